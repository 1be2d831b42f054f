;;;; home.lisp -- the home of a fluent: the one thread at a time that applies its changes.

(in-package :ars-magna.rpl.fluents)

(export '(*runner* *default-interface* default-home note-outside-change home with-owned-home
                   call-with-owned-home home-busy-p
          post-entry take-posted-entry posted-p))

;;; A fluent that a task waits for has a home, the plan runner of that task. One thread at a time
;;; works in a home. Other threads post their changes, which are applied in the order of posting.
;;; The newest entry of the inbox comes first, the oldest of the outbox.

(defstruct (backlog (:constructor make-backlog ()) (:copier nil))
  "A queue of derived fluents to recompute, by height, and at the same height in order of arrival."
  (heads (make-array 8 :initial-element nil) :type simple-vector)
  (tails (make-array 8 :initial-element nil) :type simple-vector)
  (highest 0 :type fixnum))

(define-record (home (:constructor make-home ()))
  "The place where changes of fluents are applied, by one thread at a time."
  (holder nil t "the thread that owns the home, or NIL" :writable)
  (backlog (make-backlog) backlog :writable)
  (inbox '() t :writable)
  (outbox '() list :writable)
  (on-post #'list function "the function that is called after each post" :writable)
  (attended-p (constantly nil) function "the function that says whether a thread is ready to apply
posts" :writable)
  (left-p nil boolean
          "a thread owns the home, or the last owner left it in the middle of a change" :writable)
  (closed-p nil boolean "the home accepts no changes any more. Can be set" :writable :export)
  (born (next-token) (integer 0)
        "a number that is greater for newer homes. Can be set" :writable :export)
  (repairer #'identity function "the function that repairs the home if it was left in the middle of
a change" :writable)
  (on-change nil (or null function) "the function to call before watchers are notified of a change,
or NIL. Its arguments are :SET or :PULSE, a base fluent and the new value. Can be
set" :writable :export)
  (wrapper nil (or null function) "the function that returns the entry to post instead of a given
entry, or NIL" :writable))

(defvar *runner* nil
  "The plan runner that this thread owns, while its plans run.")

(defvar *default-interface* nil
  "The default owner of plans and fluents, or NIL: see RPL-INIT-ROBOT.")

(defgeneric default-home (interface)
  (:documentation "Code outside of INTERFACE's plans changes a fluent without a home. Return the
home for this change, or NIL.")
  (:method (interface) (declare (ignore interface)) nil))

(defgeneric note-outside-change (interface function fluent value)
  (:documentation "Record that code outside of plans calls FUNCTION with FLUENT and VALUE, while
INTERFACE is in use. FUNCTION is SET-VALUE or PULSE.")
  (:method (interface function fluent value)
    (declare (ignore interface function fluent value))
    (values)))

;;; Taking a home.

(defvar *homes* '()
  "The homes that this thread owns.")

(defun acquire-home (home)
  "Make this thread the owner of HOME. Return true unless another thread owns HOME."
  (swap-if-eq (home-holder home) nil (current-thread)))

(defun release-home (home)
  (swap-if-eq (home-holder home) (current-thread) nil))

(defun call-owning-home (home take function)
  "Take HOME by calling TAKE. If TAKE returns true, call FUNCTION in HOME, leave HOME and return the
values of FUNCTION. Otherwise return NIL. An interrupt may come at any point."
  (declare (type function take function))
  (unwind-protect-strictly
    (when (funcall take home)
      (let* ((homes (cons home *homes*)) (*runner* home) (*homes* homes))
        (declare (dynamic-extent homes))
        (when (home-left-p home) (funcall (home-repairer home) home))
        (setf (home-left-p home) t)
        (multiple-value-prog1 (funcall function)
          (setf (home-left-p home) nil))))
    (release-home home)))

(defun home-busy-p (home)
  "True if a thread owns HOME, or has left HOME in the middle of a change."
  (or (home-left-p home) (home-holder home)))

(defun wait-for-home (home)
  (loop until (acquire-home home) do (yield-thread))
  t)

(defun call-with-owned-home (home function)
  "Call FUNCTION while this thread owns HOME. If another thread owns HOME, wait until HOME is free."
  (declare (type function function))
  (cond ((eq home *runner*) (funcall function))
        ((member home *homes* :test #'eq)
         (let ((*runner* home)) (funcall function)))
        (t (call-owning-home home #'wait-for-home function))))

(defmacro with-owned-home ((home) &body body)
  "Run BODY while this thread owns HOME, as CALL-WITH-OWNED-HOME does."
  `(flet ((body () ,@body))
     (declare (dynamic-extent #'body))
     (call-with-owned-home ,home #'body)))

;;; Posting. Entries may be meant for an agent of the home; see rpl/tasks/agents.lisp. Who applies
;;; entries decides whether those for an agent are due.

(defstruct (entry-for-agent (:constructor make-entry-for-agent (agent entry)) (:copier nil))
  "ENTRY, which is applied only while the tasks of AGENT may run."
  (agent nil :read-only t)
  (entry nil :type (or list function) :read-only t))

(defun post-entry (home entry &optional agent)
  "Append ENTRY, a list of settings or a function, to the entries posted to HOME. If AGENT is given,
an agent of HOME, apply ENTRY only while the tasks of AGENT may run."
  (let* ((wrapper (home-wrapper home))
         (entry (if wrapper (funcall wrapper entry) entry)))
    (atomic-push (if agent (make-entry-for-agent agent entry) entry) (home-inbox home)))
  (funcall (home-on-post home))
  (values))

(defun collect-posts (home)
  "Move the entries in the inbox of HOME to the end of its outbox."
  (loop for entries = (home-inbox home)
        until (swap-if-eq (home-inbox home) entries '())
        finally (setf (home-outbox home) (append (home-outbox home) (reverse entries)))))

(defun take-due-entry (home due-p)
  "Remove the first entry in the outbox of HOME that is due: see TAKE-POSTED-ENTRY."
  (declare (type function due-p))
  (loop for tail on (home-outbox home)
        for before = nil then last
        for last = tail
        for entry = (first tail)
        for agent = (and (entry-for-agent-p entry) (entry-for-agent-agent entry))
        when (funcall due-p agent)
          do (if before
                 (setf (rest before) (rest tail))
                 (setf (home-outbox home) (rest tail)))
             (return (values (if agent (entry-for-agent-entry entry) entry) t agent))
        finally (return (values nil nil nil))))

(defun take-posted-entry (home &optional (due-p (constantly t)))
  "Remove the oldest entry posted to HOME that is due: DUE-P, a function, returns true for its agent
or NIL. Return the entry, true and the agent; or NIL and false if there is none."
  (multiple-value-bind (entry there agent) (take-due-entry home due-p)
    (cond (there (values entry t agent))
          ((home-inbox home)
           (collect-posts home)
           (take-due-entry home due-p))
          (t (values nil nil nil)))))

(defun posted-p (home)
  "True if some entry posted to HOME has not been applied yet."
  (and (or (home-outbox home) (home-inbox home)) t))
