;;;; callers.lisp -- which plans a plan calls.

(in-package :ars-magna.rpl.language)

;;; Calls in Lisp code, and those of plans that are only known when they are called, do not show.

(addition called-procedures)
(defun called-procedures (procedure)
  "Return a list of the plan procedures that PROCEDURE, one of them, calls by name."
  (let ((seen (make-hash-table :test 'eq))
        (called '()))
    (labels ((visit (part)
               (unless (or (not (typep part 'node)) (gethash part seen))
                 (setf (gethash part seen) t)
                 (when (call-p part) (pushnew (call-procedure part) called))
                 (mapc #'visit (node-parts part)))))
      (visit (procedure-body procedure))
      (reverse called))))
