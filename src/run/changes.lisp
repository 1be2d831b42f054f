;;;; changes.lisp -- what is changed from outside, made where it is allowed and noted.

(in-package :ars-magna.run)

;;; A change is made and noted between ticks, by the thread that has the world in custody. Another
;;; thread takes custody first, or has the change made by the thread that has it; as the world may
;;; have changed by then, the arguments are checked again there. What a tick itself does, kickers
;;; included, is not noted, since a replay does it again. Nor is what is done to a world whose run
;;; is over.

(defun note-change (simulation operator arguments)
  (unless (simulation-over simulation)
    (note simulation operator arguments)))

(defun check-not-of-past-run (timeline operator)
  "Signal MISUSE if what OPERATOR is to change belongs to TIMELINE, which is over, and this code
works in another run."
  (let ((own (and *simulation* (timeline-of *simulation*))))
    (when (and own (timeline-over timeline) (not (eq own timeline)))
      (reject-outlived "~(~A~): that is of another run in ~(~A~), which is over: ~A. FIND-THING ~
                        and robots' names lead to those of the run at hand."
                       operator (timeline-name timeline) (timeline-over timeline)))))

(defun doubt-elsewhere (world operator)
  "Say once for WORLD if OPERATOR changes it, which is not that of the run at hand, and in which no
time passes."
  (let ((over (timeline-over (world-timeline world))))
    (cond (over
           (warn-once (list :past) world
                      (format nil "~(~A~) changes what nobody sees any more: the run in ~(~A~) is ~
                                   over, as ~A. What is there now is had from robots' names and ~
                                   FIND-THING."
                              operator (timeline-name (world-timeline world)) over)))
          ((and *simulation* (between-runs-p world))
           (warn-once (list :elsewhere) world
                      (format nil "~(~A~) changes ~(~A~) for a later run of (simulator ...), not ~
                                   for the run at hand. Inside of WITH-SIMULATION robots' names ~
                                   and (find-thing 'NAME) lead to what is in that."
                              operator (timeline-name (world-timeline world))))))))

(defun change-again (world operator arguments)
  "Do to WORLD, which this thread has in custody, what OPERATOR does with ARGUMENTS, if that makes
sense now."
  (let ((*world* world)
        (*simulation* (world-simulation world)))
    (apply (operator-function (find-operator operator)) arguments)))

(defmethod change-world ((timeline timeline) world function operator arguments)
  (check-own-run timeline)
  (check-not-of-past-run timeline operator)
  (unless (and *simulation* (eq timeline (timeline-of *simulation*)))
    (doubt-elsewhere world operator))
  (if (owner-p timeline)
      (deferring-interrupts
        (note-change (world-simulation world) operator arguments)
        (writing (world) (funcall function)))
      (let ((by-itself-p (goes-on-in-forks-p)))
        (asking (timeline)
          (let ((*goes-on-in-forks-p* by-itself-p))
            (change-again world operator arguments))))))

(defun own-binding-p (binding)
  "True if BINDING, (symbol . value), is that of this thread alone."
  (not (eql (cdr binding) (global-value (car binding)))))

(defmethod parameters-bound ((timeline timeline) world)
  (let ((simulation (world-simulation world)))
    (flet ((changed () (changed-parameters (simulation-known-parameters simulation))))
      (cond ((headless-p simulation) (and (eq simulation *simulation*) (changed)))
            ((and (live-p timeline) (not (owner-p timeline)))
             (remove-if-not #'own-binding-p (changed)))))))
