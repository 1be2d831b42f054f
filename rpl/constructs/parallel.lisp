;;;; parallel.lisp -- par, pursue, try-all, par-loop.

(in-package :ars-magna.rpl.constructs)

;;; The task that runs one of these starts a child for each branch, in order, and waits. COUNTER is
;;; 1 from then on; DATA is what the construct has to remember. When the outcome is known the
;;; children that are left evaporate, newest first, and when all are gone the task goes on.
;;;
;;; A branch that others than the construct have evaporated counts as ended, neither well nor badly.

(define-node parallel ((branches simple-vector))
  "BRANCHES side by side."
  :step step-parallel)

(defun start-branches (branches task frame)
  (loop with environment = (frame-environment frame)
        for branch across branches
        for index from 0
        do (start-branch branch task environment index (task-level task))))

(defun step-parallel (node task frame value)
  (cond ((plusp (frame-counter frame)) (values (frame-up frame) value))
        (t (let ((branches (parallel-branches node)))
             (setf (frame-counter frame) 1)
             (cond ((plusp (length branches))
                    (start-branches branches task frame)
                    (park task nil)
                    +parked+)
                   (t (values (frame-up frame) nil)))))))

;;; PAR.

(define-node (par-node parallel) ()
  "All of BRANCHES. DATA is the value of the last."
  :step step-parallel :child-ended par-part-over)

(defun par-part-over (node task frame child how result)
  (unless (fail-or-escape task how result)
    (when (= (1+ (task-index child)) (length (parallel-branches node)))
      (setf (frame-data frame) result))
    (complete-when-alone task (frame-data frame))))

(public par)
(defmacro par (&body branches)
  "Run BRANCHES in a plan side by side. Succeed when all have, with the value of the last one; fail
as soon as one fails, and evaporate the others (manual D.7)."
  (misplaced 'par branches))

(define-plan-form "PAR" :must (&rest branches) (form scope)
  `(make-par-node :form ',form :branches ,(branches-code branches scope)))

(defun branches-code (branches scope)
  `(vector ,@(loop with single = (single-scope scope)
                   for branch in branches
                   collect (plan-code branch single))))

;;; PURSUE.

(define-node (pursue-node parallel) ()
  "The first of BRANCHES to end."
  :step step-parallel :child-ended pursue-part-over)

;; As reading 185 says.
(defun pursue-part-over (node task frame child how result)
  (declare (ignore node frame child))
  (cond ((fail-or-escape task how result))
        ((eq how :succeeded) (complete task result))
        (t (complete-when-alone task nil))))

(public pursue)
(defmacro pursue (&body branches)
  "Run BRANCHES in a plan side by side. Succeed as soon as one does, with its value; fail as soon as
one fails. Evaporate the others (manual D.4)."
  (misplaced 'pursue branches))

(define-plan-form "PURSUE" :must (&rest branches) (form scope)
  `(make-pursue-node :form ',form :branches ,(branches-code branches scope)))

;;; TRY-ALL.

(define-node (try-all-node parallel) ()
  "The first of BRANCHES to succeed. DATA is the failures, last first."
  :step step-parallel :child-ended try-all-part-over)

(defun try-all-part-over (node task frame child how result)
  (declare (ignore node child))
  (ecase how
    (:succeeded (complete task result))
    (:escaped (decide task result))
    (:failed (push result (frame-data frame)))
    (:evaporated))
  (unless (or (task-newest-child task) (task-signal task) (member how '(:succeeded :escaped)))
    (decide task (failure-of (make-condition 'composite-failure
                                             :failures (reverse (frame-data frame)))
                             task frame))))

(addition try-all)
(defmacro try-all (&body branches)
  "Run BRANCHES in a plan side by side. Succeed as soon as one does, with its value, and evaporate
the others; if all fail, fail with a composite failure."
  (misplaced 'try-all branches))

(define-plan-form "TRY-ALL" :must (&rest branches) (form scope)
  (if branches
      `(make-try-all-node :form ',form :branches ,(branches-code branches scope))
      (attempts-code form '() nil scope)))

;;; PAR-LOOP.

(define-node par-loop-node ((items function) (body node))
  "BODY for each element of the list that ITEMS of the environment returns, side by side, each in an
environment of its own. DATA is the number of the last and its value."
  :step step-par-loop :child-ended par-loop-part-over)

(defun step-par-loop (node task frame value)
  (if (plusp (frame-counter frame))
      (values (frame-up frame) value)
      (let* ((environment (frame-environment frame))
             (items (coerce (funcall (par-loop-node-items node) environment) 'list)))
        (setf (frame-counter frame) 1
              (frame-data frame) (cons (1- (length items)) nil))
        (loop for item in items
              for index from 0
              do (start-branch (par-loop-node-body node) task (vector environment item)
                               index (task-level task)))
        (cond (items (park task nil) +parked+)
              (t (values (frame-up frame) nil))))))

(defun par-loop-part-over (node task frame child how result)
  (declare (ignore node))
  (unless (fail-or-escape task how result)
    (when (= (task-index child) (the fixnum (car (frame-data frame))))
      (setf (cdr (frame-data frame)) result))
    (complete-when-alone task (cdr (frame-data frame)))))

(addition par-loop)
(defmacro par-loop ((variable sequence) &body body)
  "Run BODY in a plan for all elements of SEQUENCE side by side, each with its own VARIABLE; succeed
and fail as PAR does."
  (misplaced 'par-loop (list* (list variable sequence) body)))

(define-plan-form "PAR-LOOP" :must ((variable sequence) &rest body) (form scope)
  (each-code '(make-par-loop-node :items) form variable sequence '() body scope))
