;;;; compiler.lisp -- from a plan's text to code that builds its nodes.

(in-package :ars-magna.rpl.language)

(export '(define-plan-form hoisted-code plan-code refuse-code suspends-p))

;;; Every function here named X-CODE returns a form; evaluated once, when the plan is loaded, that
;;; form builds the nodes.

(defun element-names (lambda-list)
  "Return the variables of LAMBDA-LIST, a destructuring one without defaults."
  (cond ((null lambda-list) '())
        ((atom lambda-list)
         (unless (member lambda-list lambda-list-keywords) (list lambda-list)))
        (t (append (element-names (car lambda-list)) (element-names (cdr lambda-list))))))

(defmacro define-plan-form (name suspends lambda-list (form scope) &body body)
  "Let plans understand the operator called NAME, a string, or a symbol: BODY returns the code for
FORM in SCOPE, its arguments bound by LAMBDA-LIST. SUSPENDS says whether it makes a task wait: see
SUSPENSION."
  (let ((names (element-names lambda-list)))
    (with-gensyms (fits values)
      `(setf (gethash (operator-key ',name) *plan-forms*)
             (make-plan-form
              ,(string name) ,suspends
              (lambda (,form ,scope)
                (declare (ignorable ,scope))
                (multiple-value-bind (,fits ,values)
                    (ignore-errors
                     (values t (destructuring-bind ,lambda-list (rest ,form) (list ,@names))))
                  (unless ,fits (reject-shape ,form ',lambda-list))
                  (destructuring-bind ,names ,values
                    (declare (ignorable ,@names))
                    ,@body))))))))

(defun reject-shape (form lambda-list)
  (let ((*print-case* :downcase))
    (reject-clause (author) form
                   (format nil "(~A~{ ~A~})~@[, not ~A~]" (operator-text form) lambda-list
                           (slip-in-construct form lambda-list)))))

(defun refuse-code (form scope &optional (container form))
  "Return code for FORM, of CONTAINER, which plans cannot wait inside: a leaf, or an error if it
would wait."
  (multiple-value-bind (suspends reason) (suspension form scope)
    (if (eq suspends :must)
        (reject-suspension reason container)
        (leaf-code form scope))))

(defun suspends-p (form scope)
  "True if FORM in SCOPE makes its task wait, or may do so."
  (and (or (consp form) (symbol-macro-p form (scope-environment scope)))
       (suspension form scope)))

(defun binds-fluents-p (form scope)
  "True if FORM is a LET of the plan's text that binds variables to fluents; leaves do not keep an
account of these."
  (and (consp form)
       (own-text-p form)
       (operator-in-p form '("LET" "LET*"))
       (proper-list-p (second form))
       (bound-to-fluents (second form) (cddr form) scope (operator-in-p form '("LET*")))))

;;; An expression of which a part that Lisp is to use makes the task wait.

(defun hoisted-code (form scope &optional (fixed 1))
  "Return code for FORM; those of its elements after the first FIXED that suspend are bound before
it, and those to the left of them too, to keep the order."
  (let* ((parts (nthcdr fixed form))
         (count (1+ (position-if (lambda (part) (suspends-p part scope)) parts :from-end t)))
         (names (loop for part in (subseq parts 0 count)
                      collect (if (constantp part) nil (gensym "PART")))))
    (plan-code (note-expansion
                `(let ,(loop for name in names
                             for part in parts
                             when name collect (list name part))
                   (,@(subseq form 0 fixed)
                    ,@(loop for name in names
                            for part in parts
                            collect (or name part))
                    ,@(nthcdr count parts)))
                form)
               scope)))

(defun function-form-code (form scope)
  "Return code for FORM, a call whose operator has no meaning of its own in plans."
  (cond ((some (lambda (argument) (suspends-p argument scope)) (rest form))
         (hoisted-code form scope))
        ((call-suspends form scope (scope-environment scope)) (call-code form scope))
        (t (leaf-code form scope))))

(defun plan-code (form scope)
  "Return code that builds the node for FORM."
  (let ((*form-at-hand* (if (in-source-p form) form *form-at-hand*)))
    (keep-place (if (or (suspends-p form scope) (binds-fluents-p form scope))
                    (naming-code (waiting-code form scope) scope)
                    (leaf-code form scope))
                form)))

(defun naming-code (code scope)
  "Return CODE, which builds a node that runs in the environment of SCOPE, so that the node knows
the names of the variables there."
  (let ((names (names-by-level scope)))
    (if (some #'identity names)
        `(name-variables ,code ',names)
        code)))

(defun name-variables (node names)
  (unless (leaf-p node)
    (setf (node-names node) names))
  node)

(defun waiting-code (form scope)
  (let* ((environment (scope-environment scope))
         (plan-form (find-plan-form form environment)))
    (cond ((symbolp form) (expansion-code form scope))
          ((construct-behind form) (plan-code (construct-behind form) scope))
          (plan-form (funcall (plan-form-compiler plan-form) form scope))
          ((not (symbolp (first form))) (refuse-code form scope))
          ((assoc (first form) (scope-procedures scope)) (function-form-code form scope))
          ((local-function-p (first form) environment)
           (if (macro-function (first form) environment)
               (expansion-code form scope)
               (function-form-code form scope)))
          ((own-advice-for form) (refuse-code form scope))
          ((macro-function (first form) environment) (expansion-code form scope))
          ((special-operator-p (first form)) (refuse-code form scope))
          ((operator-in-p form *stirring-functions*)
           (if (some (lambda (argument) (suspends-p argument scope)) (rest form))
               (hoisted-code form scope)
               (leaf-code form scope)))
          (t (function-form-code form scope)))))

(defun expansion-code (form scope)
  (let ((expansion (macroexpand-1 form (scope-environment scope))))
    (if (and (consp form) (lisps-own-p (first form)))
        (note-written-as expansion form)
        (note-own-text expansion))
    (plan-code expansion scope)))
