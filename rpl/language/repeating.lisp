;;;; repeating.lisp -- loop, n-times, dolist, dotimes.

(in-package :ars-magna.rpl.language)

;;; After each turn others that are ready get theirs, so that a loop that never waits cannot keep
;;; them out. All of these can be left by RETURN.

(define-node turns ((until function) (count function) (body node))
  "BODY again and again: while UNTIL of the environment is false, at most COUNT times, which is a
number or NIL for as many as it takes. COUNTER is 0 before the first turn, 1 while the body runs and
2 between turns; DATA is how many are left."
  :step step-turns)

(defun turn-count (count)
  "Return COUNT, of turns, a number or a fluent that holds one. Signals WRONG-ARGUMENT."
  (let ((count (fluent-value count)))
    (check-argument n-times count (quantity-p count)
                    "a number of turns, from -1e15 to 1e15, first of all: (n-times count form...)")
    count))

(defun step-turns (node task frame value)
  (declare #.*hot* (ignore value) (type turns node) (type task task) (type frame frame))
  (let ((environment (frame-environment frame)))
    (cond ((and (= 1 (frame-counter frame)) (not (alone-p task)))
           (setf (frame-counter frame) 2)
           (make-ready task)
           +parked+)
          (t (when (= 0 (frame-counter frame))
               (setf (frame-data frame) (funcall (turns-count node) environment)))
             (setf (frame-counter frame) 1)
             (let ((left (frame-data frame)))
               (cond ((or (and left (<= (the real left) 0))
                          (funcall (turns-until node) environment))
                      (values (frame-up frame) nil))
                     (t (when left (setf (frame-data frame) (1- (the real left))))
                        (enter (turns-body node) environment frame))))))))

(defun turns-test (forms)
  "Return the condition that FORMS, after LOOP, end on, and the body. NIL is never true."
  (cond ((keyword-test forms "UNTIL") (values (second forms) (cddr forms)))
        ((keyword-test forms "WHILE") (values (note-own-text `(not ,(second forms))) (cddr forms)))
        (t (values nil forms))))

(defun turns-code (form count forms scope)
  "Return code for FORMS, after LOOP or N-TIMES, at most COUNT times (NIL: for ever)."
  (multiple-value-bind (test body) (turns-test forms)
    (if (suspends-p test scope)
        (turns-code form count
                    (list* (note-own-text `(when ,test (return-from nil nil))) body) scope)
        (block-code nil form scope
                    (lambda (scope)
                      `(make-turns :form ',form
                                   :until ,(test-lambda test scope)
                                   :count ,(value-lambda count scope)
                                   :body ,(body-code body (single-scope scope))))))))

(define-plan-form "LOOP" :may (&rest forms) (form scope)
  (turns-code form nil forms scope))

(addition n-times)
(defmacro n-times (count &body body)
  "Run BODY in a plan COUNT times, one turn after the other. BODY may start with UNTIL or WHILE and
a test made before each turn. COUNT is a number up to 1e15. Return NIL."
  (misplaced 'n-times `(,count ,@body)))

(define-plan-form "N-TIMES" :must (count &rest forms) (form scope)
  (if (suspends-p count scope)
      (with-gensyms (value)
        (plan-code (note-own-text `(let ((,value ,count)) (n-times ,value ,@forms))) scope))
      (turns-code form (note-own-text `(turn-count ,count)) forms scope)))

;;; Over the elements of a list, and numbers.

(define-node each ((items function) (body node))
  "BODY for each element of the list that ITEMS of the environment returns, in an environment of
that one. DATA is the elements left; COUNTER is as for TURNS."
  :step step-each)

(defun step-each (node task frame value)
  (declare (ignore value))
  (let ((environment (frame-environment frame)))
    (cond ((and (= 1 (frame-counter frame)) (frame-data frame) (not (alone-p task)))
           (setf (frame-counter frame) 2)
           (make-ready task)
           +parked+)
          (t (when (= 0 (frame-counter frame))
               (setf (frame-data frame) (funcall (each-items node) environment)))
             (setf (frame-counter frame) 1)
             (if (endp (frame-data frame))
                 (values (frame-up frame) nil)
                 (enter (each-body node) (vector environment (pop (frame-data frame))) frame))))))

(define-node each-number ((count function) (body node))
  "BODY for each number below what COUNT of the environment returns. DATA is the count, and COUNTER
the number of turns begun; it is negative between turns."
  :step step-each-number)

(defun step-each-number (node task frame value)
  (declare (ignore value))
  (let* ((environment (frame-environment frame))
         (begun (abs (frame-counter frame)))
         (count (or (frame-data frame)
                    (setf (frame-data frame) (funcall (each-number-count node) environment)))))
    (cond ((>= begun count) (values (frame-up frame) nil))
          ((and (plusp (frame-counter frame)) (not (alone-p task)))
           (setf (frame-counter frame) (- begun))
           (make-ready task)
           +parked+)
          (t (setf (frame-counter frame) (1+ begun))
             (enter (each-number-body node) (vector environment begun) frame)))))

(defun each-code (maker form variable source result body scope)
  "Return code for FORM: BODY with VARIABLE bound to each of what SOURCE, given to MAKER, says."
  (if (suspends-p source scope)
      (with-gensyms (value)
        (plan-code (note-own-text `(let ((,value ,source))
                                     (,(first form) (,variable ,value ,@result) ,@body)))
                   scope))
      (let ((single (single-scope scope)))
        (block-code nil form scope
                    (lambda (scope)
                      (let ((turns `(,@maker ,(value-lambda source single)
                                     :form ',form
                                     :body ,(binding-body-code
                                             body (variable-scope (single-scope scope)
                                                                  (list variable))))))
                        (if result
                            `(make-steps :form ',form
                                         :parts (vector ,turns ,(plan-code (first result) scope)))
                            turns)))))))

(define-plan-form "DOLIST" nil ((variable source &rest result) &rest body) (form scope)
  (each-code '(make-each :items) form variable source result body scope))

(define-plan-form "DOTIMES" nil ((variable source &rest result) &rest body) (form scope)
  (each-code '(make-each-number :count) form variable source result body scope))
