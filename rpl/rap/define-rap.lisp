;;;; define-rap.lisp -- DEFINE-RAP: a plan that tries methods until its success test holds.

(in-package :ars-rap)

;;; A RAP is a plan procedure of the name of its index. So steps of task nets are calls of plans,
;;; and any plan can be a step.

(defparameter *net-tries* 3
  "How often a step is repeated whose annotation (fact for step) does not hold.")

(define-task-variable goal-priority* 0
  "The priority with which the RAPs of a goal take their resources: a number. INSTALL-GOAL sets
it.")

;;; What the plan text of RAPs calls.

(defun holds-p (query) (and (solve query '()) t))

(defun over-word-p (status)
  (and (member status '(:succeeded :failed :evaporated)) t))

(defun over-p (task)
  (over-word-p (fluent-value (task-status task))))

;;; Resources belong to a robot: its plans and goals share them, and other robots have their own.

(defun resource-valve (name)
  "Return the valve of the resource NAME of the robot that the calling task drives."
  (let ((agent (agent-driven (current-task))))
    (cdr (or (assoc name (agent-note agent 'resources) :test #'value-equal)
             (first (push (cons name (make-valve name)) (agent-note agent 'resources)))))))

;;; The plan text.

(defun method-row-code (method known)
  (let ((context (rap-method-context method)))
    `(list ',(rap-method-name method)
           ,(and context (query-code context known))
           ,@(loop for variable in (rap-method-variables method)
                   collect `',(find variable (marked-variables context) :key #'code-variable)))))

(defun with-resources-code (resources body)
  "Return plan text that runs the forms BODY while their task owns RESOURCES, names or variables."
  (cond (resources
         `(shown-as (resources ,@resources)
            (with-valves (,@(loop for resource in resources
                                  collect `(resource-valve ,(if (variable-p resource)
                                                                (variable-of resource)
                                                                `',resource)))
                          :priority goal-priority*)
              ,@body)))
        ((rest body) `(seq ,@body))
        (t (first body))))

(def-interp-macro (with-resources ?names . ?forms)
  "Run FORMS in a plan while their task owns the resources NAMES, symbols that are not evaluated, or
?x for the value of the variable x. Resources belong to the robot that the plan drives: if another
task for this robot, of any plan or goal, owns one, wait. GOAL-PRIORITY* is the priority: a task
with a higher priority than the owner's takes the resource, and the owner is suspended meanwhile. A
part of the owner can own the resource as well, one part at a time. Return the values of FORMS."
  (unless (and (proper-list-p names) names (every #'symbolp names))
    (reject-clause "with-resources" names "a list of names"))
  (with-resources-code names forms))

(defun method-code (method results)
  "Return the element of a form RAP-TRIES for METHOD. Variables that are RESULTS of the RAP are
around; they get their values first."
  (let* ((variables (rap-method-variables method))
         (bound (loop for variable in variables
                      collect (if (member variable results)
                                  (make-symbol (symbol-name variable))
                                  variable))))
    `(,(rap-method-name method) ,variables ,bound
      ,@(loop for variable in variables
              for inner in bound
              unless (eq variable inner) collect `(setf ,variable ,inner))
      ,(with-resources-code (rap-method-resources method) (rap-method-body method)))))

(defun value-code (succeed results known)
  "Return a form for the values of a RAP that has succeeded: T, or those of RESULTS, Lisp
variables."
  (cond ((null results) t)
        (succeed
         (let ((marked (marked-variables succeed)))
           `(values-list (first (memory-instances
                                 (list ,@(loop for variable in results
                                               collect `',(find variable marked
                                                                :key #'code-variable)))
                                 ,(query-code succeed known))))))
        (t `(values ,@results))))

(defun tries-code (call methods succeed results known limit)
  "Return plan text that tries METHODS until SUCCEED, a query or NIL, holds."
  `(rap-tries (,(first call) ,@known) ,limit
              ,(and succeed `(holds-p ,(query-code succeed known)))
              (list ,@(loop for method in methods collect (method-row-code method known)))
              ,@(loop for method in methods collect (method-code method results))))

(defun rap-code (index documentation clauses environment)
  (multiple-value-bind (call results) (split-result index)
    (let* ((known (mapcar #'variable-of (rest call)))
           (methods (parse-methods (clauses-named 'method clauses) known results))
           (succeed (query-clause 'succeed clauses)))
      (check-results results succeed known)
      (define-procedure-code
       (first call) known
       `(,@(and documentation (list documentation))
         (let ,results
           (declare (ignorable ,@known))
           (shown-as ,call
             ,(with-resources-code (checked-resources clauses known)
                                   (list (tries-code call methods succeed results known
                                                     (attempts-of clauses)))))
           ,(value-code succeed results known)))
       clauses environment))))

(defun define-procedure-code (name parameters body clauses environment)
  "Return the form that defines the plan procedure of the RAP NAME, whose text is CLAUSES."
  (check-plan-name *rap-title* name)
  (let ((text `(define-rap ,name ,@clauses)))
    (call-with-definition text (lambda ()
                                 (procedure-form name parameters body environment text)))))

(defun check-results (results succeed known)
  (when succeed
    (let ((missing (set-difference results (variables-after succeed known))))
      (when missing
        (reject-part succeed (format nil "a query that gives the result~P ~{?~(~A~)~^, ~} a value ~
                                          whenever it holds"
                                     (length missing) missing))))))

(defun attempts-of (clauses)
  (let ((attempts (only-clause 'attempts clauses)))
    (unless (typep attempts '(or null (cons (integer 1) null)))
      (reject-part (first (clauses-named 'attempts clauses))
                   "(attempts n), with a positive integer"))
    (if attempts (first attempts) 2)))

(defun check-index (index)
  (unless (and (proper-list-p index) (first index) (symbolp (first index))
               (every #'variable-p (rest (split-result index)))
               (notany #'anonymous-p (rest (split-result index))))
    (reject-part index "an index (name ?argument... [=> ?result...])"))
  (let ((variables (remove-if-not #'variable-p (rest index))))
    (unless (= (length variables) (length (code-variables variables)))
      (reject-part index "different variables"))))

(define-user-macro define-rap (&body clauses &environment environment)
  "Define a RAP, a reactive action package: a plan procedure that tries methods until its success
test holds. A string may precede the clauses. They are
  (index (name ?argument... [=> ?result...]))   the name of the plan, its arguments and its values
  (succeed query)          the success test; see MEMORY-QUERY. A RAP without it succeeds when a
                           method succeeds
  (attempts n)             how often a method is tried with the same values; by default 2
  (resources name...)      what the RAP needs for itself; see WITH-RESOURCES
  (method [name] (context query) (resources name...) (task-net step...))
  (method [name] (context query) (resources name...) (primitive form...))
If the success test holds, the RAP succeeds. Otherwise it runs one method and tests again. It
chooses among the methods whose context holds, with each way of giving values to its variables, one
that it has tried least, and among equals the first. It fails with RAP-FAILED when there is none
that it has tried fewer than N times. An error of Lisp ends the RAP.
A query may also contain (test form), and (value ?x form), which gives ?x the value of FORM. FORM is
Lisp, and the forms of a primitive are plan text. In both, ?x means the variable x, except in quoted
data: there, it stays a variable of a pattern. (return) leaves a primitive, whose method has then
succeeded; (fail) lets the method fail.
A step of a task net is
  (tag (plan argument... [=> ?result...]) annotation...), (sequence step...) or (parallel step...)
PLAN is a RAP or another plan. Steps run at the same time unless sequences and annotations order
them:
  (for tag)                the step comes before the step TAG
  (fact for tag)           so it does; if the query FACT does not hold then, it is repeated
  (wait-for query tag)     the step TAG waits until this step has begun and QUERY holds
  (wait-for query :succeed), (wait-for query :fail)   QUERY ends this step
  (until-start tag), (until-end tag)   the start or end of the step TAG ends this step
A step that uses a result comes after the step that gives it.
Return the name. Signals MALFORMED-DEFINITION. (From RAP, after Firby 1989 and 1995.)"
  (let* ((documentation (and (stringp (first clauses)) (first clauses)))
         (clauses (if documentation (rest clauses) clauses))
         (index (find-if (lambda (clause) (and (consp clause) (symbolp (first clause))
                                               (string= 'index (first clause))))
                         clauses))
         (*rap-title* (if (typep index '(cons t (cons cons)))
                          (definition-title "define-rap" (first (second index)))
                          "define-rap")))
    (check-clause-names clauses '(index succeed attempts resources method))
    (unless (typep index '(cons t (cons cons null)))
      (reject-part index "a clause (index (name ?argument...))"))
    (only-clause 'index clauses)
    (check-index (second index))
    (unless (clauses-named 'method clauses)
      (reject-part index "at least one clause (method ...)"))
    (rap-code (second index) documentation clauses environment)))
