;;;; topics.lisp -- what HELP and APROPOS describe besides lines and plans.

(in-package :ars-magna.cli)

;;; Everything that is defined by name is a topic. *TOPIC-KINDS* lists the kinds, with functions
;;; that return all topics of the kind, a topic's name and its description.

;;; Descriptions.

(defun place-type-description (type)
  (format nil "PLACE senses whether the robot is in such a place~:[; PLACE-DESIG 0 ~(~A~) searches ~
               for one, and takes another place for it with a probability of ~A~;, but no camera ~
               finds such places~]."
          (place-type-invisible-p type) (place-type-name type)
          (plain-number-text (place-type-confusion type))))

(defun attribute-description (attribute)
  (format nil "~:[A number~;One of ~:*~{~(~A~)~^, ~}~]. ~@[A reading is right with a probability ~
               of ~A. ~]Seen without being looked for with a ~
               probability of ~A.~@[ Sensed more often when these are looked ~
               for: ~{~(~S~)~^, ~}.~]"
          (attribute-domain attribute)
          (and (eq :discrete (attribute-kind attribute))
               (plain-number-text (attribute-success attribute)))
          (plain-number-text (attribute-noticed attribute))
          (attribute-supporters attribute)))

(defun values-with-attributes ()
  "Return lists (value attribute) for all values of attributes that are names, such as RED."
  (loop for attribute in (all-attributes)
        append (loop for value in (attribute-domain attribute)
                     unless (member value '(t nil)) collect (list value attribute))))

(defun value-attribute-name (value)
  (format nil "~(~S~)" (attribute-name (second value))))

(defun value-description (value)
  (destructuring-bind (value attribute) value
    (format nil "OBJ-DESIG 1 non-local ((~A ~A)) searches for such things."
            (text-as-typed (attribute-name attribute)) (text-as-typed value))))

(defun substance-description (substance)
  (format nil "A camera reads ~A where a wall or thing consists of this substance, unless the wall ~
               or thing has a value of its own."
          (plain-number-text (substance-parameter (substance-name substance)))))

(defun kicker-description (kicker)
  (format nil "Runs on each tick with a probability of ~A on each thing with this kicker.~@[ ~A~]"
          (plain-number-text (kicker-prob kicker))
          (documentation (kicker-name kicker) 'function)))

(defun manipulation-description (manipulation)
  (format nil "Type ~{MANIPULATE ~A~^ or ~}."
          (manipulation-usages manipulation)))

(defun map-description (map)
  (format nil "~D by ~D cells.~@[ WORLD ~(~A~) goes there.~]" (map-width map) (map-height map)
          (and (robot-names-in-map map) (map-name map))))

(defun robot-description (blueprint)
  (format nil "Lives in ~(~A~)." (blueprint-map blueprint)))

(defun experiment-description (experiment)
  (or (experiment-documentation experiment) "Not documented."))

(defun measure-description (measure)
  (format nil "MEASURE ~(~A~) shows its value.~@[ ~A~]" (measure-name measure)
          (documentation (measure-name measure) 'measure)))

(defun run-variable-description (definition)
  (let ((name (variable-definition-name definition)))
    (format nil "Each run has its own value, which STATUS shows once it is used.~@[ ~A~]"
            (documentation name 'variable))))

(defun error-codes-with-commands ()
  (let ((table '()))
    (dolist (command (all-commands) (nreverse table))
      (dolist (code (command-errors command))
        (let ((known (assoc (error-code-keyword code) table :key #'error-code-keyword)))
          (if known
              (setf (rest known) (append (rest known) (list command)))
              (push (list code command) table)))))))

(defun error-code-topic-name (entry) (error-code-keyword (first entry)))

(defun error-code-description (entry)
  (destructuring-bind (code . commands) entry
    (format nil "~A Passed to the continuations of ~{~(~A~)~^, ~}." (error-code-explanation code)
            (mapcar #'command-name commands))))

(defun error-code-explanation (code)
  (let ((keyword (error-code-keyword code)))
    (if (error-code-meaning keyword)
        (format nil "~A~@[ ~A~]" (error-code-meaning keyword) (error-code-remedy keyword))
        (format nil "~@[~A.~]" (and (stringp (error-code-text code)) (error-code-text code))))))

(defun common-error-codes ()
  '(:interrupt))

(defun common-error-code-description (keyword)
  (format nil "~A ~A Passed to the continuation of any command."
          (error-code-meaning keyword) (error-code-remedy keyword)))

;;; Restarts, which a debugger offers.

(defun restart-description (name)
  (format nil "~A In Lisp: (invoke-restart '~(~A~))." (restart-documentation name) name))

;;; Names in a separate system.

(defun names-in-optional-system ()
  "Return the names that the system ars-magna/fiveam defines; NIL if that system is loaded."
  (unless (find-package :ars-fiveam) '("IS-SUCCESS-RATE" "PASS-PROBABILITY" "REPEAT-TRIAL")))

(defun optional-name-description (name)
  (format nil "ARS-FIVEAM:~A comes with (asdf:load-system \"ars-magna/fiveam\"), for tests." name))

;;; Names of Lisp.

(defun documentation-texts (symbol)
  "Return the docstrings of SYMBOL as a function, variable and type, each once."
  (remove-duplicates (loop for kind in '(function variable type)
                           for text = (documentation symbol kind)
                           when text collect text)
                     :test #'string= :from-end t))

(defun documented-names ()
  "Return a sorted list of the documented names of simulator, worlds and user, and of the packages
that the user's package uses, except parameters."
  (let ((names '()))
    (dolist (package (append (remove-if-not #'find-package
                                            '(:ars :nisp :ars-rap :ars-worlds :ars-fiveam))
                             (remove (find-package :common-lisp)
                                     (package-use-list (user-package)))))
      (do-external-symbols (symbol package) (pushnew symbol names :test #'string=)))
    (do-symbols (symbol (user-package))
      (when (eq (user-package) (symbol-package symbol)) (pushnew symbol names :test #'string=)))
    (sort (remove-if (lambda (name) (find-parameter name nil))
                     (remove-if-not #'documentation-texts names))
          #'string<)))

(defun lisp-name-kind (symbol)
  (cond ((member symbol (all-constructs) :test #'string=) "construct")
        ((macro-function symbol) "macro")
        ((fboundp symbol) "function")
        ((or (boundp symbol) (eq :symbol-macro (variable-kind symbol))) "variable")
        (t "type")))

(defun lisp-name-description (symbol)
  (format nil "~{~A~^~%~}" (documentation-texts symbol)))

(defun name-as-typed (symbol)
  "Return SYMBOL as users type it: with a package prefix unless it is accessible in ARS-USER."
  (if (eq symbol (find-symbol (symbol-name symbol) (user-package)))
      (symbol-name symbol)
      (format nil "~A:~A" (package-name (symbol-package symbol)) symbol)))

(defun call-text (symbol)
  (let ((*package* (or (symbol-package symbol) *package*)) (*print-pretty* nil))
    (format nil "(~(~A~{ ~S~}~))" (name-as-typed symbol)
            (ldiff (lambda-list-of symbol) (member '&aux (lambda-list-of symbol))))))

(defun write-lisp-topic (symbol)
  (format t "~A, ~A~%" symbol (lisp-name-kind symbol))
  (when (fboundp symbol) (write-filled (call-text symbol) 2))
  (write-paragraphs (lisp-name-description symbol) 2))

(defun write-paragraphs (text indent)
  "Write TEXT, indented by INDENT columns. Lines that begin with a blank are kept, others filled."
  (let ((paragraph '()))
    (flet ((end-paragraph ()
             (when paragraph
               (write-filled (format nil "~{~A~^ ~}" (reverse (shiftf paragraph '()))) indent))))
      (with-input-from-string (in text)
        (loop for line = (read-line in nil)
              while line
              do (cond ((or (string= line "") (blank-character-p (char line 0)))
                        (end-paragraph)
                        (write-trimmed-line "~VA~A" indent "" line))
                       (t (push line paragraph)))))
      (end-paragraph))))

;;; The kinds.

(defparameter *topic-kinds*
  '(("line" all-line-commands line-name line-sentence write-help)
    ("plan" all-procedures procedure-name plan-documentation write-plan-help)
    ("parameter" all-parameters parameter-name parameter-sentence write-parameter)
    ("place type" all-place-types place-type-name place-type-description)
    ("attribute" all-attributes attribute-name attribute-description)
    (value-attribute-name values-with-attributes first value-description)
    ("substance" all-substances substance-name substance-description)
    ("kicker" all-kickers kicker-name kicker-description)
    ("manipulation" all-manipulations manipulation-name manipulation-description)
    ("clause of maps" all-clause-kinds clause-kind-name clause-kind-usage)
    ("map" all-maps map-name map-description)
    ("robot" all-blueprints blueprint-name robot-description)
    ("experiment" all-experiments experiment-name experiment-description)
    ("measure" all-measures measure-name measure-description)
    ("run variable" all-run-variables variable-definition-name run-variable-description)
    ("error code" error-codes-with-commands error-code-topic-name error-code-description)
    ("error code" common-error-codes identity common-error-code-description)
    ("restart" restart-name-list identity restart-description)
    ("subject" all-subjects first subject-description)
    ("name of a library" names-in-optional-system identity optional-name-description)
    (lisp-name-kind documented-names identity lisp-name-description write-lisp-topic))
  "Lists (title lister name description [writer]), one for each kind of topic. LISTER is a function
that returns all objects of the kind. NAME, DESCRIPTION and WRITER are functions of an object;
WRITER prints the object's help. TITLE is a text or a function of an object.")

(defstruct (topic (:constructor make-topic (kind object name)) (:copier nil))
  "A topic of HELP: an OBJECT of KIND, an element of *TOPIC-KINDS*."
  (kind '() :type list :read-only t)
  (object nil :read-only t)
  (name "" :type string :read-only t))

(defun all-topics ()
  (loop for kind in *topic-kinds*
        append (loop for object in (funcall (second kind))
                     collect (make-topic kind object
                                         (string-upcase (string (funcall (third kind) object)))))))

(defun topic-title (topic)
  (let ((title (first (topic-kind topic))))
    (if (stringp title) title (funcall title (topic-object topic)))))

(defun topic-description (topic)
  (funcall (fourth (topic-kind topic)) (topic-object topic)))

(defun name-without-marks (name)
  "Return NAME upcased, without colons, stars and quotes: RED for :red, MAX-SPEED for max-speed*."
  (string-trim ":*'()" (string-upcase name)))

(defun topics-named (name)
  (let ((name (name-without-marks name)))
    (remove-duplicates (remove name (all-topics)
                               :key (lambda (topic) (name-without-marks (topic-name topic)))
                               :test-not #'string=)
                       :key #'topic-description :test #'equal :from-end t)))

(defun write-topic (topic)
  (let ((writer (fifth (topic-kind topic))))
    (cond (writer (funcall writer (topic-object topic)))
          (t (format t "~A, ~A~%" (topic-name topic) (topic-title topic))
             (write-filled (topic-description topic) 2)))))

(defmethod argument-choices ((type (eql :topic)) session typed)
  (append (argument-choices :command session typed)
          (mapcar (lambda (topic) (string-downcase (topic-name topic))) (all-topics))))

;;; Subjects that are no names in the simulator: keys, units, scripts.

(defparameter *help-subjects*
  '(("KEYS" "At a terminal or in a window you edit a line as in a shell or Emacs. Left, right, Home,
End, control-A and control-E move in it; with Alt or control, left and right go by words. Backspace,
Delete and control-D delete a character, control-W the word before, control-U and control-K all
before and after; control-Y brings back what these deleted. Up and down bring back earlier lines,
also of earlier sessions (HISTORY); control-R searches them for what you type next. Tab completes; a
second time it lists the choices. Control-L clears the screen. Control-C clears the line, or ends
what is running. Control-D in an empty line leaves. At a terminal only, control-Z goes back to the
shell, where fg comes here again, and control-\\ ends the program at once. A window's button Help
lists the keys of its displays.")
    ("HISTORY" "The last thousand lines typed at a terminal are kept in
~/.local/state/ars-magna/history, or under $XDG_STATE_HOME. Up and control-R bring them back. Remove
the file to forget them.")
    ("UNITS" "A number alone is in radians, metres (a cell is one wide) or ticks. Otherwise give
the unit: 90 deg, pi/2, 1/4 turn; 5 m, 250 cm; 0.5 m/tick; 20 ticks.")
    ("SCRIPTS" "A script is a file of lines as you type them. ./cli/ars-magna FILE runs it, each
line when the one before has ended. With --json it writes objects for other programs. A pasted or
saved session is a script, too: the prompt before a line and messages after a line are skipped.
Remove other answers, which would be read as lines.")
    ("NUMERIC" "The kind of attributes whose values are numbers: (defattribute :height
numeric).")
    ("COLOURS" "Colours appear on terminals, unless the environment has NO_COLOR or you started with
--color never."))
  "Lists (name text): subjects of HELP that are not names in the simulator.")

(defun all-subjects () *help-subjects*)

(defun subject-description (subject) (one-line (second subject)))
