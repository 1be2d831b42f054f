;;;; answers.lisp -- a program that reads what is typed, in the thread of a run or of plans.

(in-package :ars-magna.cli)

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

(defmethod next-typed-line ((stream asking-text))
  (let ((line (if (sessions-to-ask)
                  (ask-for-answer)
                  (read-line (typed-octets stream) nil))))
    (if line (format nil "~A~%" line) "")))

(defmethod input-of-programs ((prompts prompts) stream)
  (make-instance 'asking-text :octets stream))
