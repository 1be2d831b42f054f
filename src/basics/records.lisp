;;;; records.lisp -- marks of users' names; structures that describe their slots.

(in-package :ars-magna.basics)

(export '(document-restarts restart-name-list restart-documentation public addition settable
          settable-p addition-p addition-docstring public-symbols *loading-simulator-p*
          define-record
          reader-docstring
          reader-export-forms))

;;; A mark precedes the definition of a name: PUBLIC for the manual's names, ADDITION for ours. The
;;; users' packages ARS and NISP collect these (see src/faces.lisp). Unmarked names are internal.

(defstruct (mark (:constructor make-mark (symbol faces addition-p)) (:copier nil))
  "The mark of a public name: the FACES (:ARS, :NISP) whose packages export SYMBOL, and whether
SYMBOL is an addition to the manual."
  (symbol nil :type symbol :read-only t)
  (faces '() :type list :read-only t)
  (addition-p nil :type boolean :read-only t))

(defvar *public-marks* '() "All marks, in order of definition.")

(defparameter *packages-of-nisp*
  '("ARS-MAGNA.NISP" "ARS-MAGNA.CANVAS" "ARS-MAGNA.RPL.FLUENTS" "ARS-MAGNA.RPL.TASKS"
    "ARS-MAGNA.RPL.LANGUAGE" "ARS-MAGNA.RPL.CONSTRUCTS" "ARS-MAGNA.RPL.SEEING"
    "ARS-MAGNA.RPL-ROBOT" "ARS-MAGNA.RPL-PICTURES" "ARS-MAGNA.RPL-PROJECTING")
  "The packages whose public names NISP exports by default. ARS exports all other public names.")

(defun default-export-package (symbol)
  (let ((layer (package-name (symbol-package symbol))))
    (if (member layer *packages-of-nisp* :test #'string=) :nisp :ars)))

(defun find-public-mark (symbol)
  (find symbol *public-marks* :key #'mark-symbol :test #'eq))

(defun register-public-mark (mark)
  (let ((old (find-public-mark (mark-symbol mark))))
    (setf *public-marks* (if old
                             (substitute mark old *public-marks* :test #'eq)
                             (append *public-marks* (list mark))))))

(defvar *loading-simulator-p* t
  "True while the simulator is being loaded. Later definitions belong to users and get no marks.")

(defun mark-public-names (names addition-p)
  "Mark and export NAMES, symbols or lists (symbol face...). An addition keeps its mark."
  (when *loading-simulator-p*
    (dolist (name names)
      (destructuring-bind (symbol &rest faces) (ensure-list name)
        (export symbol (symbol-package symbol))
        (when (or addition-p (not (addition-p symbol)))
          (register-public-mark (make-mark symbol (or faces (list (default-export-package symbol)))
                                           addition-p)))))))

(defmacro public (&rest names)
  "Mark NAMES, which are defined next, as public names that the manual has. A name may be a list
(name face...). The faces, :ARS or :NISP, are the packages that export the name."
  `(mark-public-names ',names nil))

(defmacro addition (&rest names)
  "Mark NAMES, which are defined next, as public names that the manual does not have. A name may be
a list (name face...), as for PUBLIC."
  `(mark-public-names ',names t))

(defvar *settable* '() "The public symbols whose functions users may SETF.")

(defmacro settable (&rest names)
  "Let users SETF the functions NAMES, which are public. Users cannot SETF other functions, because
only functions that the journal records may change the state of a run."
  `(setf *settable* (union *settable* ',names)))

(defun settable-p (symbol)
  "True if users may SETF the function named SYMBOL."
  (and (member symbol *settable* :test #'eq) t))

(defun public-symbols (face)
  "Return the symbols that the package FACE, :ARS or :NISP, exports, in order of definition."
  (loop for mark in *public-marks*
        when (member face (mark-faces mark))
          collect (mark-symbol mark)))

(defun addition-p (symbol)
  "True if SYMBOL is marked as an addition to the manual."
  (let ((mark (find-public-mark symbol)))
    (and mark (mark-addition-p mark))))

(defun addition-docstring (text)
  "Return TEXT, the documentation of an addition to the manual. If TEXT lacks the sentence \"An
addition to the manual.\", add it as the last line, and remove a reference to chapter C."
  (let ((sentence "An addition to the manual."))
    (if (search sentence text)
        text
        (format nil "~A~%~A" (subseq text 0 (search " (Manual C.)" text)) sentence))))

;;; Lisp has no documentation for restarts, so it is kept here.

(defvar *documented-restarts* '() "Lists (name text): the restarts that are documented.")

(defun document-restarts (&rest names-and-texts)
  "Document restarts. NAMES-AND-TEXTS alternates names and texts that say what the restarts do."
  (loop for (name text) on names-and-texts by #'cddr
        do (setf *documented-restarts* (append (remove name *documented-restarts* :key #'first)
                                    (list (list name (one-line text)))))))

(defun restart-name-list ()
  "Return a list of the names of the documented restarts."
  (mapcar #'first *documented-restarts*))

(defun restart-documentation (name)
  "Return the documentation of the restart NAME, a symbol, or NIL."
  (second (find name *documented-restarts* :key #'first)))

;;;; Structures that describe their slots

;;; One form describes a structure, its slots, and who may read them. It gives the documentation of
;;; the functions and the marks of the readers. For objects of a run, see DEFINE-KIND.

(defun set-documentations (functions-and-texts)
  (loop for (function . text) in functions-and-texts
        do (setf (documentation function 'function) text)))

(defun reader-docstring (slot text)
  "Return documentation for the reader of the slot named SLOT. TEXT describes the slot's contents."
  (if (ends-with-subseq "-P" (symbol-name slot))
      (format nil "True if ~A." text)
      (format nil "Return ~A." text)))

(defun function-docstrings (name documentation predicate constructors)
  "Return an alist (symbol . text) for PREDICATE and CONSTRUCTORS, (symbol [arguments] [text])."
  (flet ((texts (beginning functions)
           (loop for (function . rest) in functions
                 when function
                   collect (cons function
                                 (or (find-if #'stringp rest)
                                     (format nil "~A of type ~A. ~A" beginning (symbol-name name)
                                             documentation))))))
    (append (texts "True of objects" (list predicate))
            (texts "Return a new object" constructors))))

(defun reader-export-forms (slots reader)
  "Return forms that export the readers of the SLOTS marked :EXPORT or :ADDITION. READER, a function
of the slot's name, returns the reader's name."
  (flet ((readers (mark)
           (loop for slot in slots
                 when (member mark (nthcdr 3 slot)) collect (funcall reader (first slot)))))
    (let ((exported (readers :export)) (added (readers :addition)))
      (append (when exported `((export ',exported)))
              (when added `((addition ,@added)))))))

(defun values-of-option (key options &optional default)
  "Return a list of the arguments of each option KEY in OPTIONS; (DEFAULT) if there is none."
  (or (loop for option in options when (eq key (first option)) collect (rest option))
      (list default)))

(defun conc-name (name options)
  (first (first (values-of-option :conc-name options (list (symbolicate name "-"))))))

(defun slot-text (slot)
  (find-if #'stringp (nthcdr 3 slot)))

(defun check-record-slot (name slot)
  (unless (and (proper-list-p slot) (<= 3 (length slot)) (symbolp (first slot))
               (not (keywordp (third slot)))
               (subsetp (remove (slot-text slot) (nthcdr 3 slot)) '(:writable :export :addition)))
    (error 'malformed-definition
           :definition (format nil "define-record ~(~A~)" name) :clause slot
           :expected "(name default type [\"what is in it\"] [:writable] [:export] [:addition])")))

(defun slot-definition (slot)
  (destructuring-bind (name default type &rest rest) slot
    `(,name ,default :type ,type ,@(unless (member :writable rest) '(:read-only t)))))

(defun docstrings-of-record (name options documentation slots)
  (append (loop for slot in slots
                for text = (slot-text slot)
                when text
                  collect (cons (symbolicate (conc-name name options) (first slot))
                                (reader-docstring (first slot) text)))
          (function-docstrings name documentation
                               (first (values-of-option :predicate options
                                                        (list (symbolicate name "-P"))))
                               (values-of-option :constructor options
                                                 (list (symbolicate "MAKE-" name))))))

(defmacro define-record (name-and-options documentation &body slots)
  "Define a structure and document its slots. NAME-AND-OPTIONS is as in DEFSTRUCT; documentation may
follow a constructor or predicate. There is a copier only if an option names one. A slot is (name
default type [\"what is in it\"] mark...). The reader's documentation is \"Return what is in it\",
or \"True if ...\" if the name ends in -P. The marks are
  :writable  if the slot can be set;
  :export    if other layers use the reader;
  :addition  if users use the reader (see ADDITION).
Return the name. Signals MALFORMED-DEFINITION."
  (destructuring-bind (name &rest options) (ensure-list name-and-options)
    (dolist (slot slots) (check-record-slot name slot))
    `(progn
       (defstruct (,name ,@(mapcar (lambda (option) (remove-if #'stringp option)) options)
                         ,@(unless (assoc :copier options) '((:copier nil))))
         ,documentation
         ,@(mapcar #'slot-definition slots))
       ,@(reader-export-forms slots (lambda (slot) (symbolicate (conc-name name options) slot)))
       (set-documentations ',(docstrings-of-record name options documentation slots))
       ',name)))
