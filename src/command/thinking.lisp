;;;; thinking.lisp -- a thought that takes time, for programs of continuations (manual 1.2).

(in-package :ars-magna.command)

;;; A thought occupies the robot's mind, not its body: movements go on. What it costs is a matter of
;;; the run's thinking mode, which is looked at when the thought begins.

(define-command think (operation (robot robot)
                       (ticks tick-span "for how many ticks, if thinking is charged"))
    ()
    ((:family :thinking) (:section "1.2") (:delay 1) (:prefix "think") (:occupies robot-mind)
     (:report () "Robot has thought"))
    "Let ROBOT think: where thinking is charged for TICKS, but 1 at least; elsewhere until the end
of the next tick. Its body and its parts go on meanwhile. A newer thought interrupts an older one."
  (if (and (> ticks 1) (thinking-charged-p (operation-timeline operation)))
      (go-on operation 'succeed (1- ticks))
      (succeed operation)))

;; The manual only wishes for it.
(addition (think :ars :nisp))
