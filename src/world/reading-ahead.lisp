;;;; reading-ahead.lisp -- memory for the next trials and moves, read at once before them.

(in-package :ars-magna.world)

;;; In a large world a move mostly waits for memory: for the thing, then for its cell, whose address
;;; depends on the thing. A processor reads many words in the time of one if it knows their
;;; addresses. So before many moves, short loops read ahead, one loop for each step of that chain.
;;; What they read does not affect results.

;; The larger the better, until a processor's cache is full, as each loop ends with waiting.
(defconstant +moves-per-batch+ 512 "The number of moves for which memory is read at once.")

(deftype batch () '(simple-vector #.+moves-per-batch+))
(deftype batch-count () '(integer 0 #.+moves-per-batch+))

(declaim (inline cell-index-or-zero))
(defun cell-index-or-zero (thing)
  "Return the index of the cell that THING is in, or 0 if THING is not on the floor."
  (declare (type thing thing))
  (or (and (eq :floor (thing-location thing))
           (point-index (world-map (thing-world thing)) (thing-x thing) (thing-y thing)))
      0))

(defun read-ahead (batch count world)
  "Read the memory that moves of the first COUNT elements of BATCH, things or NIL, need. Overwrite
these elements. Return a meaningless number, so that the compiler keeps the reads."
  (declare #.*hot* (type batch batch) (type batch-count count) (type world world))
  (let* ((stock (world-stock world)) (firsts (stock-firsts stock)) (nexts (stock-nexts stock))
         (flags (world-flags world)) (sum 0))
    (declare (type (unsigned-byte 32) sum))
    (dotimes (i count)
      (let ((thing (svref batch i)))
        (setf (svref batch i) (if thing (cell-index-or-zero thing) 0))
        (when thing (setf sum (logxor sum (aref nexts (thing-rank (the thing thing))))))))
    (dotimes (i count)
      (let ((index (svref batch i)))
        (declare (type cell-index index))
        (setf sum (logxor sum (aref flags index) (aref firsts index)))))
    sum))

;;; Which trials succeed: the gaps between successes, drawn or foreseen.

(defun gap-scale (probability)
  "Return the factor that turns the logarithm of a roll into a gap between successes; see DRAW-GAP."
  (cond ((>= probability 1d0) 0d0)
        ((< probability 1d-12) (- (/ (max probability 1d-300))))
        (t (/ (logarithm (- 1d0 probability))))))

(declaim (inline draw-gap))
(defun draw-gap (scale dice)
  "Return how many trials fail before the next success. For the probability p, SCALE is 1 / log(1 -
p), or 0 if p is 1."
  (declare (type double-float scale))
  (let ((u (- 1d0 (roll dice))))
    (declare (type (double-float (0d0) 1d0) u))
    (truncate (the (double-float 0d0 #.(double (expt 2 40)))
                   (min #.(double (expt 2 40)) (* scale (%logarithm u)))))))

;;; To know which trials will succeed, numbers are drawn ahead. They depend on the state of the dice
;;; alone, so if the dice are in that state later, the results need not be computed again.

(deftype gaps () '(simple-array (unsigned-byte 62) (#.+moves-per-batch+)))

(defstruct (outlook (:constructor make-outlook ()) (:copier nil))
  "Gaps between successes, drawn ahead: the first COUNT elements of GAPS. Dice whose state is STATE
would next draw the gap with the index NEXT."
  (gaps (make-array +moves-per-batch+ :element-type '(unsigned-byte 62) :initial-element 0)
   :type gaps :read-only t)
  (count 0 :type batch-count)
  (next 0 :type batch-count)
  (state 0 :type (unsigned-byte 64)))
(declaim-final outlook)

;; Inline, so that SCALE is not boxed.
(declaim (inline draw-next-gaps))
(defun draw-next-gaps (outlook index end scale dice)
  "Store in OUTLOOK the next gaps of SCALE and DICE, for trials before END. The next success is at
INDEX. Return the index of the first success after these gaps."
  (declare (type outlook outlook) (type (unsigned-byte 50) index end)
           (type double-float scale) (type dice dice))
  (let ((dice (copy-dice dice)) (gaps (outlook-gaps outlook)) (count 0))
    (declare (dynamic-extent dice) (type batch-count count))
    (setf (outlook-state outlook) (dice-state dice))
    (loop while (and (< index end) (< count +moves-per-batch+))
          do (let ((gap (draw-gap scale dice)))
               (setf (aref gaps count) gap)
               (incf count)
               (incf index (1+ gap))))
    (setf (outlook-next outlook) 0
          (outlook-count outlook) count)
    index))

(declaim (inline draw-gap-from-outlook))
(defun draw-gap-from-outlook (outlook scale dice)
  "Return the value of DRAW-GAP for SCALE and DICE, from OUTLOOK if it is not NIL and has this gap."
  (let ((next (if outlook (outlook-next outlook) 0)))
    (cond ((and outlook
                (< next (outlook-count outlook))
                (= (dice-state dice) (outlook-state outlook)))
           (roll dice)
           (setf (outlook-next outlook) (1+ next)
                 (outlook-state outlook) (dice-state dice))
           (aref (outlook-gaps outlook) next))
          (t (draw-gap scale dice)))))
