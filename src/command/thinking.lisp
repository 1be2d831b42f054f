;;;; thinking.lisp -- a thought that takes time, for programs of continuations (manual 1.2).

(in-package :ars-magna.command)

;;; THINK occupies the robot's mind, not its body: movements continue. Its cost depends on the run's
;;; thinking mode when it begins.

(define-command think (operation (robot robot)
                       (ticks duration "for how many ticks, if thinking is charged"))
    ()
    ((:family :thinking) (:section "1.2") (:delay 1) (:prefix "think") (:occupies robot-mind)
     (:report () "Robot has thought"))
    "Make ROBOT think. If the run charges for thinking, it takes TICKS, at least 1; a fraction of a
tick is added to the robot's next thought. Else it ends with the next tick. The robot's body and
parts continue. A newer THINK interrupts an older one."
  (let ((ticks (if (thinking-charged-p (operation-timeline operation))
                   (charge-thought robot ticks)
                   0)))
    (if (> ticks 1)
        (go-on operation 'succeed (1- ticks))
        (succeed operation))))

;; The manual only mentions it as a wish.
(addition (think :ars :nisp))
