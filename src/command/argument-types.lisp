;;;; argument-types.lisp -- what commands take, and how a wrong argument is told so.

(in-package :ars-magna.command)

(defstruct (argument-type (:constructor make-argument-type (name predicate words trouble))
                          (:copier nil))
  "A kind of argument: a test for it, and what it is in words. TROUBLE, if any, is a function that
returns in words what is wrong with a value that is none, or NIL."
  (name nil :type symbol :read-only t)
  (predicate nil :type function :read-only t)
  (words "" :type string :read-only t)
  (trouble nil :type (or null function) :read-only t))

(define-registry argument-type "argument type" :object-p argument-type-p :fixed t :internal t)

(defun define-argument-type (name predicate text &optional trouble)
  "Let NAME be an argument type: what satisfies PREDICATE, which TEXT says in words. TROUBLE is a
function that returns in words what is wrong with a value, or NIL for no more than TEXT."
  (register *argument-types* name (make-argument-type name predicate text trouble))
  name)

(defun argument-of-type-p (value type)
  "True if VALUE can be an argument of the type named TYPE."
  (funcall (argument-type-predicate (find-argument-type type)) value))

(defun argument-type-text (type &optional (value nil value-p))
  "Return in words what an argument of the type named TYPE is, and what is wrong with VALUE."
  (let* ((type (find-argument-type type))
         (trouble (and value-p (argument-type-trouble type)
                       (funcall (argument-type-trouble type) value))))
    (format nil "~A~@[: ~A~]" (argument-type-words type) trouble)))

(defun continuation-p (value)
  (or (functionp value) (symbolp value)))

(define-argument-type 'robot #'robot-p "a robot")
(define-argument-type 'camera #'camera-p "a camera, as (robot-camera ROBOT 0) returns")
(define-argument-type 'hand #'hand-p "a hand, as (robot-hand ROBOT 0) returns")
(define-argument-type 'storage-bin #'storage-bin-p
  "a storage bin, as (robot-storage-bin ROBOT 0) returns")
(defun within-reason-p (value)
  "True of real numbers small enough that arithmetic on positions and angles keeps its meaning."
  (and (realp value) (< -1d9 value 1d9)))

(define-argument-type 'number #'within-reason-p "a number between -1e9 and 1e9")
(define-argument-type 'angle #'within-reason-p "an angle in radians, between -1e9 and 1e9")
(define-argument-type 'ticks #'within-reason-p "a number of ticks, between -1e9 and 1e9")
(define-argument-type 'continuation #'continuation-p
  "a continuation: a function of an error code and the command's results, or NIL for none")
