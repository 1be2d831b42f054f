;;;; completing.lisp -- Tab: completions of a line being typed.

(in-package :ars-magna.tests)

(def-suite* completing :in ars-magna)

(defvar *completing* nil "The session whose lines are completed.")

(defmacro in-parlour (&body body)
  "Run BODY in a clean parlour, *COMPLETING* being a session there."
  `(run:call-with-simulation
    (lambda ()
      (let ((*completing* (cli:make-session :input (make-string-input-stream "")
                                            :output (make-broadcast-stream))))
        (cli::call-with-syntax 'double-float (lambda () ,@body))))
    '(ars-user::butler) :clean t))

(defun completions (text)
  "Return TEXT as it would become by each of what Tab finds, a list."
  (multiple-value-bind (start texts) (cli::completions-in *completing* text (length text))
    (loop for word in texts collect (concatenate 'string (subseq text 0 start) word))))

(defmacro completes (&rest texts-and-completions)
  "Check that each of TEXTS-AND-COMPLETIONS, lists (text completion...), is completed so."
  `(in-parlour
     (loop for (text . expected) in ',texts-and-completions
           do (is (equal expected (completions text)) "~S becomes ~S" text (completions text)))))

(test completing.knows-commands
  (completes ("stat" "status") ("STAT" "status") ("cam-i" "cam-insert-bin" "cam-insert-desig")
             ("  qu" "  quit") ("robot-turn-l" "robot-turn-left") ("frob")
             ("help cam-v" "help cam-view")
             ("repeat 3 cam-v" "repeat 3 cam-view") ("repeat 3 cam-turn 1" "repeat 3 cam-turn 1")))

(test completing.knows-the-robots-of-this-world
  "Those of others are for WORLD, which leads there."
  (completes ("robot " "robot butler")))

(test completing.knows-aliases
  (in-parlour
    (let ((cli::*aliases* '(("LOOK" "cam-view"))))
      (is (equal '("look") (completions "loo")))
      (is (equal '("look 0" "look 1") (completions "look "))))))

(test completing.knows-arguments-by-their-types
  (completes ("cam-view " "cam-view 0" "cam-view 1")
             ("hand-grasp 1 " "hand-grasp 1 0" "hand-grasp 1 1")
             ("bin-o" "bin-open") ("turn ") ("turn 1 ")
             ("obj-desig 0 l" "obj-desig 0 local")
             ("obj-desig 0 local ((:co" "obj-desig 0 local ((:color")
             ("obj-desig 0 local ((:color re" "obj-desig 0 local ((:color red")
             ("obj-desig 0 local ((:color (red viol" "obj-desig 0 local ((:color (red violet")
             ("place-desig 0 doo" "place-desig 0 doorway")
             ("params camera-angle" "params camera-angle-max-error*") ("rate f" "rate free")
             ("plan turn-and-t" "plan turn-and-tell") ("world parl" "world parlour")
             ("robot but" "robot butler")
             ("alias x cam-v" "alias x cam-view") ("cam-view ((")))

(test completing.knows-units-after-numbers
  (completes ("go 250 c" "go 250 cell" "go 250 cells" "go 250 cm") ("go ") ("go 2 ") ("go 2.5 cm ")
             ("turn 90 deg" "turn 90 deg" "turn 90 deg/tick" "turn 90 degree" "turn 90 degrees")
             ("turn 90 m") ("turn 90 deg d") ("pos 3 m c") ("pos 3 me" "pos 3 meter" "pos 3 meters"
                                                            "pos 3 metre" "pos 3 metres")
             ("set-speed 0.5 cm" "set-speed 0.5 cm/tick")
             ("set-speed 0.5 m/t" "set-speed 0.5 m/tick")
             ("turn 1/4 t" "turn 1/4 turn" "turn 1/4 turns")))

(test completing.knows-what-has-help
  (completes ("help doorw" "help doorway") ("help camera-angle-m" "help camera-angle-max-error*")
             ("help turn-and-t" "help turn-and-tell")))

(test completing.knows-designators-by-number
  (in-parlour
    (is (null (completions "cam-track 0 ")))
    (let ((robot (cli:session-robot)))
      (command:camera-get-object-designator (robot:robot-camera robot 0) :local '((:size 5)))
      (run:run-ticks 20))
    (is (equal '("cam-track 0 0") (completions "cam-track 0 ")))))

(test completing.knows-symbols-in-lisp
  (completes ("(robot-turn-l" "(robot-turn-left")
             ("(list 'most-positive-f" "(list 'most-positive-fixnum")
             ("(cl:prin1-" "(cl:prin1-to-string") ("eval (robot-turn-r" "eval (robot-turn-right")
             ("(ars:robot-turn-l" "(ars:robot-turn-left") ("(most-positive-f")
             ("(f '((:substan" "(f '((:substance")
             ("(f '((:color lightg" "(f '((:color lightgreen") ("(") ("(no-such-thing")))

(test completing.takes-no-slips-for-names
  "What was merely read is a symbol, too."
  (in-parlour
    (read-from-string "(xyzzy-slip)")
    (is (null (completions "(xyzzy")))
    (is (null (completions "obj-desig 0 local ((:color xyzzy-oth")))
    (is (null (find-symbol "XYZZY-OTH" :ars-user)))))

(test completing.runs-nothing
  (in-parlour
    (let ((ran nil))
      (declare (special ran))
      (dolist (text '("obj-desig #.(setf ran t) lo" "turn #.(setf ran t)" "(f #.(setf ran t) cd"))
        (completions text))
      (is (null ran)))))

(test completing.knows-files
  (uiop:with-temporary-file (:pathname file :prefix "ars-completing" :type "lisp")
    (let* ((name (base:native-name file))
           (start (subseq name 0 (- (length name) 4))))
      (in-parlour
        (loop for line in '("replay ~A" "world ~A" "save-journal ~A" "(load \"~A")
              do (is (equal (list (format nil line name)) (completions (format nil line start)))))
        (is (null (completions (format nil "replay ~Axyz/" start))))))))

(test completing.quotes-files-with-blanks
  (uiop:with-temporary-file (:pathname file :prefix "ars completing" :type "lisp")
    (let* ((name (base:native-name file))
           (whole (format nil "world \"~A" name)))
      (in-parlour
        (is (member whole (completions (format nil "world ~A"
                                               (subseq name 0 (position #\Space name))))
                    :test #'string=))
        (is (equal (list whole) (completions (subseq whole 0 (- (length whole) 4)))))
        (is (null (completions (format nil "world \"~A\"" name))))))))

(test completing.knows-the-home-directory
  (in-parlour
    ;; A name with a blank is in quotes.
    (is (every (lambda (text) (eql 0 (search "picture ~/" (remove #\" text))))
               (completions "picture ~/")))
    (is (equal (length (cli::argument-choices :file *completing* "~/"))
               (length (cli::argument-choices :file *completing*
                                              (base:native-name (user-homedir-pathname))))))
    (is (equal (base:native-name (merge-pathnames "x.svg" (user-homedir-pathname)))
               (cli::token-value :file "~/x.svg")))))

;;; Tab.

(defun typed-with-tab (console &rest keys)
  "Return the first line that KEYS type at CONSOLE."
  (let ((cli::*completer* (lambda (text point)
                            (cli::completions-in *completing* text point))))
    (read-line (typed-text-for (keyboard-for keys) console))))

(test tab.completes-what-is-the-only-one
  (in-parlour
    (loop for (expected . keys) in '(("status " "stat" :tab) ("turn-left  1" "turn-l" :tab " 1")
                                     ("place-desig 0 doorway " "place-desig 0 door" :tab)
                                     ("(robot-turn-left" "(robot-turn-l" :tab)
                                     ("(list status" "status" #\A "(list " :tab))
          do (is (equal expected (apply #'typed-with-tab (terminal-console)
                                        (append keys '(:enter))))))))

(test tab.goes-as-far-as-all-agree-and-then-lists
  (in-parlour
    (is (equal "cam-insert-" (typed-with-tab (terminal-console) "cam-i" :tab :enter)))
    (multiple-value-bind (console out) (terminal-console 30 24)
      (is (equal "cam-insert-" (typed-with-tab console "cam-i" :tab :tab :enter)))
      (is (search (format nil "cam-insert-bin~%cam-insert-desig~%")
                  (get-output-stream-string out))))
    (multiple-value-bind (console out) (terminal-console 40 6)
      (typed-with-tab console "c" :tab :tab :enter)
      (is (search "There are more completions." (get-output-stream-string out))))))

(test completing.knows-the-words-of-lines
  (completes ("echo o" "echo off" "echo on") ("fork " "fork off")
             ("trial choosing-by-" "trial choosing-by-rollouts")))

(test completing.knows-the-words-of-maps
  (completes ("map " "map belief" "map cones" "map designators" "map legend" "map plan"
                     "map planned-way" "map ranges" "map trail" "map way" "map wedges")
             ("map 5 co" "map 5 cones") ("watch 5 way b" "watch 5 way belief")))
