;;;; reading-ahead.lisp -- what many moves will need of memory, read at once before them.

(in-package :ars-magna.world)

;;; In a large world a move spends most of its time waiting for memory: for the thing, then for what
;;; is known of its cell, as one says where the other is. A processor waits for many words at a time
;;; as briefly as for one if it knows where they are. So short loops that only read go ahead of many
;;; moves, one for each step of that chain. What they find decides nothing.

;; The more the better, as each loop ends with waiting, as long as a processor has room for it all.
(define-constant +batch+ 512 :documentation "For how many moves memory is read at once.")

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
  (let* ((stock (world-stock world)) (firsts (stock-firsts stock)) (nexts (stock-nexts stock))
         (flags (world-flags world)) (sum 0))
    (declare (type (unsigned-byte 32) sum))
    (dotimes (i count)
      (let ((thing (svref batch i)))
        (setf (svref batch i) (if thing (cell-to-read thing) 0))
        (when thing (setf sum (logxor sum (aref nexts (thing-rank (the thing thing))))))))
    (dotimes (i count)
      (let ((index (svref batch i)))
        (declare (type cell-index index))
        (setf sum (logxor sum (aref flags index) (aref firsts index)))))
    sum))
