;;;; experiment-shell.lisp -- experiments at a shell: options, files, tables, Ctrl-C.

(in-package :ars-magna.tests)

(def-suite* experiment-shell :in ars-magna)

;;; A working directory whose name a shell would split.

(defvar *place* nil "The name of the directory that a test works in.")

(defun placed (name) (uiop:strcat *place* name))

(defun call-in-place (function)
  (let* ((dice (base:make-dice (base:process-id) "places"))
         (*place* (format nil "~Aars magna 'é' ~36R/" (uiop:native-namestring
                                                       (uiop:temporary-directory))
                          (base:roll-index 1000000 dice)))
         (path (uiop:parse-native-namestring *place*)))
    (ensure-directories-exist path)
    (unwind-protect (base:with-own-definitions () (funcall function))
      (uiop:delete-directory-tree path :validate t))))

(defun write-file (name control &rest arguments)
  "Write a file NAME into the place of the test. Return its whole name."
  (with-open-file (out (base:native-path (placed name)) :direction :output :if-exists :supersede
                                                        :external-format :utf-8)
    (format out "~?" control arguments))
  (placed name))

(defparameter *stroll*
  "(defun far () (+ 4 (random 2)))
   (defexperiment stroll
     (:robots ars-worlds:dot) (:vary (motion-noise* 0 0.1)) (:trials 12) (:limit 60)
     (:run (robot-go-forward ars-worlds:dot (far)) (run-ticks 20)
           (if (= 0 (random 9)) (error \"no, not that\") t))
     (:success (> (robot-x ars-worlds:dot) 7))
     (:measure (x (robot-x ars-worlds:dot))))"
  "An experiment, some of whose trials break off.")

(defun shell (&rest arguments)
  "Do what ./cli/ars-magna does with ARGUMENTS. Return its status, what it writes to the standard
output, and what to the error output."
  (let* ((errors (make-string-output-stream)) (status nil)
         (written (with-output-to-string (*standard-output*)
                    (let ((*error-output* errors)
                          (base:*message-queue* (base:make-message-queue))
                          (command (cli::find-shell-command (first arguments))))
                      (setf status (funcall (second command) (rest arguments)))))))
    (values status written (get-output-stream-string errors))))

(defun run-stroll (&rest options)
  (apply #'shell "experiment" (placed "a stroll.lisp") "--quiet" options))

(defmacro in-place (&body body)
  `(call-in-place (lambda () (write-file "a stroll.lisp" "~A" *stroll*) ,@body)))

(defun text-in (name) (base:file-text (base:native-path (placed name))))

(defun lines-in (name) (length (lines-of (text-in name))))

(defun said-by (function)
  "Return what the error says that FUNCTION signals."
  (handler-case (progn (funcall function) "nothing")
    (base:ars-magna-error (condition) (princ-to-string condition))))

;;; Options.

(test options-of-experiments.are-read
  (is (equal '((:other "a.lisp") (:trials 20) (:until 0.02d0) (:shard (3 . 8)) (:parallel "")
               (:out "x y") (:slurm "--time=5 -p all") (:parallel "8/alice,bob") (:other "b"))
             (cli::parse-options '("a.lisp" "--trials" "20" "--until" ".02" "--shard=3/8"
                                   "--parallel" "--out" "x y" "--slurm" "--time=5 -p all"
                                   "--parallel" "8/alice,bob" "b")
                                 :table cli::*experiment-options* :others t))))

(test options-of-experiments.that-make-no-sense-are-usage-errors
  (dolist (arguments '(("experiment") ("experiment" "a" "b" "c") ("experiment" "a" "--trails" "3")
                       ("experiment" "a" "--trials" "0") ("experiment" "a" "--trials" "many")
                       ("experiment" "a" "--trials") ("experiment" "a" "--until" "2")
                       ("experiment" "a" "--shard" "3/3" "--out" "x")
                       ("experiment" "a" "--shard" "3" "--out" "x")
                       ("experiment" "a" "--shard" "0/3") ("experiment" "a" "--parallel")
                       ("experiment" "a" "--shards" "3" "--out" "x")
                       ("experiment" "a" "--shard" "5/99999999999" "--out" "x")
                       ("experiment" "a" "--shards" "1000000000" "--missing" "--out" "x")
                       ("experiment" "a" "--plot") ("experiment" "a" "--missing" "--out" "x")
                       ("experiment" "a" "--out" "") ("experiment" "a" "--quiet=1")
                       ("experiment" "a" "--shard" "0/3" "--until" ".1" "--out" "x")
                       ("experiment" "a" "--parallel" "--slurm" "--out" "x")
                       ("merge" "a") ("merge" "--out" "x") ("compare" "1")
                       ("compare" "1" "2" "x" "--against" "3")
                       ("compare" "--by" "a") ("compare" "x" "y" "z" "--by" "a") ("frob")
                       ("frob" "x")))
    (signals cli::usage-error (cli::run-with-arguments arguments))))

(test options-of-commands.are-all-in-their-usage
  (loop for (command options) in `(("experiment" ,cli::*experiment-options*)
                                   ("merge" ,cli::*merge-options*)
                                   ("compare" ,cli::*compare-options*)
                                   ("testbed" ,cli::*testbed-options*))
        for usage = (with-output-to-string (*standard-output*)
                      (is (eql 0 (cli::run-with-arguments (list command "--help")))))
        do (is (eql 0 (search (format nil "Usage: ars-magna ~A" command) usage)))
           (loop for (option) in options
                 do (is-true (search option usage) "~A of ~A" option command)))
  (loop for (command) in cli::*shell-commands*
        do (is-true (search command (cli::command-usage nil)) "~A" command)))

(test commands.that-are-unknown-name-the-nearest
  (is-true (has-words-p (said-by (lambda () (cli::run-with-arguments '("expriment" "a"))))
                        "expriment" "Did you mean experiment")))

;;; Files and names.

(test files.without-an-experiment-or-with-several-say-so
  (in-place
    (write-file "none.lisp" "(defun nothing () 1)")
    (write-file "two.lisp" "~A (defexperiment trip (:robots ars-worlds:dot) (:run t))" *stroll*)
    (is-true (has-words-p (said-by (lambda () (shell "experiment" (placed "none.lisp"))))
                          "none.lisp" "defexperiment"))
    (is-true (has-words-p (said-by (lambda () (shell "experiment" (placed "two.lisp"))))
                          "several" "stroll" "trip"))
    (is-true (has-words-p (said-by (lambda () (shell "experiment" (placed "two") "strol")))
                          "strol" "Did you mean stroll" "trip"))
    (is (eql 0 (shell "experiment" (placed "two") "Trip" "--quiet" "--trials" "2")))))

(test files.mean-their-own-experiments-before-those-that-they-load
  (in-place
    (flet ((name-of (file)
             (ars-magna.experiment:experiment-name (cli::experiment-named (placed file)))))
      (write-file "own.lisp" "(load (merge-pathnames \"a stroll.lisp\" *load-truename*))
                              (defexperiment trip (:robots ars-worlds:dot) (:run t))")
      (write-file "lent.lisp" "(load (merge-pathnames \"a stroll.lisp\" *load-truename*))")
      (is (string= "TRIP" (name-of "own.lisp")))
      (is (string= "STROLL" (name-of "lent.lisp")))
      (is (eql 0 (shell "experiment" (placed "own.lisp") "stroll" "--quiet" "--trials" "2"))))))

(test files.with-an-error-name-its-line
  (in-place
    (write-file "bad.lisp" "(defun far () 3)~%~%(defexperiment wrong (:robots dot) (:runs t))")
    (is-true (has-words-p (said-by (lambda () (shell "experiment" (placed "bad.lisp"))))
                          "bad.lisp" "line 3" ":runs"))
    (is-true (has-words-p (said-by (lambda () (shell "experiment" (placed "no-such.lisp"))))
                          "no-such.lisp" "no file"))))

(test experiments.are-known-by-name-before-files-without-their-type
  (in-place
    (cli::load-experiments (base:native-path (placed "a stroll.lisp")))
    (let ((known (cli::experiment-named "stroll")))
      (write-file "stroll.lisp" "(error \"this must not be loaded\")")
      (uiop:with-current-directory ((uiop:parse-native-namestring *place*))
        (is (eq known (cli::experiment-named "stroll")))
        (signals cli::file-trouble (cli::experiment-named "stroll.lisp"))))
    (is-true (has-words-p (said-by (lambda () (cli::experiment-named "strll")))
                          "strll" "Did you mean stroll"))))

;;; Control C.

(test interrupts.while-an-experiment-is-loaded-stop-it
  (let ((cli::*interrupts-while-ending* nil))
    (in-place
      (write-file "slow.lisp" "(ars-magna.host:signal-user-interrupt)")
      (multiple-value-bind (status written errors) (shell "experiment" (placed "slow.lisp"))
        (is (eql 130 status))
        (is (string= "" written))
        (is (= 1 (length (lines-of errors))))
        (is-true (search "stopped" errors))))))

(defun stopped-after (seconds)
  "Return what is said when an experiment is stopped that has had a trial under way for SECONDS."
  (let* ((condition (first (ars-magna.experiment:experiment-conditions
                            (cli::experiment-named (placed "a stroll.lisp")))))
         (progress (ars-magna.experiment::make-progress nil nil 10 2))
         (*error-output* (make-string-output-stream)))
    (setf (svref (ars-magna.experiment::progress-under-way progress) 2)
          (list condition 7 (- (ars-magna.host:real-microseconds)
                               (* seconds internal-time-units-per-second))))
    (cli::call-reporting-interruption (lambda ()
                                        (let ((ars-magna.experiment::*progress* progress))
                                          (ars-magna.host:signal-user-interrupt)))
                                      "experiment" '() '())
    (get-output-stream-string *error-output*)))

(test interrupts.name-the-trial-that-does-not-end
  (let ((cli::*interrupts-while-ending* nil))
    (in-place
      (is-true (has-words-p (stopped-after 600) "stopped; trial 7 of" "under way for 10 min"))
      (is-false (search "trial" (stopped-after 1))))))

(test interrupts.of-what-ends-already-let-it-be-put-in-order
  (let ((cli::*interrupts-while-ending* nil) (log '()))
    (is (eql 130 (cli::call-until-interrupted
                  (lambda ()
                    (unwind-protect (cli::handle-or-count-interrupt)
                      (cli::handle-or-count-interrupt)
                      (push :in-order log)))
                  (lambda ()
                    (cli::handle-or-count-interrupt)
                    (push :told log)
                    130))))
    (is (equal '(:told :in-order) log))))

(test interrupts.that-somebody-heeds-end-nothing
  (let ((cli::*interrupts-while-ending* nil))
    (is (eql 7 (cli::call-until-interrupted
                (lambda ()
                  (handler-bind ((cli::user-interrupt (lambda (condition)
                                                        (invoke-restart
                                                         (find-restart 'cli::go-on condition)))))
                    (cli::handle-or-count-interrupt)
                    7))
                (constantly 130))))
    (is (null cli::*interrupts-while-ending*))))

;;; Tables.

(test experiments.are-kept-where-that-is-wanted
  (in-place
    (multiple-value-bind (status written errors) (run-stroll "--out" (placed "out put"))
      (is (eql 0 status))
      (is (string= "" errors))
      (is (string= written (text-in "out put/summary.txt")))
      (is (= 25 (lines-in "out put/rows.csv")))
      (is-true (search "no, not that" (text-in "out put/rows.csv")))
      (is-true (has-words-p written "12" "motion-noise*" "error"))
      (is (= 24 (ars-magna.experiment:count-rows (placed "out put")))))
    (let ((before (in-place-now)))
      (is (eql 0 (run-stroll)))
      (is (equal before (in-place-now))))))

(defun in-place-now ()
  "Return the names of all that is in the place of the test, in order."
  (let ((path (uiop:parse-native-namestring *place*)))
    (sort (mapcar #'uiop:native-namestring
                  (append (uiop:directory-files path) (uiop:subdirectories path)))
          #'string<)))

(test experiments.say-which-of-their-files-cannot-be-written
  (in-place
    (ensure-directories-exist (base:native-path (placed "out/summary.txt/")))
    (is-true (has-words-p (said-by (lambda () (run-stroll "--out" (placed "out"))))
                          "summary.txt" "it is a directory or a device" "remove it"))
    (is (= 25 (lines-in "out/rows.csv")))))

(test experiments.show-no-control-characters-of-damaged-tables
  (in-place
    (is (eql 0 (run-stroll "--out" (placed "out"))))
    (write-file "out/rows.csv" "~C[31mcondition,seed~%" #\Esc)
    (let ((said (said-by (lambda () (run-stroll "--out" (placed "out"))))))
      (is (null (find #\Esc said)))
      (is-true (search "^[[31m" said)))))

(test pictures.are-drawn-where-that-is-wanted
  (in-place
    (run-stroll "--out" (placed "out") "--plot")
    (is-true (uiop:directory-files (uiop:parse-native-namestring (placed "out/")) "*.svg"))
    (is (eql 0 (shell "merge" (placed "out") "--out" (placed "all") "--plot")))
    (is-true (uiop:directory-files (uiop:parse-native-namestring (placed "all/")) "*.svg"))))

(test experiments.go-on-where-they-were-left
  (in-place
    (run-stroll "--out" (placed "whole"))
    (run-stroll "--out" (placed "parts") "--trials" "5" "--workers" "1")
    (run-stroll "--out" (placed "parts") "--workers" "2")
    (is (string= (text-in "whole/rows.csv") (text-in "parts/rows.csv")))))

(defun missing-of (count)
  (string-trim '(#\Newline) (nth-value 1 (run-stroll "--out" (placed "parts") "--missing"
                                                     "--shards" count))))

(test shards.make-the-same-table
  (in-place
    (run-stroll "--out" (placed "whole"))
    (is (string= "0 1 2" (missing-of "3")))
    (is (string= "" (nth-value 1 (run-stroll "--out" (placed "parts") "--shard" "1/3"))))
    (is (= 9 (lines-in "parts/shard-1-of-3/rows.csv")))
    (is (string= "0 2" (missing-of "3")))
    (dolist (shard '("0/3" "2/3")) (run-stroll "--out" (placed "parts") "--shard" shard))
    (is (string= "" (missing-of "3")))
    (is (string= "" (missing-of "5")) "what other shards have is there")
    (is (eql 0 (shell "merge" (placed "parts") "--out" (placed "parts"))))
    (is (string= (text-in "whole/rows.csv") (text-in "parts/rows.csv")))
    (is (string= (text-in "whole/summary.txt") (text-in "parts/summary.txt")))))

(test shards.that-are-cut-short-are-missing
  (in-place
    (run-stroll "--out" (placed "parts") "--shard" "0/2")
    (let* ((file (base:native-path (placed "parts/shard-0-of-2/rows.csv")))
           (size (with-open-file (in file :element-type '(unsigned-byte 8)) (file-length in))))
      (is (string= "1" (missing-of "2")))
      (base:truncate-file file (- size 3))
      (is (string= "0 1" (missing-of "2")))
      (is (= size (progn (run-stroll "--out" (placed "parts") "--shard" "0/2")
                         (with-open-file (in file :element-type '(unsigned-byte 8))
                           (file-length in))))))))

(test merging.says-where-nothing-is
  (in-place
    (is-true (has-words-p (said-by (lambda () (shell "merge" (placed "none") "--out" *place*)))
                          "none" "no rows"))))

(test comparing.takes-conditions-and-directories
  (in-place
    (run-stroll "--out" (placed "one"))
    (run-stroll "--out" (placed "two"))
    (flet ((compared (&rest arguments) (nth-value 1 (apply #'shell "compare" arguments))))
      (is-true (has-words-p (compared "=0.1" "1" (placed "one") "--measure" "success")
                            "motion-noise*=0.1" "motion-noise*=0" "12 common seeds"))
      (is-true (has-words-p (compared "1" "all" (placed "a stroll.lisp") "--quiet") "12 common"))
      (is-true (has-words-p (compared (placed "one") (placed "two")) "24" "the same"))
      (is-true (has-words-p (said-by (lambda () (compared "1" "none" (placed "one"))))
                            "none" "motion-noise*=0.1"))
      (is-true (has-words-p (compared "--by" "motion-noise*" (placed "one") "--measure" "success")
                            "motion-noise*=0.1 against motion-noise*=0" "12 common seeds"))
      (is-true (has-words-p (compared "--by" "motion-noise*" "--against" "0.1"
                                      (placed "a stroll.lisp") "stroll" "--quiet")
                            "motion-noise*=0 against motion-noise*=0.1")))))

(test comparing.takes-values-that-several-conditions-have
  (in-place
    (write-file "steps.lisp" "(defexperiment steps (:robots ars-worlds:dot) (:trials 6)
       (:vary (motion-noise* 0 0.1) (way 'short 'long)) (:limit 60)
       (:run (robot-go-forward ars-worlds:dot (if (eq way 'long) 4 3)) (run-ticks 20))
       (:success (> (robot-x ars-worlds:dot) 7)))")
    (flet ((compared (&rest arguments) (nth-value 1 (apply #'shell "compare" arguments))))
      (shell "experiment" (placed "steps.lisp") "--quiet" "--out" (placed "out"))
      (is-true (has-words-p (compared "long" "short" (placed "out") "--measure" "success"
                                      "--plot" (placed "steps.svg"))
                            "long against short" "over all: " "motion-noise*=0.1: "))
      (is-true (probe-file (base:native-path (placed "steps.svg"))))
      (is-true (has-words-p (said-by (lambda () (compared "1" "long" (placed "out"))))
                            "long is ambiguous: it could be" "way=long")))))

(test trials.that-do-not-return-are-ended-at-a-shell
  (in-place
    (write-file "hang.lisp" "(defexperiment hang (:robots ars-worlds:dot) (:trials 2)
                               (:vary (way :loop :go)) (:run (loop while (eq way :loop)) t))")
    (multiple-value-bind (status text)
        (shell "experiment" (placed "hang.lisp") "--quiet" "--time-limit" ".2" "--out"
               (placed "out"))
      (is (eql 0 status))
      (is (search "timeout" text)))
    (is (= 5 (lines-in "out/rows.csv")))
    ;; Without a limit this returns, as their rows are there.
    (is (eql 0 (shell "experiment" (placed "hang.lisp") "--quiet" "--out" (placed "out"))))
    (let ((limit '((:time-limit 1/2)))
          (experiment (cli::experiment-named (placed "hang.lisp"))))
      (dolist (settings (list (cli::parallel-settings experiment limit "x/")
                              (cli::slurm-settings experiment limit "x/")))
        (is (equal "--time-limit 1/2" (second (assoc "limit" settings :test #'string=))))))))
