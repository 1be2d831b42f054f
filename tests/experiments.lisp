;;;; experiments.lisp -- definitions of experiments, and their trials.

(in-package :ars-magna.tests)

(def-suite* experiments :in ars-magna)

(defmacro define-for-test (&body clauses)
  "Define the experiment QUESTION with CLAUSES, as a user would."
  `(eval '(experiment:defexperiment question ,@clauses)))

(defun rows-of (results)
  "Return what came of all trials of RESULTS: lists (condition trial outcome reason ticks error)."
  (loop for sample in (experiment:results-samples results)
        append (cl:map 'list #'list
                       (make-list (length (experiment:sample-trials sample))
                                  :initial-element (experiment:sample-condition sample))
                       (experiment:sample-trials sample) (experiment:sample-outcomes sample)
                       (experiment:sample-reasons sample) (experiment:sample-ticks sample)
                       (experiment:sample-errors sample))))

(defun outcomes (&key (trials 1) (workers 1))
  "Run QUESTION and return lists (outcome reason ticks error)."
  (mapcar #'cddr (rows-of (experiment:run-experiment 'question :trials trials :workers workers
                                                               :stream nil))))

(defun measured (results measure)
  "Return what RESULTS have for MEASURE, trial by trial, in one list."
  (loop for sample in (experiment:results-samples results)
        append (coerce (experiment:sample-measure results sample measure) 'list)))

;;; Definitions.

(defmacro rejected-clause (clause &body clauses)
  "Check that an experiment of CLAUSES is rejected because of CLAUSE."
  `(let ((condition (handler-case (progn (define-for-test ,@clauses) nil)
                      (base:malformed-definition (condition) condition))))
     (is-true condition "~S" ',clauses)
     (when condition
       (is (equal (princ-to-string ',clause)
                  (princ-to-string (basics::malformed-definition-clause condition)))))))

(test definition.shows-the-clause-that-is-wrong
  (rejected-clause (:robots nobody) (:robots nobody) (:run t))
  (rejected-clause (:robots ars-worlds:dot ars-worlds:robbie)
    (:robots ars-worlds:dot ars-worlds:robbie) (:run t))
  (rejected-clause (:trials 0) (:robots ars-worlds:dot) (:run t) (:trials 0))
  (rejected-clause (:limit 1/2) (:robots ars-worlds:dot) (:run t) (:limit 1/2))
  (rejected-clause (:trils 3) (:robots ars-worlds:dot) (:run t) (:trils 3))
  (rejected-clause (:run t) (:robots ars-worlds:dot) (:run t) (:run t))
  (rejected-clause (:run) (:robots ars-worlds:dot) (:run))
  (rejected-clause (foo 3) (:robots ars-worlds:dot) (:run t) (:parameters (foo 3)))
  (rejected-clause x (:robots ars-worlds:dot) (:run t) (:measure x))
  (rejected-clause (b (base:braking* 1)) (:robots ars-worlds:dot) (:run t)
    (:conditions (a (base:max-speed* 1)) (b (base:braking* 1)))))

(test definition.says-that-names-of-robots-that-vary-are-quoted
  (is-true (has-words-p (handler-case (define-for-test (:vary (:robots 1)) (:run t))
                          (base:malformed-definition (condition) (princ-to-string condition)))
                        "'(ann bob)")))

(defun own-element ()
  "Return a list that is an element of itself."
  (let ((list (list 1 2))) (setf (second list) list) list))

(test definition.shows-the-value-that-is-wrong
  (rejected-clause (base:motion-noise* -1) (:robots ars-worlds:dot) (:run t)
    (:vary (base:motion-noise* -1)))
  (rejected-clause (size 1 1) (:robots ars-worlds:dot) (:run size) (:vary (size 1 1)))
  (rejected-clause (size #'car) (:robots ars-worlds:dot) (:run size) (:vary (size #'car)))
  (rejected-clause (size :in (list (own-element))) (:robots ars-worlds:dot) (:run size)
    (:vary (size :in (list (own-element)))))
  (rejected-clause (size :in 3) (:robots ars-worlds:dot) (:run size) (:vary (size :in 3)))
  (rejected-clause ticks (:robots ars-worlds:dot) (:run ticks) (:vary (ticks 1 2)))
  (rejected-clause (t 3) (:robots ars-worlds:dot) (:run t) (:vary (t 3))))

(test definition.says-what-a-mistyped-keyword-may-have-meant
  (handler-case (define-for-test (:robots ars-worlds:dot) (:run t) (:trails 3))
    (base:malformed-definition (condition)
      (is (search ":trials" (princ-to-string condition))))
    (:no-error (name) (fail "~A was defined" name))))

(test definition.says-which-values-are-one-in-the-table
  (handler-case (define-for-test (:robots ars-worlds:dot) (:run size) (:vary (size 1 2 "a" 'a)))
    (base:malformed-definition (condition)
      (is (search "the third and the fourth are both \"a\"" (princ-to-string condition))))
    (:no-error (name) (fail "~A was defined" name))))

(test definition.refuses-values-that-are-one-number
  (rejected-clause (size 1 2 1.0) (:robots ars-worlds:dot) (:run size) (:vary (size 1 2 1.0)))
  (rejected-clause (size 1/2 0.5) (:robots ars-worlds:dot) (:run size) (:vary (size 1/2 0.5))))

(test definition.doubts-what-is-varied-and-not-used
  (signals base:definition-warning
    (define-for-test (:robots ars-worlds:dot) (:run t) (:vary (motion-nois* 0 1)))))

(test conditions.are-all-combinations
  (define-for-test (:robots ars-worlds:dot) (:run size)
    (:vary (base:motion-noise* 0 1/2) (size 1 2 3)))
  (is (equal '("motion-noise*=0 size=1" "motion-noise*=0 size=2" "motion-noise*=0 size=3"
               "motion-noise*=0.5 size=1" "motion-noise*=0.5 size=2" "motion-noise*=0.5 size=3")
             (mapcar #'experiment::condition-name
                     (experiment:experiment-conditions (experiment:find-experiment 'question))))))

(test conditions.may-be-named-and-combined
  (define-for-test (:robots ars-worlds:dot) (:run size)
    (:conditions (calm (base:motion-noise* 0)) (rough (base:motion-noise* 1)))
    (:vary (size 1 2)))
  (is (equal '("calm size=1" "calm size=2" "rough size=1" "rough size=2")
             (mapcar #'experiment::condition-name
                     (experiment:experiment-conditions (experiment:find-experiment 'question))))))

(test conditions.are-found-by-number-name-and-part
  (define-for-test (:robots ars-worlds:dot) (:run size) (:vary (size 1 2 33)))
  (flet ((name (designator)
           (experiment::condition-name (experiment:find-condition 'question designator))))
    (is (string= "size=2" (name 2)))
    (is (string= "size=2" (name "SIZE=2")))
    (is (string= "size=33" (name "33")))
    (signals base:unknown-name (name "size"))
    (signals base:unknown-name (name 4))
    (signals base:unknown-name (name "")))
  (signals base:unknown-name (experiment:find-condition 'no-question 1)))

(defvar *question-margin* 1 "A user's special variable.")

(test conditions.give-variables-parameters-specials-and-robots-their-values
  (define-for-test (:vary (:robots 'ars-worlds:dot 'ars-worlds:robbie) (base:max-speed* 1 2)
                          (depth 3 4) (*question-margin* 70))
    (:run t)
    (:measure (speed base:max-speed*) (deep depth) (margin *question-margin*)
              (map (run:simulation-name (time:current-simulation)))))
  (let ((results (experiment:run-experiment 'question :trials 1 :workers 1 :stream nil)))
    (is (equal '(1 1 2 2 1 1 2 2) (measured results 'speed)))
    (is (equal '(3 4 3 4 3 4 3 4) (measured results 'deep)))
    (is (equal '(70 70 70 70 70 70 70 70) (measured results "margin")))
    (is (equal '("tiny" "tiny" "tiny" "tiny" "watson" "watson" "watson" "watson")
               (mapcar #'string-downcase (measured results 'map))))))

(test parameters.are-the-manuals-but-where-the-experiment-says
  (let ((base:max-speed* 3))
    (define-for-test (:robots ars-worlds:dot) (:run t) (:clean)
      (:parameters (base:camera-desig-delay* 7)) (:vary (base:prob-stop* 1/8))
      (:measure (speed base:max-speed*) (delay base:camera-desig-delay*) (stop base:prob-stop*)
                (noise base:motion-noise*) (perfect base:no-sensor-error*)))
    (let ((results (experiment:run-experiment 'question :trials 1 :workers 2 :stream nil)))
      (is (equal (list (base:parameter-default (base:find-parameter 'base:max-speed*)))
                 (measured results 'speed)))
      (is (equal '(7) (measured results 'delay)))
      (is (equal '(0.125d0) (measured results 'stop)))
      (is (equalp '(0.0) (measured results 'noise)))
      (is (equal '(t) (measured results 'perfect))))))

;;; Trials.

(test seeds.are-common-to-all-conditions
  (define-for-test (:robots ars-worlds:dot) (:seed 40) (:run size) (:vary (size 1 2))
    (:measure (seed-of-run (run:simulation-seed (time:current-simulation)))
              (chance (base:roll (world:world-dice world:*world* :user)))))
  (let* ((results (experiment:run-experiment 'question :trials 5 :workers 2 :stream nil))
         (chances (measured results 'chance)))
    (is (equal '(41 42 43 44 45 41 42 43 44 45) (measured results 'seed-of-run)))
    (is (equal (subseq chances 0 5) (subseq chances 5)))
    (is (= 5 (length (remove-duplicates (subseq chances 0 5)))))))

(test lisps-own-dice.depend-on-the-seed-too
  (define-for-test (:robots ars-worlds:dot) (:run t) (:measure (x (random 1d0))))
  (flet ((values-by (workers)
           (measured (experiment:run-experiment 'question :trials 20 :workers workers :stream nil)
                     'x)))
    (is (equal (values-by 1) (values-by 2)))
    (is (= 20 (length (remove-duplicates (values-by 1)))))))

;;; Fluents that a global variable holds.

(defvar *laps* (rpl:create-fluent 'laps 0))

(rpl:def-interp-proc laps (n)
  (rpl:set-value *laps* 0)
  (rpl:n-times n
    (driver:rpl-robot-turn 1)
    (rpl:wait-for driver:robot-stopped*)
    (rpl:set-value *laps* (+ 1 (rpl:fluent-value *laps*))))
  (rpl:fluent-value *laps*))

(defun define-lapping ()
  (define-for-test (:robots ars-worlds:dot)
    (:run (driver:run-plan 'laps 3))
    (:success (= 3 (rpl:fluent-value *laps*)))
    (:measure (laps (rpl:fluent-value *laps*)))))

(test trials.have-fluents-of-their-own
  (define-lapping)
  (rpl:set-value *laps* 7)
  (flet ((values-by (workers)
           (measured (experiment:run-experiment 'question :trials 300 :workers workers :stream nil)
                     'laps)))
    (dolist (workers '(1 2 4))
      (is (equal (make-list 300 :initial-element 3) (values-by workers)))))
  (is (= 7 (rpl:fluent-value *laps*)) "outside it is what it was"))

(test trials.begin-with-fluents-as-they-are
  (rpl:set-value *laps* 7)
  (define-for-test (:robots ars-worlds:dot)
    (:run (rpl:set-value *laps* (1+ (rpl:fluent-value *laps*))) (run:run-ticks 3))
    (:measure (laps (rpl:fluent-value *laps*))))
  (is (equal (make-list 20 :initial-element 8)
             (measured (experiment:run-experiment 'question :trials 20 :workers 2 :stream nil)
                       'laps))))

(test trials.opened-again-have-fluents-of-their-own
  (define-lapping)
  (rpl:set-value *laps* 7)
  (let* ((seen nil)
         (replay (experiment:replay-trial 'question 1 1
                                          :then (lambda ()
                                                  (setf seen (rpl:fluent-value *laps*))))))
    (is (equal '((laps 3)) (getf replay :measures)))
    (is (= 3 seen) "who looks at the trial sees that of the trial")
    (is (= 7 (rpl:fluent-value *laps*)))))

(test trials.can-be-forked-with-fluents-of-their-own
  (rpl:set-value *laps* 7)
  (define-for-test (:robots ars-worlds:dot)
    (:run (rpl:set-value *laps* 1)
          (run:with-fork () (driver:run-plan 'laps 3))
          (rpl:fluent-value *laps*))
    (:measure (laps (rpl:fluent-value *laps*))
              (ahead (run:with-fork () (driver:run-plan 'laps 2) (rpl:fluent-value *laps*)))))
  (let ((results (experiment:run-experiment 'question :trials 20 :workers 2 :stream nil)))
    (is (equal (make-list 20 :initial-element 1) (measured results 'laps)))
    (is (equal (make-list 20 :initial-element 2) (measured results 'ahead)))))

(test trials.can-be-rewound-with-fluents-of-their-own
  (rpl:set-value *laps* 7)
  (define-for-test (:robots ars-worlds:dot)
    (:run (run:keep-forks t)
          (rpl:set-value *laps* 1)
          (run:run-ticks 5)
          (driver:run-plan 'laps 3)
          (run:rewind (- (run:simulation-tick) 5)))
    (:measure (laps (rpl:fluent-value *laps*))))
  (is (equal (make-list 5 :initial-element 1)
             (measured (experiment:run-experiment 'question :trials 5 :workers 2 :stream nil)
                       'laps)))
  (is (= 7 (rpl:fluent-value *laps*))))

(test outcomes.are-those-of-plans
  (eval '(rpl:def-interp-proc outcome-plan (what)
          (case what
            (succeed t)
            (fail (rpl:fail :class 'no-way))
            (err (error "in Lisp"))
            (wait (rpl:wait-for (rpl:create-fluent nil)))
            (last (rpl:wait-time 1000)))))
  (define-for-test (:robots ars-worlds:dot) (:limit 30)
    (:vary (what 'succeed 'fail 'err 'wait 'last))
    (:run (driver:run-plan 'outcome-plan what)))
  (let ((outcomes (outcomes)))
    (is (equal '(("success" "") ("failure" "no-way") ("failure" "lisp-failure")
                 ("failure" "deadlock") ("limit" ""))
               (mapcar (lambda (outcome) (subseq outcome 0 2)) outcomes)))
    (is (search "in Lisp" (fourth (third outcomes))))
    (is (= 30 (third (fifth outcomes))))))

(test outcomes.are-what-run-returns
  (define-for-test (:robots ars-worlds:dot) (:vary (number 1 2 3 4))
    (:run (ecase number
            (1 t) (2 nil) (3 (values nil 'too-far)) (4 (values nil (format nil "so, ~%it is"))))))
  (is (equal '(("success" "" 0 "") ("failure" "" 0 "") ("failure" "too-far" 0 "")
               ("failure" "so, it is" 0 ""))
             (outcomes))))

(test outcomes.by-a-form-of-their-own
  (define-for-test (:robots ars-worlds:dot) (:limit 10) (:vary (number 1 2 3 4))
    (:run (ecase number (1 t) (2 nil) (3 (loop (run:run-ticks 1))) (4 (loop (run:run-ticks 1)))))
    (:success (evenp number)))
  (is (equal '(("failure" "only-believed") ("success" "") ("limit" "") ("success" ""))
             (mapcar (lambda (row) (subseq row 0 2)) (outcomes)))))

(test outcomes.can-look-at-what-run-returned
  (define-for-test (:robots ars-worlds:dot) (:limit 10) (:vary (number 1 2))
    (:run (if (= number 1) (values 3 'why) (loop (run:run-ticks 1))))
    (:success (eql 3 (first (experiment:trial-values))))
    (:measure (count (length (experiment:trial-values)))))
  (let ((results (experiment:run-experiment 'question :trials 1 :workers 1 :stream nil)))
    (is (equal '("success" "limit") (mapcar #'third (rows-of results))))
    (is (equal '(2 0) (measured results 'count)))))

(test limit.is-kept-whatever-runs
  (define-for-test (:robots ars-worlds:dot) (:limit 25) (:vary (number 1 2 3 4 5))
    (:run (ecase number
            (1 (run:run-ticks 25) t)
            (2 (run:run-ticks 26) t)
            (3 (run:run-until (constantly nil)))
            (4 (loop (ignore-errors (run:run-ticks 10))))
            (5 (run:with-simulation (ars-worlds:robbie) (run:run-ticks 1000) t)))))
  (is (equal '(("success" 25) ("limit" 25) ("limit" 25) ("limit" 25) ("success" 0))
             (mapcar (lambda (row) (list (first row) (third row))) (outcomes)))))

(test continuation-programs.run-until-a-form-is-true
  (define-for-test (:robots ars-worlds:dot) (:limit 40) (:vary (distance 2 100))
    (:run (let ((told (list nil)))
            (setf (get 'outcomes :told) told)
            (command:robot-go-forward ars-worlds:dot distance
                                      (lambda (err robot) (declare (ignore err robot))
                                        (setf (first told) t)))))
    (:until (first (get 'outcomes :told))))
  (destructuring-bind (near far) (outcomes)
    (is (string= "success" (first near)))
    (is (< 1 (third near) 40))
    (is (member (first far) '("success" "limit") :test #'string=))))

(test errors.are-rows
  (define-for-test (:robots ars-worlds:dot)
    (:vary (what 'error 'abort 'throw 'break 'deep 'debugger))
    (:run (labels ((deep (n) (+ 1 (deep (+ n 1)))))
            (ecase what
              (error (error "no, ~A~%never" 3)) (abort (abort)) (throw (throw 'nowhere 3))
              (break (break "hm")) (deep (deep 1))
              (debugger (invoke-debugger (make-condition 'simple-error :format-control "so"))))))
    (:measure (x 1)))
  (let ((rows (experiment:results-samples
               (experiment:run-experiment 'question :trials 2 :workers 2 :stream nil))))
    (is (= 6 (length rows)))
    (dolist (sample rows)
      (is (equalp #("error" "error") (experiment:sample-outcomes sample)))
      (is (string/= "" (aref (experiment:sample-errors sample) 0)))
      (is (equal (aref (experiment:sample-errors sample) 0)
                 (aref (experiment:sample-errors sample) 1))))))

(test errors.in-continuations-are-errors-of-the-trial
  (define-for-test (:robots ars-worlds:dot)
    (:run (command:robot-turn ars-worlds:dot 1
                              (lambda (err robot angle) (declare (ignore err robot angle))
                                (error "in mine")))
          (run:run-ticks 20)
          t))
  (destructuring-bind ((outcome reason ticks error)) (outcomes)
    (is (equal '("error" "" 5) (list outcome reason ticks)))
    (is (search "in mine" error))))

(test trials.are-silent-and-see-the-same-surroundings
  (define-for-test (:robots ars-worlds:dot)
    (:run (print :hello) (format *error-output* "hello") (warn "hello") t)
    (:measure (text (prin1-to-string (list 'some 1d0 1.0 "x"))) (base (princ-to-string 10))))
  (let* ((*print-base* 2) (*print-case* :downcase) (*read-default-float-format* 'double-float)
         (results nil)
         (text (with-output-to-string (*standard-output*)
                 (let ((*error-output* *standard-output*))
                   (setf results (experiment:run-experiment 'question :trials 2 :workers 1
                                                                      :stream nil))))))
    (is (string= "" text))
    (is (equal '(10 10) (measured results 'base)))
    (is (equal '("(SOME 1.0d0 1.0 \"x\")" "(SOME 1.0d0 1.0 \"x\")") (measured results 'text)))))

;; The second measure sees what the first has set.
(test trials.write-numbers-alike-whatever-they-set-the-printer-to
  (define-for-test (:robots ars-worlds:dot)
    (:run (setf *print-base* 16 *print-radix* t *print-case* :capitalize *print-length* 1) 17)
    (:measure (number 17) (list '(17 red 1/2)) (small (setf *read-base* 8)) (float 17.5d0))
    (:each-tick (number 17)))
  (let ((results (experiment:run-experiment 'question :trials 1 :workers 1 :stream nil)))
    (is (equal '((17) ("[17, \"red\", 0.5]") (8) (17.5d0))
               (mapcar (lambda (name) (measured results name)) '(number list small float))))))

(test reports.write-numbers-alike-whatever-the-printer-is-set-to
  (define-for-test (:robots ars-worlds:dot) (:vary (way 10 20)) (:run way) (:measure (w way)))
  (let ((results (experiment:run-experiment 'question :trials 20 :workers 1 :stream nil)))
    (flet ((texts ()
             (with-output-to-string (out)
               (experiment:print-results results out)
               (experiment:compare-conditions results 1 2 :stream out))))
      (is (string= (texts)
                   (let ((*print-base* 16) (*print-radix* t) (*read-base* 8)) (texts)))))))

(test digests.are-those-of-the-bare-run
  (define-for-test (:robots ars-worlds:dot)
    (:run (command:robot-go-forward ars-worlds:dot 3) (run:run-ticks 12) t))
  (let* ((experiment (experiment:find-experiment 'question))
         (condition (first (experiment:experiment-conditions experiment))))
    (loop for trial from 1 to 5
          do (is (= (run:with-simulation (ars-worlds:dot :seed trial)
                      (command:robot-go-forward ars-worlds:dot 3)
                      (run:run-ticks 12)
                      (run:state-digest))
                    (experiment::result-digest
                     (experiment::run-trial experiment condition trial)))))))

(test progress.names-what-has-been-under-way-for-long
  (define-for-test (:robots ars-worlds:dot) (:run t))
  (let ((progress (experiment::make-progress nil nil 10 2))
        (condition (first (experiment:experiment-conditions
                           (experiment:find-experiment 'question)))))
    (is (null (experiment::slow-trial-text progress)))
    (setf (svref (experiment::progress-under-way progress) 2) (list condition 3 0))
    (is (search "trial 3 of all" (experiment::slow-trial-text progress)))))
