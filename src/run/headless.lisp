;;;; headless.lisp -- WITH-SIMULATION: runs whose ticks pass only when asked for.

(in-package :ars-magna.run)

(export '(fresh-simulation *rewound-end-hooks* variables-among))

;;; WITH-SIMULATION makes a fresh world, with fresh robots in it, for its extent.

(defun fresh-simulation (robots &key (seed 0) journal (thinking :free))
  "Return a simulation, at tick 0, of a fresh world that holds the things of its map and fresh
ROBOTS, a list of names or robots of one map. With JOURNAL it keeps one. THINKING is its thinking
mode."
  (let* ((blueprints (mapcar (lambda (robot)
                               (if (robot-p robot) (robot-blueprint robot) (find-blueprint robot)))
                             robots))
         (maps (remove-duplicates (mapcar #'find-map (mapcar #'blueprint-map blueprints)))))
    (unless (= (length maps) 1)
      (reject-use "One simulation has one map, and these robots are defined in ~
                   ~:[none~;~:*~{~A~^, ~}~]."
                  maps))
    (let ((world (make-world (first maps) :seed seed)))
      (dolist (blueprint blueprints) (make-robot blueprint world))
      (let ((simulation (make-simulation world)))
        (begin-thinking simulation thinking)
        (when journal (begin-journal simulation))
        simulation))))

(addition call-with-simulation)
(defun call-with-simulation (function robots &key (seed 0) parameters clean journal keep
                                               (thinking :free) (errors :report) variables)
  "Call FUNCTION, with no arguments, in a fresh headless simulation of ROBOTS, a robot, its name or
a list of such, and return its values: what WITH-SIMULATION does with its body. VARIABLES are
further symbols, of any package, that name some of the ROBOTS in FUNCTION."
  (check-argument with-simulation seed (integerp seed) "an integer")
  (check-thinking 'with-simulation thinking)
  (check-argument with-simulation errors (typep errors 'error-policy)
                  ":report, :signal or :collect")
  (call-with-parameters
   parameters
   (lambda ()
     (check-parameters)
     (when clean (clean-simulation))
     (let ((*message-queue* (make-message-queue :error-policy errors)))
       (call-as-headless function
                         (fresh-simulation (ensure-list robots) :seed seed :journal journal
                                                                :thinking thinking)
                         :variables variables :keep keep)))))

(defun call-as-headless (function simulation &key variables keep)
  "Call FUNCTION with the headless SIMULATION as the current one and its robots as the values of
their names and of VARIABLES, symbols that name some of them. The run keeps forks as KEEP says, see
KEEP-FORKS, and is over at the end."
  (when *simulation* (note-environment *simulation*))
  (let* ((*message-queue* (simulation-messages simulation))
         (*simulation* simulation)
         (*world* (simulation-world simulation))
         (*tick-dice* nil)
         (*asked-with* '())
         (*outer-globals* (list :around))
         (robots (simulation-robots simulation)))
    (setf (simulation-variables simulation)
          (append variables (mapcar #'robot-name robots) *simulation-variables*
                  (list *lisps-dice*)))
    (progv (simulation-variables simulation)
        (append (robots-named variables) robots (mapcar #'symbol-value *simulation-variables*)
                (list (or (simulation-dice simulation)
                          (seeded-lisps-dice (simulation-seed simulation)))))
      (note-environment simulation)
      (in-any-case
        (call-telling-names
         (remove-duplicates (append variables (mapcar #'robot-name robots)))
         (lambda ()
           (call-reporting-errors
            (lambda ()
              (when keep (keep-forks keep simulation))
              (funcall function))
            simulation)))
        (restore-outer-globals)))))

(defun call-reporting-errors (function simulation)
  "Call FUNCTION in the headless SIMULATION; then end the run. Show or signal unread errors, by the
error policy of its message queue."
  (let ((queue (simulation-messages simulation)) (left-p t))
    (multiple-value-prog1
        (in-any-case
          (multiple-value-prog1 (funcall function)
            (signal-trouble queue)
            (setf left-p nil))
          (warn-at-end simulation left-p)
          (show-unseen queue)
          (end-headless simulation)
          ;; What the end interrupts is no error.
          (show-unseen queue (lambda (message)
                               (and (message-cause message)
                                    (or left-p
                                        (not (eq message (message-queue-unsignalled queue))))))))
      (signal-trouble queue))))

(defun warn-at-end (simulation left-p)
  "Warn if SIMULATION, which ends, has passed no ticks or too few for its requests. Do not if it is
LEFT-P, by a non-local exit such as an error, or was forked, as ticks may have passed in the fork."
  (let ((text (and (not left-p)
                   (not (simulation-forked-p simulation))
                   (text-at-end simulation))))
    (unless (or left-p (zerop (simulation-tick simulation)))
      (doubt-idle-kickers (simulation-world simulation)))
    (when text
      (queue-message (make-message :warning (list text) :notable-p t)
                     (simulation-messages simulation)))))

(define-event *rewound-end-hooks*
  "Functions of a headless run that was rewound, and of its last successor, which is over now.")

(defun end-headless (simulation)
  "End SIMULATION or, if it was rewound, its successor."
  (let ((reason "the headless simulation that it was in has ended") (last (latest simulation)))
    (retire-robots (simulation-robots last) reason)
    (end-simulation last reason)
    (unless (eq last simulation)
      (tell-listeners *rewound-end-hooks* simulation last))))

(defun variables-among (names)
  "Return the symbols among NAMES, a list or a single name, that can be variables."
  (remove-if-not (lambda (name) (and (symbolp name) (variable-name-p name)))
                 (ensure-list names)))

(defun robots-named (names)
  "Return the robots of the current simulation that are called NAMES, symbols of any package."
  ;; Their definitions may no longer exist.
  (loop with robots = (world-robots *world*)
        for name in names
        collect (or (find name robots :key #'robot-name :test #'eq)
                    (find name robots :key #'robot-name :test #'same-name-p))))

(defun retire-robots (robots reason)
  (dolist (robot robots) (retire-robot robot reason)))

(addition simulation-errors)
(defun simulation-errors (&optional (simulation (current-simulation)))
  "Return the errors in user code called by SIMULATION, and the failures of its plans, as
USER-CODE-ERRORs: at most the latest 1000, the oldest first, whether or not they were signalled,
shown or read. A run that was rewound stands for its successor. When a simulator starts, the errors
of earlier live runs are forgotten. Signals WRONG-ARGUMENT. See WITH-SIMULATION."
  (let ((simulation (latest (resolve-simulation simulation 'simulation-errors))))
    (errors-in (simulation-messages simulation)
               (lambda (run) (or (null run) (eq simulation (latest run)))))))

;;; The macro, and warnings about misspelt forms.

(defun strip-quote (form)
  "Return FORM without a leading quote."
  (if (and (consp form) (eq 'quote (first form))) (second form) form))

(defun robots-form-p (form environment)
  "True if FORM, the robots of WITH-SIMULATION, is an expression that returns them: no name or list
of names."
  (typecase form
    (symbol (and form (known-variable-p form environment) (not (find-blueprint form nil))))
    (cons (let ((head (first form)))
            (and (symbolp head)
                 (not (eq 'quote head))
                 (not (find-blueprint head nil))
                 (or (some #'consp (rest form))
                     (known-function-p head environment)))))))

(defun warn-of-used-values (body)
  "Warn about each form in BODY, that of a WITH-SIMULATION, that uses the value of a command."
  (map-calls (lambda (form)
               (let ((call (find-if (lambda (used)
                                      (and (typep used '(cons symbol))
                                           (get (first used) 'command-shape)))
                                    (values-used-in form))))
                 (when call
                   (doubt-definition "~(~A~) returns nothing: it only begins the command. The ~
                                      results go to the continuation, when ticks have ~
                                      passed." (first call)))))
             body))

(defun unquoted-settings-p (form)
  "True if FORM, to be evaluated to a list of settings, is itself such a list or a setting."
  (and (consp form)
       (let ((head (first form)))
         (if (consp head)
             (not (eq 'lambda (first head)))
             (and (symbolp head) (not (fboundp head)) (find-parameter head nil))))))

(defun settings-form (form)
  "Return FORM, the value of :parameters. Signals MALFORMED-DEFINITION if its quote is missing."
  (when (unquoted-settings-p form)
    (reject-clause "with-simulation" (list :parameters form)
                   (let ((*print-case* :downcase))
                     (format nil "a quote: :parameters '~S"
                             (abridged (if (consp (first form)) form (list form)))))))
  form)

(addition with-simulation)
(define-user-macro with-simulation ((robots &key (seed 0) parameters clean journal keep
                                            (thinking :free) (errors :report))
                                    &body body &environment environment)
  "Run BODY with ROBOTS bound to fresh robots in a fresh world, headless: ticks pass only when BODY
calls RUN-TICKS or RUN-UNTIL. Return the values of BODY. ROBOTS is the name of a robot or a list of
names, of any package, or an expression that returns such, as (list 'a 'b) or a variable that is no
robot's. Options:
- SEED, an integer, determines all randomness.
- PARAMETERS, a list of lists (name value), binds parameters; others keep their current values.
- CLEAN calls CLEAN-SIMULATION afterwards, which also removes noise that PARAMETERS asks for.
- JOURNAL keeps a journal; KEEP keeps forks, so that the run can be rewound, see KEEP-FORKS.
- THINKING says how much time thinking costs, see SET-THINKING.
- ERRORS says how errors in user code and failures of plans are reported, see below.
Only the thread of BODY sees the bindings. In another thread a name means the robot at top level, so
pass it the robot; a command to the robot at top level warns if that has no run. Messages go to a
queue of the run. When BODY ends, the run is over: commands in progress are interrupted, and the
robots take no more commands.

ERRORS; the run continues in each case:
- :REPORT makes them messages. Those unread at the end of BODY are written to the error output. So
  are unread warnings given once in a run, for example about degrees for radians or commands issued
  after the last tick, and other unread errors, except those of commands with a continuation.
- :SIGNAL signals the first as a USER-CODE-ERROR, by RUN-TICKS at the end of its tick, or by
  WITH-SIMULATION at the end.
- :COLLECT only makes them messages; SIMULATION-ERRORS returns them.
In each case a line on the error output says so if no ticks have passed although something was
requested, or if a plan waits for what nothing in the run will bring about."
  (let* ((form-p (robots-form-p robots environment))
         (robots (if form-p robots (strip-quote robots)))
         (variables (if form-p '() (variables-among robots))))
    (warn-of-used-values body)
    `(call-with-simulation (lambda ()
                             (declare (special ,@variables))
                             ,@body)
                           ,(if form-p robots `',robots)
                           :variables ',variables
                           :seed ,seed :parameters ,(settings-form parameters) :clean ,clean
                           :journal ,journal :keep ,keep :thinking ,thinking
                           :errors ,errors)))

(defmethod advice-on-use ((operator (eql 'with-simulation)) form)
  (let* ((head (strip-quote (second form)))
         (names (and (consp head) (mapcar #'strip-quote (ldiff head (member-if #'keywordp head))))))
    (cond ((null head) "name a robot: (with-simulation (ROBOT) ...)")
          ((symbolp head) (format nil "write (with-simulation (~(~A~)) ...)" head))
          ((rest names)
           (format nil "put several robots into a list: (with-simulation (~(~A~)) ...)"
                   (abridged names))))))
