;;;; issuing.lisp -- issue a command: refuse invalid calls, and warn about probable mistakes.

(in-package :ars-magna.command)

(export '(issue *ticks-follow-p* between-runs-p *asked-with* parameters-bound doubt-asked-with
          asked-elsewhere-p))

;;; Arguments from another run.

(defun argument-robot (argument)
  (typecase argument
    (designator (designator-robot argument))
    (part (part-robot argument))))

(defun check-of-this-run (command resource arguments)
  (let ((world (robot-world (resource-robot resource))))
    (dolist (argument arguments)
      (let* ((robot (if (robot-p argument) argument (argument-robot argument)))
             (other (cond (robot (robot-world robot))
                          ((thing-p argument) (thing-world argument)))))
        (unless (or (null other) (eq other world))
          (reject-use "~(~A~): ~A is of another run than ~A. ~:[Robots' names and FIND-THING lead ~
                       to those of a run~;A robot's designators come from searches of its cameras~
                       ~]; of a fork, (counterpart OBJECT FORK) is what one is there."
                      (command-name command) argument resource (designator-p argument)))))))

;;; Warnings given once for each name.

(defun continuation-arguments (command)
  (list* 'err (spec-name (command-resource command))
         (mapcar #'spec-name (command-results command))))

(defun misplaced-parameter-p (continuation told)
  "True if CONTINUATION calls a parameter by the name of an argument in another position of TOLD."
  (multiple-value-bind (list unknown-p) (lambda-list-of continuation)
    (unless unknown-p
      (loop for name in list
            for place from 0
            until (member name lambda-list-keywords)
            do (let ((other (position name told :test #'string=)))
                 (when (and other (/= place other)) (return t)))))))

(defun doubt-continuation (command world continuation
                           &optional (told (continuation-arguments command)))
  "Warn once if CONTINUATION cannot be called with TOLD, the names of what COMMAND passes to it."
  (let ((*print-pretty* nil))
    (when (and continuation
               (or (functionp continuation) (fboundp continuation))
               (or (not (callable-with-p continuation (length told)))
                   (misplaced-parameter-p continuation told)))
      (warn-once (list :continuation (command-name command)) world
                 (format nil "~(~A~): the continuation takes ~(~:A~), and is called with ~(~A~). ~
                              Write (continuation ~:*~(~A~) ...)."
                         (command-name command)
                         (lambda-list-of continuation)
                         told)))))

;;; One simulation inside another.

(defun asked-elsewhere (world)
  "Return the key for requests to WORLD in this tick from a simulation of another world."
  (list :asked-elsewhere (world-tick world)))

(defun asked-elsewhere-p (world)
  "True if a program has issued a request to WORLD inside a simulation of another world since the
last tick of WORLD."
  (said-p (asked-elsewhere world) world))

(defun note-asked-elsewhere (world)
  "Record that a program issues a request to WORLD, idle, inside a simulation of another world."
  (let ((timeline (world-timeline world)))
    (when (and *simulation*
               (by-program-p)
               (not (eq timeline (timeline-of *simulation*)))
               (not (live-p timeline))
               (not (timeline-passing-p timeline)))
      (first-time-p (asked-elsewhere world) world))))

;;; Two commands without a tick between them.

(defun takes-time-p (command)
  "True if COMMAND takes time and does not just stop the robot, so a newer one interrupts it."
  (not (or (command-instant-p command) (trait-p :stops command))))

(defun by-program-p ()
  "True if a program issues the command (a continuation too), not a plan, the prompt or a journal."
  (or (null *asker*)
      (and (stringp *asker*) (starts-with-subseq "the continuation of " *asker*))))

(defun not-begun (resource timeline)
  "Return the last request for a lasting command on RESOURCE that has not begun, or NIL."
  (find-if (lambda (request)
             (and (operation-p request)
                  (eq resource (operation-resource request))
                  (takes-time-p (operation-command request))))
           (timeline-inbox timeline)))

(defun just-begun (resource timeline)
  "Return the lasting command that RESOURCE, in a live run, has begun in the last tick, or NIL."
  (let ((event (resource-event resource)))
    (and (live-p timeline)
         (operation-p event)
         (takes-time-p (operation-command event))
         (<= (timeline-tick timeline) (1+ (operation-asked event)))
         event)))

(defun may-replace-p (command resource arguments before)
  "True if COMMAND may be meant to replace BEFORE, the same command: RESOURCE is a part, ARGUMENTS
are none or others, or BEFORE may be from an earlier time, as in a map's resident world."
  (and (eq command (operation-command before))
       (not (and (robot-p resource)
                 arguments
                 (equal arguments (operation-arguments before))
                 (let ((world (robot-world resource)))
                   (not (eq world (map-resident (world-map world)))))))))

(defun doubt-interrupting (command resource arguments timeline)
  "Warn once for a pair of commands if COMMAND, issued to RESOURCE with ARGUMENTS, interrupts one
that the same program issued in this tick (live: or the last), without a continuation."
  (when (and (by-program-p) (takes-time-p command))
    (let ((before (or (not-begun resource timeline) (just-begun resource timeline))))
      (when (and before
                 (not (may-replace-p command resource arguments before))
                 (null (operation-continuation before))
                 (equal (note-of-asker) (request-asker before)))
        (warn-of-interrupting (operation-command before) command resource)))))

(defun warn-of-interrupting (before command resource)
  (let ((*print-pretty* nil))
    (warn-once (list :hurry (command-name before) (command-name command))
               (robot-world (resource-robot resource))
               (format nil "~(~A~) does nothing: ~(~A~) was asked for before a tick has passed, ~
                            and ~A carries out one command at a time. Ask for that in the ~
                            continuation, (~(~A~) ... (continuation ~(~A~) (~(~A~) ...))), or ~
                            let ticks pass before it: ~:[(run-ticks N)~;(await-idle)~]."
                       (command-name before) (command-name command) resource
                       (command-name before) (continuation-arguments before) (command-name command)
                       (live-p (world-timeline (robot-world (resource-robot resource))))))))

(defun doubt-repeating (command resource arguments timeline)
  "Warn once if COMMAND starts over in a headless run: a relative turn of RESOURCE by ARGUMENTS that
the same program issues again while it is in progress without a continuation."
  (let ((before (resource-event resource)))
    (when (and (operation-p before)
               (eq command (operation-command before))
               (trait-p :turns command)
               (by-program-p)
               (not (live-p timeline))
               (not (operation-finished-p before))
               (null (operation-continuation before))
               (equal arguments (operation-arguments before))
               (equal (note-of-asker) (request-asker before)))
      (warn-of-repeating command (- (timeline-tick timeline) (operation-asked before)) resource))))

(defun warn-of-repeating (command ticks resource)
  (let ((*print-pretty* nil))
    (warn-once (list :again (command-name command))
               (robot-world (resource-robot resource))
               (format nil "~(~A~) was issued again after ~D tick~:P, when it had not ended: it ~
                            was interrupted, and began anew. Let it end by (run-ticks N) with more ~
                            ticks, or issue it again in its (continuation ~(~A~) ...)."
                       (command-name command) ticks (continuation-arguments command)))))

;; Manipulations, and commands that users define, may be for two robots.
(defun doubt-owners (command robot arguments)
  (unless (or (command-guarded-p command) (eq :manipulating (command-family command)))
    (dolist (argument arguments)
      (let ((owner (argument-robot argument)))
        (unless (member owner (list nil robot))
          (warn-once (list :owner (command-name command) (robot-name owner)) (robot-world robot)
                     (format nil "~(~A~): ~A belongs to ~A, not to ~A."
                             (command-name command) argument owner robot)))))))

(defun doubt-arguments (command world arguments)
  (loop for spec in (command-parameters command)
        for argument in arguments
        do (case (spec-type spec)
             (angle (doubt-angle (command-name command) world argument))
             (ticks (when (minusp argument)
                      (warn-once (list :ticks (command-name command)) world
                                 (format nil "~(~A~): ~A ticks do nothing.~@[ To drive back, turn ~
                                              by pi first.~]"
                                         (command-name command) argument
                                         (trait-p :drives command))))))))

(defvar *asked-with* '()
  "Lists (command world (parameter . value)...): the commands that programs have issued in headless
runs since the last tick, while parameters had other values than those of the run.")

(defgeneric parameters-bound (timeline world)
  (:documentation "Return a list (symbol . value) of the parameters that have another value here
than in the run of TIMELINE in WORLD.")
  (:method (timeline world) (declare (ignore timeline world)) '()))

(defun doubt-bindings (command world bindings)
  "Warn once for COMMAND if it runs with other parameters than it was issued with."
  (loop for (symbol . value) in bindings
        unless (eql value (symbol-value symbol))
          do (warn-once (list :bound (command-name command)) world
                        (format nil "~(~A~) was asked for while ~(~A~) was ~A, and is done while ~
                                     it is ~A: parameters count when ticks pass. Let them pass ~
                                     inside of the LET, by (run-ticks N), or write ~
                                     (with-simulation (ROBOT :parameters '((~3:*~(~A~) ~A))) ~
                                     ...)."
                                (command-name command) symbol value (symbol-value symbol)))))

(defun doubt-asked-with (world)
  "Warn once for each command that runs with other parameters than it was issued with, now that
ticks of WORLD pass. Then forget the recorded parameters."
  (loop for (command asked . bindings) in (reverse *asked-with*)
        when (eq asked world) do (doubt-bindings command world bindings))
  (setf *asked-with* (remove world *asked-with* :key #'second :test #'eq)))

(defun doubt-bindings-here (command world bindings)
  "Warn once for COMMAND, issued in WORLD, which runs live, that BINDINGS are of this thread."
  (loop for (symbol . value) in bindings
        do (warn-once (list :bound (command-name command)) world
                      (format nil "~(~A~) is done by the simulator, in whose thread ~(~A~) is ~A, ~
                                   not ~A, as LET has it here. Write (setf ~1@*~(~A~) ~3@*~A)."
                              (command-name command) symbol (global-value symbol) value))))

(defun note-bindings (command world)
  "Record parameters bound around COMMAND, issued in WORLD between ticks. In a live run, warn."
  (let ((timeline (world-timeline world)))
    (unless (or (asker-forked-p *asker*) (timeline-passing-p timeline))
      (let ((bindings (parameters-bound timeline world)))
        (cond ((null bindings))
              ((live-p timeline) (doubt-bindings-here command world bindings))
              (t (push (list* command world bindings) *asked-with*)))))))

(defun between-runs-p (world)
  "True if requests to a robot in WORLD, the resident world of a map, wait for a run to start or
continue."
  (let ((timeline (world-timeline world)))
    (and (eq world (map-resident (world-map world)))
         (not (live-p timeline))
         (not (timeline-passing-p timeline)))))

(defun resource-form (resource)
  "Return the form that returns RESOURCE, a robot or part, in a run of its robot."
  (let ((name (robot-name (resource-robot resource)))
        (index (and (part-p resource) (part-index resource))))
    (etypecase resource
      (robot name)
      (camera `(robot-camera ,name ,index))
      (hand `(robot-hand ,name ,index))
      (storage-bin `(robot-storage-bin ,name ,index))
      (part `(robot-part ,name ,(make-keyword (type-of resource)) ,index)))))

(defun how-to-run-text (resource)
  "Return in sentences how to have RESOURCE in a run."
  (let* ((robot (resource-robot resource)) (name (robot-name robot)) (world (robot-world robot)))
    (cond ((or (null *world*)
               (eq *world* world)
               (not (eq (world-map world) (world-map *world*))))
           (format nil "(simulator '~(~A~)) begins one and carries it out; (run-ticks N) does so ~
                         without." name))
          ((find name (world-robots *world*) :key #'robot-name)
           (format nil "This ~(~A is of the ~A~) outside of this WITH-SIMULATION, which has a ~
                        ~(~A~) of its own. Inside write ~(~A~)."
                   (type-of resource) name name (safe-text (resource-form resource))))
          (t (format nil "A robot is in the run of WITH-SIMULATION if it is named there, as ~(~A~) ~
                          is in (with-simulation ((ROBOT ~:*~(~A~))) ...)." name)))))

(defvar *ticks-follow-p* nil
  "True if the caller lets ticks pass for its commands, or reports that none do.")

(defun warn-if-kept (command resource robot)
  "Warn once for ROBOT, that of RESOURCE, if COMMAND is kept for a later run, and once for each
WITH-SIMULATION in another thread that binds its name. Not of plans: running one passes ticks."
  (when (and (between-runs-p (robot-world robot))
             (not (asker-forked-p *asker*))
             (not *ticks-follow-p*))
    (multiple-value-bind (elsewhere number) (bound-elsewhere-text (robot-name robot))
      (warn-once (list :kept (robot-name robot) number) (robot-world robot)
                 (format nil "~(~A~) is kept for a later run, as none of ~A is under way. ~A"
                         (command-name command) robot (or elsewhere (how-to-run-text resource)))))))

;;; Issuing.

(defun occupied (command resource)
  (let ((reader (command-occupies command)))
    (if reader (funcall reader resource) resource)))

(defun issue (command resource arguments continuation)
  "Issue COMMAND on RESOURCE with ARGUMENTS, which have been checked; lists are copied. CONTINUATION
may be NIL. Return nothing: the command takes effect in the next tick. Signals MISUSE if the robot's
run is over, or an argument is of another run."
  (check-in-run resource (command-name command))
  (check-of-this-run command resource arguments)
  (let* ((robot (resource-robot resource))
         (world (robot-world robot))
         (timeline (world-timeline world))
         (arguments (if (some #'consp arguments)
                        (copy-argument (command-name command) "arguments" arguments)
                        arguments)))
    (count-request (occupied command resource))
    (doubt-interrupting command (occupied command resource) arguments timeline)
    (doubt-repeating command (occupied command resource) arguments timeline)
    (post (make-operation command (occupied command resource) arguments
                          (if (untold-p timeline) nil continuation)
                          timeline)
          timeline)
    (doubt-arguments command world arguments)
    (note-bindings command world)
    (note-asked-elsewhere world)
    (doubt-owners command robot arguments)
    (doubt-continuation command world continuation)
    (warn-if-kept command resource robot)
    (values)))
