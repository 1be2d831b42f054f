;;;; way-lines.lisp -- ways as lines on a map, side by side; trails and planned ways.

(in-package :ars-magna.display)

(export '(make-way-line draw-way-lines draw-way-sample draw-way-arrows draw-way-marks jumps-between
          way-visible-p points-along draw-jump-dots draw-way-start))

;;; Several ways may go along one line. So each is drawn in its own lane, a few pixels beside its
;;; place. They are drawn together: all halos, then all lines, then arrowheads, then the marks of
;;; their ends, around each other on one spot. So no way hides another.

(defconstant +arrow-distance+ 90 "The approximate distance between arrowheads on a way, in pixels.")
(defconstant +least-way-with-arrow+ 24
  "The length of the shortest way with an arrowhead, in pixels.")
(defconstant +arrow-length+ 9 "The length of arrowheads on ways, in pixels.")

(defun segments-along (points)
  "Return a list (length x y dx dy) for each segment of the way POINTS, x y ..., longer than 0."
  (loop for (x y next-x next-y) on points by #'cddr
        for dx = (and next-y (- next-x x)) and dy = (and next-y (- next-y y))
        for length = (and next-y (sqrt (+ (* dx dx) (* dy dy))))
        while next-y
        when (plusp length) collect (list length x y dx dy)))

(defun point-along (pieces distance)
  "Return the point (x y) at DISTANCE along the way of PIECES, a value of SEGMENTS-ALONG."
  (loop for ((length x y dx dy) . more) on pieces
        when (or (<= distance length) (null more))
          return (let ((share (min 1 (/ distance length))))
                   (list (+ x (* share dx)) (+ y (* share dy))))
        do (decf distance length)))

(defun arrow-along (pieces distance)
  "Return an arrowhead (x y angle) at DISTANCE along the way of PIECES, a value of SEGMENTS-ALONG."
  (destructuring-bind ((x y) (to-x to-y))
      (list (point-along pieces (- distance (/ +arrow-length+ 2)))
            (point-along pieces (+ distance (/ +arrow-length+ 2))))
    (list (/ (+ x to-x) 2) (/ (+ y to-y) 2) (arctangent (- to-y y) (- to-x x)))))

(defun arrow-without-overlap (pieces distance arrows)
  "Return an arrowhead near DISTANCE along the way of PIECES that overlaps none of ARROWS, or NIL if
there is no room. Overlaps can occur where a way leads back."
  (loop with room = (* 3/2 +arrow-length+)
        for aside in (list 0 room (- room) (* 2 room) (* -2 room))
        for (x y angle) = (arrow-along pieces (max 0 (+ distance aside)))
        when (loop for (other-x other-y) in arrows
                   never (overlap-p (box-around x y room) (list other-x other-y other-x other-y)))
          return (list x y angle)))

(defun arrows-along (points &optional others)
  "Return arrowheads (x y angle) for the way through POINTS, x y ... in pixels. The arrowheads are
far apart and do not overlap OTHERS. A very short way has no arrowhead."
  (let* ((pieces (segments-along points)) (whole (reduce #'+ pieces :key #'first))
         (count (if (< whole +least-way-with-arrow+) 0 (max 1 (round whole +arrow-distance+))))
         (arrows '()))
    (dotimes (index count (reverse arrows))
      (let ((arrow (arrow-without-overlap pieces (* (+ index 1/2) (/ whole count))
                                          (append arrows others))))
        (when arrow (push arrow arrows))))))

(defun draw-way-arrow (canvas x y angle color hollow-p)
  "Draw an arrowhead with a halo around X, Y in direction ANGLE, hollow if HOLLOW-P."
  (flet ((head (color more)
           (let ((reach (+ more (* 1/2 +arrow-length+))))
             (with-gcontext (draw-gcontext* :foreground color)
               (draw-lines canvas draw-gcontext*
                           (append (point-at-distance x y angle reach)
                                   (point-at-distance x y (+ angle 2.4d0) reach)
                                   (point-at-distance x y (- angle 2.4d0) reach))
                           :fill-p t)))))
    (let ((ink (if in-color* color black*)) (larger (if hollow-p 2 0)))
      (head white* (+ larger 3/2))
      (head ink larger)
      (when hollow-p (head white* -1)))))

(define-constant +lanes+ '((0 0) (5/4 5/2) (5/2 -5/4) (-5/4 -5/2) (-5/2 5/4))
  :test #'cl:equal
  :documentation "The offsets of ways from their real positions in a picture of several ways: a list
(x y) for each lane, in widths of the line. No two lanes share a row, a column or a diagonal,
because ways would overlap there.")

(define-record (way-line (:constructor make-way-line
                             (position pieces &key (color (nth-ink position))
                                                   (dashes (nth-dashes position)) (width 2)
                                                   (arrows-p t) (lane position))))
  "A way drawn as a line of PIECES. POSITION is its position in a list of several ways."
  (position 0 integer)
  (lane 0 integer "the number of the lane in which the way is drawn")
  (pieces '() list "lists x y ... in pixels; between two pieces the robot was put elsewhere")
  (color 0 integer)
  (dashes '() list)
  (width 2 real)
  (arrows-p t t "the way has arrowheads"))

(defun pieces-in-lane (line)
  "Return the pieces of the way LINE that have several points, moved into the lane of LINE."
  (destructuring-bind (aside down) (nth-cyclic (way-line-lane line) +lanes+)
    (let ((dx (* 1d0 aside (way-line-width line))) (dy (* 1d0 down (way-line-width line))))
      (loop for piece in (way-line-pieces line)
            when (cddr piece)
              collect (loop for (x y) on piece by #'cddr collect (+ x dx) collect (+ y dy))))))

;;; A robot can be put elsewhere, by PLACE-ROBOT or in the window, without a way from here to there.
;;; This is a jump: the line ends, and a new one begins where the robot was put. Dots join the two.

(define-constant +jump-dashes+ '(1 6)
  :test #'cl:equal
  :documentation "The lengths of the dots and gaps that show jumps, in pixels.")
(defconstant +jump-width+ 3/2 "The width of the dots that show jumps, in pixels.")

(defun draw-jump-dots (canvas jumps color)
  "Draw JUMPS, lists x y to-x to-y in pixels, as dots in COLOR."
  (with-color color
    (with-dashes (+jump-dashes+ :width +jump-width+)
      (dolist (jump jumps) (draw-segments canvas draw-gcontext* jump)))))

(defun jumps-between (pieces)
  "Return a list x y to-x to-y for each jump between PIECES, lists x y ..., of a way."
  (loop for (piece next) on pieces
        when (and piece next) collect (append (last piece 2) (subseq next 0 2))))

(defun draw-way-halos (canvas lines)
  (dolist (line lines)
    (with-gcontext (draw-gcontext* :foreground white* :line-width (+ 2 +jump-width+))
      (dolist (jump (jumps-between (way-line-pieces line)))
        (draw-segments canvas draw-gcontext* jump)))
    (with-gcontext (draw-gcontext* :foreground white* :line-width (+ 2 (way-line-width line)))
      (dolist (points (pieces-in-lane line)) (draw-lines canvas draw-gcontext* points)))))

(defun draw-way-arrows (canvas lines)
  "Draw the arrowheads of the ways LINES, without overlaps."
  (let ((arrows '()))
    (dolist (line (remove-if-not #'way-line-arrows-p lines))
      (dolist (points (pieces-in-lane line))
        (loop for (x y angle) in (arrows-along points arrows)
              do (push (list x y angle) arrows)
                 (draw-way-arrow canvas x y angle (way-line-color line)
                                 (hollow-arrowhead-p (way-line-position line))))))))

(defun draw-way-lines (canvas lines)
  "Draw the ways LINES and their jumps, so that no way hides another."
  (draw-way-halos canvas lines)
  (dolist (line lines)
    (draw-jump-dots canvas (jumps-between (way-line-pieces line)) (way-line-color line)))
  (dolist (line lines)
    (with-color (way-line-color line)
      (with-dashes ((way-line-dashes line) :width (way-line-width line))
        (dolist (points (pieces-in-lane line)) (draw-lines canvas draw-gcontext* points)))))
  (draw-way-arrows canvas lines))

(defun draw-way-sample (canvas points color position)
  "Draw a sample of way number POSITION along POINTS, x y ... in pixels, in COLOR."
  (draw-way-lines canvas (list (make-way-line position (list points) :color color :lane 0))))

;;; Visible jumps and ways.

(defconstant +tile-side+ 4 "The side of the square tiles that cover a line, in pixels.")

(defun points-along (x y to-x to-y step)
  "Return points (x y) on the line from X, Y to TO-X, TO-Y, about STEP pixels apart."
  (loop with count = (max 1 (ceiling (max (abs (- to-x x)) (abs (- to-y y))) step))
        for share from 0 to 1 by (/ count)
        collect (list (+ x (* share (- to-x x))) (+ y (* share (- to-y y))))))

(defun tile-at (x y)
  (cons (floor x +tile-side+) (floor y +tile-side+)))

(defun tiles-along (pieces)
  "Return a hash table keyed by the tiles that PIECES, lists x y ... in pixels, cross or touch."
  (let ((tiles (make-hash-table :test #'equal)))
    (dolist (piece pieces tiles)
      (loop for (x y next-x next-y) on piece by #'cddr
            while next-y
            do (loop for (x y) in (points-along x y next-x next-y (/ +tile-side+ 2))
                     do (loop for (dx dy) in '((-1 -1) (-1 1) (1 -1) (1 1))
                              do (setf (gethash (tile-at (+ x dx) (+ y dy)) tiles) t)))))))

(defun jump-visible-p (ways box)
  "True if part of a jump in WAYS, lists of pieces, is visible: in BOX and not covered by a way."
  (loop with jumps = (mapcan #'jumps-between ways)
        with tiles = (and jumps (tiles-along (apply #'append ways)))
        for (x y to-x to-y) in jumps
        thereis (loop for (x y) in (points-along x y to-x to-y +tile-side+)
                      thereis (and (overlap-p (list x y (+ x 1/100) (+ y 1/100)) box)
                                   (not (gethash (tile-at x y) tiles))))))

(defun way-visible-p (pieces box)
  "True if a part of the way of PIECES is within BOX."
  (some (lambda (piece)
          (loop for (x y next-x next-y) on piece by #'cddr
                thereis (overlap-p (list (1- x) (1- y) (1+ x) (1+ y)) box)
                while next-y
                thereis (loop for (x y) in (points-along x y next-x next-y +tile-side+)
                              thereis (overlap-p (list x y (1+ x) (1+ y)) box))))
        pieces))

;;; Where ways begin and end.

(defconstant +mark-radius+ 4 "The radius of the mark where a way begins or ends, in pixels.")

(defun draw-way-start (canvas x y color &optional (radius +mark-radius+))
  "Draw the mark of the start of a way: a small ring."
  (with-gcontext (draw-gcontext* :foreground white*) (draw-circle canvas x y (1+ radius) t))
  (with-halo (color :width 2) (draw-circle canvas x y radius nil)))

(defun draw-way-end (canvas x y color &optional (radius +mark-radius+))
  "Draw the mark of the end of a way: a filled circle."
  (with-gcontext (draw-gcontext* :foreground white*) (draw-circle canvas x y (1+ radius) t))
  (with-color color (draw-circle canvas x y radius t)))

(defun draw-way-marks (canvas marks)
  "Draw MARKS, lists (function x y color), at ends of ways. Marks at one place surround each other."
  (flet ((near-p (one other)
           (and (< (abs (- (second one) (second other))) +mark-radius+)
                (< (abs (- (third one) (third other))) +mark-radius+))))
    (loop for (mark . before) on (reverse marks)
          for within = (count-if (lambda (other) (near-p mark other)) before)
          for (draw x y color) = mark
          do (funcall draw canvas x y color (+ +mark-radius+ (* 3 within))))))

;;; Trails.

;;; In a window only the newest part of a trail is drawn, with few points. So a long trail takes no
;;; more time than a short one, and does not hide the map.

(defvar *drawn-trail-metres* nil
  "The length in metres of the newest part of each trail that is drawn, or NIL for all of it.")

(defconstant +trail-tolerance+ 0.5d0
  "The distance from a straight part of a trail, in pixels, up to which points are left out.")

(defun straight-on-p (x y dx dy last-x last-y next-x next-y)
  "True if a trail from X, Y in direction DX, DY goes straight on from LAST-X, LAST-Y to NEXT-X,
NEXT-Y."
  (and (plusp (+ (* dx (- next-x last-x)) (* dy (- next-y last-y))))
       (<= (abs (- (* dx (- next-y y)) (* dy (- next-x x))))
           (* +trail-tolerance+ (sqrt (+ (* dx dx) (* dy dy)))))))

(defun corners-of-piece (points)
  "Return the first and last of POINTS, x y ... in pixels, and those where their line turns."
  (destructuring-bind (x y &rest more) points
    (loop with kept = (list y x) and last-x = x and last-y = y and dx = 0 and dy = 0
          for (next-x next-y) on more by #'cddr
          do (unless (straight-on-p x y dx dy last-x last-y next-x next-y)
               (unless (and (eql x last-x) (eql y last-y))
                 (setf kept (list* last-y last-x kept)))
               (setf x last-x y last-y dx (- next-x x) dy (- next-y y)))
             (setf last-x next-x last-y next-y)
          finally (return (nreverse (if more (list* last-y last-x kept) kept))))))

(defun pieces-of-trail (points)
  "Return the pieces, lists x y ... in pixels, of a trail with POINTS, the newest point first."
  (let ((pieces '()) (before nil) (left *drawn-trail-metres*) (last-x 0d0) (last-y 0d0))
    (do-trail (points x y nil placements)
      do (cond ((not (eql placements before)) (push '() pieces))
               (left (decf left (pixel-distance last-x last-y x y))))
         (setf before placements last-x x last-y y)
         (push (to-pixels x) (first pieces))
         (push (to-pixels y) (first pieces))
      until (and left (minusp left)))
    (let ((pieces (nreverse (mapcar #'nreverse pieces))))
      (if left (mapcar #'corners-of-piece pieces) pieces))))

(defun robots-with-trails (snapshot)
  (remove-if-not (lambda (robot) (cddddr (robot-image-trail robot))) (snapshot-robots snapshot)))

(defun draw-trails (canvas robots)
  (draw-way-lines canvas
                  (loop for robot in robots
                        collect (make-way-line (robot-image-position robot)
                                               (pieces-of-trail (robot-image-trail robot))
                                               :dashes (layer-dashes :trail) :width 1
                                               :arrows-p nil))))

;;; Planned ways.

(defun robots-with-planned-ways (snapshot)
  (remove-if-not (lambda (robot) (rest (robot-image-planned-way robot)))
                 (snapshot-robots snapshot)))

(defun end-of-planned-way (robot)
  "Return the end of the planned way of ROBOT, a point (x y) in pixels."
  (points-to-pixels (first (last (robot-image-planned-way robot)))))

(defun planned-way-end-boxes (robots)
  "Return the boxes, in pixels, of the rings at the ends of the planned ways of ROBOTS."
  (loop for robot in robots
        collect (destructuring-bind (x y) (end-of-planned-way robot)
                  (box-around x y (+ 2 +mark-radius+)))))

(defun draw-planned-ways (canvas robots)
  (draw-way-lines canvas
                  (loop for robot in robots
                        for way = (apply #'append (robot-image-planned-way robot))
                        collect (make-way-line (robot-image-position robot)
                                               (list (points-to-pixels way))
                                               :dashes (layer-dashes :planned-way)
                                               :arrows-p nil)))
  (draw-way-marks canvas
                  (loop for robot in robots
                        collect `(draw-way-start ,@(end-of-planned-way robot)
                                                 ,(nth-ink (robot-image-position robot))))))
