;;;; definitions.lisp -- what users define: finding, redefining, undefining, names, mistakes.

(in-package :ars-magna.tests)

(def-suite* definitions :in ars-magna)

;;; A small world that has something of each kind.

(defun define-all-kinds ()
  "Define something of each kind under names of our own."
  (mapc #'eval
        '((world:def-place-type niche (cell) :check-matchers ((((* * *) (* - *) (x - x)) 1)))
          (world:defattribute :shape (cube ball) :noticed 1)
          (world:defsubstance marble 44)
          (world:defkicker nudge (thing) (:prob .5) (world:kick-thing thing .1 0 nil))
          (world:defmap shed (10 8)
            (rect (0 0) (10 8) bricks 1)
            (obj (crate :kickers (nudge)) (5 5) ((:size 2) (:shape cube))))
          (robot:defrobot mole (shed (2 2) 0) :cameras ((3 5)) :hands (9))
          (command:defmanipulation dust (it - () :by hand) () (values nil it))
          (rpl:def-interp-proc doze () 7))))

(defmacro with-all-kinds (&body body)
  `(with-own-definitions (define-all-kinds) ,@body))

(defparameter *kinds*
  '((world:find-map shed shde) (world:find-place-type niche nich)
    (world:find-attribute :shape :shap)
    (world:find-substance marble marbel) (world:find-kicker nudge nudg)
    (robot:find-robot mole mola) (command:find-manipulation dust dusk)
    (rpl:find-procedure doze dose) (base:find-parameter "max-speed*" "max-sped*")
    (command:find-command command:robot-turn robot-trun))
  "Finders, a name that each knows, and one like it that it does not.")

(test finders.find-by-name-or-tell-the-nearest
  (with-all-kinds
    (loop for (finder name slip) in *kinds*
          for object = (funcall finder name)
          do (is (not (null object)))
             (is (eq object (funcall finder (string name))) "~A by a string" finder)
             (is (eq object (funcall finder (intern (string name) :cl-user))) "~A" finder)
             (is (null (funcall finder slip nil)))
             (handler-case (progn (funcall finder slip) (fail "~A found ~A" finder slip))
               (base:unknown-name (condition)
                 (is (search (format nil "Did you mean ~(~A~)?" name)
                             (princ-to-string condition))))))))

(test finders.take-what-they-return
  (with-all-kinds
    (dolist (finder '(world:find-map world:find-kicker world:find-place-type robot:find-robot
                      world:find-substance command:find-manipulation))
      (let ((object (funcall finder (second (assoc finder *kinds*)))))
        (is (eq object (funcall finder object)))))))

(test listers.list-in-order-of-definition
  (with-all-kinds
    (eval '(world:defmap shed-2 (4 4)))
    (eval '(world:defmap shed (9 9)))
    (is (equal '(shed shed-2) (mapcar #'world:map-name (last (world:all-maps) 2))))
    (is (eq (robot:find-robot 'mole) (first (last (robot:all-robots)))))
    (is (eq (command:find-manipulation 'dust) (first (last (command:all-manipulations)))))
    (is (eq (rpl:find-procedure 'doze) (first (last (rpl:all-procedures)))))))

;;; Undefining.

(test undefine.forgets-each-kind
  (with-all-kinds
    (loop for (kind finder name) in '((robot robot:find-robot mole) (map world:find-map shed)
                                      (place-type world:find-place-type niche)
                                      (attribute world:find-attribute :shape)
                                      (substance world:find-substance marble)
                                      (kicker world:find-kicker nudge)
                                      (manipulation command:find-manipulation dust)
                                      (procedure rpl:find-procedure doze))
          do (is (eq name (base:undefine kind name)))
             (is (null (funcall finder name nil)) "~A" kind)
             (signals base:unknown-name (base:undefine kind name)))
    (is (notany #'boundp '(shed nudge mole)))
    (is (not (fboundp 'doze)))))

(test undefine.keeps-what-the-simulator-needs
  (signals base:misuse (base:undefine 'parameter 'max-speed*))
  (signals base:misuse (base:undefine 'command 'robot-turn))
  (handler-case (base:undefine 'gadget 'shed)
    (base:unknown-name (condition)
      (is (search "kicker" (princ-to-string condition)))
      (is (not (search "argument" (princ-to-string condition)))))
    (:no-error (name) (fail "undefined ~A" name))))

(test undefine.ends-the-run-of-a-robot
  (with-all-kinds
    (let ((robot (robot:find-robot 'mole)))
      (base:undefine 'map 'shed)
      (signals base:misuse (command:robot-turn robot 1))
      (signals base:unknown-name (run:call-with-simulation (constantly nil) '(mole))))))

;;; Keeping.

(test own-definitions.are-gone-and-others-back
  (with-all-kinds
    (let ((map (world:find-map 'shed)) (robot (robot:find-robot 'mole)) (count 0))
      (flet ((kick-with (body) (world:define-kicker 'nudge :body body)))
        (kick-with (lambda (thing) (declare (ignore thing)) (incf count)))
        (ignore-errors
         (base:with-own-definitions ()
           (kick-with #'identity)
           (eval '(world:defmap shed (5 5)))
           (eval '(world:defmap annexe (5 5)))
           (eval '(rpl:def-interp-proc doze () 8))
           (eval '(command:defmanipulation dust (it - ((:size 1)) :by hand) ()))
           (base:undefine 'place-type 'niche)
           (error "out")))
        (is (eq map (world:find-map 'shed)))
        (is (eq map (symbol-value 'shed)))
        (is (not (boundp 'annexe)))
        (is (eq robot (symbol-value 'mole)))
        (is (= 7 (rpl:run-plan-alone 'doze)))
        (is (= 1 (length (command::manipulation-methods (command:find-manipulation 'dust)))))
        (is (not (null (world:find-place-type 'niche nil))))
        (run:with-simulation (mole :seed 1)
          (command:robot-turn (symbol-value 'mole) 1)
          (run:run-ticks 40))
        (is (plusp count) "the kicker is as it was")))))

(defvar *one-thing* 1)
(defvar *another-thing* 2)

(test own-definitions.set-back-what-is-current-in-whatever-order
  "A file that is loaded again meanwhile may list the variables in another order."
  (let ((base:*variables-to-restore* (list* '*one-thing* '*another-thing*
                                             base:*variables-to-restore*)))
    (base:with-own-definitions ()
      (setf *one-thing* 3)
      (setf base:*variables-to-restore* (reverse base:*variables-to-restore*)))
    (is (equal '(1 2) (list *one-thing* *another-thing*)))))

(test own-definitions.can-be-made-again
  (with-own-definitions
    (base:with-own-definitions () (define-all-kinds))
    (is (null (world:find-map 'shed nil)))
    (define-all-kinds)
    (is (= 7 (rpl:run-plan-alone 'doze)))))

;;; Files.

(defun call-with-file (function text)
  "Call FUNCTION with a Lisp file that holds TEXT, to be read in the tests' package."
  (uiop:with-temporary-file (:pathname path :stream stream :type "lisp")
    (write-string text stream)
    :close-stream
    (funcall function path)))

(defun rewrite (path text)
  "Let the file PATH hold TEXT, as an editor does: a reader of the old file still reads that."
  (with-open-file (out path :direction :output :if-exists :rename-and-delete)
    (write-string text out)))

(defun load-here (path)
  (let ((*package* (find-package :ars-magna.tests))
        (*error-output* (make-broadcast-stream)))
    (load path)))

(test redefinition.says-so-if-another-file-had-it
  (with-own-definitions
    (let ((text "(world:defmap shed (5 5)) (world:defkicker nudge (thing) () thing)"))
      (call-with-file
       (lambda (one)
         (is (null (warnings-of (lambda () (load-here one) (load-here one)))))
         (call-with-file
          (lambda (other)
            (let ((warnings (warnings-of (lambda () (load-here other)))))
              (is (= 2 (length warnings)))
              (is (search (namestring (truename one)) (first warnings)))
              (is (search (namestring (truename other)) (first warnings)))))
          text))
       text))))

(test manipulation.edited-in-its-file-leaves-nothing-behind
  "Reading 174, revised; a narrower pattern must not leave the wider one as it was."
  (with-own-manipulations
    (flet ((method-text (size result)
             (format nil "(command:defmanipulation poke (it - ((:size ~A)) :by hand) ()
                            (values nil ~A))" size result))
           (poke () (outcome-of 'poke (designate 'apple) (hand 0))))
      (call-with-file
       (lambda (path)
         (load-here path)
         (is (equal '(nil 1) (poke)))
         (rewrite path (method-text "(2 9)" 2))
         (load-here path)
         (is (equal '(:failed nil) (poke)))
         (world:set-attribute (thing 'apple) :size 3)
         (is (equal '(nil 2) (poke)))
         (rewrite path (format nil "~A ~A" (method-text "(0 9)" 3) (method-text "(2 9)" 4)))
         (load-here path)
         (is (equal '(nil 4) (poke)) "the later one")
         (load-here path)
         (is (equal '(nil 4) (poke)) "also when nothing has changed"))
       (method-text "(0 9)" 1)))))

(test manipulation.stays-if-loading-its-file-fails
  (with-own-manipulations
    (let ((text "(command:defmanipulation poke (it - ((:size 1)) :by hand) () (values nil 1))
                 (command:defmanipulation poke (it - ((:size 2)) :by hand) (~A) (values nil 2))"))
      (flet ((poke (size)
               (world:set-attribute (thing 'apple) :size size)
               (outcome-of 'poke (designate 'apple) (hand 0))))
        (call-with-file
         (lambda (path)
           (load-here path)
           (rewrite path (format nil text ":success 3"))
           (signals base:malformed-definition (load-here path))
           (is (equal '(nil 1) (poke 1)))
           (is (equal '(nil 2) (poke 2)) "the old one, as there is no new one"))
         (format nil text ""))))))

(test place-type.before-others
  (with-own-definitions
    (eval '(world:def-place-type any (cell) :check-matchers ((((-)) 1)) :before world:concave))
    (let ((map (map-of 5 5 '(rect (0 0) (5 5) bricks 1))))
      (is (equal "ANY" (first (place-at map 1 1)))))
    (is (= 2 (world:place-type-rank (world:find-place-type 'any))))
    (eval '(world:def-place-type all (cell) :check-matchers ((((-)) 2)) :before t))
    (is (= 0 (world:place-type-rank (world:find-place-type 'all))))
    (is (equal "ALL" (first (place-at (world:rebuild-map (world:find-map 'test-map)) 1 1))))
    (is (search "doorway" (complaint-about '(world:def-place-type far (cell)
                                             :check-matchers ((((-)) 1)) :before dorway))))))

(test defrobot.settled-by-several-threads-is-one-robot
  "They all come where the robots of that name are taken out before one goes on."
  (with-own-definitions ()
    (world:defmap settled-yard (9 9))
    (robot:defrobot settler (settled-yard (3 3) 0))
    (let* ((blueprint (robot::find-blueprint 'settler))
           (world (robot:robot-world (symbol-value 'settler)))
           (go-on (base:make-semaphore "settle"))
           (arrived (base:make-semaphore "arrived"))
           (threads '()))
      (robot::remove-robots-named 'settler "test")
      (host:wrap-function 'robot::remove-robots-named
                          (lambda (remove-robots-named &rest arguments)
                            (apply remove-robots-named arguments)
                            (base:signal-semaphore arrived)
                            (base:wait-on-semaphore go-on 10))
                          'test)
      (unwind-protect
           (progn
             (setf threads (loop repeat 3
                                 collect (base:start-thread
                                          (lambda () (robot:ensure-resident-robot blueprint))
                                          "settler")))
             (loop repeat 3 do (base:wait-on-semaphore arrived 10))
             (loop repeat 3 do (base:signal-semaphore go-on))
             (mapc #'base:join-thread threads))
        (host:unwrap-function 'robot::remove-robots-named 'test))
      (is (= 1 (count 'settler (world:world-robots world) :key #'robot:robot-name))))))
