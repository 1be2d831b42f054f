;;;; reporting.lisp -- reports of a session to other programs, and which line each is for.

(in-package :ars-magna.cli)

;;; A session with an account of its lines can say where a script is wrong. If its console is on an
;;; OBJECT-STREAM, it reports objects instead of text. Their types are in cli/README.md. Without an
;;; account, NIL stands for it and nothing is reported.

(defstruct (account (:constructor make-account (file &optional console)) (:copier nil))
  "Where a session is in FILE, the name of a script or NIL. The running line, TEXT, has the number
LINE, or 0 if an option has caused it; ERRORS is the number of errors before it. CONSOLE is where
objects are written, or NIL. WAITING are earlier lines whose work waits for time to pass, the newest
first. PLANS are pairs of an asker and the line that has begun that plan. TROUBLE-LINE is the number
of the faulty line in a running form, or NIL if that is not known."
  (file nil :type (or null string) :read-only t)
  (console nil :type (or null console) :read-only t)
  (line 0 :type fixnum)
  (text nil :type (or null string))
  (errors 0 :type fixnum)
  (waiting '() :type list)
  (plans '() :type list)
  (trouble-line nil :type (or null fixnum)))

(defun reports-p (account)
  (and account (account-console account) t))

(defun current-tick ()
  (and *simulation* (simulation-tick *simulation*)))

(defun report-object (account type &rest properties)
  "Write an object of TYPE, a string, with the plist PROPERTIES, and return T, if ACCOUNT reports."
  (when (reports-p account)
    (with-console (stream (account-console account))
      (write-object (list* :type type properties) stream))
    t))

(defun line-under-way (account)
  "Return the number of the running line; NIL before the first, and for an option."
  (and (plusp (account-line account)) (account-line account)))

(defun report-message (account kind text &optional (line (line-under-way account)))
  "Report a message of KIND with TEXT, caused by LINE."
  (report-object account "message" :kind kind :text text :tick (current-tick) :line line))

(defun report-values (account texts)
  (when (reports-p account)
    (dolist (text texts t) (report-object account "value" :text text))))

(defun line-done-now (account)
  "Return the number of the running line, or NIL: ACCOUNT may be NIL, or between lines."
  (and account (account-text account) (line-under-way account)))

(defun line-of-trouble (account)
  "Return the number of the invalid line, of the form or line that is being run; or NIL: ACCOUNT may
be NIL, or between lines."
  (let ((line (line-done-now account)))
    (and line (or (account-trouble-line account) line))))

(defun note-trouble-line (account line)
  (when account (setf (account-trouble-line account) line)))

(defun placed-text (account text &optional (line (line-done-now account)))
  "Return TEXT, on an error in LINE, after the place of that line if it is of a script."
  (if (and account (account-file account) line)
      (format nil "~A, line ~D: ~A" (account-file account) line text)
      text))

;;; Lines.

(defun note-line-begun (account text line errors)
  "Note that the line with the number LINE begins, after ERRORS errors. TEXT is what it says, or
NIL if it does nothing."
  (when account
    (setf (account-line account) line
          (account-text account) text
          (account-trouble-line account) nil
          (account-errors account) errors)))

(defun report-line (account type line text &rest properties)
  "Report, as an object of TYPE, on the line TEXT with the number LINE, or NIL."
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

(defun note-line-ended (account errors end)
  "Note, and report, that all requests of the running line are done, after ERRORS errors so far. If
END is not NIL, they wait for time to pass: END returns NIL until they are done, and then :OK or
:FAILED."
  (when account (report-waiting-lines account))
  (when (and account (account-text account))
    (let ((text (string-trim " " (shiftf (account-text account) nil)))
          (line (line-under-way account))
          (good-p (= errors (account-errors account))))
      (cond (end (push (list line text good-p end) (account-waiting account))
                 (report-line account "waiting" line text))
            (t (report-line account "done" line text :ok (if good-p t :false))))
      ;; Plans of lines that no longer wait are forgotten.
      (setf (account-plans account)
            (remove-if-not (lambda (plan)
                             (find (cdr plan) (account-waiting account) :key #'first))
                           (account-plans account))))))

(defun report-asking (account)
  (when account (report-object account "asking" :line (line-under-way account))))

;;;; Who asks

;;; What a line requests while time stands still ends under a later line, such as RESUME. So where
;;; lines are counted, each has its own asker text: equal to that of others, but another
;;; object.

(define-constant +asker+ "the prompt" :test #'string=
  :documentation "Who asks for what lines ask for.")

;; Equal to that, but another object: an error of the line's requests is the line's.
(defparameter *line-asker* (copy-seq +asker+)
  "The asker of lines that are not Lisp, if lines are not counted.")

(defvar *askers* (make-hash-table :test 'eq :weakness :key :synchronized t)
  "For each asker of a counted line: a list of its account, its number, and true if not Lisp.")

(defun asker-for (account &key typed-p (text +asker+))
  "Return the asker for the running line of ACCOUNT, or NIL: a text equal to TEXT. TYPED-P is true
for a line that is not Lisp."
  (cond ((and account (line-under-way account))
         (let ((asker (copy-seq text)))
           (setf (gethash asker *askers*) (list account (account-line account) typed-p))
           asker))
        (typed-p *line-asker*)
        (t text)))

(defun line-asker-p (asker)
  "True if ASKER, of a message, belongs to lines that are not Lisp."
  (or (eq *line-asker* asker) (third (gethash asker *askers*))))

(defun of-line-p (message)
  "True if MESSAGE is about a request of a counted line itself, not of a plan."
  (let ((asker (message-asker message)))
    (and (equal asker +asker+) (gethash asker *askers*) t)))

(defun lisp-asker-p (asker)
  "True if ASKER, of a request, belongs to Lisp in lines."
  (and (equal asker +asker+) (not (line-asker-p asker))))

(defun of-lisp-in-line-p (asker account)
  "True if ASKER, of a request, belongs to Lisp in the running line of ACCOUNT."
  (destructuring-bind (&optional whose line typed-p) (gethash asker *askers*)
    (and (eq whose account) (eql line (account-line account)) (not typed-p))))

(defun note-plan-of-line (account plan)
  (when account (push (cons (asker-note plan) (line-under-way account)) (account-plans account))))

(defun line-of-message (account message)
  "Return the number of the line that caused MESSAGE, or of the running one; ACCOUNT may be NIL."
  (when account
    (let* ((asker (message-asker message))
           (plan (assoc asker (account-plans account) :test #'equal)))
      (destructuring-bind (&optional whose line typed-p) (gethash asker *askers*)
        (declare (ignore typed-p))
        (cond ((eq whose account) line)
              (plan (rest plan))
              (t (line-under-way account)))))))

(defun report-messages (account messages)
  (when (reports-p account)
    (dolist (message messages t)
      (report-message account (message-kind message) (message-text message)
                      (line-of-message account message)))))
