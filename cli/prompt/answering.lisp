;;;; answering.lisp -- what is called, while prompts are at work, when something breaks or reads.

(in-package :ars-magna.cli)

;;; Each prompt has a hook for what breaks in its own thread. All other threads share one, which
;;; follows from the prompts that are at work, in whatever order they come and go: the debugger's if
;;; one of them can ask its user; else the one that says that nobody sits there. Without prompts it
;;; is what it was before.

(defvar *hooks-at-work* '() "The hooks of the prompts that are at work, the newest first.")
(defvar *hook-before* nil "What hook all threads shared before the first of them.")

(defun hook-to-share ()
  (cond ((find-if-not #'disabled-hook-p *hooks-at-work*))
        (*hooks-at-work* (first *hooks-at-work*))
        (t *hook-before*)))

(defclass prompts () ()
  (:documentation "The prompts at work, as the front end that asks their users."))

(setf *front-end* (make-instance 'prompts))

;; An editor that comes takes the place of the prompts, who ask again when it has gone.
(defmethod hook-of-front-end ((prompts prompts))
  (and *hooks-at-work* (hook-to-share)))

(defun begin-sharing (hook)
  (with-lock (*sessions-lock*)
    (unless *hooks-at-work* (setf *hook-before* (common-debugger-hook)))
    (push hook *hooks-at-work*)
    (setf (common-debugger-hook) (hook-to-share))))

(defun end-sharing (hook)
  (with-lock (*sessions-lock*)
    (setf *hooks-at-work* (remove hook *hooks-at-work* :count 1)
          (common-debugger-hook) (hook-to-share))))

(defun answered-elsewhere-p ()
  "True if somebody else answers what breaks, such as an editor, and the prompt is not in the thread
in which he began it."
  (let ((hook (common-debugger-hook)))
    (and (own-thread-p)
         (null *hooks-at-work*)
         hook
         (not (disabled-hook-p hook)))))

(defun call-sharing (hook function)
  "Call FUNCTION, a prompt at work, while HOOK is the debugger's in this thread, and one of those
that others may share."
  (with-debugger-hook (hook)
    (if (answered-elsewhere-p)
        (funcall function)
        (progn (begin-sharing hook)
               (unwind-protect (funcall function)
                 (end-sharing hook))))))

;;; A program that reads what is typed, in the thread of a run or of plans.

;;; Only the thread that has the prompt reads what is typed. So what reads in another one breaks,
;;; and ANSWER is how it goes on, with a line.

(define-condition answer-wanted (condition) ()
  (:documentation "A program reads what is typed, in another thread than that of a prompt.")
  (:report "A program reads a line; ANSWER gives it one"))

(defclass asking-text (typed-text) ()
  (:documentation "What programs read in the thread of a run: the users of prompts are asked for
each line; where nobody sits, it is read from where else it would be."))

(defun ask-for-answer ()
  "Let the user of a prompt say what line a program reads. Return it, or NIL if he has gone."
  (restart-case (invoke-debugger (make-condition 'answer-wanted))
    (answer (&optional line)
      :report "Give it the text that follows, or is typed next."
      :interactive (lambda () (list (string-left-trim " " (read-line *query-io* nil ""))))
      line)))

(defun sessions-to-ask ()
  "Return the sessions whose users can say how what has broken in this thread is to go on: the one
of this thread, or all that listen to its simulation, or the newest."
  (let ((own *session*))
    (cond ((and own (eq (session-thread own) (current-thread))) (list own))
          ((remove-if-not #'session-terminal-p (sessions-hearing *simulation*)))
          ((and own (session-terminal-p own)) (list own)))))

(defmethod next-typed-line ((stream asking-text))
  (let ((line (if (sessions-to-ask)
                  (ask-for-answer)
                  (read-line (typed-octets stream) nil))))
    (if line (format nil "~A~%" line) "")))

(defmethod input-of-programs ((prompts prompts) stream)
  (make-instance 'asking-text :octets stream))
