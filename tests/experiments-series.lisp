;;;; experiments-series.lisp -- what :each-tick records of a trial, and when.

(in-package :ars-magna.tests)

(def-suite* experiments-series :in ars-magna)

;;; A walk that is recorded, and its table.

(defvar *walk-phase* nil "What a walk that is recorded does.")

(defun walk-in-phases ()
  "Drive for 5 ticks, and wait for 3; in between the phase changes."
  (let ((*walk-phase* :driving))
    (command:robot-go-forward ars-worlds:dot 3)
    (run:run-ticks 5)
    (setf *walk-phase* :waiting)
    (run:run-ticks 3)
    (chance-p 2/3)))

(defun define-recorded-walk (&rest clauses)
  "Define WALK, which is recorded as CLAUSES say, or by a place and a phase."
  (eval `(experiment:defexperiment walk
           (:robots ars-worlds:dot)
           (:vary (base:max-speed* 1 2) (mark "=a" "b"))
           (:run (walk-in-phases))
           (:measure (way (robot:robot-x ars-worlds:dot)) (wet (chance-p 1/2)))
           ,@(or clauses '((:each-tick (x (robot:robot-x ars-worlds:dot))
                                       (phase *walk-phase*) (what mark) (rolled (random 1000))
                                       (chance (chance-p 1/2))))))))

(defun series-path (directory) (uiop:subpathname directory "series.csv"))
(defun series-text (directory) (base:file-text (series-path directory)))
(defun series-lines (directory) (file-lines (series-path directory)))

(defun write-series (directory lines &key (end (string #\Newline)))
  (with-open-file (out (series-path directory) :direction :output :if-exists :supersede
                                               :external-format :utf-8)
    (format out "~{~A~^~%~}~A" lines end)))

(defun same-tables-p (directory other)
  (and (string= (table-text directory) (table-text other))
       (string= (series-text directory) (series-text other))))

(defun recorded-in (&rest clauses)
  "Return the series of trial 1 of QUESTION, defined by CLAUSES, and the rest of what is replayed."
  (eval `(define-for-test (:robots ars-worlds:dot) ,@clauses))
  (let ((replay (experiment:replay-trial 'question 1 1)))
    (values (getf replay :series) replay)))

(defun column-at (place series)
  (mapcar (lambda (line) (nth place line)) series))

;;; What is recorded when.

(test each-tick.records-every-tick-once
  (dolist (run '((run:run-ticks 6)
                 (loop repeat 6 do (run:run-ticks 1))
                 (progn (run:run-ticks 2) (run:run-until (lambda () (= 6 (run:simulation-tick)))))))
    (is (equal '((0 0) (1 1) (2 2) (3 3) (4 4) (5 5) (6 6))
               (recorded-in `(:run ,run t) '(:each-tick (now (run:simulation-tick))))))))

(test each-tick.records-a-trial-without-ticks
  (is (equal '((0 7)) (recorded-in '(:run t) '(:each-tick (a 7))))))

(test each-tick.records-ticks-that-stand-for-more-time
  (multiple-value-bind (series replay)
      (recorded-in '(:parameters (base:tick-quantum* 4)) '(:run (run:run-ticks 5) t)
                 '(:each-tick (a t)))
    (is (= 5 (getf replay :ticks)))
    (is (equal '(0 1 2 3 4 5) (column-at 0 series)))))

(test each-tick.goes-on-after-run
  (is (equal '(0 1 2 3 4)
             (column-at 0 (recorded-in '(:run (run:run-ticks 2))
                                       '(:until (= 4 (run:simulation-tick)))
                                     '(:each-tick (a t)))))))

(test each-tick.looks-after-plans-and-before-their-caller
  (eval '(rpl:def-interp-proc stepping ()
          (setf *walk-phase* 1) (rpl:wait-time 2) (setf *walk-phase* 2) (rpl:wait-time 1) t))
  (is (equal '((0 1) (1 1) (2 2) (3 2))
             (recorded-in '(:run (let ((*walk-phase* 0))
                                 (prog1 (driver:run-plan 'stepping) (setf *walk-phase* 9))))
                        '(:each-tick (phase *walk-phase*)))))
  (is (equal '((0 :a) (1 :a) (2 :a) (3 :b))
             (loop for (tick phase) in (recorded-in '(:run (let ((*walk-phase* :a))
                                                           (run:run-ticks 2)
                                                           (setf *walk-phase* :b)
                                                           (run:run-ticks 1)))
                                                  '(:each-tick (phase *walk-phase*)))
                   collect (list tick (intern (string-upcase phase) :keyword))))))

(test each-tick.forgets-what-a-trial-is-rewound-over
  (multiple-value-bind (series replay)
      (recorded-in '(:run (run:keep-forks) (run:run-ticks 5) (run:rewind 3) (run:run-ticks 2) t)
                 '(:each-tick (now (run:simulation-tick))))
    (is (= 4 (getf replay :ticks)))
    (is (equal '((0 0) (1 1) (2 2) (3 3) (4 4)) series))))

(test each-tick.keeps-what-was-recorded-of-trials-that-do-not-end
  (is (equal '(0 1 2 3 4)
             (column-at 0 (recorded-in '(:limit 4) '(:run (loop (run:run-ticks 1)))
                                     '(:each-tick (a t))))))
  (is (equal '(0 1 2)
             (column-at 0 (recorded-in '(:run (run:run-ticks 2) (error "loud"))
                                     '(:each-tick (a t))))))
  (is (equal '(0 1 2)
             (column-at 0 (recorded-in '(:run (catch 'out (run:run-ticks 2)
                                              (throw 'out t)))
                                     '(:each-tick (a t)))))))

(test each-tick.says-what-went-wrong-first
  (multiple-value-bind (series replay)
      (recorded-in '(:run (run:run-ticks 3) t)
                 '(:each-tick (a (if (oddp (run:simulation-tick))
                                     (error "no ~D" (run:simulation-tick))
                                     :none))
                   (b (list (run:simulation-tick) #'car)) (c 1)))
    (is (equal '((0 :none :none 1) (1 :none :none 1) (2 :none :none 1) (3 :none :none 1)) series))
    (is (string= "success" (getf replay :outcome)))
    (is-true (search "each-tick b at tick 0" (getf replay :error))))
  (is-true (search "loud" (getf (nth-value 1 (recorded-in '(:run (run:run-ticks 1) (error "loud"))
                                                        '(:each-tick (a (error "quiet")))))
                                :error))))

(test each-tick.lets-no-ticks-pass
  (multiple-value-bind (series replay)
      (recorded-in '(:run (run:run-ticks 2) t) '(:each-tick (a (run:run-ticks 1))))
    (is (= 2 (getf replay :ticks)))
    (is (equal '(0 1 2) (column-at 0 series)))
    (is-true (search "run-ticks" (getf replay :error)))))

;;; Nothing else changes.

(defun row-without-fingerprint (line)
  (let ((texts (experiment::csv-fields line))) (cons (first texts) (cddr texts))))

(test each-tick.changes-no-run
  "Also where dice are rolled and a plan waits in vain."
  (eval '(rpl:def-interp-proc waiting-in-vain (fluent) (rpl:wait-for fluent)))
  (flet ((rows (directory &rest clauses)
           (eval `(experiment:defexperiment walk (:robots ars-worlds:dot) (:limit 30)
                    (:vary (way :dice :vain))
                    (:run (cond ((eq way :dice)
                                 (command:robot-go-forward ars-worlds:dot 3)
                                 (run:run-ticks (+ 3 (random 9)))
                                 (chance-p 1/2))
                                (t (driver:begin-plan 'waiting-in-vain (rpl:create-fluent 'f nil))
                                   (run:run-ticks 3)
                                   t)))
                    (:measure (x (robot:robot-x ars-worlds:dot)) (wet (chance-p 1/2))
                              (rolled (random 1000)))
                    ,@clauses))
           (walk directory)
           (mapcar #'row-without-fingerprint (table-lines directory))))
    (with-directories (plain recorded)
      (let ((rows (rows plain)))
        (is-true (search "deadlock" (table-text plain)))
        (is (equal rows (rows recorded '(:each-tick (a (random 10)) (b (chance-p 1/2))
                                         (c (robot:robot-x ars-worlds:dot))))))
        (is-false (probe-file (series-path plain)))))))

(test each-tick.rolls-other-dice-than-run
  (let ((series (recorded-in '(:run (setf (get '*walk-phase* 'rolled)
                                     (loop repeat 3 collect (random 1000)))
                               (run:run-ticks 2) t)
                             '(:each-tick (r (random 1000)) (s (random 1000)) (u (random 1000))))))
    (is (= 3 (length series)))
    (is (not (member (get '*walk-phase* 'rolled) series :key #'rest :test #'equal)))))

(test each-tick.rolls-otherwise-at-each-tick
  (dolist (form '((random 1000000) (base:roll-between 0 1 (world:world-dice world:*world* :user))))
    (is (= 21 (length (remove-duplicates
                       (column-at 1 (recorded-in '(:run (run:run-ticks 20) t)
                                               `(:each-tick (a ,form))))))))))

(test each-tick.decides-like-a-measure
  (flet ((fingerprint (&rest clauses)
           (eval `(define-for-test (:robots ars-worlds:dot) (:run t) ,@clauses))
           (first (question-fingerprints))))
    (is (string/= (fingerprint) (fingerprint '(:each-tick (a 1)))))
    (is (string/= (fingerprint '(:each-tick (a 1))) (fingerprint '(:each-tick (a 2)))))))

(test each-tick.is-checked
  (rejected-clause x (:robots ars-worlds:dot) (:run t) (:each-tick x))
  (rejected-clause (:each-tick) (:robots ars-worlds:dot) (:run t) (:each-tick))
  (rejected-clause (tick 1) (:robots ars-worlds:dot) (:run t) (:each-tick (tick 1)))
  (rejected-clause (score :mean) (:robots ars-worlds:dot) (:run t) (:measure (score :mean)))
  (rejected-clause (a 2) (:robots ars-worlds:dot) (:run t) (:each-tick (a 1) (a 2)))
  (rejected-clause (size 2) (:robots ars-worlds:dot) (:run size) (:vary (size 1 2))
    (:each-tick (size 2)))
  (is (eq 'question (define-for-test (:robots ars-worlds:dot) (:run t) (:measure (a 1))
                      (:each-tick (a 1))))))
