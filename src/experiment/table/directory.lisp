;;;; directory.lisp -- the directory of an experiment: its table, and what is kept beside it.

(in-package :ars-magna.experiment)

;;; rows.csv has a row for each trial and nothing that differs from run to run; machine.csv says how
;;; long each took, and where; experiment.txt how to repeat it all. One process at a time writes
;;; there: it holds the lock of the file `.lock'.

(defstruct (store (:constructor make-store (path experiment)) (:copier nil))
  "The directory PATH in which rows of EXPERIMENT are kept, while they are written."
  (path nil :type pathname :read-only t)
  (experiment nil :type experiment :read-only t)
  (lock (make-lock "rows") :read-only t)
  (rows nil)
  (machine nil))

(defun file-in (directory name)
  (merge-pathnames (native-path name) directory))

(defun rows-file (directory) (file-in directory "rows.csv"))
(defun machine-file (directory) (file-in directory "machine.csv"))
(defun description-file (directory) (file-in directory "experiment.txt"))

(defun directory-called (name)
  "Return the absolute path of the directory NAME, a string or pathname."
  (uiop:ensure-directory-pathname
   (merge-pathnames (if (stringp name) (uiop:parse-native-namestring name :ensure-directory t) name)
                    (uiop:getcwd))))

(defun ensure-store-directory (name)
  "Return the path of the directory NAME, made if there is none. Signals MISUSE."
  (let ((path (directory-called name)))
    (handler-case (progn (ensure-directories-exist path) path)
      (error () (reject-use "~A cannot be made; give the name of a directory that can be."
                            (native-name path))))))

(defvar *stores-in-use* '() "The directories that this process writes to.")
(defvar *stores-lock* (make-lock "directories of experiments"))

(defun claim-directory (path)
  "True if no other thread of this process has PATH, which this one has then."
  (with-lock (*stores-lock*)
    (unless (member path *stores-in-use* :test #'equal)
      (push path *stores-in-use*))))

(defun call-with-directory (function path)
  "Call FUNCTION while nobody else writes to the directory PATH. Signals MISUSE if somebody does."
  (flet ((reject ()
           (reject-use "Another run writes to ~A. Wait for its end, or give another directory."
                       (native-name path))))
    (unless (claim-directory path) (reject))
    (unwind-protect
         (multiple-value-bind (done value) (call-with-file-lock function (file-in path ".lock"))
           (unless done (reject))
           value)
      (with-lock (*stores-lock*)
        (setf *stores-in-use* (remove path *stores-in-use* :test #'equal))))))

(defun new-directory ()
  "Return the path of a new directory among the system's temporary ones."
  (loop for number from 0
        for path = (directory-called (format nil "~Aars-magna-~D-~D/"
                                             (native-name (uiop:temporary-directory))
                                             (process-number) number))
        when (nth-value 1 (ensure-directories-exist path)) return path))

(defun call-with-temporary-directory (function)
  "Call FUNCTION with the path of a new directory, which is gone afterwards."
  (let ((path (new-directory)))
    (unwind-protect (funcall function path)
      (uiop:delete-directory-tree path :validate t :if-does-not-exist :ignore))))

;;; Writing.

(defun cut-broken-line (file)
  "Cut off what a process that was killed has begun to write to FILE. True if anything is left."
  (when (existing-path file)
    (let ((end (map-lines (constantly nil) file)))
      (cut-file file end)
      (plusp end))))

(defun open-table (file columns)
  "Return a stream that appends to the table FILE, which is begun with COLUMNS if it has no lines."
  (let ((new (not (cut-broken-line file)))
        (stream (open file :direction :output :if-exists :append :if-does-not-exist :create
                           :external-format :utf-8)))
    (when new
      (write-string (csv-line columns) stream)
      (finish-output stream))
    stream))

(defparameter *machine-columns*
  '("condition" "seed" "trial" "milliseconds" "worker" "process" "host")
  "The columns of the table of what differs from run to run.")

(defun call-with-store (function experiment directory)
  "Call FUNCTION with a store for EXPERIMENT in DIRECTORY."
  (let ((store (make-store directory experiment)))
    (unwind-protect
         (progn
           (setf (store-rows store) (open-table (rows-file directory) (columns experiment))
                 (store-machine store) (open-table (machine-file directory) *machine-columns*))
           (funcall function store))
      (close-table (store-rows store))
      (close-table (store-machine store)))))

(defun close-table (stream)
  "Close STREAM, to a table, or NIL. What cannot be written any more is no news by now."
  (when stream
    (ignore-errors (close stream))))

(defun write-table-line (line stream &optional (finish #'finish-output))
  "Write LINE to STREAM, a table, and FINISH that. Signals DAMAGED-TABLE if that cannot be."
  (handler-case (progn (write-string line stream)
                       (funcall finish stream))
    (stream-error (condition)
      (reject-table (pathname stream) nil
                    "no more can be written (~A). What is there is kept; go on once there is room."
                    (system-text condition)))))

(defun system-text (condition)
  "Return what the system says of a stream, without what CONDITION says of the stream itself."
  (let* ((text (one-line (own-text condition))) (end (search ">: " text :from-end t)))
    (if end (subseq text (+ 3 end)) text)))

(defun keep-row (store result milliseconds worker)
  "Append to STORE the row for RESULT, which took MILLISECONDS of WORKER. It is there for good when
this returns."
  (let ((line (csv-line (result-texts (store-experiment store) result)))
        (machine-line (csv-line (machine-texts result milliseconds worker))))
    (with-lock ((store-lock store))
      (deferring-interrupts
        (write-table-line line (store-rows store))
        (write-table-line machine-line (store-machine store) #'identity)))))

(defun machine-texts (result milliseconds worker)
  (list (condition-name (result-condition result))
        (princ-to-string (result-seed result)) (princ-to-string (result-trial result))
        (float-text (/ (round milliseconds 1/1000) 1000d0))
        (princ-to-string worker) (princ-to-string (process-number)) (host-name)))

;;; What is there. For each condition the trials are a row of bits.

(defstruct (presence (:constructor make-presence ()) (:copier nil))
  "Which trials of which conditions have rows."
  (bits (make-hash-table :test 'eq) :read-only t)
  (count 0 :type fixnum))

(defun bits-of (condition presence)
  (or (gethash condition (presence-bits presence))
      (setf (gethash condition (presence-bits presence))
            (make-array 64 :element-type 'bit :adjustable t :initial-element 0))))

(defun present-p (condition trial presence)
  (let ((bits (bits-of condition presence)))
    (and (< trial (length bits)) (plusp (aref bits trial)))))

(defun note-present (condition trial presence)
  (let ((bits (bits-of condition presence)))
    (when (>= trial (length bits))
      (setf bits (adjust-array bits (* 2 (1+ trial)) :initial-element 0)
            (gethash condition (presence-bits presence)) bits))
    (setf (aref bits trial) 1)
    (incf (presence-count presence))))

(defun condition-of-texts (experiment texts)
  "Return the condition of EXPERIMENT that the row TEXTS is of, or NIL if it has none like that."
  (find (third texts) (experiment-conditions experiment)
        :key #'condition-name :test #'string=))

(defun check-columns (experiment file)
  (let ((columns (header-of file)))
    (unless (equal columns (columns experiment))
      (reject-table file 1 "its columns are ~{~A~^, ~}, and those of ~(~A~) are ~{~A~^, ~}. Give ~
                            another directory."
                    columns (experiment-name experiment) (columns experiment)))))

(defun present-rows (experiment directory foreign)
  "Return the presence of the rows in DIRECTORY, of trials of EXPERIMENT, and the texts of the last
of them. FOREIGN is called with the condition and the texts of a row of another fingerprint. What a
process that was killed has begun to write is cut off. Signals DAMAGED-TABLE."
  (let ((presence (make-presence)) (last nil) (file (rows-file directory)))
    (when (cut-broken-line file)
      (check-columns experiment file)
      (let ((seed (seed-column (columns experiment))))
        (map-rows (lambda (texts line start number)
                    (declare (ignore line start))
                    (let ((condition (condition-of-texts experiment texts)))
                      (when condition
                        (setf last texts)
                        (unless (string= (second texts) (condition-fingerprint condition))
                          (funcall foreign condition texts))
                        (note-present condition (trial-in (nth (1+ seed) texts) file number)
                                      presence))))
                  file)))
    (values presence last)))
