;;;; environments.lisp -- what a run has bound for those who work in it.

(in-package :ars-magna.run)

(export '(environment-of note-environment fork-p *simulation-variables*))

;;; Robots' names, and what *SIMULATION-VARIABLES* lists, are bound by WITH-SIMULATION; for a live
;;; run they are global. A fork keeps their values, and they are bound while somebody works in it.

(defvar *simulation-variables* '()
  "Symbols that a headless simulation binds, to the values they have, so that what is set in it
ends with it and simulations side by side do not meet.")

(pushnew '*simulation-variables* *kept-variables*)

;; What CLEAN-SIMULATION has changed goes with the parameters of the run.
(pushnew '*noise-before-cleaning* *simulation-variables*)

(defun fork-p (simulation)
  "True if SIMULATION is a fork of another."
  (timeline-fork-p (simulation-timeline simulation)))

(defun environment-here (simulation)
  "Return a list (symbol . value) of what the variables of SIMULATION are here."
  (let ((value-of (if (or (headless-p simulation) (eq simulation *simulation*))
                      #'symbol-value
                      #'global-value)))
    (loop for symbol in (or (simulation-variables simulation)
                            (append (mapcar #'robot-name (simulation-robots simulation))
                                    *simulation-variables*))
          when (boundp symbol)
            collect (cons symbol (funcall value-of symbol)))))

;;; A live run that is started inside of WITH-SIMULATION is current there only. When that ends, the
;;; one that is current outside has its variables again.

(defvar *outer-globals* nil
  "In a headless simulation, a list. Its rest is (run (symbol . value)...): the live run that is
current outside and what *SIMULATION-VARIABLES* were before another was started here; or ().")

(defun note-outer-globals (simulation)
  "Note what *SIMULATION-VARIABLES* are globally, if SIMULATION is about to set them inside of a
headless one while another live run is current outside."
  (let ((current (global-value '*simulation*)))
    (when (and *outer-globals*
               (null (rest *outer-globals*))
               current
               (live-p current)
               (not (eq current simulation)))
      (setf (rest *outer-globals*)
            (cons current (loop for symbol in *simulation-variables*
                                collect (cons symbol (global-value symbol))))))))

(defun restore-outer-globals ()
  "Set *SIMULATION-VARIABLES* globally to what they were before a live run was started in here."
  (destructuring-bind (&optional run &rest values) (rest *outer-globals*)
    (when (and run (eq run (global-value '*simulation*)))
      (loop for (symbol . value) in values
            do (setf (global-value symbol) value)))))

(defun publish-variables (simulation)
  "Let all threads of the live SIMULATION see what *SIMULATION-VARIABLES* are here, where a headless
simulation around it may have bound them."
  (when (live-p simulation)
    (note-outer-globals simulation)
    (dolist (symbol *simulation-variables*)
      (setf (global-value symbol) (symbol-value symbol)))))

(defun note-environment (simulation)
  "Let SIMULATION, in which this thread works, know what its variables are."
  (setf (simulation-environment simulation) (environment-here simulation))
  (publish-variables simulation))

(defun environment-of (simulation)
  "Return a list (symbol . value) of the variables of SIMULATION, wherever this is called. It has
the dice that SIMULATION was loaded with, if any."
  (or (and (headless-p simulation)
           (not (eq simulation *simulation*))
           (simulation-environment simulation))
      (let ((environment (environment-here simulation)) (dice (simulation-dice simulation)))
        (if (and dice (not (assoc *lisps-dice* environment)))
            (acons *lisps-dice* dice environment)
            environment))))

(defun take-up-environment (simulation)
  "Set the variables of SIMULATION, to which this thread comes back, to what they have become."
  (when (headless-p simulation)
    (loop for (symbol . value) in (simulation-environment simulation)
          do (unless (eq value (symbol-value symbol)) (setf (symbol-value symbol) value)))))

(defun call-in-environment (simulation function)
  "Call FUNCTION with the variables of SIMULATION, in which this thread does not work, bound. Store
their last values in SIMULATION, or globally if that is live."
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

(defun call-elsewhere (simulation function)
  "Call FUNCTION with the parameters and variables of SIMULATION, which is not the current one."
  (let ((around *simulation*))
    (when around (note-environment around))
    (in-any-case
      (call-with-parameter-values (simulation-known-parameters simulation)
                                  (lambda () (call-in-environment simulation function)))
      (when around (take-up-environment around)))))

(defun call-inside (simulation function)
  "Call FUNCTION where SIMULATION is the current one: with its world, its message queue and, if it
is not the current one out here, its parameters and, of a fork, its variables."
  (flet ((call ()
           (let ((*simulation* simulation)
                 (*world* (simulation-world simulation))
                 (*message-queue* (simulation-messages simulation))
                 (*tick-dice* nil))
             (funcall function))))
    (declare (dynamic-extent #'call))
    (if (eq simulation *simulation*)
        (call)
        (call-elsewhere simulation #'call))))
