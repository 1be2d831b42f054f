;;;; define-kind.lisp -- defining kinds of objects: structures whose slots say what they are.

(in-package :ars-magna.definitions)

(export '(define-kind))

(defun document-readers (kind conc package)
  "Document the readers of KIND, whose names in PACKAGE begin with CONC."
  (dolist (slot (kind-slots kind))
    (let* ((name (kind-slot-name slot))
           (reader (find-symbol (concatenate 'string conc (symbol-name name)) package)))
      (when (and reader (fboundp reader))
        (setf (documentation reader 'function) (reader-text name (kind-slot-text slot)))))))

(defun register-kind (name parent slots conc)
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
               (stringp (fourth slot))
               (subsetp (nthcdr 4 slot) '(:part :shared :near :export :addition)))
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
  (loop for (role slot default type text part-p shared-p) in slots
        for reader = (symbolicate conc slot)
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
object, :SHARED if it is never altered, :NEAR if it is to stand beside others; :EXPORT and :ADDITION
are as in DEFINE-RECORD. The roles are
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
  (let ((slots (slots-by-role groups))
        (conc (concatenate 'string (symbol-name name) "-"))
        (constructor (ensure-list constructor)))
    `(progn
       (define-record (,name ,@(when include `((:include ,include)))
                             (:constructor ,@(or constructor '(nil))))
         ,documentation
         ,@(loop for (slot default type text . options) in (slots-by-place groups)
                 collect `(,slot ,default ,type ,text :writable
                                 ,@(intersection '(:export :addition) options))))
       (register-kind ',name ',include (list ,@(slot-forms name conc slots)) ,conc)
       (defmethod describe-object ((object ,name) stream)
         (describe-by-kind object stream))
       ',name)))
