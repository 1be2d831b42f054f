;;;; way-picture.lisp -- a map with ways drawn on it, in a file.

(in-package :ars-magna.display)

(define-constant +arrows-apart+ 90
  :documentation "How far arrowheads on a way are apart, about, in pixels.")
(define-constant +least-arrowed+ 24
  :documentation "How long a way with an arrowhead is at least, in pixels.")
(define-constant +arrow-length+ 9 :documentation "How long arrowheads on ways are, in pixels.")

(defun lengths-along (points)
  "Return lists (length x y dx dy) of the pieces of the way through POINTS, x y ...; those of no
length are left out."
  (loop for (x y next-x next-y) on points by #'cddr
        for dx = (and next-y (- next-x x)) and dy = (and next-y (- next-y y))
        for length = (and next-y (sqrt (+ (* dx dx) (* dy dy))))
        while next-y
        when (plusp length) collect (list length x y dx dy)))

(defun spot-along (pieces distance)
  "Return the point DISTANCE along the way of PIECES (see LENGTHS-ALONG), a list (x y)."
  (loop for ((length x y dx dy) . more) on pieces
        when (or (<= distance length) (null more))
          return (let ((share (min 1 (/ distance length))))
                   (list (+ x (* share dx)) (+ y (* share dy))))
        do (decf distance length)))

(defun arrow-along (pieces distance)
  "Return a list (x y angle): an arrowhead DISTANCE along the way of PIECES."
  (destructuring-bind ((x y) (to-x to-y))
      (list (spot-along pieces (- distance (/ +arrow-length+ 2)))
            (spot-along pieces (+ distance (/ +arrow-length+ 2))))
    (list (/ (+ x to-x) 2) (/ (+ y to-y) 2) (atan (- to-y y) (- to-x x)))))

(defun free-arrow (pieces distance arrows)
  "Return an arrowhead about DISTANCE along the way of PIECES that lies on none of ARROWS, as it may
where a way leads back; or NIL."
  (loop with room = (* 3/2 +arrow-length+)
        for aside in (list 0 room (- room) (* 2 room) (* -2 room))
        for (x y angle) = (arrow-along pieces (max 0 (+ distance aside)))
        when (loop for (other-x other-y) in arrows
                   never (overlap-p (box-around x y room) (list other-x other-y other-x other-y)))
          return (list x y angle)))

(defun arrows-along (points)
  "Return lists (x y angle) of where arrowheads stand on the way through POINTS, x y ... in pixels:
few, and none on a very short one."
  (let* ((pieces (lengths-along points)) (whole (reduce #'+ pieces :key #'first))
         (count (if (< whole +least-arrowed+) 0 (max 1 (round whole +arrows-apart+))))
         (arrows '()))
    (dotimes (index count (reverse arrows))
      (let ((arrow (free-arrow pieces (* (+ index 1/2) (/ whole count)) arrows)))
        (when arrow (push arrow arrows))))))

(defun draw-way-arrow (canvas x y angle color hollow-p)
  "Draw an arrowhead with a halo around X, Y in direction ANGLE."
  (flet ((head (color more)
           (let ((reach (+ more (* 1/2 +arrow-length+))))
             (with-gcontext (draw-gcontext* :foreground color)
               (draw-lines canvas draw-gcontext*
                           (append (around x y angle reach) (around x y (+ angle 2.4d0) reach)
                                   (around x y (- angle 2.4d0) reach))
                           :fill-p t)))))
    (let ((ink (if in-color* color black*)) (larger (if hollow-p 2 0)))
      (head white* (+ larger 3/2))
      (head ink larger)
      (when hollow-p (head white* -1)))))

(defun draw-way-line (canvas points color position)
  "Draw a line of COLOR through POINTS, x y ... in pixels, dashed as that at POSITION of several,
with arrowheads on it that say where it leads; they are hollow where heads of robots are."
  (with-gcontext (draw-gcontext* :foreground white* :line-width 4)
    (draw-lines canvas draw-gcontext* points))
  (with-color color
    (with-dashes ((turn-dashes position) :width 2)
      (draw-lines canvas draw-gcontext* points)))
  (loop for (x y angle) in (arrows-along points)
        do (draw-way-arrow canvas x y angle color (hollow-head-p position))))

(defun draw-start (canvas x y color)
  "Draw what marks where a way begins: a small ring."
  (with-gcontext (draw-gcontext* :foreground white*) (draw-circle canvas x y 5 t))
  (inked (color :width 2) (draw-circle canvas x y 4 nil)))

(defun draw-goal (canvas x y color)
  "Draw what marks where a way ends: a spot."
  (with-gcontext (draw-gcontext* :foreground white*) (draw-circle canvas x y 5 t))
  (with-color color (draw-circle canvas x y 4 t)))

(defun way-entry (text color position)
  "Return an entry of a legend for a way."
  (sample-of-name (canvas x y) (text "" 38)
    (draw-way-line canvas (list (- x 18) y (+ x 18) y) color position)))

;;; Ways as points.

(defun coordinates-of (point)
  "Return the coordinates of POINT, a PT or a list (x y), as a list in pixels."
  (list (to-pixels (if (pt-p point) (pt-x point) (first point)))
        (to-pixels (if (pt-p point) (pt-y point) (second point)))))

(defun draw-way-on-map (canvas way position)
  "Draw WAY, a list of points, the one at POSITION of several."
  (let ((color (turn-ink position)))
    (draw-way-line canvas (mapcan #'coordinates-of way) color position)
    (destructuring-bind (x y) (coordinates-of (first way)) (draw-start canvas x y color))
    (destructuring-bind (x y) (coordinates-of (first (last way))) (draw-goal canvas x y color))))

(defun way-p (way)
  (and (consp way) (proper-list-p way)
       (every (lambda (point) (or (pt-p point) (number-pair-p point))) way)))

(defun check-ways (ways)
  "Signal WRONG-ARGUMENT unless WAYS is a list of ways."
  (when (and (proper-list-p ways) (member nil ways))
    (reject-argument 'save-way-picture 'ways ways
                     (format nil "a list of ways. There is a NIL in it, which FIND-WAY returns ~
                                  where there is no way: leave that out")))
  (check-argument save-way-picture ways (and (proper-list-p ways) (every #'way-p ways))
                  "a list of ways, each a list of PTs or of lists (x y)"))

(defun point-on-map-p (point map)
  (destructuring-bind (x y) (if (pt-p point) (list (pt-x point) (pt-y point)) point)
    (and (<= 0 x (map-width map)) (<= 0 y (map-height map)))))

(defun check-ways-on (map ways)
  "Signal WRONG-ARGUMENT unless all points of WAYS are on MAP."
  (dolist (way ways)
    (dolist (point way)
      (unless (point-on-map-p point map)
        (reject-argument 'save-way-picture 'ways point
                         (format nil "ways on the map ~A, with x from 0 to ~D and y from 0 to ~D"
                                 (drawn-name (map-name map)) (map-width map) (map-height map)))))))

(defun ways-entries (ways)
  "Return the entries of the legend for WAYS."
  (append (loop for nil in ways for position from 0
                collect (way-entry (format nil "way~:[~; ~D~]" (rest ways) (1+ position))
                                   (turn-ink position) position))
          (and ways (list (sample-of (canvas x y) "start" (draw-start canvas x y black*))
                          (sample-of (canvas x y) "end" (draw-goal canvas x y black*))))))

(defun snapshot-of-map (map)
  "Return a snapshot of the current world, if that is of MAP, or else of MAP with nothing in it."
  (let ((simulation *simulation*))
    (if (and simulation (eq map (world-map (simulation-world simulation))))
        (asking (simulation) (take-snapshot (simulation-world simulation)))
        (make-snapshot :map map))))

(defun way-picture-text (snapshot ways &key layers in-color scale title)
  "Return an SVG document of SNAPSHOT with WAYS, under TITLE."
  (let ((more (ways-entries ways)))
    (with-output-to-string (stream)
      (with-map-svg (canvas stream snapshot :layers layers :in-color in-color :scale scale)
        (draw-framed canvas snapshot layers
                     (lambda ()
                       (draw-terrain canvas (snapshot-map snapshot) :layers layers)
                       (loop for way in ways for position from 0
                             do (draw-way-on-map canvas way position))
                       (draw-movers canvas snapshot layers))
                     :title title :more more)))))

(addition save-way-picture)
(define-with-keywords save-way-picture
    (map ways file &key title (layers *picture-layers*) (in-color t) scale)
  "Save in FILE, replacing it, a picture of MAP, a map or the name of one, and of WAYS in it: a
list of ways, each a list of PTs or of lists (x y), as FIND-WAY returns it. If the current
simulation is in MAP, its things and robots are shown as they are now. TITLE, a string, stands
above. FILE and the other arguments are those of SAVE-PICTURE. Return the file's truename. Signals
WRONG-ARGUMENT, UNKNOWN-NAME, and MISUSE without the program that PNG needs."
  (check-ways ways)
  (check-map-options 'save-way-picture :title title :layers layers :scale scale)
  (let* ((map (find-map map)) (kind (picture-kind 'save-way-picture file)))
    (check-ways-on map ways)
    (save-svg (telling-what-breaks
                (way-picture-text (snapshot-of-map map) ways
                                  :layers layers :in-color in-color :scale scale
                                  :title (or title (drawn-name (map-name map)))))
              file kind)))
