;;;; png.lisp -- images in grey from PNG files: rows decompressed, unfiltered, and made grey.

(in-package :ars-magna.floors)

;;; For damaged data chipz signals its own errors, or others, such as for an index that is too
;;; large. All of them mean the same.

(defstruct (inflater (:constructor make-inflater (octets)) (:copier nil))
  "The state of decompressing OCTETS, in zlib's format. The octets before POSITION have been read."
  (octets (make-array 0 :element-type '(unsigned-byte 8)) :type octets :read-only t)
  (position 0 :type fixnum)
  (state (chipz:make-dstate 'chipz:zlib) :read-only t))

(defun inflate-into (buffer end inflater)
  "Let INFLATER decompress its octets into BUFFER, up to END. Return the number of octets written,
less than END only at the end of the data; NIL if the data are damaged."
  (ignore-errors
   (multiple-value-bind (used made)
       (chipz:decompress buffer (inflater-state inflater) (inflater-octets inflater)
                         :input-start (inflater-position inflater) :output-end end)
     (incf (inflater-position inflater) used)
     made)))

;;;; Rows

;;; Each row begins with its filter's number. A filter has subtracted from each octet a prediction
;;; by the octets to the left, above, or both. The octet to the left is that of the same channel,
;;; STEP before. Here STEP zeros precede a row, so there always is one. (www.w3.org/TR/png-3, 9)

(defun png-pixel-octets (png)
  (max 1 (floor (* (png-channels png) (png-depth png)) 8)))

(defun png-row-size (png)
  (ceiling (* (png-width png) (png-channels png) (png-depth png)) 8))

;;; Filters.

(declaim (inline paeth-predictor))
(defun paeth-predictor (left above corner)
  "Return LEFT, ABOVE or CORNER (above LEFT), whichever is nearest to LEFT + ABOVE - CORNER."
  (declare (type (unsigned-byte 8) left above corner))
  (let ((from-left (abs (- above corner))) (from-above (abs (- left corner)))
        (from-corner (abs (- (+ left above) (* 2 corner)))))
    (cond ((and (<= from-left from-above) (<= from-left from-corner)) left)
          ((<= from-above from-corner) above)
          (t corner))))

(defmacro add-prediction-to-row ((row above step left over corner) expected)
  "Add the value of EXPECTED to each octet of ROW after the first STEP octets. LEFT is bound to the
octet STEP to the left, OVER to the octet at the same index of the row ABOVE, and CORNER to the
octet STEP to the left of OVER."
  (with-gensyms (index)
    `(loop for ,index of-type fixnum from ,step below (length ,row)
           do (let ((,left (aref ,row (- ,index ,step))) (,over (aref ,above ,index))
                    (,corner (aref ,above (- ,index ,step))))
                (declare (ignorable ,left ,over ,corner))
                (setf (aref ,row ,index) (logand 255 (+ (aref ,row ,index) ,expected)))))))

(defun undo-filter (filter row above step)
  "Undo FILTER in ROW; the row ABOVE is already unfiltered. Return NIL if FILTER does not exist."
  (declare (type octets row above) (type (integer 1 8) step) #.*hot*)
  (case filter
    (0)
    (1 (add-prediction-to-row (row above step left over corner) left))
    (2 (add-prediction-to-row (row above step left over corner) over))
    (3 (add-prediction-to-row (row above step left over corner) (ash (+ left over) -1)))
    (4 (add-prediction-to-row (row above step left over corner) (paeth-predictor left over corner)))
    (t (return-from undo-filter nil)))
  t)

;;; A few rows are decompressed at a time, so that no image takes more memory than its samples.

(defun check-compressed-size (png needed)
  "Signal UNUSABLE-FLOOR if the compressed data of PNG are too few for NEEDED octets."
  ;; From one octet zlib makes 1032 at most.
  (when (< (* 1032 (length (png-pixels png))) needed)
    (reject-damaged-png (png-input png)
                        "the pixels take ~D bytes, for which ~D bytes of compressed ~
                         data are too few" needed (length (png-pixels png)))))

(defun inflate-next-rows (png inflater buffer size)
  "Fill BUFFER with the next SIZE octets that INFLATER decompresses from PNG."
  (let ((made (inflate-into buffer size inflater)))
    (cond ((null made)
           (reject-png (png-input png) "the image is damaged, or its compression is unknown: its ~
                                        pixels cannot be decompressed"))
          ((< made size)
           (reject-damaged-png (png-input png) "the pixels end before the last row")))))

(defun check-all-inflated (png inflater)
  "Signal UNUSABLE-FLOOR unless the data of INFLATER end after the last row of PNG."
  (when (eql 1 (inflate-into (make-octets 1) 1 inflater))
    (reject-damaged-png (png-input png) "the pixels continue after the last row"))
  (unless (ignore-errors (chipz:finish-dstate (inflater-state inflater)))
    (reject-damaged-png (png-input png) "the check sum of the pixels is missing or wrong")))

(defun call-with-row (function png buffer start y row above)
  "Copy the row of PNG at START of BUFFER into ROW, unfiltered, and call FUNCTION with Y and ROW."
  (declare (type octets buffer row above) (type function function) (type fixnum start))
  (let ((step (png-pixel-octets png)))
    (replace row buffer :start1 step :start2 (1+ start))
    (unless (undo-filter (aref buffer start) row above step)
      (reject-damaged-png (png-input png) "row ~D has the filter ~D, but filters are 0 to 4"
                          (1+ y) (aref buffer start)))
    (funcall function y row)))

(defun call-with-rows (function png)
  "Call FUNCTION for each row of PNG, from the top, with the number of the row and a vector:
PNG-PIXEL-OCTETS filler octets, then the octets of the row's pixels. Signals UNUSABLE-FLOOR."
  (let* ((size (1+ (png-row-size png))) (height (png-height png))
         (most (min height (max 1 (floor 65536 size))))
         (buffer (make-octets (* most size))) (inflater (make-inflater (png-pixels png)))
         (row (make-octets (+ (png-pixel-octets png) size -1))) (above (make-octets (length row))))
    (loop for top from 0 below height by most
          for count = (min most (- height top))
          do (inflate-next-rows png inflater buffer (* count size))
             (dotimes (i count)
               (call-with-row function png buffer (* i size) (+ top i) row above)
               (rotatef row above)))
    (check-all-inflated png inflater)))

;;;; Grey

;;; Colours and alpha become grey as in ROS's nav2_map_server (map_io.cpp), and in map_server
;;; (image_loader.cpp) before it: the average of red, green and blue. In the mode trinary alpha, if
;;; any, is averaged in as a fourth channel. In the mode scale a pixel that is not fully opaque is
;;; unknown. In the mode raw alpha is ignored.
;;;
;;; To avoid rounding, samples are sums, with three or four times 255 for white. Plain grey stays as
;;; it is. In sums, only the high eight of 16 bits count.

(defconstant +no-colour+ 65535 "The sample for an index that the palette lacks.")

(defun alpha-treatment (png mode)
  "Return the rule for alpha in PNG, read in MODE: :IGNORED, :AVERAGED or :UNKNOWN."
  (cond ((not (or (evenp (png-channels png)) (png-transparency png))) :ignored)
        ((eq :trinary mode) :averaged)
        ((eq :scale mode) :unknown)
        (t :ignored)))

(declaim (inline colour-sample))
(defun colour-sample (red green blue alpha rule)
  "Return the sample for a pixel with these channels, from 0 to 255. RULE says how ALPHA counts."
  (declare (type (unsigned-byte 8) red green blue alpha))
  (case rule
    (:averaged (+ red green blue alpha))
    (:unknown (if (= 255 alpha) (+ red green blue) 766))
    (t (+ red green blue))))

(defun plain-grey-p (png)
  (not (or (< 1 (png-channels png)) (png-palette-p png) (png-transparency png))))

(defun greatest-sample (png rule)
  (cond ((plain-grey-p png) (1- (ash 1 (png-depth png))))
        ((eq :averaged rule) 1020)
        (t 765)))

;;; One channel: a table has the sample for each of its values.

(defun palette-sample (png place rule)
  "Return the sample for the colour with the index PLACE in the palette of PNG."
  (let ((palette (png-palette png)) (alphas (png-transparency png)) (start (* 3 place)))
    (if (< start (length palette))
        (colour-sample (aref palette start) (aref palette (+ 1 start)) (aref palette (+ 2 start))
                       (if (< place (length alphas)) (aref alphas place) 255)
                       rule)
        +no-colour+)))

(defun grey-sample (png value rule)
  "Return the sample for a pixel with VALUE in the grey image PNG. One value may be transparent."
  (if (plain-grey-p png)
      value
      (let ((grey (if (= 16 (png-depth png))
                      (ash value -8)
                      (floor (* 255 value) (1- (ash 1 (png-depth png))))))
            (alpha (if (= value (number-at (png-transparency png) 0 2)) 0 255)))
        (colour-sample grey grey grey alpha rule))))

(defun sample-table (png rule)
  (let ((table (make-array (ash 1 (png-depth png)) :element-type '(unsigned-byte 16)))
        (shade (if (png-palette-p png) #'palette-sample #'grey-sample)))
    (dotimes (value (length table) table)
      (setf (aref table value) (funcall shade png value rule)))))

(declaim (inline value-in-row))
(defun value-in-row (row start x depth)
  "Return the value of the pixel X of ROW. The pixels have DEPTH bits each and begin at START."
  (declare (type octets row) (type (unsigned-byte 30) start x) (type (integer 1 16) depth))
  (case depth
    (8 (aref row (+ start x)))
    (16 (logior (ash (aref row (+ start (* 2 x))) 8) (aref row (+ start 1 (* 2 x)))))
    (t (multiple-value-bind (octet bit) (floor (* x depth) 8)
         (ldb (byte depth 0) (ash (aref row (+ start octet)) (- (+ bit depth) 8)))))))

(defun fill-samples-by-table (row table depth step samples start width)
  "Set WIDTH elements of SAMPLES, from START on, to the elements of TABLE for the values in ROW,
which begin after STEP octets."
  (declare (type octets row) (type samples table samples) (type (unsigned-byte 30) start width)
           (type (integer 1 8) step) (type (integer 1 16) depth) #.*hot*)
  (dotimes (x width)
    (setf (aref samples (+ start x)) (aref table (value-in-row row step x depth)))))

(defun check-palette-indices (png samples)
  "Signal UNUSABLE-FLOOR if a pixel of PNG has a colour that is not in its palette."
  (when (and (png-palette-p png) (find +no-colour+ (the samples samples)))
    (reject-damaged-png (png-input png)
                        "a pixel has a colour that the palette, with ~D colours, does ~
                         not have"
                        (floor (length (png-palette png)) 3))))

;;; Several channels. Of two octets the high one is the first.

(defun fill-samples-by-channels (row channels octets step samples start width rule)
  "Set WIDTH elements of SAMPLES, beginning at START, from the pixels in ROW, which begin after STEP
octets. A pixel has CHANNELS channels of OCTETS octets each."
  (declare (type octets row) (type samples samples) (type (unsigned-byte 30) start width)
           (type (integer 1 8) step) (type (integer 2 4) channels) (type (integer 1 2) octets)
           #.*hot*)
  (let ((green (if (= 2 channels) 0 octets)) (blue (if (= 2 channels) 0 (* 2 octets)))
        (alpha (* octets (1- channels))) (alpha-p (evenp channels)))
    (loop for place of-type fixnum from step by (* channels octets)
          for index of-type (unsigned-byte 31) from start below (+ start width)
          do (setf (aref samples index)
                   (colour-sample (aref row place) (aref row (+ place green))
                                  (aref row (+ place blue))
                                  (if alpha-p (aref row (+ place alpha)) 255)
                                  rule)))))

;;; The image.

(defun row-sampler (png samples rule)
  "Return a function of a row's number and octets that sets SAMPLES. RULE says how alpha counts."
  (let ((width (png-width png)) (depth (png-depth png)) (step (png-pixel-octets png))
        (channels (png-channels png)))
    (if (= 1 channels)
        (let ((table (sample-table png rule)))
          (lambda (y row)
            (fill-samples-by-table row table depth step samples (* y width) width)))
        (lambda (y row)
          (fill-samples-by-channels row channels (floor depth 8) step samples (* y width) width
                                    rule)))))

(defun read-png (input limit mode)
  "Return the PNG in INPUT, of at most LIMIT pixels, as a grey image. Signals UNUSABLE-FLOOR."
  (let* ((png (read-chunks input limit)) (rule (alpha-treatment png mode)))
    (check-compressed-size png (* (png-height png) (1+ (png-row-size png))))
    (let ((samples (make-array (* (png-width png) (png-height png))
                               :element-type '(unsigned-byte 16))))
      (call-with-rows (row-sampler png samples rule) png)
      (check-palette-indices png samples)
      (make-image (png-width png) (png-height png) (greatest-sample png rule) samples))))

(defun read-image (file limit mode)
  "Return the image in FILE, of at most LIMIT pixels, read in MODE. The first bytes of FILE decide
whether it is PGM or PNG. Signals UNUSABLE-FLOOR."
  (let ((input (make-image-input file (read-octets file limit))))
    (cond ((png-signature-p input) (read-png input limit mode))
          ((pgm-kind input) (read-pgm input limit))
          (t (reject-image input "the first bytes of the image are not those of a PGM file (P2 or ~
                                  P5) or PNG file; save it in such a format, for example by: ~
                                  ~A" *conversion-command*)))))
