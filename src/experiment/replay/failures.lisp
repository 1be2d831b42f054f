;;;; failures.lisp -- what went wrong in an experiment, by reason, with an example of each.

(in-package :ars-magna.experiment)

;;; Trials of one condition that came out alike, and have the same reason and the same text of an
;;; error, are a group. An error in a continuation or kicker lets its trial go on; so a trial that
;;; succeeded may be in a group, too.

(defun flaws-of (sample)
  "Return lists (trials outcome reason error) of the trials of SAMPLE that went wrong in the same
way, the most frequent first."
  (let ((known (make-hash-table :test 'equal)) (keys '()))
    (loop for trial across (sample-trials sample)
          for outcome across (sample-outcomes sample)
          for reason across (sample-reasons sample)
          for error across (sample-errors sample)
          for key = (list outcome reason error)
          do (unless (and (string= "success" outcome) (string= "" error))
               (unless (gethash key known) (push key keys))
               (push trial (gethash key known))))
    (stable-sort (loop for key in (reverse keys)
                       collect (cons (reverse (gethash key known)) key))
                 #'> :key #'flaw-count)))

(defun flaw-count (flaw)
  (length (first flaw)))

(defun flaw-plist (flaw sample)
  (destructuring-bind (trials outcome reason error) flaw
    (let ((count (length trials)))
      (list :condition (sample-condition sample)
            :outcome outcome :reason reason :error error
            :count count
            :share (/ count (float (length (sample-trials sample)) 1d0))
            :trials trials))))

;;; Which results are meant.

(defun existing-results (designator)
  "Return the results that DESIGNATOR means: results, the name of a directory that has some, or an
experiment that has been run here, or its name. Signals MISUSE and DAMAGED-TABLE."
  (let ((experiment (and (typep designator '(or symbol string experiment))
                         (find-experiment designator nil)))
        (directory-p (typep designator '(or string pathname))))
    (cond ((results-p designator) designator)
          ((and directory-p
                (or (null experiment) (existing-path (rows-file (directory-called designator)))))
           (read-results designator))
          (experiment
           (or (experiment-results experiment)
               (reject-use "~(~A~) has not been run here. Run it, or give the directory of its ~
                            results."
                           (experiment-name experiment))))
          (t (reject-argument "trial-failures" "results" designator
                              "results, an experiment, or the name of a directory")))))

(defun samples-meant (results condition)
  "Return those samples of RESULTS whose conditions are called CONDITION, or have that in their
names; all if it is NIL. Signals UNKNOWN-NAME."
  (let ((samples (results-samples results)))
    (cond ((null condition) samples)
          ((called (string condition) samples #'sample-condition))
          (t (reject-name "condition" (string condition)
                          (mapcar #'sample-condition samples))))))

(addition trial-failures)
(defun trial-failures (results &optional condition)
  "Return what went wrong in RESULTS (results, an experiment that has been run here, or the name of
a directory), or in those of CONDITION, a string or symbol that is a part of its name: a list of
plists :condition :outcome :reason :error :count :share (of the condition's trials) :trials (their
numbers), in the order of conditions and then of counts. Errors in code that let its trial go on
count, too. REPLAY-TRIAL opens one. Signals MISUSE, UNKNOWN-NAME, WRONG-ARGUMENT, DAMAGED-TABLE."
  (check-argument trial-failures condition (typep condition '(or string symbol))
                  "a string or symbol, or NIL")
  (loop for sample in (samples-meant (existing-results results) condition)
        append (loop for flaw in (flaws-of sample) collect (flaw-plist flaw sample))))

;;; Printing.

(defun word-text (text)
  "Return TEXT as one word of a line of the prompt."
  (if (find #\Space text) (format nil "\"~A\"" text) text))

(defun example-text (flaw sample)
  "Return the line of the prompt that opens the first trial of FLAW, of SAMPLE."
  (format nil "trial ~A ~A ~D" (word-text (sample-experiment sample))
          (word-text (sample-condition sample)) (first (first flaw))))

(defun flaw-text (flaw)
  (destructuring-bind (outcome reason error) (rest flaw)
    (format nil "~A~@[: ~A~]~@[; ~A~]" outcome
            (and (string/= "" reason) reason) (and (string/= "" error) error))))

(defun print-flaws (sample stream)
  (let* ((flaws (flaws-of sample)) (count (reduce #'+ flaws :key #'flaw-count)))
    (format stream "~A: ~D trials, ~:[~D with something wrong~;nothing wrong~]~%"
            (sample-condition sample) (length (sample-trials sample)) (zerop count) count)
    (dolist (flaw flaws)
      (format stream "  ~5D  ~5,1F %  ~A~%                  ~A~%" (flaw-count flaw)
              (* 100d0 (/ (flaw-count flaw) (length (sample-trials sample))))
              (flaw-text flaw) (example-text flaw sample)))))

(addition print-failures)
(defun print-failures (results &optional condition (stream *standard-output*))
  "Write to STREAM what TRIAL-FAILURES returns: for each condition how many trials went wrong in
which way, and a line for the prompt that opens one of them. Return nothing."
  (dolist (sample (samples-meant (existing-results results) condition) (values))
    (print-flaws sample stream)))
