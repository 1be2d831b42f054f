;;;; task.lisp -- nodes, frames and tasks: the parts of a running plan.

(in-package :ars-magna.rpl.tasks)

(export '(current-form form-text whole-form-text forms-under-way frame-runs frame frame-state
          make-frame make-task node task-label evaporating-p part-of-p lineage frame-chain
          frames-around under-way-p frame-p))

;;; A plan is a graph of nodes, its expressions. A task runs one of them as a chain of frames, the
;;; innermost of which is the task's own FRAME. All state of a task is in its frames and their
;;; environments, on the heap. Children of a task exist only while its innermost frame is that of a
;;; construct that waits for them.
;;;
;;; An environment is a vector: element 0 is the environment around it, the others are variables.

(define-record (node (:constructor nil))
  "An expression of a plan."
  (form nil t "the source of the expression that the node stands for" :writable :export)
  (names '() list "the names of the variables that the node sees: a list for each level, innermost
first" :writable :export)
  (states #() simple-vector "the names of what a frame may be in" :writable)
  (step #'list function "the function of the node, task, frame and the value of the inner expression
that has ended, which returns the frame to go on with and a value for it" :writable)
  (unwind nil (or null function) "the function of the same arguments, but a signal, that is called
when a signal passes the frame, or NIL. It returns a frame that handles it, or NIL and, if
another signal is to go on instead, that" :writable)
  (child-ended nil (or null function) "the function of node, task, frame, child, the child's state
and its result, or NIL" :writable)
  (sharing :unknown (member :unknown :shared :per-run)
         "whether forks of a run share it, once that is known" :writable))

(declaim (inline make-frame))
(define-record (frame (:constructor make-frame (node environment up)))
  "One run of NODE, in ENVIRONMENT, on behalf of the frame UP or of none."
  (node nil node "the node that the frame runs" :writable :export)
  (environment #() simple-vector "the vector of the variables that the node sees, and of those
around it" :writable :export)
  (up nil (or null frame) "the frame that gets the value, or NIL" :writable :export)
  (counter 0 fixnum
           "the number of the state that the frame is in: see FRAME-STATE" :writable :export)
  (data nil t "what the frame has to remember: in DEFINE-EXPRESSION, its MEMORY" :writable :export))

(defun frame-state (frame)
  "Return the state of FRAME, a keyword; if its node has no states, the number of parts begun."
  (let ((states (node-states (frame-node frame))))
    (if (plusp (length states))
        (svref states (frame-counter frame))
        (frame-counter frame))))

(addition task task-p)
(define-record (task (:constructor make-task (name node)
                     "Return a task by name and node that has not started: see SPAWN."))
  "One incarnation of a plan's expression."
  (name nil t "what the task is called: its tag, its procedure, or NIL" :writable :addition)
  (node nil node "the expression that it runs" :writable)
  (runner nil t "the plan runner that the task belongs to" :writable :export)
  (serial 0 fixnum "the number of the task within its plan runner" :writable :addition)
  (state :created keyword "the task's state: :created, :ready, :running, :waiting, and when it is
over :succeeded, :failed or :evaporated" :writable :addition)
  (ending-p nil boolean "true if the task is to evaporate" :writable :export)
  (level 0 (integer 0 7) "the level of the task: 0 for the plan proper, for a policy one above what
it guards" :writable :export)
  (index 0 fixnum
         "which of the parts of the task around it the task is, from 0 on" :writable :export)
  (frame nil (or null frame) "the innermost frame of the task, NIL if it is over" :writable :export)
  (value nil t "the value with which its innermost frame goes on" :writable)
  (signal nil t "what will happen to the task instead of going on, or NIL" :writable :export)
  (awaiting nil t "what the task waits for: a watcher, a timer, a valve, a text; or
NIL" :writable :export)
  (since 0 real "the tick at which the task began to wait, or did so last" :writable :addition)
  (timer nil (or null timer)
         "the timer that ends the task's wait at the latest, or NIL" :writable :export)
  (cleaning '() list "the frames of the task that clean up, innermost first" :writable :export)
  (blocked 0 fixnum "how many blocks keep it from running" :writable)
  (round 0 fixnum "in which round of its plan runner it used its slice last" :writable)
  (slice 0 fixnum "how many steps it may still take in that round" :writable)
  (result nil t
          "the value of a task that succeeded, the failure of one that failed" :writable :addition)
  (status-fluent nil (or null fluent) "the fluent that follows the task's status, or NIL: see
TASK-STATUS" :writable :export)
  (parent nil (or null task)
          "the task that the task is part of, or NIL" :writable :addition)
  (suspensions 0 fixnum "how many of its blocks are suspensions" :writable)
  (suspended nil boolean "true if SUSPEND is one of them" :writable)
  (uncounted-p nil boolean "the task's steps are not charged for, as what it does has a
price" :writable :export)
  (gate nil t "what it waits for before it starts, or NIL" :writable)
  (variables '() list "the task variables that it has set, an alist" :writable)
  (newest-child nil (or null task) "that part of the task which started last of those not over, or
NIL" :writable :export)
  (older nil (or null task)
         "the part of the same task that started before the task, or NIL" :writable :export)
  (newer nil (or null task) :writable))
(declaim-final frame task)

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
  "Return the frames of TASK from FRAME on, and those of the tasks around it, innermost first."
  (nconc (frame-chain frame)
         (mapcan (lambda (whole) (frame-chain (task-frame whole))) (rest (lineage task)))))

(defun part-of-p (task whole)
  "True if TASK is WHOLE or a part of it."
  (loop for each = task then (task-parent each)
        while each thereis (eq each whole)))

(defun evaporating-p (task)
  "True if TASK, or what it is part of, is evaporating."
  (loop for each = task then (task-parent each)
        while each thereis (task-ending-p each)))

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
  "Return the expressions that FRAME, and the frames up from it, are at, innermost first."
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

(defun object-text (object)
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
                     (handler-case (object-text form)
                       ((or error storage-condition) () "an object that cannot be printed")))
         width)))

(defmethod print-object ((node node) stream)
  (print-unreadable-object (node stream :type t)
    (write-string (form-text (node-form node) 40) stream)))

(defun whole-form-text (form)
  "Return FORM on one line as it is, unless it is longer than a page."
  (form-text form 3000 200 20))

(defun task-label (task &optional (text (lambda (form) (form-text form 40))))
  "Return a short text for TASK: its name, or what the function TEXT returns for its expression."
  (let ((name (task-name task)))
    (cond ((null name) (funcall text (node-form (task-node task))))
          ((and (symbolp name) (< (length (symbol-name name)) 100)) (string-downcase name))
          (t (string-downcase (safe-text name :escape nil))))))

(addition task-path)
(defun task-path (task)
  "Return the labels of the tasks from the top of the plan to TASK."
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
  "Take CHILD out of its parent's children. It still knows its parent."
  (let ((older (task-older child))
        (newer (task-newer child)))
    (if newer
        (setf (task-older newer) older)
        (setf (task-newest-child (task-parent child)) older))
    (when older (setf (task-newer older) newer))
    (setf (task-older child) nil
          (task-newer child) nil)))
