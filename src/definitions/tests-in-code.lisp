;;;; tests-in-code.lisp -- tests in code that are never true, or always.

(in-package :ars-magna.definitions)

(export '(test-doubt map-calls map-comparisons compared-words tested-in values-used-in
          code-doubt))

(defgeneric test-doubt (form)
  (:documentation "Return in a sentence why FORM, a test in Lisp code, is not what is meant; or NIL.
The layer that knows fluents has methods.")
  (:method (form) (declare (ignore form)) nil))

;;; Words that something is compared with: keywords, and what may be meant for one.

(defun word-p (object)
  "True if OBJECT, a constant, may be meant for a word such as an error code."
  (or (stringp object) (and (symbolp object) (not (member object '(nil t otherwise))))))

(defun words-in (object)
  (if (consp object)
      (remove-if-not #'word-p (ldiff object (cdr (last object))))
      (and (word-p object) (list object))))

(defun constant-word (form)
  (cond ((typep form '(cons (eql quote) (cons symbol null))) (second form))
        ((or (keywordp form) (stringp form)) form)))

(defun compared-words (form)
  "Return the words that FORM compares something with, and the form of that; NIL if it does not."
  (let ((arguments (rest form)))
    (flet ((is (count &rest names)
             (and (member (first form) names)
                  (proper-list-p arguments)
                  (= count (length arguments)))))
      (cond ((and (is 2 'eq 'eql 'equal) (constant-word (second arguments)))
             (values (words-in (constant-word (second arguments))) (first arguments)))
            ((is 2 'eq 'eql 'equal)
             (values (words-in (constant-word (first arguments))) (second arguments)))
            ((and (is 2 'member) (typep (second arguments) '(cons (eql quote) (cons t null))))
             (values (words-in (second (second arguments))) (first arguments)))
            ((and (member (first form) '(case ecase ccase)) (proper-list-p arguments))
             (values (loop for clause in (rest arguments)
                           when (consp clause) append (words-in (first clause)))
                     (first arguments)))))))

(defun map-calls (function form)
  "Call FUNCTION with each list in FORM, code, that may be a call: none that is quoted."
  (when (and (consp form) (not (eq 'quote (first form))))
    (funcall function form)
    (loop for rest = form then (cdr rest)
          while (consp rest) do (map-calls function (car rest)))))

(defun map-comparisons (function form)
  "Call FUNCTION with each form in FORM, code, that is compared with a word, that word, and the form
that compares them."
  (map-calls (lambda (call)
               (multiple-value-bind (words subject) (compared-words call)
                 (dolist (word words) (funcall function subject word call))))
             form))

;;; Where values are used.

(defun lisp-call-p (form &rest names)
  "True if FORM is a proper list that calls an operator, of no user's, that has one of NAMES."
  (and (typep form '(cons symbol))
       (proper-list-p form)
       (not (users-symbol-p (first form)))
       (member (first form) names :test #'string=)
       t))

(defun tested-in (form)
  "Return the tests in FORM, a call, if that is a condition."
  (cond ((lisp-call-p form "IF" "WHEN" "UNLESS") (list (second form)))
        ((lisp-call-p form "COND") (mapcar #'first (remove-if #'atom (rest form))))))

(defun values-used-in (form)
  "Return the forms whose values FORM, a call, binds, stores or tests."
  (cond ((lisp-call-p form "LET" "LET*")
         (loop for binding in (and (proper-list-p (second form)) (second form))
               when (typep binding '(cons t (cons t null))) collect (second binding)))
        ((lisp-call-p form "SETQ" "SETF") (loop for (nil value) on (rest form) by #'cddr
                                             collect value))
        ((lisp-call-p form "DOLIST") (and (typep (second form) '(cons t (cons t)))
                                       (list (second (second form)))))
        ((lisp-call-p form "CASE" "ECASE") (list (second form)))
        (t (tested-in form))))

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
  (if (keywordp word)
      (unknown-code-doubt word)
      (let ((code (find word *error-codes* :test #'string-equal)))
        (and code
             (format nil "~(~S~) is no error code: they are keywords. Write ~(~S~)." word code)))))

(defun unknown-code-doubt (word)
  (unless (member word *error-codes*)
    (if (member word +words-of-success+)
        (format nil "no command ends with ~(~S~): its error code is NIL if it succeeds." word)
        (let ((like (code-like word)))
          (and like (format nil "no command ends with ~(~S~). Did you mean ~(~S~)?" word like))))))
