;;;; home.lisp -- the home of a fluent: the one thread at a time that applies its changes.

(in-package :ars-magna.rpl.fluents)

(export '(*runner* *interface* home-in-use note-outside-change home at-home call-at-home in-use-p
          post next-entry posted-p))

;;; A fluent that a task waits for has a home, the plan runner of that task. One thread at a time
;;; works in a home. Other threads post their changes, which are applied in the order of posting.
;;; The newest entry of the inbox comes first, the oldest of the outbox.

(defstruct (backlog (:constructor make-backlog ()) (:copier nil))
  "Derived fluents to be computed, by height: those of each height in order of arrival."
  (heads (make-array 8 :initial-element nil) :type simple-vector)
  (tails (make-array 8 :initial-element nil) :type simple-vector)
  (highest 0 :type fixnum))

(define-record (home (:constructor make-home ()))
  "Where changes of fluents are applied, by one thread at a time."
  (holder nil t "the thread that has it, or NIL" :writable)
  (backlog (make-backlog) backlog :writable)
  (inbox '() t :writable)
  (outbox '() list :writable)
  (on-post #'list function "the function that is called after each post" :writable)
  (attended-p (constantly nil) function "says whether a thread is there to apply posts" :writable)
  (left-p nil boolean
          "a thread has it, or the last one left it in the middle of something" :writable)
  (closed-p nil boolean "the home accepts no changes any more. Can be set" :writable :export)
  (born (next-token) (integer 0)
        "a number that is greater for homes that were made later. Can be set" :writable :export)
  (repairer #'identity function "the function called first with the home in that case" :writable)
  (on-change nil (or null function) "the function that is called before watchers are notified of
a change, or NIL: with :SET or :PULSE, a base fluent and its value. Can be set" :writable :export)
  (wrapper nil (or null function) "returns what to post instead of an entry; or NIL" :writable))

(defvar *runner* nil
  "The plan runner that this thread has, while plans run.")

(defvar *interface* nil
  "The default owner of plans and fluents, or NIL: see RPL-INIT-ROBOT.")

(defgeneric home-in-use (interface)
  (:documentation "Return the home of fluents without one, outside of plans of INTERFACE; or NIL.")
  (:method (interface) (declare (ignore interface)) nil))

(defgeneric note-outside-change (interface function fluent value)
  (:documentation "Note what changes FLUENT where no plan is at work and INTERFACE is in use: that
FUNCTION, of SET-VALUE and PULSE, is called with FLUENT and VALUE.")
  (:method (interface function fluent value)
    (declare (ignore interface function fluent value))
    (values)))

;;; Taking a home.

(defvar *homes* '()
  "The homes that this thread has.")

(defun take-home (home)
  "Let this thread have HOME. True unless another one has it."
  (swap-if (home-holder home) nil (current-thread)))

(defun leave-home (home)
  (swap-if (home-holder home) (current-thread) nil))

(defun call-having (home take function)
  "Call FUNCTION in HOME, and leave that, if TAKE, called with it, returns true. Return the values,
or else NIL. An interrupt may come at any point."
  (declare (type function take function))
  (protecting-strictly
    (when (funcall take home)
      (let* ((homes (cons home *homes*)) (*runner* home) (*homes* homes))
        (declare (dynamic-extent homes))
        (when (home-left-p home) (funcall (home-repairer home) home))
        (setf (home-left-p home) t)
        (multiple-value-prog1 (funcall function)
          (setf (home-left-p home) nil))))
    (leave-home home)))

(defun in-use-p (home)
  "True if a thread has HOME, or has left it in the middle of something."
  (or (home-left-p home) (home-holder home)))

(defun wait-for-home (home)
  (loop until (take-home home) do (yield-thread))
  t)

(defun call-at-home (home function)
  "Call FUNCTION while this thread has HOME. If another one has it wait until it is free."
  (declare (type function function))
  (cond ((eq home *runner*) (funcall function))
        ((member home *homes* :test #'eq)
         (let ((*runner* home)) (funcall function)))
        (t (call-having home #'wait-for-home function))))

(defmacro at-home ((home) &body body)
  "Run BODY as CALL-AT-HOME would a function."
  `(flet ((body () ,@body))
     (declare (dynamic-extent #'body))
     (call-at-home ,home #'body)))

;;; Posting.

(defun post (home entry)
  "Append ENTRY, a list of settings or a function, to what is posted to HOME."
  (let ((wrapper (home-wrapper home)))
    (atomic-push (if wrapper (funcall wrapper entry) entry) (home-inbox home)))
  (funcall (home-on-post home))
  (values))

(defun next-entry (home)
  "Return the oldest entry posted to HOME, removed, and true; or NIL and false."
  (unless (home-outbox home)
    (loop for entries = (home-inbox home)
          until (swap-if (home-inbox home) entries '())
          finally (setf (home-outbox home) (reverse entries))))
  (if (home-outbox home)
      (values (pop (home-outbox home)) t)
      (values nil nil)))

(defun posted-p (home)
  "True if something posted to HOME has not been applied yet."
  (and (or (home-outbox home) (home-inbox home)) t))
