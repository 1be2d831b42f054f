;;;; several-rewinding.lisp -- rewinds past DEFROBOT and UNDEFINE; robots that have left.

(in-package :ars-magna.tests)
(in-suite several-robots)

(defun undefined-and-rewound-p ()
  "Undefine the robot DOG in the current run, rewind, and return true if DOG can be used as before."
  (ars:undefine 'robot 'dog)
  (pass-ticks-now 4)
  (run:rewind 6)
  (command:robot-turn (robot-called 'dog) 1)
  (pass-ticks-now 4)
  (and (eq (robot-called 'dog) (robot:find-robot 'dog))
       (with-temporary-file (file) (run:save-simulation file))
       (= (run:state-digest) (replayed-digest))))

(test leaving.that-was-rewound-leaves-the-robot-defined
  (with-pound
    (with-stopped-run (cat :keep t)
      (pass-ticks-now 4)
      (dotimes (i 2)
        (is-true (undefined-and-rewound-p)))
      (ars:undefine 'robot 'dog)
      (is (null (robot:find-robot 'dog nil)))
      (is (null (rest (run:simulation-robots))))
      (eval '(robot:defrobot dog (pound (3 9) 1)))
      (run:rewind 2)
      (is (= 7
             (robot:robot-y (robot-called 'dog))
             (robot:blueprint-y (robot:find-blueprint 'dog)))))))

(test joining.that-is-rewound-is-undone-with-the-definition
  (with-pound
    (with-stopped-run (cat :keep t)
      (pass-ticks-now 4)
      (eval '(robot:defrobot owl (pound (9 9) 0)))
      (pass-ticks-now 4)
      (run:rewind 6)
      (is (null (robot:find-robot 'owl nil)))
      (is (not (boundp 'owl)))
      (is (equal '("CAT" "DOG") (mapcar #'robot:robot-label (run:simulation-robots))))
      (is (has-words-p (displayed) "OWL joined after tick")))))

(test definition.replaced-in-a-run-is-restored-by-a-rewind
  "The journal and the saved run then need the first definition only."
  (with-pound
    (with-stopped-run (cat :keep t)
      (pass-ticks-now 4)
      (eval '(robot:defrobot dog (pound (3 12) 0) :hands (1 2 3)))
      (pass-ticks-now 2)
      (run:rewind 4)
      (command:robot-turn (robot-called 'dog) 1)
      (pass-ticks-now 4)
      (is (= 7 (robot:blueprint-y (robot:find-blueprint 'dog))))
      (is (= (run:state-digest) (replayed-digest)))
      (with-temporary-file (file)
        (is-true (run:save-simulation file)))
      (run:with-simulation (dog)
        (is (zerop (length (robot:robot-hands (robot:find-robot 'dog)))))))))

(test definition.moved-to-another-map-is-restored-by-a-rewind
  (with-pound
    (eval '(world:defmap kennel (20 20)))
    (with-stopped-run (cat :keep t)
      (pass-ticks-now 4)
      (eval '(robot:defrobot dog (kennel (3 3) 0)))
      (run:rewind 2)
      (is (eq 'pound (robot:blueprint-map (robot:find-blueprint 'dog))))
      (is (null (world:world-robots (world:map-resident-world (world:find-map 'kennel))))))))

(test joining.before-the-first-request-is-in-the-journal-after-a-rewind
  (with-pound
    (with-stopped-run (cat :keep t)
      (run:rewind (herd-tick))
      (eval '(robot:defrobot owl (pound (9 9) 0)))
      (command:robot-turn (robot-called 'cat) 1)
      (pass-ticks-now 3)
      (run:rewind 1)
      (ars:undefine 'robot 'owl)
      (with-temporary-file (file) (is-true (run:save-journal file)))
      (with-temporary-file (file) (is-true (run:save-simulation file))))))

(test leaving.robots-can-be-looked-at
  (with-pound
    (eval '(robot:defrobot owl (pound (9 9) 0) :cameras ((3 10))))
    (with-stopped-run (cat)
      (pass-ticks-now 1)
      (let ((owl (robot-called 'owl)))
        (ars:undefine 'robot 'owl)
        (is (eq 'owl (getf (run:status owl) :robot)))
        (is (search "OWL" (with-output-to-string (*standard-output*) (describe owl))))))))

(test leaving.of-all-robots-is-said-when-the-run-is-saved
  (with-pound
    (with-stopped-run (cat)
      (ars:undefine 'robot 'cat)
      (ars:undefine 'robot 'dog)
      (with-temporary-file (file)
        (is (has-words-p (herd-refusal (run:save-simulation file)) "all robots have left"))))))

(test rewinding.inside-own-definitions-keeps-the-run
  (with-pound
    (with-stopped-run (cat :keep t)
      (pass-ticks-now 4)
      (with-own-definitions () (run:rewind 2))
      (is (null (run:simulation-over time:*simulation*)))
      (is (eq (run:simulation-world time:*simulation*)
              (robot:robot-world (robot-called 'cat))))
      (pass-ticks-now 2)
      (run:rewind 1)
      (is (null (robot:robot-retired (robot-called 'dog)))))))

(test simulator.that-is-refused-stops-no-run
  (with-pound
    (with-messages
      (unwind-protect
           (progn
             (run:simulator 'cat :rate :free :seed 5 :display nil)
             (command:robot-go-forward (robot-called 'cat) 9)
             (run:await-idle)
             (eval '(robot:defrobot owl (pound (3 3) 0)))
             (is (has-words-p (herd-refusal (run:simulator 'cat :display nil)) "in one cell"))
             (is-true (time:live-p)))
        (run:stop-simulator)
        (setf time:*simulation* nil world:*world* nil)))))

(test undefine.does-not-choose-among-several
  (is (has-words-p (herd-refusal (ars:undefine 'robot "scout")) "PA::SCOUT or" "PB::SCOUT"))
  (is (has-words-p (herd-refusal (ars:undefine 'robot 'scout)) "PA::SCOUT or" "PB::SCOUT"))
  (is-true (robot:find-blueprint 'pa::scout)))

(test joining.at-tick-0-of-a-live-run-needs-a-free-cell
  (with-pound
    (with-messages
      (unwind-protect
           (progn
             (run:simulator 'cat :rate :free :seed 5 :display nil)
             (is (has-words-p (herd-refusal (eval '(robot:defrobot owl (pound (3 3) 0))))
                              "CAT is in the cell of")))
        (run:stop-simulator)
        (setf time:*simulation* nil world:*world* nil)))))
