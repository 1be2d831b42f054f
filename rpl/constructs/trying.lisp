;;;; trying.lisp -- one after the other until one succeeds.

(in-package :ars-magna.rpl.constructs)

(defstruct (attempt-record (:constructor make-attempt-record (order)) (:copier nil))
  "What is still to be tried, in ORDER: conses of a node and its environment; and the FAILURES so
far, last first."
  (order '() :type list)
  (failures '() :type list))

(defun order-as-written (attempts environment dice)
  (declare (ignore dice))
  (loop for attempt across attempts collect (cons attempt environment)))

(defun order-by-chance (attempts environment dice)
  "Do as ORDER-AS-WRITTEN, in an order that DICE choose; as written if there are none."
  (loop with left = (order-as-written attempts environment dice)
        while left
        collect (let ((chosen (if dice (roll-element left dice) (first left))))
                  (setf left (remove chosen left :test #'eq))
                  chosen)))

(defun all-failed (failures task frame)
  "Return the failure of TASK at FRAME that stands for FAILURES, last first."
  (failure-of (make-condition 'composite-failure :failures (reverse failures)) task frame))

(defun give-up (record task frame)
  (unwind task (frame-up frame) (all-failed (attempt-record-failures record) task frame)))

(defun attempts-code (attempts scope)
  `(vector ,@(loop for attempt in attempts collect (plan-code attempt scope))))

(define-construct try-in-order (&body attempts)
  "Run ATTEMPTS in a plan one after the other until one succeeds; return its value. If all fail,
fail with a composite failure."
  (:parts (attempts simple-vector (attempts-code attempts scope))
          (order function '(function order-as-written)))
  (:steps
   (begin
    (setf memory (make-attempt-record
                  (funcall order attempts environment (runner-dice (task-runner task)))))
    (at-once between-attempts))
   (trying (values (frame-up frame) value))
   (between-attempts
    (destructuring-bind (&optional attempt . inner) (pop (attempt-record-order memory))
      (cond (attempt
             (next trying)
             (enter (the node attempt) inner frame))
            (t (give-up memory task frame))))))
  (:unwind
   (when (and (in-state-p trying) (typep signal 'plan-failure))
     (push signal (attempt-record-failures memory))
     (next between-attempts)
     (values t frame nil))))

(define-construct try-one (&body attempts)
  "Do as TRY-IN-ORDER, in an order that the plan runner chooses: at random if it was given dice,
otherwise as written."
  (:like try-in-order)
  (:parts (attempts simple-vector (attempts-code attempts scope))
          (order function '(function order-by-chance))))

;;; For each element.

(define-construct try-each-in-order ((variable sequence) &body body)
  "Run BODY in a plan with VARIABLE bound to each element of SEQUENCE in turn until it succeeds;
return its value. If it never does, fail with a composite failure."
  (:like try-in-order)
  (:arguments sequence)
  (:parts (attempts simple-vector `(vector ,(each-body-code variable body scope)))
          (order function
                 `(let ((items ,(value-lambda sequence scope)))
                    (lambda (attempts environment dice)
                      (declare (ignore dice))
                      (loop for item in (item-list 'try-each-in-order (funcall items environment))
                            collect (cons (svref attempts 0) (vector environment item)))))))
  (:code (block-code nil form scope #'build)))
