;;;; defexperiment.lisp -- DEFEXPERIMENT.

(in-package :ars-magna.experiment)

(export '(experiment-from-options))

;;; Expanding.

(defun value-form (name form)
  "Return a form for the value FORM of the factor NAME. Lists for :THINKING need no quote."
  (if (and (eq :thinking name) (thinking-mode-p form)) `',form form))

(defun values-form (part)
  "Return a form for a list of the values in PART of :vary, or of the bounds of a design's ranges."
  (cond ((design-part-p part)
         `(list ,@(loop for (nil low high) in (design-ranges part) collect `(list ,low ,high))))
        ((eq :in (second part)) (third part))
        (t `(list ,@(loop for form in (rest part) collect (value-form (first part) form))))))

(defun named-values-form (parts value-of)
  `(list ,@(loop for part in parts collect `(list ',part ,(funcall value-of part)))))

(defun function-form (clauses forms)
  "Return a form that makes a function. The function evaluates FORMS; its parameters are the
variables that CLAUSES vary. Return NIL if there are no FORMS."
  (let ((variables (varied-variables clauses)))
    (and forms
         `(lambda ,variables
            (declare (ignorable ,@(remove-if #'special-p variables))
                     (special ,@(names-in-robots (clause-arguments :robots clauses))))
            ,@forms))))

(defun named-functions-form (key definition clauses)
  "Return a form for a list of lists (name function), or (name function summary) for a measure that
is sampled at each tick, for the parts of the clause KEY."
  `(list ,@(loop for part in (clause-arguments key clauses)
                 collect (multiple-value-bind (name form summary measure) (named-measure-part part)
                           `(list ',name ,(function-form clauses (list form))
                                  ,@(and summary (list summary))
                                  ,@(and measure
                                         `((check-measure-defined ,definition ',part
                                                                  ',measure))))))))

(defun check-measure-defined (definition part name)
  "Signal MALFORMED-DEFINITION about PART unless NAME is the name of a measure. Return NIL."
  (unless (find-measure name nil)
    (let ((nearest (nearest-name name (mapcar #'measure-name (all-measures)))))
      (reject-clause definition part
                     (format nil "(name form), or the name of a measure that DEFMEASURE has ~
                                  defined; ~(~A~) is none~@[; did you mean ~(~A~)?~]"
                             name nearest)))))

(defun flag-clause-p (key clauses)
  (multiple-value-bind (rest given) (clause-arguments key clauses)
    (and given (or (null rest) (first rest)))))

(defun thinking-form (clauses)
  (multiple-value-bind (rest given) (clause-arguments :thinking clauses)
    (if given (value-form :thinking (first rest)) :free)))

(defun trial-affecting-clauses (clauses)
  "Return those CLAUSES that affect the outcome of a trial, except the factors."
  (loop for key in '(:robots :ghosts :parameters :clean :thinking :seed :limit :run :until
                     :success :measure :each-tick)
        for clause = (find key clauses :key #'first)
        when clause collect clause))

(defun definition-form (name documentation clauses form)
  `(define-experiment ',name
     :documentation ,documentation
     :robots ,(literal-robots-form (clause-arguments :robots clauses))
     :parameters ,(named-values-form (clause-arguments :parameters clauses) #'second)
     :clean ,(flag-clause-p :clean clauses)
     :ghosts ,(flag-clause-p :ghosts clauses)
     :thinking ,(thinking-form clauses)
     :factors ,(named-values-form (clause-arguments :vary clauses) #'values-form)
     :cases (list ,@(loop for (name . parts) in (clause-arguments :conditions clauses)
                          collect `(list ',name ,(named-values-form parts (lambda (part)
                                                                            (apply #'value-form
                                                                                   part))))))
     ,@(loop for key in '(:trials :seed :limit :time-limit)
             for value = (first (clause-arguments key clauses))
             when value append (list key value))
     :variables ',(varied-variables clauses)
     :run ,(function-form clauses (clause-arguments :run clauses))
     :until ,(function-form clauses (clause-arguments :until clauses))
     :success ,(function-form clauses (clause-arguments :success clauses))
     :measures ,(named-functions-form :measure (definition-title "defexperiment" name) clauses)
     :series ,(named-functions-form :each-tick (definition-title "defexperiment" name) clauses)
     :form ',form
     :deciding ',(trial-affecting-clauses clauses)))

(addition defexperiment)
(define-user-macro defexperiment (&whole form name &body clauses &environment environment)
  "Define the experiment NAME, which RUN-EXPERIMENT runs. The first clause may be a string, the
question that the experiment asks. Return NAME. Signals MALFORMED-DEFINITION. The CLAUSES are:
  (:robots name...)          the robots in the world of each trial, all of one map; in place of a
                             name also (name :as other-name :at (x y) :angle a): another robot like
                             NAME, see WITH-SIMULATION
  (:ghosts)                  robots neither block nor see each other
  (:run form...)             what a trial does, in a fresh headless simulation
  (:vary (what form...)...)  the factors and their values; all combinations are run. WHAT is a
                             parameter, :ROBOTS (values are names or lists as in :robots, quoted),
                             :THINKING (values are thinking modes), or a variable in the other
                             clauses; a special variable is bound. (what :in form) takes values
                             from a list. Values are numbers, symbols, strings, or lists of these.
                             (:sobol n (what low high)...) samples N points from ranges instead of
                             all combinations; so do :latin-hypercube and :random. N may be followed
                             by :seed and an integer; a range may end with :integer or :log
  (:conditions (name (what form)...)...)  named conditions, alone or combined with :vary
  (:trials n)                trials of each condition; 100 by default; RUN-EXPERIMENT overrides it
  (:seed n)                  0 by default; trial T has the seed N + T under all conditions
  (:limit n)                 the most ticks of a trial, 100000 by default
  (:time-limit n)            the most seconds of real time of a trial, none by default;
                             RUN-EXPERIMENT overrides it
  (:parameters (p form)...)  the values of parameters. Other parameters have the manual's
                             values; your own settings do not count
  (:clean)                   no noise, except where :parameters and :vary set it. For noise in
                             perception, also set NO-SENSOR-ERROR* to NIL
  (:thinking mode)           the cost of thinking, see SET-THINKING; :FREE by default
  (:until form)              after :run, ticks pass until FORM is true: for continuations
  (:success form)            whether the trial succeeded: evaluated at its end, see TRIAL-VALUES.
                             If :run succeeds but FORM is false, the trial fails: only-believed
  (:measure (name form)...)  values at the end of the trial: what run variables can have, see
                             DEFINE-RUN-VARIABLE; or :NONE for no value. In place of (name form)
                             also the name of a measure, see DEFMEASURE; or (name :over summary),
                             with the summary :MEAN, :SUM, :MAX or :MIN of the measure's values
                             before the first tick and after each tick, in the column NAME-SUMMARY
  (:each-tick (name form)...)  values before the first tick and after each tick, once plans have
                             run; kept in series.csv, see TRIAL-SERIES. In place of (name form)
                             also the name of a measure. The forms must only read.
                             They have their own random numbers; any other change that they make
                             affects the trial
Without :success and :until the values of :run decide. If :run returns the values of RUN-PLAN or the
task of BEGIN-PLAN, the outcome of the plan counts (unfinished if the task has not ended). Otherwise
a true first value is success, and the second value, a symbol or string, is the reason. If a plan
started by BEGIN-PLAN waits for something that can never happen, the trial fails with the reason
deadlock. The documentation of RUN-EXPERIMENT says what is kept."
  (let ((definition (definition-title "defexperiment" name)))
    (multiple-value-bind (clauses documentation)
        (if (stringp (first clauses))
            (values (rest clauses) (first clauses))
            (values clauses nil))
      (expand-definition
       form environment
       (lambda ()
         (unless (and name (symbolp name) (not (keywordp name)))
           (reject-clause definition name "a symbol as the name"))
         (check-visible-name definition name name)
         (check-all-clauses definition name clauses)
         (list (definition-form name documentation clauses form)))))))

;;; Evaluating.

(defun check-value (definition part value)
  "Signal MALFORMED-DEFINITION unless the factor of PART can have VALUE."
  (let* ((name (first part))
         (parameter (and (not (keyword-factor-p name)) (parameter-of-variable name))))
    (cond ((eq :robots name) (check-robots definition part (robots-in-value value)))
          ((eq :thinking name)
           (unless (thinking-mode-p value)
             (reject-clause definition part
                            (format nil "thinking modes: ~A; not ~A" (thinking-modes-text)
                                    (safe-text value)))))
          (parameter
           (unless (ignore-errors (check-parameter-value parameter value) t)
             (reject-clause definition part
                            (format nil "values of ~(~A~), ~A, not ~A" name
                                    (describe-type (parameter-type parameter))
                                    (safe-text value)))))
          ((not (table-value-p value))
           (reject-clause definition part
                          (format nil "numbers, symbols, strings or lists of them, not ~A: a ~
                                       table must have a text for it"
                                  (safe-text value)))))))

(defun robots-in-value (value)
  "Return VALUE, a robot or a list of robots, as a list."
  (if (typep value '(cons t (cons keyword))) (list value) (ensure-list value)))

(defun call-rejecting-robots (function definition part)
  "Call FUNCTION, which checks a list of robots. Report its errors as MALFORMED-DEFINITION."
  (handler-case (funcall function)
    (ars-magna-error (trouble)
      (reject-clause definition part
                     (format nil "robots such as ann or (ann :as bob :at (3 4)); ~A"
                             (string-right-trim "." (one-line-text trouble)))))))

(defun check-robots-apart-in-conditions (definition experiment)
  "Signal MALFORMED-DEFINITION if robots of a condition of EXPERIMENT start in one cell."
  (unless (experiment-ghosts experiment)
    (dolist (condition (experiment-conditions experiment))
      (let ((robots (condition-robots condition)))
        (call-rejecting-robots (lambda () (check-entries-apart definition (parse-robots robots)))
                               definition (list* :robots robots))))))

(defun check-robots (definition part robots)
  (check-robot-names definition part (mapcar #'kind-in-entry robots))
  (when robots (call-rejecting-robots (lambda () (parse-robots robots)) definition part)))

(defun kind-in-entry (robot)
  "Return the name of the kind of ROBOT, a name or an entry (name :as ...)."
  (if (consp robot) (first robot) robot))

(defun check-robot-names (definition part names)
  (dolist (name names)
    (unless (and name (symbolp name))
      (reject-clause definition part
                     "names of robots. In :vary, quote each value: (:robots 'ann '(ann bob)); a ~
                      value there may also be a form that computes the list"))
    (unless (find-blueprint name nil)
      (reject-clause definition part
                     (let ((names (reverse (mapcar #'blueprint-name (all-blueprints)))))
                       (format nil "defined robots; ~(~A~) is not one~@[ (did you mean ~(~A~)?)~]. ~
                                    Known: ~{~(~A~)~^, ~}~@[ and ~D more~]"
                               name (nearest-name name names)
                               (subseq names 0 (min 12 (length names)))
                               (and (> (length names) 12) (- (length names) 12)))))))
  (let ((maps (remove-duplicates (mapcar (lambda (name) (blueprint-map (find-blueprint name)))
                                         names)
                                 :test #'same-name-p)))
    (when (rest maps)
      (reject-clause definition part
                     (format nil "robots of one map, not of ~{~(~A~)~^ and ~}" maps)))))

(defun equal-in-table-p (text other)
  "True if TEXT and OTHER, cells of a table, are equal texts or numbers, such as 1 and 1.0."
  (or (string= text other)
      (let ((number (number-from-text text)) (other-number (number-from-text other)))
        (and number other-number (= number other-number)))))

(defun check-values-differ (definition part texts)
  (loop for (text . others) on texts
        for first from 1
        for place = (position text others :test #'equal-in-table-p)
        when place
          do (reject-clause definition part
                            (format nil "values that differ in the table, where the ~:R and the ~
                                         ~:R are both ~S"
                                    first (+ 1 first place) (cut text 60)))))

(defun check-values (definition part values)
  (unless (and (proper-list-p values) values)
    (reject-clause definition part "a list of at least one value"))
  (dolist (value values) (check-value definition part value))
  (let ((*robots-compared* (names-in-value values)))
    (check-values-differ definition part
                         (mapcar (lambda (value) (factor-text (first part) value)) values))))

(defun axis-from-values (definition part values)
  "Return the axis for PART of :vary. VALUES is what the form from VALUES-FORM returns."
  (cond ((design-part-p part)
         (let ((choices (settings-of-design definition part values)))
           (dolist (choice choices)
             (loop for (nil value) in choice
                   for range in (design-ranges part)
                   do (check-value definition range value)))
           (list (vary-part-names part) choices)))
        (t (check-values definition part values)
           (list (vary-part-names part)
                 (loop for value in values collect (list (list (first part) value)))))))

(defun checked-settings (definition settings)
  "Return lists (name value) for SETTINGS, lists (part value). Signals MALFORMED-DEFINITION."
  (loop for (part value) in settings
        do (check-value definition part value)
        collect (list (first part) value)))

(defun check-conditions-differ (definition clause conditions)
  (let ((known (make-hash-table :test 'equal)))
    (dolist (condition conditions)
      (let* ((name (condition-name condition)) (other (gethash name known)))
        (when other
          (reject-clause definition clause
                         (format nil "other names or values: two conditions would be named ~A, ~
                                      ~{~S~^ ~} and ~{~S~^ ~}"
                                 (cut name 60) (condition-texts other)
                                 (condition-texts condition))))
        (setf (gethash name known) condition)))))

(defun robot-values (experiment)
  "Return a list of the values of the factor :ROBOTS in EXPERIMENT."
  (loop for (name value) in (append (loop for (nil choices) in (experiment-axes experiment)
                                          append (apply #'append choices))
                                    (loop for (nil settings) in (experiment-cases experiment)
                                          append settings))
        when (eq :robots name) collect value))

(defun experiment-from-options (name definition
                                &rest options
                                &key robots parameters clean (thinking :free) factors cases
                                &allow-other-keys)
  "Return an experiment named NAME. Errors name DEFINITION. OPTIONS may also give initial values of
other slots of an experiment."
  (check-robots definition (list* :robots robots) robots)
  (check-value definition (list :thinking thinking) thinking)
  (let* ((axes (loop for (part values) in factors collect
                     (axis-from-values definition part values)))
         (cases-from (loop for (case settings) in cases
                           collect (list case (checked-settings definition settings))))
         (experiment (apply #'%make-experiment :name name :axes axes :cases cases-from
                                               :allow-other-keys t options))
         (settings (checked-settings definition parameters))
         (*robots-compared* (names-in-value (robot-values experiment))))
    (setf (experiment-conditions experiment)
          (call-with-trial-syntax (lambda () (all-conditions experiment clean settings))))
    (check-robots-apart-in-conditions definition experiment)
    (check-conditions-differ definition
                             (if factors
                                 (list* :vary (mapcar #'first factors))
                                 (list* :conditions (mapcar #'first cases)))
                             (experiment-conditions experiment))
    experiment))

(defun define-experiment (name &rest options)
  "Define and return the experiment NAME. OPTIONS are those of EXPERIMENT-FROM-OPTIONS. A
DEFEXPERIMENT form expands to a call of DEFINE-EXPERIMENT."
  (register *experiments* name
            (apply #'experiment-from-options name (definition-title "defexperiment" name) options)))
