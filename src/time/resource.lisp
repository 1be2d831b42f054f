;;;; resource.lisp -- a part that does one thing at a time (manual 3.1.2).

(in-package :ars-magna.time)

(defstruct (resource (:constructor nil) (:copier nil))
  "What commands and events compete for: a robot or one of its parts. Anything else may serve as
a resource of SCHEDULE too; these carry their pending event themselves, which is faster."
  (event nil))
(setf (documentation 'resource-event 'function)
      "Return the event or operation pending on the resource, or NIL.")
