;;;; shards.lisp -- the tables of shards, below the directory of the whole.

(in-package :ars-magna.experiment)

;;; Shard I of N keeps its table in a directory shard-I-of-N below that of the whole, where all of
;;; them are put together. What there is of any of them counts as there.

(defun shard-directory (directory index count)
  "Return the name of the directory of the shard INDEX of COUNT below DIRECTORY."
  (native-name (file-in (directory-called directory)
                        (format nil "shard-~D-of-~D/" index count))))

(defun shard-directory-p (path)
  (starts-with-subseq "shard-" (car (last (pathname-directory path)))))

(defun directories-with-rows (directory)
  "Return the names of DIRECTORY and the directories of shards below it, those that have rows."
  (let* ((path (directory-called directory))
         (shards (remove-if-not #'shard-directory-p (uiop:subdirectories path))))
    (loop for directory in (cons path (sort (mapcar #'native-name shards) #'string<))
          for file = (existing-path (rows-file (directory-called directory)))
          when (and file (plusp (count-whole-lines file)))
            collect (native-name directory))))

(defun count-whole-lines (file)
  (let ((count 0))
    (map-lines (lambda (line start number)
                 (declare (ignore line start))
                 (setf count number))
               file)
    count))

(defun count-rows (directory)
  "Return how many rows there are in DIRECTORY and the shards below it, those of one trial once for
each table that has it."
  (loop for directory in (directories-with-rows directory)
        sum (1- (count-whole-lines (rows-file (directory-called directory))))))

;;; What is missing.

(defun note-rows (experiment file presence)
  "Note in PRESENCE which trials of EXPERIMENT have rows in FILE."
  (let ((seed (seed-column (columns experiment))))
    (when (equal (columns experiment) (header-of file))
      (map-rows (lambda (texts line start number)
                  (declare (ignore line start number))
                  (let ((condition (condition-of-texts experiment texts)))
                    (when (and condition
                               (string= (second texts) (condition-fingerprint condition)))
                      (note-present condition (parse-integer (nth (1+ seed) texts)) presence))))
                file))))

(defun missing-shards (experiment trials count directory)
  "Return the numbers, from 0, of those of COUNT shards of TRIALS trials of each condition of
EXPERIMENT that lack rows in DIRECTORY and the shards below it, in order."
  (prepare-experiment experiment)
  (let ((presence (make-presence)) (missing (make-array count :element-type 'bit)))
    (dolist (directory (directories-with-rows directory))
      (note-rows experiment (rows-file (directory-called directory)) presence))
    (loop for trial from 1 to trials
          do (unless (every (lambda (condition) (present-p condition trial presence))
                            (experiment-conditions experiment))
               (setf (aref missing (mod trial count)) 1)))
    (loop for shard below count
          when (plusp (aref missing shard)) collect shard)))
