;;;; manual-d.lisp -- An extended example: find, go, grasp, carry, return (manual appendix D).

(in-package :ars-test-manual-5)
(in-readtable :nisp)

(def-suite* manual-d :in ars-magna)

;;; The claims of the appendix about its programs, checked by programs of our own in the same two
;;; styles: with continuations and as plans.

(defmap garden (40 30)
  (rect (0 0) (39 29) stone 10)
  (obj pebble (9 9) ((:size 1) (:weight 1) (:color blue)))
  (obj ball (26 14) ((:size 1.5) (:weight .5) (:color red)))
  (obj globe (9 25.5) ((:size 1.5) (:weight 30) (:color violet))))

(defrobot runner (garden (10 14) 0)
  :cameras (((/ pi 2) 200)) :hands (10) :bins (20))

(defmacro in-garden ((&rest options) &body body)
  "Run BODY with RUNNER in a fresh garden, which plans may drive."
  `(with-simulation (runner ,@options)
     (rpl-init-robot runner)
     ,@body))

(defun eye () (robot-camera runner 0))
(defun claw () (robot-hand runner 0))
(defun pouch () (robot-storage-bin runner 0))
(defun ball () (find-thing 'ball))

(defun metres (thing)
  "Return how far RUNNER is from THING."
  (sqrt (+ (expt (- (thing-x thing) (robot-x runner)) 2)
           (expt (- (thing-y thing) (robot-y runner)) 2))))

(defun place-beside-ball (&optional (dx 0) (dy 0))
  (place-robot runner (+ dx (thing-x (ball))) (+ dy (thing-y (ball))) 0))

;;; With continuations.

(deffunc search-round - VOID (camera - CAMERA kind - SYMBOL wish - THING-DESCRIPTOR
                              then - ROBOT-CONTINUATION)
  (flet ((look ()
           (camera-get-object-designator camera kind wish
             (continuation (code camera found)
               (if found
                   (funcall then code found)
                   (search-round camera kind wish then))))))
    (camera-turn camera (!_field-of-view camera)
      (continuation (code camera angle)
        (if code (funcall then code nil) (look))))))

(test manual-d.functions-of-ones-own-take-continuations
  "D: a function that takes a continuation as robot commands do returns at once, after scheduling
what it needs; its result comes later."
  (in-garden (:clean t)
    (let ((answers '()))
      (search-round (eye) :non-local '((:color violet))
                    (continuation (code designator) (push (list code designator) answers)))
      (is (equal '(0 nil) (list (simulation-tick) answers)))
      (run-until (lambda () answers) :limit 200)
      (destructuring-bind ((code designator)) answers
        (is (null code))
        (is (eq 'violet (second (assoc :color !>designator.data)))))
      (is (near (/ pi 2) (camera-angle (eye)) 1e-6) "it faces what had not been seen before"))))

(test manual-d.searches-end-with-the-error-of-a-turn
  "D: if turning ends with an error, an interruption for instance, that is passed on."
  (in-garden (:clean t)
    (let ((answers '()))
      (search-round (eye) :non-local '((:color lightgreen))
                    (continuation (code designator) (push (list code designator) answers)))
      (run-ticks 40)
      (is (null answers) "it goes on looking")
      (run-until (lambda ()
                   (grab-resource (eye))
                   answers)
                 :limit 40)
      (is (equal '((:interrupt nil)) answers)))))

(defun track-and-go (designator then)
  (camera-track (eye) designator nil)
  (robot-goto-designator runner (eye) (continuation (err &rest more) (funcall then err))))

(defun code-of-going (designator)
  (let ((codes '()))
    (track-and-go designator (lambda (code) (push code codes)))
    (run-until (lambda () codes) :limit 400)
    (first codes)))

(defun designated (kind wish)
  (third (answer 'camera-get-object-designator (eye) kind wish)))

(test manual-d.track-and-go-may-be-asked-for-at-once
  "D.3, three findings, reading 78: what a command needs is looked at when its delay is over, so to
go to a designator may be asked for together with the track that it needs; as going takes longer to
begin than tracking. Were it not so, it would end with :NOT-TRACKING."
  (loop for (x y) in '((26 14) (26.5 14.5) (25.25 10))
        do (in-garden (:clean t)
             (move-thing (ball) x y)
             (is (null (code-of-going (designated :non-local '((:color red))))))
             (is (< (metres (ball)) 1.5))))
  (in-garden (:clean t)
    (let ((red (designated :non-local '((:color red)))))
      (setf camera-desig-delay* (1+ robot-move-delay*))
      (is (eq :not-tracking (code-of-going red))))))

(test manual-d.track-and-grasp-may-be-asked-for-at-once
  "D.5, three findings: grasping takes longer to begin than tracking, so the same holds for it."
  (in-garden (:clean t)
    (place-beside-ball)
    (let ((red (designated :local '((:color red)))))
      (camera-track (eye) red nil)
      (is (equal (list nil (claw) red) (answer 'hand-grasp-desig (claw) (eye) red)))
      (is (eq (ball) (hand-holding (claw)))))))

(test manual-d.two-processes-run-at-once
  "D: a robot may scan with a camera while it moves; a status variable set by continuations tells
which of the two has ended."
  (flet ((first-event (color)
           (in-garden (:clean t)
             (let ((event nil))
               (search-round (eye) :non-local `((:color ,color))
                             (continuation (code designator)
                               (unless event (!= event (list code (designator-p designator))))))
               (robot-go-forward runner 30
                 (continuation (err robot) (unless event (!= event (list :moved err)))))
               (run-until (lambda () event) :limit 300)
               (list event (> (robot-x runner) 10.5))))))
    (is (equal '((nil t) t) (first-event 'violet)))
    (is (equal '((:moved nil) t) (first-event 'lightgreen)))))

(defun grab-step-by-step (designator note)
  "Grasp and stow what DESIGNATOR denotes; call NOTE with the name and code of each step."
  (flet ((step-of (name then)
           (continuation (err &rest more) (funcall note name err) (funcall then))))
    (camera-track (eye) designator nil)
    (hand-grasp-desig (claw) (eye) designator
      (step-of :grasp
        (lambda ()
          (storage-bin-open (pouch)
            (step-of :open
              (lambda ()
                (hand-insert-bin (claw) (pouch)
                  (step-of :insert
                    (lambda ()
                      (hand-ungrasp (claw) (step-of :ungrasp (lambda ()))))))))))))))

(test manual-d.getting-an-object-takes-five-steps
  "D: get a local designator and track it; grasp; open the bin and insert the hand; ungrasp, which
drops the object into it; here the bin is open already (reading 190), which does no harm."
  (in-garden (:clean t)
    (place-beside-ball -.5 .1)
    (let ((steps '()))
      (grab-step-by-step (designated :local '((:color red)))
                         (lambda (name code) (push (list name code) steps)))
      (run-ticks 60)
      (is (equal '((:grasp nil) (:open :bin-open) (:insert nil) (:ungrasp nil)) (reverse steps)))
      (is (eq (pouch) (thing-location (ball))))
      (is (null (hand-holding (claw)))))))

;;; As plans.

(def-interp-proc search-plan (wish result)
  "Turn the camera and look until something fits WISH; put its designator into the fluent RESULT."
  (loop UNTIL result
    (rpl-camera-turn 0 (rpl-camera-field-of-view 0))
    (wait-for (vref camera-moved* 0))
    (if (vref camera-movement-error* 0) (fail :class :turned-away))
    (rpl-camera-get-object-designator 0 :non-local wish)
    (wait-for (vref camera-input* 0))
    (set-value result (first (fluent-value (vref camera-designators* 0))))))

(test manual-d.fluents-return-results
  "D.2: a plan may set a fluent that is given to it, as soon as it has a result."
  (in-garden (:clean t)
    (let ((result (create-fluent 'result nil)))
      (is (eq :succeeded (nth-value 1 (run-plan 'search-plan '((:color violet)) result))))
      (is-true (designator-p (fluent-value result)))
      (is (eq 'violet (second (assoc :color (rpl-designator-data result)))) "fluents will do"))))

(test manual-d.searching-goes-on-amid-noise
  "D: in a noisy world, too, a search that repeats ends with something that looked as asked for."
  (loop for seed below 5
        do (in-garden (:seed seed)
             (let ((result (create-fluent 'result nil)))
               (is (eq :succeeded (nth-value 1 (run-plan 'search-plan '((:color red)) result))))
               (is (eq 'red (second (assoc :color (rpl-designator-data result)))))))))

(test manual-d.plans-fail-when-errors-occur
  "D: the plans simply fail when errors occur."
  (in-garden (:clean t)
    (let ((task (begin-plan 'search-plan '((:color lightgreen)) (create-fluent 'result nil))))
      (run-until (lambda () (rpl-grab-camera 0) (task-over-p task)) :limit 60)
      (is (equal '(:failed :turned-away)
                 (list (task-state task) (failure-class (task-result task))))))))

(def-interp-proc go-plan (wish time)
  "Drive forward for TIME and look; go to what fits WISH; return its data."
  (let ((result (create-fluent 'result nil)))
    (pursue (search-plan wish result)
            (seq (rpl-robot-go-forward time) (wait-for robot-stopped*)))
    (if (not result) (fail :class :nothing-seen))
    (with-policy (seq (set-value (vref camera-tracking-error* 0) nil)
                      (whenever (vref camera-tracking-error* 0)
                        (wait-time 1)
                        (if (not robot-arrived-at*) (fail :class :lost-sight))))
      (rpl-camera-track 0 result)
      (wait-for (vref camera-tracking* 0))
      (set-value robot-arrived-at* nil)
      (rpl-robot-goto-designator 0)
      (wait-for (and robot-stopped* robot-arrived-at*)))
    (rpl-designator-data result)))

(test manual-d.going-by-parallelism-and-policies
  "D.4: scanning and moving in PURSUE, then tracking under a policy: the robot gets there, and the
description that was seen is returned. That the track ends on arrival does not fail the plan, as
robot-arrived-at* is known by then (reading 112)."
  (loop for (x y) in '((16 25) (16.5 24.75))
        do (in-garden (:clean t)
             (move-thing (ball) x y)
             (multiple-value-bind (data state) (run-plan 'go-plan '((:color red)) 30)
               (is (eq :succeeded state))
               (is (equal '(:color red) (assoc :color data)))
               (is (< (metres (ball)) 1.5))
               (is (eq :lost-track (fluent-value (vref camera-tracking-error* 0))))))))

(test manual-d.going-nowhere
  "D.4: if nothing was found when the move ends, the plan fails."
  (in-garden (:clean t)
    (multiple-value-bind (failure state) (run-plan 'go-plan '((:color lightgreen)) 5)
      (is (equal '(:failed :nothing-seen) (list state (failure-class failure)))))))

(def-interp-proc grab-plan (wish)
  "Put what fits WISH, and lies here, into the bin."
  (let ((found nil))
    (rpl-camera-get-object-designator 0 :local wish)
    (wait-for (vref camera-input* 0))
    (setf found (first (fluent-value (vref camera-designators* 0))))
    (if (null found) (fail :class :nothing-here))
    (rpl-camera-track 0 found)
    (wait-for (vref camera-tracking* 0))
    (with-policy (seq (set-value (vref hand-error* 0) nil)
                      (whenever (vref hand-error* 0) (fail :class :hand)))
      (with-policy (seq (set-value (vref camera-tracking-error* 0) nil)
                        (whenever (vref camera-tracking-error* 0) (fail :class :camera)))
        (rpl-hand-grasp-desig 0 0 found) (wait-for (vref hand-moved* 0))
        (rpl-storage-bin-open 0) (wait-for (vref storage-bin-moved* 0))
        (rpl-hand-insert-bin 0 0) (wait-for (vref hand-moved* 0)))
      (rpl-hand-ungrasp 0) (wait-for (vref hand-moved* 0))
      (rpl-hand-remove 0) (wait-for (vref hand-moved* 0)))
    (rpl-storage-bin-close 0) (wait-for (vref storage-bin-moved* 0))))

(test manual-d.grabbing-by-plan
  "D.6, reading 161: the object ends in the bin, which is closed, and the hand is empty and outside.
The track is lost when the hand enters the bin, but that is told after the hand's own movement, when
the policy that would fail is over."
  (in-garden (:clean t)
    (place-beside-ball)
    (is (eq :succeeded (nth-value 1 (run-plan 'grab-plan '((:color red))))))
    (is (equal (list (pouch) nil nil) (list (thing-location (ball)) (hand-holding (claw))
                                            (hand-location (claw)))))
    (is-true (storage-bin-closed-p (pouch)))))

(test manual-d.grabbing-what-is-too-heavy
  "D.6: a policy on the error fluent fails the plan in the middle; its remaining steps are not
run."
  (in-garden (:clean t)
    (place-robot runner 9 25.5 0)
    (planned (rpl-storage-bin-close 0) (wait-for (vref storage-bin-moved* 0)))
    (multiple-value-bind (failure state) (run-plan 'grab-plan '((:color violet)))
      (is (equal '(:failed :hand) (list state (failure-class failure)))))
    (is (eq :insufficient-strength (fluent-value (vref hand-error* 0))))
    (is-true (storage-bin-closed-p (pouch)) "the bin was not opened any more")))

(test manual-d.what-is-in-a-bin-is-seen-from-inside
  "D: to put an object down a camera must be inserted into the bin to sense it."
  (in-garden (:clean t)
    (move-thing (ball) (pouch))
    (flet ((sensed ()
             (planned (rpl-camera-get-object-designator 0 :local '((:color red)))
                      (wait-for (vref camera-input* 0))
                      (fluent-value (vref camera-error* 0)))))
      (is (eq :designator-not-found (sensed)))
      (planned (rpl-camera-insert 0 0) (wait-for (vref camera-moved* 0)))
      (is (null (sensed))))))

(def-interp-proc put-down-plan (wish)
  "Take what fits WISH out of the bin, which is open, and drop it."
  (rpl-camera-insert 0 0) (wait-for (vref camera-moved* 0))
  (rpl-camera-get-object-designator 0 :local wish) (wait-for (vref camera-input* 0))
  (let ((found (first (fluent-value (vref camera-designators* 0)))))
    (rpl-camera-track 0 found) (wait-for (vref camera-tracking* 0))
    (rpl-hand-insert-bin 0 0) (wait-for (vref hand-moved* 0))
    (rpl-hand-grasp-desig 0 0 found) (wait-for (vref hand-moved* 0))
    (par (seq (rpl-hand-remove 0) (wait-for (vref hand-moved* 0))
              (rpl-hand-ungrasp 0) (wait-for (vref hand-moved* 0)))
         (seq (rpl-camera-remove 0) (wait-for (vref camera-moved* 0))))))

(test manual-d.putting-down
  "D.7: hand and camera come out of the bin in parallel; the object drops to the ground where the
robot is (reading 152)."
  (in-garden (:clean t)
    (move-thing (ball) (pouch))
    (place-robot runner 5.25 7 1)
    (is (eq :succeeded (nth-value 1 (run-plan 'put-down-plan '((:color red))))))
    (is (equalp '((5.25 7) nil nil nil)
                (list (where (ball)) (storage-bin-contents (pouch)) (hand-location (claw))
                      (camera-location (eye)))))))

;;; Returning home.

(def-interp-proc turn-plan (angle) (rpl-robot-turn angle) (wait-for robot-stopped*))
(def-interp-proc drive-plan (time) (rpl-robot-go-forward time) (wait-for robot-stopped*))

(def-interp-macro (and-back ?odometer . ?body)
  `(let ((start (rpl-new-odometer ',odometer)))
     ,@body
     (let ((here (nominal (get-odometer-pos start))))
       (loop UNTIL (< (dist here origin*) .5)
         (turn-plan (- (atan2 (- (pt-y here)) (- (pt-x here))) (nominal (get-odometer-ang start))))
         (drive-plan 1)
         (setf here (nominal (get-odometer-pos start)))))))

(def-interp-proc outing-plan (heading)
  (turn-plan heading)
  (and-back walk (drive-plan 6) (turn-plan 1.2) (drive-plan 5) (turn-plan -2) (drive-plan 3)))

(test manual-d.odometers-lead-back
  "D.8, reading 98: an odometer begins where and as the robot stands; its x axis is the heading
then. To turn towards its origin and go, until the centre of its interval is near that, leads
home."
  (dolist (heading '(0 1 -2.5))
    (in-garden (:clean t)
      (place-robot runner 20 15 0)
      (is (eq :succeeded (nth-value 1 (run-plan 'outing-plan heading))))
      (is (< (sqrt (+ (expt (- (robot-x runner) 20) 2) (expt (- (robot-y runner) 15) 2))) .51)))))

(test manual-d.odometers-are-inaccurate
  "D.8: a return by odometry alone is inaccurate: with noise the estimate is near the goal, and the
true position is in the interval (3.2.2), but off its centre."
  (loop for seed below 4
        do (in-garden (:seed seed)
             (place-robot runner 20 15 0)
             (is (eq :succeeded (nth-value 1 (run-plan 'outing-plan 0))))
             (let* ((odometer (robot-odometer runner 'walk))
                    (here (nominal (get-odometer-pos odometer)))
                    (off (sqrt (+ (expt (- (robot-x runner) 20) 2)
                                  (expt (- (robot-y runner) 15) 2)))))
               (is (< (dist here origin*) .5))
               (is (< off 3))
               (is (> (abs (- off (dist here origin*))) 1d-6))))))

;;; All of it.

(def-interp-proc errand-plan (wish time)
  (and-back errand (go-plan wish time) (grab-plan wish))
  (rpl-storage-bin-open 0) (wait-for (vref storage-bin-moved* 0))
  (put-down-plan wish))

(test manual-d.the-robot-brings-the-object
  "D.9: it goes and gets the object, returns, and puts it on the ground where it set out."
  (loop for (x y) in '((16 25) (16.5 24.75))
        do (in-garden (:clean t)
             (move-thing (ball) x y)
             (is (eq :succeeded (nth-value 1 (run-plan 'errand-plan '((:color red)) 30))))
             (is (eq :floor (thing-location (ball))))
             (is (< (sqrt (+ (expt (- (thing-x (ball)) 10) 2) (expt (- (thing-y (ball)) 14) 2)))
                    .6)))))
