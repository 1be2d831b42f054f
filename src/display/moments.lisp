;;;; moments.lisp -- the notable events of a run.

(in-package :ars-magna.display)

(export '(make-moment make-moments-watcher moments-in-remarks checked-moments check-kinds
          moments-of-kinds sort-moments moment-weight moment-words))

;;; A journal records requests, not their results. So it is replayed. After each tick a watcher
;;; compares what each robot holds and has in its bins, and what failed last, with the tick before.

(define-constant +moment-kinds+ '(:grasp :release :stow :failure :plan :part :error :note)
  :test #'cl:equal
  :documentation "The kinds of moments.")

(addition moment-p)
(define-record (moment (:constructor make-moment (tick kind text &optional x y robot code)))
  "A notable event: at TICK, to the robot named ROBOT, which was at X, Y. TEXT describes it."
  (tick 0 real "the tick at which it happened" :addition)
  (kind :note symbol "its kind: :GRASP, :RELEASE, :STOW; :FAILURE of a command; :PLAN that failed or
was ended; :PART of a plan that failed, perhaps handled by the plan, or was ended; :ERROR in users'
code; :NOTE of a user" :addition)
  (text "" string "a short description of it" :addition)
  (x nil (or null real) "where the robot was then, in metres, or NIL if that is unknown" :addition)
  (y nil (or null real) "where the robot was then, in metres, or NIL if that is unknown" :addition)
  (robot nil symbol "the name of the robot, a symbol, or NIL if that is unknown" :addition)
  (code nil symbol "the error code of a command that failed, or NIL" :export))

(defmethod print-object ((moment moment) stream)
  (print-unreadable-object (moment stream)
    (format stream "~(~A~) at tick ~A: ~A" (moment-kind moment) (moment-tick moment)
            (moment-text moment))))

(defstruct (observation (:constructor make-observation (held stowed failure)) (:copier nil))
  "What each hand of a robot holds, what each of its bins contains, and what failed last."
  (held '() :type list :read-only t)
  (stowed '() :type list :read-only t)
  (failure nil :read-only t))

(defun observe-robot (robot)
  (make-observation (cl:map 'list #'hand-holding (robot-hands robot))
                    (cl:map 'list #'storage-bin-contents (robot-bins robot))
                    (robot-failure robot)))

(defun observation-before (new)
  "Return the observation before the first one, NEW: runs begin with empty hands."
  (make-observation (mapcar (constantly nil) (observation-held new)) (observation-stowed new) nil))

(defun changes-of-hands (old new)
  "Return lists (kind text) of what hands have grasped or released between two observations."
  (loop for before in (observation-held old)
        for after in (observation-held new)
        unless (eq before after)
          append (append (and before (list (list :release (format nil "let go of ~A" before))))
                         (and after (list (list :grasp (format nil "grasped ~A" after)))))))

(defun changes-of-bins (old new)
  (loop for before in (observation-stowed old)
        for after in (observation-stowed new)
        for index from 0
        append (loop for thing in (set-difference after before :test #'eq)
                     collect (list :stow (format nil "stowed ~A in bin ~D" thing index)))))

(defun failures-since (old new robot)
  (unless (eq (observation-failure new) (observation-failure old))
    (destructuring-bind (&key command error text &allow-other-keys) (last-failure robot)
      (when (trouble-p error)
        (list (list :failure (format nil "~(~A~): ~A" command text) error))))))

(defun moments-between (old new robot tick)
  "Return the moments between two observations of ROBOT, the later one at TICK."
  (loop for (kind text code) in (append (changes-of-hands old new) (changes-of-bins old new)
                                        (failures-since old new robot))
        collect (make-moment tick kind text (robot-x robot) (robot-y robot) (robot-name robot)
                             code)))

(defun make-moments-watcher ()
  "Return two functions. Call the first with a simulation after each tick. The second, without
arguments, returns the moments so far, the earliest first."
  (let ((observations '()) (moments '()))
    (values (lambda (simulation)
              (dolist (robot (simulation-robots simulation))
                (let* ((new (observe-robot robot))
                       (old (or (cdr (assoc robot observations)) (observation-before new))))
                  (setf moments
                        (revappend (moments-between old new robot (simulation-tick simulation))
                                   moments)
                        observations (acons robot new (remove robot observations :key #'first))))))
            (lambda () (reverse moments)))))

;;; A journal itself records the ends of plans, and errors in users' code.

(defun moments-in-remarks (journal until)
  "Return the moments in the remarks of JOURNAL, up to the tick UNTIL or its end."
  (loop for (tick kind text robot x y) in (reverse (journal-remarks journal))
        for blueprint = (and robot (find-blueprint robot nil))
        when (or (null until) (<= tick until))
          collect (make-moment tick kind text x y (and blueprint (blueprint-name blueprint)))))

;;; Users' own moments.

(defun parse-moment (object)
  "Return the moment for OBJECT, a moment or a list (tick text [robot]); NIL for other objects."
  (cond ((moment-p object) object)
        ((typep object '(cons integer (cons string (or null (cons symbol null)))))
         (make-moment (first object) :note (second object) nil nil (third object)))))

(defun checked-moments (operator moments end)
  "Return the list MOMENTS, an argument of OPERATOR, as moments of a run that ends at the tick END.
Signals WRONG-ARGUMENT."
  (let ((own (and (proper-list-p moments) (mapcar #'parse-moment moments))))
    (unless (and (proper-list-p moments)
                 (every (lambda (moment)
                          (and moment (typep (moment-tick moment) `(integer 0 ,end))))
                        own))
      (reject-argument operator :moments moments
                       (format nil "a list of moments, or of lists of a tick, a string and perhaps ~
                                    a robot's name, with ~
                                    whole ticks from 0 to ~D, the last one shown"
                               end)))
    own))

(defun check-kinds (operator kinds)
  "Signal WRONG-ARGUMENT unless KINDS, an argument of OPERATOR, is T or a list of kinds of moments."
  (unless (or (eq kinds t)
              (and (proper-list-p kinds) (subsetp kinds +moment-kinds+)))
    (reject-argument operator :kinds kinds
                     (format nil "T for all, or a list of some of ~{~(~S~)~^, ~}" +moment-kinds+))))

(defun moments-of-kinds (kinds moments)
  "Return those of MOMENTS whose kind is in the list KINDS, and users' own; all if KINDS is T."
  (if (eq kinds t)
      moments
      (remove-if-not (lambda (moment) (member (moment-kind moment) (cons :note kinds))) moments)))

(defun sort-moments (moments)
  "Return MOMENTS sorted by tick."
  (stable-sort (copy-list moments) #'< :key #'moment-tick))

(defparameter *expected-codes* '(:robot-blocked :not-tracking :lost-track :track-lost)
  "Codes of failures that plans expect and handle.")

(defun moment-weight (moment)
  "Return the importance of MOMENT, from 0, the most, to 3."
  (case (moment-kind moment)
    (:note 0)
    (:failure (if (member (moment-code moment) *expected-codes*) 3 2))
    (:part 2)
    (t 1)))

(defun moment-words (moment several-p)
  "Return a description of MOMENT, which names its robot if SEVERAL-P: if there are several."
  (format nil "~@[~A: ~]~A"
          (and several-p (moment-robot moment) (drawn-name (moment-robot moment)))
          (moment-text moment)))
