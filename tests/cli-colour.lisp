;;;; cli-colour.lisp -- colours at the prompt, ECHO, and WATCH.

(in-package :ars-magna.tests)

(def-suite* cli-colour :in ars-magna)

(defun escaped-p (text) (and (find (code-char 27) text) t))

(defun has-code-p (code text)
  "True if TEXT has something in the colour of CODE."
  (search (format nil "~C[~Am" (code-char 27) code) text))

;;; Escape codes.

(test paint.ends-in-each-line
  (is (string= (format nil "~C[31ma~:*~C[0m~%~:*~C[31mb~:*~C[0m~%" (code-char 27))
               (cli::paint (format nil "a~%b~%") :red)))
  (is (string= "a" (cli::paint "a" nil)))
  (is (string= "a" (cli::paint "a" "no-such-colour")))
  (is (string= "" (cli::paint "" :red))))

(test paint.can-be-taken-off
  (let ((text (format nil "one~%~%two m"))
        (painted (cli::paint "in colour" :lightblue)))
    (is (string= text (cli::unpainted-text text)))
    (is (string= text (cli::unpainted-text (cli::paint text :bold))))
    (is (string= "x in colour y" (cli::unpainted-text (format nil "x ~A y" painted))))))

(test colors.of-things-and-substances-are-known
  "Each colour that things have by default, and each that a text map uses, is an ink."
  (dolist (color '(world:red world:green world:blue world:violet world:lightred world:lightgreen
                   world:lightblue world:lightviolet :reverse :bold :grey))
    (is (cli::ink-code color) "~A" color))
  (dolist (ink ars-magna.display::+substance-inks+) (is (cli::ink-code ink) "~A" ink)))

(test colors.are-for-terminals-unless-asked-for
  (let ((stream (make-string-output-stream)))
    (is (null (cli::color-wanted-p :auto stream)))
    (is (null (cli::color-wanted-p :never stream)))
    (is-true (cli::color-wanted-p :always stream)))
  (is (equal '((:color :always)) (cli::parse-options '("--color" "always"))))
  (signals cli::usage-error (cli::parse-options '("--color" "blue"))))

;;; Sessions.

(test colors.tell-kinds-of-messages-apart
  (let* ((lines '("frobnicate" "turn .5" "(warning-set 1)" "plan stroll .5" "map 3"))
         (plain (type-lines lines))
         (colored (joined (type-lines lines :color :always))))
    (is (notany #'escaped-p plain))
    (is (equal plain (lines-of (cli::unpainted-text colored))))
    (is-true (has-code-p "31" colored) "an error")
    (is-true (has-code-p "33" colored) "a warning")
    (is-true (search (cli::paint "robot-turn: Robot turned 0.50" :cyan) colored))
    (is-true (search (cli::paint "robot-turn: Robot turned 0.50" :grey) colored) "a plan's")
    (is-true (search (cli::paint "Robot> " :bold) colored))))

(test colors.show-nothing-that-a-message-forges
  (let ((shown (joined (type-lines '("(error-set (code-char 27) \"[32mx\")") :color :always))))
    (is (search "^[[32mx" shown))
    (is (null (has-code-p "32" shown)))))

;;; ECHO.

(test echo.off-hides-plans-and-programs
  (let ((lines '("plan stroll .5" "turn 1")))
    (is (equal '("robot-turn: Robot turned 0.50" "stroll succeeded: 0.5"
                 "robot-turn: Robot turned 1.00")
               (apply #'type-batch lines)))
    (is (equal '("stroll succeeded: 0.5" "robot-turn: Robot turned 1.00")
               (rest (apply #'type-batch "echo off" lines))))
    (is (equal '("robot-turn: Robot turned 0.50" "stroll succeeded: 0.5")
               (cddr (type-batch "echo off" "echo on" "plan stroll .5"))))))

(test echo.off-hides-continuations
  (flet ((shown (setting)
           (joined (type-batch setting
                               "(robot-turn butler 1 (continuation (err robot angle)
                                                       (robot-turn robot 2 nil)))"
                               "step 30"))))
    (is-true (has-words-p (shown "echo on") "turned 1.00" "turned 2.00"))
    (is-true (search "turned 1.00" (shown "echo off")))
    (is (null (search "turned 2.00" (shown "echo off"))))))

(test echo.says-what-is-so
  (is-true (has-words-p (joined (type-batch "echo")) "are shown"))
  (is-true (has-words-p (joined (type-batch "echo off" "echo")) "are not shown"))
  (is-true (has-words-p (complaint "echo maybe") "maybe" "ON or OFF")))

(test echo.off-hides-no-failure
  (multiple-value-bind (lines errors) (type-batch "echo off" "plan stumble :ice")
    (is (= 1 errors))
    (is-true (has-words-p (joined lines) "stumble failed"))))

;;; MAP and WATCH.

(test map.takes-a-radius-a-region-and-words
  (is (equal '(:radius 3 :layers (:cones :way) :only-legend nil) (cli::map-options "3 con WAY")))
  (is (equal '(:region (1 2 30 4.5d0) :layers () :only-legend t)
             (let ((*read-default-float-format* 'double-float))
               (cli::map-options "legend 1 2 30 4.5"))))
  (is-true (has-words-p (complaint "map frob") "frob" "CONES" "LEGEND"))
  (is-true (has-words-p (complaint "map 1 2 3") "LEFT TOP RIGHT BOTTOM"))
  (is-true (has-words-p (complaint "map 9 9 1 1") "not a region"))
  (is-true (has-words-p (complaint "map -3") "radius" "-3"))
  (is-true (has-words-p (joined (type-batch "go-forward 5" "map way")) "+ way of BUTLER")))

(defun ticks-said (lines)
  (loop for line in lines
        when (eql 0 (search "Tick " line)) collect (parse-integer line :start 5 :junk-allowed t)))

(test watch.shows-a-map-for-each-tick
  (let ((lines (type-batch "angle 0" "go-forward 5" "step 2" "watch 3 2")))
    (is (equal '(1 2 3) (mapcar (lambda (tick) (- tick (first (ticks-said lines))))
                                (rest (ticks-said lines)))))
    (is (= 3 (count-if (lambda (line) (search "> BUTLER" line)) lines))))
  (flet ((state (line) (car (last (type-batch "seed 3" line "(state-digest)")))))
    (is (string= (state "step 4") (state "watch 4 cones way belief")) "it changes nothing")))

(test watch.wants-an-end
  (is-true (has-words-p (complaint "watch") "WATCH n"))
  (is-true (has-words-p (complaint "watch 0") "0" "whole number"))
  (is-true (has-words-p (complaint "watch 2.5") "2.5"))
  (is-true (has-words-p (complaint "watch 2 frob") "frob")))

(test screens.hold-back-what-others-write
  "What is written while a screen stands comes when it is gone; its last line can be shown there."
  (let* ((stream (make-string-output-stream))
         (console (cli::make-console stream)))
    (write-string "before" console)
    (cli::begin-screen console)
    (get-output-stream-string stream)
    (format console "one~%~A~%" (cli::paint "two" :red))
    (is (string= "two" (cli::last-held-back-line console)))
    (cli::write-immediately (cli::overwrite-screen-code (format nil "a~%b")) console)
    (let ((shown (get-output-stream-string stream)))
      (is (search "a" shown))
      (is (null (search "one" shown))))
    (cli::end-screen console)
    (is (search (format nil "one~%") (get-output-stream-string stream)))
    (write-string "after" console)
    (is (string= "after" (get-output-stream-string stream)))))

(test screens.forget-the-oldest-of-much
  (let ((console (cli::make-console (make-string-output-stream))))
    (is (string= "" (cli::last-held-back-line console)))
    (cli::begin-screen console)
    (loop for i below 10000 do (format console "~D~%" i))
    (is (string= "9999" (cli::last-held-back-line console)))
    (is (<= (length (cli::console-held-back console)) (* 2 cli::+most-held-back+)))))

;;; Numbers and files.

(test picture.says-its-range
  (is-true (has-words-p (complaint "picture world.svg 1000") "scale" "from 1 to 256"))
  (is-true (has-words-p (joined (type-batch "help picture")) "to 256")))

(test status.has-no-minus-before-nothing
  (is (null (search "-0.00" (joined (type-batch "angle -0.001" "pos 3 3" "status" "cameras"))))))
