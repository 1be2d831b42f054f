;;;; task.lisp -- nodes, frames and tasks: what a running plan is made of.

(in-package :ars-magna.rpl.tasks)

(export '(current-form form-text whole-form-text forms-under-way frame-runs frame frame-counter
          frame-data frame-environment frame-node frame-state frame-up make-frame make-task node
          node-form task-awaiting task-cleaning task-frame task-index task-label task-level
          task-newest-child task-runner task-signal task-status-fluent task-timer evaporating-p
          part-of-p lineage frame-chain frames-around under-way-p frame-p node-names task-doomed
          task-uncounted-p task-older))

;;; A plan is a graph of nodes, its expressions. A task runs one of them as a chain of frames, the
;;; innermost of which is the task's own FRAME. Everything that a task knows is in its frames and
;;; their environments, on the heap. Children of a task exist only while its innermost frame is
;;; that of a construct that waits for them.
;;;
;;; An environment is a vector: element 0 is the environment around it, the others are variables.

(defstruct (node (:constructor nil) (:copier nil))
  "An expression of a plan. STEP takes the node, task, frame and the value of the inner expression
that has ended, and returns the frame to go on with and a value for it. UNWIND is called with the
same arguments but a signal when a signal passes the frame, and returns a frame that takes care of
it, or NIL and, if another signal is to go on instead, that. CHILD-ENDED is called with node, task,
frame, child, the child's state and its result. STATES are the names of what a frame may be in,
NAMES those of the variables in the environment that it runs in: a list for each level of that,
innermost first. WHOSE says whether forks of a run share it, once somebody has found that out."
  (form nil)
  (names '() :type list)
  (states #() :type simple-vector)
  (step #'list :type function)
  (unwind nil :type (or null function))
  (child-ended nil :type (or null function))
  (whose :unknown :type (member :unknown :everybodys :a-runs)))

(declaim (inline make-frame))
(defstruct (frame (:constructor make-frame (node environment up)) (:copier nil))
  "One run of NODE on behalf of the frame UP. COUNTER, the number of a state, and DATA are the
node's business."
  (node nil :type node)
  (environment #() :type simple-vector)
  (up nil :type (or null frame))
  (counter 0 :type fixnum)
  (data nil))

(defun frame-state (frame)
  "Return the name of the state that FRAME is in, a keyword; a number of parts begun, if its node
has no states."
  (let ((states (node-states (frame-node frame))))
    (if (plusp (length states))
        (svref states (frame-counter frame))
        (frame-counter frame))))

(addition task)
(defstruct (task (:constructor make-task (name node)) (:copier nil))
  "One incarnation of a plan's expression. FRAME and VALUE say how it will go on; SIGNAL, if any,
what will happen to it instead. LEVEL 0 is the plan proper, a policy is one above what it guards.
SLICE is how many steps it may still take in the ROUND of that number. BLOCKED is how many keep it
from running, SUSPENSIONS how many of these are so called, SUSPENDED whether SUSPEND is one. GATE is
what it waits for before it starts, VARIABLES what it has set."
  (name nil)
  (node nil :type node)
  (runner nil)
  (serial 0 :type fixnum)
  (state :created :type keyword)
  (doomed nil :type boolean)
  (level 0 :type (integer 0 7))
  (index 0 :type fixnum)
  (frame nil :type (or null frame))
  (value nil)
  (signal nil)
  (awaiting nil)
  (since 0 :type real)
  (timer nil :type (or null timer))
  (cleaning '() :type list)
  (blocked 0 :type fixnum)
  (round 0 :type fixnum)
  (slice 0 :type fixnum)
  (result nil)
  (status-fluent nil :type (or null fluent))
  (parent nil :type (or null task))
  (suspensions 0 :type fixnum)
  (suspended nil :type boolean)
  (uncounted-p nil :type boolean)
  (gate nil)
  (variables '() :type list)
  (newest-child nil :type (or null task))
  (older nil :type (or null task))
  (newer nil :type (or null task)))
(declaim-final frame task)

(defmethod copy-plan-value ((task task) fork)
  (if (and (task-runner task) (not (home-forked-p (task-runner task) fork)))
      task
      (copy-slots task fork)))

(defmethod asker-forked-p ((task task))
  t)

(document-functions
 node-form "Return the source of the expression that the node stands for."
 make-frame "Return a frame for one run of a node, in an environment, on behalf of a frame or NIL."
 frame-node "Return the node that the frame runs."
 frame-environment "Return the vector of the variables that the node sees, and of those around it."
 frame-up "Return the frame that gets the value, or NIL."
 frame-counter "Return the number of the state that the frame is in: see FRAME-STATE."
 frame-data "Return what the frame has to remember: in DEFINE-EXPRESSION, its MEMORY."
 make-task "Return a task by name and node that has not started: see SPAWN."
 task-runner "Return the plan runner that the task belongs to."
 task-level "Return the level of the task: 0, or how many policies it is a part of."
 task-index "Return which of the parts of the task around it the task is, from 0 on."
 task-frame "Return the innermost frame of the task, NIL if it is over."
 task-signal "Return what will happen to the task instead of going on, or NIL."
 task-awaiting "Return what the task waits for: a watcher, a timer, a valve, a text; or NIL."
 task-timer "Return the timer that ends the task's wait at the latest, or NIL."
 task-cleaning "Return the frames of the task that clean up, innermost first."
 task-uncounted-p "True if the task's steps are not charged for, as what it does has a price."
 task-status-fluent "Return the fluent that follows the task's status, or NIL: see TASK-STATUS."
 task-older "Return the part of the same task that started before the task, or NIL."
 task-newest-child "Return that part of the task which started last of those not over, or NIL.")

(addition task-p task-name task-state task-serial task-parent task-result task-since)
(loop for (reader text) in
      '((task-name "Return what the task is called: its tag, its procedure, or NIL.")
        (task-state "Return the task's state: :created, :ready, :running, :waiting, and when it is
over :succeeded, :failed or :evaporated.")
        (task-serial "Return the number of the task within its plan runner.")
        (task-since "Return the tick at which the task began to wait, or did so last.")
        (task-parent "Return the task that the task is part of, or NIL.")
        (task-result "Return the value of a task that succeeded, the failure of one that failed.")
        (task-p "True of tasks."))
      do (setf (documentation reader 'function) text))

(declaim (inline task-over-p))
(addition task-over-p)
(defun task-over-p (task)
  "True if TASK has succeeded, failed or evaporated."
  (member (task-state task) '(:succeeded :failed :evaporated)))

(addition task-children)
(defun task-children (task)
  "Return the tasks that TASK consists of now, oldest first."
  (check-argument task-children task (task-p task) "a task, as begin-plan returns")
  (loop with children = '()
        for child = (task-newest-child task) then (task-older child)
        while child do (push child children)
        finally (return children)))

(addition task-top)
(defun task-top (task)
  "Return the top-level task that TASK is part of, perhaps itself."
  (check-argument task-top task (task-p task) "a task, as begin-plan returns")
  (loop while (task-parent task)
        do (setf task (task-parent task)))
  task)

(defun lineage (task)
  "Return TASK and the tasks that it is part of, innermost first."
  (loop for each = task then (task-parent each)
        while each collect each))

(defun frame-chain (frame)
  "Return FRAME and those that it is run on behalf of, innermost first."
  (loop for each = frame then (frame-up each)
        while each collect each))

(defun frames-around (task &optional (frame (task-frame task)))
  "Return the frames of TASK from FRAME on, and those of the tasks that it is part of, innermost
first."
  (nconc (frame-chain frame)
         (mapcan (lambda (whole) (frame-chain (task-frame whole))) (rest (lineage task)))))

(defun part-of-p (task whole)
  "True if TASK is WHOLE or a part of it."
  (loop for each = task then (task-parent each)
        while each thereis (eq each whole)))

(defun evaporating-p (task)
  "True if TASK, or what it is part of, is evaporating."
  (loop for each = task then (task-parent each)
        while each thereis (task-doomed each)))

(defun under-way-p (task)
  "True if TASK has been started and is not over."
  (not (or (task-over-p task) (eq (task-state task) :created))))

(defgeneric current-form (node frame)
  (:documentation "Return the source of the expression of NODE that FRAME is at.")
  (:method (node frame)
    (declare (ignore frame))
    (node-form node)))

;; A body is at the expression that one of its steps runs; a call that the body of another is at
;; runs that body anew.
(defun frame-runs (frame)
  "Return FRAME and those that it is run on behalf of, innermost first, as a list of lists: the
frames of one list run one expression."
  (let ((runs '()) (last-form nil))
    (loop for each = frame then (frame-up each)
          while each
          do (let ((form (current-form (frame-node each) each)))
               (if (and runs
                        (eq form last-form)
                        (not (find (frame-node each) (first runs) :key #'frame-node)))
                   (push each (first runs))
                   (push (list each) runs))
               (setf last-form form)))
    (nreverse (mapcar #'nreverse runs))))

(defun forms-under-way (frame)
  "Return the expressions that FRAME, and those that it is run on behalf of, are at, innermost
first."
  (loop for (each) in (frame-runs frame)
        collect (current-form (frame-node each) each)))

(addition task-form)
(defun task-form (task)
  "Return the source of the expression that TASK is at."
  (check-argument task-form task (task-p task) "a task, as begin-plan returns")
  (let ((frame (task-frame task)))
    (if frame
        (current-form (frame-node frame) frame)
        (node-form (task-node task)))))

(defun written (object)
  "Return how OBJECT is written; in part, if it is data that takes long to print."
  (if (typep object '(or cons string bit-vector number symbol))
      (unqualified-text object)
      (prin1-to-string object)))

(defun form-text (form &optional (width 60) (length 8) (level 4))
  "Return FORM, or any other object, on one line of at most WIDTH characters, with at most LENGTH
elements of each list in it, to the depth LEVEL, and symbols without their packages."
  (let ((*print-case* :downcase) (*print-pretty* nil) (*print-readably* nil)
        (*print-length* length) (*print-level* level) (*print-base* 10) (*print-radix* nil))
    (cut (substitute #\Space #\Newline
                     (handler-case (written form)
                       ((or error storage-condition) () "what cannot be printed")))
         width)))

(defmethod print-object ((node node) stream)
  (print-unreadable-object (node stream :type t)
    (write-string (form-text (node-form node) 40) stream)))

(defun whole-form-text (form)
  "Return FORM on one line as it is, unless it is longer than a page."
  (form-text form 3000 200 20))

(defun task-label (task &optional (text (lambda (form) (form-text form 40))))
  "Return a short text that says which task TASK is; of one without a name, what the function TEXT
makes of its expression."
  (let ((name (task-name task)))
    (cond ((null name) (funcall text (node-form (task-node task))))
          ((and (symbolp name) (< (length (symbol-name name)) 100)) (string-downcase name))
          (t (string-downcase (safe-text name :escape nil))))))

(addition task-path)
(defun task-path (task)
  "Return the labels of the tasks from the top of the plan to TASK."
  (reverse (mapcar #'task-label (lineage task))))

;; Whatever a plan asks for, in whatever task, is asked for by the plan as a whole.
(defmethod asker-note ((task task))
  (list "the plan " (task-label (task-top task))))

(defmethod print-object ((task task) stream)
  (print-unreadable-object (task stream :type t)
    (format stream "~D ~(~A~) ~A" (task-serial task) (task-state task) (task-label task))))

(defun link-child (child parent)
  (let ((sibling (task-newest-child parent)))
    (setf (task-parent child) parent
          (task-older child) sibling
          (task-newest-child parent) child)
    (when sibling (setf (task-newer sibling) child))))

(defun unlink-child (child)
  "Take CHILD out of its parent's children. It still knows its parent."
  (let ((older (task-older child))
        (newer (task-newer child)))
    (if newer
        (setf (task-older newer) older)
        (setf (task-newest-child (task-parent child)) older))
    (when older (setf (task-newer older) newer))
    (setf (task-older child) nil
          (task-newer child) nil)))
