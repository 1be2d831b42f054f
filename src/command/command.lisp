;;;; command.lisp -- what is known of a command.

(in-package :ars-magna.command)

(export '(command error-code *commands* command-shape command-instant-p))

;;; A command is defined once (see define-command.lisp); its COMMAND object is what the prompt, the
;;; journal and the plan language know of it.

(defstruct (parameter-spec (:conc-name spec-) (:constructor make-spec (name type text))
                           (:copier nil))
  "One argument or result of a command."
  (name nil :type symbol :read-only t)
  (type nil :type symbol :read-only t)
  (text "" :type string :read-only t))

(defstruct (error-code (:constructor make-error-code (keyword text)) (:copier nil))
  "One way in which a command fails. TEXT is what the error message says: a string, or a
function of the operation that returns one."
  (keyword nil :type keyword :read-only t)
  (text "" :type (or string function) :read-only t))

(defstruct (command (:copier nil))
  "A command as defined: its name, what it takes and returns, and how it can fail."
  (name nil :type symbol :read-only t)
  (prompt-name "" :type string :read-only t)
  (prefix "" :type string :read-only t)
  ;; What messages call the command's continuations.
  (origin "" :type string :read-only t)
  (family nil :type symbol :read-only t)
  (section nil :type (or null string) :read-only t)
  (documentation "" :type string :read-only t)
  (resource nil :type parameter-spec :read-only t)
  ;; A function of the resource that returns what is occupied instead of it, or NIL.
  (occupies nil :type (or null symbol) :read-only t)
  (parameters '() :type list :read-only t)
  (results '() :type list :read-only t)
  (errors '() :type list :read-only t)
  ;; The names of the results that are arguments, and are told after an interruption, too.
  (echo '() :type list :read-only t)
  (delay nil :type function :read-only t)
  ;; True if it is done in the tick after it was issued, whatever is issued with it.
  (instant-p nil :type boolean :read-only t)
  (report nil :type (or null function) :read-only t)
  ;; True of users' commands: trouble in them is a message.
  (guarded-p nil :type boolean :read-only t)
  (body nil :type function :read-only t))

(addition spec-name spec-type spec-text error-code-keyword error-code-text command-p command-name
          command-prompt-name command-prefix command-family command-section command-documentation
          command-resource command-parameters command-results command-errors)
(document-functions
  spec-name "Return the name of the argument or result, a symbol."
  spec-type "Return the name of the argument's type."
  spec-text "Return what the argument or result is, a sentence."
  error-code-keyword "Return the keyword that the continuation gets."
  error-code-text "Return the text of the message, a string or a function of the operation."
  command-p "True of commands."
  command-name "Return the symbol of the function that issues the command."
  command-prompt-name "Return what the command is called at the prompt, in upper case."
  command-prefix "Return the word that the command's messages begin with."
  command-family "Return :MOVING, :LOOKING, :HANDLING, :MANIPULATING or :THINKING."
  command-section "Return the section of the manual that describes the command, or NIL."
  command-documentation "Return the sentence that says what the command does."
  command-resource "Return the specification of the command's first argument, its resource."
  command-parameters "Return the specifications of its arguments but resource and continuation."
  command-results "Return the specifications of what its continuation gets besides."
  command-instant-p "True if the command is done in the tick after it was issued, whatever is issued
with it."
  command-errors "Return the command's own error codes; any can also end with :INTERRUPT.")

(defmethod reference ((command command))
  (list :command (name-string (command-name command))))

(defmethod print-object ((command command) stream)
  (print-unreadable-object (command stream :type t) (princ (command-name command) stream)))

(defun command-aliases (command)
  "Return what COMMAND is called at the prompt, in a list."
  (list (command-prompt-name command)))

(define-registry command "command" :object-p command-p :fixed t :aliases #'command-aliases)

;; What other definitions in the same file may need, when that is compiled and there is no command
;; yet.
(defun command-shape (name)
  "Return a list of what DEFINE-COMMAND said of the command NAME: its resource (variable type), its
parameters (variable type text) and its sentence. Signals UNKNOWN-NAME."
  (or (get name 'command-shape)
      (find-command name)))

(declaim (inline command-of))
(defun command-of (symbol)
  "Return the command that the function called SYMBOL issues."
  (get symbol 'command))

(defun issuer (command)
  "Return a function that issues COMMAND on a resource, with arguments, and without a continuation."
  (lambda (resource &rest arguments)
    (apply (command-name command) resource (append arguments '(nil)))))

(defun register-command (command)
  "Let there be COMMAND, for those who ask by name, and for journals."
  (let ((name (command-name command)))
    (setf (get name 'command) command)
    (register *commands* name command)
    (mapc #'note-error-code (mapcar #'error-code-keyword (command-errors command)))
    (define-operator name
        (cons (spec-type (command-resource command))
              (mapcar #'spec-type (command-parameters command)))
      (issuer command))
    name))
