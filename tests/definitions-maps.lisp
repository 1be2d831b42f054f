;;;; definitions-maps.lisp -- runs and robots when maps and robots are defined again.

(in-package :ars-magna.tests)

(in-suite definitions)

(defun define-shed (width &rest clauses)
  "Define the map SHED, WIDTH by 9, with CLAUSES. Return the warnings."
  (warnings-of (lambda () (eval `(world:defmap shed (,width 9) ,@clauses)))))

(defun mole () (robot:find-robot 'mole))

(defmacro with-mole-in-shed (&body body)
  `(with-own-definitions
     (define-shed 9)
     (eval '(robot:defrobot mole (shed (6 6) 0) :hands (5)))
     (unwind-protect (progn ,@body)
       (when (and time:*simulation* (time:live-p time:*simulation*))
         (run:stop-simulator)))))

(test map-redefined.takes-effect-at-the-next-start
  (with-mole-in-shed
    (let ((old (mole)))
      (run:with-simulation (mole)
        (is (null (define-shed 9 '(wall (2 2) (2 2) bricks 1))))
        (is (not (world:wall-at-p (world:world-map world:*world*) 2 2)) "under way"))
      (run:with-simulation (mole)
        (is (world:wall-at-p (world:world-map world:*world*) 2 2)))
      (is (not (eq old (mole))))
      (is (eq (world:find-map 'shed) (world:world-map (robot:robot-world (mole)))))
      (run:simulator (mole) :display nil)
      (is (eq (world:find-map 'shed)
              (world:world-map (run:simulation-world (time:current-simulation))))))))

(test map-redefined.stops-what-it-replaces
  "The old thread ends, pending commands are interrupted, and it is said so."
  (with-mole-in-shed
    (let ((answers '()) (robot (mole)))
      (run:simulator 'mole :display nil :rate :free)
      (let ((simulation time:*simulation*))
        (time:pause)
        (time:asking (simulation)
          (command:robot-go-forward robot 1000 (lambda (code &rest more)
                                                 (declare (ignore more))
                                                 (push code answers))))
        (run:step-ticks 3)
        (loop until (= 3 (run:simulation-tick simulation)) do (sb-thread:thread-yield))
        (let ((warnings (define-shed 9)))
          (is (= 1 (length warnings)))
          (is (search "has ended at tick 3" (first warnings))))
        (is (not (time:live-p simulation)))
        (is (equal '(:interrupt) answers))
        (signals base:misuse (command:robot-turn robot 1))
        (signals base:misuse (command:hand-ungrasp (robot:robot-hand robot 0)))
        (handler-case (command:robot-turn robot 1)
          (base:misuse (condition)
            (is (search "the variable mole holds now" (princ-to-string condition)))))))))

(defun simulator-threads ()
  (count "simulator of" (sb-thread:list-all-threads)
         :test (lambda (start thread)
                 (eql 0 (search start (sb-thread:thread-name thread))))))

(test map-redefined.leaves-no-threads
  (with-mole-in-shed
    (let ((before (simulator-threads)))
      (dotimes (round 3)
        (define-shed 9)
        (run:simulator (mole) :display nil))
      (awaiting (<= (simulator-threads) (1+ before))))))

(test map-redefined.rejects-what-no-longer-fits
  (with-mole-in-shed
    (let ((warnings (define-shed 5)))
      (is (= 1 (length warnings)))
      (is (search "outside the map, which is 5 by 9" (first warnings))))
    (dolist (function (list (lambda () (run:simulator 'mole))
                            (lambda () (run:call-with-simulation (constantly nil) '(mole)))
                            (lambda () (command:robot-turn (mole) 1))))
      (signals base:misuse (funcall function)))
    (is (search "inside a wall" (first (define-shed 9 '(wall (6 6) (6 6) bricks 1)))))
    (is (null (define-shed 9)))
    (is (eq (mole) (run:simulator 'mole :display nil)) "it fits again")))

(test map-redefined.is-not-if-it-makes-no-sense
  (with-mole-in-shed
    (let ((map (world:find-map 'shed)) (robot (mole)))
      (signals base:malformed-definition (define-shed 9 '(obj box (99 9) ())))
      (is (eq map (world:find-map 'shed)))
      (is (eq robot (mole)))
      (finishes (command:robot-turn robot 1)))))

(test robot-redefined.takes-over-from-the-old-one
  (with-mole-in-shed
    (let ((old (mole)))
      (eval '(world:defmap annexe (9 9)))
      (run:simulator 'mole :display nil)
      (eval '(robot:defrobot mole (annexe (2 2) 0)))
      (is (null (run:simulation-robots time:*simulation*)) "it has left the shed")
      (signals base:misuse (command:robot-turn old 1))
      (is (eq (world:find-map 'annexe) (world:world-map (robot:robot-world (mole)))))
      (finishes (command:robot-turn (mole) 1)))))

(test run-over.robots-take-no-more-commands
  (with-mole-in-shed
    (let ((robot (run:with-simulation (mole) (mole))))
      (handler-case (progn (command:robot-turn robot 1) (fail "no error"))
        (base:misuse (condition)
          (is (search "headless simulation" (princ-to-string condition))))))))

(test run-over.is-told-to-those-who-asked
  "What a headless run had under way when it ended is interrupted, and no tick passes any more."
  (with-mole-in-shed
    (let ((codes '()) (simulation nil))
      (run:with-simulation (mole)
        (setf simulation (time:current-simulation))
        (command:robot-turn (mole) 1 (lambda (code &rest more)
                                       (declare (ignore more))
                                       (push code codes)))
        (run:run-ticks 1))
      (is (equal '(:interrupt) codes))
      (signals base:misuse (run:run-ticks 1 simulation)))))

(test map-redefined.after-its-simulator-was-aborted
  "What is left of a run whose thread is dead is no obstacle."
  (with-mole-in-shed
    (run:simulator 'mole :display nil)
    (let* ((simulation time:*simulation*) (thread (run:simulation-thread simulation)))
      (command:robot-turn (mole) 1 (lambda (&rest all)
                                     (declare (ignore all))
                                     (sb-thread:abort-thread)))
      (loop while (base:thread-alive-p thread) do (sb-thread:thread-yield))
      (define-shed 9)
      (is-true (run:simulation-over simulation))
      (run:simulator 'mole :display nil)
      (is (not (eq simulation time:*simulation*)))
      (run:stop-simulator))))

(test map-redefined.says-what-it-ends
  "Not for a run with nothing under way, unless it is live."
  (with-mole-in-shed
    (run:simulator 'mole :display nil)
    (run:stop-simulator)
    (is (null (define-shed 9)))
    (run:simulator 'mole :display nil)
    (is (search "has ended" (first (define-shed 9))))))

(test find-thing.looks-in-the-current-simulation
  (with-mole-in-shed
    (define-shed 9 '(obj box (3 3) ((:size 1))))
    (eval '(world:defmap annexe (9 9) (obj box (3 3) ((:size 2)))))
    (eval '(robot:defrobot vole (annexe (2 2) 0)))
    (dolist (entry '((mole 1) (vole 2) (mole 1)))
      (destructuring-bind (name size) entry
        (run:simulator name :display nil)
        (is (= 1 (length (world:find-things 'box))))
        (is (= size (world:get-attribute (world:find-thing 'box) :size)))))
    (run:with-simulation (vole)
      (is (= 2 (world:get-attribute (world:find-thing 'box) :size))))))

(test run-ended.tells-all-who-asked
  "A run that is started anew, or whose world is left, interrupts what was asked of it."
  (with-mole-in-shed
    (let ((answers '()))
      (flet ((hear (code &rest more)
               (declare (ignore more))
               (push code answers)))
        (run:simulator 'mole :display nil :rate :free)
        (command:robot-go-forward (mole) 10 #'hear)
        (run:await-idle)
        (time:pause)
        (command:hand-track (robot:robot-hand (mole) 0) #'hear)
        (run:stop-simulator)
        (command:robot-turn (mole) 1 #'hear)
        (let ((old time:*simulation*))
          (run:simulator 'mole :display nil)
          (is (equal 3 (length answers)))
          (is (= 1 (count :robot-blocked answers)))
          (signals base:misuse (run:run-ticks 1 old))
          (signals base:misuse (time:post (make-errand #'list) old)))
        ;; Never started, and defined anew.
        (run:stop-simulator)
        (define-shed 9)
        (setf answers '())
        (command:robot-turn (mole) 1 #'hear)
        (define-shed 9)
        (is (equal '(:interrupt) answers))))))

(test run-ended.commands-from-threads-are-answered-once-or-refused
  (with-mole-in-shed
    (let* ((accepted 0) (answered 0) (stop nil) (lock (base:make-lock "count"))
           (threads (loop repeat 3
                          collect (base:start-thread
                                   (lambda ()
                                     (loop until stop
                                           do (handler-case
                                                  (progn
                                                    ;; Memory holds only so many that wait.
                                                    (loop while (< 10000 (- accepted answered))
                                                          until stop
                                                          do (base:yield-thread))
                                                    (command:robot-turn
                                                     (mole) .01
                                                     (lambda (&rest answer)
                                                       (declare (ignore answer))
                                                       (base:with-lock (lock) (incf answered))))
                                                    (base:with-lock (lock) (incf accepted)))
                                                (base:misuse ()))))
                                   "asking"))))
      (dotimes (round 5)
        (run:simulator 'mole :display nil :rate :free)
        (let ((goal (+ accepted 50)))
          (loop until (< goal accepted) do (sb-thread:thread-yield)))
        (define-shed 9))
      (setf stop t)
      (mapc #'base:join-thread threads)
      (define-shed 9)
      (is (plusp accepted))
      (is (= accepted answered)))))

(test robot-redefined.is-interrupted
  (with-mole-in-shed
    (let ((answers '()))
      (run:simulator 'mole :display nil)
      (time:pause)
      (command:robot-go-forward (mole) 100 (lambda (code &rest more)
                                             (declare (ignore more))
                                             (push code answers)))
      (run:step-ticks 2)
      (loop until (= 2 (run:simulation-tick)) do (sb-thread:thread-yield))
      (eval '(robot:defrobot mole (shed (5 5) 0)))
      (is (equal '(:interrupt) answers))
      (is (equal (list (mole)) (run:simulation-robots))))))

(test own-definitions.end-runs-and-let-others-begin
  (with-mole-in-shed
    (run:simulator 'mole :display nil)
    (let ((simulation time:*simulation*))
      (base:with-own-definitions ()
        (define-shed 12)
        (eval '(world:defmap annexe (9 9)))
        (eval '(robot:defrobot vole (annexe (2 2) 0)))
        (run:simulator 'vole :display nil))
      (is (eq simulation time:*simulation*))
      (is (not (null (run:simulation-over simulation))))
      (is (= 9 (world:map-width (world:find-map 'shed))))
      (finishes (command:robot-turn (mole) 1))
      (is (eq (mole) (run:simulator 'mole :display nil)))
      (is (zerop (simulator-threads-of 'annexe))))))

(defun simulator-threads-of (map)
  (count (format nil "simulator of ~A" map) (sb-thread:list-all-threads)
         :test #'string-equal :key #'sb-thread:thread-name))

;;; Maps of many clauses.

(defun hall-of-things (count descriptor-of)
  "Return the text of a map HALL with COUNT things, one a line from line 2, each with what
DESCRIPTOR-OF returns of its number, as text."
  (with-output-to-string (text)
    (format text "(world:defmap hall (100 100)~%")
    (dotimes (index count)
      (format text " (obj (pot~D :prototype egg*) (~D ~D) ~A)~%" index (mod index 100)
              (mod (floor index 100) 100) (funcall descriptor-of index)))
    (format text ")")))

(defvar *eggs-laid* 0 "How often the prototype of a test was asked for.")

(define-symbol-macro egg* (progn (incf *eggs-laid*)
                                 (world:make-new-thing 'egg nil '((:color red)))))

(test maps.of-ten-thousand-things-are-data
  "Clauses are not compiled: a tenth of these filled the memory."
  (with-own-definitions
    (setf *eggs-laid* 0)
    (call-with-file #'load-here (hall-of-things 10000 (constantly "((:size 2) (:weight 3))")))
    (let ((world (world:make-world 'hall)))
      (is (= 10000 *eggs-laid*) "the prototype's form has a value for each clause")
      (is (= 10000 (world:world-live-count world)))
      (let ((last (elt (world:world-thing-list world) 9999)))
        (is (equal '(99.0d0 99.0d0) (list (world:thing-x last) (world:thing-y last))))
        (is (equal '(red 2 3) (loop for key in '(:color :size :weight)
                                       collect (world:get-attribute last key))))))))

(test maps.of-many-things-say-where-a-mistake-is
  (with-own-definitions
    (flet ((trouble-of (wrong)
             (call-with-file
              (lambda (path)
                (handler-case (load-here path)
                  (base:malformed-definition (condition) (princ-to-string condition))))
              (hall-of-things 2000 (lambda (index) (if (= index 1500) wrong "()"))))))
      (dolist (wrong '("((:size 2) (:size 3))" "((:weight heavy))"))
        (let ((text (trouble-of wrong)))
          (is (search ", line 1502" text) "~A" text)
          (is (search "pot1500" text) "~A" text))))))

;;; Clauses of users.

(defparameter *polygon* '(world:define-map-clause polygon (map &rest parts)
                          "(polygon (x y) (x y) (x y)... substance parameter)"
                          :check (<= 5 (length parts))
                          :clauses (loop with (substance parameter) = (last parts 2)
                                         for (start end) on (butlast parts 2)
                                         collect `(wall ,start ,(or end (first parts))
                                                        ,substance ,parameter)))
  "The definition of a clause of maps, a closed line of walls.")

(defmacro with-polygons (&body body)
  `(with-own-definitions (eval *polygon*) ,@body))

(test map-clauses.of-users-stand-for-others
  (with-polygons
    (eval '(world:define-map-clause den (map point)
            "(den (x y))"
            :clauses `((polygon (2 2) (7 2) (2 7) slate 5)
                       (obj (bear :prototype egg*) ,point ((:size 3)) (cub ())))))
    (define-shed 9 "A shed." '(rect (0 0) (8 8) bricks 1) '(den (3.5 4)))
    (let ((grid (grid-of (world:find-map 'shed))) (world (world:make-world 'shed)))
      (is (equal '("CUB#1" "BEAR#2") (mapcar #'princ-to-string (world:world-thing-list world))))
      (is (equal '(:color :size) (world:map-attribute-names (world:find-map 'shed))))
      (define-shed 9 '(rect (0 0) (8 8) bricks 1) '(wall (2 2) (7 2) slate 5)
        '(wall (7 2) (2 7) slate 5) '(wall (2 7) (2 2) slate 5))
      (is (equalp grid (grid-of (world:find-map 'shed)))))))

(test map-clauses.of-users-are-told-of-as-ours
  (with-polygons
    (loop for (clause . words)
            in '(((polygon (2 2) slate 5) "(polygon (2 2) slate 5)" "(polygon (x y) (x y)")
                 ((polygon (2 2) (7 a) (2 7) slate 5) "(7 a) (2 7)" "(wall (2 2) (7 a) slate 5)"
                  "numbers from -1e15")
                 ((polygn (2 2)) "wall, rect, circle, obj or polygon"))
          for complaint = (file-complaint (format nil "(world:defmap m (9 9)~% (wall (1 1) (2 2) ~
                                                       bricks 1)~% ~S)" clause))
          do (is-true (apply #'has-words-p complaint "defmap m" "line 3)" words) "~A" complaint))
    (is (equal '(("goes beyond the map") ("did you mean slate?") ())
               (loop for clause in '((polygon (2 2) (70 2) (2 70) slate 5)
                                     (polygon (2 2) (7 2) (2 7) slat 5)
                                     (polygon (2 2) (7 2) (2 7) slate 5))
                     collect (loop for warning in (define-shed 9 clause)
                                   collect (find-if (lambda (words) (search words warning))
                                                    '("goes beyond the map"
                                                      "did you mean slate?"))))))))

(test map-clauses.without-end-are-refused
  (with-own-definitions
    (eval '(world:define-map-clause loop (map) "(loop)" :clauses '((loop))))
    (handler-case (progn (define-shed 9 '(loop)) (fail "accepted"))
      (base:malformed-definition (condition)
        (is (search "whose expansion ends" (princ-to-string condition)))))))

(test map-clauses.are-defined-or-refused
  (loop for (expected . form)
          in '(("no built-in clause has" wall (map) "(wall)" :clauses '())
               ("with a form" nook (map) "(nook)")
               ("one of the options" nook (map) "(nook)" :cells '())
               ("one of the options" nook (map) "(nook)" :claws '())
               ("a string" nook (map) :clauses '())
               ("variables for the map" nook () "(nook)" :clauses '())
               ("a symbol" 7 (map) "(nook)" :clauses '()))
        do (is (search expected (first (complaints `(world:define-map-clause ,@form)))) "~S" form))
  (is (search "cannot be undefined" (first (complaints '(base:undefine 'map-clause 'wall)))))
  (is (equal '(nil nil) (complaints '(world:define-map-clause nook (map) "(nook)" :clauses '())
                                    '(base:undefine 'map-clause 'nook)))))

(defun load-compiled (text function)
  "Call FUNCTION, which is to load the file whose name it is given: TEXT, compiled. Return the
warnings of the compiler."
  (with-own-definitions
    (call-with-file
     (lambda (path)
       (uiop:with-temporary-file (:pathname fasl :type "fasl")
         (prog1 (warnings-of (lambda () (compile-file path :output-file fasl)))
           (funcall function fasl))))
     (format nil "(in-package :ars-magna.tests)~%~A" text))))

(test restarts.leave-clauses-out-of-compiled-maps
  (let ((warnings (load-compiled *leaky-shed*
                                 (lambda (fasl)
                                   (call-choosing 'base:skip-clause (lambda () (load-here fasl)))
                                   (is (world:wall-at-p (world:find-map 'shed) 1 3))
                                   (is (null (world:find-things 'box 'shed)))
                                   (is (= 1 (length (world:find-things 'bag 'shed))))))))
    (is (= 1 (length warnings)))
    (is (search "line 4)" (first warnings)))))

(test map-clauses.may-be-defined-in-the-file-that-uses-them
  (is (null (load-compiled (format nil "~S (world:defsubstance slade 3)
(world:defmap shed (9 9) (polygon (2 2) (7 2) (2 7) slade 5))" *polygon*)
                           (lambda (fasl)
                             (load-here fasl)
                             (is (world:wall-at-p (world:find-map 'shed) 4 2)))))))
