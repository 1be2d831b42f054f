;;;; designs.lisp -- samples from ranges, in place of all combinations.

(in-package :ars-magna.experiment)

;;; In :VARY stands (KIND N range...) or (KIND N :SEED seed range...). A RANGE is (what low high),
;;; or that with a word behind it: :INTEGER or :LOG.

(defparameter *designs* '(:latin-hypercube :sobol :random) "The kinds of designs.")
(defparameter *scales* '(:integer :log) "What may stand behind a range.")
(defconstant +most-points+ 100000 "How many points a design may have.")

(defparameter *design-usage*
  "(:sobol n (what low high)...), or :latin-hypercube or :random, with N from 1 to 100000, perhaps ~
   (:sobol n :seed integer ...), and :integer or :log behind a range")

(defun design-part-p (part)
  (member (first part) *designs*))

(defun design-ranges (part)
  (if (eq :seed (third part)) (cddddr part) (cddr part)))

(defun design-seed (part)
  (if (eq :seed (third part)) (fourth part) 0))

(defun part-names (part)
  (if (design-part-p part)
      (mapcar #'first (design-ranges part))
      (list (first part))))

(defun range-p (form)
  (and (proper-list-p form)
       (or (= 3 (length form))
           (and (= 4 (length form)) (member (fourth form) *scales*)))))

;;; Values. They are rounded, so that conditions have short names.

(defconstant +design-digits+ 6 "How many digits the numbers of designs have.")

(defun check-bounds (definition range low high)
  (let* ((scale (fourth range))
         (expected (cond ((not (and (quantity-p low) (quantity-p high) (< low high)))
                          "two numbers, from -1e15 to 1e15, the lower one first")
                         ((and (eq :integer scale) (notevery #'integerp (list low high)))
                          "two integers")
                         ((and (eq :log scale) (not (plusp low))) "two numbers above 0"))))
    (when expected
      (reject-clause definition range
                     (format nil "~A; not ~A and ~A" expected (safe-text low) (safe-text high))))))

(defun rounded-to (value power)
  "Return VALUE rounded to 10^POWER, a double-float."
  (let ((step (expt 10 power)))
    (float (* step (round (rational value) step)) 1d0)))

(defun value-between (low high scale share)
  "Return the number that has SHARE, from 0 to below 1, of what is between LOW and HIGH before it."
  (ecase scale
    (:integer (+ low (floor (* (rational share) (- (1+ high) low)))))
    (:log (let* ((start (logarithm (float low 1d0)))
                 (value (exponential (+ start (* share (- (logarithm (float high 1d0)) start))))))
            (rounded-to value (- (power-of-ten (rational value)) (1- +design-digits+)))))
    ((nil) (let ((width (- (rational high) (rational low))))
             (rounded-to (+ (rational low) (* (rational share) width))
                         (- (power-of-ten width) (1- +design-digits+)))))))

(defun settings-at (point ranges bounds)
  "Return lists (name value) for POINT, which has a share of each of RANGES between its BOUNDS."
  (loop for share in point
        for (name nil nil scale) in ranges
        for (low high) in bounds
        collect (list name (value-between low high scale share))))

(defun design-choices (definition part bounds)
  "Return lists of settings, one for each point of the design PART, whose ranges have BOUNDS, lists
(low high). Points that come twice, as those of few integers do, count once."
  (let ((ranges (design-ranges part)))
    (loop for range in ranges
          for (low high) in bounds
          do (check-bounds definition range low high))
    (remove-duplicates
     (loop for point in (design-points (first part) (second part) (length ranges)
                                       (design-seed part))
           collect (settings-at point ranges bounds))
     :test #'equal :from-end t)))
