;;;; saving.lisp -- saving the state of a run in a file.

(in-package :ars-magna.run)

;;; A saved run has lines of plain data like a journal's, with check sums: a head; the objects, see
;;; saved-values.lisp; the waiting requests; the journal, if the run keeps one; and the end.

(defconstant +saved-run-version+ 1)
(define-constant +saved-title+ ";;;; A run of ARS MAGNA, saved." :test #'string=
  :documentation "The first line of files that hold saved runs.")
(note-kind-of-file :run +saved-title+
                   (format nil "the file is a saved run; (load-simulation FILE) and ~
                                (with-loaded-simulation (FILE) ...) load it"))

;;; Contents that cannot be saved, and may be left out.

(addition unsavable unsavable-parts save-without)
(document-restarts
 'save-without "Save the run without the parts that cannot be saved; the error names them.")
(define-condition unsavable (ars-magna-error)
  ((name  :initarg :name  :reader unsavable-name)
   (parts :initarg :parts :reader unsavable-parts))
  (:report (lambda (condition stream)
             (format stream "The run in ~(~A~) cannot be saved completely: ~{~A~^; ~}. Wait until ~
                             plans and events are over, or use the restart SAVE-WITHOUT to leave ~
                             these parts out; a journal that has such parts is left out completely."
                     (unsavable-name condition) (unsavable-parts condition))))
  (:documentation "A run cannot be saved completely, because of parts such as plans in progress."))

(setf (documentation 'unsavable-parts 'function)
      "Return the parts that an UNSAVABLE condition names, a list of strings.")

(defun holds-function-p (request)
  "True if REQUEST contains a user's function."
  (typecase request
    (scheduled t)
    (withdrawal (withdrawal-continuation request))))

(defun waiting-requests (simulation)
  (reverse (timeline-inbox (simulation-timeline simulation))))

(defun waiting-events (simulation)
  (pending-events (simulation-agenda simulation)))

(defun unsavable-texts (simulation journal)
  (append (loop for text in (unfinished-work-texts simulation)
                collect (format nil "~A is under way" text))
          (loop for event in (waiting-events simulation)
                when (holds-function-p event)
                  collect (format nil "an event of SCHEDULE waits for tick ~D" (event-time event)))
          (loop for request in (waiting-requests simulation)
                when (holds-function-p request)
                  collect (if (typep request 'scheduled)
                              "an event of SCHEDULE was requested"
                              "a command was withdrawn by a plan"))
          (and journal
               (some (lambda (entry) (unprintable-in (cddr entry))) (journal-entries journal))
               (list "its journal has entries with functions in them, as those of PUT-KICKER"))))

(defun copy-without-unsavable-parts (simulation)
  (let* ((copy (copy-without-participants simulation)) (timeline (simulation-timeline copy)))
    (dolist (event (waiting-events copy))
      (when (holds-function-p event) (cancel-event (timeline-agenda timeline) event)))
    (setf (timeline-inbox timeline) (remove-if #'holds-function-p (timeline-inbox timeline)))
    copy))

(defun call-with-savable-run (function simulation without-p)
  "Call FUNCTION with SIMULATION and its journal. If either has parts that cannot be saved, leave
these parts out if WITHOUT-P is true; otherwise signal UNSAVABLE."
  (let* ((journal (and (simulation-journal simulation) (journal-up-to-now simulation)))
         (texts (unsavable-texts simulation journal)))
    (cond ((null texts) (funcall function simulation journal))
          (without-p
           (funcall function (copy-without-unsavable-parts simulation)
                    (and journal (notany #'unprintable-in (journal-entries journal)) journal)))
          (t (error 'unsavable :name (simulation-name simulation) :parts texts)))))

;;; Writing.

(defun settings-of (simulation)
  (loop for parameter in (all-parameters)
        for value across (simulation-known-parameters simulation)
        collect (list (parameter-name parameter) value)))

(defun user-commands-in-progress (simulation)
  "Return the users' commands in progress or waiting in SIMULATION, in the form of definitions."
  (loop for request in (append (waiting-events simulation) (waiting-requests simulation))
        for command = (request-operator request)
        for entry = (and (command-p command) (lookup-entry (command-name command) *commands*))
        when (and entry (users-entry-p entry))
          collect (definition-of-entry :command entry)))

(defun program-state-for-head (simulation)
  "Return what the head of a saved run says about programs in SIMULATION: the noise that
DIRTY-SIMULATION would restore, and the dice of CL:RANDOM. For a live run there are no dice, because
each of its threads has its own."
  (let ((dice (and (headless-p simulation)
                   (cdr (assoc *random-state-variable* (environment-of simulation))))))
    (list* :noise
           (and (eq simulation *simulation*) (settings-with-string-names *noise-before-cleaning*))
           (and dice (list :dice (random-state-numbers dice))))))

(defun saved-run-head (simulation programs journal)
  "Return the head of the file for SIMULATION. PROGRAMS is a value of PROGRAM-STATE-FOR-HEAD."
  (let ((used (append (definitions-depended-on simulation)
                      (current-definitions (user-commands-in-progress simulation)))))
    (list* :map (qualified-name (map-name (world-map (simulation-world simulation))))
           (append
            (robots-for-header simulation)
            (list* :tick (simulation-tick simulation)
                   :digest (state-digest simulation)
                   :kickers-old-p (/= *kicker-generation*
                                      (world-kicker-generation (simulation-world simulation)))
                   :parameters (settings-of simulation)
                   :journal (and journal t)
                   :definitions (remove-duplicates used :test #'same-definition-p :from-end t)
                   programs)))))

(defun write-saved-run (simulation journal programs out)
  "Write SIMULATION and any JOURNAL of it to OUT. PROGRAMS is a value of PROGRAM-STATE-FOR-HEAD."
  (let* ((requests (waiting-requests simulation))
         (inventory (take-inventory simulation requests))
         (sum 0))
    (flet ((seal (text) (setf sum (write-checksummed-line text sum out))))
      (write-line +saved-title+ out)
      (seal (datum-text (list :ars-magna-run +saved-run-version+
                              (saved-run-head simulation programs journal))))
      (write-inventory-lines inventory #'seal)
      (with-plain-syntax
        (dolist (request requests)
          (seal (format nil "(waiting @~D)" (object-number request inventory)))))
      (seal (datum-text '(:waiting)))
      (when journal
        (seal (datum-text (list :journal (journal-full-p journal) (journal-end journal)
                                (journal-header journal))))
        (dolist (entry (journal-entries journal)) (seal (datum-text (entry-datum entry)))))
      (seal (datum-text (list :end (simulation-tick simulation)))))))

;;; Files. A new file is loaded on trial first, so saving refuses what loading would refuse.

(defun check-loadable (path name)
  "Signal MISUSE unless the run NAME that is saved in the file PATH can be loaded."
  (handler-case (read-simulation path)
    ((or damaged-simulation unknown-name) (trouble)
      (reject-use "The run in ~(~A~) cannot be saved, because the written file could not be loaded ~
                   again: ~A. An older file is unchanged. (simulator ROBOT) starts a run that can ~
                   be saved."
                  name (damage-reason trouble)))))

(defun write-simulation (simulation file without-p)
  "Write SIMULATION, which is between ticks, to FILE. If WITHOUT-P is true, leave out the parts that
cannot be saved. Return the truename of FILE."
  (when (simulation-inside-tick-p simulation)
    (reject-use "save-simulation: a tick is under way. Save the run between ticks."))
  (check-not-over simulation 'save-simulation)
  (unless (simulation-robots simulation)
    (reject-use "save-simulation: all robots have left this run, so that nothing can go on in it. ~
                 (simulator ROBOT) starts another run."))
  (when (eq simulation *simulation*) (record-settings simulation))
  (record-progress-checked (simulation-world simulation))
  (let ((programs (program-state-for-head simulation)))
    (prog1 (call-with-savable-run
            (lambda (simulation journal)
              (overwrite-file (lambda (out) (write-saved-run simulation journal programs out)) file
                              "the run" :kind :run
                              :check (lambda (path)
                                       (check-loadable path (simulation-name simulation)))))
            simulation without-p)
      (warn-of-ended-programs
       simulation "~A: the program that issued ~(~A~) is not in the saved run. Continuations ~
                   cannot be saved: begin the program again after loading."))))

;; The restart is established in the thread that saves the run: another thread may own the run.
(addition save-simulation)
(defun save-simulation (file &optional (simulation (current-simulation)))
  "Write the state of SIMULATION to FILE, between two ticks, so that LOAD-SIMULATION can continue
the run exactly. An existing FILE is replaced only after the new file has been written and loaded as
a check. Return the truename of FILE.
- Saved: world, things, kickers, robots and their parts, designators, tracks, odometers, commands in
  progress and requested commands, parameters, seed and dice, in a headless run also the dice of
  CL:RANDOM in its programs; and the journal, so that a replay still repeats the whole run.
- Left out: continuations of commands and tracks, because they belong to programs, with a warning;
  observers; messages.
Signals:
- UNSAVABLE, with the restart SAVE-WITHOUT, if plans or events of SCHEDULE are in progress or the
  journal contains functions
- MISUSE if the run is over or inside a tick, if it contains an object without a printed form, such
  as a kicker of PUT-KICKER, if the saved run could not be loaded again, or if FILE cannot be
  written, for example because it exists but is not a saved run
- WRONG-ARGUMENT unless FILE is a file name
After an error, FILE is unchanged."
  (check-argument save-simulation file (typep file '(or string pathname)) "the name of a file")
  (check-argument save-simulation simulation (simulation-p simulation) "a simulation")
  (check-kind-of-file file :run "saved run")
  (flet ((save (without-p)
           (asking (simulation) (write-simulation simulation file without-p))))
    (handler-case (save nil)
      (unsavable (condition)
        (restart-case (error condition)
          (save-without ()
            :report "Save the run without them."
            (save t)))))))
