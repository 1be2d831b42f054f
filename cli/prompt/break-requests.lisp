;;;; break-requests.lisp -- reporting breaks and reading programs; which users are asked.

(in-package :ars-magna.cli)

(export '(awaited-answers ways-awaited simulator-broken-p asker-of-break answers-break-p))

(defvar *session* nil "The session that the debugger asks, in any thread; the newest.")

(defvar *asking-p* nil "True in a thread that has broken and asks how to continue.")

;;; What the user sees.

(defun whereabouts (session break-request)
  "Return in words where BREAK-REQUEST is, if not in the thread of SESSION."
  (words-for-thread session (break-request-thread break-request)))

(defun words-for-thread (session thread)
  "Return in words what THREAD is, if not that of SESSION."
  (cond ((eq thread (session-thread session)) nil)
        ((simulator-p session thread) "the simulator's thread")
        (t (format nil "another thread, ~A" (thread-name thread)))))

(defun simulator-p (session thread)
  "True if THREAD passes the ticks of the run that SESSION listens to."
  (let ((simulation (session-simulation session)))
    (and simulation (eq thread (simulation-thread simulation)))))

(defun break-text (session break-request)
  (format nil "*BREAK* -> ~A~@[ (in ~A)~]~%~:{  ~2D  ~16A ~A~%~}~
               A number chooses. BACKTRACE, PLAN-TREE tell where it is; (...) is Lisp.~%"
          (break-words (break-request-condition break-request))
          (whereabouts session break-request)
          (loop for restart in (break-request-restarts break-request)
                for number from 0
                collect (list number (plain-name (restart-name restart))
                              (complaint-text (own-text restart))))))

(defun tell-break (session break-request)
  "Show what has happened, and make the present prompt the debugger's."
  (let ((console (session-console session)))
    (setf (break-request-told-p break-request) t)
    (write-fitted console "~A" (break-text session break-request))
    (if (console-prompt console)
        (show-prompt console "Break> ")
        (finish-output console))))

(defun report-waiting-break (session break-request)
  (let ((console (session-console session)))
    (write-fitted console
                  "*BREAK* -> ~A~@[ (in ~A)~]. It waits until the one before is answered.~%"
                  (break-words (break-request-condition break-request))
                  (whereabouts session break-request))
    (restore-prompt console)))

(defun break-line (session break-request)
  "Return on one line what has broken, and where if not in the thread of SESSION."
  (let ((words (break-words (break-request-condition break-request))))
    (format nil "~A~@[ (in ~A)~]" (subseq words 0 (position #\Newline words))
            (whereabouts session break-request))))

(defun awaited-answers (session)
  "Return a list of texts on the breaks that wait for SESSION's user; the first is asked about now.
Any thread may ask."
  (mapcar (lambda (break-request) (break-line session break-request)) (breaks-awaiting session)))

(defun ways-awaited (session)
  "Return in words the restarts that SESSION's user can choose now, or NIL. Any thread may ask."
  (let ((break-request (first (breaks-awaiting session))))
    (and break-request
         (format nil "~{~A~^, ~}"
                 (loop for restart in (break-request-restarts break-request)
                       for number from 0
                       collect (format nil "~D ~A" number (plain-name (restart-name restart))))))))

(defun simulator-broken-p (session)
  "True if SESSION's user is asked about a break in the simulator's thread. Any thread may ask."
  (some (lambda (break-request) (simulator-p session (break-request-thread break-request)))
        (breaks-awaiting session)))

(defun asker-of-break (simulation)
  "Return a text, to follow others, if another debugger than the prompts' asks about a break in the
thread of SIMULATION; or NIL."
  (let ((debugger (debugger-asking (simulation-thread simulation))))
    (and debugger
         (notany #'simulator-broken-p (sessions-showing simulation))
         (format nil "and ~A waits for the answer" debugger))))

(defun answers-break-p (text)
  "True if TEXT, a line, is valid while any break is answered."
  (or (comment-p text) (lisp-p text)))

;;;; Who is asked

;;; Each prompt has a debugger hook for its own thread. All other threads share one, which depends
;;; on the running prompts, however they start and end: the debugger's if one of them can ask its
;;; user; else the one that reports that no user can answer; without prompts, the original hook.

(defvar *hooks-at-work* '() "The hooks of the running prompts, the newest first.")
(defvar *hook-before* nil "The hook that all threads shared before the first prompt.")

(defun hook-to-share ()
  (cond ((find-if-not #'disabled-hook-p *hooks-at-work*))
        (*hooks-at-work* (first *hooks-at-work*))
        (t *hook-before*)))

(defclass prompts () ()
  (:documentation "The running prompts, as the front end that asks their users."))

(setf *front-end* (make-instance 'prompts))

;; When an editor connects it replaces the prompts; they ask again when it has gone.
(defmethod hook-of-front-end ((prompts prompts))
  (and *hooks-at-work* (hook-to-share)))

(defun begin-sharing (hook)
  (with-lock (*sessions-lock*)
    (unless *hooks-at-work* (setf *hook-before* (global-debugger-hook)))
    (push hook *hooks-at-work*)
    (setf (global-debugger-hook) (hook-to-share))))

(defun end-sharing (hook)
  (with-lock (*sessions-lock*)
    (setf *hooks-at-work* (remove hook *hooks-at-work* :count 1)
          (global-debugger-hook) (hook-to-share))))

(defun answered-elsewhere-p ()
  "True if another front end, such as an editor, answers breaks, and this is not the thread of the
prompt in which it started."
  (let ((hook (global-debugger-hook)))
    (and (own-thread-p) (null *hooks-at-work*) hook (not (disabled-hook-p hook)))))

(defun call-sharing (hook function)
  "Call FUNCTION, a prompt, with HOOK as this thread's debugger hook, which others may share."
  (with-debugger-hook (hook)
    (if (answered-elsewhere-p)
        (funcall function)
        (progn (begin-sharing hook)
               (unwind-protect (funcall function)
                 (end-sharing hook))))))

;;; Programs that read typed input in the thread of a run or of plans.

;;; Only the thread of the prompt reads what is typed. So a program that reads in another one
;;; breaks, and ANSWER continues it with a line.

(define-condition answer-wanted (condition) ()
  (:documentation "A program reads typed input in a thread other than a prompt's.")
  (:report "A program reads a line; ANSWER gives it one"))

(defclass asking-text (typed-text) ()
  (:documentation "The input stream of programs in the thread of a run: it asks the users of prompts
for each line, or, without a terminal or window, reads from the original input."))

(defun ask-for-answer ()
  "Ask a prompt's user for the line that a program reads. Return it, or NIL if the user has gone."
  (restart-case (invoke-debugger (make-condition 'answer-wanted))
    (answer (&optional line)
      :report "Give it the text that follows, or is typed next."
      :interactive (lambda () (list (string-left-trim " " (read-line *query-io* nil ""))))
      line)))

(defun sessions-to-ask ()
  "Return the sessions whose users can answer a break in this thread: the one of this thread, or all
in its simulation, or the newest."
  (let ((own *session*))
    (cond ((and own (eq (session-thread own) (current-thread))) (list own))
          ((remove-if-not #'session-terminal-p (sessions-showing *simulation*)))
          ((and own (session-terminal-p own)) (list own)))))

(defmethod next-typed-line ((stream asking-text))
  (let ((line (if (sessions-to-ask)
                  (ask-for-answer)
                  (read-line (typed-octets stream) nil))))
    (if line (format nil "~A~%" line) "")))

(defmethod input-of-programs ((prompts prompts) stream)
  (make-instance 'asking-text :octets stream))
