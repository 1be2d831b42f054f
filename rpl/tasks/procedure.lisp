;;;; procedure.lisp -- plan procedures by name, calling them, and which code of theirs forks share.

(in-package :ars-magna.rpl.tasks)

(export '(entry-for declared-names known-lambda-list reject-lisp-call procedures-to-offer
          anonymous-procedure declare-procedure defined-p ensure-procedure enter-plan
          install-procedure make-procedure procedure check-arguments procedure-name-p node-parts))

;;; A name that a plan calls refers to a cell, whether or not a procedure of that name exists yet.
;;; So procedures can be defined in any order, and redefined while plans run: a call uses what is
;;; in the cell when it happens. Calls use the symbol itself. Callers by name, such as RUN-PLAN,
;;; need not know the package that a procedure was defined in.

(addition procedure-p)
(define-record (procedure (:constructor make-procedure (name)
                          "Return a procedure by name that is yet to be defined."))
  "A plan with parameters."
  (name nil symbol "the name of a plan procedure, NIL for one made by INTERP-LAMBDA" :addition)
  (lambda-list '() list "the lambda list of a plan procedure" :writable :addition)
  (least 0 fixnum "how many arguments it takes at least" :writable)
  (most most-positive-fixnum fixnum "how many arguments it takes at most" :writable)
  (keys-p nil boolean "there are keywords among them" :writable)
  (entry nil (or null function)
         "the function of the arguments that returns an environment, or NIL" :writable :export)
  (source nil list "the text of a plan procedure as data: (def-interp-proc name parameters form...),
or (interp-lambda parameters form...)" :writable :addition)
  (body nil (or null node) "the node that the procedure runs, or NIL" :writable :export)
  (stub nil (or null function) "the Lisp function of the name, which signals MISUSE" :writable))

(define-registry procedure "plan procedure" :object-p procedure-p :by-symbol t :synonyms ("PLAN")
  :finder registered-procedure :lister registered-procedures :internal t)

(defvar *cells* (make-hash-table :test 'eq :synchronized t)
  "The cells of all names that plans define or call.")

(defun ensure-procedure (name)
  "Return the cell of the procedure called NAME."
  (or (gethash name *cells*)
      (setf (gethash name *cells*) (make-procedure name))))

(defun defined-p (procedure)
  "True if PROCEDURE is defined and its name has not been defined as a Lisp function since."
  (and (procedure-entry procedure)
       (or (null (procedure-stub procedure))
           (let ((name (procedure-name procedure)))
             (and (fboundp name)
                  (eq (symbol-function name) (procedure-stub procedure)))))))

(addition all-procedures find-procedure)
(defun all-procedures ()
  "Return a list of all plan procedures that are defined, in order of definition."
  (remove-if-not #'defined-p (registered-procedures)))

(defun procedures-to-offer ()
  "Return the names of all plan procedures that are defined, the newest of users first."
  (remove-if-not (lambda (name) (defined-p (registered-procedure name)))
                 (names-to-offer *procedures*)))

(defun live-namesake (name)
  "Return the live procedure defined last of those called NAME in any package, or NIL."
  (find-if (lambda (procedure)
             (and (same-name-p name (procedure-name procedure)) (defined-p procedure)))
           (registered-procedures) :from-end t))

;; Users give a call, a form of plans, a function, or the name of a function for that of a plan.
(defun list-remedy (list)
  (let ((name (first list)))
    (if (and (symbolp name)
             (or (live-namesake name) (not (fboundp name))))
        (format nil "Give the name, and then its arguments: (run-plan '~A~{ ~S~})."
                name (abridged (rest list)))
        (format nil "A form is no plan; make one of it: (run-plan (interp-lambda () ~{~A~^ ~}))."
                (mapcar #'unqualified-text (if (consp name) list (list list)))))))

(defun plan-remedy (name)
  "Return in sentences what to do instead of giving NAME, which is no plan's, for a plan; or NIL."
  (flet ((say (control &rest arguments)
           (let ((*print-case* :downcase)) (apply #'format nil control arguments))))
    (cond ((and (consp name) (proper-list-p name))
           (let ((*print-case* :downcase) (*print-pretty* nil)) (list-remedy name)))
          ((functionp name)
           (let ((plan (find name (registered-procedures) :key #'procedure-stub)))
             (say "~:[A function is no plan; DEF-INTERP-PROC defines one~;Give the plan's name ~
                   instead: '~:*~A~]." (and plan (procedure-name plan)))))
          ((not (and (symbolp name) (fboundp name))) nil)
          ((registered-procedure name nil)
           (say "It was one until ~A was defined as a ~:[function~;macro~]. Define the plan anew, ~
                 and give one of the two another name." name (macro-function name)))
          (t (say "~A is a ~:[function~;macro~], no plan. Define a plan that calls it: ~
                   (def-interp-proc my-plan () ~A)." name (macro-function name)
                  (if (has-plan-function-p name)
                      (plan-call-text name)
                      (format nil "(~(~A~) ...)" name)))))))

(defun reject-procedure (name)
  (let ((remedy (plan-remedy name)))
    (if remedy
        (error 'unknown-name :kind "plan procedure" :name name :remedy remedy)
        (reject-name "plan procedure" name (procedures-to-offer)))))

(defun find-procedure (name &optional (errorp t))
  "Return the plan procedure called NAME, a symbol or string: that of the symbol itself, or else the
one defined last of that name in other packages. If there is none, signal UNKNOWN-NAME,
or return NIL if ERRORP is NIL."
  (let ((known (registered-procedure name nil)))
    (cond ((and known (defined-p known)) known)
          ((and (typep name '(or symbol string)) (live-namesake name)))
          (errorp (reject-procedure name)))))

(defmethod print-object ((procedure procedure) stream)
  (print-unreadable-object (procedure stream :type t)
    (format stream "~:[~;~:*~A ~]~:A" (procedure-name procedure)
            (procedure-lambda-list procedure))))

;;; Which names are plans' is also known while the file that defines them is compiled.

(defvar *declared-procedures* (make-hash-table :test 'eq :synchronized t)
  "Lists of a lambda list, by the names for which a DEF-INTERP-PROC was compiled or loaded.")

(defun declare-procedure (name lambda-list)
  "Declare NAME, to plans compiled from now on, as a plan procedure with LAMBDA-LIST."
  (setf (gethash name *declared-procedures*) (list lambda-list)))

(defun procedure-name-p (name)
  "True if NAME is known to name a plan procedure."
  (and (gethash name *declared-procedures*)
       (let ((procedure (gethash name *cells*)))
         (or (null procedure) (null (procedure-entry procedure)) (defined-p procedure)))))

(defun known-lambda-list (name)
  "Return the lambda list of the plan procedure that NAME is known to name."
  (first (gethash name *declared-procedures*)))

(defun declared-names ()
  "Return the names that are known to name plan procedures."
  (loop for name being the hash-keys of *declared-procedures*
        when (procedure-name-p name) collect name))

(defun reject-lisp-call (name arguments)
  "Signal MISUSE: Lisp code has called NAME with the list ARGUMENTS."
  (let ((more (if arguments " ..." "")))
    (reject-use "~S is a plan, and Lisp code called it as a function. Run it on a robot by ~
                 (run-plan '~S~A), or without one by (run-plan-alone '~S~@[ :arguments ~
                 (list ...)~]). ~
                 A plan calls it as it is here, but outside of lambda and other forms that only ~
                 Lisp runs."
                name name more name arguments)))

(defun set-lambda-list (procedure lambda-list)
  (let ((shape (shape-of lambda-list)))
    (setf (procedure-lambda-list procedure) lambda-list
          (procedure-least procedure) (shape-least shape)
          (procedure-most procedure) (shape-most shape)
          (procedure-keys-p procedure) (not (eq :none (shape-keys shape))))))

(defun warn-if-function (procedure)
  (let ((name (procedure-name procedure)))
    (when (and (fboundp name) (not (eq (fdefinition name) (procedure-stub procedure))))
      (warn-of-definition "~(~A~) was ~:[a function~;a macro~] of Lisp's, which the plan procedure ~
                           replaces; call one of the two otherwise."
                          name (macro-function name)))))

(defun install-procedure (name lambda-list documentation entry body stub
                          &optional source text)
  "Make NAME a plan procedure, as TEXT, from SOURCE, defines it, for all calls from now on."
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
    (reinstate procedure)
    (let ((*definition* (make-defining source (or text (list "def-interp-proc" name)))))
      (register *procedures* name procedure))
    name))

(defmethod reinstate ((procedure procedure))
  (declare-procedure (procedure-name procedure) (procedure-lambda-list procedure))
  (setf (fdefinition (procedure-name procedure)) (procedure-stub procedure))
  procedure)

(defmethod take-back ((procedure procedure))
  (when (defined-p procedure) (fmakunbound (procedure-name procedure)))
  (remhash (procedure-name procedure) *declared-procedures*)
  (setf (procedure-entry procedure) nil))

(defun anonymous-procedure (lambda-list entry body text)
  "Return a procedure without a name, of LAMBDA-LIST, ENTRY and BODY, which TEXT defines."
  (let ((procedure (make-procedure nil)))
    (set-lambda-list procedure lambda-list)
    (setf (procedure-entry procedure) entry
          (procedure-body procedure) body
          (procedure-source procedure) text)
    procedure))

;;; Arguments.

(define-condition wrong-arguments (wrong-argument program-error)
  ()
  (:documentation "A plan was called with arguments that it does not take."))

(defun reject-arguments (procedure arguments trouble)
  (error 'wrong-arguments
         :operator (or (procedure-name procedure) "interp-lambda") :name "argument list"
         :value arguments
         :expected (format nil "~:[no argument~;~:*~A~], not ~A~:[~;: the arguments one by one, in ~
                                no list~]"
                           (and (procedure-lambda-list procedure)
                                (shape-text (procedure-lambda-list procedure)))
                           trouble
                           (listed-p procedure arguments))))

(defun listed-p (procedure arguments)
  "True if ARGUMENTS has one element, a list of arguments that PROCEDURE takes."
  (and (typep arguments '(cons cons null))
       (proper-list-p (first arguments))
       (null (misfit (shape-of (procedure-lambda-list procedure)) (first arguments)
                     :wrong-p (constantly t)))))

(defun check-arguments (procedure arguments)
  "Signal WRONG-ARGUMENTS unless PROCEDURE takes the list ARGUMENTS."
  (let ((trouble (misfit (shape-of (procedure-lambda-list procedure)) arguments
                         :wrong-p (constantly t))))
    (when trouble (reject-arguments procedure arguments trouble))))

(declaim (inline entry-for))
(defun entry-for (procedure count)
  "Return the function of COUNT arguments that returns the environment for the body of PROCEDURE."
  (declare (type procedure procedure) (type fixnum count))
  (if (and (<= (procedure-least procedure) count (procedure-most procedure))
           (not (procedure-keys-p procedure)))
      (procedure-entry procedure)
      (careful-entry procedure)))

(defun careful-entry (procedure)
  (lambda (&rest arguments)
    (check-arguments procedure arguments)
    (apply (procedure-entry procedure) arguments)))

(defun enter-plan (plan &rest arguments)
  "Return the body of PLAN, a procedure or the name of one, and its environment for ARGUMENTS."
  (let ((procedure (if (procedure-p plan) plan (find-procedure plan))))
    (check-arguments procedure arguments)
    (values (procedure-body procedure)
            (apply (procedure-entry procedure) arguments))))

;;; All runs share the plans that were defined by name. But INTERP-LAMBDA makes a plan when it is
;;; evaluated, and the functions in its nodes, and in those of its local plans, close over the
;;; variables around it. Such nodes belong to one run, and so do the nodes that refer to them; a
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

(defun shared-code (code)
  "Return a list of the nodes that CODE, a node or procedure, leads to if forks share them, and
true; or NIL and false if one of them has closed over something."
  (let ((seen (make-hash-table :test 'eq)) (nodes '()) (work (list code)))
    (loop while work
          do (let ((object (pop work)))
               (typecase object
                 ((or symbol number character string entity))
                 ((or node procedure function)
                  (unless (or (gethash object seen)
                              (and (node-p object) (eq :shared (node-sharing object)))
                              (and (procedure-p object) (defined-procedure-p object)))
                    (setf (gethash object seen) t)
                    (when (node-p object) (push object nodes))
                    (setf work (append (parts-of-code object) work))))
                 (t (return-from shared-code (values '() nil))))))
    (values nodes t)))

(defun determine-sharing (node)
  "Determine whether forks share NODE, and record it."
  (multiple-value-bind (nodes shared-p) (shared-code node)
    (dolist (each nodes) (setf (node-sharing each) :shared))
    (setf (node-sharing node) (if shared-p :shared :per-run))))

(define-shared-slots node form names states)
(define-shared-slots procedure lambda-list source)

(defmethod copy-plan-value ((node node) fork)
  (when (eq :unknown (node-sharing node)) (determine-sharing node))
  (if (eq :shared (node-sharing node)) node (copy-slots node fork)))

(defmethod copy-plan-value ((procedure procedure) fork)
  (if (or (defined-procedure-p procedure)
          (nth-value 1 (shared-code procedure)))
      procedure
      (copy-slots procedure fork)))
