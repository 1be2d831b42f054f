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
