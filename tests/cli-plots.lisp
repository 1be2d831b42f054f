;;;; cli-plots.lisp -- quantities over time at the prompt.

(in-package :ars-magna.tests)

(def-suite* cli-plots :in ars-magna)

(defun ars-user::tick-of (robot) (run:simulation-tick (run:robot-simulation robot)))

(defun ars-user::early (robot)
  (if (> (ars-user::tick-of robot) 3) (error "It is late.") 7))

(defun ars-user::drive ()
  (ars-magna.rpl-robot:begin-plan
   (rpl:interp-lambda ()
     (rpl:seq (ars-magna.rpl-robot:rpl-robot-go-forward 9) (rpl:wait-time 99))))
  (values))

(defun plots-listed (&rest lines)
  "Return what PLOT lists after LINES, one string for each plot, with single blanks. Only the line
STEP passes ticks."
  (let ((mark "Plots show all ticks."))
    (mapcar #'base:one-line
            (rest (member mark (type-lines (append lines '("plot-ticks" "plot"))
                                           :batch t :patient nil)
                          :test #'equal)))))

(test plot.samples-each-tick
  (is (equal '("1 speed 0.8 m/tick at tick 8" "2 distance 2.4 m at tick 8"
               "3 odometer-error 0 m at tick 8")
             (plots-listed "plot speed" "plot distance" "plot odometer-error" "(drive)"
                           "step 8"))))

(test plot.takes-functions-and-fluents
  (is (equal '("1 tick-of 20 at tick 20" "2 (lambda (r) (> (robot-x r) 3)) 1 at tick 20"
               "3 robot-place* 0 at tick 20" "4 hand-moved* 1 0 at tick 20"
               "5 robot-stopped* 1 at tick 20")
             (plots-listed "plot tick-of" "plot (lambda (r) (> (robot-x r) 3))"
                           "plot robot-place*" "plot hand-moved* 1" "plot robot-stopped*"
                           "(drive)" "step 20"))))

(run:define-run-variable ars-user::*plotted-score* 4
  "The points that the robot has, with a remark that is much too long for the title of a chart,
since it goes on and on until nobody reads it any more.")
(run:defmeasure ars-user::plotted-doubled "Twice the score." (* 2 ars-user::*plotted-score*))

(test plot.takes-run-variables-and-measures
  (is (equal '("1 *plotted-score* 7 at tick 5" "2 plotted-doubled 14 at tick 5")
             (plots-listed "plot *plotted-score*" "plot plotted-doubled" "step 3"
                           "(setf *plotted-score* 7)" "step 2")))
  (is-true (has-words-p (complaint "plot *ploted-score*") "did you mean *plotted-score*?"
                        "a run variable"))
  (with-scratch-file (path "svg")
    (type-batch "plot *plotted-score*" "plot plotted-doubled" "step 1"
                (format nil "plot-picture ~A" (uiop:native-namestring path)))
    (let ((svg (uiop:read-file-string path)))
      (is (mentions-p svg ">Twice the score.<"))
      (is (mentions-p svg ">The points that the robot has, with"))
      (is (mentions-p svg "...<"))
      (is (not (mentions-p svg "nobody reads"))))))

(test plot.does-not-count-as-reading-a-fluent
  (in-studio (robot)
    (let ((fluent (rpl:create-fluent "seen" 41)))
      (is (= 41 (ars-magna.rpl.fluents:peek-fluent fluent)))
      (is (= 42 (ars-magna.rpl.fluents:peek-fluent (ars-magna.rpl.lifted:+ fluent 1))))
      (let ((unread (rpl:create-fluent "unread" 1)))
        (ars-magna.rpl.fluents:peek-fluent unread)
        (is (not (ars-magna.rpl.fluents:was-read-p unread)))))))

(test plot.an-error-ends-one-curve
  "It is reported once, and time goes on."
  (multiple-value-bind (lines errors) (type-batch "plot early" "plot speed" "step 9" "plot")
    (let ((text (joined lines)))
      (is (= 1 errors))
      (is (= 1 (occurrences "Error in the plot of early: It is late." text)))
      (is-true (has-words-p text "The curve of early ends here. PLOT early off removes it"
                            "Tick 9." "ended at tick 3 by an error"
                            "0 m/tick at tick 9")))))

(test plot.refuses-what-is-no-number
  (is-true (has-words-p (joined (type-batch "plot (lambda (r) 1e30)"))
                        "Only numbers up to 1e15")))

(test plot.can-be-removed
  (is (equal '("1 distance 0 m at tick 1")
             (plots-listed "plot speed" "plot distance" "plot tick-of" "plot 3 off"
                           "plot SPEED off" "step 1")))
  (is-true (has-words-p (joined (type-batch "plot speed" "plot off" "plot"))
                        "Nothing is plotted")))

(test plot.is-cut-by-a-rewind
  (flet ((listed (&rest lines)
           (apply #'plots-listed "(keep-forks)" "step 3" "plot tick-of" "plot distance" "(drive)"
                  "step 11" lines)))
    (is (equal '("1 tick-of 9 at tick 9" "2 distance 0.8 m at tick 9") (listed "rewind 5")))
    (is (equal (listed) (listed "rewind 5" "step 5")))))

(test plot.begins-anew-in-a-fork-and-continues-after-it
  (is (equal '("1 distance 2.4 m at tick 10")
             (plots-listed "(keep-forks)" "plot distance" "(drive)" "step 7" "fork" "step 3")))
  (is (equal '("1 distance 2.4 m at tick 8")
             (plots-listed "(keep-forks)" "plot distance" "(drive)" "step 7" "fork" "step 3"
                           "fork off" "step 1"))))

(test plot.does-not-change-the-run
  (flet ((digest (&rest lines)
           (car (last (apply #'type-batch (append lines '("go 3" "turn 1" "step 9"
                                                          "(state-digest)")))))))
    (is (equal (digest "step 2")
               (digest "plot speed" "plot odometer-error" "plot robot-stopped*" "plot tick-of"
                       "step 2")))))

(test plot.saves-a-picture
  (with-scratch-file (path "svg")
    (let ((name (uiop:native-namestring path)))
      (type-batch "plot tick-of" "step 40" (format nil "plot-picture ~A" name))
      (is (mentions-p (uiop:read-file-string path) ">40</text>"))
      (is (mentions-p (uiop:read-file-string path) ">butler in parlour, tick 40<"))
      (type-batch "plot tick-of" "step 40" "plot-ticks 9" (format nil "plot-picture ~A" name))
      (is (mentions-p (uiop:read-file-string path) ">32</text>"))
      (is (not (mentions-p (uiop:read-file-string path) ">20</text>")))))
  (is-true (has-words-p (complaint "plot-picture plots.svg") "Nothing is plotted"))
  (is-true (has-words-p (complaint "plot-ticks none") "a number of ticks" "ALL")))

(test plot.answers-wrong-words
  (is-true (has-words-p (complaint "plot spede") "did you mean speed?" "or a function"))
  (is-true (has-words-p (complaint "plot no-such-thing") "cannot be plotted." "odometer-error"))
  (is-true (has-words-p (complaint "plot hand-moved*") "for each hand" "0 to 1"))
  (is-true (has-words-p (complaint "plot hand-moved* 2") "for each hand" "0 to 1"))
  (is-true (has-words-p (complaint "plot robot-place* 1") "one fluent"))
  (is-true (has-words-p (complaint "plot 7") "7 cannot be plotted"))
  (is-true (has-words-p (complaint "plot speed up") "too much"))
  (is-true (has-words-p (complaint "plot setf") "cannot be plotted"))
  (is-true (has-words-p (complaint "plot speed off") "speed is not plotted; nothing is")))

(defun ars-user::breaking (robot)
  (break "plotted")
  (ars-user::tick-of robot))

(defun type-while-the-clock-runs (&rest lines)
  "Type LINES at a terminal. The simulator's thread owns the run, and no ticks pass."
  (apply #'type-at-terminal
         "(ars-magna.run:start-clock (current-simulation) :paused-p t)" lines))

(test plot.a-break-of-a-function-is-answered-at-the-prompt
  "Also if the simulator's thread takes the first sample, for which the line waits."
  (let ((text (joined (type-while-the-clock-runs "plot breaking" "abort" "plot" "(+ 20 3)"))))
    (is (not (mentions-p text "Plotting breaking")))
    (is-true (has-words-p text "*BREAK* -> plotted"
                          "Report it and leave the plot of breaking."
                          "Try the plot of breaking again."
                          "the plot of breaking was aborted" "The curve of breaking ends here."
                          "ended by an error" "23")))
  (let ((text (joined (type-while-the-clock-runs "plot breaking" "0" "plot off" "(+ 20 3)"))))
    (is-true (has-words-p text "Plotting breaking." "No more plots." "23"))))

(test ask.a-break-is-answered-where-it-is-asked
  (let ((written (type-while-the-clock-runs "(ask butler (lambda () (break \"asked\") 42))" "0"
                                            "(+ 20 3)")))
    (is-true (written-p "*BREAK* -> asked" written))
    (is-true (written-p "42" written))
    (is-true (written-p "23" written))))
