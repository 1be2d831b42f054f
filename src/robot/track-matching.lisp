;;;; track-matching.lisp -- tracks that compare what they follow with a description (manual 3.4.2).

(in-package :ars-magna.robot)

(export '(make-matching-track))

;;; The manual matches only in searches, and announces the same for tracks. A matching track follows
;;; its designator as any other track does. Every TRACK-MATCH-INTERVAL* ticks the camera also looks,
;;; by the law of searches: each thing is missed by chance, and readings of the others are compared
;;; with the specification. Of the things that fit, the camera takes the nearest in direction for
;;; the thing that it tracks; its readings become the data of the designator. The designator then
;;; denotes this thing, perhaps a look-alike. See reading 246.

(define-kind (matching-track :include track
                             :constructor (make-matching-track
                                           (designator operation specification
                                            &aux (next-look (tick-of-next-look designator)))))
    "The state of a camera that tracks a designator and matches what it denotes."
  (:state
   (specification '() list "what the thing must be like, a descriptor specification" :shared)
   (next-look 0 fixnum "the tick of the next look")
   (misses 0 fixnum "how many looks in succession have found nothing that fits")))

(defun tick-of-next-look (designator)
  (+ (world-tick (robot-world (designator-robot designator)))
     (ticks-for track-match-interval*)))

(defun angle-off-track (designator thing)
  "Return the angle between the directions of THING and of what DESIGNATOR denotes as seen from the
robot, in radians. It is 0 in a container, and if one of the two has no direction."
  (let ((robot (designator-robot designator))
        (x (designator-x designator)) (y (designator-y designator)))
    (multiple-value-bind (thing-x thing-y) (thing-position thing)
      (if (or (designator-location designator)
              (<= (distance-to robot x y) +least-bearing-distance+)
              (<= (distance-to robot thing-x thing-y) +least-bearing-distance+))
          0d0
          (abs (angle-difference (bearing-to robot thing-x thing-y) (bearing-to robot x y)))))))

(defun things-near-track (camera designator)
  "Return a list of the things that CAMERA may take for what DESIGNATOR denotes: the thing itself,
and the others in view that differ from it by at most TRACK-MATCH-GATE* in direction."
  (let ((thing (designator-denotation designator)))
    (append (and thing (list thing))
            (remove-if (lambda (other)
                         (or (eq other thing)
                             (> (angle-off-track designator other) track-match-gate*)))
                       (things-in-view camera (designator-type designator))))))

(defun nearest-find (finds designator dice)
  "Return the element (thing . readings) of FINDS whose thing seems nearest to the direction of
DESIGNATOR, with errors drawn from DICE; NIL if FINDS is empty."
  (loop with nearest = nil and least = nil
        for find in finds
        for angle = (abs (+ (angle-off-track designator (first find)) (angle-error dice)))
        when (or (null nearest) (< angle least))
          do (setf nearest find
                   least angle)
        finally (return nearest)))

(defun update-matched-designator (camera designator thing readings dice)
  "CAMERA takes THING for what DESIGNATOR denotes. Make it so, and make READINGS the data."
  (setf (designator-data designator)
        (describe-thing thing readings (viewing-distance camera thing) dice))
  (unless (eq thing (designator-denotation designator))
    (setf (designator-denotation designator) thing)
    (refresh-designator designator dice)
    (setf (designator-swing designator) 0d0
          (camera-angle camera) (designator-angle designator))))

(defun look-at-track (track camera dice)
  "Match TRACK of CAMERA: update its designator, or count a look without success, perhaps the last."
  (let* ((designator (track-designator track))
         (specification (matching-track-specification track))
         (find (nearest-find (matching-things camera (things-near-track camera designator)
                                              (parse-specification specification) dice)
                             designator dice)))
    (cond (find
           (setf (matching-track-misses track) 0)
           (update-matched-designator camera designator (first find) (rest find) dice)
           (when (track-operation track)
             (notify-track-match (track-operation track) designator)))
          ((>= (incf (matching-track-misses track)) track-match-misses*)
           (lose-track camera (format nil "nothing there fits ~A" (safe-text specification)))))))

(defmethod match-track ((track matching-track) camera dice)
  (let ((designator (track-designator track)))
    (when (>= (world-tick (robot-world (camera-robot camera))) (matching-track-next-look track))
      (setf (matching-track-next-look track) (tick-of-next-look designator))
      (look-at-track track camera dice))))
