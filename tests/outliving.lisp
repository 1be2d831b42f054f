;;;; outliving.lisp -- a run continues after errors, aborts, throws and hangs in users' code.

(in-package :ars-magna.tests)

(def-suite* outliving :in ars-magna)

(world:defmap dell (12 12)
  (obj log (6 6) ((:size 1) (:color world:red)))
  (obj stump (3 9) ((:size 1) (:color world:blue))))
(world:defmap copse (12 12)
  (obj twig (6 6) ((:size 1) (:color world:red))))
(robot:defrobot shrew (dell (4 10) 0) :hands (10))
(robot:defrobot vole (copse (4 10) 0))

(defmacro with-shrew ((&rest options) &body body)
  `(run:with-simulation (shrew :clean t ,@options) ,@body))

(defun told-p (text)
  "True if a message of the current queue, which is emptied, has TEXT in it."
  (some (lambda (message) (search text message)) (message-texts)))

(defun turn-and (robot function)
  "Turn ROBOT a little, and then call FUNCTION, in the continuation."
  (command:robot-turn robot .01 (lambda (&rest ignore)
                                  (declare (ignore ignore))
                                  (funcall function))))

(defun run-catching (ticks)
  "Pass TICKS, or fewer after a throw to OUT; return the value thrown, or NIL."
  (catch 'out
    (run:run-ticks ticks)
    nil))

;;; What leaves a tick finds it finished.

(test throw.out-of-continuations-loses-none-of-them
  (with-shrew ()
    (let ((calls '()) (looks 0))
      (run:add-observer (lambda (simulation) (declare (ignore simulation)) (incf looks)))
      (flet ((call-and-leave (number)
               (lambda (&rest ignore)
                 (declare (ignore ignore))
                 (push number calls)
                 (throw 'out number))))
        (command:robot-set-speed shrew 1 (call-and-leave 1))
        (command:robot-set-turn-angle shrew 1 (call-and-leave 2))
        (command:robot-turn shrew 1 (call-and-leave 3)))
      (is-true (run-catching 1))
      (let ((tick (run:simulation-tick)))
        (loop repeat 50 until (= 3 (length calls)) do (run-catching 1))
        (is (= 1 tick))
        (is (equal '(3 2 1) calls) "each once, in order")
        (is (= looks (run:simulation-tick)) "and who looks on has seen each tick")))))

(defun kicked (body)
  "Make BODY, a function of a thing, the kicker of all things in the dell for a tick. Return how far
east they have moved."
  (with-own-definitions
    (world:define-kicker 'shove :prob 1 :test nil :body body)
    (let ((things (list (world:find-thing 'log) (world:find-thing 'stump))))
      (dolist (thing things) (world:set-kicker thing 'shove))
      (run-catching 1)
      (mapcar #'world:thing-x things))))

(test throw.out-of-a-kicker-keeps-no-other-from-running
  (with-shrew ()
    (is (equalp '(7 4) (kicked (lambda (thing)
                                 (world:kick-thing thing 1 0 nil)
                                 (throw 'out t)))))
    (is (= 1 (run:simulation-tick)))
    (is (= 2 (run:run-ticks 1)))))

(test throw.out-of-an-event-lets-the-other-events-of-the-tick-happen
  (with-shrew ()
    (let ((happened '()))
      (dotimes (i 3)
        (let ((i i)) (time:schedule (nil) (push i happened) (throw 'out i))))
      (is-true (run-catching 1))
      (is (equal '(2 1 0) happened)))))

(test throw.out-of-a-manipulation-ends-that
  (with-own-definitions
    (eval '(command:defmanipulation fling (:by hand) () (throw 'out hand)))
    (with-shrew ()
      (let ((answers '()) (hand (robot:robot-hand shrew 0)))
        (command:run-manipulation 'fling hand (lambda (&rest all) (push (first all) answers)))
        (is (eq hand (run-catching 20)))
        (is (equal '(:failed) answers))))))

(test time-limit.reaches-who-has-set-it
  "A limit to the time of a whole run is no error of the kicker that it meets."
  (with-shrew ()
    (is (eq :late (handler-case (kicked (lambda (thing)
                                          (declare (ignore thing))
                                          (error 'sb-ext:timeout)))
                    (sb-ext:timeout () :late))))
    (is (= 1 (run:simulation-tick)))
    (is-false (told-p "Error"))))

(test time-limit.without-a-taker-is-an-error-like-others
  (with-shrew ()
    (turn-and shrew (lambda () (error 'sb-ext:timeout)))
    (run:run-ticks 20)
    (is-true (told-p "Error in the continuation of robot-turn"))))

;;; Aborts and overflows are messages.

(defun deep (n) (1+ (deep (1+ n))))

(defun ring ()
  "Return a circular list."
  (let ((list (list 1 2 3)))
    (setf (cdddr list) list)))

(test abort.in-users-code-ends-that-call-only
  (with-shrew ()
    (turn-and shrew #'abort)
    (is (= 20 (run:run-ticks 20)))
    (is-true (told-p "robot-turn was aborted"))
    (is (equalp '(7 4) (kicked (lambda (thing)
                                 (world:kick-thing thing 1 0 nil)
                                 (abort)))))
    (is-true (told-p "was aborted"))
    (time:schedule (nil) (abort))
    (is (= 22 (run:run-ticks 1)))
    (is-true (told-p "a scheduled event was aborted"))))

(test overflow.of-the-stack-is-survived-again-and-again
  (with-shrew ()
    (loop for tick from 20 by 20
          repeat 3
          do (turn-and shrew (lambda () (deep 0)))
             (is (= tick (run:run-ticks 20)))
             (is-true (told-p "robot-turn: The stack has overflowed")))))

(test error.whose-report-is-endless-is-told
  (with-shrew ()
    (turn-and shrew (lambda () (error "What is ~S?" (ring))))
    (run:run-ticks 20)
    (is-true (told-p "What is"))
    (turn-and shrew (lambda () (error "~A" (make-string 1000000 :initial-element #\x))))
    (run:run-ticks 20)
    (let ((texts (message-texts)))
      (is (some (lambda (text) (search "Error in the continuation of robot-turn" text)) texts))
      (is (every (lambda (text) (< (length text) 5000)) texts)))))

;;; The debugger.

(defun restart-names (condition)
  "Return the names of the restarts for CONDITION, in the order in which a debugger shows them."
  (mapcar #'restart-name (compute-restarts condition)))

(defmacro with-debugger ((condition) decision &body body)
  "Run BODY, in which users' errors enter a debugger whose user does DECISION about CONDITION."
  `(let ((base:*break-on-user-error* t)
         (*debugger-hook* (lambda (,condition hook)
                            (declare (ignore hook) (ignorable ,condition))
                            ,decision)))
     ,@body))

(test debugger.offers-to-go-on-first-and-then-to-retry
  (let ((seen '()))
    (with-shrew ()
      (with-debugger (condition) (progn (setf seen (restart-names condition))
                                        (invoke-restart (first (compute-restarts condition))))
        (turn-and shrew (lambda () (error "bad wiring")))
        (is (= 20 (run:run-ticks 20)))))
    (is (equal '("ABORT" "RETRY") (mapcar #'symbol-name (subseq seen 0 2))))
    (is-false (find "STOP-SIMULATOR" seen :test #'string=) "nothing here runs live")
    (with-shrew ()
      (with-debugger (condition) (abort)
        (turn-and shrew (lambda () (error "bad wiring")))
        (run:run-ticks 20)
        (is-true (told-p "bad wiring") "going on reports it")))))

(test debugger.retry-calls-the-same-again
  (with-shrew ()
    (let ((calls 0))
      (with-debugger (condition)
                     (invoke-restart (find 'definitions::retry (compute-restarts condition)
                                           :key #'restart-name :test #'string=))
        (turn-and shrew (lambda () (when (< (incf calls) 3) (error "not yet"))))
        (run:run-ticks 20)
        (is (= 3 calls))
        (setf calls 0)
        (is (equalp '(9 4) (kicked (lambda (thing)
                                     (world:kick-thing thing 1 0 nil)
                                     (when (< (incf calls) 3) (error "not yet")))))
            "the one that failed, and then the others"))
      (is-false (told-p "not yet")))))

(test debugger.without-anybody-there-is-a-message
  "The tests run without a terminal."
  (with-shrew ()
    (let ((base:*break-on-user-error* t) (*debugger-hook* nil) (passed 0))
      (turn-and shrew (lambda () (error "bad wiring")))
      (run:run-ticks 20)
      (is-true (told-p "bad wiring"))
      (turn-and shrew (lambda () (break "Look at ~A" 'this) (incf passed)))
      (run:run-ticks 20)
      (is-true (told-p "Look at THIS"))
      (is (= 1 passed) "goes on after the break"))))

(test changes.of-what-has-been-destroyed-are-nobodys-business
  "They are made, and are not in the journal, where nothing would be called so."
  (with-shrew (:journal t)
    (let ((thing (world:make-new-thing 'twig '(dell 2 2) '())))
      (world:destroy-thing thing)
      (let ((count (length (run:journal-entries (run:simulation-journal time:*simulation*)))))
        (world:set-attribute thing :size 3)
        (world:change-attribute thing '((:color world:red)))
        (world:put-kicker nag (it thing) (:prob 1) (world:kick-thing it 1 0 nil))
        (world:run-kicker (world:find-attachment thing 'nag))
        (is (= 3 (world:get-attribute thing :size)))
        (is (= count (length (run:journal-entries (run:simulation-journal time:*simulation*)))))
        (run:run-ticks 3)
        (is-true (replays-p time:*simulation*))))))

(test condition.that-is-no-error-is-told-and-ends-the-call-only
  "Also inside code with a restart to continue, as when a file is loaded."
  (with-shrew ()
    (turn-and shrew (lambda () (error (make-condition 'condition))))
    (is (eql 20 (with-simple-restart (continue "Go on elsewhere.") (run:run-ticks 20))))
    (is-true (told-p "Break in the continuation of robot-turn"))))

;;; Definitions that go.

(test threads.begin-for-robots-whose-definitions-are-gone
  "The thread of a live run may begin after its robot has been undefined."
  (with-own-definitions
    (eval '(progn
            (world:defmap short-lived (9 9))
            (robot:defrobot mayfly (short-lived (4 4) 0))
            (run:with-simulation (mayfly)
              (base:undefine 'robot 'mayfly)
              (is (eq (first (run:simulation-robots (time:current-simulation)))
                      (run:call-with-thread-bindings (time:current-simulation)
                                                      (lambda () mayfly)))))))))
