;;;; headless.lisp -- WITH-SIMULATION: runs whose ticks pass only when asked for.

(in-package :ars-magna.run)

(export '(fresh-simulation *rewound-end-hooks* variables-among undone-text note-lines-typed))

;;; WITH-SIMULATION makes a fresh world, with fresh robots in it, for its extent.

(defun blueprint-of (designator)
  "Return the blueprint of the robot DESIGNATOR, which may be a robot or its name."
  (if (robot-p designator) (robot-blueprint designator) (find-blueprint designator)))

(defun fresh-simulation (robots &key (seed 0) journal (thinking :free))
  "Return a simulation, at tick 0, of a fresh world that holds the things of its map and fresh
ROBOTS, a list of names or robots of one map. With JOURNAL it keeps one. THINKING is its thinking
mode."
  (let* ((blueprints (mapcar #'blueprint-of robots))
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
symbols by which FUNCTION calls some of the ROBOTS, of other packages than theirs perhaps."
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
  "Call FUNCTION where SIMULATION, a headless one, is the current one, and the variables of its
robots are bound to these; so are the symbols VARIABLES, which name some of them. It keeps forks as
KEEP says, see KEEP-FORKS. Then the run is over."
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
        (append (robots-meant variables) robots (mapcar #'symbol-value *simulation-variables*)
                (list (or (simulation-dice simulation)
                          (seeded-lisps-dice (simulation-seed simulation)))))
      (note-environment simulation)
      (in-any-case
        (call-telling-names
         (remove-duplicates (append variables (mapcar #'robot-name robots)))
         (lambda ()
           (call-telling-errors
            (lambda ()
              (when keep (keep-forks keep simulation))
              (funcall function))
            simulation)))
        (restore-outer-globals)))))

(defun call-telling-errors (function simulation)
  "Call FUNCTION in the headless SIMULATION, whose run is then over. What has gone wrong that nobody
has been told is told, or signalled, as its message queue says."
  (let ((queue (simulation-messages simulation)) (left-p t))
    (multiple-value-prog1
        (in-any-case
          (multiple-value-prog1 (funcall function)
            (signal-trouble queue)
            (setf left-p nil))
          (look-at-end simulation left-p)
          (show-unseen queue)
          (end-headless simulation)
          ;; What is interrupted then is not wrong.
          (show-unseen queue (lambda (message)
                               (and (message-cause message)
                                    (or left-p
                                        (not (eq message (message-queue-unsignalled queue))))))))
      (signal-trouble queue))))

(defun look-at-end (simulation left-p)
  "Say so if something was asked for in SIMULATION, whose run is to end, and no tick has passed, or
too few have; but not if the run is LEFT-P, as by an error, or ticks may have passed in a fork."
  (let ((text (and (not left-p)
                   (not (simulation-forked-p simulation))
                   (text-at-end simulation))))
    (unless (or left-p (zerop (simulation-tick simulation)))
      (doubt-idle-kickers (simulation-world simulation)))
    (when text
      (queue-message (make-message :warning (list text) :notable-p t)
                     (simulation-messages simulation)))))

(define-event *rewound-end-hooks*
  "Functions of a headless run that was rewound, and of the one that went on in its place and is
over now.")

(defun end-headless (simulation)
  "Let SIMULATION, or what goes on in its place, be over."
  (let ((reason "the headless simulation that it was in has ended") (last (latest simulation)))
    (retire-robots (simulation-robots last) reason)
    (end-simulation last reason)
    (unless (eq last simulation)
      (tell-listeners *rewound-end-hooks* simulation last))))

(defun variables-among (names)
  "Return the symbols among NAMES, a list or a single name, that can be variables."
  (remove-if-not (lambda (name) (and (symbolp name) (variable-name-p name)))
                 (ensure-list names)))

(defun robots-meant (names)
  "Return the robots of the current simulation that NAMES, of any package, mean."
  ;; Their definitions may be gone by now.
  (loop with robots = (world-robots *world*)
        for name in names
        collect (or (find name robots :key #'robot-name :test #'eq)
                    (find name robots :key #'robot-name :test #'same-name-p))))

(defun retire-robots (robots reason)
  (dolist (robot robots) (retire-robot robot reason)))

(addition simulation-errors)
(defun simulation-errors (&optional (simulation (current-simulation)))
  "Return the errors that came up in users' code that SIMULATION has called, and the failures of
plans that were begun, as USER-CODE-ERRORs: at most the latest 1000, the oldest first. Whether they
were signalled, shown or read makes no difference. A run that was rewound stands for the one that
goes on in its place. When a simulator starts, those of live runs that are over are forgotten.
Signals WRONG-ARGUMENT. See WITH-SIMULATION."
  (let ((simulation (latest (simulation-meant simulation 'simulation-errors))))
    (errors-in (simulation-messages simulation)
               (lambda (run) (or (null run) (eq simulation (latest run)))))))

;;; The macro, and what is said of one that is not written as it should be.

(defun unquoted (form)
  "Return FORM without the quote that people put before names elsewhere."
  (if (and (consp form) (eq 'quote (first form))) (second form) form))

(defun robots-form-p (form environment)
  "True if FORM, for the robots of WITH-SIMULATION, is an expression that returns them, and no name
or list of names."
  (typecase form
    (symbol (and form (known-variable-p form environment) (not (find-blueprint form nil))))
    (cons (let ((head (first form)))
            (and (symbolp head)
                 (not (eq 'quote head))
                 (not (find-blueprint head nil))
                 (or (some #'consp (rest form))
                     (known-function-p head environment)))))))

(defun doubt-values-of-commands (body)
  "Warn of each place in BODY, that of a WITH-SIMULATION, that uses the value of a command."
  (map-calls (lambda (form)
               (let ((call (find-if (lambda (used)
                                      (and (typep used '(cons symbol))
                                           (get (first used) 'command-shape)))
                                    (values-used-in form))))
                 (when call
                   (doubt-definition "~(~A~) returns nothing: it only begins the command. What ~
                                      comes of that is told to its continuation, when ticks have ~
                                      passed." (first call)))))
             body))

(defun unquoted-settings-p (form)
  "True if FORM, for a list of settings, is such a list itself, or a setting: neither is a call."
  (and (consp form)
       (let ((head (first form)))
         (if (consp head)
             (not (eq 'lambda (first head)))
             (and (symbolp head) (not (fboundp head)) (find-parameter head nil))))))

(defun settings-form (form)
  "Return FORM, that of the list :parameters. Signals MALFORMED-DEFINITION if a quote is missing."
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
  "Run BODY with ROBOTS, the name of a robot or a list of names, of any package, or an expression
that returns such, as (list 'a 'b) or a variable that is no robot's, bound to fresh robots in a
fresh world, headless: ticks pass only when BODY calls RUN-TICKS or RUN-UNTIL. Only the thread of
BODY sees these bindings: to another one that it starts, a name means the robot that it means at
top level, so hand the robot to that; a command to the other one says so if it has no run. The
integer SEED decides all chance. Parameters are bound to what they are here, or as the list
PARAMETERS of lists (name value) says; with CLEAN, CLEAN-SIMULATION is called then, which takes
noise away that PARAMETERS asks for. With JOURNAL it keeps a journal, with KEEP forks, so that it
can be rewound, see KEEP-FORKS. THINKING says how much time thinking costs, see SET-THINKING.
Messages go to a queue of its own. When BODY has ended, the run is
over: what the robots are doing is interrupted, and they take no more commands. Return the values of
BODY.

ERRORS says what becomes of errors in users' code that the run calls, and of failures of plans that
were begun; the run goes on in any case. With :REPORT they are messages; those that nobody has read
when BODY ends are written to the error output, and so are other errors, but for those of commands
that have a continuation to tell, and warnings that come once in a run, as of degrees for radians,
and of commands that BODY gives after the last tick.
With :SIGNAL the first of them is an error of BODY, a USER-CODE-ERROR that RUN-TICKS signals when
its tick is over, or WITH-SIMULATION at the end. With :COLLECT they are only messages;
SIMULATION-ERRORS returns them. In any case it is written to the error output if no ticks have
passed and something was asked for, or a plan that was begun waits for what nothing in the run will
bring about."
  (let* ((form-p (robots-form-p robots environment))
         (robots (if form-p robots (unquoted robots)))
         (variables (if form-p '() (variables-among robots))))
    (doubt-values-of-commands body)
    `(call-with-simulation (lambda ()
                             (declare (special ,@variables))
                             ,@body)
                           ,(if form-p robots `',robots)
                           :variables ',variables
                           :seed ,seed :parameters ,(settings-form parameters) :clean ,clean
                           :journal ,journal :keep ,keep :thinking ,thinking
                           :errors ,errors)))

(defmethod advice-on-use ((operator (eql 'with-simulation)) form)
  (let* ((head (unquoted (second form)))
         (names (and (consp head) (mapcar #'unquoted (ldiff head (member-if #'keywordp head))))))
    (cond ((null head) "name a robot: (with-simulation (ROBOT) ...)")
          ((symbolp head) (format nil "write (with-simulation (~(~A~)) ...)" head))
          ((rest names)
           (format nil "several robots are a list of their own: (with-simulation (~(~A~)) ...)"
                   (abridged names))))))
