;;;; askers.lisp -- on whose behalf code runs: for people to read, while nothing depends on it.

(in-package :ars-magna.definitions)

(export '(*asker* asker-note asker-forked-p *goes-on-in-forks-p* goes-on-in-forks-p note-of-asker
          note-text))

;;; Who drives a robot from several sides wants to know whose command is under way. So whoever
;;; calls on others' behalf binds *ASKER*: CALL-USER-CODE to what it calls, plans to the task at
;;; work, the prompt to itself; and what is asked for keeps a note of it.

(defvar *asker* nil
  "Who asks for what is asked for here: an origin as CALL-USER-CODE takes it, or what has a method
of ASKER-NOTE; NIL for a program of its own, or somebody at a REPL.")

(defgeneric asker-note (asker)
  (:documentation "Return what is to be kept of ASKER: a string, or a list of items as OUT prints
them. It does not change, whatever becomes of ASKER.")
  (:method (asker) (princ-to-string asker))
  (:method ((asker string)) asker)
  (:method ((asker cons)) (mapcar (lambda (item) (if (atom item) (asker-note item) item)) asker))
  (:method ((asker symbol)) asker)
  (:method ((asker null)) (list "Lisp (" (thread-name (current-thread)) ")")))

(defgeneric asker-forked-p (asker)
  (:documentation "True if ASKER goes on in forks of the run too, such as a plan, and so is told of
the ends of its commands there.")
  (:method (asker) (declare (ignore asker)) nil))

(defvar *goes-on-in-forks-p* nil
  "True where something acts that goes on in forks of the run too, whoever the asker is.")

(defun goes-on-in-forks-p ()
  "True if what is asked for here and now is asked for in forks of the run as well, by themselves."
  (or *goes-on-in-forks-p* (asker-forked-p *asker*)))

(defun note-of-asker ()
  "Return a note of who asks here and now."
  (asker-note *asker*))

(defun note-text (note)
  "Return NOTE, as NOTE-OF-ASKER returns it, as a string."
  (with-output-to-string (stream) (write-items (ensure-list note) stream)))
