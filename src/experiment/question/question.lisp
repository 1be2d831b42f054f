;;;; question.lisp -- what an experiment asks, as it stands above tables and pictures.

(in-package :ars-magna.experiment)

(defun first-sentence (text)
  "Return the first sentence of TEXT, in one line."
  (let* ((paragraph (search (format nil "~2%") text))
         (line (one-line (subseq text 0 paragraph)))
         (end (loop for mark in '(". " "? " "! ")
                    for place = (search mark line)
                    when place minimize (1+ place))))
    (if (and end (plusp end)) (subseq line 0 end) line)))

(defun question-of (name)
  "Return what the experiment that a table calls NAME asks, if that is known, or NIL."
  (let* ((experiment (find-experiment name nil))
         (text (and experiment (experiment-documentation experiment))))
    (and text (string/= "" (one-line text)) (first-sentence text))))
