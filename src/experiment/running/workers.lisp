;;;; workers.lisp -- running trials by several threads, and saying how far it has come.

(in-package :ars-magna.experiment)

(export '(call-by-workers trial-under-way run-guarded))

(addition processors)

(defun processors ()
  "Return how many processors this machine lets us use, 1 if that cannot be told."
  (let ((text (nth-value 1 (run-command "nproc" '() :output :string))))
    (max 1 (or (and text (parse-integer text :junk-allowed t)) 1))))

(defun await-result (channel left)
  "Take a result from CHANNEL if there is one soon. Return how many are LEFT then, and the result."
  (multiple-value-bind (trouble there-p) (lparallel:try-receive-result channel :timeout 0.2)
    (values (if there-p (1- left) left) trouble)))

(defconstant +patience+ 10
  "For how many fifths of a second threads that are to end may go on with what they do.")

(defun end-workers (channel left)
  "Wait a moment for LEFT threads that have not answered by CHANNEL to end, then end them."
  (loop repeat +patience+
        while (plusp left)
        do (setf left (await-result channel left)))
  (handler-bind ((warning #'muffle-warning))
    (when (plusp left) (lparallel:kill-tasks :default))
    (lparallel:end-kernel :wait t)))

(defun call-by-workers (function count &key (pulse (constantly nil)) (stop (constantly nil)))
  "Call FUNCTION in each of COUNT threads, with its number from 1, and wait until all have returned.
PULSE, a function, is called here now and then. If this is left, STOP is called, which should let
them return; those that do not are ended. What FUNCTION signals is signalled here."
  (let* ((lparallel:*kernel* (lparallel:make-kernel
                              count :name "trials"
                              ;; Threads that are ended would say so.
                              :bindings `((*standard-output* . ,*nowhere*)
                                          (*error-output* . ,*nowhere*))))
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

;;;; Saying how far an experiment has come

;;; On a terminal there is one line that changes; elsewhere a line now and then.

(defun seconds-since (moment)
  "Return how many seconds ago MOMENT was, as REAL-MICROSECONDS told it."
  (/ (- (real-microseconds) moment) 1d6))

(defstruct (progress (:constructor make-progress
                               (stream terminal-p total workers
                                &aux (under-way (make-array (1+ workers) :initial-element nil))))
                     (:copier nil))
  "How far an experiment of TOTAL trials has come, and where that is reported."
  (stream nil :read-only t)
  (terminal-p nil :read-only t)
  (total 0 :type integer)
  (done 0 :type atomic-count)
  ;; By worker: what it is at, a list (condition trial moment seed), or NIL.
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

(defconstant +long+ 10 "After how many seconds a trial is named that is not over.")
(defconstant +longer+ 5 "How many times as long as those before it a trial must take to be named.")

(defun trials-under-way (progress)
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
      (setf (progress-told progress) (real-microseconds))
      (if (progress-terminal-p progress)
          (format stream "~C~A~@[; ~A~]~C[K~:[~;~%~]" #\Return (progress-text progress)
                  (longest-under-way progress) #\Escape last)
          (format stream "~&~A~@[; ~A~]~%" (progress-text progress)
                  (longest-under-way progress)))
      (finish-output stream))))

;;;; Trials that do not return, or end their thread

;;; A worker's thread may be ended in three ways: by the trial itself, which is that trial's error;
;;; when the run is stopped; and when this Lisp is left. In the last two nothing is held up.

(defun call-catching-thread-end (function stopping-p)
  "Call FUNCTION in a worker. True if it has ended this thread, which goes on then, unless the
function STOPPING-P returns true."
  (let ((returned-p nil))
    (block call
      (unwind-protect (progn (funcall function)
                             (setf returned-p t)
                             nil)
        (unless (or returned-p *leaving-p* (funcall stopping-p))
          (return-from call t))))))

(defun call-within (function seconds)
  "Call FUNCTION, but leave it after so many SECONDS, unless these are NIL. True if it was left."
  (block call
    (let ((open-p t))
      (flet ((leave () (when open-p (return-from call t))))
        (unwind-protect (if seconds
                            (call-with-limit function seconds #'leave)
                            (funcall function))
          (setf open-p nil))))
    nil))

(defun run-guarded (experiment condition trial stopping-p &optional seconds)
  "Run TRIAL of CONDITION of EXPERIMENT in a worker's thread, for at most so many SECONDS, unless
these are NIL. Return its result, whatever the trial does to the thread unless the function
STOPPING-P returns true."
  (let* ((seed (trial-seed experiment trial)) (late-p nil)
         (result (make-result condition trial seed)))
    (if (call-catching-thread-end
         (lambda ()
           (setf late-p (call-within
                         (lambda () (setf result (run-trial experiment condition trial)))
                         seconds)))
         stopping-p)
        (note-error result "The trial has ended the thread that it ran in.")
        ;; How far it has come differs from run to run, so the row does not have that.
        (when late-p
          (setf result (make-result condition trial seed)
                (result-outcome result) "timeout"
                (result-ticks result) nil)))
    result))

;;;; Which trials are to be run

;;; Trials come by number, and for each number all conditions, so a run stopped early has equally
;;; many of each. Workers take one after the other from the queue. A shard (index . count) has the
;;; trials whose numbers leave INDEX when divided by COUNT; (0 . 1) has all.

(defstruct (queue (:constructor make-queue (conditions last presence shard time-limit))
                  (:copier nil))
  "The trials from 1 to LAST of CONDITIONS that are in SHARD and that PRESENCE lacks."
  (conditions '() :type list :read-only t)
  (last 0 :type integer :read-only t)
  (presence nil :type hash-table :read-only t)
  (shard nil :type list :read-only t)
  ;; How many seconds each may take, or NIL.
  (time-limit nil :type (or null real) :read-only t)
  (lock (make-lock "trials") :read-only t)
  ;; What comes next.
  (trial 0 :type integer)
  (left '() :type list)
  (closed-p nil :type boolean))

(defun in-shard-p (trial shard)
  (= (car shard) (mod trial (cdr shard))))

(defun step-queue (queue)
  "Return the next trial of QUEUE, present or not, as a condition and a number, or NIL."
  (when (null (queue-left queue))
    (setf (queue-trial queue)
          (loop for trial from (1+ (queue-trial queue)) to (queue-last queue)
                when (in-shard-p trial (queue-shard queue)) return trial
                finally (return (1+ (queue-last queue))))
          (queue-left queue) (and (<= (queue-trial queue) (queue-last queue))
                                  (queue-conditions queue))))
  (values (pop (queue-left queue)) (queue-trial queue)))

(defun next-trial (queue)
  "Return a trial to be run now, as a condition and a number, or NIL if there is none left."
  (with-lock ((queue-lock queue))
    (unless (queue-closed-p queue)
      (loop (multiple-value-bind (condition trial) (step-queue queue)
              (cond ((null condition) (return nil))
                    ((not (present-p condition trial (queue-presence queue)))
                     (return (values condition trial)))))))))

(defun count-in-shard (last shard)
  "Return how many numbers from 1 to LAST are of trials in SHARD."
  (destructuring-bind (index . count) shard
    (- (floor (- last index) count) (floor (- index) count))))

(defun count-missing (queue)
  "Return how many trials there are in QUEUE, of which none has been taken."
  (let ((last (queue-last queue)) (shard (queue-shard queue)))
    (loop for condition in (queue-conditions queue)
          for bits = (bits-of condition (queue-presence queue))
          sum (- (count-in-shard last shard)
                 (loop for trial from 1 below (min (1+ last) (length bits))
                       count (and (plusp (aref bits trial)) (in-shard-p trial shard)))))))

;;; Running them.

(defun run-and-keep (experiment condition trial queue store progress worker)
  "Run TRIAL of CONDITION, which is of QUEUE, keep what comes of it in STORE, and tell PROGRESS."
  (let ((begun (real-microseconds)))
    (setf (svref (progress-under-way progress) worker)
          (list condition trial begun (trial-seed experiment trial)))
    (let ((result (run-guarded experiment condition trial (lambda () (queue-closed-p queue))
                               (queue-time-limit queue))))
      (keep-row store result (* 1000 (seconds-since begun)) worker))
    (setf (svref (progress-under-way progress) worker) nil)
    (atomic-incf (progress-done progress))))

(defun work-off (experiment queue store progress worker)
  (flet ((work ()
           (loop (multiple-value-bind (condition trial) (next-trial queue)
                   (unless condition (return))
                   (run-and-keep experiment condition trial queue store progress worker)))))
    (call-in-silence
     (lambda ()
       (call-plainly (lambda () (call-with-own-lisps-dice #'work)))))))

(defun run-queue (experiment queue store progress workers)
  "Run the trials of QUEUE by WORKERS threads. If this is left, no trial is begun any more, and
those under way are given a moment."
  (call-by-workers (lambda (worker) (work-off experiment queue store progress worker))
                   workers
                   :pulse (lambda () (tell-progress progress))
                   ;; No trial is started any more.
                   :stop (lambda () (setf (queue-closed-p queue) t))))
