;;;; comparison-picture.lisp -- a comparison as a picture: differences against zero.

(in-package :ars-magna.experiment)

(defun one-contest-p (comparison)
  "True if the same two are compared wherever COMPARISON does."
  (loop with one = (first (comparison-contrasts comparison))
        for contrast in (comparison-contrasts comparison)
        always (and (string= (contrast-first one) (contrast-first contrast))
                    (string= (contrast-second one) (contrast-second contrast)))))

(defun picture-label (contrast comparison)
  (if (and (contrast-where contrast) (one-contest-p comparison))
      (contrast-where contrast)
      (format nil "~@[~A: ~]~A against ~A" (contrast-where contrast) (contrast-first contrast)
              (contrast-second contrast))))

(defun picture-row (contrast measure comparison)
  (let ((difference (difference-called measure contrast)))
    (flet ((scaled (value)
             (and value (if (eq :rate (paired-kind difference)) (* 100 value) value))))
      (cond ((same-runs-p contrast)
             (list (picture-label contrast comparison) 0 nil nil "the same"))
            (difference
             (list (picture-label contrast comparison) (scaled (paired-estimate difference))
                   (scaled (paired-low difference)) (scaled (paired-high difference))
                   (and (paired-p difference)
                        (format nil "p ~A" (p-text (paired-adjusted-p difference))))))))))

(defun rate-compared-p (measure comparison)
  (find :rate (shown-differences (all-contrasts comparison) measure) :key #'paired-kind))

(defun range-text (numbers)
  (let ((least (reduce #'min numbers)) (most (reduce #'max numbers)))
    (format nil "~D~:[ to ~D~;~]" least (= least most) most)))

(defun shown-differences (contrasts measure)
  (remove nil (mapcar (lambda (contrast) (difference-called measure contrast)) contrasts)))

(defun tests-words (contrasts measure)
  "Return as one of how many tests p of CONTRASTS counts in the picture of MEASURE; NIL if none is."
  (let ((tested (remove-if-not #'tested-p (shown-differences contrasts measure))))
    (when tested
      (let ((tests (paired-tests (first tested))))
        (format nil "one of ~D test~:P~:[, ~D of them shown~;~]" tests (= tests (length tested))
                (length tested))))))

(defun seeds-words (comparison measure)
  (let ((trials (mapcar #'paired-trials (shown-differences (all-contrasts comparison) measure))))
    (and trials
         (format nil "~A seeds each~:[~;, those where both succeeded~]" (range-text trials)
                 (string-equal "ticks" measure)))))

(defun comparison-subtitle (comparison measure)
  (format nil "~A, seed by seed: first less second, with 95 % intervals~@[; p as ~A (Holm)~].~
               ~@[ ~A.~]~@[ ~A.~]~@[ Over all, each seed counts once; p as ~A.~]"
          (or (comparison-sides comparison) "Conditions")
          (tests-words (comparison-contrasts comparison) measure)
          (seeds-words comparison measure)
          ;; These may disagree where numbers are few.
          (and (not (rate-compared-p measure comparison))
               "The intervals are Student's, p is of a permutation test")
          (tests-words (comparison-overall comparison) measure)))

(defun comparison-chart (comparison measure &key (contrasts (all-contrasts comparison)))
  "Return the chart of what differs in MEASURE in COMPARISON, or in those CONTRASTS of it, an SVG
document, below what the experiment asks."
  (let ((experiment (comparison-experiment comparison)))
    (difference-chart (remove nil (mapcar (lambda (contrast)
                                            (picture-row contrast measure comparison))
                                          contrasts))
                      :title (or (question-of experiment)
                                 (format nil "The experiment ~A" experiment))
                      :subtitle (comparison-subtitle comparison measure)
                      :x-label (format nil "difference in ~A~:[~;, in points of 100~]"
                                       (string-downcase measure)
                                       (rate-compared-p measure comparison)))))

(addition save-comparison-picture)
(define-with-keywords save-comparison-picture
    (comparison file &key (measure "success"))
  "Save a picture of COMPARISON in FILE, replacing it: SVG or, where the program rsvg-convert is
installed, PNG, as its name ends. It shows for each pair of conditions the difference in MEASURE,
first less second, of rates in points of 100, with its 95 % interval and p as it counts among all
tests of COMPARISON, as in its verdicts; what stands above says how many these are. Return the
file's truename. Signals UNKNOWN-NAME if MEASURE was not compared, WRONG-ARGUMENT, and MISUSE
without that program."
  (check-argument save-comparison-picture comparison (comparison-p comparison) "a comparison")
  (check-argument save-comparison-picture measure (typep measure '(or symbol string))
                  "the name of a measure")
  (unless (shown-differences (all-contrasts comparison) measure)
    (reject-name "measure" (string measure)
                 (remove-duplicates
                  (loop for contrast in (all-contrasts comparison)
                        append (mapcar #'paired-measure (contrast-differences contrast)))
                  :test #'string= :from-end t)))
  (save-chart file (comparison-chart comparison measure)))
