;;;; registry.lisp -- finding, listing, redefining and undefining definitions, by kind and name.

(in-package :ars-magna.definitions)

(export '(registry define-registry register *definition-listener* lookup-entry
          defined-in-this-file-p users-entry-p names-to-suggest defined-names all-definitions
          definition-to-replace variable-in-use-p users-entries-named undo-definition
          redo-definition entry-of restore-entry remove-entry forget-value entry-variable
          *definition-changes* registries-of-plans))

;;; There is one registry for each kind of definition. Names compare without their package; the
;;; newest definition of a name counts. A registry by symbol, as for functions, first looks for the
;;; very symbol, then for the same name.
;;;
;;; The lists are replaced, never modified, so any thread may read them. One lock guards writes.

(define-record (entry (:constructor make-entry (name object source variable
                                                &optional (digest (current-form-digest))
                                                  (head (current-operator-and-name))
                                                  (documentation (current-docstring)))))
  "The entry of a definition in a registry: SOURCE defines NAME as OBJECT."
  (name nil symbol "the symbol that is defined" :export)
  (object nil t "the object that the entry defines" :export)
  (source nil list "the source of the entry's definition; see sources.lisp" :export)
  (variable nil symbol "the variable whose value is the object, or is computed from it; or NIL")
  (digest nil (or null integer) "the digest of the form of the entry's definition, or NIL" :export)
  (head '() list "the operator and name in the form of the definition, a list")
  (documentation nil (or null string) "the docstring of the definition, or NIL")
  (changed 0 fixnum "*DEFINITION-CHANGES* at the last change of the definition, or 0"
           :writable :export))

(define-record (registry (:constructor %make-registry (kind text)))
  "All definitions of one KIND. Messages name the kind with TEXT."
  (kind nil symbol)
  (text "" string "what messages call a definition of the kind" :export)
  (entries '() list "the entries of the registry's definitions, in order" :writable :export)
  (objects '() list "the objects in REGISTRY, in order; do not modify the list" :writable :export)
  (by-symbol-p nil boolean "a definition replaces another only if both have the same symbol as the
name" :writable)
  (fixed-p nil boolean "users cannot undefine any of the definitions" :writable)
  (sealed-p nil boolean "users cannot undefine the simulator's definitions" :writable)
  (plans-p nil boolean "plans use the definitions by name" :writable)
  (synonyms '() list "other names of the kind for UNDEFINE" :writable)
  (aliases (constantly '()) function "the function that returns the other names of an object,
strings and symbols" :writable))

(defmethod print-object ((registry registry) stream)
  (print-unreadable-object (registry stream :type t)
    (format stream "~A, ~D" (registry-text registry) (length (registry-objects registry)))))

(defvar *registries* '() "All registries, in order of definition.")
(defvar *registries-lock* (make-lock "registries"))
(defvar *definition-changes* 0
  "How many times a definition has been replaced by one with a different form.")

(defun ensure-registry (kind text &key by-symbol fixed sealed plans synonyms aliases)
  (let ((registry (or (find kind *registries* :key #'registry-kind)
                      (let ((new (%make-registry kind text)))
                        (setf *registries* (append *registries* (list new)))
                        new))))
    (setf (registry-by-symbol-p registry) (and by-symbol t)
          (registry-fixed-p registry) (and fixed t)
          (registry-sealed-p registry) (and sealed t)
          (registry-plans-p registry) (and plans t)
          (registry-synonyms registry) synonyms
          (registry-aliases registry) (or aliases (constantly '())))
    registry))

;;; Finding.

(defun entry-named-p (entry name registry)
  (or (same-name-p name (entry-name entry))
      (loop for alias in (funcall (registry-aliases registry) (entry-object entry))
              thereis (same-name-p name alias))))

(defun qualified-symbol (name)
  "Return the symbol named by the string NAME, such as \"P:NAME\" or \"p:name\"; or NIL."
  (let ((colon (and (stringp name) (position #\: name))))
    (when (and colon (plusp colon))
      (let* ((prefix (subseq name 0 colon))
             (package (or (find-package prefix) (find-package (string-upcase prefix))))
             ;; The name itself may begin with a colon, too.
             (name (subseq name (+ colon (if (eql colon (search "::" name)) 2 1)))))
        (and package
             (or (find-symbol name package) (find-symbol (string-upcase name) package)))))))

(defun lookup-entry (name registry)
  "Return the entry of REGISTRY for NAME, a symbol or a string, perhaps PACKAGE:NAME; or NIL."
  (when (typep name '(or symbol string))
    (let ((entries (registry-entries registry))
          (name (or (qualified-symbol name) name)))
      (or (find name entries :key #'entry-name :test #'eq)
          (loop with last = nil
                for entry in entries
                when (entry-named-p entry name registry) do (setf last entry)
                finally (return last))))))

(defun users-registries ()
  (remove-if #'registry-fixed-p *registries*))

(defun registries-of-plans ()
  "Return the registries of definitions that plans use by name."
  (remove-if-not #'registry-plans-p *registries*))

(defun users-entries-named (name)
  "Return the entries of users' definitions with the name NAME, a symbol, in all registries."
  (loop for registry in (users-registries)
        for entry = (lookup-entry name registry)
        when (and entry (users-entry-p entry)) collect entry))

(defun defined-names (registry)
  "Return a list of the names defined in REGISTRY, in order."
  (mapcar #'entry-name (registry-entries registry)))

(defun names-to-suggest (registry)
  "Return a list of the names in REGISTRY in the order in which messages suggest them: first
the users' names, the newest first, then the simulator's names."
  (let ((entries (registry-entries registry)))
    (mapcar #'entry-name (append (reverse (remove-if-not #'users-entry-p entries))
                                 (remove-if #'users-entry-p entries)))))

(defun find-definition (name registry errorp)
  "Return the object named NAME in REGISTRY, or NIL; if ERRORP is true, signal UNKNOWN-NAME
instead."
  (let ((entry (lookup-entry name registry)))
    (cond (entry (entry-object entry))
          (errorp (reject-name (registry-text registry) name (names-to-suggest registry))))))

(defun entry-of (object registry)
  "Return the entry that defines OBJECT in REGISTRY, or NIL."
  (find object (registry-entries registry) :key #'entry-object))

(defun defined-in-this-file-p (name registry)
  "True if NAME in REGISTRY is defined in the file being loaded. (Later forms may redefine NAME.)"
  (let ((entry (lookup-entry name registry))
        (file (source-file (current-source))))
    (and entry file (equal file (source-file (entry-source entry))))))

;;; Defining.

(defgeneric undo-definition (object)
  (:documentation "Undo the effects of OBJECT's definition, except its entry in the registry.")
  (:method (object) object))

(defgeneric redo-definition (object)
  (:documentation "Redo the effects of the definition of OBJECT that UNDO-DEFINITION has undone,
because the definition is restored.")
  (:method (object) object))

(defun entry-to-replace (name registry)
  "Return the entry in REGISTRY that a definition of NAME would replace, or NIL."
  (find name (registry-entries registry)
        :key #'entry-name :test (if (registry-by-symbol-p registry) #'eq #'same-name-p)))

(defun definition-to-replace (name registry)
  "Return the object in REGISTRY that a definition of NAME would replace, or NIL."
  (let ((entry (entry-to-replace name registry)))
    (and entry (entry-object entry))))

(defun set-entries (registry entries)
  (setf (registry-entries registry) entries
        (registry-objects registry) (mapcar #'entry-object entries)))

(defparameter *simulator-source* '("the simulator itself") "The source of our own definitions.")

(defun users-entry-p (entry)
  "True if ENTRY is a user's definition, not the simulator's."
  (not (equal *simulator-source* (entry-source entry))))

(defun entries-including (new old before registry)
  "Return the entries of REGISTRY with NEW inserted: before the entry of the object BEFORE, if
given; else in place of the entry OLD, unless an entry of the same name follows it; else last."
  (let* ((entries (registry-entries registry)) (others (remove old entries)))
    (cond (before (let ((tail (member before others :key #'entry-object)))
                    (append (ldiff others tail) (list new) tail)))
          ((and old (not (find (entry-name new) (rest (member old entries))
                               :key #'entry-name :test #'same-name-p)))
           (substitute new old entries))
          (t (append others (list new))))))

(defun variable-in-use-p (name)
  "True if the variable NAME has a global value other than NIL, so that no definition may set it."
  (ignore-errors (global-value name)))

(defun usable-variable (name kind)
  "Return NAME if a definition of KIND can set the variable NAME. Else return NIL, and warn unless
NAME is a symbol of Common Lisp or of the simulator."
  (flet ((refuse (control)
           (warn-of-definition "~@?: refer to the ~A by its name, '~(~A~)."
                               control name kind name)))
    (cond ((not (variable-name-p name))
           (when (users-symbol-p name)
             (refuse "~(~A~) is a constant, symbol macro or global variable and keeps its value")))
          ((variable-in-use-p name) (refuse "The variable ~(~A~) already has a value"))
          (t name))))

(defun warn-if-replaced (old new registry)
  (let ((file (source-file (entry-source old)))
        (other (source-file (entry-source new))))
    (when (and file (not (equal file other)))
      (warn-of-definition "The ~A ~(~A~) is redefined~@[ in ~A~]; its earlier definition is in ~A."
                          (registry-text registry) (entry-name new) other file))))

(defun choose-variable (name old registry)
  "Return the variable for a definition of NAME: OLD's variable; or NAME, if unused; or NIL."
  (cond ((and old (entry-variable old) (boundp (entry-variable old))) (entry-variable old))
        (t (usable-variable name (registry-text registry)))))

(defvar *definition-listener* nil
  "A function that is called with each object that this thread defines, or NIL.")

(defun replace-entry (old new registry before value)
  "Add the entry NEW to REGISTRY, in place of the entry OLD or before the object BEFORE. Set NEW's
variable, if any, to VALUE. Return true, or change nothing if another thread has replaced OLD."
  (with-lock (*registries-lock*)
    (when (eq old (entry-to-replace (entry-name new) registry))
      (when old
        (setf (entry-changed new) (if (eql (entry-digest old) (entry-digest new))
                                      (entry-changed old)
                                      (incf *definition-changes*))))
      (set-entries registry (entries-including new old before registry))
      (when (entry-variable new) (setf (global-value (entry-variable new)) value))
      t)))

(defun register (registry name object &key variable (value object) before generated)
  "Define NAME as OBJECT in REGISTRY, replacing an earlier definition. If VARIABLE is true, and NAME
can be a special variable and is unused, set NAME to VALUE. A new entry is added at the end, or
before the entry of the object BEFORE. Return OBJECT and the object that it replaces, or NIL. If
several threads define NAME at a time, each replaces a different object. GENERATED is true if a
program defines NAME, not a file: it has no source."
  (loop
    (let* ((old (entry-to-replace name registry))
           (variable (and variable (choose-variable name old registry)))
           (source (cond (generated nil)
                         (*loading-simulator-p* *simulator-source*)
                         (t (current-source))))
           (new (make-entry name object source variable)))
      (when (replace-entry old new registry before value)
        (when old (warn-if-replaced old new registry))
        (when *definition-listener* (funcall *definition-listener* object))
        (return (values object (and old (entry-object old))))))))

;;; Undefining.

(defun registry-named (kind registries)
  "Return the registry among REGISTRIES whose kind is KIND, a symbol such as KICKER, or NIL."
  (find-if (lambda (registry)
             (or (same-name-p kind (registry-kind registry))
                 (member kind (registry-synonyms registry) :test #'same-name-p)))
           registries))

(defun find-registry (kind)
  (or (registry-named kind *registries*)
      (reject-name "kind of definition" kind (mapcar #'registry-usual-name (users-registries)))))

(defun all-definitions (kind)
  "Return a list of lists (name object source) for all definitions of KIND, a kind as in UNDEFINE,
in order. SOURCE is a definition's file, :OWN for the simulator's, or NIL for typed definitions."
  (loop for entry in (registry-entries (find-registry kind))
        collect (list (entry-name entry) (entry-object entry)
                      (if (users-entry-p entry) (source-file (entry-source entry)) :own))))

(defun registry-usual-name (registry)
  (string-downcase (or (first (registry-synonyms registry)) (registry-kind registry))))

(defun forget-value (variable)
  "Make VARIABLE globally unbound. Bindings of VARIABLE by headless runs remain."
  (join-thread (start-thread (lambda () (makunbound variable)) "forgetting")))

(defun undefine-entry (entry)
  (undo-definition (entry-object entry))
  (when (entry-variable entry) (forget-value (entry-variable entry))))

(defun check-may-undefine (registry entry)
  (when (or (registry-fixed-p registry)
            (and (registry-sealed-p registry) (not (users-entry-p entry))))
    (reject-use "The ~A ~(~A~) cannot be undefined: the simulator needs it."
                (registry-text registry) (entry-name entry))))

(defun check-unambiguous (registry entry name)
  "Signal MISUSE if NAME, a symbol or string, may mean other entries of REGISTRY than ENTRY, too."
  (let ((others (remove-if-not (lambda (other) (entry-named-p other name registry))
                               (registry-entries registry))))
    (when (and (rest others)
               (not (eq (entry-name entry) (or (qualified-symbol name) name))))
      (reject-use "undefine: ~A could be ~{~A~^ or ~}. Give the symbol, with its package."
                  name (mapcar (lambda (other) (qualified-name (entry-name other))) others)))))

(addition undefine)
(defun undefine (kind name)
  "Remove the definition of NAME as KIND: MAP, MAP-CLAUSE, PLACE-TYPE, ATTRIBUTE, SUBSTANCE, KICKER,
MANIPULATION, ROBOT, RUN-VARIABLE, MEASURE, PLAN, POLICY or GOAL, a symbol of any package. The
variable of the definition becomes unbound. Existing worlds do not change, except that a robot
leaves the resident world of its map. Return NAME. Signals UNKNOWN-NAME; MISUSE for some definitions
of the simulator, and if NAME could mean several definitions; WRONG-ARGUMENT unless KIND and NAME
are symbols or strings."
  (check-argument undefine kind (typep kind '(or symbol string)) "a kind of definition, as MAP")
  (check-argument undefine name (typep name '(or symbol string)) "the name of a definition")
  (let ((registry (find-registry kind)))
    (find-definition name registry t)
    (let ((entry (lookup-entry name registry)))
      (check-may-undefine registry entry)
      (check-unambiguous registry entry name)
      (deferring-interrupts
        (remove-entry entry registry)
        (undefine-entry entry))
      name)))

(defun restore-entry (entry registry)
  "Make ENTRY, an earlier entry of REGISTRY, the current entry for its name again. Return true if it
was not."
  (with-lock (*registries-lock*)
    (unless (member entry (registry-entries registry))
      (set-entries registry
                   (entries-including entry (entry-to-replace (entry-name entry) registry)
                                      nil registry))
      t)))

(defun remove-entry (entry registry)
  "Remove ENTRY from REGISTRY. Return true if it was there."
  (with-lock (*registries-lock*)
    (when (member entry (registry-entries registry))
      (set-entries registry (remove entry (registry-entries registry)))
      t)))

;;; Making registries.

(defmacro define-registry (kind text &key object-p by-symbol fixed sealed plans synonyms aliases
                                       internal
                                       (finder (symbolicate 'find- kind))
                                       (lister (symbolicate 'all- kind 's)))
  "Define the registry of KIND, a symbol. The registry of KICKER is in the variable *KICKERS*, and
the functions FIND-KICKER and ALL-KICKERS (or the names FINDER and LISTER) search it. Users may call
the functions unless INTERNAL is true. Messages name a definition with TEXT. Objects for which
OBJECT-P is true can be passed in place of names. The other arguments are slots of REGISTRY."
  (let ((variable (symbolicate '* kind 's*)))
    `(progn
       (defparameter ,variable
         (ensure-registry ',kind ,text :by-symbol ,by-symbol :fixed ,fixed :sealed ,sealed
                                       :plans ,plans :synonyms ',synonyms :aliases ,aliases)
         ,(format nil "The registry with the definition of each ~A." text))
       ,@(unless internal `((addition ,finder ,lister)))
       (defun ,finder (name &optional (errorp t))
         ,(format nil "Return the ~A named NAME, a symbol or string.~:[~; If NAME is such an ~
                       object, return it.~] If there is none, signal UNKNOWN-NAME, or return ~
                       NIL if ERRORP is NIL."
                  text object-p)
         ,(if object-p
              `(if (,object-p name) name (find-definition name ,variable errorp))
              `(find-definition name ,variable errorp)))
       (defun ,lister ()
         ,(format nil "Return a list of all defined ~As, in order of definition." text)
         (copy-list (registry-objects ,variable))))))
