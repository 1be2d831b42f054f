;;;; tracks.lisp -- cameras that follow what they have seen, and how they lose it (manual 3.4.3).

(in-package :ars-magna.robot)

(export '(tracking-p end-track drop-designator track notify-track-end notify-track-match
          approaching-p))

;;; A track runs in the background of a camera's commands: the camera keeps pointing at its
;;; designator's denotation. Tracks are updated once a tick, after events and kickers. A track may
;;; end at any moment of a tick. Its continuation is called later, in the tracks phase, after the
;;; command that ended it has reported its own end; only an interruption is reported at once.
;;;
;;; A tracked designator becomes invalid when its last track is lost. An untracked one becomes
;;; invalid when its denotation moves, unless a hand grasps it or sets it down; a local one also
;;; when its denotation is out of reach.

;; See reading 82.
(define-kind (track :constructor (make-track (designator operation)))
    "The state of a camera that tracks a designator."
  (:state
   (designator nil (or null designator) "what is tracked")
   (operation nil t "the operation for NOTIFY-TRACK-END when the track ends, or NIL" :export)))

(defgeneric notify-track-end (operation code designator)
  (:documentation "Report to OPERATION that its track of DESIGNATOR has ended with CODE."))

(defgeneric notify-track-match (operation designator)
  (:documentation "Report to OPERATION that its track has matched DESIGNATOR anew."))

(defgeneric match-track (track camera dice)
  (:documentation "CAMERA has followed TRACK in this tick. If TRACK is to be matched now, match it,
with errors drawn from DICE (see track-matching.lisp).")
  (:method (track camera dice)
    (declare (ignore track camera dice))
    nil))

(defgeneric approaching-p (event camera)
  (:documentation "EVENT is pending on a robot. True if it moves the robot to what CAMERA tracks.")
  (:method (event camera)
    (declare (ignore event camera))
    nil))

(addition camera-tracks)
(defun camera-tracks (camera)
  "Return the designator that CAMERA tracks, or NIL."
  (let ((track (camera-tracking camera)))
    (and track (track-designator track))))

(defun tracking-p (camera designator)
  "True if CAMERA tracks DESIGNATOR."
  (eq (camera-tracks camera) designator))

(addition tracking-cameras)
(defun tracking-cameras (designator)
  "Return a list of the cameras that track DESIGNATOR, sorted by index."
  (loop for camera across (robot-cameras (designator-robot designator))
        when (tracking-p camera designator)
          collect camera))

(defun tracked-p (designator)
  (loop for camera across (robot-cameras (designator-robot designator))
          thereis (tracking-p camera designator)))

(defun camera-guides-approach-p (camera)
  (let ((event (resource-event (camera-robot camera))))
    (and event (approaching-p event camera))))

;;; Ending.

(defun report-track-end (track code)
  (when (track-operation track)
    (notify-track-end (track-operation track) code (track-designator track))))

(defun track-asker (track)
  (let ((operation (track-operation track)))
    (and (typep operation 'request) (request-asker operation))))

(defun end-track-keeping-designator (camera code warning)
  "End the track of CAMERA, but keep the designator valid. Return the designator, or NIL if CAMERA
had no track. See reading 161."
  (let ((track (camera-tracking camera)))
    (when track
      (setf (camera-tracking camera) nil)
      (when warning
        (let ((*request-origin* (track-asker track))
              (*reported-robot* (robot-name (camera-robot camera))))
          (warning-set warning)))
      (if (eq code :interrupt)
          (report-track-end track code)
          (let ((robot (camera-robot camera)))
            (mark-world-unsettled robot)
            (push (cons track code) (robot-ended-tracks robot))))
      (track-designator track))))

(defun drop-designator (designator &key silently)
  "Make DESIGNATOR invalid, free its number and end its tracks. Queue warnings unless SILENTLY."
  (when (designator-valid-p designator)
    (unless silently
      (let ((*reported-robot* (robot-name (designator-robot designator)))
            (*request-origin* (or (designator-origin designator) *request-origin*)))
        (warning-set (format nil "Removing ~A" designator))))
    (dolist (camera (tracking-cameras designator))
      (end-track-keeping-designator camera :lost-track
                                    (unless silently
                                      (format nil "~A no longer valid. ~A lost track" designator
                                              camera))))
    (release-number designator)))

(defun end-track (camera code &optional warning)
  "End the track of CAMERA, if it has one, with the error CODE, and queue WARNING, a string. If the
track is lost and no other camera tracks the designator, drop the designator."
  (let* ((track (camera-tracking camera))
         (designator (end-track-keeping-designator camera code warning)))
    (when (and designator (not (eq code :interrupt)) (not (tracked-p designator)))
      (let ((*request-origin* (track-asker track))
            (*reported-robot* (robot-name (camera-robot camera))))
        (drop-designator designator)))))

(defun lose-track (camera &optional reason)
  "End the track of CAMERA with :LOST-TRACK and a warning, which gives REASON, a string, if any."
  (end-track camera :lost-track
             (format nil "~A lost track of ~A~@[: ~A~]" camera (camera-tracks camera) reason)))

(defmethod interrupt-resource ((camera camera) timeline)
  (declare (ignore timeline))
  (call-next-method)
  (end-track camera :interrupt))

;;; When things and parts move.

(defun watch-thing (thing old-location new-location)
  "Update the robots' designators after THING has moved. A move watcher of a world."
  (let ((by-hand (or (hand-p old-location) (hand-p new-location))))
    (dolist (robot (robots-in-order (thing-world thing)))
      (when (plusp (length (robot-designators robot)))
        (dolist (designator (designators-of-thing robot thing))
          (unless (and new-location (valid-after-move-p designator by-hand))
            (drop-designator designator)))))))

(note-savable-function 'watch-thing)

(defun valid-after-move-p (designator by-hand)
  "True if DESIGNATOR stays valid although its denotation has moved. A tracked designator stays
valid if the camera can follow the thing. An untracked designator stays valid if a hand grasped the
thing or set it down (BY-HAND), and the thing was and is local (reading 139)."
  (if (tracked-p designator)
      (eq (denotation-enclosure designator) (designator-location designator))
      (and by-hand
           (eq (designator-type designator) :local)
           (designator-truly-local-p designator))))

(defun update-after-part-move (part old-location)
  "Update tracks and designators after PART, a camera or hand, has moved from OLD-LOCATION to
PART-LOCATION: a camera loses its track, and what a hand holds has moved. Warnings are queued."
  (unless (eq old-location (part-location part))
    (etypecase part
      (camera
       (when (camera-tracking part)
         (end-track part :lost-track (format nil "~A moved. No longer tracking ~A"
                                             part (camera-tracks part)))))
      (hand
       (dolist (thing (hand-contents part))
         (warning-set (format nil "~A has moved" thing))
         (watch-thing thing part part))))))
