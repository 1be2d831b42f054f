;;;; given.lisp -- what users give is copied: what they do to it later is no change of a run.

(in-package :ars-magna.copying)

(export '(given))

(defconstant +longest-given+ 100000 "How many conses and elements a datum has at most.")
(defconstant +deepest-given+ 200 "How deep its lists stand in lists at most.")

(defun copy-given (datum)
  "Return DATUM, what somebody has given us, with the lists and vectors in it copied, so that he can
change it no more; other objects are shared. A second value is true if that cannot be, as it goes on
without end or too far."
  (let ((left +longest-given+))
    (labels ((deeper (depth)
               (when (or (minusp (decf left)) (> depth +deepest-given+))
                 (return-from copy-given (values nil t))))
             (copy (datum depth)
               (typecase datum
                 (string (copy-seq datum))
                 (cons (loop with first = (list nil) with last = first
                             for tail = datum then (cdr tail)
                             while (consp tail)
                             do (deeper depth)
                                (setf last (setf (cdr last)
                                                 (list (copy (car tail) (1+ depth)))))
                             finally (setf (cdr last) tail)
                                     (return (rest first))))
                 (simple-vector (cl:map 'vector (lambda (element)
                                                  (deeper depth)
                                                  (copy element (1+ depth)))
                                        datum))
                 (t datum))))
      (copy datum 1))))

(defun given (operator name datum)
  "Return a copy of DATUM, which OPERATOR got as its argument NAME. Signals WRONG-ARGUMENT if it has
no end."
  (multiple-value-bind (copy endless-p) (copy-given datum)
    (when endless-p
      (reject-argument operator name "what was given"
                       (format nil "lists that end, with at most ~D elements in all, and at most ~
                                    ~D in one another"
                               +longest-given+ +deepest-given+)))
    copy))
