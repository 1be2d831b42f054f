;;;; why.lisp -- explaining in sentences how something got where it is.

(in-package :ars-magna.rpl.seeing)

(export '(reasons asker-description issue-description))

;;; Effects follow their causes in the trace at once: a wake-up is due to the last change before it
;;; of what was waited for, the end of a wait for parts to the last part that ended.

(defparameter *why-event-limit* 12 "The largest number of steps of a history that WHY tells.")

(defun short-form-text (form) (form-text form 60))

(defun at-form-text (entry)
  "Return text for the end of a sentence: the expression at which the task of ENTRY was. Return an
empty string if the task had not begun."
  (if (trace-entry-form entry)
      (format nil " at ~A" (short-form-text (trace-entry-form entry)))
      ""))

(defun blocked-at-entry-p (number index trace)
  "True if the task NUMBER, or one that it is part of, was blocked at entry INDEX of TRACE."
  (loop for start in (ancestor-entries number trace)
        for last = (find-if (lambda (entry)
                              (and (= (trace-entry-task start) (trace-entry-task entry))
                                   (member (trace-entry-event entry) '(:block :unblock))))
                            trace :from-end t :end index)
        thereis (and last (eq :block (trace-entry-event last)))))

(defun earlier-entry (trace index test)
  "Return the last entry of TRACE before INDEX that is in the same tick and passes TEST, or NIL."
  (loop with tick = (trace-entry-tick (aref trace index))
        for i from (1- index) downto 0
        for entry = (aref trace i)
        while (= tick (trace-entry-tick entry))
        when (funcall test entry) return entry))

(defun part-ended-p (entry number trace)
  (and (member (trace-entry-event entry) '(:succeed :fail :evaporate))
       (eql number (trace-entry-value (start-entry (trace-entry-task entry) trace)))))

;;; Agents.

(defun issue-description (issue trace)
  "Return a text of ISSUE, a command in TRACE: the call, its task and its tick."
  (let ((entry (find issue trace :key #'trace-entry-subject)))
    (format nil "~A, which task ~D issued~@[ at tick ~D~]"
            (short-form-text (cons (issue-name issue) (issue-arguments issue)))
            (issue-task issue) (and entry (trace-entry-tick entry)))))

(defgeneric asker-description (asker trace)
  (:documentation "Return a text of ASKER, the cause of an event in TRACE, with what led to it.")
  (:method (asker trace)
    (if (answer-p asker)
        (format nil "the answer~@[ ~S~] to ~A" (answer-error asker)
                (issue-description (answer-issue asker) trace))
        (asker-text asker)))
  (:method ((asker integer) trace)
    (format nil "task ~D, ~A" asker (task-description asker trace))))

(defun task-description (number trace)
  (let ((start (start-entry number trace)))
    (if (trace-entry-subject start)
        (format nil "~(~A~)" (trace-entry-subject start))
        (short-form-text (trace-entry-form start)))))

(defun change-description (entry trace)
  (format nil "~A was ~:[pulsed~;set to ~:*~A~] by ~A~@[, at ~A~]"
          (fluent-text (trace-entry-subject entry))
          (and (eq :set (trace-entry-event entry)) (form-text (trace-entry-value entry) 40))
          (asker-description (trace-entry-asker entry) trace)
          (and (trace-entry-form entry) (short-form-text (trace-entry-form entry)))))

;;; Causes.

(defun fluent-reason (fluent index trace)
  (let ((change (earlier-entry trace index
                               (lambda (entry)
                                 (and (member (trace-entry-event entry) '(:set :pulse))
                                      (depends-p fluent (trace-entry-subject entry)))))))
    (if change
        (change-description change trace)
        (format nil "~A came true" (fluent-text fluent)))))

(defun part-end-description (end trace)
  (format nil "its part ~D, ~A, ~A" (trace-entry-task end)
          (task-description (trace-entry-task end) trace)
          (ecase (trace-entry-event end)
            (:succeed "succeeded")
            (:fail (format nil "failed (~A)" (cut (trace-entry-detail end) 100)))
            (:evaporate "evaporated"))))

(defun wake-reason (entry index trace)
  (let ((subject (trace-entry-subject entry)))
    (cond ((null subject)
           (let* ((number (trace-entry-task entry))
                  (end (earlier-entry trace index (lambda (end) (part-ended-p end number trace)))))
             (if end (part-end-description end trace) "its turn had come")))
          ((realp subject) (format nil "tick ~D had come" subject))
          ((fluent-p subject) (fluent-reason subject index trace))
          ((equal "" subject) "what it had to come after was over")
          (t (format nil "it was given ~A by ~A" (trace-entry-detail entry)
                     (asker-description (trace-entry-asker entry) trace))))))

(defun end-reason (entry index trace)
  "Return text that says why the task of ENTRY evaporated or began to clean up."
  (let* ((asker (trace-entry-asker entry))
         (other (and (integerp asker) (/= asker (trace-entry-task entry))))
         (end (and other
                   (earlier-entry trace index
                                  (lambda (entry)
                                    (and (= asker (trace-entry-task entry))
                                         (member (trace-entry-event entry) '(:succeed :fail))))))))
    (cond (end (format nil "~A ~:[failed~;succeeded~]" (asker-description asker trace)
                       (eq :succeed (trace-entry-event end))))
          (other (format nil "~A ended it" (asker-description asker trace)))
          ((integerp asker) "it had cleaned up")
          (t (format nil "~A ended it" (asker-description asker trace))))))

;;; Sentences.

(defun wait-description (entry)
  (if (trace-entry-subject entry)
      (format nil "began to wait for ~A~A" (trace-entry-detail entry) (at-form-text entry))
      (format nil "began to wait for its parts, of ~A" (short-form-text (trace-entry-form entry)))))

(defun event-description (entry index trace)
  "Return the rest of a sentence about the task of ENTRY, the entry number INDEX of TRACE; or NIL."
  (let ((form (short-form-text (trace-entry-form entry))))
    (case (trace-entry-event entry)
      (:wait (wait-description entry))
      (:wake (format nil "~:[went on~;could have gone on~]~A, ~2:*~:[~;but was blocked, ~]~*~
                          because ~A"
                     (blocked-at-entry-p (trace-entry-task entry) index trace) (at-form-text entry)
                     (wake-reason entry index trace)))
      (:succeed (format nil "succeeded with ~A" (form-text (trace-entry-value entry) 60)))
      (:fail (format nil "ended by the failure: ~A" (cut (trace-entry-detail entry) 200)))
      (:failure (format nil "failed at ~A: ~A" form (cut (trace-entry-detail entry) 200)))
      (:evaporate (format nil "evaporated, because ~A" (end-reason entry index trace)))
      (:clean (format nil "began to clean up at ~A, because ~A" form
                      (if (eql (trace-entry-asker entry) (trace-entry-task entry))
                          "it had reached that cleanup"
                          (end-reason entry index trace))))
      (:cleaned "had cleaned up")
      (:command (format nil "issued ~A" (trace-entry-detail entry)))
      (:block (format nil "was blocked by ~A" (asker-description (trace-entry-asker entry) trace)))
      (:unblock "was blocked no longer"))))

;; A construct that is decided while some parts are still to evaporate ends without a wake-up.
(defun decision-sentence (entry start end trace)
  (let ((part (find-if (lambda (end)
                         (and (member (trace-entry-event end) '(:succeed :fail))
                              (part-ended-p end (trace-entry-task entry) trace)))
                       trace :start start :end end)))
    (and part
         (format nil "At tick ~D it was done with ~A, because ~A." (trace-entry-tick part)
                 (short-form-text (trace-entry-form entry)) (part-end-description part trace)))))

(defun task-event-sentences (number trace)
  "Return sentences on the events of the task NUMBER of TRACE after its start, the newest first."
  (let ((sentences '()) (parts-wait nil) (since 0))
    (loop for entry across trace
          for index from 0
          for event = (trace-entry-event entry)
          for words = (and (= number (trace-entry-task entry))
                           (event-description entry index trace))
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
    (if (integerp parent)
        (format nil "Task ~D, ~A, was started at tick ~D as a part of task ~D, ~A."
                number (task-description number trace) (trace-entry-tick start) parent
                (task-description parent trace))
        (format nil "Task ~D is the plan ~A~@[ of ~A~], started at tick ~D by ~A."
                number (task-description number trace) parent (trace-entry-tick start)
                (asker-description (trace-entry-asker start) trace)))))

(defun shorten-sentences (sentences)
  (let ((more (- (length sentences) *why-event-limit*)))
    (if (plusp more)
        (append (subseq sentences 0 *why-event-limit*)
                (list (format nil "Before that, ~D more events happened to the task; TASK-HISTORY ~
                                   lists them."
                              more)))
        sentences)))

(defgeneric reasons (subject runner)
  (:documentation "Return a list of sentences that explain how SUBJECT got into its present state.
RUNNER, if not NIL, is the plan runner that has SUBJECT.")
  (:method (subject runner)
    (declare (ignore runner))
    (reject-argument 'why 'subject subject
                     (format nil "a robot, its name or a part of a robot, for the command that ~
                                  failed last; a task or its number; or no argument"))))

(defun task-reasons (which runner)
  (multiple-value-bind (trace number) (trace-to-read which runner)
    (start-entry number trace)          ; or there is none
    (append (shorten-sentences (task-event-sentences number trace))
            (loop for start in (ancestor-entries number trace)
                  collect (start-sentence start trace)))))

(defmethod reasons ((task task) runner)
  (task-reasons task runner))

(defmethod reasons ((number integer) runner)
  (if (plusp number) (task-reasons number runner) (call-next-method)))

;; The first argument may be left out before keywords, so the arguments are one list.
(addition why)
(defun why (&rest arguments)
  "Write to :STREAM (default *STANDARD-OUTPUT*) sentences that explain why a command failed, or how
a task got into its state. Return nothing.
  \(why), (why ROBOT), or the name or a part of a robot: which command failed or was interrupted
last, when and by whom it was issued, its error code, what the code means and what to try.
  \(why TASK), or the number of a task: how a task of a plan, perhaps over, got into its state.
Events come newest first: which fluent woke the task, which task set the fluent, and how the task
and the tasks around it were started. :RUNNER names the plan runner if there are several. Needs a
trace: see *TRACE-PLANS*. Signals MISUSE if no trace was kept; UNKNOWN-NAME and WRONG-ARGUMENT."
  (multiple-value-bind (subject options)
      (if (keywordp (first arguments))
          (values nil arguments)
          (values (first arguments) (rest arguments)))
    (destructuring-bind (&key runner (stream *standard-output*)) options
      (format stream "~{~A~%~}" (reasons subject runner))
      (values))))

(show-lambda-list 'why '(&optional subject &key runner (stream *standard-output*)) #'why)
