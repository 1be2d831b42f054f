;;;; why.lisp -- explaining in sentences how something got where it is.

(in-package :ars-magna.rpl.seeing)

(export '(reasons))

;;; Effects follow their causes in the trace at once: a wake-up is due to the last change before it
;;; of what was waited for, the end of a wait for parts to the last part that ended.

(defparameter *longest-chain* 12 "How many steps of a task's history WHY tells at most.")

(defun quoted (form) (form-text form 60))

(defun at-words (entry)
  "Return where the task of ENTRY was, as words to follow others; none if it had not begun."
  (if (trace-entry-form entry)
      (format nil " at ~A" (quoted (trace-entry-form entry)))
      ""))

(defun blocked-then-p (number index trace)
  "True if the task NUMBER, or one that it is part of, was blocked at entry INDEX of TRACE."
  (loop for start in (ancestry number trace)
        for last = (find-if (lambda (entry)
                              (and (= (trace-entry-task start) (trace-entry-task entry))
                                   (member (trace-entry-event entry) '(:block :unblock))))
                            trace :from-end t :end index)
        thereis (and last (eq :block (trace-entry-event last)))))

(defun earlier (trace index test)
  "Return the last entry of TRACE before INDEX, in the same tick, of which TEST is true, or NIL."
  (loop with tick = (trace-entry-tick (aref trace index))
        for i from (1- index) downto 0
        for entry = (aref trace i)
        while (= tick (trace-entry-tick entry))
        when (funcall test entry) return entry))

(defun part-ended-p (entry number trace)
  (and (member (trace-entry-event entry) '(:succeed :fail :evaporate))
       (eql number (trace-entry-value (start-of (trace-entry-task entry) trace)))))

;;; Agents.

(defun issue-words (issue trace)
  (let ((entry (find issue trace :key #'trace-entry-subject)))
    (format nil "~A, which task ~D issued~@[ at tick ~D~]"
            (quoted (cons (issue-name issue) (issue-arguments issue)))
            (issue-task issue) (and entry (trace-entry-tick entry)))))

(defun agent-words (agent trace)
  (cond ((integerp agent)
         (format nil "task ~D, ~A" agent (task-words agent trace)))
        ((answer-p agent)
         (format nil "the answer~@[ ~S~] to ~A" (answer-error agent)
                 (issue-words (answer-issue agent) trace)))
        (t (agent-text agent))))

(defun task-words (number trace)
  (let ((start (start-of number trace)))
    (if (trace-entry-subject start)
        (format nil "~(~A~)" (trace-entry-subject start))
        (quoted (trace-entry-form start)))))

(defun change-words (entry trace)
  (format nil "~A was ~:[pulsed~;set to ~:*~A~] by ~A~@[, at ~A~]"
          (fluent-text (trace-entry-subject entry))
          (and (eq :set (trace-entry-event entry)) (form-text (trace-entry-value entry) 40))
          (agent-words (trace-entry-agent entry) trace)
          (and (trace-entry-form entry) (quoted (trace-entry-form entry)))))

;;; Causes.

(defun fluent-reason (fluent index trace)
  (let ((change (earlier trace index
                         (lambda (entry)
                           (and (member (trace-entry-event entry) '(:set :pulse))
                                (depends-p fluent (trace-entry-subject entry)))))))
    (if change
        (change-words change trace)
        (format nil "~A came true" (fluent-text fluent)))))

(defun part-words (end trace)
  (format nil "its part ~D, ~A, ~A" (trace-entry-task end)
          (task-words (trace-entry-task end) trace)
          (ecase (trace-entry-event end)
            (:succeed "succeeded")
            (:fail (format nil "failed (~A)" (cut (trace-entry-detail end) 100)))
            (:evaporate "evaporated"))))

(defun wake-reason (entry index trace)
  (let ((subject (trace-entry-subject entry)))
    (cond ((null subject)
           (let* ((number (trace-entry-task entry))
                  (end (earlier trace index (lambda (end) (part-ended-p end number trace)))))
             (if end (part-words end trace) "its turn had come")))
          ((realp subject) (format nil "tick ~D had come" subject))
          ((fluent-p subject) (fluent-reason subject index trace))
          ((equal "" subject) "what it had to come after was over")
          (t (format nil "it was given ~A by ~A" (trace-entry-detail entry)
                     (agent-words (trace-entry-agent entry) trace))))))

(defun end-reason (entry index trace)
  "Return why ENTRY, that its task evaporated or began to clean up, happened."
  (let* ((agent (trace-entry-agent entry))
         (other (and (integerp agent) (/= agent (trace-entry-task entry))))
         (end (and other
                   (earlier trace index
                            (lambda (entry)
                              (and (= agent (trace-entry-task entry))
                                   (member (trace-entry-event entry) '(:succeed :fail))))))))
    (cond (end (format nil "~A ~:[failed~;succeeded~]" (agent-words agent trace)
                       (eq :succeed (trace-entry-event end))))
          (other (format nil "~A ended it" (agent-words agent trace)))
          ((integerp agent) "it had cleaned up")
          (t (format nil "~A ended it" (agent-words agent trace))))))

;;; Sentences.

(defun wait-words (entry)
  (if (trace-entry-subject entry)
      (format nil "began to wait for ~A~A" (trace-entry-detail entry) (at-words entry))
      (format nil "began to wait for its parts, of ~A" (quoted (trace-entry-form entry)))))

(defun event-words (entry index trace)
  "Return what ENTRY, number INDEX of TRACE, says of its task, as the rest of a sentence; or NIL."
  (let ((form (quoted (trace-entry-form entry))))
    (case (trace-entry-event entry)
      (:wait (wait-words entry))
      (:wake (format nil "~:[went on~;could have gone on~]~A, ~2:*~:[~;but was blocked, ~]~*~
                          because ~A"
                     (blocked-then-p (trace-entry-task entry) index trace) (at-words entry)
                     (wake-reason entry index trace)))
      (:succeed (format nil "succeeded with ~A" (form-text (trace-entry-value entry) 60)))
      (:fail (format nil "ended by the failure: ~A" (cut (trace-entry-detail entry) 200)))
      (:failure (format nil "failed at ~A: ~A" form (cut (trace-entry-detail entry) 200)))
      (:evaporate (format nil "evaporated, because ~A" (end-reason entry index trace)))
      (:clean (format nil "began to clean up at ~A, because ~A" form
                      (if (eql (trace-entry-agent entry) (trace-entry-task entry))
                          "it had come to that"
                          (end-reason entry index trace))))
      (:cleaned "had cleaned up")
      (:command (format nil "issued ~A" (trace-entry-detail entry)))
      (:block (format nil "was blocked by ~A" (agent-words (trace-entry-agent entry) trace)))
      (:unblock "was blocked no longer"))))

;; A construct that is decided while some parts are still to evaporate ends without a wake-up.
(defun decision-sentence (entry start end trace)
  (let ((part (find-if (lambda (end)
                         (and (member (trace-entry-event end) '(:succeed :fail))
                              (part-ended-p end (trace-entry-task entry) trace)))
                       trace :start start :end end)))
    (and part
         (format nil "At tick ~D it was done with ~A, because ~A." (trace-entry-tick part)
                 (quoted (trace-entry-form entry)) (part-words part trace)))))

(defun own-sentences (number trace)
  "Return what happened to the task NUMBER of TRACE after its start, the newest first."
  (let ((sentences '()) (parts-wait nil) (since 0))
    (loop for entry across trace
          for index from 0
          for event = (trace-entry-event entry)
          for words = (and (= number (trace-entry-task entry)) (event-words entry index trace))
          when words
            do (when (and parts-wait (not (member event '(:wake :evaporate :block :unblock))))
                 (push (decision-sentence parts-wait since index trace) sentences))
               (push (format nil "At tick ~D it ~A." (trace-entry-tick entry) words) sentences)
               (unless (member event '(:block :unblock))
                 (setf parts-wait (and (eq :wait event) (null (trace-entry-subject entry)) entry)
                       since index)))
    (remove nil sentences)))

(defun start-sentence (start trace)
  (let ((number (trace-entry-task start)) (parent (trace-entry-value start)))
    (if parent
        (format nil "Task ~D, ~A, was started at tick ~D as a part of task ~D, ~A."
                number (task-words number trace) (trace-entry-tick start) parent
                (task-words parent trace))
        (format nil "Task ~D is the plan ~A, started at tick ~D by ~A."
                number (task-words number trace) (trace-entry-tick start)
                (agent-words (trace-entry-agent start) trace)))))

(defun shortened (sentences)
  (let ((more (- (length sentences) *longest-chain*)))
    (if (plusp more)
        (append (subseq sentences 0 *longest-chain*)
                (list (format nil "Before that, ~D more things happened to it; ~
                                   TASK-HISTORY has them."
                              more)))
        sentences)))

(defgeneric reasons (subject runner)
  (:documentation "Return a list of sentences that say what brought SUBJECT where it is; RUNNER, if
not NIL, has the tasks that are meant.")
  (:method (subject runner)
    (declare (ignore runner))
    (reject-argument 'why 'subject subject
                     (format nil "a robot, its name or a part of one, for the command that failed ~
                                  last; a task, or its number; or nothing"))))

(defun task-reasons (which runner)
  (multiple-value-bind (trace number) (trace-to-read which runner)
    (start-of number trace)             ; or there is none
    (append (shortened (own-sentences number trace))
            (loop for start in (ancestry number trace) collect (start-sentence start trace)))))

(defmethod reasons ((task task) runner)
  (task-reasons task runner))

(defmethod reasons ((number integer) runner)
  (if (plusp number) (task-reasons number runner) (call-next-method)))

;; The first argument may be left out before keywords, so the arguments are one list.
(addition why)
(defun why (&rest arguments)
  "Write to :STREAM (default *STANDARD-OUTPUT*), in sentences, why something is as it is. Return
nothing.
  \(why), (why ROBOT), or its name or a part of it: which command failed or was interrupted last,
what was asked for, when and by whom, its error code, what that means and what to try.
  \(why TASK), or its number: how a task of a plan, perhaps over, got where it is. Events come
newest first: which fluent woke it and which task set that, and how it and the tasks around it were
started. :RUNNER names the plan runner if there are several. Needs a trace: see *TRACE-PLANS*.
Signals MISUSE if no trace was kept; UNKNOWN-NAME and WRONG-ARGUMENT."
  (multiple-value-bind (subject options)
      (if (keywordp (first arguments))
          (values nil arguments)
          (values (first arguments) (rest arguments)))
    (destructuring-bind (&key runner (stream *standard-output*)) options
      (format stream "~{~A~%~}" (reasons subject runner))
      (values))))

(show-lambda-list 'why '(&optional subject &key runner (stream *standard-output*)) #'why)
