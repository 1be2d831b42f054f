;;;; restoring.lisp -- objects put together from the lines of a saved run.

(in-package :ars-magna.run)

;;; Each line is read when those before it have been: first what the numbers stand for, so that
;;; objects of the right shapes are there; then what is in them. A line that makes no sense is an
;;; error, and so is all that would make more objects than there are lines for, or larger arrays
;;; than there is room for. Nothing looks at an object before it is whole.

(defstruct (loaded (:constructor make-loaded (most-objects)) (:copier nil))
  "The objects of a saved run, as far as it has been read. SHAPES has for each number the shape and
the fields, or NIL for what is beside the run."
  (most-objects 0 :type integer :read-only t)
  (objects (make-array 64 :adjustable t :fill-pointer 0) :type vector :read-only t)
  (shapes (make-array 64 :adjustable t :fill-pointer 0) :type vector :read-only t)
  (elements-left (floor (heap-bytes) 64) :type integer)
  ;; The number of the object that the next line is about; what is said of it so far: where in an
  ;; array, or values, newest first, and how many.
  (next 1 :type fixnum)
  (position 0 :type fixnum)
  (values '() :type list)
  ;; What can be filled only when all else is there.
  (agenda nil)
  (tables '() :type list))

(defun begin-loading (octets)
  "Return what is loaded, nothing as yet, from a file of so many OCTETS."
  (let ((loaded (make-loaded (floor octets 12))))
    (add-loaded nil nil loaded)
    loaded))

(defun add-loaded (object shape loaded)
  (when (< (loaded-most-objects loaded) (length (loaded-objects loaded)))
    (error "it speaks of more objects than it can say something of"))
  (vector-push-extend object (loaded-objects loaded))
  (vector-push-extend shape (loaded-shapes loaded)))

;;; What the numbers stand for.

(defun add-outer (name loaded)
  "Let the next number stand for what NAME, (kind argument [more]), finds."
  (unless (typep name '(cons keyword (cons t (or null (cons t null)))))
    (error "it looks for what has no name"))
  (unless (= (loaded-next loaded) (length (loaded-objects loaded)))
    (error "it looks for what is beside the run too late"))
  (add-loaded (handler-case (apply #'outer-object name)
                (unknown-name (trouble) (error trouble))
                (error (trouble)
                  (error "~(~A~) ~A cannot be found: ~A" (first name)
                         (short-text (second name)) (one-line-text trouble))))
              nil loaded)
  ;; No line follows.
  (incf (loaded-next loaded)))

(defun new-array (element-type dimensions growth loaded)
  (unless (and (member element-type *element-types* :test #'equal)
               (typep dimensions '(cons unsigned-byte list))
               (proper-list-of-p (lambda (size) (typep size '(unsigned-byte 32))) dimensions)
               (<= (length dimensions) 8)
               (member growth '(nil :adjustable :growing))
               (or (not (eq :growing growth)) (null (rest dimensions))))
    (error "one of its arrays makes no sense"))
  (when (minusp (decf (loaded-elements-left loaded) (reduce #'* dimensions)))
    (error "its arrays would take more room than there is"))
  (let ((growing-p (eq :growing growth)))
    (apply #'make-array (if growing-p (max 4 (first dimensions)) dimensions)
           :element-type element-type
           :adjustable (and growth t)
           :fill-pointer (and growing-p (first dimensions))
           (if (eq t element-type) '(:initial-element nil) '()))))

(defun new-object (shape fields loaded)
  "Return a new object of SHAPE, (kind argument ...), perhaps with FIELDS, in which nothing is as it
should be yet."
  (destructuring-bind (kind &optional first second third) shape
    (ecase kind
      (:object (blank-object first fields))
      (:array (new-array first second third loaded))
      (:table (make-hash-table :test first))
      (:dice (make-dice 0))
      (:list (list nil))
      (:agenda (make-agenda)))))

(defun fields-called (type names)
  "Return the fields of structures of TYPE. Signals an error unless those that are kept are called
NAMES."
  (unless (and (symbolp type)
               type
               (typep (find-class type nil) 'structure-class)
               (savable-type-p type))
    (error "it has objects of a kind that is not loaded, ~A" (short-text type)))
  (let ((fields (fields-of-type type)))
    (unless (equal names (field-names (remove-if-not #'slot-kept-p fields)))
      (error "its objects of the kind ~(~A~) are not made as those that are loaded; another ~
              version of the simulator, or of that kind, saved it"
             type))
    fields))

(defun check-shape (shape)
  "Signal an error unless SHAPE is one that objects can have."
  (unless (typep shape '(or (cons (eql :object) (cons symbol (cons list null)))
                         (cons (eql :array) (cons t (cons t (cons t null))))
                         (cons (eql :table) (cons symbol (cons unsigned-byte null)))
                         (cons (eql :agenda) (cons unsigned-byte null))
                         (cons (member :dice :list) null)))
    (error "it has objects without a shape"))
  (unless (or (not (eq :table (first shape))) (member (second shape) *table-tests*))
    (error "one of its tables has a test of its own")))

(defun add-batch (kind count shape loaded)
  "Let the next COUNT numbers stand for new objects of KIND and SHAPE."
  (let ((shape (cons kind shape)))
    (check-shape shape)
    (unless (and (integerp count)
                 (<= 1 count (- (loaded-most-objects loaded) (length (loaded-objects loaded)))))
      (error "it speaks of more objects than it can say something of"))
    (let ((fields (and (eq :object kind) (fields-called (second shape) (third shape)))))
      (loop repeat count
            do (add-loaded (new-object shape fields loaded) (cons shape fields) loaded)))))

;;; What is in them.

(defun put-field (value field object type)
  (handler-case (funcall (kind-slot-writer field) value object)
    (error ()
      (error "the slot ~(~A~) of a ~(~A~) cannot be what it says" (kind-slot-name field) type))))

(defun fill-object (object values fields type)
  "Put VALUES into those FIELDS of OBJECT that are kept, and what they begin with into the others."
  (dolist (field fields)
    (put-field (cond ((not (slot-kept-p field)) (funcall (kind-slot-initial field)))
                     (values (pop values))
                     (t (error "it says too little of a ~(~A~)" type)))
               field object type))
  (when values (error "it says too much of a ~(~A~)" type)))

(defun put-elements (array count element loaded)
  "Put ELEMENT into ARRAY COUNT times, from where the last line ended."
  (let ((start (loaded-position loaded)))
    (unless (and (typep count '(integer 1)) (<= count (- (element-count array) start)))
      (error "it says too much of an array"))
    ;; ELEMENT may be an object that has not been filled, and so cannot be shown.
    (unless (typep element (array-element-type array))
      (error "an element of an array of ~(~S~) cannot be of type ~(~A~)"
             (array-element-type array) (class-name (class-of element))))
    (loop for index from start repeat count do (setf (row-major-aref array index) element))
    (incf (loaded-position loaded) count)))

(defun fill-text (text values loaded)
  (let ((part (and (typep values '(cons string null)) (first values))))
    (unless (and part (<= (length part) (- (length text) (loaded-position loaded))))
      (error "what it says of a text makes no sense"))
    (replace text part :start1 (loaded-position loaded))
    (incf (loaded-position loaded) (length part))))

(defun fill-array (array values loaded)
  "Put what VALUES say into ARRAY, from where the last line ended. True if it is full now."
  (cond ((stringp array) (fill-text array values loaded))
        ((proper-list-p values)
         (loop for (count . rest) on values by #'cddr
               do (unless rest (error "it says how often, but not what, in an array"))
                  (put-elements array count (first rest) loaded))))
  (= (element-count array) (loaded-position loaded)))

(defun collect-values (values count loaded)
  "Note VALUES besides those of lines before. True if they are COUNT now."
  (unless (proper-list-p values) (error "what it says of an object has no end"))
  (setf (loaded-values loaded) (revappend values (loaded-values loaded)))
  (incf (loaded-position loaded) (length values))
  (when (< count (loaded-position loaded)) (error "it says too much of an object"))
  (= count (loaded-position loaded)))

(defun fill-from (object shape fields values loaded)
  "Put what a line says, VALUES, into OBJECT. True if it says all that was left to be said."
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
    (:dice (unless (typep values '(cons (unsigned-byte 64) null)) (error "its dice make no sense"))
     (setf (dice-state object) (first values))
     t)
    (:list (unless (consp values) (error "one of its lists has nothing in it"))
     (setf (car object) (car values)
           (cdr object) (cdr values))
     t)))

(defun fill-next (line loaded)
  "Take in LINE, a list of an object and what is said of it. It must be the next of those LOADED."
  (let* ((number (loaded-next loaded))
         (object (and (< number (length (loaded-objects loaded)))
                      (aref (loaded-objects loaded) number))))
    (unless (and object (consp line) (eq object (first line)))
      (error "it does not say what number ~D is" number))
    (destructuring-bind (shape . fields) (aref (loaded-shapes loaded) number)
      (when (fill-from object shape fields (rest line) loaded)
        (incf (loaded-next loaded))
        (setf (loaded-position loaded) 0
              (loaded-values loaded) '())))))

(defun all-said-p (loaded)
  "True if all that is LOADED is whole."
  (= (loaded-next loaded) (length (loaded-objects loaded))))

(defun fill-tables (loaded)
  "Put into each table what belongs there: all its keys are whole by now."
  (loop for (table . values) in (loaded-tables loaded)
        do (loop for (key value) on values by #'cddr
                 do (setf (gethash key table) value))
           (unless (= (* 2 (hash-table-count table)) (length values))
             (error "one of its tables has a key twice"))))
