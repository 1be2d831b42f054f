;;;; agenda.lisp -- goals with priorities and deadlines.

(in-package :ars-rap)

;;; The agenda is a run variable, as the memory is. All its goals are worked on at the same time, in
;;; tasks of one plan. They share what they need by resources, which go to the highest priority.

(define-run-variable main-agenda* '()
  "The agenda of the current run: a list of lists (number goal priority deadline state note), the
oldest first. See AGENDA-GOALS.")

(define-run-variable goals-installed* 0 "How many goals were installed in the current run.")

(defun goal-call-p (goal)
  (and (proper-list-p goal) goal (first goal) (symbolp (first goal))
       (find-procedure (first goal) nil)
       t))

(defun check-goal (operator goal priority deadline)
  (unless (goal-call-p goal)
    (reject-argument operator 'goal goal
                     "a list (name argument...) with the name of a RAP or another plan"))
  (unless (ground-p goal)
    (reject-argument operator 'goal goal "a list without variables such as ?x"))
  (unless (realp priority) (reject-argument operator 'priority priority "a number"))
  (unless (typep deadline '(or null real))
    (reject-argument operator 'deadline deadline "a tick, or NIL")))

(defun install-goal (goal &optional (priority 0) deadline)
  "Put GOAL, a list (name argument...) with the name of a RAP or another plan, on the agenda of the
current run. PRIORITY is a number, greater for what is more urgent. The goal fails if it is not
achieved by the tick DEADLINE, unless that is NIL. Return the number of the goal. Arguments are
plain data, or things and robots of the run. Signals WRONG-ARGUMENT. (From RAP.)"
  (check-goal 'install-goal goal priority deadline)
  (let ((number (incf goals-installed*)))
    (setf main-agenda*
          (append main-agenda* (list (list number goal priority deadline :waiting ""))))
    number))

(defun agenda-goals (&optional (states '(:waiting :active :achieved :failed)))
  "Return the goals of the agenda of the current run whose state is one of STATES, a list: property
lists with :number, :goal, :priority, :deadline, :state and :note. STATE is :WAITING, :ACTIVE,
:ACHIEVED or :FAILED. NOTE is a text about a failure."
  (loop for (number goal priority deadline state note) in main-agenda*
        when (member state states)
          collect (list :number number :goal goal :priority priority :deadline deadline
                        :state state :note note)))

(defun set-goal-state (number state &optional (note ""))
  (setf main-agenda*
        (loop for row in main-agenda*
              collect (if (eql number (first row))
                          (append (subseq row 0 4) (list state note))
                          row))))

(defun remove-goal (number)
  "Remove the goal NUMBER, as INSTALL-GOAL returns it, from the agenda of the current run. Return
true if it was there. Signals WRONG-ARGUMENT, and MISUSE if the goal is being worked on."
  (unless (integerp number) (reject-argument 'remove-goal 'number number "the number of a goal"))
  (let ((row (assoc number main-agenda*)))
    (when (eq :active (fifth row))
      (reject-use "The goal ~D is active. Evaporate its task to end it." number))
    (when row (setf main-agenda* (remove number main-agenda* :key #'first)))
    (and row t)))

(defun reset-agenda ()
  "Remove all goals from the agenda of the current run. Return nothing. (From RAP.)"
  (setf main-agenda* '())
  (values))

(defun dump-agenda (&optional (stream *standard-output*))
  "Write the goals of the current run to STREAM. Return nothing. (From RAP.)"
  (dolist (goal (agenda-goals))
    (destructuring-bind (&key number goal priority deadline state note) goal
      (format stream "~&~4D  ~8A ~A  priority ~A~@[, until tick ~A~]~@[: ~A~]~%"
              number (string-downcase state) (data-text goal) priority deadline
              (and (string/= "" note) note))))
  (values))

(defun before-p (row other)
  "True if the goal of ROW comes before that of OTHER, an older one."
  (destructuring-bind (priority deadline) (subseq row 2 4)
    (destructuring-bind (other-priority other-deadline) (subseq other 2 4)
      (cond ((/= priority other-priority) (> priority other-priority))
            ((and deadline other-deadline) (< deadline other-deadline))
            (t (and deadline t))))))

(defun take-goal ()
  "Return the waiting goal with the highest priority, and among equals the earliest deadline, as a
row of the agenda, and mark it as active. Return NIL if none waits."
  (let ((best nil))
    (dolist (row main-agenda*)
      (when (and (eq :waiting (fifth row)) (or (null best) (before-p row best)))
        (setf best row)))
    (when best (set-goal-state (first best) :active))
    best))

(defun note-failure (number failure)
  "Mark the goal NUMBER as failed by FAILURE. Warn of an error of Lisp, with its place in the plan."
  (set-goal-state number :failed (failure-text failure))
  (when (typep failure 'lisp-failure)
    (warn "The goal ~A failed: ~S" (data-text (second (assoc number main-agenda*))) failure)))

(def-interp-proc pursue-goal (row)
  "Work for the goal of ROW, a row of the agenda. Return true if it is achieved. A goal whose work
is ended from outside has failed."
  (evap-protect (pursue-active-goal row) (note-interruption (first row))))

(defun note-interruption (number)
  "Mark the goal NUMBER as failed if it is still active: its work was ended from outside."
  (when (eq :active (fifth (assoc number main-agenda*)))
    (set-goal-state number :failed "Its plan was ended.")))

(def-interp-proc pursue-active-goal (row)
  "Work for the goal of ROW, which is active. Return true if it is achieved."
  (let ((number (first row)) (goal (second row)) (deadline (fourth row)))
    (handle-failure ((t (failure) (note-failure number failure) (return nil)))
      (with-task-variables ((goal-priority* (third row)))
        (if deadline
            (with-deadline ((max 0 (- deadline (simulation-tick))))
              (apply-plan (first goal) (rest goal)))
            (apply-plan (first goal) (rest goal))))
      (set-goal-state number :achieved)
      t)))

(def-interp-proc work-on-agenda (&key (at-once 8))
  "Work on the goals of the agenda of the current run until none is waiting or active, also on goals
that are installed meanwhile. Work on at most AT-ONCE goals at the same time: first on the goals
with the highest priority, and among equals the earliest deadline. Return the number of goals
achieved."
  (let ((changed (state 'agenda-changed)) (achieved 0))
    (with-task-variables ((resources* (or resources* (list :resources))))
      (pursue
        (par-loop (worker (make-list at-once))
          (loop
            (let ((row (take-goal)))
              (cond (row (when (pursue-goal row) (incf achieved))
                         (pulse changed))
                    ((agenda-goals '(:active)) (wait-for changed))
                    (t (return))))))
        ;; Goals that are installed from elsewhere.
        (loop (wait-until (agenda-goals '(:waiting)))
              (pulse changed)
              (wait-time 1))))
    achieved))

(defun process-goal-agenda ()
  "Work on the goals of the agenda of the current run, by the plan WORK-ON-AGENDA, until none is
left. Return the number of goals achieved. In a plan, call WORK-ON-AGENDA. (From RAP.)"
  (run-plan 'work-on-agenda))

(defun execute-goal (goal &optional (priority 0) deadline)
  "Work on GOAL only, as INSTALL-GOAL and PROCESS-GOAL-AGENDA do. Return true if it is achieved.
Signals WRONG-ARGUMENT. (From RAP.)"
  (let ((number (install-goal goal priority deadline)))
    (set-goal-state number :active)
    (and (eq t (run-plan 'pursue-goal (assoc number main-agenda*))) t)))
