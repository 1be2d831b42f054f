;;;; tests-in-code.lisp -- tests in code that are never true, or always.

(in-package :ars-magna.base)

;; The layer that knows fluents sets it.
(defvar *test-doubt* (constantly nil)
  "A function of a form, a test in Lisp code: it returns in a sentence why that is not what is
meant, or NIL.")

;;; Keywords that something is compared with.

(defun words-in (object)
  "Return the keywords that OBJECT, a keyword or a list of keys, has."
  (if (consp object)
      (remove-if-not #'keywordp (ldiff object (cdr (last object))))
      (and (keywordp object) (list object))))

(defun compared-words (form)
  "Return the keywords that FORM compares something with, and the form of that; NIL if it does not."
  (let ((arguments (rest form)))
    (flet ((is (count &rest names)
             (and (member (first form) names)
                  (proper-list-p arguments)
                  (= count (length arguments)))))
      (cond ((and (is 2 'eq 'eql 'equal) (keywordp (second arguments)))
             (values (words-in (second arguments)) (first arguments)))
            ((is 2 'eq 'eql 'equal)
             (values (words-in (first arguments)) (second arguments)))
            ((and (is 2 'member) (typep (second arguments) '(cons (eql quote) (cons t null))))
             (values (words-in (second (second arguments))) (first arguments)))
            ((and (member (first form) '(case ecase ccase)) (proper-list-p arguments))
             (values (loop for clause in (rest arguments)
                           when (consp clause) append (words-in (first clause)))
                     (first arguments)))))))

(defun map-comparisons (function form)
  "Call FUNCTION with each form in FORM, code, that is compared with a keyword, that keyword, and
the form that compares them."
  (when (and (consp form) (not (eq 'quote (first form))))
    (multiple-value-bind (words subject) (compared-words form)
      (dolist (word words) (funcall function subject word form)))
    (loop for rest = form then (cdr rest)
          while (consp rest) do (map-comparisons function (car rest)))))

;;; Error codes of commands.

(define-constant +words-of-success+ '(:done :ok :okay :success :succeeded :none :no-error)
  :test #'equal
  :documentation "Words that are no error codes, and that are meant for success.")

(defun code-like (word)
  "Return the error code that WORD, which is none, is written for; or NIL."
  (or (nearest-name word *error-codes*)
      (find-if (lambda (code)
                 (let ((code (symbol-name code)) (word (symbol-name word)))
                   (or (ends-with-subseq (format nil "-~A" word) code)
                       (starts-with-subseq (format nil "~A-" word) code))))
               *error-codes*)))

(defun code-doubt (word)
  "Return in a sentence why no command ends with the error code WORD, or NIL if one may."
  (unless (member word *error-codes*)
    (if (member word +words-of-success+)
        (format nil "no command ends with ~(~S~): its error code is NIL if it succeeds." word)
        (let ((like (code-like word)))
          (and like (format nil "no command ends with ~(~S~). Did you mean ~(~S~)?" word like))))))
