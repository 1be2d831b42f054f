;;;; thinking-runs.lisp -- thinking costs time: for continuations, repeated, live, in experiments.

(in-package :ars-magna.tests)
(in-suite thinking)

;;; THINK as a command.

(defmacro noting-answers ((note) &body body)
  "Run BODY, in which (NOTE name) returns a continuation; return (name code tick) of each call."
  (let ((answers (gensym "ANSWERS")))
    `(let ((,answers '()))
       (flet ((,note (name)
                (lambda (code &rest rest)
                  (declare (ignore rest))
                  (push (list name code (tick-now)) ,answers))))
         ,@body
         (reverse ,answers)))))

(test think-command.answers-after-its-ticks
  (loop for mode in *thinking-modes*
        for tick in '(1 1 7 7)
        do (with-fitter (:thinking mode)
             (is (equal `((zero nil 1) (more nil ,(1+ tick)))
                        (noting-answers (note)
                          (command:think fitter 0 (note 'zero))
                          (run:run-ticks 1)
                          (command:think fitter 7 (note 'more))
                          (run:run-ticks 20)))))))

(test think-command.tells-the-robot
  (with-fitter (:thinking :charged)
    (let ((told nil))
      (command:think fitter 3 (lambda (&rest arguments) (setf told arguments)))
      (run:run-ticks 3)
      (is (equal (list nil fitter) told)))))

(test think-command.leaves-the-body-alone
  (with-fitter (:thinking :charged :clean t)
    (is (equal '((turn nil 5) (thought nil 9))
               (noting-answers (note)
                 (command:think fitter 9 (note 'thought))
                 (command:robot-turn fitter 1 (note 'turn))
                 (run:run-ticks 20))))
    (is (null (command:under-way fitter)))))

(test think-command.a-newer-one-interrupts
  (with-fitter (:thinking :charged)
    (is (equal '((older :interrupt 4) (newer nil 9))
               (noting-answers (note)
                 (command:think fitter 9 (note 'older))
                 (run:run-ticks 3)
                 (command:think fitter 6 (note 'newer))
                 (run:run-ticks 20))))))

(test think-command.ends-with-the-run
  (is (equal '((thought :interrupt 2))
             (noting-answers (note)
               (with-fitter (:thinking :charged)
                 (command:think fitter 9 (note 'thought))
                 (run:run-ticks 2))))))

(test think-command.wrong-arguments-are-errors
  (with-fitter (:thinking :charged)
    (dolist (ticks '(-1 -1/4 "x" nil))
      (is (search "think: ticks is"
                  (wrong-argument-text (lambda () (command:think fitter ticks))))))
    (is (search "think: robot is" (wrong-argument-text (lambda () (command:think 5 5)))))
    (is (search "think: continuation is"
                (wrong-argument-text (lambda () (command:think fitter 5 5)))))))

;;; Repeated.

(defun thoughtful-ride ()
  "Let FITTER do this and that by a plan and by commands, thinking meanwhile."
  (let ((robot (first (run:simulation-robots time:*simulation*))))
    (driver:begin-plan (rpl:interp-lambda ()
                         (rpl:n-times 5
                           (rpl:think 3)
                           (driver:rpl-robot-turn .5)
                           (rpl:wait-for driver:robot-stopped*)
                           (rpl:with-charge (4) (itself 1)))))
    (command:think robot 12)
    (run:run-ticks 30)
    (run:set-thinking '(:charged :budget 20))
    (command:think robot 40)
    (run:run-ticks 30)))

(test thinking.repeats-from-the-journal
  (dolist (mode *thinking-modes*)
    (with-fitter (:thinking mode :journal t :seed 5)
      (thoughtful-ride)
      (is (= (run:state-digest) (nth-value 1 (run:replay (end-journal time:*simulation*)))))
      (run:with-replay ((end-journal time:*simulation*))
        (is (equal '(:charged :budget 20) (run:simulation-thinking)))))))

(test thinking.copies-go-on-thinking
  (with-fitter (:thinking :charged)
    (command:think fitter 20)
    (run:run-ticks 5)
    (let ((copy (run:fork-simulation time:*simulation*)))
      (is (= (run:state-digest) (run:state-digest copy)))
      (run:run-ticks 10)
      (run:run-ticks 10 copy)
      (is (= (run:state-digest) (run:state-digest copy)))
      (is (plusp (time:agenda-pending (run:simulation-agenda copy))))
      (run:run-ticks 10 copy)
      (is (zerop (time:agenda-pending (run:simulation-agenda copy))))
      (is (plusp (time:agenda-pending (run:simulation-agenda time:*simulation*)))))))

(test thinking.same-run-same-digest
  (dolist (mode *thinking-modes*)
    (flet ((digest ()
             (with-fitter (:thinking mode :seed 5)
               (thoughtful-ride)
               (run:state-digest time:*simulation* t))))
      (is (= (digest) (digest))))))

(test thinking.one-worker-or-two
  "Trials in which plans think come out the same on one worker and on two."
  (base:with-own-definitions ()
    (eval '(experiment:defexperiment thoughtfulness
            (:robots fitter)
            (:vary (budget 5 50))
            (:run (progn (run:set-thinking (list :charged :budget budget))
                         (driver:run-plan 'thoughtful-turns)))
            (:measure (angle (robot:robot-angle (first (run:simulation-robots)))))))
    (flet ((rows (workers)
             (mapcar #'cddr (rows-of (experiment:run-experiment 'thoughtfulness
                                                                :trials 6 :workers workers
                                                                :stream nil)))))
      (is (equal (rows 1) (rows 2))))))

(rpl:def-interp-proc thoughtful-turns ()
  "Turn and think by turns."
  (rpl:n-times 4
    (rpl:think 2)
    (rpl:with-charge (3) (rpl:n-times 30 (rpl:seq (itself 1))))
    (rpl:n-times 30 (rpl:seq (itself 1)))
    (driver:rpl-robot-turn .5)
    (rpl:wait-for driver:robot-stopped*)))

;;; Live.

(defmacro live-thinking ((mode) &body body)
  "Run BODY while a fresh FITTER, bound to that, runs live where thinking costs what MODE says."
  `(live (simulation)
     (run:set-thinking ,mode simulation)
     ,@body))

(test live-thinking.charged-plans-react-in-the-ticks
  (dolist (mode '(:free :charged (:charged :budget 10)))
    (live-thinking (mode)
      (destructuring-bind (thread ticks)
          (run-as-plan
            (let ((start (tick-now)))
              (rpl:think 10)
              (list (base:current-thread) (- (tick-now) start))))
        (is (eq thread (run:simulation-thread simulation)))
        (is (= ticks (if (eq mode :free) 0 10)))))))

(test live-thinking.is-the-same-each-time
  "What a plan does live, where it is charged for, it does headless at the same ticks."
  (flet ((trace-of-turns ()
           (let ((start nil))
             (run-as-plan
               (setf start (tick-now))
               (rpl:n-times 5
                 (rpl:call-plan (count-to 100))
                 (driver:rpl-robot-turn .5)
                 (rpl:wait-for driver:robot-stopped*)
                 (rpl:think 3))
               (- (tick-now) start)))))
    (let ((headless (with-fitter (:thinking '(:charged :budget 20) :seed 3) (trace-of-turns))))
      (dotimes (time 3)
        (live-thinking ('(:charged :budget 20))
          (is (= headless (trace-of-turns))))))))

(test live-thinking.is-told-by-status-unless-it-is-real
  (loop for (mode text) in '((:real nil) (:free "free") (:charged "charged"))
        do (live-thinking (mode)
             (is (equal text (cli::thinking-cost-text
                              (run:status (first (run:simulation-robots simulation)))))))))

(test live-thinking.modes-change-while-plans-run
  (live-thinking (:charged)
    (let* ((place nil)
           (stop nil)
           (task (driver:begin-plan (rpl:interp-lambda ()
                                      (loop until stop
                                            (setf place (base:current-thread))
                                            (rpl:wait-time 1))))))
      (flet ((in-ticks-p () (eq place (run:simulation-thread simulation))))
        (awaiting (in-ticks-p))
        (run:set-thinking :real simulation)
        (awaiting (not (in-ticks-p)))
        (run:set-thinking '(:charged :budget 5) simulation)
        (awaiting (null (driver::interface-thread driver::*default-interface*)))
        (awaiting (in-ticks-p))
        (setf stop t)
        (awaiting (rpl:task-over-p task))))))

(test live-thinking.kills-and-changes-from-outside-are-heard
  (live-thinking (:charged)
    (let* ((fluent (rpl:create-fluent 'fluent))
           (waiter (driver:begin-plan (rpl:interp-lambda () (rpl:wait-for fluent))))
           (thinker (driver:begin-plan (rpl:interp-lambda () (rpl:think 100000000)))))
      (awaiting (eq :waiting (rpl:task-state waiter)))
      (rpl:set-value fluent t)
      (awaiting (eq :succeeded (rpl:task-state waiter)))
      (driver:end-plan thinker)
      (is (eq :evaporated (rpl:task-state thinker))))))

(test live-thinking.is-an-option-of-the-simulator
  (let ((driver::*default-interface* nil) (time:*simulation* nil) (world:*world* world:*world*))
    (with-messages
      (dolist (mode *thinking-modes*)
        (unwind-protect
             (progn (run:simulator 'fitter :rate :free :thinking mode)
                    (is (equal mode (run:simulation-thinking))))
          (run:stop-simulator))
        (is (equal mode (getf (run:journal-header (run:simulation-journal time:*simulation*))
                              :thinking))))
      (signals base:wrong-argument (run:simulator 'fitter :thinking :cheap)))))

(test thinking.no-pulse-is-missed-with-a-small-budget
  (dolist (budget '(1 2 5 20))
    (run:with-simulation (ars-worlds:dot :thinking (list :charged :budget budget))
      (let ((task (driver:begin-plan (rpl:interp-lambda ()
                                       (driver:rpl-robot-turn 1/10)
                                       (rpl:wait-for driver:robot-stopped*)))))
        (run:run-ticks 200)
        (is (eq :succeeded (rpl:task-state task)) "~D" budget)))))

(test thinking.a-price-that-is-none-fails
  (dolist (mode '(:free :charged))
    (run:with-simulation (ars-worlds:dot :thinking mode)
      (with-messages
        (let ((task (driver:begin-plan (rpl:interp-lambda ()
                                         (rpl:with-failure-handling ((t () (return :handled)))
                                           (rpl:with-charge (-1) 1))))))
          (run:run-ticks 3)
          (is (eq :succeeded (rpl:task-state task)) "~S" mode))))))
