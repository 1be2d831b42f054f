;;;; looking-tracks.lisp -- tracks, and how they end (manual 3.4.3).

(in-package :ars-magna.tests)

(in-suite looking)

(defmacro with-track ((calls designator camera &optional (ticks 5)) &body body)
  "Run BODY where CAMERA has been told to track DESIGNATOR, TICKS ago; CALLS is then a function that
returns what the continuation was called with since last asked: (tick code camera designator)."
  `(let* ((heard '()) (start (run:simulation-tick)))
     (command:camera-track ,camera ,designator
                           (lambda (&rest call)
                             (push (cons (- (run:simulation-tick) start) call) heard)))
     (run:run-ticks ,ticks)
     (flet ((,calls () (reverse (shiftf heard '()))))
       (declare (ignorable #',calls))
       ,@body)))

(defun ball-at (x y &rest attributes)
  "Return a new thing at (X,Y) and a designator on it, non-local if it is far enough."
  (let* ((ball (apply #'put 'ball (list x y) attributes))
         (type (if (robot:within-reach-p watcher x y) :local :non-local)))
    (values ball
            (loop for sighting in (robot:look-for-things (eye) type '() :all t)
                  when (eq ball (robot::sighting-denotation sighting))
                    return (robot:designate sighting (eye))))))

(defun codes (calls) (mapcar #'second calls))

;;; Starting.

(test camera-track.tells-when-it-begins
  (with-watcher (:clean t)
    (multiple-value-bind (ball designator) (ball-at 9.5 12.5)
      (declare (ignore ball))
      (base:take-messages)
      (with-track (calls designator (eye))
        (is (equal (list (list 4 nil (eye) designator)) (calls)))
        (is (robot:tracking-p (eye) designator))
        (is (eq designator (robot:camera-tracks (eye))))
        (is (near (atan 2d0 4d0) (robot:camera-angle (eye))))
        (is (equal '("camera-track: Camera 0 tracking Designator 0") (queued-texts)))
        (run:run-ticks 50)
        (is (null (calls)))
        (is (not (run:idle-p)))))))

(test camera-track.that-cannot-begin
  (with-watcher (:clean t)
    (let ((ball (put 'ball '(9.5 10.5))) (cube (put 'cube '(5.6 10.5) :capacity 5)))
      (let ((far (find-object '())) (here (find-object '() :type :local)))
        (flet ((code (designator) (end-code 'command:camera-track (eye) designator)))
          (robot:start-track (eye) far nil)
          (is (eq :already-tracking (code far)))
          (is (eq :already-tracking (code here)))
          (robot:end-track (eye) :interrupt)
          (robot:move-part (eye) cube)
          (is (eq :local-not-local (code here)))
          (is (eq :camera-inside (code far)))
          (robot:move-part (eye) nil)
          (robot:set-robot-pose watcher 5.5 5.5)
          (is (eq :local-not-local (code here)))
          (is (not (robot:designator-valid-p here)))
          (world:move-thing ball '(9.5 11.5))
          (is (not (robot:designator-valid-p far)))
          (is (eq :lost-track (code far)))
          (is (equal '("Camera 0 is already tracking Designator 0"
                       "Camera 0 is already tracking Designator 0"
                       "Designator 1 is not local any more"
                       "Camera 0 is inside a container and cannot track Designator 0"
                       "Removing Designator 1"
                       "Designator 1 is not local any more"
                       "Removing Designator 0"
                       "Camera 0 lost track of Designator 0")
                     (last (queued-texts) 8))))))))

(test camera-track.of-what-cannot-be-seen
  (with-watcher (:clean t)
    (multiple-value-bind (ball far) (ball-at 15.5 10.5)
      (declare (ignore ball))
      (let ((screen (put 'screen '(10.5 10.5) :obsview t)))
        (is (eq :lost-track (end-code 'command:camera-track (eye) far)))
        (world:destroy-thing screen)
        ;; It was not the designator's fault.
        (is (robot:designator-valid-p far))
        (with-track (calls far (eye)) (is (equal '(nil) (codes (calls)))))))))

(test camera-track.of-another-robots-designator
  (with-watcher (:clean t)
    (let ((designator (robot:add-designator
                       (robot::make-robot (robot:robot-blueprint watcher) world:*world*)
                       :x 15 :y 10)))
      (signals base:misuse (command:camera-track (eye) designator)))))

;;; Following.

(test track.follows-a-thing-that-moves
  (with-watcher (:clean t)
    (multiple-value-bind (ball designator) (ball-at 9.5 10.5 :color 'world:red)
      (with-track (calls designator (eye))
        (loop for y from 10.5 by .2 repeat 6
              do (world:move-thing ball (list 9.5 y))
                 (world:set-attribute ball :color 'world:blue)
                 (run:run-ticks 1)
                 (is (near (atan (- y 10.5d0) 4d0) (robot:camera-angle (eye)) 1d-6))
                 (is (near (robot:designator-angle designator) (robot:camera-angle (eye))))
                 (is (near (sqrt (+ 16 (expt (- y 10.5d0) 2)))
                           (robot:designator-distance designator) 1d-6)))
        (is (equal '(nil) (codes (calls))))
        ;; Seen is seen: matching is done when a designator is acquired.
        (is (not (member '(:color world:blue) (robot:designator-data designator)
                         :test #'equal)))))))

(defun angle-to (x y)
  "Return the angle of (X,Y) relative to WATCHER's heading."
  (- (atan (- y (robot:robot-y watcher)) (- x (robot:robot-x watcher)))
     (robot:robot-angle watcher)))

(test track.angle-is-relative-to-the-robot
  (with-watcher (:clean t)
    (multiple-value-bind (ball designator) (ball-at 9.5 14.5)
      (declare (ignore ball))
      (with-track (calls designator (eye))
        (call-once 'command:robot-turn watcher 1)
        (is (near (- (/ pi 4) 1) (robot:camera-angle (eye)) 1d-6))
        (call-once 'command:robot-go-forward watcher 3)
        (is (near (angle-to 9.5 14.5) (robot:camera-angle (eye)) 1d-6))
        (is (equal '(nil) (codes (calls))))))))

(test track.angles-are-never-normalised
  (with-watcher (:clean t)
    (call-once 'command:camera-turn (eye) (* -2 pi))
    (multiple-value-bind (ball designator) (ball-at 9.5 12.5)
      (declare (ignore ball))
      (is (near (- (atan 2d0 4d0) (* 2 pi)) (robot:designator-angle designator)))
      (with-track (calls designator (eye))
        (loop repeat 4 do (call-once 'command:robot-about-face watcher))
        (is (near (- (atan 2d0 4d0) (* 6 pi)) (robot:camera-angle (eye)) 1d-6))))))

(test tracks.of-one-designator-by-two-cameras
  (with-watcher (:clean t)
    (multiple-value-bind (ball designator) (ball-at 9.5 12.5)
      (with-track (calls designator (eye 0))
        (with-track (other-calls designator (eye 1))
          (is (equal (list (eye 0) (eye 1)) (robot:tracking-cameras designator)))
          (world:move-thing ball '(9.5 12.3))
          (run:run-ticks 1)
          (is (= (robot:camera-angle (eye 0)) (robot:camera-angle (eye 1))))
          (robot:end-track (eye 0) :lost-track)
          (is (robot:designator-valid-p designator))
          (base:take-messages)
          (robot:end-track (eye 1) :lost-track "So be it")
          (is (not (robot:designator-valid-p designator)))
          (is (equal '("So be it" "Removing Designator 0") (queued-texts)))
          (run:run-ticks 1)
          (is (equal '(nil :lost-track) (codes (calls))))
          (is (equal '(nil :lost-track) (codes (other-calls)))))))))

;;; Losing.

(defun ends-with (code calls)
  "True if CALLS, of a track's continuation, are one with NIL and one with CODE."
  (equal (list nil code) (codes calls)))

(test track.is-lost-by-occlusion
  (with-watcher (:clean t)
    (multiple-value-bind (ball designator) (ball-at 15.5 10.5)
      (declare (ignore ball))
      (with-track (calls designator (eye))
        (put 'pane '(10.5 10.5))
        (run:run-ticks 2)
        (is (equal '(nil) (codes (calls))))
        (base:take-messages)
        (put 'screen '(10.5 10.5) :obsview t)
        (run:run-ticks 1)
        (is (equal (list (list 8 :lost-track (eye) designator)) (calls)))
        (is (equal '("Camera 0 lost track of Designator 0" "Removing Designator 0")
                   (queued-texts)))
        (is (run:idle-p))))))

(test track.is-lost-behind-a-wall
  (with-watcher (:clean t)
    (multiple-value-bind (ball designator) (ball-at 24.5 10.5)
      (with-track (calls designator (eye))
        (world:move-thing ball '(24.5 12.5))
        (run:run-ticks 1)
        (is (ends-with :lost-track (calls)))))))

(test track.is-lost-by-speed
  "If the direction changes by more than half the field of view, here 45 degrees, in a tick."
  (with-watcher (:clean t)
    (flet ((code-after-jump (y)
             (multiple-value-bind (ball designator) (ball-at 7.5 10.5)
               (with-track (calls designator (eye))
                 (world:move-thing ball (list 7.5 y))
                 (run:run-ticks 2)
                 (robot:end-track (eye) :interrupt)
                 (run:run-ticks 1)
                 (world:destroy-thing ball)
                 (second (codes (calls)))))))
      (is (eq :interrupt (code-after-jump 12.49)))
      (is (eq :lost-track (code-after-jump 12.51))))))

(test track.of-what-is-within-reach-is-not-lost-by-speed
  "The robot passes something at half a metre, through its neighbour cell."
  (with-watcher (:clean t)
    (let ((designator (nth-value 1 (ball-at 8.5 11.05))))
      (with-track (calls designator (eye 1))
        (command:robot-go-forward watcher 7)
        (run:run-ticks 20)
        (is (< 10.5 (robot:robot-x watcher)))
        (is (equal '(nil) (codes (calls))))))))

(test track.is-lost-on-arrival
  (with-watcher (:clean t)
    (multiple-value-bind (ball designator) (ball-at 8.5 10.5)
      (declare (ignore ball))
      (with-track (calls designator (eye))
        (robot:set-robot-pose watcher 7.9 10.5)
        (run:run-ticks 1)
        ;; Within a metre, but not arrived.
        (is (equal '(nil) (codes (calls))))
        (robot:set-robot-pose watcher 8.1 10.5)
        (run:run-ticks 1)
        (is (equal '(:lost-track) (codes (calls))))))))

(test track.is-lost-when-its-thing-goes
  (with-watcher (:clean t)
    (let ((box (put 'box '(7.5 8.5) :capacity 9)))
      (dolist (change (list #'world:destroy-thing (lambda (ball) (world:move-thing ball box))))
        (multiple-value-bind (ball designator) (ball-at 9.5 12.5)
          (with-track (calls designator (eye))
            (base:take-messages)
            (funcall change ball)
            (is (not (robot:designator-valid-p designator)))
            (is (equal '("Removing Designator 0"
                         "Designator 0 no longer valid. Camera 0 lost track")
                       (queued-texts)))
            (is (equal '(nil) (codes (calls))))
            (is (not (run:idle-p)))
            (run:run-ticks 1)
            (is (equal '(:lost-track) (codes (calls))))))))))

(test track.is-lost-when-its-camera-moves
  (with-watcher (:clean t)
    (let ((box (put 'box '(5.5 10.5) :capacity 9)))
      (multiple-value-bind (ball designator) (ball-at 9.5 12.5)
        (declare (ignore ball))
        (with-track (calls designator (eye 0))
          (robot:start-track (eye 1) designator nil)
          (base:take-messages)
          (robot:move-part (eye 0) box)
          (is (equal '("Camera 0 moved. No longer tracking Designator 0") (queued-texts)))
          (is (robot:designator-valid-p designator))
          (run:run-ticks 1)
          (is (ends-with :lost-track (calls))))))))

(test track.of-a-local-designator-becomes-non-local
  (with-watcher (:clean t)
    (multiple-value-bind (ball designator) (ball-at 5.9 10.5)
      (declare (ignore ball))
      (with-track (calls designator (eye))
        (is (eq :local (robot:designator-type designator)))
        (robot:set-robot-pose watcher 3.5 10.5)
        (run:run-ticks 1)
        (is (eq :non-local (robot:designator-type designator)))
        (is (near 2.4 (robot:designator-distance designator) 1d-6))
        ;; But never the reverse: then it is lost.
        (robot:set-robot-pose watcher 5.5 10.5)
        (run:run-ticks 1)
        (is (eq :non-local (robot:designator-type designator)))
        (is (ends-with :lost-track (calls)))))))

(test track.inside-a-container
  (with-watcher (:clean t)
    (let* ((box (put 'box '(5.5 10.5) :capacity 9)) (pen (put 'pen box :size 1)))
      (robot:move-part (eye) box)
      (let ((designator (find-object '() :type :local)))
        (is (eq pen (robot:designator-denotation designator)))
        (with-track (calls designator (eye))
          (run:run-ticks 10)
          (is (equal '(nil) (codes (calls))))
          (base:take-messages)
          (world:move-thing pen '(5.5 10.5))
          (run:run-ticks 1)
          (is (equal '("Removing Designator 0"
                       "Designator 0 no longer valid. Camera 0 lost track")
                     (queued-texts)))
          (is (equal '(:lost-track) (codes (calls)))))))))

(test track.of-what-a-hand-takes-along
  "A grasped thing is still there; put into a bin it is gone."
  (with-watcher (:clean t)
    (let ((hand (robot:robot-hand watcher 0)) (bin (robot:robot-storage-bin watcher 0)))
      (multiple-value-bind (ball designator) (ball-at 5.9 10.5 :size 1)
        (with-track (calls designator (eye))
          (world:move-thing ball hand)
          (robot:set-robot-pose watcher 12.5 10.5)
          (run:run-ticks 3)
          (is (equal '(nil) (codes (calls))))
          (is (eq :local (robot:designator-type designator)))
          (base:take-messages)
          (robot:move-part hand bin)
          (is (equal '("BALL#1 has moved" "Removing Designator 0"
                       "Designator 0 no longer valid. Camera 0 lost track")
                     (queued-texts)))
          (run:run-ticks 1)
          (is (equal '(:lost-track) (codes (calls)))))))))

(test track.is-told-after-the-command-that-ended-it
  (with-watcher (:clean t)
    (let* ((hand (robot:robot-hand watcher 0)) (order '()))
      (multiple-value-bind (ball designator) (ball-at 5.9 10.5 :size 1)
        (world:move-thing ball hand)
        (flet ((recorder (name) (lambda (err &rest more)
                                  (declare (ignore more))
                                  (push (list name err) order))))
          (command:camera-track (eye) designator (recorder :track))
          (run:run-ticks 5)
          (command:hand-insert-bin hand (robot:robot-storage-bin watcher 0) (recorder :insert))
          (run:run-ticks 5)
          (is (equal '((:track nil) (:insert nil) (:track :lost-track)) (reverse order))))))))

;;; Interrupting.

(test track.is-interrupted-by-what-turns-the-camera
  (with-watcher (:clean t)
    (multiple-value-bind (ball designator) (ball-at 9.5 10.5)
      (declare (ignore ball))
      (loop for command in (list (lambda () (command:camera-turn (eye) .1))
                                 (lambda () (command:camera-align-robot (eye)))
                                 (lambda () (time:grab-resource (eye)))
                                 (lambda () (command:camera-untrack (eye))))
            do (with-track (calls designator (eye))
                 (base:take-messages)
                 (funcall command)
                 (run:run-ticks 2)
                 (is (ends-with :interrupt (calls)))
                 (is (string= "camera-track was interrupted" (first (queued-texts))))
                 (is (null (robot:camera-tracks (eye))))
                 ;; The designator remains.
                 (is (robot:designator-valid-p designator)))))))

(test untrack.tells-the-track-first
  (with-watcher (:clean t)
    (multiple-value-bind (ball designator) (ball-at 9.5 10.5)
      (declare (ignore ball))
      (let ((order '()))
        (command:camera-track (eye) designator (lambda (err &rest more)
                                                 (declare (ignore more))
                                                 (push err order)))
        (run:run-ticks 5)
        (command:camera-untrack (eye) (lambda (err camera)
                                        (push (list err camera) order)))
        (run:run-ticks 1)
        (is (equal (list nil :interrupt (list nil (eye))) (reverse order)))
        (is (eq :not-tracking (end-code 'command:camera-untrack (eye))))
        (is (string= "Camera 0 is not tracking anything" (first (last (queued-texts)))))))))

(test track.is-interrupted-before-it-begins
  (with-watcher (:clean t)
    (multiple-value-bind (ball designator) (ball-at 9.5 10.5)
      (declare (ignore ball))
      (with-track (calls designator (eye) 2)
        (command:camera-view (eye))
        (run:run-ticks 10)
        (is (equal (list (list :interrupt (eye) designator)) (mapcar #'rest (calls))))
        (is (null (robot:camera-tracks (eye))))))))
