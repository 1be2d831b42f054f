;;;; replay.lisp -- repeating a run from its journal, to the bit.

(in-package :ars-magna.run)

(export '(call-with-replay replaying changed-definitions-sentence resolve-journal))

(addition different-definitions replay-anyway)
(document-restarts
 'replay-anyway "Replay the journal although the definitions have changed since its recording.")
(define-condition different-definitions (ars-magna-error)
  ((definition-differences :initarg :differences :reader different-definitions-differences)
   (file :initarg :file :initform "journal" :reader different-definitions-file)
   (verb :initarg :verb :initform "replay" :reader different-definitions-verb))
  (:report (lambda (condition stream)
             (format stream "The definitions recorded in this ~A are not those that are loaded: ~
                             ~{~A~^; ~}. Load the recorded definitions; or ~A it anyway, with ~
                             :ANYWAY T, but then the run may differ."
                     (different-definitions-file condition)
                     (different-definitions-differences condition)
                     (different-definitions-verb condition))))
  (:documentation "Definitions recorded in a journal or saved run differ from those now loaded."))

(defun header-differences (header blueprints)
  "Return a list of texts about how the current definitions differ from those in HEADER. BLUEPRINTS
are the robots' blueprints. There is also a text for each robot that is now in another map."
  (append (definition-difference-texts (getf header :definitions))
          (loop with map = (find-map (getf header :map) nil)
                for blueprint in blueprints
                for other = (find-map (blueprint-map blueprint) nil)
                unless (eq map other)
                  collect (format nil "robot ~(~A~) is in another map, ~(~A~)"
                                  (blueprint-name blueprint) (and other (map-name other))))))

(defun check-definitions (header blueprints)
  "Signal DIFFERENT-DEFINITIONS (restart REPLAY-ANYWAY) if definitions in HEADER are not current."
  (let ((differences (header-differences header blueprints)))
    (when differences
      (restart-case (error 'different-definitions :differences differences)
        (replay-anyway ()
          :report "Replay it all the same.")))))

(defun changed-definitions-sentence (journal)
  "Return a sentence about JOURNAL if its definitions are not the current definitions; or NIL."
  (let ((header (journal-header journal)))
    (and (header-differences header (header-blueprints header))
         "The run is repeated with definitions that have changed since it was recorded.")))

;;; To repeat very many ticks without requests takes long, so it must be asked for.

(defconstant +most-empty-ticks+ 10000000
  "The most ticks without a journal entry that a replay passes if :UNTIL is not given.")

(defun check-empty-ticks (journal)
  "Signal MISUSE if more than +MOST-EMPTY-TICKS+ ticks pass between two entries of JOURNAL."
  (loop with before = 0
        for tick in (append (mapcar #'first (journal-entries journal))
                            (list (journal-end journal)))
        do (when (> (- tick before) +most-empty-ticks+)
             (reject-use "From tick ~D to tick ~D the journal has no entry; so many ticks may take ~
                          long. Say where to stop: (replay journal :until ~D), or :until ~D to ~
                          repeat the whole journal."
                         before tick before (journal-end journal)))
           (setf before tick)))

;;; Entries.

(defun entry-text (entry number)
  (format nil "entry ~D, ~(~A~) at tick ~D" number (second entry) (first entry)))

(defun perform-operator (name arguments simulation asker)
  "Call the operator NAME with the externalized ARGUMENTS, for ASKER, in the current SIMULATION."
  (let ((operator (find-operator name))
        (arguments (internalize arguments simulation))
        (*asker* asker))
    (check-operands operator arguments)
    (apply (operator-function operator) arguments)))

(defun perform-entry (entry number simulation)
  "Repeat the journal entry ENTRY, number NUMBER, in SIMULATION. Signals MISUSE if this fails."
  (destructuring-bind (tick name . arguments) entry
    (run-ticks (- tick (simulation-tick simulation)) simulation)
    (handler-case
        (perform-operator name (restored-arguments arguments simulation) simulation "the journal")
      (error (trouble)
        (reject-use "The journal cannot be replayed: its ~A has failed: ~A."
                    (entry-text entry number) (one-line-text trouble))))))

(defun perform-entries (entries number simulation)
  (loop for entry in entries
        for each from number
        do (perform-entry entry each simulation)))

(defun perform-journal (journal simulation beginning)
  "Repeat JOURNAL in SIMULATION. Call BEGINNING with SIMULATION before its first tick passes."
  (let* ((entries (journal-entries journal))
         (before (count 0 entries :key #'first))
         (*repeated-timeline* (simulation-timeline simulation)))
    (perform-entries (subseq entries 0 before) 1 simulation)
    (funcall beginning simulation)
    (perform-entries (nthcdr before entries) (1+ before) simulation)
    (run-ticks (- (journal-end journal) (simulation-tick simulation)) simulation)))

(defun settings-with-defaults (settings)
  "Return lists (name value), one for each parameter: its value in SETTINGS or else its default."
  (loop for parameter in (all-parameters)
        collect (or (find parameter settings :key (lambda (setting)
                                                    (find-parameter (first setting))))
                    (list (parameter-name parameter) (parameter-default parameter)))))

(defun read-journal-if-file (journal operator)
  (if (journal-p journal) journal (read-journal journal operator)))

(defun call-with-replay (function journal &key until anyway keep observer
                                            (beginning #'identity))
  "Call FUNCTION in a simulation in which JOURNAL has been repeated; see WITH-REPLAY. OBSERVER, if
given, is called with the simulation after each repeated tick. BEGINNING is called with the
simulation when the entries before the first tick have been repeated."
  (let* ((journal (read-journal-if-file journal 'with-replay))
         (journal (if (and until (not (eql until (journal-end journal))))
                      (truncated-journal journal until)
                      journal))
         (header (journal-header journal))
         (entries (header-entries header)))
    (unless anyway (check-definitions header (mapcar #'robot-entry-blueprint entries)))
    (unless until (check-empty-ticks journal))
    (call-with-simulation
     (lambda ()
       (let ((simulation (current-simulation)))
         (when observer (add-observer observer simulation))
         (perform-journal journal simulation beginning)
         ;; Messages of the repetition are not shown again.
         (take-unread-messages (simulation-messages simulation))
         (when observer (remove-observer observer simulation))
         (funcall function)))
     entries
     :variables (remove-if-not #'variable-name-p (journal-robot-names journal))
     :ghosts (getf header :ghosts) :seed (getf header :seed)
     :parameters (settings-with-defaults (getf header :parameters)) :journal t
     :keep keep :thinking (getf header :thinking :free))))

(addition with-replay)
(define-user-macro with-replay ((journal &key until anyway keep) &body body)
  "Run BODY in a fresh headless simulation in which JOURNAL (a journal or the name of its file) has
been repeated, up to the tick UNTIL or the end of JOURNAL. Robots and parameters are bound in BODY
as in WITH-SIMULATION. Return the values of BODY.
- BODY begins before any request or change that was made after the tick UNTIL, even by
  continuations.
- Commands are repeated without their continuations.
- If KEEP is true, the run keeps forks, so that it can be rewound, see KEEP-FORKS.
Signals DAMAGED-JOURNAL; WRONG-ARGUMENT if UNTIL is beyond the end; MISUSE if JOURNAL has ten
million ticks without an entry and UNTIL is not given; UNKNOWN-NAME if a definition is missing; and
DIFFERENT-DEFINITIONS if definitions have changed since the recording, unless ANYWAY is true."
  `(call-with-replay (lambda () ,@body) ,journal
                     :until ,until :anyway ,anyway :keep ,keep))

(defun call-replaying (function anyway)
  (handler-bind ((different-definitions (lambda (condition)
                                          (declare (ignore condition))
                                          (when anyway (invoke-restart 'replay-anyway)))))
    (funcall function)))

(defmacro replaying ((anyway) &body body)
  "Run BODY, which replays a journal. If ANYWAY is true, changed definitions are no error."
  `(call-replaying (lambda () ,@body) ,anyway))

(defun resolve-journal (journal operator)
  "Return the journal that JOURNAL means. JOURNAL, an argument of OPERATOR, is a journal, the name
of a file, or NIL for the journal of the current simulation up to now."
  (if journal
      (read-journal-if-file journal operator)
      (let ((simulation (current-simulation)))
        (asking (simulation) (journal-up-to-now simulation)))))

(addition replay)
(defun replay (journal &key until anyway)
  "Repeat JOURNAL as WITH-REPLAY does. Return the fresh headless simulation and its STATE-DIGEST."
  (with-replay ((read-journal-if-file journal 'replay) :until until :anyway anyway)
    (values (current-simulation) (state-digest))))

(addition save-journal)
(defun save-journal (file &optional (simulation (current-simulation)))
  "Write the journal of SIMULATION up to now to FILE, and return the truename of FILE. A journal
that is already in FILE is replaced. Signals MISUSE, for example if FILE exists but is not a
journal, and WRONG-ARGUMENT unless FILE is a file name; then FILE is unchanged."
  (check-argument save-journal file (typep file '(or string pathname)) "the name of a file")
  (check-kind-of-file file :journal "journal")
  (asking (simulation) (write-journal (journal-up-to-now simulation) file)))

(addition load-journal)
(defun load-journal (file)
  "Return the journal in FILE. Signals DAMAGED-JOURNAL if FILE does not contain a complete journal."
  (read-journal file 'load-journal))
