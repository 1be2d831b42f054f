;;;; user-code.lisp -- calling users' functions safely; recording who asks for a command.

(in-package :ars-magna.definitions)

(export '(*asker* asker-note asker-forked-p *continues-in-forks-p* continues-in-forks-p
          current-asker-note asker-note-text call-user-code *user-error-hooks* note-debugger-waiting
          report-break continue-in-user-code user-calls make-user-calls *user-calls* as-users-code
          abort-user-code *leaving-ends-work-p* brief-condition-text text-of-origin
          recurring-function
          stop-recurring-remedy report-user-error))

;;; Several parties may drive a robot, so users want to know whose command is in progress. Code that
;;; acts for others binds *ASKER*: CALL-USER-CODE to what it calls, plans to the current task, the
;;; prompt to itself. Requests keep a note of it.

(defvar *asker* nil
  "The origin of requests that this thread makes now: an origin as for CALL-USER-CODE, or an object
with a method of ASKER-NOTE; NIL for a program or a REPL.")

(defgeneric asker-note (asker)
  (:documentation "Return the note by which messages name ASKER, the origin of a request: a string,
or a list of items as OUT prints them. The note must not change when ASKER changes.")
  (:method (asker) (princ-to-string asker))
  (:method ((asker string)) asker)
  (:method ((asker cons)) (mapcar (lambda (item) (if (atom item) (asker-note item) item)) asker))
  (:method ((asker symbol)) asker)
  (:method ((asker null)) (list "Lisp (" (thread-name (current-thread)) ")")))

(defgeneric asker-forked-p (asker)
  (:documentation "True if ASKER, the origin of a request, continues in forks of the run, as a plan
does. In a fork, the copy of ASKER is notified when its commands end.")
  (:method (asker) (declare (ignore asker)) nil))

(defvar *continues-in-forks-p* nil
  "True while this thread runs code that continues in forks of the run, regardless of *ASKER*.")

(defun continues-in-forks-p ()
  "True if this thread now makes requests that forks of the run repeat by themselves."
  (or *continues-in-forks-p* (asker-forked-p *asker*)))

(defun current-asker-note ()
  "Return the note by which messages name *ASKER*, the origin of requests."
  (asker-note *asker*))

(defun asker-note-text (note)
  "Return NOTE, a value of CURRENT-ASKER-NOTE, as a string."
  (with-output-to-string (stream) (write-items (ensure-list note) stream)))

;;;; Calls

;;; Continuations, kickers, tests and other functions of users are called here. A call can end in
;;; four ways besides returning. It may signal an error or be aborted: then it is over, and a
;;; message says so. It may exit non-locally, as by THROW or because its thread must end: its
;;; callers exit too, and finish the tick first (IN-ANY-CASE). Or it may never end: a watcher sees
;;; where the thread is (USER-CALLS) and can abort the call from outside (ABORT-USER-CODE).

(addition *break-on-user-error*)
(defvar *break-on-user-error* nil
  "When true, an error in user code (a continuation, kicker, manipulation, test or graphics body)
enters the debugger where the error happens, if there is an interactive debugger, at a terminal or
in an editor. Its restarts name the code. They report the error and leave the code, try it again,
or stop a live simulator. When NIL, the default, or without a terminal, the error is queued as
an error message that names its origin, and the run goes on.")

;;; The users' code that a thread is in.

(define-record (user-calls (:constructor make-user-calls (&optional stop)))
  "The calls of users' code by a thread, for a watcher. STOP, a function, ends the thread's work."
  (origin nil t "the origin of the users' code: an item, a list of items, or NIL" :writable :export)
  (count 0 fixnum "the number of calls of users' code that the thread has begun" :writable :export)
  (waiting-p nil t "the latest call of users' code waits in a debugger" :writable :export)
  (place nil (or null function) "a function that returns the file and line of the form that the
thread is loading, or NIL. Can be set" :writable :export)
  (stop nil (or null function) "a function that ends the thread's work, or NIL"))

(defvar *user-calls* nil
  "The USER-CALLS of this thread, or NIL if the thread is not watched.")

(defun call-as-users-code (function origin)
  "Call FUNCTION, interruptible users' code that ORIGIN names, and record the call for the watcher."
  (declare (type function function))
  (let ((calls *user-calls*))
    (if calls
        (let ((outer (user-calls-origin calls)))
          (incf (user-calls-count calls))
          (setf (user-calls-origin calls) origin
                (user-calls-waiting-p calls) nil)
          (unwind-protect (call-allowing-interrupts-if (interrupts-deferred-p) function)
            (setf (user-calls-origin calls) outer)))
        (call-allowing-interrupts-if (interrupts-deferred-p) function))))

(defmacro as-users-code ((origin) &body body)
  "Run BODY, users' code that ORIGIN names, as CALL-AS-USERS-CODE calls a function."
  (form-calling 'call-as-users-code body origin))

(defun note-debugger-waiting ()
  "Record for the watcher that users' code waits for an answer in a debugger."
  (when *user-calls* (setf (user-calls-waiting-p *user-calls*) t)))

(defun abort-user-code (count)
  "Abort the users' code that this thread is in, if its call still has the number COUNT."
  (let ((calls *user-calls*))
    (when (and calls (user-calls-origin calls) (= count (user-calls-count calls)))
      (abort))))

;;; Reporting.

(defun brief-condition-text (condition)
  "Return the report of CONDITION, on one line of at most 2000 characters."
  (cut (one-line (text-of-condition condition)) 2000))

(defun text-of-origin (origin)
  "Return ORIGIN, an item or list of items, as one text."
  (format nil "~{~A~}" (ensure-list origin)))

(define-event *user-error-hooks*
  "Functions that are called with the text of each error in users' code that is reported.")

(defun report-user-error (condition origin)
  "Queue an error message, and call the hooks, for CONDITION in ORIGIN, an item or list of items.
For a RUN-IS-OVER-ERROR, a request of a finished run, queue only a message, not a USER-CODE-ERROR."
  (let* ((error-text (brief-condition-text condition))
         (text (format nil "Error in ~A: ~A" (text-of-origin origin) error-text))
         (stuff `("Error in " ,@(ensure-list origin) ": " ,error-text)))
    (call-listeners *user-error-hooks* text)
    (if (typep condition 'run-is-over-error)
        (apply #'error-set stuff)
        (apply #'queue-user-error condition text stuff))))

(defun report-break (condition origin)
  "Queue a message that CONDITION, which is no error, was signalled in ORIGIN."
  (apply #'message-set "Break in "
         (append (ensure-list origin) (list ": " (brief-condition-text condition)))))

;;; Code that runs by itself, such as a kicker, may fail again and again.

(defgeneric recurring-function (item)
  (:documentation "If ITEM, an item of an error message, names a user's function that runs again and
again by itself, such as a kicker, return that function; else NIL.")
  (:method (item)
    (declare (ignore item))
    nil))

(defgeneric stop-recurring-remedy (item)
  (:documentation "Return a sentence on how to stop ITEM's RECURRING-FUNCTION."))

;;; Calling.

(document-restarts
 'abort "Report the error as a message; leave your code, or end its plan or trial. The run goes on."
 'retry "Do again what failed, after you have corrected your code, as if nothing had happened."
 'continue "Continue as if nothing had been wrong."
 'stop-simulator "Report the error, leave your code and stop the live simulator.")

(define-constant +leave+ "Report it and leave " :test #'string=
  :documentation "The beginning of the report of the restart ABORT in users' code.")

(defun thread-stoppable-p (condition)
  "True if the work of this thread can be stopped, regardless of CONDITION."
  (declare (ignore condition))
  (and *user-calls* (user-calls-stop *user-calls*) t))

(defvar *leaving-ends-work-p* (constantly nil)
  "A function that returns true if leaving the current code would end the work in progress, such as
a plan. The caller then cannot retry the code.")

(defun call-with-user-code-restarts (function origin go-on again
                                     &aux (around *leaving-ends-work-p*))
  "Call FUNCTION, users' code that ORIGIN names, with restarts: ABORT calls GO-ON; RETRY, if
possible, calls AGAIN; STOP-SIMULATOR, if possible, stops the work of this thread."
  (declare (type function function go-on again))
  (flet ((retriable-p (condition)
           (declare (ignore condition))
           (let ((inside *leaving-ends-work-p*))
             (or (eq inside around) (not (funcall (the function inside))))))
         (stop ()
           (funcall (the function (user-calls-stop *user-calls*)))
           (funcall go-on))
         (offer-abort (stream)
           (format stream "~A~A." +leave+ (text-of-origin origin)))
         (offer-retry (stream)
           (format stream "Try ~A again." (text-of-origin origin)))
         (offer-stop (stream)
           (write-string "Report it and stop the simulator." stream)))
    (declare (dynamic-extent #'retriable-p #'stop #'offer-abort #'offer-retry))
    (restart-bind ((abort go-on :report-function #'offer-abort)
                   (retry again :report-function #'offer-retry :test-function #'retriable-p)
                   (stop-simulator #'stop :report-function #'offer-stop
                                          :test-function #'thread-stoppable-p))
      (funcall function))))

(defmacro with-user-code-restarts ((origin go-on again) &body body)
  (form-calling 'call-with-user-code-restarts body origin go-on again))

(defun simulator-abort-p (restart)
  (and (eq 'abort (restart-name restart))
       (starts-with-subseq +leave+ (princ-to-string restart))))

(defun continue-in-user-code (condition)
  "Invoke the restart CONTINUE of CONDITION, if users' code has established it."
  (let ((restart (find-if (lambda (restart)
                            (or (simulator-abort-p restart) (eq 'continue (restart-name restart))))
                          (compute-restarts condition))))
    (when (and restart (eq 'continue (restart-name restart)))
      (invoke-restart restart))))

(defun call-user-code (function origin &rest arguments)
  "Call FUNCTION with ARGUMENTS and return its values. If FUNCTION signals an error or is aborted,
queue an error message that names ORIGIN (an item or list of items), and return NIL."
  (declare (dynamic-extent arguments))
  (prog (trouble (queue *message-queue*))
   again
     (setf trouble nil)
     (block call
       (flet ((go-on ()
                ;; The callee may have continued in another run, with its own queue.
                (let ((*message-queue* queue))
                  (cond ((null trouble)
                         (apply #'error-set (append (ensure-list origin) '(" was aborted"))))
                        ((typep trouble 'storage-condition))
                        (t (report-user-error trouble origin))))
                (return-from call))
              (again () (go again)))
         (declare (dynamic-extent #'go-on #'again))
         (flet ((note (condition)
                  (signal-to-callers-first condition)
                  (setf trouble condition)
                  (when *break-on-user-error* (invoke-debugger condition))
                  (go-on))
                (answer (condition somebody-p)
                  (cond (somebody-p (note-debugger-waiting))
                        (t (if (typep condition 'serious-condition)
                               (setf trouble condition)
                               (report-break condition origin))
                           (unless trouble (continue-in-user-code condition))
                           (go-on)))))
           (declare (dynamic-extent #'note #'answer))
           (return
             (with-user-code-restarts (origin #'go-on #'again)
               (handler-bind (((or error storage-condition time-limit) #'note))
                 (answering-debugger (#'answer)
                   (as-users-code (origin)
                     (with-users-random-state
                       (let ((*asker* origin))
                         (apply function arguments)))))))))))
     ;; Only now is there room to report it.
     (when (typep trouble 'storage-condition)
       (recover-memory trouble)
       (report-user-error trouble origin))))
