;;;; rewind-line.lisp -- REWIND: going back to an earlier tick.

(in-package :ars-magna.cli)

;;; The plans that go on after that are others than those that the prompt waited for: it lets these
;;; go without a word, and takes up those.

(defun errands-in (simulation)
  "Return the plan errands of SIMULATION whose end has not been told."
  (with-lock (*plan-errands-lock*)
    (remove simulation *plan-errands* :key #'plan-errand-simulation :test-not #'eq)))

(defun call-letting-go (errands function)
  "Call FUNCTION, and say nothing of how the plans of ERRANDS end, unless FUNCTION is left."
  (flet ((let-go (value)
           (dolist (errand errands) (setf (plan-errand-let-go-p errand) value))))
    (let ((done-p nil))
      (unwind-protect (progn (let-go t)
                             (multiple-value-prog1 (funcall function)
                               (setf done-p t)))
        (unless done-p (let-go nil))))))

(defun take-up-plan (session task)
  "Let SESSION wait for TASK, a plan under way, as if its PLAN had just started that."
  (let ((errand (make-plan-errand (task-name task) session *simulation*)))
    (setf (plan-errand-task errand) task)
    (with-lock (*plan-errands-lock*) (push errand *plan-errands*))
    (push errand (session-errands session))
    (when (live-p *simulation*) (start-watching-plan errand))))

(defun rewind-here (session ticks)
  "Let SESSION go on in a run that is TICKS ticks back."
  (call-letting-go (errands-in *simulation*) (lambda () (rewind ticks)))
  (dolist (task (plans)) (take-up-plan session task)))

(define-line "REWIND" (session (n tick-span "how far"))
    (:running)
    "Go back N ticks, plans included, and go on from there; 0 undoes what was done since the last
tick. What came after has not happened; the journal says that there was something."
  (check-run)
  (when (session-visit session)
    (reject-line "A trial is what it is. TRIAL begins it anew, at tick 0."))
  (rewind-here session n)
  (format t "~A~@[ Plans under way: ~{~(~A~)~^, ~}.~]~%"
          (time-text session *simulation*) (mapcar #'task-name (plans))))
