;;;; measure-lines.lisp -- MEASURE: the values of measures now.

(in-package :ars-magna.cli)

(defun find-measure-typed (name)
  (or (find-measure name nil)
      (reject-line "There is no measure ~A~@[; did you mean ~A?~]~:*~:[.~;~] ~:[No measures are ~
                    defined: (defmeasure NAME form) defines one~;MEASURE lists all measures~]."
                   name (nearest-name name (measure-names)) (measure-names))))

(defun measures-of-trial (session)
  "Return the measures of the experiment of the trial that SESSION is in, or is in a fork of."
  (let ((trial (or (session-trial session) (session-forked-trial session))))
    (and trial
         (loop for (name) in (experiment-measures (open-trial-experiment trial))
               for measure = (find-measure name nil)
               when measure collect measure))))

(defun measures-here ()
  "Return all measures, except those of testbeds in which the robot of the prompt does not play."
  (let ((others (loop for testbed in (all-testbeds)
                      unless (member *prompt-robot* (testbed-robots testbed))
                        append (testbed-measures testbed))))
    (remove-if (lambda (measure) (member measure others)) (all-measures))))

(defun measures-typed (name session)
  "Return the measures that NAME means in SESSION: one, or those to show if NAME is NIL. Those of a
trial come first; several testbeds may have measures of the same name. Signals BAD-LINE."
  (let ((own (measures-of-trial session)))
    (if name
        (list (or (find name own :key #'measure-name :test #'string-equal)
                  (find-measure-typed name)))
        (or own (measures-here)))))

(defun read-measure (measure)
  "Return the value of MEASURE, and NIL; or NIL and the text of the error that its forms signalled."
  (handler-case (values (measure-value measure) nil)
    (error (condition) (values nil (one-line-text condition)))))

(defun write-measure (measure)
  (multiple-value-bind (value trouble) (read-measure measure)
    (write-trimmed-line "~20A ~A" (string-downcase (measure-name measure))
                        (if trouble (format nil "Error: ~A" trouble) (fact-text value)))))

(defun measure-for-json (measure)
  (multiple-value-bind (value trouble) (read-measure measure)
    (list :name (string-downcase (measure-name measure))
          :value (cond ((typep value '(or real boolean)) value)
                       (t (fact-text value)))
          :error trouble)))

(define-line "MEASURE" (session (name :measure "a measure" :optional))
    (:seeing
     "(defmeasure NAME form) defines a measure. PLOT NAME plots it over time, and PICTURE file NAME
writes its value above the picture.")
    "Show the values that measures have now. In Lisp: (measure-value NAME). Without NAME, show those
of the trial that you are in, or else all, except those of testbeds in which the robot does not
play."
  (let ((measures (measures-typed name session)))
    (current-simulation)
    (with-time-stopped
      (cond ((report-object (session-account session) "measures"
                            :measures (map 'vector #'measure-for-json measures)))
            (measures (mapc #'write-measure measures))
            (t (format t "No measures are defined. (defmeasure NAME form) defines one.~%"))))))

(define-argument-choices :measure (measure-names))
