;;;; branches.lisp -- branches in parallel, and alternatives in sequence.

(in-package :ars-magna.rpl.constructs)

;;; The task that runs one of these starts a child for each branch, in order, and waits. When the
;;; outcome is known, the remaining children evaporate, newest first. Then the task goes on.
;;;
;;; A branch evaporated from outside of the construct counts as ended, neither succeeded nor failed.

(defun branches-code (branches scope)
  `(vector ,@(loop for branch in branches collect (plan-code branch scope))))

(defun start-branches (branches task environment)
  (loop for branch across branches
        for index from 0
        do (start-branch branch task environment index (task-level task)))
  (await-parts task))

(defun await-parts (task)
  (park task nil)
  +parked+)

(define-construct par (&body branches)
  "Run BRANCHES in parallel in a plan. When all branches have succeeded, return the first value of
the last form written. When one branch fails, PAR fails and evaporates the others (manual D.7)."
  (:manual)
  (:parts (branches simple-vector (branches-code branches (single-value-scope scope))))
  (:steps
   (begin
    (next inside)
    (if (plusp (length branches))
        (start-branches branches task environment)
        (values (frame-up frame) nil)))
   (inside (values (frame-up frame) value)))
  (:child-ended
   (unless (fail-or-escape task how result)
     (when (= (1+ (task-index child)) (length branches))
       (setf memory result))
     (complete-when-alone task memory))))

(define-construct pursue (&body branches)
  "Run BRANCHES in parallel, in a plan, until one branch ends. PURSUE succeeds with the value of
that branch, or fails as it failed, and evaporates the others (manual D.4; reading 185)."
  (:manual)
  (:like par)
  (:child-ended
   (cond ((fail-or-escape task how result))
         ((eq how :succeeded) (end-with-value task result))
         (t (complete-when-alone task nil)))))

(defun composite-failure-from (failures task frame)
  "Return the failure of TASK at FRAME that contains FAILURES, a list with the newest first."
  (failure-of (make-condition 'composite-failure :failures (reverse failures)) task frame))

(define-construct try-all (&body branches)
  "Run BRANCHES in parallel in a plan. As soon as one branch succeeds, TRY-ALL returns its value and
evaporates the others. If all branches fail, TRY-ALL fails with a COMPOSITE-FAILURE."
  (:like par)
  (:steps
   (begin
    (next inside)
    (if (plusp (length branches))
        (start-branches branches task environment)
        (unwind task (frame-up frame) (composite-failure-from '() task frame))))
   (inside (values (frame-up frame) value)))
  (:child-ended
   (ecase how
     (:succeeded (end-with-value task result))
     (:escaped (end-with-signal task result))
     (:failed (push result memory))
     (:evaporated))
   (unless (or (task-newest-child task) (task-signal task) (member how '(:succeeded :escaped)))
     (end-with-signal task (composite-failure-from memory task frame)))))

;;;; One after the other

(defstruct (attempt-progress (:constructor make-attempt-progress (order)) (:copier nil))
  "ORDER is a list of the attempts left, each a cons (node . environment). FAILURES is a list of the
failures so far, the newest first."
  (order '() :type list)
  (failures '() :type list))

(defun in-written-order (attempts environment dice)
  (declare (ignore dice))
  (loop for attempt across attempts collect (cons attempt environment)))

(defun in-random-order (attempts environment dice)
  "Do as IN-WRITTEN-ORDER, in an order drawn from DICE; without DICE, keep the order as written."
  (loop with left = (in-written-order attempts environment dice)
        while left
        collect (let ((chosen (if dice (roll-element left dice) (first left))))
                  (setf left (remove chosen left :test #'eq))
                  chosen)))

(define-construct try-in-order (&body attempts)
  "Run ATTEMPTS in a plan one after the other until one succeeds; return the value of that attempt.
If all attempts fail, fail with a COMPOSITE-FAILURE."
  (:parts (attempts simple-vector (branches-code attempts scope))
          (order function '(function in-written-order)))
  (:steps
   (begin
    (setf memory (make-attempt-progress
                  (funcall order attempts environment (agent-dice (task-agent task)))))
    (at-once between-attempts))
   (trying (values (frame-up frame) value))
   (between-attempts
    (destructuring-bind (&optional attempt . inner) (pop (attempt-progress-order memory))
      (cond (attempt
             (next trying)
             (enter (the node attempt) inner frame))
            (t (unwind task (frame-up frame)
                       (composite-failure-from (attempt-progress-failures memory) task frame)))))))
  (:unwind
   (when (and (in-state-p trying) (typep signal 'plan-failure))
     (push signal (attempt-progress-failures memory))
     (next between-attempts)
     (values t frame nil))))

(define-construct try-one (&body attempts)
  "Do as TRY-IN-ORDER, but in random order, drawn from the dice of the plan runner. If the runner
has no dice, keep the order as written."
  (:like try-in-order)
  (:parts (attempts simple-vector (branches-code attempts scope))
          (order function '(function in-random-order))))

;;; For each element.

(define-construct try-each-in-order ((variable sequence) &body body)
  "Run BODY in a plan for each element of SEQUENCE in turn, bound to VARIABLE, until BODY succeeds.
Return the value of BODY. If BODY succeeds for no element, fail with a COMPOSITE-FAILURE."
  (:like try-in-order)
  (:arguments sequence)
  (:parts (attempts simple-vector `(vector ,(item-loop-body-code variable body scope)))
          (order function
                 `(let ((items ,(value-lambda sequence scope)))
                    (lambda (attempts environment dice)
                      (declare (ignore dice))
                      (loop for item in (item-list 'try-each-in-order (funcall items environment))
                            collect (cons (svref attempts 0) (vector environment item)))))))
  (:code (block-code nil form scope #'build)))

;;;; For each element of a sequence

(defun iteration-environment (environment item tags)
  (coerce (list* environment item (loop for tag in tags collect (make-task tag +nothing+)))
          'simple-vector))

(defun iteration-code (variable body scope)
  "Return code for BODY in the environment of one iteration, with its own VARIABLE and tags."
  (let ((tags (tags-in body)))
    (binding-body-code body (tagged-scope (variable-scope (single-value-scope scope)
                                                          (cons variable tags))
                                          tags 2))))

(define-construct par-loop ((variable sequence) &body body)
  "Run BODY in parallel for all elements of SEQUENCE, in a plan. Each branch has its own VARIABLE
and tags. PAR-LOOP succeeds and fails as PAR does."
  (:arguments sequence)
  (:parts (items function (value-lambda sequence scope))
          (tags list `',(tags-in body))
          (body node (iteration-code variable body scope)))
  (:code (block-code nil form scope #'build))
  (:steps
   (begin
    (next inside)
    (let ((items (item-list 'par-loop (funcall items environment))))
      ;; The number of the last one, and its value.
      (setf memory (cons (1- (length items)) nil))
      (loop for item in items
            for index from 0
            do (start-branch body task (iteration-environment environment item tags) index
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

;;;; Some of several

(defstruct (tally (:constructor make-tally (missing left)) (:copier nil))
  "The count of outcomes: how many successes are MISSING and how many branches are LEFT. VALUES and
FAILURES are lists with the newest first."
  (missing 0 :type fixnum)
  (left 0 :type fixnum)
  (values '() :type list)
  (failures '() :type list))

(defun count-outcome (tally how result)
  (decf (tally-left tally))
  (case how
    (:succeeded (decf (tally-missing tally))
     (push result (tally-values tally)))
    (:failed (push result (tally-failures tally)))))

(defun complete-by-tally (task frame tally branches)
  "End the construct where TASK waits at FRAME, if TALLY decides the outcome of BRANCHES branches."
  (cond ((zerop (tally-missing tally))
         (end-with-value task (reverse (tally-values tally))))
        ((> (tally-missing tally) (tally-left tally))
         (end-with-signal
          task
          (failure-of (make-condition 'composite-failure :failures (reverse (tally-failures tally))
                                                         :attempts branches)
                      task frame)))))

(define-construct par-at-least (count &body branches)
  "Run BRANCHES in parallel, in a plan. PAR-AT-LEAST succeeds as soon as COUNT branches have
succeeded, and evaporates the others. The value of PAR-AT-LEAST is the list of the branches' values
in the order in which they came. PAR-AT-LEAST fails with a COMPOSITE-FAILURE as soon as too many
branches have failed. COUNT is an integer from 0 to the number of branches. (Not from CRAM. CRAM's
statecharts of 2026 have a PAR with minimum_success.)"
  (:arguments count)
  (:parts (needed function (value-lambda count scope))
          (branches simple-vector (branches-code branches (single-value-scope scope))))
  (:steps
   (begin
    (let ((count (fluent-value (funcall needed environment))))
      (check-argument par-at-least count (whole-p count 0 (length branches))
                      "an integer from 0 to the number of branches")
      (next over)
      (setf memory (make-tally count (length branches)))
      (if (plusp count)
          (start-branches branches task environment)
          (values (frame-up frame) '()))))
   (over (values (frame-up frame) value)))
  (:child-ended
   (cond ((eq how :escaped) (end-with-signal task result))
         (t (count-outcome memory how result)
            (complete-by-tally task frame memory (length branches))))))
