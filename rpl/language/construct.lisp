;;;; construct.lisp -- define-expression and define-construct.

(in-package :ars-magna.rpl.language)

(export '(define-expression value child how result environment memory next at-once in-state-p
          all-constructs define-construct form build))

;;; A frame is always in one of the states of its node. States have names. Only this file and
;;; FRAME-STATE use the number that stands for a state, in the frame's counter.

(defun clause-rest (key clauses)
  "Return the rest of the clause (KEY ...) in CLAUSES, and true if CLAUSES has such a clause."
  (let ((clause (assoc key clauses)))
    (values (rest clause) (and clause t))))

(defun check-clauses (definer name clauses allowed)
  "Signal MALFORMED-DEFINITION unless each of CLAUSES starts with one of the keywords ALLOWED."
  (dolist (clause clauses)
    (unless (member (first (ensure-list clause)) allowed)
      (reject-clause (definition-title definer name) clause
                     (format nil "a list that starts with one of ~{~(~S~)~^, ~}" allowed)))))

(defun state-number (name names)
  (or (position name names)
      (reject-name "state" name names)))

(defun with-node-form (name clauses forms)
  "Return a form that runs FORMS with the parts and states from the CLAUSES of node type NAME."
  (let ((states (mapcar #'first (clause-rest :steps clauses))))
    `(symbol-macrolet (,@(loop for part in (clause-rest :parts clauses)
                               collect `(,(first part) (,(symbolicate name '- (first part)) node)))
                       (environment (frame-environment frame))
                       (memory (frame-data frame)))
       (macrolet ((next (state)
                    (list 'setf '(frame-counter frame) (state-number state ',states)))
                  (in-state-p (state)
                    (list '= '(frame-counter frame) (state-number state ',states))))
         ,@forms))))

(defun state-forms (states)
  "Return the forms of a step. Its STATES, each (state form...), become local functions."
  (let* ((names (mapcar #'first states))
         (functions (loop for name in names collect (make-symbol (symbol-name name)))))
    `((macrolet ((at-once (state)
                   (list 'progn (list 'next state)
                         (list (nth (state-number state ',names) ',functions)))))
        (labels ,(loop for (nil . forms) in states
                       for function in functions
                       collect `(,function () ,@forms))
          (ecase (frame-counter frame)
            ,@(loop for function in functions
                    for number from 0
                    collect `(,number (,function)))))))))

(defun node-defun-form (function name clauses variables forms)
  `(defun ,function (node task frame ,@variables)
     (declare ,@(when (nth-value 1 (clause-rest :hot clauses)) (list *hot*))
              (type ,name node) (type task task) (type frame frame)
              (ignorable node task frame ,@variables))
     ,(with-node-form name clauses forms)))

(defun node-function-specs (name clauses)
  "Return lists (slot function definition) for the slots from the CLAUSES of node type NAME."
  (flet ((row (slot prefix variables forms)
           (when forms
             (let ((function (symbolicate prefix '- name)))
               (list (list slot function
                           (node-defun-form function name clauses variables forms)))))))
    (append (row 'step 'step '(value)
                 (or (clause-rest :step clauses)
                     (and (clause-rest :steps clauses) (state-forms (clause-rest :steps clauses)))))
            (row 'unwind 'unwind '(signal) (clause-rest :unwind clauses))
            (row 'child-ended 'child-ended '(child how result)
                 (clause-rest :child-ended clauses)))))

(defmacro define-expression (name documentation &body clauses)
  "Define the structure NAME, a type of nodes. DOCUMENTATION says what the nodes do. CLAUSES:
(:parts (name type)...): the slots of the node, in addition to the slots of all nodes. MAKE-NAME
requires them all.
(:steps (state form...)...): the forms of a step in each state. A frame begins in the first state.
The forms of another state run when the activity that the frame started for this state, such as an
inner expression, has ended. These variables are visible: NODE, TASK, FRAME, VALUE (the value of the
ended activity), the parts by name, ENVIRONMENT (of the frame), and MEMORY (a place for data of the
frame, at first NIL). (next state) sets the state of the next step; (at-once state) also takes that
step now. The forms return the next frame and its value. (values (frame-up frame) value) ends the
expression, (enter part environment frame) runs a part, and +PARKED+ means that TASK now waits.
(:step form...): the forms of a step in an expression without states, which may use (frame-counter
frame).
(:unwind form...): the forms that run when SIGNAL passes through the node: see NODE. (in-state-p
state) is true if the frame is in that state.
(:child-ended form...): the forms that run when CHILD has ended as HOW with RESULT. (:hot): compile
the functions for speed, because a profile has shown that this matters."
  (check-clauses "define-expression" name clauses
                 '(:parts :steps :step :unwind :child-ended :hot))
  (let ((functions (node-function-specs name clauses)))
    `(progn
       (declaim (ftype function ,@(mapcar #'second functions)))
       (defstruct (,name (:include node
                          (states ,(map 'vector (lambda (state) (make-keyword (first state)))
                                        (clause-rest :steps clauses)))
                          ,@(loop for (slot function) in functions
                                  collect `(,slot #',function)))
                         (:copier nil))
         ,documentation
         ,@(loop for (part type) in (clause-rest :parts clauses)
                 collect `(,part (reject-missing-slot ',part) :type ,type)))
       ,@(mapcar #'third functions)
       ',name)))

;;; A construct has four parts: for users a macro, with its lambda list, documentation and the error
;;; outside of plans; for the compiler, how to make a node; for tasks, the steps of the node in
;;; named states; and what the node does at a signal. For an example see rpl/language/README.md.

;;; All constructs.

(defvar *constructs* '()
  "A list of the names of constructs, each with its clauses, the newest construct first.")

(defun note-construct (name clauses)
  (setf (rest (or (assoc name *constructs*)
                  (first (push (list name) *constructs*))))
        clauses))

(defun all-constructs ()
  "Return the names of all constructs defined by DEFINE-CONSTRUCT, in order of definition."
  (reverse (mapcar #'first *constructs*)))

(defun clauses-with-inherited (clauses)
  "Return CLAUSES and, if CLAUSES has (:like construct), the clauses of that construct."
  (let ((like (first (clause-rest :like clauses))))
    (if like
        (append clauses (remove :manual (or (rest (assoc like *constructs*))
                                            (reject-name "construct" like (all-constructs)))
                                :key #'first))
        clauses)))

;;; Values that the task must wait for before the construct begins.

(defmacro with-hoisted-arguments (arguments form scope &body body)
  "Run BODY, which returns the code for FORM in SCOPE. ARGUMENTS are parts of FORM. If an argument
makes its task wait, bind it, and all arguments to its left, to variables before FORM."
  (if (null arguments)
      `(progn ,@body)
      `(call-with-hoisted-arguments (list* ,@(if (eq '&rest (first (last arguments 2)))
                                                 (append (butlast arguments 2) (last arguments))
                                                 (append arguments '('()))))
                                    ,form ,scope (lambda () ,@body))))

(defun call-with-hoisted-arguments (arguments form scope coder)
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
  "Return FORM with the expansion of SYMBOL, a symbol macro that is an argument of FORM. Only the
first occurrence is expanded, because arguments come before bodies."
  (let ((expansion (note-plan-text (macroexpand-1 symbol (scope-environment scope)))) (done-p nil))
    (labels ((expanded (part)
               (cond (done-p part)
                     ((eq part symbol) (setf done-p t) expansion)
                     ((consp part) (let ((first (expanded (car part))))
                                     (cons first (expanded (cdr part)))))
                     (t part))))
      (cons (first form) (expanded (rest form))))))

(defun hoisted-form (parts form)
  "Return FORM with its conses PARTS replaced by variables, inside a LET* that binds the variables."
  (let ((names (loop for nil in parts collect (gensym "PART"))))
    `(let* ,(mapcar #'list names parts)
       ,(reduce (lambda (form pair) (subst (first pair) (second pair) form :test #'eq))
                (mapcar #'list names parts) :initial-value form))))

;;; The definition.

(defun stub-form (name lambda-list documentation in-lisp)
  "Return the definition of the macro NAME. IN-LISP is the form for its expansion in Lisp, or NIL."
  (if in-lisp
      (user-macro-form name `(&whole form ,@lambda-list) (cons name lambda-list)
                       `(,documentation
                         (declare (ignorable ,@(destructuring-variables lambda-list)))
                         ,in-lisp))
      ;; Outside of plans it does not matter whether the form fits.
      `(defmacro ,name (&whole form &rest arguments)
         ,documentation
         (declare (ignore arguments))
         (list 'plan-only-form form))))

(defun construct-code-form (node clauses)
  (let ((code (first (clause-rest :code clauses))))
    `(flet ((build (&optional (scope scope))
              (declare (ignorable scope))
              (list ',(symbolicate 'make- node)
                    :form (list 'quote (form-as-written form))
                    ,@(loop for (part nil code) in (clause-rest :parts clauses)
                            append (list (make-keyword part) code)))))
       (declare (ignorable #'build))
       ,(or code '(build)))))

(defun plan-form-definition-code (name node lambda-list clauses)
  (multiple-value-bind (waits given) (clause-rest :waits clauses)
    `(define-plan-form ,name ,(if given (first waits) :must) ,lambda-list (form scope)
       (with-hoisted-arguments ,(clause-rest :arguments clauses) form scope
         ,(construct-code-form node clauses)))))

(defmacro define-construct (name lambda-list documentation &body clauses)
  "Add the construct NAME to the plan language, and export NAME from the current package.
LAMBDA-LIST has no defaults. DOCUMENTATION is for users. CLAUSES:
(:manual): the construct is in the manual.
(:command): there is a command of the same name, which users see. The documentation of the command
must also explain the construct.
(:waits :MUST, :MAY or NIL): whether the construct makes its task wait, see SUSPENSION; default
:MUST.
(:arguments form...): the arguments that are ordinary values. Each form is a variable of
LAMBDA-LIST, or returns part of the value of such a variable. If such an argument waits, it is
evaluated first. The last form may be a list after &rest.
(:parts (name type form)...): the parts of the node. Each form returns code for a part; FORM, SCOPE
and the variables of LAMBDA-LIST are bound.
(:code form): the code for the whole construct, if it is another expression, or if the node needs
something around it. (build [scope]) in the form returns the code for the node.
(:steps ...), (:step ...), (:unwind ...), (:child-ended ...), (:hot): see DEFINE-EXPRESSION.
(:in-lisp form): the expansion in ordinary Lisp. Without :IN-LISP, the construct is an error in
ordinary Lisp. If the construct has neither :code nor a step, plans use this expansion, too. (:like
construct): take missing clauses from that construct, whose lambda list must be the same."
  (check-clauses "define-construct" name clauses
                 '(:manual :command :waits :arguments :parts :code :steps :step :unwind
                   :child-ended :hot :in-lisp :like))
  (let* ((node (symbolicate name '-node))
         (all (clauses-with-inherited clauses))
         (node-p (or (clause-rest :steps all) (clause-rest :step all))))
    `(progn
       (eval-when (:compile-toplevel :load-toplevel :execute)
         (export ',name)
         (note-construct ',name ',all))
       ,@(unless (assoc :command clauses)
           `((,(if (assoc :manual clauses) 'public 'addition) ,name)))
       ,(stub-form name lambda-list documentation (first (clause-rest :in-lisp all)))
       (show-lambda-list ',name ',lambda-list)
       ,@(when node-p
           `((define-expression ,node ,(format nil "The node of ~A." name)
               ,@(loop for clause in all
                       when (member (first clause)
                                    '(:parts :steps :step :unwind :child-ended :hot))
                         collect clause))))
       ,@(when (or node-p (clause-rest :code all))
           `(,(plan-form-definition-code name node lambda-list all)))
       ',name)))
