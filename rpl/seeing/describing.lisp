;;;; describing.lisp -- the stack and variables of a task, and DESCRIBE of plan objects.

(in-package :ars-magna.rpl.seeing)

;;; A node has the names of its visible variables (NODE-NAMES), a frame the environment with their
;;; values. Variables without a home package are the compiler's own, and are not shown.

(defun note-task-shown (task)
  (when (task-runner task) (note-plans-shown (runner-client (task-runner task)))))

(addition task-stack)
(defun task-stack (task)
  "Return a list of the expressions that TASK is evaluating, innermost first: one for each call of a
plan in progress. Expressions of the tasks around TASK are left out. Return () when TASK is over."
  (check-argument task-stack task (task-p task) "a task, as begin-plan returns")
  (note-task-shown task)
  (forms-under-way (task-frame task)))

;;; Variables.

(defun environment-chain (environment)
  "Return a list of ENVIRONMENT and the environments around it, innermost first."
  (loop for each = environment then (svref each 0)
        while (plusp (length each)) collect each))

(defun frame-names (frame)
  "Return the names of variables in the environment of FRAME: a list of names for each level."
  (loop for each in (frame-chain frame)
        while (eq (frame-environment each) (frame-environment frame))
        thereis (node-names (frame-node each))))

(defun level-variables (environment names)
  "Return lists (name value) of the variables with NAMES in ENVIRONMENT, a single level. Of
variables with the same name, only the last is included."
  (loop for (name . later) on names
        for index from 1 below (length environment)
        when (and (symbol-package name) (not (member name later)))
          collect (list name (svref environment index))))

(defun visible-levels (frame)
  "Return the variables visible in FRAME, innermost first: lists (environment variable...). Each
variable is a list (name value)."
  (loop for environment in (environment-chain (frame-environment frame))
        for names in (frame-names frame)
        collect (cons environment
                      (remove-if (lambda (variable) (member (first variable) shadowed))
                                 (level-variables environment names)))
        append names into shadowed))

(defun frame-variables (frame)
  "Return the variables visible in FRAME, innermost first: a list of lists (name value)."
  (mapcan #'rest (visible-levels frame)))

;; A debugger shows the calls under way with their arguments; a frame is one.
(defmethod print-object ((frame frame) stream)
  (print-unreadable-object (frame stream :type t)
    (format stream "~:{~A = ~A, ~}~A"
            (loop for (name value) in (frame-variables frame)
                  collect (list (form-text name) (form-text value 30)))
            (form-text (node-form (frame-node frame)) 40))))

(defun visible-variables-by-environment (frames)
  "Return a table from the environments of FRAMES to lists of variables: those that the innermost
frame of an environment sees in this environment. FRAMES begin with the innermost frame."
  (let ((table (make-hash-table :test 'eq)))
    (dolist (frame frames table)
      (loop for (environment . variables) in (visible-levels frame)
            unless (nth-value 1 (gethash environment table))
              do (setf (gethash environment table) variables)))))

(defun stack-entries (task)
  "Return a list of lists (form variable...) for the expressions that TASK is evaluating, innermost
first. Each variable, a list (name value), comes with the outermost expression where it is visible."
  (let ((visible (visible-variables-by-environment (frame-chain (task-frame task))))
        (around (and (task-parent task) (task-frame (task-parent task))))
        (known '())
        (entries '()))
    ;; What it has from the task that it is part of.
    (when around (setf known (environment-chain (frame-environment around))))
    (dolist (frames (reverse (frames-by-expression (task-frame task))) entries)
      (let ((new (set-difference (environment-chain (frame-environment (first frames))) known)))
        (setf known (append new known))
        (push (cons (current-form (frame-node (first frames)) (first frames))
                    (loop for environment in (environment-chain (frame-environment (first frames)))
                          when (member environment new)
                            append (gethash environment visible)))
              entries)))))

(addition task-variables)
(defun task-variables (task)
  "Return the variables of the plan that are visible to TASK: a list of lists (name value),
innermost first, without shadowed variables. Return () when TASK is over."
  (check-argument task-variables task (task-p task) "a task, as begin-plan returns")
  (note-task-shown task)
  (and (task-frame task) (frame-variables (task-frame task))))

;;;; What DESCRIBE tells

(defun write-labelled-lines (stream &rest items)
  "For each name in ITEMS and the text after it, write a line to STREAM unless the text is NIL."
  (loop for (name text) on items by #'cddr
        when text do (format stream "  ~A: ~A~%" name text)))

(defun task-outcome-text (task)
  (case (task-state task)
    (:succeeded (form-text (task-result task) 70))
    (:failed (cut (one-line (failure-text (task-result task))) 200))))

(defmethod describe-object ((task task) stream)
  (format stream "~A~%" (form-text task 100))
  (write-labelled-lines stream
                        "State" (task-state-text task)
                        "Part of" (and (task-parent task) (form-text (task-parent task) 70))
                        "Path" (format nil "~{~A~^ > ~}" (task-path task))
                        "Level" (and (plusp (task-level task)) (task-level task))
                        "Waits for" (and (task-awaits task)
                                         (format nil "~A, since tick ~D" (task-awaits task)
                                                 (task-since task)))
                        "Result" (task-outcome-text task))
  (unless (task-over-p task)
    (format stream "  Stack:~%")
    (write-stack task 4 stream)
    (when (task-children task)
      (format stream "  Parts:~%")
      (dolist (child (task-children task)) (write-task-tree child 2 stream))))
  (dolist (valve (valves-of-task task))
    (format stream "  ")
    (write-valve valve stream)))

(defmethod describe-object ((fluent fluent) stream)
  (format stream "~A~%" (form-text fluent 100))
  (let ((sources (remove fluent (base-fluents fluent)))
        (clients (loop for client in (fluent-watchers fluent)
                       when (task-p client) collect (form-text client 70))))
    (write-labelled-lines stream
                          "Name" (form-text (fluent-name fluent))
                          "Value" (handler-case (form-text (fluent-value fluent) 70)
                                    (error (condition)
                                      (format nil "error: ~A" (printable-report condition))))
                          "Computed from" (and sources
                                               (format nil "~{~A~^, ~}"
                                                       (mapcar #'form-text sources)))
                          "Waited for by" (and clients (format nil "~{~A~^, ~}" clients)))))

(defmethod describe-object ((valve valve) stream)
  (format stream "~A~%" (form-text valve 100))
  (write-labelled-lines stream
                        "Owner" (if (valve-owner valve) (form-text (valve-owner valve) 70) "nobody")
                        "Queue" (and (valve-requests valve)
                                     (format nil "~{~A~^, ~}"
                                             (loop for task in (valve-requests valve)
                                                   collect (form-text task 70))))))

(defmethod describe-object ((procedure procedure) stream)
  (format stream "~A~%" (form-text procedure 100))
  (let ((name (procedure-name procedure)))
    (write-labelled-lines stream
                          "Called as" (format nil "(~A~{ ~A~})"
                                              (if name (form-text name) "call-plan ...")
                                              (mapcar #'form-text
                                                      (procedure-lambda-list procedure)))
                          "Defined" (if (procedure-body procedure) nil "not yet, or no longer")
                          "Documentation" (and name (documentation name 'function))
                          "Body" (and (procedure-body procedure)
                                      (form-text (node-form (procedure-body procedure)) 200)))))
