;;;; designs.lisp -- points drawn from ranges: how evenly they lie, and experiments that use them.

(in-package :ars-magna.tests)

(def-suite* designs :in ars-magna)

(defun column-of-points (points dimension)
  (mapcar (lambda (point) (nth dimension point)) points))

(defun one-in-each-part-p (numbers)
  "True if each of as many equal parts of [0, 1) as there are NUMBERS has one of these."
  (let ((count (length numbers)))
    (equal (loop for i below count collect i)
           (sort (mapcar (lambda (number) (floor (* number count))) numbers) #'<))))

(test sobol.is-the-published-sequence
  "The first points in three dimensions, as Joe and Kuo print them beside their numbers."
  (flet ((eighths (&rest numbers) (mapcar (lambda (number) (* number (expt 2 29))) numbers)))
    (is (equal (eighths 0 4 6 2 3 7 5 1) (stats::sobol-numbers 8 0)))
    (is (equal (eighths 0 4 2 6 3 7 1 5) (stats::sobol-numbers 8 1)))
    (is (equal (eighths 0 4 2 6 5 1 7 3) (stats::sobol-numbers 8 2)))))

(test sobol.has-one-number-in-each-slice
  (dolist (count '(2 8 64 512))
    (loop with points = (stats:design-points :sobol count stats:+most-dimensions+ 7)
          for dimension below stats:+most-dimensions+
          do (is-true (one-in-each-part-p (column-of-points points dimension))))))

(test sobol.has-one-point-in-each-box-of-two-dimensions
  "In the first two dimensions each box of the sizes 1/2^I and 1/2^(6 - I) has one of 64 points."
  (let ((points (stats:design-points :sobol 64 2 11)))
    (loop for i from 0 to 6
          do (is (= 64 (length (remove-duplicates
                                (loop for (x y) in points
                                      collect (list (floor (* x (expt 2 i)))
                                                    (floor (* y (expt 2 (- 6 i))))))
                                :test #'equal)))))))

(test sobol.directions-begin-with-odd-numbers-below-their-place
  "What any table of direction numbers must hold (Sobol 1967): M of place K is odd and below 2^K."
  (dotimes (dimension stats:+most-dimensions+)
    (loop for direction across (stats::direction-numbers dimension)
          for place from 1
          for odd = (/ direction (expt 2 (- 32 place)))
          do (is-true (and (integerp odd) (oddp odd) (< odd (expt 2 place)))))))

(test latin-hypercube.has-one-number-in-each-part
  (dolist (count '(1 2 7 100))
    (loop with points = (stats:design-points :latin-hypercube count 3 5)
          for dimension below 3
          do (is-true (one-in-each-part-p (column-of-points points dimension))))))

(test latin-hypercube.has-all-orders-alike
  "Each of the six orders of three parts comes in a sixth of 6,000 designs, to four deviations."
  (let ((counts (make-hash-table :test 'equal)))
    (loop for seed below 6000
          do (incf (gethash (mapcar (lambda (number) (floor (* 3 number)))
                                    (column-of-points
                                     (stats:design-points :latin-hypercube 3 1 seed) 0))
                            counts 0)))
    (is (= 6 (hash-table-count counts)))
    (loop for count being the hash-values of counts
          do (is (< (abs (- count 1000)) (* 4 (sqrt (* 6000 1/6 5/6))))))))

(test designs.of-more-points-begin-with-those-there-were
  (dolist (kind '(:sobol :random))
    (is (equal (stats:design-points kind 20 2 3)
               (subseq (stats:design-points kind 50 2 3) 0 20)))
    (is (equal (column-of-points (stats:design-points kind 20 2 3) 1)
               (column-of-points (stats:design-points kind 20 4 3) 1)))
    (is (not (equal (stats:design-points kind 20 2 3) (stats:design-points kind 20 2 4))))))

;;; In experiments.

(defun values-of-conditions (name)
  "Return what the conditions of the experiment QUESTION give NAME."
  (mapcar (lambda (condition)
            (second (assoc name (experiment::condition-settings condition))))
          (experiment:experiment-conditions (experiment:find-experiment 'question))))

(defun define-sampled (&rest part)
  (eval `(define-for-test (:robots ars-worlds:dot) (:run (list size legs)) (:vary ,part))))

(test designs.take-values-from-ranges
  (define-sampled :latin-hypercube 10 '(size 2 4) '(legs 1 5 :integer))
  (let ((sizes (values-of-conditions 'size)) (legs (values-of-conditions 'legs)))
    (is (equal '(0 1 2 3 4 5 6 7 8 9)
               (sort (mapcar (lambda (size) (floor (* 5 (- size 2)))) sizes) #'<)))
    (is (equal '(1 1 2 2 3 3 4 4 5 5) (sort (copy-list legs) #'<)))
    (is-true (every (lambda (size) (<= (length (experiment::value-text size)) 7)) sizes))))

(test designs.have-as-many-below-a-tenth-as-above-on-a-scale-of-logarithms
  (define-sampled :sobol 8 '(size 1/100 1 :log) '(legs 0 1))
  (is (= 4 (count-if (lambda (size) (< size 1/10)) (values-of-conditions 'size))))
  (is-true (every (lambda (size) (<= 1/100 size 1)) (values-of-conditions 'size))))

(test designs.try-a-point-once
  (define-sampled :random 200 '(size 1 3 :integer) '(legs 1 2 :integer))
  (is (= 6 (length (values-of-conditions 'size)))))

(test designs.are-combined-with-what-else-varies
  (eval '(define-for-test (:robots ars-worlds:dot) (:run (list size way))
          (:vary (:random 3 (size 0 1)) (way 1 2))))
  (is (= 6 (length (values-of-conditions 'size))))
  (is (equal '(1 2 1 2 1 2) (values-of-conditions 'way))))

(test designs.go-by-their-seed
  (flet ((sizes (&rest part)
           (apply #'define-sampled part)
           (values-of-conditions 'size)))
    (let ((ranges '((size 0 1) (legs 0 1))))
      (is (equal (apply #'sizes :random 5 ranges) (apply #'sizes :random 5 :seed 0 ranges)))
      (is (not (equal (apply #'sizes :random 5 ranges)
                      (apply #'sizes :random 5 :seed 1 ranges)))))))

(test designs.that-grow-keep-the-rows-there-are
  (with-directories (directory)
    (flet ((trials (count)
             (define-sampled :sobol count '(size 0 1) '(legs 1 9))
             (experiment:run-experiment 'question :trials 2 :workers 1 :stream nil
                                                  :directory directory)
             (file-lines (uiop:subpathname directory "rows.csv"))))
      (let ((before (trials 4)) (after (trials 8)))
        (is (= 9 (length before)))
        (is (= 17 (length after)))
        (is (null (set-difference before after :test #'string=)))))))

(test designs.that-cannot-be-are-refused
  (macrolet ((refused (wrong &rest vary)
               `(rejected-clause ,wrong (:robots ars-worlds:dot) (:run (list size legs))
                  (:vary ,@vary))))
    (refused (:sobol 8) (:sobol 8))
    (refused (:sobol (size 0 1)) (:sobol (size 0 1)))
    (refused (:random 0 (size 0 1)) (:random 0 (size 0 1)))
    (refused (:random 3 :seed 1/2 (size 0 1)) (:random 3 :seed 1/2 (size 0 1)))
    (refused (size 0) (:sobol 8 (size 0)))
    (refused (size 0 1 :cube) (:sobol 8 (size 0 1 :cube)))
    (refused (size 1 0) (:sobol 8 (size 1 0)))
    (refused (size 0 1 :log) (:sobol 8 (size 0 1 :log)))
    (refused (size 0 1/2 :integer) (:sobol 8 (size 0 1/2 :integer)))
    (refused (size "a" 2) (:sobol 8 (size "a" 2)))
    (refused (:robots 0 1) (:sobol 8 (:robots 0 1)))
    (refused (base:motion-noise* -3 -1) (:sobol 8 (base:motion-noise* -3 -1)))
    (refused (:vary (:sobol 8 (size 0 1)) (size 1 2)) (:sobol 8 (size 0 1)) (size 1 2))))

(test designs.are-not-compared-level-by-level
  (define-sampled :sobol 4 '(size 0 1) '(legs 1 9))
  (let ((results (experiment:run-experiment 'question :trials 2 :workers 1 :stream nil)))
    (handler-case (experiment:compare-levels results 'size :stream nil)
      (base:misuse (condition) (is (search ":sobol" (princ-to-string condition))))
      (:no-error (comparison) (fail "~A" comparison)))))

;;; Lists.

(test tables.have-lists-as-json
  (is (equal '("[[1.0, 8], [-1.2, 13]]" "[\"go\", 0.5, true, false, \"A \\\"b\\\" \\\\\"]" "FALSE")
             (mapcar #'experiment::value-text
                     '(((1.0 8) (-1.2 13)) (:go 1/2 t nil "A \"b\" \\") ())))))

(test tables.have-no-characters-that-no-file-can-have
  (is (string= "bad x" (experiment::plain-text (format nil "bad ~Cx" (code-char #xD800)))))
  (with-directories (directory)
    (define-for-test (:robots ars-worlds:dot) (:trials 2)
      (:run (error "bad ~A" (code-char #xDC00))))
    (experiment:run-experiment 'question :workers 1 :stream nil :directory directory)
    (is (= 3 (length (table-lines directory))))))

(test directories.are-called-as-told
  (with-directories (directory)
    (dolist (name '("a*b" "a?b" "[ab]" "a\\b"))
      (let ((name (format nil "~A~A" (base:native-name (base:path-of-name directory)) name)))
        (define-for-test (:robots ars-worlds:dot) (:trials 1) (:run t))
        (experiment:run-experiment 'question :workers 1 :stream nil :directory name)
        (is (= 2 (length (file-lines (base:native-path (format nil "~A/rows.csv" name))))))))))
