;;;; steps.lisp -- one thing after the other: seq, progn and forms that stand for their contents.

(in-package :ars-magna.rpl.language)

(export '(binding-body-code body-code steps steps-parts))

(declaim (inline enter-last))
(defun enter-last (node environment frame)
  (let ((up (frame-up frame)))
    (if (leaf-p node)
        (values up (call-leaf node environment))
        (values (make-frame node environment up) nil))))

(define-expression steps
  "Expressions, at least one, run in order. A frame counts those begun."
  (:hot)
  (:parts (parts simple-vector))
  (:step
   (let ((parts parts)
         (i (frame-counter frame)))
     (setf (frame-counter frame) (1+ i))
     (if (< (1+ i) (length parts))
         (enter (the node (svref parts i)) environment frame)
         (enter-last (the node (svref parts i)) environment frame)))))

(setf (documentation 'steps-parts 'function)
      "Return the vector of the nodes that are run one after the other.")

(defmethod current-form ((node steps) frame)
  (let ((i (frame-counter frame)))
    (if (plusp i)
        (node-form (svref (steps-parts node) (1- i)))
        (node-form node))))

(defun steps-code (forms scope)
  (let ((single (single-scope scope)))
    (naming-code `(make-steps :form '(seq ,@forms)
                              :parts (vector ,@(loop for (form . more) on forms
                                                     for inner = (if more single scope)
                                                     collect (plan-code form inner))))
                 scope)))

(defun body-code (forms scope)
  "Return code for FORMS as the steps of a body, of which the last one gives the values."
  (cond
    ((null forms) '+nothing+)
    ((null (rest forms)) (plan-code (first forms) scope))
    ;; What is wrong with the forms themselves comes first.
    (t (prog1 (steps-code forms scope)
         (check-after-whenever forms)))))

(defun binding-body-code (forms scope)
  "Return code for FORMS, a body that may start with declarations; these are for the reader only."
  (body-code (remove-if #'declaration-p forms) scope))

(defun declaration-p (form)
  (and (consp form) (eq (first form) 'declare)))

(defun declared-special (variables forms)
  (loop for form in forms
        when (declaration-p form)
          append (loop for (kind . names) in (rest form)
                       when (eq kind 'special) append (intersection names variables))))

;;; The forms.

(define-construct seq (&body steps)
  "Run STEPS in order and return the value of the last one; fail as soon as one fails. Policies
get their chance between steps. In ordinary Lisp, PROGN (manual D.2)."
  (:manual)
  (:waits :may)
  (:in-lisp `(progn ,@steps))
  (:code (body-code steps scope)))

(define-plan-form "PROGN" nil (&rest steps) (form scope)
  (body-code steps scope))

(define-plan-form "LOCALLY" nil (&rest steps) (form scope)
  (if (declared-special (scope-variables scope) steps)
      (refuse-code form scope)
      (binding-body-code steps scope)))

(define-plan-form "THE" nil (type part) (form scope)
  (declare (ignore type))
  (plan-code part scope))

(define-plan-form "SETQ" nil (&rest pairs) (form scope)
  (if (cddr pairs)
      (body-code (loop for (variable value) on pairs by #'cddr
                       collect (note-own-text `(setq ,variable ,value)))
                 scope)
      (hoisted-code form scope 2)))
