;;;; timeline.lisp -- all bars of a trace, with their names, an axis and a legend.

(in-package :ars-magna.rpl-pictures)

(defun draw-axis (canvas scale bottom)
  "Draw lines at round ticks down to BOTTOM, and the numbers of these above and below."
  (loop with step = (nice-step (scale-span scale))
        for tick from (* step (ceiling (scale-start scale) step)) to (scale-end scale) by step
        for x = (place tick scale)
        for text = (princ-to-string tick)
        for left = (- x (/ (* +character-width+ (length text)) 2))
        do (with-color #xDCDCDC
             (draw-line canvas draw-gcontext* x (- +top+ 6) x (+ bottom 2)))
           (write-at canvas left (- +top+ 10) text #x606060)
           (write-at canvas left (+ bottom 15) text #x606060)))

;;; The legend.

(defun draw-entry (canvas x text painter)
  "Write TEXT into the legend after what PAINTER paints at X. Return where the next entry goes."
  (funcall painter x)
  (write-at canvas (+ x 24) 38 text)
  (+ x 46 (* +character-width+ (length text))))

(defun draw-legend (canvas)
  "Draw what colors and marks mean. Return how wide that is, in pixels."
  (let ((x 10))
    (loop for (kind color text) in *looks*
          for low = (member kind '(:command :trouble))
          do (setf x (draw-entry canvas x text
                                 (lambda (x)
                                   (box canvas color x (if low 33 27) 18 (if low 4 14))))))
    (loop for (outcome nil text) in *end-looks*
          do (setf x (draw-entry canvas x text
                                 (lambda (x) (draw-mark canvas outcome (+ x 12) 27)))))
    x))

;;; The whole.

(defun draw-rows (canvas rows scale)
  (loop for row in rows
        for y from (+ +top+ 2) by +row-height+
        do (write-at canvas 10 (+ y 11)
                     (fitted (row-label row) (- +label-width+ 20)))
           (dolist (bar (row-bars row)) (draw-bar canvas bar y scale))
           (dolist (bar (row-bars row))
             (draw-mark canvas (bar-outcome bar) (place (bar-end bar) scale) y))))

(defun draw-timeline (canvas bars most)
  "Draw BARS, of top-level tasks, on CANVAS, in at most MOST rows. Return width and height in
pixels."
  (let* ((all (rows bars))
         (rows (subseq all 0 (min most (length all))))
         (scale (make-scale (reduce #'min bars :key #'bar-start)
                            (reduce #'max bars :key #'last-tick)))
         (bottom (+ +top+ (* +row-height+ (length rows)))))
    (write-at canvas 10 16 (format nil "Plans from tick ~A to ~A" (scale-start scale)
                                   (scale-end scale)))
    (draw-axis canvas scale bottom)
    (draw-rows canvas rows scale)
    (when (< most (length all))
      (write-at canvas 10 (+ bottom 34)
                (format nil "~D more rows are left out." (- (length all) most))))
    (values (max (draw-legend canvas) (+ +label-width+ +chart-width+ 40)) (+ bottom 42))))
