;;;; line.lisp -- what is known of a line command, and which one a user means.

(in-package :ars-magna.cli)

;;; The prompt's own commands are defined here and in the files that follow, each once, by
;;; DEFINE-LINE; the robot's come from the command layer (see robot-lines.lisp). HELP, the menus and
;;; what is said of wrong arguments come from these definitions. Manual E.

(defstruct (parameter-of-line (:conc-name slot-) (:copier nil)
                              (:constructor make-slot (name type text optional-p)))
  "An argument of a line command. TYPE is an argument type of the command layer, or :TOKEN, for
the characters up to the next blank, or :REST, for all that is left of the line."
  (name "" :type string :read-only t)
  (type nil :type symbol :read-only t)
  (text "" :type string :read-only t)
  (optional-p nil :type boolean :read-only t))

(defstruct (line (:copier nil))
  "A line command: ACTION is called with the session and the arguments, as read."
  (name "" :type string :read-only t)
  ;; The full name of the function that it stands for, or NIL.
  (full-name nil :type (or null string) :read-only t)
  (family nil :type symbol :read-only t)
  (parameters '() :type list :read-only t)
  (sentence "" :type string :read-only t)
  (details '() :type list :read-only t)
  (action nil :type function :read-only t))

(document-functions
  line-name "Return what the line command is called, in upper case."
  line-parameters "Return the list of the line command's arguments."
  line-sentence "Return the sentence that says what the line command does.")

(defmethod print-object ((line line) stream)
  (print-unreadable-object (line stream :type t) (write-string (line-name line) stream)))

(defvar *lines* '() "The line commands made by DEFINE-LINE, in order of definition.")

(defun register-line (line)
  (let ((old (member (line-name line) *lines* :key #'line-name :test #'string=)))
    (if old
        (setf (first old) line)
        (setf *lines* (append *lines* (list line))))
    (line-name line)))

(defun slot-form (parameter)
  "Return a form that makes the slot for PARAMETER of DEFINE-LINE."
  (destructuring-bind (variable type text &optional optional) parameter
    `(make-slot ,(string-downcase variable) ',type ,text ,(eq optional :optional))))

(defmacro define-line (name (session &rest parameters) (family) sentence &body body)
  "Define the line command NAME, a string. Each of PARAMETERS is (variable type text [:optional]),
the last ones optional; BODY runs with the variables bound to what was read, NIL if left out, and
SESSION to the session. FAMILY, a keyword, says where HELP lists it, and SENTENCE what it says."
  `(register-line
    (make-line :name ,(string-upcase name) :family ,family :sentence ,sentence
               :parameters (list ,@(mapcar #'slot-form parameters))
               :action (lambda (,session &optional ,@(mapcar #'first parameters))
                         (declare (ignorable ,session))
                         ,@body))))

;;; What a line command takes, in words.

(defun usage (line)
  "Return how LINE is typed, such as \"POS x y\"."
  (format nil "~A~{ ~A~}" (line-name line)
          (loop for slot in (line-parameters line)
                collect (format nil "~:[~A~;[~A]~]" (slot-optional-p slot) (slot-name slot)))))

(defun slot-words (slot)
  "Return what the argument in SLOT has to be."
  (case (slot-type slot)
    ((:token :rest) (slot-text slot))
    (t (argument-words (slot-type slot)))))

(defun takes (line)
  "Return in a sentence what LINE takes."
  (format nil "~A~:[ takes no arguments~;~:*: ~{~A is ~A~^, ~}~]." (usage line)
          (loop for slot in (line-parameters line)
                collect (slot-name slot) collect (slot-words slot))))

;;; Which line command is meant.

(defvar *aliases* '() "Lists (name text), in upper case and as typed: what ALIAS has defined.")

(defun all-lines ()
  "Return a list of all line commands: the prompt's own, then the robot's."
  (append *lines*
          (remove-if (lambda (line)
                       (find (line-name line) *lines* :key #'line-name :test #'string=))
                     (robot-lines))))

(defun all-line-names ()
  "Return a list of the names of all line commands, and of the functions that they stand for."
  (let ((lines (all-lines)))
    (remove-duplicates (append (mapcar #'line-name lines)
                               (remove nil (mapcar #'line-full-name (robot-lines))))
                       :test #'string= :from-end t)))

(defun lines-starting (start lines key)
  (remove-if-not (lambda (line)
                   (let ((name (funcall key line)))
                     (and name (starts-with-subseq start name))))
                 lines))

(defun reject-ambiguous (name lines)
  (reject-line "~A could be ~{~A~#[~; or ~:;, ~]~}. Type more of it." name
               (mapcar #'line-name lines)))

(defun reject-unknown (name)
  (reject-line "There is no command ~A.~@[ Did you mean ~A?~] HELP lists all commands." name
               (nearest-name name (append (mapcar #'first *aliases*) (all-line-names)))))

(defun beginning-of-all (lines)
  "Return the one of LINES with whose name those of all others begin, or NIL: STOP, not STOP-PLAN."
  (find-if (lambda (line)
             (every (lambda (other) (starts-with-subseq (line-name line) (line-name other))) lines))
           lines))

(defun complete-line (name)
  "Return the line command whose name, or else full name, begins with NAME: the only one, or the one
that all others go on from."
  (let ((candidates (or (lines-starting name (all-lines) #'line-name)
                        (lines-starting name (robot-lines) #'line-full-name))))
    (cond ((null candidates) (reject-unknown name))
          ((beginning-of-all candidates))
          (t (reject-ambiguous name candidates)))))

(defun find-line (name)
  "Return the line command called NAME, a string of any case: its name, the full name of a command's
function, or the beginning of a name; if several begin so, of the one that the others go on from.
Signals BAD-LINE."
  (let ((name (string-upcase name)))
    (or (find name (all-lines) :key #'line-name :test #'string=)
        (find name (robot-lines) :key #'line-full-name :test #'equal)
        (complete-line name))))
