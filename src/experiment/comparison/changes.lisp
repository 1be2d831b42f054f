;;;; changes.lisp -- what decides the trials of one version of an experiment but not of the other.

(in-package :ars-magna.experiment)

;;; The texts beside two tables say of what parts the fingerprints of their conditions are made. If
;;; the text of the experiment itself is another, success may mean another thing in each: then the
;;; ruler has changed, and not only what is measured with it. PAIRS are lists of a sample of the
;;; newer table and one of the older.

(defun changes-of-pair (pair after before)
  "Return which parts differ between the conditions of PAIR, by the texts in the directories AFTER
and BEFORE; :UNKNOWN if these do not say."
  (let ((now (parts-described (sample-condition (first pair)) after))
        (then (parts-described (sample-condition (second pair)) before)))
    (if (and now then) (changed-parts then now) :unknown)))

(defun changed-pairs (pairs)
  (remove-if (lambda (pair)
               (string= (sample-fingerprint (first pair)) (sample-fingerprint (second pair))))
             pairs))

(defun part-of-kind-p (kind part) (starts-with-subseq (format nil "~A " kind) part))

(defun lines-only-in (lines others title)
  "Return LINES that OTHERS lack, after TITLE, a few of them."
  (let ((only (remove-if (lambda (line) (member line others :test #'string=)) lines)))
    (append (loop for line in only
                  repeat 5
                  collect (format nil "~A: ~A" title (unbroken (cut line 88))))
            (and (nthcdr 5 only) (list (format nil "~A: ..." title))))))

(defun ruler-changes (after before)
  (let ((now (form-described after)) (then (form-described before)))
    (cons (format nil "WARNING: the experiment itself is not the same in both tables. What it ~
                       does, measures or counts as success may be another thing in each, so what ~
                       differs below need not be due to the code.")
          (append (lines-only-in then now "before") (lines-only-in now then "now")))))

(defun parts-words (parts conditions)
  (let ((others (remove-if (lambda (part) (part-of-kind-p "condition" part)) parts)))
    (format nil "What differs between the tables, under ~D condition~:P: ~{~A~^, ~}."
            conditions
            (append others
                    (and (/= (length others) (length parts))
                         (list "the parameters, robots or values of conditions"))))))

(defun leak-lines (pairs)
  "Return lines that warn if trials of PAIRS, with equal fingerprints, have come out differently."
  (let ((count (loop for (sample other) in pairs
                     sum (loop for (i . j) in (common-trials sample other)
                               count (not (same-row-p sample i other j))))))
    (unless (zerop count)
      (list (format nil "WARNING: and yet the rows of ~D trial~:P differ. Something that is in no ~
                         fingerprint decides them, such as what trials leave to each other, a ~
                         clock or a file, or rows have been changed. Neither table can be relied ~
                         on." count)))))

(defun changes-between (pairs after before)
  "Return lines on what decides the trials of PAIRS in one table but not in the other, by the texts
in the directories AFTER and BEFORE, which may be NIL."
  (let* ((changed (changed-pairs pairs))
         (changes (loop for pair in changed
                        collect (if (and after before)
                                    (changes-of-pair pair after before)
                                    :unknown)))
         (parts (remove-duplicates (apply #'append (remove :unknown changes))
                                   :test #'string= :from-end t)))
    (cond ((null changed)
           (cons "Both tables are of the same code and configuration: the fingerprints are equal."
                 (leak-lines pairs)))
          ((null parts)
           (list (format nil "What differs between the tables is not known: the fingerprints do, ~
                              but no experiment.txt beside them says of what.")))
          (t (append (and (some (lambda (part) (part-of-kind-p "experiment" part)) parts)
                          (ruler-changes after before))
                     (list (parts-words parts (length changed))))))))
