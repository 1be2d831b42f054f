;;;; manual-5-4.lisp -- Defining new attributes (manual 5.4).

(in-package :ars-test-manual-5)
(in-readtable :nisp)

(def-suite* manual-5-4 :in ars-magna)

(defmap stable (30 20)
  (rect (0 0) (29 19) wood 60)
  (obj pony (5.5 10.5) ((:size 10) (:gait trot) (:speed 7)))
  (obj mare (25.5 10.5) ((:size 12) (:gait trot) (:speed 7)))
  (obj stall (20.5 9.5) ((:size 20))))

(defrobot groom (stable (5.5 10.5) 0) :cameras ((1 100)))

(defmacro with-attributes ((&rest definitions) (&rest options) &body body)
  "Run BODY in a stable with attributes defined by DEFINITIONS, in a simulation with OPTIONS.
Cameras miss no things and see no false ones."
  `(progn
     ,@(loop for definition in definitions collect `(eval '(defattribute ,@definition)))
     (with-simulation (groom ,@options :parameters '((miss-thing-prob* 0) (false-thing-prob* 0)))
       ,@body)))

(defun found (specification &optional (type :local))
  "Return the designator that GROOM finds by SPECIFICATION, or NIL."
  (third (answer 'camera-get-object-designator (robot-camera groom 0) type specification)))

(defun reading (key specification &optional (type :local))
  "Return what GROOM reads for the attribute KEY of a thing that fits SPECIFICATION; NIL if there is
none, or KEY is not noticed."
  (let ((designator (found specification type)))
    (and designator (second (assoc key !>designator.data)))))

(defun readings (trials key specification &optional (type :local))
  (loop repeat trials collect (reading key specification type)))

(defun deviation (numbers mean)
  "Return the standard deviation of NUMBERS about MEAN."
  (sqrt (/ (loop for number in numbers sum (expt (- number mean) 2)) (length numbers))))

(defparameter *gaits* '(walk trot pace gallop))

;;; Discrete attributes.

(test manual-5-4.lists-are-domains-of-discrete-attributes
  "5.4: if the domain, unevaluated, is a list, its elements are the possible values."
  (with-attributes ((:gait (walk trot pace gallop))) (:clean t)
    (let ((gait (find-attribute :gait)))
      (is (equal '(:discrete (walk trot pace gallop))
                 (list (attribute-kind gait) (attribute-domain gait)))))
    (is (equal '(trot nil) (list (reading :gait '((:gait trot))) (reading :gait '((:gait walk))))))
    (signals wrong-argument (set-attribute (find-thing 'pony) :gait 'limp))
    (signals wrong-argument (found '((:gait limp))))))

(test manual-5-4.success-is-1-by-default
  "5.4: readings of a discrete attribute are right unless :success says otherwise, at any distance."
  (with-attributes ((:gait (walk trot pace gallop))) (:seed 1)
    (is (equal '(trot) (remove-duplicates (readings 50 :gait '((:gait trot))))))
    (is (equal '(trot) (remove-duplicates (readings 50 :gait '((:gait trot)) :non-local))))))

(test manual-5-4.success-is-how-often-a-reading-is-right
  "5.4, 3.4.2: close by a reading is right with probability :success; a wrong one is any value of
the domain, with equal chances, so the true one, too."
  (with-attributes ((:gait (walk trot pace gallop) :success .6)) (:seed 2)
    (let ((seen (readings 1000 :gait '((:gait (walk trot pace gallop))))))
      (is-true (frequent-p (count 'trot seen) 1000 (+ .6 .1)))
      (dolist (other '(walk pace gallop))
        (is-true (frequent-p (count other seen) 1000 .1) "~A" other)))))

(test manual-5-4.success-is-modified-by-distance
  "5.4, 3.4.2, reading 115: at the distance d it is p / max(1, f d (1-p)), with f
discrete-noise-factor*: at 20 m and f = .5, .4 / max(1, 6) = .067."
  (with-attributes ((:gait (walk trot pace gallop) :success .4)) (:seed 3)
    (setf discrete-noise-factor* .5)
    (let ((seen (readings 800 :gait '((:gait (walk trot pace gallop))) :non-local)))
      (is-true (frequent-p (count 'trot seen) 800 (+ (/ .4 6) (/ (- 1 (/ .4 6)) 4)))))))

;;; Numeric attributes.

(test manual-5-4.numeric-attributes
  "5.4: the domain NUMERIC makes an attribute numeric; readings are right by default, as :base is
0."
  (with-attributes ((:speed NUMERIC)) (:seed 4)
    (is (equal '(:numeric 0d0 1d0) (let ((speed (find-attribute :speed)))
                                     (list (attribute-kind speed) (attribute-base speed)
                                           (attribute-max-mult speed)))))
    (is (equalp '(7) (remove-duplicates (readings 20 :speed '((:speed (0 20)))))))
    (is (equalp '(7) (remove-duplicates (readings 20 :speed '((:speed (0 20))) :non-local))))
    (signals wrong-argument (set-attribute (find-thing 'pony) :speed 'fast))))

(defun deviation-p (deviation numbers)
  "True if NUMBERS are about 7 with DEVIATION, within some 3.3 standard errors."
  (let ((size (length numbers)))
    (and (< (abs (- (/ (reduce #'+ numbers) size) 7)) (* 3.3 (/ deviation (sqrt size))))
         (< (abs (- (deviation numbers 7) deviation)) (* 3.3 (/ deviation (sqrt (* 2 size))))))))

(test manual-5-4.base-is-the-deviation-close-by
  "5.4, 3.4.2: at no distance readings are gaussian about the truth with the deviation :base,
whatever :max-mult."
  (with-attributes ((:speed numeric :base 2 :max-mult 5)) (:seed 5)
    (is-true (deviation-p 2 (readings 600 :speed '((:speed (-99 99))))))))

(test manual-5-4.max-mult-is-the-largest-multiplier
  "5.4, 3.4.2: at the distance d the deviation is max(s, m s d/(d+f)): with f =
continuous-noise-factor* = 20 at 20 m, half of m times s; by default, m = 1, it stays s."
  (with-attributes ((:speed numeric :base 2 :max-mult 5)) (:seed 6)
    (setf continuous-noise-factor* 20)
    (is-true (deviation-p 5 (readings 600 :speed '((:speed (-99 99))) :non-local))))
  (with-attributes ((:speed numeric :base 2)) (:seed 7)
    (is-true (deviation-p 2 (readings 600 :speed '((:speed (-99 99))) :non-local)))))

;;; Noticing.

(defun noticed (trials specification)
  "Return how many of TRIALS searches by SPECIFICATION report the gait, which they do not specify."
  (count-if #'identity (readings trials :gait specification)))

(test manual-5-4.noticed-is-0-by-default
  "5.4, reading 120: an attribute is not sensed unless asked for, supported or not."
  (with-attributes ((:gait (walk trot pace gallop) :supported-by (:size))) (:clean t)
    (is (= 0 (noticed 50 '())))
    (is (= 0 (noticed 50 '((:size 10)))))))

(test manual-5-4.noticed-is-the-chance-of-being-sensed-unasked
  "5.4: the base probability of a reading that was not specified; by reading 119 :support is another
word for it."
  (dolist (option '(:noticed :support))
    (eval `(defattribute :gait (walk trot pace gallop) ,option .3))
    (with-attributes () (:seed 8 :clean t)
      (is-true (frequent-p (noticed 500 '()) 500 .3) "~A" option))))

(test manual-5-4.supporters-that-are-asked-for-raise-it
  "5.4, 3.4.2, reading 224: with n supporters in the specification it is 1 - (1-p)^(n+1); other
attributes in it do not matter."
  (with-attributes ((:speed numeric)
                    (:gait (walk trot pace gallop) :noticed .2 :supported-by (:size :speed)))
      (:seed 9 :clean t)
    (loop for (probability specification) in '((.2 ((:obsview #f)))
                                               (.36 ((:size 10)))
                                               (.36 ((:obsview #f) (:speed 7)))
                                               (.488 ((:size 10) (:speed 7))))
          do (is-true (frequent-p (noticed 400 specification) 400 probability)
                      "~A" specification))))

(test manual-5-4.what-is-asked-for-is-always-told
  "5.4: an attribute in the specification is in the data, whatever :noticed."
  (with-attributes ((:gait (walk trot pace gallop))) (:clean t)
    (is (= 20 (noticed 20 '((:gait trot)))))))

;;; Their use.

(test manual-5-4.new-attributes-are-used-like-those-that-are-built-in
  "5.4: in descriptors, specifications and designators; of a thing without a value no specification
of it is met."
  (with-attributes ((:gait (walk trot pace gallop)) (:speed numeric)) (:clean t)
    (flet ((name-of (specification)
             (let ((designator (found specification :non-local)))
               (and designator (thing-name (designator-denotation designator))))))
      (is (equal '(mare nil stall)
                 (mapcar #'name-of '(((:gait (trot pace)) (:speed (5 8)))
                                     ((:gait trot) (:speed 3))
                                     ((:size 20))))))
      (is (equal '(:gait trot) (assoc :gait (!_data (found '((:gait trot)) :non-local)))))
      (is (null (name-of '((:size 20) (:gait (walk trot pace gallop)))))))))

(test manual-5-4.names-may-be-defined-after-their-use
  "5.4, reading 124: undeclared attributes may be stored and matched, as they are; they are not
sensed unasked. Once defined they are as the definition says."
  (with-attributes () (:seed 1)
    (is (equal '(trot nil) (list (reading :gait '((:gait trot))) (reading :gait '((:gait walk))))))
    (is (= 0 (noticed 50 '((:size 10 9))))))
  (with-attributes ((:gait (walk trot pace gallop) :noticed 1)) (:clean t)
    (is (= 5 (noticed 5 '((:size 10 9)))))))

(test manual-5-4.values-are-compared-by-name
  "Reading 38: TROT of another package is the same value."
  (with-attributes ((:gait (walk trot pace gallop))) (:clean t)
    (is-true (found (list (list :gait (make-symbol "TROT")))))))

(test manual-5-4.attributes-can-be-defined-anew
  "5.4: the newest definition counts; built-in ones keep their kind, since the simulator computes
with them."
  (eval '(defattribute :gait (walk trot) :success .3))
  (eval '(defattribute :gait (hop trot)))
  (is (equal '((hop trot) 1d0) (let ((gait (find-attribute :gait)))
                                 (list (attribute-domain gait) (attribute-success gait)))))
  (is (equal '(nil t t) (mapcar (lambda (complaint) (and complaint t))
                                (complaints '(defattribute :size numeric :base 3)
                                            '(defattribute :size (small large))
                                            '(defattribute :closed numeric))))))

(test manual-5-4.the-manuals-color-and-size
  "5.4: color as the manual defines it: rarely read right, rarely noticed, more when looking at
substance; size: noticed most of the time, the more so with :capacity, :obsview or :weight."
  (let ((color (find-attribute :color)) (size (find-attribute :size)))
    (is (equal '(.4d0 .4d0 (:substance))
               (mapcar (lambda (value) (if (realp value) (/ (round value .1d-3) 1d4) value))
                       (list (attribute-success color) (attribute-noticed color)
                             (attribute-supporters color)))))
    (is (equal '(red green blue violet lightred lightblue lightgreen lightviolet)
               (attribute-domain color)))
    (is-true (near .8 (attribute-base size) 1d-6))
    (is-true (near 4 (attribute-max-mult size) 1d-6))
    (is-true (near .7 (attribute-noticed size) 1d-6))
    (is (equal '(:capacity :obsview :weight) (attribute-supporters size)))))

(test manual-5-4.mistakes-are-told
  "5.4: probabilities are from 0 to 1, deviations not negative, a domain is NUMERIC or a list."
  (dolist (rest '((numeric :base -1) ((a b) :success 2) ((a b) :success -.1) (numeric :noticed 1.5)
                  (numeric :max-mult -1) (5) () ('(a b)) (numeric :colour red)))
    (is-true (first (complaints `(defattribute :mood ,@rest))) "~S" rest)))
