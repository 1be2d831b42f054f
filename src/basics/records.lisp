;;;; records.lisp -- structures whose slots say what they are.

(in-package :ars-magna.basics)

(export '(define-record reader-text reader-marks))

;;; One form says of a structure what it is, what is in its slots, and who may read them. From that
;;; follow the documentation of its functions and the marks of its readers. Objects that belong to a
;;; run say more: see DEFINE-KIND.

(defun set-documentations (functions-and-texts)
  (loop for (function . text) in functions-and-texts
        do (setf (documentation function 'function) text)))

(defun reader-text (slot text)
  "Return the documentation of a reader of SLOT, a symbol, in which is what TEXT says."
  (if (ends-with-subseq "-P" (symbol-name slot))
      (format nil "True if ~A." text)
      (format nil "Return ~A." text)))

(defun function-texts (name documentation predicate constructors)
  "Return an alist with the documentation of PREDICATE and CONSTRUCTORS of the structure NAME, of
which DOCUMENTATION says what it is. A function is a list (symbol [lambda-list] [documentation])."
  (flet ((texts (beginning functions)
           (loop for (function . rest) in functions
                 when function
                   collect (cons function
                                 (or (find-if #'stringp rest)
                                     (format nil "~A of type ~A. ~A" beginning (symbol-name name)
                                             documentation))))))
    (append (texts "True of objects" (list predicate))
            (texts "Return a new object" constructors))))

(defun reader-marks (slots reader)
  "Return forms that let others use the readers of those SLOTS behind whose type stands :EXPORT or
:ADDITION. READER, a function of the slot's name, returns that of the reader."
  (flet ((readers (mark)
           (loop for slot in slots
                 when (member mark (nthcdr 3 slot)) collect (funcall reader (first slot)))))
    (let ((exported (readers :export)) (added (readers :addition)))
      (append (when exported `((export ',exported)))
              (when added `((addition ,@added)))))))

(defun values-of-option (key options &optional default)
  "Return a list of what stands behind KEY in each of OPTIONS, as DEFSTRUCT takes them, that begins
with it; without any, that of DEFAULT."
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

(defun record-texts (name options documentation slots)
  (append (loop for slot in slots
                for text = (slot-text slot)
                when text
                  collect (cons (symbolicate (conc-name name options) (first slot))
                                (reader-text (first slot) text)))
          (function-texts name documentation
                          (first (values-of-option :predicate options
                                                   (list (symbolicate name "-P"))))
                          (values-of-option :constructor options
                                            (list (symbolicate "MAKE-" name))))))

(defmacro define-record (name-and-options documentation &body slots)
  "Define a structure and say what each of its slots is. NAME-AND-OPTIONS is as in DEFSTRUCT; behind
a constructor or predicate may stand its documentation. There is a copier only if an option says so.
A slot is (name default type [\"what is in it\"]), with what is in it a sentence without beginning:
its reader returns that, or is true if that holds where the name ends in -P. Behind it stand
  :writable  if the slot can be set;
  :export    if other layers use the reader;
  :addition  if users do (see ADDITION).
Return the name. Signals MALFORMED-DEFINITION."
  (destructuring-bind (name &rest options) (ensure-list name-and-options)
    (dolist (slot slots) (check-record-slot name slot))
    `(progn
       (defstruct (,name ,@(mapcar (lambda (option) (remove-if #'stringp option)) options)
                         ,@(unless (assoc :copier options) '((:copier nil))))
         ,documentation
         ,@(mapcar #'slot-definition slots))
       ,@(reader-marks slots (lambda (slot) (symbolicate (conc-name name options) slot)))
       (set-documentations ',(record-texts name options documentation slots))
       ',name)))
