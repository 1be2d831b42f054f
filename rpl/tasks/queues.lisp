;;;; queues.lisp -- the queue of ready tasks, and timers.

(in-package :ars-magna.rpl.tasks)

(export '(cancel-timer set-timer timer))

;;; The length of ITEMS is a power of two; the queue starts at START and wraps around.

(defstruct (ring (:constructor make-ring ()) (:copier nil))
  "A first-in first-out queue, to which items can also be added at the front."
  (items (make-array 16 :initial-element nil) :type simple-vector)
  (start 0 :type fixnum)
  (count 0 :type fixnum))
(declaim-final ring)

(defun grow-ring (ring)
  (let* ((items (ring-items ring))
         (length (length items))
         (larger (make-array (* 2 length) :initial-element nil)))
    (dotimes (i (ring-count ring))
      (setf (svref larger i) (svref items (logand (+ (ring-start ring) i) (1- length)))))
    (setf (ring-items ring) larger
          (ring-start ring) 0)))

(declaim (inline ring-push ring-push-front ring-pop))
(defun ring-push (item ring)
  (when (= (ring-count ring) (length (ring-items ring))) (grow-ring ring))
  (let ((items (ring-items ring)))
    (setf (svref items (logand (+ (ring-start ring) (ring-count ring)) (1- (length items)))) item)
    (incf (ring-count ring))))

(defun ring-push-front (item ring)
  (when (= (ring-count ring) (length (ring-items ring))) (grow-ring ring))
  (let* ((items (ring-items ring))
         (start (logand (1- (ring-start ring)) (1- (length items)))))
    (setf (svref items start) item
          (ring-start ring) start)
    (incf (ring-count ring))))

(defun ring-pop (ring)
  "Remove and return the first item of RING, which must not be empty."
  (let* ((items (ring-items ring))
         (start (ring-start ring))
         (item (svref items start)))
    (setf (svref items start) nil
          (ring-start ring) (logand (1+ start) (1- (length items))))
    (decf (ring-count ring))
    item))

;;; Timers due at the same tick fire in the order in which they were set. A timer stores its index
;;; in the heap, so that it can be removed at once.

(define-record (timer (:constructor make-timer (due serial wake client)))
  "A timer: at tick DUE, WAKE is called with the timer."
  (due 0 real)
  (serial 0 fixnum)
  (wake #'list function)
  (client nil t "the object for which the timer was set, such as a task" :export)
  (place nil (or null fixnum) :writable))

(defstruct (timers (:constructor make-timers ()) (:copier nil))
  "A heap of timers, with the earliest timer at index 0."
  (heap (make-array 16 :adjustable t :fill-pointer 0) :type (and vector (not simple-array)))
  (count 0 :type fixnum))
(declaim-final timer timers)

(defun earlier-p (a b)
  (or (< (timer-due a) (timer-due b))
      (and (= (timer-due a) (timer-due b))
           (< (timer-serial a) (timer-serial b)))))

(defun put-timer (timer place heap)
  (setf (aref heap place) timer
        (timer-place timer) place))

(defun sift-up (timer place heap)
  (loop while (plusp place)
        for above = (ash (1- place) -1)
        while (earlier-p timer (aref heap above))
        do (put-timer (aref heap above) place heap)
           (setf place above))
  (put-timer timer place heap))

(defun sift-down (timer place heap)
  (loop with count = (fill-pointer heap)
        for left = (1+ (* 2 place))
        while (< left count)
        do (let* ((right (1+ left))
                  (child (if (and (< right count) (earlier-p (aref heap right) (aref heap left)))
                             right
                             left)))
             (unless (earlier-p (aref heap child) timer) (return))
             (put-timer (aref heap child) place heap)
             (setf place child)))
  (put-timer timer place heap))

(defun set-timer (timers due wake client)
  "Return a new timer in TIMERS that calls WAKE at tick DUE, on behalf of CLIENT."
  (let ((timer (make-timer due (incf (timers-count timers)) wake client))
        (heap (timers-heap timers)))
    (vector-push-extend timer heap)
    (sift-up timer (1- (fill-pointer heap)) heap)
    timer))

(defun cancel-timer (timer timers)
  "Remove TIMER from TIMERS, if it is in TIMERS."
  (let ((place (timer-place timer))
        (heap (timers-heap timers)))
    (when place
      (let ((last (vector-pop heap)))
        (unless (eq last timer)
          (sift-down last place heap)
          (sift-up last (timer-place last) heap)))
      (setf (timer-place timer) nil))))

(defun next-timer (timers)
  (let ((heap (timers-heap timers)))
    (and (plusp (fill-pointer heap)) (aref heap 0))))

(defun run-timers (timers tick)
  (loop for timer = (next-timer timers)
        while (and timer (<= (timer-due timer) tick))
        do (cancel-timer timer timers)
           (funcall (timer-wake timer) timer)))
