;;;; abridging.lisp -- data as messages show them: what is long or has no end, in part.

(in-package :ars-magna.basics)

(export '(abridged safe-text unqualified-text text-as-typed +more+))

;;; A message quotes what is wrong. That may be a circle, a list of lists a thousand deep or a text
;;; of megabytes, and the message should be read all the same.

(defconstant +most-parts+ 150 "How many conses a message shows of a datum at most.")
(defconstant +most-characters+ 200 "How many characters a message shows of a text at most.")

(defstruct (remark (:constructor make-remark (text)) (:copier nil))
  "TEXT that stands, in a datum, for what is left out of it."
  (text "" :type string :read-only t))

(defmethod print-object ((remark remark) stream)
  (write-string (remark-text remark) stream))

(defmethod make-load-form ((remark remark) &optional environment)
  (declare (ignore environment))
  `(make-remark ,(remark-text remark)))

(define-global +more+ (make-remark "...") "What stands for more of the same.")

(defun abridged-atom (atom)
  "Return ATOM, or what stands for it if it is long."
  (typecase atom
    (string (cut atom +most-characters+))
    (symbol (if (< +most-characters+ (length (symbol-name atom)))
                (make-remark (cut (symbol-name atom) +most-characters+))
                atom))
    (integer (if (< 500 (integer-length atom))
                 (make-remark (format nil "an integer of ~D bits" (integer-length atom)))
                 atom))
    (ratio (if (< 500 (+ (integer-length (numerator atom)) (integer-length (denominator atom))))
               (make-remark (format nil "a ratio near ~A" (ratio-size atom)))
               atom))
    (array (make-remark (format nil "an array of ~{~D~^ by ~}" (array-dimensions atom))))
    (t atom)))

(defun ratio-size (ratio)
  "Return RATIO as a float, or in words if it is too large or too small for one."
  (let ((bits (- (integer-length (numerator ratio)) (integer-length (denominator ratio)))))
    (cond ((< bits -1000) "0")
          ((< 1000 bits) (format nil "2^~D" bits))
          (t (double ratio)))))

(defun abridged (datum)
  "Return DATUM; of one that is long or has no end, its beginning, with dots for the rest."
  (let ((left +most-parts+))
    (labels ((visit (datum)
               (cond ((atom datum) (abridged-atom datum))
                     ((minusp (decf left)) +more+)
                     (t (list-from datum))))
             (list-from (conses)
               (loop for tail = conses then (cdr tail)
                     while (and (consp tail) (<= 0 left))
                     collect (visit (car tail)) into elements
                     do (decf left)
                     finally (return (nconc elements (rest-of tail)))))
             (rest-of (tail)
               (cond ((null tail) '())
                     ((consp tail) (list +more+))
                     (t (abridged-atom tail)))))
      (visit datum))))

(defun without-packages (datum)
  "Return DATUM, which is abridged, with symbols of the same names, but of no package, in it."
  (typecase datum
    (cons (cons (without-packages (car datum))
                (and (cdr datum) (without-packages (cdr datum)))))
    (keyword datum)
    (symbol (make-symbol (symbol-name datum)))
    (t datum)))

(defun unqualified-text (datum)
  "Return how DATUM, abridged, is written, but for the packages of its symbols."
  (let ((*print-gensym* nil))
    (prin1-to-string (without-packages (abridged datum)))))

(defun text-as-typed (datum)
  "Return how DATUM, a symbol or the like, is typed, in lower case: between bars where it has to be,
as with blanks in it."
  (let ((*print-case* :downcase)) (unqualified-text datum)))

(defun safe-text (object &key (escape t) (length 500))
  "Return what PRIN1, or PRINC unless ESCAPE is true, writes of OBJECT: of what is deep, long or
circular a part, at most LENGTH characters, but for the packages of symbols; words that say so if it
cannot be printed."
  (handler-case
      (let ((*print-circle* t) (*print-pretty* nil) (*print-readably* nil) (*print-escape* escape)
            (*print-length* (or *print-length* 100))
            (*print-level* (or *print-level* 20))
            (*print-gensym* nil) (*print-base* 10) (*print-radix* nil))
        (cut (write-to-string (if (typep object '(or cons string bit-vector number symbol))
                                  (without-packages (abridged object))
                                  object))
             length))
    ((or error storage-condition) () "what cannot be printed")))
