;;;; place-types.lisp -- kinds of places, as users define them.

(in-package :ars-magna.world)

(export '(place-type-index *place-types*))

;;; Place types rank by when they were first defined, unless they say :BEFORE: a cell that could
;;; be of several is of the first. Redefining a type keeps its rank and changes the type itself:
;;; probability, directions and drawing hold at once, which cells are of it holds for maps built
;;; later and for those rebuilt with REBUILD-MAP. Manual 5.1.1.

(addition place-type-p)
(define-record (place-type (:constructor %make-place-type (name)))
  "A stereotypical bit of wall structure that the robot can sense and align with."
  (name nil symbol "the symbol that the place type is called" :writable :addition)
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
  "Return the number that stands for TYPE in MAP-PLACES of MAP, or NIL if MAP was built before
TYPE was defined."
  (position type (map-place-types map) :test #'eq))
