;;;; contrasts.lisp -- comparing two conditions by their trials of equal seeds.

(in-package :ars-magna.experiment)

(addition contrast-p)

(define-record (contrast (:constructor make-contrast (where first second)))
  "The comparison of two sides, which are conditions or versions."
  (where nil (or null string) "what both sides have in common, a string, or NIL" :addition)
  (first "" string "the name of the first side, a string" :addition)
  (second "" string "the name of the second side, a string" :addition)
  (trials 0 integer "how many pairs of trials with equal seeds there are" :writable :addition)
  (unpaired-first 0 integer "how many trials of the first side have no counterpart" :writable)
  (unpaired-second 0 integer "how many trials of the second side have no counterpart" :writable)
  (errors-first 0 integer "how many paired trials of the first side ended with an error" :writable)
  (errors-second 0 integer "how many paired trials of the second side ended with an error"
  :writable)
  (same 0 integer "how many pairs of trials are the same to the last bit" :writable :addition)
  (differences '() list "a list of the differences in success, ticks and measures; NIL if all rows
are equal" :writable :addition))

(addition comparison-p)
(define-record (comparison (:constructor make-comparison
                               (experiment sides kind contrasts &key overall changes notes)))
  "A comparison of conditions of an experiment, or of two versions of an experiment.
COMPARE-CONDITIONS, COMPARE-LEVELS and COMPARE-RESULTS return comparisons."
  (experiment "" string)
  (sides nil (or null string) "a text that names both sides, or NIL")
  (kind :conditions keyword ":CONDITIONS or :VERSIONS")
  (contrasts '() list
             "a list of the pairs of conditions, or versions, that were compared" :addition)
  (overall '() list "a list of contrasts over all conditions, one for each pair of values, or one
for the two versions; each seed counts once" :addition)
  (changes '() list "a list of sentences on what differs between two versions, according to
experiment.txt beside the tables; NIL if conditions are compared" :addition)
  (notes '() list))

(defmethod print-object ((contrast contrast) stream)
  (print-unreadable-object (contrast stream)
    (format stream "~A against ~A" (contrast-first contrast) (contrast-second contrast))))

(defmethod print-object ((comparison comparison) stream)
  (print-unreadable-object (comparison stream :type t)
    (format stream "~A~@[: ~A~], ~D contrast~:P" (comparison-experiment comparison)
            (comparison-sides comparison) (length (comparison-contrasts comparison)))))

;;; Pairs.

(defun common-trials (first second)
  "Return a list of conses: the indices of trials with equal seeds in the samples FIRST and SECOND."
  (let ((seeds (sample-seeds first)) (others (sample-seeds second)) (i 0) (j 0) (pairs '()))
    (loop while (and (< i (length seeds)) (< j (length others)))
          do (let ((seed (aref seeds i)) (other (aref others j)))
               (when (= seed other) (push (cons i j) pairs))
               (when (<= seed other) (incf i))
               (when (>= seed other) (incf j))))
    (nreverse pairs)))

(defun comparable-pairs (name first second &optional (pairs (common-trials first second)))
  "FIRST and SECOND are samples. Return those PAIRS of trials that have comparable values of NAME."
  (if (string-equal name "ticks")
      (remove-if-not (lambda (pair)
                       (and (success-p (aref (sample-outcomes first) (car pair)))
                            (success-p (aref (sample-outcomes second) (cdr pair)))))
                     pairs)
      pairs))

(defun measure-column (results sample name)
  (if (string-equal name "success")
      (cl:map 'vector #'success-p (sample-outcomes sample))
      (sample-measure results sample name)))

(defun filter-both (test firsts seconds)
  "Return two lists: the elements of FIRSTS and of SECONDS at the positions where both pass TEST."
  (loop for a in firsts
        for b in seconds
        when (and (funcall test a) (funcall test b))
          collect a into values and collect b into others
        finally (return (values values others))))

;;; Truth values are compared as rates, and numbers as means. Texts are not compared.

(defun difference-of-values (name firsts seconds)
  "Return the difference in the measure NAME between the values FIRSTS and SECONDS; NIL for texts."
  (flet ((all (test) (and (every test firsts) (every test seconds))))
    (cond ((all (lambda (value) (typep value 'boolean))) (rate-difference name firsts seconds))
          ((or (some #'realp firsts) (some #'realp seconds))
           (multiple-value-call #'mean-difference
             name (filter-both #'finite-value-p firsts seconds)))
          (t nil))))

(defun set-left-out-count (difference pairs)
  "Unless DIFFERENCE is NIL, record how many of PAIRS pairs it leaves out. Return DIFFERENCE."
  (when difference
    (setf (paired-left-out difference) (- pairs (paired-trials difference))))
  difference)

(defun measure-difference (name results first other-results second pairs)
  (let ((pairs (comparable-pairs name first second pairs))
        (column (measure-column results first name))
        (other (measure-column other-results second name)))
    (multiple-value-bind (firsts seconds)
        (filter-both (lambda (value) (not (eq :none value)))
                    (loop for (i . nil) in pairs collect (aref column i))
                    (loop for (nil . j) in pairs collect (aref other j)))
      (cond ((string-equal name "ticks") (mean-difference "ticks" firsts seconds))
            ((or firsts (string-equal name "success"))
             (set-left-out-count (difference-of-values (string-downcase name) firsts seconds)
                                 (length pairs)))
            ;; Never measured in both: reported as not comparable.
            ((or (some #'finite-value-p column) (some #'finite-value-p other))
             (set-left-out-count (mean-difference (string-downcase name) '() '())
                                 (length pairs)))))))

;;; Contrasts.

(defun same-row-p (first i second j)
  "True if the trial at index I of the sample FIRST and the trial at index J of SECOND have equal
rows, except for fingerprints."
  (flet ((same (reader)
           (equal (aref (funcall reader first) i) (aref (funcall reader second) j))))
    (and (same #'sample-digests) (same #'sample-outcomes) (same #'sample-reasons)
         (same #'sample-ticks) (same #'sample-errors)
         (= (length (sample-measures first)) (length (sample-measures second)))
         (every (lambda (column other) (equal (aref column i) (aref other j)))
                (sample-measures first) (sample-measures second)))))

(defun count-errors (sample places)
  (count-if (lambda (i) (string= "error" (aref (sample-outcomes sample) i))) places))

;; Identical trials need no test, and do not count as one of several.
(defun same-runs-p (contrast)
  (and (plusp (contrast-trials contrast))
       (= (contrast-same contrast) (contrast-trials contrast))))

(defun compare-samples (contrast results first other-results second names)
  "Compare the samples FIRST of RESULTS and SECOND of OTHER-RESULTS in the measures NAMES, and store
the comparison in CONTRAST. Return CONTRAST."
  (let* ((pairs (common-trials first second)) (count (length pairs)))
    (setf (contrast-trials contrast) count
          (contrast-unpaired-first contrast) (- (length (sample-trials first)) count)
          (contrast-unpaired-second contrast) (- (length (sample-trials second)) count)
          (contrast-errors-first contrast) (count-errors first (mapcar #'car pairs))
          (contrast-errors-second contrast) (count-errors second (mapcar #'cdr pairs))
          (contrast-same contrast)
          (loop for (i . j) in pairs count (same-row-p first i second j))
          (contrast-differences contrast)
          (unless (same-runs-p contrast)
            (loop for name in names
                  for difference = (measure-difference name results first other-results second
                                                       pairs)
                  when difference collect difference)))
    contrast))

(defun find-difference (name contrast)
  (find name (contrast-differences contrast) :key #'paired-measure :test #'string-equal))

(defun all-contrasts (comparison)
  (append (comparison-contrasts comparison) (comparison-overall comparison)))

(defun tested-differences (contrasts)
  (loop for contrast in contrasts
        append (remove-if-not #'counts-as-test-p (contrast-differences contrast))))

;;;; Over several conditions

;;; The trials of one seed under several conditions are not independent, so they count as one
;;; observation: for each seed the means over all conditions are compared. Pairs count only if both
;;; have a value, so both means of a seed are over the same conditions. Seeds count only if both
;;; have them under all conditions. PAIRS are lists of two samples.

(defun seeds-in-all-pairs (pairs)
  "Return a hash table whose keys are the seeds that both samples of each of PAIRS have."
  (let ((counts (make-hash-table)))
    (loop for (first second) in pairs
          do (loop for (i . nil) in (common-trials first second)
                   do (incf (gethash (aref (sample-seeds first) i) counts 0))))
    (loop for seed being the hash-keys of counts using (hash-value count)
          unless (= count (length pairs)) do (remhash seed counts))
    counts))

(defun values-by-seed (name results other-results pairs seeds)
  "Return lists (seed a b) of the values of the measure NAME in trials of SEEDS. Each of PAIRS is a
sample of RESULTS and a sample of OTHER-RESULTS."
  (loop for (first second) in pairs
        for column = (measure-column results first name)
        for other = (measure-column other-results second name)
        append (loop for (i . j) in (comparable-pairs name first second)
                     for seed = (aref (sample-seeds first) i)
                     for a = (aref column i)
                     for b = (aref other j)
                     unless (or (eq :none a) (eq :none b) (not (gethash seed seeds)))
                       collect (list seed a b))))

(defun means-by-seed (values)
  "VALUES are lists (seed a b) of numbers. Return two lists: A's and B's means for each seed."
  (let ((sums (make-hash-table)) (seeds '()))
    (loop for (seed a b) in values
          for entry = (or (gethash seed sums)
                          (progn (push seed seeds)
                                 (setf (gethash seed sums) (list '() '()))))
          do (push a (first entry))
             (push b (second entry)))
    (loop for seed in (sort seeds #'<)
          for (firsts-of-seed seconds-of-seed) = (gethash seed sums)
          collect (exact-mean firsts-of-seed) into firsts
          collect (exact-mean seconds-of-seed) into seconds
          finally (return (values firsts seconds)))))

(defun overall-difference (name values)
  "VALUES are lists (seed a b). Return their difference in the measure NAME, or NIL for texts."
  (flet ((all (test) (loop for (nil a b) in values always (and (funcall test a) (funcall test b))))
         (difference (kind values)
           (multiple-value-bind (firsts seconds) (means-by-seed values)
             (mean-difference (string-downcase name) firsts seconds kind))))
    (cond ((all (lambda (value) (typep value 'boolean)))
           (difference :rate (loop for (seed a b) in values
                                   collect (list seed (if a 1 0) (if b 1 0)))))
          ((some (lambda (entry) (some #'realp (rest entry))) values)
           (difference :mean (remove-if-not (lambda (entry) (every #'finite-value-p (rest entry)))
                                            values))))))

(defun overall-contrast (first second pairs names results &optional (other-results results))
  (let ((contrast (make-contrast "over all" first second))
        (seeds (seeds-in-all-pairs pairs)))
    (setf (contrast-trials contrast) (hash-table-count seeds)
          (contrast-differences contrast)
          (loop for name in names
                for values = (values-by-seed name results other-results pairs seeds)
                for difference = (and values (overall-difference name values))
                when difference collect difference))
    contrast))

(defun overall-contrast-needed-p (contrasts)
  (and (rest contrasts) (notevery #'same-runs-p contrasts)))
