;;;; terminal.lisp -- the size of the terminal's window, and how wide characters are in it.

(in-package :ars-magna.host)

(export '(rows-and-columns char-width))

(defconstant +ask-for-size+ (if (uiop:featurep :linux) #x5413 #x40087468)
  "The number of the system's request for the size of a terminal's window.")

(defun rows-and-columns ()
  "Return how many rows and columns the window of this process's terminal has; zeros if the system
does not know."
  (sb-alien:with-alien ((size (array sb-alien:unsigned-short 4)))
    (setf (sb-alien:deref size 0) 0
          (sb-alien:deref size 1) 0)
    (sb-alien:alien-funcall
     (sb-alien:extern-alien "ioctl" (function sb-alien:int sb-alien:int sb-alien:unsigned-long
                                              (* (array sb-alien:unsigned-short 4))))
     1 +ask-for-size+ (sb-alien:addr size))
    (values (sb-alien:deref size 0) (sb-alien:deref size 1))))

(defun char-width (char)
  "Return how many columns of a terminal CHAR takes: 0 for accents, 2 for characters of East Asia."
  (cond ((member (internal (:sb-unicode #:general-category) char) '(:mn :me :cf)) 0)
        ((member (internal (:sb-unicode #:east-asian-width) char) '(:w :f)) 2)
        (t 1)))
