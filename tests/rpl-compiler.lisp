;;;; rpl-compiler.lisp -- plan text as a language: Lisp's forms, procedures, macros, errors.

(in-package :ars-magna.tests)
(in-suite rpl)

;;; Lisp's control forms with waiting parts.

(test compiler.let-and-friends-may-wait
  (is (equal '(1 2 3 3) (plan-value
                          (let ((a (progn (rpl:wait-time 1) (rpl:plan-time)))
                                (b (progn (rpl:wait-time 1) (rpl:plan-time))))
                            (let* ((c (progn (rpl:wait-time 1) (+ a b)))
                                   (d c))
                              (list a b c d))))))
  (is (equal '(2 (1)) (plan-value (let* ((x '(1)) (x (cons (progn (rpl:wait-time 1) 2) x)))
                                    (list (first x) (rest x)))))))

(test compiler.typed-bindings-are-nisps
  (is (equal '(1 nil) (plan-value (let ((a 1) - INTEGER (b nil) - (~ LIST))
                                    (rpl:wait-time 1)
                                    (list a b)))))
  (is (equal '(1 nil) (plan-value (let ((a 1) - INTEGER (b nil) - (~ LIST)) (list a b))))))

(test compiler.arguments-may-wait-and-keep-their-order
  (is (equal '(1 :x 2 (3)) (plan-value
                             (let ((n 0))
                               (flet ((next () (rpl:wait-time 1) (incf n)))
                                 (list (next) :x (next) (list (next)))))))))

(test compiler.conditionals-may-wait
  (is (equal '(:then 1) (plan-value (list (if (progn (rpl:wait-time 1) t) :then :else)
                                          (rpl:plan-time)))))
  (is (eq :two (plan-value (cond ((progn (rpl:wait-time 1) nil) :one)
                                 ((= 1 (rpl:plan-time)) (rpl:wait-time 1) :two)
                                 (t :three)))))
  (is (eq :value (plan-value (cond ((progn (rpl:wait-time 1) :value))))))
  (is (eq :b (plan-value (case (progn (rpl:wait-time 1) 2)
                           (1 :a) ((2 3) (rpl:wait-time 1) :b) (t :c)))))
  (is (eq :c (plan-value (case 7 (1 (rpl:wait-time 1) :a) (t :c)))))
  (is (eq :odd (plan-value (ecase 3 (2 :even) (3 (rpl:wait-time 1) :odd)))))
  (is (null (plan-value (and (progn (rpl:wait-time 1) nil) (rpl:fail)))))
  (is (eq :last (plan-value (and 1 (rpl:wait-for :x) :last))))
  (is (eq :first (plan-value (or nil (progn (rpl:wait-time 1) :first) (rpl:fail)))))
  (is (eq :done (plan-value (unless nil (rpl:wait-time 1) :done)))))

(test compiler.several-values
  (is (equal '(1 2 nil) (plan-value (multiple-value-bind (a b c)
                                        (progn (rpl:wait-time 1) (values 1 2))
                                      (list a b c)))))
  (is (equal '(1 2) (plan-value (multiple-value-bind (a b) (floor 5 (two-values))
                                  (rpl:wait-time 1)
                                  (list (- a 1) (+ b 1))))))
  (is (equal '(2 3) (plan-value (multiple-value-bind (a b) (two-values) (list a b)))))
  (is (equal '(2) (plan-value (list (two-values))))))

(rpl:def-interp-proc two-values ()
  (rpl:wait-time 1)
  (values 2 3))

(test compiler.assignments-may-wait
  (is (equal '(1 2 (0 3)) (plan-value
                            (let ((a 0) (b 0) (l (list 0 0)))
                              (setq a (progn (rpl:wait-time 1) (rpl:plan-time))
                                    b (progn (rpl:wait-time 1) (rpl:plan-time)))
                              (setf (second l) (progn (rpl:wait-time 1) (rpl:plan-time)))
                              (list a b l))))))

(test compiler.lisps-macros-are-seen-through
  (is (equal '(1 2) (plan-value (prog1 (list 1 2) (rpl:wait-time 1)))))
  (is (= 6 (plan-value (do ((i 0 (1+ i)) (sum 0 (+ sum i))) ((= i 4) sum) (rpl:wait-time 1)))))
  (is (equal '(1 (2)) (plan-value (destructuring-bind (a &rest b) '(1 2)
                                    (rpl:wait-time 1)
                                    (list a b)))))
  (is (equal '(1 nil) (plan-value (let ((a 1) - INTEGER (b nil) - (~ LIST)) (list a b))))))

(test compiler.local-functions-and-macros
  (is (equal '(2 4) (plan-value (flet ((twice (x) (* 2 x)))
                                  (rpl:wait-time 1)
                                  (mapcar #'twice '(1 2))))))
  (is (= 120 (plan-value (labels ((factorial (n) (if (= n 0) 1 (* n (factorial (1- n))))))
                           (rpl:wait-time 1)
                           (factorial 5)))))
  (is (equal '(:even 5) (plan-value
                          (labels ((evenly (n) (rpl:wait-time 1) (if (= n 0) :even (oddly (- n 1))))
                                   (oddly (n) (rpl:wait-time 1) (if (= n 0) :odd (evenly (- n 1)))))
                            (list (evenly 4) (rpl:plan-time))))))
  (is (equal '(3 7) (plan-value (let ((base 3))
                                  (flet ((wait-and (x &optional (y base))
                                           (rpl:wait-time 1)
                                           (+ x y)))
                                    (list (wait-and 0) (wait-and 3 4)))))))
  (is (= 3 (plan-value (macrolet ((pause (n) `(rpl:wait-time ,n)))
                         (pause 3)
                         (rpl:plan-time)))))
  (is (= 4 (plan-value (let ((cell (list 1)))
                         (symbol-macrolet ((place (first cell)))
                           (rpl:wait-time 1)
                           (setf place 4)
                           (first cell)))))))

(test compiler.leaves-are-lisp
  (is (equal '(1 4 9) (plan-value (rpl:wait-time 1)
                                  (loop for x in '(1 2 3) collect (* x x)))))
  (is (equal "12" (plan-value (rpl:wait-time 1)
                              (with-output-to-string (s) (princ 1 s) (princ 2 s)))))
  (is (eq :caught (plan-value (rpl:wait-time 1)
                              (handler-case (error "x") (error () :caught))))))

;;; Operators mean what plans mean by them.

(test compiler.conditions-read-fluents
  (let ((f (fluent nil)) (g (fluent 3)))
    (is (equal '(:no 1 t 4 nil :big)
               (plan-value
                 (list (if f :yes :no)
                       (cond (f 0) (g 1))
                       (if (not f) t nil)
                       (let ((n 0)) (loop until (> n g) (incf n)) n)
                       (when (and g f) t)
                       (if (or f (> (+ g 1) 3)) :big :small)))))
    (is (equal '(:three) (plan-value (case g (3 (list :three))))))
    (is (rpl:fluent-p (plan-value (not f))))
    (is (rpl:fluent-p (plan-value (null f))))
    (is (rpl:fluent-p (plan-value (let ((sum (+ g 1))) (rpl:wait-time 1) sum))))
    (is (= 4 (rpl:fluent-value (plan-value (+ g 1)))))))

(test compiler.ordinary-functions-get-the-fluent-itself
  (let ((f (fluent nil)))
    (is (eq f (plan-value (car (list f)))))))

(test compiler.what-lisps-macros-bring-along-stays-lisps
  (let ((f (fluent 1)))
    (is (eq :found (plan-value (case f (1 :found) (t :other)))))
    (is (equal (list f) (plan-value (let ((l '())) (pushnew f l) (pushnew f l) l))))))

;;; Procedures.

(rpl:def-interp-proc add-later (a &optional (b 10) &rest rest)
  "Return the arguments."
  (rpl:wait-time 1)
  (list a b rest))

(rpl:def-interp-proc named-later (a &key (b 10) (c (+ a b)))
  (rpl:wait-time 1)
  (list a b c))

(rpl:def-interp-proc typed-procedure (a - INTEGER b - (Lst INTEGER))
  (rpl:wait-time a)
  (return-from typed-procedure (list a b))
  :never)

(rpl:def-interp-proc calls-what-comes-later (n)
  (defined-later n))

(rpl:def-interp-proc defined-later (n)
  (rpl:wait-time n)
  (rpl:plan-time))

(test def-interp-proc.lambda-lists
  (is (equal '(1 10 nil) (plan-value (add-later 1))))
  (is (equal '(1 2 (3 4)) (plan-value (add-later 1 2 3 4))))
  (is (equal '(1 10 11) (plan-value (named-later 1))))
  (is (equal '(1 5 6) (plan-value (named-later 1 :b 5))))
  (is (equal '(2 (3)) (plan-value (typed-procedure 2 '(3)))))
  (is (string= "Return the arguments." (documentation 'add-later 'function)))
  (is (typep (rpl:lisp-failure-condition (plan-failure-of (rpl:call-plan 'typed-procedure 1)))
             'program-error)))

(test def-interp-proc.in-any-order
  (is (= 3 (plan-value (calls-what-comes-later 3)))))

(rpl:def-interp-proc changing () 0)

(test def-interp-proc.takes-effect-in-running-plans
  (flet ((define (answer)
           (handler-bind ((warning #'muffle-warning))
             (eval `(rpl:def-interp-proc changing () (rpl:wait-time 1) ,answer)))))
    (define 1)
    (is (equal '(1 1 2) (plan-value
                          (let ((answers '()))
                            (dotimes (i 3)
                              (push (changing) answers)
                              (when (= i 1) (define 2)))
                            (reverse answers)))))
    (handler-bind ((warning #'muffle-warning)) ; it is a plan's so far
      (eval '(defun changing () 3)))
    (is (equal '(3) (plan-value (list (changing)))))
    (define 4)
    (is (equal '(4) (plan-value (list (changing)))))))

(test def-interp-proc.a-lisp-function-unknown-before-is-called
  (let ((name (gensym "UNKNOWN")))
    (let ((plan (eval `(rpl:interp-lambda () (list (,name 2) (rpl:plan-time))))))
      (setf (fdefinition name) (lambda (x) (* 21 x)))
      (is (equal '(42 0) (rpl:run-plan-alone plan))))))

(test def-interp-proc.lisp-code-that-calls-a-plan-is-told
  (signals base:misuse (add-later 1))
  (is (typep (rpl:lisp-failure-condition
              (plan-failure-of (funcall 'add-later 1)))
             'base:misuse)))

(test interp-lambda.sees-the-variables-around-it
  (is (equal '(3 4 5)
             (plan-value (let ((x 3))
                           (rpl:wait-time 1)
                           (let ((plan (rpl:interp-lambda (y)
                                         (rpl:wait-time y)
                                         (list x y (rpl:plan-time)))))
                             (rpl:call-plan plan 4)))))))

(test make-plan.from-a-form-made-by-a-program
  (dolist (compile '(nil t))
    (let ((plan (rpl:make-plan `(let ((ticks 1))
                                  ,@(loop repeat 3 collect '(rpl:wait-time ticks))
                                  (rpl:plan-time))
                               :compile compile)))
      (is (= 3 (rpl:run-plan-alone plan)))
      (is (= 3 (plan-value (rpl:call-plan plan)))))))

;;; Macros.

(rpl:def-interp-macro (during ?what . ?body)
  "Run BODY while WHAT runs."
  `(rpl:pursue (seq-of ,@body) ,what))

(rpl:def-interp-macro (seq-of . ?forms) `(rpl:seq ,@forms))

(rpl:def-interp-macro (repeat ?n times . ?body)
  `(rpl:n-times ,n (when (not nil) ,@body)))

(eval `(rpl:def-interp-macro (with-twice (,(nisp:make-matchvar 'value) ,(nisp:make-matchvar nil))
                              . ,(nisp:make-matchvar 'body))
         (list* 'let (list (list 'twice (list '* 2 value))) body)))

(test def-interp-macro.patterns
  (is (eq :won (plan-value (during (rpl:wait-time 9) (rpl:wait-time 1) :won))))
  (is (= 6 (plan-value (repeat 3 times (rpl:wait-time 2)) (rpl:plan-time))))
  (is (= 8 (plan-value (with-twice (4 anything) (rpl:wait-time 1) twice))))
  (is (string= "Run BODY while WHAT runs." (documentation 'during 'function)))
  (signals base:malformed-definition (macroexpand-1 '(repeat 3 turns (rpl:wait-time 2)))))

;;; Errors when a plan is defined.

(defmacro refuses (condition &body body)
  `(signals ,condition (macroexpand-1 '(rpl:interp-lambda () ,@body))))

(test compiler.waiting-inside-lisp-forms-is-refused
  (dolist (form '((unwind-protect (rpl:wait-for f) (clean))
                  (handler-case (rpl:wait-time 1) (error () 1))
                  (ignore-errors (rpl:par 1 2))
                  (catch 'tag (rpl:wait-time 1))
                  (mapcar (lambda (x) (rpl:wait-for x)) list)
                  (mapcar #'(lambda (x) (add-later x)) list)
                  (loop for x in list do (rpl:wait-for x))
                  (let ((*print-base* 2)) (rpl:wait-time 1))
                  (let ((x 2)) (declare (special x)) (rpl:wait-time 1))
                  (progv '(x) '(1) (rpl:wait-time 1))
                  (multiple-value-call #'list (rpl:wait-time 1))
                  (with-open-file (stream "x") (rpl:wait-time 1))
                  (flet ((f () (rpl:wait-time 1))) (mapc #'f list))
                  (block b (rpl:wait-time 1) (mapc (lambda (x) (return-from b x)) list))))
    (handler-case (progn (macroexpand-1 `(rpl:interp-lambda () ,form))
                         (fail "~S was accepted" form))
      (rpl:misplaced-suspension (trouble)
        (is (consp (rpl:misplaced-container trouble)))
        (is (stringp (rpl:misplaced-advice trouble)))
        (is (search (string-downcase (first (rpl:misplaced-container trouble)))
                    (princ-to-string trouble)))))))

(test compiler.the-advice-fits-the-form
  (handler-case (macroexpand-1 '(rpl:interp-lambda ()
                                 (unwind-protect (rpl:wait-for f) (clean))))
    (rpl:misplaced-suspension (trouble)
      (is (equal '(rpl:wait-for f) (rpl:misplaced-form trouble)))
      (is (search "evap-protect" (rpl:misplaced-advice trouble))))))

(test compiler.malformed-constructs-are-refused
  (refuses base:malformed-definition (rpl:wait-for))
  (refuses base:malformed-definition (rpl:wait-for f :until 3))
  (refuses base:malformed-definition (if a (rpl:wait-time 1) b c))
  (refuses base:malformed-definition (rpl:retry))
  (refuses base:malformed-definition (rpl:handle-failure (lost) (rpl:wait-time 1)))
  (refuses base:malformed-definition
    (rpl:partial-order ((:tag a 1) (:tag b 2)) (:order a b) (:order b a)))
  (refuses base:malformed-definition (rpl:partial-order ((:tag a 1)) (:order a c)))
  (refuses base:malformed-definition (dolist (*print-base* list) (rpl:wait-time 1)))
  (refuses base:malformed-definition (rpl:with-tags (:tag *print-base* (rpl:wait-time 1)))))

(test compiler.a-construct-outside-of-plans-is-refused
  (signals base:misuse (macroexpand '(rpl:par 1 2)))
  (signals base:misuse (macroexpand '(rpl:wait-for f))))

(test compiler.names-of-ones-own-are-ones-own
  (is (= 3 (plan-value (flet ((par (a b) (+ a b)))
                         (rpl:wait-time 1)
                         (par 1 2))))))
