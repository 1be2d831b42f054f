;;;; taking-part.lisp -- plans take part in the simulation of their robot.

(in-package :ars-magna.rpl-robot)

(defun time-to-wake-p (interface)
  "True if plans of INTERFACE, which wait, wait for this tick."
  (or (interface-tick-wanted-p interface) (woken-by-tick-p interface)))

(defun rest-fully (interface)
  "Let it be the next tick for the plans of INTERFACE, which no other thread touches, if they all
wait, and for something else. True if so. Most ticks are like that."
  (let* ((simulation (interface-simulation interface))
         (timeline (simulation-timeline simulation)))
    (not (or (interface-closing-p interface)
             (interface-wishes interface)
             (thinking-charged-p timeline)
             (not (rest-in-tick (interface-runner interface) (timeline-tick timeline)))))))

(defmethod participant-origin ((interface interface))
  (or (interface-origin interface)
      (setf (interface-origin interface) (list "the plans of " (interface-robot interface)))))

;; If plans have a thread only that lets them react: one may be waiting for the owner to answer it.
(defmethod participant-after-tick ((interface interface) simulation)
  (look-for-outside interface)
  (cond ((thread-of interface)
         (when (or (time-to-wake-p interface) (not (thread-wanted-p interface)))
           (wake interface)))
        ((not (thread-wanted-p interface))
         (begin-moment (simulation-timeline simulation))
         (if (live-p simulation)
             (with-plans (interface)
               (unless (rest-fully interface) (react-fully interface)))
             ;; Headless nobody else is there, and most ticks need no lock.
             (unless (and (null (interface-holder interface)) (rest-fully interface))
               (with-plans (interface) (react-fully interface)))))
        ((tasks-of interface) (ensure-thread interface))
        ;; Without plans what was posted is only applied.
        ((interface-answers interface)
         (with-plans (interface)
           (unless (tasks-of interface) (react-fully interface))))))

;; What was left ready by a thread that has ended from outside waits for the next tick.
(defmethod participant-busy-p ((interface interface) simulation)
  (cond ((thread-of interface) (wake-tick interface))
        ((ready-p interface))
        ((wish-to-serve interface) t)
        ((live-p simulation) (and (thread-wanted-p interface) (tasks-of interface) t))))

;; Plans that have heard what was posted are held, and who holds them publishes what is left before
;; they are free.
(defmethod participant-at-work-p ((interface interface))
  (or (ready-p interface)
      (interface-holder interface)
      (ready-p interface)))

(defmethod participant-reseed ((interface interface) seed)
  (reseed-runner (interface-runner interface) seed))

;; What a live plan is at right now is nobody's to wait for: then only its being at work counts.
(defmethod participant-digest ((interface interface) digest)
  (flet ((add () (digest-runner (interface-runner interface) digest)))
    (if (thread-of interface)
        (unless (nth-value 1 (call-with-plans-if-free #'add interface))
          (digest-add digest :at-work))
        (with-plans (interface) (add)))))

;; A thread of plans has nothing to do while no ticks pass; nor is it there for ever.
(defmethod participant-clock-stopped ((interface interface))
  (wake interface))

(defmethod participant-end ((interface interface) simulation)
  (declare (ignore simulation))
  (close-interface interface))

(defmethod participant-unfinished ((interface interface))
  (loop for task in (tasks-of interface)
        unless (or (task-parent task) (task-over-p task))
          collect (format nil "the plan ~A" (task-label task))))
