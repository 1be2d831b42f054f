;;;; trajectory.lisp -- a run as a table: where robots were, tick by tick, and what they held.

(in-package :ars-magna.trails)

;;; The run is repeated from its journal, so any run that keeps one will do, also afterwards, and
;;; nothing is kept meanwhile.

(defparameter *trajectory-columns*
  '("tick" "robot" "x" "y" "angle" "estimated_x" "estimated_y" "estimated_angle" "holding" "place")
  "What the first line of a trajectory says.")

(note-kind-of-file :trajectory (format nil "~{~A,~}" (subseq *trajectory-columns* 0 5))
                   "it is a table of where robots were; any program that reads CSV reads it")

(defun number-as-text (number)
  "Return NUMBER as any program reads it, to the last bit."
  (let ((*read-default-float-format* 'double-float)) (princ-to-string number)))

(defun trajectory-row (robot tick)
  (printing-plainly ()
    (append (list (number-as-text tick) (string-downcase (robot-name robot)))
            (mapcar #'number-as-text
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
  (call-with-replay (lambda () (write-rows (current-simulation) names out)) journal :until 0)
  (call-with-replay (constantly nil) journal
                    :until until
                    :observer (lambda (simulation)
                                (when (zerop (mod (simulation-tick simulation) every))
                                  (write-rows simulation names out)))))

(defun check-trajectory (file every until robots journal)
  (check-argument save-trajectory file
                  (and (typep file '(or string pathname)) (not (many-files-p file))
                       (pathname-name file))
                  "the name of a file, such as \"run.csv\"; before each * ? and [ in it write \\\\")
  (check-argument save-trajectory every (whole-p every 1)
                  "a whole number of ticks, from 1 to 1e9")
  (shown-end 'save-trajectory journal until)
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
