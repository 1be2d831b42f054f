;;;; loading.lisp -- loading a saved run.

(in-package :ars-magna.run)

(export '(call-with-loaded-simulation))

(addition load-anyway)
(document-restarts
 'load-anyway "Load the saved run although the definitions have changed since it was saved.")

;;; The head.

(defun check-saved-head (datum)
  "Signal an error unless DATUM begins a saved run of this version."
  (unless (typep datum '(cons (eql :ars-magna-run) (cons t (cons t null))))
    (error "it does not begin like one"))
  (check-format (second datum) +saved-version+)
  (let* ((head (third datum))
         (trouble (or (header-trouble (if (plist-p head) (list* :seed 0 head) head))
                      (saved-head-trouble head))))
    (when trouble (error "its head makes no sense: ~A" trouble))))

(defun saved-head-trouble (head)
  "Return a text about what is wrong with HEAD, besides what HEADER-TROUBLE finds, or NIL."
  (cond ((not (settings-p (getf head :noise))) "its noise makes no sense")
        ((settings-trouble (getf head :noise)))
        ((not (or (null (getf head :dice)) (lisps-dice-numbers-p (getf head :dice))))
         "its dice make no sense")
        ((not (typep (getf head :tick) 'tick-count)) "its tick is none")
        ((not (typep (getf head :digest) '(unsigned-byte 64))) "its digest is none")))

;;; Lines. Their order is fixed, so the meaning of each is known.

(defstruct (reading (:constructor make-reading (in sum number)) (:copier nil))
  "The stream that is read, the check sum so far, and the number of the line."
  (in nil :read-only t)
  (sum 0 :type (unsigned-byte 32))
  (number 0 :type fixnum))

(defun next-datum (reading)
  "Return the datum in the next line of READING. Signals an error if there is none, or damage."
  (let ((line (or (next-line (reading-in reading)) (error "its end is missing"))))
    (incf (reading-number reading))
    (multiple-value-bind (datum sum)
        (handler-case (checked-datum line (reading-sum reading))
          (error (trouble)
            (error "line ~D is damaged: ~A" (reading-number reading) (one-line-text trouble))))
      (setf (reading-sum reading) sum)
      datum)))

(defun tagged-p (tag datum)
  (and (consp datum) (eq tag (first datum)) (proper-list-p datum)))

(defun read-numbers (reading loaded)
  "Read the definitions of numbers from READING."
  (loop for datum = (next-datum reading)
        until (tagged-p :objects datum)
        do (cond ((tagged-p :found datum) (add-outer (rest datum) loaded))
                 ((and (tagged-p :new datum) (<= 3 (length datum)))
                  (add-batch (second datum) (third datum) (nthcdr 3 datum) loaded))
                 (t (error "it does not define its numbers")))
        finally (unless (equal (rest datum) (list (1- (length (loaded-objects loaded)))))
                  (error "it has not as many objects as it says"))))

(defun read-contents (reading loaded)
  "Read the contents of the objects LOADED from READING. Return the waiting requests."
  (let ((*numbered* (loaded-objects loaded)))
    (loop until (all-objects-complete-p loaded) do (fill-next (next-datum reading) loaded))
    (fill-tables loaded)
    (loop for datum = (next-datum reading)
          do (unless (and (tagged-p :waiting datum) (<= (length datum) 2))
               (error "it does not say which requests wait"))
          while (rest datum)
          collect (second datum))))

(defun read-entries (reading)
  "Return the entries of the journal in READING, and the datum after them."
  (loop for datum = (next-datum reading)
        until (tagged-p :end datum)
        collect datum into entries
        finally (return (values entries datum))))

(defun journal-of-data (datum entries)
  "Return the journal whose first line is DATUM, with ENTRIES."
  (unless (typep datum '(cons (eql :journal) (cons boolean (cons t (cons list null)))))
    (error "its journal makes no sense"))
  (destructuring-bind (full-p end header) (rest datum)
    (let ((journal (journal-from (append (list (list :ars-magna-journal +journal-version+ header))
                                         entries
                                         (list (list :end end))))))
      (setf (journal-full-p journal) full-p)
      journal)))

(defun read-journal-of (reading head)
  "Return the journal in READING, of a run with HEAD, or NIL if it keeps none."
  (let ((first (and (getf head :journal) (next-datum reading)))
        (tick (getf head :tick)))
    (multiple-value-bind (entries end) (read-entries reading)
      (unless (equal end (list :end tick)) (error "its end is not that of the run"))
      (when (next-line (reading-in reading)) (error "there is something after its end"))
      (when (and entries (null first)) (error "it has journal entries, but no journal"))
      (let ((journal (and first (journal-of-data first entries))))
        (when (and journal (not (if (journal-full-p journal)
                                    (<= (journal-end journal) tick)
                                    (= (journal-end journal) tick))))
          (error "its journal does not end where the run is"))
        journal))))

;;; Putting the run together.

(defun sole-object (type loaded)
  "Return the only object of TYPE, a kind, in LOADED. Signals an error unless there is exactly one."
  (let ((objects (remove-if-not (lambda (object) (typep object type)) (loaded-objects loaded))))
    (unless (= 1 (length objects))
      (error "it has ~R objects of the kind ~(~A~), and a run has one" (length objects) type))
    (aref objects 0)))

(defun renamed-parameters (values settings)
  "Return VALUES, those of SETTINGS, as a vector for the current parameters; others have defaults."
  (unless (and (= (length values) (length settings))
               (every (lambda (value setting) (eql value (second setting))) values settings))
    (error "its parameters contradict each other"))
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
               "its world is not that of its run")
    (check-world world)
    (must-hold (proper-list-p (world-robots world)) "its list of robots is circular")
    (dolist (robot (world-robots world)) (check-robot robot world))
    (dolist (request requests)
      (check-request request)
      (let ((resource (resource-of request)))
        (must-hold (or (not (typep resource 'resource)) (eq timeline (timeline-of resource)))
                   "a request is to another run")))))

(defun resource-of (request)
  "Return the resource that REQUEST, an operation or one with it as an argument, occupies or frees."
  (if (operation-p request) (operation-resource request) (first (request-arguments request))))

(defun complete-loading (simulation head loaded requests)
  "Make SIMULATION, which was LOADED, ready to continue, with REQUESTS waiting. Return it."
  (let ((world (simulation-world simulation)) (timeline (simulation-timeline simulation)))
    (destructuring-bind (agenda tick . events) (loaded-agenda loaded)
      (unless (eq agenda (timeline-agenda timeline)) (error "its agenda is not that of its run"))
      (check-commands timeline events)
      (must-hold (null (intersection events requests)) "a waiting request is in progress already")
      (fill-agenda agenda tick events))
    (check-objects simulation requests)
    (setf (timeline-inbox timeline) (reverse requests)
          (timeline-run timeline) simulation
          (simulation-messages simulation) (make-message-queue)
          (simulation-dice simulation) (and (getf head :dice)
                                            (lisps-dice-of-numbers (getf head :dice)))
          (simulation-known-parameters simulation)
          (renamed-parameters (simulation-known-parameters simulation) (getf head :parameters))
          (world-kicker-generation world) (- *kicker-generation*
                                             (if (getf head :kickers-old-p) 1 0)))
    simulation))

(defun simulation-from (reading head octets)
  "Return the simulation in READING, a saved run of OCTETS whose HEAD has been read."
  (let ((loaded (begin-loading octets)))
    (read-numbers reading loaded)
    (let* ((requests (read-contents reading loaded))
           (simulation (sole-object 'simulation loaded)))
      (sole-object 'world loaded)
      (sole-object 'timeline loaded)
      (setf (simulation-journal simulation) (read-journal-of reading head))
      (complete-loading simulation head loaded requests))))

(defun read-head (reading)
  (let ((datum (next-datum reading)))
    (check-saved-head datum)
    (third datum)))

;;; Loading. The head is read first, so that an error can name the definitions that are missing.

(defun saved-head (file)
  "Return the head of the saved run in FILE. Signals DAMAGED-SIMULATION."
  (reading-file (in file :run 'damaged-simulation) (read-head (make-reading in 0 0))))

(defun read-simulation (file)
  "Return the simulation that is saved in FILE. Signals DAMAGED-SIMULATION and UNKNOWN-NAME."
  (reading-file (in file :run 'damaged-simulation)
    (let* ((reading (make-reading in 0 0))
           (head (read-head reading))
           (simulation (simulation-from reading head (file-length in))))
      (unless (= (getf head :tick) (simulation-tick simulation))
        (error "its tick is not the one in its head"))
      (unless (= (getf head :digest) (state-digest simulation))
        (error "the loaded state is not what was saved"))
      simulation)))

(defun check-saved-definitions (head)
  "Signal UNKNOWN-NAME if a robot in HEAD, of a saved run, is not defined, and
DIFFERENT-DEFINITIONS, with the restart LOAD-ANYWAY, if definitions have changed."
  (let ((differences (differences-from head (mapcar #'find-blueprint (getf head :robots)))))
    (when differences
      (restart-case (error 'different-definitions :differences differences
                                                  :file "saved run" :verb "load")
        (load-anyway ()
          :report "Load it all the same.")))))

(defun load-saved (file anyway)
  "Do what LOAD-SIMULATION does. Return also what DIRTY-SIMULATION restores, as settings by symbol."
  (check-argument load-simulation file (typep file '(or string pathname)) "the name of a file")
  (let ((head (saved-head file)))
    (unless anyway (check-saved-definitions head))
    (values (read-simulation file) (settings-by-symbol (getf head :noise)))))

(addition load-simulation)
(defun load-simulation (file &key anyway)
  "Return a new headless simulation in the state that SAVE-SIMULATION saved in FILE. It has the same
STATE-DIGEST, continues exactly as the saved run would have, given the same requests, and keeps its
journal, if any. Map, robots and all else that it uses must be loaded. Nothing in FILE is executed.
Signals:
- DAMAGED-SIMULATION if FILE is damaged or no saved run
- UNKNOWN-NAME if something it uses is not defined
- DIFFERENT-DEFINITIONS, with the restart LOAD-ANYWAY, if a definition has changed since, unless
  ANYWAY is true
- WRONG-ARGUMENT unless FILE is a name"
  (values (load-saved file anyway)))

(defun call-with-loaded-simulation (function file &key anyway keep)
  "Call FUNCTION in the simulation that is saved in FILE; see WITH-LOADED-SIMULATION."
  (multiple-value-bind (simulation noise) (load-saved file anyway)
    (call-with-parameters
     (settings-of simulation)
     (lambda ()
       (setf *noise-before-cleaning* noise)
       (call-as-headless function simulation :keep keep)))))

(addition with-loaded-simulation)
(define-user-macro with-loaded-simulation ((file &key anyway keep) &body body)
  "Run BODY in the simulation that LOAD-SIMULATION returns for FILE and ANYWAY, headless, with its
robots and parameters bound as in WITH-SIMULATION. With KEEP it keeps forks from there on, so that
it can be rewound, see KEEP-FORKS. When BODY has ended, the run is over. Return the values of BODY.
Signals what LOAD-SIMULATION does."
  `(call-with-loaded-simulation (lambda () ,@body) ,file :anyway ,anyway :keep ,keep))
