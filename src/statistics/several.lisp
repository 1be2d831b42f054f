;;;; several.lisp -- what is left of a test when it is one of several.

(in-package :ars-magna.statistics)

(defun fill-holm (shares ranked)
  "Set the elements of the vector SHARES to what they are worth among the others; RANKED are its
indexes, from the least share on."
  (loop with worth = 0d0
        for index in ranked
        for left downfrom (length shares)
        do (setf worth (max worth (min 1d0 (* left (aref shares index))))
                 (aref shares index) worth)))

(addition holm-adjusted)
(defun holm-adjusted (p-values)
  "Return a list of P-VALUES, a list or vector, each as it counts among so many tests: if all whose
result is at most .05 are called real, one or more of them are not so with a probability of at most
.05 (Holm 1979; Wright 1992 for the adjustment). They are in the order given; of equal ones the
result is equal. Signals WRONG-ARGUMENT unless P-VALUES are numbers from 0 to 1."
  (check-argument holm-adjusted p-values (elements-p p-values #'probability-p)
                  "a list or vector of numbers from 0 to 1")
  (let ((shares (map 'doubles #'meant p-values)))
    (fill-holm shares (stable-sort (loop for i below (length shares) collect i) #'<
                                   :key (lambda (i) (aref shares i))))
    (coerce shares 'list)))
