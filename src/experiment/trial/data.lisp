;;;; data.lisp -- digests of values that are data.

(in-package :ars-magna.experiment)

;;; Data are numbers, symbols, characters, strings, paths, and conses, arrays, hash tables and
;;; users' structures of these. Of other parts, such as functions and class instances, only the
;;; type counts. A part that contains itself counts by its distance to itself. So the digest does
;;; not depend on the order of a table.

(defconstant +deepest-data+ 2000 "Parts of data that are nested deeper do not count.")
(defconstant +most-compounds+ 1000000 "The most conses, arrays, tables and structures in data.")
(defconstant +most-elements+ 20000000 "The most elements of arrays in data.")

(defun user-structure-p (value)
  "True if VALUE is an instance of a user's DEFSTRUCT or DEFINE-CONDITION, and not a fluent, thing
or other object of the simulator."
  (and (typep value '(or structure-object condition))
       (null (kind-of value))
       (users-symbol-p (type-of value))))

(defun structure-values (structure)
  (loop for slot in (class-slot-names (class-of structure))
        when (slot-boundp structure slot) collect (slot-value structure slot)))

(deftype plain-atom ()
  '(or number symbol character string bit-vector pathname))

;; The contents of a weak table depend on garbage collection. See WEAK-DIGESTS.
(deftype compound ()
  '(or cons array (and hash-table (not (satisfies weak-table-p))) (satisfies user-structure-p)))

;;; Walking.

(defstruct (walk (:constructor make-walk (digest atom)) (:copier nil))
  "The state of a walk through data. Each part is added to DIGEST. ATOM is called with each part
that has no parts itself. PATH maps the compounds around the current part to their depths."
  (digest nil :type digest :read-only t)
  (atom nil :type function :read-only t)
  (path (make-hash-table :test 'eq) :read-only t)
  (compounds +most-compounds+ :type fixnum)
  (elements +most-elements+ :type fixnum))

(defun digest-word-into (word walk)
  (digest-add-word (walk-digest walk) (ldb (byte 64 0) word)))

(defun digest-text-into (text walk)
  (digest-word-into (text-hash text) walk))

(defun digest-atom-into (atom walk)
  (typecase atom
    (fixnum (digest-word-into 1 walk) (digest-word-into atom walk))
    (double-float (digest-word-into 2 walk) (digest-word-into (double-to-bits atom) walk))
    (plain-atom (digest-text-into (prin1-to-string atom) walk))
    ;; Not data: only the type counts.
    (t (digest-text-into (prin1-to-string (if (functionp atom)
                                              'function
                                              (class-name (class-of atom))))
                         walk)))
  (funcall (walk-atom walk) atom))

(defun count-compound (walk)
  "Count a compound, and leave WALK if the data are too large."
  (when (or (minusp (decf (walk-compounds walk)))
            (minusp (walk-elements walk)))
    (throw 'too-large nil)))

(defun digest-datum (value depth walk)
  (if (and (typep value 'compound) (not (stringp value)) (not (bit-vector-p value)))
      (walk-compound value depth walk)
      (digest-atom-into value walk)))

(defun walk-compound (value depth walk)
  (let ((above (gethash value (walk-path walk))))
    (cond (above (digest-word-into 3 walk) (digest-word-into (- depth above) walk))
          ((> depth +deepest-data+) (digest-word-into 4 walk))
          ((consp value) (walk-list value depth walk))
          (t (count-compound walk)
             (setf (gethash value (walk-path walk)) depth)
             (etypecase value
               (array (walk-array value depth walk))
               (hash-table (digest-hash-table value depth walk))
               ((or structure-object condition)
                (digest-text-into (prin1-to-string (type-of value)) walk)
                (dolist (part (structure-values value)) (digest-datum part (1+ depth) walk))))
             (remhash value (walk-path walk))))))

(defun walk-list (list depth walk)
  "Add the conses of LIST to WALK. All tails have the depth of LIST."
  (digest-word-into 5 walk)
  (loop for rest = list then (cdr rest)
        while (and (consp rest) (not (gethash rest (walk-path walk))))
        do (count-compound walk)
           (setf (gethash rest (walk-path walk)) depth)
           (digest-datum (car rest) (1+ depth) walk)
        finally (if (consp rest) (digest-word-into 6 walk) (digest-datum rest (1+ depth) walk)))
  (loop for rest = list then (cdr rest)
        while (and (consp rest) (remhash rest (walk-path walk)))))

(defun walk-array (array depth walk)
  (digest-word-into 7 walk)
  (dolist (dimension (array-dimensions array)) (digest-word-into dimension walk))
  (when (array-has-fill-pointer-p array) (digest-word-into (fill-pointer array) walk))
  (decf (walk-elements walk) (array-total-size array))
  (count-compound walk)
  (dotimes (index (array-total-size array))
    (digest-datum (row-major-aref array index) (1+ depth) walk)))

(defun digest-hash-table (table depth walk)
  "Add the hash TABLE to WALK, independent of the order of its entries."
  (digest-text-into (prin1-to-string (hash-table-test table)) walk)
  (dolist (number (sort (entry-digests table depth walk) #'<)) (digest-word-into number walk)))

(defun entry-digests (table depth walk &optional (test (constantly t)))
  "Return a list with a number for each entry of the hash TABLE whose key passes TEST."
  (let* ((digest (walk-digest walk)) (before (digest-value digest)))
    (prog1 (loop for key being the hash-keys of table using (hash-value value)
                 when (funcall test key)
                   do (setf (digest-value digest) 0)
                      (digest-datum key (1+ depth) walk)
                      (digest-datum value (1+ depth) walk)
                   and collect (digest-value digest))
      (setf (digest-value digest) before))))

;;; Digests.

(defun map-data-atoms (value atom)
  "Return a digest of VALUE, or NIL if VALUE is too large. Call ATOM with each part without parts."
  (let ((walk (make-walk (make-digest) atom)))
    (catch 'too-large
      (call-with-trial-syntax (lambda () (digest-datum value 0 walk)) (find-package :keyword))
      (digest-value (walk-digest walk)))))

(defun data-digest (value)
  "Return a digest of VALUE, including the packages of symbols; NIL if VALUE is too large."
  (map-data-atoms value #'identity))

;;; Weakly held objects can disappear at any time, so they are not data. But a trial can find what
;;; another trial added, unless its key was made in that trial.

(defun weak-object-p (object)
  (or (weak-pointer-p object)
      (and (hash-table-p object) (weak-table-p object))))

(defun reproducible-key-p (key table)
  "True if another trial can make an object that is the same key of the hash TABLE as KEY."
  (typecase key
    (symbol (symbol-package key))
    ((or string cons) (and (not (member (hash-table-test table) '(eq eql))) (table-value-p key)))
    (t (table-value-p key))))

(defun weak-digests (object atom)
  "Return digests of what OBJECT, a weak pointer or table, holds. ATOM is as for MAP-DATA-ATOMS."
  (if (weak-pointer-p object)
      (let ((target (weak-value object)))
        (and target (list (map-data-atoms target atom))))
      (let ((walk (make-walk (make-digest) atom)))
        (catch 'too-large
          (call-with-trial-syntax (lambda ()
                                    (entry-digests object 0 walk
                                                   (lambda (key) (reproducible-key-p key object))))
                                  (find-package :keyword))))))

(defun empty-or-not-data-p (value)
  "True if VALUE is not data, or is NIL or an empty hash table. A variable that will hold data often
has NIL or an empty table first."
  (or (null value)
      (and (hash-table-p value) (zerop (hash-table-count value)))
      (not (typep value '(or plain-atom compound)))))
