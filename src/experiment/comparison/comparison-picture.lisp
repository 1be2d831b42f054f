;;;; comparison-picture.lisp -- a comparison as a picture: differences against zero.

(in-package :ars-magna.experiment)

(defun picture-label (contrast comparison)
  "Return what stands beside the row of CONTRAST, of COMPARISON."
  (if (eq :versions (comparison-kind comparison))
      (contrast-where contrast)
      (format nil "~@[~A: ~]~A against ~A" (contrast-where contrast) (contrast-first contrast)
              (contrast-second contrast))))

(defun picture-row (contrast measure comparison)
  "Return a row of the picture for the difference of CONTRAST in MEASURE, or NIL."
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
  (some (lambda (contrast)
          (let ((difference (difference-called measure contrast)))
            (and difference (eq :rate (paired-kind difference)))))
        (all-contrasts comparison)))

(defun comparison-chart (comparison measure &key (title (comparison-title comparison))
                                               (contrasts (all-contrasts comparison)))
  "Return the chart, below TITLE, of what differs in MEASURE in COMPARISON, or in those CONTRASTS of
it, an SVG document."
  (difference-chart (remove nil (mapcar (lambda (contrast)
                                          (picture-row contrast measure comparison))
                                        contrasts))
                    :title title
                    :subtitle "First less second, with 95 % intervals; p after Holm's correction"
                    :x-label (format nil "difference in ~A~:[~;, in points of 100~]"
                                     (string-downcase measure)
                                     (rate-compared-p measure comparison))))

(addition save-comparison-picture)
(defun save-comparison-picture (comparison file &key (measure "success"))
  "Save a picture of COMPARISON in FILE, replacing it: SVG or, where the program rsvg-convert is
installed, PNG, as its name ends. It shows for each pair of conditions the difference in MEASURE,
first less second, of rates in points of 100, with its 95 % interval and p as it counts among all
tests. Return the file's truename. Signals UNKNOWN-NAME if MEASURE was not compared, WRONG-ARGUMENT,
and MISUSE without that program."
  (check-argument save-comparison-picture comparison (comparison-p comparison) "a comparison")
  (check-argument save-comparison-picture measure (typep measure '(or symbol string))
                  "the name of a measure")
  (unless (some (lambda (contrast) (difference-called measure contrast))
                (all-contrasts comparison))
    (reject-name "measure" (string measure)
                 (remove-duplicates
                  (loop for contrast in (all-contrasts comparison)
                        append (mapcar #'paired-measure (contrast-differences contrast)))
                  :test #'string= :from-end t)))
  (save-chart file (comparison-chart comparison measure)))
