;;;; known.lisp -- variables known to hold fluents, and vectors of fluents where one is wanted.

(in-package :ars-magna.rpl.fluents)

(export '(declare-fluent-variable known-pulse-p known-fluent-variable-p
          known-vector-variable-p robots-fluent-p))

;;; Of a part of which the robot has several, such as a camera, a variable holds a vector of
;;; fluents. That vector is true, always, and so never what a condition means.

(defvar *known-variables* (make-hash-table :test 'eq :synchronized t)
  "What the variables hold that are known to, a list: the name of a kind of part if a vector of
fluents, one for each part, or T if a fluent; and whether that is pulsed, and never set.")

(defun declare-fluent-variable (name &key (kind t) pulsed-p)
  "Note that the variable NAME holds a fluent, or a vector of fluents for parts of KIND, a string;
and, if PULSED-P is true, that these are never set."
  (setf (gethash name *known-variables*) (list kind pulsed-p)))

(defun known-pulse-p (name)
  "True if what the variable NAME holds is pulsed, and never set."
  (and (symbolp name) (second (gethash name *known-variables*))))

(defun known-fluent-variable-p (name)
  "True if the variable NAME is known to hold a fluent."
  (eq t (first (gethash name *known-variables*))))

(defun known-vector-variable-p (name)
  "Return the name of the kind of part for which the variable NAME holds fluents, or NIL."
  (let ((kind (first (gethash name *known-variables*))))
    (and (stringp kind) kind)))

(defmethod value-behind ((fluent fluent))
  "FLUENT-VALUE returns the value of a fluent.")

(defun fluents-vector-p (object)
  (and (simple-vector-p object)
       (plusp (length object))
       (every #'fluent-p object)))

(defun reject-vector (vector &optional (user "a condition"))
  "Signal MISUSE: VECTOR, of fluents, stands where USER needs a fluent."
  (let* ((name (safe-text (fluent-name (svref vector 0)) :escape nil))
         (variable (subseq name 0 (position #\Space name :from-end t))))
    (reject-use "~A is a vector of fluents: ~A needs one of them. Write (vref ~2:*~A~* ~A)."
                variable user
                (or (known-vector-variable-p (find-known variable)) "index"))))

(defun check-no-vector (object user)
  "Return OBJECT, a vector. Signals MISUSE if it is one of fluents, of which USER needs one."
  (when (fluents-vector-p object) (reject-vector object user))
  object)

(defun find-known (name)
  (loop for variable being the hash-keys of *known-variables*
        when (string-equal name variable) return variable))

(defun robots-fluent-p (fluent)
  "True if FLUENT is called like a known variable, or an element of one: the robot changes it."
  (let* ((name (safe-text (fluent-name fluent) :escape nil)) (space (position #\Space name)))
    (and (find-known (subseq name 0 space)) t)))
