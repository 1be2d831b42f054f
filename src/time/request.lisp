;;;; request.lisp -- something asked of a run, as data, and how it is carried out.

(in-package :ars-magna.time)

(export '(request request-entry perform resource note-asked phase-number changing-phase-p
          telling-phase-p))

;;; A request has the name of an operator and its arguments. It waits in a timeline (see
;;; timeline.lisp) until a tick begins, and is then performed, in the order of asking. Layers above
;;; include the structure, add slots and methods.

(define-kind (request :constructor (make-request (operator arguments)))
    "Something asked of a run."
  (:fixed
   (operator nil t "what is asked for: an operator's name, or what has one" :export)
   (arguments '() list "what it is asked for with" :export)
   (forked-p (goes-on-in-forks-p) boolean
             "true if the asker is copied to forks of the run" :export)
   (phase 0 fixnum "the phase of the tick in which it was asked for, 0 between ticks" :export))
  (:memory
   (asker nil t "a note of who asked for it" :export)))

(defgeneric perform (request timeline)
  (:documentation
   "Carry REQUEST out, at the start of a tick of TIMELINE, or when that ends for good. Called by
the owner."))

(defgeneric request-entry (request)
  (:documentation "Return what a journal notes of REQUEST: a list (operator argument ...).")
  (:method ((request request))
    (cons (request-operator request) (request-arguments request))))

(defmethod digest-state :after ((request request) digest)
  (digest-add digest (request-entry request)))

;;; Resources: parts that do one thing at a time (manual 3.1.2).

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

;;; Phases are counted from 1; 0 is between ticks. The run's tick defines what happens in each. In
;;; phases that change the world, a fork repeats by itself whatever user code does there.

(define-constant +phases+
    '(:requests :events :kickers :settling :continuations :observers :participants :keeping)
  :test #'equal
  :documentation "The names of the phases of a tick, in order.")

(defmacro phase-number (name)
  "Return the number of the phase of a tick that is called NAME, a keyword, not evaluated."
  (1+ (or (position name +phases+)
          (reject-name "phase" name +phases+))))

(defun changing-phase-p (phase)
  "True if the world changes in the phase with the number PHASE."
  (<= (phase-number :requests) phase (phase-number :settling)))

(defun telling-phase-p (phase)
  "True if the phase with the number PHASE comes after the world has changed."
  (<= (phase-number :continuations) phase))
