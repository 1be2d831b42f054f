;;;; running-lines.lisp -- PAUSE, RESUME, STEP, RATE, SEED, PARAMS and journals.

(in-package :ars-magna.cli)

(export '(parameter-value-text))

(defun current-live-simulation ()
  "Return the current simulation. Signals BAD-LINE if the simulation is not live."
  (check-run-not-over)
  (let ((simulation (current-simulation)))
    (unless (live-p simulation)
      (reject-line "Ticks pass here only while a command needs them. STEP lets ticks pass."))
    simulation))

(defun time-description (session simulation &optional (tick (simulation-tick simulation)))
  "Return a text that tells TICK and how time passes in SIMULATION, the run of SESSION."
  (format nil "Tick ~D, ~A." tick
          (cond ((session-trial session) (trial-pace-text (session-trial session)))
                ((simulation-over simulation) (simulation-over simulation))
                ((plusp (session-forks session)) "in a fork: STEP lets time pass")
                ((headless-p simulation) "headless")
                ((not (live-p simulation)) "stopped; RESUME continues")
                ((paused-p simulation) "paused")
                ((idle-p simulation)
                 (format nil "idle, else ~A" (rate-text (simulation-rate simulation))))
                (t (rate-text (simulation-rate simulation))))))

(define-line "PAUSE" (session) (:running)
    "Stop time until RESUME."
  (let ((simulation (current-simulation)))
    (if (session-trial session)
        (pause-trial (session-trial session))
        (progn (pause (current-live-simulation))
               ;; The tick in progress ends first.
               (asking (simulation))))
    (format t "~A~%" (time-description session simulation))))

(defun resume-run (session)
  "Resume the run of SESSION. If its clock was stopped, start the clock again."
  (check-run-not-over)
  (let ((simulation (current-simulation)))
    (cond ((or (live-p simulation) (headless-p simulation)) (resume (current-live-simulation)))
          (t (start-clock simulation :rate (or (simulation-rate simulation) *default-rate*)
                                     :real (eq :real (simulation-thinking simulation)))
             (format t "~A~%" (time-description session simulation))))))

(define-line "RESUME" (session) (:running)
    "Let time pass again after PAUSE or STOP-SIMULATOR. A trial without a terminal runs to its end."
  (if (session-trial session)
      (resume-trial (session-trial session))
      (resume-run session)))

(defun step-run (session count)
  "Pass COUNT ticks of SESSION's run. Print the tick; if fewer ticks passed, also how time passes."
  (check-run-not-over)
  (let* ((simulation (current-simulation))
         (goal (+ (simulation-tick simulation) count)))
    (step-ticks count simulation)
    (if (await-test (lambda () (>= (simulation-tick simulation) goal)))
        (format t "Tick ~D.~%" (simulation-tick simulation))
        (format t "~A~%" (time-description session simulation)))))

(define-line "STEP" (session (n steps "how many (STEP-TO moves the robot to a cell); 1 if left out"
                              :optional))
    (:running)
    "Let N ticks pass; a live simulator is paused after them."
  (if (session-trial session)
      (step-trial (session-trial session) (or n 1))
      (step-run session (or n 1))))

(defun parse-rate (text)
  "Return the rate in TEXT: a number or :FREE. Signals BAD-LINE for another text."
  (if (string-equal text "free")
      :free
      (let ((rate (ignore-errors (values (read-data-from-string text 0)))))
        (if (argument-of-type-p rate 'rate)
            rate
            (reject-line "The rate cannot be ~A. Give ~A." text (argument-type-text 'rate))))))

(defun rate-after-resume-text (session simulation)
  "If SIMULATION, the run of SESSION, is paused, return the rate after RESUME as text; else NIL."
  (let ((trial (session-trial session)))
    (cond ((and trial (not (open-trial-running-p trial))) (rate-text (open-trial-rate trial)))
          ((and (null trial) (paused-p simulation)) (rate-text (simulation-rate simulation))))))

(define-line "RATE" (session (x :rate "a number of ticks per second, or free" :optional))
    (:running)
    "Set the rate of a live simulator. Without a rate, show the rate and the tick. No ticks pass
while the simulator is idle: nothing moves by itself in its world, and no command was given. At the
rate FREE, no ticks pass either while only things move: they would pass too fast to be seen."
  (let ((simulation (current-simulation)))
    (when x
      (if (session-trial session)
          (set-trial-rate (session-trial session) (parse-rate x))
          (set-rate (parse-rate x) (current-live-simulation))))
    (format t "~A~@[ RESUME continues at ~A.~]~%" (time-description session simulation)
            (and x (rate-after-resume-text session simulation)))))

(define-line "SEED" (session (n integer "the seed"))
    (:running)
    "From now on, draw all random numbers from the seed N."
  (set-seed n (current-simulation)))

;;; Parameters.

(defun parameter-value-text (value)
  "Return VALUE of a parameter as text, a number of usual size with at most four decimals."
  (if (and (realp value) (or (zerop value) (<= 1d-3 (abs value) 1d6)))
      (plain-number-text value)
      (princ-to-string value)))

(defun parameter-text (parameter)
  (let ((value (parameter-value parameter))
        (default (parameter-default parameter)))
    (format nil "~30A ~8A ~A~:[ (default ~A)~;~]" (parameter-name parameter)
            (parameter-value-text value) (parameter-unit parameter)
            (value-equal value default) (parameter-value-text default))))

(defun parameters-matching (name)
  "Return the parameters named NAME, with or without the star. If there are none, return the
parameters whose names begin with NAME, or else those whose names contain NAME."
  (flet ((called (test)
           (loop for parameter in (all-parameters)
                 when (funcall test (string-downcase name) (parameter-name parameter))
                   collect parameter)))
    (or (called (lambda (name own) (string= own (format nil "~A*" (string-right-trim "*" name)))))
        (called #'starts-with-subseq)
        (called #'search))))

(defun write-parameters (parameters)
  (loop with group = nil
        for parameter in parameters
        do (unless (equal group (parameter-group parameter))
             (setf group (parameter-group parameter))
             (format t "~A~%" group))
           (write-trimmed-line "  ~A" (parameter-text parameter))))

(defun write-parameter (parameter)
  (write-trimmed-line "~A" (parameter-text parameter))
  (format t "~A~%" (parameter-sentence parameter)))

(defun remove-noise ()
  "Remove all noise, also noise that was set after an earlier call of CLEAN-SIMULATION."
  (dirty-simulation)
  (clean-simulation))

(defun set-default-parameters ()
  (dirty-simulation)
  (dolist (parameter (all-parameters))
    (setf (parameter-value parameter) (parameter-default parameter))))

(define-line "PARAMS" (session (name :parameter "the name of a parameter, CLEAN or DEFAULT"
                                     :optional)
                               (value :rest "its new value" :optional))
    (:running
     "PARAMS CLEAN removes all noise, as CLEAN-SIMULATION does. PARAMS DEFAULT gives all parameters
their default values.")
    "List all parameters, or those with NAME in their names, or set one to VALUE."
  (let ((parameters (parameters-matching (or name "")))
        (all (assoc name '(("clean" remove-noise) ("default" set-default-parameters))
                    :test #'equalp)))
    (cond ((and all value) (reject-line "PARAMS ~:@(~A~) takes no value." name))
          (all
           (funcall (second all))
           (format t "The parameters are now: ~A.~%" (parameters-summary (parameter-values))))
          ((rest parameters)
           (when value (reject-line "~A is a part of several names. Type more of the name." name))
           (write-parameters parameters))
          (t (let ((parameter (or (first parameters) (find-parameter name))))
               (when value
                 (setf (parameter-value parameter)
                       (handler-case (values (read-data-from-string value 0))
                         (error ()
                           (reject-line "~A cannot be read; give a number, T or NIL." value)))))
               (write-parameter parameter))))))

;;; Journals.

(defun tick-and-state-text (tick digest)
  (format nil "tick ~D, state ~16,'0X~%" tick digest))

(define-line "SAVE-JOURNAL" (session (file :file "the name of a file"))
    (:running)
    "Write the journal of this run to FILE, for REPLAY: all commands and changes."
  (let ((simulation (current-simulation)))
    (multiple-value-bind (path tick digest)
        (asking (simulation)
          (values (save-journal (path-of-name file) simulation)
                  (simulation-tick simulation)
                  (state-digest simulation)))
      (format t "~A: ~A" (native-name path) (tick-and-state-text tick digest)))))

(defun parse-anyway-word (word)
  "True if WORD is ANYWAY, NIL if WORD is NIL. Signals BAD-LINE for another word."
  (cond ((null word) nil)
        ((string-equal word "anyway") t)
        (t (reject-line "REPLAY takes a file, then ANYWAY or nothing, not ~A." word))))

(defun call-showing-progress (function session end)
  "Call FUNCTION, which processes ticks up to END, and return its values. The argument of FUNCTION
is a function of a tick that shows the progress at the terminal of SESSION."
  (let ((progress (and (session-terminal-p session)
                       (make-progress-line (session-console session)))))
    (flet ((tell (tick)
             (note-progress progress "Tick ~D of ~D. Control-C cancels." tick end)))
      (unwind-protect (funcall function #'tell)
        (when progress (end-progress progress))))))

(defun replay-with-progress (session journal anyway)
  "Repeat JOURNAL's run, and show the progress. Return the last tick and the state's digest."
  (flet ((repeat (tell)
           (call-with-replay (lambda () (values (simulation-tick *simulation*) (state-digest)))
                             journal
                             :anyway anyway
                             :observer (lambda (simulation)
                                         (funcall tell (simulation-tick simulation))))))
    (call-showing-progress #'repeat session (journal-end journal))))

(define-line "REPLAY" (session (file :file "the name of a file that SAVE-JOURNAL wrote")
                               (anyway :token "the word ANYWAY" :optional))
    (:running)
    "Repeat the run recorded in FILE, in a separate world, and show the tick and state at its end.
ANYWAY repeats the run even if definitions differ from those of the recorded run."
  (multiple-value-bind (tick digest)
      (replay-with-progress session (load-journal (path-of-name file)) (parse-anyway-word anyway))
    (format t "~A: ~A" file (tick-and-state-text tick digest))))
