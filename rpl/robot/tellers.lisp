;;;; tellers.lisp -- whether kickers may tell plans something, by what their code calls.

(in-package :ars-magna.rpl-robot)

;;; A plan that waits for a fluent waits in vain if nothing is left that could change that. Kickers
;;; run on by themselves; most of them move things, and know no fluents. So their code is looked
;;; through, and that of users' functions which it calls.

(defparameter *functions-that-tell*
  '(set-value pulse (setf fluent-value) begin-plan)
  "The names of functions by which code may change a fluent, or have a plan do so.")

(defun tells-p (object seen)
  "True if OBJECT, in the code of a function, or what that calls, may change a fluent. SEEN is a
table of what has been looked through."
  (cond ((member object *functions-that-tell* :test #'equal))
        ((gethash object seen) nil)
        ((functionp object)
         (setf (gethash object seen) t)
         (some (lambda (part) (tells-p part seen)) (code-references object)))
        ((and (symbolp object) (users-symbol-p object) (fboundp object)
              (not (macro-function object)))
         (setf (gethash object seen) t)
         (tells-p (fdefinition object) seen))))

(defvar *tellers* (make-hash-table :test 'eq :weakness :key :synchronized t)
  "What is known of the kickers in the run of an interface: lists of conses (kicker . tells-p).")

(defun telling-kicker-p (kicker interface)
  (let ((known (assoc kicker (gethash interface *tellers*) :test #'eq)))
    (if known
        (cdr known)
        (let* ((seen (make-hash-table :test 'eq))
               (answer (and (or (tells-p (kicker-body kicker) seen)
                                (tells-p (kicker-test kicker) seen))
                            t)))
          (push (cons kicker answer) (gethash interface *tellers*))
          answer))))

(defun kickers-may-tell-p (interface)
  (some-kicker (lambda (kicker) (telling-kicker-p kicker interface))
               (simulation-world (interface-simulation interface))))
