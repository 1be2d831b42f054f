;;;; patterns.lisp -- what goals look like: matching, and which pattern is the more specific.

(in-package :ars-magna.rpl.constructs)

;;; In a shape, a pattern made ready for matching, a HOLE is where anything may be; the holes of one
;;; variable are one hole, and match the same. The rest compares as attribute values do: symbols by
;;; name, numbers by value.

(defstruct (hole (:constructor make-hole (variable index)) (:copier nil))
  "The place of VARIABLE, the one number INDEX, in a shape."
  (variable nil :type symbol :read-only t)
  (index 0 :type fixnum :read-only t))

(defun parse-pattern (pattern)
  "Return the shape of PATTERN, in which ?x stands for the variable x, and its variables in order."
  (let ((holes '()))
    (labels ((hole-of (variable)
               (or (find variable holes :key #'hole-variable)
                   (first (push (make-hole variable (length holes)) holes))))
             (shape (pattern)
               (let ((variable (variable-of pattern)))
                 (cond (variable (hole-of variable))
                       ((consp pattern) (cons (shape (car pattern)) (shape (cdr pattern))))
                       (t pattern)))))
      (let ((shape (shape pattern)))
        (values shape (mapcar #'hole-variable (reverse holes)))))))

(defun fits-p (shape object values)
  "True if SHAPE matches OBJECT. VALUES, a vector whose elements are at first itself, gets to hold
what is in the holes."
  (cond ((hole-p shape)
         (let ((value (svref values (hole-index shape))))
           (cond ((eq value values) (setf (svref values (hole-index shape)) object) t)
                 (t (value-equal value object)))))
        ((consp shape)
         (and (consp object)
              (fits-p (car shape) (car object) values)
              (fits-p (cdr shape) (cdr object) values)))
        (t (value-equal shape object))))

(defun match-shape (shape count object)
  "Return true if SHAPE, with COUNT holes, matches OBJECT, and a list of what is in the holes."
  (let ((values (make-array count)))
    (fill values values)                ; an object that is in no pattern and no goal
    (and (fits-p shape object values)
         (values t (coerce values 'list)))))

(defun covers-p (shape count other)
  (values (match-shape shape count other)))

(defun pattern-text (pattern)
  "Return PATTERN as people write it, without packages."
  (labels ((plain (pattern)
             (cond ((variable-of pattern)
                    (make-symbol (format nil "?~A" (plain-name (variable-of pattern)))))
                   ((consp pattern) (cons (plain (car pattern)) (plain (cdr pattern))))
                   ((and pattern (symbolp pattern)) (make-symbol (plain-name pattern)))
                   (t pattern))))
    (let ((*print-gensym* nil) (*print-pretty* nil))
      (safe-text (plain pattern) :escape nil))))
