;;;; seeing-robots.lisp -- robots that see, follow and approach one another (manual 3.4).

(in-package :ars-magna.tests)

(in-suite looking)

(world:defmap village-green (30 12)
  (rect (0 0) (29 11) bricks 20)
  (obj flag (20.5 5.5) ((:size 2) (:color blue)))
  (obj crate (3.5 5.5) ((:size 5) (:capacity 10) (:color green))))

(robot:defrobot surveyor (village-green (3.5 5.5) 0)
  :cameras ((2 40) (3 5)) :hands (10) :bins (20) :attributes ((:team blue)))
(robot:defrobot ranger (village-green (12.5 5.5) 0)
  :cameras ((6.2 9)) :hands (10 1/2) :bins (20 1/2)
  :attributes ((:color red) (:size 4) (:team red) (:capacity 50) (:closed t) (:substance 80)))
(robot:defrobot plain-robot (village-green (12.5 8.5) 0))
(robot:defrobot tall-screen (village-green (12.5 2.5) 0)
  :cameras ((6.2 9)) :attributes ((:obsview t) (:substance 50)))

(defun answer-of (command &rest arguments)
  "Issue COMMAND with ARGUMENTS, let it end, and return what its continuation was called with: the
error code and the results, without the resource."
  (let ((answer nil))
    (apply command (append arguments (list (lambda (err resource &rest results)
                                             (declare (ignore resource))
                                             (setf answer (cons err results))))))
    (run:run-until (lambda () answer) :limit 200)
    answer))

(defun eye-of (robot) (robot:robot-camera robot 0))

(defun seen-by (robot type specification)
  "Return designators of all that the camera of ROBOT sees of TYPE that fits SPECIFICATION."
  (second (answer-of 'command:camera-get-all-object-designators
                     (eye-of robot) type specification)))

(defun names-seen-by (robot type specification)
  (loop for designator in (seen-by robot type specification)
        collect (world:thing-name (robot:designator-denotation designator))))

(test robots-seen.fit-specifications-as-things-do
  (run:with-simulation ((surveyor ranger plain-robot) :clean t)
    (setf base:scan-density* 400)
    (is (equal '(ranger) (names-seen-by surveyor :non-local '((:color red)))))
    (is (equal '(ranger) (names-seen-by surveyor :non-local '((:team red) (:size (3 5))))))
    (is (equal '() (names-seen-by surveyor :non-local '((:team blue)))) "it never finds itself")
    (is (equal '(plain-robot ranger)
               (sort (names-seen-by surveyor :non-local '((:obsmove t))) #'string<)))
    (is (equal '(flag plain-robot ranger)
               (sort (names-seen-by surveyor :non-local '()) #'string<)))
    (is (equal '(surveyor) (names-seen-by ranger :non-local '((:team blue)))))
    (is (equal '(crate) (names-seen-by surveyor :local '())))
    (is (equal '((:team red) (:color red))
               (last (robot:designator-data
                      (first (seen-by surveyor :non-local '((:team red) (:color red))))) 2)))))

(test robots-seen.are-known-by-their-undeclared-attributes
  "No warning says that nothing has :TEAM."
  (run:with-simulation ((surveyor ranger) :clean t)
    (seen-by surveyor :non-local '((:team red)))
    (is (not (find :warning (base:take-messages) :key #'base:message-kind)))
    (seen-by surveyor :non-local '((:crew red)))
    (is (find :warning (base:take-messages) :key #'base:message-kind))))

(test robots-seen.nearby-are-local
  (run:with-simulation ((surveyor ranger) :clean t)
    (robot:place-robot surveyor 11.999 5.5 0)
    (is (equal '(ranger) (names-seen-by surveyor :local '())))
    (is (equal '(flag) (names-seen-by surveyor :non-local '())))
    (is (equal '(surveyor) (names-seen-by ranger :local '())))))

(test robots-seen.are-read-with-noise
  (run:with-simulation ((surveyor ranger) :seed 3)
    (let ((sizes (loop repeat 40
                       append (loop for designator in (seen-by surveyor :non-local '((:team red)))
                                    for size = (second (assoc :size (robot:designator-data
                                                                     designator)))
                                    when size collect size))))
      (is (< 10 (length sizes)))
      (is (< 5 (length (remove-duplicates sizes))))
      (is (< 2 (/ (reduce #'+ sizes) (length sizes)) 6)))))

(test robots-seen.can-be-missed-by-chance
  (run:with-simulation ((surveyor ranger) :clean t)
    (setf base:no-sensor-error* nil base:miss-thing-prob* 1)
    (is (equal '() (names-seen-by surveyor :non-local '())))))

(test robots-seen.are-followed-by-a-track
  (run:with-simulation ((surveyor ranger) :clean t)
    (destructuring-bind (tracked untracked)
        (append (seen-by surveyor :non-local '((:color red)))
                (seen-by surveyor :non-local '((:color red))))
      (answer-of 'command:camera-track (eye-of surveyor) tracked)
      (answer-of 'command:robot-turn ranger 1)
      (is-true (robot:designator-valid-p untracked) "it has not driven yet")
      (answer-of 'command:robot-go-forward ranger 4)
      (is-false (robot:designator-valid-p untracked))
      (is-true (robot:tracking-p (eye-of surveyor) tracked))
      (multiple-value-bind (x y) (robot:robot-position ranger)
        (is (equal (list x y) (multiple-value-list (robot:designator-position tracked))))
        (is (< (abs (- (atan (- y 5.5) (- x 3.5)) (robot:designator-angle tracked))) 1d-6))
        (is (= (robot:camera-angle (eye-of surveyor)) (robot:designator-angle tracked)))))))

(test robots-seen.are-lost-when-they-jump-or-hide
  (flet ((lost-after (x y)
           (let ((code :tracking))
             (run:with-simulation ((surveyor ranger) :clean t)
               (world:make-new-thing 'wall '(village-green 12.5 8.5) '((:obsview t)))
               (let ((designator (first (seen-by surveyor :non-local '((:color red))))))
                 (command:camera-track (eye-of surveyor) designator
                                       (lambda (err &rest more)
                                         (declare (ignore more))
                                         (setf code err)))
                 (run:run-ticks 6)
                 (robot:place-robot ranger x y 0)
                 (run:run-ticks 2)
                 code)))))
    (is (eq nil (lost-after 13.5 5.5)))
    (is (eq :lost-track (lost-after 2.5 9.5)) "it moves too fast")
    (is (eq :lost-track (lost-after 21.5 11.2)) "it is behind the wall, seen from the surveyor")))

(test robots-seen.are-approached
  (run:with-simulation ((surveyor ranger) :clean t)
    (let ((designator (first (seen-by surveyor :non-local '((:color red))))))
      (answer-of 'command:camera-track (eye-of surveyor) designator)
      (is (eq nil (first (answer-of 'command:robot-goto-designator surveyor (eye-of surveyor)))))
      (is (< (abs (- 12 (robot:robot-x surveyor))) .001) "next to it")
      (is (null (robot:camera-tracks (eye-of surveyor))))
      (is (equal '(ranger) (names-seen-by surveyor :local '((:color red)))))
      (is (eq :robot-blocked (first (answer-of 'command:robot-go-forward surveyor 2)))))))

(test robots-seen.are-approached-while-they-drive
  (run:with-simulation ((surveyor ranger) :clean t)
    (answer-of 'command:robot-turn ranger 1/2)
    (answer-of 'command:robot-set-speed ranger .3)
    (let ((designator (first (seen-by surveyor :non-local '((:color red))))))
      (answer-of 'command:camera-track (eye-of surveyor) designator)
      (command:robot-go-forward ranger 12)
      (is (eq nil (first (answer-of 'command:robot-goto-designator surveyor (eye-of surveyor)))))
      (is-true (robot:within-reach-p surveyor (robot:robot-x ranger) (robot:robot-y ranger)))
      (is (/= (robot:robot-cell-index surveyor) (robot:robot-cell-index ranger))))))

(test robots-seen.hide-things-only-from-others
  (run:with-simulation ((surveyor tall-screen) :clean t)
    (setf base:scan-density* 400)
    (robot:place-robot tall-screen 12.5 5.5 0)
    (is (equal '(tall-screen) (names-seen-by surveyor :non-local '())) "it hides the flag")
    (is (equal '(crate flag surveyor)
               (sort (names-seen-by tall-screen :non-local '()) #'string<)))
    (robot:place-robot tall-screen 12.5 8.5 0)
    (let ((flag (first (seen-by surveyor :non-local '((:color blue))))))
      (answer-of 'command:camera-track (eye-of surveyor) flag)
      (robot:place-robot tall-screen 12.5 5.5 0)
      (run:run-ticks 2)
      (is-false (robot:designator-valid-p flag) "it is hidden now"))))

(test robots-seen.are-part-of-views
  (flet ((view (robot) (second (answer-of 'command:camera-view (eye-of robot)))))
    (run:with-simulation (surveyor :clean t)
      (is (every (lambda (pixel) (= 20 pixel)) (view surveyor))))
    (run:with-simulation ((surveyor ranger) :clean t)
      (is (find 50 (view surveyor) :test #'=) "the mean of 80 and the wall's 20")
      (is (find 20 (view surveyor) :test #'=)))
    (run:with-simulation ((surveyor tall-screen) :clean t)
      (robot:place-robot tall-screen 12.5 5.5 0)
      (is (find 50 (view surveyor) :test #'=))
      (is (every (lambda (pixel) (= 20 pixel)) (view tall-screen))))))

(test robots-seen.carry-things-that-nobody-else-sees
  (run:with-simulation ((surveyor ranger) :clean t)
    (let ((designator (first (seen-by surveyor :non-local '((:color blue)))))
          (flag (world:find-thing 'flag)))
      (world:move-thing flag (robot:robot-hand ranger 0))
      (is-false (robot:designator-valid-p designator))
      (is (equal '() (names-seen-by surveyor :non-local '((:color blue)))))
      (robot:place-robot surveyor 11.999 5.5 0)
      (is (equal '() (names-seen-by surveyor :local '((:color blue)))))
      (is (equal '(flag) (names-seen-by ranger :local '((:color blue))))))))

(test robots-seen.are-not-inside-of-containers
  (run:with-simulation ((surveyor ranger) :clean t)
    (robot:set-robot-pose ranger 3.5 5.5 0)
    (let ((crate (first (seen-by surveyor :local '((:color green))))))
      (is (equal '(ranger) (names-seen-by surveyor :local '((:color red)))) "in the same cell")
      (answer-of 'command:camera-track (eye-of surveyor) crate)
      (is (eq nil (first (answer-of 'command:camera-insert (eye-of surveyor) crate))))
      (is (equal '() (names-seen-by surveyor :local '()))))))

(test robots-seen.are-not-what-false-sightings-look-like
  "Nor does their number change which thing it is."
  (macrolet ((things (&rest robots)
               `(run:with-simulation (,robots)
                  (let ((dice (base:make-dice 5)) (world (robot:robot-world surveyor)))
                    (world:make-new-thing 'late '(village-green 5 5) '())
                    (loop repeat 60
                          collect (world:thing-name (robot::random-thing world dice)))))))
    (let ((things (things surveyor)))
      (is (equal '(crate flag late) (sort (remove-duplicates things) #'string<)))
      (is (equal things (things surveyor ranger)))
      (is (equal things (things surveyor ranger plain-robot))))))

;;; Parts and designators of another robot.

(test commands.refuse-parts-and-designators-of-another-robot
  (run:with-simulation ((surveyor ranger) :clean t)
    (let ((designator (first (seen-by surveyor :non-local '((:color red))))))
      (flet ((told (&rest call)
               (handler-case (progn (apply #'funcall call) "")
                 (base:misuse (trouble) (princ-to-string trouble)))))
        (is-true (has-words-p (told 'command:hand-grasp-desig (robot:robot-hand surveyor 0)
                                    (eye-of ranger) designator)
                              "hand-grasp-desig: Camera 0 belongs to RANGER"
                              "SURVEYOR needs a part of its own"))
        (is-true (has-words-p (told 'command:camera-track (eye-of ranger) designator)
                              "belongs to SURVEYOR"
                              "RANGER needs a designator from a search of its"))
        (is-true (has-words-p (told 'command:robot-goto-designator surveyor (eye-of ranger))
                              "Camera 0 belongs to RANGER"))
        (is-true (has-words-p (told 'command:hand-insert-bin (robot:robot-hand surveyor 0)
                                    (robot:robot-storage-bin ranger 0))
                              "Storage-bin 0 belongs to RANGER"))
        (is-true (has-words-p (told 'command:hand-give (robot:robot-hand ranger 0) designator
                                    :hand 0)
                              "belongs to SURVEYOR"))))))

;;; Attributes of robots.

(test attributes.of-robots-are-those-of-their-bodies
  (run:with-simulation ((surveyor ranger) :clean t)
    (is (eq 'red (world:get-attribute ranger :color)))
    (is (eq 'green (setf (world:get-attribute ranger :color) 'green)))
    (is (eq ranger (world:change-attribute ranger '((:size 7) (:battery 3)))))
    (is (equal '(green 7 3) (loop for key in '(:color :size :battery)
                                  collect (world:get-attribute (robot:robot-body ranger) key))))
    (is (equal '(ranger) (names-seen-by surveyor :non-local '((:color green)))))
    (world:set-attribute ranger :obsview t)
    (is (equal '(ranger) (names-seen-by surveyor :non-local '())) "it hides the flag now")
    (is (zerop (world:thing-capacity (robot:robot-body ranger))))))

(test attributes.of-a-robot-alone-are-those-of-its-definition
  (run:with-simulation (ranger :clean t)
    (is (eq 'red (world:get-attribute ranger :color)))
    (is (null (world:get-attribute ranger :battery)))
    (signals base:misuse (world:set-attribute ranger :color 'green))
    (signals base:misuse (world:change-attribute ranger '((:size 7)))))
  (signals base:wrong-argument (world:get-attribute 'ranger :color)))
