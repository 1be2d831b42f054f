;;;; place-types.lisp -- kinds of places, as users define them (manual 5.1.1).

(in-package :ars-magna.world)

(export '(place-type-index *place-types* place make-place define-place-type))

;;; A match form is a list of rows of entries: NIL or - for empty, T or * for a wall, x or ?()
;;; for either, compared by name. The cell in question is in the centre (manual 5.1.1).
;;;
;;; What surrounds a cell is coded in nine bits, a column at a time from the left and each
;;; column from the top, so that moving one cell to the right is a shift by three.

(deftype neighbourhood-code () '(unsigned-byte 9))

(defstruct (rule (:constructor make-rule (form direction dx dy)) (:copier nil))
  "A rule of a place type: if the walls around a cell are as in FORM, the cell at the offset DX, DY
is a place that faces DIRECTION."
  (form '() :type list :read-only t)
  (direction 0d0 :type double-float :read-only t)
  (dx 0 :type fixnum :read-only t)
  (dy 0 :type fixnum :read-only t))

(defun parse-match-entry (entry)
  "Return T, NIL or :ANY for ENTRY of a match form, or :BAD if ENTRY is invalid (reading 75)."
  (cond ((matchvar-p entry) :any)
        ((not (symbolp entry)) :bad)
        ((or (null entry) (same-name-p entry "-")) nil)
        ((or (same-name-p entry "T") (same-name-p entry "*")) t)
        ((same-name-p entry "X") :any)
        (t :bad)))

(defun parse-match-form (form definition)
  "Return the match form FORM with entries T, NIL and :ANY. Signals MALFORMED-DEFINITION."
  (flet ((reject (expected) (reject-clause definition form expected)))
    (unless (and (proper-list-p form) form (every #'consp form) (every #'proper-list-p form))
      (reject "a match form: a list of rows, each a list of entries"))
    (unless (and (oddp (length form)) (oddp (length (first form)))
                 (apply #'= (mapcar #'length form)))
      (reject "an odd number of rows, all of the same odd length"))
    (let ((rows (loop for row in form collect (mapcar #'parse-match-entry row))))
      (dolist (row rows rows)
        (when (member :bad row)
          (reject "entries NIL or - (empty), T or * (wall), x or ?() (either)"))))))

(defun match-form-size (form)
  (values (length (first form)) (length form)))

(defun small-match-form-p (form)
  "True if FORM, a match form, concerns only a cell and its neighbours."
  (multiple-value-bind (width height) (match-form-size form)
    (and (<= width 3) (<= height 3))))

(defun match-form-bits (form)
  "Return a mask and a value: FORM matches the neighbourhoods whose masked code is the value."
  (let ((mask 0) (value 0))
    (multiple-value-bind (width height) (match-form-size form)
      (loop for row in form for dy from (- (floor height 2))
            do (loop for entry in row for dx from (- (floor width 2))
                     for bit = (ash 1 (+ (* 3 (- 1 dx)) (- 1 dy)))
                     unless (eq entry :any)
                       do (setf mask (logior mask bit))
                          (when entry (setf value (logior value bit))))))
    (values mask value)))

(defun rules-table (rules)
  "Return a vector with an element for each neighbourhood code: the number, from 1, of the first
rule in RULES that fits the code, or 0. No match form in RULES is larger than 3 by 3."
  (let ((table (make-octets 512)))
    (loop for rule in (reverse rules) for number downfrom (length rules)
          do (multiple-value-bind (mask value) (match-form-bits (rule-form rule))
               (dotimes (code 512)
                 (when (= value (logand code mask))
                   (setf (aref table code) number)))))
    table))

(defun form-matches-p (form map x y)
  "True if the walls around the cell X, Y of MAP are as in FORM, a match form of any size."
  (multiple-value-bind (width height) (match-form-size form)
    (loop for row in form for cy from (- y (floor height 2))
          always (loop for entry in row for cx from (- x (floor width 2))
                       always (or (eq entry :any)
                                  (eq entry (filled-cell-at-p map cx cy)))))))

;;; Place types rank by when they were first defined, unless they say :BEFORE: a cell that could
;;; be of several is of the first. Redefining a type keeps its rank and changes the type itself:
;;; probability, directions and drawing hold at once, which cells are of it holds for maps built
;;; later and for those rebuilt with REBUILD-MAP. Manual 5.1.1.

(addition place-type-p)
(define-record (place-type (:constructor %make-place-type (name)))
  "A typical structure of walls, such as a doorway, that the robot can sense and align with."
  (name nil symbol "the symbol that names the place type" :writable :addition)
  (confusion 0d0 (double-float 0d0 1d0)
             "the probability of a false designator in a search for the type" :writable :addition)
  (invisible-p nil boolean "no designator can be acquired for the place type" :writable :addition)
  (rules '() list :writable)
  (table nil (or null octets) :writable)
  (checker nil (or null function) :writable)
  (directions nil (or null function) :writable)
  (graphics nil (or null function) "the function (window x y) that draws the place type, or NIL; can
be set. X and Y are the upper left corner of the cell in pixels" :writable :addition)
  (key 0 integer :writable))

(defmethod print-object ((type place-type) stream)
  (print-named type stream (place-type-name type)
               (format nil "PLACE-TYPE ~A" (place-type-name type))))

(define-registry place-type "place type" :object-p place-type-p)

(addition place-type-rank)
(defun place-type-rank (type)
  "Return the rank of the place type: 0 for the type that wins over all others; NIL if undefined."
  (position type (registry-objects *place-types*) :test #'eq))

(defun place-type-index (map type)
  "Return the number of TYPE in MAP-PLACES of MAP, or NIL if MAP was built before TYPE was defined."
  (position type (map-place-types map) :test #'eq))

;;; Places.

(addition place-p)
(define-record (place (:constructor make-place (type canonical-dir cell)))
  "A cell that is a place: its PLACE-TYPE, its basic canonical direction in radians, and the cell."
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
  "Return PLACE's two canonical directions in radians: the values of its type's :directions form, or
its basic direction and the opposite. Errors in the form are queued as messages (reading 72)."
  (let* ((basic (place-canonical-dir place))
         (type (place-type place))
         (function (place-type-directions type))
         (origin (list "the :directions of place type " (place-type-name type))))
    (multiple-value-bind (one other)
        (and function (call-user-code function origin (place-cell place)))
      (cond ((and (sane-number-p one) (sane-number-p other))
             (values (double one) (double other)))
            (t (when (and function (or one other))
                 (apply #'error-set (append origin (list " are not two angles at "
                                                         (place-cell place)))))
               (values basic (+ basic pi)))))))

;;; The form is checked when it is expanded, the values of its options when it is evaluated; then
;;; its code is tried on small maps.

(defun check-place-type-options (definition name lambda-list options)
  (check-name definition name "place type")
  (unless (and (consp lambda-list) (null (cdr lambda-list))
               (first lambda-list) (symbolp (first lambda-list)))
    (reject-clause definition lambda-list "a list of one variable, to be bound to the cell"))
  (check-options definition options
                 '(:confusion :check-matchers :checker :directions :invisible :graphics :before
                   :documentation))
  (when (eq (null (getf options :check-matchers)) (null (getf options :checker)))
    (reject-clause definition options "either :check-matchers or :checker, but not both")))

(defun checked-direction (definition matcher direction)
  (unless (sane-number-p direction)
    (reject-clause definition matcher (argument-type-text 'angle)))
  (when (perhaps-degrees-p direction)
    (queue-notable-warning definition ": " (degrees-advice direction)))
  (double direction))

(defun matcher-form (matcher definition)
  (unless (and (proper-list-p matcher) (<= 2 (length matcher) 4)
               (loop for step in (cddr matcher) always (typep step '(signed-byte 16))))
    (reject-clause
     definition matcher
     "(match-form direction), or (match-form direction dx dy) for a cell beside the place"))
  (destructuring-bind (form direction &optional (dx 0) (dy 0)) matcher
    `(make-rule ',(parse-match-form form definition)
                (checked-direction ,definition ',matcher ,direction) ,dx ,dy)))

;; As reading 76 says.
(defun graphics-form (graphics definition)
  (when graphics
    (unless (and (proper-list-p graphics) (proper-list-p (first graphics))
                 (= 3 (length (first graphics))) (every #'symbolp (first graphics)))
      (reject-clause definition graphics "((window x y) body...), three variables and a body"))
    `(lambda ,(first graphics) (declare (ignorable ,@(first graphics))) ,@(rest graphics))))

(defun place-type-forms (name lambda-list options)
  (let ((definition (definition-title "def-place-type" name)))
    (check-place-type-options definition name lambda-list options)
    (destructuring-bind (&key confusion check-matchers checker directions invisible graphics before
                           &allow-other-keys)
        options
      (flet ((cell-function (form)
               (and form `(lambda ,lambda-list (declare (ignorable ,@lambda-list)) ,form))))
        (unless (proper-list-p check-matchers)
          (reject-clause definition check-matchers "a list of (match-form direction)"))
        `((define-place-type ',name
            :confusion ,(or confusion 0) :invisible ,invisible
            :rules (list ,@(loop for matcher in check-matchers
                                 collect (matcher-form matcher definition)))
            :checker ,(cell-function checker)
            :directions ,(cell-function directions)
            :graphics ,(graphics-form graphics definition)
            :before ',before
            :key ,(digest-value (digest-add (make-digest) (cons name options)))))))))

(public def-place-type)
(define-user-macro def-place-type (&whole form name (&rest lambda-list) &body options
                          &environment environment)
  "Define the place type NAME (manual 5.1.1). LAMBDA-LIST is (CELL); options, in any order:
  :confusion p -- probability of a false designator in a search for the type; default 0
  :check-matchers ((match-form direction)...) -- wall patterns centred on the place
    :checker form -- or a form that returns four values: true if there is a place; integers dx and
    dy, the offset of the place from CELL; and the basic canonical direction of the place. CELL is
    the same object in each call, a cursor that moves over the map
  :directions form -- a form that returns two values, radians; by default the basic direction and
    its opposite
  :invisible true -- no designator can be acquired for places of the type
  :graphics ((window x y) body...) -- a body that draws a place of the type (manual B.1)
  :before name -- an addition: where a cell fits two types, this type wins over the type NAME, or
    over all others if NAME is T; without :before, a type that was defined earlier wins
  :documentation text -- an addition: what the place type is
A matcher may also have two integers dx and dy after the direction, the offset of the place (an
addition). The code of :checker and :directions is tried once on a small separate map. Call
REBUILD-MAP to find places of the type in maps built earlier. Signals MALFORMED-DEFINITION. Return
the name."
  (expand-definition form environment
                     (lambda () (place-type-forms name lambda-list options))))

(defun type-to-precede (definition before)
  (cond ((null before) nil)
        ((eq before t) (first (registry-objects *place-types*)))
        ((find-place-type before nil))
        (t (reject-clause definition (list :before before)
                          (format nil "T or the name of a place type: ~{~(~A~)~^, ~}"
                                  (defined-names *place-types*))))))

(defun define-place-type (name &key (confusion 0) invisible rules checker directions graphics
                                 before (key 0))
  "Define the place type NAME for DEF-PLACE-TYPE. CHECKER and DIRECTIONS are functions of a cell.
KEY is a digest of the definition, for a map's cache key. Return NAME."
  (let* ((definition (definition-title "def-place-type" name))
         (old (definition-to-replace name *place-types*))
         (next (type-to-precede definition before))
         (new (%make-place-type name)))
    (checked-probability definition :confusion confusion)
    (when (> (length rules) 255)
      (reject-clause definition (list :check-matchers '|...|) "at most 255 matchers"))
    (when (and (null old) (= (length (registry-objects *place-types*)) 255))
      (reject-clause definition name "at most 255 place types"))
    (setf (place-type-confusion new) (double confusion)
          (place-type-invisible-p new) (and invisible t)
          (place-type-rules new) rules
          (place-type-table new) (and rules
                                      (every #'small-match-form-p (mapcar #'rule-form rules))
                                      (rules-table rules))
          (place-type-checker new) checker
          (place-type-directions new) directions
          (place-type-graphics new) graphics
          (place-type-key new) key)
    (try-place-type new)
    (register *place-types* name (if old (overwrite-object old new) new)
              :before (and (not (eq next old)) next))
    (warn-of-useless-rules definition (find-place-type name))
    name))

(define-facts (place-type type)
  "Rank" (place-type-rank type)
  "Recognized by" (if (place-type-checker type)
                      "a checker"
                      (format nil "~R matcher~:P" (length (place-type-rules type))))
  "Chance that a search finds a false place" (place-type-confusion type)
  "Can be designated" (if (place-type-invisible-p type) "no" "yes"))
