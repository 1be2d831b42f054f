;;;; time-series.lisp -- a quantity over time, sampled at every tick, in bounded memory.

(in-package :ars-magna.plots)

(export '(make-time-series add-sample cut-time-series last-sample time-series-ranges))

;;; A time series keeps its samples at several resolutions. Level 0 has the newest samples. Level 1
;;; has intervals of two ticks, level 2 intervals of four, and so on. A level keeps the first, the
;;; least and the greatest sample of each of its +LEVEL-SIZE+ newest intervals, so that no peak is
;;; lost. When the last level is full, another level is made, so the last level always reaches back
;;; to the beginning. A time series of a million ticks has 12 levels and 200 kB.

(defconstant +level-size+ 512 "The number of intervals that each level of a time series keeps.")

(deftype level-buffer (type) `(simple-array ,type (512)))

(defun make-level-buffer (type) (make-array +level-size+ :element-type type))

(defstruct (level (:constructor make-level (stride)) (:copier nil))
  "The newest intervals of a time series, COUNT of them. An interval has STRIDE ticks and begins at
a tick that STRIDE divides. The ring buffers begin at START. TICKS and FIRSTS are the first samples
of the intervals, LOWS and HIGHS the least and the greatest values."
  (stride 1 :type (and fixnum (integer 1)) :read-only t)
  (start 0 :type (integer 0 (512)))
  (count 0 :type (integer 0 512))
  (ticks (make-level-buffer 'fixnum) :type (level-buffer fixnum) :read-only t)
  (firsts (make-level-buffer 'double-float) :type (level-buffer double-float) :read-only t)
  (lows (make-level-buffer 'double-float) :type (level-buffer double-float) :read-only t)
  (highs (make-level-buffer 'double-float) :type (level-buffer double-float) :read-only t))

(define-record (time-series (:constructor make-time-series (name unit index
                                                                   &optional (description ""))
                          "Return a time series without samples. NAME, UNIT and DESCRIPTION are
strings. INDEX chooses its colour."))
  "The samples of a quantity over time. One thread at a time may use it."
  (name "" string "the name of the quantity" :export)
  (unit "" string "the unit of the quantity, or an empty string" :export)
  (index 0 fixnum "the number that chooses the colour of the time series" :export)
  (description "" string "what the quantity is, for the titles of charts; or an empty string")
  (levels (list (make-level 1)) list "" :writable)
  (last-tick -1 fixnum "" :writable))

(define-record (sample-range (:constructor make-sample-range (tick end first low high)))
  "The samples of a time series in an interval of ticks."
  (tick 0 fixnum "the tick of the first sample" :export)
  (end 0 fixnum "the last tick of the interval")
  (first 0d0 double-float "the first value")
  (low 0d0 double-float "the least value")
  (high 0d0 double-float "the greatest value"))

(declaim (inline level-place interval-end))
(defun level-place (level number)
  "Return the place in the buffers of LEVEL of its interval NUMBER, counted from the oldest."
  (mod (+ (level-start level) (the fixnum number)) +level-size+))

(defun interval-end (level tick)
  "Return the last tick of the interval of LEVEL that contains TICK."
  (declare (type fixnum tick))
  ;; The stride is a power of two.
  (logior tick (1- (level-stride level))))

(defun level-tick (level number) (aref (level-ticks level) (level-place level number)))
(defun level-first (level number) (aref (level-firsts level) (level-place level number)))
(defun level-low (level number) (aref (level-lows level) (level-place level number)))
(defun level-high (level number) (aref (level-highs level) (level-place level number)))
(defun level-full-p (level) (= (level-count level) +level-size+))

;;; Adding samples.

(declaim (inline begin-interval extend-interval add-to-level))
(defun begin-interval (level tick first low high)
  (declare (type level level))
  (let ((place (level-place level (level-count level))))
    (setf (aref (level-ticks level) place) tick
          (aref (level-firsts level) place) first
          (aref (level-lows level) place) low
          (aref (level-highs level) place) high)
    (if (level-full-p level)
        (setf (level-start level) (level-place level 1))
        (incf (level-count level)))))

(defun extend-interval (level place low high)
  "Add values from LOW to HIGH to the interval at PLACE. Return true if its range has changed."
  (declare (type level level) (type double-float low high))
  (let ((changed-p nil))
    (when (< low (aref (level-lows level) place))
      (setf (aref (level-lows level) place) low
            changed-p t))
    (when (> high (aref (level-highs level) place))
      (setf (aref (level-highs level) place) high
            changed-p t))
    changed-p))

(defun add-to-level (level tick first low high)
  "Add to LEVEL values from LOW to HIGH, the value FIRST at TICK. Return NIL if the newest interval
has contained them before."
  (declare #.*hot* (type level level) (type fixnum tick) (type double-float first low high))
  (let ((newest (level-place level (1- (level-count level)))))
    (cond ((and (plusp (level-count level))
                (<= tick (interval-end level (aref (level-ticks level) newest))))
           (extend-interval level newest low high))
          (t (begin-interval level tick first low high)
             t))))

(defun make-next-level (level)
  "Return a level with the samples of LEVEL in intervals of twice the length."
  (let ((next (make-level (* 2 (level-stride level)))))
    (dotimes (number (level-count level) next)
      (add-to-level next (level-tick level number) (level-first level number)
                    (level-low level number) (level-high level number)))))

(defun add-sample (series tick value)
  "Add to SERIES its VALUE, a double-float, at TICK. Earlier samples at TICK or later are removed."
  (declare #.*hot* (type (and fixnum unsigned-byte) tick) (type double-float value)
           (type time-series series))
  (when (<= tick (time-series-last-tick series)) (cut-time-series series (1- tick)))
  (setf (time-series-last-tick series) tick)
  (loop for (level . coarser) on (time-series-levels series)
        ;; If an interval has contained VALUE before, the longer intervals have, too.
        while (add-to-level level tick value value value)
        do (when (and (null coarser) (level-full-p level))
             (setf (time-series-levels series)
                   (append (time-series-levels series) (list (make-next-level level))))
             (return))))

;;; Removing samples. An interval of which only a part is removed gets its range from the next
;;; finer level. If that level does not reach back so far, only the first sample is kept, because
;;; the range may be that of removed samples.

(defun cut-newest-interval (level finer)
  "Keep in the newest interval of LEVEL its first sample and those that the level FINER has."
  (let* ((newest (1- (level-count level))) (place (level-place level newest)))
    (setf (aref (level-lows level) place) (level-first level newest)
          (aref (level-highs level) place) (level-first level newest))
    (when finer
      (loop for number from (1- (level-count finer)) downto 0
            while (>= (level-tick finer number) (level-tick level newest))
            do (extend-interval level place (level-low finer number)
                                (level-high finer number))))))

(defun cut-level (level tick finer)
  "Remove the samples of LEVEL after TICK. FINER is the next finer level, already cut, or NIL."
  (loop while (and (plusp (level-count level))
                   (> (level-tick level (1- (level-count level))) tick))
        do (decf (level-count level)))
  (when (and (plusp (level-count level))
             (> (interval-end level (level-tick level (1- (level-count level)))) tick))
    (cut-newest-interval level finer)))

(defun cut-time-series (series tick)
  "Remove the samples of SERIES after TICK."
  (when (< tick (time-series-last-tick series))
    (setf (time-series-last-tick series) tick)
    (loop for finer = nil then level
          for level in (time-series-levels series)
          do (cut-level level tick finer))))

;;; What is kept.

(defun newest-level (series)
  "Return the finest level of SERIES that has samples, or NIL. Level 0 has none if all samples that
it kept were cut off."
  (find-if #'plusp (time-series-levels series) :key #'level-count))

(defun last-sample (series)
  "Return the tick and the value of the last sample of SERIES, or NIL if SERIES has no samples."
  (let ((level (newest-level series)))
    (and level
         (let ((number (1- (level-count level))))
           (values (level-tick level number) (level-first level number))))))

(defun first-tick (series)
  "Return the tick of the first sample that SERIES keeps, or NIL."
  (let ((levels (remove 0 (time-series-levels series) :key #'level-count)))
    (and levels (loop for level in levels minimize (level-tick level 0)))))

(defun level-from (series tick)
  "Return the finest level of SERIES that reaches back to TICK, or the level that reaches farthest."
  (or (find-if (lambda (level)
                 (and (plusp (level-count level)) (<= (level-tick level 0) tick)))
               (time-series-levels series))
      (first (last (remove 0 (time-series-levels series) :key #'level-count)))))

(defun ranges-of-level (level from last-tick)
  (loop for number below (level-count level)
        for tick = (level-tick level number)
        when (>= tick from)
          collect (make-sample-range tick (min last-tick (interval-end level tick))
                                     (level-first level number) (level-low level number)
                                     (level-high level number))))

(defun time-series-ranges (series &optional (from 0))
  "Return two values: a list of the sample ranges of SERIES, the oldest first; and the number of
ticks of each. They begin at the tick FROM, or at the first sample. There are at most 513, because
older samples are kept as ranges of longer intervals. The last one is the last sample."
  (let ((first (first-tick series)))
    (if first
        (let ((level (level-from series (max from first))))
          (values (append (ranges-of-level level from (time-series-last-tick series))
                          (multiple-value-bind (tick value) (last-sample series)
                            (and (>= tick from)
                                 (> tick (level-tick level (1- (level-count level))))
                                 (list (make-sample-range tick tick value value value)))))
                  (level-stride level)))
        (values '() 1))))
