;;;; plan-pane.lisp -- the display of plans: the tree of their tasks, or their timeline.

(in-package :ars-magna.clim)

;;; What is painted is what the watcher's look at the plans has (plan-look.lisp). A row of switches
;;; stays on top; below it the picture scrolls.

(defconstant +plan-head+ 23 "How high the row of switches is, in pixels.")

(defclass plan-pane (display-pane) ()
  (:documentation "The pane that shows the plans of the run."))

(defun plan-look-of (pane) (watcher-plans (window-watcher (window-of pane))))

;;; Switches.

(defstruct (switch (:constructor make-switch (label help action &optional lit-p)) (:copier nil))
  "A click on what is called LABEL calls ACTION, a function; HELP says what that does."
  (label "" :type string :read-only t)
  (help "" :type string :read-only t)
  (action nil :type function :read-only t)
  (lit-p nil :read-only t))

(defmethod subject-title ((switch switch)) (switch-help switch))

(defun look-again (pane)
  "Let the plans be looked at soon, as PANE is to show something else of them."
  (painted (window-watcher (window-of pane)))
  (repaint-if-changed pane))

(defun show-plans-as (pane view)
  "Let PANE show plans as VIEW, :TREE or :TIMELINE."
  (setf (plan-look-view (plan-look-of pane)) view
        (pane-offset pane) 0)
  (look-again pane))

(defun fold-task (pane serial)
  (let ((look (plan-look-of pane)))
    (setf (plan-look-folded look)
          (if (member serial (plan-look-folded look))
              (remove serial (plan-look-folded look))
              (cons serial (plan-look-folded look))))
    (look-again pane)))

(defun line-switch (pane label line help &optional lit-p)
  "Return a switch called LABEL that gives LINE to the prompt of the window of PANE."
  (make-switch label help
               (lambda () (give-line (window-conversation (window-of pane)) line))
               lit-p))

(defun plan-switches (pane)
  (let* ((look (plan-look-of pane))
         (view (plan-look-view look))
         (traced-p (plan-look-traced-p look)))
    (list (make-switch "Tree" "Show what the tasks of the plans are at, and wait for"
                       (lambda () (show-plans-as pane :tree)) (eq view :tree))
          (make-switch "Timeline" "Show what the tasks have done, over ticks"
                       (lambda () (show-plans-as pane :timeline)) (eq view :timeline))
          (line-switch pane "Trace" (format nil "trace-plans ~:[on~;off~]" traced-p)
                       (format nil "~:[Keep a trace of what plans do, for the timeline and for ~
                                    WHY~;A trace of plans is kept; click to forget it~]"
                               traced-p)
                       traced-p))))

(defun draw-switch (canvas switch x y)
  (let ((label (switch-label switch)))
    (draw-button canvas switch label (switch-lit-p switch) x y
                 (+ 10 (* +character-width+ (length label))) 17)))

(defun draw-plan-head (canvas pane)
  (let ((x 4) (robot (plan-look-robot (plan-look-of pane))))
    (dolist (switch (plan-switches pane)) (setf x (+ 5 (draw-switch canvas switch x 3))))
    (when robot
      (draw-glyphs canvas draw-gcontext* (+ x 4) 15 (format nil "of ~(~A~)" robot)))))

;;; Where there is nothing to be seen, how that can be changed.

(defun say-lines (canvas y &rest lines)
  "Write LINES from Y down: strings, and switches. Return where they end."
  (dolist (line lines y)
    (cond ((null line))
          ((switch-p line) (draw-switch canvas line 8 (+ y 2)) (incf y 24))
          (t (draw-glyphs canvas draw-gcontext* 8 (+ y 13) line) (incf y +line-height+)))))

(defun say-text (canvas pane y text)
  "Write TEXT from Y down in as many lines as it takes in PANE. Return where it ends."
  (apply #'say-lines canvas y
         (wrapped-text text (max 16 (floor (- (content-width pane) 16) +character-width+)))))

(defun say-ending (canvas pane y)
  "Write, from Y down, how the last plan ended, if one has. Return where that ends."
  (let ((ended (plan-look-ended (plan-look-of pane))))
    (if ended
        (say-text canvas pane (+ y 4) (format nil "Last: ~A." (string-right-trim "." ended)))
        y)))

(defun say-no-plan (canvas pane)
  (let ((interface (interface-of (plan-look-simulation (plan-look-of pane)))))
    ;; Plans may be under way that have not been looked at yet.
    (if (and interface (plan-runner-tasks (interface-runner interface)))
        (say-text canvas pane +plan-head+ "Looking at the plans ...")
        (let ((y (say-text canvas pane +plan-head+
                           "No plan is under way. PLAN name ... starts one.")))
          (say-ending canvas pane
                      (say-lines canvas y (line-switch pane "Which plans are there?" "plan"
                                                       "List the plans that can be started")))))))

;;; Painting.

(defmethod pane-content ((pane plan-pane))
  (let ((look (plan-look-of pane)))
    (setf (plan-look-shown-p look) (lambda () (shown-p pane)))
    (list (pane-offset pane) (multiple-value-list (pane-size pane))
          (window-selection (window-of pane))
          (plan-look-view look) (plan-look-robot look) (plan-look-tree look)
          (plan-look-page look) (plan-look-traced-p look) (plan-look-ended look))))

(defun draw-plan-tree (canvas pane)
  "Draw the tree of tasks that PANE shows. Return where it ends."
  (let ((tree (plan-look-tree (plan-look-of pane))))
    (if (and tree (plusp (tree-image-plans tree)))
        (say-ending canvas pane
                    (draw-task-tree canvas tree :width (content-width pane) :top +plan-head+))
        (say-no-plan canvas pane))))

(defun draw-plan-timeline (canvas pane)
  "Draw the timeline that PANE shows. Return where it ends."
  (let ((page (plan-look-page (plan-look-of pane))))
    (case page
      ((nil) (say-no-plan canvas pane))
      (:untraced (say-lines canvas
                            (say-text canvas pane +plan-head+
                                      "No trace is kept of these plans, so there is no timeline.")
                            (line-switch pane "Keep a trace from now on" "trace-plans on"
                                         "Keep a trace of what plans do")))
      (:too-long (say-text canvas pane +plan-head+
                           (format nil "The trace is too long to be drawn again and again. ~
                                        PLAN-TIMELINE plans.svg saves a picture.")))
      (t (draw-page canvas page :width (content-width pane) :top +plan-head+
                                :from (pane-offset pane)
                                :to (+ (pane-offset pane) (nth-value 1 (pane-size pane))))))))

(defmethod paint ((pane plan-pane))
  (multiple-value-bind (width height) (pane-size pane)
    (painting (canvas pane)
      (with-clipping (canvas 0 +plan-head+ width (max 1 (- height +plan-head+)))
        (with-origin (canvas 0 (- (pane-offset pane)))
          (setf (pane-extent pane)
                (ceiling (if (eq :timeline (plan-look-view (plan-look-of pane)))
                             (draw-plan-timeline canvas pane)
                             (draw-plan-tree canvas pane))))))
      (draw-plan-head canvas pane))))
