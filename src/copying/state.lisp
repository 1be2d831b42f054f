;;;; state.lisp -- what is in objects: digested, searched, written down, put back, checked.

(in-package :ars-magna.copying)

(export '(reference digest-state holds-p closed-over fields-of-type slot-kept-p blank-object
          note-lasting lasting-name lasting-function contradiction contradict must-hold
          proper-list-of-p))

;;; What belongs to an object is digested with it, by its state; what it only refers to, by what
;;; tells it apart from others, see REFERENCE.

(defgeneric reference (object)
  (:documentation
   "Return plain data that tells OBJECT apart from all others in its run: (KIND argument...), a
keyword and data. A journal names it so, and DEREFERENCE finds its like in another run. NIL if
there is nothing to tell it by.")
  (:method (object) (declare (ignore object)) nil))

(defgeneric digest-state (object digest)
  (:documentation "Add to DIGEST what tells OBJECT apart, its state, and that of its parts. Return
DIGEST. A kind may add an :AFTER method.")
  (:method (object digest)
    (digest-add digest object))
  (:method ((object structure-object) digest)
    (let ((kind (kind-of object)))
      (digest-mention object digest)
      (when kind
        (dolist (slot (kind-decisive-slots kind))
          (digest-slot slot (slot-content slot object) digest))))
    digest))

(defun digest-slot (slot value digest)
  (if (kind-slot-part-p slot)
      (typecase value
        (sequence
         (digest-add digest (length value))
         (map nil (lambda (part) (digest-state part digest)) value))
        (t (digest-state value digest)))
      (digest-add digest value)))

(defvar *digest-depth* 0 "How many objects, one in the other, are being digested.")

(defmethod digest-mention (object digest)
  (let ((reference (reference object)))
    (if reference
        (digest-add digest reference)
        (let ((*digest-depth* (1+ *digest-depth*)))
          (digest-add digest (first (ensure-list (type-of object))))
          ;; What contains itself ends somewhere.
          (when (< *digest-depth* 20) (digest-contents object digest)))))
  digest)

(defun digest-contents (object digest)
  "Add to DIGEST what is in OBJECT, an array, table, pathname or structure of a user's."
  (typecase object
    (array (digest-add digest (array-dimensions object))
     (dotimes (i (array-total-size object)) (digest-add digest (row-major-aref object i))))
    (hash-table (digest-table object digest))
    (pathname (digest-add digest (namestring object)))
    (structure-object
     (unless (or (kind-of object) (lisps-own-p (type-of object)))
       (dolist (slot (class-slot-names (class-of object)))
         (digest-add digest (slot-value object slot)))))))

(defun digest-table (table digest)
  "Add to DIGEST what is in the hash TABLE, in whatever order."
  (let ((sum 0))
    (maphash (lambda (key value)
               (incf sum (digest-value (digest-add (make-digest) (list key value)))))
             table)
    (digest-add digest (list (hash-table-count table) (ldb (byte 64 0) sum)))))

;;;; What is in data

;;; For messages that name where something was found. What belongs to a run, such as tasks and
;;; robots, is not looked into: from there one gets everywhere.

(defun contents-of (object)
  (typecase object
    (cons (list (car object) (cdr object)))
    (hash-table (loop for key being the hash-keys of object using (hash-value value)
                      collect key collect value))
    (array (if (eq t (array-element-type object))
               (loop for index below (array-total-size object)
                     collect (row-major-aref object index))
               '()))
    (function (if (closure-p object) (closure-values object) '()))
    (structure-object (if (eq :copy (manner-way (manner object)))
                          (loop for (index) in (reference-slots object)
                                collect (instance-slot object index))
                          '()))
    (standard-object (loop for slot in (instance-slot-names (class-of object))
                           when (slot-boundp object slot) collect (slot-value object slot)))
    (t (if (value-cell-p object) (list (cell-value object)) '()))))

(defun holds-p (object value)
  "True if VALUE is OBJECT, or in it: in a list, array, table, closure, structure or instance."
  (let ((seen (make-hash-table :test 'eq)) (work (list object)))
    (loop while work
          do (let ((each (pop work)))
               (when (eq each value) (return t))
               (unless (or (typep each '(or symbol number character)) (gethash each seen))
                 (setf (gethash each seen) t
                       work (append (contents-of each) work)))))))

(defun closed-over (function)
  "Return a list of what FUNCTION, if it is a closure, has closed over: of variables, their values."
  (when (closure-p function)
    (loop for value in (closure-values function)
          collect (if (and (value-cell-p value) (not (exit-cell-p value)))
                      (cell-value value)
                      value))))

;;;; What is written down and put back

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
  "Return a new structure of TYPE, a symbol, whose FIELDS are to be written. Until then a field has
its initial value, or, if that is not of its type, garbage: do not print the object."
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

;;;; What makes no sense

;;; What is put together from a file may contradict itself. Each layer checks its own kinds: nothing
;;; of a run that was read is used before all of it has been looked at.

(define-condition contradiction (error)
  ((text :initarg :text :reader contradiction-text))
  (:report (lambda (condition stream) (write-string (contradiction-text condition) stream)))
  (:documentation "Objects that belong together do not fit each other."))

(defun contradict (control &rest arguments)
  "Signal a CONTRADICTION with a text formatted from CONTROL and ARGUMENTS."
  (error 'contradiction :text (apply #'format nil control arguments)))

(defmacro must-hold (test control &rest arguments)
  "Signal a CONTRADICTION with a text formatted from CONTROL and ARGUMENTS unless TEST holds."
  `(unless ,test (contradict ,control ,@arguments)))

(defun proper-list-of-p (predicate object)
  "True if OBJECT is a list that ends, and PREDICATE is true of each of its elements."
  (and (proper-list-p object) (every predicate object)))
