;;;; manual-a.lisp -- appendix A of the manual: loading and running the simulator.

(in-package :ars-test-manual)
(in-readtable :nisp)

(def-suite* manual-a :in ars-magna)

;;; A robot in a world of its own, for runs beside that of SCOUT.
(defmap pen (12 12))
(defrobot lamb (pen (3 3) 0) :cameras ((1 3)))

(defmacro with-output ((text) form &body body)
  "Run BODY with TEXT bound to what FORM prints."
  `(let ((,text (with-output-to-string (*standard-output*) ,form))) ,@body))

;;; Loading.

(test manual-a.dsklap-loads-the-simulator
  "A, reading 41: a directory and ars-magna mean the system, wherever it is installed."
  (is-true (dsklap "ars-dir/ars-magna"))
  (is-true (dsklap "ars-magna")))

(defvar *loaded* nil "What a file of MANUAL-A.DSKLAP-LOADS-FILES has set.")

(test manual-a.dsklap-loads-files
  "A, reading 41: of Lisp, with their type or without."
  (uiop:with-temporary-file (:pathname file :type "lisp" :stream out)
    (format out "(incf ars-test-manual::*loaded*)~%")
    :close-stream
    (!= *loaded* 0)
    (is-true (dsklap (namestring file)))
    (is-true (dsklap (namestring (make-pathname :type nil :defaults file))))
    (is (= 2 *loaded*))))

(test manual-a.dsklap-says-what-is-not-there
  "Reading 41: a name of neither a file nor a system is an error."
  (signals unknown-name (dsklap "ars-dir/no-such-thing")))

(test manual-a.ars-is-the-installation-directory
  "A: the logical name ARS is bound to it."
  (is (equal (truename (project-file "src/ars.lisp"))
             (truename "ARS:SRC;ARS.LISP"))))

;;; Running.

(test manual-a.simulator-starts-a-robot
  "A: (simulator robot) returns the robot, and its time passes from then on."
  (is (eq scout (simulator scout :display nil :rate :free)))
  (is-true (live-p))
  (robot-go-forward scout 10)
  (is-true (await-idle))
  (is (< 17 (robot-x scout) 19))
  (stop-simulator)
  (is (not (live-p))))

(test manual-a.simulator-takes-names-too
  "A: of a robot, or of a map that has one."
  (dolist (name '(scout "scout" yard))
    (is (eq scout (simulator name :display nil :rate :free))))
  (signals unknown-name (simulator 'nobody :display nil)))

(test manual-a.simulator-runs-without-a-display
  "A, reading 238: it pops up a display, and where there is none it says so and runs all the same."
  (let ((ars-magna.display::*display-opener* nil) (ars-magna.display::*reported-messages* '()))
    (with-output (text) (simulator scout)
      (is-true (search "No display" text))
      (is-true (live-p)))
    (with-output (text) (simulator scout :display nil)
      (is (string= "" text)))))

(test manual-a.simulator-pops-up-a-display
  "A: what can open windows is called with the robot."
  (let* ((shown '()) (ars-magna.display::*display-opener* (lambda (robot) (push robot shown))))
    (simulator scout)
    (is (equal (list scout) shown))))

(test manual-a.simulator-again-starts-anew
  "Reading 238: the run of the same world ends and its commands are interrupted; robot and things
are at their start again."
  (simulator scout :display nil :rate :free)
  (robot-go-forward scout 10)
  (is-true (await-idle))
  (recording (record)
    (pause)
    (robot-turn scout 1 (record :turn))
    (simulator scout :display nil :rate :free)
    (is (equal '(:interrupt) (codes (record)))))
  (is-true (await-idle))
  (is (equal '(10d0 10d0) (multiple-value-list (robot-position scout))))
  (is (= 0 (robot-angle scout) (simulation-tick))))

(test manual-a.simulator-runs-other-worlds-beside
  "Reading 238: a run of another world goes on; the newest is the current one."
  (simulator scout :display nil :rate :free)
  (let ((yard-run *simulation*))
    (simulator lamb :display nil :rate :free)
    (is (not (eq yard-run *simulation*)))
    (is-true (and (live-p yard-run) (live-p *simulation*)))
    (robot-turn scout 1)
    (robot-turn lamb -1)
    (is-true (and (await-idle yard-run) (await-idle)))
    (is (near 1 (robot-angle scout) .02))
    (is (near -1 (robot-angle lamb) .02))))

(test manual-a.simulators-can-be-stopped-and-started
  "Reading 89: a stopped simulator stands still until it is started again."
  (simulator scout :display nil :rate :free)
  (robot-turn scout .5)
  (is-true (await-idle))
  (stop-simulator)
  (let ((tick (simulation-tick)))
    (robot-turn scout 1)
    (is (= tick (simulation-tick))))
  (simulator scout :display nil :rate :free)
  (is-true (live-p))
  (robot-turn scout 1)
  (is-true (await-idle))
  (is (near 1 (robot-angle scout) .02)))

(test manual-a.cli-runs-the-command-line
  "A, reading 205: (cli) reads lines for the robot last given to simulator, until QUIT."
  (simulator scout :display nil :rate :free)
  (with-output (text)
      (with-input-from-string (*standard-input* (format nil "turn 1~%quit~%turn 1~%")) (cli))
    (is-true (search "Robot>" text))
    (is-false (search "Time stands still" text)))
  (is-true (live-p))
  (is-true (await-idle))
  (is (near 1 (robot-angle scout) .02)))

;;; Repeating.

(defun wandering (seed &key looking)
  "Return where a mouse has got to after 200 ticks of a run with SEED, and the run's digest. With
LOOKING, the robot looks about all the time."
  (with-own-definitions ()
    (defkicker scurry (thing) (:prob 1/3)
      (kick-thing thing (roll-between -1 1 (world-dice *world* :user)) 1/8 #f))
    (with-scout (:seed seed)
      (let ((mouse (put 'mouse '(5 5))))
        (set-kicker mouse 'scurry)
        (loop repeat 200
              do (when looking (camera-view (eye)))
                 (run-ticks 1))
        (values (list (thing-x mouse) (thing-y mouse)) (state-digest))))))

(test manual-a.runs-can-be-repeated
  "Reading 218: the seed decides all chance of a run."
  (is (equal (multiple-value-list (wandering 3)) (multiple-value-list (wandering 3))))
  (is (not (equal (wandering 3) (wandering 4)))))

(test manual-a.each-purpose-has-dice-of-its-own
  "Reading 218: looking does not change how a mouse moves."
  (is (equal (wandering 3) (wandering 3 :looking t))))

(test manual-a.seeds-can-be-set
  "Reading 218: in the middle of a run too."
  (flet ((angle-turned (seed)
           (with-scout (:seed 1)
             (run-ticks 5)
             (set-seed seed)
             (answer 'robot-turn scout 3)
             (robot-angle scout))))
    (is (= (angle-turned 7) (angle-turned 7)))
    (is (/= (angle-turned 7) (angle-turned 8)))))
