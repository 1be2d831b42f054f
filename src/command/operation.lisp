;;;; operation.lisp -- a command under way: how it begins, goes on and ends.

(in-package :ars-magna.command)

;;; Issuing a command posts an OPERATION to the simulation. At the start of the next tick the
;;; operation takes its resource over, interrupting what was there, and waits for the command's
;;; delay; then its body runs, with the preconditions as they are by then. The body ends the
;;; operation, or goes on in further ticks. Invariant: an operation ends exactly once, and its
;;; continuation is called exactly once, at the end of that tick.

(defstruct (operation (:include event (function #'run-operation)) (:copier nil)
                      (:constructor make-operation (command resource arguments continuation
                                                    simulation)))
  "A command under way. It is the event that is pending on its resource."
  (command nil :type command :read-only t)
  (arguments '() :type list :read-only t)
  (continuation nil :read-only t)
  (simulation nil :type simulation :read-only t)
  ;; What to call in the next tick that is the operation's, with the operation.
  (step nil :type (or null function))
  (finished-p nil))

(document-functions
  operation-command "Return the command that the operation carries out."
  operation-resource "Return the robot or part that the operation occupies."
  operation-arguments "Return the arguments after the resource."
  operation-simulation "Return the simulation that the operation takes place in."
  operation-finished-p "True once the operation has ended.")

;;; Ending.

(defun interrupted-text (operation)
  (format nil "~A was interrupted" (command-prefix (operation-command operation))))

(defun failure-text (operation code)
  (let* ((command (operation-command operation))
         (error-code (find code (command-errors command) :key #'error-code-keyword))
         (text (and error-code (error-code-text error-code))))
    (etypecase text
      (null (format nil "~A: ~A" (command-prefix command) code))
      (string (format nil "~A" text))
      (function (funcall text operation)))))

(defun report (operation code results)
  "Queue the message that OPERATION ends with."
  (let* ((command (operation-command operation))
         (report (command-report command)))
    (cond ((eq code :interrupt) (warning-set (interrupted-text operation)))
          (code (error-set (failure-text operation code)))
          (report (let ((text (apply report operation results)))
                    (when text
                      (message-set (command-prefix command) ": " text)))))))

(defun fit-results (operation results)
  "Return RESULTS, with NIL for each of the command's results that is missing."
  (loop for nil in (command-results (operation-command operation))
        for rest = results then (rest rest)
        collect (first rest)))

(defun call-continuation (operation code results)
  (let ((origin (command-origin (operation-command operation))))
    (call-watched (operation-simulation operation)
                  (lambda ()
                    (apply #'call-user-code (operation-continuation operation) origin
                           code (operation-resource operation) results))
                  origin)))

(defun notify (operation code results)
  "Call the continuation of OPERATION with CODE and RESULTS at the end of this tick."
  (when (operation-continuation operation)
    (notify-later (operation-simulation operation)
                  (lambda () (call-continuation operation code results)))))

(defun finish (operation code &rest results)
  "End OPERATION: with the error CODE, or successfully if that is NIL. Its continuation gets CODE,
the resource and RESULTS. The second end of an operation changes nothing."
  (unless (operation-finished-p operation)
    (setf (operation-finished-p operation) t)
    (when (event-pending-p operation)
      (cancel-event (simulation-agenda (operation-simulation operation)) operation))
    (let ((results (fit-results operation results)))
      (report operation code results)
      (notify operation code results))))

(defun succeed (operation &rest results)
  "End OPERATION successfully; its continuation gets NIL, the resource and RESULTS."
  (apply #'finish operation nil results))

(defun fail-with (operation code &rest results)
  "End OPERATION with the error CODE; its continuation gets that, the resource and RESULTS."
  (apply #'finish operation code results))

;;; Beginning and going on.

(defun run-operation (operation)
  (let ((step (operation-step operation)))
    (declare (type function step))
    (unless (operation-finished-p operation)
      (funcall step operation))))

(declaim (inline once-more))
(defun once-more (operation)
  "Let the step of OPERATION be called again in the next tick. Called by that step."
  (queue-again (simulation-agenda (operation-simulation operation)) operation 1))

(defun go-on (operation step &optional (delay 1))
  "Let STEP, a function of OPERATION, be called DELAY ticks from now to carry it on."
  (setf (operation-step operation) step)
  (queue-again (simulation-agenda (operation-simulation operation)) operation delay))

(defun start-body (operation)
  (apply (command-body (operation-command operation))
         operation (operation-resource operation) (operation-arguments operation)))

(defun make-way (agenda rival)
  "Free the resource of RIVAL, the event pending on it: a command that takes no time and has only
just been issued is carried out first, anything else is interrupted. So (robot-set-speed ...)
followed by (robot-go-forward ...) sets the speed."
  (cond ((and (operation-p rival) (command-instant-p (operation-command rival)))
         (cancel-event agenda rival)
         (start-body rival))
        (t (interrupt-event agenda rival))))

(defun begin (operation)
  "Take over the resource of OPERATION and let it wait for its command's delay."
  (let* ((simulation (operation-simulation operation))
         (agenda (simulation-agenda simulation))
         (rival (pending-event agenda (operation-resource operation)))
         (delay (funcall (command-delay (operation-command operation)))))
    (when rival (make-way agenda rival))
    (setf (operation-step operation) #'start-body
          (operation-interrupt operation) (lambda () (finish operation :interrupt)))
    (queue-again agenda operation delay)))

(defun begin-unless-retired (operation)
  "Begin OPERATION, unless its robot has been retired since it was issued; then it is interrupted."
  (if (robot-retired (resource-robot (operation-resource operation)))
      (finish operation :interrupt)
      (begin operation)))

(defun resource-robot (resource)
  "Return RESOURCE if it is a robot, else the robot that it is a part of."
  (if (robot-p resource) resource (part-robot resource)))

(defun resource-simulation (resource)
  (robot-simulation (resource-robot resource)))

(defun issue (command resource arguments continuation)
  "Issue COMMAND on RESOURCE with ARGUMENTS, which have been checked; CONTINUATION may be NIL.
Return nothing: the command takes effect in the next tick. Signals MISUSE if the robot's run is
over."
  (check-in-run resource (command-name command))
  (let* ((simulation (resource-simulation resource))
         (operation (make-operation command resource arguments continuation simulation)))
    (post simulation
          (lambda ()
            (when (simulation-journal simulation)
              (note-command simulation operation))
            (begin-unless-retired operation))))
  (values))

;;; In the journal.

(defun note-command (simulation operation)
  (apply #'note simulation :command
         (string-downcase (command-name (operation-command operation)))
         (operation-resource operation)
         (operation-arguments operation)))

(defmethod apply-entry ((operation (eql :command)) arguments simulation)
  (declare (ignore simulation))
  (destructuring-bind (name resource . arguments) arguments
    (issue (find-command name) resource arguments nil)))
