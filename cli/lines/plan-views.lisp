;;;; plan-views.lisp -- PLAN-TREE, WHY and PLAN-TIMELINE: what goes on, and how it came to that.

(in-package :ars-magna.cli)

(defun tree-text (which)
  "Return the whole stacks and variables of WHICH, a task or a plan runner with plans, as text."
  (let ((plan (loop for task = (if (task-p which) which (first (plans))) then (task-parent task)
                    unless (task-parent task) return task)))
    (call-reading-plan (task-name plan)
                       (lambda () (with-output-to-string (out) (print-tasks which out t))))))

(define-line "PLAN-TREE" (session (n count "the number of a task" :optional)) (:planning)
    "Show the plans under way, or the task N of one with its parts, whole: each task with all that
it is in the middle of, its variables, what it waits for and since when; and who has which valve."
  (let ((text (call-with-plans-in-use
               (lambda (runner)
                 (let ((which (cond ((null (plans)) nil)
                                    (n (task-numbered n runner))
                                    (t runner))))
                   (and which (tree-text which)))))))
    (cond (text (write-string (visible text)))
          ((null (plans)) (reject-line "No plan is under way."))
          (t (reject-line "No task ~D is under way. PLANS shows which are." n)))))

(defun task-why-text (n)
  (call-reading-plan
   (let ((plan (first (plans)))) (and plan (task-name plan)))
   (lambda ()
     (with-output-to-string (out)
       (call-with-plans-in-use (lambda (runner) (why n :runner runner :stream out)))))))

(define-line "WHY" (session (n count "the number of a task" :optional)) (:planning)
    "Tell why the command that failed last did so: what was asked for and when, what its error code
means and what to try. With N, tell what brought the task N where it is, also one that is over:
which fluent woke it, who had set that, and how it was started. That needs a trace:
(setf *trace-plans* t) before the plan starts."
  (if n
      (write-string (visible (task-why-text n)))
      (let ((robot (session-robot)))
        (still (dolist (sentence (failure-sentences robot)) (write-filled sentence 0))))))

(define-line "PLAN-TIMELINE" (session (file :file "a name that ends in .svg or .png"))
    (:planning)
    "Save a picture of the plans that have run in FILE, replacing it: each task as a bar over
ticks, with what it waited for and the commands that it gave. Needs a trace: (setf *trace-plans* t)
before the plan starts."
  (format t "~A~%" (native-name (save-plan-timeline (path-called file)))))
