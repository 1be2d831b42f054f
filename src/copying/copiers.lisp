;;;; copiers.lisp -- the object that copies a run, and how structures are copied.

(in-package :ars-magna.copying)

(export '(copier with-copier value-in-copied-run copier-option record-copy record-finished-copy
          define-shared-types define-shared-slots))

(define-record (copier (:constructor make-copier ()))
  "An object that copies a run."
  (table (make-hash-table :test 'eq :size 500) hash-table "the copies by their originals" :writable)
  (work (make-array 512) simple-vector
        "the copies with references to replace, each followed by the slots' numbers" :writable)
  (fill 0 fixnum :writable)
  (tables '() list "the hash tables to fill when everything else is copied" :writable)
  (holder nil t "the copy whose references are being replaced" :writable)
  (environment '() list
               "an alist (variable . value) of the variables that the copied run has bound"
               :writable :export)
  (objects nil t "data that a layer stores to find copies. Can be set" :writable :export)
  (screen nil (or null function) "NIL, or a function of an object to copy: it returns a replacement
for the copy and true, or NIL and false" :writable)
  (options '() list "a plist of options; see COPIER-OPTION" :writable))

(defun copier-option (copier key)
  "Return the value of the option KEY of COPIER, or NIL."
  (getf (copier-options copier) key))

(defun value-in-copied-run (copier symbol)
  "Return the value to which the run that COPIER copies has bound SYMBOL."
  (cdr (assoc symbol (copier-environment copier) :test #'eq)))

;;; Recording copies.

(declaim (inline record-copy))
(defun record-copy (value copy copier)
  "Record COPY as the copy of VALUE by COPIER. Return COPY."
  (setf (gethash value (copier-table copier)) copy))

(declaim (inline record-finished-copy))
(defun record-finished-copy (copy copier)
  "Record COPY, an object made for the fork by COPIER, as a complete copy. Return COPY."
  (record-copy copy copy copier))

(defun queue-references (copy indices copier)
  "Queue COPY in COPIER: REPLACE-REFERENCES will replace its slots numbered INDICES. Return COPY."
  (let ((fill (copier-fill copier)))
    (declare (type (unsigned-byte 40) fill))
    (when (= fill (length (copier-work copier)))
      (setf (copier-work copier) (replace (make-array (* 4 fill)) (copier-work copier))))
    (setf (svref (copier-work copier) fill) copy
          (svref (copier-work copier) (1+ fill)) indices
          (copier-fill copier) (+ fill 2))
    copy))

;;; A copier is much larger than its copy of a small run, so copiers are reused.

(defvar *idle-copiers* (list '())
  "A list of one element, the list of the copiers that are not in use.")

(defconstant +reusable-copier-limit+ 20000
  "A copier that has copied more objects than this is not reused.")

(defun take-copier ()
  (loop for copiers = (car *idle-copiers*)
        while copiers
        when (swap-if-eq (car *idle-copiers*) copiers (rest copiers))
          return (first copiers)
        finally (return (make-copier))))

(defun put-copier-back (copier)
  (when (<= (hash-table-count (copier-table copier)) +reusable-copier-limit+)
    (clrhash (copier-table copier))
    (fill (copier-work copier) 0)
    (setf (copier-holder copier) nil
          (copier-environment copier) '()
          (copier-objects copier) nil
          (copier-screen copier) nil
          (copier-options copier) '())
    (atomic-push copier (car *idle-copiers*))))

(defmacro with-copier ((copier &key environment options screen) &body body)
  "Run BODY with the variable COPIER bound to a copier. ENVIRONMENT is an alist of the variables
that the copied run has bound; see REPLACE-OR-COPY for SCREEN. Return the values of BODY."
  `(let ((,copier (take-copier)))
     (setf (copier-environment ,copier) ,environment
           (copier-options ,copier) ,options
           (copier-screen ,copier) ,screen)
     (multiple-value-prog1 (progn ,@body)
       (put-copier-back ,copier))))

;;;; How structures are copied

(addition cannot-fork)
(define-condition cannot-fork (ars-magna-error)
  ((value :initarg :value :reader cannot-fork-value)
   (place :initarg :place :initform nil :reader cannot-fork-place)
   (trouble :initarg :trouble :initform nil :reader cannot-fork-trouble))
  (:report (lambda (condition stream)
             (format stream "~A cannot be copied for a fork~@[; it was found in ~A~]. ~:[Share it, ~
                             leave it out, or define a method of COPY-PLAN-VALUE for it~;The ~
                             method of COPY-PLAN-VALUE for it failed: ~:*~A. Correct the method, ~
                             share the object, or leave it out~]."
                     (safe-text (cannot-fork-value condition) :length 200)
                     (cannot-fork-place condition)
                     (and (cannot-fork-trouble condition)
                          (string-right-trim "." (cannot-fork-trouble condition))))))
  (:documentation "The run to be forked refers to something in the outside world: a stream, a
thread, a lock. The restarts are SHARE-VALUE (both runs have the same object), LEAVE-OUT-VALUE (the
fork has NIL in its place) and MAKE-NO-FORK."))

(addition cannot-fork-value cannot-fork-place share-value leave-out-value make-no-fork)
(document-restarts
 'share-value "Make the fork; both runs have the same object."
 'leave-out-value "Make the fork, with NIL in place of the object."
 'make-no-fork "Make no fork. The function that was called to make the fork returns NIL.")
(setf (documentation 'cannot-fork-value 'function)
      "Return the object that cannot be copied."
      (documentation 'cannot-fork-place 'function)
      "Return a text that says where the object was found, such as the name of a plan's variable.")

(defun value-location-text (value copier)
  "Return a text that says where VALUE was found: COPIER's :PLACE-OF, or what refers to VALUE."
  (let ((place-of (copier-option copier :place-of)))
    (or (and place-of (funcall place-of value))
        (and (copier-holder copier) (safe-text (copier-holder copier) :length 200)))))

(defun find-chosen-replacement (value copier)
  "If COPIER's caller has chosen a replacement for VALUE, return (VALUE . replacement); else NIL."
  (assoc value (copier-option copier :decisions) :test #'eq))

(defun chosen-replacement (value copier)
  "Return the replacement for VALUE chosen by the caller of COPIER. Signals CANNOT-FORK if none."
  (let ((decision (find-chosen-replacement value copier)))
    (if decision
        (cdr decision)
        (error 'cannot-fork :value value :place (value-location-text value copier)))))

(defgeneric copy-plan-value (value fork)
  (:documentation
   "Return the counterpart of VALUE in FORK, a fork that is being made. VALUE is an object in a
variable of a plan, in a closure or elsewhere in a run. By default, lists, vectors, tables,
structures and instances are copied with their contents. If two of them share an object, their
copies share the copy of that object. Functions are shared; closures are copied with the variables
that they close over. To change this, define a method for a class of your own: return VALUE itself
to share it, or a replacement. (forked x fork) returns the counterpart of another object x.")
  (:method (value fork) (chosen-replacement value fork)))

(addition copy-plan-value)

;;; Shared objects.

(defvar *shared-types* '()
  "The types of structures that a run shares with its forks.")

(defmacro define-shared-types (&rest types)
  "Make a run share objects of TYPES with its forks."
  `(progn ,@(loop for type in types
                  collect `(pushnew ',type *shared-types*)
                  collect `(defmethod copy-plan-value ((value ,type) fork)
                             (declare (ignore fork))
                             value))))

(defvar *shared-slots* '()
  "Lists (type slot...): structures that have no kind, and slots whose contents never change.")

(defmacro define-shared-slots (type &rest slots)
  "Make a run share the contents of SLOTS, slots of structures of TYPE, with its forks."
  `(pushnew '(,type ,@slots) *shared-slots* :test #'equal))

(defun shared-slot-p (name object kind)
  "True if forks share the contents of the slot NAME of OBJECT. KIND is the kind of OBJECT, or NIL."
  (let ((slot (and kind (find name (kind-slots kind) :key #'kind-slot-name :test #'eq))))
    (if slot
        (kind-slot-shared-p slot)
        (or (and (environment-p object) (interpreter-only-slot-p name))
            (loop for (type . slots) in *shared-slots*
                    thereis (and (typep object type) (member name slots)))))))

;;; Copy policies.

(defstruct (copy-policy (:constructor make-copy-policy (way indices fresh)) (:copier nil))
  "How structures of a class are copied. WAY is :SHARE, :COPY, :METHOD (by a user's method) or :ASK
(the caller chooses, for SBCL's structures). INDICES are the numbers of the slots whose contents are
copied too. FRESH lists pairs of functions (writer . initial), for slots that get initial values."
  (way :copy :type (member :share :copy :method :ask) :read-only t)
  (indices #() :type simple-vector :read-only t)
  (fresh '() :type list :read-only t))

(defun default-method-p (object class)
  "True if the simulator's own method of COPY-PLAN-VALUE for CLASS copies OBJECT."
  (eq (first (compute-applicable-methods #'copy-plan-value (list object nil)))
      (find-method #'copy-plan-value '() (list (find-class class) (find-class t)))))

(defun choose-copy-way (object)
  (cond ((or (comma-p object) (some (lambda (type) (typep object type)) *shared-types*)) :share)
        ((not (default-method-p object 'structure-object)) :method)
        ((and (lisp-symbol-p (class-name (class-of object))) (not (environment-p object))) :ask)
        (t :copy)))

(defun compute-copy-policy (object)
  (let* ((kind (kind-of object)) (way (choose-copy-way object))
         (links (remove :link (and kind (kind-slots kind))
                        :key #'kind-slot-role :test-not #'eq)))
    (if (member way '(:share :ask))
        (make-copy-policy way #() '())
        (make-copy-policy way
                          (coerce (loop for (index . name) in (reference-slots object)
                                        unless (or (find name links :key #'kind-slot-name)
                                                   (shared-slot-p name object kind))
                                          collect index)
                                  'simple-vector)
                          (loop for slot in links
                                collect (cons (kind-slot-writer slot) (kind-slot-initial slot)))))))

(defconstant +policies-cached+ 4096 "The size of the cache of copy policies, a power of 2.")

(defun make-policy-cache ()
  (make-array +policies-cached+ :initial-element nil))

(defvar *copy-policies* (cons '() (make-policy-cache))
  "A cons: the methods of COPY-PLAN-VALUE, and a cache of copy policies valid for these methods. The
cache is a vector of pairs (layout . copy-policy), indexed by the number of the layout.")

(defun refresh-copy-policies ()
  "Clear the cache of copy policies if methods of COPY-PLAN-VALUE were defined after it was made."
  (let ((methods (methods-of-generic #'copy-plan-value)))
    (unless (eq methods (car *copy-policies*))
      (setf *copy-policies* (cons methods (make-policy-cache))))))

(defun copy-policy (object)
  (declare #.*hot*)
  (let* ((policies (cdr *copy-policies*))
         (layout (layout-of object))
         (place (logand (layout-hash layout) (1- +policies-cached+)))
         (known (svref policies place)))
    (if (eq layout (car known))
        (cdr known)
        (cdr (setf (svref policies place) (cons layout (compute-copy-policy object)))))))
