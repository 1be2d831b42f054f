;;;; ordering.lisp -- partial-order and plan: side by side, but some after others.

(in-package :ars-magna.rpl.constructs)

;;; BEFORE holds for each branch the indices of those that must be over before it starts.
;;; DATA is a vector of :idle, :begun and :over.

(define-node ordered ((branches simple-vector) (before simple-vector))
  "All of BRANCHES, none before those are over that BEFORE names for it."
  :step step-ordered :child-ended ordered-part-over)

(defun startable-p (index before states)
  (and (eq :idle (svref states index))
       (every (lambda (other) (eq :over (svref states other))) (svref before index))))

(defun start-possible (node task frame)
  "Start all branches of NODE that may start now."
  (let ((states (frame-data frame)))
    (dotimes (index (length states))
      (when (startable-p index (ordered-before node) states)
        (setf (svref states index) :begun)
        (start-branch (svref (ordered-branches node) index) task (frame-environment frame)
                      index (task-level task))))))

(defun step-ordered (node task frame value)
  (let ((count (length (ordered-branches node))))
    (cond ((or (zerop count) (plusp (frame-counter frame))) (values (frame-up frame) value))
          (t (setf (frame-counter frame) 1
                   (frame-data frame) (make-array count :initial-element :idle))
             (start-possible node task frame)
             (park task nil)
             +parked+))))

(defun ordered-part-over (node task frame child how result)
  (unless (fail-or-escape task how result)
    (setf (svref (frame-data frame) (task-index child)) :over)
    (start-possible node task frame)
    (complete-when-alone task nil)))

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

(defun ordered-code (form steps constraints scope)
  (let ((before (predecessors steps (constraint-list constraints) form)))
    (check-orderable before form)
    (with-tags-code form (tags-in steps) scope
                    (lambda (scope)
                      `(make-ordered :form ',form
                                     :branches ,(branches-code steps scope)
                                     :before ,before)))))

(addition partial-order)
(defmacro partial-order (steps &body constraints)
  "Run STEPS in a plan side by side, as PAR, under CONSTRAINTS: by (:order a b) the step tagged b
does not start before the one tagged a is over. Steps are tagged by (:tag name form)."
  (misplaced 'partial-order (list* steps constraints)))

(addition plan)
(defmacro plan (steps &rest constraints)
  "Do as PARTIAL-ORDER; CONSTRAINTS may also be one list of them, and give reasons after the names."
  (misplaced 'plan (list* steps constraints)))

(define-plan-form "PARTIAL-ORDER" :must (steps &rest constraints) (form scope)
  (ordered-code form steps constraints scope))

(define-plan-form "PLAN" :must (steps &rest constraints) (form scope)
  (ordered-code form steps constraints scope))
