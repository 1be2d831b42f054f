;;;; moments.lisp -- what happened in a run that people want to find again.

(in-package :ars-magna.display)

;;; A journal says what was asked for, not what came of it. So it is repeated, and after each tick
;;; somebody looks what a robot holds now that it did not, what lies in its bins, and what failed.

(addition moment-p moment-tick moment-kind moment-text moment-x moment-y)
(defstruct (moment (:constructor make-moment (tick kind text &optional x y)) (:copier nil))
  "That at TICK something happened of which TEXT tells, to a robot that was at X, Y. KIND is what
sort of thing that is."
  (tick 0 :type real :read-only t)
  (kind :note :type (member :grasp :release :stow :failure :plan :note) :read-only t)
  (text "" :type string :read-only t)
  (x nil :type (or null real) :read-only t)
  (y nil :type (or null real) :read-only t))

(document-functions
  make-moment "Return a moment: that at a tick something of a kind happened, of which a text
tells, to a robot at x, y."
  moment-p "True of moments: of things that happened in a run."
  moment-tick "Return the tick at which it was."
  moment-kind "Return what sort of thing it was: :GRASP, :RELEASE, :STOW, :FAILURE, :PLAN or :NOTE."
  moment-text "Return a few words about it."
  moment-x "Return where the robot was then, in metres, or NIL if that is unknown."
  moment-y "Return where the robot was then, in metres, or NIL if that is unknown.")

(defmethod print-object ((moment moment) stream)
  (print-unreadable-object (moment stream)
    (format stream "~(~A~) at tick ~A: ~A" (moment-kind moment) (moment-tick moment)
            (moment-text moment))))

;;; What one sees of a robot that may be different in the next tick.

(defstruct (sight (:constructor make-sight (held stowed failure)) (:copier nil))
  "What each hand of a robot holds, what each of its bins contains, and what failed last."
  (held '() :type list :read-only t)
  (stowed '() :type list :read-only t)
  (failure nil :read-only t))

(defun sight-of (robot)
  (make-sight (cl:map 'list #'hand-holding (robot-hands robot))
              (cl:map 'list #'storage-bin-contents (robot-bins robot))
              (robot-failure robot)))

(defun sight-before (new)
  "Return the sight of a robot before a run, which begins with empty hands, if NEW is the first."
  (make-sight (substitute-if nil #'identity (sight-held new)) (sight-stowed new) nil))

(defun changes-of-hands (old new)
  "Return lists (kind text) of what hands have taken or let go from the sight OLD to NEW."
  (loop for before in (sight-held old)
        for after in (sight-held new)
        unless (eq before after)
          append (append (and before (list (list :release (format nil "let go of ~A" before))))
                         (and after (list (list :grasp (format nil "grasped ~A" after)))))))

(defun changes-of-bins (old new)
  (loop for before in (sight-stowed old)
        for after in (sight-stowed new)
        for index from 0
        append (loop for thing in (set-difference after before :test #'eq)
                     collect (list :stow (format nil "stowed ~A in bin ~D" thing index)))))

(defparameter *no-trouble* '(nil :interrupt :designator-not-found :no-designators-found)
  "Codes of what is no failure to look for: plans often look for what is not there, and let a newer
command take over from an older one.")

(defun failures-since (old new robot)
  (unless (eq (sight-failure new) (sight-failure old))
    (destructuring-bind (&key command error text &allow-other-keys) (last-failure robot)
      (unless (member error *no-trouble*)
        (list (list :failure (format nil "~(~A~): ~A" command text)))))))

(defun moments-between (old new robot tick)
  "Return the moments that lie between two sights of ROBOT, of which the later is of TICK."
  (loop for (kind text) in (append (changes-of-hands old new) (changes-of-bins old new)
                                   (failures-since old new robot))
        collect (make-moment tick kind text (robot-x robot) (robot-y robot))))

;;; Looking all the time.

(defun moments-watcher ()
  "Return two functions: one to be called with a simulation after each tick, and one without
arguments, which returns the moments seen so far, the earliest first."
  (let ((sights '()) (moments '()))
    (values (lambda (simulation)
              (dolist (robot (simulation-robots simulation))
                (let* ((new (sight-of robot))
                       (old (or (cdr (assoc robot sights)) (sight-before new))))
                  (dolist (moment (moments-between old new robot (simulation-tick simulation)))
                    (push moment moments))
                  (setf sights (acons robot new (remove robot sights :key #'first))))))
            (lambda () (reverse moments)))))

;;; What users add.

(defun own-moment (object)
  "Return the moment that OBJECT is, or that the list (tick text) stands for; NIL if it is none."
  (cond ((moment-p object) object)
        ((and (consp object) (eql 2 (list-length object))
              (within-reason-p (first object)) (stringp (second object)))
         (make-moment (first object) :note (second object)))))

(defun checked-moments (operator moments)
  "Return the list MOMENTS, an argument of OPERATOR, as moments. Signals WRONG-ARGUMENT."
  (let ((own (and (proper-list-p moments) (mapcar #'own-moment moments))))
    (unless (and (proper-list-p moments) (notany #'null own))
      (reject-argument operator :moments moments
                       "a list of moments, or of lists of a tick and a string"))
    own))

(defun in-order (moments)
  "Return MOMENTS by their ticks."
  (stable-sort (copy-list moments) #'< :key #'moment-tick))
