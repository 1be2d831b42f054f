;;;; scales.lisp -- how many pixels a cell has, as far as users say so.

(in-package :ars-magna.display)

(define-constant +usual-scale+ 8 :documentation "What GRAPHICS-SCALE* is until a user sets it.")

(define-argument-type 'picture-scale (lambda (value) (and (finite-p value) (<= 1 value 256)))
  "a number of pixels to a cell, from 1 to 256")

(defun users-scale ()
  "Return GRAPHICS-SCALE* if the user has set it to another value than the default, or NIL. Signals
MISUSE if that is no scale."
  (cond ((eql graphics-scale* +usual-scale+) nil)
        ((argument-of-type-p graphics-scale* 'picture-scale) graphics-scale*)
        (t (reject-use "graphics-scale* is ~S, but should be ~A. Set it to such a number, or to ~
                        ~D: then pictures have the scale that suits their map."
                       graphics-scale* (argument-type-text 'picture-scale) +usual-scale+))))

(defun check-scale (operator scale)
  "Signal WRONG-ARGUMENT if SCALE, an argument of OPERATOR, is neither a scale nor NIL."
  (unless (or (null scale) (argument-of-type-p scale 'picture-scale))
    (reject-argument operator "scale" scale (argument-type-text 'picture-scale))))
