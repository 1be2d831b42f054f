;;;; protecting.lisp -- what is done however something ends: evap-protect.

(in-package :ars-magna.rpl.constructs)

;;; Protection. While the cleanup runs, COUNTER is 2, and DATA is the signal that is to go on after
;;; it, a completion if none. A task that is cleaning up does not evaporate: see EVAPORATE.

(define-node protection ((body node) (cleanup node))
  "BODY, and CLEANUP however it ends."
  :step step-protection :unwind unwind-protection)

(defun start-cleanup (node task frame signal)
  "Return the frame that runs the cleanup of NODE before SIGNAL goes on."
  (setf (frame-counter frame) 2
        (frame-data frame) signal)
  (push frame (task-cleaning task))
  (note-event task :clean)
  (make-frame (protection-cleanup node) (frame-environment frame) frame))

(defun end-cleanup (task frame)
  (setf (task-cleaning task) (remove frame (task-cleaning task)))
  (shiftf (frame-data frame) nil))

(defun step-protection (node task frame value)
  (ecase (frame-counter frame)
    (0 (setf (frame-counter frame) 1)
     (enter (protection-body node) (frame-environment frame) frame))
    (1 (start-cleanup node task frame (make-completion value)))
    (2 (receive task frame (end-cleanup task frame)))))

(defun unwind-protection (node task frame signal)
  (ecase (frame-counter frame)
    (0 nil)
    (1 (values t (start-cleanup node task frame signal) nil))
    (2 (after-cleanup (end-cleanup task frame) signal task))))

(defun after-cleanup (first signal task)
  "SIGNAL ended a cleanup that FIRST was the reason for: return what is to go on."
  (let ((failed (typep signal 'plan-failure)))
    (cond ((or (eq first :evaporate) (and failed (not (completion-p first))))
           (when failed (note-suppressed first signal task))
           (values nil first)))))

(defun note-suppressed (first failure task)
  "Record that FAILURE happened while TASK was cleaning up because of FIRST."
  (if (typep first 'plan-failure)
      (push failure (failure-suppressed first))
      (warning-set "A cleanup failed in " (task-label task) ": " (failure-text failure))))

(addition evap-protect)
(defmacro evap-protect (form cleanup &key limit)
  "Run FORM in a plan, and CLEANUP however FORM ends: well, by failure, by evaporation or by being
left. CLEANUP may wait, for LIMIT ticks at most if given. A failure of CLEANUP counts only if FORM
ended well. Return the value of FORM."
  (misplaced 'evap-protect (list* form cleanup (and limit (list :limit limit)))))

(define-plan-form "EVAP-PROTECT" :must (protected cleanup &key limit) (form scope)
  `(make-protection :form ',form
                    :body ,(plan-code protected scope)
                    :cleanup ,(plan-code (if limit
                                             (note-own-text `(pursue ,cleanup (wait-time ,limit)))
                                             cleanup)
                                         (single-scope scope))))
