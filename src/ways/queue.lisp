;;;; queue.lisp -- nodes that wait, by their keys: a binary heap in two arrays.

(in-package :ars-magna.ways)

;;; A node may be in it more than once; who takes one out sees whether it still counts.

(deftype nodes () '(simple-array (unsigned-byte 31) (*)))

(defstruct (queue (:constructor make-queue ()) (:copier nil))
  "Nodes with their keys, double-floats. The least key comes first."
  (keys (make-amounts 64 0d0) :type amounts)
  (nodes (make-array 64 :element-type '(unsigned-byte 31)) :type nodes)
  (count 0 :type (unsigned-byte 40)))
(declaim-final queue)

(defun enlarge-queue (queue)
  "Give QUEUE room for twice as many."
  (flet ((enlarged (array)
           (replace (make-array (* 2 (length array)) :element-type (array-element-type array))
                    array)))
    (setf (queue-keys queue) (enlarged (queue-keys queue))
          (queue-nodes queue) (enlarged (queue-nodes queue)))))

(declaim (inline put-in-place))
(defun put-in-place (keys nodes place key node)
  "Let NODE with KEY be at PLACE of the arrays KEYS and NODES of a queue."
  (declare (type amounts keys) (type nodes nodes))
  (setf (aref keys place) key
        (aref nodes place) node))

(declaim (inline queue-push))
(defun queue-push (queue node key)
  (declare (type node node) (type double-float key))
  (when (= (queue-count queue) (length (queue-keys queue))) (enlarge-queue queue))
  (let ((keys (queue-keys queue)) (nodes (queue-nodes queue)) (place (queue-count queue)))
    (setf (queue-count queue) (1+ place))
    (loop while (plusp place)
          do (let ((parent (ash (1- place) -1)))
               (when (<= (aref keys parent) key) (return))
               (put-in-place keys nodes place (aref keys parent) (aref nodes parent))
               (setf place parent)))
    (put-in-place keys nodes place key node)
    nil))

(defun queue-drop (queue)
  "Take out the node with the least key."
  (declare #.*hot*)
  (let* ((keys (queue-keys queue)) (nodes (queue-nodes queue))
         (count (1- (queue-count queue)))
         (key (aref keys count)) (node (aref nodes count)) (place 0))
    (declare (type (unsigned-byte 40) count place))
    (setf (queue-count queue) count)
    (loop
      (let ((child (1+ (* 2 place))))
        (declare (type (unsigned-byte 41) child))
        (when (>= child count) (return))
        (when (and (< (1+ child) count) (< (aref keys (1+ child)) (aref keys child)))
          (incf child))
        (when (>= (aref keys child) key) (return))
        (put-in-place keys nodes place (aref keys child) (aref nodes child))
        (setf place child)))
    (put-in-place keys nodes place key node)
    nil))

(defun copy-into-queue (queue other)
  (setf (queue-keys queue) (copy-seq (queue-keys other))
        (queue-nodes queue) (copy-seq (queue-nodes other))
        (queue-count queue) (queue-count other))
  queue)
