;;;; handed-octets.lisp -- an input stream of what another thread hands over.

(in-package :ars-magna.cli)

;;; As a terminal's keys are read from a file, those of a window are read from such a stream: each
;;; character stands for an octet.

(defclass handed-octets (fundamental-character-input-stream)
  ((lock :initform (make-lock "octets") :reader handed-lock)
   (ready :initform (make-semaphore "octets") :reader handed-ready)
   ;; Those handed over last, how many of them have been read, and whether more may come.
   (octets :initform "" :accessor handed-string)
   (start :initform 0 :accessor handed-start)
   (over-p :initform nil :accessor handed-over-p))
  (:documentation "An input stream of the octets that REVISE-OCTETS leaves; it waits for them."))

(defun handed-left (stream)
  (subseq (handed-string stream) (handed-start stream)))

(defun leave-octets (stream octets)
  "Let OCTETS, a string, be all that is left to be read of STREAM, whose lock is held."
  (setf (handed-string stream) octets
        (handed-start stream) 0))

(defun revise-octets (stream function)
  "Let what FUNCTION makes of the octets that are left of STREAM, a string, take their place. Nobody
reads any meanwhile."
  (with-lock ((handed-lock stream))
    (leave-octets stream (funcall function (handed-left stream))))
  (signal-semaphore (handed-ready stream))
  (values))

(defun end-octets (stream)
  (with-lock ((handed-lock stream)) (setf (handed-over-p stream) t))
  (signal-semaphore (handed-ready stream))
  (values))

(defun next-handed (stream)
  "Return the next octet of STREAM, :EOF at its end, or NIL if none has come yet."
  (with-lock ((handed-lock stream))
    (cond ((listen stream) (prog1 (char (handed-string stream) (handed-start stream))
                             (incf (handed-start stream))))
          ((handed-over-p stream) :eof))))

(defmethod stream-read-char-no-hang ((stream handed-octets))
  (next-handed stream))

(defmethod stream-read-char ((stream handed-octets))
  (loop (let ((char (next-handed stream)))
          (when char (return char)))
        (wait-on-semaphore (handed-ready stream))))

(defmethod stream-unread-char ((stream handed-octets) char)
  (with-lock ((handed-lock stream))
    (leave-octets stream (uiop:strcat (string char) (handed-left stream))))
  nil)

(defmethod stream-listen ((stream handed-octets))
  (< (handed-start stream) (length (handed-string stream))))

(defmethod stream-clear-input ((stream handed-octets))
  (with-lock ((handed-lock stream)) (leave-octets stream ""))
  nil)

(defmethod octets-within-p ((stream handed-octets) seconds)
  ;; What has been read already may have left its signals.
  (loop until (or (listen stream) (handed-over-p stream))
        always (wait-on-semaphore (handed-ready stream) seconds)))
