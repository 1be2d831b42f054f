;;;; giving.lisp -- grasping robots, and handing things to them.

(in-package :ars-magna.tests)

(in-suite handling)

(robot:defrobot courier (village-green (14.5 5.5) pi) :cameras ((6.2 9)) :hands (10))

(defun hand-of (robot &optional (index 0)) (robot:robot-hand robot index))
(defun bin-of (robot &optional (index 0)) (robot:robot-storage-bin robot index))

(defun designated (robot specification)
  "Return a local designator of ROBOT for what fits SPECIFICATION."
  (first (seen-by robot :local specification)))

(defmacro with-giver ((&rest options) &body body)
  "Run BODY with SCOUT next to RANGER. SCOUT holds PEN, and TO is its designator of RANGER."
  `(run:with-simulation ((scout ranger) :clean t ,@options)
     (robot:place-robot scout 11.999 5.5 0)
     (let* ((pen (world:make-new-thing 'pen (hand-of scout) '((:size 1) (:weight 1))))
            (to (designated scout '((:color red)))))
       (declare (ignorable pen to))
       ,@body)))

(defun give-code (to &optional (kind :hand) (index 0))
  "Return the error code with which SCOUT gives what it holds to TO."
  (first (answer-of 'command:hand-give (hand-of scout) to kind index)))

(test robots-grasped.are-too-heavy-and-take-nothing-in
  (with-giver ()
    (command:hand-ungrasp (hand-of scout))
    (answer-of 'command:camera-track (camera-of scout) to)
    (is (eq :insufficient-strength
            (first (answer-of 'command:hand-grasp-desig (hand-of scout) (camera-of scout) to))))
    (is (search "RANGER is a robot, which no hand can lift"
                (getf (command:last-failure scout) :text)))
    (is (eq :insufficient-capacity
            (first (answer-of 'command:hand-insert (hand-of scout) to))))
    (is (eq :insufficient-capacity
            (first (answer-of 'command:camera-insert (camera-of scout) to))))
    (setf base:prob-miss-grasp* 1)
    (is (eq :missed-grasp
            (first (answer-of 'command:hand-grasp-desig (hand-of scout) (camera-of scout) to))))))

(test hand-give.gives-to-hands
  (with-giver ()
    (let ((start (run:simulation-tick)))
      (is (equal (list nil to) (answer-of 'command:hand-give (hand-of scout) to :hand 0)))
      (is (= (+ base:hand-move-delay* base:hand-grasp-delay* 1) (- (run:simulation-tick) start))))
    (is (eq pen (robot:hand-holding (hand-of ranger))))
    (is (null (robot:hand-holding (hand-of scout))))
    (is-true (robot:designator-valid-p to))
    (is (equal '(pen) (names-seen-by ranger :local '((:size 1)))))
    (is (equal '() (names-seen-by scout :local '((:size 1)))))))

(test hand-give.gives-to-bins
  (with-giver ()
    (is (eq nil (give-code to :bin)))
    (is (eq (bin-of ranger) (world:thing-location pen)))))

(test hand-give.says-why-not
  (with-giver ()
    (flet ((is-refused (code text &rest call)
             (is (eq code (apply #'give-code call)))
             (is (search text (getf (command:last-failure scout) :text))
                 "~S" (getf (command:last-failure scout) :text))
             (is (eq pen (robot:hand-holding (hand-of scout))))))
      (is-refused :no-such-part "There is no hand 2 of RANGER" to :hand 2)
      (is-refused :no-such-part "There is no bin 2 of RANGER" to :bin 2)
      (is-refused :insufficient-strength "Hand 1 of RANGER is not strong enough" to :hand 1)
      (is-refused :insufficient-capacity "No room for what Hand 0 holds in bin 1 of RANGER" to
                  :bin 1)
      (answer-of 'command:storage-bin-close (bin-of ranger))
      (is-refused :bin-closed "Bin 0 of RANGER is closed" to :bin)
      (is-refused :not-a-robot "CRATE is not a robot"
                  (progn (world:move-thing (world:find-thing 'crate) 11.9 5.5)
                         (designated scout '((:color green)))))
      (is-refused :non-local-designator "Designator is not local"
                  (first (seen-by scout :non-local '((:color blue)))))
      (world:make-new-thing 'cap (hand-of ranger) '((:size 1)))
      (is-refused :receiver-full "Hand 0 of RANGER is already holding something" to)
      (setf base:prob-miss-grasp* 1)
      (answer-of 'command:storage-bin-open (bin-of ranger))
      (is-refused :missed-give "Hand 0 missed RANGER" to :bin)
      (robot:place-robot ranger 12.5 6.5 0)
      (is-refused :bad-designator "Designator is not valid" to)))
  (with-giver ()
    (command:hand-ungrasp (hand-of scout))
    (is (eq :not-grasping (give-code to)))))

(test hand-give.waits-for-no-busy-or-distant-hand
  (with-giver ()
    (robot:set-robot-pose ranger 3.5 5.5 0)
    (robot:set-robot-pose scout 3.5 5.5 0)
    (let ((to (designated scout '((:color red)))) (crate (designated scout '((:color green))))
          (theirs (designated ranger '((:color green)))))
      (answer-of 'command:hand-insert (hand-of ranger) theirs)
      (is (eq :different-location (give-code to)) "the receiving hand is in the crate")
      (answer-of 'command:hand-remove (hand-of ranger))
      (answer-of 'command:hand-insert (hand-of scout) crate)
      (is (eq :different-location (give-code to)) "the giving hand is in the crate")
      (answer-of 'command:hand-remove (hand-of scout))
      (command:hand-give (hand-of scout) to :hand 0)
      (run:run-ticks (+ base:hand-move-delay* base:hand-grasp-delay* -1))
      (command:hand-insert (hand-of ranger) theirs)
      (run:run-ticks 1)
      (is (eq :receiver-busy (getf (command:last-failure scout) :error)))
      (is (search "Hand 0 of RANGER is carrying out a command"
                  (getf (command:last-failure scout) :text))))))

(test hand-give.misses-as-often-as-grasps
  (with-giver (:seed 11)
    (setf base:prob-miss-grasp* 1/4)
    (is (expected-count-p
         (count-code :missed-give 400
                     (lambda ()
                       (world:move-thing pen (hand-of scout))
                       (give-code to :bin)))
         400 1/4))))

(test hand-give.ends-what-watched-the-thing
  (with-giver ()
    (let ((mine (designated scout '((:size 1)))) (ends '()))
      (command:hand-track (hand-of scout) (lambda (err &rest more)
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
           (run:with-simulation ((scout ranger courier) :clean t :seed seed)
             (robot:place-robot scout 11.999 5.5 0)
             (robot:place-robot courier 13.001 5.5 0)
             (dolist (robot (list scout courier))
               (world:make-new-thing (robot:robot-name robot) (hand-of robot)
                                     '((:size 1) (:weight 1))))
             (let ((calls (loop for robot in (list scout courier)
                                collect (list (hand-of robot)
                                              (designated robot '((:color red)))))))
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
    (driver:rpl-init-robot scout)
    (is (equal '(nil nil) (driver:run-plan 'pass-on to)))
    (is (eq pen (robot:hand-holding (hand-of ranger))))))

;;; Manipulations of robots.

(in-suite manipulations)

(defun manipulated (name designator)
  "Run the manipulation NAME by SCOUT's hand; return what its continuation got."
  (let ((answer nil))
    (command:run-manipulation name designator (hand-of scout)
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
    (let ((crate (designated scout '((:color green)))))
      (is (equal (list nil ranger) (manipulated 'charge to)) "the variable is the robot")
      (is (= 100 (world:get-attribute ranger :battery)))
      (is (equal (list nil (world:find-thing 'crate)) (manipulated 'pat crate)))
      (is (equal '(:failed nil) (manipulated 'charge crate)))
      (is (equal '(:failed nil) (manipulated 'pat to)))
      (is-true (has-words-p (getf (command:last-failure scout) :text)
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
