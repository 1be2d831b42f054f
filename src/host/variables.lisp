;;;; variables.lisp -- which names can be variables.

(in-package :ars-magna.host)

(export '(users-symbol-p variable-name-p variable-forms variable-name-trouble))

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
