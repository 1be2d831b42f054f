;;;; scaling.lisp -- measured numbers of any size, for statistics that take those up to 1e15.

(in-package :ars-magna.experiment)

;;; Large numbers are multiplied by a power of two, which changes no digit. Results are divided by
;;; it. Beside them, what is some 1e250 times smaller counts as 0.

(defun nearest-float (number)
  "Return the double-float nearest to NUMBER; the same number, exact, if it is too large for one."
  (if (finite-p number) (double number) number))

(defun number-less (a b)
  "Return A less B: a float if one of them is, unless it is too large for one."
  (if (and (rationalp a) (rationalp b))
      (- a b)
      (nearest-float (- (rational a) (rational b)))))

(defun scale-for (numbers)
  "Return by which power of two to multiply NUMBERS so that none is above 5e14 either way."
  (let ((largest (reduce #'max numbers :key #'abs :initial-value 0)))
    (if (<= largest (/ +largest-quantity+ 2))
        1
        (expt 2 (- 48 (integer-length (ceiling (rational largest))))))))

(defun scaled (number scale)
  "Return NUMBER times SCALE; 0 if that is too small for a float."
  (if (= 1 scale)
      number
      (let ((product (* (rational number) scale)))
        (if (< (abs product) #.(expt 2 -900)) 0 (double product)))))

(defun unscaled (number scale)
  "Return NUMBER divided by SCALE; NIL of NIL."
  (if (or (null number) (= 1 scale))
      number
      (nearest-float (/ (rational number) scale))))
