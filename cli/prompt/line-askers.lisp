;;;; line-askers.lisp -- which line has asked for what messages tell of.

(in-package :ars-magna.cli)

;;; What a line asks for while time stands still ends under a later line, such as RESUME. So where
;;; lines are counted, each asks by a text of its own: equal to that of others, but another object.

(define-constant +asker+ "the prompt" :test #'string=
  :documentation "Who asks for what lines ask for.")

;; Equal to that, but another object: an error of what a line has asked for is the line's.
(defparameter *line-asker* (copy-seq +asker+)
  "Who asks for what lines that are no Lisp ask for, where no lines are counted.")

(defvar *askers* (make-hash-table :test 'eq :weakness :key :synchronized t)
  "For each text that asks for a line: its account, its number, and true if it is no Lisp, a list.")

(defun asker-for (account &key typed-p (text +asker+))
  "Return who asks for what the line under way of ACCOUNT, or NIL, asks for: a text that says TEXT.
TYPED-P is true of a line that is no Lisp."
  (cond ((and account (line-under-way account))
         (let ((asker (copy-seq text)))
           (setf (gethash asker *askers*) (list account (account-line account) typed-p))
           asker))
        (typed-p *line-asker*)
        (t text)))

(defun line-asker-p (asker)
  "True if ASKER, of a message, asks for what lines that are no Lisp ask for."
  (or (eq *line-asker* asker) (third (gethash asker *askers*))))

(defun of-line-p (message)
  "True if MESSAGE tells of what a line that is counted has asked for, itself and not by a plan."
  (let ((asker (message-asker message)))
    (and (equal asker +asker+) (gethash asker *askers*) t)))

(defun lisp-asker-p (asker)
  "True if ASKER, of a request, asks for what Lisp in lines asks for."
  (and (equal asker +asker+) (not (line-asker-p asker))))

(defun of-lisp-in-line-p (asker account)
  "True if ASKER, of a request, asks for what Lisp in the line under way of ACCOUNT asks for."
  (destructuring-bind (&optional whose line typed-p) (gethash asker *askers*)
    (and (eq whose account) (eql line (account-line account)) (not typed-p))))

(defun note-plan-of-line (account plan)
  (when account (push (cons (asker-note plan) (line-under-way account)) (account-plans account))))

(defun line-of-message (account message)
  "Return the number of the line of ACCOUNT, or NIL, that has asked for what MESSAGE tells of; the
line under way if that is not known."
  (when account
    (let* ((asker (message-asker message))
           (plan (assoc asker (account-plans account) :test #'equal)))
      (destructuring-bind (&optional whose line typed-p) (gethash asker *askers*)
        (declare (ignore typed-p))
        (cond ((eq whose account) line)
              (plan (rest plan))
              (t (line-under-way account)))))))

(defun report-messages (account messages)
  (when (reports-p account)
    (dolist (message messages t)
      (report-message account (message-kind message) (message-text message)
                      (line-of-message account message)))))
