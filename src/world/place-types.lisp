;;;; place-types.lisp -- kinds of places, as users define them.

(in-package :ars-magna.world)

(export '(place-type-index *place-types*))

;;; Place types rank by when they were first defined, unless they say :BEFORE: a cell that could
;;; be of several is of the first. Redefining a type keeps its rank and changes the type itself:
;;; probability, directions and drawing hold at once, which cells are of it holds for maps built
;;; later and for those rebuilt with REBUILD-MAP. Manual 5.1.1.

(defstruct (place-type (:constructor %make-place-type (name)) (:copier nil))
  "A stereotypical bit of wall structure that the robot can sense and align with."
  (name nil :type symbol)
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
 place-type-confusion "Return the probability of a false designator in a search for the type."
 place-type-invisible-p "True if no designator can be acquired for the place type."
 place-type-graphics "Return the function (window x y) that draws the place type, or NIL; can
be set. X and Y are the upper left corner of the cell in pixels.")

(defmethod print-object ((type place-type) stream)
  (if (or *print-escape* *print-readably*)
      (print-unreadable-object (type stream) (format stream "PLACE-TYPE ~A" (place-type-name type)))
      (princ (place-type-name type) stream)))

(define-registry place-type "place type" :object-p place-type-p)

(addition place-type-rank)
(defun place-type-rank (type)
  "Return the rank of the place type: 0 for the type that wins over all others; NIL if undefined."
  (position type (registry-objects *place-types*) :test #'eq))

(defun place-type-index (map type)
  "Return the number that stands for TYPE in MAP-PLACES of MAP, or NIL if MAP was built before
TYPE was defined."
  (position type (map-place-types map) :test #'eq))
