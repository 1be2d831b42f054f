;;;; names.lisp -- things are called by name, whatever package the name was read in.

(in-package :ars-magna.base)

;;; The manual compares attribute values, place types, substances, maps and manipulations by
;;; what they are called: `red' read in the user's package is the `red' of the definition.

(defun name-string (name)
  "Return what NAME (a symbol or string) is called, in upper case."
  (string-upcase (string name)))

(declaim (inline same-name-p))
(defun same-name-p (a b)
  "True if the symbols or strings A and B are called the same, whatever their packages and case."
  (or (eq a b) (string-equal a b)))

(defun value-equal (a b)
  "True if A and B are the same attribute value: symbols by name, numbers by value, lists by both."
  (cond ((eq a b) t)
        ((and (symbolp a) (symbolp b)) (and a b (same-name-p a b)))
        ((and (numberp a) (numberp b)) (= a b))
        ((and (stringp a) (stringp b)) (string= a b))
        ((and (consp a) (consp b))
         (and (value-equal (car a) (car b)) (value-equal (cdr a) (cdr b))))))

(defun edit-distance (a b)
  "Return how many insertions, deletions and replacements turn the string A into B."
  (let ((row (make-array (1+ (length b)))))
    (dotimes (j (length row)) (setf (aref row j) j))
    (loop for i from 1 to (length a)
          for diagonal = (aref row 0)
          do (setf (aref row 0) i)
             (loop for j from 1 to (length b)
                   for above = (aref row j)
                   do (setf (aref row j)
                            (min (1+ above)
                                 (1+ (aref row (1- j)))
                                 (if (char-equal (char a (1- i)) (char b (1- j)))
                                     diagonal
                                     (1+ diagonal)))
                            diagonal above)))
    (aref row (length b))))

(defun nearest-name (name names)
  "Return the one of NAMES most like NAME, or NIL if none is at all like it."
  (let ((best nil)
        (least (max 2 (floor (length (string name)) 2))))
    (dolist (candidate names best)
      (let ((distance (edit-distance (string name) (string candidate))))
        (when (< distance least)
          (setf best candidate least distance))))))

(defun resembles-p (a b)
  "True if the name A is so much like the different name B that one may be a slip for the other:
one letter apart, or two if they are long or only exchanged."
  (let* ((a (string-upcase a)) (b (string-upcase b))
         (distance (edit-distance a b)))
    (or (= distance 1)
        (and (= distance 2)
             (or (<= 8 (min (length a) (length b)))
                 (string= (sort (copy-seq a) #'char<) (sort (copy-seq b) #'char<)))))))

(defun reject-name (kind name known)
  "Signal UNKNOWN-NAME: nothing of KIND (a string) among the names KNOWN is called NAME."
  (error 'unknown-name :kind kind :name name :known known
                       :nearest (and (typep name '(or symbol string))
                                     (nearest-name name known))))
