;;;; command.lisp -- data about a command, and the steps that continue it.

(in-package :ars-magna.command)

(export '(command error-code *commands* command-signature trait-p))

;;; A command is defined once (see define-command.lisp). Its COMMAND object has the data for the
;;; prompt, the journal and the plan language.

(define-record (parameter-spec (:conc-name spec-) (:constructor make-spec (name type text)))
  "One argument or result of a command."
  (name nil symbol "the name of the argument or result, a symbol" :addition)
  (type nil symbol "the name of the argument's type" :addition)
  (text "" string "what the argument or result is, a sentence" :addition))

(define-record (error-code (:constructor make-error-code (keyword text &rest explanation)))
  "One way in which a command fails."
  (keyword nil keyword "the keyword that the continuation gets" :addition)
  (text "" (or string function)
        "the text of the message, a string or a function of the operation" :addition)
  (explanation '() list "strings: the meaning and what to try; () if in *ERROR-CODE-EXPLANATIONS*"))

(addition command-p)
(define-record command
  "A command as defined: its name, its arguments and results, and how it can fail."
  (name nil symbol "the symbol of the function that issues the command" :addition)
  (prompt-name "" string "the name of the command at the prompt, in upper case" :addition)
  (prefix "" string "the word that the command's messages begin with" :addition)
  (origin "" string "the name for the command's continuations in messages")
  (family nil symbol ":MOVING, :LOOKING, :HANDLING, :MANIPULATING, :THINKING
or :MESSAGES" :addition)
  (section nil (or null string)
           "the section of the manual that describes the command, or NIL" :addition)
  (documentation "" string "the sentence that says what the command does" :addition)
  (resource nil parameter-spec
            "the specification of the command's first argument, its resource" :addition)
  (occupies nil (or null symbol)
            "a function that maps the resource to what the command occupies instead, or NIL")
  (checker nil (or null symbol)
           "a function that checks the arguments further and returns those to keep, or NIL")
  (parameters '() list
              "the argument specifications, without resource and continuation" :addition)
  (results '() list "the specifications of the further arguments of the continuation" :addition)
  (errors '() list "the command's own error codes; any can also end with :INTERRUPT" :addition)
  (expected '() list
            "keywords: the command's error codes that do not count as failures" :export)
  (traits '() list "the traits of the command, keywords of *COMMAND-TRAITS*")
  (echo '() list
        "the names of the results that the continuation also gets after an interruption")
  (delay nil function)
  (instant-p nil boolean "the command has no delay: it is done in the tick after it was issued, even
if another command follows" :export)
  (report nil (or null function))
  (fitting '() list "the lambda list of the last continuation that fitted the command" :writable)
  (guarded-p nil boolean "a user has defined the command: errors in its code become messages")
  (body nil function))

(defmethod reference ((command command))
  (list :command (name-string (command-name command))))

(defmethod print-object ((command command) stream)
  (print-unreadable-object (command stream :type t) (princ (command-name command) stream)))

(defparameter *command-traits* '(:drives :turns :stops :asks :begins)
  "The keywords for :TRAITS in DEFINE-COMMAND.")

(defun trait-p (trait command)
  "True if COMMAND has TRAIT, one of *COMMAND-TRAITS*."
  (and (member trait (command-traits command)) t))

(define-registry command "command" :object-p command-p :fixed t
  :aliases (lambda (command) (list (command-prompt-name command))))

;; For other definitions in the same file, when that is compiled and the command does not exist.
(defun command-signature (name)
  "Return three parts of the definition of the command NAME, as a list: its resource (variable
type), a list of its parameters (variable type text), and its sentence. Signals UNKNOWN-NAME."
  (or (get name 'command-signature)
      (find-command name)))

(declaim (inline command-of))
(defun command-of (symbol)
  (get symbol 'command))

(defun register-command (command)
  (let ((name (command-name command)))
    (setf (get name 'command) command)
    (register *commands* name command)
    (mapc #'note-error-code (mapcar #'error-code-keyword (command-errors command)))
    (define-operator name
        (cons (spec-type (command-resource command))
              (mapcar #'spec-type (command-parameters command)))
      (lambda (resource &rest arguments)
        (apply name resource (append arguments '(nil)))))
    name))

;;; An operation names the function that continues it, its step. A saved file may name steps, but no
;;; other function. Our own steps trust their arguments, so DEFINE-STEP states what these must be.
;;; Users' commands pass their own steps to GO-ON; CALL-USERS-STEP calls them.

(defun register-step (step fits-p)
  "Make the function STEP a step of all operations for which the predicate FITS-P is true. If FITS-P
is :GUARDED, make STEP a step of all users' commands."
  (setf (get step 'step) fits-p)
  step)

(defmacro define-step (name (operation needs) documentation &body body)
  "Define the function NAME, a step of OPERATION that runs BODY. BODY relies on the form NEEDS, such
as (robot-p (operation-resource operation)). An operation from a file is refused if NEEDS is false."
  `(progn
     (register-step ',name (lambda (,operation) (declare (ignorable ,operation)) ,needs))
     (defun ,name (,operation) ,documentation ,@body)))

(defun check-step (step)
  "Return STEP, an argument of GO-ON. A step of the simulator without DEFINE-STEP is an error."
  (cond ((get step 'step) step)
        (*loading-simulator-p* (error "~S is not defined by DEFINE-STEP" step))
        (t (register-step step :guarded))))

(defun step-p (name)
  (and (get name 'step) (fboundp name) t))

(defun check-step-in-form (form)
  "Return FORM, whose second argument is a step. A quoted step is checked at load time."
  (destructuring-bind (function operation step &rest more) form
    (if (typep step '(cons (eql quote) (cons (and symbol (not null)) null)))
        `(,function ,operation (load-time-value (check-step ,step)) ,@more)
        form)))

(define-compiler-macro go-on (&whole form &rest arguments)
  (if (and (eq 'go-on (first form)) (rest arguments)) (check-step-in-form form) form))

(define-compiler-macro go-on-now (&whole form &rest arguments)
  (if (and (eq 'go-on-now (first form)) (rest arguments)) (check-step-in-form form) form))

;;; Facts about commands.

(defun specification-text (specification)
  (format nil "~(~A~)~@[, ~A~]" (spec-name specification)
          (and (string/= "" (spec-text specification)) (spec-text specification))))

(defun specifications-text (specifications)
  (and specifications (format nil "~{~A~^; ~}" (mapcar #'specification-text specifications))))

(define-facts (command command)
  "What it does" (command-documentation command)
  "Given to" (specification-text (command-resource command))
  "Arguments" (specifications-text (command-parameters command))
  "Results for its continuation, after an error code or NIL"
  (specifications-text (cons (command-resource command) (command-results command)))
  "Error codes" (format nil "~{~S~^, ~}" (append (mapcar #'error-code-keyword
                                                         (command-errors command))
                                                 '(:interrupt)))
  "At the prompt" (command-prompt-name command)
  "Manual" (command-section command))

(defmethod function-of-command ((name symbol))
  (let ((command (find-command name nil)))
    (and command
         (not (same-name-p name (command-name command)))
         (command-name command))))
