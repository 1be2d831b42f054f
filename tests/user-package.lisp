;;;; user-package.lisp -- users' packages, and names in several of them.

(in-package :ars-magna.tests)

(def-suite* user-package :in ars-magna)

;;; Packages.

(defun define-home (options)
  "Define a user's package with OPTIONS, from where no layer goes by a nickname. Return it."
  (let ((*package* (find-package :ars-user)))
    (eval `(ars:define-user-package :ars-test-home ,@options))))

(defmacro with-user-package ((package &rest options) &body body)
  "Run BODY with PACKAGE bound to one that DEFINE-USER-PACKAGE makes by OPTIONS."
  `(let ((,package (define-home '(,@options))))
     (unwind-protect (progn ,@body)
       (delete-package ,package))))

(defun means (name package)
  "Return the symbol that NAME is in PACKAGE, as (package symbol), or NIL."
  (let ((symbol (find-symbol name package)))
    (and symbol (package-name (symbol-package symbol)))))

(test user-package.is-ready-to-work-in
  (with-user-package (package (:export #:kitchen))
    (is (equal '("COMMON-LISP" "ARS-MAGNA.COMMAND" "ARS-MAGNA.NISP")
               (loop for name in '("CAR" "ROBOT-TURN" "VREF") collect (means name package))))
    (is (eq :external (nth-value 1 (find-symbol "KITCHEN" package))))
    (is (eq (find-package :ars-magna.canvas)
            (cdr (assoc "XLIB" (sb-ext:package-local-nicknames package) :test #'string=))))))

(test user-package.settles-all-clashes
  (flet ((shadowed (package) (sort (mapcar #'symbol-name (package-shadowing-symbols package))
                                   #'string<)))
    (with-user-package (package)
      (is (equal '("EQUAL" "IF" "LET" "LOOP" "MAP") (shadowed package)))
      (is (equal (shadowed :ars-user) (shadowed package)))
      (is (eq 'nisp:loop (find-symbol "LOOP" package)))
      (is (eq 'geo:equal (find-symbol "EQUAL" package))))
    (with-user-package (package (:use :cl :ars))
      (is (equal '("EQUAL" "MAP") (shadowed package)))
      (is (eq 'loop (find-symbol "LOOP" package)))
      (is (null (means "VREF" package))))
    (with-user-package (package (:use :cl :ars) (:use :nisp) (:shadow #:map)
                                (:shadowing-import-from :cl #:loop))
      (is (string= "ARS-TEST-HOME" (means "MAP" package)))
      (is (eq 'loop (find-symbol "LOOP" package)))
      (is (eq 'nisp:if (find-symbol "IF" package))))
    (with-user-package (package (:use))
      (is (null (shadowed package))))))

(test user-package.may-use-the-shipped-worlds
  (with-user-package (package (:use :cl :ars :nisp :ars-worlds))
    (is (eq 'ars-worlds:fetch-thing (find-symbol "FETCH-THING" package)))))

(test user-package.passes-other-options-on
  (with-user-package (package (:documentation "Mine.") (:nicknames :ars-test-hut)
                              (:local-nicknames (:xlib :cl)) (:import-from :ars-worlds #:table*))
    (is (string= "Mine." (documentation package t)))
    (is (eq package (find-package :ars-test-hut)))
    (is (eq 'ars-worlds:table* (find-symbol "TABLE*" package)))
    (is (equal (list (cons "XLIB" (find-package :cl))) (sb-ext:package-local-nicknames package)))))

(test user-package.can-be-defined-again
  (with-user-package (package (:export #:kitchen) (:use :cl :ars :nisp))
    (handler-bind ((warning (lambda (warning) (fail "~A" warning))))
      (is (eq package (define-home '((:export #:kitchen) (:use :cl :ars :nisp)))))
      (import 'ars-worlds:robbie package)
      (is (eq package (define-home '((:export #:kitchen) (:use :cl :ars :nisp))))))))

(test user-package.says-what-makes-no-sense
  (signals base:malformed-definition
    (macroexpand-1 '(ars:define-user-package :ars-test-home :export)))
  (signals base:malformed-definition
    (macroexpand-1 '(ars:define-user-package :ars-test-home (:use :no-such-package)))))

(test user-package.says-which-names-clash
  (unwind-protect
       (progn
         (intern "FAIL" (make-package :ars-test-other :use '()))
         (export (find-symbol "FAIL" :ars-test-other) :ars-test-other)
         (handler-case (define-home '((:use :cl :ars-test-other :nisp)))
           (base:malformed-definition (condition)
             (is (search "(:shadowing-import-from :ars-test-other #:fail)"
                         (princ-to-string condition))))
           (:no-error (package) (delete-package package) (fail "no clash")))
         (with-user-package (package (:use :cl :ars-test-other :nisp)
                                     (:shadowing-import-from :nisp #:fail))
           (is (eq 'rpl:fail (find-symbol "FAIL" package)))))
    (delete-package :ars-test-other)))

;;; What the system itself brings.

(defparameter *what-is-defined*
  "(flet ((defined-p (symbol)
            (and (eq (symbol-package symbol) (find-package :ars-user))
                 (or (boundp symbol) (fboundp symbol)
                     (sb-ext:valid-type-specifier-p symbol)))))
     (prin1 (list (find-package :ars-worlds)
                  (loop for symbol being the symbols of :ars-user
                        when (defined-p symbol) collect symbol)
                  (ars-magna.world:all-maps) (ars-magna.world:all-kickers)
                  (ars-magna.robot:all-robots) (ars-magna.command:all-manipulations)
                  (ars-magna.rpl:all-procedures)
                  (ars-magna.world:find-attribute :locked nil)
                  (ars-magna.world:find-attribute :lit nil))))"
  "Prints lists of what there is besides the manual's world.")

(defparameter *plain-core* sb-ext:*core-pathname*
  "The core of SBCL itself, in which the tests were loaded. They run in another.")

(defun printed-in-child (system form)
  "Return what FORM, a string, prints in a fresh Lisp that has loaded SYSTEM."
  (uiop:run-program
   (list (namestring sb-ext:*runtime-pathname*) "--core" (namestring *plain-core*)
         "--noinform" "--no-sysinit" "--no-userinit" "--non-interactive"
         "--load" (uiop:native-namestring (project-file "cli/build.lisp"))
         "--eval" (format nil "(let ((*standard-output* (make-broadcast-stream)))
                                 (asdf:load-system ~S))" system)
         "--eval" form)
   :output :string :error-output :interactive))

(test user-package.nothing-is-in-it-at-first
  (is (string= "(NIL NIL NIL NIL NIL NIL NIL NIL NIL)"
               (printed-in-child "ars-magna" *what-is-defined*))))

(defparameter *core-then-all*
  "(flet ((users ()
            (list (find-symbol \"FIND-WAY\" :ars)
                  (mapcar #'first (ars-magna.base:all-definitions :kicker))
                  (mapcar #'third (ars-magna.base:all-definitions :kicker)))))
     (eval '(ars:defkicker ars-user::sway (ars-user::thing) (:prob 1/2) nil))
     (eval '(ars:defmap ars-user::hut (9 9)))
     (eval '(ars:defrobot ars-user::tom (ars-user::hut (4 4) 0)))
     (prin1 (list (remove nil (mapcar #'find-package '(:chipz :lparallel :ars-magna.plots)))
                  (users)
                  (eval '(ars:with-simulation (ars-user::tom :clean t)
                          (nisp:rpl-init-robot ars-user::tom)
                          (nisp:run-plan (nisp:interp-lambda ()
                                           (nisp:seq (nisp:rpl-robot-turn 1)
                                                     (nisp:wait-for nisp:robot-stopped*))))
                          (list (plusp (ars:robot-angle ars-user::tom))
                                (stringp (ars:text-map ars-user::tom)))))
                  (let ((*standard-output* (make-broadcast-stream)))
                    (asdf:load-system :ars-magna)
                    (users)))))"
  "Prints what there is when the core is loaded, and after all of the simulator.")

(test core.can-be-loaded-alone-and-then-the-rest
  (is (string-equal "(nil (nil (ars-user::sway) (nil)) (t t)
 (ars-magna.ways:find-way (ars-user::sway) (nil)))"
                    (printed-in-child "ars-magna/core" *core-then-all*))))

;;; Plans of the same name in several packages.

(rpl:def-interp-proc ars-user::echo-name () :user)
(rpl:def-interp-proc echo-name () :tests)
(rpl:def-interp-proc ars-user::ask-both () (list (ars-user::echo-name) (echo-name)))

(test names.of-plans-are-names
  (is (eq (rpl:find-procedure 'ars-worlds:fetch-thing) (rpl:find-procedure 'fetch-thing)))
  (is (eq (rpl:find-procedure 'ars-worlds:fetch-thing) (rpl:find-procedure "fetch-thing")))
  (dolist (name '(no-such-plan-anywhere nil 5))
    (signals base:unknown-name (rpl:find-procedure name))))

(test names.of-plans-mean-the-very-symbol-or-the-newest
  (flet ((package-of (name)
           (package-name (symbol-package (rpl:procedure-name (rpl:find-procedure name))))))
    (is (string= "ARS-USER" (package-of 'ars-user::echo-name)))
    (is (string= "ARS-MAGNA.TESTS" (package-of 'echo-name)))
    (is (string= "ARS-MAGNA.TESTS" (package-of :echo-name)))
    (eval '(rpl:def-interp-proc ars-user::echo-name () :user))
    (is (string= "ARS-USER" (package-of :echo-name)))
    (eval '(rpl:def-interp-proc echo-name () :tests))
    (is (string= "ARS-MAGNA.TESTS" (package-of :echo-name)))))

(test names.in-plans-are-symbols
  (is (equal '(:user :tests) (rpl:run-plan-alone 'ask-both))))

(defmacro with-plan-of-users ((name parameters &body body) &body forms)
  "Run FORMS while there is a plan NAME of PARAMETERS and BODY."
  `(unwind-protect (progn (eval '(rpl:def-interp-proc ,name ,parameters ,@body)) ,@forms)
     (fmakunbound ',name)))

(test names.of-users-plans-do-not-disturb-the-shipped
  (with-plan-of-users (ars-user::travel-to (&rest ways) (rpl:fail :class :users-own :data ways))
    (is (not (eq (rpl:find-procedure 'ars-user::travel-to)
                 (rpl:find-procedure 'ars-worlds:travel-to))))
    (run:with-simulation (ars-worlds:marvin :seed 1 :clean t)
      (is (eq :succeeded (nth-value 1 (driver:run-plan 'ars-user::fetch-thing
                                                       '((:color world:blue)
                                                         (:substance world:plastic))
                                                       '((109 24))))))
      (is (eq :failed (nth-value 1 (driver:run-plan 'ars-user::travel-to)))))))

(test names.called-in-vain-are-told-where-they-are
  (eval '(rpl:def-interp-proc ask-in-vain () (ask-both)))
  (multiple-value-bind (failure state) (with-messages (rpl:run-plan-alone 'ask-in-vain))
    (is (eq :failed state))
    (is-true (has-words-p (princ-to-string failure) "no plan" "ARS-USER::ASK-BOTH"))))
