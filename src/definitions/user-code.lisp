;;;; user-code.lisp -- calling users' functions, and on whose behalf: the run goes on.

(in-package :ars-magna.definitions)

(export '(*asker* asker-note asker-forked-p *goes-on-in-forks-p* goes-on-in-forks-p note-of-asker
          note-text call-user-code *user-error-hooks* note-waiting report-break continue-inside
          user-calls make-user-calls *user-calls* as-users-code abort-user-code
          *spoilt-by-leaving-p* brief-text text-of-origin recurring-code recurring-remedy
          report-user-error))

;;; Who drives a robot from several sides wants to know whose command is under way. So whoever
;;; calls on others' behalf binds *ASKER*: CALL-USER-CODE to what it calls, plans to the task at
;;; work, the prompt to itself; and what is asked for keeps a note of it.

(defvar *asker* nil
  "Who asks for what is asked for here: an origin as CALL-USER-CODE takes it, or what has a method
of ASKER-NOTE; NIL for a program of its own, or somebody at a REPL.")

(defgeneric asker-note (asker)
  (:documentation "Return what is to be kept of ASKER: a string, or a list of items as OUT prints
them. It does not change, whatever becomes of ASKER.")
  (:method (asker) (princ-to-string asker))
  (:method ((asker string)) asker)
  (:method ((asker cons)) (mapcar (lambda (item) (if (atom item) (asker-note item) item)) asker))
  (:method ((asker symbol)) asker)
  (:method ((asker null)) (list "Lisp (" (thread-name (current-thread)) ")")))

(defgeneric asker-forked-p (asker)
  (:documentation "True if ASKER goes on in forks of the run too, such as a plan, and so is told of
the ends of its commands there.")
  (:method (asker) (declare (ignore asker)) nil))

(defvar *goes-on-in-forks-p* nil
  "True where something acts that goes on in forks of the run too, whoever the asker is.")

(defun goes-on-in-forks-p ()
  "True if what is asked for here and now is asked for in forks of the run as well, by themselves."
  (or *goes-on-in-forks-p* (asker-forked-p *asker*)))

(defun note-of-asker ()
  "Return a note of who asks here and now."
  (asker-note *asker*))

(defun note-text (note)
  "Return NOTE, as NOTE-OF-ASKER returns it, as a string."
  (with-output-to-string (stream) (write-items (ensure-list note) stream)))

;;;; Calls

;;; Continuations, kickers, tests and whatever else users give to the simulator is called here. A
;;; call may end in four ways besides returning. It may signal an error, or be aborted: then it has
;;; ended, and a message says so. It may be left, as by THROW or because its thread is to end; then
;;; its callers are left too, and see to it that the tick is finished first (IN-ANY-CASE). And it
;;; may not end at all: who watches is told where the thread is (USER-CALLS) and can have the call
;;; aborted from outside (ABORT-USER-CODE).

(addition *break-on-user-error*)
(defvar *break-on-user-error* nil
  "When true, an error in user code (a continuation, kicker, manipulation, test or graphics
body) enters the debugger where it happens, if somebody is there to answer it: at a terminal, or in
an editor. Its restarts are: report it and leave that code, try it again, and stop the simulator if
that runs live; they name whose code it is. When NIL, the default, or without a terminal, the error
is queued as an error message that names its origin, and the run goes on.")

;;; What users' code a thread is in.

(define-record (user-calls (:constructor make-user-calls (&optional stop)))
  "What users' code a thread calls. STOP is a function that ends what the thread does."
  (origin nil t "whose code the thread is in, an item or a list of items, or NIL" :writable :export)
  (count 0 fixnum "how many calls of users' code the thread has begun" :writable :export)
  (waiting-p nil t "the last of them waits for an answer in a debugger" :writable :export)
  (place nil (or null function) "a function that says where the form is that the thread loads of a
file, or NIL if it loads none. Can be set" :writable :export)
  (stop nil (or null function) "a function that ends what the thread does, or NIL"))

(defvar *user-calls* nil
  "The USER-CALLS of this thread, or NIL if nobody watches them.")

(defun call-as-users-code (function origin)
  "Call FUNCTION, of which ORIGIN says whose code it is, so that whoever watches sees that. It can
be interrupted."
  (declare (type function function))
  (let ((calls *user-calls*))
    (if calls
        (let ((outer (user-calls-origin calls)))
          (incf (user-calls-count calls))
          (setf (user-calls-origin calls) origin
                (user-calls-waiting-p calls) nil)
          (unwind-protect (call-opening (held-off-p) function)
            (setf (user-calls-origin calls) outer)))
        (call-opening (held-off-p) function))))

(defmacro as-users-code ((origin) &body body)
  "Run BODY as CALL-AS-USERS-CODE would a function."
  (form-calling 'call-as-users-code body origin))

(defun note-waiting ()
  "Let whoever watches know that users' code waits for an answer in a debugger."
  (when *user-calls* (setf (user-calls-waiting-p *user-calls*) t)))

(defun abort-user-code (count)
  "Abort the users' code that this thread is in, if that is still the call numbered COUNT."
  (let ((calls *user-calls*))
    (when (and calls (user-calls-origin calls) (= count (user-calls-count calls)))
      (abort))))

;;; Reporting.

(defun brief-text (condition)
  "Return what CONDITION reports, on one line and of bounded length."
  (cut (one-line (text-of-condition condition)) 2000))

(defun text-of-origin (origin)
  "Return ORIGIN, an item or list of items, as one text."
  (format nil "~{~A~}" (ensure-list origin)))

(define-event *user-error-hooks*
  "Functions that are called with the text of each error in users' code that is reported.")

(defun report-user-error (condition origin)
  "Queue an error message, and call the hooks, as CONDITION came up in ORIGIN, an item or list of
items. A program that goes on asking when its run is over is no trouble."
  (let ((text (format nil "Error in ~A: ~A" (text-of-origin origin) (brief-text condition)))
        (stuff (list* "Error in " (append (ensure-list origin)
                                          (list ": " (brief-text condition))))))
    (tell-listeners *user-error-hooks* text)
    (if (typep condition 'outlived)
        (apply #'error-set stuff)
        (apply #'trouble-set condition text stuff))))

(defun report-break (condition origin)
  "Queue a message that CONDITION, which is no error, came up in ORIGIN."
  (apply #'message-set "Break in "
         (append (ensure-list origin) (list ": " (brief-text condition)))))

;;; Code that runs by itself, as a kicker does, may fail again and again.

(defgeneric recurring-code (item)
  (:documentation "Return the user's function that runs again and again without being asked for, if
that is where trouble came up, by ITEM of the message about it; else NIL.")
  (:method (item)
    (declare (ignore item))
    nil))

(defgeneric recurring-remedy (item)
  (:documentation "Return in words, as a sentence, how trouble in the RECURRING-CODE of ITEM can be
ended."))

;;; Calling.

(document-restarts
 'abort "Report the error as a message and leave your code, or end the plan or the trial that it is
part of. The run goes on."
 'retry "Do again what went wrong: after you have mended your code, it goes on as if nothing had
happened."
 'continue "Go on as if nothing had been wrong."
 'stop-simulator "Report the error, leave your code and stop the live simulator.")

(define-constant +leave+ "Report it and leave " :test #'string=
  :documentation "How what the restart ABORT of a call of users' code says begins.")

(defun stoppable-p (condition)
  "True if what this thread does can be stopped, whatever CONDITION has come up."
  (declare (ignore condition))
  (and *user-calls* (user-calls-stop *user-calls*) t))

(defvar *spoilt-by-leaving-p* (constantly nil)
  "A function that is true where what is under way, such as a plan, would end if it were left: so
who has called it cannot try it again.")

(defun call-offering (function origin go-on again &aux (around *spoilt-by-leaving-p*))
  "Call FUNCTION, whose code ORIGIN says, with restarts: ABORT, which calls GO-ON; RETRY, which
calls AGAIN, unless that would spoil what is under way in it; and if this thread can be stopped
STOP-SIMULATOR."
  (declare (type function function go-on again))
  (flet ((retriable-p (condition)
           (declare (ignore condition))
           (let ((inside *spoilt-by-leaving-p*))
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
                                          :test-function #'stoppable-p))
      (funcall function))))

(defmacro offering ((origin go-on again) &body body)
  "Run BODY as CALL-OFFERING would a function."
  (form-calling 'call-offering body origin go-on again))

(defun our-abort-p (restart)
  (and (eq 'abort (restart-name restart))
       (starts-with-subseq +leave+ (princ-to-string restart))))

(defun continue-inside (condition)
  "Continue after CONDITION, if what offers that has been called by users' code, not around it."
  (let ((restart (find-if (lambda (restart)
                            (or (our-abort-p restart) (eq 'continue (restart-name restart))))
                          (compute-restarts condition))))
    (when (and restart (eq 'continue (restart-name restart)))
      (invoke-restart restart))))

(defun call-user-code (function origin &rest arguments)
  "Call FUNCTION with ARGUMENTS and return its values. Should it signal an error or be aborted,
queue an error message saying that it came from ORIGIN (an item or list of items) and return NIL."
  (declare (dynamic-extent arguments))
  (prog (trouble (queue *message-queue*))
   again
     (setf trouble nil)
     (block call
       (flet ((go-on ()
                ;; What was called may have gone on into another run, with a queue of its own.
                (let ((*message-queue* queue))
                  (cond ((null trouble)
                         (apply #'error-set (append (ensure-list origin) '(" was aborted"))))
                        ((typep trouble 'storage-condition))
                        (t (report-user-error trouble origin))))
                (return-from call))
              (again () (go again)))
         (declare (dynamic-extent #'go-on #'again))
         (flet ((note (condition)
                  (let-callers-handle condition)
                  (setf trouble condition)
                  (when *break-on-user-error* (invoke-debugger condition))
                  (go-on))
                (answer (condition somebody-p)
                  (cond (somebody-p (note-waiting))
                        (t (if (typep condition 'serious-condition)
                               (setf trouble condition)
                               (report-break condition origin))
                           (unless trouble (continue-inside condition))
                           (go-on)))))
           (declare (dynamic-extent #'note #'answer))
           (return
             (offering (origin #'go-on #'again)
               (handler-bind (((or error storage-condition time-limit) #'note))
                 (answering-debugger (#'answer)
                   (as-users-code (origin)
                     (with-users-dice
                       (let ((*asker* origin))
                         (apply function arguments)))))))))))
     ;; There is room to say so only now.
     (when (typep trouble 'storage-condition)
       (regain-room trouble)
       (report-user-error trouble origin))))
