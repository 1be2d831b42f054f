;;;; random-state.lisp -- the words in a random state.

(in-package :ars-magna.host)

(export '(random-words words-of-state fill-words wrap-renewal))

;;; In all versions of SBCL that were tried a random state is 627 words of the Mersenne Twister
;;; MT19937: two constants, the place of the next word, and 624 words.

(deftype random-words ()
  "What is in a random state."
  '(simple-array (unsigned-byte 32) (627)))

(declaim (inline words-of-state fill-words))
(defun words-of-state (state)
  "Return the words of the random state STATE, not a copy."
  (the random-words (internal (:sb-kernel #:random-state-state) state)))

(defun fill-words (seed words)
  "Seed WORDS, of a random state, by SEED, an integer of 32 bits."
  (internal (:sb-kernel #:init-random-state) seed words))

(defun wrap-renewal (wrapper)
  "Call WRAPPER, with SBCL's function and the words, where SBCL makes new words of words that have
all been read."
  (wrap-function (internal-name :sb-kernel '#:random-mt19937-update) wrapper))
