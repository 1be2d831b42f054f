;;;; listings-plans.lisp -- the manual's plans, as printed: scan, fetch, come back (manual D).

(in-package :ars-magna.tests)

(in-suite listings)

(defun run-own (name &rest arguments)
  "Run the listings' plan called NAME on VALET. Return its value, or failure, and state. Its output
is discarded."
  (let ((*standard-output* (make-broadcast-stream)))
    (apply #'driver:run-plan (own name) arguments)))

(defun ended-p (state name &rest arguments)
  (eq state (nth-value 1 (apply #'run-own name arguments))))

(defun robot-at (robot)
  (list (robot:robot-x robot) (robot:robot-y robot)))

;;; D.2: scanning.

(defun scan-by-plan (spec)
  "Scan for SPEC with VALET's camera 0. Return the plan's designator, and its state."
  (let* ((fluent (rpl:create-fluent 'desig))
         (state (nth-value 1 (run-own 'rpl-scan-for-object 0 :non-local spec fluent))))
    (values (rpl:fluent-value fluent) state)))

(test rpl-scan-for-object.turns-until-it-finds
  "In eighths of a circle, and first before it looks."
  (with-listings ("d2-rpl-scan-for-object")
    (loop for (x y turns) in '((10.5 12.5 1) (6.5 12.5 2) (2.5 8.5 4) (6.5 4.5 6) (10.5 8.5 8))
          do (with-valet (:clean t)
               (let ((ball (put-ball x y)))
                 (multiple-value-bind (designator state) (scan-by-plan '((:color red)))
                   (is (eq :succeeded state))
                   (is (eq ball (robot:designator-denotation designator)))
                   (is (near (* turns (/ pi 4)) (robot:camera-angle (valets-camera 0))))))))))

(test rpl-scan-for-object.finds-something-amid-noise
  "It goes on until there is a designator; now and then that is a false one, or of another colour."
  (with-listings ("d2-rpl-scan-for-object")
    (loop for seed from 1 to 40
          do (with-valet (:seed seed)
               (put-ball 2.5 8.5)
               (multiple-value-bind (designator state) (scan-by-plan '((:color red)))
                 (is (eq :succeeded state))
                 (is (base:value-equal '(:color red)
                                       (assoc :color (robot:designator-data designator)))))))))

(test rpl-scan-for-object.fails-if-it-cannot-turn
  (with-listings ("d2-rpl-scan-for-object")
    (with-valet (:clean t)
      (let ((task (driver:begin-plan (own 'rpl-scan-for-object) 0 :non-local '((:color red))
                                     (rpl:create-fluent 'desig))))
        (run:run-until (lambda ()
                          ;; It has just told the camera to turn once more.
                          (and (< 10 (run:simulation-tick))
                               (time:timeline-inbox (time:timeline-of (time:current-simulation))))))
        (command:camera-turn (valets-camera 0) 1 nil)
        (run:run-ticks 2)
        (is (eq :failed (rpl:task-state task)))))))

;;; D.4: going there.

(defmacro with-plans-to-go (() &body body)
  `(with-listings ("d2-rpl-scan-for-object" "d4-rpl-go-to-object") ,@body))

(defun go-by-plan (timeout)
  "Make VALET go to a red thing. Return the plan's value and state."
  (run-own 'rpl-go-to-object 0 '((:color red)) timeout))

(test rpl-go-to-object.goes-there
  "It scans while it drives ahead. Its value describes the thing as seen."
  (with-plans-to-go ()
    (loop for (x y) in '((14.5 14.5) (8.5 13.5) (2.5 12.5))
          do (with-valet (:clean t)
               (let ((ball (put-ball x y)))
                 (multiple-value-bind (data state) (go-by-plan 60)
                   (is (eq :succeeded state))
                   (is (base:value-equal '(:color red) (assoc :color data)))
                   (is (near-thing-p ball))
                   (is (near .3 (robot:robot-speed valet) 1d-6))))))))

(test rpl-go-to-object.fails-where-there-is-nothing
  "After it has driven the distance given."
  (with-plans-to-go ()
    (with-valet (:clean t)
      (put-ball 14.5 14.5 'green)
      (is (eq :failed (nth-value 1 (go-by-plan 20))))
      (is (near (+ 6.5 (* 20 .3)) (robot:robot-x valet) 1d-4)))))

(test rpl-go-to-object.fails-when-the-thing-is-gone
  "Its policy detects that the track is lost before the robot has arrived."
  (with-plans-to-go ()
    (with-valet (:clean t)
      (let* ((*standard-output* (make-broadcast-stream))
             (ball (put-ball 14.5 14.5))
             (task (driver:begin-plan (own 'rpl-go-to-object) 0 '((:color red)) 60)))
        (run:run-until (lambda () (< 9 (robot:robot-y valet))) :limit 100)
        (is (not (rpl:task-over-p task)))
        (world:destroy-thing ball)
        (run:run-ticks 3)
        (is (eq :failed (rpl:task-state task)))))))

(test rpl-go-to-object.arrives-amid-noise
  "Each run ends. Most arrive, at the thing found if there was one."
  (with-plans-to-go ()
    (let ((states (loop for seed from 1 to 60
                        collect (with-valet (:seed seed :parameters '((false-thing-prob* 0)))
                                  (let* ((ball (put-ball 12.5 12.5))
                                         (state (nth-value 1 (go-by-plan 60))))
                                    (when (eq state :succeeded)
                                      (is (near-thing-p ball)))
                                    state)))))
      (is (subsetp states '(:succeeded :failed)))
      (is (< 20 (count :succeeded states))))))

;;; D.6: grasping, and stowing away.

(defmacro with-plans-to-grab (() &body body)
  `(with-listings ("d2-rpl-scan-for-object" "d6-rpl-grab-object") ,@body))

(defun grab-by-plan ()
  "Make VALET grab a red thing; return the plan's state."
  (let ((driver:*plan-limit* 5000))
    (nth-value 1 (run-own 'rpl-grab-object 0 0 '((:color red)) 0))))

(defun parts-put-away-p ()
  "True if hand 0 is empty, and neither it nor camera 0 is inside of anything."
  (let ((hand (robot:robot-hand valet 0)))
    (and (null (robot:hand-holding hand))
         (null (robot:part-location hand))
         (null (robot:part-location (valets-camera 0))))))

(defun closed-p (index)
  (world:location-closed-p (robot:robot-storage-bin valet index)))

(test rpl-grab-object.stows-away-what-it-sees
  "All five steps, whether the bin was open or closed."
  (with-plans-to-grab ()
    (dolist (closed '(nil t))
      (with-valet (:clean t)
        (let ((ball (put-ball 6.5 8.5)))
          (when closed
            (call-once 'command:storage-bin-close (robot:robot-storage-bin valet 0)))
          (is (eq :succeeded (grab-by-plan)))
          (is (equal (list ball) (contents-of-bin 0)))
          (is (closed-p 0))
          (is (parts-put-away-p)))))))

(test rpl-grab-object.fails-if-its-hand-does
  (with-plans-to-grab ()
    (with-valet (:clean t)
      (world:set-attribute (put-ball 6.5 8.5) :weight 11)
      (is (eq :failed (grab-by-plan)))
      (is (null (contents-of-bin 0))))))

(defun grab-by-plan-amid-noise (seed)
  "Let VALET grab a ball by chance of SEED. Return how that ended, and whether the bin is closed."
  (with-valet (:seed seed :parameters '((false-thing-prob* 0)))
    (let ((ball (put-ball 6.5 8.5)) (state (grab-by-plan)))
      (when (eq state :succeeded)
        (is (equal (list ball) (contents-of-bin 0)))
        (is (parts-put-away-p)))
      (list state (closed-p 0)))))

(test rpl-grab-object.succeeds-amid-noise-only-if-it-has-it
  "It looks until it sees the ball. Then the hand must hit it (.96), not blur its designator (.9)
and hit the bin (.95), while the camera keeps track for eight ticks (.99 each). It does not ask
whether the bin has jammed in the end."
  (with-plans-to-grab ()
    (let* ((runs (loop for seed from 1 to 300 collect (grab-by-plan-amid-noise seed)))
           (successes (count :succeeded runs :key #'first)))
      (is (subsetp (mapcar #'first runs) '(:succeeded :failed)))
      (is (frequent-p successes 300 (* .96 .9 .95 (expt .99 8))))
      (is (frequent-p (count '(:succeeded nil) runs :test #'equal) successes .01)))))

;;; D.7: putting down.

(defmacro with-plans-to-put-down (() &body body)
  `(with-listings ("d2-rpl-scan-for-object" "d7-rpl-put-down-object") ,@body))

(defun put-down-by-plan ()
  "Make VALET put down the red thing from bin 0; return the plan's state."
  (nth-value 1 (run-own 'rpl-put-down-object 0 0 '((:color red)) 0)))

(defun ball-in-bin ()
  (let ((ball (put-ball 6.5 8.5)))
    (world:move-thing ball (robot:robot-storage-bin valet 0))
    ball))

(defun on-floor-here-p (thing)
  (and (eq :floor (world:thing-location thing))
       (equal (robot-at valet) (multiple-value-list (world:thing-position thing)))))

(test rpl-put-down-object.puts-down
  "The bin, which it opens if that is closed, stays open."
  (with-plans-to-put-down ()
    (dolist (closed '(nil t))
      (with-valet (:clean t)
        (let ((ball (ball-in-bin)))
          (when closed
            (call-once 'command:storage-bin-close (robot:robot-storage-bin valet 0)))
          (is (eq :succeeded (put-down-by-plan)))
          (run:run-ticks 5)
          (is (on-floor-here-p ball))
          (is (not (closed-p 0)))
          (is (parts-put-away-p))
          (is-true (has-words-p (texts) "Camera 0 is not tracking anything")
                   "the camera, which has come out, is told to stop tracking; no harm done"))))))

(test rpl-put-down-object.fails-if-there-is-nothing
  (with-plans-to-put-down ()
    (with-valet (:clean t)
      (is (eq :failed (put-down-by-plan))))))

(test rpl-put-down-object.succeeds-amid-noise-only-if-it-has-done-it
  "It looks only once: the camera must hit the bin (.95), see the ball (.95) and read its colour as
red (.475), and keep track for eight ticks; the hand must hit the bin (.95) and the ball (.96)."
  (with-plans-to-put-down ()
    (let ((states (loop for seed from 1 to 300
                        collect (with-valet (:seed seed :parameters '((false-thing-prob* 0)))
                                  (let ((ball (ball-in-bin)) (state (put-down-by-plan)))
                                    (when (eq state :succeeded)
                                      (is (on-floor-here-p ball))
                                      (is (parts-put-away-p)))
                                    state)))))
      (is (subsetp states '(:succeeded :failed)))
      (is (frequent-p (count :succeeded states) 300
                      (* .95 .95 .475 (expt .99 8) .95 .96))))))

;;; D.8: coming back.

(defun define-outing ()
  "Define a plan that goes some ticks ahead, at a speed, and then comes back by D.8."
  (eval (read-from-string
         "(def-interp-proc outing (ticks speed)
            (with-odometric-return way-back
              (rpl-robot-set-speed speed)
              (rpl-robot-go-forward ticks)
              (wait-for robot-stopped*)))")))

(defun metres-from (x y)
  (sqrt (+ (expt (- (robot:robot-x valet) x) 2) (expt (- (robot:robot-y valet) y) 2))))

(defun way-of-outing (ticks speed)
  "Make VALET go out and come back. Return the plan's state, and the distances from home at ticks."
  (let ((distances '()) (x (robot:robot-x valet)) (y (robot:robot-y valet)))
    (flet ((note (simulation)
             (declare (ignore simulation))
             (push (metres-from x y) distances)))
      (run:add-observer #'note)
      (let ((state (nth-value 1 (run-own 'outing ticks speed))))
        (values state (reverse distances))))))

(defun distances-after-peak (distances)
  "Return DISTANCES from the first time on that they go down."
  (loop for tail on distances
        when (and (rest tail) (< (second tail) (first tail))) return (rest tail)))

(test with-odometric-return.is-content-where-home-is-near
  "Its name is that of an odometer of its own."
  (with-listings ("d8-with-odometric-return")
    (define-outing)
    (with-valet (:clean t)
      (is (eq :succeeded (way-of-outing 1 .4)))
      (is (near 6.9 (robot:robot-x valet) 1d-6))
      (is-true (robot:robot-odometer valet 'way-back)))))

(test with-odometric-return.comes-back-but-does-not-notice
  "As printed its loop never sees where it is: it turns homeward, comes home, and drives on until a
wall ends that."
  (with-listings ("d8-with-odometric-return")
    (define-outing)
    (with-valet (:clean t)
      (multiple-value-bind (state distances) (way-of-outing 10 1)
        (is (eq :failed state))
        (is (near 10 (reduce #'max distances) 1d-6))
        (is (> .1 (reduce #'min (distances-after-peak distances))))
        (is (near 1 (robot:robot-x valet) 1d-4) "at the wall behind")
        (is-true (has-words-p (texts) "Robot is blocked"))))))

(test with-odometric-return.comes-back-amid-noise
  (with-listings ("d8-with-odometric-return")
    (define-outing)
    (loop for seed from 1 to 20
          do (with-valet (:seed seed)
               (multiple-value-bind (state distances) (way-of-outing 10 1)
                 (is (eq :failed state))
                 (is (> 1 (reduce #'min (distances-after-peak distances)))))))))

;;; D.9: all of it.

(defun bring-by-plan (timeout)
  "Make VALET get a red thing and bring it back. Return the plan's state."
  (let ((driver:*plan-limit* 5000))
    (nth-value 1 (run-own 'get-object-and-return 0 0 '((:color red)) 0 timeout))))

(test get-object-and-return.brings-what-is-near
  "From just over a metre behind, less than half a metre from home: there its loop ends at once."
  (with-all-listings ()
    (with-valet (:clean t)
      (robot:set-robot-pose valet 6.1 8.5 0)
      (let ((ball (put-ball 5.05 8.5)))
        (is (eq :succeeded (bring-by-plan 60)))
        (is (on-floor-here-p ball))
        (is (> .5 (metres-from 6.1 8.5)))
        (is (parts-put-away-p))
        (is-true (has-words-p (texts) "Robot is at Designator" "grasped BALL"
                              "dropped BALL#1 into Storage-bin 0" "grasped BALL"
                              "dropped BALL"))))))

(test get-object-and-return.gets-what-is-far-and-misses-home
  "Because of the loop of D.8 it drives on past home, with the ball in its bin."
  (with-all-listings ()
    (with-valet (:clean t)
      (let ((ball (put-ball 14.5 14.5)) (nearest 99))
        (run:add-observer (lambda (simulation)
                             (declare (ignore simulation))
                             (when (contents-of-bin 0)
                               (setf nearest (min nearest (metres-from 6.5 8.5))))))
        (is (eq :failed (bring-by-plan 60)))
        (is (equal (list ball) (contents-of-bin 0)))
        (is (> .3 nearest))
        (is (near 1 (robot:robot-x valet) 1d-3))))))

(test get-object-and-return.ends-amid-noise-too
  "Few runs get through all that can go wrong, and none of these has done less than it says."
  (with-all-listings ()
    (let ((states (loop for seed from 1 to 60
                        collect (with-valet (:seed seed :parameters '((false-thing-prob* 0)))
                                  (robot:set-robot-pose valet 6.1 8.5 0)
                                  (let ((ball (put-ball 5.05 8.5)) (state (bring-by-plan 60)))
                                    (when (eq state :succeeded)
                                      (is (on-floor-here-p ball)))
                                    state)))))
      (is (subsetp states '(:succeeded :failed)))
      (is (< 0 (count :succeeded states))))))
