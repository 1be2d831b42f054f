;;;; parameters.lisp -- the parameters of chapter 4, each defined once, and chance per tick.

(in-package :ars-magna.definitions)

(export '(parameter check-parameter-value describe-type define-parameter non-default-parameters
          check-parameters *noise-before-cleaning* ticks-for noise-of-step per-tick-drift
          per-tick-probability remove-noise-except))

;;; Each parameter is a special variable that users may SETF. Its one definition gives its
;;; documentation, the check of its value, its noiseless value and its line in the prompt's list. A
;;; headless run binds all of them; a live run follows the global values.

(addition parameter-p)
(define-record parameter
  "The description of a simulation parameter."
  (symbol nil symbol "the special variable that is the parameter" :export)
  (default nil t "the value that the manual gives" :addition)
  (unit "" string "the unit of the values, a string" :addition)
  (type t t "the type of the parameter's values" :export)
  (test (constantly t) function "the function that is true of the values that are of the type")
  (kind :limit (member :noise :delay :limit :setting)
        ":NOISE, :DELAY, :LIMIT or :SETTING" :addition)
  (clean nil t "the value in a noiseless world of a parameter of kind :NOISE" :export)
  (group "" string "the heading that chapter 4 lists it under" :addition)
  (sentence "" string "what the parameter means" :addition)
  (digested-p t boolean
              "digests include even the default of the parameter; see DIGEST-PARAMETERS"))
(declaim-final parameter)

(addition parameter-name)
(defun parameter-name (parameter)
  "Return the name of PARAMETER, a lower-case string such as \"max-speed*\"."
  (string-downcase (parameter-symbol parameter)))

(defmethod print-object ((parameter parameter) stream)
  (print-unreadable-object (parameter stream :type t)
    (write-string (parameter-name parameter) stream)))

(define-registry parameter "simulation parameter" :object-p parameter-p :fixed t
  :aliases (lambda (parameter)
             (list (string-right-trim "*" (symbol-name (parameter-symbol parameter))))))

(eval-when (:compile-toplevel :load-toplevel :execute)
  (defun limit-text (limit)
    "Return the number LIMIT as a short text: 1e9 for a thousand million."
    (let ((power (and (integerp limit) (>= limit 1000000) (1- (length (princ-to-string limit))))))
      (if (and power (= limit (expt 10 power)))
          (format nil "1e~D" power)
          (princ-to-string limit))))

  (defun describe-type (type)
    "Return a text that describes TYPE, the type of a parameter."
    (cond ((eq type 'boolean) "T or NIL")
          ((and (consp type) (member (first type) '(real integer)))
           (format nil "~:[a number~;an integer~]~@[ from ~A~]~@[ to ~A~]"
                   (eq (first type) 'integer)
                   (and (second type) (limit-text (second type)))
                   (and (third type) (limit-text (third type)))))
          ((typep type '(cons (eql or) (cons (eql null) (cons t null))))
           (format nil "NIL or ~A" (describe-type (third type))))
          ((typep type '(cons (eql member) cons))
           (format nil "one of ~{~(~S~)~^, ~}" (rest type)))
          (t (format nil "a value of type ~(~S~)" type)))))

;; As numbers have two limits each, so do the types: (real 0 1).
(defmacro define-parameter (symbol default
                            (&key (unit "") (type t) (kind :limit) (group "") clean addition)
                            sentence)
  "Define SYMBOL as a special variable and simulation parameter. CLEAN is its value in a noiseless
world, for parameters of the kind :NOISE; if it equals DEFAULT, it must be the same Lisp number.
ADDITION is true if the manual does not have the parameter. With :DIGESTED, digests include the
parameter even if it has its default value."
  ;; Or a run would have another digest after CLEAN-SIMULATION.
  (assert (or (eql default clean) (not (equalp default clean))) ()
          "The default of ~(~A~), ~S, equals its clean value: write ~S." symbol default clean)
  `(progn
     (,(if addition 'addition 'public) ,symbol)
     (defvar ,symbol ,default
       ,(format nil "~A Default ~A~@[ ~A~]; ~A.~:[ (Manual, chapter 4.)~;~]" sentence
                (let ((*read-default-float-format* 'double-float))
                  (princ-to-string (eval default)))
                (and (string/= unit "") unit)
                (describe-type type)
                addition))
     (register
      *parameters* ',symbol
      (make-parameter :symbol ',symbol :default ,default :unit ,unit :type ',type
                      :test (lambda (value) (typep value ',type))
                      :kind ,kind :clean ,clean :group ,group :sentence ,sentence
                      :digested-p ,(and (member addition '(nil :digested)) t)))
     ',symbol))

(defun check-parameter-value (parameter value)
  "Signal WRONG-ARGUMENT unless PARAMETER can have VALUE."
  ;; A NaN cannot even be tested for its type.
  (unless (and (or (not (realp value)) (finite-p value))
               (funcall (parameter-test parameter) value))
    (reject-argument "set parameter" (parameter-name parameter) value
                     (describe-type (parameter-type parameter)))))

(addition parameter-value)
(settable parameter-value)
(defun parameter-value (parameter)
  "Return the current value of PARAMETER, a parameter or its name. Can be set. Signals
WRONG-ARGUMENT if the new value is of the wrong type or out of range."
  (symbol-value (parameter-symbol (find-parameter parameter))))

(defun (setf parameter-value) (value parameter)
  (let ((parameter (find-parameter parameter)))
    (check-parameter-value parameter value)
    (setf (symbol-value (parameter-symbol parameter)) value)))

(defun check-parameters ()
  "Signal WRONG-ARGUMENT if any parameter has a value of the wrong type or out of range."
  (dolist (parameter (registry-objects *parameters*))
    (check-parameter-value parameter (symbol-value (parameter-symbol parameter)))))

(defun non-default-parameters ()
  "Return a list (symbol value) for each parameter whose value is not its default."
  (loop for parameter in (registry-objects *parameters*)
        for value = (parameter-value parameter)
        unless (eql value (parameter-default parameter))
          collect (list (parameter-symbol parameter) value)))

;;; Noise on and off.

(defvar *noise-before-cleaning* nil
  "The parameters that CLEAN-SIMULATION has changed, with their former values: a list of lists
(symbol value); NIL in a dirty simulation.")

(defun remove-noise-except (names)
  "As CLEAN-SIMULATION, but do not change the parameters with the symbols NAMES."
  (unless *noise-before-cleaning*
    (setf *noise-before-cleaning*
          (loop for parameter in (registry-objects *parameters*)
                when (and (eq (parameter-kind parameter) :noise)
                          (not (member (parameter-symbol parameter) names)))
                  collect (list (parameter-symbol parameter) (parameter-value parameter))
                  and do (setf (parameter-value parameter) (parameter-clean parameter))))))

(public clean-simulation)
(defun clean-simulation ()
  "Remove all noise and error: set every noise parameter to its noiseless value and NO-SENSOR-ERROR*
to T. DISCRETE-NOISE-FACTOR*, CONTINUOUS-NOISE-FACTOR*, STANDARD-MATCH-THRESHOLD* and the errors of
rangefinders do not change, because they have no effect while NO-SENSOR-ERROR* is true. Delays and
limits do not change either.
A second call changes nothing. Return nothing (manual, chapter 4; reading 117)."
  (remove-noise-except '())
  (values))

(public dirty-simulation)
(defun dirty-simulation ()
  "Undo CLEAN-SIMULATION: restore the values that the noise parameters had before. If
CLEAN-SIMULATION was not called, do nothing. Return nothing (manual, chapter 4)."
  (loop for (symbol value) in (shiftf *noise-before-cleaning* nil)
        do (setf (symbol-value symbol) value))
  (values))

;;;; The parameters of the manual

(macrolet
    ((define-physics (&rest groups)
       `(progn
          ,@(loop for (group . definitions) in groups
                  append (loop for (symbol default unit kind type sentence . options) in definitions
                               collect `(define-parameter ,symbol ,default
                                            (,@options :unit ,unit :kind ,kind :type ,type
                                             :group ,group :clean 0d0)
                                          ,sentence))))))
  (define-physics
    ;; basics/conditions.lisp limits delays, distances and angles in general.
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
      "The largest error of the distance driven in a tick. It also sets odometer intervals.")
     (robot-turn-max-error* 0.01d0 "fraction of the angle" :noise (real 0 1)
      "The largest error of the angle turned in a tick.")
     (robot-align-error-prob* 0.1d0 "probability" :noise (real 0 1)
      "The chance that aligning succeeds although the place type was sensed wrongly.")
     (robot-move-delay* 5 "ticks" :delay (integer 0 #.+largest+)
      "How long a movement takes to start.")
     (robot-turn-delay* 2 "ticks" :delay (integer 0 #.+largest+)
      "How long a turn takes to start.")
     (robot-align-delay* 4 "ticks" :delay (integer 0 #.+largest+)
      "How many more ticks an alignment takes to start than a turn does.")
     (step-duration* 15 "ticks" :delay (integer 1 #.+largest+)
      "How long a step to a neighbouring cell takes. With the initial speed and turn angle, 15 ticks
are enough for each direction." :addition t)
     (step-by-grid* nil "" :setting boolean
      "When true, a step is aimed from the robot's true position and heading, so that the errors of
steps do not add up. When NIL, it is aimed from the estimate of the main odometer." :addition t)
     (push-strength* 100 "" :limit (real 0 #.+largest+)
      "The greatest weight of the things that a robot can push at once." :addition t))
    ("Cameras"
     (camera-angle-max-error* 0.02d0 "radians" :noise (real 0 #.+largest+)
      "The largest error of a designator's angle and of a camera's report of its turn.")
     (scan-density* 50 "rays" :limit (integer 1 100000)
      "The number of evenly spaced rays that sample the field of view in a search for a designator.
Things between two rays are not seen: with 50 rays over a right angle, the robot may miss a thing
beyond 30 m, even straight ahead, because an even number of rays has no ray in the middle.")
     (prob-lose-track* 0.01d0 "probability per tick" :noise (real 0 1)
      "The chance that a track is lost for no reason.")
     (prob-lose-false-track* 0.4d0 "probability per tick" :noise (real 0 1)
      "The chance that the track of a false designator is lost.")
     (false-desig-drift-dist* 1 "cells per tick" :noise (real 0 #.+largest+)
      "The largest drift of the perceived distance of a tracked false designator.")
     ;; As reading 21 says.
     (false-desig-drift-ang* 0.2d0 "radians per tick" :noise (real 0 #.+largest+)
      "The largest drift of the perceived angle of a tracked false designator.")
     (camera-insert-miss-prob* 0.05d0 "probability" :noise (real 0 1)
      "The chance that inserting a camera misses, which loses the designator.")
     (camera-insert-lose-desig-prob* 0.1d0 "probability" :noise (real 0 1)
      "The chance that inserting a camera loses the designator although it succeeds.")
     (camera-move-delay* 2 "ticks" :delay (integer 0 #.+largest+)
      "How long inserting or removing a camera takes.")
     (camera-align-delay* 1 "ticks" :delay (integer 0 #.+largest+)
      "How long turning a camera takes.")
     (camera-desig-delay* 4 "ticks" :delay (integer 0 #.+largest+)
      "How long it takes to acquire a designator, or to start a track.")
     ;; As reading 246 says.
     (track-match-interval* 10 "ticks" :limit (integer 1 #.+largest+)
      "How many ticks pass from one look of CAMERA-TRACK-MATCHING to the next." :addition t)
     (track-match-misses* 3 "looks" :limit (integer 1 #.+largest+)
      "How many looks of CAMERA-TRACK-MATCHING in succession must find nothing that fits until the
track is lost." :addition t)
     (track-match-gate* 0.1d0 "radians" :limit (real 0 #.+largest+)
      "How far from the direction of its thing CAMERA-TRACK-MATCHING may take another thing for it."
      :addition t))
    ("Sensor error"
     (type-false-pos* 0.01d0 "probability" :noise (real 0 1)
      "The chance of sensing some place type where there is no place type.")
     (type-false-neg* 0.05d0 "probability" :noise (real 0 1)
      "The chance of not sensing the place type of a place.")
     (prob-stop* 0.07d0 "probability per cell" :limit (real 0 1)
      "The chance, for each cell along a ray, that a false designator is placed there.")
     ;; As reading 8 says.
     (miss-thing-prob* 0.05d0 "probability" :noise (real 0 1)
      "The chance that a search overlooks a thing.")
     (miss-place-prob* 0.1d0 "probability" :noise (real 0 1)
      "The chance that a search overlooks a place.")
     ;; As reading 135 says.
     (false-thing-prob* 0.01d0 "probability" :noise (real 0 1)
      "The chance that a search for things finds a thing that does not exist. The manual has false
designators of things, but no parameter for them." :addition :digested)
     (pixel-error-range* 2.0d0 "substance units" :noise (real 0 #.+largest+)
      "The largest usual error of a pixel's value, too high or too low. Errors are uniform.")
     (pixel-outlier-prob* 0.01d0 "probability" :noise (real 0 1)
      "The chance that a pixel has a random value in the map's range.")
     (no-sensor-error* nil "" :noise boolean
      "When true, nothing is sensed wrongly." :clean t)
     (discrete-noise-factor* 0.1d0 "per cell" :limit (real 0 #.+largest+)
      "How fast readings of discrete attributes become less reliable with distance.")
     (continuous-noise-factor* 0.05d0 "cells" :limit (real 0 #.+largest+)
      "How fast readings of numeric attributes become less accurate with distance.")
     (standard-match-threshold* 0.5d0 "attribute units" :limit (real 0 #.+largest+)
      "How far a reading may differ from a requested number and still match it."))
    ("Hands"
     (prob-miss-grasp* 0.04d0 "probability" :noise (real 0 1)
      "The chance that a grasp misses its object.")
     (prob-grasp-lose-desig* 0.1d0 "probability" :noise (real 0 1)
      "The chance, for each designator of an object, that a grasp loses the designator.")
     (hand-insert-miss-prob* 0.05d0 "probability" :noise (real 0 1)
      "The chance that inserting a hand misses.")
     (hand-insert-lose-desig-prob* 0.1d0 "probability" :noise (real 0 1)
      "The chance that a missed insertion of a hand loses a designator.")
     (hand-move-delay* 2 "ticks" :delay (integer 0 #.+largest+)
      "How long moving a hand takes.")
     (hand-grasp-delay* 4 "ticks" :delay (integer 0 #.+largest+)
      "How many more ticks a grasp takes than a move of the hand."))
    ("Storage bins"
     (bin-close-jam-prob* 0.01d0 "probability" :noise (real 0 1)
      "The chance that something in a storage bin keeps it from closing.")
     (bin-delay* 2 "ticks" :delay (integer 0 #.+largest+)
      "How long opening or closing a storage bin takes."))
    ("Radio"
     (radio-range* nil "metres" :limit (or null (real 0 #.+largest+))
      "How far apart two robots may be when one sends the other a message. NIL means any distance."
      :addition t)
     (radio-delay* 1 "ticks" :delay (integer 0 #.+largest+)
      "How long after it was sent a message arrives, at least 1 tick." :addition t)
     (prob-lose-message* 0d0 "probability" :noise (real 0 1)
      "The chance, for each receiver, that a message does not arrive." :addition t)
     (prob-garble-message* 0d0 "probability" :noise (real 0 1)
      "The chance, for each receiver, that a message that arrives is :GARBLED." :addition t)
     (mailbox-size* 100 "messages" :limit (integer 1 10000)
      "How many messages a robot's mailbox holds. A message more drops the oldest." :addition t))
    ("Rangefinders"
     (range-delay* 1 "ticks" :delay (integer 0 #.+largest+)
      "How long it takes to read a rangefinder." :addition t)
     (range-noise* 0.02d0 "fraction of the distance" :limit (real 0 1)
      "The largest usual error of a distance that a rangefinder measures. Errors are uniform."
      :addition t)
     (range-outlier-prob* 0.01d0 "probability" :limit (real 0 1)
      "The chance that a beam of a rangefinder reads a random distance." :addition t)
     (range-miss-prob* 0.02d0 "probability" :limit (real 0 1)
      "The chance that a beam of a rangefinder misses an obstacle and reads its maximum."
      :addition t))
    ("Time"
     (tick-quantum* 1 "ticks" :setting (real 1 1000000)
      "How many of the manual's ticks one tick represents. Motion, drift and chances per tick are
multiplied by it; actions that take time take fewer ticks. Manual 1.2 only proposes to skip time."
       :addition :digested))))

(defun per-tick-probability (probability)
  "Return the chance that an event happens in a tick, if PROBABILITY is its chance per unit of time.
A tick lasts TICK-QUANTUM* units."
  (let ((probability (double probability)))
    (if (= tick-quantum* 1)
        probability
        (- 1d0 (power (- 1d0 probability) (double tick-quantum*))))))

(defun ticks-for (time)
  "Return the number of ticks that an action of TIME units takes. A unit is a tick of the manual; a
tick lasts TICK-QUANTUM* units."
  (if (= tick-quantum* 1)
      time
      (values (ceiling time tick-quantum*))))

(declaim (inline noise-of-step))
(defun noise-of-step (noise step unit)
  "Return the relative error of a step of the length STEP. NOISE is the relative error of a step of
the length UNIT, which takes a unit of time. In a tick of many units, the errors partly cancel out."
  (declare (type (double-float 0d0) step unit))
  (if (<= step unit)
      (double noise)
      (/ (double noise) (sqrt (/ step unit)))))

(defun per-tick-drift (drift)
  "Return the largest drift in a tick, if DRIFT is the largest drift in a unit of time."
  (if (= tick-quantum* 1)
      (double drift)
      (* (double drift) (sqrt (double tick-quantum*)))))
