;;;; rap-random.lisp -- random RAPs do what a model of them does.

(in-package :ars-magna.tests.rap)

(in-suite ars-magna.tests::rap)

;;; A program is a list of RAPs, each a list (name success attempts method...), where SUCCESS is a
;;; pattern or NIL. A method is a list (context deed...). CONTEXT is a list of patterns, or lists
;;; (not pattern). A deed is (wait n), (add pattern), (delete pattern), (quit), which fails, or
;;; (call name argument); a RAP calls only later ones. The model runs programs on a list of facts,
;;; the newest first, and a clock. It enumerates values of variables instead of following facts.

(defparameter *model-values* '(a b c))
(defparameter *model-relations* '(p q r))

(defvar *model-facts*)
(defvar *model-clock*)

(defun model-instance (pattern environment)
  (loop for part in pattern
        collect (let ((binding (assoc part environment)))
                  (if binding (cdr binding) part))))

(defun model-assignments (variables)
  (if (null variables)
      (list '())
      (loop for rest in (model-assignments (rest variables))
            append (loop for value in *model-values*
                         collect (acons (first variables) value rest)))))

(defun model-free (pattern environment)
  (remove-duplicates (loop for part in pattern
                           when (and (member part '(?y ?z)) (not (assoc part environment)))
                             collect part)
                     :from-end t))

(defun model-extensions (condition environment)
  "Return the extensions of ENVIRONMENT for which CONDITION holds, by the order of the facts."
  (if (eq 'not (first condition))
      (if (model-extensions (second condition) environment) '() (list environment))
      (let ((found (loop for more in (model-assignments (model-free condition environment))
                         for all = (append environment more)
                         for place = (position (model-instance condition all) *model-facts*
                                               :test #'equal)
                         when place collect (cons place all))))
        (mapcar #'rest (sort found #'< :key #'first)))))

(defun model-choices (context environment)
  (let ((all (list environment)))
    (dolist (condition context all)
      (setf all (loop for each in all append (model-extensions condition each))))))

(defun model-run (name argument program)
  "Run the RAP NAME of PROGRAM. Return true if it succeeds."
  (destructuring-bind (success attempts . methods) (rest (assoc name program))
    (let ((environment (list (cons '?x argument))) (tries '()))
      (loop
        (when (and success (model-extensions success environment)) (return t))
        (let ((choice (model-choice methods environment tries attempts)))
          (unless choice (return nil))
          (push choice tries)
          (when (and (model-do (rest (nth (first choice) methods)) (second choice) program)
                     (null success))
            (return t)))))))

(defun model-choice (methods environment tries attempts)
  (let ((best nil) (fewest attempts))
    (loop for (context) in methods
          for number from 0
          do (dolist (values (model-choices context environment))
               (let ((count (count (list number values) tries :test #'equal)))
                 (when (< count fewest)
                   (setf best (list number values) fewest count)))))
    best))

(defun model-do (deeds environment program)
  (loop for (kind . arguments) in deeds
        do (case kind
             (wait (incf *model-clock* (first arguments)))
             (add (let ((fact (model-instance (first arguments) environment)))
                    (setf *model-facts* (cons fact (remove fact *model-facts* :test #'equal)))))
             (delete (setf *model-facts* (remove (model-instance (first arguments) environment)
                                                 *model-facts* :test #'equal)))
             (quit (return nil))
             (call (unless (model-run (first arguments)
                                      (first (model-instance (rest arguments) environment))
                                      program)
                     (return nil))))
        finally (return t)))

;;; Random programs.

(defun pick (list) (nth (random (length list)) list))

(defun random-pattern (known &optional (free '()))
  (list (pick *model-relations*) (pick (append known free *model-values*))
        (pick (append known free *model-values*))))

(defun bound-by (context)
  (remove-duplicates (loop for condition in context
                           unless (eq 'not (first condition))
                             append (intersection '(?y ?z) condition))))

(defun random-context ()
  (let ((context '()))
    (dotimes (i (random 3) (reverse context))
      (let ((known (cons '?x (bound-by context))))
        (push (if (zerop (random 4))
                  (list 'not (random-pattern known))
                  (random-pattern known '(?y ?z)))
              context)))))

(defun random-deed (known later)
  (case (random (if later 7 5))
    (0 (list 'wait (1+ (random 3))))
    ((1 2) (list 'add (random-pattern known)))
    (3 (list 'delete (random-pattern known)))
    (4 (if (zerop (random 3)) (list 'quit) (list 'add (random-pattern known))))
    (t (list 'call (pick later) (pick (append known *model-values*))))))

(defun random-method (later)
  (let* ((context (random-context)) (known (cons '?x (bound-by context))))
    (cons context (loop repeat (1+ (random 3)) collect (random-deed known later)))))

(defun random-program (names)
  (loop for (name . later) on names
        collect (list* name
                       (and (zerop (random 3)) (random-pattern '(?x)))
                       (1+ (random 2))
                       (loop repeat (1+ (random 3)) collect (random-method later)))))

;;; The same as RAPs.

(defun deed-step (deed number)
  (list (intern (format nil "STEP-~D" number) :ars-magna.tests.rap)
        (ecase (first deed)
          (wait (list 'rap-pause (second deed)))
          (add (list 'rap-note (second deed)))
          (delete (list 'rap-forget (second deed)))
          (quit '(rap-quit))
          (call (rest deed)))))

(def-interp-proc rap-pause (ticks) (wait-time ticks))
(def-interp-proc rap-note (fact) (memory-add fact))
(def-interp-proc rap-forget (fact) (memory-delete fact))
(def-interp-proc rap-quit () (fail))

(defun method-clause (method)
  (destructuring-bind (context . deeds) method
    `(method ,@(and context `((context ,@context)))
       (task-net (sequence ,@(loop for deed in deeds
                                   for number from 1
                                   collect (deed-step deed number)))))))

(defun define-program (program)
  (loop for (name success attempts . methods) in program
        collect `(define-rap (index (,name ?x))
                   ,@(and success `((succeed ,success)))
                   (attempts ,attempts)
                   ,@(mapcar #'method-clause methods))
          into forms
        finally (handler-bind ((warning #'muffle-warning))
                  (eval `(progn ,@forms)))))

(defun rap-outcome (name argument facts)
  "Run the RAP NAME on FACTS. Return whether it succeeded, the tick, and the facts."
  (with-simulation (rapper :seed 1)
    (mapc #'memory-add (reverse facts))
    (let ((done (eq t (run-plan name argument))))
      (list done (simulation-tick) (mapcar #'first main-memory*)))))

(defun model-outcome (name argument facts program)
  (let ((*model-facts* facts) (*model-clock* 0))
    (list (model-run name argument program) *model-clock* *model-facts*)))

(defparameter *random-raps* '(rap-1 rap-2 rap-3 rap-4))

(defun random-raps-that-differ (programs runs)
  "Make as many random PROGRAMS, and RUNS of each. Return lists (program name argument facts outcome
model's) where RAPs and model differ, and how many runs succeeded."
  (let ((differences '()) (successes 0))
    (dotimes (i programs (values differences successes))
      (let ((program (random-program *random-raps*)))
        (define-program program)
        (dotimes (j runs)
          (let* ((name (pick *random-raps*)) (argument (pick *model-values*))
                 (facts (remove-duplicates (loop repeat (random 6) collect (random-pattern '()))
                                           :test #'equal))
                 (model (model-outcome name argument facts program))
                 (outcome (rap-outcome name argument facts)))
            (when (first outcome) (incf successes))
            (unless (equal outcome model)
              (push (list program name argument facts outcome model) differences))))))))

(test rap-random.random-raps-do-what-their-model-does
  (let ((*random-state* (sb-ext:seed-random-state 7)))
    (multiple-value-bind (differences successes) (random-raps-that-differ 12 12)
      (is (null differences) "~S" (first differences))
      (is (< 20 successes 130)))))
