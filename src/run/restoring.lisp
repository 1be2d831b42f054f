;;;; restoring.lisp -- making objects from the lines of a saved run.

(in-package :ars-magna.run)

;;; The first lines define the numbers, and empty objects of the right shapes are made. The other
;;; lines fill them in order. A line that makes no sense is an error; so are more objects than the
;;; file can have lines for, and arrays that exceed the memory. No code uses an object before it is
;;; complete.

(defstruct (loaded (:constructor make-loaded (most-objects)) (:copier nil))
  "The objects of a saved run that is being read. SHAPES contains the shape and fields of the object
of each number, or NIL for an outer object."
  (most-objects 0 :type integer :read-only t)
  (objects (make-array 64 :adjustable t :fill-pointer 0) :type vector :read-only t)
  (shapes (make-array 64 :adjustable t :fill-pointer 0) :type vector :read-only t)
  (elements-left (floor (heap-bytes) 64) :type integer)
  ;; The number of the object of the next line; how many of its elements or values were read so far;
  ;; and the values, newest first.
  (next 1 :type fixnum)
  (position 0 :type fixnum)
  (values '() :type list)
  ;; Contents that are filled in when all other objects are complete.
  (agenda nil)
  (tables '() :type list))

(defun begin-loading (octets)
  "Return an empty LOADED structure for a file of OCTETS octets."
  (let ((loaded (make-loaded (floor octets 12))))
    (add-loaded nil nil loaded)
    loaded))

(defun add-loaded (object shape loaded)
  (when (< (loaded-most-objects loaded) (length (loaded-objects loaded)))
    (error "the file announces more objects than it has lines"))
  (vector-push-extend object (loaded-objects loaded))
  (vector-push-extend shape (loaded-shapes loaded)))

;;; Defining numbers.

(defun add-outer (name loaded)
  "Let the next number mean the outer object with the name NAME, (kind argument [more])."
  (unless (typep name '(cons keyword (cons t (or null (cons t null)))))
    (error "the name of an outer object makes no sense"))
  (unless (= (loaded-next loaded) (length (loaded-objects loaded)))
    (error "a definition is listed after the objects of the run; definitions must come first"))
  (add-loaded (handler-case (apply #'outer-object name)
                (unknown-name (trouble) (error trouble))
                (error (trouble)
                  (error "~(~A~) ~A cannot be found: ~A" (first name)
                         (short-text (second name)) (one-line-text trouble))))
              nil loaded)
  ;; It has no contents in the file.
  (incf (loaded-next loaded)))

(defun new-array (element-type dimensions growth loaded)
  (unless (and (member element-type *element-types* :test #'equal)
               (typep dimensions '(cons unsigned-byte list))
               (proper-list-of-p (lambda (size) (typep size '(unsigned-byte 32))) dimensions)
               (<= (length dimensions) 8)
               (member growth '(nil :adjustable :growing))
               (or (not (eq :growing growth)) (null (rest dimensions))))
    (error "an array makes no sense"))
  (when (minusp (decf (loaded-elements-left loaded) (reduce #'* dimensions)))
    (error "the arrays would need more memory than there is"))
  (let ((growing-p (eq :growing growth)))
    (apply #'make-array (if growing-p (max 4 (first dimensions)) dimensions)
           :element-type element-type
           :adjustable (and growth t)
           :fill-pointer (and growing-p (first dimensions))
           (if (eq t element-type) '(:initial-element nil) '()))))

(defun new-object (shape fields loaded)
  "Return a new object of SHAPE, (kind argument ...), without contents. For a structure, FIELDS are
its slots."
  (destructuring-bind (kind &optional first second third) shape
    (ecase kind
      (:object (blank-object first fields))
      (:array (new-array first second third loaded))
      (:table (make-hash-table :test first))
      (:dice (make-dice 0))
      (:list (list nil))
      (:agenda (make-agenda)))))

(defun fields-called (type names)
  "Return the slots of structures of TYPE. Signals an error unless the slots that are saved have the
names NAMES."
  (unless (and (symbolp type)
               type
               (typep (find-class type nil) 'structure-class)
               (savable-type-p type))
    (error "the file has objects of a kind that is not loaded, ~A" (short-text type)))
  (let ((fields (fields-of-type type)))
    (unless (equal names (field-names (remove-if-not #'slot-kept-p fields)))
      (error "its objects of the kind ~(~A~) have other slots than the kind that is loaded; ~
              another version of the simulator, or of the kind, saved the file"
             type))
    fields))

(defun check-shape (shape)
  "Signal an error unless SHAPE, read from a file, is valid."
  (unless (typep shape '(or (cons (eql :object) (cons symbol (cons list null)))
                         (cons (eql :array) (cons t (cons t (cons t null))))
                         (cons (eql :table) (cons symbol (cons unsigned-byte null)))
                         (cons (eql :agenda) (cons unsigned-byte null))
                         (cons (member :dice :list) null)))
    (error "the file has objects without a shape"))
  (unless (or (not (eq :table (first shape))) (member (second shape) *table-tests*))
    (error "a hash table has a user-defined test")))

(defun add-batch (kind count shape loaded)
  "Make COUNT new objects of KIND and SHAPE, for the next COUNT numbers."
  (let ((shape (cons kind shape)))
    (check-shape shape)
    (unless (and (integerp count)
                 (<= 1 count (- (loaded-most-objects loaded) (length (loaded-objects loaded)))))
      (error "the file announces more objects than it has lines"))
    (let ((fields (and (eq :object kind) (fields-called (second shape) (third shape)))))
      (loop repeat count
            do (add-loaded (new-object shape fields loaded) (cons shape fields) loaded)))))

;;; Filling objects.

(defun put-field (value field object type)
  (handler-case (funcall (kind-slot-writer field) value object)
    (error ()
      (error "the slot ~(~A~) of a ~(~A~) cannot have the value in the file"
             (kind-slot-name field) type))))

(defun fill-object (object values fields type)
  "Store VALUES in the FIELDS of OBJECT that are saved, and initial values in its other fields."
  (dolist (field fields)
    (put-field (cond ((not (slot-kept-p field)) (funcall (kind-slot-initial field)))
                     (values (pop values))
                     (t (error "there are too few values for a ~(~A~)" type)))
               field object type))
  (when values (error "there are too many values for a ~(~A~)" type)))

(defun put-elements (array count element loaded)
  "Store ELEMENT in ARRAY, COUNT times, from the current position on."
  (let ((start (loaded-position loaded)))
    (unless (and (typep count '(integer 1)) (<= count (- (element-count array) start)))
      (error "there are too many elements for an array"))
    ;; ELEMENT may be an object that has not been filled, and so cannot be shown.
    (unless (typep element (array-element-type array))
      (error "an element of an array of ~(~S~) cannot be of type ~(~A~)"
             (array-element-type array) (class-name (class-of element))))
    (loop for index from start repeat count do (setf (row-major-aref array index) element))
    (incf (loaded-position loaded) count)))

(defun fill-text (text values loaded)
  (let ((part (and (typep values '(cons string null)) (first values))))
    (unless (and part (<= (length part) (- (length text) (loaded-position loaded))))
      (error "the contents of a string make no sense"))
    (replace text part :start1 (loaded-position loaded))
    (incf (loaded-position loaded) (length part))))

(defun fill-array (array values loaded)
  "Store the elements in VALUES in ARRAY, from the current position on. True if ARRAY is full now."
  (cond ((stringp array) (fill-text array values loaded))
        ((proper-list-p values)
         (loop for (count . rest) on values by #'cddr
               do (unless rest (error "an array has a repeat count without an element"))
                  (put-elements array count (first rest) loaded))))
  (= (element-count array) (loaded-position loaded)))

(defun collect-values (values count loaded)
  "Add VALUES to the values read from earlier lines. True if there are COUNT values now."
  (unless (proper-list-p values) (error "the contents of an object are no list"))
  (setf (loaded-values loaded) (revappend values (loaded-values loaded)))
  (incf (loaded-position loaded) (length values))
  (when (< count (loaded-position loaded)) (error "there are too many values for an object"))
  (= count (loaded-position loaded)))

(defun fill-from (object shape fields values loaded)
  "Store VALUES, the contents of a line, in OBJECT. True if OBJECT is complete."
  (ecase (first shape)
    (:array (fill-array object values loaded))
    (:object (when (collect-values values (count-if #'slot-kept-p fields) loaded)
               (fill-object object (reverse (loaded-values loaded)) fields (second shape))
               t))
    (:table (when (collect-values values (* 2 (third shape)) loaded)
              (push (cons object (reverse (loaded-values loaded))) (loaded-tables loaded))
              t))
    (:agenda (when (collect-values values (1+ (second shape)) loaded)
               (setf (loaded-agenda loaded) (cons object (reverse (loaded-values loaded))))
               t))
    (:dice (unless (typep values '(cons (unsigned-byte 64) null)) (error "the state of dice makes ~
                                                                          no sense"))
     (setf (dice-state object) (first values))
     t)
    (:list (unless (consp values) (error "a numbered list has no elements"))
     (setf (car object) (car values)
           (cdr object) (cdr values))
     t)))

(defun fill-next (line loaded)
  "Store the contents in LINE, a list (object content...), in the object. The object must be the
next object of LOADED."
  (let* ((number (loaded-next loaded))
         (object (and (< number (length (loaded-objects loaded)))
                      (aref (loaded-objects loaded) number))))
    (unless (and object (consp line) (eq object (first line)))
      (error "the contents of number ~D are missing" number))
    (destructuring-bind (shape . fields) (aref (loaded-shapes loaded) number)
      (when (fill-from object shape fields (rest line) loaded)
        (incf (loaded-next loaded))
        (setf (loaded-position loaded) 0
              (loaded-values loaded) '())))))

(defun all-objects-complete-p (loaded)
  "True if all objects of LOADED are complete."
  (= (loaded-next loaded) (length (loaded-objects loaded))))

(defun fill-tables (loaded)
  "Fill the hash tables of LOADED. All objects that may be keys are complete by now."
  (loop for (table . values) in (loaded-tables loaded)
        do (loop for (key value) on values by #'cddr
                 do (setf (gethash key table) value))
           (unless (= (* 2 (hash-table-count table)) (length values))
             (error "a hash table has the same key twice"))))
