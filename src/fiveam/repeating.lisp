;;;; repeating.lisp -- REPEAT-TRIAL: a trial of a check again, in the open, from its text alone.

(in-package :ars-magna.fiveam)

(export '(repeat-trial))

;;; A check ends in a log that is read elsewhere, perhaps long after. So what it says repeats a
;;; trial in any Lisp that has the same code, whatever has been set there.

(defun replay-subject (subject seed options)
  (unless (integerp seed) (reject-argument 'repeat-trial 'seed seed "an integer"))
  (apply #'replay-trial (experiment-of subject 'repeat-trial (1- seed)) 1 1 options))

(define-user-macro repeat-trial
    (form &rest options
          &key robots (seed 1) parameters clean (limit +usual-limit+)
          until then rate step journal trace)
  "Run the trial with SEED of a check of FORM by IS-SUCCESS-RATE again, the other arguments being
those of the check: the very run that it was, but in the open. It is what a check that fails prints:

  (repeat-trial (run-plan 'fetch-thing '((:color blue)) '((109 24)))
    :robots marvin :seed 7 :parameters ((motion-noise* 0.2)))

UNTIL, THEN, RATE, STEP, JOURNAL and TRACE are as for REPLAY-TRIAL: to see it at a pace, to stop it
in the middle, and so on. Return a plist, and signal errors, as that does; MALFORMED-DEFINITION,
too."
  (declare (ignore until then rate step journal trace))
  `(replay-subject ,(subject-maker "repeat-trial" form robots parameters clean limit) ,seed
                   (list ,@(loop for (key value) on options by #'cddr
                                 unless (member key '(:robots :seed :parameters :clean :limit))
                                   append (list key value)))))

;;; As a text.

(defun text-in (package form)
  "Return FORM as its author, in PACKAGE, would write it, on one line if it is short."
  (let* ((text (form-text form package))
         (line (one-line text)))
    (if (< (length line) 90) line text)))

(defun text-of (form check)
  (text-in (experiment-package (check-experiment check)) form))

(defun literal (value)
  "Return a form that returns VALUE."
  (if (or (consp value) (and (symbolp value) (not (keywordp value)) (not (member value '(t nil)))))
      `',value
      value))

(defun repetition-options (subject seed)
  (let ((robots (subject-robots subject)) (parameters (subject-parameters subject)))
    `(:robots ,(if (rest robots) robots (first robots))
      :seed ,seed
      ,@(unless (= +usual-limit+ (subject-limit subject)) `(:limit ,(subject-limit subject)))
      ,@(when parameters
          `(:parameters ,(loop for (name value) in parameters
                               collect (list name (literal value)))))
      ,@(when (subject-clean subject) '(:clean t)))))

(defun repetition-text (check result)
  "Return a form, as text, that repeats the trial of CHECK that RESULT is of."
  (let ((subject (check-subject check)))
    (flet ((text (form) (text-of form check)))
      (if subject
          (format nil "(~A ~A~%    ~{~A ~A~^ ~})" (text 'repeat-trial) (text (subject-form subject))
                  (mapcar #'text (repetition-options subject (result-seed result))))
          (format nil "(~A '~A ~S ~D)" (text 'replay-trial)
                  (text (experiment-name (check-experiment check)))
                  (condition-name (check-condition check)) (result-trial result))))))
