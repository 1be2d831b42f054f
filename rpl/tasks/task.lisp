;;;; task.lisp -- nodes, frames and tasks: the parts of a running plan.

(in-package :ars-magna.rpl.tasks)

(export '(current-form form-text whole-form-text forms-under-way frames-by-expression frame
                       frame-state
          make-frame make-task node task-label evaporating-p part-of-p lineage frame-chain
          frames-around under-way-p frame-p task-runner))

;;; A plan is a graph of nodes, its expressions. A task runs one of them as a chain of frames, the
;;; innermost of which is the task's own FRAME. All state of a task is in its frames and their
;;; environments, on the heap. Children of a task exist only while its innermost frame is that of a
;;; construct that waits for them.
;;;
;;; An environment is a vector: element 0 is the environment around it, the others are variables.

(define-record (node (:constructor nil))
  "A compiled expression of a plan."
  (form nil t "the source of the expression that the node stands for" :writable :export)
  (names '() list "the names of the variables that are visible at the node: a list for each level,
innermost first" :writable :export)
  (states #() simple-vector "the names of the states that a frame of the node may be in" :writable)
  (step #'list function "the function that takes a step. Its arguments are the node, the task, the
frame, and the value of the inner expression that has ended. It returns the next frame and a value
for this frame" :writable)
  (unwind nil (or null function) "the function to call when a signal passes the frame, or NIL. Its
arguments are the node, the task, the frame and the signal. If a frame handles the signal, the
function returns true, this frame and a value. Otherwise it returns NIL and, if another signal
replaces the signal, that other signal" :writable)
  (child-ended nil (or null function) "the function to call when a child task of the frame has
ended, or NIL. Its arguments are the node, the task, the frame, the child, and the child's state and
result" :writable)
  (sharing :unknown (member :unknown :shared :per-run)
         "whether forks of a run share the node, once that is known" :writable))

(declaim (inline make-frame))
(define-record (frame (:constructor make-frame (node environment up)))
  "One run of NODE in ENVIRONMENT. If there is a frame UP, it gets the value of this run."
  (node nil node "the node that the frame runs" :writable :export)
  (environment #() simple-vector "a vector of the variables visible at the node; element 0 is the
environment around it" :writable :export)
  (up nil (or null frame) "the frame that gets the value of this frame, or NIL" :writable :export)
  (counter 0 fixnum
           "the number of the state of the frame: see FRAME-STATE" :writable :export)
  (data nil t "the data that the frame remembers; in DEFINE-EXPRESSION, the
MEMORY" :writable :export))

(defun frame-state (frame)
  "Return the state of FRAME: a keyword; or the number of parts begun, if its node has no states."
  (let ((states (node-states (frame-node frame))))
    (if (plusp (length states))
        (svref states (frame-counter frame))
        (frame-counter frame))))

(addition task task-p)
(define-record (task (:constructor make-task (name node)
                     "Return a new task with this name and node, not yet started: see SPAWN."))
  "A task: one run of an expression of a plan."
  (name nil t "the name of the task: its tag, the name of its procedure, or
NIL" :writable :addition)
  (node nil node "the expression that the task runs" :writable)
  (agent nil (or null agent) "the agent that the task belongs to, NIL until the task
starts" :writable :export)
  (serial 0 fixnum "the number of the task within its plan runner" :writable :addition)
  (state :created keyword "the task's state: :created, :ready, :running, :waiting, or at the end
:succeeded, :failed or :evaporated" :writable :addition)
  (ending-p nil boolean "the task must evaporate" :writable :export)
  (level 0 (integer 0 7) "the level of the task: 0 for the plan itself; for a policy, one above the
level of its body" :writable :export)
  (index 0 fixnum
         "the number of the task among the parts of the task around it, from 0" :writable :export)
  (frame nil (or null frame) "the innermost frame of the task, NIL if the task is
over" :writable :export)
  (value nil t "the value with which the task's innermost frame goes on; if the task is over, its
result" :writable)
  (signal nil t "the signal that the task will receive instead of going on, or
NIL" :writable :export)
  (awaiting nil t "the object that the task waits for: a watcher, a timer, a claim to a valve, a
text; or NIL" :writable :export)
  (since 0 real "the tick at which the current or last wait of the task began" :writable :addition)
  (round 0 fixnum "the round of its agent in which the task last ran" :writable)
  (slice 0 fixnum "the number of steps that the task may still take in that round" :writable)
  (parent nil (or null task)
          "the task around the task, or NIL" :writable :addition)
  (extras nil (or null structure-object) "what few tasks need, or NIL: see extras.lisp" :writable)
  (newest-child nil (or null task) "the newest part of the task that is not over, or
NIL" :writable :export)
  (older nil (or null task)
         "the next older part of the same parent task, or NIL" :writable :export)
  (newer nil (or null task) :writable))
(declaim-final frame task)

(defun task-runner (task)
  "Return the plan runner of TASK. Return NIL if TASK has not started."
  (let ((agent (task-agent task)))
    (and agent (agent-runner agent))))

(declaim (inline %task-runner))
(defun %task-runner (task)
  "Return the plan runner of TASK, which has started."
  (agent-runner (the agent (task-agent task))))

(defmethod copy-plan-value ((task task) fork)
  (if (and (task-runner task) (not (home-forked-p (task-runner task) fork)))
      task
      (copy-slots task fork)))

(defmethod asker-forked-p ((task task))
  t)

(declaim (inline task-over-p))
(addition task-over-p)
(defun task-over-p (task)
  "True if TASK has succeeded, failed or evaporated."
  (member (task-state task) '(:succeeded :failed :evaporated)))

(addition task-result)
(defun task-result (task)
  "Return the value of TASK if it succeeded, its failure if it failed, and NIL otherwise."
  (check-argument task-result task (task-p task) "a task, as begin-plan returns")
  (and (task-over-p task) (task-value task)))

(addition task-children)
(defun task-children (task)
  "Return a list of the parts of TASK that are not over, oldest first."
  (check-argument task-children task (task-p task) "a task, as begin-plan returns")
  (loop with children = '()
        for child = (task-newest-child task) then (task-older child)
        while child do (push child children)
        finally (return children)))

(addition task-top)
(defun task-top (task)
  "Return the top-level task around TASK, or TASK if it is a top-level task itself."
  (check-argument task-top task (task-p task) "a task, as begin-plan returns")
  (loop while (task-parent task)
        do (setf task (task-parent task)))
  task)

(defun lineage (task)
  "Return a list of TASK and the tasks around it, innermost first."
  (loop for each = task then (task-parent each)
        while each collect each))

(defun frame-chain (frame)
  "Return a list of FRAME and the frames around it in the same task, innermost first."
  (loop for each = frame then (frame-up each)
        while each collect each))

(defun frames-around (task &optional (frame (task-frame task)))
  "Return a list of frames, innermost first: those of TASK from FRAME on, and of tasks around TASK."
  (nconc (frame-chain frame)
         (mapcan (lambda (whole) (frame-chain (task-frame whole))) (rest (lineage task)))))

(defun part-of-p (task whole)
  "True if TASK is WHOLE or a part of WHOLE."
  (loop for each = task then (task-parent each)
        while each thereis (eq each whole)))

(defun evaporating-p (task)
  "True if TASK, or a task around it, is evaporating."
  (loop for each = task then (task-parent each)
        while each thereis (task-ending-p each)))

(defun under-way-p (task)
  "True if TASK has been started and is not over."
  (not (or (task-over-p task) (eq (task-state task) :created))))

(defgeneric current-form (node frame)
  (:documentation "Return the source of the expression that FRAME, a frame of NODE, is running.")
  (:method (node frame)
    (declare (ignore frame))
    (node-form node)))

;; A body is at the expression that one of its steps runs; a call that the body of another is at
;; runs that body anew.
(defun frames-by-expression (frame)
  "Return FRAME and the frames around it in the same task, innermost first, as a list of lists. The
frames in one list run the same expression."
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
  "Return a list of the expressions that FRAME and the frames around it run, innermost first."
  (loop for (each) in (frames-by-expression frame)
        collect (current-form (frame-node each) each)))

(addition task-form)
(defun task-form (task)
  "Return the source of the expression that TASK is running."
  (check-argument task-form task (task-p task) "a task, as begin-plan returns")
  (let ((frame (task-frame task)))
    (if frame
        (current-form (frame-node frame) frame)
        (node-form (task-node task)))))

(defun object-text (object)
  "Return the printed text of OBJECT, or a part of the text if OBJECT takes long to print."
  (if (typep object '(or cons string bit-vector number symbol))
      (unqualified-text object)
      (prin1-to-string object)))

(defun form-text (form &optional (width 60) (length 8) (level 4))
  "Return the text of FORM, any object, on one line of at most WIDTH characters. The text has at
most LENGTH elements of each list, lists to the depth LEVEL, and symbols without their packages."
  (let ((*print-case* :downcase) (*print-pretty* nil) (*print-readably* nil)
        (*print-length* length) (*print-level* level) (*print-base* 10) (*print-radix* nil))
    (cut (substitute #\Space #\Newline
                     (handler-case (object-text form)
                       ((or error storage-condition) () "an object that cannot be printed")))
         width)))

(defmethod print-object ((node node) stream)
  (print-unreadable-object (node stream :type t)
    (write-string (form-text (node-form node) 40) stream)))

(defun whole-form-text (form)
  "Return the complete text of FORM on one line, unless it is longer than a page."
  (form-text form 3000 200 20))

(defun task-label (task &optional (text (lambda (form) (form-text form 40))))
  "Return a short text for TASK: its name, or the value of the function TEXT for its expression."
  (let ((name (task-name task)))
    (cond ((null name) (funcall text (node-form (task-node task))))
          ((and (symbolp name) (< (length (symbol-name name)) 100)) (string-downcase name))
          (t (string-downcase (safe-text name :escape nil))))))

(addition task-path)
(defun task-path (task)
  "Return a list of the labels of the tasks from the top of the plan to TASK."
  (reverse (mapcar #'task-label (lineage task))))

;; A request of any task counts as one of the whole plan.
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
  "Remove CHILD from its parent's children. CHILD keeps the reference to its parent."
  (let ((older (task-older child))
        (newer (task-newer child)))
    (if newer
        (setf (task-older newer) older)
        (setf (task-newest-child (task-parent child)) older))
    (when older (setf (task-newer older) newer))
    (setf (task-older child) nil
          (task-newer child) nil)))
