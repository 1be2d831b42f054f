;;;; random.lisp -- the random states that users' code uses by CL:RANDOM.

(in-package :ars-magna.basics)

(export '(*random-state-variable* seeded-random-state reseed-random-state
          call-with-own-random-state with-random-state random-state-numbers random-state-numbers-p
          random-state-of-numbers take-random-snapshot restore-random-snapshot random-identifier
          tick-dice make-tick-dice begin-tick-dice *tick-dice* with-users-random-state))

;;; CL:RANDOM must not depend on what this Lisp has done before. Programs (continuations, plans and
;;; the code around them) use a random state of their run, seeded at its start. Code that changes a
;;; world uses another one, as a journal repeats the world but not the programs. It is seeded in
;;; each tick, from the run's seed and the tick, so it need not be copied, saved or digested.

(defparameter *random-state-variable* 'cl:*random-state*
  "The name of the variable that holds the random state of CL:RANDOM.")

;;; Seeding. To fill the words of a random state takes microseconds, and few programs roll. So only
;;; the first word, the seed itself, is set, with a mark after it. The rest is filled when the first
;;; roll makes SBCL renew the words. A copy of such words means the same.

(defconstant +position-index+ 2
  "The index of the word of a random state that holds the position of the next word to read.")
(defconstant +first-word-index+ (1+ +position-index+))
(defconstant +end-of-words+ 624 "The position after the last word.")
(define-constant +mark+ #(#x6C617A79 #x64696365 #x2E2E2E2E) :test #'equalp
  :documentation "The mark: the words after the seed in a random state that is not yet filled.")

(defun mark-seeded (words seed)
  "Store SEED and the mark in WORDS. They are filled from SEED when SBCL renews the random state."
  (declare (type random-words words))
  (setf (aref words +position-index+) +end-of-words+
        (aref words +first-word-index+) seed)
  (loop for mark of-type (unsigned-byte 32) across +mark+
        for index from (1+ +first-word-index+)
        do (setf (aref words index) mark)))

(defun seed-marked-p (words)
  (declare (type random-words words))
  (loop for mark of-type (unsigned-byte 32) across +mark+
        for index from (1+ +first-word-index+)
        always (= mark (aref words index))))

(defun fill-if-seed-marked (words)
  (declare (type random-words words))
  (when (seed-marked-p words)
    (fill-random-words (aref words +first-word-index+) words)))

(wrap-random-renewal (lambda (renew words)
                       (fill-if-seed-marked words)
                       (funcall renew words)))

(defparameter *seeding-can-wait-p*
  (flet ((state (filled-p)
           (let* ((state (make-random-state nil)) (words (random-state-words state)))
             (mark-seeded words 1992)
             (when filled-p (fill-if-seed-marked words))
             state)))
    (= (random (expt 2 64) (state nil)) (random (expt 2 64) (state t))))
  "True if this SBCL renews a random state's words at the first roll, when they can be filled.")

(defun seed-state (state short)
  "Seed the random state STATE with SHORT, an integer of 32 bits, and return STATE."
  (let ((words (random-state-words state)))
    (mark-seeded words short)
    (unless *seeding-can-wait-p* (fill-if-seed-marked words))
    state))

(defun reseed (state seed)
  (seed-state state (ldb (byte 32 0) (mix-bits (ldb (byte 64 0) seed)))))

(defun seeded-random-state (seed)
  "Return a random state for CL:RANDOM that depends on the integer SEED only."
  (reseed (make-random-state nil) seed))

(defun call-with-own-random-state (function)
  "Call FUNCTION with a separate random state for CL:RANDOM."
  (let ((*random-state* (make-random-state nil))) (funcall function)))

(defmacro with-random-state ((state) &body body)
  "Run BODY with the random state STATE for CL:RANDOM. If STATE is NIL, use the current state."
  `(let ((*random-state* (or ,state *random-state*))) ,@body))

(defun random-identifier ()
  "Return a random number of 64 bits that is unlikely to be the same in two processes."
  (random (expt 2 64) (make-random-state t)))

;;; The dice of a tick. They are seeded when the first users' code is called.

(define-record (tick-dice (:constructor make-tick-dice ()
                            "Return dice to be prepared for each tick by BEGIN-TICK-DICE."))
  "The random state of users' code that changes a world in the current tick. At its first use, STATE
is seeded with the integers SEED and TICK."
  (state nil (or null random-state) :writable)
  (seed 0 integer :writable)
  (tick 0 fixnum :writable)
  (seeded-p nil boolean :writable))

(defvar *tick-dice* nil
  "The TICK-DICE of users' code that this thread calls, or NIL if such code uses *RANDOM-STATE*.")

(declaim (inline begin-tick-dice))
(defun begin-tick-dice (dice seed tick)
  "Prepare DICE for TICK of a world whose seed is the integer SEED."
  (declare (type tick-dice dice) (type fixnum tick))
  (setf (tick-dice-seed dice) seed
        (tick-dice-tick dice) tick
        (tick-dice-seeded-p dice) nil))

(defun seed-tick-dice (dice)
  "Seed DICE for the current tick, and reuse their random state if they have one."
  (let ((seed (logxor (ldb (byte 64 0) (tick-dice-seed dice))
                      (mix-bits (ldb (byte 64 0) (tick-dice-tick dice)))))
        (state (tick-dice-state dice)))
    (if state
        (reseed state seed)
        (setf (tick-dice-state dice) (seeded-random-state seed)))
    (setf (tick-dice-seeded-p dice) t)))

(declaim (inline users-random-state))
(defun users-random-state ()
  (let ((dice *tick-dice*))
    (cond (dice (unless (tick-dice-seeded-p dice) (seed-tick-dice dice))
                (tick-dice-state dice))
          (t *random-state*))))

(defmacro with-users-random-state (&body body)
  "Run BODY, which calls users' code, with *RANDOM-STATE* bound to users' random state."
  `(let ((*random-state* (users-random-state))) ,@body))

;; The state itself is changed, because calls of users' code bind the variable again.
(defun reseed-random-state (seed &optional (state *random-state*))
  "Seed STATE, the random state that programs use through CL:RANDOM, with the integer SEED. In code
that changes a world, do nothing: such code uses *TICK-DICE*."
  (unless *tick-dice* (reseed state seed)))

;;; In files. SBCL does not check the words of a random state, so those from a file are checked.

(defun random-state-numbers (state)
  "Return the contents of the random state STATE as a list of 32-bit integers. If STATE was not used
since it was seeded, list only the seed; else list the position of the next word, and all words."
  (let ((words (random-state-words state)))
    (if (seed-marked-p words)
        (list (aref words +first-word-index+))
        (coerce (subseq words +position-index+) 'list))))

(defun random-state-numbers-p (datum)
  "True if RANDOM-STATE-NUMBERS could return DATUM."
  (and (proper-list-p datum)
       (every (lambda (number) (typep number '(unsigned-byte 32))) datum)
       (or (= 1 (length datum))
           (and (= (1+ +end-of-words+) (length datum))
                (<= (first datum) +end-of-words+)))))

(defun random-state-of-numbers (numbers)
  "Return a random state for which RANDOM-STATE-NUMBERS returns NUMBERS."
  (let ((state (make-random-state nil)))
    (if (rest numbers)
        (replace (random-state-words state) numbers :start1 +position-index+)
        (seed-state state (first numbers)))
    state))

;;; Snapshots of the current random state, to repeat the next rolls. Each roll changes the position
;;; or, after the last word, the words.

(defstruct (random-snapshot (:constructor make-random-snapshot (position words)) (:copier nil))
  "A snapshot of a random state: its WORDS, in which the position is outdated, and its POSITION."
  (position 0 :type (unsigned-byte 32) :read-only t)
  (words nil :type (simple-array (unsigned-byte 32) (*)) :read-only t))

(defun take-random-snapshot (before)
  "Return a snapshot of the current random state for RESTORE-RANDOM-SNAPSHOT. If CL:RANDOM was not
called since the snapshot BEFORE, return BEFORE."
  (let* ((now (random-state-words *random-state*))
         (position (aref now +position-index+))
         (same-words-p (and before (= (aref now +first-word-index+)
                                      (aref (random-snapshot-words before)
                                            +first-word-index+)))))
    (declare (type (simple-array (unsigned-byte 32) (*)) now))
    (cond ((not same-words-p) (make-random-snapshot position (copy-seq now)))
          ((= position (random-snapshot-position before)) before)
          (t (make-random-snapshot position (random-snapshot-words before))))))

(defun restore-random-snapshot (snapshot)
  "Restore the current random state from SNAPSHOT, a value of TAKE-RANDOM-SNAPSHOT."
  (let ((words (random-state-words *random-state*)))
    (replace words (random-snapshot-words snapshot))
    (setf (aref words +position-index+) (random-snapshot-position snapshot))))
