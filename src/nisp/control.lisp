;;;; control.lisp -- IF and LOOP, assignment, vectors; taking types out of lists.

(in-package :ars-magna.nisp)

(export '(untyped-bindings untyped-lambda-list lambda-list-variables))

;;; From here on IF and LOOP mean ours in this package; both expand to Common Lisp's at once.

(eval-when (:compile-toplevel :load-toplevel :execute)
  (defun doubt-test (operator test)
    (cl:let ((doubt (doubtful-test-text test)))
      (when doubt (warn-of-style "~(~A~): ~A" operator doubt)))))

(public if)
(defmacro if (test then &rest else)
  "Evaluate THEN if TEST is true, else any number of forms ELSE (manual, Figure D.5; reading 40)."
  (doubt-test 'if test)
  `(cl:if ,test ,then ,@(cl:if (rest else) `((progn ,@else)) else)))

(eval-when (:compile-toplevel :load-toplevel :execute)
  (defun loop-keyword (forms)
    "Return :UNTIL or :WHILE if FORMS, a LOOP's body, begin with a symbol of this name; else NIL."
    (and (symbolp (first forms))
         (find (first forms) '(:until :while) :test #'string=))))

(public loop)
(defmacro loop (&rest forms)
  "Evaluate the body forms again and again: (loop UNTIL test body...) until the test is true, (loop
WHILE test body...) while the test is true. The test comes before each round. Other FORMS have their
meaning in CL:LOOP (manual, Figure D.3)."
  (cl:let ((keyword (loop-keyword forms)))
    (when keyword (doubt-test 'loop (second forms)))
    ;; What follows the test is no keyword of Lisp's LOOP.
    (if (and keyword (consp (third forms)))
        `(cl:loop ,keyword ,(second forms) :do (progn ,@(cddr forms)))
        `(cl:loop ,@forms))))

(public !=)
(defmacro != (place value &rest more)
  "Set PLACE to VALUE, and likewise for each pair in MORE, as SETF does (manual 3.1; reading 14)."
  `(setf ,place ,value ,@more))

(public nop)
(defun nop ()
  "Do nothing for a moment, so that other threads can run. Return nothing (manual, Figure D.3)."
  (yield-thread)
  (values))

;;; Vectors.

(defun check-vref (vector index)
  (check-argument vref vector (typep vector 'sequence) "a vector or a list")
  (check-argument vref index (and (integerp index) (< -1 index (length vector)))
                  (format nil "the index of one of ~D elements, from 0" (length vector))))

(public vref)
(settable vref)
(defun vref (vector index)
  "Return element INDEX, from 0, of VECTOR (a vector or a list). Can be set (manual 3.1.3)."
  (check-vref vector index)
  (elt vector index))

(defun (setf vref) (value vector index)
  (check-vref vector index)
  (setf (elt vector index) value))

;;;; The types that programs use, by name

;;; Types are known by name, whatever package it was read in. A layer registers a type when it
;;; is loaded; after that the registry is only read.

(defstruct (nisp-type (:constructor make-nisp-type (name)) (:copier nil))
  "A registered type of Nisp. If objects of the type have slots, CLASS is their Lisp class, and
SLOTS is an alist from names of slots to names of readers."
  (name "" :type string :read-only t)
  (class nil :type symbol)
  (slots '() :type list)
  (maker nil :type (or null function))
  (parameters '() :type list))

(defvar *nisp-types* (make-hash-table :test 'equal)
  "A table of all registered types by name.")

(defun find-nisp-type (name)
  (values (gethash (string name) *nisp-types*)))

(defun ensure-nisp-type (name)
  (ensure-gethash (string name) *nisp-types* (make-nisp-type (string name))))

(defun exported-class-names (package)
  "Return the names of the classes that PACKAGE exports; NIL if there is no such package."
  (and (find-package package)
       (loop for symbol being the external-symbols of package
             when (find-class symbol nil) collect (symbol-name symbol))))

(defun known-type-names ()
  "Return a sorted list of the names of registered types and of classes that NISP and ARS export."
  (sort (remove-duplicates (append (loop for name being the hash-keys of *nisp-types* collect name)
                                   (exported-class-names "NISP")
                                   (exported-class-names "ARS"))
                           :test #'string=)
        #'string<))

;;;; Lists without types

;;; A hyphen and a type after a variable declare its type (manual 3.1). Types are documentation:
;;; required, then dropped, known or not. A name like that of a known type causes a warning.

(defun hyphen-p (form)
  (and (symbolp form) (string= form "-")))

(defun lambda-keyword-p (form)
  (member form lambda-list-keywords))

(defun similar-type (type)
  "If TYPE is unknown, return the name of a known type that may be meant; else NIL."
  (and type
       (symbolp type)
       (not (find-nisp-type type))
       (not (find-class type nil))
       (find-if (lambda (name) (misspelling-p type name)) (known-type-names))))

(defun warn-of-misspelt-type (operator type)
  (when (similar-type type)
    (warn-of-style "~A: there is no type ~(~A~). Did you mean ~(~A~)?"
                   operator type (similar-type type))))

(defun without-types (operator list what)
  "Return LIST without hyphens and types. Error messages call its elements WHAT, and name OPERATOR."
  (unless (listp list) (reject-clause operator list (format nil "a list of ~A" what)))
  (loop with typed = t                  ; nothing to declare yet
        with tail = list
        while (consp tail)
        for element = (pop tail)
        if (hyphen-p element)
          do (when (or typed (atom tail) (hyphen-p (first tail)))
               (reject-clause operator list "each hyphen between a variable and its type"))
             (warn-of-misspelt-type operator (pop tail))
             (setf typed t)
        else
          do (setf typed (lambda-keyword-p element))
          and collect element))

(defun untyped-lambda-list (lambda-list &optional (operator "lambda"))
  "Return LAMBDA-LIST as an ordinary lambda list, without the hyphen and type that may follow each
variable. Error messages name OPERATOR, a string (manual 3.1)."
  (without-types operator lambda-list "parameters"))

(defun untyped-bindings (bindings &optional (operator "let"))
  "Return BINDINGS without the hyphen and type that may follow each of them, as CL:LET accepts them.
Error messages name OPERATOR, a string (manual 3.1)."
  (without-types operator bindings "bindings"))

(defun parameter-variables (parameter)
  (if (atom parameter)
      (list parameter)
      (destructuring-bind (name &optional default (supplied nil supplied-p)) parameter
        (declare (ignore default))
        (cons (if (consp name) (second name) name)
              (and supplied-p (list supplied))))))

(defun lambda-list-variables (lambda-list)
  "Return the variables bound by LAMBDA-LIST, an ordinary lambda list without types."
  (mapcan #'parameter-variables
          (remove-if #'lambda-keyword-p lambda-list)))
