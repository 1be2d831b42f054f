;;;; arguments.lisp -- how large the numbers are that functions take, and which keywords.

(in-package :ars-magna.basics)

(export '(+largest+ +largest-quantity+ within-reason-p quantity-p amount-p probability-p whole-p
          tick-span-p define-with-keywords))

;;; Positions, distances, speeds, angles and times are kept below 1e9 either way: there a
;;; double-float is exact to 1e-7 metres or radians, so that what is added up in a run stays true,
;;; and a count of ticks can be added to another for ever. (At 20 ticks a second 1e9 ticks take a
;;; year and a half.) What things are like, such as weights, is kept below 1e15, where every whole
;;; number is a double-float of its own, and sums and squares are far from overflowing. Infinities
;;; and what is no number are nowhere taken. ARGUMENT-TYPES.LISP says all this to users.

(define-constant +largest+ (expt 10 9)
  :documentation "How large positions, distances, speeds, angles and times are at most.")

(define-constant +largest-quantity+ (expt 10 15)
  :documentation "How large the numbers are at most that say what something is like.")

(defun other-within-p (value limit)
  (and (finite-p value) (<= (- limit) value limit)))

(declaim (inline within-p within-reason-p quantity-p))
(defun within-p (value limit)
  "True if VALUE is a number from -LIMIT to LIMIT, an integer."
  (if (typep value 'double-float)
      (and (finite-double-p value)
           (<= (double (- limit)) value (double limit)))
      (other-within-p value limit)))

(defun within-reason-p (value)
  "True if VALUE can be a position, distance, speed, angle or time: from -1e9 to 1e9."
  (within-p value +largest+))

(defun quantity-p (value)
  "True if VALUE can say what something is like: a number from -1e15 to 1e15."
  (within-p value +largest-quantity+))

(defun amount-p (value)
  "True if VALUE is a quantity not below 0."
  (and (quantity-p value) (not (minusp value))))

(defun probability-p (value)
  "True if VALUE is a number from 0 to 1."
  (and (finite-p value) (<= 0 value 1)))

(defun whole-p (value &optional (least 0) (most +largest+))
  "True if VALUE is an integer from LEAST to MOST."
  (and (integerp value) (<= least value most)))

(defun tick-span-p (value)
  "True if VALUE is how long something can last: a whole number of ticks, from 0 to 1e9."
  (whole-p value))

;;;; Keywords

(defun check-keywords (operator known options)
  "Signal UNKNOWN-NAME if the list OPTIONS, given to OPERATOR, has a keyword that is not one of
KNOWN."
  (loop for (key) on options by #'cddr
        unless (or (member key known) (eq key :allow-other-keys))
          do (reject-name (format nil "keyword of ~(~A~)" operator) key known)))

(defun warn-of-keywords (operator known options)
  "Warn, while a call of OPERATOR is compiled, of a keyword among the forms OPTIONS that is not one
of KNOWN, and of a number in the place of one."
  (loop for (key) on options by #'cddr
        when (and (keywordp key) (not (member key known)) (not (eq key :allow-other-keys)))
          do (simple-style-warning "~(~A~) has no keyword ~(~S~); it knows ~{~(~S~)~^, ~}."
                                   operator key known)
        when (realp key)
          do (doubt-definition "~(~A~): ~S stands where a keyword should. Write one before it: ~
                                ~{~(~S~)~^, ~}." operator key known)))

(defun with-options (lambda-list)
  "Return LAMBDA-LIST with any keywords allowed, the variable of all that are given, which are
known, and how many arguments come before them."
  (destructuring-bind (required optional rest keys allowed aux keys-p)
      (multiple-value-list (parse-ordinary-lambda-list lambda-list))
    (declare (ignore optional allowed aux keys-p))
    (let ((options (or rest (gensym "OPTIONS"))) (place (position '&key lambda-list)))
      (values (append required (list '&rest options) (subseq lambda-list place)
                      '(&allow-other-keys))
              options
              (mapcar #'caar keys)
              (length required)))))

(defmacro define-with-keywords (name lambda-list documentation &body body)
  "Define the function NAME as DEFUN does, with LAMBDA-LIST, which has keywords and nothing optional
besides. Called with a keyword that is not among these it signals UNKNOWN-NAME, which lists them;
the compiler warns of such a call."
  (multiple-value-bind (all options known count) (with-options lambda-list)
    (multiple-value-bind (forms declarations) (parse-body body)
      `(progn
         (defun ,name ,all
           ,documentation
           ,@declarations
           (check-keywords ',name ',known ,options)
           ,@forms)
         (define-compiler-macro ,name (&whole form &rest arguments)
           (warn-of-keywords ',name ',known (nthcdr ,count arguments))
           form)
         (show-lambda-list ',name ',lambda-list #',name)
         ',name))))
