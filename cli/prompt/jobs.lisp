;;;; jobs.lisp -- commands that the prompt has issued, and waiting for them.

(in-package :ars-magna.cli)

;;; A command is issued and the prompt returns at once. These wait until the continuation of the
;;; command is called before they read the next line: a patient session, a session with pasted lines
;;; left, and a session in a headless simulation. REPEAT waits in the same way. Tracking a grasp
;;; lasts until the grasp is lost, so only its beginning is waited for. Plans are jobs, too: see
;;; plans.lisp.

(defparameter *patience* 100000
  "How many ticks a headless prompt waits for one command to complete.")

(defstruct (job (:constructor make-job (&key name verdict-p resource)) (:copier nil))
  "A command or plan that the prompt has issued. NAME is the name of a line that gives several
commands one after the other, or NIL; VERDICT-P is true if that line recovers from their errors and
reports the outcome itself. RESOURCE is what carries out a single command, or NIL."
  (done-p nil)
  ;; It has ended with an error.
  (failed-p nil)
  ;; It is reported separately, as a line had to wait for it.
  (apart-p nil)
  (name nil :type (or null string) :read-only t)
  (verdict-p nil :read-only t)
  (resource nil :read-only t))

;; It belongs to the prompt, even if it leads on from a run.
(define-shared job)

(defun requests-waiting ()
  (and *simulation* (timeline-inbox (timeline-of *simulation*))))

(defun job-over-p (job)
  "True if JOB is done, or lasts until something happens, such as the loss of a grip."
  (or (job-done-p job)
      (and (job-resource job)
           (null (requests-waiting))
           (grip-watched-p (job-resource job)))))

(defun end-job (job error-code)
  "Mark JOB as done, with ERROR-CODE, or NIL if it has succeeded."
  (setf (job-failed-p job) (not (member error-code '(nil :interrupt)))
        (job-done-p job) t))

;;; Waiting.

(defun held-up-p (simulation)
  "True if SIMULATION, which is live, is paused, and no one can resume it."
  (and (not *waits-while-paused-p*) (stands-still-p simulation)))

(defun await-live (test simulation)
  (let ((true (make-semaphore "fact")))
    (flet ((look (simulation)
             (declare (ignore simulation))
             (when (funcall test) (signal-semaphore true))))
      (asking (simulation)
        (add-observer #'look simulation)
        (look simulation))
      (unwind-protect (loop until (or (wait-a-while true 0.2)
                                      ;; The answer to a break may have stopped its clock.
                                      (not (live-p simulation))
                                      (held-up-p simulation)
                                      (simulation-over simulation)))
        (asking (simulation) (remove-observer #'look simulation)))))
  (funcall test))

(defun await (test)
  "Let time pass until TEST, a function of no arguments, returns true between two ticks. Return NIL
if it does not in time, when only this waiting lets ticks pass."
  (cond ((simulation-over *simulation*) (funcall test))
        ((simulation-gate *simulation*)
         (reject-line "In a trial time passes between lines only. STEP and RESUME let it pass."))
        ((live-p *simulation*) (await-live test *simulation*))
        (t (run-until test :limit *patience* :simulation *simulation*))))

(defgeneric await-job (job)
  (:documentation "Wait until JOB is done; signal BAD-LINE if that takes too many ticks.")
  (:method (job)
    (unless (or (await (lambda () (job-over-p job)))
                (held-up-p *simulation*))
      (reject-line "The command has not completed within ~D ticks; it continues." *patience*))))

(defun send (session command resource arguments)
  "Issue COMMAND on RESOURCE with ARGUMENTS, a job of SESSION that is done when it completes."
  (let ((job (make-job :resource resource)) (*caller-passes-ticks-p* t))
    (apply (command-name command) resource
           (append arguments (list (lambda (&optional error-code &rest results)
                                     (declare (ignore results))
                                     (end-job job error-code)))))
    (push job (session-jobs session))))

(defun jobs-under-way (session)
  (remove-if #'job-over-p (session-jobs session)))

(defun await-jobs (session &optional (jobs (session-jobs session)))
  "Wait until JOBS of SESSION, by default all, are done, or time stands still for good."
  (unwind-protect (mapc #'await-job (reverse jobs))
    (setf (session-jobs session)
          (if (and *simulation* (held-up-p *simulation*))
              (jobs-under-way session)
              (remove-if (lambda (job) (member job jobs)) (session-jobs session))))))

;;; Lisp may have issued commands too. Plans that it has begun run by themselves: the prompt does
;;; not wait for their commands, which may never end.

(defun awaited-p (request)
  (not (request-forked-p request)))

(defun at-work-p (resource)
  "True if RESOURCE, a robot or part, carries out a command that is expected to complete."
  (let ((event (resource-event resource)))
    (and (typep event 'operation) (not (grip-watched-p resource)))))

(defun some-request-p (test)
  "True if TEST, a function, is true of a request of the current run that waits or is carried out."
  (flet ((busy-p (resource)
           (and (at-work-p resource) (funcall test (resource-event resource)))))
    (or (some test (timeline-inbox (timeline-of *simulation*)))
        (some (lambda (robot) (some #'busy-p (robot-resources robot)))
              (simulation-robots *simulation*)))))

(defun settled-p ()
  "True if no command, except those of plans, waits or is in progress in the current simulation."
  (not (some-request-p #'awaited-p)))

(defun await-requests (&optional (test #'awaited-p))
  "Let time pass until no request for which TEST is true waits or is in progress, for *PATIENCE*
ticks at most. True if there is none."
  (let ((simulation *simulation*))
    (await (lambda () (let ((*simulation* simulation)) (not (some-request-p test)))))))

(defun waits-for-commands-p (session)
  "True if SESSION reads the next line only after the commands issued so far have completed."
  (and *simulation*
       (null (session-trial session))
       (null (simulation-over *simulation*))
       (if (live-p *simulation*)
           (and (or (session-patient-p session) (pasted-lines-left-p (session-input session)))
                (not (paused-p *simulation*)))
           ;; A simulation stopped by STOP-SIMULATOR waits for RESUME.
           (or (session-patient-p session) (headless-p *simulation*)))))

(defun catch-up (session)
  "Wait for what SESSION has issued, itself or by Lisp, if SESSION waits for that."
  (let ((after-rewind (shiftf (session-after-rewind session) nil)))
    (when after-rewind (funcall after-rewind session)))
  (if (waits-for-commands-p session)
      (progn (await-jobs session)
             (setf (session-lisp-p session)
                   (and (shiftf (session-lisp-p session) nil)
                        (not (await-requests))
                        (held-up-p *simulation*)))
             (tell-whereabouts session))
      (setf (session-jobs session) (jobs-under-way session))))

(defun waits-for-resume-p (session)
  "True if time does not pass in the run of SESSION, as that is paused."
  (and *simulation*
       (null (session-trial session))
       (live-p *simulation*)
       (stands-still-p *simulation*)))

(defun outcome-of-jobs (jobs lisp-p)
  "Return :OK or :FAILED if JOBS are done and, if LISP-P, what Lisp has issued is; else NIL."
  (cond ((notevery #'job-over-p jobs) nil)
        ((and lisp-p (not (settled-p))) nil)
        ((some #'job-failed-p jobs) :failed)
        (t :ok)))

(defun lisp-goes-on-p (session)
  "True if time stands still and Lisp in the running line of SESSION has unfinished requests."
  (let ((account (session-account session)))
    (and (account-text account)
         (waits-for-resume-p session)
         (some-request-p (lambda (request) (of-lisp-in-line-p (request-asker request) account))))))

(defun end-of-jobs (session)
  "Return NIL if what SESSION has issued last has ended, or if CATCH-UP has not waited for it. Else
return a function that returns what OUTCOME-OF-JOBS does."
  (let ((jobs (remove-if #'job-apart-p (jobs-under-way session)))
        (lisp-p (lisp-goes-on-p session)))
    (unless (outcome-of-jobs jobs lisp-p)
      (dolist (job jobs) (setf (job-apart-p job) t))
      (lambda () (outcome-of-jobs jobs lisp-p)))))

(defun unfinished-p (session)
  "True if something that SESSION or its Lisp has issued has not ended because time stands still."
  (and *simulation*
       (or (jobs-under-way session)
           (and (session-lisp-p session)
                (waits-for-resume-p session)
                (not (settled-p))))))
