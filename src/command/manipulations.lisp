;;;; manipulations.lisp -- what programs do to things by methods of their own (manual 5.5).

(in-package :ars-magna.command)

;;; A manipulation is a name with methods. Of those that take what was given, the first that is for
;;; the things designated is chosen when the manipulation begins; it must still be for them when its
;;; delay has passed. What happens then is a command's operation on the value of the method's
;;; :BY parameter.

(defstruct (parameter-list (:constructor make-parameter-list (objects patterns by others))
                           (:copier nil))
  "The parameters of a method: variables and patterns of its objects, and then its resource and
others, each a list (variable type), with NIL for no type."
  (objects '() :type list :read-only t)
  (patterns '() :type list :read-only t)
  (by '() :type list :read-only t)
  (others '() :type list :read-only t))

(defstruct (manipulation-method (:conc-name method-) (:copier nil))
  "One way to carry out a manipulation."
  (form '() :type list :read-only t)
  (parameters nil :type parameter-list :read-only t)
  (success 1d0 :type double-float :read-only t)
  (delay 0 :type tick-count :read-only t)
  (body nil :type function :read-only t))

(defstruct (manipulation (:constructor make-manipulation (name)) (:copier nil))
  "A named action on things. COMMAND, made when it is first needed, carries it out."
  (name nil :type symbol :read-only t)
  (methods '() :type list)
  (command nil :type (or null command)))
(addition manipulation-name)
(document-functions
  manipulation-name "Return the symbol that the manipulation is called.")

(defvar *manipulations* '() "All manipulations, in order of definition.")

(addition all-manipulations)
(defun all-manipulations ()
  "Return a list of the names of all manipulations, in order of definition."
  (mapcar #'manipulation-name *manipulations*))

(defun lookup-manipulation (name)
  (find name *manipulations* :key #'manipulation-name :test #'same-name-p))

(addition find-manipulation)
(defun find-manipulation (name)
  "Return the manipulation called NAME, a symbol or string. Signals UNKNOWN-NAME."
  (or (and (typep name '(or symbol string)) (lookup-manipulation name))
      (reject-name "manipulation" name (all-manipulations))))

;;; Parameter lists.

(defun hyphen-p (object)
  (and (symbolp object) (string= object "-")))

(defun variable-p (object)
  (and object (symbolp object) (not (constantp object)) (not (hyphen-p object))
       (not (member object lambda-list-keywords))))

(defun parse-objects (definition list)
  "Return the variables and patterns in LIST, the parameters before :BY."
  (loop for (variable hyphen specification) on list by #'cdddr
        for rest = list then (cdddr rest)
        unless (and (variable-p variable) (hyphen-p hyphen) (cddr rest))
          do (reject-clause definition list
                            "variable - descriptor for each object, and then :BY")
        collect variable into variables
        collect (parse-pattern definition specification) into patterns
        finally (return (values variables patterns))))

(defun parse-typed (definition list)
  "Return a list (variable type) for each of the variables in LIST, which types may follow."
  (loop while list
        collect (let ((variable (pop list)))
                  (unless (variable-p variable)
                    (reject-clause definition variable "a variable, perhaps with - and its type"))
                  (list variable (when (and list (hyphen-p (first list)))
                                   (unless (rest list)
                                     (reject-clause definition list "a type after the hyphen"))
                                   (pop list)
                                   (pop list))))))

(defun parse-parameters (definition form)
  "Return the PARAMETER-LIST that FORM stands for. Signals MALFORMED-DEFINITION."
  (unless (and (proper-list-p form) (rest (member :by form)))
    (reject-clause definition form "(variable - descriptor ... :BY resource other...)"))
  (multiple-value-bind (objects patterns) (parse-objects definition (ldiff form (member :by form)))
    (let* ((typed (parse-typed definition (rest (member :by form))))
           (variables (append objects (mapcar #'first typed))))
      (unless (equal variables (remove-duplicates variables))
        (reject-clause definition form "a different variable for each parameter"))
      (make-parameter-list objects patterns (first typed) (rest typed)))))

(defun parameter-variables (parameters)
  "Return the variables of PARAMETERS, in order."
  (append (parameter-list-objects parameters)
          (list (first (parameter-list-by parameters)))
          (mapcar #'first (parameter-list-others parameters))))

;;; Defining.

(defun check-option (definition option value type expected)
  (unless (typep value type)
    (reject-clause definition (list option value) expected))
  value)

(defun check-method-options (definition options)
  (unless (and (proper-list-p options) (evenp (length options))
               (loop for key in options by #'cddr always (member key '(:success :delay))))
    (reject-clause definition options "([:success probability] [:delay ticks])")))

(defun ensure-manipulation (name)
  (or (lookup-manipulation name)
      (let ((new (make-manipulation name)))
        (setf *manipulations* (append *manipulations* (list new)))
        new)))

(defun add-method-to (manipulation method)
  "Let MANIPULATION have METHOD, instead of one with the same parameter list or after all others."
  (let ((old (find (method-form method) (manipulation-methods manipulation)
                   :key #'method-form :test #'value-equal)))
    (setf (manipulation-methods manipulation)
          (if old
              (substitute method old (manipulation-methods manipulation))
              (append (manipulation-methods manipulation) (list method))))))

(defun define-manipulation (name form body &key (success 1) (delay 0))
  "Define a method of the manipulation NAME; what DEFMANIPULATION expands to. FORM is its
parameter list, BODY a function of as many arguments. Return NAME."
  (let ((definition (format nil "defmanipulation ~(~A~)" name)))
    (add-method-to
     (ensure-manipulation name)
     (make-manipulation-method
      :form form :parameters (parse-parameters definition form) :body body
      :success (double (check-option definition :success success '(real 0 1)
                                     "a probability from 0 to 1"))
      :delay (check-option definition :delay delay 'tick-count "a number of ticks, 0 or more")))
    name))

(public defmanipulation)
(defmacro defmanipulation (name parameters options &body body)
  "Define a method of the manipulation NAME (manual 5.5.1). PARAMETERS is
  (variable - descriptor ... :by resource other ...)
where each object's variable will be bound to a thing that is exactly as the descriptor
((attribute value [threshold]) ...) says. A value may be a matchvar ?x, which stands for the same
value wherever it occurs. A hyphen and a type may follow the resource, which is what the
scheduler arbitrates, and each of the others. OPTIONS is ([:success probability] [:delay ticks]),
by default 1 and 0. BODY runs in a tick; it returns an error code or NIL, and a value.
A method with the same parameter list is replaced. Signals MALFORMED-DEFINITION. Return NAME."
  (let ((definition (format nil "defmanipulation ~(~A~)" name)))
    (unless (and name (symbolp name))
      (reject-clause definition name "a symbol as the name of the manipulation"))
    (check-method-options definition options)
    (let ((variables (parameter-variables (parse-parameters definition parameters))))
      `(define-manipulation ',name ',parameters
         (lambda ,variables (declare (ignorable ,@variables)) ,@body)
         ,@options))))
