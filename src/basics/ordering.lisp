;;;; ordering.lisp -- the order of names as people expect it: box 2 before box 10.

(in-package :ars-magna.basics)

(export '(name-before-p))

(defun first-part (text start)
  "Return the number that the digits of TEXT from START on make, or else the character there, and
where what follows begins."
  (let ((end (or (position-if-not #'digit-char-p text :start start) (length text))))
    (if (> end start)
        (values (parse-integer text :start start :end end) end)
        (values (char text start) (1+ start)))))

(defun part-before-p (one other)
  "True if ONE, a number or character, comes before OTHER: numbers come first."
  (cond ((and (numberp one) (numberp other)) (< one other))
        ((and (characterp one) (characterp other)) (char< one other))
        (t (numberp one))))

(defun name-before-p (a b)
  "True if the string A comes before B in a list: by characters, but digits by the number that they
make."
  (loop with at-a = 0 and at-b = 0
        do (cond ((= at-b (length b)) (return nil))
                 ((= at-a (length a)) (return t)))
           (multiple-value-bind (part-a next-a) (first-part a at-a)
             (multiple-value-bind (part-b next-b) (first-part b at-b)
               (unless (eql part-a part-b) (return (part-before-p part-a part-b)))
               (setf at-a next-a at-b next-b)))))
