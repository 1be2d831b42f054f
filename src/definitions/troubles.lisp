;;;; troubles.lisp -- reporting errors in users' code; who answers a debugger.

(in-package :ars-magna.definitions)

(export '(queue-user-error user-code-errors-in remove-errors-of-runs show-unread-messages
                           *echo-output*
          drop-unsignalled-errors take-unread-messages signal-pending-error answering-debugger
          waiting-debugger-name
          end-inquiries *inquiry-hooks* *debugger-refused-p*))

;;; A message has a cause if it reports an error in users' code, or the failure of a plan that
;;; no caller waits for. The error policy of the queue decides what happens then:
;;;
;;;   :REPORT   the message is queued, and shown when the run ends if it was not read
;;;   :SIGNAL   the first error is signalled as USER-CODE-ERROR where ticks are passed
;;;   :COLLECT  the message is queued; SIMULATION-ERRORS returns the errors
;;;
;;; A queue with a table ECHOED shows errors at once, unless it has a listener. All queues show
;;; warnings of code that may never end at once.

(addition user-code-error user-code-error-cause)
(define-condition user-code-error (ars-magna-error)
  ((text :initarg :text :reader user-code-error-text)
   (cause :initarg :cause :reader user-code-error-cause))
  (:report (lambda (condition stream) (write-string (user-code-error-text condition) stream)))
  (:documentation "An error in users' code that a run has called: a continuation, a kicker, a test
or a plan. The text of the error names the code. In a run with the error policy :SIGNAL (see
WITH-SIMULATION), RUN-TICKS, RUN-UNTIL, RUN-PLAN and WITH-SIMULATION signal this error."))
(setf (documentation 'user-code-error-cause 'function)
      "Return the condition, or the failure of a plan, that caused a USER-CODE-ERROR.")

;; What a REPL shows of SIMULATION-ERRORS.
(defmethod print-object ((error user-code-error) stream)
  (if *print-escape*
      (print-unreadable-object (error stream :type t)
        (write-string (cut (one-line (user-code-error-text error)) 200) stream))
      (call-next-method)))

(defun queue-user-error (cause text &rest stuff)
  "Queue an error message with the items STUFF about CAUSE, a condition in users' code or a failure
of a plan. TEXT is the message on one line. Return nothing."
  (queue-message-items :error stuff :cause cause :summary text))

(defun error-of-message (message)
  (make-condition 'user-code-error :text (message-summary message) :cause (message-cause message)))

(defun user-code-errors-in (queue run-p)
  "Return USER-CODE-ERRORs, the oldest first, for errors in QUEUE whose runs fulfil RUN-P."
  (let ((messages (with-queue (queue)
                    (reverse (message-queue-troubles queue)))))
    (loop for message in messages
          when (funcall run-p (message-run message))
            collect (error-of-message message))))

(defun remove-errors-of-runs (queue run-p)
  "Remove from QUEUE the errors of users' code that belong to runs for which RUN-P is true.
Otherwise the queue would keep finished runs from being garbage collected."
  (with-queue (queue)
    (setf (message-queue-troubles queue)
          (remove-if run-p (message-queue-troubles queue) :key #'message-run))))

(defun drop-unsignalled-errors (queue)
  "Mark the errors of users' code in QUEUE so that none of them is signalled."
  (with-queue (queue)
    (setf (message-queue-unsignalled queue) nil)))

(defun take-unsignalled-error (queue)
  "Remove from QUEUE the first error that must be signalled. Return it as a USER-CODE-ERROR, or NIL.
Later errors now in QUEUE will not be signalled."
  (when (message-queue-unsignalled queue)
    (with-queue (queue)
      (let ((message (shiftf (message-queue-unsignalled queue) nil)))
        (when message
          (when (member message (message-queue-newest-first queue) :test #'eq)
            (setf (message-queue-newest-first queue)
                  (remove message (message-queue-newest-first queue) :test #'eq))
            (decf (message-queue-count queue)))
          (error-of-message message))))))

(defun signal-pending-error (queue)
  "If QUEUE has a pending error of users' code, signal it. Return true if a handler continues after
the error; NIL if there was no error."
  (let ((trouble (take-unsignalled-error queue)))
    (when trouble
      (with-simple-restart (continue "Let the other ticks pass.")
        (error trouble))
      t)))

;;; Unread messages.

(defparameter *unread-message-limit* 20
  "The largest number of different unread messages that are shown.")

(defun take-unread-messages (queue)
  "Return a list of the unread messages in QUEUE, the oldest first. Mark all messages as read."
  (with-queue (queue)
    (let ((newest-first (message-queue-newest-first queue)))
      (reverse (ldiff newest-first (shiftf (message-queue-seen queue) newest-first))))))

(defun write-counted-messages (messages stream)
  (let ((counts (make-hash-table :test 'equal)) (texts '()))
    (dolist (message messages)
      (let ((text (write-message message nil (text-with-command message))))
        (when (= 1 (incf (gethash text counts 0))) (push text texts))))
    (loop for text in (reverse texts)
          repeat *unread-message-limit*
          do (format stream "~A~:[~; (~D times)~]~%" (string-right-trim '(#\Newline) text)
                     (< 1 (gethash text counts)) (gethash text counts)))
    (when (< *unread-message-limit* (length texts))
      (format stream "... and ~D other messages. To show all, call (error-display) within ~
                      the simulation.~%"
              (- (length texts) *unread-message-limit*)))))

(defun shown-at-end-p (message policy)
  "True if MESSAGE, which is unread, must be shown at the end of its run under POLICY."
  (let ((notable (message-notable-p message)))
    (or (if (functionp notable) (funcall notable) (eq t notable))
        (and (not (eq :collect policy)) (unreported-error-p message)))))

(defun show-unread-messages (queue &optional (wanted (constantly t)))
  "Write to the error output the unread messages in QUEUE that must be shown and fulfil WANTED."
  (unless flush-all-errors*
    (let ((messages (remove-if-not (lambda (message)
                                     (and (shown-at-end-p message
                                                          (message-queue-error-policy queue))
                                          (funcall wanted message)))
                                   (take-unread-messages queue))))
      (when messages
        (fresh-line *error-output*)
        (write-counted-messages messages *error-output*)
        (finish-output *error-output*)))))

;;; Messages that are shown at once.

(defvar *echo-output* nil
  "The stream on which the user of this Lisp sees messages of runs; NIL for the error output.")

(defconstant +counted-text-limit+ 1000 "The largest number of texts that are counted.")

(defvar *echo-counter* (make-message-queue :echoed (make-hash-table :test 'equal))
  "The queue that counts the messages shown for queues that have no table ECHOED.")

(defun count-echo (text queue)
  "Return how many times TEXT was reported, even if not shown, since the counts were cleared."
  (let* ((counter (if (message-queue-echoed queue) queue *echo-counter*))
         (counts (message-queue-echoed counter)))
    (with-queue (counter)
      (when (< +counted-text-limit+ (hash-table-count counts)) (clrhash counts))
      (incf (gethash text counts 0)))))

(defun power-of-ten-p (count)
  (loop for power = 1 then (* 10 power)
        while (< power count)
        finally (return (= power count))))

(defun echo-message (message queue)
  "Show MESSAGE to the user of this Lisp; if repeated, only at the 1st, 10th, 100th ... time."
  (unless flush-all-errors*
    (let* ((text (string-right-trim '(#\Newline)
                                    (write-message message nil (text-with-command message))))
           (count (count-echo text queue))
           (stream (or *echo-output* *error-output*)))
      (when (power-of-ten-p count)
        ;; The stream may be closed.
        (ignore-errors
         (format stream "~&~A~:[~; (~:*~D times so far)~]~%" text (and (< 1 count) count))
         (finish-output stream))))))

;;;; Which debugger asks for a restart

;;; Code that we call may enter a foreign debugger: Lisp's own or an editor's. Errors in what is
;;; typed there belong to that debugger, and must not reach our handlers around the code. If the
;;; editor disconnects before it has answered, another front end asks. If there is none, ABORT is
;;; chosen, or CONTINUE for a condition that is no error.

(defstruct (inquiry (:constructor make-inquiry (thread hook)) (:copier nil))
  "A pending question of the debugger of HOOK (NIL: Lisp's own): which restart for THREAD?"
  (thread nil :read-only t)
  (hook nil :read-only t))

(defvar *inquiries* '() "All pending questions, the newest first. Replaced, never modified.")
(defvar *inquiries-lock* (make-lock "inquiries"))

(define-event *inquiry-hooks*
  "Functions, or their names, of two arguments: a condition and a text that names the debugger. They
are called before the debugger asks for a restart, in the thread of the error.")

(defvar *debugger-refused-p* nil
  "True while the debugger hook must signal an error instead of asking the user.")

(defun debugger-name (hook)
  (if (or hook *debugger-hook*) "the editor's debugger" "Lisp's own debugger"))

(defun waiting-debugger-name (thread)
  "If a debugger asks for a restart of THREAD, return a text that names the debugger; else NIL."
  (let ((inquiry (find thread *inquiries* :key #'inquiry-thread)))
    (and inquiry (debugger-name (inquiry-hook inquiry)))))

(defun end-inquiries (gone-p)
  "Interrupt the threads whose debugger asks for a restart. The question of a thread ends if GONE-P
returns true there: its debugger has disconnected."
  (dolist (inquiry *inquiries*)
    (interrupt-thread (inquiry-thread inquiry)
                      (lambda ()
                        (when (and (member inquiry *inquiries*) (funcall gone-p))
                          (throw inquiry nil))))))

(defun call-as-debugger (function)
  "Call FUNCTION, which enters a debugger. Errors in code typed there enter the debugger, too."
  (handler-bind (((or error storage-condition) #'debug-nested-error))
    (funcall function)))

(defun debug-nested-error (condition)
  "Let the current debugger handle CONDITION, an error in code typed in that debugger."
  (unless (typep condition 'time-limit)
    (call-as-debugger (lambda () (invoke-debugger condition)))))

;; SWANK sets both of SBCL's hooks, and the function in the first defers to the other.
(defun enter-outer-debugger (condition hook)
  "Ask the user about CONDITION in the debugger of HOOK, else of *DEBUGGER-HOOK*, else of Lisp."
  (call-as-debugger (lambda ()
                      (when hook (funcall hook condition hook))
                      (cond (*debugger-hook*
                             (let ((other *debugger-hook*) (*debugger-hook* nil))
                               (funcall other condition other)))
                            ((null hook) (invoke-debugger condition))))))

(defun choose-restart-unasked (condition)
  "Warn, and invoke a restart of CONDITION without a debugger: ABORT for errors, else CONTINUE."
  (let ((name (if (typep condition 'serious-condition) 'abort 'continue)))
    (warning-set "The debugger that asked for a restart has disconnected; " (string-downcase name)
                 " was chosen: " (one-line-text condition))
    (when (eq name 'continue) (continue condition))
    (abort condition)))

(defun ask-for-restart (condition hook)
  "Let the debugger of HOOK, or another if it disconnects, ask the user for a restart of CONDITION."
  (let ((inquiry (make-inquiry (current-thread) hook)))
    (catch inquiry
      (with-lock (*inquiries-lock*) (push inquiry *inquiries*))
      (unwind-protect (progn (call-listeners *inquiry-hooks* condition (debugger-name hook))
                             (enter-outer-debugger condition hook))
        (with-lock (*inquiries-lock*) (setf *inquiries* (remove inquiry *inquiries*))))
      (return-from ask-for-restart))
    (ask-user-for-restart *front-end* condition)
    (choose-restart-unasked condition)))

(defun call-answering-debugger (function answer)
  "Call FUNCTION. If FUNCTION enters a debugger, call ANSWER with the condition, and true if an
interactive debugger is available. If none is available, ANSWER must not return."
  (declare (type function function answer))
  (let ((hook (debugger-hook))
        (foreign (foreign-hook)))
    (flet ((decide (condition this-hook)
             (declare (ignore this-hook))
             (funcall answer condition (debugger-available-p foreign))
             (cond ((disabled-hook-p hook))
                   ((and (eq hook foreign) (not *debugger-refused-p*))
                    (ask-for-restart condition hook))
                   (t (funcall hook condition hook)))))
      (declare (dynamic-extent #'decide))
      (let* ((answerer (cons #'decide foreign))
             (*answering-hook* answerer))
        (declare (dynamic-extent answerer))
        (with-debugger-hook (#'decide)
          (funcall function))))))

(defmacro answering-debugger ((answer) &body body)
  "Run BODY. If BODY enters a debugger, call ANSWER, as CALL-ANSWERING-DEBUGGER does."
  (form-calling 'call-answering-debugger body answer))
