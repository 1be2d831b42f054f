;;;; describing.lisp -- what DESCRIBE tells of tasks, fluents, valves and plan procedures.

(in-package :ars-magna.rpl.seeing)

(defun write-lines (stream &rest items)
  "Write to STREAM each of ITEMS, alternating a name and a text, on a line; none whose text is NIL."
  (loop for (name text) on items by #'cddr
        when text do (format stream "  ~A: ~A~%" name text)))

(defun head (object stream)
  (format stream "~A~%" (form-text object 100)))

(defun outcome-text (task)
  (case (task-state task)
    (:succeeded (form-text (task-result task) 70))
    (:failed (cut (one-line (failure-text (task-result task))) 200))))

(defmethod describe-object ((task task) stream)
  (head task stream)
  (write-lines stream
               "State" (task-state-text task)
               "Part of" (and (task-parent task) (form-text (task-parent task) 70))
               "Path" (format nil "~{~A~^ > ~}" (task-path task))
               "Level" (and (plusp (task-level task)) (task-level task))
               "Waits for" (and (task-awaits task)
                                (format nil "~A, since tick ~D" (task-awaits task)
                                        (task-since task)))
               "Result" (outcome-text task))
  (unless (task-over-p task)
    (format stream "  Stack:~%")
    (write-stack task 4 stream)
    (when (task-children task)
      (format stream "  Parts:~%")
      (dolist (child (task-children task)) (write-task-tree child 2 stream))))
  (dolist (valve (valves-of task))
    (format stream "  ")
    (write-valve valve stream)))

(defmethod describe-object ((fluent fluent) stream)
  (head fluent stream)
  (let ((sources (remove fluent (base-fluents fluent)))
        (clients (loop for client in (fluent-watchers fluent)
                       when (task-p client) collect (form-text client 70))))
    (write-lines stream
                 "Name" (form-text (fluent-name fluent))
                 "Value" (handler-case (form-text (fluent-value fluent) 70)
                           (error (condition) (format nil "error: ~A" (own-text condition))))
                 "Computed from" (and sources
                                      (format nil "~{~A~^, ~}" (mapcar #'form-text sources)))
                 "Waited for by" (and clients (format nil "~{~A~^, ~}" clients)))))

(defmethod describe-object ((valve valve) stream)
  (head valve stream)
  (write-lines stream
               "Owner" (if (valve-owner valve) (form-text (valve-owner valve) 70) "nobody")
               "Queue" (and (valve-requests valve)
                            (format nil "~{~A~^, ~}"
                                    (loop for task in (valve-requests valve)
                                          collect (form-text task 70))))))

(defmethod describe-object ((procedure procedure) stream)
  (head procedure stream)
  (let ((name (procedure-name procedure)))
    (write-lines stream
                 "Called as" (format nil "(~A~{ ~A~})" (if name (form-text name) "call-plan ...")
                                     (mapcar #'form-text (procedure-lambda-list procedure)))
                 "Defined" (if (procedure-body procedure) nil "not yet, or no longer")
                 "Documentation" (and name (documentation name 'function))
                 "Body" (and (procedure-body procedure)
                             (form-text (node-form (procedure-body procedure)) 200)))))
