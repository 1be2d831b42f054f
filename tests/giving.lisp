;;;; giving.lisp -- grasping robots, and handing things to them.

(in-package :ars-magna.tests)

(in-suite handling)

(robot:defrobot relay-runner (village-green (14.5 5.5) pi) :cameras ((6.2 9)) :hands (10))

(defun hand-of (robot &optional (index 0)) (robot:robot-hand robot index))
(defun bin-of (robot &optional (index 0)) (robot:robot-storage-bin robot index))

(defun near-designator (robot specification)
  "Return a local designator of ROBOT for what fits SPECIFICATION."
  (first (seen-by robot :local specification)))

(defmacro with-giver ((&rest options) &body body)
  "Run BODY with SURVEYOR next to RANGER. SURVEYOR holds PEN, and TO is its designator of RANGER."
  `(run:with-simulation ((surveyor ranger) :clean t ,@options)
     (robot:place-robot surveyor 11.999 5.5 0)
     (let* ((pen (world:make-new-thing 'pen (hand-of surveyor) '((:size 1) (:weight 1))))
            (to (near-designator surveyor '((:color red)))))
       (declare (ignorable pen to))
       ,@body)))

(defun give-code (to &optional (kind :hand) (index 0))
  "Return the error code with which SURVEYOR gives what it holds to TO."
  (first (answer-of 'command:hand-give (hand-of surveyor) to kind index)))

(test robots-grasped.are-too-heavy-and-take-nothing-in
  (with-giver ()
    (command:hand-ungrasp (hand-of surveyor))
    (answer-of 'command:camera-track (eye-of surveyor) to)
    (is (eq :insufficient-strength
            (first (answer-of 'command:hand-grasp-desig (hand-of surveyor) (eye-of surveyor) to))))
    (is (search "RANGER is a robot, which no hand can lift"
                (getf (command:last-failure surveyor) :text)))
    (is (eq :insufficient-capacity
            (first (answer-of 'command:hand-insert (hand-of surveyor) to))))
    (is (eq :insufficient-capacity
            (first (answer-of 'command:camera-insert (eye-of surveyor) to))))
    (setf base:prob-miss-grasp* 1)
    (is (eq :missed-grasp
            (first (answer-of 'command:hand-grasp-desig (hand-of surveyor) (eye-of surveyor)
                              to))))))

(test hand-give.gives-to-hands
  (with-giver ()
    (let ((start (run:simulation-tick)))
      (is (equal (list nil to) (answer-of 'command:hand-give (hand-of surveyor) to :hand 0)))
      (is (= (+ base:hand-move-delay* base:hand-grasp-delay*) (- (run:simulation-tick) start))))
    (is (eq pen (robot:hand-holding (hand-of ranger))))
    (is (null (robot:hand-holding (hand-of surveyor))))
    (is-true (robot:designator-valid-p to))
    (is (equal '(pen) (names-seen-by ranger :local '((:size 1)))))
    (is (equal '() (names-seen-by surveyor :local '((:size 1)))))))

(test hand-give.gives-to-bins
  (with-giver ()
    (is (eq nil (give-code to :bin)))
    (is (eq (bin-of ranger) (world:thing-location pen)))))

(test hand-give.says-why-not
  (with-giver ()
    (flet ((is-refused (code text &rest call)
             (is (eq code (apply #'give-code call)))
             (is (search text (getf (command:last-failure surveyor) :text))
                 "~S" (getf (command:last-failure surveyor) :text))
             (is (eq pen (robot:hand-holding (hand-of surveyor))))))
      (is-refused :no-such-part "There is no hand 2 of RANGER" to :hand 2)
      (is-refused :no-such-part "There is no bin 2 of RANGER" to :bin 2)
      (is-refused :insufficient-strength "Hand 1 of RANGER is not strong enough" to :hand 1)
      (is-refused :insufficient-capacity "No room for what Hand 0 holds in bin 1 of RANGER" to
                  :bin 1)
      (answer-of 'command:storage-bin-close (bin-of ranger))
      (is-refused :bin-closed "Bin 0 of RANGER is closed" to :bin)
      (is-refused :not-a-robot "is not a robot"
                  (progn (world:move-thing (world:find-thing 'crate) 11.9 5.5)
                         (near-designator surveyor '((:color green)))))
      (is-refused :non-local-designator "Designator is not local"
                  (first (seen-by surveyor :non-local '((:color blue)))))
      (world:make-new-thing 'cap (hand-of ranger) '((:size 1)))
      (is-refused :receiver-full "Hand 0 of RANGER is already holding something" to)
      (setf base:prob-miss-grasp* 1)
      (answer-of 'command:storage-bin-open (bin-of ranger))
      (is-refused :missed-give "Hand 0 missed RANGER" to :bin)
      (robot:place-robot ranger 12.5 6.5 0)
      (is-refused :bad-designator "Designator is not valid" to)))
  (with-giver ()
    (command:hand-ungrasp (hand-of surveyor))
    (is (eq :not-grasping (give-code to)))))

(test hand-give.waits-for-no-busy-or-distant-hand
  (with-giver ()
    (robot:set-robot-pose ranger 3.5 5.5 0)
    (robot:set-robot-pose surveyor 3.5 5.5 0)
    (let ((to (near-designator surveyor '((:color red))))
          (crate (near-designator surveyor '((:color green))))
          (theirs (near-designator ranger '((:color green)))))
      (answer-of 'command:hand-insert (hand-of ranger) theirs)
      (is (eq :different-location (give-code to)) "the receiving hand is in the crate")
      (answer-of 'command:hand-remove (hand-of ranger))
      (answer-of 'command:hand-insert (hand-of surveyor) crate)
      (is (eq :different-location (give-code to)) "the giving hand is in the crate")
      (answer-of 'command:hand-remove (hand-of surveyor))
      (command:hand-give (hand-of surveyor) to :hand 0)
      (run:run-ticks (+ base:hand-move-delay* base:hand-grasp-delay* -1))
      (command:hand-insert (hand-of ranger) theirs)
      (run:run-ticks 1)
      (is (eq :receiver-busy (getf (command:last-failure surveyor) :error)))
      (is (search "Hand 0 of RANGER is carrying out a command"
                  (getf (command:last-failure surveyor) :text))))))

(test hand-give.misses-as-often-as-grasps
  (with-giver (:seed 11)
    (setf base:prob-miss-grasp* 1/4)
    (is (expected-count-p
         (count-code :missed-give 400
                     (lambda ()
                       (world:move-thing pen (hand-of surveyor))
                       (give-code to :bin)))
         400 1/4))))

(test hand-give.ends-what-watched-the-thing
  (with-giver ()
    (let ((mine (near-designator surveyor '((:size 1)))) (ends '()))
      (command:hand-track (hand-of surveyor) (lambda (err &rest more)
                                            (declare (ignore more))
                                            (push err ends)))
      (run:run-ticks 3)
      (give-code to)
      (is (equal '(:interrupt) ends))
      (is-false (robot:designator-valid-p mine))
      (command:hand-track (hand-of ranger) (lambda (err &rest more)
                                             (declare (ignore more))
                                             (push err ends)))
      (run:run-ticks 3)
      (is (equal '(:interrupt) ends) "the receiver can watch its grip"))))

(test hand-give.lets-the-first-of-two-givers-have-the-hand
  "Which is the first, does not depend on the order in which they were told."
  (flet ((given (order seed)
           (run:with-simulation ((surveyor ranger relay-runner) :clean t :seed seed)
             (robot:place-robot surveyor 11.999 5.5 0)
             (robot:place-robot relay-runner 13.001 5.5 0)
             (dolist (robot (list surveyor relay-runner))
               (world:make-new-thing (robot:robot-name robot) (hand-of robot)
                                     '((:size 1) (:weight 1))))
             (let ((calls (loop for robot in (list surveyor relay-runner)
                                collect (list (hand-of robot)
                                              (near-designator robot '((:color red)))))))
               (loop for (hand to) in (funcall order calls)
                     do (command:hand-give hand to :hand 0))
               (run:run-ticks 8)
               (world:thing-name (robot:hand-holding (hand-of ranger)))))))
    (let ((winners (loop for seed below 20
                         for winner = (given #'identity seed)
                         do (is (eq winner (given #'reverse seed)))
                         collect winner)))
      (is (= 2 (length (remove-duplicates winners)))))))

(test hand-give.is-journalled
  (with-temporary-file (file)
    (with-giver (:journal t)
      (give-code to)
      (setf (world:get-attribute ranger :color) 'violet)
      (run:run-ticks 2)
      (run:save-journal file)
      (is (search "hand-give" (string-downcase (uiop:read-file-string file))))
      (is (eql (run:state-digest) (replay-outcome file))))))

(rpl:def-interp-proc pass-on (to)
  (driver:rpl-hand-give 0 to :hand 0)
  (rpl:wait-for (svref driver:hand-moved* 0))
  (list (rpl:fluent-value (svref driver:hand-error* 0))
        (rpl:fluent-value (svref driver:hand-grasping* 0))))

(test hand-give.is-a-command-of-plans
  (with-giver ()
    (driver:rpl-init-robot surveyor)
    (is (equal '(nil nil) (driver:run-plan 'pass-on to)))
    (is (eq pen (robot:hand-holding (hand-of ranger))))))

;;; Manipulations of robots.

(in-suite manipulations)

(defun manipulated (name designator)
  "Run the manipulation NAME by SURVEYOR's hand; return what its continuation got."
  (let ((answer nil))
    (command:run-manipulation name designator (hand-of surveyor)
                              (lambda (&rest arguments) (setf answer arguments)))
    (run:run-until (lambda () answer) :limit 50)
    answer))

(defmacro with-manipulations (&body body)
  "Run BODY as WITH-GIVER does; the manipulations that it defines are then forgotten."
  `(with-only (command::*manipulations*)
     (with-giver () ,@body)))

(test manipulation.of-robots-needs-a-typed-parameter
  (with-manipulations
    (eval '(command:defmanipulation charge (x - robot :by hand - robot:hand) ()
            (setf (world:get-attribute x :battery) 100)
            (values nil x)))
    (eval '(command:defmanipulation pat (x - () :by hand - robot:hand) () (values nil x)))
    (world:move-thing (world:find-thing 'crate) 11.9 5.5)
    (let ((crate (near-designator surveyor '((:color green)))))
      (is (equal (list nil ranger) (manipulated 'charge to)) "the variable is the robot")
      (is (= 100 (world:get-attribute ranger :battery)))
      (is (equal (list nil (world:find-thing 'crate)) (manipulated 'pat crate)))
      (is (equal '(:failed nil) (manipulated 'charge crate)))
      (is (equal '(:failed nil) (manipulated 'pat to)))
      (is-true (has-words-p (getf (command:last-failure surveyor) :text)
                            "no method fits RANGER" "a robot fits only a parameter such as")))))

(test manipulation.of-robots-can-ask-for-attributes
  (with-manipulations
    (loop for (form . fits) in '(((x - (robot (:team red)) :by hand) . t)
                                 ((x - (robot (:team blue)) :by hand) . nil)
                                 ((x - (robot:robot (:team ?t) (:color ?c)) :by hand) . t)
                                 ((x - ((:team red)) :by hand) . nil))
          for read = (subst (var 'c) '?c (subst (var 't) '?t form))
          do (command:define-manipulation 'greet read (constantly nil))
             (is (eq (if fits nil :failed) (first (manipulated 'greet to))) "~S" form)
             (base:undefine 'manipulation 'greet))))

(test defmanipulation.takes-robot-or-a-descriptor
  (flet ((told (specification)
           (princ-to-string (nth-value 1 (ignore-errors
                                          (command:define-manipulation
                                           'greet `(x - ,specification :by hand) #'list))))))
    (with-only (command::*manipulations*)
      (is-true (has-words-p (told 'robt) "a descriptor ((attribute value [threshold]) ...)"))
      (is-true (has-words-p (told '(robot :team)) "a descriptor"))
      (is-true (has-words-p (told '(robot (:color purple))) "one of (red green")))))
