;;;; user-macros.lisp -- macros for users: a wrong use is reported as MALFORMED-DEFINITION.

(in-package :ars-magna.definitions)

(export '(define-user-macro advice-on-use wrong-keyword-text test-advice body-advice user-macro-form
          call-blaming-form variable-after-key))

;;; Macros of DEFMACRO signal Lisp's own errors when they are misused, and do not end on circular
;;; lists. Those of DEFINE-USER-MACRO signal MALFORMED-DEFINITION for every mistake in the form, at
;;; its position, also inside other forms.

(defun reject-use-of (form expected &optional condition)
  "Signal MALFORMED-DEFINITION about FORM, a use of a macro. EXPECTED describes a valid form;
CONDITION is the error that occurred, or NIL."
  (reject-clause (if (consp (rest form))
                     (definition-title (first form) (second form))
                     (string-downcase (first form)))
                 (abridged form)
                 (format nil "~A~@[ (~A)~]" expected
                         (and condition
                              (abridged (string-right-trim "." (text-of-condition condition)))))))

(defun call-blaming-form (function form)
  "Call FUNCTION, which expands FORM. Report errors other than ARS-MAGNA-ERROR as mistakes in FORM."
  (handler-case
      (call-reporting-mistakes function (lambda (condition)
                                          (reject-use-of form "forms that Lisp can compile"
                                                         condition)))
    (storage-condition ()
      (reject-use-of form "less deeply nested forms, and macros without endless recursion"))))

(defgeneric advice-on-use (operator form)
  (:documentation "Return a text that says what to write in place of FORM, a use of the macro
OPERATOR that does not fit its lambda list; or NIL.")
  (:method (operator form)
    (declare (ignore operator form))
    nil))

(defun wrong-keyword-text (parameters arguments)
  "Return a text about the first wrong keyword in ARGUMENTS for the lambda list PARAMETERS: a
keyword that is unknown or has no value, or another form. Return NIL if no keyword is wrong."
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
  "Return a text about the first of ARGUMENTS that does not fit the lambda list PARAMETERS: a
wrong keyword, or a form in place of a list. Return NIL if no argument is wrong."
  (when (proper-list-p arguments)
    (or (wrong-keyword-text parameters arguments)
        (loop for parameter in parameters
              for argument in arguments
              until (member parameter lambda-list-keywords)
              thereis (and (consp parameter)
                           (if (and argument (atom argument))
                               (format nil "~(~A~) is no list" (unqualified-text argument))
                               (misfit-text parameter argument)))))))

(defun warn-of-nisp-syntax (form)
  "Warn if FORM has a symbol such as !>robot.cameras, because Lisp's reader has read Nisp's syntax."
  (let ((slot (find-part (lambda (part)
                           (and part (symbolp part)
                                (< 2 (length (symbol-name part)))
                                (starts-with-subseq "!>" (symbol-name part))))
                         form)))
    (when slot
      (warn-of-style "~A has been read as a symbol, not as a slot. Begin your file or session ~
                      with (in-readtable :nisp)." slot))))

(defun call-parsing-form (form usage parse)
  "Call PARSE, which parses FORM, and then the function that PARSE returns. Signals
MALFORMED-DEFINITION with USAGE, an example of a valid form, if FORM does not fit."
  (when (or (endless-p form) (not (proper-list-p form)))
    (reject-use-of form "a form that is a proper list"))
  (warn-of-nisp-syntax form)
  (call-blaming-form
   (handler-case (funcall parse)
     (error ()
       (reject-use-of form (let ((*print-pretty* nil))
                             (format nil "~(~A~)~@[; ~A~]" (abridged usage)
                                     (or (advice-on-use (first form) form)
                                         (misfit-text (rest usage) (rest form))))))))
   form))

(defun expand-parsing-form (form environment usage parse)
  "Return the value of CALL-PARSING-FORM. Inside another form or a compiled file, if
CALL-PARSING-FORM signals MALFORMED-DEFINITION, return a form that signals this error later."
  (first (forms-or-rejection (lambda () (list (call-parsing-form form usage parse)))
                             (nested-form-p environment))))

(defun variable-after-key (key lambda-list)
  "Return the variable after KEY in LAMBDA-LIST, or NIL; and LAMBDA-LIST without KEY and variable."
  (let ((rest (member key lambda-list)))
    (values (second rest) (append (ldiff lambda-list rest) (cddr rest)))))

(defun user-macro-form (name lambda-list usage body)
  "Return the form that defines the macro NAME with LAMBDA-LIST and BODY. If a use of the
macro does not fit LAMBDA-LIST, or BODY signals an error, the use signals MALFORMED-DEFINITION, with
the form USAGE as an example."
  (multiple-value-bind (body declarations documentation) (parse-body body :documentation t)
    (multiple-value-bind (environment rest) (variable-after-key '&environment lambda-list)
      (multiple-value-bind (whole parameters) (variable-after-key '&whole rest)
        (with-gensyms (form arguments)
          (let ((environment (or environment (gensym "ENVIRONMENT"))))
            `(defmacro ,name (&whole ,form &rest ,arguments &environment ,environment)
               ,@(when documentation (list documentation))
               (declare (ignore ,arguments))
               (expand-parsing-form ,form ,environment ',usage
                                    (lambda ()
                                      (let (,@(when whole `((,whole ,form))))
                                        ,@(when whole `((declare (ignorable ,whole))))
                                        (destructuring-bind ,parameters (rest ,form)
                                          ,@declarations
                                          (lambda () ,@body))))))))))))

(defmacro define-user-macro (name lambda-list &body body)
  "Define the macro NAME for users, like DEFMACRO. If a use of the macro does not fit
LAMBDA-LIST, or BODY signals an error, the use signals MALFORMED-DEFINITION."
  (let ((shown (nth-value 1 (variable-after-key
                             '&whole
                             (nth-value 1 (variable-after-key '&environment lambda-list))))))
    `(progn
       ,(user-macro-form name lambda-list (cons name shown) body)
       (show-lambda-list ',name ',shown)
       ',name)))

;;; Forms that are tests. A function is always true, whatever it would return.

(defun body-form (forms)
  (if (= 1 (length forms)) (first forms) (cons 'progn forms)))

(defun intended-test (form)
  "If FORM, a test, is quoted data or a function, return a list of the intended form; else NIL."
  (typecase form
    ((cons (eql quote) (cons (not null) null))
     (let ((data (second form)))
       (list (if (and (symbolp data) (fboundp data) (not (boundp data))) (list data) data))))
    ((cons (eql function) (cons symbol null)) (list (list (second form))))
    ((cons (eql function) (cons cons null)) (intended-test (second form)))
    ((cons symbol (cons list))
     (and (string= "LAMBDA" (first form)) (list (body-form (cddr form)))))))

(defun test-advice (form)
  "If FORM, a test, is always true (quoted data or a function), return a text of advice; else NIL."
  (let ((meant (intended-test form)) (*print-case* :downcase) (*print-pretty* t)
        (*print-right-margin* 10000))
    (and meant
         (format nil "~S is ~:[a function~;data~], which always counts as true. Write only the ~
                      form: ~S."
                 (abridged form) (eq 'quote (first form)) (abridged (first meant))))))

(defun body-advice (forms)
  "If FORMS, a body, is only a lambda form, never called, return a text of advice; else NIL."
  (let ((form (first forms)) (*print-case* :downcase) (*print-pretty* nil))
    (and (typep form '(cons symbol (cons list)))
         (null (rest forms))
         (string= "LAMBDA" (first form))
         (format nil "the body is a function, ~S, which is never called. Write only the body of ~
                      the function: ~S."
                 (abridged form) (abridged (body-form (cddr form)))))))
