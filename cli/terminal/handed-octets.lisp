;;;; handed-octets.lisp -- an input stream of what another thread hands over.

(in-package :ars-magna.cli)

;;; As a terminal's keys are read from a file, those of a window are read from such a stream: each
;;; character stands for an octet.

(defclass handed-octets (fundamental-character-input-stream)
  ((lock :initform (make-lock "octets") :reader handed-lock)
   (ready :initform (make-semaphore "octets") :reader handed-ready)
   ;; Those not read yet, and whether more may come.
   (octets :initform "" :accessor handed-left)
   (over-p :initform nil :accessor handed-over-p))
  (:documentation "An input stream of the octets given to HAND-OVER; reading waits for them."))

(defun hand-over (stream octets)
  "Let whoever reads STREAM read OCTETS, a string, after what was handed over before; NIL ends it."
  (with-lock ((handed-lock stream))
    (if octets
        (setf (handed-left stream) (uiop:strcat (handed-left stream) octets))
        (setf (handed-over-p stream) t)))
  (signal-semaphore (handed-ready stream))
  (values))

(defun next-handed (stream)
  "Return the next octet of STREAM, :EOF at its end, or NIL if none has come yet."
  (with-lock ((handed-lock stream))
    (let ((left (handed-left stream)))
      (cond ((string/= "" left)
             (setf (handed-left stream) (subseq left 1))
             (char left 0))
            ((handed-over-p stream) :eof)))))

(defmethod stream-read-char-no-hang ((stream handed-octets))
  (next-handed stream))

(defmethod stream-read-char ((stream handed-octets))
  (loop (let ((char (next-handed stream)))
          (when char (return char)))
        (wait-on-semaphore (handed-ready stream))))

(defmethod stream-unread-char ((stream handed-octets) char)
  (with-lock ((handed-lock stream))
    (setf (handed-left stream) (uiop:strcat (string char) (handed-left stream))))
  nil)

(defmethod stream-listen ((stream handed-octets))
  (string/= "" (handed-left stream)))

(defmethod stream-clear-input ((stream handed-octets))
  (with-lock ((handed-lock stream)) (setf (handed-left stream) ""))
  nil)

(defmethod octets-within-p ((stream handed-octets) seconds)
  ;; What has been read already may have left its signals.
  (loop until (or (listen stream) (handed-over-p stream))
        always (wait-on-semaphore (handed-ready stream) seconds)))
