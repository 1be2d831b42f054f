;;;; box-index.lisp -- which of many boxes overlap another, without a look at each.

(in-package :ars-magna.display)

;;; The map is divided into squares. Each lists what has been entered with a box that meets it.

(define-constant +square-side+ 32 :documentation "How wide a square of a box index is, in pixels.")
(define-constant +most-squares+ 1000
  :documentation "How many squares a box meets at most that is listed in each of them.")

(defstruct (box-index (:constructor make-box-index ()) (:copier nil))
  "Entries (box . item) by the numbers of SQUARES, and those that meet very many of them, LARGE."
  (squares (make-hash-table) :type hash-table :read-only t)
  (large '() :type list))

(defun some-square (function box)
  "Return what FUNCTION, of the number of a square that BOX meets, returns first that is true."
  (destructuring-bind (first-column first-row last-column last-row)
      (mapcar (lambda (pixels) (values (floor pixels +square-side+))) box)
    ;; Squares that have a number in common are no harm: overlaps are checked.
    (loop for row from first-row to last-row
            thereis (loop for column from first-column to last-column
                            thereis (funcall function (+ column (* row 65536)))))))

(defun large-box-p (box)
  (destructuring-bind (left top right bottom) box
    (< (* +most-squares+ (expt +square-side+ 2)) (* (- right left) (- bottom top)))))

(defun enter-box (box item index)
  "Enter ITEM, which has BOX, into INDEX."
  (let ((entry (cons box item)))
    (if (large-box-p box)
        (push entry (box-index-large index))
        (some-square (lambda (square)
                       (push entry (gethash square (box-index-squares index)))
                       nil)
                     box))))

(defun index-boxes (boxes &optional (items boxes))
  "Return an index of ITEMS that have BOXES."
  (let ((index (make-box-index)))
    (mapc (lambda (box item) (enter-box box item index)) boxes items)
    index))

(defun find-overlapping (box index &optional (test (constantly t)))
  "Return an item of INDEX whose box overlaps BOX and for which TEST is true, or NIL."
  (flet ((among (entries)
           (loop for (other . item) in entries
                 when (and (overlap-p box other) (funcall test item)) return item)))
    (or (among (box-index-large index))
        (some-square (lambda (square) (among (gethash square (box-index-squares index)))) box))))

(defun all-overlapping (box index)
  "Return a list of the items of INDEX whose boxes overlap BOX."
  (let ((items '()))
    (find-overlapping box index (lambda (item) (pushnew item items) nil))
    items))
