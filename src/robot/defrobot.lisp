;;;; defrobot.lisp -- DEFROBOT: from its form to a robot (manual 5.2).

(in-package :ars-magna.robot)

(defun parse-camera (specification reject)
  (unless (and (listp specification) (= (length specification) 2)
               (finite-p (first specification)) (< 0 (first specification) (+ 2pi 1d-9))
               (typep (second specification) '(integer 1 32767)))
    (funcall reject specification
             "(field-of-view resolution): radians above 0, at most 2 pi, and 1 to 32767 pixels"))
  (list 'camera :field-of-view (double (first specification))
                :resolution (second specification)))

(defun amount-parser (kind initarg)
  "Return a function that parses an amount, which specifies a part of KIND, as the value of INITARG.
PARSE-CAMERA is such a function for cameras."
  (lambda (amount reject)
    (unless (amount-p amount)
      (funcall reject amount (argument-type-text 'amount)))
    (list kind initarg (double amount))))

(defun map-choices-text (name)
  (let ((names (mapcar #'map-name (all-maps))))
    (if names
        (format nil "a map: ~{~(~A~)~^, ~}~@[; did you mean ~(~A~)?~]"
                names (nearest-name name names))
        "a map; there is none yet")))

(defun parse-start (environment position angle reject)
  (unless (typep environment '(or map symbol string))
    (funcall reject environment "a map or its name"))
  (let ((map (or (find-map environment nil)
                 (funcall reject environment (map-choices-text environment)))))
    (destructuring-bind (x y) position
      (unless (and (sane-number-p x) (sane-number-p y))
        (funcall reject position "a position (x y), two numbers from -1e9 to 1e9"))
      (let ((trouble (start-problem-text map x y)))
        (when trouble
          (funcall reject position (format nil "a free position in ~(~A~); ~A"
                                           (map-name map) trouble))))
      (unless (sane-number-p angle)
        (funcall reject angle (argument-type-text 'angle)))
      map)))

(defun settable-slots (kind)
  "Return the slots of the part KIND that DEFROBOT may set: the fixed slots except ROBOT and INDEX."
  (remove-if-not (lambda (slot)
                   (and (eq :fixed (kind-slot-role slot))
                        (not (member (kind-slot-name slot) '(robot index)))))
                 (kind-slots kind)))

(defun slot-value-text (slot)
  (format nil "~(~S~), of type ~(~S~), ~A" (make-keyword (kind-slot-name slot))
          (kind-slot-type slot) (kind-slot-text slot)))

(defun parse-initarg (kind initarg value)
  "Return a list of INITARG and VALUE, converted for a part of KIND; NIL if either is invalid."
  (let ((slot (and (keywordp initarg)
                   (find initarg (settable-slots kind)
                         :key #'kind-slot-name :test #'same-name-p))))
    (when (and slot (or (not (realp value)) (finite-p value)))
      ;; A type such as (double-float 0d0) takes 6 as 6d0.
      (let ((value (if (and (realp value) (subtypep (kind-slot-type slot) 'double-float))
                       (double value)
                       value)))
        (when (typep value (kind-slot-type slot))
          (list initarg value))))))

(defun parse-initargs (kind specification reject)
  (loop for (initarg value) on (rest specification) by #'cddr
        append (or (parse-initarg kind initarg value)
                   (funcall reject specification
                            (format nil "for a ~(~A~), ~:[only its name~;its name and initargs ~
                                         from: ~:*~{~A~^; ~}~]"
                                    (kind-name kind)
                                    (mapcar #'slot-value-text (settable-slots kind)))))))

(defun parse-part (specification reject)
  "Return SPECIFICATION, (kind initarg value ...), with values converted to their slots' types."
  (let ((kind (and (proper-list-p specification)
                   (find (first specification) (all-kinds 'part) :key #'kind-name))))
    (unless (and kind
                 (not (member (kind-name kind) '(part camera hand storage-bin)))
                 (evenp (length (rest specification))))
      (funcall reject specification
               (format nil "(kind initarg value ...), a kind of part that DEFINE-KIND has defined; ~
                            cameras, hands and bins have options of their own")))
    (cons (kind-name kind) (parse-initargs kind specification reject))))

;;; Each option has its own syntax for parts.

(defun camera-form (camera cameras value)
  (declare (ignore cameras))
  (if (proper-list-p camera)
      `(list ,@(loop for form in camera collect (funcall value form camera)))
      (funcall value camera camera)))

(defun amount-form (amount amounts value)
  (funcall value amount amounts))

(defun part-form (specification parts value)
  (declare (ignore parts))
  (if (and (proper-list-p specification) specification)
      `(list ',(first specification)
             ,@(loop for (initarg form) on (rest specification) by #'cddr
                     collect initarg
                     collect (funcall value form specification)))
      `',specification))

(defparameter *part-options*
  (list (list :cameras #'camera-form #'parse-camera
              "a list of lists after :cameras: ((3 500)) is one camera that sees 3 radians wide, ~
               in 500 pixels")
        (list :hands #'amount-form (amount-parser 'hand :strength)
              "a list of strengths after :hands: (10) is one hand of strength 10")
        (list :bins #'amount-form (amount-parser 'storage-bin :capacity)
              "a list of capacities after :bins: (20) is one bin of capacity 20")
        (list :parts #'part-form #'parse-part
              "a list of lists after :parts, (kind initarg value ...)"))
  "The options of DEFROBOT for parts, in the order of ROBOT-PARTS. Each entry lists the option and:
- a function that returns a form for a part; its arguments are the part as written, the value of the
  option, and a function of a form and its clause; it returns a form that evaluates the given form
- a function that returns a list (kind initarg value ...) for a part; its arguments are the value of
  the part's form, and a function that rejects a value
- a format string that says what should follow the option")

(defun parse-body-attributes (name attributes)
  "Return ATTRIBUTES, an object descriptor, for the body of the robot NAME. It blocks other robots
unless ATTRIBUTES say otherwise."
  (let ((descriptor (checked-descriptor (definition-title "defrobot" name) attributes)))
    (warn-of-misspellings (definition-title "defrobot" name) name descriptor)
    (if (assoc :obsmove descriptor)
        descriptor
        (append descriptor '((:obsmove t))))))

(defun read-blueprint (name environment position angle attributes lists)
  "Return a blueprint. LISTS is a property list of options in *PART-OPTIONS* and their values."
  (flet ((reject (clause expected)
           (reject-clause (definition-title "defrobot" name) clause expected)))
    (let ((map (parse-start environment position angle #'reject)))
      (make-blueprint :name name :map (map-name map)
                      :x (double (first position)) :y (double (second position))
                      :angle (double angle)
                      :attributes (parse-body-attributes name attributes)
                      :parts (loop for (option nil parse) in *part-options*
                                   append (loop for specification in (getf lists option)
                                                collect (funcall parse specification
                                                                 #'reject)))))))

(addition define-robot)
(defun define-robot (name environment position angle &key cameras hands bins parts attributes)
  "Define a robot as DEFROBOT does, but with evaluated arguments. ENVIRONMENT is a map or its name,
POSITION a list (x y), CAMERAS a list of lists (fov resolution), PARTS a list of lists (kind initarg
value ...), and ATTRIBUTES an object descriptor. Return the robot."
  (check-robot-name (definition-title "defrobot" name) name)
  (check-robot-variable name)
  (let* ((blueprint (read-blueprint name environment position angle
                                    attributes
                                    (list :cameras cameras :hands hands :bins bins :parts parts)))
         (robot (ensure-resident-robot blueprint)))
    (register *robots* name blueprint :variable t :value robot)
    (setf (blueprint-entry blueprint) (entry-of blueprint *robots*))
    (asking (robot) (call-listeners *robot-hooks* :defined robot))
    (warn-of-angle-in-degrees (definition-title "defrobot" name) (robot-world robot) angle)
    robot))

(defun check-robot-name (definition name)
  (unless (and name (symbolp name) (symbol-package name))
    (reject-clause definition name "a symbol with a home package as the robot's name"))
  (let ((trouble (variable-name-trouble name)))
    (when trouble
      (reject-clause definition name
                     (format nil "a symbol that can be a special variable, because the variable ~
                                  holds the robot, but ~A ~A. Name the robot my-~(~A~), or shadow ~
                                  the symbol in your package: (:shadow #:~(~A~))"
                             name trouble name name)))))

(defun forget-robot-without-definition (name)
  "Unbind the variable NAME if its value is a robot of this name whose definition was taken back. A
run that was rewound still has such a robot."
  (when (and (null (definition-to-replace name *robots*))
             (boundp name)
             (robot-p (symbol-value name))
             (eq name (robot-name (symbol-value name))))
    (makunbound name)))

(defun check-robot-variable (name)
  (forget-robot-without-definition name)
  (when (and (null (definition-to-replace name *robots*))
             (variable-in-use-p name))
    (reject-clause (definition-title "defrobot" name) name
                   (format nil "a name whose variable is free; ~A has the value ~S"
                           name (symbol-value name)))))

(defun check-robot-form (definition name start options)
  (flet ((reject (clause expected) (reject-clause definition clause expected)))
    (check-robot-name definition name)
    (unless (and (proper-list-p start) (= (length start) 3)
                 (proper-list-p (second start)) (= (length (second start)) 2))
      (reject start "(environment (x y) angle)"))
    (check-options definition options
                   (list* :attributes :documentation (mapcar #'first *part-options*)))
    (unless (typep (getf options :documentation "") 'string)
      (reject (getf options :documentation) "a string as the documentation"))
    (unless (descriptor-p (getf options :attributes))
      (reject (list :attributes (getf options :attributes))
              "a list of lists (attribute value) after :attributes, each attribute once"))
    (loop for (option nil nil words) in *part-options*
          do (unless (proper-list-p (getf options option))
               (reject (list option (getf options option)) (format nil words))))))

(defun checked-value-form (definition form clause expected)
  "FORM is in CLAUSE of DEFINITION. Return a form that evaluates FORM, and signals
MALFORMED-DEFINITION if FORM signals an error."
  (if (constantp form)
      form
      `(call-clause-code (lambda () ,form) ,definition ',clause ,expected)))

(defun robot-forms (definition name start options lisp-environment)
  (destructuring-bind (environment (x y) angle) start
    (flet ((value-of (form clause)
             (checked-value-form definition form clause "a form that has a value")))
      `((define-robot ',name
          ,(checked-value-form definition (map-reference-form environment lisp-environment) start
                               "a map, its name, or a form whose value is one")
          (list ,(value-of x (second start)) ,(value-of y (second start)))
          ,(value-of angle start)
          ,@(when (getf options :attributes)
              `(:attributes ,(descriptor-form name (getf options :attributes))))
          ,@(loop for (option form) in *part-options*
                  for specifications = (getf options option)
                  append `(,option
                           (list ,@(loop for specification in specifications
                                         collect (funcall form specification specifications
                                                          #'value-of))))))))))

(public defrobot)
(define-user-macro defrobot (&whole form name &optional start &body options
                             &environment environment)
  "Define a robot: (defrobot NAME (ENVIRONMENT (X Y) ANGLE) options...). Options:
  :cameras ((FOV RESOLUTION) ...)
  :hands (STRENGTH ...)
  :bins (CAPACITY ...)
  :parts ((KIND INITARG VALUE ...) ...) -- an addition: parts of your own kinds, see DEFINE-KIND
  :attributes ((ATTRIBUTE VALUE) ...) -- an addition: what other robots see, as for things
  :documentation TEXT
NAME becomes a special variable bound to the robot. The robot stands in the resident world of the
map ENVIRONMENT (its variable or name) at (X,Y), in metres, heading ANGLE, in radians. Numbers are
evaluated. An earlier robot named NAME takes no more commands. Signals MALFORMED-DEFINITION (manual
5.2). See reading 9."
  (let ((definition (definition-title "defrobot" name)))
    (expand-definition form environment
                       (lambda ()
                         (check-robot-form definition name start options)
                         (values (robot-forms definition name start options environment)
                                 (defvar-forms name))))))
