;;;; spreading.lisp -- an experiment on many cores and machines, by this program as one file.

(in-package :ars-magna.cli)

;;; A saved program needs neither SBCL nor sources where it runs, but a machine of the same kind. It
;;; is this program, with the user's file loaded: `./PROGRAM experiment NAME` runs an experiment in
;;; it, with the same fingerprints as here.

(defvar *toplevel-function* nil
  "The function that a saved copy of this program calls when it starts.")

(defvar *saved-by-user-p* nil "True in a program that a user has saved.")

(defun program-command-line ()
  (list (or (and (not *saved-by-user-p*) (environment-value "ARS_MAGNA_PROGRAM"))
            (first (uiop:raw-command-line-arguments)))))

(defun save-program (name)
  "Save the program in its present state as the executable file NAME, and end this process."
  (freeze-file-digests)
  (setf *saved-by-user-p* t)
  (let ((path (native-path name)))
    (handler-case (progn (check-writable path)
                         (when (existing-path path) (delete-file path))
                         (sb-ext:save-lisp-and-die path :executable t :save-runtime-options t
                                                        :toplevel *toplevel-function*))
      (error (condition)
        (reject-line "~A cannot be saved: ~A" name (one-line (printable-report condition)))))))

(defun save-program-with-experiments (words name)
  "Save this program as the executable file NAME, with the experiments named by WORDS, a file or an
experiment. Signals BAD-LINE if the program cannot be saved."
  ;; Saving ends the Lisp that does it; so another process does it.
  (let* ((new (format nil "~A.new" name))
         (arguments (append (rest (program-command-line)) (list "experiment") words
                            (list "--save-executable" new))))
    (unless (eql 0 (run-attached (first (program-command-line)) arguments))
      (reject-line "~A could not be saved." name))
    (replace-file (native-path name) (native-path new))))

;;;; GNU parallel and Slurm

;;; This only writes a script, and this program with the user's experiment, into the directory of
;;; the results, and starts the script. You can read, change and start it yourself. A shard is large
;;; enough that its start, a fifth of a second, is cheap, and small enough to occupy several cores;
;;; there are no more shards than a Slurm array may have tasks. Their number depends only on the
;;; experiment, so that a second start finds the same ones.

(defparameter *shard-defaults-of-scripts* '(("run.sh" 500 16) ("job.sh" 5000 1))
  "Lists (script trials least): the number of trials in a shard, and the least number of shards.")

(defconstant +default-largest-shard-count+ 1000 "The largest number of shards by default.")

(defun default-shard-count (experiment trials script)
  "Return SCRIPT's default number of shards for TRIALS trials of each condition of EXPERIMENT."
  (destructuring-bind (size least)
      (rest (assoc script *shard-defaults-of-scripts* :test #'string=))
    (min trials
         (clamp (ceiling (* trials (length (experiment-conditions experiment))) size)
                least +default-largest-shard-count+))))

(defun trial-count (experiment options)
  (option-value :trials options (experiment-trials experiment)))

(defun common-settings (experiment options script)
  (let ((trials (trial-count experiment options)))
    `(("experiment" ,(string-downcase (experiment-name experiment)) "what is run")
      ("trials" ,trials "of each condition")
      ("shards" ,(or (option-value :shards options) (default-shard-count experiment trials script))
                "number of parts into which all trials are divided")
      ("limit" ,(format nil "~@[--time-limit ~A~]" (option-value :time-limit options))
               "--time-limit SECONDS: how long a trial may take")
      ("plot" ,(if (option-value :plot options) "--plot" "") "--plot: pictures, too"))))

(defun parallel-settings (experiment options directory)
  (append (common-settings experiment options "run.sh")
          `(("jobs" ,(option-value :workers options "100%") "at a time on each machine")
            ("hosts" ,(option-value :parallel options)
                     "for --sshlogin: 8/alice,bob ...; empty: this machine")
            ("place" ,(format nil "ars-magna-~A-~36R" (machine-instance)
                              (text-checksum (native-name directory)))
                     "the directory on other machines"))))

(defun slurm-settings (experiment options directory)
  (declare (ignore directory))
  (append (common-settings experiment options "job.sh")
          `(("workers" ,(option-value :workers options 1) "cores for each task")
            ("options" ,(option-value :slurm options) "for sbatch: --partition=long ..."))))

(defun write-script (name text directory)
  "Write TEXT as the script NAME in DIRECTORY. If a different script is there, rename it to NAME~."
  (let* ((path (merge-pathnames (native-path name) directory))
         (there (and (existing-path path) (file-text path))))
    (unless (equal there text)
      (when there
        (let ((old (native-path (format nil "~A~~" (native-name path)))))
          (replace-file old path)
          (print-notice "~A existed with another text, and was renamed to ~A." (native-name path)
                        (native-name old))))
      (overwrite-file (lambda (out) (write-string text out)) path "the script"
                       :remedy "remove it, or give another directory"))
    path))

(defun run-by-script (experiment words options script template settings)
  "Write SCRIPT, which runs EXPERIMENT, named by WORDS, on many processors, and run it. TEMPLATE is
the script's template, SETTINGS a function that returns its settings. Return the exit status."
  (let ((directory (ensure-results-directory (option-value :out options))))
    ;; Rows must not be replaced by a program that cannot continue them.
    (check-same-code experiment directory)
    (save-program-with-experiments words (native-name (merge-pathnames "ars-magna" directory)))
    (let ((path (write-script script
                              (insert-settings (shell-text template)
                                (funcall settings experiment options directory))
                              directory)))
      (or (run-attached "sh" (list (native-name path)))
          (reject-line "~A cannot be started." (native-name path))))))
