;;;; pictures-kept.lisp -- an existing file is unchanged if a picture cannot be saved.

(in-package :ars-magna.tests)

(in-suite display)

;; rsvg-convert makes none of more than 32767 pixels.
(defparameter *too-wide*
  "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"40000\" height=\"8\"/>"
  "A picture as an SVG document.")

(test picture.what-was-there-stays-if-a-png-fails
  (in-studio (robot)
    (with-directories (place)
      (let ((file (merge-pathnames "keep.png" place)))
        (ensure-directories-exist file)
        (base:overwrite-file (lambda (out) (write-string "old" out)) file "the file")
        (handler-case (progn (display:save-svg *too-wide* file :png) (fail "It was saved."))
          (base:misuse (condition)
            (let ((words (princ-to-string condition)))
              (is (or (mentions-p words "librsvg2-bin")
                      (and (mentions-p words "larger than 32767 pixels")
                           (mentions-p words "An older file of this name is unchanged")
                           (mentions-p words "Choose a smaller scale")))
                  "~A" words))))
        (is (string= "old" (base:file-text file)))
        (is (equal '("keep.png") (mapcar #'file-namestring (uiop:directory-files place))))))))

(test picture.links-to-nothing-are-refused-in-words
  (in-studio (robot)
    (with-directories (place)
      (let ((link (merge-pathnames "link.svg" place)))
        (ensure-directories-exist link)
        (sb-posix:symlink (base:native-name (merge-pathnames "nothing.svg" place))
                          (base:native-name link))
        (handler-case (progn (display:save-picture robot link) (fail "It was saved."))
          (base:misuse (condition)
            (is (mentions-p (princ-to-string condition) "a link to a file that does not exist"))))
        (sb-posix:unlink (base:native-name link))))))
