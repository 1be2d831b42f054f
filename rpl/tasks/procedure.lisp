;;;; procedure.lisp -- plan procedures by name, calling them, and which code of theirs forks share.

(in-package :ars-magna.rpl.tasks)

(export '(entry-for-arity declared-names known-lambda-list reject-lisp-call procedure-names-to-offer
          anonymous-procedure declare-procedure procedure-usable-p ensure-procedure enter-plan
          install-procedure make-procedure procedure check-arguments procedure-name-p node-parts))

;;; A name that a plan calls refers to a cell, whether or not a procedure of that name exists yet.
;;; So procedures can be defined in any order, and redefined while plans run: a call uses what is
;;; in the cell when it happens. Calls use the symbol itself. Callers by name, such as RUN-PLAN,
;;; need not know the package that a procedure was defined in.

(addition procedure-p)
(define-record (procedure (:constructor make-procedure (name)
                          "Return a procedure with the given name that is not yet defined."))
  "A plan procedure: a plan with parameters."
  (name nil symbol "the name of a plan procedure; NIL if INTERP-LAMBDA made the
procedure" :addition)
  (lambda-list '() list "the lambda list of a plan procedure" :writable :addition)
  (least 0 fixnum "the smallest number of arguments" :writable)
  (most most-positive-fixnum fixnum "the largest number of arguments" :writable)
  (keys-p nil boolean "the procedure takes keyword arguments" :writable)
  (entry nil (or null function)
         "the function that returns an environment for the arguments, or NIL" :writable :export)
  (source nil list "the text of a plan procedure as data: (def-interp-proc name parameters form...),
or (interp-lambda parameters form...)" :writable :addition)
  (body nil (or null node) "the node that the procedure runs, or NIL" :writable :export)
  (stub nil (or null function) "the Lisp function with the name of the procedure, which signals
MISUSE" :writable))

(define-registry procedure "plan procedure" :object-p procedure-p :by-symbol t :plans t
  :synonyms ("PLAN") :finder registered-procedure :lister registered-procedures :internal t)

(defvar *procedure-cells* (make-hash-table :test 'eq :synchronized t)
  "The cells of all names that plans define or call.")

(defun ensure-procedure (name)
  "Return the cell of the procedure with the name NAME. If there is no such cell, make one."
  (or (gethash name *procedure-cells*)
      (setf (gethash name *procedure-cells*) (make-procedure name))))

(defun procedure-usable-p (procedure)
  "True if PROCEDURE is defined and its name has not been redefined as a Lisp function."
  (and (procedure-entry procedure)
       (or (null (procedure-stub procedure))
           (let ((name (procedure-name procedure)))
             (and (fboundp name)
                  (eq (symbol-function name) (procedure-stub procedure)))))))

(addition all-procedures find-procedure)
(defun all-procedures ()
  "Return a list of all plan procedures that are defined, in order of definition."
  (remove-if-not #'procedure-usable-p (registered-procedures)))

(defun procedure-names-to-offer ()
  "Return the names of all defined plan procedures, those of users first, the newest first."
  (remove-if-not (lambda (name) (procedure-usable-p (registered-procedure name)))
                 (names-to-suggest *procedures*)))

(defun defined-namesake (name)
  "Return the newest defined procedure whose name is the same as NAME, in any package; or NIL."
  (find-if (lambda (procedure)
             (and (same-name-p name (procedure-name procedure)) (procedure-usable-p procedure)))
           (registered-procedures) :from-end t))

;; Users give a call, a form of plans, a function, or the name of a function for that of a plan.
(defun list-as-plan-remedy (list)
  (let ((name (first list)))
    (if (and (symbolp name)
             (or (defined-namesake name) (not (fboundp name))))
        (format nil "Give the name, and then its arguments: (run-plan '~A~{ ~S~})."
                name (abridged (rest list)))
        (format nil "A form is not a plan. Make a plan of it: (run-plan (interp-lambda () ~
                     ~{~A~^ ~}))."
                (mapcar #'unqualified-text (if (consp name) list (list list)))))))

(defun plan-remedy (name)
  "NAME, given as a plan, is not a plan. Return sentences about what to write instead; or NIL."
  (flet ((say (control &rest arguments)
           (let ((*print-case* :downcase)) (apply #'format nil control arguments))))
    (cond ((and (consp name) (proper-list-p name))
           (let ((*print-case* :downcase) (*print-pretty* nil)) (list-as-plan-remedy name)))
          ((functionp name)
           (let ((plan (find name (registered-procedures) :key #'procedure-stub)))
             (say "~:[A function is not a plan; DEF-INTERP-PROC defines a plan~;Give the plan's ~
                   name instead: '~:*~A~]." (and plan (procedure-name plan)))))
          ((not (and (symbolp name) (fboundp name))) nil)
          ((registered-procedure name nil)
           (say "It was a plan until ~A was defined as a ~:[function~;macro~]. Define the plan ~
                 again, and give one of the two another name." name (macro-function name)))
          (t (say "~A is a ~:[function~;macro~], not a plan. Define a plan that calls it: ~
                   (def-interp-proc my-plan () ~A)." name (macro-function name)
                  (if (has-plan-function-p name)
                      (plan-call-text name)
                      (format nil "(~(~A~) ...)" name)))))))

(defun reject-procedure (name)
  (let ((remedy (plan-remedy name)))
    (if remedy
        (error 'unknown-name :kind "plan procedure" :name name :remedy remedy)
        (reject-name "plan procedure" name (procedure-names-to-offer)))))

(defun find-procedure (name &optional (errorp t))
  "Return the plan procedure with the name NAME, a symbol or string. The procedure of the symbol
itself comes first, then the newest procedure of that name in other packages. If there is no such
procedure, signal UNKNOWN-NAME, or return NIL if ERRORP is NIL."
  (let ((known (registered-procedure name nil)))
    (cond ((and known (procedure-usable-p known)) known)
          ((and (typep name '(or symbol string)) (defined-namesake name)))
          (errorp (reject-procedure name)))))

(defmethod print-object ((procedure procedure) stream)
  (print-unreadable-object (procedure stream :type t)
    (format stream "~:[~;~:*~A ~]~:A" (procedure-name procedure)
            (procedure-lambda-list procedure))))

;;; Which names are plans' is also known while the file that defines them is compiled.

(defvar *declared-procedures* (make-hash-table :test 'eq :synchronized t)
  "A table from the names of plan procedures to lists of their lambda list. The table has all
procedures whose DEF-INTERP-PROC was compiled or loaded.")

(defun declare-procedure (name lambda-list)
  "Declare NAME as a plan procedure with LAMBDA-LIST, for plans that are compiled from now on."
  (setf (gethash name *declared-procedures*) (list lambda-list)))

(defun procedure-name-p (name)
  "True if NAME is known to be the name of a plan procedure."
  (and (gethash name *declared-procedures*)
       (let ((procedure (gethash name *procedure-cells*)))
         (or (null procedure) (null (procedure-entry procedure)) (procedure-usable-p procedure)))))

(defun known-lambda-list (name)
  "Return the lambda list of the plan procedure NAME, if such a procedure is known; or NIL."
  (first (gethash name *declared-procedures*)))

(defun declared-names ()
  "Return a list of the names that are known to be names of plan procedures."
  (loop for name being the hash-keys of *declared-procedures*
        when (procedure-name-p name) collect name))

(defun reject-lisp-call (name arguments)
  "Signal MISUSE, because Lisp code has called the plan NAME with the list ARGUMENTS."
  (let ((more (if arguments " ..." "")))
    (reject-use "~S is a plan, and Lisp code called it as a function. Run it on a robot by ~
                 (run-plan '~S~A), or without one by (run-plan-alone '~S~@[ :arguments ~
                 (list ...)~]). ~
                 Plans can call it in this way, but only outside of lambda and of other forms ~
                 that only Lisp runs."
                name name more name arguments)))

(defun set-lambda-list (procedure lambda-list)
  (let ((shape (lambda-list-shape lambda-list)))
    (setf (procedure-lambda-list procedure) lambda-list
          (procedure-least procedure) (shape-least shape)
          (procedure-most procedure) (shape-most shape)
          (procedure-keys-p procedure) (not (eq :none (shape-keys shape))))))

(defun warn-if-function (procedure)
  (let ((name (procedure-name procedure)))
    (when (and (fboundp name) (not (eq (fdefinition name) (procedure-stub procedure))))
      (warn-of-definition "~(~A~) was ~:[a Lisp function~;a Lisp macro~], which the plan procedure ~
                           replaces; give one of the two another name."
                          name (macro-function name)))))

(defun install-procedure (name lambda-list documentation entry body stub
                          &optional source text)
  "Make NAME a plan procedure for all later calls. TEXT is the definition, from the file SOURCE."
  (let ((procedure (ensure-procedure name)))
    (warn-if-function procedure)
    (declare-procedure name lambda-list)
    (set-lambda-list procedure lambda-list)
    (show-lambda-list name lambda-list stub)
    (setf (procedure-entry procedure) entry
          (procedure-body procedure) body
          (procedure-source procedure) text
          (procedure-stub procedure) stub
          (documentation name 'function) documentation)
    (redo-definition procedure)
    (let ((*definition* (make-defining source (or text (list "def-interp-proc" name)))))
      (register *procedures* name procedure))
    name))

(defmethod redo-definition ((procedure procedure))
  (declare-procedure (procedure-name procedure) (procedure-lambda-list procedure))
  (setf (fdefinition (procedure-name procedure)) (procedure-stub procedure))
  procedure)

(defmethod undo-definition ((procedure procedure))
  (when (procedure-usable-p procedure) (fmakunbound (procedure-name procedure)))
  (remhash (procedure-name procedure) *declared-procedures*)
  (setf (procedure-entry procedure) nil))

(defun anonymous-procedure (lambda-list entry body text)
  "Return a procedure without a name, with LAMBDA-LIST, ENTRY and BODY. TEXT is the definition."
  (let ((procedure (make-procedure nil)))
    (set-lambda-list procedure lambda-list)
    (setf (procedure-entry procedure) entry
          (procedure-body procedure) body
          (procedure-source procedure) text)
    procedure))

;;; Arguments.

(define-condition wrong-arguments (wrong-argument program-error)
  ()
  (:documentation "A plan was called with arguments that do not fit its lambda list."))

(defun reject-arguments (procedure arguments trouble)
  (error 'wrong-arguments
         :operator (or (procedure-name procedure) "interp-lambda") :name "argument list"
         :value arguments
         :expected (format nil "~:[no argument~;~:*~A~], not ~A~:[~;: give the arguments one ~
                                by one, not as a list~]"
                           (and (procedure-lambda-list procedure)
                                (lambda-list-text (procedure-lambda-list procedure)))
                           trouble
                           (argument-list-given-p procedure arguments))))

(defun argument-list-given-p (procedure arguments)
  "True if ARGUMENTS has a single element, which is a list of arguments that PROCEDURE takes."
  (and (typep arguments '(cons cons null))
       (proper-list-p (first arguments))
       (null (arguments-misfit-text (lambda-list-shape (procedure-lambda-list procedure))
                                    (first arguments)
                                    :wrong-p (constantly t)))))

(defun check-arguments (procedure arguments)
  "Signal WRONG-ARGUMENTS unless PROCEDURE takes the list ARGUMENTS."
  (let ((trouble (arguments-misfit-text (lambda-list-shape (procedure-lambda-list procedure))
                                        arguments
                                        :wrong-p (constantly t))))
    (when trouble (reject-arguments procedure arguments trouble))))

(declaim (inline entry-for-arity))
(defun entry-for-arity (procedure count)
  "Return a function of COUNT arguments that returns the environment for the body of PROCEDURE."
  (declare (type procedure procedure) (type fixnum count))
  (if (and (<= (procedure-least procedure) count (procedure-most procedure))
           (not (procedure-keys-p procedure)))
      (procedure-entry procedure)
      (checking-entry procedure)))

(defun checking-entry (procedure)
  (lambda (&rest arguments)
    (check-arguments procedure arguments)
    (apply (procedure-entry procedure) arguments)))

(defun enter-plan (plan &rest arguments)
  "Return the body of PLAN, a procedure or its name, and the environment of the body for ARGUMENTS."
  (let ((procedure (if (procedure-p plan) plan (find-procedure plan))))
    (check-arguments procedure arguments)
    (values (procedure-body procedure)
            (apply (procedure-entry procedure) arguments))))

;;; All runs share the plans defined by name. But INTERP-LAMBDA makes a plan when evaluated, and the
;;; functions in its nodes, and in those of its local plans, close over the variables around it.
;;; Such nodes, and the nodes that refer to them, belong to one run; a fork copies both.

(defun definition-current-p (procedure)
  "True if PROCEDURE is the current definition of its name. False if it is local or has no name."
  (and (procedure-name procedure)
       (eq procedure (gethash (procedure-name procedure) *procedure-cells*))))

(defun parts-of-code (object)
  "Return a list of the objects to which OBJECT (node, procedure, function, environment) refers."
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

(defun shareable-nodes (code)
  "If forks can share all nodes reachable from CODE, a node or procedure, return a list of these
nodes, and true. Otherwise some node has closed over something: return NIL and false."
  (let ((seen (make-hash-table :test 'eq)) (nodes '()) (work (list code)))
    (loop while work
          do (let ((object (pop work)))
               (typecase object
                 ((or symbol number character string entity))
                 ((or node procedure function)
                  (unless (or (gethash object seen)
                              (and (node-p object) (eq :shared (node-sharing object)))
                              (and (procedure-p object) (definition-current-p object)))
                    (setf (gethash object seen) t)
                    (when (node-p object) (push object nodes))
                    (setf work (append (parts-of-code object) work))))
                 (t (return-from shareable-nodes (values '() nil))))))
    (values nodes t)))

(defun determine-sharing (node)
  (multiple-value-bind (nodes shared-p) (shareable-nodes node)
    (dolist (each nodes) (setf (node-sharing each) :shared))
    (setf (node-sharing node) (if shared-p :shared :per-run))))

(define-shared-slots node form names states)
(define-shared-slots procedure lambda-list source)

(defmethod copy-plan-value ((node node) fork)
  (when (eq :unknown (node-sharing node)) (determine-sharing node))
  (if (eq :shared (node-sharing node)) node (copy-slots node fork)))

(defmethod copy-plan-value ((procedure procedure) fork)
  (if (or (definition-current-p procedure)
          (nth-value 1 (shareable-nodes procedure)))
      procedure
      (copy-slots procedure fork)))
