;;;; session.lisp -- one run of the prompt: where it reads and writes, and what it shows when.

(in-package :ars-magna.cli)

;;; Messages come as they please (manual E). A plain message continues the line of the prompt; a
;;; warning or an error starts a fresh one; then the prompt is shown again. What a tick has to say
;;; is shown together, when the tick is over.

(defvar *prompt-robot* nil
  "The name of the robot that the prompt commands: the one last given to SIMULATOR, or chosen.")

(pushnew 'note-robot *simulator-hooks*)

(defun note-robot (robot options)
  (declare (ignore options))
  (setf *prompt-robot* (robot-name robot))
  (call-by-name (mapcar #'robot-name (simulation-robots (robot-simulation robot)))))

(defstruct (session (:constructor %make-session) (:copier nil))
  "A prompt at work."
  (input *standard-input* :type stream :read-only t)
  (console (make-console *standard-output*) :type console :read-only t)
  ;; No prompt is shown.
  (batch-p nil :type boolean :read-only t)
  ;; Each command completes before the next is read.
  (patient-p nil :type boolean :read-only t)
  ;; What is read is shown, for transcripts.
  (echo-p nil :type boolean :read-only t)
  ;; What comes of the commands that plans and programs give is not shown.
  (quiet-p nil :type boolean)
  ;; The tallies of errors, by their text, as in repetition.lisp: any thread tells, so the lock
  ;; guards them.
  (told (make-hash-table :test 'equal) :type hash-table :read-only t)
  (flood (make-flood) :type flood :read-only t)
  (lock (make-lock "session") :read-only t)
  ;; The simulation whose messages are shown as they arrive, and its observer if it is live.
  (simulation nil)
  (observer nil)
  ;; True if there are messages that somebody will show soon.
  (news-p nil)
  (errors 0 :type fixnum)
  ;; A line has been read of what is typed.
  (typed-p nil :type boolean)
  ;; Files to load, and lines to do, before any is read.
  (files '() :type list)
  (lines '() :type list)
  ;; The run that it was in when it read a line last; see TELL-WHEREABOUTS.
  (whereabouts nil)
  ;; The name of the robot that it commanded then.
  (robot-name nil :type symbol)
  ;; The thread that reads, and what has entered the debugger in others, oldest first.
  (thread nil)
  (breaks '() :type list)
  ;; What has entered the debugger in its own thread, while it reads lines for that.
  (debugging nil)
  ;; That of the last plan, if it failed, and the plan's name, in a list.
  (failure nil)
  ;; What the plans are called that it has started; those of a rewound run are its own, too.
  (plans '() :type list)
  ;; What has been issued and may not have ended, and whether Lisp may have issued more.
  (errands '() :type list)
  (lisp-p nil)
  ;; If the run of plans that it waits for was rewound: what to call first, with this session.
  (after-rewind nil :type (or null function))
  (over-p nil)
  ;; It is to be over though its user has not left it: what he was to answer, others are asked.
  (abandoned-p nil :type boolean)
  ;; It is over because nothing more is typed: nobody has said QUIT.
  (ended-p nil :type boolean)
  ;; The trial that the prompt is in, or NIL.
  (visit nil)
  ;; The first line that is an error is the last.
  (stop-p nil :type boolean :read-only t)
  ;; Where it is in what it reads, if somebody wants to know; see reporting.lisp.
  (account nil :type (or null account) :read-only t)
  ;; In how many forks it is, one in another.
  (forks 0 :type fixnum)
  ;; The robot to go on with, in batch mode, when this one's lines are over.
  (next-robot nil)
  ;; In which package lines are read at first; NIL for the users' own.
  (package nil :type (or null package) :read-only t)
  ;; A function that is called before each line is read, outside of trials and forks: it sees to it
  ;; that the right robot is commanded, as a window does for its own; or NIL.
  (place nil :type (or null function) :read-only t))

(defmethod print-object ((session session) stream)
  (print-unreadable-object (session stream :type t)))

(setf (documentation 'session-errors 'function)
      "Return how many errors there were so far: lines that made no sense, plans that failed, and
error messages, but not those of a plan that goes on."
      (documentation 'session-quiet-p 'function)
      "True if what comes of the commands that plans and programs give is not shown. Can be set."
      (documentation 'session-input 'function) "Return the stream that lines are read from.")

(defun make-session (&key (input *standard-input*) (output *standard-output*) batch
                       (patient batch) echo files lines account stop (color :auto)
                       place package)
  "Return a session that loads FILES, does the list LINES, then reads others from INPUT, and writes
to OUTPUT. With BATCH, it shows no prompt; if PATIENT, as a batch is, each command completes
before the next is read; with ECHO, it shows what it reads. ACCOUNT, if any, is an account of its
lines. With STOP, it is over when one of them is an error. PLACE, if any, is called before each.
They are read in PACKAGE, by default ARS-USER. COLOR, which is :AUTO, :ALWAYS or :NEVER, says
whether it writes in colours: by default on a terminal, unless the environment has NO_COLOR."
  (let ((console (make-console output)))
    (setf (console-colored-p console) (color-wanted-p color (console-stream console)))
    (%make-session :input input :console console :batch-p (and batch t)
                   :patient-p (and patient t) :echo-p (and echo t)
                   :files files :lines lines :account account :stop-p (and stop t)
                   :place place :package package)))

(defun check-run ()
  "Signal BAD-LINE if the run that the prompt is in is over."
  (when (and *simulation* (simulation-over *simulation*))
    (let ((name (simulation-name *simulation*)))
      (reject-line "The run in ~(~A~) is over: ~A. ~:[WORLD shows where you can go~;~
                    WORLD ~:*~(~A~) starts it anew~]."
                   name (simulation-over *simulation*)
                   (and (find-map name nil) name)))))

(defun robot-commanded ()
  "Return the robot of the current simulation that has the name of the one that the prompt commands,
or NIL. Where Lisp at the prompt runs a simulation of its own, that has perhaps none."
  (find *prompt-robot* (simulation-robots *simulation*) :key #'robot-name))

(defun session-robot ()
  "Return the robot that the prompt commands. Signals BAD-LINE when there is none, or its run is
over."
  (check-run)
  (let ((robots (and *simulation* (simulation-robots *simulation*))))
    (or (find *prompt-robot* robots :key #'robot-name)
        (first robots)
        (reject-line "There is no robot here. WORLD lists the worlds, WORLD name starts one."))))

(defun size-of-window (session)
  "Return how many columns and rows there are where SESSION writes."
  (funcall (or (console-window (session-console session)) #'window-size)))

(defun terminal-p (session)
  "True if somebody sits at SESSION."
  (typed-by-hand-p (session-input session)))

(defun watched-p (session)
  "True if somebody sits at SESSION, and it can be found out whether he has typed something."
  (and (terminal-p session)
       (typep (source-of (session-input session)) '(or descriptor-stream handed-octets))))

(defun display-wanted-p (session)
  "True if a robot that starts for SESSION is to have a window. Where none is to be had, only
DISPLAY says so."
  (and (terminal-p session) *display-opener* t))

;;; Complaints and messages.

(defun complain (session text)
  "Show TEXT as an error."
  (incf (session-errors session))
  (let ((account (session-account session)) (console (session-console session)))
    (unless (report-trouble account text)
      (write-fresh (fitted (painted (format nil "*ERROR* -> ~A~%"
                                            (complaint-text
                                             (placed-text account text (line-of-trouble account))))
                                    (ink-of :error) console)
                           console)
                   console))))

(defun take-all-messages ()
  (append (take-messages)
          (when (and *simulation* (not (eq *message-queue* (simulation-messages *simulation*))))
            (take-messages (simulation-messages *simulation*)))))

;;; What others than the prompt ask of the robot, such as plans, ends with messages like its own.

(defun left-to-program-p (message)
  "True if MESSAGE tells how a command ended that a program has given, with a continuation: that is
told, and may recover from an error."
  (and (message-robot message)
       (message-told-p message)
       (not (line-asker-p (message-asker message)))))

(defun others-p (message)
  "True if MESSAGE tells how a command ended that a plan or program has given."
  (let ((asker (message-asker message)))
    (not (or (null asker) (equal asker +asker+)))))

(defun ink-of (kind)
  "Return the ink of what is of KIND: :ERROR, :WARNING, :MESSAGE, or :OTHERS, of others' commands."
  (ecase kind (:error :red) (:warning :yellow) (:message :cyan) (:others :grey)))

(defun message-ink (message)
  (ink-of (if (others-p message) :others (message-kind message))))

(defun other-robot (message session)
  "Return the name of the robot that MESSAGE tells of, unless it is the one that SESSION commands."
  (let ((own (session-robot-name session)) (name (message-robot message)))
    (and own name (not (eq own name)) name)))

(defun message-words (message session)
  "Return what SESSION says for MESSAGE: whose command it tells of, if another robot's; and if it is
an error or warning in a script, with the place of its line."
  (let ((text (format nil "~@[~(~A~): ~]~A" (other-robot message session) (message-text message)))
        (account (session-account session)))
    (if (member (message-kind message) '(:error :warning))
        (placed-text account text (line-of-message account message))
        text)))

(defun write-painted (message session out)
  "Write MESSAGE to OUT as the console of SESSION is to show it."
  (write-string (painted (visible (with-output-to-string (text)
                                    (write-message message text (message-words message session))))
                         (message-ink message) (session-console session))
                out))

;; As reading 197 says.
(defun write-messages (messages session)
  (let ((console (session-console session))
        (text (with-output-to-string (out)
                (dolist (message messages) (write-painted message session out)))))
    (if (and (unanswered-p console) (eq (message-kind (first messages)) :message))
        (write-after-prompt (fitted text console (console-prompt console)) console)
        (write-fresh (fitted text console) console))))

(defgeneric error-counts-p (message session)
  (:documentation "True if SESSION counts the error MESSAGE, and not what has caused it."))

(defun counts-p (message session)
  "True if MESSAGE is an error that SESSION counts."
  (and (eq :error (message-kind message))
       (error-counts-p message session)))

(defun told-often-p (message session)
  "True if MESSAGE is an error that somebody who sits at SESSION has been told often."
  (and (eq :error (message-kind message))
       (terminal-p session)
       (repeated-often-p message (session-told session))))

(defun count-error (session message)
  "Count the error MESSAGE in SESSION: if it is of an earlier line, not for the line under way."
  (let ((account (session-account session)))
    (incf (session-errors session))
    (when (others-error-p account message)
      (incf (account-errors account))
      (note-error-of-line account (line-of-message account message)))))

(defun messages-for (session messages)
  "Count the errors among MESSAGES, and return those that SESSION is to show."
  (dolist (message messages)
    (when (counts-p message session) (count-error session message)))
  (remove-if (lambda (message) (told-often-p message session))
             (if (session-quiet-p session) (remove-if #'others-p messages) messages)))

(defun texts-about (session messages)
  "Return what is to be said in SESSION of MESSAGES, which have been shown there: that some come
again and again, or are very many."
  (remove nil (append (loop for message in messages
                            collect (repetition-text message (session-told session)))
                      (and (terminal-p session)
                           (list (flood-text (session-flood session)
                                             (count-if #'others-p messages)))))))

(defun tell-messages (session messages)
  "Show MESSAGES in SESSION, and the prompt again."
  (with-lock ((session-lock session))
    (setf (session-news-p session) nil)
    (let ((console (session-console session))
          (messages (messages-for session messages)))
      (when (and messages (not flush-all-errors*))
        (printing-words ()
          (or (report-messages (session-account session) messages)
              (write-messages messages session)))
        (dolist (text (texts-about session messages))
          (write-fresh (fitted text console) console)))
      (restore-prompt console)
      (finish-output console))))
