;;;; statistics.lisp -- perception errs as often as the formulas say (manual 3.4.2, 4).

(in-package :ars-magna.tests)

(def-suite* statistics :in ars-magna)

;;; The seeds are fixed, so the results are always the same. About one in a thousand other seeds
;;; would fail a claim.

(defun chi-square (counts expected)
  "Return the sum of (count - expected)^2 / expected."
  (loop for count in counts for mean in expected
        sum (/ (expt (- count mean) 2) mean)))

(defun frequent-p (count trials probability)
  "True if COUNT of TRIALS goes with PROBABILITY, within 3.3 standard deviations."
  (<= (abs (- count (* trials probability)))
      (* 3.3 (sqrt (* trials probability (- 1 probability))))))

(defun normal-probability (x)
  "Return the probability that a standard normal number is below X, to 1e-7 (Abramowitz and Stegun
26.2.17)."
  (let* ((u (/ (+ 1 (* 0.2316419d0 (abs x)))))
         (tail (* (/ (exp (* -0.5d0 x x)) (sqrt (* 2 pi)))
                  (loop for power = u then (* power u)
                        for factor in '(0.319381530d0 -0.356563782d0 1.781477937d0
                                        -1.821255978d0 1.330274429d0)
                        sum (* factor power)))))
    (if (minusp x) tail (- 1 tail))))

(defun kolmogorov-distance (sample distribution)
  "Return the largest difference between SAMPLE's distribution and the function DISTRIBUTION."
  (let* ((sorted (sort (copy-list sample) #'<)) (size (length sorted)))
    (loop for value in sorted for below from 0
          for probability = (funcall distribution value)
          maximize (max (abs (- probability (/ below size)))
                        (abs (- (/ (1+ below) size) probability))))))

(defun same-distribution-p (sample distribution)
  "True unless the Kolmogorov-Smirnov test at .001 rejects DISTRIBUTION for SAMPLE."
  (< (kolmogorov-distance sample distribution) (/ 1.95 (sqrt (length sample)))))

(defun uniform (low high)
  "Return the distribution of numbers uniform from LOW to HIGH."
  (lambda (x) (/ (- x low) (- high low))))

;;; Readings of attributes.

(test discrete-reading.by-its-formula
  "P(correct) = p / max(1, f d (1-p)); a wrong reading is any value of the domain."
  (let ((trials 8000) (color (world:find-attribute :color)) (dice (base:make-dice 1)))
    (loop for distance in '(0 5 16 17 30 100)
          ;; p = .4 and f = .1: flat up to 16.7 m.
          for correct = (/ .4 (max 1 (* .1 distance .6)))
          do (is (near correct (robot:reading-reliability color distance) 1e-6))
             (let* ((domain (world:attribute-domain color))
                    (readings (loop repeat trials
                                    collect (robot:read-attribute color 'world:red distance dice)))
                    (other (/ (- 1 correct) (length domain))))
               (is (< (chi-square (loop for value in domain collect (count value readings))
                                  (loop for value in domain
                                        collect (* trials (if (eq value 'world:red)
                                                              (+ correct other)
                                                              other))))
                      ;; 7 degrees of freedom, .001.
                      24.3)
                   "at ~D m" distance)))))

(test certain-reading.never-degrades
  (with-own-definitions
    (world:define-attribute :sure '(a b) :success 1)
    (let ((attribute (world:find-attribute :sure)) (dice (base:make-dice 1)))
      (is (= 1 (robot:reading-reliability attribute 1d6)))
      (is (loop repeat 100 always (eq 'a (robot:read-attribute attribute 'a 1d6 dice)))))))

(test numeric-reading.by-its-formula
  "The deviation is max(s, m s d / (d + f))."
  (let ((trials 5000) (size (world:find-attribute :size)) (dice (base:make-dice 2)))
    (loop for distance in '(0 0.005 0.05 1 30)
          for deviation = (if (zerop distance)
                              .8
                              (max .8 (/ (* 4 .8 distance) (+ distance .05))))
          do (is (near deviation (robot:reading-deviation size distance) 1e-6))
             (let* ((readings (loop repeat trials
                                    collect (robot:read-attribute size 7 distance dice)))
                    (mean (/ (reduce #'+ readings) trials))
                    (variance (/ (reduce #'+ (mapcar (lambda (x) (expt (- x mean) 2)) readings))
                                 (1- trials))))
               (is (< (abs (- mean 7)) (/ (* 3.3 deviation) (sqrt trials))))
               (is (< (abs (- (sqrt variance) deviation))
                      (/ (* 3.3 deviation) (sqrt (* 2 trials)))))
               (is (same-distribution-p readings
                                        (lambda (x)
                                          (normal-probability (/ (- x 7) deviation)))))))))

(test numeric-reading.is-not-clipped
  (let ((size (world:find-attribute :size)) (dice (base:make-dice 3)))
    (is (plusp (loop repeat 1000 count (minusp (robot:read-attribute size .2 20 dice)))))))

(test substance-reading.of-type-and-parameter
  (let ((substance (world:find-attribute :substance)) (dice (base:make-dice 4)) (trials 5000)
        (kinds (length (world:all-substances))))
    (flet ((read-it (value) (robot:read-attribute substance value 1 dice)))
      (is (frequent-p (loop repeat trials count (eq 'world:wood (read-it 'world:wood)))
                      trials (+ .8 (/ .2 kinds))))
      (is (same-distribution-p (loop repeat trials
                                     collect (second (read-it '(world:wood 120))))
                               (let ((deviation (robot:reading-deviation substance 1)))
                                 (lambda (x) (normal-probability (/ (- x 120) deviation)))))))))

;;; Matching and noticing.

(test matching.takes-wrong-things-for-right
  "A blue thing is taken for red when its color is misread so: .6 / 8."
  (with-watcher (:seed 5 :parameters '((miss-thing-prob* 0) (false-thing-prob* 0)))
    (put 'ball '(9.5 10.5) :color 'world:blue)
    (is (frequent-p (loop repeat 4000
                          count (robot:look-for-things (eye) :non-local '((:color red))))
                    4000 (/ .6 8)))))

(test noticing.by-its-formula
  "1 - (1-p)^(n+1), n being the supporters that were asked for."
  (let ((capacity (world:find-attribute :capacity)))
    (is (near .3 (robot:notice-probability capacity '()) 1e-6))
    (is (near .3 (robot:notice-probability capacity '(:color)) 1e-6))
    (is (near (- 1 (expt .7 2)) (robot:notice-probability capacity '(:size :color)) 1e-6))
    (is (near (- 1 (expt .7 3)) (robot:notice-probability capacity '(:weight :size)) 1e-6)))
  (with-watcher (:seed 6 :clean t)
    (put 'ball '(9.5 10.5) :size 3 :weight 2 :capacity 4 :color 'world:red)
    (flet ((noticed (key specification)
             (loop repeat 2000
                   count (assoc key (robot::sighting-data
                                     (first (robot:look-for-things (eye) :non-local
                                                                   specification)))))))
      (is (frequent-p (noticed :capacity '()) 2000 .3))
      (is (frequent-p (noticed :capacity '((:size 3))) 2000 (- 1 (expt .7 2))))
      (is (frequent-p (noticed :capacity '((:size 3) (:weight 2))) 2000 (- 1 (expt .7 3))))
      (is (= 2000 (noticed :size '((:size 3)))))
      (is (frequent-p (noticed :obsview '()) 2000 .5))
      ;; What the ball does not have cannot be noticed.
      (is (zerop (noticed :substance '()))))))

(test description.has-what-was-noticed-first
  (with-watcher (:clean t :seed 1)
    (put 'ball '(9.5 10.5) :size 3 :weight 2 :capacity 4 :color 'world:red)
    (let ((data (loop repeat 50
                      collect (mapcar #'first
                                      (robot::sighting-data
                                       (first (robot:look-for-things
                                               (eye) :non-local '((:weight 2) (:size 3)))))))))
      (is (every (lambda (keys) (equal '(:weight :size) (last keys 2))) data))
      (is (some (lambda (keys) (< 2 (length keys))) data)))))

;;; Searches.

(defun find-count (trials specification &key (type :non-local))
  "Return how many of TRIALS searches find something."
  (loop repeat trials count (robot:look-for-things (eye) type specification)))

(test search.overlooks-things-and-places
  (with-watcher (:seed 7 :parameters '((false-thing-prob* 0)))
    (put 'ball '(9.5 10.5))
    (is (frequent-p (find-count 4000 '()) 4000 .95))
    (let ((doorway (world:find-place-type 'doorway)))
      (is (frequent-p (loop repeat 4000
                            count (find-if #'robot::sighting-denotation
                                           (robot:look-for-places (eye) doorway :all t)))
                      4000 .9)))))

(test search.chooses-any-one
  (with-watcher (:clean t :seed 8)
    (let ((balls (loop for y from 8.5 to 12.5 collect (put 'ball (list 9.5 y)))))
      (is (< (chi-square (let ((found (loop repeat 5000
                                            collect (robot::sighting-denotation
                                                     (first (robot:look-for-things
                                                             (eye) :non-local '()))))))
                           (loop for ball in balls collect (count ball found)))
                         (loop repeat 5 collect 1000))
             ;; 4 degrees of freedom, .001.
             18.5)))))

(test search.imagines-things
  (with-watcher (:seed 9 :parameters '((false-thing-prob* .1)))
    (is (frequent-p (find-count 4000 '((:size 3))) 4000 .1))
    (is (frequent-p (find-count 4000 '((:size 3)) :type :local) 4000 .1))
    (robot:move-part (eye) (robot:robot-storage-bin watcher 0))
    (is (zerop (find-count 500 '())))))

(test search.imagines-places-by-their-confusion
  (with-watcher (:seed 10)
    (robot:set-robot-angle watcher pi)
    (is (frequent-p (loop repeat 4000
                          count (robot:look-for-places (eye) (world:find-place-type 'doorway)))
                    4000 .05))))

(test false-description.meets-the-specification
  (with-watcher (:seed 11 :parameters '((false-thing-prob* 1)))
    (let ((thing (put 'thing (robot:robot-storage-bin watcher 0) :size 30 :weight 2)))
      (declare (ignore thing))
      (let ((data (loop repeat 2000
                        collect (robot::sighting-data
                                 (first (robot:look-for-things
                                         (eye) :non-local
                                         '((:color (red blue)) (:size (3 5)))))))))
        (flet ((values-of (key) (loop for entry in data collect (second (assoc key entry)))))
          (is (same-distribution-p (values-of :size) (uniform 2.5 5.5)))
          (is (frequent-p (count 'world:red (values-of :color) :test #'base:same-name-p)
                          2000 .5))
          ;; What is noticed besides is true of something in the world.
          (is (frequent-p (count-if #'numberp (values-of :weight)) 2000
                          (- 1 (expt .8 2))))
          (is (null (remove nil (values-of :substance)))))))))

(test false-designator.is-where-a-walk-stops
  "Metre by metre with .07, across walls, up to the edge of the map."
  (with-watcher (:seed 12 :parameters '((false-thing-prob* 1)))
    (let ((camera (eye)) (distances '()) (trials 4000))
      (setf (robot:camera-field-of-view camera) 1d-9)
      (loop repeat trials
            for sighting = (first (robot:look-for-things camera :non-local '((:size 3))))
            do (push (- (robot::sighting-x sighting) 5.5d0) distances))
      (is (every (lambda (distance)
                   (or (near distance (round distance) 1d-6) (near distance 24.5 1d-5)))
                 distances))
      (let ((counts (loop for metre from 1 to 24
                          collect (count-if (lambda (d) (near d metre 1d-6)) distances)))
            (edge (count-if (lambda (d) (near d 24.5 1d-5)) distances)))
        (is (< (chi-square (append counts (list edge))
                           (append (loop for metre from 1 to 24
                                         collect (* trials .07 (expt .93 (1- metre))))
                                   (list (* trials (expt .93 24)))))
               ;; 24 degrees of freedom, .001.
               51.2))))))

(test false-designator.is-anywhere-in-the-field-of-view
  (with-watcher (:seed 13 :parameters '((false-thing-prob* 1)))
    (let ((angles (loop repeat 3000
                        for sighting = (first (robot:look-for-things (eye) :non-local '()))
                        collect (robot::bearing-to watcher (robot::sighting-x sighting)
                                                   (robot::sighting-y sighting)))))
      (is (same-distribution-p angles (uniform (/ pi -4) (/ pi 4)))))))

(test designator-angle.errs-uniformly
  (with-watcher (:seed 14 :parameters '((miss-thing-prob* 0) (false-thing-prob* 0)))
    (put 'ball '(9.5 10.5))
    (let ((errors (loop repeat 3000
                        for designator = (robot:designate
                                          (first (robot:look-for-things (eye) :non-local '()))
                                          (eye))
                        collect (robot:designator-angle designator)
                        do (robot:drop-designator designator :silently t))))
      (is (same-distribution-p errors (uniform -.02 .02))))))

;;; Views.

(test pixels.err-uniformly-and-now-and-then-grossly
  "Within 2 of the truth, but anything from the map's least to its greatest with .01."
  (with-watcher (:seed 15)
    (let* ((pixels (loop repeat 3000 append (robot:take-view (eye 1))))
           (sides (loop for (left nil right) on pixels by #'cdddr
                        collect left collect right))
           (gross (remove-if (lambda (pixel) (<= 28 pixel 32)) sides)))
      (is (frequent-p (length gross) (length sides) (* .01 18/20)))
      (is (every (lambda (pixel) (<= 10 pixel 30)) gross))
      (is (same-distribution-p gross (uniform 10 28)))
      ;; Among the rest are outliers too, one in 450.
      (is (same-distribution-p (remove-if-not (lambda (pixel) (<= 28 pixel 32)) sides)
                               (uniform 28 32))))))

;;; Tracks.

;; What is told of the end of a track, and notes the tick.
(defstruct stopwatch (end nil))

(defmethod robot:notify-track-end ((stopwatch stopwatch) code designator)
  (declare (ignore code designator))
  (setf (stopwatch-end stopwatch) (run:simulation-tick)))

(defun track-lengths (trials make-designator)
  "Return for how many ticks each of TRIALS tracks of what MAKE-DESIGNATOR returns lasted."
  (loop repeat trials
        collect (let ((start (run:simulation-tick)) (stopwatch (make-stopwatch)))
                  (robot:start-track (eye) (funcall make-designator) stopwatch)
                  (run:run-until (lambda () (stopwatch-end stopwatch)) :limit 5000)
                  (- (stopwatch-end stopwatch) start))))

(defun geometric-p (lengths probability)
  "True if LENGTHS, from 1, go with ending each tick with PROBABILITY."
  (let* ((trials (length lengths)) (mean (/ (reduce #'+ lengths) trials)))
    (and (< (abs (- mean (/ probability)))
            (* 3.3 (/ (sqrt (- 1 probability)) probability (sqrt trials))))
         (frequent-p (count 1 lengths) trials probability))))

(test track.is-lost-at-random
  (with-watcher (:seed 16 :parameters '((prob-lose-track* .05)))
    (let ((ball (put 'ball '(9.5 10.5))))
      (is (geometric-p (track-lengths 1500 (lambda ()
                                             (robot:add-designator watcher :denotation ball)))
                       .05)))))

(test false-track.is-lost-at-random
  (with-watcher (:seed 17)
    (is (geometric-p (track-lengths 3000 (lambda () (phantom 20.5 10.5))) .4))))

(test false-designator.drifts
  "Uniformly: up to 1 m and .2 radians a tick."
  (with-watcher (:seed 18 :parameters '((prob-lose-false-track* 0) (camera-angle-max-error* 0)))
    (let ((distances '()) (angles '()))
      (loop repeat 2000
            do (let ((designator (phantom 15.5 10.5)))
                 (robot:start-track (eye) designator nil)
                 (push (- (robot:designator-distance designator) 10) distances)
                 (push (robot:designator-angle designator) angles)
                 (robot:end-track (eye) :interrupt)
                 (robot:drop-designator designator)))
      (is (same-distribution-p distances (uniform -1 1)))
      (is (same-distribution-p angles (uniform -.2 .2))))))

(test tick-quantum.makes-loss-more-likely
  "In a tick that stands for 10, a track is lost with 1 - (1-p)^10."
  (with-watcher (:seed 19 :parameters '((prob-lose-track* .05) (tick-quantum* 10)))
    (let ((ball (put 'ball '(9.5 10.5))))
      (is (geometric-p (track-lengths 1500 (lambda ()
                                             (robot:add-designator watcher :denotation ball)))
                       (- 1 (expt .95 10)))))))

;;; Clean.

(test clean.sees-all-and-nothing-else
  (with-watcher (:clean t)
    (loop for y from 8.5 to 12.5
          do (put 'ball (list 9.5 y) :color 'world:red :size 3 :substance 'world:wood))
    (loop repeat 50
          do (let ((sightings (robot:look-for-things (eye) :non-local
                                                     '((:color red) (:size 3 0)) :all t)))
               (is (= 5 (length sightings)))
               (dolist (sighting sightings)
                 (is (subsetp (robot::sighting-data sighting)
                              '((:color red) (:size 3) (:substance world:wood)
                                (:obsmove nil) (:obsview nil) (:closed nil) (:lit nil))
                              :test #'equal)))))
    (is (= 1 (length (remove-duplicates (loop repeat 20 collect (robot:take-view (eye)))
                                        :test #'equal))))))

(test no-sensor-error.suffices
  "Manual, chapter 4: it suppresses all sensing error, for all values of the other parameters."
  (with-watcher (:seed 20 :parameters '((no-sensor-error* t) (miss-thing-prob* 1)
                                        (false-thing-prob* 1) (prob-lose-track* 1)))
    (let ((ball (put 'ball '(9.5 12.5) :color 'world:red)))
      (loop repeat 20
            do (let ((designator (robot:designate
                                  (first (robot:look-for-things (eye) :non-local
                                                                '((:color red))))
                                  (eye))))
                 (is (eq ball (robot:designator-denotation designator)))
                 (is (near (atan 2d0 4d0) (robot:designator-angle designator)))))
      (robot:start-track (eye) (first (robot:live-designators watcher)) nil)
      (run:run-ticks 20)
      (is (robot:camera-tracks (eye)))
      (is (equal '(30d0 10d0 30d0) (robot:take-view (eye 1)))))))
