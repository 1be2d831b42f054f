;;;; user-macros.lisp -- macros for users: a wrong use is reported as MALFORMED-DEFINITION.

(in-package :ars-magna.definitions)

(export '(define-user-macro advice-on-use strange-keyword test-advice body-advice user-macro-form
          call-blaming-form variable-after))

;;; Macros of DEFMACRO signal Lisp's own errors when they are misused, and do not end on circular
;;; lists. Those of DEFINE-USER-MACRO signal MALFORMED-DEFINITION for every mistake in the form, at
;;; its position, also inside other forms.

(defun reject-use-of (form expected &optional condition)
  "Signal MALFORMED-DEFINITION about FORM, a use of a macro, perhaps because of CONDITION."
  (reject-clause (if (consp (rest form))
                     (title (first form) (second form))
                     (string-downcase (first form)))
                 (abridged form)
                 (format nil "~A~@[ (~A)~]" expected
                         (and condition
                              (abridged (string-right-trim "." (text-of-condition condition)))))))

(defun call-blaming-form (function form)
  "Call FUNCTION, which expands FORM. Errors that are not ours are reported as mistakes in FORM."
  (handler-case
      (call-blaming function (lambda (condition)
                               (reject-use-of form "forms that Lisp can compile" condition)))
    (storage-condition ()
      (reject-use-of form "forms that are less deep, and macros that come to an end"))))

(defgeneric advice-on-use (operator form)
  (:documentation "Return in words what to write instead of FORM, a use of the macro OPERATOR that
does not fit its lambda list, or NIL.")
  (:method (operator form)
    (declare (ignore operator form))
    nil))

(defun strange-keyword (parameters arguments)
  "Return in words the first of ARGUMENTS in the place of a keyword that is none of PARAMETERS, of a
macro's lambda list; or NIL."
  (let* ((keys (member '&key parameters))
         (before (remove '&optional
                         (ldiff parameters
                                (member-if (lambda (part) (member part '(&rest &body &key)))
                                           parameters))))
         (known (loop for key in (rest keys) collect (make-keyword (first (ensure-list key))))))
    (loop for (key . value) on (and keys (nthcdr (length before) arguments)) by #'cddr
          unless (member key known)
            return (format nil "there is no keyword ~(~S~)~@[; did you mean ~(~S~)?~]"
                           (abridged key) (and (keywordp key) (nearest-name key known)))
          unless value
            return (format nil "~(~S~) has no value" key))))

(defun misfit-text (parameters arguments)
  "Return in words the keyword, or form in place of a list, in ARGUMENTS that does not fit
PARAMETERS; or NIL."
  (when (proper-list-p arguments)
    (or (strange-keyword parameters arguments)
        (loop for parameter in parameters
              for argument in arguments
              until (member parameter lambda-list-keywords)
              thereis (and (consp parameter)
                           (if (and argument (atom argument))
                               (format nil "~(~A~) is no list" (unqualified-text argument))
                               (misfit-text parameter argument)))))))

(defun doubt-readtable (form)
  "Warn if FORM contains, as a symbol, syntax of Nisp's reader, such as !>robot.cameras."
  (let ((slot (find-part (lambda (part)
                           (and part (symbolp part)
                                (< 2 (length (symbol-name part)))
                                (starts-with-subseq "!>" (symbol-name part))))
                         form)))
    (when slot
      (doubt-definition "~A has been read as a symbol, not as a slot. Begin your file or session ~
                         with (in-readtable :nisp)." slot))))

(defun call-fitting (form usage parse)
  "Call the function that PARSE returns for FORM. Signals MALFORMED-DEFINITION with USAGE if it does
not fit."
  (when (or (endless-p form) (not (proper-list-p form)))
    (reject-use-of form "a form that is a proper list"))
  (doubt-readtable form)
  (call-blaming-form
   (handler-case (funcall parse)
     (error ()
       (reject-use-of form (let ((*print-pretty* nil))
                             (format nil "~(~A~)~@[; ~A~]" (abridged usage)
                                     (or (advice-on-use (first form) form)
                                         (misfit-text (rest usage) (rest form))))))))
   form))

(defun expand-fitting (form environment usage parse)
  "Do as CALL-FITTING; in other forms or a compiled file, return a form that signals its error."
  (first (forms-or-rejection (lambda () (list (call-fitting form usage parse)))
                             (nested-p environment))))

(defun variable-after (key lambda-list)
  "Return the variable after KEY in LAMBDA-LIST, or NIL; and LAMBDA-LIST without both."
  (let ((rest (member key lambda-list)))
    (values (second rest) (append (ldiff lambda-list rest) (cddr rest)))))

(defun user-macro-form (name lambda-list usage body)
  "Return the form that defines the macro NAME with LAMBDA-LIST and BODY. A use that does not fit,
or for which BODY signals an error, signals MALFORMED-DEFINITION; USAGE, a form, shows what fits."
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
  "Define the macro NAME for users, like DEFMACRO. A use that does not fit LAMBDA-LIST, or for which
BODY signals an error, signals MALFORMED-DEFINITION."
  (let ((shown (nth-value 1 (variable-after
                             '&whole (nth-value 1 (variable-after '&environment lambda-list))))))
    `(progn
       ,(user-macro-form name lambda-list (cons name shown) body)
       (show-lambda-list ',name ',shown)
       ',name)))

;;; Forms that are tests. A function is always true, whatever it would return.

(defun body-form (forms)
  (if (= 1 (length forms)) (first forms) (cons 'progn forms)))

(defun test-meant (form)
  "Return a list of the form meant by FORM, a test that is quoted or a function; else NIL."
  (typecase form
    ((cons (eql quote) (cons (not null) null))
     (let ((data (second form)))
       (list (if (and (symbolp data) (fboundp data) (not (boundp data))) (list data) data))))
    ((cons (eql function) (cons symbol null)) (list (list (second form))))
    ((cons (eql function) (cons cons null)) (test-meant (second form)))
    ((cons symbol (cons list))
     (and (string= "LAMBDA" (first form)) (list (body-form (cddr form)))))))

(defun test-advice (form)
  "Return in sentences that FORM, a test, is quoted or a function, and what to write; else NIL."
  (let ((meant (test-meant form)) (*print-case* :downcase) (*print-pretty* t)
        (*print-right-margin* 10000))
    (and meant
         (format nil "~S is ~:[a function~;data~], which always counts as true. Write the form ~
                      alone: ~S."
                 (abridged form) (eq 'quote (first form)) (abridged (first meant))))))

(defun body-advice (forms)
  "Return in sentences that FORMS, a body, is only a function, which is never called, and what to
write; else NIL."
  (let ((form (first forms)) (*print-case* :downcase) (*print-pretty* nil))
    (and (typep form '(cons symbol (cons list)))
         (null (rest forms))
         (string= "LAMBDA" (first form))
         (format nil "the body is a function, ~S, which is made and never called. Write what is in ~
                      it alone: ~S."
                 (abridged form) (abridged (body-form (cddr form)))))))
