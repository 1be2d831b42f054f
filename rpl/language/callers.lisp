;;;; callers.lisp -- which plans a plan calls.

(in-package :ars-magna.rpl.language)

;;; Nodes hold each other in slots, lists and structures of their own. Calls in Lisp code, and those
;;; of plans that are only known when they are called, do not show.

(defun parts-of (object)
  "Return what OBJECT, of a plan's code, holds that may be code."
  (typecase object
    (procedure '())
    (cons (list (car object) (cdr object)))
    (simple-vector (coerce object 'list))
    (structure-object
     (loop for slot in (class-slot-names (class-of object))
           unless (same-name-p slot 'form)
             collect (slot-value object slot)))))

(addition called-procedures)
(defun called-procedures (procedure)
  "Return a list of the plan procedures that PROCEDURE, one of them, calls by name."
  (let ((seen (make-hash-table :test 'eq))
        (called '()))
    (labels ((visit (object)
               (unless (or (typep object '(or symbol number function)) (gethash object seen))
                 (setf (gethash object seen) t)
                 (when (call-p object) (pushnew (call-procedure object) called))
                 (mapc #'visit (parts-of object)))))
      (visit (procedure-body procedure))
      (reverse called))))
