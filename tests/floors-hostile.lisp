;;;; floors-hostile.lisp -- floors that cannot be used, and the messages about them.

(in-package :ars-magna.tests)

(in-suite floors)

(defun floor-complaint (description image &rest options)
  "Return what is said of the floor with the texts DESCRIPTION and IMAGE; NIL if it is imported."
  (with-floor (yaml image description)
    (handler-case (progn (apply #'ars:import-map yaml :name 'complained-of options) nil)
      (base:ars-magna-error (condition)
        (is (null (world:find-map 'complained-of nil)))
        (remove #\Newline (text-of condition))))))

(defun check-complaint (words complaint)
  "Claim that the text COMPLAINT has WORDS."
  (is (and complaint (search words complaint)) "~S does not say ~S" complaint words))

(defun complaint-of-image (image &rest options)
  (apply #'floor-complaint (floor-text) image options))

(test description.mistakes-are-told-with-their-lines
  (loop for (words line)
          in '(("line 1: resolution is 0; give how many metres" "resolution: 0")
               ("line 1: resolution is 1#.(exit); give" "resolution: 1#.(exit)")
               ("line 1: resolution is 1e99; give" "resolution: 1e99")
               ("line 1: resolution is empty; give" "resolution:")
               ("line 1: origin is 0.0; give a list" "origin: 0.0")
               ("line 1: origin is [0.0, 0.0]; give a list" "origin: [0.0, 0.0]")
               ("line 1: origin is [0, x, 0]; give a list" "origin: [0, x, 0]")
               ("line 1: origin is [0, , 0]; give a list" "origin: [0,, 0]")
               ("line 1: a list must be complete on one line" "origin: [0.0, 0.0")
               ("line 1: a list must be complete on one line" "origin: [0.0, 0.0] 0")
               ("line 1: negate is 2; give 0" "negate: 2")
               ("line 1: mode is triple; give trinary, scale or raw" "mode: triple")
               ("line 1: mode is [raw]; give trinary" "mode: [raw]")
               ("line 1: occupied_thresh is 1.5; give a probability" "occupied_thresh: 1.5")
               ("line 1: free_thresh is nan; give a probability" "free_thresh: nan")
               ("free_thresh, 0.9, is above occupied_thresh, 0.65; exchange" "free_thresh: 0.9")
               ("line 1: a value that begins with { is not supported" "image: {a: b}")
               ("line 1: a value that begins with * is not supported" "image: *other")
               ("line 1: a value that begins with ! is not supported" "image: !!python/object x")
               ("line 1: the closing quote is missing" "image: 'floor.pgm")
               ("line 1: there is text after the closing quote" "image: 'floor.pgm' x")
               ("line 1: \\n in quotes is not supported" "image: \"floor\\n.pgm\"")
               ("line 1: image is empty; give the name" "image: ''")
               ("no-such.pgm cannot be read: there is no such file" "image: no-such.pgm")
               ("cannot be read: it is a directory" "image: /")
               ("only in ~/, your home directory" "image: ~root/floor.pgm"))
        do (check-complaint words (floor-complaint (floor-text line) (pgm-text *corner*)))))

(test description.damage-is-told
  (flet ((check (words text)
           (check-complaint words (floor-complaint text (pgm-text *corner*)))))
    (check "there is no line with the key image; add a line such as image: floor.pgm" "")
    (check "the key resolution (did you mean resolutoin?); add a line such as resolution: 0.05"
           (concatenate 'string "resolutoin: 3" (string #\Newline)
                        (remove-line "resolution: 0.05" (floor-text))))
    (check "line 7: negate is on line 4 already" (format nil "~Anegate: 1~%" (floor-text)))
    (check "line 1: \"  negate: 0\" must be a key at the left edge"
           (format nil "  negate: 0~%~A" (floor-text)))
    (check "line 2: \"floor\" must be a key at" (format nil "# x~%floor~%"))
    (check "line 1: an item of a list has no key above it" (format nil "- 1~%~A" (floor-text)))
    (check "line 7: an item of a list has no key above it" (format nil "~A- 1~%" (floor-text)))
    (check "floor.yaml, line 2: the file has bytes that are not UTF-8. Save the file in UTF-8."
           (format nil "# x~%# ~C~%~A" (code-char 255) (floor-text)))
    (check "it is an image; (import-map FILE) reads the .yaml that names it" (pgm-text *corner*))
    (check "the file has 70000 bytes, and the description of a floor has at most 65536"
           (make-string 70000 :initial-element #\Newline))))

(test description.that-the-system-does-not-let-be-read-is-refused-in-plain-words
  (handler-case (progn (ars:import-map "/proc/self/mem") (fail))
    (ars:unusable-floor (condition)
      (is (search "mem: the system forbids reading it; give another file."
                  (princ-to-string condition))))))

(test image.given-where-a-run-is-read-is-told-from-its-description
  (with-floor (yaml (pgm-text *corner*))
    (let ((image (make-pathname :type "pgm" :defaults yaml)))
      (dolist (reader '(ars:load-journal ars:load-simulation))
        (handler-case (progn (funcall reader image) (fail))
          (run:damaged-file (condition)
            (is (search "it is an image; (import-map FILE) reads the .yaml"
                        (princ-to-string condition)))))))))

(defun remove-line (line text)
  "Return TEXT without LINE."
  (format nil "~{~A~^~%~}" (remove line (uiop:split-string text :separator '(#\Newline))
                                   :test #'string=)))

(test image.damage-is-told
  (loop for (words . image)
          in `(("the first bytes of the image are not those of a PGM file" . "")
               ("save it in such a format, for example by: convert"
                . ,(format nil "~CPNG" (code-char #x89)))
               ("the first bytes of the image are not those of a PGM file" . "P6 1 1 255 aaa")
               ("at byte 2 there is no number that could be the width" . "P5x1 1 255 a")
               ("no number that could be the height" . "P5 1 -1 255 a")
               ("the width has more than 9 digits" . "P5 1234567890 1 255 a")
               ("no number that could be the greatest value" . "P5 1 1")
               ("the image has 0 by 4 pixels" . "P5 0 4 255 ")
               ("the greatest value of a pixel is 0; save" . "P2 1 1 0 0")
               ("the greatest value of a pixel is 65536; save" . "P2 1 1 65536 0")
               ("a pixel has the value 256, above the greatest, 255" . "P2 1 1 255 256")
               ("a pixel has the value 101, above the greatest, 100" . ,(format nil "P5 1 1 100 e"))
               ("the image has only 3 of the 4 values" . "P2 2 2 255 1 2 3")
               ("continues after the 4 values" . "P2 2 2 255 1 2 3 4 5")
               ("no number that could be a value" . "P2 2 2 255 1 2 3 -4")
               ("announces 4 bytes of pixels, but 3 follow" . "P5 2 2 255 abc")
               ("announces 4 bytes of pixels, but 6 follow" . "P5 2 2 255 abcdef")
               ("announces 8 bytes of pixels, but 4 follow" . "P5 2 2 256 abcd")
               ("the image has 99999 by 99999 pixels, and the limit is 25000000; cut out what you ~
                 need, or give IMPORT-MAP a higher :limit" . "P5 99999 99999 255 a"))
        do (check-complaint (format nil words) (complaint-of-image image)))
  (check-complaint "the image has 4 by 3 pixels, and the limit is 11"
                   (complaint-of-image (pgm-text *corner*) :limit 11))
  (is (null (complaint-of-image (pgm-text *corner*) :limit 12)))
  (check-complaint "has 100000 bytes, too many for the limit of 12 pixels"
                   (complaint-of-image (make-string 100000) :limit 12))
  (check-complaint "a map of 40000 cells in a row or column, and maps have at most 32767"
                   (complaint-of-image (format nil "P5 40000 1 255 ~A" (make-string 40000)))))

(test options.mistakes-are-told
  (loop for (words . options)
          in '(("pixels is 0; give the width of a cell in pixels" :pixels 0)
               ("cell is 0; give the width of a cell in metres" :cell 0)
               ("cell is 1; give the width of a cell in metres" :cell 1 :pixels 2)
               ("cell is 0.12; give a multiple of 0.05, the width of a pixel in metres, such as"
                :cell .12)
               ("share is 2; give a number from 0 to 1" :share 2)
               ("no substance called slat. Did you mean slate?" :substance slat)
               ("substance is 5; give the name of a substance" :substance 5)
               ("X); give the name of a substance" :unknown (ars:glass x))
               ("1 2); give the name of a substance" :unknown (ars:glass 1 2))
               ("limit is 0; give an integer" :limit 0)
               ("expected a clause: wall, rect, circle or obj" :clauses ((wal (0 0)))))
        do (check-complaint words (apply #'complaint-of-image (pgm-text *corner*) options)))
  (with-floor (yaml (pgm-text *corner*))
    (signals base:wrong-argument (ars:import-map yaml :name :key))
    (signals base:wrong-argument (ars:import-map (rename-file yaml "2.yaml"))))
  (signals base:wrong-argument (ars:import-map 7))
  (dolist (file (list "no-such-floor.yaml" "~nobody/floor.yaml" "" (uiop:temporary-directory)
                      (make-pathname :name :wild :type "yaml")))
    (signals ars:unusable-floor (ars:import-map file))))

(test home.is-known
  (is (string= (base:native-name (merge-pathnames "a/b.yaml" (user-homedir-pathname)))
               (base:native-name (floors::resolve-file-name "~/a/b.yaml")))))

(test export.mistakes-are-told
  (with-own-definitions
    (eval '(world:defmap plain-room (6 5) (rect (0 0) (5 4) slate 1)))
    (signals base:unknown-name (ars:export-map 'no-such-room "room.yaml"))
    (signals base:wrong-argument (ars:export-map 5 "room.yaml"))
    (signals base:wrong-argument (ars:export-map 'plain-room "room.pgm"))
    (signals base:wrong-argument (ars:export-map 'plain-room 5))
    (signals base:unknown-name (ars:export-map 'plain-room "room.yaml" :unknown 'glas))
    (signals ars:unusable-floor (ars:export-map 'plain-room "/no/such/directory/room.yaml"))))

(test export.refused-leaves-the-image-as-it-was
  (with-own-definitions
    (eval '(world:defmap plain-room (6 5) (rect (0 0) (5 4) slate 1)))
    (uiop:with-temporary-file (:pathname file :type "pgm" :stream out)
      (write-string "another map" out)
      :close-stream
      (let* ((description (make-pathname :type "yaml" :defaults file))
             (folder (uiop:ensure-directory-pathname (base:native-name description))))
        (ensure-directories-exist folder)
        (unwind-protect
             (signals ars:unusable-floor (ars:export-map 'plain-room description))
          (uiop:delete-empty-directory folder))
        (is (equal '("another map") (uiop:read-file-lines file)))))))

(test export.replaces-a-pair-and-nothing-else
  "Also a pair whose description somebody has written; but no image that it does not name."
  (with-own-definitions
    (eval '(world:defmap plain-room (6 5) (rect (0 0) (5 4) slate 1)))
    (call-in-directory
     (lambda (directory)
       (let ((description (merge-pathnames "room.yaml" directory))
             (image (merge-pathnames "room.pgm" directory)))
         (flet ((put (file text)
                  (base:call-replacing-file (lambda (out) (write-string text out)) file))
                (refused-p (words file)
                  (let ((text (base:read-file-into-string file)))
                    (handler-case (progn (ars:export-map 'plain-room description) nil)
                      (ars:unusable-floor (condition)
                        (and (search words (princ-to-string condition))
                             (string= text (base:read-file-into-string file))))))))
           (put image "my drawing")
           (is-true (refused-p "room.pgm: the file is not the image of " image))
           (is (null (base:existing-path description)))
           (put description (format nil "# mine~%image: other.pgm~%"))
           (is-true (refused-p "room.yaml: the file is not the description of " description))
           (put description (format nil "# mine~%image: room.pgm~%"))
           (is-true (refused-p "room.pgm: the file is not a PGM or PNG image" image))
           (dolist (beginning '("" "P2 1 1 255 0" "P5 "))
             (put image beginning)
             (is-true (ars:export-map 'plain-room description)))
           (is-true (ars:export-map 'plain-room description))
           (is-true (ars:export-map 'plain-room description))
           (put description "notes: none")
           (is-true (refused-p "room.yaml: the file is not the description of a map"
                               description))))))))

(test export.leaves-the-description-of-another-image
  "Though nothing is called as the new image: by its name, through a link, and if it names none."
  (with-own-definitions
    (eval '(world:defmap plain-room (6 5) (rect (0 0) (5 4) slate 1)))
    (call-in-directory
     (lambda (directory)
       (flet ((file (name) (base:native-name (merge-pathnames name directory)))
              (put (file text)
                (base:call-replacing-file (lambda (out) (write-string text out)) file)))
         (put (file "floor.png") "PNG")
         (put (file "floor.yaml") "")
         (sb-posix:symlink (file "floor.yaml") (file "link.yaml"))
         (dolist (text '("image: floor.png" "image: gone.png" "image: floor.pgm.png" "image:"))
           (put (file "floor.yaml") text)
           (dolist (name '("floor.yaml" "link.yaml"))
             (signals ars:unusable-floor (ars:export-map 'plain-room (file name))))
           (is (string= text (base:read-file-into-string (file "floor.yaml"))))
           (is (null (base:existing-path (file "floor.pgm"))))))))))

(test export.through-a-link-writes-the-pair-beside-its-target
  (with-own-definitions
    (eval '(world:defmap plain-room (6 5) (rect (0 0) (5 4) slate 1)))
    (call-in-directory
     (lambda (directory)
       (flet ((file (name) (base:native-name (merge-pathnames name directory)))
              (put (file text)
                (base:call-replacing-file (lambda (out) (write-string text out)) file)))
         (ensure-directories-exist (file "sub/"))
         (put (file "sub/real.yaml") "image: real.pgm")
         (sb-posix:symlink (file "sub/real.yaml") (file "room.yaml"))
         (is (equal (list (file "sub/real.yaml") (file "sub/real.pgm"))
                    (mapcar #'base:native-name
                            (multiple-value-list
                             (ars:export-map 'plain-room (file "room.yaml"))))))
         (is (null (base:existing-path (file "room.pgm"))))
         (is-true (ars:import-map (file "room.yaml") :name 'plain-room))
         (put (file "notes.pgm") "my notes")
         (delete-file (file "sub/real.pgm"))
         (sb-posix:symlink (file "notes.pgm") (file "sub/real.pgm"))
         (signals ars:unusable-floor (ars:export-map 'plain-room (file "room.yaml")))
         (is (string= "my notes" (base:read-file-into-string (file "notes.pgm")))))))))

(test relative-names.begin-where-lisp-says
  (with-own-definitions
    (eval '(world:defmap plain-room (6 5) (rect (0 0) (5 4) slate 1)))
    (call-in-directory
     (lambda (directory)
       (let ((*default-pathname-defaults* directory))
         (is (equal (truename directory)
                    (uiop:pathname-directory-pathname (ars:export-map 'plain-room "room.yaml"))))
         (is-true (ars:import-map "room.yaml" :name 'plain-room)))))))

(defun spoiled-text (text dice)
  "Return TEXT with some characters changed, left out or put in, as DICE say."
  (dotimes (i (1+ (base:roll-index 4 dice)) text)
    (let ((place (base:roll-index (length text) dice))
          (char (string (code-char (base:roll-index 256 dice)))))
      (setf text (concatenate 'string (subseq text 0 place)
                              (if (base:chance 2/3 dice) char "")
                              (subseq text (if (base:chance 1/2 dice) place (1+ place))))))))

(test floor.damage-is-refused-or-harmless
  "Whatever becomes of the bytes, there is a map of the image's size, or an error of ours."
  (let ((dice (base:make-dice 77)) (refused 0) (used 0)
        (*package* (find-package :ars-magna.tests)))
    (dotimes (i 400)
      (let* ((description (floor-text)) (image (if (evenp i) (pgm-text *corner*)
                                                   (pgm-octets *corner*)))
             (complaint (if (base:chance 1/2 dice)
                            (floor-complaint (spoiled-text description dice) image)
                            (complaint-of-image (spoiled-text image dice)))))
        (if complaint (incf refused) (incf used))))
    (is (< 50 refused))
    (is (< 20 used))))
