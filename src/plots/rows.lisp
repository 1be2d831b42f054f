;;;; rows.lisp -- a page of rows, with words on both sides and numbers along one axis between them.

(in-package :ars-magna.plots)

(defstruct (row (:constructor make-row (label words height)) (:copier nil))
  "Lines of text to the left and to the right. TOP and HEIGHT are pixels."
  (label '() :type list :read-only t)
  (words '() :type list :read-only t)
  (height 0 :read-only t)
  (top 0))

(defun row-middle (row) (+ (row-top row) (/ (row-height row) 2)))

(defun plan-row (label words width least)
  "Return a row at least LEAST pixels high on a page of WIDTH. WORDS is a list of strings."
  (let ((label (wrapped label (* 32/100 width)))
        (words (loop for text in words append (wrapped text (* 34/100 width)))))
    (make-row label words
              (+ 8 (max least (lines-height label) (lines-height words))))))

(defstruct (table (:copier nil))
  "A page of rows. ACROSS is the axis; LEFT to BOTTOM is where the numbers are, in pixels."
  heading across rows x-lines (left 0) (right 0) (top 0) (bottom 0) (width 0) (height 0))

(defun stack-rows (rows top)
  "Put ROWS below each other from TOP. Return where they end."
  (dolist (row rows top)
    (setf (row-top row) top)
    (incf top (row-height row))))

(defun plan-table (entries values &key title subtitle x-label (width 720) (least 14) log-x percent)
  "Return a table of ENTRIES, lists (label text...), with an axis for VALUES. Each row is at least
LEAST pixels high. The page becomes wider than WIDTH if it must."
  (check-size width 440)
  (flet ((widest (reader rows)
           (reduce #'max rows :initial-value 0
                              :key (lambda (row) (lines-width (funcall reader row))))))
    (let* ((heading (plan-heading title subtitle width))
           (rows (loop for (label . words) in entries
                       collect (plan-row label words width least)))
           (left (+ +margin+ (widest #'row-label rows) 12))
           (words-width (widest #'row-words rows))
           (right (max (+ left +least-width+)
                       (- width +margin+ (if (plusp words-width) (+ 14 words-width) 16))))
           (across (axis-across values left right log-x :percent percent))
           (top (+ (heading-bottom heading) 12))
           (bottom (+ 4 (stack-rows rows (+ top 4))))
           (bottom (if rows bottom (+ top 60)))
           (x-lines (wrapped x-label (- right left))))
      (make-table :heading heading :across across :rows rows :x-lines x-lines
                  :left left :right right :top top :bottom bottom
                  :width (ceiling (+ right (max 16 (+ 14 words-width)) +margin+))
                  :height (ceiling (+ bottom (marks-height across) 6 (lines-height x-lines)
                                      +margin+))))))

(defun write-beside (canvas x row lines anchor)
  "Write LINES at X beside ROW, around its middle."
  (write-lines canvas x (+ 12 (- (row-middle row) (/ (lines-height lines) 2))) lines
               :anchor anchor))

(defun draw-table (canvas table draw-row)
  "Draw TABLE; call DRAW-ROW with each row and its number to draw the numbers."
  (let ((left (table-left table)) (right (table-right table)) (top (table-top table))
        (bottom (table-bottom table)) (across (table-across table)))
    (draw-heading canvas (table-heading table))
    (with-ink (+grid-ink+)
      (loop for (value) in (axis-marks across)
            for x = (place value across)
            do (draw-line canvas draw-gcontext* x top x bottom)))
    (with-ink (+line-ink+ 1.2)
      (draw-line canvas draw-gcontext* left bottom right bottom))
    (draw-marks-across canvas across bottom)
    (write-lines canvas (/ (+ left right) 2) (+ bottom (marks-height across) 15)
                 (table-x-lines table) :anchor :middle)
    (loop for row in (table-rows table)
          for number from 0
          do (write-beside canvas (- left 12) row (row-label row) :end)
             (write-beside canvas (+ right 14) row (row-words row) :start)
             (funcall draw-row row number))
    (unless (table-rows table)
      (draw-no-data canvas left top right bottom))))

(defun table-svg (table draw-row)
  "Return TABLE as an SVG document. DRAW-ROW is called with a canvas, each row and its number."
  (page-svg (lambda (canvas)
              (draw-table canvas table
                          (lambda (row number) (funcall draw-row canvas row number))))
            (table-width table) (table-height table)))
