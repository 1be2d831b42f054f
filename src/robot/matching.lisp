;;;; matching.lisp -- noisy readings of attributes, and which things fit a description (3.4.2).

(in-package :ars-magna.robot)

(export '(symbol-of-package reading-reliability reading-deviation read-attribute angle-error
          specification-p specification-problem-text notice-probability))

;;; A discrete attribute is read right with a probability that falls with distance. A wrong reading
;;; is any value of the domain, so it may be right by chance. A reading of a numeric attribute is
;;; normally distributed; its deviation grows with distance. We follow the manual's formula, by
;;; which it comes near its largest within a metre (the manual's figure looks more gradual).
;;; Undeclared attributes are read exactly.

(defun reading-reliability (attribute distance)
  "Return the probability that the discrete ATTRIBUTE is read right from DISTANCE metres: p / max(1,
f d (1-p)) with its base probability p and f = DISCRETE-NOISE-FACTOR* (manual 3.4.2; reading 115)."
  (let ((p (attribute-success attribute)))
    (/ p (max 1d0 (* (double discrete-noise-factor*) (double distance) (- 1d0 p))))))

(defun reading-deviation (attribute distance)
  "Return the standard deviation of readings of the numeric ATTRIBUTE from DISTANCE metres: the
larger of s and m s d / (d+f), where s is its base deviation, m its largest multiplier and f
CONTINUOUS-NOISE-FACTOR* (manual 3.4.2; reading 116)."
  (let ((base (attribute-base attribute)) (distance (double distance)))
    (if (plusp distance)
        (max base (/ (* (attribute-max-mult attribute) base distance)
                     (+ distance (double continuous-noise-factor*))))
        base)))

;; See reading 225.
(defun noisy-number (attribute value distance dice)
  (roll-gaussian value (reading-deviation attribute distance) dice))

(defun symbol-of-package (value package)
  "Return VALUE or, if VALUE is a symbol, the symbol of the same name in PACKAGE, the name of a
package. So a misread value is a symbol of the map's package. If PACKAGE is NIL, return VALUE."
  (let ((package (and package (find-package package))))
    (if (and value (symbolp value) (not (keywordp value)) (not (eq value t))
             package
             (or (find-symbol (symbol-name value) package)
                 (not (package-locked-p package))))
        (values (intern (symbol-name value) package))
        value)))

(defun noisy-choice (attribute value domain distance package dice)
  (if (chance (reading-reliability attribute distance) dice)
      value
      (symbol-of-package (roll-element domain dice) package)))

(defun noisy-substance (attribute value distance package dice)
  "Return a noisy reading of VALUE of the :substance ATTRIBUTE: a number, a type or a list of both."
  (flet ((read-type (type)
           (noisy-choice attribute type (mapcar #'substance-name (all-substances))
                         distance package dice)))
    (cond ((realp value) (noisy-number attribute value distance dice))
          ((symbolp value) (read-type value))
          (t (list (read-type (first value))
                   (noisy-number attribute (second value) distance dice))))))

(defun read-attribute (attribute value distance dice &optional package)
  "Return a noisy reading of VALUE, a thing's value of ATTRIBUTE, from DISTANCE metres away, with an
error drawn from DICE. ATTRIBUTE is NIL for an undeclared attribute. A misread symbol comes from
PACKAGE, the name of a package, if given."
  (cond ((or no-sensor-error* (null attribute)) value)
        ((eq (attribute-kind attribute) :discrete)
         (noisy-choice attribute value (attribute-domain attribute) distance package dice))
        ((eq (attribute-name attribute) :substance)
         (noisy-substance attribute value distance package dice))
        ((realp value) (noisy-number attribute value distance dice))
        (t value)))

(defun sensing-error-probability (probability)
  "Return the PROBABILITY of a sensing error, or 0 while NO-SENSOR-ERROR* is true (reading 118)."
  (if no-sensor-error* 0d0 (double probability)))

(defun angle-error (dice)
  "Return a random error, in radians, for an estimate of an angle (manual, chapter 4)."
  (if no-sensor-error* 0d0 (roll-within (double camera-angle-max-error*) dice)))

;;; A descriptor specification is a list of (attribute value) or (attribute value threshold). A
;;; thing matches if readings of all those attributes fit; these readings are reported. A boolean
;;; attribute that a thing lacks counts as false; if it lacks any other attribute, it does not
;;; match. Undeclared attributes are treated by the shape of the value.

(defstruct (demand (:copier nil))
  "One demand of a descriptor specification: a reading fits if it is a number from LOW to HIGH or,
when LOW is NIL, one of CHOICES."
  (key nil :type symbol :read-only t)
  (attribute nil :type (or null attribute) :read-only t)
  (low nil :type (or null real) :read-only t)
  (high nil :type (or null real) :read-only t)
  (choices '() :type list :read-only t))

;; See readings 123 to 125.
(defun parse-demand (specification)
  (destructuring-bind (name value &optional threshold) specification
    (let* ((key (attribute-key name)) (attribute (declared-attribute key)))
      (if (or (specifies-range-p attribute value)
              (and (realp value) (not (discrete-p attribute))))
          (multiple-value-bind (low high) (value-limits value)
            (let ((threshold (or threshold standard-match-threshold*)))
              (make-demand :key key :attribute attribute
                           :low (- low threshold) :high (+ high threshold))))
          (make-demand :key key :attribute attribute
                       ;; NIL is a value, not a list of none.
                       :choices (if (consp value) value (list value)))))))

(defun parse-specification (specification)
  (mapcar #'parse-demand specification))

;;; What can be a specification.

(defun possible-value-p (attribute value)
  "True if VALUE, an atom, can be a value of ATTRIBUTE, which is NIL if undeclared."
  (cond ((null attribute) t)
        ((discrete-p attribute) (in-domain-p attribute value))
        ((eq (attribute-name attribute) :substance) (or (realp value) (symbolp value)))
        (t (realp value))))

(defun takes-range-p (attribute value)
  "True if VALUE, a list in a specification of ATTRIBUTE (NIL if undeclared), must be a range."
  (or (specifies-range-p attribute value)
      (not (or (null attribute)
               (discrete-p attribute)
               (eq (attribute-name attribute) :substance)))))

(defun demand-form-p (form)
  (and (specification-clause-p form)
       (let ((attribute (declared-attribute (first form))) (value (second form)))
         (if (consp value)
             (and (or (range-p value)
                      (not (takes-range-p attribute value)))
                  (every (lambda (value) (possible-value-p attribute value)) value))
             (possible-value-p attribute value)))))

(defun specification-p (object)
  "True if OBJECT is a descriptor specification (manual 3.4.2): a list of lists (attribute value
[threshold]) with values that the attributes can have."
  (and (proper-list-p object)
       (every #'demand-form-p object)))

(defun specification-problem-text (object)
  "Return a text that says why OBJECT is no valid descriptor specification, or NIL if it is valid."
  (let* ((form (and (proper-list-p object)
                    (find-if-not #'demand-form-p object)))
         (attribute (and (consp form) (symbolp (first form)) (declared-attribute (first form))))
         (domain (and attribute (attribute-domain attribute)))
         (value (and domain (specification-clause-p form)
                     (find-if-not (lambda (value) (in-domain-p attribute value))
                                  (ensure-list (second form))))))
    (when form
      (format nil "not ~(~S~)~@[, because the values are ~(~A~)~]~@[; did you mean ~(~A~)?~]"
              (abridged form) domain (and value (similar-domain-value value domain))))))

;;; Fitting.

(defun reading-fits-p (demand reading)
  "True if READING of a thing's attribute is what DEMAND wants."
  (let ((key (demand-key demand)) (low (demand-low demand)))
    (if low
        (let ((number (cond ((realp reading) reading)
                            ((and reading (eq key :substance))
                             (substance-value-parameter reading)))))
          (and number (<= low number (demand-high demand))))
        (member (if (and (consp reading) (eq key :substance))
                    (substance-value-type reading)
                    reading)
                (demand-choices demand) :test #'value-equal))))

(defun thing-map (thing)
  (world-map (thing-world thing)))

(defun reading-with-demand-symbols (demand reading thing)
  "READING of THING fits DEMAND. Return it with symbols of DEMAND or else of the map's package."
  (flet ((asked (value)
           (or (find value (demand-choices demand) :test #'value-equal)
               (symbol-of-package value
                                  (and (thing-world thing) (map-package (thing-map thing)))))))
    (cond ((realp reading) reading)
          ((and (consp reading) (eq :substance (demand-key demand)))
           (cons (asked (first reading)) (rest reading)))
          (t (asked reading)))))

(declaim (inline thing-attribute-value))
(defun thing-attribute-value (thing key)
  (second (assoc key (thing-attributes thing) :test #'eq)))

(defun match-thing (thing demands distance dice)
  "True if readings of THING from DISTANCE metres away meet all DEMANDS. The second value is these
readings, an object descriptor (reading 127)."
  (let ((readings '()))
    (dolist (demand demands (values t (nreverse readings)))
      (let* ((key (demand-key demand)) (attribute (demand-attribute demand))
             (value (thing-attribute-value thing key)))
        ;; See reading 122.
        (unless (or value (null attribute) (can-be-false-p attribute)) (return nil))
        (let ((reading (read-attribute attribute value distance dice)))
          (unless (reading-fits-p demand reading) (return nil))
          (push (list key (reading-with-demand-symbols demand reading thing)) readings))))))

;;; Attributes noticed in addition.

(defun notice-probability (attribute keys)
  "Return the probability that ATTRIBUTE is sensed unasked when KEYS were asked for: 1 - (1-p)^(n+1)
for the base probability p and n supporters among KEYS (manual 3.4.2; reading 224)."
  (let* ((supporters (attribute-supporters attribute))
         (given (count-if (lambda (key) (member key supporters :test #'eq)) keys)))
    (- 1d0 (power (- 1d0 (attribute-noticed attribute)) (1+ given)))))

(defun noticeable-p (attribute value map)
  "True if a robot can notice ATTRIBUTE, which has VALUE in a thing of MAP. A missing boolean is
noticed as false; a user-defined one is noticed only if a thing in MAP's definition has it."
  (or value
      (and (can-be-false-p attribute)
           (or (built-in-attribute-p attribute)
               (member (attribute-name attribute) (map-attribute-names map) :test #'eq)))))

(defun notice-attributes (map keys value-of distance dice)
  "Return readings of attributes not among KEYS that are noticed by chance in MAP. VALUE-OF, a
function of an attribute, returns its value, and whether there is a thing with attributes."
  (loop for attribute in (all-attributes)
        for key = (attribute-name attribute)
        unless (member key keys :test #'eq)
          append (multiple-value-bind (value present) (funcall value-of attribute)
                   (when (and present
                              (noticeable-p attribute value map)
                              (chance (notice-probability attribute keys) dice))
                     (list (list key (read-attribute attribute value distance dice
                                                     (map-package map))))))))

(defun describe-thing (thing readings distance dice)
  "Return what a search reports of THING: noticed attributes, then READINGS (reading 128)."
  (append (notice-attributes (thing-map thing) (mapcar #'first readings)
                             (lambda (attribute)
                               (values (thing-attribute-value thing (attribute-name attribute)) t))
                             distance dice)
          readings))
