;;;; trails.lisp -- where robots went, tick by tick: as ways worth drawing, and as a table.

(in-package :ars-magna.trails)

(export '(note-places ways-along straightened))

(define-record (way (:constructor make-way (trial outcome pieces)))
  "Where a robot was in a trial."
  (trial 0 integer "the number of the trial in which the way was gone" :export)
  (outcome "" string "how that ended: \"success\", \"failure\", \"limit\" or \"error\"" :export)
  (pieces '() list "the pieces of the way, lists of points (x . y), in order" :export))

(define-record (trail (:constructor make-trail (robot)))
  "Where ROBOT has been so far."
  (robot nil robot)
  (placements nil (or null fixnum)
              "how often it had been put somewhere when it was seen last, or NIL" :writable)
  (pieces '() list
          "the pieces as those of a way, latest first, as are the points of each" :writable))

(defun note-point (trail x y)
  "Let the last piece of TRAIL go on to X, Y."
  (unless (equal (cons x y) (first (first (trail-pieces trail))))
    (push (cons x y) (first (trail-pieces trail)))))

(defun note-placement (trail)
  "Let a piece of TRAIL begin where its robot has been put: it may have driven on since."
  (let ((robot (trail-robot trail)) (begun-p (trail-placements trail)))
    (setf (trail-placements trail) (robot-placements robot))
    (push '() (trail-pieces trail))
    (when begun-p (note-point trail (robot-put-x robot) (robot-put-y robot)))))

(defun note-place (trail)
  (let ((robot (trail-robot trail)))
    (unless (eql (trail-placements trail) (robot-placements robot)) (note-placement trail))
    (note-point trail (robot-x robot) (robot-y robot))))

(defun note-places (simulation trails)
  "Add to TRAILS, a list, latest first, where the robots of SIMULATION are. Return it."
  (dolist (robot (simulation-robots simulation) trails)
    (note-place (or (find robot trails :key #'trail-robot)
                    (first (push (make-trail robot) trails))))))

(defun pieces-along (trail)
  (reverse (mapcar #'reverse (trail-pieces trail))))

(defun ways-along (trails trial outcome)
  "Return the ways that TRAILS, as NOTE-PLACES keeps them, say robots went in TRIAL, which ended
with OUTCOME. A trial that broke off before robots were seen has one way, without points: so it
counts."
  (if trails
      (loop for trail in (reverse trails) collect (make-way trial outcome (pieces-along trail)))
      (list (make-way trial outcome '()))))

;;; A way has a point for each tick. What is nearly straight needs only its ends.

(defun distance-from-line (point start end)
  "Return how far POINT is from the line from START to END, or from START if they are one."
  (destructuring-bind ((x . y) (x1 . y1) (x2 . y2)) (list point start end)
    (let* ((dx (- x2 x1)) (dy (- y2 y1)) (square (+ (* dx dx) (* dy dy)))
           (share (if (zerop square)
                      0
                      (clamp (/ (+ (* dx (- x x1)) (* dy (- y y1))) square) 0 1))))
      (sqrt (+ (expt (- x x1 (* share dx)) 2) (expt (- y y1 (* share dy)) 2))))))

(defun straightened (points tolerance)
  "Return those of POINTS, a list, that a line through which leaves none off by more than TOLERANCE
(Douglas and Peucker 1973)."
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
  "Return PIECES of a way as lists x y ... in pixels, with the points that are worth drawing."
  (loop for piece in pieces
        collect (loop for (x . y) in (straightened piece (/ 1/2 graphics-scale*))
                      collect (to-pixels x) collect (to-pixels y))))

;;;; A run as a table

;;; The run is repeated from its journal, so any run that keeps one will do, also afterwards, and
;;; nothing is kept meanwhile.

(defparameter *trajectory-columns*
  '("tick" "robot" "x" "y" "angle" "estimated_x" "estimated_y" "estimated_angle" "holding" "place")
  "What the first line of a trajectory says.")

(note-kind-of-file :trajectory (format nil "~{~A,~}" (subseq *trajectory-columns* 0 5))
                   "it is a table of where robots were; any program that reads CSV reads it")

(defun full-number-text (number)
  "Return NUMBER as any program reads it, to the last bit."
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
  "Write to OUT a row for each robot of SIMULATION, or of those that NAMES, a list, mean."
  (dolist (robot (simulation-robots simulation))
    (when (or (null names) (member (robot-name robot) names :test #'same-name-p))
      (write-string (csv-line (trajectory-row robot (simulation-tick simulation))) out))))

(defun write-trajectory (journal out every until names)
  "Repeat JOURNAL, up to UNTIL, and write the rows of every EVERY ticks to OUT."
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
  "Write to FILE, as a table of commas (CSV), where the robots of a run were: of that of JOURNAL (a
journal, or a file that holds one), or else the current one up to now, which must keep one. FILE may
be new, empty, or another such table, which is replaced. A row for every EVERY ticks, up to the tick
UNTIL, and for each robot, or those that ROBOTS, a name or a list of names, means: the tick, the
robot, x and y in metres and the heading in radians; the same as its main odometer has it, put on
the map; what its hands hold; the place type that it sensed last. The run is repeated for that, with
ANYWAY even if its definitions are not those at hand. Return the file's truename. Signals
WRONG-ARGUMENT, UNKNOWN-NAME, MISUSE if there is no journal or FILE is something else or cannot be
written, when what was there is as before, and what REPLAY does."
  (let ((journal (journal-meant journal 'save-trajectory)) (robots (ensure-list robots)))
    (check-trajectory file every until robots journal)
    (check-not-foreign file :trajectory "trajectory")
    (let ((text (with-output-to-string (out)
                  (replaying (anyway)
                    (write-trajectory journal out every until robots)))))
      (write-file-anew (lambda (out) (write-string text out)) file "the trajectory"
                       :kind :trajectory))))
