;;;; rpl-text.lisp -- messages about a plan's text before it runs, and documentation of plans.

(in-package :ars-magna.tests)
(in-suite rpl)

;;; Files. The notes about a file are a list of pairs: the form that the compiler points at, as
;;; text, and the message.

(defun call-in-own-package (function)
  "Call FUNCTION while there is an empty package for texts, which is current."
  (let ((*package* (find-package :ars-user)))
    (eval '(ars:define-user-package :ars-test-texts)))
  (unwind-protect (let ((*package* (find-package :ars-test-texts))) (funcall function))
    (delete-package :ars-test-texts)))

(defun what-is-said (warning)
  "Return what the compiler points at, as text, and what WARNING says."
  (let ((context (host:error-context)))
    (cons (and context (prin1-to-string (host:context-original-form context)))
          (princ-to-string warning))))

(defun said (function)
  "Call FUNCTION, which compiles or loads. Return what it warns of, in order."
  (let ((said '()) (*error-output* (make-broadcast-stream)))
    (handler-bind ((warning (lambda (warning)
                              (push (what-is-said warning) said)
                              (muffle-warning warning))))
      (base:with-own-definitions () (funcall function)))
    (nreverse said)))

(defun call-with-files (function texts)
  "Call FUNCTION with the names of files that have TEXTS, in a package of their own."
  (if (null texts)
      (call-in-own-package function)
      (uiop:with-temporary-file (:pathname path :stream out :type "lisp")
        (write-string (first texts) out)
        :close-stream
        (call-with-files (lambda (&rest paths) (apply function path paths)) (rest texts)))))

(defun compiled (path)
  "Compile the file PATH; keep nothing. Return what COMPILE-FILE does."
  (uiop:with-temporary-file (:pathname fasl :type "fasl")
    (compile-file path :output-file fasl :verbose nil :print nil)))

(defun said-compiling (&rest texts)
  "Return what is said when files of TEXTS are compiled together."
  (call-with-files (lambda (&rest paths)
                     (said (lambda () (with-compilation-unit () (mapc #'compiled paths)))))
                   texts))

(defun said-loading (text)
  (call-with-files (lambda (path) (said (lambda () (load path)))) (list text)))

(defparameter *going* "(def-interp-proc going (place &key (speed 1))
                         (wait-time speed) (list place))"
  "A plan to be called.")

(defparameter *slips*
  '(("(goign 1)" "there is no plan procedure or function goign. Did you mean going?")
    ("(going)" "going takes (place &key (speed 1)), not 0 arguments.")
    ("(going 1 2)" "going takes (place &key (speed 1)), not 2 in place of a keyword.")
    ("(going 1 :speed)" "going takes (place &key (speed 1)), not a keyword without a value.")
    ("(going 1 :sped 2)" "not :sped (did you mean :speed?).")
    ("(later 1 2)" "later takes (x), not 2 arguments.")
    ("(lisp-later)" "not 0 arguments.")
    ("(macro-later 1)" "is a macro that is defined only after this call.")
    ("(car 1 2)" "called with two arguments")
    ("(find 1 (list 2) :tset #'eql)" ":TSET is not a known")
    ("(list no-such-variable)" "undefined variable: ARS-TEST-TEXTS::NO-SUCH-VARIABLE")
    ("(mapcar #'no-such-function (list 1))" "undefined function: ARS-TEST-TEXTS::NO-SUCH-FUNC")
    ("(+ 1 \"a\")" "conflicts with its asserted type")
    ("(let ((idle 1)) (wait-time 2))" "the variable idle is never used"))
  "Slips in a plan, and what is said of them.")

(defun text-with (slip)
  (format nil "~A(def-interp-proc slipping ()
                 (wait-time 1)
                 (par (wait-time 1)
                          (seq (wait-time 1)
                                   ~A
                                   (wait-time 2))))
               (def-interp-proc later (x) (wait-time x))
               (defun lisp-later (x) x)
               (defmacro macro-later (x) x)"
          *going* slip))

(defun same-text-p (text form)
  "True if TEXT is that of a form which prints as FORM, whatever packages its symbols are in."
  (flet ((plain (text)
           (let ((*package* (find-package :ars-user)))
             (string-downcase (prin1-to-string (read-from-string text))))))
    (string= (remove-packages (plain text)) (remove-packages (string-downcase form)))))

(defun remove-packages (text)
  "Return the text TEXT without the names of packages and breaks."
  (let ((words (uiop:split-string (substitute #\Space #\Newline text))))
    (format nil "~{~A~^ ~}"
            (loop for word in words
                  for start = (position-if-not (lambda (char) (find char "(#'")) word)
                  for colon = (and start (position #\: word :from-end t :start start))
                  unless (string= "" word)
                    collect (if (and colon (< start colon))
                                (concatenate 'string (subseq word 0 start)
                                             (subseq word (1+ colon)))
                                word)))))

(test text.slips-are-warnings-where-they-stand
  (loop for (slip expected) in *slips*
        do (loop for (said . how) in (list (cons (said-compiling (text-with slip)) "compiled")
                                           (cons (said-loading (text-with slip)) "loaded"))
                 for (form . text) = (find expected said :key #'cdr :test #'search)
                 do (is (and form (same-text-p slip form)) "~A, ~A: ~S" slip how said)
                    (is (= 1 (length said)) "~A, ~A: ~S" slip how said))))

(test text.a-malformed-construct-is-a-warning-where-it-stands
  (loop for (slip expected) in '(("(wait-for f :timout 3)" ":timout (did you mean :timeout?)")
                                 ("(wait-time)" "(wait-time span &key unit)")
                                 ("(if 1 (wait-time 1) 2 3)" "(if test then [else])"))
        for said = (said-compiling (text-with slip))
        do (is (same-text-p slip (car (first said))) "~S" said)
           (is (search expected (cdr (first said))) "~S" said)))

(test text.what-only-lisp-runs-cannot-wait
  (loop for (slip place expected)
          in '(("(mapcar (lambda (x) (later x)) (list 1))" "(later x)" "later is a plan procedure")
               ("(mapcar (lambda (x) (wait-for x)) (list 1))" "(wait-for x)"
                "A plan cannot wait inside lambda"))
        for (form . text) = (find expected (said-compiling (text-with slip))
                                  :key #'cdr :test #'search)
        do (is (and form (same-text-p place form)) "~S: ~S ~S" slip form text)))

(test text.what-is-right-is-silent
  (let ((right "(def-interp-proc first-of-two (x &rest more) (second-of-two x) (list more)
                  (flet ((wait (n) (wait-time n) n)) (helping (wait 1) :b 2))
                  (let ((unused 1)) (declare (ignore unused)) (wait-time 1) `(a ,more)))
                (def-interp-proc second-of-two (x &optional y) (wait-time x)
                  (when y (first-of-two x 1 2 3)))
                (defun helping (a &key (b 1)) (list a b))"))
    (is (null (said-compiling right)))
    (is (null (said-loading right)))
    (is (null (said-compiling "(def-interp-proc one () (wait-time 1) (two 1))"
                              "(def-interp-proc two (x) (wait-time x) (one))"))
        "files that are compiled together")))

(test text.a-file-with-slips-has-failed
  (flet ((outcome (text)
           (let ((values '()))
             (call-with-files (lambda (path)
                                (said (lambda ()
                                        (setf values (multiple-value-list (compiled path))))))
                              (list text))
             (rest values))))
    (is (equal '(nil nil) (outcome (text-with "(going 1)"))))
    (is (equal '(t nil) (outcome (text-with "(goign 1)"))) "it may yet come")
    (is (equal '(t t) (outcome (text-with "(going)"))))))

(test text.the-prompt-tells-what-a-file-needs
  (uiop:with-temporary-file (:pathname path :stream out :type "lisp")
    (format out "(def-interp-proc going (x) (gonig x)~@
                   (later x))~@
                 (def-interp-proc later () (wait-time 1))")
    :close-stream
    (base:with-own-definitions ()
      (let ((lines (type-batch (format nil "(load ~S)" (uiop:native-namestring path)))))
        (is-true (find-if (lambda (line)
                            (and (search "line 1): there is no plan procedure" line)
                                 (search "Did you mean going?" line)))
                          lines)
                 "~S" lines)
        (is-true (find-if (lambda (line) (search "line 2): later takes (), not 1 arg" line)) lines)
                 "~S" lines)))))

;;; At run time.

(rpl:def-interp-proc asked-for (a &key b) (rpl:wait-time 1) (list a b))

(test arguments.that-do-not-fit-are-told-in-our-words
  (let ((plan (handler-bind ((warning #'muffle-warning))
                (eval '(rpl:interp-lambda () (asked-for 1 :c 2))))))
    (loop for (function expected)
          in `((,(lambda () (rpl:run-plan-alone 'asked-for)) "(a &key b), not 0 arguments")
               (,(lambda () (rpl:run-plan-alone 'asked-for :arguments '(1 2 3)))
                "not 2")
               (,(lambda () (rpl:start-plan (rpl:make-plan-runner) 'asked-for 1 :bb 2))
                "not :bb (did you mean :b?)")
               (,(lambda () (error (rpl:lisp-failure-condition
                                    (plan-failure-of (rpl:call-plan 'asked-for)))))
                "not 0 arguments")
               (,(lambda () (error (rpl:lisp-failure-condition (rpl:run-plan-alone plan))))
                "not :c (did you mean :b?)"))
          do (handler-case (progn (funcall function) (fail "nothing was signalled"))
               (base:wrong-argument (condition)
                 (is (search expected (princ-to-string condition)) "~A" condition))))
    (is (equal '(1 2) (plan-value (asked-for 1 :b 2))))))

;;; Those who look it up.

(defun introspect (name &rest arguments)
  (require :sb-introspect)
  (apply #'uiop:symbol-call :sb-introspect name arguments))

(rpl:def-interp-macro (three-times ?what then . ?body) `(progn ,what ,@body))

(defun arglist (name)
  "Return the lambda list of NAME as editors show it."
  (string-downcase (let ((*package* (find-package :ars-magna.tests)))
                     (format nil "~:A" (mapcar (lambda (part)
                                                 (if (symbolp part) (symbol-name part) part))
                                               (introspect '#:function-lambda-list name))))))

(test arglists.are-those-of-the-author
  (loop for (name expected) in '((asked-for "(a &key b)")
                                 (three-times "(what then &body body)")
                                 (rpl:wait-for "(fluent &key timeout)")
                                 (rpl:whenever "(fluent &body body)")
                                 (rpl:n-times "(count &body body)")
                                 (rpl:def-interp-proc "(name parameters &body body)")
                                 (driver:rpl-camera-turn "(camera angle)"))
        do (is (string= expected (arglist name))))
  (is (search "(A &KEY B)" (with-output-to-string (*standard-output*) (describe 'asked-for)))))

(test sources.are-found
  (loop for (name kind file) in '((asked-for :function "rpl-text")
                                  (three-times :macro "rpl-text")
                                  (rpl:wait-for :macro "waiting")
                                  (rpl:par :macro "branches")
                                  (driver:rpl-camera-turn :function "commands"))
        for sources = (introspect '#:find-definition-sources-by-name name kind)
        for path = (and sources (introspect '#:definition-source-pathname (first sources)))
        do (is (and path (string= file (pathname-name path))) "~S: ~S" name path)))

(test constructs.expand-without-an-error
  (let ((count 0))
    (do-external-symbols (symbol :ars-magna.rpl)
      (when (and (macro-function symbol)
                 (not (base:lisp-symbol-p symbol))
                 (member (package-name (symbol-package symbol))
                         '("ARS-MAGNA.RPL.CONSTRUCTS" "ARS-MAGNA.RPL.LANGUAGE") :test #'string=)
                 (eq '&body (first (introspect '#:function-lambda-list symbol))))
        (incf count)
        (is (consp (macroexpand-1 (list symbol '(a) '(b)))) "~S" symbol)))
    (is (plusp count)))
  (dolist (form '((rpl:wait-for f) (rpl:wait-time 1) (rpl:seq 1 2) (rpl:par 1 2) (rpl:retry)
                  (rpl:whenever f 1) (rpl:n-times 2 1) (rpl:with-policy a b)
                  (rpl:def-interp-proc expanding () (rpl:wait-time 1))
                  (rpl:interp-lambda () (rpl:wait-time 1))
                  (rpl:def-interp-macro (expanding ?x) x)))
    (is (consp (macroexpand-1 form)) "~S" form))
  (signals base:misuse (eval '(rpl:par 1 2))))

;;; Conditions.

(test conditions.a-vector-of-fluents-is-none
  (refuses base:malformed-definition (rpl:wait-for driver:camera-moved*))
  (refuses base:malformed-definition
    (rpl:wait-for (and (not driver:hand-moved*) driver:robot-stopped*)))
  (refuses base:malformed-definition (rpl:whenever driver:camera-moved* 1))
  (refuses base:malformed-definition (if driver:camera-error* (rpl:wait-time 1)))
  (refuses base:malformed-definition (list (if driver:camera-error* 1 2)))
  (refuses base:malformed-definition (loop until driver:camera-error* (rpl:wait-time 1)))
  (handler-case (macroexpand-1 '(rpl:interp-lambda (c) (rpl:wait-for driver:hand-moved*) c))
    (base:malformed-definition (trouble)
      (is (search "(vref hand-moved* hand)" (princ-to-string trouble)))))
  (let ((vector (rpl:create-fluent-vector "door-open" 2)))
    (macrolet ((refused (&body body)
                 `(is (search "(vref door-open index)"
                              (princ-to-string (rpl:lisp-failure-condition
                                                (plan-failure-of ,@body)))))))
      (refused (rpl:wait-for vector))
      (refused (rpl:wait-for (not vector)))
      (refused (rpl:wait-for (and vector (rpl:create-fluent 'x))))
      (refused (rpl:whenever vector 1))
      (refused (if vector (rpl:wait-time 1)))
      (refused (when vector 1))
      (refused (cond ((null vector) 1)))
      (refused (loop while vector (rpl:wait-time 1)))
      (refused (mapcar (lambda (f) (if f 1 2)) (list vector))))
    (is (= 2 (plan-value (rpl:wait-time 1) (length vector))))
    (is (eq :yes (plan-value (if #(1 2) :yes :no))) "other vectors are true")))

(test conditions.mean-the-same-in-leaves-and-lambdas
  (let* ((f (fluent nil)) (g (fluent 3)) (net (rpl:fl-funcall #'evenp g)))
    (is (equal '(:no (2 1) (:odd) nil 0 1)
               (plan-value
                 (rpl:wait-time 1)
                 (list (if f :yes :no)
                       (mapcar (lambda (x) (if x 1 2)) (list f g))
                       (mapcar (lambda (x) (if (not x) :odd :even)) (list net))
                       (when net 1)
                       (loop until g count t)
                       (loop for x in (list f g) when x count t)))))
    (is (eq t (plan-value (rpl:fluent-value (null f)))))
    (is (eq :none (plan-value (if (null f) :none :some))))
    (is (null (plan-value (null (rpl:fluent-value g)))))))

(test case.reads-its-key-by-value
  (let ((g (fluent 3)))
    (is (equal '(:three :three :three (:three))
               (plan-value (list (case g (3 :three)) (ecase g (3 :three)) (ccase g (3 :three))
                                 (mapcar (lambda (x) (case x (3 :three))) (list g))))))
    (is (eq :waited (plan-value (ecase g (3 (rpl:wait-time 1) :waited) (4 1)))))
    (is (typep (rpl:lisp-failure-condition
                (plan-failure-of (ecase g (4 (rpl:wait-time 1)))))
               'type-error))))

;;; Fluents given to what takes values.

(defun doubts-about (&rest body)
  "Return what is said of a plan with BODY."
  (mapcar #'cdr (said-loading (format nil "(def-interp-proc doubtful (c) (wait-time 1)
                                             ~{~A ~} (list c))"
                                      body))))

(test known-fluents.are-told-from-values
  (loop for (form expected)
          in '(("(car robot-arrived-at*)" "(fluent-value robot-arrived-at*)")
               ("(zerop (vref camera-error* c))" "(fl-funcall #'zerop ...)")
               ("(string= robot-place* c)" "string= cannot take")
               ("(member c robot-place*)" "member cannot take")
               ("(1+ (+ robot-angle-diff* 1))" "1+ cannot take")
               ("(max 1 (create-fluent 'x 1))" "max cannot take")
               ("(let ((f (create-fluent 'f 1))) (wait-time 1) (zerop f))" "zerop")
               ("(let* ((f (state 'f)) (g (not f))) (wait-time 1) (cdr g))" "cdr")
               ("(mapcar (lambda (x) (list x (car robot-place*))) (list 1))" "car"))
        for doubts = (doubts-about form)
        do (is (= 1 (length doubts)) "~A: ~S" form doubts)
           (is (search expected (or (first doubts) "")) "~A: ~S" form doubts)))

(test known-fluents.what-takes-anything-is-silent
  (dolist (form '("(list robot-place* (cons 1 robot-place*))"
                  "(print robot-place* (make-broadcast-stream))"
                  "(format nil \"~A\" robot-place*)"
                  "(find robot-place* (list 1))"
                  "(eq robot-place* 1)"
                  "(null (fluent-value robot-place*))"
                  "(length camera-error*)"
                  "(let ((f (state 'f))) (wait-time 1) (setf f (list 1)) (car f))"
                  "(let ((f (state 'f))) (wait-time 1) (list f)
                     (let ((f '(1))) (wait-time 1) (car f))
                     (mapcar (lambda (f) (car f)) '((1))))"
                  "(rpl-robot-turn robot-angle-diff*)"))
    (is (null (doubts-about form)) "~A: ~S" form (doubts-about form))))

;;; Counts and patterns.

(test n-times.needs-a-count
  (is (search "n-times: count is NIL"
              (princ-to-string (rpl:lisp-failure-condition
                                (plan-failure-of (rpl:n-times (rpl:wait-time 1)))))))
  (is (= 3 (plan-value (let ((n (fluent 3))) (rpl:n-times n (rpl:wait-time 1))) (rpl:plan-time)))))

(test def-interp-macro.patterns-have-an-end
  (loop for pattern in (list '#1=(m x . #1#) '(m . #2=(x #2#))
                             `(m ,@(loop repeat 100000 collect 'x))
                             `(m ,(let ((deep 'x))
                                    (dotimes (i 100000 deep) (setf deep (list deep))))))
        do (signals base:malformed-definition
             (macroexpand-1 `(rpl:def-interp-macro ,pattern 1)))))
