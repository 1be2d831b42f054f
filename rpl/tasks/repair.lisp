;;;; repair.lisp -- a runner that was left in the middle of anything is made fit to go on.

(in-package :ars-magna.rpl.tasks)

;;; An interrupt from outside, such as Control-C or a time limit, may leave a reaction at any point,
;;; also between two changes that belong together. What is true then is what tasks say of
;;; themselves: their parents, states and frames. All else (who is ready, when who wakes, who hears
;;; of which fluent) is made anew from that.

(defun live-parts (task)
  "Return TASK and the tasks that it consists of, as far as they are not over. Make right how they
know each other."
  (let ((children (loop for child = (task-newest-child task) then (task-older child)
                        repeat 1000000
                        while child
                        when (and (eq task (task-parent child)) (not (task-over-p child)))
                          collect child)))
    (setf (task-newest-child task) (first children))
    (loop for (child older) on children
          for newer = nil then previous
          for previous = child
          do (setf (task-older child) older
                   (task-newer child) newer))
    (cons task (mapcan #'live-parts children))))

(defun live-tasks (runner)
  (setf (runner-roots runner) (remove-if #'task-over-p (runner-roots runner)))
  (mapcan #'live-parts (reverse (runner-roots runner))))

(defun repair-queues (runner tasks)
  "Let those of TASKS that are ready, all there are, be queued in RUNNER."
  (loop for ring across (runner-rings runner)
        do (fill (ring-items ring) nil)
           (setf (ring-start ring) 0
                 (ring-count ring) 0))
  (setf (runner-mask runner) 0
        (runner-held runner) '()
        (runner-spent runner) '()
        (runner-courtesies runner) '()
        (runner-blocks runner) (reduce #'+ tasks :key #'task-blocked))
  (dolist (task tasks)
    (when (or (eq :running (task-state task)) (courtesy-p (task-awaiting task)))
      (setf (task-awaiting task) nil
            (task-state task) :ready))
    (when (eq :ready (task-state task)) (make-ready task))))

(defun repair-timers (runner tasks)
  "Let the timers of RUNNER be those that it has and those of TASKS, for tasks that are not over."
  (let* ((heap (timers-heap (runner-timers runner)))
         (timers (remove-duplicates (append (coerce heap 'list)
                                            (remove nil (mapcar #'task-timer tasks)))
                                    :test #'eq)))
    (setf (fill-pointer heap) 0)
    (dolist (timer timers)
      (when (timer-p timer)
        (setf (timer-place timer) nil)
        (unless (and (task-p (timer-client timer)) (task-over-p (timer-client timer)))
          (vector-push-extend timer heap)
          (sift-up timer (1- (fill-pointer heap)) heap))))))

(defun own-watchers (task)
  (remove-if-not #'watcher-p
                 (cons (task-awaiting task)
                       (mapcar #'frame-data (frame-chain (task-frame task))))))

(defun repair-hearing (runner tasks)
  "Let TASKS of RUNNER hear of the fluents that they wait for, and of what they have missed."
  (repair-fluents runner (mapcan #'own-watchers tasks)
                  (lambda (watcher)
                    (let ((client (watcher-client watcher)))
                      (and (task-p client) (task-over-p client)))))
  (dolist (task tasks)
    (let ((watcher (task-awaiting task)))
      (when (and (watcher-p watcher) (eq :waiting (task-state task)))
        (handler-case (fluent-value (watcher-fluent watcher))
          (error (trouble) (funcall (watcher-wake watcher) watcher nil trouble))
          (:no-error (value) (when value (funcall (watcher-wake watcher) watcher value nil))))))))

(defun finish-ending (task)
  "Let TASK, which was about to evaporate or to end otherwise when its parts have, do so."
  (when (and (eq :waiting (task-state task)) (null (task-newest-child task)))
    (cond ((eq :evaporate (task-signal task)) (evaporate-now task))
          ((task-signal task) (make-ready task)))))

(defun repair (runner)
  "Make RUNNER fit to go on, whatever it was left in the middle of."
  (let ((tasks (live-tasks runner)))
    (repair-queues runner tasks)
    (repair-timers runner tasks)
    (repair-hearing runner tasks)
    (mapc #'finish-ending tasks)
    (dolist (task tasks)
      (when (and (task-doomed task) (not (task-over-p task))
                 (null (task-signal task)) (null (task-cleaning task)))
        (stop-waiting task)
        (end-parts task)))))
