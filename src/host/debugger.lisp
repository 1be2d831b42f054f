;;;; debugger.lisp -- whether anybody is there to answer a debugger or a front end.

(in-package :ars-magna.host)

(export '(*report-addition* *front-end* serve-while-waiting hook-of-front-end ask-how-to-go-on
          input-of-programs debugger-p foreign-hook debugger-hook common-debugger-hook
          *editor-gone-p* with-debugger-hook *answerer* calls-under-way disabled-hook-p
          take-foreground yield-foreground))

;;; A debugger of Lisp's or of an editor writes a report as PRINC does.

(defvar *report-addition* (constantly nil)
  "A function of an error of Lisp's own that returns a sentence to stand behind its report, or
NIL.")

(defun write-addition (condition stream)
  (unless *print-escape*
    (format stream "~@[~&~A~]" (ignore-errors (funcall *report-addition* condition)))))

(macrolet ((define-additions (&rest types)
             `(progn ,@(loop for type in types
                             collect `(defmethod print-object :after ((condition ,type) stream)
                                        (write-addition condition stream))))))
  (define-additions undefined-function unbound-variable reader-error type-error))

;;;; How a person is asked, where a program such as the prompt can ask one

(defvar *front-end* nil "The front end that can ask people, an object; NIL if there is none.")

(defgeneric serve-while-waiting (front-end)
  (:documentation "Do what FRONT-END has to do in this thread, which waits for another.
Called now and then.")
  (:method (front-end) (declare (ignore front-end))))

(defgeneric hook-of-front-end (front-end)
  (:documentation "Return the debugger's hook of FRONT-END, or NIL, for where an editor's has
nobody to ask.")
  (:method (front-end) (declare (ignore front-end))))

(defgeneric ask-how-to-go-on (front-end condition)
  (:documentation "Let a person choose how to go on after CONDITION, where whoever had been asked
has gone. Return if FRONT-END can ask nobody.")
  (:method (front-end condition) (declare (ignore front-end condition))))

(defgeneric input-of-programs (front-end stream)
  (:documentation "Return the stream that users' code in a run's threads reads instead of STREAM.")
  (:method (front-end stream) (declare (ignore front-end)) stream))

;;;; Debuggers

;; A hook of ours, around which there may be others of ours, says nothing of who is there.
(defvar *answerer* nil
  "The hook that CALL-ANSWERING-DEBUGGER has set last, consed to the one that somebody else had set
before; or NIL.")

;; What an editor's server has set stays when the editor has gone.
(defvar *editor-gone-p* (constantly nil)
  "A function: true if the hook that Common Lisp has for debuggers is that of an editor's server, to
which no editor is connected.")

(defun stale-p (hook)
  "True if HOOK is somebody else's, an editor's that has gone."
  (and (functionp hook)
       (not (eq hook (first *answerer*)))
       (funcall *editor-gone-p*)))

(defun foreign-hook ()
  "Return the debugger's hook, or, if that is ours, the one that somebody else had set before."
  (let ((hook (debugger-hook)))
    (if (and hook (eq hook (first *answerer*)))
        (rest *answerer*)
        hook)))

(defun debugger-p (&optional (hook (foreign-hook)))
  "True if a debugger that is entered has somebody to talk to: a terminal, or the program, such as
an editor, that has set HOOK or *DEBUGGER-HOOK*."
  (cond ((and *debugger-hook* (not (funcall *editor-gone-p*))) t)
        (hook (not (disabled-hook-p hook)))
        (t (and (interactive-stream-p *standard-input*) (interactive-stream-p *debug-io*)))))

(defun debugger-hook ()
  "Return the function that is called instead of Lisp's debugger, with a condition and itself, in
whatever thread that has not bound one; or NIL. Can be set. By the name DEBUGGER-DISABLED-HOOK one
says that there is nobody to talk to."
  (let ((hook sb-ext:*invoke-debugger-hook*))
    (if (stale-p hook) (hook-of-front-end *front-end*) hook)))

(defun (setf debugger-hook) (function)
  (setf sb-ext:*invoke-debugger-hook* function))

(defun common-debugger-hook ()
  "Return the hook of all threads that have not bound one, or NIL. Can be set."
  (global-value 'sb-ext:*invoke-debugger-hook*))

(defun (setf common-debugger-hook) (function)
  (setf (global-value 'sb-ext:*invoke-debugger-hook*) function))

(defmacro with-debugger-hook ((function) &body body)
  "Run BODY, in which this thread's debugger hook is FUNCTION. A hook that is called has none but
for that."
  `(let ((sb-ext:*invoke-debugger-hook* ,function)) ,@body))

;;; The calls under way, and the terminal that threads share with the debugger.

(defun calls-under-way (&optional (limit 100))
  "Return a list of the calls under way, the newest first and at most LIMIT of them, each as
\(function argument...) as far as the compiler has kept that."
  (internal (:sb-debug #:list-backtrace) :count limit))

(defun disabled-hook-p (hook)
  "True if HOOK is the one by which SBCL has no debugger, as in scripts."
  (and (symbolp hook) (string= hook "DEBUGGER-DISABLED-HOOK")))

(defun take-foreground ()
  "Wait until this thread has the terminal, as one that enters the debugger does."
  (internal (:sb-thread #:get-foreground)))

(defun yield-foreground ()
  "If another thread wants to enter Lisp's own debugger, for which this one, which waits, would have
to leave it the terminal, do so, until it has left the debugger."
  (let ((threads (internal (:sb-thread #:interactive-threads))))
    (when (and (eq (first threads) sb-thread:*current-thread*) (rest threads))
      (sb-thread:release-foreground)
      (take-foreground))))
