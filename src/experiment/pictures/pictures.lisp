;;;; pictures.lisp -- saving pictures of results, of paths in trials, and of comparisons.

(in-package :ars-magna.experiment)

(defparameter *picture-kinds*
  '((:success . success-pictures) (:ticks . ticks-pictures) (:measures . measure-pictures)
    (:survival . survival-pictures) (:differences . difference-pictures))
  "An alist from kinds of pictures to functions of results and summaries that make the pictures.")

;;; Files are named after their contents.

(defun file-name-part (text)
  "Return TEXT as part of a file's name: at most 100 letters, digits, points and single dashes."
  (let* ((text (substitute-if #\- (lambda (char)
                                    (not (or (and (< (char-code char) 128) (alphanumericp char))
                                             (char= #\. char))))
                              (string-downcase text)))
         (words (remove "" (uiop:split-string text :separator "-") :test #'string=))
         (name (format nil "~{~A~^-~}" words)))
    (subseq name 0 (min 100 (length name)))))

(defun unused-file-name (name where names)
  (let ((name (file-name-part (format nil "~A~@[-~A~]" name where))))
    (if (member name names :test #'string=)
        (loop for number from 2
              for other = (format nil "~A-~D" name number)
              unless (member other names :test #'string=) return other)
        name)))

(defun save-pictures (pictures directory kind)
  (let ((names '()))
    (loop for (title where chart) in pictures
          for name = (unused-file-name title where names)
          do (push name names)
          collect (save-chart (file-in directory (format nil "~A.~(~A~)" name kind)) chart))))

(addition save-result-pictures)
(define-with-keywords save-result-pictures
    (results directory &key (kind :svg) (which (mapcar #'first *picture-kinds*)))
  "Save pictures of RESULTS in DIRECTORY, which is created if necessary. Return a list of the files,
which are named after what they show. KIND is :SVG or, if the program rsvg-convert is installed,
:PNG. WHICH is a list of some of these:
  :SUCCESS      how often trials succeed, for each condition, with 95 % intervals
  :TICKS        the ticks of trials that succeed: medians, with 95 % intervals
  :MEASURES     measures: rates, or means and all numbers
  :SURVIVAL     the share of trials that are not done, after each number of ticks
  :DIFFERENCES  in success and ticks, between the values of a factor, seed by seed
The first factor whose values are numbers is the x axis. The other factors make series; more than
six series make several pictures. Pictures without data are left out. The title is the experiment's
question, if the experiment is loaded. Signals WRONG-ARGUMENT, and MISUSE if rsvg-convert is missing
or the directory cannot be made."
  (check-argument save-result-pictures results (results-p results)
                  "results, as RUN-EXPERIMENT and READ-RESULTS return them")
  (check-argument save-result-pictures directory (typep directory '(or string pathname))
                  "the name of a directory")
  (check-argument save-result-pictures kind (member kind '(:svg :png)) ":svg or :png")
  (check-argument save-result-pictures which
                  (and (proper-list-p which)
                       (every (lambda (key) (assoc key *picture-kinds*)) which))
                  (format nil "a list of some of ~{~(~S~)~^, ~}" (mapcar #'first *picture-kinds*)))
  (when (results-samples results)
    (let ((summaries (summarize-results results)))
      (save-pictures (loop for (key . function) in *picture-kinds*
                           when (member key which)
                             append (funcall function results summaries))
                     (ensure-store-directory directory) kind))))

;;;; The paths of robots in trials

(defun rerun-trial-for-paths (experiment condition trial)
  "Run TRIAL of CONDITION of EXPERIMENT again. Return a list of the paths of the trial's robots."
  (let ((trails '()) (watched-p nil))
    (flet ((look (simulation)
             (setf trails (update-trails simulation trails))))
      (let ((result (run-trial experiment condition trial
                               :gate (lambda (simulation)
                                       (unless watched-p
                                         (setf watched-p t)
                                         (look simulation)
                                         (add-observer #'look simulation))
                                       +largest+))))
        (trails-to-ways trails trial (result-outcome result))))))

(defun rerun-trials-for-paths (experiment condition trials)
  (prepare-trials experiment condition)
  (call-without-output (lambda ()
                         (loop for trial in trials
                               append (rerun-trial-for-paths experiment condition trial)))))

(defun trial-numbers (trials)
  (check-argument save-ways-picture trials
                  (or (whole-p trials 1 10000)
                      (and (consp trials) (proper-list-p trials)
                           (every (lambda (trial) (whole-p trial 1)) trials)))
                  "a number of trials, from 1 to 10000, or a list of trial numbers, from 1")
  (if (consp trials)
      trials
      (loop for trial from 1 to trials collect trial)))

(defun shown-trials-text (trials)
  "Return a text on the paths in a picture of TRIALS, a list of numbers."
  (let ((count (length trials)))
    (cond ((= 1 count) (format nil "The way of each robot in trial ~D" (first trials)))
          ((<= count 8) (format nil "The ways of the trials ~{~D~^, ~}" trials))
          ((loop for trial in trials for number from 1 always (= trial number))
           (format nil "The ways of the first ~D trials" count))
          (t (format nil "The ways of ~D trials" count)))))

(addition save-ways-picture)
(define-with-keywords save-ways-picture
    (experiment condition file &rest options &key (trials 50) part title layers in-color scale)
  "Draw the world of CONDITION of EXPERIMENT, with the paths of robots in TRIALS, into FILE. TRIALS
is N, for the first N trials, or a list of trial numbers. An existing FILE is replaced. Colours show
the outcome of each trial; markers show where trials ended. The trials are run again. CONDITION is
as for FIND-CONDITION. PART (left top right bottom), in cells, is the part of the map to draw, by
default all. TITLE replaces the experiment's question. FILE and the other arguments are those of
SAVE-PICTURE. Return the file's truename. Signals UNKNOWN-NAME, WRONG-ARGUMENT, and MISUSE if FILE
is a PNG file and rsvg-convert is missing."
  (declare (ignore part title layers in-color scale))
  (picture-kind 'save-ways-picture file)
  (let* ((experiment (find-experiment experiment))
         (condition (find-condition experiment condition))
         (trials (trial-numbers trials))
         (start (call-without-output
                 (lambda ()
                   (call-in-trial (lambda ()
                                    (take-snapshot (simulation-world (current-simulation))))
                                  experiment condition (first trials))))))
    (apply #'save-picture-of-ways 'save-ways-picture "trial" file start
           (lambda () (rerun-trials-for-paths experiment condition trials))
           (or (question-of (experiment-name experiment))
               (string-downcase (experiment-name experiment)))
           (format nil "~A. ~A, with a marker ~:[at the end of each~;for each robot where ~
                        it ended~]. Robots and things are drawn where they are when ~:[the first ~
                        of these trials~;the trial~] begins."
                   (condition-name condition) (shown-trials-text trials)
                   (rest (snapshot-robots start)) (null (rest trials)))
           (loop for (key value) on options by #'cddr
                 unless (eq :trials key) append (list key value)))))

;;;; Comparisons: differences from zero

(defun same-sides-p (comparison)
  (loop with one = (first (comparison-contrasts comparison))
        for contrast in (comparison-contrasts comparison)
        always (and (string= (contrast-first one) (contrast-first contrast))
                    (string= (contrast-second one) (contrast-second contrast)))))

(defun picture-label (contrast comparison)
  (if (and (contrast-where contrast) (same-sides-p comparison))
      (contrast-where contrast)
      (format nil "~@[~A: ~]~A against ~A" (contrast-where contrast) (contrast-first contrast)
              (contrast-second contrast))))

(defun picture-row (contrast measure comparison)
  (let ((difference (find-difference measure contrast)))
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
  (find :rate (differences-in-measure (all-contrasts comparison) measure) :key #'paired-kind))

(defun range-text (numbers)
  (let ((least (reduce #'min numbers)) (most (reduce #'max numbers)))
    (format nil "~D~:[ to ~D~;~]" least (= least most) most)))

(defun differences-in-measure (contrasts measure)
  (remove nil (mapcar (lambda (contrast) (find-difference measure contrast)) contrasts)))

(defun tests-text (contrasts measure)
  "Return a text on the number of tests for which p of MEASURE in CONTRASTS is corrected, or NIL."
  (let ((tested (remove-if-not #'counts-as-test-p (differences-in-measure contrasts measure))))
    (when tested
      (let ((tests (paired-tests (first tested))))
        (format nil "one of ~D test~:P~:[, ~D of them shown~;~]" tests (= tests (length tested))
                (length tested))))))

(defun seeds-text (comparison measure)
  (let ((trials (mapcar #'paired-trials
                        (differences-in-measure (all-contrasts comparison) measure))))
    (and trials
         (format nil "~A seeds each~:[~;, those where both succeeded~]" (range-text trials)
                 (string-equal "ticks" measure)))))

(defun comparison-subtitle (comparison measure)
  (format nil "~A, seed by seed: first minus second, with 95 % intervals~@[; p as ~A (Holm)~].~
               ~@[ ~A.~]~@[ ~A.~]~@[ Over all, each seed counts once; p as ~A.~]"
          (or (comparison-sides comparison) "Conditions")
          (tests-text (comparison-contrasts comparison) measure)
          (seeds-text comparison measure)
          ;; These may disagree where numbers are few.
          (and (not (rate-compared-p measure comparison))
               "The intervals are Student's, p is of a permutation test")
          (tests-text (comparison-overall comparison) measure)))

(defun comparison-chart (comparison measure &key (contrasts (all-contrasts comparison)))
  "Return a chart of the differences in MEASURE that COMPARISON found, as an SVG document. CONTRASTS
are the contrasts of COMPARISON to show, by default all. The title is the experiment's question."
  (let ((experiment (comparison-experiment comparison)))
    (difference-chart (remove nil (mapcar (lambda (contrast)
                                            (picture-row contrast measure comparison))
                                          contrasts))
                      :title (or (question-of experiment)
                                 (format nil "The experiment ~A" experiment))
                      :subtitle (comparison-subtitle comparison measure)
                      :x-label (format nil "difference in ~A~:[~;, in percentage points~]"
                                       (string-downcase measure)
                                       (rate-compared-p measure comparison)))))

(addition save-comparison-picture)
(define-with-keywords save-comparison-picture
    (comparison file &key (measure "success"))
  "Save a picture of COMPARISON in FILE, which is replaced if it exists. The ending of the name
chooses SVG or, if the program rsvg-convert is installed, PNG. The picture shows the difference in
MEASURE for each pair of conditions: first minus second (rates in points), with the 95 % interval
and p. As in the verdicts, p is corrected for all tests of COMPARISON; the heading has their number.
Return the file's truename. Signals UNKNOWN-NAME if MEASURE was not compared, WRONG-ARGUMENT, and
MISUSE if FILE is a PNG file and rsvg-convert is missing."
  (check-argument save-comparison-picture comparison (comparison-p comparison) "a comparison")
  (check-argument save-comparison-picture measure (typep measure '(or symbol string))
                  "the name of a measure")
  (unless (differences-in-measure (all-contrasts comparison) measure)
    (reject-name "measure" (string measure)
                 (remove-duplicates
                  (loop for contrast in (all-contrasts comparison)
                        append (mapcar #'paired-measure (contrast-differences contrast)))
                  :test #'string= :from-end t)))
  (save-chart file (comparison-chart comparison measure)))
