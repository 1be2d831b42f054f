;;;; code.lisp -- what compiled code refers to, and which file it is from.

(in-package :ars-magna.host)

(export '(method-code declared-lambda-list same-code-p structure-reader-p code-references
          lambda-list-of takes-count-p callable-with-p function-file files-besides-functions
          call-as-from-file tell-sources))

;;; Since SBCL 2.4.10, the names of called functions are no constants of code: it calls them through
;;; a linkage table. The names of macros, constants and inline functions that were used are in the
;;; cross references, those of structures in the types of functions.

(defun linked-names (code)
  "Return the names of the functions that CODE calls through a linkage table."
  (if-internal (:sb-vm #:linkage-addr->name)
    (loop for index in (internal (:sb-c #:unpack-code-fixup-locs)
                                 (internal (:sb-vm #:%code-fixups) code))
          collect (internal (:sb-vm #:linkage-addr->name) index :index))
    (progn code '())))

(defun cross-referenced-names (function)
  "Return the names of macros, constants, variables and inline functions that FUNCTION, a part of
code, was made of."
  (let ((references (internal (:sb-kernel #:%simple-fun-xrefs) function)))
    (and (vectorp references)
         (remove-if-not (lambda (object) (typep object '(and (or symbol cons) (not null))))
                        (coerce references 'list)))))

(defun names-used (code)
  "Return what functions in CODE were made of: names, and the types of these functions."
  (loop for index below (internal (:sb-kernel #:code-n-entries) code)
        for function = (internal (:sb-kernel #:%code-entry-point) code index)
        append (cross-referenced-names function)
        collect (internal (:sb-kernel #:%simple-fun-type) function)))

(defun code-of (function)
  (internal (:sb-kernel #:fun-code-header) (internal (:sb-kernel #:%fun-fun) function)))

(defun same-code-p (function other)
  "True if FUNCTION and OTHER are one function, or closures of the same code."
  (if (or (interpreted-p function) (interpreted-p other))
      (same-interpreted-p function other)
      (eq (internal (:sb-kernel #:%fun-fun) function) (internal (:sb-kernel #:%fun-fun) other))))

(defun constants-from (code start)
  (loop for index from start below (internal (:sb-kernel #:code-header-words) code)
        collect (internal (:sb-kernel #:code-header-ref) code index)))

;; SBCL 2.2 begins the constants with the name of each function, local ones included, and so on.
(defparameter *described-among-constants-p*
  (eq 'linked-names
      (first (constants-from (code-of #'linked-names)
                             (internal-value :sb-vm #:code-constants-offset))))
  "True if what describes the functions of code stands before its constants.")

(defun first-constant (code)
  "Return the index of the first constant of CODE, after what only describes its functions."
  (+ (internal-value :sb-vm #:code-constants-offset)
     (if *described-among-constants-p*
         (* (internal-value :sb-vm #:code-slots-per-simple-fun)
            (internal (:sb-kernel #:code-n-entries) code))
         0)))

(defun code-constants (function)
  "Return a list of what the code of FUNCTION, and of those compiled with it, has as constants, and
the names of functions that it calls and of what it was made of."
  (let ((code (code-of function)))
    (append (constants-from code (first-constant code))
            (linked-names code)
            (names-used code))))

(defun constant-meant (constant)
  "Return what CONSTANT, one of code, stands for: of a call by name that name."
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

(defun structure-reader-p (function)
  "True if FUNCTION is the reader of a structure's slot that DEFSTRUCT made."
  (equal (list (internal-name :sb-kernel '#:instance)) (declared-lambda-list function)))

(defun code-references (function)
  "Return a list of what FUNCTION refers to: names of functions, which are symbols or lists,
symbols, other functions, and whatever else stands in its code or was closed over. In it are no
numbers."
  (remove-if
   (lambda (object) (typep object '(or number character string bit-vector null)))
   (if (typep function 'generic-function)
       (mapcar #'method-code (methods-of-generic function))
       (append (mapcar #'constant-meant (code-constants function))
               (when (closure-p function) (closure-values function))))))

(defun lambda-list-of (name)
  "Return the lambda list of the function or macro called NAME, a symbol, or of a function itself."
  (sb-introspect:function-lambda-list name))

(defun takes-count-p (lambda-list count)
  "True if LAMBDA-LIST, an ordinary one, takes COUNT arguments, of which any may be keywords."
  (multiple-value-bind (required optional rest-p keys) (parse-ordinary-lambda-list lambda-list)
    (and (<= (length required) count)
         (or rest-p keys (<= count (+ (length required) (length optional)))))))

(defun callable-with-p (function count)
  "True if FUNCTION, or the one so called, can be called with COUNT arguments, as far as is known."
  (multiple-value-bind (list unknown-p) (lambda-list-of function)
    (or unknown-p (takes-count-p list count))))

;;; From which file functions are. Where the forms of one are evaluated one by one, that must be
;;; said.

(defvar *dates-of-files* (make-hash-table :test 'equal :synchronized t)
  "When files were written whose forms have been evaluated one by one, by what they are called.")

(defun evaluated-file-p (namestring)
  "True if NAMESTRING, one of Lisp's or NIL, is of a file whose forms have been evaluated."
  (and namestring
       (not (many-files-p namestring))
       (gethash (native-name namestring) *dates-of-files*)))

(defun call-as-from-file (function path)
  "Call FUNCTION, which evaluates forms that have been read from the file PATH: the functions that
come of it are from there."
  (let ((name (native-name path)) (errors *error-output*))
    (setf (gethash name *dates-of-files*) (file-write-date path))
    ;; What a unit says of itself at its end, that it was left, is no news to whoever leaves it.
    (let ((*error-output* (make-broadcast-stream)))
      ;; SBCL makes a pathname of it, as Lisp reads one.
      (with-compilation-unit (:source-namestring (namestring path))
        (let ((*error-output* errors)) (funcall function))))))

(defun file-of-source (source)
  "Return which file SOURCE, what SBCL knows of a definition, is from, as the system calls it, and
the time at which that was written by then; NIL if it was typed."
  (let ((path (and source (sb-introspect:definition-source-pathname source))))
    (and path
         (let ((name (native-name (translate-logical-pathname path))))
           (values name (or (sb-introspect:definition-source-file-write-date source)
                            (gethash name *dates-of-files*)))))))

(defun function-file (function)
  "Return the file that FUNCTION was compiled from, as the system calls it, and the time at which
that was written by then; NIL if it was typed."
  (file-of-source (ignore-errors (sb-introspect:find-definition-source function))))

(defun files-besides-functions (symbol)
  "Return lists (file written), as FUNCTION-FILE returns them, of definitions of SYMBOL as anything
but a function."
  (loop for kind in '(:variable :constant :symbol-macro :compiler-macro :setf-expander :type :class
                      :structure :condition)
        append (loop for source in (ignore-errors
                                    (sb-introspect:find-definition-sources-by-name symbol kind))
                     for file = (multiple-value-list (file-of-source source))
                     when (first file) collect file)))

;;; Editors ask Lisp where a name is defined, as a function, a variable and so on. What only we know
;;; the place of is told with the declarations of that name, as nothing else is free for it.

(defun tell-sources (function)
  "Let whoever asks where a symbol is defined be told also what FUNCTION of that returns, lists
\(file position operator)."
  (wrap-function 'sb-introspect:find-definition-sources-by-name
                 (lambda (original name type)
                   (append (funcall original name type)
                           (and (eq type :declaration) (symbolp name)
                                (loop for (file position operator) in (funcall function name)
                                      collect (internal (:sb-introspect #:make-definition-source)
                                                :pathname (native-path file)
                                                :character-offset position
                                                :description (list operator))))))))
