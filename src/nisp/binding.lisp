;;;; binding.lisp -- forms that bind variables: LET, \, DEFFUNC, MATCHQ and so on.

(in-package :ars-magna.nisp)

(export '(matchvar matchvar-p make-matchvar))

;;; From here on LET means ours in this package.

(public let)
(defmacro let (bindings &body body)
  "Evaluate BODY with BINDINGS, as CL:LET does; a hyphen and a type may follow each binding:
(let ((v init) - TYPE (w init)) ...) (manual 3.1)."
  `(cl:let ,(untyped-bindings bindings) ,@body))

(public \\)
(defmacro \\ (lambda-list &body body)
  "Return the function (lambda LAMBDA-LIST BODY...); a hyphen and a type may follow each parameter
(manual 3.1). The operator is one backslash, which is typed as two. See reading 4."
  `#'(lambda ,(untyped-lambda-list lambda-list "\\") ,@body))

(defun check-continuation (lambda-list body)
  "Signal MALFORMED-DEFINITION, or warn, if a CONTINUATION has its body in place of LAMBDA-LIST."
  (let ((*print-pretty* nil) (*print-case* :downcase) (shown (abridged lambda-list)))
    (when (consp lambda-list)
      (cond ((some #'constantp (ldiff lambda-list (member-if #'lambda-keyword-p lambda-list)))
             (reject-clause "continuation" shown
                            (format nil "parameters before the body: (continuation (err &rest ~
                                         results) ~S)" shown)))
            ((and (null body) (symbolp (first lambda-list)) (fboundp (first lambda-list)))
             (warn-of-style "continuation: ~S is taken for the list of parameters, and the body ~
                             is empty. Write (continuation (err &rest results) ~:*~S)."
                            shown))))))

(defun warn-of-wrong-error-codes (variable body)
  "Warn if BODY of a CONTINUATION compares VARIABLE with a keyword that is no error code."
  (map-comparisons (lambda (subject word form)
                     (declare (ignore form))
                     (cl:let ((doubt (and (eq subject variable) (wrong-error-code-text word))))
                       (when doubt (warn-of-style "continuation: ~A" doubt))))
                   body))

(public continuation)
(defmacro continuation (lambda-list &body body)
  "Return a function that a robot command calls with an error code (NIL: no error) and its results.
The form is like LAMBDA, but types may follow the parameters, and unused parameters cause no warning
(manual 3.1.1; reading 39)."
  (let ((lambda-list (untyped-lambda-list lambda-list "continuation")))
    (check-continuation lambda-list body)
    (warn-of-wrong-error-codes (first lambda-list) body)
    (multiple-value-bind (forms declarations) (parse-body body)
      `#'(lambda ,lambda-list
           (declare (ignorable ,@(lambda-list-variables lambda-list)))
           ,@declarations
           (noting-assignments () ,@forms)))))

(eval-when (:compile-toplevel :load-toplevel :execute)
  (defun expand-procedure (operator name definition)
    "Return the DEFUN form for the form (OPERATOR NAME REST...). REST is an optional hyphen and
result type, then the parameters and the body."
    (let ((definition (if (hyphen-p (first definition)) (cddr definition) definition))
          (operator (format nil "~(~A ~A~)" operator name)))
      (check-function-name operator name)
      (when (or (null definition) (not (listp (first definition))))
        (reject-clause operator (first definition) "a list of parameters after the result type"))
      `(defun ,name ,(untyped-lambda-list (first definition) operator)
         ,@(rest definition)))))

(public deffunc)
(defmacro deffunc (name &rest definition)
  "Define NAME as a function without side effects: (deffunc name - TYPE (args) body...). Types may
follow the parameters (manual 3.1)."
  (expand-procedure 'deffunc name definition))

(public defproc)
(defmacro defproc (name &rest definition)
  "Define NAME as a procedure with side effects: (defproc name - TYPE (args) body...). Types may
follow the parameters (manual 3.1)."
  (expand-procedure 'defproc name definition))

;;;; Matchvars and MATCHQ (manual 5.1.1, 5.5.1)

;;; ?x is read as a matchvar, an object that means itself. There is one for each name, so that
;;; patterns with the same matchvars are EQUAL, also after a trip through a compiled file.

(define-record (matchvar (:constructor %make-matchvar (name))
                         (:predicate matchvar-p "True of a matchvar: ?x, or the anonymous ?()."))
  "A variable in a pattern, which matches anything: ?x, or ?() without a name (manual 5.5.1)."
  (name nil symbol "the symbol that a matchvar is called, NIL for the anonymous one" :export))

(defun make-matchvar (name)
  "Return the matchvar named NAME, a symbol. If NAME is NIL, return an anonymous matchvar."
  (check-argument make-matchvar name (symbolp name) "a symbol")
  (or (get name 'matchvar)
      (setf (get name 'matchvar) (%make-matchvar name))))

(defmethod print-object ((matchvar matchvar) stream)
  (let ((name (matchvar-name matchvar)))
    (format stream "?~:[()~;~:*~S~]" name)))

(defmethod make-load-form ((matchvar matchvar) &optional environment)
  (declare (ignore environment))
  `(make-matchvar ',(matchvar-name matchvar)))

;;; A pattern compiles to nested tests. TEMPORARIES is an alist from the names met so far, in the
;;; order of the tests, to the variables that hold what they matched.

(defun matchvar-test-form (name datum temporaries)
  (let ((known (assoc name temporaries)))
    (cond ((null name) (values t temporaries))
          (known (values `(value-equal ,(cdr known) ,datum) temporaries))
          (t (let ((temporary (gensym (symbol-name name))))
               (values `(progn (setq ,temporary ,datum) t)
                       (acons name temporary temporaries)))))))

(defun cons-test-form (pattern datum temporaries)
  (with-gensyms (first rest)
    (multiple-value-bind (first-test temporaries) (pattern-test-form (car pattern) first
                                                                     temporaries)
      (multiple-value-bind (rest-test temporaries) (pattern-test-form (cdr pattern) rest
                                                                      temporaries)
        (values `(and (consp ,datum)
                      (cl:let ((,first (car ,datum)) (,rest (cdr ,datum)))
                        (declare (ignorable ,first ,rest))
                        (and ,first-test ,rest-test)))
                temporaries)))))

(defun pattern-test-form (pattern datum temporaries)
  "Return two values: a form that tests if PATTERN matches the value of the variable DATUM; and
TEMPORARIES with new temporary variables for the matchvars in PATTERN."
  (cond ((matchvar-p pattern) (matchvar-test-form (matchvar-name pattern) datum temporaries))
        ((consp pattern) (cons-test-form pattern datum temporaries))
        ((null pattern) (values `(null ,datum) temporaries))
        ((eq pattern t) (values `(eq ,datum t) temporaries))
        (t (values `(value-equal ',pattern ,datum) temporaries))))

(public matchq)
(defmacro matchq (pattern datum)
  "True if PATTERN, which is not evaluated, matches the value of DATUM. ?x matches anything, but all
?x must match the same value. If PATTERN matches, each variable x is set to the value that ?x has
matched. ?() matches anything; symbols match by name, numbers by value (manual 5.1.1; reading 34)."
  (with-gensyms (value)
    (multiple-value-bind (test temporaries) (pattern-test-form pattern value '())
      `(cl:let ((,value ,datum) ,@(mapcar #'cdr temporaries))
         (declare (ignorable ,value))
         (when ,test
           (setq ,@(loop for (name . temporary) in (reverse temporaries)
                         append (list name temporary)))
           t)))))
