;;;; guarding.lisp -- whatever goes wrong in a line ends that line, with one line that says why.

(in-package :ars-magna.cli)

;;; An interrupt (control C) ends the line that is being read or carried out; the simulator does not
;;; notice. Between lines it waits for the next.

(defun debug-if-wanted (session condition)
  (when (and *break-on-user-error*
             (terminal-p session)
             (not (typep condition '(or ars-magna-error storage-condition))))
    (invoke-debugger condition)))

(defun call-complaining (session function)
  "Call FUNCTION; complain of what goes wrong in it."
  (handler-case (funcall function)
    ((or error storage-condition) (condition)
      (regain-room condition)
      (complain session (condition-text condition)))))

(defun interrupted (session)
  "Tell the user of SESSION that his interrupt has ended the line. Users' code that keeps the
simulator waiting is aborted, too."
  (when (session-batch-p session) (throw 'leave 130))
  (when *simulation* (abort-hog *simulation*))
  (answered (session-console session))
  (write-fresh (format nil "Interrupted.~:[~; Plans go on; STOP-PLAN ends them.~]~%"
                       (and (null (session-visit session)) (notevery #'plan-ending-p (plans))))
               (session-console session)))

(defun call-guarded (session function)
  "Call FUNCTION, which may be interrupted; complain of what goes wrong in it."
  (flet ((look-into (condition) (debug-if-wanted session condition)))
    (handler-case
        (with-simple-restart (end-line "End the line.")
          (call-complaining session
                            (lambda ()
                              (handler-bind ((error #'look-into))
                                (call-open-to-interrupts function)))))
      (user-interrupt () (interrupted session)))))
