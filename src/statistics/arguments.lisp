;;;; arguments.lisp -- what statistics are made of: samples, counts, shares.

(in-package :ars-magna.statistics)

(deftype doubles ()
  "A sample, as it is worked on."
  '(simple-array double-float (*)))

(defun elements-p (value test)
  "True if VALUE is a list or a vector, of nothing but what passes TEST."
  (and (or (vectorp value) (proper-list-p value)) (every test value)))

(defun sample (operator name numbers)
  "Return NUMBERS, the argument NAME of OPERATOR, as a fresh vector of double-floats. Signals
WRONG-ARGUMENT unless they are a list or vector of numbers from -1e15 to 1e15."
  (unless (elements-p numbers #'quantity-p)
    (reject-argument operator name numbers "a list or vector of numbers from -1e15 to 1e15"))
  (map 'doubles #'double numbers))

;;; A single-float .95 is 0.949999988 as a double-float. Whoever writes a share means the decimals.

(defun meant (share)
  "Return SHARE as a double-float; a single-float as the number that is written so."
  (double (if (typep share 'single-float) (rationalize share) share)))

(defun inner-share-p (value)
  "True if VALUE is a number that lies between 0 and 1, by 1e-12 at least."
  (and (probability-p value) (<= 1d-12 (meant value) (- 1 1d-12))))

(defmacro check-share (operator place)
  "Signal WRONG-ARGUMENT unless PLACE lies between 0 and 1; return it as a double-float."
  `(progn
     (check-argument ,operator ,place (inner-share-p ,place)
                     "a number between 0 and 1, such as .95, at least 1e-12 from either")
     (meant ,place)))

(defmacro check-count (operator place &optional (most '+largest+))
  "Signal WRONG-ARGUMENT unless PLACE is an integer from 0 to MOST."
  `(check-argument ,operator ,place (whole-p ,place 0 ,most)
                   (format nil "an integer from 0 to ~D" ,most)))

(defmacro check-trials (operator successes trials)
  `(progn (check-count ,operator ,trials)
          (check-count ,operator ,successes ,trials)))
