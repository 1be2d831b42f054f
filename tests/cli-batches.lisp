;;;; cli-batches.lisp -- batches whose lines start live runs, and how batches wait and end.

(in-package :ars-magna.tests)
(in-suite cli-scripts)

(defun last-line-of (text &rest options)
  "Return the last line that a script of TEXT with OPTIONS writes."
  (first (last (apply #'run-script text options))))

(test batches.start-a-simulator-whose-plans-run
  "Manual A: a headless run around SIMULATOR does not hide the fluents from the plans' thread."
  (dolist (robot '("dot" "'dot"))
    (is (string= ":SUCCEEDED"
                 (last-line-of (format nil "(simulator ~A :rate :free)
(run-plan 'look-round 0 '((:color blue)))" robot))))))

(test batches.have-robots-named-where-time-passes
  "A continuation names the robot that SIMULATOR has started, also after that began anew."
  (is (eq :turned
          (run:with-simulation (fitter)
            (let ((turned (base:make-semaphore "turned"))
                  (*standard-output* (make-broadcast-stream)))
              (run:simulator fitter :rate :free)
              (command:robot-turn
               fitter 1
               (lambda (&rest results)
                 (declare (ignore results))
                 (command:robot-turn fitter 1 (lambda (&rest results)
                                                 (declare (ignore results))
                                                 (base:signal-semaphore turned)))))
              (and (base:wait-on-semaphore turned 20) :turned))))))

(test json.counts-lines-that-are-too-long
  (let ((objects (objects-of-script (format nil "(list \"~A\")~%zz"
                                            (make-string 1000001 :initial-element #\x)))))
    (is-true (has-words-p (first objects) "\"kind\":\"error\"" "longer than 1000000" "\"line\":1"))
    (is-true (has-words-p (second objects) "\"done\"" "\"line\":1" "\"ok\":false" "(list"))
    (is-true (has-words-p (fourth objects) "\"done\"" "\"line\":2" "\"text\":\"zz\""))))

(test json.has-no-line-for-what-options-ask-for
  (let ((objects (objects-of-script "turn 1" "--plan" "look-round 0 nil")))
    (is-true (find-if (lambda (object)
                        (has-words-p object "\"done\"" "\"line\":null" "plan look-round"))
                      objects))
    (is-true (find-if (lambda (object) (has-words-p object "\"done\"" "\"line\":1" "turn 1"))
                      objects))))

(test json.ends-the-line-quit
  (is-true (has-words-p (first (objects-of-script (format nil "quit~%turn 1")))
                        "\"done\"" "\"line\":1" "quit")))

(test json.sends-a-question-before-it-reads-the-answer
  (destructuring-bind (question asking value done last &rest others)
      (objects-of-script (format nil "(progn (princ \"Go on?\") (read-line))~%yes~%(+ 1 2)"))
    (is-true (has-words-p question "\"output\"" "Go on?"))
    (is-true (has-words-p asking "\"asking\"" "\"line\":1"))
    (is-true (has-words-p value "\"value\"" "yes"))
    (is-true (has-words-p done "\"value\"" "NIL"))
    (is-true (has-words-p last "\"done\"" "\"line\":1"))
    (is-true (has-words-p (second others) "\"done\"" "\"line\":3"))))

(defun ends-in (objects)
  "Return what OBJECTS tell of the ends of lines, without their ticks."
  (loop for object in objects
        when (or (search "\"done\"" object) (search "\"waiting\"" object))
          collect (subseq object 9 (or (search ",\"tick\"" object) (length object)))))

(test json.tells-that-a-line-waits-while-time-stands-still
  (is (equal '("done\",\"line\":1,\"text\":\"pause\",\"ok\":true"
               "waiting\",\"line\":2,\"text\":\"turn 1\""
               "waiting\",\"line\":3,\"text\":\"(camera-turn (elt !>dot.cameras 0) 1)\""
               "done\",\"line\":2,\"text\":\"turn 1\",\"ok\":true"
               "done\",\"line\":3,\"text\":\"(camera-turn (elt !>dot.cameras 0) 1)\",\"ok\":true"
               "done\",\"line\":4,\"text\":\"resume\",\"ok\":true")
             (ends-in (objects-of-script "pause
turn 1
(camera-turn (elt !>dot.cameras 0) 1)
resume" "--rate" "free")))))

(test scripts.tell-of-what-waited-with-the-line-that-has-asked-for-it
  "Not with that of RESUME, also if it is Lisp, or the end of a plan."
  (flet ((script (&rest options)
           (apply #'run-script "(def-interp-proc give-up () (wait-time 2) (fail))
pause
turn 1
(camera-turn (elt !>dot.cameras 0) 1)
plan give-up
resume
turn 1" "--rate" "free" options)))
    (is-true (find-if (lambda (line) (has-words-p line "line 5: give-up failed")) (script)))
    (let ((objects (script "--json")))
      (loop for (line . words) in '((3 "Robot turned") (4 "camera-turn") (5 "give-up failed")
                                    (7 "Robot turned"))
            do (is-true (find-if (lambda (object)
                                   (apply #'has-words-p object "\"message\""
                                          (format nil "\"line\":~D}" line) words))
                                 objects)
                        "~A: ~A" line objects))
      (is-true (find "done\",\"line\":6,\"text\":\"resume\",\"ok\":true" (ends-in objects)
                     :test #'string=)))))

(test scripts.count-errors-of-lines-while-a-plan-is-under-way
  "Those of the plan are its own; those of other lines are not."
  (multiple-value-bind (objects status)
      (run-script "(def-interp-proc wait-and-serve () (wait-time 3))
pause
plan wait-and-serve
(error-set \"own\")
resume" "--rate" "free" "--json")
    (is (= 1 status))
    (is-true (find-if (lambda (object) (has-words-p object "\"done\"" "\"line\":4" "\"ok\":false"))
                      objects)
             "~A" objects)))

(test json.of-an-error-is-not-well-also-if-the-line-waits
  (is (find "done\",\"line\":3,\"text\":\"(error \\\"x\\\")\",\"ok\":false"
            (ends-in (objects-of-script "pause
turn 1
(error \"x\")
resume" "--rate" "free"))
            :test #'string=)))

(test scripts.that-have-stopped-the-simulator-let-time-pass
  (is (equal '("robot-turn: Robot turned 1.00")
             (values (run-script "(stop-simulator)
turn 1" "--rate" "free")))))

(test scripts.say-what-has-not-ended-when-they-end
  (multiple-value-bind (lines status) (run-script "pause
turn 1" "--rate" "free")
    (is (= 1 status))
    (is-true (has-words-p (first (last lines)) "not all requests have ended" "RESUME")))
  (is (string= "done\",\"line\":2,\"text\":\"turn 1\",\"ok\":false"
               (first (last (ends-in (objects-of-script "pause
turn 1" "--rate" "free")))))))

(test scripts.say-that-what-lisp-has-asked-for-has-not-ended
  "As of a line that is none, also if a continuation has paused the run."
  (dolist (text '("pause
(robot-turn dot 1)
quit" "pause
(list (robot-turn dot 3 nil)
  (camera-turn (elt !>dot.cameras 0) .1 (lambda (&rest results) results (pause))))
resume"))
    (multiple-value-bind (lines status) (run-script text "--rate" "free")
      (is (= 1 status))
      (is-true (has-words-p (first (last lines)) "not all requests have ended"))))
  (is (equal '("done\",\"line\":1,\"text\":\"pause\",\"ok\":true"
               "waiting\",\"line\":2,\"text\":\"(robot-turn dot 1)\""
               "done\",\"line\":3,\"text\":\"(list 2)\",\"ok\":true"
               "done\",\"line\":2,\"text\":\"(robot-turn dot 1)\",\"ok\":false")
             (ends-in (objects-of-script "pause
(robot-turn dot 1)
(list 2)" "--rate" "free")))))

(test scripts.repeat-what-waits-for-nothing-while-time-stands-still
  "But not what Lisp asks for; that is waited for while time passes."
  (is (equal '("Tick 0, paused." "1" "1" "robot-turn: Robot turned 1.00")
             (values (run-script "pause
turn 1
repeat 2 (list* 1)
resume" "--rate" "free"))))
  (is-true (has-words-p (second (run-script "pause
repeat 2 (robot-turn dot 1)
resume" "--rate" "free"))
                        "line 2: Time stands still: (robot-turn dot 1)"))
  (is (equal '("robot-turn: Robot turned 1.00" "robot-turn: Robot turned 1.00")
             (values (run-script "repeat 2 (robot-turn dot 1)")))))

(test scripts.do-not-wait-while-time-stands-still
  "Nobody is there to let it go on: not for REPEAT, nor when a continuation has paused."
  (let ((lines (run-script "pause
repeat 2 turn 1
resume
(robot-turn dot 1 (lambda (&rest results) (declare (ignore results)) (pause)))
turn 2
resume" "--rate" "free")))
    (is-true (has-words-p (second lines) "line 2: Time stands still: turn 1" "RESUME"))
    (is-true (has-words-p (third lines) "Robot turned 1.00"))
    (is-true (has-words-p (first (last lines)) "Robot turned 2.00"))))

(test scripts.do-not-let-lisp-wait-while-time-stands-still
  "Not for a plan, nor for what Lisp has asked for; nor if a plan pauses the run that it is in."
  (let ((lines (run-script "pause
(run-plan (interp-lambda () (wait-time 2) :ok))
(progn (robot-turn dot 1) (await-idle))
(list (plans) (await-idle (current-simulation) 0))
resume
(run-plan (interp-lambda () (seq (pause) (wait-time 2))))
resume
(run-plan (interp-lambda () (seq (wait-time 2) :ok)))" "--rate" "free")))
    (loop for words in '(("paused") ("line 2: run-plan: the run is paused" "(resume)")
                         ("line 3: await-idle: the run is paused" "(resume)")
                         ("(NIL NIL)")
                         ("robot-turn: Robot turned 1.00")
                         ("line 6: run-plan: the run is paused")
                         (":OK") (":SUCCEEDED"))
          for line in lines
          do (is-true (apply #'has-words-p line words) "~A" lines))
    (is (= 8 (length lines)))))

(defun run-script-apart (text &rest options)
  "Run a script of TEXT in a process of its own, with OPTIONS. Return its error output, status and
output."
  (uiop:with-temporary-file (:pathname path :stream stream :type "ars")
    (write-string text stream)
    :close-stream
    (multiple-value-bind (output errors status)
        (uiop:run-program (list* (base:native-name (project-file "cli/ars-magna"))
                                 (base:native-name path) "--world" "tiny" options)
                          :output :string :error-output :string :ignore-error-status t)
      (values errors status output))))

(defun run-endless-script (&rest options)
  (apply #'run-script-apart "(robot-turn dot 1 (lambda (&rest results) (loop (list results))))"
         options))

(test scripts.say-so-where-nothing-can-be-printed
  (let ((text (joined '("(defmethod print-object :around ((x t) stream) (error \"no\"))" "turn 1"
                        "(+ 1 2)"))))
    (multiple-value-bind (errors status output) (run-script-apart text)
      (declare (ignore errors))
      (is (= 1 status))
      (is-true (has-words-p output "*ERROR*" "PRINT-OBJECT fails")))
    (is-true (has-words-p (run-script-apart text "--json") "PRINT-OBJECT fails"))))

(test scripts.name-code-that-does-not-return-and-end-at-a-time-limit
  (multiple-value-bind (errors status) (run-endless-script "--time-limit" "5")
    (is (= 124 status))
    (is-true (has-words-p errors "line 1: the continuation of robot-turn has not returned for 3 s"
                          "stopped in the continuation of robot-turn"
                          "the time limit of 5 s is over")))
  (is (= 124 (nth-value 1 (run-endless-script "--time-limit" "0.5" "--rate" "free"))))
  (signals cli::usage-error (cli::parse-options '("--time-limit" "-1"))))

;;; Control C.

(defun patience-of-script (form &rest options)
  "Run a script of FORM, text, which says BEGUN by ~A in it and never returns, in a process of its
own, with OPTIONS. Let control C come from then on until the process ends, half a second after the
last. Return its status, and its error output."
  (uiop:with-temporary-file (:pathname path :stream stream :type "ars")
    (format stream form "(progn (write-line \"BEGUN\") (finish-output))")
    :close-stream
    (let ((process (uiop:launch-program (list* (base:native-name (project-file "cli/ars-magna"))
                                               (base:native-name path) "--world" "tiny" options)
                                        :output :stream :error-output :stream))
          (patience (base:make-semaphore "patience")))
      (loop for line = (read-line (uiop:process-info-output process) nil)
            until (or (null line) (search "BEGUN" line)))
      (loop repeat 10
            while (uiop:process-alive-p process)
            do (sb-posix:kill (uiop:process-info-pid process) sb-posix:sigint)
               (base:wait-on-semaphore patience 0.5))
      (when (uiop:process-alive-p process)
        (uiop:terminate-process process :urgent t))
      (values (uiop:wait-process process)
              (uiop:slurp-stream-string (uiop:process-info-error-output process))))))

(test interrupts.end-a-batch-that-does-not-let-itself-be-ended
  "One that takes the interrupt for an error of its own, and one that lets none in."
  (dolist (form '("(loop (handler-case (progn ~A (loop)) (t () nil)))"
                  "(ars-magna.host:call-holding-interrupts (lambda () ~A (loop)))"
                  "(unwind-protect (progn ~A (loop)) (loop))"))
    (multiple-value-bind (status errors) (patience-of-script form)
      (is (= 130 status) "~A: ~A ~A" form status errors)
      (is-true (has-words-p errors "line 1: stopped: Control-C was pressed again") "~A" errors))))

(test interrupts.end-at-once-what-did-not-end
  "The third does so anyway; the second if the first has begun nothing, and is not half of it."
  (flet ((at-once-p (ending now &rest times)
           (let ((cli::*interrupts-while-ending* ending))
             (and (cli::exit-at-once-p now times) t))))
    (is (equal '(nil t nil nil t)
               (list (at-once-p nil 10) (at-once-p nil 10 9) (at-once-p nil 10 9.9d0)
                     (at-once-p 0 10 9) (at-once-p 0 10 9 8))))))

(test scripts.say-so-when-a-time-limit-ends-what-lets-no-interrupt-in
  (multiple-value-bind (errors status)
      (run-script-apart "(robot-turn dot 1 (lambda (&rest results)
                         (list results)
                         (ars-magna.host:call-holding-interrupts (lambda () (loop)))))"
                        "--time-limit" "0.5")
    (is (= 124 status))
    (is-true (has-words-p errors "line 1: stopped in the continuation of robot-turn"
                          "the time limit of 0.5 s is over"))))

(command:define-command probe-sink (operation (probe probe)) ()
    ((:family :handling) (:delay 30) (:report () "The probe has sunk"))
    "Succeed after 30 ticks."
  (command:succeed operation))

(defun diver-batch (text)
  "Return the lines that a batch of TEXT, read here, writes in a run of DIVER."
  (let ((output (make-string-output-stream)))
    (with-diver ()
      (cli:run-session (cli:make-session :input (make-string-input-stream text) :output output
                                         :batch t :package (find-package :ars-magna.tests))))
    (lines-of (get-output-stream-string output))))

(test batches.wait-for-parts-of-users-and-for-the-mind
  "Whatever of the robot is at work when the input ends."
  (is (equal '("NIL" "probe-sink: The probe has sunk")
             (diver-batch "(progn (probe-sink (the-probe diver)) nil)")))
  (is (equal '("NIL" "think: Robot has thought")
             (diver-batch "(progn (command:think diver 5) nil)"))))

(test batches.are-told-that-an-empty-hand-cannot-be-tracked
  "3.6: :NOT-GRASPING is signalled; of a hand that holds something nobody waits for the end."
  (is (equal '("*ERROR* -> Hand 0 is not holding anything") (type-batch "hand-track 0")))
  (is (equal '("get-designator: Camera 0 found Designator 0"
               "camera-track: Camera 0 tracking Designator 0"
               "hand-grasp: Hand 0 grasped LAMP#1"
               "Tick 16.")
             (type-batch "obj-desig 0 local ((:color lightred))" "cam-track 0 0" "hand-grasp 0 0"
                         "hand-track 0" "step 1"))))

(test lines.that-end-with-no-unit-say-which-there-are
  (is-true (has-words-p (complaint "turn 3 foo")
                        "foo is not a unit for an angle. Known units: rad" "deg"))
  (is-true (has-words-p (complaint "turn 3 4") "4 is too much")))

(defvar *crew* '(fitter) "Robots of a run that a variable names.")

(test with-simulation.takes-an-expression-for-its-robots
  (is (eq 'fitter (run:with-simulation (*crew*) (robot:robot-name fitter))))
  (is (eq 'fitter (run:with-simulation ((list 'fitter)) (robot:robot-name fitter))))
  (let ((crew 'fitter))
    (is (eq 'fitter (run:with-simulation (crew :seed 1) (robot:robot-name fitter))))))

(test aliases.that-lead-back-to-themselves-say-so
  (let ((cli::*aliases* cli::*aliases*))
    (is-true (has-words-p (first (type-batch "alias around turn 1" "alias back around"
                                             "alias around back"))
                          "AROUND would stand for itself: AROUND = BACK = AROUND"))))

(test process.takes-the-terminal-again-when-it-goes-on
  "After control Z and FG, or STOP and CONT from outside."
  (let ((heard (base:make-semaphore "heard")))
    (unwind-protect
         (progn (host:call-on-continuing (lambda () (base:signal-semaphore heard)))
                (sb-posix:kill (sb-posix:getpid) sb-posix:sigcont)
                (is-true (base:wait-on-semaphore heard 20)))
      (host::handle-signal sb-posix:sigcont :default)))
  (let ((cli::*continued-p* nil))
    (cli::resume-terminal)
    (is-true cli::*continued-p* "the line that is typed is drawn again")))

(test scripts.leave-errors-to-continuations-that-are-told
  "As those of plans: a program that is told may try again. What nobody is told counts."
  (flet ((status (text) (nth-value 1 (run-script text))))
    (is (= 0 (status "(hand-ungrasp (robot-hand dot 0) (lambda (&rest results) results))")))
    (is (= 0 (status "(run-plan (interp-lambda () (rpl-hand-ungrasp 0)
  (wait-for (vref hand-moved* 0))))")))
    (is (= 1 (status "(hand-ungrasp (robot-hand dot 0) nil)")))
    (is (= 1 (status "hand-ungrasp 0")))
    (is (= 1 (status "repeat 2 hand-ungrasp 0")))
    (is (= 1 (status "(run-plan (interp-lambda () (fail :no-luck)))")))))

(test batches.name-the-robot-whose-designator-is-removed
  (is-true (find "*WARNING* -> gofer: Removing Designator 0"
                 (type-to 'ars-worlds:marvin "(new-thing tin (office 15 24) ((:size 1)))"
                          "(camera-get-object-designator (robot-camera gofer 0) :local nil nil)"
                          "(robot-go-forward gofer 3 nil)")
                 :test #'string=)))

(defun told-of-pasted (&rest keys)
  "Return what is told at a prompt of the live DOT when KEYS are pasted there."
  (multiple-value-bind (console out) (terminal-console)
    (let ((input (typed-text-for (keyboard-for `(:paste ,@keys :pasted :enter)) console)))
      (unwind-protect
           (progn (run:simulator 'ars-worlds:dot :rate 50 :display nil)
                  (cli:run-session (cli:make-session :input input :output console)))
        (run:stop-simulator)))
    (get-output-stream-string out)))

(test sessions.lines-that-come-at-once-wait-for-each-other-where-no-line-is-edited
  (let ((out (make-string-output-stream)))
    (unwind-protect
         (progn (run:simulator 'ars-worlds:dot :rate 50 :display nil)
                (cli:run-session
                 (cli:make-session
                  :input (make-instance 'cli::typed-text
                                        :octets (make-string-input-stream
                                                 (format nil "turn 1~%turn 0.5~%(+ 20 22)~%"))
                                        :by-hand-p t)
                  :output out)))
      (run:stop-simulator))
    (is (not (search "interrupted" (get-output-stream-string out))))))

(test sessions.lines-pasted-together-wait-for-each-other
  "As piped ones do."
  (let ((told (told-of-pasted "turn 1" :enter "turn 0.5" :enter "(+ 20 22)")))
    (is (not (search "interrupted" told)) "~A" told)
    (is-true (search "Robot turned 1.00" told))
    (is-true (search "Robot turned 0.50" told))))
