;;;; variables.lisp -- the stack of a task, and its variables by name.

(in-package :ars-magna.rpl.seeing)

;;; A node knows the names of the variables that it sees (NODE-NAMES), a frame has the environment
;;; with their values. Variables without a home package are the compiler's own, and are not shown.

(defun note-task-seen (task)
  (when (task-runner task) (note-seen (runner-client (task-runner task)))))

(addition task-stack)
(defun task-stack (task)
  "Return the expressions that TASK is at, as lists, innermost first: only its own, not those of the
tasks that it is part of. Each call of a plan has one of its own. () when it is over."
  (check-argument task-stack task (task-p task) "a task, as begin-plan returns")
  (note-task-seen task)
  (forms-under-way (task-frame task)))

;;; Variables.

(defun environments (environment)
  "Return ENVIRONMENT and those around it, innermost first."
  (loop for each = environment then (svref each 0)
        while (plusp (length each)) collect each))

(defun frame-names (frame)
  "Return the names for the environment of FRAME: a list for each level."
  (loop for each in (frame-chain frame)
        while (eq (frame-environment each) (frame-environment frame))
        thereis (node-names (frame-node each))))

(defun level-variables (environment names)
  "Return the variables of one level, a list of lists (name value). Of those called the same, as by
LET*, the last is in force."
  (loop for (name . later) on names
        for index from 1 below (length environment)
        when (and (symbol-package name) (not (member name later)))
          collect (list name (svref environment index))))

(defun visible-levels (frame)
  "Return what FRAME sees, innermost first: lists (environment variable...), each variable a list
(name value)."
  (loop for environment in (environments (frame-environment frame))
        for names in (frame-names frame)
        collect (cons environment
                      (remove-if (lambda (variable) (member (first variable) shadowed))
                                 (level-variables environment names)))
        append names into shadowed))

(defun frame-variables (frame)
  "Return the variables that FRAME sees, innermost first: a list of lists (name value)."
  (mapcan #'rest (visible-levels frame)))

;; A debugger shows the calls under way with their arguments; a frame is one.
(defmethod print-object ((frame frame) stream)
  (print-unreadable-object (frame stream :type t)
    (format stream "~:{~A = ~A, ~}~A"
            (loop for (name value) in (frame-variables frame)
                  collect (list (form-text name) (form-text value 30)))
            (form-text (node-form (frame-node frame)) 40))))

(defun visible-variables (frames)
  "Return a table: for each environment of FRAMES, the innermost first, the variables in it that are
in force where the innermost frame is that sees it."
  (let ((table (make-hash-table :test 'eq)))
    (dolist (frame frames table)
      (loop for (environment . variables) in (visible-levels frame)
            unless (nth-value 1 (gethash environment table))
              do (setf (gethash environment table) variables)))))

(defun stack-entries (task)
  "Return what TASK is at, innermost first: a list of lists (form variable...), each variable, a
list (name value), with the outermost expression that sees it."
  (let ((visible (visible-variables (frame-chain (task-frame task))))
        (around (and (task-parent task) (task-frame (task-parent task))))
        (known '())
        (entries '()))
    ;; What it has from the task that it is part of.
    (when around (setf known (environments (frame-environment around))))
    (dolist (frames (reverse (frame-runs (task-frame task))) entries)
      (let ((new (set-difference (environments (frame-environment (first frames))) known)))
        (setf known (append new known))
        (push (cons (current-form (frame-node (first frames)) (first frames))
                    (loop for environment in (environments (frame-environment (first frames)))
                          when (member environment new)
                            append (gethash environment visible)))
              entries)))))

(addition task-variables)
(defun task-variables (task)
  "Return the variables of the plan that TASK sees where it is, as a list of lists (name value),
innermost first, but for those that others of the same name hide. () when it is over."
  (check-argument task-variables task (task-p task) "a task, as begin-plan returns")
  (note-task-seen task)
  (and (task-frame task) (frame-variables (task-frame task))))
