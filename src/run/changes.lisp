;;;; changes.lisp -- what is changed from outside, made where it is allowed and noted.

(in-package :ars-magna.run)

;;; Whoever has the world in custody makes a change between ticks, and notes it. Another thread
;;; takes custody first, or has the change made by the thread that has it. By then the world may
;;; have become another: so all is checked again there. What a tick itself does, kickers and all,
;;; needs no note: it happens again by itself. Nor does what is done to a world whose run is over.

(defun note-change (simulation operator arguments)
  (unless (simulation-over simulation)
    (note simulation operator arguments)))

(defun change-again (world operator arguments)
  "Do to WORLD, which this thread has in custody, what OPERATOR does with ARGUMENTS, if that makes
sense now."
  (let ((*world* world)
        (*simulation* (world-simulation world)))
    (apply (operator-function (find-operator operator)) arguments)))

(defmethod change-world ((timeline timeline) world function operator arguments)
  (if (owner-p timeline)
      (deferring-interrupts
        (note-change (world-simulation world) operator arguments)
        (writing (world) (funcall function)))
      (asking (timeline) (change-again world operator arguments))))
