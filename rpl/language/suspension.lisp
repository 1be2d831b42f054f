;;;; suspension.lisp -- whether an expression can make its task wait.

(in-package :ars-magna.rpl.language)

;;; An expression MUST be run by the plan machine if somewhere in it is a construct that waits,
;;; fails or calls a plan procedure. It MAY be run by it if somewhere in it is a call of a function
;;; that is not known yet (it could turn out to be a procedure), or something after which policies
;;; should get a chance, such as SET-VALUE. Anything else is a leaf.

(defstruct (plan-form (:constructor make-plan-form (name suspends compiler)) (:copier nil))
  "The meaning in plans of the operator with the name NAME. SUSPENDS is :must, :may or NIL: see
SUSPENSION. COMPILER takes the form and its scope and returns code that builds a node."
  (name "" :type string :read-only t)
  (suspends nil :type (member :must :may nil) :read-only t)
  (compiler #'list :type function :read-only t))

(defvar *plan-forms* (make-hash-table :test 'equal)
  "A table from operators, each a name or a user's symbol, to PLAN-FORMs.")

(defparameter *waking-functions* '("SET-VALUE" "PULSE" "SUSPEND" "WAKE-UP")
  "Names of functions that may make other tasks ready.")

(defun find-plan-form (form environment)
  (and (consp form)
       (symbolp (first form))
       (not (local-function-p (first form) environment))
       (or (not (operator-in-p form '("LOOP"))) (plan-loop-p form))
       (gethash (or (plan-operator-name form) (first form)) *plan-forms*)))

(defvar *inner-exits* '()
  "The names of the blocks and tags inside the expression that is being examined.")

(defun exit-suspends-p (form scope)
  "True if FORM jumps to a block or tag of the plan in SCOPE, outside of the examined expression."
  (let ((name (second form)))
    (and (not (member name *inner-exits*))
         (if (eq (first form) 'go)
             (assoc name (scope-tags scope))
             (assoc name (scope-blocks scope))))))

(defun check-plan-text-form (form environment)
  "Signal MALFORMED-DEFINITION if FORM, in the text of a plan, is a malformed IF, a LET of a task
variable, or a binding of something that cannot be bound."
  (when (plan-text-p form)
    (check-bound-names form environment)
    (when (and (operator-in-p form '("LET" "LET*")) (proper-list-p (second form)))
      (check-lexical-variables (mapcar (lambda (binding) (first (ensure-list binding)))
                                       (second form))
                               environment))
    (unless (or (not (operator-in-p form '("IF")))
                (typep form '(cons t (cons t (cons t (or null (cons t null)))))))
      (reject-clause (text-title) form "(if test then [else]): put several forms into (seq ...)"))))

(defun check-starts-with-operator (form)
  "Signal MALFORMED-DEFINITION if FORM, in the text of a plan, does not start with an operator."
  (unless (or (typep (first form) '(cons (eql lambda))) (not (plan-text-p form)))
    (reject-clause (text-title) form
                   "an operator as the first element; write data as '(...) or (list ...)")))

(defun call-suspension (form scope environment)
  "Return :MUST, :MAY or NIL for FORM itself, a call or special form: see SUSPENSION."
  (let ((name (first form)))
    (cond ((local-function-p name environment)
           (and (assoc name (scope-procedures scope)) :must))
          ((member name '(return-from go))
           (and (exit-suspends-p form scope) :must))
          ((eq name 'function)
           (and (symbolp (second form)) (assoc (second form) (scope-procedures scope)) :must))
          ((operator-in-p form *waking-functions*) :may)
          ((procedure-name-p name) :must)
          ((or (macro-function name environment)
               (special-operator-p name)
               (known-function-p name environment))
           nil)
          (t :may))))

(defun defined-exits (form plan-form)
  "Return two lists, the parts of FORM and the blocks or tags that FORM defines for them; or NIL."
  (cond ((eq (first form) 'block) (values (cddr form) (list (second form))))
        ((eq (first form) 'tagbody)
         (values (remove-if #'atom (rest form)) (remove-if #'consp (rest form))))
        ((and plan-form (string= "LOOP" (plan-form-name plan-form)))
         (values (remove-if #'atom (rest form)) '(nil)))))

;;; Symbol macros.

(defun symbol-macro-p (form environment)
  "True if FORM is a symbol macro in ENVIRONMENT and not a task variable."
  (and (symbolp form)
       (eq :symbol-macro (variable-kind form environment))
       (not (task-variable-p form environment))))

;; The walk goes into those that are local by itself.
(defun global-symbol-macro-p (form environment)
  "True if FORM, found by a code walk in ENVIRONMENT, is a global symbol macro."
  (and (symbolp form)
       (symbol-macro-p form nil)
       (not (local-variable-p form environment))
       (not (bound-in-walk-p form environment))))

;;; The macro of the library iterate expands all that is in its forms, as Lisp.

(defun waiting-call-in (form environment)
  "Return the first call in FORM, or in forms inside it, that makes a task wait; or NIL."
  (map-calls (lambda (call)
               (when (and (symbolp (first call)) (waits-p call environment))
                 (return-from waiting-call-in call)))
             form))

(defun waits-p (form environment)
  "True if FORM is a call of a construct that makes a task wait, or of a plan procedure."
  (let ((plan-form (find-plan-form form environment)))
    (if plan-form
        (eq :must (plan-form-suspends plan-form))
        (and (not (local-function-p (first form) environment))
             (procedure-name-p (first form))))))

(defun suspension (form scope)
  "Return :MUST, :MAY or NIL: whether FORM makes its task wait. Also return the part that waits."
  (let ((result nil) (reason nil))
    (labels ((note (kind form)
               (when (or (null result) (and (eq kind :must) (eq result :may)))
                 (setf result kind
                       reason form)))
             (walk-inside (forms environment exits)
               (let ((*inner-exits* (append exits *inner-exits*)))
                 (dolist (form forms) (walk-form form environment #'visit))))
             (visit (form environment)
               (cond ((atom form)
                      (if (global-symbol-macro-p form environment)
                          (note-plan-text (macroexpand-1 form environment))
                          form))
                     ((not (symbolp (first form))) (check-starts-with-operator form) form)
                     ((plan-making-form-p form) (values form t))
                     ((represented-construct form))
                     (t (check-plan-text-form form environment)
                        (visit-call form environment (find-plan-form form environment)))))
             (visit-call (form environment plan-form)
               (let* ((inner (and (iterate-call-p form)
                                  (some (lambda (part) (waiting-call-in part environment))
                                        (rest form))))
                      (kind (cond (inner :must)
                                  ((and plan-form (plan-form-suspends plan-form)))
                                  (t (call-suspension form scope environment)))))
                 (when kind (note kind (or inner form)))
                 (multiple-value-bind (parts exits) (defined-exits form plan-form)
                   (cond ((eq kind :must) (values form t))
                         (exits
                          (walk-inside parts environment exits)
                          (values form t))
                         (t form))))))
      (walk-form form (scope-environment scope) #'visit))
    (values result reason)))
