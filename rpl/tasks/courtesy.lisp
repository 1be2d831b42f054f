;;;; courtesy.lisp -- letting another task hear something before one goes on.

(in-package :ars-magna.rpl.tasks)

(export '(tell-at-rest))

;;; A task that tells another something by a pulse must not do so before the other waits for it. So
;;; the teller gives way until the hearer rests: until the hearer waits, is over, is kept from
;;; running, or has used its slice.

(defstruct (courtesy (:constructor make-courtesy (hearer teller function)) (:copier nil))
  "That the task TELLER does not go on before FUNCTION has been called, which is when the task
HEARER has come to rest."
  (hearer nil :type task :read-only t)
  (teller nil :type task :read-only t)
  (function nil :type function :read-only t))

(defmethod awaited-text ((courtesy courtesy))
  (format nil "task ~D to hear something" (task-serial (courtesy-hearer courtesy))))

(defun at-rest-p (task runner)
  (case (task-state task)
    (:running nil)
    (:ready (or (spent-p task runner) (blocked-p task)))
    (t (not (courtesy-p (task-awaiting task))))))

(defun tell-at-rest (hearer function)
  "Call FUNCTION, which lets the task HEARER hear something, now, if that is at rest or there is
none. Otherwise do so as soon as it is, and let the task at work give way until then."
  (let* ((runner *runner*)
         (teller (running-task runner)))
    (cond ((or (null hearer) (null teller) (eq hearer teller)
               (not (eq runner (task-runner hearer)))
               ;; Live, answers come in meanwhile, and who gives way could miss its own.
               (funcall (runner-attended-p runner))
               (at-rest-p hearer runner))
           (funcall function))
          (t (settle-all (remove teller (runner-courtesies runner)
                                 :key #'courtesy-hearer :test-not #'eq)
                         runner)
             (setf (runner-courtesies runner)
                   (append (runner-courtesies runner)
                           (list (make-courtesy hearer teller function)))
                   (runner-mask runner) (logior +interrupt+ (runner-mask runner)))))))

(defun give-way-to-hearer (task frame value)
  "Let TASK wait, to go on with FRAME and VALUE, if it has somebody to tell something. True if so."
  (let ((courtesy (find task (runner-courtesies (task-runner task)) :key #'courtesy-teller)))
    (when courtesy
      (park task courtesy)
      (setf (task-frame task) frame
            (task-value task) value))))

(defun settle (courtesy)
  (let ((teller (courtesy-teller courtesy)))
    (call-user-code (courtesy-function courtesy) "what a plan is told")
    (when (eq courtesy (task-awaiting teller))
      (wake teller (task-value teller)))))

(defun settle-all (courtesies runner)
  (when courtesies
    (setf (runner-courtesies runner)
          (remove-if (lambda (courtesy) (member courtesy courtesies)) (runner-courtesies runner)))
    (mapc #'settle courtesies)
    t))

(defun settle-courtesies (runner)
  (settle-all (remove-if-not (lambda (courtesy) (at-rest-p (courtesy-hearer courtesy) runner))
                             (runner-courtesies runner))
              runner))
