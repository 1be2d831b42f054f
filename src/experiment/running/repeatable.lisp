;;;; repeatable.lisp -- whether trials come out again as their rows say.

(in-package :ars-magna.experiment)

;;; A fingerprint is a guess at what decides a trial. What it misses, such as what trials leave to
;;; each other, is found by running one of them again, before an experiment goes on and at its end.

(defvar *directory-given-p* t "True if the rows are kept in a directory that the user has given.")

(defun way-to-begin-again ()
  (if *directory-given-p* "begin in another directory" "run the experiment again"))

(defun differing-column (columns texts others)
  "Return the name of the first of COLUMNS in which the rows TEXTS and OTHERS differ, and both texts
there."
  (loop for column in columns
        for text in texts
        for other in others
        unless (string= text other) return (list column other text)))

(defun run-by-worker (experiment condition trial)
  (let ((result nil) (stopped-p nil))
    (flet ((run (worker)
             (declare (ignore worker))
             (call-in-silence
              (lambda ()
                (call-plainly
                 (lambda ()
                   (setf result (run-guarded experiment condition trial
                                             (lambda () stopped-p)))))))))
      (call-by-workers #'run 1 :stop (lambda () (setf stopped-p t))))
    result))

(defun check-repeatable (experiment texts)
  "Signal MISUSE if the trial of EXPERIMENT whose row is TEXTS comes out otherwise now. See
TEXTS-WITH-MARK."
  (let* ((condition (condition-of-texts experiment texts))
         (columns (append (columns experiment) '("series, by its check sum,")))
         (trial (parse-integer (nth (1+ (seed-column columns)) texts)))
         (result (run-by-worker experiment condition trial))
         (again (texts-with-mark (result-texts experiment result) experiment
                                 (series-text experiment result))))
    (unless (equal texts again)
      (reject-use "Trial ~D of the condition ~A has a row already, and comes out differently now: ~
                   ~{its ~A is ~A, and ~A in the table~}. Either the row has been changed, or ~
                   something that is not in the fingerprint decides the trial, such as an object ~
                   or closure that trials change, the clock, a file, or a function of SBCL's that ~
                   another version of it has otherwise. Mend that, and ~A."
                  trial (condition-name condition) (differing-column columns texts again)
                  (way-to-begin-again)))))

(defparameter *seconds-for-checks* 10
  "For how long trials that have rows are run again before an experiment goes on.")

(defun check-samples (experiment rows seconds)
  "Signal MISUSE if one of ROWS, of different conditions of EXPERIMENT, comes out otherwise now. At
least one is tried, and others as long as less than SECONDS have passed."
  (loop with begun = (real-microseconds)
        for texts in rows
        do (check-repeatable experiment texts)
        until (> (seconds-since begun) seconds)))

(defun part-name (part)
  (format nil "~(~A~) ~A" (first part) (second part)))

(defun without-package (name)
  (subseq name (1+ (or (position #\: name) -1))))

(defun sharing-advice (changed condition)
  "Return what to do if CHANGED, the parts that trials of CONDITION changed, has a variable or else
a function; or NIL."
  (flet ((name (kind) (second (find kind changed :key #'first))))
    (let ((variable (name :variable)) (function (name :function)))
      (cond (variable
             (format nil "~:[No trial can bind the global variable ~A: define it with DEFVAR ~
                          instead. ~;~*~]If trials change what ~A holds, give each its own: ~
                          (:run (let ((~:*~A ...)) ...))."
                     (find variable (condition-variables condition)
                           :key (lambda (bound) (qualified (first bound))) :test #'string=)
                     (without-package variable) (without-package variable)))
            (function
             (format nil "If trials replace ~A, or leave something in it for others, keep that in ~
                          a variable, which each trial binds." (without-package function)))))))

(defun check-unchanged (experiment parts directory)
  (loop for condition in (experiment-conditions experiment)
        for before in parts
        for weak = (condition-weak-parts condition)
        for now = (prepare-condition experiment condition)
        for added = (loop for part being the hash-keys of (condition-weak-parts condition)
                          unless (gethash part weak) collect part)
        unless (and (equal before now) (null added))
          do (call-noting-refusal
              (lambda ()
                (reject-changed (set-exclusive-or before (append added now) :test #'equal)
                                condition directory))
              directory)))

(defun reject-changed (changed condition directory)
  (reject-use "Code or data have been changed while the experiment ran: ~{~A~^, ~}. The rows~@[ in ~
               ~A~] may be of either. ~@[~A ~]~@(~A~)."
              (remove-duplicates (mapcar #'part-name changed) :test #'string=)
              (and *directory-given-p* (native-name directory))
              (sharing-advice changed condition)
              (way-to-begin-again)))

(defun call-noting-refusal (function directory)
  "Call FUNCTION. If it signals MISUSE, the text in DIRECTORY says from then on that the rows beside
it were refused."
  (handler-bind ((misuse (lambda (condition)
                           (note-refusal directory (princ-to-string condition)))))
    (funcall function)))

(defun check-run-again (store parts seconds)
  "Signal MISUSE if what was kept in STORE, in so many SECONDS, cannot be had again: if its
experiment, of PARTS, is no longer what it was, or a trial comes out otherwise. This takes a
twentieth of that time, or one trial."
  (let ((experiment (store-experiment store)))
    (check-unchanged experiment parts (store-path store))
    (call-noting-refusal
     (lambda ()
       (check-samples experiment
                      (loop for condition in (experiment-conditions experiment)
                            for texts = (gethash condition (store-samples store))
                            when texts collect texts)
                      (/ seconds 20)))
     (store-path store))))
