;;;; film-line.lisp -- FILM: the run so far, to be played in a browser.

(in-package :ars-magna.cli)

(define-line "FILM" (session (file :file "a name that ends in .html or .svg")
                             (what :rest "pixels to a cell, and names of layers; BARE" :optional))
    (:seeing)
    "Save the run so far in FILE, replacing it, as a film: a page for any browser, in which it can
be played, stopped and gone through, or an animated picture. What robots grasped, let go of and
stowed, which commands and plans failed, and errors in your code are marked. The words after FILE
are those of PICTURE."
  (check-run)
  (format t "~A~%" (native-name (apply #'save-animation nil (path-called file)
                                       (picture-options what "FILM")))))
