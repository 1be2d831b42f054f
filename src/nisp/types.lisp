;;;; types.lisp -- the types of the manual and their slots by name, MAKE (manual 3.1).

(in-package :ars-magna.nisp)

(export '(define-nisp-type make-object define-nisp-slot slot-ref slot-names))

(public void)
(deftype void ()
  "The result type of functions that return no values (manual 3.1)."
  nil)

(public lst)
(deftype lst (&optional (type t))
  "The type of lists of objects of TYPE, which is not checked (manual 3.1)."
  (declare (ignore type))
  'list)

(public ~)
(deftype ~ (type)
  "The type of objects of TYPE, and of #F (manual 3.1)."
  `(or null ,type))

(public thing-descriptor)
(deftype thing-descriptor ()
  "The type of object descriptors and of specifications of objects (manual 3.3)."
  'list)

(public robot-continuation)
(deftype robot-continuation ()
  "The type of continuations of robot commands: a function, or NIL for none (manual 3.1.1)."
  '(or function symbol))

;;; Making objects.

(defun register-maker (name parameters maker)
  (let ((type (ensure-nisp-type name)))
    (setf (nisp-type-parameters type) parameters
          (nisp-type-maker type) maker)
    name))

(defmacro define-nisp-type (name lambda-list constructor)
  "Define how (make NAME arguments...) makes an object. If CONSTRUCTOR has the form #'function, call
that function with the arguments. Otherwise, evaluate the form CONSTRUCTOR with the variables in
LAMBDA-LIST bound to the arguments."
  `(register-maker ',name ',lambda-list
                   ,(if (typep constructor '(cons (eql function)))
                        constructor
                        `(lambda ,lambda-list ,constructor))))

(defun make-object (type &rest arguments)
  "Return a new object of the type named TYPE, made from ARGUMENTS. Signals UNKNOWN-NAME for an
unknown TYPE and MISUSE for a wrong number of ARGUMENTS."
  (let* ((known (find-nisp-type type))
         (maker (and known (nisp-type-maker known))))
    (unless maker
      (reject-name "type that MAKE can make" type
                   (sort (loop for type being the hash-values of *nisp-types*
                               when (nisp-type-maker type) collect (nisp-type-name type))
                         #'string<)))
    (unless (accepts-count-p (nisp-type-parameters known) (length arguments))
      (reject-use "(make ~A~{ ~S~}): a ~A is made by (make ~A~{ ~(~A~)~})."
                  type arguments (nisp-type-name known)
                  (nisp-type-name known) (nisp-type-parameters known)))
    (apply maker arguments)))

(public make)
(defmacro make (type &rest arguments)
  "Return a new object of TYPE, which is not evaluated, from ARGUMENTS: (make PT 1 2) (manual 3.1)."
  `(make-object ',type ,@arguments))

;;;; Slots by name

;;; Slot `x' of any type is read by the generic function ARS-MAGNA.SLOTS::!_X, and set by (SETF
;;; !_X): dispatch, subtypes and caching are CLOS's. The reader turns !_x and !>p.x into calls
;;; of it, and a form with a type, !(PT x), into a call of that type's own reader. Structures and
;;; classes that users define need not be registered: all of their slots can be reached.

(eval-when (:compile-toplevel :load-toplevel :execute)
  (define-generic-function-class slot-accessor
    "The class of functions that read or set slots of one name in objects of any type.")

  (defun slot-accessor-name (slot)
    "Return the symbol that names the accessor of the slot named SLOT."
    (intern (concatenate 'string "!_" (string slot)) :ars-magna.slots))

  (defun ensure-slot-accessor (slot)
    "Return the name of the accessor of the slot named SLOT. Define the accessor if necessary."
    (let ((name (slot-accessor-name slot)))
      (unless (fboundp name)
        (ensure-generic-function `(setf ,name) :lambda-list '(value object)
                                               :generic-function-class 'slot-accessor)
        (ensure-generic-function name :lambda-list '(object)
                                      :generic-function-class 'slot-accessor
                                      :documentation "Return the value of the slot of OBJECT that
has the accessor's name."))
      name)))

;;; Which slots there are.

(defun class-slot-readers (class)
  "Return an alist from the names of the slots of CLASS to their readers. Inherited slots are last."
  (loop for class in (class-and-ancestors class)
        for type = (find-nisp-type (class-name class))
        when (and type (eq (nisp-type-class type) (class-name class)))
          append (nisp-type-slots type)))

(defun users-slot-names (object)
  "If a user defined OBJECT's class, return the names of its slots, a list of symbols; else NIL."
  (let ((class (class-of object)))
    (when (and (typep class '(or structure-class standard-class))
               (users-symbol-p (class-name class))
               (not (simulator-symbol-p (class-name class))))
      (class-slot-names class))))

(defun slot-names (object)
  "Return the names of the slots of OBJECT that programs can use, a list of strings."
  (sort (remove-duplicates (append (mapcar #'car (class-slot-readers (class-of object)))
                                   (mapcar #'symbol-name (users-slot-names object)))
                           :test #'string=)
        #'string<))

(defun reject-slot (object slot setter)
  (let ((known (slot-names object)))
    (when (and setter (member slot known :test #'string=))
      (reject-use "Slot ~A of a ~A cannot be set." slot (type-of object)))
    (reject-name (format nil "slot of ~:[a ~A~;NIL~]" (null object)
                         (let ((type (type-of object)))
                           (if (symbolp type) (symbol-name type) type)))
                 slot known)))

(defmethod no-applicable-method ((accessor slot-accessor) &rest arguments)
  (let* ((object (first (last arguments)))
         (name (generic-name accessor))
         (setter (consp name))
         (slot (subseq (symbol-name (if setter (second name) name)) 2))
         (own (find slot (users-slot-names object) :test #'string=)))
    (cond ((null own) (reject-slot object slot setter))
          (setter (setf (slot-value object own) (first arguments)))
          (t (slot-value object own)))))

;;; Registering them.

(defun register-slot (class slot reader)
  "Register READER, the name of a function or NIL, as the reader of the slot named SLOT of CLASS."
  (let ((type (ensure-nisp-type class))
        (slot (string slot)))
    (setf (nisp-type-class type) class
          (nisp-type-slots type)
          (acons slot reader (remove slot (nisp-type-slots type) :key #'car :test #'string=)))))

(defun slot-reader-for-type (type slot)
  "Return the name of the accessor of SLOT for TYPE. If TYPE has none, take that for all types."
  (let* ((known (find-nisp-type type))
         (class (and known (find-class (nisp-type-class known) nil))))
    (or (and class (cdr (assoc (string slot) (class-slot-readers class) :test #'string=)))
        (ensure-slot-accessor slot))))

(defmacro define-nisp-slot (type name reader &optional writer)
  "Let programs use the slot NAME of objects of TYPE, a class, and of its subclasses. READER is the
name of a function of the object. If the slot can be set, WRITER is (SETF READER) or the name of a
function of the value and the object."
  (let ((accessor (slot-accessor-name name))
        (direct (and (symbolp reader)
                     (if writer
                         (equal writer `(setf ,reader))
                         (not (fboundp `(setf ,reader)))))))
    `(progn
       (eval-when (:compile-toplevel :load-toplevel :execute)
         (ensure-slot-accessor ',name))
       (register-slot ',type ',name ',(and direct reader))
       (defmethod ,accessor ((object ,type)) (,reader object))
       ,@(when writer
           `((defmethod (setf ,accessor) (value (object ,type))
               ,(if (symbolp writer)
                    `(,writer value object)
                    `(setf (,(second writer) object) value)))))
       ',name)))

;;; Access by a name known at run time.

(defun slot-ref (object slot)
  "Return the value of the slot of OBJECT named SLOT, a symbol or string. Can be set. Signals
UNKNOWN-NAME, which lists the slots, if OBJECT has no such slot."
  (funcall (ensure-slot-accessor slot) object))

(defun (setf slot-ref) (value object slot)
  (funcall (fdefinition `(setf ,(ensure-slot-accessor slot))) value object))

(define-compiler-macro slot-ref (&whole form object slot)
  (let ((accessor (and (typep slot '(cons (eql quote) (cons symbol null)))
                       (slot-accessor-name (second slot)))))
    (if (and accessor (fboundp accessor))
        `(,accessor ,object)
        form)))

;;;; Points and intervals (manual 3.2.1)

(define-nisp-type pt (x y) #'make-pt)
(define-nisp-slot pt x pt-x (setf pt-x))
(define-nisp-slot pt y pt-y (setf pt-y))

(define-nisp-type interval (min max) #'make-interval)
(define-nisp-slot interval min interval-min (setf interval-min))
(define-nisp-slot interval max interval-max (setf interval-max))

(define-nisp-type pt-interval (a b) #'make-pt-interval)
(define-nisp-slot pt-interval x pt-interval-x (setf pt-interval-x))
(define-nisp-slot pt-interval y pt-interval-y (setf pt-interval-y))
(define-nisp-slot pt-interval dx pt-interval-dx)
(define-nisp-slot pt-interval dy pt-interval-dy)
