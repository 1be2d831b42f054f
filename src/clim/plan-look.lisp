;;;; plan-look.lisp -- what a window knows of the plans of its run: images, made aside.

(in-package :ars-magna.clim)

;;; The pacer makes the images (watcher.lisp): neither the thread that paints nor the one that runs
;;; the ticks waits for that. It looks only where plans are to be seen, and only if they have gone
;;; on since; it takes them as they are between two of their reactions, and if they are at work just
;;; then, comes again. What looking costs, plans stand still for: so that is a tenth of the time at
;;; most.

(defconstant +most-rows+ 300 "How many tasks or rows of a timeline are shown.")
(defconstant +longest-trace+ 200000
  "From how many entries of a trace on no timeline is made of it by itself.")
(defconstant +idleness+ 9 "How many times as long as a look took plans are left alone after it.")

(defstruct (plan-look (:constructor make-plan-look ()) (:copier nil))
  "What is known of the plans of SIMULATION. VIEW is what is to be seen, :TREE or :TIMELINE;
SHOWN-P, a function, says whether anything is. FOLDED are the numbers of the tasks whose parts are
folded away. MARK is what changes when the plans do, as it was at the last look; the next is DUE, in
seconds. TREE is an image, PAGE a timeline, :UNTRACED or :TOO-LONG; both may be NIL. ENDED says in
words how the last plan ended."
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

(defun interface-of (simulation)
  "Return what runs the plans of SIMULATION, or NIL."
  (and simulation (find-if #'interface-p (simulation-participants simulation))))

(defun traced-p (interface)
  "True if a trace is kept of the plans of INTERFACE, or, where none is under way, will be."
  (let ((runner (and interface (interface-runner interface))))
    (and (or (and runner (runner-trace runner))
             (and *trace-plans* (not (and runner (plan-runner-tasks runner)))))
         t)))

(defun plans-mark (look interface)
  "Return what is EQUAL to before if LOOK, at the plans of INTERFACE, would see the same."
  (let ((runner (and interface (interface-runner interface)))
        (timeline-p (eq :timeline (plan-look-view look))))
    (list (plan-look-simulation look) interface (plan-look-view look) (plan-look-folded look)
          (traced-p interface)
          (and runner (runner-mark runner))
          (and runner timeline-p (plan-runner-tasks runner)
               (simulation-tick (plan-look-simulation look))))))

;;; Looking.

;; A plan that has broken, or stops as it is stepped, is at work and stands still: only its own
;; thread can look at it.
(defun call-at-rest (interface function)
  "Call FUNCTION while the plans of INTERFACE are at rest, or as they stand if this thread lets them
react. Return its value; or :BUSY."
  (if (holding-p interface) (funcall function) (participant-at-rest interface function)))

(defun see-timeline (look interface)
  "Let LOOK have the timeline of the plans of INTERFACE. NIL if they are at work just now."
  (let* ((runner (interface-runner interface)) (trace (runner-trace runner)))
    (if (null trace)
        (setf (plan-look-page look) :untraced)
        (let ((seen (call-at-rest interface
                                  (lambda () (multiple-value-list (trace-so-far trace))))))
          (unless (eq seen :busy)
            (destructuring-bind (entries count &rest more) seen
              (declare (ignore more))
              (setf (plan-look-page look)
                    (if (> count +longest-trace+)
                        :too-long
                        (let ((bars (bars (funcall entries) (plan-runner-tick runner))))
                          (and bars (make-page bars +most-rows+))))))
            t)))))

(defun see-tree (look interface)
  "Let LOOK have the tree of the tasks of INTERFACE. NIL if they are at work just now."
  (let ((seen (call-at-rest interface
                            (lambda ()
                              (image-of-tasks (interface-runner interface)
                                              :folded (plan-look-folded look)
                                              :most +most-rows+)))))
    (unless (eq seen :busy)
      (setf (plan-look-tree look) seen)
      t)))

(defun see-plans (look interface)
  "Let LOOK have what it is to see of the plans of INTERFACE, if any. NIL if they are at work."
  (setf (plan-look-robot look) (and interface (interface-robot interface)
                                    (robot-name (interface-robot interface)))
        (plan-look-traced-p look) (traced-p interface))
  (cond ((null interface)
         (setf (plan-look-tree look) nil (plan-look-page look) nil)
         t)
        ((eq :timeline (plan-look-view look)) (see-timeline look interface))
        (t (see-tree look interface))))

(defun look-now (look interface mark)
  "Look at the plans of INTERFACE, of which MARK is what changes. True if they were seen."
  (let ((began (seconds-now)))
    (when (see-plans look interface)
      (setf (plan-look-mark look) mark
            (plan-look-due look) (+ (seconds-now) (* +idleness+ (- (seconds-now) began))))
      t)))

(defun look-at-plans (look)
  "Look at the plans again if they have gone on, and are to be seen. True if something has changed."
  (when (and (funcall (plan-look-shown-p look))
             (plan-look-simulation look)
             (>= (seconds-now) (plan-look-due look)))
    (let* ((interface (interface-of (plan-look-simulation look)))
           (mark (plans-mark look interface)))
      (unless (equal mark (plan-look-mark look))
        ;; A plan that does not return keeps its run's plans, and says so elsewhere.
        (handler-case (look-now look interface mark)
          (misuse () nil))))))

(defun look-as-it-stands (look)
  "Look at the plans as they stand, if this thread is letting them react. True if they were seen."
  (let* ((simulation (plan-look-simulation look)) (interface (interface-of simulation)))
    (and interface
         (holding-p interface)
         (funcall (plan-look-shown-p look))
         (look-now look interface (plans-mark look interface)))))

;;; Which looks there are, and how plans end.

(defvar *plan-looks* '() "The looks of the windows that are open.")
(defvar *plan-looks-lock* (make-lock "looks at plans"))

(defun direct-look (look simulation)
  "Let LOOK be at the plans of SIMULATION, from now on; NIL: at none."
  (with-lock (*plan-looks-lock*)
    (setf (plan-look-simulation look) simulation
          (plan-look-ended look) nil
          *plan-looks* (if simulation
                           (adjoin look *plan-looks*)
                           (remove look *plan-looks*)))))

(defun ending-text (task)
  (format nil "~A ~A at tick ~A~@[: ~A~]" (task-label task)
          (case (task-state task)
            (:succeeded "succeeded") (:failed "failed") (t "was ended"))
          (plan-runner-tick (task-runner task))
          (and (eq :failed (task-state task))
               (cut (one-line (failure-text (task-result task))) 300))))

(defun note-ending (task)
  "Let the windows that show the plans of which TASK is one know how it ended. Return NIL: its
failure is reported elsewhere."
  (let ((interface (runner-client (task-runner task))))
    (when (and *plan-looks* (interface-p interface))
      (dolist (look (with-lock (*plan-looks-lock*) (copy-list *plan-looks*)))
        (when (eq (plan-look-simulation look) (interface-simulation interface))
          (setf (plan-look-ended look) (ending-text task))))))
  nil)

(attend *plan-end-hooks* note-ending)
