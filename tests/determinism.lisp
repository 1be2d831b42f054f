;;;; determinism.lisp -- a run is a function of world, parameters, seed and commands.

(in-package :ars-magna.tests)

(def-suite* determinism :in ars-magna)

(defmacro with-temporary-file ((file) &body body)
  "Run BODY with FILE bound to the path of a file that is gone afterwards."
  `(uiop:with-temporary-file (:pathname ,file :type "journal") ,@body))

(defun end-journal (simulation)
  (run:journal-up-to-now simulation))

(test journal.replays-to-the-bit
  "Commands from continuations, parameters set on the way, things changed by hand."
  (let (digest journal)
    (with-rover (:seed 21 :journal t)
      (wander rover (base:make-dice 3))
      (run:run-ticks 300)
      (setf base:motion-noise* 0.5)
      (run:run-ticks 300)
      (world:move-thing (world:find-thing 'crate) (list 6.5 6.5))
      (world:set-attribute (world:find-thing 'crate) :obsmove t)
      (robot:place-robot rover 5 5 1)
      (run:run-ticks 200)
      (robot:make-odometer rover 'trip)
      (run:run-ticks 20)
      (robot:reset-odometer-pos (robot:robot-odometer rover 'trip))
      (robot:reset-odometer (robot:robot-main-odometer rover))
      (run:set-seed 99)
      (time:grab-resource rover)
      (command:robot-goto-wall rover)
      (run:run-ticks 180)
      (setf digest (run:state-digest)
            journal (end-journal time:*simulation*)))
    (is (= 1000 (run:journal-end journal)))
    (is (= digest (nth-value 1 (run:replay journal))))
    (with-temporary-file (file)
      (run:write-journal journal file)
      (is (= digest (nth-value 1 (run:replay file))) "from a file"))))

(world:defkicker jitter (thing) (:prob 0.2)
  (let ((dice (world:world-dice (world:thing-world thing) :user)))
    (world:kick-thing thing 0.3 (base:roll-within 1 dice) t)))

(test journal.repeats-what-is-made-and-unmade
  "Things made, moved, changed, destroyed and given kickers by hand, in memory and on file."
  (let (digests journals)
    (dolist (with-functions '(nil t))
      (with-rover (:seed 25 :journal t)
        (wander rover (base:make-dice 6))
        (run:run-ticks 50)
        (let ((ball (world:make-new-thing 'ball (list arena 3 3) '((:size 1))))
              (pin (world:make-new-thing 'pin (world:find-thing 'crate) '((:size 0.1)))))
          (world:set-kicker ball 'jitter)
          (run:run-ticks 50)
          (world:move-thing pin ball)
          (world:change-attribute ball '((:color red) (:obsmove t)))
          (world:kick-thing ball 2 2 t)
          (when with-functions
            (world:put-kicker shake (thing (world:find-thing 'pillar)) (:prob 0.5)
              (world:kick-thing thing 0.1 0.1 t)))
          (run:run-ticks 50)
          (world:destroy-thing ball))
        (run:run-ticks 50)
        (push (run:state-digest) digests)
        (push (end-journal time:*simulation*) journals)))
    (is (equal digests (loop for journal in journals
                             collect (nth-value 1 (run:replay journal)))))
    (with-temporary-file (file)
      (run:write-journal (second journals) file)
      (is (= (second digests) (nth-value 1 (run:replay file))))
      (handler-case (progn (run:write-journal (first journals) file)
                           (fail "a function was written to a file"))
        (base:misuse (trouble) (is (search "call-put-kicker" (princ-to-string trouble))))))))

(test journal.rewinds-and-forks
  (let (digests journal)
    (with-rover (:seed 22 :journal t)
      (wander rover (base:make-dice 4))
      (run:run-ticks 150)
      (push (run:state-digest) digests)
      (run:run-ticks 150)
      (push (run:state-digest) digests)
      (setf journal (end-journal time:*simulation*)))
    (run:with-replay (journal :until 150)
      (is (= 150 (run:simulation-tick)))
      (is (= (second digests) (run:state-digest)))
      (command:robot-turn rover 1)
      (run:run-ticks 150)
      (is (/= (first digests) (run:state-digest))))
    (is (= (first digests) (nth-value 1 (run:replay journal))))))

(test live.and-headless-alike
  "What a live run did, its journal repeats headless."
  (with-messages
    (let* ((simulation (run:fresh-simulation '(rover) :seed 23 :journal t))
           (robot (first (run:simulation-robots simulation)))
           (ended (base:make-semaphore "ended")))
      (unwind-protect
           (progn
             (run:start-clock simulation :rate :free)
             (labels ((again (left)
                        (if (zerop left)
                            (base:signal-semaphore ended)
                            (command:robot-turn
                             robot (* left 0.3)
                             (lambda (&rest ignore)
                               (declare (ignore ignore))
                               (command:robot-go-forward
                                robot (mod left 5)
                                (lambda (&rest ignore)
                                  (declare (ignore ignore))
                                  (again (1- left)))))))))
               (again 40))
             (is-true (base:wait-on-semaphore ended 60)))
        (run:stop-clock simulation))
      (is (= (run:state-digest simulation)
             (nth-value 1 (run:replay (end-journal simulation))))))))

(test threads.every-continuation-once
  "Eight threads command one live robot; each command is answered exactly once."
  (with-messages
    (let* ((simulation (run:fresh-simulation '(rover) :seed 24))
           (robot (first (run:simulation-robots simulation)))
           (threads 8) (each 500)
           (answers (make-array (* threads each) :initial-element 0)))
      (unwind-protect
           (progn
             (run:start-clock simulation :rate :free)
             (mapc #'base:join-thread
                   (loop for thread below threads
                         collect (let ((thread thread))
                                   (base:start-thread
                                    (lambda ()
                                      (dotimes (i each)
                                        (let ((index (+ i (* thread each))))
                                          (command:robot-turn
                                           robot 0.1
                                           (lambda (&rest ignore)
                                             (declare (ignore ignore))
                                             (incf (aref answers index)))))))
                                    "commander"))))
             (is-true (run:await-idle simulation)))
        (run:stop-clock simulation))
      (is (every (lambda (count) (= 1 count)) answers)))))

(test parallel.simulations-do-not-touch
  "Two runs at once, each in its thread, have the same results as alone."
  (flet ((digest (seed)
           (with-rover (:seed seed)
             (wander rover (base:make-dice seed))
             (run:run-ticks 2000)
             (run:state-digest))))
    (let* ((alone (list (digest 1) (digest 2)))
           (together (list nil nil))
           (threads (loop for seed from 1 to 2
                          collect (let ((seed seed))
                                    (base:start-thread
                                     (lambda () (setf (nth (1- seed) together) (digest seed)))
                                     "trial")))))
      (mapc #'base:join-thread threads)
      (is (equal alone together)))))

;;; The office floor, where much moves by itself.

(defun office-robot (simulation)
  (find 'marvin (run:simulation-robots simulation)
        :key #'robot:robot-name :test #'base:same-name-p))

(defun pace-about (robot count)
  "Make ROBOT turn and drive for ever, by a fixed rule."
  (labels ((next (&rest ignore)
             (declare (ignore ignore))
             (incf count)
             (if (oddp count)
                 (command:robot-turn robot (- (* 0.7d0 (mod count 9)) 2.5d0) #'next)
                 (command:robot-go-forward robot (mod count 13) #'next))))
    (next)))

(defun office-simulation ()
  (run:fresh-simulation (list (robot:find-robot 'marvin)) :seed 7 :journal t))

(defparameter *office-digest* 9074253434097830531
  "The state of the office floor after 100,000 ticks of pacing about with seed 7. It changes when
the office, its kickers, the order of chance or what counts as state does; then it is to be replaced
knowingly.")

(test office.is-the-same-in-every-process
  (with-messages
    (let ((simulation (office-simulation)))
      (pace-about (office-robot simulation) 0)
      (run:run-ticks 100000 simulation)
      (is (= *office-digest* (run:state-digest simulation))))))

;;; What happens in the shipped worlds, whatever a digest may cover.

(defun look-and-pace-about (robot)
  "Make ROBOT turn, drive, look and sense for ever, by a fixed rule."
  (let ((count 0) (camera (robot:robot-camera robot 0)))
    (labels ((next (&rest ignore)
               (declare (ignore ignore))
               (case (mod (incf count) 5)
                 (0 (command:robot-turn robot (- (* 0.7d0 (mod count 9)) 2.5d0) #'next))
                 (1 (command:robot-go-forward robot (mod count 13) #'next))
                 (2 (command:camera-get-all-object-designators camera :non-local '() #'next))
                 (3 (command:camera-view camera #'next))
                 (4 (command:robot-place robot #'next)))))
      (next))))

(defun drive-history (name ticks)
  "Return a number for where the robot NAME is after each of TICKS ticks, and for what is said."
  (let* ((simulation (run:fresh-simulation (list (robot:find-robot name)) :seed 7))
         (robot (first (run:simulation-robots simulation)))
         (digest (base:make-digest)))
    (look-and-pace-about robot)
    (dotimes (tick ticks (base:digest-value digest))
      (run:run-ticks 1 simulation)
      (dolist (datum (list* (robot:robot-x robot) (robot:robot-y robot) (robot:robot-angle robot)
                            (mapcar #'base:message-text (base:take-messages))))
        (base:digest-add digest datum)))))

(defparameter *golden-traces*
  '((ars-worlds:robbie 17382074413652377027) (ars-worlds:marvin 14935912334409045086)
    (ars-worlds:porter 1219317027230082048) (ars-worlds:dot 13298710317008436142))
  "What DRIVE-HISTORY returns for the robots of the shipped worlds, 5,000 ticks each. It changes
when the worlds, their kickers, the messages or the order of chance do; then it is to be replaced
knowingly.")

(test traces.are-the-same-in-every-process
  (loop for (name trace) in *golden-traces*
        do (with-messages
             (is (= trace (drive-history name 5000)) "~A" name))))

(test office.live-replays-headless
  "100,000 ticks of the office floor, live, then its journal."
  (with-messages
    (let ((simulation (office-simulation))
          (over (base:make-semaphore "over")))
      (time:schedule-call (lambda () (time:pause simulation) (base:signal-semaphore over))
                          nil :timer 100000 :simulation simulation)
      (setf (run:simulation-journal simulation) (run:begin-journal simulation))
      (pace-about (office-robot simulation) 0)
      (unwind-protect (progn (run:start-clock simulation :rate :free)
                             (is-true (base:wait-on-semaphore over 120)))
        (run:stop-clock simulation))
      (is (= 100000 (run:simulation-tick simulation)))
      (let ((digest (run:state-digest simulation)))
        (is (= *office-digest* digest))
        (is (= digest (nth-value 1 (run:replay (end-journal simulation)))))))))

(test journal.repeats-what-plans-did
  "A shipped plan, with its odometers, on the noisy office floor; journals have no plans."
  (let (digest journal)
    (run:call-with-simulation
     (lambda ()
       (is (eq :succeeded
               (nth-value 1 (ars-magna.rpl-robot:run-plan
                             'ars-worlds:fetch-thing
                             '((:color world:blue) (:substance world:plastic)) '((109 24))))))
       (setf digest (run:state-digest)
             journal (end-journal time:*simulation*)))
     '(ars-worlds:marvin) :seed 5 :journal t)
    (is (= digest (nth-value 1 (run:replay journal))))))
