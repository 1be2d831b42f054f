;;;; kinds.lisp -- what each slot of a kind of object is: said once, for all who need to know.

(in-package :ars-magna.base)

;;; A kind is a structure whose slots say what they are, by role:
;;;
;;;   :fixed    the model: how the object was made;
;;;   :state    what decides the future, or what programs are told of it;
;;;   :memory   what is shown to people and decides nothing;
;;;   :scratch  what means nothing between ticks;
;;;   :link     what ties the object to those who use it, such as continuations.
;;;
;;; From that follow the readers' documentation, RESET, DIGEST-STATE, forks and the inspection of an
;;; object. Other objects in a slot are referred to, unless the slot is marked as a :PART: then they
;;; belong to the object, and are reset, digested and shown with it. What is in a slot marked as
;;; :SHARED is replaced and never altered: forks have the same. Slots marked as :NEAR stand first in
;;; memory, beside each other: what is read of many objects, one after the other, belongs there.

(defstruct (kind-slot (:constructor make-kind-slot
                          (name role type text part-p shared-p initial reader writer))
                      (:copier nil))
  "What is known of a slot of a kind. INITIAL returns the value that it begins with."
  (name nil :type symbol :read-only t)
  (role nil :type (member :fixed :state :memory :scratch :link) :read-only t)
  (type t :read-only t)
  (text "" :type string :read-only t)
  (part-p nil :type boolean :read-only t)
  (shared-p nil :type boolean :read-only t)
  (initial nil :type function :read-only t)
  (reader nil :type function :read-only t)
  (writer nil :type function :read-only t))

(defun decisive-p (slot)
  "True if SLOT has state in it, or parts."
  (or (eq :state (kind-slot-role slot))
      (and (eq :fixed (kind-slot-role slot)) (kind-slot-part-p slot))))

(defstruct (object-kind (:conc-name kind-)
                        (:constructor make-kind
                            (name slots parent
                             &aux (decisive-slots (remove-if-not #'decisive-p slots))))
                        (:predicate kind-p) (:copier nil))
  "A kind of object: its slots, those of its PARENT first."
  (name nil :type symbol :read-only t)
  (slots '() :type list :read-only t)
  (decisive-slots '() :type list :read-only t)
  (parent nil :type (or null object-kind) :read-only t))

(document-functions
  kind-slot-name "Return the name of the slot, a symbol."
  kind-slot-role "Return what the slot is: :FIXED, :STATE, :MEMORY, :SCRATCH or :LINK."
  kind-slot-type "Return the Lisp type of the slot's values."
  kind-slot-text "Return what is in the slot, in words."
  kind-slot-part-p "True if what is in the slot belongs to the object."
  kind-slot-shared-p "True if what is in the slot is never altered, so that copies can share it."
  kind-slot-reader "Return the function of an object that returns what is in the slot."
  kind-slot-writer "Return the function of a value and an object that puts the value into the slot."
  kind-p "True of kinds."
  kind-name "Return the name of the kind, the type of its objects."
  kind-slots "Return a list of what is known of the slots of the kind, inherited ones first."
  kind-parent "Return the kind that the kind includes, or NIL.")

(defmethod print-object ((kind object-kind) stream)
  (print-unreadable-object (kind stream :type t) (princ (kind-name kind) stream)))

(define-registry object-kind "kind of object"
  :object-p kind-p :by-symbol t :fixed t :internal t)

(declaim (inline kind-called))
(defun kind-called (name)
  "Return the kind called NAME, the very symbol, or NIL."
  (get name 'object-kind))

(declaim (inline kind-of))
(defun kind-of (object)
  "Return the kind that OBJECT is of, or NIL."
  (and (typep object 'structure-object)
       (kind-called (type-of object))))

(defun based-on-p (kind base)
  "True if KIND is or includes the kind called BASE."
  (loop for each = kind then (kind-parent each)
        while each
          thereis (eq base (kind-name each))))

(defun all-kinds (&optional base)
  "Return a list of all kinds, in order of definition; with BASE, the name of one, of those that
are or include it."
  (remove-if-not (lambda (kind) (or (null base) (based-on-p kind base)))
                 (all-object-kinds)))

(defun look-up-kind-name (name base kinds)
  (loop for kind in kinds
        when (and (same-name-p name (kind-name kind)) (based-on-p kind base))
          return (kind-name kind)))

(defun find-kind-name (name base)
  "Return the name of the first kind, of those that are or include the one called BASE, that is
called as NAME, a symbol or string; NIL if none is."
  (let ((kinds (registry-objects *object-kinds*)))
    (if (symbolp name)
        ;; Plans' commands ask this of each argument. What was found holds until a kind is defined.
        (let ((known (get name 'known-kind-name)))
          (unless (and known (eq base (first known)) (eq kinds (second known)))
            (setf known (list base kinds (look-up-kind-name name base kinds))
                  (get name 'known-kind-name) known))
          (third known))
        (look-up-kind-name name base kinds))))

;;; Defining.

(defun reader-name (conc slot)
  "Return the symbol of the reader of SLOT in structures whose accessors begin with CONC."
  (symbolicate conc slot))

(defun reader-text (slot)
  "Return the documentation of a reader of SLOT."
  (if (ends-with-subseq "-P" (symbol-name (kind-slot-name slot)))
      (format nil "True if ~A." (kind-slot-text slot))
      (format nil "Return ~A." (kind-slot-text slot))))

(defun document-readers (kind conc package)
  "Document the readers of KIND, whose names in PACKAGE begin with CONC."
  (dolist (slot (kind-slots kind))
    (let ((reader (find-symbol (concatenate 'string conc (symbol-name (kind-slot-name slot)))
                               package)))
      (when (and reader (fboundp reader))
        (setf (documentation reader 'function) (reader-text slot))))))

(defun register-kind (name parent slots conc)
  "Let NAME be a kind with SLOTS of its own besides those of the kind called PARENT."
  (let* ((parent (and parent
                      (or (kind-called parent)
                          (reject-clause-of-kind name (list :include parent)
                                                 "a kind to include"))))
         (kind (make-kind name (append (and parent (kind-slots parent)) slots) parent)))
    (register *object-kinds* name kind)
    (setf (get name 'object-kind) kind)
    (document-readers kind conc (symbol-package name))
    kind))

(defun slots-by-role (groups)
  "Return a list (role name default type text part-p shared-p) for each slot in GROUPS, lists (role
slot...)."
  (loop for (role . slots) in groups
        append (loop for (name default type text . options) in slots
                     collect (list role name default type text
                                   (and (member :part options) t)
                                   (and (member :shared options) t)))))

(defun slots-by-place (groups)
  "Return the slots in GROUPS, lists (role slot...), in the order in which they stand in memory."
  (stable-sort (loop for (nil . slots) in groups append slots)
               (lambda (one other)
                 (and (member :near (nthcdr 4 one)) (not (member :near (nthcdr 4 other)))))))

(defun check-kind-name (name include documentation)
  (unless (and (symbolp name) name (symbol-package name) (not (keywordp name)))
    (reject-clause-of-kind name name "a symbol of a package as the name of the kind"))
  (unless (symbolp include)
    (reject-clause-of-kind name (list :include include) "the name of a kind after :include"))
  (unless (stringp documentation)
    (reject-clause-of-kind name documentation
                           "a string that says what the kind is, before the slots")))

(defun check-kind-slot (name slot known)
  "Signal MALFORMED-DEFINITION unless SLOT of the kind NAME makes sense beside KNOWN, other names."
  (unless (and (proper-list-p slot) (<= 4 (length slot))
               (symbolp (first slot)) (first slot)
               (stringp (fourth slot)) (subsetp (nthcdr 4 slot) '(:part :shared :near)))
    (reject-clause-of-kind name slot
                           "(name default type \"what it is\" [:part] [:shared] [:near])"))
  (when (member (first slot) known :test #'same-name-p)
    (reject-clause-of-kind name slot "a name that no other slot has, also of what is included")))

(defun check-kind-form (name include documentation groups)
  (check-kind-name name include documentation)
  (let ((known (and include (kind-called include)
                    (mapcar #'kind-slot-name (kind-slots (kind-called include))))))
    (loop for group in groups
          do (unless (and (proper-list-p group)
                          (member (first group) '(:fixed :state :memory :scratch :link)))
               (reject-clause-of-kind name group "(role slot...), with one of the roles of kinds"))
             (dolist (slot (rest group))
               (check-kind-slot name slot known)
               (push (first slot) known)))))

(defun reject-clause-of-kind (name clause expected)
  (error 'malformed-definition :definition (title "define-kind" name)
                               :clause clause :expected expected))

(defun slot-forms (name conc slots)
  "Return the forms that make what is known of SLOTS of the kind NAME."
  (loop for (role slot default type text part-p shared-p) in slots
        for reader = (reader-name conc slot)
        collect `(make-kind-slot ',slot ,role ',type ,text ,part-p ,shared-p
                            (lambda () ,default)
                            (lambda (object) (,reader (the ,name object)))
                            (lambda (value object) (setf (,reader (the ,name object)) value)))))

(defun kind-options (form)
  "Return the name, the included kind or NIL, and the constructor that FORM, what DEFINE-KIND begins
with, says."
  (destructuring-bind (name &rest options) (ensure-list form)
    (unless (and (proper-list-p options) (evenp (length options))
                 (loop for key in options by #'cddr always (member key '(:include :constructor))))
      (reject-clause-of-kind name form "a name, or (name [:include kind] [:constructor c])"))
    (values name
            (getf options :include)
            (getf options :constructor
                  (and (symbolp name) (symbolicate 'make- name))))))

(defmacro define-kind (name-and-options documentation &body groups &environment environment)
  "Define a structure and say what each of its slots is. NAME-AND-OPTIONS is its name, or (name
[:include kind] [:constructor constructor]), as in DEFSTRUCT. GROUPS are lists (role slot...), a
slot is (name default type \"what it is\"), and behind that :PART if what is in it belongs to the
object, :SHARED if it is never altered, :NEAR if it is to stand beside others. The roles are
  :fixed    how the object was made;
  :state    what decides the future, or what programs are told of it;
  :memory   what is shown to people and decides nothing;
  :scratch  what means nothing between ticks;
  :link     what ties the object to those who use it.
Lisp cannot give a kind other slots while it runs: start it anew for that. Return the name. Signals
MALFORMED-DEFINITION."
  (multiple-value-bind (name include constructor) (kind-options name-and-options)
    (check-kind-form name include documentation groups)
    (unless (or (null include) (kind-called include) (find-class include nil environment))
      (reject-clause-of-kind name (list :include include) "a kind to include"))
    (kind-definition name include constructor documentation groups)))

(defun kind-definition (name include constructor documentation groups)
  "Return the form that defines the kind NAME."
  (let ((slots (slots-by-role groups))
        (conc (concatenate 'string (symbol-name name) "-")))
    `(progn
       (defstruct (,name ,@(when include `((:include ,include)))
                         ,(if (consp constructor)
                              `(:constructor ,@constructor)
                              `(:constructor ,constructor))
                         (:copier nil))
         ,documentation
         ,@(loop for (slot default type) in (slots-by-place groups)
                 collect `(,slot ,default :type ,type)))
       (register-kind ',name ',include (list ,@(slot-forms name conc slots)) ,conc)
       (defmethod describe-object ((object ,name) stream)
         (describe-by-kind object stream))
       ',name)))

;;; What is in an object.

(declaim (inline slot-content))
(defun slot-content (slot object)
  (funcall (kind-slot-reader slot) object))

(defun object-slots (object &rest roles)
  "Return a list (name value text) for each slot of OBJECT, of a kind, whose role is among ROLES;
without ROLES, for each."
  (loop for slot in (kind-slots (kind-of object))
        when (or (null roles) (member (kind-slot-role slot) roles))
          collect (list (kind-slot-name slot) (slot-content slot object) (kind-slot-text slot))))

(defun slots-to-show (object)
  "Return lists (title (name value text)...) of the slots of OBJECT, a structure: by role if it is
of a kind, else all under one title, without texts."
  (if (kind-of object)
      (loop for (role title) in '((:fixed "as it was made") (:state "state") (:memory "memory")
                                  (:scratch "scratch") (:link "links"))
            for slots = (object-slots object role)
            when slots collect (cons title slots))
      (list (cons "slots" (loop for name in (class-slot-names (class-of object))
                                collect (list name (slot-value object name) nil))))))

(defun describe-by-kind (object stream)
  "Write to STREAM what OBJECT is, what people want to know of it, and what is in it, by role."
  (write-facts object stream)
  (loop for (title . slots) in (slots-to-show object)
        do (format stream "~& ~A:~%" title)
           (loop for (name value text) in slots
                 do (format stream "  ~(~22A~) ~A  (~A)~%" name (cut (fact-text value) 200)
                            text))))

;;; Reset.

(declaim (inline map-parts))
(defun map-parts (function value)
  "Call FUNCTION with the object VALUE, or with each in the list or vector VALUE."
  (typecase value
    (list (mapc function value))
    (vector (map nil function value))
    (t (funcall function value))))

(defgeneric reset (object)
  (:documentation "Make OBJECT, of a kind, and its parts as they were when they were made. What its
:LINKs say stays. Return OBJECT. A kind may add an :AFTER method.")
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
