;;;; compiler.lisp -- where in its source the compiler is, and what waits until it has read all.

(in-package :ars-magna.host)

(export '(show-lambda-list nested-p edited-file error-context context-original-form
          compiler-error-p keep-place in-source-p call-at-place at-end-of-unit call-as-unit
          place-in-text compiler-place))

;;; SBCL remembers where each list stands that it has read to compile or load it. A list that was
;;; made of one that stands somewhere can be given its place: what the compiler has to say of it is
;;; then said of what the author wrote. That is all in tables and variables of the compiler.

(defmacro compiler-variable (name)
  `',(internal-name :sb-c name))

(defun value-if-bound (variable)
  (and (boundp variable) (symbol-value variable)))

(defun show-lambda-list (name lambda-list &optional (function (macro-function name)))
  "Let those who ask how FUNCTION, by default the macro NAME, is used be told LAMBDA-LIST."
  (when (compiled-function-p function)
    (funcall (fdefinition `(setf ,(internal-name :sb-c '#:%simple-fun-arglist)))
             lambda-list function)))

(defun nested-p (environment)
  "True if a form in ENVIRONMENT stands inside others that are compiled with it."
  (and environment (internal (:sb-c #:lexenv-lambda) environment) t))

;;; Places.

(defun places ()
  "Return the table of the places of what is being compiled, or NIL."
  (let ((table (value-if-bound (compiler-variable #:*source-paths*))))
    (and (hash-table-p table) table)))

(defun place-of (form)
  "Return where FORM stands in what is being compiled, or NIL."
  (let ((places (places)))
    (and places (consp form) (values (gethash form places)))))

(defun in-source-p (form)
  "True if FORM was read from what is being compiled, or stands in place of what was."
  (and (place-of form) t))

(defun keep-place (new old)
  "Let NEW, made of OLD, stand where OLD does if it has no place yet. Return NEW."
  (let ((place (and (consp new) (not (eq new old)) (place-of old))))
    (when (and place (not (place-of new)))
      (setf (gethash new (places)) place))
    new))

(defun call-at-place (form function)
  "Call FUNCTION. What it warns of the compiler takes to be about FORM."
  (let ((place (place-of form)))
    (progv (and place (list (compiler-variable #:*current-path*))) (list place)
      (funcall function))))

;;; An editor may have a piece of a file compiled: it copies that to a file of its own, and tells
;;; the compiler where it is from.

(defun edited-file ()
  "Return the name of the file of which an editor has a piece compiled, a string, or NIL."
  (let ((file (getf (value-if-bound (compiler-variable #:*source-plist*)) :emacs-filename)))
    (and *compile-file-truename* (stringp file) file)))

;;; Warnings that come later.

(defun error-context ()
  "Return how the compiler would tell later of what it is at."
  (internal (:sb-c #:find-error-context) nil))

(defun context-original-form (context)
  "Return the text of the form that CONTEXT is about."
  (internal (:sb-c #:compiler-error-context-original-form) context))

(defun compiler-error-p (condition)
  "True if CONDITION is that the compiler cannot read or compile a form, and goes on. What it says
is its ENCAPSULATED-CONDITION."
  (internal-type-p condition :sb-c #:compiler-error))

(defun wrap-unit-summaries (wrapper)
  "Call WRAPPER, with SBCL's function and whether the unit was left before its end, where the end of
a unit is told."
  (if-internal (:sb-c #:summarize-compilation-unit)
    (wrap-function (internal-name :sb-c '#:summarize-compilation-unit) wrapper)
    wrapper))

;;; SBCL also remembers where each form at top level begins in the text.

(defvar *kept-place* nil
  "While something is done that waited until all had been read: a list of a form and, after it,
where in the text that stands.")

(defun place-at (path)
  "Return the list that PLACE-IN-TEXT does of the form that PATH leads to, the innermost number
first; NIL if that is not known."
  (destructuring-bind (&optional top . numbers) (reverse path)
    (let* ((info (value-if-bound (compiler-variable #:*source-info*)))
           (positions (and info
                           (internal (:sb-c #:file-info-positions)
                                     (internal (:sb-c #:source-info-file-info) info)))))
      (and top positions (< top (length positions))
           (cons (aref positions top) numbers)))))

(defun compiler-place ()
  "Return the pathname of the file that is being compiled, and what PLACE-IN-TEXT returns of the
form in it that the compiler is at, or NIL if that is not known. Return NIL if no file is being
compiled."
  (let* ((context (and *compile-file-truename* (error-context)))
         (file (and context (internal (:sb-c #:compiler-error-context-file-name) context))))
    (when (pathnamep file)
      (values file (place-at (internal (:sb-c #:compiler-error-context-original-source-path)
                                       context))))))

(defun place-in-text (form)
  "Return where FORM stands in the text that is being compiled or loaded: a list of the position
after which the form at top level around it begins, and of numbers from 0, which element of that it
is in, which element of this, and so on. Return NIL if that is not known."
  (cond
    ((and *kept-place* (eq form (first *kept-place*))) (rest *kept-place*))
    ((edited-file) nil)
    (t (place-at (nthcdr 2 (place-of form))))))

;;; What can be said only when all of a file has been read, or of all files of a system.
;;;
;;; Forms that are loaded belong together, and so do files that are compiled in one
;;; WITH-COMPILATION-UNIT; a file compiled by itself is a whole. When a form is evaluated Lisp makes
;;; a unit of it too: what is to be said at its end is left to the unit around that.

(defstruct (unit (:constructor make-unit (kind outer)) (:copier nil))
  "What is compiled or loaded as a whole, of KIND :LOAD or :COMPILATION, within OUTER. TASKS are,
by form, lists of a function to call at its end and where the form stands, for the compiler and in
the text."
  (kind :load :type (member :load :compilation) :read-only t)
  (outer nil :type (or null unit) :read-only t)
  (files-p nil :type boolean)
  (tasks (make-hash-table :test 'eq) :type hash-table :read-only t))

(defvar *unit* nil "The unit that is being compiled or loaded, or NIL.")

(defun at-end-of-unit (form function)
  "Call FUNCTION when all has been read of what is compiled or loaded together with FORM, once. What
it warns of the compiler takes to be about FORM. Without a compiler, do nothing."
  (when (and *unit* (not (gethash form (unit-tasks *unit*))))
    (setf (gethash form (unit-tasks *unit*))
          (list function (call-at-place form #'error-context) (place-in-text form)))))

(defun call-noting-warnings (function)
  "Call FUNCTION. What it warns of is told as what the compiler warns of. Return whether there was a
warning, and whether it was more than a matter of style."
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
  "Do what was to be done at the end of UNIT, in order. Return what CALL-NOTING-WARNINGS does."
  (if (plusp (hash-table-count (unit-tasks unit)))
      (call-noting-warnings
       (lambda ()
         (loop for form being the hash-keys of (unit-tasks unit)
                 using (hash-value (function place in-text))
               do (let ((*kept-place* (cons form in-text)))
                    ;; The compiler tells what FUNCTION warns of as it would have at PLACE.
                    (progv (list (compiler-variable #:*compiler-error-context*)) (list place)
                      (funcall function))))))
      (values nil nil)))

(defun leave-to-outer (unit)
  (loop for form being the hash-keys of (unit-tasks unit) using (hash-value task)
        do (setf (gethash form (unit-tasks (unit-outer unit))) task)))

(defun call-in-unit (kind function &optional own)
  "Call FUNCTION in a unit of KIND, and return its values: the unit at hand if that will do and OWN
is not true, or else another."
  (if (and *unit* (not own) (member (unit-kind *unit*) (list kind :compilation)))
      (funcall function)
      (let ((*unit* (make-unit kind (and (not own) *unit*))))
        (multiple-value-prog1 (funcall function)
          (if (and (unit-outer *unit*) (not (unit-files-p *unit*)))
              (leave-to-outer *unit*)
              (let ((unit (shiftf *unit* nil))) (end-unit unit)))))))

(defun call-as-unit (function)
  "Call FUNCTION, which evaluates forms that belong together, and return its values."
  (call-in-unit :load function t))

(defun compile-in-unit (function)
  "Call FUNCTION, which compiles a file and returns what COMPILE-FILE does. Return that."
  (cond ((and *unit* (eq :compilation (unit-kind *unit*)))
         (setf (unit-files-p *unit*) t)
         (funcall function))
        (t (let ((*unit* (make-unit :compilation nil)))
             (multiple-value-bind (output warned failed) (funcall function)
               (let ((unit (shiftf *unit* nil)))
                 (multiple-value-bind (warned-now failed-now) (end-unit unit)
                   (values output (or warned warned-now) (or failed failed-now)))))))))

;; Who compiles or loads another file meanwhile has functions of that.
(defun apply-in-own-file (function arguments)
  "Apply FUNCTION, which compiles or loads a file, to ARGUMENTS. What comes of it is told apart from
a file whose forms are being evaluated around it."
  (let ((name (compiler-variable #:*source-namestring*)))
    (progv (and (evaluated-file-p (symbol-value name)) (list name)) '(nil)
      (apply function arguments))))

;;; SBCL has no hook for the end of a unit.

(wrap-function 'compile-file
               (lambda (function &rest arguments)
                 (compile-in-unit (lambda () (apply-in-own-file function arguments)))))

(wrap-function 'load
               (lambda (function &rest arguments)
                 (call-in-unit :load (lambda () (apply-in-own-file function arguments)))))

(wrap-function (internal-name :sb-c '#:%with-compilation-unit)
               (lambda (function body &rest options &key override &allow-other-keys)
                 (apply function (lambda () (call-in-unit :compilation body override)) options)))
