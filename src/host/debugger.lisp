;;;; debugger.lisp -- debuggers and front ends that can ask a person, and their hooks.

(in-package :ars-magna.host)

(export '(*report-addition* *front-end* serve-while-waiting hook-of-front-end ask-user-for-restart
          program-input debugger-available-p foreign-hook debugger-hook global-debugger-hook
          *editor-gone-p* with-debugger-hook *answering-hook* calls-in-progress disabled-hook-p
          take-foreground yield-foreground))

;;; A debugger of Lisp or an editor writes a report as PRINC does.

(defvar *report-addition* (constantly nil)
  "A function that returns a sentence to append to the report of an error of Lisp's own, or NIL.")

(defun write-report-addition (condition stream)
  (unless *print-escape*
    (format stream "~@[~&~A~]" (ignore-errors (funcall *report-addition* condition)))))

(macrolet ((define-additions (&rest types)
             `(progn ,@(loop for type in types
                             collect `(defmethod print-object :after ((condition ,type) stream)
                                        (write-report-addition condition stream))))))
  (define-additions undefined-function unbound-variable reader-error type-error simple-error))

;;;; The front end, such as the prompt, that can ask a person

(defvar *front-end* nil "The front end, such as the prompt, that can ask the user; or NIL.")

(defgeneric serve-while-waiting (front-end)
  (:documentation "Do the pending work of FRONT-END. A thread that waits for another thread calls
this function repeatedly.")
  (:method (front-end) (declare (ignore front-end))))

(defgeneric hook-of-front-end (front-end)
  (:documentation "Return FRONT-END's debugger hook, for use after an editor disconnects, or NIL.")
  (:method (front-end) (declare (ignore front-end))))

(defgeneric ask-user-for-restart (front-end condition)
  (:documentation "Let the user choose a restart for CONDITION, because the debugger of an editor
has disconnected. Return only if FRONT-END cannot ask the user.")
  (:method (front-end condition) (declare (ignore front-end condition))))

(defgeneric program-input (front-end stream)
  (:documentation "Return the stream that users' code in a run's thread reads instead of STREAM.")
  (:method (front-end stream) (declare (ignore front-end)) stream))

;;;; Debuggers

;; One of our own hooks, perhaps around others of ours, does not show that a person is present.
(defvar *answering-hook* nil
  "NIL or a pair (hook . foreign-hook): the debugger hook that CALL-ANSWERING-DEBUGGER has set last,
and the hook that another program had set before.")

;; The hook of an editor's server stays set when the editor disconnects.
(defvar *editor-gone-p* (constantly nil)
  "A function that returns true if the debugger hook belongs to a disconnected editor's server.")

(defun disconnected-hook-p (hook)
  "True if HOOK is not the simulator's, and belongs to an editor that has disconnected."
  (and (functionp hook)
       (not (eq hook (first *answering-hook*)))
       (funcall *editor-gone-p*)))

(defun foreign-hook ()
  "Return the debugger hook. If the simulator has set it, return the hook that was set before."
  (let ((hook (debugger-hook)))
    (if (and hook (eq hook (first *answering-hook*)))
        (rest *answering-hook*)
        hook)))

(defun debugger-available-p (&optional (hook (foreign-hook)))
  "True if an interactive debugger is available: there is a terminal, or a program such as an editor
has set HOOK or *DEBUGGER-HOOK*."
  (cond ((and *debugger-hook* (not (funcall *editor-gone-p*))) t)
        (hook (not (disabled-hook-p hook)))
        (t (and (interactive-stream-p *standard-input*) (interactive-stream-p *debug-io*)))))

(defun debugger-hook ()
  "Return the function that is called in place of Lisp's debugger, in threads that bind no other; or
NIL. The arguments of the function are a condition and the function itself. Can be set. The name
DEBUGGER-DISABLED-HOOK means that there is no debugger."
  (let ((hook sb-ext:*invoke-debugger-hook*))
    (if (disconnected-hook-p hook) (hook-of-front-end *front-end*) hook)))

(defun (setf debugger-hook) (function)
  (setf sb-ext:*invoke-debugger-hook* function))

(defun global-debugger-hook ()
  "Return the debugger hook of all threads that do not bind another, or NIL. Can be set."
  (global-value 'sb-ext:*invoke-debugger-hook*))

(defun (setf global-debugger-hook) (function)
  (setf (global-value 'sb-ext:*invoke-debugger-hook*) function))

(defmacro with-debugger-hook ((function) &body body)
  "Run BODY with FUNCTION as this thread's debugger hook. While a hook runs, its thread has no
debugger hook, unless the hook uses this macro."
  `(let ((sb-ext:*invoke-debugger-hook* ,function)) ,@body))

;;; The call stack, and the terminal that threads share with the debugger.

(defun calls-in-progress (&optional (limit 100))
  "Return a list of at most LIMIT calls in progress, the newest first. A call is a list (function
argument...), as far as the compiler has kept the arguments."
  (internal (:sb-debug #:list-backtrace) :count limit))

(defun disabled-hook-p (hook)
  "True if HOOK is the debugger hook by which SBCL disables its debugger, for example in scripts."
  (and (symbolp hook) (string= hook "DEBUGGER-DISABLED-HOOK")))

(defun take-foreground ()
  "Wait until this thread has the terminal, as if it entered the debugger."
  (internal (:sb-thread #:get-foreground)))

(defun yield-foreground ()
  "If another thread waits to enter Lisp's debugger, let it have the terminal. Return when that
thread has left the debugger."
  (let ((threads (internal (:sb-thread #:interactive-threads))))
    (when (and (eq (first threads) sb-thread:*current-thread*) (rest threads))
      (sb-thread:release-foreground)
      (take-foreground))))
