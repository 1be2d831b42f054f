;;;; run-variables.lisp -- DEFINE-RUN-VARIABLE: variables with a separate value in each run.

(in-package :ars-magna.run)

(export '(initialize-run-variables all-run-variables find-run-variable run-variable
          values-expected-text stored-run-variable update-run-variable check-run-variable-value
          copied-value world-of-current-run))

;;; A run variable is a symbol macro, not a special variable: any thread reads the value of its
;;; current run. The values are a slot of the run's world, so forks, rewinds and saved runs have
;;; their own. Values are plain data, which no code modifies, or things and robots. Code within
;;; ticks sets a run variable directly; everything else sets it by a request that the journal
;;; records.
;;;
;;; An entry is a list (name value use). USE is :SET once the run has set the variable, :READ if the
;;; run has only read it, and NIL before. Only variables that were set are in the digest, so that
;;; definitions for other runs do not change it.

(define-record (variable-definition (:constructor make-variable-definition (name function)))
  "The definition of a run variable."
  (name nil symbol "the name of the run variable" :export)
  (function nil function "the function that returns the initial value"))

(define-registry run-variable "run variable" :object-p variable-definition-p :by-symbol t
  :internal t)

;; The symbol has the definition, so that reading a variable is fast.
(defmethod undo-definition ((definition variable-definition))
  (let ((name (variable-definition-name definition)))
    (remprop name 'run-variable)
    (remove-symbol-macro name)))

(defmethod redo-definition ((definition variable-definition))
  (let ((name (variable-definition-name definition)))
    (unless (eq definition (get name 'run-variable))
      (setf (get name 'run-variable) definition))
    (unless (run-variable-name-p name) (set-symbol-macro name `(run-variable ',name)))))

(defun definition-of-variable (name)
  ;; A value of the symbol would not be the value in any run.
  (when (boundp name)
    (reject-use "~A has a value outside of runs, which SET, SYMBOL-VALUE or code compiled before ~
                 its DEFINE-RUN-VARIABLE has set. Evaluate (makunbound '~(~A~)), use SETF of the ~
                 run variable, and compile such code again."
                name name))
  (or (get name 'run-variable)
      (reject-name "run variable" name (names-to-suggest *run-variables*))))

;;; Values.

(defun object-of-world-p (object world)
  "True if OBJECT is a thing or robot that is or was in WORLD."
  (typecase object
    (thing (eq world (thing-world object)))
    (robot (eq world (robot-world object)))))

(defun run-variable-value-p (value world)
  (plain-datum-p value (lambda (object) (object-of-world-p object world))))

(defun values-expected-text (value)
  "Return a text about what a run variable or measure can have instead of VALUE."
  (format nil "plain data (numbers, symbols, characters, strings, lists, simple vectors), or ~
               things and robots of the current run: ~A"
          (typecase value
            ((or thing robot) "(counterpart OBJECT) returns the object of the current run")
            (hash-table "a list of lists (key value) can replace a table")
            (function "a symbol can name a function")
            (t (plain-data-limits-text)))))

(defun check-run-variable-value (operator name value
                                 &optional (world (world-of-current-run name)))
  "Signal WRONG-ARGUMENT, about the argument NAME of OPERATOR, unless a run variable can have VALUE
in WORLD."
  (unless (run-variable-value-p value world)
    ;; The run keeps errors of kickers, and would keep a long list in each.
    (reject-argument operator name (abridged value) (values-expected-text value))))

(defun copied-value (value)
  "Return VALUE, valid as a value, or a copy if it is a list, vector or string, which users may
modify."
  (declare #.*hot*)
  (typecase value
    (cons (loop for element in value
                collect (if (typep element '(or cons vector)) (copied-value element) element)))
    (simple-vector (cl:map 'simple-vector #'copied-value value))
    (string (copy-seq value))
    (t value)))

;;; Initial values. They belong to the run, but are not in digests.

(defvar *run-variables-lock* (make-lock "run variables"))

(defvar *variables-being-initialized* '()
  "The names of the run variables whose initial values this thread computes.")

(defun dice-for-initial-value (name world)
  "Return the random state for the initial value of NAME, which depends on the seed of WORLD."
  (seeded-random-state (dice-state (make-dice (world-seed world) (qualified-name name)))))

(defun reject-init-form (name condition)
  "Signal MISUSE: the init form of the run variable NAME has signalled CONDITION."
  (reject-use "The init form of the run variable ~(~A~) failed: ~A~:[~; Correct the form and ~
               define the variable again, or set it before it is read.~]"
              name (add-full-stop (one-line-text condition))
              ;; Else CONDITION is about the init form of another variable, and says so.
              (eq name (first *variables-being-initialized*))))

(defun value-of-init-form (name world)
  (let ((function (variable-definition-function (definition-of-variable name)))
        (*variables-being-initialized* (cons name *variables-being-initialized*))
        (*asker* (list "the init form of " name)))
    (with-seclusion ("It cannot command robots, start plans or change things, since init forms are ~
                      evaluated before the robots of the run may act.")
      (with-random-state ((dice-for-initial-value name world))
        (handler-bind ((error (lambda (condition) (reject-init-form name condition))))
          (funcall function))))))

(defun initial-value (name world)
  "Return the value of the init form of the run variable NAME in the run of WORLD."
  (when (member name *variables-being-initialized*)
    (reject-use "It uses ~(~A~), which has no value yet" name))
  (let ((value (value-of-init-form name world)))
    (check-run-variable-value 'define-run-variable name value world)
    (copied-value value)))

(declaim (inline find-variable-entry))
(defun find-variable-entry (name world)
  (assoc name (the list (world-run-variables world)) :test #'eq))

(defun add-variable-entry (name value use world)
  "Add the run variable NAME to WORLD, unless it is there already. Return its entry."
  (with-lock (*run-variables-lock*)
    (or (find-variable-entry name world)
        (first (push (list name value use) (world-run-variables world))))))

(defun initialize-run-variables (simulation)
  "Compute the initial values of the run variables in SIMULATION, the current run, which begins. An
error in an init form is signalled when the variable is first used, since many runs do not use it."
  (let* ((world (simulation-world simulation)) (noted (world-noted-names world)))
    (dolist (name (defined-names *run-variables*))
      (unless (find-variable-entry name world)
        (handler-case (add-variable-entry name (initial-value name world) nil world)
          (error ()))))
    ;; What an init form looks for in vain is no hint for messages of this run.
    (setf (world-noted-names world) noted)))

;;; Reading and setting.

(defun world-of-current-run (name)
  "Return the world of the current run. Signals MISUSE, about the run variable NAME, without a run."
  (if *simulation*
      (simulation-world *simulation*)
      (reject-use "The run variable ~(~A~) has a value only in a run. ~A" name
                  (or (other-thread-run-text)
                      "Use it in (with-simulation (ROBOT) ...), or after (simulator ROBOT)."))))

(defun stored-run-variable (name)
  "Return the value of the run variable NAME in the current run, which the caller must not modify."
  (let ((world (world-of-current-run name)))
    (definition-of-variable name)
    (let ((entry (or (find-variable-entry name world)
                     (add-variable-entry name (initial-value name world) :read world))))
      ;; Another thread may be setting the variable.
      (unless (third entry) (swap-if-eq (car (cddr entry)) nil :read))
      (second entry))))

(defun run-variable (name)
  "Return the value of the run variable NAME in the current run."
  (copied-value (stored-run-variable name)))

(defun move-variable-entry-to-front (entry world)
  "Move ENTRY to the front of the run variables of WORLD, so that it is found fast."
  (with-lock (*run-variables-lock*)
    (setf (world-run-variables world) (cons entry (remove entry (world-run-variables world))))))

;; Many variables are defined. A run sets few of them, but often.
(defun store-run-variable (name value world)
  (let ((entry (or (find-variable-entry name world)
                   ;; Another thread may read the variable and so add its entry first.
                   (add-variable-entry name value :set world))))
    (unless (eq :set (third entry)) (move-variable-entry-to-front entry world))
    (setf (second entry) value
          (third entry) :set)))

(defun set-run-variable (name value)
  "Set the run variable NAME to VALUE in the current run. Return VALUE."
  (let ((world (world-of-current-run name)))
    (definition-of-variable name)
    (check-not-over world 'setf)
    (check-run-variable-value 'setf name value world)
    (let ((kept (copied-value value)))
      (changing (world set-run-variable name kept)
        (store-run-variable name kept world)))
    value))

(define-operator 'set-run-variable '(name datum) #'set-run-variable)

;; So a small change of a long list costs and records little: nothing old is checked or copied.
(defun update-run-variable (name function operator &rest arguments)
  "Set the run variable NAME in the current run to the first value of FUNCTION, which is called with
the stored value while no other thread changes the run. FUNCTION must not modify that value. What it
adds is valid and is never modified. The journal records a call of OPERATOR with ARGUMENTS, which
does the same. Return the second value of FUNCTION."
  (let ((world (world-of-current-run name)))
    (check-not-over world operator)
    (flet ((update ()
             (multiple-value-bind (value result) (funcall function (stored-run-variable name))
               (store-run-variable name value world)
               result)))
      (if (changing-thread-p world)
          (update)
          (change-world (world-timeline world) world #'update operator arguments)))))

(defun (setf run-variable) (value name)
  (set-run-variable name value))

;;; Defining.

(defun run-variable-name-p (name)
  "True if the symbol NAME is the symbol macro of a run variable."
  (and (eq :symbol-macro (variable-kind name))
       (equal `(run-variable ',name) (macroexpand-1 name))))

(defun check-run-variable-name (name)
  (let ((title (definition-title "define-run-variable" name)))
    (cond ((or (not (symbolp name)) (null name) (keywordp name) (null (symbol-package name)))
           (reject-clause title name "a symbol as the name of a run variable"))
          ((run-variable-name-p name))
          ((not (variable-name-p name))
           (reject-clause title name
                          (format nil "a name that is free; ~A ~A" name
                                  (variable-name-trouble name))))
          ((and (boundp name) (not (eq :special (variable-kind name))))
           (reject-clause title name
                          (format nil "a name without a value. Code that was compiled before has ~
                                       set ~(~A~): evaluate (makunbound '~:*~(~A~)), then this ~
                                       definition, and compile that code again"
                                  name)))
          ((eq :special (variable-kind name))
           (reject-clause title name
                          (format nil "a name that is no variable yet. ~(~A~) is a special ~
                                       variable, as DEFVAR makes: remove the DEFVAR, then restart ~
                                       Lisp or evaluate (unintern '~:*~(~A~)), and load your files"
                                  name))))))

(defun install-run-variable (name function documentation)
  "Define the run variable NAME, whose init form is the body of FUNCTION. Return NAME."
  (let ((definition (make-variable-definition name function)))
    (register *run-variables* name definition)
    (redo-definition definition)
    (setf (documentation name 'variable) documentation)
    name))

(addition define-run-variable)
(define-user-macro define-run-variable (&whole form name init &optional documentation
                                        &environment environment)
  "Define NAME as a variable with a separate value in each run: each WITH-SIMULATION, SIMULATOR,
fork and trial has its own, also after REWIND, in saved runs and in replays. SETF, INCF and PUSH set
it; code sees at once what it has set. Values are plain data, or things and robots of the run; in a
fork these are the counterparts.
- INIT is evaluated when a run begins; for a variable defined later, when the run first uses it.
  RANDOM in INIT depends on the run's seed. INIT must not change the run.
- The journal records what plans, continuations and other programs set. Kickers, events and
  manipulations set the variable within ticks, which a replay repeats.
- Reading a list, vector or string returns a copy. Set the variable to change its value.
- LET of NAME makes an ordinary local variable.
- A new definition does not change the value in runs that have begun.
Using NAME without a run signals MISUSE, setting it to another object WRONG-ARGUMENT. Signals
MALFORMED-DEFINITION if NAME is another variable."
  (expand-definition
   form environment
   (lambda ()
     (check-run-variable-name name)
     (unless (typep documentation '(or null string))
       (reject-clause (definition-title "define-run-variable" name) documentation
                      "(define-run-variable name init [string])"))
     (values `((install-run-variable ',name (lambda () ,init) ,documentation))
             `((eval-when (:compile-toplevel :load-toplevel :execute)
                 (define-symbol-macro ,name (run-variable ',name))))))))
