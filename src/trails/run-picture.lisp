;;;; run-picture.lisp -- one run as a picture: the ways of its robots and its events.

(in-package :ars-magna.trails)

;;; A run picture is a picture of the end of a run, with the ways of its robots and numbered places.
;;; Notes below the map say what happened there: see spots.lisp.

(defconstant +note-size+ 12 "The height of the font of notes, in pixels.")
(defconstant +note-step+ 16 "The distance between lines of notes, in pixels.")

(defun robot-of-moment (moment simulation)
  "Return the robot in SIMULATION that MOMENT names. If MOMENT names no robot, return the only robot
of SIMULATION, or NIL if there are several."
  (let ((robots (simulation-robots simulation)))
    (if (moment-robot moment)
        (find-robot-named (moment-robot moment) robots)
        (and (null (rest robots)) (first robots)))))

(defun moment-with-position (moment simulation)
  "Return MOMENT, which is at the current tick. If MOMENT has no position, return a copy with the
position of its robot, if the robot is known."
  (let ((robot (robot-of-moment moment simulation)))
    (if (or (moment-x moment) (null robot))
        moment
        (make-moment (moment-tick moment) (moment-kind moment) (moment-text moment)
                     (robot-x robot) (robot-y robot) (robot-name robot)))))

(defun check-moment-robots (moments simulation)
  "Signal WRONG-ARGUMENT of SAVE-RUN-PICTURE unless each name in MOMENTS means one robot in
SIMULATION."
  (let ((robots (simulation-robots simulation)))
    (dolist (moment moments)
      (when (and (moment-robot moment)
                 (/= 1 (length (robots-meant (moment-robot moment) robots))))
        (reject-argument 'save-run-picture :moments (moment-robot moment)
                         (format nil "names of robots of the run, if any: ~{~(~A~)~^, ~}"
                                 (mapcar #'robot-label robots)))))))

(defun replay-for-picture (journal until own measures)
  "Replay JOURNAL up to the tick UNTIL. Return five values: a snapshot of the end; for each robot, a
list of its name and the pieces of its way; the moments found; the user's moments OWN with their
positions; and a text of the values of MEASURES at the end, or NIL. Signals WRONG-ARGUMENT if OWN
names robots that are not in the run."
  (let ((trails '()) (placed '()))
    (multiple-value-bind (watch seen) (make-moments-watcher)
      (flet ((look (simulation)
               (setf trails (update-trails simulation trails))
               (funcall watch simulation)
               (dolist (moment own)
                 (when (= (moment-tick moment) (simulation-tick simulation))
                   (push (moment-with-position moment simulation) placed)))))
        (call-with-replay
         (lambda ()
           (check-moment-robots own (current-simulation))
           (values (take-snapshot (simulation-world (current-simulation)))
                   (loop for trail in (reverse (update-trails (current-simulation) trails))
                         collect (cons (robot-name (trail-robot trail))
                                       (trail-pieces-in-order trail)))
                   (append (funcall seen) (moments-in-remarks journal until))
                   (reverse placed)
                   (text-of-measures 'save-run-picture measures)))
         journal :until until :observer #'look :beginning #'look)))))

;;; Ways.

(defun way-moved-p (way)
  "True if WAY, a list of a robot's name and pieces, has more than one point or piece."
  (and (or (cddr way) (rest (second way))) t))

(defun draw-robot-ways (canvas ways)
  "Draw WAYS, lists of a robot's name and the pieces of its way, in the order of the robots."
  (let* ((moved (loop for way in ways for position from 0
                      when (way-moved-p way)
                        collect (cons position (pieces-in-pixels (rest way))))))
    (draw-way-lines canvas (loop for (position . pieces) in moved
                                 collect (make-way-line position pieces)))
    (draw-way-marks canvas (loop for (position (x y)) in moved
                                 collect (list 'draw-way-start x y (nth-ink position))))))

(defconstant +tile-size+ 6 "The side of the boxes that cover a line, in pixels.")

(defun boxes-along (points)
  "Return a list of boxes that together cover the line through POINTS, x y ... in pixels."
  (let ((tiles (make-hash-table :test #'equal)))
    (loop for (x y next-x next-y) on points by #'cddr
          while next-y
          do (loop for (x y) in (points-along x y next-x next-y (/ +tile-size+ 2))
                   do (setf (gethash (cons (floor x +tile-size+) (floor y +tile-size+)) tiles) t)))
    (loop for (column . row) being the hash-keys of tiles
          collect (list (* +tile-size+ column) (* +tile-size+ row)
                        (* +tile-size+ (1+ column)) (* +tile-size+ (1+ row))))))

(defun moved-robot-entry (name position)
  "Return an entry of the legend for the robot NAME and its way. POSITION is the position of the
robot in the list of robots of its world."
  (named-entry-with-sample (canvas x y) (name " and its way" 54)
    (draw-ring canvas (- x 18) y 6 0 position)
    (draw-way-sample canvas (list (- x 10) y (+ x 26) y) (nth-ink position) position)))

(defun robot-entries-with-ways (snapshot ways)
  "Return legend entries for the robots that are visible in SNAPSHOT or whose WAYS are visible."
  (loop with box = (points-to-pixels (shown-part snapshot))
        for way in ways
        for position from 0
        for title = (drawn-name (name-label (first way) (mapcar #'first ways)))
        if (and (way-moved-p way) (way-visible-p (pieces-in-pixels (rest way)) box))
          collect (moved-robot-entry title position)
        else if (find (first way) (snapshot-robots snapshot) :key #'robot-image-name)
               collect (robot-entry title position)))

(defun way-start-visible-p (way snapshot)
  "True if the ring at the start of WAY is visible in the part of the map that SNAPSHOT shows."
  (and (way-moved-p way)
       (destructuring-bind (x . y) (first (second way))
         (way-visible-p (list (points-to-pixels (list x y)))
                        (points-to-pixels (shown-part snapshot))))))

(defun run-legend-entries (snapshot ways spots)
  "Return the entries of the legend for WAYS and SPOTS of a run. SNAPSHOT shows the end of the run."
  (append (robot-entries-with-ways snapshot ways)
          (when (some (lambda (way) (way-start-visible-p way snapshot)) ways)
            (list (entry-with-sample (canvas x y) "start of a way"
                    (draw-way-start canvas x y black*))))
          (jump-entries (loop for (nil . pieces) in ways collect (pieces-in-pixels pieces))
                        snapshot black*)
          (and spots (list (entry-with-sample (canvas x y) "see below"
                             (draw-number canvas x y "1"))))))

;;; The whole.

(defun draw-run (canvas snapshot ways spots layers)
  (draw-terrain canvas (snapshot-map snapshot) :layers layers)
  (draw-robot-ways canvas ways)
  (draw-movers canvas snapshot (layers-without-names layers))
  (let* ((along (loop for (nil . pieces) in ways
                      append (mapcan #'boxes-along (pieces-in-pixels pieces))))
         (boxes (draw-spots canvas snapshot spots along)))
    (when (names-shown-p layers) (draw-names canvas snapshot layers (append boxes along)))))

(defun draw-notes (canvas notes left y width)
  "Write NOTES below each other from Y on, at most WIDTH pixels wide. Each note is a list: a number
or NIL, and a text. Return the Y below the last note."
  (let ((most (max 20 (floor (- width 24) (character-width canvas +note-size+)))))
    (loop for (number text) in notes
          do (when number
               (draw-words canvas draw-gcontext* (+ left 16) y (princ-to-string number)
                           :size +note-size+ :anchor :end))
             (dolist (line (wrapped-text text most))
               (draw-words canvas draw-gcontext* (+ left 24) y line :size +note-size+)
               (incf y +note-step+)))
    y))

(defun moments-in-part (part moments)
  "Return two lists: the MOMENTS in PART (left top right bottom) of the map or without a position;
and the other MOMENTS. If PART is NIL, return MOMENTS."
  (flet ((elsewhere-p (moment)
           (destructuring-bind (left top right bottom) part
             (and (moment-x moment)
                  (not (and (<= left (moment-x moment) right)
                            (<= top (moment-y moment) bottom)))))))
    (if part
        (values (remove-if #'elsewhere-p moments) (remove-if-not #'elsewhere-p moments))
        moments)))

(defun spots-and-notes-in (part moments limit robots reach)
  "Return the values of SPOTS-AND-NOTES for the MOMENTS in PART; a last note counts the others."
  (multiple-value-bind (moments others) (moments-in-part part moments)
    (multiple-value-bind (spots notes) (spots-and-notes moments limit robots reach)
      (values spots
              (append notes (not-shown-note "Not shown, outside of this part" others))))))

(defun run-picture-svg (snapshot ways moments &key limit title subtitle layers in-color scale)
  (multiple-value-bind (spots notes)
      (spots-and-notes-in (snapshot-part snapshot) (abridge-failures moments) limit
                          (mapcar #'first ways)
                          ;; Rings nearer than this would look like one.
                          (/ (* 2 +ring-radius+) (drawn-scale scale snapshot layers)))
    (let ((more (run-legend-entries snapshot ways spots)))
      (with-output-to-string (out)
        (with-map-svg (canvas out snapshot :layers layers :in-color in-color :scale scale)
          (multiple-value-bind (width height left)
              (draw-framed canvas snapshot layers
                           (lambda () (draw-run canvas snapshot ways spots layers))
                           :title title :subtitle subtitle :more more :legend '(:robots ()))
            (let ((width (max width 480)))
              (values width
                      (draw-notes canvas notes (max 8 left) (+ height 16)
                                  (- width left 16))))))))))

(defun check-run-picture-arguments (journal moments until &key kinds limit title layers scale)
  "Check the arguments of SAVE-RUN-PICTURE. Return MOMENTS as moments. Signals WRONG-ARGUMENT."
  (check-argument save-run-picture limit (or (null limit) (whole-p limit 0 1000000))
                  "the largest number of lines below the map, a whole number, or NIL for all")
  (check-moment-kinds 'save-run-picture kinds)
  (check-map-options 'save-run-picture :title title :layers layers :scale scale)
  (checked-moments 'save-run-picture moments
                   (checked-end-tick 'save-run-picture journal until)))

(defun subtitle-text (&rest texts)
  "Return TEXTS that are not NIL as lines of one text, or NIL if there are none."
  (let ((texts (remove nil texts)))
    (and texts (format nil "~{~A~^~%~}" texts))))

(addition save-run-picture)
(define-with-keywords save-run-picture
    (file &key journal until moments (kinds t) (limit 24) part title measures
               (layers (remove :tracks *picture-layers*)) (in-color t) scale anyway)
  "Save a picture of a run in FILE, which is replaced: the world at the end, the ways of its robots,
and numbers that refer to events listed below the map. Return the file's truename. JOURNAL is a
journal or a file with a journal, by default the journal of the current simulation; UNTIL is the
last tick, by default the end of JOURNAL.

The picture shows these events: a robot grasps, releases or stows a thing; a command fails; a plan
or a part of a plan fails or is ended; an error occurs in your code. KINDS is a list of the kinds of
events to show, from :GRASP, :RELEASE, :STOW, :FAILURE, :MESSAGE that arrived, :PLAN, :PART, :ERROR
and :NOTE; by default all except :MESSAGE. MOMENTS are events of your own, which are always shown:
moments, or lists of a tick, a string and, optionally, the name of a robot of the run.

LIMIT is the largest number of lines below the map, but your own events are always listed. If LIMIT
is NIL, all events are listed with all ticks. Events that do not fit are left out and counted, the
least important first: blocked robots and lost tracks, which plans expect; then other failures of
commands and of parts of plans.

PART (left top right bottom), in cells, is the part of the map to show, by default the whole map.
TITLE is printed above the picture, and below it the values of MEASURES, a list of names of measures
(see DEFMEASURE), at the end. If ANYWAY is true, definitions may have changed since the run,
but then the picture may differ from the original run. FILE and the other arguments are those of
SAVE-PICTURE. Signals WRONG-ARGUMENT, the errors of REPLAY, and MISUSE without the program that PNG
needs or if there is no journal."
  (let* ((kind (picture-kind 'save-run-picture file))
         (journal (resolve-journal journal 'save-run-picture))
         (own (check-run-picture-arguments journal moments until
                                           :kinds kinds :limit limit :title title
                                                       :layers layers :scale scale)))
    (multiple-value-bind (snapshot ways seen own values)
        (replaying (anyway) (replay-for-picture journal until own measures))
      (save-svg (with-broken-graphics-reported
                  (run-picture-svg (snapshot-of-part snapshot part 'save-run-picture) ways
                                    (sort-moments (append (moments-of-kinds kinds seen) own))
                                    :limit limit :title title :layers layers
                                    :subtitle (subtitle-text
                                               values
                                               (and anyway (changed-definitions-sentence journal)))
                                    :in-color in-color :scale scale))
                file kind))))
