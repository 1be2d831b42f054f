;;;; phases.lisp -- what the parts of a tick are called, in order.

(in-package :ars-magna.time)

(export '(phase-number changing-phase-p telling-phase-p))

;;; Phases are counted from 1, and 0 is between ticks. What happens in one the run's tick says. In
;;; those that change the world a fork does again by itself whatever users' code does there.

(define-constant +phases+
    '(:requests :events :kickers :settling :continuations :observers :participants :keeping)
  :test #'equal
  :documentation "The names of the phases of a tick, in order.")

(defmacro phase-number (name)
  "Return the number of the phase of a tick that is called NAME, a keyword, not evaluated."
  (1+ (or (position name +phases+)
          (reject-name "phase" name +phases+))))

(defun changing-phase-p (phase)
  "True if the world changes in the phase with the number PHASE."
  (<= (phase-number :requests) phase (phase-number :settling)))

(defun telling-phase-p (phase)
  "True if the phase with the number PHASE comes after the world has changed."
  (<= (phase-number :continuations) phase))
