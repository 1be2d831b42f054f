;;;; memory.lisp -- what a robot believes: facts, and rules that follow from them.

(in-package :ars-rap)

;;; A fact is a list of plain data that begins with a symbol, such as (at truck depot). The memory
;;; is a run variable, so forks, rewinds and saved runs have their own. An entry is a list (fact
;;; tick), the newest first. Entries are never modified, so a new value shares them with the old.
;;; The journal records what is added and deleted, not the whole memory. Symbols, also variables,
;;; compare by name and numbers by value, as in patterns of goals.

(define-run-variable main-memory* '()
  "The memory of the current run: a list of lists (fact tick), the newest first. TICK is the tick at
which the fact was last added.")

(defun now () (simulation-tick))

(defun memory-entries ()
  "Return the entries of the memory of the current run, which the caller must not modify."
  (stored-run-variable 'main-memory*))

;;; Patterns.

(defun variable-p (object)
  "True if OBJECT is a variable of a pattern, such as ?x."
  (if (symbolp object)
      (let ((name (symbol-name object)))
        (and (plusp (length name)) (char= #\? (char name 0))))
      (matchvar-p object)))

(defun anonymous-p (variable)
  "True if VARIABLE is ? or ?(), which matches anything."
  (if (matchvar-p variable)
      (null (matchvar-name variable))
      (string= "?" (symbol-name variable))))

(defun variable-name (variable)
  "Return the name of VARIABLE with its question mark, a string."
  (if (matchvar-p variable)
      (format nil "?~@[~A~]" (matchvar-name variable))
      (symbol-name variable)))

(defun binding-of (variable bindings)
  "Return the element of BINDINGS for VARIABLE, in whatever package that was read, or NIL."
  (or (assoc variable bindings :test #'eq)
      (and bindings (assoc (variable-name variable) bindings :key #'variable-name
                                                             :test #'string=))))

(defun match (pattern object bindings)
  "Match PATTERN with OBJECT under BINDINGS, a list of conses (variable . value). Return the
extended bindings, or :FAIL."
  (cond ((variable-p pattern)
         (let ((binding (binding-of pattern bindings)))
           (cond ((anonymous-p pattern) bindings)
                 ((null binding) (acons pattern object bindings))
                 ((value-equal (cdr binding) object) bindings)
                 (t :fail))))
        ((consp pattern)
         (if (consp object)
             (let ((bindings (match (car pattern) (car object) bindings)))
               (if (eq :fail bindings) :fail (match (cdr pattern) (cdr object) bindings)))
             :fail))
        ((value-equal pattern object) bindings)
        (t :fail)))

(defun instance (pattern bindings)
  "Return PATTERN with the values of its variables under BINDINGS. Others stay."
  (cond ((variable-p pattern)
         (let ((binding (binding-of pattern bindings)))
           (if binding (cdr binding) pattern)))
        ((consp pattern) (cons (instance (car pattern) bindings) (instance (cdr pattern) bindings)))
        (t pattern)))

(defun ground-p (pattern)
  (cond ((variable-p pattern) nil)
        ((consp pattern) (and (ground-p (car pattern)) (ground-p (cdr pattern))))
        (t t)))

;;; Facts.

(defparameter *query-operators* '(and or not = /= < > <= >= within test value)
  "The symbols that begin a query which is no pattern of facts.")

(defun query-operator (query)
  "Return the operator of QUERY, a symbol of *QUERY-OPERATORS*, or NIL if QUERY is a pattern."
  (and (consp query) (symbolp (first query))
       (find (first query) *query-operators* :test #'string=)))

(defun pattern-valid-p (object)
  (and (proper-list-p object)
       object
       (symbolp (first object))
       (first object)
       (not (variable-p (first object)))
       (not (query-operator object))))

(defparameter *memory-limit* 100000 "How many facts a memory can have.")

(defun check-fact (operator fact)
  ;; Only what ends can be looked at: no list in itself.
  (when (plain-datum-p fact (constantly t))
    (unless (and (pattern-valid-p fact) (ground-p fact))
      (reject-argument operator 'fact (abridged fact)
                       (format nil "a list that begins with a symbol other than ~{~(~A~)~^, ~}, ~
                                    and contains no variable ?x"
                               *query-operators*))))
  (check-run-variable-value operator 'fact fact (world-of-current-run 'main-memory*)))

(defun check-pattern (operator pattern)
  (unless (pattern-valid-p pattern)
    (reject-argument operator 'pattern pattern "a pattern of facts, such as (at truck ?place)")))

(defun matching-entry-p (pattern)
  (lambda (entry) (not (eq :fail (match pattern (first entry) '())))))

(defun find-entry (fact entries)
  (find-if (lambda (entry) (value-equal fact (first entry))) entries))

(defun entries-with (fact entries operator)
  "Return ENTRIES with FACT, which OPERATOR adds in this tick, at the beginning. Signals MISUSE."
  (let ((old (find-entry fact entries)))
    (when (and (null old) (<= *memory-limit* (length entries)))
      (reject-use "~(~A~): there is no room for the fact ~A. The memory has ~D facts, and can have ~
                   no more. Delete some by (memory-delete PATTERN)."
                  operator (data-text fact) *memory-limit*))
    (cons (list fact (now)) (if old (remove old entries :test #'eq) entries))))

(defun entries-without (pattern entries)
  "Return ENTRIES without the facts that match PATTERN, and how many these were."
  (let ((kept (remove-if (matching-entry-p pattern) entries)))
    (values kept (- (length entries) (length kept)))))

(defun kept-pattern (pattern)
  "Return PATTERN as a copy of plain data for the journal, with keywords as variables."
  (cond ((consp pattern) (cons (kept-pattern (car pattern)) (kept-pattern (cdr pattern))))
        ((variable-p pattern) (intern (variable-name pattern) :keyword))
        (t (copied-value pattern))))

(defun memory-add (fact)
  "Add FACT, a list such as (at truck depot), to the memory of the current run, or renew its tick if
it is there. Return FACT. Signals WRONG-ARGUMENT. (From RAP.)"
  (check-fact 'memory-add fact)
  (let ((kept (copied-value fact)))
    (update-run-variable 'main-memory*
                         (lambda (entries) (entries-with kept entries 'memory-add))
                         'memory-add kept))
  fact)

(defun memory-delete (pattern)
  "Delete all facts that match PATTERN, such as (at ?thing depot), from the memory of the current
run. Return how many there were. Signals WRONG-ARGUMENT. (From RAP.)"
  (check-pattern 'memory-delete pattern)
  (if (notany (matching-entry-p pattern) (memory-entries))
      0
      (let ((kept (kept-pattern pattern)))
        (update-run-variable 'main-memory*
                             (lambda (entries) (entries-without kept entries))
                             'memory-delete kept))))

(defun memory-set (fact)
  "Add FACT, and delete the facts that differ from it in the last element only: after (memory-set
'(at truck depot)), the truck is nowhere else. Return FACT. Signals WRONG-ARGUMENT."
  (check-fact 'memory-set fact)
  (unless (rest fact)
    (reject-argument 'memory-set 'fact fact "a list with a name and one or several other elements"))
  (let* ((kept (copied-value fact)) (pattern (append (butlast kept) (list '?))))
    (update-run-variable 'main-memory*
                         (lambda (entries)
                           (entries-with kept (entries-without pattern entries) 'memory-set))
                         'memory-set kept))
  fact)

(defun memory-tick (fact)
  "Return the tick at which FACT was last added to the memory of the current run, or NIL."
  (check-fact 'memory-tick fact)
  (second (find-entry fact (memory-entries))))

(defun reset-memory ()
  "Delete all facts of the current run. Return nothing. (From RAP.)"
  (update-run-variable 'main-memory* (constantly '()) 'reset-memory)
  (values))

(define-operator 'memory-add '(datum) #'memory-add)
(define-operator 'memory-delete '(datum) #'memory-delete)
(define-operator 'memory-set '(datum) #'memory-set)
(define-operator 'reset-memory '() #'reset-memory)

(defun dump-memory (&key assertion (stream *standard-output*))
  "Write the facts of the current run to STREAM, each with its tick, the newest first. With
ASSERTION, a pattern, write only the facts that match it. Return nothing. (From RAP.)"
  (when assertion (check-pattern 'dump-memory assertion))
  (loop for (fact tick) in (if assertion
                               (remove-if-not (matching-entry-p assertion) (memory-entries))
                               (memory-entries))
        do (format stream "~&~8D  ~A~%" tick (data-text fact)))
  (values))

(defun data-text (data)
  "Return the text of DATA as it can be typed, in lower case, without packages."
  (let ((*print-pretty* nil)) (text-as-typed data)))
