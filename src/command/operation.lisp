;;;; operation.lisp -- a command in progress: how it begins, continues and ends.

(in-package :ars-magna.command)

(export '(operation operation-command operation-resource operation-arguments operation-subject
          operation-p end-operation succeed fail-with
          notify-caller report go-on))

;;; Issuing a command posts an OPERATION, a request, to the timeline of its robot. At the start of
;;; the next tick the operation takes over its resource, interrupting the command there, and waits
;;; for its delay. Then its body runs and checks preconditions. The body ends the operation, or
;;; continues it in further ticks: its STEP is the name of a function, and its state from tick to
;;; tick is in the operation's slots. Invariant: an operation ends exactly once, and its
;;; continuation is called exactly once, at the end of that tick.

(define-kind (operation :include event
                        :constructor (make-operation
                                      (operator resource arguments continuation timeline
                                       &aux (function #'run-operation)
                                         (interrupt #'interrupt-operation)
                                         (asked (timeline-tick timeline)))))
    "A command in progress: the event that is pending on its resource."
  (:fixed
   (timeline nil (or null timeline) "the timeline of the operation"))
  (:state
   (step nil symbol "the name of the function that continues the operation")
   (finished-p nil boolean "the operation has ended")
   (count 0 fixnum "a counter of the command, such as of turns")
   (left 0d0 double-float "the rest of the movement: radians to turn, or ticks or metres to drive")
   (reading 0d0 double-float "the odometry's reading of the turn so far, in radians")
   (subject nil t "data of the command, such as the things found; before its body runs, the name of
the command that it has interrupted, or NIL"))
  (:memory
   (asked 0 fixnum "the tick after which the command was issued"))
  (:link
   (continuation nil t "the function to call when the command ends, or NIL")))

;; The continuation belongs to a program. A fork only copies it if it copies the program, too.
(defmethod copy-plan-value ((operation operation) fork)
  (let ((copy (copy-slots operation fork)))
    (when (or (and (operation-forked-p operation) (copier-option fork :participants))
              (copier-option fork :continuations))
      (setf (operation-continuation copy) (forked (operation-continuation operation) fork)))
    copy))

(note-savable-function 'run-operation)
(note-savable-function 'interrupt-operation)

(setf (documentation 'operation-resource 'function)
      "Return the robot or part that the operation occupies."
      (documentation 'operation-arguments 'function)
      "Return a list of the arguments of the command, without its resource and continuation."
      (documentation 'operation-subject 'function)
      "Return the data that the command keeps from tick to tick. Can be set.")

(declaim (inline operation-command operation-agenda))
(defun operation-command (operation)
  "Return the command that OPERATION carries out."
  (the command (operation-operator operation)))

(defmethod print-object ((operation operation) stream)
  (print-unreadable-object (operation stream)
    (format stream "~A of ~A" (command-name (operation-command operation))
            (operation-resource operation))))

(defun operation-agenda (operation)
  (timeline-agenda (the timeline (operation-timeline operation))))

(defun resource-for-users (operation)
  "Return the resource of OPERATION as programs and journals name it: the robot, not its mind
or radio."
  (let ((resource (operation-resource operation)))
    (if (inner-resource-p resource) (inner-resource-robot resource) resource)))

(defun operation-world (operation)
  (robot-world (resource-robot (operation-resource operation))))

(defmethod reference ((operation operation))
  (list :operation (name-string (command-name (operation-command operation)))
        (event-time operation)))

(defgeneric command-journal-entry (command operation)
  (:documentation "Return the journal entry of OPERATION, which carries out COMMAND.")
  (:method ((command command) operation)
    (list* (command-name command) (resource-for-users operation)
           (operation-arguments operation))))

(defmethod request-journal-entry ((operation operation))
  (command-journal-entry (operation-command operation) operation))

;;; Ending.

(defgeneric error-cause-text (code operation)
  (:documentation "Return a text that says why OPERATION ends with the error CODE, or NIL.")
  (:method (code operation)
    (declare (ignore code operation))
    nil))

(defun error-text (operation code)
  (let* ((command (operation-command operation))
         (error-code (find code (command-errors command) :key #'error-code-keyword))
         (text (and error-code (error-code-text error-code))))
    (etypecase text
      (null (format nil "~A: ~A" (command-prefix command) code))
      (string (format nil "~A~@[: ~A~]" text (error-cause-text code operation)))
      (function (funcall text operation)))))

(defun operation-formatter (control)
  "Return a function that formats CONTROL with the resource and arguments of an operation."
  (lambda (operation)
    (apply #'format nil control (operation-resource operation) (operation-arguments operation))))

(defun operation-robot-name (operation)
  (robot-name (resource-robot (operation-resource operation))))

(defun queue-operation-message (operation text)
  (let ((*request-origin* (request-asker operation))
        (*reported-robot* (operation-robot-name operation)))
    (message-set (command-prefix (operation-command operation)) ": " text)))

(defun queue-failure-message (operation kind code text)
  "OPERATION has ended with CODE: queue TEXT as a message of KIND, and record the failure."
  (queue-message (make-message kind (list text)
                               :about (command-name (operation-command operation))
                               :told-p (and (operation-continuation operation) t))
                 *message-queue*)
  (record-failure operation code text))

(defun report (operation code results)
  "Queue the message that OPERATION has ended with CODE and RESULTS (reading 229)."
  (let* ((*request-origin* (request-asker operation))
         (*reported-robot* (operation-robot-name operation))
         (command (operation-command operation))
         (report (command-report command)))
    (cond ((eq code :interrupt)
           (queue-failure-message operation :warning code
                                  (format nil "~A was interrupted" (command-prefix command))))
          (code (queue-failure-message operation :error code (error-text operation code)))
          (report (let ((text (printing-text () (apply report operation results))))
                    (when text (queue-operation-message operation text)))))))

(defun continuation-origin (operation)
  "Return the origin that messages name for the continuation of OPERATION. It names the robot if
there are several."
  (let ((origin (command-origin (operation-command operation)))
        (robot (resource-robot (operation-resource operation))))
    (if (and (robot-world robot) (rest (world-robots (robot-world robot))))
        (append (ensure-list origin) (list " of " (robot-label robot)))
        origin)))

;; See reading 86.
(defun call-continuation (operation code results)
  (when (operation-continuation operation)
    (when (operation-forked-p operation)
      (record-code-moment (operation-timeline operation)))
    (apply #'call-user-code (operation-continuation operation)
           (continuation-origin operation)
           code (resource-for-users operation) results)))

(defun notify-caller (operation code results)
  "Call the continuation of OPERATION with CODE and RESULTS at the end of this tick."
  (when (operation-continuation operation)
    (notify-later (operation-timeline operation) 'call-continuation operation code results)))

(defun end-operation (operation code &rest results)
  "End OPERATION with the error CODE, or successfully if CODE is NIL. The continuation gets CODE,
the resource and RESULTS. Does nothing if OPERATION has ended already."
  (unless (operation-finished-p operation)
    (setf (operation-finished-p operation) t)
    (when (event-pending-p operation)
      (cancel-event (operation-agenda operation) operation))
    ;; NIL for each of the command's results that is missing (reading 85).
    (let ((results (loop for nil in (command-results (operation-command operation))
                         for rest = results then (rest rest)
                         collect (first rest))))
      ;; A user's command may fail in its report.
      (unwind-protect (report operation code results)
        (notify-caller operation code results)))))

(defun succeed (operation &rest results)
  "End OPERATION successfully; its continuation gets NIL, the resource and RESULTS."
  (apply #'end-operation operation nil results))

(register-step 'succeed (constantly t))

(defun fail-with (operation code &rest results)
  "End OPERATION with the error CODE; its continuation gets CODE, the resource and RESULTS."
  (apply #'end-operation operation code results))

(defun body-begun-p (operation)
  (not (eq (operation-step operation) 'start-body)))

(defun results-if-interrupted (operation)
  "Return the results of OPERATION after an interruption: what :ECHO names, and NIL for others."
  (let* ((command (operation-command operation))
         (names (mapcar #'spec-name (command-parameters command))))
    (loop for result in (command-results command)
          for position = (position (spec-name result) names)
          collect (cond ((not (member (spec-name result) (command-echo command))) nil)
                        (position (nth position (operation-arguments operation)))
                        ((body-begun-p operation) (operation-subject operation))))))

(defun interrupt-operation (operation)
  (apply #'end-operation operation :interrupt (results-if-interrupted operation)))

;;; Beginning and continuing.

(defun call-users-step (operation step)
  "Call STEP, a step of a user's command. If STEP fails, or neither ends nor continues OPERATION,
queue a message and end OPERATION with :FAILED."
  (let ((origin (list "command " (command-prefix (operation-command operation))))
        (returned nil))
    (in-any-case
      (call-user-code (lambda ()
                        (funcall step operation)
                        (setf returned t))
                      origin)
      (unless (or (operation-finished-p operation)
                  ;; Pending or, if FREE-RESOURCE has begun it early, about to be interrupted.
                  (and returned (or (event-pending-p operation) (event-queued-p operation))))
        (when returned (apply #'error-set (append origin '(" neither ended nor continued"))))
        (end-operation operation :failed)))))

(declaim (inline call-step))
(defun call-step (operation step)
  (if (command-guarded-p (operation-command operation))
      (call-users-step operation step)
      (funcall (the symbol step) operation)))

(defun run-operation (operation)
  "Call the step of OPERATION for this tick. A non-local exit from the step interrupts OPERATION."
  (unless (operation-finished-p operation)
    (let ((returned nil))
      (unwind-protect
           (progn (call-step operation (operation-step operation))
                  (setf returned t))
        (unless (or returned (event-pending-p operation) (operation-finished-p operation))
          (interrupt-operation operation))))))

(declaim (inline repeat-step))
(defun repeat-step (operation)
  "Call the step of OPERATION again in the next tick. Only the step itself calls REPEAT-STEP."
  (requeue-event (operation-agenda operation) operation 1))

(defun go-on (operation step &optional (delay 1))
  "Continue OPERATION with STEP in DELAY ticks. STEP names a function that takes an operation."
  (setf (operation-step operation) step)
  ;; An operation that FREE-RESOURCE has begun early is still in the queue, and goes on no more.
  (unless (event-queued-p operation)
    (requeue-event (operation-agenda operation) operation (clamp delay 1 +longest-delay+))))

(defun go-on-now (operation step)
  "Continue OPERATION with STEP from this tick on. STEP names a function that takes an operation."
  (setf (operation-step operation) step)
  (funcall step operation))

;; See reading 78.
(define-step start-body (operation t)
  "Run the body of OPERATION's command."
  (apply (command-body (operation-command operation))
         operation (resource-for-users operation) (operation-arguments operation)))

(defun free-resource (operation agenda rival)
  "Free the resource of OPERATION, on which the event RIVAL is pending. If RIVAL has no delay and
has not begun, such as a ROBOT-SET-SPEED just before a ROBOT-GO-FORWARD, execute RIVAL (reading 77).
Then interrupt RIVAL, unless it has ended."
  (flet ((tell () (note-interruption rival operation (1+ (agenda-tick agenda)))))
    (cond ((and (operation-p rival) (command-instant-p (operation-command rival))
                (not (body-begun-p rival)))
           (cancel-event agenda rival)
           (call-step rival 'start-body)
           (unless (operation-finished-p rival)
             (tell)
             (interrupt-operation rival)))
          (t (tell)
             (interrupt-event agenda rival)))))

(defgeneric record-interrupted-operation (name operation rival)
  (:documentation "Record that OPERATION, of the command NAME, interrupts RIVAL.")
  (:method (name operation rival)
    (declare (ignore name))
    (when (body-begun-p rival)
      (setf (operation-subject operation) (command-name (operation-command rival))))))

(defun begin-operation (operation)
  "Let OPERATION take over its resource, and continue OPERATION after the delay of its command."
  (let* ((agenda (operation-agenda operation))
         (rival (pending-event agenda (operation-resource operation)))
         (delay (funcall (command-delay (operation-command operation)))))
    (when rival
      (when (operation-p rival)
        (record-interrupted-operation (command-name (operation-command operation)) operation rival))
      (free-resource operation agenda rival))
    (go-on operation 'start-body (ticks-for delay))))

;; A robot may have been retired since the command was issued.
(defmethod perform ((operation operation) timeline)
  (declare (ignore timeline))
  (if (robot-retired (resource-robot (operation-resource operation)))
      (end-operation operation :interrupt)
      (begin-operation operation)))

(defun resource-robot (resource)
  (cond ((robot-p resource) resource)
        ((inner-resource-p resource) (inner-resource-robot resource))
        (t (part-robot resource))))
