;;;; picture-lines.lisp -- PICTURE.

(in-package :ars-magna.cli)

(define-line "PICTURE" (session (file :file "a name that ends in .svg or .png")
                                (scale picture-scale "how large it is; 8 if left out" :optional))
    (:seeing)
    "Save a picture of the world as it is now in FILE, replacing it, SCALE pixels to a cell."
  (let ((path (apply #'save-picture (session-robot) (path-called file)
                     (when scale (list :scale scale)))))
    (format t "~A~%" (native-name path))))
