;;;; leaving.lisp -- block and return-from, tagbody and go, also out of parallel branches.

(in-package :ars-magna.rpl.language)

;;; To leave is to send an ESCAPE up. Where it crosses the border of a task, that task ends, its
;;; siblings evaporate, and the escape goes on in the task around them.

(define-node block-node ((body node))
  "BODY, which can be left with a value."
  :step step-block :unwind unwind-block)

(defun step-block (node task frame value)
  (declare (ignore task))
  (cond ((zerop (frame-counter frame))
         (setf (frame-counter frame) 1)
         (enter (block-node-body node) (frame-environment frame) frame))
        (t (values (frame-up frame) value))))

(defun unwind-block (node task frame signal)
  (declare (ignore task))
  (and (escape-p signal)
       (eq node (escape-target signal))
       (values t (frame-up frame) (escape-value signal))))

(define-node leave ((target node) (result node))
  "End of the block TARGET with the value of RESULT."
  :step step-leave)

(defun step-leave (node task frame value)
  (cond ((zerop (frame-counter frame))
         (setf (frame-counter frame) 1)
         (enter (leave-result node) (frame-environment frame) frame))
        (t (unwind task frame (make-escape (leave-target node) value)))))

(defun block-code (name form scope coder)
  "Return the code that CODER returns for a scope in which a block called NAME, whose source is
FORM, can be left. There is a node for it only if it is."
  (with-gensyms (target)
    (let ((code (funcall coder (inner-scope scope :blocks (acons name target
                                                                 (scope-blocks scope))))))
      (if (mentions-p target code)
          `(let ((,target (make-block-node :form ',form :body +nothing+)))
             (setf (block-node-body ,target) ,code)
             ,target)
          code))))

(define-plan-form "BLOCK" nil (name &rest body) (form scope)
  (block-code name form scope (lambda (scope) (body-code body scope))))

(define-plan-form "RETURN-FROM" nil (name &optional result) (form scope)
  (let ((target (cdr (assoc name (scope-blocks scope)))))
    (if target
        `(make-leave :form ',form :target ,target
                     :result ,(plan-code result (several-scope scope)))
        (reject-name "block" name (mapcar #'car (scope-blocks scope))))))

;;; Tags.

(define-node tag-body ((parts simple-vector))
  "Expressions run in order, some of which can be gone to. COUNTER is the next one."
  :step step-tag-body :unwind unwind-tag-body)

(defun step-tag-body (node task frame value)
  (declare (ignore task value))
  (let ((i (frame-counter frame))
        (parts (tag-body-parts node)))
    (cond ((< i (length parts))
           (setf (frame-counter frame) (1+ i))
           (enter (the node (svref parts i)) (frame-environment frame) frame))
          (t (values (frame-up frame) nil)))))

(defun unwind-tag-body (node task frame signal)
  (declare (ignore task))
  (when (and (escape-p signal) (eq node (escape-target signal)))
    (setf (frame-counter frame) (escape-value signal))
    (values t frame nil)))

(define-node jump ((target node) (place fixnum))
  "Going on at the expression number PLACE of TARGET."
  :step step-jump)

(defun step-jump (node task frame value)
  (declare (ignore value))
  (unwind task (frame-up frame) (make-escape (jump-target node) (jump-place node))))

(define-plan-form "TAGBODY" nil (&rest parts) (form scope)
  (with-gensyms (target)
    (let* ((forms (remove-if #'atom parts))
           (tags (loop with place = 0
                       for part in parts
                       if (atom part) collect (list* part target place)
                       else do (incf place)))
           (inner (inner-scope (single-scope scope) :tags (append tags (scope-tags scope)))))
      `(let ((,target (make-tag-body :form ',form :parts (vector))))
         (setf (tag-body-parts ,target)
               (vector ,@(loop for part in forms collect (plan-code part inner))))
         ,target))))

(define-plan-form "GO" nil (tag) (form scope)
  (destructuring-bind (&optional target . place) (cdr (assoc tag (scope-tags scope)))
    (if target
        `(make-jump :form ',form :target ,target :place ,place)
        (reject-name "tag" tag (mapcar #'car (scope-tags scope))))))
