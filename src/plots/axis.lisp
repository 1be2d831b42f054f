;;;; axis.lisp -- axes: from numbers or words to pixels, with marks.

(in-package :ars-magna.plots)

(defstruct (axis (:copier nil))
  "An axis from the number LOW to HIGH, between the pixels FROM and TO. If LOG-P, LOW and HIGH are
logarithms. MARKS are lists (value line...) with lines of text, vertical if UPWARD-P."
  (low 0 :type real)
  (high 1 :type real)
  (from 0 :type real)
  (to 1 :type real)
  (log-p nil :type boolean)
  (marks '() :type list)
  (upward-p nil :type boolean))

(defun value-or-logarithm (value log-p)
  "Return VALUE or, if LOG-P, its decimal logarithm. Signals WRONG-ARGUMENT if VALUE has none."
  (cond ((not log-p) value)
        (t (check-argument chart value (plusp value)
                           "a number above 0 on a log axis; omit :log-x or give it as a string")
           (let ((power (decimal-exponent value)))
             (+ power (rational (/ (logarithm (/ value (expt 10 power))) (logarithm 10))))))))

(defun antilogarithm (logarithm)
  "Return approximately the number whose logarithm to base 10 is LOGARITHM."
  (multiple-value-bind (power rest) (floor logarithm)
    (* (expt 10 power) (rational (power 10 rest)))))

(defun axis-pixel (value axis)
  (let ((low (axis-low axis)))
    (+ (axis-from axis)
       (* (- (axis-to axis) (axis-from axis))
          (/ (- (value-or-logarithm value (axis-log-p axis)) low) (- (axis-high axis) low))))))

;;; Limits.

(defun value-range (values &optional (least-mark-step 0))
  "Return the least and the greatest of VALUES, or 0 and 1 if VALUES is empty. If both would be
equal, the limits are at least LEAST-MARK-STEP farther out on each side."
  (let ((low (if values (reduce #'min values) 0))
        (high (if values (reduce #'max values) 1)))
    (cond ((< low high) (values low high))
          ((zerop low) (values 0 1))
          (t (let ((more (max least-mark-step (/ (abs low) 10))))
               (values (- low more) (+ high more)))))))

(defun least-mark-step (values percent)
  "Return the least step between marks for VALUES: 1 for integers not shown as PERCENT; else 0."
  (if (and (not percent) (every #'integerp values)) 1 0))

(defun padded-range (low high from to inset)
  "Return the numbers at the ends of an axis between the pixels FROM and TO. LOW and HIGH are INSET
pixels from the ends of this axis. An INSET above a sixth of the axis counts as a sixth."
  (let* ((span (rational (- to from)))
         (inset (min (rational inset) (/ span 6)))
         (margin (* (- high low) (/ inset (- span (* 2 inset))))))
    (values (- low margin) (+ high margin))))

;;; Do the marks fit?

(defun mark-width (mark) (text-lines-width (rest mark)))

(defun marks-width (axis)
  (reduce #'max (axis-marks axis) :key #'mark-width :initial-value 0))

(defun marks-fit-p (axis least)
  "True if the mark texts of AXIS do not overlap. Each text counts as at least LEAST pixels wide."
  (loop for (mark next) on (axis-marks axis)
        while next
        always (<= (+ 12 (/ (+ (max least (mark-width mark)) (max least (mark-width next))) 2))
                   (- (axis-pixel (first next) axis) (axis-pixel (first mark) axis)))))

(defun choose-fitting-marks (axis candidates least)
  "Give AXIS the first list of marks in CANDIDATES whose texts fit. A list of a single mark, which
does not show the scale, is used only if no candidate has two marks."
  (loop for (marks . more) on (or (remove-if-not #'rest candidates) candidates)
        do (setf (axis-marks axis) marks)
        until (or (null more) (marks-fit-p axis least)))
  axis)

;;; Axes across.

(defun linear-mark-candidates (low high start end percent &optional (least-mark-step 0))
  "Return several lists of possible marks between START and END, the longest list first. The marks
of a list are at least LEAST-MARK-STEP apart, and at most 10 of them are between LOW and HIGH."
  (loop for most in '(10 8 6 5 4 3 2 1)
        for step = (max least-mark-step (choose-round-step (- high low) most))
        collect (step-marks step start end percent)))

(defun decade-marks (low high factors every)
  "Return marks at FACTORS times each 10^n for which EVERY divides n. LOW, HIGH are logarithms."
  (loop for power from (floor low) to (ceiling high)
        when (zerop (mod power every))
          append (loop for factor in factors
                       for value = (* factor (expt 10 power))
                       when (<= low (value-or-logarithm value t) high)
                         collect (list value (significant-digits-text value 4)))))

(defun logarithmic-mark-candidates (low high percent)
  "Return several lists of possible marks of a logarithmic axis from LOW to HIGH, which are
logarithms. The longest list comes first."
  (if (< (- high low) 1)
      (let ((least (antilogarithm low)) (most (antilogarithm high)))
        (linear-mark-candidates least most least most percent))
      (loop for (every . factors) in '((1 1 2 3 4 5 6 7 8 9) (1 1 2 5) (1 1 3) (1 1) (2 1) (3 1)
                                       (5 1) (10 1) (50 1) (200 1))
            collect (decade-marks low high factors every))))

(defun numeric-x-axis (values from to log-p &key percent (least 0) (inset 16))
  "Return an axis for VALUES from the pixel FROM to TO, logarithmic if LOG-P. It has as many marks
as fit, each at least LEAST pixels wide. The extremes of VALUES are INSET pixels from the ends."
  (let ((least-mark-step (if log-p 0 (least-mark-step values percent)))
        (spots (if log-p
                   (mapcar (lambda (value) (value-or-logarithm value t)) (or values '(1 10)))
                   values)))
    (multiple-value-bind (low high) (value-range spots least-mark-step)
      (multiple-value-bind (start end) (padded-range low high from to inset)
        (choose-fitting-marks (make-axis :low start :high end :from from :to to
                                         :log-p (and log-p t))
                   (if log-p
                       (logarithmic-mark-candidates start end percent)
                       (linear-mark-candidates low high low high percent least-mark-step))
                   least)))))

;;; The axis upward. Its ends are marks.

(defun numeric-y-axis (values percent range &optional (most 6))
  "Return a vertical axis for VALUES and the numbers of RANGE, without its position on the page. At
most about MOST steps separate its marks."
  (multiple-value-bind (low high) (value-range (append range values))
    (let* ((low (if (<= 0 low (/ high 2)) 0 low))
           ;; 0 and 1 can be counts or shares.
           (least-mark-step (if (<= high 1) 0 (least-mark-step values percent)))
           (step (max least-mark-step (choose-round-step (- high low) most)))
           (low (multiple-below step low))
           (high (multiple-above step high)))
      (make-axis :low low :high high :marks (step-marks step low high percent)))))

;;;; An axis of words

;;; The words are below their places, in up to three lines, if none must be broken for that.
;;; Otherwise they run upward. If there are too many for the page, it becomes wider.

(defconstant +longest-vertical-text+ 170
  "The greatest length of a line of vertical text, in pixels.")

(defun horizontal-label-lines (words width)
  "Return a list with the lines of text of each of WORDS, wrapped at WIDTH pixels. Return NIL if one
of WORDS needs more than three lines or must be broken inside."
  (let ((all (mapcar (lambda (word) (wrap-text word width)) words)))
    (and (every (lambda (word lines)
                  (and (<= (length lines) 3)
                       (every (lambda (piece) (<= (text-width piece +text-size+) width))
                              (split-text word #'space-p))))
                words all)
         all)))

(defun word-x-axis (words from to)
  "Return an axis with a mark for each of WORDS, at 0, 1, 2 and so on. The axis begins at the pixel
FROM and may reach beyond the pixel TO."
  (let* ((count (max 1 (length words)))
         (across (horizontal-label-lines words (- (/ (- to from) count) 8)))
         (all (or across (mapcar (lambda (word) (wrap-text word +longest-vertical-text+)) words)))
         (least (if across 0 (+ 1 (reduce #'max all :key #'text-lines-height :initial-value 0)))))
    (make-axis :low -1/2 :high (- count 1/2) :from from :to (max to (+ from (* count least)))
               :marks (loop for lines in all for number from 0 collect (cons number lines))
               :upward-p (null across))))

(defun marks-height (axis)
  (+ 8 (if (axis-upward-p axis)
           (marks-width axis)
           (reduce #'max (axis-marks axis) :key (lambda (mark) (text-lines-height (rest mark)))
                                           :initial-value 0))))

(defun draw-x-axis-marks (canvas axis y)
  (loop for (value . lines) in (axis-marks axis)
        for x = (axis-pixel value axis)
        do (with-ink (+axis-color+)
             (draw-line canvas draw-gcontext* x y x (+ y 4)))
           (if (axis-upward-p axis)
               (draw-vertical-text-lines canvas x (+ y 8) lines)
               (draw-text-lines canvas x (+ y 17) lines :anchor :middle))))
