;;;; machine.lisp -- how a task goes on, ends and evaporates.

(in-package :ars-magna.rpl)

;;; A signal is what can happen to a task other than going on: a PLAN-FAILURE; an ESCAPE to an
;;; enclosing node, perhaps of an enclosing task; the word :EVAPORATE; or a COMPLETION, by which
;;; the construct that the task waits in ends well. A signal reaches a task that has children only
;;; when the last of them is gone.

(defstruct (escape (:constructor make-escape (target value)) (:copier nil))
  "A way out to the node TARGET, which knows what to do with VALUE."
  (target nil :type node :read-only t)
  (value nil :read-only t))

(defstruct (completion (:constructor make-completion (value)) (:copier nil))
  "The end of a construct, with VALUE."
  (value nil :read-only t))

(defstruct (bundle (:constructor make-bundle (values)) (:copier nil))
  "Several values on their way from a leaf to whoever wants several."
  (values '() :type list :read-only t))
(declaim (sb-ext:freeze-type escape completion bundle))

(declaim (inline single-value))
(defun single-value (value)
  "Return VALUE, or the first one of a bundle."
  (if (bundle-p value) (first (bundle-values value)) value))

;;; Defining nodes.

(defmacro define-node (name (&rest slots) documentation &key step unwind child-ended)
  "Define the node type NAME, or (NAME PARENT), with SLOTS, each (slot type), and the functions
named for it."
  (destructuring-bind (name &optional (parent 'node)) (ensure-list name)
    `(defstruct (,name (:include ,parent
                        (step #',step)
                        ,@(when unwind `((unwind #',unwind)))
                        ,@(when child-ended `((child-ended #',child-ended))))
                       (:copier nil))
       ,documentation
       ,@(loop for (slot type) in slots
               collect `(,slot (required-slot ',slot) :type ,type)))))

(defun required-slot (slot)
  (reject-use "A plan's node was made without its ~(~A~)." slot))

(define-node leaf ((function function))
  "An expression that cannot wait: FUNCTION takes the environment."
  :step step-leaf)
(declaim (sb-ext:freeze-type leaf))

(defun step-leaf (node task frame value)
  (declare (ignore task value))
  (values (frame-up frame) (funcall (leaf-function node) (frame-environment frame))))

(sb-ext:define-load-time-global +parked+ (make-frame (make-leaf :function #'identity) (vector) nil)
  "What a step returns instead of a frame when its task does not go on now.")

(sb-ext:define-load-time-global +nothing+ (make-leaf :form nil :function (constantly nil))
  "The expression NIL.")

(declaim (inline enter))
(defun enter (node environment frame)
  "Begin NODE in ENVIRONMENT for FRAME: return what a step returns. The next step of FRAME gets
the value. A leaf takes no frame of its own."
  (if (leaf-p node)
      (values frame (funcall (leaf-function node) environment))
      (values (make-frame node environment frame) nil)))

(defun park (task awaiting)
  "Note that TASK, at a step that will return +PARKED+, waits for AWAITING."
  (setf (task-state task) :waiting
        (task-awaiting task) awaiting)
  (note-event task :wait (and awaiting (awaited-text awaiting))))

(defgeneric awaited-text (awaited)
  (:documentation "Return in words what a task that waits for AWAITED waits for.")
  (:method (awaited) (princ-to-string awaited))
  (:method ((fluent fluent)) (fluent-text fluent))
  (:method ((watcher watcher)) (fluent-text (watcher-fluent watcher)))
  (:method ((timer timer))
    (format nil "tick ~A" (timer-due timer))))

(defun wake (task value)
  "Let TASK, which waits, go on with VALUE."
  (setf (task-awaiting task) nil
        (task-value task) value)
  (note-event task :wake)
  (make-ready task))

;;; Ending.

(defun note-status (task state)
  (when (task-status-fluent task)
    (set-value (task-status-fluent task) state)))

(defun finish (task state result &optional (how state))
  "End TASK in STATE with RESULT. HOW says it to the construct that TASK is part of."
  (note-event task (ecase state (:succeeded :succeed) (:failed :fail) (:evaporated :evaporate))
              (and (eq state :failed) (princ-to-string result)))
  (setf (task-state task) state
        (task-result task) result
        (task-frame task) nil
        (task-value task) nil
        (task-signal task) nil)
  (note-status task state)
  (let ((parent (task-parent task)))
    (cond (parent
           (unlink-child task)
           (child-over parent task how result))
          (t (let ((runner (task-runner task)))
               (setf (runner-roots runner) (remove task (runner-roots runner)))
               (funcall (runner-on-end runner) task))))))

(defun child-over (parent child how result)
  "Let PARENT know that its CHILD has ended. Once PARENT has a signal, only the last one matters."
  (cond ((null (task-signal parent))
         (let* ((frame (task-frame parent))
                (node (frame-node frame)))
           (funcall (the function (node-child-ended node)) node parent frame child how result)))
        ((task-newest-child parent))
        ((eq (task-signal parent) :evaporate) (evaporate-now parent))
        (t (make-ready parent))))

(defun decide (parent signal)
  "Let SIGNAL happen to PARENT, which waits for its children, when they are all gone; evaporate
those that are not over."
  (setf (task-signal parent) signal
        (task-awaiting parent) nil)
  (if (task-newest-child parent)
      (evaporate-children parent)
      (make-ready parent)))

(defun complete (parent value)
  "End with VALUE the construct in which PARENT waits for its children."
  (if (task-newest-child parent)
      (decide parent (make-completion value))
      (wake parent value)))

(defun fail-or-escape (task how result)
  "Let TASK fail or be left as its child did that ended as HOW with RESULT. True if it did so."
  (when (member how '(:failed :escaped))
    (decide task result)
    t))

(defun complete-when-alone (task value)
  (unless (task-newest-child task) (complete task value)))

;;; Unwinding.

(defun finish-by-signal (task signal)
  (cond ((eq signal :evaporate) (finish task :evaporated nil))
        ((escape-p signal) (finish task :succeeded signal :escaped))
        (t (finish task :failed signal))))

(defun unwind (task frame signal)
  "Send SIGNAL up from FRAME. Return what a step returns: the frame that takes care of it, or, when
none does and TASK has ended, +PARKED+."
  (loop while frame
        do (let* ((node (frame-node frame))
                  (handler (node-unwind node)))
             (when handler
               (multiple-value-bind (handled next value) (funcall handler node task frame signal)
                 (cond (handled (return-from unwind (values next value)))
                       (next (setf signal next)))))
             (setf frame (frame-up frame))))
  (finish-by-signal task signal)
  +parked+)

(defun receive (task frame signal)
  "Let SIGNAL happen to TASK at FRAME. Return what a step returns."
  (if (completion-p signal)
      (values (frame-up frame) (completion-value signal))
      (unwind task frame signal)))

;;; Evaporating.

(defgeneric withdraw (task awaited)
  (:documentation "Take TASK out of the list of those that wait for AWAITED.")
  (:method (task awaited) (declare (ignore task awaited))))

(defun stop-waiting (task)
  (let ((awaited (shiftf (task-awaiting task) nil))
        (timer (shiftf (task-timer task) nil)))
    (cond ((null awaited))
          ((watcher-p awaited) (unwatch awaited))
          (t (withdraw task awaited)))
    (when timer (cancel-timer timer (runner-timers (task-runner task))))))

(defun release-held (runner)
  "Queue again the tasks that were put aside because they were blocked."
  (dolist (task (nreverse (shiftf (runner-held runner) '())))
    (when (eq (task-state task) :ready) (make-ready task))))

(defun evaporate-now (task)
  "Let TASK, which does not run and has no children, evaporate at once, or start to clean up."
  (let ((queued (eq (task-state task) :ready)))
    (setf (task-signal task) nil)
    (multiple-value-bind (frame value) (unwind task (task-frame task) :evaporate)
      (unless (eq frame +parked+)
        (setf (task-frame task) frame
              (task-value task) value)
        (if queued
            (release-held (task-runner task))
            (make-ready task))))))

(defun evaporate-children (task)
  "Evaporate the children of TASK, newest first."
  (loop for child = (task-newest-child task) then older
        while child
        for older = (task-older child)
        do (evaporate child)))

(defun evaporate (task)
  "End TASK, because it is no longer needed, with all that it consists of, newest first. What it
has protected by EVAP-PROTECT is done first and may take time. A task that has not started, is over
or evaporates already is left alone. Call it only from plans; from elsewhere post it."
  (cond ((or (task-over-p task) (task-doomed task) (eq (task-state task) :created)))
        (t (setf (task-doomed task) t)
           (cond ((task-cleaning task)
                  (setf (frame-data (first (last (task-cleaning task)))) :evaporate))
                 ((eq (task-state task) :running)
                  (setf (task-signal task) :evaporate)
                  (setf (runner-mask (task-runner task))
                        (logior +interrupt+ (runner-mask (task-runner task)))))
                 (t (stop-waiting task)
                    (cond ((task-newest-child task)
                           (setf (task-signal task) :evaporate)
                           (evaporate-children task))
                          (t (evaporate-now task))))))))

;;; Going on.

(defun warn-of-slow-step (task frame seconds)
  (let* ((runner (task-runner task))
         (form (current-form (frame-node frame) frame)))
    (unless (member form (runner-warned runner) :test #'eq)
      (push form (runner-warned runner))
      (warning-set "A plan's Lisp code ran for " (/ (round seconds 0.001) 1000.0)
                   " s without a pause: " (form-text form) " in " (task-label task)))))

(defun timed-step (clock node task frame value)
  "Do the step of NODE; warn if it took long by CLOCK."
  (declare (type function clock))
  (let ((start (funcall clock)))
    (multiple-value-prog1 (funcall (node-step node) node task frame value)
      (let ((seconds (- (funcall clock) start)))
        (when (> seconds (runner-slow (task-runner task)))
          (warn-of-slow-step task frame seconds))))))

(defun evaporate-self (task frame)
  "Let TASK, which has asked for its own end in the step that returned FRAME, evaporate."
  (cond ((not (eq frame +parked+))
         (setf (task-signal task) nil)
         (unwind task frame :evaporate))
        (t (stop-waiting task)
           (if (task-newest-child task)
               (evaporate-children task)
               (evaporate-now task))
           +parked+)))

(defun interrupt (task frame value)
  "Evaporate as asked, or give way to a higher level or because the reaction has taken its steps.
FRAME and VALUE are what the last step returned; return what it should have."
  (let ((runner (task-runner task)))
    (setf (runner-mask runner) (logandc2 (runner-mask runner) +interrupt+))
    (cond ((task-signal task) (evaporate-self task frame))
          ((or (null frame)
               (eq frame +parked+)
               (and (< (runner-mask runner) (ash 2 (task-level task)))
                    (< (runner-steps runner) (runner-pause runner))))
           (values frame value))
          (t (setf (task-frame task) frame
                   (task-value task) value)
             (make-ready-first task)
             +parked+))))

(defun run-steps (task frame value)
  "Let TASK go on from FRAME with VALUE until it waits, gives way or ends."
  (declare #.*hot* (type task task))    ; 15 ns a step beyond what the step does
  (let* ((runner (task-runner task))
         (clock (runner-clock runner))
         (higher (ash 2 (task-level task))))
    (declare (type plan-runner runner))
    (loop
      (when (or (>= (runner-mask runner) higher)
                (>= (runner-steps runner) (runner-pause runner)))
        (multiple-value-setq (frame value) (interrupt task frame value)))
      (cond ((null frame) (return (finish task :succeeded (single-value value))))
            ((eq frame +parked+) (return)))
      (setf (task-frame task) frame)
      (incf (runner-steps runner))
      (let ((node (frame-node frame)))
        (multiple-value-setq (frame value)
          (if clock
              (timed-step clock node task frame value)
              (funcall (node-step node) node task frame value)))))))

(defun run-task (task)
  "Let TASK, just taken from the ready ones, go on, or let its signal happen to it."
  (let ((frame (task-frame task))
        (value (shiftf (task-value task) nil))
        (signal (task-signal task)))
    (setf (task-state task) :running
          (runner-current (task-runner task)) task)
    (when signal
      (setf (task-signal task) nil)
      (multiple-value-setq (frame value) (receive task frame signal)))
    (run-steps task frame value)))

(defun spawn (parent node environment index level &optional (task (make-task nil node)))
  "Start TASK, the part number INDEX of PARENT (NIL: a top-level task), to run NODE in ENVIRONMENT.
Return it."
  (let ((runner (if parent (task-runner parent) *runner*)))
    (setf (task-runner task) runner
          (task-serial task) (incf (runner-serial runner))
          (task-level task) (min level (1- +levels+))
          (task-index task) index
          (task-frame task) (make-frame node environment nil))
    (when parent (link-child task parent))
    (note-event task :start)
    (note-status task :running)
    (make-ready task)
    task))
