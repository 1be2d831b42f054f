;;;; memory.lisp -- what a robot believes: facts, and rules that follow from them.

(in-package :ars-rap)

;;; A fact is a list of plain data that begins with a symbol, such as (at truck depot). The memory
;;; is a run variable, so forks, rewinds and saved runs have their own. An entry is a list (fact
;;; tick), the newest first. Symbols compare by name and numbers by value, as in patterns of goals.

(define-run-variable main-memory* '()
  "The memory of the current run: a list of lists (fact tick), the newest first. TICK is the tick at
which the fact was last added.")

(defun now () (simulation-tick))

(defmacro changing-memory (&body body)
  "Run BODY, which computes a new value of the memory from its old value, while the run stands
still: no change by another thread comes in between."
  `(asking ((current-simulation)) ,@body))

;;; Patterns.

(defun variable-p (object)
  "True if OBJECT is a variable of a pattern, such as ?x."
  (or (matchvar-p object)
      (and (symbolp object) (starts-with-subseq "?" (symbol-name object)))))

(defun anonymous-p (variable)
  "True if VARIABLE is ? or ?(), which matches anything."
  (if (matchvar-p variable)
      (null (matchvar-name variable))
      (string= "?" (symbol-name variable))))

(defun match (pattern object bindings)
  "Match PATTERN with OBJECT under BINDINGS, a list of conses (variable . value). Return the
extended bindings, or :FAIL."
  (cond ((variable-p pattern)
         (let ((binding (assoc pattern bindings :test #'eq)))
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
         (let ((binding (assoc pattern bindings :test #'eq)))
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

(defun check-fact (operator fact)
  (unless (and (pattern-valid-p fact) (ground-p fact))
    (reject-argument operator 'fact fact
                     (format nil "a list that begins with a symbol other than ~{~(~A~)~^, ~}, and ~
                                  contains no variable ?x"
                             *query-operators*))))

(defun check-pattern (operator pattern)
  (unless (pattern-valid-p pattern)
    (reject-argument operator 'pattern pattern "a pattern of facts, such as (at truck ?place)")))

(defun matching-entry-p (pattern)
  (lambda (entry) (not (eq :fail (match pattern (first entry) '())))))

(defun memory-add (fact)
  "Add FACT, a list such as (at truck depot), to the memory of the current run, or renew its tick if
it is there. Return FACT. Signals WRONG-ARGUMENT. (From RAP.)"
  (check-fact 'memory-add fact)
  (changing-memory
    (setf main-memory*
          (cons (list fact (now)) (remove-if (matching-entry-p fact) main-memory*))))
  fact)

(defun memory-delete (pattern)
  "Delete all facts that match PATTERN, such as (at ?thing depot), from the memory of the current
run. Return how many there were. Signals WRONG-ARGUMENT. (From RAP.)"
  (check-pattern 'memory-delete pattern)
  (changing-memory
    (let* ((entries main-memory*) (kept (remove-if (matching-entry-p pattern) entries)))
      (unless (= (length kept) (length entries)) (setf main-memory* kept))
      (- (length entries) (length kept)))))

(defun memory-set (fact)
  "Add FACT, and delete the facts that differ from it in the last element only: after (memory-set
'(at truck depot)), the truck is nowhere else. Return FACT. Signals WRONG-ARGUMENT."
  (check-fact 'memory-set fact)
  (changing-memory
    (memory-delete (append (butlast fact) (list '?)))
    (memory-add fact)))

(defun memory-tick (fact)
  "Return the tick at which FACT was last added to the memory of the current run, or NIL."
  (check-fact 'memory-tick fact)
  (second (find-if (matching-entry-p fact) main-memory*)))

(defun reset-memory ()
  "Delete all facts of the current run. Return nothing. (From RAP.)"
  (setf main-memory* '())
  (values))

(defun dump-memory (&key assertion (stream *standard-output*))
  "Write the facts of the current run to STREAM, each with its tick, the newest first. With
ASSERTION, a pattern, write only the facts that match it. Return nothing. (From RAP.)"
  (when assertion (check-pattern 'dump-memory assertion))
  (loop for (fact tick) in (if assertion
                               (remove-if-not (matching-entry-p assertion) main-memory*)
                               main-memory*)
        do (format stream "~&~8D  ~A~%" tick (data-text fact)))
  (values))

(defun data-text (data)
  "Return the text of DATA, in lower case, without packages."
  (labels ((plain (data)
             (cond ((consp data) (cons (plain (car data)) (plain (cdr data))))
                   ((and data (symbolp data) (not (keywordp data)))
                    (make-symbol (string-downcase (symbol-name data))))
                   (t data))))
    (let ((*print-pretty* nil))
      (safe-text (plain data) :escape nil))))
