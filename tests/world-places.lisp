;;;; world-places.lisp -- place types: matchers, checkers, the built-ins.

(in-package :ars-magna.tests)
(in-suite world)

(defun picture-map (&rest rows)
  "Return a map with the walls that ROWS, strings, show as *."
  (apply #'map-of (length (first rows)) (length rows)
         (loop for row in rows for y from 0
               append (loop for char across row for x from 0
                            when (char= char #\*)
                              collect `(wall (,x ,y) (,x ,y) bricks 1)))))

(defun places-of (map)
  "Return a list (name x y direction) for each place of MAP, row by row; names as strings."
  (loop for y below (world:map-height map)
        append (loop for x below (world:map-width map)
                     for place = (world:cell-type (world:map-cell map x y))
                     when place
                       collect (list (string (world:place-type-name (world:place-type place)))
                                     x y (world:place-canonical-dir place)))))

(defun places-called (name map)
  (remove name (places-of map) :key #'first :test #'string/=))

(defun place-at (map x y)
  (find-if (lambda (place) (and (= x (second place)) (= y (third place)))) (places-of map)))

(defun directions-at (map x y)
  (multiple-value-list (world:place-directions (world:cell-type (world:map-cell map x y)))))

(defun around (&rest rows)
  "Return a map with ROWS in the middle of open space."
  (let* ((width (+ 4 (length (first rows))))
         (empty (make-string width :initial-element #\-)))
    (apply #'picture-map (append (list empty empty)
                                 (loop for row in rows collect (format nil "--~A--" row))
                                 (list empty empty)))))

(test doorway.faces-through-the-opening
  "Manual 5.1.1, with the diagonal directions put right."
  (with-own-definitions
    (loop for (rows direction) in `((("---" "*-*" "---") ,(/ pi 2))
                                    (("-*-" "---" "-*-") 0d0)
                                    (("*--" "---" "--*") ,(* pi 3/4))
                                    (("--*" "---" "*--") ,(/ pi 4)))
          for map = (apply #'around rows)
          do (is (equal (list "DOORWAY" 3 3 direction) (place-at map 3 3)))
             (is (equalp (list direction (+ direction pi)) (directions-at map 3 3)))
             ;; A step along the direction, either way, stays clear of the walls.
             (loop for angle in (directions-at map 3 3)
                   do (is (not (world:wall-at-p map (+ 3.5 (cos angle)) (+ 3.5 (sin angle)))))))))

(test convex.is-outside-a-corner
  (with-own-definitions
    (loop for (rows x y direction other)
            in `((("---" "**-" "-*-") 4 2 0d0 ,(- (/ pi 2)))
                 (("-*-" "**-" "---") 4 4 ,(/ pi 2) 0d0)
                 (("---" "-**" "-*-") 2 2 ,(* 3/2 pi) ,pi)
                 (("-*-" "-**" "---") 2 4 ,pi ,(/ pi 2)))
          for map = (apply #'around rows)
          do (is (equal (list "CONVEX" x y direction) (place-at map x y)))
             (is (equalp (list direction other) (directions-at map x y))))))

(test concave.is-inside-a-corner
  (with-own-definitions
    (let ((map (map-of 7 7 '(rect (0 0) (7 7) bricks 1))))
      (is (equalp `(("CONCAVE" 1 1 0d0) ("CONCAVE" 5 1 ,(/ pi 2))
                    ("CONCAVE" 1 5 ,(* 3/2 pi)) ("CONCAVE" 5 5 ,pi))
                  (places-of map)))
      (is (equalp (list (/ pi 2) pi) (directions-at map 5 1))))
    (is (= 4 (length (places-called "CONCAVE" (map-of 9 9 '(wall (2 2) (6 6) bricks 1)))))
        "the map's own corners, none along an oblique wall")))

(test beak.is-before-the-end-of-a-thin-wall
  (with-own-definitions
    (is (equalp `(("BEAK" 5 1 ,(* 3/2 pi)) ("BEAK" 5 7 ,(/ pi 2)))
                (places-called "BEAK" (map-of 11 9 '(wall (5 2) (5 6) bricks 1)))))
    (is (equalp `(("BEAK" 1 4 ,pi) ("BEAK" 7 4 0d0))
                (places-called "BEAK" (map-of 9 9 '(wall (2 4) (6 4) bricks 1)))))
    (is (equalp `(("BEAK" 1 1 ,(* pi 5/4)) ("BEAK" 7 7 ,(/ pi 4)))
                (places-called "BEAK" (map-of 9 9 '(wall (2 2) (6 6) bricks 1)))))))

(test built-ins.face-open-space
  "Every canonical direction leads to an empty neighbour, but for the second of a beak, which
faces the end of the wall."
  (with-own-definitions
    (let ((map (map-of 40 40 '(rect (0 0) (40 40) bricks 1) '(wall (10 10) (10 30) bricks 1)
                       '(wall (10 20) (18 20) bricks 1) '(wall (20 20) (30 20) bricks 1)
                       '(rect (25 30) (30 35) bricks 1) '(wall (30 5) (35 10) bricks 1))))
      (is (equal '("BEAK" "CONCAVE" "CONVEX" "DOORWAY")
                 (sort (remove-duplicates (mapcar #'first (places-of map)) :test #'string=)
                       #'string<)))
      (loop for (name x y) in (places-of map)
            do (loop for angle in (directions-at map x y)
                     for clear in (if (string= name "BEAK") '(t nil) '(t t))
                     do (is (eq clear (not (world:wall-at-p map (+ x 0.5 (cos angle))
                                                            (+ y 0.5 (sin angle)))))
                            "~A at ~D ~D facing ~F" name x y angle))))))

;;; A user's own.

(test checker.and-matchers-agree
  "A type written as a checker finds what the same written as matchers finds."
  (with-own-definitions
    (eval '(world:def-place-type my-corner (cell)
            :confusion 1/10
            :checker (if (world:cell-filled? cell)
                         (let ((window (world:cell-occupancy-window cell 3 3)))
                           (cond ((nisp:matchq ((nil nil nil) (t t nil) (#.(nisp:make-matchvar nil)
                                                                         t nil))
                                               window)
                                  (values t 1 -1 0.0))
                                 (t (values nil 0 0 0))))
                         (values nil 0 0 0))))
    (eval '(world:def-place-type other-corner (cell)
            :check-matchers ((((- - -) (* * -) (x * -)) 0.0 1 -1))))
    (let ((map (map-of 30 30 '(rect (3 3) (20 20) bricks 1) '(rect (1 25) (8 28) bricks 1)
                       '(wall (12 0) (25 26) bricks 1))))
      (flet ((alone (name)
               (with-only (world::*place-types* name)
                 (mapcar #'rest (places-of (world:rebuild-map map))))))
        (is (= 2 (length (alone 'my-corner))))
        (is (equalp (alone 'my-corner) (alone 'other-corner)))))))

(test matchers.take-all-spellings-and-sizes
  (with-own-definitions
    (let ((map (around "*-*" "---" "***")))
      (flet ((found (form)
               (with-only (world::*place-types*)
                 (eval `(world:def-place-type spot (cell) :check-matchers ((,form 1))))
                 (mapcar #'rest (places-of (world:rebuild-map map))))))
        (is (equal '((3 3 1d0)) (found '((t nil t) (nil nil nil) (t t t)))))
        (is (equal '((3 3 1d0)) (found '((* - *) (- - -) (* * *)))))
        (is (equal '((3 3 1d0)) (found `((* - *) (,(nisp:make-matchvar nil) x x) (* * *)))))
        (is (equal '((3 3 1d0)) (found '((x x x x x) (x * - * x) (x - - - x) (x * * * x)
                                         (- - - - -)))))
        (is (equal '((3 3 1d0)) (found '((-) (-) (-) (*) (-)))) "a column of five rows")
        (is (null (found '((t)))) "walls are no places")))))

(defun wide-form (form)
  "Return the 3 x 3 match form FORM as one of 5 x 5, which is matched without a table."
  (append '((x x x x x)) (loop for row in form collect `(x ,@row x)) '((x x x x x))))

(test tables.agree-with-plain-matching
  (with-own-definitions
    (let ((dice (base:make-dice 7)))
      (dotimes (round 20)
        (let ((form (loop repeat 3 collect (loop repeat 3 collect
                                             (base:roll-element '(- * x x) dice))))
              (map (apply #'map-of 12 12
                          (loop repeat 60 collect `(wall #1=(,(base:roll-index 12 dice)
                                                             ,(base:roll-index 12 dice))
                                                         #1# bricks 1)))))
          (flet ((found (form)
                   (with-only (world::*place-types*)
                     (eval `(world:def-place-type spot (cell) :check-matchers ((,form 0))))
                     (places-of (world:rebuild-map map)))))
            (is (equal (found form) (found (wide-form form))) "~S" form)))))))

(test place-types.first-defined-wins-and-keeps-its-rank
  (with-own-definitions
    (eval '(world:def-place-type anywhere (cell) :check-matchers ((((-)) 2))))
    (eval '(world:def-place-type too-late (cell) :check-matchers ((((-)) 3))))
    (let ((map (map-of 5 5 '(rect (0 0) (5 5) bricks 1))))
      (is (equal "CONCAVE" (first (place-at map 1 1))))
      (is (equal "ANYWHERE" (first (place-at map 2 2))))
      (is (not (find "TOO-LATE" (places-of map) :key #'first :test #'string=)))
      (let ((type (world:find-place-type "anywhere")))
        (eval '(world:def-place-type anywhere (cell) :confusion 0.25
                :check-matchers ((((* - -)) 2))
                :directions (values 1 2)))
        (is (eq type (world:find-place-type 'anywhere)))
        (is (= 4 (world:place-type-rank type)))
        (is (= 0.25 (world:place-type-confusion type)))
        (is (equalp '(1d0 2d0) (directions-at map 2 2)) "directions hold at once")
        (is (equal "ANYWHERE" (first (place-at map 3 2))) "cells keep what they were")
        (world:rebuild-map map)
        (is (equal "TOO-LATE" (first (place-at map 3 2))))
        (is (equal "ANYWHERE" (first (place-at map 1 2))))))))

(test checker.targets-outside-or-filled-are-ignored
  (with-own-definitions
    (with-only (world::*place-types*)
      (eval '(world:def-place-type shifted (cell) :checker (values t -1 0 0)))
      (is (equal '((0 0 0d0) (0 1 0d0) (1 1 0d0))
                 (sort (mapcar #'rest (places-of (picture-map "-*-" "--*"))) #'<
                       :key (lambda (place) (+ (first place) (* 3 (second place))))))))))

(test place-type.options
  (with-own-definitions
    (eval '(world:def-place-type hidden (cell) :invisible t :check-matchers ((((-)) 0))
            :graphics ((win cx cy) (list win cx cy))))
    (let ((type (world:find-place-type 'hidden)))
      (is (world:place-type-invisible-p type))
      (is (equal '(w 1 2) (funcall (world:place-type-graphics type) 'w 1 2)))
      (is (= 0 (world:place-type-confusion type))))
    (is (not (world:place-type-invisible-p (world:find-place-type :doorway))))
    (is (null (world:find-place-type 'door nil)))
    (is (equalp '(.05 .03)
                (mapcar (lambda (name) (coerce (world:place-type-confusion
                                                (world:find-place-type name)) 'single-float))
                        '(doorway convex))))))

(defvar *trap* nil "Whether the directions of a place type fail.")

(test place-directions.survives-a-bad-form
  (with-own-definitions
    (eval '(world:def-place-type broken (cell) :check-matchers ((((-)) 1/2))
            :directions (if (eq 'trap *trap*) (error "out of order") (values 1 2))))
    (let ((map (map-of 3 3)) (*trap* 'trap))
      (is (equalp (list 0.5d0 (+ 0.5d0 pi)) (directions-at map 1 1)))
      (is (search "BROKEN" (first (message-texts)))))))

(test def-place-type.rejects-malformed-clauses
  (loop for (options . expected)
          in '((() . "either :check-matchers or :checker")
               ((:checker t :check-matchers ((((-)) 0))) . "not both")
               ((:checker t :confuse 1) . ":confusion")
               ((:checker t :confusion 2) . "a probability")
               ((:checker t :checker t) . "only once")
               ((:checker) . "pairs")
               ((:check-matchers 3) . "a list")
               ((:check-matchers ((((- -)) 0))) . "odd")
               ((:check-matchers ((((-) (- - -) (-)) 0))) . "odd length")
               ((:check-matchers ((((? - -)) 0))) . "entries")
               ((:check-matchers (((- - -) 0))) . "a match form")
               ((:check-matchers ((((-))))) . "(match-form direction)")
               ((:check-matchers ((((-)) 0 1))) . nil)
               ((:checker t :graphics ((win x) 1)) . "three variables"))
        for complaint = (complaint-about `(world:def-place-type test-type (cell) ,@options))
        do (if expected
               (is (and complaint (search expected complaint)) "~S: ~A" options complaint)
               (is (null complaint))))
  (is (search "a symbol" (complaint-about '(world:def-place-type "x" (cell) :checker t))))
  (is (search "one variable" (complaint-about '(world:def-place-type x () :checker t)))))

(test checker.trouble-is-the-definitions
  (with-own-definitions
    (is (search "def-place-type broken"
                (complaint-about '(world:def-place-type broken (cell)
                                   :checker (error "out of order")))))
    (is (search "four values"
                (complaint-about '(world:def-place-type broken (cell)
                                   :checker (values t 1 0.5 0)))))
    (is (null (world:find-place-type 'broken nil)))))

(test checker.that-breaks-later-spoils-no-map
  "A type whose code fails in a map is left out of that map, with a warning."
  (with-own-definitions
    (eval '(world:def-place-type broken (cell)
            :checker (when (eq 'test-map (world:map-name (world:cell-map cell)))
                       (error "out of order"))))
    (eval '(world:def-place-type anywhere (cell) :check-matchers ((((-)) 1))))
    (let ((warnings (warnings-of (lambda () (map-of 3 3)))))
      (is (= 1 (length warnings)))
      (is (search "BROKEN" (string-upcase (first warnings))))
      (is (equal "ANYWHERE" (first (place-at (world:find-map 'test-map) 1 1)))))))

;;; What can never be a place.

(defun definition-warning-of (form)
  "Return the text of the first warning about the definition FORM, or NIL."
  (handler-case (progn (eval form) nil)
    (base:definition-warning (warning) (base:definition-warning-text warning))))

(defun type-warning (matchers &rest options)
  "Return what is warned of in a place type with MATCHERS and OPTIONS, or NIL."
  (with-own-definitions
    (definition-warning-of `(world:def-place-type nook (cell)
                              :check-matchers ,matchers ,@options))))

(test place-types.a-form-whose-place-is-a-wall-is-warned-of
  (flet ((warned-p (matcher) (search "only free cells" (type-warning (list matcher)))))
    (is (warned-p '(((- - -) (- * -) (- - -)) 0)))
    (is (warned-p '(((- - -) (- - *) (- - -)) 0 1 0)))
    (is (warned-p '(((*)) 0)))
    (is (null (type-warning '((((- - -) (- * -) (- - -)) 0 1 0)))))
    (is (null (type-warning '((((- - -) (- * -) (- - -)) 0 2 0)))))
    (is (null (type-warning '((((x * x) (* x *) (x - x)) 0)))))))

(test place-types.one-of-which-all-is-taken-is-warned-of
  (let ((doorway '((((- - -) (* - *) (- - -)) 0))))
    (is (search "write :before doorway" (type-warning doorway)))
    (is (null (type-warning doorway :before 'doorway)))
    (is (null (type-warning (append doorway '((((* * *) (* - *) (* * *)) 0))))))
    (is (null (type-warning '((((x - -) (* - *) (- - -)) 0)))))))

(test place-types.the-shipped-ones-are-not-warned-of
  (with-own-definitions
    (dolist (type (world:all-place-types))
      (finishes (handler-bind ((warning #'error))
                  (world::warn-of-useless-rules "it" type))))))
