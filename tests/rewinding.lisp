;;;; rewinding.lisp -- runs that go back to an earlier tick are as they were, and continue.

(in-package :ars-magna.tests)

(def-suite* rewinding :in ars-magna)

(defun tick-of-run () (run:simulation-tick time:*simulation*))

(defun kept-ticks ()
  "Return the ticks of the forks that the current simulation keeps, oldest first."
  (reverse (mapcar #'run::fork-record-tick
                   (run::past-forks (run:simulation-past time:*simulation*)))))

(defmacro keeping-often (&body body)
  "Run BODY, where runs keep a fork at each tick that they may."
  `(let ((run::*fork-time-share* 1)) ,@body))

(defun state-now () (run:state-digest time:*simulation* t))

(defun note-state (states)
  (setf (gethash (tick-of-run) states) (state-now)))

(defun rewind-to (tick)
  (run:rewind (- (tick-of-run) tick)))

(defun trouble-of (function)
  "Return what the error says that FUNCTION signals."
  (handler-case (progn (funcall function) "no error")
    (base:ars-magna-error (condition) (princ-to-string condition))))

(defmacro is-trouble (words form)
  `(let ((text (trouble-of (lambda () ,form))))
     (is-true (has-words-p text ,@words) "~A" text)))

;;; Exactness.

(defun ride-noting (states rounds)
  "Drive on at random for ROUNDS, and note the state after each tick."
  (let ((look (lambda (simulation) (declare (ignore simulation)) (note-state states))))
    (run:add-observer look)
    (loop repeat rounds do (step-ride) (base:take-messages))
    (run:remove-observer look)))

(defun wrong-moments (states dice moments go-on)
  "Rewind the current simulation to MOMENTS ticks, by DICE. Return those at which its state is not
as STATES say. GO-ON is called after each."
  (loop repeat moments
        for tick = (base:roll-index (1+ (tick-of-run)) dice)
        do (rewind-to tick)
        unless (or (= tick 0) (eql (gethash tick states) (state-now)))
          collect tick
        do (funcall go-on)))

(test rewind.brings-back-any-tick-of-a-random-drive
  "Commands, continuations, things changed by hand, users' code that fails; two robots."
  (dolist (keep '(2 30))
    (keeping-often
      (run:with-simulation ((keeper helper) :seed keep :journal t :keep keep)
        (let* ((*ride* (make-ride (base:make-dice keep "ride")))
               (dice (base:make-dice keep "moments"))
               (states (make-hash-table)))
          (populate)
          (ride-noting states 300)
          ;; The designators of a run that is over mean nothing in another.
          (is (null (wrong-moments states dice 10
                                   (lambda ()
                                     (setf (ride-designators *ride*) '())
                                     (ride-noting states 30)))))
          (is (= (run:state-digest)
                 (nth-value 1 (run:replay (end-journal time:*simulation*))))))))))

(defun meddle-with-plans (dice)
  "Do something from outside, now and then, while plans drive marvin."
  (flet ((one-in (n) (zerop (base:roll-index n dice))))
    (when (one-in 100) (command:robot-turn ars-worlds:marvin 1))
    (when (one-in 100) (robot:place-robot ars-worlds:marvin 60 40 1))
    (when (one-in 150) (run:set-seed (base:roll-index 99 dice)))
    (when (one-in 150) (setf base:motion-noise* (/ (base:roll-index 9 dice) 10d0)))
    (when (one-in 50) (rpl:pulse driver:robot-stopped*))
    (when (one-in 50) (setf (rpl:fluent-value (aref driver:camera-error* 0)) :fogged))
    (when (and (driver:plans) (one-in 200)) (driver:end-plan (first (driver:plans))))
    (when (one-in 300) (driver:rpl-init-robot ars-worlds:marvin))
    (when (or (null (driver:plans)) (one-in 200))
      (driver:begin-plan 'fetch-thing '((:color blue) (:substance plastic)) '((109 24))))))

(defun go-on-with-plans (dice states ticks)
  (loop repeat ticks
        do (meddle-with-plans dice)
           (run:run-ticks 1)
           (note-state states)
           (base:take-messages)))

(test rewind.brings-plans-back-at-any-stage
  "Plans begun, ended and disturbed from outside; few forks, so that much is done again; or many."
  (dolist (keep '(2 30))
    (keeping-often
      (run:with-simulation (ars-worlds:marvin :seed keep :journal t :keep keep)
        (let ((dice (base:make-dice keep "plans")) (states (make-hash-table)))
          (go-on-with-plans dice states 400)
          (is (null (wrong-moments states dice 8
                                   (lambda () (go-on-with-plans dice states 40)))))
          (is (= (run:state-digest)
                 (nth-value 1 (run:replay (end-journal time:*simulation*))))))))))

(test rewind.goes-on-as-before-if-asked-the-same
  (keeping-often
    (run:with-simulation ((keeper helper) :seed 5 :journal t :keep 10)
      (let ((*ride* (make-ride (base:make-dice 5 "ride"))) (states (make-hash-table)))
        (populate)
        (ride-noting states 200)
        (let* ((journal (end-journal time:*simulation*))
               (end (run:journal-end journal)))
          (run:rewind 70)
          (let ((done (1- (run:journal-length (run:simulation-journal time:*simulation*)))))
            ;; The state at END was noted before the requests of that tick.
            (loop for entry in (nthcdr done (run:journal-entries journal))
                  while (< (first entry) end)
                  do (run::perform-entry entry 0 time:*simulation*)))
          (run:run-ticks (- end (tick-of-run)))
          (is (= (gethash end states) (state-now))))))))

;;; What it does, and does not.

(test rewind.lets-another-run-go-on
  (with-rover (:seed 1 :journal t :keep t)
    (let ((old rover) (simulation time:*simulation*) (answers '()))
      (run:run-ticks 10)
      (command:robot-goto-wall rover (lambda (err &rest more)
                                       (declare (ignore more))
                                       (push err answers)))
      (run:run-ticks 10)
      (let ((new (run:rewind 15)))
        (is (= 5 (tick-of-run)))
        (is (eq new time:*simulation*))
        (is (eq new (run:robot-simulation rover)))
        (is (eq world:*world* (run:simulation-world new)))
        (is (not (eq old rover)))
        (is (equal '(:interrupt) answers))
        (is (equal '((5 run::rewound 20)) (run:journal-entries (run:simulation-journal new)))))
      (is-trouble ("robot-turn" "rewound to tick 5" "rover") (command:robot-turn old 1))
      (is-trouble ("rewound to tick 5") (run:run-ticks 1 simulation))
      (is-trouble ("rewound to tick 5") (run:rewind 1 simulation))
      (command:robot-turn rover 1)
      (run:run-ticks 10)
      (is (plusp (robot:robot-angle rover))))
    (let ((last rover))
      (run:rewind 0)
      (run:rewind 3)
      (is (= 12 (tick-of-run)))
      (is (not (eq last rover)))
      (rewind-to 0)
      (is (= 0 (tick-of-run)))
      (is (= 0 (robot:robot-angle rover))))
    (run:run-ticks 2)
    (is (= 2 (tick-of-run)))))

(test rewind.0-undoes-what-was-done-since-the-last-tick
  (with-rover (:seed 1 :keep t)
    (run:run-ticks 4)
    (let ((before (state-now)))
      (robot:place-robot rover 6 6 1)
      (setf base:motion-noise* 0.6)
      (is (/= before (state-now)))
      (run:rewind 0)
      (is (= before (state-now)))
      (is (= 0.1d0 base:motion-noise*)))))

(test rewind.the-run-of-with-simulation-ends-with-it
  (let ((robot nil))
    (with-rover (:keep t)
      (run:run-ticks 5)
      (run:rewind 2)
      (setf robot rover))
    (is-trouble ("has ended") (command:robot-turn robot 1))))

(test rewind.says-how-far-one-can-go
  (with-rover (:keep 2)
    (run:run-ticks 30)
    (is-trouble ("31" "at most 30" "tick 0") (run:rewind 31))
    (is-trouble ("whole number") (run:rewind -1))
    (is-trouble ("whole number") (run:rewind 1.5)))
  (with-rover ()
    (run:run-ticks 5)
    (is-trouble (":keep" "keep-forks") (run:rewind 1))
    (run:keep-forks 5)
    (run:run-ticks 5)
    (is-trouble ("at most 5" "tick 5") (run:rewind 6))
    (run:rewind 5)
    (is (= 5 (tick-of-run)))
    (run:keep-forks nil)
    (is-trouble (":keep") (run:rewind 0))
    (is-trouble ("from 2 to 1000") (run:keep-forks 1))))

(rpl:def-interp-proc undo-oneself ()
  (rpl:wait-time 2)
  (trouble-of (lambda () (run:rewind 1))))

(test rewind.is-misuse-where-ticks-pass
  (with-rover (:keep t)
    (let ((texts '()))
      (flet ((try (&rest ignored)
               (declare (ignore ignored))
               (push (trouble-of (lambda () (run:rewind 1))) texts)))
        (run:run-ticks 3)
        (command:robot-turn rover 0.1 #'try)
        (time:schedule (nil) (try))
        (run:add-observer #'try)
        (run:run-ticks 8))
      (is (< 8 (length texts)))
      (is (every (lambda (text) (has-words-p text "passing")) texts)))
    (is-true (has-words-p (driver:run-plan 'undo-oneself) "a plan cannot rewind its own run"))
    (let ((simulation time:*simulation*) (text nil))
      (base:join-thread
       (base:start-thread (lambda () (setf text (trouble-of (lambda () (run:rewind 1 simulation)))))
                          "another"))
      (is-true (has-words-p text "headless" "WITH-SIMULATION")))))

(test rewind.works-in-forks-and-replays
  (let ((journal nil) (state nil))
    (with-rover (:seed 3 :journal t)
      (command:robot-turn rover 2)
      (run:run-ticks 10)
      (setf state (state-now))
      (command:robot-stop rover)
      (run:run-ticks 10)
      (setf journal (end-journal time:*simulation*))
      (let ((tick nil) (outside rover))
        (run:with-fork ()
          (run:keep-forks)
          (run:run-ticks 10)
          (run:rewind 4)
          (setf tick (tick-of-run))
          (is (not (eq rover outside))))
        (is (= 26 tick))
        (is (eq rover outside))
        (is (= 20 (tick-of-run)))))
    (run:with-replay (journal :keep t)
      (run:rewind 10)
      (is (= state (state-now))))))

(test rewind.is-in-journals-on-file
  (with-rover (:seed 4 :journal t :keep t)
    (command:robot-goto-wall rover)
    (run:run-ticks 30)
    (run:rewind 12)
    (command:robot-turn rover 1)
    (run:run-ticks 20)
    (with-temporary-file (file)
      (run:save-journal file)
      (multiple-value-bind (simulation digest) (run:replay file)
        (is (= digest (run:state-digest)))
        (is (equal '(18 run::rewound 30)
                   (second (run:journal-entries (run:simulation-journal simulation)))))))))

;;; Kept forks.

(test keep-forks.are-few-and-closer-the-newer
  (keeping-often
    (with-rover (:keep 12)
      (run:run-ticks 2000)
      (let ((ticks (kept-ticks)))
        (is (= 12 (length ticks)))
        (is (= 0 (first ticks)))
        (is (= 2000 (first (last ticks))))
        (is (< (- 2000 (car (last ticks 3))) 30))
        (is (< (* 8 (- (car (last ticks 3)) (car (last ticks 4)))) (second ticks)))))))

(test keep-forks.that-cannot-be-made-are-left-out-with-a-warning
  (keeping-often
    (with-rover (:keep t)
      (run:run-ticks 2)
      (base:take-messages)
      (let ((stream (make-broadcast-stream)))
        (driver:begin-plan (rpl:interp-lambda ()
                             (let ((out stream))
                               (rpl:wait-time 1000)
                               (princ 1 out))))
        (run:run-ticks 5))
      (let ((texts (mapcar #'base:message-text (base:take-messages))))
        (is (= 1 (count-if (lambda (text) (has-words-p text "cannot be kept for REWIND")) texts))
            "~A" texts))
      (is (equal '(0 1 2) (kept-ticks)))
      (run:rewind 3)
      (is (= 4 (tick-of-run)))
      (is (= 1 (length (driver:plans)))))))

;;; Live.

(defmacro live-rover ((&rest options) &body body)
  "Run BODY while the resident rover runs live and keeps forks."
  `(with-messages
     (run:simulator 'rover :keep t :display nil ,@options)
     (unwind-protect (progn ,@body)
       (run:stop-simulator))))

(test rewind.a-live-run-goes-on-live
  (keeping-often
    (live-rover (:rate 500 :seed 2)
      (let ((states (make-hash-table)) (old rover) (seen 0))
        (run:add-observer (lambda (simulation)
                            (incf seen)
                            (setf (gethash (run:simulation-tick simulation) states)
                                  (run:state-digest simulation))))
        (command:robot-turn rover 90)
        (awaiting (< 20 (tick-of-run)))
        (time:pause)
        (run:rewind 10)
        (is-true (time:live-p))
        (is-true (time:paused-p))
        (is (= 500 (run:simulation-rate time:*simulation*)))
        (is (not (eq old rover)))
        (is (eq rover (robot:find-robot 'rover)))
        (is (eq time:*simulation* (run:robot-simulation rover)))
        (is (= (run:state-digest) (gethash (tick-of-run) states)))
        (let ((before (tick-of-run)) (seen-before seen))
          (time:resume)
          (awaiting (< (+ 20 before) (tick-of-run)))
          (is (< seen-before seen)))
        (is-trouble ("rewound" "rover") (command:robot-turn old 1))
        (is (eq (run:rewind 3) time:*simulation*))
        (is-true (time:live-p))
        (is-false (time:paused-p))
        (run:stop-simulator)
        (run:rewind 5)
        (is-false (time:live-p))
        (is (= (run:state-digest) (nth-value 1 (run:replay (end-journal time:*simulation*)))))))
    (live-rover (:rate 500 :seed 2)
      (is (= 2 (run:simulation-seed time:*simulation*)))
      (is (> 20 (tick-of-run))))))

(rpl:def-interp-proc turn-for-ever ()
  (loop (driver:rpl-robot-turn 0.5)
        (rpl:wait-for driver:robot-stopped*)))

(test rewind.is-not-kept-by-plans-of-a-run-that-nobody-ended
  "The robot ends them with its new run, which is over by then: they withdraw no command from it."
  (live-rover (:rate 500 :seed 2 :thinking :free)
    (driver:rpl-init-robot rover)
    (driver:begin-plan (rpl:interp-lambda ()
                         (driver:rpl-robot-turn 1000)
                         (rpl:wait-for driver:robot-stopped*)))
    (awaiting (< 5 (tick-of-run)))
    (run:stop-simulator)
    (let ((driver::*default-interface* nil))
      (renew-world (robot:robot-world rover))
      (run:simulator 'rover :rate 500 :keep t :display nil)
      (command:robot-turn rover 90)
      (awaiting (< 5 (tick-of-run)))
      (is (string= "no error" (trouble-of (lambda () (run:rewind 2))))))))

(test isolation.ends-the-plans-of-live-runs
  (let ((interface nil))
    (call-isolated
     (lambda ()
       (run:simulator 'rover :rate 500 :display nil)
       (driver:rpl-init-robot rover)
       (driver:begin-plan 'turn-for-ever)
       (setf interface (shiftf driver::*default-interface* nil))))
    (is-true (run:simulation-over (driver::interface-simulation interface)))
    (awaiting (null (driver::plans-thread interface)))
    (is (null (driver::tasks-of-interface interface)))))

(test rewind.live-plans-go-on
  (live-rover (:rate 500 :seed 2)
    (driver:rpl-init-robot rover)
    (driver:begin-plan 'turn-for-ever)
    (awaiting (< 60 (tick-of-run)))
    (run:rewind 40)
    (is (= 1 (length (driver:plans))))
    (let* ((tick (tick-of-run))
           (journal (run:simulation-journal time:*simulation*))
           (before (run:journal-length journal)))
      (awaiting (< (+ 60 tick) (tick-of-run)))
      (is (< (+ 3 before) (run:journal-length journal))))
    (driver:end-plan :all)
    (awaiting (null (driver:plans)))))
