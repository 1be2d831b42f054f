;;;; inventory.lisp -- finding and numbering all objects of a run, to save them.

(in-package :ars-magna.run)

;;; Some objects do not belong to one run: maps, robots' definitions, kickers and other definitions,
;;; and some functions of the simulator. A saved run refers to these external objects by name, and
;;; they must be defined where it is loaded.

(defgeneric external-name (object)
  (:documentation "Return the name of OBJECT, or NIL if OBJECT belongs to one run. The name is a
list (KIND argument...) of a keyword and plain data. EXTERNAL-OBJECT finds OBJECT by this name.")
  (:method (object) (declare (ignore object)) nil)
  (:method ((map map)) (list :map (qualified-name (map-name map))))
  (:method ((blueprint blueprint)) (list :robot (qualified-name (blueprint-name blueprint))))
  (:method ((kicker kicker)) (list :kicker (qualified-name (kicker-name kicker))))
  (:method ((type place-type)) (list :place-type (qualified-name (place-type-name type))))
  (:method ((character character)) (list :character (char-code character)))
  (:method ((command command))
    (list (if (manipulation-command-p command) :manipulation :command)
          (qualified-name (command-name command))))
  (:method ((method manipulation-method))
    (loop for manipulation in (all-manipulations)
          for position = (position method (manipulation-methods manipulation))
          when position
            return (list :method (qualified-name (manipulation-name manipulation)) position)))
  (:method ((function function))
    (let ((name (savable-function-name function)))
      (and name (list :function name))))
  (:method ((number float))
    (and (typep number 'double-float)
         (not (finite-p number))
         (list :double-float (double-to-bits number)))))

(defun manipulation-method-at (position name)
  (check-type position unsigned-byte)
  (or (nth position (manipulation-methods (find-manipulation name)))
      (error "the manipulation ~(~A~) has too few methods for the file" name)))

(defun external-object (kind argument &optional more)
  "Return the object with the external name (KIND ARGUMENT [MORE]), or signal an error."
  (or (typecase argument
        (string (case kind
                  (:map (find-map argument))
                  (:robot (find-blueprint argument))
                  (:kicker (find-kicker argument))
                  (:place-type (find-place-type argument))
                  (:command (find-command argument))
                  (:manipulation (ensure-manipulation-command (find-manipulation argument)))
                  (:method (manipulation-method-at more argument))))
        (integer (case kind
                   (:character (code-char (the (integer 0 (#.char-code-limit)) argument)))
                   (:double-float (bits-to-double (the (unsigned-byte 64) argument)))))
        (symbol (and (eq :function kind)
                     (or (find-savable-function argument)
                         (error "~A is not a function that a saved run may refer to" argument)))))
      (error "~A is not a kind of object that a saved run may refer to" (short-text kind))))

(defun checked-external-name (object)
  "Return the EXTERNAL-NAME of OBJECT, and true if this name no longer means OBJECT."
  (let ((name (external-name object)))
    (values name
            (and name
                 (not (eql object (ignore-errors (apply #'external-object name))))))))

;;;; The inventory

;;; The inventory contains all objects that can be reached from the simulation. Structures, arrays
;;; and tables get numbers, and so do lists and strings that are found twice or would make a line of
;;; the file too long. Other values are written where they are found. Objects of one shape form a
;;; batch and have successive numbers.

(defconstant +longest-inline-string+ 1000 "The most characters of a string without a number.")
(defconstant +most-elements-in-line+ 1000 "The most elements of a list or array in a line.")
(defconstant +max-nesting+ 50 "The deepest nesting of lists without numbers.")
(defconstant +max-characters-per-object+ 300000
  "The approximate maximum number of characters that are written for one object.")

(defstruct (batch (:constructor make-batch (shape fields)) (:copier nil))
  "Objects of the same SHAPE. If they are structures, FIELDS are their slots."
  (shape '() :type list :read-only t)
  (fields '() :type list :read-only t)
  (members (make-array 4 :adjustable t :fill-pointer 0) :type vector :read-only t))

(defstruct (inventory (:constructor make-inventory ()) (:copier nil))
  "The objects of a run that is to be saved. STATES is a hash table; its keys are the objects found
so far, its values :FOUND or :NUMBERED. At the end, the number of the object replaces :NUMBERED."
  (states (make-hash-table :test 'eql) :type hash-table :read-only t)
  (external-objects '() :type list)
  (batches (make-hash-table :test 'equal) :type hash-table :read-only t)
  (shapes '() :type list)
  (waiting '() :type list)
  ;; About how many more characters may be written for the current object.
  (room 0 :type fixnum)
  ;; The current object and its current field, for messages.
  (holder nil)
  (field nil))

;;; Objects that cannot be saved.

(defun reject-unsavable (object why inventory)
  "Signal MISUSE: OBJECT, in the current object of INVENTORY, cannot be saved for the reason WHY."
  (let ((field (inventory-field inventory)))
    (reject-use "The run cannot be saved: ~@[the slot ~(~A~) of ~]~A contains ~A. ~A."
                (and field (kind-slot-name field)) (short-text (inventory-holder inventory))
                (one-line (short-text object)) why)))

;;; Shapes.

(defparameter *savable-element-types*
  (cons t (remove-duplicates
           (mapcar #'upgraded-array-element-type
                   (list* 'bit 'character 'base-char 'single-float 'double-float 'fixnum
                          (loop for bits in '(1 2 4 7 8 15 16 31 32 62 63 64)
                                collect (list 'unsigned-byte bits)
                                collect (list 'signed-byte bits))))
           :test #'equal))
  "The element types of arrays that can be saved with a run.")

(defparameter *savable-table-tests* '(eq eql equal equalp)
  "The tests of hash tables that can be saved with a run.")

(defun array-shape (array)
  (list :array (array-element-type array) (if (array-has-fill-pointer-p array)
                                              (list (fill-pointer array))
                                              (array-dimensions array))
        (cond ((array-has-fill-pointer-p array) :growing)
              ((adjustable-array-p array) :adjustable))))

(defun savable-structure-type-p (type)
  "True if structures of TYPE, a symbol, can be saved slot by slot."
  (or (kind-named type)
      (member type '(place cell interruption command-failure pt interval pt-interval))
      (not (or (lisp-symbol-p type) (simulator-symbol-p type)))))

(defun structure-shape (object inventory)
  (let ((type (type-of object)))
    (unless (and (symbolp type) (savable-structure-type-p type))
      (reject-unsavable object "Only the Lisp that made this object can use it" inventory))
    (list :object type)))

(defun table-shape (table inventory)
  (unless (member (hash-table-test table) *savable-table-tests*)
    (reject-unsavable table "Hash tables with a user-defined test cannot be saved" inventory))
  (list :table (hash-table-test table) (hash-table-count table)))

(defun saved-object-shape (object inventory)
  "Return the shape of OBJECT: a list of a keyword and plain data from which an empty object of the
same structure can be made. Signals MISUSE."
  (typecase object
    (cons (list :list))
    (array (array-shape object))
    (hash-table (table-shape object inventory))
    (dice (list :dice))
    (agenda (list :agenda (agenda-pending object)))
    (structure-object (structure-shape object inventory))
    (t (reject-unsavable object "Only the Lisp that made this object can use it" inventory))))

(defun shape-fields (shape)
  (and (eq :object (first shape))
       (remove-if-not #'saved-slot-p (fields-of-type (second shape)))))

;;; Finding objects.

(defun add-to-batch (object inventory)
  (let* ((shape (saved-object-shape object inventory))
         (batch (or (gethash shape (inventory-batches inventory))
                    (progn (push shape (inventory-shapes inventory))
                           (setf (gethash shape (inventory-batches inventory))
                                 (make-batch shape (shape-fields shape)))))))
    (vector-push-extend object (batch-members batch))))

(defun mark-found (object numbered-p inventory)
  "Record in INVENTORY that OBJECT was found. OBJECT gets a number if NUMBERED-P is true or if it
was found before. Return true if it was found before."
  (let ((state (gethash object (inventory-states inventory))))
    (when (or (eq :found state) (and numbered-p (null state)))
      (setf (gethash object (inventory-states inventory)) :numbered)
      (add-to-batch object inventory))
    (unless (or state numbered-p)
      (setf (gethash object (inventory-states inventory)) :found))
    state))

(defun mark-numbered (object inventory)
  "Give OBJECT a number in INVENTORY. If it belongs to the run, its contents are recorded later."
  (unless (gethash object (inventory-states inventory))
    (multiple-value-bind (name other-p) (checked-external-name object)
      (cond ((null name)
             (mark-found object t inventory)
             (push object (inventory-waiting inventory)))
            (other-p
             (reject-unsavable object "This object has been defined anew, or is no longer defined"
                               inventory))
            (t (setf (gethash object (inventory-states inventory)) :numbered)
               (push (cons object name) (inventory-external-objects inventory)))))))

(defun reserve-characters (characters inventory)
  "Record CHARACTERS more characters for the current object of INVENTORY. True if there is room."
  (plusp (decf (inventory-room inventory) characters)))

(defun record-string (text inventory)
  (let ((short-p (and (<= (length text) +longest-inline-string+) (simple-string-p text))))
    (mark-found text (not (and (reserve-characters (* 2 (length text)) inventory) short-p))
                inventory)))

(defun record-list (list depth inventory)
  "Record the conses of LIST, which is nested DEPTH deep, and their contents in INVENTORY."
  (loop for tail = list then (cdr tail)
        for position from 1
        while (consp tail)
        do (let ((far-p (or (not (reserve-characters 2 inventory)) (= depth +max-nesting+))))
             (when (mark-found tail (or far-p (= position +most-elements-in-line+)) inventory)
               (return))
             ;; The rest gets its own line and is surveyed later.
             (when (or far-p (= position +most-elements-in-line+))
               (push tail (inventory-waiting inventory))
               (return))
             (record-value (car tail) depth inventory))
        finally (record-value tail depth inventory)))

(defun record-value (value depth inventory)
  "Record VALUE in INVENTORY, and also its contents if it gets no number. Signals MISUSE."
  (typecase value
    ((or null fixnum) (reserve-characters 20 inventory))
    (double-float (if (finite-p value)
                      (reserve-characters 25 inventory)
                      (mark-numbered value inventory)))
    (symbol (reserve-characters (+ 10 (* 2 (length (symbol-name value)))) inventory)
     (when (unprintable-atom-p value)
       (reject-unsavable value "The package of this symbol has a name with ::" inventory)))
    (number (reserve-characters 50 inventory)
     (when (unprintable-atom-p value) (reject-unsavable value "This number is too long" inventory)))
    (cons (record-list value (1+ depth) inventory))
    (string (record-string value inventory))
    (t (mark-numbered value inventory))))

;;; Contents of objects.

(defun record-slots (object inventory)
  (let ((batch (gethash (saved-object-shape object inventory) (inventory-batches inventory))))
    (dolist (field (batch-fields batch))
      (setf (inventory-field inventory) field)
      (record-value (funcall (kind-slot-reader field) object) 0 inventory))))

(defun record-array (array inventory)
  (when (eq t (array-element-type array))
    (dotimes (index (element-count array))
      (record-value (row-major-aref array index) 0 inventory))))

(defun record-contents (object inventory)
  (setf (inventory-room inventory) +max-characters-per-object+
        (inventory-holder inventory) object
        (inventory-field inventory) nil)
  (typecase object
    (cons (record-value (car object) 0 inventory)
     (record-value (cdr object) 0 inventory))
    (array (record-array object inventory))
    (hash-table (maphash (lambda (key value)
                           (record-value key 0 inventory)
                           (record-value value 0 inventory))
                         object))
    (dice)
    (agenda (dolist (event (pending-events object)) (record-value event 0 inventory)))
    (t (record-slots object inventory))))

(defun record-all-contents (inventory)
  "Record the contents of all objects in INVENTORY, until no new objects are found."
  (loop while (inventory-waiting inventory)
        do (dolist (object (reverse (shiftf (inventory-waiting inventory) '())))
             (record-contents object inventory))))

(defun batches-in-order (inventory)
  (loop for shape in (reverse (inventory-shapes inventory))
        collect (gethash shape (inventory-batches inventory))))

(defun number-objects (inventory)
  "Number the objects in INVENTORY: first the external objects, then the objects of each batch."
  (let ((number 0) (states (inventory-states inventory)))
    (setf (inventory-external-objects inventory) (reverse (inventory-external-objects inventory)))
    (loop for (object) in (inventory-external-objects inventory)
          do (setf (gethash object states) (incf number)))
    (dolist (batch (batches-in-order inventory))
      (loop for object across (batch-members batch)
            do (setf (gethash object states) (incf number))))))

(defun take-inventory (simulation requests)
  "Return the inventory of SIMULATION and of REQUESTS, a list of the requests in its inbox. The
first batch is SIMULATION alone. Signals MISUSE."
  (let ((inventory (make-inventory)))
    (setf (inventory-holder inventory) simulation)
    (record-value simulation 0 inventory)
    (dolist (request requests) (record-value request 0 inventory))
    (record-all-contents inventory)
    (number-objects inventory)
    inventory))

(defun inventory-size (inventory)
  (+ (length (inventory-external-objects inventory))
     (loop for batch in (batches-in-order inventory) sum (length (batch-members batch)))))

(defun object-number (object inventory)
  (let ((state (gethash object (inventory-states inventory))))
    (and (integerp state) state)))
