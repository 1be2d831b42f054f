;;;; events.lisp -- events per second of chains of events, each of which queues the next.

(in-package :ars-magna.benchmarks)

(defun chains (count events longest)
  "Return a function that runs EVENTS events of COUNT chains with delays from 1 to LONGEST."
  (lambda ()
    (let ((agenda (time:make-agenda)) (ran 0))
      (declare (type fixnum ran events longest) (optimize speed))
      (flet ((again (event)
               (incf ran)
               (time:queue-again agenda event (1+ (mod (* ran 31) longest)))))
        (dotimes (chain count)
          (time:queue-event agenda (1+ (mod (* chain 7919) longest)) #'again))
        (loop while (< ran events) do (time:advance-agenda agenda))))))

(loop for (count longest) in '((1 1) (1000 1) (1000 1000) (100000 1) (100000 1000))
      do (say (format nil "~:D chain~:P with delays up to ~:D" count longest)
              (per-second 3000000 (chains count 3000000 longest)) "events/s"))
