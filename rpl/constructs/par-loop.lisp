;;;; par-loop.lisp -- side by side for each element of a sequence.

(in-package :ars-magna.rpl.constructs)

(defun turn-environment (environment item tags)
  "Return an environment, in ENVIRONMENT, of ITEM and of tasks that are yet to start, one for each
of TAGS."
  (coerce (list* environment item (loop for tag in tags collect (make-task tag +nothing+)))
          'simple-vector))

(defun turn-code (variable body scope)
  "Return code for BODY in the environment of a turn: VARIABLE and the tags in BODY are its own."
  (let ((tags (tags-in body)))
    (binding-body-code body (tagged-scope (variable-scope (single-scope scope)
                                                          (cons variable tags))
                                          tags 2))))

(define-construct par-loop ((variable sequence) &body body)
  "Run BODY in a plan for all elements of SEQUENCE side by side, each with its own VARIABLE, and its
own tags; succeed and fail as PAR does."
  (:arguments sequence)
  (:parts (items function (value-lambda sequence scope))
          (tags list `',(tags-in body))
          (body node (turn-code variable body scope)))
  (:code (block-code nil form scope #'build))
  (:steps
   (begin
    (next inside)
    (let ((items (item-list 'par-loop (funcall items environment))))
      ;; The number of the last one, and its value.
      (setf memory (cons (1- (length items)) nil))
      (loop for item in items
            for index from 0
            do (start-branch body task (turn-environment environment item tags) index
                              (task-level task)))
      (if items
          (await-parts task)
          (values (frame-up frame) nil))))
   (inside (values (frame-up frame) value)))
  (:child-ended
   (unless (fail-or-escape task how result)
     (when (= (task-index child) (the fixnum (car memory)))
       (setf (cdr memory) result))
     (complete-when-alone task (cdr memory)))))
