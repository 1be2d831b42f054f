;;;; rewinding.lisp -- what is asked of plans from outside, done again where a run is rewound.

(in-package :ars-magna.rpl-robot)

;;; Plans do by themselves what they did. That they were begun and ended, and that somebody else set
;;; their fluents, is in no journal; the run remembers it, if it is one that can be rewound.

(defun find-task-below (serial tasks)
  "Return the task with the number SERIAL among TASKS and their parts, or NIL."
  (loop for task in tasks
          thereis (if (eql serial (task-serial task))
                      task
                      (find-task-below serial (task-children task)))))

(defun react-again ()
  "Let plans react between two ticks, as they did then."
  (let ((interface (usable-interface)))
    (when interface
      (with-plans (interface) (react-fully interface)))))

(defun end-again (serial)
  "End the task with the number SERIAL, or all plans if that is NIL, as somebody did then."
  (let* ((interface (usable-interface))
         (task (and interface serial (find-task-below serial (tasks-of interface)))))
    (when (and interface (or task (null serial)))
      (end-in interface task))))

(defun note-of-plans (interface function &rest arguments)
  "Let the run of INTERFACE remember that FUNCTION of ARGUMENTS does again what is done here."
  (apply #'note-doing (interface-simulation interface) function arguments))

(defun name-of-fluent (fluent)
  "Return how a fluent variable leads to FLUENT: a list of that and, if it holds a vector, the
index; or else FLUENT."
  (loop for (variable) in *fluent-variables*
        for value = (symbol-value variable)
        for index = (and (vectorp value) (position fluent value :test #'eq))
        when (or (eq fluent value) index)
          return (list variable index)
        finally (return fluent)))

(defun fluent-named (name)
  "Return the fluent that NAME, as NAME-OF-FLUENT has returned it elsewhere, means here."
  (if (consp name)
      (destructuring-bind (variable index) name
        (if index (aref (symbol-value variable) index) (symbol-value variable)))
      (entity-like name)))

(defun change-again (function name value)
  "Call FUNCTION with the fluent that NAME means, and VALUE."
  (funcall function (fluent-named name) value))

(defun note-outside-change (function fluent value)
  "Let the current run remember that FUNCTION was called from outside of plans with FLUENT and
VALUE."
  (when (and *simulation* (simulation-past *simulation*))
    (note-doing *simulation* #'change-again function (name-of-fluent fluent) value)))

(setf *on-outside-change* #'note-outside-change)
