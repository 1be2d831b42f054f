;;;; journal-text.lisp -- writing and reading journals as plain data.

(in-package :ars-magna.run)

(export '(write-journal read-journal))

;;; The first line is a comment. Then come the head, one line for each entry, and the end. A comment
;;; after each has a check sum of the file up to there, which shows where damage is. Reading
;;; executes nothing and interns nothing. See plain-data.lisp for the syntax.

(defconstant +journal-version+ 2)
(define-constant +journal-title+ ";;;; A journal of ARS MAGNA." :test #'string=
  :documentation "The first line of a file that holds a journal.")
(note-kind-of-file :journal +journal-title+
                   "the file is a journal; (replay FILE) and (load-journal FILE) read it")
(defconstant +latest-end+ (expt 10 9) "The last tick that a journal on file can end at.")

;;; Writing.

(defun check-printable (journal)
  "Signal MISUSE if JOURNAL contains an object that could not be read back from a file."
  (dolist (entry (journal-entries journal))
    (let ((object (unprintable-in (cddr entry))))
      (when object
        (reject-use "The journal cannot be written to a file: at tick ~D, ~(~A~) was given ~A, ~
                     which has no printed form that can be read again. Replay it in memory instead."
                    (first entry) (second entry) (short-text object)))))
  (when (unprintable-in (journal-header journal))
    (reject-use "The journal cannot be written to a file: ~A in its head has no printed form that ~
                 can be read again. Replay it in memory instead."
                (short-text (unprintable-in (journal-header journal)))))
  (when (< +latest-end+ (journal-end journal))
    (reject-use "The journal cannot be written to a file: it ends at tick ~D, but files hold only ~
                 runs up to tick ~D. Replay it in memory instead."
                (journal-end journal) +latest-end+)))

(defun entry-datum (entry)
  "Return ENTRY in the form used in files, with a keyword for the operator."
  (list* (first entry) (make-keyword (symbol-name (second entry))) (cddr entry)))

(defun journal-data (journal)
  (append (list (list :ars-magna-journal +journal-version+
                      (append (journal-header journal)
                              (and (journal-remarks journal)
                                   (list :remarks (reverse (journal-remarks journal)))))))
          (mapcar #'entry-datum (journal-entries journal))
          (list (list :end (journal-end journal)))))

(defun write-data-lines (data out)
  "Write DATA to OUT, each element as a line with a check sum."
  (write-line +journal-title+ out)
  (let ((sum 0))
    (dolist (datum data) (setf sum (write-checksummed-line (datum-text datum) sum out)))))

;;; Reading.

(defun check-head-line (line)
  "Signal an error unless LINE begins like the first line of a journal of this version."
  (flet ((begins-p (text) (starts-with-subseq text line :test #'char-equal)))
    (when (or (begins-p "(:ars-magna-journal 1 ") (begins-p "(ars-magna-journal 1 "))
      (error "the file has the old format 1, whose entries could call any function, and cannot be ~
              read any more: repeat the run with the version that recorded it, or record it anew"))
    (unless (begins-p "(ars-magna-journal ") (error "the file does not begin like a journal"))))

(defun checked-entry-datum (number line sum)
  "Return the values of CHECKED-DATUM for LINE and SUM. Errors name the NUMBER of the entry."
  (handler-case (checked-datum line sum)
    (error (trouble)
      (error "~[the head~:;~:*entry ~D~] is damaged: ~A" number (one-line-text trouble)))))

(defun read-journal-data (in)
  "Return all data of the journal in the stream IN. Signals errors that name the damaged entry."
  (loop with sum = 0
        for number from 0
        for line = (next-data-line in)
        while line
        when (zerop number) do (check-head-line line)
        collect (multiple-value-bind (datum new) (checked-entry-datum number line sum)
                  (setf sum new)
                  datum)))

;;; Checking the data.

(defun plist-p (object)
  (and (listp object)
       (evenp (length object))
       (loop for key in object by #'cddr always (keywordp key))))

(defun list-of-p (type object)
  (proper-list-of-p (lambda (element) (typep element type)) object))

(defun settings-p (object)
  (list-of-p '(cons string (cons (or real boolean keyword) null)) object))

(defun definitions-p (object)
  (list-of-p '(cons symbol (cons string (cons (or integer symbol) null))) object))

(defun remarks-p (object)
  (list-of-p '(cons tick-count
               (cons keyword
                (cons string
                 (cons (or null string) (cons (or null real) (cons (or null real) null))))))
             object))

(defun settings-error-text (settings)
  (handler-case (call-with-parameters settings (constantly nil))
    (ars-magna-error (trouble) (one-line-text trouble))))

(defun duplicates-p (names)
  (/= (length names) (length (remove-duplicates names :test #'string-equal))))

(defun header-error-text (header)
  (flet ((wrong-p (key predicate) (not (funcall predicate (getf header key)))))
    (cond ((not (plist-p header)) "the head is no list of names and values")
          ((wrong-p :map #'stringp) "the head names no map")
          ((robots-error-text header))
          ((wrong-p :seed #'integerp) "its seed is no integer")
          ((not (thinking-mode-p (getf header :thinking :free))) "its thinking mode makes no sense")
          ((wrong-p :parameters #'settings-p) "its parameters make no sense")
          ((wrong-p :definitions #'definitions-p) "its definitions make no sense")
          ((wrong-p :remarks #'remarks-p) "its remarks make no sense")
          ((name-without-definition header)
           (format nil "the head does not contain the definition of ~A"
                   (name-without-definition header)))
          ((settings-error-text (getf header :parameters))))))

(defun name-without-definition (header)
  "Return the name of a map or robot in HEADER whose definition is missing in HEADER, or NIL."
  (flet ((described-p (kind name)
           (find (list kind name) (getf header :definitions) :test #'same-definition-p)))
    (if (described-p :map (getf header :map))
        (find-if-not (lambda (name) (described-p :robot (kind-of-robot name header)))
                     (getf header :robots))
        (getf header :map))))

(defun entry-error-text (entry tick)
  "Return a text about an error in the journal entry ENTRY, which follows an entry at TICK, or NIL."
  (cond ((not (typep entry '(cons tick-count (cons symbol list)))) "it is no list (tick name ...)")
        ((< (first entry) tick) (format nil "its tick, ~D, is before the tick of the previous ~
                                             entry, ~D" (first entry) tick))
        ((null (find-operator (second entry) nil))
         (format nil "there is no operator called ~A"
                 (short-text (plain-name (second entry)))))))

(defun checked-entries (data)
  "Return the entries in DATA with symbols as operators. Errors name the first invalid entry."
  (loop with tick = 0
        for entry in data
        for number from 1
        for trouble = (entry-error-text entry tick)
        when trouble do (error "entry ~D makes no sense: ~A" number trouble)
        do (setf tick (first entry))
        ;; Use the symbol with which the operator was defined.
        collect (list* tick (operator-name (find-operator (second entry))) (cddr entry))))

(defun check-head (head)
  (unless (typep head '(cons (eql :ars-magna-journal) (cons t (cons t null))))
    (error "the file does not begin like a journal"))
  (check-file-format (second head) +journal-version+)
  (when (header-error-text (third head))
    (error "the head makes no sense: ~A" (header-error-text (third head))))
  (check-robots-of-header (third head)))

(defun check-end (end entries)
  "Signal an error unless END is a valid last datum (:end tick) after ENTRIES."
  (unless (typep end '(cons (eql :end) (cons tick-count null))) (error "the end of the file is ~
                                                                        missing"))
  (when (< +latest-end+ (second end))
    (error "it ends at tick ~D, but files hold only runs up to tick ~D" (second end) +latest-end+))
  (when (and entries (< (second end) (first (first (last entries)))))
    (error "the journal ends at tick ~D, before its last entry" (second end))))

(defun journal-from-data (data)
  "Return the journal made from DATA, all data of a file. Signals an error if DATA are invalid."
  (check-head (first data))
  (let ((journal (make-journal (uiop:remove-plist-key :remarks (third (first data)))))
        (entries (checked-entries (butlast (rest data))))
        (end (first (last (rest data)))))
    (check-end end entries)
    (setf (journal-newest-first journal) (reverse entries)
          (journal-length journal) (length entries)
          (journal-remarks journal) (reverse (getf (third (first data)) :remarks))
          (journal-end journal) (second end))
    journal))

(defun read-journal (file &optional (operator 'read-journal))
  "Return the journal in FILE. Error messages name OPERATOR, which was called with FILE. Signals
DAMAGED-JOURNAL, which names an invalid entry, if FILE does not contain a complete journal;
WRONG-ARGUMENT unless FILE is a file name."
  (unless (typep file '(or string pathname))
    (reject-argument operator 'journal file
                     "a journal, or the name of a file that holds a journal"))
  (reading-file (in file :journal 'damaged-journal) (journal-from-data (read-journal-data in))))

;;; Writing. The new file is read on trial, so saving refuses what loading would refuse.

(defun check-readable (path)
  "Signal MISUSE unless the journal in the file PATH can be read."
  (handler-case (read-journal path)
    ((or damaged-journal unknown-name) (trouble)
      (reject-use "The journal cannot be written to a file, because the written file could not be ~
                   read again: ~A. An older file is unchanged. (simulator ROBOT) starts a run with ~
                   a new journal."
                  (damage-reason trouble)))))

(defun write-journal (journal file)
  "Write JOURNAL to FILE and return the file's truename. An existing FILE is replaced only after the
new file has been written and read as a check. Signals MISUSE and leaves FILE unchanged if that
fails, for example if an entry contains a function or another object without a readable form."
  (check-printable journal)
  (overwrite-file (lambda (out) (write-data-lines (journal-data journal) out)) file "the journal"
                   :kind :journal :check #'check-readable))
