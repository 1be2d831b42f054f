;;;; telling.lisp -- texts for errors: the same on every version of SBCL, and of bounded length.

(in-package :ars-magna.basics)

(export '(simulator-symbol-p format-briefly report-briefly printable-report simulator-error-text
          partial-report typed-input-p reading-error-text text-of-condition one-line-text point-text
          zero-if-tiny editor-output-stream cause-of-reading-error))

;;; What SBCL reports of a wrong type differs between its versions: the type that its compiler has
;;; derived, the variable that was to be bound. Tables of experiments hold these texts, and two rows
;;; of one trial must be equal. So a type error names the value and the widest common type that the
;;; value is not of. Users' conditions and texts stay as they are.

(defparameter *common-types*
  '((number "a number") (real "a real number") (integer "an integer") ((integer 0) "0 or more")
    (rational "a rational number") (float "a float") (character "a character")
    (string "a string") ((or string symbol character) "a string")
    (cons "a list with elements") (list "a list") (symbol "a symbol")
    (hash-table "a hash table") (array "an array") (sequence "a list, vector or string")
    ((or function symbol) "a function") (stream "a stream") (pathname "a path"))
  "Lists (type words). Messages name the first that includes the expected type, not the value.")

(defparameter *arithmetic-texts*
  '((division-by-zero "A number is divided by 0.")
    (floating-point-overflow "A floating-point number is too large.")
    (floating-point-underflow "A floating-point number is too close to 0.")
    (floating-point-invalid-operation
     "An operation on floating-point numbers has no result, such as 0 divided by 0."))
  "Lists (condition-type text).")

;;; Wrong types.

(defparameter *compiler-phrases*
  '("Argument is neither a positive integer" "Invalid function name" "malformed property list"
    "is not a string designator")
  "Parts of texts that only some versions of SBCL use in type errors.")

;; A type without elements, such as that of the indices of an empty vector, is part of any other.
(defun common-type-text (datum type)
  "Return the description of the first of *COMMON-TYPES* that includes TYPE but not DATUM, or NIL."
  (unless (subtypep type nil)
    (loop for (common words) in *common-types*
          when (and (not (typep datum common)) (subtypep type common))
            return words)))

(defun limits-of-integer-type (type)
  "Return the least and greatest integers of TYPE, (integer LEAST GREATEST) or (mod N), and true. A
missing limit is NIL. For other types, return NIL three times."
  (flet ((bound (bound step)
           (cond ((integerp bound) bound)
                 ((and (consp bound) (integerp (first bound))) (+ (first bound) step)))))
    (cond ((and (consp type) (eq 'integer (first type)))
           (values (bound (second type) 1) (bound (third type) -1) t))
          ((and (consp type) (eq 'mod (first type)))
           (values 0 (bound (list (second type)) -1) t))
          (t (values nil nil nil)))))

(defun integer-range-text (datum type)
  "Return a text that describes TYPE, a range of integers that does not include the integer DATUM.
Return NIL if TYPE is no range of integers, or DATUM is no integer."
  (multiple-value-bind (least greatest range-p) (limits-of-integer-type type)
    (cond ((not (and range-p (integerp datum))) nil)
          ((and least greatest (< greatest least)) "in range: the range is empty")
          ((and least greatest) (format nil "from ~D to ~D" least greatest))
          (greatest (format nil "~D or less" greatest))
          (least (format nil "~D or more" least)))))

(defun compiler-text-p (condition)
  "True if the text of CONDITION, a type error, is SBCL's own: not from a program or CHECK-TYPE."
  (or (not (typep condition 'simple-condition))
      ;; The compiler's texts are no strings, except these in older versions.
      (let ((control (simple-condition-format-control condition)))
        (or (not (stringp control))
            (some (lambda (words) (search words control)) *compiler-phrases*)))))

(defun type-error-text (condition)
  (when (compiler-text-p condition)
    (let* ((datum (type-error-datum condition))
           (type (type-error-expected-type condition))
           (words (or (common-type-text datum type)
                      (integer-range-text datum type)
                      (and (symbolp type) (find-class type nil)
                           (format nil "of the type ~(~A~)" type))))
           (value (safe-text datum :length 100)))
      (cond (words (format nil "The value ~A is not ~A.~@[ ~A~]"
                           value words (funcall *report-addition* condition)))
            ((member (type-of condition) '(type-error simple-type-error))
             (format nil "The value ~A cannot be used here." value))))))

;;; All of Lisp's own errors.

(defun remove-standard-reference (text)
  (let ((end (search (format nil "~%See also:") text)))
    (if end (subseq text 0 end) text)))

(defun undefined-name-text (condition)
  (format nil "The ~:[variable ~A has no value~;function ~A is undefined~].~@[ ~A~]"
          (typep condition 'undefined-function)
          (unqualified-text (cell-error-name condition))
          (funcall *report-addition* condition)))

(defun simulator-symbol-p (symbol)
  "True if the package of SYMBOL is one of the simulator's own packages."
  (let ((package (symbol-package symbol)))
    (and package (starts-with-subseq "ARS-MAGNA." (package-name package)))))

(defun name-conflict-text (condition)
  "Return a text for the name conflict CONDITION if the simulator owns one of the symbols, or NIL."
  (let* ((symbols (sb-ext:name-conflict-symbols condition))
         (ours (find-if #'simulator-symbol-p symbols)))
    (when ours
      (format nil "~A would mean ~{~A:~A~^ and ~} here. Choose one of them first, by ~
                   (shadowing-import 'ars:~(~A~)) or in a defpackage (:shadowing-import-from :ars ~
                   #:~(~:*~A~)); or write (ars:define-user-package :mine) for a package without ~
                   such conflicts."
              (symbol-name ours)
              ;; Their order depends on the version of SBCL.
              (loop for symbol in (cons ours (remove ours symbols))
                    collect (package-name (symbol-package symbol))
                    collect (symbol-name symbol))
              (symbol-name ours)))))

;; Lisp's own text shows the stream.
(defun access-refused-text (condition)
  "Return the simulator's text for the stream error CONDITION if the system refused access; or NIL."
  (let* ((text (one-line (princ-to-string condition))) (place (search ": " text :from-end t))
         (file (ignore-errors (pathname (stream-error-stream condition))))
         (input-p (starts-with-subseq "couldn't read from" text)))
    (when (and place (or input-p (starts-with-subseq "Couldn't write to" text)))
      (format nil "~:[The ~:[out~;in~]put~*~;The file ~*~A~] cannot be ~:[written~;read~]: ~A."
              file input-p (and file (native-name file)) input-p
              (string-downcase (string-right-trim "." (subseq text (+ 2 place))))))))

(defun lisp-error-text (condition)
  "Return the simulator's text for CONDITION, an error of Lisp or SBCL; NIL if there is none."
  (ignore-errors
   (when (lisp-symbol-p (type-of condition))
     (typecase condition
       (arithmetic-error
        (second (assoc-if (lambda (type) (typep condition type)) *arithmetic-texts*)))
       (sb-ext:name-conflict (name-conflict-text condition))
       ((or undefined-function unbound-variable) (undefined-name-text condition))
       (stream-error (access-refused-text condition))
       ;; Lisp's own text for ECASE and the like is used.
       (type-error (unless (string= "CASE-FAILURE" (type-of condition))
                     (type-error-text condition)))))))

;;;; Texts of bounded length

;;; A condition may report a circular list, or an object that cannot be printed.

(defmacro printing-briefly (() &body body)
  "Run BODY, which makes text for people. Deep, long and circular data are abridged."
  `(printing-text ()
     (let ((*print-circle* t) (*print-length* 100) (*print-level* 20) (*print-pretty* nil))
       ,@body)))

(defun format-briefly (destination control &rest arguments)
  "Call FORMAT with the same arguments, but abridge deep, long and circular ARGUMENTS."
  (printing-briefly () (apply #'format destination control arguments)))

(defun report-briefly (condition)
  "Return the report of CONDITION, or the printed form of another object, abridged as by
FORMAT-BRIEFLY. An object that is already being printed does not count as circular."
  (with-output-to-string (out)
    (printing-briefly () (let ((*print-escape* nil)) (print-object condition out)))))

;;; Conditions.

(defun storage-error-text (condition)
  (if (stack-full-p condition)
      (format nil "The stack has overflowed: calls or lists are nested too deeply. Look for a ~
                   recursion that does not end.")
      "There is not enough memory. Use smaller or fewer objects at a time."))

(defun reading-error-p (condition)
  "True if CONDITION says that typed text, or text of a program, cannot be read as Lisp."
  (or (typep condition 'reader-error)
      (and (typep condition 'end-of-file)
           (not (typep (stream-error-stream condition) 'file-stream)))))

(defun cause-of-reading-error (condition)
  "Return the original cause of CONDITION. LOAD wraps conditions in others that add a position."
  (let ((cause (encapsulated-condition condition)))
    (if cause (cause-of-reading-error cause) condition)))

(defun unreadable-name-remedy (text)
  "Return a sentence with a remedy if the error text TEXT is about an unreadable name; else NIL."
  (cond ((or (search "not found in the" text) (search "Package" text))
         "Perhaps the name is misspelt, or the file that defines it is not loaded")
        ((search "is not external" text)
         "To use an internal symbol of that package, write two colons")))

(defun encoding-error-text (condition)
  "If CONDITION says that a file has an unexpected encoding, return a text that says so; else NIL."
  (let ((encoding (format-of-decoding-error condition)))
    (and encoding
         (format nil "it has bytes that are not ~A. Save the file in ~:*~A" encoding))))

(defun undecodable-file-text (condition)
  (let ((trouble (encoding-error-text condition)))
    (and trouble
         (format nil "~:[This~;~:*~A~] cannot be read: ~A."
                 (ignore-errors (native-name (pathname (stream-error-stream condition))))
                 trouble))))

(defun reading-error-text (condition)
  "Return the text of CONDITION, an error of the Lisp reader, without names of streams."
  (let* ((cause (cause-of-reading-error condition))
         (text (cond ((encoding-error-text cause))
                     ((typep cause 'simple-condition)
                      (format-briefly nil "~?" (simple-condition-format-control cause)
                                      (simple-condition-format-arguments cause)))
                     (t "it ends too early; is a parenthesis or quote missing?"))))
    (if (starts-with-subseq "failed to build" text)
        "a number is too large, too small, or divided by 0"
        (format nil "~A~@[. ~A~]" (string-right-trim "." text) (unreadable-name-remedy text)))))

(defgeneric typed-input-p (stream)
  (:documentation "True if STREAM reads the lines that a user types or pipes in.")
  (:method (stream)
    (declare (ignore stream))
    nil))

(defun printable-report (condition)
  "Return the report of CONDITION, as far as it can be printed. For another object, return its
printed form, or an empty text if it cannot be printed."
  (handler-case (remove-standard-reference (report-briefly condition))
    ((or error storage-condition) ()
      ;; There may be nothing that can be printed.
      (or (and (typep condition 'condition) (ignore-errors (partial-report condition)))
          ""))))

;;; A report may fail, also in a method of PRINT-OBJECT. What it has written until then is shown.

(defun without-addresses (text)
  "Return TEXT without the addresses of objects, which differ in each process."
  (loop for start = (search " {" text)
        for end = (and start (position #\} text :start start))
        while (and end (every (lambda (char) (digit-char-p char 16)) (subseq text (+ 2 start) end)))
        do (setf text (concatenate 'string (subseq text 0 start) (subseq text (1+ end))))
        finally (return text)))

(defun failing-report-text (condition trouble beginning)
  "Return a text for CONDITION, whose report wrote BEGINNING and failed with the error TROUBLE."
  (let ((why (or (simulator-error-text trouble)
                 (ignore-errors (format-briefly nil "~A" trouble))
                 ;; Its text may contain CONDITION, which cannot be printed.
                 (ignore-errors (simple-condition-format-control trouble))
                 (type-of trouble))))
    (format nil "~@[~A... ~](~(~A~), whose report fails: ~A)"
            (and (string/= "" beginning) (string-right-trim " " beginning))
            (type-of condition)
            (without-addresses (one-line (princ-to-string why))))))

(defun write-report (condition stream)
  "Write the report of CONDITION to STREAM, with a text in place of each unprintable object."
  (printing-briefly ()
    (let ((sb-ext:*suppress-print-errors* 'error) (*print-escape* nil) (*print-circle* nil))
      (print-object condition stream))))

(defun partial-report (condition)
  "Return the printable part of CONDITION's report, and a text that says that the report fails."
  (let ((out (make-string-output-stream)))
    (handler-case (progn (write-report condition out)
                         (format nil "~A (~(~A~), whose report fails)"
                                 (without-addresses (get-output-stream-string out))
                                 (type-of condition)))
      ((or error storage-condition) (trouble)
        (failing-report-text condition trouble (get-output-stream-string out))))))

(defun simulator-error-text (condition)
  "Return the simulator's text (the same for each SBCL) for CONDITION, a Lisp error; or NIL."
  (cond ((typep condition 'storage-condition) (storage-error-text condition))
        ((and (typep condition 'end-of-file) (typed-input-p (stream-error-stream condition)))
         "The input has ended: there is nothing left to read.")
        ((reading-error-p condition)
         (add-full-stop (format nil "This cannot be read: ~A" (reading-error-text condition))))
        ((undecodable-file-text condition))
        (t (lisp-error-text condition))))

(defun text-of-condition (condition)
  "Return the text of CONDITION, or its type if it has no text."
  (let ((text (or (printing-text () (simulator-error-text condition))
                  (printable-report condition))))
    (if (string= text "") (string-downcase (type-of condition)) (escape-controls text))))

(defun zero-if-tiny (number)
  "Return NUMBER, or 0 if NUMBER printed with two decimals would be 0.00 or -0.00."
  (if (< (abs number) 0.005d0) 0 number))

(defun coordinate-text (number)
  "Return the coordinate NUMBER, in metres, as text rounded to 0.1 mm: a typed 23.2 is shown as
23.2, not as 23.200000762939453. Numbers closer to 0 than 0.00005 have an exponent."
  (let ((text (string-right-trim "0" (format nil "~,4F" number))))
    (cond ((< 0 (abs number) 5d-5)
           (let ((*read-default-float-format* 'double-float)) (prin1-to-string (double number))))
          ((ends-with #\. text) (format nil "~A0" text))
          (t text))))

(defun point-text (x y)
  "Return the point (X, Y), in metres, as text."
  (format nil "(~A ~A)" (coordinate-text x) (coordinate-text y)))

(defun one-line-text (condition)
  "Return the text of CONDITION on one line, without a full stop, to be part of a sentence."
  (string-right-trim "." (cut (one-line (text-of-condition condition)) 400)))

;;; The output of editors.

(defun resolve-synonym-stream (stream)
  (if (typep stream 'synonym-stream)
      (resolve-synonym-stream (symbol-value (synonym-stream-symbol stream)))
      stream))

(defun editor-output-stream ()
  "Return the stream of this thread's standard output if an editor, SLIME or SLY, has set that
stream; else NIL. The stream stays open, and other threads may write to it. The standard output of
other threads does not reach the editor's prompt."
  (let* ((stream (resolve-synonym-stream *standard-output*))
         (package (symbol-package (type-of stream))))
    (and package
         (some (lambda (server) (starts-with-subseq server (package-name package)))
               '("SWANK" "SLYNK"))
         stream)))
