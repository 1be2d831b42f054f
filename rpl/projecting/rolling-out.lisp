;;;; rolling-out.lisp -- one rollout of a plan, in a fork of its run or in a believed world.

(in-package :ars-magna.rpl-projecting)

(defun end-of (task question interface)
  "Return how TASK, or else the asking task of QUESTION, has ended; NIL if it has not."
  (cond (task (final-state-of-task interface task))
        ((question-ended question))
        (t (final-state-of-task interface (task-top (wish-task question))))))

(defun cost-p (object)
  "True of real numbers, and of positive infinity, the worst; not of a NaN."
  (typecase object
    (float (or (finite-p object) (positive-infinity-p object)))
    (real t)))

(defun cost-of (question)
  "Return what the function :COST of QUESTION returns, or NIL without one. Signals WRONG-ARGUMENT."
  (let ((function (option question :cost)))
    (when function
      (let ((cost (funcall function)))
        (unless (cost-p cost)
          (reject-argument (question-operator question) :cost cost
                           "a function that returns a number, or positive infinity for the worst"))
        cost))))

(defun broken-off (condition &optional option)
  "Return the values of a rollout that CONDITION, an error of the function OPTION or of others, has
broken off: how it has ended, its result, no cost, and OPTION."
  (values :failed (make-condition 'lisp-failure :condition condition) nil option))

(defun with-cost (question how result)
  (handler-case (values how result (cost-of question))
    (error (condition) (broken-off condition :cost))))

(defun go-to-end (question interface begin over)
  "Call BEGIN, which returns the task whose end counts or NIL, and let ticks of the current
simulation pass until what QUESTION is about has ended, or OVER, called after each, says how.
Return how it has ended, its result, its cost, and the option whose function broke it off, if any."
  (handler-case
      (let* ((last (+ (simulation-tick) (option question :horizon)))
             (task (funcall begin))
             (how (pass-until interface
                              (lambda ()
                                ;; The plan that asked may not wait for that any more.
                                (when (and *asked* (obsolete-wish-p *asked*))
                                  (throw 'abandoned nil))
                                (or (funcall over) (end-of task question interface)))
                              last)))
        (with-cost question how (if task (task-result task) (question-result question))))
    (error (condition) (broken-off condition))))

;;; A plan that never waits would take a million steps in each tick, to no use.

(defun runaway-test (runner)
  "Return a function that returns :RUNAWAY if the plans of RUNNER have taken as many steps as a
reaction may, or more, since it was called last, or made."
  (let ((steps (counted-steps runner)))
    (lambda ()
      (let ((before (shiftf steps (counted-steps runner))))
        (when (<= *runaway-limit* (- steps before)) :runaway)))))

(defun run-rollout (scene trial seed question interface begin)
  "Run and return the rollout number TRIAL, with SEED, of SCENE, in this run: see GO-TO-END."
  (let* ((start (simulation-tick))
         (runner (interface-runner interface))
         (steps (counted-steps runner))
         (runaway (runaway-test runner))
         (trails '()))
    (multiple-value-bind (how result cost broken)
        (go-to-end question interface begin
                   (lambda ()
                     (setf trails (note-places (current-simulation) trails))
                     (funcall runaway)))
      (make-rollout scene trial seed how result (- (simulation-tick) start) cost
                    (- (counted-steps runner) steps)
                    (ways-along trails trial (outcome-word how))
                    broken))))

;;; Such a world is made by the user's function WORLD. It is called with a function and a seed; it
;;; must put things where they are believed to be, and call that function in a WITH-SIMULATION with
;;; that seed. Nothing there leads to the true run: that is not the current one, its robots are not
;;; bound, and no object of it is accepted as an argument. Objects of it in global variables can be
;;; read, but not changed or commanded. Fluents have a realm for each rollout.

(defun object-of-run (object)
  "Return OBJECT, or an object in it if it is a list or vector, that belongs to a run; or NIL."
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

(defun check-known-in-belief (question)
  "Signal WRONG-ARGUMENT if QUESTION is about an object that a world believed in cannot know."
  (let ((object (or (question-subject question)
                    (object-of-run (list (question-plan question)
                                         (question-arguments question))))))
    (when object
      (reject-argument (question-operator question)
                       (if (question-subject question) 'plan :arguments)
                       object
                       (format nil "what a plan can know in another world: :world goes with plans ~
                                    that have names, and arguments such as numbers, names and ~
                                    lists of them")))))

(defun call-without-run (function)
  "Call FUNCTION where there is no current simulation, no robot of one is bound, other runs than
those that FUNCTION makes cannot be changed, and fluents of outside are as in a fork."
  (let ((robots (and *simulation* (simulation-robots *simulation*))))
    (progv (mapcar #'robot-name robots) '()
      (progv *simulation-variables* (mapcar #'symbol-value *simulation-variables*)
        (let ((*simulation* nil) (*world* nil) (*interface* nil) (*realm* (fork-realm *realm*)))
          (with-seclusion (funcall function)))))))

(defun run-in-belief (scene trial seed)
  (unless *simulation*
    (reject-use "project: the function :world must call the function that it is given inside of ~
                 (with-simulation ...)."))
  (let ((question (scene-question scene)) (interface (ensure-interface)))
    (run-rollout scene trial seed question interface
                 (lambda ()
                   (begin-plan-in-interface
                    interface (question-plan question) (question-arguments question)
                    #'identity)))))

(defun no-rollout (scene trial seed condition)
  (multiple-value-bind (how result cost broken) (broken-off condition :world)
    (make-rollout scene trial seed how result 0 cost 0 '() broken)))

(defun roll-out-in-belief (scene trial seed then)
  "Return the values of THEN, a function that is called with the rollout number TRIAL, with SEED, of
SCENE, where that has ended in the world that the question believes in."
  (let ((values '()) (called-p nil))
    (flet ((run ()
             (setf called-p t
                   values (multiple-value-list (funcall then (run-in-belief scene trial seed))))))
      (handler-case
          (progn
            (call-without-run (lambda ()
                                (funcall (option (scene-question scene) :world) #'run seed)))
            (unless called-p
              (reject-use "project: the function :world has not called the function given to it.")))
        (error (condition)
          (setf values (list (funcall then (no-rollout scene trial seed condition))))))
      (values-list values))))

;;; A run is forked once for a question: that fork, the moment, never goes on. Each rollout is a
;;; fork of it with its own seed; so all begin alike, also if the run goes on meanwhile, and
;;; any of them can be looked at again.

(defun call-undisturbed (function print)
  "Call FUNCTION, which runs a rollout, as if no plan were at work around it, without a debugger.
What it writes is dropped unless PRINT is true."
  (let ((*rolling-out* t)
        (*standard-output* (if print *standard-output* (make-broadcast-stream)))
        (*error-output* (if print *error-output* (make-broadcast-stream)))
        (*break-on-user-error* nil)
        (*break-on-plan-failures* nil)
        (*step-plans* nil)
        (*trace-plans* nil))
    (call-apart function)))

;;; The moment.

(defun drop-records (moment)
  "Make MOMENT, a fork, keep no journal and no trace, and report no errors. Return it."
  (setf (simulation-journal moment) nil
        (message-queue-error-policy (simulation-messages moment)) :collect)
  (dolist (participant (simulation-participants moment))
    (when (interface-p participant) (stop-trace (interface-runner participant))))
  moment)

;;; The rollout.

(defun begin-rollout (question branch)
  "Begin what QUESTION, of a fork, asks about: its BRANCH, if it has any. Return the task whose end
counts, or NIL: see NOTE-ENDED."
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
           (begin-plan-in-interface
            interface (question-plan question) (question-arguments question) #'identity))
          ((and (question-branches question) (not (eq :branch (option question :until))))
           (task-top task)))))

(defun projection-without-rollouts (question)
  "Return the projection without rollouts that PROJECT returns for QUESTION in a rollout."
  (make-projection (question-text question) (simulation-tick) (option question :horizon) '()))

(defun roll-out-in-fork (scene trial seed then)
  (let ((fork (fork-simulation (scene-moment scene) :seed seed)))
    (unwind-protect
         (call-in-fork
          fork
          (lambda ()
            (let* ((original (scene-question scene))
                   (interface (interface-of (interface-robot (wish-interface original)) fork))
                   (question (find (question-token original)
                                   (remove-if-not #'question-p (interface-wishes interface))
                                   :key #'question-token)))
              (funcall then (run-rollout scene trial seed question interface
                                         (lambda ()
                                           (begin-rollout question (scene-branch scene))))))))
      (release-fork fork))))

(defun roll-out (scene trial seed &key (then #'identity) print)
  "Return the rollout number TRIAL, with SEED, of SCENE; or what THEN returns, which is called with
it where it has ended. Nothing happens in any other run. What plans write there is lost unless PRINT
is true, or the option :PRINT of the question."
  (let* ((question (scene-question scene))
         (output *standard-output*) (errors *error-output*)
         (then (lambda (rollout)
                 (let ((*standard-output* output) (*error-output* errors))
                   (funcall then rollout)))))
    (call-undisturbed (lambda ()
                     (let ((*fork-asker* (question-operator question)))
                       (if (scene-moment scene)
                           (roll-out-in-fork scene trial seed then)
                           (roll-out-in-belief scene trial seed then))))
                   (or print (option question :print)))))
