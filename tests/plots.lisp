;;;; plots.lisp -- charts: numbers as text, round marks, what is drawn where.

(in-package :ars-magna.tests)

(eval-when (:compile-toplevel :load-toplevel :execute)
  (sb-ext:add-package-local-nickname :plots :ars-magna.plots :ars-magna.tests))

(def-suite* plots :in ars-magna)

;;; Reading a chart.

(defun chart-attribute (name element)
  "Return the attribute NAME of ELEMENT, the text of a tag, as a string; NIL if there is none."
  (let* ((key (format nil " ~A=\"" name))
         (start (search key element)))
    (when start
      (let ((begin (+ start (length key))))
        (subseq element begin (position #\" element :start begin))))))

(defun chart-numbers (text)
  "Return the decimals in TEXT, as rationals."
  (loop for word in (uiop:split-string text :separator " ,")
        unless (string= "" word)
          collect (let ((point (position #\. word)))
                    (if point
                        (let ((digits (parse-integer (remove #\. word))))
                          (/ digits (expt 10 (- (length word) point 1))))
                        (parse-integer word)))))

(defun chart-number (name element)
  (first (chart-numbers (chart-attribute name element))))

(defun chart-elements (tag chart)
  "Return what stands between < and the next < of each element TAG of CHART."
  (loop with key = (format nil "<~A " tag)
        for start = (search key chart) then (search key chart :start2 end)
        while start
        for end = (or (position #\< chart :start (1+ start)) (length chart))
        collect (subseq chart start end)))

(defun chart-words (element)
  "Return the words of ELEMENT, a text."
  (let ((text (subseq element (1+ (position #\> element)))))
    (loop for (code character) in '(("&lt;" "<") ("&gt;" ">") ("&quot;" "\"") ("&amp;" "&"))
          do (setf text (uiop:frob-substrings text (list code) character)))
    text))

(defun chart-texts (chart)
  "Return all that is written in CHART, a list of strings."
  (mapcar #'chart-words (chart-elements "text" chart)))

(defun text-named (words chart)
  (find words (chart-elements "text" chart) :key #'chart-words :test #'string=))

(defun colored (tag color chart)
  "Return the elements TAG of CHART that are drawn in COLOR, such as #0072b2."
  (remove-if-not (lambda (element) (search color element)) (chart-elements tag chart)))

(defun marker-centers (color chart)
  "Return lists (x y): the middles of the circles of COLOR in CHART, but that of the legend."
  (loop for element in (colored "ellipse" color chart)
        unless (search "nothing" element)
          collect (list (chart-number "cx" element) (chart-number "cy" element))))

;;; Numbers as text.

(test figures.are-written-as-people-read-them
  (loop for (value percent text) in '((0 nil "0") (0.05 nil "0.05") (1/3 nil "0.3333")
                                      (-12.5d0 nil "-12.5") (200 nil "200") (123456 nil "123500")
                                      (1/8 t "12.5 %") (1 t "100 %") (nil nil "-")
                                      (99999 nil "100000") (1.5d9 nil "1.5e9")
                                      (9999999 nil "1e7") (-2d-7 nil "-2e-7") (1d308 nil "1e308")
                                      (2d-308 nil "2e-308") (5d-324 nil "4.941e-324")
                                      (-1d-323 nil "-9.881e-324") (-1/100000000 t "-1e-6 %"))
        do (is (string= text (plots:rounded-number-text value :percent percent)) "~S" value)))

(defun axis-marks-of (&rest points)
  "Return what is written along both axes of a chart of POINTS, x y x y ...."
  (chart-texts (plots:line-chart (list (cons nil (loop for (x y) on points by #'cddr
                                                       collect (list x y)))))))

(test axes.have-round-marks-of-one-kind
  (is (equal '("0.0" "0.2" "0.4" "0.6" "0.8" "1.0" "0" "1" "2" "3" "4" "5" "6" "7" "8" "9" "10")
             (axis-marks-of 0 0 10 1)))
  (is (equal '("0" "500" "1000" "1500" "2000") (subseq (axis-marks-of 0 3 1 1700) 0 5)))
  (is (equal '("-2e300" "-1e300" "0" "1e300" "2e300")
             (subseq (axis-marks-of 0 -2d300 1 2d300) 0 5)))
  (is (equal '("9996" "9998" "10000") (subseq (axis-marks-of 0 9996 1 10004) 0 3)))
  (is (equal '("0.30" "0.35") (subseq (axis-marks-of 1 0.3d0 2 0.45d0) 0 2)))
  (is (member "0.3" (axis-marks-of 0 1 0.3d0 1) :test #'search))
  (is (member "5.0" (axis-marks-of 5.1d0 5.1d0) :test #'string=)))

(test axes.of-what-is-counted-have-whole-numbers
  "Also where all numbers are the same; and never one mark alone."
  (is (equal '("0" "1" "2" "0" "1" "2") (axis-marks-of 1 1)))
  (is (equal '("0" "1" "2" "1" "2") (axis-marks-of 1 1 2 2)))
  (loop for points in '((5 5) (100 7) (3 3 4 4) (1000000 999999) (20 1 30 1) (1 1 2 2 3 3))
        do (let ((marks (apply #'axis-marks-of points)))
             (is (notany (lambda (mark) (find #\. mark)) marks) "~S" marks)
             (is (<= 4 (length marks)) "~S" marks))))

(test words.longer-than-a-line-are-broken-behind-dashes
  (is (equal '("the-way-" "round-the-" "table")
             (plots::wrap-text "the-way-round-the-table" (canvas:text-width "round-the--" 12))))
  (is (equal '("a" "word-and-" "another")
             (plots::wrap-text "a word-and-another" (canvas:text-width "word-and-a" 12))))
  (is (equal '("supercalif" "ragilistic")
             (plots::wrap-text "supercalifragilistic" (canvas:text-width "supercalif" 12)))))

(test axes.of-logarithms-have-marks-at-powers-of-ten
  (let ((texts (chart-texts (plots:line-chart '((nil (0.001 1) (1000 1))) :log-x t))))
    (is (subsetp '("0.001" "0.01" "0.1" "1" "10" "100" "1000") texts :test #'string=))
    (is (null (member "500" texts :test #'string=))))
  (signals base:wrong-argument (plots:line-chart '((nil (0 1) (10 1))) :log-x t)))

;;; Points.

(test points.stand-where-the-axes-say
  (let* ((chart (plots:line-chart '((nil (0 0) (4 1/2) (10 1))) :percent t))
         (centers (marker-centers "#0072b2" chart)))
    (is (= 3 (length centers)))
    (loop for (x y) in centers
          for across in '("0" "4" "10")
          for upward in '("0 %" nil "100 %")
          do (is (= x (+ 1/2 (chart-number "x" (text-named across chart)))))
             (when upward
               (is (= y (+ 1/2 -4 (chart-number "y" (text-named upward chart)))))))
    (is (= (* 2 (second (second centers)))
           (+ (second (first centers)) (second (third centers)))))))

(test points.of-several-series-at-one-place-stand-beside-each-other
  (let* ((chart (plots:line-chart '((a (1 .5 .4 .6) (2 .5 .4 .6)) (b (1 .5 .4 .6) (2 .5 .4 .6))
                                    (c (1 .5 .4 .6) (2 .5 .4 .6)))))
         (bars (loop for color in '("#0072b2" "#d55e00" "#009e73")
                     append (loop for path in (colored "path" color chart)
                                  when (search "stroke-width=\"1.2\"" path)
                                    collect (subseq (chart-attribute "d" path) 1
                                                    (position #\, (chart-attribute "d" path)))))))
    (is (= 6 (length bars)))
    (is (= 6 (length (remove-duplicates bars :test #'string=))))))

(test points.without-a-number-are-gaps
  (let ((chart (plots:line-chart '((nil (1 1) (2 2) (3 nil) (4 3) (5 2) (6 nil nil nil) (7 1))))))
    (is (= 5 (length (marker-centers "#0072b2" chart))))
    (is (= 2 (length (colored "polyline" "#0072b2" chart))))
    (is (null (colored "path" "#0072b2" chart)))))

(test points.at-words-keep-their-order-and-are-not-joined
  (let ((chart (plots:line-chart '((calm ("walk" .5) (|run| .3)) (rough (fly .1) ("walk" .2)))
                                 :percent t)))
    (is (equal '("walk" "run" "fly")
               (remove-if-not (lambda (text) (member text '("walk" "run" "fly") :test #'string=))
                              (chart-texts chart))))
    (is (null (colored "polyline" "#0072b2" chart)))
    (is (search "<title>calm, walk: 50 %</title>" chart))))

(test series.look-different-without-colour
  "The first 210 series have no colour, marker and dashes in common."
  (let ((looks (loop for index below 210
                     collect (list (plots::series-color index)
                                   (plots::nth-cyclic index plots::*series-markers*)
                                   (plots::nth-cyclic index plots::*series-dashes*)))))
    (is (= 210 (length (remove-duplicates looks :test #'equal))))
    (is (= 30 (length (remove-duplicates (subseq (mapcar #'rest looks) 0 30) :test #'equal))))))

;;; Other charts.

(defparameter *curves*
  '(("quick" :steps ((10 3/4 .5 .9) (20 1/2 .3 .7)) :censored (30 30) :times (10 20 30 30))
    ("slow" :steps ((15 1/2 nil nil) (30 0 nil nil)) :times #(15 30)))
  "Curves of four and of two trials.")

(test curves.fall-where-somebody-ended
  (let* ((chart (plots:survival-chart *curves*))
         (line (first (last (colored "polyline" "#0072b2" chart))))
         (points (chart-numbers (chart-attribute "points" line))))
    (flet ((x (text) (+ 1/2 (chart-number "x" (text-named text chart))))
           (y (text) (+ 1/2 -4 (chart-number "y" (text-named text chart)))))
      (let* ((top (y "100 %")) (unit (/ (- (y "0 %") top) 4)))
        (is (equal (list top top (+ top unit) (+ top unit) (+ top (* 2 unit)) (+ top (* 2 unit)))
                   (loop for (nil y) on points by #'cddr collect y))))
      (is (equal (list (x "0") (x "10") (x "10") (x "20") (x "20") (x "30"))
                 (loop for (x) on points by #'cddr collect x))))))

(test curves.say-how-many-are-left
  (let ((texts (chart-texts (plots:survival-chart *curves* :risk-label "under way" :width 400))))
    (is (equal '("under way" "4" "4" "4" "3" "3" "2" "2" "2" "2" "2" "2" "1" "1" "1")
               (remove "" (rest (member "slow" texts :test #'string=)) :test #'string=))))
  (is (null (member "still there"
                    (chart-texts (plots:survival-chart '((a :steps ((10 1/2))))))
                    :test #'string=))))

(test differences.stand-against-zero-with-what-is-said-of-them
  (let ((texts (chart-texts (plots:difference-chart
                             '(("b - a" .125 -.01 .26 "p = 0.03") ("c - a" nil nil nil))
                             :percent t :title "<&\">"))))
    (is (subsetp '("<&\">" "b - a" "+12.5 % (-1 % to +26 %)" "p = 0.03" "c - a" "no data" "0 %")
                 texts :test #'string=))))

(test measures.stay-with-their-group
  (is (= 3 (length (colored "rect" "#8fb3cc"
                            (plots:measure-chart '((a (1 2)) (b (3)) (c ())))))))
  (let ((numbers (list 1 2)))
    (plots:measure-chart `((a ,numbers) (b (3))))
    (is (equal '(1 2) numbers))))

(test measures.are-columns-as-high-as-there-are-many
  (let* ((chart (plots:measure-chart '((a (1 1 1 1 2 2 nil 10) 2 1 2))))
         (heights (mapcar (lambda (element) (chart-number "height" element))
                          (colored "rect" "#8fb3cc" chart))))
    (is (equal '(28 14 7) heights))
    (is (subsetp '("median 2 (1 to 2)" "n = 7") (chart-texts chart) :test #'string=))))

;;; Files, and what is no data.

(test charts.are-the-same-for-the-same-numbers
  (is (string= (plots:line-chart '((a (1/2 0.25d0) (1 1/8))))
               (plots:line-chart '((a (0.5 1/4) (1d0 0.125))))))
  (is (string= (plots:survival-chart *curves*) (plots:survival-chart *curves*)))
  (let ((numbers (loop for n below 500 collect (mod (* n n 7919) 1009))))
    (is (string= (plots:measure-chart `((a ,numbers)))
                 (plots:measure-chart `((a ,(coerce (reverse numbers) 'vector))))))))

(test charts.without-data-say-so
  (dolist (chart (list (plots:line-chart '()) (plots:line-chart '((nil)))
                       (plots:survival-chart '()) (plots:difference-chart '())
                       (plots:measure-chart '())))
    (is (member "no data" (chart-texts chart) :test #'string=)))
  (is (member "a (no data)" (chart-texts (plots:line-chart '(("a") ("b" (1 2)))))
              :test #'string=)))

(test charts.are-saved-as-their-names-end
  (with-scratch-file (file "svg")
    (let ((chart (plots:line-chart '((a (1 2))))))
      (is (equal (truename file) (plots:save-chart file chart)))
      (is (string= chart (uiop:read-file-string file)))
      (signals base:wrong-argument (plots:save-chart "chart.gif" chart))
      (signals base:wrong-argument (plots:save-chart file '((a (1 2))))))))

(test charts.refuse-what-is-no-data
  (macrolet ((refused (&rest forms)
               `(progn ,@(loop for form in forms
                               collect `(signals base:wrong-argument ,form)))))
    (refused (plots:line-chart 5) (plots:line-chart '(5)) (plots:line-chart '((a 5)))
             (plots:line-chart '((a (1)))) (plots:line-chart '((a (1 2 3 4 5))))
             (plots:line-chart '((a (1 . 2)))) (plots:line-chart '((a (1 :high))))
             (plots:line-chart '((a (nil 1)))) (plots:line-chart '((a (1 2))) :title 5)
             (plots:line-chart '((a (1 2))) :width 20)
             (plots:line-chart '((a (1 2))) :range 5)
             (plots:line-chart `((a (1 ,sb-ext:double-float-positive-infinity))))
             (plots:survival-chart '((a :steps ((1 2)))))
             (plots:survival-chart '((a :times (-1))))
             (plots:difference-chart '((a))) (plots:measure-chart '((a 5))))))
