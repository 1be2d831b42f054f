;;;; several-plans.lisp -- random plans of several robots of a run end when, and how, a model says.

;;; Half of the cases end plans at random ticks, or call RPL-INIT-ROBOT. The tests make some of
;;; these cases.

(in-package :ars-magna.benchmarks)

(handler-bind ((warning #'muffle-warning))
  (asdf:load-system "ars-magna/tests"))

(defun report-cases (title count seed kills-p)
  "Say what is wrong with COUNT random cases."
  (let ((troubles '()) (plans 0) (ordered 0))
    (let ((seconds (seconds-for
                    (lambda ()
                      (multiple-value-setq (troubles plans ordered)
                        (uiop:symbol-call :ars-magna.tests :troubles-with-random-cases
                                          count seed kills-p))))))
      (say title (/ plans seconds) "plans/s")
      (say "  plans of two to five robots" plans "")
      (say "  runs in which the order within a tick matters" ordered "")
      (say "  runs that differ from the model" (length troubles) "")
      (loop for trouble in troubles repeat 10 do (print trouble)))))

(report-cases "random plans of several robots" 3000 1992 nil)
(report-cases "random plans of several robots, some ended" 3000 1993 t)

(let* ((troubles '())
       (seconds (seconds-for
                 (lambda ()
                   (setf troubles (uiop:symbol-call :ars-magna.tests :troubles-with-rewinds
                                                    2000 1994))))))
  (say "random plans of several robots, rewound" (/ 2000 seconds) "rewinds/s")
  (say "  runs that go another way after the rewind" (length troubles) "")
  (loop for trouble in troubles repeat 10 do (print trouble)))
