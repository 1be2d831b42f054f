;;;; home.lisp -- where fluents are heard: in one thread at a time, to which all others post.

(in-package :ars-magna.rpl.fluents)

(export '(*runner* *interface* home-in-use note-outside-change home home-closed-p home-born
          home-on-change at-home call-at-home in-use-p post next-entry posted-p))

;;; A fluent that somebody waits for has a home, the plan runner of those who wait. One thread at a
;;; time has a home; what others want to change meanwhile they post, and it is heard in the order of
;;; posting. The newest entry of the inbox comes first, the oldest of the outbox.

(defstruct (backlog (:constructor make-backlog ()) (:copier nil))
  "Derived fluents to be computed, by height: those of each height in order of arrival."
  (heads (make-array 8 :initial-element nil) :type simple-vector)
  (tails (make-array 8 :initial-element nil) :type simple-vector)
  (highest 0 :type fixnum))

(defstruct (home (:constructor make-home ()) (:copier nil))
  "Where changes are heard. HOLDER is the thread that has it, ON-POST is called after each post.
ATTENDED-P says whether a thread is there that will hear what is posted. LEFT-P is true while a
thread has it, and afterwards if that has left it in the middle of something: then REPAIRER is
called with it before anything else is done. CLOSED-P says that it hears nothing any more. BORN is a
token, given when it was made.
For whoever keeps a trace, ON-CHANGE is called with
:SET or :PULSE, a base fluent and its value, before anybody hears of that, and WRAPPER with each
entry: it returns what is posted instead."
  (holder nil :type t)
  (backlog (make-backlog) :type backlog :read-only t)
  (inbox '() :type t)
  (outbox '() :type list)
  (on-post #'list :type function)
  (attended-p (constantly nil) :type function)
  (left-p nil :type boolean)
  (closed-p nil :type boolean)
  (born (next-token) :type (integer 0))
  (repairer #'identity :type function)
  (on-change nil :type (or null function))
  (wrapper nil :type (or null function)))

(defvar *runner* nil
  "The plan runner that this thread has, while plans run.")

(defvar *interface* nil
  "What plans and fluents belong to where nothing else says so, or NIL: see RPL-INIT-ROBOT.")

(defgeneric home-in-use (interface)
  (:documentation "Return the home of fluents that have none yet, where no plan is at work and
INTERFACE is in use; or NIL.")
  (:method (interface) (declare (ignore interface)) nil))

(defgeneric note-outside-change (interface function fluent value)
  (:documentation "Note what changes FLUENT where no plan is at work and INTERFACE is in use: that
FUNCTION, of SET-VALUE and PULSE, is called with FLUENT and VALUE.")
  (:method (interface function fluent value)
    (declare (ignore interface function fluent value))
    (values)))

;;; Having it.

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
  "Let ENTRY, a list of settings or a function, be next in HOME after all that was posted before."
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
  "True if something posted to HOME has not been heard yet."
  (and (or (home-outbox home) (home-inbox home)) t))

(document-functions
  home-born "Return a number that is greater for homes that were made later. Can be set."
  home-closed-p "True if the home hears nothing any more. Can be set."
  home-on-change "Return the function that is told of changes, or NIL. Can be set.")
