;;;; jobs.lisp -- commands that the prompt has issued, and waiting for them.

(in-package :ars-magna.cli)

;;; A command is issued and the prompt returns at once. These wait until the continuation of the
;;; command is called before they read the next line: a patient session, a session with pasted lines
;;; left, and a session in a headless simulation. REPEAT waits in the same way. Tracking a grasp
;;; lasts until the grasp is lost, so only its start is awaited. Plans are jobs, too (plans.lisp).

(defparameter *wait-limit* 100000
  "How many ticks a headless prompt waits for one command to complete.")

(defstruct (job (:constructor make-job (&key name verdict-p resource)) (:copier nil))
  "A command or plan that the prompt has issued. NAME is the name of a line command that issues
several commands, or NIL. VERDICT-P is true if that line command recovers from errors and reports
the outcome itself. RESOURCE is the robot or part that carries out a single command, or NIL."
  (done-p nil)
  ;; It has ended with an error.
  (failed-p nil)
  ;; It is reported separately, as a line had to wait for it.
  (apart-p nil)
  (name nil :type (or null string) :read-only t)
  (verdict-p nil :read-only t)
  (resource nil :read-only t))

;; It belongs to the prompt, even if it leads on from a run.
(define-shared-types job)

(defun waiting-requests ()
  (and *simulation* (timeline-inbox (timeline-of *simulation*))))

(defun job-over-p (job)
  "True if JOB is done, or lasts until something happens, such as the loss of a grip."
  (or (job-done-p job)
      (and (job-resource job)
           (null (waiting-requests))
           (grip-watched-p (job-resource job)))))

(defun end-job (job error-code)
  "Mark JOB as done, with ERROR-CODE, or NIL if it has succeeded."
  (setf (job-failed-p job) (not (member error-code '(nil :interrupt)))
        (job-done-p job) t))

;;; Waiting.

(defun paused-for-good-p (simulation)
  "True if SIMULATION, which is live, is paused, and no one can resume it."
  (and (not *user-can-resume-p*) (paused-without-steps-p simulation)))

(defun await-test-live (test simulation)
  (let ((true (make-semaphore "fact")))
    (flet ((look (simulation)
             (declare (ignore simulation))
             (when (funcall test) (signal-semaphore true))))
      (asking (simulation)
        (add-observer #'look simulation)
        (look simulation))
      (unwind-protect (loop until (or (serve-and-wait-once true 0.2)
                                      ;; The answer to a break may have stopped its clock.
                                      (not (live-p simulation))
                                      (paused-for-good-p simulation)
                                      (simulation-over simulation)))
        (ask-later simulation (lambda () (remove-observer #'look simulation))))))
  (funcall test))

(defun await-test (test)
  "Let time pass until TEST, a function of no arguments, returns true between two ticks. In a
headless simulation, return NIL after *WAIT-LIMIT* ticks."
  (cond ((simulation-over *simulation*) (funcall test))
        ((simulation-gate *simulation*)
         (reject-line "In a trial, time passes between lines only. STEP and RESUME let time pass."))
        ((live-p *simulation*) (await-test-live test *simulation*))
        (t (run-until test :limit *wait-limit* :simulation *simulation*))))

(defgeneric await-job (job)
  (:documentation "Wait until JOB is done; signal BAD-LINE if that takes too many ticks.")
  (:method (job)
    (unless (or (await-test (lambda () (job-over-p job)))
                (paused-for-good-p *simulation*))
      (reject-line "The command has not completed within ~D ticks; it continues." *wait-limit*))))

(defun issue-job (session command resource arguments)
  "Issue COMMAND on RESOURCE with ARGUMENTS. Add a job to SESSION that ends when COMMAND completes."
  (let ((job (make-job :resource resource)) (*caller-passes-ticks-p* t))
    (apply (command-name command) resource
           (append arguments (list (lambda (&optional error-code &rest results)
                                     (declare (ignore results))
                                     (end-job job error-code)))))
    (push job (session-jobs session))))

(defun jobs-under-way (session)
  (remove-if #'job-over-p (session-jobs session)))

(defun await-jobs (session &optional (jobs (session-jobs session)))
  "Wait until JOBS of SESSION, by default all, are done, or until no user can let time pass."
  (unwind-protect (mapc #'await-job (reverse jobs))
    (setf (session-jobs session)
          (if (and *simulation* (paused-for-good-p *simulation*))
              (jobs-under-way session)
              (remove-if (lambda (job) (member job jobs)) (session-jobs session))))))

;;; Lisp may have issued commands too. Plans that it has begun run by themselves: the prompt does
;;; not wait for their commands, which may never end.

(defun issued-outside-plans-p (request)
  (not (request-forked-p request)))

(defun carries-out-command-p (resource)
  "True if RESOURCE, a robot or part, carries out a command that is expected to complete."
  (let ((event (resource-event resource)))
    (and (typep event 'operation) (not (grip-watched-p resource)))))

(defun some-request-p (test)
  "True if a request of the current run, waiting or in progress, passes TEST, a function."
  (flet ((busy-p (resource)
           (and (carries-out-command-p resource) (funcall test (resource-event resource)))))
    (or (some test (timeline-inbox (timeline-of *simulation*)))
        (some (lambda (robot) (some #'busy-p (robot-resources robot)))
              (simulation-robots *simulation*)))))

(defun no-command-pending-p ()
  "True if no command, except those of plans, waits or is in progress in the current simulation."
  (not (some-request-p #'issued-outside-plans-p)))

(defun await-requests (&optional (test #'issued-outside-plans-p))
  "Let time pass, for at most *WAIT-LIMIT* ticks, until no waiting or running request passes TEST.
Return true if no request is left that passes TEST."
  (let ((simulation *simulation*))
    (await-test (lambda () (let ((*simulation* simulation)) (not (some-request-p test)))))))

(defun waits-for-commands-p (session)
  "True if SESSION reads the next line only after the commands issued so far have completed."
  (and *simulation*
       (null (session-trial session))
       ;; A trial that REPLAY-TRIAL repeats has broken.
       (null (simulation-gate *simulation*))
       (null (simulation-over *simulation*))
       (if (live-p *simulation*)
           (and (or (session-patient-p session) (pasted-lines-waiting-p (session-input session)))
                (not (paused-p *simulation*)))
           ;; A simulation stopped by STOP-SIMULATOR waits for RESUME.
           (or (session-patient-p session) (headless-p *simulation*)))))

(defun await-session-commands (session)
  "If SESSION waits for commands before it reads the next line, wait until the commands issued by
SESSION and its Lisp are done."
  (let ((after-rewind (shiftf (session-after-rewind session) nil)))
    (when after-rewind (funcall after-rewind session)))
  (if (waits-for-commands-p session)
      (progn (await-jobs session)
             (setf (session-lisp-p session)
                   (and (shiftf (session-lisp-p session) nil)
                        (null (session-forked-trial session))
                        (not (await-requests))
                        (paused-for-good-p *simulation*)))
             (call-before-line-hooks session))
      (setf (session-jobs session) (jobs-under-way session))))

(defun waits-for-resume-p (session)
  "True if the run of SESSION is live and paused, so that time does not pass."
  (and *simulation*
       (null (session-trial session))
       (live-p *simulation*)
       (paused-without-steps-p *simulation*)))

(defun outcome-of-jobs (jobs lisp-p)
  "Return :OK or :FAILED once JOBS and, with LISP-P, Lisp's requests are done; before that, NIL."
  (cond ((notevery #'job-over-p jobs) nil)
        ((and lisp-p (not (no-command-pending-p))) nil)
        ((some #'job-failed-p jobs) :failed)
        (t :ok)))

(defun lisp-requests-pending-p (session)
  "True if time stands still and Lisp in the running line of SESSION has unfinished requests."
  (let ((account (session-account session)))
    (and (account-text account)
         (waits-for-resume-p session)
         (some-request-p (lambda (request)
                           (asked-by-lisp-of-line-p (request-asker request) account))))))

(defun pending-outcome-function (session)
  "Return NIL if the jobs that SESSION issued last are done. Otherwise return a function that
returns the value of OUTCOME-OF-JOBS for these jobs."
  (let ((jobs (remove-if #'job-apart-p (jobs-under-way session)))
        (lisp-p (lisp-requests-pending-p session)))
    (unless (outcome-of-jobs jobs lisp-p)
      (dolist (job jobs) (setf (job-apart-p job) t))
      (lambda () (outcome-of-jobs jobs lisp-p)))))

(defun unfinished-work-p (session)
  "True if a job or request of SESSION has not ended because time stands still."
  (and *simulation*
       (or (jobs-under-way session)
           (and (session-lisp-p session)
                (waits-for-resume-p session)
                (not (no-command-pending-p))))))

;;; What continues after an interrupted line.

(defun running-command-name (robot)
  (let ((event (and (carries-out-command-p robot) (resource-event robot))))
    (and (typep event 'operation)
         (string-upcase (command-prompt-name (operation-command event))))))

(defun command-in-progress (session)
  "Return the robot that SESSION commands, and the name of the line or command that the robot
carries out; NIL if the robot carries out nothing."
  (let* ((robot (and *simulation* (null (simulation-over *simulation*)) (session-robot)))
         (name (and robot (or (some #'job-name (jobs-under-way session))
                              (running-command-name robot)))))
    (and name (values robot name))))

(defun other-robots-at-work (robot)
  "Return the robots of the current run, except ROBOT, that carry out commands."
  (and *simulation* (not (simulation-over *simulation*))
       (remove-if-not #'running-command-name (remove robot (simulation-robots *simulation*)))))
