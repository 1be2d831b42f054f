;;;; repeating.lisp -- how to repeat a trial of a check, as a text.

(in-package :ars-magna.fiveam)

;;; WITH-SIMULATION begins with the parameters as they are there, a trial with the manual's. So what
;;; differs is written out; and :CLEAN where that says the same in less.

(defun noiseless-p (parameter value)
  (or (not (eq :noise (parameter-kind parameter)))
      (eql value (parameter-clean parameter))))

(defun clean-p (parameters values)
  "True if VALUES, of PARAMETERS, are without noise, and what they are now is not."
  (and (every #'noiseless-p parameters values)
       (notevery #'noiseless-p parameters (mapcar #'parameter-value parameters))))

(defun settings (check)
  "Return the options of WITH-SIMULATION by which its parameters are those of the trials of CHECK."
  (let* ((parameters (all-parameters))
         (values (coerce (condition-parameters (check-condition check)) 'list))
         (clean (clean-p parameters values))
         (settings (loop for parameter in parameters
                         for value in values
                         unless (or (and clean (eq :noise (parameter-kind parameter)))
                                    (eql value (parameter-value parameter)))
                           collect (list (parameter-symbol parameter) value))))
    (append (and clean '(:clean t))
            (and settings `(:parameters ',settings)))))

(defun text-of (form check)
  "Return FORM as the author of CHECK would write it, on one line if it is short."
  (let* ((text (form-text form (experiment-package (check-experiment check))))
         (line (one-line text)))
    (if (< (length line) 90) line text)))

(defun repetition-text (check result)
  "Return a form, as text, that repeats the trial of CHECK that RESULT is of."
  (let ((robots (check-robots check)))
    (if robots
        (format nil "(~A ~A~%    ~A)" (text-of 'with-simulation check)
                (text-of (list* (if (rest robots) robots (first robots))
                                :seed (result-seed result) (settings check))
                         check)
                (text-of (check-form check) check))
        (format nil "(replay-trial '~A ~S ~D)"
                (text-of (experiment-name (check-experiment check)) check)
                (condition-name (check-condition check)) (result-trial result)))))
