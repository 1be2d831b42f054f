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

(defun text-of-refusal-by (function)
  "Return the text of the ARS-MAGNA-ERROR that FUNCTION signals."
  (handler-case (progn (funcall function) "")
    (ars-magna-error (trouble) (princ-to-string trouble))))

(test rap-memory.holds-more-facts-than-a-user-can-set-and-is-saved
  (ars-magna.tests::with-temporary-file (file)
    (in-rap-run
      ;; Short of 10,001 calls of MEMORY-ADD.
      (asking ((current-simulation))
        (ars-magna.run:update-run-variable
         'main-memory*
         (lambda (entries)
           (append entries (loop for n below 10001 collect (list (list 'part n) 0))))
         'reset-memory))
      (memory-add '(part all))
      (is (= 10002 (length main-memory*)))
      (is (equal '((part all) 0) (first main-memory*)))
      (is (= 10002 (with-fork () (length main-memory*))))
      (let ((digest (state-digest)))
        (save-simulation file)
        (with-loaded-simulation (file)
          (is (= digest (state-digest)))
          (is (memory-holds-p '(part 10000))))))))

(test rap-memory.a-full-memory-says-so-and-names-the-fact
  (in-rap-run
    (let ((ars-rap::*memory-limit* 2))
      (mapc #'memory-add '((a 1) (a 2) (a 1)))
      (is (equal '((a 1) (a 2)) (mapcar #'first main-memory*)))
      (let ((text (text-of-refusal-by (lambda () (memory-add '(a 3))))))
        (is (search "memory-add: there is no room for the fact (a 3)" text)))
      (memory-set '(a 4))
      (is (equal '((a 4)) (mapcar #'first main-memory*))))))

(test rap-memory.the-journal-records-changes-and-repeats-them
  (with-simulation (rapper :seed 1 :journal t :keep t)
    (run-ticks 1)
    (mapc #'memory-add '((at a b) (at b c) (on c d) (on a b)))
    (run-ticks 2)
    (memory-set '(at a c))
    (memory-delete '(on ?x ?))
    (memory-delete '(no such fact))
    (let ((entries (journal-entries (simulation-journal (current-simulation)))))
      (is (equal '(memory-add memory-add memory-add memory-add memory-set memory-delete)
                 (mapcar #'second entries)))
      (is (equal '(3 memory-delete (on :?x :?)) (first (last entries)))))
    (is (= (state-digest) (nth-value 1 (replay (simulation-journal (current-simulation))))))
    (run-ticks 1)
    (let ((digest (state-digest)))
      (run-ticks 5)
      (reset-memory)
      (rewind 5)
      (is (= digest (state-digest))))))

(test rap-memory.facts-do-not-change-with-the-callers-data
  (in-rap-run
    (let* ((text (copy-seq "cup")) (vector (vector 1 2)) (fact (list 'seen text vector)))
      (memory-add fact)
      (setf (char text 0) #\p (svref vector 0) 7 (second fact) nil)
      (is (equalp '((seen "cup" #(1 2))) (mapcar #'first main-memory*))))))

(test rap-memory.finds-facts-with-vectors
  (in-rap-run
    (memory-add '(v #(1 2)))
    (memory-add '(v #(1 2)))
    (is (= 1 (length main-memory*)))
    (is (memory-holds-p '(v #(1 2.0))))
    (is (not (memory-holds-p '(v #(1 2 3)))))
    (is (equalp '(#(1 2)) (memory-query '?x '(v ?x))))))

(test rap-memory.an-unsuitable-fact-is-named
  (in-rap-run
    (dolist (fact (list (list 'g #'car) (list 'g (make-hash-table)) '(g (1 . 2))))
      (dolist (operator '(memory-add memory-set))
        (let ((text (text-of-refusal-by (lambda () (funcall operator fact)))))
          (is (search (string-downcase operator) text) "~A" text)
          (is (search "(G " text) "~A" text)
          (is (not (search "main-memory*" text)) "~A" text))))
    (is (null main-memory*))))

(test rap-memory.says-what-needs-a-run
  (loop for (variable function) in (list (list "main-memory*" (lambda () (memory-add '(g 1))))
                                         (list "main-agenda*"
                                               (lambda () (install-goal '(rap-work a 1)))))
        for text = (text-of-refusal-by function)
        do (is (search (format nil "The run variable ~A has a value only in a run" variable) text)
               "~A" text)))

(test rap-memory.dumps-facts-as-they-can-be-typed
  (in-rap-run
    (mapc #'memory-add '((says "cup") (says cup) (says #\a) (at #(a "b") :key nil)))
    (is (equal '("0  (at #(a \"b\") :key nil)" "0  (says #\\a)" "0  (says cup)" "0  (says \"cup\")")
               (mapcar (lambda (line) (string-trim " " line))
                       (uiop:split-string (string-right-trim '(#\Newline)
                                                             (with-output-to-string (out)
                                                               (dump-memory :stream out)))
                                          :separator '(#\Newline)))))))

(test rap-memory.variables-are-compared-by-name
  (in-rap-run
    (memory-add '(have cup 1))
    (memory-add '(have cup cup))
    (is (equal '((cup)) (memory-query '(ars-magna.tests::?x) '(have ?x ?))))
    (is (equal '(cup) (memory-query '?x '(have ars-magna.tests::?x ?x))))
    (is (equal '(cup) (memory-query '?x '(and (have ?x ?n) (= ars-magna.tests::?n 1)))))))

(test rap-memory.refuses-data-without-end
  (flet ((circle (place) (let ((list (list 'a 2))) (funcall place list list) list)))
    (in-rap-run
      (dolist (data (list (circle (lambda (new list) (setf (cddr list) new)))
                          (circle (lambda (new list) (setf (car list) new)))))
        (dolist (fact (list (list 'x data) (cons 'x data)))
          (signals wrong-argument (memory-add fact))
          (signals wrong-argument (memory-set fact))
          (signals wrong-argument (memory-tick fact)))
        (is (= 0 (memory-delete (list 'x data)))))
      (is (null main-memory*)))))
