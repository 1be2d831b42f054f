;;;; manipulations.lisp -- methods by pattern, and carrying them out (manual 5.5).

(in-package :ars-magna.tests)

(def-suite* manipulations :in ars-magna)

(defmacro with-own-manipulations (&body body)
  "Run BODY, with COOK in a clean simulation; the manipulations it defines are then forgotten."
  `(with-only (command::*manipulations*)
     (with-cook (:clean t :seed 1)
       ,@body)))

(defun var (name) (nisp:make-matchvar name))

(defun define-way (name parameters result &key (success 1) (delay 0))
  "Define a method of NAME with PARAMETERS that returns the values of the list RESULT."
  (command:define-manipulation name parameters
                               (lambda (&rest arguments)
                                 (declare (ignore arguments))
                                 (values-list result))
                               :success success :delay delay))

(defun outcome-of (name &rest arguments)
  "Run the manipulation NAME with ARGUMENTS; return what its continuation got."
  (apply #'reply 'command:run-manipulation name arguments))

(defun fits-p (specification descriptor)
  "True if a thing with the attributes DESCRIPTOR is as SPECIFICATION says."
  (command::patterns-fit-p (list (command::parse-pattern "test" specification))
                           (list (world:make-new-thing 'it nil descriptor))))

(defun fit-p (&rest pairs)
  "True if things with the second elements of PAIRS are as their first elements say, together."
  (command::patterns-fit-p
   (loop for (specification) in pairs collect (command::parse-pattern "test" specification))
   (loop for (nil descriptor) in pairs collect (world:make-new-thing 'it nil descriptor))))

;;; Patterns.

(test pattern.numbers-are-exact
  (is-true (fits-p '((:size 4)) '((:size 4))))
  (is-true (fits-p '((:size 4)) '((:size 4d0))))
  (is-false (fits-p '((:size 4)) '((:size 4.1))))
  (is-true (fits-p '((:size 4 .2)) '((:size 4.1))) "unless a threshold is given")
  (is-true (fits-p '((:size (3 5))) '((:size 3))))
  (is-false (fits-p '((:size (3 5))) '((:size 2.9))))
  (is-true (fits-p '((:size (3 5) .2)) '((:size 2.9))))
  (is-false (fits-p '((:capacity (0.1 9999))) '((:size 4))) "no value is no capacity")
  (is-false (fits-p '((:capacity (0.1 9999))) '((:capacity 0))))
  (is-true (fits-p '((:capacity (0 9999))) '((:capacity 0)))))

(test pattern.names-and-alternatives
  (is-true (fits-p '((:color blue)) '((:color world:blue))))
  (is-false (fits-p '((:color blue)) '((:color red))))
  (is-true (fits-p '((:color (red blue))) '((:color red))))
  (is-false (fits-p '((:color (red blue))) '((:color green))))
  (is-true (fits-p '((:substance wood)) '((:substance (wood 3)))))
  (is-true (fits-p '((:substance (2 4))) '((:substance (wood 3)))))
  (is-true (fits-p '((:substance (wood metal))) '((:substance metal)))))

(test pattern.truth-and-falsity
  (is-true (fits-p '((:closed nil)) '()))
  (is-true (fits-p '((:closed nil)) '((:closed nil))))
  (is-false (fits-p '((:closed nil)) '((:closed t))))
  (is-true (fits-p '((:closed t)) '((:closed t))))
  (is-false (fits-p '((:closed t)) '()))
  (is-true (fits-p '((:closed (t nil))) '()))
  (is-false (fits-p '((:color (red blue))) '())))

(test pattern.undeclared-attributes-go-by-their-shape
  (is-true (fits-p '((:type :key)) '((:type key))))
  (is-true (fits-p '((:number (3 5))) '((:number 4))))
  (is-true (fits-p '((:number (3 5 7))) '((:number 5))))
  (is-false (fits-p '((:number (3 5 7))) '((:number 4))))
  (is-true (fits-p '((:spots ((1 2) (3 4)))) '((:spots ((1 2) (3 4))))))
  (is-true (fits-p '((:alarm nil)) '())))

(test pattern.matchvars-are-shared
  (is-true (fits-p `((:size ,(var 'x)) (:weight ,(var 'x))) '((:size 3) (:weight 3.0))))
  (is-false (fits-p `((:size ,(var 'x)) (:weight ,(var 'x))) '((:size 3) (:weight 4))))
  (is-true (fits-p `((:size ,(var nil)) (:weight ,(var nil))) '((:size 3) (:weight 4))))
  (is-false (fits-p `((:size ,(var nil))) '()) "?() wants a value, any")
  (is-false (fits-p `((:lock-id ,(var 'x))) '()))
  (is-true (fits-p `((:closed ,(var 'x)) (:obsmove ,(var 'x))) '((:closed nil))))
  (flet ((lock-and-key (lock key)
           (fit-p `(((:capacity (.1 9999)) (:lock-id ,(var 'x))) ((:capacity 3) (:lock-id ,lock)))
                  `(((:type :key) (:lock-id ,(var 'x))) ((:type key) (:lock-id ,key))))))
    (is-true (lock-and-key 'a 'a))
    (is-true (lock-and-key '(1 2) '(1 2)))
    (is-false (lock-and-key 'a 'b))))

;;; Definitions.

(defun what-is-wrong (parameters &optional options)
  "Return the clause that is wrong in a DEFMANIPULATION with PARAMETERS and OPTIONS."
  (handler-case (with-only (command::*manipulations*)
                  (eval `(command:defmanipulation try ,parameters ,options nil))
                  :nothing)
    (base:malformed-definition (trouble) (basics::malformed-definition-clause trouble))))

(test defmanipulation.shows-the-clause-that-is-wrong
  (is (eq :nothing (what-is-wrong '(a - ((:size 3)) :by hand - hand count - integer more))))
  (is (eq :nothing (what-is-wrong '(:by hand))))
  (is (equal '(a - ((:size 3))) (what-is-wrong '(a - ((:size 3))))))
  (is (equal '(a - ((:size 3)) :by) (what-is-wrong '(a - ((:size 3)) :by))))
  (is (equal '(a ((:size 3))) (what-is-wrong '(a ((:size 3)) :by hand))))
  (is (equal '(:size) (what-is-wrong '(a - ((:size)) :by hand))))
  (is (equal '(:size 3 -1) (what-is-wrong '(a - ((:size 3 -1)) :by hand))))
  (is (eq 'container (what-is-wrong '(a - container :by hand))))
  (is (eq '&optional (what-is-wrong '(a - () :by hand &optional b))))
  (is (equal 3 (what-is-wrong '(a - () :by 3))))
  (is (equal '(- ) (what-is-wrong '(a - () :by hand -))))
  (is (equal '(a - () :by a) (what-is-wrong '(a - () :by a))))
  (is (equal '(:success 2) (what-is-wrong '(:by hand) '(:success 2))))
  (is (equal '(:delay -1) (what-is-wrong '(:by hand) '(:delay -1))))
  (is (equal '(:speed 3) (what-is-wrong '(:by hand) '(:speed 3))))
  (signals base:malformed-definition (macroexpand '(command:defmanipulation "x" (:by hand) ()))))

(test defmanipulation.replaces-a-method-with-the-same-parameters
  (with-own-manipulations
    (define-way 'poke '(it - () :by hand) '(nil 2))
    (define-way 'poke '(it - ((:size 1)) :by hand) '(nil 1))
    (flet ((poke () (outcome-of 'poke (designate 'apple) (hand 0))))
      (is (equal '(nil 1) (poke)) "the last defined that applies")
      (define-way 'poke '(it - ((:size 1)) :by hand) '(nil 3))
      (is (equal '(nil 3) (poke)) "replaced")
      (world:set-attribute (thing 'apple) :size 2)
      (is (equal '(nil 2) (poke)))
      (define-way 'poke '(it - () :by hand) '(nil 4))
      (world:set-attribute (thing 'apple) :size 1)
      (is (equal '(nil 4) (poke)) "the last defined, also when it is defined again")
      (is (equal '(poke) (mapcar #'command:manipulation-name (command:all-manipulations)))))))

(test manipulation.undefined-while-under-way-fails
  (with-own-manipulations
    (define-way 'poke '(it - () :by hand) '(nil 1))
    (let ((answers '()) (apple (designate 'apple)))
      (command:run-manipulation 'poke apple (hand 0) (lambda (&rest all) (push all answers)))
      (base:undefine 'manipulation 'poke)
      (run:run-ticks 5)
      (is (equal '((:failed nil)) answers)))))

(test defmanipulation.keeps-methods-of-other-types
  "What was typed is no earlier version of a method with other types."
  (with-own-manipulations
    (define-way 'poke '(it - ((:size 1)) :by hand - robot:hand) '(nil :hand))
    (define-way 'poke '(it - ((:size 1)) :by hand - robot:robot) '(nil :robot))
    (is (equal '(nil :hand) (outcome-of 'poke (designate 'apple) (hand 0))))
    (is (equal '(nil :robot) (outcome-of 'poke (designate 'apple) (robot:find-robot 'cook))))))

(test defmanipulation.takes-the-example-of-the-manual
  (with-own-manipulations
    (let ((form (let ((*package* (find-package :ars-magna.tests))
                      (*readtable* (named-readtables:find-readtable :nisp)))
                  (read-from-string
                   "(command:defmanipulation bar (box - ((:capacity (0.1 9999)) (:bolt ?x))
                                                  bolt - ((:type :bolt) (:bolt ?x))
                                                  :by hand - HAND)
                      (:success .9 :delay 1)
                      (cond ((robot:in-location bolt hand)
                             (setf (world:get-attribute box :barred) #t)
                             (values nil hand))
                            (t (values :not-holding-bolt hand))))"))))
      (is (eq 'bar (eval form)))
      (let ((bolt (world:make-new-thing 'bolt '(kitchen 5.5 5.5) '((:type bolt) (:bolt 7))))
            (codes '()))
        (world:set-attribute (thing 'hamper) :bolt 7)
        (let ((box (designate 'hamper)) (key (designate 'bolt)))
          (is (equal (list :not-holding-bolt (hand 0)) (outcome-of 'bar box key (hand 0))))
          (world:move-thing bolt (hand 0))
          (dotimes (i 200)
            (command:manipulate bar box key (hand 0)
              (lambda (code value)
                (is (eq (and (null code) (hand 0)) value))
                (push code codes)))
            (run:run-ticks 1))
          (is (= 200 (length codes)))
          (is (expected-count-p (count :failed codes) 200 .1))
          (is (= 200 (+ (count :failed codes) (count nil codes))))
          (is-true (world:get-attribute (thing 'hamper) :barred)))))))

;;; Carrying them out.

(test manipulation.fails-where-nothing-is-designated
  (with-own-manipulations
    (define-way 'poke '(it - () :by hand) '(nil done))
    (flet ((poke (designator &optional (hand (hand 0))) (outcome-of 'poke designator hand)))
      (let ((apple (designate 'apple)) (gone (designate 'apple)) (pen (designate 'pen)))
        (robot:drop-designator gone)
        (is (equal '(nil done) (poke apple)))
        (is (equal '(nil done) (poke pen)) "seen inside the hamper")
        (is (equal '(:failed nil) (poke gone)))
        (is (equal '(:failed nil) (poke (hallucinate))))
        (is (equal '(:failed nil) (poke (designate 'crate :type :non-local))))
        (world:move-thing (thing 'apple) 9.5 9.5)
        (is (equal '(:failed nil) (poke apple)))
        (is (string= (format nil "poke: APPLE#6 by Hand 0: DONE~@
                                  poke: PEN#4 by Hand 0: DONE~@
                                  *ERROR* -> poke failed~@
                                  *ERROR* -> poke failed~@
                                  *ERROR* -> poke failed: Designator 3 is not local, but objects ~
                                  of manipulations must be. Drive there, for example with ~
                                  robot-goto-designator, and search again with the type :local~@
                                  *WARNING* -> Removing Designator 0~@
                                  *ERROR* -> poke failed~%")
                     (let ((texts (texts)))
                       (subseq texts (search "poke:" texts)))))))))

(test manipulation.knows-its-own-robot's-designators-only
  (with-only (command::*manipulations*)
    (run:with-simulation ((cook rover-in-kitchen) :clean t :ghosts t)
      (define-way 'poke '(it - () :by hand) '(nil done))
      (let ((other (robot:robot-hand (robot:find-robot 'rover-in-kitchen) 0)))
        (is (equal '(:failed nil) (outcome-of 'poke (designate 'apple) other)))))))

(test manipulation.waits-for-its-delay
  (with-own-manipulations
    (loop for (delay ticks) in '((0 1) (1 1) (2 2) (7 7))
          do (let ((name (intern (format nil "WAIT-~D" delay) :ars-magna.tests)))
               (define-way name '(it - () :by hand) '(nil nil) :delay delay)
               (is (= ticks (ticks-of 'command:run-manipulation name
                                      (designate 'apple) (hand 0))))))))

(test manipulation.is-tested-when-its-delay-has-passed
  (with-own-manipulations
    (define-way 'poke '(it - () :by hand) '(nil 2))
    (define-way 'poke '(it - ((:size 1)) :by hand) '(nil 1) :delay 5)
    (let ((*answers* '()) (apple (designate 'apple)))
      (command:manipulate poke apple (hand 0) (recorder 'poke))
      (run:run-ticks 3)
      (world:set-attribute (thing 'apple) :size 2)
      (run:run-ticks 5)
      (is (equal '((:failed nil)) (answers-to 'poke)))
      (is (equal '(nil 2) (outcome-of 'poke apple (hand 0)))))))

(test manipulation.success-is-a-matter-of-chance
  (with-own-manipulations
    (define-way 'try '(it - () :by hand) '(nil nil) :success 0.3)
    (define-way 'never '(it - () :by hand) '(nil nil) :success 0)
    (let ((apple (designate 'apple)) (done 0))
      (dotimes (i 2000)
        (command:manipulate try apple (hand 0)
          (lambda (code value) (declare (ignore value)) (unless code (incf done))))
        (run:run-ticks 1))
      (is (expected-count-p done 2000 .3))
      (is (equal '(:failed nil) (outcome-of 'never apple (hand 0)))))))

(test manipulation.occupies-its-resource
  (with-own-manipulations
    (define-way 'poke '(it - () :by hand - hand) '(nil done) :delay 5)
    (define-way 'poke '(it - () :by camera - camera) '(nil seen) :delay 5)
    (let ((*answers* '()) (apple (designate 'apple)))
      (command:manipulate poke apple (hand 0) (recorder 'first))
      (command:manipulate poke apple (camera 0) (recorder 'camera))
      (run:run-ticks 2)
      (command:manipulate poke apple (hand 0) (recorder 'second))
      (run:run-ticks 2)
      (command:hand-grasp-check (hand 0) nil)
      (run:run-ticks 10)
      (is (equal '((:interrupt nil)) (answers-to 'first)))
      (is (equal '((:interrupt nil)) (answers-to 'second)))
      (is (equal '((nil seen)) (answers-to 'camera)))
      (setf *answers* '())
      (command:hand-insert-bin (hand 0) (bin 0) (recorder 'insert))
      (command:manipulate poke apple (hand 0) nil)
      (time:grab-resource (hand 0))
      (run:run-ticks 10)
      (is (equal '(:interrupt) (mapcar #'first (answers-to 'insert)))))))

(test manipulation.passes-its-other-arguments
  (with-own-manipulations
    (let ((got '()))
      (command:define-manipulation
       'put '(it - () :by robot - robot count - number word)
       (lambda (&rest arguments) (setf got arguments) (values :odd 7)))
      (is (equal '(:odd 7) (outcome-of 'put (designate 'apple) cook 3 "x")))
      (is (equal (list (thing 'apple) cook 3 "x") got)))))

(test manipulation.an-error-in-its-body-is-data
  (with-own-manipulations
    (command:define-manipulation 'crash '(:by hand) (lambda (hand) (car hand)))
    (is (equal '(:failed nil) (outcome-of 'crash (hand 0))))
    (is (search "Error in manipulation crash: " (texts)))))

(test manipulation.runs-in-its-world
  (with-own-manipulations
    (command:define-manipulation 'spawn '(:by hand)
                                 (lambda (hand)
                                   (world:make-new-thing 'plum hand '((:size 1)))
                                   (values nil (world:find-thing 'plum))))
    (let ((outcome (outcome-of 'spawn (hand 0))))
      (is (equal (list nil (thing 'plum)) outcome)))
    (is (eq (thing 'plum) (robot:hand-holding (hand 0))))))

(test manipulation.rejects-wrong-arguments-at-once
  (with-own-manipulations
    (define-way 'poke '(it - () :by hand - hand count - number) '(nil nil))
    (let ((apple (designate 'apple)))
      (signals base:unknown-name (command:manipulate pok apple (hand 0) 1 nil))
      (dolist (arguments (list (list) (list nil) (list apple (hand 0) nil)
                               (list apple (hand 0) 1) (list (thing 'apple) (hand 0) 1 nil)
                               (list apple (camera 0) 1 nil) (list apple nil 1 nil)
                               (list apple (hand 0) 'one nil) (list apple (hand 0) 1 "f")
                               (list apple (hand 0) 1 2 nil)))
        (signals base:wrong-argument (apply #'command:run-manipulation 'poke arguments))))))

(defun see (specification)
  "Return a local designator of something that is as SPECIFICATION says."
  (third (reply 'command:camera-get-object-designator (camera 0) :local specification)))

(test manipulation.is-in-the-journal
  (with-only (command::*manipulations*)
    (define-way 'poke '(it - () :by hand count) '(nil nil) :success .5)
    (command:define-manipulation 'grow '(it - () :by hand by - number)
                                 (lambda (it hand by)
                                   (declare (ignore hand))
                                   (incf (world:get-attribute it :size) by)
                                   nil)
                                 :success .7)
    (flet ((keep-doing (name &rest more)
             (loop repeat 20
                   do (apply #'command:run-manipulation name (append more '(nil)))
                      (run:run-ticks 2))))
      (with-cook (:seed 5 :journal t :clean t)
        (keep-doing 'grow (see '((:size 1))) (hand 0) 1)
        (keep-doing 'poke (see '((:size 12))) (hand 0) "word")
        (let ((journal (run:simulation-journal time:*simulation*)))
          (setf (run:journal-end journal) (run:simulation-tick))
          (is (= 42 (length (run:journal-entries journal))))
          (is (eql (run:state-digest) (nth-value 1 (run:replay journal)))))))))

(test in-location.is-immediate
  (with-cook ()
    (is-true (robot:in-location (thing 'pen) (thing 'hamper)))
    (is-false (robot:in-location (thing 'dot) (thing 'hamper)))
    (is-true (robot:in-location (thing 'apple) :floor))
    (is-false (robot:in-location (thing 'apple) (hand 0)))))
