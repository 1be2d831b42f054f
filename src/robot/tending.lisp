;;;; tending.lisp -- what happens to tracks and designators in each tick (manual 3.4.3).

(in-package :ars-magna.robot)

(export '(update-tracks tracks-in-progress-p start-track trackable-p out-of-sight-p
          end-track-on-arrival))

;;; Whether a camera that points at something sees it (manual 2.2, 3.4.3). A search sends rays and
;;; does not find what no ray reaches. The same holds for tracks.

(defun ray-crosses-cell-p (dx dy angle)
  "True if a ray in direction ANGLE crosses the cell whose centre is (DX,DY) from the ray's start."
  (let ((cos (cosine angle)) (sin (sine angle)))
    (and (plusp (+ (* dx cos) (* dy sin)))
         (<= (abs (- (* dx sin) (* dy cos)))
             (* 0.5d0 (+ (abs cos) (abs sin)))))))

(defun ray-reaches-p (world x y angle index)
  "True if a ray from (X,Y) in the direction ANGLE, in radians, meets the cell INDEX of WORLD."
  (let ((reached nil))
    (flet ((visit (at flag)
             (or (when (= at index) (setf reached t))
                 (logtest flag +opaque+))))
      (declare (dynamic-extent #'visit))
      (walk-ray #'visit world x y (cosine angle) (sine angle)))
    reached))

(defun ray-visibility (world x y to-x to-y heading width count)
  "Send COUNT rays from (X,Y) in WORLD, spread over WIDTH radians around HEADING. Return :CLEAR if a
ray reaches the cell of (TO-X,TO-Y), :OBSTRUCTED if all rays towards the cell are stopped before it,
or NIL if no ray is directed at the cell."
  (let* ((index (map-index (world-map world) to-x to-y))
         (dx (- (+ 0.5d0 (floor to-x)) x)) (dy (- (+ 0.5d0 (floor to-y)) y))
         (spacing (/ width count)) (first (- heading (* 0.5d0 (- width spacing))))
         (middle (- (+ heading (angle-difference (arctangent dy dx) heading)) first))
         ;; A circle around the cell, seen from there.
         (half (arctangent 0.75d0 (sqrt (+ (* dx dx) (* dy dy)))))
         (sight nil))
    (loop for number from (max 0 (ceiling (- middle half) spacing))
            to (min (1- count) (floor (+ middle half) spacing))
          for angle = (+ first (* number spacing))
          when (ray-crosses-cell-p dx dy angle)
            do (if (ray-reaches-p world x y angle index)
                   (return :clear)
                   (setf sight :obstructed))
          finally (return sight))))

;; Where a robot can drive straight ahead it can see, too, however few the rays are.
(defun visible-p (designator camera)
  "True if CAMERA, pointed at what DESIGNATOR denotes, sees it: rays reach its cell, or nothing
obstructs the view although no ray reaches the cell (reading 141). False designators are visible.
During an approach a free line to a corner of the cell is enough."
  (let* ((robot (camera-robot camera)) (world (robot-world robot))
         (own-x (robot-x robot)) (own-y (robot-y robot))
         (x (designator-x designator)) (y (designator-y designator)))
    (or (null (designator-denotation designator))
        (in-same-cell-p robot x y)
        (line-clear-p world own-x own-y x y)
        (and (or (camera-guides-approach-p camera) (within-reach-p robot x y))
             (in-sight-p world own-x own-y x y))
        (ecase (ray-visibility world own-x own-y x y
                               (+ (robot-angle robot) (designator-angle designator))
                               (camera-field-of-view camera) scan-density*)
          (:clear t)
          (:obstructed nil)
          ((nil) (in-sight-p world own-x own-y x y))))))

;;; A track updates angle and distance of its designator and points the camera there. Only a
;;; matching track updates the data (see track-matching.lisp). A track is lost:
;;; - when the denotation is hidden
;;; - when it moves too fast: its direction from the robot changes in a tick by more than half the
;;;   field of view. The robot's own turning does not count, as the camera compensates it; nor do
;;;   things within reach, or within reach a tick before
;;; - when the robot arrives. A command that drives the robot to something ends the track on
;;;   arrival; else only the robot's own cell counts
;;; - by chance
;;; A local designator of an object out of reach in the open becomes non-local. A false one drifts.

;;; Refreshing.

(defun drift-false-designator (designator dice)
  "Move the false DESIGNATOR at random unless local: nearer or farther, and sideways (reading 143)."
  (let* ((robot (designator-robot designator))
         (map (world-map (robot-world robot)))
         (x (designator-x designator)) (y (designator-y designator)))
    (unless (or no-sensor-error* (eq (designator-type designator) :local))
      (let ((distance (abs (+ (distance-to robot x y)
                              (roll-within (per-tick-drift false-desig-drift-dist*) dice))))
            (bearing (+ (bearing-to robot x y)
                        (roll-within (per-tick-drift false-desig-drift-ang*) dice))))
        (setf (values (designator-x designator) (designator-y designator))
              (clip-to-map map
                           (+ (robot-x robot) (* distance (cosine bearing)))
                           (+ (robot-y robot) (* distance (sine bearing)))))))))

(defun refresh-designator (designator dice)
  "Update the tracked DESIGNATOR; store the change of direction in DESIGNATOR-SWING (reading 226)."
  (let ((robot (designator-robot designator)) (before (designator-distance designator)))
    (unless (designator-denotation designator) (drift-false-designator designator dice))
    (multiple-value-bind (x y) (designator-position designator)
      (setf (designator-x designator) x
            (designator-y designator) y
            (designator-swing designator) 0d0)
      (unless (designator-location designator)
        (let ((distance (distance-to robot x y)))
          (setf (designator-distance designator) distance)
          (if (> distance +least-bearing-distance+)
              (update-bearing designator (bearing-to robot x y) before dice)
              (setf (designator-bearing-p designator) nil)))))))

(defun update-bearing (designator bearing before dice)
  "Update DESIGNATOR to the true direction BEARING. BEFORE is its denotation's previous distance."
  (let* ((robot (designator-robot designator))
         (relative (- bearing (robot-angle robot)))
         (known (designator-bearing-p designator)))
    (unless (or (not known)
                (< before 1d0)
                (within-reach-p robot (designator-x designator) (designator-y designator)))
      (setf (designator-swing designator)
            (abs (angle-difference bearing (designator-bearing designator)))))
    (unless (and known (= relative (designator-relative-bearing designator)))
      (set-bearing designator bearing dice))))

;;; Losing.

(defun refresh-once (designator tick dice)
  "Refresh DESIGNATOR unless another camera's track has done so in TICK."
  (unless (= (designator-refreshed designator) tick)
    (setf (designator-refreshed designator) tick)
    (refresh-designator designator dice)))

(defun denotation-in-open-p (designator)
  "True if DESIGNATOR denotes something in the open: not in a container or bin, and no place whose
door is closed."
  (let ((denotation (designator-denotation designator)))
    (and (null (designator-location designator))
         (typecase denotation
           (thing (null (denotation-enclosure designator)))
           (place (not (blocked-cell-p (robot-world (designator-robot designator))
                                       (designator-x designator) (designator-y designator)
                                       +closed-door+)))
           (t t)))))

(defun robot-at-denotation-p (designator)
  (in-same-cell-p (designator-robot designator)
                  (designator-x designator) (designator-y designator)))

(defun trackable-p (designator camera)
  "True if CAMERA, in the open, can track the non-local DESIGNATOR now, wherever CAMERA points."
  (and (designator-valid-p designator)
       (denotation-in-open-p designator)
       (not (robot-at-denotation-p designator))
       (visible-p designator camera)))

(defun out-of-sight-p (designator camera)
  "True if DESIGNATOR denotes something in the open that is hidden from CAMERA."
  (and (denotation-in-open-p designator)
       (not (visible-p designator camera))))

(defun cannot-follow-p (camera designator)
  "True if CAMERA cannot follow the non-local DESIGNATOR any longer. The arrival at the end of an
approach does not count, because the approach itself reports it (reading 112)."
  (if (robot-at-denotation-p designator)
      (not (camera-guides-approach-p camera))
      (or (not (trackable-p designator camera))
          ;; See reading 141.
          (> (designator-swing designator) (* 0.5d0 (camera-field-of-view camera))))))

(defun keep-or-lose-track (camera designator dice)
  "Point CAMERA at DESIGNATOR and match the track if due, or by chance let CAMERA lose the track
(readings 220, 235)."
  (cond ((and (not no-sensor-error*)
              (chance (per-tick-probability (if (designator-denotation designator)
                                                prob-lose-track*
                                                prob-lose-false-track*))
                      dice))
         (lose-track camera))
        (t (setf (camera-angle camera) (designator-angle designator))
           (match-track (camera-tracking camera) camera dice))))

(defun update-local-track (camera designator dice)
  (let ((local (designator-truly-local-p designator)))
    (cond ((not (or local (denotation-in-open-p designator)))
           (drop-designator designator))
          (t (unless local (setf (designator-type designator) :non-local))
             (if (out-of-sight-p designator camera)
                 (lose-track camera)
                 (keep-or-lose-track camera designator dice))))))

(defun update-track (camera designator tick dice)
  (refresh-once designator tick dice)
  (cond ((eq (designator-type designator) :local)
         (update-local-track camera designator dice))
        ((cannot-follow-p camera designator) (lose-track camera))
        (t (keep-or-lose-track camera designator dice))))

;;; The tracks phase.

(defun drop-unreachable-designators (robot)
  (let ((designators (robot-designators robot)))
    (loop for number from 0
          while (< number (length designators))
          do (let ((designator (aref designators number)))
               (when (and designator
                          (eq (designator-type designator) :local)
                          (not (designator-truly-local-p designator))
                          (not (tracked-p designator)))
                 (drop-designator designator))))))

;; See readings 87 and 112.
(defun update-robot-tracks (robot tick)
  (when (plusp (length (robot-designators robot)))
    (loop with dice = (robot-dice robot :tracking)
          for camera across (robot-cameras robot)
          for designator = (camera-tracks camera)
          when designator
            do (update-track camera designator tick dice))
    (drop-unreachable-designators robot))
  (when (robot-ended-tracks robot)
    (loop for (track . code) in (reverse (shiftf (robot-ended-tracks robot) '()))
          do (report-track-end track code))))

(defun update-tracks (world)
  "Update all tracks and designators in WORLD for this tick."
  (dolist (robot (robots-in-order world))
    (update-robot-tracks robot (world-tick world))))

(defun tracks-in-progress-p (world)
  "True if WORLD must run ticks because a camera tracks or a track has ended."
  (loop for robot in (world-robots world)
          thereis (or (robot-ended-tracks robot)
                      (some #'camera-tracking (robot-cameras robot)))))

(defun start-track (camera designator operation
                    &optional (track (make-track designator operation)))
  "Make CAMERA track DESIGNATOR. When TRACK ends, call NOTIFY-TRACK-END of OPERATION (reading 142)."
  (unless (tracked-p designator)
    (let ((robot (camera-robot camera)))
      (refresh-once designator (world-tick (robot-world robot)) (robot-dice robot :tracking))
      ;; It may have been seen from quite another place.
      (setf (designator-swing designator) 0d0)))
  (setf (camera-angle camera) (designator-angle designator)
        (camera-tracking camera) track))

(defun end-track-on-arrival (camera)
  "Point CAMERA at what it tracks and end its track, because the robot has arrived (reading 108)."
  (let ((designator (camera-tracks camera)))
    (when (designator-denotation designator)
      (refresh-designator designator (robot-dice (camera-robot camera) :tracking))
      (setf (camera-angle camera) (designator-angle designator)))
    (lose-track camera)))
