;;;; forks-many.lisp -- ten thousand forks of random runs continue as their originals do.

;;; Each fork is compared tick by tick with its original, and with a fork of its own: digests with
;;; plans, messages, traces. The program also looks for state that a fork shares with its original.
;;; The tests make some of these forks.

(in-package :ars-magna.benchmarks)

(handler-bind ((warning #'muffle-warning))
  (asdf:load-system "ars-magna/tests"))

(defun report-forks (title name &rest arguments)
  "Say how many forks the function of the tests called NAME makes, and what is wrong with them."
  (let* ((forks 0) (troubles '())
         (seconds (seconds-for
                   (lambda ()
                     (multiple-value-setq (forks troubles)
                       (apply #'uiop:symbol-call :ars-magna.tests name arguments))))))
    (say title (/ forks seconds) "forks/s, compared")
    (say "  forks" forks "")
    (say "  that go another way, disturb or share" (length troubles) "")
    (loop for trouble in troubles repeat 10 do (print trouble))))

(report-forks "random commands" :forks-of-rides 100 40 1000)
(report-forks "random plans" :forks-of-random-plans 400 10 1000)
(report-forks "shipped errands" :forks-of-errands 500 3 1000)
