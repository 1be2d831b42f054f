;;;; plan-mouse.lisp -- the mouse on the display of plans: tasks, and moments of the timeline.

(in-package :ars-magna.clim)

;;; A click on a task of the tree, or on the name of one beside the timeline, tells of it; one on
;;; the timeline itself takes the run back to that moment. The right button offers lines of the
;;; prompt.

(defstruct (plan-moment (:constructor make-plan-moment (tick bar)) (:copier nil))
  "The TICK of a timeline, and the BAR or text that is drawn there, or NIL."
  (tick 0 :type integer :read-only t)
  (bar nil :read-only t))

(defmethod subject-title ((moment plan-moment)) (format nil "Tick ~D" (plan-moment-tick moment)))

(defmethod subject-key ((image task-image)) (list :task (task-image-serial image)))
(defmethod subject-key ((bar bar)) (list :task (bar-serial bar)))

(defmethod describe-subject ((image task-image) stream)
  (format stream "Task ~D~@[, ~A~]: ~A~%" (task-image-serial image) (task-image-name image)
          (task-image-state image))
  (format stream "  part of ~{~A~^ > ~}~%" (task-image-path image))
  (format stream "  at ~A~%" (task-image-form image))
  (loop for call in (reverse (task-image-calls image)) do (format stream "  in ~A~%" call))
  (when (task-image-awaits image)
    (format stream "  waits for ~A since tick ~A~%" (task-image-awaits image)
            (task-image-since image))))

(defmethod describe-subject ((bar bar) stream) (format stream "Task ~A~%" (subject-title bar)))

(defmethod describe-subject ((moment plan-moment) stream)
  (format stream "Tick ~D: click to go back to it~@[; drawn here: ~A~]~%" (plan-moment-tick moment)
          (and (plan-moment-bar moment) (subject-title (plan-moment-bar moment)))))

;;; What can be done.

(defun task-offers (serial)
  (list (list "Its stack and variables" (format nil "plan-tree ~D" serial))
        (list "Why is it where it is?" (format nil "why ~D" serial))))

(defmethod offers ((image task-image) window)
  (declare (ignore window))
  (let ((serial (task-image-serial image)))
    (append (task-offers serial)
            (list (if (eq :stepped (task-image-look image))
                      (list "Let it go without stopping" (format nil "step-task ~D off" serial))
                      (list "Stop when it goes on, and step" (format nil "step-task ~D" serial)))
                  (list "End it" (format nil "end-task ~D" serial))))))

(defmethod offers ((bar bar) window)
  (declare (ignore window))
  (task-offers (bar-serial bar)))

(defun rewind-line (tick) (format nil "rewind-to ~D" tick))

(defmethod offers ((moment plan-moment) window)
  (cons (list "Go back to it" (rewind-line (plan-moment-tick moment)))
        (and (typep (plan-moment-bar moment) 'bar)
             (offers (plan-moment-bar moment) window))))

;;; Where the mouse is.

(defun tick-under (pane x y)
  (let* ((look (plan-look-of pane)) (page (plan-look-page look)))
    (and (eq :timeline (plan-look-view look))
         page
         (not (symbolp page))
         (> y +plan-head+)
         (tick-at x (scale-for page (content-width pane))))))

(defun plan-subject-at (pane x y)
  "Return what is drawn at X, Y of PANE: a switch, the mark or image of a task, a moment; or NIL."
  (let* ((subjects (pane-subjects pane))
         (subject (subject-at (if (< y +plan-head+)
                                  (remove-if-not #'switch-p subjects :key #'first)
                                  subjects)
                              x y))
         (tick (tick-under pane x y)))
    (if tick (make-plan-moment tick subject) subject)))

(defmethod hover-text ((pane plan-pane) x y) (subject-text (plan-subject-at pane x y)))

(defun go-back-to (pane tick)
  "Let the prompt take the run that PANE shows back to TICK."
  (if (< tick (snapshot-tick (window-snapshot (window-of pane))))
      (give-line (window-conversation (window-of pane)) (rewind-line tick))
      (hint (window-of pane) "That is now.")))

(defmethod click ((pane plan-pane) button x y)
  (let ((subject (plan-subject-at pane x y)))
    (cond ((typep subject '(or switch fold-mark))
           (when (eq button :left)
             (etypecase subject
               (switch (funcall (switch-action subject)))
               (fold-mark (fold-task pane (fold-mark-serial subject))))))
          ((eq button :right) (offer pane (and subject (list subject)) x y))
          ((plan-moment-p subject) (go-back-to pane (plan-moment-tick subject)))
          (t (pick (window-of pane) subject)))))
