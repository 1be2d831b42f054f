;;;; messages.lisp -- the queue of errors, warnings and messages (manual 3.7), and OUT.

(in-package :ars-magna.definitions)

(export '(error-policy warn-at-once queue-notable-warning *message-queue* make-message-queue
                       message-queue
          copy-message-queue message *reported-robot* *get-reporting-run* *request-origin*
          take-messages
          queue-message queue-message-items message-text phrase write-message *message-limit*
          make-message robot-text robot-of-message))

;;; Messages are queued as lists of items and become text when they are read. The queue is
;;; bounded: beyond *MESSAGE-LIMIT* the oldest are dropped and counted.

(defparameter *message-limit* 1000
  "The number of messages that a queue holds before it drops the oldest (manual 3.7; an addition).")

(public flush-all-errors*)
(defvar flush-all-errors* nil
  "When true, queued messages are discarded instead of displayed. Default NIL (manual 3.7).")

(deftype error-policy ()
  "What happens to errors in users' code."
  '(member :report :signal :collect))

(defvar *request-origin* nil
  "The origin of the request that messages are about, a value of CURRENT-ASKER-NOTE; or NIL.")

(defvar *reported-robot* nil
  "The name of the robot that messages queued in this thread are about, or NIL.")

(defvar *get-reporting-run* (constantly nil)
  "A function that returns the run to which messages queued in this thread belong, or NIL.")

(define-record (message (:constructor make-message
                            (kind items &key cause (summary "") told-p notable-p about)
                          "Return a message of KIND with a list of ITEMS."))
  "A message of the simulator or a user."
  (kind :message (member :error :warning :message) ":ERROR, :WARNING or :MESSAGE" :export)
  (items '() list "the items that the message is made of" :export)
  (asker *request-origin* t
         "the origin of the message's request, such as a plan's name; or NIL" :export)
  (robot *reported-robot* t
         "the name of the robot whose command the message reports, or NIL" :export)
  ;; Several runs may share a queue.
  (run (funcall *get-reporting-run*) t "the run that the message belongs to, or NIL" :export)
  (cause nil t "the reported condition or failure in users' code, or NIL (troubles.lisp)" :export)
  (summary "" string "a text about the cause, on one line")
  (about nil (or null symbol)
         "the name of the command whose failure the message reports, or NIL" :export)
  (told-p nil boolean "users' code has also received what the message reports" :export)
  ;; Or a function that returns it later; or :AT-ONCE for a message that is shown at once if there
  ;; is no listener, because the run may never end.
  (notable-p nil (or boolean (eql :at-once) function)
             "the message is a warning that is shown like an error if it is not read"))

(define-record (message-queue (:constructor make-message-queue
                                  (&key (error-policy :report) echoed)
                                "Return a new, empty queue of messages."))
  "A queue of unread messages. The lists, counts and tables need LOCK, except to test UNSIGNALLED."
  (lock (make-lock "messages") t)
  (newest-first '() list :writable)
  (count 0 fixnum :writable)
  (forgotten 0 fixnum :writable)
  (listener nil (or null function) "the function, without arguments, that is called after each
message is queued, in the thread that queues the message; or NIL. Can be set" :writable :export)
  (error-policy :report error-policy
                ":REPORT, :SIGNAL or :COLLECT: what happens to errors in users' code. Can be set"
                :writable :export)
  (seen '() list "the tail of NEWEST-FIRST with the messages that need not be shown" :writable)
  (read-p nil boolean
          "messages of the queue have been read or counted"
          :writable :export)
  (troubles '() list "the latest errors in users' code, the newest first" :writable)
  (unsignalled nil (or null message) "the first message about an error in users' code that is to be
signalled, or NIL; see troubles.lisp" :writable :export)
  (echoed nil (or null hash-table) "the table that counts errors, or NIL. If there is a table and no
listener, errors are shown at once"))

;; An interrupt, such as Ctrl-C, may report something too.
(defmacro with-queue ((queue) &body body)
  "Run BODY while no other thread changes QUEUE, with interrupts deferred."
  `(deferring-interrupts (with-lock ((message-queue-lock ,queue)) ,@body)))

(defvar *message-queue* (make-message-queue :echoed (make-hash-table :test 'equal))
  "The queue to which messages are added. A headless simulation binds its own queue.")

(defun copy-message-queue (queue)
  "Return a new queue with the messages of QUEUE, marked as read, and without a listener."
  (let ((copy (make-message-queue)))
    (with-queue (queue)
      (setf (message-queue-newest-first copy) (message-queue-newest-first queue)
            (message-queue-seen copy) (message-queue-newest-first queue)
            (message-queue-count copy) (message-queue-count queue)
            (message-queue-forgotten copy) (message-queue-forgotten queue)))
    copy))

(defun record-user-error (message queue)
  (push message (message-queue-troubles queue))
  (let ((last (nthcdr (1- *message-limit*) (message-queue-troubles queue))))
    (when last (setf (rest last) '())))
  (when (and (eq :signal (message-queue-error-policy queue))
             (null (message-queue-unsignalled queue)))
    (setf (message-queue-unsignalled queue) message)))

(defun unreported-error-p (message)
  "True if MESSAGE is about an error or mistake in users' code that is not reported in another way."
  (and (not (message-told-p message))
       (or (message-cause message) (eq :error (message-kind message)))))

(defun shown-at-once-p (message queue)
  (or (eq :at-once (message-notable-p message))
      (and (message-queue-echoed queue)
           (or (unreported-error-p message) (eq t (message-notable-p message))))))

(defun queue-message (message queue)
  "Add MESSAGE to QUEUE and notify its listener."
  (with-queue (queue)
    (when (and (message-cause message) (eq :error (message-kind message)))
      (record-user-error message queue))
    (push message (message-queue-newest-first queue))
    (incf (message-queue-count queue))
    (when (> (message-queue-count queue) (* 2 *message-limit*))
      (incf (message-queue-forgotten queue) (- (message-queue-count queue) *message-limit*))
      (setf (message-queue-newest-first queue)
            (subseq (message-queue-newest-first queue) 0 *message-limit*)
            (message-queue-count queue) *message-limit*)))
  (let ((listener (message-queue-listener queue)))
    (cond (listener (funcall listener))
          ((shown-at-once-p message queue) (echo-message message queue)))))

(defun queue-message-items (kind items &rest options)
  "Queue a message of KIND with ITEMS and OPTIONS, the arguments of MAKE-MESSAGE. Return nothing."
  (queue-message (apply #'make-message kind items options) *message-queue*)
  (values))

(public error-set)
(defun error-set (&rest stuff)
  "Queue an error message of the items STUFF, printed as by OUT. Return nothing (manual 3.7)."
  (queue-message-items :error stuff))

(public warning-set)
(defun warning-set (&rest stuff)
  "Queue a warning of the items STUFF, printed as by OUT. Return nothing (manual 3.7)."
  (queue-message-items :warning stuff))

(defun queue-notable-warning (&rest stuff)
  "Queue a warning of the items STUFF. If still unread at the end, show it then. Return nothing."
  (queue-message-items :warning stuff :notable-p t))

(defun warn-at-once (&rest stuff)
  "Queue a warning of the items STUFF. If the queue has no listener, show it now. Return nothing."
  (queue-message-items :warning stuff :notable-p :at-once))

(public message-set)
(defun message-set (&rest stuff)
  "Queue a message of the items STUFF, printed as by OUT. Return nothing (manual 3.7)."
  (queue-message-items :message stuff))

(defun take-messages (&optional (queue *message-queue*))
  "Empty QUEUE. Return a list of its messages, the oldest first, at most *MESSAGE-LIMIT*. If older
messages were dropped, the list begins with a warning that gives their number."
  (with-queue (queue)
    (setf (message-queue-read-p queue) t)
    (let* ((messages (message-queue-newest-first queue))
           (kept (reverse (subseq messages 0 (min (length messages) *message-limit*))))
           (forgotten (+ (message-queue-forgotten queue) (- (length messages) (length kept)))))
      (setf (message-queue-newest-first queue) '()
            (message-queue-count queue) 0
            (message-queue-forgotten queue) 0)
      (if (plusp forgotten)
          (cons (make-message :warning (list forgotten " earlier messages were forgotten")) kept)
          kept))))

;;; Formatting a message costs more than queueing it, and few are read.

(define-record (phrase (:constructor phrase (control &rest arguments)
                          "Return an item of a message: the format string CONTROL with ARGUMENTS.
They are formatted when the message is read, so ARGUMENTS must never change."))
  "An item of a message that is formatted when the message is read."
  (control "" string)
  (arguments '() list))
(defmethod print-object ((phrase phrase) stream)
  (printing-text ()
    (apply #'format stream (phrase-control phrase) (phrase-arguments phrase))))

;;; Printing.

(defun write-item (item stream)
  "Write ITEM to STREAM without quotes or exponent markers of floats; T is a newline (reading 36)."
  (cond ((eq item t) (terpri stream))
        ((floatp item)
         (let ((*read-default-float-format* (type-of item)))
           (princ item stream)))
        (t (princ item stream))))

(defun write-items (items stream)
  (dolist (item items) (write-item item stream)))

(public (out :nisp))
(defun out (&rest items)
  "Print ITEMS without quotes to standard output; T is a newline. Return nothing (manual 3.1.3)."
  (write-items items *standard-output*)
  (finish-output)
  (values))

(defun item-text (item)
  "Return ITEM as OUT prints it. If ITEM cannot be printed, return a text that says so."
  (handler-case (with-output-to-string (stream) (write-item item stream))
    (error (trouble) (format nil "an object that cannot be printed (~A: ~A)"
                             (string-downcase (type-of item)) (one-line-text trouble)))))

(defun message-text (message)
  "Return the items of MESSAGE as a string, without the marker *ERROR* or *WARNING*."
  (format nil "~{~A~}" (mapcar #'item-text (message-items message))))

(defgeneric robot-text (run name)
  (:documentation "Return a text for the robot with the name NAME if messages of RUN must say which
robot they are about; else NIL. RUN and NAME may be NIL.")
  (:method (run name) (declare (ignore run name)) nil))

(defun robot-of-message (message)
  "Return the text for the robot of MESSAGE, or NIL if the message need not name it."
  (robot-text (message-run message) (message-robot message)))

(defun text-with-robot (message &optional (text (message-text message)))
  "Return TEXT, of MESSAGE. If the message must name its robot, prepend the name."
  (format nil "~@[~A: ~]~A" (robot-of-message message) text))

(defun text-with-command (message)
  "Return the text of MESSAGE, with the names of its robot, if needed, and of its command."
  (let ((text (message-text message)) (name (message-about message)))
    (text-with-robot
     message
     (if (and name (not (starts-with-subseq (string name) text :test #'char-equal)))
         (format nil "~(~A~): ~A" name text)
         text))))

(defun write-message (message stream &optional (text (message-text message)))
  "Write MESSAGE, with the text TEXT, and a newline to STREAM. Errors begin with *ERROR* ->,
warnings with *WARNING* -> (manual E). If STREAM is NIL, return the line as a string."
  (format stream "~@[*~A* -> ~]~A~%"
          (ecase (message-kind message) (:error "ERROR") (:warning "WARNING") (:message nil))
          text))

(public error-display)
(defun error-display (&optional (stream *standard-output*))
  "Write all queued messages to STREAM, the oldest first, and flush the queue. A STREAM of NIL or T
means standard output. In a run of several robots, messages about a command begin with its robot's
name. If FLUSH-ALL-ERRORS* is true, flush the queue without writing. Return nothing (manual 3.7,
reading 207). Signals WRONG-ARGUMENT, and keeps the messages, if STREAM is no stream."
  (check-argument error-display stream (typep stream '(or stream boolean)) "a stream")
  (let ((messages (take-messages))
        (stream (if (streamp stream) stream *standard-output*)))
    (unless flush-all-errors*
      (dolist (message messages)
        (write-message message stream (text-with-robot message)))
      (finish-output stream)))
  (values))
