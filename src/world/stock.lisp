;;;; stock.lisp -- the things of a world by number, and which of them lie in which cell.

(in-package :ars-magna.world)

;;; A world may have a million cells and a hundred thousand things. So positions are kept in flat
;;; vectors of small numbers, which need few memory accesses and are copied at once. The RANK of a
;;; thing is its index in the vector of things. In the vectors of numbers a thing is its TAG, 1 more
;;; than its rank; 0 is no thing. The things on a cell's floor form a chain, in order of arrival.
;;;
;;; Bodies of robots come first in the chain of a cell, and their ranks do not count where ranks
;;; matter: in digests, and when ranks are renumbered. A removed body keeps its rank until then. So
;;; it makes no difference when a robot has joined the world before its first tick.

(deftype tag () '(unsigned-byte 32))
(deftype tags () '(simple-array tag (*)))

(defun make-tag-vector (size) (make-array size :element-type 'tag :initial-element 0))

(defconstant +initial-stock-size+ 16 "The number of things that a new stock has room for.")

(define-kind (stock :constructor (make-stock (&optional (cells 0)
                                              &aux (firsts (make-tag-vector cells)))))
    "The things of a world, and the cells of the floor that they are in."
  (:state
   (things (make-array +initial-stock-size+ :initial-element nil) simple-vector
           "the things by rank, in order of creation; NIL where one has been destroyed" :part)
   (count 0 fixnum "the number of ranks in use")
   (bodies 0 fixnum "the number of ranks that robots' bodies have or had")
   (firsts (make-tag-vector 0) tags "by cell index, the tag of the first thing on the cell's floor")
   (nexts (make-tag-vector +initial-stock-size+) tags
          "by rank, the tag of the thing that arrived next in the same cell")
   (marks (make-octets +initial-stock-size+) octets
          "by rank, the flags that the thing causes in its cell")))

;;; Cells.

;; Inline: callers that move things call them by the thousand in a tick.
(declaim (inline visit-things-in-cell append-to-cell put-first-in-cell take-from-cell
                 cell-thing-flags))
(defun visit-things-in-cell (function index stock)
  "Call FUNCTION with each thing on the floor of the cell INDEX of STOCK, in order of arrival."
  (declare (type function function) (type cell-index index) (type stock stock))
  (loop for tag of-type tag = (aref (stock-firsts stock) index)
          then (aref (stock-nexts stock) (1- tag))
        until (zerop tag)
        do (funcall function (the thing (svref (stock-things stock) (1- tag))))))

(defun append-to-cell (rank index stock)
  "Append the thing with RANK, which is in no cell, to the things in the cell INDEX of STOCK."
  (declare (type cell-index rank index) (type stock stock))
  (let* ((firsts (stock-firsts stock)) (nexts (stock-nexts stock)) (first (aref firsts index)))
    (if (zerop first)
        (setf (aref firsts index) (1+ rank))
        (loop for tag of-type tag = first then next
              for next of-type tag = (aref nexts (1- tag))
              until (zerop next)
              finally (setf (aref nexts (1- tag)) (1+ rank))))))

(defun put-first-in-cell (rank index stock)
  "Put the thing with RANK, which is in no cell, before the things in the cell INDEX of STOCK."
  (declare (type cell-index rank index) (type stock stock))
  (setf (aref (stock-nexts stock) rank) (aref (stock-firsts stock) index)
        (aref (stock-firsts stock) index) (1+ rank)))

(defun take-from-cell (rank index stock)
  (declare (type cell-index rank index) (type stock stock))
  (let* ((firsts (stock-firsts stock)) (nexts (stock-nexts stock))
         (tag (1+ rank)) (next (shiftf (aref nexts rank) 0)))
    (if (= tag (aref firsts index))
        (setf (aref firsts index) next)
        (loop for before of-type tag = (aref firsts index) then after
              for after of-type tag = (aref nexts (1- before))
              until (= tag after)
              finally (setf (aref nexts (1- before)) next)))))

(declaim (inline alone-in-cell-p))
(defun alone-in-cell-p (rank index stock)
  (declare (type cell-index rank index) (type stock stock))
  (and (= (1+ rank) (aref (stock-firsts stock) index))
       (zerop (aref (stock-nexts stock) rank))))

(defun cell-thing-flags (index stock)
  (declare (type cell-index index) (type stock stock))
  (loop with flags of-type (unsigned-byte 8) = 0
        for tag of-type tag = (aref (stock-firsts stock) index)
          then (aref (stock-nexts stock) (1- tag))
        until (zerop tag)
        do (setf flags (logior flags (aref (stock-marks stock) (1- tag))))
        finally (return flags)))

;;; Things.

(defun enlarge-vector (vector size)
  (replace (make-array size :element-type (array-element-type vector)
                            :initial-element (if (simple-vector-p vector) nil 0))
           vector))

(defun add-to-stock (thing stock)
  "Give THING the next rank in STOCK. A full STOCK grows to twice its size."
  (when (body-p thing) (incf (stock-bodies stock)))
  (let ((rank (stock-count stock)))
    (when (= rank (length (stock-things stock)))
      (setf (stock-things stock) (enlarge-vector (stock-things stock) (* 2 rank))
            (stock-nexts stock) (enlarge-vector (stock-nexts stock) (* 2 rank))
            (stock-marks stock) (enlarge-vector (stock-marks stock) (* 2 rank))))
    (incf (stock-count stock))
    (setf (thing-rank thing) rank
          (svref (stock-things stock) rank) thing)))

;; Ranks only get smaller, from the first to the last, so an updated tag in FIRSTS is never mistaken
;; for one yet to be updated.
(defun close-rank-gaps (stock index-of)
  "Renumber the ranks in STOCK without gaps. INDEX-OF is a function that returns the cell index of a
thing on the floor, else NIL."
  (let* ((old (stock-things stock)) (nexts (stock-nexts stock)) (count (stock-count stock))
         (ranks (make-array count :initial-element nil))
         (new (make-stock)))
    (loop for rank below count
          for thing = (svref old rank)
          do (when (and thing (thing-alive-p thing))
               (add-to-stock thing new)
               (setf (svref ranks rank) (thing-rank thing))))
    (flet ((new-tag (tag) (if (zerop tag) 0 (1+ (svref ranks (1- tag))))))
      (loop for rank below count
            for thing = (svref old rank)
            for index = (and thing (thing-alive-p thing) (funcall index-of thing))
            do (when index
                 (when (= (1+ rank) (aref (stock-firsts stock) index))
                   (setf (aref (stock-firsts stock) index) (new-tag (1+ rank))))
                 (setf (aref (stock-nexts new) (thing-rank thing)) (new-tag (aref nexts rank))
                       (aref (stock-marks new) (thing-rank thing))
                       (aref (stock-marks stock) rank)))))
    (setf (stock-things stock) (stock-things new)
          (stock-nexts stock) (stock-nexts new)
          (stock-marks stock) (stock-marks new)
          (stock-count stock) (stock-count new)
          (stock-bodies stock) (stock-bodies new))))

(defun thing-rank-count (stock)
  "Return the number of ranks in STOCK, without those of bodies."
  (- (stock-count stock) (stock-bodies stock)))

;;; The contents for a digest: the things in each cell, then all things. Bodies are digested with
;;; their robots.

(defmethod digest-state ((stock stock) digest)
  (digest-add digest (length (stock-firsts stock)))
  (dotimes (index (length (stock-firsts stock)))
    (let ((things '()))
      (visit-things-in-cell (lambda (thing) (push thing things)) index stock)
      (digest-add digest (nreverse things))))
  (digest-add digest (thing-rank-count stock))
  (loop for thing across (stock-things stock) repeat (stock-count stock)
        do (unless (body-p thing) (digest-state thing digest)))
  digest)
