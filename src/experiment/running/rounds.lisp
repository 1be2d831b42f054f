;;;; rounds.lisp -- which trials are to be run, and running them.

(in-package :ars-magna.experiment)

;;; Trials come by number, and for each number all conditions, so that whoever stops early has as
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
  (let ((begun (moment)))
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
                   ;; Nobody gets another trial.
                   :stop (lambda () (setf (queue-closed-p queue) t))))
