;;;; thinking.lisp -- a thought that takes time, for programs of continuations (manual 1.2).

(in-package :ars-magna.command)

;;; THINK occupies the robot's mind, not its body: movements continue. Its cost depends on the run's
;;; thinking mode when it begins.

(define-command think (operation (robot robot)
                       (ticks tick-span "for how many ticks, if thinking is charged"))
    ()
    ((:family :thinking) (:section "1.2") (:delay 1) (:prefix "think") (:occupies robot-mind)
     (:report () "Robot has thought"))
    "Make ROBOT think. If the run charges for thinking, it takes TICKS, at least 1; else it ends
with the next tick. The robot's body and parts continue. A newer THINK interrupts an older one."
  (if (and (> ticks 1) (thinking-charged-p (operation-timeline operation)))
      (go-on operation 'succeed (1- ticks))
      (succeed operation)))

;; The manual only mentions it as a wish.
(addition (think :ars :nisp))
