;;;; copying.lisp -- copies of a run's objects for another run; copies of users' arguments.

(in-package :ars-magna.copying)

(export '(copying copy-values copy-slots copy-argument))

;;; A COPIER walks from an object to all that can be reached, and records the copy of each. So two
;;; objects that refer to the same one also do so in the copies. It copies an object first and
;;; replaces the references in the copy later, from a work list. So lists and chains may be of any
;;; length. Slots of structures are known from their kinds, or else from their classes:
;;;
;;;   copied   lists, arrays, tables, structures, instances, conditions, closures with their cells;
;;;   fresh    the :LINKs of kinds, as in a new object;
;;;   shared   numbers, symbols, code, what DEFINE-SHARED-TYPES says, and :SHARED slots of kinds.

(declaim (inline forked))
(addition forked)
(defun forked (value copier)
  "Return the copy of VALUE in a fork. Methods of COPY-PLAN-VALUE call this function with their
second argument, COPIER. The copy may be incomplete until all methods have returned."
  (typecase value
    ((or number symbol character) value)
    (t (forked-object value copier))))

(defun forked-object (value copier)
  (declare #.*hot* (type copier copier))
  (multiple-value-bind (copy known-p) (gethash value (copier-table copier))
    (cond (known-p copy)
          ((copier-screen copier) (replace-or-copy value copier))
          (t (begin-copy value copier)))))

(defun replace-or-copy (value copier)
  "If the screen of COPIER, a function, replaces VALUE, return the replacement; else a copy."
  (multiple-value-bind (instead screened-p) (funcall (copier-screen copier) value)
    (if screened-p
        (record-copy value instead copier)
        (begin-copy value copier))))

(defmethod copy-plan-value ((value structure-object) fork)
  (copy-slots value fork))

(defun copy-slots (object copier &optional (copy-policy (copy-policy object)))
  "Return a copy, made by COPIER, of the structure OBJECT. Its slots will contain copies too."
  (declare #.*hot* (type copy-policy copy-policy))
  (let ((copy (record-copy object (copy-structure (the structure-object object)) copier)))
    (loop for (writer . initial) in (copy-policy-fresh copy-policy)
          do (funcall (the function writer) (funcall (the function initial)) copy))
    (unless (zerop (length (copy-policy-indices copy-policy)))
      (queue-references copy (copy-policy-indices copy-policy) copier))
    copy))

;;; Other objects.

(define-shared-types package pathname readtable class generic-function method method-combination)

(defmethod copy-plan-value ((value random-state) fork)
  (record-copy value (make-random-state value) fork))

(defmethod copy-plan-value ((value dice) fork)
  (record-copy value (copy-dice value) fork))

(defmethod copy-plan-value ((value condition) fork)
  (multiple-value-bind (copy indices) (copy-condition value)
    (queue-references (record-copy value copy fork) (coerce indices 'simple-vector) fork)))

(defmethod copy-plan-value ((value standard-object) fork)
  (let ((copy (record-copy value (allocate-instance (class-of value)) fork)))
    (dolist (slot (per-instance-slot-names (class-of value)))
      (when (slot-boundp value slot)
        (setf (slot-value copy slot) (slot-value value slot))))
    (queue-references copy nil fork)))

(defun duplicate-array (array)
  (if (typep array '(simple-array * (*)))
      (copy-seq array)
      (copy-array array)))

(defun copy-displaced (array copier)
  (multiple-value-bind (base offset) (array-displacement array)
    (record-copy array
                 (make-array (array-dimensions array)
                             :element-type (array-element-type array)
                             :adjustable (adjustable-array-p array)
                             :fill-pointer (and (array-has-fill-pointer-p array)
                                                (fill-pointer array))
                             :displaced-to (forked base copier)
                             :displaced-index-offset offset)
                 copier)))

(defun copy-by-method (value copier)
  "Return the replacement for VALUE that the caller has chosen, or else the value of
COPY-PLAN-VALUE. Errors of a user's method become CANNOT-FORK."
  (let ((decision (find-chosen-replacement value copier)))
    (flet ((blame (condition)
             (unless (typep condition 'ars-magna-error)
               (error 'cannot-fork :value value :place (value-location-text value copier)
                                   :trouble (brief-condition-text condition)))))
      (declare (dynamic-extent #'blame))
      (if decision
          (cdr decision)
          (handler-bind ((error #'blame))
            (copy-plan-value value copier))))))

(defun begin-copy (value copier)
  (declare #.*hot*)
  (flet ((note (copy) (queue-references (record-copy value copy copier) nil copier)))
    (declare (inline note))
    (typecase value
      (cons (note (cons (car value) (cdr value))))
      (hash-table (let ((copy (record-copy value (make-similar-table value) copier)))
                    (push (cons value copy) (copier-tables copier))
                    copy))
      (structure-object (let ((copy-policy (copy-policy value)))
                          (ecase (copy-policy-way copy-policy)
                            (:copy (copy-slots value copier copy-policy))
                            (:share value)
                            (:method (record-copy value (copy-by-method value copier) copier))
                            (:ask (chosen-replacement value copier)))))
      (function (if (closure-p value) (note (copy-closure value)) (copy-function value copier)))
      (simple-vector (if (zerop (length value)) value (note (copy-seq value))))
      (array (cond ((array-displacement value) (copy-displaced value copier))
                   ((eq t (array-element-type value)) (note (duplicate-array value)))
                   (t (record-copy value (duplicate-array value) copier))))
      (t (cond ((not (value-cell-p value)) (record-copy value (copy-by-method value copier) copier))
               ;; So an exit to it fails properly in a fork too.
               ((exit-cell-p value) value)
               (t (note (make-value-cell (cell-value value)))))))))

(defun copy-function (function copier)
  "Return FUNCTION, which is not a closure, or its replacement if its class is a user's."
  (cond ((typep function 'generic-function) (copy-plan-value function copier))
        ((typep function 'standard-object) (chosen-replacement function copier))
        (t function)))

;;; Replacing references in copies.

(defun replace-list-references (list copier)
  "LIST is a copied list. Replace its references by copies, up to a tail that was copied before."
  (declare #.*hot* (type copier copier))
  (loop
    (setf (car list) (forked (car list) copier))
    (let ((tail (cdr list)))
      (cond ((or (not (consp tail)) (nth-value 1 (gethash tail (copier-table copier))))
             (setf (cdr list) (forked tail copier))
             (return))
            (t (setf list (setf (cdr list)
                                (record-copy tail (cons (car tail) (cdr tail)) copier))))))))

(defun replace-references (copy indices copier)
  "Replace the references in COPY by copies. INDICES are slot numbers, or NIL if slots have none."
  (declare #.*hot* (type copier copier))
  (cond (indices
         (loop for index of-type (unsigned-byte 20) across (the simple-vector indices)
               do (let ((value (instance-slot copy index)))
                    (unless (typep value '(or null fixnum))
                      (setf (instance-slot copy index) (forked value copier))))))
        ((consp copy) (replace-list-references copy copier))
        ((simple-vector-p copy)
         (dotimes (index (length copy))
           (let ((value (svref copy index)))
             (unless (typep value '(or null fixnum))
               (setf (svref copy index) (forked value copier))))))
        ((functionp copy)
         (replace-closure-values copy (lambda (value) (forked value copier))))
        ((arrayp copy)
         (dotimes (index (array-total-size copy))
           (setf (row-major-aref copy index) (forked (row-major-aref copy index) copier))))
        ((value-cell-p copy) (setf (cell-value copy) (forked (cell-value copy) copier)))
        (t (dolist (slot (per-instance-slot-names (class-of copy)))
             (when (slot-boundp copy slot)
               (setf (slot-value copy slot) (forked (slot-value copy slot) copier)))))))

(defun replace-all-references (copier)
  (declare #.*hot* (type copier copier))
  (loop until (zerop (copier-fill copier))
        do (let ((fill (decf (copier-fill copier) 2)))
             (replace-references (setf (copier-holder copier) (svref (copier-work copier) fill))
                                 (svref (copier-work copier) (1+ fill))
                                 copier))))

;; A key must be complete before its hash value is known.
(defun fill-tables (tables copier)
  (let ((contents (loop for (table) in tables
                        do (setf (copier-holder copier) table)
                        collect (loop for key being the hash-keys of table using (hash-value value)
                                      collect (cons (forked key copier) (forked value copier))))))
    (replace-all-references copier)
    (loop for (nil . copy) in tables
          for pairs in contents
          do (loop for (key . value) in pairs
                   do (setf (gethash key copy) value)))))

(defun finish-copies (copier)
  (loop
    (replace-all-references copier)
    (let ((tables (shiftf (copier-tables copier) '())))
      (unless tables (return))
      (fill-tables tables copier))))

(defmacro copying ((copier) &body body)
  "Run BODY, which copies objects with COPIER. Then complete the copies. Return the value of BODY."
  (once-only (copier)
    `(progn
       (refresh-copy-policies)
       (prog1 (progn ,@body)
         (finish-copies ,copier)))))

;;; Plain values, outside of any run.

(defun copied-by-default-p (value)
  "True if VALUE is a list, array, table, closure or closed-over variable, or an instance of a
user's class that has no method of COPY-PLAN-VALUE."
  (typecase value
    ((or cons array hash-table) t)
    (condition nil)
    (function (and (closure-p value) (not (typep value 'standard-object))))
    (structure-object (and (null (kind-of value)) (eq :copy (copy-policy-way (copy-policy value)))))
    (standard-object (default-method-p value 'standard-object))
    (t (and (value-cell-p value) (not (exit-cell-p value))))))

(defun copy-values (list instead-of)
  "Return a deep copy of LIST. If two values share an object, their copies share the copy. An object
for which COPIED-BY-DEFAULT-P is false is replaced by the value of INSTEAD-OF, called with it."
  (if (every (lambda (value) (typep value '(or number symbol character))) list)
      list
      (with-copier (copier :screen (lambda (value)
                                     (if (copied-by-default-p value)
                                         (values nil nil)
                                         (values (funcall instead-of value) t))))
        (copying (copier) (forked list copier)))))

;;;; Users' arguments

(defconstant +longest-argument+ 100000 "The largest number of conses and elements in an argument.")
(defconstant +deepest-argument+ 200 "The largest nesting depth of an argument.")

(defun copy-lists (datum)
  "Return DATUM with its lists and vectors copied, so that the caller cannot modify them later. If
DATUM is circular, too long or too deep, return NIL and true."
  (let ((left +longest-argument+))
    (labels ((deeper (depth)
               (when (or (minusp (decf left)) (> depth +deepest-argument+))
                 (return-from copy-lists (values nil t))))
             (copy (datum depth)
               (typecase datum
                 (string (copy-seq datum))
                 (cons (loop with first = (list nil) with last = first
                             for tail = datum then (cdr tail)
                             while (consp tail)
                             do (deeper depth)
                                (setf last (setf (cdr last)
                                                 (list (copy (car tail) (1+ depth)))))
                             finally (setf (cdr last) tail)
                                     (return (rest first))))
                 (simple-vector (cl:map 'vector (lambda (element)
                                                  (deeper depth)
                                                  (copy element (1+ depth)))
                                        datum))
                 (t datum))))
      (copy datum 1))))

(defun copy-argument (operator name datum)
  "Return a copy of DATUM, the argument NAME of OPERATOR. Signals WRONG-ARGUMENT if DATUM is
circular, too long or too deep."
  (multiple-value-bind (copy endless-p) (copy-lists datum)
    (when endless-p
      (reject-argument operator name "what was given"
                       (format nil "proper lists of at most ~D elements, nested at most ~D deep"
                               +longest-argument+ +deepest-argument+)))
    copy))
