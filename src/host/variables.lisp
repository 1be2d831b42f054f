;;;; variables.lisp -- which names can be variables, and which mean nothing at all.

(in-package :ars-magna.host)

(export '(users-symbol-p variable-name-p variable-forms variable-name-trouble undefined-name
          still-undefined-p))

;;; What a user defines by a name can often be had as the value of a variable of that name too.

(defun variable-name-trouble (name)
  "Return in words why the symbol NAME, of a package, cannot become a special variable, or NIL."
  (let ((package (symbol-package name)))
    (cond ((package-locked-p package) (format nil "belongs to ~A" (package-name package)))
          ((constantp name) "is a constant")
          ((not (member (variable-kind name) '(nil :special)))
           "is a symbol macro or a global variable"))))

(defun users-symbol-p (name)
  "True if the symbol NAME is in a package whose names users may define."
  (let ((package (symbol-package name)))
    (and package
         (not (keywordp name))
         (not (package-locked-p package)))))

(defun variable-name-p (name)
  "True if the symbol NAME can become a special variable: constants cannot, nor what belongs to a
locked package, such as Common Lisp's or ours."
  (and name
       (symbol-package name)
       (null (variable-name-trouble name))))

(defun variable-forms (name)
  "Return the forms, perhaps none, that declare NAME a special variable."
  (when (variable-name-p name) `((defvar ,name))))

;;; Names that the compiler finds used, and that nobody has defined.

(defun undefined-name (condition)
  "Return the name that CONDITION, a warning of the compiler's, says is not defined, and whether as
a :FUNCTION or :VARIABLE; NIL if it says something else."
  (let ((arguments (and (typep condition '(and warning simple-condition))
                        (simple-condition-format-arguments condition))))
    (when (and (proper-list-p arguments)
               (= 2 (length arguments))
               (member (first arguments) '(:function :variable)))
      (values (second arguments) (first arguments)))))

(defun still-undefined-p (name kind)
  "True if NAME is not defined as KIND, a :FUNCTION or :VARIABLE, by now either."
  (ecase kind
    (:function (not (fboundp name)))
    (:variable (not (or (boundp name) (known-variable-p name nil))))))
