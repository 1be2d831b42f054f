;;;; realm.lisp -- realms: the states of fluents in runs and in forks.

(in-package :ars-magna.rpl.fluents)

(export '(*realm* +root+ fork-realm drop-realm-references source-realm entity twin-here entity-here
                  fresh-twin
          foreign-entity-p next-token))

;;; Plans, vectors, networks and global variables refer to fluents. A fork needs its own states
;;; for all of them. So each object that is an ENTITY belongs to a realm, and has a twin in each
;;; realm that was forked from that. ENTITY-HERE finds the twin for any entity. Twins
;;; have the same TOKEN, a number. Twins that a fork's plans refer to are made with the fork.
;;; Others are made on demand, with the state at the moment of the fork: before an entity changes,
;;; the forks made since its last change (SEEN counts them) get their twins.

(define-record (realm (:constructor make-realm (parent number)))
  "The entities of one fork, or of all runs that are not forks. The fork has the number NUMBER among
the forks of PARENT. Without PARENT, the realm is that of all runs that are not forks."
  (parent nil (or null realm) :writable)
  (number 0 fixnum :writable)
  (twins (make-hash-table :test 'eq :size 100) hash-table "entities by token")
  (lock (make-lock "realm") t)
  (forks '() list "a list (number . weak realm), the newest first" :writable)
  (room 16 fixnum
        "how many more forks can be recorded before dead forks are removed from the list" :writable)
  (count 0 fixnum "how many forks the realm has had so far" :writable)
  (made 0 (integer 0) "the token given to the realm when it was made" :writable)
  (sources '() list "weak references to the homes of the forked run, at the time of the fork. Can be
set" :writable :export)
  (left-p nil boolean "this fork is over, and another fork has replaced it" :writable)
  (tokens 0 atomic-count :writable))

(define-global +root+ (make-realm nil 0)
  "The realm of all runs that are not forks.")

(defun next-token ()
  "Return a number that is greater than all numbers returned before."
  (1+ (atomic-incf (realm-tokens +root+))))

(declaim (type realm *realm*))
(defvar *realm* +root+
  "The realm of the current run of this thread.")

(define-record (entity (:constructor nil))
  "An object that has a twin in each fork: a fluent or a valve."
  (realm *realm* realm "the realm that the entity belongs to" :writable :export)
  (token 0 fixnum :writable)
  (seen 0 fixnum :writable)
  (first nil t "a weak reference to the oldest twin, or NIL without twins" :writable))

(define-shared-slots entity first)

(declaim (inline entity-here))
(defun entity-here (entity)
  "Return what represents ENTITY in the current run: ENTITY or, in a fork of its run, its twin."
  (if (eq *realm* (entity-realm entity))
      entity
      (entity-in entity *realm*)))

(defun descends-p (realm ancestor)
  (loop for each = realm then (realm-parent each)
        while each thereis (eq each ancestor)))

(defun entity-in (entity realm)
  "Return the object that represents ENTITY in REALM. If REALM was forked from the realm of ENTITY
or replaces it, return the twin; otherwise ENTITY."
  (cond ((eq realm (entity-realm entity)) entity)
        ((descends-p realm (entity-realm entity))
         (or (known-twin entity realm)
             (add-twin entity realm (fresh-twin (entity-in entity (realm-parent realm)) realm))))
        ((realm-left-p (entity-realm entity)) (or (known-twin entity realm) entity))
        (t entity)))

(defun known-twin (entity realm)
  (and (plusp (entity-token entity))
       (with-lock ((realm-lock realm))
         (gethash (entity-token entity) (realm-twins realm)))))

(defun twin-here (entity)
  "Return what represents ENTITY in the current run. ENTITY may be of a fork of the same origin."
  (or (known-twin entity *realm*) (entity-here entity)))

(defgeneric fresh-twin (entity realm)
  (:documentation "Return a new object like ENTITY for REALM. Nothing uses the new object yet."))

(defun ensure-token (entity)
  (when (zerop (entity-token entity))
    (with-lock ((realm-lock (entity-realm entity)))
      (when (zerop (entity-token entity))
        (setf (entity-first entity) (make-weak-reference entity)
              (entity-token entity) (next-token)))))
  (entity-token entity))

(defun add-twin (entity realm twin)
  "Make TWIN the twin of ENTITY in REALM, unless there is a twin already. Return the twin in REALM."
  (let ((token (ensure-token entity)))
    (with-lock ((realm-lock realm))
      (or (gethash token (realm-twins realm))
          (setf (entity-realm twin) realm
                (entity-token twin) token
                (entity-first twin) (entity-first entity)
                (entity-seen twin) 0
                (gethash token (realm-twins realm)) twin)))))

;;; Forking.

(defun fork-realm (realm)
  "Return a new fork of REALM."
  (with-lock ((realm-lock realm))
    (let ((fork (make-realm realm (incf (realm-count realm)))))
      (setf (realm-made fork) (next-token))
      (push (cons (realm-number fork) (make-weak-reference fork)) (realm-forks realm))
      (when (minusp (decf (realm-room realm)))
        (setf (realm-forks realm) (remove-if-not #'weak-value (realm-forks realm) :key #'cdr)
              (realm-room realm) (max 16 (length (realm-forks realm)))))
      fork)))

(defmethod copy-plan-value ((realm realm) fork)
  (if (eq realm (source-realm fork))
      (record-copy realm (fork-realm realm) fork)
      realm))

(defun source-realm (copier)
  "Return the realm of the run that COPIER copies."
  (or (value-in-copied-run copier '*realm*) +root+))

(defgeneric foreign-entity-p (entity copier)
  (:documentation "True if ENTITY does not belong to the run that COPIER copies.")
  (:method (entity copier) (declare (ignore entity copier)) nil))

(defmethod copy-plan-value ((entity entity) fork)
  (let ((own (entity-in entity (source-realm fork))))
    (cond ((not (eq own entity)) (record-copy entity (forked own fork) fork))
          ((not (eq (entity-realm entity) (source-realm fork))) entity)
          ((foreign-entity-p entity fork) entity)
          (t (copy-entity entity fork)))))

(defun copy-entity (entity copier)
  (let ((realm (forked (entity-realm entity) copier))
        (copy (copy-slots entity copier)))
    (setf (entity-token copy) (ensure-token entity)
          (entity-first copy) (entity-first entity)
          (entity-seen copy) 0)
    ;; Runs in other threads, of the same realm, may add twins of what they have.
    (with-lock ((realm-lock realm))
      (setf (gethash (entity-token entity) (realm-twins realm)) copy))
    (when (>= (entity-seen entity) (1- (realm-number realm)))
      (setf (entity-seen entity) (realm-number realm)))
    copy))

;;; A run that is rewound again and again continues in a fork of a fork of a fork. To drop the runs
;;; that are over, the newest takes the twins of its parent and becomes a fork of its grandparent.

(defun twins-in (realm)
  (with-lock ((realm-lock realm))
    (loop for twin being the hash-values of (realm-twins realm) collect twin)))

(defun record-fork (fork realm)
  "Record FORK in REALM. The number of FORK is a number that REALM has used before."
  (with-lock ((realm-lock realm))
    (setf (realm-forks realm)
          (merge 'list (list (cons (realm-number fork) (make-weak-reference fork)))
                 (realm-forks realm)
                 #'> :key #'car))))

(defun promote-realm (realm)
  "If REALM has a grandparent, let REALM take the place of its parent as a fork of the grandparent."
  (let* ((parent (realm-parent realm))
         (above (realm-parent parent)))
    (when above
      (dolist (twin (twins-in parent)) (entity-in twin realm))
      (setf (realm-number realm) (realm-number parent)
            (realm-made realm) (realm-made parent)
            (realm-sources realm) (realm-sources parent)
            (realm-parent realm) above)
      (record-fork realm above))))

(defun drop-realm-references (realm successor)
  "Remove references from SUCCESSOR to entities of REALM, and of its other forks. SUCCESSOR is a
fork of a fork of REALM and replaces REALM. If REALM is not a fork, keep these references."
  (promote-realm successor)
  (when (realm-parent realm)
    (loop for (nil . weak) in (shiftf (realm-forks realm) '())
          for fork = (weak-value weak)
          do (when (and fork (eq realm (realm-parent fork))) (promote-realm fork)))
    (setf (realm-left-p realm) t)))

;;; Changes.

(defgeneric may-need-twin-p (entity realm)
  (:documentation "True if REALM, a fork, may need a twin of ENTITY.")
  (:method (entity realm) (declare (ignore entity realm)) t))

(defun make-fork-twins (entity)
  "Make the twins of ENTITY in the forks that were made since the last change of ENTITY."
  (let ((realm (entity-realm entity)))
    (loop for (number . weak) in (realm-forks realm)
          while (> number (entity-seen entity))
          do (let ((fork (weak-value weak)))
               (when (and fork (may-need-twin-p entity fork))
                 (entity-in entity fork))))
    (setf (entity-seen entity) (realm-count realm))))

(declaim (inline before-change))
(defun before-change (entity)
  "Make the twins of ENTITY that forks need. Must be called before each change of ENTITY's state."
  (when (< (entity-seen entity) (realm-count (entity-realm entity)))
    (make-fork-twins entity)))
