;;;; ways-going.lisp -- robots sent along ways: by programs, and at the prompt; pictures.

(in-package :ars-magna.tests)

(in-suite ways)

(defun going-trial (x y seed &key clean (options '()))
  "Send MARVIN to (X,Y). Return the error code, or :THERE, and how far from there it really is."
  (let ((answers '()))
    (run:with-simulation (ars-worlds:marvin :seed seed :clean clean)
      (apply #'ars-worlds:robot-go-to ars-worlds:marvin x y
             (lambda (err robot) (push (list (or err :there) robot) answers))
             options)
      (run:run-until (lambda () answers) :limit 2000)
      (multiple-value-bind (at-x at-y) (robot:robot-position ars-worlds:marvin)
        (is (= 1 (length answers)))
        (is (eq ars-worlds:marvin (second (first answers))))
        (values (first (first answers))
                (ars:way-length (list (list x y) (list at-x at-y))))))))

(defun there-p (x y seed &rest options)
  (multiple-value-bind (answer distance) (apply #'going-trial x y seed options)
    (and (eq :there answer) (< distance 2))))

(test going.always-arrives-in-the-default-office
  (loop for (x y) in '((109 24) (108.5 70.5) (10 25) (95 28))
        do (loop for seed from 1 to 5
                 do (is-true (there-p x y seed) "(~A,~A), seed ~D" x y seed))))

(defun way-of-marvin ()
  "Return how many points the way has that MARVIN is about to go."
  (length (robot:robot-planned-way ars-worlds:marvin)))

(test going.shows-its-way-until-it-is-over
  (let ((answers '()))
    (run:with-simulation (ars-worlds:marvin :seed 1)
      (ars-worlds:robot-go-to ars-worlds:marvin 109 24
                              (lambda (err robot) (push (list err robot) answers)))
      (is (< 2 (way-of-marvin)))
      (run:run-ticks 10)
      (let ((fork (run:fork-simulation)) (digest (run:state-digest)))
        (run:call-in-fork fork (lambda () (is (< 2 (way-of-marvin)) "forks have it, too")))
        (robot:publish-way ars-worlds:marvin '())
        (is (= digest (run:state-digest)) "it decides nothing"))
      (run:run-until (lambda () answers) :limit 2000)
      (is (zerop (way-of-marvin))))))

(test going.shows-no-way-after-an-interruption
  (run:with-simulation (ars-worlds:marvin :seed 1)
    (ars-worlds:robot-go-to ars-worlds:marvin 109 24 nil)
    (run:run-ticks 10)
    (is (< 2 (way-of-marvin)))
    (command:robot-turn ars-worlds:marvin 1 nil)
    (run:run-ticks 1)
    (is (zerop (way-of-marvin)))))

(test planned-ways.what-is-left-begins-where-the-robot-is
  (flet ((left (x y) (robot::remaining-points '((0 0) (4 0) (4 6)) x y)))
    (is (equalp '((0 0) (4 0) (4 6)) (left -1 2)))
    (is (equalp '((3 0) (4 0) (4 6)) (left 3 0.5)))
    (is (equalp '((4 2) (4 6)) (left 5 2)))
    (is (equalp '((4 6)) (remove-duplicates (left 4 9) :test #'equalp)))
    (is (equal '() (robot::remaining-points '() 1 1)))))

(test publish-way.is-taken-back-by-what-interrupts-the-robot
  "Also where the program that published it has not noticed."
  (run:with-simulation (ars-worlds:marvin :seed 1)
    (command:robot-go-forward ars-worlds:marvin 20 nil)
    (run:run-ticks 5)
    (robot:publish-way ars-worlds:marvin (list '(1 2) (geo:make-pt 3 4)))
    (run:run-ticks 5)
    (is (equal '((1d0 2d0) (3d0 4d0)) (robot:robot-planned-way ars-worlds:marvin)))
    (command:robot-turn ars-worlds:marvin 1 nil)
    (run:run-ticks 1)
    (is (zerop (way-of-marvin)))
    (signals base:wrong-argument (robot:publish-way ars-worlds:marvin '((1 2 3))))
    (signals base:wrong-argument (robot:publish-way nil '()))))

(test travel-to.shows-its-way-until-it-is-killed
  (run:with-simulation (ars-worlds:marvin :seed 1)
    (let ((plan (ars-magna.rpl-robot:begin-plan 'ars-worlds:patrol-places '((109 24)))))
      (run:run-ticks 10)
      (is (< 2 (way-of-marvin)))
      (ars-magna.rpl-robot:end-plan plan)
      (run:run-ticks 2)
      (is (zerop (way-of-marvin))))))

(test going.arrives-without-noise-as-near-as-wanted
  (multiple-value-bind (answer distance)
      (going-trial 109 24 1 :clean t :options '(:tolerance 1/10))
    (is (eq :there answer))
    (is (< distance 1/10))))

(test going.says-why-it-ends
  (is (eq :no-way (let ((seed 1))
                    (world:defmap apart (9 5)
                      (rect (0 0) (8 4) stone 1)
                      (wall (4 0) (4 4) stone 1))
                    (robot:defrobot settler (apart (2.5 2.5) 0) :cameras ((1 5)))
                    (let ((answer nil))
                      (run:with-simulation (settler :seed seed)
                        (ars-worlds:robot-go-to settler 6.5 2.5
                                                (lambda (err robot)
                                                  (declare (ignore robot))
                                                  (setf answer err)))
                        (run:run-ticks 50))
                      answer))))
  (run:with-simulation (ars-worlds:marvin :seed 1)
    (let ((answer nil))
      (ars-worlds:robot-go-to ars-worlds:marvin 109 24
                              (lambda (err robot) (declare (ignore robot)) (setf answer err)))
      (run:run-ticks 20)
      (ars:robot-turn ars-worlds:marvin 1)
      (run:run-ticks 20)
      (is (eq :interrupt answer)))
    (signals base:wrong-argument
      (ars-worlds:robot-go-to ars-worlds:marvin 500 1 #'list))))

(test going.is-decided-by-the-seed
  (flet ((distance (seed) (nth-value 1 (going-trial 109 24 seed))))
    (is (= (distance 3) (distance 3)))
    (is (/= (distance 3) (distance 4)))))

(test go-to.is-a-line-of-the-prompt
  (is-true (has-words-p (complaint "go-to 3") "GO-TO x y" "y"))
  (is-true (has-words-p (complaint "go-to 300 7") "300" "point")))

(defun occurrences (word text)
  (loop for place = (search word text) then (search word text :start2 (1+ place))
        while place count t))

(test pictures.show-ways-on-the-map
  (uiop:with-temporary-file (:pathname file :type "svg")
    (flet ((lines (&rest ways)
             (ars:save-way-picture 'two-doors ways file :scale 10 :layers '())
             (occurrences "<p" (base:file-text file))))
      (let ((way (ars:find-way 'two-doors '(3 5.5) '(17 5.5))))
        ;; Two for each: it has a halo.
        (is (= (+ 4 (lines way)) (lines way '((3 3) (4 4)) '((5 5) (6 6)))))
        (is (search "210" (base:file-text file)))
        (signals base:wrong-argument (lines '((1 2 3))))
        (signals base:wrong-argument (ars:save-way-picture 'two-doors (list way) "a.gif"))))))

(test going.leaves-no-error-about-a-camera-that-has-lost-its-doorway
  (run:with-simulation (ars-worlds:marvin :seed 0)
    (let ((answers '()))
      (ars-worlds:robot-go-to ars-worlds:marvin 109 24
                              (lambda (err robot) (declare (ignore robot)) (push err answers)))
      (run:run-until (lambda () answers) :limit 2000)
      (is (equal '(nil) answers))
      (let ((messages (base:take-messages)))
        (is-true (find :warning messages :key #'base:message-kind) "the camera loses it")
        (is (null (find :error messages :key #'base:message-kind)))))))

(defun answers-of-journey (tick then)
  "Send MARVIN through a doorway, and call THEN after TICK ticks. Return what it is told of that in
the end, a list, and the errors about runs that are over."
  (let ((answers '()) (queue nil))
    (run:with-simulation (ars-worlds:marvin :seed 1 :keep t)
      (setf queue (run:simulation-messages time:*simulation*))
      (ars-worlds:robot-go-to ars-worlds:marvin 109 24
                              (lambda (err robot) (declare (ignore robot)) (push err answers)))
      (run:run-ticks tick)
      (funcall then))
    (values answers
            (remove-if-not (lambda (message) (search "is over" (base:message-text message)))
                           (base:take-messages queue)))))

(defun is-told-once (what then)
  "Check that who sends MARVIN is told once, whenever THEN is called, which does WHAT to its run."
  (loop for tick from 20 to 100
        do (multiple-value-bind (answers errors) (answers-of-journey tick then)
             (is (equal '(:interrupt) answers) "tick ~D, its run ~A" tick what)
             (is (null errors) "tick ~D, its run ~A: ~A" tick what errors))))

(test going.is-told-once-whatever-becomes-of-its-run
  "At each moment on the way through a doorway, also when only the camera has a command."
  (is-told-once "ends" (lambda ()))
  (is-told-once "is rewound" (lambda () (run:rewind 5) (run:run-ticks 10)))
  (is-told-once "is rewound by no tick" (lambda () (run:rewind 0)))
  (is-told-once "is forked" (lambda ()
                              (run:with-fork (:continuations t) (run:run-ticks 5)))))

;;; Another command to the robot ends it at once, also while a camera looks, or a speed is set.

(defun told-to-stop (robot begin tick)
  "Return what the continuation of BEGIN, a function of it, has got 30 ticks after ROBOT was told to
stop at TICK, and what that then does; NIL if it had ended by then."
  (let ((codes '()))
    (funcall begin (lambda (err robot) (declare (ignore robot)) (push err codes)))
    (run:run-ticks tick)
    (unless codes
      (command:robot-stop robot)
      (run:run-ticks 30)
      (list codes (command:under-way robot)))))

(defun going-stopped (begin tick)
  (run:with-simulation (ars-worlds:marvin :seed 1)
    (told-to-stop ars-worlds:marvin begin tick)))

(test errands.end-when-the-robot-is-told-to-stop
  (loop for tick from 0 to 60
        do (is (equal '((:interrupt) nil)
                      (run:with-simulation (ars-worlds:dot :seed 1)
                        (told-to-stop ars-worlds:dot
                                      (lambda (continuation)
                                        (ars-worlds:run-errand ars-worlds:dot '((:color red))
                                                               continuation))
                                      tick)))
               "~D" tick)))

(test going.ends-when-the-robot-is-told-to-stop
  (loop for tick from 0 to 140
        do (is (equal '((:interrupt) nil)
                      (going-stopped (lambda (continuation)
                                       (ars-worlds:robot-go-to ars-worlds:marvin 109 24
                                                               continuation))
                                     tick))
               "~D" tick)))

(test going.elsewhere-ends-the-way-that-it-was-on
  "Also where there is nothing to drive."
  (loop for (x y) in '((4 6) (3.5 6.5) (5 5))
        do (run:with-simulation (ars-worlds:dot :clean t)
             (let ((said '()))
               (flet ((note (name) (lambda (err robot)
                                     (declare (ignore robot))
                                     (push (list name err) said))))
                 (ars-worlds:robot-go-to ars-worlds:dot 10 10 (note :first))
                 (run:run-ticks 3)
                 (ars-worlds:robot-go-to ars-worlds:dot x y (note :second))
                 (run:run-ticks 100))
               (is (equal '((:first :interrupt) (:second nil))
                          (sort said #'string< :key #'first)))
               (is (null (command:under-way ars-worlds:dot)))))))

(test going.needs-nobody-to-tell
  (run:with-simulation (ars-worlds:dot :clean t)
    (ars-worlds:robot-go-to ars-worlds:dot 5 5 nil)
    (run:run-ticks 100)
    (command:robot-go-distance ars-worlds:dot 1)
    (run:run-ticks 100)
    (is (null (find :error (base:take-messages) :key #'base:message-kind)))))

(test reckonings.go-on-side-by-side
  (run:with-simulation (ars-worlds:dot :clean t)
    (let ((me (ars-worlds:begin-reckoning (ars-worlds:here ars-worlds:dot) ars-worlds:dot)))
      (flet ((believed () (mapcar #'round (ars-worlds:reckon me)))
             (true () (mapcar #'round (subseq (ars-worlds:here ars-worlds:dot) 0 2))))
        (loop for (x y) in '((5 5) (9 9) (4 6))
              do (ars-worlds:robot-go-to ars-worlds:dot x y nil)
                 (run:run-ticks 100)
                 (is (equal (true) (believed))))
        (loop repeat 8
              do (ars-worlds:begin-reckoning '(1 1 0) ars-worlds:dot))
        (signals base:misuse (believed))))))

(test going.refuses-what-it-cannot-use
  (run:with-simulation (ars-worlds:marvin)
    (loop for (robot x y . options) in `((rex 3 3) (,ars-worlds:marvin "a" 3)
                                         (,ars-worlds:marvin 3 nil)
                                         (,ars-worlds:marvin 3 3 :start (4))
                                         (,ars-worlds:marvin 3 3 :tolerance "x")
                                         (,ars-worlds:marvin 3 3 :patience 0))
          do (signals base:wrong-argument
               (apply #'ars-worlds:robot-go-to robot x y #'list options)))))
