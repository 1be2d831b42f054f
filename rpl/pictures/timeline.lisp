;;;; timeline.lisp -- all bars of a trace in rows, with names, axis and legend, also in a file.

(in-package :ars-magna.rpl-pictures)

(export '(make-timeline-page timeline-page-scale draw-timeline-page))

;;; The parts of a task stand below it. Parts that run the same expression one after the other, as
;;; the turns of a loop do, share a row, so that a long run needs no more rows than a short one.

(defstruct (row (:constructor make-row (bars)) (:copier nil))
  "A row of a timeline: bars of the same expression that do not overlap, oldest first."
  (bars '() :type list))

(defun row-label (row &optional (indent 2) (most 24))
  "Return the text for tasks in ROW, indented by INDENT spaces per parent, by MOST spaces at most."
  (let ((more (1- (length (row-bars row)))))
    (format nil "~V@T~@[~A: ~]~A~@[ (and ~D more)~]"
            (min most (* indent (bar-depth (first (row-bars row)))))
            (bar-owner (first (row-bars row)))
            (bar-label (first (row-bars row)))
            (and (plusp more) more))))

(defun bar-fits-p (bar row)
  "True if BAR has the expression of the bars in ROW and starts when the last of them has ended."
  (let ((last (first (last (row-bars row)))))
    (and (eq (bar-form bar) (bar-form last))
         (equal (bar-owner bar) (bar-owner last))
         (<= (bar-end last) (bar-start bar)))))

(defun arrange-in-rows (bars)
  "Return the rows for BARS, which are sorted by start, without the rows for their parts."
  (let ((rows '()))
    (dolist (bar bars (nreverse rows))
      (let ((row (find-if (lambda (row) (bar-fits-p bar row)) rows)))
        (if row
            (setf (row-bars row) (append (row-bars row) (list bar)))
            (push (make-row (list bar)) rows))))))

(defun rows-of-bars (bars)
  "Return the rows for BARS and their parts, from top to bottom."
  (loop for row in (arrange-in-rows bars)
        collect row
        append (rows-of-bars (stable-sort (mapcan (lambda (bar) (copy-list (bar-parts bar)))
                                                  (row-bars row))
                                   #'< :key #'bar-serial))))

(defun draw-axis (canvas scale top bottom)
  "Draw lines from TOP to BOTTOM at round numbers of ticks, with these numbers above and below."
  (loop with step = (axis-tick-step (scale-span scale) (clamp (floor (scale-width scale) 50) 2 12))
        for tick from (* step (ceiling (scale-start scale) step)) to (scale-end scale) by step
        for x = (x-of-tick tick scale)
        for text = (princ-to-string tick)
        for left = (- x (/ (* +character-width+ (length text)) 2))
        do (with-color #xDCDCDC
             (with-lines (:style (if in-color* :solid :dash))
               (draw-line canvas draw-gcontext* x (- top 6) x (+ bottom 2))))
           (write-text-at canvas left (- top 10) text #x606060)
           (write-text-at canvas left (+ bottom 15) text #x606060)))

;;; The legend.

(defparameter *timeline-legend*
  (append (loop for (kind nil nil text) in *bar-looks* collect (list kind text))
          (loop for (outcome nil text) in *end-looks* collect (list outcome text)))
  "Lists (look text): the meaning of each colour and mark.")

(defun looks-of-bar (bar)
  (append (list (if (bar-call-p bar) :call :parts) (bar-outcome bar))
          (mapcar #'span-kind (bar-spans bar))
          (loop for span in (bar-commands bar)
                collect (if (failure-code-p (span-error span)) :trouble :command))))

(defun legend-of-rows (rows)
  (let ((drawn (loop for row in rows append (mapcan #'looks-of-bar (row-bars row)))))
    (remove-if-not (lambda (entry) (member (first entry) drawn)) *timeline-legend*)))

(defun legend-places (legend width)
  "Place the entries of LEGEND in lines of WIDTH pixels. Return two values: a list of the placed
entries (look text x y), and the height of all lines."
  (let ((x 0) (y 0))
    (values (loop for (what text) in legend
                  for wide = (+ 46 (* +character-width+ (length text)))
                  do (when (and (plusp x) (> (+ x wide) width))
                       (setf x 0)
                       (incf y +legend-line-height+))
                  collect (list what text x y)
                  do (incf x wide))
            (+ y +legend-line-height+))))

(defun draw-legend (canvas legend x y width)
  "Draw LEGEND at X, Y, WIDTH pixels wide. Return the y coordinate of its end."
  (multiple-value-bind (places height) (legend-places legend width)
    (loop for (what text right down) in places
          do (if (assoc what *bar-looks*)
                 (draw-bar-look canvas what (+ x right) (+ y down) 18 +bar-height+)
                 (draw-end-mark canvas what (+ x right 12) (+ y down)))
             (write-text-at canvas (+ x right 24) (+ y down 11) text))
    (+ y height)))

;;; The rows.

(defun row-height (row)
  "Return the height of ROW in pixels, with its lane for commands if it has commands."
  (+ +bar-height+ +row-gap+ (if (some #'bar-commands (row-bars row)) (+ 1 +lane-height+) 0)))

(defun rows-height (rows)
  (reduce #'+ (mapcar #'row-height rows)))

(defun row-label-for-width (row width)
  "Return the label of ROW, with less indentation if WIDTH, in pixels, is small."
  (if (< width 250) (row-label row 1 7) (row-label row)))

(defun labels-width (rows least most)
  (clamp (+ 24 (* +character-width+
                  (loop for row in rows maximize (length (row-label-for-width row most)))))
         least most))

(defun cut-row-label (row width)
  (cut-to-width (row-label-for-width row width) width))

(defun draw-row (canvas row y scale)
  (with-subject (canvas (first (row-bars row)))
    (write-text-at canvas 10 (+ y 11)
                   (or (cut-row-label row (max 80 (- (scale-left scale) 20))) "")))
  (dolist (bar (row-bars row)) (draw-bar canvas bar y scale))
  (draw-command-lane canvas (mapcan (lambda (bar) (copy-list (bar-commands bar))) (row-bars row))
                     (+ y +bar-height+ 1) scale)
  (dolist (bar (row-bars row))
    (draw-end-mark canvas (bar-outcome bar) (x-of-tick (bar-end bar) scale) y)))

(defun draw-rows (canvas rows scale top &key (from 0) to)
  "Draw ROWS from TOP down, except rows that end above FROM or begin below TO."
  (loop for row in rows
        for y = (+ top 2) then (+ y height)
        for height = (row-height row)
        when (and (>= (+ y height) from) (or (null to) (<= y to)))
          do (draw-row canvas row y scale)))

;;; As a page.

(define-record (page (:constructor %make-page (rows unseen start end)))
  "The contents of a timeline: ROWS of bars, from tick START to END."
  (rows '() list)
  (unseen 0 fixnum "the number of rows that were left out")
  (start 0 real "the tick with which a page begins" :export)
  (end 0 real "the tick with which a page ends" :export))

(defun sorted-by-owner (bars)
  "Return BARS, the bars of plans, so that those of a robot are together, in the order of starts."
  (loop for owner in (remove-duplicates (mapcar #'bar-owner bars) :test #'equal :from-end t)
        append (remove owner bars :key #'bar-owner :test-not #'equal)))

(defun make-timeline-page (bars most)
  "Return a page with the rows for BARS, the bars of top-level tasks, but at most MOST rows. The
plans of a robot are together."
  (let* ((all (rows-of-bars (sorted-by-owner bars))) (unseen (max 0 (- (length all) most))))
    (%make-page (subseq all 0 (- (length all) unseen)) unseen
                (reduce #'min bars :key #'bar-start) (reduce #'max bars :key #'last-tick-of-bar))))

(defun draw-omitted-rows-text (canvas page y)
  (when (plusp (page-unseen page))
    (write-text-at canvas 10 y (format nil "~D more rows are left out." (page-unseen page)))))

(defconstant +title-size+ 13 "The height of the font of the title, in pixels.")
(defconstant +title-line-height+ 17 "The distance between lines of the title, in pixels.")

(defun title-lines (canvas page title width)
  "Return TITLE, by default the range of ticks of PAGE, as lines of at most WIDTH pixels."
  (wrap-text-to-width (or title (format nil "Plans from tick ~D to ~D" (page-start page)
                                          (page-end page)))
                      width (character-width canvas +title-size+)))

(defun draw-timeline (canvas bars most &optional title)
  "Draw a timeline of BARS, the bars of top-level tasks, on CANVAS, in at most MOST rows below
TITLE. The default title is the range of ticks. Return the width and height in pixels."
  (let* ((page (make-timeline-page bars most)) (rows (page-rows page))
         (left (labels-width rows 120 +greatest-label-width+))
         (scale (make-scale (page-start page) (page-end page) left
                            (clamp (* +tick-width+ (- (page-end page) (page-start page)))
                                   +least-chart-width+ +greatest-chart-width+)))
         (width (+ left (scale-width scale) 40))
         (lines (title-lines canvas page title (- width 20)))
         (top (+ 30 (draw-legend canvas (legend-of-rows rows) 10
                                 (+ 10 (* +title-line-height+ (length lines)))
                                 (- width 10))))
         (bottom (+ top (rows-height rows))))
    (loop for line in lines for y from 16 by +title-line-height+
          do (draw-words canvas draw-gcontext* 10 y line :size +title-size+ :bold-p t))
    (draw-axis canvas scale top bottom)
    (write-text-at canvas 10 (- top 10) "ticks" #x606060)
    (draw-rows canvas rows scale top)
    (draw-omitted-rows-text canvas page (+ bottom 34))
    (values width (+ bottom 42))))

;;; In a place of any width.

(defun timeline-page-scale (page width)
  "Return the scale for PAGE in WIDTH pixels. The names of tasks take at most half."
  (let ((left (labels-width (page-rows page) 100 (max 100 (floor width 2)))))
    (make-scale (page-start page) (page-end page) left (max 60 (- width left 24)))))

(define-constant +axis-height+ 26
  :documentation "The height of the tick numbers above the rows of a page, in pixels.")

(defun draw-timeline-page (canvas page &key (width 640) (top 0) (from 0) to)
  "Draw PAGE on CANVAS, WIDTH pixels wide, from TOP down. FROM and TO, in pixels from the top, are
the visible part: other rows are not drawn, and the tick numbers stay above the visible rows. Return
the y coordinate of the end of PAGE, in pixels."
  (let* ((scale (timeline-page-scale page width))
         (first (+ top +axis-height+))
         (bottom (+ first (rows-height (page-rows page))))
         (axis (min (+ first from) bottom)))
    (draw-axis canvas scale axis bottom)
    (with-clipping (canvas 0 axis width (max 1 (- bottom axis)))
      (draw-rows canvas (page-rows page) scale first :from from :to to))
    (draw-omitted-rows-text canvas page (+ bottom 34))
    (draw-legend canvas *timeline-legend* 10 (+ bottom (if (plusp (page-unseen page)) 44 24))
                 (- width 10))))

;;; In a file.

(defun trace-bars (runner)
  "Return the bars of the trace of RUNNER. Signals MISUSE if RUNNER has no trace."
  (let ((trace (plan-trace runner)))
    (cond ((null trace)
           (reject-use "No trace was kept of these plans. Set *trace-plans* to true before ~
                        they start, or at the prompt type TRACE-PLANS ON."))
          ((bars trace (plan-runner-tick runner)))
          (t (reject-use "No plan has run here: run a plan first.")))))

(defun plan-package (bars)
  "Return the package of the first plan name in BARS, or *PACKAGE* if no plan has a name."
  (let ((name (some #'bar-name bars)))
    (or (and (symbolp name) (symbol-package name))
        *package*)))

(defun timeline-svg (bars most in-color title scale)
  (let ((*package* (plan-package bars)))
    (with-output-to-string (stream)
      (with-svg (canvas stream :color-p in-color :zoom scale)
        (with-canvas (canvas)
          (draw-timeline canvas bars most title))))))

(addition save-plan-timeline)
(define-with-keywords save-plan-timeline
    (file &key runner (most 1000) (in-color t) title (scale 1))
  "Save in FILE a timeline of the plans that have run, replacing an older file. The name ends in
.svg or, if the program rsvg-convert is installed, in .png. Each task is a bar over ticks, below the
bar of its parent task, with its waits, its commands while they were in progress, and its end.
Iterations of a loop share a row. Return the truename of FILE. Signals WRONG-ARGUMENT and MISUSE.
  RUNNER: the plan runner, by default the plan runner in use. RUNNER must have a trace: see
*TRACE-PLANS*.
  MOST: the largest number of rows to draw.
  IN-COLOR: false for black and white.
  TITLE: a string above the picture, instead of the ticks.
  SCALE: from 1 to 10, the size of everything, text included.
On a page of a paper, 174 mm wide, a picture of up to 820 pixels (some 70 ticks) is readable."
  (check-argument save-plan-timeline title (typep title '(or null string)) "a string or NIL")
  (check-argument save-plan-timeline scale (and (finite-p scale) (<= 1 scale 10))
                  "a number from 1 to 10, the magnification of the picture")
  (check-argument save-plan-timeline most (whole-p most 1 1000000) "an integer from 1 to 1000000")
  (let ((kind (picture-kind 'save-plan-timeline file))
        (bars (call-with-plans-in-use
               (lambda (in-use) (trace-bars (or runner in-use (runner-to-show)))))))
    (save-svg (timeline-svg bars most in-color title scale) file kind)))
