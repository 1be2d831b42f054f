;;;; finding.lisp -- which line command a user means; lines typed as Lisp, or the other way round.

(in-package :ars-magna.cli)

(export '(all-line-commands find-line-command))

(defun all-line-commands ()
  "Return a list of all line commands: the prompt's own, then the robot's."
  (append *line-commands*
          (remove-if (lambda (line)
                       (find (line-name line) *line-commands* :key #'line-name :test #'string=))
                     (robot-line-commands))))

(defun all-line-command-names ()
  "Return a list of the names of all line commands, and of the functions that line commands call."
  (let ((lines (all-line-commands)))
    (remove-duplicates (append (mapcar #'line-name lines)
                               (remove nil (mapcar #'line-full-name (robot-line-commands))))
                       :test #'string= :from-end t)))

(defun items-with-prefix (start items key)
  (remove-if-not (lambda (item)
                   (let ((name (funcall key item)))
                     (and name (starts-with-subseq start name))))
                 items))

(defun reject-ambiguous (name names &optional hint)
  (reject-line "~A could be ~{~A~#[~; or ~:;, ~]~}. Type more of the name.~@[ ~A~]"
               (string-upcase name) names hint))

(defun reject-unknown-name (kind name names &optional hint)
  "Signal BAD-LINE because NAME is not among NAMES. KIND names the kind of object, such as plan."
  (reject-line "There is no ~A ~A.~@[ Did you mean ~A?~]~@[ ~A~]" kind (string-upcase name)
               (nearest-name name names) hint))

(defparameter *foreign-line-names*
  '(("?" "HELP") ("EXIT" "QUIT") ("BYE" "QUIT") ("LOGOUT" "QUIT"))
  "Lists (name line): names that other programs use for line commands of the prompt.")

(defparameter *newcomer-hints*
  `((("LEFT")  "TURN-LEFT turns by a quarter, TURN -30 deg by an angle.")
    (("RIGHT") "TURN-RIGHT turns by a quarter, TURN 30 deg by an angle.")
    (("FORWARD" "FORWARDS" "FD" "FWD" "AHEAD" "MOVE" "DRIVE" "WALK" "STRAIGHT")
     "GO 5 m drives 5 metres ahead, GO-FORWARD 5 drives for 5 ticks, GOTO-WALL to a wall.")
    (("BACK" "BACKWARD" "BACKWARDS" "REVERSE" "BK")
     "A robot drives forwards only. ABOUT-FACE turns the robot round.")
    (("ROTATE" "SPIN") "TURN 90 deg turns the robot, to the left if the angle is below 0.")
    (("LOOK" "SEE" "SCAN" "FIND" "SEARCH")
     "CAM-VIEW 0 looks, OBJ-DESIG 1 non-local ((:color red)) searches, MAP draws the world.")
    (("GRAB" "TAKE" "PICK" "PICKUP" "GRASP")
     "HAND-GRASP 0 0 grasps the thing that camera 0 tracks, after OBJ-DESIG and CAM-TRACK.")
    (("DROP" "RELEASE" "PUT" "UNGRASP") "HAND-UNGRASP 0 lets go of what hand 0 holds.")
    (("WHERE" "POSITION" "WHEREAMI" "LS" "DIR" "LIST" "INVENTORY")
     "STATUS describes the robot, THINGS lists the things, MAP draws the world.")
    (("UNDO") "REWIND 10 goes 10 ticks back.")
    (("RESET" "RESTART") "WORLD name starts a world again, REWIND 10 goes 10 ticks back.")
    (("WAIT" "SLEEP" "TICK" "RUN-TICKS")
     "STEP 10 lets 10 ticks pass, PAUSE and RESUME stop and start time.")
    (("RUN-PLAN" "BEGIN-PLAN")
     ,(format nil "PLAN name argument... carries out a plan; in Lisp it is (run-plan 'name ~
                   argument...). (begin-plan 'name argument...) does not wait for its end."))
    (("END-PLAN" "END-PLANS")
     "STOP-PLAN ends all plans, STOP-PLAN 2 plan number 2; in Lisp it is (end-plan plan).")
    (("EACH" "EVERY" "EVERYBODY" "BOTH")
     "ALL: TURN 1 gives the command TURN 1 to each robot; ROBOT lists the robots.")
    (("HALT" "KILL" "ABORT") "STOP stops the robot, STOP-PLAN ends plans, PAUSE stops time.")
    (("LOAD" "SOURCE" "RUN")
     "(load \"FILE\") loads a Lisp file, PLAN name carries out a plan, WORLD name enters a world.")
    (("SIMULATOR" "START") "WORLD name starts a robot's world again, RESUME continues.")
    (("EXPERIMENT" "EXPERIMENTS") "TRIAL lists the experiments, and runs a trial of one.")
    (("JOURNAL" "SAVE") "SAVE-JOURNAL name keeps what was done, REPLAY name repeats it.")
    (("SET" "SETQ" "SETF" "PARAM" "PARAMETER")
     "PARAMS lists the parameters; Lisp such as (setq motion-noise* 0) sets a parameter.")
    (("PRINT" "ECHO" "LET") "A line in parentheses is Lisp: (print (robot-names))."))
  "Lists (words hint): words that newcomers type although they name no line command, and a hint.")

(defun newcomer-hint (name)
  (second (find-if (lambda (hint) (member name (first hint) :test #'string=)) *newcomer-hints*)))

;;; Advice for words that are not lines.

(defun plan-advice (name)
  (let ((plan (find-procedure name nil)))
    (and plan (format nil "~A is a plan: PLAN ~A." (procedure-name plan) (plan-usage plan)))))

(defun line-command-named (name)
  (find name (all-line-commands) :key #'line-name :test #'string-equal))

(defun line-command-advice (name)
  (let ((line (line-command-named name)))
    (and line (format nil "~A is a command of this prompt, typed without parentheses: ~A."
                      (line-name line) (line-command-usage line)))))

(defun parameter-advice (name)
  (let ((parameter (find-parameter name nil)))
    (and parameter
         (format nil "~A is a parameter: (setq ~:*~A VALUE) sets it, PARAMS lists all."
                 (parameter-name parameter)))))

(defun call-advice (name)
  "If NAME, such as TURN(90), begins with the name of a line command, return a sentence on how to
type the line command; else NIL."
  (let ((place (position #\( name)))
    (and place (plusp place) (line-command-advice (subseq name 0 place)))))

(defun variable-advice (name)
  "If NAME is written as a global variable, such as *SCORE*, return a sentence on how to see its
value; else NIL."
  (and (< 2 (length name)) (char= #\* (char name 0) (char name (1- (length name))))
       (format nil "EVAL ~A shows the value of a variable." name)))

(defun reject-unknown-command (name)
  (let ((hint (or (newcomer-hint name) (plan-advice name) (parameter-advice name) (call-advice name)
                  (variable-advice name)
                  (and (public-function-named name)
                       (format nil "~A is Lisp, in parentheses: (~(~:*~A~) ...)." name)))))
    (reject-line "There is no command ~A.~@[ ~A~]~@[ Did you mean ~A?~] HELP lists all commands."
                 name hint
                 (and (null hint)
                      (nearest-name name (append (mapcar #'first *aliases*)
                                                 (all-line-command-names)))))))

(defun line-command-with-prefix (name)
  "Return the line command whose name, or else full name, begins with NAME. Of several line
commands, return the one whose name is the beginning of all the others. Otherwise signal BAD-LINE."
  (let ((candidates (or (items-with-prefix name (all-line-commands) #'line-name)
                        (items-with-prefix name (robot-line-commands) #'line-full-name))))
    (cond ((null candidates) (reject-unknown-command name))
          ;; STOP, not STOP-PLAN.
          ((find-if (lambda (line) (every (lambda (other)
                                            (starts-with-subseq (line-name line)
                                                                (line-name other)))
                                          candidates))
                    candidates))
          (t (reject-ambiguous name (mapcar #'line-name candidates) (newcomer-hint name))))))

(defun find-line-command (name)
  "Return the line command for NAME, a string of any case. NAME may be the command's name, the full
name of its function, another program's name for the command, or the beginning of a name. Of several
line commands, return the one whose name is the beginning of all the others. Signals BAD-LINE."
  (let* ((typed (string-upcase name))
         (name (or (second (assoc typed *foreign-line-names* :test #'string=)) typed)))
    (or (line-command-named name)
        (find name (robot-line-commands) :key #'line-full-name :test #'equal)
        (line-command-with-prefix name))))

;;; Undefined functions.

(defun advice-on-function (condition)
  "Return a sentence of advice if CONDITION reports an undefined function; otherwise NIL."
  (let ((name (and (typep condition 'undefined-function) (cell-error-name condition))))
    (when (and name (symbolp name))
      (or (plan-advice name)
          (line-command-advice (symbol-name name))
          (multiple-value-bind (symbol status) (find-symbol (symbol-name name) :ars-worlds)
            (and (eq :external status)
                 (fboundp symbol)
                 (format nil "There is ARS-WORLDS:~A." symbol)))))))

(defun text-with-advice (condition)
  "Return the text of CONDITION, an error in a line, with a hint for an undefined function."
  (let* ((advice (advice-on-function condition))
         (*report-addition* (if advice (constantly nil) *report-addition*)))
    (format nil "~A~@[ ~A~]" (condition-text condition) advice)))

;;; Calls.

(defun check-typed-call (form)
  "Signal BAD-LINE if FORM, as typed, calls a function with a wrong number of arguments."
  (when (and (typep form '(cons symbol))
             (proper-list-p form)
             (fboundp (first form))
             (not (macro-function (first form)))
             (not (special-operator-p (first form))))
    (multiple-value-bind (parameters known-p) (function-argument-types (first form))
      (let ((trouble (and known-p
                          (arguments-misfit-text (lambda-list-shape parameters) (rest form)))))
        (when trouble
          (reject-line "~(~A~) takes ~A, not ~A.~@[ ~A~]" (first form)
                       (lambda-list-text (lambda-list-of (first form))) trouble
                       (line-command-advice (symbol-name (first form)))))))))

;; Lisp's own STEP and GO, which are called like lines, do nothing with a number. An undefined
;; function is reported before its arguments, such as DEG, are evaluated.
(defun check-line-in-parentheses (form)
  "Signal BAD-LINE if FORM, as typed, is a line command in parentheses, such as (step 5)."
  (when (and (typep form '(cons symbol))
             (or (typep form '(cons (member step go) (or null (cons real))))
                 (not (fboundp (first form))))
             (line-command-named (symbol-name (first form))))
    (reject-line "~A" (line-command-advice (symbol-name (first form))))))

;;; New variables.

(defun warn-of-new-variable (name)
  "Warn that typed Lisp has set the undefined variable NAME, if NAME is similar to a defined
variable or ends in an asterisk."
  (let ((meant (similar-variable name)) (elsewhere (variable-elsewhere-text name)))
    (when (or meant elsewhere (let ((place (position #\* (symbol-name name) :from-end t)))
                      (and place (plusp place) (= place (1- (length (symbol-name name)))))))
      (warning-set (format nil "~(~A~) is a new variable; it was not defined before.~@[ Did you ~
                                mean ~A?~] ~:[(defvar ~(~A~) ...) defines it.~;~:*~A~]"
                           name meant elsewhere name)))))

;;; A second command in a line.

(defun command-in-comment (text)
  "TEXT is a line that is not Lisp. Return its comment if the comment looks like a second command,
as in turn 1; go 3. Otherwise return NIL."
  (let ((start (position #\; text)))
    (when (and start
               (plusp start)
               (not (find #\" text :end start))
               (not (blank-character-p (char text (1- start)))))
      (let ((comment (string-trim " ;" (subseq text start))))
        (and (string/= "" comment)
             (line-command-named (split-first-word comment))
             comment)))))

(defun warn-of-command-in-comment (text)
  (let ((comment (command-in-comment text)))
    (when comment
      (warning-set (format nil "What follows ; is a comment: ~A was left out. Type one command a ~
                                line."
                           comment)))))
