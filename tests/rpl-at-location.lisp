;;;; rpl-at-location.lisp -- at-location alone: places lost, returned to, and shared.

(in-package :ars-magna.tests)
(in-suite rpl)

;;; A robot that is only a fluent, its place. It takes three ticks to go anywhere.

(rpl:def-interp-proc go-to-place (robot place)
  (tell (list :go place))
  (rpl:set-value robot :on-the-way)
  (rpl:wait-time 3)
  (rpl:set-value robot place))

(rpl:def-interp-proc stay-at (robot place ticks &optional (attempts 10))
  (rpl:at-location (place :there (eq robot place) :go (go-to-place robot place)
                          :attempts attempts)
    (rpl:evap-protect (rpl:seq (tell place)
                               (rpl:wait-time ticks)
                               (tell (list :done place)))
      (tell :end))))

(rpl:def-interp-proc push-away (robot tick times)
  (rpl:wait-time tick)
  (rpl:n-times times
    (tell :push)
    (rpl:set-value robot :elsewhere)
    (rpl:wait-time 5)))

(test at-location.goes-there-first
  (let ((robot (fluent :home)))
    (is (equal '(((:go :shop) 0) (:shop 3) ((:done :shop) 7) (:end 7))
               (tale (is (equal '(:done :shop) (plan-value (stay-at robot :shop 4)))))))
    (is (equal '((:shop 0) ((:done :shop) 1) (:end 1))
               (tale (plan-value (stay-at robot :shop 1)))))
    (is (null (fluents::fluent-first-watcher robot)))
    (is (null (fluents::fluent-first-link robot)))))

(test at-location.pushed-away-once
  "PL: the body evaporates, the robot goes there again, and the body starts anew."
  (let ((robot (fluent :home)))
    (is (equal '(((:go :shop) 0) (:shop 3) (:push 5) (:end 5) ((:go :shop) 5) (:shop 8)
                 ((:done :shop) 12) (:end 12))
               (tale (plan-value (rpl:par (stay-at robot :shop 4) (push-away robot 5 1))))))))

(test at-location.pushed-away-ten-times-and-once-more
  (flet ((outcome (times)
           (let ((robot (fluent :home)) (state nil))
             (list (count '(:go :shop)
                          (tale (multiple-value-bind (value how)
                                    (plan-outcome (rpl:par (push-away robot 5 times)
                                                           (stay-at robot :shop 6)))
                                  (setf state (if (eq how :failed) (type-of value) how))))
                          :key #'first :test #'equal)
                   state))))
    (is (equal '(11 :succeeded) (outcome 10)))
    (is (equal '(11 rpl:location-lost) (outcome 11)))))

(test at-location.attempts-and-place-are-said
  (let* ((robot (fluent :home))
         (failure (plan-failure-of (rpl:par (stay-at robot :shop 9 0) (push-away robot 5 1)))))
    (is (eq :shop (rpl:lost-place failure)))
    (is (eql 0 (rpl:lost-attempts failure)))
    (is (search "SHOP" (princ-to-string failure)))))

(test at-location.a-way-that-leads-elsewhere-counts
  (let ((turns 0))
    (is (typep (plan-failure-of (rpl:at-location (:shop :there (= turns 9) :go (incf turns)
                                                        :attempts 3)
                                  (tell :never)))
               'rpl:location-lost))
    (is (= 4 turns))))

(test at-location.of-two-the-one-whose-place-fits-does-not-drive
  (let ((robot (fluent :home)))
    (is (equal '(((:go :shop) 0) (:shop 3) (:shop 3) ((:done :shop) 5) (:end 5)
                 ((:done :shop) 9) (:end 9))
               (tale (plan-value (rpl:par (stay-at robot :shop 6) (stay-at robot :shop 2))))))))

(test at-location.of-two-the-other-waits-for-the-first
  "And who comes behind it waits too, though its place fits still: else the other might never go."
  (let ((robot (fluent :home)))
    (is (equal '(((:go :shop) 0) (:shop 3) ((:done :shop) 9) (:end 9)
                 ((:go :bank) 9) (:bank 12) ((:done :bank) 14) (:end 14)
                 ((:go :shop) 14) (:shop 17) ((:done :shop) 18) (:end 18))
               (tale (plan-value (rpl:par (stay-at robot :shop 6)
                                          (stay-at robot :bank 2)
                                          (rpl:seq (rpl:wait-time 4) (stay-at robot :shop 1)))))))))

(test at-location.what-is-no-fluent-is-looked-at
  (let ((place :home))
    (is (eq :at-shop
            (plan-value (rpl:par (rpl:seq (rpl:wait-time 4) (setf place :elsewhere))
                                 (rpl:at-location (:shop :there (eq place :shop)
                                                         :go (rpl:seq (rpl:wait-time 1)
                                                                      (setf place :shop)))
                                   (rpl:wait-time 6)
                                   :at-shop)))))
    (is (eq :shop place))))

(test at-location.can-be-left-and-fail
  (let ((robot (fluent :home)))
    (is (eq :left (plan-value (dolist (x '(1 2))
                                (rpl:at-location (:shop :there (eq robot :shop)
                                                        :go (go-to-place robot :shop))
                                  (return :left))))))
    (is (eq :body (rpl:failure-class
                   (plan-failure-of (rpl:at-location (:bank :there (eq robot :bank)
                                                            :go (go-to-place robot :bank))
                                      (rpl:fail :class :body))))))
    (is (eq :way (rpl:failure-class
                  (plan-failure-of (rpl:at-location (:shop :there (eq robot :shop)
                                                           :go (rpl:fail :class :way))
                                     1)))))))

(test at-location.leaves-nothing-behind-whenever-it-ends
  "Ended at each tick, in each order: afterwards the way is free, and nobody watches the robot."
  (dotimes (tick 24)
    (dolist (places '((:shop :bank :shop) (:shop :shop :bank) (:bank :home :shop)))
      (let ((robot (fluent :home)) (free nil))
        (tale
          (plan-value
            (rpl:pursue (rpl:par (stay-at robot (first places) 4)
                                 (stay-at robot (second places) 3)
                                 (stay-at robot (third places) 2)
                                 (push-away robot 4 2)
                                 (rpl:wait-time 100))
                        (rpl:wait-time tick))
            (setf free (and (null (rpl:valve-owner (constructs::stay-registry-valve
                                                    (constructs::stay-registry))))
                            (null (rpl:fluent-value (constructs::stay-registry-stays
                                             (constructs::stay-registry))))))
            (stay-at robot :far 1)))
        (is (eq t free))
        (is (null (fluents::fluent-first-watcher robot)))
        (is (null (fluents::fluent-first-link robot)))))))

(test at-location.needs-a-test-and-a-way
  (dolist (form '((rpl:at-location (:shop :there t) 1)
                  (rpl:at-location (:shop :go t) 1)
                  (rpl:at-location (:shop :there t :go t :when t) 1)
                  (rpl:at-location :shop 1)))
    (signals base:malformed-definition (rpl:make-plan form))))
