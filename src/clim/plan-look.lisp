;;;; plan-look.lisp -- images of the plans of a window's run, made in another thread.

(in-package :ars-magna.clim)

;;; The pacer makes the images (watcher.lisp), so neither painting nor ticks wait for them. It looks
;;; only while plans are displayed and have progressed. It reads the plans between two of their
;;; reactions; if they are busy, it tries again later. Plans stand still during a look, so looks
;;; take a tenth of the time at most.

(defconstant +most-plan-rows+ 300 "The largest number of tasks, or of rows of a timeline, to show.")
(defconstant +longest-trace+ 200000
  "The largest number of entries of a trace for which the window draws a timeline.")
(defconstant +pause-per-look+ 9
  "The pause after a look at the plans, as a multiple of the time that the look took.")

(defstruct (plan-look (:constructor make-plan-look ()) (:copier nil))
  "What a window shows of the plans of SIMULATION, and when to look again. VIEW is the display,
:TREE or :TIMELINE. SHOWN-P is a function that returns true while the display is visible. FOLDED
lists the numbers of the tasks with hidden subtasks. MARK is the value of PLANS-STATE-MARK at the
last look. DUE is the time of the next look, in seconds. TREE is an image of the tasks, or NIL. PAGE
is a timeline, :UNTRACED, :TOO-LONG or NIL. ENDED is a text on how the last plan ended, or NIL."
  (simulation nil)
  (view :tree :type (member :tree :timeline))
  (shown-p (constantly nil) :type function)
  (folded '() :type list)
  (mark nil)
  (due 0d0 :type double-float)
  (robot nil)
  (tree nil)
  (page nil)
  (traced-p nil)
  (ended nil :type (or null string)))

(defun plan-interface-of (simulation)
  (and simulation (find-if #'interface-p (simulation-participants simulation))))

(defun plans-traced-p (interface)
  "True if the running plans of INTERFACE, or the next plans if none is running, are traced."
  (let ((runner (and interface (interface-runner interface))))
    (and (or (and runner (runner-trace runner))
             (and *trace-plans* (not (and runner (plan-runner-tasks runner)))))
         t)))

(defun plans-state-mark (look interface)
  "Return a value that represents what LOOK shows of the plans of INTERFACE. Two such values are
EQUAL if LOOK would show the same."
  (let ((runner (and interface (interface-runner interface)))
        (timeline-p (eq :timeline (plan-look-view look))))
    (list (plan-look-simulation look) interface (plan-look-view look) (plan-look-folded look)
          (plans-traced-p interface)
          (and runner (runner-change-mark runner))
          (and runner timeline-p (plan-runner-tasks runner)
               (simulation-tick (plan-look-simulation look))))))

;;; Looking.

;; A plan that has broken, or is stepped, is busy and stands still: only its own thread can read it.
(defun call-while-plans-rest (interface function)
  "Call FUNCTION while the plans of INTERFACE are at rest, or at once if this thread runs their
reactions. Return the value of FUNCTION, or :BUSY if the plans do not come to rest."
  (if (holding-plans-p interface) (funcall function) (participant-at-rest interface function)))

(defun update-plan-timeline (look interface)
  "Store the timeline of the plans of INTERFACE in LOOK. Return NIL if the plans are busy."
  (let* ((runner (interface-runner interface)) (trace (runner-trace runner)))
    (if (null trace)
        (setf (plan-look-page look) :untraced)
        (let ((seen (call-while-plans-rest interface
                                           (lambda () (multiple-value-list (trace-so-far trace))))))
          (unless (eq seen :busy)
            (destructuring-bind (entries count &rest more) seen
              (declare (ignore more))
              (setf (plan-look-page look)
                    (if (> count +longest-trace+)
                        :too-long
                        (let ((bars (bars (funcall entries) (plan-runner-tick runner))))
                          (and bars (make-timeline-page bars +most-plan-rows+))))))
            t)))))

(defun update-plan-tree (look interface)
  "Store the tree of the tasks of INTERFACE in LOOK. Return NIL if the plans are busy."
  (let ((seen (call-while-plans-rest interface
                                     (lambda ()
                                       (image-of-tasks (interface-runner interface)
                                                       :folded (plan-look-folded look)
                                                       :most +most-plan-rows+)))))
    (unless (eq seen :busy)
      (setf (plan-look-tree look) seen)
      t)))

(defun update-plan-view (view look interface)
  "Store the tree or timeline, as VIEW says, in LOOK. Return NIL if the plans are busy."
  (ecase view
    (:tree (update-plan-tree look interface))
    (:timeline (update-plan-timeline look interface))))

(defun update-plan-image (look interface)
  "Store in LOOK the tree or timeline of the plans of INTERFACE, or NIL if INTERFACE is NIL. Return
NIL if the plans are busy."
  (setf (plan-look-robot look) (and interface (participant-robot interface)
                                    (robot-name (participant-robot interface)))
        (plan-look-traced-p look) (plans-traced-p interface))
  (cond ((null interface)
         (setf (plan-look-tree look) nil (plan-look-page look) nil)
         t)
        (t (update-plan-view (plan-look-view look) look interface))))

(defun update-look (look interface mark)
  "Store in LOOK an image of the plans of INTERFACE, and MARK, the value of PLANS-STATE-MARK for
them. Return NIL if the plans are busy, else true."
  (let ((began (seconds-now)))
    (when (update-plan-image look interface)
      (setf (plan-look-mark look) mark
            (plan-look-due look) (+ (seconds-now) (* +pause-per-look+ (- (seconds-now) began))))
      t)))

(defun update-look-if-changed (look)
  "Update LOOK if it is visible and its plans have changed. Return true if LOOK was updated."
  (when (and (funcall (plan-look-shown-p look))
             (plan-look-simulation look)
             (>= (seconds-now) (plan-look-due look)))
    (let* ((interface (plan-interface-of (plan-look-simulation look)))
           (mark (plans-state-mark look interface)))
      (unless (equal mark (plan-look-mark look))
        ;; A plan that does not return blocks the plans of its run. That is reported elsewhere.
        (handler-case (update-look look interface mark)
          (misuse () nil))))))

(defun update-look-of-own-plans (look)
  "Update both views of LOOK at once if this thread runs its plans' reactions. Return true if LOOK
was updated."
  (let ((interface (plan-interface-of (plan-look-simulation look))))
    ;; No other thread can look while the plans stand still. The user may open the display or change
    ;; the view meanwhile; and the display opens by itself only some time after a plan has begun.
    (when (and interface (holding-plans-p interface))
      (update-plan-view (if (eq :tree (plan-look-view look)) :timeline :tree) look interface)
      (update-look look interface (plans-state-mark look interface)))))

;;; Which looks there are, and how plans end.

(defvar *plan-looks* '() "The PLAN-LOOK objects of the open windows.")
(defvar *plan-looks-lock* (make-lock "looks at plans"))

(defun set-look-simulation (look simulation)
  "Make LOOK show the plans of SIMULATION from now on, or no plans if SIMULATION is NIL."
  (with-lock (*plan-looks-lock*)
    (setf (plan-look-simulation look) simulation
          (plan-look-ended look) nil
          *plan-looks* (if simulation
                           (adjoin look *plan-looks*)
                           (remove look *plan-looks*)))))

(defun plan-ending-text (task)
  (format nil "~A ~A at tick ~A~@[: ~A~]" (task-label task)
          (case (task-state task)
            (:succeeded "succeeded") (:failed "failed") (t "was ended"))
          (plan-runner-tick (task-runner task))
          (and (eq :failed (task-state task))
               (cut (one-line (failure-text (task-result task))) 300))))

(defun record-plan-ending (task)
  "Record the end of TASK, a plan, for the windows that show its run. Return NIL, because the
failure of TASK is reported elsewhere."
  (let ((interface (runner-client (task-runner task))))
    (when (and *plan-looks* (interface-p interface))
      (dolist (look (with-lock (*plan-looks-lock*) (copy-list *plan-looks*)))
        (when (eq (plan-look-simulation look) (interface-simulation interface))
          (setf (plan-look-ended look) (plan-ending-text task))))))
  nil)

(add-listener *plan-end-hooks* record-plan-ending)
