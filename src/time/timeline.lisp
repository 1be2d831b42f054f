;;;; timeline.lisp -- the events of a run, the requests to it, and what thinking costs.

(in-package :ars-magna.time)

(export '(timeline make-timeline timeline-p timeline-of timeline-tick phase-in-this-thread
          record-code-moment check-not-over check-own-run check-not-secluded with-seclusion
          wake-owner post post-again withdraw-request take-requests requested-inside-tick-p owner-p
          *repeated-timeline* continuation-suppressed-p notify-later deliver-notifications
          check-thinking-mode thinking-modes-text thinking-mode-p timeline-thinking
          set-timeline-thinking
          choose-plan-threads thinking-charged-p thinking-budget))

;;; The thread that owns the timeline passes its ticks. Other threads use it in two ways. POST
;;; leaves a request, performed at the start of the next tick, and returns at once; all commands use
;;; it. ASK, in asking.lisp, calls a function between two ticks and waits for its values. A timeline
;;; that is not running yet keeps posted requests.

;;; Secluded code can change only the runs that it has begun itself.

(defvar *seclusion* nil
  "A symbol that marks the secluded code that this thread runs, and its timelines; or NIL. Its name
says why the code cannot change other runs, and what to do.")

(defmacro with-seclusion ((reason) &body body)
  "Run BODY as secluded code: BODY can change and command only runs that have begun in BODY. REASON,
a format control, is the text of the error that other changes and commands signal."
  `(let ((*seclusion* (make-symbol (format nil ,reason)))) ,@body))

(define-kind (timeline :constructor (make-timeline (name &optional (custody (make-custody)))))
    "The events of a run, and the requests that wait to be performed in it."
  (:fixed
   (name "" (or symbol string) "the name of the timeline, for messages" :export)
   (real-p nil boolean "plans think in a separate thread while the clock runs" :export))
  (:state
   (agenda (make-agenda) agenda "the events that wait for their ticks" :part :export)
   (charge '() list
           "the cost of thinking: NIL for no ticks, or a plist; see CHARGE-OF-THINKING-MODE"))
  ;; Requests are not part of a run's state before they are taken.
  (:scratch
   (inbox '() t "the requests that wait for the next tick, newest first" :export)
   (notifications '() list "the calls due at the end of the tick: lists (function argument...), the
newest first")
   (due-notifications '() list "the calls being made at the end of the tick, oldest first"))
  (:link
   (phase 0 fixnum
          "the number of phases of the current tick that have begun; 0 between ticks" :export)
   (moments 0 fixnum
            "the number of calls and acts of code in the tick, which forks repeat"
            :export)
   (on-moment nil (or null function) "a function to call before MOMENTS is counted up, or NIL"
                                     :export)
   (ticking-p nil boolean "a tick is under way, and the world changes" :export)
   (passing-p nil boolean "a thread passes ticks without a clock" :export)
   (fork-p nil boolean "the timeline is that of a fork" :export)
   (seclusion *seclusion* symbol "the mark of the secluded code that made the timeline, or NIL")
   (run nil t "the run that the timeline belongs to, or NIL" :export)
   (over nil (or null string)
         "why the run is over, a sentence without full stop; NIL if the run is not over" :export)
   (tick-dice (make-tick-dice) tick-dice
              "the dice of CL:RANDOM for users' code that changes the world" :export)
   (custody (make-custody) custody "the record of who owns the timeline and its world" :export)
   (pacing nil t "the pacing of the timeline, or NIL if it never ran live" :export)))

(setf (documentation 'make-timeline 'function)
      "Return a timeline named NAME, at tick 0, without events and requests. If the timeline follows
another of the same world, CUSTODY is the custody of that timeline.")

(declaim (inline timeline-tick))
(defun timeline-tick (timeline)
  "Return the number of ticks of TIMELINE that have passed; inside a tick, its number."
  (agenda-tick (timeline-agenda timeline)))

(defmethod print-object ((timeline timeline) stream)
  (print-unreadable-object (timeline stream :type t)
    (format stream "~A at tick ~D" (timeline-name timeline) (timeline-tick timeline))))

(defgeneric timeline-of (object)
  (:documentation "Return the timeline of OBJECT: a timeline, a run, a world with robots, a robot or
a part of a robot. Signals WRONG-ARGUMENT for any other object.")
  (:method ((timeline timeline)) timeline)
  (:method (object)
    (error 'wrong-argument :operator "ask" :name "simulation" :value object
                           :expected "a simulation, or a robot in one")))

(addition *simulation*)
(defvar *simulation* nil
  "The current simulation: of WITH-SIMULATION, the simulator's thread, or the last SIMULATOR call.")

(setf *get-reporting-run* (lambda () *simulation*))

(addition current-simulation)
(defun current-simulation ()
  "Return the current simulation, the value of *SIMULATION*. Signals MISUSE if there is none."
  (or *simulation*
      (reject-use "There is no current simulation. ~A"
                  (or (other-thread-run-text)
                      "Use (simulator ROBOT) or (with-simulation (ROBOT) ...)."))))

(defun check-not-over (object &optional operator)
  "Signal MISUSE if the run of OBJECT is over. The error names the function OPERATOR, if given."
  (let ((timeline (timeline-of object)))
    (when (timeline-over timeline)
      (reject-finished-run "~@[~(~A~): ~]The run in ~(~A~) is over, at tick ~D: ~A. ~
                            (simulator ROBOT) starts another."
                           operator (timeline-name timeline) (timeline-tick timeline)
                           (timeline-over timeline)))))

(defun wake-owner (timeline)
  "If the thread that paces TIMELINE sleeps, wake it, because there may be work for it."
  (wake-if-asleep (timeline-custody timeline)))

(defun owner-p (object)
  "True if this thread owns the world of OBJECT."
  (has-custody-p (timeline-custody (timeline-of object))))

(defun phase-in-this-thread (timeline)
  "If this thread is inside a tick of TIMELINE, return the number of the phase of the tick; else 0."
  (if (owner-p timeline) (timeline-phase timeline) 0))

;;; Plans are copied to forks and act there by themselves; other askers do not. To repeat acts of
;;; others at the right moment, their order among the acts of plans must be known.

(defun record-code-moment (timeline)
  "Record that code is about to run in a tick of TIMELINE that changed the world. Forks rerun this."
  (when (timeline-on-moment timeline) (funcall (timeline-on-moment timeline)))
  (incf (timeline-moments timeline)))

;;; When a run is repeated, all requests to it are repeated, including those of continuations. So
;;; continuations of commands that events and kickers issue inside ticks must not be called: their
;;; requests would be made twice.

(defvar *repeated-timeline* nil
  "The timeline of the run that this thread is repeating, as in a replay; or NIL.")

(defun continuation-suppressed-p (timeline)
  "True while this thread repeats the run of TIMELINE. Continuations are then not called, since the
requests that they made are repeated, too."
  (and (eq timeline *repeated-timeline*)
       (changing-phase-p (phase-in-this-thread timeline))
       (not (continues-in-forks-p))))

;;; Objects of a fork look like those of its original, and are easily confused with them.

(defun check-not-secluded (object)
  "Signal MISUSE if the current code is secluded, and the run of OBJECT did not begin in that code."
  (when (and *seclusion* (not (eq *seclusion* (timeline-seclusion (timeline-of object)))))
    (reject-use "~A" (symbol-name *seclusion*))))

(defun check-own-run (timeline)
  "Signal MISUSE if the current code must not change the run of TIMELINE, because the code is
secluded from that run, or works in a fork of another run in the same map."
  (check-not-secluded timeline)
  (let ((own (and *simulation* (timeline-of *simulation*))))
    (when (and own
               (timeline-fork-p own)
               (not (eq own timeline))
               (eq (timeline-name own) (timeline-name timeline)))
      (reject-use "This object belongs to another run than the fork in which this code works, at ~
                   tick ~D. (counterpart OBJECT *SIMULATION*) returns the copy of a robot or thing ~
                   in the fork; names of robots, and FIND-THING, give the objects of the fork."
                  (timeline-tick own)))))

;;; Requests.

(defun post (request object)
  "Post REQUEST, to be performed at the start of the next tick of OBJECT's run, after earlier
requests. Any thread may do so. Return nothing. Signals MISUSE if the run is over (reading 219)."
  (let ((timeline (timeline-of object)))
    (check-own-run timeline)
    (check-not-over timeline)
    (setf (request-asker request) (current-asker-note)
          (request-phase request) (phase-in-this-thread timeline))
    (atomic-push request (timeline-inbox timeline))
    ;; The run may have ended just now, and the inbox may have been emptied for the last time.
    (when (and (timeline-over timeline) (withdraw-request request timeline))
      (check-not-over timeline))
    (wake-owner timeline))
  (values))

(defun post-again (request timeline)
  "Put REQUEST back into the inbox of TIMELINE, as the last. The world's thread calls this."
  (atomic-push request (timeline-inbox timeline)))

(defun withdraw-request (request timeline)
  "Remove REQUEST from the inbox of TIMELINE. Return true; NIL if another thread had removed it."
  (loop for inbox = (timeline-inbox timeline)
        unless (member request inbox) return nil
        when (swap-if-eq (timeline-inbox timeline) inbox (remove request inbox))
          return t))

(defun requested-inside-tick-p (request)
  "True if REQUEST was made while a tick changed the world. A repeated tick makes REQUEST again."
  (changing-phase-p (request-phase request)))

;; Requests made by a tick are not in the journal. Other threads may post during that tick, so the
;; order between the two sorts must not matter.
(defun take-requests (timeline)
  "Empty the inbox of TIMELINE, and return a list of the requests. Requests made inside a tick come
first; in each group, the oldest comes first."
  (loop for inbox = (timeline-inbox timeline)
        when (swap-if-eq (timeline-inbox timeline) inbox '())
          return (if (rest inbox)
                     (let ((requests (reverse inbox)))
                       (append (remove-if-not #'requested-inside-tick-p requests)
                               (remove-if #'requested-inside-tick-p requests)))
                     inbox)))

;;; Notifications.

(defun notify-later (timeline function &rest arguments)
  "At the end of this tick of TIMELINE, call the function named FUNCTION, after earlier functions."
  (push (cons function arguments) (timeline-notifications timeline)))

(declaim (inline notifications-in-order))
(defun notifications-in-order (notifications salt)
  "Return NOTIFICATIONS, the newest first, in the order in which they are made: the oldest first or,
if there are several robots, by the turns of the robots in the tick with SALT."
  (flet ((resource (notification)
           (let ((event (second notification)))
             (and (typep event 'event) (event-resource event)))))
    (if (and salt (rest notifications))
        (sorted-by-turn (reverse notifications) #'resource salt)
        (reverse notifications))))

(defun next-notification (timeline)
  (or (pop (timeline-due-notifications timeline))
      (progn (setf (timeline-due-notifications timeline)
                   (notifications-in-order (shiftf (timeline-notifications timeline) '())
                                           (agenda-salt (timeline-agenda timeline))))
             (pop (timeline-due-notifications timeline)))))

(declaim (inline notifications-left-p deliver-notifications))
(defun notifications-left-p (timeline)
  (or (timeline-notifications timeline) (timeline-due-notifications timeline)))

;; A notification may fork the run. The fork then gets the remaining ones.
(defun deliver-all (timeline)
  (let ((*tick-dice* nil))
    (unwind-protect (loop for notification = (next-notification timeline)
                          while notification
                          do (apply (first notification) (rest notification)))
      (when (notifications-left-p timeline) (deliver-all timeline)))))

(defun deliver-notifications (timeline)
  "Make the calls due at the end of this tick, in order, even after a non-local exit from a call."
  (when (notifications-left-p timeline) (deliver-all timeline)))

;;; The manual (1.2) separates simulated time from thinking time. To measure the value of thinking,
;;; they must be connected in the same way on every machine. So a run has a thinking mode:
;;; - :FREE: the world waits
;;; - :CHARGED: thinking with a stated cost takes that many ticks
;;; - (:CHARGED :BUDGET steps): the steps of plans take ticks, too
;;; - :REAL: plans think in a separate thread while a clock runs
;;; The cost of thinking is part of the run's state. A separate thread only affects the requests to
;;; the run, and these are in the journal.

(defun charge-of-thinking-mode (mode)
  "Return the cost of thinking in MODE, a plist or NIL for no ticks; and true if MODE is valid."
  (cond ((member mode '(:free :real)) (values nil t))
        ((member mode '(:charged (:charged)) :test #'cl:equal) (values '(:charged t) t))
        ((and (typep mode '(cons (eql :charged) (cons (eql :budget) (cons t null))))
              (whole-p (third mode) 1))
         (values (list :charged t :budget (third mode)) t))))

(defun thinking-mode-p (mode)
  "True if MODE is a thinking mode that SET-THINKING accepts."
  (nth-value 1 (charge-of-thinking-mode mode)))

(defun thinking-modes-text ()
  "Return a text that lists the thinking modes."
  (format nil ":FREE, :REAL, :CHARGED, or (:CHARGED :BUDGET steps), where steps is the number of ~
               steps of plans in a tick, a whole number from 1 to 1e9"))

(defun check-thinking-mode (operator mode)
  "Signal WRONG-ARGUMENT, as an error of OPERATOR, unless MODE is a thinking mode."
  (unless (thinking-mode-p mode)
    (reject-argument operator 'thinking mode (thinking-modes-text))))

(defun timeline-thinking (timeline)
  "Return the thinking mode of TIMELINE."
  (let ((budget (thinking-budget timeline)))
    (cond (budget (list :charged :budget budget))
          ((thinking-charged-p timeline) :charged)
          ((timeline-real-p timeline) :real)
          (t :free))))

(defun set-timeline-thinking (timeline mode)
  "Set the thinking mode of TIMELINE to MODE."
  (setf (timeline-charge timeline) (charge-of-thinking-mode mode)
        (timeline-real-p timeline) (eq mode :real)))

(defun choose-plan-threads (timeline real)
  "If REAL is true and thinking is free, make the plans of TIMELINE run in a separate thread."
  (setf (timeline-real-p timeline) (and real (not (timeline-charge timeline)))))

(defun thinking-charged-p (timeline)
  "True if thinking with a stated cost takes ticks in TIMELINE."
  (and (timeline-charge timeline) t))

(defun thinking-budget (timeline)
  "Return the number of steps that plans in TIMELINE may take in a tick; NIL if there is no limit."
  (getf (timeline-charge timeline) :budget))
