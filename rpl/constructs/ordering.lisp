;;;; ordering.lisp -- waiting for the end of other tasks: join-task, partial-order and plan.

(in-package :ars-magna.rpl.constructs)

(defun over-status-p (status)
  (and (member status '(:succeeded :failed :evaporated)) t))

(defun continue-with-outcome (target task frame)
  (let ((result (task-result target)))
    (cond ((eq :failed (task-state target)) (unwind task (frame-up frame) result))
          (t (values (frame-up frame)
                     (and (eq :succeeded (task-state target)) (not (escape-p result)) result))))))

(defstruct (joining (:constructor make-joining (target watcher)) (:copier nil))
  "The wait of a task for the end of TARGET. WATCHER watches the status of TARGET."
  (target nil :type task :read-only t)
  (watcher nil :type watcher :read-only t))

(defmethod awaited-text ((joining joining))
  (format nil "the end of ~A" (task-label (joining-target joining))))

(defmethod remove-waiting-task (task (joining joining))
  (unwatch (joining-watcher joining)))

(defmethod tasks-awaited ((joining joining))
  (let ((target (joining-target joining)))
    (and (under-way-p target) (list target))))

(defun end-join (watcher value trouble)
  (declare (ignore value trouble))
  (unwatch watcher)
  (wake (watcher-client watcher) nil))

(defun await-end (target task)
  (let ((watcher (make-watcher (fl-funcall 'over-status-p (task-status target)) #'end-join task)))
    (watch watcher)
    (park task (make-joining target watcher))
    (report-wait-cycle task)))

(define-construct join-task (task)
  "Wait in a plan until TASK is over. Return the value of TASK, or fail as TASK failed. Return NIL
if TASK evaporated or was left by a non-local exit (from CRAM, except for NIL)."
  (:arguments task)
  (:parts (target function (value-lambda task scope)))
  (:steps
   (begin
    (let ((target (checked-target (funcall target environment) task 'join-task "wait for")))
      (cond ((task-over-p target) (continue-with-outcome target task frame))
            (t (next over)
               (setf memory target)
               (await-end target task)
               +parked+))))
   (over (continue-with-outcome memory task frame))))

;;; All steps are started, but what comes later in an order has a gate, which is closed until what
;;; comes earlier is over. The orders hold as long as the construct runs; then they are lifted.

(defstruct (order (:constructor make-order (earlier later)) (:copier nil))
  "The constraint that the task LATER starts only when the task EARLIER is over, or when the fluent
EARLIER is true. WATCHER waits for EARLIER."
  (earlier nil :type (or task fluent) :read-only t)
  (later nil :type task :read-only t)
  (watcher nil :type (or null watcher)))

(defmethod awaited-text ((order order))
  (let ((earlier (order-earlier order)))
    (if (task-p earlier)
        (format nil "the end of ~A" (task-label earlier))
        (awaited-text earlier))))

(defmethod tasks-awaited ((gate gate))
  (let ((tasks (mapcar #'order-earlier (gate-holds gate))))
    (and (every (lambda (task) (and (task-p task) (under-way-p task))) tasks)
         tasks)))

(defun remove-order (order)
  (when (order-watcher order)
    (unwatch (shiftf (order-watcher order) nil))
    (release-hold (order-later order) order)))

(defun note-earlier-end (watcher value trouble)
  (declare (ignore value))
  (destructuring-bind (order . task) (watcher-client watcher)
    (cond ((null trouble) (remove-order order))
          ((null (task-signal task))
           (end-with-signal task (failure-of trouble task (task-frame task)))))))

(defun order-fluent (order)
  "Return the fluent that becomes true when ORDER allows its later task to start."
  (let ((earlier (order-earlier order)))
    (if (task-p earlier)
        (fl-funcall 'over-status-p (task-status earlier))
        earlier)))

(defun enforce-order (order task)
  (let ((fluent (order-fluent order)))
    (unless (fluent-value fluent)
      (add-hold (order-later order) order)
      (setf (order-watcher order) (make-watcher fluent #'note-earlier-end (cons order task)))
      (watch (order-watcher order)))))

(defun checked-orders (pairs task)
  "Return an order of TASK for each of PAIRS (earlier . later). Signals WRONG-ARGUMENT and MISUSE."
  (loop for (earlier . later) in pairs
        do (check-argument partial-order earlier (or (task-p earlier) (fluent-p earlier))
                           "a task, such as the name of a :tag, or a fluent")
           (check-argument partial-order later (task-p later)
                           "a task, such as the name of a :tag")
           (when (task-p earlier) (check-same-runner task earlier))
           (check-same-runner task later)
        collect (make-order (if (fluent-p earlier) (entity-here earlier) earlier) later)))

;;; Reading the constraints.

(defun constraint-list (constraints)
  "Return a list of all (:order a b) forms in CONSTRAINTS, or in a list in CONSTRAINTS."
  (loop for constraint in constraints
        if (and (consp constraint) (consp (first constraint)))
          append constraint
        else collect constraint))

(defun check-order-tag (form name steps scope)
  "Signal MALFORMED-DEFINITION if the symbol NAME, in an :order of FORM, names no tag or variable."
  (unless (or (consp name)
              (member name (tags-in steps))
              (and (symbolp name)
                   (not (constantp name))
                   (known-variable-p name (scope-environment scope))))
    (reject-clause (text-title) form
                   (format nil "tags in :order that are in scope, not ~(~S~)" (abridged name)))))

(defun read-orders (steps constraints form scope)
  (loop for constraint in (constraint-list constraints)
        do (unless (typep constraint '(cons (eql :order) (cons t (cons t t))))
             (reject-clause (text-title) constraint "(:order earlier later)"))
           (check-order-tag form (second constraint) steps scope)
           (check-order-tag form (third constraint) steps scope)
        collect (list (second constraint) (third constraint))))

;;; Circles. A task starts before it ends, an order lets one end before another starts, and what is
;;; tagged within a tagged form starts and ends within that.

(defun nested-tags (forms)
  "Return a list of (outer inner): the pairs of tag names in FORMS where inner is inside outer."
  (loop for form in forms
        append (cond ((atom form) '())
                     ((and (eq (first form) :tag) (typep (rest form) '(cons symbol t)))
                      (append (loop for inner in (tags-in (cddr form))
                                    collect (list (second form) inner))
                              (nested-tags (cddr form))))
                     ((null (tags-in (list form))) '())
                     (t (nested-tags (loop for tail = form then (cdr tail)
                                           while (consp tail) collect (car tail)))))))

(defun precedences (orders nestings)
  "Return a list of pairs (earlier later) of events, each (:start name) or (:end name)."
  (append (loop for name in (remove-duplicates (mapcan #'copy-list (append orders nestings)))
                collect (list (list :start name) (list :end name)))
          (loop for (earlier later) in orders
                collect (list (list :end earlier) (list :start later)))
          (loop for (outer inner) in nestings
                collect (list (list :start outer) (list :start inner))
                collect (list (list :end inner) (list :end outer)))))

(defun circular-p (precedences)
  (loop for open = (remove-if-not (lambda (pair)
                                    (find (first pair) precedences :key #'second :test #'equal))
                                  precedences)
        while precedences
        do (when (= (length open) (length precedences)) (return t))
           (setf precedences open)))

(defun check-orders (orders steps form)
  (when (circular-p (precedences (remove-if-not (lambda (order) (every #'symbolp order)) orders)
                                 (nested-tags steps)))
    (reject-clause (text-title) form "constraints without a cycle: some steps could never start")))

(defun orders-lambda (steps constraints form scope)
  (let ((orders (read-orders steps constraints form scope)))
    (check-orders orders steps form)
    (value-lambda `(list ,@(loop for (earlier later) in orders
                                 collect `(cons ,earlier ,later)))
                  scope)))

;;; The constructs. MEMORY is the value of the last step, and the orders.

;; The variables around it show in stacks; the tasks of its tags show as its parts.
(defun named-order-code (code inner scope)
  "Return CODE, whose node runs in the scope INNER, so that its node has the names of SCOPE."
  `(set-node-names ,code ',(if (eq inner scope)
                               (names-by-level scope)
                               (cons '() (names-by-level scope)))))

(defun end-orders (memory)
  (when memory (mapc #'remove-order (shiftf (cdr memory) '()))))

(define-construct partial-order (steps &body constraints)
  "Run STEPS in parallel, in a plan, as PAR does, under CONSTRAINTS. With the constraint (:order a
b), the task b starts only after the task a has ended in any way. Each of a and b is the name of a
tag, (:tag name form), in STEPS or around PARTIAL-ORDER, or a form whose value is a task. If a is a
fluent, b starts when the fluent is true, or has been pulsed since PARTIAL-ORDER began.
The constraints hold until PARTIAL-ORDER ends. A task that has started already cannot be b. Cycles
of the tags in STEPS are errors when the plan is defined; other cycles are reported as a deadlock.
Return the first value of the last step (from CRAM, except for the value)."
  (:parts (branches simple-vector (branches-code steps (single-value-scope scope)))
          (pairs function (orders-lambda steps constraints form scope)))
  (:code (with-tags-code form (tags-in steps) scope
                         (lambda (inner) (named-order-code (build inner) inner scope))))
  (:steps
   (begin
    (next over)
    (let ((orders (checked-orders (funcall pairs environment) task)))
      (setf memory (cons nil orders))
      (dolist (order orders) (enforce-order order task))
      (cond ((plusp (length branches)) (start-branches branches task environment))
            (t (end-orders memory)
               (values (frame-up frame) nil)))))
   (over
    (end-orders memory)
    (values (frame-up frame) value)))
  (:unwind
   (end-orders memory)
   nil)
  (:child-ended
   (unless (fail-or-escape task how result)
     (when (= (1+ (task-index child)) (length branches))
       (setf (car memory) result))
     (complete-when-alone task (car memory)))))

(define-construct plan (steps &body constraints)
  "Do as PARTIAL-ORDER. CONSTRAINTS may also be a single list of constraints, and a constraint may
have a reason after its names (from BMT)."
  (:like partial-order))
