;;;; clim-awaiting.lisp -- programs that wait in a debugger are shown and answered in the window.

(in-package :ars-magna.tests)

(in-suite clim)

(defun broken (text thread &optional told-p)
  "Return what a program that calls BREAK with TEXT leaves with a session; it waits in THREAD."
  (let ((break-request (cli::make-break-request
                        (make-condition 'simple-condition :format-control text)
                        '() thread '())))
    (setf (cli::break-request-told-p break-request) told-p)
    break-request))

(defun leave-broken (session &rest break-requests)
  "Let BREAK-REQUESTS, of other threads, wait for SESSION."
  (setf (cli::break-state-others (cli::session-break-state session)) break-requests))

(defun note-above (window)
  "Return what is said above the line that is typed in WINDOW, where one is."
  (first (window::text-above-input (window::window-conversation window) "")))

(test awaiting.is-said-above-the-line-and-in-the-strip
  (in-window (window robot)
    (let ((session (window::window-session window)) (thread (base:current-thread)))
      (is (null (note-above window)))
      (is (not (mentions-p (window::run-status-text window) "the prompt asks")))
      (leave-broken session (broken "oh" thread))
      (is (mentions-p (note-above window) "How to continue? oh (in another thread, "))
      (is (mentions-p (window::run-status-text window) "the prompt asks how to continue a program"))
      (setf (cli::break-state-own (cli::session-break-state session))
            (broken "mine" (cli::session-thread session) t))
      (is (mentions-p (note-above window) "1 more waits. How to continue? mine"))
      (is (mentions-p (window::run-status-text window)
                      "the prompt asks how to continue two programs")))))

(test awaiting.is-said-once-where-the-simulator-waits
  "The strip's word for how time goes tells of that one."
  (in-window (window robot)
    (let ((session (window::window-session window)) (thread (base:current-thread)))
      (setf (window::watcher-progress (window::window-watcher window))
            (window::make-progress :state :broken))
      (leave-broken session (broken "oh" thread))
      (is (= 1 (occurrences "asks how" (window::run-status-text window))))
      (leave-broken session (broken "oh" thread) (broken "ah" thread))
      (is (mentions-p (window::run-status-text window)
                      "the prompt asks how to continue two programs")))))

(test awaiting.what-breaks-while-another-is-answered-leaves-the-prompt-there
  "What it says would else stand where the line was, which would not be seen."
  (in-window (window robot)
    (let* ((conversation (window::window-conversation window))
           (console (window::conversation-console conversation)))
      (setf (cli::console-edited-p console) t)
      (cli::show-prompt console "Break> ")
      (cli::report-waiting-break (window::window-session window)
                                 (broken "oh" (base:current-thread)))
      (is (mentions-p (said-in window) "It waits until the earlier break is answered"))
      (is (equal "Break> " (cli:unpainted-text (first (window::shown-input-line conversation))))))))

(defun print-in-threads (console &rest texts)
  "Write each of TEXTS to CONSOLE a hundred times in its own thread, without flushing. Return the
threads."
  (loop for text in texts
        collect (let ((text text))
                  (base:start-thread (lambda ()
                                       (loop repeat 100 do (write-string text console)))
                                     "printer"))))

(test awaiting.the-prompt-stays-whatever-other-threads-print
  "Also while it changes, and below text that does not end in a newline."
  (in-window (window robot)
    (let* ((conversation (window::window-conversation window))
           (console (window::conversation-console conversation)))
      (flet ((shown-p (label text)
               (let ((shown (window::shown-input-line conversation)))
                 (and shown
                      (equal label (cli:unpainted-text (first shown)))
                      (equal (list text (length text)) (rest shown))))))
        (setf (cli::console-edited-p console) t)
        (let ((threads (print-in-threads console "part " (format nil "whole~%") "Robot> ")))
          (is (loop for count from 1 to 200
                    for prompt = (if (oddp count) "Robot> " "Break> ")
                    do (cli::show-prompt console prompt)
                    always (shown-p prompt "")))
          (mapc #'base:join-thread threads))
        (cli::change-typed-line console (lambda (line)
                                          (setf (cli:drawn-line-text line) "turn 1"
                                                (cli:drawn-line-point line) 6)))
        (mapc #'base:join-thread (print-in-threads console "part "))
        (is (shown-p "Break> " "turn 1"))
        (is (mentions-p (said-in window) "part part "))
        (cli::end-typed-line console)
        (is (null (window::shown-input-line conversation)))))))

(test awaiting.code-that-draws-in-a-window-is-not-waited-for
  "Nobody could answer it: the thread that handles keys would wait. It is said once."
  (in-window (window robot)
    (let ((calls 0))
      (world:set-attribute (world:find-thing "BOX#1") :draw-function
                           (lambda (&rest arguments)
                             (declare (ignore arguments))
                             (incf calls)
                             (break "look")))
      (world:move-thing (world:find-thing "BOX#1") (robot:robot-hand robot 0))
      (window::publish-snapshot (window::window-watcher window) (time:current-simulation))
      (window::without-debugger
        (window::refresh window)
        (window::repaint (pane window 'window::hands)))
      (is (= 1 calls))
      (is (= 1 (count-if (lambda (message)
                           (mentions-p (base:message-text message)
                                       "Drawing code has called the debugger (look)"))
                         (base:take-messages)))))))

(test awaiting.errors-in-drawing-code-go-to-the-run-that-is-shown
  "Also if the window has shown another run before, whose messages its thread would add to."
  (in-window (window robot)
    (world:set-attribute (world:find-thing "BOX#1") :draw-function
                         (lambda (&rest arguments)
                           (declare (ignore arguments))
                           (error "no brush")))
    (world:move-thing (world:find-thing "BOX#1") (robot:robot-hand robot 0))
    (window::publish-snapshot (window::window-watcher window) (time:current-simulation))
    (let ((definitions:*message-queue* (definitions:make-message-queue)))
      (window::refresh window)
      (is (null (base:take-messages))))
    (is (= 1 (count-if (lambda (message) (mentions-p (base:message-text message) "no brush"))
                       (base:take-messages))))))

(test awaiting.a-line-that-waits-for-plans-can-answer-what-they-wait-for
  "The plans are held until the thread that waits for them does what it is needed for."
  (in-studio (robot)
    (let ((interface (ars-magna.rpl-robot::driver-interface
                      (ars-magna.rpl-robot:driver-for-plan nil)))
          (held (base:make-semaphore "held")) (answered (base:make-semaphore "answered"))
          (done (base:make-semaphore "done")) (simulation (time:current-simulation)))
      (base:start-thread (lambda ()
                           (ars-magna.rpl-robot:call-with-plans
                            (lambda ()
                              (base:signal-semaphore held)
                              (base:wait-on-semaphore answered 60))
                            interface))
                         "plans")
      (base:wait-on-semaphore held)
      (base:start-thread (lambda ()
                           (let ((time:*simulation* simulation)
                                 (base:*front-end*
                                   (make-instance 'waiting-front-end
                                                  :function (lambda ()
                                                              (base:signal-semaphore answered)))))
                             (ars-magna.rpl-robot:call-with-plans
                              (lambda () (base:signal-semaphore done)) interface)))
                         "line")
      (is (base:wait-on-semaphore done 20))
      (base:signal-semaphore answered))))

(test awaiting.a-task-that-is-ended-is-stepped-no-longer
  (in-studio (robot)
    (let ((task (ars-magna.rpl-robot:begin-plan 'ars-user::window-plan)))
      (run:run-ticks 2)
      (ars-magna.rpl.seeing:step-task task)
      (let ((said (with-output-to-string (*standard-output*)
                    (funcall (cli:line-action (cli:find-line-command "END-TASK"))
                             (cli:make-session)
                             (format nil "~D" (ars-magna.rpl:task-serial task))))))
        (is (mentions-p said "ends"))
        (is (null (ars-magna.rpl.seeing::stepping-courses (ars-magna.rpl:task-runner task))))))))

(test awaiting.lines-of-menus-and-buttons-come-after-the-answer
  "They would be taken for wrong answers; forms are evaluated where it has broken."
  (in-window (window robot)
    (let ((conversation (window::window-conversation window)))
      (leave-broken (window::window-session window) (broken "oh" (base:current-thread)))
      (window::run-line-at-prompt conversation "rewind 10")
      (window::replace-input-line conversation "turn ")
      (is (has-words-p (said-in window)
                       "REWIND 10: answer the break first" "TURN: answer"))
      (is (equal "" (keys-given window)))
      (window::run-line-at-prompt conversation "(describe 1)")
      (is (mentions-p (keys-given window) "(describe 1)")))))
