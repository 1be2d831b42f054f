;;;; run-variables.lisp -- run variables: values, forks, files, replays, plans, live runs, status.

(in-package :ars-magna.tests)

(def-suite* run-variables :in ars-magna)

(run:define-run-variable *catch* 0 "How much was counted.")
(run:define-run-variable *haul* '())
(run:define-run-variable *draw-of-run* (random 1000000))
(run:define-run-variable *lucky-thing* (world:find-thing 'buoy))
(run:define-run-variable *never-used* 5)

(defvar *tallies* 0 "A variable that all runs share.")
(defvar *tallies-of-all* '() "A variable that all runs share.")

(world:defmap lagoon (40 20)
  (rect (0 0) (39 19) bricks 10)
  (obj buoy (20 10) ((:size 1) (:color red)))
  (obj cork (30.5 4.5) ((:size 1) (:color red))))

(robot:defrobot otter (lagoon (5 5) 0))
(robot:defrobot teal (lagoon (8 9) 0))

(defmacro in-lagoon ((&rest options) &body body)
  `(run:with-simulation ((otter teal) :clean t ,@options) ,@body))

(defun journalled ()
  (run:journal-entries (run:simulation-journal time:*simulation*)))

;;; Values.

(test run-variable.has-a-value-in-each-run
  (in-lagoon ()
    (setf *catch* 7)
    (is (= 8 (incf *catch*)))
    (push 'a *haul*)
    (push 'b *haul*)
    (is (equal '(8 (b a)) (list *catch* *haul*)))
    (in-lagoon () (is (equal '(0 ()) (list *catch* *haul*))))
    (is (eq 'b (pop *haul*)))
    (is (equal '(8 (a)) (list *catch* *haul*))))
  (in-lagoon () (is (equal '(0 ()) (list *catch* *haul*)))))

(test run-variable.has-no-value-without-a-run
  (dolist (function (list (lambda () *catch*) (lambda () (setf *catch* 1))))
    (is (search "The run variable *catch* has a value only in a run" (text-of-error function)))))

(test init-form.rolls-the-dice-of-the-run
  (flet ((lot (seed) (in-lagoon (:seed seed) *draw-of-run*)))
    (is (= (lot 1) (lot 1)))
    (is (/= (lot 1) (lot 2)))
    (in-lagoon (:seed 1)
      (let ((next (random 1000000)))
        (is (/= next *draw-of-run*))
        (in-lagoon (:seed 1)
          (is (numberp *draw-of-run*))
          (is (= next (random 1000000)) "the init form has rolled the dice of programs"))))))

(test init-form.finds-things-of-the-run
  (in-lagoon ()
    (is (eq (world:find-thing 'buoy) *lucky-thing*))
    (let ((outer *lucky-thing*))
      (in-lagoon ()
        (is (eq (world:find-thing 'buoy) *lucky-thing*))
        (is (not (eq outer *lucky-thing*)))))))

(test value.is-checked-when-it-is-set
  (in-lagoon ()
    (dolist (value (list 1/3 2.5d0 :key 'symbol #\a "text" '(1 (2 "b")) #(1 #(2)) nil otter
                         (list otter (world:find-thing 'cork) #(1))))
      (is (equalp value (setf *catch* value)))
      (is (equalp value *catch*)))
    (loop with other = (robot:find-robot 'otter)
          for (value text) in `((,(make-hash-table) "a list of lists (key value)")
                                (,#'car "a symbol can name a function")
                                ((1 . 2) "lists without a dotted tail")
                                (,(make-symbol "A") "symbols with a package")
                                (,(make-list 10001) "at most 10000 elements")
                                (,time:*simulation* "things and robots of the current run"))
          do (is (search text (text-of-error (lambda () (setf *catch* value))))))
    (let ((outer otter))
      (in-lagoon ()
        (is (search "(counterpart OBJECT) returns the object of the current run"
                    (text-of-error (lambda () (setf *catch* outer)))))))))

(test value.is-a-copy
  (in-lagoon (:journal t)
    (let ((list (list 1 (list 2) (vector 3) (copy-seq "four"))))
      (setf *haul* list)
      (setf (first (second list)) 0)
      (setf (aref (third *haul*) 0) 0)
      (setf (char (fourth *haul*) 0) #\x)
      (is (equalp '(1 (2) #(3) "four") *haul*))
      (is (= (run:state-digest) (replayed-digest))))))

;;; Definitions.

(test run-variables.of-one-name-in-two-packages-are-two
  (let* ((packages (list (make-package "TALLY-A" :use '()) (make-package "TALLY-B" :use '())))
         (a (intern "TALLY" (first packages))) (b (intern "TALLY" (second packages))))
    (unwind-protect
         (base:with-own-definitions ()
           (eval `(run:define-run-variable ,a 1))
           (eval `(run:define-run-variable ,b 2))
           (in-lagoon ()
             (is (equal '(1 2) (list (eval a) (eval b))))
             (eval `(setf ,a 5))
             (is (equal '(5 2) (list (eval a) (eval b))))
             (is (equal '("tally-a::tally" "tally-b::tally")
                        (mapcar #'second (getf (run:status otter) :variables))))))
      (mapc #'delete-package packages))))

(test run-variable.keeps-its-value-when-it-is-defined-anew-and-can-be-undefined
  (base:with-own-definitions ()
    (let ((use (in-lagoon ()
                 (eval '(run:define-run-variable *brief* 1))
                 (let ((use (compile nil '(lambda () *brief*))))
                   (is (= 1 (funcall use)))
                   (eval '(run:define-run-variable *brief* 2))
                   (is (= 1 (funcall use)))
                   (in-lagoon () (is (= 2 (funcall use))))
                   use))))
      (ars:undefine 'run-variable '*brief*)
      (is (search "run variable called *brief*"
                  (text-of-error (lambda () (in-lagoon () (funcall use))))))
      (is (null (host:variable-kind '*brief*))))))

;;; State of the run.

(test digest.has-run-variables-that-were-set
  (in-lagoon ()
    (let ((digest (run:state-digest)))
      (is (equal '(0 ()) (list *catch* *haul*)))
      (is (= digest (run:state-digest)))
      (setf *catch* 0)
      (is (/= digest (run:state-digest)))
      (let ((set (run:state-digest)))
        (setf *catch* 1)
        (is (/= set (run:state-digest)))
        (setf *catch* 0)
        (is (= set (run:state-digest)))))))

(test fork.has-its-own-values
  (in-lagoon ()
    (setf *catch* 1
          *haul* (list otter (world:find-thing 'cork)))
    (let ((digest (run:state-digest)) (original otter))
      (run:with-fork ()
        (is (= digest (run:state-digest)))
        (is (equal (list otter (world:find-thing 'cork)) *haul*))
        (is (not (eq original (first *haul*))))
        (is (= 2 (incf *catch*)))
        (run:with-fork () (is (= 3 (incf *catch*))))
        (is (= 2 *catch*)))
      (is (= 1 *catch*))
      (is (= digest (run:state-digest))))))

(test rewind.restores-values
  (in-lagoon (:keep t :journal t)
    (setf *catch* 1)
    (run:run-ticks 5)
    (incf *catch*)
    (run:run-ticks 5)
    (incf *catch*)
    (run:rewind 0)
    (is (= 2 *catch*))
    (run:rewind 5)
    (is (= 1 *catch*))
    (run:rewind 5)
    (is (= 0 *catch*))
    (is (= (run:state-digest) (replayed-digest)))))

(test saved-run.has-run-variables
  (in-lagoon (:journal t :seed 8)
    (setf *catch* (list 1 "two" #\3 teal (world:find-thing 'buoy) #(4)))
    (world:destroy-thing (world:find-thing 'buoy))
    (let ((lot *draw-of-run*))
      (with-temporary-file (file)
        (run:save-simulation file)
        (let ((digest (run:state-digest)))
          (run:with-loaded-simulation (file)
            (is (= digest (run:state-digest)))
            (is (= lot *draw-of-run*))
            (is (equalp '(1 "two" #\3) (subseq *catch* 0 3)))
            (is (eq teal (fourth *catch*)))
            (is (equalp #(4) (sixth *catch*)))
            (incf *draw-of-run*)
            (is (/= digest (run:state-digest)))))))))

(test saved-run.needs-the-definitions-of-the-variables-that-it-has-used
  (base:with-own-definitions ()
    (with-temporary-file (file)
      (in-lagoon ()
        (eval '(run:define-run-variable *brief* 1))
        (eval '(incf *brief*))
        (run:save-simulation file))
      (ars:undefine 'run-variable '*brief*)
      (is (search "variable called *brief*"
                  (text-of-error (lambda () (run:load-simulation file :anyway t))))))))

;;; Who sets them.

(world:defkicker counting (thing) (:prob 1)
  (incf *catch* (world:thing-serial thing)))

(rpl:def-interp-proc tally-up-to (count)
  (loop
    (rpl:wait-time 1)
    (incf *catch*)
    (push (list *catch* (rpl:plan-time)) *haul*)
    (when (<= count *catch*) (return *catch*))))

(rpl:def-interp-proc await-tally (count)
  (rpl:wait-until (<= count *catch*))
  (setf *haul* (list 'reached (decf *catch* 2)))
  (rpl:par (rpl:seq (rpl:wait-time 1) (incf *catch* 100))
           (driver:on-robot ('teal) (incf *catch* 1000)))
  *catch*)

(test kicker.sets-run-variables-without-the-journal
  (in-lagoon (:journal t)
    (world:set-kicker (world:find-thing 'cork) 'counting)
    (run:run-ticks 5)
    (is (= (* 5 (world:thing-serial (world:find-thing 'cork))) *catch*))
    (is (null (find 'run::set-run-variable (journalled) :key #'second)))
    (is (= (run:state-digest) (replayed-digest)))))

(test event.sets-run-variables-without-the-journal
  (in-lagoon (:journal t)
    (time:schedule (nil :timer 3) (push :event *haul*))
    (run:run-ticks 5)
    (is (equal '(:event) *haul*))
    (is (null (find 'run::set-run-variable (journalled) :key #'second)))
    (is (= (run:state-digest)
           (nth-value 1 (run:replay (run:simulation-journal time:*simulation*)))))))

(test continuation-and-program.set-run-variables-with-the-journal
  (in-lagoon (:journal t)
    (setf *catch* otter)
    (command:robot-turn otter 1 (lambda (&rest results)
                                  (declare (ignore results))
                                  (setf *haul* #(1 #\a))))
    (run:run-ticks 20)
    (is (equalp '((0 run::set-run-variable *catch* (:the :robot "OTTER"))
                  (run::set-run-variable *haul* (:the :vector 1 (:the :character 97))))
                (list (first (journalled)) (rest (first (last (journalled)))))))
    (is (= (run:state-digest) (replayed-digest)))))

(test plans.set-run-variables
  (in-lagoon (:journal t :keep t)
    (driver:rpl-init-robot teal)
    (driver:rpl-init-robot otter)
    (let ((counting (driver:begin-plan 'tally-up-to 6))
          (waiting (driver:begin-plan 'await-tally 4)))
      (run:run-ticks 2)
      (let ((fork (run:fork-simulation)))
        (run:run-ticks 20)
        (run:run-ticks 20 fork)
        (is (= (run:state-digest) (run:state-digest fork)))
        (is (= 1104 (rpl:task-result waiting)))
        (is (= 1104 (rpl:task-result counting)))
        (run:rewind 19)
        (run:run-ticks 19)
        (is (= (run:state-digest) (run:state-digest fork)))
        (is (= (run:state-digest) (replayed-digest)))))))

(test plans.of-a-live-run-set-run-variables
  (with-stopped-run (otter)
    (run:simulator 'otter :rate :free :display nil)
    (driver:rpl-init-robot (robot:find-robot 'otter))
    (let ((task (driver:begin-plan 'tally-up-to 20)))
      (run:await-idle)
      (run:stop-simulator)
      (is (eql 20 (rpl:task-result task)))
      (is (= 20 *catch*))
      (is (= (run:state-digest) (replayed-digest)))
      (in-lagoon () (is (= 0 *catch*)) (incf *catch*))
      (is (= 20 *catch*)))
    (run:simulator 'otter :rate :free :display nil)
    (run:stop-simulator)
    (is (= 0 *catch*))))

(test threads.read-the-values-of-their-own-run
  (let ((counts (make-array 4)))
    (flet ((counter (index)
             (lambda ()
               (run:with-simulation (otter)
                 (dotimes (n (1+ index)) (incf *catch*) (run:run-ticks 1))
                 (setf (aref counts index) *catch*)))))
      (mapc #'host:join-thread
            (loop for index below 4 collect (host:start-thread (counter index) "counting"))))
    (is (equalp #(1 2 3 4) counts))))

(test trials.have-their-own-values
  (with-own-definitions
    (eval '(experiment:defexperiment catches
            (:robots otter)
            (:run (dotimes (n 3 t) (incf *catch*) (run:run-ticks 1)))
            (:measure (tally *catch*))))
    (is (equal '(3 3 3 3)
               (measured (experiment:run-experiment 'catches :trials 4 :workers 2 :stream nil)
                         'tally)))))

;;; Global variables in forks.

(rpl:def-interp-proc tally-for-all ()
  (rpl:wait-time 1)
  (let ((*print-base* 8)) (setf *print-base* 9))
  (incf *tallies*)
  (push 1 *tallies-of-all*))

(defun warnings-of-shared-variables (function)
  "Return the variables that warnings name because FUNCTION, called in a run, sets them in forks."
  (let ((*tallies-of-all* '()))
    (in-lagoon ()
      (driver:rpl-init-robot otter)
      (funcall function)
      (loop for text in (warnings-so-far)
            when (search "a variable that all runs share" text)
              collect (subseq text (search "*" text) (search ", a var" text))))))

(test fork.warns-once-of-global-variables-that-plans-set
  (flet ((warned (function) (warnings-of-shared-variables function)))
    (is (null (warned (lambda () (driver:run-plan 'tally-for-all)))))
    ;; *TALLIES-OF-ALL* is bound here, so that the plan sets the binding.
    (is (equal '("*tallies*")
               (warned (lambda ()
                         (driver:begin-plan 'tally-for-all)
                         (dotimes (n 2) (run:with-fork () (run:run-ticks 3)))))))
    (is (equal '("*tallies*")
               (warned (lambda ()
                         (ars-magna.rpl-projecting:project '(tally-for-all)
                                                           :trials 3 :horizon 5)))))))

(test fork.warns-of-global-variables-that-continuations-set
  (flet ((warned (continuation)
           (warnings-of-shared-variables
            (lambda ()
              (command:robot-turn otter 1 continuation)
              (run:with-fork (:continuations t) (run:run-ticks 20))))))
    (is (equal '("*tallies*")
               (warned (nisp:continuation (&rest results) (when results (incf *tallies*))))))
    (is (null (warned (nisp:continuation (&rest results) (unless results (incf *tallies*))))))
    (is (null (warned (nisp:continuation (&rest results)
                        (let ((*tallies* 1)) (when results (incf *tallies*)))))))))

;;; Status.

(test status.shows-run-variables-that-were-used
  (in-lagoon ()
    (is (null (getf (run:status otter) :variables)))
    (is (equal '(0 ()) (list *catch* *haul*)))
    (push otter *haul*)
    (let ((shown '((:name "*catch*" :value 0) (:name "*haul*" :value ("OTTER")))))
      (is (equal shown (getf (run:status otter) :variables)))
      (is (equal (list (list '*catch* 0) (list '*haul* (list otter))) (run:run-variables)))
      (is (search "Run variables: *catch* 0; *haul* (\"OTTER\")"
                  (with-output-to-string (out) (describe time:*simulation* out))))))
  (is (find "*catch*:           5"
            (type-to 'otter "(setf ars-magna.tests::*catch* 5)" "status") :test #'string=)))

(test prompt.finds-run-variables-and-measures
  (let ((text (joined (type-batch "apropos haul" "help *catch*" "help weight-of-catch"))))
    (is-true (has-words-p text "*HAUL*" "run variable" "How much was"
                          "MEASURE weight-of-catch shows its value." "What the catch weighs.")
             "~A" text)))

(run:defmeasure weight-of-catch "What the catch weighs." *catch*)
