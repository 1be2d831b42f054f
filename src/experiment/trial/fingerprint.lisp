;;;; fingerprint.lisp -- one number for all that decides the trials of a condition.

(in-package :ars-magna.experiment)

(export '(settle-fingerprints prepare-condition))

;;; The parts of a fingerprint are lists (kind name number): the experiment's own text, the values
;;; of the condition, the simulator, what the journal of such a run would have, and what the forms
;;; can reach. Rows whose fingerprints are equal come from the same function of the seed, as far as
;;; can be told; a second start of an experiment tries it on a trial that it finds. What else stands
;;; in the files that those parts are from may decide them, too, but for other experiments.

(defparameter *file-digests* (make-hash-table :test 'equal :synchronized t)
  "Numbers of files by name: those that a saved Lisp was made of may be gone when it runs.")

(defvar *digests-settled-p* nil
  "True in a Lisp that was saved with its experiments: what becomes of their files is no matter.")

(defun short-name (file)
  (name-in-directory (native-path file)))

(defun digest-of-file (file written)
  "Return a number for the code in FILE, which was loaded as WRITTEN at that time. Signals MISUSE if
it has been changed since."
  (let ((now (ignore-errors (file-write-date (native-path file)))))
    (cond ((and *digests-settled-p* (gethash file *file-digests*)))
          ((and now (or (null written) (= now written)))
           (setf (gethash file *file-digests*) (file-digest (native-path file) "defexperiment")))
          ((gethash file *file-digests*))
          (now (reject-use "~A has been changed since it was loaded. Load it again, so that what ~
                            runs is what it says."
                           file))
          (t 0))))

(defun file-parts (files)
  "Return a part for each name among FILES, lists (file written)."
  (let ((parts '()))
    (loop for (file written) in files
          for part = (find (short-name file) parts :key #'second :test #'string=)
          for number = (digest-of-file file written)
          ;; Those of Lisp's own are not there.
          do (cond ((zerop number))
                   (part (setf (third part) (ldb (byte 64 0) (+ number (third part)))))
                   (t (push (list :file (short-name file) number) parts))))
    parts))

(defun configuration-parts (experiment condition)
  (list (list :simulator *simulator-version* *simulator-digest*)
        (list :experiment (string-downcase (experiment-name experiment))
              (form-digest (experiment-deciding experiment)))
        (list :condition (condition-name condition)
              (data-number (list (condition-robots condition)
                                 (condition-thinking condition)
                                 (coerce (condition-parameters condition) 'list)
                                 (condition-arguments condition))))))

(defun definitions-in-trial (experiment condition)
  "Return the definitions that the run of a trial of CONDITION begins with; see src/run."
  (call-in-trial (lambda () (definitions-of (current-simulation))) experiment condition 1))

(defun entries-of (definitions)
  (loop for definition in definitions
        for entry = (definition-entry definition)
        when entry collect entry))

(defun definitions-without-entry (definitions)
  "Return those of DEFINITIONS that nothing else stands for: manipulations, what is undefined."
  (remove-if (lambda (definition)
               (or (eq :file (first definition)) (definition-entry definition)))
             definitions))

(defun reach-of (experiment condition definitions)
  (let ((reach (make-reach)))
    (dolist (entry (entries-of definitions)) (visit-definition entry reach))
    (dolist (function (list* (experiment-run experiment) (experiment-until experiment)
                             (experiment-success experiment)
                             (mapcar #'second (append (experiment-measures experiment)
                                                      (experiment-series experiment)))))
      (visit function reach))
    (visit (experiment-deciding experiment) reach)
    (visit (mapcar #'second (condition-settings condition)) reach)
    reach))

(defun fingerprint-parts (experiment condition)
  "Return the parts of the fingerprint of CONDITION of EXPERIMENT, in order, and what its trials can
reach."
  (let* ((definitions (definitions-in-trial experiment condition))
         (reach (reach-of experiment condition definitions)))
    (values
     (sort (remove-duplicates (append (configuration-parts experiment condition)
                                      (reach-parts reach)
                                      (definitions-without-entry definitions)
                                      (file-parts (reach-files reach)))
                              :test #'equal)
           #'string< :key #'part-text)
     reach)))

(defun part-text (part)
  (destructuring-bind (kind name number) part
    (format nil "~(~A~) ~A ~16,'0X" kind (plain-text (princ-to-string name))
            (if (integerp number) number (text-checksum (princ-to-string number))))))

(defun fingerprint-of (parts)
  (format nil "~16,'0X"
          (let ((digest (make-digest)))
            (dolist (part parts)
              (loop for char across (part-text part) do (digest-add digest char)))
            (digest-value digest))))

(defun note-reach (condition reach)
  (setf (condition-variables condition)
        (loop for symbol in (reach-variables reach)
              collect (list symbol (global-value symbol)))
        (condition-weak-parts condition) (reach-weak-parts reach)))

(defun look-up-fingerprint (experiment condition)
  "Give CONDITION of EXPERIMENT its fingerprint, and what else its trials need. Return the parts of
the fingerprint."
  (multiple-value-bind (parts reach) (fingerprint-parts experiment condition)
    (note-reach condition reach)
    (setf (condition-fingerprint condition) (fingerprint-of parts))
    parts))

(defun prepare-condition (experiment condition)
  "Do as LOOK-UP-FINGERPRINT, whatever reader and printer are set to."
  (call-plainly (lambda () (look-up-fingerprint experiment condition))))

(defun prepare-trials (experiment condition)
  "Give CONDITION of EXPERIMENT what its trials need, but no fingerprint: its files may have been
changed."
  (call-plainly
   (lambda ()
     (note-reach condition
                 (reach-of experiment condition (definitions-in-trial experiment condition))))))

(defun prepare-experiment (experiment)
  "Give the conditions of EXPERIMENT their fingerprints. Signals MISUSE if a file is not as it was
loaded, and what the making of its worlds signals."
  (dolist (condition (experiment-conditions experiment) experiment)
    (prepare-condition experiment condition)))

(defun settle-fingerprints ()
  "Let what the experiments' files say now be what their fingerprints say from now on, whatever
becomes of the files: for a Lisp that is saved with all that is in it. Signals MISUSE if a file is
not as it was loaded."
  (mapc #'prepare-experiment (all-experiments))
  (setf *digests-settled-p* t))
