;;;; texts.lisp -- numbers and counts as they are written in a report.

(in-package :ars-magna.experiment)

(defun fixed-text (number decimals)
  "Return NUMBER with so many DECIMALS."
  (multiple-value-bind (whole rest)
      (truncate (abs (round (* (rational number) (expt 10 decimals)))) (expt 10 decimals))
    (format nil "~:[~;-~]~D~:[~;.~V,'0D~]" (and (minusp number) (plusp (+ whole rest)))
            whole (plusp decimals) decimals rest)))

(defun tally-text (tally most)
  "Return TALLY, an alist from texts to counts, in one line, the MOST commonest first."
  (flet ((counted (text count)
           (unbroken (format nil "~A (~D)" (cut text 60) count))))
    (let ((rest (nthcdr most tally)))
      (format nil "~{~A~^, ~}"
              (append (loop for (text . count) in tally
                            repeat most collect (counted text count))
                      (and rest (list (counted "others" (reduce #'+ rest :key #'cdr)))))))))
