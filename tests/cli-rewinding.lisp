;;;; cli-rewinding.lisp -- the prompt goes back to an earlier tick.

(in-package :ars-magna.tests)

(def-suite* cli-rewinding :in ars-magna)

(test rewind.at-a-prompt-that-keeps-forks
  (is-true (answers-p '("Tick 5." "Tick 2, headless." "Tick 0, headless.")
                      '("(keep-forks)" "step 5" "rewind 3" "rewind 2")))
  (is-true (has-words-p (complaint "rewind 3") "keep-forks"))
  (is-true (has-words-p (complaint "rewind") "REWIND n" "missing"))
  (is-true (has-words-p (joined (type-batch "(keep-forks)" "rewind 3")) "at most 0" "tick 0")))

(test rewind.commands-go-to-the-robot-of-now
  (let ((lines (type-batch "(keep-forks)" "turn .5" "(rewind (simulation-tick))" "rewind 0"
                           "(robot-angle butler)" "turn .3" "(robot-angle butler)")))
    (is-true (has-words-p (joined lines) "turned 0.50" "at tick 0" "Tick 0, headless."
                          "turned 0.30"))
    (is (equal '("0.0" "0.3") (list (nth 3 lines) (nth 5 lines))))))

(test rewind.waits-for-no-plan-that-nobody-waited-for
  (let ((lines (type-batch "(def-interp-proc drone () (loop (wait-time 1)))" "(keep-forks)"
                           "(begin-plan 'drone)" "step 5" "rewind 2" "(simulation-tick)")))
    (is-true (has-words-p (joined lines) "Plans under way: drone"))
    (is (equal "3" (car (last lines))))))

(test rewind.waits-for-the-commands-that-are-under-way-again
  "As after Lisp that rewinds."
  (is (equal '("NIL" "robot-turn: Robot turned 1.00" "Tick 3, headless."
               "robot-turn: Robot turned 1.00" "5")
             (type-to 'ars-worlds:dot "(values (keep-forks))" "turn 1" "rewind 2"
                      "(simulation-tick)"))))

(test rewind.says-what-plans-without-names-are
  (is-true (has-words-p (joined (type-batch "(keep-forks)"
                                            "(begin-plan (interp-lambda () (wait-time 99)))"
                                            "step 5" "rewind 2"))
                        "Plans under way: (wait-time 99)")))

(test rewind.live-plans-are-watched-again
  "Of the plan of the run that is over nothing is told."
  (let ((text (let ((run:*forks-to-keep* t))
                (joined (type-live '("pause" "plan dawdle 1000000" "step 20" "rewind 10" "plans"
                                     "quit"))))))
    (is-true (has-words-p text "Plan 1 is under way" "paused. Plans under way: dawdle."
                          "1 waiting: dawdle")
             "~A" text)
    (is (null (search "was stopped" text))))
  (awaiting (null cli::*plan-jobs*)))

(test rewind.by-lisp-lets-plans-be-watched-again
  (let ((text (let ((run:*forks-to-keep* t))
                (joined (type-live '("pause" "plan dawdle 1000000" "step 20" "(rewind 10)" "plans"
                                     "quit"))))))
    (is-true (has-words-p text "1 waiting: dawdle") "~A" text)
    (is (null (search "was stopped" text))))
  (awaiting (null cli::*plan-jobs*)))

;;; Forks.

(defun ends-and-errors (&rest lines)
  "Return of the objects that a script of LINES makes with --json those of ends and errors."
  (remove-if-not (lambda (object)
                   (or (search "\"done\"" object) (search "\"kind\":\"error\"" object)))
                 (objects-of-script (format nil "~{~A~%~}" lines))))

(test fork.tells-of-errors-in-continuations-with-the-lines-that-asked
  (let ((objects (ends-and-errors "fork"
                                  "(robot-turn dot 1 (lambda (&rest r) r (error \"boo\")))"
                                  "(+ 1 2)")))
    (loop for words in '(("line\":1" "ok\":true") ("boo" "line\":2}") ("line\":2" "ok\":false")
                         ("line\":3" "ok\":true"))
          for object in objects
          do (is-true (apply #'has-words-p object words) "~A: ~A" words objects))))
