;;;; manual-5-1-1.lisp -- Place types (manual 5.1.1).

(in-package :ars-test-manual-5)
(in-readtable :nisp)

(def-suite* manual-5-1-1 :in ars-magna)

(defun places (map)
  "Return the places of MAP, row by row, each as (name x y basic-direction)."
  (loop for y below (map-height map)
        append (loop for x below (map-width map)
                     for place = (cell-type (map-cell map x y))
                     when place
                       collect (list (string (place-type-name (place-type place))) x y
                                     (place-canonical-dir place)))))

(defun places-called (name &rest rows)
  "Return the places called NAME, as (x y basic-direction), of the map that ROWS show."
  (loop for (called . rest) in (places (apply #'picture-map rows))
        when (same-name-p name called) collect rest))

(defun directions (map x y)
  "Return the two canonical directions of the place at (X Y) of MAP."
  (multiple-value-list (place-directions (cell-type (map-cell map x y)))))

(defun define-niche (matchers &rest options)
  "Define the place type NICHE by MATCHERS, before all others, with OPTIONS."
  (eval `(def-place-type niche (cell) :check-matchers ,matchers :before t ,@options)))

(defun niches (&rest rows) (apply #'places-called 'niche rows))

(defun all-near (expected numbers)
  (and (= (length expected) (length numbers))
       (every (lambda (a b) (near a b 1d-6)) expected numbers)))

;;; Match forms.

(test manual-5-1-1.match-forms-are-pictures
  "5.1.1: nil is empty, t is wall, ?() is either; the cell in the middle becomes the place."
  (define-niche '((((?() t   ?())
                    (t   nil t)
                    (?() nil ?())) 1)))
  (is (equal '((3 1 1d0)) (niches "--***--" "--*-*--" "-------")))
  (is (equal '((3 1 1d0)) (niches "---*---" "--*-*--" "--*-*--")) "what is ?() does not matter")
  (is (null (niches "-------" "-------" "--*-*--" "-------")) "a wall is missing")
  (is (null (niches "--***--" "--*-*--" "--***--")) "a wall is too much"))

(test manual-5-1-1.match-forms-may-be-abbreviated
  "5.1.1, reading 75: -, * and x are nil, t and ?(), and the two may be mixed."
  (let ((rows '("--***--" "--*-*--" "--*----" "--*-*--" "--***--")))
    (define-niche '((((?() t ?()) (t nil t) (?() nil ?())) 1)))
    (let ((in-full (apply #'niches rows)))
      (is (equal '((3 1 1d0)) in-full))
      (define-niche '((((x * x) (* - *) (x - x)) 1)))
      (is (equal in-full (apply #'niches rows)))
      (define-niche '((((X t x) (* nil *) (?() - x)) 1)))
      (is (equal in-full (apply #'niches rows))))))

(test manual-5-1-1.match-forms-have-any-odd-size
  "5.1.1: a matrix is as wide and high as it says, centred on the cell."
  (define-niche '((((* - - - *)) 0)))
  (is (equal '((3 1 0d0)) (niches "-------" "-*---*-" "-------")))
  (define-niche '((((-)) 0)))
  (is (equal '((0 0 0d0) (1 1 0d0)) (niches "-*" "*-")))
  (define-niche '((((- - -) (- * -) (- - -)) 0)))
  (is (null (niches "---" "-*-" "---")) "reading 71: a place is an empty cell"))

(test manual-5-1-1.cells-beyond-the-map-match-walls
  "5.1.1, reading 53: outside of the map is wall."
  (define-niche '((((* * *) (* - -) (* - -)) 0)))
  (is (equal '((0 0 0d0)) (niches "---" "---" "---"))))

(test manual-5-1-1.each-form-has-its-direction
  "5.1.1: DIRECTION, which is evaluated, is the basic canonical direction of what its form matches."
  (define-niche '((((* - -)) (/ pi 4)) (((- - *)) (* pi 3/4))))
  (is (equalp `((2 0 ,(/ pi 4)) (5 0 ,(* pi 3/4))) (niches "-*----*-"))))

;;; Directions.

(test manual-5-1-1.directions-are-two-values-of-the-cell
  "5.1.1: the two canonical directions are the values of :directions, with the cell bound and its
basic direction in !>cell.type.canonical-dir."
  (define-niche '((((* - -)) 1)) :directions '(values !>cell.type.canonical-dir
                                                      (- (cell-x cell) 10)))
  (is-true (all-near '(1 -8) (directions (picture-map "-*---") 2 0))))

(test manual-5-1-1.directions-by-default-are-opposite
  "5.1.1, reading 72: without :directions they are the basic direction and the one behind."
  (define-niche '((((* - -)) 1)))
  (is-true (all-near (list 1 (+ 1 pi)) (directions (picture-map "-*---") 2 0))))

(test manual-5-1-1.defaults
  "5.1.1, reading 72: :confusion is 0, :invisible false, :graphics none."
  (define-niche '((((* - -)) 1)))
  (let ((niche (find-place-type 'niche)))
    (is (equal '(0d0 nil nil) (list (place-type-confusion niche) (place-type-invisible-p niche)
                                    (place-type-graphics niche))))))

;;; Checkers.

(defun define-niche-by (checker)
  (eval `(def-place-type niche (cell) :checker ,checker :before t)))

(test manual-5-1-1.checkers-return-four-values
  "5.1.1: whether there is a place, where it is relative to the cell (any cell may be asked), and
its basic canonical direction."
  (define-niche-by '(if !>cell.filled?
                        (values t 1 -2 1.5)
                        (values #f 0 0 0)))
  (is (equal '((3 1 1.5d0)) (niches "------" "------" "------" "--*---")))
  (define-niche-by '(values #f 0 0 0))
  (is (null (niches "------" "--*---"))))

(test manual-5-1-1.checkers-are-asked-of-every-cell
  "5.1.1: CELL is bound to each cell of the map, filled or empty."
  (define-niche-by '(if !>cell.filled? (values #f 0 0 0) (values t 0 0 (+ (cell-x cell) 0.5))))
  (is (equal '((0 0 0.5d0) (2 0 2.5d0) (0 1 0.5d0) (1 1 1.5d0) (2 1 2.5d0)) (niches "-*-" "---"))))

(test manual-5-1-1.checkers-name-empty-cells-of-the-map
  "5.1.1, reading 71: a checker that names a filled cell, or one outside of the map, is not heeded."
  (define-niche-by '(if !>cell.filled? (values t 2 0 0) (values #f 0 0 0)))
  (is (equal '((7 0 0d0)) (niches "-*-*-*--*-"))))

(test manual-5-1-1.occupancy-windows-show-the-cells-around
  "5.1.1: (cell-occupancy-window cell width height) is a matrix, centred on the cell, of t for a
wall and nil for an empty cell; beyond the map is wall (reading 53)."
  (let ((map (picture-map "*----" "-**--" "----*")))
    (flet ((window (x y width height)
             (cell-occupancy-window (map-cell map x y) width height)))
      (is-true (matchq ((t nil nil) (nil t t) (nil nil nil)) (window 1 1 3 3)))
      (is-true (matchq ((nil t t nil nil)) (window 2 1 5 1)))
      (is-true (matchq ((nil) (nil) (t)) (window 4 1 1 3)))
      (is-true (matchq ((t t t) (t t nil) (t nil t)) (window 0 0 3 3)))
      (is-false (matchq ((t nil nil) (nil t t) (nil nil t)) (window 1 1 3 3))))))

(test manual-5-1-1.checkers-may-match-windows
  "5.1.1: a corner told by a checker with MATCHQ is found where the same told by a match form is."
  (let ((rows '("------" "-***--" "-*-*--" "-*----" "---**-" "------")))
    (define-niche-by '(let ((window (cell-occupancy-window cell 3 3)))
                        (if (matchq ((nil nil nil) (nil t t) (nil t ?())) window)
                            (values t -1 -1 (* 3/2 pi))
                            (values #f 0 0 0))))
    (let ((found (apply #'niches rows)))
      (is (equal `((0 0 ,(* 3/2 pi))) found))
      (define-niche '((((nil nil nil) (nil t t) (nil t ?())) (* 3/2 pi) -1 -1)))
      (is (equal found (apply #'niches rows))))))

(test manual-5-1-1.one-way-of-telling-is-needed
  "5.1.1: a type has :check-matchers or a :checker."
  (is (equal '(t t nil)
             (mapcar (lambda (complaint) (and complaint t))
                     (complaints '(def-place-type niche (cell) :confusion 0)
                                 '(def-place-type niche (cell) :check-matchers ((((-)) 0))
                                   :checker (values nil 0 0 0))
                                 '(def-place-type niche (cell) :check-matchers ((((-)) 0))))))))

;;; Which type, and since when.

(test manual-5-1-1.the-type-defined-first-wins
  "5.1.1, reading 70: a cell is of one type: of those that match, that which was first defined."
  (eval '(def-place-type niche (cell) :check-matchers ((((- - -) (* - *) (- - -)) 1))))
  (flet ((type-there ()
           (place-type-name (place-type (cell-type (map-cell (picture-map "-------" "-------"
                                                                          "--*-*--" "-------"
                                                                          "-------")
                                                             3 2))))))
    (is (eq 'doorway (type-there)))
    (undefine 'place-type 'doorway)
    (is (eq 'niche (type-there)))
    (define-niche '((((* - *)) 1)))
    (is (eq 'niche (type-there)))))

(test manual-5-1-1.types-hold-for-maps-built-later
  "5.1.1, reading 70: a map that there is keeps its places until it is built again."
  (let ((map (picture-map "-*---")))
    (define-niche '((((* - -)) 1)))
    (is (null (places map)))
    (is (equal '(("NICHE" 2 0 1d0)) (places (rebuild-map map))))
    (is (equal '((2 0 1d0)) (niches "-*---")))))

;;; What robots make of them.

(defmap cloister (14 11)
  (rect (0 0) (13 10) bricks 10)
  (wall (6 1) (6 4) slate 20)
  (wall (6 6) (6 9) slate 20))

(defrobot monk (cloister (2.5 5.5) 0) :cameras ((6.28 100)))

(defun define-alcove (&rest options)
  "Define a place type for the opening in the cloister's wall, with two directions of its own."
  (eval `(def-place-type alcove (cell)
           :check-matchers ((((* ) (-) (*)) .5))
           :directions (values .5 (+ .5 (/ pi 2))) :before t ,@options))
  (rebuild-map cloister))

(defun sought (type &key all)
  "Return what a search of MONK for places of TYPE ends with: code and finding."
  (let ((answer (answer (if all
                            'camera-get-all-place-designators
                            'camera-get-place-designator)
                        (robot-camera monk 0) type)))
    (list (first answer) (third answer))))

(test manual-5-1-1.own-types-are-sensed-and-found
  "5.1.1: a user's place type is sensed by ROBOT-PLACE, found by cameras, and aligned with: the
nearest canonical direction counts."
  (define-alcove)
  (with-simulation (monk :clean t)
    (destructuring-bind (code designator) (sought 'alcove)
      (is (null code))
      (is (equal '(:non-local alcove) (list !>designator.type (first !>designator.data))))
      (is (near 0 !>designator.angle 1d-6)))
    ;; Differences count round the circle (reading 73), angles are not reduced (reading 50).
    (loop for (heading aligned) in `((0 .5) (1 .5) (2 ,(+ .5 (/ pi 2))) (-1 .5)
                                     (7 ,(+ .5 2pi)) (-5.5 ,(- .5 2pi)))
          do (place-robot monk 6.5 5.5 heading)
             (is (equal '(nil alcove) (let ((answer (call-once 'robot-place monk)))
                                        (list (first answer) (third answer)))))
             (is (null (end-code 'robot-align-place monk)))
             (is (near aligned (robot-angle monk) 1d-6)))))

(test manual-5-1-1.invisible-types-are-not-designated
  "5.1.1: of a type that is :invisible no designators can be acquired; it is sensed all the same."
  (define-alcove :invisible t)
  (with-simulation (monk :clean t)
    (is (equal '(:invisible-place-type nil) (sought 'alcove)))
    (is (eq :invisible-place-type (first (sought 'alcove :all t))))
    (place-robot monk 6.5 5.5 0)
    (is (eq 'alcove (third (call-once 'robot-place monk))))))

(defun false-finds (confusion trials)
  "Return how many of TRIALS searches for a type with CONFUSION, of which there is no place, find
one."
  (eval `(def-place-type mirage (cell) :check-matchers ((((* - * - * - *)) 0))
           :confusion ,confusion))
  (with-simulation (monk :seed 5)
    (loop repeat trials
          count (second (sought 'mirage)))))

(test manual-5-1-1.confusion-is-the-chance-of-a-false-designator
  "5.1.1, reading 74: in a search for the type, one false designator is found with probability
:confusion, wherever there is no such place at all; by default never, and never in a clean world."
  (is (= 0 (false-finds 0 60)))
  (is-true (frequent-p (false-finds .3 400) 400 .3))
  (is (= 60 (false-finds 1 60)))
  (with-simulation (monk :clean t)
    (is (equal '(:designator-not-found nil) (sought 'mirage)))))

;;; The built-in types.

(defun basic-directions (type rows-and-directions)
  "True if in each of ROWS-AND-DIRECTIONS, lists (direction row...), the only TYPE has the
direction."
  (loop for (direction . rows) in rows-and-directions
        for found = (apply #'places-called type rows)
        always (and (= 1 (length found)) (near direction (third (first found)) 1d-6))))

(test manual-5-1-1.doorways-are-narrow-openings
  "5.1.1: a doorway has a wall on either side and the way is free, in two straight and, reading 66,
two oblique ways, its direction leading through; the other direction is opposite."
  (is-true (basic-directions
            'doorway `((,(/ pi 2)     "-----" "-----" "-*-*-" "-----" "-----")
                       (0             "-----" "--*--" "-----" "--*--" "-----")
                       (,(* 3/4 pi)   "-----" "-*---" "-----" "---*-" "-----")
                       (,(/ pi 4)     "-----" "---*-" "-----" "-*---" "-----"))))
  (is-true (all-near (list (/ pi 2) (* 3/2 pi))
                     (directions (picture-map "-----" "-----" "-*-*-" "-----" "-----") 2 2))))

(test manual-5-1-1.convex-corners-are-outside-of-walls
  "5.1.1: the empty cell at the outside of a corner of two walls, which faces away from both."
  (let ((map (picture-map "------" "------" "-***--" "---*--" "---*--" "------")))
    (is (equal '(("CONVEX" 4 1 0d0)) (remove "CONVEX" (places map) :key #'first :test #'string/=)))
    (is-true (all-near (list 0 (/ pi -2)) (directions map 4 1))))
  (is (= 4 (length (places-called 'convex "------" "------" "--**--" "--**--" "------" "------")))))

(test manual-5-1-1.concave-corners-are-inside-of-walls
  "5.1.1, reading 67: an empty cell with walls on two perpendicular sides, which faces away from
both: each corner of a room, and nothing else in it."
  (let ((map (picture-map "*****" "*---*" "*---*" "*---*" "*****")))
    (is (equal '((1 1) (3 1) (1 3) (3 3))
               (loop for (name x y) in (places map)
                     when (string= name "CONCAVE") collect (list x y))))
    (is-true (all-near (list 0 (/ pi 2)) (directions map 1 1)))))

(test manual-5-1-1.beaks-are-before-ends-of-thin-walls
  "5.1.1, reading 67: the cell before the tip of a wall, whose basic direction leads away from it."
  (is (equalp `((4 2 0d0) (0 2 ,pi))
              (sort (places-called 'beak "------" "------" "-***--" "------" "------")
                    #'> :key #'first)))
  (is-true (all-near (list 0 pi)
                     (directions (picture-map "------" "------" "-***--" "------" "------") 4 2))))
