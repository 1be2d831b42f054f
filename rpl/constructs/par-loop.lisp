;;;; par-loop.lisp -- side by side for each element of a sequence.

(in-package :ars-magna.rpl.constructs)

(define-construct par-loop ((variable sequence) &body body)
  "Run BODY in a plan for all elements of SEQUENCE side by side, each with its own VARIABLE; succeed
and fail as PAR does."
  (:arguments sequence)
  (:parts (items function (value-lambda sequence scope))
          (body node (each-body-code variable body scope)))
  (:code (block-code nil form scope #'build))
  (:steps
   (begin
    (next inside)
    (let ((items (coerce (funcall items environment) 'list)))
      ;; The number of the last one, and its value.
      (setf memory (cons (1- (length items)) nil))
      (loop for item in items
            for index from 0
            do (start-branch body task (vector environment item) index (task-level task)))
      (if items
          (await-parts task)
          (values (frame-up frame) nil))))
   (inside (values (frame-up frame) value)))
  (:child-ended
   (unless (fail-or-escape task how result)
     (when (= (task-index child) (the fixnum (car memory)))
       (setf (cdr memory) result))
     (complete-when-alone task (cdr memory)))))
