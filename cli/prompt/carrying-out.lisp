;;;; carrying-out.lisp -- doing what a line says.

(in-package :ars-magna.cli)

(defun expand-alias (text &optional known)
  "Return TEXT with the alias that it begins with, if any, replaced; again, but each only once."
  (multiple-value-bind (name rest) (split-line text)
    (let ((alias (assoc name *aliases* :test #'string-equal)))
      (if (and alias (not (member alias known)))
          (expand-alias (concatenate 'string (second alias) rest) (cons alias known))
          text))))

(defun unhurried-p (line)
  "True if what LINE prints is to be seen as it comes."
  (or (line-full-name line)
      (member (line-name line) '("EVAL" "REPEAT" "TRIAL" "FORK" "WATCH") :test #'string=)))

(defun run-line (session line text)
  "Do what LINE does with the arguments in TEXT. What it prints comes out in one piece."
  (let ((arguments (read-arguments line text)))
    (if (unhurried-p line)
        (apply (line-action line) session arguments)
        (write-string (with-output-to-string (*standard-output*)
                        (apply (line-action line) session arguments))))))

(defun run-text (session text)
  "Do what TEXT, a line as typed, says; what it asks for, the prompt asks for."
  (let ((*asker* +asker+))
    (cond ((comment-p text))
          ((lisp-p text) (evaluate-text session text))
          (t (let ((text (expand-alias text)))
               (if (lisp-p text)
                   (evaluate-text session text)
                   (multiple-value-bind (name rest) (split-line text)
                     (run-line session (find-line name) rest))))))))
