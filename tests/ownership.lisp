;;;; ownership.lisp -- several programs drive one robot: the newest does, and it shows which.

(in-package :ars-magna.tests)

(def-suite* ownership :in ars-magna)

(world:defmap rink (30 30)
  (obj puck (15 15) ((:size 1) (:color world:red))))
(robot:defrobot skater (rink (5 5) 0) :cameras ((6 5)) :hands (5))

(rpl:def-interp-proc spin ()
  "Turn for a long time."
  (driver:rpl-robot-turn 9)
  (rpl:wait-for driver:robot-stopped*))

(rpl:def-interp-proc spin-in-parts ()
  (rpl:par (rpl:wait-time 1)
           (rpl:seq (driver:rpl-robot-turn 9)
                    (rpl:wait-for driver:robot-stopped*))))

(defmacro with-skater ((&rest options) &body body)
  `(run:with-simulation (skater :clean t ,@options) ,@body))

(defun owner () (nth-value 1 (command:under-way skater)))
(defun command-and-owner () (multiple-value-list (command:under-way skater)))

(defun at-the-prompt (&rest lines)
  "Type LINES at a prompt on the current simulation; return what it writes, a list of lines."
  (let ((output (make-string-output-stream)))
    (cli:run-session (cli:make-session :input (make-string-input-stream (joined lines))
                                       :output output :batch t))
    (lines-of (get-output-stream-string output))))

(defun from-lisp (text)
  "True if TEXT says that a program, or somebody at a REPL, asked."
  (eql 0 (search "Lisp (" text)))

(test ownership.a-command-knows-who-asked
  (with-skater ()
    (is (equal '(nil) (command-and-owner)))
    (command:robot-turn skater 2)
    (run:run-ticks 1)
    (is (eq 'command:robot-turn (command:under-way skater)))
    (is-true (from-lisp (owner)))
    (run:run-ticks 30)
    (is (equal '(nil) (command-and-owner)) "it is over")
    (is (null (command:last-interruption skater)) "and nothing was interrupted")))

(test ownership.a-robot-that-only-thinks-carries-out-a-thought
  (with-skater (:thinking :charged)
    (command:think skater 50 nil)
    (run:run-ticks 1)
    (is (eq 'command:think (command:under-way skater)))
    (is-true (from-lisp (owner)))
    (command:robot-turn skater 2)
    (run:run-ticks 2)
    (is (eq 'command:robot-turn (command:under-way skater)))
    (is (null (command:last-interruption skater)))
    (command:think skater 3 nil)
    (run:run-ticks 1)
    (is (eq 'command:think (first (command:last-interruption skater))))
    (run:run-ticks 60)
    (is (null (command:under-way skater)))))

(test ownership.a-continuation-asks-for-itself
  (with-skater ()
    (command:robot-turn skater .3 (lambda (err robot angle)
                                    (declare (ignore err angle))
                                    (command:robot-go-forward robot 20)))
    (run:run-ticks 5)
    (is (equal '(command:robot-go-forward "the continuation of robot-turn") (command-and-owner)))))

(test ownership.kickers-and-events-ask-for-themselves
  (with-own-definitions
    (eval '(world:defkicker nudge (thing) () (command:robot-turn skater 9)))
    (with-skater ()
      (world:set-kicker (world:find-thing 'puck) 'nudge)
      (run:run-ticks 3)
      (is (search "nudge" (owner) :test #'char-equal))))
  (with-skater ()
    (time:schedule ('x) (command:robot-turn skater 9))
    (run:run-ticks 3)
    (is (equal "a scheduled event" (owner)))))

(test ownership.a-plan-asks-by-its-name
  (dolist (plan '(spin spin-in-parts))
    (with-skater ()
      (driver:begin-plan plan)
      (run:run-ticks 4)
      (is (equal (list 'command:robot-turn (format nil "the plan ~(~A~)" plan))
                 (command-and-owner))))))

(test ownership.the-newest-of-three-wins-and-says-whom-it-interrupted
  "Lisp, then a plan, then a continuation, then the prompt."
  (with-skater ()
    (let ((answers '()))
      (flet ((answer (name) (lambda (err &rest ignore)
                              (declare (ignore ignore))
                              (push (list name err) answers))))
        (command:robot-turn skater 9 (answer :lisp))
        (run:run-ticks 1)
        (driver:begin-plan 'spin)
        (run:run-ticks 2)
        (is (equal "the plan spin" (owner)))
        (destructuring-bind (what asker by by-asker tick) (command:last-interruption skater)
          (is (equal '(command:robot-turn command:robot-turn "the plan spin")
                     (list what by by-asker)))
          (is-true (from-lisp asker))
          (is (= 3 tick)))
        (command:camera-view (robot:robot-camera skater 0)
                             (lambda (err camera view)
                               (declare (ignore err camera view))
                               (command:robot-go-forward skater 30 (answer :continuation))))
        (run:run-ticks 3)
        (is (equal "the continuation of camera-view" (owner)))
        (is (equal '("the plan spin" "the continuation of camera-view")
                   (list (second (command:last-interruption skater))
                         (fourth (command:last-interruption skater)))))
        (at-the-prompt "turn 5")
        (is (equal '((:continuation :interrupt) (:lisp :interrupt)) answers))
        (is (equal '("the continuation of camera-view" "the prompt")
                   (list (second (command:last-interruption skater))
                         (fourth (command:last-interruption skater)))))))))

(test ownership.of-one-tick-the-last-request-wins
  (with-skater ()
    (driver:begin-plan 'spin)
    (run:run-ticks 1)                     ; asked for at the end of this tick
    (command:robot-go-forward skater 20)
    (run:run-ticks 1)
    (is-true (from-lisp (owner)))
    (is (equal "the plan spin" (second (command:last-interruption skater))))))

(test ownership.of-a-track-is-whose-it-was
  (with-skater ()
    (let ((camera (robot:robot-camera skater 0)))
      (command:camera-get-object-designator
       camera :non-local '((:color world:red))
       (lambda (err camera designator)
         (declare (ignore err))
         (command:camera-track camera designator)))
      (run:run-ticks 20)
      (is (equal '(command:camera-track "the continuation of camera-get-object-designator")
                 (multiple-value-list (command:under-way camera))))
      (command:camera-turn camera 1)
      (run:run-ticks 3)
      (is (equal '(command:camera-track command:camera-turn)
                 (list (first (command:last-interruption camera))
                       (third (command:last-interruption camera)))))
      (is (null (command:under-way camera))))))

(test ownership.of-what-is-grabbed-is-noted
  (with-skater ()
    (command:robot-turn skater 9)
    (run:run-ticks 1)
    (time:grab-resource skater)
    (run:run-ticks 1)
    (is (null (command:under-way skater)))
    (is (eq 'time::grab (third (command:last-interruption skater))))))

(test ownership.is-shown-at-the-prompt-and-in-displays
  (with-skater ()
    (command:robot-turn skater 9)
    (run:run-ticks 2)
    (flet ((line (start lines) (find-if (lambda (line) (eql 0 (search start line))) lines)))
      (let ((status (at-the-prompt "status")))
        (is (eql 0 (search "Under way:         robot-turn, for Lisp (" (line "Under way" status))))
        (is (null (line "Interrupted" status))))
      (driver:begin-plan 'spin)
      (run:run-ticks 2)
      (let ((status (at-the-prompt "status")))
        (is (equal "Under way:         robot-turn, for the plan spin" (line "Under way" status)))
        (is (eql 0 (search "Interrupted:       robot-turn, for Lisp (" (line "Interr" status))))
        (is (search "by robot-turn, for the plan spin, at tick 4" (line "Interr" status)))))
    (is (search "Under way: robot-turn, for the plan spin"
                (display::svg-picture skater :display :state)))))

(test ownership.decides-nothing
  "Neither digest nor journal depend on who asks; a replay asks for the journal."
  (flet ((digest-for (asker)
           (with-skater (:journal t)
             (let ((base:*asker* asker)) (command:robot-turn skater 9))
             (run:run-ticks 3)
             (is (equal (run:state-digest) (run:state-digest)))
             (list (run:state-digest) (run:journal-entries
                                       (run:simulation-journal time:*simulation*))))))
    (is (equal (digest-for "the prompt") (digest-for '("kicker " 5)))))
  (let ((journal (with-skater (:journal t)
                   (command:robot-turn skater 9)
                   (run:run-ticks 3)
                   (run:simulation-journal time:*simulation*))))
    (run:with-replay (journal)
      (is (equal "the journal"
                 (nth-value 1 (command:under-way
                               (first (run:simulation-robots time:*simulation*)))))))))

(test ownership.live-three-drivers-take-turns
  "A plan in its own thread, a continuation in the simulator's, and this thread."
  (let ((driver::*default-interface* nil) (time:*simulation* nil) (world:*world* nil)
        (*standard-output* (make-broadcast-stream)))
    (with-messages
      (unwind-protect
           (progn
             (run:simulator skater :rate :free :seed 1)
             (driver:rpl-init-robot skater)
             (let ((camera (robot:robot-camera skater 0)))
               (command:robot-set-turn-angle skater .05)
               (driver:begin-plan (rpl:interp-lambda ()
                                    (driver:rpl-robot-turn 500000000)
                                    (rpl:wait-for driver:robot-stopped*)))
               (awaiting (search "the plan" (or (owner) "")))
               (command:camera-view camera (lambda (err camera view)
                                             (declare (ignore err camera view))
                                             (command:robot-turn skater 500000000)))
               (awaiting (equal "the continuation of camera-view" (owner)))
               (is (search "the plan" (second (command:last-interruption skater))))
               (command:robot-turn skater 500000000)
               (awaiting (from-lisp (or (owner) "")))
               (is (equal "the continuation of camera-view"
                          (second (command:last-interruption skater))))))
        (run:stop-simulator)))))
