;;;; ordering.lisp -- partial-order and plan: side by side, but some after others.

(in-package :ars-magna.rpl.constructs)

(defun startable-p (index before states)
  "True if branch INDEX is still :idle in STATES, and those that BEFORE names for it are :over."
  (and (eq :idle (svref states index))
       (every (lambda (other) (eq :over (svref states other))) (svref before index))))

(defun start-possible (branches before states task environment)
  "Start as parts of TASK those of BRANCHES that may start now."
  (dotimes (index (length branches))
    (when (startable-p index before states)
      (setf (svref states index) :begun)
      (start-branch (svref branches index) task environment index (task-level task)))))

;;; Reading the constraints.

(defun step-name (step)
  (and (typep step '(cons (eql :tag) (cons symbol t)))
       (second step)))

(defun constraint-list (constraints)
  "Return CONSTRAINTS, (:order a b) forms or lists of such, as one list."
  (loop for constraint in constraints
        if (and (consp constraint) (consp (first constraint)))
          append constraint
        else collect constraint))

(defun step-index (name steps form)
  (or (position name steps :key #'step-name)
      (reject-clause "plan" form (format nil "in :order only tags of the steps, not ~(~A~)" name))))

(defun predecessors (steps constraints form)
  "Return for each of STEPS a list of the indices of those that CONSTRAINTS put before it."
  (let ((before (make-array (length steps) :initial-element '())))
    (dolist (constraint constraints before)
      (unless (typep constraint '(cons (eql :order) (cons t (cons t t))))
        (reject-clause "plan" constraint "(:order earlier later)"))
      (destructuring-bind (earlier later &rest reason) (rest constraint)
        (declare (ignore reason))
        (pushnew (step-index earlier steps form)
                 (svref before (step-index later steps form)))))))

(defun check-orderable (before form)
  "Signal MALFORMED-DEFINITION if BEFORE can never be satisfied."
  (loop with waiting = (loop for i below (length before) collect i)
        for startable = (remove-if (lambda (i) (intersection (svref before i) waiting)) waiting)
        while startable
        do (setf waiting (set-difference waiting startable))
        finally (when waiting
                  (reject-clause "plan" form
                                 "constraints without a circle: some steps could never start"))))

(defun checked-predecessors (steps constraints form)
  "Do as PREDECESSORS. Signal MALFORMED-DEFINITION if they can never be satisfied."
  (let ((before (predecessors steps (constraint-list constraints) form)))
    (check-orderable before form)
    before))

(define-construct partial-order (steps &body constraints)
  "Run STEPS in a plan side by side, as PAR, under CONSTRAINTS: by (:order a b) the step tagged b
does not start before the one tagged a is over. Steps are tagged by (:tag name form)."
  (:parts (branches simple-vector (branches-code steps scope))
          ;; For each branch, the indices of those that must be over before it starts.
          (before simple-vector (checked-predecessors steps constraints form)))
  (:code (with-tags-code form (tags-in steps) scope #'build))
  (:steps
   (begin
    (next inside)
    (setf memory (make-array (length branches) :initial-element :idle))
    (start-possible branches before memory task environment)
    (if (plusp (length branches))
        (await-parts task)
        (values (frame-up frame) nil)))
   (inside (values (frame-up frame) value)))
  (:child-ended
   (unless (fail-or-escape task how result)
     (setf (svref memory (task-index child)) :over)
     (start-possible branches before memory task environment)
     (complete-when-alone task nil))))

(define-construct plan (steps &body constraints)
  "Do as PARTIAL-ORDER; CONSTRAINTS may also be one list of them, and give reasons after the names."
  (:like partial-order))
