;;;; user-package.lisp -- DEFINE-USER-PACKAGE: packages that are ready to work in.

(in-package :ars-magna.faces)

;;; ARS and NISP extend some operators of Common Lisp and export the extensions under the same
;;; names. A package that uses all three has to say which it means: the extensions, which do what
;;; the originals do where those make sense.

(defun option-values (key options)
  (loop for (name . values) in options when (eq name key) append values))

(defun used-packages (definition names)
  "Return a list of the packages named NAMES, which the package of DEFINITION uses. Signals
MALFORMED-DEFINITION if one does not exist."
  (let ((missing (remove-if #'find-package names)))
    (when missing
      (reject-clause definition (cons :use names)
                     (format nil "packages that exist; first load what defines ~{~A~^, ~}"
                             missing))))
  (mapcar #'find-package names))

(defun standard-symbol (name)
  (multiple-value-bind (symbol status) (find-symbol name :cl)
    (and (eq status :external) symbol)))

(defun extensions-in (package)
  "Return a list of the names for which PACKAGE exports another symbol than Common Lisp does."
  (let ((names '()))
    (do-external-symbols (symbol package names)
      (unless (member (standard-symbol (symbol-name symbol)) (list nil symbol))
        (push (symbol-name symbol) names)))))

(defun shadowing-options (packages settled)
  "Return options of DEFPACKAGE that import the extensions in PACKAGES in place of Common Lisp's
symbols. If several packages extend a name, the last one is used. The names SETTLED are left out."
  (loop for package in (reverse packages)
        for names = (set-difference (extensions-in package) settled :test #'string=)
        when names
          collect `(:shadowing-import-from ,(package-name package) ,@(sort names #'string<))
        do (setf settled (append names settled))))

(defun settled-names (options)
  "Return a list of the names for which OPTIONS of DEFPACKAGE choose a symbol."
  (append (option-values :shadow options)
          (loop for (key nil . names) in options
                when (eq key :shadowing-import-from) append names)))

(defun conflicting-names (packages settled)
  "Return a list of the names, except SETTLED, under which PACKAGES export different symbols."
  (let ((symbols (make-hash-table :test #'equal)))
    (dolist (package packages)
      (do-external-symbols (symbol package)
        (pushnew symbol (gethash (symbol-name symbol) symbols))))
    (sort (loop for name being the hash-keys of symbols using (hash-value called-so)
                when (and (rest called-so) (not (member name settled :test #'string=)))
                  collect name)
          #'string<)))

(defun package-exporting (name packages)
  (find-if (lambda (package) (eq :external (nth-value 1 (find-symbol name package)))) packages))

(defun check-clashes (definition packages settled)
  "Signal MALFORMED-DEFINITION if PACKAGES export different symbols with a name not in SETTLED."
  (let ((names (conflicting-names packages settled)))
    (when names
      (let ((package (package-exporting (first names) packages)))
        (reject-clause definition (cons :use (mapcar #'package-name packages))
                       (format nil "an option that chooses the package of ~{~A~^, ~}, such as ~
                                    (:shadowing-import-from :~(~A #:~A~))"
                               names (package-name package) (first names)))))))

(defun clash-options (definition options)
  "Return options of DEFPACKAGE to resolve conflicts between Lisp and the packages of OPTIONS."
  (let* ((packages (used-packages definition (option-values :use options)))
         (settled (settled-names options))
         (added (when (member (find-package :cl) packages)
                  (shadowing-options packages settled))))
    (check-clashes definition packages (append settled (settled-names added)))
    added))

(defun user-package-options (definition options)
  (let ((bad (find-if-not #'consp options)))
    (when bad
      (reject-clause definition bad "an option of DEFPACKAGE, such as (:export #:kitchen)")))
  (let ((options (if (assoc :use options) options `((:use :cl :ars :nisp) ,@options))))
    (append options
            (clash-options definition options)
            (unless (find "XLIB" (option-values :local-nicknames options)
                          :key #'first :test #'string=)
              '((:local-nicknames (:xlib :ars-magna.canvas)))))))

(defun check-package-name (name)
  (unless (typep name '(or symbol string character))
    (reject-clause "define-user-package" name "a name, such as :my-house, for the package")))

(defun package-form (name options environment)
  (macroexpand-1 `(defpackage ,name
                    ,@(user-package-options (definition-title "define-user-package" name) options))
                 environment))

(addition define-user-package)
(define-user-macro define-user-package (&whole form name &rest options &environment environment)
  "Define the package NAME, ready to work in, as DEFPACKAGE does with OPTIONS. If OPTIONS do not
contain (:use ...), the package uses CL, ARS and NISP. If a used package extends a function of
Common Lisp, such as ARS:EQUAL or NISP:LOOP, the new package has the extension, unless OPTIONS
choose otherwise. XLIB is a local nickname of ARS-MAGNA.CANVAS. Signals MALFORMED-DEFINITION. Return
the package. See reading 213."
  (check-package-name name)
  `(eval-when (:compile-toplevel :load-toplevel :execute)
     ,(expand-definition form environment
                         (lambda () (list (package-form name options environment))))
     (find-package ',name)))

;;; At a REPL.

(defun greet ()
  "If a user has typed the form that loaded the system, print how to begin."
  (when (and (null *load-truename*) (null *compile-file-truename*) (debugger-available-p))
    (format t "~&; ARS MAGNA is loaded. To begin, type (in-package :ars-user), then (in-readtable ~
               :nisp).~%; (ars:define-user-package :mine) makes a package of your own.~%")))
