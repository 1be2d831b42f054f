;;;; manual-5-1.lisp -- Maps (manual 5.1).

(in-package :ars-test-manual-5)
(in-readtable :nisp)

(def-suite* manual-5-1 :in ars-magna)

(defvar chest*
  (let ((chest (new-thing chest nil ((:capacity 9) (:size 8) (:weight 2) (:color blue)))))
    (new-thing coin chest ((:size .1) (:weight .1)))
    chest))

(defkicker fidget (thing) () (kick-thing thing .5 0 nil))

(defmap attic (16 12)
  (rect (0 0) (16 12) bricks 0 15 26 11)
  (wall (4 2) (4 8) slate 10 40)
  (wall (8 9) (12 9) wood 77)
  (obj lamp (2 3) ((:size 2) (:color LightRed)))
  (obj (crate :kickers (fidget)) (6.5 3.25) ((:capacity 1) (:size 6))
    (sack ((:size 50) (:capacity 5))
      (nut ((:size .3))))
    ((box :prototype chest*) ((:color red) (:weight 7))))
  (obj (trunk :prototype chest*) (7 6) ((:size 3) (:substance wood))
    (rope ((:size 1)))))

(defrobot usher (attic (6 6.5) 0) :cameras ((6.28 60)))

(test manual-5-1.defmap-makes-a-map-of-so-many-cells
  "5.1, reading 61: (defmap attic (16 12) ...) makes an object of type MAP, 16 by 12 cells in size,
the value of the variable ATTIC and known by that name."
  (is-true (typep attic 'map))
  (is (equal '(16 12) (list (map-width attic) (map-height attic))))
  (is (eq attic (find-map 'attic)))
  (is (= (* 16 12) (reduce #'+ (mapcar #'length (wall-picture attic))))))

(test manual-5-1.names-of-kinds-of-clauses-and-substances-are-names
  "5.1, reading 38: BRICKS and bricks, of whatever package, are the same."
  (is-true (same-name-p 'bricks (cell-substance-type (map-cell attic 0 5))))
  (is (eq (get-attribute (find-thing 'lamp attic) :color)
          (get-attribute (new-thing x nil ((:color ars:lightred))) :color))))

;;; wall

(test manual-5-1.wall-fills-a-straight-line-with-both-its-ends
  "5.1: a wall is the straight line of cells from (x0,y0) to (x1,y1), and nothing else."
  (is (equal '("------" "-****-" "----*-" "----*-")
             (wall-picture (map-of 6 4 '(wall (1 1) (4 1) bricks 1) '(wall (4 3) (4 1) wood 2)))))
  (is (equal '("---" "-*-" "---")
             (wall-picture (map-of 3 3 '(wall (1 1) (1 1) bricks 1))))))

(test manual-5-1.wall-that-is-oblique-is-digitized
  "5.1, reading 57: of an oblique line the nearest cell in each column, or row, is filled."
  (is (equal '("*----" "-**--" "---**")
             (wall-picture (map-of 5 3 '(wall (0 0) (4 2) bricks 1)))))
  (is (equal '("--*" "-*-" "-*-" "*--")
             (wall-picture (map-of 3 4 '(wall (2 0) (0 3) bricks 1))))))

(test manual-5-1.wall-of-one-parameter-has-it-everywhere
  "5.1: without param1 the parameter of all cells is param0; their substance is the wall's type."
  (is (equalp '(77 77 77 77 77) (walls attic 8 9 9 9 10 9 11 9 12 9)))
  (is-true (loop for x from 8 to 12
                 always (same-name-p 'wood (cell-substance-type (map-cell attic x 9))))))

(test manual-5-1.wall-of-two-parameters-goes-from-one-to-the-other
  "5.1: parameters are interpolated from param0 to param1, linearly, on oblique lines too."
  (is (equalp '(10 15 20 25 30 35 40) (walls attic 4 2 4 3 4 4 4 5 4 6 4 7 4 8)))
  (is (equalp '(8 4 0 -4) (walls (map-of 4 3 '(wall (0 0) (3 2) bricks 8 -4))
                                 0 0 1 1 2 1 3 2))))

(test manual-5-1.walls-of-later-clauses-cover-earlier-ones
  "5.1, reading 57: where two walls cross, the later clause counts."
  (let ((den (map-of 5 5 '(wall (0 2) (4 2) bricks 1) '(wall (2 0) (2 4) slate 9))))
    (is (equalp '(1 9 1) (walls den 1 2 2 2 3 2)))
    (is-true (same-name-p 'slate (cell-substance-type (map-cell den 2 2))))))

;;; rect

(test manual-5-1.rect-is-an-outline
  "5.1, reading 55: a rect fills the rectangle's border; its inside is the room."
  (is (equal '("------" "-****-" "-*--*-" "-****-" "------")
             (wall-picture (map-of 6 5 '(rect (1 1) (4 3) bricks 1)))))
  (is (equal '("-----" "-***-" "-***-")
             (wall-picture (map-of 5 3 '(rect (3 2) (1 1) bricks 1))))
      "corners in any order"))

(test manual-5-1.rect-of-one-parameter-has-it-everywhere
  "5.1: without more parameters all cells have param0."
  (let ((den (map-of 5 5 '(rect (0 0) (4 4) bricks 6))))
    (is (equalp '(6 6 6 6 6) (walls den 0 0 4 0 4 4 0 4 2 4)))))

(test manual-5-1.rect-of-four-parameters-goes-from-corner-to-corner
  "5.1, reading 56: param0 at (x0,y0), param1 at (x1,y0), param2 at (x1,y1), param3 at (x0,y1), and
between corners what lies between."
  (let ((den (map-of 5 9 '(rect (0 0) (4 8) bricks 0 4 20 12))))
    (is (equalp '(0 4 20 12) (walls den 0 0 4 0 4 8 0 8)) "corners")
    (is (equalp '(2 12 16 6) (walls den 2 0 4 4 2 8 0 4)) "middles")))

(test manual-5-1.rect-takes-one-parameter-or-four
  "5.1, reading 56: param1 to param3 come together or not at all."
  (is (equal '(nil t t nil)
             (mapcar (lambda (complaint) (and complaint t))
                     (complaints '(defmap den (5 5) (rect (0 0) (4 4) bricks 1))
                                 '(defmap den (5 5) (rect (0 0) (4 4) bricks 1 2))
                                 '(defmap den (5 5) (rect (0 0) (4 4) bricks 1 2 3))
                                 '(defmap den (5 5) (rect (0 0) (4 4) bricks 1 2 3 4)))))))

;;; circle

(test manual-5-1.circle-is-a-digitized-outline
  "5.1, reading 55: the filled cells are those about RAD from the centre, all round, and closed."
  (let* ((den (map-of 21 21 '(circle (10 10) 7 stone 3)))
         (radii (loop for y below 21
                      append (loop for x below 21
                                   when (wall-at-p den x y)
                                     collect (sqrt (+ (expt (- x 10) 2) (expt (- y 10) 2)))))))
    (is-true (every (lambda (radius) (<= 6.3 radius 7.7)) radii))
    (is-true (and (wall-at-p den 3 10) (wall-at-p den 17 10) (wall-at-p den 10 3)
                  (wall-at-p den 10 17)))
    (is (<= 40 (length radii) 60))
    (is-false (wall-at-p den 10 10))))

(test manual-5-1.circle-has-one-substance-and-parameter
  "5.1: all cells of a circle are of TYPE with PARAM."
  (let ((den (map-of 9 9 '(circle (4 4) 3 stone 3.5))))
    (is-true (loop for y below 9
                   always (loop for x below 9
                                for cell = (map-cell den x y)
                                always (or (not (cell-filled? cell))
                                           (and (= 3.5 (cell-substance-parameter cell))
                                                (same-name-p 'stone
                                                             (cell-substance-type cell)))))))))

;;; Cells and edges.

(test manual-5-1.cells-have-whole-coordinates
  "5.1, reading 51: the cell of (x,y) is that of the floors of x and y."
  (is (equal '("---" "-**" "---")
             (wall-picture (map-of 3 3 '(wall (1.75 1.99) (2.5 1.01) bricks 1)))))
  (is (equal '(t t nil nil) (list (wall-at-p attic 4 2) (wall-at-p attic 4.99 8.99)
                                  (wall-at-p attic 3.999 5) (wall-at-p attic 5 5)))))

(test manual-5-1.clauses-are-held-within-the-map
  "5.1, reading 52: (rect (0 0) (16 12) ...) in a map of 16 by 12 cells closes the room: its far
walls are in the last cells, and no warning is given. What lies further out is pressed against the
edge."
  (is (equalp '(0 15 26 11) (walls attic 0 0 15 0 15 11 0 11)))
  (is-true (loop for x below 16 always (and (wall-at-p attic x 0) (wall-at-p attic x 11))))
  (is-true (loop for y below 12 always (and (wall-at-p attic 0 y) (wall-at-p attic 15 y))))
  (is (null (warnings-of (lambda () (map-of 5 5 '(rect (0 0) (5 5) bricks 1))))))
  (is (equal '("doubtful")
             (mapcar (lambda (text) (if (search "goes beyond" text) "doubtful" text))
                     (warnings-of (lambda () (map-of 5 5 '(wall (2 2) (9 2) bricks 1))))))))

(defmap meadow (9 9))
(defrobot stray (meadow (4 4.5) 0) :cameras ((1 5)))

(test manual-5-1.outside-the-map-is-solid
  "5.1, reading 53: beyond the edge is wall: robots end there, cameras see the parameter 0."
  (is (equal '(t t t nil) (list (wall-at-p meadow -1 4) (wall-at-p meadow 9 4)
                                (wall-at-p meadow 4 100) (wall-at-p meadow 8 8))))
  (with-simulation (stray :clean t)
    (is (equalp '(0 0 0 0 0) (third (call-once 'camera-view (robot-camera stray 0)))))
    (is (null (end-code 'robot-goto-wall stray)))
    (is (< 8.9 (robot-x stray) 9))))

;;; obj

(test manual-5-1.obj-puts-a-thing-where-it-says
  "5.1, readings 51 and 54: a thing is at (x,y) exactly, whether those are whole or not; it has the
name and the descriptor of its clause."
  (let ((lamp (find-thing 'lamp attic)) (crate (find-thing 'crate attic)))
    (is (equalp '((2 3) (6.5 3.25)) (list (where lamp) (where crate))))
    (is-true (same-name-p 'lamp (thing-name lamp)))
    (is (equal '((:size 2) (:color ars:lightred)) (thing-attributes lamp)))))

(test manual-5-1.obj-takes-the-descriptor-of-its-prototype
  "5.1: attributes of the prototype hold unless the clause says otherwise."
  (let ((trunk (find-thing 'trunk attic)))
    (is (equal '(9 3 2 blue wood)
               (loop for key in '(:capacity :size :weight :color :substance)
                     collect (get-attribute trunk key))))
    (is (= 8 (get-attribute chest* :size)) "the prototype stays as it is")))

(test manual-5-1.obj-copies-the-contents-of-its-prototype
  "5.1, reading 58: what is in the prototype is in the thing, before the clause's own contents."
  (let ((inside (thing-contents (find-thing 'trunk attic))))
    (is (equal '("COIN" "ROPE") (mapcar (lambda (thing) (string (thing-name thing))) inside)))
    (is-false (member (first (thing-contents chest*)) inside) "a coin of its own")))

(test manual-5-1.contents-are-described-recursively
  "5.1: contents are objects with contents; a prototype may be given for them, too."
  (let* ((crate (find-thing 'crate attic)) (sack (find-thing 'sack attic))
         (box (find-thing 'box attic)))
    (is (equal (list sack box) (thing-contents crate)))
    (is (equal '("NUT") (mapcar (lambda (thing) (string (thing-name thing)))
                                (thing-contents sack))))
    (is (equal '(9 red 7) (loop for key in '(:capacity :color :weight)
                                collect (get-attribute box key))))
    (is (eq crate (thing-location box)))
    (is (equalp (where crate) (where (find-thing 'nut attic))))))

(test manual-5-1.contents-are-made-before-what-holds-them
  "5.1 and E, three findings: things are numbered from 1 in one row, contents before their
container; prototypes have no number."
  (is (equal '("LAMP#1" "NUT#2" "SACK#3" "COIN#4" "BOX#5" "CRATE#6" "COIN#7" "ROPE#8" "TRUNK#9")
             (names (world-thing-list (current-world attic)))))
  (is (equal '("CHEST") (names (list chest*)))))

(test manual-5-1.contents-need-not-fit
  "5.1, reading 63: contents given by a map are accepted, however large they are."
  (is (< (get-attribute (find-thing 'crate attic) :capacity)
         (get-attribute (find-thing 'sack attic) :size))))

(test manual-5-1.names-and-descriptors-are-not-evaluated-but-prototypes-are
  "5.1, reading 59: chest* is a variable; LAMP and ((:color red)) stand for themselves."
  (is-false (boundp 'lamp))
  (is (equal '(nil t)
             (mapcar (lambda (complaint) (and complaint t))
                     (complaints '(defmap den (5 5) (obj (a :prototype (progn chest*)) (1 1) ()))
                                 '(defmap den (5 5) (obj (a :prototype 'chest) (1 1) ())))))))

(test manual-5-1.prototypes-do-not-pass-on-kickers
  "5.1, reading 58: a thing has the kickers that it is given, not those of its prototype."
  (let ((restless (new-thing pup nil ((:size 2)))))
    (set-kicker restless 'fidget)
    (with-simulation (usher)
      (let ((copy (make-new-thing 'pup (list attic 9 3) '() :prototype restless)))
        (run-ticks 3)
        (is (equal '(nil (9d0 3d0)) (list (thing-kickers copy) (where copy))))
        (is (< 7 (thing-x (find-thing 'crate))) "whose clause names one")))))

(test manual-5-1.objects-may-stand-anywhere-in-the-map-only
  "5.1: a position is a place in the map, from 0 to below its size."
  (is (equal '(nil nil t t t)
             (mapcar (lambda (complaint) (and complaint t))
                     (complaints '(defmap den (5 5) (obj a (0 0) ()))
                                 '(defmap den (5 5) (obj a (4.99 4.99) ()))
                                 '(defmap den (5 5) (obj a (5 1) ()))
                                 '(defmap den (5 5) (obj a (1 -.1) ()))
                                 '(defmap den (5 5) (obj a (1) ())))))))

(test manual-5-1.clauses-of-no-kind-are-errors
  "5.1: there are walls, rects, circles and objects; anything else is refused, with a message."
  (dolist (clause '((door (1 1) (2 2)) (wall (1 1) bricks 1) (wall (1 1) (2 2) bricks)
                    (rect (0 0) (4 4)) (circle (2 2) bricks 1) (circle (2 2) -1 bricks 1)
                    (obj (1 1) ()) (obj a (1 1) (:color red)) lamp))
    (is-true (first (complaints `(defmap den (5 5) ,clause))) "~S" clause)))

;;; Each run has things of its own.

(test manual-5-1.each-run-begins-with-the-map-as-defined
  "5.1, 5.3: things that were moved, changed or destroyed in one run are as the map says in the
next."
  (flet ((shape ()
           (loop for thing in (world-thing-list *world*)
                 collect (list (princ-to-string thing) (where thing) (thing-attributes thing)))))
    (let ((before (with-simulation (usher :clean t) (shape))))
      (with-simulation (usher :clean t)
        (move-thing (find-thing 'lamp) '(9 3))
        (set-attribute (find-thing 'crate) :size 77)
        (destroy-thing (find-thing 'trunk))
        (is-false (equal before (shape))))
      (is (equal before (with-simulation (usher :clean t) (shape)))))))

;;; Caches.

(defun call-with-cache (function)
  "Call FUNCTION with the name of a file that there is not, in a directory that there is not."
  (let* ((directory (uiop:ensure-directory-pathname
                     (format nil "~Aars-magna-tests/manual-5-1" (uiop:temporary-directory))))
         (file (uiop:native-namestring (merge-pathnames "cache/den" directory))))
    (flet ((clean ()
             (uiop:delete-directory-tree directory :validate t :if-does-not-exist :ignore)))
      (clean)
      (unwind-protect (funcall function file)
        (clean)))))

(defun cached-den (file parameter &rest things)
  "Define the map DEN with FILE as its cache; return it."
  (eval `(defmap den (8 8 :cache ,file) (rect (0 0) (7 7) bricks ,parameter) ,@things))
  (find-map 'den))

(test manual-5-1.cache-is-a-file-that-the-map-is-kept-in
  "5.1: :cache names the file; it is made with the map, directories included, and used again."
  (call-with-cache
   (lambda (file)
     (is-false (probe-file file))
     (cached-den file 5)
     (is-true (probe-file file))
     (let ((written (file-write-date file)))
       (is (equalp '(5 5) (walls (cached-den file 5) 0 0 7 3)))
       (is (= written (file-write-date file))))
     (is (null (message-texts))))))

(test manual-5-1.cache-that-does-not-fit-is-made-anew
  "5.1, reading 62: with other clauses the map is built from them, the file is written again, and a
message says so."
  (call-with-cache
   (lambda (file)
     (cached-den file 5)
     (is (equalp '(6 6) (walls (cached-den file 6) 0 0 7 3)))
     (is-true (has-words-p (first (message-texts)) "stale"))
     (cached-den file 6)
     (is (null (message-texts))))))

(test manual-5-1.cache-keeps-no-things
  "5.1, reading 62: the file holds the grid; things are those of the definition."
  (call-with-cache
   (lambda (file)
     (cached-den file 5 '(obj ball (3 3) ((:size 1))))
     (let ((den (cached-den file 5 '(obj cube (4 4) ((:size 2))))))
       (is (null (message-texts)) "the grid is the same")
       (is (equal '("CUBE#1") (names (world-thing-list (current-world den)))))))))

(test manual-5-1.maps-can-be-defined-anew
  "5.1, reading 61: the newest definition of a name counts."
  (eval '(defmap den (5 5) (wall (1 1) (1 1) bricks 1)))
  (eval '(defmap den (7 3)))
  (let ((den (find-map 'den)))
    (is (equal '(7 3 nil) (list (map-width den) (map-height den) (wall-at-p den 1 1))))
    (is (eq den (symbol-value 'den)))))
