;;;; sealed-lines.lisp -- lines of text with check sums, in files that may be damaged or forged.

(in-package :ars-magna.run)

;;; A comment after each line has a check sum of the file up to there, which shows where damage is.
;;; Other comments, empty lines and line ends of other systems are accepted. Files are read as
;;; octets, since damaged ones may be no valid UTF-8.

(defconstant +longest-line+ 1000000 "The most characters of a line of a saved file.")
(defconstant +longest-file+ (expt 2 28) "The most bytes of a saved file.")

(addition damaged-file)
(define-condition damaged-file (ars-magna-error)
  ((file   :initarg :file   :reader damaged-file-name)
   (reason :initarg :reason :reader damaged-file-reason))
  (:report (lambda (condition stream)
             (format stream "~A cannot be used: ~A." (file-name-text (damaged-file-name condition))
                     (damaged-file-reason condition))))
  (:documentation "A file cannot be used: it is damaged or was not saved by the simulator."))

(defun write-damage-report (condition stream kind operator)
  "Report to STREAM that the file of CONDITION is no usable KIND. Name OPERATOR, which saves one."
  (format stream "~A is no usable ~A: ~A. Save a new file with ~A; nothing was changed."
          (file-name-text (damaged-file-name condition)) kind (damaged-file-reason condition)
          operator))

(addition damaged-journal)
(define-condition damaged-journal (damaged-file)
  ()
  (:report (lambda (condition stream)
             (write-damage-report condition stream "journal" "SAVE-JOURNAL")))
  (:documentation "A file that should hold a journal cannot be used."))

(addition damaged-simulation)
(define-condition damaged-simulation (damaged-file)
  ()
  (:report (lambda (condition stream)
             (write-damage-report condition stream "saved run" "SAVE-SIMULATION")))
  (:documentation "A file that should hold a saved run cannot be used."))

;;; Writing.

(defun write-checksummed-line (text sum out)
  "Write TEXT and its check sum to OUT as a line. Return the sum. SUM is the previous line's sum."
  (when (<= (- +longest-line+ 10) (length text))
    (error "one entry takes ~D characters, more than a line can have" (length text)))
  (let ((sum (text-checksum text sum)))
    (format out "~A ;~8,'0X~%" text sum)
    (when (< (- +longest-file+ (expt 2 20)) (file-position out))
      (error "the file would take more than ~D bytes" (- +longest-file+ (expt 2 20))))
    sum))

;;; Reading.

(defun read-limited-line (in)
  "Return the next line of IN, cut off after +LONGEST-LINE+ characters, or NIL at the end of IN."
  (let* ((last nil)
         (line (with-output-to-string (out)
                 (loop repeat +longest-line+
                       do (setf last (read-char in nil))
                       until (member last '(nil #\Newline))
                       do (write-char last out)))))
    (when (or last (plusp (length line)))
      (string-right-trim '(#\Return) (if (every (lambda (char) (< (char-code char) 128)) line)
                                         line
                                         (utf-8-decoded line))))))

(defun comment-line-p (line)
  "True if LINE is a comment or empty; an editor may have put a byte order mark before it."
  (let ((text (string-left-trim '(#\Space #\Tab #.(code-char #xFEFF)) line)))
    (or (string= "" text) (char= #\; (char text 0)))))

(defun line-checksum (line start)
  (and (<= 0 start)
       (string= " ;" line :start2 start :end2 (+ 2 start))
       (parse-integer line :start (+ 2 start) :radix 16 :junk-allowed t)))

(defun checked-datum (line sum)
  "Return the datum in LINE and the check sum of LINE. SUM is the check sum of the previous line.
Signals an error if LINE is damaged."
  (when (= +longest-line+ (length line))
    (error "the line has ~D characters or more" +longest-line+))
  (let* ((start (- (length line) 10))
         (text (subseq line 0 (max 0 start)))
         (sum (text-checksum text sum)))
    (unless (eql sum (line-checksum line start)) (error "the line has been changed since it was ~
                                                         written"))
    (multiple-value-bind (datum end) (read-datum text)
      (unless (= end (length text)) (error "the line has more than one datum"))
      (values datum sum))))

(defun next-data-line (in)
  "Return the next line of IN that is not a comment, or NIL at the end."
  (loop for line = (read-limited-line in)
        unless (and line (comment-line-p line)) return line))

;;; Files.

(defun call-with-saved-file (function file)
  "Call FUNCTION with a stream of the octets of FILE, for NEXT-DATA-LINE. Signals an error if FILE
is not a regular file, or is too long."
  (let ((trouble (unusable-file-text file)))
    (when trouble (error "~A" trouble)))
  (with-open-file (in file :external-format :latin-1)
    (when (< +longest-file+ (file-length in))
      (error "the file has ~D bytes, more than a saved file can have" (file-length in)))
    (let ((*uninterned-symbols* (make-hash-table :test 'equal)))
      (funcall function in))))

(defun call-reading-file (function file kind damage)
  "Call FUNCTION as CALL-WITH-SAVED-FILE does. Errors other than UNKNOWN-NAME are signalled as an
error of the class DAMAGE that names FILE. KIND is the expected kind of FILE."
  (handler-case (call-with-saved-file function file)
    (unknown-name (trouble) (error trouble))
    (stream-error ()
      (error damage :file file :reason "the operating system does not allow reading it"))
    ((or error storage-condition) (trouble)
      (error damage :file file :reason (or (advice-on-file file kind)
                                           (one-line-text trouble))))))

(defun damage-reason (trouble)
  "Return the reason of the error TROUBLE, signalled by READING-FILE, as a part of a sentence."
  (if (typep trouble 'damaged-file)
      (damaged-file-reason trouble)
      (string-right-trim "." (one-line-text trouble))))

(defmacro reading-file ((in file kind damage) &body body)
  "Run BODY with IN bound to a stream of FILE. See CALL-READING-FILE for KIND and DAMAGE."
  `(call-reading-file (lambda (,in) ,@body) ,file ,kind ,damage))

(defun check-file-format (found expected)
  (unless (eql expected found)
    (error "another version of the simulator wrote the file, in format ~A; this version reads ~
            format ~D"
           (safe-text found) expected)))
