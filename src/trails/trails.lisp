;;;; trails.lisp -- where robots went, tick by tick: as ways to draw, and as a table.

(in-package :ars-magna.trails)

(export '(update-trails trails-to-ways simplify-line))

(define-record (way (:constructor make-way (trial outcome pieces)))
  "The way that a robot went in a trial."
  (trial 0 integer "the number of the trial of the way" :export)
  (outcome "" string "the outcome of the trial: \"success\", \"failure\", \"limit\" or
\"error\"" :export)
  (pieces '() list "the way's pieces, in order: lists of points (x . y) without jumps" :export))

(define-record (trail (:constructor make-trail (robot)))
  "The positions of ROBOT from the beginning of a run up to now."
  (robot nil robot)
  (placements nil (or null fixnum)
              "the count of the robot's placements at its last recorded position, or NIL" :writable)
  (pieces '() list "the pieces, like those of a way, but the latest piece first and in each piece
the latest point first" :writable))

(defun extend-trail (trail x y)
  (unless (equal (cons x y) (first (first (trail-pieces trail))))
    (push (cons x y) (first (trail-pieces trail)))))

(defun begin-trail-piece (trail)
  "Begin a new piece of TRAIL where its robot was put. Since then the robot may have moved."
  (let ((robot (trail-robot trail)) (begun-p (trail-placements trail)))
    (setf (trail-placements trail) (robot-placements robot))
    (push '() (trail-pieces trail))
    (when begun-p (extend-trail trail (robot-put-x robot) (robot-put-y robot)))))

(defun update-trail (trail)
  (let ((robot (trail-robot trail)))
    (unless (eql (trail-placements trail) (robot-placements robot)) (begin-trail-piece trail))
    (extend-trail trail (robot-x robot) (robot-y robot))))

(defun update-trails (simulation trails)
  "Add the current positions of the robots of SIMULATION to TRAILS, a list of their trails. A new
trail is added at the front for a robot without one. Return the list."
  (dolist (robot (simulation-robots simulation) trails)
    (update-trail (or (find robot trails :key #'trail-robot)
                      (first (push (make-trail robot) trails))))))

(defun trail-pieces-in-order (trail)
  (reverse (mapcar #'reverse (trail-pieces trail))))

(defun trails-to-ways (trails trial outcome)
  "Return the ways of TRIAL, which ended with OUTCOME, from TRAILS, a value of UPDATE-TRAILS. A
trial without trails, which failed at once, has one way without points, so that it is counted."
  (if trails
      (loop for trail in (reverse trails) collect (make-way trial outcome
                                                          (trail-pieces-in-order trail)))
      (list (make-way trial outcome '()))))

;;; A way has a point for each tick. Nearly straight parts need only their ends.

(defun distance-from-line (point start end)
  "Return the distance of POINT from the line between START and END, which may be equal."
  (destructuring-bind ((x . y) (x1 . y1) (x2 . y2)) (list point start end)
    (let* ((dx (- x2 x1)) (dy (- y2 y1)) (square (+ (* dx dx) (* dy dy)))
           (share (if (zerop square)
                      0
                      (clamp (/ (+ (* dx (- x x1)) (* dy (- y y1))) square) 0 1))))
      (sqrt (+ (expt (- x x1 (* share dx)) 2) (expt (- y y1 (* share dy)) 2))))))

(defun simplify-line (points tolerance)
  "Return a simplified line: a list of some of POINTS, such that all other points are at most
TOLERANCE from the line through the returned points (Douglas and Peucker 1973)."
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
  "Return the PIECES of a way as lists x y ... in pixels, simplified for drawing."
  (loop for piece in pieces
        collect (loop for (x . y) in (simplify-line piece (/ 1/2 graphics-scale*))
                      collect (to-pixels x) collect (to-pixels y))))

;;;; A run as a table

;;; The run is replayed from its journal. So a table can be made of any run with a journal, also
;;; afterwards, and nothing is recorded during the run.

(defparameter *trajectory-columns*
  '("tick" "robot" "x" "y" "angle" "estimated_x" "estimated_y" "estimated_angle" "holding" "place")
  "The names of the columns of a trajectory, as SAVE-TRAJECTORY writes it.")

(note-kind-of-file :trajectory (format nil "~{~A,~}" (subseq *trajectory-columns* 0 5))
                   "the file is a table of the positions of robots, which any CSV reader can read")

(defun full-number-text (number)
  "Return the text of NUMBER in full precision, so that other programs can read it."
  (let ((*read-default-float-format* 'double-float)) (princ-to-string number)))

(defun trajectory-row (robot tick)
  (printing-plainly ()
    (append (list (full-number-text tick) (string-downcase (robot-label robot)))
            (mapcar #'full-number-text
                    (list* (robot-x robot) (robot-y robot) (robot-angle robot)
                           (multiple-value-list (odometer-estimate (robot-main-odometer robot)))))
            (list (format nil "~{~A~^ ~}" (loop for hand across (robot-hands robot)
                                                when (hand-holding hand) collect it))
                  (format nil "~@[~(~A~)~]" (robot-last-place robot))))))

(defun write-robot-rows (simulation names out)
  "Write a row to OUT for each robot of SIMULATION; unless NAMES is NIL, only for the robots NAMES."
  (let* ((robots (simulation-robots simulation))
         (meant (loop for name in names append (robots-meant name robots))))
    (dolist (robot robots)
      (when (or (null names) (member robot meant))
        (write-string (csv-line (trajectory-row robot (simulation-tick simulation))) out)))))

(defun write-trajectory (journal out every until names)
  (write-string (csv-line *trajectory-columns*) out)
  (flet ((look (simulation)
           (when (zerop (mod (simulation-tick simulation) every))
             (write-robot-rows simulation names out))))
    (call-with-replay (constantly nil) journal :until until :observer #'look :beginning #'look)))

(defun check-trajectory-arguments (file every until robots journal)
  (check-argument save-trajectory file
                  (and (typep file '(or string pathname)) (not (wildcard-name-p file))
                       (pathname-name file))
                  "the name of a file, such as \"run.csv\"; write \\\\ before each * ? and [")
  (check-argument save-trajectory every (whole-p every 1)
                  "a whole number of ticks, from 1 to 1e9")
  (checked-end-tick 'save-trajectory journal until)
  (let ((known (journal-robot-names journal)))
    (dolist (name robots)
      (unless (robots-meant name known :key #'identity)
        (reject-name "robot in the run of the journal" name known)))))

(addition save-trajectory)
(define-with-keywords save-trajectory
    (file &key journal (every 1) until robots anyway)
  "Replay a run and write the positions of its robots to FILE, a CSV table. Return the truename of
FILE. JOURNAL is a journal or a file with a journal, by default the journal of the current
simulation up to now. The table has a row for each robot every EVERY ticks, up to the tick UNTIL.
ROBOTS, a name or a list of names, restricts the table to these robots. A row has the tick; the
robot; its x and y in metres and its heading in radians; the same three numbers as estimated by the
robot's main odometer, in coordinates of the map; the things in its hands; and the place type that
the robot sensed last. If ANYWAY is true, definitions may have changed since the run.

FILE may be new, empty, or a table that SAVE-TRAJECTORY has written, which is replaced. Signals
WRONG-ARGUMENT, UNKNOWN-NAME, the errors of REPLAY, and MISUSE if there is no journal, or if FILE is
another file or cannot be written. After an error FILE is unchanged."
  (let ((journal (resolve-journal journal 'save-trajectory)) (robots (ensure-list robots)))
    (check-trajectory-arguments file every until robots journal)
    (check-kind-of-file file :trajectory "trajectory")
    (let ((text (with-output-to-string (out)
                  (replaying (anyway)
                    (write-trajectory journal out every until robots)))))
      (overwrite-file (lambda (out) (write-string text out)) file "the trajectory"
                      :kind :trajectory))))
