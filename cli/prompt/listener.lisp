;;;; listener.lisp -- showing messages, and hiding those that repeat.

(in-package :ars-magna.cli)

;;; An error is shown three times, then at the tenth, the hundredth time and so on; a transcript has
;;; every one. For an error of a line, the count begins again with the next line. For code that runs
;;; by itself, it continues until that code changes or is in another run.

(defstruct tally
  "How often an error was reported, in CODE, a function that runs by itself, or NIL, last at TICK."
  (count 0 :type (integer 0))
  (code nil)
  (tick 0 :type integer))

(defun item-at-fault (message)
  "Return the item of MESSAGE that says whose code, running by itself, is at fault, or NIL."
  (find-if #'recurring-code (message-items message)))

(defun tick-of (message)
  (let ((run (message-run message)))
    (if run (simulation-tick run) 0)))

(defun tally-for (message counts)
  (let* ((text (message-text message))
         (code (let ((item (item-at-fault message)))
                 (and item (recurring-code item))))
         (tally (gethash text counts)))
    (cond ((and tally (eq code (tally-code tally)) (<= (tally-tick tally) (tick-of message)))
           tally)
          (t (when (< *message-limit* (hash-table-count counts)) (clrhash counts))
             (setf (gethash text counts) (make-tally :code code))))))

(defun power-of-ten-p (number)
  (or (= 1 number)
      (and (zerop (mod number 10)) (power-of-ten-p (/ number 10)))))

(defun repeated-often-p (message counts)
  "Count MESSAGE in COUNTS. True if it repeats so often that it is hidden."
  (let* ((tally (tally-for message counts)) (count (incf (tally-count tally))))
    (setf (tally-tick tally) (tick-of message))
    (and (< 3 count) (not (power-of-ten-p count)))))

(defun repetition-text (message counts)
  "Return a note on how often MESSAGE, which is shown, was reported, by COUNTS; or NIL."
  (let* ((tally (and (eq :error (message-kind message)) (gethash (message-text message) counts)))
         (count (if tally (tally-count tally) 0))
         (item (item-at-fault message)))
    (when (<= 3 count)
      (format nil "That has come up ~D times; it is shown again after ~D.~@[ ~A~] PAUSE stops ~
                   time.~%"
              count
              (loop for next = 10 then (* 10 next) when (< count next) return next)
              (and item (recurring-remedy item))))))

(defun reset-line-error-counts (counts)
  "Remove the errors of lines from COUNTS."
  (maphash (lambda (text tally) (unless (tally-code tally) (remhash text counts))) counts))

(defun merge-counts (counts others)
  "Add to COUNTS the higher counts of the table OTHERS."
  (maphash (lambda (text tally)
             (let ((own (gethash text counts)))
               (when (or (null own) (< (tally-count own) (tally-count tally)))
                 (setf (gethash text counts) (copy-tally tally)))))
           others))

;;; Plans may give more messages than a user can read.

(define-constant +flood+ 50
  :documentation "After this many messages from others' commands, with no line between them, a
message says how to hide them.")

;;;; Messages

;;; Messages arrive at any time (manual E). A plain message continues the line of the prompt; a
;;; warning or an error starts a fresh one; then the prompt is shown again. All messages of a tick
;;; are shown together, when the tick is over.

(defstruct (listener (:copier nil))
  "Shows, on a console, the messages of a session's lines and of a simulation."
  (console (make-console *standard-output*) :type console :read-only t)
  ;; A user can type and answer.
  (terminal-p nil :type boolean :read-only t)
  ;; Messages from commands of plans and programs are hidden.
  (quiet-p nil :type boolean)
  ;; The counts of errors, by text, as above: any thread may report, so the lock guards them.
  (error-counts (make-hash-table :test 'equal) :type hash-table :read-only t)
  ;; How many messages from others' commands were shown since the last line was read; after too
  ;; many, in all.
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

(defun flood-text (listener count)
  "Count COUNT more messages from others' commands. Return, once, a message if they are too many."
  (let ((before (listener-others-shown listener)))
    (and (< before +flood+)
         (<= +flood+ (incf (listener-others-shown listener) count))
         (format nil "ECHO OFF hides messages from commands that plans and programs ~
                      issue.~%"))))

(defun reset-flood (listener)
  "Start counting again in LISTENER, unless there were too many."
  (when (< (listener-others-shown listener) +flood+)
    (setf (listener-others-shown listener) 0)))

;;; Complaints and messages.

(defun complain (listener text)
  (incf (listener-errors listener))
  (let ((account (listener-account listener)) (console (listener-console listener)))
    (unless (and (reports-p account) (report-message account :error text))
      (write-fitted console "~A"
                    (painted (format nil "*ERROR* -> ~A~%"
                                     (complaint-text
                                      (placed-text account text (line-of-trouble account))))
                             (ink-of :error) console)))))

(defun take-all-messages ()
  (append (take-messages)
          (when (and *simulation* (not (eq *message-queue* (simulation-messages *simulation*))))
            (take-messages (simulation-messages *simulation*)))))

;;; Commands from others than the prompt, such as plans, end with the same messages.

(defun left-to-program-p (message)
  "True if MESSAGE ends a command that has a program's continuation, which may handle errors."
  (and (message-robot message)
       (message-told-p message)
       (not (line-asker-p (message-asker message)))))

(defun others-p (message)
  "True if MESSAGE ends a command that a plan or program has issued."
  (let ((asker (message-asker message)))
    (not (or (null asker) (equal asker +asker+)))))

(defun ink-of (kind)
  "Return the ink of messages of KIND: :ERROR, :WARNING, :MESSAGE, or :OTHERS, others' commands."
  (ecase kind (:error :red) (:warning :yellow) (:message :cyan) (:others :grey)))

(defun message-words (message listener)
  "Return the text of MESSAGE for LISTENER: with the robot's name, if it is about another robot's
command; and with the place of its line, if it is an error or warning in a script."
  (let* ((own (listener-robot-name listener)) (name (message-robot message))
         (text (format nil "~@[~(~A~): ~]~A" (and own (not (eq own name)) name)
                       (message-text message)))
         (account (listener-account listener)))
    (if (member (message-kind message) '(:error :warning))
        (placed-text account text (line-of-message account message))
        text)))

(defun write-painted (message listener out)
  (write-string (painted (visible (with-output-to-string (text)
                                    (write-message message text (message-words message listener))))
                         (ink-of (if (others-p message) :others (message-kind message)))
                         (listener-console listener))
                out))

;; As reading 197 says.
(defun write-messages (messages listener)
  (let ((console (listener-console listener))
        (text (with-output-to-string (out)
                (dolist (message messages) (write-painted message listener out)))))
    (if (and (unanswered-p console) (eq (message-kind (first messages)) :message))
        (write-after-prompt (fitted text console (console-prompt console)) console)
        (write-fitted console "~A" text))))

(defun count-error (listener message)
  "Count the error MESSAGE in LISTENER: for the line that caused it, if that is an earlier one."
  (let ((account (listener-account listener)))
    (incf (listener-errors listener))
    (when (and account (not (eql (line-of-message account message) (line-under-way account))))
      (incf (account-errors account))
      ;; That line may wait for time to pass.
      (let ((waiting (assoc (line-of-message account message) (account-waiting account))))
        (when waiting (setf (third waiting) nil))))))

(defgeneric error-counts-p (message listener)
  (:documentation "True if LISTENER counts the error MESSAGE itself, and not its cause."))

(defun messages-for (listener messages)
  "Count the errors among MESSAGES, and return those that LISTENER is to show."
  (dolist (message messages)
    (when (and (eq :error (message-kind message)) (error-counts-p message listener))
      (count-error listener message)))
  (remove-if (lambda (message) (and (eq :error (message-kind message))
                                    (listener-terminal-p listener)
                                    (repeated-often-p message (listener-error-counts listener))))
             (if (listener-quiet-p listener) (remove-if #'others-p messages) messages)))

(defun texts-about (listener messages)
  "Return notes for LISTENER on MESSAGES, which it has shown: that some repeat, or are very many."
  (remove nil (append (loop for message in messages
                            collect (repetition-text message (listener-error-counts listener)))
                      (and (listener-terminal-p listener)
                           (list (flood-text listener (count-if #'others-p messages)))))))

(defun tell-messages (listener messages)
  (with-lock ((listener-lock listener))
    (setf (listener-news-p listener) nil)
    (let ((console (listener-console listener))
          (messages (messages-for listener messages)))
      (when (and messages (not flush-all-errors*))
        (printing-words ()
          (or (report-messages (listener-account listener) messages)
              (write-messages messages listener)))
        (dolist (text (texts-about listener messages))
          (write-fitted console "~A" text)))
      (restore-prompt console))))
