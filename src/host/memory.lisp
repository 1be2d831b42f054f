;;;; memory.lisp -- how much memory objects take, and when SBCL next collects garbage.

(in-package :ars-magna.host)

(export '(octets-before-garbage scrub-stack dynamic-usage collections))

(defun dynamic-usage ()
  "Return how many bytes objects take, including garbage."
  (internal (:sb-kernel #:dynamic-usage)))

(defun collection-trigger ()
  "Return at how many bytes SBCL collects garbage; NIL if this SBCL does not say."
  (ignore-errors
   (internal (:sb-sys #:sap-ref-word)
             (internal (:sb-sys #:foreign-symbol-sap) "auto_gc_trigger" t)
             0)))

(defun octets-before-garbage ()
  "Return how many bytes of objects can be made before SBCL next collects garbage; a very large
number if this SBCL does not say."
  (let ((trigger (collection-trigger)))
    (if trigger (- trigger (dynamic-usage)) most-positive-fixnum)))

(defun scrub-stack ()
  "Clear what calls that have returned left on the stack, which would keep objects from being
collected."
  (internal (:sb-sys #:scrub-control-stack)))

(defun collections ()
  "Return an object that is another one after each garbage collection."
  (internal-value :sb-kernel #:*gc-epoch*))
