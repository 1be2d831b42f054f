;;;; assignments.lisp -- noting that plans and continuations set users' global variables.

(in-package :ars-magna.definitions)

(export '(*assignment-hooks* note-assignment noting-assignments users-global-p))

;;; All runs share the global variables of programs, so a plan or continuation that sets one in a
;;; fork disturbs the original. The layer of runs warns of that. Plans are compiled from their text,
;;; with a call of NOTE-ASSIGNMENT at each assignment. The text of a continuation is Lisp's: a
;;; continuation compares the values, before and after, of the variables that its text assigns.
;;; Assignments in functions that plans and continuations call are not seen.

(define-event *assignment-hooks*
  "Functions called with a symbol, a user's special variable, when a plan or continuation has set
its global value.")

(defun users-global-p (name environment)
  "True if the symbol NAME is a special variable in ENVIRONMENT, and not Lisp's or the simulator's."
  (and (symbolp name)
       (special-variable-p name environment)
       (users-symbol-p name)))

(defun note-assignment (name)
  "Call the hooks because a plan or continuation sets the special variable NAME, unless this thread
has bound NAME: then only the binding is set."
  (unless (bound-in-thread-p name)
    (call-listeners *assignment-hooks* name)))

;;; Continuations.

(defparameter *assigning-operators*
  '("SETQ" "SETF" "PSETQ" "PSETF" "INCF" "DECF" "PUSH" "PUSHNEW" "POP" "MULTIPLE-VALUE-SETQ")
  "The names of operators that assign variables.")

(defun places-assigned (call)
  "Return the places that CALL, a call of one of *ASSIGNING-OPERATORS*, assigns."
  (destructuring-bind (operator &rest arguments) call
    (cond ((string= operator "MULTIPLE-VALUE-SETQ") (ensure-list (first arguments)))
          ((member operator '("PUSH" "PUSHNEW") :test #'string=) (list (second arguments)))
          ((member operator '("INCF" "DECF" "POP") :test #'string=) (list (first arguments)))
          (t (loop for (place) on arguments by #'cddr collect place)))))

(defun globals-assigned (forms environment)
  "Return a list of users' special variables that the text FORMS assigns."
  (let ((found '()))
    (map-calls (lambda (call)
                 (when (apply #'lisp-call-p call *assigning-operators*)
                   (dolist (place (places-assigned call))
                     (when (users-global-p place environment) (pushnew place found)))))
               forms)
    (nreverse found)))

(defun values-now (names)
  (loop for name in names
        collect (if (boundp name) (symbol-value name) '%unbound)))

(defmacro noting-assignments (() &body body &environment environment)
  "Run BODY, the forms of a continuation. If it has changed users' special variables that its text
assigns, call NOTE-ASSIGNMENT for each. Return the values of BODY."
  (let ((names (globals-assigned body environment)))
    (if (null names)
        `(progn ,@body)
        (with-gensyms (before)
          `(let ((,before (values-now ',names)))
             (multiple-value-prog1 (progn ,@body)
               (note-changes ',names ,before)))))))

(defun note-changes (names before)
  (loop for name in names
        for old in before
        for new in (values-now names)
        unless (eq old new) do (note-assignment name)))
