;;;; valve.lisp -- valves: the owner of a resource, and the tasks that wait for it (manual D).

(in-package :ars-magna.rpl.constructs)

(export '(claim-p valve))

;;; A task claims one or several valves, all at once or none. CLAIMS of a valve are those granted,
;;; the newest first. A part of a task that owns a valve may own it as well, one part at a time. So
;;; the OWNER-CLAIMS of a valve are its owner's claim, the first one, and those of tasks around it;
;;; between them may be claims that parts have lost to parts. Any other claim was preempted: it has
;;; LOST the valve, and its task is suspended. OUTER leads from a claim to the claims of tasks
;;; around its own that owned the valve when it was granted: they return it only after this claim.
;;;
;;; Waiting claims queue by priority, then level, then order of arrival, in a LINE for each
;;; priority and level. A claim to several valves can be overtaken by claims that can be granted.
;;; The time to enter or leave a queue, and to find the next claim, does not depend on the length
;;; of a line; it grows with the logarithm of the number of lines.

(addition valve-p)
(define-record (valve (:include entity) (:constructor %make-valve (name)))
  "A valve, which guarantees that one task at a time owns a resource."
  (name nil t "the name that the valve was made with" :addition)
  (claims '() list :writable)
  (lines nil t "a tree of the lines of claims that wait for the valve" :writable)
  (count 0 fixnum "how many lines the valve has had so far" :writable))

(define-record (claim (:constructor make-claim (task valves priority)))
  "The request of TASK to own VALVES. TASK waits for its claim, or a frame of TASK holds the claim."
  (task nil task)
  (valves '() list "the valves that the claim requests" :export)
  (priority 0 real)
  (taken '() list "the valves that the claim has got" :writable)
  (lost '() list "the valves that the claim has got and that another claim has taken" :writable)
  (outer '() list "conses (valve . claim): a valve that this claim has got, and the owner claim
around this one" :writable)
  (turns '() list "the turns of a waiting claim in the lines of its valves" :writable))

(defstruct (line (:constructor make-line (valve priority level)) (:copier nil))
  "The queue of claims to VALVE with one PRIORITY, by tasks of one LEVEL, in order of arrival. A
line is also a node of a tree: AHEAD and BEHIND are its subtrees, whose lines have less WEIGHT."
  (ahead nil :type (or null line))
  (behind nil :type (or null line))
  (weight 0 :type (unsigned-byte 32))
  (valve nil :type valve :read-only t)
  (priority 0 :type real :read-only t)
  (level 0 :type fixnum :read-only t)
  (first-turn nil)
  (last-turn nil))

(defstruct (turn (:constructor make-turn (claim line)) (:copier nil))
  "The place of CLAIM in LINE."
  (claim nil :type claim :read-only t)
  (line nil :type line :read-only t)
  (previous nil :type (or null turn))
  (next nil :type (or null turn)))
(declaim-final line turn)

(define-linked-list turn turn-line :in line :join join-line :leave leave-line)

;; In a fork whose plans do not refer to it, it is free.
(defmethod fresh-twin ((valve valve) realm)
  (declare (ignore realm))
  (%make-valve (valve-name valve)))

(addition make-valve)
(defun make-valve (name)
  "Return a new valve with the name NAME and without an owner."
  (%make-valve name))

(addition valve-owner)
(defun valve-owner (valve)
  "Return the task that owns VALVE, or its part that took VALVE last. Return NIL if VALVE is free."
  (check-argument valve-owner valve (valve-p valve) "a valve, as make-valve returns")
  (let ((claims (valve-claims (entity-here valve))))
    (and claims (claim-task (first claims)))))

(addition valve-requests)
(defun valve-requests (valve)
  "Return the tasks that wait for VALVE, in the order in which they will get it."
  (let ((tasks '()))
    (some-line (lambda (line)
                 (loop for turn = (line-first-turn line) then (turn-next turn)
                       while turn do (push (claim-task (turn-claim turn)) tasks)))
               (valve-lines (entity-here valve)))
    (nreverse tasks)))

(defun some-line (function tree)
  "Return the first true value that FUNCTION returns for a line of TREE, from the front; or NIL."
  (and tree
       (or (some-line function (line-ahead tree))
           (funcall function tree)
           (some-line function (line-behind tree)))))

(defun owner-claims (valve)
  (loop for claim = (first (valve-claims valve)) then (cdr (assoc valve (claim-outer claim)))
        while claim
        when (member valve (claim-taken claim) :test #'eq) collect claim))

(addition valve-losers)
(defun valve-losers (valve)
  "Return the tasks that lost VALVE and will get it back, the next one first."
  (let* ((valve (entity-here valve)) (owner-claims (owner-claims valve)))
    (mapcar #'claim-task
            (remove-if (lambda (claim) (member claim owner-claims)) (valve-claims valve)))))

(defun valve-text (valve)
  (one-line (safe-text (valve-name valve) :escape nil)))

(defmethod print-object ((valve valve) stream)
  (print-unreadable-object (valve stream)
    (format stream "valve ~A~@[ of task ~D~]" (valve-text valve)
            (and (valve-owner valve) (task-serial (valve-owner valve))))))

(defmethod awaited-text ((claim claim))
  (format nil "~[~;valve~:;valves~] ~:*~*~{~(~A~)~^, ~}"
          (min 2 (length (claim-valves claim)))
          (mapcar #'valve-text (claim-valves claim))))

;;; Granting.

(defun rivals (valve task)
  (remove-if (lambda (claim) (part-of-p task (claim-task claim))) (owner-claims valve)))

(defun may-preempt-p (claim rival)
  "True if CLAIM may take the valves that RIVAL owns. A rival that evaporates keeps its valves."
  (and (> (claim-priority claim) (claim-priority rival))
       (not (evaporating-p (claim-task rival)))))

;; A task that is suspended as it has lost a valve takes none: perhaps from the one that has it.
(defun available-p (valve claim)
  "True if CLAIM may take VALVE, from its rivals if necessary."
  (let ((rivals (rivals valve (claim-task claim))))
    (or (null rivals)
        (and (every (lambda (rival) (may-preempt-p claim rival)) rivals)
             (null (all-preemptors (claim-task claim)))))))

(defun grantable-p (claim)
  (every (lambda (valve) (available-p valve claim)) (claim-valves claim)))

(defun lose-valve (valve claim)
  (when (and (member valve (claim-taken claim)) (not (member valve (claim-lost claim))))
    (push valve (claim-lost claim))
    (block-task (claim-task claim) t)))

(defun take-valve (valve claim)
  "Grant VALVE to CLAIM. Return (VALVE rival) for each claim that loses VALVE, outermost first."
  (let* ((owner-claims (owner-claims valve))
         (rivals (rivals valve (claim-task claim)))
         (outer (find-if-not (lambda (claim) (member claim rivals :test #'eq)) owner-claims)))
    (when outer (push (cons valve outer) (claim-outer claim)))
    (push claim (valve-claims valve))
    (push valve (claim-taken claim))
    (mapcar (lambda (rival) (list valve rival)) (reverse rivals))))

;; What a rival does about it may give valves back: those that CLAIM has already by then.
(defun grant-claim (claim)
  (loop for (valve rival) in (mapcan (lambda (valve) (take-valve valve claim)) (claim-valves claim))
        do (lose-valve valve rival)))

;;; Queueing.

(defun line-before-p (line other)
  (or (> (line-priority line) (line-priority other))
      (and (= (line-priority line) (line-priority other))
           (> (line-level line) (line-level other)))))

;;; The lines of a valve are a treap: a tree in which each line has more weight than those below it.
;;; Weights are pseudo-random, so that it is hardly ever deep.

(defun split-line-tree (tree line)
  "Return two trees: the lines of TREE that go before LINE, and the other lines of TREE."
  (cond ((null tree) (values nil nil))
        ((line-before-p tree line)
         (multiple-value-bind (ahead behind) (split-line-tree (line-behind tree) line)
           (setf (line-behind tree) ahead)
           (values tree behind)))
        (t (multiple-value-bind (ahead behind) (split-line-tree (line-ahead tree) line)
             (setf (line-ahead tree) behind)
             (values ahead tree)))))

(defun join-line-trees (ahead behind)
  "Return one tree of the lines of AHEAD and, after those, the lines of BEHIND."
  (cond ((null ahead) behind)
        ((null behind) ahead)
        ((> (line-weight ahead) (line-weight behind))
         (setf (line-behind ahead) (join-line-trees (line-behind ahead) behind))
         ahead)
        (t (setf (line-ahead behind) (join-line-trees ahead (line-ahead behind)))
           behind)))

(defun without-line (tree line)
  (cond ((eq tree line) (join-line-trees (line-ahead line) (line-behind line)))
        ((line-before-p line tree)
         (setf (line-ahead tree) (without-line (line-ahead tree) line))
         tree)
        (t (setf (line-behind tree) (without-line (line-behind tree) line))
           tree)))

(defun find-line (line tree)
  (loop while tree
        do (cond ((line-before-p line tree) (setf tree (line-ahead tree)))
                 ((line-before-p tree line) (setf tree (line-behind tree)))
                 (t (return tree)))))

(defun ensure-line (claim valve)
  (let ((line (make-line valve (claim-priority claim) (task-level (claim-task claim)))))
    (or (find-line line (valve-lines valve))
        (multiple-value-bind (ahead behind) (split-line-tree (valve-lines valve) line)
          ;; As different from the last weight as can be.
          (setf (line-weight line) (ldb (byte 32 0) (* 2654435769 (incf (valve-count valve))))
                (valve-lines valve) (join-line-trees (join-line-trees ahead line) behind))
          line))))

(defun queue-up (claim)
  (dolist (valve (claim-valves claim))
    (let ((turn (make-turn claim (ensure-line claim valve))))
      (join-line turn)
      (push turn (claim-turns claim)))))

(defun leave-queues (claim)
  (dolist (turn (shiftf (claim-turns claim) '()))
    (leave-line turn)
    (let ((line (turn-line turn)))
      (unless (line-first-turn line)
        (let ((valve (line-valve line)))
          (setf (valve-lines valve) (without-line (valve-lines valve) line)))))))

(defmethod remove-waiting-task (task (claim claim))
  (leave-queues claim))

(defun next-in-line (line)
  (loop for turn = (line-first-turn line) then (turn-next turn)
        while turn
        when (grantable-p (turn-claim turn)) return (turn-claim turn)))

(defun grant-queued-claim (claim)
  (leave-queues claim)
  (grant-claim claim)
  (when (eq claim (task-awaiting (claim-task claim))) (wake (claim-task claim) nil)))

(defun grant-queued-claims (task)
  "TASK has just got back a valve. Grant the waiting claims of TASK and its parts, where possible."
  (let ((awaited (task-awaiting task)))
    (when (and (claim-p awaited) (grantable-p awaited)) (grant-queued-claim awaited)))
  (mapc #'grant-queued-claims (task-children task)))

(defun regain-valve (valve claim)
  (when (member valve (claim-lost claim))
    (setf (claim-lost claim) (remove valve (claim-lost claim)))
    (unblock-task (claim-task claim) t)
    (unless (claim-lost claim) (grant-queued-claims (claim-task claim)))))

;; The new owner has no parts yet, and at least the priority of those in line: no other can have it.
(defun grant-released-valve (valve)
  "Grant the first grantable claim waiting for VALVE. Then give VALVE back to losers, if possible."
  (let ((claim (some-line #'next-in-line (valve-lines valve))))
    (when claim (grant-queued-claim claim)))
  (dolist (claim (owner-claims valve))
    (regain-valve valve claim)))

(defun without-claim (claims claim)
  (if (eq claim (first claims)) (rest claims) (remove claim claims)))

(defun release-valves (claim)
  (leave-queues claim)
  (let ((valves (shiftf (claim-taken claim) '())))
    (dolist (valve valves)
      (setf (valve-claims valve) (without-claim (valve-claims valve) claim))
      (regain-valve valve claim))
    ;; A claim that is granted one of them may have got others with it, which are taken then.
    (loop for valve in valves
          for owner in (mapcar (lambda (valve) (first (valve-claims valve))) valves)
          when (eq owner (first (valve-claims valve)))
            do (grant-released-valve valve))))

;;; Circles.

(defun outermost-rival (valve task)
  "Return the task that must end or release VALVE before TASK can own VALVE; or NIL."
  (let ((rival (first (last (rivals valve task)))))
    (and rival (claim-task rival))))

(defmethod tasks-awaited ((claim claim))
  (loop for valve in (claim-valves claim)
        unless (available-p valve claim)
          collect (outermost-rival valve (claim-task claim))))

(defmethod stuck-wait-text ((claim claim))
  (let ((names (remove-duplicates (mapcar #'task-label (tasks-awaited claim)) :test #'string=)))
    (format nil "the ~A that ~{~A~^ and ~} ~:[has~;have~]" (awaited-text claim) names
            (rest names))))

(defmethod preemptors (task (claim claim))
  (remove nil (mapcar (lambda (valve) (outermost-rival valve (claim-task claim)))
                      (claim-lost claim))))
