;;;; compiler.lisp -- where in its source SBCL's compiler is, and how it tells of what it warns of.

(in-package :ars-magna.host)

(export '(show-lambda-list nested-p place-of set-place call-with-current-place positions-of-forms
          edited-file error-context call-with-error-context call-as-compiler call-as-other-file
          wrap-compilation-units wrap-unit-summaries context-original-form context-file
          context-path compiler-error-p))

;;; SBCL remembers where each list stands that it has read to compile or load it. A list that was
;;; made of one that stands somewhere can be given its place: what the compiler has to say of it is
;;; then said of what the author wrote. That is all in tables and variables of the compiler.

(defmacro compiler-variable (name)
  "Return the symbol of the compiler's variable NAME."
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

(defun set-place (form place)
  "Let the list FORM stand at PLACE in what is being compiled."
  (setf (gethash form (places)) place))

(defun call-with-current-place (place function)
  "Call FUNCTION. What it warns of the compiler takes to be about what stands at PLACE."
  (progv (list (compiler-variable #:*current-path*)) (list place)
    (funcall function)))

(defun positions-of-forms ()
  "Return the vector of the positions in the text after which the forms at top level begin, or NIL."
  (let ((info (value-if-bound (compiler-variable #:*source-info*))))
    (and info
         (internal (:sb-c #:file-info-positions)
                   (internal (:sb-c #:source-info-file-info) info)))))

;;; An editor may have a piece of a file compiled: it copies that to a file of its own, and tells
;;; the compiler where it is from.

(defun edited-file ()
  "Return the name of the file of which an editor has a piece compiled, a string, or NIL."
  (let ((file (getf (value-if-bound (compiler-variable #:*source-plist*)) :emacs-filename)))
    (and *compile-file-truename* (stringp file) file)))

(defun call-as-other-file (function other-p)
  "Call FUNCTION, which compiles or loads a file, and return its values. OTHER-P is a function of
the name of the file that is being evaluated: if it returns true, FUNCTION's file is told apart."
  (let ((name (compiler-variable #:*source-namestring*)))
    (progv (and (funcall other-p (symbol-value name)) (list name)) '(nil)
      (funcall function))))

;;; Warnings that come later.

(defun error-context ()
  "Return how the compiler would tell later of what it is at."
  (internal (:sb-c #:find-error-context) nil))

(defun call-with-error-context (context function)
  "Call FUNCTION. What it warns of the compiler tells as it would have when CONTEXT was made."
  (progv (list (compiler-variable #:*compiler-error-context*)) (list context)
    (funcall function)))

(defun context-original-form (context)
  "Return the text of the form that CONTEXT is about."
  (internal (:sb-c #:compiler-error-context-original-form) context))

(defun context-file (context)
  "Return the pathname of the file that CONTEXT is in; NIL if it is in none."
  (let ((file (and context (internal (:sb-c #:compiler-error-context-file-name) context))))
    (and (pathnamep file) file)))

(defun context-path (context)
  "Return a list of which element of which list in the text CONTEXT is about, the innermost number
first, that of the form at top level last."
  (internal (:sb-c #:compiler-error-context-original-source-path) context))

(defun compiler-error-p (condition)
  "True if CONDITION is that the compiler cannot read or compile a form, and goes on. What it says
is its ENCAPSULATED-CONDITION."
  (internal-type-p condition :sb-c #:compiler-error))

(defun call-as-compiler (function)
  "Call FUNCTION. What it warns of is told as what the compiler warns of."
  (with-compilation-unit ()
    (progv (list (compiler-variable #:*last-message-count*)
                 (compiler-variable #:*last-error-context*))
        (list (list* 0 nil nil) nil)
      (handler-bind ((style-warning
                       (fdefinition (compiler-variable #:compiler-style-warning-handler)))
                     (warning (fdefinition (compiler-variable #:compiler-warning-handler))))
        (funcall function)))))

(defun wrap-compilation-units (wrapper)
  "Call WRAPPER, with SBCL's function and its arguments, where WITH-COMPILATION-UNIT begins a unit."
  (wrap-function (internal-name :sb-c '#:%with-compilation-unit) wrapper))

(defun wrap-unit-summaries (wrapper)
  "Call WRAPPER, with SBCL's function and whether the unit was left before its end, where the end of
a unit is told."
  (if-internal (:sb-c #:summarize-compilation-unit)
    (wrap-function (internal-name :sb-c '#:summarize-compilation-unit) wrapper)
    wrapper))
