;;;; clauses.lisp -- what the checks of all our defining forms have in common.

(in-package :ars-magna.world)

(defun proper-list-p (object)
  (and (listp object) (ignore-errors (list-length object)) (null (cdr (last object)))))

(defun check-options (definition options known)
  "Signal MALFORMED-DEFINITION unless OPTIONS is a plist with keys among KNOWN, each once."
  (unless (and (proper-list-p options) (evenp (length options)))
    (reject-clause definition options
                   (format nil "pairs of an option and its value; options: ~(~{~S~^ ~}~)" known)))
  (loop for (key value) on options by #'cddr
        for seen = '() then (cons last seen) for last = key
        do (unless (member key known)
             (reject-clause definition (list key value)
                            (format nil "one of the options ~(~{~S~^ ~}~)" known)))
           (when (member key seen)
             (reject-clause definition (list key value) "each option only once"))))

(defun check-probability (definition option value)
  "Return VALUE, of OPTION, as a double-float. Signals MALFORMED-DEFINITION."
  (unless (typep value '(real 0 1))
    (reject-clause definition (list option value) "a probability from 0 to 1"))
  (double value))

(defun point-form-p (form)
  "True if FORM is a list of two real numbers."
  (and (proper-list-p form) (= 2 (length form)) (every #'realp form)))

