;;;; manual-4.lisp -- the simulation parameters: what there are, delays, clean and dirty (manual 4).

(in-package :ars-magna.tests)

(def-suite* manual-4 :in ars-magna)

(defparameter *printed-parameters*
  `((ars:max-speed* 1) (ars:max-turn-angle* ,(/ pi 8)) (ars:min-turn-angle* .05) (ars:braking* 2)
    (ars:motion-noise* .1) (ars:robot-turn-max-error* .01) (ars:robot-align-error-prob* .1)
    (ars:robot-move-delay* 5) (ars:robot-turn-delay* 2) (ars:robot-align-delay* 4)
    (ars:camera-angle-max-error* .02) (ars:scan-density* 50) (ars:prob-lose-track* .01)
    (ars:prob-lose-false-track* .4) (ars:false-desig-drift-dist* 1) (ars:false-desig-drift-ang* .2)
    (ars:camera-insert-miss-prob* .05) (ars:camera-insert-lose-desig-prob* .1)
    (ars:camera-move-delay* 2) (ars:camera-align-delay* 1) (ars:camera-desig-delay* 4)
    (ars:type-false-pos* .01) (ars:type-false-neg* .05) (ars:prob-stop* .07)
    (ars:miss-thing-prob* .05) (ars:miss-place-prob* .1) (ars:pixel-error-range* 2)
    (ars:pixel-outlier-prob* .01) (ars:no-sensor-error* nil) (ars:discrete-noise-factor* .1)
    (ars:continuous-noise-factor* .05) (ars:standard-match-threshold* .5)
    (ars:prob-miss-grasp* .04) (ars:prob-grasp-lose-desig* .1) (ars:hand-insert-miss-prob* .05)
    (ars:hand-insert-lose-desig-prob* .1) (ars:hand-move-delay* 2) (ars:hand-grasp-delay* 4)
    (ars:bin-close-jam-prob* .01) (ars:bin-delay* 2))
  "The parameters that the manual lists, and their defaults.")

(defun same-value-p (a b)
  (if (and (realp a) (realp b)) (near a b 1d-7) (eql a b)))

(test manual-4.defaults-are-as-printed
  "4, reading 228: each parameter is a special variable that has the value in brackets, exactly,
unless somebody sets it."
  (loop for (symbol default) in *printed-parameters*
        do (is (same-value-p default (symbol-value symbol)) "~A" symbol)
           (is (same-value-p default (ars:parameter-default (ars:find-parameter symbol)))
               "~A" symbol)))

(test manual-4.what-the-manual-does-not-list-is-ours
  "4, reading 135: such as the chance of false things, and the time that a tick stands for."
  (dolist (parameter (ars:all-parameters))
    (let ((symbol (base:parameter-symbol parameter)))
      ;; Knobs of testbeds are those of programs.
      (unless (equal "Testbeds" (base::parameter-group parameter))
        (is (eq (null (assoc symbol *printed-parameters*)) (base:addition-p symbol)) "~A" symbol))))
  (is (near .01 ars:false-thing-prob*))
  (is (= 1 ars:tick-quantum*)))

(test manual-4.parameters-hold-once-they-are-set
  "4: the physics can be adjusted by setting them, in the midst of a run too."
  (with-sprinter (:clean t)
    (loop for (delay ticks) in '((5 5) (1 1) (0 1) (12 12))
          do (setf ars:robot-move-delay* delay)
             (is (= ticks (first (sprint 'ars:robot-go-forward 1)))))))

;;; Delays.

(defun delayed-commands ()
  "Return a list of (parameters command . arguments): the commands of SPRINTER that take no longer
than the sum of PARAMETERS, and their arguments."
  (let ((camera (lens)) (hand (ars:robot-hand sprinter 0)) (bin (ars:robot-storage-bin sprinter 0)))
    `(((ars:robot-move-delay*) ars:robot-go-forward ,sprinter 1)
      ((ars:robot-turn-delay*) ars:robot-turn ,sprinter .2)
      ((ars:robot-turn-delay* ars:robot-align-delay*) ars:robot-align-place ,sprinter)
      ((ars:robot-turn-delay*) ars:robot-turn-corner ,sprinter)
      ((ars:camera-align-delay*) ars:camera-turn ,camera 2)
      ((ars:camera-align-delay*) ars:camera-align-robot ,camera)
      ((ars:camera-align-delay*) ars:camera-align-place ,camera)
      ((ars:camera-desig-delay*) ars:camera-get-object-designator ,camera :non-local ())
      ((ars:camera-desig-delay*) ars:camera-get-place-designator ,camera ars:doorway)
      ((ars:camera-move-delay*) ars:camera-insert ,camera ,bin)
      ((ars:camera-move-delay*) ars:camera-remove ,camera)
      ((ars:hand-move-delay*) ars:hand-insert-bin ,hand ,bin)
      ((ars:hand-move-delay*) ars:hand-remove ,hand)
      ((ars:bin-delay*) ars:storage-bin-close ,bin)
      ((ars:bin-delay*) ars:storage-bin-open ,bin))))

(test manual-4.delays-are-scheduled
  "4, reading 79: each delay parameter says in how many ticks its operations happen; delays add,
and none at all is the next tick."
  (with-sprinter (:clean t)
    (place-sprinter 1.5 1.5 0)
    (loop for (parameters command . arguments) in (delayed-commands)
          do (loop for delays in '(() (0 0) (7 9))
                   for sum = (reduce #'+ (or delays (mapcar #'symbol-value parameters))
                                     :end (length parameters))
                   do (progv (and delays parameters)
                          (subseq delays 0 (if delays (length parameters) 0))
                        (is (= (max 1 sum) (apply #'ticks-of command arguments))
                            "~A ~A" command delays))))))

(test manual-4.tracking-starts-when-a-designator-would-be-acquired
  "4: CAMERA-DESIG-DELAY* is the time to start tracking, too."
  (with-sprinter (:clean t)
    (put 'ball '(9.5 5.5) :tag 'ball)
    (let ((designator (spot-tag 'ball)))
      (is (= 4 (ticks-of 'ars:camera-track (lens) designator)))
      (reply 'ars:camera-untrack (lens))
      (setf ars:camera-desig-delay* 9)
      (is (= 9 (ticks-of 'ars:camera-track (lens) designator))))))

;;; Clean and dirty.

(defun noise-parameter-p (symbol)
  "True if the parameter SYMBOL makes noise, as one can tell by its name."
  (let ((name (string symbol)))
    (or (member symbol '(ars:motion-noise* ars:no-sensor-error*))
        (and (not (eq symbol 'ars:prob-stop*))
             (loop for part in '("PROB" "ERROR" "FALSE" "OUTLIER") thereis (search part name))))))

(test manual-4.clean-simulation-removes-all-noise
  "4, reading 117: probabilities, error ranges and drifts become 0 and NO-SENSOR-ERROR* T; delays,
limits, density, thresholds and noise factors stay."
  (with-sprinter ()
    (is (null (multiple-value-list (ars:clean-simulation))))
    (loop for (symbol default) in *printed-parameters*
          for value = (symbol-value symbol)
          do (cond ((eq symbol 'ars:no-sensor-error*) (is (eq t value)))
                   ((noise-parameter-p symbol) (is (and (realp value) (zerop value)) "~A" symbol))
                   (t (is (same-value-p default value) "~A" symbol))))
    (is (zerop ars:false-thing-prob*))))

(test manual-4.dirty-simulation-restores-what-was-before
  "4: not the defaults, but the state before CLEAN-SIMULATION was called, whatever was set since."
  (with-sprinter ()
    (setf ars:motion-noise* .3d0 ars:miss-thing-prob* 0 ars:robot-move-delay* 8)
    (let ((before (loop for (symbol) in *printed-parameters* collect (symbol-value symbol))))
      (ars:clean-simulation)
      (setf ars:motion-noise* .7d0 ars:prob-miss-grasp* .9d0)
      (is (null (multiple-value-list (ars:dirty-simulation))))
      (is (equal before
                 (loop for (symbol) in *printed-parameters* collect (symbol-value symbol)))))))

(test manual-4.cleaning-twice-is-cleaning-once
  "4, reading 117: the second call does not take the clean state for the dirty one."
  (with-sprinter ()
    (ars:clean-simulation)
    (ars:clean-simulation)
    (is (zerop ars:motion-noise*))
    (ars:dirty-simulation)
    (is (near .1 ars:motion-noise* 1d-7))
    (is (null ars:no-sensor-error*))))

(test manual-4.dirty-simulation-needs-a-clean-one
  "4, reading 117: without CLEAN-SIMULATION before it does nothing, nor does a second one."
  (with-sprinter ()
    (setf ars:motion-noise* .3d0)
    (ars:dirty-simulation)
    (is (= .3d0 ars:motion-noise*))
    (ars:clean-simulation)
    (ars:dirty-simulation)
    (setf ars:motion-noise* .4d0)
    (ars:dirty-simulation)
    (is (= .4d0 ars:motion-noise*))))

(defun hike ()
  "Make SPRINTER move, look and feel. Return the arguments of its continuations, and its position."
  (flet ((say (calls) (mapcar (lambda (call) (subseq call 0 2)) calls)))
    (list (say (call-times 20 'ars:robot-go-forward sprinter 9))
          (fourth (sprint 'ars:robot-turn 1.5)) (ars:robot-x sprinter) (ars:robot-angle sprinter)
          (fourth (sprint 'ars:robot-place))
          (third (reply 'ars:camera-view (lens)))
          (ars:designator-angle (spot-tag 'ball)))))

(test manual-4.a-clean-world-depends-on-no-chance
  "4: behaviour in a noiseless world is the same for all seeds; in a dirty one it is not."
  (flet ((outcomes (clean)
           (loop for seed from 1 to 6
                 collect (with-sprinter (:seed seed :clean clean
                                         :parameters '((ars:miss-thing-prob* 0)
                                                       (ars:false-thing-prob* 0)))
                           (put 'ball '(12.5 12.5) :tag 'ball)
                           (hike)))))
    (is (= 1 (length (remove-duplicates (outcomes t) :test #'equal))))
    (is (= 6 (length (remove-duplicates (outcomes nil) :test #'equal))))))

(test manual-4.kickers-are-no-noise
  "4, reading 117: the :PROB of a kicker is part of the world, and stays in a clean one."
  (with-sprinter (:clean t :seed 1)
    (let ((kicks 0))
      (ars:put-kicker twitch (thing (put 'gnome '(9.5 5.5))) (:prob .25)
        (progn thing (incf kicks)))
      (ars:run-ticks 2000)
      (is (frequent-p kicks 2000 .25)))))

(test manual-4.no-sensor-error*-suppresses-all-sensing-error
  "4, reading 118: whatever the others say, places, things, angles, pixels and tracks are as they
are; motion is as noisy as ever."
  (with-sprinter (:seed 3 :parameters '((ars:no-sensor-error* t) (ars:type-false-neg* 1)
                                        (ars:type-false-pos* 1) (ars:miss-thing-prob* 1)
                                        (ars:miss-place-prob* 1) (ars:false-thing-prob* 1)
                                        (ars:prob-lose-track* 1) (ars:pixel-outlier-prob* 1)
                                        (ars:camera-angle-max-error* 1)))
    (put 'ball '(9.5 7.5) :tag 'ball :color 'ars:red)
    (is (null (fourth (sprint 'ars:robot-place))))
    (let ((designator (follow-designator (spot-tag 'ball))))
      (is (near (atan 2 4) (ars:designator-angle designator) 1d-6))
      (ars:run-ticks 50)
      (is (eq designator (ars:camera-tracks (lens)))))
    (reply 'ars:camera-untrack (lens))
    (place-sprinter 5.5 5.5 pi)
    (is (null (first (reply 'ars:camera-align-robot (lens)))))
    (is (every (lambda (pixel) (near 10 pixel)) (third (reply 'ars:camera-view (lens)))))
    (is (eq :designator-not-found
            (first (reply 'ars:camera-get-place-designator (lens) 'ars:doorway))))
    (place-sprinter 20.5 13.5 0)
    (is (string= 'doorway (fourth (sprint 'ars:robot-place))))
    (sprint 'ars:robot-go-forward 1)
    (is-false (near 21.3 (ars:robot-x sprinter) 1d-6))))
