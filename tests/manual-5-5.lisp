;;;; manual-5-5.lisp -- Manipulations: defining and running them (manual 5.5).

(in-package :ars-test-manual-5)
(in-readtable :nisp)

(def-suite* manual-5-5 :in ars-magna)

(defmap bank (12 12)
  (rect (0 0) (11 11) stone 60)
  (obj safe (5 5) ((:capacity 9) (:size 10) (:color red) (:lock-id 7)))
  (obj vault (5.5 5.5) ((:capacity 90) (:size 50) (:color blue) (:lock-id 8)))
  (obj gold-key (5.25 5.75) ((:type :key) (:size .1) (:lock-id 7)))
  (obj iron-key (5 5) ((:type :key) (:size .2) (:lock-id 8)))
  (obj bell (9 9) ((:size 1) (:color violet))))

(defrobot teller (bank (5 5) 0)
  :cameras ((6.28 60)) :hands (10 10) :bins (20))

(defun at (name &optional (type :local))
  "Return a designator of TELLER's on the thing called NAME, found by its size."
  (third (answer 'camera-get-object-designator (robot-camera teller 0) type
                 `((:size ,(get-attribute (find-thing name) :size) .01)))))

(defun outcome (name &rest arguments)
  "Return the values that the manipulation NAME with ARGUMENTS ends with: code and value."
  (apply #'answer 'run-manipulation name arguments))

(defun left-hand () (robot-hand teller 0))

(defmacro in-bank ((&rest options) &body body)
  "Run BODY with TELLER in a fresh and clean bank."
  `(with-simulation (teller :clean t ,@options) ,@body))

(defmacro define (&body definitions)
  "Define manipulations, as a file would."
  `(progn ,@(loop for definition in definitions
                  collect `(eval '(defmanipulation ,@definition)))))

;;; Methods and things.

(test manual-5-5.bodies-return-a-code-and-a-value
  "5.5.1, 5.5.2: the body's two values, an error code or nil and another, are what the continuation
is called with; both arguments are there even if the body returns less."
  (define (prod (it - ((:size (0 99))) :by hand - HAND) () (values nil (list it hand)))
          (slap (it - ((:size (0 99))) :by hand - HAND) () (values :ouch 5))
          (pass (it - ((:size (0 99))) :by hand - HAND) () nil))
  (in-bank ()
    (let ((safe (at 'safe)))
      (is (equal (list nil (list (find-thing 'safe) (left-hand)))
                 (outcome 'prod safe (left-hand))))
      (is (equal '(:ouch 5) (outcome 'slap safe (left-hand))))
      (is (equal '(nil nil) (outcome 'pass safe (left-hand)))))))

(test manual-5-5.objects-are-given-by-designators
  "5.5.2: the object parameters are bound to what the designators denote, in order."
  (define (compare (one - ((:lock-id ?x)) other - ((:size (0 99))) :by robot - ROBOT) ()
            (values nil (list (thing-name one) (thing-name other)))))
  (in-bank ()
    (is (equal '(nil (safe vault)) (outcome 'compare (at 'safe) (at 'vault) teller)))
    (is (equal '(nil (vault gold-key)) (outcome 'compare (at 'vault) (at 'gold-key) teller)))))

(test manual-5-5.patterns-are-descriptor-specifications
  "5.5.1: only objects that match the descriptor may be bound to the variable; if none of the
methods fits, the code is :FAILED."
  (define (paint (it - ((:color (red violet)) (:size (5 20))) :by hand - HAND) ()
            (set-attribute it :color 'green)
            (values nil it)))
  (in-bank ()
    (is (eq :failed (first (outcome 'paint (at 'vault) (left-hand)))) "blue")
    (is (eq :failed (first (outcome 'paint (at 'gold-key) (left-hand)))) "without colour")
    (is (null (first (outcome 'paint (at 'safe) (left-hand)))))
    (is (eq 'green (get-attribute (find-thing 'safe) :color)))
    (is (eq :failed (first (outcome 'paint (at 'safe) (left-hand)))) "green by now")))

(test manual-5-5.patterns-are-matched-exactly
  "Reading 126: true values are compared, without noise and without the usual threshold."
  (define (weigh (it - ((:size (10 20))) :by hand - HAND) () (values nil :ten))
          (judge (it - ((:size 9.9)) :by hand - HAND) () (values nil :near))
          (guess (it - ((:size 9.9 .2)) :by hand - HAND) () (values nil :near)))
  (with-simulation (teller :seed 3 :parameters '((false-thing-prob* 0) (miss-thing-prob* 0)))
    (let ((safe (third (answer 'camera-get-object-designator (robot-camera teller 0) :local
                               '((:size 10 4))))))
      (is (equal '((nil :ten)) (remove-duplicates
                                (loop repeat 20 collect (outcome 'weigh safe (left-hand)))
                                :test #'equal)))
      (is (eq :failed (first (outcome 'judge safe (left-hand)))))
      (is (equal '(nil :near) (outcome 'guess safe (left-hand))) "a threshold of its own"))))

(test manual-5-5.matchvars-stand-for-one-value
  "5.5.1: ?x is bound to the attribute's value where it comes first; where it comes again the value
must be the same. An object without the attribute does not match."
  (define (fasten (box - ((:capacity (.1 9999)) (:lock-id ?x)) key - ((:type :key) (:lock-id ?x))
                       :by hand - HAND)
              ()
            (values nil (thing-name key))))
  (in-bank ()
    (flet ((code (box key) (first (outcome 'fasten (at box) (at key) (left-hand)))))
      (is (equal '(nil nil) (list (code 'safe 'gold-key) (code 'vault 'iron-key))))
      (is (equal '(:failed :failed) (list (code 'safe 'iron-key) (code 'vault 'gold-key))))
      (is (eq :failed (code 'gold-key 'safe)))
      (set-attribute (find-thing 'gold-key) :lock-id nil)
      (is (eq :failed (code 'safe 'gold-key))))))

(test manual-5-5.the-newest-method-that-fits-is-used
  "5.5.1, reading 174: a manipulation may have several methods, chosen by the objects passed; of
those that fit, that defined last counts."
  (define (knock (it - ((:size (0 99))) :by hand - HAND) () (values nil :any))
          (knock (it - ((:size (0 99)) (:color red)) :by hand - HAND) () (values nil :red)))
  (in-bank ()
    (flet ((value (name) (second (outcome 'knock (at name) (left-hand)))))
      (is (equal '(:red :any) (list (value 'safe) (value 'vault))))
      (define (knock (it - ((:capacity (1 99))) :by hand - HAND) () (values nil :box)))
      (is (equal '(:box :box :any) (list (value 'safe) (value 'vault) (value 'iron-key))))
      (define (knock (it - ((:size (0 99)) (:color red)) :by hand - HAND) () (values nil :ruby)))
      (is (equal '(:ruby :box) (list (value 'safe) (value 'vault)))
          "that method anew, so newest"))))

(test manual-5-5.undefined-manipulations-are-gone
  "Reading 174: UNDEFINE removes all methods; running it is an error then."
  (define (knock (it - ((:size (0 99))) :by hand - HAND) () (values nil :any)))
  (in-bank ()
    (let ((safe (at 'safe)))
      (undefine 'manipulation 'knock)
      (signals unknown-name (run-manipulation 'knock safe (left-hand) nil)))))

(test manual-5-5.what-cannot-be-reached-fails
  "5.5.2, reading 175: with a designator that is not local, or invalid by now, no method applies."
  (define (ring (it - ((:size (0 99))) :by hand - HAND) () (values nil :ding)))
  (in-bank ()
    (let ((bell (at 'bell :non-local)))
      (is (equal '(:failed nil) (outcome 'ring bell (left-hand))))
      (place-robot teller 9 9 0)
      (is (equal '(:failed nil) (outcome 'ring bell (left-hand))) "it never turns local")))
  (in-bank ()
    (let ((safe (at 'safe)))
      (is (equal '(nil :ding) (outcome 'ring safe (left-hand))))
      (destroy-thing (find-thing 'safe))
      (is (equal '(:failed nil) (outcome 'ring safe (left-hand)))))))

(test manual-5-5.what-is-not-there-fails
  "Reading 175: a false designator denotes nothing that could match."
  (define (ring (it - () :by hand - HAND) () (values nil :ding)))
  (with-simulation (teller :seed 1 :clean t)
    (setf no-sensor-error* nil false-thing-prob* 1)
    (let ((phantom (third (answer 'camera-get-object-designator (robot-camera teller 0) :local
                                  '((:color lightgreen))))))
      (is-true (designator-valid-p phantom))
      (is (eq :failed (first (outcome 'ring phantom (left-hand))))))))

;;; Success and delay.

(test manual-5-5.success-is-the-probability-that-it-works
  "5.5.1: by default always; else :FAILED comes with probability 1 - :success, in a clean world, too
(reading 117)."
  (define (pull (it - () :by hand - HAND) (:success .7) (values nil 1))
          (push (it - () :by hand - HAND) () (values nil 1)))
  (in-bank (:seed 4)
    (let ((safe (at 'safe)))
      (flet ((successes (name trials)
               (loop repeat trials count (equal '(nil 1) (outcome name safe (left-hand))))))
        (is-true (frequent-p (successes 'pull 600) 600 .7))
        (is (= 60 (successes 'push 60)))
        (is (equal '(:failed nil) (loop for answer = (outcome 'pull safe (left-hand))
                                        when (first answer) return answer)))))))

(test manual-5-5.a-failure-by-chance-does-nothing
  "Reading 175: success is tested before the body runs."
  (define (spoil (it - () :by hand - HAND) (:success 0) (set-attribute it :color 'green)))
  (in-bank ()
    (is (equal '(:failed nil) (outcome 'spoil (at 'safe) (left-hand))))
    (is (eq 'red (get-attribute (find-thing 'safe) :color)))))

(test manual-5-5.delay-is-how-long-it-takes
  "5.5.1, reading 79: with :delay n the body runs n ticks ahead; by default, 0, in the next."
  (loop for (delay ticks) in '((0 1) (1 1) (2 2) (7 7))
        do (eval `(defmanipulation wait (it - () :by hand - HAND) (:delay ,delay)
                    (values nil (simulation-tick))))
           (in-bank ()
             (let ((safe (at 'safe)) (start (simulation-tick)))
               (is (= ticks (- (second (outcome 'wait safe (left-hand))) start)) "~D" delay))))
  (define (wait (it - () :by hand - HAND) () (values nil (simulation-tick))))
  (in-bank ()
    (let ((safe (at 'safe)) (start (simulation-tick)))
      (is (= (1+ start) (second (outcome 'wait safe (left-hand))))))))

;;; Resources and other parameters.

(test manual-5-5.the-resource-is-what-by-says
  "5.5.1, reading 176: the value of the parameter after :BY is the resource; commands on it, and
manipulations by it, interrupt each other, those on other resources do not."
  (define (press (it - () :by hand - HAND) (:delay 9) (values nil :done)))
  (in-bank ()
    (let ((safe (at 'safe)) (answers '()))
      (flet ((press (name hand)
               (manipulate press safe hand
                 (continuation (err value) (push (list name err value) answers)))))
        (press :first (left-hand))
        (run-ticks 2)
        (press :second (left-hand))
        (press :other (robot-hand teller 1))
        (run-ticks 3)
        (is (equal '((:first :interrupt nil)) answers))
        (run-ticks 9)
        (is (equal '((:other nil :done) (:second nil :done))
                   (sort (rest (reverse answers)) #'string< :key #'first)))
        (setf answers '())
        (press :third (left-hand))
        (run-ticks 1)
        (hand-ungrasp (left-hand) nil)
        (run-ticks 2)
        (is (equal '((:third :interrupt nil)) answers))))))

(test manual-5-5.resources-have-the-type-they-say
  "5.5.1, reading 176: `:by hand - HAND' takes a hand; no other."
  (define (press (it - () :by hand - HAND) () (values nil :done))
          (turn-key (it - () :by it-by) () (values nil it-by)))
  (in-bank ()
    (let ((safe (at 'safe)))
      (signals wrong-argument (run-manipulation 'press safe (robot-camera teller 0) nil))
      (signals wrong-argument (run-manipulation 'press safe nil nil))
      (dolist (resource (list (left-hand) (robot-camera teller 0) (robot-storage-bin teller 0)
                              teller))
        (is (equal (list nil resource) (outcome 'turn-key safe resource)))))))

(test manual-5-5.other-parameters-follow-the-resource
  "5.5.1: after the resource come ordinary parameters, which are passed as they are."
  (define (paint (it - () :by hand - HAND color coats) ()
            (set-attribute it :color color)
            (values nil (list hand coats))))
  (in-bank ()
    (is (equal (list nil (list (left-hand) 3)) (outcome 'paint (at 'safe) (left-hand) 'green 3)))
    (is (eq 'green (get-attribute (find-thing 'safe) :color)))
    (signals wrong-argument (run-manipulation 'paint (at 'safe) (left-hand) 'green nil))))

(test manual-5-5.objects-are-not-necessary
  "5.5.1: a manipulation may be of no object, or of several."
  (define (wave (:by hand - HAND) () (values nil :hello)))
  (in-bank ()
    (is (equal '(nil :hello) (outcome 'wave (left-hand))))))

;;; Running.

(test manual-5-5.manipulate-takes-the-name-as-written
  "5.5.2: MANIPULATE does not evaluate the name, RUN-MANIPULATION, a function, does; :BY is written
in neither."
  (define (knock (it - () :by hand - HAND) () (values nil :knock))
          (scratch (it - () :by hand - HAND) () (values nil :scratch)))
  (in-bank ()
    (let ((safe (at 'safe)) (knock 'scratch) (answers '()))
      (flet ((note (err value) (push (list err value) answers)))
        (manipulate knock safe (left-hand) #'note)
        (run-ticks 2)
        (run-manipulation knock safe (left-hand) #'note)
        (run-ticks 2)
        (is (equal '((nil :scratch) (nil :knock)) answers))))))

(test manual-5-5.manipulations-are-commands
  "5.5.2: they return at once, take effect later, and may go without a continuation (reading 39)."
  (define (paint (it - () :by hand - HAND) (:delay 2) (set-attribute it :color 'green)))
  (in-bank ()
    (let ((safe (at 'safe)))
      (manipulate paint safe (left-hand) nil)
      (is (eq 'red (get-attribute (find-thing 'safe) :color)))
      (run-ticks 2)
      (is (eq 'green (get-attribute (find-thing 'safe) :color))))))

(test manual-5-5.own-codes-are-errors-like-others
  "5.5.2, reading 229: a manipulation's own code is told in the messages, as that of a command is."
  (define (fasten (it - () :by hand - HAND) () (values :not-holding-key hand)))
  (in-bank ()
    (is (equal (list :not-holding-key (left-hand)) (outcome 'fasten (at 'safe) (left-hand))))
    (is (equal "fasten: NOT-HOLDING-KEY" (first (last (message-texts)))))))

(test manual-5-5.bodies-that-fail-are-messages
  "Reading 86: an error in the body is a message that names the manipulation; the run goes on, and
the continuation is called."
  (define (crash (it - () :by hand - HAND) () (error "It slips")))
  (in-bank ()
    (is (eq :failed (first (outcome 'crash (at 'safe) (left-hand)))))
    (is-true (find-if (lambda (text) (has-words-p text "crash" "It slips")) (message-texts)))))

(test manual-5-5.mistakes-are-told
  "5.5.1: each object has a descriptor, one resource follows :BY, success and delay are in range."
  (dolist (rest '(((it - ((:size 1)))  ()) ((it :by hand) ()) ((:by) ()) ((it - red :by hand) ())
                  ((it - () :by hand) (:success 2)) ((it - () :by hand) (:delay -1))
                  ((it - () :by hand) (:chance .5)) ((it - ((:size (9 1))) :by hand) ())))
    (is-true (first (complaints `(defmanipulation oops ,@rest nil))) "~S" rest)))
