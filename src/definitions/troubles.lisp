;;;; troubles.lisp -- how errors in users' code come to the notice of whoever started that code.

(in-package :ars-magna.definitions)

(export '(trouble-set errors-in forget-errors show-unseen *echo-output* drop-unsignalled
          take-unseen signal-trouble))

;;; A message has a cause if it tells of an error in users' code, or of the failure of a plan that
;;; nobody waits for. The error policy of the queue decides what happens then:
;;;
;;;   :REPORT   the message is queued, and shown when the run ends if nobody has read it
;;;   :SIGNAL   the first error is signalled as USER-CODE-ERROR where ticks are passed
;;;   :COLLECT  the message is queued; SIMULATION-ERRORS returns the errors
;;;
;;; A queue with a table ECHOED shows errors at once, unless it has a listener. Each queue does that
;;; with warnings of what may never end.

(addition user-code-error user-code-error-cause)
(define-condition user-code-error (ars-magna-error)
  ((text :initarg :text :reader user-code-error-text)
   (cause :initarg :cause :reader user-code-error-cause))
  (:report (lambda (condition stream) (write-string (user-code-error-text condition) stream)))
  (:documentation "An error came up in users' code that a run has called: a continuation, a kicker,
a test, a plan that was begun. Its text says whose code it was. RUN-TICKS, RUN-UNTIL, RUN-PLAN and
WITH-SIMULATION signal it in a run that is to :SIGNAL errors, see WITH-SIMULATION."))
(setf (documentation 'user-code-error-cause 'function)
      "Return the condition, or the failure of a plan, that a USER-CODE-ERROR is of.")

;; What a REPL shows of SIMULATION-ERRORS.
(defmethod print-object ((error user-code-error) stream)
  (if *print-escape*
      (print-unreadable-object (error stream :type t)
        (write-string (cut (one-line (user-code-error-text error)) 200) stream))
      (call-next-method)))

(defun trouble-set (cause text &rest stuff)
  "Queue an error message made of the items STUFF which tells of CAUSE, a condition in users' code
or a failure of a plan; TEXT says it in a line. Return nothing."
  (queue-items :error stuff :cause cause :summary text))

(defun error-of-message (message)
  (make-condition 'user-code-error :text (message-summary message) :cause (message-cause message)))

(defun errors-in (queue run-p)
  "Return the errors of users' code that were told to QUEUE of runs for which RUN-P is true, as
USER-CODE-ERRORs, the oldest first."
  (let ((messages (with-queue (queue)
                    (reverse (message-queue-troubles queue)))))
    (loop for message in messages
          when (funcall run-p (message-run message))
            collect (error-of-message message))))

(defun forget-errors (queue run-p)
  "Forget the errors of users' code that were told to QUEUE of runs for which RUN-P is true: else a
run that is over would be kept as long as the queue."
  (with-queue (queue)
    (setf (message-queue-troubles queue)
          (remove-if run-p (message-queue-troubles queue) :key #'message-run))))

(defun drop-unsignalled (queue)
  "Let no error of users' code that QUEUE has been told of be signalled."
  (with-queue (queue)
    (setf (message-queue-unsignalled queue) nil)))

(defun take-unsignalled (queue)
  "Return the first error of users' code that is to be signalled and was not, as USER-CODE-ERROR, or
NIL. It, and others that came after it, count as signalled; it is no message any more."
  (when (message-queue-unsignalled queue)
    (with-queue (queue)
      (let ((message (shiftf (message-queue-unsignalled queue) nil)))
        (when message
          (when (member message (message-queue-newest-first queue) :test #'eq)
            (setf (message-queue-newest-first queue)
                  (remove message (message-queue-newest-first queue) :test #'eq))
            (decf (message-queue-count queue)))
          (error-of-message message))))))

(defun signal-trouble (queue)
  "Signal the error in users' code of which QUEUE has been told and that is to be signalled, if
there is one. True if there was, and whoever handled it wants to go on."
  (let ((trouble (take-unsignalled queue)))
    (when trouble
      (with-simple-restart (continue "Let the other ticks pass.")
        (error trouble))
      t)))

;;; What nobody has read.

(defparameter *most-unread* 20 "How many different messages are shown that nobody has read.")

(defun notable-now-p (message)
  (let ((notable (message-notable-p message)))
    (if (functionp notable) (funcall notable) (eq t notable))))

(defun take-unseen (queue)
  "Return the messages in QUEUE that nobody has seen, the oldest first. All in it counts as seen."
  (with-queue (queue)
    (let ((newest-first (message-queue-newest-first queue)))
      (reverse (ldiff newest-first (shiftf (message-queue-seen queue) newest-first))))))

(defun write-counted (messages stream)
  (let ((counts (make-hash-table :test 'equal)) (texts '()))
    (dolist (message messages)
      (let ((text (write-message message nil (text-with-command message))))
        (when (= 1 (incf (gethash text counts 0))) (push text texts))))
    (loop for text in (reverse texts)
          repeat *most-unread*
          do (format stream "~A~:[~; (~D times)~]~%" (string-right-trim '(#\Newline) text)
                     (< 1 (gethash text counts)) (gethash text counts)))
    (when (< *most-unread* (length texts))
      (format stream "... and ~D other messages; (error-display), inside, shows all.~%"
              (- (length texts) *most-unread*)))))

(defun shown-at-end-p (message policy)
  "True if MESSAGE, which nobody has seen, is shown when its run ends under the error POLICY."
  (or (notable-now-p message)
      (and (not (eq :collect policy)) (to-be-seen-p message))))

(defun show-unseen (queue &optional (wanted (constantly t)))
  "Write to the error output the messages in QUEUE that are to be seen and for which WANTED is true,
unless they were read or told before."
  (unless flush-all-errors*
    (let ((messages (remove-if-not (lambda (message)
                                     (and (shown-at-end-p message
                                                          (message-queue-error-policy queue))
                                          (funcall wanted message)))
                                   (take-unseen queue))))
      (when messages
        (fresh-line *error-output*)
        (write-counted messages *error-output*)
        (finish-output *error-output*)))))

;;; What is shown when it happens.

(defvar *echo-output* nil
  "The stream on which whoever works at this Lisp sees what runs write; NIL for the error output.")

(defconstant +most-echoed+ 1000 "How many texts are counted.")

(defvar *echo-counter* (make-message-queue :echoed (make-hash-table :test 'equal))
  "The queue that counts what is shown of queues without a table.")

(defun count-echo (text queue)
  "Return how often TEXT has been shown, or would have been, since it was last forgotten."
  (let* ((counter (if (message-queue-echoed queue) queue *echo-counter*))
         (counts (message-queue-echoed counter)))
    (with-queue (counter)
      (when (< +most-echoed+ (hash-table-count counts)) (clrhash counts))
      (incf (gethash text counts 0)))))

(defun power-of-ten-p (count)
  (loop for power = 1 then (* 10 power)
        while (< power count)
        finally (return (= power count))))

(defun echo-message (message queue)
  "Show MESSAGE to who works at this Lisp. Of what comes again and again, less and less is shown."
  (unless flush-all-errors*
    (let* ((text (string-right-trim '(#\Newline)
                                    (write-message message nil (text-with-command message))))
           (count (count-echo text queue))
           (stream (or *echo-output* *error-output*)))
      (when (power-of-ten-p count)
        ;; The stream may be closed.
        (ignore-errors
         (format stream "~&~A~:[~; (~:*~D times by now)~]~%" text (and (< 1 count) count))
         (finish-output stream))))))
