;;;; random.lisp -- Lisp's own dice, of which all that the simulator needs is that they begin anew.

(in-package :ars-magna.base)

(defparameter *lisps-dice* 'cl:*random-state*
  "The name of the variable whose value CL:RANDOM rolls.")

(defun call-with-lisps-dice (function seed)
  "Call FUNCTION. What CL:RANDOM says in it depends on the integer SEED only."
  (let ((*random-state* (sb-ext:seed-random-state
                         (ldb (byte 32 0) (mix-word (ldb (byte 64 0) seed))))))
    (funcall function)))

(defun call-with-own-lisps-dice (function)
  "Call FUNCTION. CL:RANDOM has dice of its own in it, which no other thread rolls."
  (let ((*random-state* (make-random-state nil))) (funcall function)))

(defun unheard-of-number ()
  "Return a number of 64 bits that no other process comes upon, if chance allows."
  (random (expt 2 64) (make-random-state t)))

(defun lisps-dice-p (symbol)
  "True if SYMBOL is a name by which Lisp's own dice are rolled."
  (and (member symbol '(cl:random cl:*random-state* cl:make-random-state)) t))
