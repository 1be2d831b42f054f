;;;; measures.lisp -- DEFMEASURE, and where measures are read.

(in-package :ars-magna.tests)

(def-suite* measures :in ars-magna)

(world:defmap orchard (20 6)
  (rect (0 0) (19 5) hedge 5)
  (obj apple (10.5 3.5) ((:size 1) (:weight 1))))
(robot:defrobot picker (orchard (2.5 2.5) 0) :hands (5))

(run:defmeasure progress "How far east the robot is." (robot:robot-x picker))
(run:defmeasure apples (length (world:world-thing-list world:*world*)))
(run:defmeasure nonsense (error "No such measure can be taken."))
(run:defmeasure direction-word (if (< (robot:robot-x picker) 5) :near :far))
(run:defmeasure lottery
  (+ (random 1000) (base:roll (world:world-dice world:*world* :user))))

(defun go-east (metres)
  (command:robot-go-distance picker metres)
  (run:run-ticks (+ 6 (ceiling metres 0.7))))

(test measure.is-of-the-run-in-which-it-is-read
  (run:with-simulation (picker :clean t)
    (is (= 2.5 (run:measure-value 'progress)))
    (is (= 1 (run:measure-value "apples")))
    (let ((fork (run:fork-simulation)))
      (go-east 4)
      (is (within-p 6.5 (run:measure-value 'progress)))
      (is (= 2.5 (run:call-in-fork fork (lambda () (run:measure-value 'progress)))))
      (is (eq :far (run:measure-value (run:find-measure 'direction-word)))))))

(test measure.errors-are-seen-by-who-asks
  (run:with-simulation (picker)
    (signals simple-error (run:measure-value 'nonsense))
    (is (search "Did you mean progress?"
                (handler-case (run:measure-value 'progres)
                  (base:unknown-name (trouble) (princ-to-string trouble))))))
  (signals base:misuse (run:measure-value 'progress)))

(test measure.reading-leaves-the-run-alone
  (flet ((ride (ask)
           (run:with-simulation (picker :seed 3)
             (loop repeat 15
                   do (command:robot-go-distance picker 1)
                      (run:run-ticks 2)
                      (when ask (run:measure-value 'lottery)))
             (list (run:state-digest) (random 1000000)
                   (base:roll (world:world-dice world:*world* :user))))))
    (is (equal (ride nil) (ride t))))
  (flet ((value () (run:with-simulation (picker :seed 3) (run:measure-value 'lottery))))
    (is (= (value) (value)))))

(test measure.definitions-without-a-form-are-refused
  (dolist (form '((run:defmeasure hollow) (run:defmeasure hollow "Only words.")
                  (run:defmeasure :hollow 1) (run:defmeasure 7 1) (run:defmeasure nil 1)))
    (signals base:malformed-definition (eval form)))
  (is (null (run:find-measure 'hollow nil))))

(test measure.is-redefined-and-undefined
  (base:with-own-definitions ()
    (eval '(run:defmeasure passing 1))
    (eval '(run:defmeasure passing "Now two." 2))
    (run:with-simulation (picker) (is (= 2 (run:measure-value 'passing))))
    (is (equal "Now two." (documentation 'passing 'run::measure)))
    (base:undefine 'measure 'passing)
    (is (null (run:find-measure 'passing nil)))))

;;; Experiments.

(experiment:defexperiment orchard-trip
  (:robots picker)
  (:run (go-east 4) t)
  (:measure progress (progress :over :mean) (progress :over :sum) (progress :over :max)
            (progress :over :min) (ours (run:measure-value 'progress))
            (lottery :over :max) direction-word)
  (:each-tick progress))

(defun column-of (results name)
  (coerce (experiment:sample-measure results (first (experiment:results-samples results)) name)
          'list))

(test experiment.measures-by-name-and-over-the-run
  (let* ((results (experiment:run-experiment 'orchard-trip :trials 4 :stream nil))
         (replay (experiment:replay-trial 'orchard-trip 1 2))
         (series (mapcar #'second (getf replay :series))))
    (is (equal (column-of results 'ours) (column-of results 'progress)))
    (is (= 13 (length series)))
    (is (= (second (column-of results 'progress-sum)) (getf-measure replay 'progress-sum)))
    (is (within-p (reduce #'+ series) (getf-measure replay 'progress-sum)))
    (is (within-p (/ (reduce #'+ series) 13) (getf-measure replay 'progress-mean)))
    (is (= (reduce #'max series) (getf-measure replay 'progress-max)))
    (is (= 2.5 (getf-measure replay 'progress-min)))
    (is (equal '("far" "far" "far" "far") (column-of results 'direction-word)))
    (is (null (getf replay :differences)))))

(defun getf-measure (replay name)
  (second (assoc name (getf replay :measures) :test #'string-equal)))

(run:define-run-variable *pickings* '())

(experiment:defexperiment orchard-kinds
  (:robots picker)
  (:run (push (world:find-thing 'apple) *pickings*) t)
  (:measure (pair (vector 1/2 "a" 'b)) (nested (list #() '(1) nil)) (none '())
            (hollow #()) (picked *pickings*) (apple (first *pickings*)) (robot picker) (char #\a)))

(test experiment.measures-what-run-variables-can-have
  (let ((results (experiment:run-experiment 'orchard-kinds :trials 1 :stream nil)))
    (is (equal '("[0.5, \"a\", \"b\"]" "[[], [1], false]" nil "[]" "[\"apple#1\"]" "apple#1"
                 "picker" "a")
               (loop for name in (experiment:results-measures results)
                     append (column-of results name))))))

(experiment:defexperiment orchard-odd
  (:robots picker)
  (:run t)
  (:measure (table (make-hash-table))))

(test experiment.refuses-measures-that-are-no-data
  (let ((text (getf (experiment:replay-trial 'orchard-odd 1 1) :error)))
    (is-true (has-words-p text "Error in the measure table" "a list of lists (key value)")
             "~A" text)))

(experiment:defexperiment hopeless-trip
  (:robots picker)
  (:run t)
  (:measure (left (error "no left")) (right (error "no right"))))

(test experiment.tells-of-all-measures-that-fail
  (let ((text (with-output-to-string (*standard-output*)
                (experiment:print-results
                 (experiment:run-experiment 'hopeless-trip :trials 1 :stream nil)))))
    (is-true (has-words-p text "Error in the measure left: no left"
                          "Error in the measure right: no right")
             "~A" text)))

(test experiment.samples-do-not-affect-the-trial
  (experiment:defexperiment orchard-trip-unmeasured
    (:robots picker) (:run (go-east 4) t) (:measure progress))
  (flet ((digests (name) (experiment:run-experiment name :trials 3 :stream nil)))
    (is (equal (column-of (digests 'orchard-trip) 'progress)
               (column-of (digests 'orchard-trip-unmeasured) 'progress)))))

(test experiment.broken-measures-spoil-no-other
  (experiment:defexperiment orchard-errors
    (:robots picker) (:run (go-east 1) t)
    (:measure progress (nonsense :over :mean) (direction-word :over :mean) nonsense))
  (let ((replay (experiment:replay-trial 'orchard-errors 1 1)))
    (is (equal "success" (getf replay :outcome)))
    (is (< 3 (getf-measure replay 'progress) 4))
    (is (eq :none (getf-measure replay 'nonsense-mean)))
    (is (eq :none (getf-measure replay 'direction-word-mean)))
    (is (search "measure nonsense" (getf replay :error)))))

(test experiment.refuses-measures-that-are-none
  (flet ((refusal (part &optional (key :measure))
           (handler-case (eval `(experiment:defexperiment orchard-refused
                                  (:robots picker) (:run t) (,key ,part)))
             (base:malformed-definition (trouble) (princ-to-string trouble)))))
    (is (search "did you mean progress?" (refusal 'progres)))
    (is (search ":sum, :max or :min" (refusal '(progress :over :median))))
    (is (search ":each-tick part" (refusal '(progress :over :mean) :each-tick)))
    (is (search "(name form)" (refusal :progress)))))

(test fingerprint.depends-on-the-measure
  (base:with-own-definitions ()
    (flet ((fingerprint ()
             (eval '(experiment:defexperiment orchard-print
                     (:robots picker) (:run t) (:measure shifting)))
             (let ((experiment (experiment:find-experiment 'orchard-print)))
               (experiment::prepare-experiment experiment)
               (experiment::condition-fingerprint
                (first (experiment:experiment-conditions experiment))))))
      (eval '(run:defmeasure shifting 1))
      (let ((first (fingerprint)))
        (is (equal first (fingerprint)))
        (eval '(run:defmeasure shifting 2))
        (is (not (equal first (fingerprint))))))))

;;; Rollouts.

(rpl:def-interp-proc pick-way (metres)
  (driver:rpl-robot-go-distance metres)
  (rpl:wait-for driver:robot-stopped*)
  :there)

(test project.reads-a-measure-in-each-rollout
  (run:with-simulation (picker :seed 2)
    (let* ((project (driver-projection '(pick-way 4) 'progress))
           (mean (driver-projection '(pick-way 4) '(progress :over :mean)))
           (values (mapcar #'projecting-measure (projection-list project))))
      (is (= 6 (length (remove-duplicates values))))
      (is (every (lambda (x) (< 6 x 7)) values))
      (is (within-p (/ (reduce #'+ values) 6) (mean-measure project)))
      (is (< 2.5 (mean-measure mean) (mean-measure project))))))

(defun mean-measure (projection)
  (ars-magna.rpl-projecting:projection-mean-measure projection))
(defun driver-projection (plan measure)
  (ars-magna.rpl-projecting:project-plan plan :trials 6 :horizon 100 :measure measure))
(defun projection-list (projection) (ars-magna.rpl-projecting:projection-rollouts projection))
(defun projecting-measure (rollout) (ars-magna.rpl-projecting:rollout-measure rollout))

(test project.reports-errors-of-measures
  (run:with-simulation (picker :seed 2)
    (let ((projection (driver-projection '(pick-way 2) 'nonsense)))
      (is (= 0 (ars-magna.rpl-projecting:projection-probability projection)))
      (is (null (mean-measure projection))))
    (signals base:unknown-name (driver-projection '(pick-way 2) 'progres))
    (signals base:wrong-argument (driver-projection '(pick-way 2) '(progress :over :all)))
    (signals base:wrong-argument (driver-projection '(pick-way 2) 5)))
  (is (search "Error in the measure of PROJECT, in 6 of 6 rollouts"
              (run:with-simulation (picker :seed 2)
                (driver-projection '(pick-way 2) 'nonsense)
                (format nil "~{~A~%~}" (mapcar #'base:message-text (base:take-messages)))))))

(test try-best.prefers-more-of-a-measure
  (flet ((x-after (&rest options)
           (run:with-simulation (picker :clean t)
             (driver:run-plan (rpl:make-plan
                               `(ars-magna.rpl-projecting:try-best (:trials 3 :horizon 60 ,@options)
                                  (pick-way 1) (pick-way 6) (pick-way 3))))
             (round (- (robot:robot-x picker) 2.5)))))
    (is (= 1 (x-after)))
    (is (= 6 (x-after :measure ''progress)))
    (is (= 1 (x-after :measure ''progress :cost '(lambda () (robot:robot-x picker)))))))

;;; Pictures and the prompt.

(test picture.has-measures-below-its-title
  (run:with-simulation (picker :clean t :journal t)
    (is (search ">progress 2.5, direction-word NEAR<"
                (display:svg-picture picker :measures '(progress direction-word))))
    (is (not (search "progress" (display:svg-picture picker))))
    (go-east 4)
    (uiop:with-temporary-file (:pathname file :type "svg")
      (trails:save-run-picture file :measures '(progress))
      (is (search ">progress 6.5<" (uiop:read-file-string file))))
    (signals base:unknown-name (display:svg-picture picker :measures '(nothing)))
    (signals base:wrong-argument (display:svg-picture picker :measures 'progress))
    (is (search "measure nonsense cannot be computed: No such"
                (handler-case (display:svg-picture picker :measures '(nonsense))
                  (base:misuse (trouble) (princ-to-string trouble)))))))
