;;;; names.lisp -- what things and robots are called, written beside them where there is room.

(in-package :ars-magna.display)

;;; A box is a list (left top right bottom) in pixels. A name is written near by where its box meets
;;; no wall, thing, robot or other name, and rather no mark of a place; if there is no such room,
;;; not at all. Robots come first, then large things.

(define-constant +name-size+ 10 :documentation "How high the font of names is, in pixels.")
(define-constant +name-height+ 11 :documentation "How high the box of a name is, in pixels.")

(defun overlap-p (a b)
  "True if the boxes A and B, lists (left top right bottom), overlap."
  (and (< (first a) (third b)) (< (first b) (third a))
       (< (second a) (fourth b)) (< (second b) (fourth a))))

(defun box-around (x y half)
  "Return the box that reaches HALF from X, Y to each side."
  (list (- x half) (- y half) (+ x half) (+ y half)))

(defun name-boxes (x y half width)
  "Return boxes for a name WIDTH pixels wide beside what reaches HALF pixels from X, Y: the best
first."
  (let ((gap (+ half 2)) (high +name-height+))
    (loop for (left top) in (list (list (+ x gap) (- y (/ high 2)))
                                  (list (- x gap width) (- y (/ high 2)))
                                  (list (- x (/ width 2)) (- y gap high))
                                  (list (- x (/ width 2)) (+ y gap))
                                  (list (+ x (/ gap 2)) (- y gap high))
                                  (list (+ x (/ gap 2)) (+ y gap))
                                  (list (- x (/ gap 2) width) (- y gap high))
                                  (list (- x (/ gap 2) width) (+ y gap)))
          collect (list left top (+ left width) (+ top high)))))

(defun on-map-p (map box)
  (destructuring-bind (left top right bottom) box
    (and (<= 0 left) (<= 0 top)
         (<= right (to-pixels (map-width map))) (<= bottom (to-pixels (map-height map))))))

(defun cells-below (map box function)
  "True if FUNCTION, of the index of a cell, is true for one of the cells of MAP that BOX, which is
on it, meets."
  (destructuring-bind (left top right bottom) box
    (flet ((cell (pixels limit) (min (floor pixels graphics-scale*) (1- limit))))
      (let ((width (map-width map)) (height (map-height map)))
        (loop for row from (cell top height) to (cell (- bottom 1/100) height)
                thereis (loop for column from (cell left width) to (cell (- right 1/100) width)
                                thereis (funcall function (+ column (* row width)))))))))

(defun on-wall-p (map box)
  (cells-below map box (lambda (index) (logtest +wall+ (aref (map-flags map) index)))))

(defun on-place-p (map box)
  (cells-below map box (lambda (index) (plusp (aref (map-places map) index)))))

(defun best-box (map boxes taken)
  "Return the first of BOXES that is on MAP and meets no wall and none of TAKEN, and rather no
place; or NIL."
  (let ((free (remove-if-not (lambda (box)
                               (and (on-map-p map box)
                                    (notany (lambda (other) (overlap-p box other)) taken)
                                    (not (on-wall-p map box))))
                             boxes)))
    (or (find-if-not (lambda (box) (on-place-p map box)) free)
        (first free))))

(defun named-spots (snapshot)
  "Return lists (name x y half) of what has a name on the map, in order of importance."
  (append (loop for robot in (snapshot-robots snapshot)
                collect (list (string-downcase (robot-image-name robot))
                              (to-pixels (robot-image-x robot)) (to-pixels (robot-image-y robot))
                              (* 8/5 (robot-radius))))
          (loop for image in (stable-sort (coerce (snapshot-things snapshot) 'list) #'>
                                          :key #'thing-image-size)
                collect (list (thing-image-name image)
                              (to-pixels (thing-image-x image)) (to-pixels (thing-image-y image))
                              (half-width image)))))

(defun thing-image-name (image)
  (string-downcase (thing-name (thing-image-thing image))))

(defun write-name (canvas name box)
  (with-color black*
    (draw-words canvas draw-gcontext* (+ 1 (first box)) (- (fourth box) 2) name
                :size +name-size+)))

(defun draw-names (canvas snapshot &optional boxes)
  "Write the names of robots and things where there is room, and none of BOXES."
  (let* ((map (snapshot-map snapshot)) (spots (named-spots snapshot))
         (per-character (character-width canvas +name-size+))
         (taken (append boxes
                        (loop for (nil x y half) in spots collect (box-around x y half)))))
    (loop for (name x y half) in spots
          for width = (+ 2 (* per-character (length name)))
          for box = (best-box map (name-boxes x y half width) taken)
          when box
            do (push box taken)
               (write-name canvas name box))))
