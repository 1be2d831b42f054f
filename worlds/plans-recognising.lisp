;;;; plans-recognising.lisp -- signatures from cameras, and a way back without odometry.

;;; EXPLORE-BY-VIEWS wanders about in steps. It learns places by their views, and ways between them:
;;; in which direction a step leads to which place. RETURN-BY-VIEWS follows these ways back. Views
;;; tell where the robot is, and which way it faces, so errors do not add up. Neither plan uses a
;;; map, an odometer or a position.

(in-package :ars-worlds)
(in-readtable :nisp)

;;; Signatures.

(defun all-cameras ()
  "Return the indices of all cameras of the plan's robot."
  (loop for camera below (rpl-robot-num-cameras) collect camera))

(defun check-cameras (operator cameras)
  (check-arguments operator
                   (list (and (consp cameras) (ars-magna.base:proper-list-p cameras))
                         "cameras" cameras
                         (format nil "a list of one or more indices of cameras: ~A has ~D"
                                 (rpl-robot) (rpl-robot-num-cameras)))))

(defun views-all-round (camera)
  "Return how many views of CAMERA make a circle. Signals WRONG-ARGUMENT if no number of them does."
  (let* ((field (rpl-camera-field-of-view camera)) (count (round 2pi field)))
    (check-arguments 'take-round-signature
                     (list (< (abs (- (* count field) 2pi)) 1d-6) "camera" camera
                           "a camera with a field of view that divides a circle, such as pi/2"))
    count))

(def-interp-proc take-view (camera)
  "Return the view of CAMERA."
  (outcome (rpl-camera-view camera) (vref camera-input* camera) (vref camera-views* camera)))

(def-interp-proc take-signature (&optional (cameras (all-cameras)))
  "Return a signature of the views of CAMERAS, a list of indices, as they point now."
  (check-cameras 'take-signature cameras)
  (let ((views '()))
    (dolist (camera cameras) (push (take-view camera) views))
    (cons :fixed (reverse views))))

(def-interp-proc face-ahead (camera)
  (outcome (rpl-camera-align-robot camera) (vref camera-moved* camera)
           (vref camera-movement-error* camera)))

(def-interp-proc take-round-signature (&optional (cameras (all-cameras)))
  "Turn each of CAMERAS, a list of indices, all round and return a signature of what they saw. The
field of view of each must divide a circle. Fails with WRONG-ARGUMENT otherwise."
  (check-cameras 'take-round-signature cameras)
  (let ((strips '()))
    (dolist (camera cameras)
      (let ((count (views-all-round camera)) (pixels '()))
        (face-ahead camera)
        (n-times count
          (setf pixels (append pixels (take-view camera)))
          (if (> count 1) (turn-camera camera (rpl-camera-field-of-view camera))))
        (push pixels strips)))
    (cons :round (reverse strips))))

;;; What is known: places, and ways between them. A way is a list (from angle to): from the place
;;; FROM, a step in the direction ANGLE, in radians to the right of the heading at which FROM was
;;; learned, leads to the place TO; or nowhere, if TO is NIL.

(define-run-variable *known-ways* '()
  "The ways that EXPLORE-BY-VIEWS has found in this run: lists (from angle to).")

(defun ways-from (place)
  (remove place *known-ways* :key #'first :test-not #'equal))

(defun known-way (from angle)
  "Return the way from the place FROM that has nearly the direction ANGLE, or NIL."
  (find-if (lambda (way) (< (abs (angle-difference angle (second way))) .7)) (ways-from from)))

(defun note-way (from angle to)
  "Note that the way from the place FROM in the direction ANGLE leads to TO."
  (setf *known-ways* (cons (list from (angle-difference angle 0) to)
                           (remove (known-way from angle) *known-ways* :test #'equal))))

(defun first-way (from test)
  "Return the first of the fewest ways from the place FROM to a place for which TEST is true; NIL if
none lead there."
  (let ((seen (list from)) (routes (list (list from))))
    ;; A route is a list (place way...), the ways the newest first.
    (loop for (place . ways) = (pop routes)
          while place
          do (when (and ways (funcall test place)) (return (first (last ways))))
             (dolist (way (ways-from place))
               (let ((to (third way)))
                 (when (and to (not (member to seen :test #'equal)))
                   (push to seen)
                   (setf routes (append routes (list (list* to way ways))))))))))

;;; Steps. Where the robot is: the name of a place, and how far it has turned since it learned it.

(defun unused-number ()
  "Return a number that no known place has as its name: how many are known, if possible."
  (loop for number from (length *known-places*)
        unless (assoc number *known-places*) return number))

(def-interp-proc find-out-place (cameras threshold)
  "Return the name of the place where the robot is, and how far it has turned since it learned that
place. If the best match is below THRESHOLD, learn the place, with a number as its name."
  (let ((signature (take-round-signature cameras)))
    (multiple-value-bind (name match turn) (recognise-place signature :threshold threshold)
      (declare (ignore match))
      (if name
          (values name turn)
          (values (learn-place (unused-number) signature) 0)))))

(def-interp-proc step-and-look (angle step cameras threshold)
  "Turn the robot by ANGLE and drive STEP metres. Return what FIND-OUT-PLACE does, and true if
something stopped the robot."
  (turn-by (angle-difference angle 0))
  (let ((blocked (drive-by step)))
    (multiple-value-bind (here turn) (find-out-place cameras threshold)
      (values here turn blocked))))

(defun untried-angle (place turn dice)
  "Return a direction in which no way from PLACE is known, by preference straight on; or NIL."
  (let ((sides (if (chance 1/2 dice) '(1 -1) '(-1 1))))
    (find-if-not (lambda (angle) (known-way place angle))
                 (mapcar (lambda (quarters) (+ turn (* quarters (/ pi 2))))
                         (if (chance 3/4 dice)
                             (list 0 (first sides) (second sides) 2)
                             (list (first sides) (second sides) 0 2))))))

(defun note-step (from angle to turn blocked)
  "Note that a step from the place FROM leads to TO, where the robot has the turn TURN, and back,
unless something BLOCKED the robot."
  (if (equal from to)
      (when blocked (note-way from angle nil))
      (progn (note-way from angle to)
             (unless blocked (note-way to (+ turn pi) from)))))

(defun check-count (operator name value)
  (check-arguments operator (list (and (integerp value) (plusp value)) name value
                                  "a whole number, from 1")))

(defun check-step (operator step)
  (check-arguments operator (list (and (realp step) (plusp step)) ":step" step
                                  "a number of metres above 0")))

(def-interp-proc explore-by-views (&key (places 8) (step 2) (cameras (all-cameras))
                                        (threshold recognition-threshold*))
  "Let the robot wander about in steps of STEP metres until it knows PLACES places, or has gone ten
steps for each. If no known place matches by THRESHOLD, the robot learns another place. CAMERAS are
indices. The places are in *KNOWN-PLACES*, with numbers as names: 0 is where the robot started. The
ways are in *KNOWN-WAYS*. Return how many places are known. Fails with WRONG-ARGUMENT."
  (check-count 'explore-by-views ":places" places)
  (check-step 'explore-by-views step)
  (with-valve ((rpl-robot-valve))
    (let ((dice (dice-for 'explore-by-views)))
      (multiple-value-bind (here turn) (find-out-place cameras threshold)
        (n-times (* 10 places) WHILE (< (length *known-places*) places)
          (let ((angle (or (untried-angle here turn dice)
                           (second (first-way here (lambda (place) (untried-angle place 0 dice))))
                           (roll-between 0 2pi dice))))
            (multiple-value-bind (to there blocked)
                (step-and-look (- angle turn) step cameras threshold)
              (note-step here angle to there blocked)
              (setf here to turn there))))))
    (length *known-places*)))

;; On the way back the robot takes the best place, however bad the match. If it is wrong, or
;; something is in the way, the robot notices that nothing has changed, and steps elsewhere.
(def-interp-proc return-by-views (&key (to 0) (step 2) (cameras (all-cameras)) (patience 60))
  "Bring the robot back to the place TO, which EXPLORE-BY-VIEWS has learned with the same STEP and
CAMERAS, by recognition alone. Return how many steps that took. Fails with :LOST after PATIENCE
steps, or with WRONG-ARGUMENT."
  (check-arguments 'return-by-views
                   (list (assoc to *known-places* :test #'equal) ":to" to
                         (format nil "the name of a known place~:[: none is known before ~
                                      EXPLORE-BY-VIEWS or LEARN-PLACE has run~;, one of ~
                                      ~:*~{~S~^, ~}~]"
                                 (mapcar #'first *known-places*))))
  (check-step 'return-by-views step)
  (check-count 'return-by-views ":patience" patience)
  (with-valve ((rpl-robot-valve))
    (let ((count 0) (stuck nil) (dice (dice-for 'return-by-views)))
      (multiple-value-bind (here turn) (find-out-place cameras 0)
        (loop UNTIL (equal here to)
          (if (>= count patience) (fail :class :lost :at here))
          (incf count)
          (let ((way (first-way here (lambda (place) (equal place to)))))
            (multiple-value-bind (next there blocked)
                (step-and-look (if (and way (not stuck))
                                   (- (second way) turn)
                                   (roll-between 0 2pi dice))
                               step cameras 0)
              (setf stuck (and blocked (equal here next)) here next turn there)))))
      count)))
