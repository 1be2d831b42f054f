;;;; journal.lisp -- what was asked of a run, and when, so that it can be repeated exactly.

(in-package :ars-magna.time)

;;; A journal is a header (a plist: world, robots, seed, parameters), entries (tick operation
;;; argument ...) in the order in which they took effect, and the tick at which it ended. Robots,
;;; parts, things and designators stand in it as lists that name them; see EXTERNALIZE. What
;;; commands do is not in it, and need not be: a run is a function of what is.

(defconstant +journal-version+ 1)

(defstruct (journal (:constructor make-journal (header)) (:copier nil))
  "The record of one run."
  (header '() :type list)
  (newest-first '() :type list)
  (length 0 :type fixnum)
  (end 0 :type tick-count))
(addition journal-p journal-header journal-length journal-end)
(setf (documentation 'make-journal 'function) "Return an empty journal that begins with HEADER."
      (documentation 'journal-p 'function) "True of journals."
      (documentation 'journal-header 'function)
      "Return the plist with which the run began: world, robots, seed, parameters."
      (documentation 'journal-length 'function) "Return how many entries the journal has."
      (documentation 'journal-end 'function) "Return the tick at which the journal ends.")

(addition journal-entries)
(defun journal-entries (journal)
  "Return the entries (tick operation argument ...) of JOURNAL, oldest first."
  (reverse (journal-newest-first journal)))

(defgeneric externalize (object)
  (:documentation
   "Return printable data that names OBJECT, for INTERNALIZE to find its like in another run.
Things without a name of their own stand for themselves.")
  (:method (object) object)
  (:method ((object cons)) (cons (externalize (car object)) (externalize (cdr object)))))

(defgeneric internalize-reference (kind reference simulation)
  (:documentation
   "Return what REFERENCE, a list that begins with the keyword KIND, names in SIMULATION."))

(defun make-reference (kind arguments)
  "Return what EXTERNALIZE makes of a robot, part, thing or designator: (:the KIND ARGUMENT ...)."
  (list* :the kind arguments))

(defun internalize (datum simulation)
  "Return DATUM with every reference in it replaced by what it names in SIMULATION."
  (cond ((atom datum) datum)
        ((eq (first datum) :the)
         (internalize-reference (second datum) (cddr datum) simulation))
        (t (cons (internalize (car datum) simulation) (internalize (cdr datum) simulation)))))

(defun note (simulation operation &rest arguments)
  "Enter OPERATION with ARGUMENTS, as of now, into the journal of SIMULATION, if it keeps one."
  (let ((journal (simulation-journal simulation)))
    (when journal
      (let ((tick (agenda-tick (simulation-agenda simulation))))
        (push (list* tick operation (externalize arguments)) (journal-newest-first journal))
        (incf (journal-length journal))
        (setf (journal-end journal) tick)))))

(defun truncated-journal (journal tick)
  "Return a journal that ends at TICK and until then is like JOURNAL."
  (let ((copy (make-journal (journal-header journal))))
    (setf (journal-newest-first copy)
          (remove-if (lambda (entry) (>= (first entry) tick)) (journal-newest-first journal))
          (journal-length copy) (length (journal-newest-first copy))
          (journal-end copy) tick)
    copy))

(defgeneric apply-entry (operation arguments simulation)
  (:documentation
   "Do again, between ticks of SIMULATION, what an entry of a journal says. ARGUMENTS have been
internalized.")
  (:method ((operation (eql :parameter)) arguments simulation)
    (declare (ignore simulation))
    (destructuring-bind (symbol value) arguments (setf (parameter-value symbol) value))))

;;; On file.

(addition damaged-journal)
(define-condition damaged-journal (ars-magna-error)
  ((file   :initarg :file   :reader damaged-journal-file)
   (reason :initarg :reason :reader damaged-journal-reason))
  (:report (lambda (condition stream)
             (format stream "~A is no usable journal: ~A. Save one with SAVE-JOURNAL; ~
                             nothing was changed."
                     (damaged-journal-file condition) (damaged-journal-reason condition))))
  (:documentation "A file that should hold a journal cannot be used."))

(defun unprintable-in (datum)
  "Return something in DATUM that could not be read back, or NIL."
  (typecase datum
    (cons (or (unprintable-in (car datum)) (unprintable-in (cdr datum))))
    ((or symbol number string character) nil)
    (t datum)))

(defun check-printable (journal)
  (dolist (entry (journal-entries journal))
    (let ((object (unprintable-in entry)))
      (when object
        (reject-use "The journal cannot be written to a file: at tick ~D, ~(~A~) was given ~A, ~
                     which has no printed form that can be read again. Replay it in memory instead."
                    (first entry) (if (eq :world (second entry)) (third entry) (second entry))
                    object)))))

(defun write-journal (journal file)
  "Write JOURNAL to FILE, replacing it when all is written. Return the file's truename. Signals
MISUSE if an entry holds a function, or another object without a readable form."
  (check-printable journal)
  (with-open-file (out file :direction :output :if-exists :supersede :external-format :utf-8)
    (with-standard-io-syntax
      (let ((*package* (find-package :keyword)) (*print-readably* nil))
        (format out ";;;; A journal of ARS MAGNA.~%")
        (format out "~S~%" (list :ars-magna-journal +journal-version+
                                 :end (journal-end journal) :header (journal-header journal)))
        (dolist (entry (journal-entries journal)) (format out "~S~%" entry))
        (format out "~S~%" :end))))
  (truename file))

(defun read-forms (file)
  (handler-case
      (with-open-file (in file :external-format :utf-8)
        (with-standard-io-syntax
          (let ((*read-eval* nil) (*package* (find-package :keyword)))
            (loop for form = (read in nil in) until (eq form in) collect form))))
    (error (condition)
      (error 'damaged-journal :file file
                              :reason (remove #\Newline (princ-to-string condition))))))

(defun entry-p (form)
  (and (consp form) (typep (first form) 'tick-count) (consp (cdr form)) (keywordp (second form))))

(defun read-journal (file)
  "Return the journal in FILE. Signals DAMAGED-JOURNAL if it is none, or incomplete."
  (destructuring-bind (&optional start &rest entries) (read-forms file)
    (flet ((reject (reason) (error 'damaged-journal :file file :reason reason)))
      (cond ((not (and (consp start) (eq (first start) :ars-magna-journal)))
             (reject "it does not begin like one"))
            ((not (eql (second start) +journal-version+)) (reject "another version wrote it"))
            ((not (eq (first (last entries)) :end)) (reject "its end is missing")))
      (destructuring-bind (&key (end 0) header) (cddr start)
        (let ((journal (make-journal header)) (entries (butlast entries)))
          (unless (every #'entry-p entries) (reject "an entry makes no sense"))
          (setf (journal-newest-first journal) (reverse entries)
                (journal-length journal) (length entries)
                (journal-end journal) end)
          journal)))))
