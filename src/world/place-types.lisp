;;;; place-types.lisp -- kinds of places, as users define them.

(in-package :ars-magna.world)

;;; Place types rank by when they were first defined: a cell that could be of several is of
;;; the first. Redefining a type keeps its rank and changes the type itself: probability,
;;; directions and drawing hold at once, which cells are of it holds for maps built later and
;;; for those rebuilt with REBUILD-MAP. Manual 5.1.1.

(defstruct (place-type (:constructor %make-place-type (name rank)) (:copier nil))
  "A stereotypical bit of wall structure that the robot can sense and align with."
  (name nil :type symbol)
  (rank 0 :type (integer 0 254) :read-only t)
  (confusion 0d0 :type (double-float 0d0 1d0))
  (invisible-p nil :type boolean)
  (rules '() :type list)
  (table nil :type (or null octets))
  (checker nil :type (or null function))
  (directions nil :type (or null function))
  (graphics nil :type (or null function))
  (key 0 :type integer))

(addition place-type-p place-type-name place-type-confusion place-type-invisible-p
          place-type-graphics)
(document-functions
 place-type-p "True of a place type."
 place-type-name "Return the symbol that the place type is called."
 place-type-rank "Return the rank of the place type: 0 for the type that wins over all others."
 place-type-confusion "Return the probability of a false designator in a search for the type."
 place-type-invisible-p "True if no designator can be acquired for the place type."
 place-type-graphics "Return the function (window x y) that draws the place type, or NIL; can
be set. X and Y are the upper left corner of the cell in pixels.")

(defmethod print-object ((type place-type) stream)
  (if (or *print-escape* *print-readably*)
      (print-unreadable-object (type stream) (format stream "PLACE-TYPE ~A" (place-type-name type)))
      (princ (place-type-name type) stream)))

(defvar *place-types* '() "All place types, by rank.")

(addition all-place-types)
(defun all-place-types ()
  "Return a list of all place types, by rank."
  (copy-list *place-types*))

(addition find-place-type)
(defun find-place-type (name)
  "Return the place type called NAME, a symbol or string, or NIL. A place type is returned as
it is."
  (cond ((place-type-p name) name)
        ((typep name '(or symbol string))
         (find name *place-types* :key #'place-type-name :test #'same-name-p))))

(defun ensure-place-type (name)
  "Return the place type called NAME, made and ranked last if there is none."
  (or (find-place-type name)
      (let ((type (%make-place-type name (length *place-types*))))
        (setf *place-types* (append *place-types* (list type)))
        type)))

(defun place-type-index (map type)
  "Return the number that stands for TYPE in MAP-PLACES of MAP, or NIL if MAP was built before
TYPE was defined."
  (position type (map-place-types map) :test #'eq))

;;; Defining.

(defun check-place-type-options (definition name lambda-list options)
  (unless (and name (symbolp name) (not (keywordp name)))
    (reject-clause definition name "a symbol as the name of the place type"))
  (unless (and (consp lambda-list) (null (cdr lambda-list))
               (first lambda-list) (symbolp (first lambda-list)))
    (reject-clause definition lambda-list "a list of one variable, to be bound to the cell"))
  (check-options definition options
                 '(:confusion :check-matchers :checker :directions :invisible :graphics))
  (when (eq (null (getf options :check-matchers)) (null (getf options :checker)))
    (reject-clause definition options "either :check-matchers or :checker, one of them")))

(defun matcher-form (matcher definition)
  "Return a form that makes the rule for MATCHER, an element of :check-matchers."
  (unless (and (proper-list-p matcher) (<= 2 (length matcher) 4)
               (every #'integerp (cddr matcher)))
    (reject-clause definition matcher
                   "(match-form direction), or (match-form direction dx dy) for a place beside it"))
  (destructuring-bind (form direction &optional (dx 0) (dy 0)) matcher
    `(make-rule ',(normal-form form definition) (double ,direction) ,dx ,dy)))

(defun graphics-form (graphics definition)
  (when graphics
    (unless (and (proper-list-p graphics) (proper-list-p (first graphics))
                 (= 3 (length (first graphics))) (every #'symbolp (first graphics)))
      (reject-clause definition graphics "((window x y) body...), three variables and a body"))
    `(lambda ,(first graphics) (declare (ignorable ,@(first graphics))) ,@(rest graphics))))

(public def-place-type)
(defmacro def-place-type (name (&rest lambda-list) &rest options)
  "Define the place type NAME (manual 5.1.1). LAMBDA-LIST is (CELL); options, in any order:
  :confusion p -- probability of a false designator in a search for the type; default 0
  :check-matchers ((match-form direction)...) -- wall patterns centred on the place
  :checker form -- or a form of four values: true to classify, integers dx and dy to the place
    from CELL, its basic canonical direction; CELL is one cursor that moves over the map
  :directions form -- of two values, radians; default the basic direction and its opposite
  :invisible true -- no designator can be acquired for it
  :graphics ((window x y) body...) -- draws it (manual B.1).
A matcher may go on with integers dx dy, as a checker's values do: our addition. Maps built
earlier learn of it from REBUILD-MAP. Signals MALFORMED-DEFINITION. Return the name."
  (let ((definition (format nil "def-place-type ~(~A~)" name)))
    (check-place-type-options definition name lambda-list options)
    (destructuring-bind (&key confusion check-matchers checker directions invisible graphics)
        options
      (flet ((cell-function (form)
               (and form `(lambda ,lambda-list (declare (ignorable ,@lambda-list)) ,form))))
        (unless (proper-list-p check-matchers)
          (reject-clause definition check-matchers "a list of (match-form direction)"))
        `(define-place-type ',name
           :confusion ,(or confusion 0) :invisible ,invisible
           :rules (list ,@(loop for matcher in check-matchers
                                collect (matcher-form matcher definition)))
           :checker ,(cell-function checker)
           :directions ,(cell-function directions)
           :graphics ,(graphics-form graphics definition)
           :key ,(digest-value (digest-add (make-digest) (cons name options))))))))

(defun check-place-type (definition confusion rules)
  (unless (typep confusion '(real 0 1))
    (reject-clause definition (list :confusion confusion) "a probability from 0 to 1"))
  (when (> (length rules) 255)
    (reject-clause definition (list :check-matchers '|...|) "at most 255 matchers")))

(defun define-place-type (name &key (confusion 0) invisible rules checker directions graphics
                                 (key 0))
  "Define the place type NAME; what DEF-PLACE-TYPE expands to, with functions of a cell for
CHECKER and DIRECTIONS. KEY stands for the definition in the key of a map's cache. Return NAME."
  (let ((definition (format nil "def-place-type ~(~A~)" name)))
    (check-place-type definition confusion rules)
    (when (and (null (find-place-type name)) (= (length *place-types*) 255))
      (reject-clause definition name "at most 255 place types"))
    (let ((type (ensure-place-type name)))
      (setf (place-type-name type) name
            (place-type-confusion type) (double confusion)
            (place-type-invisible-p type) (and invisible t)
            (place-type-rules type) rules
            (place-type-table type) (and rules
                                         (every #'small-form-p (mapcar #'rule-form rules))
                                         (rules-table rules))
            (place-type-checker type) checker
            (place-type-directions type) directions
            (place-type-graphics type) graphics
            (place-type-key type) key)
      name)))
