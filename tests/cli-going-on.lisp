;;;; cli-going-on.lisp -- in which run prompts continue after one of them ends the run.

(in-package :ars-magna.tests)

(in-suite cli-sessions)

(rpl:def-interp-proc ars-user::plan-that-stumbles ()
  (rpl:fail :thin-ice))

(defmacro in-shed (&body body)
  "Run BODY where the robot MOLE lives in a woodshed, and HEIFER in a hayloft; no windows open."
  `(with-own-definitions
     (setf display:*display-opener* nil)
     (eval '(world:defmap woodshed (30 9)))
     (eval '(robot:defrobot mole (woodshed (6 6) 0)))
     (eval '(world:defmap hayloft (30 9)))
     (eval '(robot:defrobot heifer (hayloft (6 6) 0)))
     (let ((*standard-output* (make-broadcast-stream)))
       (unwind-protect (progn (run:simulator 'mole :rate :free :display nil) ,@body)
         (stop-all)))))

(test going-on.a-stopped-simulator-waits-for-resume
  "It is not one whose time passes as lines need it."
  (in-shed
    (let* ((simulation time:*simulation*) (tick (run:simulation-tick simulation))
           (session (cli:make-session :output (make-broadcast-stream))))
      (run:stop-simulator)
      (is (not (cli::waits-for-commands-p session)))
      (is (mentions-p (cli::time-description session simulation) "RESUME"))
      (type-here "resume")
      (is (time:live-p simulation))
      (is (eq :free (run:simulation-rate simulation)) "it has the rate that it had")
      (is (= tick (run:simulation-tick simulation))))))

(defun type-here (&rest lines)
  "Type LINES at a prompt in this thread, where it is now. Return what it writes."
  (let ((output (make-string-output-stream)))
    (cli:run-session (cli:make-session :input (make-string-input-stream (joined lines))
                                       :output output :batch t :patient nil))
    (get-output-stream-string output)))

(defun do-in (talk &rest lines)
  "Enter LINES in TALK, and wait until all have been done."
  (apply #'enter talk lines)
  (is-true (await-turns talk (* 2 (length lines)))))

(defun call-with-talk (function robot-name)
  (let ((talk (begin-talk (robot:find-robot robot-name))))
    (unwind-protect (funcall function talk)
      (end-talk talk))))

(test going-on.a-prompt-goes-where-another-has-led
  (in-shed
    (call-with-talk (lambda (talk)
                      (do-in talk "world hayloft")
                      (let ((text (type-here "robot" "step 2")))
                        (is (search "From here on: HEIFER in HAYLOFT." text) "~A" text)
                        (is (search "Tick 2." text) "~A" text)
                        (is (= 1 (occurrences "From here on" text)))))
                    'mole)))

(test going-on.others-follow-the-prompt-of-this-thread
  (in-shed
    (call-with-talk (lambda (talk)
                      (type-here "world hayloft")
                      (do-in talk "robot")
                      (let ((text (told-to talk)))
                        (is (search "From here on: HEIFER in HAYLOFT." text) "~A" text)
                        (is (search "HEIFER  " text) "~A" text)
                        (is (not (search "is over" text)) "~A" text)))
                    'mole)))

(test going-on.own-robots-new-run-comes-first
  (in-shed
    (call-with-talk (lambda (talk)
                      (type-here "world hayloft" "world woodshed")
                      (do-in talk "robot")
                      (is (search "From here on: MOLE in WOODSHED." (told-to talk))))
                    'mole)))

(test going-on.who-waits-for-a-line-is-told-at-once
  (in-shed
    (let* ((output (make-string-output-stream))
           (waiting (cli:make-session :input (make-string-input-stream "") :output output)))
      (cli::call-as-running-session
       waiting
       (lambda ()
         (cli::listen-to waiting time:*simulation*)
         (type-here "world hayloft")
         (is (search "From here on: HEIFER in HAYLOFT." (get-output-stream-string output)))
         (is (eq time:*simulation* (cli::session-simulation waiting)))
         (cli::stop-listening waiting))))))

(test world.starts-anew-what-has-passed-no-tick
  (in-shed
    (type-here "pause" "world woodshed" "pause")
    (let ((first time:*simulation*))
      (type-here "world woodshed")
      (is (not (eq first time:*simulation*)))
      (is (time:live-p time:*simulation*)))))

(test going-on.the-end-of-a-plan-is-told-where-it-was-begun
  "The terminal's prompt is in another run, which is over."
  (in-shed
    (call-with-talk (lambda (talk)
                      (let ((text ""))
                        (do-in talk "world hayloft" "plan plan-that-stumbles")
                        (awaiting (search "failed"
                                          (setf text (concatenate 'string text (told-to talk)))))
                        (is (search "plan-that-stumbles failed: " text) "~A" text)
                        (is (search "PLANS tells more" text) "~A" text)))
                    'mole)))
