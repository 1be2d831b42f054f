;;;; forking-uses.lisp -- making and using forks: seeds, continuations, threads, live runs.

(in-package :ars-magna.tests)
(in-suite forking)

;;; What is forked with a run, and what is not.

(test uses.seeds-draw-chance-anew
  (run:with-simulation ((keeper helper) :seed 3)
    (let ((*ride* (make-ride (base:make-dice 3 "seeds"))))
      (populate)
      (run:run-ticks 5)
      (flet ((outcome (&rest options)
               (apply #'run:call-with-fork (lambda () (run:run-ticks 300) (run:state-digest))
                      options)))
        (let ((one (outcome :seed 1)))
          (is (= one (outcome :seed 1)))
          (is (/= one (outcome :seed 2)))
          (is (= (outcome) (outcome)))
          (is (/= one (outcome))))))))

(test uses.seeds-are-for-the-dice-of-plans-too
  (run:with-simulation (rover :seed 3)
    (driver:begin-plan (rpl:interp-lambda ()
                         (rpl:wait-time 3)
                         (let ((rolls '()))
                           (rpl:n-times 20
                             (push (rpl:try-one 1 2 3 4) rolls))
                           rolls)))
    (run:run-ticks 1)
    (flet ((outcome (&rest options)
             (apply #'run:call-with-fork
                    (lambda ()
                      (let ((task (first (driver:plans))))
                        (run:run-ticks 9)
                        (rpl:task-result task)))
                    options)))
      (is (= 20 (length (outcome))))
      (is (equal (outcome) (outcome)))
      (is (not (equal (outcome :seed 1) (outcome :seed 2)))))))

(test uses.continuations-only-if-wanted
  "Copied, they count in variables of their own."
  (run:with-simulation (rover :seed 3)
    (let* ((count 0) (tell (lambda () count)))
      (command:robot-turn rover 1 (lambda (&rest ignore) (declare (ignore ignore)) (incf count)))
      (time:schedule (:look :timer 20)
        (base:message-set "count " (funcall tell)))
      (flet ((outcome (&rest options)
               (apply #'run:call-with-fork
                      (lambda () (run:run-ticks 30) (messages-text time:*simulation*))
                      options)))
        (run:run-ticks 2)
        (is (search "count 0" (outcome)))
        (is (search "count 1" (outcome :continuations t)))
        (is (zerop count))
        (run:run-ticks 30)
        (is (= 1 count))))))

(test uses.what-is-asked-for-just-before-happens-in-both
  (run:with-simulation (rover :seed 3)
    (command:robot-turn rover 1)
    (command:camera-turn (robot:robot-camera rover 0) 1)
    (run:run-ticks 1)
    (command:robot-go-forward rover 2)
    (time:grab-resource (robot:robot-camera rover 0))
    (run:with-fork ()
      (run:run-ticks 1)
      (is (null (time:resource-event (robot:robot-camera rover 0))))
      (run:run-ticks 20)
      (is (/= 5.5d0 (robot:robot-x rover))))
    (is (= 5.5d0 (robot:robot-x rover)))
    (is (null (fork-trouble time:*simulation* 20)))))

(test uses.observers-stay-behind
  (run:with-simulation (rover :seed 3)
    (let ((seen '()))
      (run:add-observer (lambda (simulation) (push simulation seen)))
      (run:with-fork () (run:run-ticks 3))
      (is (null seen))
      (run:run-ticks 1)
      (is (equal (list time:*simulation*) seen)))))

(test uses.parameters-are-a-forks-own
  (run:with-simulation (rover :seed 3)
    (let ((before base:braking*))
      (run:with-fork ()
        (setf base:braking* (* 2 before))
        (run:run-ticks 1)
        (run:with-fork () (is (= (* 2 before) base:braking*))))
      (is (= before base:braking*)))))

(test uses.journals-of-forks-can-be-replayed
  (run:with-simulation (rover :seed 3 :journal t)
    (command:robot-turn rover 1)
    (run:run-ticks 4)
    (let ((fork (run:fork-simulation)))
      (command:robot-go-forward rover 3)
      (run:run-ticks 4)
      (run:call-in-fork fork
                        (lambda ()
                          (command:robot-turn rover -2)
                          (run:run-ticks 20)
                          (is (equal '(0 4) (mapcar #'first (run:journal-entries
                                                             (run:simulation-journal fork)))))
                          (is (= (run:state-digest)
                                 (nth-value 1 (run:replay (run:journal-up-to-now fork)))))))
      (is (equal '(0 4) (mapcar #'first (run:journal-entries
                                         (run:simulation-journal time:*simulation*))))))))

;;; Mistakes.

(test uses.mistakes-say-so
  (let ((fork nil) (gone nil) (troubles '()))
    (flet ((trouble (class function)
             (handler-case (progn (funcall function) nil)
               (base:ars-magna-error (trouble) (typep trouble class)))))
      (signals base:misuse (let ((time:*simulation* nil)) (run:fork-simulation)))
      (run:with-simulation (rover :seed 3)
        (setf gone time:*simulation*)
        (driver:rpl-init-robot rover)
        (time:schedule (:in-tick :timer 1 :when (progn (push (trouble 'base:misuse
                                                                      #'run:fork-simulation)
                                                             troubles)
                                                       t)))
        (driver:begin-plan (rpl:interp-lambda ()
                             (rpl:wait-time 1)
                             (push (trouble 'base:misuse #'run:fork-simulation) troubles)))
        (run:run-ticks 5)
        (is (equal '(t t) troubles) "~S" (messages-text time:*simulation*))
        (signals base:wrong-argument (run:release-fork time:*simulation*))
        (signals base:wrong-argument (run:fork-simulation :seed 1.5))
        (signals base:wrong-argument (run:fork-simulation :sede 1))
        (signals base:wrong-argument (run:fork-simulation time:*simulation* :seed))
        (signals base:wrong-argument (run:call-in-fork time:*simulation* #'list))
        (signals base:wrong-argument (run:counterpart rover time:*simulation*))
        (signals base:ars-magna-error (run:fork-simulation 7))
        (setf fork (run:fork-simulation))
        (signals base:wrong-argument (run:counterpart "rover" fork))
        (run:release-fork fork)
        (run:release-fork fork)
        (signals base:misuse (run:run-ticks 1 fork))
        (signals base:misuse (run:fork-simulation fork))
        (signals base:misuse (run:call-in-fork fork (lambda () (command:robot-turn rover 1)))))
      (signals base:misuse (run:fork-simulation gone)))))

;;; In and out.

(test uses.forks-in-forks-and-out-by-a-throw
  (run:with-simulation (rover :seed 3)
    (let ((names (list rover)))
      (is (eq :out (catch 'out
                     (run:with-fork ()
                       (push rover names)
                       (run:run-ticks 2)
                       (run:with-fork ()
                         (push rover names)
                         (run:run-ticks 3)
                         (is (= 5 (run:simulation-tick)))
                         (throw 'out :out))))))
      (is (= 3 (length (remove-duplicates names))))
      (is (zerop (run:simulation-tick)))
      (is (eq rover (first (last names)))))))

(test uses.plans-begun-in-a-fork-stay-there
  (run:with-simulation (rover :seed 3)
    (is (equal '(:done :succeeded)
               (run:with-fork ()
                 (multiple-value-list
                  (driver:run-plan (rpl:interp-lambda ()
                                     (driver:rpl-robot-turn 1)
                                     (rpl:wait-for driver:robot-stopped*)
                                     :done))))))
    (is (null (driver:plans)))
    (driver:rpl-init-robot rover)
    (let ((interface driver::*default-interface*) (stopped driver:robot-stopped*))
      (run:with-fork ()
        (driver:rpl-init-robot rover)
        (driver:begin-plan (rpl:interp-lambda () (rpl:wait-time 3)))
        (run:run-ticks 1)
        (is (= 1 (length (driver:plans)))))
      (is (eq interface driver::*default-interface*))
      (is (eq stopped driver:robot-stopped*))
      (is (null (driver:plans))))))

(test uses.what-is-set-where-one-comes-from-is-kept
  "Code of a run that a fork lets go on may give the robot to plans anew."
  (run:with-simulation (rover :seed 3)
    (let ((original time:*simulation*))
      (time:schedule (:give :timer 2) (driver:rpl-init-robot rover))
      (run:with-fork ()
        (run:run-ticks 4 original)
        (is (null driver::*default-interface*)))
      (is (eq rover (driver:rpl-robot)))
      (is (eq :done (driver:run-plan (rpl:interp-lambda () (rpl:wait-time 1) :done)))))))

(test uses.other-simulations-inside-and-around
  (run:with-simulation (rover :seed 3)
    (driver:rpl-init-robot rover)
    (run:run-ticks 2)
    (run:with-fork ()
      (let ((forks-rover rover))
        (run:with-simulation (rover :seed 4)
          (is (eq :done (driver:run-plan (rpl:interp-lambda () (rpl:wait-time 5) :done))))
          (run:with-fork ()
            (is (eq :done (driver:run-plan (rpl:interp-lambda () (rpl:wait-time 5) :done))))
            (is (= 10 (run:simulation-tick)))))
        (is (eq forks-rover rover))
        (is (= 2 (run:simulation-tick)))
        (is (eq rover (driver:rpl-robot)))))))

(test uses.ends-of-runs-inside
  (let ((fork nil))
    (run:with-simulation (rover :seed 3)
      (driver:begin-plan (rpl:interp-lambda () (rpl:wait-time 9)))
      (run:run-ticks 1)
      (setf fork (run:fork-simulation)))
    (run:call-in-fork fork (lambda ()
                             (let ((task (first (driver:plans))))
                               (run:run-ticks 15)
                               (is (eq :succeeded (rpl:task-state task))))))
    (run:release-fork fork)))

;;; What is what.

(test counterparts.of-all-that-has-one
  (run:with-simulation (rover :seed 3 :clean t)
    (let* ((ball (world:make-new-thing 'ball (list world:*world* 5.5 10.2) '((:size 1))))
           (gone (world:make-new-thing 'ball (list world:*world* 5.5 10.2) '((:size 1))))
           (fluent (fluent nil 'f)) (valve (rpl:make-valve 'v)) (designator nil)
           (task (driver:begin-plan (rpl:interp-lambda () (rpl:wait-for fluent))))
           (over (driver:begin-plan (rpl:interp-lambda () 1))))
      (command:camera-get-object-designator
       (robot:robot-camera rover 0) :local '()
       (lambda (code camera &optional found) (declare (ignore code camera))
         (setf designator found)))
      (world:destroy-thing gone)
      (run:run-ticks 20)
      (let* ((fork (run:fork-simulation)) (forks-fork (run:fork-simulation fork))
             (objects (list rover (robot:robot-hand rover 1) (robot:robot-main-odometer rover)
                            ball fluent valve task)))
        (when designator (push designator objects))
        (dolist (object objects)
          (let ((one (run:counterpart object fork)) (other (run:counterpart object forks-fork)))
            (is (eq (type-of object) (type-of one)))
            (is (not (eq object one)))
            (is (eq one (run:counterpart one fork)))
            (is (eq other (run:counterpart one forks-fork)))))
        (is (null (run:counterpart over fork)))
        (is (null (run:counterpart gone fork)))
        (world:destroy-thing ball)
        (is (world:thing-alive-p (run:counterpart ball fork)))))))

;;; Threads.

(defun digests-in-threads (count function)
  "Call FUNCTION with 0 to COUNT - 1, each in a thread of its own. Return a list of the results."
  (let* ((results (make-array count :initial-element :none))
         (threads (loop for index below count
                        collect (let ((index index))
                                  (base:start-thread (lambda ()
                                                       (setf (svref results index)
                                                             (funcall function index)))
                                                     "fork")))))
    (mapc #'base:join-thread threads)
    (coerce results 'list)))

(test threads.each-with-a-fork-while-the-original-goes-on
  (run:with-simulation (ars-worlds:marvin :seed 7)
    (driver:begin-plan 'ars-worlds:fetch-thing '((:color blue) (:substance plastic)) '((109 24)))
    (run:run-ticks 20)
    (let* ((simulation time:*simulation*)
           (forks (loop repeat 8 collect (run:fork-simulation)))
           (started (base:make-semaphore "started"))
           (others (base:start-thread
                    (lambda ()
                      (base:signal-semaphore started)
                      (digests-in-threads
                       8 (lambda (index) (first (last (passing 40 (nth index forks)))))))
                    "forks"))
           (digests '()))
      (base:wait-on-semaphore started)
      (setf digests (passing 40 simulation))
      (base:join-thread others)
      (dolist (fork forks)
        (is (= (run:state-digest simulation t) (run:state-digest fork t))))
      (is (= 80 (length digests))))))

(test threads.fork-a-run-of-another-and-find-its-names
  "What the run has bound is known, whoever asks."
  (run:with-simulation (rover :seed 3)
    (run:with-fork () nil)
    (let ((fluent (fluent nil 'f)) (simulation time:*simulation*))
      (driver:begin-plan (rpl:interp-lambda () (rpl:wait-for fluent) (rpl:plan-time)))
      (run:run-ticks 2)
      (flet ((outcome (ticks)
               (let ((fork (run:fork-simulation simulation)))
                 (run:call-in-fork
                  fork
                  (lambda ()
                    (let ((task (first (driver:plans))))
                      (run:run-ticks ticks)
                      (rpl:set-value fluent t)
                      (run:run-ticks 2)
                      (list (rpl:task-result task) (eq rover (driver:rpl-robot)))))))))
        (is (equal (loop for ticks below 8 collect (list (+ 3 ticks) t))
                   (digests-in-threads 8 #'outcome)))
        (is (null (rpl:fluent-value fluent)))))))

(test threads.of-eight-runs-at-once
  (flet ((outcome (seed)
           (run:with-simulation (ars-worlds:marvin :seed (mod seed 4))
             (driver:begin-plan 'ars-worlds:fetch-thing '((:color blue) (:substance plastic))
                                '((109 24)))
             (run:run-ticks 30)
             (run:with-fork () (run:run-ticks 30) (run:state-digest time:*simulation* t)))))
    (let ((digests (digests-in-threads 8 #'outcome)))
      (is (equal (subseq digests 0 4) (subseq digests 4)))
      (is (equal (subseq digests 0 4) (mapcar #'outcome '(0 1 2 3)))))))
