;;;; rap-seeing.lisp -- how RAPs show in the tools that look at plans, and what they say.

(in-package :ars-magna.tests.rap)

(def-suite* ars-magna.tests::rap-seeing :in ars-magna.tests::ars-magna)

(defun has (text where)
  "True if TEXT is in WHERE, where blanks and line ends count as one blank."
  (search text (format nil "~{~A~^ ~}"
                       (remove "" (uiop:split-string where :separator '(#\Space #\Newline))
                               :test #'string=))))

;;; A kitchen.

(define-rap (index (see-bring ?thing ?place))
  (succeed (at ?thing ?place))
  (resources arm)
  (method by-hand
    (context (at ?thing ?where))
    (task-net (sequence (reach (see-go ?where))
                        (grip (see-grip ?thing ?where))
                        (leave (see-leave ?thing ?place)))))
  (method ask (primitive (wait-time 3))))

(define-rap (index (see-go ?place))
  (method walk (primitive (wait-time 5))))

(define-rap (index (see-grip ?thing ?place))
  (attempts 1)
  (method (primitive (wait-time 1)
                     (when (memory-holds-p '(greasy)) (fail :class :slipped))
                     (memory-delete `(at ,thing ,place)))))

(define-rap (index (see-leave ?thing ?place))
  (method (primitive (memory-add `(at ,thing ,place)))))

(defmacro in-kitchen (&body body)
  `(let ((*trace-plans* t))
     (in-rap-run (memory-add '(at cup sink)) ,@body)))

(defmacro printed (form)
  "Return what FORM prints."
  `(with-output-to-string (*standard-output*) ,form))

(defun task-named (text)
  "Return the innermost task whose name begins with TEXT."
  (find-if (lambda (task) (eql 0 (search text (format nil "~(~A~)" (task-name task)))))
           (reverse (tasks-now))))

(defun tasks-now ()
  (labels ((below (task) (cons task (mapcan #'below (task-children task)))))
    (mapcan #'below (list (find-task '(see-bring) (rpl-runner))))))

(test rap-seeing.a-try-shows-its-rap-method-values-and-steps
  (in-kitchen
    (begin-plan 'see-bring 'cup 'table)
    (run-ticks 3)
    (let ((tree (printed (print-plans))))
      (is (has "see-bring (see-bring cup table)" tree) "~A" tree)
      (is (has "see-bring cup table, try 1: by-hand (where sink) (task-net" tree))
      (is (has "reach (see-go sink)" tree))
      (is (has "see-go sink, try 1: walk (wait-time 5) waits for tick 6" tree))
      (is (has "grip (see-grip ?thing ?where) waits for the end of reach" tree)))))

(test rap-seeing.no-internal-forms-show
  (in-kitchen
    (begin-plan 'see-bring 'cup 'table)
    (run-ticks 3)
    (let ((tree (printed (print-plans *standard-output* t))))
      (is (has "where = sink" tree))
      (is (has "in (resources arm)" tree))
      (loop for word in '("prog" "push" "handle-failure" "partial-order" "with-valves" "case"
                          "choice" "shown-as" "#:" "rap-tries")
            do (is (not (search word tree)) "~A: ~A" word tree)))))

(test rap-seeing.why-names-the-try-that-a-step-is-part-of
  (in-kitchen
    (memory-add '(greasy))
    (begin-plan 'see-bring 'cup 'table)
    (run-ticks 8)
    (let ((why (printed (why (task-named "see-bring cup")))))
      (is (has "see-bring cup table, try 2: ask, was started at tick 7 as a part of task 1" why)
          "~A" why))
    (let ((why (printed (why (find-task '(see-bring) (rpl-runner))))))
      (is (has "because its part 2, see-bring cup table, try 1: by-hand (where sink), failed" why)
          "~A" why))))

(test rap-seeing.tries-are-in-timelines
  (in-kitchen
    (memory-add '(greasy))
    (begin-plan 'see-bring 'cup 'table)
    (run-ticks 8)
    (uiop:with-temporary-file (:pathname path :type "svg")
      (save-plan-timeline path)
      (let ((picture (uiop:read-file-string path)))
        (is (has "see-bring cup table, try 1: by-hand (where sink), ticks 1 to 7, failed" picture))
        (is (has "see-bring cup table, try 2: ask" picture))))))

(test rap-seeing.places-of-tries-can-be-read-and-found
  (in-kitchen
    (begin-plan 'see-bring 'cup 'table)
    (run-ticks 3)
    (let* ((task (task-named "see-go sink")) (place (task-place task)))
      (is (equal place (read-from-string (prin1-to-string place))))
      (is (eq task (find-task place (rpl-runner)))))))

;;; Calls without end.

(define-rap (index (see-self ?x)) (method (task-net (again (see-self ?x)))))
(define-rap (index (see-first ?x)) (method (primitive (see-second x))) (method (primitive 1)))
(define-rap (index (see-second ?x)) (attempts 9) (method (task-net (back (see-first ?x)))))
(define-rap (index (see-down ?n))
  (method bottom (context (= ?n 0)) (primitive (note-rap :bottom)))
  (method deeper (context (test (plusp ?n))) (primitive (see-down (1- n)))))
(define-rap (index (see-unload ?x))
  (succeed (not (in ? ?x)))
  (attempts 1)
  (method (context (in ?thing ?x)) (primitive (memory-delete `(in ,thing ,x)) (see-unload x))))

(test rap-seeing.a-rap-that-calls-itself-without-end-fails
  (in-rap-run
    (loop for (name told) in '((see-self "The RAP (see-self 1) calls itself")
                               (see-first "1) calls itself with the same arguments"))
          do (let ((failure (failure-of-run name 1)))
               (is (eq :too-deep (failure-class failure)))
               (is (search told (princ-to-string failure)) "~A" failure)))))

(test rap-seeing.deep-recursion-works
  "Up to the limit of plans, and with the same arguments if the memory changes."
  (is (equal '((0 :bottom)) (rap-notes (is (eq t (run-plan 'see-down 900))))))
  (in-rap-run
    (let ((failure (failure-of-run 'see-down 2100)))
      (is (eq :too-deep (failure-class failure)))
      (is (not (search "itself" (princ-to-string failure)))))
    (dotimes (i 20) (memory-add (list 'in i 'box)))
    (is (eq t (run-plan 'see-unload 'box)))
    (is (null main-memory*))))

(define-rap (index (see-enter ?room))
  (succeed (in ?room))
  (method (task-net (sequence (a (see-unlock ?room)) (b (rap-work ?room 1))))))
(define-rap (index (see-unlock ?room)) (method (task-net (sequence (a (see-enter ?room))))))
(define-rap (index (see-enter-slowly ?room))
  (method (task-net (sequence (a (rap-work ?room 1)) (b (see-leave-slowly ?room))))))
(define-rap (index (see-leave-slowly ?room))
  (method (task-net (a (see-enter-slowly ?room)))))

(test rap-seeing.raps-that-call-each-other-without-end-fail
  "Once: what is too deep is not tried again at each level."
  (in-rap-run
    (dolist (name '(see-enter see-enter-slowly))
      (let ((failure (failure-of-run name 'hall)))
        (is (eq :too-deep (failure-class failure)))
        (is (has (format nil "The RAP (~(~A~) hall) calls itself" name) (princ-to-string failure))
            "~A" failure)))))

(define-rap (index (see-spin)) (succeed (never)) (attempts 1000000000) (method (primitive (fail))))

(test rap-seeing.a-rap-that-tries-on-without-waiting-is-told
  (let ((told (with-output-to-string (*error-output*)
                (handler-bind ((warning (lambda (warning)
                                          (format *error-output* "~A" warning)
                                          (muffle-warning warning))))
                  (in-rap-run (begin-plan 'see-spin) (run-ticks 1))))))
    (is (has "1000000 steps without waiting, at (see-spin)" told) "~A" told)))

;;; What failures say.

(define-rap (index (see-slip ?x)) (attempts 3) (method try-it (primitive (fail :class :slipped))))
(define-rap (index (see-fall ?x))
  (method a (context (near ?y)) (task-net (slip (see-slip ?y))))
  (method b (task-net (slip (see-slip ?x)))))
(define-rap (index (see-crash ?x))
  (method a (context (near ?y)) (task-net (fall (see-fall ?y))))
  (method b (task-net (fall (see-fall ?x)))))

(test rap-seeing.failures-count-equal-tries
  (in-rap-run
    (let ((failure (failure-of-run 'see-fall 'cup)))
      (is (equal (format nil "(see-fall cup): (b), 2 times: (see-slip cup): (try-it), 3 times: ~
                              Plan failure :SLIPPED")
                 (princ-to-string failure)) "~A" failure)
      (is (= 2 (length (rap-failed-tries failure)))))))

(test rap-seeing.long-failures-keep-their-beginning-and-the-innermost-cause
  (in-rap-run
    (mapc #'memory-add '((near wall) (near edge) (near stairs)))
    (let ((text (princ-to-string (failure-of-run 'see-crash 'cup))))
      (is (<= (length text) 300))
      (is (eql 0 (search "(see-crash cup): (a stairs), 2 times: (see-fall stairs)" text)) "~A" text)
      (is (eql (- (length text) 21) (search "Plan failure :SLIPPED" text :from-end t)) "~A" text))
    (install-goal '(see-crash cup))
    (process-goal-agenda)
    (is (> 400 (length (printed (dump-agenda)))))))

;;; Waiting for the memory.

(define-rap (index (see-stew ?what))
  (attempts 1)
  (method slowly
    (task-net (heat (rap-hum ?what) (wait-for (hot ?what) taste))
              (taste (rap-work taste 1))
              (stir (rap-hum ?what) (wait-for (burnt ?what) :fail)))))

(test rap-seeing.waits-for-the-memory-name-step-query-and-rap
  (in-kitchen
    (begin-plan 'see-stew 'soup)
    (run-ticks 9)
    (let ((tree (printed (print-plans))))
      (is (has "taste (wait-for (hot ?what) taste) waits for (hot soup) since tick 1" tree)
          "~A" tree)
      (is (has "(wait-for (burnt ?what) :fail) waits for (burnt soup) since tick 1" tree)
          "~A" tree))
    (memory-add '(hot soup))
    (run-ticks 1)
    (let ((why (printed (why 4))))
      (is (has "Task 4, taste, was started at tick 1 as a part of task 2, see-stew soup, try 1"
               why) "~A" why)
      (is (has "it went on at (wait-for (hot ?what) taste), because (hot soup) came true" why)
          "~A" why))
    (memory-add '(burnt soup))
    (let ((told (printed (progn (install-goal '(see-stew soup)) (process-goal-agenda)
                                (dump-agenda)))))
      (is (has "(see-stew soup): (slowly): (burnt soup) has ended the step stir" told) "~A" told))))

;;; Goals.

(def-interp-proc see-drive (metres)
  (rpl-robot-go-distance metres)
  (wait-for robot-stopped*))

(test rap-seeing.goals-that-take-the-robot-from-each-other-are-named
  (dolist (deadline '(nil 50))
    (in-rap-run
      (install-goal '(see-drive 3) 0 deadline)
      (install-goal '(see-drive 2) 0 deadline)
      (process-goal-agenda)
      (let ((told (find "was interrupted by" (ars-magna.tests::texts-of-warnings) :test #'search)))
        (is (and told (has "goal 1 (see-drive 3) in the plan work-on-agenda" told)
                 (has "goal 2 (see-drive 2) in the plan work-on-agenda" told))
            "~A" told)))))

;;; The debugger.

(define-rap (index (see-doubt ?x))
  (method (context (and (size ?x ?n) (test (< ?n 5)))) (primitive (note-rap :small))))

(test rap-seeing.restarts-name-the-test-with-the-error
  (let* ((restarts '())
         (*break-on-user-error* t)
         (notes (with-debugger-hook ((lambda (condition hook)
                                       (declare (ignore hook))
                                       (setf restarts (mapcar #'princ-to-string
                                                              (compute-restarts condition)))
                                       (use-value t condition)))
                  (rap-notes (memory-add '(size cup big)) (run-plan 'see-doubt 'cup)))))
    (is (equal '((0 :small)) notes))
    (is (equal '("Do (test (< ?n 5)) again." "Let (test (< ?n 5)) return a value.")
               (subseq restarts 0 2)))))
