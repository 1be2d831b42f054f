;;;; part-lines.lisp -- BINS, CAMERAS and HANDS.

(in-package :ars-magna.cli)

;;; The layouts are those of the session in manual E.

;; As reading 203 says.
(defun write-bin (bin)
  (put-line "~2D ~9A ~7A ~4,1F  ~{~A~^ ~}"
              (format nil "~2A" (storage-bin-index bin))
              (if (storage-bin-closed-p bin) "Closed" "Open")
              (amount-text (storage-bin-capacity bin))
              (remaining-capacity bin)
              (storage-bin-contents bin)))

(define-line "BINS" (session)
    (:seeing)
    "List the storage bins: open or closed, total and current capacity, contents."
  (let ((robot (session-robot)))
    (still
      (format t "BIN STATUS TOTAL-CAP CURRENT-CAP CONTENTS~%-----~%")
      (map nil #'write-bin (robot-bins robot)))))

(defun tracked-text (camera)
  "Return what CAMERA tracks, in words, or NIL."
  (when (camera-tracks camera)
    (let ((designator (designator-status (camera-tracks camera))))
      (format nil "~A designator @ ~A" (kind-text designator) (bearing-text designator)))))

(defun write-camera (camera)
  (put-line "~4A ~,2F ~3A~6,2F ~@[~A ~]~@[Tracking ~A~]"
              (camera-index camera)
              (camera-field-of-view camera)
              (camera-resolution camera)
              (hundredths (camera-angle camera))
              (location-text camera)
              (tracked-text camera)))

(define-line "CAMERAS" (session)
    (:seeing)
    "List the cameras: field of view, resolution, angle, location, what they track."
  (let ((robot (session-robot)))
    (still
      (format t "CAMERA FIELD RES ANGLE~%-----~%")
      (map nil #'write-camera (robot-cameras robot)))))

(defun write-hand (hand)
  (put-line "~6A ~7A ~14A ~@[~A~]"
              (hand-index hand)
              (amount-text (hand-strength hand))
              (or (hand-holding hand) "")
              (location-text hand)))

(define-line "HANDS" (session)
    (:seeing)
    "List the hands: strength, what they hold, location."
  (let ((robot (session-robot)))
    (still
      (format t "HAND STRENGTH GRASPING~%-----~%")
      (map nil #'write-hand (robot-hands robot)))))
