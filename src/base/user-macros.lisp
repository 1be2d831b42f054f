;;;; user-macros.lisp -- macros that users write: what does not fit them is told as ours.

(in-package :ars-magna.base)

;;; Macros made by DEFMACRO signal errors of Lisp's where they are not used as they should be, and
;;; look for the end of a circle. DEFINE-USER-MACRO's do not: whatever is wrong with the form, it is
;;; a MALFORMED-DEFINITION, where it stands and in forms around it too.

(defun unlike-ours-p (condition)
  (not (typep condition 'ars-magna-error)))

(defun reject-use-of (form expected &optional condition)
  "Signal MALFORMED-DEFINITION about FORM, the use of a macro, perhaps because of CONDITION."
  (reject-clause (if (consp (rest form))
                     (title (first form) (second form))
                     (string-downcase (first form)))
                 (abridged form)
                 (format nil "~A~@[ (~A)~]" expected
                         (and condition
                              (abridged (string-right-trim "." (text-of-condition condition)))))))

(defun call-blaming-form (function form)
  "Call FUNCTION, which expands FORM. Errors that are not ours are mistakes in what the author wrote
there."
  (handler-case
      (handler-bind ((error (lambda (condition)
                              (when (unlike-ours-p condition)
                                (reject-use-of form "forms that Lisp can compile" condition)))))
        (funcall function))
    (storage-condition ()
      (reject-use-of form "forms that are less deep, and macros that come to an end"))))

(defun call-fitting (form usage parse)
  "Call what PARSE, a function, returns; that takes apart FORM, the use of a macro as USAGE shows."
  (unless (proper-form-p form) (reject-use-of form "a form that ends, in a parenthesis"))
  (call-blaming-form (handler-case (funcall parse)
                       (error () (reject-use-of form (usage-text usage))))
                     form))

(defun usage-text (usage)
  (let ((*print-pretty* nil)) (format nil "~(~A~)" (abridged usage))))

(defun proper-form-p (form)
  (and (not (endless-p form)) (proper-list-p form)))

(defun expand-fitting (form environment usage parse)
  "Return what CALL-FITTING does; in other forms or in a file that is compiled, a form that signals
later what that signals."
  (first (forms-or-rejection (lambda () (list (call-fitting form usage parse)))
                             (nested-p environment))))

(defun variable-after (key lambda-list)
  "Return the variable that comes after KEY in LAMBDA-LIST, or NIL; and LAMBDA-LIST without both."
  (let ((rest (member key lambda-list)))
    (values (second rest) (append (ldiff lambda-list rest) (cddr rest)))))

(defun user-macro-form (name lambda-list usage body)
  "Return the form that defines the macro NAME with LAMBDA-LIST and BODY. A use of it that does not
fit, or which BODY makes nothing of, signals MALFORMED-DEFINITION; USAGE, a form, says what fits."
  (multiple-value-bind (body declarations documentation) (parse-body body :documentation t)
    (multiple-value-bind (environment rest) (variable-after '&environment lambda-list)
      (multiple-value-bind (whole parameters) (variable-after '&whole rest)
        (with-gensyms (form arguments)
          (let ((environment (or environment (gensym "ENVIRONMENT"))))
            `(defmacro ,name (&whole ,form &rest ,arguments &environment ,environment)
               ,@(when documentation (list documentation))
               (declare (ignore ,arguments))
               (expand-fitting ,form ,environment ',usage
                               (lambda ()
                                 (let (,@(when whole `((,whole ,form))))
                                   ,@(when whole `((declare (ignorable ,whole))))
                                   (destructuring-bind ,parameters (rest ,form)
                                     ,@declarations
                                     (lambda () ,@body))))))))))))

(defmacro define-user-macro (name lambda-list &body body)
  "Define the macro NAME, which users write, as DEFMACRO does. A use of it that does not fit
LAMBDA-LIST, or which BODY makes nothing of, signals MALFORMED-DEFINITION."
  (let ((shown (nth-value 1 (variable-after
                             '&whole (nth-value 1 (variable-after '&environment lambda-list))))))
    `(progn
       ,(user-macro-form name lambda-list (cons name shown) body)
       (show-lambda-list ',name ',shown)
       ',name)))
