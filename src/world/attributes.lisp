;;;; attributes.lisp -- what can be said of a thing, and how well it can be sensed.

(in-package :ars-magna.world)

(export '(attribute define-attribute declared-attribute built-in-attribute-p attribute-key
          *attributes* specification-clause-p range-p value-limits discrete-p in-domain-p
          can-be-false-p specifies-range-p))

;;; An attribute is discrete, with a list of possible values, or numeric. Undeclared attributes may
;;; be stored and matched, but are only sensed when asked for. Manual 3.3, 3.4.2 and 5.4.

(addition attribute-p)
(define-record (attribute (:constructor make-attribute))
  "An attribute of things: its possible values and sensing parameters."
  (name nil symbol "the keyword that names the attribute" :addition)
  (kind :discrete (member :discrete :numeric) ":discrete or :numeric" :addition)
  (domain '() list "the list of possible values of a discrete attribute; NIL if numeric" :addition)
  (success 1d0 double-float "the base probability that a discrete reading is correct" :addition)
  (base 0d0 double-float "the base standard deviation of numeric readings" :addition)
  (max-mult 1d0 double-float "the largest multiplier of the base deviation, far away" :addition)
  (noticed 0d0 double-float "the base probability that the attribute is sensed unasked" :addition)
  (supporters '() list "the keywords of the attributes that support this one" :addition))

(defmethod print-object ((attribute attribute) stream)
  (print-unreadable-object (attribute stream :type t)
    (format stream "~(~S~)" (attribute-name attribute))))

(define-registry attribute "attribute" :object-p attribute-p :sealed t)

(declaim (inline attribute-key))
(defun attribute-key (name)
  "Return the keyword for the attribute named NAME, a symbol."
  (if (keywordp name) name (make-keyword (name-string name))))

(defun declared-attribute (name)
  "Return the attribute named NAME, a symbol, or NIL if NAME is undeclared."
  (loop with key = (attribute-key name)
        for attribute in (registry-objects *attributes*)
        when (eq key (attribute-name attribute)) return attribute))

(defun declared-name-like (name)
  "NAME is not declared. Return the declared name that it probably misspells, or NIL."
  (let ((key (attribute-key name)))
    (unless (or (declared-attribute key) (eq key :draw-function))
      (find-if (lambda (other) (misspelling-p key other))
               (cons :draw-function (defined-names *attributes*))))))

;;; Defining.

(defun check-domain (definition domain)
  (cond ((and (consp domain) (eq 'quote (first domain)))
         (reject-clause definition domain
                        "an unquoted list of the values, because the list is not evaluated"))
        ((and (consp domain) (null (rest domain)) (symbolp (first domain))
              (same-name-p (first domain) 'numeric))
         (reject-clause definition domain "NUMERIC without parentheses"))
        ((not (or (and (symbolp domain) domain (same-name-p domain 'numeric))
                  (and (consp domain) (proper-list-p domain))))
         (reject-clause definition domain "NUMERIC or a list of the possible values"))))

(defun check-attribute-clauses (definition domain base max-mult supported-by)
  (check-domain definition domain)
  (loop for (option value) in `((:base ,base) (:max-mult ,max-mult))
        unless (amount-p value)
          do (reject-clause definition (list option value) (argument-type-text 'amount)))
  (unless (and (proper-list-p supported-by) (every #'symbolp supported-by))
    (reject-clause definition (list :supported-by supported-by) "a list of attribute names")))

(defvar *built-in-attributes* '()
  "The names of the attributes in the manual's table 3.3, which every thing has.")

(defun built-in-attribute-p (attribute)
  "True if ATTRIBUTE is one of the manual's attributes. Every thing has these, at least by default."
  (member (attribute-name attribute) *built-in-attributes* :test #'eq))

(defun check-kind-of-built-in (definition name domain)
  "Signal MALFORMED-DEFINITION if NAME is a built-in attribute and DOMAIN is of the other kind,
discrete or numeric."
  (let ((old (declared-attribute name)))
    (when (and old (built-in-attribute-p old)
               (not (eq (attribute-kind old) (if (consp domain) :discrete :numeric))))
      (reject-clause definition domain
                     (format nil "a ~(~A~) attribute, because the simulator computes with ~(~S~)"
                             (attribute-kind old) (attribute-name old))))))

;;; Programs read and set attributes often, so the declared name that another one resembles is
;;; cached. Names of undeclared attributes that a thing has are compared, too.

(define-global *likenesses* (make-hash-table :test 'eq :synchronized t)
  "A table from undeclared names to the names that they probably misspell, or to NIL.")

(define-global *misspellings* (make-hash-table :test 'eq :synchronized t)
  "A table from names of attributes of new things to the values of FIND-MISSPELLING.")

(defun define-attribute (name domain &key (success 1) (base 0) (max-mult 1) (noticed 0)
                                       supported-by)
  "Define or redefine the attribute NAME for DEFATTRIBUTE, and return NAME (reading 120)."
  (let ((definition (definition-title "defattribute" name))
        (old (declared-attribute name)))
    (check-attribute-clauses definition domain base max-mult supported-by)
    (when (eq (attribute-key name) :draw-function)
      (reject-clause definition name
                     (format nil "another name, because the simulator itself defines ~
                                  :draw-function; give this attribute to things: ~
                                  (set-attribute thing :draw-function 'name)")))
    (check-kind-of-built-in definition name domain)
    (dolist (supporter supported-by)
      (let ((like (declared-name-like supporter)))
        (when like
          (warn-of-definition "~A: no attribute is called ~(~S~); did you mean ~(~S~)?"
                              definition supporter like))))
    (register
     *attributes* (attribute-key name)
     (make-attribute :name (attribute-key name)
                     :kind (if (consp domain) :discrete :numeric)
                     :domain (if (consp domain) domain '())
                     :success (checked-probability definition :success success)
                     :base (double base) :max-mult (double max-mult)
                     :noticed (checked-probability definition :noticed noticed)
                     :supporters (mapcar #'attribute-key supported-by)))
    (clrhash *likenesses*)
    (clrhash *misspellings*)
    (when old (warn-of-unfit-recipes (declared-attribute name)))
    name))

(defun warn-of-attribute-options (definition domain options)
  "Warn if OPTIONS has :base or :max-mult for a list DOMAIN, or :success without :base for NUMERIC."
  (flet ((given-p (option) (nth-value 2 (get-properties options (list option)))))
    (let ((strange (if (consp domain)
                       (find-if #'given-p '(:base :max-mult))
                       ;; Numeric attributes may have symbols as values, for which :success is.
                       (and (not (given-p :base)) (given-p :success) :success))))
      (when strange
        (warn-of-style "~A: ~(~S~) is for ~:[readings that are right or wrong; without :base, ~
                        numbers are read exactly~;numbers; the option for values in a list is ~
                        :success~]."
                       definition strange (consp domain))))))

(defun attribute-forms (name domain options)
  "Return the forms that DEFATTRIBUTE expands to (reading 119)."
  (let ((definition (definition-title "defattribute" name)))
    (unless (and name (symbolp name))
      (reject-clause definition name "a symbol as the name of the attribute"))
    (check-domain definition domain)
    (check-options definition options
                   '(:success :base :max-mult :noticed :support :supported-by :documentation))
    (warn-of-attribute-options definition domain options)
    (destructuring-bind (&key (success 1) (base 0) (max-mult 1) (support 0) (noticed support)
                           supported-by &allow-other-keys)
        options
      `((define-attribute ',name ',domain :success ,success :base ,base :max-mult ,max-mult
                                          :noticed ,noticed :supported-by ',supported-by)))))

(public defattribute numeric)
(define-user-macro defattribute (&whole form name &optional domain &body options
                                 &environment environment)
  "Define the attribute NAME, a keyword by convention (manual 5.4). DOMAIN is NUMERIC or a list
of the possible values, unevaluated. Options, in any order:
  :success p -- base probability that a discrete reading is correct; default 1
  :base deviation -- base standard deviation of numeric readings; default 0
  :max-mult factor -- the largest multiplier of the base deviation, reached far away; default 1
  :noticed p (or :support p) -- base probability of being sensed without request; default 0
  :supported-by (name...) -- attributes that, when asked for, raise the probability :noticed
  :documentation text -- an addition: what the attribute is
Signals MALFORMED-DEFINITION. Return the name."
  (expand-definition form environment (lambda () (attribute-forms name domain options))))

;;; A specification asks for a value, a range, or any of several values. Robots (manual 3.4.2) and
;;; manipulations (5.5.1) use the same lists (attribute value [threshold]). A robot compares them
;;; with what it senses, a manipulation with the true values.

(defun specification-clause-p (form)
  "True if FORM is a list (attribute value) or (attribute value threshold). The value is an atom or
a proper list, and is not compared with the attribute's domain. The threshold is NIL or a number not
below 0. Numbers are from -1e15 to 1e15."
  (and (proper-list-p form)
       (<= 2 (length form) 3)
       (first form) (symbolp (first form))
       (specifiable-value-p (second form))
       (or (null (third form)) (amount-p (third form)))))

(defun specifiable-value-p (value)
  "True if VALUE, an atom or a proper list, contains no number beyond +-1e15."
  (if (consp value)
      (and (proper-list-p value) (every #'specifiable-value-p value))
      (or (not (realp value)) (bounded-number-p value))))

(defun range-p (value)
  "True if VALUE is a range: a list of two numbers, the lower one first."
  (and (number-pair-p value) (<= (first value) (second value))))

(defun value-limits (value)
  "Return the least and greatest number in VALUE, a number or a list of two; NIL for other values."
  (cond ((realp value) (values value value))
        ((number-pair-p value) (values (first value) (second value)))))

;;; Functions by attribute; NIL is an undeclared one.

(defun discrete-p (attribute)
  "True if ATTRIBUTE is discrete. ATTRIBUTE is NIL for an undeclared attribute."
  (and attribute (eq :discrete (attribute-kind attribute))))

(defun in-domain-p (attribute value)
  "True if VALUE is in the domain of ATTRIBUTE, which is discrete."
  (and (member value (attribute-domain attribute) :test #'value-equal) t))

(defun can-be-false-p (attribute)
  "True if NIL as a value of ATTRIBUTE (NIL if undeclared) means false, not unspecified."
  (and attribute (member nil (attribute-domain attribute)) t))

(defun specifies-range-p (attribute value)
  "True if VALUE, a value in a specification of ATTRIBUTE, is a range rather than a list of
alternatives. ATTRIBUTE is NIL for an undeclared attribute."
  (and (number-pair-p value) (not (discrete-p attribute))))

(define-facts (attribute attribute)
  "Values" (if (eq :numeric (attribute-kind attribute))
               "numbers"
               (comma-separated (attribute-domain attribute)))
  "Chance of a right reading" (and (eq :discrete (attribute-kind attribute))
                                   (attribute-success attribute))
  "Standard deviation of readings" (and (eq :numeric (attribute-kind attribute))
                                        (format nil "~A nearby, far away at most ~A times as much"
                                                (attribute-base attribute)
                                                (attribute-max-mult attribute)))
  "Chance of being sensed unasked" (attribute-noticed attribute)
  "Sensed more often together with" (comma-separated (attribute-supporters attribute)))
