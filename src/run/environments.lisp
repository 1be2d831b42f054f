;;;; environments.lisp -- the variables that a run binds for code that works in it.

(in-package :ars-magna.run)

(export '(environment-of store-environment fork-p *simulation-variables*))

;;; Robots' names and the *SIMULATION-VARIABLES* are bound by WITH-SIMULATION; for a live run they
;;; are global. A fork keeps their values, and they are bound while code works in it.

(defvar *simulation-variables* '()
  "The symbols that a headless simulation binds to their current values. So assignments in the
simulation are undone at its end and do not affect other simulations.")

(pushnew '*simulation-variables* *variables-to-restore*)

;; CLEAN-SIMULATION sets it together with the parameters of the run.
(pushnew '*noise-before-cleaning* *simulation-variables*)

(defun fork-p (simulation)
  "True if SIMULATION is a fork of another simulation."
  (timeline-fork-p (simulation-timeline simulation)))

(defun environment-in-this-thread (simulation)
  "Return an alist from the variables of SIMULATION to their values in this thread; from the names
of its robots to the robots, if SIMULATION is not the current one here."
  (let ((robots (simulation-robots simulation)) (current (eq simulation *simulation*)))
    (loop for symbol in (or (simulation-variables simulation)
                            (append (mapcar #'robot-name robots) *simulation-variables*))
          for robot = (and (not current) (find symbol robots :key #'robot-name :test #'eq))
          when (boundp symbol)
            collect (cons symbol (cond (robot)
                                       ((or current (headless-p simulation)) (symbol-value symbol))
                                       (t (global-value symbol)))))))

;;; A live run that is started inside WITH-SIMULATION is current there only. At the end, the
;;; variables of the one that is current outside are restored.

(defvar *saved-outer-globals* nil
  "In a headless simulation, a list. Its REST is empty until a live run is started in the simulation
while another live run is current outside. Then REST is (run (symbol . value)...): the outer run,
and the values of *SIMULATION-VARIABLES* in the outer run.")

(defun save-outer-globals (simulation)
  "SIMULATION is about to set the global values of *SIMULATION-VARIABLES*. Save the old values if
SIMULATION was started in a headless simulation while another live run is current outside."
  (let ((current (global-value '*simulation*)))
    (when (and *saved-outer-globals*
               (null (rest *saved-outer-globals*))
               current
               (live-p current)
               (not (eq current simulation)))
      (setf (rest *saved-outer-globals*)
            (cons current (loop for symbol in *simulation-variables*
                                collect (cons symbol (global-value symbol))))))))

(defun restore-outer-globals ()
  "Restore the global values of *SIMULATION-VARIABLES* that SAVE-OUTER-GLOBALS has saved, if any."
  (destructuring-bind (&optional run &rest values) (rest *saved-outer-globals*)
    (when (and run (eq run (global-value '*simulation*)))
      (loop for (symbol . value) in values
            do (setf (global-value symbol) value)))))

(defun set-variables-globally (simulation)
  "If SIMULATION is live, set the global values of *SIMULATION-VARIABLES*, which all its threads
see, to the values in this thread. If SIMULATION was started in a headless simulation, the variables
are bound in this thread."
  (when (live-p simulation)
    (save-outer-globals simulation)
    (dolist (symbol *simulation-variables*)
      (setf (global-value symbol) (symbol-value symbol)))))

(defun store-environment (simulation)
  "Store the current values of SIMULATION's variables in SIMULATION, where this thread works."
  (setf (simulation-environment simulation) (environment-in-this-thread simulation))
  (set-variables-globally simulation))

(defun environment-of (simulation)
  "Return an alist from the variables of SIMULATION to their values. Any thread may call this. The
alist includes the dice that SIMULATION was loaded with, if any."
  (or (and (headless-p simulation)
           (not (eq simulation *simulation*))
           (simulation-environment simulation))
      (let ((environment (environment-in-this-thread simulation))
            (dice (simulation-dice simulation)))
        (if (and dice (not (assoc *random-state-variable* environment)))
            (acons *random-state-variable* dice environment)
            environment))))

(defun restore-environment (simulation)
  "This thread returns to SIMULATION. Set the variables to their values stored in SIMULATION."
  (when (headless-p simulation)
    (loop for (symbol . value) in (simulation-environment simulation)
          do (unless (eq value (symbol-value symbol)) (setf (symbol-value symbol) value)))))

(defun call-in-environment (simulation function)
  "Call FUNCTION with the variables of SIMULATION bound. This thread does not work in SIMULATION.
Store the last values of the variables in SIMULATION, or globally if SIMULATION is live."
  (let* ((environment (environment-of simulation)) (symbols (mapcar #'car environment)))
    (progv symbols (mapcar #'cdr environment)
      (in-any-case
        (funcall function)
        (if (headless-p simulation)
            (setf (simulation-environment simulation)
                  (loop for symbol in symbols collect (cons symbol (symbol-value symbol))))
            (loop for (symbol . value) in environment
                  do (unless (eq value (symbol-value symbol))
                       (setf (global-value symbol) (symbol-value symbol)))))))))

(defun call-in-other-run (simulation function)
  "Call FUNCTION with the parameters and variables of SIMULATION, which is not the current run."
  (let ((around *simulation*))
    (when around (store-environment around))
    (in-any-case
      (call-with-parameter-values (simulation-known-parameters simulation)
                                  (lambda () (call-in-environment simulation function)))
      (when around (restore-environment around)))))

(defun call-in-simulation (simulation function)
  "Call FUNCTION with SIMULATION as the current simulation, with its world and message queue. If
another simulation was current, also bind the parameters and variables of SIMULATION."
  (flet ((call ()
           (let ((*simulation* simulation)
                 (*world* (simulation-world simulation))
                 (*message-queue* (simulation-messages simulation))
                 (*tick-dice* nil))
             (funcall function))))
    (declare (dynamic-extent #'call))
    (if (eq simulation *simulation*)
        (call)
        (call-in-other-run simulation #'call))))

(defmethod call-in-run-of ((simulation simulation) function)
  (call-in-simulation simulation function))

(defmethod call-in-run-of ((robot robot) function)
  (let ((simulation (world-simulation (robot-world robot))))
    (if simulation
        (call-in-simulation simulation function)
        (funcall function))))
