;;;; other-runs.lisp -- REWIND, TRIAL and FORK: continuing in another run.

(in-package :ars-magna.cli)

;;; A rewind replaces the running plans. The prompt drops the old ones without a message and waits
;;; for the new ones, also when the rewind comes from Lisp.

(defun forget-plan-jobs (old new)
  "Stop reporting to prompts how the plans of the run OLD end, because the run NEW replaces OLD."
  (declare (ignore new))
  (dolist (job (with-lock (*plan-jobs-lock*)
                 (remove old *plan-jobs* :key #'plan-job-simulation :test-not #'eq)))
    (setf (plan-job-forgotten-p job) t
          (session-after-rewind (plan-job-session job)) #'adopt-plans)))

(add-listener *rewind-hooks* forget-plan-jobs)

;; The end of a trial is on the stack, so a trial is not rewound, but run again. Its programs go on.
(defun repeat-trial (session trial tick)
  "Open TRIAL again, and let TICK ticks pass, without messages from programs."
  (let ((again (make-open-trial (open-trial-experiment trial) (open-trial-condition trial)
                                (open-trial-number trial) (open-trial-directory trial)))
        (quiet-p (shiftf (session-quiet-p session) t)))
    (setf (open-trial-rate again) (open-trial-rate trial)
          (open-trial-steps again) tick
          (open-trial-stepped-p again) t
          (open-trial-restore again) (lambda () (setf (session-quiet-p session) quiet-p)))
    (leave-open-trial session (lambda () (run-trial-in-session session again)))))

(defun rewind-trial (session trial tick)
  (let ((changed (open-trial-changed trial)))
    (when (minusp tick)
      (reject-line "This trial is at tick ~D. Give at most that many ticks."
                   (simulation-tick *simulation*)))
    (when (and changed (< changed tick))
      (reject-line "The run was changed at tick ~D. Go back to that tick, or before it." changed))
    (repeat-trial session trial tick)))

(defun rewind-to-tick (session tick)
  (if (session-trial session)
      (rewind-trial session (session-trial session) tick)
      (rewind-and-report session (- (simulation-tick *simulation*) tick))))

(defun rewind-and-report (session ticks)
  (let ((tick (- (simulation-tick *simulation*) ticks)))
    (rewind ticks)
    ;; No session waits for commands that are in progress again.
    (setf (session-after-rewind session) nil
          (session-lisp-p session) t)
    (adopt-plans session)
    (tell-other-sessions session *simulation*
                         (format nil "Another prompt has rewound the run to tick ~D.~%" tick))
    (format t "~A~@[ Plans under way: ~{~A~^, ~}.~]~%"
            (time-description session *simulation* tick) (mapcar #'task-label (plans)))))

(define-line "REWIND" (session (n tick-span "how far"))
    (:running)
    "Go back N ticks and continue from there, plans included. REWIND 0 undoes changes since the last
tick. Later ticks are discarded; the journal records the rewind. Continuations waiting for a
command, such as that of GO-TO, receive :INTERRUPT. In a trial, programs go on, too: the trial is
run again, up to that tick."
  (check-run-not-over)
  (rewind-to-tick session (- (simulation-tick *simulation*) n)))

(define-line "REWIND-TO" (session (tick count "the tick to go back to"))
    (:running)
    "Go back to the end of TICK and continue from there, as with REWIND."
  (check-run-not-over)
  (let ((now (simulation-tick *simulation*)))
    (unless (<= tick now) (reject-line "This run is at tick ~D. Give an earlier tick." now))
    (rewind-to-tick session tick)))

;;;; TRIAL

(defun open-trial-name (trial)
  (format nil "trial ~D of ~(~A~), ~A" (open-trial-number trial)
          (experiment-name (open-trial-experiment trial))
          (condition-name (open-trial-condition trial))))

(defun write-fitted-line (session control &rest arguments)
  (format t "~&~A~%" (fit-to-window (apply #'format nil control arguments)
                                    (session-console session))))

(defun write-open-trial (session trial)
  (write-fitted-line session "~@(~A~).~%~A" (open-trial-name trial)
                     (time-description session *simulation*))
  (when (open-trial-changed trial)
    (write-fitted-line session "The run was changed at tick ~D and no longer shows the experiment."
                       (open-trial-changed trial))))

;;; Its end.

(defun measures-text (trial result)
  (format nil "~:{~(~A~) ~A~:^, ~}"
          (loop for (name value) in (measure-values (open-trial-experiment trial) result)
                collect (list name (case value ((t) "yes") ((nil) "no") (:none "none")
                                     (t (format-briefly nil "~A" value)))))))

(defun write-trial-result (session trial result)
  (write-fitted-line session "The trial is over at tick ~D: ~A~@[ (~A)~].~@[ ~A.~]"
                     (result-ticks result)
                     (result-outcome result)
                     (and (string/= "" (result-reason result)) (result-reason result))
                     (let ((text (measures-text trial result))) (and (string/= "" text) text)))
  (when (string/= "" (result-error result))
    (write-fitted-line session "The error of the trial: ~A"
                       (short-error-text (result-error result))))
  (when (open-trial-changed trial)
    (write-fitted-line session
                       "This is not the experiment's result: the run was changed at tick ~D."
                       (open-trial-changed trial))))

(defun read-lines-after-trial (session trial result parts row)
  "After the end of TRIAL with RESULT, read lines of SESSION until a line leaves the trial. ROW is
the stored row to compare with RESULT, or NIL; PARTS are the parts of the row's fingerprint."
  (setf (open-trial-result trial) result)
  (pause-trial trial)
  (call-outside-trial (lambda ()
                        (show-messages session)
                        (write-trial-result session trial result)
                        (when row
                          (write-fitted-line session
                                    "~:[The result equals its row.~;~
                                     ~:*The result differs from its row: ~{~A~^; ~}.~]"
                                    (row-differences (open-trial-experiment trial) result parts row
                                                     (open-trial-directory trial))))))
  (loop (run-line-in-trial session trial)))

;;; Going there, and out again.

(defun pause-at-next-tick (session trial restart)
  "Pause TRIAL at its next tick. Until then, continue the interrupted code by RESTART."
  (pause-trial trial)
  (setf (open-trial-interrupted-p trial) t)
  (write-fitted (session-console session)
                "Interrupted: the trial pauses at its next tick. Control-C leaves it.~%")
  (finish-output (session-console session))
  (invoke-restart restart))

(defun call-with-pause-on-interrupt (session trial function)
  "Call FUNCTION. While ticks pass in TRIAL, Control-C at the terminal of SESSION pauses the trial
at the next tick. A second Control-C before that tick leaves the trial."
  (flet ((pause-or-leave (condition)
           (let ((restart (find-restart 'go-on condition)))
             (if (and restart (session-terminal-p session) (not (open-trial-interrupted-p trial)))
                 (pause-at-next-tick session trial restart)
                 (setf (open-trial-left-p trial) t)))))
    (handler-bind ((user-interrupt #'pause-or-leave))
      (funcall function))))

(defun run-open-trial (session trial)
  (let* ((experiment (open-trial-experiment trial))
         (condition (open-trial-condition trial))
         (number (open-trial-number trial))
         (directory (open-trial-directory trial))
         (parts (and directory (prepare-condition experiment condition)))
         (row (and directory (row-of-trial experiment condition number directory)))
         (*trace-plans* t)
         ;; An asker of no line: what goes wrong later is told with the line that runs then.
         (*asker* (copy-seq +prompt-asker+))
         (*request-origin* *asker*))
    (rerun-trial experiment condition number
                 :journal t
                 :gate (make-trial-gate session trial)
                 :then (lambda (result) (read-lines-after-trial session trial result parts row)))))

(defun call-with-run-paused (function)
  "Pause the current live simulation, if any, while calling FUNCTION."
  (let ((simulation *simulation*))
    (if (and simulation (live-p simulation) (not (paused-p simulation)))
        (unwind-protect (progn (pause simulation) (funcall function))
          (resume simulation))
        (funcall function))))

(defun enter-trial (session trial)
  "Run TRIAL in SESSION until a line leaves the trial. Return a function to call afterwards."
  (let ((*prompt-robot* nil) (left-p nil))
    (setf (session-trial session) trial)
    (unwind-protect
         (prog1 (catch 'left-trial
                  (call-with-pause-on-interrupt session trial
                                                (lambda () (run-open-trial session trial)))
                  #'values)
           (setf left-p t))
      (setf (session-trial session) nil)
      (call-restore trial)
      (abandon-jobs session)
      (import-robot-names (current-robot-names))
      (unless left-p (format (session-console session) "~&The trial has been left.~%")))))

(defun abandon-jobs (session)
  (dolist (job (shiftf (session-jobs session) '()))
    (when (plan-job-p job) (close-job job))))

(defun run-trial-in-session (session trial)
  "Run TRIAL in SESSION, with the session's own run paused, and what follows on it."
  (funcall (call-with-run-paused (lambda () (enter-trial session trial)))))

(defun open-trial-in-session (session trial)
  (flet ((enter ()
           (write-fitted-line session "~@(~A~): seed ~D, at most ~D ticks. STEP and RESUME let ~
                                       time pass, TRIAL OFF leaves it."
                     (open-trial-name trial)
                     (trial-seed (open-trial-experiment trial) (open-trial-number trial))
                     (experiment-limit (open-trial-experiment trial)))
           (unless (can-poll-input-p session) (setf (open-trial-rate trial) :free))
           (run-trial-in-session session trial)))
    (call-after-leaving-trial session #'enter)))

(defun leave-trial (session)
  (unless (session-trial session) (reject-line "The prompt is not in a trial."))
  (leave-open-trial session
                    (lambda () (format t "You have left the trial~@[ for ~(~A~)~].~%"
                                       (and *simulation* (simulation-name *simulation*))))))

(define-line "TRIAL" (session (name :experiment "an experiment or testbed, or OFF" :optional)
                              (condition :token "the number of a condition, or a part of its name"
                                         :optional)
                              (number count "the number of the trial" :optional)
                              (directory :token "the directory of its row" :optional))
    (:running)
    "Enter a trial of an experiment, at tick 0, exactly as the experiment runs the trial. Of a
testbed, CONDITION is AGENT or AGENT,KNOB=VALUE, as in TRIAL tileworld bold,dynamism=64 1. STEP,
RESUME and RATE let time pass; STATUS, PLAN-TREE, WHY and others show the state; SAVE-JOURNAL saves
the run. Without a terminal, RESUME runs the trial to its end. With DIRECTORY, the outcome of the
trial is compared with its row in the table there. TRIAL OFF leaves the trial, as do WORLD and
another TRIAL. Without NUMBER, list the conditions; without NAME, list the experiments, or tell the
current trial."
  (cond ((and (null name) (session-trial session))
         (write-open-trial session (session-trial session)))
        ((null name) (write-experiments))
        ((and (string-equal name "off") (null condition)) (leave-trial session))
        ((null number)
         (let ((question (resolve-question name)))
           (when condition (resolve-condition question condition))
           (if (testbed-p question)
               (write-games question)
               (write-experiment-conditions question))))
        (t (multiple-value-bind (experiment condition)
               (resolve-condition (resolve-question name) condition)
             (check-trial-number experiment number)
             ;; Before the trial that is open is left.
             (when directory (row-of-trial experiment condition number directory))
             (open-trial-in-session session
                                    (make-open-trial experiment condition number directory))))))

(define-line "FAILURES" (session (name :token "a directory, or an experiment that was run here")
                                 (condition :token "a part of a condition's name" :optional))
    (:running)
    "List the failed trials of an experiment by condition and reason. For each reason, show a TRIAL
line that opens such a trial."
  (let ((names (experiment-names-matching name)))
    (print-failures (if (and names (null (rest names)) (not (existing-path (path-of-name name))))
                        (experiment-run-here (first names))
                        name)
                    condition)))

;;;; FORK

;;; In a fork the prompt is in a headless run: time passes as lines need it. The forked run stands
;;; still meanwhile. As with a trial, the line that enters a fork runs until a line leaves it.

(defun read-lines-in-fork (session)
  (format (session-console session)
          "~&In a fork, at tick ~D. STEP lets time pass, FORK OFF leaves it.~@[ Plans under way: ~
           ~{~A~^, ~}.~]~%"
          (simulation-tick *simulation*) (mapcar #'task-label (plans)))
  (loop until (session-over-p session)
        do (call-guarded session (lambda () (run-nested-line session)))
           (call-guarded session (lambda () (show-messages session)))))

(defun enter-fork (session fork)
  "Run SESSION in FORK until a line leaves FORK. Earlier jobs, and the trial that SESSION is in, are
set aside meanwhile."
  (let ((jobs (shiftf (session-jobs session) '()))
        (trial (shiftf (session-trial session) nil))
        (outer (session-forked-trial session))
        (depth (session-forks session)))
    (setf (session-forks session) (1+ depth)
          (session-forked-trial session) (or trial outer))
    (unwind-protect (catch 'left-fork
                      (call-in-fork fork (lambda () (read-lines-in-fork session))))
      (abandon-jobs session)
      (setf (session-jobs session) jobs
            (session-trial session) trial
            (session-forked-trial session) outer
            (session-forks session) depth))))

(defun enter-new-fork (session seed)
  "Run SESSION in a fork of the current run until a line leaves the fork; then discard the fork."
  (let ((fork (apply #'fork-simulation :continuations (and (session-trial session) t)
                     (and seed (list :seed seed))))
        (run *simulation*))
    (keep-forks t fork)
    (tell-other-sessions session run
                         (format nil "Another prompt is in a fork of the run, which is paused.~%"))
    (unwind-protect (call-with-run-paused (lambda () (enter-fork session fork)))
      (tell-other-sessions
       session run
       (format nil "The fork is left; the run ~:[continues~;is still paused~].~%" (paused-p run)))
      (stop-listening session)
      (release-fork fork)
      (unless (session-over-p session)
        (format (session-console session) "~&Back from the fork. ~A~%"
                (time-description session *simulation*))))))

(define-line "FORK" (session (seed :off "OFF, or an integer: the seed of the copy"
                                   :optional))
    (:running)
    "Continue in a copy of the run, plans included. The copy does exactly what the run would do. In
a fork of a trial, programs go on, too. With SEED, the copy has other random numbers. The run itself
is paused. FORK OFF discards the copy and returns to the run, which has not changed."
  (check-run-not-over)
  (cond ((null seed) (enter-new-fork session nil))
        ((string-equal seed "off")
         (when (zerop (session-forks session)) (reject-line "The prompt is not in a fork."))
         (throw 'left-fork t))
        (t (enter-new-fork session (or (ignore-errors (parse-integer seed))
                                       (reject-line "The seed of a fork is an integer, not ~A."
                                                    seed))))))
