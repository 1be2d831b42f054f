;;;; scanning.lisp -- what a camera has in view: things, places, surfaces (manual 3.4.3).

(in-package :ars-magna.robot)

(export '(look-for-things look-for-places camera-heading take-view warn-of-unknown-attributes))

;;; SCAN-DENSITY* rays cross the field of view. In view is whatever is in a cell that a ray meets,
;;; up to and including the first cell that is a wall or holds something that obstructs vision; also
;;; all in the robot's own cell. Things within reach need no ray, since rays from next to a thing
;;; may all miss it: their direction must be in the field of view. A camera inside a container or
;;; storage bin sees what is directly in it, at distance 0. What a hand holds is where the hand is.

(declaim (inline toggle-seen enclosed-by-walls-p))
(defun toggle-seen (flags index)
  (declare (type flag-vector flags) (type cell-index index))
  (setf (aref flags index) (logxor (aref flags index) (logior +occupied+ +seen+))))

(defun enclosed-by-walls-p (map x y)
  "True if every line from (X,Y) ends at a wall of MAP."
  (declare (type double-float x y))
  (and (map-enclosed map)
       (<= 1d0 x) (< x (double (1- (map-width map))))
       (<= 1d0 y) (< y (double (1- (map-height map))))))

(defun unmark-seen (flags cells)
  (declare #.*hot* (type flag-vector flags) (type list cells))
  (dolist (index cells)
    (toggle-seen flags index)))

(defun occupied-cells (world x y angle width count reach)
  "Send COUNT rays from (X,Y) in WORLD, spread over WIDTH radians around ANGLE. Return a list of the
cells that rays meet within REACH columns and rows and that hold things on the floor (reading 130)."
  (declare #.*hot* (type world world) (type double-float x y angle width)
           (type (unsigned-byte 15) reach) (type (unsigned-byte 30) count))
  (let* ((flags (world-flags world)) (map (world-map world))
         (columns (map-width map)) (rows (map-height map)) (found '()))
    (flet ((visit (index flag)
             (declare (type cell-index index) (type (unsigned-byte 8) flag))
             (when (logtest flag +occupied+)
               (toggle-seen flags index)
               (push index found))
             (logtest flag +opaque+))
           (corner (dx dy at)
             (declare (type double-float dx dy at))
             (dolist (index (cells-past-corner world (+ x (* dx at)) (+ y (* dy at)) dx dy))
               (when (logtest (aref flags index) +occupied+)
                 (toggle-seen flags index)
                 (push index found)))))
      (declare (inline visit corner))
      (macrolet ((walk (reach)
                   `(walk-fan #'visit #'corner (logior +occupied+ +opaque+) flags columns rows x y
                              angle width count ,reach)))
        (if (and (= reach +no-limit+) (enclosed-by-walls-p map x y))
            (walk nil)
            (walk reach))))
    (unmark-seen flags found)
    (nreverse found)))

(defun place-cells-in-view (world number x y angle width count)
  "Send COUNT rays from (X,Y) in WORLD, spread over WIDTH radians around ANGLE. Return a list of the
cells that the rays meet and whose place type has NUMBER in the map, without closed doors."
  (declare #.*hot* (type world world) (type double-float x y angle width)
           (type (unsigned-byte 30) count) (type (unsigned-byte 8) number))
  (let ((flags (world-flags world)) (places (map-places (world-map world))) (found '()))
    (declare (type flag-vector places))
    (flet ((visit (index flag)
             (declare (type cell-index index) (type (unsigned-byte 8) flag))
             (when (and (= (aref places index) number)
                        (not (logtest flag (logior +seen+ +closed-door+))))
               (toggle-seen flags index)
               (push index found))
             (logtest flag +opaque+)))
      (declare (inline visit))
      (do-rays (dx dy) (angle width count)
        (walk-ray #'visit world x y dx dy)))
    (unmark-seen flags found)
    (nreverse found)))

;;; Which things are in view.

(defun camera-heading (camera)
  "Return the direction in which CAMERA points, in radians, in the world (reading 145)."
  (+ (robot-angle (camera-robot camera)) (camera-angle camera)))

(defun cells-in-view (camera reach)
  "Return a list of the cells where CAMERA may see things: the robot's own cell, then the cells that
rays meet within REACH columns and rows and that hold things."
  (let* ((robot (camera-robot camera)) (own (robot-cell-index robot)))
    (when own
      (cons own (occupied-cells (robot-world robot) (robot-x robot) (robot-y robot)
                                (camera-heading camera) (camera-field-of-view camera)
                                scan-density* reach)))))

(defun in-close-view-p (camera thing)
  "THING is on the floor within reach. True if CAMERA sees THING or is exactly at THING."
  (let ((robot (camera-robot camera)) (x (thing-x thing)) (y (thing-y thing)))
    (or (<= (distance-to robot x y) +contact+)
        (and (<= (abs (angle-difference (bearing-to robot x y) (camera-heading camera)))
                 (* 0.5d0 (camera-field-of-view camera)))
             (in-sight-p (robot-world robot) (robot-x robot) (robot-y robot) x y)))))

(defun cells-around (robot)
  (let ((map (world-map (robot-world robot)))
        (column (floor (robot-x robot))) (row (floor (robot-y robot))))
    (loop for y from (1- row) to (1+ row)
          append (loop for x from (1- column) to (1+ column)
                       for index = (map-index map x y)
                       when index collect index))))

(defun things-in-cells (cells camera local)
  "Return the things in CELLS that are local to the robot if LOCAL, else the others (reading 131).
Bodies of other robots count as things."
  (let* ((robot (camera-robot camera)) (world (robot-world robot)) (things '())
         (own-body (robot-body robot)))
    (dolist (index cells (nreverse things))
      (do-cell-things (thing index world)
        (when (and (not (eq thing own-body))
                   (eq local (within-reach-p robot (thing-x thing) (thing-y thing))))
          (push thing things))))))

(defun things-in-open-view (camera local)
  "Return the things on the floor in CAMERA's view: those within reach if LOCAL, else the others."
  (let* ((cells (cells-in-view camera (if local 1 +no-limit+)))
         (others (and local cells
                      (remove-if (lambda (index) (member index cells))
                                 (cells-around (camera-robot camera))))))
    (append (things-in-cells cells camera local)
            (remove-if-not (lambda (thing) (in-close-view-p camera thing))
                           (things-in-cells others camera t)))))

(defun things-in-view (camera type)
  "Return the things of TYPE, :LOCAL or :NON-LOCAL, that CAMERA has in view (reading 132)."
  (let ((location (camera-location camera)) (local (eq type :local)))
    (append (cond ((null location) (things-in-open-view camera local))
                  (local (location-contents location)))
            (and local (loop for hand across (robot-hands (camera-robot camera))
                             when (eq (hand-location hand) location)
                               append (hand-contents hand))))))

;;; Finding some of them, and others.

(defun false-sighting-count (probability all dice)
  "Return how many false designators a search finds by chance, at most 8 if ALL, else at most 1."
  (loop with probability = (sensing-error-probability probability)
        while (and (< count 8) (chance probability dice))
        count t into count
        while all
        finally (return count)))

(defun all-or-random-one (finds all dice)
  "Return FINDS if ALL, else a list of one random element; () if FINDS is empty (reading 133)."
  (if (or all (null finds)) finds (list (roll-element finds dice))))

(defun matching-things (camera things demands dice)
  "CAMERA has THINGS in its view, but may miss each by chance. Return a list of pairs (thing .
readings) for the things seen whose readings fit DEMANDS (reading 129)."
  (loop with missing = (sensing-error-probability miss-thing-prob*)
        for thing in things
        for distance = (viewing-distance camera thing)
        unless (chance missing dice)
          append (multiple-value-bind (matches readings)
                     (match-thing thing demands distance dice)
                   (and matches (list (cons thing readings))))))

(defun viewing-distance (camera thing)
  (cond ((camera-location camera) 0d0)
        ((eq :floor (thing-location thing))
         (distance-to (camera-robot camera) (thing-x thing) (thing-y thing)))
        (t (multiple-value-call #'distance-to (camera-robot camera) (thing-position thing)))))

(defun thing-sighting (camera type thing readings dice)
  (multiple-value-bind (x y) (thing-position thing)
    (make-sighting type thing x y
                   (describe-thing thing readings (viewing-distance camera thing) dice))))

(defun warn-of-unknown-attributes (specification world)
  "Warn once of each undeclared attribute in SPECIFICATION."
  (loop for (name) in specification
        for key = (attribute-key name)
        unless (declared-attribute key) do (warn-of-unknown-attribute key world)))

(defun look-for-things (camera type specification &key all)
  "Return a list of CAMERA's sightings of things of TYPE that fit SPECIFICATION: all sightings if
ALL, else one. The list may contain false sightings."
  (let* ((world (robot-world (camera-robot camera)))
         (dice (robot-dice (camera-robot camera) :looking))
         (demands (parse-specification specification))
         (finds (matching-things camera (things-in-view camera type) demands dice))
         (phantoms (if (and (camera-location camera) (eq type :non-local))
                       0
                       (false-sighting-count false-thing-prob* all dice))))
    (warn-of-unknown-attributes specification world)
    (loop for find in (all-or-random-one (append finds (make-list phantoms)) all dice)
          collect (if find
                      (thing-sighting camera type (first find) (rest find) dice)
                      (false-sighting camera type (false-description world demands dice) dice)))))

(defun places-in-view (camera type)
  "Return the places of TYPE that CAMERA, in the open, has in view, except the robot's own cell."
  (let* ((robot (camera-robot camera)) (world (robot-world robot)) (map (world-map world))
         (number (place-type-index map type)) (own (robot-cell-index robot)))
    (when (and number own)
      (loop for index in (place-cells-in-view world number (robot-x robot) (robot-y robot)
                                              (camera-heading camera) (camera-field-of-view camera)
                                              scan-density*)
            unless (= index own)
              collect (multiple-value-bind (y x) (floor index (map-width map))
                        (cell-type (map-cell map x y)))))))

(defun look-for-places (camera type &key all (name (place-type-name type)))
  "Return a list of CAMERA's sightings, in the open, of places of the place type TYPE: all sightings
if ALL, else one. The list may contain false sightings. The data of each sighting are NAME, the
symbol by which the caller asked for TYPE (reading 74)."
  (let* ((dice (robot-dice (camera-robot camera) :looking))
         (missing (sensing-error-probability miss-place-prob*))
         (finds (remove-if (lambda (place) (declare (ignore place)) (chance missing dice))
                           (places-in-view camera type)))
         (phantoms (false-sighting-count (place-type-confusion type) all dice)))
    (loop for place in (all-or-random-one (append finds (make-list phantoms)) all dice)
          collect (if place
                      (let ((cell (place-cell place)))
                        (make-sighting :non-local place
                                       (+ 0.5d0 (cell-x cell)) (+ 0.5d0 (cell-y cell))
                                       (list name)))
                      (false-sighting camera :non-local (list name) dice)))))

;;; Each pixel is the parameter of the surface that its ray meets: a wall, the largest thing that
;;; obstructs vision in the first cell that has one, or 0 at the edge of the map. Things on the way
;;; that have a substance but do not obstruct vision corrupt it: the pixel is the mean of them all.
;;; Things in the robot's own cell do not count. From inside a container, only that is seen.

(defun obstructing-thing (index world)
  "Return the largest thing in the cell INDEX that obstructs vision, or NIL (reading 240)."
  (let ((best nil))
    (do-cell-things (thing index world)
      (when (and (thing-obsview-p thing)
                 (or (null best) (> (thing-size thing) (thing-size best))))
        (setf best thing)))
    best))

(defun true-pixel (world x y dx dy)
  "Return the noiseless substance parameter that a ray from (X,Y) along DX, DY sees (reading 65)."
  (let ((sum 0d0) (count 1) (last 0d0))
    (flet ((visit (index flag)
             (cond ((zerop flag) nil)
                   ((logtest flag +wall+)
                    (setf last (aref (map-parameters (world-map world)) index)))
                   ((logtest flag +obsview+)
                    (setf last (thing-substance-parameter
                                (obstructing-thing index world))))
                   (t (do-cell-things (thing index world)
                        (when (thing-substance-p thing)
                          (incf sum (thing-substance-parameter thing))
                          (incf count)))
                      nil))))
      (walk-ray #'visit world x y dx dy))
    (/ (+ sum last) count)))

(defun noisy-pixel (value map dice)
  "Return a noisy reading of VALUE, a true pixel: uniformly distributed within PIXEL-ERROR-RANGE* of
VALUE, or occasionally within the range of the wall parameters of MAP (reading 147)."
  (cond (no-sensor-error* value)
        ((chance pixel-outlier-prob* dice)
         (roll-between (map-least-parameter map) (map-greatest-parameter map) dice))
        (t (+ value (roll-within (double pixel-error-range*) dice)))))

(defun view-in-open (camera)
  (let* ((robot (camera-robot camera)) (world (robot-world robot)) (pixels '()))
    (do-rays (dx dy) ((camera-heading camera)
                      (camera-field-of-view camera)
                      (camera-resolution camera))
      (push (true-pixel world (robot-x robot) (robot-y robot) dx dy) pixels))
    (nreverse pixels)))

;; See reading 148.
(defun view-in-container (camera)
  (let ((location (camera-location camera)))
    (make-list (camera-resolution camera)
               :initial-element (if (thing-p location)
                                    (thing-substance-parameter location)
                                    0d0))))

(defun take-view (camera)
  "Take a view with CAMERA: return a list of one number for each pixel, from left to right, and
store it as CAMERA-LAST-VIEW (manual 3.4.3)."
  (let* ((world (robot-world (camera-robot camera)))
         (map (world-map world)) (dice (robot-dice (camera-robot camera) :looking)))
    (setf (camera-last-view-tick camera) (world-tick world)
          (camera-last-view camera)
          (loop for value in
                (if (camera-location camera) (view-in-container camera) (view-in-open camera))
                collect (noisy-pixel value map dice)))))
