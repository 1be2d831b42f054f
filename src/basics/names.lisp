;;;; names.lisp -- comparing names without their packages; ordering names.

(in-package :ars-magna.basics)

(export '(same-name-p nearest-name resembles-p value-equal name-string name-before-p))

;;; The manual compares attribute values, place types, substances, maps and manipulations by name:
;;; `red' read in the user's package is the `red' of the definition.

(defun name-string (name)
  "Return the name of NAME, a symbol or string, in upper case."
  (string-upcase (string name)))

(defun called-alike-p (a b)
  "True if the symbols or strings A and B have the same name. Most differ in length."
  (declare #.*hot*)
  (let ((a (if (symbolp a) (symbol-name a) (string a)))
        (b (if (symbolp b) (symbol-name b) (string b))))
    (and (= (length a) (length b)) (string-equal a b))))

(declaim (inline same-name-p))
(defun same-name-p (a b)
  "True if the symbols or strings A and B have the same name, regardless of package and case."
  (or (eq a b) (called-alike-p a b)))

(defun value-equal (a b)
  "True if A and B are the same attribute value: symbols by name, numbers by value, lists by
both (reading 38)."
  (cond ((eq a b) t)
        ((and (symbolp a) (symbolp b)) (and a b (same-name-p a b)))
        ((and (numberp a) (numberp b)) (= a b))
        ((and (stringp a) (stringp b)) (string= a b))
        ((and (consp a) (consp b))
         (and (value-equal (car a) (car b)) (value-equal (cdr a) (cdr b))))))

(defun edit-distance (a b)
  "Return how many insertions, deletions, replacements and swaps of neighbours turn A into B."
  (let ((rows (make-array (list (1+ (length a)) (1+ (length b))))))
    (dotimes (i (1+ (length a)) (aref rows (length a) (length b)))
      (dotimes (j (1+ (length b)))
        (setf (aref rows i j)
              (if (or (zerop i) (zerop j))
                  (+ i j)
                  (min (1+ (aref rows (1- i) j))
                       (1+ (aref rows i (1- j)))
                       (if (char-equal (char a (1- i)) (char b (1- j)))
                           (aref rows (1- i) (1- j))
                           (1+ (aref rows (1- i) (1- j))))
                       (if (exchanged-p a i b j)
                           (1+ (aref rows (- i 2) (- j 2)))
                           (+ i j)))))))))

(defun exchanged-p (a i b j)
  "True if the two characters before I in A are those before J in B the other way round."
  (and (< 1 i) (< 1 j)
       (char-equal (char a (- i 1)) (char b (- j 2)))
       (char-equal (char a (- i 2)) (char b (- j 1)))))

(defun nearest-name (name names)
  "Return the one of NAMES most like NAME, or NIL if none is similar or NAME has more than 100
characters."
  (let ((names (and (<= (length (string name)) 100) names))
        (best nil)
        (least (max 2 (floor (length (string name)) 2))))
    (dolist (candidate names best)
      (let ((distance (edit-distance (string name) (string candidate))))
        (when (< distance least)
          (setf best candidate least distance))))))

(defparameter *letters-alike* '("AEIOUY" "CKQ" "CSZ" "FVW" "GJ")
  "Letters that may sound alike.")

(defun alike-p (letter other)
  "True if the characters LETTER and OTHER are equal or may sound alike."
  (or (char-equal letter other)
      (some (lambda (letters)
              (and (find letter letters :test #'char-equal)
                   (find other letters :test #'char-equal)))
            *letters-alike*)))

(defun another-word-p (a b)
  "True if the short names A and B, of one length, differ in a letter that does not sound alike:
SISE may be a misspelling of SIZE, SIDE is not."
  (and (= (length a) (length b))
       (< (length a) 6)
       (= 1 (count nil (map 'list #'char-equal a b)))
       (notevery #'alike-p a b)))

(defun resembles-p (a b)
  "True if the name A may be a misspelling of the different name B: one letter apart, or two if they
are long. In short names, and at their beginning, a different letter makes another word, unless the
two sound alike."
  (let* ((a (string a)) (b (string b)) (shorter (min (length a) (length b))))
    (and (plusp shorter)
         (or (alike-p (char a 0) (char b 0))
             (and (/= (length a) (length b)) (<= 3 shorter)))
         (<= 1 (edit-distance a b) (if (<= 8 shorter) 2 1))
         (not (another-word-p a b)))))

;;; Natural order of names: box 2 before box 10.

(defun first-part (text start)
  "Return the number or else the character in TEXT at START, and the position after it."
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
  "True if the string A sorts before B: by characters, and by the values of the numbers in them."
  (loop with at-a = 0 and at-b = 0
        do (cond ((= at-b (length b)) (return nil))
                 ((= at-a (length a)) (return t)))
           (multiple-value-bind (part-a next-a) (first-part a at-a)
             (multiple-value-bind (part-b next-b) (first-part b at-b)
               (unless (eql part-a part-b) (return (part-before-p part-a part-b)))
               (setf at-a next-a at-b next-b)))))
