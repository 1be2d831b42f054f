;;;; debugger.lisp -- when a program breaks, the user says how to continue.

(in-package :ars-magna.cli)

(export '(*break-hooks*))

;;; Only the prompt's thread reads what is typed. If a program in it breaks, by (BREAK) or an error
;;; to be debugged, it asks how to continue before it reads the next line. If a program in another
;;; thread breaks, such as the simulator's, that thread waits. Lines typed at the prompt are for it
;;; until one continues it. Without a terminal or window there is no debugger, and a break is a
;;; message; so is a break in a line that answers a break.

;;; What the user says.

(defun post-call-to-thread (session break-request function)
  "Make the thread of BREAK-REQUEST call FUNCTION soon, with the current package and syntax."
  (flet ((call-posted ()
           (let* ((console (session-console session))
                  (*standard-output* console)
                  (*query-io* (make-two-way-stream (make-concatenated-stream) console)))
             (with-simple-restart (end-line "End the line.")
               (call-reporting-session-errors session function)))))
    (setf (break-request-call break-request)
          (function-with-specials #'call-posted
                                  '*package* '*readtable* '*read-default-float-format*)))
  (signal-semaphore (break-request-posted break-request)))

(defun call-in-broken-thread (session break-request function)
  "Make BREAK-REQUEST's thread call FUNCTION. Wait until FUNCTION returns or the thread continues."
  (cond ((own-thread-break-p break-request) (funcall function))
        (t (post-call-to-thread session break-request function)
           (wait-on-semaphore (break-request-done break-request)))))

(defun restart-named (word break-request)
  "Return BREAK-REQUEST's restart with number WORD or a name beginning with WORD. Signals BAD-LINE."
  (let ((number (ignore-errors (parse-integer word)))
        (restarts (break-request-restarts break-request)))
    (or (and number (<= 0 number) (nth number restarts))
        (find-if (lambda (restart)
                   (starts-with-subseq (string-upcase word) (string (restart-name restart))))
                 restarts)
        (reject-line "~A is not one of the restarts. Give a listed number or name (~{~A~^, ~}), ~
                      BACKTRACE, PLAN-TREE, QUIT, or a form in parentheses."
                     word (mapcar #'plain-name (mapcar #'restart-name restarts))))))

(defun write-backtrace ()
  "Write the user's calls that led into the debugger, the newest first."
  (let* ((calls (calls-in-progress 100))
         (start (position 'invoke-debugger calls :key #'first)))
    (loop for call in (if start (nthcdr (1+ start) calls) calls)
          until (member (first call)
                        '(eval-quietly call-user-code call-until-error call-handling-trouble))
          do (write-trimmed-line
              "  ~A" (escape-controls (cut (one-line (format-briefly nil "~S" call)) 300))))))

(defun run-debug-line (session break-request text)
  (flet ((says-p (word) (string-equal word (split-first-word text))))
    (cond ((nothing-to-run-p text))
          ((lisp-p text) (let ((form (read-form session text)))
                           (call-in-broken-thread session break-request
                                                  (lambda ()
                                                    (call-reporting-undefined
                                                     (lambda () (evaluate session form)))))))
          ((says-p "quit") (setf (session-over-p session) t))
          ((says-p "backtrace") (call-in-broken-thread session break-request #'write-backtrace))
          ((says-p "plan-tree")
           (call-in-broken-thread session break-request
                                  (lambda () (print-plans *standard-output* t))))
          (t (multiple-value-bind (word rest) (split-first-word text)
               (continue-by-restart session break-request (restart-named word break-request)
                                    rest))))))

(defun continue-by-restart (session break-request restart rest)
  "Continue the thread of BREAK-REQUEST by RESTART. If RESTART needs a value, read the value from
REST or, if REST is blank, from the next line."
  (let* ((needs-value-p (and (restart-needs-value-p restart)
                             (not (own-thread-break-p break-request))))
         (answer (cond ((not needs-value-p) nil)
                       ((every #'blank-character-p rest) (read-input session "Value> "))
                       (t rest))))
    (unless (and needs-value-p (null answer))
      (flet ((continue-with-answer ()
               (let ((*query-io* (if answer
                                     (make-two-way-stream (make-string-input-stream answer)
                                                          (make-broadcast-stream))
                                     *query-io*)))
                 (invoke-restart-interactively restart))))
        (call-in-broken-thread session break-request #'continue-with-answer)))))

(defun read-debug-line (session break-request)
  (let ((text (read-input session "Break> ")))
    (if text
        (run-debug-line session break-request text)
        (setf (session-over-p session) t))))

;;; How a program waits.

(defun call-answering-break (session break-request function)
  "Call FUNCTION, which reads answers to BREAK-REQUEST, a break in this thread. Later breaks in
other threads wait until FUNCTION returns."
  (let* ((state (session-break-state session))
         (before (shiftf (break-state-own state) break-request)))
    (unwind-protect (funcall function)
      (setf (break-state-own state) before)
      (when (and (session-other-breaks session) (not before) (not (session-over-p session)))
        (show-break session (first (session-other-breaks session)))))))

(defun answer-earlier-breaks (session break-request)
  "BREAK-REQUEST is this thread's break. Read lines that answer earlier breaks in other threads."
  (let ((breaks (copy-list (session-other-breaks session))))
    (when breaks (report-waiting-break session break-request))
    (dolist (other breaks)
      (unless (break-request-told-p other) (show-break session other))
      (loop while (member other (session-other-breaks session))
            until (session-over-p session)
            do (call-reporting-session-errors
                session (lambda () (read-debug-line session other)))))))

(defun announce-break (session break-request)
  "Report another thread's BREAK-REQUEST in SESSION; with its restarts if the user can answer now."
  (if (or (break-state-own (session-break-state session))
          (not (eq break-request (first (session-other-breaks session)))))
      (report-waiting-break session break-request)
      (show-break session break-request)))

(defun remove-break (session break-request)
  "Remove BREAK-REQUEST from SESSION: its thread continues, perhaps after another prompt's answer."
  (let* ((console (session-console session)) (state (session-break-state session))
         (first-p (eq break-request (first (break-state-others state))))
         (left (removef (break-state-others state) break-request)))
    (unless (or (break-state-own state) (session-over-p session))
      (cond ((and left first-p) (show-break session (first left)))
            ((and (console-prompt console) (null left))
             (show-prompt console "Robot> "))))
    (signal-semaphore (break-request-done break-request))))

(defvar *own-process-p* nil "True in a process that runs only this program.")

(defun repl-break-message (sessions break-request)
  "If all SESSIONS are windows, return a message on BREAK-REQUEST for the error output, because the
user may be waiting in Lisp's own REPL. Otherwise return NIL."
  (and (not *own-process-p*)
       (every #'session-place sessions)
       (format nil "~A: a window asks how to continue."
               (break-summary (first sessions) break-request))))

(defun await-break-answer (sessions break-request)
  "Wait in the broken thread until users of SESSIONS answer BREAK-REQUEST. Make the calls that the
sessions' threads post, until a call continues this thread."
  (dolist (state (mapcar #'session-break-state sessions))
    (setf (break-state-others state) (append (break-state-others state) (list break-request))))
  (unwind-protect (progn (dolist (session sessions) (announce-break session break-request))
                         (let ((words (repl-break-message sessions break-request)))
                           (when words (say-on-error-output words)))
                         (loop
                           (wait-on-semaphore (break-request-posted break-request))
                           (funcall (break-request-call break-request))
                           (signal-semaphore (break-request-done break-request))))
    (dolist (session sessions) (remove-break session break-request))))

;; A user's window may be lost although there is another, or the terminal.
(defun sessions-able-to-answer (session)
  "If the user of SESSION was lost, return the sessions whose users can answer its breaks: sessions
in the same run, else all sessions. Return NIL if the user ended SESSION."
  (flet ((can-answer-p (other)
           (and (session-terminal-p other)
                (not (eq other session))
                (not (session-over-p other))
                (not (session-abandoned-p other)))))
    (and (session-abandoned-p session)
         (or (remove-if-not #'can-answer-p (sessions-showing *simulation*))
             (remove-if-not #'can-answer-p (running-sessions))))))

(defun break-request-for-condition (condition sessions)
  (make-break-request condition (restarts-to-offer condition) (current-thread) sessions
                      (robot-text-of-calling-plan)))

(defun run-debugger-prompt (session break-request)
  (flet ((read-lines ()
           (answer-earlier-breaks session break-request)
           (show-break session break-request)
           (loop until (session-over-p session)
                 do (call-guarded session (lambda () (read-debug-line session break-request))))))
    (call-answering-break session break-request
                    (lambda ()
                      (if (session-trial session)
                          (call-outside-trial #'read-lines)
                          (read-lines)))))
  ;; Others may say how to continue if its user no longer can.
  (let ((others (sessions-able-to-answer session)))
    (when others
      (await-break-answer
       others (break-request-for-condition (break-request-condition break-request) others))))
  (invoke-restart 'end-line))

;; A line may wait for what has broken elsewhere, as RUN-PLAN does for a plan.
(defmethod serve-while-waiting ((prompts prompts))
  "If this thread runs a prompt's line, read answers to other threads' breaks until no break waits."
  (let ((session *session*))
    (when (and session (eq (session-thread session) (current-thread)) (not *showing-messages-p*))
      (loop for break-request = (first (session-other-breaks session))
            while break-request
            do (when (session-over-p session) (invoke-restart 'end-line))
               (call-reporting-session-errors
                session (lambda () (read-debug-line session break-request)))))))

(defun abort-by-restart (condition)
  "Invoke the innermost of the restarts ABORT and END-LINE for CONDITION."
  (invoke-restart (or (find-if (lambda (restart)
                                 (member (restart-name restart) '(abort end-line)))
                               (restarts-within-line condition))
                      'abort)))

(define-event *break-hooks*
  "Functions without arguments, or names of functions. A thread that breaks calls these functions,
for example to show its state, before it asks how to continue.")

(defun break-ignored-p ()
  "True if prompts ignore breaks of this thread: the user has started the thread, it has no prompt,
and Lisp runs other programs, too."
  (not (or *own-process-p*
           (own-thread-p)
           (and *session* (eq (session-thread *session*) (current-thread))))))

(defun enter-debugger (condition hook)
  "Ask the prompt's user how to continue after CONDITION. Lisp calls this hook, not its debugger."
  ;; The question needs stack that is not there.
  (when (typep condition 'storage-condition) (abort-by-restart condition))
  (let* ((*asking-how-to-continue-p* t) (sessions (sessions-to-ask)))
    (cond ((break-ignored-p) nil)
          (sessions
           (with-debugger-hook ('debugger-disabled-hook)
             (call-listeners *break-hooks*)
             (if (eq (session-thread (first sessions)) (current-thread))
                 (run-debugger-prompt (first sessions)
                                      (break-request-for-condition condition sessions))
                 (await-break-answer sessions (break-request-for-condition condition sessions)))))
          ;; Without any, as when it has just ended, Lisp's own debugger comes up.
          (*session* (debugger-disabled-hook condition hook)))))

(defun mark-process-as-own ()
  "Mark this Lisp, about to be saved as an image, as a process that runs only this program."
  (setf *own-process-p* t
        (debugger-hook) 'debugger-disabled-hook))

(defun exit-after-unhandled-error (condition)
  "End this process, which is starting or ending, because nothing handles CONDITION."
  (when (typep condition 'user-interrupt) (exit-after-interrupts))
  (say-on-error-output (condition-text condition))
  (end-process 1))

(defun thread-error-text (condition)
  "Return the message on CONDITION, which is not handled in this thread of a user's program."
  (let ((serious-p (typep condition 'serious-condition)))
    (format nil "~:[Break~;Error~] in a thread~@[, ~A,~] that a program has started: ~A. ~
                 ~:[It continues~;That thread ends; everything else continues~]."
            serious-p (thread-name (current-thread))
            (string-right-trim "." (short-error-text (condition-text condition))) serious-p)))

(defconstant +most-thread-errors+ 100
  "How many different errors in threads of programs are reported.")

(defvar *reported-thread-errors* '()
  "The messages already reported on errors in threads of programs; a message is reported once.")
(defvar *reported-thread-errors-lock* (make-lock "reported thread errors"))

(defun report-thread-error (condition)
  "Write a new message on CONDITION to the error output, but at most +MOST-THREAD-ERRORS+ messages."
  (let* ((text (thread-error-text condition))
         (count (with-lock (*reported-thread-errors-lock*)
                  (unless (or (member text *reported-thread-errors* :test #'string=)
                              (< +most-thread-errors+ (length *reported-thread-errors*)))
                    (length (push text *reported-thread-errors*))))))
    (when count
      (say-on-error-output (if (<= count +most-thread-errors+)
                               text
                               "There are more errors in threads; they are not reported.")))))

;; The rest of the program recognises by this name that there is no debugger.
(defun debugger-disabled-hook (condition hook)
  "Report CONDITION. If it is an error, abort this thread's work, else continue. Lisp calls this
hook, not its debugger, if there is no terminal or window, or a break is being answered."
  (declare (ignore hook))
  (cond (*session*
         (report-session-error *session* (format nil "Break: ~A" (condition-text condition))))
        ((and *own-process-p* (users-thread-p)) (report-thread-error condition))
        (*own-process-p* (exit-after-unhandled-error condition)))
  (unless (typep condition 'serious-condition) (continue condition))
  (abort-by-restart condition))

;;; Another debugger, such as an editor's, may ask instead.

(defmethod ask-user-for-restart ((prompts prompts) condition)
  (when (sessions-to-ask) (enter-debugger condition nil)))

(defun report-debugger-question (condition asker)
  "Report in the prompts of the simulation that ASKER asks how to continue after CONDITION."
  (unless (eq 'enter-debugger (global-debugger-hook))
    (dolist (session (remove-if-not #'session-terminal-p (sessions-showing *simulation*)))
      (show-line-in-session
       session (format nil "*BREAK* -> ~A~@[ (in ~A)~]. ~@(~A~) waits for the answer.~%"
                       (break-condition-text condition)
                       (thread-description session (current-thread))
                       asker)))))

(add-listener *inquiry-hooks* report-debugger-question)

;;; From when to when.

(defun continue-orphaned-break (session break-request)
  "Continue BREAK-REQUEST, which only SESSION could answer, by its likeliest restart. Report that."
  (let ((restart (first (break-request-restarts break-request))))
    (post-call-to-thread session break-request
                         (lambda ()
                           (warning-set
                            (format nil "The prompt that asked about ~A was closed; ~A was chosen"
                                    (break-summary session break-request)
                                    (plain-name (restart-name restart))))
                           (invoke-restart restart)))))

(defun continue-orphaned-breaks (session)
  "Continue all breaks that wait only for SESSION, which is over."
  (dolist (break-request (session-other-breaks session))
    (unless (removef (break-request-sessions break-request) session)
      (continue-orphaned-break session break-request))))

(defun call-with-debugger (session function)
  (let ((outer *session*))
    (setf *session* session
          (break-state-thread (session-break-state session)) (current-thread))
    (unwind-protect (call-sharing-hook (if (session-terminal-p session)
                                           'enter-debugger
                                           'debugger-disabled-hook)
                                       (lambda () (call-as-running-session session function)))
      (setf *session* outer)
      (continue-orphaned-breaks session))))
