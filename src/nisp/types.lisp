;;;; types.lisp -- the types of the manual, and MAKE for all of them (manual 3.1).

(in-package :ars-magna.nisp)

(export '(define-nisp-type make-object))

(public void)
(deftype void ()
  "The type of no values (manual 3.1)."
  nil)

(public lst)
(deftype lst (&optional (type t))
  "The type of the lists of objects of TYPE, which is not looked into (manual 3.1)."
  (declare (ignore type))
  'list)

(public ~)
(deftype ~ (type)
  "The type of #F and the objects of TYPE (manual 3.1)."
  `(or null ,type))

(public thing-descriptor)
(deftype thing-descriptor ()
  "The type of object descriptors and of specifications of objects (manual 3.3)."
  'list)

(public robot-continuation)
(deftype robot-continuation ()
  "The type of what a robot command takes as its continuation, NIL for none (manual 3.1.1)."
  '(or function symbol))

;;; Making objects.

(defun register-maker (name parameters maker)
  "Let (make NAME ...) call MAKER, which takes PARAMETERS."
  (let ((type (ensure-nisp-type name)))
    (setf (nisp-type-parameters type) parameters
          (nisp-type-maker type) maker)
    name))

(defmacro define-nisp-type (name lambda-list constructor &optional documentation)
  "Let (make NAME arguments...) evaluate the form CONSTRUCTOR with LAMBDA-LIST bound to the
arguments, or call it with them if it is written #'function. DOCUMENTATION is for the reader."
  (declare (ignore documentation))
  `(register-maker ',name ',lambda-list
                   ,(if (typep constructor '(cons (eql function)))
                        constructor
                        `(lambda ,lambda-list ,constructor))))

(defun takes-p (parameters count)
  (let* ((keyword (position-if #'lambda-keyword-p parameters))
         (required (or keyword (length parameters)))
         (optional (member '&optional parameters)))
    (cond ((< count required) nil)
          ((intersection parameters '(&rest &key)) t)
          (t (<= count (+ required (length (rest optional))))))))

(defun make-object (type &rest arguments)
  "Return a new object of the type called TYPE, made from ARGUMENTS as that type wants them. An
unknown TYPE and a wrong number of ARGUMENTS are errors."
  (let* ((known (find-nisp-type type))
         (maker (and known (nisp-type-maker known))))
    (unless maker
      (reject-name "type that MAKE can make" type
                   (sort (loop for type being the hash-values of *nisp-types*
                               when (nisp-type-maker type) collect (nisp-type-name type))
                         #'string<)))
    (unless (takes-p (nisp-type-parameters known) (length arguments))
      (reject-use "(make ~A~{ ~S~}): a ~A is made by (make ~A~{ ~(~A~)~})."
                  type arguments (nisp-type-name known)
                  (nisp-type-name known) (nisp-type-parameters known)))
    (apply maker arguments)))

(public make)
(defmacro make (type &rest arguments)
  "Return a new object of TYPE, a name that is not evaluated, made from ARGUMENTS, such as
(make PT 1 2) (manual 3.1)."
  `(make-object ',type ,@arguments))
