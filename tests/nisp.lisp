;;;; nisp.lisp -- the dialect: what its syntax reads as and what its forms do.

(in-package :ars-magna.tests)

(def-suite* nisp :in ars-magna)

;;; A package as a user would have it, and a type hierarchy with slots.

(defpackage :ars-magna.tests.user
  (:documentation "A user's package: Common Lisp with Nisp's forms in place of its own.")
  (:use :cl :ars-magna.nisp :ars-magna.geometry)
  (:shadowing-import-from :ars-magna.nisp #:let #:loop #:if)
  (:shadowing-import-from :ars-magna.geometry #:equal))

(defstruct (part (:constructor make-part (angle &optional owner)))
  (angle 0)
  (owner nil))

(defstruct (wheel (:include part) (:constructor make-wheel (angle))))

(defun half-angle (part) (/ (part-angle part) 2))
(defun set-half-angle (value part)
  (setf (part-angle part) (* 2 value)))

(nisp:define-nisp-type part (angle &optional owner)
  (make-part angle owner))
(nisp:define-nisp-slot part angle part-angle (setf part-angle))
(nisp:define-nisp-slot part owner part-owner (setf part-owner))
(nisp:define-nisp-slot part half half-angle set-half-angle)
(nisp:define-nisp-slot part fixed half-angle)

(defun nisp-read (text &optional (package :ars-magna.tests.user))
  "Return the form that TEXT is in PACKAGE with the readtable :NISP."
  (let ((*package* (find-package package))
        (*readtable* (named-readtables:find-readtable :nisp)))
    (values (read-from-string text))))

(defun nisp-function (text)
  "Compile the form that TEXT is, a function; claim that nothing in it deserves a warning."
  (multiple-value-bind (function warnings) (compile nil (nisp-read text))
    (is (null warnings) "~A compiles with warnings" text)
    function))

(defun nisp-value (text &rest arguments)
  "Return the values of the function that the form TEXT is, called with ARGUMENTS."
  (apply (nisp-function text) arguments))

(defmacro signals-misread (text)
  `(signals base:malformed-definition (nisp-read ,text)))

;;; Reading.

(test reader.booleans-are-t-and-nil
  (is (equal '(t nil t nil) (nisp-read "(#T #F #t #f)"))))

(test reader.leaves-marks-inside-symbols-alone
  (let ((symbols (nisp-read "(add! interval-subset? a!=b !foo ! ? !! foo!_x)")))
    (is (equal '("ADD!" "INTERVAL-SUBSET?" "A!=B" "!FOO" "!" "?" "!!" "FOO!_X")
               (mapcar #'symbol-name symbols)))
    (is (eq 'geo:add! (first symbols)))
    (is (eq (find-package :ars-magna.tests.user) (symbol-package (fourth symbols))))))

(test reader.operators-mean-nisp-in-any-package
  (let ((form (nisp-read "(!= (!_x p) 3)" :keyword)))
    (is (eq 'nisp:!= (first form)))
    (is (eq (nisp::slot-accessor-name "X") (first (second form))))
    (is (eq :p (second (second form))))))

(test reader.paths-chain-from-the-left
  (is (equal (nisp-read "(!_canonical-dir (!_type cell))")
             (nisp-read "!>cell.type.canonical-dir")))
  (is (equal (nisp-read "(!_x ars-magna.tests.user::p)" :cl) (nisp-read "!>p.x")))
  (is (eq (nisp-read "p") (nisp-read "!>p")))
  (is (equal (nisp-read "(list (!_y p))") (nisp-read "(list !>p.y)")))
  (signals-misread "!>p..x")
  (signals-misread "!>"))

(test reader.typed-access-goes-straight-to-the-type
  (is (eq 'geo:pt-x (nisp-read "!(PT x)")))
  (is (eq 'geo:pt-x (nisp-read "!_(pt X)")))
  (is (eq 'geo:pt-interval-dy (nisp-read "!(PT-INTERVAL dy)")))
  (is (eq 'part-angle (nisp-read "!(part angle)")))
  (is (eq (nisp-read "!_half") (nisp-read "!(part half)")))
  (is (eq (nisp-read "!_x") (nisp-read "!(UNHEARD-OF x)")))
  (signals-misread "!(PT)")
  (signals-misread "!_(PT x y)"))

(test reader.matchvars-are-objects-in-data
  (destructuring-bind (name . body) (nisp-read "(?name . ?body)")
    (is (nisp:matchvar-p name))
    (is (nisp:matchvar-p body))
    (is (eq (nisp-read "body") (nisp:matchvar-name body))))
  (let ((descriptor (nisp-read "((:capacity (0.1 9999)) (:lock-id ?x))")))
    (is (nisp:matchvar-p (second (second descriptor)))))
  (is (null (nisp:matchvar-name (nisp-read "?()"))))
  (is (equal (nisp-read "(?x ?())") (nisp-read "(?x ?( ))")))
  (is (not (nisp:matchvar-p (nisp-read "?"))))
  (signals-misread "?(x)")
  (signals-misread "?7"))

(test reader.matchvars-print-as-they-are-read
  (let ((*package* (find-package :ars-magna.tests.user)))
    (is (string= "(?X ?())" (prin1-to-string (nisp-read "(?x ?())"))))))

(test reader.matchvars-survive-a-compiled-file
  (uiop:with-temporary-file (:pathname source :type "lisp" :stream out :direction :output)
    (format out "(in-package :ars-magna.tests.user)
                 (defparameter cl-user::pattern '((:lock-id ?x) ?()))
                 (defun cl-user::read-x (p) !>p.x)")
    (finish-output out)
    (let* ((*readtable* (named-readtables:find-readtable :nisp))
           (*standard-output* (make-broadcast-stream))
           (fasl (compile-file source)))
      (load fasl)
      (delete-file fasl)))
  (is (equal (nisp-read "((:lock-id ?x) ?())") (symbol-value 'cl-user::pattern)))
  (is (= 4 (funcall 'cl-user::read-x (geo:make-pt 4 5)))))

(test reader.skips-what-features-exclude
  (is (equal '(1) (nisp-read "(#+(or) !>a.b #+(or) ?() #+(or) !(no such thing) #+(or) ?x 1)"))))

;;; Slots.

(test slots.read-and-set-by-every-syntax
  (dolist (place '("(!_x p)" "(!(PT x) p)" "(!_(PT x) p)" "!>p.x" "(slot-ref p 'x)"))
    (let ((p (geo:make-pt 1 2)))
      (is (= 1 (nisp-value (format nil "(lambda (p) ~A)" place) p)))
      (nisp-value (format nil "(lambda (p) (!= ~A 5))" place) p)
      (is (= 5 (geo:pt-x p)) "~A" place)
      (nisp-value (format nil "(lambda (p) (incf ~A))" place) p)
      (is (= 6 (geo:pt-x p)) "~A" place))))

(test slots.chain-through-objects
  (let ((box (nisp:make pt-interval (geo:make-pt 4 5) (geo:make-pt 1 2))))
    (is (= 1 (nisp-value "(lambda (box) !>box.x.min)" box)))
    (nisp-value "(lambda (box) (!= !>box.x.min 0 !>box.y.max 9))" box)
    (is (= 4 (nisp-value "(lambda (box) !>box.dx)" box)))
    (is (= 7 (nisp-value "(lambda (box) (!(PT-INTERVAL dy) box))" box)))))

(test slots.belong-to-subtypes-too
  (let ((wheel (make-wheel 8)))
    (is (= 8 (nisp-value "(lambda (w) (!_angle w))" wheel)))
    (is (= 8 (nisp-value "(lambda (w) (!(PART angle) w))" wheel)))
    (is (= 4 (nisp:slot-ref wheel "HALF")))
    (setf (nisp:slot-ref wheel :half) 10)
    (is (= 20 (nisp-value "(lambda (w) !>w.angle)" wheel)))
    (is (equal '("ANGLE" "FIXED" "HALF" "OWNER") (nisp:slot-names wheel)))))

(test slots.unknown-ones-are-named-with-those-there-are
  (handler-case (nisp-value "(lambda (p) !>p.z)" (geo:make-pt 1 2))
    (base:unknown-name (condition)
      (is (equal '("X" "Y") (slot-value condition 'basics::known)))
      (is (search "slot of a PT" (princ-to-string condition))))
    (:no-error (value) (fail "returned ~S" value)))
  (signals base:unknown-name (nisp:slot-ref 7 'x))
  (signals base:unknown-name (setf (nisp:slot-ref (geo:make-pt 1 2) 'z) 3)))

(test slots.computed-ones-cannot-be-set
  (signals base:misuse (setf (nisp:slot-ref (nisp:make pt-interval 1 2) 'dx) 3))
  (signals base:misuse (setf (nisp:slot-ref (make-wheel 8) 'fixed) 3)))

;;; Making.

(test make.knows-types-by-name
  (is (geo:equal (geo:make-pt 1 2) (nisp-value "(lambda () (make PT 1 2))")))
  (is (geo:equal (geo:make-interval 1 2) (nisp:make :interval 1 2)))
  (is (geo:equal (geo:make-pt-interval 1 2) (nisp:make-object "PT-INTERVAL" 1 2)))
  (is (eql 3 (part-owner (nisp:make part 1 3)))))

(test make.rejects-what-it-cannot-make
  (signals base:unknown-name (nisp:make unicorn 1 2))
  (signals base:misuse (nisp:make pt 1))
  (signals base:misuse (nisp:make pt 1 2 3))
  (signals base:misuse (nisp:make part 1 2 3))
  (signals base:wrong-argument (nisp:make interval 2 1)))

;;; Binding.

(test let.drops-types
  (is (equal '(nil nil 3)
             (nisp-value "(lambda ()
                            (let ((desig NIL) - (~ DESIGNATOR) (stop #F) - BOOLEAN (x 3))
                              (list desig stop x)))")))
  (is (eql 2 (nisp-value "(lambda () (let ((x 2) - (Lst PT)) x))")))
  (is (null (nisp-value "(lambda () (let (x - INTEGER y) (or x y)))"))))

(test let.takes-plain-forms-with-declarations
  (is (= 3 (nisp-value "(lambda (x) (let ((y x) z) (declare (fixnum y) (ignore z)) (+ y 1)))" 2)))
  (is (equal '(cl:let ((x 1)) (declare (special x)) x)
             (macroexpand-1 '(nisp:let ((x 1)) (declare (special x)) x)))))

(test typed-lists.reject-stray-hyphens
  (dolist (list '((- t x) (x -) (x - - t) (x - t - t) (&optional - t)))
    (signals base:malformed-definition (nisp:untyped-lambda-list list))
    (signals base:malformed-definition (nisp:untyped-bindings list)))
  (signals base:malformed-definition (nisp:untyped-lambda-list 'x))
  (signals base:malformed-definition (nisp:untyped-bindings 7)))

(test typed-lists.keep-keywords-and-defaults
  (is (equal '(a b &optional (c 1) &rest d &key (e 2) ((:f g) 3 g-p) &aux h)
             (nisp:untyped-lambda-list
              '(a - t b &optional (c 1) - integer &rest d - (lst t)
                &key (e 2) - pt ((:f g) 3 g-p) - (~ pt) &aux h))))
  (is (equal '(a b c d d-p g g-p h)
             (nisp:lambda-list-variables
              '(a &optional b (c 1) &key (d 2 d-p) ((:f g) 3 g-p) &aux h)))))

(test lambda.one-backslash-makes-a-typed-closure
  (is (= 7 (nisp-value "(lambda (n) (funcall (\\\\ (x - INTEGER &optional (y 4) - INTEGER)
                                                (+ x y n))
                                              1))"
                       2)))
  (is (eq 'nisp:\\ (nisp-read "\\\\")))
  (is (string= "\\" (symbol-name 'nisp:\\))))

(test continuation.takes-types-and-ignores-what-it-likes
  (is (null (funcall (nisp-value "(lambda () (continuation (err &rest fu) ()))") nil 1 2)))
  (is (= 5 (funcall (nisp-value "(lambda () (continuation (err - SYMBOL cam - CAMERA ang) ang))")
                    nil 'camera 5)))
  (is (null (funcall (nisp-value "(lambda () (continuation (err &key (a 1 a-p) ((:b c) 2))))")
                     :interrupt))))

(test deffunc-and-defproc.define-with-result-types
  (dolist (form '("(deffunc test-twice - INTEGER (x - INTEGER &key (times 2) - INTEGER)
                     \"Documented.\" (* times x))"
                  "(defproc test-twice - (~ INTEGER) (x &key (times 2))
                     \"Documented.\" (* times x))"
                  "(defproc test-twice (x &key (times 2)) \"Documented.\" (* times x))"))
    (handler-bind ((warning #'muffle-warning))
      (eval (nisp-read form)))
    (let ((name (nisp-read "test-twice")))
      (is (= 8 (funcall name 4)))
      (is (= 12 (funcall name 4 :times 3)))
      (is (string= "Documented." (documentation name 'function)))
      (fmakunbound name)))
  (signals base:malformed-definition (macroexpand-1 '(nisp:deffunc f - void)))
  (signals base:malformed-definition (macroexpand-1 '(nisp:defproc f - void x))))

(test types.are-types-of-the-host-too
  (is (typep '(1 2) '(nisp:lst integer)))
  (is (typep nil '(nisp:~ geo:pt)))
  (is (typep (geo:make-pt 1 2) '(nisp:~ geo:pt)))
  (is (not (typep 3 '(nisp:~ geo:pt))))
  (is (not (typep nil 'nisp:void)))
  (is (typep '((:color red)) 'nisp:thing-descriptor))
  (is (typep #'car 'nisp:robot-continuation)))

;;; Control.

(test if.takes-any-number-of-else-forms
  (let ((text "(lambda (x) (let ((n 0)) (values (if x :yes (incf n) (incf n) n) n)))"))
    (is (equal '(2 2) (multiple-value-list (nisp-value text nil))))
    (is (equal '(:yes 0) (multiple-value-list (nisp-value text t)))))
  (is (equal '(cl:if a b) (macroexpand-1 '(nisp:if a b))))
  (is (equal '(cl:if a b c) (macroexpand-1 '(nisp:if a b c)))))

(test loop.runs-a-body-until-or-while
  (is (= 3 (nisp-value "(lambda () (let ((n 0)) (loop UNTIL (= n 3) (incf n)) n))")))
  (is (= 3 (nisp-value "(lambda () (let ((n 0)) (loop while (< n 3) (nop) (incf n)) n))")))
  (is (= 3 (nisp-value "(lambda () (let ((n 0)) (loop :until (= (incf n) 3)) n))")))
  (is (= 4 (nisp-value "(lambda () (loop until nil (return 4)))"))))

(test loop.otherwise-is-that-of-common-lisp
  (is (equal '(1 3) (nisp-value "(lambda () (loop for x in '(1 2 3) if (oddp x) collect x))")))
  (is (equal '(2 1) (nisp-value "(lambda (n &aux l)
                                   (loop until (= n 2) do (push (incf n) l)) l)"
                                0)))
  (is (= 5 (nisp-value "(lambda (n) (loop (when (= (incf n) 5) (return n))))" 0)))
  (is (= 3 (nisp-value "(lambda (n) (loop while (< n 3) for i from 0 do (incf n)
                                          finally (return n)))"
                       0))))

(test !=.sets-several-places
  (is (equal '(1 2) (nisp-value "(lambda (a b) (!= a 1 b 2) (list a b))" 0 0))))

(test nop.returns-nothing
  (is (null (multiple-value-list (nisp:nop)))))

(test vref.reads-and-sets
  (let ((vector (vector 1 2 3)) (list (list 1 2 3)))
    (is (= 2 (nisp:vref vector 1) (nisp:vref list 1)))
    (setf (nisp:vref vector 2) 9 (nisp:vref list 2) 9)
    (is (equalp #(1 2 9) vector))
    (is (equal '(1 2 9) list))
    (signals base:wrong-argument (nisp:vref vector 3))
    (signals base:wrong-argument (nisp:vref vector 'one))
    (signals base:wrong-argument (nisp:vref 7 0))))

(test out.is-that-of-the-base
  (is (string= (format nil "turned 0.5~%")
               (with-output-to-string (*standard-output*) (nisp:out "turned " 0.5d0 t)))))

;;; Matching.

(defparameter *convex*
  "(lambda (win) (matchq ((?() t nil) ( t t nil) (nil nil nil)) win))")

(test matchq.matches-occupancy-windows
  (let ((match (nisp-function *convex*)))
    (is-true (funcall match '((t t nil) (t t nil) (nil nil nil))))
    (is-true (funcall match '((nil t nil) (t t nil) (nil nil nil))))
    (is-false (funcall match '((nil t nil) (t t nil) (nil t nil))))
    (is-false (funcall match '((nil t nil) (t t nil))))
    (is-false (funcall match '((nil t nil) (t t :wall) (nil nil nil))))
    (is-false (funcall match 7))))

(test matchq.sets-the-variables-when-all-matches
  (let ((match (nisp-function "(lambda (datum &aux (x 0) (y 0))
                                 (list (matchq (move ?x (?y . ?())) datum) x y))")))
    (is (equal '(t 5 b) (funcall match '(move 5 (b c)))))
    (is (equal '(nil 0 0) (funcall match '(move 5 b))))
    (is (equal '(nil 0 0) (funcall match '(move 5 (b c) d))))))

(test matchq.asks-the-same-again-of-a-repeated-matchvar
  (let ((match (nisp-function "(lambda (datum &aux x) (and (matchq (?x (?x)) datum) x))")))
    (is (equal '(a 1) (funcall match '((a 1) ((:a 1d0))))))
    (is (null (funcall match '((a 1) ((:a 2))))))))

(test matchq.compares-atoms-by-name-and-value
  (is-true (nisp-value "(lambda () (matchq (red 7.5 \"a\") '(cl-user::red 15/2 \"a\")))"))
  (is-false (nisp-value "(lambda () (matchq (red) '(blue)))"))
  (is-false (nisp-value "(lambda () (matchq (t) '(nil)))")))

(test matchq.evaluates-the-datum-once
  (is (= 1 (nisp-value "(lambda (&aux (n 0)) (matchq (1 1) (progn (incf n) '(1 1))) n)")))
  (is-true (nisp-value "(lambda () (matchq ?() 4))")))

;;; Loading.

(test dsklap.loads-files-and-rejects-what-is-not-there
  (uiop:with-temporary-file (:pathname source :type "lisp" :stream out :direction :output)
    (format out "(defparameter cl-user::loaded-by-dsklap 7)")
    (finish-output out)
    (is-true (nisp:dsklap (namestring (make-pathname :type nil :defaults source)))))
  (is (= 7 (symbol-value 'cl-user::loaded-by-dsklap)))
  (is-true (nisp:dsklap "ars-dir/alexandria"))
  (signals base:unknown-name (nisp:dsklap "ars-dir/no-such-system"))
  (signals base:wrong-argument (nisp:dsklap 7)))

(test reader.passes-over-a-byte-order-mark
  (is (equal '(1 2) (nisp-read (format nil "~A(1 2)" (code-char #xFEFF))))))
