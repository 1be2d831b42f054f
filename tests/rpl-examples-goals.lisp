;;;; rpl-examples-goals.lisp -- goals and places of the literature, on a robot.

(in-package :ars-magna.tests)
(in-suite rpl-robot)

;;; CRAM's plan library: to get a thing to a place, grasp it and put it down there. If it is lost on
;;; the way, fetch it again, three times in all.

(defvar *thefts* 0 "How often the robot is to lose what it has grasped.")
(defvar *grasped* nil "The colour of what the robot believes to have in its hand.")

(rpl:def-goal (belief (in-hand ?color))
  (and (rpl:fluent-value (svref driver:hand-grasping* 0))
       (eq color *grasped*)))

(rpl:def-goal (achieve (in-hand ?color))
  (tell (list :grasping color (rpl:goals-under-way)))
  (grasped color)
  (setf *grasped* color))

(rpl:def-goal (belief (loc ?color bin)) (believed-p (list 'loc color 'bin)))

(rpl:def-interp-proc let-go-of ()
  (driver:rpl-hand-ungrasp 0)
  (rpl:wait-for (svref driver:hand-moved* 0)))

(rpl:def-interp-proc be-robbed ()
  (if (plusp *thefts*)
      (rpl:seq (decf *thefts*)
               (let-go-of)
               ;; It looks anew.
               (driver:rpl-grab-camera 0)
               (rpl:wait-time 1))))

(rpl:def-goal (achieve (loc ?color bin))
  (rpl:with-retry-counters ((losses 2))
    (rpl:handle-failure ((:lost () (rpl:do-retry losses (rpl:retry))))
      (rpl:achieve `(in-hand ,color))
      (be-robbed)
      (if (not (rpl:belief `(in-hand ,color))) (rpl:fail :class :lost :color color))
      (hand-in-bin)
      (let-go-of)
      (begin-to-believe (list 'loc color 'bin)))))

(defun stow-ball (thefts)
  "Let FITTER stow the ball, robbed THEFTS times. Return how that ended, how often it grasped, and
where the ball is."
  (let ((*thefts* thefts) (*grasped* nil) (*believed* '()) (state nil) (place nil))
    (let ((told (tale (with-fitter (:clean t)
                        (setf state (nth-value 1 (run-as-plan
                                                   (rpl:achieve '(loc world:green bin))))
                              place (world:thing-location (world:find-thing 'ball)))))))
      (list state (length told)
            (and (typep place 'robot:storage-bin) :in-bin)
            (third (first (first told)))))))

(test examples.a-thing-in-its-place-by-way-of-the-hand
  (is (equal '(:succeeded 1 :in-bin) (butlast (stow-ball 0))))
  (is (equal '(:succeeded 3 :in-bin) (butlast (stow-ball 2))))
  (is (equal '(:failed 3 nil) (butlast (stow-ball 3)))))

(test examples.what-it-grasped-for
  "The goal at hand, and the one above it, are known while it works (action awareness)."
  (is (base:value-equal '((rpl:achieve (in-hand green)) (rpl:achieve (loc green bin)))
                        (fourth (stow-ball 0)))))

(test examples.done-is-done
  (let ((*believed* '((loc green bin))))
    (is (null (tale (with-fitter (:clean t)
                      (is (eq :succeeded
                              (nth-value 1 (run-as-plan
                                             (rpl:achieve '(loc world:green bin))))))))))))

;;; *The* thing: exactly one, or failure.

(rpl:def-goal (perceive (the ?description))
  (driver:rpl-camera-get-all-object-designators 0 :local description)
  (rpl:wait-for (svref driver:camera-input* 0))
  (let ((found (rpl:fluent-value (svref driver:camera-designators* 0))))
    (if (/= 1 (length found)) (rpl:fail :class :not-one :found (length found)))
    (first found)))

(test examples.the-thing-is-just-one
  (with-fitter (:clean t)
    (is (typep (run-as-plan (rpl:perceive '(the ((:color world:green))))) 'robot:designator))
    (multiple-value-bind (failure state)
        (let ((base:*message-queue* (base:make-message-queue)))
          (run-as-plan (rpl:perceive '(the ()))))
      (is (eq :failed state))
      (is (eq :not-one (rpl:failure-class failure)))
      (is (= 2 (getf (rpl:failure-data failure) :found)))
      (is (member '(rpl:perceive (the nil)) (rpl:failure-plan-backtrace failure) :test #'equal)
          "Which perceive failed is to be seen."))))

;;; Looking elsewhere, three times.

(rpl:def-goal (perceive (somewhere ?color))
  (rpl:with-retry-counters ((elsewhere 3))
    (rpl:handle-failure ((:not-seen () (rpl:do-retry elsewhere
                                         (tell :elsewhere)
                                         (turn-second-camera (/ pi 2))
                                         (rpl:retry))))
      (driver:rpl-camera-get-object-designator 1 :non-local (list (list :color color)))
      (rpl:wait-for (svref driver:camera-input* 1))
      (or (first (rpl:fluent-value (svref driver:camera-designators* 1)))
          (rpl:fail :class :not-seen :color color)))))

(rpl:def-interp-proc turn-second-camera (angle)
  (driver:rpl-camera-turn 1 angle)
  (rpl:wait-for (svref driver:camera-moved* 1)))

(test examples.looking-elsewhere-three-times
  "The jar is straight ahead; a camera that sees one radian starts aside of it."
  (flet ((look (angle)
           (let ((state nil) (base:*message-queue* (base:make-message-queue)))
             (list (length (tale (with-fitter (:clean t)
                                   (setf state (nth-value
                                                1 (run-as-plan
                                                    (turn-second-camera angle)
                                                    (rpl:perceive
                                                     '(somewhere world:lightred))))))))
                   state))))
    (is (equal '(0 :succeeded) (look 0)))
    (is (equal '(2 :succeeded) (look pi)))
    (is (equal '(3 :succeeded) (look (/ pi 2))))
    (is (equal '(3 :failed) (look .8)))))

;;; At a place of the hall, from which the robot is pushed.

(rpl:def-interp-proc work-at (x ticks)
  (rpl:at-location (x :there (here-p (robot-x) x) :go (drive-to-x x))
    (tell :working)
    (rpl:wait-time ticks)
    (tell (list :worked x))))

(rpl:def-interp-proc push-robot (times from)
  "Wait until the robot is at FROM; push it away, TIMES times."
  (rpl:n-times times
    (rpl:wait-until (here-p (robot-x) from))
    (rpl:wait-time 3)
    (multiple-value-bind (x y) (robot:robot-position postman)
      (robot:place-robot postman (- x 2) y 0))))

(defun work-pushed (times)
  "Return how POSTMAN's work at a place ended that it was pushed from TIMES times, and how often it
was begun and done."
  (let* ((state nil)
         (base:*message-queue* (base:make-message-queue))
         (told (tale (run:with-simulation (postman :clean t)
                       (driver:rpl-init-robot postman)
                       (setf state (nth-value
                                    1 (run-as-plan (rpl:par (work-at 12 8)
                                                            (push-robot times 12)))))))))
    (list state (count :working told :key #'first) (count '(:worked 12) told :key #'first
                                                          :test #'equal))))

(test examples.pushed-from-its-place
  (is (equal '(:succeeded 1 1) (work-pushed 0)))
  (is (equal '(:succeeded 2 1) (work-pushed 1)))
  (is (equal '(:succeeded 11 1) (work-pushed 10)))
  (is (equal '(:failed 11 0) (work-pushed 11))))

(test examples.two-at-places
  "One whose place fits does not drive; the other waits for both."
  (is (equal '(:working :working (:worked 12) (:worked 12) :working (:worked 20))
             (mapcar #'first (told-by-robot (postman)
                               (rpl:par (work-at 12 6)
                                        (rpl:seq (rpl:wait-time 1) (work-at 12 7))
                                        (rpl:seq (rpl:wait-time 2) (work-at 20 1))))))))
