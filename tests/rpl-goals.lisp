;;;; rpl-goals.lisp -- goals by pattern: def-goal, achieve, perceive, belief.

(in-package :ars-magna.tests)
(in-suite rpl)

;;; The robot's beliefs are a list of facts such as (on a b).

(defvar *believed* '() "Goals that are believed.")

(defun believed-p (goal) (find goal *believed* :test #'base:value-equal))

(defun begin-to-believe (goal) (push goal *believed*))

(rpl:def-goal (belief (on ?a ?b))
  "True if A is believed to be on B."
  (believed-p (list 'on a b)))

(rpl:def-goal (achieve (on ?a ?b))
  (rpl:wait-time 2)
  (begin-to-believe (list 'on a b))
  (list a :on b))

(rpl:def-goal (achieve (on ?a floor))
  (rpl:wait-time 1)
  (begin-to-believe (list 'on a 'floor))
  (rpl:succeed-with a :dropped))

(rpl:def-goal (achieve (on ?a ?a))
  (rpl:wait-time 1)
  :is-no-use)

(rpl:def-goal (achieve (tidy . ?things))
  (dolist (thing things)
    (rpl:achieve `(on ,thing shelf)))
  (length things))

(rpl:def-goal (perceive (on ?a ?b))
  (rpl:wait-time 1)
  (setf *believed* (remove (list 'on a b) *believed* :test #'equal))
  (if (eq b 'table) (begin-to-believe (list 'on a b)))
  (if (eq b 'nowhere) (rpl:fail :class :cannot-look)))

(rpl:def-goal (perceive (color ?thing))
  (rpl:wait-time 1)
  (list thing :red))

(defun values-of-achieving (goal)
  "Return a list of the two values of achieving GOAL."
  (plan-value (multiple-value-bind (a b) (rpl:achieve goal) (list a b))))

(test achieve.does-what-makes-it-believed
  (let ((*believed* '()))
    (is (equal '(((cup :on table) 2) (2 2))
               (with-log (note)
                 (plan-value (note (rpl:achieve '(on cup table)))
                             (note (rpl:plan-time))))))
    (is (believed-p '(on cup table)))))

(test achieve.returns-at-once-if-it-is-believed
  (let ((*believed* '((on cup table))))
    (is (equal '((on cup table) 0)
               (plan-value (list (rpl:achieve '(on cup table)) (rpl:plan-time)))))))

(test achieve.the-most-specific-pattern-counts
  "Whatever the order of definition; a variable used twice is more specific than two."
  (let ((*believed* '()))
    (is (equal '(cup :dropped)
               (values-of-achieving '(on cup floor))))
    (let ((failure (plan-failure-of (rpl:achieve '(on cup cup)))))
      (is (typep failure 'rpl:goal-not-achieved))
      (is (equal '(on cup cup) (rpl:failed-goal failure)))
      (is (search "achieve (on cup cup)" (princ-to-string failure))))))

(test achieve.names-are-those-of-any-package
  (let ((*believed* '()))
    (is (equal '(2 :dropped) (values-of-achieving '(:on 2 :floor))))))

(test achieve.goals-of-goals
  (let ((*believed* '((on pen shelf))))
    (is (= 2 (plan-value (rpl:achieve `(tidy pen ,'book)))))
    (is (believed-p '(on book shelf)))
    (is (zerop (plan-value (rpl:achieve '(tidy)))))))

(test achieve.without-a-goal-says-which-there-are
  (dolist (form (list (rpl:interp-lambda () (rpl:achieve '(under a b)))
                      (rpl:interp-lambda () (rpl:achieve '(on a)))
                      (rpl:interp-lambda () (rpl:achieve :happiness))))
    (let ((failure (plan-failure-of (rpl:call-plan form))))
      (is (typep failure 'rpl:unknown-goal))
      (is (eq 'rpl:achieve (rpl:failed-goal-operator failure)))
      (is (member '(on ?a floor) (rpl:unknown-goal-known failure) :test #'base:value-equal))
      (is (search "(on ?a floor)" (princ-to-string failure)))))
  (is (eq :handled (plan-value (rpl:handle-failure ((rpl:goal-failure (f)
                                                      (return (and (rpl:failed-goal f) :handled))))
                                 (rpl:achieve '(under a b)))))))

(test perceive.looks-and-returns-what-is-believed-then
  (let ((*believed* '((on cup shelf))))
    (is (equal '(t nil 2)
               (plan-value (list (and (rpl:perceive '(on cup table)) t)
                                 (rpl:perceive '(on cup shelf))
                                 (rpl:plan-time)))))
    (is (equal '(ball :red) (plan-value (rpl:perceive '(color ball)))))
    (is (eq :cannot-look (rpl:failure-class (plan-failure-of (rpl:perceive '(on cup nowhere))))))
    (is (typep (plan-failure-of (rpl:perceive '(size ball))) 'rpl:unknown-goal))))

(test belief.asks
  (let ((*believed* '((on cup shelf))))
    (is (equal '((on cup shelf) nil)
               (plan-value (list (rpl:belief '(on cup shelf)) (rpl:belief '(on cup table))))))
    (is (typep (plan-failure-of (rpl:belief '(color ball))) 'rpl:unknown-goal))))

(test belief.may-be-a-fluent
  "A network counts by its value, for ACHIEVE too."
  (base:with-own-definitions ()
    (let ((height (fluent 0)))
      (setf (get 'height 'fluent) height)
      (define-quietly '(rpl:def-goal (belief (higher ?h))
                        (ars-magna.rpl.lifted:> (get 'height 'fluent) h)))
      (define-quietly '(rpl:def-goal (achieve (higher ?h))
                        (rpl:n-times h (rpl:wait-time 1)
                          (rpl:set-value (get 'height 'fluent)
                                         (1+ (rpl:fluent-value (get 'height 'fluent)))))))
      (is (typep (plan-failure-of (rpl:achieve '(higher 2))) 'rpl:goal-not-achieved))
      (is (null (plan-value (rpl:achieve '(higher 3)))))
      (is (= 5 (rpl:fluent-value height)))
      (is (eq t (rpl:fluent-value (plan-value (rpl:achieve '(higher 4)))))))))

(test goals-under-way.say-for-what
  (base:with-own-definitions ()
    (define-quietly '(rpl:def-goal (achieve (on ?a shelf))
                      (rpl:par (rpl:wait-time 1)
                               (rpl:seq (rpl:wait-time 1)
                                        (begin-to-believe (rpl:goals-under-way))
                                        (begin-to-believe (list 'on a 'shelf))))))
    (let ((*believed* '()))
      (plan-value (rpl:achieve '(tidy book)))
      (is (equal '((rpl:achieve (on book shelf)) (rpl:achieve (tidy book)))
                 (second *believed*))))))

(test achieve.is-shown-with-its-goal
  (let ((*believed* '()) (a 'cup))
    (base:with-own-definitions ()
      (define-quietly '(rpl:def-goal (achieve (on ?a ?b)) (rpl:fail :class :too-high :on b)))
      (let ((failure (plan-failure-of (rpl:achieve `(on ,a shelf)))))
        (is (member '(rpl:achieve (on cup shelf)) (rpl:failure-plan-backtrace failure)
                    :test #'equal))))))

;;; Defining.

(test def-goal.replaces-what-matches-the-same
  (base:with-own-definitions ()
    (let ((count (length (rpl:all-goals))) (*believed* '()))
      (define-quietly '(rpl:def-goal (achieve (on ?thing ?place))
                        (begin-to-believe (list 'on thing place))
                        :anew))
      (is (= count (length (rpl:all-goals))))
      (is (eq :anew (plan-value (rpl:achieve '(on cup table)))))
      (is (equal '(cup :dropped)
                 (values-of-achieving '(on cup floor))))
      (base:undefine 'goal "achieve (on ?a floor)")
      (is (= (1- count) (length (rpl:all-goals))))
      (setf *believed* '())
      (is (eq :anew (plan-value (rpl:achieve '(on cup floor)))))))
  (let ((*believed* '()))
    (is (equal '(cup :on table) (plan-value (rpl:achieve '(on cup table)))))))

(test def-goal.of-two-none-more-specific-the-first-counts
  (base:with-own-definitions ()
    (define-quietly '(rpl:def-goal (achieve (near ?thing wall)) :first))
    (define-quietly '(rpl:def-goal (achieve (near door ?thing)) :second))
    (is (eq :first (plan-value (rpl:achieve '(near door wall)))))
    (is (eq :second (plan-value (rpl:achieve '(near door door)))))
    (define-quietly '(rpl:def-goal (achieve (near door wall)) :third))
    (is (eq :third (plan-value (rpl:achieve '(near door wall)))))))

(test def-goal.is-found-and-documented
  (let ((goal (rpl:find-goal "belief (on ?a ?b)")))
    (is (eq 'rpl:belief (rpl:goal-operator goal)))
    (is (base:value-equal '(on ?a ?b) (rpl:goal-pattern goal)))
    (is (string= "True if A is believed to be on B." (documentation goal t)))
    (is (search "belief (on ?a ?b)" (princ-to-string goal))))
  (signals base:unknown-name (rpl:find-goal "achieve (happiness)")))

(test def-goal.what-makes-no-sense-is-said-at-once
  (dolist (form '((rpl:def-goal (maintain (on ?a ?b)) t)
                  (rpl:def-goal (achieve) t)
                  (rpl:def-goal (achieve on) t)
                  (rpl:def-goal achieve t)))
    (signals base:malformed-definition (macroexpand-1 form)))
  (signals base:malformed-definition (rpl:make-plan '(rpl:succeed-with 1))))

(test achieve.without-end-fails-as-deep-calls-do
  (base:with-own-definitions ()
    (define-quietly '(rpl:def-goal (achieve (deeper ?n)) (rpl:achieve `(deeper ,(1+ n)))))
    (is (eq :too-deep (rpl:failure-class (plan-failure-of (rpl:achieve '(deeper 1))))))))

(rpl:def-interp-proc apply-myself () (rpl:apply-plan 'apply-myself '()))

(test apply-plan.without-end-fails-as-deep-calls-do
  (is (eq :too-deep (rpl:failure-class (plan-failure-of (rpl:apply-plan 'apply-myself '()))))))
