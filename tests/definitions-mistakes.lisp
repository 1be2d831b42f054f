;;;; definitions-mistakes.lisp -- mistakes in definitions are reported with clause, file and line.

(in-package :ars-magna.tests)

(in-suite definitions)

(defun complaints (&rest forms)
  "Return the texts of what evaluating FORMS, in turn, signals: NIL for each that is fine."
  (with-own-definitions
    (loop for form in forms
          collect (handler-case
                      (handler-bind ((base:definition-warning #'muffle-warning))
                        (eval form)
                        nil)
                    (base:ars-magna-error (condition) (princ-to-string condition))))))

(test mistakes.are-refused
  (loop for (form . expected)
          in '(((world:defattribute :temp '(a b c)) . "an unquoted list")
               ((world:defattribute :temp (numeric)) . "without parentheses")
               ((world:defattribute :size (small large)) . "a numeric attribute")
               ((world:defattribute :closed numeric) . "a discrete attribute")
               ((world:defmap m (9 9) (obj box (1 1) ((:color puce)))) . "one of red")
               ((world:defmap m (9 9) (obj box (1 1) ((:color gren)))) . "did you mean green?")
               ((world:defmap m (9 9) (obj box (1 1) ((:mood 'good)))) . "an unquoted value")
               ((world:defmap m (9 9) (wal (1 1) (3 1) bricks 2)) . "did you mean wall?")
               ((world:defmap m (9 9) '(wall (1 1) (3 1) bricks 2)) . "a clause without a quote")
               ((world:defmap m (9 9) (wall '(1 1) (3 1) bricks 2)) . "Write it without quotes")
               ((world:defmap m (9 9) . 7) . "a form that is a proper list")
               ((world:defsubstance marble)
                . "defsubstance marble: there is nothing, or NIL, in place of a number as the ")
               ((command:defmanipulation m (x - () :by hand - HAND) (:delay 1 :delay 2))
                . "each option only once")
               ((world:defmap) . "(defmap name &optional size")
               ((world:defkicker) . "(defkicker name lambda-list &optional options")
               ((world:new-thing box) . "new-thing name location descriptor")
               ((let ((x 1)) (world:new-thing box x)) . "new-thing name location descriptor")
               ((world:new-thing lid . #2=((m 1 1) . #2#)) . "a form that is a proper list")
               ((world:new-thing lid (m 1 1 . 2) ()) . "a location")
               ((robot:defrobot #3=(r . #3#)) . "a form that is a proper list")
               ((rpl:def-interp-proc p (a &optional "x") 1) . "is no symbol")
               ((rpl:def-interp-proc p () (3 4)) . "(3 4)")
               ((rpl:def-interp-macro . #4=((m x) . #4#)) . "a form that is a proper list")
               ((progn (rpl:def-interp-macro (m for x) ''x) (rpl:def-interp-proc p () (m for)))
                . "(m for x)")
               ((ars:define-user-package :p (:size -1)) . "-1")
               ((ars:define-user-package :p (:export . 7)) . "forms that Lisp can compile")
               ((ars:define-user-package :p (:import-from :cl #:no-such)) . "NO-SUCH")
               ((world:defmap m (9 9) (obj (box :prototype no-such*) (1 1) ())) . "NO-SUCH*")
               ((world:defmap m (9 9) (obj (box :prototype 7) (1 1) ())) . "a thing, made by")
               ((world:defmap m (9 9) (obj (box :kickers (ncuk)) (1 1) ())) . "no kicker called")
               ((world:def-place-type p (cell) :checker t :directions 1) . "four values")
               ((world:def-place-type p (cell) :check-matchers ((((-)) 1)) :directions 1)
                . "two values")
               ((world:def-place-type p (cell) :check-matchers ((((-)) 1))
                 :directions (values 1 'up)) . "two values")
               ((world:def-place-type p (cell) :check-matchers ((((-)) 1))
                 :directions (car cell)) . "code that runs")
               ((command:defmanipulation m (it - ((:size (5 3))) :by hand) ()) . "lower end first")
               ((rpl:def-interp-proc "p" () 1) . "a symbol")
               ((world:defmap yard) . "(width height)")
               ((robot:defrobot nobody) . "(environment (x y) angle)")
               ((world:defattribute :q) . "NUMERIC or a list")
               ((world:defsubstance jelly) . "a number as the parameter")
               ((world:defsubstance aether #.sb-ext:double-float-positive-infinity) . "a number")
               ((world:defkicker k (x) (set-attribute x :size 3)) . "(set-attribute x :size 3)")
               ((world:defmap m (9 9) . #1=((wall (1 1) (2 2) bricks 1) . #1#)) . "a proper list")
               ((world:defmap m (9 9)
                 (obj box (1 1) ((:size #.sb-ext:double-float-positive-infinity))))
                . "a number"))
        do (let ((complaint (first (complaints form))))
             (is (and complaint (search expected complaint)) "~S: ~A" form complaint))))

(test mistakes.of-robots-are-refused
  (loop for (form . expected)
          in '(((robot:defrobot r (m (1 1) no-such-angle)) . "NO-SUCH-ANGLE")
               ((robot:defrobot r (m (1 1) 0) :hands (no-such-hand)) . "NO-SUCH-HAND")
               ((robot:defrobot r (m (5.5 5.5) 0)) . "inside a wall")
               ((robot:defrobot r (m (50 5) 0)) . "outside the map, which is 9 by 9")
               ((robot:defrobot r (mm (5 5) 0)) . "a map:")
               ((robot:defrobot r (m (5 5) 0) :arms (5)) . ":cameras"))
        do (let ((complaint (second (complaints '(world:defmap m (9 9) (wall (5 5) (5 5) bricks 1))
                                                form))))
             (is (and complaint (search expected complaint)) "~S: ~A" form complaint))))

(defun doubts (&rest forms)
  "Return the texts of the warnings that evaluating FORMS gives."
  (with-own-definitions
    (warnings-of (lambda () (mapc #'eval forms)))))

(test mistakes.that-may-be-none-are-warned-of
  (loop for (expected . forms)
          in '(("goes beyond" (world:defmap m (9 9) (wall (3 3) (12 3) bricks 1)))
               ("goes beyond" (world:defmap m (9 9) (circle (3 3) 5 bricks 1)))
               ("goes beyond" (world:defmap m (9 9) (rect (-1 0) (5 5) bricks 1)))
               ("inside a wall" (world:defmap m (9 9) (wall (3 3) (5 3) bricks 1)
                                  (obj box (4.5 3.5) ())))
               ("did you mean :color?" (world:defmap m (9 9) (obj box (4 4) ((:colour red)))))
               ("did you mean :color?" (world:new-thing box nil ((:colour red))))
               ("did you mean :weight?" (command:defmanipulation m (it - ((:weigth 1)) :by hand)
                                            ())))
        do (let ((doubts (apply #'doubts forms)))
             (is (= 1 (length doubts)) "~S: ~S" forms doubts)
             (is (search expected (first doubts)))))
  (is (null (doubts '(world:defmap m (9 9) (rect (0 0) (9 9) bricks 1) (circle (4 4) 4 bricks 1)
                      (obj box (2 2) ((:lock-id 3) (:shape round) (:haunts nil))))))
      "what is on the edge, and names that are merely not declared"))

(test circles.however-large-take-no-time
  "All of a circle that lies outside is pressed against the edge."
  (with-own-definitions
    (handler-bind ((base:definition-warning #'muffle-warning))
      (let ((edge (wall-picture (map-of 7 5 '(rect (0 0) (7 5) bricks 1)))))
        (dolist (radius '(30 100 1e9 1d300))
          (is (equal edge (wall-picture (map-of 7 5 `(circle (3 2) ,radius bricks 1))))))
        (is (equal (wall-picture (map-of 7 5 '(circle (3 2) 11 bricks 1))) edge))))))

;;; Specifications.

(test specifications.reversed-ranges-are-refused
  (is-true (robot:specification-p '((:size (3 5)) (:numbers (1 2)))))
  (is-false (robot:specification-p '((:size (5 3)))))
  (is-false (robot:specification-p '((:numbers (2 1)))) "also of attributes not declared")
  (is-false (robot:specification-p '((:substance (90 20)))))
  (is-true (robot:specification-p '((:substance (wood metal))))))

(test specifications.names-of-nobodys-are-warned-of-once
  (with-own-definitions
    (eval '(world:defmap shed (9 9) (obj crate (5 5) ((:size 2) (:shape round)))))
    (eval '(robot:defrobot seer (shed (4 4) 0) :cameras ((6.28 5))))
    (run:call-with-simulation
     (lambda ()
       (flet ((look (specification)
                (robot:look-for-things (camera-of 'seer) :non-local specification)
                (mapcar #'base:message-text (base:take-messages))))
         (is (null (look '((:shape round)))) "carried by something")
         (is (null (look '((:color red)))) "declared")
         (is (search "did you mean :color?" (first (look '((:colour red))))))
         (is (null (look '((:colour blue)))) "not twice")
         (is (search ":mood" (first (look '((:mood sad))))))))
     '(seer) :clean t)))

;;; In files.

(defun file-complaint (text)
  "Return what loading a file that holds TEXT complains of."
  (with-own-definitions
    (call-with-file (lambda (path)
                      (handler-case (progn (load-here path) nil)
                        (base:malformed-definition (condition) (princ-to-string condition))))
                    text)))

(test mistakes.in-files-are-told-with-their-line
  (loop for (line . text)
          in '((4 . "; a comment (with (parentheses
(world:defmap m (9 9)
  (rect (0 0) (9 9) bricks 1)
  (wall (3 3) 5 bricks 1)
  (wall (3 3) (5 5) bricks 1))")
               (3 . "(world:defmap m (9 9)
  (rect (0 0) (9 9) bricks 1)
  (obj (box :prototype no-such*) (4 4) ()))")
               (4 . "
(world:defmap m (9 9))
(robot:defrobot r (m (4 4) 0)
  :hands (-3))")
               (2 . "(world:defattribute :shape (round square)
  :success 7)")
               (2 . "(defvar *box*
  (world:new-thing box nil (:size 4)))")
               (3 . "(world:defkicker push (thing)
  ()
  (world:kick-thing thing 1 0 nil))
(world:defkicker pull (thing) (:porb 1) nil)"))
        do (let ((complaint (file-complaint text)))
             (is (search (format nil "line ~D)" (if (search ":porb" text) 4 line)) complaint)
                 "~A" complaint))))

(defun call-choosing (restart function &rest values)
  "Call FUNCTION; a malformed definition is answered by RESTART with VALUES."
  (handler-bind ((base:malformed-definition
                   (lambda (condition)
                     (apply #'invoke-restart (find-restart restart condition) values))))
    (funcall function)))

(defparameter *leaky-shed* "(world:defmap shed (9 9)
  (wall (1 1) (1 5) bricks 1)
  (wall (2 2) 7 bricks 1)
  (obj (box :prototype no-such*) (4 4) ())
  (obj bag (5 2) ()))")

(test restarts.leave-clauses-out
  (with-own-definitions
    (call-with-file (lambda (path) (call-choosing 'base:skip-clause (lambda () (load-here path))))
                    *leaky-shed*)
    (let ((shed (world:find-map 'shed)))
      (is (world:wall-at-p shed 1 3))
      (is (not (world:wall-at-p shed 2 2)))
      (is (equal '("BAG#1") (mapcar #'princ-to-string
                                    (world:world-thing-list (world:make-world shed))))))))

(test restarts.take-other-clauses
  (with-own-definitions
    (call-with-file
     (lambda (path)
       (handler-bind ((base:malformed-definition
                        (lambda (condition)
                          (use-value (if (search "wall" (princ-to-string condition))
                                         '(wall (2 2) (7 7) bricks 1)
                                         '(obj box (4 5) ()))
                                     condition))))
         (load-here path)))
     *leaky-shed*)
    (let ((shed (world:find-map 'shed)))
      (is (world:wall-at-p shed 7 7))
      (is (equal '("BOX#1" "BAG#2") (mapcar #'princ-to-string
                                            (world:world-thing-list (world:make-world shed))))))))

(test restarts.read-clauses-again
  (with-own-definitions
    (call-with-file
     (lambda (path)
       (handler-bind ((base:malformed-definition
                        (lambda (condition)
                          (rewrite path "(world:defmap shed (9 9)
  (wall (1 1) (1 5) bricks 1)
  (wall (2 2) (2 7) bricks 1)
  (obj sack (4 4) ())
  (obj bag (5 2) ()))")
                          (invoke-restart (find-restart 'base:read-again condition)))))
         (load-here path)))
     *leaky-shed*)
    (let ((shed (world:find-map 'shed)))
      (is (world:wall-at-p shed 2 7))
      (is (equal '("SACK#1" "BAG#2") (mapcar #'princ-to-string
                                             (world:world-thing-list (world:make-world shed))))))))

(test restarts.deal-with-whole-definitions
  (with-own-definitions
    (eval '(world:defmap shed (9 9)))
    (call-with-file
     (lambda (path)
       (call-choosing 'base:skip-definition (lambda () (load-here path)))
       (is (null (robot:find-robot 'mole nil)))
       (call-choosing 'use-value (lambda () (load-here path)) '(robot:defrobot mole (shed (3 3) 0)))
       (is (= 3 (robot:robot-x (robot:find-robot 'mole))))
       (handler-bind ((base:malformed-definition
                        (lambda (condition)
                          (rewrite path "(robot:defrobot mole (shed (4 4) 0))")
                          (invoke-restart (find-restart 'base:read-again condition)))))
         (load-here path))
       (is (= 4 (robot:robot-x (robot:find-robot 'mole)))))
     "(robot:defrobot mole (shed (33 3) 0))")))

(test mistakes.of-lisp-are-told-as-ours
  "A variable or function that is not there is named, with the definition that wants it."
  (loop for (form . expected)
          in '(((world:defkicker k (x) (:prob no-such-prob) nil) . "NO-SUCH-PROB")
               ((world:defattribute :t (a b) :success no-such) . "NO-SUCH")
               ((world:defsubstance s no-such) . "NO-SUCH")
               ((command:defmanipulation m (:by hand) (:delay (no-such-function)) nil)
                . "NO-SUCH-FUNCTION")
               ((world:def-place-type p (cell) :check-matchers ((((-)) north))) . "NORTH"))
        do (let ((complaint (first (complaints form))))
             (is (and complaint (search expected complaint)) "~S: ~A" form complaint))))

(test mistakes.in-patterns
  (loop for (clause . expected) in '(((:color rd) . "did you mean red?")
                                     ((:color (red bleu)) . "did you mean blue?")
                                     ((:size (1 2 3)) . "a range")
                                     ((:size small) . "a number")
                                     ((:color ?color) . "(in-readtable :nisp)"))
        do (let ((complaint (first (complaints `(command:defmanipulation m (it - (,clause) :by hand)
                                                 () nil)))))
             (is (and complaint (search expected complaint)) "~S: ~A" clause complaint)))
  (is (equal '(nil) (complaints '(command:defmanipulation m
                                  (it - ((:color (red blue)) (:closed nil) (:size 3)) :by hand)
                                  () nil)))))

(test mistakes.in-specifications-name-the-part
  (with-own-definitions
    (eval '(world:defmap shed (9 9)))
    (eval '(robot:defrobot seer (shed (4 4) 0) :cameras ((1 5))))
    (handler-case (command:camera-get-object-designator (camera-of 'seer) :local
                                                        '((:size 3) (:color rd)))
      (base:wrong-argument (condition)
        (is (search "not (:color rd)" (princ-to-string condition)))
        (is (search "did you mean red?" (princ-to-string condition))))
      (:no-error (&rest values) (fail "accepted: ~S" values)))))

(test mistakes.inside-other-forms-are-told-as-ours
  (loop for form in '((progn (world:defmap m (9 9) (wal (1 1) (2 2) bricks 1)))
                      (let ((x 1)) (world:defmap m (9 9) (wal (1 1) (2 2) bricks 1)) x)
                      (funcall (lambda () (world:defmap m (9 9) (wal (1 1) (2 2) bricks 1)))))
        do (is (search "a clause: wall" (first (complaints form))) "~S" form)))

(test mistakes.of-a-dot-in-a-clause-are-told-as-such
  (dolist (clause '((wall (1 1) (2 2) . bricks) (obj pot (1 1) . 5) (rect . 5)))
    (is (search "a clause without a dot before its last element"
                (first (complaints `(world:defmap m (9 9) ,clause))))
        "~S" clause))
  (is (search "a clause: wall" (first (complaints '(world:defmap m (9 9) (wal . 5)))))))

(test mistakes.in-use-value-are-asked-about-again
  (with-own-definitions
    (let ((values '((wal (1 1) (2 2) bricks 1) (wall (1 1) (2 2) bricks 1))))
      (handler-bind ((base:malformed-definition
                       (lambda (condition)
                         (invoke-restart (find-restart 'use-value condition) (pop values)))))
        (eval '(world:defmap m (9 9) (oops))))
      (is (null values))
      (is (= 1 (length (world::map-clauses (world:find-map 'm))))))))

(test mistakes.of-slips-are-no-other-words
  (is (null (doubts '(world:defmap m (9 9) (obj box (4 4) ((:height 3) (:side 2) (:lock 1)))))))
  (is (= 1 (length (doubts '(world:defmap m (9 9) (obj box (4 4) ((:weihgt 3))))))))
  (is (= 1 (length (doubts '(world:defmap m (9 9) (obj box (4 4) ((:ize 3))))))))
  (dolist (slip '(:sise :zize :colur :coler :kolor))
    (is (= 1 (length (doubts `(world:defmap m (9 9) (obj box (4 4) ((,slip 3))))))) "~A" slip))
  (dolist (word '(:side :sine :site :dolor :hue))
    (is (null (doubts `(world:defmap m (9 9) (obj box (4 4) ((,word 3)))))) "~A" word))
  (let ((doubts (doubts '(world:defsubstance limestone 5)
                        '(world:defmap m (9 9) (wall (1 1) (2 2) limstone 1)
                          (wall (3 3) (4 4) ivory 1)))))
    (is (= 1 (length doubts)))
    (is (search "did you mean limestone?" (first doubts)))))

(test mistakes.are-where-code-is-not-where-words-are
  "A definition that a comment or a string shows is not the one that is wrong."
  (is (search "line 4)" (file-complaint "; (world:defmap m (9 9) (wal (1 1)))
#| (world:defmap m (9 9)) |#
(defparameter *ars-test-text* \"(world:defmap m (9 9)\")
(world:defmap m (9 9) (wal (1 1)))"))))

(test mistakes.attributes-that-no-longer-fit-are-told
  (with-own-definitions
    (eval '(world:defattribute :mood (good bad)))
    (eval '(world:defmap shed (9 9) (obj crate (4 4) () (imp ((:mood good))))))
    (let ((warnings (warnings-of (lambda () (eval '(world:defattribute :mood (happy sad)))))))
      (is (= 1 (length warnings)))
      (is (search "imp" (first warnings))))
    (is (null (warnings-of (lambda () (eval '(world:defattribute :mood (good sad)))))))))

(test mistakes.in-the-second-of-a-name-are-told-with-its-line
  (is (search "line 3)" (file-complaint "(world:defmap m (9 9))
(robot:defrobot fred (m (5 5) 0))
(robot:defrobot fred (m (6 6) 0) :hnds (10))"))))

(test restarts.read-the-right-one-of-a-name-again
  (with-own-definitions
    (call-with-file
     (lambda (path)
       (handler-bind ((base:malformed-definition
                        (lambda (condition)
                          (rewrite path "(world:defmap m (9 9))
(robot:defrobot fred (m (5 5) 0))
(robot:defrobot fred (m (6 6) 0) :hands (10))")
                          (invoke-restart (find-restart 'base:read-again condition)))))
         (load-here path)))
     "(world:defmap m (9 9))
(robot:defrobot fred (m (5 5) 0))
(robot:defrobot fred (m (6 6) 0) :hnds (10))")
    (is (= 6 (robot:robot-x (robot:find-robot 'fred))))))

(test restarts.take-just-the-clause
  (with-own-definitions
    (eval '(world:defmap m (9 9)))
    (call-choosing 'use-value (lambda () (eval '(robot:defrobot fred (m (50 5) 0)))) '(5 5))
    (is (= 5 (robot:robot-x (robot:find-robot 'fred))))))

(test restarts.take-whole-definitions-for-clauses
  (with-own-definitions
    (call-choosing 'use-value (lambda () (eval '(world:defmap m (9 9) (wal (1 1) (2 2) bricks 1))))
                   '(world:defmap m (5 5)))
    (is (= 5 (world:map-width (world:find-map 'm))))))

(test restarts.do-not-mistake-the-name-for-the-clause
  "An error of the author's is not the name's."
  (with-own-definitions
    (signals base:misuse
      (call-choosing 'use-value (lambda () (eval '(world:defsubstance s1 (error "oops")))) 4))
    (is (null (world:find-substance 's1 nil)))))

(test restarts.leave-out-contents-alone
  (with-own-definitions
    (call-choosing 'base:skip-clause
                   (lambda () (eval '(world:defmap m (9 9)
                                      (obj box (5 5) ((:size 9)) (can ((:color rd)))
                                       (pan ((:size 1))))))))
    (is (equal '("PAN#1" "BOX#2")
               (mapcar #'princ-to-string
                       (world:world-thing-list (world:make-world (world:find-map 'm))))))))

(test restarts.are-public
  (dolist (name '("SKIP-CLAUSE" "SKIP-DEFINITION" "READ-AGAIN"))
    (is (eq :external (nth-value 1 (find-symbol name :ars))))))
