;;;; rpl-images.lisp -- trees of tasks as data and as pictures.

(in-package :ars-magna.tests)
(in-suite rpl)

(defun image-until (tick &rest options)
  "Return the image of the tasks of SEEN-BOSS at TICK, and its rows."
  (let ((image (apply #'rpl:image-of-tasks (seen-until tick) options)))
    (values image (rpl:tree-image-rows image))))

(test images.have-a-row-for-each-task
  (multiple-value-bind (image rows) (image-until 3)
    (is (= 1 (rpl:tree-image-plans image)))
    (is (= (length rows) (rpl:tree-image-tasks image)))
    (is (= 3 (rpl:tree-image-tick image)))
    (is (equal '(0 1) (list (rpl:task-image-depth (first rows))
                            (rpl:task-image-depth (second rows)))))
    (is (= 4 (rpl:task-image-parts (first rows))))
    (let ((arm (find 3 rows :key #'rpl:task-image-serial)))
      (is (equal "valve arm" (rpl:task-image-awaits arm)))
      (is (= 0 (rpl:task-image-since arm)))
      (is (equal "seen-boss" (first (rpl:task-image-path arm)))))))

(test images.say-how-tasks-are
  (let ((looks (mapcar #'rpl:task-image-look (nth-value 1 (image-until 4)))))
    (is (member :waiting looks))
    (is (member :blocked looks))
    (is (member :cleaning looks))))

(test images.fold-and-count-what-they-leave-out
  (multiple-value-bind (image rows) (image-until 3 :folded '(1))
    (is (= 1 (length rows)))
    (is (rpl:task-image-folded-p (first rows)))
    (is (< 1 (rpl:tree-image-tasks image))))
  (is (= 2 (length (nth-value 1 (image-until 3 :most 2))))))

(test images.of-thousands-of-tasks-have-few-rows
  (let* ((runner (seen-until 1 :trace nil
                               :plan (rpl:make-plan
                                      '(rpl:par-loop (i (loop for i below 10000 collect i))
                                        (rpl:wait-time 2)))))
         (image (rpl:image-of-tasks runner)))
    (is (= 300 (length (rpl:tree-image-rows image))))
    (is (< 10000 (rpl:tree-image-tasks image)))))

(test images.know-the-calls-that-tasks-are-in
  (run:call-with-simulation
   (lambda ()
     (ars-magna.rpl-robot:begin-plan 'ars-user::dawdle 9)
     (run:run-ticks 2)
     (let ((row (first (rpl:tree-image-rows
                        (rpl:image-of-tasks (ars-magna.rpl-robot:rpl-runner))))))
       (is (equal "dawdle" (rpl:task-image-name row)))))
   '(ars-user::butler)))

(test images.change-their-mark-when-tasks-go-on
  (let* ((runner (seen-until 3)) (mark (rpl:runner-change-mark runner)))
    (is (equal mark (rpl:runner-change-mark runner)))
    (rpl:advance-timers runner 7)
    (rpl:react-to-all runner)
    (is (not (equal mark (rpl:runner-change-mark runner))))))

;;; Pictures.

(test task-tree.shows-tasks-and-what-they-wait-for
  (uiop:with-temporary-file (:pathname path :type "svg")
    (ars-magna.rpl-pictures:save-plan-tree path :runner (seen-until 3))
    (let ((text (uiop:read-file-string path)))
      (is (eql 0 (search "<svg" text)))
      (is-true (has-words-p text "1 seen-boss" "waits for valve arm since tick 0" "1 plan"
                            "Fold the parts of task 1 away")))
    (ars-magna.rpl-pictures:save-plan-tree path :runner (seen-until 3) :most 2)
    (is (search "not shown: folded, or beyond the limit" (uiop:read-file-string path)))
    (signals base:wrong-argument (ars-magna.rpl-pictures:save-plan-tree path :most 0))))

(test task-tree.marks-stand-out-on-white
  "No mark has a contrast below 3 with what it lies on."
  (flet ((light (color)
           (flet ((part (position weight)
                    (let ((value (/ (ldb (byte 8 position) color) 255d0)))
                      (* weight (if (<= value 0.04045d0)
                                    (/ value 12.92d0)
                                    (expt (/ (+ value 0.055d0) 1.055d0) 2.4d0))))))
             (+ (part 16 0.2126d0) (part 8 0.7152d0) (part 0 0.0722d0)))))
    (loop for (nil color) in ars-magna.rpl-pictures::*task-looks*
          do (is (<= 3 (/ 1.05d0 (+ 0.05d0 (light color))))))))

(test timeline.fits-a-narrow-place
  (let* ((runner (seen-until 30))
         (page (ars-magna.rpl-pictures:make-timeline-page (rpl:bars (rpl:plan-trace runner)) 100))
         (scale (ars-magna.rpl-pictures:timeline-page-scale page 360)))
    (is (= 0 (ars-magna.rpl-pictures:page-start page)))
    (is (= 22 (ars-magna.rpl-pictures:page-end page)))
    (is (null (ars-magna.rpl-pictures:tick-at 20 scale)))
    (is (= 11 (ars-magna.rpl-pictures:tick-at (ars-magna.rpl-pictures::x-of-tick 11 scale) scale)))
    (is (<= (ars-magna.rpl-pictures::x-of-tick 22 scale) 340))
    (is (null (ars-magna.rpl-pictures:tick-at 359 scale)))))
