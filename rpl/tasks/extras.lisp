;;;; extras.lisp -- what few tasks need: blocks, time limits, cleanups, variables of their own.

(in-package :ars-magna.rpl.tasks)

;;; A task has no room for these. It gets a record of them when one is first set.

(defmacro define-extra (name default text)
  "Define TASK-NAME, which returns what TEXT says: NAME of the extras of a task, or DEFAULT if the
task has none. It can be set."
  (let ((task-reader (symbolicate "TASK-" name)) (reader (symbolicate "EXTRAS-" name)))
    `(progn
       (declaim (inline ,task-reader))
       (defun ,task-reader (task)
         ,(reader-docstring name text)
         (let ((extras (task-extras task)))
           (if extras (,reader (the extras extras)) ,default)))
       (defun (setf ,task-reader) (value task)
         (if (or (task-extras task) (not (eql value ,default)))
             (setf (,reader (ensure-extras task)) value)
             value)))))

(defmacro define-extras (&body slots)
  "Define the record EXTRAS with SLOTS, and a reader of tasks for each. A slot is (name default type
\"what is in it\" [:export])."
  `(progn
     (define-record (extras (:constructor make-extras ()))
       "What few tasks need."
       ,@(loop for (name default type) in slots collect (list name default type :writable)))
     (declaim-final extras)
     (defun ensure-extras (task)
       (or (task-extras task)
           (setf (task-extras task) (make-extras))))
     ,@(reader-export-forms slots (lambda (name) (symbolicate "TASK-" name)))
     ,@(loop for (name default nil text) in slots
             collect `(define-extra ,name ,default ,text))))

(define-extras
  (timer nil (or null timer)
         "the timer that ends the task's wait at its time limit, or NIL" :export)
  (cleaning '() list "the frames of the task that clean up, innermost first" :export)
  (blocked 0 fixnum "the number of blocks that keep the task from running")
  (suspensions 0 fixnum "the number of the task's blocks that are suspensions")
  (suspended nil boolean "true if SUSPEND has suspended the task")
  (gate nil t "the gate that keeps the task from starting, or NIL")
  (uncounted-p nil boolean "the task's steps are not charged, because WITH-CHARGE has a fixed price"
               :export)
  (status-fluent nil (or null fluent)
                 "the fluent whose value is the task's status, or NIL: see TASK-STATUS" :export)
  (variables '() list "the task variables that the task has set, an alist"))
