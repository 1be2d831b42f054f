;;;; rpl-fluents.lisp -- fluents, networks, pulses.

(in-package :ars-magna.tests)
(def-suite* rpl :in ars-magna)

(defmacro plan-outcome (&body body)
  "Run BODY as a plan alone, its messages kept apart; return its value and state."
  `(let ((base:*message-queue* (base:make-message-queue)))
     (rpl:run-plan-alone (rpl:interp-lambda () ,@body))))

(defmacro plan-value (&body body)
  "Return the value of BODY as a plan that must succeed."
  `(multiple-value-bind (value state) (plan-outcome ,@body)
     (is (eq :succeeded state))
     value))

(defmacro plan-failure-of (&body body)
  "Return the failure of BODY as a plan that must fail."
  `(multiple-value-bind (failure state) (plan-outcome ,@body)
     (is (eq :failed state))
     failure))

(defun fluent (&optional value (name 'f)) (rpl:create-fluent name value))

(test fluent.holds-a-value
  (let ((f (fluent 3)))
    (is (= 3 (rpl:fluent-value f)))
    (is (eq :new (rpl:set-value f :new)))
    (is (eq :new (rpl:fluent-value f)))
    (setf (rpl:fluent-value f) 4)
    (is (= 4 (rpl:fluent-value f)))
    (is (null (rpl:fluent-value (rpl:state 'got-it))))))

(test fluent-value.of-anything-else-is-itself
  (is (equal '(1 2) (rpl:fluent-value '(1 2))))
  (is (null (rpl:fluent-value nil))))

(test fluent.shows-name-and-value
  (is (string= "#<fluent got-desig = NIL>" (princ-to-string (rpl:state 'got-desig))))
  (let ((f (fluent 3 'height)))
    (is (string= "#<fluent (> height 2) = T>"
                 (princ-to-string (ars-magna.rpl.lifted:> f 2))))))

(test fluent-vector.is-a-vector-of-fluents
  (let ((moved (rpl:create-fluent-vector 'camera-moved* 3)))
    (rpl:set-value (nisp:vref moved 1) t)
    (is (equal '(nil t nil) (map 'list #'rpl:fluent-value moved)))))

;;; Networks.

(test network.follows-its-sources
  (let* ((f (fluent 1)) (g (fluent 2))
         (networks (list (ars-magna.rpl.lifted:+ f g) (ars-magna.rpl.lifted:< f g)
                         (ars-magna.rpl.lifted:and f g) (ars-magna.rpl.lifted:or f g)
                         (ars-magna.rpl.lifted:not f) (ars-magna.rpl.lifted:eql f g)
                         (rpl:fl-funcall #'list f 0 g) (rpl:fl-apply #'max f (list g 0)))))
    (is (equal '(3 t 2 1 nil nil (1 0 2) 2) (mapcar #'rpl:fluent-value networks)))
    (rpl:set-value f 2)
    (is (equal '(4 nil 2 2 nil t (2 0 2) 2) (mapcar #'rpl:fluent-value networks)))))

(test network.without-fluents-is-plain-lisp
  (is (= 3 (ars-magna.rpl.lifted:+ 1 2)))
  (is (= 3 (funcall 'ars-magna.rpl.lifted:+ 1 2)))
  (is (eq :b (ars-magna.rpl.lifted:and :a :b)))
  (is (null (ars-magna.rpl.lifted:and nil (error "not evaluated"))))
  (is (eq :a (ars-magna.rpl.lifted:or :a (error "not evaluated"))))
  (is (= 6 (rpl:fl-apply #'+ 1 '(2 3)))))

(test lifted.conditions-read-fluents-by-value
  (let ((f (fluent nil)))
    (is (eq :no (ars-magna.rpl.lifted:if f :yes :no)))
    (is (eq :no (ars-magna.rpl.lifted:cond (f :yes) (t :no))))
    (is (null (ars-magna.rpl.lifted:when f :yes)))
    (is (eq :no (ars-magna.rpl.lifted:unless f :no)))
    (let ((turns 0))
      (ars-magna.rpl.lifted:loop until f (when (= 3 (incf turns)) (rpl:set-value f t)))
      (is (= 3 turns)))))

(test network.is-forgotten-by-its-sources-when-nobody-watches
  (let ((f (fluent 0)))
    (plan-value (rpl:pursue (rpl:wait-for (> (+ f 1) 10))
                            (rpl:wait-for (and (> f 3) (< f 5)))
                            (rpl:seq (rpl:wait-time 1)
                                     (is (fluents::fluent-first-link f))
                                     (rpl:set-value f 4))))
    (is (null (fluents::fluent-first-link f)))
    (is (null (fluents::fluent-first-watcher f)))))

(test network.is-computed-once-for-each-change-of-a-diamond
  (let* ((f (fluent 0)) (computed 0)
         (left (rpl:fl-funcall #'1+ f))
         (right (rpl:fl-funcall #'- (rpl:fl-funcall #'1- f)))
         (both (rpl:fl-funcall (lambda (a b) (incf computed) (+ a b)) left right))
         (odd-one-out (ars-magna.rpl.lifted:not (ars-magna.rpl.lifted:eql both 2))))
    (is (eq :deadlock
            (nth-value 1 (plan-outcome
                           (rpl:par (rpl:wait-for odd-one-out)
                                    (rpl:seq (setf computed 0)
                                             (dotimes (i 10) (rpl:set-value f (+ i 1)))))))))
    (is (= 10 computed))))

(test network.that-is-deep-and-shared-is-computed-on-demand
  (let ((f (fluent 1)))
    (loop with network = f
          repeat 60
          do (setf network (ars-magna.rpl.lifted:- (ars-magna.rpl.lifted:+ network network)
                                                   network))
          finally (is (= 1 (rpl:fluent-value network))))))

(test network.agrees-with-plain-computation
  "Random networks under random settings, watched and not."
  (let ((dice (base:make-dice 11 "networks")))
    (loop repeat 60
          do (let* ((bases (loop repeat 4 collect (fluent 0)))
                    (nodes (coerce bases 'vector))
                    (thunks (map 'vector (lambda (f) (lambda () (rpl:fluent-value f))) bases)))
               (loop repeat 20
                     do (let* ((i (base:roll-index (length nodes) dice))
                               (j (base:roll-index (length nodes) dice))
                               (a (aref thunks i)) (b (aref thunks j))
                               (mix (lambda (x y) (mod (+ (* 3 x) y 1) 5))))
                          (setf nodes (concatenate 'vector nodes
                                                   (list (rpl:fl-funcall mix (aref nodes i)
                                                                         (aref nodes j))))
                                thunks (concatenate 'vector thunks
                                                    (list (lambda ()
                                                            (funcall mix (funcall a)
                                                                     (funcall b))))))))
               (let ((watcher (fluents::make-watcher (aref nodes 23) #'list nil)))
                 (fluents::watch watcher)
                 (loop repeat 30
                       do (rpl:set-value (base:roll-element bases dice) (base:roll-index 5 dice))
                          (unless (every (lambda (node thunk)
                                           (= (rpl:fluent-value node) (funcall thunk)))
                                         nodes thunks)
                            (fail "a network is out of date")))
                 (fluents::unwatch watcher)
                 (is (every (lambda (f) (null (fluents::fluent-first-link f))) bases)))))))

(test set-value.refuses-networks-and-what-is-no-fluent
  (signals ars-magna.base:wrong-argument
    (rpl:set-value (ars-magna.rpl.lifted:not (fluent)) t))
  (signals ars-magna.base:wrong-argument (rpl:set-value 3 t))
  (let ((fluent (rpl:state 'itself)) (other (rpl:state 'other)))
    (signals ars-magna.base:wrong-argument (rpl:set-value fluent fluent))
    (signals ars-magna.base:wrong-argument (rpl:pulse fluent fluent))
    (is (eq other (rpl:set-value fluent other)) "another fluent can be a value"))
  (signals ars-magna.base:wrong-argument (rpl:pulse nil)))

(test set-value.is-not-for-networks-to-do
  (let* ((f (fluent 0)) (g (fluent 0))
         (meddler (rpl:fl-funcall (lambda (x) (when (plusp x) (rpl:set-value g x)) nil) f))
         (failure (plan-failure-of (rpl:par (rpl:wait-for meddler) (rpl:set-value f 1)))))
    (is (typep (rpl:lisp-failure-condition failure) 'base:misuse))
    (is (= 0 (rpl:fluent-value g)))))

;;; Waiting and pulses.

(test wait-for.returns-the-value-at-once-if-it-is-true
  (is (eq :yes (plan-value (rpl:wait-for (fluent :yes)))))
  (is (eq :yes (plan-value (rpl:wait-for :yes)))))

(test wait-for.wakes-in-order-of-arrival
  (let ((f (fluent)) (woken '()))
    (plan-value (rpl:par (rpl:par-loop (i '(1 2 3 4 5))
                           (rpl:wait-for f)
                           (push i woken))
                         (rpl:seq (rpl:wait-time 1) (rpl:set-value f t))))
    (is (equal '(5 4 3 2 1) woken))))

(test wait-for.a-network-wakes-when-it-becomes-true
  (let ((stopped (fluent)) (arrived (fluent)))
    (is (equal '(:there 3)
               (plan-value
                 (rpl:par (rpl:seq (rpl:wait-time 1) (rpl:pulse stopped)
                                   (rpl:wait-time 1) (rpl:set-value arrived :there)
                                   (rpl:wait-time 1) (rpl:pulse stopped))
                          (let ((value (rpl:wait-for (and stopped arrived))))
                            (list value (rpl:plan-time)))))))))

(test wait-for.gives-up-after-its-timeout
  (let ((f (fluent)))
    (is (equal '(nil 4) (plan-value (list (rpl:wait-for f :timeout 4) (rpl:plan-time)))))
    (is (equal '(:in-time 2)
               (plan-value
                 (rpl:par (rpl:seq (rpl:wait-time 2) (rpl:pulse f :in-time))
                          (list (rpl:wait-for f :timeout 4) (rpl:plan-time))))))
    (is (null (fluents::fluent-first-watcher f)))))

(test pulse.wakes-all-who-wait-and-leaves-the-fluent-false
  (let ((f (fluent)) (woken 0))
    (plan-value (rpl:par (rpl:par-loop (i '(1 2 3)) (rpl:wait-for f) (incf woken))
                         (rpl:seq (rpl:wait-time 1)
                                  (rpl:pulse f)
                                  (is (null (rpl:fluent-value f))))))
    (is (= 3 woken))))

(test pulse.is-heard-by-networks-of-it
  (let ((f (fluent)) (g (fluent 3)))
    (is (eq t (plan-value (rpl:par (rpl:seq (rpl:wait-time 1) (rpl:pulse g nil))
                                   (rpl:wait-for (not g))))))
    (is (= 7 (plan-value (rpl:par (rpl:seq (rpl:wait-time 1) (rpl:pulse f 7))
                                  (rpl:wait-for (or (= g 4) f))))))))

(test pulse.is-over-after-an-instant
  "Then the fluent, and what depends on it, is as it was before."
  (let ((f (fluent)) (g (fluent 3)))
    (is (equal '(nil 3 (7 t) 3)
               (plan-value (let ((network (> g 5)))
                             (rpl:pulse f)
                             (rpl:pulse g)
                             (list (rpl:fluent-value f) (rpl:fluent-value g)
                                   (let ((heard nil))
                                     (rpl:par (rpl:seq (rpl:wait-for network)
                                                       (setf heard t))
                                              (rpl:pulse g 7))
                                     (list 7 heard))
                                   (rpl:fluent-value g))))))))

(test pulse.none-is-missed-by-a-task-that-waits-in-time
  (let ((ping (fluent)) (pong (fluent)) (heard 0))
    (plan-value
      (rpl:par (dotimes (i 300) (rpl:wait-for ping) (incf heard) (rpl:pulse pong))
               (dotimes (i 300) (rpl:pulse ping) (rpl:wait-for pong))))
    (is (= 300 heard))))

(test pulse.commits-the-waiter-whatever-follows
  (let ((f (fluent)))
    (is (eq :heard (plan-value (rpl:par (rpl:seq (rpl:wait-time 1) (rpl:pulse f :heard)
                                                 (rpl:pulse f nil) (rpl:set-value f nil))
                                        (rpl:wait-for f)))))))

(test apply-settings.happen-at-one-instant
  "The value and error fluents of a command are set when its pulse is heard (manual C)."
  (let ((designators (fluent)) (trouble (fluent :old)) (input (fluent)) (seen '()))
    (plan-value
      (rpl:par (rpl:seq (rpl:wait-for input)
                        (setf seen (list (rpl:fluent-value designators)
                                         (rpl:fluent-value trouble))))
               (rpl:seq (rpl:wait-time 1)
                        (rpl:apply-settings `((:pulse ,input) (:set ,trouble nil)
                                              (:set ,designators (d1)))))))
    (is (equal '((d1) nil) seen)))
  (let ((a (fluent 1)) (b (fluent 2)))
    (is (eq :deadlock
            (nth-value 1 (plan-outcome
                           (rpl:par (rpl:wait-for (= a b))
                                    (rpl:seq (rpl:wait-time 1)
                                             (rpl:apply-settings
                                              `((:set ,a 2) (:set ,b 1))))))))
        "a reader saw one setting without the other")))

(test network.an-error-in-it-fails-those-who-wait
  (let* ((f (fluent 1))
         (failure (plan-failure-of (rpl:par (rpl:wait-for (< f 0))
                                            (rpl:seq (rpl:wait-time 1) (rpl:set-value f :x))))))
    (is (typep failure 'rpl:lisp-failure))
    (is (typep (rpl:lisp-failure-condition failure) 'type-error))
    (is (equal '(rpl:wait-for (< f 0)) (rpl:failure-form failure)))))

(test fluents.of-a-vector-are-numbered
  (let ((fluents (rpl:create-fluent-vector "dial" 12)))
    (is (equal '("dial 0" "dial 9" "dial 10" "dial 11")
               (loop for index in '(0 9 10 11)
                     collect (rpl:fluent-name (svref fluents index)))))))
