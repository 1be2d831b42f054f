;;;; time-series.lisp -- a quantity over time, sampled at every tick, in bounded memory.

(in-package :ars-magna.plots)

(export '(make-time-series add-sample cut-time-series last-sample time-series-samples))

;;; A time series keeps its samples at several resolutions. Level 0 has the newest samples, level 1
;;; those at every second tick, level 2 at every fourth, and so on. Each level keeps +LEVEL-SIZE+
;;; samples. When the last level is full, another level is made, so the last level always reaches
;;; back to the beginning. A time series of a million ticks has 12 levels and 100 kB.

(defconstant +level-size+ 512 "The number of samples that each level of a time series keeps.")

(defstruct (level (:constructor make-level (stride)) (:copier nil))
  "The newest samples of a time series at ticks that STRIDE divides, COUNT of them, in two ring
buffers that begin at START."
  (stride 1 :type (and fixnum (integer 1)) :read-only t)
  (start 0 :type (integer 0 (512)))
  (count 0 :type (integer 0 512))
  (ticks (make-array +level-size+ :element-type 'fixnum)
   :type (simple-array fixnum (512)) :read-only t)
  (values (make-array +level-size+ :element-type 'double-float)
   :type (simple-array double-float (512)) :read-only t))

(define-record (time-series (:constructor make-time-series (name unit index)
                          "Return a time series without samples. NAME and UNIT are strings. INDEX
chooses its colour."))
  "The samples of a quantity over time. One thread at a time may use it."
  (name "" string "the name of the quantity" :export)
  (unit "" string "the unit of the quantity, or an empty string" :export)
  (index 0 fixnum "the number that chooses the colour of the time series" :export)
  (levels (list (make-level 1)) list "" :writable)
  (last-tick -1 fixnum "" :writable))

(declaim (inline level-place))
(defun level-place (level number)
  "Return the place in the buffers of LEVEL of its sample NUMBER, counted from the oldest."
  (mod (+ (level-start level) (the fixnum number)) +level-size+))

(defun level-tick (level number) (aref (level-ticks level) (level-place level number)))
(defun level-value (level number) (aref (level-values level) (level-place level number)))
(defun level-full-p (level) (= (level-count level) +level-size+))

(declaim (inline add-to-level))
(defun add-to-level (level tick value)
  (declare #.*hot* (type level level) (type fixnum tick) (type double-float value))
  (let ((place (level-place level (level-count level))))
    (setf (aref (level-ticks level) place) tick
          (aref (level-values level) place) value)
    (if (level-full-p level)
        (setf (level-start level) (level-place level 1))
        (incf (level-count level)))))

(defun make-next-level (level)
  "Return a level with the samples of LEVEL at ticks that twice its stride divides."
  (let ((next (make-level (* 2 (level-stride level)))))
    (dotimes (number (level-count level) next)
      (let ((tick (level-tick level number)))
        (when (zerop (mod tick (level-stride next)))
          (add-to-level next tick (level-value level number)))))))

(defun add-sample (series tick value)
  "Add to SERIES its VALUE, a double-float, at TICK. Earlier samples at TICK or later are removed."
  (declare #.*hot* (type fixnum tick) (type time-series series))
  (when (<= tick (time-series-last-tick series)) (cut-time-series series (1- tick)))
  (setf (time-series-last-tick series) tick)
  (dolist (level (time-series-levels series))
    (declare (type level level))
    (unless (zerop (mod tick (level-stride level))) (return))
    (add-to-level level tick value)
    (when (and (level-full-p level) (eq level (first (last (time-series-levels series)))))
      (setf (time-series-levels series)
            (append (time-series-levels series) (list (make-next-level level))))
      (return))))

(defun cut-time-series (series tick)
  "Remove the samples of SERIES after TICK."
  (setf (time-series-last-tick series) (min tick (time-series-last-tick series)))
  (dolist (level (time-series-levels series))
    (loop while (and (plusp (level-count level))
                     (> (level-tick level (1- (level-count level))) tick))
          do (decf (level-count level)))))

(defun newest-level (series)
  "Return the finest level of SERIES that has samples, or NIL. Level 0 has none if all samples that
it kept were cut off."
  (find-if #'plusp (time-series-levels series) :key #'level-count))

(defun last-sample (series)
  "Return the tick and the value of the last sample of SERIES, or NIL if SERIES has no samples."
  (let ((level (newest-level series)))
    (and level
         (let ((number (1- (level-count level))))
           (values (level-tick level number) (level-value level number))))))

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

(defun time-series-samples (series &optional (from 0))
  "Return two values: a list of samples (tick . value) of SERIES, the oldest first; and the number
of ticks between two samples. The samples begin at the tick FROM, or at the first sample. There are
at most 513, because older samples are kept at longer intervals."
  (let ((first (first-tick series)))
    (if first
        (let ((level (level-from series (max from first))))
          (values (append (loop for number below (level-count level)
                                for tick = (level-tick level number)
                                when (>= tick from)
                                  collect (cons tick (level-value level number)))
                          (multiple-value-bind (tick value) (last-sample series)
                            (and (>= tick from)
                                 (> tick (level-tick level (1- (level-count level))))
                                 (list (cons tick value)))))
                  (level-stride level)))
        (values '() 1))))
