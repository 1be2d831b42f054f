;;;; reading-ahead.lisp -- what many moves will need of memory, read at once before them.

(in-package :ars-magna.world)

;;; In a large world a move spends most of its time waiting for memory: for the thing, then for the
;;; list of its cell, then for a link of that, as each says where the next is. A processor waits for
;;; many words at a time as briefly as for one if it knows where they are. So short loops that only
;;; read go ahead of many moves, one for each step of that chain. What they find decides nothing.

(define-constant +batch+ 64 :documentation "For how many moves memory is read at once.")

(deftype batch () '(simple-vector #.+batch+))
(deftype batch-count () '(integer 0 #.+batch+))

(declaim (inline cell-to-read))
(defun cell-to-read (thing)
  "Return the index of the cell that THING lies in, or 0 if it does not lie on the floor."
  (declare (type thing thing))
  (or (and (eq :floor (thing-location thing))
           (point-index (world-map (thing-world thing)) (thing-x thing) (thing-y thing)))
      0))

(defun read-ahead (batch count world)
  "Read what it takes to move the first COUNT elements of BATCH, things of WORLD or NIL; they are
overwritten. Return a number without a meaning, for which all has to be read indeed."
  (declare #.*hot* (type batch batch) (type batch-count count) (type world world))
  (let ((cells (world-cells world)) (flags (world-flags world)) (sum 0))
    (declare (type fixnum sum))
    (flet ((note (object) (when object (setf sum (logxor sum 1)))))
      (declare (inline note))
      ;; The two ends of what a move reads of a thing.
      (dotimes (i count)
        (let ((thing (svref batch i)))
          (note (and thing (thing-location thing) (thing-obsview-p thing)))))
      (dotimes (i count)
        (let ((thing (svref batch i)))
          (setf (svref batch i) (if thing (cell-to-read thing) 0))))
      (dotimes (i count)
        (let ((index (svref batch i)))
          (declare (type cell-index index))
          (setf sum (logxor sum (aref flags index))
                (svref batch i) (svref cells index))))
      (dotimes (i count)
        (note (rest (the list (svref batch i))))))
    sum))
