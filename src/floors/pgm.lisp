;;;; pgm.lisp -- images in grey: PGM files, as numbers in text or as bytes.

(in-package :ars-magna.floors)

(deftype octets () '(simple-array (unsigned-byte 8) (*)))
(deftype samples () '(simple-array (unsigned-byte 16) (*)))

(defun make-octets (size)
  (make-array size :element-type '(unsigned-byte 8) :initial-element 0))

(defstruct (image (:constructor make-image (width height white samples)) (:copier nil))
  "A grey image of WIDTH by HEIGHT pixels. SAMPLES has their values, row by row from the top: from
0, black, to WHITE, and WHITE + 1 for an unknown pixel."
  (width 1 :type (integer 1) :read-only t)
  (height 1 :type (integer 1) :read-only t)
  (white 255 :type (integer 1 65535) :read-only t)
  (samples (make-array 0 :element-type '(unsigned-byte 16)) :type samples :read-only t))

(defstruct (image-input (:constructor make-image-input (file octets)) (:copier nil))
  "The OCTETS of FILE. The octets before POSITION have been read."
  (file nil :type pathname :read-only t)
  (octets (make-array 0 :element-type '(unsigned-byte 8)) :type octets :read-only t)
  (position 0 :type fixnum))

(defun reject-image (input control &rest arguments)
  (reject-floor (image-input-file input) nil "~?" control arguments))

(defparameter *conversion-command* "convert floor.png -colorspace gray -depth 8 floor.pgm"
  "A shell command that converts an image into a PGM image, which IMPORT-MAP reads.")

(defun check-image-size (input width height limit)
  (unless (and (plusp width) (plusp height))
    (reject-image input "the image has ~D by ~D pixels; save an image that has ~
                         pixels" width height))
  (when (< limit (* width height))
    (reject-image input "the image has ~D by ~D pixels, and the limit is ~D; cut out what you ~
                         need, or give IMPORT-MAP a higher :limit"
                  width height limit)))

(defun read-octets (file limit)
  "Return the bytes of FILE. Signals UNUSABLE-FLOOR if there are too many for LIMIT pixels."
  (with-open-file (in file :element-type '(unsigned-byte 8))
    (when (< (+ +most-description-octets+ (* 8 limit)) (file-length in))
      (reject-floor file nil "the image has ~D bytes, too many for the limit of ~D pixels; cut out ~
                              what you need, or give IMPORT-MAP a higher :limit"
                    (file-length in) limit))
    (let ((octets (make-octets (file-length in))))
      (read-sequence octets in)
      octets)))

;;;; PGM

;;; A PGM file begins with P2 (numbers in text) or P5 (bytes), then come width, height and the
;;; greatest value, with blanks between and perhaps comments, then the rows from the top down. In
;;; P5 one blank ends the head, and a value takes two bytes, the higher first, if 256 or more can
;;; be. (netpbm.sourceforge.net/doc/pgm.html)

;;; Words of the head, and of what is written in text.

(declaim (inline blank-octet-p))
(defun blank-octet-p (octet)
  "True if OCTET is a blank: a space, tab, line feed, vertical tab, form feed or return."
  (or (= octet 32) (<= 9 octet 13)))

(defun skip-blanks (input)
  "Move the position of INPUT to the next word, past blanks and comments."
  (let* ((octets (image-input-octets input)) (end (length octets))
         (position (image-input-position input)))
    (declare (type octets octets) (type fixnum end position))
    (loop while (< position end)
          do (let ((octet (aref octets position)))
               (cond ((blank-octet-p octet) (incf position))
                     ((= octet 35)
                      (setf position (or (position 10 octets :start position) end)))
                     (t (return)))))
    (setf (image-input-position input) position)))

(defun next-number (input what)
  "Return the next number in INPUT, of at most 9 digits. WHAT names the number in errors."
  (skip-blanks input)
  (let ((octets (image-input-octets input)) (start (image-input-position input)) (number 0))
    (declare (type octets octets) (type fixnum start) (type (unsigned-byte 32) number))
    (loop for position of-type fixnum from start below (min (length octets) (+ start 10))
          for digit of-type fixnum = (- (aref octets position) 48)
          while (and (<= 0 digit 9) (< position (+ start 9)))
          do (setf number (+ (* 10 number) digit))
             (setf (image-input-position input) (1+ position)))
    (when (and (= 9 (- (image-input-position input) start))
               (< (image-input-position input) (length octets))
               (digit-char-p (code-char (aref octets (image-input-position input)))))
      (reject-image input "at byte ~D of the image, ~A has more than 9 digits; save an image of a ~
                           size that a map can have" start what))
    (when (or (= start (image-input-position input))
              (and (< (image-input-position input) (length octets))
                   (not (blank-octet-p (aref octets (image-input-position input))))
                   (/= 35 (aref octets (image-input-position input)))))
      (reject-image input "the image is damaged: at byte ~D there is no number that could be ~A; ~
                           save it again as PGM" (image-input-position input) what))
    number))

;;; The pixels.

(defun check-sample (input sample white)
  (when (< white sample)
    (reject-image input "the image is damaged: a pixel has the value ~D, above the greatest, ~D; ~
                         save it again" sample white)))

(defun read-text-samples (input count white)
  "Return a vector of the next COUNT values of INPUT, written as text, each at most WHITE."
  (let ((samples (make-array count :element-type '(unsigned-byte 16))))
    (dotimes (index count)
      (skip-blanks input)
      (when (= (image-input-position input) (length (image-input-octets input)))
        (reject-image input "the image has only ~D of the ~D values that its header announces; ~
                             save it again" index count))
      (let ((sample (next-number input "a value")))
        (check-sample input sample white)
        (setf (aref samples index) sample)))
    (skip-blanks input)
    (unless (= (image-input-position input) (length (image-input-octets input)))
      (reject-image input "the image continues after the ~D values that its header announces; save ~
                           only one image in the file" count))
    samples))

(defun check-octets-left (input needed)
  "Signal UNUSABLE-FLOOR unless exactly NEEDED octets are left in INPUT, or one more, a line end."
  (let* ((end (length (image-input-octets input))) (left (- end (image-input-position input))))
    (unless (or (= left needed)
                (and (= left (1+ needed)) (= 10 (aref (image-input-octets input) (1- end)))))
      (reject-image input "the header of the image announces ~D bytes of pixels, but ~D follow; ~
                           copy or save the image again, as bytes and not as text" needed left))))

(defun read-binary-samples (input count white)
  "Return a vector of the next COUNT values of INPUT, each at most WHITE. A value is a byte or, if
WHITE is above 255, a pair of bytes."
  (incf (image-input-position input))
  (let ((wide (< 255 white)))
    (check-octets-left input (if wide (* 2 count) count))
    (let ((samples (make-array count :element-type '(unsigned-byte 16)))
          (octets (image-input-octets input)) (start (image-input-position input)))
      (declare (type octets octets) (type fixnum start count))
      (if wide
          (dotimes (index count)
            (setf (aref samples index) (logior (ash (aref octets (+ start (* 2 index))) 8)
                                               (aref octets (+ start 1 (* 2 index))))))
          (replace samples octets :start2 start :end2 (+ start count)))
      (let ((high (find-if (lambda (sample) (< white sample)) samples)))
        (when high (check-sample input high white)))
      samples)))

(defun pgm-kind (input)
  "Return 2 or 5 if INPUT begins with P2 or P5, else NIL."
  (let ((octets (image-input-octets input)))
    (and (< 2 (length octets)) (= 80 (aref octets 0)) (find (aref octets 1) #(50 53))
         (- (aref octets 1) 48))))

(defun read-pgm (input limit)
  "Return the PGM image in INPUT, of at most LIMIT pixels. Signals UNUSABLE-FLOOR."
  (setf (image-input-position input) 2)
  (let ((width (next-number input "the width")) (height (next-number input "the height")))
    (check-image-size input width height limit)
    (let ((white (next-number input "the greatest value")) (count (* width height)))
      (unless (<= 1 white 65535)
        (reject-image input "the greatest value of a pixel is ~D; save the image with a greatest ~
                             value from 1 to 65535, usually 255" white))
      (make-image width height white
                  (if (= 2 (pgm-kind input))
                      (read-text-samples input count white)
                      (read-binary-samples input count white))))))
