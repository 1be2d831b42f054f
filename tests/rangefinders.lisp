;;;; rangefinders.lisp -- what rays meet, and what rangefinders read of it.

(in-package :ars-magna.tests)

(def-suite* rangefinders :in ars-magna)

(world:defmap cavern (20 14)
  (rect (0 0) (19 13) stone 5)
  (wall (8 3) (8 6) slate 20)
  (wall (12 9) (15 9) slate 20)
  (wall (3 9) (3 9) slate 20) (wall (4 10) (4 10) slate 20)      ; corner to corner
  (wall (14 4) (14 4) slate 20)                                  ; a corner alone
  (obj crate (5.5 11.5) ((:obsmove t) (:size 20)))
  (obj curtain (16.5 6.5) ((:obsview t) (:size 5)))
  (obj pebble (10.5 4.5) ((:size 1))))

(robot:defrobot bat-one (cavern (5.5 4.5) 0)
  :parts ((robot:rangefinder :beams 8 :arc (* 2 pi) :maximum 30)
          (robot:rangefinder :maximum 2)))
(robot:defrobot bat-two (cavern (2.5 4.5) 0))

(defmacro in-cavern ((&rest options) &body body)
  `(run:with-simulation (bat-one :seed 3 ,@options) ,@body))

(defun cavern-world () (robot:robot-world bat-one))

(defun cast (x y angle &rest more) (apply #'robot:cast-ray (cavern-world) x y angle more))

(defun rangefinder (index) (robot:robot-part bat-one 'robot:rangefinder index))

(defun ranges-read (&optional (index 0))
  "Let BAT-ONE read its rangefinder with INDEX. Return the ranges."
  (let ((answer nil))
    (command:rangefinder-read (rangefinder index) (lambda (err part ranges)
                                                    (declare (ignore part))
                                                    (setf answer (list err ranges))))
    (run:run-ticks 1)
    (is (null (first answer)))
    (second answer)))

;;; Rays.

(defun solid-cell-p (world x y)
  (let ((index (world:map-index (world:world-map world) x y)))
    (or (null index)
        (logtest (logior world:+wall+ world:+obsmove+ world:+obsview+)
                 (aref (world:world-flags world) index)))))

(defun distance-in-small-steps (world x y angle)
  "Return the distance from (X,Y) to the first solid cell other than that of (X,Y), to .001."
  (loop for distance from 0d0 by 1d-3
        for at-x = (+ x (* distance (base:cosine angle)))
        for at-y = (+ y (* distance (base:sine angle)))
        when (and (not (and (= (floor x) (floor at-x)) (= (floor y) (floor at-y))))
                  (solid-cell-p world at-x at-y))
          return distance))

(test rays.end-where-small-steps-meet-something
  (in-cavern ()
    (loop with dice = (base:make-dice 7)
          repeat 300
          do (let* ((x (base:roll-between 1d0 19d0 dice)) (y (base:roll-between 1d0 13d0 dice))
                    (angle (base:roll-between -10d0 10d0 dice))
                    (true (distance-in-small-steps (cavern-world) x y angle))
                    (cast (cast x y angle)))
               (is (<= -1d-3 (- true cast) 3d-3) "~F ~F ~F: ~F not ~F" x y angle cast true)))))

(test rays.say-what-they-meet
  (in-cavern ()
    (flet ((meets (&rest arguments)
             (multiple-value-bind (distance obstacle) (apply #'cast arguments)
               (list distance (if (world:thing-p obstacle)
                                  (world:thing-name obstacle)
                                  obstacle)))))
      (is (equal '(2.5d0 :wall) (meets 5.5 4.5 0)))
      (is (equal '(2.5d0 :wall) (meets 11/2 9/2 0)) "any numbers do")
      (is (equal '(3.5d0 crate) (meets 1.5 11.5 0)))
      (is (equal '(2.5d0 curtain) (meets 13.5 6.5 0)))
      (is (equal '(4.5d0 :wall) (meets 9.5 4.5 0)) "over what blocks nothing")
      (is (equal '(nil nil) (meets 5.5 4.5 0 2)))
      (is (equal '(2.5d0 :wall) (meets 5.5 4.5 0 5/2)))
      (is (equal '(1.5d0 :wall) (meets 5.5 11.5 (/ pi 2))) "the start does not count"))))

(test rays.pass-corners-as-views-do
  (in-cavern ()
    (is (< (abs (- (* 2 (sqrt 2d0)) (cast 2d0 12d0 (/ pi -4)))) 1d-5)
        "two walls that touch at a corner have no hole")
    (is (< (abs (- (* 5 (sqrt 2d0)) (cast 12d0 6d0 (/ pi -4)))) 1d-5)
        "a single corner is passed")))

(world:defmap barrens (6 4))
(robot:defrobot elk (barrens (2.5 1.5) 0))

(test rays.end-at-the-edge-of-the-map
  (run:with-simulation (elk)
    (is (equal '(3.5d0 :wall)
               (multiple-value-list (robot:cast-ray (robot:robot-world elk) 2.5 1.5 0))))))

(test rays.wrong-arguments-say-what-is-right
  (in-cavern ()
    (loop for (world x y angle maximum . words)
            in `((,bat-one 1 1 0 nil "robot-world") (,(cavern-world) 90 1 0 nil "20 by 14")
                 (,(cavern-world) :a 1 0 nil "20 by 14") (,(cavern-world) 1 1 :up nil "radians")
                 (,(cavern-world) 1 1 0 -1 "metres") (,(cavern-world) 1 1 0 "far" "metres"))
          do (handler-case (progn (robot:cast-ray world x y angle maximum)
                                  (fail "~S is accepted" (list x y angle maximum)))
               (base:wrong-argument (condition)
                 (is-true (apply #'has-words-p (princ-to-string condition) words)
                          "~A" condition))))))

;;; Readings.

(test ranges.are-the-truth-in-a-clean-run
  (in-cavern (:clean t)
    (is (equal (loop for angle in (robot:rangefinder-beam-angles (rangefinder 0))
                     collect (cast 5.5 4.5 angle))
               (ranges-read)))
    (is (equal (robot:rangefinder-last-ranges (rangefinder 0)) (ranges-read)))
    (is (equal '(2d0) (ranges-read 1)) "nothing within the maximum")
    (robot:place-robot bat-one 6.5 4.5 0)
    (is (equal '(1.5d0) (ranges-read 1)))))

(test beams.are-spread-as-pixels
  (in-cavern ()
    (is (equal '(0d0) (robot:rangefinder-beam-angles (rangefinder 1))))
    (let ((angles (robot:rangefinder-beam-angles (rangefinder 0))))
      (is (= 8 (length angles)))
      (is (every (lambda (angle next) (< (abs (- (- next angle) (/ pi 4))) 1d-9))
                 angles (rest angles)))
      (is (< (abs (reduce #'+ angles)) 1d-9)))))

(defmacro with-range-errors ((&key (noise 0) (outliers 0) (misses 0)) &body body)
  `(in-cavern (:parameters '((base:range-noise* ,noise) (base:range-outlier-prob* ,outliers)
                             (base:range-miss-prob* ,misses)))
     ,@body))

(defun many-ranges (&optional (reads 250))
  (loop repeat reads append (ranges-read)))

(test ranges.err-as-the-parameters-say
  (with-range-errors ()
    (is (equal (loop for angle in (robot:rangefinder-beam-angles (rangefinder 0))
                     collect (cast 5.5 4.5 angle))
               (ranges-read))))
  (with-range-errors (:misses 1/4)
    (is (<= 430 (count 30d0 (many-ranges)) 570) "a quarter of 2000"))
  (with-range-errors (:noise 1/10)
    (let* ((true (loop for angle in (robot:rangefinder-beam-angles (rangefinder 0))
                       collect (cast 5.5 4.5 angle)))
           (errors (loop repeat 100
                         append (mapcar (lambda (range true) (/ (- range true) true))
                                        (ranges-read) true))))
      (is (every (lambda (error) (<= -.1001d0 error .1001d0)) errors))
      (is (< .095 (reduce #'max errors)))
      (is (< (abs (/ (reduce #'+ errors) (length errors))) .01))))
  (with-range-errors (:outliers 1)
    (let ((ranges (many-ranges)))
      (is (every (lambda (range) (<= 0 range 30)) ranges))
      (is (<= 14.2 (/ (reduce #'+ ranges) (length ranges)) 15.8)))))

(test ranges.take-the-delay-of-the-parameter
  (in-cavern (:clean t :parameters '((base:range-delay* 4)))
    (let ((tick nil))
      (command:rangefinder-read (rangefinder 0) (lambda (&rest ignore)
                                                  (declare (ignore ignore))
                                                  (setf tick (run:simulation-tick))))
      (run:run-ticks 10)
      (is (eql 4 tick)))))

(test ranges.see-robots-that-have-bodies
  (flet ((behind (&rest options)
           (apply #'run:call-with-simulation
                  (lambda (&rest ignore)
                    (declare (ignore ignore))
                    (cast 5.5 4.5 pi))
                  '(bat-one bat-two) options)))
    (is (= 2.5d0 (behind)))
    (is (= 4.5d0 (behind :ghosts t)))))

(test ranges.are-forked-saved-and-repeated
  (in-cavern (:journal t)
    (many-ranges 5)
    (let ((fork (run:fork-simulation)) (digest (run:state-digest)))
      (is (= digest (run:state-digest fork)))
      (let ((later (run:call-in-fork
                    fork (lambda () (run:run-ticks 1)
                           (robot:rangefinder-last-ranges
                            (first (coerce (robot:robot-sensors
                                            (first (run:simulation-robots)))
                                           'list)))))))
        (is (equal later (robot:rangefinder-last-ranges (rangefinder 0)))))
      (is-true (replays-p time:*simulation*))
      (with-temporary-file (file)
        (run:save-simulation file)
        (let ((last (robot:rangefinder-last-ranges (rangefinder 0))) (next (ranges-read)))
          (run:with-loaded-simulation (file)
            (let* ((robot (first (run:simulation-robots))) (answer nil)
                   (part (robot:robot-part robot 'robot:rangefinder 0)))
              (is (equal last (robot:rangefinder-last-ranges part)))
              (command:rangefinder-read part (lambda (err part ranges)
                                               (declare (ignore err part))
                                               (setf answer ranges)))
              (run:run-ticks 1)
              (is (equal next answer)))))))))

;;; For people.

(test ranges.are-shown-in-pictures-and-text-maps
  (in-cavern (:clean t)
    (flet ((picture () (display:svg-picture bat-one :layers '(:ranges :legend))))
      (is (not (mentions-p (picture) ">measured<")))
      (ranges-read)
      (is-true (mentions-p (picture) ">measured<"))
      (is (not (mentions-p (display:svg-picture bat-one :layers '(:legend)) ">measured<")))
      (is-true (has-words-p (display:text-map bat-one :layers '(:ranges))
                            "~ measured by BAT-ONE")))))

(test ranges.are-read-at-the-prompt
  (let ((text (joined (type-to 'bat-one "ranges 1" "status" "ranges 2" "help ranges"))))
    (is-true (has-words-p text "rangefinder-read: Rangefinder 1 reads 2.00"
                          "Rangefinder 1: last-ranges (2.00)"
                          "There is no rangefinder 2. BAT-ONE has 2"
                          "Measure the distances")
             "~A" text))
  (is-true (has-words-p (joined (type-to 'elk "ranges 0")) "ELK has no rangefinder.")))

(test rangefinders.wrong-options-say-what-is-right
  (loop for (part word) in '(((robot:rangefinder :arc 7) "2 pi")
                             ((robot:rangefinder :beams 0) "beams")
                             ((robot:rangefinder :maximum 0) "maximum")
                             ((robot:rangefinder :range 3) ":maximum")
                             ((robot:rangefinder :last-ranges (1)) ":beams"))
        do (handler-case (progn (robot:define-robot 'newt 'cavern '(5 5) 0 :parts (list part))
                                (fail "~S is accepted" part))
             (base:malformed-definition (condition)
               (is (search word (princ-to-string condition)) "~A" condition)))))
