;;;; wishes.lisp -- what a plan's task wants done while all plans rest, such as a fork of the run.

(in-package :ars-magna.rpl-robot)

(export '(wish serve-wish add-wish forget-wish grant-wish wishes-in-tick fork-at-rest
          unwanted-wish-p call-apart))

;;; A run cannot be forked at a plan's own step: what that is about to do is on Lisp's stack. So a
;;; task that wants it done leaves a wish, waits, and goes on in the same tick with what came of it.
;;; Wishes are served one at a time, the oldest first, when the reaction has come to rest; after
;;; each the plans react anew. What a wish is about is in the wish, so that a fork has its twin.

(define-record wish
  "What TASK of INTERFACE waits for; without a task, what somebody outside wants of a fork."
  (task nil (or null task)
        "the task that waits for the wish to be served, or NIL if none does" :export)
  (interface nil (or null interface) "the interface that has the wish" :export))

(defgeneric serve-wish (wish)
  (:documentation "Do what WISH is about and let its task go on by GRANT-WISH. Called while all
plans of its interface rest. An error lets the task fail. Return :LATER if nothing has become of
it."))

(defconstant +most-wishes+ 100
  "How many wishes are served in a tick. A plan that wishes without end is not to stop time.")

(defun add-wish (wish)
  "Let WISH be served when the plans, which the caller holds, rest."
  (let ((interface (wish-interface wish)))
    (setf (interface-wishes interface) (append (interface-wishes interface) (list wish)))))

(defun forget-wish (wish)
  "Let WISH no longer be one of its interface, as if it had never been."
  (removef (interface-wishes (wish-interface wish)) wish))

(defmethod withdraw (task (wish wish))
  (declare (ignore task))
  (forget-wish wish))

(defun grant-wish (wish value)
  "Let the task of WISH go on with VALUE. The caller holds the plans."
  (forget-wish wish)
  (at-home ((interface-runner (wish-interface wish)))
    (complete (wish-task wish) value)))

(defun refuse-wish (wish condition)
  (let ((task (wish-task wish)))
    (forget-wish wish)
    (at-home ((interface-runner (wish-interface wish)))
      (decide task (failure-of condition task (task-frame task))))))

(defun wishes-in-tick (interface)
  "Return how many wishes of INTERFACE have been served in this tick."
  (let ((tick (simulation-tick (interface-simulation interface))))
    (unless (eql tick (interface-wish-tick interface))
      (setf (interface-wish-tick interface) tick
            (interface-wishes-served interface) 0))
    (interface-wishes-served interface)))

(defun wish-to-serve (interface)
  "Return the oldest wish of INTERFACE whose task could go on, or NIL."
  (find-if (lambda (wish)
             (let ((task (wish-task wish)))
               (and task (not (blocked-p task)))))
           (interface-wishes interface)))

(defun serve-next (interface)
  "Serve a wish of INTERFACE if there is one, and time need not pass first. True if its task goes
on."
  (let ((wish (wish-to-serve interface)))
    (when (and wish
               (not (interface-closing-p interface))
               (< (wishes-in-tick interface) +most-wishes+))
      (let ((answer (handler-case (serve-wish wish)
                      (error (condition) (refuse-wish wish condition)))))
        (incf (interface-wishes-served interface))
        (not (eq answer :later))))))

(defun react-and-serve (interface)
  "Let the plans of INTERFACE react and serve their wishes until neither goes on. Return :IDLE, or
:BUDGET if what is left must wait for a tick."
  (loop
    (let ((outcome (react-to-all (interface-runner interface))))
      (unless (serve-next interface)
        (return (if (wish-to-serve interface) :budget outcome))))))

;;; What those who serve need.

(defun fork-at-rest (interface)
  "Return a fork of the simulation of INTERFACE, whose plans rest and are held by the caller."
  (in-any-case
    (progn (setf (interface-resting-p interface) t)
           (fork-simulation (interface-simulation interface)))
    (setf (interface-resting-p interface) nil)))

(defun unwanted-wish-p (wish)
  "True if nobody waits for what comes of WISH any more: its plan is to end, or all is over."
  (let* ((interface (wish-interface wish)) (task (wish-task wish))
         (simulation (interface-simulation interface)))
    (or (interface-closing-p interface)
        (and (simulation-over simulation) t)
        (and (thread-of interface) (not (live-p simulation)))
        (and task (member (task-top task) (interface-unwanted interface)) t))))

(defun call-apart (function)
  "Call FUNCTION as if no plan were at work around it."
  (let ((*reacting* nil) (*held* '()) (*asker* nil))
    (funcall function)))
