;;;; digests.lisp -- the digest covers all of the state, of each kind, and nothing else.

(in-package :ars-magna.tests)

(def-suite* digests :in ars-magna)

;;; Everything in a run, by kind.

(defun events-of (simulation)
  (time:pending-events (run:simulation-agenda simulation)))

(defun digested-object-p (object)
  "True if OBJECT is of a kind, and no body of a robot: what a body is follows from its robot."
  (and (base:kind-of object) (not (world:body-p object))))

(defun parts-in (object)
  "Return a list of the objects of kinds that belong to OBJECT directly."
  (loop for slot in (base:kind-slots (base:kind-of object))
        for content = (funcall (base:kind-slot-reader slot) object)
        when (base:kind-slot-part-p slot)
          append (remove-if-not #'digested-object-p
                                (if (typep content 'sequence)
                                    (coerce content 'list)
                                    (list content)))))

(defun objects-in (simulation)
  "Return a list of all objects of kinds in SIMULATION, in an order that copies of it have too."
  (let ((objects '()))
    (labels ((visit (object)
               (push object objects)
               (mapc #'visit (parts-in object))))
      (visit simulation)
      (mapc #'visit (events-of simulation)))
    (reverse objects)))

(defun other-value (value dice)
  "Return a value unlike VALUE, a number or truth value, that could be in its place."
  (etypecase value
    (double-float (+ value (base:roll-between .1 1 dice)))
    (integer (+ value 1 (base:roll-index 5 dice)))
    (boolean (not value))))

(defun slots-to-change (object roles)
  "Return the slots of OBJECT of ROLES whose values this file knows how to change."
  (remove-if-not (lambda (slot)
                   (and (member (base:kind-slot-role slot) roles)
                        (subtypep (base:kind-slot-type slot)
                                  '(or double-float integer boolean))))
                 (base:kind-slots (base:kind-of object))))

(defun changed-twin (simulation number slot dice)
  "Return a copy of SIMULATION in which SLOT of the object with NUMBER has another value."
  (let* ((twin (run:fork-simulation simulation))
         (object (nth number (objects-in twin)))
         (value (funcall (base:kind-slot-reader slot) object)))
    (funcall (base:kind-slot-writer slot)
             (let ((other (other-value value dice)))
               (if (typep other (base:kind-slot-type slot)) other (- value 1)))
             object)
    twin))

(defun future (simulation)
  "Return the digests of SIMULATION at the next ticks, and where its robots then are."
  (loop repeat 6
        do (run:run-ticks 3 simulation)
        collect (run:state-digest simulation)
        append (loop for robot in (run:simulation-robots simulation)
                     append (multiple-value-list (robot:robot-position robot)))))

(defun any-slot (simulation roles dice)
  "Return the number of an object in SIMULATION and one of its slots of ROLES, by DICE."
  (let ((objects (objects-in simulation)))
    (loop
      (let* ((number (base:roll-index (length objects) dice))
             (slots (slots-to-change (nth number objects) roles)))
        (when slots (return (values number (base:roll-element slots dice))))))))

(defun call-at-moments (function moments seed)
  "Call FUNCTION with a simulation, in which much is under way, MOMENTS times."
  (run:with-simulation ((keeper helper) :seed seed)
    (let ((*ride* (make-ride (base:make-dice seed "moments"))))
      (populate)
      (loop repeat moments
            do (loop repeat 5 do (step-ride) (base:take-messages))
               (funcall function time:*simulation*)))))

(test digest.differs-with-any-state
  "8,000 pairs that are different in one slot: of state."
  (let ((dice (base:make-dice 1992 "pairs")) (same '()) (seen '()))
    (call-at-moments
     (lambda (simulation)
       (let ((digest (run:state-digest simulation)))
         (loop repeat 80
               do (multiple-value-bind (number slot) (any-slot simulation '(:state) dice)
                    (pushnew (base:kind-slot-name slot) seen)
                    (when (= digest (run:state-digest (changed-twin simulation number slot dice)))
                      (pushnew (base:kind-slot-name slot) same))))))
     100 7)
    (is (null same) "~A can differ unnoticed" same)
    (is (< 50 (length seen)) "only ~A" seen)))

(test digest.equal-means-the-same-future
  "2,000 pairs that are different in one slot: of memory or scratch."
  (let ((dice (base:make-dice 1992 "futures")) (different '()) (wrong '()))
    (call-at-moments
     (lambda (simulation)
       (let ((digest (run:state-digest simulation))
             (future (future (run:fork-simulation simulation))))
         (loop repeat 20
               do (multiple-value-bind (number slot)
                      (any-slot simulation '(:memory :scratch) dice)
                    (let ((twin (changed-twin simulation number slot dice)))
                      (unless (= digest (run:state-digest twin))
                        (pushnew (base:kind-slot-name slot) wrong))
                      (unless (equal future (future twin))
                        (pushnew (base:kind-slot-name slot) different)))))))
     100 8)
    (is (null wrong) "~A is digested" wrong)
    (is (null different) "~A decides" different)))

(test digest.covers-what-is-under-way
  (flet ((digest-after (function)
           (with-rover (:seed 3)
             (funcall function)
             (run:run-ticks 2)
             (run:state-digest))))
    (let ((digests (list (digest-after (lambda ()))
                         (digest-after (lambda () (command:robot-turn rover 1)))
                         (digest-after (lambda () (command:robot-turn rover 2)))
                         (digest-after (lambda () (command:robot-go-forward rover 9)))
                         (digest-after (lambda () (command:robot-go-forward rover 8)))
                         (digest-after (lambda () (time:schedule (nil :timer 9) nil)))
                         (digest-after (lambda () (time:schedule (nil :timer 8) nil)))
                         (digest-after (lambda () (setf base:braking* 3))))))
      (is (= (length digests) (length (remove-duplicates digests)))))))

(test digest.does-not-ask-who-is-told
  (flet ((digest-with (continuation)
           (with-rover (:seed 3)
             (command:robot-go-forward rover 9 continuation)
             (run:run-ticks 7)
             (run:state-digest))))
    (is (= (digest-with nil) (digest-with (lambda (&rest ignore) (declare (ignore ignore))))))))

;;; Copies.

(test copy.goes-the-way-of-its-original
  (call-at-moments
   (lambda (simulation)
     (let ((twin (run:fork-simulation simulation))
           (digest (run:state-digest simulation)))
       (is (= digest (run:state-digest twin)))
       (let ((twins-twin (run:fork-simulation twin)))
         (is (equal (future twin) (future twins-twin))))
       (is (= digest (run:state-digest simulation)) "the original is not disturbed")))
   30 9))

(test copy.of-a-run-that-goes-on-the-same
  "The original goes on too, without asking for anything more."
  (with-rover (:seed 5)
    (command:robot-go-forward rover 9)
    (time:schedule (:bell :timer 12) (setf (base:parameter-value 'base:braking*) 1))
    (run:run-ticks 6)
    (let ((twin (run:fork-simulation time:*simulation*)))
      (run:run-ticks 20 twin)
      (setf base:braking* 2)
      (run:run-ticks 20)
      (is (= (robot:robot-x rover) (robot:robot-x (first (run:simulation-robots twin)))))
      (is (not (eq rover (first (run:simulation-robots twin))))))))

(test copy.does-not-answer-for-its-original
  (with-rover (:seed 5)
    (let ((answers 0))
      (command:robot-turn rover 1 (lambda (&rest ignore)
                                    (declare (ignore ignore))
                                    (incf answers)))
      (run:run-ticks 2)
      (run:run-ticks 20 (run:fork-simulation time:*simulation*))
      (is (= 0 answers))
      (run:run-ticks 20)
      (is (= 1 answers)))))

;;; One seed.

(test seed.governs-plans-too
  (with-rover (:seed 3)
    (driver:rpl-init-robot rover)
    (run:set-seed 77)
    (let ((dice (rpl:agent-dice (rpl:runner-agent (driver:rpl-runner)))))
      (is (= (base:dice-state dice) (base:dice-state (base:make-dice 77 :plans))))
      (is (= 77 (run:simulation-seed time:*simulation*))))))

(test digest.of-participants-on-demand
  (with-rover (:seed 3)
    (driver:rpl-init-robot rover)
    (let ((alone (run:state-digest)) (with-plans (run:state-digest time:*simulation* t)))
      (driver:begin-plan 'listen-ahead)
      (is (= alone (run:state-digest)))
      (is (/= with-plans (run:state-digest time:*simulation* t))))))

;;; Names.

(defun digest-of (datum)
  (base:digest-value (base:digest-add (base:make-digest) datum)))

(test digest.names-count-as-what-they-are-called
  (loop for (name other) in '(("RED" "REED") ("ÄTNA" "ATNA"))
        for growing = (make-array 20 :element-type 'character :adjustable t :fill-pointer 0)
        do (loop for char across name do (vector-push-extend (char-downcase char) growing))
           (dolist (same (list (intern name :ars-magna.tests) (make-symbol (string-downcase name))
                               (string-downcase name) growing))
             (is (= (digest-of name) (digest-of same))))
           (is (/= (digest-of name) (digest-of other))))
  (is (= (digest-of nil) (digest-of "nil")))
  (is (= (digest-of "red") (digest-of (coerce "red" 'simple-base-string)))))

(test digests.of-what-is-no-simulation-are-refused-by-name
  (dolist (call (list (lambda () (run:state-digest nil t)) (lambda () (run:keep-forks t nil))))
    (let ((text (handler-case (progn (funcall call) "")
                  (base:wrong-argument (condition) (princ-to-string condition)))))
      (is-true (or (search "state-digest: simulation is NIL" text)
                   (search "keep-forks: simulation is NIL" text))
               "~A" text))))

(test digests.of-a-robot-are-those-of-its-run
  (with-rover ()
    (is (= (run:state-digest) (run:state-digest rover)))))
