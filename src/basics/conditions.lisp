;;;; conditions.lisp -- the errors of misuse, refused exits, and the limits of numbers.

(in-package :ars-magna.basics)

(export '(check-argument reject-argument malformed-definition-expected malformed-definition-place
          malformed-definition-clause warn-of-definition warn-of-style reject-name plain-name
          reject-use run-is-over-error reject-finished-run names-to-show
          malformed-definition-definition call-refusing-exits refuse-exits call-allowing-exits
          +largest+ +largest-quantity+ sane-number-p bounded-number-p amount-p probability-p whole-p
          define-with-keywords))

;;; Misuse of the library signals one of these. A robot that fails in a task does not: it reports an
;;; error code to its command's continuation (manual 3.1.1).
;;;
;;; *PRINT-CIRCLE* may be true where a report is shown. The text is abridged and has no circles, but
;;; may contain a text twice, which must be printed twice.

(addition ars-magna-error)
(define-condition ars-magna-error (error)
  ()
  (:documentation "The root of all errors that ARS MAGNA signals."))

(defmethod print-object :around ((condition ars-magna-error) stream)
  "Print the report of CONDITION to STREAM, as far as possible, without control characters."
  (if *print-escape*
      (call-next-method)
      (let ((out (make-string-output-stream)))
        (unwind-protect (call-next-method condition out)
          (write-string (escape-controls (get-output-stream-string out)) stream)))))

(addition wrong-argument)
(define-condition wrong-argument (ars-magna-error)
  ((operator :initarg :operator :reader wrong-argument-operator)
   (name     :initarg :name     :reader wrong-argument-name)
   (value    :initarg :value    :reader wrong-argument-value)
   (expected :initarg :expected :reader wrong-argument-expected))
  (:report (lambda (condition stream)
             (let ((*print-circle* nil))
               (format stream "~(~A~): ~(~A~) is ~S; give ~A"
                       (wrong-argument-operator condition)
                       (wrong-argument-name condition)
                       (let ((value (wrong-argument-value condition)))
                         (if (pathnamep value) (file-name-text value) (abridged value)))
                       (add-full-stop (wrong-argument-expected condition))))))
  (:documentation "A function was called with an argument that it cannot use."))

(defun reject-argument (operator name value expected)
  "Signal WRONG-ARGUMENT."
  (error 'wrong-argument :operator operator :name name :value value :expected expected))

(defmacro check-argument (operator place test expected)
  "Signal WRONG-ARGUMENT unless TEST is true. The text EXPECTED says what values PLACE can have."
  `(unless ,test (reject-argument ',operator ',place ,place ,expected)))

(addition malformed-definition)
(define-condition malformed-definition (ars-magna-error)
  ((definition :initarg :definition :reader malformed-definition-definition)
   (clause     :initarg :clause     :reader malformed-definition-clause)
   (expected   :initarg :expected   :reader malformed-definition-expected)
   (place      :initarg :place      :initform nil :reader malformed-definition-place))
  (:report (lambda (condition stream)
             (let ((*print-case* :downcase) (*print-circle* nil)
                   (clause (malformed-definition-clause condition)))
               (format stream "~A~@[ (~A)~]: ~:[there is nothing, or NIL, in place of ~*~;cannot ~
                               use the clause~%  ~S;~%expected ~]~A"
                       (malformed-definition-definition condition)
                       (malformed-definition-place condition)
                       clause
                       (abridged clause)
                       (add-full-stop (malformed-definition-expected condition))))))
  (:documentation "A defining form (DEFMAP, DEFROBOT ...) has an invalid clause."))

(setf (documentation 'malformed-definition-definition 'function)
      "Return the definition with the invalid clause: a text such as \"defmap yard\", or a form."
      (documentation 'malformed-definition-place 'function)
      "Return the file and line of the invalid clause, as a string; NIL if the clause was typed."
      (documentation 'malformed-definition-clause 'function)
      "Return the invalid clause, a form; NIL if the clause is missing."
      (documentation 'malformed-definition-expected 'function)
      "Return a text that describes a valid clause.")

(addition definition-warning definition-warning-text)
(define-condition definition-warning (warning)
  ((text :initarg :text :reader definition-warning-text))
  (:report (lambda (condition stream)
             (write-string (definition-warning-text condition) stream)))
  (:documentation "A definition is valid, but may not be what its author meant."))

(setf (documentation 'definition-warning-text 'function)
      "Return the text of a DEFINITION-WARNING, a string.")

(define-condition doubtful-definition (definition-warning style-warning)
  ()
  (:documentation "A definition in a compiled file may have a mistake: it refers to something
undefined, or has an unused part. This is a style warning, so compiling does not fail."))

(defun format-for-author (control arguments)
  (printing-text ()
    (let ((*print-case* :downcase)) (apply #'format nil control arguments))))

(defun warn-of-definition (control &rest arguments)
  "Signal a DEFINITION-WARNING with a text formatted from CONTROL and ARGUMENTS."
  (warn 'definition-warning :text (format-for-author control arguments)))

(defun warn-of-style (control &rest arguments)
  "Like WARN-OF-DEFINITION, but the author may have intended the definition as it is. In a compiled
file the warning is a STYLE-WARNING. (Scripts hide style warnings, but scripts are not compiled.)"
  (warn (if *compile-file-truename* 'doubtful-definition 'definition-warning)
        :text (format-for-author control arguments)))

(defun plain-name (name)
  "Return NAME as text: a symbol in lower case, without its package."
  (if (symbolp name) (string-downcase name) name))

(defun names-to-show (names)
  "Return a list of texts: the first 12 of NAMES, and a text that says how many more there are."
  (let ((more (- (length names) 12)))
    (append (mapcar #'plain-name (subseq names 0 (min 12 (length names))))
            (when (plusp more) (list (format nil "and ~D more" more))))))

(addition unknown-name)
(define-condition unknown-name (ars-magna-error)
  ((kind    :initarg :kind    :reader unknown-name-kind)
   (name    :initarg :name    :reader unknown-name-name)
   (nearest :initarg :nearest :initform nil :reader unknown-name-nearest)
   (known   :initarg :known   :initform '() :reader unknown-name-known)
   (remedy  :initarg :remedy  :initform nil :reader unknown-name-remedy))
  (:report (lambda (condition stream)
             (with-accessors ((kind unknown-name-kind) (name unknown-name-name)
                              (nearest unknown-name-nearest) (known unknown-name-known)
                              (remedy unknown-name-remedy))
                 condition
               (let ((*print-circle* nil))
                 (format stream "There is no ~A called ~A.~@[ Did you mean ~A?~]~
                                 ~@[ Known: ~{~A~^, ~}.~]~@[ ~A~]"
                         kind
                         (if (symbolp name)
                             (cut (plain-name name) +shown-character-limit+)
                             (prin1-to-string (abridged name)))
                         (and nearest (plain-name nearest))
                         (names-to-show known)
                         remedy)))))
  (:documentation "No definition or object of the requested kind has the given name."))

(defun reject-name (kind name known &optional (meant known))
  "Signal UNKNOWN-NAME: there is no KIND (a string) with the name NAME. The error lists the names
KNOWN, and suggests the name in MEANT that is most similar to NAME."
  (error 'unknown-name :kind kind :name name :known known
                       :nearest (and (typep name '(or symbol string))
                                     (nearest-name name meant))))

(addition misuse)
(define-condition misuse (ars-magna-error)
  ((text :initarg :text :reader misuse-text))
  (:report (lambda (condition stream) (write-string (misuse-text condition) stream)))
  (:documentation "An operation is not allowed at this moment or in this state."))

(define-condition run-is-over-error (misuse)
  ()
  (:documentation "A program has requested an operation of a finished run."))

(defun reject-finished-run (control &rest arguments)
  "Signal RUN-IS-OVER-ERROR, a MISUSE, with a text formatted from CONTROL and ARGUMENTS."
  (error 'run-is-over-error :text (printing-text () (apply #'format nil control arguments))))

(defun reject-use (control &rest arguments)
  "Signal MISUSE with a text formatted from CONTROL and ARGUMENTS; it should name the remedy."
  (error 'misuse :text (printing-text () (apply #'format nil control arguments))))

;;;; Refusing to exit a Lisp that is shared with other code

(defvar *exit-refusal* nil
  "The text of the error that EXIT signals while code must not exit this Lisp; else NIL.")

(defun exit-unless-refused (function &rest arguments)
  "Apply FUNCTION, which exits this Lisp, to ARGUMENTS. Signals MISUSE if exits are refused."
  (when *exit-refusal*
    (reject-use "~A" *exit-refusal*))
  (apply function arguments))

(wrap-function 'sb-ext:exit #'exit-unless-refused)

(defun call-refusing-exits (function &optional (text "EXIT would end the whole program here. ~
                                                      Signal an error instead, or return."))
  "Call FUNCTION. Within FUNCTION, EXIT signals MISUSE with TEXT."
  (let ((*exit-refusal* (format nil text))) (funcall function)))

(defun refuse-exits (text)
  "Make EXIT signal MISUSE with TEXT in all threads of this Lisp, except within CALL-ALLOWING-EXITS.
If TEXT is NIL, let EXIT exit again."
  (setf (global-value '*exit-refusal*) text))

(defun call-allowing-exits (function)
  "Call FUNCTION. Within FUNCTION, EXIT exits this Lisp even if the caller refuses exits."
  (let ((*exit-refusal* nil)) (funcall function)))

;;;; Limits of numbers

;;; Positions, distances, speeds, angles and times are limited to 1e9 either way. There a
;;; double-float is exact to 1e-7 metres or radians, so sums in a run stay exact and tick counts can
;;; always be added. (At 20 ticks a second 1e9 ticks take a year and a half.) Attributes, such as
;;; weights, are limited to 1e15, where every whole number is a double-float, and sums and squares
;;; cannot overflow. Infinities and NaNs are never accepted. See also OPERATORS.LISP.

(define-constant +largest+ (expt 10 9)
  :documentation "The limit of positions, distances, speeds, angles and times.")

(define-constant +largest-quantity+ (expt 10 15)
  :documentation "The limit of attribute values.")

(defun non-double-within-p (value limit)
  (and (finite-p value) (<= (- limit) value limit)))

(declaim (inline within-p sane-number-p bounded-number-p))
(defun within-p (value limit)
  (if (typep value 'double-float)
      (and (finite-double-p value)
           (<= (double (- limit)) value (double limit)))
      (non-double-within-p value limit)))

(defun sane-number-p (value)
  "True if VALUE is a possible position, distance, speed, angle or time: from -1e9 to 1e9."
  (within-p value +largest+))

(defun bounded-number-p (value)
  "True if VALUE is a number from -1e15 to 1e15, as the value of an attribute must be."
  (within-p value +largest-quantity+))

(defun amount-p (value)
  "True if VALUE is a number from 0 to 1e15."
  (and (bounded-number-p value) (not (minusp value))))

(defun probability-p (value)
  "True if VALUE is a number from 0 to 1."
  (and (finite-p value) (<= 0 value 1)))

(defun whole-p (value &optional (least 0) (most +largest+))
  "True if VALUE is an integer from LEAST to MOST."
  (and (integerp value) (<= least value most)))

;;;; Keywords

(defun check-keywords (operator known options)
  "Signal UNKNOWN-NAME if the list OPTIONS, passed to OPERATOR, has a keyword that is not in KNOWN."
  (loop for (key) on options by #'cddr
        unless (or (member key known) (eq key :allow-other-keys))
          do (reject-name (format nil "keyword of ~(~A~)" operator) key known)))

(defun warn-unknown-keywords (operator known options)
  "Warn if OPTIONS for OPERATOR have an unknown keyword, or a number in place of a keyword."
  (loop for (key) on options by #'cddr
        when (and (keywordp key) (not (member key known)) (not (eq key :allow-other-keys)))
          do (simple-style-warning "~(~A~) has no keyword ~(~S~); it knows ~{~(~S~)~^, ~}."
                                   operator key known)
        when (realp key)
          do (warn-of-style "~(~A~): ~S stands in the place of a keyword. Write a keyword ~
                             before ~:*~S: ~{~(~S~)~^, ~}." operator key known)))

(defun lambda-list-with-options (lambda-list)
  "Return four values: LAMBDA-LIST with any keywords allowed; the variable that holds all options;
the known keywords; and the number of arguments before the options."
  (multiple-value-bind (required optional rest keys) (parse-ordinary-lambda-list lambda-list)
    (declare (ignore optional))
    (let ((options (or rest (gensym "OPTIONS"))) (place (position '&key lambda-list)))
      (values (append required (list '&rest options) (subseq lambda-list place)
                      '(&allow-other-keys))
              options
              (mapcar #'caar keys)
              (length required)))))

(defmacro define-with-keywords (name lambda-list documentation &body body)
  "Define the function NAME like DEFUN, with a LAMBDA-LIST that has keywords and no optional
parameters. A call with an unknown keyword signals UNKNOWN-NAME, which lists the known keywords. The
compiler warns of a call with an unknown keyword."
  (multiple-value-bind (all options known count) (lambda-list-with-options lambda-list)
    (multiple-value-bind (forms declarations) (parse-body body)
      `(progn
         (defun ,name ,all
           ,documentation
           ,@declarations
           (check-keywords ',name ',known ,options)
           ,@forms)
         (define-compiler-macro ,name (&whole form &rest arguments)
           (warn-unknown-keywords ',name ',known (nthcdr ,count arguments))
           form)
         (show-lambda-list ',name ',lambda-list #',name)
         ',name))))
