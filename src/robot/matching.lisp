;;;; matching.lisp -- which things fit a description, and what is read of them (manual 3.4.2).

(in-package :ars-magna.robot)

;;; A descriptor specification is a list of (attribute value) or (attribute value threshold). A
;;; thing matches if readings of all those attributes fit; these readings are what is reported.
;;; A thing that says nothing of a boolean attribute counts as having it false; of any other, it
;;; does not match. Attributes that nobody defined are taken by the shape of the value.

(defstruct (demand (:copier nil))
  "One attribute specification: a reading fits if it is a number from LOW to HIGH, or when these
are NIL, if it is one of CHOICES."
  (key nil :type symbol :read-only t)
  (attribute nil :type (or null attribute) :read-only t)
  (low nil :type (or null real) :read-only t)
  (high nil :type (or null real) :read-only t)
  (choices '() :type list :read-only t))

(defun range-p (value)
  (and (consp value) (consp (rest value)) (null (cddr value))
       (realp (first value)) (realp (second value))))

(defun numeric-demand (key attribute value threshold)
  (let ((threshold (or threshold standard-match-threshold*)))
    (multiple-value-bind (low high)
        (if (realp value) (values value value) (values (first value) (second value)))
      (make-demand :key key :attribute attribute
                   :low (- low threshold) :high (+ high threshold)))))

(defun parse-demand (specification)
  (destructuring-bind (name value &optional threshold) specification
    (let* ((key (attribute-key name)) (attribute (find-attribute key)))
      (if (and (or (realp value) (range-p value))
               (not (and attribute (eq (attribute-kind attribute) :discrete))))
          (numeric-demand key attribute value threshold)
          (make-demand :key key :attribute attribute
                       ;; NIL is a value, not a list of none.
                       :choices (if (consp value) value (list value)))))))

(defun parse-specification (specification)
  "Return the demands that the descriptor SPECIFICATION makes."
  (mapcar #'parse-demand specification))

;;; What can be a specification.

(defun possible-value-p (attribute value)
  "True if VALUE, an atom, can be a value of ATTRIBUTE (NIL: an undefined one)."
  (cond ((null attribute) t)
        ((eq (attribute-kind attribute) :discrete)
         (member value (attribute-domain attribute) :test #'value-equal))
        ((eq (attribute-name attribute) :substance) (or (realp value) (symbolp value)))
        (t (realp value))))

(defun demand-form-p (form)
  (and (consp form) (first form) (symbolp (first form))
       (consp (rest form)) (listp (cddr form)) (null (cdddr form))
       (typep (third form) '(or null (real 0)))
       (let ((attribute (find-attribute (first form))) (value (second form)))
         (if (consp value)
             (and (null (cdr (last value)))
                  (or (null attribute)
                      (not (eq (attribute-kind attribute) :numeric))
                      (range-p value)
                      (eq (attribute-name attribute) :substance))
                  (every (lambda (value) (possible-value-p attribute value)) value))
             (possible-value-p attribute value)))))

(defun specification-p (object)
  "True if OBJECT is a descriptor specification (manual 3.4.2): a list of lists (attribute value
[threshold]) with values that the attributes can have."
  (and (listp object) (null (cdr (last object)))
       (every #'demand-form-p object)))

;;; Fitting.

(defun number-of-reading (key reading)
  "Return the number that READING of the attribute KEY is or means, or NIL."
  (cond ((realp reading) reading)
        ((and reading (eq key :substance)) (substance-value-parameter reading))))

(defun fits-p (demand reading)
  "True if READING of a thing's attribute is what DEMAND wants."
  (let ((key (demand-key demand)) (low (demand-low demand)))
    (if low
        (let ((number (number-of-reading key reading)))
          (and number (<= low number (demand-high demand))))
        (member (if (and (consp reading) (eq key :substance))
                    (substance-value-type reading)
                    reading)
                (demand-choices demand) :test #'value-equal))))

(declaim (inline thing-value))
(defun thing-value (thing key)
  (second (assoc key (thing-attributes thing) :test #'eq)))

(defun says-nothing-p (attribute value)
  "True if VALUE, which a thing has for ATTRIBUTE (NIL: an undefined one), means none."
  (and (null value)
       attribute
       (not (member nil (attribute-domain attribute)))))

(defun match-thing (thing demands distance dice)
  "Return true if readings of THING from DISTANCE metres away meet all DEMANDS, and those readings
as an object descriptor."
  (let ((readings '()))
    (dolist (demand demands (values t (nreverse readings)))
      (let* ((key (demand-key demand)) (attribute (demand-attribute demand))
             (value (thing-value thing key)))
        (when (says-nothing-p attribute value) (return nil))
        (let ((reading (read-attribute attribute value distance dice)))
          (unless (fits-p demand reading) (return nil))
          (push (list key reading) readings))))))

;;; What is noticed besides.

(defun notice-probability (attribute keys)
  "Return the probability that ATTRIBUTE is sensed unasked when the attributes KEYS were asked for:
1 - (1-p)^(n+1), n of them being its supporters (manual 3.4.2)."
  (let* ((supporters (attribute-supporters attribute))
         (given (count-if (lambda (key) (member key supporters :test #'eq)) keys)))
    (- 1d0 (expt (- 1d0 (attribute-noticed attribute)) (1+ given)))))

(defun notice-attributes (keys value-of distance dice)
  "Return readings of attributes not among KEYS that happen to be noticed. VALUE-OF, a function of
an attribute, returns its value, and secondly whether there is one."
  (loop for attribute in (all-attributes)
        for key = (attribute-name attribute)
        unless (member key keys :test #'eq)
          append (multiple-value-bind (value present) (funcall value-of attribute)
                   (when (and present (chance (notice-probability attribute keys) dice))
                     (list (list key (read-attribute attribute value distance dice)))))))

(defun describe-thing (thing readings distance dice)
  "Return the description of THING that a search reports: what is noticed, then READINGS."
  (append (notice-attributes (mapcar #'first readings)
                             (lambda (attribute)
                               (let ((value (thing-value thing (attribute-name attribute))))
                                 (values value (not (says-nothing-p attribute value)))))
                             distance dice)
          readings))
