;;;; access.lisp -- how changes from outside reach the owner of a world.

(in-package :ars-magna.world)

(export '(change-world changing writing))

;;; Whoever runs a world changes it within its ticks: kickers, events, commands. What users do from
;;; anywhere else goes to the world's owner, its timeline, by one generic function: the layer above
;;; sends it to the thread that may do it, and notes it in the journal. A world says which thread
;;; is changing it; so nobody else has to.

(defgeneric change-world (timeline world function operator arguments)
  (:documentation
   "Make a change to WORLD, whose timeline is TIMELINE, by calling FUNCTION with no arguments, where
and when that is allowed, and return its values. It is what the operator called OPERATOR, a symbol,
does with the list ARGUMENTS.")
  (:method ((timeline null) world function operator arguments)
    (declare (ignore world operator arguments))
    (funcall function)))

(declaim (inline writing-p))
(defun writing-p (world)
  "True if this thread is changing WORLD, or there is no world to change."
  (or (null world)
      (eq (world-writer (the world world)) (current-thread))))

(defun call-writing (function world)
  "Call FUNCTION, which may change WORLD. Called by its owner."
  (let ((before (world-writer world)))
    (setf (world-writer world) (current-thread))
    (unwind-protect (funcall function)
      (setf (world-writer world) before))))

(defmacro writing ((world) &body body)
  "Run BODY, in which this thread may change WORLD. Only its owner may do so."
  `(flet ((write-it () ,@body))
     (declare (dynamic-extent #'write-it))
     (call-writing #'write-it ,world)))

(defun world-of-living (thing)
  "Return the world that THING is in, or NIL if it is a prototype or has been destroyed, so that
what becomes of it is nobody's business."
  (and (thing-alive-p thing) (thing-world thing)))

(defmacro changing ((world operator &rest arguments) &body body)
  "Run BODY, which changes WORLD (NIL: nobody's, as of prototypes), where that is allowed; it is
what OPERATOR, a symbol, unevaluated, does with ARGUMENTS. Conses nothing inside ticks."
  (once-only (world)
    `(flet ((change-it () ,@body))
       (if (writing-p ,world)
           (change-it)
           ;; A closure of its own, so that none is made above.
           (change-world (world-timeline ,world) ,world (lambda () (change-it))
                         ',operator (list ,@arguments))))))
