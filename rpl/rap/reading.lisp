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

(defun query-code (query known &optional (bound known) (whole query))
  "Return a form whose value is QUERY with the values of the Lisp variables KNOWN, and with
functions in place of the forms of its tests and values. BOUND are the variables that have values
before QUERY, which is a part of the query WHOLE."
  (flet ((part-code (part) (query-code part known bound whole)))
    (case (query-operator query)
      (and `(list 'and ,@(loop for part in (rest query)
                               collect (part-code part)
                               do (setf bound (variables-after part bound)))))
      ((or not) `(list ',(query-operator query) ,@(mapcar #'part-code (rest query))))
      (test `(list* 'test ,(form-code query (second query) known bound whole)))
      (value `(list* 'value ,(pattern-code (second query) known)
                     ,(form-code query (third query) known bound whole)))
      (t (pattern-code query known)))))

(defun form-code (query form known bound whole)
  "Return code for a list of a function that does FORM, the Lisp of QUERY, which is a part of the
query WHOLE, and the variables that are its arguments: see QUERY-CODE."
  (let ((arguments (loop for marked in (marked-variables whole)
                         for variable = (code-variable marked)
                         when (and (member variable bound)
                                   (not (member variable known))
                                   (mentions-variable-p form variable))
                           collect marked)))
    `(list* (lambda ,(mapcar #'code-variable arguments)
              (value-of-part
               ',query
               (lambda ()
                 ,@(rejecting-code (set-difference (code-variables whole) bound) whole
                                   (list (code-with-variables form))))))
            ',arguments)))

(defun value-of-part (query function)
  "Return the value of FUNCTION, which does the Lisp of QUERY, (test form) or (value ?x form). In
the debugger, restarts do it again or give it a value."
  (if *leaves-offer-restarts*
      (call-with-value-restarts query function)
      (funcall function)))

(defun mentions-variable-p (form variable)
  (cond ((quoted-p form) nil)
        ((consp form) (or (mentions-variable-p (car form) variable)
                          (mentions-variable-p (cdr form) variable)))
        ((variable-p form) (and (not (anonymous-p form)) (eq variable (variable-of form))))
        (t (eq variable form))))

(defun unquoted (forms)
  "Return the parts of FORMS, code, that are not quoted data."
  (cond ((quoted-p forms) nil)
        ((consp forms) (cons (unquoted (car forms)) (unquoted (cdr forms))))
        (t forms)))

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
    (reject-part query (format nil "~A, (test form) or (value ?x form)" *query-syntax*))))

;;; Which variables have values. A query that holds gives values to those of its patterns; but one
;;; inside (not ...) gives none, and (or ...) only to those that are in all its branches.

(defun check-values (query part bound)
  "Signal an error about QUERY unless all variables in PART are among BOUND, Lisp variables."
  (let ((missing (set-difference (code-variables part) bound)))
    (when missing
      (reject-part query (format nil "~{?~(~A~)~^, ~} with a value: put the pattern that gives it ~
                                      one before this query"
                                 missing)))))

(defun variables-after (query bound)
  "Return the list of BOUND, Lisp variables that have values, and those to which QUERY gives values.
Signal an error if a comparison or test in QUERY uses a variable before it has a value."
  (case (query-operator query)
    ((nil) (union bound (code-variables query)))
    (and (dolist (part (rest query) bound) (setf bound (variables-after part bound))))
    (or (if (rest query)
            (reduce #'intersection
                    (loop for part in (rest query) collect (variables-after part bound)))
            bound))
    (not (variables-after (second query) bound)
     bound)
    (within (check-values query (second query) bound)
     (union bound (code-variables (third query))))
    (test (check-values query (unquoted (rest query)) bound)
     bound)
    (value (check-values query (unquoted (cddr query)) bound)
     (union bound (code-variables (second query))))
    (= (equal-variables-after query bound))
    (t (check-values query (rest query) bound)
     bound)))

(defun equal-variables-after (query bound)
  "Do as VARIABLES-AFTER for QUERY, (= a b): a variable gets the value of the other side."
  (destructuring-bind (a b) (rest query)
    (flet ((free-p (part)
             (and (variable-p part) (not (member (variable-of part) bound)))))
      (cond ((free-p a) (check-values query b bound))
            ((free-p b) (check-values query a bound))
            (t (check-values query (list a b) bound)))
      (union bound (code-variables (rest query))))))

(defmacro variable-without-value (title query name)
  "Signal an error: the definition TITLE uses the variable NAME, to which QUERY gives no value."
  (reject-clause title query (format nil "a query that gives ?~(~A~) a value before it is used; ~
                                          inside (not ...), or in only some branches of (or ~
                                          ...), it gets none" name)))

(defun rejecting-code (names query forms)
  "Return FORMS, code, in which the use of a variable NAMES is an error about QUERY."
  (if names
      `((symbol-macrolet ,(loop for name in names
                                collect `(,name (variable-without-value ,*rap-title* ,query
                                                                        ,name)))
          ,@forms))
      forms))

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
  "Return the rest of the clause NAME among CLAUSES, or NIL. Signal an error if there are several,
or if nothing follows the name."
  (let ((found (clauses-named name clauses)))
    (when (rest found) (reject-part (second found) (format nil "only one clause ~(~A~)" name)))
    (when (and found (null (rest (first found))))
      (reject-part (first found) (format nil "something after ~(~A~), or no such clause" name)))
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

(defun body-clause (clauses method)
  "Return the clause TASK-NET or PRIMITIVE among CLAUSES, those of the clause METHOD."
  (let ((bodies (append (clauses-named 'task-net clauses) (clauses-named 'primitive clauses))))
    (unless (= 1 (length bodies))
      (reject-part method "either a clause (task-net step...) or a clause (primitive form...)"))
    (unless (rest (first bodies))
      (reject-part method (format nil "at least one ~:[form~;step~] in ~(~A~)"
                                  (clauses-named 'task-net clauses) (first bodies))))
    (first bodies)))

(defun checked-resources (clauses known)
  "Return the names and variables in the clause RESOURCES among CLAUSES. KNOWN have values."
  (let ((resources (only-clause 'resources clauses)))
    (dolist (resource resources resources)
      (unless (and resource (symbolp resource)
                   (or (not (variable-p resource)) (member (variable-of resource) known)))
        (reject-part (first (clauses-named 'resources clauses))
                     "names, or variables such as ?x that have values")))))

(defun parse-method (clause number known results)
  "Return the method of CLAUSE, (method [name] clause...). KNOWN are the Lisp variables of the
index, RESULTS those of its results."
  (let* ((name (and (symbolp (second clause)) (second clause)))
         (clauses (nthcdr (if name 2 1) clause)))
    (check-clause-names clauses '(context resources task-net primitive))
    (let* ((body (body-clause clauses clause))
           (context (query-clause 'context clauses))
           (all (set-difference (code-variables context) known))
           (bound (if context (variables-after context known) known))
           (variables (reverse (intersection all bound)))
           (unbound (set-difference all (append bound results))))
      (make-rap-method
       :name (or name (intern (format nil "METHOD-~D" number)))
       :context context
       :resources (checked-resources clauses bound)
       :variables variables
       :body (if (string= 'task-net (first body))
                 (list (task-net-code body (append variables known) results))
                 (rejecting-code unbound context (code-with-variables (rest body))))))))

(defun parse-methods (clauses known results)
  "Return the methods of CLAUSES; see PARSE-METHOD. Signal an error unless their names differ."
  (let ((methods '()))
    (loop for clause in clauses
          for number from 1
          for method = (parse-method clause number known results)
          for name = (rap-method-name method)
          do (when (find name methods :key #'rap-method-name :test #'string=)
               (reject-part clause (format nil "a method of another name: an earlier method is ~
                                                called ~(~A~)" name)))
             (push method methods))
    (reverse methods)))
