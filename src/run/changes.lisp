;;;; changes.lisp -- what is changed from outside, made where it is allowed and noted.

(in-package :ars-magna.run)

;;; Between ticks the owner makes a change at once; other threads have it made by the owner. What a
;;; tick itself does, kickers and all, needs no note: it happens again by itself.

(defmethod change-world ((timeline timeline) world function operator arguments)
  (let ((simulation (world-simulation world)))
    (asking (timeline)
      (note simulation operator arguments)
      (writing (world) (funcall function)))))
