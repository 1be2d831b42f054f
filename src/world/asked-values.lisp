;;;; asked-values.lisp -- what may be asked of an attribute: a value, a range, or any of some.

(in-package :ars-magna.world)

(export '(asking-form-p range-p value-limits discrete-p in-domain-p can-be-false-p asks-range-p))

;;; Robots and manipulations ask in the same words, lists (attribute value [threshold]), manual
;;; 3.4.2 and 5.5.1; but a robot compares with what it senses, a manipulation with what is so.

(defun asking-form-p (form)
  "True if FORM is a list (attribute value) or (attribute value threshold), whatever the values of
that attribute are. A value is an atom or a list that ends, a threshold NIL or not below 0; numbers
are from -1e15 to 1e15."
  (and (proper-list-p form)
       (<= 2 (length form) 3)
       (first form) (symbolp (first form))
       (askable-p (second form))
       (or (null (third form)) (amount-p (third form)))))

(defun askable-p (value)
  "True if VALUE, an atom or a list that ends, has no number in it that is beyond reason."
  (if (consp value)
      (and (proper-list-p value) (every #'askable-p value))
      (or (not (realp value)) (quantity-p value))))

(defun range-p (value)
  "True if VALUE is a range: a list of two numbers, the lower one first."
  (and (number-pair-p value) (<= (first value) (second value))))

(defun value-limits (value)
  "Return the least and the greatest number that VALUE, a number or a list of two, stands for; NIL
for anything else."
  (cond ((realp value) (values value value))
        ((number-pair-p value) (values (first value) (second value)))))

;;; By attribute; NIL is one that nobody has defined.

(defun discrete-p (attribute)
  "True if ATTRIBUTE, or NIL, is known to have one of a list of values."
  (and attribute (eq :discrete (attribute-kind attribute))))

(defun in-domain-p (attribute value)
  "True if VALUE is one of those that ATTRIBUTE, which is discrete, can have."
  (and (member value (attribute-domain attribute) :test #'value-equal) t))

(defun can-be-false-p (attribute)
  "True if for ATTRIBUTE, or NIL, the value NIL means false rather than unspecified."
  (and attribute (member nil (attribute-domain attribute)) t))

(defun asks-range-p (attribute value)
  "True if VALUE, asked for of ATTRIBUTE, or NIL, has the shape of a range and means one, not any
of two values."
  (and (number-pair-p value) (not (discrete-p attribute))))
