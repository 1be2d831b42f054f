;;;; rewinding.lisp -- what is asked of plans from outside, done again where a run is rewound.

(in-package :ars-magna.rpl-robot)

;;; Plans do by themselves what they did. That they were begun and ended, that somebody else set
;;; their fluents, gave commands by plan functions, or said a word to a task, such as SUSPEND, is in
;;; no journal; the run remembers it, if it is one that can be rewound.

(defun react-again ()
  (let ((interface (usable-interface)))
    (when interface
      (with-plans (interface) (react-fully interface)))))

(defun note-of-plans (interface function &rest arguments)
  "Let the run of INTERFACE remember that FUNCTION of ARGUMENTS does again what is done here."
  (apply #'note-doing (interface-simulation interface) function arguments))

(defun say-again (word arguments serial)
  "Call the function WORD with ARGUMENTS and the task with the number SERIAL, or the runner of plans
if that is NIL, as somebody did then."
  (let* ((interface (usable-interface))
         (runner (and interface (interface-runner interface)))
         (subject (if (and runner serial) (task-numbered serial runner) runner)))
    (when subject (apply word (append arguments (list subject))))))

(defmethod note-word ((interface interface) word arguments subject)
  (when (interface-valid-p interface)
    (note-of-plans interface #'say-again word arguments
                   (and (task-p subject) (task-serial subject)))))

(defun call-noting-command (interface operator arguments function)
  "Call FUNCTION, which does what the plan function OPERATOR does with ARGUMENTS. If that is called
from outside of the plans of INTERFACE, remember that. What it asks for is heard by what goes on in
forks too."
  (note-of-plans interface #'apply operator (mapcar #'fluent-value arguments))
  (let ((*goes-on-in-forks-p* t))
    (funcall function)))

(defun name-of-fluent (fluent)
  "Return how a fluent variable leads to FLUENT: a list of that and, if it holds a vector, the
index; or else FLUENT."
  (loop for (variable) in *fluent-variables*
        for value = (symbol-value variable)
        for index = (and (vectorp value) (position fluent value :test #'eq))
        when (or (eq fluent value) index)
          return (list variable index)
        finally (return fluent)))

(defun change-again (function name value)
  "Call FUNCTION with the fluent that NAME, as NAME-OF-FLUENT has returned it elsewhere, means here,
and VALUE."
  (funcall function
           (if (consp name)
               (destructuring-bind (variable index) name
                 (if index (aref (symbol-value variable) index) (symbol-value variable)))
               (entity-like name))
           value))

(defun note-change (function fluent value)
  "Remember for rewinds that FUNCTION has been called with FLUENT and VALUE from outside of plans."
  (when (and *simulation* (simulation-past *simulation*))
    (note-doing *simulation* #'change-again function (name-of-fluent fluent) value)))

(defmethod note-outside-change ((interface interface) function fluent value)
  (note-change function fluent value))

(defmethod note-outside-change ((interface null) function fluent value)
  (note-change function fluent value))

;;; What the run was that is over is forgotten.

(defun realm-of (simulation)
  (cdr (assoc '*realm* (environment-of simulation))))

(defun leave-fluents (old new)
  "Let no fluent of NEW, which is to go on in the place of OLD, lead back to that."
  ;; The realm may be that of a live run around OLD, too.
  (when (or (eq old (global-value '*simulation*))
            (not (eq (realm-of old) (global-value '*realm*))))
    (leave-realm (realm-of old) (realm-of new))))

(attend *rewind-hooks* leave-fluents)

(defun give-fluents-back (old new)
  "Let the fluents of OLD, a run that was rewound, have the values that they have where it has gone
on, in NEW, which is over."
  (let ((from (realm-of new)) (realm (realm-of old)))
    (unless (or (null realm) (eq from realm)) (give-back-all from realm))))

(attend *rewound-end-hooks* give-fluents-back)

;; A live run that was rewound has let top-level code work in a fork of where that worked before.
(defun leave-rewound (robot options)
  "Let top-level code, now that the simulator of ROBOT has started a run of its own, work again
where all runs do that are no forks. Fluents have the values there that they had last."
  (declare (ignore robot options))
  (let ((from (global-value '*realm*)))
    (unless (eq from +root+)
      (give-back-all from +root+)
      (setf (global-value '*realm*) +root+)
      (when (eq from *realm*) (setf *realm* +root+)))))

(attend *simulator-hooks* leave-rewound)
