;;;; replacing.lisp -- other code for what is tagged in a plan, from its next start on.

(in-package :ars-magna.rpl.language)

;;; What is tagged can be named from outside by a path: the plan, and the tag, or the tags around
;;; each other. A tagged node keeps the layers of its scope, so that text that comes later can be
;;; compiled as if it stood there. Tasks that run keep the nodes that they started with.

(defun scope-of (layers)
  "Return a scope with LAYERS, the innermost first; it knows no blocks, tags and local plans."
  (let ((scope (make-scope)))
    (dolist (layer (reverse layers) scope)
      (destructuring-bind (kind first &optional names) layer
        (setf scope (ecase kind
                      (:variables
                       (layered-scope scope layer first :variable (remove-duplicates names)))
                      (:functions (layered-scope scope layer first :function names))
                      (:wrapping (rewrapped-scope scope first))))))))

(defun rewrapped-scope (scope wrapping)
  (destructuring-bind (operator definitions) wrapping
    (ecase operator
      (macrolet
       (wrapped-scope scope wrapping
                      :macro (loop for definition in definitions
                                   collect (list (first definition)
                                                 (macro-expander definition
                                                                 (scope-environment scope))))))
      (symbol-macrolet (wrapped-scope scope wrapping :symbol-macro definitions)))))

;;; Finding.

(defun local-body (procedure)
  (and (procedure-body procedure)
       (not (eq procedure (find-procedure (procedure-name procedure) nil)))
       (procedure-body procedure)))

(defun inner-nodes (node)
  (loop for part in (node-parts node)
        append (typecase part
                 (node (list part))
                 (procedure (ensure-list (local-body part))))))

(defun tagged-in (node name)
  "Return the tagged nodes called NAME in NODE, in order; of those within each other the outermost."
  (let ((seen (make-hash-table :test 'eq)) (found '()))
    (labels ((visit (node)
               (unless (gethash node seen)
                 (setf (gethash node seen) t)
                 (if (and (tagged-p node) (same-name-p name (tagged-name node)))
                     (push node found)
                     (mapc #'visit (inner-nodes node))))))
      (visit node))
    (nreverse found)))

(defun find-tagged (operator path)
  (unless (and (proper-list-p path) (rest path) (every #'symbolp (rest path)))
    (reject-argument operator 'path path
                     "a list of a plan and a tag, or of tags around each other"))
  (let ((nodes (list (procedure-body (if (procedure-p (first path))
                                         (first path)
                                         (find-procedure (first path)))))))
    (dolist (name (rest path))
      (setf nodes (remove-duplicates
                   (loop for node in nodes
                         append (tagged-in (if (tagged-p node) (tagged-body node) node) name))
                   :from-end t)))
    (unless (= 1 (length nodes))
      (reject-use "~(~A~): there are ~D places that ~S leads to, not one. A path is a plan and a ~
                   tag in it; tags around each other tell places apart."
                  operator (length nodes) path))
    (first nodes)))

;;; Replacing.

(defun written-code (node)
  (let ((forms (cddr (node-form node))))
    (if (rest forms) `(seq ,@forms) (first forms))))

(addition task-code)
(defun task-code (path)
  "Return the plan text that the tasks at PATH, a list of a plan or its name and a tag in it, run
from their next start on, and true if it replaces what is written there. If the tag stands in others
of the plan, they may come before it; of places within each other the outermost is meant. Signals
UNKNOWN-NAME, WRONG-ARGUMENT, and MISUSE if there is not just one such place. (Ours.)"
  (let ((node (find-tagged 'task-code path)))
    (if (tagged-replaced node)
        (values (first (tagged-replaced node)) t)
        (values (written-code node) nil))))

(addition replace-task-code)
(defun replace-task-code (path form &key compile)
  "Let the tasks at PATH, see TASK-CODE, run FORM, plan text, from their next start on; those under
way go on as they are. FORM sees the variables that are visible at the tag, but not the blocks, tags
and local plans there. Its Lisp code is interpreted, as by MAKE-PLAN; compiled if COMPILE is true.
A definition of the plan anew forgets FORM. Return FORM. Signals as TASK-CODE does, and
MALFORMED-DEFINITION. (CRAM's, which takes a function.)"
  (let* ((node (find-tagged 'replace-task-code path))
         (body (call-blaming-form
                (lambda ()
                  (with-own-text (form)
                    (evaluate-form (plan-code form (scope-of (tagged-layers node)))
                                   :compile compile)))
                (list 'replace-task-code path form))))
    (setf (tagged-replaced node) (list form (or (second (tagged-replaced node))
                                                (tagged-body node)))
          (tagged-body node) body)
    form))

(addition restore-task-code)
(defun restore-task-code (path)
  "Let the tasks at PATH, see TASK-CODE, run what is written there from their next start on. Return
it. (Ours.)"
  (let ((node (find-tagged 'restore-task-code path)))
    (when (tagged-replaced node)
      (setf (tagged-body node) (second (tagged-replaced node))
            (tagged-replaced node) nil))
    (written-code node)))
