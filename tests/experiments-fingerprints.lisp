;;;; experiments-fingerprints.lisp -- what a trial depends on is in its fingerprint, nothing else.

(in-package :ars-magna.tests)

(def-suite* experiments-fingerprints :in ars-magna)

;;; What the experiments here can reach.

(defvar *question-data* 1 "A user's data.")
(defvar *question-cache* nil "What a user's code keeps for later.")
(defvar *question-count* 0 "What a user's code counts.")

(defgeneric question-step (kind) (:documentation "A user's generic function."))

(defmacro define-reaching (form)
  "Define the experiment QUESTION, which evaluates FORM."
  `(eval '(experiment:defexperiment question (:robots ars-worlds:dot) (:run ,form))))

(defun question-fingerprints ()
  (let ((experiment (experiment:find-experiment 'question)))
    (loop for condition in (experiment:experiment-conditions experiment)
          do (experiment:prepare-condition experiment condition)
          collect (experiment::condition-fingerprint condition))))

(defun noticed-p (change)
  "True if the fingerprints of QUESTION are others once the function CHANGE has been called."
  (let ((before (question-fingerprints)))
    (is (equal before (question-fingerprints)))
    (funcall change)
    (not (equal before (question-fingerprints)))))

(defmacro changes (&body forms)
  "True if FORMS, evaluated as they are typed, change the fingerprint of QUESTION."
  `(noticed-p (lambda () ,@(loop for form in forms collect `(eval ',form)))))

;;; Code.

(test typed-code.is-noticed
  (eval '(defun question-help () 1))
  (eval '(defun question-work () (question-help)))
  (define-reaching (question-work))
  (is-true (changes (defun question-help () 2)))
  (is-true (changes (setf (symbol-function 'question-work) (lambda () (question-help)))))
  (is-false (changes (defun question-idle () 2))))

(defun tree-atoms (tree)
  "Return a list of the atoms in TREE, vectors included."
  (typecase tree
    (cons (append (tree-atoms (car tree)) (tree-atoms (cdr tree))))
    (simple-vector (loop for element across tree append (tree-atoms element)))
    (t (list tree))))

(test code.tells-what-it-was-made-of
  "Also what leaves no trace in it: macros, constants and inline functions."
  (eval '(progn (defconstant +question-constant+ 50)
                (defmacro question-macro (x) `(1+ ,x))
                (declaim (inline question-inline))
                (defun question-inline (x) (* x 3))))
  (eval '(defun question-made-of (n)
          (if (< n +question-constant+) (question-macro (question-inline n)) (question-help))))
  (eval '(defstruct question-structure slot))
  (eval '(defun question-reads (object)
          (declare (type question-structure object))
          (question-structure-slot object)))
  (is (member 'question-structure
              (tree-atoms (base:code-references (fdefinition 'question-reads)))))
  (let ((references (tree-atoms (base:code-references (fdefinition 'question-made-of)))))
    (dolist (name '(+question-constant+ question-macro question-inline question-help))
      (is (member name references) "~A is not among them" name))))

(test plans.are-noticed
  (eval '(rpl:def-interp-proc question-part (n) (rpl:wait-time n)))
  (eval '(rpl:def-interp-proc question-plan () (question-part 1) t))
  (define-reaching (driver:run-plan 'question-plan))
  (is-false (changes (rpl:def-interp-proc question-part (n) (rpl:wait-time n))))
  (is-true (changes (rpl:def-interp-proc question-part (n) (rpl:wait-time (* 2 n)))))
  (is-true (changes (rpl:def-interp-proc question-plan () (question-part 3) t))))

(test methods.are-noticed
  (eval '(defmethod question-step ((kind integer)) 1))
  (define-reaching (question-step 3))
  (is-true (changes (defmethod question-step ((kind integer)) 2)))
  (is-true (changes (defmethod question-step ((kind string)) 2))))

(test files.are-noticed-by-their-code
  (uiop:with-temporary-file (:pathname path :type "lisp")
    (flet ((write-code (text)
             (with-open-file (out path :direction :output :if-exists :supersede)
               (format out "(in-package :ars-magna.tests)~%~A" text))
             (handler-bind ((warning #'muffle-warning)) (load path))))
      (write-code "(defun question-work () 1)")
      (define-reaching (question-work))
      (is-false (noticed-p (lambda () (write-code "; another
 (defun question-work ()
    1)"))))
      (is-false (noticed-p (lambda () (write-code "(defun question-work () 1)
 (experiment:defexperiment other-question (:robots ars-worlds:dot) (:run t))"))))
      (is-true (noticed-p (lambda () (write-code "(defun question-work () 2)")))))))

;;; Data.

(test data.of-every-kind-are-noticed
  (define-reaching (identity *question-data*))
  (let ((*question-data* 1) (old *question-data*))
    (unwind-protect
         (loop for (value other)
                 in `((1 2) (1 1.0) (1.0 1d0) (a b) ("a" "b") (#\a #\b) ((1 . 2) (1 . 3))
                      ((a (1 . b)) (a (1 . c))) (,(vector 1 2) ,(vector 1 3)) (#*01 #*11)
                      (#c(1 2) #c(1 3)) (#p"a" #p"b")
                      (,(make-array '(2 2) :initial-element 0)
                       ,(make-array '(2 2) :initial-element 1))
                      (car ,(intern "CAR" :keyword)))
               do (setf (base:global-value '*question-data*) value)
                  (is-true (noticed-p (lambda ()
                                        (setf (base:global-value '*question-data*) other)))
                           "~S, ~S" value other))
      (setf (base:global-value '*question-data*) old))))

(test caches.make-no-difference
  (define-reaching (identity *question-cache*))
  (unwind-protect
       (is-false (noticed-p (lambda () (setf (base:global-value '*question-cache*)
                                             (make-hash-table)))))
    (setf (base:global-value '*question-cache*) nil)))

;;; Tables and structures.

(defstruct question-record "A user's structure." (size 1) (names '()))

(defun question-table (&rest entries)
  "Return a hash table of ENTRIES, keys and values by turns."
  (let ((table (make-hash-table :test 'equal)))
    (loop for (key value) on entries by #'cddr do (setf (gethash key table) value))
    table))

(defmacro with-question-data ((value) &body body)
  "Run BODY with VALUE in *QUESTION-DATA*, which the experiment QUESTION can reach."
  `(let ((old *question-data*))
     (define-reaching (identity *question-data*))
     (unwind-protect (progn (setf (base:global-value '*question-data*) ,value) ,@body)
       (setf (base:global-value '*question-data*) old))))

(test data.in-tables-and-structures-are-noticed
  (with-question-data ((question-table "a" 1 :b (list 2 (question-table 'c 3))))
    (is-true (noticed-p (lambda () (setf (gethash "a" *question-data*) 2))))
    (is-true (noticed-p (lambda () (remhash "a" *question-data*))))
    (is-true (noticed-p (lambda ()
                          (setf (gethash 'c (second (gethash :b *question-data*))) 4)))))
  (with-question-data ((vector 0 (make-question-record)))
    (is-true (noticed-p (lambda () (setf (question-record-size (aref *question-data* 1)) 2))))
    (is-true (noticed-p (lambda ()
                          (push "x" (question-record-names (aref *question-data* 1))))))))

(defstruct (question-node (:print-function (lambda (node stream depth)
                                             (declare (ignore node depth))
                                             (write-string "node" stream))))
  (value 0) (parent nil))

(test data.in-themselves-are-noticed
  (let ((node (make-question-node)) (ring (list 1 2 3)))
    (setf (question-node-parent node) node
          (cdddr ring) ring)
    (with-question-data (node)
      (is-true (noticed-p (lambda () (setf (question-node-value node) 1)))))
    (with-question-data (ring)
      (is-true (noticed-p (lambda () (setf (second ring) 5)))))))

(test data.deep-down-and-many-are-noticed
  (let* ((leaf (list 0)) (deep leaf) (many (make-array 1500000 :initial-element 0)))
    (loop repeat 300 do (setf deep (list deep)))
    (with-question-data (deep)
      (is-true (noticed-p (lambda () (setf (first leaf) 1)))))
    (with-question-data (many)
      (is-true (noticed-p (lambda () (setf (aref many 1400000) 1)))))))

(test data.beside-what-is-none-are-noticed
  (with-question-data ((list 0 #'car (make-condition 'error) ars-worlds:dot))
    (is-true (noticed-p (lambda () (setf (first *question-data*) 1))))))

(test data.of-global-and-undeclared-variables-are-noticed
  (eval '(sb-ext:defglobal **question-global** (list 0)))
  (let ((name (intern "*QUESTION-UNDECLARED*" :ars-magna.tests)))
    (setf (symbol-value name) (list 0))
    (handler-bind ((warning #'muffle-warning))
      (dolist (symbol (list '**question-global** name))
        (define-reaching (identity symbol))
        (eval `(experiment:defexperiment question (:robots ars-worlds:dot) (:run (first ,symbol))))
        (is-true (noticed-p (lambda () (incf (first (symbol-value symbol))))))))))

(test data.in-tables-have-no-order
  (with-question-data ((question-table 1 2 3 4 "five" 6))
    (is-false (noticed-p (lambda ()
                           (setf (base:global-value '*question-data*)
                                 (question-table "five" 6 3 4 1 2)))))))

(test plans.named-in-tables-are-noticed
  (eval '(rpl:def-interp-proc question-plan () (rpl:wait-time 1)))
  (with-question-data ((question-table :first 'question-plan))
    (is-true (changes (rpl:def-interp-proc question-plan () (rpl:wait-time 2))))))

(defun refusal-of-trials (data form)
  "Return what is said when trials have evaluated FORM, a list, with DATA in *QUESTION-DATA*; NIL if
nothing is."
  (with-question-data (data)
    (eval `(experiment:defexperiment question (:robots ars-worlds:dot) (:run ,form)))
    (handler-case (not (experiment:run-experiment 'question :trials 3 :workers 1 :stream nil))
      (base:misuse (condition) (princ-to-string condition)))))

(test tables.that-trials-fill-are-noticed
  "What one trial leaves in a global table another finds: the rows are not those of seeds."
  (is-true (has-words-p (refusal-of-trials (make-hash-table)
                                           '(setf (gethash (hash-table-count *question-data*)
                                                           *question-data*) t))
                        "give each trial its own value: (:run (let ((*question-data* ...)) ...))")))

(test refusals.say-what-helps
  (eval '(sb-ext:defglobal **question-global** (list 0)))
  (let ((said (refusal-of-trials 1 '(incf (first **question-global**)))))
    (is-true (has-words-p said "define it with DEFVAR" "Run the experiment again."))
    (is-false (has-words-p said "directory") "none was given")))

;;; What is held weakly may go at any time: that is no change, but what trials add there is one.

(test weak-tables.that-trials-fill-are-noticed
  (dolist (weakness '(:key :value :key-and-value :key-or-value))
    (dolist (data (list (make-hash-table :weakness weakness)
                        (list (make-hash-table :weakness weakness))))
      (is-true (has-words-p (refusal-of-trials
                             ;; Nothing lets go of the value.
                             data '(setf (gethash 'x (first (base:ensure-list *question-data*)))
                                    'some-value))
                            "*question-data*" "give each trial its own value")))))

(test weak-tables.may-lose-what-they-have
  (dolist (weakness '(:key :value :key-and-value))
    (let ((table (make-hash-table :weakness weakness)))
      (setf (gethash 'y table) 1)
      (is (null (refusal-of-trials table '(or (remhash 'y *question-data*) t)))))))

(test weak-tables.may-have-keys-that-trials-have-made
  (is (null (refusal-of-trials (make-hash-table :weakness :key :test 'equal)
                               '(let ((key (make-question-record)))
                                 (setf (gethash key *question-data*) key
                                  (gethash (make-symbol "KEY") *question-data*) 1))))))

(test weak-pointers.do-not-hide-what-trials-change
  (let ((data (list 1)))
    (is-true (has-words-p (refusal-of-trials
                           (base:make-weak-reference data)
                           '(incf (first (sb-ext:weak-pointer-value *question-data*))))
                          "*question-data*"))
    (is (equal '(4) data))))

(define-condition question-condition (error)
  ((count :initform 0 :accessor question-condition-count)
   (unbound :reader question-condition-unbound)))

(test conditions.that-trials-change-are-noticed
  (is-true (has-words-p (refusal-of-trials (make-condition 'question-condition)
                                           '(incf (question-condition-count *question-data*)))
                        "*question-data*"))
  (is (null (refusal-of-trials (make-condition 'question-condition) '(list *question-data*)))))

(test rows.that-were-refused-stay-so
  (with-directories (directory other)
    (with-question-data ((list 0))
      (define-reaching (incf (first *question-data*)))
      (flet ((go-on () (experiment:run-experiment 'question :trials 3 :workers 1 :stream nil
                                                            :directory directory))
             (refused-p (function)
               (handler-case (progn (funcall function) nil)
                 (base:misuse (condition)
                   (search "were refused" (princ-to-string condition))))))
        (signals base:misuse (go-on))
        (is-true (refused-p #'go-on))
        (is-true (refused-p (lambda () (experiment:merge-results (list directory) :to other))))
        (signals warning (experiment:read-results directory))))))

(test values.of-conditions-have-packages
  (flet ((fingerprint (symbol)
           (eval `(experiment:defexperiment question (:robots ars-worlds:dot)
                    (:vary (way '(,symbol))) (:run way)))
           (question-fingerprints)))
    (is (equal (fingerprint 'base:chance) (fingerprint 'base:chance)))
    (is (not (equal (fingerprint 'base:chance) (fingerprint (intern "CHANCE" :keyword)))))))

;;; What trials set.

(test variables.are-bound-for-each-trial
  (eval '(experiment:defexperiment question (:robots ars-worlds:dot)
          (:run (incf *question-count*) (push 1 *question-cache*) t)
          (:measure (count *question-count*) (length (length *question-cache*)))))
  (let ((results (experiment:run-experiment 'question :trials 30 :workers 3 :stream nil)))
    (is (equal (make-list 30 :initial-element 1) (measured results 'count)))
    (is (equal (make-list 30 :initial-element 1) (measured results 'length))))
  (is (eql 0 *question-count*))
  (is (null *question-cache*)))

(test variables.of-the-manuals-style-do-not-meet
  "A continuation that sets a global variable, and :until that asks it, by several workers."
  (eval '(defun question-drive (robot legs)
          (if (zerop legs)
              (setf *question-cache* t)
              (command:robot-go-forward
               robot 1 (lambda (err robot) (declare (ignore err))
                         (question-drive robot (1- legs)))))))
  (eval '(experiment:defexperiment question (:robots ars-worlds:dot) (:limit 200)
          (:vary (legs 2 4)) (:run (question-drive ars-worlds:dot legs))
          (:until *question-cache*)))
  (flet ((rows (workers)
           (rows-of (experiment:run-experiment 'question :trials 40 :workers workers
                                                         :stream nil))))
    (let ((one (rows 1)))
      (is (= 80 (length one)))
      (is-true (every (lambda (row) (string= "success" (third row))) one))
      (is (equal one (rows 4))))))

(test variables.are-bound-for-replays-too
  "A trial that is replayed before any run, or twice, finds what a worker would find."
  (eval '(defun question-drive (robot)
          (command:robot-go-forward robot 3 (lambda (err robot) (declare (ignore err robot))
                                              (setf *question-cache* t)))))
  (eval '(experiment:defexperiment question (:robots ars-worlds:dot) (:limit 200)
          (:run (question-drive ars-worlds:dot)) (:until *question-cache*)))
  (flet ((ticks () (getf (experiment:replay-trial 'question 1 1) :ticks)))
    (let ((first (ticks)))
      (is (< 1 first 200))
      (is (= first (ticks)))
      (is (equal (list first)
                 (mapcar #'fifth (rows-of (experiment:run-experiment 'question :trials 1 :workers 1
                                                                               :stream nil)))))))
  (is (null *question-cache*)))

(test variables.keep-what-they-share
  "Values are not copied: what is the same outside is the same in a trial."
  (let ((list (list 1 2 3)))
    (setf (base:global-value '*question-data*) (make-array 4 :fill-pointer 0 :adjustable t)
          (base:global-value '*question-cache*) (cons list (last list)))
    (unwind-protect
         (progn
           (define-reaching (and (adjustable-array-p *question-data*)
                                 (eq (cdr *question-cache*) (last (car *question-cache*)))))
           (is (equal '("success") (mapcar #'third
                                           (rows-of (experiment:run-experiment
                                                     'question :trials 1 :workers 1
                                                               :stream nil))))))
      (setf (base:global-value '*question-data*) 1
            (base:global-value '*question-cache*) nil))))

(test code.that-changes-while-it-runs-is-noticed
  (eval '(defun question-help () 1))
  (define-reaching (progn (setf (symbol-function 'question-help) (lambda () 2)) (question-help)))
  (handler-case (progn (experiment:run-experiment 'question :trials 2 :workers 1 :stream nil)
                       (fail "it was not"))
    (base:misuse (condition)
      (is (search "while the experiment ran" (princ-to-string condition))))))

(test experiments.may-run-in-trials
  (eval '(experiment:defexperiment walk (:robots ars-worlds:dot) (:run t)))
  (define-reaching (experiment:run-experiment 'walk :trials 2 :workers 1 :stream nil))
  (let ((rows (rows-of (experiment:run-experiment 'question :trials 6 :workers 2 :stream nil))))
    (is (= 6 (length rows)))
    (is-true (every (lambda (row) (equal '("success" "" 0 "") (cddr row))) rows) "~S" rows)))

(defclass question-kind () () (:documentation "A user's class."))

(test methods.of-lisps-own-functions-are-noticed
  (define-reaching (make-instance 'question-kind))
  (is-true (changes (defmethod initialize-instance :after ((kind question-kind) &key) 1))))

;;; The printer, and the order.

(test tables.do-not-depend-on-the-printer
  (define-walk)
  (with-directories (plain odd)
    (walk plain :trials 12)
    (let ((*print-base* 16) (*print-radix* t) (*read-base* 8) (*print-case* :downcase)
          (*print-length* 2) (*read-default-float-format* 'double-float))
      (walk odd :trials 5)
      (walk odd :trials 12)
      (is (= 2 (length (experiment:results-samples (experiment:read-results odd))))))
    (is (string= (table-text plain) (table-text odd)))))

(test conditions.have-one-order-everywhere
  (eval '(experiment:defexperiment walk (:robots ars-worlds:dot)
          (:conditions (calm (base:max-speed* 1)) (rough (base:max-speed* 3))
           (brisk (base:max-speed* 2)))
          (:run (command:robot-go-forward ars-worlds:dot 3) (run:run-ticks 5) t)))
  (with-directories (directory shard-0 shard-1 merged)
    (flet ((names (results)
             (mapcar #'experiment:sample-condition (experiment:results-samples results))))
      (is (equal '("calm" "rough" "brisk") (names (walk directory :trials 4))))
      (is (equal '("calm" "rough" "brisk") (names (experiment:read-results directory))))
      (walk shard-0 :trials 4 :shard '(0 . 2))
      (walk shard-1 :trials 4 :shard '(1 . 2))
      (is (equal '("calm" "rough" "brisk")
                 (names (experiment:merge-results (list shard-1 shard-0) :to merged))))
      (is (string= (table-text directory) (table-text merged)))
      (is (string= "rough" (experiment:condition-name (experiment:find-condition 'walk 2)))))))
