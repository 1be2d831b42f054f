;;;; tags.lisp -- tasks by name: with-tags, (:tag name form), status; replacing their code.

(in-package :ars-magna.rpl.language)

(export '(start-branch tagged-scope tags-in with-tags-code))

;;; WITH-TAGS binds the name of each (:tag name form) in it to a task that is yet to start, so that
;;; other branches can refer to it before. A second run of the same form gets a separate task,
;;; with the same status fluent.

(define-expression tagged
  "Runs BODY as a separate task with the name NAME. The function PLACE returns the environment that
has the task, and the index of the task there; or NIL if no environment has it. LAYERS are the
layers of its scope. REPLACED is NIL, or a list of the replacing form and the original node."
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
     (end-with-value task result))))

(defun task-for-tag (node environment)
  (multiple-value-bind (holder index) (funcall (tagged-place node) environment)
    (let ((task (and holder (svref holder index))))
      (if (and task (eq (task-state task) :created))
          task
          (let ((new (make-task (tagged-name node) (tagged-body node))))
            ;; Those that follow the status of the tag continue to.
            (when (and task (task-over-p task))
              (setf (task-status-fluent new) (task-status-fluent task)))
            (when holder (setf (svref holder index) new))
            new)))))

(defun start-branch (branch task environment index level)
  "Start BRANCH as part number INDEX of TASK. If BRANCH is tagged, start it as the task of its tag."
  (if (tagged-p branch)
      (spawn-gated task (tagged-body branch) environment index level
                   (task-for-tag branch environment))
      (spawn task branch environment index level)))

(defun tag-name-p (name)
  (and (symbolp name) (not (constantp name))))

(define-plan-form ":TAG" :must (name &rest body) (form scope)
  (unless (tag-name-p name)
    (reject-clause (text-title) form "(:tag name form...), with a symbol as the name of the task"))
  (destructuring-bind (&optional level index) (cdr (assoc name (scope-task-tags scope)))
    `(make-tagged :form ',(form-as-written form) :name ',name
                  :place ,(if level
                              `(lambda (,(scope-variable scope))
                                 (values ,(environment-form scope level) ,index))
                              '(constantly nil))
                  :body ,(body-code body (single-value-scope scope))
                  :layers ',(scope-layers scope)
                  :replaced '())))

(defun tags-in (forms)
  "Return the names of the tags in FORMS, but not in a WITH-TAGS, PAR-LOOP or similar construct."
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
  "Return a copy of SCOPE in which the variables NAMES are tags. The variables are in the innermost
environment of SCOPE, from index FIRST on."
  (inner-scope scope
               :task-tags (append (loop for name in names
                                        for index from first
                                        collect (list name (scope-level scope) index))
                                  (scope-task-tags scope))))

(defun with-tags-code (form names scope coder)
  "Return the code that CODER returns for a scope with NAMES bound to tasks, for the source FORM."
  (if names
      `(make-binding
        :form ',(form-as-written form)
        :fill (lambda (environment)
                (vector environment
                        ,@(loop for name in names collect `(make-task ',name +nothing+))))
        :body ,(funcall coder (tagged-scope (variable-scope scope names) names 1)))
      (funcall coder scope)))

(define-construct with-tags (&body body)
  "Run BODY in a plan. For each (:tag name form) in BODY, bind the variable name to the task that
runs the form. (:tag name form) returns one value. See TASK-STATUS, WITH-TASK-BLOCKED and EVAPORATE.
The body of a procedure binds tags as WITH-TAGS does."
  (:code (with-tags-code form (tags-in body) scope (lambda (scope) (body-code body scope)))))

(addition task-status)
(defun task-status (task)
  "Return a fluent whose value is the status of TASK: :created, :running, :blocked (by
WITH-TASK-BLOCKED), :suspended (by SUSPEND, WITH-TASK-SUSPENDED or the loss of a valve), :succeeded,
:failed or :evaporated (the words of CRAM in 2009 and in 2020)."
  (check-argument task-status task (task-p task) "a task, as begin-plan returns")
  (or (task-status-fluent task)
      (setf (task-status-fluent task)
            (create-fluent (format nil "(task-status ~(~A~))" (or (task-name task) 'task))
                           (status-word task (task-state task))))))

;;; What is tagged can be named from outside by a path: the plan, and the tag, or the tags around
;;; each other. A tagged node keeps the layers of its scope, so that text that comes later can be
;;; compiled as if it stood there. Tasks that run keep the nodes that they started with.

(defun scope-from-layers (layers)
  "Return a scope with LAYERS, the innermost first, but without blocks, tags and local plans."
  (let ((scope (make-scope)))
    (dolist (layer (reverse layers) scope)
      (destructuring-bind (kind first &optional names) layer
        (setf scope (ecase kind
                      (:variables
                       (layered-scope scope layer first :variable (remove-duplicates names)))
                      (:functions (layered-scope scope layer first :function names))
                      (:wrapping (wrapped-scope scope first))))))))

;;; Finding.

(defun inner-nodes (node)
  (loop for part in (node-parts node)
        append (typecase part
                 (node (list part))
                 ;; A local one.
                 (procedure (unless (eq part (find-procedure (procedure-name part) nil))
                              (ensure-list (procedure-body part)))))))

(defun tagged-nodes-in (node name)
  "Return a list, in order, of the outermost tagged nodes with the name NAME in NODE."
  (let ((seen (make-hash-table :test 'eq)) (found '()))
    (labels ((visit (node)
               (unless (gethash node seen)
                 (setf (gethash node seen) t)
                 (if (and (tagged-p node) (same-name-p name (tagged-name node)))
                     (push node found)
                     (mapc #'visit (inner-nodes node))))))
      (visit node))
    (nreverse found)))

(defun find-tagged-node (operator path)
  (unless (and (proper-list-p path) (rest path) (every #'symbolp (rest path)))
    (reject-argument operator 'path path
                     "a list of a plan and a tag, or of a plan and nested tags"))
  (let ((nodes (list (procedure-body (if (procedure-p (first path))
                                         (first path)
                                         (find-procedure (first path)))))))
    (dolist (name (rest path))
      (setf nodes (remove-duplicates
                   (loop for node in nodes
                         append (tagged-nodes-in (if (tagged-p node) (tagged-body node) node) name))
                   :from-end t)))
    (unless (= 1 (length nodes))
      (reject-use "~(~A~): ~S leads to ~D places, not to one. A path is a list of a plan and a ~
                   tag in this plan. To select one of several places, write the tags around that ~
                   place before the tag."
                  operator path (length nodes)))
    (first nodes)))

;;; Replacing.

(defun written-code (node)
  (let ((forms (cddr (node-form node))))
    (if (rest forms) `(seq ,@forms) (first forms))))

(addition task-code)
(defun task-code (path)
  "Return the plan text that tasks at PATH run when they next start, and true if this text replaces
the original. PATH is a list of a plan, or its name, and a tag in this plan. Tags around this tag
may come before the tag. Of nested places, the outermost is used. Signals UNKNOWN-NAME and
WRONG-ARGUMENT. Signals MISUSE unless PATH leads to exactly one place."
  (let ((node (find-tagged-node 'task-code path)))
    (if (tagged-replaced node)
        (values (first (tagged-replaced node)) t)
        (values (written-code node) nil))))

(addition replace-task-code)
(defun replace-task-code (path form &key compile)
  "Let tasks at PATH run the plan text FORM when they next start (for PATH see TASK-CODE). Running
tasks are not affected. FORM can use the variables visible at the tag, but not the blocks, tags and
local plans there. The Lisp code in FORM is interpreted, as by MAKE-PLAN, or compiled if COMPILE is
true. Redefining the plan discards FORM. Return FORM. Signals the errors of TASK-CODE, and
MALFORMED-DEFINITION. (From CRAM, where REPLACE-TASK-CODE takes a function.)"
  (let* ((node (find-tagged-node 'replace-task-code path))
         (body (call-blaming-form
                (lambda ()
                  (with-plan-text (form)
                    (evaluate-form (plan-code form (scope-from-layers (tagged-layers node)))
                                   :compile compile)))
                (list 'replace-task-code path form))))
    (setf (tagged-replaced node) (list form (or (second (tagged-replaced node))
                                                (tagged-body node)))
          (tagged-body node) body)
    form))

(addition restore-task-code)
(defun restore-task-code (path)
  "Let tasks at PATH (see TASK-CODE) run the original code when they next start. Return that code."
  (let ((node (find-tagged-node 'restore-task-code path)))
    (when (tagged-replaced node)
      (setf (tagged-body node) (second (tagged-replaced node))
            (tagged-replaced node) nil))
    (written-code node)))
