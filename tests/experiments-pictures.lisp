;;;; experiments-pictures.lisp -- pictures of results, and maps with the ways of trials.

(in-package :ars-magna.tests)

(def-suite* experiments-pictures :in ars-magna)

;;; Which conditions stand where.

(defun grid (&rest levels)
  "Return conditions for the whole grid of LEVELS, lists of texts, with ten trials each."
  (let ((texts (reduce (lambda (rests level)
                         (loop for text in level
                               append (loop for rest in rests collect (cons text rest))))
                       (reverse levels) :initial-value '(()))))
    (loop for one in texts
          for i from 1
          collect (list* one (loop for j from 1 to 10
                                   collect (list (if (<= j (mod i 11)) "success" "failure")
                                                 :ticks (* 10 j) :values (list j)))))))

(defun panel-shapes (results)
  "Return for each panel of RESULTS where it is, and what its series are called."
  (loop for panel in (experiment::panels (experiment:results-samples results)
                                         (experiment::series-factors results)
                                         (experiment:results-factors results))
        collect (cons (experiment::panel-where panel)
                      (mapcar #'first (experiment::panel-series panel)))))

(test panels.have-numbers-along-them-and-words-as-series
  (with-report (results '("way" "noise") '() (grid '("a" "b") '("0" "1" "2")))
    (is (= 1 (experiment::x-axis-factor results)))
    (is (equal '((nil "a" "b")) (panel-shapes results))))
  (with-report (results '("noise") '() (grid '("0" "1" "2")))
    (is (equal '((nil nil)) (panel-shapes results))))
  (with-report (results '("way") '() (grid '("a" "b")))
    (is (= 0 (experiment::x-axis-factor results)))))

(test panels.are-several-where-series-were-too-many
  (with-report (results '("way" "size" "noise") '("m")
                        (grid '("a" "b" "c") '("x" "y" "z") '("0" "1")))
    (is (equal '(("x" "a" "b" "c") ("y" "a" "b" "c") ("z" "a" "b" "c")) (panel-shapes results))))
  (with-report (results '("way" "noise") '()
                        (grid (loop for i from 1 to 13 collect (format nil "w~D" i)) '("0" "1")))
    (is (equal '(5 5 3) (mapcar (lambda (shape) (length (rest shape))) (panel-shapes results))))))

(test panels.take-cases-as-words-and-not-what-they-decide
  (with-report (results '("case" "noise" "speed") '()
                        `((("calm" "0" "1") ("success")) (("rough" "1" "1") ("success"))))
    (is (equal '(0) (experiment::varying-factors results)))
    (is (= 0 (experiment::x-axis-factor results)))))

;;; Files.

(defun picture-names (results directory &rest options)
  (mapcar #'file-namestring (apply #'experiment:save-result-pictures results directory options)))

(test pictures.are-called-by-what-they-show
  (with-report (results '("way" "noise*") '("m") (grid '("a" "b") '("0" "1")))
    (with-directories (pictures)
      (is (equal '("success.svg" "ticks.svg" "measure-m.svg" "spread-of-m.svg" "survival.svg"
                   "difference-in-success-by-way.svg" "difference-in-ticks-by-way.svg"
                   "difference-in-success-by-noise.svg" "difference-in-ticks-by-noise.svg")
                 (picture-names results pictures)))
      (is (equal '("survival.svg") (picture-names results pictures :which '(:survival))))
      (dolist (file (experiment:save-result-pictures results pictures))
        (is-true (probe-file file))))))

(test pictures.are-the-same-each-time
  (with-report (results '("way" "noise") '("m") (grid '("a" "b" "c") '("0" "1")))
    (with-directories (one other)
      (loop for a in (experiment:save-result-pictures results one)
            for b in (experiment:save-result-pictures results other)
            do (is (string= (base:file-text a) (base:file-text b)) "~A" a)))))

(test pictures.may-be-png
  (with-report (results '("noise") '() (grid '("0" "1")))
    (with-directories (pictures)
      (if (eql 0 (base:run-command "rsvg-convert" '("--version")))
          (is (equal '("success.png")
                     (picture-names results pictures :kind :png :which '(:success))))
          (signals base:misuse
            (experiment:save-result-pictures results pictures :kind :png))))))

(test pictures.leave-out-what-there-is-nothing-of
  (with-report (results '("noise") '("m") `((("0") ,@(times 9 '("failure" :values ("word"))))))
    (with-directories (pictures)
      (is (equal '("success.svg") (picture-names results pictures)))))
  (with-report (results '("noise") '() `((("0") ,@(times 9 '("failure" :ticks 7)))
                                         (("1") ,@(times 9 '("failure" :ticks 8)))))
    (with-directories (pictures)
      (is (equal '("success.svg" "difference-in-success-by-noise.svg")
                 (picture-names results pictures))))))

(test pictures.of-anything-are-drawn
  (flet ((check (factors measures conditions)
           (with-report (results factors measures conditions)
             (with-directories (pictures)
               (let ((names (picture-names results pictures)))
                 (is (equal names (remove-duplicates names :test #'string=)))
                 (is-true names)
                 names)))))
    (check '() '("m") '((() ("success" :values (1)))))
    (check '("a") '("m") `((("") ("error" :error "boom")) (("x") ("success" :values ("TRUE")))))
    (check '("n") '("m" "M!" "m*") (grid (loop for i from 1 to 40 collect (princ-to-string i))))
    (check (list (make-string 200 :initial-element #\f)) '()
           (grid (list (make-string 300 :initial-element #\x) "é/../\"<&")))))

(test pictures.are-of-what-is-asked-for
  (with-report (results '("noise") '() (grid '("0" "1")))
    (with-directories (pictures)
      (signals base:wrong-argument
        (experiment:save-result-pictures results pictures :which '(:suces)))
      (signals base:wrong-argument (experiment:save-result-pictures results pictures :kind :gif))
      (signals base:wrong-argument (experiment:save-result-pictures results 3))
      (signals base:wrong-argument (experiment:save-result-pictures 3 pictures)))))

;;; What they show.

(defun picture-text (results which)
  "Return the first picture of RESULTS that shows WHICH."
  (with-directories (pictures)
    (base:file-text (first (experiment:save-result-pictures results pictures
                                                            :which (list which))))))

(test pictures.ask-what-the-experiment-asks
  (base:with-own-definitions ()
    (eval '(experiment:defexperiment made-up "Is it so? If not, why?"
            (:robots ars-worlds:dot) (:run t)))
    (with-report (results '("noise") '() (grid '("0" "1")))
      (is (member "Is it so?" (chart-texts (picture-text results :success)) :test #'string=)))))

(test pictures.of-success-have-a-point-for-each-condition
  (with-report (results '("noise") '() `((("0") ,@(times 10 '("success")))
                                         (("1") ,@(times 10 '("failure")))))
    (let ((chart (picture-text results :success)))
      (is (search "0: 100 % (72.25 % to 100 %)" chart))
      (is (search "1: 0 % (0 % to 27.75 %)" chart)))))

(defun written-in (file) (format nil "~{~A ~}" (chart-texts (base:file-text file))))

(defun p-written (difference)
  (format nil "p ~A" (experiment::p-text (experiment:paired-adjusted-p difference))))

(test pictures.of-differences-count-the-tests-they-show
  (with-made-up (results (append (four-plans "0") (four-plans "0.5")))
    (with-directories (pictures)
      ;; Ticks are the same in all pairs: no test.
      (loop for (name measure seeds)
              in '(("success" success
                    "; p as one of 6 tests (Holm). 60 seeds each. Over all, each seed counts once; ~
                     p as one of 3 tests.")
                   ("ticks" ticks ". 42 to 54 seeds each, those where both succeeded."))
            for file = (find (format nil "difference-in-~A-by-plan" name)
                             (experiment:save-result-pictures results pictures
                                                              :which '(:differences))
                             :key #'pathname-name :test #'string=)
            for words = (written-in file)
            for comparison = (experiment:compare-levels results 'plan :measure measure :stream nil)
            do (is (mentions-p words (format nil "each plan against a, seed by seed: first minus ~
                                                  second, with 95 % intervals~@?"
                                             seeds)))
               (loop for contrast in (append (experiment:comparison-contrasts comparison)
                                             (experiment:comparison-overall comparison))
                     for (difference) = (experiment:contrast-differences contrast)
                     do (is (mentions-p words (p-written difference))))))))

(test pictures.say-what-their-series-are
  (with-report (results '("way" "noise") '() (grid '("a" "b") '("0" "1")))
    (is (member "way" (chart-texts (picture-text results :success)) :test #'string=))
    (is (not (member "way" (chart-texts (picture-text results :survival)) :test #'string=))))
  (with-report (results '("noise" "kick") '() (grid '("0" "1") '("0.5" "0.7")))
    (let ((texts (chart-texts (picture-text results :success))))
      (is (member "kick" texts :test #'string=))
      (is (member "0.7" texts :test #'string=))
      (is (not (member "kick=0.7" texts :test #'string=)))))
  (with-report (results '("noise") '() (grid '("0" "1")))
    (is (member "noise" (chart-texts (picture-text results :survival)) :test #'string=))))

(test pictures.of-survival-never-end-what-failed
  (with-report (results '("noise") '()
                        `((("0") ("success" :ticks 100) ("failure" :ticks 5)
                                 ("error" :ticks 1 :error "boom") ("limit" :ticks 5000))))
    (let ((sample (first (experiment:results-samples results))))
      (is (= 105 (experiment::horizon (list sample) 5000)))
      (is (= 100 (experiment::horizon (list sample) 100)))
      (destructuring-bind (name &key times steps)
          (experiment::sample-curve "x" sample 105 .95d0 t)
        (is (string= "x" name))
        (is (equalp #(100 105 105 105) times))
        (is (= 1 (length steps)))
        (is (= 100 (first (first steps))))
        (is (close-p 3/4 (second (first steps))))))
    (let ((words (format nil "~{~A ~}" (chart-texts (picture-text results :survival)))))
      (is (search "limit of 5000 ticks are never done" words))
      (is (search "1 trial broke off with an error" words)))))

;;; Ways.

(defun define-wandering ()
  (eval '(experiment:defexperiment wandering
          (:robots ars-worlds:dot)
          (:vary (steps 1 2))
          (:limit 60)
          (:run (command:robot-turn ars-worlds:dot (* 2 (trial-angle)) nil)
                (run:run-ticks 20)
                (command:robot-go-forward ars-worlds:dot (* 2 steps) nil)
                (run:run-ticks 30)
                (chance-p 1/2)))))

(defun trial-angle () (base:roll (world:world-dice world:*world* :user)))

(defun end-of-trial (condition trial)
  "Return where DOT is at the end of a trial, and its outcome, by a measure."
  (let* ((sample (find (experiment::condition-name
                        (experiment:find-condition 'wandering condition))
                       (experiment:results-samples
                        (experiment:run-experiment 'wandering :trials trial :workers 1
                                                              :stream nil))
                       :key #'experiment:sample-condition :test #'string=)))
    (aref (experiment:sample-outcomes sample) (1- trial))))

(test ways.are-where-the-robot-was-tick-by-tick
  (define-wandering)
  (let* ((experiment (experiment:find-experiment 'wandering))
         (condition (experiment:find-condition experiment 2))
         (places '()))
    (experiment:run-trial experiment condition 3
                          :gate (lambda (simulation)
                                  (let ((robot (first (run:simulation-robots simulation))))
                                    (push (cons (robot:robot-x robot) (robot:robot-y robot))
                                          places))
                                  1))
    (let ((way (first (experiment::rerun-trials-for-paths experiment condition '(3)))))
      (is (= 3 (trails:way-trial way)))
      (is (< 3 (length (first (trails:way-pieces way)))))
      (is (equal (remove-duplicates (reverse places) :test #'equal :from-end t)
                 (first (trails:way-pieces way))))
      (is (string= (end-of-trial 2 3) (trails:way-outcome way))))))

(test ways.change-nothing-in-the-trial
  (define-wandering)
  (let ((experiment (experiment:find-experiment 'wandering)) (digests '()))
    (loop for gate in (list nil (lambda (simulation)
                                  (run:add-observer #'run:simulation-tick simulation)
                                  1000))
          do (push (experiment:result-digest
                    (experiment:run-trial experiment (experiment:find-condition experiment 1) 2
                                          :gate gate))
                   digests))
    (is (apply #'= digests))))

(test ways.need-only-the-ends-of-what-is-straight
  (let ((points '((0 . 0) (1 . 0) (2 . 0) (3 . 0) (3 . 1) (3 . 2))))
    (is (equal '((0 . 0) (3 . 0) (3 . 2)) (trails:simplify-line points 1/10)))
    (is (equal '((0 . 0) (3 . 2)) (trails:simplify-line points 10)))
    (is (equal points (trails:simplify-line points -1)))
    (is (equal '((1 . 1)) (trails:simplify-line '((1 . 1)) 1)))
    (is (equal '() (trails:simplify-line '() 1)))
    ;; A circle has no ends.
    (is (equal '((0 . 0) (5 . 0) (0 . 0))
               (trails:simplify-line '((0 . 0) (5 . 0) (0 . 0)) 1)))))

(test ways.are-drawn-by-outcome
  (define-wandering)
  (with-directories (directory)
    (ensure-directories-exist directory)
    (let* ((file (concatenate 'string directory "ways.svg"))
           (text (progn (experiment:save-ways-picture 'wandering 1 file :trials 8)
                        (base:file-text file)))
           (outcomes (mapcar #'trails:way-outcome
                             (experiment::rerun-trials-for-paths
                              (experiment:find-experiment 'wandering)
                              (experiment:find-condition 'wandering 1)
                              '(1 2 3 4 5 6 7 8))))
           (succeeded (count "success" outcomes :test #'string=)))
      (is (< 0 succeeded 8))
      (is (search (format nil "succeeded: ~D trial" succeeded) text))
      (is (search (format nil "failed: ~D trial" (- 8 succeeded)) text))
      (experiment:save-ways-picture 'wandering 1 file :trials 8)
      (is (string= text (base:file-text file)))
      (is (search "The ways of the trials 1, 2, 3, 4, 5, 6, 7, 8, with a marker" text))
      (experiment:save-ways-picture 'wandering 1 file :trials '(2) :part '(0 0 12 6))
      (is (search "The way of each robot in trial 2, with a marker" (base:file-text file)))
      (is (< (length (base:file-text file)) (length text))))))

(test ways.are-asked-for-properly
  (define-wandering)
  (flet ((save (condition file &rest options)
           (apply #'experiment:save-ways-picture 'wandering condition file options)))
    (signals base:unknown-name (save 7 "/tmp/none.svg"))
    (signals base:wrong-argument (save 1 "/tmp/none.gif"))
    (signals base:wrong-argument (save 1 "/tmp/none.svg" :trials 0))
    (signals base:wrong-argument (save 1 "/tmp/none.svg" :trials '(0)))
    (signals base:wrong-argument (save 1 "/tmp/none.svg" :trials 1 :part '(3 3 2 9)))
    (signals base:unknown-name
      (experiment:save-ways-picture 'no-such-question 1 "/tmp/none.svg"))))

;;; The shipped figures.

(test figures.go-between-their-comments
  (is (equal '("a" "<!-- table of x -->" "```" "1 2" "```" "<!-- end of table -->" "b"
               "<!-- table of y -->" "old" "<!-- end of table -->")
             (ars-worlds::replace-table
              '("a" "<!-- table of x -->" "old" "older" "<!-- end of table -->" "b"
                "<!-- table of y -->" "old" "<!-- end of table -->")
              'x '("```" "1 2" "```")))))

(test figures.of-choosing-are-rates-and-pairs
  (is (string= "96 % (94 to 97)" (ars-worlds::rate-text 479 500)))
  (is (equal '("In 20 pairs of trials with the same seed, only the rollouts were in time;"
               "in 1 pair only the short way was in time: p < .001.")
             (ars-worlds::paired-comparison-lines
              (append (make-list 20 :initial-element "failure") '("success" "success" "limit"))
              (append (make-list 20 :initial-element "success") '("failure" "success" "failure")))))
  (is (equal "in 0 pairs only the short way was in time: p = 0.250."
             (second (ars-worlds::paired-comparison-lines '("limit" "limit" "limit")
                                                          '("success" "success" "success"))))))

(test figures.on-the-pages-exist
  (loop for (experiment page function . names) in ars-worlds::*figures*
        for text = (base:file-text (project-file (format nil "worlds/~A" page)))
        do (is (search (ars-worlds::comment-line (format nil "table of ~A" experiment)) text))
           (is-true (fboundp function))
           (dolist (name names)
             (let ((file (format nil "pictures/~(~A~)/~A.svg" experiment name)))
               (is (search file text) "~A is not on ~A" file page)
               (is-true (probe-file (project-file (format nil "worlds/~A" file))))))))

(test figures.of-rates-have-a-column-for-each-value-of-the-last-factor
  (with-report (results '("noise" "size") '()
                        (loop for (texts successes) in '((("0" "x") 10) (("0" "y") 5)
                                                         (("1" "x") 0) (("1" "y") 10))
                              collect (list* texts (append (times successes '("success"))
                                                           (times (- 10 successes)
                                                                  '("failure"))))))
    (is (equal '("| `noise` | x size | y size |" "|---|---|---|"
                 "| 0 | 100 % (72 to 100) | 50 % (24 to 76) |"
                 "| 1 | 0 % (0 to 28) | 100 % (72 to 100) |")
               (ars-worlds::rate-table-lines results)))))

(test figures.are-of-known-experiments
  (signals base:wrong-argument (ars-worlds::save-figures "no-such-experiment")))

(test figures.that-are-shipped-are-what-is-drawn-now
  "Those that take seconds. After a change of what pictures look like, run ./worlds/figures."
  (experiment::call-with-temporary-directory
   (lambda (directory)
     (let ((ars-worlds::*figures-directory* (uiop:ensure-directory-pathname directory)))
       (ars-worlds::save-quick-figures)
       (let ((files (directory (merge-pathnames "**/*.svg" ars-worlds::*figures-directory*))))
         (is (= 6 (length files)))
         (dolist (file files)
           (let ((name (enough-namestring file (truename ars-worlds::*figures-directory*))))
             (is (string= (base:file-text (project-file (format nil "worlds/~A" name)))
                          (base:file-text file))
                 "~A is older than the drawing" name))))))))

(test charts.say-how-many-trials-broke-off-with-an-error
  (with-report (results '("way") '() '((("a") ("error" :error "boom") ("success" :ticks 3))
                                       (("b") ("success" :ticks 5) ("success" :ticks 4))))
    (is-true (mentions-p (experiment::intervals-text
                          :rate (experiment::summarize-results results))
                         "1 trial broke off with an error"))))

(test comparison.counts-no-differences-that-rounding-makes
  "Sums of the same numbers in another order are no more and no less."
  (let ((difference (experiment::mean-difference
                     "x"
                     (loop for i from 1 to 12 collect (* (+ 6 i) (+ 1 double-float-epsilon)))
                     (loop for i from 1 to 12 collect (+ 6d0 i)))))
    (is (plusp (experiment:paired-low difference)))
    (is (= 1 (experiment:paired-p difference)))
    (is-false (experiment::counts-as-test-p difference))))
