;;;; conditions.lisp -- errors of misuse, refused exits, and the limits of numbers.

(in-package :ars-magna.basics)

(export '(check-argument reject-argument malformed-definition-expected malformed-definition-place
          malformed-definition-clause warn-of-definition doubt-definition reject-name plain-name
          reject-use outlived reject-outlived names-to-show malformed-definition-definition
          call-refusing-exits refuse-exits call-allowing-exits +largest+ +largest-quantity+
          within-reason-p quantity-p amount-p probability-p whole-p tick-span-p
          define-with-keywords))

;;; A misused library signals one of these. A robot that fails in a task does not: it
;;; reports an error code through its command's continuation (manual 3.1.1).
;;;
;;; Who shows a report may have circles marked. What is in it is abridged and has none, but may have
;;; a text twice, which is to stand there twice.

(addition ars-magna-error)
(define-condition ars-magna-error (error)
  ()
  (:documentation "The root of every error that ARS MAGNA signals."))

(defmethod print-object :around ((condition ars-magna-error) stream)
  "Let nothing that a terminal obeys come to STREAM; what a report that fails has written comes."
  (if *print-escape*
      (call-next-method)
      (let ((out (make-string-output-stream)))
        (unwind-protect (call-next-method condition out)
          (write-string (visible (get-output-stream-string out)) stream)))))

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
                         (if (pathnamep value) (shown-name value) (abridged value)))
                       (sentence (wrong-argument-expected condition))))))
  (:documentation "A function was called with an argument that it cannot use."))

(defun reject-argument (operator name value expected)
  "Signal WRONG-ARGUMENT."
  (error 'wrong-argument :operator operator :name name :value value :expected expected))

(defmacro check-argument (operator place test expected)
  "Signal WRONG-ARGUMENT unless TEST holds; EXPECTED says in words what PLACE should be."
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
               (format stream "~A~@[ (~A)~]: ~:[nothing, or NIL, is where there should be ~*~;~
                               cannot use the clause~%  ~S;~%expected ~]~A"
                       (malformed-definition-definition condition)
                       (malformed-definition-place condition)
                       clause
                       (abridged clause)
                       (sentence (malformed-definition-expected condition))))))
  (:documentation "A defining form (DEFMAP, DEFROBOT ...) has a clause that makes no sense."))

(setf (documentation 'malformed-definition-definition 'function)
      "Return what was being defined, in words or as read."
      (documentation 'malformed-definition-place 'function)
      "Return the file and line of what makes no sense, a string, or NIL if it was typed."
      (documentation 'malformed-definition-clause 'function)
      "Return the clause that makes no sense, as read; NIL where something is missing."
      (documentation 'malformed-definition-expected 'function)
      "Return in words what should be there instead.")

(addition definition-warning definition-warning-text)
(define-condition definition-warning (warning)
  ((text :initarg :text :reader definition-warning-text))
  (:report (lambda (condition stream)
             (write-string (definition-warning-text condition) stream)))
  (:documentation "A definition can be used, but does perhaps not say what its author meant."))

(setf (documentation 'definition-warning-text 'function)
      "Return what a DEFINITION-WARNING says, a string.")

(define-condition definition-doubt (definition-warning style-warning)
  ()
  (:documentation "A definition needs what there is not yet, or has what it does not need; in a file
that is compiled, which must not fail for that."))

(defun text-for-author (control arguments)
  (printing-words ()
    (let ((*print-case* :downcase)) (apply #'format nil control arguments))))

(defun warn-of-definition (control &rest arguments)
  "Signal a DEFINITION-WARNING with a text formatted from CONTROL and ARGUMENTS."
  (warn 'definition-warning :text (text-for-author control arguments)))

(defun doubt-definition (control &rest arguments)
  "Do as WARN-OF-DEFINITION. The definition may be what its author meant: so in a file that is
compiled the warning is a STYLE-WARNING. Scripts, which do not show these, are not compiled."
  (warn (if *compile-file-truename* 'definition-doubt 'definition-warning)
        :text (text-for-author control arguments)))

(defun plain-name (name)
  "Return NAME as people write it: a symbol in lower case, without its package."
  (if (symbolp name) (string-downcase name) name))

(defun names-to-show (names)
  "Return NAMES as people write them, the first dozen of them if there are more."
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
                             (cut (plain-name name) +most-characters+)
                             (prin1-to-string (abridged name)))
                         (and nearest (plain-name nearest))
                         (names-to-show known)
                         remedy)))))
  (:documentation "A name was given that nothing of that kind has."))

(defun reject-name (kind name known &optional (meant known))
  "Signal UNKNOWN-NAME: nothing of KIND (a string) among the names KNOWN is called NAME. One of the
names MEANT could be meant."
  (error 'unknown-name :kind kind :name name :known known
                       :nearest (and (typep name '(or symbol string))
                                     (nearest-name name meant))))

(addition misuse)
(define-condition misuse (ars-magna-error)
  ((text :initarg :text :reader misuse-text))
  (:report (lambda (condition stream) (write-string (misuse-text condition) stream)))
  (:documentation "An operation was asked for at a moment or in a state that forbids it."))

(define-condition outlived (misuse)
  ()
  (:documentation "Something was asked of a run that is over, as by a program that was told so."))

(defun reject-outlived (control &rest arguments)
  "Signal OUTLIVED, a MISUSE, with a text formatted from CONTROL and ARGUMENTS."
  (error 'outlived :text (printing-words () (apply #'format nil control arguments))))

(defun reject-use (control &rest arguments)
  "Signal MISUSE with a text formatted from CONTROL and ARGUMENTS; it should name the remedy."
  (error 'misuse :text (printing-words () (apply #'format nil control arguments))))

;;;; Code that would end the Lisp in which it runs together with others'

(defvar *refusal* nil
  "What is said, a string, while code runs that is not to end this Lisp; else NIL.")

(defun refuse-exit (function &rest arguments)
  "Apply FUNCTION, which ends this Lisp, to ARGUMENTS. Signals MISUSE if that is refused."
  (when *refusal*
    (reject-use "~A" *refusal*))
  (apply function arguments))

(wrap-function 'sb-ext:exit #'refuse-exit)

(defun call-refusing-exits (function &optional (text "EXIT would end the whole program here. ~
                                                        Signal an error instead, or return."))
  "Call FUNCTION, in which EXIT signals MISUSE, with TEXT."
  (let ((*refusal* (format nil text))) (funcall function)))

(defun refuse-exits (text)
  "Let EXIT signal MISUSE with TEXT in each thread of this Lisp, where nothing else is said; or with
NIL end this Lisp again."
  (setf (global-value '*refusal*) text))

(defun call-allowing-exits (function)
  "Call FUNCTION, in which EXIT ends this Lisp, whatever goes on around it."
  (let ((*refusal* nil)) (funcall function)))

;;;; Limits of numbers, and functions that take keywords

;;; Positions, distances, speeds, angles and times are kept below 1e9 either way: there a
;;; double-float is exact to 1e-7 metres or radians, so that what is added up in a run stays true,
;;; and a count of ticks can be added to another for ever. (At 20 ticks a second 1e9 ticks take a
;;; year and a half.) What things are like, such as weights, is kept below 1e15, where every whole
;;; number is a double-float of its own, and sums and squares are far from overflowing. Infinities
;;; and what is no number are nowhere taken. ARGUMENT-TYPES.LISP says all this to users.

(define-constant +largest+ (expt 10 9)
  :documentation "How large positions, distances, speeds, angles and times are at most.")

(define-constant +largest-quantity+ (expt 10 15)
  :documentation "How large the numbers are at most that say what something is like.")

(defun other-within-p (value limit)
  (and (finite-p value) (<= (- limit) value limit)))

(declaim (inline within-p within-reason-p quantity-p))
(defun within-p (value limit)
  "True if VALUE is a number from -LIMIT to LIMIT, an integer."
  (if (typep value 'double-float)
      (and (finite-double-p value)
           (<= (double (- limit)) value (double limit)))
      (other-within-p value limit)))

(defun within-reason-p (value)
  "True if VALUE can be a position, distance, speed, angle or time: from -1e9 to 1e9."
  (within-p value +largest+))

(defun quantity-p (value)
  "True if VALUE can say what something is like: a number from -1e15 to 1e15."
  (within-p value +largest-quantity+))

(defun amount-p (value)
  "True if VALUE is a quantity not below 0."
  (and (quantity-p value) (not (minusp value))))

(defun probability-p (value)
  "True if VALUE is a number from 0 to 1."
  (and (finite-p value) (<= 0 value 1)))

(defun whole-p (value &optional (least 0) (most +largest+))
  "True if VALUE is an integer from LEAST to MOST."
  (and (integerp value) (<= least value most)))

(defun tick-span-p (value)
  "True if VALUE is how long something can last: a whole number of ticks, from 0 to 1e9."
  (whole-p value))

;;;; Keywords

(defun check-keywords (operator known options)
  "Signal UNKNOWN-NAME if the list OPTIONS, given to OPERATOR, has a keyword that is not one of
KNOWN."
  (loop for (key) on options by #'cddr
        unless (or (member key known) (eq key :allow-other-keys))
          do (reject-name (format nil "keyword of ~(~A~)" operator) key known)))

(defun warn-of-keywords (operator known options)
  "Warn, while a call of OPERATOR is compiled, of a keyword among the forms OPTIONS that is not one
of KNOWN, and of a number in the place of one."
  (loop for (key) on options by #'cddr
        when (and (keywordp key) (not (member key known)) (not (eq key :allow-other-keys)))
          do (simple-style-warning "~(~A~) has no keyword ~(~S~); it knows ~{~(~S~)~^, ~}."
                                   operator key known)
        when (realp key)
          do (doubt-definition "~(~A~): ~S stands where a keyword should. Write one before it: ~
                                ~{~(~S~)~^, ~}." operator key known)))

(defun with-options (lambda-list)
  "Return LAMBDA-LIST with any keywords allowed, the variable of all that are given, which are
known, and how many arguments come before them."
  (destructuring-bind (required optional rest keys allowed aux keys-p)
      (multiple-value-list (parse-ordinary-lambda-list lambda-list))
    (declare (ignore optional allowed aux keys-p))
    (let ((options (or rest (gensym "OPTIONS"))) (place (position '&key lambda-list)))
      (values (append required (list '&rest options) (subseq lambda-list place)
                      '(&allow-other-keys))
              options
              (mapcar #'caar keys)
              (length required)))))

(defmacro define-with-keywords (name lambda-list documentation &body body)
  "Define the function NAME as DEFUN does, with LAMBDA-LIST, which has keywords and nothing optional
besides. Called with a keyword that is not among these it signals UNKNOWN-NAME, which lists them;
the compiler warns of such a call."
  (multiple-value-bind (all options known count) (with-options lambda-list)
    (multiple-value-bind (forms declarations) (parse-body body)
      `(progn
         (defun ,name ,all
           ,documentation
           ,@declarations
           (check-keywords ',name ',known ,options)
           ,@forms)
         (define-compiler-macro ,name (&whole form &rest arguments)
           (warn-of-keywords ',name ',known (nthcdr ,count arguments))
           form)
         (show-lambda-list ',name ',lambda-list #',name)
         ',name))))
