;;;; queries.lisp -- questions to the memory, and rules.

(in-package :ars-rap)

;;; The answers to a query are bindings, in the order of the memory, the newest fact first. Rules
;;; work backwards: a fact that follows from others is in no memory.

(define-record (memory-rule (:constructor make-memory-rule (name head query documentation)))
  "A rule by which facts follow from others, defined by DEFINE-MEMORY-RULE."
  (name nil symbol "the name of the rule")
  (head nil list "the pattern of the facts that follow")
  (query nil list "the query from which they follow")
  (documentation nil (or null string)))

(define-registry memory-rule "memory rule" :object-p memory-rule-p :by-symbol t :plans t
  :internal t)

(defparameter *rule-depth-limit* 1000 "How deeply rules may use each other.")

(defparameter *rule-data-limits* '(50 1000)
  "How deep the lists in the data of rules may be nested, and how many conses they may have.")

(defvar *tables* nil
  "The tables of the query in progress: a hash table from lists (rule pattern), as by DATA-KEY; or
NIL, without tables.")

(defvar *rounds* 0 "How many rounds the query in progress has begun.")
(defvar *round* nil "The number of the round in progress, or NIL.")
(defvar *rule-depth* 0 "How deep in each other rules are being applied.")
(defvar *incomplete-p* nil "True if facts were taken from a table that may lack some.")
(defvar *grown-p* nil "True if the round in progress has found a new fact.")

(defun solve (query bindings)
  "Return a list of the extensions of BINDINGS for which QUERY holds."
  (let ((*tables* nil) (*rounds* 0) (*round* nil) (*rule-depth* 0) (solutions '()))
    (map-solutions (lambda (solution) (push solution solutions)) query bindings)
    (nreverse solutions)))

(defun map-solutions (function query bindings)
  "Call FUNCTION with each extension of BINDINGS for which QUERY holds."
  (declare (type function function))
  (case (query-operator query)
    ((nil) (map-matches function query bindings nil))
    (and (map-joint-solutions function (rest query) bindings))
    (or (dolist (part (rest query)) (map-solutions function part bindings)))
    (not (unless (solvable-p (second query) bindings) (funcall function bindings)))
    (within (destructuring-bind (span pattern) (rest query)
              (let ((ticks (if (variable-p span) (value-of-variable span bindings query) span)))
                (unless (realp ticks)
                  (reject-use "In the query ~A, ~A is no number of ticks."
                              (data-text query) (data-text ticks)))
                (map-matches function pattern bindings (- (now) ticks)))))
    (test (when (call-form (rest query) bindings query) (funcall function bindings)))
    (value (let ((extended (match (second query) (call-form (cddr query) bindings query)
                             bindings)))
             (unless (eq :fail extended) (funcall function extended))))
    (t (map-comparison function query bindings))))

(defun map-joint-solutions (function queries bindings)
  "Call FUNCTION with each extension of BINDINGS for which all QUERIES hold."
  (declare (type function function))
  (if queries
      (map-solutions (lambda (solution) (map-joint-solutions function (rest queries) solution))
                     (first queries) bindings)
      (funcall function bindings)))

(defun solvable-p (query bindings)
  "True if QUERY holds for an extension of BINDINGS. Rules that are being applied must not matter."
  (let ((*round* nil))
    (map-solutions (lambda (solution)
                     (declare (ignore solution))
                     (return-from solvable-p t))
                   query bindings)
    nil))

(defun call-form (form bindings query)
  "Return the value of FORM, a list (function variable...), a part of QUERY."
  (apply (first form) (loop for variable in (rest form)
                            collect (value-of-variable variable bindings query))))

(defun value-of-variable (variable bindings query)
  (cdr (or (binding-of variable bindings)
           (reject-use "In the query ~A, the variable ~A has no value. Put the pattern that gives ~
                        it one before."
                       (data-text query) (data-text variable)))))

(defun map-matches (function pattern bindings since)
  "Call FUNCTION with the extensions of BINDINGS by which PATTERN matches facts, and then those by
which it matches what follows by rules. If SINCE is a tick, leave out older facts."
  (declare (type function function))
  (flet ((try (fact)
           (let ((extended (match pattern fact bindings)))
             (unless (eq :fail extended) (funcall function extended)))))
    (loop for (fact tick) in (memory-entries)
          do (when (or (null since) (<= since tick)) (try fact)))
    (dolist (rule (all-memory-rules))
      (let ((call (instance pattern bindings)))
        (unless (eq :fail (bind-head (memory-rule-head rule) call '()))
          ;; More may be found meanwhile.
          (loop with facts = (facts-by-rule rule call)
                for i from 0
                while (< i (length facts)) do (try (aref facts i))))))))

;;; Applying rules. A table has the facts that follow by a rule and may match a pattern. Rules may
;;; use each other in circles. So the first table that a query needs is worked out in rounds, with
;;; the tables that it needs itself. In a round, each of them is worked out once; where one needs a
;;; table that this round has begun already, it takes the facts found so far. The rounds end when
;;; one has found nothing new, or when no table has had to do with fewer facts than there may be.

(defstruct (rule-table (:constructor make-rule-table (rule pattern)) (:copier nil))
  "The FACTS that follow by RULE and may match PATTERN, and their keys. ROUND is the last round that
has worked them out."
  (rule nil :type memory-rule :read-only t)
  (pattern nil :type list :read-only t)
  (facts (make-array 8 :adjustable t :fill-pointer 0) :type vector :read-only t)
  (keys (make-hash-table :test 'equal) :type hash-table :read-only t)
  (round 0 :type fixnum)
  (complete-p nil :type boolean))

(defun data-key (data)
  "Return an object for DATA. Those of two data are EQUAL if the data are VALUE-EQUAL."
  (cond ((consp data) (cons (data-key (car data)) (data-key (cdr data))))
        ((null data) nil)
        ((symbolp data) (cons :symbol (string-upcase data)))
        ((realp data) (rational data))
        ((simple-vector-p data) (cons :vector (map 'list #'data-key data)))
        (t data)))

(defun generalized (pattern)
  "Return PATTERN with ? in place of its variables."
  (cond ((variable-p pattern) '?)
        ((consp pattern) (cons (generalized (car pattern)) (generalized (cdr pattern))))
        (t pattern)))

(defun bind-head (head pattern bindings)
  "Match HEAD, of a rule, with PATTERN, which may have variables: they match anything."
  (cond ((variable-p pattern) bindings)
        ((and (consp head) (consp pattern))
         (let ((bindings (bind-head (car head) (car pattern) bindings)))
           (if (eq :fail bindings) :fail (bind-head (cdr head) (cdr pattern) bindings))))
        ((and (variable-p head) (not (ground-p pattern))) bindings)
        (t (match head pattern bindings))))

(defun facts-by-rule (rule pattern)
  "Return a vector of the facts that follow by RULE and may match PATTERN. Facts that are found
later may be added to it."
  (let ((table (rule-table rule (generalized pattern))))
    (cond ((rule-table-complete-p table))
          ((null *round*) (complete-table table))
          ((= *round* (rule-table-round table)) (setf *incomplete-p* t))
          (t (extend-table table)))
    (rule-table-facts table)))

(defun rule-table (rule pattern)
  (unless *tables* (setf *tables* (make-hash-table :test 'equal)))
  (let ((key (cons (memory-rule-name rule) (data-key pattern))))
    (or (gethash key *tables*)
        (setf (gethash key *tables*) (make-rule-table rule pattern)))))

(defun complete-table (table)
  "Find out all facts of TABLE, and of the tables that it needs."
  (let ((first (1+ *rounds*)))
    (loop
      (let ((*round* (incf *rounds*)) (*incomplete-p* nil) (*grown-p* nil))
        (extend-table table)
        (unless (and *incomplete-p* *grown-p*) (return))))
    (loop for each being the hash-values of *tables*
          do (when (<= first (rule-table-round each)) (setf (rule-table-complete-p each) t)))))

(defun extend-table (table)
  "Apply the rule of TABLE once, and add the facts to TABLE."
  (let* ((rule (rule-table-rule table))
         (bindings (bind-head (memory-rule-head rule) (rule-table-pattern table) '()))
         (*rule-depth* (1+ *rule-depth*))
         (around-p (shiftf *incomplete-p* nil)))
    (when (< *rule-depth-limit* *rule-depth*) (reject-endless-rule rule))
    (check-size (rule-table-pattern table) rule)
    (setf (rule-table-round table) *round*)
    (map-solutions (lambda (solution) (add-to-table (fact-of-rule rule solution) table))
                   (memory-rule-query rule) bindings)
    (unless *incomplete-p* (setf (rule-table-complete-p table) t))
    (setf *incomplete-p* (or around-p *incomplete-p*))))

(defun add-to-table (fact table)
  (let ((key (data-key fact)) (keys (rule-table-keys table)))
    (unless (gethash key keys)
      (check-size fact (rule-table-rule table))
      (setf (gethash key keys) t *grown-p* t)
      (vector-push-extend fact (rule-table-facts table)))))

(defun check-size (data rule)
  "Signal MISUSE if DATA, a fact or pattern of RULE, is too large. Then there is no end of them."
  (let ((count 0))
    (destructuring-bind (deepest most) *rule-data-limits*
      (labels ((walk (data depth)
                 (loop while (consp data)
                       do (when (or (< deepest depth) (< most (incf count)))
                            (reject-endless-rule rule))
                          (walk (pop data) (1+ depth)))))
        (walk data 0)))))

(defun reject-endless-rule (rule)
  (reject-use "The memory rule ~(~A~) uses itself without end." (memory-rule-name rule)))

(defun fact-of-rule (rule bindings)
  (let ((fact (instance (memory-rule-head rule) bindings)))
    (unless (ground-p fact)
      (reject-use "The memory rule ~(~A~) gives ~A, in which a variable has no value."
                  (memory-rule-name rule) (data-text fact)))
    fact))

(defun map-comparison (function query bindings)
  "Call FUNCTION with BINDINGS, extended if a variable gets a value, if the comparison QUERY holds."
  (declare (type function function))
  (destructuring-bind (operator a b) (instance query bindings)
    (cond ((and (string= '= operator) (variable-p a)) (funcall function (acons a b bindings)))
          ((and (string= '= operator) (variable-p b)) (funcall function (acons b a bindings)))
          (t (dolist (side (list a b))
               (when (variable-p side) (value-of-variable side '() query)))
             (when (compare (query-operator query) a b) (funcall function bindings))))))

(defun compare (operator a b)
  (case operator
    (= (value-equal a b))
    (/= (not (value-equal a b)))
    (t (unless (and (realp a) (realp b))
         (reject-use "~(~A~) compares numbers, not ~A and ~A." operator
                     (data-text a) (data-text b)))
       (funcall operator a b))))

;;; Checking.

(defun query-valid-p (query &key tests-too)
  "True if QUERY is a query. With TESTS-TOO, (test form) and (value ?x form) are queries."
  (flet ((all (queries) (and (proper-list-p queries)
                             (every (lambda (each) (query-valid-p each :tests-too tests-too))
                                    queries))))
    (case (query-operator query)
      ((nil) (pattern-valid-p query))
      ((and or) (all (rest query)))
      (not (and (all (rest query)) (= 2 (length query))))
      (within (and (typep query '(cons t (cons t (cons t null))))
                   (or (realp (second query)) (variable-p (second query)))
                   (pattern-valid-p (third query))))
      (test (and tests-too (typep query '(cons t (cons t null)))))
      (value (and tests-too (typep query '(cons t (cons (satisfies variable-p) (cons t null))))))
      (t (typep query '(cons t (cons t (cons t null))))))))

(defparameter *query-syntax*
  (format nil "a pattern such as (at ?thing depot), (and query...), (or query...), (not query), (= ~
               a b), also /= < > <= >=, or (within ticks pattern)")
  "What messages say of queries.")

(defun check-query (operator query)
  (unless (query-valid-p query)
    (reject-argument operator 'query query *query-syntax*)))

;;; Asking.

(defun memory-instances (template query)
  "Return a list of instances of TEMPLATE, one for each different way in which QUERY holds."
  (let ((keys (make-hash-table :test 'equal)))
    (loop for bindings in (solve query '())
          for instance = (instance template bindings)
          for key = (data-key instance)
          unless (shiftf (gethash key keys) t) collect instance)))

(defun memory-query (template query)
  "Return a list of instances of TEMPLATE, one for each way in which QUERY holds in the memory of
the current run, without duplicates: (memory-query '?place '(at truck ?place)). A query is
  (name part...)           a pattern of facts; ?x matches anything, each time the same; ? anything
  (and query...), (or query...), (not query)
  (= a b)                  equal; gives a variable without a value the value of the other
  (/= a b) (< a b) (> a b) (<= a b) (>= a b)
  (within ticks pattern)   as PATTERN, for facts that were added at most TICKS ticks ago
Signals WRONG-ARGUMENT, and MISUSE if a variable is compared that has no value."
  (check-query 'memory-query query)
  (memory-instances template query))

(defun memory-holds-p (query)
  "True if QUERY holds in the memory of the current run; see MEMORY-QUERY."
  (check-query 'memory-holds-p query)
  (and (solve query '()) t))
