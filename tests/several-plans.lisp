;;;; several-plans.lisp -- several robots of a run, each with plans of its own.

(in-package :ars-magna.tests)

(def-suite* several-plans :in ars-magna)

(world:defmap croft (40 40)
  (rect (0 0) (39 39) bricks 10))

(robot:defrobot ada (croft (5 5) 0) :cameras ((3 10)) :hands (10))
(robot:defrobot ben (croft (5 15) 0) :cameras ((3 10) (2 8)))
(robot:defrobot cyd (croft (5 25) 0))

(defmacro with-three (options &body body)
  "Run BODY with the robots ADA, BEN and CYD."
  `(run:with-simulation ((ada ben cyd) :clean t ,@options)
     (declare (special ada ben cyd))
     ,@body))

(rpl:def-interp-proc drive-metres (metres)
  (driver:rpl-robot-go-forward (round (/ metres 0.8)))
  (rpl:wait-for driver:robot-stopped*)
  (robot:robot-name (driver:rpl-robot)))

(rpl:def-interp-proc turn-about (angle)
  (driver:rpl-robot-turn angle)
  (rpl:wait-for driver:robot-stopped*)
  (rpl:fluent-value driver:robot-angle-diff*))

(rpl:def-interp-proc drive-mate (mate)
  (list (driver:on-robot (mate) (drive-metres 4))
        (robot:robot-name (driver:rpl-robot))))

(defun x-of (robot) (round (robot:robot-x robot)))

;;; Which robot a plan drives.

(test plans.of-several-robots-run-side-by-side
  (with-three ()
    (let ((tasks (list (driver:begin-plan 'drive-metres 8 :robot ada)
                       (driver:begin-plan 'drive-metres 16 :robot 'ben)
                       (driver:begin-plan 'drive-metres 4 :robot "CYD"))))
      (is (= 3 (length (driver:plans))))
      (is (equal (list (second tasks)) (driver:plans 'ben)))
      (run:run-ticks 40)
      (is (equal '(ada ben cyd) (mapcar #'rpl:task-result tasks)))
      (is (equal '(13 21 9) (mapcar #'x-of (list ada ben cyd))))
      (is (null (driver:plans))))))

(test plans.without-a-robot-drive-that-of-the-last-init
  (with-three ()
    (signals base:misuse (driver:begin-plan 'drive-metres 8))
    (driver:rpl-init-robot ben)
    (is (eq 'ben (driver:run-plan 'drive-metres 8)))
    (driver:rpl-init-robot 'cyd)
    (is (eq 'cyd (driver:run-plan 'drive-metres 8)))
    (is (eq 'ada (driver:run-plan 'drive-metres 8 :robot ada)))
    (is (eq cyd (driver:rpl-robot)))))

(test init.ends-the-plans-of-that-robot-only
  (with-three ()
    (let ((first (driver:begin-plan 'drive-metres 8 :robot ada))
          (second (driver:begin-plan 'drive-metres 8 :robot ben))
          (old (driver:robot-fluent ada 'driver:robot-stopped*))
          (other (driver:robot-fluent ben 'driver:robot-stopped*)))
      (run:run-ticks 3)
      (driver:rpl-init-robot ada)
      (is (eq :evaporated (rpl:task-state first)))
      (is (not (rpl:task-over-p second)))
      (is (not (eq old (driver:robot-fluent ada 'driver:robot-stopped*))))
      (is (eq other (driver:robot-fluent ben 'driver:robot-stopped*)))
      (run:run-ticks 40)
      (is (eq 'ben (rpl:task-result second)))
      (is (> (robot:robot-x ben) (robot:robot-x ada))))))

(test plans.begun-by-a-plan-drive-its-robot
  (with-three ()
    (driver:rpl-init-robot ada)
    (is (eq :succeeded
            (nth-value 1 (driver:run-plan
                          (rpl:interp-lambda ()
                            (let ((task (driver:begin-plan 'drive-metres 8)))
                              (rpl:join-task task)
                              (unless (eq 'ben (rpl:task-result task)) (rpl:fail))))
                          :robot ben))))))

(test arguments.with-a-plan-that-takes-robot-itself
  (with-three ()
    (driver:rpl-init-robot ada)
    (is (equal '(ben ada)
               (driver:run-plan (rpl:interp-lambda (&key robot)
                                  (list robot (robot:robot-name (driver:rpl-robot))))
                                :robot 'ben)))
    (signals base:unknown-name (driver:begin-plan 'drive-metres 8 :robot 'nobody))
    (signals base:wrong-argument (driver:begin-plan 'drive-metres 8 :robbot 'ben))))

(rpl:def-interp-proc name-by-default (&key (name (robot:robot-name (driver:rpl-robot))))
  name)

(test arguments.get-default-values-on-the-robot-that-the-plan-drives
  (with-three ()
    (is (eq 'ben (driver:run-plan 'name-by-default :robot ben)))
    (driver:rpl-init-robot ada)
    (is (eq 'ben (driver:run-plan 'name-by-default :robot ben)))
    (is (eq 'cyd (driver:run-plan (rpl:interp-lambda ()
                                    (let ((task (driver:begin-plan 'name-by-default :robot cyd)))
                                      (rpl:join-task task)))
                                  :robot ben)))))

(test thinking.is-charged-to-robots-that-plans-first-drive-during-a-reaction
  (with-three (:thinking :charged)
    (is (= 5 (driver:run-plan (rpl:interp-lambda ()
                                (let ((task (driver:begin-plan
                                             (rpl:interp-lambda () (rpl:think 5) (rpl:plan-time))
                                             :robot ben)))
                                  (rpl:join-task task)))
                              :robot ada)))))

(test fluents.first-asked-for-in-several-threads-at-once-are-the-same
  (loop repeat 50
        do (with-three ()
             (let* ((ready (base:make-semaphore "ready")) (simulation time:*simulation*)
                    (threads (loop repeat 6
                                   collect (base:start-thread
                                            (lambda ()
                                              (base:wait-on-semaphore ready)
                                              (run:call-with-thread-bindings
                                               simulation
                                               (lambda ()
                                                 (let ((driver::*default-interface* nil))
                                                   (driver:robot-fluent
                                                    ada 'driver:robot-stopped*)))))
                                            "asker"))))
               (loop repeat 6 do (base:signal-semaphore ready))
               (is (= 1 (length (remove-duplicates (mapcar #'base:join-thread threads)))))
               (is (= 1 (length (run::simulation-participants simulation))))
               (is (= 1 (length (driver::interface-drivers
                                 (driver::interface-of-simulation simulation)))))))))

;;; ON-ROBOT and fluents.

(test on-robot.means-another-robot-for-its-extent
  (with-three ()
    (is (equal '(ben ada) (driver:run-plan 'drive-mate 'ben :robot ada)))
    (is (equal '(5 9) (mapcar #'x-of (list ada ben))))
    (is (equal '(cyd ben ada)
               (driver:run-plan
                (rpl:interp-lambda ()
                  (let ((names '()))
                    (driver:on-robot (ben)
                      (rpl:par (driver:on-robot ((robot:find-robot 'cyd))
                                 (rpl:wait-time 3)
                                 (push (robot:robot-name (driver:rpl-robot)) names))
                               (rpl:seq (rpl:wait-time 2)
                                        (push (robot:robot-name (driver:rpl-robot)) names))))
                    (push (robot:robot-name (driver:rpl-robot)) names)
                    (list (second names) (third names) (first names))))
                :robot ada)))))

(test on-robot.ends-with-its-body-in-any-way
  (with-three ()
    (is (eq 'ada (driver:run-plan
                  (rpl:interp-lambda ()
                    (rpl:handle-failure ((t () (return nil)))
                      (driver:on-robot (ben) (rpl:wait-time 1) (rpl:fail)))
                    (block out (driver:on-robot (ben) (rpl:wait-time 1) (return-from out)))
                    (robot:robot-name (driver:rpl-robot)))
                  :robot ada)))
    (is (eq :failed (nth-value 1 (driver:run-plan
                                  (rpl:interp-lambda () (driver:on-robot ('nobody) nil))
                                  :robot ada))))))

(test fluents.are-those-of-the-robot-that-the-plan-drives
  (with-three ()
    (driver:begin-plan 'turn-about 1 :robot ada)
    (driver:begin-plan 'turn-about 2 :robot ben)
    (run:run-ticks 20)
    (flet ((turned (robot)
             (value-in (driver:robot-fluent robot 'driver:robot-angle-diff*))))
      (is (near-p 1 (turned ada)))
      (is (near-p 2 (turned 'ben)))
      (is (null (turned cyd))))
    (is (= 2 (length (driver:robot-fluent ben 'driver:camera-input*))))
    (is (eq (svref (driver:robot-fluent ben 'driver:camera-input*) 1)
            (driver:robot-fluent ben 'driver:camera-input* 1)))
    (signals base:wrong-argument (driver:robot-fluent ben 'driver:camera-input* 2))
    (signals base:wrong-argument (driver:robot-fluent ben 'driver:robot-stopped* 0))
    (signals base:wrong-argument (driver:robot-fluent ben 'no-fluent))
    (driver:rpl-init-robot ben)
    (signals base:misuse (setf driver:robot-stopped* 5))))

(test networks.keep-the-fluents-that-they-captured
  (with-three ()
    (let ((condition nil))
      (driver:begin-plan (rpl:interp-lambda ()
                           (setf condition (ars-magna.rpl.lifted:or driver:robot-stopped* nil))
                           (rpl:wait-time 1))
                         :robot ada)
      (run:run-ticks 1)
      (let ((task (driver:begin-plan (rpl:interp-lambda (network)
                                       (rpl:wait-for network)
                                       (rpl:plan-time))
                                     condition :robot ben)))
        (driver:begin-plan 'turn-about 0.9 :robot ben)
        (run:run-ticks 6)
        (is (not (rpl:task-over-p task)))
        (driver:begin-plan 'turn-about 0.9 :robot ada)
        (run:run-ticks 6)
        (is-true (rpl:task-over-p task))))))

(test fluents.of-users-and-valves-are-shared
  (with-three ()
    (let ((bell (rpl:create-fluent 'bell)) (valve (rpl:make-valve 'gate)) (order '()))
      (flet ((use (name ticks)
               (rpl:interp-lambda ()
                 (rpl:wait-for bell)
                 (rpl:with-valve (valve)
                   (push (list name :in (rpl:plan-time)) order)
                   (rpl:wait-time ticks)
                   (push (list name :out (rpl:plan-time)) order)))))
        (driver:begin-plan (use 'a 3) :robot ada)
        (driver:begin-plan (use 'b 3) :robot ben)
        (driver:begin-plan (rpl:interp-lambda () (rpl:wait-time 2) (rpl:set-value bell t))
                           :robot cyd)
        (run:run-ticks 20)
        (is (equal '(:in :out :in :out) (mapcar #'second (reverse order))))
        (is (equal '(3 6 6 9) (mapcar #'third (reverse order))))))))

;;; Ends.

(test end-plan.ends-all-plans-or-those-of-a-robot
  (with-three ()
    (flet ((begin (robot) (driver:begin-plan (rpl:interp-lambda () (rpl:wait-time 100))
                                             :robot robot)))
      (let ((tasks (mapcar #'begin (list ada ada ben cyd))))
        (driver:end-plan :all :robot 'ada)
        (is (equal '(:evaporated :evaporated :waiting :waiting)
                   (progn (run:run-ticks 1) (mapcar #'rpl:task-state tasks))))
        (driver:end-plan :all)
        (is (every #'rpl:task-over-p tasks))
        (signals base:wrong-argument (driver:end-plan (first tasks) :robot 'ada))))))

(test end-plan.ends-plans-of-a-robot-together
  (with-three ()
    (let* ((valve (rpl:make-valve 'door)) (entered '())
           (plan (rpl:interp-lambda (name)
                   (rpl:with-valve (valve) (push name entered) (rpl:wait-time 100))))
           (tasks (list (driver:begin-plan plan 'first :robot ada)
                        (driver:begin-plan plan 'second :robot ada)
                        (driver:begin-plan plan 'other :robot ben))))
      (run:run-ticks 1)
      (driver:end-plan :all :robot ada)
      (run:run-ticks 1)
      (is (equal '(:evaporated :evaporated :waiting) (mapcar #'rpl:task-state tasks)))
      (is (equal '(other first) entered)))))

(test commands.of-an-ended-plan-are-interrupted-on-every-robot
  (with-three ()
    (let ((task (driver:begin-plan (rpl:interp-lambda (mate)
                                     (driver:rpl-robot-go-forward 20)
                                     (driver:on-robot (mate) (driver:rpl-robot-go-forward 20))
                                     (rpl:wait-time 100))
                                   ben :robot ada)))
      (run:run-ticks 3)
      (driver:end-plan task)
      (run:run-ticks 1)
      (let ((before (mapcar #'robot:robot-x (list ada ben))))
        (is-true (every #'plusp before))
        (run:run-ticks 5)
        (is (equal before (mapcar #'robot:robot-x (list ada ben))))))))

(test robots.that-leave-end-their-plans-only
  (with-own-definitions ()
    (eval '(world:defmap fold (20 20)))
    (eval '(robot:defrobot ewe (fold (3 3) 0)))
    (eval '(robot:defrobot ram (fold (3 7) 0)))
    (with-stopped-run (ewe)
      (let ((first (driver:begin-plan 'drive-metres 6 :robot 'ewe))
            (second (driver:begin-plan 'drive-metres 6 :robot 'ram)))
        (run:run-ticks 3 time:*simulation*)
        (ars:undefine 'robot 'ewe)
        (run:run-ticks 20 time:*simulation*)
        (is (eq :evaporated (rpl:task-state first)))
        (is (eq 'ram (rpl:task-result second)))))))

;;; A robot gets a new driver or leaves.

(test init.of-a-robot-lets-on-robot-of-others-go-on
  (with-three ()
    (let* ((log '())
           (task (driver:begin-plan
                  (rpl:interp-lambda ()
                    (driver:on-robot ('ben)
                      (loop (driver:rpl-robot-turn 1)
                            (rpl:wait-for driver:robot-stopped*)
                            (push (rpl:fluent-value driver:robot-movement-error*) log))))
                  :robot ada)))
      (run:run-ticks 6)
      (driver:rpl-init-robot ben)
      (let ((before (length log)))
        (run:run-ticks 20)
        (is (not (rpl:task-over-p task)))
        (is (< (+ 2 before) (length log)))))))

(test init.in-a-live-run-lets-on-robot-of-others-go-on-at-once
  (with-three ()
    ;; So slow that no command ends by itself.
    (run:start-clock time:*simulation* :rate 1)
    (unwind-protect
         (let* ((driven-p nil)
                (task (driver:begin-plan
                       (rpl:interp-lambda ()
                         (driver:on-robot ('ben)
                           (driver:rpl-robot-go-forward 30)
                           (setf driven-p t)
                           (rpl:wait-for driver:robot-stopped*)
                           (driver:rpl-robot-turn 1)
                           :on))
                       :robot ada)))
           (awaiting driven-p)
           (driver:rpl-init-robot ben)
           (awaiting (eq :on (rpl:task-result task))))
      (run:stop-clock time:*simulation*))))

;; Nothing but the wait lets time go on.
(test live.a-plan-that-never-waits-delays-no-other
  (with-three ()
    (run:start-clock time:*simulation* :rate :free)
    (unwind-protect
         (let ((count 0) (latest 0))
           (driver:begin-plan (rpl:interp-lambda () (loop (random 5))) :robot ada)
           (driver:begin-plan (rpl:interp-lambda ()
                                (loop (rpl:wait-time 1)
                                      (setf latest (rpl:plan-time))
                                      (incf count)))
                              :robot ben)
           (awaiting (< 20 count))
           (is (<= 20 latest)))
      (driver:end-plan :all)
      (run:stop-clock time:*simulation*))))

(test live.time-passes-while-a-plan-computes
  (with-three ()
    (run:start-clock time:*simulation* :rate :free)
    (unwind-protect
         (let ((task (driver:begin-plan (rpl:interp-lambda ()
                                          (loop (when (< 30 (rpl:plan-time)) (return :polled))))
                                        :robot ada)))
           (awaiting (eq :polled (rpl:task-result task))))
      (driver:end-plan :all)
      (run:stop-clock time:*simulation*))))

(test robots.that-leave-let-on-robot-fail
  (with-own-definitions ()
    (eval '(world:defmap fold (20 20)))
    (eval '(robot:defrobot ewe (fold (3 3) 0)))
    (eval '(robot:defrobot ram (fold (3 7) 0)))
    (with-stopped-run (ewe)
      (let ((task (driver:begin-plan
                   (rpl:interp-lambda ()
                     (rpl:handle-failure ((:robot-gone () (return :alone)))
                       (driver:on-robot ('ram)
                         (loop (driver:rpl-robot-turn 1)
                               (rpl:wait-for driver:robot-stopped*)))))
                   :robot 'ewe)))
        (run:run-ticks 3 time:*simulation*)
        (ars:undefine 'robot 'ram)
        (run:run-ticks 3 time:*simulation*)
        (is (eq :alone (rpl:task-result task)))))))

(test messages.are-sent-while-the-robot-drives
  (with-three ()
    (is (equal '(:arrived :succeeded)
               (multiple-value-list
                (driver:run-plan (rpl:interp-lambda ()
                                   (driver:rpl-robot-go-distance 10)
                                   (rpl:wait-time 3)
                                   (driver:rpl-robot-send 'ben :hi)
                                   (rpl:wait-for driver:robot-sent*)
                                   (rpl:wait-for driver:robot-stopped*)
                                   (or (rpl:fluent-value driver:robot-movement-error*) :arrived))
                                 :robot ada))))
    (is (equal '(:hi ada) (subseq (multiple-value-list (robot:next-message ben)) 0 2)))))

(test project.takes-the-robot
  (with-three (:seed 1)
    (driver:begin-plan 'drive-metres 9 :robot ada)
    (let ((projection (ars-magna.rpl-projecting:project 'drive-metres
                        :arguments '(8) :robot 'ben :trials 2)))
      (is (= 2 (ars-magna.rpl-projecting:projection-successes projection)))
      (is (= 1 (length (driver:plans)))))))
