;;;; approaches.lisp -- the approaches of the tests, ten thousand clean and as many noisy.

;;; Prints how many of those with a free straight way succeed. The tests make some hundreds of the
;;; same settings. Set *COUNT* for another number.

(in-package :ars-magna.benchmarks)

(handler-bind ((warning #'muffle-warning))
  (asdf:load-system "ars-magna/tests"))

(defvar *count* 10000)

(defun failed-approaches (seed &rest options)
  "Return what went wrong in *COUNT* settings that are not in the way, from SEED on."
  (apply #'uiop:symbol-call :ars-magna.tests :failed-approaches
         (uiop:symbol-call :ars-magna.tests :free-settings *count* seed)
         options))

(defun say-arrivals (name failed)
  (say name (- *count* (length failed)) "")
  (loop for (setting . troubles) in failed repeat 5
        do (format t "~S~%  ~S~%" setting troubles)))

(let ((clean '()) (noisy '()))
  (let ((seconds (seconds-for
                  (lambda ()
                    (setf clean (failed-approaches 1 :clean t)
                          noisy (failed-approaches
                                 1000000
                                 :parameters '((base:prob-lose-track* 0)
                                               (base:false-thing-prob* 0))))))))
    (say "approaches in rooms made at random" (/ (* 2 *count*) seconds) "approaches/s")
    (say-arrivals (format nil "  of ~:D clean ones, arrivals" *count*) clean)
    (say-arrivals (format nil "  of ~:D noisy ones, arrivals" *count*) noisy)))
