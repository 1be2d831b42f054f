;;;; rpl-examples-robot.lisp -- plans that the literature of RPL shows, on a robot.

(in-package :ars-magna.tests)
(in-suite rpl-robot)

;;; A hall with two lanes: one at 4.5 with a pillar in it, beside a wall, and a free one at 2.5.
(world:defmap mail-hall (44 9)
  (rect (0 0) (43 8) bricks 5)
  (wall (17 5) (23 5) slate 5)
  (obj pillar (20.5 4.5) ((:size 9) (:obsmove t) (:weight 90) (:color violet))))

(robot:defrobot courier (mail-hall (4.5 4.5) 0) :cameras (((* 2 pi) 5)))
(robot:defrobot postman (mail-hall (4.5 2.5) 0) :cameras (((* 2 pi) 5)))

(defun robot-x () (values (robot:robot-position (driver:rpl-robot))))

(rpl:def-interp-macro (commanding ?command ?pulse ?error)
  `(rpl:seq ,command (rpl:wait-for ,pulse) (rpl:fluent-value ,error)))

(rpl:def-interp-proc turn-round-by (angle)
  (commanding (driver:rpl-robot-turn angle) driver:robot-stopped* driver:robot-movement-error*))

(rpl:def-interp-proc go-ahead (metres)
  (driver:rpl-robot-set-speed .5)
  (commanding (driver:rpl-robot-go-forward (ceiling metres .5))
              driver:robot-stopped* driver:robot-movement-error*))

(defun wrong-way-p (x)
  (minusp (* (- x (robot-x)) (cos (robot:robot-angle (driver:rpl-robot))))))

(rpl:def-interp-proc drive-to-x (x &optional blocked)
  "Drive along the hall to X, in whatever pieces. Pulse BLOCKED when something is in the way."
  (loop UNTIL (< (abs (- x (robot-x))) .4)
    (if (wrong-way-p x) (turn-round-by pi))
    (if (eq :robot-blocked (go-ahead (abs (- x (robot-x)))))
        (rpl:seq (rpl:pulse blocked)
                 (rpl:wait-time 1)))))

(defmacro told-by-robot ((robot &rest arguments) &body body)
  "Run BODY as a plan of ROBOT in a clean world. Return what was told, in order."
  `(tale (run:with-simulation (,robot :clean t ,@arguments)
           (driver:rpl-init-robot ,robot)
           (is (eq :succeeded (nth-value 1 (run-as-plan ,@body)))))))

(defun tick-of (item told) (second (find item told :key #'first :test #'equal)))

;;; Mail delivery under two policies, one in the other (cc-Golog, figure 1): charge when the battery
;;; is low, greet at a door.

(defun metres-from-door (x) (abs (- x 18)))

(rpl:def-interp-proc deliver-under-policies (charge)
  (let ((battery (rpl:create-fluent 'battery charge))
        (x (rpl:create-fluent 'x (robot-x))))
    (rpl:pursue
     (loop (rpl:wait-time 1)
           (rpl:set-value x (robot-x))
           (rpl:set-value battery (- (rpl:fluent-value battery) 1)))
     (rpl:with-tags
       (rpl:with-policy (rpl:whenever (<= battery 46)
                          (rpl:with-task-blocked delivery
                            (driver:rpl-grab-robot)
                            (tell (list :charging (robot-x)))
                            (rpl:wait-time 10)
                            (rpl:set-value battery 100)
                            (tell (list :charged (robot-x)))))
         (rpl:with-policy (rpl:whenever (< (rpl:fl-funcall #'metres-from-door x) 1)
                            (tell :hello))
           (:tag delivery
             (drive-to-x 30)
             (tell :delivered))))))))

(test examples.mail-delivery-under-two-policies
  "The first run shows when it is at the door; in the second the battery is low just then."
  (let* ((told (told-by-robot (postman) (deliver-under-policies 1000)))
         (hello (tick-of :hello told)))
    (is (equal '(:hello :delivered) (mapcar #'first told)))
    (let* ((told (told-by-robot (postman) (deliver-under-policies (+ 46 hello))))
           (charging (find-if #'consp told :key #'first))
           (charged (third told)))
      (is (= 4 (length told)) "~S" told)
      (is (equal '(:charging :charged) (list (first (first charging)) (first (first charged)))))
      (is (= hello (second charging) (tick-of :hello told)) "Both at once: ~S" told)
      (is (= 10 (- (second charged) (second charging))))
      (is (= (second (first charging)) (second (first charged))) "It stands while it charges.")
      (is (eq :delivered (first (fourth told)))))))

;;; Navigation that is suspended by an obstacle (Rittweiler's thesis): what is it, and past it on
;;; the right or on the left.

(rpl:def-interp-proc what-is-ahead ()
  (rpl:try-all
    (rpl:seq (driver:rpl-camera-get-object-designator 0 :local '((:color violet)))
             (rpl:wait-for (svref driver:camera-input* 0))
             (if (rpl:fluent-value (svref driver:camera-error* 0)) (rpl:fail :class :not-seen))
             :pillar)
    (rpl:seq (rpl:wait-time 200) :unknown)))

(rpl:def-interp-proc pass-by (side angle)
  (tell side)
  (turn-round-by angle)
  (if (go-ahead 2)
      (rpl:seq (turn-round-by (- angle))
               (rpl:fail :class :no-room :on side)))
  (turn-round-by (- angle))
  (go-ahead 4)
  side)

(rpl:def-interp-proc navigate (x)
  (let ((blocked (rpl:state 'blocked)))
    (rpl:with-tags
      (rpl:pursue
       (:tag navigation (drive-to-x x blocked))
       (rpl:whenever blocked
         (rpl:with-task-blocked navigation
           (tell (what-is-ahead))
           (tell (list :passed (rpl:try-in-order (pass-by :right (/ pi 2))
                                                 (pass-by :left (/ pi -2)))))))))
    (tell (list :at (round (robot-x))))))

(test examples.navigation-past-an-obstacle
  (is (equal '(:pillar :right :left (:passed :left) (:at 34))
             (mapcar #'first (told-by-robot (courier) (navigate 34))))))

;;; A courier that takes opportunities unless another job would miss its deadline (Beetz and
;;; Bennewitz).

(defstruct letter name from to deadline (state :waiting))

(defun here-p (x place) (< (abs (- x place)) .4))

(defun most-urgent (letters)
  (first (sort (remove :delivered (copy-list letters) :key #'letter-state)
               #'< :key #'letter-deadline)))

(defun ticks-left (letter)
  "Return how many ticks there are to spare if the robot goes for LETTER from now on alone."
  (let ((way (if (eq :carried (letter-state letter))
                 (abs (- (letter-to letter) (robot-x)))
                 (+ (abs (- (letter-from letter) (robot-x)))
                    (abs (- (letter-to letter) (letter-from letter)))))))
    (- (letter-deadline letter) (rpl:plan-time) (* 2 way) 6)))

(defun opportunity (x job letters)
  "Return a letter other than JOB that can be taken or handed over at X if there is time."
  (and (> (ticks-left job) 5)
       (find-if (lambda (letter)
                  (ecase (letter-state letter)
                    (:waiting (here-p x (letter-from letter)))
                    (:carried (here-p x (letter-to letter)))
                    (:delivered nil)))
                (remove job letters))))

(rpl:def-interp-proc exchange (letter)
  (rpl:wait-time 3)
  (setf (letter-state letter) (ecase (letter-state letter)
                                (:waiting :carried)
                                (:carried :delivered)))
  (tell (list (letter-state letter) (letter-name letter))))

(rpl:def-interp-proc do-job (job)
  (if (eq :waiting (letter-state job))
      (rpl:seq (drive-to-x (letter-from job))
               (exchange job)))
  (drive-to-x (letter-to job))
  (exchange job))

(rpl:def-interp-proc run-errands (letters)
  (let ((x (rpl:create-fluent 'x (robot-x))))
    (rpl:pursue
     (loop (rpl:wait-time 1) (rpl:set-value x (robot-x)))
     (loop WHILE (most-urgent letters)
       (let ((job (most-urgent letters)))
         (rpl:with-tags
           (rpl:with-policy
               (rpl:whenever (rpl:fl-funcall #'opportunity x job letters)
                 (let ((letter (opportunity (robot-x) job letters)))
                   (if letter
                       (rpl:with-task-blocked errand
                         (driver:rpl-grab-robot)
                         (exchange letter)))))
             (:tag errand (do-job job)))))))))

(defun courier-told (deadline)
  "Return what is told of two letters, if the first has DEADLINE."
  (told-by-robot (postman)
    (run-errands (list (make-letter :name :a :from 10 :to 34 :deadline deadline)
                       (make-letter :name :b :from 20 :to 28 :deadline 400)))))

(test examples.a-courier-takes-opportunities
  (let ((told (courier-told 120)))
    (is (equal '((:carried :a) (:carried :b) (:delivered :b) (:delivered :a))
               (mapcar #'first told)))
    (is (<= (tick-of '(:delivered :a) told) 120))))

(test examples.a-courier-keeps-deadlines
  (let ((told (courier-told 78)))
    (is (equal '((:carried :a) (:delivered :a) (:carried :b) (:delivered :b))
               (mapcar #'first told)))
    (is (<= (tick-of '(:delivered :a) told) 78))))
