;;;; traffic.lisp -- the travels of several robots that the tests make, a thousand of each.

;;; Prints how many fail; none should. A number after the program's name is the number of seeds.

(in-package :ars-magna.benchmarks)

(handler-bind ((warning #'muffle-warning))
  (asdf:load-system "ars-magna/tests"))

(defparameter *seeds* (parse-integer (or (uiop:getenv "BENCHMARK_NUMBER") "1000")))

(defun of-tests (name) (find-symbol name :ars-magna.tests))

(defun failed-seeds (travel names goals clean)
  "Return the seeds, of *SEEDS*, with which the robots in the variable NAMES do not all arrive."
  (loop for seed from 1 to *seeds*
        when (funcall (of-tests travel) (symbol-value (of-tests names))
                      (symbol-value (of-tests goals)) seed :clean clean)
          collect seed))

(loop for (text travel robots) in '(("two robots in a doorway" "TRAVEL-TROUBLES" "HEAD-ON")
                                    ("a plan and a program in a doorway" "PLAN-TRAVEL-TROUBLES"
                                     "HEAD-ON")
                                    ("two robots in a corridor" "TRAVEL-TROUBLES" "IN-CORRIDOR")
                                    ("ten robots through a doorway" "TRAVEL-TROUBLES" "CONVOY")
                                    ("five robots against five" "TRAVEL-TROUBLES" "BOTH-WAYS"))
      for names = (format nil "*~A*" robots)
      for goals = (format nil "*~A-GOALS*" robots)
      do (dolist (clean '(nil t))
           (let* ((failed '())
                  (seconds (seconds-for
                            (lambda () (setf failed (failed-seeds travel names goals clean))))))
             (say (format nil "~A, ~:[noisy~;clean~]: failed of ~:D" text clean *seeds*)
                  (length failed) "")
             (say "  travels" (/ *seeds* seconds) "travels/s")
             (format t "~@[  seeds ~{~D~^ ~}~%~]" (subseq failed 0 (min 10 (length failed)))))))
