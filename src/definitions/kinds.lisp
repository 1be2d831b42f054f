;;;; kinds.lisp -- kinds: structures that describe each slot once, for all operations.

(in-package :ars-magna.definitions)

(export '(make-kind-slot slots-to-show *object-kinds* kind-p kind-of kind-named all-kinds
          find-kind-name object-slots reset slot-content define-kind))

;;; A kind is a structure with a role for each slot; DEFINE-KIND lists the roles. They determine the
;;; readers' documentation, RESET, DIGEST-STATE, forks and inspection. An object in a slot marked as
;;; :PART belongs to the object, and is reset, digested and shown with it; other objects are only
;;; referred to. The contents of a :SHARED slot are replaced and never modified, so forks share
;;; them. :NEAR slots come first in memory: mark those that are read for many objects in a row.

(define-record (kind-slot (:constructor make-kind-slot
                              (name role type text part-p shared-p initial reader writer)))
  "The description of a slot of a kind."
  (name nil symbol "the name of the slot, a symbol" :export)
  (role nil (member :fixed :state :memory :scratch :link)
        "the role of the slot: :FIXED, :STATE, :MEMORY, :SCRATCH or :LINK" :export)
  (type t t "the Lisp type of the slot's values" :export)
  (text "" string "the text that describes the slot's contents" :export)
  (part-p nil boolean "the slot's contents belong to the object" :export)
  (shared-p nil boolean "the slot's contents are never modified, so copies share them" :export)
  (initial nil function "the function that returns the slot's initial contents" :export)
  (reader nil function "the function of an object that returns the slot's contents" :export)
  (writer nil function
          "the function that stores a value in the slot of an object (value, object)" :export))

(defun decisive-slot-p (slot)
  "True if SLOT has the role :STATE, or is a :FIXED slot that contains parts of the object."
  (or (eq :state (kind-slot-role slot))
      (and (eq :fixed (kind-slot-role slot)) (kind-slot-part-p slot))))

(define-record (object-kind (:conc-name kind-)
                            (:constructor make-kind
                                (name slots parent
                                 &aux (decisive-slots (remove-if-not #'decisive-slot-p slots))))
                            (:predicate kind-p))
  "A kind of object, defined by DEFINE-KIND."
  (name nil symbol "the name of the kind, the type of its objects" :export)
  (slots '() list "a list of the descriptions of the kind's slots, inherited ones first" :export)
  (decisive-slots '() list "the slots of the kind whose contents determine how a run continues"
                  :export)
  (parent nil (or null object-kind) "the kind that this kind includes, or NIL"))

(defmethod print-object ((kind object-kind) stream)
  (print-unreadable-object (kind stream :type t) (princ (kind-name kind) stream)))

(define-registry object-kind "kind of object"
  :object-p kind-p :by-symbol t :fixed t :internal t)

(declaim (inline kind-named))
(defun kind-named (name)
  "Return the kind named NAME, or NIL. NAME must be the same symbol, not only the same string."
  (get name 'object-kind))

(declaim (inline kind-of))
(defun kind-of (object)
  "Return the kind of OBJECT, or NIL."
  (and (typep object 'structure-object)
       (kind-named (type-of object))))

(defun kind-includes-p (kind base)
  (loop for each = kind then (kind-parent each)
        while each
          thereis (eq base (kind-name each))))

(defun all-kinds (&optional base)
  "Return a list of all kinds in order of definition. If the name BASE is given, list only the kind
BASE and the kinds that include it."
  (remove-if-not (lambda (kind) (or (null base) (kind-includes-p kind base)))
                 (all-object-kinds)))

(defun uncached-kind-name (name base kinds)
  (loop for kind in kinds
        when (and (same-name-p name (kind-name kind)) (kind-includes-p kind base))
          return (kind-name kind)))

(defun find-kind-name (name base)
  "Return the name of the first kind named NAME, a string or a symbol of any package. Only the kind
BASE and the kinds that include BASE count. Return NIL if no such kind has this name."
  (let ((kinds (registry-objects *object-kinds*)))
    (if (symbolp name)
        ;; Plans' commands ask this for each argument. The cache is valid until a kind is defined.
        (let ((known (get name 'known-kind-name)))
          (unless (and known (eq base (first known)) (eq kinds (second known)))
            (setf known (list base kinds (uncached-kind-name name base kinds))
                  (get name 'known-kind-name) known))
          (third known))
        (uncached-kind-name name base kinds))))

;;; The contents of an object.

(declaim (inline slot-content))
(defun slot-content (slot object)
  "Return the contents of SLOT in OBJECT."
  (funcall (kind-slot-reader slot) object))

(defun object-slots (object &rest roles)
  "Return a list (name value text) for each slot of OBJECT with one of ROLES, or for all slots."
  (loop for slot in (kind-slots (kind-of object))
        when (or (null roles) (member (kind-slot-role slot) roles))
          collect (list (kind-slot-name slot) (slot-content slot object) (kind-slot-text slot))))

(defun slots-to-show (object)
  "Return a list of lists (title (name value text)...) of the slots of the structure OBJECT. If
OBJECT is of a kind, there is a list for each role; else there is one list, and the texts are NIL."
  (if (kind-of object)
      (loop for (role title) in '((:fixed "as it was made") (:state "state") (:memory "memory")
                                  (:scratch "scratch") (:link "links"))
            for slots = (object-slots object role)
            when slots collect (cons title slots))
      (list (cons "slots" (loop for name in (class-slot-names (class-of object))
                                collect (list name (slot-value object name) nil))))))

;;; Reset.

(declaim (inline map-parts))
(defun map-parts (function value)
  (typecase value
    (list (mapc function value))
    (vector (map nil function value))
    (t (funcall function value))))

(defgeneric reset (object)
  (:documentation "Reset OBJECT, an object of a kind, and its parts to their initial state. Slots
with the role :LINK keep their values. Return OBJECT. A kind may add an :AFTER method.")
  (:method (object) object)
  (:method ((object structure-object))
    (let ((kind (kind-of object)))
      (when kind
        (dolist (slot (kind-slots kind))
          (ecase (kind-slot-role slot)
            ((:state :memory :scratch)
             (funcall (kind-slot-writer slot) (funcall (kind-slot-initial slot)) object))
            (:fixed (when (kind-slot-part-p slot) (map-parts #'reset (slot-content slot object))))
            (:link))))
      object)))

;;;; Defining kinds

(defun document-readers (kind conc package)
  (dolist (slot (kind-slots kind))
    (let* ((name (kind-slot-name slot))
           (reader (find-symbol (concatenate 'string conc (symbol-name name)) package)))
      (when (and reader (fboundp reader))
        (setf (documentation reader 'function) (reader-docstring name (kind-slot-text slot)))))))

(defun register-kind (name parent slots conc)
  (let* ((parent (and parent
                      (or (kind-named parent)
                          (reject-clause-of-kind name (list :include parent)
                                                 "an existing kind after :include"))))
         (kind (make-kind name (append (and parent (kind-slots parent)) slots) parent)))
    (register *object-kinds* name kind)
    (setf (get name 'object-kind) kind)
    (document-readers kind conc (symbol-package name))
    kind))

(defun slots-in-memory-order (groups)
  "Return the slots in GROUPS, a list of lists (role slot...), in their order in memory."
  (stable-sort (loop for (nil . slots) in groups append slots)
               (lambda (one other)
                 (and (member :near (nthcdr 4 one)) (not (member :near (nthcdr 4 other)))))))

(defun check-kind-name (name include documentation)
  (unless (and (symbolp name) name (symbol-package name) (not (keywordp name)))
    (reject-clause-of-kind name name "an interned symbol as the name of the kind"))
  (unless (symbolp include)
    (reject-clause-of-kind name (list :include include) "the name of a kind after :include"))
  (unless (stringp documentation)
    (reject-clause-of-kind name documentation
                           "a string that says what the kind is, before the slots")))

(defun check-kind-slot (name slot known)
  (unless (and (proper-list-p slot) (<= 4 (length slot))
               (symbolp (first slot)) (first slot)
               (stringp (fourth slot))
               (subsetp (nthcdr 4 slot) '(:part :shared :near :export :addition)))
    (reject-clause-of-kind name slot
                           "(name default type \"what it is\" [:part] [:shared] [:near])"))
  (when (member (first slot) known :test #'same-name-p)
    (reject-clause-of-kind name slot
                           "a name that no other slot has, here or in the included kind")))

(defun check-kind-form (name include documentation groups)
  (check-kind-name name include documentation)
  (let ((known (and include (kind-named include)
                    (mapcar #'kind-slot-name (kind-slots (kind-named include))))))
    (loop for group in groups
          do (unless (and (proper-list-p group)
                          (member (first group) '(:fixed :state :memory :scratch :link)))
               (reject-clause-of-kind name group "(:fixed/:state/:memory/:scratch/:link slot...)"))
             (dolist (slot (rest group))
               (check-kind-slot name slot known)
               (push (first slot) known)))))

(defun reject-clause-of-kind (name clause expected)
  (error 'malformed-definition :definition (definition-title "define-kind" name)
                               :clause clause :expected expected))

(defun kind-slot-form (name conc role slot)
  (destructuring-bind (slot default type text &rest options) slot
    (let ((reader (symbolicate conc slot)))
      `(make-kind-slot ',slot ,role ',type ,text
                       ,(and (member :part options) t)
                       ,(and (member :shared options) t)
                       (lambda () ,default)
                       (lambda (object) (,reader (the ,name object)))
                       (lambda (value object) (setf (,reader (the ,name object)) value))))))

(defun kind-options (form)
  "Return the name, included kind (or NIL) and constructor in FORM, as in DEFINE-KIND."
  (destructuring-bind (name &rest options) (ensure-list form)
    (unless (and (proper-list-p options) (evenp (length options))
                 (loop for key in options by #'cddr always (member key '(:include :constructor))))
      (reject-clause-of-kind name form "a name, or (name [:include kind] [:constructor c])"))
    (values name
            (getf options :include)
            (getf options :constructor
                  (and (symbolp name) (symbolicate 'make- name))))))

(defmacro define-kind (name-and-options documentation &body groups &environment environment)
  "Define a structure with a role for each slot. NAME-AND-OPTIONS is its name, or (name [:include
kind] [:constructor constructor]), as in DEFSTRUCT. GROUPS are lists (role slot...). A slot is (name
default type \"what it is\"), then :PART if its contents belong to the object, :SHARED if its
contents are never modified, :NEAR to store the slot near the other :NEAR slots in memory; :EXPORT
and :ADDITION are as in DEFINE-RECORD. The roles are
  :fixed    the model: how the object was made;
  :state    what determines the future, or what programs see of it;
  :memory   what is shown to people and determines nothing;
  :scratch  what has no meaning between ticks;
  :link     ties to users of the object, such as continuations.
To change the slots of a kind, restart Lisp. Return the name. Signals MALFORMED-DEFINITION."
  (multiple-value-bind (name include constructor) (kind-options name-and-options)
    (check-kind-form name include documentation groups)
    (unless (or (null include) (kind-named include) (find-class include nil environment))
      (reject-clause-of-kind name (list :include include) "an existing kind after :include"))
    (kind-definition-form name include constructor documentation groups)))

(defun kind-definition-form (name include constructor documentation groups)
  (let ((conc (concatenate 'string (symbol-name name) "-")))
    `(progn
       (define-record (,name ,@(when include `((:include ,include)))
                             (:constructor ,@(or (ensure-list constructor) '(nil))))
         ,documentation
         ,@(loop for (slot default type text . options) in (slots-in-memory-order groups)
                 collect `(,slot ,default ,type ,text :writable
                                 ,@(intersection '(:export :addition) options))))
       (register-kind ',name ',include
                      (list ,@(loop for (role . slots) in groups
                                    append (loop for slot in slots
                                                 collect (kind-slot-form name conc role slot))))
                      ,conc)
       (defmethod describe-object ((object ,name) stream)
         (describe-by-kind object stream))
       ',name)))
