;;;; expression.lisp -- define-expression: a kind of node, and what it does in states with names.

(in-package :ars-magna.rpl.language)

(export '(define-expression value child how result environment memory next at-once in-state-p))

;;; A frame is always in one of the states of its node. States have names; that a frame holds their
;;; number, in its counter, is nobody's business but this file's and FRAME-STATE's.

(defun clause (key clauses)
  "Return what follows KEY in that of CLAUSES, (key ...), and true if there is one."
  (let ((clause (assoc key clauses)))
    (values (rest clause) (and clause t))))

(defun check-clauses (definer name clauses allowed)
  "Signal MALFORMED-DEFINITION unless each of CLAUSES starts with one of ALLOWED, keywords."
  (dolist (clause clauses)
    (unless (member (first (ensure-list clause)) allowed)
      (reject-clause (title definer name) clause
                     (format nil "a list that starts with one of ~{~(~S~)~^, ~}" allowed)))))

(defun state-number (name names)
  (or (position name names)
      (reject-name "state" name names)))

(defun with-node-form (name clauses forms)
  "Return a form that runs FORMS with what CLAUSES say of the node called NAME at hand."
  (let ((states (mapcar #'first (clause :steps clauses))))
    `(symbol-macrolet (,@(loop for part in (clause :parts clauses)
                               collect `(,(first part) (,(symbolicate name '- (first part)) node)))
                       (environment (frame-environment frame))
                       (memory (frame-data frame)))
       (macrolet ((next (state)
                    (list 'setf '(frame-counter frame) (state-number state ',states)))
                  (in-state-p (state)
                    (list '= '(frame-counter frame) (state-number state ',states))))
         ,@forms))))

(defun state-forms (states)
  "Return the forms of a step in STATES, each (state form...): a local function for each of them."
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

(defun node-function (function name clauses variables forms)
  `(defun ,function (node task frame ,@variables)
     (declare ,@(when (nth-value 1 (clause :hot clauses)) (list *hot*))
              (type ,name node) (type task task) (type frame frame)
              (ignorable node task frame ,@variables))
     ,(with-node-form name clauses forms)))

(defun node-functions (name clauses)
  "Return a list of (slot function definition): what a node called NAME does, as CLAUSES say."
  (flet ((row (slot prefix variables forms)
           (when forms
             (let ((function (symbolicate prefix '- name)))
               (list (list slot function
                           (node-function function name clauses variables forms)))))))
    (append (row 'step 'step '(value)
                 (or (clause :step clauses)
                     (and (clause :steps clauses) (state-forms (clause :steps clauses)))))
            (row 'unwind 'unwind '(signal) (clause :unwind clauses))
            (row 'child-ended 'child-ended '(child how result) (clause :child-ended clauses)))))

(defmacro define-expression (name documentation &body clauses)
  "Define NAME as a kind of node, by a structure. DOCUMENTATION says what it does. CLAUSES:
(:parts (name type)...): its slots, besides those of all nodes; all must be given to MAKE-NAME.
(:steps (state form...)...): what a step does in each state. The first is where a frame begins; the
others are called after what goes on while a frame is in them, such as an inner expression, and
their forms run when that is over. They see NODE, TASK, FRAME, the VALUE of what has ended, the
parts by name, the frame's ENVIRONMENT and its MEMORY, a place for what it has to remember, at first
NIL. (next state) goes over to that for the next step; (at-once state) takes that step, too. They
return the frame to go on with and its value: (values (frame-up frame) value) ends the expression,
(enter part environment frame) runs a part; or +PARKED+ if TASK now waits.
(:step form...): the same of an expression without states, which may count in (frame-counter frame).
(:unwind form...): what is done when SIGNAL passes, see NODE; (in-state-p state) is true if the
frame is in that. (:child-ended form...): what is done when CHILD has ended as HOW with RESULT.
(:hot): a profile has shown that this one must be fast."
  (check-clauses "define-expression" name clauses
                 '(:parts :steps :step :unwind :child-ended :hot))
  (let ((functions (node-functions name clauses)))
    `(progn
       (declaim (ftype function ,@(mapcar #'second functions)))
       (defstruct (,name (:include node
                          (states ,(map 'vector (lambda (state) (make-keyword (first state)))
                                        (clause :steps clauses)))
                          ,@(loop for (slot function) in functions
                                  collect `(,slot #',function)))
                         (:copier nil))
         ,documentation
         ,@(loop for (part type) in (clause :parts clauses)
                 collect `(,part (required-slot ',part) :type ,type)))
       ,@(mapcar #'third functions)
       ',name)))
