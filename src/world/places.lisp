;;;; places.lisp -- which cells are places: the classification of a map, and its readers.

(in-package :ars-magna.world)

(export '(place make-place))

;;; Types are tried in the order of their ranks, cells row by row; a cell stays what it first
;;; became. Only empty cells become places. Patterns no larger than 3 x 3 are looked up in a
;;; table by the code of the neighbourhood, see match-forms.lisp.

(deftype codes () '(simple-array (unsigned-byte 16) (*)))

(declaim (inline column-code))
(defun column-code (flags x y width height)
  "Return three bits: the walls at column X in the rows above, at and below Y."
  (declare (type octets flags) (type (signed-byte 20) x y width height))
  (flet ((bit-at (y)
           (declare (type (signed-byte 20) y))
           (if (and (< -1 x width) (< -1 y height))
               (logand +wall+ (aref flags (the cell-index (+ x (* y width)))))
               1)))
    (declare (inline bit-at))
    (logior (ash (bit-at (1- y)) 2) (ash (bit-at y) 1) (bit-at (1+ y)))))

(defun neighbourhood-codes (map)
  "Return the neighbourhood codes of all cells of MAP, by index."
  (declare #.*hot*)
  (let* ((width (map-width map)) (height (map-height map)) (flags (map-flags map))
         (codes (make-array (* width height) :element-type '(unsigned-byte 16)))
         (index 0))
    (declare (type cell-index index))
    (dotimes (y height codes)
      (let ((code (logior (ash (column-code flags -1 y width height) 3)
                          (column-code flags 0 y width height))))
        (declare (type neighbourhood-code code))
        (dotimes (x width)
          (setf code (logior (ldb (byte 9 0) (ash code 3))
                             (column-code flags (1+ x) y width height))
                (aref codes index) code
                index (1+ index)))))))

(declaim (inline classify-cell))
(defun classify-cell (map number x y direction)
  "Make the cell X, Y of MAP a place of the type NUMBER, unless it is one already, filled or
outside (reading 71)."
  (declare (type (signed-byte 20) x y) (type (unsigned-byte 8) number))
  (when (and (< -1 x (map-width map)) (< -1 y (map-height map)))
    (let ((index (+ x (* y (map-width map)))))
      (declare (type cell-index index))
      (when (and (zerop (aref (map-places map) index))
                 (not (logtest +wall+ (aref (map-flags map) index))))
        (setf (aref (map-places map) index) number
              (aref (map-directions map) index) direction)))))

(defun classify-by-table (map type number codes)
  (declare #.*hot* (type codes codes) (type (unsigned-byte 8) number))
  (let ((table (place-type-table type))
        (rules (coerce (the list (place-type-rules type)) 'simple-vector))
        (width (map-width map)) (index 0))
    (declare (type octets table) (type cell-index index))
    (dotimes (y (map-height map))
      (dotimes (x width)
        (let ((found (aref table (ldb (byte 9 0) (aref codes index)))))
          (incf index)
          (unless (zerop found)
            (let ((rule (svref rules (1- found))))
              (declare (type rule rule))
              (classify-cell map number
                             (+ x (the (signed-byte 16) (rule-dx rule)))
                             (+ y (the (signed-byte 16) (rule-dy rule)))
                             (rule-direction rule)))))))))

(defun classify-by-forms (map type number)
  (dotimes (y (map-height map))
    (dotimes (x (map-width map))
      (let ((rule (find-if (lambda (rule) (form-matches-p (rule-form rule) map x y))
                           (place-type-rules type))))
        (when rule
          (classify-cell map number (+ x (rule-dx rule)) (+ y (rule-dy rule))
                         (rule-direction rule)))))))

(defun definition-of (type)
  "Return the definition of TYPE, for *DEFINITION*: the one at hand, or else what is known of it."
  (let ((operator "def-place-type")
        (entry (lookup-entry (place-type-name type) *place-types*)))
    (if (and *definition* (same-name-p operator (first (defining-form *definition*))))
        *definition*
        (make-defining (and entry (entry-source entry))
                       (list operator (place-type-name type))))))

(defun blame-type (type option expected)
  "Signal MALFORMED-DEFINITION about OPTION of the definition of TYPE."
  (let* ((*definition* (definition-of type))
         (rest (member option (defining-form *definition*))))
    (reject-clause (title "def-place-type" (place-type-name type))
                   (if rest (subseq rest 0 2) option)
                   expected)))

(defun call-blaming-type (function cell type option)
  "Call FUNCTION, which runs the OPTION of TYPE for CELL, a cursor. Errors in it are TYPE's, and so
is exhausted storage, once the stack is unwound."
  (flet ((blame (condition)
           (blame-type type option (format nil "code that runs; at ~A: ~A" cell
                                           (string-right-trim "." (text-of-condition condition))))))
    (handler-case
        (handler-bind ((error (lambda (condition)
                                (unless (typep condition '(or malformed-definition
                                                           undefined-function unbound-variable))
                                  (blame condition)))))
          (funcall function))
      (storage-condition (condition) (blame condition)))))

(defun check-checked (type cell values)
  "Signal unless VALUES, which the checker of TYPE returned for CELL, say where a place is."
  (destructuring-bind (dx dy direction) values
    (unless (and (typep dx '(signed-byte 16)) (typep dy '(signed-byte 16))
                 (within-reason-p direction))
      (blame-type type :checker
                  (format nil "four values at ~A: a boolean, two integers, a direction (after the ~
                               first came~{ ~S~})"
                          cell values)))))

(defun classify-by-checker (map type number)
  (let ((cell (make-cell map 0 0)) (checker (place-type-checker type)))
    (declare (type function checker))
    (flet ((classify ()
             (dotimes (y (map-height map))
               (setf (cell-y cell) y)
               (dotimes (x (map-width map))
                 (setf (cell-x cell) x)
                 (multiple-value-bind (found dx dy direction) (funcall checker cell)
                   (when found
                     (check-checked type cell (list dx dy direction))
                     (classify-cell map number (+ x dx) (+ y dy) (double direction))))))))
      (call-blaming-type #'classify cell type :checker))))

(defun classify-by-type (map type number codes)
  "Make places of TYPE, which has NUMBER in MAP, of the cells of MAP that are none yet."
  (cond ((place-type-checker type) (classify-by-checker map type number))
        ((place-type-table type) (classify-by-table map type number codes))
        (t (classify-by-forms map type number))))

(defun check-directions (map type number)
  "Signal MALFORMED-DEFINITION unless the :directions of TYPE are two where it is first found."
  (let ((index (position number (map-places map)))
        (function (place-type-directions type)))
    (when (and index function)
      (multiple-value-bind (y x) (floor index (map-width map))
        (let* ((cell (make-cell map x y))
               (directions (call-blaming-type
                            (lambda () (multiple-value-list (funcall function cell)))
                            cell type :directions)))
          (unless (and (= 2 (length directions)) (every #'within-reason-p directions))
            (blame-type type :directions
                        (format nil "two values at ~A, both angles in radians, not~{ ~S~}"
                                cell directions))))))))

(defun clear-places (map)
  "Forget the places of MAP; number the place types known now."
  (let ((size (* (map-width map) (map-height map))))
    (setf (map-places map) (make-octets size)
          (map-directions map) (make-doubles size)
          (map-place-types map) (coerce (cons nil (registry-objects *place-types*))
                                        'simple-vector))))

(defun classify-places (map)
  "Find the places of MAP anew, by the place types known now. A type whose code fails is left out,
with a warning. Return MAP, and true if no type was left out. See reading 70."
  (clear-places map)
  (let ((codes (neighbourhood-codes map)) (whole t))
    (loop for type in (registry-objects *place-types*) for number from 1
          do (handler-case (progn (classify-by-type map type number codes)
                                  (check-directions map type number))
               (error (condition)
                 (setf whole nil)
                 (setf (map-places map) (nsubstitute 0 number (map-places map)))
                 (warn-of-definition "Map ~A has no places of type ~A: ~A"
                                     (map-name map) (place-type-name type) condition))))
    (values map whole)))

;;; Reading.

(addition place-p)
(define-record (place (:constructor make-place (type canonical-dir cell)))
  "A cell as a place: its PLACE-TYPE, basic canonical direction (radians) and the cell."
  (type nil place-type "the PLACE-TYPE that the place is of" :addition)
  (canonical-dir 0d0 double-float
                 "the place's basic canonical direction, radians (manual 5.1.1)" :addition)
  (cell nil cell "the cell that is the place" :addition))

(defmethod reference ((place place))
  (list :place (name-string (place-type-name (place-type place)))
        (cell-x (place-cell place)) (cell-y (place-cell place))))

(addition cell-type)
(defun cell-type (cell)
  "Return the PLACE that CELL is, or NIL (manual 5.1.1)."
  (let* ((map (cell-map cell))
         (index (cell-index-in-map cell))
         (number (if index (aref (map-places map) index) 0)))
    (unless (zerop number)
      (make-place (aref (map-place-types map) number)
                  (aref (map-directions map) index)
                  (make-cell map (cell-x cell) (cell-y cell))))))

(addition place-directions)
(defun place-directions (place)
  "Return the two canonical directions of PLACE, radians: what its type's :directions form says,
or its basic direction and the opposite. Trouble in the form is queued as an error
message (reading 72)."
  (let* ((basic (place-canonical-dir place))
         (type (place-type place))
         (function (place-type-directions type))
         (origin (list "the :directions of place type " (place-type-name type))))
    (multiple-value-bind (one other)
        (and function (call-user-code function origin (place-cell place)))
      (cond ((and (within-reason-p one) (within-reason-p other))
             (values (double one) (double other)))
            (t (when (and function (or one other))
                 (apply #'error-set (append origin (list " are not two angles at "
                                                         (place-cell place)))))
               (values basic (+ basic pi)))))))
