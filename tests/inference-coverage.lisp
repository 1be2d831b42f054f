;;;; inference-coverage.lisp -- how often intervals cover the true value, and how often tests err.

(in-package :ars-magna.tests)

(def-suite* inference-coverage :in ars-magna)

;;; For counts, the coverage is computed by adding up probabilities. Random samples have fixed
;;; seeds.

(defun all-bounds (interval trials)
  "Return a list of lists: what the function INTERVAL says of 0, 1 ... TRIALS successes."
  (loop for successes from 0 to trials
        collect (multiple-value-list (funcall interval successes trials))))

(defun coverage (bounds trials probability)
  "Return how often one of BOUNDS, of each number of successes, holds PROBABILITY."
  (loop for odds across (binomial-odds trials probability)
        for (low high) in bounds
        when (<= low probability high) sum odds))

(defun coverages (interval trials)
  "Return the coverages of the function INTERVAL for probabilities from .02 to .98."
  (let ((bounds (all-bounds interval trials)))
    (loop for hundredths from 2 to 98
          collect (coverage bounds trials (/ hundredths 100d0)))))

(test wilson.covers-on-average-what-it-says
  (loop for trials in '(200 333 500 1000)
        for coverages = (coverages #'stats:wilson-interval trials)
        do (is (<= .945 (/ (reduce #'+ coverages) 97) .955) "~D trials" trials)
           (is (<= .9 (reduce #'min coverages)) "~D trials" trials)))

(test wilson.covers-at-other-confidences
  (loop for confidence in '(.8d0 .9d0 .99d0)
        for coverages = (coverages (lambda (successes trials)
                                     (stats:wilson-interval successes trials
                                                            :confidence confidence))
                                   300)
        do (is (near confidence (/ (reduce #'+ coverages) 97) .004))))

(test exact.covers-at-least-what-it-says
  (loop for trials in '(5 50 200)
        do (is (<= .95 (reduce #'min (coverages #'stats:exact-interval trials))))))

(defun count-that (trials claim)
  "Return how often CLAIM, called TRIALS times, is true."
  (loop repeat trials count (funcall claim)))

(defun normals (size mean dice)
  (loop repeat size collect (base:roll-gaussian mean 1 dice)))

(defmacro holding-p (value form)
  "True if the two values of FORM, bounds, hold VALUE."
  `(multiple-value-bind (low high) ,form (<= low ,value high)))

(test wilson.covers-when-drawn
  (let ((dice (base:make-dice 1927)))
    (is (frequent-p (count-that 4000 (lambda ()
                                       (let ((p (base:roll-between .02 .98 dice)))
                                         (holding-p p (stats:wilson-interval
                                                       (count-that 200 (lambda ()
                                                                         (base:chance p dice)))
                                                       200)))))
                    4000 .95))))

(test student.covers-what-it-says
  (loop for size in '(2 5 30)
        for dice = (base:make-dice 1908 (princ-to-string size))
        do (is (frequent-p (count-that 2000 (lambda ()
                                              (holding-p 3 (stats:student-interval
                                                            (normals size 3 dice)))))
                           2000 .95)
               "~D numbers" size)))

(test median-interval.covers-what-it-says
  "Whatever the distribution: of exponential numbers the median is log 2."
  (let ((dice (base:make-dice 2)))
    (is (frequent-p (count-that 2000 (lambda ()
                                       (holding-p (log 2d0)
                                         (stats:median-interval
                                          (loop repeat 10
                                                collect (- (log (- 1 (base:roll dice)))))))))
                    2000 .978515625))))

(test bootstrap.covers-nearly-what-it-says
  "Of 40 exponential numbers, which are badly skewed, 93 % or so; Student's misses more above."
  (let* ((dice (base:make-dice 1987))
         (covered (count-that 500 (lambda ()
                                    (holding-p 1 (stats:bootstrap-interval
                                                  (loop repeat 40
                                                        collect (- (log (- 1 (base:roll dice)))))
                                                  :resamples 500))))))
    (is (<= 445 covered 485))))

(test paired-proportions.cover-nearly-what-they-say
  (let ((dice (base:make-dice 10)) (holding 0))
    (loop repeat 1000
          do (let ((counts (list 0 0 0 0)))
               (loop repeat 200
                     do (let ((roll (base:roll dice)))
                          (incf (nth (position-if (lambda (end) (< roll end)) '(.5 .7 .8 1))
                                     counts))))
               (when (holding-p .1 (apply #'stats:paired-proportion-interval counts))
                 (incf holding))))
    (is (<= 930 holding 975))))

;;; Tests.

(defun mcnemar-size (trials level)
  "Return how often the test finds a difference, where there is none, in TRIALS that differ."
  (loop for odds across (binomial-odds trials 1/2)
        for first from 0
        when (<= (stats:mcnemar-test first (- trials first)) level) sum odds))

(test mcnemar.errs-no-more-than-it-says
  (let ((sizes (loop for trials from 1 to 200 collect (mcnemar-size trials .05d0))))
    (is (<= (reduce #'max sizes) .05d0))
    (is (< .03 (/ (reduce #'+ (nthcdr 100 sizes)) 100)))))

(test permutation.errs-no-more-than-it-says
  "Exact and drawn; and what it finds is spread evenly."
  (loop for size in '(10 40)
        for dice = (base:make-dice 1935 (princ-to-string size))
        for found = (loop repeat 600
                          collect (stats:permutation-test (normals size 0 dice) :resamples 400))
        do (loop for level in '(.05 .2 .5)
                 do (is (frequent-p (count level found :test #'>=) 600 level)
                        "~D numbers, level ~A" size level))))

(test permutation.finds-what-is-there
  (let ((dice (base:make-dice 5)))
    (is (< 90 (count-that 100 (lambda ()
                                (<= (stats:permutation-test (normals 20 1 dice)) .05)))))))

(test log-rank.errs-as-often-as-it-says
  (let ((dice (base:make-dice 1966)))
    (flet ((times () (loop repeat 50 collect (min 60 (floor (log (- 1 (base:roll dice))) -1/40))))
           (done (times) (mapcar (lambda (time) (< time 60)) times)))
      (is (frequent-p (count-that 600 (lambda ()
                                        (let ((first (times)) (second (times)))
                                          (<= (stats:log-rank-test first (done first)
                                                                   second (done second))
                                              .05))))
                      600 .05)))))

(defun verdict-of-growing (true-rate rate trials dice)
  "Return the first verdict on RATE in up to TRIALS trials that succeed with TRUE-RATE."
  (loop with successes = 0
        for trial from 1 to trials
        do (when (base:chance true-rate dice) (incf successes))
        thereis (stats:rate-verdict successes trial rate)))

(test rate-verdict.errs-no-more-than-it-says-however-often-asked
  (let ((dice (base:make-dice 1970)))
    (is (<= (count-that 300 (lambda () (verdict-of-growing .9 .9 1000 dice))) 18))))

(test rate-verdict.comes-where-there-is-a-difference
  (let ((dice (base:make-dice 1971)))
    (is (<= 97 (count-that 100 (lambda ()
                                 (eq :above (verdict-of-growing .97 .9 1000 dice))))))
    (is (<= 97 (count-that 100 (lambda ()
                                 (eq :below (verdict-of-growing .8 .9 1000 dice))))))))
