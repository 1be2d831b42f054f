;;;; fields.lisp -- what is in an object, of a kind or not, to be written down and put back.

(in-package :ars-magna.copying)

(export '(fields-of-type slot-kept-p blank-object note-lasting lasting-name lasting-function))

;;; A copy in a file has what another object of a run would need to go on: of a kind, what its
;;; roles :FIXED, :STATE and :MEMORY say; what is :SCRATCH or a :LINK is as at first. A structure
;;; without a kind has no roles, and all that is in it counts.

(defun slot-kept-p (slot)
  "True if what is in SLOT, see FIELDS-OF-TYPE, is to be written down."
  (and (member (kind-slot-role slot) '(:fixed :state :memory)) t))

(defun plain-slot (name type)
  "Return what is known of the slot NAME, of TYPE, of a structure without a kind."
  (make-kind-slot name :fixed type "" nil nil
                  (constantly nil)
                  (lambda (object) (slot-value object name))
                  (lambda (value object)
                    (unless (typep value type)
                      (error 'type-error :datum value :expected-type type))
                    (setf (slot-value object name) value))))

(defun fields-of-type (type)
  "Return a list of the slots of the structures of TYPE, a symbol."
  (let* ((kind (kind-called type))
         (slots (and kind (kind-slots kind))))
    (append slots
            (loop for (name slot-type) in (class-slot-types (find-class type))
                  unless (find name slots :key #'kind-slot-name)
                    collect (plain-slot name slot-type)))))

(defun blank-object (type fields)
  "Return a new structure of TYPE, a symbol, whose FIELDS are to be written. Until then there is in
them what they begin with, if that may be: an error may show the object."
  (let ((object (allocate-instance (find-class type))))
    (dolist (field fields object)
      (ignore-errors
       (funcall (kind-slot-writer field) (funcall (kind-slot-initial field)) object)))))

;;; Functions that objects hold, and that a file may name: none but these.

(defvar *lasting-functions* '()
  "The names of functions that objects of a run hold for as long as they last.")

(defun note-lasting (name)
  "Let the function called NAME be one that a file may name as held by an object. Return NAME."
  (pushnew name *lasting-functions*)
  name)

(defun lasting-name (function)
  "Return the name of FUNCTION if it is one of those that NOTE-LASTING was told of, or NIL."
  (find function *lasting-functions* :key #'fdefinition))

(defun lasting-function (name)
  "Return the function called NAME if NOTE-LASTING was told of it, or NIL."
  (and (member name *lasting-functions*) (fdefinition name)))
