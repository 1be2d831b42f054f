;;;; question.lisp -- what an experiment asks, and what people want to know of it.

(in-package :ars-magna.experiment)

(defun first-sentence (text)
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

(define-facts (experiment experiment)
  "Robots" (listed (experiment-robots experiment))
  "Varies" (listed (factor-names experiment))
  "Conditions" (length (experiment-conditions experiment))
  "Trials of each" (experiment-trials experiment)
  "Ends at tick" (experiment-limit experiment)
  "Measures" (listed (mapcar #'first (experiment-measures experiment)))
  "Each tick" (listed (mapcar #'first (experiment-series experiment))))
