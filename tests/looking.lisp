;;;; looking.lisp -- descriptions, and searches for things and places (manual 3.4.2, 3.4.3).

(in-package :ars-magna.tests)

(def-suite* looking :in ars-magna)

;;; WATCHER looks along a room, through a doorway in the wall that divides it.
(world:defmap gallery (30 21)
  (rect (0 0) (29 20) bricks 10)
  (wall (20 1) (20 9) slate 30)
  (wall (20 11) (20 19) slate 30))

(robot:defrobot watcher (gallery (5.5 10.5) 0)
  :cameras (((/ pi 2) 5) ((/ pi 4) 3))
  :hands (10)
  :bins (20))

(defmacro with-watcher ((&rest options) &body body)
  "Run BODY in a headless simulation with a fresh WATCHER."
  `(run:with-simulation (watcher ,@options) ,@body))

(defun eye (&optional (index 0)) (robot:robot-camera watcher index))

(defun put (name where &rest attributes)
  "Return a new thing NAME with ATTRIBUTES, keys and values, at WHERE: (x y) or what holds it."
  (world:make-new-thing name (if (listp where) (cons world:*world* where) where)
                        (loop for (key value) on attributes by #'cddr collect (list key value))))

(defun call-times (ticks command &rest arguments)
  "Issue COMMAND with ARGUMENTS and pass TICKS. Return what its continuation was called with, each
time as (tick code resource result...), ticks counted from now."
  (let ((calls '()) (start (run:simulation-tick)))
    (apply command (append arguments
                           (list (lambda (&rest call)
                                   (push (cons (- (run:simulation-tick) start) call) calls)))))
    (run:run-ticks ticks)
    (reverse calls)))

(defun call-once (command &rest arguments)
  "Issue COMMAND with ARGUMENTS and pass 30 ticks. Return what its continuation was called with,
claiming that this was once."
  (let ((calls (apply #'call-times 30 command arguments)))
    (is (= 1 (length calls)) "~S was answered ~D times" command (length calls))
    (rest (first calls))))

(defun end-code (command &rest arguments) (first (apply #'call-once command arguments)))

(defun queued-texts ()
  "Return the texts of the messages queued since last asked."
  (mapcar #'base:message-text (base:take-messages)))

(defun find-object (specification &key (type :non-local) (camera (eye)))
  "Return the designator that a search finds, or NIL."
  (third (call-once 'command:camera-get-object-designator camera type specification)))

(defun find-objects (specification &key (type :non-local) (camera (eye)))
  "Return the names of the things that a search for all finds."
  (sort (loop for designator in (third (call-once 'command:camera-get-all-object-designators
                                                  camera type specification))
              collect (world:thing-name (robot:designator-denotation designator)))
        #'string<))

(defun near (a b &optional (tolerance 1d-9)) (< (abs (- a b)) tolerance))

;;; Descriptions.

(defun fits (specification &rest attributes)
  "True if a thing with ATTRIBUTES fits SPECIFICATION, seen without noise."
  (with-watcher (:clean t)
    (let ((thing (apply #'put 'box '(9.5 10.5) attributes)))
      (values (robot::match-thing thing (robot::parse-specification specification)
                                  4d0 (base:make-dice 1))))))

(test matching.of-each-form
  "Manual 3.4.2: values, alternatives, numbers and ranges with the threshold of .5 or their own."
  (is (fits '() :color 'world:red))
  (is (fits '((:color red)) :color 'world:red))
  (is (not (fits '((:color red)) :color 'world:blue)))
  (is (fits '((:color (green blue))) :color 'world:blue))
  (is (not (fits '((:color (green blue))) :color 'world:red)))
  (loop for (specification low high) in '(((:size 4) 3.5 4.5) ((:size (3 5)) 2.5 5.5)
                                          ((:size 4 2) 2 6) ((:size (3 5) 2) 1 7)
                                          ((:size 4 0) 4 4))
        do (is (fits (list specification) :size low))
           (is (fits (list specification) :size high))
           (is (not (fits (list specification) :size (- low .01))))
           (is (not (fits (list specification) :size (+ high .01)))))
  (is (fits '((:size 4) (:color red)) :size 4 :color 'world:red))
  (is (not (fits '((:size 4) (:color red)) :size 4 :color 'world:green))))

(test matching.of-what-is-not-said
  "Booleans that a thing does not mention are false; other attributes have no value."
  (is (fits '((:obsview nil))))
  (is (not (fits '((:obsview t)))))
  (is (fits '((:obsview (t nil)))))
  (is (not (fits '((:size (0 100))))))
  (is (not (fits '((:color (red green blue))))))
  (is (not (fits '((:substance wood))))))

(test matching.of-substances
  (is (fits '((:substance wood)) :substance 'world:wood))
  (is (fits '((:substance (metal wood))) :substance '(world:wood 7)))
  (is (fits '((:substance (6 8))) :substance '(world:wood 7)))
  (is (fits '((:substance 120)) :substance 'world:wood))
  (is (not (fits '((:substance wood)) :substance 7))))

(test matching.of-undefined-attributes
  "They are taken by the shape of the value, and read as they are."
  (is (fits '((:shape cylinder)) :shape 'cylinder))
  (is (fits '((:shape (cube cylinder))) :shape 'cylinder))
  (is (not (fits '((:shape cube)) :shape 'cylinder)))
  (is (fits '((:lock-id 7)) :lock-id 7.4))
  (is (fits '((:lock-id (7 9))) :lock-id 8))
  (is (not (fits '((:lock-id 7)) :lock-id 'seven)))
  (is (fits '((:lock-id nil)))))

(test specification.is-checked-at-once
  (with-watcher ()
    (dolist (bad '(red (:color red) ((:color)) ((:color red . 1)) ((:color purple)) ((:size red))
                   ((:size 4 -1)) ((:size (3 4 5))) ((nil 3)) ((:size 4 1 1)) ((:color (red pink)))
                   ((:obsview 3)) ((:size nil)) (("size" 3)) ((:size (3 . 4)))))
      (signals base:wrong-argument
        (command:camera-get-object-designator (eye) :local bad)
        "~S was accepted" bad))
    (signals base:wrong-argument (command:camera-get-object-designator (eye) :near '()))
    (signals base:wrong-argument (command:camera-get-object-designator watcher :local '()))
    (signals base:wrong-argument (command:camera-get-place-designator (eye) 3))
    (signals base:wrong-argument (command:camera-track (eye) 0))))

;;; Searches for things.

(test get-object-designator.finds-what-fits
  (with-watcher (:clean t)
    (put 'ball '(9.5 12.5) :color 'world:red :size 4)
    (put 'bell '(9.5 8.5) :color 'world:blue)
    (destructuring-bind ((tick code camera designator))
        (call-times 10 'command:camera-get-object-designator (eye) :non-local
                    '((:color red) (:size (3 5))))
      (is (= 4 tick))
      (is (null code))
      (is (eq camera (eye)))
      (is (eq :non-local (robot:designator-type designator)))
      (is (near (robot:designator-angle designator) (atan 2d0 4d0)))
      (is (near (robot:designator-distance designator) (sqrt 20d0)))
      (is (equal '((:color red) (:size 4))
                 (last (robot:designator-data designator) 2))
          "in the words of the question")
      (is (eq designator (robot:find-designator watcher 0)))
      (is (equal '("get-designator: Camera 0 found Designator 0") (queued-texts))))))

(test get-object-designator.finds-nothing-else
  (with-watcher (:clean t)
    (put 'ball '(9.5 10.5) :color 'world:red)
    (is (equal (list :designator-not-found (eye) nil)
               (call-once 'command:camera-get-object-designator (eye) :non-local
                          '((:color blue)))))
    (is (equal '("Camera 0 found no such object") (queued-texts)))
    (is (null (find-object '((:color red)) :type :local)))))

(test get-object-designator.numbers
  "A designator gets the smallest number that is free."
  (with-watcher (:clean t)
    (put 'ball '(9.5 10.5) :color 'world:red)
    (flet ((number () (robot:designator-number (find-object '()))))
      (is (equal '(0 1 2) (loop repeat 3 collect (number))))
      (robot:drop-designator (robot:find-designator watcher 1))
      (is (equal '(1 3) (loop repeat 2 collect (number))))
      (is (equal "Designator 3" (princ-to-string (robot:find-designator watcher 3))))
      (is (null (robot:find-designator watcher 9))))))

(test local.is-the-own-cell-or-less-than-a-metre
  (with-watcher (:clean t)
    (put 'same '(5.99 10.99))
    (put 'close '(6.4 10.5))
    (put 'far '(6.6 10.5))
    (is (equal '(close same) (find-objects '() :type :local)))
    (is (equal '(far) (find-objects '())))))

(test own-cell.is-always-in-view
  (with-watcher (:clean t)
    (put 'behind '(5.2 10.5))
    (put 'farther-behind '(4.6 10.5))
    (put 'there '(5.5 10.5) :size 3)
    (is (equal '(behind there) (find-objects '() :type :local)))
    (let ((designator (find-object '((:size 3)) :type :local)))
      (is (= 0 (robot:designator-distance designator) (robot:designator-angle designator))))))

(test view.ends-at-walls-and-at-what-obstructs
  (with-watcher (:clean t)
    (put 'pane '(9.5 10.5) :obsview nil)
    (put 'screen '(11.5 10.5) :obsview t)
    (put 'cell-mate '(11.2 10.8))
    (put 'hidden '(13.5 10.5))
    (put 'in-the-corner '(24.5 4.5))
    (is (equal '(cell-mate pane screen) (find-objects '() :camera (eye 1))))))

(test field-of-view.bounds-the-search
  (with-watcher (:clean t)
    (put 'ahead '(9.5 10.5))
    (put 'right '(5.5 14.5))
    (is (equal '(ahead) (find-objects '())))
    (robot:set-robot-angle watcher 1)
    (is (equal '(right) (find-objects '())))
    (call-once 'command:camera-turn (eye) -1)
    (is (equal '(ahead) (find-objects '())))
    (is (equal '(:designator-not-found) (list (end-code 'command:camera-get-object-designator
                                                        (eye 1) :non-local '()))))))

(test inside.sees-what-is-directly-in-there
  (with-watcher (:clean t)
    (let ((box (put 'box '(5.5 10.5) :capacity 9)))
      (put 'ball '(5.5 10.5))
      (put 'pen box)
      (put 'nib (put 'case box :capacity 1))
      (is (equal '(ball box) (find-objects '() :type :local)))
      (robot:move-part (eye) box)
      (is (equal '(case pen) (find-objects '() :type :local)))
      (is (null (find-object '())))
      (is (eq :camera-enclosed
              (end-code 'command:camera-get-place-designator (eye) 'world:doorway)))
      (let ((designator (first (robot:live-designators watcher))))
        (is (= 0 (robot:designator-distance designator)))))))

(test held-things.are-where-the-hand-is
  (with-watcher (:clean t)
    (let ((box (put 'box '(5.5 10.5) :capacity 9))
          (pen (put 'pen '(5.5 10.5) :size 1)))
      (world:move-thing pen (robot:robot-hand watcher 0))
      (is (equal '(box pen) (find-objects '() :type :local)))
      (robot:move-part (eye) box)
      (is (equal '() (find-objects '() :type :local)))
      (robot:move-part (robot:robot-hand watcher 0) box)
      (is (equal '(pen) (find-objects '() :type :local))))))

(test get-all.takes-a-tick-more-for-each-further
  (with-watcher (:clean t)
    (dotimes (index 4) (put 'ball (list 9.5 (+ 9.1 index))))
    (destructuring-bind ((tick code camera designators))
        (call-times 20 'command:camera-get-all-object-designators (eye) :non-local '())
      (declare (ignore code camera))
      (is (= 7 tick))
      (is (= 4 (length designators))))
    (is (equal (list (format nil "get-all-designators: Camera 0 found ~
                                  Designator 0, Designator 1, Designator 2, Designator 3"))
               (queued-texts)))))

(test get-all.leaves-out-what-has-moved-meanwhile
  (with-watcher (:clean t)
    (put 'ball '(9.5 10.5))
    (let ((mouse (put 'mouse '(9.5 9.5))) (fly (put 'fly '(9.5 11.5))) found)
      (command:camera-get-all-object-designators (eye) :non-local '()
                                                 (lambda (err camera designators)
                                                   (declare (ignore err camera))
                                                   (setf found designators)))
      (run:run-ticks 5)
      (world:move-thing mouse '(9.5 9.6))
      (world:destroy-thing fly)
      (run:run-ticks 5)
      (is (equal '(ball) (loop for designator in found
                               collect (world:thing-name
                                        (robot:designator-denotation designator))))))))

(test searches.are-interrupted
  (with-watcher (:clean t)
    (put 'ball '(9.5 10.5))
    (dolist (command '(command:camera-get-object-designator
                       command:camera-get-all-object-designators))
      (let ((calls '()))
        (funcall command (eye) :non-local '() (lambda (&rest call) (push call calls)))
        (run:run-ticks 2)
        (call-once 'command:camera-view (eye))
        (is (equal (list (list :interrupt (eye) nil)) calls))))))

(test already-tracking.keeps-from-searching
  (with-watcher (:clean t)
    (put 'ball '(9.5 10.5))
    (robot:start-track (eye) (find-object '()) nil)
    (is (eq :already-tracking (end-code 'command:camera-get-object-designator
                                        (eye) :non-local '())))
    (is (eq :already-tracking (end-code 'command:camera-get-all-object-designators
                                        (eye) :non-local '())))
    (is (eq :already-tracking (end-code 'command:camera-get-place-designator
                                        (eye) 'world:doorway)))
    (is (eq :already-tracking (end-code 'command:camera-get-all-place-designators
                                        (eye) 'world:doorway)))))

;;; Searches for places.

(test get-place-designator.finds-a-doorway
  (with-watcher (:clean t)
    (destructuring-bind ((tick code camera designator))
        (call-times 10 'command:camera-get-place-designator (eye) 'world:doorway)
      (is (= 4 tick))
      (is (null code))
      (is (eq camera (eye)))
      (is (eq :non-local (robot:designator-type designator)))
      (is (equal '(world:doorway) (robot:designator-data designator)))
      (is (near 0 (robot:designator-angle designator)))
      (is (near 15 (robot:designator-distance designator))))))

(test get-all-place-designators.finds-corners
  (with-watcher (:clean t)
    (let ((found (third (call-once 'command:camera-get-all-place-designators
                                   (eye) 'world:concave))))
      ;; The two corners ahead on this side of the wall.
      (is (equal '((19.5d0 1.5d0) (19.5d0 19.5d0))
                 (sort (loop for designator in found
                             collect (list (robot:designator-x designator)
                                           (robot:designator-y designator)))
                       #'< :key #'second))))))

(test own-place.is-not-found
  (with-watcher (:clean t)
    (robot:set-robot-pose watcher 20.5 10.5)
    (is (eq :designator-not-found
            (end-code 'command:camera-get-place-designator (eye) 'world:doorway)))))

(test place-types.that-cannot-be-looked-for
  (with-own-definitions
    (world:define-place-type 'burrow :invisible t :rules '())
    (with-watcher (:clean t)
      (dolist (command '(command:camera-get-place-designator
                         command:camera-get-all-place-designators))
        (base:take-messages)
        (is (equal (list :invalid-place-type (eye) nil) (call-once command (eye) 'door)))
        (is (eq :invisible-place-type (end-code command (eye) 'burrow)))
        (is (eq :designator-not-found (end-code command (eye) "beak")))
        (is (equal '("DOOR is not a place type" "BURROW cannot be recognized at a distance"
                     "Camera 0 found no beak")
                   (queued-texts)))))))
