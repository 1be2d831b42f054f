;;;; loading.lisp -- loading a saved run.

(in-package :ars-magna.run)

(export '(call-with-loaded-simulation))

(addition load-anyway)
(document-restarts
 'load-anyway "Load the saved run although the definitions have changed since it was saved.")

;;; The head.

(defun check-saved-head (datum)
  "Signal an error unless DATUM, the first in a file, is the head of a saved run of this version."
  (unless (typep datum '(cons (eql :ars-magna-run) (cons t (cons t null))))
    (error "the file does not begin like a saved run"))
  (check-file-format (second datum) +saved-run-version+)
  (let* ((head (third datum))
         (trouble (or (header-error-text (if (plist-p head) (list* :seed 0 head) head))
                      (saved-run-head-error-text head))))
    (when trouble (error "the head makes no sense: ~A" trouble))
    (check-robots-of-header head)))

(defun saved-run-head-error-text (head)
  "Return a text about an error in HEAD that HEADER-ERROR-TEXT does not find, or NIL."
  (cond ((not (settings-p (getf head :noise))) "the noise in the head makes no sense")
        ((settings-error-text (getf head :noise)))
        ((not (or (null (getf head :dice)) (random-state-numbers-p (getf head :dice))))
         "the dice in the head make no sense")
        ((not (typep (getf head :tick) 'tick-count)) "the tick in the head is not a tick")
        ((not (typep (getf head :digest) '(unsigned-byte 64)))
         "the digest in the head is not a digest")))

;;; Lines. Their order is fixed, so the meaning of each is known.

(defstruct (line-reader (:constructor make-line-reader (in sum number)) (:copier nil))
  "A file that is being read: its stream IN, the check sum SUM so far, and the NUMBER of the line."
  (in nil :read-only t)
  (sum 0 :type (unsigned-byte 32))
  (number 0 :type fixnum))

(defun next-datum (reader)
  "Return the datum in the next line of READER. Signals an error for a damaged or missing line."
  (let ((line (or (next-data-line (line-reader-in reader))
                  (error "the end of the file is missing"))))
    (incf (line-reader-number reader))
    (multiple-value-bind (datum sum)
        (handler-case (checked-datum line (line-reader-sum reader))
          (error (trouble)
            (error "line ~D is damaged: ~A" (line-reader-number reader) (one-line-text trouble))))
      (setf (line-reader-sum reader) sum)
      datum)))

(defun tagged-p (tag datum)
  (and (consp datum) (eq tag (first datum)) (proper-list-p datum)))

(defun read-object-definitions (reader loader)
  "Read from READER which numbers mean which objects, and make these objects in LOADER."
  (loop for datum = (next-datum reader)
        until (tagged-p :objects datum)
        do (cond ((tagged-p :found datum) (add-external-object (rest datum) loader))
                 ((and (tagged-p :new datum) (<= 3 (length datum)))
                  (add-new-objects (second datum) (third datum) (nthcdr 3 datum) loader))
                 (t (error "the file does not define the numbers of its objects")))
        finally (unless (equal (rest datum) (list (1- (length (loader-objects loader)))))
                  (error "the file does not have as many objects as it says"))))

(defun read-object-contents (reader loader)
  "Read the contents of the objects in LOADER from READER. Return a list of the waiting requests."
  (let ((*numbered-objects* (loader-objects loader)))
    (loop until (all-objects-complete-p loader)
          do (process-contents-line (next-datum reader) loader))
    (fill-hash-tables loader)
    (loop for datum = (next-datum reader)
          do (unless (and (tagged-p :waiting datum) (<= (length datum) 2))
               (error "the list of waiting requests is missing"))
          while (rest datum)
          collect (second datum))))

(defun read-journal-entries (reader)
  "Return a list of the entries of the journal in READER, and the datum after the entries."
  (loop for datum = (next-datum reader)
        until (tagged-p :end datum)
        collect datum into entries
        finally (return (values entries datum))))

(defun saved-journal-from-data (datum entries)
  "Return the journal whose first line is DATUM, with ENTRIES."
  (unless (typep datum '(cons (eql :journal) (cons boolean (cons t (cons list null)))))
    (error "the journal in the file makes no sense"))
  (destructuring-bind (full-p end header) (rest datum)
    (let ((journal (journal-from-data
                    (append (list (list :ars-magna-journal +journal-version+ header))
                            entries
                            (list (list :end end))))))
      (setf (journal-full-p journal) full-p)
      journal)))

(defun read-saved-journal (reader head)
  "Return the journal in READER, a saved run with HEAD, or NIL if the run keeps no journal."
  (let ((first (and (getf head :journal) (next-datum reader)))
        (tick (getf head :tick)))
    (multiple-value-bind (entries end) (read-journal-entries reader)
      (unless (equal end (list :end tick))
        (error "the last line does not have the tick of the run"))
      (when (next-data-line (line-reader-in reader)) (error "the file goes on after its last line"))
      (when (and entries (null first)) (error "the file has journal entries, but no journal"))
      (let ((journal (and first (saved-journal-from-data first entries))))
        (when (and journal (not (if (journal-full-p journal)
                                    (<= (journal-end journal) tick)
                                    (= (journal-end journal) tick))))
          (error "the journal does not end at the tick of the run"))
        journal))))

;;; Putting the run together.

(defun only-object (type loader)
  "Return the only object of TYPE in LOADER. Signals an error unless there is exactly one."
  (let ((objects (remove-if-not (lambda (object) (typep object type)) (loader-objects loader))))
    (unless (= 1 (length objects))
      (error "the file has ~R objects of the kind ~(~A~), but a run has one" (length objects) type))
    (aref objects 0)))

(defun parameter-vector (values settings)
  "Return VALUES, the values in SETTINGS, as a vector in the order of the current parameters.
Parameters that are not in SETTINGS get their defaults."
  (unless (and (= (length values) (length settings))
               (every (lambda (value setting) (eql value (second setting))) values settings))
    (error "the parameters in the file contradict each other"))
  (map 'vector
       (lambda (parameter)
         (let ((setting (find (parameter-name parameter) settings
                              :key #'first :test #'string=)))
           (if setting (second setting) (parameter-default parameter))))
       (all-parameters)))

(defun check-objects (simulation requests)
  "Signal an error unless the objects of SIMULATION are consistent."
  (let ((world (simulation-world simulation)) (timeline (simulation-timeline simulation)))
    (must-hold (and world timeline (eq timeline (world-timeline world)))
               "the world does not belong to the timeline of the run")
    (check-world world)
    (must-hold (proper-list-p (world-robots world)) "the world's list of robots is circular")
    (must-hold (or (null (world-dice-names world))
                   (equal (world-roster world) (sorted-by-full-name (world-robots world))))
               "the world's robots are not in order")
    (dolist (robot (world-robots world)) (check-robot robot world))
    (check-run-variables world)
    (dolist (request requests)
      (check-request request)
      (let ((resource (resource-of-request request)))
        (must-hold (or (not (typep resource 'resource)) (eq timeline (timeline-of resource)))
                   "a request belongs to another run")))))

(defun resource-of-request (request)
  "Return the resource of REQUEST if REQUEST is an operation, otherwise its first argument."
  (if (operation-p request) (operation-resource request) (first (request-arguments request))))

(defun complete-loading (simulation head loader requests)
  "Make SIMULATION, loaded by LOADER, ready to continue, with REQUESTS waiting. Return SIMULATION."
  (let ((world (simulation-world simulation)) (timeline (simulation-timeline simulation)))
    (destructuring-bind (agenda tick . events) (loader-agenda loader)
      (unless (eq agenda (timeline-agenda timeline)) (error "the agenda does not belong to the ~
                                                             timeline of the run"))
      (check-commands timeline events)
      (must-hold (null (intersection events requests)) "a waiting request is in progress already")
      (fill-agenda agenda tick events))
    (check-objects simulation requests)
    (setf (timeline-inbox timeline) (reverse requests)
          (timeline-run timeline) simulation
          (simulation-messages simulation) (make-message-queue)
          (simulation-dice simulation) (and (getf head :dice)
                                            (random-state-of-numbers (getf head :dice)))
          (simulation-known-parameters simulation)
          (parameter-vector (simulation-known-parameters simulation) (getf head :parameters))
          (world-kicker-generation world) (- *kicker-generation*
                                             (if (getf head :kickers-old-p) 1 0)))
    simulation))

(defun simulation-from-lines (reader head octets)
  "Return the simulation in READER, a file of OCTETS octets. HEAD is its head, already read."
  (let ((loader (make-empty-loader octets)))
    (read-object-definitions reader loader)
    (let* ((requests (read-object-contents reader loader))
           (simulation (only-object 'simulation loader)))
      (only-object 'world loader)
      (only-object 'timeline loader)
      (setf (simulation-journal simulation) (read-saved-journal reader head))
      (complete-loading simulation head loader requests))))

(defun read-head (reader)
  (let ((datum (next-datum reader)))
    (check-saved-head datum)
    (third datum)))

;;; Loading. The head is read first, so that an error can name the definitions that are missing.

(defun read-saved-run-head (file)
  (reading-file (in file :run 'damaged-simulation) (read-head (make-line-reader in 0 0))))

(defun read-simulation (file)
  "Return the simulation that is saved in FILE. Signals DAMAGED-SIMULATION and UNKNOWN-NAME."
  (reading-file (in file :run 'damaged-simulation)
    (let* ((reader (make-line-reader in 0 0))
           (head (read-head reader))
           (simulation (progn
                         ;; Names that no definition has made.
                         (header-entries head)
                         (simulation-from-lines reader head (file-length in)))))
      (unless (= (getf head :tick) (simulation-tick simulation))
        (error "the tick of the run is not the tick in the head"))
      (unless (= (getf head :digest) (state-digest simulation))
        (error "the digest of the loaded run is not the digest in the head"))
      simulation)))

(defun check-saved-definitions (head)
  "Signal UNKNOWN-NAME if a robot in HEAD, the head of a saved run, is not defined. Signal
DIFFERENT-DEFINITIONS, with the restart LOAD-ANYWAY, if definitions have changed."
  (let ((differences (header-differences head (header-blueprints head))))
    (when differences
      (restart-case (error 'different-definitions :differences differences
                                                  :file "saved run" :verb "load")
        (load-anyway ()
          :report "Load it all the same.")))))

(defun load-saved-run (file anyway)
  "Load the run in FILE as LOAD-SIMULATION does. Return the simulation, and a list (symbol value) of
the parameters that DIRTY-SIMULATION would restore in this simulation."
  (check-argument load-simulation file (typep file '(or string pathname)) "the name of a file")
  (let ((head (read-saved-run-head file)))
    (unless anyway (check-saved-definitions head))
    (values (read-simulation file) (settings-with-symbols (getf head :noise)))))

(addition load-simulation)
(defun load-simulation (file &key anyway)
  "Return a new headless simulation in the state that SAVE-SIMULATION saved in FILE. The simulation
has the same STATE-DIGEST as the saved run, and its journal, if any. Given the same requests, it
continues exactly as the saved run would have. It does not become the current run: use
WITH-LOADED-SIMULATION, or RUN-TICKS and ASKING with the simulation that is returned. The map, the
robots and all other definitions that the run uses must be loaded. Nothing in FILE is executed.
Signals:
- DAMAGED-SIMULATION if FILE is damaged or is not a saved run
- UNKNOWN-NAME if a definition that the run uses is not loaded
- DIFFERENT-DEFINITIONS, with the restart LOAD-ANYWAY, if a definition has changed since the run was
  saved, unless ANYWAY is true
- WRONG-ARGUMENT unless FILE is a file name"
  (values (load-saved-run file anyway)))

(defun call-with-loaded-simulation (function file &key anyway keep)
  "Call FUNCTION in the simulation that is saved in FILE; see WITH-LOADED-SIMULATION."
  (multiple-value-bind (simulation noise) (load-saved-run file anyway)
    (call-leaving-current-run
     (settings-of simulation)
     (lambda ()
       (setf *noise-before-cleaning* noise)
       (call-in-headless-run function simulation :keep keep)))))

(addition with-loaded-simulation)
(define-user-macro with-loaded-simulation ((file &key anyway keep) &body body)
  "Run BODY in the simulation that LOAD-SIMULATION returns for FILE and ANYWAY, headless, with its
robots and parameters bound as in WITH-SIMULATION. If KEEP is true, the run keeps forks from now on,
so that it can be rewound, see KEEP-FORKS. When BODY has ended, the run is over. Return the values
of BODY. Signals the same errors as LOAD-SIMULATION."
  `(call-with-loaded-simulation (lambda () ,@body) ,file :anyway ,anyway :keep ,keep))
