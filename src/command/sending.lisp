;;;; sending.lisp -- messages between robots, by radio.

(in-package :ars-magna.command)

(export '(write-datum-safely))

;;; ROBOT-SEND occupies the robot's radio, not its body. The sender is not told whether a message
;;; has arrived: as with a real radio, the receiver must answer.

(define-argument-type 'recipient
  (lambda (value)
    (or (robot-p value)
        (and value (typep value '(or symbol string)))))
  "another robot of the run, its name, or :all for all others")

(defun reject-recipient (to robots)
  (reject-argument 'robot-send 'to to
                   (format nil "another robot than the sender: ~:[this run has only one, and :all ~
                                would reach nobody~;~:*~{~(~A~)~^, ~}, or :all for all of them~]"
                           (mapcar #'robot-label robots))))

;; The robot may have left since the request was recorded.
(defun recipient-named (name sender)
  "Return the name, a symbol, of the robot in the run of SENDER that NAME means. Signals
UNKNOWN-NAME and MISUSE, but not while the run is repeated."
  (let* ((world (robot-world sender)) (meant (robots-meant name (world-robots world))))
    (cond ((and meant (null (rest meant))) (robot-name (first meant)))
          ((and (symbolp name) (eq *repeated-timeline* (world-timeline world))) name)
          (meant (reject-use "robot-send: ~A could be ~{~A~^ or ~}. Give the full name."
                             name (mapcar #'robot-full-name meant)))
          (t (reject-name "robot in this run" name
                          (mapcar #'robot-name (remove sender (world-robots world))))))))

(defun check-message (sender to message)
  "Return the arguments of ROBOT-SEND to keep: TO as a symbol, and MESSAGE."
  (let ((name (cond ((robot-p to) (robot-name to))
                    ((eq to :all) :all)
                    (t (recipient-named to sender)))))
    (when (eq name (robot-name sender))
      (reject-recipient to (remove sender (robots-in-order (robot-world sender)))))
    (list name message)))

(defun in-radio-range-p (sender robot)
  (or (null radio-range*)
      (let ((dx (- (robot-x sender) (robot-x robot))) (dy (- (robot-y sender) (robot-y robot)))
            (range (double radio-range*)))
        (<= (+ (* dx dx) (* dy dy)) (* range range)))))

(defun receives-p (robot sender to)
  "True if ROBOT can receive a message of SENDER to TO, a name or :ALL."
  (and (not (eq robot sender))
       (or (eq to :all) (eq to (robot-name robot)))
       (in-radio-range-p sender robot)))

(defun arriving-message (message dice)
  "Return MESSAGE as it arrives, and true; or NIL and NIL if it is lost."
  (cond ((chance prob-lose-message* dice) (values nil nil))
        ((chance prob-garble-message* dice) (values :garbled t))
        (t (values message t))))

(defun transmit (operation sender to message)
  "Let MESSAGE of SENDER arrive at TO after the delay of the radio, unless it is lost."
  (let ((seed (seed-of-next-message sender)) (agenda (operation-agenda operation)))
    (dolist (robot (robots-in-order (robot-world sender)))
      (when (receives-p robot sender to)
        (multiple-value-bind (message arrives-p)
            (arriving-message message (make-dice (mixed-word seed (resource-key robot))))
          (when arrives-p
            (requeue-event agenda
                           (make-arrival (robot-world sender) (robot-name robot) message
                                         (robot-name sender) (agenda-tick agenda))
                           (ticks-for radio-delay*))))))))

(defun write-datum-safely (stream datum &rest parameters)
  "Write DATUM to STREAM as SAFE-TEXT shows it. FORMAT calls this function, so a message is printed
only when it is shown."
  (declare (ignore parameters))
  (write-string (safe-text datum) stream))

(define-command robot-send (operation (robot robot)
                            (to recipient
                             "another robot of the run, its name, or :all for all others")
                            (message message
                             "plain data: numbers, symbols, strings, characters, lists, vectors"))
    ()
    ((:family :messages) (:delay 1) (:occupies robot-radio) (:arguments check-message)
     (:report () (destructuring-bind (to message) (operation-arguments operation)
                   (phrase "Robot sent ~/ars-magna.command:write-datum-safely/ to ~(~A~)"
                           message to))))
    "Send MESSAGE by radio to another robot, or to all others. It arrives in the receivers'
mailboxes RADIO-DELAY* ticks later, see NEXT-MESSAGE, unless they are out of RADIO-RANGE* or it is
lost. The robot's body and parts continue. A newer ROBOT-SEND in the same tick interrupts an older
one."
  (transmit operation robot to message)
  (succeed operation))

(addition (robot-send :ars :nisp))
