;;;; under-way.lisp -- commands of plans in progress, and how plans learn of their ends.

(in-package :ars-magna.rpl-robot)

;;; A command that a plan has issued is a DEED until its last answer has been applied.

(defstruct (deed (:constructor make-deed (command resource outcome task cleanup-p issue tick))
                 (:copier nil))
  "That COMMAND is done on RESOURCE, as TASK (NIL: no plan) asked for at TICK, perhaps to clean up.
OUTCOME makes settings of an answer."
  (command nil :type command :read-only t)
  (resource nil :read-only t)
  (outcome nil :type function :read-only t)
  (task nil :type (or null task) :read-only t)
  (cleanup-p nil :read-only t)
  ;; Its record in the trace, or NIL.
  (issue nil :read-only t)
  (tick 0 :type fixnum :read-only t)
  ;; Its identity in the simulator.
  (continuation nil :type (or null function))
  ;; It goes on in the background, as a track that has begun.
  (begun-p nil)
  ;; Plans have been told that it was interrupted.
  (told-p nil)
  ;; Its last answer has come.
  (over-p nil))

(defun deed-name (deed)
  (command-name (deed-command deed)))

(defstruct (answer (:constructor make-answer (deed err settings last-p)) (:copier nil))
  "SETTINGS that an answer to DEED with the error code ERR means, not yet heard."
  (deed nil :type deed :read-only t)
  (err nil :read-only t)
  (settings '() :type list :read-only t)
  (last-p nil :read-only t))

(defun add-deed (deed interface)
  (with-lock ((interface-deeds-lock interface))
    (setf (interface-deeds interface) (append (interface-deeds interface) (list deed))))
  deed)

(defun forget-deed (deed interface)
  (with-lock ((interface-deeds-lock interface))
    (removef (interface-deeds interface) deed)))

(defun deed-open-p (deed)
  "True if DEED is in progress, and its end was not reported."
  (not (or (deed-told-p deed) (deed-over-p deed))))

;;; Settings. (:error fluent code) sets a fluent as :SET does.

(defun plain-settings (settings)
  (loop for (kind . more) in settings
        collect (cons (if (eq kind :error) :set kind) more)))

;;; Answers.

(defun ends-p (command err)
  "True if an answer of COMMAND with the error code ERR is its last: a track that begins will end."
  (or err (not (trait-p :begins command))))

(defun add-answer (answer interface)
  (with-lock ((interface-deeds-lock interface))
    (setf (interface-answers interface) (append (interface-answers interface) (list answer)))))

(defun take-answer (answer interface)
  "Remove ANSWER from those not applied yet, and with the last one its deed. True unless another
thread has done so before."
  (with-lock ((interface-deeds-lock interface))
    (when (member answer (interface-answers interface))
      (removef (interface-answers interface) answer)
      (when (answer-last-p answer) (removef (interface-deeds interface) (answer-deed answer)))
      t)))

(defun ends-by-command-p (deed)
  "True if a new command on its resource interrupts DEED when it is issued: unless it takes no time,
and is carried out first, or goes on in the background."
  (not (or (deed-begun-p deed)
           (command-instant-p (deed-command deed)))))

;;; The simulator answers in its own thread. An answer, a list of settings of fluents, is applied
;;; between two reactions of plans. When a plan's command interrupts older ones on its resource,
;;; their answers are applied at once: those that have come in already, else :INTERRUPT. So a wait
;;; after a command gets the end of that command. The simulator's own later answer to an
;;; interrupted command sets only the fluents for the state of the robot: no error fluent, no pulse.

(defun note-pulses (interface deed settings)
  "Note which fluents SETTINGS, of the end of DEED of INTERFACE, pulse in this tick."
  (when (deed-task deed)
    (loop with plan = (task-serial (task-top (deed-task deed)))
          for (kind fluent) in settings
          for name = (and (eq :pulse kind) (fluent-name fluent))
          when name
            do (setf (interface-pulses interface)
                     (cons (list name plan (simulation-tick (interface-simulation interface)))
                           (remove name (interface-pulses interface)
                                   :key #'first :test #'equal))))))

(defmethod last-pulse ((interface interface) task fluent)
  (destructuring-bind (&optional name plan tick)
      (assoc (fluent-name fluent) (interface-pulses interface) :test #'equal)
    (and name (eql plan (task-serial (task-top task))) tick)))

(defun hear (answer interface)
  "Apply ANSWER, unless that was done. The caller holds the plans."
  (when (take-answer answer interface)
    (let ((deed (answer-deed answer)) (settings (answer-settings answer)))
      (setf (deed-begun-p deed) t)
      (note-unread interface deed (answer-err answer))
      (unless (deed-told-p deed) (note-pulses interface deed settings))
      (with-answer ((deed-issue deed) (answer-err answer))
        (apply-settings (if (deed-told-p deed)
                            ;; What the robot is or has.
                            (remove :set settings :key #'first :test-not #'eq)
                            (plain-settings settings)))))))

(defun post-answer (interface deed err results)
  "Post the answer to DEED, with ERR and RESULTS, to its plans. In the simulator's thread."
  (let ((settings '()))
    (in-any-case
      (setf settings (apply (deed-outcome deed) (deed-resource deed) err results))
      (let ((answer (make-answer deed err settings (ends-p (deed-command deed) err))))
        (add-answer answer interface)
        (post (interface-runner interface) (lambda () (hear answer interface)))
        (when (answer-last-p answer) (setf (deed-over-p deed) t))))))

(defun answering (interface deed)
  (setf (deed-continuation deed)
        (lambda (err resource &rest results)
          (declare (ignore resource))
          (post-answer interface deed err results))))

;;; Telling before the simulator does.

(defun tell-interrupted (deed)
  "Report to plans that DEED was interrupted, as soon as its task has reached its wait."
  (setf (deed-told-p deed) t)
  (tell-at-rest (deed-task deed)
                (lambda ()
                  (with-answer ((deed-issue deed) :interrupt)
                    (apply-settings (plain-settings
                                     (funcall (deed-outcome deed) (deed-resource deed)
                                              :interrupt)))))))

(defun hear-answers-on (resource interface except)
  (dolist (answer (interface-answers interface))
    (let ((deed (answer-deed answer)))
      (when (and (eq resource (deed-resource deed)) (not (eq deed except)))
        (tell-at-rest (deed-task deed) (lambda () (hear answer interface)))))))

(defun reacting-p (interface)
  (eq *runner* (interface-runner interface)))

(defun task-at-work (interface)
  (let ((task (and (reacting-p interface) (current-task))))
    (and task (eq :running (task-state task)) task)))

(defun take-over (interface resource &key except (test #'ends-by-command-p))
  "Report to plans that the deeds on RESOURCE, except EXCEPT, for which TEST is true, were ended by
the plan at work, if there is one."
  (when (reacting-p interface)
    (hear-answers-on resource interface except)
    (dolist (deed (interface-deeds interface))
      (when (and (eq resource (deed-resource deed))
                 (not (eq deed except))
                 (deed-open-p deed)
                 (funcall test deed))
        (tell-of-clash interface deed except)
        (tell-of-hurry interface deed except)
        (tell-interrupted deed)
        (count-takeover interface resource (deed-task deed) (task-at-work interface))))))

;;; Issuing.

(defun call-on-robot (interface function)
  "Call FUNCTION, which does something with the robot of INTERFACE. Should that be gone just now,
the plan at work ends; an error says no more than that."
  (handler-bind ((error (lambda (condition)
                          (declare (ignore condition))
                          (unless (interface-valid-p interface) (leave-plan)))))
    (funcall function)))

(defun issue-deed (interface command resource arguments outcome issue)
  "Issue COMMAND on RESOURCE; OUTCOME says what plans hear of its end. ISSUE is for the trace."
  (let* ((task (task-at-work interface))
         (cleanup-p (and task (some #'task-cleaning (lineage task)) t))
         (deed (make-deed command resource outcome task cleanup-p issue
                          (simulation-tick (interface-simulation interface))))
         (issued-p nil))
    (when (and task (not cleanup-p)) (count-command task command outcome resource))
    (add-deed deed interface)
    (in-any-case
      (progn (call-on-robot interface
                            (lambda ()
                              (apply (command-name command) resource
                                     (append arguments (list (answering interface deed))))))
             (setf issued-p t))
      (unless issued-p (forget-deed deed interface)))
    (take-over interface resource :except deed)))

(defun grab (interface resource)
  "Interrupt whatever goes on on RESOURCE, also what takes no time and in the background."
  (call-on-robot interface
                 (lambda () (grab-resource resource (interface-simulation interface))))
  (take-over interface resource :test (constantly t)))

;;; When a plan ends.

;; Another thread may end the run at any time, and the robot may be in another run by now: then the
;; end of the run has interrupted the command, or will.
(defun withdraw-deed (deed interface)
  "Have the command of DEED interrupted, unless the run of INTERFACE is over."
  (let ((simulation (interface-simulation interface)))
    (flet ((over-p ()
             (or (simulation-over simulation)
                 (not (eq simulation (robot-simulation (interface-robot interface)))))))
      (unless (over-p)
        (handler-case (withdraw-command (deed-resource deed) (deed-continuation deed))
          (misuse (condition) (unless (over-p) (error condition))))))))

;; What was issued to clean up is meant to last.
(defun interrupt-deeds (interface task)
  "Interrupt what the top-level TASK, which has not succeeded, has asked for and is under way."
  (dolist (deed (interface-deeds interface))
    (when (and (deed-open-p deed)
               (deed-task deed)
               (eq task (task-top (deed-task deed)))
               (not (deed-cleanup-p deed))
               (not (command-instant-p (deed-command deed))))
      (withdraw-deed deed interface)
      (tell-interrupted deed))))

;;; Fluents tell plans how their own commands end. What the prompt or a program has told the robot
;;; to do ends unheard, and a plan such as (whenever robot-stopped* ...) stays silent. Plans that
;;; wait once are named where that is said of all that wait in vain; see warnings.lisp.

(defun watcher-of-end (interface command)
  "Return a top-level task of INTERFACE, which this thread holds, that watches for the end of
commands of the robot such as COMMAND; or NIL."
  (let ((pulse (symbol-value (pulse-of-command command))))
    (find-if (lambda (task)
               (let ((parts (waiting-parts task)))
                 (and (some #'watches-p parts) (member pulse (fluents-awaited parts)))))
             (tasks-of interface))))

(defun tell-of-outside (interface command)
  (let ((task (call-with-plans-if-free (lambda () (watcher-of-end interface command)) interface)))
    (when task
      (tell-once interface (list :outside (task-label task))
                 "~(~A~) has ended. No plan has given it, so the plan ~A, which waits for ~A, does ~
                  not hear of it. Let a plan give it: ~A."
                 command (task-label task)
                 (fluent-text (symbol-value (pulse-of-command command)))
                 (twin-text command)))))

(defun look-for-outside (interface)
  (let* ((robot (interface-robot interface))
         (event (resource-event robot))
         (command (and (operation-p event)
                       (not (find robot (interface-deeds interface) :key #'deed-resource))
                       (command-name (operation-command event))))
         (before (shiftf (interface-outside interface) command)))
    (when (and before (null command) (pulse-of-command before) (tasks-of interface))
      (tell-of-outside interface before))))
