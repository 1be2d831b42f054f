;;;; access.lisp -- how changes from outside reach the owner of a world.

(in-package :ars-magna.world)

;;; Only the owner of a simulation changes its world. Operations that users may call from any
;;; thread wrap their work here; the layer above replaces *WORLD-ACCESS* to send the work to
;;; the owner and to note it in a journal.

(defun direct-world-access (function world operation arguments)
  "Call FUNCTION here and now: access for the owner of WORLD."
  (declare (ignore world operation arguments) (type function function))
  (funcall function))

(defvar *world-access* 'direct-world-access
  "A function (function world operation arguments) that makes a change to WORLD by calling
FUNCTION with no arguments, where and when that is allowed, and returns its values. OPERATION
is the symbol of the operation that the user called with the list ARGUMENTS.")

(defun call-with-world-access (function world operation arguments)
  "Have *WORLD-ACCESS* call FUNCTION, which changes WORLD. Without a WORLD, for prototypes,
call it directly."
  (if world
      (funcall *world-access* function world operation arguments)
      (funcall function)))

(defmacro with-world-access ((world operation &rest arguments) &body body)
  "Run BODY, which changes WORLD, by way of *WORLD-ACCESS*; it is the work of OPERATION (a
symbol, unevaluated) called with ARGUMENTS. Conses nothing where access is direct."
  (with-gensyms (work)
    `(flet ((,work () ,@body))
       (if (eq *world-access* 'direct-world-access)
           (,work)
           (call-with-world-access #',work ,world ',operation (list ,@arguments))))))
