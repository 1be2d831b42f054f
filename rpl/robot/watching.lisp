;;;; watching.lisp -- plans that keep their thread are named while they do, and ended if need be.

(in-package :ars-magna.rpl-robot)

;;; A watcher, a thread of its own, looks twice in *HOG-SECONDS* at what the plans' thread is doing.
;;; If it finds the same step of Lisp code three times in a row, the plan has kept the thread for
;;; that long: a warning names the plan. The code is aborted if somebody wants the plan to end, or
;;; the simulator has been stopped. A plan that takes step after step is named by the runner; if it
;;; goes on after the simulator has stopped, it is ended.

(defstruct (look (:constructor make-look (rests steps task)) (:copier nil))
  "What the plans' thread was at: how often it had come to rest, how many steps had been taken, and
TASK, or NIL if it was at none."
  (rests 0 :read-only t)
  (steps 0 :read-only t)
  (task nil :read-only t))

(defun look-at (interface thread)
  (let ((*runner* (interface-runner interface)))
    (make-look (interface-rests interface)
               (plan-runner-steps)
               (and (eq thread (interface-holder interface))
                    (current-task)))))

(defun busy-since-p (look earlier)
  "True if the plans have not come to rest between EARLIER and LOOK."
  (and earlier
       (look-task look)
       (look-task earlier)
       (eql (look-rests look) (look-rests earlier))))

(defun stuck-since-p (look earlier)
  "True if the plans were in the same step at EARLIER and LOOK."
  (and (busy-since-p look earlier)
       (eql (look-steps look) (look-steps earlier))))

(defun unwanted-p (interface task)
  (or (interface-closing-p interface)
      (not (live-p (interface-simulation interface)))
      (member (task-top task) (interface-unwanted interface))))

(defun warn-of-plan (task)
  (warn-at-once (format nil "The plan ~A has kept the plans' thread for ~,1F s and goes on, at ~A ~
                             in ~{~A~^ > ~}; (end-plan :all) or (stop-simulator) ends it"
                        (task-label (task-top task)) (hog-seconds)
                        (form-text (task-form task)) (task-path task))))

(defun abort-step (interface steps)
  "Abort the Lisp code that the plans of INTERFACE are at in this thread, if it still is the same."
  (let ((*runner* (interface-runner interface)))
    (when (and (eql steps (plan-runner-steps))
               (holding-p interface))
      (abort))))

(defun end-hog (interface thread look stuck-p)
  "End the plan that LOOK is of: its Lisp code if it is STUCK-P in that, else between two steps."
  (let ((steps (look-steps look)))
    (if stuck-p
        (interrupt-thread thread (lambda () (abort-step interface steps)))
        (stop-plan (interface-runner interface) (task-top (look-task look))))))

(defun watch-plans (interface thread calls ended)
  "Name what the plans' THREAD, in the users' CALLS, does not get out of, and end it if it is to
end, until the semaphore ENDED says that the thread has."
  (loop with earlier = nil and stuck = 1 and busy = 1
        until (wait-on-semaphore ended (/ (hog-seconds) 2))
        do (let ((look (look-at interface thread)))
             (setf stuck (if (stuck-since-p look earlier) (1+ stuck) 1)
                   busy (if (busy-since-p look earlier) (1+ busy) 1)
                   earlier look
                   (interface-hog interface) (and (<= 3 stuck) (look-task look)))
             (unless (user-calls-waiting-p calls)
               (when (= 3 stuck) (warn-of-plan (look-task look)))
               (when (and (<= 3 busy) (unwanted-p interface (look-task look)))
                 (end-hog interface thread look (<= 3 stuck)))))
        finally (setf (interface-hog interface) nil)))
