;;;; status-data.lisp -- what STATUS tells other programs: what (status) returns, as JSON has it.

(in-package :ars-magna.cli)

;;; In Lisp NIL is nothing, false and the empty list, and a list may be a property list or not. So
;;; here is said by their keys what the values are, where a program could not tell.

(defparameter *keys-of-objects*
  '(:cameras :hands :bins :sensors :under-way :interrupted :designators)
  "The keys whose values are lists of property lists.")

(defparameter *keys-of-lists* '(:view :contents :slots :data)
  "The keys whose values are lists, which may be empty.")

(defparameter *keys-of-truths* '(:live :closed)
  "The keys whose values are true or false.")

(defun arrays-for-lists (value)
  (if (and (consp value) (null (cdr (last value))))
      (map 'vector #'arrays-for-lists value)
      value))

(defun value-for-json (key value)
  (cond ((member key *keys-of-objects*) (map 'vector #'object-for-json value))
        ((member key *keys-of-truths*) (if value t :false))
        ((and (eq key :failed) value) (object-for-json value))
        ((and (member key *keys-of-lists*) (null value)) #())
        (t (arrays-for-lists value))))

(defun object-for-json (plist)
  "Return PLIST with values that WRITE-JSON takes for what they are."
  (loop for (key value) on plist by #'cddr
        collect key
        collect (value-for-json key value)))

(defun report-status (session robot)
  "Report how ROBOT is, whose world stands still, if SESSION reports by objects. True if it does."
  (let ((account (session-account session)))
    (when (reports-p account)
      (apply #'report-object account "status"
             (object-for-json (printing-plainly () (status robot)))))))
