;;;; rpl-text-places.lisp -- messages about plans name the right line.

(in-package :ars-magna.tests)
(in-suite rpl)

;;; Lines.

(defun texts-of (said)
  "Return what is said in SAID, each text on one line."
  (loop for (nil . text) in said collect (substitute #\Space #\Newline text)))

(defun said-somehow (text)
  "Return what is said when a file of TEXT is compiled, and when it is loaded: two lists of texts."
  (list (texts-of (said-compiling text)) (texts-of (said-loading text))))

(defun lines-told (texts)
  "Return the numbers of the lines that TEXTS tell."
  (loop for text in texts
        for start = (search ", line " text)
        when start collect (parse-integer text :start (+ start 7) :junk-allowed t)))

(defparameter *twice*
  "
(def-interp-proc twice ()
  (wait-time 1)                         ; (missing 3), it says here
  '(missing 3)
  (missing 3)
  #| (missing 3 |#
  (list #'car \"(missing 3)\" #\\( (quote (missing 3)))
  (par (seq (missing 3))
       (late (wait-time 1) 2)))

(def-interp-proc late (x) (wait-time x))"
  "A plan with the same mistake on lines 5 and 8, and one on line 9.")

(test lines.are-those-of-the-form-and-not-of-its-like
  (loop for texts in (said-somehow *twice*)
        do (is (equal '(5 8 9) (lines-told texts)) "~S" texts)))

(test lines.also-where-nothing-waits-and-in-plans-without-a-name
  (let ((*gensym-counter* 0))
    (loop for text in '("(defvar *first* (interp-lambda () (seq (wait-time 1) (missing))))
(defvar *second*
  (interp-lambda ()
    (seq (wait-time 1)
         (missing))))"
                        "(defun first-one () (list (interp-lambda () (wait-time 1) (missing))))
;; ä ö ü: more octets than characters
(defun second-one ()
  (list
    (interp-lambda () (wait-time 1) (missing))))")
          do (loop for texts in (said-somehow text)
                   do (is (equal '(1 5) (lines-told texts)) "~S" texts)))))

(defparameter *misplaced-twice*
  "
(def-interp-proc misplaced-twice ()
  (wait-time 1)
  (print 3)
  (unwind-protect (wait-time 1)
    (print 4)))
(def-interp-proc retrying ()
  (handle-failure ((t () (retry)))
    (wait-time 1))
  (retry))"
  "Plans with a misplaced wait on line 5 and a misplaced retry on line 10.")

(test lines.of-errors
  (is (equal '(5 10) (lines-told (texts-of (said-compiling *misplaced-twice*)))))
  (call-with-files
   (lambda (path)
     (handler-case (let ((*error-output* (make-broadcast-stream))) (load path))
       (base:malformed-definition (condition)
         (is (search "line 5" (base:malformed-definition-place condition))))
       (:no-error (&rest values) (declare (ignore values)) (fail "nothing was signalled"))))
   (list *misplaced-twice*)))

(test lines.are-told-when-a-compiled-file-is-loaded
  (call-with-files
   (lambda (path)
     (uiop:with-temporary-file (:pathname fasl :type "fasl")
       (said (lambda () (compile-file path :output-file fasl :verbose nil :print nil)))
       (handler-case (let ((*error-output* (make-broadcast-stream))) (load fasl))
         (base:malformed-definition (condition)
           (is (search "line 5" (princ-to-string condition)) "~A" condition))
         (:no-error (&rest values) (declare (ignore values)) (fail "nothing was signalled")))))
   (list *misplaced-twice*)))

(test lines.are-told-at-the-end-too
  (destructuring-bind (text) (texts-of (said-compiling "
(def-interp-proc z4 () (wait-time 1)
  (nobody-knows 3))"))
    (is (search ".lisp, line 3): there is no plan procedure" text) "~S" text)))

;;; Names.

(test nearest-names.are-also-those-that-the-file-defines
  (loop for texts in (said-somehow "(defun stow-parcel (x) x)
                                    (def-interp-proc n1 () (wait-time 1) (stow-parcle 1))")
        do (is (= 1 (length texts)))
           (is (search "Did you mean stow-parcel?" (first texts)) "~S" texts)))

(test nearest-names.at-run-time-are-those-of-constructs-too
  (let* ((plan (handler-bind ((warning #'muffle-warning))
                 (rpl:make-plan (let ((*package* (find-package :ars-user)))
                                  (read-from-string "(wait-tme 1)")))))
         (failure (rpl:run-plan-alone plan)))
    (is (search "Did you mean wait-time?"
                (princ-to-string (rpl:lisp-failure-condition failure)))
        "~A" failure)))

(test nearest-names.one-letter-is-like-no-other
  (let ((texts (texts-of (said-compiling "(def-interp-proc p (x) (wait-time x))
                                          (def-interp-proc n2 () (wait-time 1) (q 1))"))))
    (is (= 1 (length texts)))
    (is (null (search "Did you mean" (first texts))) "~S" texts)))

;;; What is said.

(defparameter *refusals*
  '(("(whenever (robot-stopped* :mised :all) (wait-time 1))" "(fluent :missed :all)")
    ("(whenever ((vref camera-moved* 0) :mised :all) (wait-time 1))" "(fluent :missed :all)")
    ("(whenever (robot-stopped* :missed :some) (wait-time 1))" "(fluent :missed :all)")
    ("(whenever (robot-stopped* :missed) (wait-time 1))" "(fluent :missed :all)")
    ("(with-valves (c c :priority) (wait-time 1))" "(valve... [:priority number])")
    ("(with-valves (c :prority 3) (wait-time 1))" "(valve... [:priority number])")
    ("(let ((x 1) (x 2)) (wait-time 1) (list x))" "each variable once: x is bound twice")
    ("(multiple-value-bind (x x) (floor 1 2) (wait-time 1) (list x))" "each variable once")
    ("(:tag (wait-time 1))" "(:tag name form...)")
    ("(:tag nil (wait-time 1))" "(:tag name form...)")
    ("(policy-get :x)" "policy-get only in a clause of define-policy")
    ("(let ((*print-base* 2)) (wait-time 1))" "A plan cannot wait inside let")
    ("(at-location (:x :go (wait-time 1)) (wait-time 1))" ":there test")
    ("(incf robot-angle-diff*)"
     "(set-value robot-angle-diff* (+ (fluent-value robot-angle-diff*) 1))")
    ("(let ((f (create-fluent 'f 1))) (wait-time 1) (decf f 3))" "- (fluent-value f) 3")))

(test texts.each-mistake-is-told-once
  (loop for (form expected) in *refusals*
        for texts = (texts-of (said-compiling (format nil "(def-interp-proc m (c) (wait-time 1)
                                                             ~A (list c))"
                                                      form)))
        do (is (= 1 (length texts)) "~A: ~S" form texts)
           (is (search expected (or (first texts) "")) "~A: ~S" form texts)))

(test texts.an-empty-definition-is-told-once
  (let ((texts (texts-of (said-compiling "(def-interp-proc)"))))
    (is (= 1 (length texts)) "~S" texts)
    (is (search "(def-interp-proc name parameters" (first texts)))))

(test texts.a-tag-without-a-name-is-our-error
  (refuses base:malformed-definition (:tag (rpl:wait-time 1)))
  (refuses base:malformed-definition (rpl:par (:tag t (rpl:wait-time 1)))))

(test whenever.a-wrong-choice-is-told-at-run-time
  (let ((choice :some) (f (fluent nil)))
    (is (search "missed is :SOME"
                (princ-to-string
                 (rpl:lisp-failure-condition
                  (plan-failure-of
                    (rpl:par (rpl:whenever (f :missed choice) (rpl:wait-time 1))
                             (rpl:seq (rpl:wait-time 1) (rpl:set-value f t))))))))))

(test at-location.the-robot-need-never-be-there
  (is (typep (plan-failure-of (rpl:at-location (:x :there nil :go (rpl:wait-time 1) :attempts 1)
                                (rpl:wait-time 1)))
             'rpl:location-lost)))

(test too-deep.names-the-limit
  (let ((data (rpl:failure-data (let ((rpl:*plan-depth-limit* 5))
                                  (rpl:run-plan-alone 'endless)))))
    (is (= 5 (getf data :limit)))
    (is (search "*plan-depth-limit*" (getf data :remedy)))))

(rpl:def-interp-proc endless () (rpl:wait-time 1) (endless))

;;; Loops that wait.

(test loops.bind-their-variable-around-the-result
  (is (= 2 (plan-value (dotimes (i 2 i) (rpl:wait-time 1)))))
  (is (equal '(2 2) (plan-value (dotimes (i 2 (list i (rpl:plan-time))) (rpl:wait-time 1)))))
  (is (= 0 (plan-value (dotimes (i -3 i) (rpl:wait-time 1)))))
  (is (equal '(nil) (plan-value (dolist (x '(1 2) (list x)) (rpl:wait-time x)))))
  (is (equal '(nil 4) (plan-value (dolist (x '(1 2) (progn (rpl:wait-time 1)
                                                           (list x (rpl:plan-time))))
                                    (rpl:wait-time x)))))
  (is (eq :left (plan-value (dolist (x '(1) (return :left)) (rpl:wait-time x)))))
  (is (null (plan-value (dolist (x '(1 2)) (rpl:wait-time x))))))

;;; Several values.

(defmacro both-values (form)
  "Return the list of the first two values of FORM in a plan that waits."
  `(plan-value (multiple-value-bind (a b) ,form (list a b))))

(test values.all-of-what-the-task-itself-runs-and-one-of-another-task
  (let ((valve (rpl:make-valve 'valve)))
    (is (equal '(1 2) (both-values (rpl:with-valve (valve) (rpl:wait-time 1) (values 1 2)))))
    (is (equal '(1 2) (both-values (rpl:evap-protect (seq-of-two) nil))))
    (is (equal '(1 2) (both-values (rpl:handle-failure () (seq-of-two)))))
    (is (equal '(1 2) (both-values (rpl:try-in-order (rpl:fail) (seq-of-two)))))
    (is (equal '(1 2) (both-values (rpl:call-plan 'seq-of-two)))))
  (is (equal '(1 nil) (both-values (rpl:par 0 (seq-of-two)))))
  (is (equal '(1 nil) (both-values (:tag part (seq-of-two)))))
  (is (equal '(1 nil) (both-values (rpl:with-deadline (5) (seq-of-two)))))
  (is (equal '(1 nil) (both-values (rpl:with-policy (rpl:wait-time 9) (seq-of-two))))))

(rpl:def-interp-proc seq-of-two () (rpl:wait-time 1) (values 1 2))
