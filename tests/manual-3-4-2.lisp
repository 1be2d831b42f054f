;;;; manual-3-4-2.lisp -- section 3.4.2 of the manual: matching, noise and description of objects.

(in-package :ars-test-manual)
(in-readtable :nisp)

(def-suite* manual-3-4-2 :in ars-magna)

;;; Specifications, without noise.

(defun fits-p (specification &rest attributes)
  "True if a clean search by SPECIFICATION finds a thing with ATTRIBUTES, keys and values."
  (with-scout (:clean t)
    (apply #'put-beside 'ball 5 0 attributes)
    (and (look specification) t)))

(defun matches-just-p (specification low high)
  "True if SPECIFICATION is met by sizes from LOW to HIGH, cleanly, and by no others."
  (equal '(nil t t nil)
         (loop for size in (list (- low 1/100) low high (+ high 1/100))
               collect (fits-p (list specification) :size size))))

(test manual-3-4-2.a-value-stands-for-itself
  "3.4.2: (:color red) specifies objects whose color is red."
  (is-true (fits-p '((:color red)) :color 'red))
  (is (not (fits-p '((:color red)) :color 'lightred))))

(test manual-3-4-2.a-list-of-values-stands-for-any-of-them
  "3.4.2: (:color (green blue)) specifies green or blue objects."
  (loop for (color fits) in '((green t) (blue t) (red nil))
        do (is (eq fits (fits-p '((:color (green blue))) :color color)))))

(test manual-3-4-2.a-number-matches-within-the-default-threshold
  "3.4.2 and 4: (:size 4) with the standard-match-threshold* of 0.5."
  (is-true (matches-just-p '(:size 4) 7/2 9/2)))

(test manual-3-4-2.the-default-threshold-can-be-set
  "3.4.2: it is used where none is specified, and only there."
  (let ((standard-match-threshold* 1/4))
    (is-true (matches-just-p '(:size 4) 15/4 17/4))
    (is-true (matches-just-p '(:size 4 2) 2 6))))

(test manual-3-4-2.a-range-matches-what-is-in-it
  "3.4.2, reading 125: (:size (3 5)), widened by the default threshold as well."
  (is-true (matches-just-p '(:size (3 5)) 5/2 11/2)))

(test manual-3-4-2.a-third-element-is-the-threshold
  "3.4.2: (:size 4 2) is between 2 and 6, (:size (3 5) 2) between 1 and 7."
  (loop for (specification low high) in '(((:size 4 2) 2 6) ((:size (3 5) 2) 1 7)
                                          ((:size (3 5) 0) 3 5) ((:size 4 0) 4 4))
        do (is-true (matches-just-p specification low high))))

(test manual-3-4-2.all-attributes-specified-must-match
  "3.4.2: the values of all of them; none fits the specification of nothing too."
  (loop for (specification fits) in '((((:size 4) (:color red)) t) (((:size 4)) t) (() t)
                                      (((:size 4) (:color blue)) nil)
                                      (((:size 2) (:color red)) nil))
        do (is (eq fits (fits-p specification :size 4 :color 'red)))))

(test manual-3-4-2.a-descriptor-must-have-a-value
  "3.4.2: for each attribute specified; what an object does not have matches no value."
  (is (not (fits-p '((:size (-99 99))) :color 'red)))
  (is (not (fits-p '((:color (red green blue violet))) :size 4)))
  (is (not (fits-p '((:shape cube)) :size 4))))

(test manual-3-4-2.false-is-a-value
  "Readings 122 and 123: (:obsview #f) asks for what obstructs nothing, said or not."
  (loop for (value . attributes) in '((nil) (nil :obsview nil) (t :obsview t))
        do (is (eq (not value) (apply #'fits-p '((:obsview #f)) attributes)))
           (is (eq value (apply #'fits-p '((:obsview #t)) attributes)))
           (is-true (apply #'fits-p '((:obsview (#t #f))) attributes))))

(test manual-3-4-2.a-list-is-read-by-the-kind-of-attribute
  "Reading 124: two numbers are a range, also for an attribute that is not defined."
  (is-true (fits-p '((:lock-id (7 9))) :lock-id 8))
  (is-true (fits-p '((:shape (cube cylinder))) :shape 'cylinder))
  (is (not (fits-p '((:shape (cube cone))) :shape 'cylinder))))

(test manual-3-4-2.substances-match-by-type-and-number
  "Reading 64: a symbol matches the type, a number the parameter."
  (loop for (specification fits) in '(((:substance wood) t) ((:substance (metal wood)) t)
                                      ((:substance metal) nil) ((:substance 7) t)
                                      ((:substance (5 9)) t) ((:substance 120) nil))
        do (is (eq fits (fits-p (list specification) :substance '(wood 7))))))

(test manual-3-4-2.nonsense-is-refused-at-once
  "3.4.2: an invalid specification is an error in the calling program."
  (with-scout ()
    (dolist (nonsense '(red (:color red) ((:color)) ((:size red)) ((:size 4 -1)) ((:size (5 3)))
                        ((:size (3 4 5))) ((:color purple)) ((:size 4 1 1)) (("size" 4))))
      (signals wrong-argument
        (camera-get-object-designator (eye) :non-local nonsense)
        "~S was accepted" nonsense))))

(test manual-3-4-2.matching-happens-at-acquisition
  "3.4.2, footnote, reading 226: a track goes on when its object is altogether different."
  (at-each-spot (:clean t)
    (let* ((ball (put-beside 'ball 5 0 :color 'red :size 3)) (designator (look '((:color red)))))
      (tracking (record designator)
        (let ((data !>designator.data))
          (change-attribute ball '((:color blue) (:size 9)))
          (move-thing ball (beside 5 1))
          (run-ticks 20)
          (is (equal '(nil) (codes (record))))
          (is (equal data !>designator.data))
          (is (eq 'red (reading-of :color designator))))))))

;;; Noise of discrete attributes.

(defun reliability (p distance &optional (factor .1d0))
  "Return the probability that an attribute with the base probability P is read right."
  (/ p (max 1 (* factor distance (- 1 p)))))

(defun color-readings (trials distance &rest parameters)
  "Return the colors read of a blue ball DISTANCE metres from (2,15), of as many searches as find
it; all would."
  (with-scout (:seed (round (* 10 distance)) :parameters (append parameters *sure*))
    (place-robot scout 2 15 0)
    (put-beside 'ball distance 0 :color 'blue)
    (look-often trials (lambda (found) (reading-of :color found))
                :specification '((:color (red green blue violet
                                          lightred lightblue lightgreen lightviolet))))))

(test manual-3-4-2.discrete-noise-by-distance
  "3.4.2, reading 115: right with p / max(1, f d (1-p)); for a color p is 0.4, so it is level up
to 16.7 metres. A wrong reading is right by luck once in eight."
  (loop for distance in '(3 10.25 16.5 20.37 27)
        for right = (reliability .4d0 distance)
        do (is (frequent-p (count 'blue (color-readings 1000 distance))
                           1000 (+ right (/ (- 1 right) 8)))
               "at ~D m" distance)))

(test manual-3-4-2.the-factor-says-where-noise-begins
  "3.4.2: discrete-noise-factor*, f; with 1 readings get worse beyond 1.67 metres."
  (loop for (factor distance) in '((1 1.5) (1 5) (1 20) (0 27))
        for right = (reliability .4d0 distance factor)
        do (is (frequent-p (count 'blue (color-readings 1000 distance
                                                        `(discrete-noise-factor* ,factor)))
                           1000 (+ right (/ (- 1 right) 8)))
               "factor ~D at ~D m" factor distance)))

(test manual-3-4-2.wrong-readings-are-uniform
  "3.4.2: chosen from all possible values, each as likely."
  (let* ((readings (color-readings 2000 20)) (right (reliability .4d0 20))
         (other (/ (- 1 right) 8)))
    ;; 7 degrees of freedom, .001.
    (is (< (chi-square (loop for color in '(blue red green violet lightred lightblue lightgreen
                                            lightviolet)
                             collect (count color readings))
                       (cons (* 2000 (+ right other)) (loop repeat 7 collect (* 2000 other))))
           24.3))))

(test manual-3-4-2.certain-attributes-stay-so
  "3.4.2, reading 115: with p = 1 distance does no harm."
  (with-own-definitions ()
    (defattribute :flag (up down))
    (with-scout (:seed 13 :parameters (cons '(discrete-noise-factor* 99) *sure*))
      (place-robot scout 2 15 0)
      (put-beside 'mast 27 0 :flag 'up)
      (is (= 300 (find-count 300 '((:flag up)))))
      (is (= 0 (find-count 300 '((:flag down))))))))

(test manual-3-4-2.noise-makes-wrong-things-match
  "3.4.2: as often as a blue ball is read as red."
  (with-scout (:seed 14 :parameters *sure*)
    (put-beside 'ball 5 0 :color 'blue)
    (is (frequent-p (find-count 2000 '((:color red))) 2000 (/ .6 8)))))
