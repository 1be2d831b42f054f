;;;; occupancy.lisp -- from the pixels of an image to cells that are free, occupied or unknown.

(in-package :ars-magna.floors)

;;; The blacker a pixel, the likelier it is that something is there; :negate turns that round. Above
;;; one threshold it is occupied, below the other free, between them unknown. In the mode raw the
;;; value itself is the chance in percent, and above 100 unknown. In the mode scale ROS has shades
;;; between the thresholds; a cell of ours is a wall or not, so there, too, they are unknown.

(defconstant +free+ 0 "Stands for a cell where nothing is.")
(defconstant +occupied+ 1 "Stands for a cell where something is.")
(defconstant +unknown+ 2 "Stands for a cell of which nobody knows.")

(defstruct (grid (:constructor make-grid
                     (width height &optional (cells (make-octets (* width height)))))
                 (:copier nil))
  "WIDTH by HEIGHT cells, row by row from the top: +FREE+, +OCCUPIED+ or +UNKNOWN+ each."
  (width 1 :type (integer 1) :read-only t)
  (height 1 :type (integer 1) :read-only t)
  (cells (make-array 0 :element-type '(unsigned-byte 8)) :type octets :read-only t))

(defun count-of (state grid)
  (count state (grid-cells grid)))

(defun chance-of (description sample white)
  "Return how likely it is that a pixel with the value SAMPLE is occupied, from 0 to 1; NIL if
that is not known."
  (let ((brightness (/ sample white)))
    (cond ((eq :raw (description-mode description))
           (let ((percent (round (* 255 brightness))))
             (and (<= percent 100) (/ percent 100))))
          ((description-negated-p description) brightness)
          (t (- 1 brightness)))))

(defun state-of (description sample white)
  (let ((chance (chance-of description sample white)))
    (cond ((null chance) +unknown+)
          ((< (description-occupied description) chance) +occupied+)
          ((< chance (description-free description)) +free+)
          (t +unknown+))))

(defun state-table (description white)
  "Return a vector of the states of pixels, by their values from 0 to WHITE; what is one more than
that is unknown."
  (let ((table (make-octets (+ 2 white))))
    (setf (aref table (1+ white)) +unknown+)
    (dotimes (sample (1+ white) table)
      (setf (aref table sample) (state-of description sample white)))))

;;; Cells of several pixels. They are laid from the lower left corner, where the origin is, so the
;;; last row and column may have fewer pixels.

(defun state-of-block (free occupied unknown share)
  "Return the state of a cell with so many pixels: occupied if any is, and SHARE of them are;
unknown if more are that than free."
  (cond ((and (plusp occupied) (<= (* share (+ free occupied unknown)) occupied)) +occupied+)
        ((< free unknown) +unknown+)
        (t +free+)))

(defun count-states (image table left top right bottom)
  "Return how many of the pixels of IMAGE from LEFT to below RIGHT and TOP to below BOTTOM are free,
occupied and unknown, by TABLE."
  (let ((samples (image-samples image)) (width (image-width image))
        (counts (make-array 3 :initial-element 0)))
    (declare (type samples samples) (type octets table) (dynamic-extent counts))
    (loop for y from top below bottom
          do (loop for x from left below right
                   do (incf (aref counts (aref table (aref samples (+ x (* y width))))))))
    (values (aref counts +free+) (aref counts +occupied+) (aref counts +unknown+))))

(defun block-grid (image table side share)
  (let* ((width (ceiling (image-width image) side))
         (height (ceiling (image-height image) side))
         (missing (- (* side height) (image-height image)))
         (grid (make-grid width height)))
    (dotimes (y height grid)
      (let* ((top (- (* y side) missing)) (bottom (+ top side)))
        (dotimes (x width)
          (setf (aref (grid-cells grid) (+ x (* y width)))
                (multiple-value-call #'state-of-block
                  (count-states image table (* x side) (max 0 top)
                                (min (image-width image) (* (1+ x) side)) bottom)
                  share)))))))

(defun pixel-grid (image table)
  (let ((samples (image-samples image))
        (grid (make-grid (image-width image) (image-height image))))
    (declare (type samples samples) (type octets table))
    (let ((cells (grid-cells grid)))
      (dotimes (index (length cells) grid)
        (setf (aref cells index) (aref table (aref samples index)))))))

(defun image-grid (image description side share)
  (let ((table (state-table description (image-white image))))
    (if (= 1 side)
        (pixel-grid image table)
        (block-grid image table side share))))
