;;;; world.lisp -- maps: walls, clauses and their errors, lines through the grid.

(in-package :ars-magna.tests)

(def-suite* world :in ars-magna)

;;; After a test that defines other place types, the shipped ones are restored.

(defun call-with-own-definitions (function)
  "Call FUNCTION; what it defines (maps, place types, attributes ...) is forgotten afterwards."
  (let ((base:*message-queue* (base:make-message-queue)))
    (base:call-with-own-definitions function)))

(defmacro with-own-definitions (&body body)
  `(call-with-own-definitions (lambda () ,@body)))

(defmacro with-only ((registry &rest names) &body body)
  "Run BODY where REGISTRY knows what is called NAMES, forms, and nothing else."
  `(base:with-own-definitions ()
     (definitions::set-entries
      ,registry
      (remove-if-not (lambda (definition)
                       (member (base:entry-name definition) (list ,@names)
                               :test #'base:same-name-p))
                     (definitions::registry-entries ,registry)))
     ,@body))

(defun map-of (width height &rest clauses)
  "Return a map with CLAUSES of walls."
  (eval `(world:defmap test-map (,width ,height) ,@clauses))
  (world:find-map 'test-map))

(defun wall-picture (map)
  "Return the walls of MAP as a list of strings."
  (loop for y below (world:map-height map)
        collect (coerce (loop for x below (world:map-width map)
                              collect (if (world:wall-at-p map x y) #\* #\-))
                        'string)))

(defun parameter-at (map x y) (world:cell-substance-parameter (world:map-cell map x y)))
(defun substance-at (map x y) (world:cell-substance-type (world:map-cell map x y)))

(defun complaint-about (form)
  "Return the text of the MALFORMED-DEFINITION that evaluating FORM signals, or NIL."
  (handler-case (with-own-definitions (eval form) nil)
    (base:malformed-definition (condition) (princ-to-string condition))))

(defun warnings-of (function)
  "Call FUNCTION; return the texts of the warnings about definitions that it signals."
  (let ((texts '()))
    (handler-bind ((base:definition-warning
                     (lambda (warning)
                       (push (princ-to-string warning) texts)
                       (muffle-warning warning))))
      (funcall function))
    (nreverse texts)))

(defun message-texts ()
  (mapcar #'base:message-text (base:take-messages)))

;;; Walls.

(test wall.is-bresenham-with-both-ends
  (with-own-definitions
    (is (equal '("*-----" "-**---" "---**-" "-----*")
               (wall-picture (map-of 6 4 '(wall (0 0) (5 3) bricks 1)))))
    (is (equal '("-----" "-*---" "-----")
               (wall-picture (map-of 5 3 '(wall (1 1) (1.9 1.5) bricks 1)))))))

(test wall.parameter-is-linear-in-steps
  (with-own-definitions
    (let ((map (map-of 9 3 '(wall (0 1) (8 1) slate 10 30))))
      (loop for x to 8
            do (is (= (+ 10 (* 2.5 x)) (parameter-at map x 1))))
      (is (base:same-name-p 'slate (substance-at map 3 1)))
      (is (null (substance-at map 3 0)))
      (is (= 0 (parameter-at map 3 0)))
      (is (= 10 (world:map-least-parameter map)))
      (is (= 30 (world:map-greatest-parameter map))))))

(test rect.is-an-outline-clamped-into-the-map
  "Manual 5.1: big-room's rect, whose corner lies outside, is its room."
  (with-own-definitions
    (let ((map (map-of 5 4 '(rect (0 0) (5 4) bricks 0 10 30 25))))
      (is (equal '("*****" "*---*" "*---*" "*****") (wall-picture map)))
      (is (equalp '(0 10 30 25)
                  (list (parameter-at map 0 0) (parameter-at map 4 0)
                        (parameter-at map 4 3) (parameter-at map 0 3))))
      (is (= 5 (parameter-at map 2 0)))
      (is (< 10 (parameter-at map 4 1) (parameter-at map 4 2) 30))
      (is (< 0 (parameter-at map 0 1) (parameter-at map 0 2) 25)))))

(test circle.is-a-closed-symmetric-outline
  (with-own-definitions
    (is (equal '("---------" "---***---" "--*---*--" "-*-----*-" "-*-----*-" "-*-----*-"
                 "--*---*--" "---***---" "---------")
               (wall-picture (map-of 9 9 '(circle (4 4) 3 bricks 7)))))
    (let ((map (map-of 9 9 '(circle (4.5 4.2) 0 bricks 7))))
      (is (= 1 (count 1 (world:map-flags map))))
      (is (= 7 (parameter-at map 4 4))))))

(test clauses.later-ones-overwrite
  (with-own-definitions
    (let ((map (map-of 5 5 '(wall (0 2) (4 2) bricks 1) '(wall (2 0) (2 4) slate 9))))
      (is (= 9 (parameter-at map 2 2)))
      (is (base:same-name-p 'slate (substance-at map 2 2)))
      (is (= 1 (parameter-at map 1 2))))))

(test map.is-solid-outside
  (with-own-definitions
    (let ((map (map-of 3 3)))
      (is (not (world:wall-at-p map 0 0)))
      (is (not (world:wall-at-p map 2.999 2.999)))
      (loop for (x y) in '((-0.001 1) (1 -5) (3 1) (1 3) (1e20 1))
            do (is (world:wall-at-p map x y))
               (is (null (world:map-index map x y))))
      (is (= 0 (parameter-at map -1 7))))))

(test occupancy-window.is-centred
  (with-own-definitions
    (let ((map (map-of 4 4 '(wall (2 1) (2 1) bricks 1))))
      (is (equal '((nil nil nil) (nil nil t) (nil nil nil))
                 (world:cell-occupancy-window (world:map-cell map 1.5 1.5) 3 3)))
      (is (equal '((t t t t t) (t t nil nil nil) (t t nil nil t))
                 (world:cell-occupancy-window (world:map-cell map 0 0) 5 3))))))

(test defmap.binds-and-registers
  (with-own-definitions
    (eval '(world:defmap test-place (4 5)))
    (let ((first (symbol-value 'test-place)))
      (is (eq first (world:find-map "test-place")))
      (is (eq first (world:find-map :test-place)))
      (eval '(world:defmap test-place (4 5) (wall (0 0) (1 1) bricks 1)))
      (is (not (eq first (world:find-map 'test-place))))
      (is (= 1 (count 'test-place (world:all-maps) :key #'world:map-name))))
    (signals base:unknown-name (world:find-map 'no-such-map))))

;;; Malformed clauses.

(test defmap.rejects-malformed-clauses
  "The complaint shows the clause and what was expected."
  (loop for (clause . expected)
          in '(((wall (0 0) (1 1)) . "(wall (x0 y0)")
               ((wall (0 0) (1 1) bricks) . "parameter")
               ((wall (0 0) (1 1) bricks 1 2 3) . "(wall (x0 y0)")
               ((wall (0 0) 1 bricks 1) . "(wall (x0 y0)")
               ((wall (0 a) (1 1) bricks 1) . "numbers")
               ((wall (0 0) (1 1) "bricks" 1) . "substance")
               ((rect (0 0) (1 1) bricks 1 2) . "(rect (x0 y0)")
               ((rect (0 0) (1 1) bricks 1 2 3 4 5) . "[three more]")
               ((circle (0 0) bricks 1) . "(circle (x y)")
               ((circle (0 0) -1 bricks 1) . "radius not below 0")
               ((circle (0 0) 1 bricks 1 2) . "(circle (x y)")
               ((door (0 0)) . "wall, rect, circle or obj")
               (17 . "wall, rect, circle or obj")
               ((wall . 3) . "without a dot")
               ((obj lamp) . "(obj name (x y) descriptor")
               ((obj lamp (1 2)) . "(obj name (x y) descriptor")
               ((obj lamp 1 ()) . "a position")
               ((obj lamp (4 1) ()) . "from 0 to below 4 and 4")
               ((obj lamp (-1 1) ()) . "in the map")
               ((obj "lamp" (1 1) ()) . "a name")
               ((obj (lamp :proto box) (1 1) ()) . ":prototype")
               ((obj (lamp :prototype) (1 1) ()) . "pairs")
               ((obj (lamp :kickers jump) (1 1) ()) . ":kickers (name ...)")
               ((obj (lamp :kickers (no-such-kicker)) (1 1) ()) . "no kicker called")
               ((obj (lamp :prototype 3) (1 1) ()) . "made by NEW-THING")
               ((obj lamp (1 1) (:size 2)) . "object descriptor")
               ((obj lamp (1 1) ((:size 2) (:size 3))) . "each attribute once")
               ((obj lamp (1 1) ((:size red))) . "a number")
               ((obj lamp (1 1) ((:size -1))) . "not below 0")
               ((obj lamp (1 1) ((:color purple))) . "red, green, blue")
               ((obj lamp (1 1) ((:obsview 7))) . "one of")
               ((obj lamp (1 1) ((:substance "wood"))) . "substance's name")
               ((obj lamp (1 1) () pen) . "contents: (name descriptor")
               ((obj lamp (1 1) () (pen)) . "contents: (name descriptor")
               ((obj lamp (1 1) () (pen ((:size big)))) . "a number"))
        for complaint = (complaint-about `(world:defmap test-map (4 4) ,clause))
        do (is (and complaint (search expected complaint)) "~S: ~A" clause complaint)
           (is (search "defmap test-map" complaint))))

(test defmap.rejects-malformed-heads
  (loop for (form . expected)
          in '(((world:defmap "room" (4 4)) . "a symbol")
               ((world:defmap nil (4 4)) . "a symbol")
               ((world:defmap test-map 4) . "(width height)")
               ((world:defmap test-map (4)) . "(width height)")
               ((world:defmap test-map (4 0)) . "integers from 1")
               ((world:defmap test-map (4 5.5)) . "integers from 1")
               ((world:defmap test-map (4 4 :cash "x")) . ":cache")
               ((world:defmap test-map (4 4 :cache)) . "pairs")
               ((world:defmap test-map (4 4 :cache 7)) . "a file"))
        for complaint = (complaint-about form)
        do (is (and complaint (search expected complaint)) "~S: ~A" form complaint)))

(test defmap.shows-the-clause
  (is (search "(wall (0 0) 1 bricks 1)"
              (complaint-about '(world:defmap test-map (4 4) (wall (0 0) 1 bricks 1))))))

;;; Lines through the grid.

(defun cells-on-line (x y dx dy &rest arguments)
  "Return what is met by the line from (X,Y) in a grid of 4 by 3: lists (index distance column)."
  (let ((met '()))
    (values (apply #'world:walk-cells-on-line
                   (lambda (index at column)
                     (push (list index at column) met)
                     nil)
                   4 3 x y dx dy arguments)
            (reverse met))))

(test walk-grid.goes-by-cells-to-the-edge
  (is (equalp '(3.5d0 ((5 0.5d0 t) (6 1.5d0 t) (7 2.5d0 t)))
              (multiple-value-list (cells-on-line 0.5d0 1.5d0 1d0 0d0 10))))
  (is (equalp '(1d0 ((5 0d0 nil) (1 0.5d0 nil)))
              (multiple-value-list (cells-on-line 1.5d0 2d0 0d0 -2d0 10))))
  (is (equalp '(1.5d0 ((5 0.5d0 t)))
              (multiple-value-list (cells-on-line 0.5d0 1.5d0 1d0 0d0 1)))))

(test walk-grid.goes-through-a-corner-by-a-neighbour
  (flet ((first-cell (&rest arguments)
           (first (first (nth-value 1 (apply #'cells-on-line 0.5d0 0.5d0 1d0 1d0 arguments))))))
    (is (= 4 (first-cell 10)) "the next row")
    (is (= 1 (first-cell 10 t)) "the next column")))
