;;;; manual-3-4-2-readings.lisp -- section 3.4.2 of the manual: numbers read, and what is noticed.

(in-package :ars-test-manual)
(in-readtable :nisp)

(in-suite manual-3-4-2)

;;; Noise of numeric attributes.

(defun deviation (base multiplier distance &optional (factor .05d0))
  "Return the standard deviation of readings, by the formula of 3.4.2."
  (if (zerop distance)
      base
      (max base (/ (* multiplier base distance) (+ distance factor)))))

(defun size-readings (trials distance &rest parameters)
  "Return the sizes read, in TRIALS searches, of a thing of size 7 DISTANCE metres from (2,15)."
  (with-scout (:seed (round (* 10 distance)) :parameters (append parameters *sure*))
    (place-robot scout 2 15 0)
    (put-beside 'ball distance 0 :size 7)
    (look-often trials (lambda (found) (reading-of :size found))
                :type (if (< distance 1) :local :non-local)
                :specification '((:size (-99 99))))))

(defun normal (mean deviation)
  (lambda (x) (normal-probability (/ (- x mean) deviation))))

(test manual-3-4-2.numeric-noise-by-distance
  "3.4.2, reading 116: gaussian about the truth, with max(s, m s d / (d + f)); a size has the base
deviation .8 and the multiplier 4."
  (loop for distance in '(0 .01 .05 .5 2.75 10 27)
        do (is (same-distribution-p (size-readings 1000 distance)
                                    (normal 7 (deviation .8d0 4 distance)))
               "at ~D m" distance)))

(test manual-3-4-2.the-factor-says-how-steep-noise-grows
  "3.4.2: continuous-noise-factor*, f."
  (loop for (factor distance) in '((5 5) (5 20) (0 1.5))
        do (is (same-distribution-p (size-readings 1000 distance
                                                   `(continuous-noise-factor* ,factor))
                                    (normal 7 (deviation .8d0 4 distance factor)))
               "factor ~D at ~D m" factor distance)))

(test manual-3-4-2.numeric-readings-may-be-negative
  "Reading 225: nothing is cut off."
  (with-scout (:seed 15 :parameters *sure*)
    (put-beside 'ball 5 0 :size .2)
    (let ((sizes (look-often 500 (lambda (found) (reading-of :size found))
                             :specification '((:size (-99 99))))))
      (is (frequent-p (count-if #'minusp sizes) 500
                      (funcall (normal .2 (deviation .8d0 4 5)) 0))))))

(test manual-3-4-2.numbers-match-as-often-as-noise-lets-them
  "3.4.2: for ranges of the text, a thing of size 4 at 5 metres."
  (with-scout (:seed 16 :parameters *sure*)
    (put-beside 'ball 5 0 :size 4)
    (loop with below = (normal 4 (deviation .8d0 4 5))
          for (specification low high) in '(((:size 4) 3.5 4.5) ((:size (3 5)) 2.5 5.5)
                                            ((:size 4 2) 2 6) ((:size (3 5) 2) 1 7))
          do (is (frequent-p (find-count 1000 (list specification)) 1000
                             (- (funcall below high) (funcall below low)))
                 "~S" specification))))

(test manual-3-4-2.undefined-attributes-are-read-as-they-are
  "Reading 124: an attribute that is not defined is never misread."
  (with-scout (:seed 17 :parameters *sure*)
    (put-beside 'ball 5 0 :lock-id 7)
    (is (= 200 (find-count 200 '((:lock-id 7 0)))))))

;;; Instantiated descriptors.

(test manual-3-4-2.what-was-specified-is-reported
  "3.4.2: with the readings that matched (reading 127)."
  (with-scout (:seed 18 :parameters *sure*)
    (put-beside 'ball 5 0 :size 4 :color 'red)
    (let ((found (remove nil (look-often 1000 #'identity
                                         :specification '((:size 4) (:color (red blue)))))))
      (is (< 50 (length found)))
      (is (every (lambda (found) (<= 3.5 (reading-of :size found) 4.5)) found))
      (is (every (lambda (found) (member (reading-of :color found) '(red blue))) found)))))

(defun notice-count (trials key specification)
  "Return in how many of TRIALS clean searches by SPECIFICATION KEY is reported."
  (with-scout (:clean t :seed 19)
    (put-beside 'box 5 0 :size 3 :weight 2 :capacity 4 :substance 9 :color 'red)
    (count t (look-often trials (lambda (found) (nth-value 1 (reading-of key found)))
                         :specification specification))))

(test manual-3-4-2.attributes-are-noticed-by-chance
  "3.4.2: an unspecified one with its base probability, unless a supporter is specified."
  (dolist (key '(:capacity :size :weight :color :substance :obsview))
    (let ((p (attribute-noticed (find-attribute key))))
      (is (< 0 p 1))
      (is (frequent-p (notice-count 1000 key '()) 1000 p) "~A" key))))

(test manual-3-4-2.capacity-is-supported-by-size-and-weight
  "3.4.2: that is, by these two."
  (is (null (set-exclusive-or '(:size :weight)
                              (attribute-supporters (find-attribute :capacity))))))

(test manual-3-4-2.supporters-make-noticing-likelier
  "3.4.2, reading 224: 1 - (1-p)^(n+1), where n supporters are specified; others do not count."
  (let ((p (attribute-noticed (find-attribute :capacity))))
    (loop for (n . specification) in '((0 (:color red)) (1 (:size 3)) (1 (:size 3) (:color red))
                                       (2 (:size 3) (:weight 2)))
          do (is (frequent-p (notice-count 1000 :capacity specification) 1000
                             (- 1 (expt (- 1 p) (1+ n))))
                 "~S" specification))))

(test manual-3-4-2.what-is-noticed-is-read-with-noise
  "3.4.2: a noisified value is added, as for attributes specified."
  (with-scout (:seed 20 :parameters *sure*)
    (put-beside 'ball 5 0 :size 7)
    (let ((sizes (remove nil (look-often 2000 (lambda (found) (reading-of :size found))))))
      (is (same-distribution-p sizes (normal 7 (deviation .8d0 4 5)))))))

(test manual-3-4-2.what-an-object-lacks-is-not-noticed
  "3.4.2: only booleans have a value if none is given (reading 122)."
  (with-scout (:clean t :seed 21)
    (put-beside 'ball 5 0 :size 3)
    (let ((keys (remove-duplicates
                 (loop for data in (look-often 500 #'designator-data)
                       append (mapcar #'first data)))))
      (is (subsetp keys '(:size :obsmove :obsview :closed)))
      (is (subsetp '(:size :obsmove :obsview :closed) keys)))))

(test manual-3-4-2.undefined-attributes-are-not-noticed
  "Reading 124: a search reports such an attribute only if it asks for it."
  (with-scout (:clean t :seed 22)
    (put-beside 'column 5 0 :shape 'cylinder)
    (is (every #'null (look-often 300 (lambda (found) (reading-of :shape found)))))
    (is (eq 'cylinder (reading-of :shape (look '((:shape cylinder))))))))

(test manual-3-4-2.noticed-first-specified-last
  "Reading 128: the order in which a designator's data come."
  (with-scout (:clean t :seed 23)
    (put-beside 'box 5 0 :size 3 :weight 2 :capacity 4 :color 'red)
    (let ((keys (look-often 200 (lambda (found) (mapcar #'first (designator-data found)))
                            :specification '((:weight 2) (:color red)))))
      (is (every (lambda (keys) (equal '(:weight :color) (last keys 2))) keys))
      (is (some #'cddr keys)))))
