;;;; repeating.lisp -- how to repeat a trial of a check, as a text.

(in-package :ars-magna.fiveam)

;;; WITH-SIMULATION begins with the parameters as they are there, a trial with the manual's. So what
;;; differs is written out; and :CLEAN where that says the same in less.

(defun settings-text (check)
  "Return the arguments of WITH-SIMULATION by which its parameters are those of the trials of CHECK."
  (let* ((parameters (all-parameters))
         (values (coerce (condition-parameters (check-condition check)) 'list))
         (clean (clean-p parameters values))
         (settings (loop for parameter in parameters
                         for value in values
                         unless (or (and clean (eq :noise (parameter-kind parameter)))
                                    (eql value (parameter-value parameter)))
                           collect (list (parameter-symbol parameter) value))))
    (format nil "~:[~; :clean t~]~@[ :parameters '~A~]" clean
            (and settings (text-of settings check)))))

(defun clean-p (parameters values)
  "True if VALUES, of PARAMETERS, are without noise, and what they are now is not."
  (flet ((noiseless-p (parameter value)
           (or (not (eq :noise (parameter-kind parameter)))
               (eql value (parameter-clean parameter)))))
    (and (every #'noiseless-p parameters values)
         (notevery #'noiseless-p parameters (mapcar #'parameter-value parameters)))))

(defun text-of (form check)
  (form-text form (experiment-package (check-experiment check))))

(defun repetition-text (check result)
  "Return a form, as text, that repeats the trial of CHECK that RESULT is of."
  (if (check-robots check)
      (format nil "(with-simulation (~A :seed ~D~A)~%  ~A)" (text-of (check-robots check) check)
              (result-seed result) (settings-text check) (text-of (check-form check) check))
      (format nil "(replay-trial '~A ~S ~D)"
              (text-of (experiment-name (check-experiment check)) check)
              (condition-name (check-condition check)) (result-trial result))))
