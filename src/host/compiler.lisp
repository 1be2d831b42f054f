;;;; compiler.lisp -- the position of the compiler and of LOAD; work deferred to a unit's end.

(in-package :ars-magna.host)

(export '(show-lambda-list nested-form-p edited-file error-context context-original-form
          compiler-error-p copy-source-location has-source-location-p call-at-source-location
          at-end-of-unit call-in-new-unit location-in-text compiler-location form-start
          line-of-last-character line-of-next-character encapsulated-condition
          format-of-decoding-error))

;;; SBCL records the location of each list that it has read to compile or load. COPY-SOURCE-LOCATION
;;; gives a list made from another list the location of that list, so that the compiler's notes
;;; point to the author's text. The locations are in the compiler's tables and variables.

(defmacro compiler-variable (name)
  `',(internal-name :sb-c name))

(defun value-if-bound (variable)
  (and (boundp variable) (symbol-value variable)))

(defun show-lambda-list (name lambda-list &optional (function (macro-function name)))
  "Make editors and DESCRIBE show LAMBDA-LIST for FUNCTION, by default that of the macro NAME."
  (when (compiled-function-p function)
    (funcall (fdefinition `(setf ,(internal-name :sb-c '#:%simple-fun-arglist)))
             lambda-list function)))

(defun nested-form-p (environment)
  "True if a form in ENVIRONMENT is inside another form that is being compiled."
  (and environment (internal (:sb-c #:lexenv-lambda) environment) t))

;;; Source locations.

(defun source-location-table ()
  "Return the table of the source locations of forms in the current compilation, or NIL."
  (let ((table (value-if-bound (compiler-variable #:*source-paths*))))
    (and (hash-table-p table) table)))

(defun source-location (form)
  (let ((table (source-location-table)))
    (and table (consp form) (values (gethash form table)))))

(defun has-source-location-p (form)
  "True if FORM has a source location in the current compilation."
  (and (source-location form) t))

(defun copy-source-location (new old)
  "Give the form NEW the source location of the form OLD, unless NEW has a location. Return NEW."
  (let ((location (and (consp new) (not (eq new old)) (source-location old))))
    (when (and location (not (source-location new)))
      (setf (gethash new (source-location-table)) location))
    new))

(defun call-at-source-location (form function)
  "Call FUNCTION. The compiler attributes its warnings to FORM."
  (let ((location (source-location form)))
    (progv (and location (list (compiler-variable #:*current-path*))) (list location)
      (funcall function))))

;;; An editor that compiles a piece of a file copies it to another file and says where it is from.

(defun edited-file ()
  "If an editor compiles a part of a file, return the name of that file, a string; else NIL."
  (let ((file (getf (value-if-bound (compiler-variable #:*source-plist*)) :emacs-filename)))
    (and *compile-file-truename* (stringp file) file)))

;;; Deferred warnings.

(defun error-context ()
  "Return the compiler's current error context."
  (internal (:sb-c #:find-error-context) nil))

(defun context-original-form (context)
  "Return the text of the form that CONTEXT, an error context of the compiler, is about."
  (internal (:sb-c #:compiler-error-context-original-form) context))

(defun compiler-error-p (condition)
  "True if CONDITION says that the compiler cannot read or compile a form, and continues with the
next form. ENCAPSULATED-CONDITION returns the cause of CONDITION."
  (internal-type-p condition :sb-c #:compiler-error))

(defun wrap-unit-summaries (wrapper)
  "When a compilation unit ends, call WRAPPER with SBCL's reporter, and true if the unit aborted."
  (if-internal (:sb-c #:summarize-compilation-unit)
    (wrap-function (internal-name :sb-c '#:summarize-compilation-unit) wrapper)
    wrapper))

;;; SBCL also records where each top-level form begins in the text.

(defvar *deferred-location* nil
  "During deferred work, a cons (form . location): its form and the form's location; else NIL.")

(defun source-location-at (path)
  "Return the location, as LOCATION-IN-TEXT does, of the form with the source path PATH; or NIL.
PATH is a list of numbers, the innermost first."
  (destructuring-bind (&optional top . numbers) (reverse path)
    (let* ((info (value-if-bound (compiler-variable #:*source-info*)))
           (positions (and info
                           (internal (:sb-c #:file-info-positions)
                                     (internal (:sb-c #:source-info-file-info) info)))))
      (and top positions (< top (length positions))
           (cons (aref positions top) numbers)))))

(defun compiler-location ()
  "Return the pathname of the file that is being compiled, and the location of the current form, as
LOCATION-IN-TEXT returns it, or NIL. Return NIL if no file is being compiled."
  (let* ((context (and *compile-file-truename* (error-context)))
         (file (and context (internal (:sb-c #:compiler-error-context-file-name) context))))
    (when (pathnamep file)
      (values file (source-location-at
                    (internal (:sb-c #:compiler-error-context-original-source-path) context))))))

(defun location-in-text (form)
  "Return the location of FORM in the text that is being compiled or loaded; NIL if unknown. A
location is a list (position index...): the position after which the top-level form begins, and the
indices, from 0, of the elements that lead to FORM."
  (cond
    ((and *deferred-location* (eq form (first *deferred-location*))) (rest *deferred-location*))
    ((edited-file) nil)
    (t (source-location-at (nthcdr 2 (source-location form))))))

;;; What can be checked only when a whole file, or all files of a system, have been read.
;;;
;;; Forms that are loaded together make a unit. So do files compiled in one WITH-COMPILATION-UNIT,
;;; and a file compiled alone. Lisp also makes a unit for each evaluated form; its deferred work is
;;; left to the unit around it.

(defstruct (unit (:constructor make-unit (kind outer)) (:copier nil))
  "Files or forms that are compiled or loaded as a whole, within the unit OUTER. TASKS is a table
from forms to lists: a function to call at the end of the unit, the compiler's error context for the
form, and the form's location in the text."
  (kind :load :type (member :load :compilation) :read-only t)
  (outer nil :type (or null unit) :read-only t)
  (files-p nil :type boolean)
  (tasks (make-hash-table :test 'eq) :type hash-table :read-only t))

(defvar *unit* nil "The unit that is being compiled or loaded, or NIL.")

(defun at-end-of-unit (form function)
  "Call FUNCTION once, at the end of the compilation unit that contains FORM. The compiler
attributes the warnings of FUNCTION to FORM. Outside of compiling and loading, do nothing."
  (when (and *unit* (not (gethash form (unit-tasks *unit*))))
    (setf (gethash form (unit-tasks *unit*))
          (list function (call-at-source-location form #'error-context) (location-in-text form)))))

(defun call-tracking-warnings (function)
  "Call FUNCTION and report its warnings as those of the compiler. Return two values: whether there
were warnings, and whether any was worse than a style warning."
  (let ((warned nil) (failed nil))
    (with-compilation-unit ()
      (progv (list (compiler-variable #:*last-message-count*)
                   (compiler-variable #:*last-error-context*))
          (list (list* 0 nil nil) nil)
        (handler-bind ((style-warning
                         (fdefinition (compiler-variable #:compiler-style-warning-handler)))
                       (warning (fdefinition (compiler-variable #:compiler-warning-handler))))
          (handler-bind ((warning (lambda (condition)
                                    (setf warned t)
                                    (unless (typep condition 'style-warning) (setf failed t)))))
            (funcall function)))))
    (values warned failed)))

(defun end-unit (unit)
  "Do the deferred work of UNIT, in order. Return the values of CALL-TRACKING-WARNINGS."
  (if (plusp (hash-table-count (unit-tasks unit)))
      (call-tracking-warnings
       (lambda ()
         (loop for form being the hash-keys of (unit-tasks unit)
                 using (hash-value (function location in-text))
               do (let ((*deferred-location* (cons form in-text)))
                    ;; The compiler attributes warnings of FUNCTION to LOCATION.
                    (progv (list (compiler-variable #:*compiler-error-context*)) (list location)
                      (funcall function))))))
      (values nil nil)))

(defun move-tasks-to-outer-unit (unit)
  (loop for form being the hash-keys of (unit-tasks unit) using (hash-value task)
        do (setf (gethash form (unit-tasks (unit-outer unit))) task)))

(defun call-in-unit (kind function &optional own)
  "Call FUNCTION in the current unit if KIND fits it and OWN is false, else in a new unit of KIND."
  (if (and *unit* (not own) (member (unit-kind *unit*) (list kind :compilation)))
      (funcall function)
      (let ((*unit* (make-unit kind (and (not own) *unit*))))
        (multiple-value-prog1 (funcall function)
          (if (and (unit-outer *unit*) (not (unit-files-p *unit*)))
              (move-tasks-to-outer-unit *unit*)
              (let ((unit (shiftf *unit* nil))) (end-unit unit)))))))

(defun call-in-new-unit (function)
  "Call FUNCTION, which evaluates forms that belong together, and return its values."
  (call-in-unit :load function t))

(defun compile-in-unit (function)
  "Call FUNCTION, which compiles a file, in a compilation unit. Return the values of COMPILE-FILE."
  (cond ((and *unit* (eq :compilation (unit-kind *unit*)))
         (setf (unit-files-p *unit*) t)
         (funcall function))
        (t (let ((*unit* (make-unit :compilation nil)))
             (multiple-value-bind (output warned failed) (funcall function)
               (let ((unit (shiftf *unit* nil)))
                 (multiple-value-bind (warned-now failed-now) (end-unit unit)
                   (values output (or warned warned-now) (or failed failed-now)))))))))

;; A file compiled or loaded meanwhile has definitions of its own.
(defun apply-with-own-file (function arguments)
  "Apply FUNCTION, which compiles or loads a file, to ARGUMENTS. Definitions are recorded as defined
in that file."
  (let ((name (compiler-variable #:*source-namestring*)))
    (progv (and (evaluated-file-p (symbol-value name)) (list name)) '(nil)
      (apply function arguments))))

;;; SBCL has no hook for the end of a unit.

(wrap-function 'compile-file
               (lambda (function &rest arguments)
                 (compile-in-unit (lambda () (apply-with-own-file function arguments)))))

(wrap-function 'load
               (lambda (function &rest arguments)
                 (call-in-unit :load (lambda () (apply-with-own-file function arguments)))))

(wrap-function (internal-name :sb-c '#:%with-compilation-unit)
               (lambda (function body &rest options &key override &allow-other-keys)
                 (apply function (lambda () (call-in-unit :compilation body override)) options)))

;;;; The position of LOAD in a file that it cannot read

(defun form-start (stream)
  "Return the position, in characters, of the form that LOAD is reading from STREAM; 0 if LOAD
cannot read even its first character; NIL if LOAD is not reading STREAM."
  (and (internal-type-p stream :sb-int #:form-tracking-stream)
       (or (internal (:sb-int #:form-tracking-stream-form-start-char-pos) stream) 0)))

(defun line-of-next-character (stream)
  "Return the number of the line of the next character that LOAD will read from STREAM. FORM-START
must not return NIL for STREAM."
  (car (internal (:sb-int #:line/col-from-charpos) stream)))

;; A word may end by the newline after it, which has been read by then.
(defun line-of-last-character (stream)
  "Return the number of the line of the last character that LOAD has read from STREAM. FORM-START
must not return NIL for STREAM."
  (destructuring-bind (line . column) (internal (:sb-int #:line/col-from-charpos) stream)
    (if (plusp column) line (max 1 (1- line)))))

(defun encapsulated-condition (condition)
  "Return the condition to which CONDITION only adds a position, as conditions of LOAD do; or NIL."
  (and (internal-type-p condition :sb-int #:encapsulated-condition)
       (internal (:sb-int #:encapsulated-condition) condition)))

(defun format-of-decoding-error (condition)
  "If CONDITION says that a stream has bytes that are not valid text in its external format, return
the name of that format, a string; else NIL."
  (when (internal-type-p condition :sb-int #:stream-decoding-error)
    (let ((format (if-internal (:sb-kernel #:character-coding-error-external-format)
                    (internal (:sb-kernel #:character-coding-error-external-format) condition)
                    :utf-8)))
      (string (first (ensure-list format))))))
