;;;; troubles.lisp -- how errors in users' code come to the notice of whoever started that code.

(in-package :ars-magna.base)

;;; A message has a cause if something is wrong with users' code: an error that came up in it, or
;;; the failure of a plan that nobody waits for. What becomes of it is the manner of the queue:
;;;
;;;   :REPORT   it is a message, and shown when the run ends if nobody has read it
;;;   :SIGNAL   the first error is signalled as USER-CODE-ERROR to whoever lets ticks pass
;;;   :COLLECT  it is a message; who wants to know of errors asks SIMULATION-ERRORS
;;;
;;; A queue that echoes shows it when it happens, unless somebody listens to the queue.

(deftype error-manner ()
  "What becomes of errors in users' code."
  '(member :report :signal :collect))

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
  (queue-message (make-message :error stuff :cause cause :summary text) *message-queue*)
  (values))

(defun error-of-message (message)
  "Return MESSAGE, which has a cause, as a USER-CODE-ERROR."
  (make-condition 'user-code-error :text (message-summary message) :cause (message-cause message)))

(defun errors-in (queue run-p)
  "Return the errors of users' code that were told to QUEUE of runs for which RUN-P is true, as
USER-CODE-ERRORs, the oldest first."
  (loop for message in (reverse (message-queue-troubles queue))
        when (funcall run-p (message-run message))
          collect (error-of-message message)))

(defun forgive (queue)
  "Let no error of users' code that QUEUE has been told of be signalled."
  (setf (message-queue-unsignalled queue) nil))

(defun take-unsignalled (queue)
  "Return the first error of users' code that is to be signalled and was not, as USER-CODE-ERROR, or
NIL. It, and others that came after it, count as signalled; it is no message any more."
  (when (message-queue-unsignalled queue)
    (with-lock ((message-queue-lock queue))
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

(defun to-be-seen-p (message)
  "True if MESSAGE tells of an error, or of what is wrong with users' code, and nobody was told of
it otherwise."
  (and (not (message-told-p message))
       (or (message-cause message) (eq :error (message-kind message)))))

(defun notable-now-p (message queue)
  "True if MESSAGE, in QUEUE, is a warning to be shown like an error. Where errors are signalled, as
in tests and the trials of experiments, warnings are only messages."
  (let ((notable (message-notable-p message)))
    (and (eq :report (message-queue-manner queue))
         (if (functionp notable) (funcall notable) notable))))

(defun take-unseen (queue wanted)
  "Return the messages in QUEUE that are to be seen, that nobody has seen, and for which WANTED is
true, the oldest first. All in it counts as seen."
  (with-lock ((message-queue-lock queue))
    (let* ((newest-first (message-queue-newest-first queue))
           (unseen (ldiff newest-first (shiftf (message-queue-seen queue) newest-first))))
      (reverse (remove-if-not (lambda (message)
                                (and (or (to-be-seen-p message) (notable-now-p message queue))
                                     (funcall wanted message)))
                              unseen)))))

(defun overlook (queue)
  "Let nobody be shown what is in QUEUE by now; it can be read."
  (setf (message-queue-seen queue) (message-queue-newest-first queue)))

(defun write-counted (messages stream)
  "Write MESSAGES to STREAM, the same text once, with how often it came."
  (let ((counts (make-hash-table :test 'equal)) (texts '()))
    (dolist (message messages)
      (let ((text (write-message message nil)))
        (when (= 1 (incf (gethash text counts 0))) (push text texts))))
    (loop for text in (reverse texts)
          repeat *most-unread*
          do (format stream "~A~:[~; (~D times)~]~%" (string-right-trim '(#\Newline) text)
                     (< 1 (gethash text counts)) (gethash text counts)))
    (when (< *most-unread* (length texts))
      (format stream "... and ~D other messages; (error-display), inside, shows all.~%"
              (- (length texts) *most-unread*)))))

(defun tell-unseen (queue &optional (wanted (constantly t)))
  "Write to the error output the messages in QUEUE that are to be seen and for which WANTED is true,
unless they were read or told before, or errors are only to be collected."
  (unless (or flush-all-errors* (eq :collect (message-queue-manner queue)))
    (let ((messages (take-unseen queue wanted)))
      (when messages
        (fresh-line *error-output*)
        (write-counted messages *error-output*)
        (finish-output *error-output*)))))

;;; What is shown when it happens.

(defvar *echo-output* nil
  "The stream on which whoever works at this Lisp sees what runs write; NIL for the error output.")

(defconstant +most-echoed+ 1000 "How many texts are counted.")

(defun count-echo (text queue)
  "Return how often TEXT has been shown, or would have been, since it was last forgotten."
  (let ((counts (message-queue-echoed queue)))
    (with-lock ((message-queue-lock queue))
      (when (< +most-echoed+ (hash-table-count counts)) (clrhash counts))
      (incf (gethash text counts 0)))))

(defun power-of-ten-p (count)
  (loop for power = 1 then (* 10 power)
        while (< power count)
        finally (return (= power count))))

(defun echo-message (message queue)
  "Show MESSAGE to who works at this Lisp. Of what comes again and again, less and less is shown."
  (unless flush-all-errors*
    (let* ((text (string-right-trim '(#\Newline) (write-message message nil)))
           (count (count-echo text queue))
           (stream (or *echo-output* *error-output*)))
      (when (power-of-ten-p count)
        ;; The stream may be closed.
        (ignore-errors
         (format stream "~&~A~:[~; (~:*~D times by now)~]~%" text (and (< 1 count) count))
         (finish-output stream))))))

(setf *message-echo* 'echo-message)
