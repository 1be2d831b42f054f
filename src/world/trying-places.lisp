;;;; trying-places.lisp -- small maps on which a place type is tried, and forms that are in vain.

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

;;; Match forms that can never make a place, as their author should be told.

;;; A place is a free cell, and is of the type that was defined first. So a form in which the place
;;; itself is a wall is in vain, and so is a type all of whose forms fit only what is taken.

(defun walled-p (rule)
  "True if RULE wants a wall where it has the place."
  (multiple-value-bind (width height) (form-size (rule-form rule))
    (let ((column (+ (rule-dx rule) (floor width 2))) (row (+ (rule-dy rule) (floor height 2))))
      (and (< -1 column width) (< -1 row height)
           (eq t (nth column (nth row (rule-form rule))))))))

(defun form-text (form)
  "Return FORM in the abbreviations of manual 5.1.1."
  (format nil "(~{(~{~A~^ ~})~^ ~})"
          (loop for row in form
                collect (loop for entry in row
                              collect (case entry ((t) "*") ((nil) "-") (t "x"))))))

(defun warn-of-walled (definition rule)
  (let ((dx (rule-dx rule)) (dy (rule-dy rule)))
    (warn-of-definition "~A: the match form ~A can never fit a place, as ~A is a wall, and only ~
                         free cells are places; write - there, or give the free cell beside it ~
                         that is the place: (match-form direction dx dy)"
                        definition (form-text (rule-form rule))
                        (if (= 0 dx dy)
                            "its middle"
                            (format nil "the cell ~D ~D from its middle" dx dy)))))

;;; What is taken.

(defun free-codes (rule)
  "Return the codes of the neighbourhoods, around a free cell, that RULE, which is small, fits."
  (multiple-value-bind (mask value) (form-bits (rule-form rule))
    (loop for code below 512
          when (and (= value (logand code mask)) (not (logbitp 4 code))) collect code)))

(defun taker (code types)
  "Return the first of TYPES that takes a cell with the neighbourhood CODE for itself, or NIL."
  (find-if (lambda (type)
             (let ((number (if (place-type-table type) (aref (place-type-table type) code) 0)))
               (and (plusp number)
                    (let ((rule (nth (1- number) (place-type-rules type))))
                      (= 0 (rule-dx rule) (rule-dy rule))))))
           types))

(defun takers (rules types)
  "Return those of TYPES that take all that RULES fit; NIL if something is left."
  (let ((takers '()))
    (dolist (rule rules takers)
      (unless (= 0 (rule-dx rule) (rule-dy rule)) (return '()))
      (dolist (code (free-codes rule))
        (pushnew (or (taker code types) (return-from takers '())) takers)))))

(defun warn-of-taken (definition type)
  "Warn if types defined before TYPE leave nothing for it."
  (let* ((types (registry-objects *place-types*))
         (rules (remove-if #'walled-p (place-type-rules type)))
         (takers (and (place-type-table type)
                      (takers rules (ldiff types (member type types))))))
    (when takers
      (doubt-definition "~A: all that it fits is of the type ~{~(~A~)~^ or ~} already; what was ~
                         defined before wins; to let this one win, say :before ~(~A~)"
                        definition (mapcar #'place-type-name takers)
                        (place-type-name (find-if (lambda (other) (member other takers))
                                                  types))))))

(defun warn-of-vain-rules (definition type)
  "Warn of what in TYPE, which has been registered, can never make a place."
  (mapc (lambda (rule) (warn-of-walled definition rule))
        (remove-if-not #'walled-p (place-type-rules type)))
  (warn-of-taken definition type))
