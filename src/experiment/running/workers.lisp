;;;; workers.lisp -- running trials in several threads, and reporting progress.

(in-package :ars-magna.experiment)

(export '(call-by-workers current-slow-trial-text run-trial-in-worker))

(addition processors)

(defun processors ()
  "Return the number of processors that this process may use, or 1 if it is unknown."
  (let ((text (nth-value 1 (run-command "nproc" '() :output :string))))
    (max 1 (or (and text (parse-integer text :junk-allowed t)) 1))))

(defun await-result (channel left)
  "Wait a moment for one of the LEFT results that CHANNEL still has to deliver. Return how many
results are left, and the new result or NIL."
  (multiple-value-bind (trouble there-p) (lparallel:try-receive-result channel :timeout 0.2)
    (values (if there-p (1- left) left) trouble)))

(defconstant +most-worker-waits+ 10
  "The time to wait for threads before they are ended, in fifths of a second.")

(defun end-workers (channel left)
  "Wait a moment for the LEFT threads whose results CHANNEL still lacks, then end these threads."
  (loop repeat +most-worker-waits+
        while (plusp left)
        do (setf left (await-result channel left)))
  (handler-bind ((warning #'muffle-warning))
    (when (plusp left) (lparallel:kill-tasks :default))
    (lparallel:end-kernel :wait t)))

(defun call-by-workers (function count &key (pulse (constantly nil)) (stop (constantly nil)))
  "Call FUNCTION in COUNT threads with the thread's number, from 1, and wait until all return. Call
PULSE now and then meanwhile. At the end, also after a THROW, call STOP, which should make the
threads return; threads that do not return are ended. Errors of FUNCTION are signalled here."
  (let* ((lparallel:*kernel* (lparallel:make-kernel
                              count :name "trials"
                              ;; Threads that are ended would print a message.
                              :bindings `((*standard-output* . ,*null-output*)
                                          (*error-output* . ,*null-output*))))
         (channel (lparallel:make-channel))
         (left count))
    (unwind-protect
         (progn
           (loop for number from 1 to count
                 do (let ((number number))
                      (lparallel:submit-task
                       channel
                       (lambda ()
                         (handler-case (progn (funcall function number) nil)
                           ((or error storage-condition) (condition) condition))))))
           (loop with trouble
                 while (plusp left)
                 do (setf (values left trouble) (await-result channel left))
                    (when trouble (error trouble))
                    (funcall pulse)))
      (funcall stop)
      (end-workers channel left))))

;;;; Progress

;;; On a terminal one line is updated; elsewhere a line is printed now and then.

(defun seconds-since (moment)
  (/ (- (real-microseconds) moment) 1d6))

(defstruct (progress (:constructor make-progress
                               (stream terminal-p total workers
                                &aux (under-way (make-array (1+ workers) :initial-element nil))))
                     (:copier nil))
  "The progress of an experiment of TOTAL trials, and the STREAM to report it to, or NIL."
  (stream nil :read-only t)
  (terminal-p nil :read-only t)
  (total 0 :type integer)
  (done 0 :type atomic-count)
  ;; By worker: its current trial, a list (condition trial moment seed), or NIL.
  (under-way #() :type simple-vector :read-only t)
  (begun (real-microseconds) :type integer)
  (told (real-microseconds) :type integer))

(defun duration-text (seconds)
  (cond ((< seconds 100) (format nil "~D s" (round seconds)))
        ((< seconds 6000) (format nil "~D min" (round seconds 60)))
        (t (format nil "~,1F h" (/ seconds 3600)))))

(defun rate-text (rate)
  (if (< rate 10) (format nil "~,1F" rate) (format nil "~D" (round rate))))

(defun progress-text (progress)
  (let* ((done (progress-done progress)) (total (progress-total progress))
         (seconds (seconds-since (progress-begun progress)))
         (rate (if (plusp seconds) (/ done seconds) 0d0)))
    (format nil "~D of ~D trials~@[, ~A a second~]~@[, ~A left~]" done total
            (and (plusp rate) (rate-text rate))
            (and (plusp rate) (< done total) (duration-text (/ (- total done) rate))))))

;; A trial is named if it takes longer than both.
(defconstant +slow-trial-seconds+ 10 "A number of seconds.")
(defconstant +slow-trial-factor+ 5 "A multiple of the average duration of trials before it.")

(defun trials-under-way (progress)
  (sort (remove nil (coerce (progress-under-way progress) 'list)) #'< :key #'third))

(defun average-seconds (progress)
  "Return the average duration, in seconds, of the trials of PROGRESS that have ended."
  (let ((workers (1- (length (progress-under-way progress))))
        (spent (reduce #'+ (trials-under-way progress)
                       :key (lambda (trial) (seconds-since (third trial))))))
    (if (zerop (progress-done progress))
        0
        (/ (max 0 (- (* workers (seconds-since (progress-begun progress))) spent))
           (progress-done progress)))))

(defun slow-trial-text (progress)
  "Return a text on the trial of PROGRESS that has run longest, if it has run for a long time, and
much longer than other trials took; else NIL."
  (let ((oldest (first (trials-under-way progress))))
    (when oldest
      (destructuring-bind (condition trial moment &optional seed) oldest
        (when (> (seconds-since moment) (max +slow-trial-seconds+
                                               (* +slow-trial-factor+ (average-seconds progress))))
          (format nil "trial ~D of ~A~@[, seed ~D,~] has been under way for ~A" trial
                  (condition-name condition) seed (duration-text (seconds-since moment))))))))

(defvar *progress* nil "The progress of the experiment that runs in this thread, or NIL.")

(defun current-slow-trial-text ()
  "Return a text on the longest-running trial of this thread's experiment if it is slow, else NIL."
  (and *progress* (slow-trial-text *progress*)))

(defun report-progress (progress &optional last)
  "Print PROGRESS if the previous report is long enough ago, or if LAST is true."
  (let ((stream (progress-stream progress)))
    (when (and stream
               (or last
                   (> (seconds-since (progress-told progress))
                      (if (progress-terminal-p progress) 0.5 10))))
      (setf (progress-told progress) (real-microseconds))
      (if (progress-terminal-p progress)
          (format stream "~C~A~@[; ~A~]~C[K~:[~;~%~]" #\Return (progress-text progress)
                  (slow-trial-text progress) #\Escape last)
          (format stream "~&~A~@[; ~A~]~%" (progress-text progress)
                  (slow-trial-text progress)))
      (finish-output stream))))

;;;; Trials that do not return, or end their thread

;;; A worker's thread may be ended by the trial itself, which is that trial's error; or because the
;;; run is stopped or this Lisp exits. The last two are not intercepted.

(defun call-catching-thread-end (function stopping-p)
  "Call FUNCTION in a worker's thread. If FUNCTION tries to end the thread, prevent that and return
true, unless the function STOPPING-P returns true."
  (let ((returned-p nil))
    (block call
      (unwind-protect (progn (funcall function)
                             (setf returned-p t)
                             nil)
        (unless (or returned-p *exiting-p* (funcall stopping-p))
          (return-from call t))))))

(defun call-within-seconds (function seconds)
  "Call FUNCTION. If FUNCTION takes longer than SECONDS (NIL: no limit), leave it and return true."
  (block call
    (let ((open-p t))
      (flet ((leave () (when open-p (return-from call t))))
        (unwind-protect (if seconds
                            (call-with-time-limit function seconds #'leave)
                            (funcall function))
          (setf open-p nil))))
    nil))

(defun run-trial-in-worker (experiment condition trial stopping-p &optional seconds)
  "Run TRIAL of CONDITION of EXPERIMENT in a worker's thread, for at most SECONDS (NIL: no limit).
Return the trial's result, even if the trial ends the thread, unless STOPPING-P returns true."
  (let* ((seed (trial-seed experiment trial)) (late-p nil)
         (result (make-result condition trial seed)))
    (if (call-catching-thread-end
         (lambda ()
           (setf late-p (call-within-seconds
                         (lambda () (setf result (run-trial experiment condition trial)))
                         seconds)))
         stopping-p)
        (set-error-outcome result "The trial has ended the thread that it ran in.")
        ;; Its progress differs from run to run, so it is not in the row.
        (when late-p
          (setf result (make-result condition trial seed)
                (result-outcome result) "timeout"
                (result-ticks result) nil)))
    result))

;;;; The queue of trials

;;; Trials are ordered by number, then by condition, so a run stopped early has as many of each
;;; condition. Workers take one after the other from the queue. A shard (index . count) has the
;;; trials whose numbers leave INDEX when divided by COUNT; (0 . 1) has all.

(defstruct (queue (:constructor make-queue (conditions last presence shard time-limit))
                  (:copier nil))
  "Those of the trials 1 to LAST of CONDITIONS that are in SHARD and not in PRESENCE."
  (conditions '() :type list :read-only t)
  (last 0 :type integer :read-only t)
  (presence nil :type hash-table :read-only t)
  (shard nil :type list :read-only t)
  ;; The most seconds of a trial, or NIL.
  (time-limit nil :type (or null real) :read-only t)
  (lock (make-lock "trials") :read-only t)
  ;; The next trial: its number, and the conditions that it has yet to run under.
  (trial 0 :type integer)
  (left '() :type list)
  (closed-p nil :type boolean))

(defun in-shard-p (trial shard)
  (= (car shard) (mod trial (cdr shard))))

(defun pop-queue-trial (queue)
  "Return condition and number of the next trial of QUEUE, even if it has a row; NIL at the end."
  (when (null (queue-left queue))
    (setf (queue-trial queue)
          (loop for trial from (1+ (queue-trial queue)) to (queue-last queue)
                when (in-shard-p trial (queue-shard queue)) return trial
                finally (return (1+ (queue-last queue))))
          (queue-left queue) (and (<= (queue-trial queue) (queue-last queue))
                                  (queue-conditions queue))))
  (values (pop (queue-left queue)) (queue-trial queue)))

(defun next-missing-trial (queue)
  "Return condition and number of the next trial of QUEUE that has no row; NIL at the end."
  (with-lock ((queue-lock queue))
    (unless (queue-closed-p queue)
      (loop (multiple-value-bind (condition trial) (pop-queue-trial queue)
              (cond ((null condition) (return nil))
                    ((not (trial-present-p condition trial (queue-presence queue)))
                     (return (values condition trial)))))))))

(defun count-in-shard (last shard)
  "Return the number of trials from 1 to LAST in SHARD."
  (destructuring-bind (index . count) shard
    (- (floor (- last index) count) (floor (- index) count))))

(defun count-missing (queue)
  "Return the number of trials in QUEUE, of which none has been taken yet."
  (let ((last (queue-last queue)) (shard (queue-shard queue)))
    (loop for condition in (queue-conditions queue)
          for bits = (presence-bits condition (queue-presence queue))
          sum (- (count-in-shard last shard)
                 (loop for trial from 1 below (min (1+ last) (length bits))
                       count (and (plusp (aref bits trial)) (in-shard-p trial shard)))))))

;;; Running them.

(defun run-and-store-trial (experiment condition trial queue store progress worker)
  "Run TRIAL of CONDITION, from QUEUE, append its row to STORE, and update PROGRESS."
  (let ((begun (real-microseconds)))
    (setf (svref (progress-under-way progress) worker)
          (list condition trial begun (trial-seed experiment trial)))
    (let ((result (run-trial-in-worker experiment condition trial (lambda () (queue-closed-p queue))
                                       (queue-time-limit queue))))
      (store-row store result (* 1000 (seconds-since begun)) worker))
    (setf (svref (progress-under-way progress) worker) nil)
    (atomic-incf (progress-done progress))))

(defun run-queued-trials (experiment queue store progress worker)
  (flet ((work ()
           (loop (multiple-value-bind (condition trial) (next-missing-trial queue)
                   (unless condition (return))
                   (run-and-store-trial experiment condition trial queue store progress worker)))))
    (call-without-output
     (lambda ()
       (call-with-trial-syntax (lambda () (call-with-own-random-state #'work)))))))

(defun run-queue (experiment queue store progress workers)
  "Run the trials of QUEUE in WORKERS threads. After a non-local exit no more trials are started,
and running trials have a moment to end."
  (call-by-workers (lambda (worker) (run-queued-trials experiment queue store progress worker))
                   workers
                   :pulse (lambda () (report-progress progress))
                   :stop (lambda () (setf (queue-closed-p queue) t))))
