;;;; code.lisp -- what compiled code refers to, and which file it comes from.

(in-package :ars-magna.host)

(export '(method-code declared-lambda-list same-code-p code-references
          lambda-list-of accepts-count-p callable-with-count-p function-file
          files-of-other-definitions
          call-recording-file add-definition-sources))

;;; Since SBCL 2.4.10, names of called functions are not among the constants of code but in a
;;; linkage table. Names of macros, constants and inline functions are in the cross references,
;;; those of structures in the types of functions.

(defun linked-names (code)
  "Return the names of the functions that CODE calls through a linkage table."
  (if-internal (:sb-vm #:linkage-addr->name)
    (loop for index in (internal (:sb-c #:unpack-code-fixup-locs)
                                 (internal (:sb-vm #:%code-fixups) code))
          collect (internal (:sb-vm #:linkage-addr->name) index :index))
    (progn code '())))

(defun cross-referenced-names (function)
  "Return the names of the macros, constants, variables and inline functions that FUNCTION uses."
  (let ((references (internal (:sb-kernel #:%simple-fun-xrefs) function)))
    (and (vectorp references)
         (remove-if-not (lambda (object) (typep object '(and (or symbol cons) (not null))))
                        (coerce references 'list)))))

(defun names-used (code)
  "Return a list of the names that the functions in CODE use, and of the types of these functions."
  (loop for index below (internal (:sb-kernel #:code-n-entries) code)
        for function = (internal (:sb-kernel #:%code-entry-point) code index)
        append (cross-referenced-names function)
        collect (internal (:sb-kernel #:%simple-fun-type) function)))

(defun code-of (function)
  (internal (:sb-kernel #:fun-code-header) (internal (:sb-kernel #:%fun-fun) function)))

(defun same-code-p (function other)
  "True if FUNCTION and OTHER are the same function, or are closures of the same code."
  (if (or (interpreted-p function) (interpreted-p other))
      (same-interpreted-p function other)
      (eq (internal (:sb-kernel #:%fun-fun) function) (internal (:sb-kernel #:%fun-fun) other))))

(defun constants-from (code start)
  (loop for index from start below (internal (:sb-kernel #:code-header-words) code)
        collect (internal (:sb-kernel #:code-header-ref) code index)))

;; SBCL 2.2 begins the constants with the names of all functions, including local ones.
(defparameter *functions-among-constants-p*
  (eq 'linked-names
      (first (constants-from (code-of #'linked-names)
                             (internal-value :sb-vm #:code-constants-offset))))
  "True if this SBCL stores the descriptions of functions before the constants of code.")

(defun first-constant-index (code)
  "Return the index of the first constant of CODE after the descriptions of its functions."
  (+ (internal-value :sb-vm #:code-constants-offset)
     (if *functions-among-constants-p*
         (* (internal-value :sb-vm #:code-slots-per-simple-fun)
            (internal (:sb-kernel #:code-n-entries) code))
         0)))

(defun code-constants (function)
  "Return the constants in the code of FUNCTION and functions compiled with it, and the names used."
  (let ((code (code-of function)))
    (append (constants-from code (first-constant-index code))
            (linked-names code)
            (names-used code))))

(defun constant-or-function-name (constant)
  "Return the name of the function that CONSTANT, a constant of code, refers to; else CONSTANT."
  (if (internal-type-p constant :sb-kernel #:fdefn)
      (internal (:sb-kernel #:fdefn-name) constant)
      constant))

(defun method-code (method)
  "Return the function that was compiled from the body of METHOD."
  (or (internal (:sb-pcl #:safe-method-fast-function) method)
      (sb-mop:method-function method)))

(defun declared-lambda-list (function)
  "Return the lambda list that FUNCTION was compiled with."
  (internal (:sb-kernel #:%fun-lambda-list) function))

(defun code-references (function)
  "Return a list of the objects that FUNCTION refers to: function names (symbols or lists), symbols,
other functions, constants and closed-over values. Numbers, characters and strings are left out."
  (remove-if
   (lambda (object) (typep object '(or number character string bit-vector null)))
   (if (typep function 'generic-function)
       (mapcar #'method-code (methods-of-generic function))
       (append (mapcar #'constant-or-function-name (code-constants function))
               (when (closure-p function) (closure-values function))))))

(defun lambda-list-of (name)
  "Return the lambda list of NAME: a function, or the name of a function or macro. The second value
is true if it is not known."
  (let ((list (and (closure-p name) (declared-lambda-list name))))
    ;; Continuations are closures, and are checked whenever a command is issued.
    (if (and (consp list) (notany (lambda (element) (member element lambda-list-keywords)) list))
        list
        (sb-introspect:function-lambda-list name))))

(defun accepts-count-p (lambda-list count)
  "True if a function with LAMBDA-LIST accepts COUNT arguments, counting keywords and their values."
  (if (notany (lambda (element) (member element lambda-list-keywords)) lambda-list)
      (= count (length lambda-list))
      (multiple-value-bind (required optional rest-p keys) (parse-ordinary-lambda-list lambda-list)
        (and (<= (length required) count)
             (or rest-p keys (<= count (+ (length required) (length optional))))))))

(defun callable-with-count-p (function count)
  "True if FUNCTION, a function or a name, accepts COUNT arguments or has an unknown lambda list."
  (unless (and (symbolp function) (or (macro-function function) (special-operator-p function)))
    (multiple-value-bind (list unknown-p) (lambda-list-of function)
      (or unknown-p (accepts-count-p list count)))))

;;; The source files of functions. SBCL does not know the file of forms that are evaluated singly.

(defvar *write-dates* (make-hash-table :test 'equal :synchronized t)
  "A table from file names to write dates, for files whose forms were evaluated one by one.")

(defun evaluated-file-p (namestring)
  "True if NAMESTRING is the name of a file whose forms were evaluated one by one."
  (and namestring
       (not (wildcard-name-p namestring))
       (gethash (native-name namestring) *write-dates*)))

(defun call-recording-file (function path)
  "Call FUNCTION, which evaluates forms of the file PATH. Record PATH as the file of new functions."
  (let ((name (native-name path)) (errors *error-output*))
    (setf (gethash name *write-dates*) (file-write-date path))
    ;; The summary that a unit was left is useless here: the caller knows.
    (let ((*error-output* (make-broadcast-stream)))
      ;; SBCL parses this as a Lisp pathname.
      (with-compilation-unit (:source-namestring (namestring path))
        (let ((*error-output* errors)) (funcall function))))))

(defun file-of-source (source)
  "Return the file of SOURCE, a definition source of SBCL, and the write date of the file at the
time of the definition; NIL if the definition was typed, or is of a file that only the builders of
SBCL had."
  (let* ((path (and source (sb-introspect:definition-source-pathname source)))
         (name (and path (ignore-errors (native-name (translate-logical-pathname path))))))
    (and name
         (values name (or (sb-introspect:definition-source-file-write-date source)
                          (gethash name *write-dates*))))))

(defun file-of-code (function)
  "Return the values of FUNCTION-FILE, using only the debug information in the code of FUNCTION."
  (let* ((source (internal (:sb-c #:debug-info-source)
                           (internal (:sb-kernel #:%code-debug-info) (code-of function))))
         (name (internal (:sb-c #:debug-source-namestring) source)))
    (and name
         (values (native-name (translate-logical-pathname name))
                 (internal (:sb-c #:debug-source-created) source)))))

(defun function-file (function)
  "Return the native name of the file that FUNCTION was compiled from, and the write date of the
file at that time; NIL if FUNCTION was typed."
  (handler-case (file-of-source (sb-introspect:find-definition-source function))
    ;; Of a file compiled by the Lisp that saved this core, SBCL may have kept the positions of the
    ;; first forms only, and looks for those of later ones.
    (error () (ignore-errors (file-of-code function)))))

(defun files-of-other-definitions (symbol)
  "Return a list (file write-date) for each definition of SYMBOL but functions; see FUNCTION-FILE."
  (loop for kind in '(:variable :constant :symbol-macro :compiler-macro :setf-expander :type :class
                      :structure :condition)
        append (loop for source in (ignore-errors
                                    (sb-introspect:find-definition-sources-by-name symbol kind))
                     for file = (multiple-value-list (file-of-source source))
                     when (first file) collect file)))

;;; Editors ask Lisp where a name is defined as a function, a variable and so on. Our own
;;; definitions are reported as declarations of that name, since no other type is unused.

(defun add-definition-sources (function)
  "Make Lisp also report the sources (file position operator) that FUNCTION lists for a symbol."
  (wrap-function 'sb-introspect:find-definition-sources-by-name
                 (lambda (original name type)
                   (append (funcall original name type)
                           (and (eq type :declaration) (symbolp name)
                                (loop for (file position operator) in (funcall function name)
                                      collect (internal (:sb-introspect #:make-definition-source)
                                                :pathname (native-path file)
                                                :character-offset position
                                                :description (list operator))))))))
