;;;; try-all.lisp -- side by side until the first succeeds.

(in-package :ars-magna.rpl.constructs)

(define-construct try-all (&body branches)
  "Run BRANCHES in a plan side by side. Succeed as soon as one does, with its value, and evaporate
the others; if all fail, fail with a composite failure."
  (:like par)
  (:steps
   (begin
    (next inside)
    (if (plusp (length branches))
        (start-branches branches task environment)
        (unwind task (frame-up frame) (all-failed '() task frame))))
   (inside (values (frame-up frame) value)))
  (:child-ended
   (ecase how
     (:succeeded (complete task result))
     (:escaped (decide task result))
     (:failed (push result memory))
     (:evaporated))
   (unless (or (task-newest-child task) (task-signal task) (member how '(:succeeded :escaped)))
     (decide task (all-failed memory task frame)))))
