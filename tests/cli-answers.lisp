;;;; cli-answers.lisp -- programs that read typed lines, in the thread of a run or of plans.

(in-package :ars-magna.tests)

(in-suite cli-debugger)

(test answers.are-asked-for-where-somebody-sits
  "A prompt asks how what reads goes on: by ANSWER, with a line."
  (let ((cli::*session* (cli:make-session :input (make-instance 'cli::typed-text
                                                                :by-hand-p t
                                                                :octets (make-string-input-stream
                                                                         "")))))
    (setf (cli::break-state-thread (cli::session-break-state cli::*session*))
          (base:current-thread))
    (flet ((answer (condition hook)
             (declare (ignore hook))
             (is (eq 'cli::answer
                     (restart-name (first (cli::restarts-to-offer condition)))))
             (invoke-restart 'cli::answer "(a b) 7")))
      (base:with-debugger-hook (#'answer)
        (let ((stream (base:program-input base:*front-end* (make-string-input-stream ""))))
          (is (equal '(a b) (read stream)))
          (is (equal 7 (read stream))))))))

(test answers.are-read-from-elsewhere-where-nobody-sits
  (let ((cli::*session* nil))
    (is (equal '(a b) (read (base:program-input base:*front-end*
                                                (make-string-input-stream "(a b)")))))))

(test answers.are-for-what-runs-in-other-threads
  (let ((time:*simulation* nil))
    (run:call-with-simulation
     (lambda ()
       (run:call-with-thread-bindings time:*simulation*
                                      (lambda () (is (typep *standard-input* 'cli::asking-text)))))
     '(ars-user::butler))))

(test break.of-a-trial-that-is-run-again-waits-for-no-command
  (let ((written (type-at-terminal
                  "(defexperiment go-and-break \"Breaks.\" (:robots butler) (:trials 1)
                     (:run (robot-go-forward butler 1 (continuation (err robot) (error \"no\")))
                           (run-ticks 9) (error \"boom\")))"
                  "(setf *break-on-user-error* t)"
                  "(replay-trial 'go-and-break 1 1)" "(+ 2 3)" "0" "(+ 3 4)"
                  "(setf *break-on-user-error* nil)")))
    (is-true (written-p "*BREAK* -> " written) "~S" written)
    (is-true (written-p "5" written))
    (is-true (written-p "7" written))
    (is-false (some (lambda (line) (search "between lines only" line)) written) "~S" written)))
