;;;; overall.lisp -- two plans, or versions, over several conditions: each seed counts once.

(in-package :ars-magna.experiment)

;;; The trials of a seed under several conditions share their chance, so they are no more than one
;;; observation: for each seed the means over all conditions are compared. Both means of a seed are
;;; of the same conditions, as only pairs count in which both have been measured; and only seeds
;;; count that both have under all conditions. PAIRS are lists of two samples.

(defun complete-seeds (pairs)
  "Return a table of the seeds of which both samples of all PAIRS have a trial."
  (let ((counts (make-hash-table)))
    (loop for (first second) in pairs
          do (loop for (i . nil) in (common-trials first second)
                   do (incf (gethash (aref (sample-seeds first) i) counts 0))))
    (loop for seed being the hash-keys of counts using (hash-value count)
          unless (= count (length pairs)) do (remhash seed counts))
    counts))

(defun values-by-seed (name results other-results pairs seeds)
  "Return lists (seed a b) of what PAIRS, of samples of RESULTS and OTHER-RESULTS, have as NAME in
trials of SEEDS."
  (loop for (first second) in pairs
        for column = (column-of results first name)
        for other = (column-of other-results second name)
        append (loop for (i . j) in (pairs-for name first second)
                     for seed = (aref (sample-seeds first) i)
                     for a = (aref column i)
                     for b = (aref other j)
                     unless (or (eq :none a) (eq :none b) (not (gethash seed seeds)))
                       collect (list seed a b))))

(defun means-by-seed (values)
  "Return the means of A and of B for each seed in VALUES, lists (seed a b) of numbers."
  (let ((sums (make-hash-table)) (seeds '()))
    (loop for (seed a b) in values
          for entry = (or (gethash seed sums)
                          (progn (push seed seeds)
                                 (setf (gethash seed sums) (list '() '()))))
          do (push a (first entry))
             (push b (second entry)))
    (loop for seed in (sort seeds #'<)
          for (firsts-of-seed seconds-of-seed) = (gethash seed sums)
          collect (exact-mean firsts-of-seed) into firsts
          collect (exact-mean seconds-of-seed) into seconds
          finally (return (values firsts seconds)))))

(defun overall-difference (name values)
  "Return the difference in NAME by VALUES, lists (seed a b); NIL of words."
  (flet ((all (test) (loop for (nil a b) in values always (and (funcall test a) (funcall test b))))
         (difference (kind values)
           (multiple-value-bind (firsts seconds) (means-by-seed values)
             (mean-difference (string-downcase name) firsts seconds kind))))
    (cond ((all (lambda (value) (typep value 'boolean)))
           (difference :rate (loop for (seed a b) in values
                                   collect (list seed (if a 1 0) (if b 1 0)))))
          ((some (lambda (entry) (some #'realp (rest entry))) values)
           (difference :mean (remove-if-not (lambda (entry) (every #'finite-value-p (rest entry)))
                                            values))))))

(defun overall-contrast (first second pairs names results &optional (other-results results))
  "Return the contrast of what is called FIRST and SECOND over all PAIRS, lists of samples of
RESULTS and OTHER-RESULTS, in what NAMES say."
  (let ((contrast (make-contrast "over all" first second))
        (seeds (complete-seeds pairs)))
    (setf (contrast-trials contrast) (hash-table-count seeds)
          (contrast-differences contrast)
          (loop for name in names
                for values = (values-by-seed name results other-results pairs seeds)
                for difference = (and values (overall-difference name values))
                when difference collect difference))
    contrast))

(defun worth-overall-p (contrasts)
  "True if CONTRASTS are several, and not all the same runs."
  (and (rest contrasts) (notevery #'same-runs-p contrasts)))
