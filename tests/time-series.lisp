;;;; time-series.lisp -- quantities over time: which samples are kept, and charts of them.

(in-package :ars-magna.tests)

(in-suite plots)

(defun series-until (tick &key (series (plots:make-time-series "height" "m" 0)) (from 1))
  "Return SERIES with samples at the ticks FROM to TICK, each with twice the tick as value."
  (loop for each from from to tick do (plots:add-sample series each (* 2d0 each)))
  series)

(defun ticks-kept (series &optional (from 0))
  (mapcar #'car (plots:time-series-samples series from)))

(test time-series.keeps-few-samples-of-the-whole-and-all-of-the-end
  (let ((series (series-until 100000)))
    (let ((ticks (ticks-kept series)))
      (is (<= 256 (length ticks) 513))
      (is (<= (first ticks) 256))
      (is (= 100000 (first (last ticks)))))
    (is (equal (loop for tick from 99700 to 100000 collect tick) (ticks-kept series 99700)))
    (is (>= 10 (length (plots::time-series-levels series))) "memory grows with the logarithm")
    (is (loop for (tick . value) in (plots:time-series-samples series)
              always (= value (* 2 tick))))))

(test time-series.samples-are-evenly-spaced
  "Whichever tick they begin at; but for the last, which is always there."
  (let ((series (series-until 5000 :from 777)))
    (dolist (from '(0 777 1000 3000 4000 4600))
      (multiple-value-bind (samples step) (plots:time-series-samples series from)
        (is (loop for ((tick) (next) more) on samples
                  while more always (= step (- next tick))))
        (is (<= (max from 777) (first (first samples)) (+ step (max from 777))))))))

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
    (is (null (plots:time-series-samples series)))))

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
    (is (= 100 (plots:sample-at chart 0)))
    (is (= 300 (plots:sample-at chart 720)))
    (is (equal '(200 400d0) (multiple-value-list (plots:sample-at chart (/ (+ 62 708) 2)))))))
