;;;; names.lisp -- which names plans can bind, and the lists that these stand in.

(in-package :ars-magna.rpl.language)

(export '(check-variables plain-parameters))

(defun variable-trouble (name environment)
  "Return in words why NAME cannot be a lexical variable in ENVIRONMENT, or NIL. That it is special
is another matter."
  (cond ((not (symbolp name)) "is no symbol")
        ((or (null name) (keywordp name)) "is a constant")
        ((member name lambda-list-keywords) "is a word of lambda lists")
        (t (case (variable-kind name environment)
             (:constant "is a constant")
             (:global "is a global variable")))))

(defun check-variables (variables environment &optional (form nil form-p))
  "Signal MALFORMED-DEFINITION, about FORM if that is given, unless all of VARIABLES can be lexical
variables in ENVIRONMENT."
  (dolist (variable variables)
    (let ((trouble (variable-trouble variable environment)))
      (when trouble
        (reject-clause (author) (if form-p form variable)
                       (format nil "the name of a lexical variable; ~(~S~) ~A"
                               (abridged variable) trouble))))))

;;; Lambda lists.

(defun parameters-trouble (parameters environment)
  "Return in words why PARAMETERS, without types, are no ordinary lambda list, or NIL."
  (flet ((first-trouble (names)
           (loop for name in names
                 for trouble = (variable-trouble name environment)
                 when trouble return (format nil "~(~S~) ~A" name trouble))))
    (handler-case (parse-ordinary-lambda-list parameters :normalize nil)
      (error ()
        (return-from parameters-trouble
          (or (first-trouble (remove-if (lambda (parameter)
                                      (or (consp parameter)
                                          (member parameter lambda-list-keywords)))
                                    parameters))
              "this is none"))))
    (let* ((variables (lambda-list-variables parameters))
           (twice (find-if (lambda (variable) (< 1 (count variable variables))) variables)))
      (cond (twice (format nil "~(~S~) is there twice" twice))
            ((equal '(&rest) (last parameters)) "a variable comes after &rest")
            (t (first-trouble variables))))))

(defun forgotten-parameters-text (parameters environment)
  (and (typep parameters '(cons symbol))
       (known-function-p (first parameters) environment)
       "The list of parameters stands before the body; write () if there are none"))

(defun doubt-parameters (parameters definition environment)
  "Warn if one of PARAMETERS, of DEFINITION, is called like a function by which plans command the
robot: then they may be the first form of a body, with no list of parameters before it."
  (let ((name (find-if (lambda (name)
                         (and (starts-with-subseq "RPL-" (string name))
                              (known-function-p name environment)))
                       (lambda-list-variables parameters))))
    (when name
      (doubt-definition "~A: a parameter is called like the function ~(~A~). If (~1@*~(~A~)) is ~
                         the first form of the body, write the list of parameters before it: () ~
                         if there are none."
                        definition name))))

(defun plain-parameters (parameters form environment &optional (definition (author)))
  "Return PARAMETERS, of FORM in DEFINITION, without types. Signals MALFORMED-DEFINITION unless they
are a lambda list."
  (flet ((reject (trouble)
           (reject-clause definition (if (consp parameters) parameters form)
                          (format nil "an ordinary lambda list, such as (a &optional b &key c); ~
                                       ~A~@[. ~A~]"
                                  trouble (forgotten-parameters-text parameters environment)))))
    (unless (proper-list-p parameters) (reject "this is no list that ends"))
    (let* ((plain (untyped-lambda-list parameters definition))
           (trouble (parameters-trouble plain environment)))
      (when trouble (reject trouble))
      (doubt-parameters plain definition environment)
      plain)))

;;; Forms that bind, also where they are Lisp's to run.

(defun check-bindings (form environment)
  (let ((bindings (second form)))
    (unless (proper-list-p bindings)
      (reject-clause (author) form "(variable value) for each variable, in a list that ends"))
    (dolist (entry (untyped-bindings bindings (author)))
      (unless (typep entry '(or symbol (cons t (or null (cons t null)))))
        (reject-clause (author) (if (consp entry) entry form)
                       "(variable value) for each variable"))
      (check-variables (list (first (ensure-list (or entry '(nil))))) environment form))))

(defun check-local-functions (form environment)
  (unless (proper-list-p (second form))
    (reject-clause (author) form "(name parameters form...) for each, in a list that ends"))
  (dolist (definition (second form))
    (unless (and (typep definition '(cons t (cons list t))) (proper-list-p definition))
      (reject-clause (author) (if (consp definition) definition form)
                     "(name parameters form...) for each"))
    (plain-parameters (second definition) definition environment)))

(defun check-names (form environment)
  (flet ((is (&rest names) (operator-in-p form names)))
    (cond ((is "LET" "LET*") (check-bindings form environment))
          ((is "FLET" "LABELS") (check-local-functions form environment))
          ((is "MULTIPLE-VALUE-BIND")
           (when (proper-list-p (second form))
             (check-variables (second form) environment form)))
          ((is "DOLIST" "DOTIMES" "PAR-LOOP" "TRY-EACH-IN-ORDER")
           (when (typep (second form) '(cons t cons))
             (check-variables (list (first (second form))) environment form))))))
