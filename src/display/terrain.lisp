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

(defun row-runs (map y in-color)
  "Return the runs of walls in the row Y of MAP, from left to right."
  (declare (type map map) (type fixnum y))
  (let ((flags (map-flags map)) (width (map-width map)) (runs '()) (run nil))
    (dotimes (x width (nreverse runs))
      (let* ((index (+ x (* y width)))
             (shade (and (logtest +wall+ (aref flags index))
                         (if in-color (wall-shade map index) 0))))
        (cond ((null shade) (setf run nil))
              ((and run (= shade (wall-run-shade run))) (setf (wall-run-right run) (1+ x)))
              (t (push (setf run (make-wall-run x (1+ x) y (1+ y) shade)) runs)))))))

(defun wall-runs (map in-color)
  "Return rectangles that together are all walls of MAP."
  (let ((above (make-array (map-width map) :initial-element nil)) (runs '()))
    (dotimes (y (map-height map) runs)
      (dolist (run (row-runs map y in-color))
        (let ((old (svref above (wall-run-left run))))
          (cond ((and old (= (wall-run-bottom old) y)
                      (= (wall-run-right old) (wall-run-right run))
                      (= (wall-run-shade old) (wall-run-shade run)))
                 (setf (wall-run-bottom old) (1+ y)))
                (t (push run runs)
                   (setf (svref above (wall-run-left run)) run))))))))

(defun draw-walls (canvas map)
  (let ((by-shade (make-array 64 :initial-element '())))
    (dolist (run (wall-runs map in-color*))
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
of items, says whose it is."
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

(defun draw-places (canvas map)
  "Mark the cells of MAP that are places of visible types which have graphics (manual B)."
  (let ((types (map-place-types map)) (places (map-places map)) (width (map-width map)))
    (flet ((drawn-p (type)
             (and type (place-type-graphics type) (not (place-type-invisible-p type)))))
      (loop for number across places
            for index of-type fixnum from 0
            unless (zerop number)
              do (let ((type (svref types number)))
                   (when (drawn-p type)
                     (multiple-value-bind (row column) (floor index width)
                       (draw-place canvas type column row))))))))

(defun draw-terrain (canvas map)
  "Draw the walls of MAP in black, or in greys by their substance parameters, and the marks of its
places, on CANVAS, GRAPHICS-SCALE* pixels to a cell (manual B)."
  (draw-walls canvas map)
  (draw-places canvas map))
