;;;; request.lisp -- requests to a run, as data, and how they are performed.

(in-package :ars-magna.time)

(export '(request request-journal-entry perform resource count-request phase-number changing-phase-p
          notifying-phase-p))

;;; A request is the name of an operator and its arguments. It waits in a timeline (timeline.lisp)
;;; until the next tick begins. Requests are performed in the order in which they were made. Layers
;;; above include the structure, and add slots and methods.

(define-kind (request :constructor (make-request (operator arguments)))
    "A request to a run to perform an operator."
  (:fixed
   (operator nil t "the requested operator: its name, or an object that has one" :export)
   (arguments '() list "the arguments of the operator" :export)
   (forked-p (continues-in-forks-p) boolean
             "true if forks of the run contain a copy of the plan or code that made the request"
             :export)
   (phase 0 fixnum "the phase of the tick in which the request was made, 0 between ticks" :export))
  (:memory
   (asker nil t "the origin of the request, for messages" :export)))

(defgeneric perform (request timeline)
  (:documentation
   "Perform REQUEST in the thread of its world, when a tick of TIMELINE begins or the run ends."))

(defgeneric request-journal-entry (request)
  (:documentation "Return the journal entry of REQUEST: a list (operator argument ...).")
  (:method ((request request))
    (cons (request-operator request) (request-arguments request))))

(defmethod digest-state :after ((request request) digest)
  (digest-add digest (request-journal-entry request)))

;;; Resources: parts that do one thing at a time (manual 3.1.2).

(define-kind (resource :constructor nil)
    "A robot or one of its parts, for which commands and events compete. SCHEDULE accepts any object
as a resource; structures of this type are faster, because they contain their pending event."
  (:state
   (event nil t "the event or command that is pending on the resource, or NIL" :export))
  (:memory
   (interruption nil t "the record of the last interruption on the resource, or NIL" :export)
   (asked 0 atomic-count "the number of requests for the resource so far. A program that issues a
sequence of commands can detect that others made requests in between" :export)))

(defun count-request (resource)
  "Add one to the number of requests for RESOURCE, if RESOURCE is a structure of the type RESOURCE."
  (when (resource-p resource) (atomic-incf (resource-asked resource))))

;;; Phases are counted from 1; 0 is between ticks. The run's tick defines what happens in each. User
;;; code that runs while the world changes runs again in forks, so these repeat what it does.

(define-constant +phases+
    '(:requests :events :kickers :settling :continuations :observers :participants :keeping)
  :test #'equal
  :documentation "The names of the phases of a tick, in order.")

(defmacro phase-number (name)
  "Return the number of the phase NAME of a tick. NAME is a keyword and is not evaluated."
  (1+ (or (position name +phases+)
          (reject-name "phase" name +phases+))))

(defun changing-phase-p (phase)
  "True if the world changes in the phase with the number PHASE."
  (<= (phase-number :requests) phase (phase-number :settling)))

(defun notifying-phase-p (phase)
  "True if the phase with the number PHASE comes after the world has changed."
  (<= (phase-number :continuations) phase))
