;;;; queries.lisp -- questions to the memory, and rules.

(in-package :ars-rap)

;;; The answer to a query is a list of bindings, in the order of the memory, the newest fact first.
;;; The rules of a memory work backwards: a fact that follows from others is in no memory.

(define-record (memory-rule (:constructor make-memory-rule (name head query documentation)))
  "A rule by which facts follow from others, defined by DEFINE-MEMORY-RULE."
  (name nil symbol "the name of the rule")
  (head nil list "the pattern of the facts that follow")
  (query nil list "the query from which they follow")
  (documentation nil (or null string)))

(define-registry memory-rule "memory rule" :object-p memory-rule-p :by-symbol t :internal t)

(defparameter *rule-depth-limit* 1000 "How deeply rules may use each other.")

(defvar *rules-in-use* '()
  "What this thread is finding out by rules, innermost first: lists (rule pattern).")

(defun solve (query bindings)
  "Return a list of the extensions of BINDINGS for which QUERY holds."
  (case (query-operator query)
    ((nil) (solve-pattern query bindings (lambda (tick) (declare (ignore tick)) t)))
    (and (let ((all (list bindings)))
           (dolist (part (rest query) all)
             (setf all (loop for each in all append (solve part each))))))
    (or (loop for part in (rest query) append (solve part bindings)))
    (not (if (solve (second query) bindings) '() (list bindings)))
    (within (destructuring-bind (span pattern) (rest query)
              (let ((since (- (now) (instance span bindings))))
                (solve-pattern pattern bindings (lambda (tick) (<= since tick))))))
    (test (destructuring-bind (function . variables) (rest query)
            (and (apply function (loop for variable in variables
                                       collect (value-of-variable variable bindings query)))
                 (list bindings))))
    (t (solve-comparison query bindings))))

(defun value-of-variable (variable bindings query)
  (cdr (or (assoc variable bindings :test #'eq)
           (reject-use "In the query ~A, the variable ~A has no value. Put the pattern that gives ~
                        it one before."
                       (data-text query) (data-text variable)))))

(defun solve-pattern (pattern bindings tick-test)
  "Return the extensions of BINDINGS by which PATTERN matches facts whose ticks pass TICK-TEST, or
facts that follow by rules."
  (append (loop for (fact tick) in main-memory*
                for extended = (if (funcall tick-test tick) (match pattern fact bindings) :fail)
                unless (eq :fail extended) collect extended)
          (loop for rule in (all-memory-rules)
                append (loop for fact in (facts-by-rule rule (instance pattern bindings))
                             for extended = (match pattern fact bindings)
                             unless (eq :fail extended) collect extended))))

(defun bind-head (head pattern bindings)
  "Match HEAD, of a rule, with PATTERN, which may have variables: they match anything."
  (cond ((variable-p pattern) bindings)
        ((and (consp head) (consp pattern))
         (let ((bindings (bind-head (car head) (car pattern) bindings)))
           (if (eq :fail bindings) :fail (bind-head (cdr head) (cdr pattern) bindings))))
        ((and (variable-p head) (not (ground-p pattern))) bindings)
        (t (match head pattern bindings))))

(defun generalized (pattern)
  "Return PATTERN with ? in place of its variables."
  (cond ((variable-p pattern) '?)
        ((consp pattern) (cons (generalized (car pattern)) (generalized (cdr pattern))))
        (t pattern)))

;;; While the facts of a pattern are found out by a rule, the rule gives no facts for the same
;;; pattern again. So rules about circular relations come to an end.

(defun facts-by-rule (rule pattern)
  "Return the facts that follow by RULE and may match PATTERN."
  (let ((bindings (bind-head (memory-rule-head rule) pattern '()))
        (use (list rule (generalized pattern))))
    (unless (or (eq :fail bindings) (member use *rules-in-use* :test #'value-equal))
      (when (< *rule-depth-limit* (length *rules-in-use*))
        (reject-use "The memory rule ~(~A~) uses itself without end." (memory-rule-name rule)))
      (let ((*rules-in-use* (cons use *rules-in-use*)))
        (loop for solution in (solve (memory-rule-query rule) bindings)
              collect (fact-of-rule rule solution))))))

(defun fact-of-rule (rule bindings)
  (let ((fact (instance (memory-rule-head rule) bindings)))
    (unless (ground-p fact)
      (reject-use "The memory rule ~(~A~) gives ~A, in which a variable has no value."
                  (memory-rule-name rule) (data-text fact)))
    fact))

(defun solve-comparison (query bindings)
  (destructuring-bind (operator a b) (instance query bindings)
    (cond ((and (string= '= operator) (variable-p a)) (list (acons a b bindings)))
          ((and (string= '= operator) (variable-p b)) (list (acons b a bindings)))
          (t (dolist (side (list a b))
               (when (variable-p side) (value-of-variable side '() query)))
             (if (compare (query-operator query) a b) (list bindings) '())))))

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
  "True if QUERY is a query. With TESTS-TOO, (test form) is one."
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
  (remove-duplicates (mapcar (lambda (bindings) (instance template bindings)) (solve query '()))
                     :test #'value-equal :from-end t))

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

(defmacro define-memory-rule (name head query &optional documentation)
  "Define the rule NAME: facts that match HEAD, a pattern, follow whenever QUERY holds; see
MEMORY-QUERY. Rules may use each other. Return NAME. Signals MALFORMED-DEFINITION."
  (let ((definition (definition-title "define-memory-rule" name)))
    (unless (and name (symbolp name) (not (keywordp name)))
      (reject-clause definition name "a symbol as the name"))
    (unless (pattern-valid-p head)
      (reject-clause definition head "a pattern of facts, such as (near ?a ?b)"))
    (unless (query-valid-p query)
      (reject-clause definition query *query-syntax*))
    (unless (typep documentation '(or null string))
      (reject-clause definition documentation "a string"))
    `(progn (register *memory-rules* ',name
                      (make-memory-rule ',name ',head ',query ,documentation))
            ',name)))
