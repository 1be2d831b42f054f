;;;; directory.lisp -- the directory of an experiment: writing its table and the other files.

(in-package :ars-magna.experiment)

(export '(ensure-store-directory))

;;; rows.csv has a row for each trial and nothing that differs from run to run. series.csv, if the
;;; experiment has :each-tick, has a line for each tick of each trial. machine.csv says how long
;;; each trial took, and where, with a checksum of its row; experiment.txt how to repeat the
;;; experiment. One process at a time writes there: it holds the lock of the file `.lock'.

(defstruct (store (:constructor make-store (path experiment)) (:copier nil))
  "The directory PATH, to which rows of EXPERIMENT are being written."
  (path nil :type pathname :read-only t)
  (experiment nil :type experiment :read-only t)
  (lock (make-lock "rows") :read-only t)
  (rows nil)
  (series nil)
  (machine nil)
  ;; By condition, the texts of the first row that was kept. See TEXTS-WITH-CHECKSUM.
  (samples (make-hash-table :test 'eq) :read-only t))

(defun ensure-store-directory (name)
  "Return the path of the directory NAME, created if necessary. Signals MISUSE."
  (let ((path (directory-path name)))
    (handler-case (progn (make-directories path) path)
      (error () (reject-use "~A cannot be created. Give another directory." (native-name path))))))

(defvar *stores-in-use* '() "The directories that this process writes to.")
(defvar *stores-lock* (make-lock "directories of experiments"))

(defun call-with-locked-directory (function path)
  "Call FUNCTION with the directory PATH locked. Signals MISUSE if another run writes to it."
  (flet ((reject ()
           (reject-use "Another run writes to ~A. Wait for its end, or give another directory."
                       (native-name path))))
    (check-files-plain path)
    (check-plain-file (lock-file path))
    (unless (with-lock (*stores-lock*)
              (unless (member path *stores-in-use* :test #'equal)
                (push path *stores-in-use*)))
      (reject))
    (unwind-protect
         (multiple-value-bind (done value)
             (call-with-file-lock function (lock-file path)
                                  (lambda ()
                                    (reject-use "~A cannot be written to. Is it read-only?"
                                                (native-name path))))
           (unless done (reject))
           value)
      (with-lock (*stores-lock*)
        (setf *stores-in-use* (remove path *stores-in-use* :test #'equal))))))

(defun call-with-temporary-directory (function)
  "Call FUNCTION with the path of a new directory, and delete that afterwards."
  (let ((path (loop for number from 0
                    for path = (directory-path (format nil "~Atrials-~D-~D/"
                                                       (native-name (uiop:temporary-directory))
                                                       (process-id) number))
                    when (make-missing-directory path) return path)))
    (unwind-protect (funcall function path)
      (uiop:delete-directory-tree path :validate t :if-does-not-exist :ignore))))

;;; Writing.

(defun remove-incomplete-line (file columns)
  "FILE is a table with COLUMNS. Remove a last line that a killed process left incomplete. Return
true if FILE has lines left. If FILE is no such table, change nothing and signal DAMAGED-TABLE."
  (when (existing-path file)
    (check-file-header file columns)
    (let ((end (map-lines (constantly nil) file)))
      (unless (= end (file-size file))
        (call-reporting-file-errors (lambda () (check-writable file) (truncate-file file end))
                                    file))
      (plusp end))))

(defun open-table (file columns)
  "Return a stream that appends to the table FILE. If FILE has no lines, COLUMNS are written first."
  (let ((new (not (remove-incomplete-line file columns)))
        (stream (call-reporting-file-errors
                 (lambda ()
                   (check-writable file)
                   (open file :direction :output :if-exists :append :if-does-not-exist :create
                              :external-format :utf-8))
                 file)))
    (when new (write-table-line (csv-line columns) stream))
    stream))

(defparameter *machine-columns*
  '("condition" "seed" "trial" "milliseconds" "worker" "process" "host" "row"))

(defun open-table-of-machines (directory)
  "Return a stream that appends to machine.csv in DIRECTORY. Signals DAMAGED-TABLE."
  (let ((file (machine-file directory)))
    (handler-case (open-table file *machine-columns*)
      (damaged-table (condition)
        (reject-table file (damaged-table-line condition)
                      "~A Or delete this file: it only has times and check sums of trials."
                      (damaged-table-trouble condition))))))

(defun call-with-store (function experiment directory)
  (let ((store (make-store directory experiment)))
    (unwind-protect
         (progn
           (setf (store-rows store) (open-table (rows-file directory) (columns experiment))
                 (store-machine store) (open-table-of-machines directory))
           (when (experiment-series experiment)
             (setf (store-series store)
                   (open-table (series-file directory) (series-columns experiment))))
           (funcall function store))
      ;; Errors were reported before.
      (dolist (stream (list (store-series store) (store-rows store) (store-machine store)))
        (when stream (ignore-errors (close stream)))))))

(defun write-table-line (line stream &optional (finish #'finish-output))
  "Write LINE to STREAM, a table, then call FINISH with STREAM. Signals DAMAGED-TABLE."
  (handler-case (progn (write-string line stream)
                       (funcall finish stream))
    (stream-error (condition)
      (reject-table (pathname stream) nil
                    "no row can be added to this table (~A). The rows in it are kept; continue ~
                     once there is room on the disk."
                    (write-failure-text condition)))))

;; The series is written first, so that a trial with a row has all of its series.
(defun store-row (store result milliseconds worker)
  "Append the row and the series of RESULT to STORE, and finish output. The trial took MILLISECONDS
in the worker numbered WORKER."
  (let* ((experiment (store-experiment store))
         (texts (result-texts experiment result))
         (line (csv-line texts))
         (series (series-text experiment result))
         (machine-line (csv-line (machine-texts result milliseconds worker line)))
         (condition (result-condition result)))
    (with-lock ((store-lock store))
      (deferring-interrupts
        (when (store-series store) (write-table-line series (store-series store)))
        (write-table-line line (store-rows store))
        (write-table-line machine-line (store-machine store)
                          ;; Lines of fast trials are written together.
                          (if (> milliseconds 1) #'finish-output #'identity))
        (unless (or (gethash condition (store-samples store))
                    (string= "timeout" (result-outcome result)))
          (setf (gethash condition (store-samples store))
                (texts-with-checksum texts experiment series)))))))

(defun row-checksum (line) (format nil "~8,'0X" (text-checksum line)))

(defun machine-texts (result milliseconds worker row)
  (list (condition-name (result-condition result))
        (integer-text (result-seed result)) (integer-text (result-trial result))
        (float-text (/ (round milliseconds 1/1000) 1000d0))
        (integer-text worker) (integer-text (process-id)) (machine-instance)
        (row-checksum row)))

;;; Existing rows. Their presence is a table from conditions to bits, one for each trial.

(defun presence-bits (condition presence)
  (or (gethash condition presence)
      (setf (gethash condition presence)
            (make-array 64 :element-type 'bit :adjustable t :initial-element 0))))

(defun trial-present-p (condition trial presence)
  (let ((bits (presence-bits condition presence)))
    (and (< trial (length bits)) (plusp (aref bits trial)))))

(defun note-trial-present (condition trial presence)
  (let ((bits (presence-bits condition presence)))
    (when (>= trial (length bits))
      (setf bits (adjust-array bits (* 2 (1+ trial)) :initial-element 0)
            (gethash condition presence) bits))
    (setf (aref bits trial) 1)))

(defun condition-of-texts (experiment texts)
  (find (third texts) (experiment-conditions experiment)
        :key #'condition-name :test #'string=))

(defun check-row (experiment condition texts file number)
  "TEXTS are line NUMBER of FILE. Signal DAMAGED-TABLE unless they can be a row of CONDITION of
EXPERIMENT, or of a former condition if CONDITION is NIL."
  (let ((seed (seed-column (columns experiment))))
    (unless (string= (first texts) (string-downcase (experiment-name experiment)))
      (reject-table file number "this is a row of another experiment, ~A. Give another directory."
                    (first texts)))
    (when (or (and condition (not (equal (condition-texts condition) (subseq texts 3 seed))))
              (and (null condition)
                   (find (second texts) (experiment-conditions experiment)
                         :key #'condition-fingerprint :test #'equal)))
      (reject-row file number "The condition, factors and fingerprint of this row do not agree."))))

(defun check-seed-of-row (experiment texts file number)
  "TEXTS are line NUMBER of FILE. Signal DAMAGED-TABLE if EXPERIMENT has other seeds."
  (destructuring-bind (seed trial &rest others) (nthcdr (seed-column (columns experiment)) texts)
    (declare (ignore others))
    (let ((expected (trial-seed experiment (parse-integer trial))))
      (unless (= expected (parse-integer seed))
        (reject-table file number "this row is of other seeds: its trial ~A has the seed ~A, and ~
                                   that of this run has ~D. Give another directory for these seeds."
                      trial seed expected)))))

(defun recorded-checksums (directory)
  "Return a table of the checksums of rows in machine.csv in DIRECTORY, by lists (condition trial)
of texts. Lines without a checksum do not count. Of several lines of a trial, the last counts."
  (let ((sums (make-hash-table :test 'equal)) (file (machine-file directory)))
    (when (existing-path file)
      (map-lines (lambda (line start number)
                   (declare (ignore start number))
                   (let ((texts (handler-case (csv-fields (line-text line)) (broken-line () '()))))
                     (when (= (length texts) (length *machine-columns*))
                       (setf (gethash (list (first texts) (third texts)) sums)
                             (first (last texts))))))
                 file))
    sums))

(defun check-row-unchanged (condition trial texts sums file number)
  "TEXTS are line NUMBER of FILE, of TRIAL of CONDITION. Signal DAMAGED-TABLE if SUMS has another
checksum for it."
  (let ((sum (gethash (list (condition-name condition) (integer-text trial)) sums))
        (now (row-checksum (csv-line texts))))
    (unless (or (null sum) (string= sum now))
      (reject-row file number "This row has changed since its trial: its check sum is ~A, and ~A ~
                               in machine.csv."
                  now sum))))

(defun present-rows (experiment directory foreign &optional (sample (constantly nil)))
  "Return two values: a table of the rows of EXPERIMENT in DIRECTORY whose series are complete, and
the index of the series. Call FOREIGN for each row with another fingerprint, and SAMPLE for each row
in the table, with the row's condition and texts. Remove an incomplete last line. Signals
DAMAGED-TABLE if a row is not of EXPERIMENT, or not as its trial left it."
  (let ((presence (make-hash-table :test 'eq)) (file (rows-file directory))
        (series (index-existing-series experiment directory))
        (sums (recorded-checksums directory))
        (place (1+ (seed-column (columns experiment)))))
    (when (remove-incomplete-line file (columns experiment))
      (do-rows (texts file start number)
        (let ((condition (condition-of-texts experiment texts)))
          (check-seed-of-row experiment texts file number)
          (when (and condition (string/= (second texts) (condition-fingerprint condition)))
            (funcall foreign condition texts))
          (check-row experiment condition texts file number)
          (when (and condition (series-complete-p series texts))
            (let ((trial (parse-integer (nth place texts))))
              (check-row-unchanged condition trial texts sums file number)
              (funcall sample condition texts)
              (note-trial-present condition trial presence))))))
    (values presence series)))
