;;;; cli-forms.lisp -- forms and comments over several lines, some of which cannot be read.

(in-package :ars-magna.tests)

(in-suite cli-scripts)

(defun ends-of-lines (text &rest options)
  "Return the numbers of lines with a done in a script of TEXT with OPTIONS, a list, negative if not
ok."
  (loop for object in (apply #'objects-of-script text options)
        when (search "\"type\":\"done\"" object)
          collect (let ((line (parse-integer object :start (+ 7 (search "\"line\":" object))
                                                    :junk-allowed t)))
                    (if (search "\"ok\":true" object) line (- line)))))

(defun text-of-bytes (count)
  (make-string count :initial-element #\x))

(defparameter *too-many* (1+ cli::+longest-line-typed+) "How many bytes no line has.")

(test forms.that-cannot-be-read-are-passed-over-to-their-end
  "No line of the rest is a command."
  (dolist (form '("(list foo:bar~%turn 1~%)" "(list #<x>~%turn 1~%)" "(list 1 . 2 3~%turn 1~%)"
                  "(list~%foo:bar ; )~%\"a)\\\")~%\" #\\) |)~%)|~%#| #| ) |# )~%|# #\\(~%turn 1)"
                  "(list foo:bar) (list~%1~%)" "(list #.(error \"no\")~%(turn~%1))"))
    (let ((text (format nil form)))
      (is (equal (list -1 (+ 2 (count #\Newline text)))
                 (ends-of-lines (format nil "~A~%turn 2~%" text)))
          "~A" form))))

(test forms.that-cannot-be-read-and-do-not-end-are-one-error
  (is (equal '(-1) (ends-of-lines (format nil "(list foo:bar~%turn 1~%"))))
  (is (equal '(-1 2) (ends-of-lines (format nil "(list foo:bar))~%turn 1~%"))))
  (is (equal '(-1 2) (ends-of-lines (format nil "#<x>~%turn 1~%")))))

(test forms.with-a-line-that-is-too-long-are-passed-over-to-their-end
  (let ((long (text-of-bytes *too-many*)))
    (is (equal '(-1 5) (ends-of-lines (format nil "(list~%~A~%turn 1~%)~%turn 2~%" long))))
    (is (equal '(-1 4) (ends-of-lines (format nil "(list ~A~%turn 1~%)~%turn 2~%" long))))
    (is (equal '(-1 3) (ends-of-lines (format nil "(list~%\"~A\")~%turn 2~%" long))))
    (is (equal '(4) (ends-of-lines (format nil "#|~%~A~%turn 1|#~%turn 2~%" long))))
    (is (equal '(-1 2) (ends-of-lines (format nil "~A~%turn 2~%" long))))))

(test forms.with-a-mistake-are-told-with-its-line
  (loop for (form line) in '(("(defmap pen (9 9)~%(wall (1 1) (1 3) wood 2)~%(wal (2 2)))" 3)
                             ("#| a~%b |# (defmap pen (9 9)~%(wal (2 2)))" 3)
                             ("(progn~%(defmap pen (9 9)~%(wal (2 2))~%))" 3)
                             ("(list~%'(1~%nowhere:f~%2)~%)" 3)
                             ("(list~%nowhere:f 2)" 2)
                             ("(list 1)~%(list~%1" 2)
                             ("(list 1~%(car 2))" 1))
        for said = (find "*ERROR*" (run-script (format nil form)) :test #'search)
        do (is-true (has-words-p said (format nil "line ~D:" line)) "~A: ~A" form said)))

(test forms.of-many-lines-are-read-in-memory-in-proportion
  (flet ((bytes-for (form ends)
           (bytes-consed-by (lambda ()
                              (is (equal ends (ends-of-lines (format nil "~A~%turn 2~%" form)))))
                            1)))
    (let ((lines (format nil "~{~A~%~}" (loop repeat 4000 collect "(list a line of a form)"))))
      (is (> 150000000 (bytes-for (format nil "(length '(1~%~A))" lines) '(1 4003))))
      (is (> 150000000 (bytes-for (format nil "(list foo:bar~%~A)" lines) '(-1 4003)))))))

(test comments.may-be-of-any-length
  (let ((long (text-of-bytes *too-many*)))
    (is (equal '(2 4) (ends-of-lines (format nil "; ~A~%turn 1~%# ~:*~A~%turn 2~%" long))))))

(test comments.that-are-longer-than-a-line-leave-what-is-behind-them
  "Unless it is itself in a line that is too long."
  (let ((long (text-of-bytes *too-many*)))
    (is (equal '(2 3) (ends-of-lines (format nil "#| ~A~%|# turn 1~%turn 2~%" long))))
    (is (equal '(2 3) (ends-of-lines (format nil "#| ~A~%|# (list 1)~%turn 2~%" long))))
    (is (equal '(2) (ends-of-lines (format nil "#| ~A |#~%turn 2~%" long))))
    (is (equal '(3) (ends-of-lines (format nil "#|~%~A|# #| more |# ; more~%turn 2~%" long))))
    (is (equal '(-1 2) (ends-of-lines (format nil "#| ~A |#  turn 1~%turn 2~%" long))))
    (is (equal '(-1 4) (ends-of-lines (format nil "#|~%~A|# (turn~%1)~%turn 2~%" long))))
    (is (equal '(-1 3) (ends-of-lines (format nil "(list 1) #|~%~A|# turn 1~%turn 2~%" long))))
    (is (equal '(1 3) (ends-of-lines (format nil "(list 1) #|~%~A|#~%turn 2~%" long))))
    (is (equal '(-1) (ends-of-lines (format nil "#| ~A~%turn 2~%" long))))))

(test comments.may-touch-what-is-before-them
  (is (= 0 (nth-value 1 (type-batch "status; c" "turn 90 deg; c" "turn 1; c" "turn pi/2;c"))))
  (is (equal '(1 2) (ends-of-lines (format nil "go 1 m; c~%status;c~%")))))

(test arguments.that-no-attribute-has-are-told-with-what-it-can-have
  "As in Lisp."
  (is-true (has-words-p (complaint "obj-desig 1 non-local ((:color raed))")
                        "not (:color raed), because the values are" "did you mean red? OBJ-DESIG")))

(test json.has-no-line-for-what-a-plan-of-an-option-does
  (let ((message (first (objects-of-script "" "--plan" "stroll 1"))))
    (is-true (has-words-p message "Robot turned" "\"line\":null"))))

(test json.of-a-command-that-a-later-line-interrupts-is-well
  "As the exit status says."
  (let ((text (format nil "~{~A~%~}" (objects-of-script (format nil "pause~%turn 1~%turn 2~%resume")
                                                        "--rate" "free"))))
    (is (search "\"text\":\"turn 1\",\"ok\":true" text) "~A" text)
    (is (search "\"status\":0,\"errors\":0" text) "~A" text)))

(test json.of-a-command-of-lisp-that-fails-is-not-well
  "Also if it has waited for time to pass."
  (is (equal '(1 -2 3)
             (ends-of-lines (format nil "pause~%(hand-ungrasp (robot-hand dot 0) nil)~%resume")
                            "--rate" "free"))))

(test programs.that-read-where-the-input-has-ended-are-told-so
  "Nothing was typed, so no parenthesis is missing."
  (dolist (form '("(read)" "(read-line)"))
    (is-true (has-words-p (first (run-script form)) "line 1: The input has ended") "~A" form))
  (is-true (has-words-p (first (run-script "(read-from-string \"(a\")")) "parenthesis")))

(test values.that-cannot-be-printed-are-told-as-such
  (let ((name (symbol-name 'make-speechless)))
    (loop for (form . words) in '(("(ars-magna.tests::~A)" "of type speechless")
                                  ("(list 1 (ars-magna.tests::~A))" "of type cons"))
          do (is-true (apply #'has-words-p (complaint (format nil form name))
                             "cannot be printed: This cannot be printed" "PRINT-OBJECT" words)))))

(test scripts.give-up-once-what-repeat-waits-for-too-long
  "The next line does not wait for it again."
  (let ((cli::*wait-limit* 3))
    (is (= 1 (count-if (lambda (line) (search "not completed within 3 ticks" line))
                       (run-script (format nil "repeat 2 go-forward 50~%(list 1)")))))))

(test scripts.that-only-define-a-robot-are-told-apart
  (flet ((only-defines-p (text)
           (uiop:with-temporary-file (:pathname file :stream out :type "lisp")
             (write-string text out)
             :close-stream
             (cli::file-only-defines-p file))))
    (is-true (only-defines-p "(in-package :ars-user)
(defmap pen (8 8)) (defrobot bo (pen (2 2) 0))"))
    (dolist (text '("(defmap pen (8 8))" "(defrobot bo (pen (2 2) 0)) turn 1" "(defrobot bo" ""
                    "(defrobot bo (pen (2 2) 0)) (print 1)"))
      (is-false (only-defines-p text)))))
