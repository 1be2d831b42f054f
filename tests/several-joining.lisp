;;;; several-joining.lisp -- robots that join or leave a run, and where they may.

(in-package :ars-magna.tests)
(in-suite several-robots)

(defmacro with-pound (&body body)
  "Run BODY with a map of its own that has the robots CAT and DOG."
  `(with-own-definitions ()
     (eval '(world:defmap pound (20 20)))
     (eval '(robot:defrobot cat (pound (3 3) 0)))
     (eval '(robot:defrobot dog (pound (3 7) 0)))
     ,@body))

(defun herd-tick ()
  (run:simulation-tick time:*simulation*))

(defun pass-ticks-now (count)
  (run:run-ticks count time:*simulation*))

(defun robot-called (name)
  (symbol-value name))

(defun replayed-digest ()
  "Return the digest at the end of a replay of the current run, from memory and from a file."
  (let ((journal (run:journal-up-to-now time:*simulation*)))
    (with-temporary-file (file)
      (run:write-journal journal file)
      (let ((digest (nth-value 1 (run:replay journal))))
        (is (= digest (nth-value 1 (run:replay file))))
        digest))))

(defun operators-in-journal ()
  (mapcar #'second (run:journal-entries (run:journal-up-to-now time:*simulation*))))

(test joining.before-the-run-begins-is-no-entry
  (with-pound
    (eval '(robot:defrobot owl (pound (9 9) 0)))
    (with-stopped-run (cat)
      (is (= 3 (length (getf (run:journal-header (run:simulation-journal time:*simulation*))
                             :robots))))
      (is (null (operators-in-journal)))
      (is (= (run:state-digest) (replayed-digest))))))

(test joining.is-repeated-in-the-same-tick
  (with-pound
    (with-stopped-run (cat :keep t)
      (command:robot-turn (robot-called 'cat) 9)
      (command:robot-go-forward (robot-called 'dog) 9)
      (pass-ticks-now 4)
      (let ((joined (herd-tick)))
        (eval '(robot:defrobot owl (pound (9 9) (/ pi 2))))
        (command:robot-go-forward (robot-called 'owl) 5)
        (pass-ticks-now 6)
        (is (equal '(command:robot-turn command:robot-go-forward run::robot-joined
                     command:robot-go-forward)
                   (operators-in-journal)))
        (is (equal (list joined 'run::robot-joined "ARS-MAGNA.TESTS::OWL" "ARS-MAGNA.TESTS::OWL"
                         9d0 9d0 (/ pi 2))
                   (third (run:journal-entries (run:journal-up-to-now time:*simulation*)))))
        (is (= 2 (length (getf (run:journal-header (run:simulation-journal time:*simulation*))
                               :robots))))
        (is (= (run:state-digest) (replayed-digest)))
        (run:with-replay ((run:journal-up-to-now time:*simulation*))
          (is (eq (robot-called 'owl) (third (run:simulation-robots))))
          (is (< 9 (robot:robot-y (robot-called 'owl)))))))))

(test joining.is-kept-by-rewinding-to-a-later-tick-and-undone-by-an-earlier
  (with-pound
    (with-stopped-run (cat :keep t)
      (command:robot-go-forward (robot-called 'dog) 9)
      (pass-ticks-now 4)
      (eval '(robot:defrobot owl (pound (9 9) 0)))
      (command:robot-go-forward (robot-called 'owl) 5)
      (pass-ticks-now 3)
      (let ((digest (run:state-digest)) (old (robot-called 'owl)))
        (pass-ticks-now 3)
        (run:rewind 3)
        (is (= digest (run:state-digest)))
        (is (not (eq old (robot-called 'owl))))
        (is (eq (robot-called 'owl) (third (run:simulation-robots))))
        (command:robot-turn (robot-called 'owl) 1)
        (pass-ticks-now 5)
        (is (= (run:state-digest) (replayed-digest)))
        (setf old (robot-called 'owl))
        (run:rewind 10)
        (is (equal '(cat dog) (mapcar #'robot:robot-name (run:simulation-robots))))
        (is-trouble ("rewound" "owl") (command:robot-turn old 1))
        (pass-ticks-now 5)
        (is (= (run:state-digest) (replayed-digest)))))))

(test leaving.and-redefinition-are-repeated
  (with-pound
    (with-stopped-run (cat :keep t)
      (command:robot-go-forward (robot-called 'dog) 9)
      (command:robot-turn (robot-called 'cat) 9)
      (pass-ticks-now 4)
      (command:robot-go-forward (robot-called 'cat) 4)
      (eval '(robot:defrobot cat (pound (3 3) 0)))
      (command:robot-turn (robot-called 'cat) 1)
      (pass-ticks-now 3)
      (ars:undefine 'robot 'dog)
      (pass-ticks-now 3)
      (is (equal '(command:robot-go-forward command:robot-turn run::robot-left run::robot-joined
                   command:robot-turn run::robot-left)
                 (operators-in-journal)))
      (let ((digest (run:state-digest)))
        (pass-ticks-now 4)
        (run:rewind 4)
        (is (= digest (run:state-digest)))
        (eval '(robot:defrobot dog (pound (3 7) 0)))
        (pass-ticks-now 4)
        (is (= (run:state-digest) (replayed-digest)))))))

(test rewinding.goes-over-two-definitions-of-one-robot
  "Forks repeat the earlier definition where it was in force, though the later one counts now."
  (with-pound
    (with-stopped-run (cat :keep t)
      (pass-ticks-now 2)
      (eval '(robot:defrobot dog (pound (9 9) 0) :hands (5)))
      (pass-ticks-now 2)
      (let ((digest (run:state-digest)))
        (eval '(robot:defrobot dog (pound (12 9) 0)))
        (pass-ticks-now 2)
        (run:rewind 2)
        (is (= 9 (robot:robot-x (robot-called 'dog))))
        (is (= 1 (length (robot:robot-hands (robot-called 'dog)))))
        (is (= digest (run:state-digest)))))))

;;; Robots of one cell in a resident world.

(test starts.in-one-cell-are-refused-by-simulator
  (with-pound
    (eval '(robot:defrobot owl (pound (3.5 3.5) 0)))
    (is-true (has-words-p (herd-refusal (run:simulator 'cat :display nil))
                          "CAT and OWL would start in one cell" ":ghosts t"))
    (with-stopped-run (cat :ghosts t)
      (is (null (robot:robot-body (robot-called 'cat)))))
    (run:with-simulation ((list 'owl))
      (is (= 3.5 (robot:robot-x (first (run:simulation-robots))))))
    (is-true (has-words-p (herd-refusal (run:with-simulation ((list 'owl 'cat)))) "one cell"))))

(test starts.in-an-occupied-cell-of-a-run-are-refused
  (with-pound
    (with-stopped-run (cat)
      (pass-ticks-now 2)
      (robot:place-robot (robot-called 'cat) 12 12 0)
      (is-true (has-words-p (herd-refusal (eval '(robot:defrobot owl (pound (12.5 12.5) 0))))
                            "defrobot owl" "CAT is in the cell of (12.5 12.5)"))
      (is (null (robot:find-robot 'owl nil)))
      (let ((*load-truename* nil) (*load-pathname* nil))
        (is-true (has-words-p (herd-refusal (eval '(robot:defrobot dog (pound (12 12) 0))))
                              "CAT is in")))
      (is (eq (robot-called 'dog) (second (run:simulation-robots))) "the old robot is still there")
      (eval '(robot:defrobot cat (pound (12 12) 1)))
      (is (= 1 (robot:robot-angle (robot-called 'cat)))))
    (with-stopped-run (cat :ghosts t)
      (pass-ticks-now 2)
      (eval '(robot:defrobot owl (pound (12 12) 0)))
      (is (= 12 (robot:robot-x (robot-called 'owl)))))))

(test starts.are-free-when-a-file-is-loaded-again
  (uiop:with-temporary-file (:pathname path :type "lisp" :stream out)
    (write-string "(in-package :ars-magna.tests)
                   (world:defmap pound (20 20))
                   (robot:defrobot cat (pound (3 3) 0))
                   (robot:defrobot dog (pound (3 7) 0))"
                  out)
    :close-stream
    (with-own-definitions ()
      (load path)
      (with-stopped-run (cat)
        (pass-ticks-now 2)
        (robot:place-robot (robot-called 'cat) 9 9 0)
        (robot:place-robot (robot-called 'dog) 3 3 0)
        (robot:place-robot (robot-called 'cat) 3 7 0)
        (load path)
        (is (equal '(3d0 3d0)
                   (multiple-value-list (robot:robot-position (robot-called 'cat)))))))))

;;; Files from before robots had bodies.

(defun without-ghosts-mark (from to)
  "Copy FROM, a journal or saved run, to the file TO without the mark :GHOSTS, with new check sums."
  (let ((sum 0))
    (with-open-file (out to :direction :output :if-exists :supersede)
      (loop for line in (uiop:read-file-lines from)
            for first-p = t then nil
            do (cond (first-p (write-line line out))
                     (t (let ((datum (subseq line 0 (position #\; line :from-end t))))
                          (setf sum (run::write-checksummed-line
                                     (string-right-trim
                                      " " (without-part " ghosts nil" datum))
                                     sum out)))))))))

(defun without-part (part text)
  "Return TEXT without the first PART."
  (let ((start (search part text)))
    (if start
        (concatenate 'string (subseq text 0 start) (subseq text (+ start (length part))))
        text)))

(test files.of-several-robots-from-before-are-refused
  (dolist (save (list #'run:save-journal #'run:save-simulation))
    (with-temporary-file (file)
      (with-temporary-file (older)
        (dolist (path (list file older)) (uiop:delete-file-if-exists path))
        (run:with-simulation ((colt mare) :journal t)
          (run:run-ticks 3)
          (funcall save file))
        (without-ghosts-mark file older)
        (is-true (has-words-p (herd-refusal (if (eq save #'run:save-journal)
                                           (run:load-journal older)
                                           (run:load-simulation older)))
                              "several robots" "version 1.10" "record the run anew"))))))

;;; Robots that leave.

(test leaving.leaves-behind-what-was-held
  (with-pound
    (eval '(robot:defrobot owl (pound (9 9) 0) :hands (9) :bins (9)))
    (with-stopped-run (cat :keep t)
      (pass-ticks-now 2)
      (let ((owl (robot-called 'owl)))
        (dolist (part (list (robot:robot-hand owl 0) (robot:robot-storage-bin owl 0)))
          (world:make-new-thing 'nut part '((:size 1) (:weight 1)))))
      (pass-ticks-now 1)
      (ars:undefine 'robot 'owl)
      (dolist (nut (world:find-things 'nut))
        (is (eq :floor (world:thing-location nut)))
        (is (= 9 (world:thing-x nut))))
      (pass-ticks-now 2)
      (with-temporary-file (file) (is-true (run:save-simulation file))))))

(test leaving.is-repeated-if-the-definition-is-loaded
  (with-pound
    (let (journal digest)
      (with-stopped-run (cat)
        (pass-ticks-now 2)
        (eval '(robot:defrobot owl (pound (9 9) 0)))
        (pass-ticks-now 2)
        (ars:undefine 'robot 'owl)
        (pass-ticks-now 2)
        (setf journal (run:journal-up-to-now time:*simulation*)
              digest (run:state-digest)))
      (is-true (find "ARS-MAGNA.TESTS::OWL" (getf (run:journal-header journal) :definitions)
                     :key #'second :test #'equal))
      (eval '(robot:defrobot owl (pound (9 9) 0)))
      (is (= digest (nth-value 1 (run:replay journal)))))))

(test leaving.of-a-robot-that-joined-before-the-first-tick-is-saved
  (with-pound
    (with-messages
      (unwind-protect
           (progn
             (run:simulator 'cat :rate :free :seed 5 :display nil)
             (time:pause)
             (eval '(robot:defrobot owl (pound (9 9) 0)))
             (run:stop-simulator)
             (pass-ticks-now 2)
             (ars:undefine 'robot 'owl)
             (pass-ticks-now 2)
             (with-temporary-file (file) (is-true (run:save-journal file)))
             (with-temporary-file (file) (is-true (run:save-simulation file))))
        (setf time:*simulation* nil world:*world* nil)))))

(test leaving.that-was-rewound-can-be-repeated
  (with-pound
    (with-stopped-run (cat :keep t)
      (pass-ticks-now 4)
      (ars:undefine 'robot 'dog)
      (pass-ticks-now 4)
      (run:rewind 6)
      (is (= 2 (length (run:simulation-robots))))
      (is (eq 'dog (eval '(robot:defrobot dog (pound (3 7) 1)))))
      (is (= 2 (length (run:simulation-robots))))
      (is (= 1 (robot:robot-angle (robot-called 'dog)))))))

(test leaving.robots-have-bodies-that-can-be-printed
  (with-pound
    (with-stopped-run (cat)
      (let ((body (robot:robot-body (robot-called 'dog))))
        (ars:undefine 'robot 'dog)
        (is (null (world:thing-location body)))
        (is (equal "#<BODY DOG>" (prin1-to-string body)))))))
