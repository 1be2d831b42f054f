;;;; keywords.lisp -- functions that say which keywords they know when they are given another.

(in-package :ars-magna.basics)

(export '(define-with-keywords))

(defun check-keywords (operator known options)
  "Signal UNKNOWN-NAME if the list OPTIONS, given to OPERATOR, has a keyword that is not one of
KNOWN."
  (loop for (key) on options by #'cddr
        unless (or (member key known) (eq key :allow-other-keys))
          do (reject-name (format nil "keyword of ~(~A~)" operator) key known)))

(defun warn-of-keywords (operator known options)
  "Warn, while a call of OPERATOR is compiled, of a keyword among the forms OPTIONS that is not one
of KNOWN, and of a number in the place of one."
  (loop for (key) on options by #'cddr
        when (and (keywordp key) (not (member key known)) (not (eq key :allow-other-keys)))
          do (simple-style-warning "~(~A~) has no keyword ~(~S~); it knows ~{~(~S~)~^, ~}."
                                   operator key known)
        when (realp key)
          do (doubt-definition "~(~A~): ~S stands where a keyword should. Write one before it: ~
                                ~{~(~S~)~^, ~}." operator key known)))

(defun with-options (lambda-list)
  "Return LAMBDA-LIST with any keywords allowed, the variable of all that are given, which are
known, and how many arguments come before them."
  (destructuring-bind (required optional rest keys allowed aux keys-p)
      (multiple-value-list (parse-ordinary-lambda-list lambda-list))
    (declare (ignore optional allowed aux keys-p))
    (let ((options (or rest (gensym "OPTIONS"))) (place (position '&key lambda-list)))
      (values (append required (list '&rest options) (subseq lambda-list place)
                      '(&allow-other-keys))
              options
              (mapcar #'caar keys)
              (length required)))))

(defmacro define-with-keywords (name lambda-list documentation &body body)
  "Define the function NAME as DEFUN does, with LAMBDA-LIST, which has keywords and nothing optional
besides. Called with a keyword that is not among these it signals UNKNOWN-NAME, which lists them;
the compiler warns of such a call."
  (multiple-value-bind (all options known count) (with-options lambda-list)
    (multiple-value-bind (forms declarations) (parse-body body)
      `(progn
         (defun ,name ,all
           ,documentation
           ,@declarations
           (check-keywords ',name ',known ,options)
           ,@forms)
         (define-compiler-macro ,name (&whole form &rest arguments)
           (warn-of-keywords ',name ',known (nthcdr ,count arguments))
           form)
         (show-lambda-list ',name ',lambda-list #',name)
         ',name))))
