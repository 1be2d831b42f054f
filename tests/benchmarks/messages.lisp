;;;; messages.lisp -- how long it takes to send a message, deliver it and take it.

;;; Prints nanoseconds per message. The ticks are subtracted: as many pass without messages. THINK
;;; shows what a command costs that does nothing.

(in-package :ars-magna.benchmarks)

(world:defmap radio-field (30 20) (rect (0 0) (29 19) bricks 10))
(robot:defrobot caller (radio-field (5 5) 0))

(defparameter *messages* 20000)

(defun robots-for-messages (count)
  (loop for i from 1 to count
        collect (list 'caller :as (intern (format nil "CALLER-~D" i) :ars-magna.benchmarks)
                      :at (list (+ 1.5 (mod i 25)) (+ 1.5 (floor i 25))))))

(defun seconds-of-messages (robots step &rest options)
  "Return the seconds in which *MESSAGES* ticks pass among ROBOTS, a number. STEP is called with the
list of robots before each tick."
  (run:with-simulation ((robots-for-messages robots) :parameters options)
    (let ((robots (run:simulation-robots)))
      (seconds-for (lambda ()
                     (loop repeat *messages*
                           do (funcall step robots)
                              (run:run-ticks 1)))))))

(defun send-to-second (robots)
  (command:robot-send (first robots) (second robots) '(at 3 4)))

(defun send-to-all (robots)
  (command:robot-send (first robots) :all '(at 3 4)))

(defun send-in-ring (robots)
  (loop for (robot next) on (append robots (list (first robots)))
        while next do (command:robot-send robot next '(at 3 4))))

(defun think-each (robots)
  (dolist (robot robots) (command:think robot 1)))

(defun take-each (robots)
  (dolist (robot robots) (robot:next-message robot)))

(defun say-message-cost (text robots receivers step &rest options)
  (let ((empty (seconds-of-messages robots #'identity))
        (full (apply #'seconds-of-messages robots step options)))
    (say text (/ (* 1e9 (- full empty)) (* *messages* receivers)) "ns")))

(flet ((send-and-take (robots) (take-each (rest robots)) (send-to-second robots))
       (send-all-and-take (robots) (take-each (rest robots)) (send-to-all robots)))
  (say-message-cost "think, ten robots in a tick, per robot" 10 10 #'think-each)
  (say-message-cost "sent and delivered, ten robots in a ring" 10 10 #'send-in-ring
                    '(mailbox-size* 1))
  (say-message-cost "the same with loss, garbling and a range" 10 10 #'send-in-ring
                    '(mailbox-size* 1) '(prob-lose-message* 1/10) '(prob-garble-message* 1/10)
                    '(radio-range* 100))
  (say-message-cost "the same into full mailboxes of 100" 10 10 #'send-in-ring)
  (say-message-cost "one message in a tick, sent, delivered and taken" 2 1 #'send-and-take)
  (say-message-cost "to nine robots at once, per receiver" 10 9 #'send-all-and-take))
