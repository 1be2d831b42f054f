;;;; spreading.lisp -- an experiment on many cores and machines, by GNU parallel or Slurm.

(in-package :ars-magna.cli)

;;; All that is done here is to write a script, and this program with the user's experiment, into
;;; the directory of the results, and to start the script: it can be read, changed and started by
;;; itself. Shards are so large that starting one, a fifth of a second, is cheap beside what it
;;; does, but enough for several cores; and no more than there may be tasks in an array of Slurm's.
;;; How many they are depends on nothing but the experiment, so that starting again finds the same.

(defparameter *shards-of-scripts* '(("run.sh" 500 16) ("job.sh" 5000 1))
  "Lists (script trials least): for how many trials there is a shard, but at least so many shards.")

(defconstant +most-shards+ 1000 "How many shards there are at most unless somebody says.")

(defun default-shards (experiment trials script)
  "Return how many shards TRIALS trials of each condition of EXPERIMENT make for SCRIPT."
  (destructuring-bind (size least)
      (rest (assoc script *shards-of-scripts* :test #'string=))
    (min trials
         (clamp (ceiling (* trials (length (experiment-conditions experiment))) size)
                least +most-shards+))))

(defun trials-of (experiment options)
  (option-value :trials options (experiment-trials experiment)))

(defun place-for (directory)
  "Return what the directory for DIRECTORY is called on other machines."
  (format nil "ars-magna-~A-~36R" (machine-instance) (text-checksum (native-name directory))))

(defun common-settings (experiment options script)
  (let ((trials (trials-of experiment options)))
    `(("experiment" ,(string-downcase (experiment-name experiment)) "what is run")
      ("trials" ,trials "of each condition")
      ("shards" ,(or (option-value :shards options) (default-shards experiment trials script))
                "into how many parts all trials are divided")
      ("limit" ,(format nil "~@[--time-limit ~A~]" (option-value :time-limit options))
               "--time-limit SECONDS: how long a trial may take")
      ("plot" ,(if (option-value :plot options) "--plot" "") "--plot: pictures, too"))))

(defun parallel-settings (experiment options directory)
  (append (common-settings experiment options "run.sh")
          `(("jobs" ,(option-value :workers options "100%") "at a time on each machine")
            ("hosts" ,(option-value :parallel options)
                     "for --sshlogin: 8/alice,bob ...; empty: this machine")
            ("place" ,(place-for directory) "the directory on other machines"))))

(defun slurm-settings (experiment options directory)
  (declare (ignore directory))
  (append (common-settings experiment options "job.sh")
          `(("workers" ,(option-value :workers options 1) "cores for each task")
            ("options" ,(option-value :slurm options) "for sbatch: --partition=long ..."))))

(defun write-script (name text directory)
  "Write TEXT as the script NAME in DIRECTORY. Another one that is there is kept, as NAME~."
  (let* ((path (merge-pathnames (native-path name) directory))
         (there (and (existing-path path) (file-text path))))
    (unless (equal there text)
      (when there
        (let ((old (native-path (format nil "~A~~" (native-name path)))))
          (replace-file old path)
          (say "~A was there, and different; it is ~A now." (native-name path)
               (native-name old))))
      (write-file-anew (lambda (out) (write-string text out)) path "the script"
                       :remedy "remove it, or give another directory"))
    path))

(defun spread (experiment words options script template settings)
  "Run EXPERIMENT, which WORDS, arguments of this program, stand for, by SCRIPT, made of TEMPLATE
and what SETTINGS, a function, returns. Return the status to exit with."
  (let ((directory (ensure-results-directory (option-value :out options))))
    ;; What has made the rows that are there is not to be replaced by what cannot go on with them.
    (check-same-code experiment directory)
    (save-program-with words (native-name (merge-pathnames "ars-magna" directory)))
    (let ((path (write-script script
                              (with-settings (text-called template)
                                (funcall settings experiment options directory))
                              directory)))
      (or (run-attached "sh" (list (native-name path)))
          (reject-line "~A cannot be started." (native-name path))))))
