;;;; patterns.lisp -- descriptors with matchvars, for objects of manipulations (manual 5.5.1).

(in-package :ars-magna.command)

;;; A pattern is a list of clauses (key value threshold). It tests a thing's true values, without
;;; noise, and without a threshold unless one is given. A list of values is a range for a numeric
;;; attribute and alternatives for any other; for an undeclared attribute, two numbers are a range.
;;; NIL means false or unspecified. A matchvar is bound at its first occurrence and must have the
;;; same value at each later one, in this pattern or the next.

(defun check-discrete-clause (definition clause attribute)
  (let ((value (find-if-not (lambda (value) (or (matchvar-p value) (in-domain-p attribute value)))
                            (if (in-domain-p attribute (second clause))
                                '()
                                (ensure-list (second clause))))))
    (when value
      (reject-clause definition clause
                     (format nil "one of ~(~A~)~@[; did you mean ~(~A~)?~]"
                             (attribute-domain attribute)
                             (similar-domain-value value (attribute-domain attribute)))))))

(defun check-clause (definition clause)
  (let* ((key (attribute-key (first clause))) (attribute (declared-attribute key))
         (value (second clause)))
    (when (and value (symbolp value) (starts-with-subseq "?" (symbol-name value)))
      (reject-clause definition clause
                     "a value; write (in-readtable :nisp) before this form to make ?x a matchvar"))
    (when (and (specifies-range-p attribute value) (not (range-p value)))
      (reject-clause definition clause "a range with the lower end first"))
    (cond ((null attribute))
          ((discrete-p attribute)
           (check-discrete-clause definition clause attribute))
          ((eq :substance key))
          ((not (or (matchvar-p value) (bounded-number-p value) (null value) (range-p value)))
           (reject-clause definition clause "a number, or a range: two numbers in a list")))))

(defun parse-pattern (definition specification)
  "Return the pattern of SPECIFICATION, a list of lists (attribute value [threshold]). Signals
MALFORMED-DEFINITION about DEFINITION. See reading 126."
  (unless (and (proper-list-p specification) (every #'specification-clause-p specification))
    (reject-clause definition
                   (if (proper-list-p specification)
                       (find-if-not #'specification-clause-p specification)
                       specification)
                   "a descriptor ((attribute value [threshold]) ...) after each object's hyphen"))
  (dolist (clause specification) (check-clause definition clause))
  (loop for (name value threshold) in specification
        collect (list (attribute-key name) value (or threshold 0))))

;;; Values.

(defun within-threshold-p (number low high threshold)
  (<= (- low threshold) number (+ high threshold)))

(defun comparable-value (key value wanted)
  "Return VALUE; for key :SUBSTANCE, its parameter if WANTED is a number or range, else its type."
  (cond ((not (eq key :substance)) value)
        ((value-limits wanted) (substance-value-parameter value))
        (t (substance-value-type value))))

(defun value-fits-p (key wanted threshold value)
  "True if VALUE, a thing's value of the attribute KEY, fits WANTED, a value in a pattern."
  (cond ((or (null wanted) (null value)) (and (listp wanted) (member value (or wanted '(nil)))))
        ((and (realp wanted) (realp value)) (within-threshold-p value wanted wanted threshold))
        ((atom wanted) (value-equal wanted value))
        ((not (specifies-range-p (declared-attribute key) wanted))
         (or (member value wanted :test #'value-equal) (value-equal wanted value)))
        ((realp value) (within-threshold-p value (first wanted) (second wanted) threshold))))

;;; Matchvars.

(defun bind-matchvar (matchvar key value bindings)
  "True if MATCHVAR can have VALUE, a value of KEY. Return BINDINGS with MATCHVAR bound as well."
  (let ((binding (assoc matchvar bindings)))
    (cond ((not (or value (can-be-false-p (declared-attribute key)))) (values nil bindings))
          ((null (matchvar-name matchvar)) (values t bindings))
          (binding (values (value-equal value (cdr binding)) bindings))
          (t (values t (acons matchvar value bindings))))))

(defun match-clause (clause thing bindings)
  (destructuring-bind (key wanted threshold) clause
    (let ((value (get-attribute thing key)))
      (if (matchvar-p wanted)
          (bind-matchvar wanted key value bindings)
          (values (value-fits-p key wanted threshold (comparable-value key value wanted))
                  bindings)))))

(defun match-pattern (pattern thing bindings)
  "True if THING fits PATTERN with BINDINGS. Return the bindings after the match as a second value."
  (dolist (clause pattern (values t bindings))
    (multiple-value-bind (fits after) (match-clause clause thing bindings)
      (unless fits (return (values nil bindings)))
      (setf bindings after))))

(defun patterns-fit-p (patterns things)
  "True if each of THINGS fits the corresponding pattern in PATTERNS. The patterns share matchvars."
  (loop with bindings = '()
        for pattern in patterns
        for thing in things
        always (multiple-value-bind (fits after) (match-pattern pattern thing bindings)
                 (setf bindings after)
                 fits)))

;;; Versions of a pattern.

(defun exclusive-values-p (one other)
  "True if no value can fit both ONE and OTHER, values in patterns."
  (multiple-value-bind (low high) (value-limits one)
    (multiple-value-bind (other-low other-high) (value-limits other)
      (cond ((or (matchvar-p one) (matchvar-p other)) nil)
            ((and low other-low) (or (< high other-low) (< other-high low)))
            (t (null (intersection (if (listp one) (or one '(nil)) (list one))
                                   (if (listp other) (or other '(nil)) (list other))
                                   :test #'value-equal)))))))

(defun similar-patterns-p (pattern other)
  "True if PATTERN and OTHER have the same attributes, and a thing can fit both patterns."
  (and (equal (mapcar #'first pattern) (mapcar #'first other))
       (notany #'exclusive-values-p (mapcar #'second pattern) (mapcar #'second other))))
