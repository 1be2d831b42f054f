;;;; trying.lisp -- one after the other until one succeeds; and what is done however it ends.

(in-package :ars-magna.rpl.constructs)

;;; COUNTER is how many attempts have begun, DATA the failures of those that failed, last first.

(define-node attempts ((parts simple-vector) (shuffled t))
  "The first of PARTS to succeed, tried in order, or in any order if SHUFFLED."
  :step step-attempts :unwind unwind-attempts)

(defstruct (attempt-record (:constructor make-attempt-record (order)) (:copier nil))
  "The ORDER, a list, of what is still to be tried, and the FAILURES so far, last first."
  (order '() :type list)
  (failures '() :type list))

(defun shuffled-order (order dice)
  "Return ORDER, a list, in another order."
  (loop while order
        collect (let ((chosen (roll-element order dice)))
                  (setf order (remove chosen order))
                  chosen)))

(defun attempt-order (node task)
  (let ((order (loop for i below (length (attempts-parts node)) collect i))
        (dice (runner-dice (task-runner task))))
    (if (and dice (attempts-shuffled node))
        (shuffled-order order dice)
        order)))

(defun all-failed (record task frame)
  "Return the failure that stands for those in RECORD."
  (failure-of (make-condition 'composite-failure
                              :failures (reverse (attempt-record-failures record)))
              task frame))

(defun step-attempts (node task frame value)
  (let ((record (or (frame-data frame)
                    (setf (frame-data frame) (make-attempt-record (attempt-order node task))))))
    (cond ((plusp (frame-counter frame)) (values (frame-up frame) value))
          ((null (attempt-record-order record))
           (unwind task (frame-up frame) (all-failed record task frame)))
          (t (setf (frame-counter frame) 1)
             (enter (the node (svref (attempts-parts node) (pop (attempt-record-order record))))
                    (frame-environment frame)
                    frame)))))

(defun unwind-attempts (node task frame signal)
  (declare (ignore node task))
  (when (and (typep signal 'plan-failure) (plusp (frame-counter frame)))
    (push signal (attempt-record-failures (frame-data frame)))
    (setf (frame-counter frame) 0)
    (values t frame nil)))

(addition try-in-order)
(defmacro try-in-order (&body attempts)
  "Run ATTEMPTS in a plan one after the other until one succeeds; return its value. If all fail,
fail with a composite failure."
  (misplaced 'try-in-order attempts))

(addition try-one)
(defmacro try-one (&body attempts)
  "Do as TRY-IN-ORDER, in an order that the plan runner chooses: at random if it was given dice,
otherwise as written."
  (misplaced 'try-one attempts))

(defun attempts-code (form attempts shuffled scope)
  `(make-attempts :form ',form
                  :parts (vector ,@(loop for attempt in attempts
                                         collect (plan-code attempt scope)))
                  :shuffled ,shuffled))

(define-plan-form "TRY-IN-ORDER" :must (&rest attempts) (form scope)
  (attempts-code form attempts nil scope))

(define-plan-form "TRY-ONE" :must (&rest attempts) (form scope)
  (attempts-code form attempts t scope))

;;; For each element.

(define-node each-attempt ((items function) (body node))
  "BODY for the first element of the list that ITEMS returns for which it succeeds."
  :step step-each-attempt :unwind unwind-attempts)

(defun step-each-attempt (node task frame value)
  (let* ((environment (frame-environment frame))
         (record (or (frame-data frame)
                     (setf (frame-data frame)
                           (make-attempt-record
                            (coerce (funcall (each-attempt-items node) environment) 'list))))))
    (cond ((plusp (frame-counter frame)) (values (frame-up frame) value))
          ((null (attempt-record-order record))
           (unwind task (frame-up frame) (all-failed record task frame)))
          (t (setf (frame-counter frame) 1)
             (enter (each-attempt-body node)
                    (vector environment (pop (attempt-record-order record)))
                    frame)))))

(addition try-each-in-order)
(defmacro try-each-in-order ((variable sequence) &body body)
  "Run BODY in a plan with VARIABLE bound to each element of SEQUENCE in turn until it succeeds;
return its value. If it never does, fail with a composite failure."
  (misplaced 'try-each-in-order (list* (list variable sequence) body)))

(define-plan-form "TRY-EACH-IN-ORDER" :must ((variable sequence) &rest body) (form scope)
  (each-code '(make-each-attempt :items) form variable sequence '() body scope))
