;;;; valve.lisp -- who owns a resource (manual D).

(in-package :ars-magna.rpl.constructs)

;;; A task claims one or several valves, all at once or none. CLAIMS of a valve are those granted:
;;; the first is its owner's, the others were preempted by the one before, and have LOST it; their
;;; tasks do not run meanwhile. The claims that wait for it queue by priority, by level, then first
;;; in first out; one that wants several can be overtaken by such as can have what they want.
;;; What an owner's own parts ask for they have: it is for the owner to keep them apart.

(defstruct (valve (:include entity) (:constructor %make-valve (name)) (:copier nil))
  "What guarantees that one task at a time has a resource."
  (name nil :read-only t)
  (claims '() :type list)
  (waiting '() :type list))

(defstruct (claim (:constructor make-claim (task valves priority)) (:copier nil))
  "That TASK wants or has VALVES. TAKEN are those that it did not have before, LOST those of them
that have been taken from it."
  (task nil :type task :read-only t)
  (valves '() :type list :read-only t)
  (priority 0 :type real :read-only t)
  (taken '() :type list)
  (lost '() :type list))

;; In a fork whose plans did not lead to it, nobody has it.
(defmethod fresh-twin ((valve valve) realm)
  (declare (ignore realm))
  (%make-valve (valve-name valve)))

(document-functions
  claim-p "True of claims: what tasks that want or have valves wait for, or have in a frame."
  claim-valves "Return the valves that the claim is to.")

(addition make-valve)
(defun make-valve (name)
  "Return a new valve called NAME, that nobody owns."
  (%make-valve name))

(addition valve-p valve-name valve-owner valve-requests valve-losers)
(document-functions
  valve-p "True of valves."
  valve-name "Return the name that the valve was made with.")

(defun valve-owner (valve)
  "Return the task that has VALVE, or NIL."
  (check-argument valve-owner valve (valve-p valve) "a valve, as make-valve returns")
  (let ((claims (valve-claims (here valve))))
    (and claims (claim-task (first claims)))))

(defun valve-requests (valve)
  "Return the tasks that wait for VALVE, the next to have it first."
  (mapcar #'claim-task (valve-waiting (here valve))))

(defun valve-losers (valve)
  "Return the tasks from which VALVE was taken and which are to have it back, the next first."
  (mapcar #'claim-task (rest (valve-claims (here valve)))))

(defun valve-text (valve)
  "Return the name of VALVE as text."
  (one-line (safe-text (valve-name valve) :escape nil)))

(defmethod print-object ((valve valve) stream)
  (print-unreadable-object (valve stream)
    (format stream "valve ~A~@[ of task ~D~]" (valve-text valve)
            (and (valve-owner valve) (task-serial (valve-owner valve))))))

(defmethod awaited-text ((claim claim))
  (format nil "~[~;valve~:;valves~] ~:*~*~{~(~A~)~^, ~}"
          (min 2 (length (claim-valves claim)))
          (mapcar #'valve-text (claim-valves claim))))

;;; Who may have what.

(defun had-p (valve task)
  "True if TASK has VALVE as a part of its owner."
  (let ((owner (valve-owner valve)))
    (and owner (part-of-p task owner))))

(defun available-p (valve claim)
  "True if CLAIM may take VALVE, from its owner if need be: one that evaporates keeps it."
  (let ((owner (first (valve-claims valve))))
    (or (null owner)
        (had-p valve (claim-task claim))
        (and (> (claim-priority claim) (claim-priority owner))
             (not (evaporating-p (claim-task owner)))))))

(defun grantable-p (claim)
  (every (lambda (valve) (available-p valve claim)) (claim-valves claim)))

(defun lose (valve claim)
  "Take VALVE from CLAIM, and keep its task from running."
  (unless (member valve (claim-lost claim))
    (push valve (claim-lost claim))
    (block-task (claim-task claim) t)))

(defun regain (valve claim)
  (when (member valve (claim-lost claim))
    (setf (claim-lost claim) (remove valve (claim-lost claim)))
    (unblock-task (claim-task claim) t)))

(defun grant (claim)
  "Let CLAIM have its valves."
  (dolist (valve (claim-valves claim))
    (unless (had-p valve (claim-task claim))
      (let ((owner (first (valve-claims valve))))
        (when owner (lose valve owner)))
      (push claim (valve-claims valve))
      (push valve (claim-taken claim)))))

;;; Queueing.

(defun before-p (claim other)
  "True if CLAIM goes before OTHER, which came first."
  (or (> (claim-priority claim) (claim-priority other))
      (and (= (claim-priority claim) (claim-priority other))
           (> (task-level (claim-task claim)) (task-level (claim-task other))))))

(defun queue-up (claim)
  (dolist (valve (claim-valves claim))
    (setf (valve-waiting valve)
          (merge 'list (valve-waiting valve) (list claim) #'before-p))))

(defun leave-queues (claim)
  (dolist (valve (claim-valves claim))
    (setf (valve-waiting valve) (remove claim (valve-waiting valve)))))

(defmethod withdraw (task (claim claim))
  (leave-queues claim))

(defun grant-waiting (valve)
  "Grant the claims that wait for VALVE and can be granted, and give it back to who lost it last."
  (dolist (claim (valve-waiting valve))
    (when (grantable-p claim)
      (leave-queues claim)
      (grant claim)
      (wake (claim-task claim) nil)))
  (when (valve-claims valve)
    (regain valve (first (valve-claims valve)))))

(defun give-back (claim)
  "Let CLAIM have nothing any more."
  (leave-queues claim)
  (let ((valves (shiftf (claim-taken claim) '())))
    (dolist (valve valves)
      (setf (valve-claims valve) (remove claim (valve-claims valve)))
      (regain valve claim))
    (mapc #'grant-waiting valves)))

;;; Circles.

(defmethod hinderers ((claim claim))
  (loop for valve in (claim-valves claim)
        unless (available-p valve claim)
          collect (valve-owner valve)))

(defmethod hindrance-text ((claim claim))
  (format nil "the ~A that ~{~A~^ and ~} has" (awaited-text claim)
          (remove-duplicates (mapcar #'task-label (hinderers claim)) :test #'string=)))

(defmethod taken-from (task (claim claim))
  (mapcar #'valve-owner (claim-lost claim)))
