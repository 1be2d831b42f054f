;;;; lisp-errors.lisp -- Common Lisp's own errors read the same on every version of SBCL.

(in-package :ars-magna.tests)

(in-suite base)

;;; Forms are strings, so that no compiler derives anything from them before the test.

(defparameter *texts-of-lisp-errors*
  '(("(+ nothing 1)" "The value NIL is not a number.")
    ("(float nothing)" "The value NIL is not a number.")
    ("(max nothing 1)" "The value NIL is not a number.")
    ("(ash 1 'far)" "The value FAR is not a number.")
    ("(evenp 1.5)" "The value 1.5 is not an integer.")
    ("(isqrt -1)" "The value -1 is not 0 or more.")
    ("(car 5)" "The value 5 is not a list.")
    ("(assoc 1 5)" "The value 5 is not a list.")
    ("(apply #'+ 5)" "The value 5 is not a list.")
    ("(apply #'+ '(1 far))" "The value FAR is not a number.")
    ("(setf (car nothing) 1)" "The value NIL is not a list with elements.")
    ("(length 5)" "The value 5 is not a list, vector or string.")
    ("(every #'oddp 5)" "The value 5 is not a list, vector or string.")
    ("(loop for x across nothing collect x)" "The value NIL is not an array.")
    ("(aref (vector 1 2 3) 5)" "The value 5 is not from 0 to 2.")
    ("(aref (vector 1 2 3) -1)" "The value -1 is not 0 or more.")
    ("(aref (vector 1 2 3) 'far)" "The value FAR is not a number.")
    ("(elt (vector 1 2 3) 5)" "The value 5 is not from 0 to 2.")
    ("(elt (vector) 0)" "The value 0 is not in range: the range is empty.")
    ("(funcall 5)" "The value 5 is not a function.")
    ("(random 0)" "The value 0 cannot be used here.")
    ("(write-to-string 1 :base 50)" "The value 50 is not from 2 to 36.")
    ("(getf 5 :where)" "The value 5 is not a list.")
    ("(string= 5 \"far\")" "The value 5 is not a string.")
    ("(robot:robot-angle 5)" "The value 5 is not of the type robot.")
    ("(no-such-function 1)" "The function NO-SUCH-FUNCTION is undefined.")
    ("(funcall 'no-such-function)" "The function NO-SUCH-FUNCTION is undefined.")
    ("(list no-such-variable)" "The variable NO-SUCH-VARIABLE has no value.")
    ("(/ 1 0)" "A number is divided by 0.")
    ("(/ 1d0 0)" "A number is divided by 0.")
    ("(mod 5 0)" "A number is divided by 0.")
    ("(exp 1000d0)" "A floating-point number is too large.")
    ("(subseq \"abc\" 5)" "The bounding indices 5 and NIL are bad for a sequence of length 3.")
    ("(ecase 5 (1 2) (2 3))" "5 fell through ECASE expression. Wanted one of (1 2)."))
  "Lists (form text).")

(defun call-typed (text)
  "Compile and call the form in TEXT, in which the variable NOTHING is NIL."
  (let* ((*package* (find-package :ars-magna.tests))
         (form `(lambda (nothing) (declare (ignorable nothing)) ,(read-from-string text))))
    (handler-bind ((warning #'muffle-warning))
      (let ((*error-output* (make-broadcast-stream)))
        (funcall (compile nil form) nil)))))

(defun error-text-of (text)
  "Return on one line what is told of the error in the form in TEXT."
  (handler-case (progn (call-typed text) "no error")
    (error (condition) (base:one-line (base:text-of-condition condition)))))

(test lisp-errors.read-the-same-on-every-sbcl
  (loop for (form text) in *texts-of-lisp-errors*
        do (is (string= text (error-text-of form)) "~A: ~A" form (error-text-of form))))

(test lisp-errors.do-not-depend-on-the-printer
  (let ((*print-pretty* t) (*print-right-margin* 10) (*package* (find-package :keyword)))
    (is (string= "The value FAR is not a number." (error-text-of "(ash 1 'far)")))
    (is (string= "The function NO-SUCH-FUNCTION is undefined."
                 (error-text-of "(no-such-function)")))))

(define-condition wrong-guess (type-error) ()
  (:report "Guess again."))

(test lisp-errors.of-programs-keep-their-texts
  (loop for (form text)
          in '(("(error \"no ~A\" 'way)" "no WAY")
               ("(error 'wrong-guess :datum 5 :expected-type 'string)" "Guess again.")
               ("(error 'simple-type-error :datum 5 :expected-type 'list :format-control \"mine\")"
                "mine")
               ("(check-type nothing number \"a weight\")"
                "The value of NOTHING is NIL, which is not a weight."))
        do (is (string= text (error-text-of form)) "~A: ~A" form (error-text-of form))))

;;; Where they are told.

(test lisp-errors.in-tables-are-the-same-on-every-sbcl
  (define-for-test (:robots ars-worlds:dot)
    (:vary (what 'type 'plan 'stack))
    (:run (ecase what
            (type (+ 1 (first (list what))))
            (plan (driver:run-plan (rpl:interp-lambda () (rpl:wait-time 1) (car 'far))))
            (stack (driver:run-plan (rpl:interp-lambda ()
                                      (rpl:wait-time 1)
                                      (labels ((dig (n) (1+ (dig n)))) (dig 1))))))))
  (let ((stack (format nil "The stack has overflowed: calls or lists are nested too deeply. Look ~
                            for a recursion that does not end.")))
    (is (equal (list "The value TYPE is not a number." "The value FAR is not a list." stack)
               (mapcar #'sixth (rows-of (experiment:run-experiment 'question :trials 1
                                                                             :stream nil)))))))

(test lisp-errors.in-messages-of-continuations-and-plans
  (with-rover ()
    (command:robot-turn rover 0.1 (lambda (err robot angle)
                                    (declare (ignore err angle))
                                    (+ 1 robot)))
    (run:run-ticks 10)
    (driver:run-plan (rpl:interp-lambda () (rpl:wait-time 1) (car (rpl:plan-time))))
    (let ((texts (mapcar #'base:message-text (base:take-messages))))
      (dolist (words '("is not a number." "Lisp error in a plan: The value 11 is not a list."))
        (is-true (find-if (lambda (text) (search words text)) texts) "~A: ~S" words texts)))))

;;; What cannot be printed takes nothing else along.

(define-condition half-said (error) ()
  (:report (lambda (condition stream)
             (declare (ignore condition))
             (format stream "The gripper said ")
             (error "no number ~D" 7))))

(test lisp-errors.that-cannot-be-printed-keep-their-authors-words
  (loop for (form . words)
          in '(("(error \"no ~A for ~D\" (ars-magna.tests::make-speechless) 3)"
                "no #<error printing a SPEECHLESS" "This cannot be printed." "> for 3"
                "simple-error, whose report fails")
               ("(error 'ars-magna.tests::half-said)" "The gripper said..."
                "half-said, whose report fails: no number 7")
               ("(error \"this is ~A, and that ~A\" 3)" "this is 3, and that"
                "simple-error, whose report fails"))
        do (is-true (apply #'has-words-p (error-text-of form) words) "~A" (error-text-of form))
           (is (not (search "{1" (error-text-of form))) "an address is another each time"))
  (is (string= "this an object that cannot be printed (speechless: This cannot be printed) here"
               (base:message-text
                (definitions::make-message :message (list "this " (make-speechless) " here")))))
  (is-true (tells-p "The gripper said... (half-said, whose report fails: no number 7)"
                    (rpl:interp-lambda () (error 'half-said)))))
