;;;; plan-views.lisp -- PLAN-TREE, WHY and PLAN-TIMELINE: what plans do, and how they came to it.

(in-package :ars-magna.cli)

(defun task-tree-text (n)
  "Return the whole stacks and variables of the task number N, or of all if it is NIL, as text; NIL
where there is no such task. To be called while no plan goes on."
  (call-with-plans-in-use
   (lambda (runner)
     (let* ((which (if (and n runner) (task-numbered n runner) runner))
            (task (if (task-p which) which (first (plans)))))
       (when task
         (call-reading-plan (plan-name-of task)
                            (lambda ()
                              (with-output-to-string (out) (print-tasks which out t)))))))))

(defun plan-name-of (task)
  "Return the name of the plan that TASK is part of."
  (loop for each = task then (task-parent each)
        unless (task-parent each) return (task-name each)))

(define-line "PLAN-TREE" (session (n count "the number of a task" :optional)) (:planning)
    "Show the plans under way, or the task N of one with its parts, whole: each task with all that it
is in the middle of, its variables, what it waits for and since when; and who has which valve."
  (let ((text (and (plans) (task-tree-text n))))
    (cond (text (write-string (visible text)))
          ((null (plans)) (reject-line "No plan is under way."))
          (t (reject-line "No task ~D is under way. PLANS shows which are." n)))))

(define-line "WHY" (session (n count "the number of a task")) (:planning)
    "Tell what brought the task N where it is, also one that is over: which fluent woke it, who had
set that, and how it was started. Needs a trace: (setf *trace-plans* t) before the plan starts."
  (write-string
   (visible (call-reading-plan
             (let ((plan (first (plans)))) (and plan (task-name plan)))
             (lambda ()
               (with-output-to-string (out)
                 (call-with-plans-in-use
                  (lambda (runner) (why n :runner runner :stream out)))))))))

(define-line "PLAN-TIMELINE" (session (file :token "a name that ends in .svg or .png"))
    (:planning)
    "Save a picture of the plans that have run in FILE, replacing it: each task as a bar over ticks, with
what it waited for and the commands that it gave. Needs a trace: (setf *trace-plans* t) before the plan
starts."
  (format t "~A~%" (native-name (save-plan-timeline (native-path file)))))
