;;;; experiment-replay.lisp -- from a row of an experiment to its run, in Lisp and at the prompt.

(in-package :ars-magna.tests)

(def-suite* experiment-replay :in ars-magna)

;;; An experiment whose trials go wrong in all ways.

(rpl:def-interp-proc ars-user::wander (fail-p)
  "Turn until tick 6, and perhaps fail then."
  (ars-magna.rpl-robot:rpl-robot-turn (random 1.5))
  (rpl:wait-for ars-magna.rpl-robot:robot-stopped*)
  (rpl:wait-time 2)
  (if fail-p (rpl:fail :class :lost) :there))

(defun butler () (first (run:simulation-robots)))

(defun turn-and-err ()
  (command:robot-turn (butler) 1 (lambda (&rest results)
                                   (declare (ignore results))
                                   (error "in passing")))
  (run:run-ticks 12)
  t)

(defun interrupt-oneself ()
  "Do as control C does after 3 ticks, and let 4 more pass."
  (run:run-ticks 3)
  (with-simple-restart (cli::go-on "Go on.") (host:signal-user-interrupt))
  (run:run-ticks 4)
  t)

(defun interrupt-oneself-twice ()
  "Do as control C does twice before a tick passes."
  (run:run-ticks 3)
  (loop repeat 2
        do (with-simple-restart (cli::go-on "Go on.") (host:signal-user-interrupt)))
  t)

(defun try (way)
  "Do what WAY says in the current simulation, in a trial."
  (ecase way
    (well (run:run-ticks 5) (values (< (random 1.0) 2) nil))
    (badly (run:run-ticks 7) (values nil :no-luck))
    (loudly (run:run-ticks 3) (error "This is loud."))
    (slowly (loop (run:run-ticks 1)))
    (in-passing (turn-and-err))
    (breaking (run:run-ticks 2) (break "look here") t)
    (by-plan (ars-magna.rpl-robot:run-plan 'ars-user::wander nil))
    (by-failing-plan (ars-magna.rpl-robot:run-plan 'ars-user::wander t))
    (packaged (values (read-from-string "(1.5 a)") (package-name *package*)))))

(experiment:defexperiment trying
  "What becomes of trials that go wrong? In all ways."
  (:robots ars-user::butler)
  (:vary (way 'well 'badly 'loudly 'slowly 'in-passing 'breaking 'by-plan 'by-failing-plan
              'packaged))
  (:limit 50) (:trials 2)
  (:run (try way))
  (:measure (angle (robot:robot-angle (butler)))
            (text (princ-to-string (read-from-string "(1.5 a)")))))

(experiment:defexperiment interrupting
  (:robots ars-user::butler)
  (:run (interrupt-oneself)))

(experiment:defexperiment interrupting-twice
  (:robots ars-user::butler)
  (:run (interrupt-oneself-twice)))

(defun call-with-trials (function)
  "Call FUNCTION with the results of TRYING and the directory they are in."
  (experiment::call-with-temporary-directory
   (lambda (path)
     (funcall function
              (experiment:run-experiment 'trying :workers 1 :stream nil :directory path)
              (uiop:native-namestring path)))))

;;; In Lisp.

(test replay.is-the-very-run-of-its-row
  (call-with-trials
   (lambda (results path)
     (let ((outcomes '()))
       (dolist (sample (experiment:results-samples results))
         (loop for trial across (experiment:sample-trials sample)
               for outcome across (experiment:sample-outcomes sample)
               for replay = (experiment:replay-trial 'trying (experiment:sample-condition sample)
                                                     trial :directory path)
               do (push outcome outcomes)
                  (is (string= outcome (getf replay :outcome)))
                  (is (null (getf replay :differences)))))
       (dolist (outcome '("success" "failure" "limit" "error"))
         (is (member outcome outcomes :test #'string=)))))))

(test replay.finds-what-a-worker-finds
  (let* ((*package* (find-package :keyword))
         (*read-default-float-format* 'double-float)
         (*readtable* (copy-readtable))
         (seen nil)
         (plain (getf (experiment:replay-trial 'trying "packaged" 1) :measures)))
    (set-macro-character #\( (lambda (stream char) (declare (ignore stream char)) :odd))
    (is (equal plain (getf (experiment:replay-trial 'trying "packaged" 1
                                                    :then (lambda () (setf seen *package*)))
                           :measures)))
    (is (equal "(1.5 A)" (second (assoc 'text plain))))
    (is (eq (find-package :keyword) seen) "who looks has what he had outside")))

(test replay.names-what-differs
  (call-with-trials
   (lambda (results path)
     (declare (ignore results))
     (let* ((file (concatenate 'string path "rows.csv"))
            (text (base:read-file-into-string file))
            (place (search "failure,no-luck,7" text)))
       (with-open-file (out file :direction :output :if-exists :supersede)
         (write-string (replace text "failure,no-luck,8" :start1 place) out))
       (is (equal '("ticks is 7, and 8 in the row")
                  (getf (experiment:replay-trial 'trying "badly" 1 :directory path)
                        :differences)))
       (is (null (getf (experiment:replay-trial 'trying "badly" 2 :directory path)
                       :differences)))
       (signals base:misuse (experiment:replay-trial 'trying "badly" 3 :directory path))))))

(test replay.stops-in-the-middle
  (let* ((seen nil)
         (replay (experiment:replay-trial 'trying "by-plan" 1 :until 3 :trace t
                  :then (lambda ()
                          (setf seen (list (run:simulation-tick)
                                           (length (ars-magna.rpl-robot:plans))
                                           (with-output-to-string (*standard-output*)
                                             (rpl:why 1))))))))
    (is (= 3 (first seen) (getf replay :ticks)))
    (is (= 1 (second seen)))
    (is-true (has-words-p (third seen) "started at tick 0" "rpl-robot-turn"))
    (is (null (getf replay :outcome)))
    (is (null time:*simulation*))))

(test replay.errors-of-who-looks-are-his
  (signals simple-error
    (experiment:replay-trial 'trying "well" 1 :until 3 :then (lambda () (error "mine"))))
  (signals simple-error (experiment:replay-trial 'trying "well" 1 :then (lambda () (error "mine"))))
  (signals base:misuse
    (experiment:replay-trial 'trying "well" 1 :then (lambda () (run:run-ticks 1)))))

(test replay.steps-and-paces-change-nothing
  (flet ((digest (&rest options)
           (getf (apply #'experiment:replay-trial 'trying "by-failing-plan" 2 options) :digest)))
    (let ((ticks '()) (plain (digest)))
      (dolist (other (list (digest :rate :free) (digest :rate 100000) (digest :trace t)
                           (digest :journal t)
                           (digest :step (lambda (simulation)
                                           (push (run:simulation-tick simulation) ticks)))))
        (is (string= plain other)))
      (is (equal '(0 1 2 3) (subseq (reverse ticks) 0 4)))
      (is (= 2 (getf (experiment:replay-trial 'trying "well" 1
                      :step (lambda (simulation)
                              (and (= 2 (run:simulation-tick simulation)) :stop)))
                     :ticks))))))

(test replay.asks-before-each-tick
  (with-input-from-string (in (format nil "y~%y~%n~%"))
    (let* ((out (make-string-output-stream))
           (*query-io* (make-two-way-stream in out)))
      (is (= 2 (getf (experiment:replay-trial 'trying "well" 1 :step t) :ticks)))
      (is-true (search "Tick 2." (get-output-stream-string out))))))

(test replay.has-the-digest-of-the-row
  (call-with-trials
   (lambda (results path)
     (declare (ignore results))
     (let ((digest (getf (experiment:replay-trial 'trying "badly" 1) :digest)))
       (is (= 16 (length digest)))
       (is-true (search digest (base:read-file-into-string
                                (concatenate 'string path "rows.csv"))))))))

(defun digest-of-journal (journal)
  (format nil "~16,'0X" (nth-value 1 (run:replay journal))))

(test replay.keeps-a-journal
  (let ((replay (experiment:replay-trial 'trying "by-plan" 1 :journal t)))
    (is (string= (getf replay :digest) (digest-of-journal (getf replay :journal)))))
  (uiop:with-temporary-file (:pathname path)
    (let ((replay (experiment:replay-trial 'trying "by-plan" 2 :journal path)))
      (is (string= (getf replay :digest) (digest-of-journal path))))))

(test replay.breaks-for-who-wants-that
  (let* ((base:*break-on-user-error* t) (entered '()))
    (base:with-debugger-hook ((lambda (condition hook)
                                (declare (ignore hook))
                                (push (run:simulation-tick) entered)
                                (if (typep condition 'error)
                                    (abort condition)
                                    (continue condition))))
      (is (string= "success" (getf (experiment:replay-trial 'trying "breaking" 1) :outcome)))
      (is (string= "aborted" (getf (experiment:replay-trial 'trying "loudly" 1) :error))))
    (is (equal '(3 2) entered))))

(test replay.rejects-what-makes-no-sense
  (signals base:unknown-name (experiment:replay-trial 'no-such 1 1))
  (signals base:unknown-name (experiment:replay-trial 'trying "no such" 1))
  (signals base:unknown-name (experiment:replay-trial 'trying "by-" 1))
  (dolist (options '((:until -1) (:rate 0) (:step 5) (:journal 5) (:then nil) (:directory 5)))
    (signals base:wrong-argument (apply #'experiment:replay-trial 'trying 1 1 options)))
  (dolist (trial '("one" 0 -1 1.5))
    (signals base:wrong-argument (experiment:replay-trial 'trying 1 trial))))

;;; Failures.

(test failures.are-grouped-with-examples
  (call-with-trials
   (lambda (results path)
     (flet ((ways (results)
              (loop for group in (experiment:trial-failures results)
                    collect (list (getf group :condition) (getf group :outcome)
                                  (getf group :reason) (getf group :error) (getf group :trials)))))
       (is (equal '(("way=badly" "failure" "no-luck" "" (1 2))
                    ("way=loudly" "error" "" "This is loud." (1 2))
                    ("way=slowly" "limit" "" "" (1 2))
                    ("way=in-passing" "error" ""
                     "Error in the continuation of robot-turn: in passing" (1 2))
                    ("way=breaking" "error" "" "look here" (1 2))
                    ("way=by-failing-plan" "failure" "lost" "" (1 2)))
                  (ways results)))
       (is (equal (ways results) (ways path)))
       (is (equal (ways results) (ways 'trying)))
       (is (equal '(1d0) (mapcar (lambda (group) (getf group :share))
                                 (experiment:trial-failures results "loudly"))))
       (is-true (has-words-p (with-output-to-string (out)
                               (experiment:print-failures results nil out))
                             "way=loudly: 2 trials, 2 with something wrong"
                             "2  100.0 %  error; This is loud."
                             "trial trying way=loudly 1"
                             "way=well: 2 trials, nothing wrong"))))))

(test failures.need-results
  (signals base:misuse (experiment:trial-failures 'interrupting))
  (signals base:misuse (experiment:trial-failures "/no/such/directory/"))
  (signals base:wrong-argument (experiment:trial-failures 5)))
