;;;; rap-memory.lisp -- the memory of reactive action packages: threads, cost, values, texts.

(in-package :ars-magna.tests.rap)

(def-suite* ars-magna.tests::rap-memory :in ars-magna.tests::ars-magna)

(def-interp-proc remember-often (count)
  (dotimes (n count)
    (when (zerop (mod n 10)) (wait-time 1))
    (memory-add (list 'in-plan n))))

(defmacro in-live-rap-run (&body body)
  `(ars-magna.tests::with-stopped-run (rapper)
     (simulator 'rapper :rate :free :display nil)
     (rpl-init-robot (find-robot 'rapper))
     (unwind-protect (progn ,@body) (stop-simulator))))

(test rap-memory.threads-and-plans-lose-no-fact
  (in-live-rap-run
    (begin-plan 'remember-often 50)
    (mapc #'ars-magna.base:join-thread
          (loop for thread below 3
                collect (let ((thread thread))
                          (ars-magna.base:start-thread
                           (lambda ()
                             (dotimes (n 30)
                               (memory-add (list 'in-thread thread n))
                               (memory-set (list 'newest thread n))))
                           "remembering"))))
    (await-idle)
    (is (= (+ 50 (* 3 31)) (length main-memory*)))
    (is (equal '(0 1 2) (sort (memory-query '?who '(newest ?who 29)) #'<)))))
