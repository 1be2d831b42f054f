;;;; tracking.lisp -- following what was designated (manual 3.4.3).

(in-package :ars-magna.command)

;;; CAMERA-TRACK tells its continuation twice: with NIL when the track begins, and with a code when
;;; it ends. If it cannot begin, it tells once.

(defun track-obstacle (camera designator)
  "Return the error code that keeps CAMERA from tracking DESIGNATOR, or NIL."
  (let ((local (eq (designator-type designator) :local)))
    (cond ((camera-tracking camera) :already-tracking)
          ((and local (not (local-to-camera-p camera designator))) :local-not-local)
          ((and (not local) (camera-location camera)) :camera-inside)
          ((not (own-designator-p camera designator)) :lost-track)
          ((if local (out-of-sight-p designator camera) (not (trackable-p designator camera)))
           :lost-track))))

(defun local-to-camera-p (camera designator)
  "True if what the local DESIGNATOR denotes is where CAMERA is, and next to the
robot (reading 140)."
  (and (own-designator-p camera designator)
       (eq (designator-location designator) (camera-location camera))
       (designator-local-p* designator)))

;; Warnings have said why, unless it was interrupted.
(defmethod track-ended ((operation operation) code designator)
  (setf (operation-finished-p operation) t)
  (if (eq code :interrupt)
      (report operation code '())
      (note-failed operation code (error-text operation code)))
  (notify operation code (list designator)))

(defun interrupt-track (operation camera)
  "End the track of CAMERA, if it has one, for OPERATION, which is at work."
  (let ((track (camera-tracking camera)))
    (when (and track (track-operation track))
      (note-interruption (track-operation track) operation
                         (timeline-tick (operation-timeline operation))))
    (end-track camera :interrupt)))

;; As reading 83 says.
(defun begin-track (operation camera designator)
  (report operation nil (list designator))
  (notify operation nil (list designator))
  (start-track camera designator operation))

;; As reading 5 says.
(define-command camera-track (operation (camera camera)
                              (designator designator "what to track"))
    ((designator "the designator"))
    ((:family :looking) (:section "3.4.3") (:delay camera-desig-delay*) (:echo designator)
     (:traits :begins)
     (:errors (:already-tracking #'already-tracking-text)
              (:local-not-local (text-of "~*~A is not local any more"))
              (:camera-inside (text-of "~A is inside a container and cannot track ~A"))
              (:lost-track (text-of "~A lost track of ~A")))
     (:report (designator)
              (format nil "~A tracking ~A" (operation-resource operation) designator)))
    "Turn CAMERA to what DESIGNATOR denotes and keep it so. The continuation is called when the
track begins, with NIL, and again when it ends, with the error code that says how."
  (let ((obstacle (track-obstacle camera designator)))
    (if obstacle
        (fail-with operation obstacle designator)
        (begin-track operation camera designator))))

;; As reading 84 says.
(define-command camera-untrack (operation (camera camera))
    ()
    ((:family :looking) (:section "3.4.3") (:traits :stops) (:expected :not-tracking)
     (:errors (:not-tracking (text-of "~A is not tracking anything")))
     (:report () (format nil "~A stopped tracking" (operation-resource operation))))
    "Stop CAMERA from tracking. The designator remains; the track's continuation gets :INTERRUPT."
  (cond ((camera-tracking camera)
         (interrupt-track operation camera)
         (succeed operation))
        (t (fail-with operation :not-tracking))))
