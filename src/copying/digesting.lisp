;;;; digesting.lisp -- the state of objects of a kind, in a digest.

(in-package :ars-magna.copying)

(export '(reference digest-state))

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
