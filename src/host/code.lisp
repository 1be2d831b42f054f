;;;; code.lisp -- what compiled code refers to.

(in-package :ars-magna.host)

(export '(code-constants constant-meant method-code declared-lambda-list same-code-p
          structure-reader-p source-at))

;;; Tried with SBCL 2.2.9, 2.5.2 and 2.6.4. Since 2.4.10, the names of called functions are no
;;; constants of code: it calls them through a linkage table. The names of macros, constants and
;;; inline functions that were used are in the cross references, those of structures in the types of
;;; functions.

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

(defun source-at (path position operator)
  "Return, as SB-INTROSPECT has it, that something is defined by OPERATOR in PATH at POSITION."
  (internal (:sb-introspect #:make-definition-source)
            :pathname path :character-offset position :description (list operator)))
