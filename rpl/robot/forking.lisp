;;;; forking.lisp -- plans in forks of their run.

(in-package :ars-magna.rpl-robot)

;;; Plans are copied while they rest, between two reactions: then all that they are about to do is
;;; in their tasks, and in what was posted to them.

(defmethod client-forked-p ((interface interface) copier)
  (eq (interface-simulation interface) (copier-option copier :simulation)))

(defmethod copy-plan-value ((interface interface) fork)
  (if (client-forked-p interface fork)
      (copy-slots interface fork)
      interface))

(defmethod participant-copy ((interface interface) simulation copier)
  (declare (ignore simulation))
  (let ((twin (forked interface copier))
        (robot (forked (interface-robot interface) copier))
        (realm (forked (source-realm copier) copier)))
    (setf (interface-ender twin) (lambda () (close-interface twin)))
    (push (make-weak (interface-runner interface)) (realm-sources realm))
    (push (interface-ender twin) (robot-enders robot))
    twin))

;; What this thread is at cannot be gone on with elsewhere.
(defmethod participant-around-p ((interface interface))
  (and (holding-p interface) (not (interface-resting-p interface))))

(defmethod check-forkable ((interface interface))
  (when (participant-around-p interface)
    (refuse-fork "a plan is at work here. In the text of a plan PROJECT and TRY-BEST fork the run ~
                  when the plans have come to rest.")))

(defun call-holding-at-rest (interface function)
  "Call FUNCTION, holding the plans of INTERFACE. Return its value; :BUSY if somebody else has
them."
  (multiple-value-bind (value free-p)
      (call-if-free (interface-lock interface)
                    (lambda ()
                      (call-holding (lambda ()
                                      ;; What was left halfway is put in order.
                                      (at-home ((interface-runner interface)))
                                      (funcall function))
                                    interface)))
    (if free-p value :busy)))

(defmethod participant-at-rest ((interface interface) function)
  (cond ((interface-resting-p interface) (funcall function))
        (t (check-not-kept interface)
           (call-holding-at-rest interface function))))

(defmethod call-as-participant-makes-way ((interface interface) function)
  (call-wanting-plans (lambda (have)
                        (declare (ignore have))
                        (allowing-interrupts (funcall function)))
                      interface))

(defmethod participant-place ((interface interface) value)
  (multiple-value-bind (task name) (task-with value (interface-runner interface))
    (and task (format nil "the variable ~(~A~) of the task ~D, ~A"
                      name (task-serial task) (task-label task)))))

;;; What is what.

(defmethod counterpart-here ((entity entity))
  (here entity))
