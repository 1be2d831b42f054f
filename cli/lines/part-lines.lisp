;;;; part-lines.lisp -- BINS, CAMERAS and HANDS.

(in-package :ars-magna.cli)

;;; The layouts are those of the session in manual E.

(defun write-parts (heading writer reader)
  "Write HEADING, and by WRITER each part of the robot that READER returns."
  (let ((robot (session-robot)))
    (still
      (format t "~A~%-----~%" heading)
      (map nil writer (funcall reader robot)))))

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
  (write-parts "BIN STATUS TOTAL-CAP CURRENT-CAP CONTENTS" #'write-bin #'robot-bins))

(defun write-camera (camera)
  (put-line "~4A ~,2F ~3A~6,2F ~@[~A ~]~@[Tracking ~A~]"
              (camera-index camera)
              (camera-field-of-view camera)
              (camera-resolution camera)
              (hundredths (camera-angle camera))
              (location-text camera)
              (when (camera-tracks camera)
                (let ((designator (designator-status (camera-tracks camera))))
                  (format nil "~A designator @ ~A" (kind-text designator)
                          (bearing-text designator))))))

(define-line "CAMERAS" (session)
    (:seeing)
    "List the cameras: field of view, resolution, angle, location, what they track."
  (write-parts "CAMERA FIELD RES ANGLE" #'write-camera #'robot-cameras))

(defun write-hand (hand)
  (put-line "~6A ~7A ~14A ~@[~A~]"
              (hand-index hand)
              (amount-text (hand-strength hand))
              (or (hand-holding hand) "")
              (location-text hand)))

(define-line "HANDS" (session)
    (:seeing)
    "List the hands: strength, what they hold, location."
  (write-parts "HAND STRENGTH GRASPING" #'write-hand #'robot-hands))
