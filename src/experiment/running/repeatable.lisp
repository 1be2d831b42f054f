;;;; repeatable.lisp -- checking that trials run again give the rows in the table.

(in-package :ars-magna.experiment)

;;; A fingerprint can miss something that affects a trial, such as data that trials share. So trials
;;; are run again and compared with their rows, before an experiment is resumed and at its end.

(defvar *directory-given-p* t "True if the user has given the directory of the rows.")

(defun start-again-advice ()
  (if *directory-given-p* "begin in another directory" "run the experiment again"))

(defun differing-column (columns texts others)
  "Return a list: the first of COLUMNS in which the rows TEXTS and OTHERS differ, its text in
OTHERS, and its text in TEXTS."
  (loop for column in columns
        for text in texts
        for other in others
        unless (string= text other) return (list column other text)))

(defun run-by-worker (experiment condition trial)
  (let ((result nil) (stopped-p nil))
    (flet ((run (worker)
             (declare (ignore worker))
             (call-without-output
              (lambda ()
                (call-with-trial-syntax
                 (lambda ()
                   (setf result (run-trial-in-worker experiment condition trial
                                                     (lambda () stopped-p)))))))))
      (call-by-workers #'run 1 :stop (lambda () (setf stopped-p t))))
    result))

(defun check-trial-repeatable (experiment texts)
  "Signal MISUSE if the trial of EXPERIMENT with TEXTS (see TEXTS-WITH-CHECKSUM) gives another row."
  (let* ((condition (condition-of-texts experiment texts))
         (columns (append (columns experiment) '("series, by its check sum,")))
         (trial (parse-integer (nth (1+ (seed-column columns)) texts)))
         (result (run-by-worker experiment condition trial))
         (again (texts-with-checksum (result-texts experiment result) experiment
                                     (series-text experiment result))))
    (unless (equal texts again)
      (reject-use "Trial ~D of the condition ~A has a row already, and comes out differently now: ~
                   ~{its ~A is ~A, and ~A in the table~}. Either the row has been changed, or ~
                   something that is not in the fingerprint affects the trial, such as a ~
                   variable that trials set (define it by DEFINE-RUN-VARIABLE instead), an object ~
                   or closure that trials change, a random state, the clock, a file, or a ~
                   function of SBCL that differs in another version. Correct that, and ~A."
                  trial (condition-name condition) (differing-column columns texts again)
                  (start-again-advice)))))

(defparameter *seconds-for-checks* 10
  "How many seconds an experiment that resumes spends on checking rows by running trials again.")

(defun check-rows-repeatable (experiment rows seconds)
  "Signal MISUSE if a trial of ROWS, rows of different conditions of EXPERIMENT, now gives another
row. Check at least one trial, and more trials until SECONDS have passed."
  (loop with begun = (real-microseconds)
        for texts in rows
        do (check-trial-repeatable experiment texts)
        until (> (seconds-since begun) seconds)))

(defun fingerprint-part-name (part)
  (format nil "~(~A~) ~A" (first part) (second part)))

(defun name-without-package (name)
  (subseq name (1+ (or (position #\: name) -1))))

(defun sharing-advice (changed condition)
  "CHANGED are the fingerprint parts that trials of CONDITION have changed. Return advice if they
contain a variable or a function; else NIL."
  (flet ((name (kind) (second (find kind changed :key #'first))))
    (let ((variable (name :variable)) (function (name :function)))
      (cond (variable
             (format nil "~:[No trial can bind the global variable ~A: define it with DEFVAR ~
                          instead. ~;~*~]If trials change what ~A holds, give each trial its own ~
                          value: (:run (let ((~:*~A ...)) ...))."
                     (find variable (condition-variables condition)
                           :key (lambda (bound) (qualified-symbol-name (first bound)))
                           :test #'string=)
                     (name-without-package variable) (name-without-package variable)))
            (function
             (format nil "If trials replace ~A, or store data in it for other trials, keep the ~
                          data in a variable, which each trial binds."
                     (name-without-package function)))))))

(defun check-code-unchanged (experiment parts directory)
  (loop for condition in (experiment-conditions experiment)
        for before in parts
        for weak = (condition-weak-parts condition)
        for now = (prepare-condition experiment condition)
        for added = (loop for part being the hash-keys of (condition-weak-parts condition)
                          unless (gethash part weak) collect part)
        unless (and (equal before now) (null added))
          do (call-recording-refused-rows
              (lambda ()
                (reject-changed (set-exclusive-or before (append added now) :test #'equal)
                                condition directory))
              directory)))

(defun reject-changed (changed condition directory)
  (reject-use "Code or data changed while the experiment ran: ~{~A~^, ~}. The rows~@[ in ~
               ~A~] may be from before or after the change. ~@[~A ~]~@(~A~)."
              (remove-duplicates (mapcar #'fingerprint-part-name changed) :test #'string=)
              (and *directory-given-p* (native-name directory))
              (sharing-advice changed condition)
              (start-again-advice)))

(defun call-recording-refused-rows (function directory)
  "Call FUNCTION. If FUNCTION signals MISUSE, record in DIRECTORY that the rows there were refused."
  (handler-bind ((misuse (lambda (condition)
                           (record-refusal directory (princ-to-string condition)))))
    (funcall function)))

(defun check-finished-run (store parts seconds)
  "Signal MISUSE if the experiment of STORE no longer has the fingerprint PARTS, or a trial gives
another row now. The run took SECONDS. The check lasts a twentieth of SECONDS, or one trial."
  (let ((experiment (store-experiment store)))
    (check-code-unchanged experiment parts (store-path store))
    (call-recording-refused-rows
     (lambda ()
       (check-rows-repeatable experiment
                              (loop for condition in (experiment-conditions experiment)
                                    for texts = (gethash condition (store-samples store))
                                    when texts collect texts)
                              (/ seconds 20)))
     (store-path store))))
