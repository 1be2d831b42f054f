;;;; issuing.lisp -- issue a command: refuse invalid calls, and warn about probable mistakes.

(in-package :ars-magna.command)

(export '(occupied-resource issue *caller-passes-ticks-p* between-runs-p *recorded-bindings*
          rebound-parameters warn-of-recorded-bindings requested-by-other-run-p))

;;; Arguments from another run.

(defun argument-robot (argument)
  (typecase argument
    (designator (designator-robot argument))
    (part (part-robot argument))))

(defun check-same-run (command resource arguments)
  (let ((world (robot-world (resource-robot resource))))
    (dolist (argument arguments)
      (let* ((robot (if (robot-p argument) argument (argument-robot argument)))
             (other (cond (robot (robot-world robot))
                          ((thing-p argument) (thing-world argument)))))
        (unless (or (null other) (eq other world))
          (reject-use "~(~A~): ~A belongs to another run than ~A. ~:[A robot's name and FIND-THING ~
                       return the object of this run~;Use a designator from a search of this ~
                       robot's cameras~]; (counterpart OBJECT FORK) returns the object of a fork."
                      (command-name command) argument resource (designator-p argument)))))))

;; Manipulations, and commands that users define, may be for two robots.
(defun check-own-arguments (command resource arguments)
  "Signal MISUSE if a part or designator in ARGUMENTS belongs to another robot than RESOURCE."
  (unless (or (command-guarded-p command) (eq :manipulating (command-family command)))
    (let ((robot (resource-robot resource)))
      (dolist (argument arguments)
        (unless (member (argument-robot argument) (list nil robot))
          (check-not-retired (argument-robot argument) (command-name command))
          (reject-use "~(~A~): ~A belongs to ~A, but ~A needs ~:[a part of its own~;a designator ~
                       from a search of its own cameras~]."
                      (command-name command) argument (argument-robot argument) robot
                      (designator-p argument)))))))

;;; Warnings given once for each name.

(defun continuation-arguments (command)
  (list* 'err (spec-name (command-resource command))
         (mapcar #'spec-name (command-results command))))

(defun misplaced-parameter-p (continuation told)
  "True if a parameter of CONTINUATION has the name of an argument that is passed in another
position. TOLD lists the names of the arguments."
  (multiple-value-bind (list unknown-p) (lambda-list-of continuation)
    (unless unknown-p
      (loop for name in list
            for place from 0
            until (member name lambda-list-keywords)
            do (let ((other (position name told :test #'string=)))
                 (when (and other (/= place other)) (return t)))))))

(defun continuation-fits-p (continuation told)
  "True if CONTINUATION can take the arguments with the names TOLD, as far as is known."
  (and (callable-with-count-p continuation (length told))
       (not (misplaced-parameter-p continuation told))))

(defun warn-of-continuation (command world continuation
                             &optional (told (continuation-arguments command)))
  "Warn once if CONTINUATION cannot take the arguments that COMMAND passes. TOLD lists their names."
  (let ((*print-pretty* nil))
    (when (and continuation
               (or (functionp continuation) (fboundp continuation))
               (not (continuation-fits-p continuation told)))
      (warn-once (list :continuation (command-name command)) world
                 (format nil "~(~A~): the continuation takes ~(~:A~), but is called with ~(~A~). ~
                              Write (continuation ~:*~(~A~) ...)."
                         (command-name command)
                         (lambda-list-of continuation)
                         told)))))

;; Programs give the same continuation again and again; its lambda list is then the same list. Any
;; thread may set the slot: each list in it has fitted.
(defun check-continuation (command world continuation)
  "Warn once if CONTINUATION cannot take the arguments that COMMAND passes."
  (let ((list (and (functionp continuation) (lambda-list-of continuation))))
    (cond ((and list (eq list (command-fitting command))))
          ((and list (continuation-fits-p continuation (continuation-arguments command)))
           (setf (command-fitting command) list))
          (t (warn-of-continuation command world continuation)))))

;;; One simulation inside another.

(defun other-run-request-key (world)
  (list :asked-elsewhere (world-tick world)))

(defun requested-by-other-run-p (world)
  "True if a program simulating another world issued a request to WORLD since WORLD's last tick."
  (warning-given-p (other-run-request-key world) world))

(defun record-other-run-request (world)
  "If a program in a simulation of another world issues a request to an idle WORLD, record this."
  (let ((timeline (world-timeline world)))
    (when (and *simulation*
               (not (eq timeline (timeline-of *simulation*)))
               (from-program-p)
               (not (live-p timeline))
               (not (timeline-passing-p timeline)))
      (first-warning-for-key-p (other-run-request-key world) world))))

;;; Two commands without a tick between them.

(defun takes-time-p (command)
  "True if COMMAND takes time and newer ones interrupt it; false if it only stops something."
  (not (or (command-instant-p command) (trait-p :stops command))))

(defun from-program-p ()
  "True if a program or a continuation issues the command, not a plan, the prompt or a journal."
  (or (null *asker*)
      (and (stringp *asker*) (starts-with-subseq "the continuation of " *asker*))))

(defun pending-request (resource timeline)
  "Return the last request on RESOURCE that has not begun and whose command takes time, or NIL."
  (find-if (lambda (request)
             (and (operation-p request)
                  (eq resource (operation-resource request))
                  (takes-time-p (operation-command request))))
           (timeline-inbox timeline)))

(defun operation-just-begun (resource timeline)
  "Return RESOURCE's operation if it began in the last tick of a live run and takes time, or NIL."
  (let ((event (resource-event resource)))
    (and (operation-p event)
         (live-p timeline)
         (takes-time-p (operation-command event))
         (<= (timeline-tick timeline) (1+ (operation-asked event)))
         event)))

(defun may-replace-p (command resource arguments before)
  "True if COMMAND may be meant to replace BEFORE, an operation of the same command: RESOURCE is a
part, ARGUMENTS are empty or differ from those of BEFORE, or the world is a resident world, where
BEFORE may be left over from earlier work. No message replaces another."
  (and (eq command (operation-command before))
       (not (radio-p resource))
       (not (and (robot-p resource)
                 arguments
                 (equal arguments (operation-arguments before))
                 (let ((world (robot-world resource)))
                   (not (eq world (map-resident (world-map world)))))))))

(defun warn-if-interrupting (command resource arguments timeline)
  "Warn, once for each pair of commands, if COMMAND interrupts a command of RESOURCE that the same
program has just issued without a continuation: in this tick or, in a live run, in the last tick."
  (when (takes-time-p command)
    (let ((before (or (pending-request resource timeline)
                      (operation-just-begun resource timeline))))
      (when (and before
                 (from-program-p)
                 (not (may-replace-p command resource arguments before))
                 (null (operation-continuation before))
                 (equal (current-asker-note) (request-asker before)))
        (warn-of-interrupting (operation-command before) command resource)))))

(defun warn-of-interrupting (before command resource)
  (let ((*print-pretty* nil))
    (warn-once (list :hurry (command-name before) (command-name command))
               (robot-world (resource-robot resource))
               (format nil "~(~A~) does nothing: ~(~A~) was issued before a tick had passed, and ~
                            ~A carries out one command at a time. Issue the second command in the ~
                            continuation of the first, (~(~A~) ... (continuation ~(~A~) (~(~A~) ~
                            ...))), or let ticks pass in between: ~:[(run-ticks N)~;(await-idle)~]."
                       (command-name before) (command-name command) resource
                       (command-name before) (continuation-arguments before) (command-name command)
                       (live-p (world-timeline (robot-world (resource-robot resource))))))))

(defun warn-if-repeating (command resource arguments timeline)
  "Warn once if a program in a headless run repeats COMMAND, a relative turn of RESOURCE by
ARGUMENTS, while the same turn is in progress without a continuation. The turn then starts over."
  (let ((before (resource-event resource)))
    (when (and (operation-p before)
               (eq command (operation-command before))
               (trait-p :turns command)
               (not (live-p timeline))
               (from-program-p)
               (not (operation-finished-p before))
               (null (operation-continuation before))
               (equal arguments (operation-arguments before))
               (equal (current-asker-note) (request-asker before)))
      (warn-of-repeating command (- (timeline-tick timeline) (operation-asked before)) resource))))

(defun warn-of-repeating (command ticks resource)
  (let ((*print-pretty* nil))
    (warn-once (list :again (command-name command))
               (robot-world (resource-robot resource))
               (format nil "~(~A~) was issued again after ~D tick~:P, before it had ended: it was ~
                            interrupted and started over. Run more ticks with (run-ticks N), or ~
                            issue the command again in its (continuation ~(~A~) ...)."
                       (command-name command) ticks (continuation-arguments command)))))

(defun warn-of-arguments (command world arguments)
  (loop for spec in (command-parameters command)
        for argument in arguments
        do (case (spec-type spec)
             (angle (warn-of-angle-in-degrees (command-name command) world argument))
             (ticks (when (minusp argument)
                      (warn-once (list :ticks (command-name command)) world
                                 (format nil "~(~A~): ~A ticks do nothing.~@[ To drive back, turn ~
                                              by pi first.~]"
                                         (command-name command) argument
                                         (trait-p :drives command))))))))

(defvar *recorded-bindings* '()
  "The commands that a program has issued in a headless run since the last tick, under other
parameter values than the run's. Each is a list (command world (parameter . value)...).")

(defgeneric rebound-parameters (timeline world)
  (:documentation "Return a list of pairs (symbol . value): the parameters that the caller has bound
to other values than the run of TIMELINE in WORLD uses.")
  (:method (timeline world) (declare (ignore timeline world)) '()))

(defun warn-of-bindings (command world bindings)
  "Warn once for COMMAND if it runs with other parameter values than it was issued with."
  (loop for (symbol . value) in bindings
        unless (eql value (symbol-value symbol))
          do (warn-once (list :bound (command-name command)) world
                        (format nil "~(~A~) was issued while ~(~A~) was ~A, but is carried out ~
                                     while it is ~A: parameters count when ticks pass. Call ~
                                     (run-ticks N) inside the LET, or write (with-simulation ~
                                     (ROBOT :parameters '((~3:*~(~A~) ~A))) ...)."
                                (command-name command) symbol value (symbol-value symbol)))))

(defun warn-of-recorded-bindings (world)
  "When ticks of WORLD pass, warn once for each command that runs with other parameter values than
it was issued with. Then forget the recorded parameters."
  (loop for (command asked . bindings) in (reverse *recorded-bindings*)
        when (eq asked world) do (warn-of-bindings command world bindings))
  (setf *recorded-bindings* (remove world *recorded-bindings* :key #'second :test #'eq)))

(defun warn-of-thread-bindings (command world bindings)
  "Warn once that BINDINGS of this thread have no effect on COMMAND in the live run of WORLD."
  (loop for (symbol . value) in bindings
        do (warn-once (list :bound (command-name command)) world
                      (format nil "~(~A~) is carried out in the simulator's thread, where ~(~A~) ~
                                   is ~A, not ~A as in this LET. Write (setf ~1@*~(~A~) ~3@*~A)."
                              (command-name command) symbol (global-value symbol) value))))

(defun record-bindings (command world)
  "Unless WORLD is in a tick, record the parameters that COMMAND finds bound. Warn in a live run."
  (let ((timeline (world-timeline world)))
    (unless (or (asker-forked-p *asker*) (timeline-passing-p timeline))
      (let ((bindings (rebound-parameters timeline world)))
        (cond ((null bindings))
              ((live-p timeline) (warn-of-thread-bindings command world bindings))
              (t (push (list* command world bindings) *recorded-bindings*)))))))

(defun between-runs-p (world)
  "True if requests to robots in WORLD, a resident world, wait for a run to start or continue."
  (let ((timeline (world-timeline world)))
    (and (eq world (map-resident (world-map world)))
         (not (live-p timeline))
         (not (timeline-passing-p timeline)))))

(defun resource-form (resource)
  "Return a form whose value is RESOURCE, a robot or part, in a run of its robot."
  (let ((name (robot-name (resource-robot resource)))
        (index (and (part-p resource) (part-index resource))))
    (etypecase resource
      (robot name)
      (camera `(robot-camera ,name ,index))
      (hand `(robot-hand ,name ,index))
      (storage-bin `(robot-storage-bin ,name ,index))
      (part `(robot-part ,name ,(make-keyword (type-of resource)) ,index)))))

(defun how-to-run-text (resource)
  (let* ((robot (resource-robot resource)) (name (robot-name robot)) (world (robot-world robot)))
    (cond ((or (null *world*)
               (eq *world* world)
               (not (eq (world-map world) (world-map *world*))))
           (format nil "(simulator '~(~A~)) starts a live run, which carries out the command; ~
                        (run-ticks N) carries it out without a live run." name))
          ((find name (world-robots *world*) :key #'robot-name)
           (format nil "This ~(~A belongs to the ~A~) outside of this WITH-SIMULATION, which has a ~
                        separate ~(~A~). Inside WITH-SIMULATION, write ~(~A~)."
                   (type-of resource) name name (safe-text (resource-form resource))))
          (t (format nil "A robot is in the run of WITH-SIMULATION if WITH-SIMULATION names the ~
                          robot, as in (with-simulation ((ROBOT ~(~A~))) ...)." name)))))

(defvar *caller-passes-ticks-p* nil
  "True if the caller lets ticks pass for its commands, or itself reports that no ticks pass.")

(defun warn-if-postponed (command resource robot)
  "Warn if COMMAND is kept for a later run: once for ROBOT, the robot of RESOURCE, and again for
each WITH-SIMULATION that binds the name of ROBOT in another thread. Do not warn of commands from
plans, because running a plan passes ticks."
  (when (and (between-runs-p (robot-world robot))
             (not (asker-forked-p *asker*))
             (not *caller-passes-ticks-p*))
    (multiple-value-bind (elsewhere number) (other-thread-robot-text (robot-name robot))
      (warn-once (list :kept (robot-name robot) number) (robot-world robot)
                 (format nil "~(~A~) is kept for a later run, because no run of ~A is in progress. ~
                              ~A"
                         (command-name command) robot (or elsewhere (how-to-run-text resource)))))))

;;; Issuing.

(defun occupied-resource (command resource)
  "Return what COMMAND on RESOURCE occupies: RESOURCE, or a part of it, such as the robot's radio."
  (let ((reader (command-occupies command)))
    (if reader (funcall reader resource) resource)))

(defun arguments-to-issue (command resource arguments)
  "Return ARGUMENTS of COMMAND on RESOURCE with their lists and vectors copied, and checked by the
function that COMMAND names for this."
  (let ((arguments (if (some (lambda (argument) (typep argument '(or cons vector))) arguments)
                       (copy-argument (command-name command) "arguments" arguments)
                       arguments))
        (checker (command-checker command)))
    (if checker (apply checker resource arguments) arguments)))

(defun issue (command resource arguments continuation)
  "Issue COMMAND on RESOURCE with ARGUMENTS, which have been checked. Copy lists and vectors in
ARGUMENTS. CONTINUATION may be NIL. Return nothing: the command takes effect in the next tick.
Signals MISUSE if the run is over, or if an argument belongs to another run or another robot."
  (check-not-retired resource (command-name command))
  (check-same-run command resource arguments)
  (check-own-arguments command resource arguments)
  (let* ((robot (resource-robot resource))
         (world (robot-world robot))
         (timeline (world-timeline world))
         (arguments (arguments-to-issue command resource arguments)))
    (count-request (occupied-resource command resource))
    (warn-if-interrupting command (occupied-resource command resource) arguments timeline)
    (warn-if-repeating command (occupied-resource command resource) arguments timeline)
    (post (make-operation command (occupied-resource command resource) arguments
                          (if (continuation-suppressed-p timeline) nil continuation)
                          timeline)
          timeline)
    (warn-of-arguments command world arguments)
    (record-bindings command world)
    (record-other-run-request world)
    (check-continuation command world continuation)
    (warn-if-postponed command resource robot)
    (values)))
