;;;; random.lisp -- Lisp's own dice, of which all that the simulator needs is that they begin anew.

(in-package :ars-magna.base)

(defun seeded-random-state (seed)
  "Return a random state for CL:RANDOM that depends on the integer SEED only."
  (sb-ext:seed-random-state (ldb (byte 32 0) (mix-word (ldb (byte 64 0) seed)))))
