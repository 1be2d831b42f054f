;;;; run-pictures.lisp -- pictures of a run, with what happened where.

(in-package :ars-magna.tests)

(in-suite display)

(test run-picture.numbers-places-where-something-was
  (in-studio (robot)
    (journal-of-a-drive robot)
    (with-scratch-file (file "svg")
      (ars:save-run-picture file :title "A drive & more" :layers '(:title)
                                 :moments (list (display:make-moment 3 :note "here" 2 2)
                                                (display:make-moment 4 :note "there" 2.1 2)
                                                (display:make-moment 9 :note "far" 6 6)))
      (let ((text (uiop:read-file-string file)))
        (dolist (part '("A drive &amp; more" ">1</text>" ">2</text>" "tick 4: there"))
          (is (mentions-p text part)))
        (is (not (mentions-p text ">3</text>")))))))

(defun run-picture (&rest options)
  "Return the text of a picture of the current run."
  (with-scratch-file (file "svg")
    (apply #'ars:save-run-picture file options)
    (uiop:read-file-string file)))

(defun notes-in (picture)
  "Return the texts in PICTURE that are neither numbers nor names, in order."
  (remove-if-not (lambda (text) (some (lambda (word) (mentions-p text word))
                                      '("tick" "Not shown" "moments")))
                 (mapcar (lambda (text) (of-element text :text)) (drawn-with :text picture))))

(defun moments-at (count)
  "Return COUNT moments of failures at one place, and a grasp and a note at another."
  (append (loop for tick from 1 to count
                collect (display:make-moment tick :failure "Robot is blocked" 3 3 nil
                                             :robot-blocked))
          (list (display:make-moment 2 :grasp "grasped a pen" 6 6)
                (display:make-moment 3 :note "halfway" 6 6))))

(test run-picture.has-a-line-for-what-is-the-same-at-a-place
  (in-studio (robot)
    (run:run-ticks 20)
    (let ((notes (notes-in (run-picture :layers '() :moments (moments-at 15)))))
      (is (equal '("ticks 1, 2, 3 and 12 more: Robot is blocked" "tick 2: grasped a pen"
                   "tick 3: halfway")
                 notes)))))

(test run-picture.leaves-out-what-matters-least-and-counts-it
  (in-studio (robot)
    (run:run-ticks 20)
    (let ((notes (notes-in (run-picture :layers '() :moments (moments-at 15) :limit 2))))
      (is (equal '("tick 2: grasped a pen" "tick 3: halfway"
                   "Not shown: 15 failures of commands.")
                 notes)))))

(test run-picture.never-leaves-out-a-users-own-moments
  "However low the limit is; and without one, all ticks are told."
  (in-studio (robot)
    (run:run-ticks 20)
    (let ((own (loop for x from 2 to 6 collect (display:make-moment x :note "look here" x 4))))
      (is (= 5 (count-if (lambda (note) (mentions-p note "look here"))
                         (notes-in (run-picture :layers '() :limit 2 :moments own)))))
      (is (mentions-p (run-picture :layers '() :limit 2 :moments (append own (moments-at 15)))
                      "Not shown: 1 grasp")))
    (is (mentions-p (run-picture :layers '() :limit nil :moments (moments-at 5))
                    "ticks 1, 2, 3, 4, 5: Robot is blocked"))))

(test run-picture.shows-the-kinds-that-are-chosen
  (in-studio (robot)
    (ungrasp-nothing robot)
    (is (= 1 (length (notes-in (run-picture :layers '())))))
    (is (null (notes-in (run-picture :layers '() :kinds '(:grasp :plan)))))
    (signals base:wrong-argument (run-picture :kinds '(:grasps)))
    (signals base:wrong-argument (run-picture :limit -1))))

(test run-picture.puts-a-users-words-where-the-robot-was
  (in-studio (robot)
    (journal-of-a-drive robot)
    (let ((picture (run-picture :layers '() :moments '((7 "half way")))))
      (is (= 2 (length (remove "1" (drawn-with :text picture)
                               :key (lambda (text) (of-element text :text)) :test-not #'equal)))
          "On the map and before the words."))))

(test run-picture.has-a-number-for-each-place-where-a-robot-was
  "Also where it was less than a metre from the last one."
  (in-studio (robot)
    (command:robot-go-forward robot 5)
    (run:run-ticks 20)
    (let ((picture (run-picture :layers '() :kinds '()
                                :moments (loop for tick from 1 to 7
                                               collect (list tick (format nil "note ~D" tick))))))
      (is (< 3 (loop for number from 1 to 7
                     count (mentions-p picture (format nil ">~D</text>" number))))))))

(test pictures.of-a-run-with-other-definitions-are-made-anyway
  (with-own-definitions
    (flet ((define (width)
             (eval `(world:defmap moved (,width 9) (rect (0 0) (,(1- width) 8) bricks 1)))
             (eval '(robot:defrobot mover (moved (2.5 2.5) 0)))))
      (define 9)
      (let ((journal (run:call-with-simulation
                      (lambda () (run:run-ticks 3)
                        (run:simulation-journal (time:current-simulation)))
                      '(mover) :journal t)))
        (define 12)
        (with-scratch-file (svg "svg")
          (signals run:different-definitions (ars:save-run-picture svg :journal journal))
          (dolist (save (list (lambda (journal)
                                (ars:save-run-picture svg :journal journal :anyway t))
                              (lambda (journal) (ars:save-animation journal svg :anyway t))))
            (is-true (funcall save journal))
            (is (mentions-p (uiop:read-file-string svg) "is repeated with definitions")))
          (is (null (ars:journal-moments journal :anyway t)))
          (delete-file svg)
          (is-true (ars:save-trajectory svg :journal journal :anyway t)))))))

(test way-picture.refuses-what-is-no-way-on-its-map
  (flet ((refusal (ways)
           (handler-case (ars:save-way-picture 'ars-worlds:tiny ways "way.svg")
             (base:wrong-argument (condition) (princ-to-string condition)))))
    (is-true (has-words-p (refusal '(((2 2) (50 60)))) "(50 60)" "map tiny" "x from 0 to 12"))
    (is (not (find #\~ (refusal '(nil)))))))

(test run-picture.keeps-numbers-on-the-smallest-map
  "Where the map is as large as a number, that is wholly on it; on a smaller one, in its middle."
  (loop for (scale least) in '((40 9) (20 9) (10 5))
        do (let ((middle (/ scale 2)))
             (dolist (at (trails::number-position (list 0 0 scale scale) middle middle 4 '() '()))
               (is (<= least at (- scale least)))))))

(test run-picture.has-what-save-picture-has
  (in-studio (robot)
    (journal-of-a-drive robot)
    (let ((words (mapcar (lambda (text) (of-element text :text))
                         (drawn-with :text (run-picture)))))
      (dolist (word '("bricks 10" "box" "10"))
        (is (member word words :test #'string=) "~A" word))
      (is (some (lambda (word) (search " m" word)) words) "the scale bar"))
    (is (< (length (run-picture :scale 5 :layers '() :in-color nil)) (length (run-picture))))
    (is (not (mentions-p (run-picture :in-color nil) "#c22418")))))

(test way-picture.has-what-save-picture-has
  (in-studio (robot)
    (with-scratch-file (file "svg")
      (display:save-way-picture 'studio '(((2 2) (5 5)) ((3 3) (8 8))) file :scale 10)
      (let ((words (mapcar (lambda (text) (of-element text :text))
                           (drawn-with :text (uiop:read-file-string file)))))
        (dolist (word '("studio" "way 1" "way 2" "box" "bricks 10" "20"))
          (is (member word words :test #'string=) "~A" word)))
      (display:save-way-picture 'studio '() file :layers '())
      (is (null (drawn-with :text (uiop:read-file-string file))))
      (is (mentions-p (handler-case (display:save-way-picture 'studio '(nil) file)
                        (base:wrong-argument (condition) (text-of condition)))
                      "FIND-WAY")))))

(test run-picture.names-no-ways-of-robots-that-never-moved
  (in-studio (robot)
    (run:run-ticks 3)
    (is (not (or (mentions-p (run-picture) "its way")
                 (mentions-p (run-picture) "start of a way")))))
  (in-studio (robot)
    (journal-of-a-drive robot)
    (is (mentions-p (run-picture) "studio-robot and its way"))
    (is (mentions-p (run-picture) "start of a way"))))

(test run-picture.has-rings-around-what-lies-where-something-happened
  "So what was grasped and let go of is seen: the ring is larger than it."
  (in-studio (robot)
    (let* ((snapshot (display:snapshot-of robot)) (canvas:graphics-scale* 20)
           (image (aref (display:snapshot-things snapshot) 0))
           (x (* 20 (display:thing-image-x image))) (y (* 20 (display:thing-image-y image))))
      (is (< (display:thing-half-width image) (trails::ring-radius snapshot (+ x 2) y)))
      (is (= trails::+ring-radius+ (trails::ring-radius snapshot (+ x 200) y)))
      (is (null (drawn-with :ellipse
                            (format nil "~{~A~}"
                                    (drawing (canvas)
                                      (trails::draw-spot canvas 50 50 9 '(80 80) "1")))
                            :cx 50 :fill "#000000"))))))

(test run-picture.documentation-lists-all-kinds-of-moments
  (let ((text (documentation 'ars:save-run-picture 'function)))
    (dolist (kind display::+moment-kinds+)
      (is (search (format nil "~S" kind) text) "~S" kind)
      (is-true (assoc kind trails::*moment-kind-nouns*)))))

(test run-picture.tells-two-robots-apart
  (run:with-simulation ((ars-worlds:marvin ars-worlds:gofer) :seed 3 :journal t)
    (command:robot-go-forward ars-worlds:marvin 99)
    (command:robot-go-forward ars-worlds:gofer 99)
    (run:run-ticks 60)
    (let* ((picture (run-picture))
           (ways (loop for line in (drawn-with :polyline picture)
                       unless (equal "#ffffff" (of-element line :stroke))
                         collect (list (of-element line :stroke)
                                       (of-element line :stroke-dasharray)))))
      (is (= 2 (length (remove-duplicates (mapcar #'first ways) :test #'equal))))
      (is (= 2 (length (remove-duplicates (mapcar #'second ways) :test #'equal))))
      (dolist (words '("marvin and its way" "gofer and its way"
                       "marvin: robot-go-forward: Robot is blocked"
                       "gofer: robot-go-forward: Robot is blocked"))
        (is (mentions-p picture words))))))
