;;;; looking-hidden.lisp -- tracks, searches and arrivals agree on what is hidden (2.2, 3.4.3, 3.5).

(in-package :ars-magna.tests)

(in-suite looking)

;;; A track of one thing, and things put in between at random points.

(defun put-posts (count dice)
  "Put COUNT things that obstruct sight, anywhere in the hall of WATCHER but in the robot's cell."
  (loop repeat count
        do (loop for x = (base:roll-between 4 14 dice)
                 for y = (base:roll-between 6 16 dice)
                 while (robot:in-same-cell-p watcher x y)
                 finally (put 'post (list x y) :obsview t))))

(defun found-p (thing)
  "True if a search by camera 0 finds THING, of whatever type."
  (and (loop for type in '(:local :non-local)
             thereis (member thing (robot::things-in-view (eye) type)))
       t))

(defun free-line-p (thing)
  (robot:line-clear-p world:*world* (robot:robot-x watcher) (robot:robot-y watcher)
                      (world:thing-x thing) (world:thing-y thing)))

(test track.ends-where-no-search-would-find-the-thing
  "Reading 141."
  (let ((dice (base:make-dice 8)) (kept 0) (lost 0))
    (loop repeat 400
          do (with-watcher (:clean t)
               (robot:set-robot-pose watcher (base:roll-between 7 9 dice)
                                     (base:roll-between 9 12 dice))
               (multiple-value-bind (ball designator)
                   (ball-at (base:roll-between 7 13 dice) (base:roll-between 8 13 dice))
                 (when designator
                   (track-at-once designator)
                   (run:run-ticks 1)
                   (put-posts 25 dice)
                   (run:run-ticks 1)
                   (cond ((robot:tracking-p (eye) designator)
                          (incf kept)
                          (robot:end-track (eye) :interrupt)
                          (is-true (or (found-p ball) (free-line-p ball))
                                   "kept, but ~A is not found from ~A" ball watcher))
                         ;; The camera has turned no more.
                         (t (incf lost)
                            (unless (robot:in-same-cell-p watcher (world:thing-x ball)
                                                          (world:thing-y ball))
                              (is-true (not (found-p ball)) "lost, but ~A is found from ~A"
                                       ball watcher))))))))
    (is (< 40 kept))
    (is (< 40 lost))))

;;; What has been arrived at.

(world:defmap walled-yard (30 20)
  (rect (0 0) (29 19) bricks 10)
  (wall (18 8) (25 14) slate 30))

(robot:defrobot inmate (walled-yard (13 9) 0) :cameras (((* 2 pi) 9)))

(defun lodge (x y goal-x goal-y)
  "Let INMATE go from (X,Y) to a ball at (GOAL-X,GOAL-Y). Return the error code, and true if a
search finds the ball as something local."
  (run:with-simulation (inmate :clean t :errors :collect)
    (robot:set-robot-pose inmate x y)
    (let* ((ball (put 'ball (list goal-x goal-y))) (camera (robot:robot-camera inmate 0))
           (designator (loop for sighting in (robot:look-for-things camera :non-local '() :all t)
                             when (eq ball (robot::sighting-denotation sighting))
                               return (robot:designate sighting camera)))
           (code :unseen))
      (when designator
        (robot:start-track camera designator nil)
        (command:robot-goto-designator inmate camera
                                       (lambda (err &rest results)
                                         (declare (ignore results))
                                         (setf code err)))
        (run:run-ticks 150))
      (values code (and (member ball (robot::things-in-view camera :local)) t)))))

(test arrival.is-where-the-thing-can-be-found
  "Reading 108: beside a wall, too, which may run between two points that are close together."
  (multiple-value-bind (code found) (lodge 13 9 20.5 11)
    (is-true (or code found) "~S ~S" code found))
  (let ((dice (base:make-dice 4)) (arrived 0))
    (loop repeat 300
          do (multiple-value-bind (code found)
                 (lodge (base:roll-between 12 17 dice) (base:roll-between 7 14 dice)
                        (base:roll-between 17 25 dice) (base:roll-between 8 15 dice))
               (when (null code)
                 (incf arrived)
                 (is-true found))))
    (is (< 60 arrived))))
