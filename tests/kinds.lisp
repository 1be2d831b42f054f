;;;; kinds.lisp -- the slots of kinds, and a kind of sensor added from outside.

(defpackage :ars-magna.tests.sonar
  (:documentation "A sensor that the simulator does not have, as a user would add it.")
  (:use :cl)
  (:import-from :ars-magna.base #:define-kind #:define-argument-type)
  (:import-from :ars-magna.world #:wall-at-p #:world-map #:world-dice)
  (:import-from :ars-magna.robot #:part #:robot #:location #:index #:robot-x #:robot-y
                #:robot-angle #:robot-world)
  (:import-from :ars-magna.command #:define-command #:succeed)
  (:import-from :ars-magna.rpl-robot #:define-fluents #:define-outcome)
  (:export #:sonar #:sonar-ping #:sonar-pings #:sonar-echo #:rpl-sonar-ping #:sonar-distance*
           #:sonar-heard*))

(in-package :ars-magna.tests.sonar)

(define-kind (sonar :include part)
    "A sonar that looks straight ahead."
  (:fixed
   (range 5d0 double-float "how far the sonar hears, in metres"))
  (:state
   (pings 0 fixnum "how often the sonar was asked"))
  (:memory
   (echo nil (or null double-float) "the last distance heard, in metres, or NIL")))

(define-argument-type 'sonar #'sonar-p "a sonar")

(defun distance-ahead (sonar)
  "Return how far the next wall ahead of SONAR is, in metres, or its range."
  (let* ((robot (sonar-robot sonar)) (map (world-map (robot-world robot))))
    (loop for distance from 0d0 below (sonar-range sonar) by 0.05d0
          when (wall-at-p map
                          (+ (robot-x robot) (* distance (cos (robot-angle robot))))
                          (+ (robot-y robot) (* distance (sin (robot-angle robot)))))
            return distance
          finally (return (sonar-range sonar)))))

(define-command sonar-ping (operation (sonar sonar))
    ((distance "how far the next wall is, in metres"))
    ((:family :looking) (:section "none of it") (:delay 2)
     (:report (distance) (format nil "a wall at ~,2F" distance)))
    "Let SONAR measure how far the next wall ahead is."
  (incf (sonar-pings sonar))
  (setf (sonar-echo sonar)
        (+ (distance-ahead sonar)
           (ars-magna.base:roll-within 0.1d0 (world-dice (robot-world (sonar-robot sonar)) :user))))
  (succeed operation (sonar-echo sonar)))

(define-fluents sonar
  (sonar-distance* "The distance last heard.")
  (sonar-heard* "Pulsed when the sonar has heard something."))

(define-outcome (sonar-ping) (distance)
  (:set sonar-distance* distance)
  (:pulse sonar-heard*))

(in-package :ars-magna.tests)

(eval-when (:compile-toplevel :load-toplevel :execute)
  (sb-ext:add-package-local-nickname :sonar :ars-magna.tests.sonar :ars-magna.tests))

(def-suite* kinds :in ars-magna)

(world:defmap cave (9 9) (rect (0 0) (8 8) slate 3))
(robot:defrobot bat (cave (2.5 4.5) 0)
  :cameras ((1 4)) :parts ((sonar:sonar :range 4d0) (sonar:sonar)))

(defun ears (index) (robot:robot-part bat 'sonar:sonar index))

(defmacro with-bat ((&rest options) &body body)
  `(run:with-simulation (bat ,@options) ,@body))

(test sensor.is-a-part-like-any-other
  (with-bat ()
    (is (eq bat (robot:part-robot (ears 0))))
    (is (= 1 (robot:part-index (ears 1))))
    (is (string= "Sonar 1" (princ-to-string (ears 1))))
    (is (member (ears 0) (robot:robot-parts bat)))
    (is (equal '(sonar:sonar :range 4d0)
               (second (robot::blueprint-parts (robot:robot-blueprint bat)))))
    (signals base:wrong-argument (ears 2))
    (signals base:wrong-argument (sonar:sonar-ping bat))))

(test sensor.answers-its-commands
  (with-bat (:seed 3)
    (let ((heard '()))
      (sonar:sonar-ping (ears 0) (lambda (err sonar distance)
                                   (push (list err sonar distance) heard)))
      (run:run-ticks 5)
      (sonar:sonar-ping (ears 1) (lambda (err sonar distance)
                                   (push (list err sonar distance) heard)))
      (run:run-ticks 1)
      (sonar:sonar-ping (ears 1))
      (run:run-ticks 5)
      (destructuring-bind ((err-1 sonar-1 distance-1) (err-0 sonar-0 distance-0)) heard
        (is (eq :interrupt err-1))
        (is (eq (ears 1) sonar-1))
        (is (null distance-1))
        (is (null err-0))
        (is (eq (ears 0) sonar-0))
        (is (< 3.9 distance-0 4.1) "it hears no farther than 4 metres"))
      (is (< 4.8 (sonar:sonar-echo (ears 1)) 5.2) "the other hears farther"))))

(test sensor.is-digested-and-reset
  (with-bat (:seed 3)
    (let ((fresh (run:state-digest)))
      (incf (sonar:sonar-pings (ears 0)))
      (is (/= fresh (run:state-digest)) "state counts")
      (decf (sonar:sonar-pings (ears 0)))
      (setf (sonar:sonar-echo (ears 0)) 1d0)
      (is (= fresh (run:state-digest)) "memory does not")
      (setf (sonar:sonar-pings (ears 1)) 7)
      (base:reset bat)
      (is (= fresh (run:state-digest)))
      (is (null (sonar:sonar-echo (ears 0))))
      (is (= 0 (sonar:sonar-pings (ears 1)))))))

(test sensor.is-copied
  (with-bat (:seed 3)
    (sonar:sonar-ping (ears 0))
    (run:run-ticks 4)
    (sonar:sonar-ping (ears 1))
    (run:run-ticks 1)
    (let* ((twin (run:fork-simulation time:*simulation*))
           (other (robot:robot-part (first (run:simulation-robots twin)) 'sonar:sonar 1)))
      (is (not (eq other (ears 1))))
      (is (eq (first (run:simulation-robots twin)) (robot:part-robot other)))
      (is (= 0 (sonar:sonar-pings other)))
      (run:run-ticks 5 twin)
      (is (= 1 (sonar:sonar-pings other)) "what was under way goes on there")
      (is (= 0 (sonar:sonar-pings (ears 1))) "and has not yet here")
      (run:run-ticks 5)
      (is (= (run:state-digest) (run:state-digest twin)))
      (is (= (sonar:sonar-echo (ears 1)) (sonar:sonar-echo other))))))

(test sensor.is-in-the-journal
  (let (digest journal)
    (with-bat (:seed 3 :journal t)
      (sonar:sonar-ping (ears 1))
      (run:run-ticks 10)
      (setf digest (run:state-digest)
            journal (end-journal time:*simulation*)))
    (is (equal '((0 sonar:sonar-ping (:the :sonar "BAT" 1))) (run:journal-entries journal)))
    (is (= digest (nth-value 1 (run:replay journal))))
    (with-temporary-file (file)
      (run:write-journal journal file)
      (is (= digest (nth-value 1 (run:replay file)))))))

(test sensor.is-shown-by-status
  (let ((text (joined (type-to 'bat "sonar-ping 0" "status"))))
    (is (search "Sonar 0: pings 1, echo 3.95" text) "~A" text)
    (is (search "Sonar 1: pings 0, echo NIL" text))))

(rpl:def-interp-proc listen-ahead ()
  (rpl:seq (sonar:rpl-sonar-ping 0)
           (rpl:wait-for (svref sonar:sonar-heard* 0))
           (rpl:fluent-value (svref sonar:sonar-distance* 0))))

(test sensor.is-there-for-plans
  (with-bat (:seed 3)
    (driver:rpl-init-robot bat)
    (multiple-value-bind (distance state) (driver:run-plan 'listen-ahead)
      (is (eq :succeeded state))
      (is (< 3.8 distance 4.2))
      (is (eq (ears 1) (driver:rpl-robot-part 'sonar:sonar 1))))))

;;; What kinds say.

(test kinds.describe-their-readers
  (is (search "how often the sonar was asked" (documentation 'sonar:sonar-pings 'function)))
  (is (eql 0 (search "Return " (documentation 'sonar:sonar-pings 'function))))
  (is (eql 0 (search "True if " (documentation 'robot:storage-bin-closed-p 'function)))))

(test kinds.describe-predicates-and-constructors
  (is (eql 0 (search "True of objects of type SONAR. " (documentation 'sonar::sonar-p 'function))))
  (is (eql 0 (search "Return a new object of type SONAR. "
                     (documentation 'sonar::make-sonar 'function)))))

(base:define-record (bat-call (:conc-name call-)
                              (:constructor make-call (pitch &optional loud-p) "Return a call."))
  "What a bat says."
  (pitch 0 fixnum "how high the call is, in kilohertz")
  (loud-p nil boolean "others hear the call" :writable)
  (echo nil t :writable))

(test records.describe-their-functions
  (loop for (text . function) in '(("Return how high the call is, in kilohertz." . call-pitch)
                                   ("True if others hear the call." . call-loud-p)
                                   (nil . call-echo)
                                   ("Return a call." . make-call)
                                   ("True of objects of type BAT-CALL. What a bat says."
                                    . bat-call-p))
        do (is (equal text (documentation function 'function)) "~A" function)))

(test records.can-be-set-only-where-they-say-so
  (is (fboundp '(setf call-loud-p)))
  (is (not (fboundp '(setf call-pitch))))
  (is (not (fboundp 'copy-bat-call))))

(test records.export-the-readers-that-say-so
  (is (equal '((export '(call-echo)) (base:addition call-pitch))
             (base:reader-export-forms '((pitch 0 fixnum "high" :addition)
                                                     (loud-p nil boolean) (echo nil t :export))
                                                   (lambda (slot)
                                                     (base:symbolicate 'call- slot))))))

(test records.reject-what-makes-no-sense
  (dolist (slot '(pitch (pitch) (pitch 0) (pitch 0 :writable)
                  (pitch 0 fixnum "high" :unheard) ("pitch" 0 fixnum)))
    (signals base:malformed-definition
      (macroexpand-1 `(base:define-record bat-call "It." ,slot)))))

(test kinds.show-what-is-in-an-object
  (with-bat ()
    (is (equal '(sonar::pings 0) (subseq (find 'sonar::pings (base:object-slots (ears 0) :state)
                                               :key #'first)
                                         0 2)))
    (let ((text (with-output-to-string (out) (describe (ears 0) out))))
      (is (search "how far the sonar hears" text))
      (is (search "memory" text)))))

(test kinds.reject-what-makes-no-sense
  (signals base:malformed-definition
    (macroexpand-1 '(base:define-kind (thing-of-mine) "Mine." (:status (a 0 fixnum "it")))))
  (signals base:malformed-definition
    (macroexpand-1 '(base:define-kind (thing-of-mine) "Mine." (:state (a 0 fixnum)))))
  (signals base:malformed-definition
    (macroexpand-1 '(robot:defrobot newt (cave (2.5 4.5) 0) :parts ((gills :count 3))))
    (eval '(robot:defrobot newt (cave (2.5 4.5) 0) :parts ((gills :count 3))))))

(test kinds.all-have-roles-and-words
  (is (subsetp '(robot:robot robot:camera robot:hand robot:storage-bin robot:designator
                 robot:odometer world:thing world:attachment command:operation robot:track)
               (mapcar #'base:kind-name (base:all-kinds))))
  (dolist (kind (base:all-kinds))
    (dolist (slot (base:kind-slots kind))
      (is (plusp (length (base:kind-slot-text slot))) "~A ~A" kind (base:kind-slot-name slot)))))
