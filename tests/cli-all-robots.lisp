;;;; cli-all-robots.lisp -- lines for all robots of a run, and robots told apart by full names.

(in-package :ars-magna.tests)

(in-suite cli-robots)

;;; Two robots of one name, and a third.

(defun call-with-twins (function)
  "Call FUNCTION with two robots TWIN of different packages, and LONER, in a map of their own. They
are symbols. Only the first twin has a hand."
  (let ((packages (list (make-package "TWINS-A" :use '()) (make-package "TWINS-B" :use '()))))
    (with-own-definitions
      (unwind-protect
           (destructuring-bind (one two)
               (mapcar (lambda (package) (intern "TWIN" package)) packages)
             (eval '(world:defmap twin-shed (20 10)))
             (eval `(robot:defrobot ,one (twin-shed (3.5 3.5) 0)
                      :cameras ((3 10)) :hands (10) :attributes ((:color red) (:size 4))))
             (eval `(robot:defrobot ,two (twin-shed (3.5 6.5) 0)
                      :cameras ((3 10)) :attributes ((:color blue) (:obsview t))))
             (eval '(robot:defrobot loner (twin-shed (9.5 3.5) 0) :cameras ((3 10))))
             (funcall function one two 'loner))
        (mapc #'forget-name '("TWIN" "LONER"))
        (mapc #'delete-package packages)))))

(defmacro with-twins ((one two loner) &body body)
  `(call-with-twins (lambda (,one ,two ,loner) (declare (ignorable ,one ,two ,loner)) ,@body)))

(defun sorted (lines) (sort (copy-list lines) #'string<))

(defun type-to-twins (&rest lines)
  "Type LINES where the prompt commands the first of two robots TWIN, without noise."
  (with-twins (one two loner) (apply #'type-to one lines)))

(defmacro in-twin-shed ((one two loner) &body body)
  "Run BODY in a run without noise of three robots, which are the values of the variables."
  (let ((names (gensym)))
    `(with-twins (,one ,two ,loner)
       (let ((,names (list ,one ,two ,loner)))
         (run:call-with-simulation
          (lambda ()
            (destructuring-bind (,one ,two ,loner) (mapcar #'symbol-value ,names)
              (declare (ignorable ,one ,two ,loner))
              ,@body))
          ,names :clean t :journal t)))))

;;; Lines for all.

(test all.gives-a-line-to-each-robot-and-waits-for-all
  "Of the robots, one is commanded, so that messages about it have no name."
  (with-names ("MARVIN" "GOFER")
    (let ((lines (type-to 'ars-worlds:marvin "all: turn 1" "all:go-forward 5" "(simulation-tick)")))
      (is (equal '("gofer: robot-turn: Robot turned 1.00" "robot-turn: Robot turned 1.00")
                 (sorted (subseq lines 0 2))))
      (is (equal '("gofer: robot-go-forward: Robot stopped" "robot-go-forward: Robot stopped")
                 (sorted (subseq lines 2 4))))
      (is (< 5 (parse-integer (fifth lines)))))))

(test all.repeats-and-may-be-repeated-and-pasted
  (with-names ("MARVIN" "GOFER")
    (flet ((turns (&rest lines)
             (count-if (lambda (line) (search "Robot turned" line))
                       (apply #'type-to 'ars-worlds:marvin lines))))
      (is (= 4 (turns "repeat 2 all: turn 0.1")))
      (is (= 6 (turns "all: repeat 3 turn 0.1")))
      (is (= 2 (turns "Robot> all: turn 0.1")))
      (is (= 2 (turns "alias spin all: turn 0.1" "spin"))))))

(test all.is-stopped-by-no-error-of-one-robot
  "Errors are told with the robots that have them; of all robots, once and without."
  (is (equal '("*ERROR* -> loner, twins-a::twin: There is no hand."
               "*ERROR* -> twins-b::twin: There is a hand.")
             (let ((errors '(("LONER" "There is no hand.") ("TWINS-A::TWIN" "There is no hand.")
                             ("TWINS-B::TWIN" "There is a hand.")))
                   (output (make-string-output-stream)))
               (cli::report-errors-of-robots (cli:make-session :batch t :output output) errors 3)
               (lines-of (get-output-stream-string output)))))
  (let ((lines (type-to-twins "all: hand-ungrasp 0" "all: go" "all: frob")))
    (is-true (find "*ERROR* -> loner: LONER has no hand." lines :test #'string=))
    (is-true (find "*ERROR* -> twins-b::twin: TWINS-B::TWIN has no hand." lines :test #'string=))
    (is-true (has-words-p (joined lines) "Hand 0"))
    (is (= 1 (count-if (lambda (line) (search "metres is missing" line)) lines)))
    (is (= 1 (count-if (lambda (line) (search "no command FROB" line)) lines)))))

(test all.refuses-lines-that-are-not-about-a-robot
  (let ((lines (type-to-twins "all: step 3" "all: robot loner" "all: all: turn 1" "all:"
                              "(simulation-tick)")))
    (is (= 5 (length lines)))
    (loop for line in lines
          for word in '("STEP is not about one robot" "ROBOT is not about" "ALL: is not about"
                        "cmd is missing" "0")
          do (is (search word line) "~A" line))))

(test all.prints-below-names-in-the-order-of-full-names
  (is (equal '("LONER" "9.5" "TWINS-A::TWIN" "3.5" "TWINS-B::TWIN" "3.5")
             (type-to-twins "all: (out (robot-x (ars-magna.cli:session-robot)) t)"
                            "all: (values)")))
  (let ((lines (type-to-twins "status all")))
    (is (equal '("LONER" "Position:          (9.50,3.50)" "TWINS-A::TWIN"
                 "Position:          (3.50,3.50)" "TWINS-B::TWIN" "Position:          (3.50,6.50)")
               (remove-if-not (lambda (line)
                                (or (eql 0 (search "Position:" line)) (search "TWIN" line)
                                    (search "LONER" line)))
                              lines)))
    (is (equal lines (type-to-twins "all: status")))
    (is (equal (type-to-twins "robot loner" "status") (type-to-twins "status loner")))))

(test all.works-in-forks-and-trials
  (let ((lines (type-to-twins "fork" "all: turn 1" "fork off" "all: angle 2" "robot loner"
                              "(robot-angle (ars-magna.cli:session-robot))")))
    (is (= 3 (count-if (lambda (line) (search "Robot turned 1.00" line)) lines)))
    (is (string= "2.0" (first (last lines)))))
  (with-twins (one two loner)
    (eval `(experiment:defexperiment twins-wait (:robots ,one ,two ,loner) (:trials 1)
             (:clean t) (:run (run:run-ticks 40))))
    (is (equal '("loner: robot-turn: Robot turned 1.00" "robot-turn: Robot turned 1.00"
                 "twins-b::twin: robot-turn: Robot turned 1.00")
               (sorted (remove-if-not (lambda (line) (search "Robot turned" line))
                                      (type-to one "trial twins-wait 1 1" "all: turn 1" "step 20"
                                               "trial off")))))))

;;; Names.

(test robots.of-one-name-are-chosen-by-their-full-names
  (let ((lines (type-to-twins "robot twin" "robot twins-b::twin" "robot" "turn 1"
                              "(robot-turn twins-a::twin 1 nil)" "(robot-turn loner 1 nil)")))
    (is (string= "*ERROR* -> TWIN could be TWINS-A::TWIN or TWINS-B::TWIN. Type the full name."
                 (first lines)))
    (is-true (has-words-p (joined lines) "TWINS-A::TWIN" "TWINS-B::TWIN    @ (3.50,6.50) commanded"
                          "LONER            @ (9.50,3.50)"))
    (is (equal '("robot-turn: Robot turned 1.00" "twins-a::twin: robot-turn: Robot turned 1.00"
                 "loner: robot-turn: Robot turned 1.00")
               (last lines 3)))))

(test robots.of-one-name-are-completed
  (in-twin-shed (one two loner)
    (let ((*completing* (cli:make-session :input (make-string-input-stream "")
                                          :output (make-broadcast-stream))))
      (is (equal '("robot twins-a::twin" "robot twins-b::twin") (completions "robot t")))
      (is (equal '("status all" "status loner" "status twins-a::twin" "status twins-b::twin")
                 (completions "status ")))
      (is (equal '("all: status") (completions "all: stat")))
      (is (equal '("all:status") (completions "all:stat")))
      (is (member "all:" (completions "al") :test #'string=)))))

(test robots.of-one-name-have-no-short-variable
  "Otherwise it would be that of an arbitrary one."
  (let ((text (joined (type-to-twins "(robot-turn twin 1 nil)"))))
    (is-true (has-words-p text "*ERROR*" "TWIN") "~A" text)))

(test json.names-robots
  "Messages have robots only where there are several."
  (let ((objects (objects-of-script (format nil "all: turn 1~%status all") "--world" "office"
                                    "--robot" "marvin")))
    (loop for name in '("marvin" "gofer")
          do (is-true (find-if (lambda (object)
                                 (has-words-p object "Robot turned" "\"line\":1"
                                              (format nil "\"robot\":\"~A\"}" name)))
                               objects)
                      "~A ~A" name objects))
    (let ((statuses (find-if (lambda (object) (search "\"statuses\"" object)) objects)))
      (is-true (has-words-p statuses "\"robots\":[{\"robot\":\"gofer\",\"map\":\"office\""
                            ",{\"robot\":\"marvin\",\"map\":\"office\""))))
  (is-false (find-if (lambda (object) (and (search "Robot turned" object)
                                           (search "\"robot\"" object)))
                     (objects-of-script "turn 1"))))

;;; The commanded robot, and the others.

(test robots.that-leave-the-run-are-replaced-with-a-warning
  "The first line for the robot that has left is carried out by no other robot."
  (flet ((lines-after-departure (&rest lines)
           (apply #'type-to-twins "robot loner" "turn 1"
                  "(progn (setf ars-magna.cli:*prompt-robot* :gone) (values))" "" lines)))
    (let ((lines (lines-after-departure "turn 1" "turn 1")))
      (is-true (has-words-p (joined lines) "GONE is no longer in this run: the lines command "
                            "GONE is no longer in this run, and this line is for no other robot")
               "~A" lines)
      (is (= 2 (count-if (lambda (line) (search "Robot turned" line)) lines)) "~A" lines)
      (is (string= "robot-turn: Robot turned 1.00" (first (last lines)))))
    (let ((lines (lines-after-departure "robot twins-b::twin" "turn 1" "robot")))
      (is-false (find "*ERROR*" lines :test #'search) "~A" lines)
      (is-true (find "TWINS-B::TWIN    @ (3.50,6.50) commanded" lines :test #'string=)))
    (let ((lines (lines-after-departure "all: turn 2")))
      (is-false (find "*ERROR*" lines :test #'search) "~A" lines)
      (is (= 3 (count-if (lambda (line) (search "Robot turned 2.00" line)) lines))))))

(test status.in-lisp-is-of-the-commanded-robot
  (is (equal '("LONER" "LONER" "LONER" "TWINS-A::TWIN" "TWIN" "TWINS-B::TWIN" "TWIN")
             (type-to-twins "robot loner" "(out (string (getf (status) :robot)) t)"
                            "all: (out (string (getf (status) :robot)) t)"))))

(test go-to.names-the-robot-in-its-messages
  (with-names ("MARVIN" "GOFER")
    (let ((lines (type-to 'ars-worlds:marvin "all: go-to 18 10")))
      (is (= 1 (count-if (lambda (line) (eql 0 (search "gofer: go-to: Robot is near" line)))
                         lines)))
      (is (= 1 (count-if (lambda (line) (eql 0 (search "go-to: Robot is near" line))) lines))))))

(test repeated-errors.are-counted-for-each-robot
  (let ((counts (make-hash-table :test 'equal)))
    (flet ((hidden-p (robot)
             (let ((definitions:*reported-robot* robot))
               (cli::count-repeated-message (definitions:make-message :error '("Blocked"))
                                            counts))))
      (is (equal '(nil nil nil t) (loop repeat 4 collect (and (hidden-p 'twin) t))))
      (is-false (hidden-p 'loner)))))

(test things.in-hands-are-told-with-the-robot
  (in-twin-shed (one two loner)
    (let ((thing (world:make-new-thing 'gift (robot:robot-hand one 0)
                                       '((:color world:red) (:size 1)))))
      (is (string= "in hand 0 of TWINS-A::TWIN" (cli::thing-place-text thing))))))

;;; Who is in the way.

(test blocked.names-the-robot-in-the-way
  (let ((lines (type-to-twins "go 20" "why")))
    (is (string= "*ERROR* -> Robot is blocked: LONER is in the way" (first lines)))
    (is-true (has-words-p (joined lines) "with :ROBOT-BLOCKED" "LONER is in the way")))
  (in-twin-shed (one two loner)
    (is (null (robot:robot-in-way one)))
    (robot:place-robot one 0.5 0.5 3.14)
    (command:robot-go-forward one 5)
    (run:run-ticks 5)
    (is (string= "Robot is blocked" (getf (command:last-failure one) :text)) "by a wall")))

;;; Displays.

(test bodies.are-drawn-as-robots-only
  (in-twin-shed (one two loner)
    (let ((snapshot (display:take-snapshot (robot:robot-world one))))
      (is (= 0 (length (display:snapshot-things snapshot))))
      (is (equal '("TWINS-A::TWIN" "TWINS-B::TWIN" "LONER")
                 (mapcar #'display:robot-image-label (display:snapshot-robots snapshot))))
      (let ((picture (display:svg-picture one)) (map (display:text-map one)))
        (dolist (name '("twins-a::twin" "twins-b::twin" "loner"))
          (is (search name picture))
          (is (search (string-upcase name) map))))
      (is (equal '("TWINS-A::TWIN at 3.50, 3.50 heading 0 deg (0.00 rad)" "  :color red" "  :size 4"
                   "  :obsmove t")
                 (lines-of (with-output-to-string (out)
                             (display:describe-subject (display:snapshot-robot snapshot
                                                                               "twins-a::twin")
                                                       out))))))))

(test designators.of-robots-are-drawn-to-robots
  (in-twin-shed (one two loner)
    (robot:add-designator one :denotation (robot:robot-body loner))
    (let* ((image (display:snapshot-robot (display:take-snapshot (robot:robot-world one))
                                          (robot:robot-name one)))
           (designator (first (display:robot-image-designators image))))
      (is (string= "LONER" (display::denoted-object-text designator)))
      (is (= 9.5 (display::designator-image-x designator)))
      (is (search ">LONER<" (display:svg-picture one :display :designators))))))

(test bodies.end-the-views-of-others-in-pictures
  "If they obstruct vision; never the view of their own robot."
  (in-twin-shed (one two loner)
    (let* ((snapshot (display:take-snapshot (robot:robot-world one)))
           (index (world:map-index (world:find-map 'twin-shed) 3.5 6.5)))
      (flet ((blocked-p (robot)
               (and (funcall (display::opaque-cell-test
                              snapshot (display:snapshot-robot snapshot (robot:robot-name robot)))
                             index)
                    t)))
        (is (equal '(t nil t) (mapcar #'blocked-p (list one two loner))))))))

(test tables-and-moments.have-full-names-of-robots
  (in-twin-shed (one two loner)
    (command:robot-go-forward one 20)
    (run:run-ticks 20)
    (let ((rows (saved-trajectory :every 20 :robots (list "twins-b::twin" 'loner))))
      (is (equal '("twins-b::twin" "loner" "twins-b::twin" "loner") (mapcar #'second (rest rows)))))
    (is (= 4 (length (rest (saved-trajectory :every 20 :robots "twin")))) "both")
    (is (equal '("twins-a::twin" "twins-b::twin" "loner")
               (mapcar #'second (rest (saved-trajectory :until 0)))))
    (let ((names (mapcar #'robot:robot-name (list one two loner)))
          (moment (display:make-moment 3 :note "stood" 1 1 (robot:robot-name two))))
      (is (string= "twins-b::twin: stood" (display:moment-description moment names)))
      (is (string= "stood" (display:moment-description moment (last names)))))))

(test run-pictures.have-full-names-of-robots
  (in-twin-shed (one two loner)
    (command:robot-go-forward one 20)
    (run:run-ticks 20)
    (uiop:with-temporary-file (:pathname path :type "svg")
      (trails:save-run-picture path)
      (let ((picture (joined (file-lines path))))
        (dolist (name '("twins-a::twin" "twins-b::twin" "twins-a::twin: robot-go-forward: "))
          (is (search name picture) "~A" name)))
      (signals base:wrong-argument
        (trails:save-run-picture path :moments '((3 "stood" twin)))))
    (uiop:with-temporary-file (:pathname path :type "html")
      (display:save-animation nil path)
      (is (search "twins-a::twin: robot-go-forward: " (joined (file-lines path)))))))
