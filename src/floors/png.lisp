;;;; png.lisp -- images in grey from PNG files; and from files of either format.

(in-package :ars-magna.floors)

;;; Colours and alpha become grey as in ROS's nav2_map_server (map_io.cpp), and in map_server
;;; (image_loader.cpp) before it: how bright a pixel is is the average of red, green and blue. In
;;; the mode trinary alpha is averaged in, if the image has it, as a fourth channel. In the mode
;;; scale a pixel that is not wholly opaque is unknown. In the mode raw alpha does not count.
;;;
;;; So that nothing is rounded, samples are sums here, with three or four times 255 for white. Grey
;;; alone stays as it is. Where there are sums, of 16 bits the high eight count.

(defconstant +no-colour+ 65535 "Stands in a table of shades for a place that a palette lacks.")

(defun alpha-rule (png mode)
  "Return how alpha counts in PNG, read in MODE: :IGNORED, :AVERAGED or :UNKNOWN."
  (cond ((not (or (evenp (png-channels png)) (png-transparency png))) :ignored)
        ((eq :trinary mode) :averaged)
        ((eq :scale mode) :unknown)
        (t :ignored)))

(declaim (inline shade-of-colour))
(defun shade-of-colour (red green blue alpha rule)
  "Return the sample for a pixel of these channels, 0 to 255 each, if alpha counts as RULE says."
  (declare (type (unsigned-byte 8) red green blue alpha))
  (case rule
    (:averaged (+ red green blue alpha))
    (:unknown (if (= 255 alpha) (+ red green blue) 766))
    (t (+ red green blue))))

(defun plain-grey-p (png)
  "True if PNG has a channel of grey and nothing else."
  (not (or (< 1 (png-channels png)) (png-palette-p png) (png-transparency png))))

(defun white-of (png rule)
  "Return the greatest sample that may come of PNG, if alpha counts as RULE says."
  (cond ((plain-grey-p png) (1- (ash 1 (png-depth png))))
        ((eq :averaged rule) 1020)
        (t 765)))

;;; One channel: a table has the sample for each of its values.

(defun shade-of-place (png place rule)
  "Return the sample for what is at PLACE of the palette of PNG."
  (let ((palette (png-palette png)) (alphas (png-transparency png)) (start (* 3 place)))
    (if (< start (length palette))
        (shade-of-colour (aref palette start) (aref palette (+ 1 start)) (aref palette (+ 2 start))
                         (if (< place (length alphas)) (aref alphas place) 255)
                         rule)
        +no-colour+)))

(defun shade-of-grey (png value rule)
  "Return the sample for VALUE of the grey image PNG, in which one value may be transparent."
  (if (plain-grey-p png)
      value
      (let ((grey (if (= 16 (png-depth png))
                      (ash value -8)
                      (floor (* 255 value) (1- (ash 1 (png-depth png))))))
            (alpha (if (= value (number-at (png-transparency png) 0 2)) 0 255)))
        (shade-of-colour grey grey grey alpha rule))))

(defun shade-table (png rule)
  (let ((table (make-array (ash 1 (png-depth png)) :element-type '(unsigned-byte 16)))
        (shade (if (png-palette-p png) #'shade-of-place #'shade-of-grey)))
    (dotimes (value (length table) table)
      (setf (aref table value) (funcall shade png value rule)))))

(declaim (inline value-in-row))
(defun value-in-row (row start x depth)
  "Return value X, of DEPTH bits, of the octets of ROW from START on."
  (declare (type octets row) (type (unsigned-byte 30) start x) (type (integer 1 16) depth))
  (case depth
    (8 (aref row (+ start x)))
    (16 (logior (ash (aref row (+ start (* 2 x))) 8) (aref row (+ start 1 (* 2 x)))))
    (t (multiple-value-bind (octet bit) (floor (* x depth) 8)
         (ldb (byte depth 0) (ash (aref row (+ start octet)) (- (+ bit depth) 8)))))))

(defun shade-row-by-table (row table depth step samples start width)
  "Let WIDTH of SAMPLES from START be what TABLE has for the values of ROW, behind STEP octets."
  (declare (type octets row) (type samples table samples) (type (unsigned-byte 30) start width)
           (type (integer 1 8) step) (type (integer 1 16) depth) #.*hot*)
  (dotimes (x width)
    (setf (aref samples (+ start x)) (aref table (value-in-row row step x depth)))))

(defun check-places (png samples)
  "Signal UNUSABLE-FLOOR if a pixel of PNG has a colour that its palette lacks."
  (when (and (png-palette-p png) (find +no-colour+ (the samples samples)))
    (reject-damaged (png-tape png) "a pixel has a colour that its palette, of ~D, lacks"
                    (floor (length (png-palette png)) 3))))

;;; Several channels. Of two octets the high one is the first.

(defun shade-row-by-sums (row channels octets step samples start width rule)
  "Let WIDTH of SAMPLES from START be those of ROW, behind STEP octets, with so many CHANNELS and
OCTETS to each."
  (declare (type octets row) (type samples samples) (type (unsigned-byte 30) start width)
           (type (integer 1 8) step) (type (integer 2 4) channels) (type (integer 1 2) octets)
           #.*hot*)
  (let ((green (if (= 2 channels) 0 octets)) (blue (if (= 2 channels) 0 (* 2 octets)))
        (alpha (* octets (1- channels))) (alpha-p (evenp channels)))
    (loop for place of-type fixnum from step by (* channels octets)
          for index of-type (unsigned-byte 31) from start below (+ start width)
          do (setf (aref samples index)
                   (shade-of-colour (aref row place) (aref row (+ place green))
                                    (aref row (+ place blue))
                                    (if alpha-p (aref row (+ place alpha)) 255)
                                    rule)))))

;;; The image.

(defun row-shader (png samples rule)
  "Return a function of y and a row of PNG that puts what that comes to into SAMPLES."
  (let ((width (png-width png)) (depth (png-depth png)) (step (png-step png))
        (channels (png-channels png)))
    (if (= 1 channels)
        (let ((table (shade-table png rule)))
          (lambda (y row)
            (shade-row-by-table row table depth step samples (* y width) width)))
        (lambda (y row)
          (shade-row-by-sums row channels (floor depth 8) step samples (* y width) width rule)))))

(defun read-png (tape limit mode)
  "Return the PNG image in TAPE, of at most LIMIT pixels, in grey. How bright a pixel is is the
average of red, green and blue, with alpha as MODE has it, as in ROS's nav2_map_server: averaged in
as a fourth channel if MODE is :TRINARY; nobody knows what is not wholly opaque if it is :SCALE; of
no account if it is :RAW. Signals UNUSABLE-FLOOR."
  (let* ((png (read-chunks tape limit)) (rule (alpha-rule png mode)))
    (check-pixels-there png (* (png-height png) (1+ (png-row-size png))))
    (let ((samples (make-array (* (png-width png) (png-height png))
                               :element-type '(unsigned-byte 16))))
      (call-with-rows (row-shader png samples rule) png)
      (check-places png samples)
      (make-image (png-width png) (png-height png) (white-of png rule) samples))))

(defun read-image (file limit mode)
  "Return the image in FILE, of at most LIMIT pixels, for MODE: PGM or PNG, whatever FILE is called.
Signals UNUSABLE-FLOOR."
  (let ((tape (make-tape file (read-octets file limit))))
    (cond ((png-begins-p tape) (read-png tape limit mode))
          ((pgm-kind tape) (read-pgm tape limit))
          (t (reject-image tape "the image is no PGM file, P2 or P5, and no PNG file by its first ~
                                 bytes; save it as one, as with: ~A" *conversion*)))))
