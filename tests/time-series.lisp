;;;; time-series.lisp -- quantities over time: which samples are kept, and charts of them.

(in-package :ars-magna.tests)

(in-suite plots)

(defun series-until (tick &key (series (plots:make-time-series "height" "m" 0)) (from 1))
  "Return SERIES with samples at the ticks FROM to TICK, each with twice the tick as value."
  (loop for each from from to tick do (plots:add-sample series each (* 2d0 each)))
  series)

(defun ticks-kept (series &optional (from 0))
  (mapcar #'plots:sample-range-tick (plots:time-series-ranges series from)))

(defun range-values (range)
  "Return a list of the first tick, the last tick, the first value, the least value and the greatest
value of RANGE."
  (list (plots:sample-range-tick range) (plots::sample-range-end range)
        (plots::sample-range-first range) (plots::sample-range-low range)
        (plots::sample-range-high range)))

(defun ranges-kept (series &optional (from 0))
  (mapcar #'range-values (plots:time-series-ranges series from)))

(test time-series.keeps-few-samples-of-the-whole-and-all-of-the-end
  (let ((series (series-until 100000)))
    (let ((ticks (ticks-kept series)))
      (is (<= 256 (length ticks) 513))
      (is (<= (first ticks) 256))
      (is (= 100000 (first (last ticks)))))
    (is (equal (loop for tick from 99700 to 100000 collect tick) (ticks-kept series 99700)))
    (is (>= 10 (length (plots::time-series-levels series))) "memory grows with the logarithm")
    (is (loop for (tick end . values) in (ranges-kept series)
              always (equalp (list (* 2 tick) (* 2 tick) (* 2 end)) values)))))

(test time-series.samples-are-evenly-spaced
  "Whichever tick they begin at; but for the first and the last, which are always there."
  (let ((series (series-until 5000 :from 777)))
    (dolist (from '(0 777 1000 3000 4000 4600))
      (multiple-value-bind (ranges step) (plots:time-series-ranges series from)
        (let ((ticks (mapcar #'plots:sample-range-tick ranges)))
          (is (loop for (tick next more) on (rest ticks)
                    while more always (= step (- next tick))))
          (is (<= (max from 777) (first ticks) (+ step (max from 777)))))))))

(defun value-of-tick (tick)
  "Return a value that differs from those of the ticks around TICK."
  (float (mod (* 7919 (1+ tick)) 1009) 1d0))

(defun true-range-p (values)
  "True if VALUES, a value of RANGE-VALUES, has the range of the values of its ticks."
  (destructuring-bind (tick end first low high) values
    (let ((all (loop for each from tick to end collect (value-of-tick each))))
      (and (= first (first all)) (= low (reduce #'min all)) (= high (reduce #'max all))))))

(defun possible-range-p (values)
  "True if VALUES, a value of RANGE-VALUES, has no value that is not of its ticks."
  (destructuring-bind (tick end first low high) values
    (let ((all (loop for each from tick to end collect (value-of-tick each))))
      (and (= first (first all)) (member low all) (member high all) (<= low first high)))))

(defun add-values (series from to)
  (loop for tick from from to to do (plots:add-sample series tick (value-of-tick tick))))

(test time-series.keeps-the-least-and-the-greatest-value-of-each-interval
  (dolist (begin '(0 5 777))
    (let ((series (plots:make-time-series "height" "m" 0)))
      (add-values series begin 9000)
      (dolist (from '(0 3000 7000 8500))
        (is (every #'true-range-p (ranges-kept series from)))))))

(test time-series.a-short-peak-is-not-lost
  (let ((series (plots:make-time-series "speed" "m/tick" 0)))
    (dotimes (tick 100000)
      (plots:add-sample series tick (cond ((= tick 5741) 0.4d0) ((= tick 5801) -0.2d0) (t 0d0))))
    (let ((ranges (ranges-kept series)))
      (is (= 0.4d0 (reduce #'max ranges :key #'fifth)))
      (is (= -0.2d0 (reduce #'min ranges :key #'fourth)))
      (is (= 1 (count-if #'plusp ranges :key #'fifth))))))

(test time-series.a-cut-leaves-no-removed-value
  "Near the end all ranges are exact. Far back, an interval that was cut keeps what is known."
  (loop for ticks in '((8990 9000) (8900 8999) (8700 8701) (8000 9000) (5001 5003 9000) (3 4 2000))
        do (let ((series (plots:make-time-series "height" "m" 0)))
             (add-values series 0 9000)
             (dolist (tick ticks)
               (plots:cut-time-series series tick)
               (dolist (from '(0 3000 7000))
                 (let ((ranges (ranges-kept series from)))
                   (is (every #'possible-range-p ranges))
                   (is (notany (lambda (range) (> (second range) tick)) ranges))
                   (is (<= (count-if-not #'true-range-p ranges) (length ticks)))
                   (when (> tick 8600) (is (every #'true-range-p ranges)))))
               (add-values series (1+ tick) (+ tick 20))
               (is (equal (loop for each from (+ tick 10) to (+ tick 20) collect each)
                          (ticks-kept series (+ tick 10))))
               (add-values series (+ tick 21) 9000)))))

(test time-series.cut-back-goes-on-as-if-nothing-had-been-cut
  "Far back, only every eighth tick was kept."
  (let ((series (series-until 3000)) (other (series-until 3000)))
    (dolist (tick '(2900 2000 600 100))
      (plots:cut-time-series series tick)
      (is (<= (- tick 7) (plots:last-sample series) tick))
      (series-until 3000 :series series :from (1+ tick))
      (is (= 3000 (plots:last-sample series)))
      (is (equal (ticks-kept other 2990) (ticks-kept series 2990))))
    (plots:cut-time-series series 0)
    (is (null (plots:last-sample series)))
    (is (null (plots:time-series-ranges series)))))

(test time-series.a-sample-replaces-those-of-later-ticks
  (let ((series (series-until 40)))
    (plots:add-sample series 30 -1d0)
    (is (equal '(28 29 30) (ticks-kept series 28)))
    (is (= -1 (nth-value 1 (plots:last-sample series))))))

(test time-chart.says-what-it-shows
  (let* ((series (series-until 400))
         (charts (plots:collect-time-charts (list series (plots:make-time-series "none" "" 1)) 720))
         (svg (plots:time-charts-svg charts "Heights")))
    (dolist (word '(">Heights<" ">height<" ">800 m<" ">tick<" ">100<" ">300<" ">500<" ">none<"
                    ">no value yet<"))
      (is (mentions-p svg word)))
    (is (= 1 (length (rest (split-by "stroke=\"#0072b2\"" svg)))) "one line, for one of two")))

(test time-chart.breaks-the-line-where-samples-are-missing
  (let ((series (series-until 100)))
    (series-until 300 :series series :from 201)
    (let ((svg (plots:time-charts-svg (plots:collect-time-charts (list series) 720) "")))
      (is (= 2 (length (rest (split-by "stroke=\"#0072b2\"" svg))))))))

(test time-chart.finds-the-sample-under-the-mouse
  (let ((chart (first (plots:collect-time-charts (list (series-until 300)) 720 :from 100))))
    (flet ((values-at (x) (range-values (plots:sample-range-at chart x))))
      (is (= 100 (first (values-at 0))))
      (is (= 300 (first (values-at 720))))
      (is (equal '(200 200 400d0 400d0 400d0) (values-at (/ (+ 62 708) 2)))))))

(test time-chart.says-the-range-where-an-interval-has-several-values
  (let* ((series (series-until 3000))
         (chart (first (plots:collect-time-charts (list series) 720))))
    (flet ((text-at (x) (plots:sample-text series (plots:sample-range-at chart x))))
      (is (equal "height: 2 to 14 m at ticks 1 to 7" (text-at 0)))
      (is (mentions-p (text-at 400) " m at ticks "))
      (is (equal "height: 6000 m at tick 3000" (text-at 720))))
    (is (equal "height: 5980 m at tick 2990"
               (plots:sample-text series (first (plots:time-series-ranges series 2990)))))))

(test time-chart.says-whole-numbers-in-full
  (is (equal '("123459" "-999999999" "1e9" "1234" "0.3333")
             (mapcar #'plots::sampled-value-text '(123459 -999999999 1000000000 1234.5d0 1/3)))))

(test time-chart.draws-peaks-and-straight-lines
  (flet ((points (&rest ranges)
           (plots::points-of-line (mapcar (lambda (range) (apply #'plots::make-sample-range range))
                                          ranges))))
    (is (equalp '((0 0) (3 3) (4 4) (7 7))
                (points '(0 3 0d0 0d0 3d0) '(4 7 4d0 4d0 7d0))))
    (is (equalp '((0 0) (4 -1) (8 5) (9 4))
                (points '(0 8 0d0 -1d0 5d0) '(9 9 4d0 4d0 4d0))))
    (is (equalp '((0 0) (4 5) (8 -1) (9 0))
                (points '(0 8 0d0 -1d0 5d0) '(9 9 0d0 0d0 0d0))))))
