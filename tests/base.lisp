;;;; base.lisp -- dice, parameters, messages, names and user code.

(in-package :ars-magna.tests)

(def-suite* base :in ars-magna)

;;; Dice.

(test dice.same-seed-and-purpose-roll-the-same
  (let ((a (base:make-dice 7 :motion)) (b (base:make-dice 7 "motion"))
        (c (base:make-dice 7 :place)) (d (base:make-dice 8 :motion)))
    (flet ((rolls (dice) (loop repeat 20 collect (base:roll dice))))
      (let ((first (rolls a)))
        (is (equal first (rolls (base:copy-dice (base:make-dice 7 :motion)))))
        (is (not (equal first (rolls c))))
        (is (not (equal first (rolls d)))))
      (is-true (rolls b)))))

(test dice.are-uniform
  "Chi-square of 100,000 rolls in 100 classes, 99 degrees of freedom; the bound is at p = 0.999."
  (let ((dice (base:make-dice 1)) (counts (make-array 100 :initial-element 0)))
    (loop repeat 100000 do (incf (aref counts (floor (* 100 (base:roll dice))))))
    (is (< (loop for count across counts sum (/ (expt (- count 1000) 2) 1000d0)) 148.2d0))))

(test dice.gaussian-has-its-moments
  (let* ((dice (base:make-dice 2))
         (rolls (loop repeat 40000 collect (base:roll-gaussian 3 2 dice)))
         (mean (/ (reduce #'+ rolls) 40000))
         (variance (/ (loop for r in rolls sum (expt (- r mean) 2)) 40000)))
    (is (< (abs (- mean 3)) 0.05d0))
    (is (< (abs (- variance 4)) 0.15d0))
    (is (= 5d0 (base:roll-gaussian 5 0 dice)))))

(test dice.certainty-rolls-nothing
  (let* ((dice (base:make-dice 4)) (state (base:dice-state dice)))
    (is-false (base:chance 0 dice))
    (is-true (base:chance 1 dice))
    (is (= 0d0 (base:roll-within 0 dice)))
    (is (= state (base:dice-state dice)))))

;;; Parameters.

(defparameter *defaults*
  '((base:max-speed* 1) (base:braking* 2) (base:motion-noise* 0.1d0) (base:scan-density* 50)
    (base:prob-lose-false-track* 0.4d0) (base:pixel-error-range* 2d0) (base:hand-grasp-delay* 4)
    (base:no-sensor-error* nil) (base:bin-close-jam-prob* 0.01d0))
  "Some defaults of chapter 4, from each group.")

(test parameters.have-the-manuals-defaults
  (loop for (symbol default) in *defaults*
        do (is (eql default (base:parameter-default (base:find-parameter symbol))) "~A" symbol)))

(test parameters.are-checked-where-they-enter
  (base:call-with-parameters
   '()
   (lambda ()
     (signals base:wrong-argument (setf (base:parameter-value "motion-noise*") 2))
     (signals base:wrong-argument (setf (base:parameter-value "braking") 1.5))
     (signals base:unknown-name (base:parameter-value "max-sped"))
     (is (= 3 (setf (base:parameter-value "Braking*") 3)))
     (is (= 3 base:braking*))))
  (is (= 2 base:braking*)))

(test parameters.are-given-in-pairs
  (dolist (settings '(7 (7) (:seed (max-speed* 2)) ((max-speed* 2) "x") ((max-speed* 2 3))
                      ((max-speed* . 2)) ((max-speed* 2) . 3)))
    (signals base:wrong-argument (base:call-with-parameters settings (constantly nil))))
  (signals base:unknown-name (base:call-with-parameters '((7 2)) (constantly nil)))
  (is (= 2 (base:call-with-parameters '((max-speed* 2)) (lambda () base:max-speed*)))))

(test parameters.clean-and-dirty
  "Cleaning removes all noise, once; delays and limits stay; dirtying restores."
  (base:call-with-parameters
   '((motion-noise* 0.3))
   (lambda ()
     (base:clean-simulation)
     (base:clean-simulation)
     (dolist (parameter (base:all-parameters))
       (if (eq :noise (base:parameter-kind parameter))
           (is (member (base:parameter-value parameter) '(0d0 t)) "~A" parameter)
           (is (eql (base:parameter-default parameter) (base:parameter-value parameter)))))
     (base:dirty-simulation)
     (is (= 0.3 base:motion-noise*))
     (is-false base:no-sensor-error*)
     (setf base:braking* 7)
     (base:dirty-simulation)
     (is (= 7 base:braking*)))))

;;; Messages.

(defmacro with-messages (&body body)
  "Run BODY with a message queue of its own."
  `(let ((base:*message-queue* (base:make-message-queue))) ,@body))

(defun displayed ()
  (with-output-to-string (stream) (base:error-display stream)))

(test messages.are-queued-and-displayed-once
  (with-messages
    (base:message-set "Robot turned " 0.5d0)
    (base:warning-set "It is " 'late)
    (base:error-set "one" t "two")
    (is (string= (format nil "Robot turned 0.5~%*WARNING* -> It is LATE~%*ERROR* -> one~%two~%")
                 (displayed)))
    (is (string= "" (displayed)))))

(test messages.can-be-flushed-unseen
  (with-messages
    (base:error-set "never seen")
    (let ((base:flush-all-errors* t)) (is (string= "" (displayed))))
    (is (string= "" (displayed)))))

(test messages.are-bounded
  (with-messages
    (loop for i below (+ (* 2 base:*message-limit*) 500) do (base:message-set i))
    (let ((messages (base:take-messages)))
      (is (<= (length messages) (1+ base:*message-limit*)))
      (is (eq :warning (base:message-kind (first messages))))
      (is (string= (princ-to-string (+ (* 2 base:*message-limit*) 499))
                   (base:message-text (first (last messages))))))))

;;; Names and user code.

(test names.compare-by-name
  (is-true (base:value-equal :red 'red))
  (is-true (base:value-equal '(a 1 "x") '(:a 1.0 "x")))
  (is-false (base:value-equal 'red 'blue))
  (is-false (base:value-equal nil 'nil-like))
  (is (string= "robot" (base:nearest-name "robt" '("hand" "robot"))))
  (is (null (base:nearest-name "xyzzy" '("hand" "robot")))))

(test user-code.trouble-becomes-a-message
  (with-messages
    (is (null (base:call-user-code (lambda (x) (car x)) "a test" 5)))
    (is (search "Error in a test" (displayed))))
  (with-messages
    (is (equal '(1 2) (multiple-value-list
                       (base:call-user-code (lambda () (values 1 2)) "a test"))))
    (is (string= "" (displayed)))))

(test digest.tells-data-apart
  (flet ((digest (datum) (base:digest-value (base:digest-add (base:make-digest) datum))))
    (is (= (digest '(1 2.5d0 :red "x")) (digest (list 1 2.5d0 'red "X"))))
    (is (/= (digest 1d0) (digest (+ 1d0 double-float-epsilon double-float-epsilon))))
    (is (/= (digest '(1 2)) (digest '(2 1))))
    (is (/= (digest 0d0) (digest -0d0)))))
