;;;; messages.lisp -- plain data that robots send each other, and the mailboxes in which it arrives.

(in-package :ars-magna.robot)

(export '(message-datum-p put-message *message-hooks* make-arrival arrival-p arrival-fits-p
          seed-of-next-message last-arrivals))

;;; Messages are state of the run, and journals and saved runs contain them. So they are plain data,
;;; which no code modifies: senders give copies, and receivers get copies. A message on its way is
;;; an event of the agenda without a resource. A robot sends one message at a time, and robots act
;;; in the order of their turns; so messages that arrive in one tick arrive in the order of the
;;; ticks and turns in which they were sent.

;;; Messages.

(defun message-datum-p (datum)
  "True if DATUM can be sent: plain data, see PLAIN-DATUM-P."
  (plain-datum-p datum))

(defun unsendable-text (datum)
  "Return a text about what to send instead of DATUM."
  (typecase datum
    ((or sequence number symbol) (plain-data-limits-text))
    (t "send the name of a robot or thing, or other data about it, not the object")))

(define-argument-type 'message #'message-datum-p
  "plain data: numbers, symbols, strings, characters, lists, vectors"
  #'unsendable-text)

;;; Mailboxes.

(define-event *message-hooks*
  "Functions called when a message has arrived in the mailbox of a robot, with the robot, the name
of the sender, and the tick in which the message was sent.")

;; Digests of runs without messages are as they were before there were radios.
(defmethod digest-state ((radio radio) digest)
  (if (and (null (resource-event radio))
           (null (radio-mailbox radio))
           (= 0 (radio-sent radio) (radio-dropped radio)))
      digest
      (call-next-method)))

(defmethod reference ((radio radio))
  (list :radio (robot-label (inner-resource-robot radio))))

;; Other dice would change the streams of runs without messages.
(defun seed-of-next-message (robot)
  "Count one more message that ROBOT sends. Return a number that seeds the dice for its noise."
  (let ((seed (world-seed (robot-world robot))))
    (mixed-word (mixed-word seed (robot-key robot)) (incf (radio-sent (robot-radio robot))))))

(defun note-last-arrival (radio entry tick)
  (let ((before (radio-last-arrivals radio)))
    (setf (radio-last-arrivals radio)
          (list* tick entry (and (eql tick (first before)) (rest before))))))

(defun last-arrivals (robot tick)
  "Return a list of the messages (message sender tick) that arrived at ROBOT in TICK, oldest first."
  (let ((arrivals (radio-last-arrivals (robot-radio robot))))
    (and (eql tick (first arrivals)) (reverse (rest arrivals)))))

(defun warn-of-full-mailbox (robot)
  (warn-once (list :mailbox (robot-name robot)) (robot-world robot)
             (format nil "The mailbox of ~A is full, so the oldest message is dropped. Take ~
                          messages with NEXT-MESSAGE, or raise mailbox-size*, which is ~D."
                     robot mailbox-size*)))

(defun put-message (robot message sender tick)
  "Put MESSAGE, which SENDER sent in TICK, into the mailbox of ROBOT. If the mailbox is full, drop
the oldest messages, count them, and warn once."
  (let* ((radio (robot-radio robot))
         (entry (list message sender tick))
         (before (radio-mailbox radio))
         (surplus (- (1+ (length before)) mailbox-size*)))
    (when (plusp surplus)
      (when (zerop (radio-dropped radio)) (warn-of-full-mailbox robot))
      (incf (radio-dropped radio) surplus))
    (setf (radio-mailbox radio)
          (append (nthcdr (max 0 surplus) before) (list entry)))
    (note-last-arrival radio entry (world-tick (robot-world robot)))
    (call-listeners *message-hooks* robot sender tick)))

(defun copied-message (message)
  (if (typep message '(or cons vector)) (copy-argument 'next-message "message" message) message))

(addition next-message)
(defun next-message (robot)
  "Take the oldest message from the mailbox of ROBOT. Return the message, the name of the robot that
sent it, a symbol, and the tick in which it was sent; or NIL if the mailbox is empty. As a message
may be NIL, test the second value. A message that was garbled on its way is :GARBLED. The journal
records that a message was taken. Signals WRONG-ARGUMENT."
  (check-argument next-message robot (robot-p robot) (argument-type-text 'robot robot))
  (let ((radio (robot-radio robot)))
    (when (radio-mailbox radio)
      (changing ((robot-world robot) next-message robot)
        (destructuring-bind (&optional message sender tick) (pop (radio-mailbox radio))
          (values (copied-message message) sender tick))))))

(define-operator 'next-message '(robot) #'next-message)

(defun check-mailbox-owner (operator robot)
  (unless (robot-p robot)
    (reject-argument operator "robot" robot (argument-type-text 'robot robot))))

(addition robot-messages)
(defun robot-messages (robot)
  "Return a list of the messages in the mailbox of ROBOT, which keeps them: lists (message sender
tick), the oldest first; see NEXT-MESSAGE. Signals WRONG-ARGUMENT."
  (check-mailbox-owner 'robot-messages robot)
  (loop for (message sender tick) in (radio-mailbox (robot-radio robot))
        collect (list (copied-message message) sender tick)))

(addition robot-dropped-messages)
(defun robot-dropped-messages (robot)
  "Return how many messages to ROBOT were dropped because its mailbox was full, see MAILBOX-SIZE*.
Signals WRONG-ARGUMENT."
  (check-mailbox-owner 'robot-dropped-messages robot)
  (radio-dropped (robot-radio robot)))

;;; Messages on their way. They name robots, as a robot may leave meanwhile.

(define-kind (arrival :include event
                      :constructor (make-arrival (world receiver message sender tick
                                                  &aux (operator 'arrival)
                                                    (arguments (list receiver message sender tick))
                                                    (function #'arrive))))
    "A message on its way: the event that it arrives."
  (:fixed
   (world nil (or null world) "the world that the receiver is in" :export)))

(defun arrive (arrival)
  "Put the message of ARRIVAL into the mailbox of its receiver, unless the receiver has left."
  (destructuring-bind (receiver message sender tick) (request-arguments arrival)
    (let ((robot (find receiver (world-robots (arrival-world arrival))
                       :key #'robot-name :test #'eq)))
      (when robot (put-message robot message sender tick)))))

(note-savable-function 'arrive)

(defun arrival-fits-p (arrival)
  "True if ARRIVAL, read from a file, is a message on its way."
  (and (eq 'arrival (request-operator arrival))
       (eq #'arrive (event-function arrival))
       (null (event-interrupt arrival))
       (null (event-resource arrival))
       (world-p (arrival-world arrival))
       (typep (request-arguments arrival)
              '(cons symbol (cons (satisfies message-datum-p)
                             (cons symbol (cons tick-count null)))))))

(defmethod check-request ((arrival arrival))
  (must-hold (arrival-fits-p arrival) "a message on its way is invalid"))
