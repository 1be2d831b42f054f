;;;; headless.lisp -- WITH-SIMULATION: runs whose ticks pass only when asked for.

(in-package :ars-magna.run)

(export '(fresh-simulation *rewound-end-hooks*))

;;; WITH-SIMULATION makes a fresh world, with fresh robots in it, for its extent.

(defun fresh-simulation (robots &key (seed 0) journal (thinking :free) ghosts)
  "Return a new simulation of a fresh world, at tick 0. The world contains the things of the map and
fresh ROBOTS, given as for CALL-WITH-SIMULATION. If JOURNAL is true, the simulation keeps a journal.
THINKING is the thinking mode. If GHOSTS is true, robots have no bodies."
  (let* ((entries (parse-robots robots))
         (world (make-world (find-map (blueprint-map (robot-entry-blueprint (first entries))))
                            :seed seed)))
    ;; A journal may begin in any state.
    (unless (or ghosts (and (listp robots) (every #'robot-entry-p robots)))
      (check-entries-apart 'with-simulation entries))
    (setf (world-ghosts-p world) (and ghosts t))
    (dolist (entry entries) (make-robot-of-entry entry world))
    (arrange-robots world)
    (let ((simulation (make-simulation world)))
      (set-initial-thinking simulation thinking)
      (when journal (begin-journal simulation))
      simulation)))

(defun make-robot-of-entry (entry world)
  (let ((start (robot-entry-start entry)))
    (when start (warn-of-angle-in-degrees 'with-simulation world (third start)))
    (make-robot (robot-entry-blueprint entry) world :name (robot-entry-name entry) :start start)))

(defun call-leaving-current-run (settings function)
  "Call FUNCTION, which starts a headless run, with parameters bound as CALL-WITH-PARAMETERS does.
Store the variables of the current run, if any, before they are bound anew."
  (when *simulation* (store-environment *simulation*))
  (call-with-parameters settings function))

(addition call-with-simulation)
(defun call-with-simulation (function robots &key (seed 0) parameters clean journal keep ghosts
                                               (thinking :free) (errors :report) variables)
  "Call FUNCTION without arguments in a new headless simulation of ROBOTS, and return its values.
ROBOTS is a robot, its name, a list (NAME :as OTHER-NAME :at (x y) :angle a), or a list of these.
VARIABLES are symbols of any package. Like the names of ROBOTS, each is bound to the robot of that
name. The other arguments are options of WITH-SIMULATION."
  (check-argument with-simulation seed (integerp seed) "an integer")
  (check-thinking-mode 'with-simulation thinking)
  (check-argument with-simulation errors (typep errors 'error-policy)
                  ":report, :signal or :collect")
  (call-leaving-current-run
   parameters
   (lambda ()
     (check-parameters)
     (when clean
       (remove-noise-except (loop for (name) in parameters
                                  collect (parameter-symbol (find-parameter name)))))
     (let ((*message-queue* (make-message-queue :error-policy errors)))
       (call-in-headless-run function
                             (fresh-simulation robots :seed seed :journal journal :ghosts ghosts
                                                      :thinking thinking)
                             :variables variables :keep keep)))))

(defun call-in-headless-run (function simulation &key variables keep)
  "Call FUNCTION with the headless SIMULATION as the current simulation. Bind the names of its
robots to the robots. VARIABLES are further symbols to bind, each to the robot of the same name.
KEEP says how many forks the run keeps, see KEEP-FORKS. The run is over at the end."
  (let* ((*message-queue* (simulation-messages simulation))
         (*simulation* simulation)
         (*world* (simulation-world simulation))
         (*tick-dice* nil)
         (*recorded-bindings* '())
         (*saved-outer-globals* (list :around))
         (robots (simulation-robots simulation)))
    (setf (simulation-variables simulation)
          (append variables (mapcar #'robot-name robots) *simulation-variables*
                  (list *random-state-variable*)))
    (progv (simulation-variables simulation)
        (append (robots-named variables) robots (mapcar #'symbol-value *simulation-variables*)
                (list (or (simulation-dice simulation)
                          (seeded-random-state (simulation-seed simulation)))))
      (store-environment simulation)
      (in-any-case
        (call-recording-robot-names
         (remove-duplicates (append variables (mapcar #'robot-name robots)))
         (lambda ()
           (call-reporting-errors
            (lambda ()
              (initialize-run-variables simulation)
              (when keep (keep-forks keep simulation))
              (funcall function))
            simulation)))
        (restore-outer-globals)))))

(defun call-reporting-errors (function simulation)
  "Call FUNCTION in the headless SIMULATION; then end the run. Show or signal unread errors,
according to the error policy of the simulation's message queue."
  (let ((queue (simulation-messages simulation)) (left-p t))
    (multiple-value-prog1
        (in-any-case
          (multiple-value-prog1 (funcall function)
            (signal-pending-error queue)
            (setf left-p nil))
          (warn-of-unpassed-ticks simulation left-p)
          (show-unread-messages queue)
          (end-headless-run simulation)
          ;; What the end interrupts is no error.
          (show-unread-messages
           queue (lambda (message)
                   (and (message-cause message)
                        (or left-p
                            (not (eq message (message-queue-unsignalled queue))))))))
      (signal-pending-error queue))))

(defun warn-of-unpassed-ticks (simulation left-p)
  "Warn at the end of SIMULATION if no ticks have passed, or too few for its requests. Do not warn
if LEFT-P is true, that is, after a non-local exit such as an error. Do not warn either if
SIMULATION was forked, because ticks may have passed in the fork."
  (let ((text (and (not left-p)
                   (not (simulation-forked-p simulation))
                   (warning-at-end-text simulation))))
    (unless (or left-p (zerop (simulation-tick simulation)))
      (warn-of-idle-kickers (simulation-world simulation)))
    (when text
      (queue-message (make-message :warning (list text) :notable-p t)
                     (simulation-messages simulation)))))

(define-event *rewound-end-hooks*
  "Functions called at the end of a headless run that was rewound, with the run and its successor.")

(defun end-headless-run (simulation)
  "End SIMULATION or, if it was rewound, its successor."
  (let ((reason "the headless simulation that it was in has ended")
        (last (latest-successor simulation)))
    (retire-robots (simulation-robots last) reason)
    (end-simulation last reason)
    (unless (eq last simulation)
      (call-listeners *rewound-end-hooks* simulation last))))

(defun robots-named (names)
  "Return the robots of the current simulation that have the names NAMES, symbols of any package."
  ;; Their definitions may no longer exist.
  (loop with robots = (world-robots *world*)
        for name in names
        collect (or (find name robots :key #'robot-name :test #'eq)
                    (find name robots :key #'robot-name :test #'same-name-p))))

(defun retire-robots (robots reason)
  (dolist (robot robots) (retire-robot robot reason)))

(addition simulation-errors)
(defun simulation-errors (&optional (simulation (current-simulation)))
  "Return a list of at most 1000 USER-CODE-ERRORs, the oldest first: the latest errors in user code
that SIMULATION called, and failures of its plans. They include errors already signalled, shown or
read. If SIMULATION was rewound, its successor is used. When a simulator starts, the errors of
earlier live runs are forgotten. Signals WRONG-ARGUMENT. See WITH-SIMULATION."
  (let ((simulation (latest-successor (resolve-simulation simulation 'simulation-errors))))
    (user-code-errors-in (simulation-messages simulation)
               (lambda (run) (or (null run) (eq simulation (latest-successor run)))))))

;;; The macro, and warnings about misspelt forms.

(defun warn-of-used-command-values (body)
  (map-calls (lambda (form)
               (let ((call (find-if (lambda (used)
                                      (and (typep used '(cons symbol))
                                           (get (first used) 'command-signature)))
                                    (value-forms-in form))))
                 (when call
                   (warn-of-style "~(~A~) returns nothing: it only begins the command. The ~
                                   results go to the continuation, when ticks have ~
                                   passed." (first call)))))
             body))

(defun unquoted-settings-p (form)
  "True if FORM, which should return settings, is itself a setting or an unquoted list of settings."
  (and (consp form)
       (let ((head (first form)))
         (if (consp head)
             (not (eq 'lambda (first head)))
             (and (symbolp head) (not (fboundp head)) (find-parameter head nil))))))

(defun checked-settings-form (form)
  "Return FORM, the option :parameters. Signals MALFORMED-DEFINITION if FORM lacks a quote."
  (when (unquoted-settings-p form)
    (reject-clause "with-simulation" (list :parameters form)
                   (let ((*print-case* :downcase))
                     (format nil "a list with a quote, as in :parameters '~S"
                             (abridged (if (consp (first form)) form (list form)))))))
  form)

(addition with-simulation)
(define-user-macro with-simulation ((robots &key (seed 0) parameters clean journal keep ghosts
                                            (thinking :free) (errors :report))
                                    &body body &environment environment)
  "Run BODY with ROBOTS bound to fresh robots in a fresh world, headless: ticks pass only when BODY
calls RUN-TICKS or RUN-UNTIL. Return the values of BODY. ROBOTS is the name of a robot, of any
package, or a list of names. It may be an expression that returns either, such as (list 'a 'b) or a
variable that is not the name of a robot. A list (NAME :as OTHER-NAME :at (X Y) :angle A) in place
of a name means another robot like NAME, named OTHER-NAME, which starts at (X,Y). Each option may be
missing; X, Y and A are evaluated. Options:
- SEED, an integer, determines all randomness.
- PARAMETERS, a list of lists (name value), binds parameters; others keep their current values.
- CLEAN, if true, removes noise as CLEAN-SIMULATION does, except from parameters in PARAMETERS. For
  errors of sensors, PARAMETERS must also have (no-sensor-error* nil).
- JOURNAL, if true, makes the run keep a journal. KEEP makes the run keep forks, so that it can be
  rewound, see KEEP-FORKS.
- GHOSTS, if true, makes robots neither block nor see each other.
- THINKING says how much time thinking costs, see SET-THINKING.
- ERRORS says how errors in user code and failures of plans are reported: :REPORT, :SIGNAL or
  :COLLECT, see below.
Only the thread of BODY sees the bindings of robots and parameters. In other threads a robot's name
means the top-level robot, so pass the robot itself to a thread. A command to a top-level robot
queues a warning if the robot is in no run. Messages go to the message queue of the run. When BODY
ends, the run is over: commands in progress are interrupted, and the robots take no more commands.

After an error in user code or a failure of a plan, the run continues. ERRORS says how it is
reported:
- :REPORT queues a message. At the end of BODY, unread messages of this kind are written to the
  error output. The same is done with other unread errors, but not with errors of commands that have
  a continuation. It is also done with unread warnings that are given once in a run, for example
  about degrees for radians or about commands issued after the last tick.
- :SIGNAL signals the first error or failure as a USER-CODE-ERROR. RUN-TICKS signals it at the end
  of the tick, or WITH-SIMULATION at its own end.
- :COLLECT only queues a message; SIMULATION-ERRORS returns the errors and failures.
With each value of ERRORS, a warning goes to the error output if no ticks have passed although
something was requested, or if a plan waits for an event that nothing in the run can cause."
  (warn-of-used-command-values body)
  (multiple-value-bind (robots variables) (robot-list-form robots environment)
    `(call-with-simulation (lambda ()
                             (declare (special ,@variables))
                             ,@body)
                           ,robots
                           :variables ',variables
                           :seed ,seed :parameters ,(checked-settings-form parameters) :clean ,clean
                           :journal ,journal :keep ,keep :ghosts ,ghosts :thinking ,thinking
                           :errors ,errors)))

(defmethod advice-on-use ((operator (eql 'with-simulation)) form)
  (let* ((head (strip-quote (second form)))
         (names (and (consp head) (mapcar #'strip-quote (ldiff head (member-if #'keywordp head))))))
    (cond ((null head) "name a robot: (with-simulation (ROBOT) ...)")
          ((symbolp head) (format nil "write (with-simulation (~(~A~)) ...)" head))
          ((rest names)
           (format nil "put several robots into a list: (with-simulation (~(~A~)) ...)"
                   (abridged names))))))
