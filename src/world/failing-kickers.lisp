;;;; failing-kickers.lisp -- what can be done about a kicker that fails again and again.

(in-package :ars-magna.world)

(defun where-to-mend (attachment)
  "Return in words where the code of the kicker ATTACHMENT is to be mended."
  (let* ((kicker (attachment-kicker attachment))
         (file (function-file (kicker-body kicker))))
    (cond (file (format nil "in ~A, and load that again" file))
          ((eq kicker (find-kicker (kicker-name kicker) nil)) "by DEFKICKER")
          (t "by PUT-KICKER"))))

(defmethod recurring-code ((attachment attachment))
  (kicker-body (attachment-kicker attachment)))

(defmethod recurring-remedy ((attachment attachment))
  (let ((name (attachment-name attachment)))
    (format nil "Mend the kicker ~A ~A; or take it off: ~
                 (put-kicker ~(~A~) (thing (find-thing \"~A\")))."
            name (where-to-mend attachment) name (attachment-thing attachment))))

;; An origin that has nobody to blame is of a group that was read ahead.
(defmethod recurring-code ((origin origin))
  (recurring-code (origin-attachment origin)))

(defmethod recurring-remedy ((origin origin))
  (recurring-remedy (origin-attachment origin)))
