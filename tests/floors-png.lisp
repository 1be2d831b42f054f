;;;; floors-png.lisp -- floors whose image is a PNG file.

(in-package :ars-magna.tests)

(in-suite floors)

;;; PNG files, written here as strings with a character for each octet. Their data is not compressed
;;; but in zlib's stored blocks.

(defun octet-string (number count &key low-first)
  "Return NUMBER as COUNT octets, the high one first unless LOW-FIRST."
  (let ((octets (loop for place below count
                      collect (code-char (ldb (byte 8 (* 8 place)) number)))))
    (coerce (if low-first octets (reverse octets)) 'string)))

(defun octets-as-string (octets)
  (map 'string #'code-char octets))

(defun slow-crc-32 (text)
  "Return the CRC-32 of TEXT, bit by bit."
  (let ((crc #xFFFFFFFF))
    (loop for char across text
          do (setf crc (logxor crc (char-code char)))
             (loop repeat 8
                   do (setf crc (if (oddp crc) (logxor #xEDB88320 (ash crc -1)) (ash crc -1)))))
    (logxor crc #xFFFFFFFF)))

(defun adler-32 (text)
  (let ((a 1) (b 0))
    (loop for char across text
          do (setf a (mod (+ a (char-code char)) 65521)
                   b (mod (+ a b) 65521)))
    (logior (ash b 16) a)))

(defun png-chunk (name content)
  (let ((text (concatenate 'string name content)))
    (concatenate 'string (octet-string (length content) 4) text
                 (octet-string (slow-crc-32 text) 4))))

(defun stored-block (text last-p)
  (concatenate 'string (octet-string (if last-p 1 0) 1)
               (octet-string (length text) 2 :low-first t)
               (octet-string (logxor #xFFFF (length text)) 2 :low-first t) text))

(defun stored-by-zlib (text)
  "Return TEXT as zlib keeps it, not compressed."
  (format nil "~A~{~A~}~A" (octets-as-string '(#x78 1))
          (loop for start from 0 to (length text) by 65535
                for end = (min (length text) (+ start 65535))
                collect (stored-block (subseq text start end) (= end (length text))))
          (octet-string (adler-32 text) 4)))

(defun png-signature ()
  (octets-as-string '(137 80 78 71 13 10 26 10)))

(defun png-head-chunk (width height depth colour &optional (manner '(0 0 0)))
  (png-chunk "IHDR" (concatenate 'string (octet-string width 4) (octet-string height 4)
                                 (octets-as-string (list* depth colour manner)))))

(defun png-file (width colour rows &key (depth 8) (chunks "") (manner '(0 0 0)))
  "Return the PNG file of WIDTH, of the type COLOUR, with ROWS: lists of a filter and octets."
  (concatenate 'string (png-signature)
               (png-head-chunk width (length rows) depth colour manner) chunks
               (png-chunk "IDAT" (stored-by-zlib (octets-as-string (apply #'append rows))))
               (png-chunk "IEND" "")))

(defun png-palette-chunk (&rest octets)
  (png-chunk "PLTE" (octets-as-string octets)))

(defun corner-png (colour pixel &rest options)
  "Return *CORNER* as a PNG file of the type COLOUR; PIXEL returns the octets for one of grey."
  (apply #'png-file 4 colour
         (loop for row in *corner* collect (cons 0 (loop for grey in row
                                                         append (funcall pixel grey))))
         options))

;;; What is read.

(test png.is-read-as-pgm-is
  "Grey, red, green and blue, a palette, with and without alpha, of 8 and 16 bits."
  (flet ((check (image &rest lines)
           (with-floor (yaml image (apply #'floor-text lines))
             (is (equal *corner-rows* (imported-rows yaml)) "~S" image))))
    (check (corner-png 0 #'list))
    (check (corner-png 0 (lambda (grey) (list grey 77)) :depth 16))
    (check (corner-png 2 (lambda (grey) (list grey grey grey))))
    (check (corner-png 2 (lambda (grey) (list grey 0 grey 0 grey 0)) :depth 16))
    (check (corner-png 3 (lambda (grey) (list (position grey '(0 205 254))))
                       :chunks (png-palette-chunk 0 0 0 205 205 205 254 254 254)))
    (check (corner-png 4 (lambda (grey) (list grey 255))) "mode: scale" "occupied_thresh: 0.5"
           "free_thresh: 0.1")
    (check (corner-png 4 (lambda (grey) (list grey 0 255 255)) :depth 16) "mode: scale")
    (check (corner-png 6 (lambda (grey) (list grey grey grey (if (= 205 grey) 0 255))))
           "mode: scale")))

(test png.is-known-by-its-first-bytes
  "The image here is called floor.pgm. What may be left out is passed over."
  (with-floor (yaml (corner-png 0 #'list :chunks (concatenate 'string (png-chunk "tEXt" "by: me")
                                                              (png-chunk "prVt" ""))))
    (is (equal *corner-rows* (imported-rows yaml))))
  (check-complaint "floor.yaml: it is an image; (import-map FILE) reads the .yaml that names it"
                   (floor-complaint (corner-png 0 #'list) "")))

(defun states-of-png (image &rest lines)
  "Return the first row of the floor with IMAGE, whose description has LINES."
  (with-floor (yaml image (apply #'floor-text lines))
    (first (imported-rows yaml))))

(test png.data-may-be-in-several-chunks
  "As large images have it, also in the middle of what zlib has made, or empty ones."
  (let ((data (stored-by-zlib (octets-as-string '(0 0 205 254)))))
    (is (string= "#u." (states-of-png
                        (format nil "~A~A~{~A~}~A" (png-signature) (png-head-chunk 3 1 8 0)
                                (loop for (start end) in `((0 1) (1 9) (9 9) (9 ,(length data)))
                                      collect (png-chunk "IDAT" (subseq data start end)))
                                (png-chunk "IEND" "")))))))

(test png.of-few-bits-is-read
  "Also in rows that end within an octet."
  (is (string= "#.##.#.#..#"
               (states-of-png (png-file 11 0 '((0 #b01001010 #b11011111)) :depth 1))))
  (is (string= "#u.#." (states-of-png (png-file 5 0 '((0 #b00011100 #b11000000)) :depth 2)
                                      "occupied_thresh: 0.7")))
  (is (string= "#u." (states-of-png (png-file 3 0 '((0 #x0B #xF0)) :depth 4))))
  (is (string= "#.u" (states-of-png
                      (png-file 3 3 '((0 #b00100100)) :depth 2
                                :chunks (png-palette-chunk 0 0 0 200 200 200 255 255 255))))))

(test png.colours-are-averaged
  "As ROS's nav2_map_server does: the mean of 255, 255 and 0 is 170, of 255, 0 and 0 it is 85."
  (let ((rows '((0 255 255 0 255 0 0 255 255 254))))
    (is (string= "u#." (states-of-png (png-file 3 2 rows))))
    (is (string= "uu." (states-of-png (png-file 3 2 rows) "occupied_thresh: 0.6667")))
    (is (string= "##." (states-of-png (png-file 3 2 rows) "occupied_thresh: 0.3333"))))
  (is (string= "u#." (states-of-png (png-file 3 2 '((0 170 255 0 102 102 0 0 5 10)))
                                    "mode: raw" "occupied_thresh: 0.65"))))

(test png.alpha-counts-as-ros-has-it
  "In the mode trinary it is averaged in, in scale what is not opaque is unknown, in raw it is
of no account."
  (let ((image (png-file 4 6 '((0 0 0 0 255 0 0 0 0 255 255 255 0 205 205 205 255)))))
    (is (string= "##u." (states-of-png image)))
    (is (string= "#uuu" (states-of-png image "mode: scale")))
    (is (string= "..uu" (states-of-png image "mode: raw"))))
  (is (string= "#u." (states-of-png (png-file 3 4 '((0 0 255 255 254 255 255))) "mode: scale"))))

(test png.transparency-of-greys-and-palettes-is-read
  (let ((palette (png-palette-chunk 0 0 0 255 255 255 255 255 255)))
    (is (string= "u.u" (states-of-png
                        (png-file 3 3 '((0 0 2 1))
                                  :chunks (concatenate 'string palette
                                                       (png-chunk "tRNS"
                                                                  (octets-as-string '(0 254)))))
                        "mode: scale"))))
  (is (string= "#u." (states-of-png (png-file 3 0 '((0 0 254 255))
                                              :chunks (png-chunk "tRNS"
                                                                 (octets-as-string '(0 254))))
                                    "mode: scale"))))

(test png.transparency-of-16-bits-is-read
  "The value that is transparent is all of it; how opaque the others are is their high eight bits."
  (is (string= "#u." (states-of-png (png-file 3 0 '((0 0 1 254 2 254 3)) :depth 16
                                              :chunks (png-chunk "tRNS"
                                                                 (octets-as-string '(254 2))))
                                    "mode: scale")))
  (is (string= "#u." (states-of-png (png-file 3 4 '((0 0 9 255 255 254 9 127 255 254 9 255 255))
                                              :depth 16)
                                    "mode: scale"))))

(test png.filters-are-undone
  "The same rows by each filter: nothing, the left, above, their mean, the likeliest of three."
  (let ((expected (states-with '(0 254 205 254))))
    (loop for rows in '(((0 0 254 205 254))
                        ((1 0 254 207 49))
                        ((2 0 254 205 254))
                        ((3 0 254 78 152))
                        ((4 0 254 207 49)))
          do (is (string= expected (states-of-png (png-file 4 0 rows))) "~S" rows))
    (loop for second in '((0 0 254 205 254) (1 0 254 207 49) (2 206 0 205 0) (3 231 127 78 25)
                          (4 206 0 205 0))
          do (with-floor (yaml (png-file 4 0 (list '(0 50 254 0 254) second)))
               (is (equal expected (second (imported-rows yaml))) "~S" second)))))

(defparameter *compressed-png*
  (format nil "89504e470d0a1a0a0000000d4948445200000028000000140800000000da2d20670000000467~
               414d4100000001fc2250db000000c24944415478da8d91610ec3200885d91bd97d76aa1da23f~
               8c07ec850c2103ecaa33b5edab122414fc84e8a61eb4eefe3b2cf4280fa0216fa6277d86bc9c~
               8ef232dfabe75a43ba8bf4483f98aede294cdf574f60aeef5761fef3a03398f1da3398b1c0f5~
               64e86232e320e69311ae0d85cd1377ed102624c476f077f3fb3702ea5c2dea6b83292cf15510~
               9497d5b66da678a9c281e730c2609088b92aea3f708956ec9dd8670587c98a440b033909678b~
               198c66012c8c0d6c81c1b40742ac1640e7d317b25ba4f67cd840df0000000049454e44ae4260~
               82")
  "A PNG file of 40 by 20 pixels of grey in hexadecimal, that zlib has compressed, with a dynamic
table. Its rows have the filters 0 to 4 in turn.")

(defun octets-in-hexadecimal (text)
  (octets-as-string (loop for place below (length text) by 2
                          collect (parse-integer text :start place :end (+ 2 place) :radix 16))))

(test png.that-zlib-compressed-is-read
  (with-floor (yaml (octets-in-hexadecimal *compressed-png*))
    (multiple-value-bind (map report) (ars:import-map yaml :name 'compressed :unknown 'glass)
      (is (equal '(40 20) (list (world:map-width map) (world:map-height map))))
      (is (equal '(585 160 55) (loop for key in '(:free :occupied :unknown)
                                     collect (getf report key))))
      (loop for (y row) in '((3 "#uuuuuuuu........#.....................#")
                         (8 "#uuu...................................#")
                         (15 "#...#.#.........##.........#...........#")
                         (19 "########################################"))
            do (is (string= row (nth y (wall-rows map))))))))

(test png.of-many-rows-is-read
  "More than are decompressed at a time, each one darker than that above it."
  (let ((rows (cons (cons 0 (make-list 400 :initial-element 250))
                    (loop repeat 399 collect (cons 2 (make-list 400 :initial-element 255))))))
    (with-floor (yaml (png-file 400 0 rows))
      (let ((image (floors::read-image (merge-pathnames "floor.pgm" yaml) 160000 :trinary)))
        (is (equal '(400 400 255) (list (floors::image-width image) (floors::image-height image)
                                        (floors::image-white image))))
        (is (loop for index from 0
                  for sample across (floors::image-samples image)
                  always (= sample (mod (- 250 (floor index 400)) 256))))))))
