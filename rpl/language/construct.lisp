;;;; construct.lisp -- define-construct: all that there is to know of a construct, in one form.

(in-package :ars-magna.rpl.language)

(export '(all-constructs define-construct form build))

;;; A construct has four sides. Users meet a macro: its lambda list, documentation, and the error if
;;; it is written outside of plans. The compiler makes a node of it. A task runs the node step by
;;; step, in states that have names. And signals pass it. See rpl/README.md for how to add one.

;;; All constructs.

(defvar *constructs* '()
  "For each construct, the last one first, its name and its clauses.")

(defun note-construct (name clauses)
  (setf (rest (or (assoc name *constructs*)
                  (first (push (list name) *constructs*))))
        clauses))

(defun all-constructs ()
  "Return the names of the constructs that DEFINE-CONSTRUCT has made, in order of definition."
  (reverse (mapcar #'first *constructs*)))

(defun all-clauses (clauses)
  "Return CLAUSES and, if one is (:like construct), those of that one."
  (let ((like (first (clause :like clauses))))
    (if like
        (append clauses (remove :manual (or (rest (assoc like *constructs*))
                                            (reject-name "construct" like (all-constructs)))
                                :key #'first))
        clauses)))

;;; Values that the task must wait for before the construct begins.

(defmacro hoisting (arguments form scope &body body)
  "Run BODY, which returns the code for FORM in SCOPE; but should one of ARGUMENTS, parts of FORM,
make its task wait, bind it before FORM, and so those to the left of it."
  (if (null arguments)
      `(progn ,@body)
      `(call-hoisting (list* ,@(if (eq '&rest (first (last arguments 2)))
                                   (append (butlast arguments 2) (last arguments))
                                   (append arguments '('()))))
                      ,form ,scope (lambda () ,@body))))

(defun call-hoisting (arguments form scope coder)
  (let* ((last (position-if (lambda (argument) (suspends-p argument scope)) arguments
                            :from-end t))
         (symbol (and last (find-if (lambda (argument)
                                      (and (symbolp argument) (suspends-p argument scope)))
                                    arguments))))
    (cond (symbol (plan-code (note-expansion (with-symbol-expanded symbol form scope) form) scope))
          (last (plan-code (note-expansion
                            (hoisted-form (remove-if #'atom (subseq arguments 0 (1+ last))) form)
                            form)
                           scope))
          (t (funcall coder)))))

(defun with-symbol-expanded (symbol form scope)
  "Return FORM with what SYMBOL, a symbol macro that is an argument of it, stands for in its place:
the first one, as arguments come before bodies."
  (let ((expansion (note-own-text (macroexpand-1 symbol (scope-environment scope)))) (done-p nil))
    (labels ((expanded (part)
               (cond (done-p part)
                     ((eq part symbol) (setf done-p t) expansion)
                     ((consp part) (let ((first (expanded (car part))))
                                     (cons first (expanded (cdr part)))))
                     (t part))))
      (cons (first form) (expanded (rest form))))))

(defun hoisted-form (parts form)
  "Return FORM with variables for PARTS, conses in it, that are bound around it."
  (let ((names (loop for nil in parts collect (gensym "PART"))))
    `(let* ,(mapcar #'list names parts)
       ,(reduce (lambda (form pair) (subst (first pair) (second pair) form :test #'eq))
                (mapcar #'list names parts) :initial-value form))))

;;; The definition.

(defun stub-form (name lambda-list documentation in-lisp)
  "Return the definition of the macro that Lisp knows as NAME; IN-LISP returns its expansion there."
  (if in-lisp
      (user-macro-form name `(&whole form ,@lambda-list) (cons name lambda-list)
                       `(,documentation
                         (declare (ignorable ,@(element-names lambda-list)))
                         ,in-lisp))
      ;; Outside of plans it does not matter whether the form fits.
      `(defmacro ,name (&whole form &rest arguments)
         ,documentation
         (declare (ignore arguments))
         (list 'in-plans-only form))))

(defun construct-code-form (node clauses)
  (let ((code (first (clause :code clauses))))
    `(flet ((build (&optional (scope scope))
              (declare (ignorable scope))
              (list ',(symbolicate 'make- node)
                    :form (list 'quote (form-as-written form))
                    ,@(loop for (part nil code) in (clause :parts clauses)
                            append (list (make-keyword part) code)))))
       (declare (ignorable #'build))
       ,(or code '(build)))))

(defun plan-form-form (name node lambda-list clauses)
  (multiple-value-bind (waits given) (clause :waits clauses)
    `(define-plan-form ,name ,(if given (first waits) :must) ,lambda-list (form scope)
       (hoisting ,(clause :arguments clauses) form scope
         ,(construct-code-form node clauses)))))

(defmacro define-construct (name lambda-list documentation &body clauses)
  "Let the plan language have the construct NAME, exported from the package at hand. LAMBDA-LIST has
no defaults. DOCUMENTATION is for users. CLAUSES:
(:manual): the manual has it.
(:command): there is a command of the same name, which is what users see; its documentation says,
too, what the name means in plans.
(:waits :MUST, :MAY or NIL): whether it makes its task wait, see SUSPENSION; :MUST if not given.
(:arguments form...): those of the variables of LAMBDA-LIST, or forms that return parts of their
values, that stand for ordinary values, which should they wait are had before; the last may be
&rest and a list of such.
(:parts (name type form)...): what its node consists of; each form returns code, with the variables
of LAMBDA-LIST, FORM and SCOPE bound.
(:code form): the code for the whole, if it is another expression, or if the node needs something
around it; then (build [scope]) in it is the code for the node.
(:steps ...), (:step ...), (:unwind ...), (:child-ended ...), (:hot): see DEFINE-EXPRESSION.
(:in-lisp form): its expansion, as a macro's, in ordinary Lisp, where it is an error otherwise; and
in plans as well if there is neither :code nor a step.
(:like construct): what is not said here is as for that one, whose lambda list must be the same."
  (check-clauses "define-construct" name clauses
                 '(:manual :command :waits :arguments :parts :code :steps :step :unwind
                   :child-ended :hot :in-lisp :like))
  (let* ((node (symbolicate name '-node))
         (all (all-clauses clauses))
         (node-p (or (clause :steps all) (clause :step all))))
    `(progn
       (eval-when (:compile-toplevel :load-toplevel :execute)
         (export ',name)
         (note-construct ',name ',all))
       ,@(unless (assoc :command clauses)
           `((,(if (assoc :manual clauses) 'public 'addition) ,name)))
       ,(stub-form name lambda-list documentation (first (clause :in-lisp all)))
       (show-lambda-list ',name ',lambda-list)
       ,@(when node-p
           `((define-expression ,node ,(format nil "The node of ~A." name)
               ,@(loop for clause in all
                       when (member (first clause)
                                    '(:parts :steps :step :unwind :child-ended :hot))
                         collect clause))))
       ,@(when (or node-p (clause :code all))
           `(,(plan-form-form name node lambda-list all)))
       ',name)))
