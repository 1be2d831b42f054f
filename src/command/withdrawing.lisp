;;;; withdrawing.lisp -- interrupt a command that you issued, if it is still in progress.

(in-package :ars-magna.command)

(export '(withdraw-command withdrawal))

;;; GRAB-RESOURCE interrupts any command on a resource. To end only a command of its own, a program
;;; withdraws that; its continuation identifies it. The journal records what was interrupted: a
;;; command, a track, or nothing.

(define-kind (withdrawal :include request
                         :constructor (make-withdrawal (continuation arguments
                                                        &aux (operator 'withdraw-command))))
    "A request to interrupt a command still in progress. The first argument is its resource."
  (:fixed
   (continuation nil t "the command's continuation; NIL if the second argument says where the
command is: :COMMAND, :TRACK or NIL" :export)))

(defun track-operation-of (resource)
  (let ((track (and (camera-p resource) (camera-tracking resource))))
    (and track (operation-p (track-operation track)) (track-operation track))))

(defun has-continuation-p (operation continuation)
  (and (operation-p operation)
       (eq continuation (operation-continuation operation))))

(defun withdrawn-command-kind (withdrawal)
  "Return :COMMAND if the command of WITHDRAWAL occupies its resource, :TRACK if the command is a
camera's track, or NIL if the command is not in progress."
  (destructuring-bind (resource &optional place) (request-arguments withdrawal)
    (let ((continuation (withdrawal-continuation withdrawal)))
      (cond ((null continuation) place)
            ((has-continuation-p (resource-event resource) continuation) :command)
            ((has-continuation-p (track-operation-of resource) continuation) :track)))))

;; Called right before it is performed.
(defmethod request-journal-entry ((withdrawal withdrawal))
  (list 'withdraw-command
        (first (request-arguments withdrawal))
        (withdrawn-command-kind withdrawal)))

(defmethod perform ((withdrawal withdrawal) timeline)
  (let* ((resource (first (request-arguments withdrawal)))
         (agenda (timeline-agenda timeline))
         (tick (1+ (agenda-tick agenda))))
    (ecase (withdrawn-command-kind withdrawal)
      (:command (let ((event (resource-event resource)))
                  (note-interruption event withdrawal tick)
                  (interrupt-event agenda event)))
      (:track (note-interruption (track-operation-of resource) withdrawal tick)
       (end-track resource :interrupt))
      ((nil)))))

(defun withdraw-command (resource continuation)
  "At the start of the next tick, interrupt the command of RESOURCE that has CONTINUATION, if it is
in progress then. A track in the background is in progress, too. Returns nothing."
  (post (make-withdrawal continuation (list resource)) resource))

;; The result of a withdrawal, in a replayed run.
(define-operator 'withdraw-command '(datum datum)
  (lambda (resource place) (post (make-withdrawal nil (list resource place)) resource)))
