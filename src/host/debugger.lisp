;;;; debugger.lisp -- debuggers and front ends that can ask a person, and their hooks.

(in-package :ars-magna.host)

(export '(*report-addition* *front-end* serve-while-waiting hook-of-front-end ask-how-to-go-on
          input-of-programs debugger-p foreign-hook debugger-hook global-debugger-hook
          *editor-gone-p* with-debugger-hook *answerer* calls-under-way disabled-hook-p
          take-foreground yield-foreground))

;;; A debugger of Lisp or an editor writes a report as PRINC does.

(defvar *report-addition* (constantly nil)
  "A function of an error of Lisp's own that returns a sentence to append to its report, or NIL.")

(defun write-addition (condition stream)
  (unless *print-escape*
    (format stream "~@[~&~A~]" (ignore-errors (funcall *report-addition* condition)))))

(macrolet ((define-additions (&rest types)
             `(progn ,@(loop for type in types
                             collect `(defmethod print-object :after ((condition ,type) stream)
                                        (write-addition condition stream))))))
  (define-additions undefined-function unbound-variable reader-error type-error))

;;;; The front end, such as the prompt, that can ask a person

(defvar *front-end* nil "The front end that can ask people, an object; NIL if there is none.")

(defgeneric serve-while-waiting (front-end)
  (:documentation "Do the pending work of FRONT-END in this thread, which waits for another. Called
now and then.")
  (:method (front-end) (declare (ignore front-end))))

(defgeneric hook-of-front-end (front-end)
  (:documentation "Return the debugger hook of FRONT-END, or NIL, for use after an editor has
disconnected.")
  (:method (front-end) (declare (ignore front-end))))

(defgeneric ask-how-to-go-on (front-end condition)
  (:documentation "Let the user choose a restart for CONDITION, after another debugger has gone.
Return if FRONT-END cannot ask.")
  (:method (front-end condition) (declare (ignore front-end condition))))

(defgeneric input-of-programs (front-end stream)
  (:documentation "Return the stream that users' code in a run's threads reads instead of STREAM.")
  (:method (front-end stream) (declare (ignore front-end)) stream))

;;;; Debuggers

;; One of our own hooks, perhaps around others of ours, does not show that a person is present.
(defvar *answerer* nil
  "The hook set last by CALL-ANSWERING-DEBUGGER, consed to the foreign hook before it; or NIL.")

;; The hook of an editor's server stays set when the editor disconnects.
(defvar *editor-gone-p* (constantly nil)
  "A function: true if the global debugger hook is that of an editor's server without an editor.")

(defun stale-p (hook)
  "True if HOOK is foreign and belongs to an editor that has disconnected."
  (and (functionp hook)
       (not (eq hook (first *answerer*)))
       (funcall *editor-gone-p*)))

(defun foreign-hook ()
  "Return the debugger hook, or, if that is ours, the foreign one that was set before."
  (let ((hook (debugger-hook)))
    (if (and hook (eq hook (first *answerer*)))
        (rest *answerer*)
        hook)))

(defun debugger-p (&optional (hook (foreign-hook)))
  "True if an interactive debugger is available: there is a terminal, or a program such as an editor
has set HOOK or *DEBUGGER-HOOK*."
  (cond ((and *debugger-hook* (not (funcall *editor-gone-p*))) t)
        (hook (not (disabled-hook-p hook)))
        (t (and (interactive-stream-p *standard-input*) (interactive-stream-p *debug-io*)))))

(defun debugger-hook ()
  "Return the function that replaces Lisp's debugger in threads without a binding, called with a
condition and itself; or NIL. Can be set. The name DEBUGGER-DISABLED-HOOK means that there is no
debugger."
  (let ((hook sb-ext:*invoke-debugger-hook*))
    (if (stale-p hook) (hook-of-front-end *front-end*) hook)))

(defun (setf debugger-hook) (function)
  (setf sb-ext:*invoke-debugger-hook* function))

(defun global-debugger-hook ()
  "Return the global debugger hook, for threads without a binding, or NIL. Can be set."
  (global-value 'sb-ext:*invoke-debugger-hook*))

(defun (setf global-debugger-hook) (function)
  (setf (global-value 'sb-ext:*invoke-debugger-hook*) function))

(defmacro with-debugger-hook ((function) &body body)
  "Run BODY with FUNCTION as this thread's debugger hook. A running hook has none
unless it uses this."
  `(let ((sb-ext:*invoke-debugger-hook* ,function)) ,@body))

;;; The call stack, and the terminal that threads share with the debugger.

(defun calls-under-way (&optional (limit 100))
  "Return a list of at most LIMIT calls in progress, the newest first, each as (function
argument...) as far as the compiler has kept that."
  (internal (:sb-debug #:list-backtrace) :count limit))

(defun disabled-hook-p (hook)
  "True if HOOK is the one that disables SBCL's debugger, as in scripts."
  (and (symbolp hook) (string= hook "DEBUGGER-DISABLED-HOOK")))

(defun take-foreground ()
  "Wait until this thread has the terminal, as a thread that enters the debugger does."
  (internal (:sb-thread #:get-foreground)))

(defun yield-foreground ()
  "Yield the terminal if another thread waits to enter Lisp's debugger. Return when that has left
it."
  (let ((threads (internal (:sb-thread #:interactive-threads))))
    (when (and (eq (first threads) sb-thread:*current-thread*) (rest threads))
      (sb-thread:release-foreground)
      (take-foreground))))
