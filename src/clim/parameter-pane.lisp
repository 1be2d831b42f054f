;;;; parameter-pane.lisp -- the panel of the simulation parameters (manual, chapter 4).

(in-package :ars-magna.clim)

;;; The panel shows the values that are in force in the run of the window. It sets nothing itself:
;;; each change is a line of the prompt, so it is in the transcript, the history and the journal.
;;; In a live run the parameters are global variables, see parameters-of-runs.lisp.

(defclass parameter-pane (display-pane)
  (;; The values that lines will set that still wait for a running line: an alist by symbol.
   (requested :initform '() :accessor pane-requested))
  (:documentation "The pane that shows the parameters of the run."))

(defconstant +panel-head-height+ 42
  "The height of the buttons and the note above the list of parameters, in pixels.")
(defconstant +value-width+ 50 "The width of a parameter's value, in pixels.")
(defconstant +step-button-width+ 15 "The width of a button that steps a value, in pixels.")

(defstruct (parameter-row (:constructor make-parameter-row (parameter value)) (:copier nil))
  "A row of the panel: PARAMETER with its VALUE."
  (parameter nil :read-only t)
  (value nil :read-only t))

(defun row-changed-p (row)
  (not (value-equal (parameter-row-value row) (parameter-default (parameter-row-parameter row)))))

(defmethod subject-title ((row parameter-row))
  (let ((parameter (parameter-row-parameter row)))
    (format nil "~A: ~A~@[ ~A~]~@[ (default ~A)~]. ~A" (parameter-name parameter)
            (ars-magna.cli:parameter-value-text (parameter-row-value row))
            (and (string/= "" (parameter-unit parameter)) (parameter-unit parameter))
            (and (row-changed-p row)
                 (ars-magna.cli:parameter-value-text (parameter-default parameter)))
            (parameter-sentence parameter))))

;;; Steps.

(defun power-of-ten-below (number)
  "Return the greatest power of ten that is at most NUMBER, a positive rational number."
  (let ((power 1))
    (loop while (> power number) do (setf power (/ power 10)))
    (loop while (<= (* 10 power) number) do (setf power (* 10 power)))
    power))

(defun step-size (parameter)
  "Return the step by which the panel changes PARAMETER, a number: a power of ten that changes the
first digit of the default, or the second digit if the first is 1; 1/10 if the default is 0. Ticks
change by 1 at least."
  (let* ((default (abs (rationalize (parameter-default parameter))))
         (size (if (zerop default) 1 default))
         (power (power-of-ten-below size))
         (step (if (< size (* 2 power)) (/ power 10) power)))
    (if (or (string= "ticks" (parameter-unit parameter))
            (subtypep (parameter-type parameter) 'integer))
        (max 1 step)
        step)))

(defun parameter-limits (parameter)
  "Return the least and the greatest value that the panel gives PARAMETER, a number."
  (let ((type (parameter-type parameter)))
    (destructuring-bind (&optional least most) (and (consp type) (rest type))
      (values (if (realp least) least (- +largest+))
              (if (realp most) most +largest+)))))

(defun next-value (parameter value direction)
  "Return the value one step from VALUE of PARAMETER, up if DIRECTION is 1 and down if it is -1.
Return NIL if VALUE is at the limit of PARAMETER. T is one step up from NIL."
  (cond ((eq 'boolean (parameter-type parameter))
         (and (eq (plusp direction) (not value)) (list (plusp direction))))
        ;; One that need not be a number is only typed.
        ((not (realp (parameter-default parameter))) nil)
        (t (multiple-value-bind (least most) (parameter-limits parameter)
             (let* ((step (step-size parameter))
                    (next (clamp (* step (+ direction (round (rational value) step)))
                                 least most)))
               (and (plusp (* direction (- next (rational value)))) (list next)))))))

;;; Lines.

(defun exact-value-text (value)
  "Return VALUE of a parameter as the text to type that reads as the same value."
  (if (floatp value)
      (let ((*read-default-float-format* (type-of value))) (princ-to-string value))
      (string-downcase (ars-magna.cli:parameter-value-text value))))

(defun parameter-line-text (parameter value)
  (format nil "params ~A ~A" (parameter-name parameter) (exact-value-text value)))

(defun set-parameter-by-line (pane parameter value)
  (setf (pane-requested pane)
        (acons (parameter-symbol parameter) value
               (remove (parameter-symbol parameter) (pane-requested pane) :key #'car)))
  (run-line-at-prompt (window-conversation (window-of pane))
                      (parameter-line-text parameter value)))

(defun edit-parameter (pane row)
  "Put a line that sets the parameter of ROW into the input line, with the present value to edit."
  (let ((window (window-of pane)))
    (replace-input-line (window-conversation window)
                        (parameter-line-text (parameter-row-parameter row)
                                             (parameter-row-value row)))
    (focus-input-line window)))

;;; What is shown.

(defun parameter-values-in-force (pane)
  (watcher-parameters (window-watcher (window-of pane))))

(defun parameter-rows (pane)
  "Return the rows of PANE: strings, which are headings, and PARAMETER-ROW objects."
  (loop with group = nil
        for parameter in (all-parameters)
        for value across (parameter-values-in-force pane)
        unless (equal group (parameter-group parameter))
          collect (setf group (parameter-group parameter))
        collect (make-parameter-row parameter value)))

(defun forget-fulfilled-requests (pane)
  "Forget the values requested in PANE that have been set, or all if no line runs or waits."
  (setf (pane-requested pane)
        (and (running-line (window-conversation (window-of pane)))
             (let ((values (parameter-values-in-force pane)))
               (loop for parameter in (all-parameters)
                     for value across values
                     for request = (assoc (parameter-symbol parameter) (pane-requested pane))
                     when (and request (not (value-equal value (cdr request))))
                       collect request)))))

(defmethod pane-appearance ((pane parameter-pane))
  (forget-fulfilled-requests pane)
  (let ((simulation (window-simulation (window-of pane))))
    (list (pane-offset pane) (multiple-value-list (pane-size pane)) (live-p simulation)
          (pane-requested pane) (coerce (parameter-values-in-force pane) 'list))))

(defun row-value-or-request (pane row)
  "Return the value of ROW that PANE steps: the value requested last, if it is not set yet, or else
the present value. The second value is true if a line that sets it still waits."
  (let ((request (assoc (parameter-symbol (parameter-row-parameter row)) (pane-requested pane))))
    (if request
        (values (cdr request) t)
        (values (parameter-row-value row) nil))))

(defun step-button (pane row label direction)
  "Return the button of PANE that steps the value of ROW in DIRECTION, 1 or -1; NIL at its limit."
  (let* ((parameter (parameter-row-parameter row))
         (next (next-value parameter (row-value-or-request pane row) direction)))
    (when next
      (make-button label nil (lambda () (set-parameter-by-line pane parameter (first next)))
                   (format nil "Run the line ~A" (parameter-line-text parameter (first next)))))))

(defun set-all-buttons (pane)
  (list (prompt-line-button pane "Clean" "params clean" "Remove all noise: the line params clean")
        (prompt-line-button pane "Default" "params default"
                            "Give all parameters their defaults: the line params default")))

(defun scope-text (simulation)
  "Return a text on the runs that changes of parameters in SIMULATION affect."
  (if (headless-p simulation)
      "Changes affect this run only."
      "Changes affect live and new runs."))

;;; Painting.

(defun draw-step-buttons (canvas pane row x y)
  (loop for (label direction) in '(("-" -1) ("+" 1))
        for left from x by (+ 2 +step-button-width+)
        for button = (step-button pane row label direction)
        when button
          do (draw-button canvas button label nil left (1+ y) +step-button-width+ 14)))

(defun draw-parameter-text (canvas row text grey-p x y)
  "Draw ROW up to X, where its value, TEXT, begins. Draw TEXT in grey if GREY-P. Return nothing."
  (let* ((parameter (parameter-row-parameter row))
         (default (and (row-changed-p row)
                       (format nil "(~A)" (ars-magna.cli:parameter-value-text
                                           (parameter-default parameter)))))
         (left (- x 8 (if default (label-width default) 0))))
    (draw-label canvas 14 (+ y 12) (cut-label (parameter-name parameter) (- left 20)))
    (when default
      (draw-rectangle canvas draw-gcontext* 5 (+ y 6) 5 5 t)
      (with-gcontext (draw-gcontext* :foreground +secondary-text-color+)
        (draw-label canvas left (+ y 12) default)))
    (with-gcontext (draw-gcontext* :foreground (if grey-p +border-color+ black*))
      (draw-label canvas x (+ y 12) text))))

(defun draw-parameter-row (canvas pane row y)
  (let* ((width (content-width pane))
         (buttons (- width 3 (* 2 (+ 2 +step-button-width+)))))
    (multiple-value-bind (value requested-p) (row-value-or-request pane row)
      (with-subject (canvas row)
        (with-gcontext (draw-gcontext* :foreground white*)
          (draw-rectangle canvas draw-gcontext* 0 y width +line-height+ t))
        (draw-parameter-text canvas row (ars-magna.cli:parameter-value-text value) requested-p
                             (- buttons +value-width+) y))
      (draw-step-buttons canvas pane row buttons y))))

(defun draw-panel-row (canvas pane row y)
  (if (stringp row)
      (draw-label canvas 4 (+ y 12) (string-capitalize row :end 1) :bold-p t)
      (draw-parameter-row canvas pane row y)))

(defun draw-panel-head (canvas pane)
  "Draw the part of PANE that does not scroll: what holds now, and buttons that set all."
  (let ((simulation (window-simulation (window-of pane))) (x 4))
    (dolist (button (set-all-buttons pane)) (setf x (+ 5 (draw-plan-button canvas button x 3))))
    (draw-label canvas (+ x 4) 15
                (format nil "now: ~A" (parameters-summary (parameter-values-in-force pane))))
    (with-gcontext (draw-gcontext* :foreground +secondary-text-color+)
      (draw-label canvas 4 35 (scope-text simulation)))))

(defmethod paint ((pane parameter-pane))
  (multiple-value-bind (width height) (pane-size pane)
    (with-pane-canvas (canvas pane)
      (with-clipping (canvas 0 +panel-head-height+ width (max 1 (- height +panel-head-height+)))
        (with-origin (canvas 0 (- (pane-offset pane)))
          (loop for row in (parameter-rows pane)
                for y from +panel-head-height+ by +line-height+
                ;; A row that is partly below the pane would be buttons without a text.
                when (<= (- (+ y +line-height+) (pane-offset pane)) height)
                  do (draw-panel-row canvas pane row y))))
      (draw-panel-head canvas pane))
    (setf (pane-extent pane) (panel-height pane))))

(defun panel-height (pane)
  "Return the height of the complete contents of PANE, in pixels."
  (+ +panel-head-height+ 4 (* +line-height+ (length (parameter-rows pane)))))

;;; The mouse.

(defun panel-subject-at (pane x y)
  "Return the button or row that PANE shows at X, Y, or NIL. Rows are so close together that X, Y
must be inside."
  (subject-at (remove-if-not (lambda (box)
                               (destructuring-bind (left top right bottom) box
                                 (and (<= left x right) (<= top y) (< y bottom))))
                             (pane-subjects pane) :key #'rest)
              x y))

(defmethod hover-text ((pane parameter-pane) x y)
  (let ((subject (panel-subject-at pane x y)))
    (cond (subject (subject-description subject))
          ((< y +panel-head-height+)
           "A click on a parameter puts the line that sets it into the input line")
          (t ""))))

(defmethod handle-click ((pane parameter-pane) button x y)
  (let ((subject (panel-subject-at pane x y)))
    (when (eq button :left)
      (typecase subject
        (button (funcall (button-command subject))
         (repaint-if-changed pane))
        (parameter-row (edit-parameter pane subject))))))
