;;;; user-macros.lisp -- macros that users write: what does not fit them is told as ours.

(in-package :ars-magna.definitions)

(export '(define-user-macro advice-on-use strange-keyword test-advice body-advice user-macro-form
          call-blaming-form variable-after))

;;; Macros made by DEFMACRO signal errors of Lisp's where they are not used as they should be, and
;;; look for the end of a circle. DEFINE-USER-MACRO's do not: whatever is wrong with the form, it is
;;; a MALFORMED-DEFINITION, where it stands and in forms around it too.

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
      (call-blaming function (lambda (condition)
                               (reject-use-of form "forms that Lisp can compile" condition)))
    (storage-condition ()
      (reject-use-of form "forms that are less deep, and macros that come to an end"))))

(defgeneric advice-on-use (operator form)
  (:documentation "Return in words what else to write for FORM, a use of the macro OPERATOR that
does not fit its lambda list, or NIL.")
  (:method (operator form)
    (declare (ignore operator form))
    nil))

(defun strange-keyword (parameters arguments)
  "Return in words the first of ARGUMENTS that stands where a keyword of PARAMETERS, of a macro's
lambda list, should and is none of them; or NIL."
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
  "Return in words what it is in ARGUMENTS, forms, that does not fit PARAMETERS, of a macro's lambda
list: a keyword, or a form where there should be a list. Return NIL if it is something else."
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
  "Warn if FORM has in it, as a symbol, what only Nisp's reader reads, such as !>robot.cameras."
  (let ((slot (part-with (lambda (part)
                           (and part (symbolp part)
                                (< 2 (length (symbol-name part)))
                                (starts-with-subseq "!>" (symbol-name part))))
                         form)))
    (when slot
      (doubt-definition "~A has been read as a symbol, not as a slot. Begin your file or session ~
                         with (in-readtable :nisp)." slot))))

(defun call-fitting (form usage parse)
  "Call what PARSE, a function, returns; that takes apart FORM, the use of a macro as USAGE shows."
  (when (or (endless-p form) (not (proper-list-p form)))
    (reject-use-of form "a form that ends, in a parenthesis"))
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

;;; Forms that are tests. A function is true, whatever it would return.

(defun body-form (forms)
  (if (= 1 (length forms)) (first forms) (cons 'progn forms)))

(defun test-meant (form)
  "Return in a list the form whose value is meant where FORM, a test, is quoted or a function; NIL
if it is neither."
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
  "Return in sentences that FORMS, a body, is nothing but a function, which is never called, and
what to write; else NIL."
  (let ((form (first forms)) (*print-case* :downcase) (*print-pretty* nil))
    (and (typep form '(cons symbol (cons list)))
         (null (rest forms))
         (string= "LAMBDA" (first form))
         (format nil "the body is a function, ~S, which is made and never called. Write what is in ~
                      it alone: ~S."
                 (abridged form) (abridged (body-form (cddr form)))))))
