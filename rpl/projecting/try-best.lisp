;;;; try-best.lisp -- doing what rollouts say goes best.

(in-package :ars-magna.rpl-projecting)

(defun question-of-branches (task forms options)
  "Return the question of TASK which of the branches FORMS is the best, given the plist OPTIONS; NIL
if there is only one."
  (let ((options (checked-options 'try-best options)))
    (and (rest forms)
         (%make-question :operator 'try-best :task task :interface (asking-interface task)
                         :branches (mapcar #'whole-form-text forms) :options options))))

(define-construct try-best ((&key trials horizon until cost seed tell print) &body branches)
  "Run in a plan that one of BRANCHES which does best in rollouts, and return its values: each
branch is tried in TRIALS forks of the run, 20 if not given, until the whole plan has ended, or
HORIZON ticks have passed, 600 if not given. The best is the branch with which the plan succeeds
most often; of these, the one that takes the fewest ticks on average where it succeeds; of these,
the first. Trials of the same number have the same chance in all branches.
  UNTIL :branch looks only at the branch: until that has ended.
  COST, a function without arguments, is called in each fork at the end and returns a number, of
which less is better, or positive infinity, the worst; it decides instead of ticks.
  SEED, an integer, decides the seeds of rollouts; by default the run's does, and the tick.
  TELL, a function, is called with the list of projections and the index of the chosen branch.
  PRINT, if true, lets plans write in rollouts as ever; otherwise that is lost.
In a rollout a branch is chosen by chance: there are no rollouts in rollouts. The task goes on in
the same tick; nothing else of its run depends on how it has chosen. Fails with a CANNOT-FORK if the
run cannot be forked (ours)."
  (:arguments trials horizon until cost seed tell print)
  (:parts (request function
                   (value-lambda `(list :trials ,trials :horizon ,horizon :until ,until :cost ,cost
                                        :seed ,seed :tell ,tell :print ,print)
                                 scope))
          (forms list `',branches)
          (branches simple-vector
                    (if branches
                        `(vector ,@(loop for branch in branches collect (plan-code branch scope)))
                        (reject-clause (author) form "at least one branch"))))
  (:steps
   (begin
    (next chosen)
    (setf memory (question-of-branches task forms (funcall request environment)))
    (if memory (ask memory task) (values frame 0)))
   (chosen
    (next inside)
    (enter (svref branches value) environment frame))
   (inside
    (note-ended memory :succeeded value)
    (values (frame-up frame) value)))
  (:unwind
   (when (and memory (in-state-p inside)) (note-signal memory signal))
   nil))
