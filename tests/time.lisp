;;;; time.lisp -- the agenda, the tick, schedule and threads.

(in-package :ars-magna.tests)

(def-suite* time :in ars-magna)

(world:defmap bare (3 3))

(defun bare-simulation ()
  "Return a simulation of a world with nothing in it."
  (let ((world (world:make-world (world:find-map 'bare))))
    (run::ensure-timeline world)
    (run::make-simulation world)))

(defmacro with-bare-simulation ((variable) &body body)
  "Run BODY with VARIABLE bound to a simulation of nothing."
  `(with-messages
     (let* ((,variable (bare-simulation))
            (time:*simulation* ,variable))
       ,@body)))

;; A request that calls a function.
(defstruct (errand (:include time:request) (:constructor make-errand (function))) function)

(defmethod time:perform ((errand errand) timeline)
  (declare (ignore timeline))
  (funcall (errand-function errand)))

(defmacro recording ((record) &body body)
  "Run BODY, in which (RECORD datum) remembers DATUM; return the data in order."
  (let ((data (gensym)))
    `(let ((,data '()))
       (flet ((,record (datum) (push datum ,data)))
         ,@body)
       (reverse ,data))))

;;; Agenda.

(test agenda.runs-each-event-in-its-tick
  "Delays of all sizes, over pages and volumes of the wheel, against their due times."
  (let* ((agenda (time:make-agenda)) (dice (base:make-dice 5)) (late 0) (ran 0))
    (dotimes (i 3000)
      (let ((delay (ceiling (expt 10 (base:roll-between 0 6.3 dice)))))
        (time:queue-event agenda delay
                          (lambda (event)
                            (declare (ignore event))
                            (incf ran)
                            (unless (= delay (time:agenda-tick agenda)) (incf late))))))
    (is (= 3000 (time:agenda-pending agenda)))
    (loop repeat 2000000 do (time:advance-agenda agenda))
    (is (= 0 late))
    (is (= 3000 ran))
    (is (= 0 (time:agenda-pending agenda)))))

(test agenda.keeps-the-order-of-queueing
  "Events for one tick, queued from far and from near, run in the order in which they were queued."
  (let ((agenda (time:make-agenda)))
    (is (equal (loop for i below 40 collect i)
               (recording (record)
                 (dotimes (i 40)
                   (let ((i i))
                     (time:queue-event agenda (- 3000000 (time:agenda-tick agenda))
                                       (lambda (event) (declare (ignore event)) (record i))))
                   (loop repeat (if (< i 20) 100000 49000)
                         do (time:advance-agenda agenda)))
                 (loop until (zerop (time:agenda-pending agenda))
                       do (time:advance-agenda agenda)))))))

(test agenda.priority-comes-before-order
  (let ((agenda (time:make-agenda)))
    (is (equal '(:high :first :second :low)
               (recording (record)
                 (loop for (name priority) in '((:first 0) (:low -1) (:second 0) (:high 3))
                       do (let ((name name))
                            (time:queue-event agenda 4 (lambda (event)
                                                         (declare (ignore event))
                                                         (record name))
                                              :priority priority)))
                 (loop repeat 4 do (time:advance-agenda agenda)))))))

(test agenda.cancelled-events-never-run
  (let* ((agenda (time:make-agenda)) (ran nil)
         (event (time:queue-event agenda 2 (lambda (e) (declare (ignore e)) (setf ran t))
                                  :resource :x)))
    (is (eq event (time:pending-event agenda :x)))
    (time:cancel-event agenda event)
    (is (null (time:pending-event agenda :x)))
    (loop repeat 5 do (time:advance-agenda agenda))
    (is-false ran)
    (is (= 0 (time:agenda-pending agenda)))))

;;; Schedule (manual 3.8).

(test schedule.default-is-the-next-tick
  (with-bare-simulation (s)
    (is (equal '(1 1 4)
               (recording (record)
                 (time:schedule (nil) (record (run:simulation-tick)))
                 (time:schedule (nil :timer 0) (record (run:simulation-tick)))
                 (time:schedule (nil :timer 4) (record (run:simulation-tick)))
                 (run:run-ticks 10))))))

(test schedule.the-first-of-equals-stays-the-higher-wins
  (with-bare-simulation (s)
    (is (equal '(:second-lost :first-lost :third)
               (recording (record)
                 (time:schedule (:arm :interrupt (record :first-lost)) (record :first))
                 (time:schedule (:arm :interrupt (record :second-lost)) (record :second))
                 (time:schedule (:arm :priority 1) (record :third))
                 (run:run-ticks 3))))))

(test schedule.when-and-timeout
  (with-bare-simulation (s)
    (is (equal '((:true 8))
               (recording (record)
                 (time:schedule (nil :timer 3 :when (>= (run:simulation-tick) 8) :timeout 20)
                   (record (list :true (run:simulation-tick))))
                 (time:schedule (nil :when (>= (run:simulation-tick) 8) :timeout 5)
                   (record :evaporated))
                 (time:schedule (nil :when nil :timeout 5 :interrupt (record :interrupted))
                   (record :never))
                 (run:run-ticks 30))))
    (is-true (run:idle-p s))))

(test schedule.an-event-can-queue-the-next
  (with-bare-simulation (s)
    (is (equal '(1 3 5 7)
               (recording (record)
                 (labels ((again ()
                            (record (run:simulation-tick))
                            (time:schedule (:chain :timer 2) (again))))
                   (time:schedule (:chain) (again))
                   (run:run-ticks 8)))))))

(test schedule.waits-its-turn-among-requests
  "What is asked of a resource is taken in the order of asking."
  (with-bare-simulation (s)
    (is (equal '(:mine)
               (recording (record)
                 (time:grab-resource :a)
                 (time:schedule (:a) (record :mine))
                 (run:run-ticks 3)))
        "a grab does not take what is asked for after it")
    (is (equal '(:lost)
               (recording (record)
                 (time:schedule (:a :timer 2 :interrupt (record :lost)) (record :mine))
                 (time:grab-resource :a)
                 (run:run-ticks 3))))))

(test schedule.an-interrupted-event-may-ask-again
  "The event that an :interrupt form schedules meets the winner, and only one is pending."
  (with-bare-simulation (s)
    (is (equal '(:again-lost :high)
               (recording (record)
                 (time:schedule (:arm :timer 5
                                      :interrupt (time:schedule
                                                     (:arm :interrupt (record :again-lost))
                                                   (record :again)))
                   (record :low))
                 (time:schedule (:arm :timer 3 :priority 1) (record :high))
                 (run:run-ticks 2)
                 (is (= 1 (time:agenda-pending (run:simulation-agenda s))))
                 (run:run-ticks 10))))))

(test schedule.does-not-outlive-its-timeout
  (with-bare-simulation (s)
    (is (equal '((:last 4))
               (recording (record)
                 (time:schedule (nil :when t :timer 8 :timeout 4) (record :too-late))
                 (time:schedule (nil :when t :timer 4 :timeout 4)
                   (record (list :last (run:simulation-tick))))
                 (time:schedule (:gate :when nil :timeout 3) (record :never))
                 (run:run-ticks 3)
                 (is (null (time:pending-event (run:simulation-agenda s) :gate)))
                 (run:run-ticks 20))))))

(test schedule.resources-that-look-the-same-are
  (with-bare-simulation (s)
    (is (equal '(:lost :lost :first :first)
               (recording (record)
                 (loop for resource in (list (list :door 3) "gate")
                       do (time:schedule ((copy-seq resource)) (record :first))
                          (time:schedule ((copy-seq resource) :interrupt (record :lost))
                            (record :second)))
                 (run:run-ticks 2))))))

(test schedule.trouble-in-a-body-is-reported
  (with-bare-simulation (s)
    (time:schedule (nil) (error "bad body"))
    (run:run-ticks 2)
    (is (search "bad body" (displayed)))
    (is (= 2 (run:simulation-tick)))))

(test schedule.rejects-what-is-no-number
  (with-bare-simulation (s)
    (signals base:wrong-argument (time:schedule (nil :timer -1) nil))
    (signals base:wrong-argument (time:schedule (nil :priority :high) nil))))

;;; Ticks.

(test ticks.have-their-order
  "Requests, events, kickers, tracks and grips, notifications, observers."
  (with-messages
    (is (equal '(:request :event :kicker :notification :observer)
               (recording (record)
                 (let* ((s (bare-simulation))
                        (thing (world:make-new-thing 'gnome (list (run:simulation-world s) 1 1)
                                                     '((:size 1)))))
                   (world:call-put-kicker thing 'note
                                          :body (lambda (thing)
                                                  (declare (ignore thing))
                                                  (record :kicker)
                                                  (time:notify-later
                                                   (time:timeline-of s)
                                                   (lambda () (record :notification)))))
                   (time:schedule-call (lambda () (record :event)) nil :simulation s)
                   (time:post (make-errand (lambda () (record :request))) s)
                   (run:add-observer (lambda (s) (declare (ignore s)) (record :observer)) s)
                   (run:run-ticks 1 s)))))))

(test ticks.run-until-a-predicate-or-a-limit
  (with-bare-simulation (s)
    (is (equal '(t 5) (multiple-value-list
                       (run:run-until (lambda () (= 5 (run:simulation-tick)))))))
    (is (equal '(nil 12) (multiple-value-list
                          (run:run-until (constantly nil) :limit 7))))))

(test ticks.no-simulation-names-the-remedy
  (let ((time:*simulation* nil))
    (handler-case (progn (run:run-ticks 1) (fail "ran"))
      (base:misuse (trouble) (is (search "with-simulation" (princ-to-string trouble)))))))

;;; Live.

(defun wait-for-event (simulation timer)
  "Wait until TIMER ticks of the live SIMULATION have passed; true if that came to be."
  (let ((passed (base:make-semaphore "passed")))
    (time:schedule-call (lambda () (base:signal-semaphore passed)) nil
                        :timer timer :simulation simulation)
    (base:wait-on-semaphore passed 60)))

(defmacro with-live ((simulation rate) &body body)
  `(unwind-protect (progn (run:start-clock ,simulation :rate ,rate) ,@body)
     (run:stop-clock ,simulation)))

(test live.ticks-pass-by-themselves
  (with-bare-simulation (s)
    (with-live (s :free)
      (is-true (wait-for-event s 5000))
      (is-true (run:await-idle s))
      (let ((tick (time:ask s (lambda () (run:simulation-tick s)))))
        (is (>= tick 5000))
        (is (= tick (time:ask s (lambda () (run:simulation-tick s)))) "idle time stands still")))
    (is-false (time:live-p s))))

(test live.pause-step-resume
  (with-bare-simulation (s)
    (with-live (s :free)
      (time:pause s)
      (let ((stepped (base:make-semaphore "stepped")))
        (time:schedule-call (lambda () (base:signal-semaphore stepped)) nil :simulation s)
        (is (= 0 (time:ask s (lambda () (run:simulation-tick s)))))
        (run:step-ticks 1 s)
        (is-true (base:wait-on-semaphore stepped 60))
        (time:schedule-call (lambda () (base:signal-semaphore stepped)) nil :timer 50
                                                                            :simulation s)
        (time:resume s)
        (is-true (base:wait-on-semaphore stepped 60))))))

(test live.pause-holds-the-tick-that-is-due
  (with-bare-simulation (s)
    (with-live (s 1/100)
      (flet ((tick () (time:ask s (lambda () (run:simulation-tick s)))))
        (time:schedule-call (lambda () nil) nil :timer 50 :simulation s)
        (tick)
        (time:pause s)
        (let ((before (tick)))
          (time:set-rate :free s)
          (is (equal (list before before before) (list (tick) (tick) (tick)))))))))

(test live.resume-takes-effect-at-once-though-the-clock-saw-no-pause
  "The clock's thread is busy from PAUSE to RESUME. A tick takes a hundred seconds."
  (with-bare-simulation (s)
    (with-live (s :free)
      (let ((busy (base:make-semaphore "busy"))
            (go-on (base:make-semaphore "go on"))
            (passed (base:make-semaphore "passed")))
        (time:ask-later s (lambda ()
                            (base:signal-semaphore busy)
                            (base:wait-on-semaphore go-on 60)))
        (is-true (base:wait-on-semaphore busy 60))
        (time:pause s)
        (time:set-rate 1/100 s)
        (time:schedule-call (lambda () (base:signal-semaphore passed)) nil :simulation s)
        (time:resume s)
        (base:signal-semaphore go-on)
        (is-true (base:wait-on-semaphore passed 60))))))

(test live.run-ticks-is-refused
  (with-bare-simulation (s)
    (with-live (s 20)
      (signals base:misuse (run:run-ticks 1 s))
      (signals base:misuse (run:start-clock s)))
    (signals base:wrong-argument (run:start-clock s :rate 0))))

(test live.questions-bring-back-values-and-errors
  (with-bare-simulation (s)
    (with-live (s :free)
      (is (equal '(1 2) (multiple-value-list (time:ask s (lambda () (values 1 2))))))
      (signals base:misuse (time:ask s (lambda () (base:reject-use "no"))))
      (is-true (wait-for-event s 10)))))

(test live.posts-from-many-threads-all-arrive-once
  (with-bare-simulation (s)
    (let ((count 0) (each 2000))
      (with-live (s :free)
        (let ((threads (loop repeat 4
                             collect (base:start-thread
                                      (lambda ()
                                        (loop repeat each
                                              do (time:post (make-errand (lambda () (incf count)))
                                                        s)))
                                      "poster"))))
          (mapc #'base:join-thread threads)
          (is-true (wait-for-event s 2)))
        (is (= (* 4 each) (time:ask s (lambda () count))))))))
