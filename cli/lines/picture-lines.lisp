;;;; picture-lines.lisp -- PICTURE and DISPLAY.

(in-package :ars-magna.cli)

(define-line "PICTURE" (session (file :token "a name that ends in .svg or .png")
                                (scale picture-scale "how large it is; 8 if left out" :optional))
    (:seeing)
    "Save a picture of the world as it is now in FILE, replacing it, SCALE pixels to a cell."
  (let ((path (apply #'save-picture (session-robot) (path-called file)
                     (when scale (list :scale scale)))))
    (format t "~A~%" (native-name path))))

(define-line "DISPLAY" (session) (:seeing)
    "Show the robot and its world in a window, where there is one to be had."
  (open-display (session-robot)))
