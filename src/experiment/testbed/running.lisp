;;;; running.lisp -- RUN-TESTBED, and what TESTBED tells about a testbed.

(in-package :ars-magna.experiment)

(export '(write-testbed-list write-agents-order broken-agents count-broken-trials
          first-broken-trial check-new-game))

(addition start-agent)
(defun start-agent (agent)
  "Start AGENT, the name of a plan or function, in the current simulation: begin the plan, or call
the function without arguments. Errors end the trial, but a plan's failures leave the game to go on.
Return nothing. Signals UNKNOWN-NAME."
  (cond ((and (symbolp agent) (find-procedure agent nil)) (begin-plan agent))
        ((and agent (symbolp agent) (fboundp agent)) (funcall agent))
        (t (reject-name "agent" agent '())))
  (values))

(defun check-new-game ()
  "Signal MISUSE unless a game can begin here, in a run that has passed no ticks."
  (let ((tick (simulation-tick)))
    (unless (zerop tick)
      (reject-use "play: a game begins at tick 0, and this run is at tick ~D. To play on, let ~
                   ticks pass by (run-ticks N); for another game, begin another run." tick))))

(defun call-with-fixed-knobs (knobs function)
  "Return the values of FUNCTION, which plays a game. Signal MISUSE if one of KNOBS, parameters, has
another value then: tables would say what the game was not."
  (let ((before (mapcar #'symbol-value knobs)))
    (multiple-value-prog1 (funcall function)
      (loop for knob in knobs
            for old in before
            do (unless (eql old (symbol-value knob))
                 (reject-use "The agent set ~(~A~), a knob of the game, from ~A to ~A. Agents play ~
                              with the knobs as they are."
                             knob old (symbol-value knob)))))))

(defun resolve-agent (testbed name)
  "Return the agent NAME: a plan or function of that very name, or else an agent of TESTBED."
  (let ((names (mapcar #'first (testbed-agents testbed))))
    (cond ((agent-p name)
           (when (agent-arguments-text name) (reject-use "~A" (agent-arguments-text name)))
           name)
          ((and name (symbolp name) (find name names :test #'same-name-p)))
          (t (reject-name "agent" name names)))))

(defun resolve-knob (testbed setting)
  "Return SETTING, a list (knob value), with the symbol of a knob of TESTBED."
  (unless (setting-p setting)
    (reject-argument 'run-testbed 'knobs setting "lists (knob value)"))
  (let ((knob (or (find (first setting) (testbed-knobs testbed) :test #'same-name-p)
                  (reject-name "knob" (first setting) (testbed-knobs testbed)))))
    (check-parameter-value (parameter-of-variable knob) (second setting))
    (list knob (second setting))))

(defun resolve-knobs (testbed settings)
  (let ((resolved (loop for setting in settings collect (resolve-knob testbed setting))))
    (loop for ((knob) . others) on resolved
          do (when (assoc knob others)
               (reject-use "The knob ~(~A~) is set twice. Set it once." knob)))
    resolved))

(defun check-testbed-arguments (agents knobs seeds)
  (check-argument run-testbed agents (proper-list-p agents) "a list of names, such as (my-agent)")
  (check-argument run-testbed agents
                  (= (length agents) (length (remove-duplicates agents :test #'string=)))
                  "agents with different names, by which tables know them")
  (check-argument run-testbed knobs (proper-list-p knobs) "a list of lists (knob value)")
  (check-argument run-testbed seeds (and (integerp seeds) (plusp seeds))
                  "a positive integer, the number of seeds"))

(addition run-testbed)
(defun run-testbed (name &key agents knobs (seeds 100) tuning (workers 1) directory time-limit
                              (stream *error-output*))
  "Run AGENTS in the testbed NAME, all on the same SEEDS, a number. Return results, as
RUN-EXPERIMENT does: AGENT is a factor, and the score is the first measure. AGENTS are names of
plans or functions, or of agents of the testbed; by default all of these. KNOBS are lists (knob
value). If TUNING is true, the seeds are those to write agents with, else those to test them.
WORKERS, DIRECTORY, TIME-LIMIT and STREAM are as for RUN-EXPERIMENT. But if an agent has changed
since its games in DIRECTORY, these games are played again, and a copy of the old table is kept in a
directory old-N there. Signals UNKNOWN-NAME, WRONG-ARGUMENT, and the errors of RUN-EXPERIMENT and
DEFEXPERIMENT."
  (let ((testbed (find-testbed name)))
    (check-testbed-arguments agents knobs seeds)
    (run-experiment-object
     (testbed-experiment testbed
                         (loop for agent in (or agents (mapcar #'first (testbed-agents testbed)))
                               collect (resolve-agent testbed agent))
                         :settings (resolve-knobs testbed knobs)
                         :tuning tuning)
     seeds workers directory stream time-limit)))

(defun run-experiment-object (experiment seeds workers directory stream &optional time-limit)
  "Register EXPERIMENT, so that failed trials can be listed, and run it. Return the results."
  (register *experiments* (experiment-name experiment) experiment :generated t)
  ;; Not by its name: other threads may run the same testbed.
  (let ((*renew-changed-rows-p* t))
    (apply #'run-experiment experiment
           :trials seeds :workers workers :directory directory :stream stream
           (and time-limit (list :time-limit time-limit)))))

(defun broken-trials (sample)
  "Return the numbers of the trials of SAMPLE that had an error or took too long."
  (loop for trial across (sample-trials sample)
        for error across (sample-errors sample)
        for outcome across (sample-outcomes sample)
        when (or (string/= "" error) (string= "timeout" outcome)) collect trial))

(defun count-broken-trials (results)
  "Return how many trials of RESULTS had an error or took too long."
  (loop for sample in (results-samples results) sum (length (broken-trials sample))))

(defun broken-agents (agents results)
  "Return those of AGENTS, in the order of the samples of RESULTS, that have broken trials."
  (loop for agent in agents
        for sample in (results-samples results)
        when (broken-trials sample) collect agent))

(defun first-broken-trial (results)
  "Return the number of the first broken trial of the first sample of RESULTS that has one."
  (first (some #'broken-trials (results-samples results))))

(defun nearest-mean (numbers)
  (float (/ (reduce #'+ numbers :key #'rational) (length numbers)) 1d0))

(defun score-number (value measure)
  "Return VALUE, of MEASURE, as a number: 1 and 0 for true and false."
  (cond ((realp value) value)
        ((member value '(t nil)) (if value 1 0))
        (t (reject-use "The measure ~(~A~) has the value ~A, which is no number." measure value))))

(defun mean-score (testbed results sample)
  "Return the mean of the score of TESTBED in SAMPLE of RESULTS."
  (let ((score (testbed-score testbed)))
    (nearest-mean (map 'list (lambda (value) (score-number value score))
                       (sample-measure results sample score)))))

(defun best-first (testbed scored)
  "Return SCORED, a list of conses (agent . mean score), in order by the direction of TESTBED."
  (stable-sort (copy-list scored) (if (testbed-less-is-better testbed) #'< #'>) :key #'cdr))

(defun write-agents-order (testbed results agents stream)
  "Write AGENTS, which have RESULTS in TESTBED, to STREAM, the best first."
  (let ((scored (loop for agent in agents
                      for sample in (results-samples results)
                      collect (cons agent (mean-score testbed results sample)))))
    (write-wrapped (format nil "Best first, by ~A: ~:{~(~A~) ~A~:^, ~}." (score-text testbed)
                           (loop for (agent . mean) in (best-first testbed scored)
                                 collect (list agent (decimal-text mean 3))))
                   stream)))

(defun score-text (testbed)
  "Return the name of the score of TESTBED, with the direction."
  (format nil "~(~A~)~:[~;, less is better~]" (testbed-score testbed)
          (testbed-less-is-better testbed)))

;;; Telling.

(defun agent-name-text (agent)
  (string-downcase agent))

(defun knob-line (name)
  (let* ((parameter (find-parameter name)) (default (parameter-default parameter)))
    (format nil "~A, ~A~@[ ~A~]; default ~(~A~). ~A" (parameter-name parameter)
            (describe-type (parameter-type parameter))
            (and (string/= "" (parameter-unit parameter)) (parameter-unit parameter))
            ;; As it can be typed.
            (if (symbolp default) (prin1-to-string default) (value-text default))
            (one-line (parameter-sentence parameter)))))

(defun write-testbed-section (title lines stream)
  (when lines
    (format stream "~%~A~%" title)
    (dolist (line lines) (write-wrapped (one-line line) stream :first "  - "))))

(defun write-testbed (testbed stream)
  (write-wrapped (format nil "~(~A~): ~A" (testbed-name testbed)
                         (one-line (testbed-documentation testbed)))
                 stream)
  (write-testbed-section "Rules" (testbed-rules testbed) stream)
  (write-testbed-section "Knobs" (mapcar #'knob-line (testbed-knobs testbed)) stream)
  (write-testbed-section (format nil "Agents, by the score ~A" (score-text testbed))
                         (loop for (name text) in (testbed-agents testbed)
                               collect (format nil "~(~A~): ~A" name text))
                         stream)
  (write-testbed-section "Claims" (mapcar #'first (testbed-claims testbed)) stream)
  (write-testbed-section "Sources" (testbed-sources testbed) stream)
  (write-testbed-section "Seeds"
                         (list (format nil "for tuning from ~D on; for testing from ~D on"
                                       (1+ (first-seed testbed t)) (1+ (first-seed testbed nil))))
                         stream))

(addition testbed)
(defun testbed (name &optional (stream *standard-output*))
  "Write the rules, knobs, agents, claims and sources of the testbed NAME to STREAM. Return the
testbed. Signals UNKNOWN-NAME."
  (let ((testbed (find-testbed name)))
    (write-testbed testbed stream)
    testbed))

(defun write-testbed-list (stream)
  "Write the names of all testbeds to STREAM, with a sentence on each."
  (dolist (testbed (all-testbeds))
    (write-wrapped (first-sentence (testbed-documentation testbed)) stream
                   :first (format nil "  ~(~20A~)" (testbed-name testbed)))))
