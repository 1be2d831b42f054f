;;;; cli-telling.lisp -- messages to a user at the prompt, and how often they come.

(in-package :ars-magna.tests)

(in-suite cli)

(defun told-at-prompt (&rest lines)
  "Return what somebody is told who types LINES at a prompt, of which each waits for the last."
  (let ((out (make-string-output-stream)))
    (cli:run-session
     (cli:make-session
      :input (make-instance 'cli::typed-text
                            :octets (make-string-input-stream (format nil "~{~A~%~}" lines))
                            :by-hand-p t)
      :output out :patient t))
    (base:one-line (get-output-stream-string out))))

(test messages.that-repeat-are-told-less-and-less-often
  (let ((told (make-hash-table :test 'equal))
        (message (definitions::make-message :error '("again"))))
    (is (equal '(1 2 3 10 100 1000)
               (loop for count from 1 to 1001
                     unless (cli::count-repeated-message message told) collect count)))))

(defun failing-kicker-room ()
  (eval '(world:defkicker fail-often (thing) () (error "no ~A" (world:thing-name thing))))
  (eval '(world:defmap failing-room (9 9)
          (rect (0 0) (8 8) bricks 10)
          (obj (pot :kickers (fail-often)) (4.5 5.5) ((:size 1)))))
  (eval '(robot:defrobot tester (failing-room (2.5 2.5) 0))))

(test messages.of-kickers-that-fail-say-how-to-end-that
  "They are counted on when lines are typed, until the kicker is another."
  (with-own-definitions
    (failing-kicker-room)
    (run:call-with-simulation
     (lambda ()
       (let ((cli:*prompt-robot* 'tester))
         (flet ((shown (&rest lines)
                  (let ((told (apply #'told-at-prompt lines)))
                    (values (occurrences "*ERROR* -> Error in kicker FAIL-OFTEN of POT#1: no POT"
                                         told)
                            told))))
           (multiple-value-bind (count told) (shown "step 5" "step 5" "step 5")
             (is (= 4 count))
             (is (mentions-p told
                             "Correct the kicker FAIL-OFTEN by DEFKICKER; or remove it: (put-"))
             (is (mentions-p told "(thing (find-thing \"POT#1\"))). PAUSE stops time.")))
           (is (= 6 (shown "step 5"
                           (format nil "(defkicker ars-magna.tests::fail-often (it) () ~
                                        (error \"no ~~A\" (thing-name it)))")
                           "step 5")))
           (is (= 2 (shown "step 2" "(put-kicker fail-often (thing (find-thing \"POT#1\")))"
                           "step 2"))))))
     '(tester))))

;;; What comes of plans' commands may be more than anybody reads.

(test echo.is-pointed-to-once-where-plans-give-many-commands
  (let ((session (cli:make-session :input (make-instance 'cli::typed-text :by-hand-p t
                                                         :octets (make-string-input-stream ""))))
        (messages (let ((base:*message-queue* (base:make-message-queue))
                        (definitions::*request-origin* "a plan"))
                    (loop repeat 30 do (base:message-set "Camera 0 turned"))
                    (base:take-messages))))
    (flet ((text () (first (cli::notes-on-messages session messages)))
           (read-a-line () (cli::reset-message-count session)))
      (is (null (text)))
      (read-a-line)
      (is (null (text)) "a line was read between")
      (is (search "ECHO OFF" (text)))
      (read-a-line)
      (loop repeat 3 do (is (null (text)))))))
