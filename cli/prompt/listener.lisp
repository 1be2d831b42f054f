;;;; listener.lisp -- showing messages, and hiding those that repeat.

(in-package :ars-magna.cli)

;;; An error is shown three times, then at the tenth, the hundredth time and so on; a transcript has
;;; every one. For an error of a line, the count begins again with the next line. For code that runs
;;; by itself, it continues until that code changes or is in another run.

(defstruct tally
  "How often an error was reported, the last time at TICK. CODE is NIL, or the recurring function
that signals the error, such as a kicker."
  (count 0 :type (integer 0))
  (code nil)
  (tick 0 :type integer))

(defun faulty-code-item (message)
  "Return the item of MESSAGE that names a faulty recurring function, such as a kicker; or NIL."
  (find-if #'recurring-function (message-items message)))

(defun message-tick (message)
  (let ((run (message-run message)))
    (if run (simulation-tick run) 0)))

(defun message-key (message)
  "Return the key of MESSAGE in tables of counts: its robot and its text."
  (cons (message-robot message) (message-text message)))

(defun tally-for (message counts)
  (let* ((key (message-key message))
         (code (let ((item (faulty-code-item message)))
                 (and item (recurring-function item))))
         (tally (gethash key counts)))
    (cond ((and tally (eq code (tally-code tally)) (<= (tally-tick tally) (message-tick message)))
           tally)
          (t (when (< *message-limit* (hash-table-count counts)) (clrhash counts))
             (setf (gethash key counts) (make-tally :code code))))))

(defun power-of-ten-p (number)
  (or (= 1 number)
      (and (zerop (mod number 10)) (power-of-ten-p (/ number 10)))))

(defun count-repeated-message (message counts)
  "Count MESSAGE in the table COUNTS. Return true if MESSAGE has come too often to be shown."
  (let* ((tally (tally-for message counts)) (count (incf (tally-count tally))))
    (setf (tally-tick tally) (message-tick message))
    (and (< 3 count) (not (power-of-ten-p count)))))

(defun repetition-text (message counts)
  "Return text on how often MESSAGE was reported, from the table COUNTS; NIL if not often."
  (let* ((tally (and (eq :error (message-kind message)) (gethash (message-key message) counts)))
         (count (if tally (tally-count tally) 0))
         (item (faulty-code-item message)))
    (when (<= 3 count)
      (format nil "This error has come up ~D times; it is shown again at ~D times.~@[ ~A~] ~
                   PAUSE stops time.~%"
              count
              (loop for next = 10 then (* 10 next) when (< count next) return next)
              (and item (stop-recurring-remedy item))))))

(defun reset-line-error-counts (counts)
  (maphash (lambda (key tally) (unless (tally-code tally) (remhash key counts))) counts))

(defun merge-counts (counts others)
  "Raise the counts in the table COUNTS that are lower than in the table OTHERS."
  (maphash (lambda (key tally)
             (let ((own (gethash key counts)))
               (when (or (null own) (< (tally-count own) (tally-count tally)))
                 (setf (gethash key counts) (copy-tally tally)))))
           others))

;;; Plans may give more messages than a user can read.

(define-constant +many-messages+ 50
  :documentation "The number of messages from commands of plans and programs, without a line in
between, after which a hint says how to hide them.")

;;;; Messages

;;; Messages arrive at any time (manual E). A plain message continues the line of the prompt; a
;;; warning or an error starts a fresh one; then the prompt is shown again. All messages of a tick
;;; are shown together, when the tick is over.

(defstruct (listener (:copier nil))
  "A listener shows the messages of a session's lines and of a simulation on a console."
  (console (make-console *standard-output*) :type console :read-only t)
  ;; A user can type and answer.
  (terminal-p nil :type boolean :read-only t)
  ;; Messages from commands of plans and programs are hidden.
  (quiet-p nil :type boolean)
  ;; The counts of errors, by robot and text: any thread may report, so the lock guards them.
  (error-counts (make-hash-table :test 'equal) :type hash-table :read-only t)
  ;; How many messages of others' commands were shown since the last line; after too many, in all.
  (others-shown 0 :type fixnum)
  (lock (make-lock "session") :read-only t)
  ;; The simulation whose messages are shown as they arrive, and its observer if it is live.
  (simulation nil)
  (observer nil)
  ;; The name of the robot that it commands there.
  (robot-name nil :type symbol)
  ;; True if there are messages that will be shown soon.
  (news-p nil)
  (errors 0 :type fixnum)
  ;; Which line is being run, if that is needed; see reporting.lisp.
  (account nil :type (or null account) :read-only t)
  ;; Its user is lost, but has not left it: other users are asked instead.
  (abandoned-p nil :type boolean))

(defun many-messages-hint (listener count)
  "Count COUNT more messages of plans and programs. Return a hint, once, after too many messages."
  (let ((before (listener-others-shown listener)))
    (and (< before +many-messages+)
         (<= +many-messages+ (incf (listener-others-shown listener) count))
         (format nil "ECHO OFF hides messages from commands that plans and programs ~
                      issue.~%"))))

(defun reset-message-count (listener)
  "Set LISTENER's count of messages of plans and programs to 0, unless the hint was given."
  (when (< (listener-others-shown listener) +many-messages+)
    (setf (listener-others-shown listener) 0)))

;;; Complaints and messages.

(defun report-session-error (listener text)
  (incf (listener-errors listener))
  (let ((account (listener-account listener)) (console (listener-console listener)))
    (unless (and (reports-objects-p account) (report-message account :error text))
      (write-fitted console "~A"
                    (paint-for-console (format nil "*ERROR* -> ~A~%"
                                     (short-error-text
                                      (text-with-location account text
                                                          (faulty-line-number account))))
                             (message-color :error) console)))))

(defun take-all-messages ()
  (append (take-messages)
          (when (and *simulation* (not (eq *message-queue* (simulation-messages *simulation*))))
            (take-messages (simulation-messages *simulation*)))))

;;; Commands from others than the prompt, such as plans, end with the same messages.

(defun has-program-continuation-p (message)
  "True if MESSAGE reports the end of a command, and a program's continuation got that report."
  (and (message-about message)
       (message-told-p message)
       (not (line-asker-p (message-asker message)))))

(defun from-program-p (message)
  "True if MESSAGE reports the end of a command that a plan or program has issued."
  (let ((asker (message-asker message)))
    (not (or (null asker) (equal asker +prompt-asker+)))))

(defun message-color (kind)
  "KIND is :ERROR, :WARNING, :MESSAGE, or :OTHERS (commands of plans and programs)."
  (ecase kind (:error :red) (:warning :yellow) (:message :cyan) (:others :grey)))

(defun full-message-text (message listener)
  "Return the text of MESSAGE for LISTENER. Add the robot's name if another robot's command has
ended. Add file and line number to errors and warnings in a script."
  (let* ((own (listener-robot-name listener)) (name (message-robot message))
         (run (or (message-run message) *simulation*))
         (text (format nil "~@[~(~A~): ~]~A"
                       (and own name (not (eq own name)) (label-in-run name run))
                       (message-text message)))
         (account (listener-account listener)))
    (if (member (message-kind message) '(:error :warning))
        (text-with-location account text (line-number-of-message account message))
        text)))

(defun write-colored-message (message listener out)
  (let ((kind (if (from-program-p message) :others (message-kind message)))
        (text (with-output-to-string (text)
                (write-message message text (full-message-text message listener)))))
    (write-string (paint-for-console (escape-controls text) (message-color kind)
                                     (listener-console listener))
                  out)))

;; As reading 197 says.
(defun write-messages (messages listener)
  (let ((console (listener-console listener))
        (text (with-output-to-string (out)
                (dolist (message messages) (write-colored-message message listener out)))))
    (if (and (prompt-unanswered-p console) (eq (message-kind (first messages)) :message))
        (write-after-prompt (fit-to-window text console (console-prompt console)) console)
        (write-fitted console "~A" text))))

(defun count-error (listener message)
  "Count the error MESSAGE in LISTENER, and in its account if an earlier line caused the error."
  (let ((account (listener-account listener)))
    (incf (listener-errors listener))
    (when (and account
               (not (eql (line-number-of-message account message) (last-line-number account))))
      (incf (account-errors account))
      ;; That line may wait for time to pass.
      (let ((waiting (assoc (line-number-of-message account message) (account-waiting account))))
        (when waiting (setf (third waiting) nil))))))

(defgeneric error-counts-p (message listener)
  (:documentation "True if LISTENER counts the error MESSAGE: no plan or program handles it."))

(defun count-and-select-messages (listener messages)
  "Count the errors among MESSAGES, and return those that LISTENER is to show."
  (dolist (message messages)
    (when (and (eq :error (message-kind message)) (error-counts-p message listener))
      (count-error listener message)))
  (remove-if (lambda (message) (and (eq :error (message-kind message))
                                    (listener-terminal-p listener)
                                    (count-repeated-message message
                                                            (listener-error-counts listener))))
             (if (listener-quiet-p listener) (remove-if #'from-program-p messages) messages)))

(defun notes-on-messages (listener messages)
  "Return notes, a list of texts, on errors repeated in MESSAGES and on too many messages."
  (remove nil (append (loop for message in messages
                            collect (repetition-text message (listener-error-counts listener)))
                      (and (listener-terminal-p listener)
                           (list (many-messages-hint
                                  listener (count-if #'from-program-p messages)))))))

(defun print-messages (listener messages)
  (with-lock ((listener-lock listener))
    (setf (listener-news-p listener) nil)
    (let ((console (listener-console listener))
          (messages (count-and-select-messages listener messages)))
      (when (and messages (not flush-all-errors*))
        (printing-text ()
          (or (report-messages (listener-account listener) messages)
              (write-messages messages listener)))
        (dolist (text (notes-on-messages listener messages))
          (write-fitted console "~A" text)))
      (restore-prompt console))))
