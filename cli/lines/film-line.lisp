;;;; film-line.lisp -- FILM: the run so far, to be played in a browser.

(in-package :ars-magna.cli)

(define-line "FILM" (session (file :file "a name that ends in .html or .svg"))
    (:seeing)
    "Save the run so far in FILE, replacing it, as a film: a page for any browser, in which it can
be played, stopped and gone through, or an animated picture. What robots grasped, let go of and
stowed, and which commands failed, is marked."
  (check-run)
  (format t "~A~%" (native-name (save-animation nil (path-called file)))))
