;;;; doors.lisp -- doors, which are like walls while they are closed.

(in-package :ars-magna.tests)

(def-suite* doors :in ars-magna)

;;; Two rooms. A door is in the upper doorway; the lower doorway has a door that is open.

(world:defmap lodge (15 13)
  (rect (0 0) (14 12) plaster 10)
  (wall (7 0) (7 3) plaster 20)
  (wall (7 5) (7 10) plaster 20)
  (wall (7 12) (7 12) plaster 20)
  (obj (gate :prototype ars-worlds:door*) (7.5 4.5) ((:lock-id 4)))
  (obj (hatch :prototype ars-worlds:door*) (7.5 11.5) ((:closed nil)))
  (obj (key :prototype ars-worlds:key*) (2.5 8.5) ((:lock-id 4)))
  (obj ball (6.5 4.5) ((:size 1) (:weight 1) (:color red)))
  (obj vase (12.5 4.5) ((:size 1) (:color blue))))

(robot:defrobot steward (lodge (3.5 4.5) 0)
  :cameras ((1 9)) :hands (10 10) :parts ((robot:rangefinder :maximum 20)))
(robot:defrobot maid (lodge (3.5 7.5) 0))

(defmacro in-lodge ((&rest options) &body body)
  `(run:with-simulation (steward :clean t :seed 1 ,@options) ,@body))

(defun gate () (world:find-thing 'gate))
(defun set-gate (closed) (world:set-attribute (gate) :closed closed))

(defun end-of (command &rest arguments)
  "Issue COMMAND, and pass ticks until it has ended. Return its error code and first result."
  (let ((end nil))
    (apply command (append arguments
                           (list (lambda (err resource &rest results)
                                   (declare (ignore resource))
                                   (unless end (setf end (list err (first results))))))))
    (run:run-until (lambda () end) :limit 200)
    end))

(defun steward-camera () (robot:robot-camera steward 0))

(defun seen-by-steward (specification type)
  (first (end-of #'command:camera-get-object-designator (steward-camera) type specification)))

;;; Way, view and place.

(test door.is-a-wall-while-closed
  (in-lodge ()
    (is (eq nil (first (end-of #'command:robot-goto-wall steward))))
    (is (< 6.99 (robot:robot-x steward) 7))
    (is (eq :robot-blocked (first (end-of #'command:robot-go-distance steward 1))))
    (set-gate nil)
    (is (eq nil (first (end-of #'command:robot-goto-wall steward))))
    (is (< 13.99 (robot:robot-x steward) 14))))

(test door.blocks-the-view-while-closed
  (in-lodge ()
    (is (eq :designator-not-found (seen-by-steward '((:color blue)) :non-local)))
    (is (= 3.5d0 (first (second (end-of #'command:rangefinder-read
                                        (robot:robot-part steward 'robot:rangefinder 0))))))
    (set-gate nil)
    (is (eq nil (seen-by-steward '((:color blue)) :non-local)))
    (is (= 10.5d0 (first (second (end-of #'command:rangefinder-read
                                         (robot:robot-part steward 'robot:rangefinder 0))))))))

(test door.is-seen-as-a-thing-open-or-closed
  (in-lodge ()
    (dolist (closed '(t nil))
      (set-gate closed)
      (is (eq nil (seen-by-steward `((:door t) (:closed ,closed)) :non-local)))
      (is (eq :designator-not-found
              (seen-by-steward `((:door t) (:closed ,(not closed))) :non-local))))))

(test doorway.is-a-place-only-while-its-door-is-open
  (in-lodge ()
    (flet ((sensed () (list (first (end-of #'command:camera-get-place-designator
                                           (steward-camera) 'doorway))
                            (progn (robot:place-robot steward 7.5 4.5 0)
                                   (second (end-of #'command:robot-place steward)))
                            (progn (end-of #'command:robot-align-place steward)
                                   (first (end-of #'command:robot-align-place steward)))
                            (robot:place-robot steward 3.5 4.5 0))))
      (is (equal '(:designator-not-found nil :no-place-type) (butlast (sensed))))
      (set-gate nil)
      (is (equal '(nil doorway nil) (butlast (sensed)))))))

(test doorway.is-no-place-for-noisy-senses-either
  (run:with-simulation (steward :parameters '((base:type-false-pos* 0) (base:type-false-neg* 0)))
    (robot:place-robot steward 7.5 4.5 0)
    (is (eq nil (second (end-of #'command:robot-place steward))))
    (set-gate nil)
    (is (eq 'doorway (second (end-of #'command:robot-place steward))))))

(test track-of-a-doorway-ends-when-its-door-closes
  (in-lodge ()
    (set-gate nil)
    (let ((place (second (end-of #'command:camera-get-place-designator (steward-camera) 'doorway)))
          (codes '()))
      (command:camera-track (steward-camera) place
                            (lambda (err &rest ignore)
                              (declare (ignore ignore))
                              (push err codes)))
      (run:run-ticks 20)
      (is (equal '(nil) codes))
      (set-gate t)
      (run:run-ticks 2)
      (is (= 2 (length codes)))
      (is (null (robot:camera-tracks (steward-camera)))))))

(test door.is-followed-as-a-wall
  (flet ((end (closed)
           (in-lodge ()
             (set-gate closed)
             (robot:place-robot steward 6.5 1.5 (/ pi 2))
             (end-of #'command:robot-follow-wall steward)
             (robot:robot-y steward))))
    (is (< 10 (end t)) "past the closed door, up to the hatch")
    (is (< (end nil) 5))))

(test door.stops-what-is-kicked
  (in-lodge ()
    (let ((ball (world:find-thing 'ball)))
      (is (null (world:kick-thing ball 1 0 nil)))
      (is (= 6.5d0 (world:thing-x ball)))
      (is-true (world:kick-thing ball 1 0 t))
      (is (/= 7 (floor (world:thing-x ball))) "beside the door")
      (world:move-thing ball '(6.5 4.5))
      (set-gate nil)
      (is-true (world:kick-thing ball 1 0 nil))
      (is (= 7.5d0 (world:thing-x ball))))))

(test door.needs-the-attribute-and-the-floor
  (in-lodge ()
    (flet ((closed-p (descriptor)
             (world:closed-door-p (world:make-new-thing 'slab '(lodge 10.5 10.5) descriptor))))
      (is (eq t (closed-p '((:door t) (:closed t)))))
      (is (null (closed-p '((:door t)))))
      (is (null (closed-p '((:closed t)))))
      (is (null (closed-p '((:door nil) (:closed t))))))
    (world:move-thing (gate) (robot:robot-hand steward 0))
    (is-true (world:closed-door-p (gate)))
    (is (eq nil (first (end-of #'command:robot-goto-wall steward))))
    (is (< 13.99 (robot:robot-x steward) 14) "a door in a hand leaves the doorway free")
    (world:move-thing (gate) '(7.5 4.5))
    (world:set-attribute (gate) :door nil)
    (robot:place-robot steward 3.5 4.5 0)
    (is (eq nil (first (end-of #'command:robot-goto-wall steward))))
    (is (< 13.99 (robot:robot-x steward) 14))))

(robot:defrobot ajar (lodge (10.5 7.5) 0) :attributes ((:door t) (:closed t)))

(test door.is-no-body
  (run:with-simulation ((steward ajar) :clean t)
    (let ((body (robot:robot-body ajar)))
      (is (null (world:closed-door-p body)))
      (robot:place-robot steward 9.5 7.5 0)
      (is (eq :robot-blocked (first (end-of #'command:robot-goto-wall steward)))))))

;;; Manipulations.

(defun local-designator (specification)
  (second (end-of #'command:camera-get-object-designator (steward-camera) :local specification)))

(defun handle-gate (name &optional (hand 0) (key nil))
  "Do the manipulation NAME on the gate until it does not fail by chance. Return its code."
  (loop repeat 10
        for objects = (cons (local-designator '((:door t)))
                            (and key (list (local-designator '((:type :key))))))
        for code = (let ((end :none))
                     (apply #'command:run-manipulation name
                            (append objects
                                    (list (robot:robot-hand steward hand)
                                          (lambda (err value)
                                            (declare (ignore value))
                                            (setf end err)))))
                     (run:run-until (lambda () (not (eq :none end))) :limit 50)
                     end)
        until (not (eq :failed code))
        finally (return code)))

(test doors.are-opened-and-closed-by-hands
  (in-lodge ()
    (robot:place-robot steward 6.9 4.2 0)
    (is (eq :already-closed (handle-gate 'close)))
    (is (eq nil (handle-gate 'open)))
    (is (null (world:closed-door-p (gate))))
    (is (eq :already-open (handle-gate 'open)))
    (is (eq nil (handle-gate 'close)))
    (is-true (world:closed-door-p (gate)))
    (world:move-thing (world:find-thing 'ball) (robot:robot-hand steward 0))
    (is (eq :hand-full (handle-gate 'open)))
    (is (eq nil (handle-gate 'open 1)))))

(test doors.are-not-closed-on-what-is-in-the-doorway
  (in-lodge ()
    (set-gate nil)
    (robot:place-robot steward 7.5 4.5 0)
    (is (eq :doorway-occupied (handle-gate 'close)))
    (robot:place-robot steward 6.9 4.2 0)
    (world:move-thing (world:find-thing 'ball) '(7.2 4.2))
    (is (eq :doorway-occupied (handle-gate 'close)))
    (world:move-thing (world:find-thing 'ball) '(10 10))
    (is (eq nil (handle-gate 'close))))
  (run:with-simulation ((steward maid) :clean t :seed 1)
    (set-gate nil)
    (robot:place-robot steward 6.9 4.2 0)
    (robot:place-robot maid 7.5 4.5 0)
    (is (eq :doorway-occupied (handle-gate 'close)))))

(test doors.are-locked-with-their-keys
  (in-lodge ()
    (robot:place-robot steward 6.9 4.2 0)
    (is (eq :key-not-in-hand
            (progn (world:move-thing (world:find-thing 'key) '(6.8 4.1))
                   (handle-gate 'lock 1 t))))
    (world:move-thing (world:find-thing 'key) (robot:robot-hand steward 1))
    (is (eq nil (handle-gate 'ars-worlds:lock 1 t)))
    (is (eq :locked (handle-gate 'open)))
    (is (eq nil (handle-gate 'ars-worlds:unlock 1 t)))
    (is (eq nil (handle-gate 'open)))
    (is (eq :door-open (handle-gate 'ars-worlds:lock 1 t)))
    (world:set-attribute (gate) :lock-id 5)
    (set-gate t)
    (is (eq :failed (handle-gate 'ars-worlds:lock 1 t)) "another key's lock")))

;;; State.

(defun gate-and-digest ()
  (list (world:closed-door-p (gate)) (run:state-digest)))

(test doors.are-digested-forked-rewound-saved-and-repeated
  (in-lodge (:journal t :keep t)
    (let ((closed (run:state-digest)))
      (set-gate nil)
      (is (/= closed (run:state-digest)))
      (set-gate t)
      (is (= closed (run:state-digest))))
    (robot:place-robot steward 6.9 4.2 0)
    (handle-gate 'open)
    (let ((then (gate-and-digest)) (tick (run:simulation-tick)) (fork (run:fork-simulation)))
      (run:run-ticks 1)
      (is (eq nil (handle-gate 'close)))
      (let ((later (gate-and-digest)))
        (is (null (world:world-invariant-violations world:*world*)))
        (is (equal then (run:call-in-fork fork #'gate-and-digest)))
        (is-true (replays-p time:*simulation*))
        (with-temporary-file (file)
          (run:save-simulation file)
          (run:with-loaded-simulation (file)
            (is (equal later (gate-and-digest)))
            (is (null (world:world-invariant-violations world:*world*)))
            (robot:place-robot steward 3.5 4.5 0)
            (end-of #'command:robot-goto-wall (first (run:simulation-robots)))
            (is (< (robot:robot-x (first (run:simulation-robots))) 7)))))
      (run:rewind (- (run:simulation-tick) tick))
      (is (equal then (gate-and-digest))))))

;;; Ways and plans.

(defun way-xs (&rest options)
  "Return the points of the way between the rooms of the lodge."
  (loop for point in (apply #'ways:find-way 'lodge '(3.5 4.5) '(11.5 4.5) options)
        collect (list (geo:pt-x point) (geo:pt-y point))))

(test ways.avoid-the-doors-that-are-believed-closed
  (is (equal '((3.5d0 4.5d0) (11.5d0 4.5d0)) (way-xs)))
  (is (find 11.5d0 (way-xs :closed '((7.5 4.5))) :key #'second))
  (is (equal (way-xs :closed '((7 4))) (way-xs :closed (list (geo:make-pt 7.9 4.1)))))
  (is (null (way-xs :closed '((7.5 4.5) (7.5 11.5)))))
  (is (equal '((3.5d0 4.5d0) (11.5d0 4.5d0)) (way-xs)) "nothing is remembered")
  (let ((chart (ways:bar-cell (ways:make-chart 'lodge) '(7.5 11.5))))
    (is (null (ways:find-way chart '(3.5 4.5) '(11.5 4.5) :closed '((7.5 4.5)))))
    (is (= 1 (length (ways:barred-cells chart))))
    (is (= 2 (length (ways:find-way chart '(3.5 4.5) '(11.5 4.5))))))
  (signals base:wrong-argument (way-xs :closed '(7.5 4.5)))
  (signals base:wrong-argument (way-xs :closed '((70 4.5))))
  (signals base:wrong-argument (way-xs :closed :all)))

(test ways.do-not-depend-on-the-doors-of-a-run
  (in-lodge () (is (equal '((3.5d0 4.5d0) (11.5d0 4.5d0)) (way-xs)))))

(test programs.that-meet-a-closed-door-go-round
  (dotimes (seed 5)
    (run:with-simulation (steward :seed seed)
      (is (eq nil (first (end-of #'ars-worlds:robot-go-to steward 11.5 4.5))))
      (is (< 10 (robot:robot-x steward) 13) "seed ~D" seed)
      (is-true (world:closed-door-p (gate))))))

(rpl:def-interp-proc cross-lodge (closed)
  (ars-worlds:travel-to (ars-worlds:begin-reckoning (ars-worlds:here (driver:rpl-robot)))
                        '(11.5 4.5) :closed closed)
  (rpl:plan-time))

(defun crossing-of-lodge (seed hatch-closed-p &optional closed)
  "Return the values of RUN-PLAN of a drive into the other room."
  (run:with-simulation (steward :seed seed)
    (world:set-attribute (world:find-thing 'hatch) :closed hatch-closed-p)
    (multiple-value-list (driver:run-plan 'cross-lodge closed))))

(test travel-to.goes-another-way-at-a-closed-door
  (dotimes (seed 4)
    (destructuring-bind ((found how) (known known-how))
        (list (crossing-of-lodge seed nil) (crossing-of-lodge seed nil '((7.5 4.5))))
      (is (equal '(:succeeded :succeeded) (list how known-how)) "seed ~D" seed)
      (is (< known found 200) "seed ~D" seed))))

(test travel-to.fails-if-all-doors-are-closed-and-names-them
  (dotimes (seed 4)
    (destructuring-bind (failure how) (crossing-of-lodge seed t)
      (is (eq :failed how))
      (is (eq :cannot-get-there (rpl:failure-class failure)))
      (is (= 2 (length (getf (rpl:failure-data failure) :closed))) "seed ~D" seed)
      (is-true (member '(7.5 4.5) (getf (rpl:failure-data failure) :closed) :test #'equal))))
  (is (search "travel-to: :closed is (7 4); give a list of points"
              (princ-to-string (first (crossing-of-lodge 1 nil '(7 4)))))))

(rpl:def-interp-proc close-behind ()
  (let ((me (ars-worlds:begin-reckoning (ars-worlds:here (driver:rpl-robot)))))
    (ars-worlds:visit-thing me 0 '((:door t) (:closed nil)))
    (ars-worlds:manipulate-thing 'close 0 0 '((:door t)))))

(test robots.close-the-door-of-the-doorway-that-they-visit-behind-them
  (dotimes (seed 4)
    (run:with-simulation (steward :seed seed)
      (robot:place-robot steward 3.5 11.5 0)
      (is (eq :succeeded (nth-value 1 (driver:run-plan 'close-behind))))
      (is-true (world:closed-door-p (world:find-thing 'hatch)))
      (is (< 8 (robot:robot-x steward) 8.5)))))

;;; For people.

(test doors.are-shown-open-or-closed
  (in-lodge ()
    (flet ((shown () (list (display:text-map steward)
                           (display:svg-picture steward :layers '()))))
      (destructuring-bind ((text picture) (open-text open-picture))
          (list (shown) (progn (set-gate nil) (shown)))
        (is-true (has-words-p text "% GATE, closed" "HATCH"))
        (is (not (mentions-p open-text "closed")))
        (is (string/= picture open-picture))))))
