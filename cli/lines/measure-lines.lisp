;;;; measure-lines.lisp -- MEASURE: the values of measures now.

(in-package :ars-magna.cli)

(defun find-measure-typed (name)
  (or (find-measure name nil)
      (reject-line "There is no measure ~A~@[; did you mean ~A?~]~:*~:[.~;~] ~:[No measures are ~
                    defined: (defmeasure NAME form) defines one~;MEASURE lists all measures~]."
                   name (nearest-name name (measure-names)) (measure-names))))

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

(define-line "MEASURE" (session (name :measure "a measure; all measures if left out" :optional))
    (:seeing
     "(defmeasure NAME form) defines a measure. PLOT NAME plots it over time, and PICTURE file NAME
writes its value above the picture.")
    "Show the values that measures have now. In Lisp: (measure-value NAME)."
  (let ((measures (if name (list (find-measure-typed name)) (all-measures))))
    (current-simulation)
    (with-time-stopped
      (cond ((report-object (session-account session) "measures"
                            :measures (map 'vector #'measure-for-json measures)))
            (measures (mapc #'write-measure measures))
            (t (format t "No measures are defined. (defmeasure NAME form) defines one.~%"))))))

(define-argument-choices :measure (measure-names))
