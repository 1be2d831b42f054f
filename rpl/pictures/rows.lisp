;;;; rows.lisp -- which bars of a timeline share a row, and in which order the rows stand.

(in-package :ars-magna.rpl-pictures)

;;; The parts of a task stand below it. Parts that run the same expression one after the other, as
;;; the turns of a loop do, share a row, so that a long run needs no more rows than a short one.

(defstruct (row (:constructor make-row (bars)) (:copier nil))
  "Bars of one expression that do not overlap, oldest first."
  (bars '() :type list))

(defun row-label (row &optional (indent 2) (most 24))
  "Return which tasks are in ROW, indented by how deep they are: each time by INDENT, by MOST in
all."
  (let ((more (1- (length (row-bars row)))))
    (format nil "~V@T~A~@[ (and ~D more)~]" (min most (* indent (bar-depth (first (row-bars row)))))
            (bar-label (first (row-bars row)))
            (and (plusp more) more))))

(defun fits-p (bar row)
  "True if BAR can stand in ROW, after the last one there."
  (let ((last (first (last (row-bars row)))))
    (and (eq (bar-form bar) (bar-form last)) (<= (bar-end last) (bar-start bar)))))

(defun lanes (bars)
  "Return rows for BARS, parts of one row, in order of start."
  (let ((rows '()))
    (dolist (bar bars (nreverse rows))
      (let ((row (find-if (lambda (row) (fits-p bar row)) rows)))
        (if row
            (setf (row-bars row) (append (row-bars row) (list bar)))
            (push (make-row (list bar)) rows))))))

(defun rows (bars)
  "Return the rows for BARS and their parts, from top to bottom."
  (loop for row in (lanes bars)
        collect row
        append (rows (stable-sort (mapcan (lambda (bar) (copy-list (bar-parts bar))) (row-bars row))
                           #'< :key #'bar-serial))))
