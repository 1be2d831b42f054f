;;;; manipulations.lisp -- actions on things that users define by methods (manual 5.5).

(in-package :ars-magna.command)

(export '(define-manipulation method-signature manipulation-method))

;;; A manipulation is a name with methods, the newest first. When it begins, it chooses the first
;;; method that takes the arguments and fits the designated things. The method must still fit after
;;; its delay. Then its body runs as a command's operation on the value of its :BY parameter.
;;;
;;; A method replaces one with the same parameter list. When a changed file is loaded again, the
;;; methods that it no longer contains are removed, so a method with edited parameters leaves no old
;;; version behind. A method typed at a REPL replaces one with the same variables, types and
;;; attributes, unless no thing could fit both.

(define-record (parameter-list (:constructor make-parameter-list (objects patterns robots typed)))
  "The parameters of a method: the variables and the patterns of its objects, whether each object is
a robot, and a list (variable type) for its resource and for each other parameter. The type may be
NIL."
  (objects '() list)
  (patterns '() list)
  (robots '() list)
  (typed '() list))

(define-record (manipulation-method (:conc-name method-))
  "One way to carry out a manipulation."
  (form '() list)
  (source '() list "the source of the method's definition; see SOURCE-OF-CURRENT-FORM" :export)
  (digest nil (or null integer) "a digest of the form of the method's definition, or NIL" :export)
  (parameters nil parameter-list)
  (success 1d0 double-float)
  (delay 0 tick-count)
  (body nil function))

(defmethod reference ((method manipulation-method))
  (list :method (method-form method)))

(define-record (manipulation (:constructor make-manipulation (name)))
  "A named action on things."
  (name nil symbol "the symbol that names the manipulation" :writable :addition)
  (methods '() list "a list of the methods of the manipulation, the newest first" :writable :export)
  (command nil (or null command)
           "the command that carries out the manipulation, or NIL before its first use" :writable))

(define-registry manipulation "manipulation" :object-p manipulation-p)

(defmethod print-object ((manipulation manipulation) stream)
  (print-unreadable-object (manipulation stream :type t)
    (princ (manipulation-name manipulation) stream)))

;;; Parameter lists.

(defun hyphen-p (object)
  (and (symbolp object) (string= object "-")))

(defun variable-p (object)
  (and object (symbolp object) (not (constantp object)) (not (hyphen-p object))
       (not (member object lambda-list-keywords))))

(defun robot-name-p (object)
  (and (symbolp object) (string= object "ROBOT")))

(defun parse-object (definition specification)
  "Return the pattern of SPECIFICATION, what follows an object's hyphen, and whether the object is a
robot: SPECIFICATION is a descriptor, ROBOT, or a list of ROBOT and a descriptor's clauses."
  (cond ((robot-name-p specification) (values '() t))
        ((and (consp specification) (robot-name-p (first specification)))
         (values (parse-pattern definition (rest specification)) t))
        (t (values (parse-pattern definition specification) nil))))

(defun parse-objects (definition list)
  "Return three lists: the variables and the patterns in LIST, the parameters before :BY, and
whether each is a robot."
  (loop for (variable hyphen specification) on list by #'cdddr
        for rest = list then (cdddr rest)
        unless (and (variable-p variable) (hyphen-p hyphen) (cddr rest))
          do (reject-clause definition list
                            "variable - descriptor for each object, and then :BY")
        collect variable into variables
        collect (multiple-value-list (parse-object definition specification)) into parsed
        finally (return (values variables (mapcar #'first parsed) (mapcar #'second parsed)))))

(defun parse-typed-variables (definition list)
  "Return a list of (variable type) for the variables in LIST. A hyphen and a type may follow each."
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
  (unless (and (proper-list-p form) (rest (member :by form)))
    (reject-clause definition form "(variable - descriptor ... :BY resource other...)"))
  (multiple-value-bind (objects patterns robots)
      (parse-objects definition (ldiff form (member :by form)))
    (let* ((typed (parse-typed-variables definition (rest (member :by form))))
           (variables (append objects (mapcar #'first typed))))
      (unless (equal variables (remove-duplicates variables))
        (reject-clause definition form "a different variable for each parameter"))
      (make-parameter-list objects patterns robots typed))))

(defun parameter-variables (parameters)
  (append (parameter-list-objects parameters)
          (mapcar #'first (parameter-list-typed parameters))))

(defun method-signature (method)
  "Return three values: the variables of METHOD's objects, a list (variable type) for its resource,
and a list of lists (variable type) for its other parameters. The type is NIL where none is given."
  (destructuring-bind (by . others) (parameter-list-typed (method-parameters method))
    (values (parameter-list-objects (method-parameters method)) by others)))

;;; Defining.

(defun check-option (definition option value type)
  (unless (argument-of-type-p value type)
    (reject-clause definition (list option value) (argument-type-text type)))
  value)

(defmethod advice-on-use ((operator (eql 'defmanipulation)) form)
  (and (consp (cddr form))
       (null (cdddr form))
       "the list of options comes after the parameters, () for none"))

(defun outdated-method-p (name method source)
  "True if METHOD of NAME comes from an earlier version of SOURCE's file, and is no longer in it."
  (let ((old (method-source method)))
    (and source
         (equal (source-file old) (source-file source))
         (not (equal old source))
         (not (part-in-file-p (source-file source) (list 'defmanipulation name)
                              (method-form method))))))

(defun edited-method-p (old method)
  "True if OLD and METHOD were typed, not read from files, and METHOD looks like an edited OLD."
  (let ((parameters (method-parameters old)) (others (method-parameters method)))
    (and (null (method-source old)) (null (method-source method))
         (equal (parameter-variables parameters) (parameter-variables others))
         (equal (parameter-list-typed parameters) (parameter-list-typed others))
         (equal (parameter-list-robots parameters) (parameter-list-robots others))
         (every #'similar-patterns-p
                (parameter-list-patterns parameters) (parameter-list-patterns others)))))

(defun replace-old-methods (name methods method)
  "Return METHODS of NAME with METHOD in front, without those that METHOD replaces (reading 174)."
  (let* ((current (remove-if (lambda (old) (outdated-method-p name old (method-source method)))
                             methods))
         (old (or (find (method-form method) current :key #'method-form :test #'value-equal)
                  (find-if (lambda (old) (edited-method-p old method)) current))))
    (cons method (remove old current))))

(defun warn-if-in-other-files (name methods method)
  (let* ((file (source-file (method-source method)))
         (files (mapcar (lambda (old) (source-file (method-source old))) methods))
         (others (remove nil files)))
    (when (and others (not (member file files :test #'equal)))
      (warn-of-definition "The manipulation ~(~A~) has methods from ~{~A~^, ~} too: they are used ~
                           where no newer method fits. (undefine 'manipulation '~(~A~)) removes ~
                           all methods."
                          name (remove-duplicates others :test #'equal) name))))

(defun define-manipulation (name form body &key (success 1) (delay 0))
  "Define a method of the manipulation NAME, as DEFMANIPULATION does. FORM is the method's parameter
list, BODY a function of these parameters. Return NAME."
  (let* ((definition (definition-title "defmanipulation" name))
         (manipulation (or (find-manipulation name nil) (make-manipulation name)))
         (method (make-manipulation-method
                  :form form :source (current-source) :digest (current-form-digest)
                  :parameters (parse-parameters definition form) :body body
                  :success (double (check-option definition :success success 'probability))
                  :delay (check-option definition :delay delay 'tick-span))))
    (dolist (pattern (parameter-list-patterns (method-parameters method)))
      (warn-of-misspellings definition "a pattern" pattern))
    (warn-if-in-other-files name (manipulation-methods manipulation) method)
    (setf (manipulation-methods manipulation)
          (replace-old-methods name (manipulation-methods manipulation) method))
    (unless (find-manipulation name nil)
      (register *manipulations* name manipulation))
    name))

(defun warn-of-type (definition type)
  "Warn if the parameter type TYPE is no argument type or class, but resembles an argument type."
  (unless (or (not (symbolp type)) (find-argument-type type nil) (find-class type nil))
    (let ((like (similar-argument-type type)))
      (when like
        (warn-of-style "~A: no type is called ~(~A~), so any value fits. Did you mean ~(~A~)?"
                          definition type like)))))

(defun manipulation-forms (definition name parameters options body)
  (check-name definition name "manipulation")
  (unless (typep options '(or null (cons keyword)))
    (reject-clause definition options
                   "a list of options before the body, such as (:success 9/10), or () for none"))
  (check-options definition options '(:success :delay))
  (let* ((parsed (parse-parameters definition parameters))
         (variables (parameter-variables parsed)))
    (loop for (nil type) in (parameter-list-typed parsed) do (warn-of-type definition type))
    (when (body-advice body) (warn-of-style "~A: ~A" definition (body-advice body)))
    `((define-manipulation ',name ',parameters
        (lambda ,variables (declare (ignorable ,@variables)) ,@body)
        ,@options))))

(public defmanipulation)
(define-user-macro defmanipulation (&whole form name parameters options &body body
                                    &environment environment)
  "Define a method of the manipulation NAME (manual 5.5.1). PARAMETERS is
  (variable - descriptor ... :by resource other ...)
Each variable of an object is bound to a thing that fits the descriptor ((attribute value
[threshold]) ...) exactly. Instead of a descriptor, ROBOT or (robot (attribute value [threshold])
...) binds the variable to another robot, with such attributes. A value may be a matchvar ?x, which
has the same value wherever it occurs. A hyphen and a type may follow the resource and each other
parameter. The resource is the robot or part that the command occupies. OPTIONS is ([:success
probability] [:delay ticks]), by default 1 and 0. BODY runs in a tick; it returns an error code or
NIL, and a value. Of several methods that fit, the newest is used. A method replaces an older method
with the same parameter list. Loading a changed file again removes the methods that it no longer
contains. Signals MALFORMED-DEFINITION. Return NAME."
  (let ((definition (definition-title "defmanipulation" name)))
    (expand-definition form environment
                       (lambda ()
                         (manipulation-forms definition name parameters options body)))))

(define-shared-types command manipulation manipulation-method)

(define-facts (manipulation manipulation)
  "Methods, the newest first" (format nil "~{~A~^; ~}"
                                      (mapcar (lambda (method) (fact-text (method-form method)))
                                              (manipulation-methods manipulation))))
