;;;; plan-pane.lisp -- the display of plans, a tree or a timeline, and the mouse on it.

(in-package :ars-magna.clim)

;;; It paints what the watcher's look at the plans has (plan-look.lisp). A row of buttons stays on
;;; top; below it the picture scrolls.

(defconstant +plan-buttons-height+ 23 "The height of the row of buttons, in pixels.")

(defclass plan-pane (display-pane) ()
  (:documentation "The pane that shows the plans of the run."))

(defun plan-look-of (pane) (watcher-plans (window-watcher (window-of pane))))

;;; Its buttons have no keys.

(defun request-new-look (pane)
  "Request new images of the plans, because the user has changed what PANE shows of them."
  (report-painted (window-watcher (window-of pane)))
  (repaint-if-changed pane))

(defun set-plan-view (pane view)
  (setf (preferences-plan-view (window-preferences (window-of pane))) view
        (plan-look-view (plan-look-of pane)) view
        (pane-offset pane) 0)
  (request-new-look pane))

(defun toggle-task-folding (pane serial)
  (let ((look (plan-look-of pane)))
    (setf (plan-look-folded look)
          (if (member serial (plan-look-folded look))
              (remove serial (plan-look-folded look))
              (cons serial (plan-look-folded look))))
    (request-new-look pane)))

(defun prompt-line-button (pane label line help &optional lit-p)
  (make-button label nil
               (lambda () (run-line-at-prompt (window-conversation (window-of pane)) line)) help
               lit-p))

(defun plan-buttons (pane)
  (let* ((look (plan-look-of pane))
         (view (plan-look-view look))
         (traced-p (plan-look-traced-p look)))
    (list (make-button "Tree" nil (lambda () (set-plan-view pane :tree))
                       "Show what the tasks of the plans do and wait for" (eq view :tree))
          (make-button "Timeline" nil (lambda () (set-plan-view pane :timeline))
                       "Show what the tasks have done, as bars over ticks" (eq view :timeline))
          (prompt-line-button pane "Trace" (format nil "trace-plans ~:[on~;off~]" traced-p)
                              (format nil
                                      "~:[Keep a trace of what plans do, for the timeline and for ~
                                       WHY~;A trace of plans is kept; click to discard the trace~]"
                                      traced-p)
                              traced-p))))

(defun draw-plan-button (canvas button x y)
  (let ((label (button-label button)))
    (draw-button canvas button label (button-lit-p button) x y
                 (button-width label) 17)))

(defun draw-plan-buttons (canvas pane)
  (let ((x 4) (robot (plan-look-robot (plan-look-of pane))))
    (dolist (button (plan-buttons pane)) (setf x (+ 5 (draw-plan-button canvas button x 3))))
    (when robot
      (draw-label canvas (+ x 4) 15 (format nil "of ~(~A~)" robot)))))

;;; If there is nothing to show, it says how to change that.

(defun draw-plan-lines (canvas y &rest lines)
  "Draw LINES, strings and buttons, from Y down. Return the y coordinate of their end."
  (dolist (line lines y)
    (cond ((null line))
          ((button-p line) (draw-plan-button canvas line 8 (+ y 2)) (incf y 24))
          (t (draw-label canvas 8 (+ y 13) line) (incf y +line-height+)))))

(defun draw-plan-text (canvas pane y text)
  "Draw TEXT from Y down, wrapped to the width of PANE. Return the y coordinate of its end."
  (apply #'draw-plan-lines canvas y
         (wrapped-text text (max 16 (floor (- (content-width pane) 16)
                                     (character-width canvas +label-size+))))))

(defun draw-plan-ending (canvas pane y)
  "Write below Y how the last plan, if any, ended. Return the y coordinate of the text's end."
  (let ((ended (plan-look-ended (plan-look-of pane))))
    (if ended
        (draw-plan-text canvas pane (+ y 4) (format nil "Last: ~A." (string-right-trim "." ended)))
        y)))

(defun plan-running-p (simulation)
  (let ((interface (plan-interface-of simulation)))
    (and interface (plan-runner-tasks (interface-runner interface)))))

(defun draw-no-plan-text (canvas pane)
  ;; There may be running plans that have not been looked at yet.
  (if (plan-running-p (plan-look-simulation (plan-look-of pane)))
      (draw-plan-text canvas pane +plan-buttons-height+ "Looking at the plans ...")
      (let ((y (draw-plan-text canvas pane +plan-buttons-height+
                               "No plan is running. The line PLAN name ... starts a plan.")))
        (draw-plan-ending canvas pane
                          (draw-plan-lines
                           canvas y (prompt-line-button pane "List the plans" "plan"
                                                        "List plans that can be started"))))))

;;; Painting.

(defmethod pane-appearance ((pane plan-pane))
  (let ((look (plan-look-of pane)))
    (setf (plan-look-shown-p look) (lambda () (pane-shown-p pane)))
    (list (pane-offset pane) (multiple-value-list (pane-size pane))
          (window-selection (window-of pane))
          (plan-look-view look) (plan-look-robot look) (plan-look-tree look)
          (plan-look-page look) (plan-look-traced-p look) (plan-look-ended look))))

(defun draw-plan-tree (canvas pane)
  "Draw the tree of tasks for PANE. Return the y coordinate of its end."
  (let ((tree (plan-look-tree (plan-look-of pane))))
    (if (and tree (plusp (tree-image-plans tree)))
        (draw-plan-ending canvas pane
                          (draw-task-tree canvas tree :width (content-width pane)
                                                :top +plan-buttons-height+))
        (draw-no-plan-text canvas pane))))

(defun draw-plan-timeline (canvas pane)
  "Draw the timeline for PANE. Return the y coordinate of its end."
  (let ((page (plan-look-page (plan-look-of pane))))
    (case page
      ((nil) (draw-no-plan-text canvas pane))
      (:untraced (draw-plan-lines canvas
                                  (draw-plan-text canvas pane +plan-buttons-height+
                                                  "There is no timeline without a trace.")
                                  (prompt-line-button pane "Keep a trace from now on"
                                                      "trace-plans on"
                                                      "Start to keep a trace of what plans do")))
      (:too-long (draw-plan-text canvas pane +plan-buttons-height+
                                 (format nil "The trace is too long to be drawn in the window. ~
                                              The line PLAN-TIMELINE plans.svg saves a picture.")))
      (t (draw-timeline-page canvas page :width (content-width pane) :top +plan-buttons-height+
                                :from (pane-offset pane)
                                :to (+ (pane-offset pane) (nth-value 1 (pane-size pane))))))))

(defmethod paint ((pane plan-pane))
  (multiple-value-bind (width height) (pane-size pane)
    (with-pane-canvas (canvas pane)
      (with-clipping (canvas 0 +plan-buttons-height+ width (max 1 (- height +plan-buttons-height+)))
        (with-origin (canvas 0 (- (pane-offset pane)))
          (setf (pane-extent pane)
                (ceiling (if (eq :timeline (plan-look-view (plan-look-of pane)))
                             (draw-plan-timeline canvas pane)
                             (draw-plan-tree canvas pane))))))
      (draw-plan-buttons canvas pane))))

;;;; The mouse

;;; A click on a task of the tree, or on its name beside the timeline, shows details; a click on the
;;; timeline itself rewinds the run to that tick. The right button offers lines of the prompt.

(defstruct (timeline-point (:constructor make-timeline-point (tick bar)) (:copier nil))
  "A point of a timeline: its TICK, and BAR, the bar or text that is drawn at the point, or NIL."
  (tick 0 :type integer :read-only t)
  (bar nil :read-only t))

(defmethod subject-title ((moment timeline-point))
  (format nil "Tick ~D" (timeline-point-tick moment)))

(defmethod choice-key ((mark fold-mark)) (list :fold-mark (fold-mark-serial mark)))

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

(defmethod describe-subject ((moment timeline-point) stream)
  (format stream "Tick ~D: click to rewind to it~@[; drawn here: ~A~]~%"
          (timeline-point-tick moment)
          (and (timeline-point-bar moment) (subject-title (timeline-point-bar moment)))))

;;; What can be done.

(defun task-offers (serial)
  (list (list "Its stack and variables" (format nil "plan-tree ~D" serial))
        (list "Explain how it got into this state" (format nil "why ~D" serial))))

(defmethod offers ((image task-image) window)
  (declare (ignore window))
  (let ((serial (task-image-serial image)))
    (append (task-offers serial)
            (list (if (eq :stepped (task-image-look image))
                      (list "Let it run without stopping" (format nil "step-task ~D off" serial))
                      (list "Step it from its next expression" (format nil "step-task ~D" serial)))
                  (list "End it" (format nil "end-task ~D" serial))))))

(defmethod offers ((bar bar) window)
  (declare (ignore window))
  (task-offers (bar-serial bar)))

(defun rewind-line-text (tick) (format nil "rewind-to ~D" tick))

(defmethod offers ((moment timeline-point) window)
  (cons (list "Pause, and rewind to this tick" (rewind-line-text (timeline-point-tick moment))
              #'pause-before-rewind)
        (and (typep (timeline-point-bar moment) 'bar)
             (offers (timeline-point-bar moment) window))))

;;; Where the mouse is.

(defun tick-at-mouse (pane x y)
  (let* ((look (plan-look-of pane)) (page (plan-look-page look)))
    (and (eq :timeline (plan-look-view look))
         page
         (not (symbolp page))
         (> y +plan-buttons-height+)
         (tick-at x (timeline-page-scale page (content-width pane))))))

(defun plan-subject-at (pane x y)
  "Return the subject that PANE shows at X, Y: a button, the fold mark or image of a task, or a
point of the timeline. Return NIL if PANE shows no subject there."
  (let* ((subjects (pane-subjects pane))
         (subject (subject-at (if (< y +plan-buttons-height+)
                                  (remove-if-not #'button-p subjects :key #'first)
                                  subjects)
                              x y))
         (tick (tick-at-mouse pane x y)))
    (if tick (make-timeline-point tick subject) subject)))

(defmethod hover-text ((pane plan-pane) x y) (subject-description (plan-subject-at pane x y)))

(defun rewind-run-to-tick (pane tick)
  (let ((window (window-of pane)))
    (cond ((< tick (snapshot-tick (window-snapshot window)))
           (pause-before-rewind window)
           (run-line-at-prompt (window-conversation window) (rewind-line-text tick)))
          (t (show-hint window "The run is at this tick now.")))))

(defmethod handle-click ((pane plan-pane) button x y)
  (let ((subject (plan-subject-at pane x y)))
    (cond ((typep subject '(or button fold-mark))
           (when (eq button :left)
             (etypecase subject
               (button (funcall (button-command subject)))
               (fold-mark (toggle-task-folding pane (fold-mark-serial subject))))))
          ((eq button :right) (open-offers-at pane (and subject (list subject)) x y))
          ((timeline-point-p subject) (rewind-run-to-tick pane (timeline-point-tick subject)))
          (t (select-and-describe (window-of pane) subject)))))
