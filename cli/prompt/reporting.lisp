;;;; reporting.lisp -- reports of a session to other programs, and which line each is for.

(in-package :ars-magna.cli)

;;; A session with an account of its lines can say where a script is wrong. If its console is on an
;;; OBJECT-STREAM, it reports objects instead of text. Their types are in cli/README.md. Without an
;;; account, NIL stands for it and nothing is reported.

(defstruct (account (:constructor make-account (file &optional console)) (:copier nil))
  "A record of the line that a session is running. FILE is the name of a script or NIL. The running
line has the text TEXT and the number LINE, which is 0 for an option. ERRORS is the number of errors
before that line. CONSOLE is the console that gets JSON objects, or NIL. WAITING are earlier lines
whose work waits for time to pass, the newest first. PLANS holds pairs of a plan's asker and the
number of the line that has begun the plan. TROUBLE-LINE is the number of the faulty line in a
running form, or NIL if the number is not known."
  (file nil :type (or null string) :read-only t)
  (console nil :type (or null console) :read-only t)
  (line 0 :type fixnum)
  (text nil :type (or null string))
  (errors 0 :type fixnum)
  (waiting '() :type list)
  (plans '() :type list)
  (trouble-line nil :type (or null fixnum)))

(defun reports-objects-p (account)
  (and account (account-console account) t))

(defun current-tick ()
  (and *simulation* (simulation-tick *simulation*)))

(defun report-object (account type &rest properties)
  "If ACCOUNT reports objects, write an object of TYPE, a string, with PROPERTIES, and return T."
  (when (reports-objects-p account)
    (with-console (stream (account-console account))
      (write-object (list* :type type properties) stream))
    t))

(defun last-line-number (account)
  "Return the number of the running line of ACCOUNT; NIL before the first line, and for an option."
  (and (plusp (account-line account)) (account-line account)))

(defun report-message (account kind text &key (line (last-line-number account)) robot)
  "Report a message. ROBOT is a text that names the robot of the message, or NIL."
  (apply #'report-object account "message" :kind kind :text text :tick (current-tick) :line line
         (and robot (list :robot robot))))

(defun report-values (account texts)
  (when (reports-objects-p account)
    (dolist (text texts t) (report-object account "value" :text text))))

(defun running-line-number (account)
  "Return the number of the running line of ACCOUNT; NIL if ACCOUNT is NIL or no line is running."
  (and account (account-text account) (last-line-number account)))

(defun faulty-line-number (account)
  "Return the number of the faulty line in the running line or form; NIL if there is none."
  (let ((line (running-line-number account)))
    (and line (or (account-trouble-line account) line))))

(defun note-trouble-line (account line)
  (when account (setf (account-trouble-line account) line)))

(defun text-with-location (account text &optional (line (running-line-number account)))
  "Return TEXT, about an error in LINE. For a script, begin with its name and the line number."
  (if (and account (account-file account) line)
      (format nil "~A, line ~D: ~A" (account-file account) line text)
      text))

;;; Lines.

(defun note-line-start (account text line errors)
  "Record that the line with the number LINE begins, after ERRORS errors. TEXT is the text of the
line, or NIL if the line does nothing."
  (when account
    (setf (account-line account) line
          (account-text account) text
          (account-trouble-line account) nil
          (account-errors account) errors)))

(defun report-line (account type line text &rest properties)
  (apply #'report-object account type :line line :text text
         (append properties (list :tick (current-tick)))))

(defun report-waiting-lines (account)
  "Report the ends of lines that had to wait for time to pass, the oldest first."
  (dolist (waiting (reverse (account-waiting account)))
    (destructuring-bind (line text good-p end) waiting
      (let ((how (funcall end)))
        (when how
          (removef (account-waiting account) waiting)
          (report-line account "done" line text
                       :ok (if (and good-p (eq :ok how)) t :false)))))))

(defun give-up-waiting-lines (account)
  "Report that lines which wait for time to pass have not ended, and never will."
  (dolist (waiting (reverse (shiftf (account-waiting account) '())))
    (report-line account "done" (first waiting) (second waiting) :ok :false)))

(defun note-line-end (account errors end)
  "Record and report that all requests of the running line are done, after ERRORS errors so far. If
requests still wait for time to pass, END is a function: it returns NIL until the requests are done,
and then :OK or :FAILED. Otherwise END is NIL."
  (when account (report-waiting-lines account))
  (when (and account (account-text account))
    (let ((text (string-trim " " (shiftf (account-text account) nil)))
          (line (last-line-number account))
          (good-p (= errors (account-errors account))))
      (cond (end (push (list line text good-p end) (account-waiting account))
                 (report-line account "waiting" line text))
            (t (report-line account "done" line text :ok (if good-p t :false))))
      ;; Plans of lines that no longer wait are forgotten.
      (setf (account-plans account)
            (remove-if-not (lambda (plan)
                             (find (cdr plan) (account-waiting account) :key #'first))
                           (account-plans account))))))

(defun report-program-input (account)
  (when account (report-object account "asking" :line (last-line-number account))))

;;;; Who asks

;;; Requests of a line while time stands still end under a later line, such as RESUME. So each
;;; counted line has its own asker text: equal to others, but another object.

(define-constant +prompt-asker+ "the prompt" :test #'string=
  :documentation "The text in messages that names a line of the prompt as the asker of a request.")

;; Equal to that, but another object: an error of the line's requests is the line's.
(defparameter *line-requester* (copy-seq +prompt-asker+)
  "The asker of requests made by lines that are not Lisp, in sessions that do not count lines.")

(defvar *lines-of-askers* (make-hash-table :test 'eq :weakness :key :synchronized t)
  "A table of the askers of counted lines. Values: lists (account line-number not-lisp-p).")

(defun asker-for (account &key typed-p (text +prompt-asker+))
  "Return the asker, a string equal to TEXT, for requests of the running line of ACCOUNT, which may
be NIL. TYPED-P is true for a line that is not Lisp."
  (cond ((and account (last-line-number account))
         (let ((asker (copy-seq text)))
           (setf (gethash asker *lines-of-askers*) (list account (account-line account) typed-p))
           asker))
        (typed-p *line-requester*)
        (t text)))

(defun line-asker-p (asker)
  "True if ASKER is the asker of requests made by lines that are not Lisp."
  (or (eq *line-requester* asker) (third (gethash asker *lines-of-askers*))))

(defun about-line-request-p (message)
  "True if MESSAGE is about a request of a counted line itself, not of a plan."
  (let ((asker (message-asker message)))
    (and (equal asker +prompt-asker+) (gethash asker *lines-of-askers*) t)))

(defun lisp-asker-p (asker)
  "True if ASKER is the asker of requests made by Lisp in lines."
  (and (equal asker +prompt-asker+) (not (line-asker-p asker))))

(defun asked-by-lisp-of-line-p (asker account)
  (destructuring-bind (&optional whose line typed-p) (gethash asker *lines-of-askers*)
    (and (eq whose account) (eql line (account-line account)) (not typed-p))))

(defun note-plan-of-line (account plan)
  (when account (push (cons (asker-note plan) (last-line-number account)) (account-plans account))))

(defun line-number-of-message (account message)
  "Return the number of the line that caused MESSAGE, or of the running line; NIL without ACCOUNT."
  (when account
    (let* ((asker (message-asker message))
           (plan (assoc asker (account-plans account) :test #'equal)))
      (destructuring-bind (&optional whose line typed-p) (gethash asker *lines-of-askers*)
        (declare (ignore typed-p))
        (cond ((eq whose account) line)
              (plan (rest plan))
              (t (last-line-number account)))))))

(defun report-messages (account messages)
  (when (reports-objects-p account)
    (dolist (message messages t)
      (report-message account (message-kind message) (message-text message)
                      :line (line-number-of-message account message)
                      :robot (robot-of-message message)))))
