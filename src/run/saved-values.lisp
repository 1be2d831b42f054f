;;;; saved-values.lisp -- writing the objects of an inventory as lines of text.

(in-package :ars-magna.run)

;;; The first lines define the numbers, in order:
;;;
;;;   (found map "ARS-WORLDS::OFFICE")           an external object, by its name
;;;   (new object 31 |...::THING| ("NAME" ...))  how many objects of a shape there are, and the
;;;   (new array 2 |...::T| (75) nil)            slots whose values follow
;;;
;;; Then comes at least one line for each new object: its number and its contents. The contents of
;;; an array are a repeat count, an element, and so on.

(defun write-elements (list inventory out &optional (beginning #\Space))
  "Write the elements of LIST up to its end or to a cons that has a number. Write BEGINNING before
the first element and a space before each other element."
  (loop for tail = list then (cdr tail)
        for separator = beginning then #\Space
        while (and (consp tail)
                   (or (eq tail list) (null (object-number tail inventory))))
        do (write-char separator out)
           (write-value (car tail) inventory out)
        finally (when tail
                  (write-string " . " out)
                  (write-value tail inventory out))))

(defun write-value (value inventory out)
  "Write VALUE to OUT. If VALUE has a number in INVENTORY, write the number instead."
  (let ((number (and (not (typep value '(or symbol fixnum))) (object-number value inventory))))
    (cond (number (format out "@~D" number))
          ((consp value) (write-elements value inventory out #\()
           (write-char #\) out))
          (t (write-datum value out)))))

;;; Lines.

(defun element-count (array)
  (if (array-has-fill-pointer-p array) (fill-pointer array) (array-total-size array)))

(defun write-repeated-elements (array start inventory out)
  "Write the number of equal elements of ARRAY from START on, and their value. Return their end."
  (let* ((element (row-major-aref array start))
         (end (or (loop for index from (1+ start) below (element-count array)
                        unless (eql element (row-major-aref array index)) return index)
                  (element-count array))))
    (format out " ~D " (- end start))
    (write-value element inventory out)
    end))

(defun write-array-part (array start inventory out)
  "Write the elements of ARRAY from START on that fit into a line. Return the end index."
  (cond ((stringp array)
         (let ((end (min (length array) (+ start (* 10 +most-elements-in-line+)))))
           (write-char #\Space out)
           (write-quoted (subseq array start end) #\" out)
           end))
        (t (loop repeat +most-elements-in-line+
                 while (< start (element-count array))
                 do (setf start (write-repeated-elements array start inventory out)))
           start)))

(defun object-contents (object fields)
  "OBJECT is neither an array nor a cons. Return its contents as a list for LOADER-VALUES."
  (typecase object
    (dice (list (dice-state object)))
    (agenda (cons (agenda-tick object) (pending-events object)))
    (hash-table (let ((values '()))
                  (maphash (lambda (key value) (setf values (list* value key values))) object)
                  (nreverse values)))
    (t (loop for field in fields collect (funcall (kind-slot-reader field) object)))))

(defun write-values-line (values inventory out)
  "Write the first elements of VALUES, as many as fit into a line. Return the others."
  (loop repeat +most-elements-in-line+
        while values
        do (write-char #\Space out)
           (write-value (pop values) inventory out))
  values)

(defun write-object-line (object more inventory out)
  "Write the next line for OBJECT to OUT. MORE are the values that are left to write, or an index if
OBJECT is an array. Return what is left after this line, in the same form, or NIL."
  (typecase object
    (cons (write-elements object inventory out) nil)
    (array (let ((end (write-array-part object more inventory out)))
             (and (< end (element-count object)) end)))
    (t (write-values-line more inventory out))))

(defun write-object-lines (object fields inventory seal)
  "Call SEAL with each line for the contents of OBJECT. For a structure, FIELDS are its slots."
  (let ((more (typecase object
                (cons nil)
                (array 0)
                (t (object-contents object fields)))))
    (loop do (funcall seal (with-output-to-string (out)
                             (format out "(@~D" (object-number object inventory))
                             (setf more (write-object-line object more inventory out))
                             (write-char #\) out)))
          while more)))

(defun field-names (fields)
  (mapcar (lambda (field) (symbol-name (kind-slot-name field))) fields))

(defun batch-line (batch)
  "Return the line that defines the numbers of the objects in BATCH: their count and shape."
  (destructuring-bind (kind . more) (batch-shape batch)
    (datum-text `(:new ,kind ,(length (batch-members batch)) ,@more
                       ,@(and (eq :object kind) (list (field-names (batch-fields batch))))))))

(defun write-inventory-lines (inventory seal)
  "Call the function SEAL with each line of the text of INVENTORY, a string."
  (loop for (nil . name) in (inventory-external-objects inventory)
        do (funcall seal (datum-text (cons :found name))))
  (let ((batches (batches-in-order inventory)))
    (dolist (batch batches) (funcall seal (batch-line batch)))
    (funcall seal (datum-text (list :objects (inventory-size inventory))))
    (with-plain-syntax
      (dolist (batch batches)
        (loop for object across (batch-members batch)
              do (write-object-lines object (batch-fields batch) inventory seal))))))
