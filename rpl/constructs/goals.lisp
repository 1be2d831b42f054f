;;;; goals.lisp -- def-goal: plans found by patterns of goals.

(in-package :ars-magna.rpl.constructs)

(export '(advice-on-goal))

;;; In a shape, a prepared pattern, a HOLE matches anything; a variable's holes are one object and
;;; match the same. The rest compares like attribute values: symbols by name, numbers by value.

(defstruct (hole (:constructor make-hole (variable index)) (:copier nil))
  "A place in a shape where VARIABLE matches anything. INDEX is the number of the variable."
  (variable nil :type symbol :read-only t)
  (index 0 :type fixnum :read-only t))

(defun parse-pattern (pattern)
  "Return the shape of PATTERN, and its variables in order. ?x stands for the variable x."
  (let ((holes '()))
    (labels ((hole-of (variable)
               (or (find variable holes :key #'hole-variable)
                   (first (push (make-hole variable (length holes)) holes))))
             (shape (pattern)
               (let ((variable (variable-of pattern)))
                 (cond (variable (hole-of variable))
                       ((consp pattern) (cons (shape (car pattern)) (shape (cdr pattern))))
                       (t pattern)))))
      (let ((shape (shape pattern)))
        (values shape (mapcar #'hole-variable (reverse holes)))))))

(defun shape-matches-p (shape object values)
  "True if SHAPE matches OBJECT. Store holes' values in VALUES; unset elements are VALUES itself."
  (cond ((hole-p shape)
         (let ((value (svref values (hole-index shape))))
           (cond ((eq value values) (setf (svref values (hole-index shape)) object) t)
                 (t (value-equal value object)))))
        ((consp shape)
         (and (consp object)
              (shape-matches-p (car shape) (car object) values)
              (shape-matches-p (cdr shape) (cdr object) values)))
        (t (value-equal shape object))))

(defun match-shape (shape count object)
  "If SHAPE, with COUNT holes, matches OBJECT, return true and a list of the values of the holes."
  (let ((values (make-array count)))
    (fill values values)                ; an object that is in no pattern and no goal
    (and (shape-matches-p shape object values)
         (values t (coerce values 'list)))))

(defun pattern-text (pattern)
  (labels ((plain (pattern)
             (cond ((variable-of pattern)
                    (make-symbol (format nil "?~A" (plain-name (variable-of pattern)))))
                   ((consp pattern) (cons (plain (car pattern)) (plain (cdr pattern))))
                   ((and pattern (symbolp pattern)) (make-symbol (plain-name pattern)))
                   (t pattern))))
    (let ((*print-gensym* nil) (*print-pretty* nil))
      (safe-text (plain pattern) :escape nil))))

;;; A goal is a plan that is found by a pattern. If several match, the most specific is used: one
;;; whose pattern matches nothing that the others' patterns do not. Of several such, the one
;;; defined first is used. So the order in which files are loaded does not matter, as it does in
;;; CRAM, which takes the first that matches.

(addition goal-p)
(define-record (goal (:constructor make-goal
                         (operator pattern shape variables procedure documentation)))
  "A plan for the goals that match a pattern, defined by DEF-GOAL."
  (operator nil symbol
            "the operator of the goal, ACHIEVE, PERCEIVE or BELIEF" :writable :addition)
  (pattern nil t "the pattern of the goal, as it was defined" :writable :addition)
  (shape nil t :writable)
  (variables '() list :writable)
  (procedure nil (or null procedure) "the procedure with parameters VARIABLES, or NIL" :writable)
  (documentation nil (or null string) :writable))

(defun goal-text (operator pattern)
  (format nil "~A ~A" (plain-name operator) (pattern-text pattern)))

(defmethod print-object ((goal goal) stream)
  (print-unreadable-object (goal stream :type t)
    (write-string (goal-text (goal-operator goal) (goal-pattern goal)) stream)))

(defmethod documentation ((goal goal) (kind (eql t)))
  (goal-documentation goal))

(define-registry goal "goal" :object-p goal-p :plans t)

;;; Choosing.

(defun operator-goals (operator)
  (remove operator (all-goals) :key #'goal-operator :test-not #'eq))

(defun goal-covers-p (goal other)
  (match-shape (goal-shape goal) (length (goal-variables goal)) (goal-shape other)))

(defun more-specific-p (goal other)
  "True if the pattern of OTHER matches everything that the pattern of GOAL matches, and more."
  (and (goal-covers-p other goal)
       (not (goal-covers-p goal other))))

(defun choose-goal (operator instance)
  "Return the goal for OPERATOR and INSTANCE, and the values of its variables; or NIL."
  (let ((best nil) (values '()))
    (dolist (goal (operator-goals operator) (values best values))
      (multiple-value-bind (matches found)
          (match-shape (goal-shape goal) (length (goal-variables goal)) instance)
        (when (and matches (or (null best) (more-specific-p goal best)))
          (setf best goal
                values found))))))

(defun advice-on-goal (name)
  "Return a sentence about how to write the goal whose pattern starts with NAME; NIL if none does."
  (let ((goal (find-if (lambda (goal)
                         (let ((first (first (goal-pattern goal))))
                           (and first (symbolp first) (same-name-p name first))))
                       (all-goals))))
    (and goal
         (format nil "it is the first word of a goal. Quote the goal: (~(~A~) '(~(~A~) ...)); ~
                      with values of variables write (~2:*~(~A~) `(~(~A~) ,x ...))."
                 (goal-operator goal) (plain-name name)))))

;;; Defining. A pattern that matches the same as one defined before redefines that one.

(defun goal-entry-name (operator pattern shape count)
  (let ((old (find-if (lambda (goal)
                        (and (match-shape shape count (goal-shape goal))
                             (match-shape (goal-shape goal) (length (goal-variables goal)) shape)))
                      (operator-goals operator))))
    (if old
        (entry-name (find old (registry-entries *goals*) :key #'entry-object))
        (make-symbol (string-upcase (goal-text operator pattern))))))

(defun install-goal (operator pattern procedure text)
  (multiple-value-bind (shape variables) (parse-pattern pattern)
    (register *goals* (goal-entry-name operator pattern shape (length variables))
              (make-goal operator pattern shape variables procedure text))))

(defun checked-goal-operator (definition operator)
  (or (and (symbolp operator) (find operator '(achieve perceive belief) :test #'same-name-p))
      (reject-clause definition operator "achieve, perceive or belief")))

(defun def-goal-code (definition operator pattern body environment)
  (unless (consp pattern)
    (reject-clause definition pattern "a goal's pattern, such as (on ?a ?b)"))
  (multiple-value-bind (body text) (split-documentation body)
    (let ((variables (nth-value 1 (parse-pattern pattern))))
      (check-variables variables environment pattern)
      `(install-goal ',(checked-goal-operator definition operator) ',pattern
                     ,(macroexpand-1 `(interp-lambda ,variables (block succeed-with ,@body))
                                     environment)
                     ,text))))

(addition def-goal)
(define-user-macro def-goal (&whole form (operator pattern) &body body &environment environment)
  "Define BODY as the plan for goals that match PATTERN, such as (on ?a ?b). OPERATOR is ACHIEVE,
PERCEIVE or BELIEF. BODY is plan text and may start with a documentation string. In BODY the
variables a and b have the values that ?a and ?b match. A variable that occurs twice must match the
same value twice. A pattern may end in a dot and ?x. The value of the goal is the value of BODY, or
the value given to SUCCEED-WITH. If several patterns match a goal, the most specific one is used,
and among equals the one defined first. (CRAM uses the first pattern that matches.) A new pattern
replaces an older one if only the names of the variables differ. Signals MALFORMED-DEFINITION. (From
CRAM, with variables as in DEF-INTERP-MACRO.)"
  (let ((definition (format nil "def-goal (~(~A~) ...)" operator)))
    (expand-definition form environment
                       (lambda ()
                         (list (def-goal-code definition operator pattern body environment))))))

(define-construct succeed-with (&rest values)
  "End the body of a DEF-GOAL successfully, with VALUES. (From CRAM, where the name is SUCCEED. In
ARS MAGNA, SUCCEED is a name for commands.)"
  (:code (if (assoc 'succeed-with (scope-blocks scope))
             (plan-code (note-plan-text `(return-from succeed-with (values ,@values))) scope)
             (reject-clause (text-title) form "succeed-with only in the body of a def-goal"))))
