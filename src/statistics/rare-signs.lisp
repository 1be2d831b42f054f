;;;; rare-signs.lisp -- how probable sums of thrown signs are that hardly any draw would reach.

(in-package :ars-magna.statistics)

;;; Draws of fair signs never say less than 1 / (draws + 1), which is too much where a test is one
;;; of hundreds. So signs are drawn that are tilted towards the sum that was seen: a number A is
;;; positive with the odds e^(2 A tilt), such that this sum is the mean. A draw then counts by its
;;; weight, how much less likely it is with fair signs: e^(log cosh (A tilt) summed - tilt * sum).
;;; In the tail that is never more than Chernoff's bound, so the share is known to a few per cent,
;;; however small. What was seen counts as one of the draws (Harrison 2012, "Conservative
;;; hypothesis tests and confidence intervals using importance sampling").

(defun minus-share (x)
  "Return how likely a number with the odds e^(2X) of being positive is negative; X is not below 0."
  (declare (type double-float x))
  (let ((odds (exponential (* -2 (min x 300d0)))))
    (/ odds (+ 1 odds))))

(defun tilted-mean (sizes tilt)
  "Return the mean of the sum of SIZES with signs that are drawn with TILT."
  (declare (type doubles sizes) (type double-float tilt))
  (loop for size across sizes
        sum (* size (- 1 (* 2 (minus-share (* size tilt))))) of-type double-float))

(defun tilt-for (sizes sum)
  "Return the tilt with which the sum of SIZES, the largest of which is 1, is SUM on average."
  (declare (type doubles sizes) (type double-float sum))
  (let ((low 0d0) (high (/ 20 (max 1d-4 (reduce #'min sizes)))))
    (loop repeat 40
          for middle of-type double-float = (/ (+ low high) 2)
          do (if (< (tilted-mean sizes middle) sum) (setf low middle) (setf high middle)))
    low))

(defun log-of-cosh (x)
  (declare (type double-float x))
  (- x (logarithm (* 2 (- 1 (minus-share x))))))

(defun tilted-sum (sizes shares dice)
  "Return the sum of SIZES, each negative with its probability among SHARES."
  (declare (type doubles sizes shares) (type dice dice) #.*hot*)
  (loop with sum of-type double-float = 0d0
        for size across sizes
        for share across shares
        do (incf sum (if (< (roll dice) share) (- size) size))
        finally (return sum)))

(defun tail-share (sizes sum grain resamples dice)
  "Return how likely SIZES, at most 1, with signs thrown by a coin, sum up to SUM or more either
way, by RESAMPLES tilted draws."
  (let* ((tilt (tilt-for sizes sum))
         (shares (map 'doubles (lambda (size) (minus-share (* size tilt))) sizes))
         (logs (loop for size across sizes sum (log-of-cosh (* size tilt)))))
    (flet ((weight (sum) (exponential (max -700d0 (- logs (* tilt sum))))))
      (/ (loop with weights = (weight sum)
               repeat resamples
               for drawn = (tilted-sum sizes shares dice)
               when (>= drawn (- sum grain)) do (incf weights (weight drawn))
               finally (return (* 2 weights)))
         (1+ resamples)))))

(defun rare-share (sizes sum grain resamples dice)
  "Return how likely numbers of SIZES, with signs thrown by a coin, sum up to SUM or more either
way, if that is seldom."
  (let ((largest (reduce #'max sizes)))
    (min 1d0 (tail-share (map 'doubles (lambda (size) (/ size largest)) sizes)
                         (/ sum largest) (/ grain largest) resamples dice))))
