;;;; at-the-repl.lisp -- what Lisp and editors show about users' definitions.

(in-package :ars-magna.tests)

(def-suite* at-the-repl :in ars-magna)

(defparameter *a-users-file* "(in-package :ars-user)
(in-readtable :nisp)

(defattribute :glow (dim bright) :success 9/10 :documentation \"How much it shines.\")
(defsubstance velvet 7 \"Soft cloth.\")
(def-place-type alcove (cell)
  :documentation \"Walls on three sides.\"
  :check-matchers ((((* * *)
                     (* - *)
                     (* - *)) (/ pi 2))))
(defkicker drift (thing) (:prob 1/10)
  \"Drifts away.\"
  (kick-thing thing 1/4 0 nil))
(defmap parlour (8 6)
  \"Where guests sit.\"
  (rect (0 0) (7 5) bricks 3)
  (obj (lamp :kickers (drift)) (5.5 2.5) ((:size 1) (:glow dim))))
(defrobot butler (parlour (2.5 2.5) 0) :cameras ((1 3)) :hands (4) :documentation \"Serves.\")
(defmanipulation polish (lamp - ((:glow dim)) :by hand - HAND) (:success .9)
  \"Makes it shine.\"
  (set-attribute lamp :glow 'bright)
  (values nil hand))
(def-interp-proc wander-about (metres)
  \"Drive METRES.\"
  (rpl-robot-go-forward metres))
(defexperiment wandering
  \"How far?\"
  (:robots butler)
  (:vary (metres 1 2))
  (:run (run-plan 'wander-about metres)))
" "Definitions of each kind, with documentation.")

(defparameter *users-names*
  '(("PARLOUR" world:map "Where guests sit.") ("BUTLER" robot:robot "Serves.")
    ("DRIFT" kicker "Drifts away.") ("ALCOVE" place-type "Walls on three sides.")
    ("VELVET" substance "Soft cloth.") ("GLOW" attribute "How much it shines.")
    ("POLISH" manipulation "Makes it shine.") ("WANDER-ABOUT" plan "Drive METRES.")
    ("WANDERING" experiment "How far?"))
  "What that defines: names, kinds and documentation.")

(defun call-with-users-file (function)
  "Call FUNCTION with the path of a file of what *A-USERS-FILE* says, which is loaded; undo that."
  (let ((*package* (find-package :ars-user)))
    (uiop:with-temporary-file (:pathname path :type "lisp")
      (with-open-file (out path :direction :output :if-exists :supersede)
        (write-string *a-users-file* out))
      (base:with-own-definitions ()
        (load path)
        (funcall function (truename path))))))

(defun users-name (name)
  "Return the symbol called NAME in the file; attributes are keywords."
  (find-symbol name (if (string= "GLOW" name) :keyword :ars-user)))

(test documentation.is-kept-by-kind-of-definition
  (call-with-users-file
   (lambda (path)
     (declare (ignore path))
     (loop for (name kind text) in *users-names*
           do (is (equal text (documentation (users-name name) kind)) "~A ~A" kind name))
     (is (null (documentation 'nothing-of-the-kind 'kicker))))))

(test describe.tells-what-definitions-call-a-symbol
  (call-with-users-file
   (lambda (path)
     (loop for (name kind text) in *users-names*
           for said = (with-output-to-string (out) (describe (users-name name) out))
           do (is-true (has-words-p said (format nil "~A names a" name) text
                                    (format nil "Defined in: ~A, line" (namestring path)))
                       "~A ~A: ~A" kind name said))
     (is-true (has-words-p (with-output-to-string (out) (describe (users-name "ALCOVE") out))
                           "ALCOVE names a place type:" "line 6"))
     (is-true (has-words-p (with-output-to-string (out) (describe (users-name "GLOW") out))
                           "names an attribute" "dim, bright" "0.9")))))

(test describe.tells-of-a-robot-what-one-wants-to-know
  (with-skater ()
    (command:robot-turn skater 2)
    (run:run-ticks 2)
    (let ((said (with-output-to-string (out) (describe skater out))))
      (is-true (has-words-p said "rink at (5.00,5.00)" "tick 2" "Carries out: robot-turn"))
      (is (< (reduce #'max (mapcar #'length (lines-of said))) 400) "and no array of numbers"))))

(test describe.tells-of-commands-as-the-manual-does
  (let ((said (with-output-to-string (out) (describe 'command:robot-turn out))))
    (is-true (has-words-p said "how far in radians" "Error codes" "Manual 3.5")))
  (is-true (has-words-p (with-output-to-string (out)
                          (describe (command:find-command 'command:robot-go-forward) out))
                        "GO-FORWARD" ":ROBOT-BLOCKED" "3.5"))
  (is-true (has-words-p (with-output-to-string (out) (describe 'turn-right out))
                        "TURN-RIGHT names a command" "Turn ROBOT" "At the prompt: TURN-RIGHT"))
  (is-true (has-words-p (with-output-to-string (out) (describe 'max-speed out))
                        "MAX-SPEED names a simulation parameter" "cells per tick")))

(test sources.of-definitions-are-told-to-editors
  (call-with-users-file
   (lambda (path)
     (let ((text (base:read-file-into-string path)))
       (loop for (name kind) in *users-names*
             for symbol = (users-name name)
             for sources = (loop for type in '(:variable :function :declaration)
                                 append (uiop:symbol-call :sb-introspect
                                                          '#:find-definition-sources-by-name
                                                          symbol type))
             do (is (member path (mapcar #'source-path sources) :test #'equal)
                    "~A ~A" kind name)
                (dolist (source sources)
                  (let ((offset (uiop:symbol-call :sb-introspect
                                                  '#:definition-source-character-offset source)))
                    (when offset
                      (is (search (string-downcase name) (subseq text offset (+ offset 60)))
                          "~A ~A at ~D" kind name offset)))))))))

(test sources.begin-where-the-forms-of-definitions-begin
  (call-with-users-file
   (lambda (path)
     (let ((text (base:read-file-into-string path)) (count 0))
       (loop for (name) in *users-names*
             do (loop for (nil position operator) in (definitions::definition-sources
                                                      (users-name name))
                      do (incf count)
                         (is (eql position (search (format nil "(~(~A~)" operator) text
                                                   :start2 position))
                             "~A at ~D" name position)))
       (is (< 3 count))))))

(defun source-path (source)
  (uiop:symbol-call :sb-introspect '#:definition-source-pathname source))

(test indentation.follows-from-how-definers-are-shown
  (dolist (name '("DEFMAP" "DEFROBOT" "DEFKICKER" "DEFMANIPULATION" "DEF-PLACE-TYPE"
                  "DEFATTRIBUTE" "DEFEXPERIMENT" "DEF-INTERP-PROC" "WITH-SIMULATION"
                  "CONTINUATION" "PAR" "N-TIMES" "WHENEVER" "WITH-POLICY" "DEF-GOAL"))
    (let ((macro (macro-function (users-name name))))
      (is (find '&body (uiop:symbol-call :sb-introspect '#:function-lambda-list macro))
          "~A has no body" name))))

;;; Editors. No server is loaded here, so what it would ask stands in for it.

(defun call-with-server (function)
  "Call FUNCTION with the function that the inspector of a server called SWANK-BACKEND asks."
  (let* ((package (make-package "SWANK-BACKEND" :use '()))
         (symbol (intern "EMACS-INSPECT" package)))
    (unwind-protect
         (progn (eval `(defgeneric ,symbol (object) (:method (object) (list object))))
                (funcall function symbol))
      (fmakunbound symbol)
      (delete-package package))))

(test inspectors.show-what-slots-mean
  (if (find-package "SWANK-BACKEND")
      (skip "a server is loaded")
      (call-with-server
       (lambda (inspect)
         (is (member "SWANK-BACKEND" (uiop:symbol-call :ars '#:join-editors) :test #'string=))
         (with-skater ()
           (let ((window (funcall inspect skater)))
             (is-true (find "the robot's true heading" window
                            :test (lambda (words item) (and (stringp item) (search words item)))))
             (is (member `(:value ,(robot:robot-world skater)) window :test #'equal))))
         (is (equal '(5) (funcall inspect 5)) "of what is not ours they show what they would")))))

(defun call-with-editor (function)
  "Call FUNCTION while an editor seems to be connected to a server called SWANK, which inspects by
listing what it is given and what it takes for the buffer's package."
  (let ((package (make-package "SWANK" :use '())) (seen nil))
    (unwind-protect
         (destructuring-bind (connection inspect buffer readtable)
             (loop for name in '("DEFAULT-CONNECTION" "INSPECT-IN-EMACS" "*BUFFER-PACKAGE*"
                                 "*BUFFER-READTABLE*")
                   collect (intern name package))
           (proclaim `(special ,buffer ,readtable))
           (setf (fdefinition connection) (constantly t)
                 (fdefinition inspect) (lambda (object)
                                         (setf seen (list object (symbol-value buffer)))))
           (funcall function)
           seen)
      (delete-package package))))

(test inspect-in-editor.works-in-threads-that-are-not-the-servers
  "The server's own variables are unbound there."
  (if (find-package "SWANK")
      (skip "a server is loaded")
      (is (equal (list 5 *package*)
                 (call-with-editor (lambda () (uiop:symbol-call :ars '#:inspect-in-editor 5)))))))

(test inspect-in-editor.says-that-no-editor-is-connected
  (signals base:misuse (uiop:symbol-call :ars '#:inspect-in-editor 5)))

(test inspect.shows-big-objects-in-part
  (flet ((said (object)
           (with-output-to-string (*standard-output*)
             (with-input-from-string (*standard-input* (format nil "q~%")) (inspect object)))))
    (let ((map (said (world:find-map 'ars-worlds:watson))))
      (is (< (length map) 3000))
      (is-true (has-words-p map "WIDTH: 40" "FLAGS: #(1 1 1" "..)")))
    (is (= 30 (count #\z (said (make-list 30 :initial-element "z"))))
        "what is not ours is shown as ever")))

;;; Trajectories.

(defun saved-trajectory (&rest arguments)
  "Return the rows of the trajectory that SAVE-TRAJECTORY writes, given ARGUMENTS."
  (uiop:with-temporary-file (:pathname path :type "csv")
    (apply #'trails:save-trajectory path arguments)
    (mapcar #'base:csv-fields (file-lines path))))

(test trajectories.say-where-robots-were
  (with-skater (:journal t)
    (command:robot-go-forward skater 4)
    (run:run-ticks 12)
    (let ((rows (saved-trajectory)) (few (saved-trajectory :every 5 :until 10 :robots 'skater)))
      (is (equal '("tick" "robot" "x" "y" "angle") (subseq (first rows) 0 5)))
      (is (= 14 (length rows)) "the head and ticks 0 to 12")
      (is (equal '("0" "skater" "5.0" "5.0" "0.0" "5.0" "5.0" "0.0" "" "") (second rows)))
      (is (= (robot:robot-x skater)
             (let ((*read-default-float-format* 'double-float))
               (read-from-string (third (first (last rows)))))))
      (is (equal '("tick" "0" "5" "10") (mapcar #'first few)))
      (is (= 12 (run:simulation-tick)) "and the run has not noticed"))))

(test trajectories.need-a-journal-and-a-name
  (with-skater ()
    (signals base:misuse (saved-trajectory)))
  (with-skater (:journal t)
    (signals base:unknown-name (saved-trajectory :robots 'nobody))
    (signals base:wrong-argument (saved-trajectory :every 0))
    (handler-case (saved-trajectory :until 3)
      (base:wrong-argument (condition)
        (is (search "save-trajectory: until is 3; give a tick of the journal, from 0 to 0"
                    (princ-to-string condition))))
      (:no-error (rows) (is (null rows))))
    (dolist (name '("" "*.csv" "/" 5 nil))
      (signals base:wrong-argument (trails:save-trajectory name)))
    (dolist (name '("/no/such/directory/run.csv" "/dev/null"))
      (signals base:misuse (trails:save-trajectory name)))))

(test trajectories.and-traces-replace-no-files-of-another-kind
  (with-skater (:journal t)
    (run:run-ticks 2)
    (uiop:with-temporary-file (:pathname path :type "csv")
      (flet ((refused-p (save text)
               "True if SAVE, called with PATH, is refused, and TEXT stays in it."
               (let ((told (handler-case (prog1 nil (funcall save path))
                             (base:misuse (misuse) (princ-to-string misuse)))))
                 (and (has-words-p told "unchanged" "another name")
                      (string= text (alexandria:read-file-into-string path))))))
        (run:save-journal path)
        (let ((journal (alexandria:read-file-into-string path)))
          (is-true (refused-p (lambda (path) (trails:save-trajectory path :journal path)) journal))
          (is-true (refused-p (lambda (path) (tasks:write-trace #() path)) journal)))
        (write-text (format nil "a letter~%") path)
        (is-true (refused-p #'trails:save-trajectory (format nil "a letter~%")))
        (write-text "" path)
        (is (pathnamep (trails:save-trajectory path)))
        (is (pathnamep (trails:save-trajectory path)))))))

;;; Conditions print as sentences.

(defun condition-classes ()
  "Return a list of the classes of conditions that the packages of the project export."
  (let ((classes '()))
    (dolist (package (list-all-packages) classes)
      (when (eql 0 (search "ARS-MAGNA." (package-name package)))
        (do-external-symbols (symbol package)
          (let ((class (find-class symbol nil)))
            (when (and class (subtypep class 'condition)
                       (eql 0 (search "ARS-MAGNA." (package-name (symbol-package symbol)))))
              (pushnew class classes))))))))

(defun report-of-its-own-p (class)
  "True if conditions of CLASS say more than what they are called."
  (let ((text (handler-case (princ-to-string (make-condition (class-name class)))
                (error () "Its report needs to know more."))))
    (not (search "was signalled" text))))

(test conditions.say-more-than-what-they-are-called
  (let ((classes (condition-classes)))
    (is (< 20 (length classes)))
    (dolist (class (remove (find-class 'base:ars-magna-error) classes))
      (is-true (report-of-its-own-p class) "~A" class))))

(defun complaint-of (function)
  "Return what the condition says that FUNCTION signals, or NIL."
  (handler-case (progn (funcall function) nil)
    (condition (condition) (princ-to-string condition))))

(test conditions.are-sentences
  (with-skater ()
    (dolist (function (list (lambda () (command:robot-turn skater "far"))
                            (lambda () (world:find-map 'no-such-map))
                            (lambda () (robot:robot-hand skater 7))
                            (lambda () (run:status 'nobody))
                            (lambda () (run:run-ticks -1))
                            (lambda () (rpl:why 1))
                            (lambda () (driver:run-plan 'no-such-plan))
                            (lambda () (run:save-journal "/tmp/none.journal"))
                            (lambda () (run:load-journal "/no/such/file"))
                            (lambda () (trails:save-trajectory "none.csv"))
                            (lambda () (macroexpand-1 '(world:defmap 5 (1 1))))))
      (let ((said (complaint-of function)))
        (is-true (and said (find (char said (1- (length said))) ".?"))
                 "~S" said)))))
