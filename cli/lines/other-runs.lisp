;;;; other-runs.lisp -- REWIND, TRIAL and FORK: continuing in another run.

(in-package :ars-magna.cli)

;;; After a rewind the running plans are others than those that the prompt waited for. It drops the
;;; old ones without a message and waits for the new ones, also when the rewind comes from Lisp.

(defun let-errands-go (old new)
  "Report no ends of the plans of OLD that prompts wait for, as NEW replaces it."
  (declare (ignore new))
  (dolist (errand (with-lock (*plan-errands-lock*)
                    (remove old *plan-errands* :key #'plan-errand-simulation :test-not #'eq)))
    (setf (plan-errand-let-go-p errand) t
          (session-after-rewind (plan-errand-session errand)) #'take-up-plans)))

(attend *rewind-hooks* let-errands-go)

(defun check-rewindable (session)
  (check-run)
  (when (session-visit session)
    (reject-line "A trial cannot be rewound. TRIAL starts it again, at tick 0.")))

(defun rewind-and-tell (session ticks)
  (let ((tick (- (simulation-tick *simulation*) ticks)))
    (rewind ticks)
    ;; No session waits for commands that are in progress again.
    (setf (session-after-rewind session) nil
          (session-lisp-p session) t)
    (take-up-plans session)
    (tell-others session *simulation*
                 (format nil "Another prompt has rewound the run to tick ~D.~%" tick))
    (format t "~A~@[ Plans under way: ~{~A~^, ~}.~]~%"
            (time-text session *simulation* tick) (mapcar #'task-label (plans)))))

(define-line "REWIND" (session (n tick-span "how far"))
    (:running)
    "Go back N ticks and continue from there, plans included. REWIND 0 undoes changes since the last
tick. Later ticks are discarded; the journal records the rewind. Continuations waiting for a
command, such as that of GO-TO, receive :INTERRUPT."
  (check-rewindable session)
  (rewind-and-tell session n))

(define-line "REWIND-TO" (session (tick count "the tick to go back to"))
    (:running)
    "Go back to the end of TICK and continue from there, as with REWIND."
  (check-rewindable session)
  (let ((now (simulation-tick *simulation*)))
    (unless (<= tick now) (reject-line "It is only tick ~D." now))
    (rewind-and-tell session (- now tick))))

;;;; TRIAL

;;; Which trial is meant.

(defun experiment-names (start)
  "Return the names of the experiments that begin with START; of the very one if there is that."
  (let ((experiment (find-experiment start nil)))
    (if experiment
        (list (experiment-name experiment))
        (all-starting (string-upcase start) (mapcar #'experiment-name (all-experiments))
                      #'string))))

(defun experiment-meant (name)
  "Return the experiment called NAME, or the only one whose name begins so. Signals BAD-LINE."
  (let ((names (experiment-names name)))
    (cond ((null names)
           (reject-absent "experiment" name (mapcar #'experiment-name (all-experiments))
                        "TRIAL lists all; (load \"FILE\") loads others."))
          ((rest names) (reject-ambiguous name names))
          (t (find-experiment (first names))))))

(defun condition-meant (experiment text)
  "Return the condition of EXPERIMENT that TEXT means: its number, from 1, or a part of its name."
  (find-condition experiment (or (ignore-errors (parse-integer text)) text)))

;;; What is there.

(defun write-experiments ()
  (if (all-experiments)
      (dolist (experiment (all-experiments))
        (write-filled (whole-sentence (experiment-text experiment)) 27
                      (format nil "  ~(~A~)" (experiment-name experiment))))
      (format t "No experiment is defined. (load \"FILE\") loads a file that has some.~%")))

(defun write-conditions (experiment)
  (format t "~(~A~), ~D trials of each condition by default:~%" (experiment-name experiment)
          (experiment-trials experiment))
  (loop for condition in (experiment-conditions experiment)
        for number from 1
        do (put-line "  ~3D  ~A" number (condition-name condition))))

(defun visit-name (visit)
  (format nil "trial ~D of ~(~A~), ~A" (visit-trial visit)
          (experiment-name (visit-experiment visit))
          (condition-name (visit-condition visit))))

(defun say-here (session control &rest arguments)
  "Write a line formatted from CONTROL and ARGUMENTS, as it fits the window of SESSION."
  (format t "~&~A~%" (fitted (apply #'format nil control arguments) (session-console session))))

(defun write-visit (session visit)
  (say-here session "~@(~A~).~%~A" (visit-name visit) (time-text session *simulation*))
  (when (visit-changed visit)
    (say-here session "Since tick ~D this is no longer the experiment's run."
              (visit-changed visit))))

;;; Its end.

(defun measures-text (visit result)
  (format nil "~:{~(~A~) ~A~:^, ~}"
          (loop for (name value) in (measured (visit-experiment visit) result)
                collect (list name (case value ((t) "yes") ((nil) "no") (:none "none")
                                     (t (format-briefly nil "~A" value)))))))

(defun write-result (session visit result)
  (say-here session "The trial is over at tick ~D: ~A~@[ (~A)~].~@[ ~A.~]" (result-ticks result)
            (result-outcome result)
            (and (string/= "" (result-reason result)) (result-reason result))
            (let ((text (measures-text visit result))) (and (string/= "" text) text)))
  (when (string/= "" (result-error result))
    (say-here session "Its error: ~A" (complaint-text (result-error result))))
  (when (visit-changed visit)
    (say-here session "This is not the experiment's result: the run was changed at tick ~D."
              (visit-changed visit))))

(defun stay (session visit result parts row)
  "Read lines of SESSION where the trial of VISIT has ended, with RESULT, until one leads out."
  (setf (visit-result visit) result)
  (pause-visit visit)
  (call-aside (lambda ()
                (show-messages session)
                (write-result session visit result)
                (when row
                  (say-here session
                            "~:[It is as in its row.~;~:*It differs from its row: ~{~A~^; ~}.~]"
                            (row-differences (visit-experiment visit) result parts row
                                             (visit-directory visit))))))
  (loop (visit-line session visit)))

;;; Going there, and out again.

(defun pause-soon (session visit restart)
  "Let VISIT pause at its next tick, and continue by RESTART what was interrupted."
  (pause-visit visit)
  (setf (visit-interrupted-p visit) t)
  (write-fitted (session-console session)
                "Interrupted: the trial pauses at its next tick. Control-C leaves it.~%")
  (finish-output (session-console session))
  (invoke-restart restart))

(defun call-pausable (session visit function)
  "Call FUNCTION. Control-C at the terminal of SESSION, while ticks pass in VISIT, pauses the trial
at the next tick. A second Control-C, if that does not come, leaves the trial."
  (flet ((heed (condition)
           (let ((restart (find-restart 'go-on condition)))
             (if (and restart (session-terminal-p session) (not (visit-interrupted-p visit)))
                 (pause-soon session visit restart)
                 (setf (visit-left-p visit) t)))))
    (handler-bind ((user-interrupt #'heed))
      (funcall function))))

(defun run-visit (session visit)
  (let* ((experiment (visit-experiment visit))
         (condition (visit-condition visit))
         (trial (visit-trial visit))
         (directory (visit-directory visit))
         (parts (and directory (prepare-condition experiment condition)))
         (row (and directory (row-of-trial experiment condition trial directory)))
         (*trace-plans* t))
    (run-again experiment condition trial
               :journal t
               :gate (visit-gate session visit)
               :then (lambda (result) (stay session visit result parts row)))))

(defun call-with-others-paused (function)
  "Call FUNCTION, while the current live simulation, if any, is paused."
  (let ((simulation *simulation*))
    (if (and simulation (live-p simulation) (not (paused-p simulation)))
        (unwind-protect (progn (pause simulation) (funcall function))
          (resume simulation))
        (funcall function))))

(defun enter-visit (session visit)
  "Run VISIT in SESSION until a line leads out. Return a function to call then."
  (let ((*prompt-robot* nil) (left-p nil))
    (setf (session-visit session) visit)
    (unwind-protect
         (prog1 (catch 'left-visit
                  (call-pausable session visit (lambda () (run-visit session visit)))
                  #'values)
           (setf left-p t))
      (setf (session-visit session) nil)
      (drop-errands session)
      (call-by-name (robots-here))
      (unless left-p (format (session-console session) "~&The trial has been left.~%")))))

(defun drop-errands (session)
  (dolist (errand (shiftf (session-errands session) '()))
    (when (plan-errand-p errand) (close-errand errand))))

(defun go-to-trial (session visit)
  (call-outside session
                (lambda ()
                  (say-here session "~@(~A~): seed ~D, at most ~D ticks. STEP and RESUME let time ~
                                     pass, TRIAL OFF leads out."
                            (visit-name visit)
                            (trial-seed (visit-experiment visit) (visit-trial visit))
                            (experiment-limit (visit-experiment visit)))
                  (unless (watched-p session) (setf (visit-rate visit) :free))
                  (funcall (call-with-others-paused (lambda () (enter-visit session visit)))))))

(defun leave-trial (session)
  (unless (session-visit session) (reject-line "The prompt is in no trial."))
  (leave-visit session
               (lambda () (format t "Out of the trial~@[, in ~(~A~)~].~%"
                                  (and *simulation* (simulation-name *simulation*))))))

(define-line "TRIAL" (session (name :experiment "the name of an experiment, or OFF" :optional)
                              (condition :token "the number of a condition, or a part of its name"
                                         :optional)
                              (number count "the number of the trial" :optional)
                              (directory :token "the directory of its row" :optional))
    (:running)
    "Enter a trial of an experiment, at tick 0, exactly as the experiment runs it. STEP, RESUME and
RATE let time pass; STATUS, PLAN-TREE, WHY and others show its state; SAVE-JOURNAL saves it. Without
a terminal, RESUME runs it to its end. With DIRECTORY, its outcome is compared with its row there.
TRIAL OFF leaves it, as do WORLD and another TRIAL. Without NUMBER, list the conditions; without
NAME, list the experiments, or tell which trial this is."
  (cond ((and (null name) (session-visit session)) (write-visit session (session-visit session)))
        ((null name) (write-experiments))
        ((and (string-equal name "off") (null condition)) (leave-trial session))
        ((null number)
         (let ((experiment (experiment-meant name)))
           (when condition (condition-meant experiment condition))
           (write-conditions experiment)))
        (t (let ((experiment (experiment-meant name)))
             (go-to-trial session (make-visit experiment (condition-meant experiment condition)
                                              number directory))))))

(define-line "FAILURES" (session (name :token "a directory, or an experiment that was run here")
                                 (condition :token "a part of a condition's name" :optional))
    (:running)
    "List the failed trials of an experiment by condition and reason, each with a TRIAL line that
opens one of them."
  (let ((names (experiment-names name)))
    (print-failures (if (and names (null (rest names)) (not (existing-path (path-called name))))
                        (first names)
                        name)
                    condition)))

;;;; FORK

;;; In a fork the prompt is in a headless run: time passes as its lines need it. The forked run
;;; stands still meanwhile. Like a trial, a fork is entered by a line that continues until another
;;; one leads out.

(defun read-in-fork (session)
  (format (session-console session)
          "~&In a fork, at tick ~D. STEP lets time pass, FORK OFF leads back.~@[ Plans under way: ~
           ~{~A~^, ~}.~]~%"
          (simulation-tick *simulation*) (mapcar #'task-label (plans)))
  (loop until (session-over-p session)
        do (call-guarded session (lambda () (next-line-inside session)))
           (call-guarded session (lambda () (show-messages session)))))

(defun enter-fork (session fork)
  "Run SESSION in FORK until a line leads out. Its earlier errands do not count there."
  (let ((errands (shiftf (session-errands session) '()))
        (depth (session-forks session)))
    (setf (session-forks session) (1+ depth))
    (unwind-protect (catch 'left-fork
                      (call-in-fork fork (lambda () (read-in-fork session))))
      (drop-errands session)
      (setf (session-errands session) errands
            (session-forks session) depth))))

(defun go-to-fork (session seed)
  "Run SESSION in a fork of the current run until a line leads out; then discard the fork."
  (let ((fork (if seed (fork-simulation :seed seed) (fork-simulation))) (run *simulation*))
    (keep-forks t fork)
    (tell-others session run
                 (format nil "Another prompt is in a fork of the run, which is paused.~%"))
    (unwind-protect (call-with-others-paused (lambda () (enter-fork session fork)))
      (tell-others session run
                   (format nil "The fork is left; the run ~:[continues~;is still paused~].~%"
                           (paused-p run)))
      (stop-listening session)
      (release-fork fork)
      (unless (session-over-p session)
        (format (session-console session) "~&Back from the fork. ~A~%"
                (time-text session *simulation*))))))

(define-line "FORK" (session (seed :off "OFF, or an integer: the seed of the copy"
                                   :optional))
    (:running)
    "Continue in a copy of the run, plans included. The copy does what the run would do, or with
SEED what it might do. The run itself is paused. FORK OFF returns to it, unchanged, and discards the
copy."
  (check-run)
  (cond ((session-visit session) (reject-line "A trial cannot be forked. TRIAL OFF leads out."))
        ((null seed) (go-to-fork session nil))
        ((string-equal seed "off")
         (when (zerop (session-forks session)) (reject-line "The prompt is in no fork."))
         (throw 'left-fork t))
        (t (go-to-fork session (or (ignore-errors (parse-integer seed))
                                   (reject-line "The seed of a fork is an integer, not ~A."
                                                seed))))))
