;;;; trails.lisp -- where robots went, tick by tick: as ways to draw, and as a table.

(in-package :ars-magna.trails)

(export '(note-places ways-along straightened))

(define-record (way (:constructor make-way (trial outcome pieces)))
  "The way of a robot in a trial."
  (trial 0 integer "the number of the trial of the way" :export)
  (outcome "" string "its outcome: \"success\", \"failure\", \"limit\" or \"error\"" :export)
  (pieces '() list "the pieces of the way, lists of points (x . y), in order" :export))

(define-record (trail (:constructor make-trail (robot)))
  "The places of ROBOT so far."
  (robot nil robot)
  (placements nil (or null fixnum)
              "how often it had been put somewhere at the last place, or NIL" :writable)
  (pieces '() list "pieces like those of a way, latest first, as are their points" :writable))

(defun note-point (trail x y)
  "Extend the last piece of TRAIL to X, Y."
  (unless (equal (cons x y) (first (first (trail-pieces trail))))
    (push (cons x y) (first (trail-pieces trail)))))

(defun note-placement (trail)
  "Begin a new piece of TRAIL where its robot has been put. It may have driven on since."
  (let ((robot (trail-robot trail)) (begun-p (trail-placements trail)))
    (setf (trail-placements trail) (robot-placements robot))
    (push '() (trail-pieces trail))
    (when begun-p (note-point trail (robot-put-x robot) (robot-put-y robot)))))

(defun note-place (trail)
  (let ((robot (trail-robot trail)))
    (unless (eql (trail-placements trail) (robot-placements robot)) (note-placement trail))
    (note-point trail (robot-x robot) (robot-y robot))))

(defun note-places (simulation trails)
  "Add the places of the robots of SIMULATION to TRAILS, a list, latest first. Return the list."
  (dolist (robot (simulation-robots simulation) trails)
    (note-place (or (find robot trails :key #'trail-robot)
                    (first (push (make-trail robot) trails))))))

(defun pieces-along (trail)
  (reverse (mapcar #'reverse (trail-pieces trail))))

(defun ways-along (trails trial outcome)
  "Return the ways of TRAILS, a value of NOTE-PLACES, in TRIAL, which ended with OUTCOME. A trial
without trails, which failed at once, has one way without points, so that it is counted."
  (if trails
      (loop for trail in (reverse trails) collect (make-way trial outcome (pieces-along trail)))
      (list (make-way trial outcome '()))))

;;; A way has a point for each tick. Nearly straight parts need only their ends.

(defun distance-from-line (point start end)
  "Return the distance of POINT from the line from START to END, or from START if both are equal."
  (destructuring-bind ((x . y) (x1 . y1) (x2 . y2)) (list point start end)
    (let* ((dx (- x2 x1)) (dy (- y2 y1)) (square (+ (* dx dx) (* dy dy)))
           (share (if (zerop square)
                      0
                      (clamp (/ (+ (* dx (- x x1)) (* dy (- y y1))) square) 0 1))))
      (sqrt (+ (expt (- x x1 (* share dx)) 2) (expt (- y y1 (* share dy)) 2))))))

(defun straightened (points tolerance)
  "Return some of POINTS, a list, such that all others are at most TOLERANCE from the line through
them (Douglas and Peucker 1973)."
  (let ((points (coerce points 'simple-vector)) (kept '()))
    (labels ((visit (start end)
               (let ((place nil) (most tolerance))
                 (loop for i from (1+ start) below end
                       for off = (distance-from-line (svref points i) (svref points start)
                                                     (svref points end))
                       when (> off most) do (setf place i most off))
                 (when place
                   (visit start place)
                   (push (svref points place) kept)
                   (visit place end)))))
      (if (< (length points) 3)
          (coerce points 'list)
          (let ((last (1- (length points))))
            (visit 0 last)
            (append (list (svref points 0)) (nreverse kept) (list (svref points last))))))))

(defun pieces-in-pixels (pieces)
  "Return PIECES of a way as lists x y ... in pixels, simplified for drawing."
  (loop for piece in pieces
        collect (loop for (x . y) in (straightened piece (/ 1/2 graphics-scale*))
                      collect (to-pixels x) collect (to-pixels y))))

;;;; A run as a table

;;; The run is replayed from its journal. So a table can be made of any run with a journal, also
;;; afterwards, and nothing is recorded during the run.

(defparameter *trajectory-columns*
  '("tick" "robot" "x" "y" "angle" "estimated_x" "estimated_y" "estimated_angle" "holding" "place")
  "The columns of a trajectory.")

(note-kind-of-file :trajectory (format nil "~{~A,~}" (subseq *trajectory-columns* 0 5))
                   "it is a table of where robots were; any program that reads CSV reads it")

(defun full-number-text (number)
  "Return NUMBER in full precision, as text that any program can read."
  (let ((*read-default-float-format* 'double-float)) (princ-to-string number)))

(defun trajectory-row (robot tick)
  (printing-plainly ()
    (append (list (full-number-text tick) (string-downcase (robot-name robot)))
            (mapcar #'full-number-text
                    (list* (robot-x robot) (robot-y robot) (robot-angle robot)
                           (multiple-value-list (odometer-estimate (robot-main-odometer robot)))))
            (list (format nil "~{~A~^ ~}" (loop for hand across (robot-hands robot)
                                                when (hand-holding hand) collect it))
                  (format nil "~@[~(~A~)~]" (robot-last-place robot))))))

(defun write-rows (simulation names out)
  "Write a row for each robot of SIMULATION to OUT; only for those in the list NAMES unless it is
NIL."
  (dolist (robot (simulation-robots simulation))
    (when (or (null names) (member (robot-name robot) names :test #'same-name-p))
      (write-string (csv-line (trajectory-row robot (simulation-tick simulation))) out))))

(defun write-trajectory (journal out every until names)
  "Replay JOURNAL up to UNTIL and write rows to OUT every EVERY ticks."
  (write-string (csv-line *trajectory-columns*) out)
  (flet ((look (simulation)
           (when (zerop (mod (simulation-tick simulation) every))
             (write-rows simulation names out))))
    (call-with-replay (constantly nil) journal :until until :observer #'look :beginning #'look)))

(defun check-trajectory (file every until robots journal)
  (check-argument save-trajectory file
                  (and (typep file '(or string pathname)) (not (many-files-p file))
                       (pathname-name file))
                  "the name of a file, such as \"run.csv\"; before each * ? and [ in it write \\\\")
  (check-argument save-trajectory every (whole-p every 1)
                  "a whole number of ticks, from 1 to 1e9")
  (checked-end-tick 'save-trajectory journal until)
  (let ((known (mapcar (lambda (robot) (blueprint-name (find-blueprint robot)))
                       (getf (journal-header journal) :robots))))
    (dolist (name robots)
      (unless (member name known :test #'same-name-p)
        (reject-name "robot of that run" name known)))))

(addition save-trajectory)
(define-with-keywords save-trajectory
    (file &key journal (every 1) until robots anyway)
  "Replay a run and write the places of its robots to FILE, a CSV table. Return the truename.
JOURNAL is a journal or a file with one, by default that of the current simulation so far. There is
a row every EVERY ticks, up to the tick UNTIL, for each robot, or only for those of ROBOTS, a name
or a list of names. It has the tick, the robot, x and y in metres and the heading in radians; the
same three as its main odometer estimates them, in coordinates of the map; what its hands hold; and
the place type that it sensed last. ANYWAY accepts a run whose definitions are not the present ones.

FILE may be new, empty, or another such table, which is replaced. Signals WRONG-ARGUMENT,
UNKNOWN-NAME, and what REPLAY does; and MISUSE if there is no journal, or if FILE is something else
or cannot be written, and then FILE is unchanged."
  (let ((journal (resolve-journal journal 'save-trajectory)) (robots (ensure-list robots)))
    (check-trajectory file every until robots journal)
    (check-not-foreign file :trajectory "trajectory")
    (let ((text (with-output-to-string (out)
                  (replaying (anyway)
                    (write-trajectory journal out every until robots)))))
      (write-file-anew (lambda (out) (write-string text out)) file "the trajectory"
                       :kind :trajectory))))
