;;;; registry.lisp -- what users define, by kind and name: finding, listing, redefining, undefining.

(in-package :ars-magna.base)

;;; One registry for each kind of definition. Names compare as names, whatever package they were
;;; read in; the newest definition of a name counts. A registry that tells names apart by symbol,
;;; as functions are, finds the very symbol first and then whatever is called the same.
;;;
;;; The lists are replaced, never altered, so that any thread may read them at any time. All
;;; writing is done under one lock.

(defstruct (definition (:constructor make-definition (name object source variable))
                       (:copier nil))
  "That NAME means OBJECT, by a definition in SOURCE; VARIABLE, if any, holds what it stands for."
  (name nil :type symbol :read-only t)
  (object nil :read-only t)
  (source nil :type list :read-only t)
  (variable nil :type symbol :read-only t))

(defstruct (registry (:constructor %make-registry (kind text)) (:copier nil))
  "All definitions of one KIND, called TEXT in messages, in order, and their objects."
  (kind nil :type symbol :read-only t)
  (text "" :type string :read-only t)
  (definitions '() :type list)
  (objects '() :type list)
  ;; True if names that are different symbols mean different things.
  (by-symbol-p nil :type boolean)
  ;; True if users cannot take definitions back.
  (fixed-p nil :type boolean)
  ;; Returns what else an object may be called, a list of strings and symbols.
  (aliases (constantly '()) :type function))

(document-functions
  definition-name "Return the symbol that is defined."
  definition-object "Return what the definition's name means."
  definition-source "Return the source of the definition; see sources.lisp."
  registry-objects "Return what REGISTRY has objects of, in order of definition; do not alter it.")

(defmethod print-object ((registry registry) stream)
  (print-unreadable-object (registry stream :type t)
    (format stream "~A, ~D" (registry-text registry) (length (registry-objects registry)))))

(defvar *registries* '() "All registries, in order of definition.")
(defvar *registries-lock* (make-lock "registries"))

(defun ensure-registry (kind text &rest options &key by-symbol fixed aliases)
  "Return the registry of KIND, made if there is none, with these properties."
  (declare (ignore options))
  (let ((registry (or (find kind *registries* :key #'registry-kind)
                      (let ((new (%make-registry kind text)))
                        (setf *registries* (append *registries* (list new)))
                        new))))
    (setf (registry-by-symbol-p registry) (and by-symbol t)
          (registry-fixed-p registry) (and fixed t)
          (registry-aliases registry) (or aliases (constantly '())))
    registry))

;;; Finding.

(defun called-p (definition name registry)
  (or (same-name-p name (definition-name definition))
      (member name (funcall (registry-aliases registry) (definition-object definition))
              :test #'same-name-p)))

(defun lookup-definition (name registry)
  "Return the definition in REGISTRY of NAME, a symbol or string, or NIL."
  (when (typep name '(or symbol string))
    (let ((definitions (registry-definitions registry)))
      (or (find name definitions :key #'definition-name :test #'eq)
          (find-if (lambda (definition) (called-p definition name registry))
                   definitions :from-end t)))))

(defun lookup (name registry)
  "Return the object in REGISTRY that is called NAME, or NIL."
  (let ((definition (lookup-definition name registry)))
    (and definition (definition-object definition))))

(defun defined-names (registry)
  "Return the names defined in REGISTRY, in order."
  (mapcar #'definition-name (registry-definitions registry)))

(defun find-definition (name registry errorp)
  "Return the object in REGISTRY that is called NAME. If there is none, return NIL, or signal
UNKNOWN-NAME if ERRORP is true."
  (or (lookup name registry)
      (and errorp
           (reject-name (registry-text registry) name (defined-names registry)))))

;;; Defining.

(defgeneric take-back (object)
  (:documentation "Undo what the definition of OBJECT has done besides entering it.")
  (:method (object) object))

(defgeneric reinstate (object)
  (:documentation "Do again what TAKE-BACK may have undone: OBJECT is defined as it was before.")
  (:method (object) object))

(defun set-definitions (registry definitions)
  (setf (registry-definitions registry) definitions
        (registry-objects registry) (mapcar #'definition-object definitions)))

(defun seal-definitions ()
  "Let all that is defined so far count as the simulator's own."
  (dolist (registry *registries*)
    (set-definitions registry
                     (loop for definition in (registry-definitions registry)
                           collect (make-definition (definition-name definition)
                                                    (definition-object definition)
                                                    '("the simulator itself")
                                                    (definition-variable definition))))))

(defun same-definition-p (definition name registry)
  (if (registry-by-symbol-p registry)
      (eq name (definition-name definition))
      (same-name-p name (definition-name definition))))

(defun say-if-replaced (old new registry)
  "Warn that the definition NEW replaces OLD if OLD was in another file."
  (let ((file (source-file (definition-source old)))
        (other (source-file (definition-source new))))
    (when (and file (not (equal file other)))
      (warn-of-definition "The ~A ~A is defined anew~@[ in ~A~]; so far it was as ~A says."
                          (registry-text registry) (definition-name new) other file))))

(defun set-variables (old new value)
  "Let the variable of the definition NEW have VALUE, and that of OLD, which it replaces."
  (dolist (variable (list (and old (definition-variable old)) (definition-variable new)))
    (when variable (setf (sb-ext:symbol-global-value variable) value))))

(defun register (registry name object &key variable (value object) before)
  "Let NAME mean OBJECT in REGISTRY, from now on; it takes the place of what it meant before. With
VARIABLE, the special variable NAME, if it can be one, has VALUE from now on. BEFORE is an object of
the registry to come directly before, instead of last. Return OBJECT."
  (let ((new (make-definition name object (current-source)
                              (and variable (variable-name-p name) name)))
        (old nil))
    (with-lock (*registries-lock*)
      (let ((definitions (registry-definitions registry)))
        (setf old (find-if (lambda (definition) (same-definition-p definition name registry))
                           definitions))
        (set-definitions registry
                         (cond (before
                                (insert-before new before (remove old definitions)))
                               ((null old) (append definitions (list new)))
                               ((registry-by-symbol-p registry)
                                (append (remove old definitions) (list new)))
                               (t (substitute new old definitions))))
        (set-variables old new value)))
    (when old (say-if-replaced old new registry))
    object))

(defun insert-before (new object definitions)
  "Return DEFINITIONS with NEW before that of OBJECT."
  (let ((tail (member object definitions :key #'definition-object)))
    (append (ldiff definitions tail) (list new) tail)))

;;; Undefining.

(defun find-registry (kind)
  (or (find kind *registries* :key #'registry-kind :test #'same-name-p)
      (reject-name "kind of definition" kind (mapcar #'registry-kind *registries*))))

(defun forget-definition (definition)
  "Undo what DEFINITION, no longer in its registry, has done."
  (let ((variable (definition-variable definition)))
    (take-back (definition-object definition))
    (when (and variable (boundp variable))
      (makunbound variable))))

(addition undefine)
(defun undefine (kind name)
  "Take back the definition of NAME, of KIND: MAP, PLACE-TYPE, ATTRIBUTE, SUBSTANCE, KICKER,
MANIPULATION, ROBOT or PROCEDURE, a symbol of any package. Its variable becomes unbound; worlds
that are under way keep what they have. Return NAME. Signals UNKNOWN-NAME, and MISUSE for what is
no user's to define."
  (let ((registry (find-registry kind)))
    (when (registry-fixed-p registry)
      (reject-use "A ~A cannot be undefined: the simulator needs it." (registry-text registry)))
    (find-definition name registry t)
    (let ((definition (lookup-definition name registry)))
      (with-lock (*registries-lock*)
        (set-definitions registry (remove definition (registry-definitions registry))))
      (forget-definition definition)
      name)))

;;; Keeping definitions.

(defun become (object model)
  "Make the structure OBJECT like MODEL, another of its type, slot by slot. Return OBJECT."
  (dolist (slot (sb-mop:class-slots (class-of object)) object)
    (let ((name (sb-mop:slot-definition-name slot)))
      (unless (eql (slot-value object name) (slot-value model name))
        (setf (slot-value object name) (slot-value model name))))))

(defun keep-definition (definition)
  (let ((variable (definition-variable definition)))
    (list definition
          (copy-structure (definition-object definition))
          (and variable (boundp variable) (list (symbol-value variable))))))

(defun restore-definition (kept)
  (destructuring-bind (definition copy value) kept
    (become (definition-object definition) copy)
    (when value (setf (symbol-value (definition-variable definition)) (first value)))))

(defun restore-registry (registry kept)
  "Make REGISTRY as it was when KEPT, a list made by KEEP-DEFINITION, was made."
  (let* ((now (registry-definitions registry))
         (then (mapcar #'first kept)))
    (with-lock (*registries-lock*) (set-definitions registry then))
    (mapc #'forget-definition (set-difference now then))
    (mapc #'restore-definition kept)
    (mapc #'reinstate (registry-objects registry))))

(defun call-with-own-definitions (function)
  "Call FUNCTION; see WITH-OWN-DEFINITIONS."
  (let ((kept (loop for registry in *registries*
                    collect (cons registry (mapcar #'keep-definition
                                                   (registry-definitions registry))))))
    (unwind-protect (funcall function)
      (loop for (registry . definitions) in kept
            do (restore-registry registry definitions)))))

(addition with-own-definitions)
(defmacro with-own-definitions (() &body body)
  "Run BODY. Maps, robots, kickers and whatever else it defines, redefines or undefines is
afterwards, however BODY ends, as it was before: for tests, and suites of users. Return the values
of BODY. Definitions are shared by all threads, so only one thread at a time may do this."
  `(call-with-own-definitions (lambda () ,@body)))

;;; Making registries.

(defmacro define-registry (kind text &key object-p by-symbol fixed aliases internal
                                       (finder (symbolicate 'find- kind))
                                       (lister (symbolicate 'all- kind 's)))
  "Define the registry of KIND, a symbol, in the variable *KINDs*, and the functions FIND-KIND and
ALL-KINDs, or as FINDER and LISTER say, for users unless INTERNAL is true. TEXT is what a definition
is called in messages. OBJECT-P names the predicate of what may be given instead of a name. The rest
are slots of REGISTRY."
  (let ((variable (symbolicate '* kind 's*)))
    `(progn
       (defparameter ,variable
         (ensure-registry ',kind ,text :by-symbol ,by-symbol :fixed ,fixed :aliases ,aliases)
         ,(format nil "The registry of each ~A." text))
       ,@(unless internal `((addition ,finder ,lister)))
       (defun ,finder (name &optional (errorp t))
         ,(format nil "Return the ~A called NAME, a symbol or string~@[; one is returned as it ~
                       is~*~]. If there is none, signal UNKNOWN-NAME, or return NIL if ERRORP is ~
                       NIL."
                  text object-p)
         ,(if object-p
              `(if (,object-p name) name (find-definition name ,variable errorp))
              `(find-definition name ,variable errorp)))
       (defun ,lister ()
         ,(format nil "Return a list of the ~As that are defined, in order of definition." text)
         (copy-list (registry-objects ,variable))))))
