;;;; rpl-hostile.lisp -- invalid plans are refused, in our words.

(in-package :ars-magna.tests)
(in-suite rpl)

(defun refused-text (form)
  "Return what is said when FORM is refused as a definition; NIL if it is not."
  (handler-case (progn (base:with-own-definitions () (eval form)) nil)
    (base:malformed-definition (condition) (princ-to-string condition))))

(defun refused-saying-p (text form)
  "True if FORM is refused with TEXT, and shows nothing of what it would become."
  (let ((said (let ((*package* (find-package :ars-magna.tests))) (refused-text form))))
    (and said (search text said)
         (notany (lambda (inner) (search inner said :test #'char-equal))
                 '("%make-policy" "#:" "destructuring")))))

(defmacro refused-each (text &rest forms)
  "Check that each of FORMS is refused with TEXT."
  `(progn ,@(loop for form in forms
                  collect `(is (refused-saying-p ,text ',form)
                               "~S: ~A" ',form (refused-text ',form)))))

;;; Names.

(test hostile.plans-are-called-by-symbols
  (refused-each "a symbol as the name"
    (rpl:def-interp-proc (setf colour) (thing) (rpl:wait-time 1))
    (rpl:def-interp-macro ((setf colour) ?x) x)
    (rpl:def-interp-proc "colour" () 1))
  (is (null (rpl:find-procedure 'colour nil)))
  (handler-bind ((warning #'muffle-warning))
    (is (null (refused-text '(rpl:interp-lambda () (no-such-colour 1)))))))

(test hostile.a-name-refused-is-not-known
  (ignore-errors (eval '(rpl:def-interp-proc refused-plan (a a) 1)))
  (ignore-errors (eval '(rpl:def-interp-proc (setf refused-plan) (a) a)))
  (is (null (remove-if-not (lambda (name)
                             (or (consp name) (eq name 'refused-plan)))
                           (ars-magna.rpl.tasks::declared-names)))))

;;; Lambda lists.

(defparameter *no-lambda-lists*
  '(((a . b) "not a proper list") ((a a) "a occurs twice") ((nil) "nil is a constant")
    ((&rest) "after &rest") (((a b)) "lambda list") ((:a) ":a is a constant")
    ((t) "t is a constant") ((pi) "pi is a constant") ((a &optional (a 1)) "a occurs twice")
    ((&key &optional a) "lambda list") ((5) "5 is no symbol"))
  "What no plan can have as parameters, and what is said of it.")

(test hostile.lambda-lists
  (loop for (parameters text) in *no-lambda-lists*
        do (dolist (form `((rpl:def-interp-proc hostile ,parameters (rpl:wait-time 1))
                           (rpl:interp-lambda ,parameters (rpl:wait-time 1))
                           (rpl:make-policy ,parameters (:init t))
                           (rpl:define-policy hostile ,parameters (:check nil))
                           (rpl:interp-lambda ()
                             (flet ((local ,parameters (rpl:wait-time 1))) (local 1)))
                           (rpl:interp-lambda ()
                             (rpl:wait-time 1)
                             (labels ((local ,parameters 1)) (local 1)))))
             (is (refused-saying-p text form) "~S: ~A" form (refused-text form)))))

(test hostile.lambda-lists-are-refused-once-where-they-stand
  (let ((said (said-compiling
               (format nil "~%(def-interp-proc hostile~%  (a a)~%  (wait-time 1))"))))
    (is (= 1 (length said)) "~S" said)
    (is (search "def-interp-proc hostile" (cdr (first said))))
    (is (search "line 3" (cdr (first said))) "~S" said)
    (is (search "a occurs twice" (cdr (first said))))))

(test hostile.goals
  (refused-each "t is a constant"
    (rpl:def-goal (rpl:achieve (on ?a ?t)) (rpl:wait-time 1))))

(test hostile.lambda-lists-that-are-some
  (is (equal '(1 2 (3) 4)
             (plan-value
               (flet ((local (a - integer &optional (b 2 b-p) &rest c)
                        (rpl:wait-time 1) (list a (and b-p b) c)))
                 (append (local 1 2 3) '(4)))))))

;;; Bindings.

(test hostile.bindings
  (refused-each "(variable value)"
    (rpl:interp-lambda () (let ((x 1 2)) (rpl:wait-time 1) x))
    (rpl:interp-lambda () (let ((a 1) . 5) (rpl:wait-time 1) a))
    (rpl:interp-lambda () (let* 5 (rpl:wait-time 1)))
    (rpl:interp-lambda () (rpl:wait-time 1) (let ((x 1 2)) x))))

(test hostile.constants-are-no-variables
  (refused-each "is a constant"
    (rpl:interp-lambda () (let ((t 0)) (rpl:wait-time 1) t))
    (rpl:interp-lambda () (rpl:wait-time 1) (let ((pi 0)) pi))
    (rpl:interp-lambda () (let* (nil) (rpl:wait-time 1)))
    (rpl:interp-lambda () (dolist (t '(1)) (rpl:wait-time 1)))
    (rpl:interp-lambda () (dotimes (pi 2) (rpl:wait-time 1)))
    (rpl:interp-lambda () (rpl:wait-time 1) (dotimes (:i 2) (list 1)))
    (rpl:interp-lambda () (rpl:par-loop (nil '(1)) (rpl:wait-time 1)))
    (rpl:interp-lambda () (rpl:try-each-in-order (:x '(1)) (rpl:wait-time 1)))
    (rpl:interp-lambda () (multiple-value-bind (a t) (values 1 2) (rpl:wait-time 1) a))
    (rpl:interp-lambda () (rpl:handle-failure ((:late (t) 1)) (rpl:wait-time 1)))
    (rpl:interp-lambda () (rpl:handle-failure ((:late (:e) 1)) (rpl:wait-time 1))))
  (is (refused-text '(rpl:interp-lambda () (:tag :walk (rpl:wait-time 1))))))

;;; Clauses of handlers.

(test hostile.clauses-that-match-nothing
  (refused-each "matches no failure"
    (rpl:interp-lambda () (rpl:handle-failure (((:lost :late) () 1)) (rpl:wait-time 1)))
    (rpl:interp-lambda () (rpl:handle-failure ((5 () 1)) (rpl:wait-time 1)))
    (rpl:interp-lambda () (rpl:handle-failure ((1.5 () 1)) (rpl:wait-time 1)))
    (rpl:interp-lambda () (rpl:handle-failure ((nil () 1)) (rpl:wait-time 1)))
    (rpl:interp-lambda () (rpl:handle-failure (((or) () 1)) (rpl:wait-time 1)))
    (rpl:interp-lambda () (rpl:handle-failure (((or :late 3) (e) e)) (rpl:wait-time 1))))
  (refused-each "one variable or none"
    (rpl:interp-lambda () (rpl:handle-failure ((t (a b) 1)) (rpl:wait-time 1)))
    (rpl:interp-lambda () (rpl:handle-failure ((t () . 1)) (rpl:wait-time 1))))
  (refused-each "a list of clauses: write ((t))"
    (rpl:interp-lambda () (rpl:handle-failure (t) (rpl:wait-time 1))))
  (is (eq :there (plan-value
                   (rpl:handle-failure (((or :lost (or :late simple-error)) (e) e
                                         (return :there)))
                     (rpl:fail :class :late))))))

;;; Policies.

(test hostile.policies-take-their-own-parameters
  (base:with-own-definitions ()
    (eval '(rpl:define-policy hostile-tidy (papers most) (:check (< most papers))))
    (let ((said (princ-to-string
                 (rpl:lisp-failure-condition
                  (plan-failure-of (rpl:with-named-policy 'hostile-tidy (5) (rpl:wait-time 1)))))))
      (is (search "hostile-tidy: argument list is (5); give (papers most), not 1 argument" said)
          "~A" said)))
  (refused-each ":init, :check, :recover or :clean-up"
    (rpl:make-policy () (:init t) "doc")
    (rpl:make-policy () "doc" (:init t))))

;;; Arguments.

(test hostile.units
  (refused-each ":unit :ticks or :unit :seconds, not"
    (rpl:interp-lambda () (rpl:wait-time 3 :unit :minutes))
    (rpl:interp-lambda () (rpl:wait-time 3 :unit 5))
    (rpl:interp-lambda () (rpl:with-deadline (3 :unit :minutes) (rpl:wait-time 1))))
  (loop for (plan text)
          in (list (list (rpl:interp-lambda (unit) (rpl:wait-time 3 :unit unit))
                         "wait-time: unit is :MINUTES; give :ticks or :seconds")
                   (list (rpl:interp-lambda (unit) (rpl:with-deadline (3 :unit unit)
                                                     (rpl:wait-time 1)))
                         "with-deadline: unit is :MINUTES; give :ticks or :seconds"))
        for failure = (rpl:run-plan-alone plan :arguments '(:minutes))
        for said = (princ-to-string (rpl:lisp-failure-condition failure))
        do (is (search text said) "~A" said)))

(test hostile.arguments-are-checked-at-once
  (signals base:wrong-argument
    (rpl:run-plan-alone (rpl:interp-lambda () (rpl:wait-time 1)) :limit :ten))
  (signals base:wrong-argument
    (rpl:run-plan-alone (rpl:interp-lambda () (rpl:wait-time 1)) :arguments 5))
  (let ((fluent (fluent 1)))
    (signals base:wrong-argument (rpl:fl-value-changed fluent :test 5))
    (signals base:wrong-argument (rpl:fl-value-changed fluent :test 'when))
    (signals base:wrong-argument (rpl:fl-value-changed fluent :key 'no-such-function))
    (is (rpl:fluent-p (rpl:fl-value-changed fluent :test 'equal :key #'list)))))

(test hostile.task-variables-and-orders
  (refused-each "name value [string]" (rpl:define-task-variable *hostile-tv* 1 :x))
  (refused-each "tags in :order that are in scope"
    (rpl:interp-lambda ()
      (rpl:partial-order ((:tag a (rpl:wait-time 1)) (:tag b (rpl:wait-time 1))) (:order a "b")))
    (rpl:interp-lambda ()
      (rpl:partial-order ((:tag a (rpl:wait-time 1)) (:tag b (rpl:wait-time 1))) (:order t b)))))

;;; Code replaced.

(rpl:def-interp-proc hostile-patrol ()
  (:tag step (rpl:wait-time 3))
  (rpl:plan-time))

(test hostile.replaced-code
  (dolist (code (list '(1 2) (let ((deep 'x)) (dotimes (i 100000 deep) (setf deep (list deep))))))
    (signals base:malformed-definition (rpl:replace-task-code '(hostile-patrol step) code))
    (signals base:malformed-definition
      (rpl:replace-task-code '(hostile-patrol step) code :compile t)))
  (is (= 3 (plan-value (hostile-patrol)))))

(test hostile.a-path-leads-to-the-outermost
  (unwind-protect
       (progn
         (rpl:replace-task-code '(hostile-patrol step)
                                '(rpl:seq (:tag step (rpl:wait-time 2)) (rpl:wait-time 5)))
         (is (= 7 (plan-value (hostile-patrol))))
         (is (equal '(rpl:wait-time 2) (rpl:task-code '(hostile-patrol step step)))))
    (rpl:restore-task-code '(hostile-patrol step)))
  (is (= 3 (plan-value (hostile-patrol)))))

;;; Sequences.

(test hostile.sequences-end
  (let ((circle (list 1 2)))
    (setf (cddr circle) circle)
    (dolist (sequence (list '(1 . 2) circle 5))
      (loop for (name plan)
              in (list (list "try-each-in-order"
                             (rpl:interp-lambda (list)
                               (rpl:try-each-in-order (x list) (rpl:wait-time 1) (rpl:fail x))))
                       (list "par-loop"
                             (rpl:interp-lambda (list)
                               (rpl:par-loop (x list) (rpl:wait-time 1) (list x))))
                       (list "dolist"
                             (rpl:interp-lambda (list)
                               (dolist (x list) (rpl:wait-time 1) (list x)))))
            for result = (rpl:run-plan-alone plan :arguments (list sequence) :limit 100)
            do (is (typep result 'rpl:lisp-failure) "~A: ~S" name result)
               (is (search (format nil "~A: " name)
                           (princ-to-string (rpl:lisp-failure-condition result)))))))
  (is (= 2 (plan-value (rpl:try-each-in-order (x #(1 2))
                         (rpl:wait-time 1) (if (= x 1) (rpl:fail)) x)))))
