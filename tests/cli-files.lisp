;;;; cli-files.lisp -- the file of a world means the same however it is loaded; source places.

(in-package :ars-magna.tests)

(def-suite* cli-files :in ars-magna)

;;; Roads to a world.

(defun substance-on-road (road)
  "Load a file in Nisp's syntax, with a wall whose parameter is a decimal fraction, by ROAD, a
function of its name. Return that parameter."
  (uiop:with-temporary-file (:pathname path :stream out :type "lisp")
    (format out "(defmap barn (9 9) (rect (0 0) (8 8) bricks 0.1))~@
                 (defvar *truth* #t)~@
                 (defrobot cow (barn (4 4) 0))")
    :close-stream
    (base:with-own-definitions ()
      (funcall road (uiop:native-namestring path))
      (world:cell-substance-parameter (world:map-cell (world:find-map 'barn) 0 0)))))

(defun road-by-line (control)
  "Return the road of the line that CONTROL makes of a file's name."
  (lambda (name) (type-batch (format nil control name))))

(defparameter *roads*
  (list (cons "--world and WORLD" #'cli::robot-names-in-world)
        (cons "(load ...)" (road-by-line "(load ~S)"))
        (cons "world" (road-by-line "world ~S"))
        (cons "--load" (lambda (name)
                         (type-lines '() :batch t :files (list name)))))
  "Ways to load a file of a world, by what a user calls them.")

(test worlds.are-the-same-on-all-roads
  (loop for (name . road) in *roads*
        do (is (= (float 0.1f0 1d0) (substance-on-road road)) "~A" name)))

(test numbers.typed-are-exact
  (is (equal '("0.1") (type-batch "(values 0.1)")))
  (is (equal '("T") (type-batch "(typep 0.1 'double-float)"))))

(test names-of-files.may-have-any-characters
  (dolist (name '("a b" "a'b" "a*b" "a?b" "a[b]" "-a" "é" "a\\b"))
    (uiop:with-temporary-file (:pathname path)
      (let* ((directory (uiop:native-namestring (uiop:pathname-directory-pathname path)))
             (file (format nil "~Aars-magna ~A.lisp" directory name)))
        (unwind-protect
             (progn (with-open-file (out (base:native-path file) :direction :output)
                      (format out "(defmap shed (5 5)) (defrobot hen (shed (2 2) 0))"))
                    (base:with-own-definitions ()
                      (is (equal '("HEN")
                                 (mapcar #'symbol-name (cli::robot-names-in-world file)))
                          "~A" name)))
          (delete-file (base:native-path file)))))))

(test experiments.may-be-in-files-and-directories-of-any-name
  "Lisp takes * ? and [ for patterns; the system and its users do not."
  (base:with-own-definitions ()
    (dolist (name '("s*t?" "s[x"))
      (call-in-directory
       (lambda (directory)
         (let* ((inner (base:native-path-of-directory
                        (format nil "~A~A" (base:native-name directory) name)))
                (file (format nil "~A~A.lisp" (base:native-name inner) name))
                (rows (format nil "~Arows ~:*~A" (base:native-name inner) name)))
           (base:make-directories inner)
           (base:call-replacing-file
            (lambda (out)
              (format out "(defmap shed (5 5 :cache \"shed.map\")) (defrobot hen (shed (2 2) 0))~@
                           (defun half (x) (/ x 2))~@
                           (defexperiment rest-a-while (:robots hen) (:trials 2) (:limit 3)~@
                             (:run (run-ticks (half 2))) (:success t))"))
            (base:native-path file))
           (let ((experiment (cli::experiment-named file)))
             (is (equal file (experiment:experiment-file experiment)))
             (experiment:run-experiment experiment :directory rows :stream nil)
             (is (= 2 (experiment:count-rows rows)))
             (is-true (base:existing-path (base:native-path
                                           (format nil "~Ashed.map" (base:native-name inner))))
                      "the cache is beside the file")
             (is (search (format nil "experiment ~A.lisp rest" name)
                         (base:file-text (base:native-path
                                          (format nil "~A/experiment.txt" rows))))))))))))

(test mistakes.in-files-of-any-name-are-told-with-that-name-and-line
  (call-in-directory
   (lambda (directory)
     (let ((file (format nil "~As*t.lisp" (base:native-name directory))))
       (base:call-replacing-file (lambda (out) (format out "~%(defmap shed (5 5) (wal (1 1)))"))
                                 (base:native-path file))
       (handler-case (progn (cli::load-lisp (base:native-path file)) (fail))
         (base:malformed-definition (condition)
           (is (search (format nil "~A, line 2" file) (princ-to-string condition)))))))))

;;; What cannot be read.

(defun trouble-in-file (text)
  "Return what is said of a world's file that has TEXT, without the file's name."
  (uiop:with-temporary-file (:pathname path :stream out :type "lisp")
    (write-string text out)
    :close-stream
    (handler-case (progn (cli::load-lisp path) "")
      (cli::file-trouble (condition)
        (let ((text (princ-to-string condition)))
          (subseq text (search ", line " text)))))))

(test worlds.that-make-no-sense-are-told-without-packages
  (uiop:with-temporary-file (:pathname path :stream out :type "lisp")
    (write-string "(defmap pen (9 9) (obj t12345))" out)
    :close-stream
    (base:with-own-definitions ()
      (handler-case (cli::robot-names-in-world (base:native-name path))
        (error (condition)
          (let* ((*package* (find-package :cl-user)) (said (cli::ending-message condition)))
            (is-true (has-words-p said "(obj t12345)") "~A" said)))))))

(test files.that-cannot-be-read-say-so-in-plain-words
  (loop for (text line cause) in '(("(values 1)~%(values 2" "line 2" "parenthesis")
                                   ("(values 1)~%~%(values 2))" "line 3" "parenthesis")
                                   ("~%(values 1e400)" "line 2" "too large")
                                   ("(values 51/0)" "line 1" "divided by 0")
                                   ("(values 1)~%(nowhere:f)" "line 2" "NOWHERE")
                                   ("(values~%'(a~%nowhere:f~%)~%)" "line 3" "NOWHERE")
                                   ("(values~%~%1 ; #~%#] 2)" "line 4" "dispatch"))
        for said = (trouble-in-file (format nil text))
        do (is-true (has-words-p said line "cannot be read" cause) "~A" said)
           (is (not (search "STREAM" said)) "~A" said)))

(defun complaint-about-file (text control &optional (external-format :utf-8))
  "Return what the line says that CONTROL makes of the name of a file with TEXT."
  (uiop:with-temporary-file (:pathname path :stream out :type "lisp"
                             :external-format external-format)
    (write-string text out)
    :close-stream
    (complaint (format nil control (uiop:native-namestring path)))))

(defun complaint-of-loading (text)
  "Return what a line says that loads a file with TEXT."
  (complaint-about-file text "(load ~S)"))

(test files.that-lisp-loads-say-where-they-cannot-be-read
  (loop for (text . words) in '(("(values 1)~%~%(values nowhere:f)" "line 3" "NOWHERE" "misspelt")
                                ("(values 1)~%(cl:no-such 1" "line 2" "NO-SUCH" "COMMON-LISP"
                                 "misspelt")
                                ("; one~%(values 'ars-magna.cli::zip)~%(ars-magna.cli:zip)" "line 3"
                                 "ZIP" "two colons")
                                ("~%(values 1)~%(list 1~%2" "line 3" "parenthesis")
                                ("~%(list~%1~%nowhere:f~%2)" "line 4" "NOWHERE")
                                ("(list~%1~%#]~%2)" "line 3" "dispatch")
                                ("(list~%1~%))~%2)" "line 3" "parenthesis"))
        for said = (complaint-of-loading (format nil text))
        do (is-true (apply #'has-words-p said "cannot be read" words) "~A" said)
           (is (not (search ".." said)) "~A" said)))

(test files.in-another-encoding-say-so-and-where
  (loop for (text line) in '(("(print \"ä\")~%" "line 1: ") ("(values 1)~%~%ä~%" "line 3: ")
                             ("~A(values 1)" "line 1: ") ("(values 1~%ä)" "line 2: "))
        for said = (complaint-about-file (format nil text (code-char 255)) "(load ~S)" :latin-1)
        do (is-true (has-words-p said line "cannot be read: it has bytes that are not UTF-8. Save")
                    "~A" said))
  (let ((said (complaint-about-file "ä" "(with-open-file (in ~S) (read-line in))" :latin-1)))
    (is-true (has-words-p said ".lisp cannot be read: it has bytes that are not UTF-8") "~A" said)))

(defun told-of-compiling (text)
  "Return the lines that a batch answers which compiles a file with TEXT, one error or more."
  (uiop:with-temporary-file (:pathname path :stream out :type "lisp")
    (write-string text out)
    :close-stream
    (prog1 (remove-if-not (lambda (line) (uiop:string-prefix-p "*" line))
                          (type-batch (format nil "(compile-file ~S)" (base:native-name path))))
      (uiop:delete-file-if-exists (compile-file-pathname path)))))

(test files.that-are-compiled-say-where-they-cannot-be
  (loop for (text . words) in
        '(("~%(list 1)~%(nowhere:f)" "*ERROR*" "line 3: " "cannot be read" "NOWHERE")
          ("(list 1)~%(list 2))" "*ERROR*" "line 2: " "unmatched close parenthesis")
          ("(list 1)~%~%(list 2" "*ERROR*" "line 3: " "it ends too early")
          ("(defun f ()~%  (let ((1 2)) 3))" "*ERROR*" "line 2: " "1 is not a symbol")
          ("(defun f (x)~%  (list x~%    (car)))" "*WARNING*" "line 3: " "CAR" "zero arguments"))
        for told = (told-of-compiling (format nil text))
        do (is (= 1 (length told)) "~A" told)
           (is-true (apply #'has-words-p (first told) ".lisp, " words) "~A" told)))

(test files.that-are-compiled-well-need-no-words
  "Matters of style, and what a program muffles, are not told."
  (is (null (told-of-compiling "(defun f (x) 1) (eval-when (:compile-toplevel) (list (list 1)))")))
  (is (null (told-of-compiling "(locally (declare (sb-ext:muffle-conditions warning)) (car))"))))

(test worlds.of-a-file-begin-with-its-first-robot
  "However often it is loaded, and whatever had its robots' names before."
  (flet ((robots (&rest names)
           (uiop:with-temporary-file (:pathname path :stream out :type "lisp")
             (format out "(defmap byre (9 9))~{(defrobot ~A (byre (4 4) 0))~}" names)
             :close-stream
             (loop repeat 2
                   collect (mapcar #'symbol-name
                                   (cli::robot-names-in-world (uiop:native-namestring path)))))))
    (base:with-own-definitions ()
      (is (equal '(("ROBBIE" "COW") ("ROBBIE" "COW")) (robots "robbie" "cow")))
      (is (equal '(("COW" "ROBBIE") ("COW" "ROBBIE")) (robots "cow" "robbie"))))))

(test forms.over-lines-are-read-once-more
  "What is evaluated while a form is read is so for its first line, and for the whole."
  (is (equal '("*TIMES-READ*" "(2 2 3 4 5)")
             (type-batch "(defparameter *times-read* 0)"
                         "(list #.(incf *times-read*)" "2" "3" "4" "5)"))))

(test numbers.that-cannot-be-read-say-so-in-plain-words
  (dolist (line '("turn 1e400" "turn 51/0" "(+ 1 1e400)" "(read-from-string \"(1\")"))
    (let ((said (complaint line)))
      (is-true (has-words-p said "cannot be read") "~A" said)
      (is (not (search "STREAM" said)) "~A" said))))

(test definitions.that-are-doubtful-are-told-on-the-command-line
  (uiop:with-temporary-file (:pathname path :stream out :type "lisp")
    (format out "(defmap doubtful-barn (9 9) (rect (0 0) (8 8) bricks 0.1))~@
                 (warn 'ars-magna.base:definition-warning :text \"is that meant?\")~@
                 (defrobot doubtful-cow (doubtful-barn (4 4) 0))")
    :close-stream
    (base:with-own-definitions ()
      (let ((*standard-output* (make-string-output-stream))
            (base:*message-queue* (base:make-message-queue)))
        (cli::run-prompt (cli::parse-options (list "--batch" "--plan" "no-such-plan" "--world"
                                                   (uiop:native-namestring path))))
        (is-true (search "is that meant?" (get-output-stream-string *standard-output*)))))))

(defun prompt-loading (text &rest arguments)
  "Return what the program writes with ARGUMENTS, when --load gives a file with TEXT."
  (uiop:with-temporary-file (:pathname path :stream out :type "lisp")
    (write-string text out)
    :close-stream
    (base:with-own-definitions ()
      (let ((*standard-output* (make-string-output-stream))
            (base:*message-queue* (base:make-message-queue)))
        (cli::run-prompt (cli::parse-options (list* "--load" (uiop:native-namestring path)
                                                    arguments)))
        (get-output-stream-string *standard-output*)))))

(test files.may-define-the-world-that-the-options-ask-for
  (let ((text "(defmap late-barn (9 9)) (defrobot late-cow (late-barn (4 4) 0))"))
    (dolist (options '(("--world" "late-barn") ("--robot" "late-cow")))
      (is (search "no plan NO-SUCH"
                  (apply #'prompt-loading text "--batch" "--plan" "no-such" options))))
    (signals cli::usage-error
      (prompt-loading text "--batch" "--plan" "no-such" "--world" "nowhere"))
    (is (search "line 1"
                (handler-case (prompt-loading "(car 5)" "--batch" "--world" "late-barn")
                  (cli::usage-error (condition) (princ-to-string condition)))))))

;;; The shell script.

(defun status-of-script (arguments)
  "Return the status of ./cli/ars-magna with ARGUMENTS, shell text."
  (values (base:run-command "sh" (list "-c" (format nil "exec \"$0\" ~A" arguments)
                                       (base:native-name (project-file "cli/ars-magna"))))))

(test script.says-what-goes-wrong
  (is (eql 0 (status-of-script "--version")))
  (is (eql 1 (status-of-script "--version >/dev/full")))
  (is (eql 2 (status-of-script "--list --world \"$(printf 'caf\\351')\" </dev/null"))))

;;; Other files.

(test names-of-journals.may-have-any-characters
  (dolist (name '("a b" "a*b" "a?b" "[ab]" "é" "a\\b"))
    (let ((file (format nil "~Aars-magna ~A.journal"
                        (uiop:native-namestring (uiop:temporary-directory)) name)))
      (unwind-protect
           (is (= 0 (nth-value 1 (type-batch "turn 1" (format nil "save-journal \"~A\"" file)
                                             (format nil "replay \"~A\"" file))))
               "~A" name)
        (when (probe-file (base:native-path file)) (delete-file (base:native-path file)))))))

(test files.of-other-kinds-say-what-reads-them
  (let ((journal (format nil "~A~%(ars-magna-journal 2 (robots))~%" run::+journal-title+)))
    (is-true (has-words-p (complaint-of-loading journal) "the file is a journal; (replay FILE)"))
    (uiop:with-temporary-file (:pathname path :stream out :type "ars")
      (write-string journal out)
      :close-stream
      (dolist (function (list #'cli::load-lisp
                              (lambda (path)
                                (cli::run-with-arguments (list (uiop:native-namestring path))))))
        (is-true (has-words-p (said-by (lambda () (funcall function path)))
                              "the file is a journal; (replay FILE)"))))))

(test files.that-are-scripts-of-lines-say-so
  (dolist (said (list (complaint-of-loading (format nil "; mine~%turn 1~%go 3~%"))
                      (trouble-in-file (format nil "(values 1)~%turn 1~%go 3~%"))))
    (is-true (has-words-p said "TURN is a command of the prompt"
                          "looks like a script. Run it by: ars-magna "))))

(test files.that-are-being-loaded-are-named-when-a-batch-is-ended
  "By a time limit or control C; and so are lines that are piped in."
  (uiop:with-temporary-file (:pathname path :stream out :type "lisp")
    (format out "(list 1)~%(loop (handler-case (progn (write-line \"BEGUN\") (finish-output) (loop))
  (t () nil)))~%")
    :close-stream
    (let* ((name (uiop:native-namestring path)) (place (format nil "stopped in ~A, line 2: " name)))
      (multiple-value-bind (errors status) (run-script-apart "" "--load" name "--time-limit" "0.5")
        (is (= 124 status))
        (is (mentions-p errors (format nil "~Athe time limit of 0.5 s" place))))
      (is (mentions-p (nth-value 1 (patience-of-script "" "--load" name))
                      (format nil "~AControl-C was pressed again" place)))))
  (is (mentions-p (nth-value 1 (uiop:run-program
                                (list (base:native-name (project-file "cli/ars-magna"))
                                      "--batch" "--time-limit" "0.5")
                                :input (make-string-input-stream (format nil "~%(loop)~%"))
                                :error-output :string :ignore-error-status t))
                  "line 2: stopped: the time limit of 0.5 s")))
