;;;; means.lisp -- how large a mean or a median is, of which a sample was seen.

(in-package :ars-magna.statistics)

(defun student-bounds (sample confidence)
  (let ((size (length (the doubles sample))))
    (if (< size 2)
        (values nil nil)
        (let ((mean (mean-of sample))
              (reach (* (student-reach confidence (double (1- size)))
                        (deviation-of sample size))))
          (values (- mean reach) (+ mean reach))))))

(addition student-interval)
(defun student-interval (numbers &key (confidence .95d0))
  "Return the bounds, low and high, of the interval for the mean of what NUMBERS, a list or vector,
are a sample of (Student 1908). It holds the true mean as often as CONFIDENCE says if that is
normal. Of skewed numbers it holds it less often: of exponential ones, with .95, in 89 of 100
samples of 5, 93 of 30, and 94 of 50. BOOTSTRAP-INTERVAL is no better there. Of numbers that are all
equal, both bounds are that number; of fewer than two, both are NIL. Signals WRONG-ARGUMENT unless
NUMBERS are from -1e15 to 1e15, and CONFIDENCE between 0 and 1."
  (let ((confidence (check-share student-interval confidence)))
    (student-bounds (sample 'student-interval 'numbers numbers) confidence)))

(defun check-pairs (operator name seconds firsts)
  "Signal WRONG-ARGUMENT unless there are as many SECONDS, its argument NAME, as FIRSTS."
  (unless (= (length firsts) (length seconds))
    (reject-argument operator name seconds
                     (format nil "one for each of the first, which are ~D" (length firsts)))))

(addition mean-difference-interval)
(defun mean-difference-interval (firsts seconds &key (confidence .95d0))
  "Return the bounds, low and high, of the interval for the mean of FIRSTS less that of SECONDS,
lists or vectors of numbers that belong together one by one, such as what two plans took with the
same seeds: STUDENT-INTERVAL of the differences (Student 1908). Both are NIL of fewer than two
pairs. Signals WRONG-ARGUMENT as that does, and if the two are not equally many."
  (let ((confidence (check-share mean-difference-interval confidence))
        (firsts (sample 'mean-difference-interval 'firsts firsts))
        (others (sample 'mean-difference-interval 'seconds seconds)))
    (check-pairs 'mean-difference-interval 'seconds seconds firsts)
    (student-bounds (map 'doubles #'- firsts others) confidence)))

(defun outer-rank (size tail)
  "Return the largest rank that the median of what SIZE numbers are a sample of is below with a
probability of TAIL at most, or 0."
  (let ((low 0) (high size))
    (loop while (< (1+ low) high)
          do (let ((rank (floor (+ low high) 2)))
               (if (<= (half-or-fewer (1- rank) size) tail)
                   (setf low rank)
                   (setf high rank))))
    low))

(addition median-interval)
(defun median-interval (numbers &key (confidence .95d0))
  "Return the bounds, low and high, of the interval for the median of what NUMBERS, a list or
vector, are a sample of, whatever its distribution, and how often such an interval holds it,
CONFIDENCE or more: the two of NUMBERS that are so far in from the ends as that allows (David and
Nagaraja 2003, Order Statistics, 7.1). All three are NIL if NUMBERS are too few, for .95 fewer than
six. Signals WRONG-ARGUMENT unless they are from -1e15 to 1e15, and CONFIDENCE between 0 and 1."
  (let* ((confidence (check-share median-interval confidence))
         (sample (sorted (sample 'median-interval 'numbers numbers)))
         (size (length sample))
         (rank (outer-rank size (/ (- 1 confidence) 2))))
    (if (zerop rank)
        (values nil nil nil)
        (values (aref sample (1- rank)) (aref sample (- size rank))
                (- 1 (* 2 (half-or-fewer (1- rank) size)))))))
