;;;; looking.lisp -- views, and what all commands of cameras say (manual 3.4.3).

(in-package :ars-magna.command)

;;; A search only needs a camera that does not track. A track goes on in the background of views
;;; and insertions; whatever else turns the camera interrupts it.

(defun already-tracking-text (operation)
  (let ((camera (operation-resource operation)))
    (format nil "~A is already tracking~@[ ~A~]" camera (camera-tracks camera))))

(define-command camera-view (operation (camera camera))
    ((view "a list of numbers, one for each pixel from left to right"))
    ((:family :looking) (:section "3.4.3") (:traits :asks)
     (:report (view) (format nil "~A sees ~{~,2F~^ ~}" (operation-resource operation) view)))
    "Take a view with CAMERA."
  (succeed operation (take-view camera)))
