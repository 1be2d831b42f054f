;;;; noting.lisp -- what goes into the journal of a run: its beginning, what is asked, its end.

(in-package :ars-magna.run)

(export '(remark unremark note begin-journal end-of-journal))

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

(defun follow-settings (simulation)
  "Let the journal of SIMULATION know which parameters somebody has set."
  (follow-parameters (simulation-known-parameters simulation)
                     (and (simulation-thread simulation) t)
                     (lambda (symbol value)
                       (note simulation 'parameter (list (string-downcase symbol) value))))
  (when (and (eq simulation *simulation*)
             (not (eq *noise-before-cleaning* (simulation-known-noise simulation))))
    (note-cleaning simulation)))

(defun note-cleaning (simulation)
  "Let the journal of SIMULATION know what DIRTY-SIMULATION would restore there now."
  (setf (simulation-known-noise simulation) *noise-before-cleaning*)
  (note simulation 'cleaning (list (loop for (symbol value) in *noise-before-cleaning*
                                         collect (list (string-downcase symbol) value)))))

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
                            :parameters (loop for (symbol value) in (parameter-settings)
                                              collect (list (string-downcase symbol) value))
                            :definitions (definitions-of simulation)))))

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
