;;;; trying-best.lisp -- plans that choose what does best in rollouts.

(in-package :ars-test-projecting)
(in-readtable :nisp)

(in-suite projecting)

(defvar *told* '() "What TRY-BEST has told: lists of the index chosen and successes, latest first.")

(defun note-choice (projections best)
  (push (cons best (mapcar #'projection-successes projections)) *told*))

(defmacro choices-of (&body body)
  "Run BODY; return what was told of choices meanwhile, in order."
  `(let ((*told* '()))
     ,@body
     (reverse *told*)))

;;; What it costs.

(def-interp-proc choose-and-tell-when ()
  "Choose between two short branches by rollouts; return the tick when that is done."
  (try-best (:trials 10 :horizon 20) (wait-time 1) (wait-time 1))
  (plan-time))

(test try-best.costs-what-the-steps-of-its-rollouts-do
  (flet ((end (thinking)
           (with-simulation (runner :seed 1 :thinking thinking)
             (values (run-plan 'choose-and-tell-when)))))
    (is (= 1 (end :free) (end :charged)))
    (is (< 1 (end '(:charged :budget 100)) 5 (end '(:charged :budget 20))))))

(defparameter *modes* '(:free :charged (:charged :budget 5) (:charged :budget 100))
  "Thinking modes that are the same on every machine.")

(defmacro in-each-mode ((&rest options) &body body)
  "Return a list of what BODY returns in each of *MODES*, on the court."
  `(loop for mode in *modes*
         collect (on-court (,@options :thinking mode) ,@body)))

(test try-best.has-the-price-of-the-with-charge-around-it
  (is (equal '(2 7 7 7)
             (in-each-mode ()
               (first (told-of (with-charge (7)
                                 (try-best (:trials 20 :horizon 50 :until :branch)
                                   (seq (wait-time 2) :near)
                                   (n-times 9 (wait-time 1))))
                               (plan-time)))))))

(def-interp-proc choose-in-choices ()
  (try-best (:trials 3 :horizon 60)
    (seq (think 3) (try-best (:trials 3 :horizon 30) (seq (wait-time 2) (toss .7)) (toss .4)))
    (with-charge (5) (try-best (:trials 3) (seq (think 2 :alone t) (toss .9)) (toss .5)))
    (fail)))

(test try-best.can-be-nested-whatever-thinking-costs
  (flet ((courses ()
           (in-each-mode (:seed 4)
             (list (told 'choose-in-choices) (simulation-tick) (state-digest)))))
    (let ((courses (courses)))
      (is (equal '(:succeeded :succeeded :succeeded :succeeded)
                 (mapcar (lambda (course) (second (first course))) courses)))
      (destructuring-bind (free charged few many) (mapcar #'second courses)
        (is (< free charged few))
        (is (<= charged many few)))
      (is (equal courses (courses))))))

(test try-best.works-in-policies-whatever-thinking-costs
  (let ((counts (in-each-mode (:seed 2)
                  (let ((bell (create-fluent 'bell)) (count 0))
                    (first (told-of (with-policy (whenever bell
                                                   (set-value bell nil)
                                                   (try-best (:trials 2 :horizon 9 :until :branch)
                                                     (wait-time 2)
                                                     (wait-time 1))
                                                   (incf count))
                                      (n-times 3 (set-value bell t) (wait-time 60)))
                                    count))))))
    (is (equal '(3 3 3 3) counts))))

(test try-best.evaporates-while-its-rollouts-are-paid-for
  (is (equal '((:over 3) (:over 3))
             (loop for mode in '(:charged (:charged :budget 100))
                   collect (on-court (:thinking mode)
                             (first (told-of (let ((end (pursue
                                                         (seq (wait-time 3) :over)
                                                         (loop (try-best (:trials 9 :horizon 20)
                                                                 (think 1)
                                                                 (wait-time 1))))))
                                               (list end (plan-time)))))))))
  (on-court (:thinking '(:charged :budget 1))
    (let ((task (begin-plan (interp-lambda ()
                              (loop (try-best (:trials 9 :horizon 20)
                                      (wait-time 1)
                                      (wait-time 2)))))))
      (run-ticks 5)
      (end-plan task)
      (run-ticks 1)
      (is (eq :evaporated (task-state task))))))

;;; Which branch.

(test try-best.takes-what-succeeds-most-often
  (on-court (:seed 1)
    (let ((choices (choices-of
                     (is (equal '(:heads :succeeded)
                                (told-of (try-best (:trials 10 :tell #'note-choice)
                                           (toss .1) (toss 1) (toss .5))))))))
      (is (= 1 (length choices)))
      (destructuring-bind (best first second third) (first choices)
        (is (= 1 best))
        (is (= 10 second))
        (is (< first third 10))))))

(test try-best.looks-at-the-whole-plan-or-only-at-the-branch
  (flet ((choice (until)
           (on-court ()
             (first (told-of (let ((way (try-best (:trials 4 :until until)
                                          (seq (wait-time 1) :near)
                                          (seq (wait-time 5) :far))))
                               (if (and (eq way :near) (null until)) (fail))
                               way))))))
    (is (eq :far (choice nil)))
    (is (eq :near (choice :branch)))))

(test try-best.prefers-the-quicker-of-equals-and-then-the-first
  (on-court ()
    (is (eq :quick (first (told-of (try-best (:trials 3)
                                     (seq (wait-time 9) :slow)
                                     (seq (wait-time 2) :quick)
                                     (seq (wait-time 2) :too))))))
    (is (eq :first (first (told-of (try-best (:trials 2) :first :second)))))))

(test try-best.can-go-by-another-cost
  (on-court (:clean t)
    (is (< 10 (let ((x (progn (told-of (try-best (:trials 2 :cost (lambda () (- (robot-x runner))))
                                         (wait-time 1)
                                         (run-on 0 3)))
                              (robot-x runner))))
                x)))
    (is (equal '(:cheap :succeeded)
               (told-of (let ((price 0))
                          (try-best (:trials 2 :cost (lambda () price))
                            (seq (setq price 5) :dear)
                            (seq (wait-time 3) (setq price 1) :cheap))))))))

(test try-best.with-one-branch-just-does-it
  (on-court ()
    (is (null (choices-of (is (equal '(1 :succeeded)
                                     (told-of (try-best (:tell #'note-choice) 1)))))))
    (signals malformed-definition (make-plan '(try-best ())))))

(test try-best.fails-as-its-branch-does
  (on-court ()
    (is (equal '(:tails :succeeded)
               (told-of (handle-failure ((:tails () (return :tails)))
                          (try-best (:trials 2) (toss 0) (toss 0))))))))

(test try-best.returns-all-values-and-lets-branches-leave
  (on-court ()
    (is (equal '((1 2) :succeeded)
               (told-of (multiple-value-bind (a b) (try-best (:trials 2) (values 1 2) (fail))
                          (list a b)))))
    (is (equal '(:out :succeeded)
               (told-of (block out
                          (try-best (:trials 2 :until :branch)
                            (fail)
                            (return-from out :out))))))))

;;; The run takes no notice.

(test try-best.goes-on-as-a-plan-without-it-would
  "State, chance and time of a run do not depend on how a branch was chosen."
  (flet ((future (plan)
           (on-court (:seed 9)
             (let ((told (told plan)))
               (list told (simulation-tick) (state-digest) (robot-x runner) (robot-y runner))))))
    (is (equal (future (interp-lambda () (run-on .3 4) (run-on 1 5) (toss 1)))
               (future (interp-lambda ()
                         (run-on .3 4)
                         (try-best (:trials 8) (run-on 0 100) (run-on 1 5) (toss 0))
                         (toss 1)))))))

(test try-best.comes-out-the-same-each-time
  (flet ((choices ()
           (on-court (:seed 4)
             (choices-of (told-of (n-times 5
                                    (try-best (:trials 5 :until :branch :tell #'note-choice)
                                      (handle-failure ((t () (return))) (toss .5))
                                      (toss .6)))))))) 
    (is (equal (choices) (choices)))))

(test try-best.gives-all-branches-the-same-luck
  (on-court (:seed 8)
    (let ((seeds '()))
      (told-of (try-best (:trials 6 :tell (lambda (projections best)
                                            (declare (ignore best))
                                            (setf seeds (mapcar #'outcomes projections))))
                 (toss .5) (toss .5)))
      (is (equal (first seeds) (second seeds)))
      (is (= 6 (length (remove-duplicates (mapcar #'first (first seeds)))))))))

(test try-best.keeps-no-trace-of-rollouts
  (let ((*trace-plans* t))
    (flet ((events (plan)
             (on-court (:seed 1)
               (told plan)
               (loop for entry across (plan-trace (rpl-runner))
                     collect (list (trace-entry-tick entry) (trace-entry-event entry))))))
      (is (equal (events (interp-lambda () (try-best (:trials 1) (toss 1) (toss 0)) 1))
                 (events (interp-lambda () (try-best (:trials 9) (toss 1) (toss 0)) 1)))))))

(test try-best.chooses-by-chance-in-rollouts
  "There are no rollouts in rollouts: how often a function is called is linear in the choices."
  (on-court (:seed 2)
    (let ((choices
            (choices-of
              (told-of (try-best (:trials 40 :tell #'note-choice)
                         (try-best (:trials 40 :tell #'note-choice)
                           :good
                           (fail))
                         (fail))))))
      (is (= 2 (length choices)))
      (is (< 8 (second (first choices)) 32))
      (is (equal '(0 40 0) (second choices))))
    (is (= 1/2 (projection-probability
                (let ((seen nil))
                  (told-of (setf seen (rollout-value
                                       (first (projection-rollouts
                                               (project (interp-lambda () (project '(toss 1)))
                                                        :trials 1))))))
                  seen))))))

;;; What else goes on.

(test try-best.side-by-side-choose-one-after-the-other
  (on-court (:seed 1)
    (let ((choices (choices-of
                     (is (eq :succeeded
                             (second (told-of
                                      (par (try-best (:trials 4 :tell #'note-choice)
                                             (fail) (wait-time 1))
                                           (try-best (:trials 40 :tell #'note-choice)
                                             (wait-time 2) (fail))))))))))
      (is (= 2 (length choices)))
      ;; In the rollouts of the first the second chooses by chance.
      (is (eql 1 (first (first choices))))
      (is (equal '(0 40 0) (second choices))))))

(test try-best.is-given-up-with-its-task
  "A policy that fires in the same reaction comes first: there is nothing left to choose."
  (on-court ()
    (let ((alarm (create-fluent 'alarm)))
      (is (null (choices-of
                  (is (equal '(:alarmed :succeeded)
                             (told-of (handle-failure ((:alarm () (return :alarmed)))
                                        (with-policy (seq (wait-for alarm) (fail :class :alarm))
                                          (par (wait-time 3)
                                               (try-best (:tell #'note-choice) 1 2)
                                               (set-value alarm t)))))))))))))

(test try-best.of-a-suspended-task-waits
  (on-court ()
    (let ((ticks '()))
      (told-of (par (:tag chooser
                      (seq (wait-time 1)
                           (try-best (:trials 2 :tell (lambda (projections best)
                                                        (declare (ignore projections best))
                                                        (push (simulation-tick) ticks)))
                             1 2)))
                    (with-task-blocked chooser (wait-time 5))))
      (is (equal '(5) ticks)))))

(test try-best.lets-time-pass-however-often-it-is-asked
  (on-court ()
    (let ((count 0))
      (begin-plan (interp-lambda ()
                    (loop (project '(toss 1) :trials 1)
                          (incf count))))
      (run-ticks 3)
      (is (= 3 (simulation-tick)))
      (is (<= 100 count 400)))))

(test try-best.works-in-forks
  (on-court (:seed 3)
    (let ((task (begin-plan (interp-lambda ()
                              (wait-time 2)
                              (try-best (:trials 3) (fail) :good)))))
      (run-ticks 1)
      (is (equal '(:good) (let ((answer nil))
                            (with-fork ()
                              (run-ticks 3)
                              (push (told-of (try-best (:trials 2) (fail) :good)) answer))
                            (mapcar #'first answer))))
      (run-ticks 3)
      (is (eq :good (task-result task))))))

(test try-best.works-live
  (live (simulation)
    (is (equal '(:good :succeeded)
               (told-of (wait-time 2)
                        (try-best (:trials 3 :horizon 20)
                          (seq (wait-time 1) (fail))
                          (seq (wait-time 1) :good)))))
    (is (= 3 (projection-successes (project (interp-lambda () (wait-time 2)) :trials 3))))
    (let ((task (begin-plan (interp-lambda () (loop (project (interp-lambda () (wait-time 1))
                                                             :trials 1))))))
      (end-plan task)
      (is-true (await (lambda () (task-over-p task)))))))

(defun busy-choosing (seed)
  "Return how often a plan chose, beside many fluents that nobody waits for and that change."
  (on-court (:seed seed)
    (let ((fluents (loop repeat 300 collect (create-fluent 'f 0))))
      (first (told-of (n-times 40
                        (dolist (fluent fluents)
                          (set-value fluent (+ 1 (fluent-value fluent))))
                        (try-best (:trials 3 :until :branch) (wait-time 1) (wait-time 2)))
                      (fluent-value (first fluents)))))))

(test try-best.works-in-many-threads-at-once
  "Runs in other threads do not get between a run and its forks."
  (let ((counts '()) (lock (make-lock "counts")))
    (loop repeat 3
          do (mapc #'join-thread
                   (loop for seed in '(1 2 3)
                         collect (let ((seed seed))
                                   (start-thread
                                    (lambda ()
                                      (let* ((*message-queue* (make-message-queue))
                                             (count (busy-choosing seed)))
                                        (with-lock (lock) (push count counts))))
                                    "choosing")))))
    (is (equal '(40 40 40 40 40 40 40 40 40) counts))))

;;; The shipped errand, on a few seeds. The experiment CHOOSING-BY-ROLLOUTS has many.

(defmacro with-trolleys ((seed) &body body)
  "Run BODY in the office with trolleys where SEED says."
  `(with-simulation (ars-worlds:marvin :seed ,seed)
     (ars-worlds:leave-trolleys)
     ,@body))

(defun in-time-p (which)
  "True if the errand that chooses as WHICH says succeeds here."
  (eq :succeeded (nth-value 1 (run-plan 'ars-worlds:carry-messages which))))

(defun successes-of (which seeds)
  "Return how often the errand that chooses as WHICH says succeeds with SEEDS."
  (loop for seed in seeds
        count (with-trolleys (seed) (in-time-p which))))

(test try-best.is-worth-it
  "On the office, where the better way depends on what stands in it."
  (let ((seeds (loop for seed from 5 to 12 collect seed)))
    (is (<= (successes-of :first seeds) 5))
    (is (<= (successes-of :second seeds) 5))
    (is (<= 7 (successes-of :best seeds)))))

(defun square (number) (* number number))

(test projection.foretells-better-than-the-rate-of-success-does
  "Brier's score of forecasts, the mean square of how far they are off, is below that of the rate."
  (let* ((forecasts '())
         (outcomes (loop for seed from 21 to 32
                         collect (with-trolleys (seed)
                                   (push (projection-probability
                                          (project '(ars-worlds:carry-messages :first)
                                                   :trials 8 :horizon 1200))
                                         forecasts)
                                   (if (in-time-p :first) 1 0))))
         (rate (/ (reduce #'+ outcomes) (length outcomes))))
    (flet ((score (forecasts)
             (/ (reduce #'+ (mapcar #'square (mapcar #'- forecasts outcomes))) (length outcomes))))
      (is (< (score (reverse forecasts))
             (* 1/2 (score (mapcar (constantly rate) outcomes))))))))
