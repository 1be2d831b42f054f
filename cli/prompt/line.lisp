;;;; line.lisp -- definitions of line commands: the prompt's own, and the robot's.

(in-package :ars-magna.cli)

(export '(line line-command-usage))

;;; The prompt's own commands are defined here and in the files that follow, each once, by
;;; DEFINE-LINE. The robot's commands come from the command layer (see below). HELP, the menus and
;;; messages on wrong arguments are made from these definitions. Manual E.

(defstruct (line-parameter (:constructor make-line-parameter (name type text optional-p))
                           (:copier nil))
  "A parameter of a line command. TYPE is an argument type of the command layer, or a keyword.
:REST, :LINE (another line) and :FORM (of Lisp) stand for the rest of the line. :TOKEN and other
keywords, such as :FILE, stand for the text up to the next blank. CHOICES depends on the keyword."
  (name "" :type string :read-only t)
  (type nil :type symbol :read-only t)
  (text "" :type string :read-only t)
  (optional-p nil :type boolean :read-only t))

(define-record line
  "A line command."
  (name "" string "what the line command is called, in upper case" :export)
  (full-name nil (or null string) "the full name of the function that it stands for, or NIL")
  (family nil symbol "where HELP lists the line command, a keyword" :export)
  (parameters '() list "the list of the line command's parameters" :export)
  (sentence "" string)
  (details '() list)
  (action nil function "the function of the session and the arguments that does it" :export))

(defmethod print-object ((line line) stream)
  (print-unreadable-object (line stream :type t) (write-string (line-name line) stream)))

(defvar *line-commands* '() "The line commands made by DEFINE-LINE, in order of definition.")

(defvar *aliases* '() "Lists (name text) of aliases; names in upper case, texts as typed.")

(defun register-line (line)
  (let ((old (member (line-name line) *line-commands* :key #'line-name :test #'string=)))
    (if old
        (setf (first old) line)
        (setf *line-commands* (append *line-commands* (list line))))
    (line-name line)))

(defmacro define-line (name (session &rest parameters) (family &rest details) sentence &body body)
  "Define the line command NAME, a string. Each of PARAMETERS is (variable type text [:optional]);
optional ones come last. BODY runs with the variables bound to the arguments, NIL for arguments left
out, and SESSION bound to the session. FAMILY, a keyword, says where HELP lists the line command.
SENTENCE is the command's help; DETAILS, strings, are paragraphs below the parameters."
  `(register-line
    (make-line :name ,(string-upcase name) :family ,family :sentence ,sentence
               :details (list ,@details)
               :parameters
               (list ,@(loop for (variable type text optional) in parameters
                             collect `(make-line-parameter ,(string-downcase variable) ',type ,text
                                                           ,(eq optional :optional))))
               :action (lambda (,session &optional ,@(mapcar #'first parameters))
                         (declare (ignorable ,session))
                         ,@body))))

;;; The arguments of a line command, in words.

(defgeneric argument-description (type)
  (:documentation "Return text that says what to type for an argument of TYPE, a symbol."))

(defun line-command-usage (line)
  "Return how to type LINE, such as \"POS x y\"."
  (format nil "~A~{ ~A~}" (line-name line)
          (loop for parameter in (line-parameters line)
                collect (format nil "~:[~A~;[~A]~]" (line-parameter-optional-p parameter)
                                (line-parameter-name parameter)))))

(defun parameter-description (parameter)
  (if (keywordp (line-parameter-type parameter))
      (line-parameter-text parameter)
      (argument-description (line-parameter-type parameter))))

(defun arguments-text (line)
  (format nil "~A~:[ takes no arguments~;~:*: ~{~A is ~A~^, ~}~]." (line-command-usage line)
          (loop for parameter in (line-parameters line)
                collect (line-parameter-name parameter) collect (parameter-description parameter))))

;;; What a plan takes.

(defun plan-parameter-usage (parameter keyword)
  "Return how to type the argument for a plan's PARAMETER after the lambda list KEYWORD (or NIL)."
  (let ((name (if (consp parameter) (first parameter) parameter)))
    (ecase keyword
      ((nil) (format nil "~(~A~)" name))
      (&optional (format nil "[~(~A~)]" name))
      (&key (if (consp name)
                (format nil "[~(~S~)]" (first name))
                (format nil "[:~(~A~)]" name)))
      ((&rest &body) (format nil "[~(~A~)...]" name)))))

(defun plan-parameters-usage (lambda-list)
  (loop with keyword = nil
        for parameter in lambda-list
        until (eq parameter '&aux)
        if (member parameter lambda-list-keywords)
          do (setf keyword parameter)
        else
          collect (plan-parameter-usage parameter keyword)))

(defun plan-usage (plan)
  (format nil "~A~{ ~A~}" (procedure-name plan)
          (plan-parameters-usage (procedure-lambda-list plan))))

;;;; The robot's commands as line commands

;;; For each command of the command layer there is a line command with the same arguments, without
;;; the robot. Manual E lists the exceptions; they take what a camera tracks as the designator.

(defun line-parameter-for (specification)
  (make-line-parameter (string-downcase (spec-name specification)) (spec-type specification)
                       (spec-text specification) nil))

(defun robot-resource-p (command)
  (same-name-p (spec-type (command-resource command)) 'robot))

(defun type-keyword (type) (make-keyword (symbol-name type)))

(defun help-family-of-command (command)
  (let ((type (type-keyword (spec-type (command-resource command)))))
    (case type
      (:robot (case (command-family command)
                (:moving :moving)
                (:thinking :planning)
                (:messages :seeing)
                (t :manipulating)))
      (t type))))

(defun error-details (command)
  (loop for code in (command-errors command)
        for text = (error-code-text code)
        collect (format nil ":~A~@[ -- ~A~]" (symbol-name (error-code-keyword code))
                        (and (stringp text) text))))

(defun command-details (command)
  (append (when (command-results command)
            (list (format nil "Results: ~{~A~^, ~}."
                          (mapcar #'spec-text (command-results command)))))
          (when (command-errors command)
            (list (format nil "Errors: ~{~A~^; ~}." (error-details command))))
          (list (format nil "In Lisp: ~(~A~).~@[ Manual ~A.~]"
                        (command-name command) (command-section command)))))

(defun line-name-of (command)
  "Return the name of COMMAND's line command. As in manual E, -DESIGNATOR is cut to -DESIG."
  (let* ((name (string-upcase (command-prompt-name command)))
         (start (search "-DESIG" name :from-end t)))
    (if start (subseq name 0 (+ start 6)) name)))

(defun line-command-for (command)
  (make-line :name (line-name-of command)
             :full-name (string-upcase (command-name command))
             :family (help-family-of-command command)
             :parameters (append (unless (robot-resource-p command)
                                   (list (line-parameter-for (command-resource command))))
                                 (mapcar #'line-parameter-for (command-parameters command)))
             :sentence (command-documentation command)
             :details (command-details command)
             :action (lambda (session &rest arguments)
                       (if (robot-resource-p command)
                           (issue-job session command (session-robot) arguments)
                           (issue-job session command (first arguments) (rest arguments))))))

(defvar *robot-line-cache* '(() . ())
  "A cons that caches the list of the robot's commands and the list of their line commands.")

(defun robot-line-commands ()
  (let ((commands (all-commands)))
    (unless (equal commands (car *robot-line-cache*))
      (setf *robot-line-cache* (cons commands (mapcar #'line-command-for commands))))
    (cdr *robot-line-cache*)))

;;; Those that differ.

(defun tracked-designator (camera)
  "Return the designator that CAMERA tracks. Signals BAD-LINE if CAMERA tracks nothing."
  (or (camera-tracks camera)
      (reject-line "~A is not tracking anything." camera)))

(defun issue-named-command (session name resource &rest arguments)
  (issue-job session (find-command name) resource arguments))

(define-line "CAM-INSERT-DESIG" (session (cam camera "the camera to insert"))
    (:camera)
    "Insert the camera CAM into the thing whose local designator it tracks."
  (issue-named-command session 'camera-insert cam (tracked-designator cam)))

(define-line "CAM-INSERT-BIN" (session (cam camera "the camera to insert")
                                       (bin storage-bin "the storage bin"))
    (:camera)
    "Insert the camera CAM into the storage bin BIN."
  (issue-named-command session 'camera-insert cam bin))

(define-line "HAND-INSERT-DESIG" (session (hand hand "the hand to insert")
                                          (cam camera "the camera that tracks the thing"))
    (:hand)
    "Insert the hand HAND into the thing whose local designator the camera CAM tracks."
  (issue-named-command session 'hand-insert hand (tracked-designator cam)))

;; As reading 195 says.
(define-line "HAND-GRASP" (session (hand hand "the hand that is to grasp")
                                   (cam camera "the camera that tracks the thing"))
    (:hand)
    "Make the hand HAND grasp the thing that the camera CAM, in the same location, tracks."
  (issue-named-command session 'hand-grasp-desig hand cam (tracked-designator cam)))
