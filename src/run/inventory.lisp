;;;; inventory.lisp -- all the objects of a run, met by going from one to the next, and numbered.

(in-package :ars-magna.run)

;;; Maps, robots' definitions, kickers and the like are not of one run; neither are some functions
;;; of ours that its objects hold. A saved run names them, and they must be defined where it is
;;; loaded.

(defgeneric outer-name (object)
  (:documentation "Return the name, a list (KIND argument...) of a keyword and plain data, by which
OUTER-OBJECT finds OBJECT, which is not of any one run; or NIL if it is of one.")
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
    (let ((name (lasting-name function)))
      (and name (list :function name))))
  (:method ((number float))
    (and (typep number 'double-float)
         (not (finite-p number))
         (list :double-float (double-to-bits number)))))

(defun method-at (position name)
  "Return the method at POSITION of the manipulation called NAME."
  (check-type position unsigned-byte)
  (or (nth position (manipulation-methods (find-manipulation name)))
      (error "~(~A~) has not so many methods" name)))

(defun outer-object (kind argument &optional more)
  "Return what the name (KIND ARGUMENT [MORE]) means here. Signals an error if it means nothing."
  (or (typecase argument
        (string (case kind
                  (:map (find-map argument))
                  (:robot (find-blueprint argument))
                  (:kicker (find-kicker argument))
                  (:place-type (find-place-type argument))
                  (:command (find-command argument))
                  (:manipulation (command-for (find-manipulation argument)))
                  (:method (method-at more argument))))
        (integer (case kind
                   (:character (code-char (the (integer 0 (#.char-code-limit)) argument)))
                   (:double-float (bits-to-double (the (unsigned-byte 64) argument)))))
        (symbol (and (eq :function kind)
                     (or (lasting-function argument)
                         (error "~A is no function that objects of a run hold" argument)))))
      (error "~A is nothing that a run uses" (short-text kind))))

(defun name-at-hand (object)
  "Return the OUTER-NAME of OBJECT; a second value is true if that means another, or nothing, now."
  (let ((name (outer-name object)))
    (values name
            (and name
                 (not (eql object (ignore-errors (apply #'outer-object name))))))))

;;;; The inventory

;;; From the simulation every object is reached that it would need to go on. What has an identity
;;; gets a number: structures, arrays and tables; and lists and strings that are met twice, or would
;;; make a line of a file too long. All else is written where it is met. Objects of one shape make a
;;; batch, and have successive numbers.

(defconstant +longest-text+ 1000 "How many characters a string has at most that has no number.")
(defconstant +longest-row+ 1000 "How many elements of a list or array a line has at most.")
(defconstant +deepest-text+ 50 "How deep lists without numbers stand in lists at most.")
(defconstant +room-of-object+ 300000 "About how many characters may be written for one object.")

(defstruct (batch (:constructor make-batch (shape fields)) (:copier nil))
  "Objects of one SHAPE. FIELDS are those of structures."
  (shape '() :type list :read-only t)
  (fields '() :type list :read-only t)
  (members (make-array 4 :adjustable t :fill-pointer 0) :type vector :read-only t))

(defstruct (inventory (:constructor make-inventory ()) (:copier nil))
  "The objects of a run. STATES has for each that was met :MET, :NUMBERED, or in the end its number,
if it is to have one."
  (states (make-hash-table :test 'eql) :type hash-table :read-only t)
  (outer '() :type list)
  (batches (make-hash-table :test 'equal) :type hash-table :read-only t)
  (shapes '() :type list)
  (waiting '() :type list)
  ;; About how many characters may yet be written for the object that is looked at.
  (room 0 :type fixnum)
  ;; The object that is looked at, and the field in which, for messages.
  (holder nil)
  (field nil))

;;; What cannot be saved.

(defun reject-object (object why inventory)
  "Signal MISUSE: OBJECT, met in what INVENTORY looks at, cannot be saved, and WHY."
  (let ((field (inventory-field inventory)))
    (reject-use "The run cannot be saved: in ~@[the slot ~(~A~) of ~]~A is ~A, ~A."
                (and field (kind-slot-name field)) (short-text (inventory-holder inventory))
                (one-line (short-text object)) why)))

;;; Shapes.

(defparameter *element-types*
  (cons t (remove-duplicates
           (mapcar #'upgraded-array-element-type
                   (list* 'bit 'character 'base-char 'single-float 'double-float 'fixnum
                          (loop for bits in '(1 2 4 7 8 15 16 31 32 62 63 64)
                                collect (list 'unsigned-byte bits)
                                collect (list 'signed-byte bits))))
           :test #'equal))
  "What arrays that are saved can have as elements.")

(defparameter *table-tests* '(eq eql equal equalp)
  "The tests that tables which are saved can have.")

(defun array-shape (array)
  (list :array (array-element-type array) (if (array-has-fill-pointer-p array)
                                              (list (fill-pointer array))
                                              (array-dimensions array))
        (cond ((array-has-fill-pointer-p array) :growing)
              ((adjustable-array-p array) :adjustable))))

(defun savable-type-p (type)
  "True if structures called TYPE, a symbol, can be saved by what is in their slots."
  (or (kind-called type)
      (member type '(place cell interruption command-failure pt interval pt-interval))
      (not (or (lisps-own-p type) (our-own-p type)))))

(defun structure-shape (object inventory)
  (let ((type (type-of object)))
    (unless (and (symbolp type) (savable-type-p type))
      (reject-object object "which only its own Lisp knows" inventory))
    (list :object type)))

(defun table-shape (table inventory)
  (unless (member (hash-table-test table) *table-tests*)
    (reject-object table "a table with a test of its own" inventory))
  (list :table (hash-table-test table) (hash-table-count table)))

(defun shape-in-inventory (object inventory)
  "Return what must be known of OBJECT before what is in it: a list of a keyword and plain data.
Signals MISUSE."
  (typecase object
    (cons (list :list))
    (array (array-shape object))
    (hash-table (table-shape object inventory))
    (dice (list :dice))
    (agenda (list :agenda (agenda-pending object)))
    (structure-object (structure-shape object inventory))
    (t (reject-object object "which only its own Lisp knows" inventory))))

(defun shape-fields (shape)
  (and (eq :object (first shape))
       (remove-if-not #'slot-kept-p (fields-of-type (second shape)))))

;;; Meeting objects.

(defun enlist (object inventory)
  "Give OBJECT a place in its batch in INVENTORY."
  (let* ((shape (shape-in-inventory object inventory))
         (batch (or (gethash shape (inventory-batches inventory))
                    (progn (push shape (inventory-shapes inventory))
                           (setf (gethash shape (inventory-batches inventory))
                                 (make-batch shape (shape-fields shape)))))))
    (vector-push-extend object (batch-members batch))))

(defun meet (object numbered-p inventory)
  "Note that OBJECT was met, to have a number if NUMBERED-P is true. True if it was met before."
  (let ((state (gethash object (inventory-states inventory))))
    (when (or (eq :met state) (and numbered-p (null state)))
      (setf (gethash object (inventory-states inventory)) :numbered)
      (enlist object inventory))
    (unless (or state numbered-p)
      (setf (gethash object (inventory-states inventory)) :met))
    state))

(defun meet-object (object inventory)
  "Meet OBJECT, which has a number: one of the run, to be looked at later, or one beside it."
  (unless (gethash object (inventory-states inventory))
    (multiple-value-bind (name other-p) (name-at-hand object)
      (cond ((null name)
             (meet object t inventory)
             (push object (inventory-waiting inventory)))
            (other-p
             (reject-object object "which has been defined anew, or is no longer defined"
                            inventory))
            (t (setf (gethash object (inventory-states inventory)) :numbered)
               (push (cons object name) (inventory-outer inventory)))))))

(defun take-room (characters inventory)
  "Note that some CHARACTERS will be written for the object at hand. True if there is room."
  (plusp (decf (inventory-room inventory) characters)))

(defun survey-text (text inventory)
  (let ((short-p (and (<= (length text) +longest-text+) (simple-string-p text))))
    (meet text (not (and (take-room (* 2 (length text)) inventory) short-p)) inventory)))

(defun survey-list (list depth inventory)
  "Meet the conses of LIST, which stands DEPTH deep in others, and what is in them."
  (loop for tail = list then (cdr tail)
        for position from 1
        while (consp tail)
        do (let ((far-p (or (not (take-room 2 inventory)) (= depth +deepest-text+))))
             (when (meet tail (or far-p (= position +longest-row+)) inventory) (return))
             ;; What follows in a line of its own can be looked at by itself.
             (when (or far-p (= position +longest-row+))
               (push tail (inventory-waiting inventory))
               (return))
             (survey (car tail) depth inventory))
        finally (survey tail depth inventory)))

(defun survey (value depth inventory)
  "Meet VALUE, and what is in it if it has no number. Signals MISUSE."
  (typecase value
    ((or null fixnum) (take-room 20 inventory))
    (double-float (if (finite-p value)
                      (take-room 25 inventory)
                      (meet-object value inventory)))
    (symbol (take-room (+ 10 (* 2 (length (symbol-name value)))) inventory)
     (when (unprintable-atom-p value)
       (reject-object value "whose package has :: in its name" inventory)))
    (number (take-room 50 inventory)
     (when (unprintable-atom-p value) (reject-object value "which is too long" inventory)))
    (cons (survey-list value (1+ depth) inventory))
    (string (survey-text value inventory))
    (t (meet-object value inventory))))

;;; Looking at what was met.

(defun survey-fields (object inventory)
  (let ((batch (gethash (shape-in-inventory object inventory) (inventory-batches inventory))))
    (dolist (field (batch-fields batch))
      (setf (inventory-field inventory) field)
      (survey (funcall (kind-slot-reader field) object) 0 inventory))))

(defun survey-array (array inventory)
  (when (eq t (array-element-type array))
    (dotimes (index (element-count array))
      (survey (row-major-aref array index) 0 inventory))))

(defun survey-contents (object inventory)
  "Meet what is in OBJECT, which has a number."
  (setf (inventory-room inventory) +room-of-object+
        (inventory-holder inventory) object
        (inventory-field inventory) nil)
  (typecase object
    (cons (survey (car object) 0 inventory)
     (survey (cdr object) 0 inventory))
    (array (survey-array object inventory))
    (hash-table (maphash (lambda (key value)
                           (survey key 0 inventory)
                           (survey value 0 inventory))
                         object))
    (dice)
    (agenda (dolist (event (pending-events object)) (survey event 0 inventory)))
    (t (survey-fields object inventory))))

(defun survey-all (inventory)
  "Look at all that INVENTORY has met and not yet looked at, and at what is met there."
  (loop while (inventory-waiting inventory)
        do (dolist (object (reverse (shiftf (inventory-waiting inventory) '())))
             (survey-contents object inventory))))

(defun batches-in-order (inventory)
  (loop for shape in (reverse (inventory-shapes inventory))
        collect (gethash shape (inventory-batches inventory))))

(defun give-numbers (inventory)
  "Number what is in INVENTORY: first what is beside the run, then each batch."
  (let ((number 0) (states (inventory-states inventory)))
    (setf (inventory-outer inventory) (reverse (inventory-outer inventory)))
    (loop for (object) in (inventory-outer inventory)
          do (setf (gethash object states) (incf number)))
    (dolist (batch (batches-in-order inventory))
      (loop for object across (batch-members batch)
            do (setf (gethash object states) (incf number))))))

(defun take-inventory (simulation requests)
  "Return the inventory of SIMULATION and of REQUESTS, a list of those that wait to be taken. The
first batch is SIMULATION alone. Signals MISUSE."
  (let ((inventory (make-inventory)))
    (setf (inventory-holder inventory) simulation)
    (survey simulation 0 inventory)
    (dolist (request requests) (survey request 0 inventory))
    (survey-all inventory)
    (give-numbers inventory)
    inventory))

(defun inventory-size (inventory)
  (+ (length (inventory-outer inventory))
     (loop for batch in (batches-in-order inventory) sum (length (batch-members batch)))))

(defun number-of (object inventory)
  "Return the number of OBJECT in INVENTORY, or NIL if it has none."
  (let ((state (gethash object (inventory-states inventory))))
    (and (integerp state) state)))
