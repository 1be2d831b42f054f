;;;; deeds.lisp -- the commands of plans that are under way, and what was answered to them.

(in-package :ars-magna.rpl-robot)

;;; A command that a plan has issued is a DEED until its last answer has been heard.

(defstruct (deed (:constructor make-deed (command resource outcome task cleanup-p issue tick))
                 (:copier nil))
  "That COMMAND is done on RESOURCE, as TASK (NIL: no plan) asked for at TICK, perhaps to clean up.
OUTCOME makes settings of an answer."
  (command nil :type command :read-only t)
  (resource nil :read-only t)
  (outcome nil :type function :read-only t)
  (task nil :type (or null task) :read-only t)
  (cleanup-p nil :read-only t)
  ;; What the trace knows of it, or NIL.
  (issue nil :read-only t)
  (tick 0 :type fixnum :read-only t)
  ;; By what the simulator knows it.
  (continuation nil :type (or null function))
  ;; It goes on in the background, as a track that has begun.
  (begun-p nil)
  ;; Plans have been told that it was interrupted.
  (told-p nil)
  ;; It has been answered for the last time.
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
  "True if DEED is under way, and nobody has been told that it is not."
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
  "Take ANSWER from those that are not yet heard, and with the last one its deed. True unless
somebody has done so before."
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
