;;;; agenda.lisp -- events waiting for their tick.

(in-package :ars-magna.time)

(export '(event agenda make-agenda queue-event requeue-event +longest-delay+ cancel-event
          interrupt-event pending-event advance-agenda pending-events request-name
          note-interruption interruption resource-key sorted-by-turn run-early due-event-p))

;;; A hierarchical timing wheel. The near wheel has a bucket for each tick of the current page of
;;; 256 ticks, the far wheel one for each page of the current volume of 256 pages; later events wait
;;; in one list. Turning a page moves its far bucket into the near wheel. The cost of queueing and
;;; running an event does not depend on the number of events.
;;;
;;; Invariants: a bucket is NIL or the last of its events, which form a ring: next to the last is
;;; the first, and so on in the order of queueing. Within a tick, higher priorities run first and
;;; equal ones in that order. If there are several robots, those of equal priority run in the order
;;; of their robots' turns, which differs from tick to tick; events without a robot run first. A
;;; resource has at most one pending event. Cancelled events stay in their bucket and are dropped
;;; when it comes up. Manual 3.8.

(defconstant +page-bits+ 8)
(defconstant +page-size+ (ash 1 +page-bits+))
(defconstant +page-mask+ (1- +page-size+))

(define-kind (event :include request :constructor (%make-event (function)))
    "An event: a call of FUNCTION, with the event as its argument, in the tick TIME."
  (:fixed
   (function #'identity function "the function of the event that is called in its tick" :export)
   (interrupt nil (or null function)
              "the function to call, with the event, if the event is interrupted" :export)
   (resource nil t "the resource that the event occupies, or NIL" :export))
  (:state
   (time 0 tick-count "the tick that the event waits for" :export)
   (priority 0 fixnum "the event's priority; higher ones come first")
   (pending-p nil boolean "the event waits for its tick" :export))
  (:link
   (queued-p nil boolean "a bucket holds the event, pending or cancelled" :export)
   (next nil (or null event) "the event after it in its bucket; the first after the last")))

(defmethod reference ((event event))
  (list :event (event-time event)))

(deftype bucket () '(or null event))
(deftype wheel () '(simple-vector #.+page-size+))

(defun make-wheel ()
  (make-array +page-size+ :initial-element nil))

(define-record (agenda (:constructor make-agenda () "Return an agenda without events, at tick 0."))
  "The events of one simulation that wait for their ticks."
  (tick 0 tick-count "the tick that the agenda has reached" :writable :export)
  (near (make-wheel) wheel "the events of the current page")
  (far nil (or null wheel) "the events of the later pages of the volume; NIL before the first"
       :writable)
  (beyond nil bucket :writable)
  (pending 0 fixnum "how many events are pending" :writable :export)
  (unequal 0 fixnum "how many of those have a priority other than 0" :writable)
  (salt nil (or null (unsigned-byte 64)) "the number from which the order of robots in the
current tick is computed, or NIL if there are not several robots" :writable :export)
  (claims (make-hash-table :test 'equal) hash-table "the pending event of each resource that is not
a RESOURCE structure; lists and strings are the same resource if they look the same"))

(declaim (inline add-to-ring detach-ring))
(defun add-to-ring (last event)
  "Add EVENT to the ring whose last event is LAST (NIL: empty). Return EVENT, the new last event."
  (setf (event-queued-p event) t
        (event-next event) (if last (shiftf (event-next last) event) event))
  event)

(define-modify-macro append-event (event) add-to-ring)

(defun detach-ring (last)
  "Cut the ring whose last event is LAST, and return its first event; NIL if LAST is NIL."
  (and last (shiftf (event-next last) nil)))

(defun put-in-bucket (agenda event)
  (declare #.*hot* (type agenda agenda) (type event event))
  (let* ((time (event-time event))
         (page (ash time (- +page-bits+)))
         (current (ash (agenda-tick agenda) (- +page-bits+))))
    (cond ((= page current)
           (append-event (svref (agenda-near agenda) (logand time +page-mask+)) event))
          ((= (ash page (- +page-bits+)) (ash current (- +page-bits+)))
           (let ((far (or (agenda-far agenda) (setf (agenda-far agenda) (make-wheel)))))
             (append-event (svref far (logand page +page-mask+)) event)))
          (t (append-event (agenda-beyond agenda) event)))))

(defun put-all-in-buckets (agenda event)
  "Put EVENT and the events that follow it into the buckets for their ticks. Drop cancelled events."
  (loop while event
        do (let ((next (event-next event)))
             (if (event-pending-p event)
                 (put-in-bucket agenda event)
                 (setf (event-queued-p event) nil))
             (setf event next))))

(defun turn-page (agenda)
  (let ((page (ash (agenda-tick agenda) (- +page-bits+))))
    (when (zerop (logand page +page-mask+))
      (put-all-in-buckets agenda (detach-ring (shiftf (agenda-beyond agenda) nil))))
    (when (agenda-far agenda)
      (put-all-in-buckets
       agenda (detach-ring (shiftf (svref (agenda-far agenda) (logand page +page-mask+)) nil))))))

;;; Resources.

(declaim (inline pending-event))
(defun pending-event (agenda resource)
  "Return the event that is pending on RESOURCE, or NIL."
  (if (resource-p resource)
      (resource-event resource)
      (values (gethash resource (agenda-claims agenda)))))

(defun set-pending-event (agenda event resource)
  "Make EVENT the pending event of RESOURCE; if EVENT is NIL, RESOURCE has none (reading 81)."
  (cond ((null resource))
        ((resource-p resource) (setf (resource-event resource) event))
        (event (setf (gethash resource (agenda-claims agenda)) event))
        (t (remhash resource (agenda-claims agenda)))))

;;; Queueing and cancelling.

(declaim (inline mark-event-pending mark-event-not-pending requeue-event))
(defun mark-event-pending (agenda event)
  (setf (event-pending-p event) t)
  (incf (agenda-pending agenda))
  (unless (zerop (event-priority event)) (incf (agenda-unequal agenda))))

(defun mark-event-not-pending (agenda event)
  (setf (event-pending-p event) nil)
  (decf (agenda-pending agenda))
  (unless (zerop (event-priority event)) (decf (agenda-unequal agenda))))

(defconstant +longest-delay+ (ash 1 59) "The largest delay of an event, in ticks.")

(defun requeue-event (agenda event delay)
  "Queue EVENT, which is not pending, to run DELAY ticks from now (at least 1). See reading 79."
  (declare (type tick-count delay))
  (when (event-queued-p event)
    (reject-use "An event that is still in the queue cannot be queued again."))
  (setf (event-time event) (the tick-count (+ (agenda-tick agenda) (max 1 delay))))
  (mark-event-pending agenda event)
  (when (event-resource event) (set-pending-event agenda event (event-resource event)))
  (put-in-bucket agenda event))

(defun queue-event (agenda delay function &key resource (priority 0) interrupt)
  "Queue and return a new event, which calls FUNCTION with itself DELAY ticks from now (at least 1).
RESOURCE must have no pending event. If the event is interrupted, INTERRUPT is called with it."
  (let ((event (%make-event function)))
    (setf (event-resource event) resource
          (event-priority event) priority
          (event-interrupt event) interrupt)
    (requeue-event agenda event delay)
    event))

(defun cancel-event (agenda event)
  "Remove EVENT from AGENDA if it is pending. No handler is called."
  (when (event-pending-p event)
    (mark-event-not-pending agenda event)
    (set-pending-event agenda nil (event-resource event))))

(defun interrupt-event (agenda event)
  "Cancel EVENT and call its interrupt handler."
  (when (event-pending-p event)
    (cancel-event agenda event)
    (when (event-interrupt event)
      (funcall (event-interrupt event) event))))

;;; Running.

(defun run-if-pending (agenda event)
  (declare #.*hot* (type agenda agenda) (type event event))
  (setf (event-queued-p event) nil)
  (when (event-pending-p event)
    (mark-event-not-pending agenda event)
    (when (event-resource event) (set-pending-event agenda nil (event-resource event)))
    (funcall (event-function event) event)))

(defun run-events-in-order (agenda event)
  "Run EVENT and the events after it. If an event exits non-locally, still run the events after it."
  (declare #.*hot* (type agenda agenda))
  (unwind-protect
       (loop while event
             do (run-if-pending agenda (shiftf event (event-next (the event event)))))
    (when event (run-events-in-order agenda event))))

;;; Turns of robots. A robot that is barred by another that has yet to drive in the tick lets the
;;; other go first: the event of the other runs early, and is skipped when its turn comes.

(defgeneric resource-key (resource)
  (:documentation "Return a number of 62 bits that identifies the robot of RESOURCE; 0 for none.")
  (:method (resource)
    (declare (ignore resource))
    0))

(declaim (inline turn-of-resource))
(defun turn-of-resource (resource salt)
  "Return a 64-bit number: in a tick with SALT, robots with lower numbers act first."
  (let ((key (if resource (resource-key resource) 0)))
    (declare (type (unsigned-byte 62) key) (type (unsigned-byte 64) salt))
    (if (zerop key) 0 (mixed-word key salt))))

(defconstant +turn-bits+ 41 "The number of bits of a turn that are compared.")
(defconstant +position-bits+ (- 61 +turn-bits+) "The number of bits for a position in a bucket.")

;; Shell's method. CL:SORT calls its predicate for each comparison, and takes ten times as long.
(defun sort-numbers (numbers)
  "Sort NUMBERS, a vector of fixnums, in place. Return NUMBERS."
  (declare #.*hot* (type (simple-array fixnum (*)) numbers))
  (loop for gap of-type (unsigned-byte 32) = (ash (length numbers) -1)
          then (if (= gap 2) 1 (truncate (* 5 gap) 11))
        while (plusp gap)
        do (loop for start of-type (unsigned-byte 32) from gap below (length numbers)
                 for number = (aref numbers start)
                 do (loop for place of-type fixnum = start then (- place gap)
                          while (and (>= place gap) (> (aref numbers (- place gap)) number))
                          do (setf (aref numbers place) (aref numbers (- place gap)))
                          finally (setf (aref numbers place) number))))
  numbers)

(defun sorted-by-turn (items resource-of salt)
  "Return ITEMS, a list, sorted by the turns of their robots in a tick with SALT; stable.
RESOURCE-OF is a function that returns the resource of an item, or NIL."
  (declare #.*hot* (type list items) (type function resource-of))
  (if (< (length items) (ash 1 +position-bits+))
      (let* ((vector (coerce items 'simple-vector))
             (numbers (make-array (length vector) :element-type 'fixnum)))
        (declare (type simple-vector vector))
        (dotimes (position (length vector))
          (let ((turn (turn-of-resource (funcall resource-of (svref vector position)) salt)))
            (setf (aref numbers position)
                  (logior (ash (ash turn #.(- +turn-bits+ 64)) +position-bits+) position))))
        (loop for number across (the (simple-array fixnum (*)) (sort-numbers numbers))
              collect (svref vector (logand number #.(1- (ash 1 +position-bits+))))))
      (stable-sort (copy-list items) #'<
                   :key (lambda (item) (turn-of-resource (funcall resource-of item) salt)))))

(defun due-event-p (agenda event)
  "True if EVENT, which is queued or was queued in AGENDA, is still to run in the current tick."
  (and (event-pending-p event)
       (= (event-time event) (agenda-tick agenda))))

(defun run-early (agenda event)
  "Run EVENT, which is due, before its turn."
  (run-if-pending agenda event))

;; An event that ran early may have been queued again, for a later tick.
(defun run-if-due (agenda event)
  (when (= (event-time event) (agenda-tick agenda))
    (run-if-pending agenda event)))

(defun run-bucket (agenda last)
  (declare #.*hot* (type agenda agenda))
  (let ((first (detach-ring last)))
    (cond ((eq first last) (run-if-pending agenda first))
          ((and (zerop (agenda-unequal agenda)) (null (agenda-salt agenda)))
           (run-events-in-order agenda first))
          (t (let ((salt (agenda-salt agenda))
                   (events (loop for event = first then (event-next event)
                                 while event collect event)))
               (when salt (setf events (sorted-by-turn events #'event-resource salt)))
               (unless (zerop (agenda-unequal agenda))
                 (setf events (stable-sort events #'> :key #'event-priority)))
               (call-each (lambda (event) (run-if-due agenda event)) events))))))

(defun advance-agenda (agenda)
  "Advance AGENDA to the next tick and run the events due in it."
  (declare #.*hot* (type agenda agenda))
  (let ((tick (incf (agenda-tick agenda))))
    (when (zerop (logand tick +page-mask+)) (turn-page agenda))
    (let ((last (svref (agenda-near agenda) (logand tick +page-mask+))))
      (when last
        (setf (svref (agenda-near agenda) (logand tick +page-mask+)) nil)
        (run-bucket agenda last)))))

;;; Listing and copying.

(defun pending-events (agenda)
  "Return a list of the pending events of AGENDA, sorted by time, priority and order of queueing."
  (let ((events '()))
    (flet ((note-bucket (last)
             (when last
               (loop for event = (event-next last) then (event-next event)
                     do (when (event-pending-p event) (push event events))
                     until (eq event last)))))
      (unless (zerop (agenda-pending agenda))
        (map nil #'note-bucket (agenda-near agenda))
        (map nil #'note-bucket (agenda-far agenda))
        (note-bucket (agenda-beyond agenda))))
    (stable-sort (stable-sort (nreverse events) #'> :key #'event-priority) #'< :key #'event-time)))

(defmethod digest-state ((agenda agenda) digest)
  (digest-add digest (agenda-tick agenda))
  (dolist (event (pending-events agenda) digest)
    (digest-state event digest)
    (digest-add digest (event-resource event))))

;; RESOURCE structures hold their pending events, so copying these copies that too.
(defmethod copy-plan-value ((agenda agenda) fork)
  (let ((copy (record-copy agenda (make-agenda) fork)))
    (setf (agenda-tick copy) (agenda-tick agenda)
          (agenda-salt copy) (agenda-salt agenda))
    (dolist (event (pending-events agenda) copy)
      (let ((twin (forked event fork)) (resource (event-resource event)))
        (mark-event-pending copy twin)
        (unless (resource-p resource) (set-pending-event copy twin (forked resource fork)))
        (put-in-bucket copy twin)))))

;;; The last interruption on a resource.

(defgeneric request-name (request)
  (:documentation "Return the name of the command or event that REQUEST requests, for messages.")
  (:method ((request request)) (request-operator request)))

(define-record (interruption (:constructor make-interruption (tick what asker by by-asker)))
  "A record: in TICK, the request BY of BY-ASKER interrupted the request WHAT of ASKER."
  (tick 0 tick-count "the tick of the interruption" :export)
  (what nil t "the name of what was interrupted" :export)
  (asker nil t "a note of who had asked for that" :export)
  (by nil t "the name of what interrupted it" :export)
  (by-asker nil t "a note of who had asked for that" :export))

(defun note-interruption (request rival tick)
  "Record, for messages, that the request RIVAL interrupts REQUEST on its resource in TICK."
  (let ((resource (event-resource request)))
    (when (resource-p resource)
      (setf (resource-interruption resource)
            (make-interruption tick
                               (request-name request) (request-asker request)
                               (request-name rival) (request-asker rival))))))

(define-shared-types interruption)
