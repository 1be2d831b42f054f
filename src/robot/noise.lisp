;;;; noise.lisp -- how wrongly attributes are read from a distance (manual 3.4.2).

(in-package :ars-magna.robot)

(export '(own-symbol reading-reliability reading-deviation read-attribute angle-error))

;;; A discrete attribute is read right with a probability that falls with distance; a wrong reading
;;; is any value of the domain, so it may be right by luck. A reading of a numeric attribute is
;;; normally distributed; its deviation grows with distance. The manual's formula for that, which
;;; we follow, lets it come near its largest within a metre (its figure looks more gradual).
;;; Attributes that nobody defined are read as they are.

(defun reading-reliability (attribute distance)
  "Return the probability that the discrete ATTRIBUTE is read right DISTANCE metres away: p / max(1,
f d (1-p)), p being its base probability and f DISCRETE-NOISE-FACTOR* (manual 3.4.2; reading 115)."
  (let ((p (attribute-success attribute)))
    (/ p (max 1d0 (* (double discrete-noise-factor*) (double distance) (- 1d0 p))))))

(defun reading-deviation (attribute distance)
  "Return the standard deviation of readings of the numeric ATTRIBUTE from DISTANCE metres away: the
larger of s and m s d / (d+f), s being its base deviation, m its largest multiplier and f
CONTINUOUS-NOISE-FACTOR* (manual 3.4.2; reading 116)."
  (let ((base (attribute-base attribute)) (distance (double distance)))
    (if (plusp distance)
        (max base (/ (* (attribute-max-mult attribute) base distance)
                     (+ distance (double continuous-noise-factor*))))
        base)))

;; As reading 225 says.
(defun noisy-number (attribute value distance dice)
  (roll-gaussian value (reading-deviation attribute distance) dice))

(defun own-symbol (value package)
  "Return VALUE, or if it is a symbol, the one of the same name that somebody writes in PACKAGE, the
name of a package; so that what is misread is still a word of the world's author. NIL: any will do."
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
      (own-symbol (roll-element domain dice) package)))

(defun noisy-substance (attribute value distance package dice)
  "Return a reading of VALUE of the :substance ATTRIBUTE: a number, a type, or a list of both."
  (flet ((read-type (type)
           (noisy-choice attribute type (mapcar #'substance-name (all-substances))
                         distance package dice)))
    (cond ((realp value) (noisy-number attribute value distance dice))
          ((symbolp value) (read-type value))
          (t (list (read-type (first value))
                   (noisy-number attribute (second value) distance dice))))))

(defun read-attribute (attribute value distance dice &optional package)
  "Return a reading of VALUE, which a thing has for ATTRIBUTE (NIL: an undefined one), from DISTANCE
metres away, its error drawn from DICE. A symbol that is misread is one of PACKAGE, if that is given
by name."
  (cond ((or no-sensor-error* (null attribute)) value)
        ((eq (attribute-kind attribute) :discrete)
         (noisy-choice attribute value (attribute-domain attribute) distance package dice))
        ((eq (attribute-name attribute) :substance)
         (noisy-substance attribute value distance package dice))
        ((realp value) (noisy-number attribute value distance dice))
        (t value)))

(defun sensing-chance (probability)
  "Return PROBABILITY of a sensing error, or 0 while there is none (reading 118)."
  (if no-sensor-error* 0d0 (double probability)))

(defun angle-error (dice)
  "Return the error, in radians, of an estimate of an angle (manual, chapter 4)."
  (if no-sensor-error* 0d0 (roll-within (double camera-angle-max-error*) dice)))
