;;;; variables.lisp -- the stack of a task, and its variables by name.

(in-package :ars-magna.rpl.seeing)

;;; A node knows the names of the variables that it sees (NODE-NAMES), a frame has the environment
;;; with their values. Variables without a home package are the compiler's own, and are not shown.

(defun stack-frames (task)
  "Return the frames of TASK, innermost first."
  (loop for frame = (task-frame task) then (frame-up frame)
        while frame collect frame))

(defun without-repetition (forms)
  "Return FORMS; of those that follow each other and are the same, only the first."
  (loop for (form . more) on forms
        unless (and more (eq form (first more))) collect form))

(defun frame-form (frame)
  (current-form (frame-node frame) frame))

(addition task-stack)
(defun task-stack (task)
  "Return the expressions that TASK is at, as lists, innermost first: only its own, not those of the
tasks that it is part of. () when it is over."
  (without-repetition (mapcar #'frame-form (stack-frames task))))

;;; Variables.

(defun outer-environment (environment)
  (and (plusp (length environment)) (svref environment 0)))

(defun environments (environment)
  "Return ENVIRONMENT and those around it, innermost first."
  (loop for each = environment then (outer-environment each)
        while each
        when (plusp (length each)) collect each))

(defun frame-names (frame)
  "Return the names for the environment of FRAME: a list for each level."
  (loop for each = frame then (frame-up each)
        while (and each (eq (frame-environment each) (frame-environment frame)))
        thereis (node-names (frame-node each))))

(defun level-variables (environment names)
  "Return the variables of one level, a list of lists (name value)."
  (loop for name in names
        for index from 1 below (length environment)
        when (symbol-package name)
          collect (list name (svref environment index))))

(defun frame-variables (frame known)
  "Return the variables that FRAME sees, innermost first, but for those of the environments KNOWN."
  (loop for environment in (environments (frame-environment frame))
        for names in (frame-names frame)
        until (member environment known :test #'eq)
        append (level-variables environment names)))

(defun known-environments (task)
  "Return the environments that TASK has from the task that it is part of."
  (let* ((parent (task-parent task))
         (frame (and parent (task-frame parent))))
    (and frame (environments (frame-environment frame)))))

(defun stack-entries (task)
  "Return what TASK is at, innermost first: a list of lists (form variable...), each variable, a
list (name value), with the outermost expression that sees it."
  (let ((known (known-environments task)) (entries '()))
    (dolist (frame (reverse (stack-frames task)))
      (let ((form (frame-form frame))
            (variables (frame-variables frame known)))
        (setf known (append (environments (frame-environment frame)) known))
        (if (and entries (eq form (first (first entries))))
            (setf (rest (first entries)) (append (rest (first entries)) variables))
            (push (cons form variables) entries))))
    entries))

(addition task-variables)
(defun task-variables (task)
  "Return the variables of the plan that TASK sees where it is, as a list of lists (name value),
innermost first. () when it is over."
  (let ((frame (task-frame task)))
    (and frame
         (remove-duplicates (frame-variables frame '()) :key #'first :from-end t))))
