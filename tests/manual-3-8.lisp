;;;; manual-3-8.lisp -- the scheduler: events, their resources and priorities (manual 3.8).

(in-package :ars-magna.tests)

(def-suite* manual-3-8 :in ars-magna)

(defun now () (ars:simulation-tick))

(defmacro diary ((note &optional (lost (gensym))) &body body)
  "Run BODY in a headless simulation, then pass 30 ticks. In BODY, (NOTE what) notes WHAT and the
tick, and (LOST what) notes that WHAT was interrupted. Return the notes in order, lists (what tick)
and
(:lost what)."
  (let ((entries (gensym)))
    `(let ((,entries '()))
       (with-stroller ()
         (flet ((,note (what) (push (list what (now)) ,entries))
                (,lost (what) (push (list :lost what) ,entries)))
           (declare (ignorable #',lost))
           ,@body
           (ars:run-ticks 30)))
       (reverse ,entries))))

;;; When.

(test manual-3-8.interrupts-are-told-in-the-tick-of-the-event-that-won
  "3.8: an event's handler reads the same tick as its body."
  (let ((ticks '()))
    (is (equal '((b 4))
               (diary (note)
                 (ars:schedule (:arm :timer 9 :interrupt (push (now) ticks)) (note 'a))
                 (ars:run-ticks 3)
                 (ars:schedule (:arm :priority 1) (note 'b)))))
    (is (equal '(4) ticks))))

(test manual-3-8.a-timeout-before-the-timer-frees-the-resource
  "3.8: after the timeout the event evaporates, and another can have the resource."
  (is (equal '((b 5) (:lost c) (d 16))
             (diary (note lost)
               (ars:schedule (:arm :timer 20 :timeout 3 :when t :interrupt (lost 'a)) (note 'a))
               (ars:run-ticks 4)
               (ars:schedule (:arm) (note 'b))
               (ars:run-ticks 1)
               (ars:schedule (:arm :timer 20 :timeout 10 :when t) (note 'never))
               (ars:run-ticks 9)
               (ars:schedule (:arm :interrupt (lost 'c)) (note 'c))
               (ars:run-ticks 1)
               (ars:schedule (:arm) (note 'd))))))

(test manual-3-8.an-event-runs-in-the-next-tick
  "3.8, reading 79: once, in a single tick, by default the next. A timer of 0 means that, too;
another is the number of ticks from now."
  (is (equal '((a 1) (b 1) (c 1) (d 2) (e 7))
             (diary (note)
               (ars:schedule (nil) (note 'a))
               (ars:schedule (nil :timer 0) (note 'b))
               (ars:schedule (nil :timer 1) (note 'c))
               (ars:schedule (nil :timer 7) (note 'e))
               (ars:schedule (nil :timer 2) (note 'd))))))

(test manual-3-8.timers-count-from-scheduling
  "3.8: at whatever tick; their forms are evaluated at once."
  (is (equal '((a 8) (b 10))
             (diary (note)
               (ars:run-ticks 5)
               (let ((delay 3))
                 (ars:schedule (nil :timer delay) (note 'a))
                 (setf delay 5)
                 (ars:schedule (nil :timer delay) (note 'b)))))))

(test manual-3-8.scheduling-returns-at-once-and-nothing
  "3.8, 2.3: a call queues the event; its body runs when ticks pass."
  (is (equal '((before 0) (event 1))
             (diary (note)
               (is (null (multiple-value-list (ars:schedule (nil) (note 'event)))))
               (note 'before)))))

(test manual-3-8.events-of-a-tick-run-in-order-of-queueing
  "3.8: those whose resources differ, or that have none; those of higher priority before."
  (is (equal '((f 4) (a 4) (b 4) (c 4) (d 4) (e 4))
             (diary (note)
               (ars:schedule (nil :timer 4) (note 'a))
               (ars:schedule (:arm :timer 4) (note 'b))
               (ars:schedule (nil :timer 4) (note 'c))
               (ars:schedule (:leg :timer 4) (note 'd))
               (ars:schedule (nil :timer 4 :priority -1) (note 'e))
               (ars:schedule (nil :timer 4 :priority 2) (note 'f))))))

(test manual-3-8.a-body-may-have-many-forms
  "3.8: -body- is the code for the event, and sees the variables around it."
  (let ((x 1))
    (is (equal '((2 1) (3 1))
               (diary (note)
                 (ars:schedule (:arm) (note (incf x)) (note (incf x))))))))

(test manual-3-8.events-can-be-chained
  "3.8: an ongoing process is an event that queues the next, on the same resource too."
  (is (equal '((0 1) (1 4) (2 7) (3 10))
             (diary (note)
               (labels ((next (count)
                          (note count)
                          (when (< count 3)
                            (ars:schedule (:arm :timer 3) (next (1+ count))))))
                 (ars:schedule (:arm) (next 0)))))))

;;; Arbitration.

(test manual-3-8.of-equal-events-the-first-wins
  "3.8, reading 77: the one queued later loses, and its interrupt handler is run."
  (is (equal '((:lost b) (a 1))
             (diary (note lost)
               (ars:schedule (:arm :interrupt (lost 'a)) (note 'a))
               (ars:schedule (:arm :interrupt (lost 'b)) (note 'b))))))

(test manual-3-8.the-higher-priority-wins
  "3.8: whichever comes first; the default priority is 0, and priorities may be negative. The loser
is interrupted."
  (loop for (first second winner loser) in '((0 1 b a) (1 0 a b) (0 -1 a b) (-2 -1 b a) (7 7 a b))
        do (is (equal (list (list :lost loser) (list winner 1))
                      (diary (note lost)
                        (ars:schedule (:arm :priority first :interrupt (lost 'a)) (note 'a))
                        (ars:schedule (:arm :priority second :interrupt (lost 'b)) (note 'b))))
               "~A" (list first second)))
  (is (equal '((:lost a) (b 1))
             (diary (note lost)
               (ars:schedule (:arm :interrupt (lost 'a)) (note 'a))
               (ars:schedule (:arm :priority 1 :interrupt (lost 'b)) (note 'b))))))

(test manual-3-8.a-resource-has-one-pending-event-whatever-its-tick
  "3.8, reading 81: an event for later keeps others off its resource until it has run."
  (is (equal '((:lost b) (a 10) (c 13))
             (diary (note lost)
               (ars:schedule (:arm :timer 10) (note 'a))
               (ars:run-ticks 3)
               (ars:schedule (:arm :interrupt (lost 'b)) (note 'b))
               (ars:run-ticks 9)
               (ars:schedule (:arm) (note 'c))))))

(test manual-3-8.an-event-may-be-bumped-while-it-waits
  "3.8: by one of higher priority, at the moment when that is queued, and then it never runs."
  (is (equal '((:lost a) (b 8))
             (diary (note lost)
               (ars:schedule (:arm :timer 20 :interrupt (lost 'a)) (note 'a))
               (ars:run-ticks 5)
               (ars:schedule (:arm :priority 1 :timer 3) (note 'b))))))

(test manual-3-8.events-of-different-resources-do-not-meet
  "3.8, reading 80: nor do those without a resource meet anything."
  (is (equal '((a 1) (b 1) (c 1) (d 1))
             (diary (note)
               (ars:schedule (:arm) (note 'a))
               (ars:schedule (:leg) (note 'b))
               (ars:schedule (nil) (note 'c))
               (ars:schedule (nil) (note 'd))))))

(test manual-3-8.a-handler-is-optional
  "3.8: an interrupted event without one is just not run."
  (is (equal '((b 1))
             (diary (note)
               (ars:schedule (:arm) (note 'a))
               (ars:schedule (:arm :priority 1) (note 'b))))))

(test manual-3-8.an-event-cannot-be-interrupted-while-it-runs
  "3.8: events that it schedules itself, of any priority, come after it."
  (is (equal '((begun 1) (ended 1) (rival 2))
             (diary (note lost)
               (ars:schedule (:arm :interrupt (lost 'a))
                 (note 'begun)
                 (ars:schedule (:arm :priority 9) (note 'rival))
                 (note 'ended))))))

(test manual-3-8.a-grab-interrupts-what-is-pending
  "3.8, reading 37."
  (is (equal '((:lost a))
             (diary (note lost)
               (ars:schedule (:arm :timer 9 :interrupt (lost 'a)) (note 'a))
               (ars:run-ticks 3)
               (ars:grab-resource :arm)))))

;;; Conditions.

(test manual-3-8.a-test-is-waited-for
  "3.8: with :WHEN the event occurs when, and only if, the test becomes true, once."
  (is (equal '((a 6))
             (diary (note)
               (let ((door :closed))
                 (ars:schedule (nil :timer 6) (setf door :open))
                 (ars:schedule (nil :when (eq door :open)) (note 'a))
                 (ars:schedule (nil :when (eq door :ajar)) (note 'b)))))))

(test manual-3-8.a-test-is-asked-from-its-timer-on
  "3.8: after at least TIME ticks, once a tick; what was true before that does not count."
  (is (equal '((asked 4) (asked 5) (asked 6) (a 6))
             (diary (note)
               (ars:schedule (nil :timer 4
                                  :when (progn (note 'asked)
                                               (or (= 2 (now)) (= 6 (now)))))
                 (note 'a))))))

(test manual-3-8.an-event-evaporates-after-its-timeout
  "3.8, reading 80: it may still occur in the tick of its timeout, which counts from scheduling;
no handler is run, and its resource is free again."
  (flet ((open-at (tick)
           (diary (note lost)
             (ars:run-ticks 10)
             (ars:schedule (:arm :timer 2 :timeout 5 :when (>= (now) tick)
                                 :interrupt (lost 'a))
               (note 'a))
             (ars:run-ticks 6)
             (ars:schedule (:arm) (note 'b)))))
    (is (equal '((a 12) (b 17)) (open-at 3)))
    (is (equal '((a 14) (b 17)) (open-at 14)))
    (is (equal '((a 15) (b 17)) (open-at 15)))
    (is (equal '((b 17)) (open-at 16)))))

(test manual-3-8.a-timeout-needs-a-test
  "3.8, reading 80: without one it is ignored; without a timeout a test is asked for ever."
  (is (equal '((a 9) (b 29))
             (diary (note)
               (ars:schedule (nil :timer 9 :timeout 3) (note 'a))
               (ars:schedule (nil :when (= 29 (now))) (note 'b))))))

(test manual-3-8.who-waits-for-a-test-holds-the-resource
  "3.8, reading 81: and can be bumped while waiting."
  (is (equal '((:lost b) (:lost a) (c 6))
             (diary (note lost)
               (ars:schedule (:arm :when nil :interrupt (lost 'a)) (note 'a))
               (ars:run-ticks 2)
               (ars:schedule (:arm :interrupt (lost 'b)) (note 'b))
               (ars:run-ticks 3)
               (ars:schedule (:arm :priority 1) (note 'c))))))

;;; Events and commands.

(test manual-3-8.commands-take-resources-over
  "3.8, reading 77: a command interrupts an event, even one queued before it; an event of its own
priority, 0, queued after it, loses."
  (let ((code :none))
    (is (equal '((:lost a) (:lost b))
               (diary (note lost)
                 (ars:schedule (stroller :timer 5 :interrupt (lost 'a)) (note 'a))
                 (ars:robot-turn stroller 3 (lambda (err &rest more)
                                              (declare (ignore more))
                                              (setf code err)))
                 (ars:run-ticks 2)
                 (ars:schedule (stroller :interrupt (lost 'b)) (note 'b)))))
    (is (null code) "the turn has ended")))

(test manual-3-8.events-of-higher-priority-interrupt-commands
  "3.8: the command gets :INTERRUPT at the end of the tick, as from another command."
  (is (equal '((a 7) (:interrupt 7))
             (diary (note)
               (ars:robot-go-forward stroller 50 (lambda (err robot)
                                                   (declare (ignore robot))
                                                   (note err)))
               (ars:run-ticks 6)
               (ars:schedule (stroller :priority 1) (note 'a))))))

(test manual-3-8.trouble-in-an-event-is-a-message
  "3.8, reading 86: an error in a body, test or handler; time goes on."
  (with-stroller ()
    (ars:schedule (nil) (error "bad body"))
    (ars:schedule (nil :when (error "bad test")) nil)
    (ars:schedule (:arm) nil)
    (ars:schedule (:arm :interrupt (error "bad handler")) nil)
    (ars:run-ticks 3)
    (let ((texts (texts)))
      (dolist (words '("bad body" "bad test" "bad handler"))
        (is-true (search words texts) "~A" words)))
    (is (= 3 (now)))))

(test manual-3-8.numbers-of-ticks-and-priorities-are-integers
  "3.8: integer priority, some given number of ticks; other values are refused at once."
  (with-stroller ()
    (signals ars:wrong-argument (ars:schedule (nil :priority 1/2) nil))
    (signals ars:wrong-argument (ars:schedule (nil :priority :high) nil))
    (signals ars:wrong-argument (ars:schedule (nil :timer -1) nil))
    (signals ars:wrong-argument (ars:schedule (nil :timer 1.5) nil))
    (signals ars:wrong-argument (ars:schedule (nil :when t :timeout -1) nil))
    (signals ars:wrong-argument (ars:schedule (nil :when t :timeout "soon") nil))
    (is-true (ars:idle-p) "nothing was queued")))
