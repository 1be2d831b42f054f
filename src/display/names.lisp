;;;; names.lisp -- what things and robots are called, written beside them where there is room.

(in-package :ars-magna.display)

;;; A box is a list (left top right bottom) in pixels. A name is written where its box meets no thing,
;;; robot or name and no wall; if there is no such place near, across walls, on a white plate; if
;;; that does not do either, not at all. Robots come first, then large things.

(define-constant +name-height+ 12 :documentation "How high a name is, in pixels.")

(defun overlap-p (a b)
  (and (< (first a) (third b)) (< (first b) (third a))
       (< (second a) (fourth b)) (< (second b) (fourth a))))

(defun box-around (x y half)
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

(defun on-wall-p (map box)
  "True if BOX, which is on MAP, meets a wall."
  (destructuring-bind (left top right bottom) box
    (flet ((cell (pixels) (floor pixels graphics-scale*)))
      (loop for row from (cell top) to (min (cell (1- bottom)) (1- (map-height map)))
              thereis (loop for column from (cell left) to (min (cell (1- right)) (1- (map-width map)))
                              thereis (logtest +wall+
                                               (aref (map-flags map)
                                                     (+ column (* row (map-width map))))))))))

(defun best-box (map boxes taken)
  "Return the first of BOXES that is on MAP and meets none of TAKEN, and rather no wall; or NIL."
  (let ((free (remove-if-not (lambda (box)
                               (and (on-map-p map box)
                                    (notany (lambda (other) (overlap-p box other)) taken)))
                             boxes)))
    (or (find-if-not (lambda (box) (on-wall-p map box)) free)
        (first free))))

(defun named-spots (snapshot)
  "Return lists (name x y half subject) of what has a name on the map, in order of importance."
  (append (loop for robot in (snapshot-robots snapshot)
                collect (list (string-downcase (robot-image-name robot))
                              (to-pixels (robot-image-x robot)) (to-pixels (robot-image-y robot))
                              (robot-radius)))
          (loop for image in (stable-sort (coerce (snapshot-things snapshot) 'list) #'>
                                          :key #'thing-image-size)
                collect (list (thing-image-name image)
                              (to-pixels (thing-image-x image)) (to-pixels (thing-image-y image))
                              (half-width image)))))

(defun thing-image-name (image)
  (string-downcase (thing-name (thing-image-thing image))))

(defun write-name (canvas map name box)
  (let ((x (+ 1 (first box))) (y (- (fourth box) 2)))
    (with-color black*
      (if (on-wall-p map box)
          (draw-text-on-plate canvas x y name)
          (draw-text canvas x y name)))))

(defun draw-names (canvas snapshot)
  "Write the names of robots and things where there is room."
  (let* ((map (snapshot-map snapshot)) (spots (named-spots snapshot))
         (taken (loop for (nil x y half) in spots collect (box-around x y half))))
    (loop for (name x y half) in spots
          for box = (best-box map (name-boxes x y half (+ 2 (words-width name))) taken)
          when box
            do (push box taken)
               (write-name canvas map name box))))
