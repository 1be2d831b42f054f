;;;; construct.lisp -- define-construct: all that there is to know of a construct, in one form.

(in-package :ars-magna.rpl.language)

;;; A construct has four sides. Users meet a macro: its lambda list, documentation, and the error if
;;; it is written outside of plans. The compiler makes a node of it. A task runs the node step by
;;; step, in states that have names. And signals pass it. See rpl/README.md for how to add one.

(defmacro in-plans-only (form)
  "Signal MISUSE: FORM, of the plan language, was met in ordinary Lisp code."
  (misplaced (first form) (rest form)))

(defun part-name (part) (first part))

(defun node-name (name) (symbolicate name '-node))

(defun slot-reader (name part) (symbolicate name '-node- (part-name part)))

(defmacro in-states (names state &body body)
  "Run BODY, in which (next NAME) lets the place STATE be that of the state called NAME."
  `(macrolet ((next (name)
                (let ((index (position name ',names)))
                  (unless index (reject-name "state" name ',names))
                  (list 'setf ',state index))))
     ,@body))

(defun with-parts-form (name parts states forms)
  "Return a form that runs FORMS with PARTS of the construct NAME, its states, the environment and
the memory of its frame at hand."
  `(symbol-macrolet (,@(loop for part in parts
                             collect `(,(part-name part) (,(slot-reader name part) node)))
                     (environment (frame-environment frame))
                     (memory (frame-data frame)))
     (in-states ,states (frame-counter frame) ,@forms)))

(defun step-definition (function name parts states)
  "Return the definition of FUNCTION, which takes a step of the construct NAME."
  (let ((names (mapcar #'first states)))
    `(defun ,function (node task frame value)
       (declare (type ,(node-name name) node) (type task task) (type frame frame)
                (ignorable node task value))
       ,(with-parts-form
         name parts names
         `((ecase (frame-counter frame)
             ,@(loop for (nil . forms) in states
                     for index from 0
                     collect `(,index ,@forms))))))))

(defun handler-definition (function name parts states variables forms)
  "Return the definition of FUNCTION, of node, task, frame and VARIABLES, for the construct NAME."
  `(defun ,function (node task frame ,@variables)
     (declare (type ,(node-name name) node) (type task task) (type frame frame)
              (ignorable node task frame ,@variables))
     ,(with-parts-form name parts (mapcar #'first states) forms)))

(defmacro hoisting (arguments form scope &body body)
  "Run BODY, which returns the code for FORM in SCOPE; but should one of ARGUMENTS, variables whose
values are parts of FORM, make its task wait, bind it before FORM."
  (if (null arguments)
      `(progn ,@body)
      `(call-hoisting (list ,@arguments) ,form ,scope (lambda () ,@body))))

(defun call-hoisting (arguments form scope coder)
  "Return the code for FORM in SCOPE, which CODER returns if none of ARGUMENTS, parts of FORM, makes
its task wait; otherwise they are bound before."
  (let ((first (find-if (lambda (argument) (suspends-p argument scope)) arguments)))
    (if first
        (with-gensyms (value)
          (plan-code (note-own-text `(let ((,value ,first))
                                       ,(subst value first form :test #'eq)))
                     scope))
        (funcall coder))))

(defun check-construct (name clauses)
  (dolist (clause clauses)
    (unless (member (first (ensure-list clause))
                    '(:manual :waits :like :arguments :parts :code :steps :unwind :child-ended))
      (reject-clause (title "define-construct" name) clause
                     "one of :manual, :waits, :like, :arguments, :parts, :code, :steps, :unwind ~
                      and :child-ended"))))

(defmacro define-construct (name lambda-list documentation &body clauses)
  "Let the plan language have the construct NAME, exported from the package at hand. LAMBDA-LIST has
no defaults. DOCUMENTATION is for users. CLAUSES:
(:manual): the manual has it. (:waits :MUST, :MAY or NIL): whether it makes its task wait, see
SUSPENSION; :MUST if not given. (:arguments variable...): those of LAMBDA-LIST that are ordinary
values, which should they wait are had before.
(:parts (name type form)...): what its node consists of; each form returns code, with the variables
of LAMBDA-LIST, FORM and SCOPE bound. (:code form): the code for the whole, if it is another
expression, or if the node needs something around it; then (build) in it is the code for the node.
(:steps (state form...)...): what a step does in each state, of which the first is where it begins;
the forms see TASK, FRAME, the VALUE of the inner expression that has ended, ENVIRONMENT, MEMORY
(what the frame remembers) and the parts by name; (next state) goes over to that. They return the
frame to go on with and its value, as ENTER does, or +PARKED+.
(:unwind form...): what is done when SIGNAL passes; see NODE. (:child-ended form...): what is done
when CHILD has ended as HOW with RESULT. (:like construct): these are that one's, if not given."
  (check-construct name clauses)
  (flet ((clause (key) (rest (assoc key clauses))))
    (let* ((parts (clause :parts))
           (states (clause :steps))
           (like (first (clause :like)))
           (step (symbolicate 'step- name))
           (unwind (and (clause :unwind) (symbolicate 'unwind- name)))
           (child-ended (and (clause :child-ended) (symbolicate name '-part-over)))
           (waits (if (assoc :waits clauses) (first (clause :waits)) :must)))
      `(progn
         (eval-when (:compile-toplevel :load-toplevel :execute)
           (export ',name))
         (,(if (assoc :manual clauses) 'public 'addition) ,name)
         (defmacro ,name (&whole form ,@lambda-list)
           ,documentation
           (declare (ignore ,@(element-names lambda-list)))
           (list 'in-plans-only form))
         ,@(when (or states like)
             `((defstruct (,(node-name name)
                           (:include ,(if like (node-name like) 'node)
                            ,@(when states `((step #',step)))
                            ,@(when unwind `((unwind #',unwind)))
                            ,@(when child-ended `((child-ended #',child-ended))))
                           (:copier nil))
                 ,(format nil "The node of ~A." name)
                 ,@(loop for (slot type) in parts
                         collect `(,slot (required-slot ',slot) :type ,type)))))
         ,@(when states `(,(step-definition step name parts states)))
         ,@(when unwind
             `(,(handler-definition unwind name parts states '(signal) (clause :unwind))))
         ,@(when child-ended
             `(,(handler-definition child-ended name parts states '(child how result)
                                    (clause :child-ended))))
         (define-plan-form ,(symbol-name name) ,waits ,lambda-list (form scope)
           (hoisting ,(clause :arguments) form scope
             ,(construct-code-form name parts (clause :code))))
         ',name))))

(defun construct-code-form (name parts code)
  "Return the form that makes the code for the construct NAME."
  (let ((build `(list ',(symbolicate 'make- (node-name name))
                      :form (list 'quote form)
                      ,@(loop for (part nil code) in parts
                              append (list (make-keyword part) code)))))
    (if code
        `(flet ((build (&optional (scope scope)) (declare (ignorable scope)) ,build))
           (declare (ignorable #'build))
           ,@code)
        build)))
