;;;; reading.lisp -- the parts of a DEFINE-RAP form.

(in-package :ars-rap)

(defvar *rap-title* "define-rap" "What messages call the definition that is being expanded.")

(defun reject-part (part expected)
  (reject-clause *rap-title* part expected))

;;; ?x in a pattern is the Lisp variable x in code.

(defun code-variables (object)
  "Return the Lisp variables for the variables in OBJECT, in order, without those of ? and ?()."
  (let ((found '()))
    (labels ((walk (object)
               (cond ((variable-p object)
                      (unless (anonymous-p object) (pushnew (variable-of object) found)))
                     ((consp object) (walk (car object)) (walk (cdr object))))))
      (walk object))
    (reverse found)))

(defun quoted-p (form)
  "True if FORM is quoted, with a quote or a backquote."
  (and (consp form)
       (symbolp (car form))
       (member (car form) '(quote quasiquote) :test #'string=)))

(defun code-with-variables (form)
  "Return FORM, code, with the Lisp variable x in place of ?x. Quoted data stay patterns."
  (cond ((variable-p form) (if (anonymous-p form) form (variable-of form)))
        ((quoted-p form) form)
        ((consp form) (cons (code-with-variables (car form)) (code-with-variables (cdr form))))
        (t form)))

(defun pattern-code (pattern known)
  "Return a form whose value is PATTERN with the values of the Lisp variables KNOWN in it."
  (cond ((variable-p pattern)
         (if (and (not (anonymous-p pattern)) (member (variable-of pattern) known))
             (variable-of pattern)
             `',pattern))
        ((and (consp pattern) (intersection known (code-variables pattern)))
         `(cons ,(pattern-code (car pattern) known) ,(pattern-code (cdr pattern) known)))
        (t `',pattern)))

(defun query-code (query known)
  "Return a form whose value is QUERY with the values of the Lisp variables KNOWN, and with
functions in place of the forms of its tests."
  (case (query-operator query)
    ((and or not) `(list ',(query-operator query)
                         ,@(loop for part in (rest query) collect (query-code part known))))
    (test (let ((variables (set-difference (marked-variables query) known :key #'code-variable)))
            `(list* 'test (lambda ,(mapcar #'code-variable variables)
                            ,(code-with-variables (second query)))
                    ',variables)))
    (t (pattern-code query known))))

(defun code-variable (variable)
  (if (variable-p variable) (variable-of variable) variable))

(defun marked-variables (object)
  "Return the variables in OBJECT as they are written."
  (let ((found '()))
    (labels ((walk (object)
               (cond ((variable-p object) (pushnew object found))
                     ((consp object) (walk (car object)) (walk (cdr object))))))
      (walk object))
    (reverse found)))

(defun check-rap-query (query)
  (unless (query-valid-p query :tests-too t)
    (reject-part query (format nil "~A, or (test form)" *query-syntax*))))

;;; Clauses.

(defun split-result (index)
  "Return the index or step INDEX, (name argument... [=> variable...]), without results, and the
list of the variables of its results."
  (let ((arrow (member "=>" index :test (lambda (word part)
                                          (and (symbolp part) (string= word part))))))
    (unless (every (lambda (part) (and (variable-p part) (not (anonymous-p part)))) (rest arrow))
      (reject-part index "variables such as ?x after =>"))
    (values (ldiff index arrow) (mapcar #'variable-of (rest arrow)))))

(defun clauses-named (name clauses)
  (remove name clauses :key #'first :test-not #'string=))

(defun check-clause-names (clauses names)
  (dolist (clause clauses)
    (unless (and (consp clause) (symbolp (first clause)) (proper-list-p clause)
                 (member (first clause) names :test #'string=))
      (reject-part clause (format nil "one of the clauses ~{(~(~A~) ...)~^, ~}" names)))))

(defun only-clause (name clauses)
  "Return the rest of the clause NAME among CLAUSES, or NIL. Signal an error if there are several."
  (let ((found (clauses-named name clauses)))
    (when (rest found) (reject-part (second found) (format nil "only one clause ~(~A~)" name)))
    (rest (first found))))

(defun query-clause (name clauses)
  "Return the query of the clause NAME among CLAUSES, or NIL. Several queries count as (and ...)."
  (let ((queries (only-clause name clauses)))
    (when queries
      (let ((query (if (rest queries) (cons 'and queries) (first queries))))
        (check-rap-query query)
        query))))

(defstruct (rap-method (:copier nil))
  "A method of a RAP: CONTEXT is a query or NIL; BODY is plan text; VARIABLES are those of CONTEXT."
  (name nil :read-only t)
  (context nil :read-only t)
  (resources '() :read-only t)
  (body '() :read-only t)
  (variables '() :read-only t))

(defun parse-method (clause number known results)
  "Return the method of CLAUSE, (method [name] clause...). KNOWN are the Lisp variables of the
index, RESULTS those of its results."
  (let* ((name (and (symbolp (second clause)) (second clause)))
         (clauses (nthcdr (if name 2 1) clause)))
    (check-clause-names clauses '(context resources task-net primitive))
    (let* ((context (query-clause 'context clauses))
           (net (only-clause 'task-net clauses))
           (primitive (only-clause 'primitive clauses))
           (variables (reverse (set-difference (code-variables context) known))))
      (unless (if net (null primitive) primitive)
        (reject-part clause "either a clause (task-net step...) or a clause (primitive form...)"))
      (make-rap-method
       :name (or name (intern (format nil "METHOD-~D" number)))
       :context context
       :resources (only-clause 'resources clauses)
       :variables variables
       :body (if net
                 (list (task-net-code net (append variables known) results))
                 (code-with-variables primitive))))))
