;;;; entries.lisp -- the reference: entries of names, and of commands.

(in-package :ars-magna.manual)

(export '(chapter-title))

(define-record entry
  "An entry of the reference."
  (name "" string "the name that the entry describes, as users write it" :export)
  (chapter nil keyword "the key of the chapter that the entry is in" :export)
  (section "" string "the heading of the entry's section in the chapter")
  (symbol nil symbol)
  (use "" string "a call or use of the name")
  (facts '() list "lists (label text)")
  (text "" string "the description of the name")
  (file nil (or null string) "the file where the name is defined, or NIL"))

(defparameter *chapters*
  '((:commands "Commands" "Commands for robots, cameras, hands and storage bins.")
    (:prompt "The prompt's lines" "Lines to type after Robot>, besides Lisp.")
    (:parameters "Parameters" "Special variables that set the physics and noise of the world.")
    (:error-codes "Error codes" "Error codes for continuations, and the commands that pass them.")
    (:definers "Definers" "Macros and functions that define things of your own.")
    (:constructs "Plan constructs" "What plans can say beyond Lisp.")
    (:plan-functions "Plan functions" "Functions with which plans command and query their robot.")
    (:fluents "Fluents" "Variables with the fluents that tell plans how commands ended.")
    (:attributes "Attributes" "Properties of things, and how well they are sensed.")
    (:substances "Substances" "Materials of walls and things.")
    (:place-types "Place types" "Kinds of places that a robot can sense where it stands.")
    (:colours "Colours" "For the drawing code of place types.")
    (:conditions "Conditions and restarts" "Errors that are signalled, and how to continue.")
    (:robots "Maps and robots" "The shipped worlds: the system ars-magna/worlds.")
    (:kickers "Kickers" "Programs that move or change things of the shipped worlds.")
    (:manipulations "Manipulations" "What robots can do to things of the shipped worlds.")
    (:plans "Shipped plans" "Plans to start with.")
    (:experiments "Shipped experiments" "Experiments that you can run as they are.")
    (:names "Functions, variables, types" "All other names of ARS and NISP, by layer.")
    (:worlds-names "Other names of the worlds" "What else ARS-WORLDS has: things, and functions."))
  "Lists (key title introduction), in order. A name is linked to the first chapter that has it.")

(defun chapter-title (chapter)
  "Return the title of CHAPTER, a key of *CHAPTERS*."
  (second (assoc chapter *chapters*)))

(defun chapter-introduction (chapter) (third (assoc chapter *chapters*)))

(defun chapter-file (chapter)
  (format nil "reference-~(~A~).html" chapter))

(defun entry-address (entry)
  (format nil "~A#~A" (chapter-file (entry-chapter entry)) (entry-anchor (entry-name entry))))

(defun entry-key (entry)
  (string-downcase (entry-name entry)))

;;; What is known of symbols.

(defun project-file-name (path)
  "Return PATH, a native file name, relative to the project's directory; NIL if it is outside."
  (let ((directory (native-name (project-root))))
    (and path
         (starts-with-subseq directory path)
         (subseq path (length directory)))))

(defun file-of-symbol (symbol)
  "Return the name of the project's file in which SYMBOL is defined, or NIL."
  (some #'project-file-name
        (append (when (fboundp symbol)
                  (list (function-file (or (macro-function symbol) (fdefinition symbol)))))
                (mapcar #'first (files-of-other-definitions symbol)))))

(defun call-as-text (name lambda-list)
  "Return as text a call of the function or macro NAME with LAMBDA-LIST, without package prefixes."
  (let ((*print-case* :downcase) (*print-pretty* nil)
        (*package* (or (and (symbolp name) (symbol-package name)) *package*)))
    (format nil "(~A~{ ~A~})" (string-downcase name)
            (mapcar #'unqualified-text (visible-parameters lambda-list)))))

(defun visible-parameters (lambda-list)
  "Return LAMBDA-LIST without its &whole, &environment and &aux parameters."
  (loop with rest = lambda-list
        while (consp rest)
        for item = (pop rest)
        if (member item '(&whole &environment)) do (pop rest)
        else if (eq item '&aux) do (loop-finish)
        else collect item into items
        finally (return (append items (and rest (list '&rest rest))))))

(defun symbol-documentation (symbol)
  (format nil "~{~A~^~2%~}" (documentation-texts symbol)))

(defun symbol-kinds (symbol)
  (append (cond ((macro-function symbol) '("macro"))
                ((not (fboundp symbol)) '())
                ((typep (fdefinition symbol) 'generic-function) '("generic function"))
                (t '("function")))
          (cond ((eq :symbol-macro (variable-kind symbol)) '("variable"))
                ((not (boundp symbol)) '())
                ((constantp symbol) '("constant"))
                (t '("variable")))
          (let ((class (find-class symbol nil)))
            (cond ((null class) '())
                  ((subtypep symbol 'condition) '("condition"))
                  (t '("type"))))))

(defun packages-exporting (symbol)
  "Return the names of the users' packages that export the name of SYMBOL."
  (loop for face in '("ARS" "NISP" "ARS-WORLDS" "ARS-FIVEAM")
        when (and (find-package face)
                  (multiple-value-bind (other status) (find-symbol (symbol-name symbol) face)
                    (and (eq :external status)
                         (or (eq other symbol)
                             (and (fboundp symbol) (fboundp other)
                                  (eq (fdefinition other) (fdefinition symbol)))))))
          collect face))

(defun symbol-facts (symbol)
  (let ((sorts (symbol-kinds symbol)) (packages (packages-exporting symbol)))
    (append (when sorts (list (list "Is a" (format nil "~{~A~^, ~}" sorts))))
            (when packages (list (list "Package" (format nil "~{~A~^, ~}" packages)))))))

;;;; Commands

(defun code-markup (name)
  (format nil "`~(~A~)`" name))

(defun keyword-heading (keyword)
  (let ((words (substitute #\Space #\- (string-downcase keyword))))
    (string-upcase words :end 1)))

(defun argument-facts (specifications)
  (loop for spec in specifications
        collect (list (string-downcase (spec-name spec))
                      (format nil "~A~@[; ~A~]" (argument-type-text (spec-type spec))
                              (and (string/= "" (spec-text spec)) (spec-text spec))))))

(defun result-fact (command)
  (list "Continuation gets"
        (format nil "an error code or NIL; the ~(~A~)~{; ~A~}"
                (spec-name (command-resource command))
                (mapcar #'spec-text (command-results command)))))

(defun error-fact (command)
  (list "Error codes"
        (format nil "~{~A, ~}~A"
                (loop for code in (command-errors command)
                      collect (code-markup (format nil ":~A" (error-code-keyword code))))
                (code-markup ":interrupt"))))

(defun plan-function-of (command)
  (multiple-value-bind (symbol status)
      (find-symbol (format nil "RPL-~A" (command-name command)) :nisp)
    (and (eq :external status) symbol)))

(defun prompt-and-plan-facts (command)
  (append (list (list "At the prompt" (code-markup (command-prompt-name command))))
          (when (plan-function-of command)
            (list (list "In plans" (code-markup (plan-function-of command)))))
          (when (command-section command)
            (list (list "Cited" (format nil "Manual ~A" (command-section command)))))))

(defun command-entry (command)
  (make-entry :name (string-downcase (command-name command)) :chapter :commands
              :section (keyword-heading (command-family command)) :symbol (command-name command)
              :use (format nil "(~(~A ~A~{ ~A~}~) [continuation])" (command-name command)
                           (spec-name (command-resource command))
                           (mapcar #'spec-name (command-parameters command)))
              :facts (append (argument-facts (cons (command-resource command)
                                                   (command-parameters command)))
                             (list (result-fact command) (error-fact command))
                             (prompt-and-plan-facts command))
              :text (format nil "~A The command takes effect in the next tick and returns nothing."
                            (command-documentation command))
              :file (file-of-symbol (command-name command))))

(defun simulator-commands ()
  "Return the simulator's own commands, without commands that users have defined."
  (remove-if-not (lambda (command) (packages-exporting (command-name command))) (all-commands)))

;;; Error codes.

(defun find-error-code (keyword command)
  (find keyword (command-errors command) :key #'error-code-keyword))

(defun error-entry (keyword commands)
  (let* ((failing (remove-if-not (lambda (command) (find-error-code keyword command)) commands))
         (messages (remove-duplicates
                    (loop for command in failing
                          for text = (error-code-text (find-error-code keyword command))
                          when (stringp text) collect text)
                    :test #'string=)))
    (make-entry :name (format nil "~(~S~)" keyword) :chapter :error-codes
                :use (format nil "~(~S~)" keyword)
                :facts `(,@(when messages
                             (list (list "Message" (format nil "~{~A~^; ~}." messages))))
                         ("Told by" ,(format nil "~{~A~^, ~}"
                                             (mapcar (lambda (command)
                                                       (code-markup (command-name command)))
                                                     failing))))
                :text (format nil "~@[~A ~]~@[~A ~]The continuation of a command gets this code as ~
                                   its first argument."
                              (error-code-meaning keyword) (error-code-remedy keyword)))))

(defun interrupt-entry ()
  (make-entry :name ":interrupt" :chapter :error-codes :use ":interrupt"
              :facts '(("Told by" "every command"))
              :text "The error code for the continuation of a command that a newer one has
interrupted by taking over its robot, camera, hand or bin, or that was in progress at the end of the
run (manual 3.1.1)."))

(defun error-entries ()
  (let* ((commands (simulator-commands))
         (keywords (remove-duplicates (loop for command in commands
                                            append (mapcar #'error-code-keyword
                                                           (command-errors command))))))
    (cons (interrupt-entry)
          (mapcar (lambda (keyword) (error-entry keyword commands))
                  (sort keywords #'string<)))))

;;; The prompt's lines.

(defun line-entry (line)
  (make-entry :name (string-downcase (line-name line)) :chapter :prompt
              :section (keyword-heading (line-family line)) :use (line-command-usage line)
              :facts (append (when (line-full-name line)
                               (list (list "Stands for"
                                           (code-markup (line-full-name line)))))
                             (mapcar (lambda (slot) (list "" (line-parameter-help slot)))
                                     (line-parameters line))
                             (mapcar (lambda (detail) (list "" detail)) (line-details line)))
              :text (line-sentence line)
              :file (project-file-name (function-file (line-action line)))))

(defun simulator-lines ()
  "Return the prompt's own lines, without lines for commands that users have defined."
  (let ((others (mapcar #'command-prompt-name
                        (set-difference (all-commands) (simulator-commands)))))
    (remove-if (lambda (line) (member (line-name line) others :test #'string-equal))
               (all-line-commands))))
