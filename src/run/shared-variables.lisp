;;;; shared-variables.lisp -- warning of global variables that forks share with the original run.

(in-package :ars-magna.run)

(export '(share-warnings))

;;; A run and its forks share a record. So a warning appears once, where users read it, and not in
;;; each of the forks that a plan makes to look ahead.

(define-record (warning-record (:constructor make-warning-record (queue)))
  "The record of warnings about global variables, shared by a run and its forks."
  (queue nil message-queue "the message queue of the original run")
  (names '() list "the variables that warnings have named" :writable))

(define-shared-types warning-record)

(defun share-warnings (simulation fork)
  "Make FORK, a new fork of SIMULATION, share the record of warnings about variables."
  (setf (simulation-shared-warnings fork)
        (or (simulation-shared-warnings simulation)
            (setf (simulation-shared-warnings simulation)
                  (make-warning-record (simulation-messages simulation))))))

(defun note-name (name record)
  "Add NAME to the names in RECORD, which threads share. Return false if it is there already."
  (loop for names = (warning-record-names record)
        when (member name names :test #'eq) return nil
        when (swap-if-eq (warning-record-names record) names (cons name names)) return t))

(defun warn-of-shared-variable (name)
  "Warn once, in the original run, if this code runs in a fork: it has set the special variable
NAME. While REWIND repeats a run there is no warning, since the variable may be meant for it."
  (let ((simulation *simulation*))
    (when (and simulation
               (fork-p simulation)
               (not (eq *repeated-timeline* (simulation-timeline simulation))))
      (let ((record (simulation-shared-warnings simulation)))
        (when (and record (note-name name record))
          (let ((*message-queue* (warning-record-queue record)))
            (queue-notable-warning
             (format nil "A plan or continuation in a fork of this run has set ~(~A~), a variable ~
                          that all runs share. Define it by (define-run-variable ~:*~(~A~) ...), ~
                          so that each run has its own value."
                     name))))))))

(add-listener *assignment-hooks* warn-of-shared-variable)
