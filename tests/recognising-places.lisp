;;;; recognising-places.lisp -- places recognised by what cameras see, and the way back by views.

(in-package :ars-magna.tests)

(def-suite* recognising-places :in ars-magna)

(defun random-signature (dice &rest sizes)
  "Return a round signature with a strip of random pixels for each of SIZES."
  (cons :round (loop for size in sizes
                     collect (loop repeat size collect (base:roll-between 0 20 dice)))))

(defun turned-signature (signature count)
  "Return what SIGNATURE, of one strip, is after the robot has turned right by COUNT pixels."
  (let ((strip (second signature)))
    (list :round (append (nthcdr count strip) (subseq strip 0 count)))))

(defun same-angle-p (angle other)
  (< (abs (geo:angle-difference angle other)) 1d-9))

;;; The match.

(test signature-match.of-equal-signatures-is-one
  (dolist (signature '((:round (1 2 3)) (:round (1.5d0) (7 8)) (:fixed (4 4) (5))))
    (is (every #'= '(1 0) (multiple-value-list
                           (ars-worlds:signature-match signature signature))))))

(test signature-match.finds-the-turn
  (let ((signature (random-signature (base:make-dice 1) 36)))
    (loop for count from 0 below 36
          do (multiple-value-bind (match turn)
                 (ars-worlds:signature-match (turned-signature signature count) signature)
               (is (= 1 match))
               (is (same-angle-p turn (* count (/ (* 2 pi) 36))))))))

(test signature-match.of-fixed-signatures-depends-on-heading
  (is (= 0 (ars-worlds:signature-match '(:fixed (0 50)) '(:fixed (50 0)))))
  (is (= 1 (ars-worlds:signature-match '(:round (0 50)) '(:round (50 0))))))

(test signature-match.is-proportional-up-to-the-tolerance
  (let ((ars-worlds:pixel-tolerance* 4))
    (loop for (pixel match) in '((10 1) (11 3/4) (8 1/2) (14 0) (-90 0))
          do (is (= match (ars-worlds:signature-match `(:fixed (,pixel)) '(:fixed (10))))))))

(test signature-match.weighs-all-pixels-alike
  (is (= 3/4 (ars-worlds:signature-match '(:fixed (1 2 3) (99)) '(:fixed (1 2 3) (4))))))

(test signature-match.is-symmetric-and-bounded
  (let ((dice (base:make-dice 2)))
    (loop repeat 100
          for sizes = (list (+ 1 (base:roll-index 9 dice)) (+ 1 (base:roll-index 9 dice)))
          for a = (apply #'random-signature dice sizes)
          for b = (apply #'random-signature dice sizes)
          do (multiple-value-bind (match turn) (ars-worlds:signature-match a b)
               (multiple-value-bind (converse back) (ars-worlds:signature-match b a)
                 (is (<= 0 match 1))
                 (is (< (abs (- match converse)) 1d-12))
                 (when (< (abs turn) 3) (is (same-angle-p turn (- back)))))))))

(test signature-match.of-several-cameras-turns-them-together
  (let ((signature '(:round (1 2 3 4 5 6 7 8) (10 20 30 40))))
    (multiple-value-bind (match turn)
        (ars-worlds:signature-match '(:round (3 4 5 6 7 8 1 2) (20 30 40 10)) signature)
      (is (= 1 match))
      (is (same-angle-p turn (/ pi 2))))
    (is (> 1 (ars-worlds:signature-match '(:round (3 4 5 6 7 8 1 2) (10 20 30 40)) signature)))))

;;; What noise does to the match. Both signatures err by at most E, uniformly.

(defun expected-match (e)
  "Return the expected match of a pixel with itself; the tolerance is 5."
  (cond ((zerop e) 1)
        ((<= (* 2 e) 5) (- 1 (/ (* 2 e) 15)))
        (t (- (/ 5 (* 2 e)) (/ 25 (* 12 e e))))))

(defun mean-match (error pairs)
  "Return the mean match of PAIRS of views that a camera takes of the same scene."
  (with-watcher (:parameters `((base:pixel-error-range* ,error) (base:pixel-outlier-prob* 0)))
    (/ (loop repeat pairs
             sum (ars-worlds:signature-match (list :fixed (view)) (list :fixed (view))))
       pairs)))

(test signature-match.falls-with-noise-as-a-formula-says
  (loop for (e match) in '((0 1) (1 13/15) (5/2 2/3) (5 5/12))
        do (is (= match (expected-match e))))
  (is (= 1 (mean-match 0 3)))
  (dolist (e '(1 2 5/2 4 10))
    (let ((mean (mean-match e 300)))
      (is (< (abs (- mean (expected-match e))) .025) "~A for an error of ~A" mean e))))

(test signature-match.without-noise-is-one
  (run:with-simulation (ars-worlds:dot :clean t)
    (let ((first (driver:run-plan 'ars-worlds:take-round-signature)))
      (is (= 20 (length (second first))))
      (is (= 1 (ars-worlds:signature-match (driver:run-plan 'ars-worlds:take-round-signature)
                                           first))))))

;;; Places.

(defun recognised (signature places &rest options)
  "Return what RECOGNISE-PLACE returns, as a list, its numbers rounded to thousandths."
  (mapcar (lambda (value) (if (realp value) (/ (round value 1/1000) 1000) value))
          (multiple-value-list (apply #'ars-worlds:recognise-place signature :places places
                                      options))))

(defparameter *three-places*
  '((hall (:round (10 10 20 30))) (lab (:round (10 10 20 33)) (:round (70 70 70 70)))
    (den (:round (50 60 70 80)))))

(test recognise-place.returns-the-best-and-the-runner-up
  (is (equal '(hall 1 0 lab 17/20) (recognised '(:round (10 10 20 30)) *three-places*)))
  (is (equal '(hall 1 1571/1000 lab 17/20) (recognised '(:round (10 20 30 10)) *three-places*)))
  (is (equal '(lab 1 0 den 1/4) (recognised '(:round (70 70 70 70)) *three-places*)))
  (is (equal '(den 1 0 nil 0)
              (recognised '(:round (50 60 70 80)) (last *three-places*)))))

(test recognise-place.rejects-what-matches-too-badly
  (is (equal '(nil 1/2) (subseq (recognised '(:round (10 10 0 0)) *three-places*) 0 2)))
  (is (eq 'hall (first (recognised '(:round (10 10 0 0)) *three-places* :threshold 1/2))))
  (is (equal '(nil 0 0 nil 0) (recognised '(:round (1)) '())))
  (is (null (first (recognised '(:round (1)) '() :threshold 0)))))

(test add-place.changes-no-other-set
  (let* ((one (ars-worlds:add-place 'den '(:fixed (1)) '()))
         (two (ars-worlds:add-place 'den '(:fixed (2)) one))
         (three (ars-worlds:add-place "den" '(:fixed (3)) two)))
    (is (equal '((den (:fixed (1)))) one))
    (is (equal '((den (:fixed (1)) (:fixed (2)))) two))
    (is (equal '((den (:fixed (1)) (:fixed (2))) ("den" (:fixed (3)))) three))))

;;; In a run.

(test known-places.belong-to-the-run
  (run:with-simulation (ars-worlds:dot :clean t :keep t)
    (is (eq 'a (ars-worlds:learn-place 'a '(:fixed (1)))))
    (run:run-ticks 1)
    (let ((digest (run:state-digest)))
      (run:with-fork ()
        (ars-worlds:learn-place 'b '(:fixed (9)))
        (is (eq 'b (ars-worlds:recognise-place '(:fixed (9))))))
      (is (equal '((a (:fixed (1)))) ars-worlds:*known-places*))
      (ars-worlds:learn-place 'c '(:fixed (9)))
      (run:run-ticks 5)
      (is (eq 'c (ars-worlds:recognise-place '(:fixed (9)))))
      (run:rewind 5)
      (is (null (ars-worlds:recognise-place '(:fixed (9)))))
      (is (equal digest (run:state-digest)))))
  (run:with-simulation (ars-worlds:dot) (is (null ars-worlds:*known-places*))))

(rpl:def-interp-proc learn-and-return (headings)
  "Learn two places in OFFICE; return what is recognised at the first one with each of HEADINGS."
  (let ((found '()))
    (ars-worlds:learn-place 'library
                            (progn (robot:place-robot (driver:rpl-robot) 74 26 0)
                                   (ars-worlds:take-round-signature)))
    (ars-worlds:learn-place 'canteen
                            (progn (robot:place-robot (driver:rpl-robot) 14 50 0)
                                   (ars-worlds:take-round-signature)))
    (dolist (heading headings)
      (robot:place-robot (driver:rpl-robot) 74.1 25.9 heading)
      (multiple-value-bind (name match turn)
          (ars-worlds:recognise-place (ars-worlds:take-round-signature))
        (push (list name (> match .55)
                    (< (abs (geo:angle-difference turn heading)) .2))
              found)))
    (robot:place-robot (driver:rpl-robot) 52 10 0)
    (list found (ars-worlds:recognise-place (ars-worlds:take-round-signature)))))

(test recognise-place.in-any-heading-and-nowhere-else
  (run:with-simulation (ars-worlds:marvin :seed 1)
    (is (equal (list (make-list 3 :initial-element '(library t t)) nil)
               (driver:run-plan 'learn-and-return '(0 1.1 2.5))))))

(test take-signature.is-of-the-cameras-as-they-point
  (run:with-simulation (ars-worlds:marvin :clean t)
    (destructuring-bind (kind . views) (driver:run-plan 'ars-worlds:take-signature '(2 0))
      (is (eq :fixed kind))
      (is (equal views (list (robot:camera-last-view (robot:robot-camera ars-worlds:marvin 2))
                             (robot:camera-last-view (robot:robot-camera ars-worlds:marvin 0))))))
    (is (equal '(40 36 36) (mapcar #'length
                                   (rest (driver:run-plan 'ars-worlds:take-round-signature)))))))

;;; Mistakes.

(world:defmap cell-of-squinter (6 6))
(robot:defrobot squinter (cell-of-squinter (3.5 3.5) 0) :cameras ((2 5)))

(test recognising.rejects-wrong-arguments
  (loop for (function . words)
          in `((,(lambda () (ars-worlds:signature-match '(:square (1)) '(:round (1))))
                "signature" "(:SQUARE (1))" "(:round view...)")
               (,(lambda () (ars-worlds:signature-match '(:round (1)) '(:round . 2))) ":round")
               (,(lambda () (ars-worlds:signature-match '(:round (1 a)) '(:round (1 2)))) "a list")
               (,(lambda () (ars-worlds:signature-match '(:round (1 2)) '(:round (1 2 3))))
                "of the same cameras" "3 pixels")
               (,(lambda () (ars-worlds:signature-match '(:round (1)) '(:fixed (1)))) ":fixed")
               (,(lambda () (ars-worlds:add-place nil '(:fixed (1)) '())) "name")
               (,(lambda () (ars-worlds:add-place 'a '(:fixed) '())) "signature")
               (,(lambda () (ars-worlds:add-place 'a '(:fixed (1)) '((b (:fixed (1 2))))))
                "the same cameras")
               (,(lambda () (ars-worlds:recognise-place '(:fixed (1)) :places '((a)))) ":places")
               (,(lambda () (ars-worlds:recognise-place '(:fixed (1)) :places '() :threshold 2))
                ":threshold" "0 to 1"))
        for text = (text-of-error function)
        do (dolist (word words) (is (search word text) "~A lacks ~A" text word))))

(test take-round-signature.needs-a-field-that-divides-a-circle
  (let ((failure (run:with-simulation (squinter)
                   (driver:run-plan 'ars-worlds:take-round-signature))))
    (is (search "divides a circle" (princ-to-string failure)))))

;;; The way back.

(defparameter *bad-wheels* '((base:motion-noise* .5) (base:robot-turn-max-error* .1)))

(defun way-back (seed &key (between (constantly nil)) (places 6))
  "Let MARVIN explore, call BETWEEN, and let MARVIN return. Return how far it was and is from its
start, and its position."
  (run:with-simulation (ars-worlds:marvin :seed seed :parameters *bad-wheels*)
    (flet ((distance ()
             (ars-worlds::vector-length (- (robot:robot-x ars-worlds:marvin) 62)
                                        (- (robot:robot-y ars-worlds:marvin) 38))))
      (driver:run-plan 'ars-worlds:explore-by-views :places places)
      (let ((far (distance)))
        (funcall between)
        (driver:run-plan 'ars-worlds:return-by-views)
        (list far (distance) (multiple-value-list (robot:robot-position ars-worlds:marvin)))))))

(test return-by-views.brings-the-robot-back-with-bad-wheels
  (destructuring-bind (far near position) (way-back 101)
    (declare (ignore position))
    (is (< 5 far))
    (is (< near 3))))

(test return-by-views.uses-no-odometer
  (flet ((forget-position ()
           (robot:reset-odometer (robot:robot-main-odometer ars-worlds:marvin))))
    (is (equal (way-back 102 :places 4)
               (way-back 102 :places 4 :between #'forget-position)))))

(test ways.lead-by-the-fewest-steps
  (run:with-simulation (ars-worlds:dot)
    (setf ars-worlds:*known-ways* '((0 0 1) (1 0 2) (2 0 3) (0 1 4) (4 1 3) (4 2 nil)))
    (is (equal '(0 1 4) (ars-worlds::first-way 0 (lambda (place) (eql place 3)))))
    (is (equal '(0 0 1) (ars-worlds::first-way 0 (lambda (place) (eql place 2)))))
    (is (null (ars-worlds::first-way 3 (lambda (place) (eql place 0)))))))

(test ways.lead-between-places-with-names-of-all-kinds
  (run:with-simulation (ars-worlds:dot)
    (setf ars-worlds:*known-ways* '(("a" 0 b) (b 0 "c") ("c" 0 "a")))
    (is (equal '("a" 0 b) (ars-worlds::first-way "a" (lambda (place) (equal place "c")))))))

(defun explored (seed &rest options)
  "Let PORTER learn its start as the place 1, and explore with OPTIONS. Return the names of the
places that it knows then."
  (run:with-simulation (ars-worlds:porter :seed seed)
    (driver:run-plan (rpl:interp-lambda ()
                       (ars-worlds:learn-place 1 (ars-worlds:take-round-signature))))
    (apply #'driver:run-plan 'ars-worlds:explore-by-views options)
    (mapcar #'first ars-worlds:*known-places*)))

(test explore-by-views.gives-each-place-a-number-of-its-own
  (is (equal '(1 2 3) (explored 1 :places 3 :threshold .99))))

(test explore-by-views.learns-the-more-places-the-higher-the-threshold
  (flet ((known (threshold) (length (explored 1 :places 3 :threshold threshold))))
    (is (= 1 (known 0)))
    (is (= 3 (known 1)))))

(defun failure-of-plan (robot name &rest arguments)
  "Return the text of the failure of the plan NAME with ARGUMENTS on ROBOT, which knows place A."
  (run:with-simulation (robot)
    (ars-worlds:learn-place 'a '(:round (1 2 3)))
    (princ-to-string (apply #'driver:run-plan name arguments))))

(robot:defrobot blind-robot (cell-of-squinter (3.5 3.5) 0))

(test finding-back.rejects-wrong-arguments
  (loop for (robot name arguments . words)
          in '((ars-worlds:dot ars-worlds:explore-by-views (:places 0) ":places" "from 1")
               (ars-worlds:dot ars-worlds:explore-by-views (:step -1) ":step" "above 0")
               (ars-worlds:dot ars-worlds:explore-by-views (:cameras 0) "one or more indices")
               (blind-robot ars-worlds:explore-by-views () "one or more indices" "has 0")
               (blind-robot ars-worlds:take-signature () "one or more indices")
               (ars-worlds:dot ars-worlds:return-by-views (:to b) ":to is B" "one of A")
               (ars-worlds:dot ars-worlds:return-by-views (:to a :step 0) ":step")
               (ars-worlds:dot ars-worlds:return-by-views (:to a :patience 1/2) ":patience"))
        for text = (apply #'failure-of-plan robot name arguments)
        do (dolist (word words) (is (search word text) "~A lacks ~A" text word)))
  (let ((text (princ-to-string (run:with-simulation (ars-worlds:dot)
                                 (driver:run-plan 'ars-worlds:return-by-views)))))
    (is (search "none is known before explore-by-views" (string-downcase text)))))
