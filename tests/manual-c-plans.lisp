;;;; manual-c-plans.lisp -- Plans in RPL, by themselves and on a robot (manual appendices C, D).

(in-package :ars-test-manual-5)
(in-readtable :nisp)

(def-suite* manual-c-plans :in ars-magna)

;;; Plans drive COOK of manual-c.lisp. "Our RPL" marks features of the language that the manual
;;; assumes and we chose.

(defmacro alone (&body body)
  "Run BODY as a plan without a robot; return its value, or failure, and how it ended."
  `(run-plan-alone (interp-lambda () ,@body)))

(defmacro log-of (&body body)
  "Run BODY as a plan alone. Return what it noted, a list of (what tick), by (note what)."
  `(let ((notes '()))
     (flet ((note (what) (push (list what (plan-time)) notes)))
       (declare (ignorable #'note))
       (alone ,@body))
     (reverse notes)))

;;; Fluents.

(test manual-c-plans.wait-for-waits-until-the-fluent-is-true
  "C: (wait-for f) waits until the fluent f becomes true; if it is, it does not wait."
  (let ((f (create-fluent 'f nil)) (g (create-fluent 'g :already)))
    (is (equal '((:already 0) (:now 3))
               (log-of (par (note (wait-for g))
                            (note (wait-for f))
                            (seq (wait-time 3) (set-value f :now))))))))

(test manual-c-plans.pulses-are-for-an-instant
  "C, reading 177: a pulse sets a fluent to true for an instant: all waiting tasks wake, once; then
the fluent is false."
  (let ((f (create-fluent 'f nil)))
    (is (equal '((:a 2) (:b 2) (nil 7))
               (log-of (par (seq (wait-for f) (note :a) (note (wait-for f :timeout 5)))
                            (seq (wait-for f) (note :b))
                            (seq (wait-time 2) (pulse f))))))
    (is (null (fluent-value f)))))

(test manual-c-plans.fluents-keep-their-values
  "D: fluents such as error codes stay as they were set, so plans must reset them to known states
before relying on them."
  (let ((trouble (create-fluent 'trouble :old)))
    (is (equal '((:old 0) (nil 0))
               (log-of (note (wait-for trouble))
                       (set-value trouble nil)
                       (note (wait-for trouble :timeout 0)))))))

(test manual-c-plans.states-are-fluents-that-are-false-at-first
  "D.2: (state 'name) is a new fluent, false until it is set; (create-fluent 'name value) has a
value."
  (is (equal '(nil t 5) (alone (let ((s (state 's)) (f (create-fluent 'f 5)))
                                 (let ((before (fluent-value s)))
                                   (set-value s t)
                                   (list before (fluent-value s) (fluent-value f)))))))
  (is (= 3 (fluent-value 3)) "our RPL: of what is no fluent the value is itself"))

(test manual-c-plans.conditions-read-fluents
  "D.2, D.4, reading 184: IF, COND, LOOP UNTIL, WAIT-FOR and WHENEVER look at a fluent's value;
NOT, AND, = and such of fluents do, too."
  (let ((no (create-fluent 'no nil)) (yes (create-fluent 'yes 4)))
    (is (equal '(:no :yes :yes :four nil)
               (alone (list (if no :yes :no)
                            (if yes :yes :no)
                            (if (not no) :yes :no)
                            (cond (no :none) ((= yes 4) :four))
                            (if (and yes no) t nil)))))
    (is (equal '((:done 0)) (log-of (loop UNTIL yes (note :turn)) (note :done))))))

(test manual-c-plans.networks-follow-their-fluents
  "D.4, reading 184: a task can wait for a condition of several fluents; it wakes when that becomes
true."
  (let ((a (create-fluent 'a nil)) (b (create-fluent 'b 1)))
    (is (equal '((:there 5))
               (log-of (par (seq (wait-for (and a (> b 2))) (note :there))
                            (seq (wait-time 1) (set-value b 3)
                                 (wait-time 1) (set-value b 0) (set-value a t)
                                 (wait-time 3) (set-value b 7))))))))

(test manual-c-plans.ordinary-functions-get-the-fluent
  "D.2: Lisp's own functions do not look into fluents: hence (car (fluent-value f))."
  (let ((f (create-fluent 'f '(1 2))))
    (is (equal (list f 1) (alone (list (identity f) (car (fluent-value f))))))
    (is-true (has-words-p (princ-to-string f) "f" "(1 2)") "but print shows name and value")))

;;; Order.

(test manual-c-plans.seq-and-loops
  "D: steps follow each other; LOOP UNTIL tests before each turn, N-TIMES turns at most so often."
  (is (equal '((1 0) (2 3)) (log-of (seq (note 1) (wait-time 3) (note 2)))))
  (is (equal '((0 0) (1 1) (2 2)) (log-of (let ((n 0))
                                            (loop UNTIL (= n 3)
                                              (note n) (incf n) (wait-time 1))))))
  (is (equal '((:turn 0) (:turn 1)) (log-of (n-times 2 (note :turn) (wait-time 1))))))

(test manual-c-plans.wait-time-counts-ticks
  "Reading 90: (wait-time 1) is one tick."
  (in-pantry ()
    (is (= 7 (let ((start (simulation-tick)))
               (planned (wait-time 7) (- (simulation-tick) start)))))))

(test manual-c-plans.par-waits-for-all-and-fails-with-one
  "D.7, our RPL: PAR does its branches at once, ends with the last, fails as soon as one fails."
  (is (equal '((:b 1) (:a 4) (:after 4))
             (log-of (par (seq (wait-time 4) (note :a)) (seq (wait-time 1) (note :b)))
                     (note :after))))
  (is (null (log-of (par (seq (wait-time 4) (note :a)) (seq (wait-time 1) (fail)))))))

(test manual-c-plans.pursue-ends-with-the-first
  "D.4, reading 185: PURSUE ends when one branch ends; the others are dropped."
  (is (equal '((:fast 2) (:after 2))
             (log-of (pursue (seq (wait-time 9) (note :slow)) (seq (wait-time 2) (note :fast)))
                     (note :after))))
  (is (null (log-of (pursue (seq (wait-time 9) (note :slow)) (seq (wait-time 2) (fail)))
                    (note :after)))))

(test manual-c-plans.policies-hold-while-the-body-runs
  "D.4, reading 186: WITH-POLICY runs its policy with the body and before it; a failure of the
policy fails the whole; when the body ends the policy ends."
  (let ((trouble (create-fluent 'trouble :left-over)))
    (flet ((run (when)
             (log-of (with-policy (seq (set-value trouble nil)
                                       (whenever trouble (fail)))
                       (note :start)
                       (wait-time 2)
                       (if when (set-value trouble t))
                       (note :more))
                     (note :after))))
      (is (equal '((:start 0) (:more 2) (:after 2)) (run nil)))
      (is (equal '((:start 0)) (run t)) "not even the next form is begun"))))

(test manual-c-plans.whenever-reacts-each-time
  "C, our RPL: WHENEVER runs its body each time that the fluent becomes true, and never ends."
  (let ((bell (create-fluent 'bell nil)))
    (is (equal '((:ring 1) (:ring 4))
               (log-of (pursue (whenever bell (note :ring))
                               (seq (wait-time 1) (pulse bell) (wait-time 3) (pulse bell)
                                    (wait-time 3))))))))

(test manual-c-plans.tries
  "Our RPL: TRY-IN-ORDER does one after the other until one succeeds, TRY-ALL all at once; they fail
if all do."
  (is (equal '((:a 0) (:b 1)) (log-of (try-in-order (seq (note :a) (wait-time 1) (fail)) (note :b)
                                                    (note :c)))))
  (is (equal '((:second 2)) (log-of (try-all (seq (wait-time 1) (fail))
                                             (seq (wait-time 2) (note :second))
                                             (seq (wait-time 3) (note :third))))))
  (is (eq :failed (nth-value 1 (alone (try-all (fail) (fail)))))))

;;; Failure.

(test manual-c-plans.failures-end-the-plan
  "D: (fail) ends what it is in, up to a construct that can do without; the plan's value is then the
failure, with its class."
  (multiple-value-bind (failure state) (alone (wait-time 1) (fail :class :lost) (wait-time 1))
    (is (equal '(:failed :lost 1) (list state (failure-class failure) (failure-tick failure)))))
  (multiple-value-bind (failure state) (alone (wait-time 1) (parse-integer "moon"))
    (is (eq :failed state) "a Lisp error is a failure")
    (is-true (typep (lisp-failure-condition failure) 'parse-error))))

(test manual-c-plans.failures-can-be-handled
  "Our RPL: HANDLE-FAILURE, by class; EVAP-PROTECT cleans up however its first form ends."
  (is (equal '((:handled 2) (:after 2))
             (log-of (block nil
                       (handle-failure ((:lost (failure) (note :handled) (return)))
                         (wait-time 2) (fail :class :lost)))
                     (note :after))))
  (is (equal '((:clean 1) (:clean 4) (:clean 6))
             (log-of (evap-protect (wait-time 1) (note :clean))
                     (pursue (evap-protect (wait-time 99) (note :clean)) (wait-time 3))
                     (evap-protect (seq (wait-time 2) (fail)) (note :clean))))))

;;; Procedures and macros.

(def-interp-proc twice-as-late (n) "Wait N ticks, twice." (wait-time n) (wait-time n) (plan-time))

(def-interp-macro (unless-late ?limit . ?body)
  `(pursue (seq ,@body) (wait-time ,limit)))

(test manual-c-plans.procedures-are-plans-with-parameters
  "D.2: DEF-INTERP-PROC defines a procedure; its value is that of its last form, and fluents may be
given to it, to be set."
  (is (= 6 (alone (twice-as-late 3))))
  (in-pantry () (is (= 4 (run-plan 'twice-as-late 2)) "it can be run by name"))
  (is (equal "Wait N ticks, twice." (documentation 'twice-as-late 'function))))

(test manual-c-plans.macros-have-patterns
  "D.8, reading 34: in (def-interp-macro (name ?x . ?rest) template) the variables x and rest are
what stands there."
  (is (equal '((:a 1)) (log-of (unless-late 4 (wait-time 1) (note :a) (wait-time 5) (note :b))))))

(test manual-c-plans.waiting-is-for-plans-only
  "Our RPL: a form that waits has no meaning in Lisp code, nor inside Lisp forms that cannot wait."
  (signals ars-magna-error (macroexpand '(wait-for robot-stopped*)))
  (signals ars-magna-error
    (macroexpand-1 '(interp-lambda () (mapcar (lambda (f) (wait-for f)) fluents)))))

;;; On a robot.

(test manual-c-plans.a-wait-after-a-command-hears-its-pulse
  "C, our RPL: the pulse of a command cannot come before the plan waits for it, however soon it
ends."
  (in-pantry ()
    (is (= 50 (planned (let ((heard 0))
                         (n-times 50
                           (rpl-hand-remove 0)
                           (if (wait-for (vref hand-moved* 0) :timeout 20) (incf heard)))
                         heard))))))

(test manual-c-plans.interrupted-commands-tell-so
  "C, reading 179: when a newer command interrupts an older one, that gets :INTERRUPT; then comes
the result of the newer."
  (in-pantry ()
    (is (equal '(:interrupt nil)
               (planned
                 (let ((codes '()))
                   (with-policy (whenever (robot-stopped* :missed :all)
                                  (push (fluent-value robot-movement-error*) codes))
                     (rpl-robot-goto-wall)
                     (wait-time 7)
                     (rpl-robot-turn 1)
                     (wait-time 20))
                   (reverse codes)))))))

(test manual-c-plans.losers-commands-go-on
  "Reading 185: the plan that loses in PURSUE is dropped; the robot continues its last command."
  (in-pantry ()
    (planned (pursue (seq (rpl-robot-go-forward 6) (wait-for robot-stopped*))
                     (wait-time 7)))
    (is (< 6 (robot-x cook) 7))
    (planned (wait-for robot-stopped* :timeout 30))
    (is (near 8.8 (robot-x cook) .01))))

(test manual-c-plans.plans-that-cannot-go-on-are-told
  "Our RPL: a plan that waits for what can never come is at a deadlock, which names the fluent."
  (in-pantry ()
    (is (eq :deadlock (nth-value 1 (run-plan (interp-lambda () (wait-for robot-arrived-at*))))))
    (is-true (has-words-p (first (message-texts)) "deadlock" "robot-arrived-at*"))))

(test manual-c-plans.valves-guarantee-ownership
  "D: valves guarantee ownership of a resource: one at a time, first come first served."
  (let ((hand (make-valve 'hand)))
    (is (equal '((1 0) (2 2) (3 4))
               (log-of (par-loop (n '(1 2 3)) (with-valve (hand) (note n) (wait-time 2))))))))

;;; Resources and arguments.

(test manual-c-plans.grabbing-stops-what-runs
  "C, reading 179: rpl-grab-robot, -camera, -hand and -bin stop the processes on that resource,
whose fluents become :INTERRUPT."
  (is (equal '(t :interrupt) (told (robot-stopped* robot-movement-error*)
                                   (seq (rpl-robot-goto-wall) (wait-time 7) (rpl-grab-robot)))))
  (is (equal '(t :interrupt) (told ((vref camera-moved* 1) (vref camera-movement-error* 1))
                                   (seq (rpl-camera-turn 1 1) (rpl-grab-camera 1)))))
  (is (equal '(t :interrupt) (told ((vref hand-moved* 2) (vref hand-error* 2))
                                   (seq (rpl-hand-insert-bin 2 0) (rpl-grab-hand 2)))))
  (is (equal '(t :interrupt) (told ((vref storage-bin-moved* 0) (vref storage-bin-error* 0))
                                   (seq (rpl-storage-bin-close 0) (rpl-grab-bin 0))))))

(test manual-c-plans.parts-do-not-mix
  "C: what one part does changes the fluents of that part only."
  (in-pantry ()
    (planned
      (dolist (fluent (list (vref camera-movement-error* 0) (vref hand-error* 0)
                            robot-movement-error*))
        (set-value fluent :mine))
      (rpl-camera-turn 1 1) (wait-for (vref camera-moved* 1))
      (rpl-hand-remove 2) (wait-for (vref hand-moved* 2)))
    (is (equal '(:mine :mine :mine nil :not-inside)
               (mapcar #'fluent-value (list (vref camera-movement-error* 0) (vref hand-error* 0)
                                            robot-movement-error* (vref camera-movement-error* 1)
                                            (vref hand-error* 2)))))))

(test manual-c-plans.arguments-may-be-fluents
  "C: all arguments can be fluents whose values are of the right type."
  (flet ((f (value) (create-fluent 'argument value)))
    (is (equalp '(t nil .7) (turned (rpl-robot-turn (f .7)))))
    (is (equal '(t nil 1) (searched (rpl-camera-get-object-designator (f 0) (f :local)
                                                                   (f '((:color violet)))))))
    (is (equal '(t nil "Storage-bin 1" "NIL") (handled (rpl-hand-insert (f 0) (f 1)))))
    (in-pantry ()
      (is (= 7 (rpl-hand-strength (f 1))))
      (is (eq (robot-camera cook 1) (rpl-robot-part 'camera (f 1))))
      (is-true (odometer-p (rpl-new-odometer (f 'walk)))))
    (with-simulation ((cook maid))
      (is (eq maid (rpl-init-robot (f maid)))))))

(test manual-c-plans.arguments-of-the-wrong-kind-are-told
  "C: indices are those of parts that there are, other arguments as for the command."
  (in-pantry ()
    (signals wrong-argument (rpl-camera-view 2))
    (signals wrong-argument (rpl-hand-ungrasp -1))
    (signals wrong-argument (rpl-storage-bin-open "0"))
    (signals wrong-argument (rpl-robot-turn 'left))
    (signals wrong-argument (rpl-camera-track 0 (create-fluent 'nothing)))))

;;; What commands of plans end.

(test manual-c-plans.a-wait-does-not-hear-an-older-command
  "C, our RPL: the interrupted command's fluents are set first, so a wait after the new command
waits for the new one."
  (in-pantry ()
    (is (equal '(nil 1.0)
               (planned (rpl-robot-goto-wall)
                        (wait-time 7)
                        (rpl-robot-turn 1)
                        (wait-for robot-stopped*)
                        (list (fluent-value robot-movement-error*)
                              (/ (round (or (fluent-value robot-angle-diff*) 0) .01) 100.0)))))))

(test manual-c-plans.a-plan-that-is-ended-takes-its-commands-along
  "Our RPL: when a whole plan is ended its commands are interrupted."
  (in-pantry ()
    (let ((plan (begin-plan (interp-lambda () (rpl-robot-goto-wall) (wait-for robot-stopped*)))))
      (run-ticks 8)
      (end-plan plan)
      (run-ticks 2)
      (let ((x (robot-x cook)))
        (run-ticks 10)
        (is (= x (robot-x cook)))))))

(test manual-c-plans.pulses-leave-the-value-that-was-there
  "Our RPL: a pulse is T for an instant, then the value is that which was there before."
  (let ((f (create-fluent 'f 5)))
    (is (equal 5 (alone (pulse f) (fluent-value f))))))
