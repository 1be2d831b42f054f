;;;; labels.lisp -- an axis of words.

(in-package :ars-magna.plots)

;;; The words stand below their places, in up to three lines, if none need be broken for that; else
;;; they run upward, and if there are too many for the page, it becomes wider.

(defconstant +longest-upward+ 170 "How long a line of a name that runs upward is, in pixels.")

(defun across-lines (words width)
  "Return the lines of each of WORDS within WIDTH pixels, or NIL if they don't fit in three."
  (let ((all (mapcar (lambda (word) (wrapped word width)) words)))
    (and (every (lambda (word lines)
                  (and (<= (length lines) 3)
                       (every (lambda (piece) (<= (text-width piece +text-size+) width))
                              (split word #'space-p))))
                words all)
         all)))

(defun word-axis (words from to)
  "Return an axis with a mark for each of WORDS: 0, 1, 2 .... It may reach beyond the pixel TO."
  (let* ((count (max 1 (length words)))
         (across (across-lines words (- (/ (- to from) count) 8)))
         (all (or across (mapcar (lambda (word) (wrapped word +longest-upward+)) words)))
         (least (if across 0 (+ 1 (reduce #'max all :key #'lines-height :initial-value 0)))))
    (make-axis :low -1/2 :high (- count 1/2) :from from :to (max to (+ from (* count least)))
               :marks (loop for lines in all for number from 0 collect (cons number lines))
               :upward-p (null across))))

(defun marks-height (axis)
  "Return how much room the marks of AXIS take below it, in pixels."
  (+ 8 (if (axis-upward-p axis)
           (marks-width axis)
           (reduce #'max (axis-marks axis) :key (lambda (mark) (lines-height (rest mark)))
                                           :initial-value 0))))

(defun draw-marks-across (canvas axis y)
  "Draw the marks of AXIS, which runs across at Y, and what they say."
  (loop for (value . lines) in (axis-marks axis)
        for x = (place value axis)
        do (with-ink (+line-ink+)
             (draw-line canvas draw-gcontext* x y x (+ y 4)))
           (if (axis-upward-p axis)
               (write-lines-upward canvas x (+ y 8) lines)
               (write-lines canvas x (+ y 17) lines :anchor :middle))))
