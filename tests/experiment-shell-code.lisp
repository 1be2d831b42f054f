;;;; experiment-shell-code.lisp -- at a shell: which code an experiment depends on; shards.

(in-package :ars-magna.tests)

(in-suite experiment-shell)

;;; Code that would end the program, or does not end itself.

(defun write-stroll-that (form &rest more)
  "Write an experiment whose trials evaluate FORM, and after it the forms MORE, as a file."
  (write-file "leaver.lisp" "(defexperiment leaver (:robots ars-worlds:dot) (:trials 2) (:run ~A))~
                             ~{~%~A~}"
              form more))

(test trials.that-would-end-the-program-break-off
  (in-place
    (dolist (form '("(sb-ext:exit :code 0)" "(sb-ext:exit :code 0 :abort t)" "(uiop:quit 0 nil)"))
      (write-stroll-that form)
      (multiple-value-bind (status text) (shell "experiment" (placed "leaver.lisp") "--quiet")
        (is (eql 0 status))
        (is-true (has-words-p text "2 trials" "0 to" "exit would end"))))
    (is-true (has-words-p (getf (ars-magna.experiment:replay-trial 'ars-user::leaver 1 1) :error)
                          "exit would end"))))

(test files.that-would-end-the-program-say-where
  (in-place
    (write-stroll-that "t" "(warn \"Mind the step\")" "(sb-ext:exit)")
    (let* ((said nil)
           (errors (with-output-to-string (*error-output*)
                     (setf said (said-by (lambda ()
                                           (cli::experiment-named (placed "leaver.lisp"))))))))
      (is-true (has-words-p said "leaver.lisp" "line 3" "exit would end"))
      ;; The compiler has nothing to say of that.
      (is-true (has-words-p errors "Mind the step"))
      (is-false (has-words-p errors "compilation")))))

(test threads.that-trials-start-end-by-themselves
  "What nothing handles in them is told of once, with the name of the thread; the program goes on."
  (let ((session cli::*session*) (own-p cli::*own-process-p*) (told '()))
    (setf cli::*session* nil cli::*own-process-p* t)
    (flet ((err () (base:with-debugger-hook ('cli::debugger-disabled-hook) (error "no, boo."))))
      (unwind-protect
           (loop repeat 2
                 do (base:join-thread (bordeaux-threads:make-thread #'err :name "of a trial")))
        (setf told (shiftf cli::*reported-thread-errors* '())
              cli::*session* session cli::*own-process-p* own-p)))
    (is (equal (list (format nil "Error in a thread, of a trial, that a program has started: no, ~
                                  boo. That thread ends; everything else continues."))
               told))))

(test rows.that-come-first-are-checked-when-an-experiment-goes-on
  (in-place
    (write-stroll-that "(progn (run-ticks 3) t)")
    (flet ((go-on (trials)
             (shell "experiment" (placed "leaver.lisp") "--quiet" "--trials" trials
                    "--out" (placed "there"))))
      (is (eql 0 (go-on "5")))
      (is (eql 0 (go-on "6")))
      (let* ((text (text-in "there/rows.csv")) (place (search "success,,3," text)))
        (write-file "there/rows.csv" "~A4~A"
                    (subseq text 0 (+ place 9)) (subseq text (+ place 10))))
      (is-true (has-words-p (said-by (lambda () (go-on "7")))
                            "line 2: This row has changed since its trial" "Delete the line"))
      ;; Without check sums, the trial is run again.
      (delete-file (placed "there/machine.csv"))
      (is-true (has-words-p (said-by (lambda () (go-on "7")))
                            "Trial 1 " "its ticks is 3, and 4 in the table")))))

;;; Directories whose text was edited.

(defun errors-at-a-shell (&rest arguments)
  "Return what ./cli/ars-magna called with ARGUMENTS writes to the error output."
  (nth-value 1 (uiop:run-program (cons (base:native-name (project-file "cli/ars-magna")) arguments)
                                 :error-output :string)))

(test directories.with-an-edited-text-are-told-of-at-a-shell
  (in-place
    (errors-at-a-shell "experiment" (placed "a stroll.lisp") "--trials" "2" "--out" (placed "out"))
    (flet ((told-p (&rest arguments)
             (write-file "out/experiment.txt" "The experiment stroll.~%Check sum: 00000000~%")
             (has-words-p (apply #'errors-at-a-shell arguments)
                          "experiment.txt is damaged or has been changed")))
      (is-true (told-p "merge" (placed "out") "--out" (placed "all")))
      (is-true (told-p "compare" "1" "2" (placed "out")))
      (is-true (told-p "compare" "--by" "motion-noise*" (placed "out")))
      (is-true (told-p "experiment" (placed "a stroll.lisp") "--trials" "2" "--quiet"
                       "--out" (placed "out"))))))

;;; Shards without trials, and directories of other code.

(test shards.without-trials-say-so
  (in-place
    (multiple-value-bind (status text errors)
        (run-stroll "--trials" "3" "--shard" "7/9" "--out" (placed "few"))
      (is (eql 0 status))
      (is (string= "" text))
      (is-true (has-words-p errors "shard 7 of 9 has no trials" "only 3")))
    (is-false (uiop:directory-exists-p (base:native-path (placed "few/"))))
    (is (string= (format nil "1 2 3~%")
                 (nth-value 1 (run-stroll "--trials" "3" "--shards" "9" "--missing"
                                          "--out" (placed "few")))))
    (run-stroll "--trials" "3" "--shard" "3/9" "--out" (placed "few"))
    (is (= 3 (lines-in "few/shard-3-of-9/rows.csv")))
    (run-stroll "--trials" "9" "--shard" "0/9" "--out" (placed "few"))
    (is (= 3 (lines-in "few/shard-0-of-9/rows.csv")))))

(test directories.with-rows-of-other-code-are-not-spread-into
  (in-place
    (run-stroll "--out" (placed "there") "--shard" "0/2")
    (flet ((check ()
             (said-by (lambda ()
                        (ars-magna.experiment:check-same-code
                         (cli::experiment-named (placed "a stroll.lisp")) (placed "there"))))))
      (is (string= "nothing" (check)))
      (write-file "a stroll.lisp" "~A~%" (substitute #\5 #\4 *stroll* :count 1))
      (is-true (has-words-p (check) "shard-0-of-2" "other code" "file a stroll.lisp"))
      (write-file "a stroll.lisp" "(defexperiment stroll (:robots ars-worlds:dot) (:run t))")
      (is-true (has-words-p (check) "shard-0-of-2" "columns")))))

;;; What decides the rows.

(defun fingerprints-now ()
  (let ((experiment (first (cli::load-experiments (base:native-path (placed "a stroll.lisp"))))))
    (ars-magna.experiment::prepare-experiment experiment)
    (mapcar #'ars-magna.experiment::condition-fingerprint
            (ars-magna.experiment:experiment-conditions experiment))))

(test fingerprints.know-the-functions-of-the-file-and-of-those-that-it-loads
  (in-place
    (write-file "far.lisp" "(defun far () 4)")
    (flet ((fingerprints (more)
             (write-file "a stroll.lisp" "~A~%(load (merge-pathnames \"far.lisp\" *load-truename*))"
                         more)
             (with-open-file (out (base:native-path (placed "a stroll.lisp")) :direction :output
                                                                             :if-exists :append)
               (write-string (subseq *stroll* (search "(defexperiment" *stroll*)) out))
             (fingerprints-now)))
      (let ((first (fingerprints "(defun unused () 1)")))
        (is (equal first (fingerprints ";; Other words.
 (defun unused  () 1)")))
        (write-file "far.lisp" "(defun far () 5)")
        (is (not (equal first (fingerprints "(defun unused () 1)"))))
        (write-file "far.lisp" "(defun far () 4)")
        (is (equal first (fingerprints "(defun unused () 1)")))))))

(test fingerprints.know-the-functions-of-the-file
  (in-place
    (let ((first (fingerprints-now)))
      (is (equal first (fingerprints-now)))
      (write-file "a stroll.lisp" "~A~%" (substitute #\5 #\4 *stroll* :count 1))
      (is (not (equal first (fingerprints-now)))))))

(test fingerprints.are-settled-in-a-saved-program
  (in-place
    (let ((first (fingerprints-now)) (ars-magna.experiment::*file-digests-frozen-p* nil))
      (ars-magna.experiment:freeze-file-digests)
      (delete-file (base:native-path (placed "a stroll.lisp")))
      (let ((experiment (ars-magna.experiment:find-experiment 'ars-user::stroll)))
        (flet ((now ()
                 (ars-magna.experiment::prepare-experiment experiment)
                 (mapcar #'ars-magna.experiment::condition-fingerprint
                         (ars-magna.experiment:experiment-conditions experiment))))
          (is (equal first (now)))
          (write-file "a stroll.lisp" "(defun other () 1)")
          (is (equal first (now))))))))

;;; Scripts.

(defun script-settings (settings)
  "Return what a shell makes of SETTINGS, a list of lists (variable value)."
  (let ((text (cli::insert-settings "@SETTINGS@" (loop for (variable value) in settings
                                                       collect (list variable value "what")))))
    (lines-of text)))

(test scripts.have-their-settings-quoted
  (loop for (word line) in '((5 "a=5") ("" "a=") ("two words" "a=\"two words\"")
                             ("it's $x" "a=\"it's \\$x\"") ("8/ssh -p 2 x,`y`"
                                                            "a=\"8/ssh -p 2 x,\\`y\\`\""))
        for written = (first (script-settings `(("a" ,word))))
        do (is (string= line (string-right-trim " " (subseq written 0 (search "#" written))))))
  (dolist (name '("spread-parallel.sh" "spread-slurm.sh"))
    (is-false (search "@SETTINGS@" (cli::insert-settings (cli::shell-text name) '(("a" 1 "one")))))
    (is-true (eql 0 (search (format nil "#!/bin/sh~%") (cli::shell-text name))))))

(test shards.are-of-a-size-that-pays
  (in-place
    (let ((experiment (cli::experiment-named (placed "a stroll.lisp"))))
      (loop for (trials script shards) in '((5 "run.sh" 5) (100 "run.sh" 16) (10000 "run.sh" 40)
                                            (1000000 "run.sh" 1000) (100 "job.sh" 1)
                                            (100000 "job.sh" 40) (10000000 "job.sh" 1000))
            do (is (= shards (cli::default-shard-count experiment trials script))
                   "~D trials by ~A" trials script)))))

(test scripts.that-somebody-has-changed-are-kept
  (in-place
    (flet ((write-script (text)
             (with-output-to-string (*error-output*)
               (cli::write-script "run.sh" text (uiop:parse-native-namestring *place*)))))
      (is (string= "" (write-script "one")))
      (is (string= "" (write-script "one")))
      (is-true (has-words-p (write-script "two") "run.sh~"))
      (is (string= "two" (text-in "run.sh")))
      (is (string= "one" (text-in "run.sh~"))))))

(test files.of-definitions-that-only-the-builders-of-lisp-had-are-no-errors
  ;; Debian 13 has a logical pathname here that names no file.
  (is (listp (host:files-of-other-definitions (uiop:find-symbol* "O-RDONLY" "SB-POSIX")))))
