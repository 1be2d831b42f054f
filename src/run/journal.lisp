;;;; journal.lisp -- the requests to a run and their ticks, so that it can be repeated exactly.

(in-package :ars-magna.run)

(export '(journal remark unremark note begin-journal end-of-journal))

;;; A journal is a header, entries (tick operator argument ...) in the order in which they took
;;; effect, and the tick at which it ended. An operator is a name that DEFINE-OPERATOR has
;;; defined; robots, parts, things and designators stand in an entry as lists that name them (see
;;; references.lisp). What commands do is not in it, and need not be: a run is a function of what
;;; is.

(addition *journal-limit*)
(defparameter *journal-limit* 1000000
  "How many entries a journal holds at most (about 200 bytes each). One that is full says so, and
repeats the run up to there.")

(addition journal-p)
(define-record (journal (:constructor make-journal (header)))
  "The record of one run."
  (header '() list "the plist with which the run began: map, robots, seed, parameters, and what the
definitions were that decide it" :writable :addition)
  (newest-first '() list "its entries, the newest first" :writable)
  (length 0 fixnum "how many entries the journal has" :writable :addition)
  (end 0 tick-count "the tick at which the journal ends" :writable :addition)
  (remarks '() list "lists (tick kind text robot x y), the newest first: what is told of the run
that a replay cannot know. ROBOT is a name, a string, or NIL" :writable :export)
  (full-p nil boolean "there was something to note and no room for it" :writable))

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
  "Return a journal that is like JOURNAL, of a run that has come to TICK, and goes on by itself."
  (let ((copy (copy-structure journal)))
    (setf (journal-header copy) (copy-list (journal-header journal)))
    (unless (journal-full-p copy) (setf (journal-end copy) tick))
    copy))

(defun truncated-journal (journal tick)
  "Return a journal that ends at TICK and until then is like JOURNAL. Signals WRONG-ARGUMENT for a
TICK that it does not reach."
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

;;;; Noting what is asked

(defun close-full-journal (journal tick)
  "Let JOURNAL end at TICK, and say so."
  (setf (journal-full-p journal) t
        (journal-end journal) tick)
  (warn-notably (format nil "The journal is full: with ~D entries it ends at tick ~D. The run goes ~
                            on, and can be repeated up to there; see *JOURNAL-LIMIT*."
                       (journal-length journal) tick)))

(defun room-left-p (journal)
  "True if JOURNAL may have another entry. A limit that is no number does not count."
  (not (and (finite-p *journal-limit*)
            (>= (journal-length journal) *journal-limit*))))

(defun add-entry (journal tick entry)
  "Enter ENTRY, a list of an operator and its arguments, into JOURNAL as of TICK, if there is room."
  (cond ((journal-full-p journal))
        ((not (room-left-p journal)) (close-full-journal journal tick))
        (t (push (cons tick entry) (journal-newest-first journal))
           (incf (journal-length journal))
           (setf (journal-end journal) tick))))

(defun lasting-arguments (arguments)
  "Return ARGUMENTS, which are externalized, to be kept: functions in them with the variables that
they see as these are now. See ARGUMENTS-AGAIN."
  (if (some #'functionp arguments) (memorized arguments) arguments))

(defun arguments-again (arguments simulation)
  "Return what LASTING-ARGUMENTS has returned for SIMULATION, a repetition of that run."
  (if (some #'functionp arguments) (recalled arguments simulation) arguments))

;; What the tick itself has asked for, as kickers and events do, it asks for again when repeated.
(defun note (simulation operator arguments &optional request)
  "Enter that OPERATOR, a symbol, was asked for with the list ARGUMENTS, by REQUEST if that is
given, into the journal of SIMULATION, as of now, if it keeps one, and into what it remembers of its
past."
  (when (noting-p simulation)
    (let ((arguments (externalize arguments)) (journal (simulation-journal simulation)))
      (when (and journal (not (and request (asked-inside-p request))))
        (add-entry journal (simulation-tick simulation)
                   (cons operator (lasting-arguments arguments))))
      (remember simulation operator arguments request))))

(defun settings-by-name (settings)
  "Return SETTINGS, lists (symbol value), with the names of the parameters as strings."
  (loop for (symbol value) in settings collect (list (string-downcase symbol) value)))

(defun settings-by-symbol (settings)
  "Return SETTINGS, lists (name value), with the symbols of the parameters."
  (loop for (name value) in settings
        collect (list (parameter-symbol (find-parameter name)) value)))

(defun follow-settings (simulation)
  "Let the journal of SIMULATION know which parameters somebody has set, and what DIRTY-SIMULATION
would restore now."
  (follow-parameters (simulation-known-parameters simulation)
                     (and (simulation-thread simulation) t)
                     (lambda (symbol value)
                       (note simulation 'parameter (list (string-downcase symbol) value))))
  (when (and (eq simulation *simulation*)
             (not (eq *noise-before-cleaning* (simulation-known-noise simulation))))
    (setf (simulation-known-noise simulation) *noise-before-cleaning*)
    (note simulation 'cleaning (list (settings-by-name *noise-before-cleaning*)))))

;;; Remarks. Plans and programs are not repeated in a replay; so what became of them is remarked, by
;;; whatever thread, for people to read. It changes nothing.

(define-constant +remark-limit+ 1000 :documentation "How many remarks a journal has at most.")
(define-constant +part-limit+ 500
  :documentation "How many remarks a journal has when no more of parts of plans are added: a plan
that tries again and again has many such, and others are to have room.")

(defun room-for-remark-p (journal kind)
  (< (length (journal-remarks journal)) (if (eq kind :part) +part-limit+ +remark-limit+)))

(defun remark (simulation kind text &optional robot)
  "Let the journal of SIMULATION, if it keeps one, say that something of KIND, a keyword, happened
now, of which TEXT tells, to ROBOT, if given. Return the remark, or NIL."
  (let ((journal (simulation-journal simulation)))
    (when (and journal (room-for-remark-p journal kind))
      (let ((remark (list (simulation-tick simulation) kind text
                          (and robot (qualified-name (robot-name robot)))
                          (and robot (robot-x robot)) (and robot (robot-y robot)))))
        (atomic-push remark (journal-remarks journal))
        remark))))

(defun unremark (simulation remark)
  "Let the journal of SIMULATION say no more what REMARK, as REMARK has returned it, says."
  (let ((journal (simulation-journal simulation)))
    (when journal
      (loop for remarks = (journal-remarks journal)
            until (swap-if (journal-remarks journal) remarks
                           (remove remark remarks :test #'eq))))))

(defun remark-error (text)
  "Let the journal of the run at work here, if any, tell of an error in users' code."
  (when *simulation*
    (let ((robots (simulation-robots *simulation*)))
      (remark *simulation* :error text (and (null (rest robots)) (first robots))))))

(attend *user-error-hooks* remark-error)

;;; Beginning and end.

(defun begin-journal (simulation)
  "Let SIMULATION keep a journal from now on, at its beginning. Return the journal."
  (setf (simulation-journal simulation)
        (make-journal (list :map (qualified-name
                                  (map-name (world-map (simulation-world simulation))))
                            :robots (robot-names simulation)
                            :seed (simulation-seed simulation)
                            :thinking (simulation-thinking simulation)
                            :parameters (settings-by-name (parameter-settings))
                            :definitions (definitions-of simulation)))))

(defun begin-thinking (simulation mode)
  "Let thinking in SIMULATION, which has passed no tick, cost from the beginning what MODE says."
  (set-timeline-thinking (simulation-timeline simulation) mode)
  (when (simulation-journal simulation)
    (setf (getf (journal-header (simulation-journal simulation)) :thinking)
          (simulation-thinking simulation))))

(defun renew-definitions (simulation)
  "Let the journal of SIMULATION, which has passed no tick, say what the definitions are now: until
then they may change."
  (let ((header (copy-list (journal-header (simulation-journal simulation)))))
    (setf (getf header :definitions) (definitions-of simulation)
          (journal-header (simulation-journal simulation)) header)))

(defun robot-names (simulation)
  (mapcar (lambda (robot) (qualified-name (robot-name robot))) (simulation-robots simulation)))

(defun end-of-journal (simulation)
  "Return the journal of SIMULATION, marked as reaching to now unless it was full before. Signals
MISUSE if it keeps none."
  (let ((journal (or (simulation-journal simulation)
                     (reject-use "This simulation keeps no journal. Ask for one: ~
                                  (with-simulation (ROBOT :journal t) ...), and do not say ~
                                  (simulator ROBOT :journal nil)."))))
    (when (eq simulation *simulation*) (follow-settings simulation))
    (unless (journal-full-p journal) (setf (journal-end journal) (simulation-tick simulation)))
    ;; Some may have been defined since it began.
    (let ((header (copy-list (journal-header journal))))
      (setf (getf header :robots) (robot-names simulation)
            (getf header :definitions) (merge-definitions (getf header :definitions)
                                                          (definitions-of simulation))
            (journal-header journal) header))
    journal))

;;;; Changes from outside

;;; A change is made and noted between ticks, by the thread that has the world in custody. Another
;;; thread takes custody first, or has the change made by the thread that has it; as the world may
;;; have changed by then, the arguments are checked again there. What a tick itself does, kickers
;;; included, is not noted, since a replay does it again. Nor is what is done to a world whose run
;;; is over.

(defun check-not-of-past-run (timeline operator)
  "Signal MISUSE if what OPERATOR is to change belongs to TIMELINE, which is over, and this code
works in another run."
  (let ((own (and *simulation* (timeline-of *simulation*))))
    (when (and own (timeline-over timeline) (not (eq own timeline)))
      (reject-outlived "~(~A~): that is of another run in ~(~A~), which is over: ~A. FIND-THING ~
                        and robots' names lead to those of the run at hand."
                       operator (timeline-name timeline) (timeline-over timeline)))))

(defun doubt-elsewhere (world operator)
  "Say once for WORLD if OPERATOR changes it, which is not that of the run at hand, and in which no
time passes."
  (let ((over (timeline-over (world-timeline world))))
    (cond (over
           (warn-once (list :past) world
                      (format nil "~(~A~) changes what nobody sees any more: the run in ~(~A~) is ~
                                   over, as ~A. What is there now is had from robots' names and ~
                                   FIND-THING."
                              operator (timeline-name (world-timeline world)) over)))
          ((and *simulation* (between-runs-p world))
           (warn-once (list :elsewhere) world
                      (format nil "~(~A~) changes ~(~A~) for a later run of (simulator ...), not ~
                                   for the run at hand. Inside of WITH-SIMULATION robots' names ~
                                   and (find-thing 'NAME) lead to what is in that."
                              operator (timeline-name (world-timeline world))))))))

(defun change-again (world operator arguments)
  "Do to WORLD, which this thread has in custody, what OPERATOR does with ARGUMENTS, if that makes
sense now."
  (let ((*world* world)
        (*simulation* (world-simulation world)))
    (apply (operator-function (find-operator operator)) arguments)))

(defmethod change-world ((timeline timeline) world function operator arguments)
  (check-own-run timeline)
  (check-not-of-past-run timeline operator)
  (unless (and *simulation* (eq timeline (timeline-of *simulation*)))
    (doubt-elsewhere world operator))
  (if (owner-p timeline)
      (deferring-interrupts
        (let ((simulation (world-simulation world)))
          (unless (simulation-over simulation)
            (note simulation operator arguments)))
        (writing (world) (funcall function)))
      (let ((by-itself-p (goes-on-in-forks-p)))
        (asking (timeline)
          (let ((*goes-on-in-forks-p* by-itself-p))
            (change-again world operator arguments))))))

(defmethod parameters-bound ((timeline timeline) world)
  (let ((simulation (world-simulation world)))
    (flet ((changed () (changed-parameters (simulation-known-parameters simulation))))
      (cond ((headless-p simulation) (and (eq simulation *simulation*) (changed)))
            ((and (live-p timeline) (not (owner-p timeline)))
             ;; Those that only this thread has bound.
             (remove-if (lambda (binding) (eql (cdr binding) (global-value (car binding))))
                        (changed)))))))
