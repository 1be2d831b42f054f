;;;; resource.lisp -- a part that does one thing at a time (manual 3.1.2).

(in-package :ars-magna.time)

(export '(resource note-asked))

(define-kind (resource :constructor nil)
    "What commands and events compete for: a robot or one of its parts. Anything else may serve as
a resource of SCHEDULE too; these carry their pending event themselves, which is faster."
  (:state
   (event nil t "the event or command that is pending on the resource, or NIL" :export))
  (:memory
   (interruption nil t "what was interrupted last on the resource, or NIL" :export)
   (asked 0 atomic-count "how often the resource was asked for: whoever gives it one command after
the other can tell by that whether somebody else came between" :export)))

(defun note-asked (resource)
  "Note that RESOURCE is asked for, if it is one that can tell."
  (when (resource-p resource) (atomic-incf (resource-asked resource))))
