;;;; live-view.lisp -- names that hold still from one picture of a window to the next.

(in-package :ars-magna.display)

(export '(live-view make-live-view))

;;; The places of names of things at rest depend only on things at rest, the map, the scale and the
;;; layers. A name keeps its place until another thing at rest, or a mark that stays, takes this
;;; place. Robots and moving things do not move these names, and are drawn above them. Names of
;;; robots and moving things are placed for each picture, and keep their place beside their owner
;;; while it is free. They may cover names of things at rest.

(defconstant +ticks-to-rest+ 100
  "A thing, robot or mark is at rest after this number of ticks without a move.")
(defconstant +resting-mark-tolerance+ 3
  "A mark that moves by less than this number of pixels is at rest.")

(define-record (live-view (:constructor make-live-view ()
                              "Return a new live view, in which no name has a place yet."))
  "A live view: what the successive pictures of a world in a window have in common."
  (robot nil t "the name of the robot that is drawn as a disc, or NIL. Can be set"
         :writable :export)
  (pointed nil t "the thing, or the name of the robot, that the mouse points at, or NIL. Its name is
written whatever layers are shown. Can be set" :writable :export)
  (snapshot nil t "the snapshot of the last picture" :writable)
  (moves (make-hash-table :test 'eq :weakness :key) hash-table
         "the ticks at which things and robots moved last, by owner")
  (marks '() list "pairs (box . tick) of the marks in the last picture, since when they are there"
         :writable)
  (basis '() list "what the names of things at rest were placed for" :writable)
  (names '() list "the names of things at rest" :writable)
  (bodies (make-box-index) box-index "an index of the boxes of things at rest" :writable)
  (targets (make-box-index) box-index "an index of the label targets of things at rest" :writable)
  (covered (make-box-index) box-index "an index of the names of things at rest" :writable)
  (places (make-hash-table :test 'eq :weakness :key) hash-table
          "the placed names of the last picture, by owner"))

(defun label-target-owner (target)
  "Return the thing, or the name of the robot, of TARGET."
  (let ((robot (label-target-robot target)))
    (if robot (robot-image-name robot) (thing-image-thing (label-target-thing target)))))

(defun longest-live-trail (map)
  "Return the length of the longest trail that a window shows in MAP, in metres."
  (+ (map-width map) (map-height map)))

;;; What moves.

(defun owners-with-places (snapshot)
  "Return lists (owner x y) for the things and robots of SNAPSHOT."
  (append (loop for robot in (snapshot-robots snapshot)
                collect (list (robot-image-name robot) (robot-image-x robot)
                              (robot-image-y robot)))
          (loop for image across (snapshot-things snapshot)
                collect (list (thing-image-thing image) (thing-image-x image)
                              (thing-image-y image)))))

(defun record-moves-between (old new moves)
  "Record in the table MOVES what has moved between the snapshots OLD and NEW."
  (let ((before (make-hash-table :test 'eq)))
    (loop for (owner . place) in (owners-with-places old) do (setf (gethash owner before) place))
    (loop for (owner . place) in (owners-with-places new)
          for old-place = (gethash owner before)
          when (and old-place (not (equal place old-place)))
            do (setf (gethash owner moves) (snapshot-tick new)))))

(defun record-moves (view snapshot)
  "Record in VIEW what has moved since its last picture. SNAPSHOT is that of the next picture. After
a rewind, or in another map, nothing has moved."
  (let ((old (shiftf (live-view-snapshot view) snapshot)) (moves (live-view-moves view)))
    (cond ((eq old snapshot))
          ((and old
                (eq (snapshot-map old) (snapshot-map snapshot))
                (<= (snapshot-tick old) (snapshot-tick snapshot)))
           (record-moves-between old snapshot moves))
          (t (clrhash moves)))))

(defun moved-lately-p (view owner)
  (let ((tick (gethash owner (live-view-moves view))))
    (and tick (< (- (snapshot-tick (live-view-snapshot view)) tick) +ticks-to-rest+))))

(defun moving-image-p (view image)
  "True if the thing of IMAGE moves: it has moved lately, or it has kickers and has ever moved. So a
sheet of paper that is blown about now and then moves no names."
  (let ((thing (thing-image-thing image)))
    (and (gethash thing (live-view-moves view))
         (or (thing-image-moving-p image) (moved-lately-p view thing)))))

(defun images-by-motion (view snapshot)
  "Return two values, lists of images: the things of SNAPSHOT at rest, and those that move."
  (loop for image across (snapshot-things snapshot)
        if (moving-image-p view image) collect image into moving
        else collect image into resting
        finally (return (values resting moving))))

;;; Marks at rest.

(defun mark-at-rest-p (box other)
  (loop for old in box for new in other
        always (< (abs (- old new)) +resting-mark-tolerance+)))

(defun record-marks (view boxes tick new-p)
  "Record in VIEW that its picture at TICK has marks in BOXES. If NEW-P, all of them are at rest."
  (setf (live-view-marks view)
        (loop for box in boxes
              for old = (find-if (lambda (entry)
                                   (and (<= (cdr entry) tick) (mark-at-rest-p (car entry) box)))
                                 (live-view-marks view))
              collect (cond (new-p (cons box (- tick +ticks-to-rest+)))
                            (old old)
                            (t (cons box tick))))))

(defun marks-at-rest (view tick)
  (loop for (box . since) in (live-view-marks view)
        when (<= +ticks-to-rest+ (- tick since)) collect box))

;;; Keeping places.

(defun kept-box (old target)
  "Return the box of OLD, a placed name, moved as far as its owner, which is now TARGET. Return NIL
if TARGET has another name."
  (let ((before (placed-name-target old)))
    (when (string= (label-target-name before) (label-target-name target))
      (let ((dx (- (label-target-x target) (label-target-x before)))
            (dy (- (label-target-y target) (label-target-y before))))
        (destructuring-bind (left top right bottom) (placed-name-box old)
          (list (+ left dx) (+ top dy) (+ right dx) (+ bottom dy)))))))

(defun keep-name (view placement target &optional (test (constantly t)))
  "Return the name of TARGET in its old place in PLACEMENT, or NIL if the place is not free or the
function TEST returns false for its box. The room is taken then."
  (let* ((old (gethash (label-target-owner target) (live-view-places view)))
         (box (and old (kept-box old target))))
    (when (and box (best-placed-box placement target (list box) test t))
      (reserve-name-box placement box)
      (make-placed-name target box (placed-name-led-p old)))))

(defun record-place (view name)
  (setf (gethash (label-target-owner (placed-name-target name)) (live-view-places view)) name))

;;; Names of things at rest.

(defun at-old-place-p (view target)
  "True if the owner of TARGET is where it was when its name was placed last."
  (let ((old (gethash (label-target-owner target) (live-view-places view))))
    (and old
         (= (label-target-x target) (label-target-x (placed-name-target old)))
         (= (label-target-y target) (label-target-y (placed-name-target old))))))

(defun names-at-rest (view placement targets per-character)
  "Return names for TARGETS in PLACEMENT. Names whose owners have stayed are placed first."
  (let ((kept (loop for target in targets
                    for name = (and (at-old-place-p view target)
                                    (keep-name view placement target))
                    when name collect name)))
    (append kept
            (loop with done = (mapcar #'placed-name-target kept)
                  for target in targets
                  for name = (and (not (member target done))
                                  (or (keep-name view placement target)
                                      (place-name placement target per-character)))
                  when name collect name))))

(defun place-names-at-rest (view snapshot layers images marks per-character)
  "Place the names of IMAGES, the things of SNAPSHOT at rest. MARKS are the boxes of marks at rest."
  (let* ((targets (label-targets-by-size images))
         (boxes (widened-target-boxes targets)) (bodies (index-boxes boxes))
         (index (index-boxes (mapcar #'label-target-box targets) targets))
         (placement (make-placement snapshot (remove :trail layers)
                                    (index-boxes marks marks bodies) (index-boxes marks) index '()))
         (names (names-at-rest view placement (named-targets targets layers) per-character)))
    (setf (live-view-bodies view) bodies
          (live-view-targets view) index
          (live-view-names view) names
          (live-view-covered view) (index-boxes (mapcar #'placed-name-box names)))
    (dolist (name names) (record-place view name))))

(defun names-basis (snapshot layers)
  "Return a list of what the places of names depend on besides things and marks."
  (list (snapshot-map snapshot) (map-places (snapshot-map snapshot)) (shown-part snapshot)
        graphics-scale* in-color*
        (remove-if-not (lambda (layer) (member layer layers)) '(:names :mover-names :places))))

(defun update-names-at-rest (view snapshot layers images marks per-character)
  "Place the names of IMAGES, the things of SNAPSHOT at rest, unless all that they depend on is
unchanged. MARKS are the boxes of all marks in the picture."
  (let* ((basis (names-basis snapshot layers)) (tick (snapshot-tick snapshot))
         (new-p (not (equal basis (first (live-view-basis view))))))
    (when new-p (clrhash (live-view-places view)))
    (record-marks view marks tick new-p)
    (let ((all (list basis images (marks-at-rest view tick))))
      (unless (equal all (live-view-basis view))
        (setf (live-view-basis view) all)
        (place-names-at-rest view snapshot layers images (third all) per-character)))))

;;; Names of robots and moving things.

(defun placement-above-names (view snapshot layers targets marks)
  "Return the placement for the names of TARGETS, which move."
  (let ((boxes (append marks
                       (camera-line-boxes (snapshot-robots snapshot) (live-view-robot view))
                       (widened-target-boxes targets))))
    (make-placement snapshot (remove :trail layers)
                    (index-boxes boxes boxes (live-view-bodies view)) (index-boxes marks)
                    (index-boxes (mapcar #'label-target-box targets) targets
                                 (live-view-targets view))
                    (remove nil targets :key #'label-target-robot)
                    (live-view-covered view))))

(defun place-moving-name (view placement target per-character)
  "Return the name of TARGET, which moves, in PLACEMENT: in its old place if this is free and, when
TARGET has stopped, clear. Return NIL if there is no room. Only names of robots and of what has
moved lately cover other names."
  (let ((moving-p (moved-lately-p view (label-target-owner target)))
        (width (name-width target per-character)))
    (flet ((on-name-p (box) (find-overlapping-item box (placement-covered placement))))
      (or (keep-name view placement target
                     (lambda (box)
                       (or moving-p
                           (and (not (on-name-p box))
                                (unambiguous-in-placement-p placement target box width)))))
          (place-name placement target per-character
                      (lambda (box)
                        (or moving-p (label-target-robot target) (not (on-name-p box)))))
          (and moving-p (keep-name view placement target))))))

(defun pointed-target (view snapshot)
  "Return a label target for the thing or robot of SNAPSHOT that the mouse points at, or NIL."
  (let* ((owner (live-view-pointed view))
         (robot (find owner (snapshot-robots snapshot) :key #'robot-image-name))
         (thing (find owner (snapshot-things snapshot) :key #'thing-image-thing)))
    (cond ((null owner) nil)
          (robot (robot-label-target robot (snapshot-robots snapshot) (live-view-robot view)))
          (thing (thing-label-target thing 0)))))

(defun pointed-name (view placement names per-character)
  "Return a list of the name of what the mouse points at, unless NAMES have it. Without room, the
name covers others."
  (let ((target (pointed-target view (placement-snapshot placement))))
    (unless (or (null target)
                (find (label-target-owner target) names
                      :key (lambda (name) (label-target-owner (placed-name-target name)))))
      (list (or (place-name placement target per-character)
                (make-placed-name target
                                  (first (candidate-name-boxes
                                          (label-target-x target) (label-target-y target)
                                          (label-target-half target)
                                          (name-width target per-character)))
                                  nil))))))

(defun place-names-above (view snapshot layers images marks per-character)
  "Return the names of robots and of IMAGES, moving things, and of what the mouse points at."
  (let* ((targets (append (robot-label-targets (snapshot-robots snapshot) (live-view-robot view))
                          (label-targets-by-size images)))
         (placement (placement-above-names view snapshot layers targets marks))
         (names (loop for target in (named-targets targets layers)
                      for name = (place-moving-name view placement target per-character)
                      when name collect name)))
    (dolist (name names) (record-place view name))
    (append names (pointed-name view placement (append names (live-view-names view))
                                per-character))))

(defun place-names (view canvas snapshot layers)
  "Return two values, lists of placed names for a picture of SNAPSHOT on CANVAS with LAYERS: names
of things at rest, and the names above them."
  (record-moves view snapshot)
  (let ((per-character (character-width canvas +name-size+))
        (marks (layer-mark-boxes snapshot layers)))
    (multiple-value-bind (resting moving) (images-by-motion view snapshot)
      (update-names-at-rest view snapshot layers resting
                            (layer-mark-boxes snapshot (remove :planned-way layers))
                            per-character)
      (values (live-view-names view)
              (place-names-above view snapshot layers moving marks per-character)))))
