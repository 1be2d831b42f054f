(in-package :ars-magna.experiment)
(defun sequential-level (look &key (level .05d0)) (/ level look (1+ look)))
(defun wilson-interval (s n &key (confidence .95)) (declare (ignore confidence)) (let ((p (/ s (float n 1d0)))) (values (max 0 (- p (/ 1 (sqrt n)))) (min 1 (+ p (/ 1 (sqrt n)))))))
