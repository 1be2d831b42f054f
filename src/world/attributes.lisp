;;;; attributes.lisp -- what can be said of a thing, and how well it can be sensed.

(in-package :ars-magna.world)

;;; An attribute is discrete, with a list of possible values, or numeric. Attributes that
;;; nobody defined may be stored and matched but are never sensed unasked. Manual 3.3, 3.4.2
;;; and 5.4.

(defstruct (attribute (:constructor make-attribute) (:copier nil))
  "What is known of an attribute of things: its possible values and sensing parameters."
  (name nil :type symbol :read-only t)
  (kind :discrete :type (member :discrete :numeric) :read-only t)
  (domain '() :type list :read-only t)
  (success 1d0 :type double-float :read-only t)
  (base 0d0 :type double-float :read-only t)
  (max-mult 1d0 :type double-float :read-only t)
  (noticed 0d0 :type double-float :read-only t)
  (supporters '() :type list :read-only t))

(addition attribute-p attribute-name attribute-kind attribute-domain attribute-success
          attribute-base attribute-max-mult attribute-noticed attribute-supporters)
(document-functions
 attribute-p "True of an attribute."
 attribute-name "Return the keyword that the attribute is called."
 attribute-kind "Return :discrete or :numeric."
 attribute-domain "Return the list of possible values of a discrete attribute; NIL if numeric."
 attribute-success "Return the base probability that a discrete reading is correct."
 attribute-base "Return the base standard deviation of numeric readings."
 attribute-max-mult "Return the largest multiplier of that deviation, far away."
 attribute-noticed "Return the base probability that the attribute is sensed unasked."
 attribute-supporters "Return the keywords of the attributes that support this one.")

(defvar *attributes* '() "All attributes, in order of definition.")

(declaim (inline attribute-key))
(defun attribute-key (name)
  "Return the keyword that stands for the attribute called NAME, a symbol."
  (if (keywordp name) name (make-keyword (name-string name))))

(addition find-attribute)
(defun find-attribute (name)
  "Return the attribute called NAME, a symbol, or NIL if nobody has defined it."
  (find (attribute-key name) *attributes* :key #'attribute-name :test #'eq))

(addition all-attributes)
(defun all-attributes ()
  "Return a list of all attributes, in order of definition."
  (copy-list *attributes*))

(defun register-attribute (attribute)
  (let ((old (find-attribute (attribute-name attribute))))
    (setf *attributes* (if old
                           (substitute attribute old *attributes*)
                           (append *attributes* (list attribute))))))

(defun check-attribute-clauses (definition domain base max-mult supported-by)
  (unless (or (and (symbolp domain) domain (same-name-p domain 'numeric))
              (and (consp domain) (proper-list-p domain)))
    (reject-clause definition domain "NUMERIC or a list of the possible values"))
  (loop for (option value) in `((:base ,base) (:max-mult ,max-mult))
        unless (typep value '(real 0))
          do (reject-clause definition (list option value) "a number not below 0"))
  (unless (and (proper-list-p supported-by) (every #'symbolp supported-by))
    (reject-clause definition (list :supported-by supported-by) "a list of attribute names")))

(defun define-attribute (name domain &key (success 1) (base 0) (max-mult 1) (noticed 0)
                                       supported-by)
  "Define or redefine the attribute NAME; what DEFATTRIBUTE expands to. Return NAME."
  (let ((definition (format nil "defattribute ~(~S~)" name)))
    (check-attribute-clauses definition domain base max-mult supported-by)
    (register-attribute
     (make-attribute :name (attribute-key name)
                     :kind (if (consp domain) :discrete :numeric)
                     :domain (if (consp domain) domain '())
                     :success (check-probability definition :success success)
                     :base (double base) :max-mult (double max-mult)
                     :noticed (check-probability definition :noticed noticed)
                     :supporters (mapcar #'attribute-key supported-by)))
    name))

(public defattribute numeric)
(defmacro defattribute (name domain &rest options)
  "Define the attribute NAME, a keyword by convention (manual 5.4). DOMAIN is NUMERIC or a list
of the possible values, unevaluated. Options, in any order:
  :success p -- base probability that a discrete reading is correct; default 1
  :base deviation -- base standard deviation of numeric readings; default 0
  :max-mult factor -- the largest multiplier of that deviation, far away; default 1
  :noticed p (or :support p) -- base probability of being sensed unasked; default 0
  :supported-by (name...) -- attributes that raise that chance when asked for; unevaluated
Signals MALFORMED-DEFINITION. Return the name."
  (let ((definition (format nil "defattribute ~(~S~)" name)))
    (unless (and name (symbolp name))
      (reject-clause definition name "a symbol as the name of the attribute"))
    (check-options definition options
                   '(:success :base :max-mult :noticed :support :supported-by))
    (destructuring-bind (&key (success 1) (base 0) (max-mult 1) (support 0) (noticed support)
                           supported-by)
        options
      `(define-attribute ',name ',domain :success ,success :base ,base :max-mult ,max-mult
                                         :noticed ,noticed :supported-by ',supported-by))))

;;; The built-in attributes (manual, table 3.3). The manual gives the sensing parameters of
;;; :color and :size and the supporters of :capacity. The rest are our choice: what blocks the
;;; way or the view, or is closed, is plain to see if one looks for it; weight and capacity are
;;; guesses from afar; a substance that is a symbol is read right in :success of all cases.

(defattribute :obsmove (t nil)
  :success .95 :noticed .3 :supported-by (:size :weight))
(defattribute :obsview (t nil)
  :success .95 :noticed .5 :supported-by (:size))
(defattribute :closed (t nil)
  :success .9 :noticed .3 :supported-by (:capacity))
(defattribute :color (red green blue violet lightred lightblue lightgreen lightviolet)
  :success .4 :noticed .4 :supported-by (:substance))
(defattribute :size numeric
  :base .8 :max-mult 4 :noticed .7 :supported-by (:capacity :obsview :weight))
(defattribute :weight numeric
  :base .5 :max-mult 4 :noticed .2 :supported-by (:size :substance))
(defattribute :capacity numeric
  :base .6 :max-mult 4 :noticed .3 :supported-by (:size :weight))
(defattribute :substance numeric
  :success .8 :base 1 :max-mult 3 :noticed .5 :supported-by (:color))
