;;;; window-system.lisp -- getting the system that opens windows, where McCLIM is to be had.

(in-package :ars-magna.cli)

;;; Neither this program nor its tests need McCLIM. It is found by ASDF, or through a Quicklisp that
;;; is installed. The program's own second core, for --window, has it already; the first one, and a
;;; Lisp of the user's, load it when somebody wants a window.

(defun configure-asdf ()
  "In this program, let ASDF find the project, and what has been compiled of it."
  (when (find-package :ars-magna.build)
    (uiop:symbol-call :ars-magna.build :configure)))

(defun call-or-say (function trouble)
  "Call FUNCTION, which compiles and loads libraries, in Lisp's own syntax. What the compiler says
is of no interest. If that fails, signal BAD-LINE with TROUBLE, the control string of a text that
says why."
  (handler-case
      (let ((*standard-output* (make-broadcast-stream)) (*error-output* (make-broadcast-stream))
            (*package* (find-package :cl-user))
            (*readtable* (copy-readtable nil))
            (*read-default-float-format* 'single-float))
        (handler-bind ((warning #'muffle-warning)) (funcall function)))
    (error (condition)
      (reject-line trouble (one-line (condition-text condition))))))

(defun load-windows (quicklisp-p)
  "Load the system of windows, and McCLIM through Quicklisp before if QUICKLISP-P."
  (when quicklisp-p
    (call-or-say #'ars-magna.clx:get-by-quicklisp
                 "No window: Quicklisp could not get McCLIM (~A). Is the network there? Then say ~
                  WINDOW again."))
  (call-or-say (lambda () (asdf:load-system "ars-magna/clim"))
               "No window: McCLIM is there, but cannot be loaded: ~A"))

;; Read when this file is loaded, so that a saved program has it with it.
(defparameter *how-to-get-windows*
  (file-text (asdf:system-relative-pathname "ars-magna" "cli/prompt/usage-window.txt"))
  "What is to be done where McCLIM is not installed.")

(defun reject-unfit-clx ()
  "Signal BAD-LINE if the CLX that would be loaded is known not to work."
  (let ((trouble (ars-magna.clx:clx-trouble)))
    (when trouble (reject-line "No window: ~A" trouble))))

(defun ensure-windows ()
  "Let there be something that opens windows. Signals BAD-LINE if there is no X server or McCLIM, or
if CLX does not work."
  (unless *display-opener*
    (when (member (environment-value "DISPLAY") '(nil "") :test #'equal)
      (reject-line "No display: the environment variable DISPLAY names no X server. MAP draws the ~
                    world here, PICTURE in a file."))
    (configure-asdf)
    (let ((found-p (ars-magna.clx:find-library "mcclim/looks")))
      (unless (or found-p (find-package :quicklisp) (ars-magna.clx:quicklisp-file))
        (write-string *how-to-get-windows*)
        (reject-line "No window: McCLIM is not installed; what is to be done stands above."))
      (reject-unfit-clx)
      (format t "Loading what windows need; the first time that takes some minutes.~%")
      (finish-output)
      (load-windows (not found-p)))))
