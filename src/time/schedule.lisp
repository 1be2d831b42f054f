;;;; schedule.lisp -- the manual's access to the scheduler (3.8).

(in-package :ars-magna.time)

(export '(schedule-call interrupt-resources interrupt-resource scheduled))

;;; Requests for a resource, by SCHEDULE, GRAB-RESOURCE or a command, are performed in the order in
;;; which they were made, at the start of the next tick. Of two events of SCHEDULE, the one with the
;;; higher priority stays, of equals the earlier; the other is interrupted. A command interrupts any
;;; event. It has the priority 0.

(define-kind (scheduled :include event
                        :constructor (make-scheduled
                                      (body resource priority on-interrupt test timeout timer
                                       &aux (operator 'schedule) (function #'run-scheduled)
                                         (interrupt #'interrupt-scheduled))))
    "An event that SCHEDULE has made."
  (:fixed
   (body nil function "the function of the event")
   (on-interrupt nil (or null function) "the function to call if the event loses, or NIL")
   (test nil (or null function) "a function that must return true for the event to happen, or NIL")
   (timeout nil (or null integer) "the number of ticks after which the event is dropped, or NIL")
   (timer 1 integer "the least number of ticks until the event may happen")
   (agenda nil (or null agenda) "the agenda in which the event waits"))
  (:state
   (deadline nil (or null integer) "the last tick in which the event may happen, or NIL")))

;; Requests are performed in a tick before the agenda has advanced to it.
(defun call-in-tick (function timeline)
  "Call FUNCTION, users' code, with the agenda of TIMELINE advanced to the current tick."
  (let ((agenda (timeline-agenda timeline)))
    (cond ((= (phase-number :requests) (timeline-phase timeline))
           (incf (agenda-tick agenda))
           (in-any-case (funcall function) (decf (agenda-tick agenda))))
          (t (funcall function)))))

(defun interrupt-scheduled (event)
  (let ((handler (scheduled-on-interrupt event)))
    (when handler
      (call-in-tick (lambda () (call-user-code handler "an event's interrupt handler"))
                    (timeline-of *simulation*)))))

(defun expires-first-p (event)
  (and (scheduled-deadline event)
       (< (scheduled-timeout event) (scheduled-timer event))))

(defun run-scheduled (event)
  "Call the body of EVENT if its test is true; if not, try again in the next tick (reading 80)."
  (let* ((test (scheduled-test event)) (deadline (scheduled-deadline event))
         (left (if deadline (- deadline (event-time event)) 1)))
    (cond ((or (minusp left) (expires-first-p event)))
          ((or (null test) (call-user-code test "a scheduled event's :when"))
           (call-user-code (scheduled-body event) "a scheduled event"))
          ((plusp left) (requeue-event (scheduled-agenda event) event 1)))))

(defun enter-event (event agenda)
  (setf (scheduled-agenda event) agenda
        (scheduled-deadline event) (and (scheduled-test event) (scheduled-timeout event)
                                        (+ (agenda-tick agenda) (scheduled-timeout event))))
  (requeue-event agenda event (if (expires-first-p event)
                                  (scheduled-timeout event)
                                  (scheduled-timer event))))

(defmethod perform ((event scheduled) timeline)
  (let* ((agenda (timeline-agenda timeline))
         (resource (event-resource event))
         (rival (and resource (pending-event agenda resource))))
    (cond ((and rival (>= (event-priority rival) (event-priority event)))
           (interrupt-scheduled event))
          (t (when rival
               (note-interruption rival event (1+ (agenda-tick agenda)))
               (interrupt-event agenda rival))
             (enter-event event agenda)))))

(defun schedule-call (function resource
                      &key (priority 0) interrupt when timeout (timer 1)
                           (simulation (current-simulation)))
  "Request an event that calls FUNCTION. The arguments are those of SCHEDULE. Returns nothing.
Signals WRONG-ARGUMENT for a priority, timer or timeout that is not an integer."
  (check-argument schedule priority (typep priority 'fixnum) "an integer")
  (check-argument-type 'schedule 'timer timer 'tick-span)
  (when timeout (check-argument-type 'schedule 'timeout timeout 'tick-span))
  (post (make-scheduled function (copy-argument 'schedule "resource" resource) priority
                        interrupt when timeout timer)
        simulation))

;; Only in memory: a function cannot be written to a file.
(defmethod request-journal-entry ((event scheduled))
  (list 'schedule (scheduled-body event) (event-resource event) (event-priority event)
        (scheduled-on-interrupt event) (scheduled-test event) (scheduled-timeout event)
        (scheduled-timer event)))

(define-operator 'schedule '(function datum integer datum datum datum integer)
  (lambda (function resource priority interrupt when timeout timer)
    (schedule-call function resource :priority priority :interrupt interrupt :when when
                                     :timeout timeout :timer timer)))

(defun intended-delay (head body)
  "Return the number in (schedule HEAD . BODY) that the user probably meant as a delay, or NIL."
  (find-if #'integerp (list* head (and (consp head) (ignore-errors (second head)))
                             (and (typep body '(cons t null)) body))))

(defmethod advice-on-use ((operator (eql 'schedule)) form)
  (let* ((head (second form)) (delay (intended-delay head (cddr form))))
    (flet ((advice (resource)
             (format nil "write (schedule (~(~A~)~@[ :timer ~D~]) ...)"
                     (unqualified-text resource) delay)))
      (cond ((null (rest form)) (advice nil))
            ((typep head '(cons (member lambda function)))
             (format nil "the code to run is the body: ~A" (advice nil)))
            ((integerp head) (advice nil))
            ((atom head) (advice head))
            ((typep head '(cons keyword)) (and delay (advice nil)))
            ((integerp (second head)) (advice (first head)))))))

(public schedule)
(define-user-macro schedule ((resource &key priority interrupt (when t when-p) timeout timer)
                    &body body)
  "Schedule an event that runs BODY on RESOURCE (NIL: none) in the next tick or in TIMER ticks.
- :PRIORITY is an integer, default 0. If the resource already has an event, the event with the
higher priority stays. Of events with equal priorities, the first stays.
- The form INTERRUPT is evaluated if this event loses.
- With the form WHEN, the event waits, after TIMER, for the first tick in which WHEN is true. If
that does not happen within TIMEOUT ticks from now, the event is dropped.
- TIMER and TIMEOUT are integers from 0 to 1e9.
INTERRUPT and WHEN, like BODY, run inside ticks. Resources that are EQUAL are the same resource.
Requests for a resource, including commands, are performed in the order in which they were made, at
the start of the next tick. A command has the priority 0, and interrupts any event on the resource.
Returns nothing (manual 3.8). See reading 7."
  (when (test-advice when) (warn-of-style "schedule, :when: ~A" (test-advice when)))
  `(schedule-call (lambda () ,@body) ,resource
                  :priority ,(or priority 0)
                  :timer ,(or timer 1)
                  ,@(when timeout `(:timeout ,timeout))
                  ,@(when interrupt `(:interrupt (lambda () ,interrupt)))
                  ,@(when when-p `(:when (lambda () ,when)))))

;;; Taking resources away.

(defgeneric interrupt-resource (resource timeline)
  (:documentation
   "Interrupt the event pending on RESOURCE, and its background activities. The thread that owns the
world calls this function inside a tick. A layer with background activities adds a method.")
  (:method (resource timeline)
    (let* ((agenda (timeline-agenda timeline))
           (event (pending-event agenda resource)))
      (when event (interrupt-event agenda event)))))

(define-kind (grab :include request :constructor (make-grab (arguments &aux (operator 'grab))))
    "A request to interrupt everything on a resource. The resource is the only argument.")

(defmethod perform ((grab grab) timeline)
  (let* ((resource (first (request-arguments grab)))
         (agenda (timeline-agenda timeline))
         (event (pending-event agenda resource)))
    (when event (note-interruption event grab (1+ (agenda-tick agenda))))
    (interrupt-resource resource timeline)))

(public grab-resource)
(defun grab-resource (resource &optional (simulation (current-simulation)))
  "At the start of the next tick, interrupt the command or event that occupies RESOURCE, and the
track of RESOURCE. Either may be missing. Returns nothing (manual, figure D.3). See reading 37."
  (count-request resource)
  (post (make-grab (list (copy-argument 'grab-resource "resource" resource))) simulation))

(define-operator 'grab '(datum) #'grab-resource)

(defun interrupt-resources (timeline resources)
  "Interrupt everything on RESOURCES, in order, and call the continuations. The thread that owns the
world of TIMELINE calls this function between ticks."
  (dolist (resource resources) (interrupt-resource resource timeline))
  (deliver-notifications timeline))
