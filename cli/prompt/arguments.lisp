;;;; arguments.lisp -- from the characters of a line to arguments, and the possible arguments.

(in-package :ars-magna.cli)

;;; The Lisp reader reads arguments, evaluating nothing (manual E). Numbers stand for cameras,
;;; hands, storage bins and designators. A comment begins with a semicolon, or with a lone #.

;; As reading 227 says.
(defgeneric read-argument (type datum robot)
  (:documentation
   "Return the argument of TYPE, a keyword, for which the typed DATUM stands. Parts of ROBOT are
typed by number. Signal BAD-LINE for an invalid DATUM. Without a method for TYPE, return DATUM.")
  (:method (type datum robot)
    (cond ((part-type-p type)
           (element-numbered datum (parts-of-kind robot type) (part-kind-text type) robot))
          ((typed-by-number-p type) (designator-numbered datum robot))
          (t datum))))

(defun part-type-p (type)
  (and (find-kind-name type 'part) t))

(defun part-kind-text (type)
  (substitute #\Space #\- (string-downcase type)))

;;; Parts by number.

(defun element-numbered (index elements kind robot)
  (let ((count (length elements)))
    (cond ((zerop count) (reject-line "~A has no ~A." robot kind))
          ((not (typep index 'unsigned-byte))
           (reject-line "~S is not the number of a ~A. Give a number from 0." index kind))
          ((< index count) (aref elements index))
          (t (reject-line "There is no ~A ~D. ~A has ~D, numbered from 0."
                          kind index robot count)))))

(defun designator-numbered (datum robot)
  (or (find-designator robot datum)
      (reject-line "There is no designator ~S. STATUS lists the designators." datum)))

(defun keyword-of-symbol (datum)
  (if (and datum (symbolp datum)) (make-keyword (symbol-name datum)) datum))

(defmethod read-argument ((type (eql :designator-type)) datum robot)
  (declare (ignore robot))
  (keyword-of-symbol datum))

(defmethod read-argument ((type (eql :receiving-part)) datum robot)
  (declare (ignore robot))
  (keyword-of-symbol datum))

(defmethod read-argument ((type (eql :recipient)) datum robot)
  (declare (ignore robot))
  (if (and (symbolp datum) (string= "ALL" datum)) :all datum))

(defun typed-by-number-p (type)
  (or (member type '(:designator :destination))
      (part-type-p type)))

(defmethod argument-description ((type symbol))
  (let ((key (type-keyword type)))
    (if (typed-by-number-p key)
        (format nil "the number of a ~A" (if (part-type-p key) (part-kind-text key) "designator"))
        (format nil "~A~@[, such as ~A~]" (argument-type-text type) (quantity-examples type)))))

(defmethod argument-description ((type (eql 'designator-type)))
  "local or non-local")

;;; The prompt's own types.

(define-argument-type 'count #'whole-p "a whole number, from 0 to 1e9")
(define-argument-type 'steps (lambda (value) (whole-p value 1))
  "a whole number of ticks, from 1 to 1e9")

;;; Reading.

(defun reject-reader-macro (stream char argument)
  (declare (ignore stream argument))
  (error "#~C can be used only in Lisp, not as an argument" char))

(defun read-data-from-string (text start)
  "Return the Lisp datum in TEXT at START and the position of its end. Signal errors for #. and #S."
  (let ((*read-eval* nil) (*readtable* (copy-readtable)))
    ;; That makes objects by calling functions.
    (set-dispatch-macro-character #\# #\S #'reject-reader-macro)
    (read-from-string text t nil :start start :preserve-whitespace t)))

(defun strip-quote (datum)
  "Return DATUM without the quote that Lisp users may type before it."
  (if (typep datum '(cons (eql quote) (cons t null)))
      (second datum)
      datum))

(defun read-datum (text start line)
  "Return the Lisp datum in TEXT at START and the position of its end (reading 196). The datum is
not evaluated, so a quote before the datum does not matter."
  (handler-case (multiple-value-bind (datum end) (read-data-from-string text start)
                  (values (strip-quote datum) end))
    (end-of-file ()
      (reject-line "~A is not complete: a parenthesis or quote is missing. ~A"
                   (subseq text start) (arguments-text line)))
    (error (condition)
      (reject-line "~A cannot be read: ~A. ~A" (subseq text start)
                   (one-line (if (typep condition 'reader-error)
                                 (reading-error-text condition)
                                 (condition-text condition)))
                   (arguments-text line)))))

(defun integer-if-whole (value)
  (if (and (floatp value) (bounded-number-p value) (= value (round value)))
      (round value)
      value))

(defun coerce-for-type (value type)
  "Return the typed VALUE. If only an equal integer is of the argument TYPE, return that integer."
  (if (argument-of-type-p value type)
      value
      (let ((whole (integer-if-whole value)))
        (if (argument-of-type-p whole type) whole value))))

(defun check-argument-read (value parameter line)
  (unless (argument-of-type-p value (line-parameter-type parameter))
    (let ((trouble (argument-trouble-text value (line-parameter-type parameter))))
      (reject-line "~A cannot be ~S~@[: ~A~]~:[.~;~] ~A"
                   (line-parameter-name parameter) value trouble
                   (and trouble (ends-with #\? trouble))
                   (arguments-text line)))))

(deftype rest-type ()
  "The types of arguments that take the rest of a line."
  '(member :rest :line :form :map-words :plot))

(defun token-value (type token)
  "Return what TOKEN stands for as an argument of TYPE. In the name of a file, ~ is expanded."
  (if (eq type :file) (native-name (path-of-name token)) token))

(defun read-line-parameter (parameter text start line)
  "Return the argument for PARAMETER of LINE in TEXT at START, and the position of its end."
  (typecase (line-parameter-type parameter)
    (rest-type (values (string-trim " " (subseq text start)) (length text)))
    (keyword (let* ((end (token-end text start))
                    (token (string-trim "\"" (subseq text start end))))
               (values (token-value (line-parameter-type parameter) token) end)))
    (t (multiple-value-bind (datum end) (read-number-or-datum parameter text start line)
         (let ((value (coerce-for-type
                       (read-argument (type-keyword (line-parameter-type parameter)) datum
                                      (robot-of-arguments line))
                       (line-parameter-type parameter))))
           (check-argument-read value parameter line)
           (values value end))))))

(defun read-number-or-datum (parameter text start line)
  "Return the number or datum typed in TEXT at START for PARAMETER of LINE, and the position of its
end. Numbers with units are converted to the simulator's own units."
  (multiple-value-bind (datum end) (read-datum text start line)
    (read-quantity datum text start end (line-parameter-type parameter)
                   (lambda (trouble) (reject-line "~A ~A" trouble (arguments-text line))))))

(defun robot-of-arguments (line)
  "Return the robot whose parts the arguments of LINE name; NIL if the arguments name no parts."
  (and (some (lambda (parameter) (typed-by-number-p (type-keyword (line-parameter-type parameter))))
             (line-parameters line))
       (session-robot)))

(defun reject-surplus-text (line text)
  "Signal BAD-LINE because TEXT follows LINE's last argument. List the units that could follow it."
  (let* ((parameter (first (last (line-parameters line))))
         (dimension (and parameter (dimension-of (line-parameter-type parameter)))))
    (if (and dimension (alpha-char-p (char text 0)))
        (reject-line "~A is not a unit for ~A. Known units: ~{~A~^, ~}. ~A" text
                     (dimension-text dimension) (unit-names dimension) (arguments-text line))
        (reject-line "~A is too much. ~A~@[ ~A~]" text (arguments-text line)
                     (and (string= "GO" (line-name line)) "GO-TO x y drives to a place.")))))

(defun read-arguments (line text)
  (let ((position (skip-blanks text 0)))
    (flet ((over-p () (= position (length text)))
           (advance (value end) (setf position (skip-blanks text end)) value))
      (prog1 (loop for parameter in (line-parameters line)
                   until (and (over-p) (line-parameter-optional-p parameter))
                   when (over-p)
                     do (reject-line "~A is missing. ~A" (line-parameter-name parameter)
                                     (arguments-text line))
                   collect (multiple-value-call #'advance
                             (read-line-parameter parameter text position line)))
        (unless (over-p) (reject-surplus-text line (subseq text position)))))))

;;;; What can be typed for an argument

(defgeneric argument-choices (type session typed)
  (:documentation "Return a list of possible arguments of TYPE, a keyword, in SESSION: strings,
symbols and numbers. TYPED is the text typed so far; choices that do not begin with TYPED may be
included. Return NIL if the choices are not known. May signal BAD-LINE, as without a robot.")
  (:method (type session typed)
    (declare (ignore session typed))
    (when (part-type-p type)
      (loop for index below (length (parts-of-kind (session-robot) type))
            collect index))))

(defmacro define-argument-choices (type form)
  "Make the value of FORM the choices for an argument of TYPE, whatever was typed so far."
  `(defmethod argument-choices ((type (eql ,type)) session typed)
     (declare (ignore session typed))
     ,form))

(defun designator-numbers ()
  (mapcar #'designator-number (live-designators (session-robot))))

(define-argument-choices :designator (designator-numbers))
(define-argument-choices :destination (designator-numbers))
(define-argument-choices :designator-type '(local non-local))
(define-argument-choices :receiving-part '(hand bin))
(define-argument-choices :direction
  '(north north-east east south-east south south-west west north-west))
(define-argument-choices :recipient
  (cons "all" (names-as-typed (remove (robot-name (session-robot)) (current-robot-names)))))
(define-argument-choices :odometer-part '(:pos :ang))
(define-argument-choices :place-type (mapcar #'place-type-name (all-place-types)))
(define-argument-choices :rate '(free))
(define-argument-choices :parameter
  (append (mapcar #'parameter-name (all-parameters)) '("clean" "default")))
(define-argument-choices :switch '(on off))
(define-argument-choices :off '(off))
(define-argument-choices :experiment (append (question-names) '(off)))

;;; Worlds and robots.

(defmethod argument-choices ((type (eql :world)) session typed)
  (append (mapcar #'map-name (maps-with-robots))
          (remove-if-not (lambda (file)
                           (or (uiop:string-suffix-p file "/") (uiop:string-suffix-p file ".lisp")))
                         (argument-choices :file session typed))))

(defun names-as-typed (names)
  "Return NAMES, names of robots, as texts to type."
  (mapcar #'string-downcase (labels-of-names names)))

(define-argument-choices :robot-name (names-as-typed (robot-names)))
(define-argument-choices :robot-here (names-as-typed (current-robot-names)))
(define-argument-choices :robots (cons "all" (names-as-typed (current-robot-names))))

;;; Files.

(defun directory-entries (directory)
  "Return the names of the files and subdirectories in DIRECTORY, as the operating system spells
them. Names of subdirectories end in a slash."
  (let ((path (path-of-name directory)))
    (flet ((without-directory (entry)
             (let ((name (native-name entry)))
               (subseq name (1+ (or (position #\/ name :from-end t :end (1- (length name)))
                                    -1))))))
      (mapcar #'without-directory
              (ignore-errors (append (uiop:subdirectories path) (uiop:directory-files path)))))))

(defmethod argument-choices ((type (eql :file)) session typed)
  (declare (ignore session))
  (let* ((slash (position #\/ typed :from-end t))
         (directory (subseq typed 0 (if slash (1+ slash) 0)))
         (start (subseq typed (length directory))))
    (loop for name in (directory-entries (if slash directory "./"))
          when (and (starts-with-subseq start name)
                    (or (string/= "" start) (char/= #\. (char name 0))))
            collect (uiop:strcat directory name))))

;;; Names of commands.

(defmethod argument-choices ((type (eql :command)) session typed)
  (declare (ignore session))
  (let ((names (if (items-with-prefix (string-upcase typed) (all-line-commands) #'line-name)
                   (mapcar #'line-name (all-line-commands))
                   (all-line-command-names))))
    (mapcar #'string-downcase (append names (mapcar #'first *aliases*)))))
