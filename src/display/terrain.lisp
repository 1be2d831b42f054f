;;;; terrain.lisp -- what never moves: walls, and the marks of places (manual B, B.1).

(in-package :ars-magna.display)

;;; Runs of wall cells with the same shade are merged into rectangles, and all rectangles of a
;;; shade are drawn at once: a picture of a big floor is made of few elements.

;;; Walls.

(define-constant +darkest-wall+ 8 :documentation "The shade of grey* of the least parameter.")
(define-constant +lightest-wall+ 44 :documentation "The shade of grey* of the greatest one.")

(defun wall-shade (map index)
  "Return the shade of grey* of the wall in the cell INDEX of MAP; walls of one map that all have
the same parameter are dark."
  (declare (type map map))
  (let ((least (map-least-parameter map)) (greatest (map-greatest-parameter map)))
    (if (> greatest least)
        (+ +darkest-wall+
           (values (round (* (- +lightest-wall+ +darkest-wall+)
                             (/ (- (aref (map-parameters map) index) least)
                                (- greatest least))))))
        +darkest-wall+)))

(defstruct (wall-run (:constructor make-wall-run (left right top bottom shade)) (:copier nil))
  "A rectangle of wall cells of one shade; RIGHT and BOTTOM are outside."
  (left 0 :type fixnum) (right 0 :type fixnum) (top 0 :type fixnum) (bottom 0 :type fixnum)
  (shade 0 :type fixnum))

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

(defun row-runs (map window y in-color)
  "Return the runs of walls in the row Y of MAP within WINDOW, from left to right."
  (declare (type map map) (type fixnum y))
  (let ((flags (map-flags map)) (width (map-width map)) (runs '()) (run nil))
    (loop for x from (window-left window) below (window-right window)
          do (let* ((index (+ x (* y width)))
                    (shade (and (logtest +wall+ (aref flags index))
                                (if in-color (wall-shade map index) 0))))
               (cond ((null shade) (setf run nil))
                     ((and run (= shade (wall-run-shade run))) (setf (wall-run-right run) (1+ x)))
                     (t (push (setf run (make-wall-run x (1+ x) y (1+ y) shade)) runs)))))
    (nreverse runs)))

(defun wall-runs (map window in-color)
  "Return rectangles that together are all walls of MAP within WINDOW."
  (let ((above (make-array (map-width map) :initial-element nil)) (runs '()))
    (loop for y from (window-top window) below (window-bottom window)
          do (dolist (run (row-runs map window y in-color))
               (let ((old (svref above (wall-run-left run))))
                 (cond ((and old (= (wall-run-bottom old) y)
                             (= (wall-run-right old) (wall-run-right run))
                             (= (wall-run-shade old) (wall-run-shade run)))
                        (setf (wall-run-bottom old) (1+ y)))
                       (t (push run runs)
                          (setf (svref above (wall-run-left run)) run))))))
    runs))

(defun draw-walls (canvas map window)
  (let ((by-shade (make-array 64 :initial-element '())))
    (dolist (run (wall-runs map window in-color*))
      (setf (svref by-shade (wall-run-shade run))
            (list* (* graphics-scale* (wall-run-left run))
                   (* graphics-scale* (wall-run-top run))
                   (* graphics-scale* (- (wall-run-right run) (wall-run-left run)))
                   (* graphics-scale* (- (wall-run-bottom run) (wall-run-top run)))
                   (svref by-shade (wall-run-shade run)))))
    (loop for rectangles across by-shade
          for shade from 0
          when rectangles
            do (with-color (svref grey* shade)
                 (draw-rectangles canvas draw-gcontext* rectangles t)))))

;;; Graphics bodies are user code: one that fails is reported once, and drawn as a mark.

(defvar *broken-graphics* (make-hash-table :test #'eq :weakness :key :synchronized t)
  "The functions that have signalled an error.")

(defun draw-mark (canvas x y width height)
  "Draw what stands for graphics that cannot be drawn: a crossed box."
  (with-color (svref red* 11)
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

(defun draw-place (canvas type column row)
  (let ((x (* column graphics-scale*)) (y (* row graphics-scale*)))
    (draw-by-user canvas (place-type-graphics type)
                  (list "the :graphics of place type " (place-type-name type))
                  x y graphics-scale* graphics-scale* x y)))

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

(defun draw-terrain (canvas map &key left top right bottom)
  "Draw the walls of MAP in black, or in greys by their substance parameters, and the marks of its
places, on CANVAS, GRAPHICS-SCALE* pixels to a cell (manual B). LEFT, TOP, RIGHT and BOTTOM, columns
and rows of cells, say which part of MAP is wanted; by default all of it is."
  (let ((window (clip-window map left top right bottom)))
    (draw-walls canvas map window)
    (draw-places canvas map window)))
