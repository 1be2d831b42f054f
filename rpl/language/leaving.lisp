;;;; leaving.lisp -- block and return-from, tagbody and go, also out of parallel branches.

(in-package :ars-magna.rpl.language)

(export '(block-code make-leave))

;;; To leave is to send an ESCAPE up. Where it crosses the border of a task, that task ends, its
;;; siblings evaporate, and the escape goes on in the task around them.

(define-expression block-node
  "BODY, which can be left with a value."
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
  "End of the block TARGET with the value of RESULT."
  (:parts (target node) (result node))
  (:steps
   (begin
    (next getting-result)
    (enter result environment frame))
   (getting-result (unwind task frame (make-escape target value)))))

(setf (documentation 'make-leave 'function)
      "Return a node that leaves for its target with the value of its result, both nodes.")

(defun block-code (name form scope coder)
  "Return the code that CODER returns for a scope in which a block called NAME, whose source is
FORM, can be left. There is a node for it only if it is."
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
                     :result ,(plan-code result (several-scope scope)))
        (reject-name "block" name (mapcar #'car (scope-blocks scope))))))

;;; Tags.

(define-expression tag-body
  "Expressions run in order, some of which can be gone to. A frame counts those done with."
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
  "Going on at the expression number PLACE of TARGET."
  (:parts (target node) (place fixnum))
  (:step (unwind task (frame-up frame) (make-escape target place))))

(define-plan-form "TAGBODY" nil (&rest parts) (form scope)
  (with-gensyms (target)
    (let* ((forms (remove-if #'atom parts))
           (tags (loop with place = 0
                       for part in parts
                       if (atom part) collect (list* part target place)
                       else do (incf place)))
           (inner (inner-scope (single-scope scope) :tags (append tags (scope-tags scope)))))
      `(let ((,target (make-tag-body :form ',(form-as-written form) :parts (vector))))
         (setf (tag-body-parts ,target)
               (vector ,@(loop for part in forms collect (plan-code part inner))))
         ,target))))

(define-plan-form "GO" nil (tag) (form scope)
  (destructuring-bind (&optional target . place) (cdr (assoc tag (scope-tags scope)))
    (if target
        `(make-jump :form ',(form-as-written form) :target ,target :place ,place)
        (reject-name "tag" tag (mapcar #'car (scope-tags scope))))))
