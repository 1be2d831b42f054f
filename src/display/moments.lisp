;;;; moments.lisp -- the notable events of a run.

(in-package :ars-magna.display)

(export '(make-moment make-moments-watcher moments-in-remarks checked-moments check-moment-kinds
          moments-of-kinds sort-moments moment-rank moment-description))

;;; A journal records requests, not their results. So it is replayed. After each tick a watcher
;;; compares what each robot holds and has in its bins, and what failed last, with the tick before.

(define-constant +moment-kinds+ '(:grasp :release :stow :failure :message :plan :part :error :note)
  :test #'cl:equal
  :documentation "The kinds of moments, which are notable events of a run.")

(addition moment-p)
(define-record (moment (:constructor make-moment (tick kind text &optional x y robot code)))
  "A notable event of a run. TEXT says what happened at TICK to the robot named ROBOT at X, Y."
  (tick 0 real "the tick of the event" :addition)
  (kind :note symbol "the kind of the event: :GRASP, :RELEASE, :STOW; :FAILURE of a command;
:MESSAGE that arrived; :PLAN
that failed or was ended; :PART of a plan that failed or was ended, even if the plan continued;
:ERROR in users' code; :NOTE of a user" :addition)
  (text "" string "a short description of the event" :addition)
  (x nil (or null real) "the robot's x coordinate then, in metres, or NIL if unknown" :addition)
  (y nil (or null real) "the robot's y coordinate then, in metres, or NIL if unknown" :addition)
  (robot nil symbol "the name of the robot, a symbol, or NIL if it is unknown" :addition)
  (code nil symbol "the error code of a command that failed, or NIL" :export))

(defmethod print-object ((moment moment) stream)
  (print-unreadable-object (moment stream)
    (format stream "~(~A~) at tick ~A: ~A" (moment-kind moment) (moment-tick moment)
            (moment-text moment))))

(defstruct (observation (:constructor make-observation (held stowed failure)) (:copier nil))
  "The state of a robot after a tick, to find moments. HELD lists the thing in each hand, and STOWED
the contents of each bin. FAILURE is the last failure of a command."
  (held '() :type list :read-only t)
  (stowed '() :type list :read-only t)
  (failure nil :read-only t))

(defun observe-robot (robot)
  (make-observation (cl:map 'list #'hand-holding (robot-hands robot))
                    (cl:map 'list #'storage-bin-contents (robot-bins robot))
                    (robot-failure robot)))

(defun initial-observation (new)
  "Return an observation with empty hands, to compare with NEW, the first observation of a run."
  (make-observation (mapcar (constantly nil) (observation-held new)) (observation-stowed new) nil))

(defun changes-of-hands (old new)
  "Return lists (kind text) for the things that hands grasped or released between OLD and NEW."
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

(defun new-command-failure (old new robot)
  (unless (eq (observation-failure new) (observation-failure old))
    (destructuring-bind (&key command error text &allow-other-keys) (last-failure robot)
      (when (failure-code-p error)
        (list (list :failure (format nil "~(~A~): ~A" command text) error))))))

(defun new-messages (robot tick)
  "Return lists (kind text) for the messages that arrived at ROBOT in TICK."
  (loop for (message sender) in (last-arrivals robot tick)
        collect (list :message (format nil "heard ~A from ~(~A~)" (safe-text message) sender))))

(defun moments-between (old new robot tick)
  (loop for (kind text code) in (append (changes-of-hands old new) (changes-of-bins old new)
                                        (new-messages robot tick)
                                        (new-command-failure old new robot))
        collect (make-moment tick kind text (robot-x robot) (robot-y robot) (robot-name robot)
                             code)))

(defun make-moments-watcher ()
  "Return two functions. The first must be called with a simulation after each tick. The second,
without arguments, returns the moments found so far, the earliest first."
  (let ((observations '()) (moments '()))
    (values (lambda (simulation)
              (dolist (robot (simulation-robots simulation))
                (let* ((new (observe-robot robot))
                       (old (or (cdr (assoc robot observations)) (initial-observation new))))
                  (setf moments
                        (revappend (moments-between old new robot (simulation-tick simulation))
                                   moments)
                        observations (acons robot new (remove robot observations :key #'first))))))
            (lambda () (reverse moments)))))

;;; A journal itself records the ends of plans, and errors in users' code.

(defun moments-in-remarks (journal until)
  "Return the moments in the remarks of JOURNAL, up to the tick UNTIL, or all if UNTIL is NIL."
  (loop for (tick kind text robot x y) in (reverse (journal-remarks journal))
        for name = (and robot (remembered-robot-name robot))
        when (or (null until) (<= tick until))
          collect (make-moment tick kind text x y name)))

;;; Users' own moments.

(defun parse-moment (object)
  "Return the moment for OBJECT, a moment or a list (tick text [robot]), or NIL for other objects."
  (cond ((moment-p object) object)
        ((typep object '(cons integer (cons string (or null (cons symbol null)))))
         (make-moment (first object) :note (second object) nil nil (third object)))))

(defun checked-moments (operator moments end)
  "Return a list of moments for MOMENTS, an argument of OPERATOR. Signals WRONG-ARGUMENT unless all
of them are moments, or lists (tick text [robot]), up to the tick END."
  (let ((own (and (proper-list-p moments) (mapcar #'parse-moment moments))))
    (unless (and (proper-list-p moments)
                 (every (lambda (moment)
                          (and moment (typep (moment-tick moment) `(integer 0 ,end))))
                        own))
      (reject-argument operator :moments moments
                       (format nil "a list whose elements are moments or lists (tick string ~
                                    [robot-name]), with whole ticks from 0 to ~D, the last tick ~
                                    shown"
                               end)))
    own))

(defun check-moment-kinds (operator kinds)
  "Signal WRONG-ARGUMENT unless KINDS, an argument of OPERATOR, is T or a list of kinds of moments."
  (unless (or (eq kinds t)
              (and (proper-list-p kinds) (subsetp kinds +moment-kinds+)))
    (reject-argument operator :kinds kinds
                     (format nil "T for all except messages, or a list of some of ~
                                  ~{~(~S~)~^, ~}"
                             +moment-kinds+))))

(defun moments-of-kinds (kinds moments)
  "Return those of MOMENTS whose kind is :NOTE or in the list KINDS. If KINDS is T, return all
except messages."
  (if (eq kinds t)
      (remove :message moments :key #'moment-kind)
      (remove-if-not (lambda (moment) (member (moment-kind moment) (cons :note kinds))) moments)))

(defun sort-moments (moments)
  "Return MOMENTS sorted by tick."
  (stable-sort (copy-list moments) #'< :key #'moment-tick))

(defparameter *expected-error-codes* '(:robot-blocked :not-tracking :lost-track :track-lost)
  "The error codes of failures that plans usually expect and handle.")

(defun moment-rank (moment)
  "Return the rank of MOMENT by importance, from 0, the most important, to 3."
  (case (moment-kind moment)
    (:note 0)
    (:failure (if (member (moment-code moment) *expected-error-codes*) 3 2))
    (:part 2)
    (t 1)))

(defun moment-description (moment robots)
  "Return a description of MOMENT. It names the robot if ROBOTS, the names of the robots of the run,
are several."
  (let ((name (moment-robot moment)))
    (format nil "~@[~A: ~]~A"
            (and name (rest robots)
                 (drawn-name (name-label (or (first (robots-meant name robots :key #'identity))
                                             name)
                                         robots)))
            (moment-text moment))))
