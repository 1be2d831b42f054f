;;;; protecting.lisp -- what is done however something ends: evap-protect.

(in-package :ars-magna.rpl.constructs)

;;; While the cleanup runs, the frame remembers the signal that is to go on after it, a completion
;;; if none. A task that is cleaning up does not evaporate: see EVAPORATE.

(defun start-cleanup (cleanup task frame signal)
  (setf (frame-data frame) signal)
  (push frame (task-cleaning task))
  (note-event task :clean)
  (make-frame cleanup (frame-environment frame) frame))

(defun end-cleanup (task frame)
  (setf (task-cleaning task) (remove frame (task-cleaning task)))
  (unless (task-cleaning task) (note-event task :cleaned))
  (shiftf (frame-data frame) nil))

(defun after-cleanup (first signal task)
  "SIGNAL ended a cleanup that FIRST was the reason for: return what is to go on."
  (let ((failed (typep signal 'plan-failure)))
    (when (or (eq first :evaporate) (and failed (not (completion-p first))))
      (when failed (note-suppressed first signal task))
      (values nil first))))

(defun note-suppressed (first failure task)
  (if (typep first 'plan-failure)
      (push failure (failure-suppressed first))
      (warn-notably "A cleanup failed in " (task-label task) ": " (failure-text failure))))

(defun report-given-up (cleanup)
  (warn-notably "The cleanup " (form-text cleanup) " in " (task-label (current-task))
               " was given up at tick " (plan-time) ": it took longer than its limit."))

(defun cleanup-form (cleanup limit)
  "Return the form for CLEANUP that takes at most as many ticks as LIMIT, a form or NIL, says."
  (if limit
      (note-own-text `(pursue ,cleanup
                              (seq (wait-time ,limit) (report-given-up ',cleanup))))
      cleanup))

(define-construct evap-protect (protected cleanup &key limit)
  "Run PROTECTED, a form, in a plan, and CLEANUP however that ends: well, by failure, by evaporation
or by being left. CLEANUP may wait; if LIMIT, a number of ticks, is given and over first, it is
given up, with a warning. A failure of CLEANUP counts only if PROTECTED ended well. Return all
values of PROTECTED."
  (:parts (protected node (plan-code protected scope))
          (cleanup node (plan-code (cleanup-form cleanup limit) (single-scope scope))))
  (:steps
   (begin
    (next inside)
    (enter protected environment frame))
   (inside
    (next cleaning-up)
    (start-cleanup cleanup task frame (make-completion value)))
   (cleaning-up
    (let ((signal (end-cleanup task frame)))
      (if (completion-p signal)
          (receive task frame signal)
          (unwind task (frame-up frame) signal)))))
  (:unwind
   (cond ((in-state-p inside)
          (next cleaning-up)
          (values t (start-cleanup cleanup task frame signal) nil))
         ((in-state-p cleaning-up)
          (after-cleanup (end-cleanup task frame) signal task)))))
