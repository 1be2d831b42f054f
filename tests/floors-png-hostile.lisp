;;;; floors-png-hostile.lisp -- PNG files that cannot be used, and the messages about them.

(in-package :ars-magna.tests)

(in-suite floors)

(defun png-of-chunks (&rest chunks)
  "Return the PNG file that CHUNKS make, with IEND after them."
  (format nil "~A~{~A~}~A" (png-signature) chunks (png-chunk "IEND" "")))

(defun png-of-data (text)
  "Return the PNG file of 3 by 1 pixels of grey in which TEXT stands for what zlib has made."
  (png-of-chunks (png-head-chunk 3 1 8 0) (png-chunk "IDAT" text)))

(defun damaged-at (place text)
  "Return TEXT with another character at PLACE, which counts from the end if it is negative."
  (let ((copy (copy-seq text)) (place (mod place (length text))))
    (setf (char copy place) (code-char (logxor 1 (char-code (char text place)))))
    copy))

(defparameter *three-pixels* '((0 0 205 254)))

(test png.damage-is-told
  (let ((good (png-file 3 0 *three-pixels*)) (head (png-head-chunk 3 1 8 0)))
    (loop for (words image)
            in `(("the first bytes of the image are not those of a PGM file (P2 or P5) or PNG file"
                  ,(damaged-at 5 good))
                 ("the chunk at byte 8 has a wrong name or check sum; copy or save it again"
                  ,(damaged-at 20 good))
                 ("the chunk at byte 33 has a wrong name or check sum" ,(damaged-at 50 good))
                 ("the chunk at byte 33 has a wrong name"
                  ,(png-of-chunks head (png-chunk "I AT" "")))
                 ("ends before its last chunk, IEND" ,(subseq good 0 (- (length good) 1)))
                 ("ends before its last chunk, IEND" ,(subseq good 0 (- (length good) 12)))
                 ("the file has 9 bytes, and ends before its last chunk" ,(subseq good 0 9))
                 ("first chunk is IEND with 0 bytes, not IHDR with 13" ,(png-of-chunks))
                 ("first chunk is IHDR with 2 bytes, not" ,(png-of-chunks (png-chunk "IHDR" "ab")))
                 ("has a chunk IHDR, which is unknown or in the wrong position; convert"
                  ,(png-of-chunks head head))
                 ("has a chunk CgBI, which is unknown"
                  ,(png-file 3 0 *three-pixels* :chunks (png-chunk "CgBI" "x"))))
          do (check-complaint words (complaint-of-image image)))
    (is (null (complaint-of-image good)))))

(test png.heads-that-make-no-sense-are-told
  (flet ((check (words &rest head)
           (check-complaint (format nil words)
                            (complaint-of-image (png-of-chunks (apply #'png-head-chunk head)
                                                               (png-chunk "IDAT" "x"))))))
    (check "the image has 0 by 4 pixels; save an image" 0 4 8 0)
    (check "the image has 4 by 0 pixels; save an image" 4 0 8 0)
    (check "no PNG images of colour type 1 with 8 bits" 3 1 8 1)
    (check "no PNG images of colour type 3 with 16 bits" 3 1 16 3)
    (check "no PNG images of colour type 0 with 3 bits" 3 1 3 0)
    (check "no PNG images of colour type 6 with 0 bits" 3 1 0 6)
    (check "PNG has no compression 1, filter 0 and interlace 0" 3 1 8 0 '(1 0 0))
    (check "PNG has no compression 0, filter 0 and interlace 2" 3 1 8 0 '(0 0 2))
    (check "the image has 4294967295 by 4294967295 pixels, and the limit is 25000000"
           4294967295 4294967295 16 6)
    (check "interlaced (Adam7), which is not supported; convert the image, for example by: ~
            convert floor.png -colorspace gray -depth 8 floor.pgm, and name the converted image in ~
            the .yaml file"
           3 1 8 0 '(0 0 1))))

(test png.palettes-that-do-not-fit-are-told
  (flet ((check (words chunks &optional (colour 3))
           (check-complaint words (complaint-of-image
                                   (png-file 3 colour '((0 0 1 2)) :chunks chunks)))))
    (check "the palette, PLTE, is missing" "")
    (check "has a colour that the palette, with 2 colours, does not have"
           (png-palette-chunk 0 0 0 255 255 255))
    (check "a palette has 3 to 768 bytes, 3 for each colour, and this palette has 4"
           (png-palette-chunk 0 0 0 255))
    (check "and this palette has 0 bytes, or is a second palette" (png-palette-chunk))
    (check "and this palette has 771 bytes, or"
           (apply #'png-palette-chunk (make-list 771 :initial-element 1)))
    (check "and this palette has 9 bytes, or is a second palette"
           (let ((chunk (png-palette-chunk 0 0 0 1 1 1 2 2 2)))
             (concatenate 'string chunk chunk)))
    (check "the chunk tRNS has 1 bytes, not 2" (png-chunk "tRNS" "a") 0)
    (check "stands for transparent (tRNS), which is supported only for grey images and palettes"
           (png-chunk "tRNS" "abcdef") 2)))

(test png.pixels-that-do-not-fit-are-told
  (let ((data (stored-by-zlib (octets-as-string (first *three-pixels*)))))
    (loop for (words image)
            in `(("the pixels end before the last row"
                  ,(png-of-data (stored-by-zlib (octets-as-string '(0 0 205)))))
                 ("the pixels continue after the last row"
                  ,(png-of-data (stored-by-zlib (octets-as-string '(0 0 205 254 1)))))
                 ("the check sum of the pixels is missing or wrong"
                  ,(png-of-data (subseq data 0 (- (length data) 4))))
                 ("its pixels cannot be decompressed; convert" ,(png-of-data (damaged-at -1 data)))
                 ("its pixels cannot be decompressed; convert" ,(png-of-data (damaged-at 0 data)))
                 ("its pixels cannot be decompressed" ,(png-of-data (octets-as-string '(#x78 1 7))))
                 ("the pixels end before the last row" ,(png-of-data (octets-as-string '(#x78 1))))
                 ("0 bytes of compressed data are too few" ,(png-of-data ""))
                 ("0 bytes of compressed data are too few"
                  ,(png-of-chunks (png-head-chunk 3 1 8 0)))
                 ("row 2 has the filter 5, but filters are 0 to 4"
                  ,(png-file 3 0 '((0 1 2 3) (5 1 2 3)))))
          do (check-complaint words (complaint-of-image image)))))

(test png.sizes-are-checked-before-there-is-memory-for-them
  "The limit holds for PNG, too; and no more than 1032 octets come of one that zlib made."
  (let ((image (corner-png 0 #'list)))
    (check-complaint "the image has 4 by 3 pixels, and the limit is 11"
                     (complaint-of-image image :limit 11))
    (is (null (complaint-of-image image :limit 12))))
  (check-complaint "the pixels take 200005000 bytes, for which 11 bytes of compressed data are too"
                   (complaint-of-image
                    (png-of-chunks (png-head-chunk 5000 5000 16 6)
                                   (png-chunk "IDAT" (stored-by-zlib ""))))))

(defun octets-of-image (image)
  (map 'floors::octets #'char-code image))

(defun png-samples (image)
  "Return the samples of the PNG file IMAGE; NIL if it is refused."
  (let ((input (floors::make-image-input #p"floor.png" (octets-of-image image))))
    (and (floors::png-signature-p input)
         (handler-case (floors::image-samples (floors::read-png input 10000 :trinary))
           (ars:unusable-floor () nil)))))

(defun with-right-sums (image)
  "Return the PNG file IMAGE with check sums that are right, as far as it has chunks."
  (loop with copy = (copy-seq image) and octets = (octets-of-image image)
        for start = 8 then (+ end 4)
        while (< (+ start 8) (length copy))
        for end = (+ start 8 (floors::number-at octets start))
        while (<= (+ end 4) (length copy))
        do (replace copy (octet-string (slow-crc-32 (subseq copy (+ start 4) end)) 4) :start1 end)
        finally (return copy)))

(test png.damage-anywhere-is-refused
  "At 200 places: the same image, or an error of ours. If somebody has made the check sums of the
chunks right again, an image or an error of ours."
  (let* ((image (octets-in-hexadecimal *compressed-png*)) (good (png-samples image))
         (dice (base:make-dice 1996)) (refused 0))
    (dotimes (i 200)
      (let* ((damaged (copy-seq image)) (place (base:roll-index (length image) dice)))
        (setf (char damaged place) (code-char (base:roll-index 256 dice)))
        (let ((samples (png-samples damaged)))
          (is (or (null samples) (equalp good samples)) "at ~D" place)
          (unless samples (incf refused)))
        (png-samples (with-right-sums damaged))
        (png-samples (subseq image 0 place))))
    (is (< 190 refused))))
