;;;; reporting.lisp -- what a session tells other programs: objects for messages and ends of lines.

(in-package :ars-magna.cli)

;;; A session that has an account of its lines can say where a script is wrong. If its console is on
;;; an OBJECT-STREAM, it reports by objects instead of text. Their types are in cli/README.md. Where
;;; there is no account, NIL stands for it, and nothing is reported.

(defstruct (account (:constructor make-account (file &optional console)) (:copier nil))
  "Where a session is in FILE, the name of a script or NIL. LINES have been read; the line under
way, TEXT, begins at LINE; ERRORS were there before it. CONSOLE is where objects are written, or
NIL."
  (file nil :type (or null string) :read-only t)
  (console nil :type (or null console) :read-only t)
  (lines 0 :type fixnum)
  (line 0 :type fixnum)
  (text nil :type (or null string))
  (errors 0 :type fixnum))

(defun reports-p (account)
  "True if what has ACCOUNT reports by objects."
  (and account (account-console account) t))

(defun now ()
  "Return the tick of the current simulation, or NIL."
  (and *simulation* (simulation-tick *simulation*)))

(defun report-object (account type &rest properties)
  "Write an object of TYPE, a string, with PROPERTIES, a property list, if ACCOUNT is of what
reports by objects. True if it is."
  (when (reports-p account)
    (with-console (stream (account-console account))
      (write-object (list* :type type properties) stream))
    t))

(defun line-under-way (account)
  "Return the number of the line that is being done, or NIL before the first."
  (and (plusp (account-line account)) (account-line account)))

(defun report-message (account kind text)
  "Report a message of KIND that says TEXT."
  (report-object account "message" :kind kind :text text :tick (now)
                                   :line (line-under-way account)))

(defun report-trouble (account text)
  "Report that a line makes no sense, as TEXT says. True if ACCOUNT is of what reports by objects."
  (when (reports-p account) (report-message account :error text)))

(defun report-messages (account messages)
  "Report MESSAGES. True if ACCOUNT is of what reports by objects."
  (when (reports-p account)
    (dolist (message messages t)
      (report-message account (message-kind message) (message-text message)))))

(defun report-values (account texts)
  "Report TEXTS, of the values of a form of Lisp. True if ACCOUNT is of what reports by objects."
  (when (reports-p account)
    (dolist (text texts t) (report-object account "value" :text text))))

(defun placed-text (account text)
  "Return TEXT, of what goes wrong in a line, after the place of that line if it is of a script."
  (if (and account (account-file account) (account-text account))
      (format nil "~A, line ~D: ~A" (account-file account) (account-line account) text)
      text))

;;; Lines.

(defun note-read (account)
  "Note that a line has been read."
  (when account (incf (account-lines account))))

(defun note-line-begun (account text errors)
  "Note that TEXT, the line that was read last, or NIL if there is nothing to do in it, is about to
be done, and that there were ERRORS so far."
  (when account
    (setf (account-line account) (account-lines account)
          (account-text account) text
          (account-errors account) errors)))

(defun note-line-ended (account errors)
  "Note, and report, that all that the line under way has asked for is done, and that there were
ERRORS so far."
  (when (and account (account-text account))
    (report-object account "done" :line (account-line account)
                                  :text (string-trim " " (account-text account))
                                  :ok (if (= errors (account-errors account)) t :false)
                                  :tick (now))
    (setf (account-text account) nil)))
