;;;; random-restarts.lisp -- random commands, while definitions change and runs end.

(in-package :ars-magna.tests)

(in-suite random-driver)

;;; Like the random driver, but now and then a kicker, attribute, manipulation, place type or the
;;; map is defined again, and the run ends at any moment and another begins. All continuations of a
;;; run must have been called when it has ended.

(defun redefine-kicker ()
  (world:define-kicker (pick '(ride-hop ride-vanish ride-change)) :prob (pick '(0 .01 .1))
    :body (if (luck .5)
              (lambda (thing)
                (world:kick-thing thing (pick '(-.5 .5)) .2 (luck .5))
                (when (luck .01) (misbehave)))
              (lambda (thing) (world:set-attribute thing :weight (pick '(.1 1 nil)))))))

(defun redefine-place-type ()
  (eval `(world:def-place-type ride-nook (cell)
           :before ,(luck .5) :confusion ,(pick '(0 1/2)) :invisible ,(luck .3)
           :check-matchers ((((x * x) (x - x) (x - x)) ,(pick '(0 1 2))))))
  (world:rebuild-map (world:world-map world:*world*)))

(defun redefine-attribute ()
  (if (luck .5)
      (world:define-attribute :mood (pick '((good bad) numeric (bad sad))) :noticed .5)
      (world:define-attribute :color (pick '((red blue green) (red blue green gold))) :success .8))
  (tolerating (base:wrong-argument)
    (world:set-attribute (pick (world:world-thing-list world:*world*)) :mood (pick '(good bad 7)))))

(defun redefine-manipulation ()
  (eval `(command:defmanipulation open (it - ((:size (0 ,(pick '(5 30))))) :by hand)
             (:success ,(pick '(.5 1)) :delay ,(pick '(0 3)))
           (world:set-attribute it :closed nil)
           (values nil hand))))

(defun redefine-map ()
  "Define the map anew: for the runs that come, not for the one under way."
  (eval `(world:defmap zoo (9 9)
           (rect (0 0) (8 8) bricks 1 4 8 12)
           (wall (5 1) (5 ,(pick '(1 2))) slate 20)
           (obj box (3.5 3.5) ((:size 6) (:capacity 5) (:weight 1)) (bead ((:size .1))))
           (obj post (6.5 6.5) ((:obsmove t) (:obsview t) (:size 9)))
           (obj ball (3 3) ((:size 1) (:weight 1) (:color red))))))

(defun redefine-something ()
  (handler-bind ((warning #'muffle-warning))
    (case (base:roll-index 12 (ride-dice *ride*))
      ((0 1 2) (redefine-place-type))
      ((3 4 5) (redefine-attribute))
      ((6 7) (redefine-manipulation))
      (8 (redefine-map))
      (t (redefine-kicker)))))

(defun approach-something ()
  "Track the newest designator of a robot, and go there."
  (let* ((robot (any-robot)) (camera (pick (coerce (robot:robot-cameras robot) 'list)))
         (designator (first (robot:live-designators robot))))
    (when designator
      (issue-command 'command:camera-track camera designator)
      (ride-on 2)
      (issue-command 'command:robot-goto-designator robot camera)
      (ride-on (pick '(1 5 30))))))

(defun drive-through-run (commands seed)
  "Issue COMMANDS commands in a run of its own, which ends whatever is under way."
  (let ((last (+ commands (ride-issued *ride*))))
    (run:with-simulation ((keeper helper) :seed seed)
      (run:add-observer #'watch-ride)
      (populate)
      (loop until (or (<= last (ride-issued *ride*)) (ride-troubles *ride*))
            do (cond ((luck .01) (redefine-something))
                     ((luck .05) (approach-something))
                     (t (step-ride)))
               (base:take-messages))
      (setf (ride-over-p *ride*) t))
    (loop for (name) being the hash-keys of (ride-pending *ride*)
          do (complain "~A was not answered when its run ended" name))))

(defun troubles-of-ride (commands seed)
  "Return what was wrong in a random drive of COMMANDS commands, oldest first."
  (reverse (ride-troubles (drive-at-random commands seed))))

(defun troubles-of-runs (runs commands seed)
  "Return what was wrong in RUNS runs of COMMANDS commands each, one after the other, oldest first."
  (base:with-own-definitions ()
    (let ((*ride* (make-ride (base:make-dice seed "runs"))))
      (loop for run below runs
            until (ride-troubles *ride*)
            do (setf (ride-designators *ride*) '()
                     (ride-over-p *ride*) nil)
               (drive-through-run commands (+ seed run)))
      (reverse (ride-troubles *ride*)))))

(test random-driver.outlives-ends-and-redefinitions
  (loop for seed from 1 to 3
        for troubles = (troubles-of-runs 10 300 seed)
        do (is (null troubles) "seed ~D: ~{~A~^; ~}" seed (last troubles 5))))
