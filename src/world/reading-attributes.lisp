;;;; reading-attributes.lisp -- the attributes that things have, and what is said of wrong names.

(in-package :ars-magna.world)

(defun carried-p (key world)
  "True if any thing of WORLD says something of the attribute KEY."
  (do-things (thing world)
    (when (assoc key (thing-attributes thing) :test #'eq)
      (return-from carried-p t))))

;;; What programs ask of a thing, or give it, many a time: of most names it is known what they may
;;; be slips for. What is asked for may also be a slip for what a thing has that nobody declared.

(define-global *likenesses* (make-hash-table :test 'eq :synchronized t)
  "For names that are not declared, the name that each may be a slip for, or NIL.")

(defun carried-name-like (key world)
  "Return the name of an undeclared attribute, of a thing of WORLD, for which KEY may be a slip; or
NIL."
  (do-things (thing world)
    (loop for (other) in (thing-attributes thing)
          when (and (not (attribute-of other)) (resembles-p key other))
            do (return-from carried-name-like other))))

(defun known-likeness (key world)
  "Return the name, declared or had by a thing of WORLD, for which KEY, undeclared, may be a slip."
  (multiple-value-bind (like known-p) (gethash key *likenesses*)
    (if known-p
        like
        (setf (gethash key *likenesses*)
              (or (declared-name-like key) (carried-name-like key world))))))

(defun note-slip (operator thing key &key read)
  "Warn, once, if OPERATOR was given KEY for an attribute of THING, in a world, which is declared by
nobody, had by nothing, and looks like a declared one or, if it is READ, like one that is had."
  (let ((world (thing-world thing)))
    (when (and world (not (attribute-of key)))
      (let ((like (known-likeness key world)))
        (when (and like
                   (or read (declared-name-like key))
                   (not (said-p key world))
                   (not (carried-p key world)))
          (warn-once key world
                     (format nil "~(~A~) of ~(~A~): ~(~S~) is not declared, and nothing here has ~
                                  it; did you mean ~(~S~)?"
                             operator (thing-name thing) key like)))))))

(public get-attribute)
(settable get-attribute)
(defun get-attribute (thing attribute)
  "Return the value of ATTRIBUTE, a keyword, of THING, or NIL if it is unspecified. Can be set,
which is SET-ATTRIBUTE (manual 5.3). A list is the thing's own: do not alter it, as SORT does. An
ATTRIBUTE that may be a slip for one that is declared or that a thing has gets a warning, once in a
run."
  (check-argument get-attribute thing (thing-p thing) (argument-type-text 'thing thing))
  (let* ((key (attribute-key attribute))
         (entry (assoc key (thing-attributes thing) :test #'eq)))
    (unless entry (note-slip 'get-attribute thing key :read t))
    (second entry)))

(defun merge-descriptors (new old)
  "Return the object descriptor OLD with what NEW says instead; order as in OLD, then as in NEW."
  (append (loop for entry in old
                collect (or (assoc (first entry) new :test #'eq) entry))
          (remove-if (lambda (entry) (assoc (first entry) old :test #'eq)) new)))

(defun refresh-physics (thing)
  "Make the cached slots of THING agree with its attributes."
  (flet ((number-of (key)
           (let ((value (get-attribute thing key))) (if (realp value) (double value) 0d0)))
         (truth-of (key) (and (get-attribute thing key) t)))
    (setf (thing-obsmove-p thing) (truth-of :obsmove)
          (thing-obsview-p thing) (truth-of :obsview)
          (thing-closed-p thing) (truth-of :closed)
          (thing-size thing) (number-of :size)
          (thing-weight thing) (number-of :weight)
          (thing-capacity thing) (number-of :capacity)
          (thing-substance-p thing) (truth-of :substance)
          (thing-substance-parameter thing)
          (substance-value-parameter (get-attribute thing :substance)))))
