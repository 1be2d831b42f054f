;;;; prompt.lisp -- reading lines and doing what they say.

(in-package :ars-magna.cli)

;;; Whatever goes wrong in a line ends that line, with one line that says why. An interrupt (control
;;; C) ends the line that is being read or carried out; the simulator does not notice. Between lines
;;; it waits for the next.

(defun read-input (session prompt)
  "Return the next line of SESSION, or NIL at the end. Show PROMPT unless it is a batch, and what
comes of earlier lines if the session waits for that."
  (let ((console (session-console session)))
    (unless (or (session-batch-p session)
                (and (unanswered-p console) (string= prompt (console-prompt console))))
      (with-lock ((session-lock session)) (show-prompt console prompt)))
    (catch-up session)
    (let* ((given (pop (session-lines session)))
           (line (or given
                     (and (not (console-trouble console))
                          (read-line (session-input session) nil)))))
      (with-lock ((session-lock session))
        (cond ((session-batch-p session))
              ((null line) (terpri console))
              ((or given (session-echo-p session)) (format console "~A~%" (visible line))))
        (answered console))
      line)))

;;; Carrying out a line.

(defun comment-p (text)
  "True if there is nothing to do in TEXT: it is blank, or a comment after ; or #."
  (let ((start (position-if-not #'blank-p text)))
    (or (null start) (find (char text start) ";#"))))

;; As reading 205 says.
(defun lisp-p (text)
  (char= #\( (char text (position-if-not #'blank-p text))))

(defun split-line (text)
  "Return the first word of TEXT and what follows it."
  (let* ((start (position-if-not #'blank-p text))
         (end (token-end text start)))
    (values (subseq text start end) (subseq text end))))

(defun expand-alias (text &optional known)
  "Return TEXT with the alias that it begins with, if any, replaced; again, but each only once."
  (multiple-value-bind (name rest) (split-line text)
    (let ((alias (assoc name *aliases* :test #'string-equal)))
      (if (and alias (not (member alias known)))
          (expand-alias (concatenate 'string (second alias) rest) (cons alias known))
          text))))

(defun run-line (session line text)
  "Do what LINE does with the arguments in TEXT. What it prints comes out in one piece."
  (let ((arguments (read-arguments line text)))
    (if (unhurried-p line)
        (apply (line-action line) session arguments)
        (write-string (with-output-to-string (*standard-output*)
                        (apply (line-action line) session arguments))))))

(defun unhurried-p (line)
  "True if what LINE prints is to be seen as it comes."
  (or (line-full-name line)
      (member (line-name line) '("EVAL" "REPEAT" "TRIAL") :test #'string=)))

(defun run-text (session text)
  "Do what TEXT, a line as typed, says; what it asks for, the prompt asks for."
  (let ((*asker* "the prompt"))
    (cond ((comment-p text))
          ((lisp-p text) (evaluate-text session text))
          (t (let ((text (expand-alias text)))
               (if (lisp-p text)
                   (evaluate-text session text)
                   (multiple-value-bind (name rest) (split-line text)
                     (run-line session (find-line name) rest))))))))

;;; Lines that go wrong.

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

(defun interrupted (session)
  "Tell the user of SESSION that his interrupt has ended the line. Users' code that keeps the
simulator waiting is aborted, too."
  (when (session-batch-p session) (throw 'leave 130))
  (when *simulation* (abort-hog *simulation*))
  (answered (session-console session))
  (format (session-console session) "~&Interrupted.~:[~; Plans go on; STOP-PLAN ends them.~]~%"
          (and (null (session-visit session)) (notevery #'plan-ending-p (plans)))))

(defun do-next (session text)
  "Do what TEXT, a line, says, or let it answer the newest break, if a program waits for that."
  (let ((breakage (first (session-breaks session))))
    (if breakage
        (debug-line session breakage text)
        (run-text session text))))

(defun next-line (session)
  "Read a line of SESSION and do what it says; at the end of input, let the session be over."
  (follow-simulation session)
  (let ((text (read-input session (if (session-breaks session) "Break> " "Robot> "))))
    (if text
        (do-next session text)
        (setf (session-over-p session) t))))

(defun load-first (session)
  "Load the files that SESSION begins with."
  (loop while (session-files session)
        do (let ((file (pop (session-files session))))
             (call-guarded session (lambda () (load-lisp (file-called file))))
             (setf (session-lisp-p session) t))))

(defun run-lines (session)
  "Do what the files and lines of SESSION say until it is over, or goes on with another robot."
  (load-first session)
  (loop until (or (session-over-p session) (session-next-robot session))
        do (call-guarded session (lambda () (next-line session)))
           (call-guarded session (lambda () (show-messages session)))))

(defun call-with-streams (session function)
  "Call FUNCTION, which writes to SESSION and asks its user."
  (let* ((*standard-output* (session-console session))
         (*standard-input* (session-input session))
         (*query-io* (make-two-way-stream *standard-input* *standard-output*)))
    (funcall function)))

(defun run-session (session)
  "Read lines and do what they say until QUIT or the end of input. Return SESSION."
  (flet ((run ()
           (unwind-protect (call-with-syntax 'double-float (lambda () (run-lines session)))
             (stop-listening session))))
    (call-with-debugger session
                        (lambda ()
                          (call-with-streams session (lambda () (call-holding-interrupts #'run))))))
  session)

(defun prompt (&rest options &key input output batch patient echo lines)
  "Run the command-line interface: prompt for commands to the robot last given to SIMULATOR, until
QUIT or the end of input. INPUT and OUTPUT are streams, by default the standard ones. If PATIENT,
or headless, each command completes before the next is read; BATCH is that without a prompt; with
ECHO, lines are shown as they are read; the list LINES is done first. Returns nothing (manual A,
E)."
  (declare (ignore input output batch patient echo lines))
  (run-session (apply #'make-session options))
  (values))
