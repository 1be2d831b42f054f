;;;; journals-definitions.lisp -- journals of other definitions, and of live runs.

(in-package :ars-magna.tests)

(in-suite journals)

(defparameter *lawn*
  "(world:def-place-type nook (cell) :check-matchers ((((* * *) (* - *) (x - x)) 1)))
(world:defattribute :shape (cube ball) :noticed 1)
(world:defsubstance jelly 44)
(defun push-length () .1)
(world:defkicker prod (thing) (:prob .5) (world:kick-thing thing (push-length) 0 nil))
(world:defkicker spare (thing) () thing)
(world:define-map-clause hedge (map length) \"(hedge)\"
  :clauses `((wall (1 0) (,length 0) jelly 1)))
(world:defmap lawn (10 8)
  (rect (0 0) (9 7) jelly 1)
  (hedge 3)
  (obj (crate :kickers (prod)) (5 5) ((:size 2) (:shape cube))))
(robot:defrobot mower (lawn (2 2) 0) :cameras ((3 5)) :hands (9))
(command:defmanipulation polish (it - () :by hand) () (values nil it))
"
  "A file with something of each kind.")

(defun lawn-with (old new)
  "Return the text of *LAWN* with NEW instead of OLD."
  (let ((position (search old *lawn*)))
    (concatenate 'string (subseq *lawn* 0 position) new
                 (subseq *lawn* (+ position (length old))))))

(defun call-in-directory (function)
  "Call FUNCTION with a new directory, which is gone afterwards."
  (uiop:with-temporary-file (:pathname file)
    (let ((directory (uiop:ensure-directory-pathname (format nil "~A-d" (namestring file)))))
      (ensure-directories-exist directory)
      (unwind-protect (funcall function directory)
        (uiop:delete-directory-tree directory :validate t)))))

(defun load-text (text directory &key (name "lawn.lisp") compiled)
  "Load a file NAME of DIRECTORY that holds TEXT, COMPILED or not. Return its path."
  (let ((path (merge-pathnames name directory)))
    (rewrite path text)
    (handler-bind ((warning #'muffle-warning))
      (load-here (if compiled
                     (let ((*package* (find-package :ars-magna.tests))
                           (*error-output* (make-broadcast-stream))
                           (*standard-output* (make-broadcast-stream)))
                       (compile-file path))
                     path)))
    path))

(defmacro with-world-loaded ((text &rest options) &body body)
  "Run BODY as if nothing but TEXT, in a file of its own, had been loaded."
  `(base:with-own-definitions ()
     (call-in-directory (lambda (directory)
                          (declare (ignorable directory))
                          (load-text ,text directory ,@options)
                          ,@body))))

(defun mow (&optional (function (constantly nil)))
  "Return the journal of a run of the mower, in which FUNCTION is called once."
  (run:call-with-simulation
   (lambda ()
     (run:run-ticks 10)
     (funcall function)
     (run:run-ticks 10)
     (end-journal time:*simulation*))
   '(mower) :seed 4 :journal t))

(defun mown (&rest options)
  "Return a journal of a run in the world that OPTIONS say how to load."
  (apply (lambda (text &rest options)
           (with-world-loaded (text :name (getf options :name "lawn.lisp")
                                    :compiled (getf options :compiled))
             (mow)))
         options))

(test fingerprint.knows-the-same-world-anywhere
  "In another directory, compiled, with other comments and layout, loaded twice."
  (let ((journal (mown *lawn*)))
    (dolist (text (list *lawn*
                        (format nil "; Mine.~%~A#| the end |#" *lawn*)
                        (substitute #\Newline #\Space *lawn*)
                        (lawn-with "(:prob .5) (world"
                                   (format nil "(  :prob .5~%)~C(world" #\Tab))))
      (dolist (compiled '(nil t))
        (with-world-loaded (text :compiled compiled)
          (is (integerp (replay-outcome journal)))
          (load-text text directory)
          (is (integerp (replay-outcome journal))))))
    (is-true (with-temporary-file (file)
               (run:write-journal journal file)
               (with-world-loaded (*lawn*) (integerp (replay-outcome file)))))))

(test fingerprint.names-the-substances-of-its-map
  (with-world-loaded (*lawn*)
    (run:with-simulation ('mower)
      (is (equal '("JELLY")
                 (mapcar #'string
                         (run::definition-names-in-use :substance time:*simulation*)))))))

(defun differences-with (journal text)
  "Return what a replay of JOURNAL says is different in the world TEXT, a list of strings."
  (with-world-loaded (text)
    (handler-case (progn (run:replay journal) '())
      (run:different-definitions (condition)
        (run::different-definitions-differences condition)))))

(test fingerprint.names-what-has-changed
  (let ((journal (mown *lawn*)))
    (loop for (old new words)
            in '((".5" ".6" "kicker prod has changed since the recording")
                 ("(crate :kickers" "(tin :kickers" "map lawn has changed since the recording")
                 ("(2 2) 0)" "(2 3) 0)" "robot mower has changed since the recording")
                 ("(,length 0)" "(,(1+ length) 0)"
                  "map clause hedge has changed since the recording")
                 ("push-length () .1" "push-length () .2"
                  "file lawn.lisp has changed since the recording")
                 ("(world:defkicker spare (thing) () thing)" "" "kicker spare is not loaded")
                 ("jelly 44" "jelly 45" "substance jelly has changed since the recording")
                 ("(values nil it)" "(values nil nil)"
                  "manipulation polish has changed since the recording")
                 (":noticed 1" ":noticed .5" "attribute shape has changed since the recording"))
          for differences = (differences-with journal (lawn-with old new))
          do (is (member words differences :test #'string=) "~A: ~A" words differences)
             (is (subsetp differences (list words "file lawn.lisp has changed since the recording")
                          :test #'string=)))
    (with-world-loaded ((lawn-with ".5" ".6"))
      (is (integerp (replay-outcome journal :anyway t)))
      (is (integerp (handler-bind ((run:different-definitions
                                     (lambda (condition)
                                       (declare (ignore condition))
                                       (invoke-restart 'run:replay-anyway))))
                      (replay-in-full journal)))))))

(defun replay-in-full (journal)
  "Return the digest after a replay of JOURNAL; what it signals is not caught."
  (nth-value 1 (run:replay journal)))

(test fingerprint.of-worlds-that-are-not-loaded
  (let ((journal (mown *lawn*)))
    (is (typep (replay-outcome journal) 'base:unknown-name))))

(test fingerprint.notices-what-is-redefined-meanwhile
  (with-world-loaded (*lawn*)
    (let ((journal (mow (lambda ()
                          (eval '(world:defkicker prod (thing) (:prob .1) thing))))))
      (is-true (says-p "kicker prod was defined anew during the recorded run"
                       (replay-outcome journal))))))

(test fingerprint.does-not-mind-the-unrelated
  (with-world-loaded (*lawn*)
    (let ((journal (mow)))
      (call-in-directory
       (lambda (directory)
         (load-text "(world:defkicker other (thing) () thing)
                     (world:defmap yard-2 (5 5)) (robot:defrobot other-mower (yard-2 (2 2) 0))"
                    directory :name "yard.lisp")
         (is (integerp (replay-outcome journal)))))
      (eval '(world:defkicker other (thing) () 7))
      (eval '(world:defkicker typed (thing) () 7))
      (is (integerp (replay-outcome journal))))))

(test fingerprint.of-a-world-that-was-typed
  (base:with-own-definitions ()
    (define-all-kinds)
    (flet ((record ()
             (run:with-simulation (mole :journal t)
               (run:run-ticks 5)
               (end-journal time:*simulation*))))
      (let ((journal (record)))
        (is (integerp (replay-outcome journal)))
        (eval '(world:defkicker nobody-has-it (thing) () thing))
        (is (integerp (replay-outcome journal)))
        (eval '(world:defkicker nudge (thing) (:prob .5) (world:kick-thing thing .2 0 nil)))
        (is (says-p "kicker nudge has changed since the recording" (replay-outcome journal)))))))

(defparameter *two-files*
  '("(world:defsubstance jelly 44)
     (defun push-length () .1)
     (world:defkicker prod (thing) (:prob .5) (world:kick-thing thing (push-length) 0 nil))
     (world:defkicker late (thing) (:prob .5) (world:kick-thing thing 0 (push-length) nil))"
    "(world:defmap lawn (10 8) (rect (0 0) (9 7) jelly 1) (obj (crate :kickers (prod)) (5 5) ()))
     (robot:defrobot mower (lawn (2 2) 0))"))

(defun mow-two-files (kickers function)
  "Return what FUNCTION does where KICKERS, a text, and the other of *TWO-FILES* are loaded."
  (base:with-own-definitions ()
    (call-in-directory
     (lambda (directory)
       (load-text kickers directory :name "kickers.lisp")
       (load-text (second *two-files*) directory)
       (funcall function)))))

(test fingerprint.of-two-files
  "A kicker of the other file, or what it calls, counts; also if it is put on a thing later."
  (let ((journal (mow-two-files (first *two-files*) #'mow))
        (later (mow-two-files
                (first *two-files*)
                (lambda ()
                  (mow (lambda () (world:set-kicker (world:find-thing 'crate) 'late)))))))
    (dolist (journal (list journal later))
      (flet ((outcome (kickers)
               (mow-two-files kickers (lambda () (replay-outcome journal)))))
        (is (integerp (outcome (first *two-files*))))
        (is (says-p "kickers.lisp has changed since the recording"
                    (outcome (substitute #\3 #\1 (first *two-files*)))))
        (is (says-p "kicker prod has changed since the recording"
                    (outcome (substitute #\6 #\5 (first *two-files*)))))))))

(test form-digests.tell-forms-apart
  (let ((forms '((a) ((a)) (a nil) (nil a) ((a nil)) (a . b) (a b) "a" a #\a 97 (97) 1 1.0 1d0 1/2
                 .5 .5d0 "A" () (()) (quote a) (function a) `(a ,b) `(a b) 18446744073709551616 0)))
    (is (= (length forms)
           (length (remove-duplicates (mapcar #'definitions::form-digest forms)))))
    (is (= (definitions::form-digest '(let ((#1=#:g1 1) (#2=#:g2 2)) (+ #1# #2#)))
           (definitions::form-digest '(let ((#3=#:g7 1) (#4=#:g8 2)) (+ #3# #4#)))))
    (is (/= (definitions::form-digest '(let ((#5=#:g1 1) (#6=#:g2 2)) (+ #5# #6#)))
            (definitions::form-digest '(let ((#7=#:g7 1) (#8=#:g8 2)) (+ #8# #7#)))))))

;;; Live.

(test live-journal.repeats-what-other-threads-did
  (with-messages
    (let* ((simulation (run:fresh-simulation '(rover) :seed 41 :journal t))
           (robot (first (run:simulation-robots simulation)))
           (world (run:simulation-world simulation)))
      (unwind-protect
           (progn
             (run:start-clock simulation :rate :free)
             (mapc #'base:join-thread
                   (loop for number below 4
                         collect (let ((number number))
                                   (base:start-thread
                                    (lambda ()
                                      (dotimes (i 50)
                                        (command:robot-turn robot (* .1 number))
                                        (world:move-thing (world:find-thing 'crate world)
                                                          (+ 2 number) (+ 3 (mod i 5)))
                                        (robot:place-robot robot 4 (+ 4 number) 0)
                                        (run:set-seed (+ i number) simulation)))
                                    "changer"))))
             (is-true (run:await-idle simulation)))
        (run:stop-clock simulation))
      (with-temporary-file (file)
        (run:save-journal file simulation)
        (is (eql (run:state-digest simulation) (replay-outcome file)))))))

(test live-journal.knows-parameters-that-anybody-has-set
  "What another thread sets holds in the run, and what a continuation sets holds for others."
  (with-messages
    (let* ((simulation (run:fresh-simulation '(rover) :seed 41 :journal t))
           (robot (first (run:simulation-robots simulation)))
           (seen '()))
      (flet ((turn-and-set (value)
               (command:robot-turn robot .1 (lambda (&rest ignore)
                                              (declare (ignore ignore))
                                              (push base:braking* seen)
                                              (when value (setf base:braking* value))))
               (is-true (run:await-idle simulation))))
        (unwind-protect
             (progn
               (run:start-clock simulation :rate :free)
               (setf base:braking* 7)
               (turn-and-set 9)
               (turn-and-set nil)
               (is (= 9 base:braking*)))
          (run:stop-clock simulation)))
      (is (equal '(9 7) seen))
      (is (equal '(7 9) (loop for (nil operator name value) in (run:journal-entries
                                                                (run:simulation-journal simulation))
                              when (and (eq operator 'run::parameter) (equal name "braking*"))
                                collect value))))))

(test live-journal.is-there-when-asked-for
  "A run without one says so; the next has one, of what is defined when it starts."
  (with-messages
    (with-world-loaded (*lawn*)
      (flet ((run-once (&rest options)
               (let ((robot (apply #'run:simulator 'mower :rate :free options)))
                 (run:stop-simulator)
                 (run:robot-simulation robot))))
        (is-true (says-p ":journal nil"
                         (handler-case (end-journal (run-once :journal nil :seed 1))
                           (base:misuse (trouble) trouble))))
        (eval '(world:defkicker prod (thing) (:prob .3) thing))
        (is (integerp (replay-outcome (end-journal (run-once)))))))))
