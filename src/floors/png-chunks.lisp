;;;; png-chunks.lisp -- PNG files: the chunks that they are made of.

(in-package :ars-magna.floors)

;;; A PNG file is a signature of eight octets and then chunks: the number of the octets of content,
;;; a name of four letters, the content, a check sum of name and content. Numbers have the high
;;; octet first. IHDR, the first, is the head; PLTE the palette, if there is one; tRNS says what is
;;; transparent; the contents of all IDAT are the pixels, compressed by zlib; IEND ends the file.
;;; Others may be left out if their name begins with a small letter. (www.w3.org/TR/png-3)

(define-constant +png-signature+ (coerce #(137 80 78 71 13 10 26 10) 'octets) :test 'equalp
  :documentation "The octets with which each PNG file begins.")

(defstruct (png (:copier nil))
  "The chunks of a PNG file: WIDTH by HEIGHT pixels with CHANNELS of DEPTH bits. If PALETTE-P is
true, the only channel is an index in PALETTE, which has three octets for each colour. TRANSPARENCY
is the content of tRNS, or NIL. PIXELS are the compressed octets of the pixels."
  (input nil :type image-input :read-only t)
  (width 1 :type (integer 1) :read-only t)
  (height 1 :type (integer 1) :read-only t)
  (depth 8 :type (integer 1 16) :read-only t)
  (channels 1 :type (integer 1 4) :read-only t)
  (palette-p nil :type boolean :read-only t)
  (palette nil :type (or null octets))
  (transparency nil :type (or null octets))
  (pixels (make-array 0 :element-type '(unsigned-byte 8)) :type octets))

(defun png-signature-p (input)
  (let ((octets (image-input-octets input)))
    (and (< 8 (length octets)) (equalp +png-signature+ (subseq octets 0 8)))))

(defun reject-png (input control &rest arguments)
  "Signal UNUSABLE-FLOOR about the PNG file INPUT. The message says how to convert the file."
  (reject-image input "~?; convert the image, for example by: ~A, and name the converted image in ~
                       the .yaml file"
                control arguments *conversion-command*))

(defun reject-damaged-png (input control &rest arguments)
  (reject-image input "the image is damaged: ~?; copy or save it again" control arguments))

;;; Numbers and check sums.

(defun number-at (octets start &optional (count 4))
  "Return the number in COUNT octets of OCTETS from START on, the highest octet first."
  (declare (type octets octets))
  (loop with number = 0
        for index from start below (+ start count)
        do (setf number (logior (ash number 8) (aref octets index)))
        finally (return number)))

(declaim (type (simple-array (unsigned-byte 32) (256)) *crc-table*))
(define-global *crc-table*
  (let ((table (make-array 256 :element-type '(unsigned-byte 32))))
    (dotimes (octet 256 table)
      (let ((crc octet))
        (loop repeat 8
              do (setf crc (logxor (if (oddp crc) #xEDB88320 0) (ash crc -1))))
        (setf (aref table octet) crc))))
  "The contribution of each octet to a CRC-32, by octet.")

(defun crc-32 (octets start end)
  "Return the check sum of OCTETS from START to before END: the CRC-32 of ISO 3309."
  (declare (type octets octets) (type fixnum start end) #.*hot*)
  (let ((crc #xFFFFFFFF) (table *crc-table*))
    (declare (type (unsigned-byte 32) crc))
    (loop for index of-type fixnum from start below end
          do (setf crc (logxor (aref table (logand 255 (logxor crc (aref octets index))))
                               (ash crc -8))))
    (logxor crc #xFFFFFFFF)))

;;; Chunks.

(defun chunk-name (octets start)
  "Return the chunk name at START of OCTETS, four letters, or NIL if a character is no letter."
  (let ((name (map 'string #'code-char (subseq octets start (+ start 4)))))
    (and (every (lambda (char) (or (char<= #\A char #\Z) (char<= #\a char #\z))) name)
         name)))

(defun next-chunk (input)
  "Return the name of the next chunk in INPUT, and the start and end of its content."
  (let* ((octets (image-input-octets input)) (start (+ 8 (image-input-position input)))
         (end (and (<= start (length octets)) (+ start (number-at octets (- start 8))))))
    (unless (and end (<= (+ end 4) (length octets)))
      (reject-damaged-png input "the file has ~D bytes, and ends before its last chunk, IEND"
                          (length octets)))
    (let ((name (chunk-name octets (- start 4))))
      (unless (and name (= (number-at octets end) (crc-32 octets (- start 4) end)))
        (reject-damaged-png input "the chunk at byte ~D has a wrong name or check sum" (- start 8)))
      (setf (image-input-position input) (+ end 4))
      (values name start end))))

;;; The head.

(define-constant +png-colours+ '((0 1 1 2 4 8 16) (2 3 8 16) (3 1 1 2 4 8) (4 2 8 16) (6 4 8 16))
  :test 'equal
  :documentation "A list (type channels depth...) for each colour type of PNG. The types 0 and 4 are
grey; 2 and 6 are red, green and blue; 3 is a palette. The last channel of 4 and 6 is alpha.")

(defun check-encoding (input compression filter interlace)
  "Signal UNUSABLE-FLOOR if INPUT has an unsupported COMPRESSION, FILTER or INTERLACE."
  (when (= 1 interlace)
    (reject-png input "the image is interlaced (Adam7), which is not supported"))
  (unless (= 0 compression filter interlace)
    (reject-damaged-png input "PNG has no compression ~D, filter ~D and interlace ~D"
                        compression filter interlace)))

(defun png-from-header (input octets limit)
  "Return a PNG for INPUT from OCTETS, the content of the chunk IHDR. Signals UNUSABLE-FLOOR if
there are more than LIMIT pixels."
  (let ((width (number-at octets 0)) (height (number-at octets 4)))
    (check-image-size input width height limit)
    (destructuring-bind (depth colour . encoding) (coerce (subseq octets 8) 'list)
      (apply #'check-encoding input encoding)
      (destructuring-bind (&optional channels &rest depths) (rest (assoc colour +png-colours+))
        (unless (member depth depths)
          (reject-damaged-png input "there are no PNG images of colour type ~D with ~D bits"
                              colour depth))
        (make-png :input input :width width :height height :depth depth :channels channels
                  :palette-p (= 3 colour))))))

(defun read-header-chunk (input limit)
  "Return a PNG from the first chunk of INPUT. Signals UNUSABLE-FLOOR if the chunk is invalid or
there are more than LIMIT pixels."
  (multiple-value-bind (name start end) (next-chunk input)
    (unless (and (string= "IHDR" name) (= 13 (- end start)))
      (reject-damaged-png input "the first chunk is ~A with ~D bytes, not IHDR with 13"
                          name (- end start)))
    (png-from-header input (subseq (image-input-octets input) start end) limit)))

;;; The other chunks.

(defun check-palette (png content)
  (unless (and (null (png-palette png)) (zerop (mod (length content) 3))
               (<= 1 (floor (length content) 3) 256))
    (reject-damaged-png (png-input png) "a palette has 3 to 768 bytes, 3 for each colour, and this ~
                                         palette has ~D bytes, or is a second ~
                                         palette" (length content))))

(defun check-transparency (png content)
  (when (= 3 (png-channels png))
    (reject-png (png-input png) "a colour of the image stands for transparent (tRNS), which is ~
                                 supported only for grey images and palettes"))
  (unless (or (png-palette-p png) (= 2 (length content)))
    (reject-damaged-png (png-input png) "the chunk tRNS has ~D bytes, not 2" (length content))))

(defun store-chunk (png name content)
  "Store CONTENT of the chunk NAME in PNG. Signals UNUSABLE-FLOOR if NAME is unknown and critical."
  (cond ((and (string= "PLTE" name) (png-palette-p png))
         (check-palette png content)
         (setf (png-palette png) content))
        ((and (string= "tRNS" name) (oddp (png-channels png)))
         (check-transparency png content)
         (setf (png-transparency png) content))
        ((and (upper-case-p (char name 0)) (string/= "PLTE" name))
         (reject-png (png-input png) "the image has a chunk ~A, which is unknown or in the wrong ~
                                      position" name))))

(defun join-pieces (octets pieces)
  "Return PIECES of OCTETS, joined in order. PIECES are pairs (start . end), the last piece first."
  (let* ((size (loop for (start . end) in pieces sum (- end start)))
         (joined (make-octets size)) (place size))
    (loop for (start . end) in pieces
          do (decf place (- end start))
             (replace joined octets :start1 place :start2 start :end2 end))
    joined))

(defun read-chunks (input limit)
  "Return the PNG that INPUT holds, of at most LIMIT pixels. Signals UNUSABLE-FLOOR."
  (setf (image-input-position input) 8)
  (let ((png (read-header-chunk input limit)) (octets (image-input-octets input)) (pieces '()))
    (loop
      (multiple-value-bind (name start end) (next-chunk input)
        (cond ((string= "IDAT" name) (push (cons start end) pieces))
              ((string= "IEND" name) (return))
              (t (store-chunk png name (subseq octets start end))))))
    (when (and (png-palette-p png) (null (png-palette png)))
      (reject-damaged-png input "the palette, PLTE, is missing"))
    (setf (png-pixels png) (join-pieces octets pieces))
    png))
