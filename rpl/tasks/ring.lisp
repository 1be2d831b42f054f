;;;; ring.lisp -- a queue that conses nothing once it has grown: who runs next.

(in-package :ars-magna.rpl.tasks)

;;; The length of ITEMS is a power of two; the queue starts at START and wraps around.

(defstruct (ring (:constructor make-ring ()) (:copier nil))
  "A first-in first-out queue that can also be pushed to at its front."
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
