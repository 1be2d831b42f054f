;;;; repeating.lisp -- loops, block and return-from, tagbody and go.

(in-package :ars-magna.rpl.language)

(export '(block-code make-leave item-loop-body-code give-way item-list))

;;; To leave is to send an ESCAPE up. Where it crosses the border of a task, that task ends, its
;;; siblings evaporate, and the escape goes on in the task around them.

(define-expression block-node
  "Runs BODY, which can be left with a value."
  (:parts (body node))
  (:steps
   (begin
    (next inside)
    (enter body environment frame))
   (inside (values (frame-up frame) value)))
  (:unwind
   (and (escape-p signal)
        (eq node (escape-target signal))
        (values t (frame-up frame) (escape-value signal)))))

(define-expression leave
  "Leaves the block TARGET with the value of RESULT."
  (:parts (target node) (result node))
  (:steps
   (begin
    (next getting-result)
    (enter result environment frame))
   (getting-result (unwind task frame (make-escape target value)))))

(setf (documentation 'make-leave 'function)
      "Return a node that leaves the block of node TARGET with the value of node RESULT.")

(defun block-code (name form scope coder)
  "Return the code that CODER returns for a scope inside a block with the name NAME. FORM is the
source of the block. The code has a node for the block only if some form leaves the block."
  (with-gensyms (target)
    (let ((code (funcall coder (inner-scope scope :blocks (acons name target
                                                                 (scope-blocks scope))))))
      (if (mentions-p target code)
          `(let ((,target (make-block-node :form ',(form-as-written form) :body +nothing+)))
             (setf (block-node-body ,target) ,code)
             ,target)
          code))))

(define-plan-form "BLOCK" nil (name &rest body) (form scope)
  (block-code name form scope (lambda (scope) (body-code body scope))))

(define-plan-form "RETURN-FROM" nil (name &optional result) (form scope)
  (let ((target (cdr (assoc name (scope-blocks scope)))))
    (if target
        `(make-leave :form ',(form-as-written form) :target ,target
                     :result ,(plan-code result (multiple-values-scope scope)))
        (reject-name "block" name (mapcar #'car (scope-blocks scope))))))

;;; Tags.

(define-expression tag-body
  "Runs expressions, some of them targets of jumps. The frame's counter says how many have begun."
  (:parts (parts simple-vector))
  (:step
   (let ((i (frame-counter frame)))
     (cond ((< i (length parts))
            (setf (frame-counter frame) (1+ i))
            (enter (the node (svref parts i)) environment frame))
           (t (values (frame-up frame) nil)))))
  (:unwind
   (when (and (escape-p signal) (eq node (escape-target signal)))
     (setf (frame-counter frame) (escape-value signal))
     (values t frame nil))))

(define-expression jump
  "Jumps to expression number PLACE of TARGET."
  (:parts (target node) (place fixnum))
  (:step (unwind task (frame-up frame) (make-escape target place))))

(define-plan-form "TAGBODY" nil (&rest parts) (form scope)
  (with-gensyms (target)
    (let* ((forms (remove-if #'atom parts))
           (tags (loop with place = 0
                       for part in parts
                       if (atom part) collect (list* part target place)
                       else do (incf place)))
           (inner (inner-scope (single-value-scope scope) :tags (append tags (scope-tags scope)))))
      `(let ((,target (make-tag-body :form ',(form-as-written form) :parts (vector))))
         (setf (tag-body-parts ,target)
               (vector ,@(loop for part in forms collect (plan-code part inner))))
         ,target))))

(define-plan-form "GO" nil (tag) (form scope)
  (destructuring-bind (&optional target . place) (cdr (assoc tag (scope-tags scope)))
    (if target
        `(make-jump :form ',(form-as-written form) :target ,target :place ,place)
        (reject-name "tag" tag (mapcar #'car (scope-tags scope))))))

;;; After each turn others that are ready get theirs, so that a loop that never waits cannot keep
;;; them out. All of these can be left by RETURN.

(defun give-way (task)
  "Let other ready tasks run before TASK continues. Return +PARKED+."
  (make-ready task)
  +parked+)

(defun repetition-count (count)
  (let ((count (fluent-value count)))
    (check-argument n-times count (bounded-number-p count)
                    "a number of times, from -1e15 to 1e15, as in (n-times count form...)")
    count))

(define-expression turns
  "Runs BODY repeatedly, while the function UNTIL returns false for the environment. The function
TIMES returns the maximum number of iterations, or NIL for no limit. A frame counts them down."
  (:hot)                                ; 40 ns a turn
  (:parts (until function) (times function) (body node))
  (:steps
   (begin
    (setf memory (funcall times environment))
    (at-once between-turns))
   (in-turn
    (cond ((only-ready-task-p task) (at-once between-turns))
          (t (next between-turns) (give-way task))))
   (between-turns
    (let ((left memory))
      (cond ((or (and left (<= (the real left) 0))
                 (funcall until environment))
             (values (frame-up frame) nil))
            (t (when left (setf memory (1- (the real left))))
               (next in-turn)
               (enter body environment frame)))))))

(defun split-loop-test (forms)
  "FORMS follow LOOP. Return the condition that ends the loop, or NIL, and the body of the loop."
  (cond ((starts-with-test-p forms "UNTIL") (values (second forms) (cddr forms)))
        ((starts-with-test-p forms "WHILE")
         (values (note-plan-text `(not ,(second forms))) (cddr forms)))
        (t (values nil forms))))

(defun loop-code (form count forms scope)
  "Return code for a loop of FORMS, which follow LOOP or N-TIMES. COUNT is a form for the maximum
number of iterations, or NIL for no limit."
  (multiple-value-bind (test body) (split-loop-test forms)
    (if (suspends-p test scope)
        (loop-code form count
                   (list* (note-plan-text `(when ,test (return-from nil nil))) body) scope)
        (block-code nil form scope
                    (lambda (scope)
                      `(make-turns :form ',(form-as-written form)
                                   :until ,(value-lambda (condition-form
                                                          test (scope-environment scope))
                                                         scope)
                                   :times ,(value-lambda count scope)
                                   :body ,(body-code body (single-value-scope scope))))))))

(define-plan-form "LOOP" :may (&rest forms) (form scope)
  (loop-code form nil forms scope))

(define-construct n-times (count &body body)
  "Run BODY in a plan COUNT times in sequence. BODY may start with UNTIL or WHILE and a test, which
is evaluated before each iteration. COUNT is a number up to 1e15. Return NIL."
  (:arguments count)
  (:code (loop-code form (note-plan-text `(repetition-count ,count)) body scope)))

;;; Over the elements of a list, and numbers.

(defun item-list (operator sequence)
  "Return a list of the elements of SEQUENCE, over which OPERATOR iterates. Signals WRONG-ARGUMENT
unless SEQUENCE is a vector or a proper list."
  (unless (typep sequence '(and sequence (or (not list) (satisfies proper-list-p))))
    (reject-argument operator 'sequence sequence "a vector, or a proper list"))
  (coerce sequence 'list))

(defun checked-proper-list (operator list)
  (unless (proper-list-p list)
    (reject-argument operator 'list list "a proper list"))
  list)

(define-expression each
  "Runs BODY for each element of the list that ITEMS returns, in an environment with this element.
Afterwards runs ENDING in an environment with NIL. A frame remembers the elements left."
  (:parts (items function) (body node) (ending node))
  (:steps
   (begin
    (setf memory (checked-proper-list 'dolist (funcall items environment)))
    (at-once between-turns))
   (in-turn
    (cond ((or (null memory) (only-ready-task-p task)) (at-once between-turns))
          (t (next between-turns) (give-way task))))
   (between-turns
    (cond ((endp memory) (enter-tail ending (vector environment nil) frame))
          (t (next in-turn)
             (enter body (vector environment (pop memory)) frame))))))

(define-expression each-number
  "Runs BODY once for each integer N from 0 to one less than the value of LIMIT, in an environment
that contains N. Afterwards runs ENDING in an environment with the number of iterations. A frame
remembers a cons of the next number and the limit."
  (:parts (limit function) (body node) (ending node))
  (:steps
   (begin
    (setf memory (cons 0 (funcall limit environment)))
    (at-once between-turns))
   (in-turn
    (cond ((or (>= (car memory) (cdr memory)) (only-ready-task-p task)) (at-once between-turns))
          (t (next between-turns) (give-way task))))
   (between-turns
    (let ((number (car memory)))
      (cond ((>= number (cdr memory))
             (enter-tail ending (vector environment number) frame))
            (t (incf (car memory))
               (next in-turn)
               (enter body (vector environment number) frame)))))))

(defun item-loop-body-code (variable body scope)
  "Return code for BODY in an environment in which VARIABLE is bound."
  (binding-body-code body (variable-scope (single-value-scope scope) (list variable))))

(defun item-loop-code (maker form variable part result body scope)
  (destructuring-bind (slot source) part
    (with-hoisted-arguments (source) form scope
      (block-code nil form scope
                  (lambda (scope)
                    (let ((inner (variable-scope scope (list variable))))
                      `(,maker :form ',(form-as-written form)
                               ,slot ,(value-lambda source scope)
                               :body ,(item-loop-body-code variable body scope)
                               :ending ,(body-code (remove nil result) inner))))))))

(define-plan-form "DOLIST" nil ((variable source &optional result) &rest body) (form scope)
  (item-loop-code 'make-each form variable (list :items source) (list result) body scope))

(define-plan-form "DOTIMES" nil ((variable limit &optional result) &rest body) (form scope)
  (item-loop-code 'make-each-number form variable (list :limit limit) (list result) body scope))
