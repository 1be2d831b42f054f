;;;; agreement.lisp -- random runs, forked, rewound, saved and replayed, go on the same way.

;;; ./tests/benchmarks/run agreement [COUNT] makes COUNT runs, 500 by default, the same each time.
;;; It prints the differences, with the shortest script for five of them; the exit status is then 1.
;;; tests/agreement-scripts.lisp has the requests, and what no copy can have. The tests make some of
;;; these runs.

(in-package :ars-magna.benchmarks)

(handler-bind ((warning #'muffle-warning))
  (asdf:load-system "ars-magna/tests"))

(defparameter *runs* (parse-integer (or (uiop:getenv "BENCHMARK_NUMBER") "500")))

(defun counted (items)
  "Return a list (item . count) for each of ITEMS that there is."
  (loop for item in (remove-duplicates items :test #'equal)
        collect (cons item (count item items :test #'equal))))

(defun say-shortest (script differences)
  "Print DIFFERENCES of SCRIPT, and the shortest script with such."
  (format t "~&  ~S~%" differences)
  (pprint (uiop:symbol-call :ars-magna.tests :shortest-script script)))

(defun say-agreement (disagreements refusals seconds)
  "Print how many runs there were in so many SECONDS, and their DISAGREEMENTS."
  (say "random runs, each on six ways" (/ *runs* seconds) "runs/s")
  (say "  runs" *runs* "")
  (say "  that agree on all ways" (- *runs* (length disagreements)) "")
  (loop for ((way what) . count) in (counted (loop for (nil . differences) in disagreements
                                                   append (loop for (way what) in differences
                                                                collect (list way what))))
        do (say (format nil "  ~(~A: another ~A~)" way what) count ""))
  (loop for (reason . count) in (counted refusals)
        do (say (format nil "  not saved, as ... ~A" reason) count ""))
  (loop for (script . differences) in disagreements
        repeat 5
        do (say-shortest script differences)))

(let (disagreements refusals)
  (let ((seconds (seconds-for
                  (lambda ()
                    (multiple-value-setq (disagreements refusals)
                      (uiop:symbol-call :ars-magna.tests :disagreements-of-runs *runs* 1))))))
    (say-agreement disagreements refusals seconds)
    (when disagreements (uiop:quit 1))))
