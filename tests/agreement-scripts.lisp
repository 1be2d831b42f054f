;;;; agreement-scripts.lisp -- random scripts: what is asked of a run and when, as data.

(in-package :ars-magna.tests)

(def-suite* agreement :in ars-magna)

;;; A script has a world, robots and a list of actions: requests between ticks, and what an observer
;;; does inside of ticks. It refers to things, parts and designators by their index among those that
;;; exist, so runs in the same state do the same. Nothing outside of a run has an effect.

(defstruct script
  "The requests to a run: CLAUSES of a map of WIDTH and HEIGHT, ROBOTS as DEFINE-ROBOT takes them,
and STEPS, (tick :between deed) or (tick :observer deed). At the tick AT the run is forked, saved
and rewound to; if LATE-P, after the steps between ticks. KEEP is the number of forks kept, STRIDE
the number of ticks passed at once."
  (seed 0) (width 12) (height 12) (clauses '()) (robots '()) (thinking :free)
  (keep 2) (stride 1) (ticks 0) (at 0) (late-p nil) (steps '()))

(defvar *script* nil "The script of the run here.")

;;; What the words in a deed mean.

(defun nth-of (index list)
  "Return the element of LIST that INDEX means; leave the deed if there is none."
  (if list
      (nth (mod index (length list)) list)
      (throw 'no-deed nil)))

(defun robots-by-name ()
  (sort (copy-list (run:simulation-robots time:*simulation*)) #'string<
        :key (lambda (robot) (string (robot:robot-name robot)))))

(defun parts-here (reader)
  (loop for robot in (robots-by-name) append (coerce (funcall reader robot) 'list)))

(defun things-here ()
  (sort (copy-list (world:world-thing-list world:*world*)) #'< :key #'world:thing-serial))

(defun designators-here ()
  (loop for robot in (robots-by-name)
        append (sort (copy-list (robot:live-designators robot)) #'<
                     :key #'robot:designator-number)))

(defun tasks-here ()
  (labels ((all (tasks) (loop for task in tasks
                              collect task append (all (rpl:task-children task)))))
    (all (driver:plans))))

(defun meant (word)
  "Return what WORD in a deed means here: itself unless it is a list of a keyword and an index."
  (if (typep word '(cons keyword (cons integer null)))
      (destructuring-bind (kind index) word
        (nth-of index (ecase kind
                        (:robot (robots-by-name))
                        (:camera (parts-here #'robot:robot-cameras))
                        (:hand (parts-here #'robot:robot-hands))
                        (:bin (parts-here #'robot:robot-bins))
                        (:sensor (parts-here #'robot:robot-sensors))
                        (:thing (things-here))
                        (:designator (designators-here))
                        (:task (tasks-here)))))
      word))

;;; Deeds. What must be there and is not, or is refused, is left out: in each run alike.

(defvar *deeds* (make-hash-table :test 'eq) "What deeds do, functions by name.")

(defmacro define-deed (name lambda-list &body body)
  "Let the deed (NAME argument...) do BODY, with LAMBDA-LIST bound to what the arguments mean."
  `(setf (gethash ',name *deeds*) (lambda ,lambda-list ,@body)))

(defun perform-deed (deed)
  "Do DEED in the run here."
  (catch 'no-deed
    (handler-case (apply (gethash (first deed) *deeds*) (mapcar #'meant (rest deed)))
      (base:ars-magna-error () nil))))

(defun perform-step-at (tick place)
  "Do what *SCRIPT* has to be done at TICK in PLACE."
  (loop for (at where deed) in (script-steps *script*)
        do (when (and (= at tick) (eq where place)) (perform-deed deed))))

;;; Continuations. A fork may have copies of them. Those of commands that were under way when a run
;;; was rewound or saved are not called there, which is documented. An observer then does in their
;;; place what they did.

(defvar *following* t "True where continuations are to do something.")
(defvar *followed* '() "What continuations did: (tick tick-of-asking deed...), the newest first.")
(defvar *left-to-observer* '()
  "What an observer is to do in the place of continuations, as *FOLLOWED*.")

(defun follow-script (asked deeds)
  "Do DEEDS, as a command that was ASKED for at a tick is over."
  (when *following*
    (push (list* (tick-of-run) asked deeds) *followed*)
    (mapc #'perform-deed deeds)))

(defun continuation-doing (deeds)
  "Return a continuation that does DEEDS, or NIL if there are none."
  (and deeds
       (let ((asked (tick-of-run)))
         (lambda (&rest results)
           (declare (ignore results))
           (follow-script asked deeds)))))

(defun look-on-script (simulation)
  "Do, as an observer, what is to be done in this tick of SIMULATION."
  (let ((tick (run:simulation-tick simulation)))
    (loop for (at nil . deeds) in *left-to-observer*
          do (when (= at tick) (mapc #'perform-deed deeds)))
    (perform-step-at tick :observer)))

;;; What is asked of robots.

(define-deed command (name resource arguments &rest deeds)
  (apply name resource (append (mapcar #'meant arguments)
                               (list (continuation-doing deeds)))))

(define-deed manipulate (name designator hand &rest deeds)
  (let ((continuation (continuation-doing deeds)))
    (command:run-manipulation name designator hand
                              (lambda (code value)
                                (when continuation (funcall continuation code value))))))

(define-deed turn-by-chance (robot) (command:robot-turn robot (random 2d0)))
(define-deed grab (resource) (time:grab-resource resource))

;;; What changes the world.

(define-deed move (thing x y) (world:move-thing thing x y))
(define-deed put (thing place) (world:move-thing thing place))
(define-deed set (thing key value) (world:set-attribute thing key value))
(define-deed kick (thing dx dy) (world:kick-thing thing dx dy t))
(define-deed destroy (thing) (world:destroy-thing thing))
(define-deed attach (thing kicker) (world:set-kicker thing kicker))
(define-deed put-kicker (thing other)
  (let ((count 0))
    (world:put-kicker accord-count (it thing) (:prob .3)
      (world:kick-thing it (/ (incf count) 10) 0 t)
      (world:kick-thing other 0 (/ count 10) t))))
(define-deed run-kicker (thing index)
  (world:run-kicker (nth-of index (world:thing-kickers thing))))
(define-deed make (name x y attributes kickers)
  (world:make-new-thing name (list world:*world* x y) attributes :kickers kickers))
(define-deed place (robot x y angle)
  (unless (robot:occupant-text (robot:robot-world robot) x y robot)
    (robot:place-robot robot x y angle)))
(define-deed seed (seed) (run:set-seed seed))
(define-deed parameter (symbol value) (setf (symbol-value symbol) value))
(define-deed thinking (mode) (run:set-thinking mode))

;;; Events. Closures refer to the robots and things of one run. No two events share a variable: in a
;;; repeated run, each has its own copies of the variables, as they were when its tick began.

(define-deed kick-later (thing timer dx dy)
  (time:schedule (nil :timer timer) (world:kick-thing thing dx dy nil)))

(define-deed kick-twice (thing timer dx dy)
  (time:schedule (nil :timer timer)
    (world:kick-thing thing dx dy nil)
    (time:schedule (nil :timer 5) (world:kick-thing thing dy dx nil))))

(define-deed count-and-kick (thing resource priority timer timeout)
  (let ((count 0))
    (flet ((count-on () (incf count)))
      (time:schedule (resource :priority priority :timer timer :timeout timeout
                               :when (= 3 (count-on))
                               :interrupt (world:kick-thing thing 0 (count-on) t))
        (world:kick-thing thing (/ (count-on) 5) 0 t)
        (time:schedule (resource :timer 2) (world:kick-thing thing 0 (/ (count-on) 5) t))))))

(define-deed kick-by-chance (thing timer)
  (time:schedule (nil :timer timer)
    (world:kick-thing thing (- (random 2d0) 1) (base:roll-within 1d0 (zoo-dice)) t)))

(define-deed command-later (robot timer angle &rest deeds)
  (time:schedule (nil :timer timer)
    (command:robot-turn robot angle (continuation-doing deeds))))

(define-deed do-later (resource priority timer deeds)
  (time:schedule (resource :timer timer :priority priority) (mapc #'perform-deed deeds)))

;;; Plans. A saved run has none, and does not know which robot they drove: that is chosen again.

(defun choose-robot-for-plans ()
  (unless (driver::usable-interface)
    (driver:rpl-init-robot (first (robots-by-name)))))

(define-deed begin (name &rest arguments)
  (choose-robot-for-plans)
  (when (< (length (driver:plans)) 4)
    (apply #'driver:begin-plan name arguments)))

(define-deed begin-text (seed)
  (choose-robot-for-plans)
  (when (< (length (driver:plans)) 4)
    (let ((things (list (rpl:create-fluent 'f) (rpl:create-fluent 'g) (rpl:create-fluent 'h)
                        (rpl:make-valve 'v) (rpl:make-valve 'w))))
      (driver:begin-plan (rpl:make-plan (random-plan-text things (base:make-dice seed "plan")))))))

(define-deed end (task) (driver:end-plan task))
(define-deed suspend (task) (rpl:suspend task))
(define-deed wake-up (task) (rpl:wake-up task))
(define-deed evaporate (task) (rpl:evaporate task))
(define-deed plan-turn (angle)
  (choose-robot-for-plans)
  (driver:rpl-robot-turn angle))
(define-deed pulse () (rpl:pulse driver:robot-stopped*))

(rpl:def-interp-proc shove-later (thing ticks)
  (rpl:n-times 20
    (rpl:wait-time ticks)
    (time:schedule (nil :timer 3) (world:kick-thing thing 0.2 0 t))
    (rpl:par (rpl:wait-time (random 3))
             (rpl:seq (driver:rpl-camera-turn 0 0.1d0) (rpl:wait-time 1)))))
