;;;; timeline.lisp -- all bars of a trace, with their names, an axis and a legend.

(in-package :ars-magna.rpl-pictures)

(defun draw-axis (canvas scale top bottom)
  "Draw lines at round ticks from TOP down to BOTTOM, and the numbers of these above and below."
  (loop with step = (nice-step (scale-span scale) (clamp (floor (scale-width scale) 50) 2 12))
        for tick from (* step (ceiling (scale-start scale) step)) to (scale-end scale) by step
        for x = (place tick scale)
        for text = (princ-to-string tick)
        for left = (- x (/ (* +character-width+ (length text)) 2))
        do (with-color #xDCDCDC
             (with-lines (:style (if in-color* :solid :dash))
               (draw-line canvas draw-gcontext* x (- top 6) x (+ bottom 2))))
           (write-at canvas left (- top 10) text #x606060)
           (write-at canvas left (+ bottom 15) text #x606060)))

;;; The legend.

(defun draw-legend (canvas &key (x 10) (y 27) width)
  "Draw what colors and marks mean, from X, Y on, in as many lines as it takes if it is to be WIDTH
pixels wide. Return where it ends: how far to the right, and how far down."
  (let ((left x))
    (flet ((entry (text painter)
             (let ((end (+ x 46 (* +character-width+ (length text)))))
               (when (and width (> end width) (> x left))
                 (setf end (+ left (- end x)) x left)
                 (incf y 18))
               (funcall painter x y)
               (write-at canvas (+ x 24) (+ y 11) text)
               (setf x end))))
      (loop for (kind nil nil text) in *looks*
            do (let ((kind kind))
                 (entry text (lambda (x y) (look-box canvas kind x y 18 +bar-height+)))))
      (loop for (outcome nil text) in *end-looks*
            do (entry text (lambda (x y) (draw-mark canvas outcome (+ x 12) y)))))
    (values x (+ y 18))))

;;; The rows.

(defun row-height (row)
  "Return how high ROW is, in pixels: with a lane for commands, if there are any."
  (+ +bar-height+ +gap+ (if (some #'bar-commands (row-bars row)) (+ 1 +lane-height+) 0)))

(defun rows-height (rows)
  (reduce #'+ (mapcar #'row-height rows)))

(defun name-to-fit (row width)
  "Return what ROW is called; where WIDTH, in pixels, is little, little of it says how deep it is."
  (if (< width 250) (row-label row 1 7) (row-label row)))

(defun labels-width (rows least most)
  "Return how wide the column with the names of ROWS is, in pixels: as they need, from LEAST to
MOST."
  (clamp (+ 24 (* +character-width+
                  (loop for row in rows maximize (length (name-to-fit row most)))))
         least most))

(defun row-name (row width)
  "Return what ROW is called, as far as WIDTH pixels have room for it."
  (fitted (name-to-fit row width) width))

(defun draw-row (canvas row y scale)
  "Draw ROW with its upper edge at Y, its name left of SCALE."
  (with-subject (canvas (first (row-bars row)))
    (write-at canvas 10 (+ y 11) (or (row-name row (max 80 (- (scale-left scale) 20))) "")))
  (dolist (bar (row-bars row)) (draw-bar canvas bar y scale))
  (draw-lane canvas (mapcan (lambda (bar) (copy-list (bar-commands bar))) (row-bars row))
             (+ y +bar-height+ 1) scale)
  (dolist (bar (row-bars row))
    (draw-mark canvas (bar-outcome bar) (place (bar-end bar) scale) y)))

(defun draw-rows (canvas rows scale top &key (from 0) to)
  "Draw ROWS from TOP down, but for those that end above FROM or begin below TO."
  (loop for row in rows
        for y = (+ top 2) then (+ y height)
        for height = (row-height row)
        when (and (>= (+ y height) from) (or (null to) (<= y to)))
          do (draw-row canvas row y scale)))

;;; As a page.

(defstruct (page (:constructor %make-page (rows unseen start end)) (:copier nil))
  "ROWS to be drawn from tick START to END; UNSEEN is how many more there would be."
  (rows '() :type list :read-only t)
  (unseen 0 :type fixnum :read-only t)
  (start 0 :type real :read-only t)
  (end 0 :type real :read-only t))

(document-functions
  page-start "Return the tick with which a page begins."
  page-end "Return the tick with which a page ends.")

(defun make-page (bars most)
  "Return a page of BARS, of top-level tasks, with at most MOST rows."
  (let* ((all (rows bars)) (unseen (max 0 (- (length all) most))))
    (%make-page (subseq all 0 (- (length all) unseen)) unseen
                (reduce #'min bars :key #'bar-start) (reduce #'max bars :key #'last-tick))))

(defun draw-unseen (canvas page y)
  (when (plusp (page-unseen page))
    (write-at canvas 10 y (format nil "~D more rows are left out." (page-unseen page)))))

(defun draw-timeline (canvas bars most &optional title)
  "Draw BARS, of top-level tasks, on CANVAS, in at most MOST rows, below TITLE or, if it is NIL,
from when to when they are. Return width and height in pixels."
  (let* ((page (make-page bars most))
         (left (labels-width (page-rows page) 120 +label-width+))
         (scale (make-scale (page-start page) (page-end page) left))
         (bottom (+ +top+ (rows-height (page-rows page)))))
    (write-at canvas 10 16 (or title (format nil "Plans from tick ~A to ~A" (page-start page)
                                             (page-end page))))
    (draw-axis canvas scale +top+ bottom)
    (draw-rows canvas (page-rows page) scale +top+)
    (draw-unseen canvas page (+ bottom 34))
    (values (max (draw-legend canvas) (+ left +chart-width+ 40)) (+ bottom 42))))

;;; In a place of any width.

(defun scale-for (page width)
  "Return the scale of PAGE in a place WIDTH pixels wide: of it the names have what they need, up to
half."
  (let ((left (labels-width (page-rows page) 100 (max 100 (floor width 2)))))
    (make-scale (page-start page) (page-end page) left (max 60 (- width left 24)))))

(define-constant +axis-height+ 26
  :documentation "How high the numbers above the rows of a page are, in pixels.")

(defun draw-page (canvas page &key (width 640) (top 0) (from 0) to)
  "Draw PAGE on CANVAS, WIDTH pixels wide, from TOP down. Of its rows only those between FROM and
TO, in pixels from the top, need be seen; the numbers of ticks are above them as long as any is.
Return where it ends, in pixels."
  (let* ((scale (scale-for page width))
         (first (+ top +axis-height+))
         (bottom (+ first (rows-height (page-rows page))))
         (axis (min (+ first from) bottom)))
    (draw-axis canvas scale axis bottom)
    (with-clipping (canvas 0 axis width (max 1 (- bottom axis)))
      (draw-rows canvas (page-rows page) scale first :from from :to to))
    (draw-unseen canvas page (+ bottom 34))
    (nth-value 1 (draw-legend canvas :y (+ bottom (if (plusp (page-unseen page)) 44 24))
                                     :width width))))
