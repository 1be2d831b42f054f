;;;; connecting.lisp -- CLIM's port to the X server, and what is said if there is none.

(in-package :ars-magna.clim)

;;; If the X server cannot be reached, another value of DISPLAY may help. If it answers and a
;;; library fails then, only another library does.

(deftype program-fault ()
  "Errors of a program, not of what it is connected to."
  '(or type-error cell-error program-error control-error arithmetic-error))

(defun clx-fails-p ()
  "True if CLX by itself cannot read a long answer of the X server: which keys are down takes 40
bytes, and CLX reads 32 of them first."
  (handler-case (let ((display (xlib:open-default-display)))
                  (unwind-protect (xlib:query-keymap display)
                    (xlib:close-display display :abort t))
                  nil)
    (program-fault () t)
    (error () nil)))

(defun words-for-fault (condition clx-fails-p)
  "Return what is said of CONDITION, with which McCLIM fails on an X server that answers: that CLX
is at fault if CLX-FAILS-P."
  (format nil "No window: ~A fails on SBCL ~A, though the X server ~A answers (~A).~@[ ~A~]"
          (ars-magna.clx:library-text (if clx-fails-p "CLX" "McCLIM"))
          (lisp-implementation-version)
          (environment-value "DISPLAY")
          (one-line-text condition)
          (and clx-fails-p ars-magna.clx:*clx-remedy*)))

(defun words-for-no-port (condition)
  "Return what is said if CONDITION came up when CLIM's port was opened."
  (typecase condition
    (program-fault (words-for-fault condition (clx-fails-p)))
    (xlib:connection-failure
     (format nil "No display: the X server ~A, which DISPLAY names, refuses the connection (~A)."
             (environment-value "DISPLAY") (one-line-text condition)))
    (t (format nil "No display: the X server ~A, which DISPLAY names, does not answer (~A). ~
                    Start it, or set DISPLAY to another."
               (environment-value "DISPLAY") (one-line-text condition)))))

(defun window-port ()
  "Return CLIM's port to the X server. Signals MISUSE if there is none."
  (unless (or clim:*default-server-path*
              (not (member (environment-value "DISPLAY") '(nil "") :test #'equal)))
    (reject-use "No display: there is no X server; set the environment variable DISPLAY."))
  (handler-case (clim:find-port)
    (error (condition) (reject-use "~A" (words-for-no-port condition)))))
