;;;; rolling-out.lisp -- one rollout of a plan, in a fork of its run or in a believed world.

(in-package :ars-magna.rpl-projecting)

(defun final-state-of-question (task question interface)
  "Return how TASK has ended. Without a TASK, return how the branch or plan of QUESTION has ended,
or else how the asking plan has. Return NIL if nothing has ended yet."
  (cond (task (final-state-of-task interface task))
        ((question-ended question))
        (t (final-state-of-task interface (task-top (wish-task question))))))

(defun valid-cost-p (object)
  "True if OBJECT is a valid cost: a real number or positive infinity, but not a NaN."
  (typecase object
    (float (or (finite-p object) (positive-infinity-p object)))
    (real t)))

(defun question-cost (question)
  "Return the value of QUESTION's function :COST, or NIL without :COST. Signals WRONG-ARGUMENT."
  (let ((function (question-option question :cost)))
    (when function
      (let ((cost (funcall function)))
        (unless (valid-cost-p cost)
          (reject-argument (question-operator question) :cost cost
                           "a function that returns a number, or positive infinity for the worst"))
        cost))))

(defun failed-rollout-values (condition &optional option)
  "Return the values of RUN-QUESTION-TO-END for a rollout that the error CONDITION has ended. OPTION
is the option whose code signalled CONDITION, or NIL."
  (values :failed (make-condition 'lisp-failure :condition condition) nil option nil))

;;; The measure of a question, read at the end of a rollout or sampled at each tick.

(defun make-meter (question)
  "Return two functions for QUESTION's option :MEASURE: one to call before the first tick and after
each tick, and one that then returns the measure's value; or NIL without :MEASURE."
  (multiple-value-bind (name summary) (parse-measure (question-option question :measure))
    (let ((numbers '()) (last nil))
      (values (lambda ()
                (when (and summary (not (eql last (simulation-tick))))
                  (setf last (simulation-tick))
                  (push (measured-number name) numbers)))
              (lambda ()
                (cond (summary (summary-of-numbers summary (reverse numbers)))
                      (name (measured-number name))))))))

(defun values-at-end (question how result measured)
  "Return the values of RUN-QUESTION-TO-END at the end of a rollout. MEASURED returns the measure."
  (let ((cost nil))
    (handler-case (setf cost (question-cost question))
      (error (condition)
        (return-from values-at-end (failed-rollout-values condition :cost))))
    (handler-case (values how result cost nil (funcall measured))
      (error (condition) (failed-rollout-values condition :measure)))))

(defun run-question-to-end (question interface begin over)
  "Call BEGIN, which starts the plan or branch of QUESTION and returns the task to watch or NIL. Let
ticks of the current simulation pass until the plan or branch has ended, or the function OVER,
called with the plan after each tick, returns a state. Return five values: the state, the result,
the cost, the option whose code signalled an error, or NIL, and the measure."
  (multiple-value-bind (sample measured) (make-meter question)
    (flet ((sample ()
             (handler-case (funcall sample)
               (error (condition)
                 (return-from run-question-to-end (failed-rollout-values condition :measure))))))
      (handler-case
          (let* ((last (+ (simulation-tick) (question-option question :horizon)))
                 (task (progn (sample) (funcall begin)))
                 (how (pass-until interface
                                  (lambda ()
                                    ;; The plan that asked may not wait for that any more.
                                    (when (and *current-question*
                                               (obsolete-wish-p *current-question*))
                                      (throw 'abandoned nil))
                                    (sample)
                                    (or (funcall over
                                                  (or task (task-top (wish-task question))))
                                        (final-state-of-question task question interface)))
                                  last)))
            (values-at-end question how (if task (task-result task) (question-result question))
                           measured))
        (error (condition) (failed-rollout-values condition))))))

;;; A plan that never waits would take a million steps in each tick, to no use. If another plan
;;; beside it is the one that never waits, the rollout goes on, though slowly.

(defun only-plan-ready-p (plan runner)
  (flet ((ready-p (plan) (find :ready (all-tasks plan) :key #'task-state)))
    (and (ready-p plan)
         (notany #'ready-p (remove plan (plan-runner-tasks runner))))))

(defun runaway-test (runner)
  "Return a function of a plan of RUNNER. It returns :RUNAWAY if, since its last call, at least
*RUNAWAY-LIMIT* steps were taken, and the plan is the only one that could go on at once."
  (let ((steps (counted-steps runner)))
    (lambda (plan)
      (let ((before (shiftf steps (counted-steps runner))))
        (when (and (<= *runaway-limit* (- steps before)) (only-plan-ready-p plan runner))
          :runaway)))))

(defun run-rollout (scene trial seed question interface begin)
  "Run the rollout number TRIAL of SCENE, with SEED, in the current run. Return the rollout. BEGIN
starts the plan or branch of QUESTION: see RUN-QUESTION-TO-END."
  (let* ((start (simulation-tick))
         (runner (interface-runner interface))
         (steps (counted-steps runner))
         (runaway (runaway-test runner))
         (trails '()))
    (multiple-value-bind (how result cost broken measure)
        (run-question-to-end question interface begin
                             (lambda (plan)
                               (setf trails (update-trails (current-simulation) trails))
                               (funcall runaway plan)))
      (make-rollout scene trial seed how result (- (simulation-tick) start) cost
                    (- (counted-steps runner) steps)
                    (trails-to-ways trails trial (outcome-word how))
                    broken measure))))

;;; Such a world is made by the user's function WORLD. It is called with a function and a seed; it
;;; must put things where they are believed to be, and call that function in a WITH-SIMULATION with
;;; that seed. Nothing there leads to the true run: that is not the current one, its robots are not
;;; bound, and no object of it is accepted as an argument. Objects of it in global variables can be
;;; read, but not changed or commanded. Fluents have a realm for each rollout.

(defun find-run-object (object)
  "Return an object of a run: OBJECT, or an element of the list or vector OBJECT; or NIL."
  (let ((seen (make-hash-table :test 'eq)))
    (labels ((look (object)
               (typecase object
                 ((or number symbol character string) nil)
                 ((or cons simple-vector)
                  (unless (gethash object seen)
                    (setf (gethash object seen) t)
                    (if (consp object)
                        (or (look (car object)) (look (cdr object)))
                        (some #'look object))))
                 ((or task entity) object)
                 (procedure (and (null (procedure-name object)) object))
                 (t (and (kind-of object) object)))))
      (look object))))

(defun check-no-run-objects (question)
  "Signal WRONG-ARGUMENT if QUESTION is about an object of this run, which believed worlds lack."
  (let ((object (or (question-subject question)
                    (find-run-object (list (question-plan question)
                                           (question-arguments question))))))
    (when object
      (reject-argument (question-operator question)
                       (if (question-subject question) 'plan :arguments)
                       object
                       (format nil "with :world, a plan that has a name, and arguments that belong ~
                                    to no run, such as numbers, symbols and lists of these")))))

(defun call-without-run (function)
  "Call FUNCTION without a current simulation, and with the robots' variables unbound. FUNCTION can
change only runs that it makes. Changes to existing fluents have no effect outside, as in a fork."
  (let ((robots (and *simulation* (simulation-robots *simulation*))))
    (progv (mapcar #'robot-name robots) '()
      (progv *simulation-variables* (mapcar #'symbol-value *simulation-variables*)
        (let ((*simulation* nil) (*world* nil) (*default-interface* nil)
              (*realm* (fork-realm *realm*)))
          (with-seclusion ("This object belongs to another run than the one that was made for ~
                            this code, and cannot be commanded or changed here. To get the objects ~
                            of this run, use names of robots, and FIND-THING.")
            (funcall function)))))))

(defun run-rollout-in-belief (scene trial seed)
  (unless *simulation*
    (reject-use "project: the function :world must call its argument, a function, inside of ~
                 (with-simulation ...)."))
  (let* ((question (rollout-start-question scene))
         (driver (driver-for-plan (question-robot question) (question-plan question))))
    (run-rollout scene trial seed question (driver-interface driver)
                 (lambda ()
                   (begin-plan-with-driver
                    driver (question-plan question) (question-arguments question)
                    #'identity)))))

(defun make-failed-rollout (scene trial seed condition)
  (multiple-value-bind (how result cost broken) (failed-rollout-values condition :world)
    (make-rollout scene trial seed how result 0 cost 0 '() broken)))

(defun roll-out-in-belief (scene trial seed then)
  "Run the rollout number TRIAL of SCENE, with SEED, in a believed world. At its end, call the
function THEN with the rollout in that world, and return the values of THEN."
  (let ((values '()) (called-p nil))
    (flet ((run ()
             (setf called-p t
                   values (multiple-value-list (funcall then (run-rollout-in-belief scene trial
                                                                                    seed))))))
      (handler-case
          (progn
            (call-without-run (lambda ()
                                (funcall (question-option (rollout-start-question scene) :world)
                                         #'run seed)))
            (unless called-p
              (reject-use "project: the function :world has not called its argument, a function.")))
        (error (condition)
          (setf values (list (funcall then (make-failed-rollout scene trial seed condition))))))
      (values-list values))))

;;; A run is forked once for a question: that fork, the moment, never goes on. Each rollout is a
;;; fork of it with its own seed; so all begin alike, also if the run goes on meanwhile, and
;;; any of them can be looked at again.

(defun call-with-rollout-settings (function print)
  "Call FUNCTION, which runs a rollout, outside of reactions of plans and without a debugger. Drop
the output of FUNCTION unless PRINT is true."
  (let ((*rolling-out* t)
        (*standard-output* (if print *standard-output* (make-broadcast-stream)))
        (*error-output* (if print *error-output* (make-broadcast-stream)))
        (*break-on-user-error* nil)
        (*break-on-plan-failures* nil)
        (*step-plans* nil)
        (*trace-plans* nil))
    (call-outside-reactions function)))

;;; The moment.

(defun disable-recording (moment)
  "Make MOMENT, a fork, keep no journal and no trace, and report no errors. Return MOMENT."
  (setf (simulation-journal moment) nil
        (message-queue-error-policy (simulation-messages moment)) :collect)
  (dolist (participant (simulation-participants moment))
    (when (interface-p participant) (stop-trace (interface-runner participant))))
  moment)

;;; The rollout.

(defun begin-rollout (question branch)
  "Begin the plan, or the branch number BRANCH, of QUESTION in a fork. Return the task whose end is
the end of the rollout, or NIL if NOTE-QUESTION-END records the end."
  (let ((interface (wish-interface question)) (task (wish-task question)))
    (call-with-plans (lambda ()
                       (cond ((null task) (forget-wish question))
                             ((question-branches question) (grant-wish question branch))
                             ((question-subject question)
                              (grant-wish question (projection-without-rollouts question)))
                             (t (grant-wish question :do-it))))
                     interface)
    (cond ((question-subject question))
          ((null task)
           (begin-plan-with-driver
            (question-driver question) (question-plan question) (question-arguments question)
            #'identity))
          ((and (question-branches question) (not (eq :branch (question-option question :until))))
           (task-top task)))))

(defun projection-without-rollouts (question)
  "Return the projection without rollouts that PROJECT returns for QUESTION in a rollout."
  (make-projection (question-text question) (simulation-tick) (question-option question :horizon)
                   '()))

(defun roll-out-in-fork (scene trial seed then)
  (let ((fork (fork-simulation (rollout-start-moment scene) :seed seed)))
    (unwind-protect
         (call-in-fork
          fork
          (lambda ()
            (let* ((original (rollout-start-question scene))
                   (interface (interface-of-simulation fork))
                   (question (find (question-token original)
                                   (remove-if-not #'question-p (interface-wishes interface))
                                   :key #'question-token)))
              (funcall then (run-rollout scene trial seed question interface
                                         (lambda ()
                                           (begin-rollout question
                                                          (rollout-start-branch scene))))))))
      (release-fork fork))))

(defun roll-out (scene trial seed &key (then #'identity) print)
  "Run the rollout number TRIAL of SCENE, with SEED. At its end, call the function THEN with the
rollout, inside of its run, and return the values of THEN. No other run changes. Drop the output of
plans unless PRINT, or the option :PRINT of the question, is true."
  (let* ((question (rollout-start-question scene))
         (output *standard-output*) (errors *error-output*)
         (then (lambda (rollout)
                 (let ((*standard-output* output) (*error-output* errors))
                   (funcall then rollout)))))
    (call-with-rollout-settings (lambda ()
                                  (let ((*fork-operator* (question-operator question)))
                                    (if (rollout-start-moment scene)
                                        (roll-out-in-fork scene trial seed then)
                                        (roll-out-in-belief scene trial seed then))))
                                (or print (question-option question :print)))))
