;;;; changes.lisp -- what is changed from outside, made where it is allowed and noted.

(in-package :ars-magna.run)

;;; Between ticks the owner makes a change at once; other threads have it made by the owner. By then
;;; the world may have become another, so all is checked again there. What a tick itself does,
;;; kickers and all, needs no note: it happens again by itself. Nor does what is done to a world
;;; whose run is over. While no thread runs a world, the lock of its timeline keeps threads apart
;;; that change it, start it, or start it anew.

(defun note-change (simulation operator arguments)
  (unless (simulation-over simulation)
    (note simulation operator arguments)))

(defun call-as-only-writer (function otherwise timeline world)
  "Call FUNCTION if this thread may change WORLD now and TIMELINE is still its own, with everybody
else kept out; else OTHERWISE, as another thread runs the world or it has started anew. Return the
values."
  (if (eq (timeline-thread timeline) (current-thread))
      (funcall function)
      (let ((values :not-called))
        (with-lock ((timeline-lock timeline))
          (when (and (null (timeline-thread timeline)) (eq timeline (world-timeline world)))
            (setf values (multiple-value-list (funcall function)))))
        (if (eq values :not-called)
            (funcall otherwise)
            (values-list values)))))

(defun ask-for-change (operator arguments)
  (apply (operator-function (find-operator operator)) arguments))

(defun make-change-again (simulation operator arguments)
  "Let OPERATOR, a name, be done to the world of SIMULATION with ARGUMENTS, as its owner. Return its
values. Nothing is noted if they make no sense any more."
  (let* ((world (simulation-world simulation))
         (*simulation* simulation)
         (*world* world))
    (call-as-only-writer (lambda ()
                           (multiple-value-prog1
                               (writing (world) (ask-for-change operator arguments))
                             (note-change simulation operator arguments)))
                         (lambda () (ask-for-change operator arguments))
                         (simulation-timeline simulation) world)))

(defmethod change-world ((timeline timeline) world function operator arguments)
  (call-as-only-writer (lambda ()
                         (note-change (world-simulation world) operator arguments)
                         (writing (world) (funcall function)))
                       (lambda ()
                         (let ((simulation (world-simulation world)))
                           (asking ((simulation-timeline simulation))
                             (make-change-again simulation operator arguments))))
                       timeline world))
