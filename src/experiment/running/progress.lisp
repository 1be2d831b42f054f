;;;; progress.lisp -- saying how far an experiment has come.

(in-package :ars-magna.experiment)

(export '(trial-under-way))

;;; On a terminal there is one line that changes; elsewhere a line now and then.

(defun moment ()
  "Return this moment, for SECONDS-SINCE."
  (real-microseconds))

(defun seconds-since (moment)
  (/ (- (moment) moment) 1d6))

(defstruct (progress (:constructor make-progress
                               (stream terminal-p total workers
                                &aux (under-way (make-array (1+ workers) :initial-element nil))))
                     (:copier nil))
  "How far an experiment has come, of TOTAL trials, and who is told so."
  (stream nil :read-only t)
  (terminal-p nil :read-only t)
  (total 0 :type integer)
  (done 0 :type atomic-count)
  ;; By worker: what it is at, a list (condition trial moment seed), or NIL.
  (under-way #() :type simple-vector :read-only t)
  (begun (moment) :type integer)
  (told (moment) :type integer))

(defun duration-text (seconds)
  (cond ((< seconds 100) (format nil "~D s" (round seconds)))
        ((< seconds 6000) (format nil "~D min" (round seconds 60)))
        (t (format nil "~,1F h" (/ seconds 3600)))))

(defun rate-text (rate)
  (if (< rate 10) (format nil "~,1F" rate) (format nil "~D" (round rate))))

(defun progress-text (progress)
  "Return how far PROGRESS has come: trials, rate, and how long it will take."
  (let* ((done (progress-done progress)) (total (progress-total progress))
         (seconds (seconds-since (progress-begun progress)))
         (rate (if (plusp seconds) (/ done seconds) 0d0)))
    (format nil "~D of ~D trials~@[, ~A a second~]~@[, ~A left~]" done total
            (and (plusp rate) (rate-text rate))
            (and (plusp rate) (< done total) (duration-text (/ (- total done) rate))))))

(defconstant +long+ 10 "After how many seconds a trial is named that is not over.")
(defconstant +longer+ 5 "How many times as long as those before it a trial must take to be named.")

(defun trials-under-way (progress)
  "Return what the workers of PROGRESS are at, lists (condition trial moment seed), oldest first."
  (sort (remove nil (coerce (progress-under-way progress) 'list)) #'< :key #'third))

(defun usual-seconds (progress)
  "Return how long the trials of PROGRESS that are over have taken on average, in seconds."
  (let ((workers (1- (length (progress-under-way progress))))
        (spent (reduce #'+ (trials-under-way progress)
                       :key (lambda (trial) (seconds-since (third trial))))))
    (if (zerop (progress-done progress))
        0
        (/ (max 0 (- (* workers (seconds-since (progress-begun progress))) spent))
           (progress-done progress)))))

(defun longest-under-way (progress)
  "Return in words which trial of PROGRESS has been under way longest, if that is long, and much
longer than others took; or NIL."
  (let ((oldest (first (trials-under-way progress))))
    (when oldest
      (destructuring-bind (condition trial moment &optional seed) oldest
        (when (> (seconds-since moment) (max +long+ (* +longer+ (usual-seconds progress))))
          (format nil "trial ~D of ~A~@[, seed ~D,~] has been under way for ~A" trial
                  (condition-name condition) seed (duration-text (seconds-since moment))))))))

(defvar *progress* nil "How far the experiment that runs in this thread has come, or NIL.")

(defun trial-under-way ()
  "Return in words which trial of the experiment that runs in this thread has been under way
longest, if that is long; or NIL."
  (and *progress* (longest-under-way *progress*)))

(defun tell-progress (progress &optional last)
  "Say how far PROGRESS has come, if it is time to, or this is the LAST time."
  (let ((stream (progress-stream progress)))
    (when (and stream
               (or last
                   (> (seconds-since (progress-told progress))
                      (if (progress-terminal-p progress) 0.5 10))))
      (setf (progress-told progress) (moment))
      (if (progress-terminal-p progress)
          (format stream "~C~A~@[; ~A~]~C[K~:[~;~%~]" #\Return (progress-text progress)
                  (longest-under-way progress) #\Escape last)
          (format stream "~&~A~@[; ~A~]~%" (progress-text progress)
                  (longest-under-way progress)))
      (finish-output stream))))
