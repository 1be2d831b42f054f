;;;; png-rows.lisp -- PNG files: the rows of pixels, decompressed and without their filters.

(in-package :ars-magna.floors)

;;; Each row begins with an octet that says by which filter each octet has been made smaller:
;;; what is to be expected there was subtracted, by what is to the left, above, or both. The octet
;;; to the left is that of the same channel, STEP before. Here a row has STEP zeros in front, so
;;; that there always is one. (www.w3.org/TR/png-3, 9)

(defun png-step (png)
  "Return how many octets there are to a pixel of PNG, at least 1."
  (max 1 (floor (* (png-channels png) (png-depth png)) 8)))

(defun png-row-size (png)
  "Return how many octets the pixels of a row of PNG take."
  (ceiling (* (png-width png) (png-channels png) (png-depth png)) 8))

;;; Filters.

(declaim (inline likeliest-of))
(defun likeliest-of (left above corner)
  "Return LEFT, ABOVE or CORNER, which is above LEFT: that nearest to LEFT + ABOVE - CORNER."
  (declare (type (unsigned-byte 8) left above corner))
  (let ((from-left (abs (- above corner))) (from-above (abs (- left corner)))
        (from-corner (abs (- (+ left above) (* 2 corner)))))
    (cond ((and (<= from-left from-above) (<= from-left from-corner)) left)
          ((<= from-above from-corner) above)
          (t corner))))

(defmacro add-to-row ((row above step left over corner) expected)
  "Add EXPECTED to each octet of ROW behind the first STEP ones. LEFT, OVER and CORNER are bound to
the octets to the left of it, in ABOVE, and to the left of that."
  (with-gensyms (index)
    `(loop for ,index of-type fixnum from ,step below (length ,row)
           do (let ((,left (aref ,row (- ,index ,step))) (,over (aref ,above ,index))
                    (,corner (aref ,above (- ,index ,step))))
                (declare (ignorable ,left ,over ,corner))
                (setf (aref ,row ,index) (logand 255 (+ (aref ,row ,index) ,expected)))))))

(defun undo-filter (filter row above step)
  "Let ROW, made by FILTER, be as it was; the row ABOVE is already. Return NIL if there is no such
filter."
  (declare (type octets row above) (type (integer 1 8) step) #.*hot*)
  (case filter
    (0)
    (1 (add-to-row (row above step left over corner) left))
    (2 (add-to-row (row above step left over corner) over))
    (3 (add-to-row (row above step left over corner) (ash (+ left over) -1)))
    (4 (add-to-row (row above step left over corner) (likeliest-of left over corner)))
    (t (return-from undo-filter nil)))
  t)

;;; Rows. They are decompressed some at a time, so that an image takes no more memory than its
;;; samples, whatever is in the file.

(define-constant +most-inflation+ 1032
  :documentation "How many octets may come of one that zlib compressed, at most.")

(defun check-pixels-there (png needed)
  "Signal UNUSABLE-FLOOR if NEEDED octets cannot come of what PNG has."
  (when (< (* +most-inflation+ (length (png-pixels png))) needed)
    (reject-damaged (png-tape png) "its pixels take ~D bytes, and ~D bytes of compressed data are ~
                                    too few for that" needed (length (png-pixels png)))))

(defun fill-with-rows (png inflater buffer size)
  "Put the next SIZE octets that INFLATER, of PNG, decompresses into BUFFER."
  (let ((made (inflate-into buffer size inflater)))
    (cond ((null made)
           (reject-png (png-tape png) "the image is damaged, or compressed in a way that is not ~
                                       known here: its pixels cannot be decompressed"))
          ((< made size)
           (reject-damaged (png-tape png) "its pixels end before the last row")))))

(defun check-all-inflated (png inflater)
  "Signal UNUSABLE-FLOOR unless INFLATER, of PNG, ends behind the last row."
  (when (eql 1 (inflate-into (make-octets 1) 1 inflater))
    (reject-damaged (png-tape png) "its pixels go on behind the last row"))
  (unless (inflated-p inflater)
    (reject-damaged (png-tape png) "the check sum of its pixels is missing or wrong")))

(defun call-with-row (function png buffer start y row above)
  "Let ROW be that of PNG at START of BUFFER, as it was before it was filtered, and call FUNCTION
with Y and it."
  (declare (type octets buffer row above) (type function function) (type fixnum start))
  (let ((step (png-step png)))
    (replace row buffer :start1 step :start2 (1+ start))
    (unless (undo-filter (aref buffer start) row above step)
      (reject-damaged (png-tape png) "row ~D has the filter ~D, and there are 0 to 4"
                      (1+ y) (aref buffer start)))
    (funcall function y row)))

(defun call-with-rows (function png)
  "Call FUNCTION with the number of each row of PNG, from the top, and the octets of its pixels,
behind as many other ones as PNG-STEP says. Signals UNUSABLE-FLOOR."
  (let* ((size (1+ (png-row-size png))) (height (png-height png))
         (most (min height (max 1 (floor 65536 size))))
         (buffer (make-octets (* most size))) (inflater (make-inflater (png-pixels png)))
         (row (make-octets (+ (png-step png) size -1))) (above (make-octets (length row))))
    (loop for top from 0 below height by most
          for count = (min most (- height top))
          do (fill-with-rows png inflater buffer (* count size))
             (dotimes (i count)
               (call-with-row function png buffer (* i size) (+ top i) row above)
               (rotatef row above)))
    (check-all-inflated png inflater)))
