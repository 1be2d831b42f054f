;;;; copiers.lisp -- what copies the objects of a run, and how structures are copied.

(in-package :ars-magna.copying)

(export '(copier with-copier copier-variable copier-option note-copy settled define-shared
          define-shared-slots))

(define-record (copier (:constructor make-copier ()))
  "What copies a run."
  (table (make-hash-table :test 'eq :size 500) hash-table "what was copied, and to what" :writable)
  (work (make-array 512) simple-vector
        "the copies that are to be put right, each followed by how" :writable)
  (fill 0 fixnum :writable)
  (tables '() list "the hash tables that are to be filled when all else is done" :writable)
  (holder nil t "what is being put right" :writable)
  (environment '() list
               "a list (variable . value): what the run that is copied has bound" :writable :export)
  (objects nil t "what a layer has put there to find copies by. Can be set" :writable :export)
  (screen nil (or null function) "a function of what is about to be copied, or NIL: it returns what
there is to be instead of a copy, and true; or NIL and false" :writable)
  (options '() list "a plist for those who know what to do about it" :writable))

(defun copier-option (copier key)
  "Return what the one who asked for COPIER said of KEY, or NIL."
  (getf (copier-options copier) key))

(defun copier-variable (copier symbol)
  "Return the value that the run that COPIER copies has bound SYMBOL to."
  (cdr (assoc symbol (copier-environment copier) :test #'eq)))

;;; Noting.

(declaim (inline note-copy))
(defun note-copy (value copy copier)
  "Let COPY be what COPIER has for VALUE. Return COPY."
  (setf (gethash value (copier-table copier)) copy))

(declaim (inline settled))
(defun settled (copy copier)
  "Return COPY, an object that is made for the fork of COPIER, and all right."
  (note-copy copy copy copier))

(defun put-right-later (copy how copier)
  "Let COPIER put right what is in COPY, HOW: see PUT-RIGHT. Return COPY."
  (let ((fill (copier-fill copier)))
    (declare (type (unsigned-byte 40) fill))
    (when (= fill (length (copier-work copier)))
      (setf (copier-work copier) (replace (make-array (* 4 fill)) (copier-work copier))))
    (setf (svref (copier-work copier) fill) copy
          (svref (copier-work copier) (1+ fill)) how
          (copier-fill copier) (+ fill 2))
    copy))

;;; A copier is much larger than what it makes of a small run; so those that have done their work
;;; are used again.

(defvar *idle-copiers* (list '())
  "A list whose element is the list of the copiers that nobody uses.")

(defconstant +largest-idle+ 20000 "How many objects a copier may have copied to be used again.")

(defun take-copier ()
  (loop for copiers = (car *idle-copiers*)
        while copiers
        when (swap-if (car *idle-copiers*) copiers (rest copiers))
          return (first copiers)
        finally (return (make-copier))))

(defun put-copier-back (copier)
  (when (<= (hash-table-count (copier-table copier)) +largest-idle+)
    (clrhash (copier-table copier))
    (fill (copier-work copier) 0)
    (setf (copier-holder copier) nil
          (copier-environment copier) '()
          (copier-objects copier) nil
          (copier-screen copier) nil
          (copier-options copier) '())
    (atomic-push copier (car *idle-copiers*))))

(defmacro with-copier ((copier &key environment options screen) &body body)
  "Run BODY with COPIER bound to what copies a run that has bound the variables of ENVIRONMENT, with
OPTIONS and SCREEN. Return the values of BODY."
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
                             method of COPY-PLAN-VALUE for it failed: ~:*~A. Mend that, share it, ~
                             or leave it out~]."
                     (safe-text (cannot-fork-value condition) :length 200)
                     (cannot-fork-place condition)
                     (and (cannot-fork-trouble condition)
                          (string-right-trim "." (cannot-fork-trouble condition))))))
  (:documentation "A fork was asked for, and something in the run is part of the world outside: a
stream, a thread, a lock. Restarts: SHARE-VALUE, both runs have the same one; LEAVE-OUT-VALUE, the
fork has NIL instead; MAKE-NO-FORK."))

(addition cannot-fork-value cannot-fork-place share-value leave-out-value make-no-fork)
(document-restarts
 'share-value "Make the fork; both runs have the same object."
 'leave-out-value "Make the fork; it has NIL instead of the object."
 'make-no-fork "Make no fork. The function that was to make one returns NIL.")
(setf (documentation 'cannot-fork-value 'function)
      "Return what cannot be copied."
      (documentation 'cannot-fork-place 'function)
      "Return where it was found: a text, such as the name of a plan's variable.")

(defun found-in (value copier)
  "Return a text that says where COPIER has come upon VALUE: what its option :PLACE-OF, a function,
says, or else in what kind of object."
  (let ((place-of (copier-option copier :place-of)))
    (or (and place-of (funcall place-of value))
        (and (copier-holder copier) (safe-text (copier-holder copier) :length 200)))))

(defun decision-about (value copier)
  "Return a cons of VALUE and what the fork is to have for it, if COPIER was told that; else NIL."
  (assoc value (copier-option copier :decisions) :test #'eq))

(defun ask-about (value copier)
  "Return what the fork is to have for VALUE as the option :DECISIONS, an alist, says. Signals
CANNOT-FORK."
  (let ((decision (decision-about value copier)))
    (if decision
        (cdr decision)
        (error 'cannot-fork :value value :place (found-in value copier)))))

(defgeneric copy-plan-value (value fork)
  (:documentation
   "Return what FORK, a fork of a run that is being made, is to have for VALUE, which was found in
the variables of its plans, in closures, or wherever a run keeps things. Lists, vectors, tables,
structures and instances of classes are copied, with what is in them; what two hold is shared by
their copies. Functions are shared, those that have closed over something are copied with that. A
method for a class of one's own may say otherwise: that VALUE itself is shared, by returning it, or
what stands for it; (forked x fork) is what FORK has for another object x.")
  (:method (value fork) (ask-about value fork)))

(addition copy-plan-value)

;;; What is shared.

(defvar *shared-types* '()
  "The types of structures that are shared.")

(defmacro define-shared (&rest types)
  "Let objects of TYPES be shared by a run and its forks."
  `(progn ,@(loop for type in types
                  collect `(pushnew ',type *shared-types*)
                  collect `(defmethod copy-plan-value ((value ,type) fork)
                             (declare (ignore fork))
                             value))))

(defvar *shared-slots* '()
  "Lists (type slot...): slots of structures without a kind, in which nothing is ever altered.")

(defmacro define-shared-slots (type &rest slots)
  "Let a run and its forks share what is in SLOTS of structures of TYPE."
  `(pushnew '(,type ,@slots) *shared-slots* :test #'equal))

(defun shared-slot-p (name object kind)
  "True if forks share what is in the slot NAME of OBJECT, of KIND or of none."
  (let ((slot (and kind (find name (kind-slots kind) :key #'kind-slot-name :test #'eq))))
    (if slot
        (kind-slot-shared-p slot)
        (or (and (environment-p object) (fixed-slot-p name))
            (loop for (type . slots) in *shared-slots*
                    thereis (and (typep object type) (member name slots)))))))

;;; Manners.

(defstruct (manner (:constructor make-manner (way indices fresh)) (:copier nil))
  "How structures of a class are copied. WAY is :SHARE; :COPY; :METHOD, if a method knows; or :ASK,
of what is the system's own. What is in the slots number INDICES is copied too; FRESH is a list
(writer . initial) of functions for the slots that are as in a new object."
  (way :copy :type (member :share :copy :method :ask) :read-only t)
  (indices #() :type simple-vector :read-only t)
  (fresh '() :type list :read-only t))

(defun default-method-p (object class)
  "True if OBJECT is copied by our method of COPY-PLAN-VALUE for CLASS, not by another one."
  (eq (first (compute-applicable-methods #'copy-plan-value (list object nil)))
      (find-method #'copy-plan-value '() (list (find-class class) (find-class t)))))

(defun way-to-copy (object)
  (cond ((some (lambda (type) (typep object type)) *shared-types*) :share)
        ((not (default-method-p object 'structure-object)) :method)
        ((and (lisps-own-p (class-name (class-of object))) (not (environment-p object))) :ask)
        (t :copy)))

(defun find-manner (object)
  (let* ((kind (kind-of object)) (way (way-to-copy object))
         (links (remove :link (and kind (kind-slots kind))
                        :key #'kind-slot-role :test-not #'eq)))
    (if (member way '(:share :ask))
        (make-manner way #() '())
        (make-manner way
                     (coerce (loop for (index . name) in (reference-slots object)
                                   unless (or (find name links :key #'kind-slot-name)
                                              (shared-slot-p name object kind))
                                     collect index)
                             'simple-vector)
                     (loop for slot in links
                           collect (cons (kind-slot-writer slot) (kind-slot-initial slot)))))))

(defconstant +manners-known+ 4096 "How many manners are remembered at most, a power of 2.")

(defun no-manners ()
  (make-array +manners-known+ :initial-element nil))

(defvar *manners* (cons '() (no-manners))
  "The methods of COPY-PLAN-VALUE, and what was found out when these were all: a vector of lists
(layout . manner), each where the number of its layout says, the last one of those that belong
there.")

(defun refresh-manners ()
  "Forget the manners that were found out before methods of COPY-PLAN-VALUE were defined."
  (let ((methods (methods-of-generic #'copy-plan-value)))
    (unless (eq methods (car *manners*))
      (setf *manners* (cons methods (no-manners))))))

(defun manner (object)
  (declare #.*hot*)
  (let* ((manners (cdr *manners*))
         (layout (layout-of object))
         (place (logand (layout-number layout) (1- +manners-known+)))
         (known (svref manners place)))
    (if (eq layout (car known))
        (cdr known)
        (cdr (setf (svref manners place) (cons layout (find-manner object)))))))
