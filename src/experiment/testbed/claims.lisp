;;;; claims.lisp -- what is claimed of the agents of a testbed, checked seed by seed.

(in-package :ars-magna.experiment)

;;; The same seed gives all agents the same world, so scores are compared in pairs. The claims of a
;;; testbed are those published; a claim that does not hold is reported, not tuned to.

(defconstant +claim-level+ 1/100 "The largest p with which a difference counts.")

(defun scores-under (testbed agents settings seeds workers)
  "Return an alist from AGENTS to lists of their scores, by seed, in TESTBED under SETTINGS."
  (let* ((experiment (testbed-experiment testbed agents :settings settings))
         (results (run-experiment-object experiment seeds workers nil nil)))
    (loop for sample in (results-samples results)
          for agent in agents
          for error = (find "" (sample-errors sample) :test #'string/=)
          do (when error (reject-use "~(~A~), ~(~A~): ~A" (testbed-name testbed) agent error))
          collect (cons agent
                        (coerce (sample-measure results sample (testbed-score testbed)) 'list)))))

(defun agents-in-relations (relations)
  (remove-duplicates (loop for (nil a b) in relations collect a collect b) :from-end t))

(defun paired-row (differences)
  "Return the mean of DIFFERENCES, its 95 % interval, and the p of the permutation test."
  (multiple-value-bind (low high) (student-interval differences)
    (list :difference (nearest-mean differences) :low low :high high
          :p (values (permutation-test differences :rare-too t)))))

(defun nearest-mean (numbers)
  (float (/ (reduce #'+ numbers :key #'rational) (length numbers)) 1d0))

(defun better-by-p (row margin)
  (and (<= margin (getf row :difference))
       (<= (getf row :p) +claim-level+)))

(defun within-p (row margin)
  (<= (- margin) (getf row :difference) margin))

(defun not-worse-p (row margin)
  (<= (- margin) (or (getf row :low) (getf row :difference))))

(defun score-differences (scores a b)
  (mapcar #'- (rest (assoc a scores)) (rest (assoc b scores))))

(defun simple-row (relation scores)
  "Return a row for RELATION, of another kind than :NARROWS, by SCORES."
  (destructuring-bind (kind a b margin) relation
    (let ((row (paired-row (score-differences scores a b))))
      (append row (list :holds (funcall (ecase kind
                                           (:better #'better-by-p)
                                           (:within #'within-p)
                                           (:not-worse #'not-worse-p))
                                         row margin))))))

(defun narrowing-row (relation scores-of)
  "Return a row for RELATION, (:narrows a b (knob from to)). SCORES-OF is a function of settings."
  (destructuring-bind (a b (knob from to)) (rest relation)
    (flet ((gaps (value)
             (score-differences (funcall scores-of (list (list knob value))) a b)))
      (let ((row (paired-row (mapcar #'- (gaps from) (gaps to)))))
        (append row (list :holds (better-by-p row 0)))))))

(defun relation-text (relation)
  (destructuring-bind (kind a b more) relation
    (let ((*print-case* :downcase))
      (ecase kind
        (:better (format nil "~(~A~) - ~(~A~), at least ~A" a b (value-text more)))
        (:within (format nil "~(~A~) - ~(~A~), within ~A" a b (value-text more)))
        (:not-worse (format nil "~(~A~) - ~(~A~), interval above -~A" a b (value-text more)))
        (:narrows (format nil "(~(~A~) - ~(~A~)) from ~(~A~) ~A to ~A" a b (first more)
                          (value-text (second more)) (value-text (third more))))))))

(defun settings-text (settings)
  (format nil "~{~A~^ ~}"
          (loop for (name value) in settings
                collect (format nil "~(~A~)=~A" name (value-text value)))))

(defun check-claim (testbed claim seeds workers)
  "Return rows for CLAIM, (text settings relation...)."
  (destructuring-bind (text all-settings . relations) claim
    (loop for settings in all-settings
          append
          (let ((simple (remove :narrows relations :key #'first)) (scores nil))
            (flet ((scores-of (more)
                     (scores-under testbed (agents-in-relations relations)
                                   (append settings more) seeds workers)))
              (when simple (setf scores (scores-of '())))
              (loop for relation in relations
                    collect (list* :claim text :settings settings :relation relation
                                   (if (eq :narrows (first relation))
                                       (narrowing-row relation #'scores-of)
                                       (simple-row relation scores)))))))))

(addition check-claims)
(defun check-claims (name &key (seeds 100) (workers 1) (claims :all))
  "Check the claims of the testbed NAME on as many SEEDS, those for testing. Return a list of
property lists, one for each relation under each setting:
  :claim, :settings, :relation        the text, a list of lists (knob value), and the relation
  :difference, :low, :high, :p        the mean difference of the scores in pairs, its 95 % interval,
                                      and p of the permutation test
  :holds                              true if the relation holds, with p at most .01
The relations are
  (:better a b margin)        the agent A scores at least MARGIN more than B
  (:within a b margin)        the scores of A and B differ by at most MARGIN; p does not count
  (:not-worse a b margin)     the interval of the difference lies above -MARGIN; p does not count
  (:narrows a b (knob v w))   A is less ahead of B when KNOB is W than when it is V
CLAIMS is a list of the numbers of claims to check, from 1. Signals UNKNOWN-NAME, and MISUSE if an
agent has an error."
  (let ((testbed (find-testbed name)))
    (loop for claim in (testbed-claims testbed)
          for number from 1
          when (or (eq :all claims) (member number claims))
            append (check-claim testbed claim seeds workers))))

(defun claim-row-text (row)
  "Return ROW, of CHECK-CLAIMS, as a row of a Markdown table."
  (destructuring-bind (&key settings relation difference low high p holds &allow-other-keys) row
    (flet ((number (x) (if x (decimal-text x 3) "-")))
      (format nil "| ~A | ~A | ~A | ~A to ~A | ~A | ~:[**not reproduced**~;holds~] |"
              (settings-text settings) (relation-text relation)
              (number difference) (number low) (number high)
              (if (< p 1/1000) "< .001" (decimal-text p 3)) holds))))
