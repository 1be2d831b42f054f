;;;; track-matching-kept.lisp -- matching tracks in forks, rewinds, files, replays, plans, lines.

(in-package :ars-magna.tests)

(in-suite track-matching)

(defmacro amid-matching ((&rest options) &body body)
  "Run BODY in a noisy run where WATCHER has a matching track of one of two red balls."
  `(run:with-simulation (watcher :seed 3 :parameters '((base:track-match-interval* 3)
                                                       (base:track-match-misses* 30)
                                                       (base:prob-lose-track* 0)
                                                       (base:miss-thing-prob* 0)
                                                       (base:false-thing-prob* 0))
                                 ,@options)
     (put 'ball '(9.5 10.5) :color 'world:red)
     (put 'twin '(9.5 10.6) :color 'world:red)
     (command:camera-track-matching (eye) (find-object '()) '((:color red)))
     (run:run-ticks 31)
     ,@body))

(defun matched-and-digest (&optional (ticks 0))
  "Return what designators denote and say after TICKS more ticks, and the digest."
  (run:run-ticks ticks)
  (list (loop for designator in (robot:live-designators (first (run:simulation-robots)))
              collect (list (denoted-name designator) (robot:designator-data designator)))
        (run:state-digest)))

(test matching.is-forked-and-rewound
  (amid-matching (:keep t)
    (let* ((fork (run:fork-simulation))
           (now (matched-and-digest))
           (later (run:call-in-fork fork (lambda () (matched-and-digest 40)))))
      (is (equalp now (matched-and-digest)) "the fork disturbs the original")
      (is (equalp later (matched-and-digest 40)))
      (is (not (equal (first now) (first later))))
      (run:rewind 40)
      (is (equalp now (matched-and-digest)))
      (is (equalp later (matched-and-digest 40))))))

(test matching.is-saved-and-loaded
  (amid-matching ()
    (with-temporary-file (file)
      (run:save-simulation file)
      (let ((now (matched-and-digest)) (later (matched-and-digest 40)))
        (run:with-loaded-simulation (file)
          (is (equalp now (matched-and-digest)))
          (is (equalp later (matched-and-digest 40))))))))

(world:defmap yard (24 12)
  (rect (0 0) (23 11) bricks 10)
  (obj ball (10.5 5.5) ((:size 3) (:color red)))
  (obj twin (10.5 5.7) ((:size 3) (:color red))))

(robot:defrobot guard (yard (4.5 5.5) 0) :cameras ((2 9)))

(test matching.is-repeated-from-a-journal
  (run:with-simulation (guard :seed 4 :journal t)
    (let ((camera (robot:robot-camera guard 0)))
      (labels ((look (&rest results)
                 (declare (ignore results))
                 (command:camera-get-object-designator camera :non-local '() #'follow))
               (follow (code camera designator)
                 (if code
                     (look)
                     (command:camera-track-matching
                      camera designator '((:size 3 5))
                      (lambda (code camera designator)
                        (declare (ignore camera designator))
                        (when code (look)))))))
        (look)
        (run:run-ticks 300))
      (is (<= 5 (count 'command:camera-track-matching
                      (run:journal-entries (run:simulation-journal time:*simulation*))
                      :key #'second)))
      (is (= (run:state-digest) (replayed-digest))))))

(test matching.with-an-invalid-description-is-not-loaded
  (amid-matching ()
    (is (null (unsound-robots (list watcher) world:*world*)))
    (setf (robot::matching-track-specification (robot:camera-tracking (eye))) '((:color orange)))
    (is (equal '("what a track is matched with is invalid")
               (unsound-robots (list watcher) world:*world*)))))

(test digest.of-a-run-with-another-track-is-as-before
  "The parameters of matching are no part of it unless they are changed."
  (with-watcher ()
    (robot:start-track (eye) (robot:add-designator watcher :denotation (put 'ball '(9.5 10.5)))
                       nil)
    (is (not (robot::matching-track-p (robot:camera-tracking (eye)))))
    (run:run-ticks 3)
    (let ((before (run:state-digest)))
      (setf base:track-match-gate* 1/2)
      (is (/= before (run:state-digest)))
      (setf base:track-match-gate* .1d0)
      (is (= before (run:state-digest))))))

;;; Plans.

(rpl:def-interp-proc red-ball ()
  (driver:rpl-camera-get-object-designator 0 :non-local '((:color red)))
  (rpl:wait-for (svref driver:camera-input* 0))
  (first (rpl:fluent-value (svref driver:camera-designators* 0))))

(rpl:def-interp-proc count-matches ()
  (let ((ball (red-ball)) (matches 0))
    (rpl:set-value (svref driver:camera-tracking-error* 0) nil)
    (driver:rpl-camera-track-matching 0 ball '((:color red)))
    (rpl:wait-for (svref driver:camera-tracking* 0))
    (rpl:pursue
     (rpl:wait-for (svref driver:camera-tracking-error* 0))
     (loop (rpl:wait-for (svref driver:camera-tracking* 0))
           (setf matches (+ matches 1))))
    (list matches (rpl:fluent-value (svref driver:camera-tracking-error* 0)))))

(test plan.is-told-of-each-match
  (run:with-simulation (guard :clean t :keep t)
    (world:destroy-thing (world:find-thing 'twin))
    (driver:rpl-init-robot guard)
    (let ((task (driver:begin-plan 'count-matches)))
      (run:run-ticks 55)
      (world:set-attribute (world:find-thing 'ball) :color 'world:blue)
      (run:run-ticks 5)
      (let ((fork (run:fork-simulation)))
        (run:run-ticks 40 fork)
        (run:run-ticks 40)
        (is (equal '(4 :lost-track) (rpl:task-result task)))
        (is (= (run:state-digest) (run:state-digest fork)))))))

;;; The prompt.

(test prompt.tracks-and-matches
  (is (equal '("get-designator: Camera 0 found Designator 0"
               "camera-track-matching: Camera 0 tracking Designator 0"
               "*WARNING* -> camera-track-matching was interrupted"
               "camera-untrack: Camera 0 stopped tracking")
             (remove "Tick" (type-to 'guard "(clean-simulation)" "obj-desig 0 non-local ()"
                                     "cam-track-matching 0 0 ((:color red))" "step 30"
                                     "cam-untrack 0")
                     :test #'search)))
  (loop for (line text) in '(("cam-track-matching 0 0 red" "descriptor specification")
                             ("cam-track-matching 0 5 ()" "no designator 5")
                             ("cam-track-matching 0 0" "specification is missing"))
        do (is (find text (type-to 'guard "(clean-simulation)" "obj-desig 0 non-local ()" line)
                     :test #'search))))
