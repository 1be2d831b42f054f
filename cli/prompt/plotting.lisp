;;;; plotting.lisp -- quantities that sessions plot: their samples, taken once in each tick.

(in-package :ars-magna.cli)

(export '(plotted-charts plots-mark set-plots-shown follow-plots plotted-names plotter-ticks
          leave-plots continue-plots cut-plotter))

;;; An observer of the run takes the samples, between two ticks. Each run and robot has its own
;;; curves, so curves begin anew in a fork or trial, and continue when the prompt comes back. The
;;; observer removes itself when there is nothing to sample. No thread waits for that.

(defstruct (quantity (:constructor make-quantity
                         (name unit maker &optional user-code-p description))
                     (:copier nil))
  "A quantity that can be plotted. The function MAKER takes the value and the tick from which to
continue, NIL at the beginning. It returns a function of a robot and the present tick that returns
the value. USER-CODE-P is true if that function may signal errors. DESCRIPTION is a text or NIL."
  (name "" :type string :read-only t)
  (unit "" :type string :read-only t)
  (maker nil :type function :read-only t)
  (user-code-p nil :type boolean :read-only t)
  (description nil :type (or null string) :read-only t))

(defstruct (plotted (:constructor make-plotted (quantity series function)) (:copier nil))
  "A quantity that is plotted for a robot of a run. FUNCTION returns its value; NIL after an error."
  (quantity nil :type quantity :read-only t)
  (series nil :type time-series :read-only t)
  (function nil :type (or null function)))

(defstruct (plots (:constructor make-plots (robot &optional plotted)) (:copier nil))
  "What is plotted for the robot named ROBOT of a run. OBSERVER takes the samples; or NIL."
  (robot nil :type symbol :read-only t)
  (plotted '() :type list)
  (observer nil :type (or null function)))

(defstruct (plotter (:copier nil))
  "What a session plots: QUANTITIES, in the order in which the user has chosen them. TICKS is the
number of ticks that charts show, or NIL for all. RUNS is a table from runs to lists of PLOTS. No
samples are taken while SHOWN-P is NIL. LOCK guards the curves and what observers are installed."
  (quantities '() :type list)
  (ticks nil :type (or null (integer 1)))
  (shown-p t :type boolean)
  (runs (make-hash-table :test 'eq :weakness :key :synchronized t) :type hash-table :read-only t)
  (lock (make-lock "plots") :read-only t))

(setf (documentation 'plotter-ticks 'function)
      "Return the number of ticks that plots show, or NIL for all ticks.")

(defun ensure-plotter (session)
  (or (session-plotter session) (setf (session-plotter session) (make-plotter))))

(defun find-plots (plotter simulation robot)
  (find robot (gethash simulation (plotter-runs plotter)) :key #'plots-robot))

(defun ensure-plots (plotter simulation robot)
  (or (find-plots plotter simulation robot)
      (let ((plots (make-plots robot)))
        (push plots (gethash simulation (plotter-runs plotter)))
        plots)))

;;; Samples.

(defconstant +largest-plotted-number+ 1d15 "The largest absolute value that can be plotted.")

(defun plotted-number (value)
  "Return VALUE as a double-float: NIL is 0, and other values that are no numbers are 1."
  (cond ((not (realp value)) (if value 1d0 0d0))
        ((and (finite-p value) (<= (abs value) +largest-plotted-number+))
         (coerce value 'double-float))
        (t (reject-use "The value is ~A. Only numbers up to 1e15 can be plotted"
                       (cut (princ-to-string value) 40)))))

(defun call-plotted-function (plotted robot tick)
  "Return the value of PLOTTED at TICK as a double-float. Return NIL after an error, and report it."
  (let ((quantity (plotted-quantity plotted)) (number nil))
    (flet ((compute ()
             (setf number (plotted-number (funcall (plotted-function plotted) robot tick)))))
      (if (quantity-user-code-p quantity)
          (call-user-code #'compute (list "the plot of " (quantity-name quantity)))
          (compute)))
    number))

(defun end-curve (plotted)
  "Take no more samples of PLOTTED, because of an error, and say so."
  (setf (plotted-function plotted) nil)
  (let ((name (quantity-name (plotted-quantity plotted))))
    (message-set "The curve of " name " ends here. PLOT " name " off removes it")))

(defun take-sample (plotted robot tick lock)
  (let ((number (call-plotted-function plotted robot tick)))
    (if number
        (with-lock (lock) (add-sample (plotted-series plotted) tick number))
        (end-curve plotted))))

(defun take-samples (plots simulation lock)
  (let ((robot (find (plots-robot plots) (simulation-robots simulation) :key #'robot-name)))
    (when robot
      (dolist (plotted (plots-plotted plots))
        (when (plotted-function plotted)
          (take-sample plotted robot (simulation-tick simulation) lock))))))

(defun sampling-wanted-p (plotter plots)
  (and (plotter-shown-p plotter) (plots-plotted plots) t))

(defun stop-sampling-if-unwanted (plotter plots observer simulation)
  (when (with-lock ((plotter-lock plotter))
          (unless (sampling-wanted-p plotter plots)
            (setf (plots-observer plots) nil)
            t))
    (remove-observer observer simulation)))

(defun make-sampling-observer (plotter plots)
  (let ((observer nil))
    (setf observer (lambda (simulation)
                     (if (sampling-wanted-p plotter plots)
                         (take-samples plots simulation (plotter-lock plotter))
                         (stop-sampling-if-unwanted plotter plots observer simulation))))))

;;; What is sampled.

(defun begin-to-plot (quantity index)
  (make-plotted quantity
                (make-time-series (quantity-name quantity) (quantity-unit quantity) index
                                  (one-line (or (quantity-description quantity) "")))
                (funcall (quantity-maker quantity) nil nil)))

(defun unused-index (plotted)
  "Return the smallest number, from 0, that is not the index of a curve of PLOTTED."
  (loop for index from 0
        unless (find index plotted :key (lambda (one) (time-series-index (plotted-series one))))
          return index))

(defun update-plotted (plots quantities)
  "Make PLOTS plot QUANTITIES. Return true if some of them were not plotted before."
  (let* ((old (plots-plotted plots)) (new-p nil)
         (kept (remove-if-not (lambda (plotted) (member (plotted-quantity plotted) quantities))
                              old))
         (all kept))
    (dolist (quantity quantities)
      (unless (find quantity kept :key #'plotted-quantity)
        (setf all (append all (list (begin-to-plot quantity (unused-index all))))
              new-p t)))
    (setf (plots-plotted plots) all)
    new-p))

(defun install-observer (plotter plots)
  "Return a new observer that PLOTS needs, or NIL if it needs none. The caller holds the lock."
  (and (sampling-wanted-p plotter plots)
       (null (plots-observer plots))
       (setf (plots-observer plots) (make-sampling-observer plotter plots))))

(defun follow-plots (session simulation robot)
  "Take samples of what SESSION plots in SIMULATION, for the robot named ROBOT."
  (let ((plotter (session-plotter session)))
    (when (and plotter simulation (not (simulation-over simulation))
               (or (plotter-quantities plotter) (find-plots plotter simulation robot)))
      (multiple-value-bind (plots new-p observer)
          (with-lock ((plotter-lock plotter))
            (let ((plots (ensure-plots plotter simulation robot)))
              (values plots
                      (update-plotted plots (plotter-quantities plotter))
                      (install-observer plotter plots))))
        (when (or new-p observer)
          (asking (simulation)
            (when observer (add-observer observer simulation))
            (when (plotter-shown-p plotter)
              (take-samples plots simulation (plotter-lock plotter)))))))))

(defun name-of-robot-commanded ()
  "Return the name of the robot that the prompt commands, or NIL if there is none."
  (let ((robot (and *simulation* (or (robot-of-prompt) (first (simulation-robots *simulation*))))))
    (and robot (robot-name robot))))

(defun update-plots (session)
  "Take samples of what SESSION plots in the present run."
  (follow-plots session *simulation* (name-of-robot-commanded)))

(defun set-plots-shown (session shown-p)
  "Take samples of what SESSION plots only if SHOWN-P. After this, FOLLOW-PLOTS starts again."
  (setf (plotter-shown-p (ensure-plotter session)) (and shown-p t)))

(defun stop-plotting (session)
  "Take no more samples for SESSION, which may be over."
  (when (and (session-over-p session) (session-plotter session)) (set-plots-shown session nil)))

;;; A rewind cuts the curves.

(defun cut-plotted (plotted tick)
  (let ((curve (plotted-series plotted)))
    (cut-time-series curve tick)
    (when (plotted-function plotted)
      (setf (plotted-function plotted)
            (multiple-value-bind (last value) (last-sample curve)
              (funcall (quantity-maker (plotted-quantity plotted)) value (and last tick)))))))

(defun cut-plotter (plotter old new)
  "Let the curves of PLOTTER in the run OLD continue in NEW, which has replaced OLD."
  (let ((plots (gethash old (plotter-runs plotter))))
    (when plots
      (with-lock ((plotter-lock plotter))
        (dolist (each plots)
          (dolist (plotted (plots-plotted each)) (cut-plotted plotted (simulation-tick new)))))
      (remhash old (plotter-runs plotter))
      (setf (gethash new (plotter-runs plotter)) plots))))

(defun cut-plots (old new)
  "Let the curves of the run OLD continue in NEW, which has replaced OLD."
  (dolist (plotter (remove nil (mapcar #'session-plotter (running-sessions))))
    (cut-plotter plotter old new)))

(add-listener *rewind-hooks* cut-plots)

;;; The session of a window ends with the window. The next window of its robot continues the curves.

(defun leave-plots (session)
  "Take no more samples for SESSION. Return what it plots, for CONTINUE-PLOTS, or NIL."
  (when (session-plotter session)
    (set-plots-shown session nil)
    (session-plotter session)))

(defun plots-of-robot (plotter robot)
  "Return a list of lists (run plots) for the robot named ROBOT. The plots have no observers."
  (let ((all '()))
    (maphash (lambda (run list)
               (let ((plots (find robot list :key #'plots-robot)))
                 (when plots (push (list run (make-plots robot (plots-plotted plots))) all))))
             (plotter-runs plotter))
    all))

(defun continue-plots (session plotter robot)
  "Let SESSION plot what PLOTTER, a value of LEAVE-PLOTS, has plotted. Continue its curves of the
robot named ROBOT. No samples are taken before FOLLOW-PLOTS is called."
  (let ((next (make-plotter :quantities (plotter-quantities plotter)
                            :ticks (plotter-ticks plotter)
                            ;; An observer of PLOTTER may still be at work.
                            :lock (plotter-lock plotter))))
    (loop for (run plots) in (plots-of-robot plotter robot)
          do (setf (gethash run (plotter-runs next)) (list plots)))
    (setf (session-plotter session) next)))

;;; What is shown.

(defun current-plotted (session simulation robot)
  "Return what SESSION plots in SIMULATION for the robot named ROBOT."
  (let* ((plotter (session-plotter session))
         (plots (and plotter (find-plots plotter simulation robot))))
    (and plots (plots-plotted plots))))

(defun plotted-names (session)
  "Return the names of the quantities that SESSION plots."
  (and (session-plotter session)
       (mapcar #'quantity-name (plotter-quantities (session-plotter session)))))

(defun end-of-curve-text (plotted)
  "Return a text that says where PLOTTED ended after an error, or NIL."
  (and (null (plotted-function plotted))
       (format nil "ended~@[ at tick ~D~] by an error" (last-sample (plotted-series plotted)))))

(defun plots-mark (session simulation robot)
  "Return a value that represents the plots of SESSION in SIMULATION for the robot named ROBOT. It
is EQUAL to an earlier value if they look the same."
  (let ((all (current-plotted session simulation robot)))
    (and all
         (with-lock ((plotter-lock (session-plotter session)))
           (list (plotter-ticks (session-plotter session))
                 (loop for plotted in all
                       collect (list (plotted-series plotted) (last-sample (plotted-series plotted))
                                     (end-of-curve-text plotted))))))))

(defun plotted-charts (session simulation robot width)
  "Return charts, WIDTH pixels wide, of what SESSION plots in SIMULATION for the robot named ROBOT."
  (let ((all (current-plotted session simulation robot)) (plotter (session-plotter session)))
    (and all
         (with-lock ((plotter-lock plotter))
           (collect-time-charts
            (mapcar #'plotted-series all) width
            :from (if (plotter-ticks plotter)
                      (max 0 (- (simulation-tick simulation) (plotter-ticks plotter)))
                      0)
            :notes (lambda (curve)
                     (end-of-curve-text (find curve all :key #'plotted-series))))))))
