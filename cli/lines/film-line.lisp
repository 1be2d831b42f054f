;;;; film-line.lisp -- FILM: the run so far, to be played in a browser.

(in-package :ars-magna.cli)

(define-line "FILM" (session (file :file "a name that ends in .html or .svg")
                             (what :rest "pixels to a cell, names of layers; BARE; ANYWAY"
                                   :optional))
    (:seeing)
    "Save the run so far in FILE, replacing it, as a film: a page for any browser, in which it can
be played, stopped and gone through, or an animated picture. What robots grasped, let go of and
stowed, which commands and plans failed, and errors in your code are marked. The words after FILE
are those of PICTURE, and ANYWAY: also if what is defined is not what the run began with."
  (check-run)
  (let* ((words (split-words (or what "")))
         (others (remove "ANYWAY" words :test #'string-equal))
         (options (picture-options (format nil "~{~A~^ ~}" others) "FILM")))
    (flet ((save (*frame-hook*)
             (apply #'save-animation nil (path-called file)
                    :anyway (/= (length words) (length others)) options)))
      (format t "~A~%" (native-name (call-telling-ticks
                                     #'save session (simulation-tick (current-simulation))))))))
