;;;; guarding.lisp -- an error in a line ends that line, with one line that says why.

(in-package :ars-magna.cli)

;;; An interrupt (Control-C) ends the line that is being read or carried out, and does not affect
;;; the simulator. Between lines it waits for the next one.

(defun debug-if-wanted (session condition)
  (when (and *break-on-user-error*
             (session-terminal-p session)
             (not (typep condition '(or ars-magna-error storage-condition))))
    (invoke-debugger condition)))

(defun complain-of-printing (session trouble)
  "Say in SESSION that the error cannot be printed, because of TROUBLE. At a terminal no line could
be typed either: so signal that."
  (when (session-terminal-p session) (error trouble))
  (incf (session-errors session))
  (write-fresh (concatenate 'string "*ERROR* -> " +unprintable+ '(#\Newline))
               (session-console session)))

(defun call-complaining (session function)
  (handler-case (funcall function)
    ((or error storage-condition) (condition)
      (regain-room condition)
      (handler-case (complain session (format nil "~A~@[ ~A~]" (condition-text condition)
                                              (advice-on-function condition)))
        (error (trouble) (complain-of-printing session trouble))))))

(defun command-carried-out (robot)
  (let ((event (and (at-work-p robot) (resource-event robot))))
    (and (typep event 'operation)
         (string-upcase (command-prompt-name (operation-command event))))))

(defun command-going-on (session)
  "Return the robot that SESSION commands, and the name of the line or command that it carries out;
NIL if it carries out none."
  (let* ((robot (and *simulation* (null (simulation-over *simulation*)) (session-robot)))
         (name (and robot (or (some #'errand-name (errands-under-way session))
                              (command-carried-out robot)))))
    (and name (values robot name))))

(defun what-goes-on (session)
  "Return sentences that say what continues in the simulator after the line of SESSION has ended,
and how to end it; or, if nothing does, how to leave the prompt. In a trial, nothing continues.
During the answer to a break, return how to answer."
  (multiple-value-bind (robot command) (command-going-on session)
    (let ((plans-p (notevery #'plan-ending-p (plans))))
      (cond ((ways-awaited session)
             (format nil " What has broken waits for one of ~A." (ways-awaited session)))
            ((session-visit session) "")
            ((or robot plans-p)
             (format nil "~@[ ~A goes on with ~]~@[~A; STOP ends that.~]~
                          ~:[~; Plans go on; STOP-PLAN ends them.~]"
                     robot command plans-p))
            (t " QUIT leaves.")))))

(defun whose-code (&optional (calls *user-calls*))
  "Return in words whose code a thread runs, by CALLS, or which form of a file it loads; NIL if
neither, or if that is not recorded."
  (let ((origin (and calls (user-calls-origin calls)))
        (place (and calls (user-calls-place calls))))
    (cond (origin (text-of-origin origin))
          (place (funcall place)))))

(defun say-where (session text)
  "Write TEXT to the error output, with the place of the running line of SESSION."
  (let* ((account (session-account session)) (line (line-done-now account)))
    (say-on-error-output (format nil "~@[~A, ~]~@[line ~D: ~]~A"
                                 (and line (account-file account)) line text))))

(defun dropped-text (count)
  (format nil "~[~:; ~:*~D line~:P that waited ~:*~[~;was~:;were~] dropped; the arrow up brings ~
               ~:*~[~;it~:;them~] back.~]"
          count))

(defun interrupted (session whose)
  "Tell the user of SESSION that an interrupt has ended the line, in code of WHOSE, a text or NIL.
Users' code that keeps the simulator waiting is aborted, too."
  (when (session-batch-p session)
    (say-where session (format nil "stopped~@[ in ~A~]." whose))
    (throw 'leave 130))
  (when *simulation* (abort-hog *simulation*))
  (let ((console (session-console session)) (dropped (drop-waiting (session-input session))))
    (answered console)
    (write-fitted console "Interrupted.~A~A~%" (dropped-text dropped) (what-goes-on session))))

(defun call-guarded (session function)
  "Call FUNCTION, which may be interrupted; complain of what goes wrong in it."
  (let ((whose nil))
    (flet ((look-into (condition) (debug-if-wanted session condition))
           (look-whose (condition)
             (declare (ignore condition))
             (setf whose (whose-code))))
      (handler-case
          (with-simple-restart (end-line "End the line.")
            (call-complaining session
                              (lambda ()
                                (handler-bind ((error #'look-into)
                                               (user-interrupt #'look-whose))
                                  (call-open-to-interrupts function)))))
        (user-interrupt () (interrupted session whose))))))
