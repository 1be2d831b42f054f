;;;; line.lisp -- what is known of a line command, and which one a user means.

(in-package :ars-magna.cli)

(export '(line usage))

;;; The prompt's own commands are defined here and in the files that follow, each once, by
;;; DEFINE-LINE; the robot's come from the command layer (see robot-lines.lisp). HELP, the menus and
;;; what is said of wrong arguments come from these definitions. Manual E.

(defstruct (parameter-of-line (:conc-name slot-) (:copier nil)
                              (:constructor make-slot (name type text optional-p)))
  "An argument of a line command. TYPE is an argument type of the command layer, or a keyword:
:REST, :LINE (another line) or :FORM (of Lisp) for all that is left of the line; any other for the
characters up to the next blank: :TOKEN, or what they stand for, such as :FILE (see CHOICES)."
  (name "" :type string :read-only t)
  (type nil :type symbol :read-only t)
  (text "" :type string :read-only t)
  (optional-p nil :type boolean :read-only t))

(define-record line
  "A line command."
  (name "" string "what the line command is called, in upper case" :export)
  (full-name nil (or null string) "the full name of the function that it stands for, or NIL")
  (family nil symbol "where HELP lists the line command, a keyword" :export)
  (parameters '() list "the list of the line command's arguments" :export)
  (sentence "" string)
  (details '() list)
  (action nil function "the function of the session and the arguments that does it" :export))

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
  (destructuring-bind (variable type text &optional optional) parameter
    `(make-slot ,(string-downcase variable) ',type ,text ,(eq optional :optional))))

(defmacro define-line (name (session &rest parameters) (family &rest details) sentence &body body)
  "Define the line command NAME, a string. Each of PARAMETERS is (variable type text [:optional]),
the last ones optional; BODY runs with the variables bound to what was read, NIL if left out, and
SESSION to the session. FAMILY, a keyword, says where HELP lists it, SENTENCE what it says, and
DETAILS, strings, what it says below the parameters, a paragraph each."
  `(register-line
    (make-line :name ,(string-upcase name) :family ,family :sentence ,sentence
               :details (list ,@details)
               :parameters (list ,@(mapcar #'slot-form parameters))
               :action (lambda (,session &optional ,@(mapcar #'first parameters))
                         (declare (ignorable ,session))
                         ,@body))))

;;; What a line command takes, in words.

(defgeneric argument-words (type)
  (:documentation "Return in words what is typed for an argument of TYPE, a symbol."))

(defun usage (line)
  "Return how LINE is typed, such as \"POS x y\"."
  (format nil "~A~{ ~A~}" (line-name line)
          (loop for slot in (line-parameters line)
                collect (format nil "~:[~A~;[~A]~]" (slot-optional-p slot) (slot-name slot)))))

(defun slot-words (slot)
  (if (keywordp (slot-type slot))
      (slot-text slot)
      (argument-words (slot-type slot))))

(defun takes (line)
  (format nil "~A~:[ takes no arguments~;~:*: ~{~A is ~A~^, ~}~]." (usage line)
          (loop for slot in (line-parameters line)
                collect (slot-name slot) collect (slot-words slot))))

;;; What a plan takes.

(defun parameter-word (parameter keyword)
  "Return how PARAMETER, of a plan's lambda list after the lambda list keyword KEYWORD, is typed."
  (let ((name (if (consp parameter) (first parameter) parameter)))
    (ecase keyword
      ((nil) (format nil "~(~A~)" name))
      (&optional (format nil "[~(~A~)]" name))
      (&key (if (consp name)
                (format nil "[~(~S~)]" (first name))
                (format nil "[:~(~A~)]" name)))
      ((&rest &body) (format nil "[~(~A~)...]" name)))))

(defun parameter-words (lambda-list)
  (loop with keyword = nil
        for parameter in lambda-list
        until (eq parameter '&aux)
        if (member parameter lambda-list-keywords)
          do (setf keyword parameter)
        else
          collect (parameter-word parameter keyword)))

(defun plan-usage (plan)
  (format nil "~A~{ ~A~}" (procedure-name plan) (parameter-words (procedure-lambda-list plan))))
