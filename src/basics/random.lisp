;;;; random.lisp -- Lisp's own dice, which users' code rolls by CL:RANDOM.

(in-package :ars-magna.basics)

(export '(*lisps-dice* seeded-lisps-dice reseed-lisps-dice
          call-with-own-lisps-dice rolling lisps-dice-numbers lisps-dice-numbers-p
          lisps-dice-of-numbers dice-rolled roll-back unheard-of-number tick-dice make-tick-dice
          begin-tick-dice *tick-dice* with-users-dice))

;;; What CL:RANDOM says must not depend on what has gone on in Lisp before. Programs (continuations,
;;; plans, what is around them) have a random state of their run's, seeded when it begins. Code that
;;; changes a world has another, as a journal repeats the world but not the programs; in each tick
;;; it begins anew, from a word that depends on nothing but the seed and the tick, so that there is
;;; no state to be copied, saved or digested.

(defparameter *lisps-dice* 'cl:*random-state*
  "The name of the variable whose value CL:RANDOM rolls.")

;;; Seeding. What a seed makes of the words of a random state takes microseconds, and few programs
;;; roll. So only the first word, which is the seed itself, is set, with a mark behind it; the rest
;;; follows when the first roll asks SBCL for new numbers. A copy of such words means the same.

(defconstant +place-of-place+ 2
  "The index, in the words of a random state, of the place at which they are read next.")
(defconstant +first-word+ (1+ +place-of-place+))
(defconstant +all-read+ 624 "The place in words of which all have been read.")
(define-constant +mark+ #(#x6C617A79 #x64696365 #x2E2E2E2E) :test #'equalp
  :documentation "What stands behind the first of words that are still to be filled.")

(defun mark-seeded (words seed)
  "Let WORDS, of a random state, be filled from SEED when somebody asks for new ones."
  (declare (type random-words words))
  (setf (aref words +place-of-place+) +all-read+
        (aref words +first-word+) seed)
  (loop for mark of-type (unsigned-byte 32) across +mark+
        for index from (1+ +first-word+)
        do (setf (aref words index) mark)))

(defun marked-p (words)
  (declare (type random-words words))
  (loop for mark of-type (unsigned-byte 32) across +mark+
        for index from (1+ +first-word+)
        always (= mark (aref words index))))

(defun fill-if-marked (words)
  (declare (type random-words words))
  (when (marked-p words)
    (fill-words (aref words +first-word+) words)))

(wrap-renewal (lambda (renew words)
                (fill-if-marked words)
                (funcall renew words)))

(defparameter *seeding-waits-p*
  (flet ((state (filled-p)
           (let* ((state (make-random-state nil)) (words (words-of-state state)))
             (mark-seeded words 1992)
             (when filled-p (fill-if-marked words))
             state)))
    (= (random (expt 2 64) (state nil)) (random (expt 2 64) (state t))))
  "Whether seeding may wait for the first roll, as this SBCL asks for new words so that they can be
filled by then.")

(defun seed-state (state short)
  "Return the random state STATE, seeded by SHORT, a number of 32 bits."
  (let ((words (words-of-state state)))
    (mark-seeded words short)
    (unless *seeding-waits-p* (fill-if-marked words))
    state))

(defun reseed (state seed)
  "Let the random state STATE be what SEEDED-LISPS-DICE returns for SEED, an integer."
  (seed-state state (ldb (byte 32 0) (mix-word (ldb (byte 64 0) seed)))))

(defun seeded-lisps-dice (seed)
  "Return a random state for CL:RANDOM that depends on the integer SEED only."
  (reseed (make-random-state nil) seed))

(defun call-with-own-lisps-dice (function)
  "Call FUNCTION. CL:RANDOM has dice of its own in it, which no other thread rolls."
  (let ((*random-state* (make-random-state nil))) (funcall function)))

(defmacro rolling ((state) &body body)
  "Run BODY. CL:RANDOM rolls STATE in it or, if that is NIL, what it rolls here."
  `(let ((*random-state* (or ,state *random-state*))) ,@body))

(defun unheard-of-number ()
  "Return a number of 64 bits that no other process comes upon, if chance allows."
  (random (expt 2 64) (make-random-state t)))

;;; The dice of a tick. They are seeded when the first users' code is called.

(define-record (tick-dice (:constructor make-tick-dice ()
                            "Return what holds the dice of one tick after the other. See
BEGIN-TICK-DICE."))
  "What CL:RANDOM rolls in users' code that changes a world in the tick at hand: STATE, once it is
seeded by the integers SEED and TICK."
  (state nil (or null random-state) :writable)
  (seed 0 integer :writable)
  (tick 0 fixnum :writable)
  (seeded-p nil boolean :writable))

(defvar *tick-dice* nil
  "The TICK-DICE for users' code that this thread calls, or NIL if that rolls what is there.")

(declaim (inline begin-tick-dice))
(defun begin-tick-dice (dice seed tick)
  "Let DICE be those of TICK of a world whose chance comes from the integer SEED."
  (declare (type tick-dice dice) (type fixnum tick))
  (setf (tick-dice-seed dice) seed
        (tick-dice-tick dice) tick
        (tick-dice-seeded-p dice) nil))

(defun seed-tick-dice (dice)
  "Seed DICE, without a new random state if they have one."
  (let ((seed (logxor (ldb (byte 64 0) (tick-dice-seed dice))
                      (mix-word (ldb (byte 64 0) (tick-dice-tick dice)))))
        (state (tick-dice-state dice)))
    (if state
        (reseed state seed)
        (setf (tick-dice-state dice) (seeded-lisps-dice seed)))
    (setf (tick-dice-seeded-p dice) t)))

(declaim (inline users-dice))
(defun users-dice ()
  "Return the random state that users' code called here is to roll."
  (let ((dice *tick-dice*))
    (cond (dice (unless (tick-dice-seeded-p dice) (seed-tick-dice dice))
                (tick-dice-state dice))
          (t *random-state*))))

(defmacro with-users-dice (&body body)
  "Run BODY, which calls users' code, with the dice that it is to roll by CL:RANDOM."
  `(let ((*random-state* (users-dice))) ,@body))

;; The state itself is changed: while users' code is called it is bound once more.
(defun reseed-lisps-dice (seed &optional (state *random-state*))
  "Let what CL:RANDOM says to programs here, who roll STATE, depend on the integer SEED from now on.
Code that changes a world rolls other dice."
  (unless *tick-dice* (reseed state seed)))

;;; In files. SBCL trusts what is in a random state, so that what comes from outside is looked at.

(defun lisps-dice-numbers (state)
  "Return what is in the random state STATE, a list of whole numbers of 32 bits: what it is seeded
by, if nobody has rolled it since; or else the place in its words, and these."
  (let ((words (words-of-state state)))
    (if (marked-p words)
        (list (aref words +first-word+))
        (coerce (subseq words +place-of-place+) 'list))))

(defun lisps-dice-numbers-p (datum)
  "True if DATUM can be what LISPS-DICE-NUMBERS returns."
  (and (proper-list-p datum)
       (every (lambda (number) (typep number '(unsigned-byte 32))) datum)
       (or (= 1 (length datum))
           (and (= (1+ +all-read+) (length datum))
                (<= (first datum) +all-read+)))))

(defun lisps-dice-of-numbers (numbers)
  "Return a random state for which LISPS-DICE-NUMBERS returns NUMBERS."
  (let ((state (make-random-state nil)))
    (if (rest numbers)
        (replace (words-of-state state) numbers :start1 +place-of-place+)
        (seed-state state (first numbers)))
    state))

;;; What the dice are at a moment, for who is to repeat what is rolled next. Each roll changes the
;;; place at which the words are read or, when all have been, the words.

(defstruct (rolled (:constructor make-rolled (place words)) (:copier nil))
  "What the dice of programs were: the WORDS of a random state, but for the PLACE in it."
  (place 0 :type (unsigned-byte 32) :read-only t)
  (words nil :type (simple-array (unsigned-byte 32) (*)) :read-only t))

(defun dice-rolled (before)
  "Return what the dice of programs are here and now, for ROLL-BACK. It is BEFORE, which was
returned earlier, or NIL, if they have not been rolled since."
  (let* ((now (words-of-state *random-state*))
         (place (aref now +place-of-place+))
         (same-words-p (and before (= (aref now +first-word+)
                                      (aref (rolled-words before) +first-word+)))))
    (declare (type (simple-array (unsigned-byte 32) (*)) now))
    (cond ((not same-words-p) (make-rolled place (copy-seq now)))
          ((= place (rolled-place before)) before)
          (t (make-rolled place (rolled-words before))))))

(defun roll-back (rolled)
  "Let the dice of programs be here what they were when DICE-ROLLED returned ROLLED."
  (let ((words (words-of-state *random-state*)))
    (replace words (rolled-words rolled))
    (setf (aref words +place-of-place+) (rolled-place rolled))))
