;;;; octet-queue.lisp -- octets handed over before their time, in the order in which they came.

(in-package :ars-magna.cli)

;;; Of many lines that are pasted at once, most wait here while the first are carried out. Neither
;;; to add to them, nor to see whether control C is among them, may take the longer the more they
;;; are.

(defparameter *control-c* (code-char 3))

(defstruct (octet-queue (:copier nil) (:constructor make-octet-queue ()))
  "OCTETS, a list of characters, of which LAST is the last cons. INTERRUPTS is how many of them are
control C."
  (octets '() :type list)
  (last '() :type list)
  (interrupts 0 :type (integer 0)))

(defun empty-queue-p (queue)
  (null (octet-queue-octets queue)))

(defun whole-line-p (queue)
  (find-if (lambda (octet) (find octet '(#\Return #\Newline))) (octet-queue-octets queue)))

(defun take-octet (queue)
  (let ((octet (pop (octet-queue-octets queue))))
    (when (char= octet *control-c*) (decf (octet-queue-interrupts queue)))
    octet))

(defun add-octets (queue octets)
  "Let OCTETS, a fresh list, come after those of QUEUE."
  (when octets
    (if (empty-queue-p queue)
        (setf (octet-queue-octets queue) octets)
        (setf (rest (octet-queue-last queue)) octets))
    (setf (octet-queue-last queue) (last octets))
    (incf (octet-queue-interrupts queue) (count *control-c* octets))))

(defun put-back-octet (queue octet)
  (if (empty-queue-p queue)
      (add-octets queue (list octet))
      (progn (push octet (octet-queue-octets queue))
             (when (char= octet *control-c*) (incf (octet-queue-interrupts queue))))))

(defun take-all-octets (queue)
  (setf (octet-queue-interrupts queue) 0)
  (shiftf (octet-queue-octets queue) '()))

(defun forget-until-interrupt (queue)
  "Take all up to the last control C out of QUEUE. True if there is one."
  (when (plusp (octet-queue-interrupts queue))
    (loop until (zerop (octet-queue-interrupts queue)) do (take-octet queue))
    t))
