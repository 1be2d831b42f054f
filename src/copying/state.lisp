;;;; state.lisp -- the contents of objects: digested, searched, saved, restored, checked.

(in-package :ars-magna.copying)

(export '(reference digest-state parts-to-digest contains-value-p closed-over-values
          fields-of-type saved-slot-p blank-object
          note-savable-function savable-function-name find-savable-function contradiction
          signal-contradiction must-hold proper-list-of-p))

;;; An object is digested with its state and parts; other objects it refers to, by their REFERENCE.

(defgeneric reference (object)
  (:documentation
   "Return a list of a keyword and plain data that identifies OBJECT in its run, or NIL. Journals
contain such lists. DEREFERENCE returns the object that a list identifies in another run.")
  (:method (object) (declare (ignore object)) nil))

(defgeneric digest-state (object digest)
  (:documentation "Add to DIGEST the reference of OBJECT, the state of OBJECT, and the state of its
parts. Return DIGEST. A kind may add an :AFTER method.")
  (:method (object digest)
    (digest-add digest object))
  (:method ((object structure-object) digest)
    (let ((kind (kind-of object)))
      (digest-add-identity object digest)
      (when kind
        (dolist (slot (kind-decisive-slots kind))
          (digest-slot slot
                       (if (kind-slot-part-p slot)
                           (parts-to-digest object (slot-content slot object))
                           (slot-content slot object))
                       digest))))
    digest))

(defgeneric parts-to-digest (object parts)
  (:documentation "Return PARTS, the contents of a slot of OBJECT that holds its parts, in the order
in which they are digested. A kind adds a method if the order in the slot must not matter.")
  (:method (object parts)
    (declare (ignore object))
    parts))

(defun digest-slot (slot value digest)
  (if (kind-slot-part-p slot)
      (typecase value
        (sequence
         (digest-add digest (length value))
         (map nil (lambda (part) (digest-state part digest)) value))
        (t (digest-state value digest)))
      (digest-add digest value)))

(defvar *digest-depth* 0 "The nesting depth of the object that is being digested.")

(defmethod digest-add-identity (object digest)
  (let ((reference (reference object)))
    (if reference
        (digest-add digest reference)
        (let ((*digest-depth* (1+ *digest-depth*)))
          (digest-add digest (first (ensure-list (type-of object))))
          ;; Circular objects end here.
          (when (< *digest-depth* 20) (digest-contents object digest)))))
  digest)

(defun digest-contents (object digest)
  "Add to DIGEST the contents of OBJECT, an array, a table, a pathname or a user's structure."
  (typecase object
    (array (digest-add digest (array-dimensions object))
     (dotimes (i (array-total-size object)) (digest-add digest (row-major-aref object i))))
    (hash-table (digest-table object digest))
    (pathname (digest-add digest (namestring object)))
    (structure-object
     (unless (or (kind-of object) (lisp-symbol-p (type-of object)))
       (dolist (slot (class-slot-names (class-of object)))
         (digest-add digest (slot-value object slot)))))))

(defun digest-table (table digest)
  "Add to DIGEST the contents of TABLE, a hash table. The order of the entries does not matter."
  (let ((sum 0))
    (maphash (lambda (key value)
               (incf sum (digest-value (digest-add (make-digest) (list key value)))))
             table)
    (digest-add digest (list (hash-table-count table) (ldb (byte 64 0) sum)))))

;;;; The contents of data

;;; For messages that name where something was found. Objects of a run, such as tasks and robots,
;;; are not searched, because everything can be reached from them.

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
    (structure-object (if (eq :copy (copy-policy-way (copy-policy object)))
                          (loop for (index) in (reference-slots object)
                                collect (instance-slot object index))
                          '()))
    (standard-object (loop for slot in (per-instance-slot-names (class-of object))
                           when (slot-boundp object slot) collect (slot-value object slot)))
    (t (if (value-cell-p object) (list (cell-value object)) '()))))

(defun contains-value-p (object value)
  "True if VALUE is OBJECT, or is contained in OBJECT at any depth: in lists, arrays, tables,
closures, structures or instances."
  (let ((seen (make-hash-table :test 'eq)) (work (list object)))
    (loop while work
          do (let ((each (pop work)))
               (when (eq each value) (return t))
               (unless (or (typep each '(or symbol number character)) (gethash each seen))
                 (setf (gethash each seen) t
                       work (append (contents-of each) work)))))))

(defun closed-over-values (function)
  "Return a list of the values that FUNCTION closes over; NIL if FUNCTION is not a closure."
  (when (closure-p function)
    (loop for value in (closure-values function)
          collect (if (and (value-cell-p value) (not (exit-cell-p value)))
                      (cell-value value)
                      value))))

;;;; Saving and restoring

;;; A file has what a restored object needs: of a kind, the slots with roles :FIXED, :STATE and
;;; :MEMORY; :SCRATCH and :LINK slots start as in a new object. Of other structures it has all.

(defun saved-slot-p (slot)
  "True if saved runs contain SLOT, an element of FIELDS-OF-TYPE."
  (and (member (kind-slot-role slot) '(:fixed :state :memory)) t))

(defun make-plain-kind-slot (name type)
  "Return a kind slot that describes the slot NAME, of TYPE, in a structure without a kind."
  (make-kind-slot name :fixed type "" nil nil
                  (constantly nil)
                  (lambda (object) (slot-value object name))
                  (lambda (value object)
                    (unless (typep value type)
                      (error 'type-error :datum value :expected-type type))
                    (setf (slot-value object name) value))))

(defun fields-of-type (type)
  "Return a list that describes all slots of structures of TYPE, a symbol."
  (let* ((kind (kind-named type))
         (slots (and kind (kind-slots kind))))
    (append slots
            (loop for (name slot-type) in (class-slot-types (find-class type))
                  unless (find name slots :key #'kind-slot-name)
                    collect (make-plain-kind-slot name slot-type)))))

(defun blank-object (type fields)
  "Return a new structure of TYPE, a symbol. The caller must then set its FIELDS, descriptions of
slots. Before that, a field has its initial value, or garbage if the initial value is of the wrong
type; so do not print the object."
  (let ((object (allocate-instance (find-class type))))
    (dolist (field fields object)
      (ignore-errors
       (funcall (kind-slot-writer field) (funcall (kind-slot-initial field)) object)))))

;;; Functions that objects hold and that a file may name. Others are refused.

(defvar *savable-functions* '()
  "The names of functions that objects of a saved run may hold.")

(defun note-savable-function (name)
  "Allow files of saved runs to name the function NAME as the contents of a slot. Return NAME."
  (pushnew name *savable-functions*)
  name)

(defun savable-function-name (function)
  "Return the name of FUNCTION if that name was passed to NOTE-SAVABLE-FUNCTION, or NIL."
  (find function *savable-functions* :key #'fdefinition))

(defun find-savable-function (name)
  "Return the function named NAME if NAME was passed to NOTE-SAVABLE-FUNCTION, or NIL."
  (and (member name *savable-functions*) (fdefinition name)))

;;;; Consistency of restored objects

;;; Objects read from a file may contradict each other. Each layer checks its own kinds. No object
;;; of the run is used before all have been checked.

(define-condition contradiction (error)
  ((text :initarg :text :reader contradiction-text))
  (:report (lambda (condition stream) (write-string (contradiction-text condition) stream)))
  (:documentation "Objects loaded from a file are inconsistent."))

(defun signal-contradiction (control &rest arguments)
  "Signal a CONTRADICTION with a text formatted from CONTROL and ARGUMENTS."
  (error 'contradiction :text (apply #'format nil control arguments)))

(defmacro must-hold (test control &rest arguments)
  "Signal a CONTRADICTION with a text formatted from CONTROL and ARGUMENTS unless TEST is true."
  `(unless ,test (signal-contradiction ,control ,@arguments)))

(defun proper-list-of-p (predicate object)
  "True if OBJECT is a proper list and PREDICATE is true for each of its elements."
  (and (proper-list-p object) (every predicate object)))
