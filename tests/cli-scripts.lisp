;;;; cli-scripts.lisp -- files of prompt lines, and programs that talk to the prompt.

(in-package :ars-magna.tests)

(def-suite* cli-scripts :in ars-magna)

;;; In this Lisp.

(defun with-script-named (name line)
  "Return LINE with SCRIPT for NAME, if that is in it."
  (let ((start (search name line)))
    (if start
        (uiop:strcat (subseq line 0 start) "SCRIPT" (subseq line (+ start (length name))))
        line)))

(defun call-as-process (arguments)
  "Do what ./cli/ars-magna does with ARGUMENTS. Return the lines that it writes to the standard
output, its status, and what it writes to the error output."
  (let* ((output (make-string-output-stream))
         (errors (make-string-output-stream))
         (base:*message-queue* (base:make-message-queue))
         (cli::*prompt-robot* nil)
         (status (let ((*standard-output* (cli::make-console output)) (*error-output* errors))
                   (handler-case (let ((*trace-output* *trace-output*)
                                       (*debug-io* *debug-io*) (*terminal-io* *terminal-io*))
                                   (cli::run-with-arguments arguments))
                     (cli::usage-error (condition)
                       (format errors "~A" condition)
                       2)))))
    (values (lines-of (get-output-stream-string output)) status
            (get-output-stream-string errors))))

(defun run-script (text &rest options)
  "Return what CALL-AS-PROCESS does for a script of TEXT with OPTIONS; its name is SCRIPT in what is
written."
  (uiop:with-temporary-file (:pathname path :stream stream :type "ars")
    (write-string text stream)
    :close-stream
    (let ((name (uiop:native-namestring path)))
      (multiple-value-bind (lines status errors)
          (call-as-process (list* name "--world" "tiny" options))
        (values (mapcar (lambda (line) (with-script-named name line)) lines) status errors)))))

(test scripts.tell-of-plans-that-their-end-cuts-off
  "In the words of the prompt: what lets ticks pass there is a line."
  (flet ((told (&rest lines)
           (nth-value 2 (run-script (joined lines)))))
    (let ((begin "(begin-plan (interp-lambda () (wait-time 50)))"))
      (dolist (said (list (told begin) (told "turn 90 deg" begin) (told begin "step 3")))
        (is-true (has-words-p said "the plan" "STEP N passes N ticks"))
        (is (null (search "with-simulation" said)))
        (is (null (search "run-ticks" said))))
      (is (string= "" (told begin "step 60"))))))

(defparameter *small-script*
  (joined '("#!/usr/bin/env ars-magna" "# a comment" "turn 90 deg" "(+ 1" "  2)" "frobnicate"
            "turn 1")))

(test scripts.are-done-line-by-line-and-tell-where-they-err
  (multiple-value-bind (lines status) (run-script *small-script*)
    (is (= 1 status))
    (is (= 4 (length lines)) "~A" lines)
    (is-true (has-words-p (first lines) "robot-turn: Robot turned"))
    (is (string= "3" (second lines)))
    (is-true (has-words-p (third lines) "*ERROR* -> SCRIPT, line 6: There is no command"))
    (is-true (has-words-p (fourth lines) "robot-turn: Robot turned"))))

(test scripts.are-not-swallowed-by-what-clears-input
  (is (equal '("NIL" "3" "(T NIL)" "5")
             (loop for line in (run-script "(clear-input)
(+ 1 2)
(list (y-or-n-p) (y-or-n-p))
y
n
(+ 2 3)")
                   when (or (search "NIL" line) (every #'digit-char-p line))
                     collect (subseq line (or (search "(T" line) 0))))))

(test scripts.the-rest-of-an-answer-is-no-line
  (multiple-value-bind (lines status) (run-script "(list (y-or-n-p))
yes
(list (read-char))
y (+ 1 1)
(+ 2 3)")
    (is (= 0 status) "~A" lines)
    (is (equal '("2" "5") (remove-if-not (lambda (line) (every #'digit-char-p line)) lines)))))

(test scripts.have-comments-over-lines
  (multiple-value-bind (lines status)
      (run-script "#| One, #| and another in it,
go 99 |# over
frobnicate |# (+ 1 2) #| behind a form
frobnicate |# (+ 2 2) ; #| none
(list 1 #| in a form
 |# 2) #| |#
turn 0 #| behind a line
frobnicate
|#
(length \"#| no\")
frobnicate")
    (is (= 1 status))
    (is (equal '("3" "4" "(1 2)") (subseq lines 0 3)))
    (is-true (has-words-p (fourth lines) "Robot turned"))
    (is (string= "5" (fifth lines)))
    (is (= 6 (length lines)) "~A" lines)
    (is-true (has-words-p (sixth lines) "line 11: There is no command")))
  (is-true (has-words-p (first (run-script (format nil "turn 0~%#| no end~%turn 1") "--stop"))
                        "Robot turned"))
  (is-true (has-words-p (second (run-script (format nil "turn 0~%#| no end~%turn 1")))
                        "line 2: The comment" "does not end")))

(test scripts.tell-what-is-not-defined
  (let ((lines (run-script "(defun ars-user::double-of (x) (* x yy (half-of x)))
(defun ars-user::even-p (n) (if (= n 0) t (odd-p (- n 1)))) (defun odd-p (n) (not (even-p n)))
(defun ars-user::half-of (x) (/ x 2))
(null (setf zz 3))
(half-of 8)")))
    (is (equal '("SCRIPT, line 1: The function half-of is not defined."
                 "SCRIPT, line 1: The variable yy is not defined.")
               (loop for line in lines
                     when (search "*WARNING* -> " line) collect (subseq line 13)))
        "~A" lines)))

(test scripts.end-with-a-status
  (flet ((status (text &rest options) (nth-value 1 (apply #'run-script text options))))
    (is (= 0 (status "turn 1")))
    (is (= 0 (status "")))
    (is (= 1 (status "(car 1)")))
    (is (= 1 (status "bin-open 7")))
    (is (= 0 (status (format nil "quit~%frobnicate")))))
  (multiple-value-bind (lines status errors) (call-as-process '("no-such-script" "--json"))
    (is (null lines))
    (is (= 2 status))
    (is-true (has-words-p errors "no-such-script" "nor a file" "experiment"))))

(test scripts.stop-at-an-error-if-told-to
  (multiple-value-bind (lines status) (run-script *small-script* "--stop")
    (is (= 1 status))
    (is (= 3 (length lines)) "~A" lines))
  (is (= 1 (length (run-script (format nil "bin-open 0~%bin-open 0~%turn 1") "--stop"
                               "--world" "watson")))
      "what the robot cannot do is an error too"))

(test scripts.are-the-same-run-each-time
  (flet ((digest (&rest options)
           (first (last (apply #'run-script (format nil "go 2~%turn 1~%(state-digest)") options)))))
    (is (string= (digest "--seed" "3") (digest "--seed" "3")))
    (is (string/= (digest "--seed" "3") (digest "--seed" "4")))))

;;; JSON.

(defun json-text (value)
  (with-output-to-string (out) (cli::write-json value out)))

(test json.is-written-as-it-should-be
  (is (string= "{\"a_b\":1,\"c\":[1.5,null,true,false,\"red\"],\"d\":{\"e\":\"x\"}}"
               (json-text '(:a-b 1 :c #(1.5d0 nil t :false red) :d (:e "x")))))
  (is (string= "\"q\\\" b\\\\ \\u000A \\u0007 é\""
               (json-text (format nil "q\" b\\ ~C ~C é" #\Newline (code-char 7)))))
  (is (string= "[0.3333333333333333,-2,1.0e20]" (json-text #(1/3 -2 1d20))))
  (is (string= "[]" (json-text #()))))

(defun objects-of-script (text &rest options)
  "Return the lines that a script of TEXT makes with --json and OPTIONS, but the first."
  (rest (apply #'run-script text "--json" options)))

(test json.is-all-that-is-written
  "Also what is traced and timed."
  (dolist (line (objects-of-script "(time (+ 1 2))
(format *trace-output* \"traced~%\")
(format *debug-io* \"debugged~%\")
(format *terminal-io* \"typed~%\")
(uiop:print-backtrace :count 3)
(defun ars-user::traced (x) x)
(trace ars-user::traced)
(ars-user::traced 1)
(untrace)"))
    (is (eql 0 (search "{\"type\":" line)) line)))

(test json.tells-each-message-and-each-end-of-a-line
  (let ((objects (run-script *small-script* "--json")))
    (is-true (has-words-p (first objects) "\"type\":\"begin\"" "\"world\":\"tiny\""
                          "\"rate\":null"))
    (loop for object in (rest objects)
          for words in '(("\"message\"" "\"kind\":\"message\"" "Robot turned" "\"line\":3")
                         ("\"done\"" "\"line\":3" "\"text\":\"turn 90 deg\"" "\"ok\":true")
                         ("\"value\"" "\"text\":\"3\"")
                         ("\"done\"" "\"line\":4" "\"ok\":true")
                         ("\"message\"" "\"kind\":\"error\"" "\"text\":\"There is no" "\"line\":6")
                         ("\"done\"" "\"line\":6" "\"ok\":false")
                         ("\"message\"" "\"line\":7")
                         ("\"done\"" "\"line\":7")
                         ("\"end\"" "\"status\":1" "\"errors\":1"))
          do (is-true (apply #'has-words-p object words) "~A" object))
    (is (= 10 (length objects)))))

(test json.has-the-status-as-data
  (let ((object (first (objects-of-script "status"))))
    (is-true (has-words-p object "\"type\":\"status\"" "\"tick\":0" "\"robot\":\"dot\""
                          "\"position\":[" "\"cameras\":[{" "\"view\":["
                          "\"live\":" "\"failed\":null" "\"designators\":[]"))))

(test json.keeps-text-without-a-newline-apart
  (is-true (has-words-p (joined (objects-of-script "(progn (princ \"half\") (error \"no\"))"))
                        "{\"type\":\"output\",\"text\":\"half\"}" "\"kind\":\"error\"")))

;;; What cli/README.md shows.

(defun blocks-of-kind (kind)
  (remove kind (page-blocks "cli/README.md") :key #'page-block-kind :test-not #'equal))

(test cli-readme.its-script-goes-there-and-back
  (let* ((block (find "Scripts" (blocks-of-kind "text") :key #'page-block-heading
                                                        :test #'string=)))
    (multiple-value-bind (lines status)
        (run-script (joined (page-block-lines block)) "--world" "hall" "--seed" "7")
      (is (= 0 status))
      (is-true (has-words-p (car (last lines)) "at ") "~A" lines))))

(test cli-readme.its-numbers-are-read
  (let ((lines (loop for line in (page-block-lines (first (blocks-of-kind "text")))
                     append (remove "" (mapcar (lambda (start)
                                                 (string-trim " " (subseq line start
                                                                          (search "  " line
                                                                                  :start2 start))))
                                               (column-starts line))
                                    :test #'string=))))
    (is (< 6 (length lines)))
    (is (= 0 (nth-value 1 (run-script (joined (cons "pos 48 15" lines)) "--world" "hall")))
        "~A" lines)))

(defun column-starts (line)
  "Return where the columns of LINE begin, which are two blanks or more apart."
  (cons 0 (loop for i from 2 below (length line)
                when (and (char/= #\Space (char line i)) (string= "  " (subseq line (- i 2) i)))
                  collect i)))

(test cli-readme.its-line-can-be-typed
  (let ((cli::*line-commands* cli::*line-commands*)
        (*package* (find-package :ars-magna.cli)))
    (dolist (block (blocks-of-kind "lisp"))
      (load (make-string-input-stream (joined (page-block-lines block)))))
    (is (equal '("5.00") (type-batch "pos 3 4" "how-far 6 8")))
    (is-true (has-words-p (joined (type-batch "help how-far")) "HOW-FAR x y" "how far the robot"))))

(test cli-readme.its-python-talks-to-the-prompt
  (let ((python (first (blocks-of-kind "python"))))
    (if (eql 0 (base:run-command "python3" '("--version")))
        (multiple-value-bind (status text)
            (base:run-command "env" (list "-C" (uiop:native-namestring (project-file ""))
                                          "python3" "-c" (joined (page-block-lines python)))
                              :output :string)
          (is (eql 0 status))
          (is (equal (page-block-lines (car (last (blocks-of-kind "text")))) (lines-of text))))
        (skip "There is no python3: nobody talks to the prompt."))))

(test scripts.place-errors-of-commands-too
  (let ((lines (run-script (joined '("turn 1" "place-desig 0 attic")))))
    (is-true (has-words-p (second lines) "*ERROR* -> SCRIPT, line 2:" "ATTIC is not a place type")
             "~A" lines)))

(test scripts.may-begin-with-a-mark-of-the-order-of-bytes
  (is (= 0 (nth-value 1 (run-script (format nil "~Cturn 1" (code-char #xFEFF)))))))

(test scripts.leave-errors-on-the-way-to-who-goes
  "Of GO-TO only its own end counts."
  (flet ((came (text)
           (multiple-value-list (run-script text "--seed" "2" "--stop"))))
    (destructuring-bind (lines status errors)
        (came (format nil "go-to 9 9~%go-to 2 9~%(+ 1 2)"))
      (declare (ignore errors))
      (is-true (find "Robot is blocked" lines :test #'search))
      (is (equal "3" (car (last lines))))
      (is (= 0 status)))
    (is (= 1 (second (came (format nil "go-to 500 500~%")))))))

(test scripts.may-come-last
  (uiop:with-temporary-file (:pathname path :stream stream :type "ars")
    (write-string "(+ 1 2)" stream)
    :close-stream
    (is (equal '("3") (call-as-process (list "--world" "tiny" (uiop:native-namestring path)))))
    (is (= 2 (nth-value 1 (call-as-process '("--world" "tiny" "no-such-script")))))))

(test json.tells-values-from-text
  (is-true (has-words-p (joined (objects-of-script "(progn (print 1) (values 2 \"three\"))"))
                        "{\"type\":\"output\",\"text\":\"1 \"}"
                        "{\"type\":\"value\",\"text\":\"2\"}"
                        "{\"type\":\"value\",\"text\":\"\\\"three\\\"\"}")))

(test scripts.place-warnings-about-definitions
  (let ((text (joined (run-script (joined '("say hello" "(defmap kolored (9 9)"
                                            "  (obj pen (3 3) ((:kolor 1))))"))))))
    (is-true (has-words-p text "*WARNING* -> SCRIPT, line 2: defmap kolored: pen has :kolor"))))

(defun script-with-bytes (&rest parts)
  "Return what RUN-SCRIPT does for PARTS, strings, with a byte that is no UTF-8 between each two."
  (uiop:with-temporary-file (:pathname path :stream stream :type "ars"
                             :external-format :latin-1)
    (format stream (format nil "~~{~~A~~^~C~~}" (code-char 233)) parts)
    :close-stream
    (call-as-process (list (uiop:native-namestring path) "--world" "tiny"))))

(test scripts.refuse-lines-that-are-not-utf-8
  "In forms and commands; comments may have any bytes."
  (multiple-value-bind (lines status)
      (script-with-bytes (format nil "; caf") (format nil "~%(print \"caf")
                         (format nil "\")~%(list 1~%  \"") (format nil "\"~%  2)~%say caf")
                         (format nil "~%(print :good)~%"))
    (is (= 1 status))
    (is (= 3 (count-if (lambda (line) (search "*ERROR*" line)) lines)))
    (loop for number in '(2 4 6)
          do (is-true (find-if (lambda (line)
                                 (has-words-p line (format nil "line ~D: The line has bytes" number)
                                              "UTF-8"))
                               lines)))
    (is-true (find ":GOOD" lines :test #'search))))

(test load.of-a-name-for-many-files-says-what-to-write
  (is-true (has-words-p (joined (run-script (joined '("(load \"st*r.lisp\")"))))
                        "line 1: st*r.lisp cannot be loaded" "write \\\\ before each *")))
