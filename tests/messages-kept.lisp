;;;; messages-kept.lisp -- messages in forks, rewinds, files, replays, plans and at the prompt.

(in-package :ars-magna.tests)

(in-suite messages)

(defparameter *poor-radio*
  '((base:prob-lose-message* 1/4) (base:prob-garble-message* 1/4) (base:radio-delay* 3)
    (base:mailbox-size* 4))
  "Parameters with which the fate of messages depends on chance and on what came before.")

(defun chatter (ticks)
  "Let the robots of the current run send and take messages for TICKS ticks."
  (loop repeat ticks
        for tick = (run:simulation-tick)
        do (command:robot-send (robot:find-robot 'heron) :all (list 'at tick #\x (vector tick)))
           (when (evenp tick)
             (command:robot-send (robot:find-robot 'snipe) 'heron tick))
           (when (zerop (mod tick 3)) (robot:next-message (robot:find-robot 'curlew)))
           (run:run-ticks 1)))

(defun all-mail ()
  (mapcar #'robot:robot-messages (run:simulation-robots)))

(defun mail-and-digest ()
  (list (all-mail) (run:state-digest)))

(defmacro amid-chatter ((&rest options) &body body)
  "Run BODY in a run with messages in mailboxes and on their way."
  `(run:with-simulation ((heron snipe curlew) :seed 4 :parameters *poor-radio* ,@options)
     (chatter 30)
     (command:robot-send curlew :all "request")
     ,@body))

(defun later (ticks)
  "Return the mail and digest after TICKS more ticks of chatter."
  (chatter ticks)
  (mail-and-digest))

(defun later-in (simulation ticks)
  (run:call-in-fork simulation (lambda () (later ticks))))

(test messages.are-forked
  (amid-chatter ()
    (let ((fork (run:fork-simulation)) (before (run:state-digest)))
      (is (= before (run:state-digest fork)))
      (let ((later (later-in fork 12)))
        (is (= before (run:state-digest)) "the fork's messages disturb the original")
        (is (equalp later (later 12)))))))

(test messages.are-rewound
  (amid-chatter (:keep t)
    (let ((then (mail-and-digest)) (tick (run:simulation-tick)))
      (run:run-ticks 1)
      (robot:next-message heron)
      (chatter 9)
      (run:rewind (- (run:simulation-tick) tick))
      (is (equalp then (mail-and-digest)))
      (is (= tick (run:simulation-tick))))))

(test messages.are-saved-and-loaded
  (amid-chatter (:journal t)
    (with-temporary-file (file)
      (run:save-simulation file)
      (let ((mail (mail-and-digest)) (later (later 12)))
        (run:with-loaded-simulation (file)
          (is (equalp mail (mail-and-digest)))
          (is (equalp later (later 12))))))))

(test messages.are-repeated-from-a-journal
  (amid-chatter (:journal t)
    (run:run-ticks 6)
    (with-temporary-file (file)
      (run:save-journal file)
      (let ((mail (mail-and-digest)))
        (run:with-replay (file) (is (equalp mail (mail-and-digest))))))))

(test messages.taken-by-continuations-are-repeated
  (run:with-simulation ((heron snipe) :journal t :keep t)
    (let ((taken '()))
      (labels ((poll (&rest results)
                 (declare (ignore results))
                 (let ((message (robot:next-message snipe))) (when message (push message taken)))
                 (command:think snipe 2 #'poll)))
        (poll)
        (dotimes (n 10) (send-and-pass heron snipe (list n)))
        (run:run-ticks 3)
        (is (equal (loop for n below 10 collect (list n)) (reverse taken)))
        (is (equal '(nil) (take-mail snipe)))
        (is (= (run:state-digest) (replayed-digest)))))))

(test next-message.is-no-entry-if-there-is-no-message
  (on-moor (:journal t)
    (robot:next-message heron)
    (is (null (run:journal-entries (run:simulation-journal time:*simulation*))))
    (send-and-pass heron snipe #(1 #\a))
    (robot:next-message snipe)
    (is (equal '((0 command:robot-send (:the :robot "HERON") snipe
                  (:the :vector 1 (:the :character 97)))
                 (2 robot:next-message (:the :robot "SNIPE")))
               (run:journal-entries (run:simulation-journal time:*simulation*))))))

(test digest.of-a-run-without-messages-has-no-radio
  (on-moor ()
    (let ((before (run:state-digest)))
      (send-and-pass heron snipe 1)
      (is (/= before (run:state-digest))))
    (is (= 1 (robot::radio-sent (robot:robot-radio heron)))))
  (run:with-simulation (heron)
    (let ((digest (run:state-digest)))
      (setf (robot:robot-radio heron) (robot::make-radio :robot heron))
      (is (= digest (run:state-digest))))))

;;; Robots that leave.

(test messages.to-a-robot-that-leaves-are-lost-and-its-own-arrive
  (with-pound
    (with-stopped-run (cat)
      (setf base:radio-delay* 5)
      (command:robot-send (robot-called 'cat) 'dog :to-dog)
      (command:robot-send (robot-called 'dog) 'cat :from-dog)
      (pass-ticks-now 2)
      (let ((gone (robot-called 'dog)))
        (ars:undefine 'robot 'dog)
        (pass-ticks-now 5)
        (is (equal '(:from-dog) (mail-of (robot-called 'cat))))
        (is (null (mail-of gone)))
        (is (search "no robot in this run called dog"
                    (text-of-error
                     (lambda () (command:robot-send (robot-called 'cat) 'dog 1)))))
        (command:robot-send (robot-called 'cat) gone :lost)
        (pass-ticks-now 7)
        ;; A replay needs the definition.
        (eval '(robot:defrobot dog (pound (3 7) 0)))
        (pass-ticks-now 3)
        (is (= (run:state-digest) (replayed-digest)))))))

;;; Plans.

(rpl:def-interp-proc answer-message ()
  (if (null (driver:rpl-messages)) (rpl:wait-for driver:robot-heard*))
  (let ((message (driver:rpl-next-message)))
    (driver:rpl-robot-send 'snipe (list 'got message))
    (rpl:wait-for driver:robot-sent*)
    (list message (rpl:fluent-value driver:robot-radio-error*))))

(test plan.hears-and-answers
  (on-moor ()
    (driver:rpl-init-robot heron)
    (let ((task (driver:begin-plan 'answer-message)))
      (run:run-ticks 4)
      (is (eq :waiting (rpl:task-state task)))
      (send-and-pass snipe heron :go 5)
      (is (equal '(:go nil) (rpl:task-result task)))
      (is (equal '((got :go)) (mail-of snipe))))))

(test plan.hears-in-forks-and-after-rewinding
  (on-moor (:keep t)
    (driver:rpl-init-robot heron)
    (driver:begin-plan 'answer-message)
    (run:run-ticks 2)
    (command:robot-send snipe heron :go)
    (run:run-ticks 1)
    (let ((fork (run:fork-simulation)))
      (run:run-ticks 6)
      (run:run-ticks 6 fork)
      (is (equal '((got :go)) (mail-of snipe)))
      (is (= (run:state-digest) (run:state-digest fork)))
      (run:rewind 5)
      (is (null (mail-of snipe)))
      (run:run-ticks 5)
      (is (equal '((got :go)) (mail-of snipe)))
      (is (= (run:state-digest) (run:state-digest fork))))))

(test plan.hears-in-a-live-run
  (with-stopped-run (heron)
    (run:simulator 'heron :rate :free :display nil)
    (driver:rpl-init-robot heron)
    (let ((task (driver:begin-plan 'answer-message)))
      (command:robot-send snipe heron :go)
      (run:await-idle)
      (run:stop-simulator)
      (is (equal '(:go nil) (rpl:task-result task)))
      (is (equal '((got :go)) (mail-of snipe)))
      (is (= (run:state-digest) (replayed-digest))))))

;;; The prompt and pictures.

(test prompt.sends-shows-and-takes-messages
  (is (equal '("Messages that arrive are shown."
               "robot-send: Robot sent (GO 3) to snipe"
               "snipe: heard (GO 3) from heron"
               "robot-send: Robot sent HELLO to all"
               "Messages that arrive are not shown."
               "snipe: robot-send: Robot sent 1 to heron"
               "(GO 3) from heron, sent at tick 1"
               "HELLO from heron, sent at tick 2"
               "(GO 3) from heron, sent at tick 1"
               "HELLO from heron, sent at tick 2"
               "No message for HERON.")
             (remove-if (lambda (line) (search "curlew" line))
                        (type-to 'heron "messages on" "send snipe (go 3)" "send all hello"
                                 "messages off" "(robot-send snipe heron 1 nil)"
                                 "robot snipe" "messages" "next-message" "messages"
                                 "robot heron" "next-message")))))

(test prompt.refuses-wrong-messages
  (let ((lines (type-to 'heron "send heron 1" "send stork 1" "send snipe" "send snipe go there")))
    (loop for text in '("another robot than the sender" "no robot in this run called stork"
                        "message is missing" "there is too much")
          for line in lines
          do (is (search text line)))))

(test pictures.show-messages-when-asked
  (on-moor (:journal t)
    (send-and-pass heron snipe '(go 3))
    (uiop:with-temporary-file (:pathname file :type "svg")
      (flet ((text (&rest options)
               (apply #'trails:save-run-picture file options)
               (uiop:read-file-string file)))
        (is (null (search "heard (GO 3)" (text))))
        (is (search "heard (GO 3) from heron" (text :kinds '(:message))))))))
