;;;; break-requests.lisp -- reporting breaks and reading programs; which users are asked.

(in-package :ars-magna.cli)

(export '(waiting-break-texts restart-choices-text simulator-broken-p other-debugger-text
          valid-at-any-break-p))

(defvar *session* nil "The session that the debugger asks, in any thread; the newest.")

(defvar *asking-how-to-continue-p* nil "True in a thread that has broken and asks how to continue.")

;;; What the user sees.

(defun break-thread-text (session break-request)
  "Return text that names the thread of BREAK-REQUEST; NIL if it is the thread of SESSION."
  (thread-description session (break-request-thread break-request)))

(defun thread-description (session thread)
  "Return text that names THREAD; NIL if THREAD is the thread of SESSION."
  (cond ((eq thread (session-thread session)) nil)
        ((simulator-thread-p session thread) "the simulator's thread")
        (t (format nil "another thread, ~A" (thread-name thread)))))

(defun simulator-thread-p (session thread)
  "True if THREAD runs the simulation whose messages SESSION shows."
  (let ((simulation (session-simulation session)))
    (and simulation (eq thread (simulation-thread simulation)))))

(defun break-text (session break-request)
  (format nil "*BREAK* -> ~A~@[ (in ~A)~]~%~:{  ~2D  ~16A ~A~%~}~
               Type a number. BACKTRACE, PLAN-TREE show where the program is; (...) is Lisp.~%"
          (break-condition-text break-request)
          (break-thread-text session break-request)
          (loop for restart in (break-request-restarts break-request)
                for number from 0
                collect (list number (plain-name (restart-name restart))
                              (short-error-text (printable-report restart))))))

(defun show-break (session break-request)
  "Show the condition and restarts of BREAK-REQUEST in SESSION, whose prompt becomes Break>."
  (let ((console (session-console session)))
    (setf (break-request-told-p break-request) t)
    (write-fitted console "~A" (break-text session break-request))
    (if (console-prompt console)
        (show-prompt console "Break> ")
        (finish-output console))))

(defun report-waiting-break (session break-request)
  (let ((console (session-console session)))
    (write-fitted console
                  "*BREAK* -> ~A~@[ (in ~A)~]. It waits until the earlier break is answered.~%"
                  (break-condition-text break-request)
                  (break-thread-text session break-request))
    (restore-prompt console)))

(defun break-summary (session break-request)
  "Return one line: the condition of BREAK-REQUEST, and its thread if SESSION has another thread."
  (let ((words (break-condition-text break-request)))
    (format nil "~A~@[ (in ~A)~]" (subseq words 0 (position #\Newline words))
            (break-thread-text session break-request))))

(defun waiting-break-texts (session)
  "Return a list of texts, one for each break that waits for an answer of SESSION's user. The user
is being asked about the first break. Any thread may call this function."
  (mapcar (lambda (break-request) (break-summary session break-request))
          (breaks-for-session session)))

(defun restart-choices-text (session)
  "Return text that lists the restarts that SESSION's user can choose now; NIL if no break waits.
Any thread may call this function."
  (let ((break-request (first (breaks-for-session session))))
    (and break-request
         (format nil "~{~A~^, ~}"
                 (loop for restart in (break-request-restarts break-request)
                       for number from 0
                       collect (format nil "~D ~A" number (plain-name (restart-name restart))))))))

(defun simulator-broken-p (session)
  "True if SESSION's user is asked about a break in the simulator's thread. Callable in any thread."
  (some (lambda (break-request) (simulator-thread-p session (break-request-thread break-request)))
        (breaks-for-session session)))

(defun other-debugger-text (simulation)
  "If a debugger other than the prompt's asks about a break in the thread of SIMULATION, return the
end of a sentence that says so; otherwise NIL."
  (let ((debugger (waiting-debugger-name (simulation-thread simulation))))
    (and debugger
         (notany #'simulator-broken-p (sessions-showing simulation))
         (format nil "and ~A waits for the answer" debugger))))

(defun valid-at-any-break-p (text)
  "True if the line TEXT is Lisp or a comment, and so is valid whatever break is being answered."
  (or (nothing-to-run-p text) (lisp-p text)))

;;;; Who is asked

;;; Each prompt has a debugger hook for its own thread. All other threads share one, which depends
;;; on the running prompts, however they start and end: the debugger's if one of them can ask its
;;; user; else the one that reports that no user can answer; without prompts, the original hook.

(defvar *prompt-debugger-hooks* '() "The hooks of the running prompts, the newest first.")
(defvar *hook-before-prompts* nil "The hook that all threads shared before the first prompt.")

(defun shared-debugger-hook ()
  (cond ((find-if-not #'disabled-hook-p *prompt-debugger-hooks*))
        (*prompt-debugger-hooks* (first *prompt-debugger-hooks*))
        (t *hook-before-prompts*)))

(defclass prompts () ()
  (:documentation "The front end of running prompts: asks users how to continue after breaks."))

(setf *front-end* (make-instance 'prompts))

;; When an editor connects it replaces the prompts; they ask again when it has gone.
(defmethod hook-of-front-end ((prompts prompts))
  (and *prompt-debugger-hooks* (shared-debugger-hook)))

(defun add-prompt-hook (hook)
  (with-lock (*sessions-lock*)
    (unless *prompt-debugger-hooks* (setf *hook-before-prompts* (global-debugger-hook)))
    (push hook *prompt-debugger-hooks*)
    (setf (global-debugger-hook) (shared-debugger-hook))))

(defun remove-prompt-hook (hook)
  (with-lock (*sessions-lock*)
    (setf *prompt-debugger-hooks* (remove hook *prompt-debugger-hooks* :count 1)
          (global-debugger-hook) (shared-debugger-hook))))

(defun other-front-end-answers-p ()
  "True if another front end, say an editor, answers breaks and the simulator started this thread."
  (let ((hook (global-debugger-hook)))
    (and (own-thread-p) (null *prompt-debugger-hooks*) hook (not (disabled-hook-p hook)))))

(defun call-sharing-hook (hook function)
  "Call FUNCTION, a prompt, with HOOK as debugger hook; threads without a prompt may share HOOK."
  (with-debugger-hook (hook)
    (if (other-front-end-answers-p)
        (funcall function)
        (progn (add-prompt-hook hook)
               (unwind-protect (funcall function)
                 (remove-prompt-hook hook))))))

;;; Programs that read typed input in the thread of a run or of plans.

;;; Only the thread of the prompt reads what is typed. So a program that reads in another one
;;; breaks, and ANSWER continues it with a line.

(define-condition answer-wanted (condition) ()
  (:documentation "A program reads typed input in a thread other than a prompt's.")
  (:report "A program reads a line; ANSWER gives it one"))

(defclass asking-text (typed-text) ()
  (:documentation "The input stream of programs in the thread of a run. It asks the users of prompts
for each line. Without a terminal or window, it reads the original input."))

(defun ask-for-program-input ()
  "Ask a prompt's user for a program's input line. Return the line, or NIL if the user has gone."
  (restart-case (invoke-debugger (make-condition 'answer-wanted))
    (answer (&optional line)
      :report "Give the program the text that follows, or the line typed next."
      :interactive (lambda () (list (string-left-trim " " (read-line *query-io* nil ""))))
      line)))

(defun sessions-to-ask ()
  "Return the sessions whose users can answer a break in this thread: the session of this thread,
else all sessions in its simulation, else the newest session."
  (let ((own *session*))
    (cond ((and own (eq (session-thread own) (current-thread))) (list own))
          ((remove-if-not #'session-terminal-p (sessions-showing *simulation*)))
          ((and own (session-terminal-p own)) (list own)))))

(defmethod next-typed-line ((stream asking-text))
  (let ((line (if (sessions-to-ask)
                  (ask-for-program-input)
                  (read-line (typed-octets stream) nil))))
    (if line (format nil "~A~%" line) "")))

(defmethod program-input ((prompts prompts) stream)
  (make-instance 'asking-text :octets stream))
