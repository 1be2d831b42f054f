;;;; moments.lisp -- what happened in a run that people want to find again.

(in-package :ars-magna.display)

(export '(make-moment moments-watcher remarked-moments checked-moments check-kinds of-kinds
          in-order moment-weight moment-words))

;;; A journal says what was asked for, not what came of it. So it is repeated, and after each tick
;;; somebody looks what a robot holds now that it did not, what lies in its bins, and what failed.

(define-constant +moment-kinds+ '(:grasp :release :stow :failure :plan :part :error :note)
  :test #'cl:equal
  :documentation "What sorts of moments there are.")

(addition moment-p)
(define-record (moment (:constructor make-moment (tick kind text &optional x y robot code)))
  "That at TICK something happened of which TEXT tells, to ROBOT, the name of one, that was at X, Y.
KIND is what sort of thing that is."
  (tick 0 real "the tick at which it was" :addition)
  (kind :note symbol "what sort of thing it was: :GRASP, :RELEASE, :STOW; :FAILURE of a command;
:PLAN, that failed or was ended; :PART of a plan, in which something failed that the plan may have
taken care of, or that somebody ended; :ERROR in users' code; :NOTE of a user's" :addition)
  (text "" string "a few words about it" :addition)
  (x nil (or null real) "where the robot was then, in metres, or NIL if that is unknown" :addition)
  (y nil (or null real) "where the robot was then, in metres, or NIL if that is unknown" :addition)
  (robot nil symbol "the name of the robot, a symbol, or NIL if that is unknown" :addition)
  (code nil symbol "the error code of a command that failed, or NIL" :export))

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

(defun failures-since (old new robot)
  (unless (eq (sight-failure new) (sight-failure old))
    (destructuring-bind (&key command error text &allow-other-keys) (last-failure robot)
      (when (trouble-p error)
        (list (list :failure (format nil "~(~A~): ~A" command text) error))))))

(defun moments-between (old new robot tick)
  "Return the moments that lie between two sights of ROBOT, of which the later is of TICK."
  (loop for (kind text code) in (append (changes-of-hands old new) (changes-of-bins old new)
                                        (failures-since old new robot))
        collect (make-moment tick kind text (robot-x robot) (robot-y robot) (robot-name robot)
                             code)))

;;; Looking all the time.

(defun moments-watcher ()
  "Return two functions: one to be called with a simulation after each tick, and one without
arguments, which returns the moments seen so far, the earliest first."
  (let ((sights '()) (moments '()))
    (values (lambda (simulation)
              (dolist (robot (simulation-robots simulation))
                (let* ((new (sight-of robot))
                       (old (or (cdr (assoc robot sights)) (sight-before new))))
                  (setf moments
                        (revappend (moments-between old new robot (simulation-tick simulation))
                                   moments)
                        sights (acons robot new (remove robot sights :key #'first))))))
            (lambda () (reverse moments)))))

;;; What a journal itself has: what became of plans, and errors in users' code.

(defun remarked-moments (journal until)
  "Return the moments that the remarks of JOURNAL, up to the tick UNTIL or its end, tell of."
  (loop for (tick kind text robot x y) in (reverse (journal-remarks journal))
        for blueprint = (and robot (find-blueprint robot nil))
        when (or (null until) (<= tick until))
          collect (make-moment tick kind text x y (and blueprint (blueprint-name blueprint)))))

;;; What users add.

(defun own-moment (object)
  "Return the moment that OBJECT is, or that the list (tick text [robot]) stands for; NIL if it is
none."
  (cond ((moment-p object) object)
        ((typep object '(cons integer (cons string (or null (cons symbol null)))))
         (make-moment (first object) :note (second object) nil nil (third object)))))

(defun checked-moments (operator moments end)
  "Return the list MOMENTS, an argument of OPERATOR, as moments of a run that ends at the tick END.
Signals WRONG-ARGUMENT."
  (let ((own (and (proper-list-p moments) (mapcar #'own-moment moments))))
    (unless (and (proper-list-p moments)
                 (every (lambda (moment)
                          (and moment (typep (moment-tick moment) `(integer 0 ,end))))
                        own))
      (reject-argument operator :moments moments
                       (format nil "a list of moments, or of lists of a tick, a string and perhaps ~
                                    a robot's name, with ~
                                    whole ticks from 0 to ~D, where what is shown of the run ends"
                               end)))
    own))

(defun check-kinds (operator kinds)
  "Signal WRONG-ARGUMENT unless KINDS, an argument of OPERATOR, is T or a list of kinds of moments."
  (unless (or (eq kinds t)
              (and (proper-list-p kinds) (subsetp kinds +moment-kinds+)))
    (reject-argument operator :kinds kinds
                     (format nil "T for all, or a list of some of ~{~(~S~)~^, ~}" +moment-kinds+))))

(defun of-kinds (kinds moments)
  "Return those of MOMENTS that are of KINDS, T or a list, or a user's own."
  (if (eq kinds t)
      moments
      (remove-if-not (lambda (moment) (member (moment-kind moment) (cons :note kinds))) moments)))

(defun in-order (moments)
  "Return MOMENTS by their ticks."
  (stable-sort (copy-list moments) #'< :key #'moment-tick))

;;; Telling of them.

(defparameter *expected-codes* '(:robot-blocked :not-tracking :lost-track :track-lost)
  "Codes of failures that plans expect, and go on after.")

(defun moment-weight (moment)
  "Return how much MOMENT matters: 0 is most, 3 least."
  (case (moment-kind moment)
    (:note 0)
    (:failure (if (member (moment-code moment) *expected-codes*) 3 2))
    (:part 2)
    (t 1)))

(defun moment-words (moment several-p)
  "Return what happened at MOMENT, in words; also to which robot, if there are SEVERAL-P."
  (format nil "~@[~A: ~]~A"
          (and several-p (moment-robot moment) (drawn-name (moment-robot moment)))
          (moment-text moment)))
