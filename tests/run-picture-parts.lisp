;;;; run-picture-parts.lisp -- pictures of a part of a run, and what stands below them.

(in-package :ars-magna.tests)

(in-suite display)

(test picture.of-a-part-without-robots-is-called-by-its-map
  (in-studio (robot)
    (let ((picture (display:svg-picture robot :part '(12 0 20 4))))
      (is (not (mentions-p picture "NIL")))
      (is (mentions-p picture ">studio, tick 0<")))))

(test run-picture.of-a-part-counts-what-happened-outside
  (in-studio (robot)
    (ungrasp-nothing robot)
    (let ((picture (run-picture :part '(12 0 20 4))))
      (is (mentions-p picture "Not shown, outside of this part: 1 failure of a"))
      (is (not (mentions-p picture "Hand 0 is not holding"))))))

(test run-picture.of-a-part-names-only-ways-that-are-in-it
  (call-with-two-walkers
   (lambda (first second)
     (robot:place-robot second 10 5 0)
     (run:run-ticks 1)
     (walk-from-one-spot (list first second) 3 3)
     (let ((picture (run-picture :part '(9 0 20 6))))
       (is (mentions-p picture "walker-2 and its way"))
       (is (not (mentions-p picture "walker-1")))))))

(test bundle.of-a-part-counts-the-trials-outside
  (in-studio (robot)
    (command:robot-go-forward robot 3)
    (run:run-ticks 5)
    (flet ((words (part)
             (with-scratch-file (file "svg")
               (trails:save-picture-of-ways
                'save-ways-picture "trial" file (display:snapshot-of robot)
                (lambda () (list (trails::make-way 1 "failure" '(((2 . 6) (5 . 6))))
                                 (trails::make-way 2 "success" '(((2 . 7) (5 . 7))))))
                "Title" "Words." :part part)
               (uiop:read-file-string file))))
      (is (mentions-p (words nil) "failed: 1 trial"))
      (is (mentions-p (words nil) "start of a way"))
      (is (not (mentions-p (words nil) "Not shown")))
      (is (not (mentions-p (words '(12 0 20 4)) "failed")))
      (is (mentions-p (words '(12 0 20 4)) "ways of 2 trials.")))))

(test bundle.has-arrowheads
  (in-studio (robot)
    (flet ((heads (&rest ends)
             (length (drawn-with :polygon
                                 (format nil "~{~A~}"
                                         (drawing (canvas)
                                           (trails::draw-arrows-on-ways
                                            canvas
                                            (loop for end in ends
                                                  collect (trails::make-way
                                                           1 "success"
                                                           `(((2 . 6) (,end . 6))))))))))))
      (is (plusp (heads 9)))
      (is (< (heads 9 9 9 9 9 9 9 9 9) (* 9 (heads 9))) "No more than have room."))))

(test run-picture.tells-of-failures-briefly
  "Without code, and why only once."
  (let* ((why "failed: Plan failure :WILL-NOT-DO :COMMAND (SEQ (SETF TARGET 1))")
         (texts (mapcar #'display:moment-text
                        (trails::abridge-failures
                         (list (display:make-moment 3 :part (format nil "task (fetch) ~A" why))
                               (display:make-moment 5 :plan (format nil "plan (fetch) ~A" why))
                               (display:make-moment 6 :grasp "grasped what failed: A"))))))
    (is (equal '("task (fetch) failed: will-not-do" "plan (fetch) failed by that"
                 "grasped what failed: A")
               texts))))
