;;;; tags.lisp -- tasks by name: with-tags, (:tag name form), the status of a task.

(in-package :ars-magna.rpl.language)

(export '(start-branch tagged-scope tags-in with-tags-code))

;;; WITH-TAGS binds the name of each (:tag name form) in it to a task that is yet to start, so that
;;; other branches can refer to it before. A second run of the same form gets a task of its own,
;;; with the same status fluent.

(define-expression tagged
  "BODY as a task of its own called NAME. PLACE returns the environment that holds the task and
its index there, NIL if none does. LAYERS are those of its scope; REPLACED is NIL, or a list of what
BODY is the code of and of the node that it stands for: see replacing.lisp."
  (:parts (name symbol) (place function) (body node) (layers list) (replaced list))
  (:steps
   (begin
    (next inside)
    (start-branch node task environment 0 (task-level task))
    (park task nil)
    +parked+)
   (inside (values (frame-up frame) value)))
  (:child-ended
   (unless (fail-or-escape task how result)
     (complete task result))))

(defun tag-task (node environment)
  "Return the task that is to run NODE, which is tagged."
  (multiple-value-bind (holder index) (funcall (tagged-place node) environment)
    (let ((task (and holder (svref holder index))))
      (if (and task (eq (task-state task) :created))
          task
          (let ((new (make-task (tagged-name node) (tagged-body node))))
            ;; Who follows the status of the tag goes on to do so.
            (when (and task (task-over-p task))
              (setf (task-status-fluent new) (task-status-fluent task)))
            (when holder (setf (svref holder index) new))
            new)))))

(defun start-branch (branch task environment index level)
  "Start BRANCH as the part number INDEX of TASK; as the task of its tag, if it is tagged."
  (if (tagged-p branch)
      (spawn-gated task (tagged-body branch) environment index level
                   (tag-task branch environment))
      (spawn task branch environment index level)))

(defun tag-name-p (name)
  (and (symbolp name) (not (constantp name))))

(define-plan-form ":TAG" :must (name &rest body) (form scope)
  (unless (tag-name-p name)
    (reject-clause (author) form "(:tag name form...), with a symbol as the name of the task"))
  (destructuring-bind (&optional level index) (cdr (assoc name (scope-task-tags scope)))
    `(make-tagged :form ',(form-as-written form) :name ',name
                  :place ,(if level
                              `(lambda (,(scope-variable scope))
                                 (values ,(environment-form scope level) ,index))
                              '(constantly nil))
                  :body ,(body-code body (single-scope scope))
                  :layers ',(scope-layers scope)
                  :replaced '())))

(defun tags-in (forms)
  "Return the names of the tags in FORMS, not counting those that belong to a WITH-TAGS, or to each
turn of a PAR-LOOP, in them."
  (let ((names '()))
    (labels ((search-in (form)
               (cond ((atom form))
                     ((and (eq (first form) :tag) (consp (rest form)) (tag-name-p (second form)))
                      (pushnew (second form) names)
                      (search-all (cddr form)))
                     ((or (eq (first form) 'quote)
                          (operator-in-p form '("WITH-TAGS" "PAR-LOOP" "PARTIAL-ORDER" "PLAN"))))
                     (t (search-all form))))
             (search-all (forms)
               (loop for tail = forms then (cdr tail)
                     while (consp tail) do (search-in (car tail)))))
      (search-all forms))
    (nreverse names)))

(defun tagged-scope (scope names first)
  "Return SCOPE, in whose innermost environment the variables NAMES, from the place FIRST on, are
tags."
  (inner-scope scope
               :task-tags (append (loop for name in names
                                        for index from first
                                        collect (list name (scope-level scope) index))
                                  (scope-task-tags scope))))

(defun with-tags-code (form names scope coder)
  "Return the code that CODER returns for a scope in which NAMES are bound to tasks."
  (if names
      `(make-binding
        :form ',(form-as-written form)
        :fill (lambda (environment)
                (vector environment
                        ,@(loop for name in names collect `(make-task ',name +nothing+))))
        :body ,(funcall coder (tagged-scope (variable-scope scope names) names 1)))
      (funcall coder scope)))

(define-construct with-tags (&body body)
  "Run BODY in a plan with the name of each (:tag name form) in it bound to the task that runs
that form, and returns one value of it: see TASK-STATUS, WITH-TASK-BLOCKED and EVAPORATE. A
procedure's body is a WITH-TAGS too."
  (:code (with-tags-code form (tags-in body) scope (lambda (scope) (body-code body scope)))))

(addition task-status)
(defun task-status (task)
  "Return a fluent that is :created, :running, :blocked, :suspended, :succeeded, :failed or
:evaporated, as TASK is. It is :blocked by WITH-TASK-BLOCKED, :suspended by SUSPEND, by
WITH-TASK-SUSPENDED and by the loss of a valve (CRAM's words of 2009 and of 2020)."
  (check-argument task-status task (task-p task) "a task, as begin-plan returns")
  (or (task-status-fluent task)
      (setf (task-status-fluent task)
            (create-fluent (format nil "(task-status ~(~A~))" (or (task-name task) 'task))
                           (status-word task (task-state task))))))
