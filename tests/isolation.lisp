;;;; isolation.lisp -- each test starts from the state after the tests were loaded.

(in-package :ars-magna.tests)

;;; A test has a message queue of its own. After it, definitions, variables, names, runs and robots
;;; are set back. Variables are set back, not bound, because the threads of a test share them.

;;; Variables.

(defun layers ()
  "Return the list of the project's packages, those of tests left out."
  (remove-if-not (lambda (package)
                   (and (eql 0 (search "ARS-MAGNA." (package-name package)))
                        (not (eql 0 (search "ARS-MAGNA.TESTS" (package-name package))))))
                 (list-all-packages)))

(defun settable-variables-now ()
  "Return the variables that others than their own layer may set, and those that a run binds."
  (append '(definitions::*noise-before-cleaning* cli::*prompt-robot* cli::*aliases*)
          run:*simulation-variables*
          (loop for package in (layers)
                append (loop for symbol being the external-symbols of package
                             when (and (eq package (symbol-package symbol))
                                       (eq :special (sb-cltl2:variable-information symbol)))
                               collect symbol))))

(defvar *settable-variables* '() "What SETTABLE-VARIABLES-NOW has returned.")

(defun settable-variables ()
  "Return SETTABLE-VARIABLES-NOW, which is looked for once."
  (or *settable-variables* (setf *settable-variables* (settable-variables-now))))

(defun call-keeping-variables (function)
  "Call FUNCTION and set back the variables that it has set."
  (let* ((variables (remove-if-not #'boundp (settable-variables)))
         (values (mapcar #'symbol-value variables)))
    (unwind-protect (funcall function)
      (loop for variable in variables
            for value in values
            unless (eq value (symbol-value variable))
              do (setf (symbol-value variable) value)))))

;;; Names.

(defun names-in (package)
  "Return the list of the symbols present in PACKAGE."
  (loop for symbol being the present-symbols of package collect symbol))

(defun call-keeping-names (function package)
  "Call FUNCTION. Afterwards PACKAGE has the same symbols as before."
  (let ((names (names-in package)))
    (unwind-protect (funcall function)
      (dolist (new (set-difference (names-in package) names)) (unintern new package))
      (import (set-difference names (names-in package)) package))))

;;; Worlds.

(defun resident-worlds ()
  (loop for map in (world:all-maps)
        when (world:map-resident map) collect it))

;; A run whose plans were not ended would leave them with the robot, to end with a later run of it.
(defun stop-run (timeline)
  "Stop the clock of TIMELINE. If plans take part in its run, end the run, and so the plans."
  (time:stop-pacing timeline)
  (let ((run (time:timeline-run timeline)))
    (when (and run (run:simulation-participants run))
      (run:end-simulation run "the test that started it has ended"))))

(defun stop-all ()
  "End what runs live in resident worlds, and its plans."
  (when driver::*default-interface* (driver::close-interface driver::*default-interface*))
  (dolist (world (resident-worlds))
    (when (world:world-timeline world) (stop-run (world:world-timeline world)))))

(defun renew-world (world)
  "Make the resident WORLD as if nothing had ever happened in it."
  (world:reset-world world :seed 0)
  (when (world:world-timeline world)
    (setf (world:world-timeline world)
          (time:make-timeline (world:map-name (world:world-map world))))))

;;; All of it.

(defun call-in-own-worlds (function)
  "Call FUNCTION. Afterwards undo its definitions, stop its runs, and renew the worlds."
  (unwind-protect (base:with-own-definitions ()
                    (unwind-protect (funcall function)
                      (stop-all)))
    (mapc #'renew-world (resident-worlds))))

(defun call-isolated (function)
  "Call FUNCTION, a test, and undo all that it changed. Return its value."
  (let ((base:*message-queue* (base:make-message-queue)))
    (call-keeping-names
     (lambda ()
       (call-keeping-variables
        (lambda () (call-in-own-worlds function))))
     :ars-user)))
