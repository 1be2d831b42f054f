;;;; places.lisp -- which cells are places: the classification of a map, and its readers.

(in-package :ars-magna.world)

;;; Types are tried in the order of their ranks, cells row by row; a cell stays what it first
;;; became. Only empty cells become places. Patterns no larger than 3 x 3 are looked up in a
;;; table by the code of the neighbourhood, see RULES-TABLE.

(deftype codes () '(simple-array (unsigned-byte 16) (*)))

(declaim (inline column-code))
(defun column-code (flags x y width height)
  "Return three bits: whether column X has a wall in the row above Y, in row Y, and in the next
row."
  (declare (type octets flags) (type (signed-byte 20) x y width height))
  (flet ((bit-at (y)
           (declare (type (signed-byte 20) y))
           (if (and (< -1 x width) (< -1 y height))
               (logand +wall+ (aref flags (the cell-index (+ x (* y width)))))
               1)))
    (declare (inline bit-at))
    (logior (ash (bit-at (1- y)) 2) (ash (bit-at y) 1) (bit-at (1+ y)))))

(defun neighbourhood-codes (map)
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
  "Make the cell X, Y of MAP a place of the type NUMBER, if free and not yet a place (reading 71)."
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

(defun place-type-definition-context (type)
  "Return a value for *DEFINITION*: the current definition of TYPE, or else a definition made from
the registry's entry of TYPE."
  (let ((operator "def-place-type")
        (entry (lookup-entry (place-type-name type) *place-types*)))
    (if (and *definition* (same-name-p operator (first (defining-form *definition*))))
        *definition*
        (make-defining (and entry (entry-source entry))
                       (list operator (place-type-name type))))))

(defun reject-type-option (type option expected)
  (let* ((*definition* (place-type-definition-context type))
         (rest (member option (defining-form *definition*))))
    (reject-clause (definition-title "def-place-type" (place-type-name type))
                   (if rest (subseq rest 0 2) option)
                   expected)))

(defun call-place-type-code (function cell type option)
  "Call FUNCTION, which runs the code of OPTION of TYPE for CELL. Report errors in the code as
mistakes in the definition of TYPE."
  (flet ((blame (condition)
           (reject-type-option
            type option
            (format nil "code that runs without an error; at ~A: ~A" cell
                    (string-right-trim "." (text-of-condition condition))))))
    (handler-case
        (handler-bind ((error (lambda (condition)
                                (unless (typep condition '(or malformed-definition
                                                           undefined-function unbound-variable))
                                  (blame condition)))))
          (funcall function))
      ;; There is room to report it once the stack is unwound.
      (storage-condition (condition) (blame condition)))))

(defun check-checker-values (type cell values)
  (destructuring-bind (dx dy direction) values
    (unless (and (typep dx '(signed-byte 16)) (typep dy '(signed-byte 16))
                 (sane-number-p direction))
      (reject-type-option type :checker
                          (format nil "four values at ~A: a boolean, two integers, a direction ~
                                       (the values after the first were~{ ~S~})"
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
                     (check-checker-values type cell (list dx dy direction))
                     (classify-cell map number (+ x dx) (+ y dy) (double direction))))))))
      (call-place-type-code #'classify cell type :checker))))

(defun classify-by-type (map type number codes)
  "Make places of TYPE, the type with NUMBER, of the cells of MAP that fit and are not places yet."
  (cond ((place-type-checker type) (classify-by-checker map type number))
        ((place-type-table type) (classify-by-table map type number codes))
        (t (classify-by-forms map type number))))

(defun check-directions (map type number)
  "Signal MALFORMED-DEFINITION unless TYPE's :directions are two angles for its first place in MAP."
  (let ((index (position number (map-places map)))
        (function (place-type-directions type)))
    (when (and index function)
      (multiple-value-bind (y x) (floor index (map-width map))
        (let* ((cell (make-cell map x y))
               (directions (call-place-type-code
                            (lambda () (multiple-value-list (funcall function cell)))
                            cell type :directions)))
          (unless (and (= 2 (length directions)) (every #'sane-number-p directions))
            (reject-type-option type :directions
                                (format nil "two values at ~A, both angles in radians, not~{ ~S~}"
                                        cell directions))))))))

(defun clear-places (map)
  "Remove all places from MAP, and give MAP the current place types."
  (let ((size (* (map-width map) (map-height map))))
    (setf (map-places map) (make-octets size)
          (map-directions map) (make-double-vector size)
          (map-place-types map) (coerce (cons nil (registry-objects *place-types*))
                                        'simple-vector))))

(defun classify-places (map)
  "Find the places of MAP again. Leave out place types whose code fails, with a warning. Return MAP,
and true if no type was left out (reading 70)."
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

;;; A checker or :directions form that does not work would show only when a map is built, perhaps
;;; much later. So each is tried when it is defined: a checker on a sample of walls, the rules on
;;; maps made of their own match forms. What the code needs may be defined later in its file, so a
;;; missing function or variable is no error yet.

(defparameter *sample-map-rows*
  '("###########"
    "#.........#"
    "#.#.###.#.#"
    "#...#.....#"
    "#.###.###.#"
    "#.......#.#"
    "###.#####.#"
    "#.....#...#"
    "#.#.......#"
    "#...#..#..#"
    "###########")
  "The rows of a sample map with doorways, corners, posts and ends of walls.")

(defun small-map (width height filled-p)
  "Return a map with walls in the cells for which FILLED-P, a function of column and row, is true."
  (let ((map (%make-map :name 'sample :width width :height height)))
    (clear-grid map)
    (dotimes (y height)
      (dotimes (x width)
        (when (funcall filled-p x y)
          (setf (aref (map-flags map) (+ x (* y width))) +wall+))))
    (clear-places map)
    map))

(defun form-wall-p (form column row)
  "True if FORM, a match form, has a wall at COLUMN and ROW. The upper left corner is at 0, 0."
  (and (<= 0 column) (<= 0 row) (eq t (nth column (nth row form)))))

(defun make-rule-map (rule)
  "Return a small map with the walls in the match form of RULE, and free cells around them."
  (multiple-value-bind (width height) (match-form-size (rule-form rule))
    (let ((margin (1+ (max (abs (rule-dx rule)) (abs (rule-dy rule))))))
      (small-map (+ width (* 2 margin)) (+ height (* 2 margin))
                 (lambda (x y) (form-wall-p (rule-form rule) (- x margin) (- y margin)))))))

(defun try-place-type (type)
  (handler-case
      (mapc (lambda (map)
              (setf (map-place-types map) (vector nil type))
              (classify-by-type map type 1 (neighbourhood-codes map))
              (check-directions map type 1))
            (if (place-type-checker type)
                (list (small-map (length (first *sample-map-rows*)) (length *sample-map-rows*)
                                 (lambda (x y) (char= #\# (char (nth y *sample-map-rows*) x)))))
                (mapcar #'make-rule-map (place-type-rules type))))
    ((or undefined-function unbound-variable) () nil)))

;;; Warnings of match forms that can never make a place.

;;; A place is an empty cell, and has the type that was defined first. So a match form with a wall
;;; in its centre never applies, nor does a type all of whose forms fit only cells of earlier types.

(defun rule-needs-wall-p (rule)
  "True if the match form of RULE requires a wall in the cell that RULE makes a place."
  (multiple-value-bind (width height) (match-form-size (rule-form rule))
    (form-wall-p (rule-form rule)
                 (+ (rule-dx rule) (floor width 2))
                 (+ (rule-dy rule) (floor height 2)))))

(defun match-form-text (form)
  "Return the text of FORM, a match form, in the abbreviations of manual 5.1.1."
  (format nil "(~{(~{~A~^ ~})~^ ~})"
          (loop for row in form
                collect (loop for entry in row
                              collect (case entry ((t) "*") ((nil) "-") (t "x"))))))

(defun warn-of-rule-needing-wall (definition rule)
  (let ((dx (rule-dx rule)) (dy (rule-dy rule)))
    (warn-of-definition "~A: the match form ~A can never fit a place, because ~A is a wall, and ~
                         only free cells are places; write - there, or let a free cell beside it ~
                         be the place, and give its offset: (match-form direction dx dy)"
                        definition (match-form-text (rule-form rule))
                        (if (= 0 dx dy)
                            "its middle"
                            (format nil "the cell ~D ~D from its middle" dx dy)))))

;;; Cells of earlier types.

(defun codes-of-rule (rule)
  "Return the codes of a free cell's neighbourhoods that fit RULE, which is at most 3 by 3."
  (multiple-value-bind (mask value) (match-form-bits (rule-form rule))
    (loop for code below 512
          when (and (= value (logand code mask)) (not (logbitp 4 code))) collect code)))

(defun first-type-for-code (code types)
  "Return the first of TYPES that makes a cell with the neighbourhood CODE a place, or NIL."
  (find-if (lambda (type)
             (let ((number (if (place-type-table type) (aref (place-type-table type) code) 0)))
               (and (plusp number)
                    (let ((rule (nth (1- number) (place-type-rules type))))
                      (= 0 (rule-dx rule) (rule-dy rule))))))
           types))

(defun covering-types (rules types)
  "If each cell that fits RULES is a place of some type in TYPES, return these types; else NIL."
  (let ((takers '()))
    (dolist (rule rules takers)
      (unless (= 0 (rule-dx rule) (rule-dy rule)) (return '()))
      (dolist (code (codes-of-rule rule))
        (pushnew (or (first-type-for-code code types) (return-from covering-types '())) takers)))))

(defun warn-of-covered-type (definition type)
  "Warn if each cell that fits TYPE is a place of a type defined before TYPE."
  (let* ((types (registry-objects *place-types*))
         (rules (remove-if #'rule-needs-wall-p (place-type-rules type)))
         (takers (and (place-type-table type)
                      (covering-types rules (ldiff types (member type types))))))
    (when takers
      (warn-of-style "~A: all cells that fit are of the type ~{~(~A~)~^ or ~} already; the type ~
                      that was defined earlier wins; to let this type win, write :before ~(~A~)"
                        definition (mapcar #'place-type-name takers)
                        (place-type-name (find-if (lambda (other) (member other takers))
                                                  types))))))

(defun warn-of-useless-rules (definition type)
  (mapc (lambda (rule) (warn-of-rule-needing-wall definition rule))
        (remove-if-not #'rule-needs-wall-p (place-type-rules type)))
  (warn-of-covered-type definition type))
