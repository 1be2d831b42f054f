;;;; definitions-names.lisp -- names of Common Lisp, users' own words, and package locks.

(in-package :ars-magna.tests)

(in-suite definitions)

;;; Names of Common Lisp's.

(test names.of-common-lisp-need-no-variable
  (with-own-definitions
    (mapc #'eval
          '((world:defkicker open (box) () (world:set-attribute box :closed nil))
            (world:defkicker step (thing) (:prob 1) (world:kick-thing thing .1 0 nil))
            (world:defmap room (10 10)
              (rect (0 0) (10 10) bricks 1)
              (obj (box :kickers (open step)) (5.5 5.5) ((:closed t) (:capacity 3))))
            (robot:defrobot resident (room (2 2) 0) :hands (5))))
    (is (eq 'room (world:map-name (world:find-map 'room))))
    (is (not (boundp 'room)))
    (run:with-simulation (resident :seed 1)
      (let ((box (world:find-thing 'box)))
        (run:run-ticks 3)
        (is (null (world:get-attribute box :closed)))
        (is (< 5.79 (world:thing-x box) 5.81))
        (eval '(world:new-thing pin (room 3 4) ()))
        (is (= 3 (world:thing-x (world:find-thing 'pin))))))))

(test names.of-maps-are-no-variables-unless-they-are
  "A lexical variable called as a map, or as a symbol of Common Lisp's, is a variable."
  (with-own-definitions
    (eval '(world:defmap room (10 10)))
    (eval '(world:defmap floor (5 5)))
    (eval '(let ((room (world:find-map 'floor)))
            (world:new-thing pin (room 3 4) ())))
    (is (eq (world:find-map 'floor)
            (world:world-map (world:thing-world (world:find-thing 'pin (world:find-map 'floor))))))
    (is (null (world:find-thing 'pin (world:find-map 'room))))))

(test names.of-robots-must-be-variables
  (with-own-definitions
    (eval '(world:defmap room (10 10)))
    (let ((text (complaint-about '(robot:defrobot max (room (2 2) 0)))))
      (is (search "MAX belongs to COMMON-LISP" text))
      (is (search "(:shadow #:max)" text)))
    (is (search "ROBOT belongs to" (complaint-about '(robot:defrobot robot:robot
                                                      (room (2 2) 0)))))))

(defconstant +ars-test-limit+ 5)
(define-symbol-macro ars-test-alias (car '(1)))

(test names.of-robots-are-no-constants-nor-macros
  (with-own-definitions
    (eval '(world:defmap room (10 10)))
    (flet ((complaint (name) (complaint-about `(robot:defrobot ,name (room (2 2) 0)))))
      (is (search "is a constant" (complaint '+ars-test-limit+)))
      (is (search "is a symbol macro" (complaint 'ars-test-alias)))
      (is (search "a symbol with a home package" (complaint (make-symbol "NOBODY")))))))

(test simulator.takes-the-name-of-a-map
  (with-own-definitions
    (eval '(world:defmap room (10 10)))
    (signals base:misuse (run:simulator 'room))
    (signals base:unknown-name (run:simulator 'rom))
    (eval '(robot:defrobot resident (room (2 2) 0)))
    (unwind-protect
         (dolist (designator (list 'room "ROOM" (world:find-map 'room) 'resident))
           (is (eq (robot:find-robot 'resident) (run:simulator designator :display nil)))
           (is (time:live-p (time:current-simulation))))
      (run:stop-simulator))))

(test names.are-known-from-any-package
  "A robot, map or kicker is found by the symbol in the caller's package."
  (with-own-definitions
    (eval '(world:defmap shed (10 10)))
    (eval '(robot:defrobot cl-user::mole (cl-user::shed (2 2) 0)))
    (is (eql 9 (eval '(run:with-simulation (mole :seed 9)
                        (and (eq mole (robot:find-robot 'mole))
                             (eq mole cl-user::mole)
                             (world:world-seed world:*world*))))))))

;;; What is ours cannot be redefined by accident.

(test names.of-ours-are-locked
  (dolist (form '((defun geo:add (a b) (list a b)) (defvar rpl:state 1)
                  (defstruct rpl:task x) (defmacro nisp:out (x) x)))
    (signals sb-ext:package-lock-violation
      (let ((*package* (find-package :ars-user))) (eval form)))))

;;; Words. The author of a world, and any caller, get back symbols of their packages.

(defmacro with-packages ((author asker) &body body)
  "Run BODY with two packages that know nothing of ours."
  `(let ((,author (make-package "ARS-TEST-AUTHOR" :use '(:cl)))
         (,asker (make-package "ARS-TEST-ASKER" :use '(:cl))))
     (unwind-protect (progn ,@body)
       (delete-package ,asker)
       (delete-package ,author))))

(defun form-in (package text)
  (let ((*package* package)) (read-from-string text)))

(defun eval-in (package text)
  (let ((*package* package)) (eval (read-from-string text))))

(defparameter *gaudy-world*
  "(progn
     (ars:defmap gaudy (12 12)
       (rect (0 0) (12 12) bricks 1)
       (obj ball (6 8) ((:color red) (:substance (wood 3)) (:size 2)))
       (obj bell (8 6) ((:color green) (:substance metal) (:size 2))))
     (ars:defrobot seer (gaudy (6 6) 0) :cameras ((6.28 5))))")

(defun words-in (data)
  "Return the symbols in the description DATA that are neither keywords nor truth values."
  (loop for (nil value) in data
        append (remove-if (lambda (word)
                            (or (not (symbolp word)) (keywordp word) (member word '(t nil))))
                          (if (consp value) value (list value)))))

(defun descriptions (specification)
  "Return what the camera of SEER reports in 300 searches of a noisy world."
  (loop repeat 150
        append (mapcar #'robot::sighting-data
                       (append (robot:look-for-things (camera 0) :non-local specification :all t)
                               (robot:look-for-things (camera 0) :local specification :all t)))))

(defun camera-of (name)
  (robot:robot-camera (robot:find-robot name) 0))

(test words.are-those-of-the-worlds-author
  (with-own-definitions
    (with-packages (author asker)
      (eval-in author *gaudy-world*)
      (run:call-with-simulation
       (lambda ()
         (let ((words (loop repeat 200
                            append (loop for sighting
                                           in (robot:look-for-things (camera-of 'seer) :non-local
                                                                     '() :all t)
                                         append (words-in (robot::sighting-data sighting))))))
           (is (< 100 (length words)))
           (is (< 6 (length (remove-duplicates words))) "some are misread")
           (is (null (remove author words :key #'symbol-package)))))
       "SEER" :seed 5))))

(test words.are-those-of-who-asks
  (with-own-definitions
    (with-packages (author asker)
      (eval-in author *gaudy-world*)
      (run:call-with-simulation
       (lambda ()
         (loop for text in '("((:color (red green violet)))" "((:substance (wood metal glass)))")
               for specification = (form-in asker text)
               for key = (first (first specification))
               do (let ((values (loop repeat 100
                                      append (loop for sighting
                                                     in (robot:look-for-things
                                                         (camera-of 'seer) :non-local
                                                         specification :all t)
                                                   collect (assoc key (robot::sighting-data
                                                                       sighting))))))
                    (is (< 20 (length values)))
                    (is (null (remove asker (words-in values) :key #'symbol-package))))))
       "SEER" :seed 6))))

(test words.of-places-too
  (with-own-definitions
    (with-packages (author asker)
      (eval-in author *gaudy-world*)
      (eval-in author "(ars:defmap gaudy (12 12) (rect (0 0) (12 12) bricks 1)
                                                 (rect (8 8) (9 9) bricks 1))")
      (run:call-with-simulation
       (lambda ()
         (let ((sightings (robot:look-for-places (camera-of 'seer) (world:find-place-type 'convex)
                                                 :all t
                                                 :name (form-in asker "convex"))))
           (is (equal (list (form-in asker "convex"))
                      (robot::sighting-data (first sightings)))))
         (let ((seer (robot:find-robot 'seer)) (names '()))
           (robot:place-robot seer 1.5 1.5 0)
           (command:robot-place seer (lambda (code robot name)
                                       (declare (ignore code robot))
                                       (push name names)))
           (run:run-ticks 3)
           (is (equal (list (form-in author "concave")) names))))
       "SEER" :seed 1 :clean t))))

;;; Attributes.

(test attributes.stay-in-the-worlds-that-have-them
  "A declared boolean is noticed only where some thing starts with it, or of what has it."
  (with-own-definitions
    (eval '(world:defattribute :lit (t nil) :noticed 1))
    (eval '(world:defmap dark (9 9) (obj crate (5 5) ((:size 2)))))
    (eval '(world:defmap bright (9 9) (obj crate (5 5) ((:size 2))) (obj lamp (5 5) ((:lit t)))))
    (loop for (map . expected) in '((dark) (bright t))
          do (eval `(robot:defrobot seer (,map (4 4) 0) :cameras ((6.28 5))))
             (run:call-with-simulation
              (lambda ()
                (let ((data (robot::sighting-data
                             (first (robot:look-for-things (camera-of 'seer) :non-local
                                                           '((:size 2)))))))
                  (is (eq (first expected) (and (assoc :lit data) t)) "in ~A" map)))
              '(seer) :clean t))))

;;; Several packages, and several kinds, of one name.

(test names.live-side-by-side-in-packages
  "Maps, robots and kickers of the same name do not disturb each other."
  (with-own-definitions
    (with-packages (one other)
      (loop for (package width) in (list (list one 9) (list other 12))
            do (eval-in package (format nil "(progn
                 (ars:defkicker hop (x) () (ars:set-attribute x :size ~A))
                 (ars:defmap den (~:*~A 9) (obj (box :kickers (hop)) (5 5) ((:size 1))))
                 (ars:defrobot rex (den (2 2) 0)))" width)))
      (flet ((in (package name) (find-symbol name package)))
        (is (= 9 (world:map-width (symbol-value (in one "DEN")))))
        (is (= 12 (world:map-width (symbol-value (in other "DEN")))))
        (is (= 12 (world:map-width (world:find-map 'den))) "the newest, for anybody else")
        (is (eq (symbol-value (in one "REX")) (robot:find-robot "ARS-TEST-AUTHOR:REX")))
        (loop for (package size) in (list (list one 9) (list other 12))
              do (run:call-with-simulation
                  (lambda ()
                    (run:run-ticks 2)
                    (is (= size (world:get-attribute (world:find-thing 'box) :size))))
                  (in package "REX")))))))

(test names.of-different-kinds-do-not-meet
  (with-own-definitions
    (eval '(world:defmap shed (9 9)))
    (eval '(robot:defrobot mole (shed (2 2) 0)))
    (is (search "by its name"
                (first (warnings-of (lambda () (eval '(world:defkicker mole (x) () x)))))))
    (is (robot:robot-p (robot:find-robot 'mole)))
    (is (eq (robot:find-robot 'mole) (symbol-value 'mole)))
    (warnings-of (lambda () (eval '(world:defkicker shed (x) () x))))
    (finishes (eval '(robot:defrobot vole (shed (3 3) 0))))
    (is (search "a name whose variable is free"
                (complaint-about '(progn (defparameter *taken* 3)
                                   (world:defmap den (9 9))
                                   (robot:defrobot *taken* (den (2 2) 0))))))))

(test kickers.defined-again-after-all-are-used
  (with-own-definitions
    (flet ((define-hop (size)
             (world:define-kicker 'hop :body (lambda (x) (world:set-attribute x :size size))))
           (size-after-a-tick ()
             (run:with-simulation (mole)
               (run:run-ticks 2)
               (list (world:get-attribute (world:find-thing 'box) :size)
                     (mapcar #'base:message-text (base:take-messages))))))
      (define-hop 5)
      (eval '(world:defmap shed (9 9) (obj (box :kickers (hop)) (5 5) ((:size 1)))))
      (eval '(robot:defrobot mole (shed (2 2) 0)))
      (base:undefine 'kicker 'hop)
      (destructuring-bind (size messages) (size-after-a-tick)
        (is (= 1 size))
        (is (search "is made without the kicker" (first messages))))
      (define-hop 7)
      (is (equal '(7 ()) (size-after-a-tick))))))

(defun users-function (x) x)

(test names.of-plans-are-no-functions-unsaid
  (with-own-definitions
    ;; A symbol of its own, which no other test can have declared special.
    (flet ((define () (let ((x (gensym "X")))
                        (eval `(rpl:def-interp-proc users-function (,x) ,x)))))
      (unwind-protect
           (progn
             (is (search "users-function was a Lisp function"
                         (first (warnings-of #'define))))
             (is (null (warnings-of #'define)) "it is a plan's by now"))
        (base:undefine 'plan 'users-function)
        (setf (fdefinition 'users-function) (lambda (x) x))))))

(test names.of-constants-are-no-variables-of-maps
  (with-own-definitions
    (is (search "is a constant, symbol macro or global variable and keeps its value: refer"
                (first (warnings-of (lambda ()
                                      (eval '(world:defmap +ars-test-limit+ (5 5))))))))
    (is (= 5 +ars-test-limit+))
    (is (null (warnings-of (lambda () (eval '(world:defmap room (5 5))))))
        "of Common Lisp's names the README says so")))

(test names.of-plans-must-be-free
  (let ((text (complaint-about '(rpl:def-interp-proc open (x) x))))
    (is (search "(:shadow #:open)" text)))
  (is (search "belongs to" (complaint-about '(rpl:def-interp-macro (rpl:seq ?x) nil)))))
