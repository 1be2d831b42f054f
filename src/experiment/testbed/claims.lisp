;;;; claims.lisp -- what is claimed of the agents of a testbed, checked seed by seed.

(in-package :ars-magna.experiment)

;;; The same seed gives all agents the same world, so scores are compared in pairs. The claims of a
;;; testbed are those published; a claim that does not hold is reported, not tuned to.

(defconstant +claim-level+ 1/100 "The largest p with which a difference counts.")

(defun seeds-for-claim-level ()
  "Return the least number of seeds for which p can be at most +CLAIM-LEVEL+."
  (loop for seeds from 1
        when (<= (smallest-possible-p seeds) +claim-level+) return seeds))

(defun seeds-for-relation (relation)
  "Return the least number of seeds for which RELATION can hold."
  (ecase (first relation)
    ((:better :narrows) (seeds-for-claim-level))
    (:not-worse 2)
    (:within 1)))

(defun paired-row (differences)
  "Return the mean of DIFFERENCES, its 95 % interval, and the p of the permutation test."
  (multiple-value-bind (low high) (student-interval differences)
    (list :difference (nearest-mean differences) :low low :high high
          :p (values (permutation-test differences :rare-too t)))))

(defun better-by-p (row margin less)
  (and (<= margin (if less (- (getf row :difference)) (getf row :difference)))
       (<= (getf row :p) +claim-level+)))

(defun within-p (row margin)
  (<= (- margin) (getf row :difference) margin))

(defun not-worse-p (row margin less)
  (if less
      (<= (getf row :high) margin)
      (<= (- margin) (getf row :low))))

(defun relation-holds-p (relation row less)
  (destructuring-bind (kind margin) (list (first relation) (fourth relation))
    (ecase kind
      (:better (better-by-p row margin less))
      (:within (within-p row margin))
      (:not-worse (not-worse-p row margin less))
      (:narrows (better-by-p row 0 less)))))

(defun relation-row (relation settings scores-of less)
  "Return a row for RELATION under SETTINGS. SCORES-OF returns the scores of a game. If LESS is
true, less is better."
  (let* ((differences (relation-differences relation settings scores-of))
         (row (paired-row differences))
         (needed (seeds-for-relation relation))
         (enough-p (<= needed (length differences))))
    (append row
            (list :holds (and enough-p (relation-holds-p relation row less) t)
                  :seeds-needed (and (not enough-p) needed)))))

(defun claim-measure (testbed claim)
  "Return the measure that CLAIM of TESTBED is about, and true if less of it is better."
  (let ((part (find-if #'measure-part-p (cddr claim))))
    (if part
        (values (second part) (and (third part) t))
        (values (testbed-score testbed) (testbed-less-is-better testbed)))))

(defun claim-games (claim)
  "Return the games that CLAIM is about."
  (loop for settings in (second claim)
        append (loop for relation in (claim-relations claim)
                     append (relation-games relation settings))))

(defun claim-rows (testbed claim games seeds)
  "Return the rows of CLAIM of TESTBED by the first SEEDS of GAMES, which have been run."
  (multiple-value-bind (measure less) (claim-measure testbed claim)
    (flet ((scores-of (game) (game-scores games game measure seeds)))
      (loop for settings in (second claim)
            append (loop for relation in (claim-relations claim)
                         collect (list* :claim (first claim) :settings settings
                                        :relation relation :measure measure :less less
                                        (relation-row relation settings #'scores-of less)))))))

(defun check-measure (testbed measure)
  "Signal UNKNOWN-NAME unless the games of TESTBED measure MEASURE."
  (let ((names (mapcar #'first (getf (experiment-options testbed) :measures))))
    (unless (member measure names :test #'string-equal)
      (reject-name "measure" measure names))))

(defun selected-claims (testbed numbers)
  "Return the claims of TESTBED with NUMBERS, a list, or :ALL. Signals WRONG-ARGUMENT."
  (let* ((claims (testbed-claims testbed)) (count (length claims)))
    (unless (or (eq :all numbers)
                (and (proper-list-p numbers)
                     (every (lambda (number) (whole-p number 1 count)) numbers)))
      (reject-argument 'check-claims 'claims numbers
                       (if claims
                           (format nil ":all, or a list of numbers from 1 to ~D" count)
                           (format nil ":all; ~(~A~) has no claims" (testbed-name testbed)))))
    (loop for claim in claims
          for number from 1
          when (or (eq :all numbers) (member number numbers)) collect claim)))

(defun run-claims (testbed claims games seeds)
  "Run the games of CLAIMS of TESTBED for so many SEEDS, unless that has been done."
  (dolist (claim claims) (check-measure testbed (claim-measure testbed claim)))
  (run-games games (loop for claim in claims append (claim-games claim)) seeds))

(addition check-claims)
(defun check-claims (name &key (seeds 100) (workers 1) (claims :all))
  "Check the claims of the testbed NAME on as many SEEDS, those for testing. Return a list of
property lists, one for each relation under each list of settings:
  :claim, :settings, :relation        the text, a list of lists (knob value), and the relation; see
                                      DEFINE-TESTBED
  :measure, :less                     what is compared, and true if less of it is better
  :difference, :low, :high, :p        the mean difference of the scores in pairs, first minus
                                      second, its 95 % interval, and p of the permutation test
  :holds                              true if the relation holds, for :better and :narrows with p
                                      at most .01
  :seeds-needed                       if there are too few seeds for the relation to hold at all,
                                      how many are needed; else NIL
CLAIMS is a list of the numbers of claims to check, from 1. Signals UNKNOWN-NAME, WRONG-ARGUMENT,
and MISUSE if an agent has an error."
  (check-argument check-claims seeds (and (integerp seeds) (plusp seeds)) "a positive integer")
  (let* ((testbed (find-testbed name))
         (claims (selected-claims testbed claims))
         (games (make-games testbed workers)))
    (run-claims testbed claims games seeds)
    (loop for claim in claims append (claim-rows testbed claim games seeds))))

(defun verdict-text (row)
  (cond ((getf row :holds) "holds")
        ((getf row :seeds-needed) "too few seeds")
        (t "**not reproduced**")))

(defun claim-p-text (p)
  "Return the text of P, with one digit more if it would not show which side of .01 P is on."
  (cond ((< p 1/1000) "< .001")
        ((< 1/100 p 105/10000) (decimal-text p 4))
        (t (decimal-text p 3))))

(defun claim-row-text (row)
  "Return ROW, of CHECK-CLAIMS, as a row of a Markdown table."
  (destructuring-bind (&key settings relation less difference low high p &allow-other-keys) row
    (flet ((number (x) (if x (decimal-text x 3) "-")))
      (format nil "| ~A | ~A | ~A | ~A to ~A | ~A | ~A |"
              (if settings (settings-text settings) "defaults") (relation-text relation less)
              (number difference) (number low) (number high)
              (claim-p-text p) (verdict-text row)))))
