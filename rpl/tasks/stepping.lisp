;;;; stepping.lisp -- how a task starts and runs step by step, and waits until another is at rest.

(in-package :ars-magna.rpl.tasks)

(export '(tell-at-rest spawn))

;;; A task that tells another something by a pulse must not do so before the other waits for it. So
;;; the teller gives way until the hearer rests: until the hearer waits, is over, is kept from
;;; running, or has used its slice.

(defstruct (courtesy (:constructor make-courtesy (hearer teller function)) (:copier nil))
  "That the task TELLER does not go on before FUNCTION has been called, which is when the task
HEARER has come to rest."
  (hearer nil :type task :read-only t)
  (teller nil :type task :read-only t)
  (function nil :type function :read-only t))

(defmethod awaited-text ((courtesy courtesy))
  (format nil "task ~D to come to rest" (task-serial (courtesy-hearer courtesy))))

(defun at-rest-p (task runner)
  (case (task-state task)
    (:running nil)
    (:ready (or (spent-p task runner) (blocked-p task)))
    (t (not (courtesy-p (task-awaiting task))))))

(defun tell-at-rest (hearer function)
  "Call FUNCTION, which lets the task HEARER hear something, now, if that is at rest or there is
none. Otherwise do so as soon as it is, and let the task at work give way until then."
  (let* ((runner *runner*)
         (teller (running-task runner)))
    (cond ((or (null hearer) (null teller) (eq hearer teller)
               (not (eq runner (task-runner hearer)))
               ;; Live, answers come in meanwhile, and who gives way could miss its own.
               (funcall (runner-attended-p runner))
               (at-rest-p hearer runner))
           (funcall function))
          (t (settle-all (remove teller (runner-courtesies runner)
                                 :key #'courtesy-hearer :test-not #'eq)
                         runner)
             (setf (runner-courtesies runner)
                   (append (runner-courtesies runner)
                           (list (make-courtesy hearer teller function)))
                   (runner-mask runner) (logior +interrupt+ (runner-mask runner)))))))

(defun give-way-to-hearer (task frame value)
  "Make TASK wait, to continue with FRAME and VALUE, if it must report something first. True if so."
  (let ((courtesy (find task (runner-courtesies (task-runner task)) :key #'courtesy-teller)))
    (when courtesy
      (park task courtesy)
      (setf (task-frame task) frame
            (task-value task) value))))

(defun settle (courtesy)
  (let ((teller (courtesy-teller courtesy)))
    (call-user-code (courtesy-function courtesy) "what a plan is told")
    (when (eq courtesy (task-awaiting teller))
      (wake teller (task-value teller)))))

(defun settle-all (courtesies runner)
  (when courtesies
    (setf (runner-courtesies runner)
          (remove-if (lambda (courtesy) (member courtesy courtesies)) (runner-courtesies runner)))
    (mapc #'settle courtesies)
    t))

(defun settle-courtesies (runner)
  (settle-all (remove-if-not (lambda (courtesy) (at-rest-p (courtesy-hearer courtesy) runner))
                             (runner-courtesies runner))
              runner))

;;; Before each step a task yields to a ready task of a higher level, so that a policy reacts to the
;;; last step before the next one is taken.

(defun warn-of-slow-step (task frame seconds)
  (let ((form (current-form (frame-node frame) frame)))
    (when (first-warning-p form (task-runner task))
      (warning-set "A plan's Lisp code ran for " (/ (round seconds 0.001) 1000.0)
                   " s without a pause: " (form-text form) " in " (task-label task)))))

(defun time-now (runner)
  "Return the seconds by the clock of RUNNER, or NIL without one."
  (let ((clock (runner-clock runner)))
    (and clock (funcall clock))))

(defun timed-step (start node task frame value)
  (let ((runner (task-runner task)))
    (setf (runner-looked-at runner) nil)
    (multiple-value-prog1 (funcall (node-step node) node task frame value)
      (let ((seconds (- (or (time-now runner) start) start)))
        (when (and (> seconds (runner-slow runner)) (not (runner-looked-at runner)))
          (warn-of-slow-step task frame seconds))))))

(defun call-offering-again (frame function)
  "Call FUNCTION, which takes a step at FRAME, with the restart RETRY, which takes it again."
  (let ((counter (frame-counter frame))
        (data (frame-data frame)))
    (loop
      (restart-case (return (funcall function))
        (retry ()
          :test (lambda (condition)
                  (declare (ignore condition))
                  (not *in-leaf-p*))
          :report (lambda (stream)
                    (format stream "Do ~A again."
                            (form-text (current-form (frame-node frame) frame))))
          (setf (frame-counter frame) counter
                (frame-data frame) data))))))

(defun watched-step (node task frame value)
  "Do the step of NODE as RUN-STEPS would, for whoever measures, goes through plans step by step, or
may look into errors."
  (let* ((runner (task-runner task))
         (stepper (runner-stepper runner)))
    (flet ((take ()
             (let ((start (time-now runner)))
               (if start
                   (timed-step start node task frame value)
                   (funcall (node-step node) node task frame value)))))
      (declare (dynamic-extent #'take))
      (when stepper (funcall stepper task frame))
      ;; A leaf offers the same, and a value in its place.
      (if (and *leaves-offer-restarts* (not (leaf-p node)))
          (call-offering-again frame #'take)
          (take)))))

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
  "Evaporate as asked, or give way to a higher level or because TASK has taken its steps. FRAME and
VALUE are what the last step returned; return what it should have."
  (when (runner-doomed (task-runner task)) (end-doomed (task-runner task)))
  (let* ((runner (task-runner task))
         (mask (logandc2 (runner-mask runner) +interrupt+))
         (preempted (>= mask (ash 2 (task-level task))))
         (spent (>= (runner-steps runner) (runner-pause runner)))
         (kept (and (plusp (runner-blocks runner)) (blocked-p task))))
    (setf (runner-mask runner) mask)
    (cond ((task-signal task) (evaporate-self task frame))
          ((or (null frame) (eq frame +parked+)) (values frame value))
          ((and (runner-courtesies runner) (give-way-to-hearer task frame value)) +parked+)
          ((not (or preempted spent kept)) (values frame value))
          (t (setf (task-frame task) frame
                   (task-value task) value)
             (if (and preempted (not kept)) (make-ready-first task) (make-ready task))
             +parked+))))

(defun run-steps (task frame value)
  "Run TASK from FRAME with VALUE until it waits, yields or ends."
  (declare #.*hot* (type task task))    ; 15 ns a step beyond what the step does
  (let* ((runner (task-runner task))
         (watched (or (time-now runner) (runner-stepper runner) *leaves-offer-restarts*))
         (higher (ash 2 (task-level task))))
    (declare (type plan-runner runner))
    (loop
      (when (or (>= (runner-mask runner) higher)
                (>= (runner-steps runner) (runner-pause runner))
                (runner-doomed runner))
        (multiple-value-setq (frame value) (interrupt task frame value)))
      (cond ((null frame) (return (finish task :succeeded (single-value value))))
            ((eq frame +parked+) (return)))
      (setf (task-frame task) frame)
      (incf (runner-steps runner))
      (let ((node (frame-node frame)))
        (multiple-value-setq (frame value)
          (if watched
              (watched-step node task frame value)
              (funcall (node-step node) node task frame value)))))))

(defun begin-turn (task runner)
  "Give TASK what is left of its slice in this round of RUNNER, a new one if it has had none."
  (declare #.*hot* (type task task) (type plan-runner runner))
  (unless (= (task-round task) (runner-round runner))
    (setf (task-round task) (runner-round runner)
          (task-slice task) (runner-slice runner)))
  (let ((slice (+ (runner-steps runner) (max 0 (task-slice task)))))
    (setf (runner-pause runner)
          (if (task-uncounted-p task) slice (min (runner-limit runner) slice)))))

(defun run-task (task)
  "Run TASK, just taken from the ready ones, or deliver its signal."
  (let* ((frame (task-frame task))
         (value (shiftf (task-value task) nil))
         (signal (task-signal task))
         (runner (task-runner task))
         (start (runner-steps runner)))
    (setf (task-state task) :running
          (runner-current runner) task)
    (begin-turn task runner)
    (let ((*asker* task))
      (when signal
        (setf (task-signal task) nil)
        (multiple-value-setq (frame value) (receive task frame signal)))
      (run-steps task frame value))
    (let ((taken (- (runner-steps runner) start)))
      (decf (task-slice task) taken)
      (when (task-uncounted-p task) (give-back runner taken)))))

(defun check-room (runner)
  (unless (< (runner-alive runner) *plan-task-limit*)
    (if (running-task runner)
        (fail :class :too-many-tasks :limit *plan-task-limit*)
        (reject-use "There are ~D tasks of plans under way; see *PLAN-TASK-LIMIT*."
                    (runner-alive runner)))))

(defun spawn (parent node environment index level &optional (task (make-task nil node)))
  "Start TASK, the part number INDEX of PARENT (NIL: a top-level task), to run NODE in ENVIRONMENT.
Return it."
  (let ((runner (if parent (task-runner parent) *runner*)))
    (check-room runner)
    (incf (runner-alive runner))
    (setf (task-runner task) runner
          (task-serial task) (incf (runner-serial runner))
          (task-level task) (min level (1- +levels+))
          (task-node task) node
          (task-index task) index
          (task-frame task) (make-frame node environment nil))
    (when parent
      (link-child task parent)
      (when (task-uncounted-p parent) (setf (task-uncounted-p task) t)))
    (incf (runner-blocks runner) (task-blocked task))
    (note-event task :start (task-name task) (and parent (task-serial parent)))
    (note-status task :running)
    (make-ready task)
    task))
