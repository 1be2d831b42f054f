;;;; journal.lisp -- recording the requests to a run, so that it can be repeated exactly.

(in-package :ars-magna.run)

(export '(journal add-remark remove-remark record-operation begin-journal journal-up-to-now))

;;; A journal is a header, entries (tick operator argument ...) in the order in which they took
;;; effect, and the tick at which it ended. An operator is a name defined by DEFINE-OPERATOR;
;;; robots, parts, things and designators are written as references (references.lisp). What commands
;;; do is not recorded: it follows from the journal.

(addition *journal-limit*)
(defparameter *journal-limit* 1000000
  "The largest number of entries of a journal, each of about 200 bytes. A warning says when a
journal becomes full. From then on it records nothing, and a replay ends at that tick.")

(addition journal-p)
(define-record (journal (:constructor make-journal (header)))
  "The record of the requests in one run, from which the run can be repeated."
  (header '() list "a plist of how the run began: map, robots, seed, parameters, and the definitions
that it depends on" :writable :addition)
  (newest-first '() list "the entries of the journal, the newest first" :writable)
  (length 0 fixnum "how many entries the journal has" :writable :addition)
  (end 0 tick-count "the tick at which the journal ends" :writable :addition)
  (remarks '() list "lists (tick kind text robot x y), the newest first: events of the run that a
replay does not repeat. ROBOT is a name, a string, or NIL" :writable :export)
  (full-p nil boolean "true if an entry was left out because the journal was full" :writable))

(defmethod print-object ((journal journal) stream)
  (print-unreadable-object (journal stream :type t)
    (format stream "~D entr~:@P, to tick ~D" (journal-length journal) (journal-end journal))))

(addition journal-entries)
(defun journal-entries (journal)
  "Return the entries (tick operator argument ...) of JOURNAL, oldest first; do not alter them.
Signals WRONG-ARGUMENT."
  (check-argument journal-entries journal (journal-p journal) "a journal, as LOAD-JOURNAL returns")
  (reverse (journal-newest-first journal)))

(defun copied-journal (journal tick)
  "Return a copy of JOURNAL, the journal of a run that has reached TICK."
  (let ((copy (copy-structure journal)))
    (setf (journal-header copy) (copy-list (journal-header journal)))
    (unless (journal-full-p copy) (setf (journal-end copy) tick))
    copy))

(defun truncated-journal (journal tick)
  "Return a copy of JOURNAL that ends at TICK. Signals WRONG-ARGUMENT if JOURNAL ends before TICK."
  (unless (typep tick `(integer 0 ,(journal-end journal)))
    (reject-argument "replay" "until" tick
                     (format nil "a tick of the journal, from 0 to ~D" (journal-end journal))))
  (let ((copy (make-journal (journal-header journal))))
    (setf (journal-newest-first copy)
          (remove-if (lambda (entry) (>= (first entry) tick)) (journal-newest-first journal))
          (journal-length copy) (length (journal-newest-first copy))
          (journal-remarks copy) (remove-if (lambda (remark) (> (first remark) tick))
                                            (journal-remarks journal))
          (journal-end copy) tick)
    copy))

;;;; Recording requests

(defun close-full-journal (journal tick)
  "End JOURNAL, which is full, at TICK, and queue a warning."
  (setf (journal-full-p journal) t
        (journal-end journal) tick)
  (queue-notable-warning
   (format nil "The journal is full: it has ~D entries and ends at tick ~D. The run goes on, but ~
                can be repeated only up to that tick; see *JOURNAL-LIMIT*."
           (journal-length journal) tick)))

(defun room-for-entry-p (journal)
  "True if JOURNAL has room for one more entry, or if *JOURNAL-LIMIT* is not a number."
  (not (and (finite-p *journal-limit*)
            (>= (journal-length journal) *journal-limit*))))

(defun add-entry (journal tick entry)
  "Add ENTRY, a list of an operator and its arguments, at TICK to JOURNAL, if there is room."
  (cond ((journal-full-p journal))
        ((not (room-for-entry-p journal)) (close-full-journal journal tick))
        (t (push (cons tick entry) (journal-newest-first journal))
           (incf (journal-length journal))
           (setf (journal-end journal) tick))))

(defun arguments-to-keep (arguments)
  "Return the externalized ARGUMENTS for a journal entry: functions are copied with the values that
they close over. See RESTORED-ARGUMENTS."
  (if (some #'functionp arguments) (memorize-arguments arguments) arguments))

(defun restored-arguments (arguments simulation)
  "Return the arguments in ARGUMENTS, a value of ARGUMENTS-TO-KEEP, for the replay SIMULATION."
  (if (some #'functionp arguments) (recall-arguments arguments simulation) arguments))

;; Requests made inside the tick, by kickers and events, are made again when it is repeated.
(defun record-operation (simulation operator arguments &optional request)
  "Record that OPERATOR, a symbol, is called with the list ARGUMENTS at the current tick, perhaps
for REQUEST. Record it in the journal and in the past of SIMULATION, if SIMULATION keeps them."
  (when (recording-p simulation)
    (let ((arguments (externalize arguments)) (journal (simulation-journal simulation)))
      (when (and journal (not (and request (requested-inside-tick-p request))))
        (add-entry journal (simulation-tick simulation)
                   (cons operator (arguments-to-keep arguments))))
      (record-act simulation operator arguments request))))

(defun settings-with-string-names (settings)
  "Return SETTINGS, lists (symbol value), as lists (name value) with strings as names."
  (loop for (symbol value) in settings collect (list (string-downcase symbol) value)))

(defun settings-with-symbols (settings)
  "Return SETTINGS, lists (name value), as lists (symbol value) with the parameters' symbols."
  (loop for (name value) in settings
        collect (list (parameter-symbol (find-parameter name)) value)))

(defun record-settings (simulation)
  "Record in the journal of SIMULATION the parameters that were set since the last call. If the
values that DIRTY-SIMULATION would restore have changed, record these, too."
  (synchronize-parameters (simulation-known-parameters simulation)
                          (and (simulation-thread simulation) t)
                          (lambda (symbol value)
                            (record-operation simulation 'parameter
                                              (list (string-downcase symbol) value))))
  (when (and (eq simulation *simulation*)
             (not (eq *noise-before-cleaning* (simulation-known-noise simulation))))
    (setf (simulation-known-noise simulation) *noise-before-cleaning*)
    (record-operation simulation 'cleaning
                      (list (settings-with-string-names *noise-before-cleaning*)))))

;;; Remarks. Plans and programs are not repeated in a replay. So the journal has remarks about them
;;; for users, made by any thread. They do not affect the replay.

(define-constant +remark-limit+ 1000 :documentation "The largest number of remarks in a journal.")
(define-constant +part-limit+ 500
  :documentation "A journal with this many remarks gets no more remarks about parts of plans. A plan
that retries makes many of them, and would leave no room for other remarks.")

(defun room-for-remark-p (journal kind)
  (< (length (journal-remarks journal)) (if (eq kind :part) +part-limit+ +remark-limit+)))

(defun add-remark (simulation kind text &optional robot)
  "If SIMULATION keeps a journal, add a remark at the current tick: KIND is a keyword, TEXT a
string, and ROBOT the robot concerned, if any. Return the remark, or NIL."
  (let ((journal (simulation-journal simulation)))
    (when (and journal (room-for-remark-p journal kind))
      (let ((remark (list (simulation-tick simulation) kind text
                          (and robot (qualified-name (robot-name robot)))
                          (and robot (robot-x robot)) (and robot (robot-y robot)))))
        (atomic-push remark (journal-remarks journal))
        remark))))

(defun remove-remark (simulation remark)
  "Remove REMARK, a value of ADD-REMARK, from the journal of SIMULATION."
  (let ((journal (simulation-journal simulation)))
    (when journal
      (loop for remarks = (journal-remarks journal)
            until (swap-if-eq (journal-remarks journal) remarks
                              (remove remark remarks :test #'eq))))))

(defun add-error-remark (text)
  (when *simulation*
    (let ((robots (simulation-robots *simulation*)))
      (add-remark *simulation* :error text (and (null (rest robots)) (first robots))))))

(add-listener *user-error-hooks* add-error-remark)

;;; Beginning and end.

(defun begin-journal (simulation)
  "Make SIMULATION keep a journal. No tick of SIMULATION has passed yet. Return the journal."
  (setf (simulation-journal simulation)
        (make-journal
         `(:map ,(qualified-name (map-name (world-map (simulation-world simulation))))
           ,@(robots-for-header simulation)
           :seed ,(simulation-seed simulation)
           :thinking ,(simulation-thinking simulation)
           :parameters ,(settings-with-string-names (non-default-parameters))
           :definitions ,(definitions-depended-on simulation)))))

(defun set-initial-thinking (simulation mode)
  "Set the thinking mode of SIMULATION and of its journal to MODE. No tick has passed yet."
  (set-timeline-thinking (simulation-timeline simulation) mode)
  (when (simulation-journal simulation)
    (setf (getf (journal-header (simulation-journal simulation)) :thinking)
          (simulation-thinking simulation))))

(defun update-journal-definitions (simulation)
  "Store the current definitions in the journal of SIMULATION, because definitions may have changed
since the journal was begun. No tick of SIMULATION has passed yet."
  (let* ((journal (simulation-journal simulation)) (header (copy-list (journal-header journal))))
    (setf (getf header :definitions) (definitions-depended-on simulation)
          (journal-header journal) header)
    (update-journal-ghosts simulation)))

(defun merge-journal-definitions (simulation)
  "Add the definitions that SIMULATION depends on now to its journal. Definitions may have changed
since the journal was begun."
  (let* ((journal (simulation-journal simulation)) (header (copy-list (journal-header journal))))
    (setf (getf header :definitions) (merge-definitions (getf header :definitions)
                                                        (definitions-depended-on simulation))
          (journal-header journal) header)))

(defun journal-up-to-now (simulation)
  "Return a copy of the journal of SIMULATION, up to the current tick unless the journal is full.
The copy does not grow when SIMULATION continues. Signals MISUSE if SIMULATION keeps no journal."
  (let ((journal (or (simulation-journal simulation)
                     (reject-use "This simulation keeps no journal. Start it with a journal: ~
                                  (with-simulation (ROBOT :journal t) ...), or (simulator ROBOT) ~
                                  without :journal nil."))))
    (when (eq simulation *simulation*) (record-settings simulation))
    (unless (journal-full-p journal) (setf (journal-end journal) (simulation-tick simulation)))
    (merge-journal-definitions simulation)
    (copied-journal journal (simulation-tick simulation))))

;;;; Changes from outside

;;; A change is made and recorded between ticks, by the owner of the world. Another thread takes
;;; custody first, or has the owner make the change. As the world may have changed by then, the
;;; arguments are checked again there. Changes inside a tick, as by kickers, are not recorded, since
;;; a replay repeats them. Nor are changes of a world whose run is over.

(defun check-not-of-past-run (timeline operator)
  "Signal MISUSE if the run of TIMELINE is over, and OPERATOR changes its world from another run."
  (let ((own (and *simulation* (timeline-of *simulation*))))
    (when (and own (timeline-over timeline) (not (eq own timeline)))
      (reject-finished-run "~(~A~): this object belongs to another run in ~(~A~), which is over: ~
                            ~A. FIND-THING and robots' names return the objects of the current run."
                           operator (timeline-name timeline) (timeline-over timeline)))))

(defun warn-of-change-elsewhere (world operator)
  "OPERATOR changes WORLD. Warn once for WORLD if its run is over, or if WORLD is between two runs
and this code works in another run."
  (let ((over (timeline-over (world-timeline world))))
    (cond (over
           (warn-once (list :past) world
                      (format nil "~(~A~) changes an object of a past run: the run in ~(~A~) is ~
                                   over because ~A. Robots' names and FIND-THING return the ~
                                   current objects."
                              operator (timeline-name (world-timeline world)) over)))
          ((and *simulation* (between-runs-p world))
           (warn-once (list :elsewhere) world
                      (format nil "~(~A~) changes ~(~A~) for a later run of (simulator ...), not ~
                                   for the current run. Inside WITH-SIMULATION, robots' names and ~
                                   (find-thing 'NAME) return the objects of the current run."
                              operator (timeline-name (world-timeline world))))))))

(defun perform-change (world operator arguments)
  "Change WORLD, which this thread owns: call OPERATOR with ARGUMENTS. It checks ARGUMENTS again."
  (let ((*world* world)
        (*simulation* (world-simulation world)))
    (apply (operator-function (find-operator operator)) arguments)))

(defmethod change-world ((timeline timeline) world function operator arguments)
  (check-own-run timeline)
  (check-not-of-past-run timeline operator)
  (unless (and *simulation* (eq timeline (timeline-of *simulation*)))
    (warn-of-change-elsewhere world operator))
  (if (owner-p timeline)
      (deferring-interrupts
        (let ((simulation (world-simulation world)))
          (unless (simulation-over simulation)
            (record-operation simulation operator arguments)))
        (permitting-changes (world) (funcall function)))
      (asking (timeline) (perform-change world operator arguments))))

(defmethod rebound-parameters ((timeline timeline) world)
  (let ((simulation (world-simulation world)))
    (flet ((changed () (parameters-changed-since (simulation-known-parameters simulation))))
      (cond ((headless-p simulation) (and (eq simulation *simulation*) (changed)))
            ((and (live-p timeline) (not (owner-p timeline)))
             ;; Return those that only this thread has bound.
             (remove-if (lambda (binding) (eql (cdr binding) (global-value (car binding))))
                        (changed)))))))
