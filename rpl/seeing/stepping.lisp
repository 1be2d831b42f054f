;;;; stepping.lisp -- stopping plans in the debugger: at failures, or at each expression.

(in-package :ars-magna.rpl.seeing)

(export '(plan-break-p))

;;; A break is no error. Without an interactive debugger it is a message, and the plan goes on.

(addition plan-break plan-break-task)
(define-condition plan-break (condition)
  ((text :initarg :text :reader plan-break-text)
   (task :initarg :task :reader plan-break-task)
   (frame :initarg :frame :reader plan-break-frame))
  (:report (lambda (break stream) (write-break break stream)))
  (:documentation "A plan has stopped in the debugger: at a failure, or to be stepped through."))

(defun plan-break-p (object)
  "True if OBJECT is a PLAN-BREAK condition."
  (typep object 'plan-break))

(setf (documentation 'plan-break-task 'function)
      "Return the task that stopped.")

(defparameter *longest-stack* 12 "The largest number of expressions of a plan that a break shows.")

(defun write-break (break stream)
  (let ((task (plan-break-task break)))
    (format stream "~A~%  in task ~{~A~^ > ~}, at tick ~D"
            (plan-break-text break) (task-path task) (runner-tick (task-runner task)))
    (loop for form in (plan-backtrace task (plan-break-frame break))
          repeat *longest-stack*
          do (format stream "~%    ~A" (form-text form 70)))
    (loop for (name value) in (frame-variables (plan-break-frame break))
          repeat *longest-stack*
          do (format stream "~%    ~(~A~) = ~A" name (form-text value 70)))))

(defun enter-break (break)
  "Enter the debugger for BREAK, if a debugger is available. Return when the plan is to go on."
  (if (debugger-available-p)
      (invoke-debugger break)
      (message-set "Break: " (printable-report break))))

;;; Where plans fail.

(addition *break-on-plan-failures*)
(defvar *break-on-plan-failures* nil
  "Which failures enter the debugger where they happen, even if the plan handles the failure. The
value is T for all failures, a class of failures as in HANDLE-FAILURE, a list of classes, or NIL for
none. Without an interactive debugger, such failures are messages.")

(defun break-wanted-p (failure)
  (let ((types *break-on-plan-failures*))
    (and types
         (some (lambda (type)
                 (and (typep type '(or symbol cons)) (failure-matches-p failure type)))
               (if (and (consp types) (not (eq 'or (first types)))) types (list types))))))

(defun break-if-wanted (failure task frame)
  (when (break-wanted-p failure)
    (with-simple-restart (continue "Let the failure happen.")
      (enter-break (make-condition 'plan-break :text (printable-report failure) :task task
                                                :frame frame)))))

(add-listener *failure-hooks* break-if-wanted)

;;; A runner with plans to be stepped has a STEPPER, which is called before each step of any of its
;;; tasks (see INSTRUMENTED-STEP); other runners cost nothing. Only steps that begin an expression
;;; count. Leaves have no steps of their own: a stop comes before those that are steps of a body.

(addition *step-plans*)
(defvar *step-plans* nil
  "If true, plans that start from now on stop before each expression: see STEP-TASK.")

(defstruct (stepping-course (:constructor make-stepping-course (task)) (:copier nil))
  "How TASK is stepped through. MODE is :run, :step (stop before any expression) or :over. In the
mode :over, the task WITHIN runs until it returns to the frame UNTIL; if UNTIL is :NEXT, until its
next expression; if UNTIL is NIL, until the task is over."
  (task nil :type task :read-only t)
  (mode :step :type (member :step :over :run))
  (within nil :type (or null task))
  (until nil :type (or null frame (eql :next))))

(defgeneric next-form (node frame)
  (:documentation "Return the expression that the next step of FRAME, a frame of NODE, begins, and
true if it is a leaf. Return NIL if it begins none, or an expression that has its own step.")
  (:method (node frame)
    (if (and (zerop (frame-counter frame)) (null (frame-data frame)))
        (values (node-form node) nil)
        nil))
  (:method ((node steps) frame)
    (let* ((parts (steps-parts node))
           (part (svref parts (min (frame-counter frame) (1- (length parts))))))
      (if (leaf-p part)
          (values (node-form part) t)
          nil))))

(defun note-frame-return (course task frame)
  "If TASK, about to take a step at FRAME, has returned to the frame UNTIL of COURSE, record this."
  (let ((until (stepping-course-until course)))
    (when (and (frame-p until)
               (eq task (stepping-course-within course))
               (not (member until (rest (frame-chain frame)))))
      (setf (stepping-course-until course) :next))))

(defun stop-wanted-p (course task)
  (ecase (stepping-course-mode course)
    (:run nil)
    (:step t)
    (:over (or (task-over-p (stepping-course-within course))
               (and (eq task (stepping-course-within course))
                    (eq :next (stepping-course-until course)))))))

(defun resume-stepping (course mode &optional task until)
  (setf (stepping-course-mode course) mode
        (stepping-course-within course) task
        (stepping-course-until course) until))

(document-restarts
 'step "In a plan that is being stepped: do this, and stop before the next expression."
 'next "In a plan that is being stepped: do all of this, and stop before the next expression of
this task."
 'out "In a plan that is being stepped: finish what this is a part of, and stop after that.")

(defun stop-at (course task frame form leaf-p)
  (restart-case
      (progn (enter-break (make-condition 'plan-break
                                          :task task :frame frame
                                          :text (format nil "Next: ~A" (form-text form 70))))
             (resume-stepping course :run))       ; without a debugger
    (continue ()
      :report "Go on without stopping."
      (resume-stepping course :run))
    (step ()
      :report "Do this, and stop before the next expression."
      (resume-stepping course :step))
    (next ()
      :report "Do all of this, and stop before the next expression of this task."
      (resume-stepping course :over task (if leaf-p :next (frame-up frame))))
    (out ()
      :report "Finish what this is a part of, and stop after that."
      (let ((outer (if leaf-p frame (frame-up frame))))
        (resume-stepping course :over task (and outer (frame-up outer)))))))

(defun stop-if-wanted (courses task frame)
  (let ((course (some (lambda (whole) (find whole courses :key #'stepping-course-task))
                      (lineage task))))
    (when course
      (note-frame-return course task frame)
      (multiple-value-bind (form leaf-p) (next-form (frame-node frame) frame)
        (when (and form (stop-wanted-p course task))
          (stop-at course task frame form leaf-p))))))

;;; Which tasks are stepped through.

(defun stepping-courses (runner)
  (and (runner-stepper runner)
       (remove-if #'task-over-p (funcall (runner-stepper runner) nil nil)
                  :key #'stepping-course-task)))

(addition step-task)
(defun step-task (task &optional (on t))
  "From now on, stop before each expression of TASK and its parts. If ON is NIL, no longer stop. A
stop enters the debugger; its restarts STEP, NEXT, OUT and CONTINUE say how far to run. Without an
interactive debugger, a stop is a message, and the task goes on. Returns nothing."
  (check-argument step-task task (task-p task) "a task, as begin-plan returns")
  (let* ((runner (task-runner task))
         (others (remove task (stepping-courses runner) :key #'stepping-course-task))
         (courses (if on (cons (make-stepping-course task) others) others)))
    (setf (runner-stepper runner)
          (and courses
               (lambda (task frame)
                 (if task (stop-if-wanted courses task frame) courses))))
    (values)))

(defun step-if-wanted (task)
  (when *step-plans* (step-task task)))

(add-listener *plan-start-hooks* step-if-wanted)
