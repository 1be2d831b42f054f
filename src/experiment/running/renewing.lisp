;;;; renewing.lisp -- running trials again whose code has changed since they were run.

(in-package :ars-magna.experiment)

;;; While you write an agent, its code changes from run to run. So RUN-TESTBED does not refuse rows
;;; of other code, but copies the table and removes these rows. Rows of unchanged conditions stay.

(defvar *renew-changed-rows-p* nil
  "True if trials whose code has changed are run again; else their rows are refused.")

(defun changed-conditions (experiment directory)
  "Return the conditions of EXPERIMENT that have rows of other code in DIRECTORY."
  (let ((changed '()))
    (present-rows experiment directory
                  (lambda (condition texts)
                    (declare (ignore texts))
                    (pushnew condition changed)))
    (remove-if-not (lambda (condition) (member condition changed))
                   (experiment-conditions experiment))))

(defun copy-table (directory)
  "Copy the files of the table in DIRECTORY to a new directory old-N below it. Return its path."
  (let ((copy (loop for number from 1
                    for path = (file-in directory (format nil "old-~D/" number))
                    unless (uiop:directory-exists-p path)
                      return (ensure-store-directory path))))
    (loop for file-of in '(rows-file series-file machine-file description-file)
          for file = (existing-path (funcall file-of directory))
          for own = (funcall file-of copy)
          do (when file
               (call-reporting-file-errors (lambda () (uiop:copy-file file own)) own)))
    copy))

(defun remove-lines (conditions file place)
  "Remove the lines of CONDITIONS, names, from FILE, a table with the names in the column PLACE.
Also remove lines that cannot be read."
  (when (existing-path file)
    (call-replacing-table
     (lambda (out)
       (map-lines (lambda (line start number)
                    (declare (ignore start))
                    (let* ((text (ignore-errors (line-text line)))
                           (name (nth place (ignore-errors (csv-fields text)))))
                      (when (and name
                                 (or (= number 1) (not (member name conditions :test #'string=))))
                        (write-line text out))))
                  file))
     file)))

(defconstant +most-changes-shown+ 5)

(defun changes-text (experiment conditions parts directory)
  "Return a text on what has changed since the trials of CONDITIONS of EXPERIMENT, or NIL."
  (let* ((changes (remove-duplicates
                   (loop for condition in (experiment-conditions experiment)
                         for its in parts
                         when (member condition conditions)
                           append (changed-parts-since-run condition its directory))
                   :test #'string= :from-end t))
         (more (- (length changes) +most-changes-shown+)))
    (and changes
         (format nil "~{~A~^, ~}~@[ and ~D more~]"
                 (subseq changes 0 (min +most-changes-shown+ (length changes)))
                 (and (plusp more) more)))))

(defun report-renewal (experiment conditions parts directory copy stream)
  "Say on STREAM that trials of CONDITIONS of EXPERIMENT are run again, and what has changed."
  (let ((others (remove-if (lambda (condition) (member condition conditions))
                           (experiment-conditions experiment))))
    (format stream "~&Code has changed since the trials of ~{~A~^, ~}~@[: ~A~]. They are ~
                    run again~:[~;, the others are not~]. The old table is in ~A.~%"
            (mapcar #'condition-name conditions)
            (changes-text experiment conditions parts directory)
            others (native-name copy))))

(defun renew-changed-rows (experiment parts directory stream)
  "Remove rows of other code of the conditions of EXPERIMENT from the table in DIRECTORY. Keep a
copy of the old table, and say so on STREAM, unless it is NIL. PARTS are the fingerprint parts of
all conditions."
  (let* ((changed (changed-conditions experiment directory))
         (names (mapcar #'condition-name changed)))
    (when changed
      (let ((copy (copy-table directory)))
        (when stream (report-renewal experiment changed parts directory copy stream)))
      ;; The rows last: if this is interrupted, they are still found to be of other code.
      (remove-lines names (machine-file directory) 0)
      (remove-lines names (series-file directory) 2)
      (remove-lines names (rows-file directory) 2))))
