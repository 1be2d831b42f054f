;;;; trying-places.lisp -- small maps on which the code of a place type is tried.

(in-package :ars-magna.world)

;;; A checker or :directions form that does not work would show only when a map is built, perhaps
;;; much later. So each is tried when it is defined: a checker on a sample of walls, the rules on
;;; maps made of their own match forms. What the code needs may be defined later in its file: a
;;; function or variable that is missing is no trouble yet.

(defparameter *sample*
  '("###########"
    "#.........#"
    "#.#.###.#.#"
    "#...#.....#"
    "#.###.###.#"
    "#.......#.#"
    "###.#####.#"
    "#.....#...#"
    "#.#.......#"
    "#...#..#..#"
    "###########")
  "Walls with doorways, corners, posts and ends of walls.")

(defun small-map (width height filled-p)
  "Return a map in which the cells for which FILLED-P of column and row is true are walls."
  (let ((map (%make-map :name 'sample :width width :height height)))
    (clear-grid map)
    (dotimes (y height)
      (dotimes (x width)
        (when (funcall filled-p x y)
          (setf (aref (map-flags map) (+ x (* y width))) +wall+))))
    (clear-places map)
    map))

(defun rule-map (rule)
  "Return a map with the walls of RULE and room for the place beside them."
  (multiple-value-bind (width height) (form-size (rule-form rule))
    (let ((margin (1+ (max (abs (rule-dx rule)) (abs (rule-dy rule))))))
      (small-map (+ width (* 2 margin)) (+ height (* 2 margin))
                 (lambda (x y)
                   (let ((row (- y margin)) (column (- x margin)))
                     (and (< -1 row height) (< -1 column width)
                          (eq t (nth column (nth row (rule-form rule)))))))))))

(defun try-on (type map)
  "Classify MAP by TYPE alone, and ask for the directions of a place that was found."
  (setf (map-place-types map) (vector nil type))
  (classify-by-type map type 1 (neighbourhood-codes map))
  (check-directions map type 1))

(defun try-place-type (type)
  "Signal MALFORMED-DEFINITION if the code of TYPE does not return what it should."
  (handler-case
      (mapc (lambda (map) (try-on type map))
            (if (place-type-checker type)
                (list (small-map (length (first *sample*)) (length *sample*)
                                 (lambda (x y) (char= #\# (char (nth y *sample*) x)))))
                (mapcar #'rule-map (place-type-rules type))))
    ((or undefined-function unbound-variable) () nil)))
