;;;; terrain.lisp -- what never moves: walls, and the marks of places (manual B, B.1).

(in-package :ars-magna.display)

;;; Runs of wall cells with the same shade are merged into rectangles, and all rectangles of a
;;; shade are drawn at once: a picture of a big floor is made of few elements.

;;; Walls.

(define-constant +darkest-wall+ 14 :documentation "The shade of grey* of the least parameter.")
(define-constant +lightest-wall+ 44 :documentation "The shade of grey* of the greatest one.")

(defun wall-shade (map parameter)
  "Return the shade of grey* of walls of MAP with PARAMETER; walls of one map that all have the same
parameter are dark."
  (declare (type map map))
  (let ((least (map-least-parameter map)) (greatest (map-greatest-parameter map)))
    (if (> greatest least)
        (+ +darkest-wall+
           (values (round (* (- +lightest-wall+ +darkest-wall+)
                             (/ (- parameter least) (- greatest least))))))
        +darkest-wall+)))

(defun wall-colors (map)
  "Return a function of the index of a wall cell of MAP that returns its colour: a grey by the
substance parameter, tinted by the substance; black on a display without colours."
  (let ((hues (hues-of map)) (known (make-hash-table :test #'eql)))
    (if in-color*
        (lambda (index)
          (let* ((substance (aref (map-substances map) index))
                 (shade (wall-shade map (aref (map-parameters map) index)))
                 (key (+ shade (* 64 substance))))
            (or (gethash key known)
                (setf (gethash key known) (wall-color shade (svref hues substance))))))
        (constantly black*))))

(defstruct (wall-run (:constructor make-wall-run (left right top bottom color)) (:copier nil))
  "A rectangle of wall cells of one colour; RIGHT and BOTTOM are outside."
  (left 0 :type fixnum) (right 0 :type fixnum) (top 0 :type fixnum) (bottom 0 :type fixnum)
  (color 0 :type color))

(defstruct (window (:constructor make-window (left top right bottom)) (:copier nil))
  "The cells of a map that are to be drawn; RIGHT and BOTTOM are outside."
  (left 0 :type fixnum :read-only t) (top 0 :type fixnum :read-only t)
  (right 0 :type fixnum :read-only t) (bottom 0 :type fixnum :read-only t))

(defun clip-window (map left top right bottom)
  "Return the window of the cells of MAP between the given ones; NIL means to the edge."
  (flet ((within (value limit) (max 0 (min value limit))))
    (let ((width (map-width map)) (height (map-height map)))
      (make-window (within (or left 0) width) (within (or top 0) height)
                   (within (or right width) width) (within (or bottom height) height)))))

(defun row-runs (map window y colors)
  "Return the runs of walls in the row Y of MAP within WINDOW, from left to right."
  (declare (type map map) (type fixnum y) (type function colors))
  (let ((flags (map-flags map)) (width (map-width map)) (runs '()) (run nil))
    (loop for x from (window-left window) below (window-right window)
          do (let* ((index (+ x (* y width)))
                    (color (and (logtest +wall+ (aref flags index)) (funcall colors index))))
               (cond ((null color) (setf run nil))
                     ((and run (= color (wall-run-color run))) (setf (wall-run-right run) (1+ x)))
                     (t (push (setf run (make-wall-run x (1+ x) y (1+ y) color)) runs)))))
    (nreverse runs)))

(defun wall-runs (map window)
  "Return rectangles that together are all walls of MAP within WINDOW."
  (let ((above (make-array (map-width map) :initial-element nil)) (runs '())
        (colors (wall-colors map)))
    (loop for y from (window-top window) below (window-bottom window)
          do (dolist (run (row-runs map window y colors))
               (let ((old (svref above (wall-run-left run))))
                 (cond ((and old (= (wall-run-bottom old) y)
                             (= (wall-run-right old) (wall-run-right run))
                             (= (wall-run-color old) (wall-run-color run)))
                        (setf (wall-run-bottom old) (1+ y)))
                       (t (push run runs)
                          (setf (svref above (wall-run-left run)) run))))))
    runs))

(defun draw-walls (canvas map window)
  (let ((by-color '()))
    (dolist (run (wall-runs map window))
      (let ((entry (or (assoc (wall-run-color run) by-color)
                       (first (push (list (wall-run-color run)) by-color)))))
        (setf (rest entry)
              (list* (* graphics-scale* (wall-run-left run))
                     (* graphics-scale* (wall-run-top run))
                     (* graphics-scale* (- (wall-run-right run) (wall-run-left run)))
                     (* graphics-scale* (- (wall-run-bottom run) (wall-run-top run)))
                     (rest entry)))))
    (loop for (color . rectangles) in (sort by-color #'< :key #'first)
          do (with-color color
               (draw-rectangles canvas draw-gcontext* rectangles t)))))

;;; Graphics bodies are user code: one that fails is reported once, and drawn as a mark.

(defvar *broken-graphics* (make-hash-table :test #'eq :weakness :key :synchronized t)
  "The functions that have signalled an error, and are called no more.")

(defmacro telling-what-breaks (&body body)
  "Run BODY, which draws a file: of what is broken it tells once, though it was told before."
  `(let ((*broken-graphics* (make-hash-table :test #'eq))) ,@body))

(defun draw-mark (canvas x y width height)
  "Draw what stands for graphics that cannot be drawn: a crossed box."
  (with-color (svref red* 9)
    (with-clipping (canvas x y width height)
      (draw-rectangle canvas draw-gcontext* x y (1- width) (1- height))
      (draw-segments canvas draw-gcontext*
                     (list x y (+ x width -1) (+ y height -1)
                           x (+ y height -1) (+ x width -1) y)))))

(defun draw-by-user (canvas function origin x y width height &rest arguments)
  "Have FUNCTION draw in a box of CANVAS, called with CANVAS and ARGUMENTS. ORIGIN, an item or list
of items, says whose it is (reading 214)."
  (unless (gethash function *broken-graphics*)
    (let ((finished-p nil))
      (with-clipping (canvas x y width height)
        (let ((draw-gcontext* (create-gcontext)))
          (call-user-code (lambda ()
                            (apply function canvas arguments)
                            (setf finished-p t))
                          origin)))
      (unless finished-p (setf (gethash function *broken-graphics*) t))))
  (when (gethash function *broken-graphics*)
    (draw-mark canvas x y width height)))

;;; Places.

(defun draw-place-at (canvas type x y)
  "Draw the mark of TYPE in the cell whose upper left corner is at X, Y."
  (draw-by-user canvas (place-type-graphics type)
                (list "the :graphics of place type " (place-type-name type))
                x y graphics-scale* graphics-scale* x y))

(defun draw-place (canvas type column row)
  (draw-place-at canvas type (* column graphics-scale*) (* row graphics-scale*)))

;; As reading 210 says.
(defun drawn-place-type-p (type)
  (and type (place-type-graphics type) (not (place-type-invisible-p type))))

(defun draw-places (canvas map window)
  "Mark the cells of MAP in WINDOW that are places of visible types which have graphics (manual B)."
  (let ((types (map-place-types map)) (places (map-places map)) (width (map-width map)))
    (loop for y from (window-top window) below (window-bottom window)
          do (loop for x from (window-left window) below (window-right window)
                   for number = (aref places (+ x (* y width)))
                   unless (zerop number)
                     do (let ((type (svref types number)))
                          (when (drawn-place-type-p type) (draw-place canvas type x y)))))))

;;; The grid: on the floor only, so that it lies on white.

(defun steps-apart (pixels)
  "Return how many cells marks are apart, 1, 2, 5, 10 and so on, that are PIXELS apart at least."
  (loop for unit = 1 then (* 10 unit)
        do (dolist (factor '(1 2 5))
             (when (<= pixels (* factor unit graphics-scale*))
               (return-from steps-apart (* factor unit))))))

(defun draw-grid (canvas window)
  (let ((step (steps-apart 16)))
    (flet ((lines (from to function)
             (loop for at from (* step (ceiling from step)) to to by step
                   append (funcall function (to-pixels at)))))
      (with-gcontext (draw-gcontext* :foreground (if in-color* +grid-ink+ black*) :dashes '(1 3)
                                     :line-style (if in-color* :solid :dash))
        (draw-segments canvas draw-gcontext*
                       (let ((left (to-pixels (window-left window)))
                             (top (to-pixels (window-top window)))
                             (right (to-pixels (window-right window)))
                             (bottom (to-pixels (window-bottom window))))
                         (append (lines (window-left window) (window-right window)
                                        (lambda (x) (list x top x bottom)))
                                 (lines (window-top window) (window-bottom window)
                                        (lambda (y) (list left y right y))))))))))

(defun draw-terrain (canvas map &key left top right bottom (layers '(:places)))
  "Draw the walls of MAP in black, or in greys by their substance parameters with a tint by their
substance, and, as far as LAYERS lists :PLACES and :GRID, the marks of its places and the borders of
its cells, on CANVAS, GRAPHICS-SCALE* pixels to a cell (manual B). LEFT, TOP, RIGHT and BOTTOM,
columns and rows of cells, say which part of MAP is wanted; by default all of it is."
  (let ((window (clip-window map left top right bottom)))
    (when (member :grid layers) (draw-grid canvas window))
    (draw-walls canvas map window)
    (when (member :places layers) (draw-places canvas map window))))
