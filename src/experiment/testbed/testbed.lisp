;;;; testbed.lisp -- DEFINE-TESTBED: a game with rules, knobs and a score, for agents to compare.

(in-package :ars-magna.experiment)

(export '(testbed-experiment testbed-robots testbed-measures agent-p
          agent-arguments-text))

;;; The manual measures itself against the testbeds of its time (1.2, 1.3). A testbed is an
;;; experiment whose factor AGENT has the agents as values. So its trials, tables, comparisons and
;;; pictures are those of experiments. Its knobs are parameters. An agent is the name of a plan or
;;; function, so any agent can be compared with those that the testbed has.

(addition testbed-p)
(define-record (testbed (:constructor make-testbed))
  "A testbed: an experiment on agents, with its rules and what is claimed about it."
  (name nil symbol "the symbol that names the testbed" :addition)
  (documentation "" string "what the testbed is about, a string" :export)
  (rules '() list "the rules, strings" :addition)
  (sources '() list "where the rules are from, strings" :addition)
  (knobs '() list "the parameters that are knobs of the testbed, symbols" :addition)
  (agents '() list "the agents, lists (name text)" :addition)
  (score nil symbol "the name of the measure that is the score" :addition)
  (less-is-better nil boolean "true if agents are the better, the less they score" :addition)
  (seeds '() list "the seeds, a list (:tuning N :testing N): trial T has the seed N + T" :addition)
  (sweeps '() list "lists ((knob value...) (knob value)...): what the page of results varies")
  (claims '() list "lists (text settings relation...): see DEFINE-TESTBED")
  (package *package* package)
  (title "" string "what error messages call the definition")
  (form '() list "the form of the definition")
  (deciding '() list "the clauses that affect a trial")
  (options nil function "a function that returns options of EXPERIMENT-FROM-OPTIONS"))

(defmethod print-object ((testbed testbed) stream)
  (print-named testbed stream (testbed-name testbed)
               (format nil "TESTBED ~A" (testbed-name testbed))))

(define-registry testbed "testbed" :object-p testbed-p :by-symbol t)

(defmethod affects-trials-p ((testbed testbed)) nil)

;;; Defining.

(defparameter *testbed-clauses*
  '((:rules "(:rules string...)")
    (:sources "(:sources string...)")
    (:knobs "(:knobs parameter...), parameters that DEFINE-KNOB or the simulator has defined")
    (:agents "(:agents (name string)...), names of plans or functions")
    (:score "(:score measure), the name of a measure that DEFMEASURE defines, or (:score measure
:less) if less is better")
    (:seeds "(:seeds :tuning n :testing n), integers")
    (:sweeps "(:sweeps ((knob value...) (knob value)...)...)")
    (:claims "(:claims (string (((knob value)...)...) relation...)...)"))
  "The clauses that a testbed has besides those of an experiment, and their syntax.")

(defun testbed-clause-valid-p (clause)
  (let ((parts (rest clause)))
    (flet ((all (type) (and (proper-list-p parts) parts
                            (every (lambda (part) (typep part type)) parts))))
      (ecase (first clause)
        ((:rules :sources) (all 'string))
        (:knobs (all '(and symbol (not null))))
        (:agents (all '(cons (and symbol (not null)) (cons string null))))
        (:score (typep parts '(cons (and symbol (not null))
                               (or null (cons (eql :less) null)))))
        (:seeds (typep parts '(cons (eql :tuning)
                               (cons integer (cons (eql :testing) (cons integer null))))))
        (:sweeps (every #'sweep-p parts))
        (:claims (every #'claim-frame-p parts))))))

(defun sweep-p (thing)
  "True if THING is a list ((knob value...) (knob value)...)."
  (and (proper-list-p thing)
       (typep thing '(cons (cons symbol cons)))
       (proper-list-p (first thing))
       (settings-p (rest thing))))

(defun check-claim-parts (definition claims agents)
  "Signal MALFORMED-DEFINITION unless all parts of CLAIMS are relations between AGENTS."
  (dolist (claim claims)
    (dolist (part (cddr claim))
      (unless (relation-p part agents)
        (reject-clause definition part *relation-syntax*)))))

(defun check-distinct (definition names)
  (unless (= (length names) (length (remove-duplicates names)))
    (reject-clause definition names "each name once")))

(defun check-settings (definition settings)
  "Signal MALFORMED-DEFINITION if SETTINGS name a knob twice."
  (check-distinct definition (mapcar #'first settings)))

(defun check-knobs-known (definition clauses)
  "Signal MALFORMED-DEFINITION if claims or sweeps of CLAUSES name what is no knob."
  (let ((knobs (testbed-clause :knobs clauses)))
    (flet ((check (name form)
             (unless (member name knobs)
               (reject-clause definition form
                              (format nil "knobs of the clause :knobs, ~{~(~A~)~^, ~}; not ~(~A~)"
                                      knobs name)))))
      (dolist (sweep (testbed-clause :sweeps clauses))
        (dolist (part sweep) (check (first part) sweep)))
      (dolist (claim (testbed-clause :claims clauses))
        (dolist (settings (second claim))
          (check-settings definition settings)
          (dolist (setting settings) (check (first setting) settings)))
        (dolist (part (cddr claim))
          (dolist (name (knobs-in-relation part)) (check name part)))))))

(defun testbed-clause (key clauses)
  (rest (find key clauses :key #'first)))

(defun check-testbed-clauses (definition clauses)
  (dolist (clause clauses)
    (let ((syntax (and (consp clause) (assoc (first clause) *testbed-clauses*))))
      (when (and syntax (not (testbed-clause-valid-p clause)))
        (reject-clause definition clause (second syntax)))))
  (loop for key in '(:rules :agents :score :seeds)
        do (unless (testbed-clause key clauses)
             (reject-clause definition (list key) (second (assoc key *testbed-clauses*)))))
  (check-distinct definition (testbed-clause :knobs clauses))
  (check-distinct definition (mapcar #'first (testbed-clause :agents clauses)))
  (destructuring-bind (&key tuning testing) (testbed-clause :seeds clauses)
    (when (eql tuning testing)
      (reject-clause definition (testbed-clause :seeds clauses) "different seeds for tuning")))
  (check-claim-parts definition (testbed-clause :claims clauses)
                     (mapcar #'first (testbed-clause :agents clauses)))
  (check-knobs-known definition clauses))

(defun own-testbed-clause-p (clause)
  (and (consp clause) (assoc (first clause) *testbed-clauses*)))

(defun with-fixed-knobs (knobs clauses)
  "Return CLAUSES, with a clause :run in which the agent must not set KNOBS."
  (loop for clause in clauses
        collect (if (and (consp clause) (eq :run (first clause)) (rest clause) knobs)
                    `(:run (call-with-fixed-knobs ',knobs (lambda () ,@(rest clause))))
                    clause)))

(defun experiment-clauses-of-testbed (clauses)
  "Return the clauses of the experiment on the agents of a testbed with CLAUSES."
  (list* `(:vary (,(intern "AGENT") ,@(loop for (name) in (testbed-clause :agents clauses)
                                           collect `',name)))
         `(:seed ,(getf (testbed-clause :seeds clauses) :testing))
         (let* ((score (first (testbed-clause :score clauses)))
                (others (with-fixed-knobs (testbed-clause :knobs clauses)
                                          (remove-if #'own-testbed-clause-p clauses)))
                (measures (find :measure others :key #'first)))
           (cons `(:measure ,score ,@(rest measures)) (remove measures others)))))

(addition define-testbed)
(define-user-macro define-testbed (&whole form name documentation &body clauses
                                   &environment environment)
  "Define the testbed NAME, which RUN-TESTBED runs. DOCUMENTATION is a string. Return NAME. The
CLAUSES are those of DEFEXPERIMENT, except :vary and :seed, and these:
  (:rules string...)       the rules of the game
  (:sources string...)     where they are from
  (:knobs parameter...)    what can be varied: parameters, see DEFINE-KNOB
  (:agents (name string)...)  agents, each with a sentence. A name is that of a plan or function;
                           in the clause :run it is the value of the variable AGENT, see START-AGENT
  (:score measure)         the measure by which agents are compared; (:score measure :less) if
                           less is better
  (:seeds :tuning n :testing n)  trial T has the seed N + T: one N to write agents with, another to
                           test them
  (:sweeps ((knob value...) (knob value)...)...)  what the page of results varies, all else given
  (:claims (string (((knob value)...)...) relation...)...)  what is said of the agents; it holds
                           if each relation holds under each of the lists of settings
A relation compares A and B, each an agent, or a list (agent (knob value)...) with settings of its
own. So one agent can be compared under two settings.
  (:better a b margin)        A scores at least MARGIN more than B, or less, if less is better
  (:within a b margin)        the scores of A and B differ by at most MARGIN
  (:not-worse a b margin)     A is not worse than B by MARGIN: the interval leaves that out
  (:narrows a b (knob v w))   the score of A less that of B is better when KNOB is V than when W
  (:measure name)             the claim is about this measure, not the score; (:measure name :less)
                              if less is better
Signals MALFORMED-DEFINITION."
  (let ((definition (definition-title "define-testbed" name)))
    (expand-definition
     form environment
     (lambda ()
       (unless (and name (symbolp name) (not (keywordp name)))
         (reject-clause definition name "a symbol as the name"))
       (unless (stringp documentation)
         (reject-clause definition documentation "a string that says what the testbed is about"))
       (check-testbed-clauses definition clauses)
       (let ((experiment (experiment-clauses-of-testbed clauses)))
         (check-all-clauses definition name experiment)
         (list (testbed-registration name documentation definition clauses experiment form)))))))

(defun check-knobs-defined (definition knobs)
  "Signal MALFORMED-DEFINITION unless KNOBS are names of parameters."
  (dolist (knob knobs)
    (unless (parameter-of-variable knob)
      (reject-clause definition knob "a parameter; (define-knob NAME ...) defines one"))))

(defun testbed-registration (name documentation definition clauses experiment form)
  `(progn
     (check-knobs-defined ,definition ',(testbed-clause :knobs clauses))
     (register *testbeds* ',name
               (make-testbed
                :name ',name :documentation ,documentation :title ,definition
                :score ',(first (testbed-clause :score clauses))
                :less-is-better ,(and (rest (testbed-clause :score clauses)) t)
                ,@(loop for key in '(:rules :sources :knobs :agents :seeds :sweeps :claims)
                        collect key
                        collect `',(testbed-clause key clauses))
                :form ',form
                :deciding ',(trial-affecting-clauses experiment)
                ;; Without the operator and the name.
                :options (lambda ()
                           (list ,@(cddr (definition-form name documentation experiment
                                           form))))))))

(defun check-knob-name (definition name)
  "Signal MALFORMED-DEFINITION if a parameter has the name of NAME, but is another symbol or one of
another package."
  (let* ((known (find-parameter name nil)) (symbol (and known (parameter-symbol known))))
    (when (and symbol
               (symbol-package symbol)
               (not (and (eq name symbol) (eq *package* (symbol-package symbol)))))
      (reject-clause definition name
                     (format nil "another name: ~(~S~) is a parameter, and parameters are found by ~
                                  their names without packages" symbol)))))

(addition define-knob)
(define-user-macro define-knob (name default unit type documentation)
  "Define the parameter NAME, a special variable, for a testbed. TYPE gives the range, as in (real 0
100), (integer 1 9) or (member :four :eight); UNIT is a string. Experiments can vary the knob,
WITH-SIMULATION can bind it, journals record it. Define knobs when a file is loaded, not during a
run. Return NAME. Signals MALFORMED-DEFINITION."
  (let ((definition (definition-title "define-knob" name)))
    (unless (and name (symbolp name) (users-symbol-p name)
                 (member (variable-kind name) '(nil :special)))
      (reject-clause definition name "a symbol that is no other variable"))
    (check-knob-name definition name)
    (unless (and (stringp unit) (stringp documentation))
      (reject-clause definition (list unit documentation) "a unit and a sentence, two strings"))
    (unless (typep type '(or (cons (member real integer) (cons real (cons real null)))
                          (cons (eql member) cons) (eql boolean)))
      (reject-clause definition type
                     "(real low high), (integer low high), (member ...) or boolean"))
    (unless (typep default type)
      (reject-clause definition default (format nil "a default of the type ~(~S~)" type)))
    `(progn
       (eval-when (:compile-toplevel) (proclaim '(special ,name)))
       (define-parameter ,name ,default
           (:unit ,unit :type ,type :kind :setting :group "Testbeds" :addition t)
         ,documentation))))

;;; The experiment.

(defun agent-p (name)
  "True if the symbol NAME names a plan or a function, which an agent can be."
  (and (symbolp name) name
       (or (find-procedure name nil) (and (fboundp name) (not (macro-function name))))))

(defun agent-arguments-text (name)
  "Return a text that says which arguments the agent NAME takes, and what to do; NIL if it can be
called without any."
  (let ((procedure (find-procedure name nil)))
    (multiple-value-bind (list unknown-p)
        (if procedure (procedure-lambda-list procedure) (lambda-list-of name))
      (unless (or unknown-p (accepts-count-p list 0))
        (format nil "~(~A~) takes arguments, ~(~A~), but agents are called without any. Define an ~
                     agent that calls it, such as (~A my-agent () (~(~A~) ...))."
                name list (if procedure "def-interp-proc" "defun") name)))))

(defun reseeded-clauses (clauses seed)
  (substitute-if (list :seed seed) (lambda (clause) (eq :seed (first clause))) clauses))

(defun first-seed (testbed tuning)
  "Return the seed before the first of TESTBED, for tuning if TUNING is true, else for testing."
  (or (getf (testbed-seeds testbed) (if tuning :tuning :testing)) 0))

(defun experiment-options (testbed)
  "Return the options of EXPERIMENT-FROM-OPTIONS that the definition of TESTBED gives, a plist."
  (let ((*package* (testbed-package testbed))) (funcall (testbed-options testbed))))

(defun testbed-parameters (testbed)
  "Return what TESTBED sets for all its games, lists (name value)."
  (loop for (part value) in (getf (experiment-options testbed) :parameters)
        collect (list (first part) value)))

(defun testbed-robots (testbed)
  "Return the names of the robots in games of TESTBED."
  (mapcar #'kind-in-entry (getf (experiment-options testbed) :robots)))

(defun testbed-measures (testbed)
  "Return the measures of TESTBED that are defined."
  (loop for (name) in (getf (experiment-options testbed) :measures)
        for measure = (find-measure name nil)
        when measure collect measure))

(defun factor-parts (settings)
  (loop for (name . values) in settings collect (list* (list name) values)))

(defun testbed-experiment (testbed agents &key settings games tuning)
  "Return an experiment on AGENTS in TESTBED. SETTINGS are lists (knob value). Or without AGENTS, an
experiment on GAMES, lists (agent setting...). Use the seeds for tuning if TUNING is true, else
those for testing."
  (let* ((options (experiment-options testbed))
         (seed (first-seed testbed tuning))
         (variable (first (getf options :variables)))
         (experiment
           (apply #'experiment-from-options (testbed-name testbed) (testbed-title testbed)
                  ;; Settings are factors of one value each, so that a table records them.
                  :factors (and agents
                                (list* (list (list variable) agents)
                                       (loop for (name value) in settings
                                             collect (list (list name) (list value)))))
                  :cases (loop for game in games
                               collect (list (game-text game)
                                             (factor-parts `((,variable ,(first game))
                                                             ,@(rest game)))))
                  :seed seed
                  :form (testbed-form testbed)
                  :deciding (reseeded-clauses (testbed-deciding testbed) seed)
                  options)))
    (setf (experiment-package experiment) (testbed-package testbed))
    experiment))
