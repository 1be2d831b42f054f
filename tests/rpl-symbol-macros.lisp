;;;; rpl-symbol-macros.lisp -- symbol macros in plans stand for plan text; the library iterate.

(in-package :ars-magna.tests)
(in-suite rpl)

(rpl:def-interp-proc symbol-later ()
  (rpl:wait-time 1)
  :later)

(define-symbol-macro everywhere-later (rpl:seq (rpl:wait-time 1) :everywhere))

(test symbol-macros.that-wait-wait
  (is (equal '(:yes 1) (plan-value (symbol-macrolet ((next (rpl:seq (rpl:wait-time 1) :yes)))
                                     (list next (rpl:plan-time))))))
  (is (eq :later (plan-value (symbol-macrolet ((next (symbol-later))) next))))
  (is (equal '(:later 2) (plan-value (symbol-macrolet ((first (symbol-later)) (next first))
                                       next
                                       (let ((x next)) (list x (rpl:plan-time)))))))
  (is (equal '(:everywhere :everywhere 2)
             (plan-value (list everywhere-later everywhere-later (rpl:plan-time))))))

(test symbol-macros.leave-blocks-and-go-to-tags
  (is (= 3 (plan-value (block nil
                         (tagbody
                            (symbol-macrolet ((next (go end)))
                              (rpl:wait-time 1)
                              next
                              (return 4))
                          end
                            (return 3))))))
  (is (= 5 (plan-value (block nil
                         (rpl:par (symbol-macrolet ((out (return 5))) (if (rpl:wait-time 1) 1 out))
                                  (rpl:wait-time 9)))))))

(test symbol-macros.are-arguments
  (is (= 3 (plan-value (symbol-macrolet ((span (rpl:seq (rpl:wait-time 1) 2)))
                         (rpl:wait-time span)
                         (rpl:plan-time)))))
  (is (equal '(:in 2) (plan-value
                        (let ((valve (rpl:make-valve 'hand)))
                          (symbol-macrolet ((hand (rpl:seq (rpl:wait-time 1) valve)))
                            (rpl:with-valve (hand)
                              (if hand (list :in (rpl:plan-time))))))))))

(test symbol-macros.mean-what-plans-mean
  (let ((f (fluent t)) (g (fluent)))
    (is (equal '(2 :yes)
               (plan-value
                 (symbol-macrolet ((ready (and f g)))
                   (rpl:par (rpl:wait-for ready)
                            (rpl:seq (rpl:wait-time 2) (rpl:set-value g t)))
                   (list (rpl:plan-time) (if ready :yes :no))))))))

(test symbol-macros.are-hidden-by-variables
  (is (equal '(7 (7) 7 (7))
             (plan-value
               (symbol-macrolet ((next (rpl:seq (rpl:wait-time 1) 2)))
                 (append (let ((next 7) (everywhere-later 7))
                           (rpl:wait-time 1)
                           (list next (list everywhere-later)))
                         (let ((everywhere-later 7)) (list everywhere-later (list 7)))))))))

;; What a pattern matcher makes of (match object ((list x y) ...) ...): to fail is to go on.
(defmacro match-pair (object pair-form otherwise)
  "If OBJECT is a list of two with the first not greater, return the value of PAIR-FORM with X and Y
bound to the two, else the value of OTHERWISE."
  (let ((value (gensym)) (next (gensym)))
    `(let ((,value ,object))
       (block match
         (tagbody
            (symbol-macrolet ((fail-here (go ,next)))
              (if (and (consp ,value) (= 2 (length ,value)))
                  (let ((x (first ,value)) (y (second ,value)))
                    (if (> x y) fail-here)
                    (return-from match ,pair-form))
                  fail-here))
            ,next
            (return-from match ,otherwise))))))

(test symbol-macros.let-pattern-matchers-match
  (is (equal '(3 :other :none 5)
             (plan-value
               (rpl:wait-time 1)
               (flet ((sum (object)
                        (match-pair object
                            (rpl:seq (rpl:wait-time (- y x)) (+ x y))
                          (if (consp object) :other :none))))
                 (list (sum '(1 2)) (sum '(2 1)) (sum 3) (+ 3 (rpl:plan-time))))))))

;;; Iterate.

(defun call-with-iterate (function)
  "Call FUNCTION with a macro with the name and package of ITERATE's ITER. Like that, it expands all
forms in its body."
  (let* ((there (find-package "ITERATE"))
         (package (or there (make-package "ITERATE" :use '())))
         (symbol (intern "ITER" package)))
    (unless there
      (setf (macro-function symbol)
            (lambda (form environment)
              `(progn ,@(mapcar (lambda (form) (macroexpand form environment)) (rest form))))))
    (unwind-protect (funcall function symbol)
      (unless there (delete-package package)))))

(test iterate.a-wait-inside-gets-the-advice-for-loop
  (call-with-iterate
   (lambda (iter)
     (handler-case (progn (rpl:make-plan `(rpl:seq (rpl:wait-time 1)
                                                   (,iter (progn x in (list 1 2))
                                                          (if x (rpl:wait-time x)))))
                          (fail "it was accepted"))
       (rpl:misplaced-suspension (trouble)
         (is (equal '(rpl:wait-time x) (rpl:misplaced-form trouble)))
         (is (eq iter (first (rpl:misplaced-container trouble))))
         (is (search "(loop UNTIL test ...)" (rpl:misplaced-advice trouble)))))
     (is (equal '(2 1) (plan-value-of `(list (,iter '(rpl:wait-time 1) (+ 1 1)) 1)))))))

(defun plan-value-of (form)
  "Return the value of FORM as a plan."
  (values (rpl:run-plan-alone (rpl:make-plan form))))

(defmacro iter (&body forms)
  "A macro of a user's that is called as one of iterate's is."
  `(progn ,@forms))

(test iterate.a-users-macro-of-that-name-is-a-plans
  (is (= 1 (plan-value (iter (rpl:wait-time 1) (rpl:plan-time))))))

;;; Macros that expand what is in them.

(defmacro expanded (form &environment environment)
  "Expand to what FORM expands to."
  (macroexpand form environment))

(defmacro expanded-once (form &environment environment)
  "Expand to what FORM expands to at first."
  (macroexpand-1 form environment))

(test macroexpand.leaves-constructs-to-the-plan
  (is (= 4 (plan-value (expanded (rpl:wait-time 4)) (rpl:plan-time))))
  (is (= 4 (plan-value (expanded-once (rpl:wait-time 4)) (rpl:plan-time))))
  (is (equal '(:in 5) (plan-value (list (expanded (rpl:seq (rpl:wait-time 5) :in))
                                        (rpl:plan-time)))))
  (is (= 2 (plan-value (expanded (expanded-once (rpl:par (rpl:wait-time 1) (rpl:wait-time 2))))
                       (rpl:plan-time)))))

(test macroexpand.of-a-construct-in-lisp-code-names-the-construct
  (flet ((message (form)
           (handler-case (progn (rpl:make-plan `(list ,form)) "")
             (error (condition) (princ-to-string condition)))))
    (dolist (operator '(expanded expanded-once))
      (let ((text (message `(lambda () (,operator (rpl:wait-time 4))))))
        (is (search "wait-time 4" text :test #'char-equal) "~A" text)
        (is (not (search "signal-misplaced-construct" text :test #'char-equal)) "~A" text)
        (is (not (search "plan-only-form" text :test #'char-equal)) "~A" text)))))

(defmacro meaning-of-y (&environment environment)
  "Expand to what Y expands to, quoted."
  `',(macroexpand-1 'y environment))

(defmacro wait-for-y (&environment environment)
  "Expand to a wait if Y is a symbol macro, else to Y."
  (if (eq 'y (macroexpand-1 'y environment)) 'y '(rpl:wait-time 1)))

(test symbol-macros.that-variables-shadow-are-none-for-macros
  (is (eq 'y (plan-value (symbol-macrolet ((y (+ 1 2)))
                           (let ((y 1)) (declare (ignorable y)) (meaning-of-y))))))
  (is (equal '(y (+ 1 2) 3)
             (plan-value (symbol-macrolet ((y (+ 1 2)))
                           (list (funcall (lambda (y) (declare (ignorable y)) (meaning-of-y)) 1)
                                 (meaning-of-y)
                                 (funcall (lambda (y)
                                            (declare (ignorable y))
                                            (symbol-macrolet ((y 3)) (meaning-of-y)))
                                          1))))))
  (is (equal '(7 0) (plan-value (symbol-macrolet ((y (+ 1 2)))
                                  (list (funcall (lambda (y) (wait-for-y)) 7)
                                        (rpl:plan-time)))))))
