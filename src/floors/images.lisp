;;;; images.lisp -- images in grey, and the bytes of the files that they are read from.

(in-package :ars-magna.floors)

(deftype octets () '(simple-array (unsigned-byte 8) (*)))
(deftype samples () '(simple-array (unsigned-byte 16) (*)))

(defun make-octets (size)
  (make-array size :element-type '(unsigned-byte 8) :initial-element 0))

(defstruct (image (:constructor make-image (width height white samples)) (:copier nil))
  "An image in grey of WIDTH by HEIGHT pixels, whose SAMPLES, row by row from the top, go from 0,
black, to WHITE. One more than WHITE is a pixel of which nobody knows."
  (width 1 :type (integer 1) :read-only t)
  (height 1 :type (integer 1) :read-only t)
  (white 255 :type (integer 1 65535) :read-only t)
  (samples (make-array 0 :element-type '(unsigned-byte 16)) :type samples :read-only t))

(defstruct (tape (:constructor make-tape (file octets)) (:copier nil))
  "The OCTETS of FILE, read up to POSITION."
  (file nil :type pathname :read-only t)
  (octets (make-array 0 :element-type '(unsigned-byte 8)) :type octets :read-only t)
  (position 0 :type fixnum))

(defun reject-image (tape control &rest arguments)
  (reject-floor (tape-file tape) nil "~?" control arguments))

(defparameter *conversion* "convert floor.png -colorspace gray -depth 8 floor.pgm"
  "The line for a shell that makes an image of one that cannot be read.")

(defun check-pixels (tape width height limit)
  (unless (and (plusp width) (plusp height))
    (reject-image tape "the image has ~D by ~D pixels; save one that has some" width height))
  (when (< limit (* width height))
    (reject-image tape "the image has ~D by ~D pixels, and the limit is ~D; cut out what you need, ~
                        or give IMPORT-MAP a higher :limit"
                  width height limit)))

(defun read-octets (file limit)
  "Return what FILE holds. Signals UNUSABLE-FLOOR if that is too much for LIMIT pixels."
  (with-open-file (in file :element-type '(unsigned-byte 8))
    (when (< (+ +most-octets+ (* 8 limit)) (file-length in))
      (reject-floor file nil "the image has ~D bytes, too many for the limit of ~D pixels; cut out ~
                              what you need, or give IMPORT-MAP a higher :limit"
                    (file-length in) limit))
    (let ((octets (make-octets (file-length in))))
      (read-sequence octets in)
      octets)))
