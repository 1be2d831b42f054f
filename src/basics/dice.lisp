;;;; dice.lisp -- dice, the source of all randomness; digests, one number for a state.

(in-package :ars-magna.basics)

(export '(dice copy-dice mixed-word text-hash text-checksum digest make-digest digest-add
          digest-add-word digest-add-identity))

;;; Dice are splitmix64 generators (Steele, Lea and Flood 2014): one 64-bit word of state, the same
;;; numbers on every machine and with every compiler. A simulation has one stream for each purpose,
;;; so an extra look does not change how a box moves.

(deftype word () '(unsigned-byte 64))

(define-constant +golden-gamma+ #x9E3779B97F4A7C15)

(declaim (inline mix-bits))
(defun mix-bits (word)
  (declare (type word word))
  (let* ((word (ldb (byte 64 0) (* (logxor word (ash word -30)) #xBF58476D1CE4E5B9)))
         (word (ldb (byte 64 0) (* (logxor word (ash word -27)) #x94D049BB133111EB))))
    (declare (type word word))
    (logxor word (ash word -31))))

(declaim (inline mixed-word))
(defun mixed-word (one other)
  "Return a 64-bit hash of the integers ONE and OTHER."
  (mix-bits (logxor (mix-bits (ldb (byte 64 0) one)) (ldb (byte 64 0) other))))

(declaim (inline %make-dice dice-state (setf dice-state) copy-dice))
(define-record (dice (:constructor %make-dice (state)))
  "A stream of random numbers. Two dice in the same state roll the same sequence of numbers."
  (state 0 word "the state of the dice, an integer of 64 bits" :writable :export))
(declaim-final dice)

(defun copy-dice (dice)
  "Return dice in the same state as DICE."
  (%make-dice (dice-state dice)))

(declaim (inline characters-hash))
(defun characters-hash (string code)
  "Return a 64-bit hash (FNV-1a) of STRING. The function CODE maps each character to a number."
  (let ((word #xCBF29CE484222325))
    (declare (type word word))
    (flet ((add (char)
             (setf word (ldb (byte 64 0) (* (logxor word (funcall code char)) #x100000001B3)))))
      (declare (inline add))
      ;; Lisp stores names in the first two types.
      (typecase string
        (simple-base-string (loop for char across string do (add char)))
        ((simple-array character (*)) (loop for char across string do (add char)))
        (t (loop for char across string do (add char))))
      word)))

(defun text-hash (text)
  "Return a 64-bit hash of the characters of TEXT, a string designator."
  (declare #.*hot*)
  (characters-hash (string text) #'char-code))

(declaim (inline upper-code))
(defun upper-code (char)
  (let ((code (char-code char)))
    ;; CHAR-UPCASE is slow, and most characters do not need it.
    (cond ((<= (char-code #\a) code (char-code #\z)) (- code 32))
          ((< code 128) code)
          (t (char-code (char-upcase char))))))

(defun name-hash (name)
  "Return a 64-bit hash of NAME, a string designator, regardless of case."
  (declare #.*hot*)
  (characters-hash (string name) #'upper-code))

(addition make-dice)
(defun make-dice (seed &optional (purpose ""))
  "Return new dice that depend only on the integer SEED and on PURPOSE, a string designator. They do
not change what the dice of a world roll. Signals WRONG-ARGUMENT unless SEED is an integer."
  (check-argument make-dice seed (integerp seed) "an integer")
  (%make-dice (mix-bits (logxor (mix-bits (ldb (byte 64 0) seed)) (text-hash purpose)))))

(declaim (inline roll chance roll-between roll-within))

(addition roll)
(defun roll (dice)
  "Return a double-float uniform in [0, 1)."
  (declare (type dice dice))
  (let ((state (ldb (byte 64 0) (+ (dice-state dice) +golden-gamma+))))
    (setf (dice-state dice) state)
    (* (the double-float (float (ash (mix-bits state) -11) 1d0)) #.(power-of-two -53))))

(addition chance)
(defun chance (probability dice)
  "True with PROBABILITY. No dice are rolled if PROBABILITY is 0 or less, or 1 or more. Signals
WRONG-ARGUMENT unless PROBABILITY is a number from -1e15 to 1e15."
  (check-argument chance probability (bounded-number-p probability) "a probability, from 0 to 1")
  (let ((probability (double probability)))
    (cond ((<= probability 0d0) nil)
          ((>= probability 1d0) t)
          (t (< (roll dice) probability)))))

(addition roll-between)
(defun roll-between (low high dice)
  "Return a double-float uniform in [LOW, HIGH). Signals WRONG-ARGUMENT unless LOW and HIGH are
numbers from -1e15 to 1e15."
  (check-argument roll-between low (bounded-number-p low) "a number from -1e15 to 1e15")
  (check-argument roll-between high (bounded-number-p high) "a number from -1e15 to 1e15")
  (let ((low (double low)) (high (double high)))
    (+ low (* (roll dice) (- high low)))))

(addition roll-within)
(defun roll-within (range dice)
  "Return a double-float uniform in [-RANGE, RANGE); 0 if RANGE is 0. Signals WRONG-ARGUMENT unless
RANGE is a number from -1e15 to 1e15."
  (check-argument roll-within range (bounded-number-p range) "a number from -1e15 to 1e15")
  (let ((range (double range)))
    (if (zerop range) 0d0 (roll-between (- range) range dice))))

(addition roll-index)
(defun roll-index (count dice)
  "Return an integer uniform in [0, COUNT). Signals WRONG-ARGUMENT unless COUNT is an integer from 1
to 2^53, the range in which every integer is a double-float."
  (check-argument roll-index count (whole-p count 1 #.(expt 2 53)) "an integer from 1 to 2^53")
  (values (floor (* (roll dice) count))))

(addition roll-element)
(defun roll-element (sequence dice)
  "Return a random element of SEQUENCE. Signals WRONG-ARGUMENT if SEQUENCE is empty."
  (check-argument roll-element sequence (and (typep sequence 'sequence) (plusp (length sequence)))
                  "a sequence that is not empty")
  (elt sequence (roll-index (length sequence) dice)))

(addition roll-gaussian)
(defun roll-gaussian (mean deviation dice)
  "Return a normally distributed double-float. If DEVIATION is 0, return MEAN and roll no dice.
Signals WRONG-ARGUMENT unless MEAN and DEVIATION are numbers from -1e15 to 1e15."
  (check-argument roll-gaussian mean (bounded-number-p mean) "a number from -1e15 to 1e15")
  (check-argument roll-gaussian deviation (bounded-number-p deviation)
                  "a number from -1e15 to 1e15")
  (if (zerop deviation)
      (double mean)
      (let ((radius (sqrt (the (double-float 0d0) (* -2d0 (logarithm (- 1d0 (roll dice)))))))
            (angle (* 2d0 pi (roll dice))))
        (+ (double mean) (* (double deviation) radius (cosine angle))))))

;;;; Digests

(define-record (digest (:constructor make-digest ()
                         "Return a digest to which nothing has been added."))
  "A hash of a sequence of data (FNV-1a, 64 bits)."
  (value #xCBF29CE484222325 word "the hash of all data added so far, 64 bits" :writable :export))

(declaim (inline digest-add-word))
(defun digest-add-word (digest word)
  "Add WORD, 64 bits, to DIGEST."
  (setf (digest-value digest)
        (mix-bits (ldb (byte 64 0) (* (logxor (digest-value digest) word) #x100000001B3)))))

(defgeneric digest-add-identity (object digest)
  (:documentation "Add to DIGEST data that identify OBJECT, or else its contents. Return DIGEST."))

(defun digest-add (digest datum)
  "Add DATUM to DIGEST: numbers to the bit, symbols and strings by name, lists and vectors by
elements. All functions count as equal. DIGEST-ADD-IDENTITY adds other objects. Return DIGEST."
  (declare #.*hot* (type digest digest))
  (typecase datum
    (null (digest-add-word digest (load-time-value (name-hash nil))))
    (double-float
     (digest-add-word digest (double-to-bits datum)))
    (fixnum (digest-add-word digest (ldb (byte 64 0) datum)))
    (integer (digest-add-word digest (ldb (byte 64 0) datum)))
    (ratio (if (finite-p datum)
               (digest-add digest (coerce datum 'double-float))
               (digest-add digest (list (numerator datum) (denominator datum)))))
    (real (digest-add digest (coerce datum 'double-float)))
    ((or symbol string) (digest-add-word digest (name-hash datum)))
    (character (digest-add-word digest (char-code datum)))
    (cons (digest-add-word digest 3)
     (loop for tail = datum then (cdr tail)
           while (consp tail)
           do (digest-add digest (car tail))
           finally (digest-add digest tail)))
    ((simple-array (unsigned-byte 8) (*)) (digest-add-word digest (length datum))
     (loop for octet across datum do (digest-add-word digest octet)))
    (simple-vector (digest-add-word digest (length datum))
     (loop for element across datum do (digest-add digest element)))
    (vector (digest-add-word digest (length datum))
     (loop for element across datum do (digest-add digest element)))
    (function (digest-add-word digest 1))
    (t (digest-add-identity datum digest)))
  digest)

(defun text-checksum (text &optional (before 0))
  "Return a 32-bit checksum of TEXT, combined with BEFORE, the checksum of the text before TEXT."
  (ldb (byte 32 0) (mix-bits (logxor before (text-hash text)))))
