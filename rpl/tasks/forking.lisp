;;;; forking.lisp -- which code of plans forks share, and which they have a copy of.

(in-package :ars-magna.rpl.tasks)

(export '(node-parts))

;;; All runs share the plans that were defined by name. But INTERP-LAMBDA makes a plan when it is
;;; evaluated, and the functions in its nodes, and in those of its local plans, have closed over
;;; the variables around it. Such nodes belong to one run, and so do the nodes that lead to them; a
;;; fork copies both.

(defun defined-procedure-p (procedure)
  "True if PROCEDURE is the one of its name, and none that is local or has no name."
  (and (procedure-name procedure)
       (eq procedure (gethash (procedure-name procedure) *cells*))))

(defun parts-of-code (object)
  "Return a list of what OBJECT, a node, procedure, function or environment of one, refers to."
  (etypecase object
    (function (and (closure-p object) (closure-values object)))
    (node (node-parts object))
    (procedure (list (procedure-entry object) (procedure-body object)))
    ((satisfies environment-p) (environment-values object))))

(defun node-parts (node)
  "Return a list of the nodes, procedures and functions in the slots of NODE."
  (labels ((code-in (value)
             (typecase value
               ((or node procedure function) (list value))
               (cons (append (code-in (car value)) (code-in (cdr value))))
               (simple-vector (loop for each across value append (code-in each))))))
    (loop for (index . name) in (reference-slots node)
          unless (member name '(form names states))
            append (code-in (instance-slot node index)))))

(defun everybodys-code (code)
  "Return a list of the nodes that CODE, a node or procedure, leads to if they are everybody's, and
true; or NIL and false if one of them has closed over something."
  (let ((seen (make-hash-table :test 'eq)) (nodes '()) (work (list code)))
    (loop while work
          do (let ((object (pop work)))
               (typecase object
                 ((or symbol number character string entity))
                 ((or node procedure function)
                  (unless (or (gethash object seen)
                              (and (node-p object) (eq :everybodys (node-whose object)))
                              (and (procedure-p object) (defined-procedure-p object)))
                    (setf (gethash object seen) t)
                    (when (node-p object) (push object nodes))
                    (setf work (append (parts-of-code object) work))))
                 (t (return-from everybodys-code (values '() nil))))))
    (values nodes t)))

(defun find-whose (node)
  "Find out whose NODE is, and remember it. Return that."
  (multiple-value-bind (nodes everybodys-p) (everybodys-code node)
    (dolist (each nodes) (setf (node-whose each) :everybodys))
    (setf (node-whose node) (if everybodys-p :everybodys :a-runs))))

(define-shared-slots node form names states)
(define-shared-slots procedure lambda-list source)

(defmethod copy-plan-value ((node node) fork)
  (let ((whose (node-whose node)))
    (if (eq :everybodys (if (eq :unknown whose) (find-whose node) whose))
        node
        (copy-slots node fork))))

(defmethod copy-plan-value ((procedure procedure) fork)
  (if (or (defined-procedure-p procedure)
          (nth-value 1 (everybodys-code procedure)))
      procedure
      (copy-slots procedure fork)))
