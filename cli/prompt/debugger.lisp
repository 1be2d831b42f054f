;;;; debugger.lisp -- when a program breaks, the user says how to continue.

(in-package :ars-magna.cli)

(export '(*break-hooks*))

;;; Only the thread of the prompt reads what is typed. When a program in it breaks, by (BREAK) or an
;;; error that the user wants to look into, it asks how to continue before it reads the next line.
;;; When a program in another thread breaks, such as the simulator's, that thread waits, and the
;;; lines typed at the prompt are for it until one continues it. Without a terminal or window there
;;; is no debugger: a break is a message. The same holds for the lines that answer a break: there is
;;; no break in a break.

;;; What the user says.

(defun hand-order (session breakage function)
  "Make BREAKAGE's thread, another one, call FUNCTION soon, with this one's package and syntax."
  (flet ((call-ordered ()
           (let* ((console (session-console session))
                  (*standard-output* console)
                  (*query-io* (make-two-way-stream (make-concatenated-stream) console)))
             (with-simple-restart (end-line "End the line.")
               (call-complaining session function)))))
    (setf (breakage-order breakage)
          (spread-specials #'call-ordered
                           '*package* '*readtable* '*read-default-float-format*)))
  (signal-semaphore (breakage-ordered breakage)))

(defun order (session breakage function)
  "Let the thread of BREAKAGE call FUNCTION, and wait until it has done so or continues."
  (cond ((here-p breakage) (funcall function))
        (t (hand-order session breakage function)
           (wait-on-semaphore (breakage-done breakage)))))

(defun restart-called (word breakage)
  "Return the restart that WORD, a number or the beginning of a name, means. Signals BAD-LINE."
  (let ((number (ignore-errors (parse-integer word)))
        (restarts (breakage-restarts breakage)))
    (or (and number (<= 0 number) (nth number restarts))
        (find-if (lambda (restart)
                   (starts-with-subseq (string-upcase word) (string (restart-name restart))))
                 restarts)
        (reject-line "~A is no way to go on. Give a number or name that is listed (~{~A~^, ~}), ~
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

(defun debug-line (session breakage text)
  (flet ((says-p (word) (string-equal word (split-line text))))
    (cond ((comment-p text))
          ((lisp-p text) (let ((form (read-form session text)))
                           (order session breakage
                                  (lambda ()
                                    (call-telling-undefined
                                     (lambda () (evaluate session form)))))))
          ((says-p "quit") (setf (session-over-p session) t))
          ((says-p "backtrace") (order session breakage #'write-backtrace))
          ((says-p "plan-tree")
           (order session breakage (lambda () (print-plans *standard-output* t))))
          (t (multiple-value-bind (word rest) (split-line text)
               (choose session breakage (restart-called word breakage) rest))))))

(defun choose (session breakage restart rest)
  "Continue BREAKAGE by RESTART. A value that it needs is REST, or else what the user types next."
  (let* ((asks-p (and (asks-p restart) (not (here-p breakage))))
         (answer (cond ((not asks-p) nil)
                       ((every #'blank-p rest) (read-input session "Value> "))
                       (t rest))))
    (unless (and asks-p (null answer))
      (order session breakage
             (lambda ()
               (let ((*query-io* (if answer
                                     (make-two-way-stream (make-string-input-stream answer)
                                                          (make-broadcast-stream))
                                     *query-io*)))
                 (invoke-restart-interactively restart)))))))

(defun read-debug-line (session breakage)
  (let ((text (read-input session "Break> ")))
    (if text
        (debug-line session breakage text)
        (setf (session-over-p session) t))))

;;; How a program waits.

(defun call-debugging (session breakage function)
  "Call FUNCTION, which reads lines for BREAKAGE, of this thread; other threads' breaks come after."
  (let* ((state (session-break-state session)) (before (shiftf (break-state-own state) breakage)))
    (unwind-protect (funcall function)
      (setf (break-state-own state) before)
      (when (and (session-breaks session) (not before) (not (session-over-p session)))
        (tell-break session (first (session-breaks session)))))))

(defun answer-those-before (session breakage)
  "Read lines for breaks in other threads before BREAKAGE, which is in this one."
  (let ((breaks (copy-list (session-breaks session))))
    (when breaks (tell-waiting session breakage))
    (dolist (other breaks)
      (unless (breakage-told-p other) (tell-break session other))
      (loop while (member other (session-breaks session))
            until (session-over-p session)
            do (call-complaining session (lambda () (read-debug-line session other)))))))

(defun announce-break (session breakage)
  "Tell of BREAKAGE, of another thread than the one of SESSION: all, if it can be answered now."
  (if (or (break-state-own (session-break-state session))
          (not (eq breakage (first (session-breaks session)))))
      (tell-waiting session breakage)
      (tell-break session breakage)))

(defun forget-break (session breakage)
  "Release SESSION from BREAKAGE, which continues; another prompt may have answered it."
  (let* ((console (session-console session)) (state (session-break-state session))
         (first-p (eq breakage (first (break-state-others state))))
         (left (removef (break-state-others state) breakage)))
    (unless (or (break-state-own state) (session-over-p session))
      (cond ((and left first-p) (tell-break session (first left)))
            ((and (console-prompt console) (null left))
             (show-prompt console "Robot> "))))
    (signal-semaphore (breakage-done breakage))))

(defvar *own-process-p* nil "True in a process that does nothing but this program.")

(defun words-for-repl (sessions breakage)
  "Return a message for the error output if BREAKAGE is asked about in SESSIONS that are all in
windows, as the user may wait in Lisp's own REPL; or NIL."
  (and (not *own-process-p*)
       (every #'session-place sessions)
       (format nil "~A: a window asks how it goes on." (break-line (first sessions) breakage))))

(defun debug-elsewhere (sessions breakage)
  "Carry out the orders of the threads of SESSIONS for BREAKAGE, until one continues it."
  (dolist (state (mapcar #'session-break-state sessions))
    (setf (break-state-others state) (append (break-state-others state) (list breakage))))
  (unwind-protect (progn (dolist (session sessions) (announce-break session breakage))
                         (let ((words (words-for-repl sessions breakage)))
                           (when words (say-on-error-output words)))
                         (loop
                           (wait-on-semaphore (breakage-ordered breakage))
                           (funcall (breakage-order breakage))
                           (signal-semaphore (breakage-done breakage))))
    (dolist (session sessions) (forget-break session breakage))))

;; A user's window may be lost although there is another, or the terminal.
(defun heirs-of (session)
  "Return the sessions whose users can answer for the user of SESSION, which is over: those in its
run, or else all; NIL if its user has left it."
  (flet ((can-answer-p (other)
           (and (session-terminal-p other)
                (not (eq other session))
                (not (session-over-p other))
                (not (session-abandoned-p other)))))
    (and (session-abandoned-p session)
         (or (remove-if-not #'can-answer-p (sessions-hearing *simulation*))
             (remove-if-not #'can-answer-p (sessions-at-work))))))

(defun broken-here (condition sessions)
  "Return what CONDITION has broken in this thread, for the users of SESSIONS."
  (make-breakage condition (restarts-to-offer condition) (current-thread) sessions))

(defun debug-here (session breakage)
  (flet ((read-lines ()
           (answer-those-before session breakage)
           (tell-break session breakage)
           (loop until (session-over-p session)
                 do (call-guarded session (lambda () (read-debug-line session breakage))))))
    (call-debugging session breakage
                    (lambda ()
                      (if (session-visit session)
                          (call-aside #'read-lines)
                          (read-lines)))))
  ;; Others may say how to continue if its user no longer can.
  (let ((heirs (heirs-of session)))
    (when heirs (debug-elsewhere heirs (broken-here (breakage-condition breakage) heirs))))
  (invoke-restart 'end-line))

;; A line may wait for what has broken elsewhere, as RUN-PLAN does for a plan.
(defmethod serve-while-waiting ((prompts prompts))
  "If this thread has the prompt, and carries out a line, read lines for breaks in other threads,
until those continue."
  (let ((session *session*))
    (when (and session (eq (session-thread session) (current-thread)) (not *showing-p*))
      (loop for breakage = (first (session-breaks session))
            while breakage
            do (when (session-over-p session) (invoke-restart 'end-line))
               (call-complaining session (lambda () (read-debug-line session breakage)))))))

(defun give-up (condition)
  "Leave what CONDITION has come up in, by the innermost restart that does."
  (invoke-restart (or (find-if (lambda (restart)
                                 (member (restart-name restart) '(abort end-line)))
                               (restarts-within condition))
                      'abort)))

(define-event *break-hooks*
  "Functions of no arguments, or their names, that are called in a thread that has broken before it
asks how to continue: to show the state in which it stands still.")

(defun others-matter-p ()
  "True if what breaks in this thread is no matter of prompts: it is a user's own, in a Lisp that
does other things too, and no prompt runs in it."
  (not (or *own-process-p*
           (own-thread-p)
           (and *session* (eq (session-thread *session*) (current-thread))))))

(defun enter-debugger (condition hook)
  "Ask the user of the prompt how to continue after CONDITION. Called instead of Lisp's debugger."
  ;; The question needs stack that is not there.
  (when (typep condition 'storage-condition) (give-up condition))
  (let* ((*asking-p* t) (sessions (sessions-to-ask)))
    (cond ((others-matter-p) nil)
          (sessions
           (with-debugger-hook ('debugger-disabled-hook)
             (tell-listeners *break-hooks*)
             (if (eq (session-thread (first sessions)) (current-thread))
                 (debug-here (first sessions) (broken-here condition sessions))
                 (debug-elsewhere sessions (broken-here condition sessions)))))
          ;; Without any, as when it has just ended, Lisp's own debugger comes up.
          (*session* (debugger-disabled-hook condition hook)))))

(defun make-process-own ()
  "Make this Lisp, which is to be saved, run only this program."
  (setf *own-process-p* t
        (debugger-hook) 'debugger-disabled-hook))

(defun end-unheard (condition)
  "End this process, which is starting or ending, as nothing handles CONDITION."
  (when (typep condition 'user-interrupt) (end-interrupted))
  (say-on-error-output (condition-text condition))
  (end-process 1))

(defun users-thread-text (condition)
  "Return the message on CONDITION, which nothing handles in this thread of a program's."
  (let ((serious-p (typep condition 'serious-condition)))
    (format nil "~:[Break~;Error~] in a thread~@[, ~A,~] that a program has started: ~A. ~
                 ~:[It continues~;That thread ends; everything else continues~]."
            serious-p (thread-name (current-thread))
            (string-right-trim "." (complaint-text (condition-text condition))) serious-p)))

(defconstant +most-told+ 100 "How many different errors in threads of programs are reported.")

(defvar *told-of-threads* '() "What has been said of threads of programs; each is said once.")
(defvar *told-lock* (make-lock "told of threads"))

(defun tell-of-users-thread (condition)
  "Say on the error output, unless that or very many others were said before, what CONDITION is."
  (let* ((text (users-thread-text condition))
         (count (with-lock (*told-lock*)
                  (unless (or (member text *told-of-threads* :test #'string=)
                              (< +most-told+ (length *told-of-threads*)))
                    (length (push text *told-of-threads*))))))
    (when count
      (say-on-error-output (if (<= count +most-told+)
                               text
                               "There are more errors in threads; they are no longer reported.")))))

;; The rest of the program recognises by this name that there is no debugger.
(defun debugger-disabled-hook (condition hook)
  "Report CONDITION and continue, if it is no error, or end what this thread does. Called instead of
Lisp's debugger without a terminal or window, or while a break is being answered."
  (declare (ignore hook))
  (cond (*session* (complain *session* (format nil "Break: ~A" (condition-text condition))))
        ((and *own-process-p* (users-thread-p)) (tell-of-users-thread condition))
        (*own-process-p* (end-unheard condition)))
  (unless (typep condition 'serious-condition) (continue condition))
  (give-up condition))

;;; Another debugger, such as an editor's, may ask instead.

(defmethod ask-how-to-go-on ((prompts prompts) condition)
  (when (sessions-to-ask) (enter-debugger condition nil)))

(defun tell-of-inquiry (condition asker)
  "Tell the prompts in the simulation that ASKER asks how to continue after CONDITION."
  (unless (eq 'enter-debugger (common-debugger-hook))
    (dolist (session (remove-if-not #'session-terminal-p (sessions-hearing *simulation*)))
      (say-in session (format nil "*BREAK* -> ~A~@[ (in ~A)~]. ~@(~A~) waits for the answer.~%"
                              (break-words condition)
                              (words-for-thread session (current-thread))
                              asker)))))

(attend *inquiry-hooks* tell-of-inquiry)

;;; From when to when.

(defun release (session breakage)
  "Continue BREAKAGE, which has waited for SESSION only, by the likeliest restart, and report that."
  (let ((restart (first (breakage-restarts breakage))))
    (hand-order session breakage
                (lambda ()
                  (warning-set (format nil "The prompt that asked about ~A has gone; ~A was ~
                                            chosen"
                                       (break-line session breakage)
                                       (plain-name (restart-name restart))))
                  (invoke-restart restart)))))

(defun release-all (session)
  "Continue all breaks that wait for SESSION, which is over, and for no other."
  (dolist (breakage (session-breaks session))
    (unless (removef (breakage-sessions breakage) session)
      (release session breakage))))

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
