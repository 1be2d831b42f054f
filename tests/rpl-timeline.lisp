;;;; rpl-timeline.lisp -- pictures of plans: bars, spans, rows, SVG files.

(in-package :ars-magna.tests)
(in-suite rpl)

(defun bars-until (limit)
  "Return the bars of SEEN-BOSS until tick LIMIT: the plan's, and those of its parts."
  (let ((bar (first (rpl:bars (rpl:plan-trace (seen-until limit)) limit))))
    (values bar (rpl:bar-parts bar))))

(defun span-list (bar kind)
  (loop for span in (rpl:bar-spans bar)
        when (eq kind (rpl:span-kind span))
          collect (list (rpl:span-start span) (rpl:span-end span) (rpl:span-text span))))

(test bars.say-when-tasks-lived-waited-and-ended
  (multiple-value-bind (bar parts) (bars-until 30)
    (is (equal '(0 22 :succeeded)
               (list (rpl:bar-start bar) (rpl:bar-end bar) (rpl:bar-outcome bar))))
    (is (equal '(2 3 4 5 6) (mapcar #'rpl:bar-serial parts)))
    (is (equal '((0 4 "door") (5 7 "tick 7")) (span-list (first parts) :waiting)))
    (is (equal '((3 5 nil)) (span-list (first parts) :blocked)))
    (is (equal '((0 7 "valve arm") (7 11 "tick 11")) (span-list (second parts) :waiting)))
    (let ((cleaning (second (rpl:bar-parts (fourth parts)))))
      (is (eq :evaporated (rpl:bar-outcome cleaning)))
      (is (equal '((2 22 nil)) (span-list cleaning :cleaning))))))

(test bars.clean-up-no-longer-than-that-takes
  (let* ((runner (rpl:make-plan-runner :trace t :on-end #'identity))
         (bar (progn (rpl:run-plan-alone
                      (rpl:make-plan '(rpl:seq (rpl:evap-protect (rpl:wait-time 2)
                                                (rpl:wait-time 3))
                                       (rpl:wait-time 4)))
                      :runner runner)
                     (first (rpl:bars (rpl:plan-trace runner))))))
    (is (equal '((2 5 nil)) (span-list bar :cleaning)))
    (is (= 9 (rpl:bar-end bar)))))

(test bars.of-tasks-under-way-go-on-until-now
  (multiple-value-bind (bar parts) (bars-until 5)
    (is (null (rpl:bar-outcome bar)))
    (is (= 5 (rpl:bar-end bar)))
    (is (= 5 (third (list 0 0 (rpl:bar-end (second parts))))))))

(test bars.know-of-failures
  (let* ((runner (rpl:make-plan-runner :trace t :on-end #'identity))
         (bar (progn (rpl:run-plan-alone (rpl:make-plan '(rpl:seq (rpl:wait-time 2)
                                                          (rpl:fail :class :slip)))
                                         :runner runner)
                     (first (rpl:bars (rpl:plan-trace runner))))))
    (is (eq :failed (rpl:bar-outcome bar)))
    (is (eq :slip (rpl:failure-class (rpl:bar-failure bar))))
    (is (= 2 (rpl:bar-end bar)))))

;;; Rows.

(test rows.are-shared-by-turns-of-a-loop
  (let* ((runner (seen-until 60 :plan (rpl:make-plan
                                       '(rpl:n-times 20 (rpl:par (rpl:wait-time 2)
                                                         (rpl:wait-time 1))))))
         (bars (rpl:bars (rpl:plan-trace runner)))
         (rows (ars-magna.rpl-pictures::rows-of-bars bars)))
    (is (= 41 (1+ (length (rpl:bar-parts (first bars))))))
    (is (= 3 (length rows)))
    (is (equal '(1 20 20)
               (mapcar (lambda (row) (length (ars-magna.rpl-pictures::row-bars row))) rows)))))

;;; Files.

(defun timeline-text (runner &rest options)
  (uiop:with-temporary-file (:pathname path :type "svg")
    (apply #'ars-magna.rpl-pictures:save-plan-timeline path :runner runner options)
    (uiop:read-file-string path)))

(test timeline.shows-tasks-waits-ends-and-a-legend
  (let ((text (timeline-text (seen-until 30))))
    (is (eql 0 (search "<svg" text)))
    (is-true (has-words-p text "1 seen-boss" "2 one" "valve arm" "runs its parts"
                          "waits" "succeeded"))
    (is (search "ticks 0 to 22, succeeded" text))))

(test timeline.of-hundreds-of-tasks-is-cut-where-asked
  (let ((runner (seen-until 3 :plan (rpl:make-plan
                                     '(rpl:par-loop (i (loop for i below 300 collect i))
                                       (rpl:wait-time 2))))))
    (is-true (has-words-p (timeline-text runner) "300 (" "301 ("))
    (is (search "281 more rows are left out" (timeline-text runner :most 20)))
    (signals base:wrong-argument (timeline-text runner :most 0))))

(test timeline.is-the-same-every-time
  (is (string= (timeline-text (seen-until 30)) (timeline-text (seen-until 30)))))

(test timeline.without-a-trace-is-misuse
  (signals base:misuse (timeline-text (seen-until 3 :trace nil)))
  (signals base:misuse (timeline-text (rpl:make-plan-runner :trace t)))
  (signals base:wrong-argument
    (ars-magna.rpl-pictures:save-plan-timeline "timeline.jpg" :runner (seen-until 3))))

;;; On a robot.

(rpl:def-interp-proc turn-and-tell (angle)
  (driver:rpl-robot-turn angle)
  (rpl:wait-for driver:robot-stopped*))

(rpl:def-interp-proc turn-twice ()
  (rpl:par (turn-and-tell 1) (rpl:wait-time 3))
  (driver:rpl-storage-bin-open 0)
  (rpl:wait-for (svref driver:storage-bin-moved* 0)))

(defmacro with-traced-turns (() &body body)
  "Run BODY in a simulation in which TURN-TWICE has run, and is traced."
  `(run:with-simulation (ars-user::butler :clean t)
     (let ((driver:*trace-plans* t))
       (driver:run-plan 'turn-twice))
     ,@body))

(test task-commands.say-who-issued-them-for-what-and-what-came-of-it
  (with-traced-turns ()
    (let ((commands (rpl:task-commands nil)))
      (is (equal '((driver:rpl-robot-turn 1) (driver:rpl-storage-bin-open 0))
                 (mapcar (lambda (command) (getf command :command)) commands)))
      (is (equal '(nil :bin-open) (mapcar (lambda (command) (getf command :error)) commands)))
      (is (equal '(2 1) (mapcar (lambda (command) (getf command :task)) commands)))
      (is (< (getf (first commands) :tick) (getf (first commands) :answered)))
      (is (member '(turn-and-tell 1) (getf (first commands) :for) :test #'equal)))))

(test why.names-the-command-whose-answer-woke-a-task
  (with-traced-turns ()
    (let ((text (with-output-to-string (out) (rpl:why 2 :stream out))))
      (is-true (has-words-p text "robot-stopped* was pulsed by the answer to"
                            "rpl-robot-turn 1), which task 2 issued at tick 0")))))

(test timeline.has-commands-and-the-calls-they-were-issued-in
  (with-traced-turns ()
    (let ((text (timeline-text nil)))
      (is-true (has-words-p text "rpl-storage-bin-open 0), ticks" ": bin-open"
                            "(turn-and-tell 1)")))))

(test timeline.writes-commands-where-there-is-room
  (with-traced-turns ()
    (is-true (has-words-p (timeline-text nil) ">robot-turn 1<")))
  (flet ((name (text)
           (ars-magna.rpl-pictures::command-text
            (ars-magna.rpl.seeing::make-span :command 0 text))))
    (is (string= "robot-turn -0.05 nil" (name "(rpl-robot-turn -0.058755822d0 nil)")))
    (is (string= "camera-track 1 #<Designator 0>" (name "(rpl-camera-track 1 #<Designator 0>)")))))

(test timeline.shows-that-names-of-commands-are-cut-and-has-the-whole-ones-in-titles
  (let* ((whole (format nil "(rpl-camera-get-all-object-designators~{ word-~D~})"
                        (loop for i below 20 collect i)))
         (span (ars-magna.rpl.seeing::make-span :command 0 whole 90))
         (scale (ars-magna.rpl-pictures::make-scale 0 100 0 100))
         (drawn (format nil "~{~A~}"
                        (drawing (canvas)
                          (ars-magna.rpl-pictures::draw-command canvas span nil 0 0 scale)))))
    (is-true (has-words-p drawn "<title>" whole "ticks 0 to 90"))
    (is (equal '("camera-get-a...")
               (mapcar (lambda (text) (of-element text :text)) (drawn-with :text drawn))))))

(test timeline.takes-what-is-no-trouble-for-none
  "A command that something newer ended, or a look that found nothing, is drawn as others are; where
one points at it, it says in words what came of it."
  (flet ((drawn (code)
           (let ((span (ars-magna.rpl.seeing::make-span :command 0 "(rpl-robot-turn 1)" 9)))
             (setf (ars-magna.rpl.seeing::span-error span) code)
             (format nil "~{~A~}"
                     (drawing (canvas)
                       (ars-magna.rpl-pictures::draw-command
                        canvas span nil 0 0 (ars-magna.rpl-pictures::make-scale 0 100 0 100)))))))
    (flet ((fill-of (code) (of-element (first (drawn-with :rect (drawn code))) :fill)))
      (is (equal (fill-of nil) (fill-of :interrupt)))
      (is (equal (fill-of nil) (fill-of :designator-not-found)))
      (is (not (equal (fill-of nil) (fill-of :robot-blocked)))))
    (is-true (has-words-p (drawn :interrupt) ": interrupt. A newer request took over"))))

(test timeline.has-a-title-and-a-scale
  (let ((runner (seen-until 30)))
    (flet ((text (&rest options) (apply #'timeline-text runner options)))
      (is-true (has-words-p (text :title "A day of work") ">A day of work<"))
      (is (< (* 3/2 (of-element (first (drawn-with :svg (text))) :width))
             (of-element (first (drawn-with :svg (text :scale 2))) :width))))
    (dolist (options '((:title 7) (:scale 0) (:scale 1000)))
      (signals base:wrong-argument (apply #'timeline-text runner options)))))

(test timeline.has-whole-expressions-in-titles
  (let ((runner (seen-until 9 :plan (rpl:make-plan
                                     '(rpl:par
                                       (rpl:wait-time (+ 1 1 1 (* 1 1 1 1 1) (- 1 1 1 1 1 1 1)
                                                       (* 1 1 1 1 1 1 1 1 1) 7777))
                                       (rpl:wait-time 2))))))
    (is-true (has-words-p (timeline-text runner) "(* 1 1 1 1 1 1 1 1 1) 7777)), ticks"))))

(test timeline.writes-the-last-commands-before-them-where-there-is-no-room-behind
  (flet ((place (x from)
           (multiple-value-list
            (ars-magna.rpl-pictures::find-command-text-place 50 x 10 from 140))))
    (is (equal '(73) (place 60 0)))
    (is (equal '(67) (place 120 0)))
    (is (equal '(nil) (place 120 80)))
    (is (equal '(82 t) (multiple-value-list
                        (ars-magna.rpl-pictures::find-command-text-place 50 80 60 0 140))))))

(defun colors-in (text)
  "Return what follows each # in the SVG document TEXT, six characters each time."
  (loop for start = (search "=\"#" text) then (search "=\"#" text :start2 (1+ start))
        while start collect (subseq text (+ 3 start) (+ 9 start))))

(test timeline.needs-no-colours
  "Without them there is only black and white, and kinds are told apart by texture."
  (let ((text (timeline-text (seen-until 30) :in-color nil)))
    (is (subsetp '("000000" "ffffff") (colors-in text) :test #'string=))
    (is (subsetp (colors-in text) '("000000" "ffffff") :test #'string=))
    (is-true (has-words-p text "runs its parts" "waits"))))

(test timeline.legend-has-what-is-drawn
  (is (not (has-words-p (timeline-text (seen-until 30)) "command that failed"))))

(test timeline.is-as-wide-as-its-ticks-and-breaks-its-title
  (let ((words (format nil "~{~A~^ ~}" (loop repeat 60 collect "word"))))
    (flet ((width (text)
             (of-element (first (elements text)) :width)))
      (is (< 0 (width (timeline-text (seen-until 30))) 820))
      (is (= (width (timeline-text (seen-until 30)))
             (width (timeline-text (seen-until 30) :title words))))
      (is (has-words-p (timeline-text (seen-until 30) :title words) "ticks")))))

(test timeline.has-no-two-kinds-that-look-alike-without-colours
  "Neither as wide as in the legend nor as narrow as a tick may be."
  (dolist (width '(6 18))
    (let ((looks (loop for (kind) in ars-magna.rpl-pictures::*bar-looks*
                       collect (drawing (canvas)
                                 (let ((canvas:in-color* nil))
                                   (ars-magna.rpl-pictures::draw-bar-look
                                    canvas kind 0 0 width 14))))))
      (is (= 8 (length looks) (length (remove-duplicates looks :test #'equal)))))))

(test timeline.has-no-lines-through-the-names-of-commands
  "A name beside its command has a white ground."
  (let* ((span (ars-magna.rpl.seeing::make-span :command 0 "(rpl-robot-turn 1)"))
         (drawn (drawing (canvas)
                  (ars-magna.rpl-pictures::write-command canvas span 100 40 10 0 400)))
         (elements (elements (format nil "~{~A~}" drawn)))
         (plate (first elements)) (name (find :text elements :key #'first)))
    (is (eq :rect (first plate)))
    (is (equal "#ffffff" (of-element plate :fill)))
    (is (< (of-element plate :x) (of-element name :x)))
    (is (< (of-element plate :y) (of-element name :y)
           (+ (of-element plate :y) (of-element plate :height))))))

(test timeline.gives-names-the-room-that-they-need
  (flet ((width (label)
           (ars-magna.rpl-pictures::labels-width
            (list (ars-magna.rpl-pictures::make-row
                   (list (ars-magna.rpl.seeing::make-bar 1 nil label nil 0 0))))
            120 480)))
    (is (= 120 (width 'a)))
    (is (< (width 'a-plan-with-a-long-name) (width 'a-plan-with-a-name-that-is-yet-much-longer)))))

(test trace-plans.takes-effect-at-the-next-plan
  (run:with-simulation (ars-user::butler :clean t)
    (driver:run-plan 'turn-twice)
    (signals base:misuse (rpl:trace-of nil))
    (let ((driver:*trace-plans* t))
      (driver:run-plan 'turn-twice))
    (is (plusp (length (rpl:trace-of nil))))
    (is (null (set-difference '(:start :command :answer :succeed)
                              (mapcar #'rpl:trace-entry-event (rpl:trace-of nil)))))))

(test trace.answers-what-planners-ask
  "Did it grasp a green thing; why did it drive there; which look failed?"
  (run:with-simulation (ars-worlds:robbie :seed 1)
    (let ((driver:*trace-plans* t))
      (driver:run-plan 'ars-worlds:fetch-thing
                       '((:color world:lightgreen) (:substance world:wood)) '((35.5 22.5))))
    (let ((commands (rpl:task-commands nil)))
      (flet ((issued (name)
               (remove name commands :key (lambda (command) (first (getf command :command)))
                                     :test-not #'eq))
             (for-p (name command)
               (find name (getf command :for) :key #'first)))
        (let ((grasp (find nil (issued 'driver:rpl-hand-grasp-desig)
                           :key (lambda (command) (getf command :error)))))
          (is (equal '(:color world:lightgreen)
                     (assoc :color (robot:designator-data (fourth (getf grasp :command))))))
          (is (for-p 'ars-worlds:take-thing grasp)))
        (is (every (lambda (drive) (or (for-p 'ars-worlds:travel-to drive)
                                       (for-p 'ars-worlds:find-and-take drive)
                                       (for-p 'ars-worlds:put-thing-down drive)))
                   (issued 'driver:rpl-robot-go-forward)))
        (let ((looks (issued 'driver:rpl-camera-get-all-object-designators)))
          (is (< 0 (count-if (lambda (look) (getf look :error)) looks) (length looks))))))))
