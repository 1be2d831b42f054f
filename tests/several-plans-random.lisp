;;;; several-plans-random.lisp -- random plans of several robots end as a model says; rewinds.

(in-package :ars-magna.tests)
(in-suite several-plans)

;;; The same as real plans of real robots.

(world:defmap heath (60 60)
  (rect (0 0) (59 59) bricks 10))

(robot:defrobot abe (heath (5 5) 0))
(robot:defrobot bea (heath (25 5) 0))
(robot:defrobot kit (heath (45 5) 0))
(robot:defrobot deb (heath (5 35) 0))
(robot:defrobot eve (heath (45 35) 0))

(defvar *begun* '() "An alist from numbers of plans to their tasks, in a run of random plans.")

(defun note-begun (id task)
  (setf *begun* (acons id task (remove id *begun* :key #'car)))
  task)

(defun robot-plan-text (plan)
  (destructuring-bind (kind &optional first second third) plan
    (flet ((text (plan) (robot-plan-text plan)))
      (ecase kind
        (wait `(rpl:wait-time ,first))
        (fail `(rpl:seq (rpl:wait-time ,first) (rpl:fail)))
        (think `(rpl:think ,first))
        (pulse `(rpl:pulse (svref fluents ,first)))
        (set `(rpl:set-value (svref fluents ,first) ,second))
        (await `(rpl:wait-for (svref fluents ,first) ,@(when second `(:timeout ,second))))
        (turn `(rpl:seq (driver:rpl-robot-turn ,(+ .025d0 (* .05d0 first)))
                        (rpl:wait-for driver:robot-stopped*)))
        (listen '(rpl:wait-for driver:robot-stopped*))
        (hear `(rpl:wait-for (driver:robot-fluent ',first 'driver:robot-stopped*)))
        (on `(driver:on-robot (',first) ,(text second)))
        (seq `(rpl:seq ,@(mapcar #'text (rest plan))))
        (try `(rpl:try-in-order ,@(mapcar #'text (rest plan))))
        (par `(rpl:par ,@(mapcar #'text (rest plan))))
        (pursue `(rpl:pursue ,@(mapcar #'text (rest plan))))
        (try-all `(rpl:try-all ,@(mapcar #'text (rest plan))))
        (protect `(rpl:evap-protect ,(text first) (rpl:wait-time ,second)))
        (handle `(rpl:handle-failure ((t () (rpl:wait-time ,second) (return))) ,(text first)))
        (deadline `(rpl:with-deadline (,second) ,(text first)))
        (valve `(rpl:with-valve ((svref valves ,first)) ,(text second)))
        (begin `(note-begun ,first (driver:begin-plan (rpl:interp-lambda () ,(text third))
                                                      :robot ',second)))
        (join `(rpl:join-task ,(text (cons 'begin (rest plan)))))))))

(defun shared-by-plans ()
  "Return a list: a vector of fluents, and one of valves."
  (list (coerce (loop repeat 4 collect (fluent nil)) 'simple-vector)
        (vector (rpl:make-valve 'v) (rpl:make-valve 'w))))

(defun begin-real (id robot plan shared)
  (note-begun id (driver:begin-plan
                  (rpl:make-plan `(destructuring-bind (fluents valves) ',shared
                                    (declare (ignorable fluents valves))
                                    ,(robot-plan-text plan)))
                  :robot robot)))

(defun do-really (shared kind &rest arguments)
  (ecase kind
    (begin (destructuring-bind (id robot plan) arguments (begin-real id robot plan shared)))
    (end (let ((task (cdr (assoc (first arguments) *begun*))))
           (when task (driver:end-plan task))))
    (end-robot (when *begun* (driver:end-plan :all :robot (first arguments))))
    (end-all (when *begun* (driver:end-plan :all)))
    (init (driver:rpl-init-robot (first arguments)))))

(defun ends-now (ends)
  "Return ENDS, lists (id tick outcome), with those plans that have ended meanwhile."
  (loop with tick = (run:simulation-tick)
        for (id . begun) in *begun*
        for task = (driver::task-in-current-run begun)
        when (and (rpl:task-over-p task) (not (assoc id ends)))
          do (push (list id tick (ecase (rpl:task-state task)
                                   (:succeeded :ok) (:failed :fail) (:evaporated :gone)))
                   ends))
  ends)

(defun pass-to (tick)
  (let ((ticks (- tick (run:simulation-tick))))
    (when (plusp ticks) (run:run-ticks ticks))))

(defun really (deeds stops shared ends)
  "Do DEEDS at their ticks, and note which plans have ended at STOPS, a sorted list of ticks. Return
a sorted list of ENDS and further ends."
  (dolist (tick stops (sort ends #'< :key #'first))
    (pass-to tick)
    (setf ends (ends-now ends))
    (dolist (deed deeds)
      (when (= tick (first deed)) (apply #'do-really shared (rest deed))))
    (setf ends (ends-now ends))))

(defun stops-for (ends deeds last)
  "Return the ticks to look at: before and at each of ENDS, at DEEDS, and LAST."
  (sort (remove-duplicates (append (list last)
                                   (mapcar #'first deeds)
                                   (loop for (nil tick) in ends
                                         collect tick when (plusp tick) collect (1- tick))))
        #'<))

(defmacro with-robots-of-case ((robots charged-p &rest options) &body body)
  "Run BODY with ROBOTS, a list of names. They turn slowly, so that turns overlap."
  `(let ((*begun* '())
         (base:*message-queue* (base:make-message-queue))
         (*standard-output* (make-broadcast-stream))
         (*error-output* (make-broadcast-stream))
         (base:*echo-output* (make-broadcast-stream)))
     (run:with-simulation (,robots :clean t :thinking (if ,charged-p :charged :free) ,@options)
       (dolist (robot (run:simulation-robots)) (command:robot-set-turn-angle robot .05d0))
       ,@body)))

;;; Random plans.

(defvar *next-id*)
(defvar *robots-to-use* '() "The robots that random plans may drive, besides their own.")

(defun random-robot-plan (depth dice &optional (valves '(0 1)))
  "Return a random plan of at most DEPTH levels that owns only VALVES, one in the other in order.
Most parts begin with a wait, so that the order within a tick seldom matters."
  (let ((plan (random-part depth dice valves)))
    (if (or (member (first plan) '(wait fail)) (base:chance 1/8 dice))
        plan
        (list 'seq (list 'wait (1+ (base:roll-index 500 dice))) plan))))

(defun random-part (depth dice valves)
  (labels ((part (&optional (valves valves)) (random-robot-plan (1- depth) dice valves))
           (parts () (loop repeat (1+ (base:roll-index 3 dice)) collect (part)))
           (one (list) (base:roll-element list dice))
           (span () (1+ (base:roll-index 2000 dice)))
           (begun (valves)
             (list (incf *next-id*) (one *robots-to-use*) (part valves))))
    (let ((kind (if (plusp depth)
                    (one '(seq seq par par pursue try-all try protect handle deadline valve valve
                           on on begin join turn listen await))
                    (one '(wait wait fail think pulse set set await await turn turn listen hear)))))
      (ecase kind
        ((wait fail think) (list kind (span)))
        (pulse (list 'pulse (base:roll-index 4 dice)))
        (set (list 'set (base:roll-index 4 dice) (one '(t t nil))))
        (await (list* 'await (base:roll-index 4 dice) (one (list '() (list (span))))))
        (turn (list 'turn (base:roll-index 100 dice)))
        (listen '(listen))
        (hear (list 'hear (one *robots-to-use*)))
        (on (list 'on (one *robots-to-use*) (part)))
        ((seq try par pursue try-all) (cons kind (parts)))
        ((protect handle deadline) (list kind (part) (span)))
        (valve (if valves
                   (let ((valve (one valves)))
                     (list 'valve valve (part (remove-if-not (lambda (v) (> v valve)) valves))))
                   (list 'wait (span))))
        (begin (cons 'begin (begun '(0 1))))
        (join (cons 'join (begun valves)))))))

(defun random-ending (robots ids hermit dice)
  (let ((tick (base:roll-index 4000 dice)))
    (cons tick
          (ecase (base:roll-index 5 dice)
            ((0 1) (list 'end (base:roll-element ids dice)))
            (2 (list 'end-robot (base:roll-element robots dice)))
            (3 (if hermit (list 'init hermit) (list 'end (base:roll-element ids dice))))
            (4 (list 'end-all))))))

(defstruct (robot-case (:conc-name case-)) robots deeds charged-p plans)

(defun random-case (dice kills-p)
  "Return a random case: plans of two to five robots and, if KILLS-P is true, their early ends. No
other robot drives the robot of an INIT."
  (let* ((*next-id* 0)
         (robots (subseq '(abe bea kit deb eve) 0 (+ 2 (base:roll-index 4 dice))))
         (hermit (and kills-p (base:chance 1/2 dice) (first (last robots))))
         (*robots-to-use* (remove hermit robots))
         (begins (loop for robot in (append robots (when (base:chance 1/3 dice) robots))
                       collect (list (if (base:chance 1/8 dice) 0 (base:roll-index 2000 dice))
                                     'begin (incf *next-id*) robot (random-robot-plan 4 dice))))
         (ids (loop for id from 1 to *next-id* collect id)))
    (make-robot-case
     :robots robots
     :plans *next-id*
     :charged-p (base:chance 1/2 dice)
     :deeds (stable-sort (append begins
                                 (when kills-p
                                   (loop repeat (1+ (base:roll-index 3 dice))
                                         collect (random-ending robots ids hermit dice))))
                         #'< :key #'first))))

(defun case-by-model (case order)
  (ends-by-model (case-robots case) (case-deeds case) order (case-charged-p case)))

(defun case-really (case stops)
  (with-robots-of-case ((case-robots case) (case-charged-p case))
    (really (case-deeds case) stops (shared-by-plans) '())))

(defun admissible-p (case last)
  "True if the plans of CASE really end as they do by the model in some of 1000 random orders."
  (let ((ends (case-really case (loop for tick from 0 to (+ 10000 last) collect tick)))
        (dice (base:make-dice 1 "orders")))
    (values (loop repeat 300 thereis (equal ends (case-by-model case dice)))
            ends)))

(defun trouble-with-case (case)
  "Return what is wrong with the real ends of plans of CASE, or NIL; and true if the model has other
ends in another order."
  (multiple-value-bind (ends last) (case-by-model case :first)
    (let ((stops (stops-for ends (case-deeds case) (+ 30 last)))
          (order-matters-p (not (equal ends (case-by-model case :last)))))
      (values (unless (equal ends (case-really case stops))
                (multiple-value-bind (admissible-p real) (admissible-p case last)
                  (unless admissible-p (list case :model ends :real real))))
              order-matters-p))))

(defun troubles-with-random-cases (count seed kills-p)
  "Return what is wrong with COUNT random cases, how many plans these begin at most, and in how many
cases the order within a tick matters."
  (let ((dice (base:make-dice seed "plans of robots")) (troubles '()) (plans 0) (ordered 0))
    (dotimes (i count (values troubles plans ordered))
      (let ((case (random-case dice kills-p)))
        (incf plans (case-plans case))
        (multiple-value-bind (trouble order-matters-p) (trouble-with-case case)
          (when trouble (push trouble troubles))
          (when order-matters-p (incf ordered)))))))

(test plans.of-several-robots-end-when-and-how-the-model-says
  (is (null (troubles-with-random-cases 100 1 nil))))

(test plans.of-several-robots-that-are-ended-end-when-and-how-the-model-says
  (is (null (troubles-with-random-cases 100 2 t))))

;;; Rewinds and forks at random points.

(defun find-plans-again ()
  "After a rewind, note the tasks of the run that goes on, and forget those that began later."
  (setf *begun* (loop for (id . task) in *begun*
                      for twin = (handler-case (driver::task-in-current-run task)
                                   (base:misuse () nil))
                      when twin collect (cons id twin))))

(defun from-tick (tick stops)
  (cons tick (remove tick stops :test #'>=)))

(defun trouble-with-rewind (case dice)
  "Return what is wrong with CASE if its run is rewound at a random tick, or NIL. If the order
within a tick matters, do not try CASE."
  (multiple-value-bind (ends last) (case-by-model case :first)
    (let* ((deeds (case-deeds case))
           ;; A rewind to tick 0 would undo how slowly the robots turn.
           (at (+ 2 (base:roll-index (1+ last) dice)))
           (to (1+ (base:roll-index (1- at) dice)))
           (stops (stops-for ends deeds (+ 30 last)))
           (undisturbed (case-really case stops)))
      (with-robots-of-case ((case-robots case) (case-charged-p case) :keep t)
        (let ((shared (shared-by-plans)))
          (unless (equal ends undisturbed) (return-from trouble-with-rewind nil))
          (really deeds (append (remove at stops :test #'<=) (list at)) shared '())
          (run:rewind (- at to))
          (find-plans-again)
          (let ((ends (really (remove to deeds :key #'first :test #'>) (from-tick to stops) shared
                              (remove to undisturbed :key #'second :test #'<=))))
            (unless (equal undisturbed ends)
              (list case :at at :to to :undisturbed undisturbed :rewound ends))))))))

(defun troubles-with-rewinds (count seed)
  (let ((dice (base:make-dice seed "rewinds of robots")))
    (loop repeat count
          for trouble = (trouble-with-rewind (random-case dice t) dice)
          when trouble collect trouble)))

(test plans.of-several-robots-go-on-the-same-way-after-a-rewind
  (is (null (troubles-with-rewinds 40 3))))
