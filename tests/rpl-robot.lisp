;;;; rpl-robot.lisp -- plans on a robot: accessors, order, runs headless.

(in-package :ars-magna.tests)
(in-suite rpl-robot)

(defmacro run-as-plan (&body body)
  "Run BODY as a plan of the robot in use; return its value, or failure, and state."
  `(driver:run-plan (rpl:interp-lambda () ,@body)))

(defun value-in (fluent) (rpl:fluent-value fluent))

;;; Accessors and arguments.

(test accessors.tell-what-the-robot-has
  (with-fitter ()
    (is (= 2 (driver:rpl-robot-num-cameras)))
    (is (= 2 (driver:rpl-robot-num-hands)))
    (is (= 2 (driver:rpl-robot-num-bins)))
    (is (= 0.8d0 (driver:rpl-robot-speed)))
    (is (= 0.3d0 (driver:rpl-robot-turn-angle)))
    (is (= (* 2 pi) (driver:rpl-camera-field-of-view 0)))
    (is (= 3 (driver:rpl-camera-resolution 1)))
    (is (= 0 (driver:rpl-camera-angle 0)))
    (is (null (driver:rpl-camera-last-view 0)))
    (is (= 5 (driver:rpl-hand-strength 1)))
    (is (= 10 (driver:rpl-storage-bin-capacity 0)))
    (is (= 1 (driver:rpl-storage-bin-real-capacity (rpl:create-fluent 'bin 1))))
    (is (not (driver:rpl-storage-bin-closed? 0)))
    (is (eq (robot:robot-camera fitter 1)
            (driver::find-part :camera (robot:robot-camera fitter 1) 'test)))
    (is (= 2 (length driver:camera-moved*)))
    (is (= 2 (length driver:storage-bin-jammer*)))))

;;; Taking part.

(test interface.takes-part-until-another-does
  "A robot given to plans anew is told of each tick once, however often that is done."
  (with-fitter ()
    (let ((simulation (time:current-simulation)))
      (dotimes (count 3)
        (driver:rpl-init-robot fitter)
        (is (equal (list driver::*default-interface*) (run::simulation-participants simulation))))
      (driver::close-interface driver::*default-interface*)
      (is (null (run::simulation-participants simulation))))))

(test ticks.in-which-plans-only-wait-cost-nothing
  "No byte is allocated. But plans know which tick it is, and hear of what is done from outside."
  (with-fitter ()
    (let* ((bell (rpl:create-fluent 'bell))
           (task (driver:begin-plan (rpl:interp-lambda () (rpl:wait-for bell) (rpl:plan-time)))))
      (run:run-ticks 3)
      (let ((before (sb-ext:get-bytes-consed)))
        (run:run-ticks 5000)
        (is (< (- (sb-ext:get-bytes-consed) before) 100000)))
      (is (= 5003 (rpl:plan-runner-tick (driver:rpl-runner))))
      (is (not (rpl:task-over-p task)))
      (rpl:set-value bell t)
      (run:run-ticks 1)
      (is (<= 5003 (rpl:task-result task) 5004)))))

(test arguments.wrong-ones-say-so
  (with-fitter ()
    (dolist (call (list (lambda () (driver:rpl-camera-turn 2 1))
                        (lambda () (driver:rpl-camera-turn -1 1))
                        (lambda () (driver:rpl-camera-turn nil 1))
                        (lambda () (driver:rpl-hand-strength 7))
                        (lambda () (driver:rpl-storage-bin-open 1.0))
                        (lambda () (driver:rpl-camera-turn 0 "far"))
                        (lambda () (driver:rpl-robot-set-speed :fast))
                        (lambda () (driver:rpl-hand-grasp-desig 0 0 (rpl:create-fluent 'none)))
                        (lambda () (driver:rpl-hand-insert-bin 0 3))
                        (lambda () (driver:rpl-camera-get-object-designator 0 :near '()))
                        (lambda () (driver:rpl-designator-data 5))
                        (lambda () (driver:end-plan 5))))
      (signals base:wrong-argument (funcall call)))
    (is (search "RPL-CAMERA-TURN"
                (handler-case (driver:rpl-camera-turn 0 "far")
                  (base:wrong-argument (trouble) (string-upcase (princ-to-string trouble))))))
    (signals base:unknown-name (driver:run-plan 'no-such-plan))
    (signals base:unknown-name (driver:begin-plan 'no-such-plan))))

(test arguments.may-be-fluents
  (with-fitter (:clean t)
    (flet ((f (value) (rpl:create-fluent 'f value)))
      (run-as-plan
        (driver:rpl-robot-set-speed (f .5))
        (driver:rpl-robot-turn (f 1))
        (rpl:wait-for driver:robot-stopped*)
        (driver:rpl-camera-turn (f 1) (f .5))
        (rpl:wait-for (svref driver:camera-moved* 1))
        (driver:rpl-camera-get-object-designator (f 0) (f :local) (f '((:color green))))
        (rpl:wait-for (svref driver:camera-input* 0))
        (driver:rpl-camera-track 0 (f (first (value-in (svref driver:camera-designators* 0)))))
        (rpl:wait-for (svref driver:camera-tracking* 0))
        (driver:rpl-hand-insert (f 0) (f 1))
        (rpl:wait-for (svref driver:hand-moved* 0))))
    (is (= .5 (driver:rpl-robot-speed)))
    (is (> 1d-9 (abs (- 1 (robot:robot-angle fitter)))))
    (is (= .5 (driver:rpl-camera-angle 1)))
    (is-true (robot:camera-tracks (robot:robot-camera fitter 0)))
    (is (eq (robot:robot-storage-bin fitter 1) (value-in (svref driver:hand-inside* 0))))))

(test interface.needs-a-robot
  (run:with-simulation ((rover))
    (signals base:misuse (driver:rpl-robot-turn 1))
    (is (null (driver:plans)))
    (is (eq rover (driver:rpl-init-robot 'rover)))
    (is (eq rover (driver:rpl-robot))))
  (run:with-simulation ((fitter))
    (is (= 1 (run-as-plan 1)) "RUN-PLAN takes the only robot")
    (run:with-simulation ((rover))
      (signals base:misuse (driver:rpl-robot-turn 1)))
    (is (eq fitter (driver:rpl-robot)))))

(test hand.coming-out-of-a-box-in-a-bin
  "What a hand is inside of is also known when it comes out one level."
  (with-fitter (:clean t)
    (world:move-thing (world:find-thing 'box) (robot:robot-storage-bin fitter 0))
    (is (equal '(box bin nil)
               (run-as-plan
                 (let ((what '()))
                   (flet ((note () (push (let ((inside (value-in (svref driver:hand-inside* 0))))
                                           (cond ((robot:designator-p inside) 'box)
                                                 (inside 'bin)))
                                         what)))
                     (hand-in-bin)
                     (driver:rpl-camera-insert 0 0)
                     (rpl:wait-for (svref driver:camera-moved* 0))
                     (driver:rpl-hand-insert 0 (seen 'red))
                     (rpl:wait-for (svref driver:hand-moved* 0))
                     (note)
                     (driver:rpl-hand-remove 0)
                     (rpl:wait-for (svref driver:hand-moved* 0))
                     (note)
                     (driver:rpl-hand-remove 0)
                     (rpl:wait-for (svref driver:hand-moved* 0))
                     (note)
                     (reverse what))))))))

;;; Order.

(test answers.are-seen-whole
  "Code that receives the pulse sees its values and error code; none comes twice."
  (with-fitter (:clean t)
    (is (equal '((:interrupt nil) (nil 1d0) (nil 0.5d0))
               (run-as-plan
                 (let ((seen '()))
                   (rpl:with-policy
                       (rpl:whenever (driver:robot-stopped* :missed :all)
                         (push (list (value-in driver:robot-movement-error*)
                                     (let ((angle (value-in driver:robot-angle-diff*)))
                                       (and angle (/ (fround angle 1d-3) 1d3))))
                               seen))
                     (driver:rpl-robot-turn 3)
                     (rpl:wait-time 4)
                     (driver:rpl-robot-turn 1)
                     (rpl:wait-for driver:robot-stopped*)
                     (driver:rpl-robot-turn .5)
                     (rpl:wait-for driver:robot-stopped*)
                     (rpl:wait-time 1))
                   (reverse seen)))))))

(test answers.a-wait-after-the-command-hears-it
  "Even of commands that are answered in the very next tick."
  (with-fitter ()
    (is (= 50 (run-as-plan
                (let ((heard 0))
                  (rpl:n-times 50
                    (driver:rpl-robot-place)
                    (rpl:wait-for driver:robot-place-input*)
                    (incf heard))
                  heard))))
    (is (= 50 (run:simulation-tick)))))

(rpl:def-interp-proc waiter (number order)
  (rpl:wait-for driver:robot-stopped*)
  (vector-push-extend number order)
  (rpl:wait-for (> driver:robot-angle-diff* 0))
  (vector-push-extend (- number) order))

(defun order-of-ends ()
  (with-fitter ()
    (let ((order (make-array 0 :adjustable t :fill-pointer t)))
      (loop for number from 1 to 200 do (driver:begin-plan 'waiter number order))
      (is (= 200 (length (driver:plans))))
      (driver:rpl-robot-turn 1)
      (run:run-until (lambda () (null (driver:plans))) :limit 50)
      (coerce order 'list))))

(test plans.two-hundred-end-in-the-same-order
  (let ((order (order-of-ends)))
    (is (= 400 (length order)))
    (loop repeat 9 do (is (equal order (order-of-ends))))))

(rpl:def-interp-proc wanderer ()
  (rpl:n-times 5
    (rpl:try-one (amble 1) (amble -1) (amble 2))))

(rpl:def-interp-proc amble (angle)
  (driver:rpl-robot-turn angle)
  (rpl:wait-for driver:robot-stopped*)
  (driver:rpl-robot-go-forward 2)
  (rpl:wait-for driver:robot-stopped*)
  (driver:rpl-camera-get-all-object-designators 0 :non-local '())
  (rpl:wait-for (svref driver:camera-input* 0)))

(defun trace-of-run (seed)
  "Return the trace of a run, its final digest, and where it ended."
  (let ((driver:*trace-plans* t)
        (*package* (find-package :ars-magna.tests)))
    (with-fitter (:seed seed)
      (driver:run-plan 'wanderer)
      (list (with-output-to-string (stream)
              (rpl:write-trace (rpl:plan-trace (driver:rpl-runner)) stream))
            (run:state-digest)
            (multiple-value-list (robot:robot-position fitter))))))

(test plans.same-seed-same-trace
  (is (equal (trace-of-run 5) (trace-of-run 5)))
  (is (not (equal (third (trace-of-run 5)) (third (trace-of-run 6))))))

(test plans.side-by-side-do-not-meet
  "Two headless simulations, each with a plan in a thread of its own, run as they do alone."
  (let* ((alone (list (trace-of-run 7) (trace-of-run 8)))
         (together (list nil nil))
         (threads (loop for i below 2
                        collect (let ((i i))
                                  (base:start-thread (lambda ()
                                                       (setf (nth i together)
                                                             (trace-of-run (+ 7 i))))
                                                     "a trial")))))
    (mapc #'base:join-thread threads)
    (is (equal alone together))))

;;; Runs.

(test run-plan.says-how-it-ended
  (with-fitter ()
    (with-messages
      (flet ((ended (plan &rest arguments)
               (multiple-value-bind (value state) (apply #'driver:run-plan plan arguments)
                 (list (if (typep value 'rpl:plan-failure) (rpl:failure-class value) value)
                       state))))
        (is (equal '(6 :succeeded) (ended (rpl:interp-lambda (a b) (* a b)) 2 3)))
        (is (equal '(:oops :failed) (ended (rpl:interp-lambda () (rpl:fail :class :oops)))))
        (is (equal '(nil :failed) (ended (rpl:interp-lambda () (parse-integer "x")))))
        (is (equal '(nil :evaporated)
                   (ended (rpl:interp-lambda () (rpl:evaporate (rpl:current-task))
                            (rpl:wait-time 1)))))
        (is (equal '(nil :deadlock)
                   (ended (rpl:interp-lambda () (rpl:wait-for driver:robot-stopped*)))))
        (let ((driver:*plan-limit* 20))
          (is (equal '(nil :limit) (ended (rpl:interp-lambda () (rpl:wait-time 50))))))
        (is (null (driver:plans)) "what did not end was ended")))))

(test run-plan.deadlock-names-task-and-fluent
  (with-fitter ()
    (let ((text (with-output-to-string (stream)
                  (let ((base:*message-queue* (base:make-message-queue)))
                    (run-as-plan (rpl:par (rpl:wait-for (svref driver:hand-lost* 0))
                                          (rpl:wait-for driver:robot-arrived-at*)))
                    (base:error-display stream)))))
      (is (search "eadlock" text))
      (is (search "hand-lost*" text))
      (is (search "robot-arrived-at*" text)))))

(test run-plan.kickers-do-not-hide-a-deadlock
  (run:with-simulation (robbie)
    (with-messages
      (is (eq :deadlock (nth-value 1 (run-as-plan (rpl:wait-for driver:robot-stopped*)))))
      (is (> 5 (run:simulation-tick))))))

(test run-plan.not-inside-a-plan
  (with-fitter ()
    (with-messages
      (is (typep (rpl:lisp-failure-condition (run-as-plan (run-as-plan 1))) 'base:misuse)))))

(test plans.start-and-end-others
  (with-fitter ()
    (is (eq :evaporated
            (run-as-plan
              (let ((other (driver:begin-plan (rpl:interp-lambda () (rpl:wait-time 50)))))
                (rpl:wait-time 2)
                (driver:print-plans (make-broadcast-stream))
                (driver:end-plan other)
                (rpl:wait-time 1)
                (rpl:task-state other)))))))

(test plans.are-listed-and-ended
  (with-fitter ()
    (let ((first (driver:begin-plan (rpl:interp-lambda ()
                                      (rpl:wait-for driver:robot-stopped*)
                                      :heard)))
          (second (driver:begin-plan (rpl:interp-lambda () (rpl:wait-time 100)))))
      (run:run-ticks 2)
      (is (equal (list first second) (driver:plans)))
      (is (search "robot-stopped*"
                  (with-output-to-string (stream) (driver:print-plans stream))))
      (driver:end-plan second)
      (is (eq :evaporated (rpl:task-state second)))
      (driver:rpl-robot-turn .1)
      (run:run-ticks 10)
      (is (eq :succeeded (rpl:task-state first)))
      (is (eq :heard (rpl:task-result first)))
      (driver:begin-plan (rpl:interp-lambda () (rpl:wait-time 100)))
      (driver:end-plan :all)
      (is (null (driver:plans))))))

(test rpl-init-robot.ends-what-was-under-way
  (with-fitter ()
    (let ((task (driver:begin-plan (rpl:interp-lambda () (rpl:wait-time 100))))
          (stopped driver:robot-stopped*))
      (driver:rpl-init-robot fitter)
      (run:run-ticks 1)
      (is (eq :evaporated (rpl:task-state task)))
      (is (not (eq stopped driver:robot-stopped*))))))

(rpl:def-interp-proc rewritten () :old)

(test procedures.redefined-while-running
  (with-fitter ()
    (let ((task (driver:begin-plan (rpl:interp-lambda ()
                                     (let ((first (rewritten)))
                                       (rpl:wait-time 5)
                                       (list first (rewritten)))))))
      (run:run-ticks 2)
      (unwind-protect
           (progn (let ((*error-output* (make-broadcast-stream)))
                    (handler-bind ((warning #'muffle-warning))
                      (eval '(rpl:def-interp-proc rewritten () :new))))
                  (run:run-ticks 10)
                  (is (equal '(:old :new) (rpl:task-result task))))
        (handler-bind ((warning #'muffle-warning))
          (eval '(rpl:def-interp-proc rewritten () :old)))))))

;;; An errand like that of appendix D: fetch the jar from the other room, come back, put it down.

(rpl:def-interp-macro (answer ?command ?pulse ?error)
  `(rpl:seq ,command
            (rpl:wait-for ,pulse)
            (if ,error (rpl:fail :class (value-in ,error)))))

(rpl:def-interp-macro (moving ?command)
  `(answer ,command driver:robot-stopped* driver:robot-movement-error*))
(rpl:def-interp-macro (looking ?command)
  `(answer ,command (svref driver:camera-input* 0) (svref driver:camera-error* 0)))
(rpl:def-interp-macro (handling ?command)
  `(answer ,command (svref driver:hand-moved* 0) (svref driver:hand-error* 0)))
(rpl:def-interp-macro (opening ?command)
  `(answer ,command (svref driver:storage-bin-moved* 0) (svref driver:storage-bin-error* 0)))

(rpl:def-interp-proc follow (type description)
  (looking (driver:rpl-camera-get-object-designator 0 type description))
  (let ((designator (first (value-in (svref driver:camera-designators* 0)))))
    (driver:rpl-camera-track 0 designator)
    (rpl:wait-for (svref driver:camera-tracking* 0))
    designator))

(rpl:def-interp-proc return-to-origin (odometer)
  (let ((here (geo:nominal (robot:get-odometer-pos odometer))))
    (loop UNTIL (< (geo:norm here) .5)
      (moving (driver:rpl-robot-turn
               (geo:angle-difference (geo:atan2 (- (geo:pt-y here)) (- (geo:pt-x here)))
                                     (geo:nominal (robot:get-odometer-ang odometer)))))
      (moving (driver:rpl-robot-go-forward (max 1 (floor (geo:norm here)))))
      (setf here (geo:nominal (robot:get-odometer-pos odometer))))))

(rpl:def-interp-proc bring (description)
  (let ((odometer (driver:rpl-new-odometer 'way)))
    (follow :non-local description)
    (moving (driver:rpl-robot-goto-designator 0))
    (handling (driver:rpl-hand-grasp-desig 0 0 (follow :local description)))
    (handling (driver:rpl-hand-insert-bin 0 0))
    (handling (driver:rpl-hand-ungrasp 0))
    (handling (driver:rpl-hand-remove 0))
    (opening (driver:rpl-storage-bin-close 0))
    (return-to-origin odometer)
    (opening (driver:rpl-storage-bin-open 0))
    (answer (driver:rpl-camera-insert 0 0)
            (svref driver:camera-moved* 0) (svref driver:camera-movement-error* 0))
    (handling (driver:rpl-hand-insert-bin 0 0))
    (handling (driver:rpl-hand-grasp-desig 0 0 (follow :local description)))
    (rpl:par (rpl:seq (handling (driver:rpl-hand-remove 0))
                      (handling (driver:rpl-hand-ungrasp 0)))
             (answer (driver:rpl-camera-remove 0)
                     (svref driver:camera-moved* 0) (svref driver:camera-movement-error* 0)))
    :brought))

(defun distance-to-point (x y other-x other-y)
  (sqrt (+ (expt (- x other-x) 2) (expt (- y other-y) 2))))

(test errand.in-a-clean-world
  (with-fitter (:clean t)
    (multiple-value-bind (value state) (driver:run-plan 'bring '((:color lightred)))
      (is (eq :succeeded state) "~A" value)
      (let ((jar (world:find-thing 'jar)))
        (is (eq :floor (world:thing-location jar)))
        (multiple-value-bind (x y) (world:thing-position jar)
          (is (> .6 (distance-to-point x y 3.5 5.5))))))))
