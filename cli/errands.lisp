;;;; errands.lisp -- commands to the robot that the prompt has issued, and waiting for them.

(in-package :ars-magna.cli)

;;; At a live prompt a command is issued and the prompt is back at once. A headless simulation, a
;;; batch and REPEAT wait until the command's continuation is called. Tracking a grasp goes on until
;;; the grasp is lost, so nobody waits for that.

(defparameter *patience* 100000
  "How many ticks a headless prompt waits for one command to complete.")

(defvar *waiting-p* nil
  "True while each command is to complete before the next is issued.")

(defparameter *endless-commands* '("HAND-TRACK")
  "Commands that are not expected to complete.")

(defstruct (errand (:constructor make-errand ()) (:copier nil))
  "A command that the prompt has issued."
  (done-p nil))

(defun endless-p (command)
  (find (command-name command) *endless-commands* :test #'same-name-p))

(defun issue-errand (command resource arguments)
  "Issue COMMAND on RESOURCE with ARGUMENTS. Return an errand that is done when it completes."
  (let ((errand (make-errand)))
    (apply (command-name command) resource
           (append arguments (list (lambda (&rest results)
                                     (declare (ignore results))
                                     (setf (errand-done-p errand) t)))))
    errand))

;;; Waiting.

(defun await-live (test simulation)
  (let ((true (make-semaphore "fact")))
    (flet ((look (simulation)
             (declare (ignore simulation))
             (when (funcall test) (signal-semaphore true))))
      (asking (simulation)
        (add-observer #'look simulation)
        (look simulation))
      (unwind-protect (wait-on-semaphore true)
        (asking (simulation) (remove-observer #'look simulation))))))

(defun await (test)
  "Let time pass until TEST, a function of no arguments, returns true between two ticks. Return
NIL if it does not in good time, when nothing but the waiting lets time pass."
  (if (live-p *simulation*)
      (await-live test *simulation*)
      (run-until test :limit *patience* :simulation *simulation*)))

(defun await-errand (errand)
  (unless (await (lambda () (errand-done-p errand)))
    (reject-line "The command has not completed within ~D ticks; it goes on." *patience*)))

(defun send (session command resource arguments)
  "Issue COMMAND on RESOURCE with ARGUMENTS, and wait for it if SESSION waits for commands."
  (let ((errand (issue-errand command resource arguments)))
    (cond ((endless-p command) (unless (live-p *simulation*) (run-ticks 1)))
          ((or *waiting-p* (not (live-p *simulation*))) (await-errand errand))
          (t (setf (session-errands session)
                   (cons errand (remove-if #'errand-done-p (session-errands session))))))))

(defun await-all (session)
  "Wait until all that SESSION has issued is done, unless time stands still."
  (let ((errands (shiftf (session-errands session) '())))
    (when (and errands (live-p *simulation*) (not (paused-p *simulation*)))
      (mapc #'await-errand (reverse errands)))))

;;; Lisp may have issued commands too.

(defun at-work-p (resource)
  "True if RESOURCE, a robot or part, carries out a command that is expected to complete."
  (let ((event (resource-event resource)))
    (and (typep event 'operation) (not (endless-p (operation-command event))))))

(defun robot-at-work-p (robot)
  (or (at-work-p robot)
      (some #'at-work-p (robot-cameras robot))
      (some #'at-work-p (robot-hands robot))
      (some #'at-work-p (robot-bins robot))))

(defun settled-p ()
  "True if no command waits to begin, or goes on, in the current simulation."
  (and (null (simulation-inbox *simulation*))
       (notany #'robot-at-work-p (simulation-robots *simulation*))))

(defun settle (session)
  "If SESSION is a batch, let time pass until no robot carries out a command, within patience."
  (when (and (session-batch-p session) *simulation*)
    (let ((simulation *simulation*))
      (await (lambda () (let ((*simulation* simulation)) (settled-p)))))))
