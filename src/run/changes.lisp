;;;; changes.lisp -- what is changed from outside, made where it is allowed and noted.

(in-package :ars-magna.run)

;;; Between ticks the owner makes a change at once; other threads have it made by the owner. By then
;;; the world may have become another, so all is checked again there. What a tick itself does,
;;; kickers and all, needs no note: it happens again by itself. Nor does what is done to a world
;;; whose run is over.

(defun note-change (simulation operator arguments)
  (unless (simulation-over simulation)
    (note simulation operator arguments)))

(defun make-change-again (simulation operator arguments)
  "Let OPERATOR, a name, be done to the world of SIMULATION with ARGUMENTS, as its owner. Return its
values. Nothing is noted if they make no sense any more."
  (let* ((world (simulation-world simulation))
         (*simulation* simulation)
         (*world* world))
    (multiple-value-prog1
        (writing (world) (apply (operator-function (find-operator operator)) arguments))
      (note-change simulation operator arguments))))

(defmethod change-world ((timeline timeline) world function operator arguments)
  (let ((simulation (world-simulation world)))
    (cond ((owner-p timeline)
           (note-change simulation operator arguments)
           (writing (world) (funcall function)))
          (t (asking (timeline) (make-change-again simulation operator arguments))))))
