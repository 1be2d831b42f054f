;;;; session.lisp -- one run of the prompt: what it reads, shows and asks, and its state.

(in-package :ars-magna.cli)

(export '(session make-session session-robot session-errors session-input session-quiet-p
          session-recording session-plotter
          *prompt-robot*))

(defstruct (break-request (:constructor make-break-request
                              (condition restarts thread sessions &optional robot))
                          (:copier nil))
  "A break of a program, which waits in THREAD until the user of one of SESSIONS says how to
continue. CALL is the function that THREAD is to call next. ROBOT is a text for the robot of the
plan that has broken, if the run has several robots; else NIL."
  (condition nil :type condition :read-only t)
  (restarts '() :type list :read-only t)
  (thread nil :read-only t)
  (sessions '() :type list)
  (robot nil :type (or null string) :read-only t)
  (call nil :type (or null function))
  ;; The ways to continue have been shown.
  (told-p nil :type boolean)
  (posted (make-semaphore "call posted") :read-only t)
  (done (make-semaphore "call done") :read-only t))

(defun restarts-within-line (condition)
  "Return the restarts for CONDITION, from the innermost to the restart that ends the line. Of
restarts with the same name, include only the innermost."
  (let* ((all (remove nil (compute-restarts condition) :key #'restart-name))
         (last (position 'end-line all :key #'restart-name)))
    (remove-duplicates (subseq all 0 (and last (1+ last))) :test #'string=
                       :key #'restart-name :from-end t)))

(defun restart-rank (restart condition)
  "Return a number for RESTART: the lower the number, the more likely the user wants RESTART."
  (let ((first-names (if (typep condition 'serious-condition)
                         '("ABORT" "RETRY" "STOP-SIMULATOR")
                         '("ANSWER" "CONTINUE"))))
    (or (position (restart-name restart) first-names :test #'string=) (length first-names))))

(defparameter *restarts-with-value*
  '("USE-VALUE" "STORE-VALUE" "RETURN-VALUE" "CALL-FORM" "REPLACE-FUNCTION" "SPECIFY-PACKAGE"
    "USE-PACKAGE" "RENAME" "ANSWER")
  "The names of restarts that ask the user for a value.")

(defun restart-needs-value-p (restart)
  (member (restart-name restart) *restarts-with-value* :test #'string=))

(defun restarts-to-offer (condition)
  "Return the restarts for CONDITION that a user can choose, the most likely first."
  (stable-sort (restarts-within-line condition)
               #'< :key (lambda (restart) (restart-rank restart condition))))

(defun own-thread-break-p (break-request)
  (eq (break-request-thread break-request) (current-thread)))

(defun robot-text-of-calling-plan ()
  "Return a text for the robot of the plan that runs in this thread, if the run has several robots;
else NIL."
  (let ((task (calling-task)))
    (and task (robot-text *simulation* (robot-name-of-client (task-client task))))))

(defun break-condition-text (break-request)
  "Return the text of the condition of BREAK-REQUEST, after the robot of the plan if the run has
several robots. It is one line, except for the stack of a plan that has stopped."
  (let* ((condition (break-request-condition break-request)) (text (condition-text condition)))
    (format nil "~@[~A: ~]~A" (break-request-robot break-request)
            (if (plan-break-p condition)
                (escape-controls text)
                (short-error-text text)))))

(defstruct (break-state (:copier nil))
  "The breaks that wait for the user of the prompt in THREAD. OWN is the break in THREAD itself, or
NIL. OTHERS are the breaks in other threads, the oldest first."
  (thread nil)
  (own nil :type (or null break-request))
  (others '() :type list))

;;;; Sessions

(defstruct (reader (:copier nil))
  "The source of a session's lines."
  (input *standard-input* :type stream :read-only t)
  ;; Files to load, and lines to do, before any is read.
  (files '() :type list)
  (lines '() :type list)
  ;; The package in which they are first read; NIL for the users' own.
  (package nil :type (or null package) :read-only t)
  ;; No prompt is shown.
  (batch-p nil :type boolean :read-only t)
  ;; Lines that are read are shown, for transcripts.
  (echo-p nil :type boolean :read-only t)
  ;; The first line that is an error is the last.
  (stop-p nil :type boolean :read-only t)
  ;; A typed line has been read.
  (typed-p nil :type boolean)
  ;; Input has ended without QUIT.
  (ended-p nil :type boolean))

(defvar *prompt-robot* nil
  "The name of the robot that the prompt commands: the robot last given to SIMULATOR or chosen.")

(add-listener *simulator-hooks* record-prompt-robot)

(defun record-prompt-robot (robot options)
  (declare (ignore options))
  (setf *prompt-robot* (robot-name robot))
  (import-robot-names (mapcar #'robot-name (simulation-robots (robot-simulation robot)))))

(defstruct (session (:include listener) (:constructor %make-session) (:copier nil))
  "A running prompt: it runs the lines of READER, and shows their messages."
  (reader (make-reader) :type reader :read-only t)
  (break-state (make-break-state) :type break-state :read-only t)
  ;; Each command completes before the next is read.
  (patient-p nil :type boolean :read-only t)
  ;; A function to call before each line is read, outside of trials and forks, or NIL: it makes sure
  ;; that the right robot is commanded, as a window does for its own.
  (place nil :type (or null function) :read-only t)
  ;; The run in which it last commanded the robot *PROMPT-ROBOT*, or NIL.
  (commanded-run nil)
  ;; The run that it was in when it last read a line; see CALL-BEFORE-LINE-HOOKS.
  (whereabouts nil)
  ;; The trial that it is in, or NIL, and how many nested forks it is in.
  (trial nil)
  ;; While it is in a fork of a trial, that trial. The programs in it never end.
  (forked-trial nil)
  (forks 0 :type fixnum)
  ;; The names of the plans that it has started; those of a rewound run are its own, too.
  (plans '() :type list)
  ;; The failure of the last plan, if it failed, and the plan's name, in a list.
  (failure nil)
  ;; What has been issued and may not have ended, and whether Lisp may have issued more.
  (jobs '() :type list)
  (lisp-p nil)
  ;; The film that it records, and what it plots; or NIL.
  (recording nil)
  (plotter nil)
  ;; After a rewind of a run with awaited plans: the function to call first, with this session.
  (after-rewind nil :type (or null function))
  (over-p nil)
  ;; The robot to continue with, in batch mode, when this one's lines are over.
  (next-robot nil))

(defmethod print-object ((session session) stream)
  (print-unreadable-object (session stream :type t)))

(setf (documentation 'session-errors 'function)
      "Return the number of errors so far: invalid lines, failed plans, and error messages, except
error messages of a plan that continues."
      (documentation 'session-recording 'function)
      "Return the film that the session records, or NIL."
      (documentation 'session-plotter 'function)
      "Return what the session plots, or NIL if nothing was ever plotted."
      (documentation 'session-quiet-p 'function)
      "True if messages from commands of plans and programs are hidden. Can be set.")

(defun session-input (session)
  "Return the stream from which SESSION reads lines."
  (reader-input (session-reader session)))

(defun session-batch-p (session) (reader-batch-p (session-reader session)))

(defun make-session (&key (input *standard-input*) (output *standard-output*) batch
                       (patient batch) echo files lines account stop (color :auto)
                       place package)
  "Return a session that loads FILES, runs the lines in the list LINES, then reads lines from INPUT,
and writes to OUTPUT. With BATCH, the session shows no prompt. If PATIENT, by default in a batch,
each command completes before the next line is read. With ECHO, lines are shown as they are read.
ACCOUNT, if any, records the running line. With STOP, the session ends at the first error in a line.
PLACE, if any, is a function to call before each line. Lines are read in PACKAGE, by default
ARS-USER. COLOR is :ALWAYS, :NEVER, or :AUTO (on a terminal, unless the environment has NO_COLOR)."
  (let ((console (make-console output)))
    (setf (console-colored-p console) (color-wanted-p color (console-stream console)))
    (%make-session :console console :terminal-p (typed-by-hand-p input)
                   :patient-p (and patient t) :account account :place place
                   :reader (make-reader :input input :files files :lines lines :package package
                                        :batch-p (and batch t) :echo-p (and echo t)
                                        :stop-p (and stop t)))))

(defun session-thread (session)
  (break-state-thread (session-break-state session)))

(defun session-other-breaks (session)
  "Return the breaks in other threads that wait for SESSION, the oldest first."
  (break-state-others (session-break-state session)))

(defun breaks-for-session (session)
  "Return the breaks that wait for SESSION. The user is asked about the first break."
  (let ((own (break-state-own (session-break-state session)))
        (others (session-other-breaks session)))
    (cond ((null own) others)
          ((break-request-told-p own) (cons own others))
          (t (append others (list own))))))

(defun check-run-not-over ()
  (when (and *simulation* (simulation-over *simulation*))
    (let ((name (simulation-name *simulation*)))
      (reject-line "The run in ~(~A~) is over: ~A. ~:[WORLD shows where you can go~;~
                    WORLD ~:*~(~A~) starts it again~]."
                   name (simulation-over *simulation*)
                   (and (find-map name nil) name)))))

(defun robot-of-prompt ()
  "Return the robot of the current simulation with the name *PROMPT-ROBOT*, or NIL. A simulation
that Lisp at the prompt runs may have no such robot."
  (find *prompt-robot* (simulation-robots *simulation*) :key #'robot-name))

(defvar *departed-robot* nil
  "The name of the robot that has left the run before the line that is running, or NIL.")

(defun check-robot-not-departed ()
  "Signal BAD-LINE if the robot that the prompt commands has left the run before this line."
  (when (and *departed-robot* (eq *departed-robot* *prompt-robot*))
    (reject-line "~A is no longer in this run, and this line is for no other robot. Choose with ~
                  ROBOT, or type the line again to command ~A."
                 *departed-robot* (first (simulation-robots *simulation*)))))

(defun commanded-robot-or-reject ()
  "Return the robot that plans of the prompt drive by default, or NIL. Signals BAD-LINE."
  (check-robot-not-departed)
  (robot-of-prompt))

(defun session-robot ()
  "Return the robot that the prompt commands. Signals BAD-LINE without a robot, after the run, and
if the robot has left the run before this line."
  (check-run-not-over)
  (check-robot-not-departed)
  (let ((robots (and *simulation* (simulation-robots *simulation*))))
    (or (and robots (robot-of-prompt))
        (first robots)
        (reject-line "There is no robot here. WORLD lists worlds; WORLD name starts a world."))))

(defun world-of-prompt ()
  "Return the world of the current run. Signals BAD-LINE without a robot or after the run."
  (let ((*departed-robot* nil)) (robot-world (session-robot))))

(defun size-of-window (session)
  (funcall (or (console-window (session-console session)) #'window-size)))

(defun can-poll-input-p (session)
  "True if SESSION has a user at a terminal or window, and can check for typed input."
  (and (session-terminal-p session)
       (typep (source-stream (session-input session)) '(or descriptor-stream queued-octets))))

(defun display-wanted-p (session)
  "True if a robot that starts for SESSION gets a window. If windows fail, only DISPLAY says so."
  (and (session-terminal-p session) *display-opener* t))
