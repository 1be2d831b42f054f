;;;; terrain.lisp -- what never moves: walls, and the marks of places, some drawn by users' code.

(in-package :ars-magna.display)

(export '(with-broken-graphics-reported draw-terrain))

;;; If users' drawing code fails or does not end, this is reported once, and the code is not called
;;; again. The caller then draws something else. Redefined code is a new function and is called.

(defconstant +drawing-seconds+ 2
  "The time limit, in seconds, for users' code that draws one thing or cell.")
(defconstant +drawing-calls+ 100000
  "The largest number of calls of drawing functions that users' code may make per thing or cell.")

(defvar *broken-graphics* (make-hash-table :test #'eq :weakness :key :synchronized t)
  "A table of drawing functions that have signalled an error, and of names without functions.")

(defmacro with-broken-graphics-reported (&body body)
  "Run BODY, which draws a picture for a file. Graphics known to be broken are reported again."
  `(let ((*broken-graphics* (make-hash-table :test #'eq))) ,@body))

(defun signal-drawing-timeout ()
  "Signal MISUSE because users' code has drawn too long, unless the code waits in a debugger."
  (unless (user-calls-waiting-p *user-calls*)
    (reject-use "The drawing code had not ended after ~D seconds. Correct its endless loop."
                +drawing-seconds+)))

(defun draw-by-user-code (canvas function origin x y width height &rest arguments)
  "Call FUNCTION, a user's function, with CANVAS and ARGUMENTS, to draw in the box X, Y, WIDTH,
HEIGHT. ORIGIN, an item or a list of items, names FUNCTION in messages (reading 214). Return true if
FUNCTION succeeds. Otherwise an error message is queued, and the caller must draw over the box."
  (flet ((draw ()
           (let ((*drawing-calls-left* +drawing-calls+) (draw-gcontext* (create-gcontext)))
             (call-with-time-limit (lambda () (apply function canvas arguments))
                                   +drawing-seconds+ #'signal-drawing-timeout)
             t)))
    (unless (gethash function *broken-graphics*)
      (with-clipping (canvas x y width height)
        (let ((*user-calls* (or *user-calls* (make-user-calls))))
          (unless (call-user-code #'draw origin)
            (setf (gethash function *broken-graphics*) t)))))
    (not (gethash function *broken-graphics*))))

(defun draw-crossed-out-box (canvas x y width height)
  (with-color (svref red* 9)
    (with-clipping (canvas x y width height)
      (draw-rectangle canvas draw-gcontext* x y (1- width) (1- height))
      (draw-segments canvas draw-gcontext*
                     (list x y (+ x width -1) (+ y height -1)
                           x (+ y height -1) (+ x width -1) y)))))

;;;; Terrain

;;; Runs of wall cells with the same look are merged into rectangles, and all rectangles of a
;;; look are drawn at once: a picture of a big floor is made of few elements.

;;; Walls.

(defstruct (wall-look (:constructor make-wall-look (color &optional (texture :plain)))
                      (:copier nil))
  "The look of walls. All walls of a map that look alike share one object."
  (color 0 :type color :read-only t)
  (texture :plain :type keyword :read-only t))

(defun wall-look-of (material parameter)
  (make-wall-look (wall-color (wall-shade parameter) (material-hue material))
             (material-texture material)))

(defun wall-look-function (map)
  "Return a function from the index of a wall cell of MAP to the look of the wall. The look depends
on substance and parameter. On a display without colours it is plain black."
  (let ((materials (materials-of map)) (known (make-hash-table :test #'eql))
        (black (make-wall-look black*)))
    (if in-color*
        (lambda (index)
          (let* ((substance (aref (map-substances map) index))
                 (parameter (aref (map-parameters map) index))
                 (key (+ (wall-shade parameter) (* 64 substance))))
            (or (gethash key known)
                (setf (gethash key known) (wall-look-of (svref materials substance) parameter)))))
        (constantly black))))

(defstruct (wall-run (:constructor make-wall-run (left right top bottom look)) (:copier nil))
  "A rectangle of wall cells with the same look. LEFT and TOP are its first column and row; RIGHT
and BOTTOM are the first ones after it."
  (left 0 :type fixnum) (right 0 :type fixnum) (top 0 :type fixnum) (bottom 0 :type fixnum)
  (look nil :type wall-look))

(defun clip-map-part (map left top right bottom)
  "Return the part of MAP between the given columns and rows as a list (left top right bottom).
RIGHT and BOTTOM are the first column and row after the part. NIL means the edge of MAP."
  (flet ((within (value limit) (max 0 (min value limit))))
    (let ((width (map-width map)) (height (map-height map)))
      (list (within (or left 0) width) (within (or top 0) height)
            (within (or right width) width) (within (or bottom height) height)))))

(defun row-runs (map window y looks)
  "Return the runs of walls in the row Y of MAP within WINDOW, from left to right."
  (declare (type map map) (type fixnum y) (type function looks))
  (let ((flags (map-flags map)) (width (map-width map)) (runs '()) (run nil))
    (loop for x from (first window) below (third window)
          do (let* ((index (+ x (* y width)))
                    (look (and (logtest +wall+ (aref flags index)) (funcall looks index))))
               (cond ((null look) (setf run nil))
                     ((and run (eq look (wall-run-look run))) (setf (wall-run-right run) (1+ x)))
                     (t (push (setf run (make-wall-run x (1+ x) y (1+ y) look)) runs)))))
    (nreverse runs)))

(defun wall-runs (map window)
  "Return rectangles that together cover all walls of MAP within WINDOW."
  (let ((above (make-array (map-width map) :initial-element nil)) (runs '())
        (looks (wall-look-function map)))
    (loop for y from (second window) below (fourth window)
          do (dolist (run (row-runs map window y looks))
               (let ((old (svref above (wall-run-left run))))
                 (cond ((and old (= (wall-run-bottom old) y)
                             (= (wall-run-right old) (wall-run-right run))
                             (eq (wall-run-look old) (wall-run-look run)))
                        (setf (wall-run-bottom old) (1+ y)))
                       (t (push run runs)
                          (setf (svref above (wall-run-left run)) run))))))
    runs))

(defconstant +least-tile-width+ 4 "The least width of a texture's tile, in pixels.")

(defun tile-width ()
  "Return the width in pixels of a texture's tiles, which divide a cell evenly. Return NIL if tiles
would be narrower than +LEAST-TILE-WIDTH+."
  (let ((width (/ (rational graphics-scale*) (max 1 (round graphics-scale* 7)))))
    (and (<= +least-tile-width+ width) width)))

(defun draw-wall-look (canvas look rectangles &optional (tile (tile-width)))
  "Fill RECTANGLES, a list x y width height ..., with the wall look LOOK. Tiles of its texture are
TILE pixels wide; without TILE, leave out the texture."
  (with-color (wall-look-color look)
    (draw-rectangles canvas draw-gcontext* rectangles t))
  (when tile
    (with-color (mix-colors (wall-look-color look) white* 6/10)
      (draw-texture canvas draw-gcontext* (wall-look-texture look) rectangles tile))))

(defun wall-width-in-pixels (from to)
  "Return the width in pixels of a wall from column or row FROM to TO: at least 1, to be visible."
  (max 1 (to-pixels (- to from))))

(defun rectangles-by-look (runs)
  "Return a list (look x y width height ...), in pixels, for each look of the wall RUNS."
  (let ((lists '()))
    (dolist (run runs lists)
      (let ((list (or (assoc (wall-run-look run) lists :test #'eq)
                      (first (push (list (wall-run-look run)) lists)))))
        (setf (rest list)
              (list* (to-pixels (wall-run-left run)) (to-pixels (wall-run-top run))
                     (wall-width-in-pixels (wall-run-left run) (wall-run-right run))
                     (wall-width-in-pixels (wall-run-top run) (wall-run-bottom run))
                     (rest list)))))))

(defun draw-walls (canvas map window)
  (loop for (look . rectangles) in (sort (rectangles-by-look (wall-runs map window)) #'<
                                         :key (lambda (list) (wall-look-color (first list))))
        do (draw-wall-look canvas look rectangles)))

;;; Places.

(defun draw-place-at (canvas type x y)
  (or (draw-by-user-code canvas (place-type-graphics type)
                         (list "the :graphics of place type " (place-type-name type))
                         x y graphics-scale* graphics-scale* x y)
      (draw-crossed-out-box canvas x y graphics-scale* graphics-scale*)))

;; As reading 210 says.
(defun drawn-place-type-p (type)
  (and type (place-type-graphics type) (not (place-type-invisible-p type))))

(defun draw-places (canvas map window)
  "Draw the marks of places in WINDOW of MAP whose types are visible and have graphics (manual B)."
  (let ((types (map-place-types map)) (places (map-places map)) (width (map-width map)))
    (loop for y from (second window) below (fourth window)
          do (loop for x from (first window) below (third window)
                   for number = (aref places (+ x (* y width)))
                   unless (zerop number)
                     do (let ((type (svref types number)))
                          (when (drawn-place-type-p type)
                            (draw-place-at canvas type (to-pixels x) (to-pixels y))))))))

;;; The grid: on the floor only, so that it lies on white.

(defun one-two-five-series (limit)
  "Return the list of the numbers 1, 2, 5, 10, 20 and so on up to LIMIT."
  (loop for unit = 1 then (* 10 unit)
        while (<= unit limit)
        append (remove-if (lambda (number) (< limit number)) (list unit (* 2 unit) (* 5 unit)))))

(defun step-for-distance (pixels)
  "Return the least of 1, 2, 5, 10, 20 ... such that this many cells are at least PIXELS wide."
  (find-if (lambda (step) (<= pixels (to-pixels step)))
           (one-two-five-series (* 10 (max 1 (/ pixels graphics-scale*))))))

(defun marks-between (start end pixels)
  "Return coordinates from START to END, in metres, for axis marks that are at least PIXELS apart."
  (loop with step = (step-for-distance pixels)
        for metres from (* step (ceiling start step)) to end by step collect metres))

(defun draw-grid (canvas map window)
  (declare (ignore map))
  (destructuring-bind (left top right bottom) window
    (with-gcontext (draw-gcontext* :foreground (if in-color* +grid-ink+ black*) :dashes '(1 3)
                                   :line-style (if in-color* :solid :dash))
      (draw-segments canvas draw-gcontext*
                     (points-to-pixels (append (loop for x in (marks-between left right 16)
                                                     append (list x top x bottom))
                                               (loop for y in (marks-between top bottom 16)
                                                     append (list left y right y))))))))

(defun draw-terrain (canvas map &key left top right bottom (layers '(:places)))
  "Draw the walls of MAP on CANVAS, with GRAPHICS-SCALE* pixels per cell (manual B), and the layers
in LAYERS that are drawn below and on walls, such as :GRID and :PLACES. Walls are black on canvases
without colours. Otherwise the grey of a wall shows its parameter; its tint and texture show its
substance. LEFT, TOP, RIGHT and BOTTOM, in cells, limit the part to draw, by default the whole MAP."
  (let ((window (clip-map-part map left top right bottom)))
    (flet ((draw-at (depth)
             (dolist (layer (layers-at-depth depth layers))
               (funcall (%layer-draw layer) canvas map window))))
      (draw-at :under-walls)
      (draw-walls canvas map window)
      (draw-at :on-walls))))

;;; The marks of the built-in place types.

;;; Each is a :graphics function as a user would write it. A circle denotes a convex corner, a dot a
;;; concave one or a beak, a square a doorway. On a display with colours the cell has a tint, and
;;; the mark a dark shade of the same hue: so marks can be read without telling tints apart.

(defun fill-cell (canvas x y color)
  (when in-color*
    (with-color color
      (draw-rectangle canvas draw-gcontext* x y graphics-scale* graphics-scale* t))))

;; As reading 209 says.
(defun draw-dot (canvas x y)
  (let* ((size (max 2 (floor graphics-scale* 3)))
         (margin (/ (- graphics-scale* size) 2)))
    (draw-arc canvas draw-gcontext* (+ x margin) (+ y margin) size size 0 2pi t)))

;; As reading 68 says.
(defun draw-convex (canvas x y)
  (fill-cell canvas x y (svref lightred* 9))
  (with-color (svref lightred* 0)
    (draw-arc canvas draw-gcontext* x y graphics-scale* graphics-scale* 0 2pi nil)))

(defun draw-concave (canvas x y)
  (fill-cell canvas x y (svref lightred* 11))
  (with-color (svref lightred* 0) (draw-dot canvas x y)))

(defun draw-beak (canvas x y)
  (fill-cell canvas x y (svref violet* 11))
  (with-color (svref violet* 0) (draw-dot canvas x y)))

(defun draw-doorway (canvas x y)
  (fill-cell canvas x y (svref lightblue* 9))
  (with-color (svref lightblue* 0)
    (draw-rectangle canvas draw-gcontext* (1+ x) (1+ y)
                    (- graphics-scale* 2) (- graphics-scale* 2) nil)))

(loop for (name function) in '((convex draw-convex) (concave draw-concave)
                               (beak draw-beak) (doorway draw-doorway))
      do (setf (place-type-graphics (find-place-type name)) (symbol-function function)))
