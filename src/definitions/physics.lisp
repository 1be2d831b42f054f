;;;; physics.lisp -- the parameters of chapter 4: constants of the world, and chance per tick.

(in-package :ars-magna.definitions)

(export '(ticks-for noise-of-step per-tick-drift per-tick-probability))

(macrolet
    ((define-group (group &rest definitions)
       `(progn
          ,@(loop for (symbol default unit kind type sentence . options) in definitions
                  collect `(define-parameter ,symbol ,default
                               (,@options :unit ,unit :kind ,kind :type ,type :group ,group
                                :clean 0d0)
                             ,sentence))))
     (define-physics (&rest groups)
       `(progn ,@(loop for group in groups collect `(define-group ,@group)))))
  (define-physics
    ;; No delay, distance or angle is beyond what basics/arguments.lisp allows in general.
    ("Robot movement"
     ;; As reading 217 says.
     (max-speed* 1 "cells per tick" :limit (real 0 #.+largest+)
      "The fastest the robot can drive. Motion is swept, so values above 1 skip no cell.")
     ;; As reading 228 says.
     (max-turn-angle* (/ pi 8) "radians per tick" :limit (real 0 #.+largest+)
      "The fastest the robot can turn.")
     (min-turn-angle* 0.05d0 "radians per tick" :limit (real 0 #.+largest+)
      "The slowest the robot can turn.")
     (braking* 2 "ticks" :delay (integer 0 #.+largest+)
      "How long the robot coasts before it comes to a stop.")
     (motion-noise* 0.1d0 "fraction of the speed" :noise (real 0 1)
      "How far the distance driven in a tick may be from the speed; sizes odometer intervals.")
     (robot-turn-max-error* 0.01d0 "fraction of the angle" :noise (real 0 1)
      "How far the angle turned in a tick may be from the turn angle.")
     (robot-align-error-prob* 0.1d0 "probability" :noise (real 0 1)
      "The chance that aligning succeeds although the place type was sensed wrongly.")
     (robot-move-delay* 5 "ticks" :delay (integer 0 #.+largest+)
      "How long a movement takes to start.")
     (robot-turn-delay* 2 "ticks" :delay (integer 0 #.+largest+)
      "How long a turn takes to start.")
     (robot-align-delay* 4 "ticks" :delay (integer 0 #.+largest+)
      "How much longer than a turn an alignment takes to start."))
    ("Cameras"
     (camera-angle-max-error* 0.02d0 "radians" :noise (real 0 #.+largest+)
      "The largest error of a designator's angle and of a camera's report of its turn.")
     (scan-density* 50 "rays" :limit (integer 1 100000)
      "How many evenly spaced rays sample the field of view in a search for a designator. What lies
between two rays is not seen: 50 over a right angle may miss a thing beyond 30 m, even dead ahead,
as an even number of rays has none in the middle.")
     (prob-lose-track* 0.01d0 "probability per tick" :noise (real 0 1)
      "The chance that a track is lost for no reason.")
     (prob-lose-false-track* 0.4d0 "probability per tick" :noise (real 0 1)
      "The chance that the track of a false designator is lost.")
     (false-desig-drift-dist* 1 "cells per tick" :noise (real 0 #.+largest+)
      "How far the perceived distance of a tracked false designator may drift.")
     ;; As reading 21 says.
     (false-desig-drift-ang* 0.2d0 "radians per tick" :noise (real 0 #.+largest+)
      "How far the perceived angle of a tracked false designator may drift.")
     (camera-insert-miss-prob* 0.05d0 "probability" :noise (real 0 1)
      "The chance that inserting a camera misses, which loses the designator.")
     (camera-insert-lose-desig-prob* 0.1d0 "probability" :noise (real 0 1)
      "The chance that inserting a camera loses the designator although it succeeds.")
     (camera-move-delay* 2 "ticks" :delay (integer 0 #.+largest+)
      "How long inserting or removing a camera takes.")
     (camera-align-delay* 1 "ticks" :delay (integer 0 #.+largest+)
      "How long turning a camera takes.")
     (camera-desig-delay* 4 "ticks" :delay (integer 0 #.+largest+)
      "How long acquiring a designator, or starting to track one, takes."))
    ("Sensor error"
     (type-false-pos* 0.01d0 "probability" :noise (real 0 1)
      "The chance of sensing a place type, any of them, where there is none.")
     (type-false-neg* 0.05d0 "probability" :noise (real 0 1)
      "The chance of not sensing the place type that is there.")
     (prob-stop* 0.07d0 "probability per cell" :limit (real 0 1)
      "The chance that the walk along a ray that places a false designator stops.")
     ;; As reading 8 says.
     (miss-thing-prob* 0.05d0 "probability" :noise (real 0 1)
      "The chance that a search overlooks a thing.")
     (miss-place-prob* 0.1d0 "probability" :noise (real 0 1)
      "The chance that a search overlooks a place.")
     ;; As reading 135 says.
     (false-thing-prob* 0.01d0 "probability" :noise (real 0 1)
      "The chance that a search for things finds one that is not there. The manual has false
designators of things, but no parameter for them." :addition :digested)
     (pixel-error-range* 2.0d0 "substance units" :noise (real 0 #.+largest+)
      "The normal error of a pixel, uniform to either side.")
     (pixel-outlier-prob* 0.01d0 "probability" :noise (real 0 1)
      "The chance that a pixel is any value of the map's range.")
     (no-sensor-error* nil "" :noise boolean
      "When true, nothing is sensed wrongly." :clean t)
     (discrete-noise-factor* 0.1d0 "per cell" :limit (real 0 #.+largest+)
      "How fast the reading of discrete attributes gets worse with distance.")
     (continuous-noise-factor* 0.05d0 "cells" :limit (real 0 #.+largest+)
      "How fast the reading of numeric attributes gets worse with distance.")
     (standard-match-threshold* 0.5d0 "attribute units" :limit (real 0 #.+largest+)
      "How far from a specified number a reading may be and still match."))
    ("Hands"
     (prob-miss-grasp* 0.04d0 "probability" :noise (real 0 1)
      "The chance that a grasp misses its object.")
     (prob-grasp-lose-desig* 0.1d0 "probability" :noise (real 0 1)
      "The chance, for each designator on it, that grasping an object loses it.")
     (hand-insert-miss-prob* 0.05d0 "probability" :noise (real 0 1)
      "The chance that inserting a hand misses.")
     (hand-insert-lose-desig-prob* 0.1d0 "probability" :noise (real 0 1)
      "The chance that an insertion that missed loses a designator.")
     (hand-move-delay* 2 "ticks" :delay (integer 0 #.+largest+)
      "How long moving a hand takes.")
     (hand-grasp-delay* 4 "ticks" :delay (integer 0 #.+largest+)
      "How much longer than a move a grasp takes."))
    ("Storage bins"
     (bin-close-jam-prob* 0.01d0 "probability" :noise (real 0 1)
      "The chance that something in a storage bin keeps it from closing.")
     (bin-delay* 2 "ticks" :delay (integer 0 #.+largest+)
      "How long opening or closing a storage bin takes."))
    ("Time"
     (tick-quantum* 1 "ticks" :setting (real 1 1000000)
      "How much time one tick stands for: motion, drift and chances scale with it, and what takes
time takes fewer ticks. The manual only wishes, in chapter 1.2, to skip ahead."
       :addition :digested))))

(defun per-tick-probability (probability)
  "Return the chance that something of PROBABILITY per unit of time happens in a tick, which stands
for TICK-QUANTUM* of them."
  (let ((probability (double probability)))
    (if (= tick-quantum* 1)
        probability
        (- 1d0 (power (- 1d0 probability) (double tick-quantum*))))))

(defun ticks-for (time)
  "Return how many ticks what takes TIME, as the manual counts it in ticks, takes when a tick stands
for TICK-QUANTUM* of it."
  (if (= tick-quantum* 1)
      time
      (values (ceiling time tick-quantum*))))

(declaim (inline noise-of-step))
(defun noise-of-step (noise step unit)
  "Return how far, as a fraction of it, a STEP may be off, if NOISE is how far one of length UNIT
is, which takes a unit of time: in a tick that stands for many, their errors cancel out in part."
  (declare (type (double-float 0d0) step unit))
  (if (<= step unit)
      (double noise)
      (/ (double noise) (sqrt (/ step unit)))))

(defun per-tick-drift (drift)
  "Return how far something may drift in a tick, if it does so by DRIFT at most in a unit of time."
  (if (= tick-quantum* 1)
      (double drift)
      (* (double drift) (sqrt (double tick-quantum*)))))
