;;;; journal-text.lisp -- journals as text: plain data that executes nothing and interns nothing.

(in-package :ars-magna.run)

;;; The first form is the head, then comes one for each entry, and then the end. Behind each form a
;;; comment has a check sum of it and all before it, so that damage is found, and where. Data are
;;; lists, numbers, strings and names. A bare name is a keyword; other symbols stand between bars,
;;; with their package. They are read into a package of their own, where nothing can go wrong,
;;; and then looked up; one that does not exist becomes a symbol without a home.

(defconstant +journal-version+ 2)

(addition damaged-journal)
(define-condition damaged-journal (ars-magna-error)
  ((file   :initarg :file   :reader damaged-journal-file)
   (reason :initarg :reason :reader damaged-journal-reason))
  (:report (lambda (condition stream)
             (format stream "~A is no usable journal: ~A. Save one with SAVE-JOURNAL; ~
                             nothing was changed."
                     (damaged-journal-file condition) (damaged-journal-reason condition))))
  (:documentation "A file that should hold a journal cannot be used."))

;;; Writing.

(defun unprintable-in (datum)
  "Return something in DATUM that could not be read back, or NIL."
  (typecase datum
    (cons (or (unprintable-in (car datum)) (unprintable-in (cdr datum))))
    ((or symbol string integer ratio) nil)
    (float (unless (finite-p datum) datum))
    (t datum)))

(defun check-printable (journal)
  (dolist (entry (journal-entries journal))
    (let ((object (unprintable-in (cddr entry))))
      (when object
        (reject-use "The journal cannot be written to a file: at tick ~D, ~(~A~) was given ~A, ~
                     which has no printed form that can be read again. Replay it in memory instead."
                    (first entry) (second entry) object)))))

(defun bare-name-p (name)
  "True if NAME, a string, can stand in a journal as it is, for a keyword."
  (and (plusp (length name))
       (alpha-char-p (char name 0))
       (every (lambda (char) (or (char<= #\A char #\Z) (digit-char-p char) (find char "-*+/<>=!?")))
              name)
       (not (member name '("NIL" "T") :test #'string=))))

(defun write-barred (text stream)
  (write-char #\| stream)
  (loop for char across text
        do (when (find char "|\\") (write-char #\\ stream))
           (write-char char stream))
  (write-char #\| stream))

(defun write-symbol (symbol stream)
  (let ((name (symbol-name symbol)) (package (symbol-package symbol)))
    (cond ((null symbol) (write-string "nil" stream))
          ((eq t symbol) (write-string "t" stream))
          ((and (keywordp symbol) (bare-name-p name)) (write-string (string-downcase name) stream))
          (t (write-barred (format nil "~@[~A~]::~A" (and package (package-name package)) name)
                           stream)))))

(defun write-datum (datum stream)
  (typecase datum
    (symbol (write-symbol datum stream))
    (cons (write-char #\( stream)
     (loop for tail = datum then (cdr tail)
           do (write-datum (car tail) stream)
              (cond ((consp (cdr tail)) (write-char #\Space stream))
                    ((null (cdr tail)) (return))
                    (t (write-string " . " stream)
                       (write-datum (cdr tail) stream)
                       (return))))
     (write-char #\) stream))
    (t (prin1 datum stream))))

(defun datum-text (datum)
  (with-standard-io-syntax
    (let ((*read-default-float-format* 'double-float) (*print-readably* nil))
      (with-output-to-string (out) (write-datum datum out)))))

(defun entry-datum (entry)
  "Return ENTRY as it stands in a file: the operator by name."
  (list* (first entry) (make-keyword (symbol-name (second entry))) (cddr entry)))

(defun journal-data (journal)
  "Return what the file of JOURNAL has, in order."
  (append (list (list :ars-magna-journal +journal-version+ (journal-header journal)))
          (mapcar #'entry-datum (journal-entries journal))
          (list (list :end (journal-end journal)))))

(defun write-journal (journal file)
  "Write JOURNAL to FILE, replacing it when all is written. Return the file's truename. Signals
MISUSE if an entry holds a function, or another object without a readable form."
  (check-printable journal)
  (with-open-file (out file :direction :output :if-exists :supersede :external-format :utf-8)
    (format out ";;;; A journal of ARS MAGNA.~%")
    (let ((sum 0))
      (dolist (datum (journal-data journal))
        (let ((text (datum-text datum)))
          (setf sum (text-checksum text sum))
          (format out "~A ;~8,'0X~%" text sum)))))
  (truename file))

;;; Reading.

(defun refuse-character (stream char)
  (declare (ignore stream))
  (error "it has a ~A where none can be" char))

(defparameter *journal-readtable*
  (let ((readtable (copy-readtable nil)))
    (dolist (char '(#\: #\# #\' #\` #\, #\;) readtable)
      (set-macro-character char 'refuse-character nil readtable)))
  "How journals are read: lists, numbers, strings and names.")

(defun looked-up (symbol)
  "Return the symbol that SYMBOL, as it was read, stands for."
  (let* ((name (symbol-name symbol)) (colons (search "::" name)))
    (cond ((string= name "NIL") nil)
          ((string= name "T") t)
          ((null colons) (or (find-symbol name :keyword) (make-symbol name)))
          (t (let ((package (find-package (subseq name 0 colons)))
                   (name (subseq name (+ 2 colons))))
               (or (and package (find-symbol name package)) (make-symbol name)))))))

(defun look-up-names (datum known)
  "Return DATUM with each symbol replaced by what it stands for. KNOWN has those met before."
  (typecase datum
    (cons (cons (look-up-names (car datum) known) (look-up-names (cdr datum) known)))
    (symbol (multiple-value-bind (symbol there) (gethash datum known)
              (if there symbol (setf (gethash datum known) (looked-up datum)))))
    (t datum)))

(defun call-reading (function)
  "Call FUNCTION with the Lisp reader set up to read journals, into a package of their own."
  (let ((package (make-package (gensym "JOURNAL") :use '())))
    (unwind-protect
         (with-standard-io-syntax
           (let ((*package* package) (*readtable* *journal-readtable*) (*read-eval* nil)
                 (*read-default-float-format* 'double-float))
             (funcall function)))
      (delete-package package))))

(defun read-checksum (text start)
  "Return the check sum that stands in TEXT from START on, and where the next line begins."
  (let ((end (or (position #\Newline text :start start) (length text))))
    (values (and (<= (+ start 10) end)
                 (string= " ;" text :start2 start :end2 (+ 2 start))
                 (parse-integer text :start (+ 2 start) :end end :radix 16 :junk-allowed t))
            (min (1+ end) (length text)))))

(defun first-opening (text)
  "Return where the first line of TEXT that is no comment begins, or NIL."
  (loop for start = 0 then (1+ end)
        for end = (position #\Newline text :start start)
        while (< start (length text))
        when (char= #\( (char text start)) return start
        while end))

(defun read-checked (text start sum)
  "Return the datum in TEXT at START, where the next begins and its check sum. SUM is that of what
comes before. Signals an error that says what is wrong."
  (multiple-value-bind (datum end)
      (handler-case (read-from-string text t nil :start start :preserve-whitespace t)
        ((or error storage-condition) (trouble) (error "~A" (one-line-text trouble))))
    (let ((sum (text-checksum (subseq text start end) sum)))
      (multiple-value-bind (expected next) (read-checksum text end)
        (unless (eql sum expected) (error "it is not as it was written"))
        (values datum next sum)))))

(defun one-line-text (condition)
  (let ((text (substitute #\Space #\Newline (princ-to-string condition))))
    (string-right-trim "." (subseq text 0 (min 80 (length text))))))

(defun read-data (text)
  "Return a list of all data in the journal TEXT. Signals an error that says what is wrong, and in
which entry."
  (let ((known (make-hash-table :test 'eq))
        (next (or (first-opening text) (error "it does not begin like one")))
        (sum 0)
        (data '()))
    (call-reading
     (lambda ()
       (loop while (< next (length text))
             do (multiple-value-bind (datum end new-sum)
                    (handler-case (read-checked text next sum)
                      (error (trouble)
                        (error "~[its head~:;~:*entry ~D~] (line ~D) is damaged: ~A"
                               (length data) (1+ (count #\Newline text :end next)) trouble)))
                  (push (look-up-names datum known) data)
                  (setf next end sum new-sum)))))
    (nreverse data)))

;;; What the data come to.

(defun plist-p (object)
  (and (listp object) (ignore-errors (evenp (length object)))
       (loop for key in object by #'cddr always (keywordp key))))

(defun strings-p (object)
  (and (listp object) (every #'stringp object)))

(defun parameters-p (object)
  (and (listp object)
       (every (lambda (setting) (typep setting '(cons string (cons (or real boolean) null))))
              object)))

(defun definitions-p (object)
  (and (listp object)
       (every (lambda (definition)
                (typep definition '(cons symbol (cons string (cons t null)))))
              object)))

(defun header-trouble (header)
  "Return what is wrong with HEADER, or NIL."
  (flet ((wrong-p (key predicate) (not (funcall predicate (getf header key)))))
    (cond ((not (plist-p header)) "its head is no list of names and values")
          ((wrong-p :map #'stringp) "its head names no map")
          ((wrong-p :robots #'strings-p) "its head names no robots")
          ((wrong-p :seed #'integerp) "its seed is no integer")
          ((wrong-p :parameters #'parameters-p) "the parameters in its head make no sense")
          ((wrong-p :definitions #'definitions-p) "the definitions in its head make no sense"))))

(defun entry-trouble (entry tick)
  "Return what is wrong with ENTRY, which comes after one at TICK, or NIL."
  (cond ((not (typep entry '(cons tick-count (cons symbol list)))) "it is no list (tick name ...)")
        ((< (first entry) tick) (format nil "its tick, ~D, comes after ~D" (first entry) tick))
        ((null (find-operator (second entry) nil))
         (format nil "nothing that can be asked of a run is called ~(~A~)" (second entry)))))

(defun operator-entry (entry)
  "Return ENTRY with the name of its operator as that was defined."
  (list* (first entry) (operator-name (find-operator (second entry))) (cddr entry)))

(defun entries-of (data)
  "Return DATA, the entries of a journal, checked. Signals an error that names the entry."
  (loop with tick = 0
        for entry in data
        for number from 1
        for trouble = (entry-trouble entry tick)
        when trouble do (error "entry ~D makes no sense: ~A" number trouble)
        do (setf tick (first entry))
        collect (operator-entry entry)))

(defun journal-from (data)
  "Return the journal that DATA, all that its file has, come to. Signals an error if it is none."
  (destructuring-bind (&optional start &rest rest) data
    (let ((end (first (last rest))))
      (unless (typep start '(cons (eql :ars-magna-journal) (cons t (cons t null))))
        (error "it does not begin like one"))
      (unless (eql +journal-version+ (second start)) (error "another version wrote it"))
      (unless (typep end '(cons (eql :end) (cons tick-count null))) (error "its end is missing"))
      (let ((journal (make-journal (third start))) (entries (entries-of (butlast rest))))
        (when (header-trouble (third start)) (error "~A" (header-trouble (third start))))
        (when (and entries (< (second end) (first (first (last entries)))))
          (error "it ends before its last entry"))
        (setf (journal-newest-first journal) (reverse entries)
              (journal-length journal) (length entries)
              (journal-end journal) (second end))
        journal))))

(defun check-new-enough (text)
  (when (search "(:ARS-MAGNA-JOURNAL 1 " text :end2 (min 200 (length text)))
    (error "it is of the old format 1, whose entries could call any function, and is not read any ~
            more: repeat the run, with the version that recorded it, or record it anew")))

(defun read-journal (file)
  "Return the journal in FILE. Signals DAMAGED-JOURNAL if it is none, or incomplete, and says which
entry is to blame."
  (handler-case
      (let ((text (read-file-into-string file :external-format :utf-8)))
        (check-new-enough text)
        (journal-from (read-data text)))
    (error (trouble)
      (error 'damaged-journal :file file
                              :reason (string-right-trim "." (princ-to-string trouble))))))
