;;;; match-forms.lisp -- patterns of walls around a cell, as DEF-PLACE-TYPE takes them.

(in-package :ars-magna.world)

;;; A match form is a list of rows of entries: NIL or - for empty, T or * for a wall, x or ?()
;;; for either, compared by name. The cell in question is in the centre (manual 5.1.1).
;;;
;;; What surrounds a cell is coded in nine bits, a column at a time from the left and each
;;; column from the top, so that moving one cell to the right is a shift by three.

(deftype neighbourhood-code () '(unsigned-byte 9))

(defstruct (rule (:constructor make-rule (form direction dx dy)) (:copier nil))
  "Where the walls are as in FORM around a cell, the cell DX, DY away is a place facing DIRECTION."
  (form '() :type list :read-only t)
  (direction 0d0 :type double-float :read-only t)
  (dx 0 :type fixnum :read-only t)
  (dy 0 :type fixnum :read-only t))

(defun normal-entry (entry)
  "Return T, NIL or :ANY for ENTRY of a match form, or :BAD (reading 75)."
  (cond ((matchvar-p entry) :any)
        ((not (symbolp entry)) :bad)
        ((or (null entry) (same-name-p entry "-")) nil)
        ((or (same-name-p entry "T") (same-name-p entry "*")) t)
        ((same-name-p entry "X") :any)
        (t :bad)))

(defun normal-form (form definition)
  "Return the match form FORM with entries T, NIL and :ANY. Signals MALFORMED-DEFINITION."
  (flet ((reject (expected) (reject-clause definition form expected)))
    (unless (and (proper-list-p form) form (every #'consp form) (every #'proper-list-p form))
      (reject "a match form: a list of rows, each a list of entries"))
    (unless (and (oddp (length form)) (oddp (length (first form)))
                 (apply #'= (mapcar #'length form)))
      (reject "rows of one length, an odd number of them, each of an odd length"))
    (let ((rows (loop for row in form collect (mapcar #'normal-entry row))))
      (dolist (row rows rows)
        (when (member :bad row)
          (reject "entries NIL or - (empty), T or * (wall), x or ?() (either)"))))))

(defun form-size (form)
  (values (length (first form)) (length form)))

(defun small-form-p (form)
  "True if FORM looks at a cell's neighbours at most."
  (multiple-value-bind (width height) (form-size form)
    (and (<= width 3) (<= height 3))))

(defun form-bits (form)
  "Return a mask and a value: FORM matches the neighbourhoods whose masked code is the value."
  (let ((mask 0) (value 0))
    (multiple-value-bind (width height) (form-size form)
      (loop for row in form for dy from (- (floor height 2))
            do (loop for entry in row for dx from (- (floor width 2))
                     for bit = (ash 1 (+ (* 3 (- 1 dx)) (- 1 dy)))
                     unless (eq entry :any)
                       do (setf mask (logior mask bit))
                          (when entry (setf value (logior value bit))))))
    (values mask value)))

(defun rules-table (rules)
  "Return a table that gives, for each neighbourhood code, the number (from 1) of the first of
RULES that matches it, or 0. All forms must be small."
  (let ((table (make-octets 512)))
    (loop for rule in (reverse rules) for number downfrom (length rules)
          do (multiple-value-bind (mask value) (form-bits (rule-form rule))
               (dotimes (code 512)
                 (when (= value (logand code mask))
                   (setf (aref table code) number)))))
    table))

(defun form-matches-p (form map x y)
  "True if the walls around the cell X, Y of MAP are as FORM, of any size, says."
  (multiple-value-bind (width height) (form-size form)
    (loop for row in form for cy from (- y (floor height 2))
          always (loop for entry in row for cx from (- x (floor width 2))
                       always (or (eq entry :any)
                                  (eq entry (filled-at-p map cx cy)))))))
