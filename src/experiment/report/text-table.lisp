;;;; text-table.lisp -- tables of text: columns side by side, in blocks that fit the page.

(in-package :ars-magna.experiment)

(export '(call-with-page-width))

(defconstant +page-width+ 100
  "The most characters of a line.")

(defvar *page-width* +page-width+ "The most characters of a line now, as in a narrower window.")

(defun call-with-page-width (function &optional (width +page-width+))
  "Call FUNCTION, which writes tables, with pages of WIDTH characters, from 60 to +PAGE-WIDTH+."
  (let ((*page-width* (max 60 (min width +page-width+))))
    (funcall function)))

;;; Lines.

(defun no-break-text (text)
  "Return TEXT with no-break spaces, so that it is not wrapped unless it is longer than a line."
  (substitute #\No-break_space #\Space (coerce text '(simple-array character (*)))))

(defun write-wrapped (text stream &key (first ""))
  "Write TEXT to STREAM in lines that fit the page. The first line begins with the text FIRST, the
other lines with as many spaces."
  (loop with indent = (length first)
        for line in (wrapped-text text (- *page-width* indent))
        for start = first then (make-string indent :initial-element #\Space)
        do (format stream "~A~A~%" start line)))

;;; Columns. A cell is a list of lines.

(defstruct (text-column (:constructor %make-text-column (heading cells anchor width))
                        (:copier nil))
  "A column. HEADING and CELLS are lists of lines of WIDTH characters, aligned at :START or :END."
  (heading '() :type list :read-only t)
  (cells '() :type list :read-only t)
  (anchor :start :type (member :start :end) :read-only t)
  (width 0 :type integer :read-only t))

(defun make-text-column (heading texts &key (anchor :start) (widest 30) whole-p)
  "Return a column of TEXTS below HEADING, wrapped in lines of at most WIDEST characters. If WHOLE-P
is true, TEXTS are not wrapped."
  (flet ((lines (text) (wrapped-text text widest)))
    (let* ((cells (mapcar (if whole-p #'list #'lines) texts))
           (heading (lines heading))
           (width (reduce #'max (apply #'append heading cells) :key #'length)))
      (%make-text-column heading cells anchor width))))

(defun blocks (key columns)
  "Divide COLUMNS into lists that fit on the page, each list after all columns of KEY."
  (flet ((width (columns) (reduce #'+ columns :key (lambda (column)
                                                     (+ 2 (text-column-width column))))))
    (loop with blocks = '() and block = '()
          for column in columns
          do (when (and block (> (width (append key block (list column))) *page-width*))
               (push (append key block) blocks)
               (setf block '()))
             (setf block (append block (list column)))
          finally (return (reverse (cons (append key block) blocks))))))

;;; Writing.

(defun pad-text (text column)
  (if (eq :end (text-column-anchor column))
      (format nil "~V@A" (text-column-width column) text)
      (format nil "~VA" (text-column-width column) text)))

(defun write-cells (cells columns stream)
  (loop for number from 0 below (reduce #'max cells :key #'length)
        do (format stream "~A~%"
                   (string-right-trim " " (format nil "~{  ~A~}"
                                                  (loop for cell in cells
                                                        for column in columns
                                                        collect (pad-text (or (nth number cell) "")
                                                                          column)))))))

(defun write-block (columns stream)
  (write-cells (mapcar #'text-column-heading columns) columns stream)
  (apply #'mapc (lambda (&rest cells) (write-cells cells columns stream))
         (mapcar #'text-column-cells columns)))

(defun write-text-table (key columns stream)
  "Write COLUMNS to STREAM, in as many blocks as needed, each with KEY, columns that identify rows."
  (loop for (block . more) on (blocks key columns)
        do (write-block block stream)
           (when more (terpri stream))))

;;; Numbers and counts in a cell.

(defun percent-text (share trials)
  (decimal-text (* 100 share)
                (max 0 (- (length (integer-text (max 1 (1- trials)))) 2))))

(defun tally-text (tally most)
  "Return TALLY, an alist from texts to counts, as a line: the first MOST texts, then others (N)."
  (flet ((counted (text count)
           (no-break-text (format nil "~A (~D)" (cut text 60) count))))
    (let ((rest (nthcdr most tally)))
      (format nil "~{~A~^, ~}"
              (append (loop for (text . count) in tally
                            repeat most collect (counted text count))
                      (and rest (list (counted "others" (reduce #'+ rest :key #'cdr)))))))))
