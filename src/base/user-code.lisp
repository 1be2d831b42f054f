;;;; user-code.lisp -- trouble in a user's continuation, kicker or test is data.

(in-package :ars-magna.base)

(addition *break-on-user-error*)
(defvar *break-on-user-error* nil
  "When true, an error in user code (a continuation, kicker, manipulation, test or graphics
body) enters the debugger where it happens; when NIL, the default, it is queued as an error
message that names its origin, and the run goes on.")

(defun report-user-error (condition origin)
  (apply #'error-set "Error in "
         (append (ensure-list origin)
                 (list ": " (substitute #\Space #\Newline
                                        (handler-case (princ-to-string condition)
                                          (error () (string (type-of condition)))))))))

(defun call-user-code (function origin &rest arguments)
  "Call FUNCTION with ARGUMENTS and return its values. Should it signal an error, queue an error
message saying that it came from ORIGIN (an item or list of items) and return NIL."
  (declare (dynamic-extent arguments))
  (block nil
    (handler-bind
        (((or error storage-condition)
           (lambda (condition)
             (when *break-on-user-error* (invoke-debugger condition))
             (report-user-error condition origin)
             (return nil))))
      (let ((*asker* origin))
        (apply function arguments)))))
