;;;; trying.lisp -- running trials of a form or an experiment until a check is decided.

(in-package :ars-magna.fiveam)

(export '(repeat-trial))

(defstruct (subject (:constructor make-subject
                        (function form package robots parameters clean ghosts limit))
                    (:copier nil))
  "A form whose rate of success is checked. FUNCTION evaluates FORM, which was written in PACKAGE.
Trials have ROBOTS, without bodies if GHOSTS; PARAMETERS, lists (name value); no noise if CLEAN; and
at most LIMIT ticks."
  (function nil :read-only t)
  (form nil :read-only t)
  (package nil :type package :read-only t)
  (robots '() :type list :read-only t)
  (parameters '() :read-only t)
  (clean nil :read-only t)
  (ghosts nil :read-only t)
  (limit 0 :read-only t))

(defconstant +default-tick-limit+ 100000 "The default for the largest number of ticks of a trial.")

;;; An experiment for a form.

(defun convert-parameters (parameters operator)
  "Return PARAMETERS, lists (name value), in the form that EXPERIMENT-FROM-OPTIONS requires. Errors
say that PARAMETERS is an argument of OPERATOR."
  (unless (and (proper-list-p parameters)
               (every (lambda (part) (and (proper-list-p part) (= 2 (length part)))) parameters))
    (reject-argument operator 'parameters parameters "lists (name value)"))
  (loop for (name value) in parameters
        for symbol = (parameter-symbol (find-parameter name))
        collect (list (list symbol value) value)))

(defun experiment-for-subject (subject operator seed)
  "Return an experiment of trials of SUBJECT, with seeds that follow SEED. Errors name OPERATOR."
  (let ((limit (subject-limit subject)))
    (unless (integerp seed) (reject-argument operator 'seed seed "an integer"))
    (unless (whole-p limit 1)
      (reject-argument operator 'limit limit "a number of ticks from 1 to 1e9"))
    (let ((experiment (experiment-from-options operator (string-downcase operator)
                                               :robots (subject-robots subject)
                                               :run (subject-function subject)
                                               :seed seed :limit limit
                                               :parameters (convert-parameters
                                                            (subject-parameters subject)
                                                                            operator)
                                               :clean (subject-clean subject)
                                               :ghosts (subject-ghosts subject))))
      (setf (experiment-package experiment) (subject-package subject))
      experiment)))

;;; Expanding the macros.

(defun parse-robot-list (operator robots form)
  "Return ROBOTS, a name, an entry (NAME :as ...) or a list of these, as a list. Signals
MALFORMED-DEFINITION without a robot."
  (let* ((robots (if (and (consp robots) (eq 'quote (first robots))) (second robots) robots))
         (elements (if (typep robots '(cons t (cons keyword))) (list robots) (ensure-list robots))))
    (unless (and (proper-list-p elements)
                 elements
                 (every (lambda (element) (typep element '(or symbol (cons symbol (cons keyword)))))
                        elements))
      (reject-clause operator form
                     "an option :robots, with the name of a robot or a list of robots of one map"))
    elements))

(defun robots-form-and-names (operator robots form environment)
  "Return two values: a form for the list of robots that ROBOTS, the option of a macro, means; and
the names of robots that can be variables in FORM. If ROBOTS is an expression, there are no names."
  (if (robots-expression-p robots environment)
      (values robots '())
      (let ((elements (parse-robot-list operator robots form)))
        (values (literal-robots-form elements environment) (names-in-robots elements)))))

(defun parameters-form (operator parameters)
  "Return a form that returns lists (name value). PARAMETERS is such a form, or lists (name form)."
  (if (and (consp parameters) (consp (first parameters)))
      `(list ,@(loop for part in parameters
                     do (unless (and (proper-list-p part) (= 2 (length part))
                                     (symbolp (first part)))
                          (reject-clause operator part
                                         "(parameter form), as in :parameters ((max-speed* 2))"))
                     collect `(list ',(first part) ,(second part))))
      parameters))

(defun subject-expansion (operator form robots parameters clean ghosts limit environment)
  "Return a form that makes the subject from these arguments of the macro OPERATOR."
  (warn-of-nested-run form)
  (multiple-value-bind (robots-form names)
      (robots-form-and-names operator robots form environment)
    `(make-subject (lambda ()
                     (declare (special ,@names))
                     ,form)
                   ',form (find-package ,(package-name *package*))
                   ,robots-form
                   ,(parameters-form operator parameters) ,clean (and ,ghosts t) ,limit)))

;;;; A trial

(defstruct (rate-check (:conc-name check-)
                       (:constructor make-check (experiment condition subject at-least trials
                                                 level workers))
                       (:copier nil))
  "A check that trials of CONDITION of EXPERIMENT succeed at a rate of AT-LEAST or more."
  (experiment nil :read-only t)
  (condition nil :read-only t)
  ;; The form that the experiment was made for, or NIL.
  (subject nil :type (or null subject) :read-only t)
  (at-least 0d0 :type double-float :read-only t)
  ;; The most trials.
  (trials 0 :type integer :read-only t)
  (level 0d0 :type double-float :read-only t)
  (workers 1 :type integer :read-only t)
  ;; The results that count, the latest first; the successes in them; the verdict.
  (results '() :type list)
  (successes 0 :type integer)
  (verdict nil :type symbol))

(defun success-p (result) (string= "success" (result-outcome result)))

(defun record-result (check result)
  "Add RESULT of the next trial to the results of CHECK. Return the verdict, or NIL."
  (push result (check-results check))
  (when (success-p result) (incf (check-successes check)))
  (setf (check-verdict check)
        (verdict (check-successes check) (length (check-results check)) (check-trials check)
                 (check-at-least check) (check-level check))))

(defun run-one-trial (check trial stopping-p)
  (call-without-output
   (lambda ()
     (run-trial-in-worker (check-experiment check) (check-condition check) trial stopping-p))))

;; The trials that count are decided in their order, whichever worker runs them.
(defun run-next-trials (check first)
  "Run trials of CHECK from FIRST on, only one if there is one worker. Return the results in order."
  (let* ((workers (check-workers check))
         (last (min (check-trials check) (+ first (max first (* 8 workers)))))
         (results (make-array (- last first -1)))
         (stopped nil))
    (cond ((= 1 workers) (list (run-one-trial check first (constantly t))))
          (t (call-by-workers (lambda (worker)
                                (loop for trial from (+ first worker -1) to last by workers
                                      until stopped
                                      do (setf (aref results (- trial first))
                                               (run-one-trial check trial (lambda () stopped)))))
                              workers :stop (lambda () (setf stopped t)))
             (coerce results 'list)))))

(defun run-check (check)
  "Run trials of CHECK until the verdict is :PASSED or :FAILED. Return CHECK."
  (loop for first = (1+ (length (check-results check)))
        until (loop for result in (run-next-trials check first)
                      thereis (record-result check result)))
  check)

;;;; Repeating a trial

;;; The log of a check may be read elsewhere and much later. So the form that it prints repeats a
;;; trial in any Lisp with the same code, whatever parameters are set there.

(defun repeat-subject-trial (subject seed options)
  (unless (integerp seed) (reject-argument 'repeat-trial 'seed seed "an integer"))
  (apply #'replay-trial (experiment-for-subject subject 'repeat-trial (1- seed)) 1 1 options))

(define-user-macro repeat-trial
    (form &rest options
          &key robots (seed 1) parameters clean ghosts (limit +default-tick-limit+)
          until then rate step journal trace
     &environment environment)
  "Repeat a trial of a check by IS-SUCCESS-RATE in this thread: the trial of FORM with SEED. A
failed check prints a form (repeat-trial ...); the arguments besides SEED are those of the check.

  (repeat-trial (run-plan 'fetch-thing '((:color blue)) '((109 24)))
    :robots marvin :seed 7 :parameters ((motion-noise* 0.2)))

UNTIL, THEN, RATE, STEP, JOURNAL and TRACE are those of REPLAY-TRIAL, for example to watch the trial
at a pace or to stop it in the middle. Return the same plist as REPLAY-TRIAL. Signals the errors of
REPLAY-TRIAL, and MALFORMED-DEFINITION."
  (declare (ignore until then rate step journal trace))
  `(repeat-subject-trial ,(subject-expansion "repeat-trial" form robots parameters clean ghosts
                                             limit environment)
                         ,seed
                   (list ,@(loop for (key value) on options by #'cddr
                                 unless (member key '(:robots :seed :parameters :clean :ghosts
                                                       :limit))
                                   append (list key value)))))

;;; As a text.

(defun form-text-for-check (form check)
  "Return the text of FORM in the package of CHECK, on one line if it is short."
  (let* ((text (form-text-in-package form (experiment-package (check-experiment check))))
         (line (one-line text)))
    (if (< (length line) 90) line text)))

(defun literal-form (value)
  (if (or (consp value) (and (symbolp value) (not (keywordp value)) (not (member value '(t nil)))))
      `',value
      value))

(defun repeat-trial-options (subject seed)
  (let ((robots (subject-robots subject)) (parameters (subject-parameters subject)))
    `(:robots ,(if (rest robots) robots (first robots))
      :seed ,seed
      ,@(unless (= +default-tick-limit+ (subject-limit subject)) `(:limit ,(subject-limit subject)))
      ,@(when parameters
          `(:parameters ,(loop for (name value) in parameters
                               collect (list name (literal-form value)))))
      ,@(when (subject-clean subject) '(:clean t))
      ,@(when (subject-ghosts subject) '(:ghosts t)))))

(defun repeat-trial-text (check result)
  (let ((subject (check-subject check)))
    (flet ((text (form) (form-text-for-check form check)))
      (if subject
          (format nil "(~A ~A~%    ~{~A ~A~^ ~})" (text 'repeat-trial) (text (subject-form subject))
                  (mapcar #'text (repeat-trial-options subject (result-seed result))))
          (format nil "(~A '~A ~S ~D)" (text 'replay-trial)
                  (text (experiment-name (check-experiment check)))
                  (condition-name (check-condition check)) (result-trial result))))))
