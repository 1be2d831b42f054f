;;;; agenda.lisp -- goals with priorities and deadlines.

(in-package :ars-rap)

;;; The agenda is a run variable, as the memory is: what is in it counts. Each WORK-ON-AGENDA has a
;;; task that waits for changes, starts a task beside it for each goal in its turn, and evaporates
;;; tasks whose goals are no longer there. Goals share what they need by resources.

(define-run-variable main-agenda* '()
  "The agenda of the current run: a list of lists (number goal priority deadline state note robot).
First come the last goals that have ended, in the order of their ends, then the other goals, the
oldest first. See AGENDA-GOALS.")

(defparameter *ended-goals-kept* 100 "How many goals that have ended stay on the agenda.")

(defparameter *open-goals-limits* '(500 8000)
  "How many goals on the agenda may be waiting or active, and how many elements and characters they
may have.")

(defconstant +largest-agenda+ 9900
  "The most elements and characters on the agenda. A run variable can have a few more.")

(defparameter *longest-goal-note* 200 "The largest number of characters in the note of a goal.")

(define-run-variable goals-installed* 0 "How many goals were installed in the current run.")

(defun goal-call-p (goal)
  (and (proper-list-p goal) goal (first goal) (symbolp (first goal))
       (find-procedure (first goal) nil)
       t))

(defun check-priority (operator priority)
  (unless (realp priority) (reject-argument operator 'priority priority "a number")))

(defun check-goal (operator goal priority deadline)
  (unless (goal-call-p goal)
    (reject-argument operator 'goal goal
                     "a list (name argument...) with the name of a RAP or another plan"))
  (check-run-variable-value operator 'goal goal (world-of-current-run 'main-agenda*))
  (unless (ground-p goal)
    (reject-argument operator 'goal goal "a list without variables such as ?x"))
  (check-priority operator priority)
  (unless (typep deadline '(or null real))
    (reject-argument operator 'deadline deadline "a tick, or NIL")))

(defun agenda-row (number) (assoc number main-agenda*))

(defun goal-state (number) (fifth (agenda-row number)))

;;; Each task that works on the agenda waits for a fluent of its own. Agents have notes of them.

(defun goal-workers (agent)
  "Return a list of lists (robot only fluent), one for each task of AGENT that works on the agenda.
ONLY is the number of its only goal, or NIL."
  (agent-note agent 'goal-workers))

(defun wake-goal-workers (agent)
  "Let the tasks of AGENT that work on the agenda look at it. Can be called from anywhere."
  (flet ((wake-all ()
           (loop for (nil nil fluent) in (goal-workers agent) do (set-value fluent t))))
    (cond ((inside-plans-p (agent-runner agent)) (wake-all))
          (t (note-from-outside #'wake-goal-workers agent)
             (post-entry (agent-runner agent) #'wake-all agent)))))

(defun announce-change ()
  "Let all tasks that work on the agenda of the current run look at it."
  (let ((interface (usable-interface)))
    (when interface
      (dolist (agent (runner-agents (interface-runner interface)))
        (when (goal-workers agent) (wake-goal-workers agent))))))

(defmacro changing-agenda (&body body)
  "Run BODY, which reads and sets the agenda, while the run stands still: no change by another
thread comes in between. Then announce the change. Return the values of BODY."
  `(multiple-value-prog1 (asking ((current-simulation)) ,@body)
     (announce-change)))

(defun ended-p (row) (and (member (fifth row) '(:achieved :failed)) t))

(defun data-size (data)
  "Return the number of elements and characters in DATA, as the limits of run variables count them."
  (typecase data
    (cons (loop while (consp data) sum (1+ (data-size (pop data)))))
    (string (length data))
    (simple-vector (+ (length data) (reduce #'+ data :key #'data-size)))
    (t 0)))

(defun without-old-ends (rows)
  "Return ROWS, of the agenda, without the oldest ends if there are too many or they are too large."
  (loop for over = (- (count-if #'ended-p rows) *ended-goals-kept*) then (1- over)
        while (and rows
                   (ended-p (first rows))
                   (or (plusp over) (< +largest-agenda+ (data-size rows))))
        do (pop rows))
  rows)

(defun with-changed-row (row rows)
  "Return ROWS, of the agenda, with ROW in place of the row of the same goal."
  (if (ended-p row)
      (let ((others (remove (first row) rows :key #'first)))
        (without-old-ends (append (remove-if-not #'ended-p others) (list row)
                                  (remove-if #'ended-p others))))
      (substitute row (first row) rows :key #'first)))

(defun change-goal (number &key priority state (note ""))
  "Give the goal NUMBER another PRIORITY, or another STATE with a NOTE. Return true if the goal is
on the agenda."
  (changing-agenda
    (let ((row (agenda-row number)))
      (when row
        (destructuring-bind (goal old-priority deadline old-state old-note robot) (rest row)
          (setf main-agenda* (with-changed-row
                              (list number goal (or priority old-priority) deadline
                                    (or state old-state)
                                    (if state (cut-middle note *longest-goal-note*) old-note)
                                    robot)
                              main-agenda*)))
        t))))

(defun set-goal-state (number state &optional (note ""))
  (change-goal number :state state :note note))

;;; What users call.

(defun check-room (row)
  "Signal MISUSE if ROW, a new row, makes the open goals of the agenda too many."
  (let ((rows (cons row (remove-if #'ended-p main-agenda*))))
    (destructuring-bind (most largest) *open-goals-limits*
      (when (or (< most (length rows)) (< largest (data-size rows)))
        (reject-use "install-goal: The agenda is full: ~D goals wait or are worked on. There may ~
                     be ~D, with ~:D elements and characters together. Install ~A later, or remove ~
                     goals by REMOVE-GOAL." (1- (length rows)) most largest
                    (cut (data-text (second row)) 60))))))

(defun install-goal (goal &optional (priority 0) deadline robot)
  "Put GOAL, a list (name argument...) with the name of a RAP or another plan, on the agenda of the
current run. PRIORITY is a number, greater for what is more urgent. The goal fails unless it is
achieved at the tick DEADLINE or before; NIL means any time. If ROBOT is given, a robot or its name,
only the plans of that robot work on the goal. Return the number of the goal. Arguments are plain
data, or things and robots of the run. Signals WRONG-ARGUMENT and UNKNOWN-NAME; and MISUSE if 500
goals are waiting or active. (From RAP.)"
  (check-goal 'install-goal goal priority deadline)
  (let ((robot (and robot (find-robot robot))))
    (changing-agenda
      (let* ((number (1+ goals-installed*))
             (row (list number goal priority deadline :waiting "" robot)))
        (check-room row)
        (setf main-agenda* (without-old-ends (append main-agenda* (list row)))
              goals-installed* number)))))

(defun check-number (operator number)
  (unless (integerp number) (reject-argument operator 'number number "the number of a goal")))

(defun remove-goal (number)
  "Remove the goal NUMBER, as INSTALL-GOAL returns it, from the agenda of the current run. If it is
active, its task evaporates. Return true if it was there. Signals WRONG-ARGUMENT."
  (check-number 'remove-goal number)
  (changing-agenda
    (when (agenda-row number)
      (setf main-agenda* (remove number main-agenda* :key #'first))
      t)))

(defun set-goal-priority (number priority)
  "Give the goal NUMBER, as INSTALL-GOAL returns it, another PRIORITY. If it is active, this holds
for resources that it requests from now on. Return true if the goal is on the agenda of the current
run. Signals WRONG-ARGUMENT."
  (check-number 'set-goal-priority number)
  (check-priority 'set-goal-priority priority)
  (change-goal number :priority priority))

(defun reset-agenda ()
  "Remove all goals from the agenda of the current run. The tasks of active goals evaporate. Return
nothing. (From RAP.)"
  (changing-agenda (setf main-agenda* '()))
  (values))

(defun suspended-goals ()
  "Return the numbers of the active goals with a suspended task."
  (call-with-plans-in-use
   (lambda (runner)
     (loop for task in (and runner (all-tasks runner))
           when (and (goal-task-p task) (some #'suspended-p (all-tasks task)))
             collect (task-index task)))))

(defun agenda-goals (&optional (states '(:waiting :active :suspended :achieved :failed)))
  "Return the goals of the agenda of the current run whose state is one of STATES, a list: property
lists with :number, :goal, :priority, :deadline, :state, :note and :robot. STATE is :WAITING,
:ACTIVE, :SUSPENDED, :ACHIEVED or :FAILED. An active goal is :SUSPENDED while one of its tasks is
suspended, for example because a resource was taken from it. NOTE is a text about a failure. Of the
goals that have ended, the last 100 are there."
  (loop with suspended = (and (find :active main-agenda* :key #'fifth) (suspended-goals))
        for (number goal priority deadline state note robot) in (sort main-agenda* #'< :key #'first)
        for shown = (if (and (eq :active state) (member number suspended)) :suspended state)
        when (member shown states)
          collect (list :number number :goal goal :priority priority :deadline deadline
                        :state shown :note note :robot robot)))

(defun dump-agenda (&key (stream *standard-output*))
  "Write the goals of the current run to STREAM. Return nothing. (From RAP.)"
  (dolist (goal (agenda-goals))
    (destructuring-bind (&key number goal priority deadline state note robot) goal
      (format stream "~&~4D  ~9A ~A  priority ~A~@[, until tick ~A~]~@[, for ~A~]~@[: ~A~]~%"
              number (string-downcase state) (data-text goal) priority deadline
              (and robot (string-downcase (robot-name robot)))
              (and (string/= "" note) note))))
  (values))
