;;;; forking-values.lisp -- the values of plans' variables in forks.

(in-package :ars-magna.tests)
(in-suite forking)

(defun call-with-forked (value function &rest options)
  "Let a plan have VALUE in a variable, and fork it with OPTIONS. Call FUNCTION, in the fork, with
what the plan has there. Return what FUNCTION returns."
  (run:with-simulation (rover :seed 1)
    (driver:begin-plan (rpl:interp-lambda (value) (rpl:wait-time 3) value) value)
    (run:run-ticks 1)
    (apply #'run:call-with-fork
           (lambda ()
             (let ((task (first (driver:plans))))
               (run:run-ticks 5)
               (funcall function (rpl:task-result task))))
           options)))

(defmacro with-forked ((variable value &rest options) &body body)
  "Run BODY in a fork made with OPTIONS, with VARIABLE bound to what a plan there has for VALUE."
  `(call-with-forked ,value (lambda (,variable) ,@body) ,@options))

(defun written-alike-p (one other)
  "True if ONE and OTHER are written the same way, with all circles and sharing."
  (with-standard-io-syntax
    (let ((*print-circle* t) (*print-readably* nil))
      (string= (prin1-to-string one) (prin1-to-string other)))))

(defstruct (link-of-chain (:constructor make-link-of-chain (next)))
  "A structure that knows another."
  next)

(defclass chain-node ()
  ((next :initarg :next :initform nil :reader chain-node-next)
   (unbound)
   (common :allocation :class :initform (list :common) :reader chain-node-common))
  (:documentation "An instance that knows another."))

(test values.lists-with-their-sharing-and-circles
  (let* ((part (list 1 "two" #\3)) (ring (list :a :b :c))
         (value (list* part part ring (vector part ring) 4)))
    (setf (cdddr ring) ring)
    (setf (cddr part) (list value))
    (with-forked (copy value)
      (is (written-alike-p value copy))
      (is (not (eq value copy)))
      (is (eq (first copy) (second copy)))
      (is (not (eq part (first copy))))
      (is (not (eq (second part) (second (first copy)))) "strings can be altered, too")
      (is (eq copy (third (first copy)))))))

(test values.long-lists-and-deep-ones
  (let ((long (loop for index below 1000000 collect index)) (deep '()) (chain nil)
        (nodes nil))
    (dotimes (index 100000)
      (setf deep (list deep)
            chain (make-link-of-chain chain)
            nodes (make-instance 'chain-node :next nodes)))
    (with-forked (copy (list long deep chain nodes))
      (is (= 1000000 (length (first copy))))
      (is (equal long (first copy)))
      (is (not (eq (last long) (last (first copy)))))
      (is (= 100000 (loop for each = (second copy) then (first each)
                          while each count t)))
      (is (= 100000 (loop for each = (third copy) then (link-of-chain-next each)
                          while each count t)))
      (is (= 100000 (loop for each = (fourth copy) then (chain-node-next each)
                          while each count t))))))

(test values.instances
  (let* ((last (make-instance 'chain-node)) (first (make-instance 'chain-node :next last))
         (common (chain-node-common last)))
    (with-forked (copy (list first last))
      (is (eq (second copy) (chain-node-next (first copy))))
      (is (not (eq last (second copy))))
      (is (not (slot-boundp (second copy) 'unbound)))
      (is (eq common (chain-node-common (second copy)))
          "what all instances of a class have is everybody's"))))

(define-condition remark (error) ((what :initarg :what :reader remark-what))
  (:documentation "An error that says WHAT.")
  (:default-initargs :what (list :nothing)))

(test values.conditions
  (let ((remark (make-condition 'remark :what (list 1 2))) (bare (make-condition 'remark)))
    (with-forked (copy (list remark (remark-what remark) bare))
      (is (typep (first copy) 'remark))
      (is (not (eq remark (first copy))))
      (is (eq (second copy) (remark-what (first copy))))
      (is (not (eq (second copy) (remark-what remark))))
      (is (equal '(:nothing) (remark-what (third copy)))))))

(test values.closures-that-share-a-variable
  (let* ((count 0) (more (lambda () (incf count))) (tell (lambda () count))
         (constant (let ((list (list 1))) (lambda () list))))
    (with-forked (copy (list more tell constant #'car 'car))
      (funcall (first copy))
      (funcall (first copy))
      (is (= 2 (funcall (second copy))))
      (is (zerop count))
      (is (not (eq (funcall constant) (funcall (third copy)))))
      (is (eq #'car (fourth copy))))
    (is (zerop (funcall tell)))))

(test values.numbers-symbols-and-code-are-everybodys
  (let ((values (list 1 2d0 (expt 7 90) 3/4 #c(1 2) 'symbol (make-symbol "NOBODYS") #\c
                      #p"/tmp" *package* #'print-object (find-class 'chain-node) #'car)))
    (with-forked (copy values)
      (is (every #'eql values copy)))))

(test values.arrays-of-all-sorts
  (let ((growing (make-array 5 :adjustable t :fill-pointer 2 :initial-contents '(a b c d e)))
        (grid (make-array '(2 3) :initial-element (list 1)))
        (bits (make-array 70 :element-type 'bit :initial-element 1))
        (reals (make-array '(2 2) :element-type 'double-float :initial-element 1d0))
        (text (make-array 3 :element-type 'character :adjustable t :fill-pointer 1
                            :initial-element #\x))
        (table (make-array '(2 2) :adjustable t :initial-element 0)))
    (with-forked (copies (list growing grid bits reals text table (vector) (make-array nil)))
      (destructuring-bind (growing-copy grid-copy bits-copy reals-copy text-copy table-copy
                           nothing point)
          copies
        (is (equalp (list growing grid bits reals text table)
                    (list growing-copy grid-copy bits-copy reals-copy text-copy table-copy)))
        (is (= 2 (fill-pointer growing-copy)))
        (is (eq 'd (aref growing-copy 3)))
        (vector-push-extend 'new growing-copy)
        (is (eq 'new (aref growing-copy 2)))
        (is (eq 'c (aref growing 2)))
        (is (eq (aref grid-copy 0 0) (aref grid-copy 1 2)))
        (is (not (eq (aref grid 0 0) (aref grid-copy 0 0))))
        (setf (aref bits-copy 0) 0 (aref reals-copy 1 1) 2d0)
        (is (= 1 (aref bits 0)))
        (is (= 1d0 (aref reals 1 1)))
        (vector-push-extend #\y text-copy)
        (is (string= "x" text))
        (is (adjustable-array-p table-copy))
        (is (zerop (length nothing)))
        (is (zerop (aref point)))))))

(test values.tables-of-all-tests
  (loop for test in '(eq eql equal equalp)
        do (let ((table (make-hash-table :test test)) (key (list 1 "key" #'car)))
             (setf (gethash key table) (list :value key)
                   (gethash :self table) table
                   (gethash 3d0 table) 'three)
             (with-forked (copy (list table key))
               (destructuring-bind (table-copy key-copy) copy
                 (is (eq test (hash-table-test table-copy)))
                 (is (= 3 (hash-table-count table-copy)))
                 (is (eq key-copy (second (gethash key-copy table-copy))) "~A" test)
                 (is (eq table-copy (gethash :self table-copy)))
                 (is (not (eq key key-copy)))
                 (remhash :self table-copy)
                 (is (gethash :self table)))))))

(test values.tables-by-what-is-copied-too
  "The keys are lists with parts of the robot in them, which a fork has others for."
  (run:with-simulation (rover :seed 1)
    (let ((table (make-hash-table :test 'equal)) (hand (robot:robot-hand rover 0)))
      (setf (gethash (list :hand hand) table) :found
            (gethash (make-hash-table) table) :table)
      (driver:begin-plan (rpl:interp-lambda (table) (rpl:wait-time 3) table) table)
      (run:run-ticks 1)
      (run:with-fork ()
        (let ((task (first (driver:plans))))
          (run:run-ticks 5)
          (is (eq :found (gethash (list :hand (robot:robot-hand rover 0))
                                  (rpl:task-result task))))
          (is (null (gethash (list :hand hand) (rpl:task-result task)))))))))

(test values.weak-tables-stay-weak
  (let ((table (make-hash-table :test 'eq :weakness :key)))
    (with-forked (copy table)
      (is (eq :key (sb-ext:hash-table-weakness copy))))))
