;;;; debugger.lisp -- when a program breaks, the user says how to continue.

(in-package :ars-magna.cli)

(export '(*break-hooks*))

;;; Only the prompt's thread reads what is typed. If a program in it breaks, by (BREAK) or an error
;;; to be debugged, it asks how to continue before it reads the next line. If a program in another
;;; thread breaks, such as the simulator's, that thread waits. Lines typed at the prompt are for it
;;; until one continues it. Without a terminal or window there is no debugger, and a break is a
;;; message; so is a break in a line that answers a break.

;;; What the user says.

(defun post-call (session break-request function)
  "Make the other thread of BREAK-REQUEST call FUNCTION soon, with this one's package and syntax."
  (flet ((call-posted ()
           (let* ((console (session-console session))
                  (*standard-output* console)
                  (*query-io* (make-two-way-stream (make-concatenated-stream) console)))
             (with-simple-restart (end-line "End the line.")
               (call-reporting-session-errors session function)))))
    (setf (break-request-call break-request)
          (spread-specials #'call-posted
                           '*package* '*readtable* '*read-default-float-format*)))
  (signal-semaphore (break-request-posted break-request)))

(defun call-in-broken-thread (session break-request function)
  "Make the thread of BREAK-REQUEST call FUNCTION, and wait until it has done so or continues."
  (cond ((broken-here-p break-request) (funcall function))
        (t (post-call session break-request function)
           (wait-on-semaphore (break-request-done break-request)))))

(defun restart-called (word break-request)
  "Return the restart that WORD, a number or the beginning of a name, means. Signals BAD-LINE."
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
  (let* ((calls (calls-under-way 100))
         (start (position 'invoke-debugger calls :key #'first)))
    (loop for call in (if start (nthcdr (1+ start) calls) calls)
          until (member (first call)
                        '(eval-quietly call-user-code call-until-error call-with-care))
          do (put-line "  ~A" (visible (cut (one-line (format-briefly nil "~S" call)) 300))))))

(defun debug-line (session break-request text)
  (flet ((says-p (word) (string-equal word (split-line text))))
    (cond ((comment-p text))
          ((lisp-p text) (let ((form (read-form session text)))
                           (call-in-broken-thread session break-request
                                                  (lambda ()
                                                    (call-telling-undefined
                                                     (lambda () (evaluate session form)))))))
          ((says-p "quit") (setf (session-over-p session) t))
          ((says-p "backtrace") (call-in-broken-thread session break-request #'write-backtrace))
          ((says-p "plan-tree")
           (call-in-broken-thread session break-request
                                  (lambda () (print-plans *standard-output* t))))
          (t (multiple-value-bind (word rest) (split-line text)
               (continue-by-restart session break-request (restart-called word break-request)
                                    rest))))))

(defun continue-by-restart (session break-request restart rest)
  "Continue BREAK-REQUEST by RESTART. If it needs a value, that is REST, or else the next line."
  (let* ((needs-value-p (and (restart-asks-p restart) (not (broken-here-p break-request))))
         (answer (cond ((not needs-value-p) nil)
                       ((every #'blank-p rest) (read-input session "Value> "))
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
        (debug-line session break-request text)
        (setf (session-over-p session) t))))

;;; How a program waits.

(defun call-debugging (session break-request function)
  "Call FUNCTION, which reads lines for this thread's BREAK-REQUEST, before others' breaks."
  (let* ((state (session-break-state session))
         (before (shiftf (break-state-own state) break-request)))
    (unwind-protect (funcall function)
      (setf (break-state-own state) before)
      (when (and (session-breaks session) (not before) (not (session-over-p session)))
        (tell-break session (first (session-breaks session)))))))

(defun answer-those-before (session break-request)
  "Read lines for breaks in other threads before BREAK-REQUEST, which is in this one."
  (let ((breaks (copy-list (session-breaks session))))
    (when breaks (report-waiting-break session break-request))
    (dolist (other breaks)
      (unless (break-request-told-p other) (tell-break session other))
      (loop while (member other (session-breaks session))
            until (session-over-p session)
            do (call-reporting-session-errors
                session (lambda () (read-debug-line session other)))))))

(defun announce-break (session break-request)
  "Report BREAK-REQUEST, of another thread than that of SESSION: all, if it can be answered now."
  (if (or (break-state-own (session-break-state session))
          (not (eq break-request (first (session-breaks session)))))
      (report-waiting-break session break-request)
      (tell-break session break-request)))

(defun forget-break (session break-request)
  "Release SESSION from BREAK-REQUEST, which continues; another prompt may have answered it."
  (let* ((console (session-console session)) (state (session-break-state session))
         (first-p (eq break-request (first (break-state-others state))))
         (left (removef (break-state-others state) break-request)))
    (unless (or (break-state-own state) (session-over-p session))
      (cond ((and left first-p) (tell-break session (first left)))
            ((and (console-prompt console) (null left))
             (show-prompt console "Robot> "))))
    (signal-semaphore (break-request-done break-request))))

(defvar *own-process-p* nil "True in a process that does nothing but this program.")

(defun words-for-repl (sessions break-request)
  "Return a message for the error output if only windows, those of SESSIONS, ask about
BREAK-REQUEST, as the user may wait in Lisp's own REPL; or NIL."
  (and (not *own-process-p*)
       (every #'session-place sessions)
       (format nil "~A: a window asks how to continue."
               (break-line (first sessions) break-request))))

(defun debug-elsewhere (sessions break-request)
  "Make the calls that the threads of SESSIONS post for BREAK-REQUEST, until one continues it."
  (dolist (state (mapcar #'session-break-state sessions))
    (setf (break-state-others state) (append (break-state-others state) (list break-request))))
  (unwind-protect (progn (dolist (session sessions) (announce-break session break-request))
                         (let ((words (words-for-repl sessions break-request)))
                           (when words (say-on-error-output words)))
                         (loop
                           (wait-on-semaphore (break-request-posted break-request))
                           (funcall (break-request-call break-request))
                           (signal-semaphore (break-request-done break-request))))
    (dolist (session sessions) (forget-break session break-request))))

;; A user's window may be lost although there is another, or the terminal.
(defun sessions-to-answer-for (session)
  "Return the sessions whose users can answer for the user of SESSION, which is over: those in its
run, or else all; NIL if its user has left it."
  (flet ((can-answer-p (other)
           (and (session-terminal-p other)
                (not (eq other session))
                (not (session-over-p other))
                (not (session-abandoned-p other)))))
    (and (session-abandoned-p session)
         (or (remove-if-not #'can-answer-p (sessions-showing *simulation*))
             (remove-if-not #'can-answer-p (sessions-at-work))))))

(defun break-request-for-condition (condition sessions)
  "Return a break request for CONDITION in this thread, for the users of SESSIONS."
  (make-break-request condition (restarts-to-offer condition) (current-thread) sessions))

(defun run-debugger-prompt (session break-request)
  (flet ((read-lines ()
           (answer-those-before session break-request)
           (tell-break session break-request)
           (loop until (session-over-p session)
                 do (call-guarded session (lambda () (read-debug-line session break-request))))))
    (call-debugging session break-request
                    (lambda ()
                      (if (session-trial session)
                          (call-outside-trial #'read-lines)
                          (read-lines)))))
  ;; Others may say how to continue if its user no longer can.
  (let ((others (sessions-to-answer-for session)))
    (when others
      (debug-elsewhere
       others (break-request-for-condition (break-request-condition break-request) others))))
  (invoke-restart 'end-line))

;; A line may wait for what has broken elsewhere, as RUN-PLAN does for a plan.
(defmethod serve-while-waiting ((prompts prompts))
  "If this thread has a prompt that runs a line, read lines for breaks in other threads, until
those continue."
  (let ((session *session*))
    (when (and session (eq (session-thread session) (current-thread)) (not *showing-p*))
      (loop for break-request = (first (session-breaks session))
            while break-request
            do (when (session-over-p session) (invoke-restart 'end-line))
               (call-reporting-session-errors
                session (lambda () (read-debug-line session break-request)))))))

(defun give-up (condition)
  "Abort what has signalled CONDITION, by the innermost restart for that."
  (invoke-restart (or (find-if (lambda (restart)
                                 (member (restart-name restart) '(abort end-line)))
                               (restarts-within condition))
                      'abort)))

(define-event *break-hooks*
  "Functions of no arguments, or their names. A thread that breaks calls them before it asks how to
continue, to show its state.")

(defun outside-prompts-p ()
  "True if prompts ignore breaks of this thread: it is a user's own, without a prompt, in a Lisp
that does other things too."
  (not (or *own-process-p*
           (own-thread-p)
           (and *session* (eq (session-thread *session*) (current-thread))))))

(defun enter-debugger (condition hook)
  "Ask the user of the prompt how to continue after CONDITION. Called instead of Lisp's debugger."
  ;; The question needs stack that is not there.
  (when (typep condition 'storage-condition) (give-up condition))
  (let* ((*asking-p* t) (sessions (sessions-to-ask)))
    (cond ((outside-prompts-p) nil)
          (sessions
           (with-debugger-hook ('debugger-disabled-hook)
             (tell-listeners *break-hooks*)
             (if (eq (session-thread (first sessions)) (current-thread))
                 (run-debugger-prompt (first sessions)
                                      (break-request-for-condition condition sessions))
                 (debug-elsewhere sessions (break-request-for-condition condition sessions)))))
          ;; Without any, as when it has just ended, Lisp's own debugger comes up.
          (*session* (debugger-disabled-hook condition hook)))))

(defun make-process-own ()
  "Make this Lisp, which is to be saved, run only this program."
  (setf *own-process-p* t
        (debugger-hook) 'debugger-disabled-hook))

(defun end-for-unhandled (condition)
  "End this process, which is starting or ending, because nothing handles CONDITION."
  (when (typep condition 'user-interrupt) (end-interrupted))
  (say-on-error-output (condition-text condition))
  (end-process 1))

(defun users-thread-text (condition)
  "Return the message on CONDITION, which nothing handles in this thread of a user's program."
  (let ((serious-p (typep condition 'serious-condition)))
    (format nil "~:[Break~;Error~] in a thread~@[, ~A,~] that a program has started: ~A. ~
                 ~:[It continues~;That thread ends; everything else continues~]."
            serious-p (thread-name (current-thread))
            (string-right-trim "." (complaint-text (condition-text condition))) serious-p)))

(defconstant +most-reported+ 100 "How many different errors in threads of programs are reported.")

(defvar *reported-thread-errors* '()
  "What was reported of threads of programs; each is reported once.")
(defvar *reported-lock* (make-lock "reported thread errors"))

(defun report-users-thread (condition)
  "Write a message on CONDITION to the error output, once, and not after very many others."
  (let* ((text (users-thread-text condition))
         (count (with-lock (*reported-lock*)
                  (unless (or (member text *reported-thread-errors* :test #'string=)
                              (< +most-reported+ (length *reported-thread-errors*)))
                    (length (push text *reported-thread-errors*))))))
    (when count
      (say-on-error-output (if (<= count +most-reported+)
                               text
                               "There are more errors in threads; they are no longer reported.")))))

;; The rest of the program recognises by this name that there is no debugger.
(defun debugger-disabled-hook (condition hook)
  "Report CONDITION and continue, if it is no error, or end what this thread does. Called instead of
Lisp's debugger without a terminal or window, or while a break is being answered."
  (declare (ignore hook))
  (cond (*session* (complain *session* (format nil "Break: ~A" (condition-text condition))))
        ((and *own-process-p* (users-thread-p)) (report-users-thread condition))
        (*own-process-p* (end-for-unhandled condition)))
  (unless (typep condition 'serious-condition) (continue condition))
  (give-up condition))

;;; Another debugger, such as an editor's, may ask instead.

(defmethod ask-how-to-go-on ((prompts prompts) condition)
  (when (sessions-to-ask) (enter-debugger condition nil)))

(defun tell-of-inquiry (condition asker)
  "Report in the prompts of the simulation that ASKER asks how to continue after CONDITION."
  (unless (eq 'enter-debugger (global-debugger-hook))
    (dolist (session (remove-if-not #'session-terminal-p (sessions-showing *simulation*)))
      (show-line-in-session
       session (format nil "*BREAK* -> ~A~@[ (in ~A)~]. ~@(~A~) waits for the answer.~%"
                       (break-words condition)
                       (words-for-thread session (current-thread))
                       asker)))))

(attend *inquiry-hooks* tell-of-inquiry)

;;; From when to when.

(defun release (session break-request)
  "Continue BREAK-REQUEST, which only SESSION could answer, by the most likely restart; report
that."
  (let ((restart (first (break-request-restarts break-request))))
    (post-call session break-request
               (lambda ()
                 (warning-set (format nil "The prompt that asked about ~A has gone; ~A was ~
                                           chosen"
                                      (break-line session break-request)
                                      (plain-name (restart-name restart))))
                 (invoke-restart restart)))))

(defun release-all (session)
  "Continue all breaks that wait for SESSION, which is over, and for no other."
  (dolist (break-request (session-breaks session))
    (unless (removef (break-request-sessions break-request) session)
      (release session break-request))))

(defun call-with-debugger (session function)
  (let ((outer *session*))
    (setf *session* session
          (break-state-thread (session-break-state session)) (current-thread))
    (unwind-protect (call-sharing (if (session-terminal-p session)
                                      'enter-debugger
                                      'debugger-disabled-hook)
                                  (lambda () (call-among-sessions session function)))
      (setf *session* outer)
      (release-all session))))
