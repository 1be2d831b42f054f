;;;; fluent.lisp -- fluents, and their watchers (manual C).

(in-package :ars-magna.rpl.fluents)

(export '(make-watcher watcher watcher-p define-linked-list home-forked-p declare-fluent-variable
          known-pulse-p known-fluent-variable-p vector-variable-kind robot-fluent-p
          note-changed-by-commands))

;;; A base fluent is set. A derived fluent is computed from its sources. While it has no user, it is
;;; computed on demand and its sources have no link to it. Its first user, a watcher or a used
;;; derived fluent, links it to its sources; when the last user goes, the link is removed, so that
;;; nothing leaks. HEIGHT is the longest path down to a base fluent.

(public fluent)
(addition fluent-p)
(define-record (fluent (:include entity) (:constructor %make-fluent (name now))
                       (:predicate fluent-p "True of fluents, networks included."))
  "A variable whose value changes in time. Plans wait for fluents to become true (manual C)."
  (name nil t "the name that the fluent was created with; for a network, its operator" :addition)
  (now nil t :writable)
  (reading nil (member nil :once :always)
          "NIL until the fluent is read: see WAS-READ-P" :writable)
  (home nil (or null home) :writable)
  (height 0 fixnum :writable)
  (sets 0 fixnum "how often the fluent was set to another value: see operators.lisp" :writable)
  (pulses 0 fixnum "how often the fluent, a base fluent, was pulsed" :writable :export)
  (first-watcher nil (or null watcher) :writable)
  (last-watcher nil (or null watcher) :writable)
  (first-link nil (or null link) :writable)
  (last-link nil (or null link) :writable))

(define-record (derived (:include fluent)
                        (:constructor %make-derived (name operator sources height)))
  "A fluent whose value OPERATOR computes from those of SOURCES, fluents and other objects."
  (operator #'list function)
  (sources '() list)
  (users 0 fixnum :writable)
  (links '() list :writable)
  (trouble nil (or null condition)
           "the error in the last computation of the fluent, or NIL" :writable)
  (queued nil (member nil t :pulsed) "how the fluent will be recomputed, or NIL" :writable)
  (successor nil (or null derived) :writable))

(define-record (watcher (:constructor make-watcher (fluent wake client)))
  "A watcher of FLUENT. When FLUENT changes to a true value, WAKE is called with the watcher, the
value, and NIL or the error in computing the value."
  (fluent nil fluent "the fluent that the watcher watches" :export)
  (wake #'list function
        "the function to call when the fluent becomes true: see WATCHER" :export)
  (client nil t "the object for which the watcher watches, such as a task" :export)
  (pending 0 fixnum "the number of events not yet handled" :writable :export)
  (previous nil (or null watcher) :writable)
  (next nil (or null watcher) :writable))

(define-record (link (:constructor make-link (source dependent)))
  "A record that DEPENDENT must be recomputed when SOURCE changes."
  (source nil fluent)
  (dependent nil derived)
  (previous nil (or null link) :writable)
  (next nil (or null link) :writable))

(define-record (view (:include derived)
                     (:constructor %make-view (name operator sources height bases memory always-p
                                               test key)))
  "A network with a memory: see operators.lisp."
  (bases '() list "the base fluents of the view")
  (memory nil t "the state when the view was last read: how often its bases were set or pulsed. In a
view of changes, a cons of this count and KEY of the value" :writable)
  (always-p nil t "the view counts each event")
  (test nil (or null function))
  (key nil (or null function)))

(declaim-final view derived watcher link fluent)
(define-shared-slots fluent name)

;;; In forks.

(defmethod fresh-twin ((fluent fluent) realm)
  (declare (ignore realm))
  (let ((twin (%make-fluent (fluent-name fluent) (fluent-now fluent))))
    (setf (fluent-sets twin) (fluent-sets fluent)
          (fluent-pulses twin) (fluent-pulses fluent)
          (fluent-reading twin) (fluent-reading fluent))
    twin))

(defmethod fresh-twin ((fluent derived) realm)
  (%make-derived (fluent-name fluent) (derived-operator fluent)
                 (mapcar (lambda (source)
                           (if (fluent-p source) (entity-in source realm) source))
                         (derived-sources fluent))
                 (fluent-height fluent)))

(defgeneric home-forked-p (home copier)
  (:documentation "True if HOME belongs to the run that COPIER copies.")
  (:method (home copier) (declare (ignore home copier)) nil))

(declaim (inline home-of))
(defun home-of (fluent)
  "Return the home of FLUENT; NIL if FLUENT has no home or a closed home."
  (let ((home (fluent-home fluent)))
    (if (and home (home-closed-p home)) nil home)))

(defmethod foreign-entity-p ((fluent fluent) copier)
  (let ((home (home-of fluent)))
    (and home (not (home-forked-p home copier)))))

;; A home made since may be of the run that was forked, or of any other.
(defmethod may-need-twin-p ((fluent fluent) realm)
  (let ((home (home-of fluent)))
    (or (null home)
        (< (realm-made realm) (home-born home))
        (member home (realm-sources realm) :key #'weak-value :test #'eq))))

(public create-fluent)
(defun create-fluent (name &optional value)
  "Return a new fluent with the name NAME and the value VALUE (manual D.4)."
  (%make-fluent name value))

(public state)
(defun state (name)
  "Return a new fluent, false at first. NAME is the proposition that it represents (manual D.2)."
  (create-fluent name nil))

(addition create-fluent-vector)
(defun create-fluent-vector (name count &optional value)
  "Return a vector of COUNT new fluents with VALUE, for example one for each camera (manual C).
Signals WRONG-ARGUMENT unless COUNT is an integer from 0 to a million."
  (check-argument create-fluent-vector count (whole-p count 0 1000000)
                  "an integer from 0 to 1000000")
  (let ((vector (make-array count)))
    (dotimes (i count vector)
      (setf (svref vector i) (create-fluent (format nil "~A ~D" (string name) i) value)))))

;;; Doubly linked lists, so that leaving one costs the same however many are in it.

(defmacro define-linked-list (type list-of &key (in 'fluent) join leave)
  "Define JOIN and LEAVE, which append a member of TYPE to a doubly linked list or remove it.
(LIST-OF member) returns the structure of type IN with the list's slots FIRST-TYPE and LAST-TYPE."
  (let ((first (symbolicate in '-first- type))
        (last (symbolicate in '-last- type))
        (previous (symbolicate type '-previous))
        (next (symbolicate type '-next)))
    `(progn
       (defun ,join (member)
         (let* ((list (,list-of member))
                (tail (,last list)))
           (setf (,previous member) tail
                 (,next member) nil
                 (,last list) member)
           (if tail
               (setf (,next tail) member)
               (setf (,first list) member))))
       (defun ,leave (member)
         (let ((list (,list-of member))
               (before (,previous member))
               (after (,next member)))
           (if before
               (setf (,next before) after)
               (setf (,first list) after))
           (if after
               (setf (,previous after) before)
               (setf (,last list) before))
           (setf (,previous member) nil
                 (,next member) nil))))))

(define-linked-list watcher watcher-fluent :join join-watchers :leave leave-watchers)
(define-linked-list link link-source :join join-links :leave leave-links)

;;; For parts of which the robot has several, such as cameras, a variable holds a vector of
;;; fluents. A vector is always true, so a condition never means it.

(defvar *known-fluent-variables* (make-hash-table :test 'eq :synchronized t)
  "A table from variables to lists (kind pulsed-p commands-p). If the variable holds a fluent, KIND
is T. If it holds a vector of fluents, one for each part of a kind, KIND names this kind. PULSED-P
is true if these fluents are pulsed and never set. COMMANDS-P is true if commands change them.")

(defun declare-fluent-variable (name &key (kind t) pulsed-p)
  "Record that the variable NAME holds a fluent, or a vector of fluents for parts of KIND, a string.
If PULSED-P is true, these fluents are pulsed and never set."
  (setf (gethash name *known-fluent-variables*)
        (list kind pulsed-p (changed-by-commands-p name))))

(defun changed-by-commands-p (name)
  (third (gethash name *known-fluent-variables*)))

(defun note-changed-by-commands (name)
  "Record that commands of the robot change the fluents in the variable NAME."
  (destructuring-bind (&optional (kind t) pulsed-p commands-p)
      (gethash name *known-fluent-variables*)
    (declare (ignore commands-p))
    (setf (gethash name *known-fluent-variables*) (list kind pulsed-p t))))

(defun known-pulse-p (name)
  "True if the variable NAME holds fluents that are pulsed and never set."
  (and (symbolp name) (second (gethash name *known-fluent-variables*))))

(defun known-fluent-variable-p (name)
  "True if the variable NAME is known to hold a fluent."
  (eq t (first (gethash name *known-fluent-variables*))))

(defun vector-variable-kind (name)
  "If the variable NAME holds a vector of fluents for parts, return the kind of part; else NIL."
  (let ((kind (first (gethash name *known-fluent-variables*))))
    (and (stringp kind) kind)))

(defmethod value-to-pass-text ((fluent fluent))
  "FLUENT-VALUE returns the value of a fluent.")

(defun fluents-vector-p (object)
  (and (simple-vector-p object)
       (plusp (length object))
       (every #'fluent-p object)))

(defun reject-fluent-vector (vector &optional (user "a condition"))
  "Signal MISUSE, because VECTOR is a vector of fluents where USER needs a single fluent."
  (let* ((name (safe-text (fluent-name (svref vector 0)) :escape nil))
         (variable (subseq name 0 (position #\Space name :from-end t))))
    (reject-use "~A is a vector of fluents: ~A needs one of them. Write (vref ~2:*~A~* ~A)."
                variable user
                (or (vector-variable-kind (fluent-variable-named variable)) "index"))))

(defun fluent-variable-named (name)
  (loop for variable being the hash-keys of *known-fluent-variables*
        when (string-equal name variable) return variable))

(defun robot-fluent-p (fluent)
  "True if only commands of the robot change FLUENT: FLUENT has the name of a known variable that
commands change, or of an element of the vector in such a variable."
  (let* ((name (safe-text (fluent-name fluent) :escape nil)) (space (position #\Space name))
         (variable (fluent-variable-named (subseq name 0 space))))
    (and variable (changed-by-commands-p variable) t)))
