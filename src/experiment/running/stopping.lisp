;;;; stopping.lisp -- adding trials until intervals are narrow.

(in-package :ars-magna.experiment)

;;; Whoever looks at an interval again and again, and stops when he likes it, has more confidence
;;; than he may. So it is looked at after fixed numbers of trials only, 50, 100, 200 and so on, and
;;; the K-th look has the share 1 / (K (K + 1)) of the error that is allowed: all looks together
;;; have no more than the whole (Bonferroni's inequality; the shares add up to 1). An interval that
;;; was decided by is so the one that can be stated.

(defconstant +first-look+ 50 "After how many trials intervals are looked at first.")

(defun count-at-look (look)
  "Return after how many trials of each condition the LOOK-th look is, from 1."
  (* +first-look+ (expt 2 (1- look))))

(defun confidence-at-look (look)
  "Return the confidence of the intervals of the LOOK-th look, if that of all is to be .95."
  (- 1d0 (sequential-level look :level .05d0)))
