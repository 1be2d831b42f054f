;;;; projecting.lisp -- plans that are tried in forks, and choose by the results.

(in-package :ars-user)

(define-user-package :ars-test-projecting
  (:documentation "Where a user asks what may become of plans.")
  (:import-from :ars-magna.tests
                #:ars-magna #:def-suite* #:in-suite #:test #:is #:is-true #:signals #:live
                #:fitter #:await)
  (:import-from :ars-magna.base #:take-messages #:message-text #:start-thread #:join-thread
                #:make-lock
                #:with-lock #:*message-queue* #:make-message-queue))

(in-package :ars-test-projecting)
(in-readtable :nisp)

(def-suite* projecting :in ars-magna)

(defmap court (30 20)
  (rect (0 0) (29 19) bricks 10)
  (obj ball (20 5) ((:size 1) (:color red))))

(defrobot runner (court (10 10) 0)
  :cameras ((3 5)) :hands (10))

(defmacro on-court ((&rest options) &body body)
  "Run BODY in a headless simulation with OPTIONS and a fresh RUNNER that plans drive."
  `(with-simulation (runner ,@options)
     (rpl-init-robot runner)
     ,@body))

(def-interp-proc toss (probability &optional (ticks 1))
  "Succeed with PROBABILITY, after TICKS."
  (wait-time ticks)
  (if (chance probability (world-dice *world* :user))
      :heads
      (fail :class :tails)))

(def-interp-proc run-on (angle ticks)
  "Turn by ANGLE and drive for TICKS."
  (rpl-robot-turn angle)
  (wait-for robot-stopped*)
  (rpl-robot-go-forward ticks)
  (wait-for robot-stopped*)
  (if (fluent-value robot-movement-error*)
      (fail :class :stopped)
      :there))

(defun told (plan &rest arguments)
  "Return value, or failure, and state of PLAN with ARGUMENTS as a list."
  (multiple-value-list (apply #'run-plan plan arguments)))

(defmacro told-of (&body plan)
  `(told (interp-lambda () ,@plan)))

(defun outcomes (projection)
  "Return lists of seed, state and ticks of the rollouts of PROJECTION."
  (loop for rollout in (projection-rollouts projection)
        collect (list (rollout-seed rollout) (rollout-state rollout) (rollout-ticks rollout))))

(test project.takes-what-the-plan-takes
  (on-court (:seed 1)
    (signals error (project 'toss))
    (signals error (project '(toss 1 2 3)))
    (signals ars:wrong-argument (project 'toss :arguments 1))))

;;; What a projection tells.

(test projection.says-how-often-a-plan-succeeds
  (on-court (:seed 1)
    (let ((projection (project '(toss .3) :trials 300)))
      (is (= 300 (length (projection-rollouts projection))))
      (is (< 65 (projection-successes projection) 115))
      (is (= (projection-probability projection) (/ (projection-successes projection) 300d0)))
      (is (equal (list (cons :tails (- 300 (projection-successes projection))))
                 (projection-failures projection)))
      (is (= 1 (projection-mean-ticks projection)))
      (multiple-value-bind (low high) (projection-interval projection)
        (is (< low .3 high)))
      (is (every #'rollout-succeeded-p
                 (projection-rollouts (project 'toss :arguments '(1))))))))

(test projection.keeps-what-took-too-long-apart
  (on-court ()
    (let ((projection (project '(toss 1 50) :horizon 49 :trials 3)))
      (is (equal '((:limit . 3)) (projection-failures projection)))
      (is (null (projection-mean-ticks projection)))
      (is (= 3 (projection-successes (project '(toss 1 50) :horizon 50 :trials 3)))))))

(test projection.takes-errors-for-outcomes
  (on-court ()
    (let* ((projection (project (interp-lambda () (wait-time 1) (car (robot-x runner)))
                                :trials 2))
           (rollout (first (projection-rollouts projection))))
      (is (equal '((lisp-failure . 2)) (projection-failures projection)))
      (is (typep (lisp-failure-condition (rollout-failure rollout)) 'type-error))
      (is (null (take-messages))))))

(test projection.prints-on-one-line
  (on-court ()
    (let ((text (prin1-to-string (project '(toss 1) :trials 4))))
      (is (search "(toss 1): 4 of 4, 0.51 to 1.00, 1.0 ticks" text) "~A" text)
      (is (not (find #\Newline text))))))

(test projection.calls-for-the-cost-in-the-fork
  (on-court (:clean t)
    (let ((projection (project '(run-on 0 8) :trials 2 :cost (lambda () (robot-x runner)))))
      (is (every (lambda (rollout) (< 12 (rollout-cost rollout) 19))
                 (projection-rollouts projection)))
      (is (= 10 (robot-x runner))))))

;;; The run takes no notice.

(test project.changes-nothing
  "A run in which somebody asks what may become of plans goes on as one in which nobody does."
  (flet ((future (ask)
           (on-court (:seed 5)
             (run-ticks 3)
             (let ((task (begin-plan 'run-on 1 12)))
               (run-ticks 4)
               (let ((before (state-digest)))
                 (funcall ask task)
                 (is (= before (state-digest))))
               (run-ticks 30)
               (list (state-digest) (robot-x runner) (length (take-messages)))))))
    (let ((undisturbed (future #'identity)))
      (is (equal undisturbed (future (lambda (task) (project task :trials 3)))))
      (is (equal undisturbed (future (lambda (task)
                                       (is-true task)
                                       (project '(run-on 2 200) :trials 3))))))))

(test project.in-a-plan-changes-nothing
  (flet ((future (plan)
           (on-court (:seed 6)
             (let ((told (told plan)))
               (list told (state-digest) (robot-x runner) (simulation-tick)
                     (length (take-messages)))))))
    (is (equal (future (interp-lambda () (wait-time 2) (run-on 1 9)))
               (future (interp-lambda ()
                         (wait-time 2)
                         (project '(toss .5) :trials 5)
                         (project '(run-on 2 200) :trials 5)
                         (run-on 1 9)))))))

(test project.works-in-continuations
  (on-court ()
    (let ((projection nil))
      (robot-turn runner 1 (continuation (err robot angle)
                             (setf projection (project '(toss 1) :trials 2))))
      (run-ticks 20)
      (is (= 2 (projection-successes projection))))))

(test rollouts.come-out-the-same-again
  "A rollout can be looked at again, at any time; a fork with its seed does the same."
  (on-court (:seed 2)
    (let* ((projection (project '(run-on .4 40) :trials 6))
           (rollout (fourth (projection-rollouts projection)))
           (looked (with-rollout (rollout)
                     (list (simulation-tick) (robot-x runner) (state-digest))))
           (forked (with-fork (:seed (rollout-seed rollout))
                     (run-plan 'run-on .4 40)
                     (list (simulation-tick) (robot-x runner) (state-digest)))))
      (is (= (rollout-ticks rollout) (first looked)))
      (is (equal looked forked))
      (run-ticks 10)
      (is (equal looked (with-rollout (rollout)
                          (list (simulation-tick) (robot-x runner) (state-digest))))))))

(test rollouts.can-be-looked-at-when-their-run-is-over
  (let ((rollout nil))
    (on-court (:seed 2)
      (run-ticks 5)
      (told-of (try-best (:trials 3 :tell (lambda (projections best)
                                            (setf rollout (first (projection-rollouts
                                                                  (nth best projections))))))
                 (toss 0 9) (toss 1 9))))
    (is (= 9 (rollout-ticks rollout)))
    (is (= 14 (with-rollout (rollout) (simulation-tick))))))

(test seeds.depend-on-run-and-tick-only
  (flet ((asked (seed ticks &rest options)
           (on-court (:seed seed)
             (run-ticks ticks)
             (outcomes (apply #'project-plan 'toss :arguments '(.5) :trials 20 options)))))
    (is (equal (asked 1 2) (asked 1 2)))
    (is (not (equal (asked 1 2) (asked 1 3))))
    (is (not (equal (asked 1 2) (asked 2 2))))
    (is (= 20 (length (remove-duplicates (mapcar #'first (asked 1 2))))))
    (is (equal (asked 1 2 :seed 7) (asked 3 4 :seed 7)))))

;;; What is left of a task.

(test project.tells-what-is-left-of-a-task
  (on-court (:seed 1)
    (let ((task (begin-plan 'toss 1 29)))
      (run-ticks 10)
      (let ((projection (project task :trials 3)))
        (is (= 3 (projection-successes projection)))
        (is (= 20 (projection-mean-ticks projection))))
      (is (not (task-over-p task)))
      (run-ticks 20)
      (is (eq :succeeded (task-state task)))
      (is (= 0 (projection-mean-ticks (project task :trials 1)))))))

(test project.tells-a-plan-what-will-become-of-itself
  (on-court (:seed 1)
    (destructuring-bind (projection state)
        (told-of (let ((future (project (current-task) :trials 4)))
                   (wait-time 7)
                   (if (projection-rollouts future) future (fail :class :nothing-known))))
      (is (eq :succeeded state))
      (is (equal '((:nothing-known . 4)) (projection-failures projection)))
      (is (= 7 (rollout-ticks (first (projection-rollouts projection))))))))

(test project.of-a-plan-begins-as-if-called
  "What its plan owns is no hindrance to a plan that is projected."
  (on-court ()
    (let ((arm (make-valve 'arm)))
      (is (equal '(3 :succeeded)
                 (told-of (with-valve (arm)
                            (projection-successes
                             (project (interp-lambda () (with-valve (arm) (wait-time 2)))
                                      :trials 3)))))))))

;;; Worlds believed in.

(defun believed-court (run seed)
  "Call RUN where the ball is believed to be elsewhere."
  (with-simulation (runner :seed seed)
    (move-thing (find-thing 'ball) '(4 4))
    (funcall run)))

(def-interp-proc where-is-the-ball ()
  (wait-time 2)
  (thing-x (find-thing 'ball)))

(test project.can-ask-of-a-world-believed-in
  (on-court (:seed 3)
    (place-robot runner 3 3 0)
    (let ((projection (project 'where-is-the-ball :world #'believed-court :trials 3)))
      (is (equal '(4d0 4d0 4d0) (mapcar #'rollout-value (projection-rollouts projection))))
      (is (= 10 (with-rollout ((first (projection-rollouts projection))) (robot-x runner)))))
    (is (= 20 (thing-x (find-thing 'ball))))
    (is (equal '(2 :succeeded)
               (told-of (projection-successes
                         (project 'where-is-the-ball :world #'believed-court :trials 2)))))))

(test project.keeps-the-true-run-from-a-world-believed-in
  (on-court ()
    (flet ((refused-p (plan &rest arguments)
             (handler-case (progn (project plan :arguments arguments :world #'believed-court) nil)
               (wrong-argument () t))))
      (is-true (refused-p 'toss runner))
      (is-true (refused-p 'toss (list 1 (find-thing 'ball))))
      (is-true (refused-p 'toss (vector (robot-hand runner 0))))
      (is-true (refused-p 'toss (create-fluent 'f)))
      (is-true (refused-p (begin-plan 'toss 1 5)))
      (is-true (refused-p (interp-lambda () 1))))
    (flet ((failure (world)
             (lisp-failure-condition
              (rollout-failure (first (projection-rollouts
                                       (project '(toss 1) :trials 1 :world world)))))))
      (is (typep (failure (lambda (run seed) (declare (ignore seed)) (funcall run))) 'misuse))
      (is (typep (failure (lambda (run seed) (declare (ignore run seed)) 1)) 'misuse))
      (is (typep (failure (lambda (run seed) (declare (ignore run seed)) (robot-x runner)))
                 'unbound-variable)))))

;;; To be looked at.

(test projection.is-a-picture
  (on-court (:seed 1)
    (let ((path (merge-pathnames "projection.svg" (uiop:temporary-directory)))
          (projection (project '(run-on .4 40) :trials 5)))
      (unwind-protect
           (let ((text (uiop:read-file-string (save-projection-picture projection path))))
             (is (search "5 rollouts" text))
             (is (search "(run-on 0.4 40)" text)))
        (uiop:delete-file-if-exists path)))))

(test projection.is-told-whole-above-its-picture
  "However long; and the picture takes what SAVE-PICTURE takes."
  (on-court (:seed 1)
    (let* ((path (merge-pathnames "projection.svg" (uiop:temporary-directory)))
           (projection (project (list 'run-on 1/8 (loop for i below 40 collect i)) :trials 2))
           (words (format nil "~{~D~^ ~}" (loop for i below 40 collect i))))
      (is (search words (projection-text projection)))
      (is (not (search words (prin1-to-string projection))))
      (unwind-protect
           (flet ((text (&rest options)
                    (uiop:read-file-string
                     (apply #'save-projection-picture projection path options))))
             (is (search "36 37 38 39" (text)))
             (let ((text (text :title "Mine" :in-color nil :scale 6 :layers '(:title))))
               (is (search ">Mine<" text))
               (is (not (search "trials" text))))
             (signals wrong-argument (text :layers '(:frob))))
        (uiop:delete-file-if-exists path)))))
