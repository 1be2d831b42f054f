;;;; window.lisp -- how fast the window paints, on a machine with McCLIM and an X display.

;;; Does not run by default. The measurements are in window-figures.lisp, which names McCLIM's
;;; packages and is loaded only if McCLIM is found.

(in-package :ars-magna.benchmarks)

(defun what-is-missing ()
  "Return a sentence about what the window lacks on this machine, or NIL."
  (let ((display (sb-ext:posix-getenv "DISPLAY")))
    (cond ((null (asdf:find-system "mcclim/looks" nil))
           "McCLIM is not installed: the window is not measured.")
          ((or (null display) (string= display ""))
           "There is no X display (DISPLAY is not set): the window is not measured."))))

(let ((missing (what-is-missing)))
  (cond (missing (format t "~&~A~%" missing))
        (t (asdf:load-system "ars-magna/clim")
           (load (merge-pathnames "../clim-client.lisp" *load-truename*))
           (load (merge-pathnames "window-figures.lisp" *load-truename*)))))
