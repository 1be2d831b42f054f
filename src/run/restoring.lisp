;;;; restoring.lisp -- making objects from the lines of a saved run.

(in-package :ars-magna.run)

;;; The first lines define the numbers, and empty objects of the right shapes are made. The other
;;; lines fill them in order. A senseless line is an error; so are more objects than the file can
;;; have lines for, and arrays that exceed the memory. No code uses an object before it is complete.

(defstruct (loader (:constructor make-loader (most-objects)) (:copier nil))
  "The objects of a saved run that is being read. SHAPES contains the shape and fields of the object
of each number, or NIL for an external object."
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

(defun make-empty-loader (octets)
  (let ((loader (make-loader (floor octets 12))))
    (add-object nil nil loader)
    loader))

(defun add-object (object shape loader)
  (when (< (loader-most-objects loader) (length (loader-objects loader)))
    (error "the file announces more objects than it has lines"))
  (vector-push-extend object (loader-objects loader))
  (vector-push-extend shape (loader-shapes loader)))

;;; Defining numbers.

(defun add-external-object (name loader)
  "Give the next number to the external object with the name NAME, (kind argument [more])."
  (unless (typep name '(cons keyword (cons t (or null (cons t null)))))
    (error "the name of an external object makes no sense"))
  (unless (= (loader-next loader) (length (loader-objects loader)))
    (error "a definition is listed after the objects of the run; definitions must come first"))
  (add-object (handler-case (apply #'external-object name)
                (unknown-name (trouble) (error trouble))
                (error (trouble)
                  (error "~(~A~) ~A cannot be found: ~A" (first name)
                         (short-text (second name)) (one-line-text trouble))))
              nil loader)
  ;; It has no contents in the file.
  (incf (loader-next loader)))

(defun make-empty-array (element-type dimensions growth loader)
  (unless (and (member element-type *savable-element-types* :test #'equal)
               (typep dimensions '(cons unsigned-byte list))
               (proper-list-of-p (lambda (size) (typep size '(unsigned-byte 32))) dimensions)
               (<= (length dimensions) 8)
               (member growth '(nil :adjustable :growing))
               (or (not (eq :growing growth)) (null (rest dimensions))))
    (error "an array makes no sense"))
  (when (minusp (decf (loader-elements-left loader) (reduce #'* dimensions)))
    (error "the arrays would need more memory than there is"))
  (let ((growing-p (eq :growing growth)))
    (apply #'make-array (if growing-p (max 4 (first dimensions)) dimensions)
           :element-type element-type
           :adjustable (and growth t)
           :fill-pointer (and growing-p (first dimensions))
           (if (eq t element-type) '(:initial-element nil) '()))))

(defun make-empty-object (shape fields loader)
  "Return a new empty object of SHAPE, (kind argument ...). FIELDS are the slots of a structure."
  (destructuring-bind (kind &optional first second third) shape
    (ecase kind
      (:object (blank-object first fields))
      (:array (make-empty-array first second third loader))
      (:table (make-hash-table :test first))
      (:dice (make-dice 0))
      (:list (list nil))
      (:agenda (make-agenda)))))

(defun as-unsaved-slot (field)
  "Return a copy of FIELD, the description of a slot, for a file without this slot."
  (make-kind-slot (kind-slot-name field) :link (kind-slot-type field) (kind-slot-text field)
                  (kind-slot-part-p field) (kind-slot-shared-p field) (kind-slot-initial field)
                  (kind-slot-reader field) (kind-slot-writer field)))

(defparameter *newer-slots*
  '((ars-magna.robot:designator "ORIGIN")
    (ars-magna.robot:mind "UNPAID")
    (ars-magna.world:world "RUN-VARIABLES")
    (ars-magna.robot:mind "PLAN-TIMES")
    (ars-magna.robot:robot "RADIO")
    (ars-magna.world:world "GHOSTS-P" "DICE-NAMES" "ROSTER")
    (ars-magna.world:stock "BODIES")
    (ars-magna.robot:robot "BODY" "DICE-BASE" "KEY" "START"))
  "Slots that earlier versions did not save, as lists (type name...), the newest first. Version 1.10
saved none of them; runs with one robot do not need them. Radios are made when a run is loaded.")

(defun without-slots (names fields)
  "Return FIELDS with the slots that have NAMES marked as not saved."
  (loop for field in fields
        collect (if (member (kind-slot-name field) names :test #'string=)
                    (as-unsaved-slot field)
                    field)))

(defun names-of-saved-slots (fields)
  (field-names (remove-if-not #'saved-slot-p fields)))

(defun saved-slots (type names)
  "Return the slots of structures of TYPE. Signals an error unless NAMES lists the slots to save."
  (unless (and (symbolp type)
               type
               (typep (find-class type nil) 'structure-class)
               (savable-structure-type-p type))
    (error "the file has objects of a kind that is not loaded, ~A" (short-text type)))
  (loop with fields = (fields-of-type type)
        for (nil . newer) in (cons '() (remove type *newer-slots* :key #'first :test-not #'eq))
        do (setf fields (without-slots newer fields))
           (when (equal names (names-of-saved-slots fields)) (return fields))
        finally (error "its objects of the kind ~(~A~) have other slots than the kind that is ~
                        loaded; another version of the simulator, or of the kind, saved the file"
                       type)))

(defun check-shape (shape)
  "Signal an error unless SHAPE, read from a file, is valid."
  (unless (typep shape '(or (cons (eql :object) (cons symbol (cons list null)))
                         (cons (eql :array) (cons t (cons t (cons t null))))
                         (cons (eql :table) (cons symbol (cons unsigned-byte null)))
                         (cons (eql :agenda) (cons unsigned-byte null))
                         (cons (member :dice :list) null)))
    (error "the file has objects without a shape"))
  (unless (or (not (eq :table (first shape))) (member (second shape) *savable-table-tests*))
    (error "a hash table has a user-defined test")))

(defun add-new-objects (kind count shape loader)
  "Make COUNT new objects of KIND and SHAPE, for the next COUNT numbers."
  (let ((shape (cons kind shape)))
    (check-shape shape)
    (unless (and (integerp count)
                 (<= 1 count (- (loader-most-objects loader) (length (loader-objects loader)))))
      (error "the file announces more objects than it has lines"))
    (let ((fields (and (eq :object kind) (saved-slots (second shape) (third shape)))))
      (loop repeat count
            do (add-object (make-empty-object shape fields loader) (cons shape fields) loader)))))

;;; Filling objects.

(defun store-slot (value field object type)
  (handler-case (funcall (kind-slot-writer field) value object)
    (error ()
      (error "the slot ~(~A~) of a ~(~A~) cannot have the value in the file"
             (kind-slot-name field) type))))

(defun fill-object (object values fields type)
  "Store VALUES in the FIELDS of OBJECT that are saved, and initial values in its other fields."
  (dolist (field fields)
    (store-slot (cond ((not (saved-slot-p field)) (funcall (kind-slot-initial field)))
                      (values (pop values))
                      (t (error "there are too few values for a ~(~A~)" type)))
                field object type))
  (when values (error "there are too many values for a ~(~A~)" type)))

(defun store-elements (array count element loader)
  "Store ELEMENT in ARRAY, COUNT times, from the current position on."
  (let ((start (loader-position loader)))
    (unless (and (typep count '(integer 1)) (<= count (- (element-count array) start)))
      (error "there are too many elements for an array"))
    ;; ELEMENT may be an object that has not been filled, and so cannot be shown.
    (unless (typep element (array-element-type array))
      (error "an element of an array of ~(~S~) cannot be of type ~(~A~)"
             (array-element-type array) (class-name (class-of element))))
    (loop for index from start repeat count do (setf (row-major-aref array index) element))
    (incf (loader-position loader) count)))

(defun fill-text (text values loader)
  (let ((part (and (typep values '(cons string null)) (first values))))
    (unless (and part (<= (length part) (- (length text) (loader-position loader))))
      (error "the contents of a string make no sense"))
    (replace text part :start1 (loader-position loader))
    (incf (loader-position loader) (length part))))

(defun fill-array (array values loader)
  "Store the elements in VALUES in ARRAY, from the current position on. True if ARRAY is full now."
  (cond ((stringp array) (fill-text array values loader))
        ((proper-list-p values)
         (loop for (count . rest) on values by #'cddr
               do (unless rest (error "an array has a repeat count without an element"))
                  (store-elements array count (first rest) loader))))
  (= (element-count array) (loader-position loader)))

(defun collect-values (values count loader)
  "Add VALUES to the values read from earlier lines. True if there are COUNT values now."
  (unless (proper-list-p values) (error "the contents of an object are no list"))
  (setf (loader-values loader) (revappend values (loader-values loader)))
  (incf (loader-position loader) (length values))
  (when (< count (loader-position loader)) (error "there are too many values for an object"))
  (= count (loader-position loader)))

(defun store-line-contents (object shape fields values loader)
  "Store VALUES, the contents of a line, in OBJECT. True if OBJECT is complete."
  (ecase (first shape)
    (:array (fill-array object values loader))
    (:object (when (collect-values values (count-if #'saved-slot-p fields) loader)
               (fill-object object (reverse (loader-values loader)) fields (second shape))
               t))
    (:table (when (collect-values values (* 2 (third shape)) loader)
              (push (cons object (reverse (loader-values loader))) (loader-tables loader))
              t))
    (:agenda (when (collect-values values (1+ (second shape)) loader)
               (setf (loader-agenda loader) (cons object (reverse (loader-values loader))))
               t))
    (:dice (unless (typep values '(cons (unsigned-byte 64) null)) (error "the state of dice makes ~
                                                                          no sense"))
     (setf (dice-state object) (first values))
     t)
    (:list (unless (consp values) (error "a numbered list has no elements"))
     (setf (car object) (car values)
           (cdr object) (cdr values))
     t)))

(defun process-contents-line (line loader)
  "Store the contents in LINE, (object content...), in the object, which must be LOADER's next."
  (let* ((number (loader-next loader))
         (object (and (< number (length (loader-objects loader)))
                      (aref (loader-objects loader) number))))
    (unless (and object (consp line) (eq object (first line)))
      (error "the contents of number ~D are missing" number))
    (destructuring-bind (shape . fields) (aref (loader-shapes loader) number)
      (when (store-line-contents object shape fields (rest line) loader)
        (incf (loader-next loader))
        (setf (loader-position loader) 0
              (loader-values loader) '())))))

(defun all-objects-complete-p (loader)
  (= (loader-next loader) (length (loader-objects loader))))

(defun fill-hash-tables (loader)
  "Fill the hash tables of LOADER. All objects that may be keys are complete by now."
  (loop for (table . values) in (loader-tables loader)
        do (loop for (key value) on values by #'cddr
                 do (setf (gethash key table) value))
           (unless (= (* 2 (hash-table-count table)) (length values))
             (error "a hash table has the same key twice"))))
