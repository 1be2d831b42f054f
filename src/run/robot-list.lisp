;;;; robot-list.lisp -- the robots that a run begins with, as users write them.

(in-package :ars-magna.run)

(export '(parse-robots check-entries-apart literal-robots-form names-in-robots
          robots-expression-p))

;;; A list of robots has names, robots, and entries (NAME :as OTHER-NAME :at (x y) :angle a):
;;; another robot of the kind NAME, or NAME at another start. A literal list in a macro has
;;; unevaluated names and evaluated numbers; the value of any other form has symbols and numbers.

(defstruct (robot-entry (:constructor make-robot-entry (blueprint name start)) (:copier nil))
  "A robot to be made from BLUEPRINT with NAME, a symbol. START is a list (x y angle), or () if NAME
and start are those of BLUEPRINT."
  (blueprint nil :type blueprint :read-only t)
  (name nil :type symbol :read-only t)
  (start '() :type list :read-only t))

(define-constant +robot-options+ '(:as :at :angle) :test #'equal)

(define-constant +robot-list-advice+
    "robots such as SCOUT, or (SCOUT :as SCOUT-2 :at (X Y) :angle A)"
  :test #'equal)

(defun entry-form-p (form)
  "True if FORM is a list of a head and options, not a list of robots."
  (and (proper-list-p form) (rest form) (keywordp (second form))))

;;; Parsing.

(defun reject-entry (operator entry control &rest arguments)
  (reject-argument operator 'robots entry
                   (format nil "~A: ~?" +robot-list-advice+ control arguments)))

(defun check-entry-options (operator entry)
  (let ((trouble (wrong-keyword-text '(head &key as at angle) entry)))
    (when trouble (reject-entry operator entry "~A" trouble)))
  (loop for (key . others) on (loop for key in (rest entry) by #'cddr collect key)
        when (member key others)
          do (reject-entry operator entry "~(~S~) is given twice" key)))

(defun check-entry-name (operator entry name)
  (unless (and name (symbolp name) (not (keywordp name)))
    (reject-entry operator entry ":as takes a symbol that can be a variable, not ~S" name))
  (let ((trouble (and (symbol-package name) (variable-name-trouble name))))
    (when trouble
      (reject-entry operator entry "~A ~A, so no variable can hold the robot; ~
                                    write :as my-~(~A~)"
                    name trouble name))))

(defun check-entry-start (operator entry map position angle)
  (unless (and (proper-list-p position) (= 2 (length position)) (every #'sane-number-p position))
    (reject-entry operator entry ":at takes a position (x y), two numbers from -1e9 to 1e9"))
  (let ((trouble (apply #'start-problem-text map position)))
    (when trouble (reject-entry operator entry "~A" trouble)))
  (unless (sane-number-p angle)
    (reject-entry operator entry ":angle takes ~A" (argument-type-text 'angle))))

(defun robot-entry-start-pose (entry)
  "Return the list (x y angle) where the robot of ENTRY starts."
  (or (robot-entry-start entry) (blueprint-start (robot-entry-blueprint entry))))

(defun parse-options-of-robot (operator entry)
  (check-entry-options operator entry)
  (destructuring-bind (head &key (as nil as-p) (at nil at-p) (angle nil angle-p)) entry
    (let* ((kind (parse-robot operator head)) (blueprint (robot-entry-blueprint kind)))
      (when as-p (check-entry-name operator entry as))
      (destructuring-bind (x y own-angle) (robot-entry-start-pose kind)
        (let ((position (if at-p at (list x y))) (angle (if angle-p angle own-angle)))
          (check-entry-start operator entry (find-map (blueprint-map blueprint)) position angle)
          (make-robot-entry blueprint (if as-p as (robot-entry-name kind))
                            (mapcar #'double (append position (list angle)))))))))

(defun parse-robot (operator robot)
  "Return the ROBOT-ENTRY that ROBOT, an element of a list of robots, means."
  (cond ((robot-entry-p robot) robot)
        ((robot-p robot)
         (make-robot-entry (robot-blueprint robot) (robot-name robot) (robot-start robot)))
        ((entry-form-p robot) (parse-options-of-robot operator robot))
        ((consp robot) (reject-entry operator robot "a list has options after the name"))
        ((find-blueprint robot nil)
         (let ((blueprint (find-blueprint robot)))
           (make-robot-entry blueprint (blueprint-name blueprint) '())))
        ;; Another robot of a kind, in the current run.
        (t (parse-robot operator (find-robot robot)))))

(defun full-name (entry)
  (qualified-name (robot-entry-name entry)))

(defun check-names-unlike (operator entries)
  (loop for (entry . others) on entries
        for name = (robot-entry-name entry)
        when (find (full-name entry) others :key #'full-name :test #'string-equal)
          do (reject-use "~(~A~): ~A is in the list of robots twice. Give the second another name ~
                          and start: (~(~A~) :as ~(~A~)-2 :at (X Y))."
                         operator name (blueprint-name (robot-entry-blueprint entry)) name)))

(defun check-one-map (entries)
  (let ((maps (remove-duplicates (loop for entry in entries
                                       collect (find-map (blueprint-map
                                                          (robot-entry-blueprint entry)))))))
    (unless (= (length maps) 1)
      (reject-use "All robots of a simulation must be defined in one map, but these are defined in ~
                   ~{~A~^, ~}."
                  maps))))

(defun parse-robots (robots &optional (operator 'with-simulation))
  "Return a list of ROBOT-ENTRIES for ROBOTS: a robot, a name, an entry (name :as ...), or a list of
these. Errors name OPERATOR."
  (unless (or (atom robots) (proper-list-p robots))
    (reject-entry operator robots "it is a dotted list"))
  (let ((entries (mapcar (lambda (robot) (parse-robot operator robot))
                         (if (entry-form-p robots) (list robots) (ensure-list robots)))))
    (unless entries
      (reject-use "~(~A~): the list of robots is empty. Name at least one robot." operator))
    (check-names-unlike operator entries)
    (check-one-map entries)
    entries))

;;; Robots that would be in one cell.

(defun check-robots-apart (operator poses map &optional (allowed-p (constantly nil)))
  "POSES is a list of lists (name x y ...). Signal MISUSE if two of these points are in one cell,
unless ALLOWED-P returns true; its arguments are the two names."
  (let ((names (make-hash-table)))
    (loop for (name x y) in poses
          for index = (map-index map x y)
          for other = (gethash index names)
          do (unless (or (null other) (funcall allowed-p other name))
               (reject-use "~(~A~): ~A and ~A would start in one cell, that of ~A. Let one of them ~
                            start elsewhere, or write :ghosts t if robots need not see or block ~
                            each other."
                           operator other name (point-text x y)))
             (setf (gethash index names) name))))

(defun check-entries-apart (operator entries)
  "Signal MISUSE, which names OPERATOR, if two robots of ENTRIES, from PARSE-ROBOTS, start in one
cell."
  (check-robots-apart operator
                      (loop for entry in entries
                            collect (cons (robot-entry-name entry)
                                          (robot-entry-start-pose entry)))
                      (find-map (blueprint-map (robot-entry-blueprint (first entries))))))

;;; Forms.

(defun strip-quote (form)
  (if (and (consp form) (eq 'quote (first form))) (second form) form))

(defun literal-entry-p (form environment)
  "True if FORM is a literal entry (NAME :as ...), not a call of a function."
  (and (entry-form-p form)
       (let ((head (strip-quote (first form))))
         (and head
              (symbolp head)
              (or (find-blueprint head nil) (not (known-function-p head environment)))))))

(defun robots-expression-p (form environment)
  "True if FORM, the robots of WITH-SIMULATION, is an expression, not a name or a list of names."
  (typecase form
    (symbol (and form (known-variable-p form environment) (not (find-blueprint form nil))))
    (cons (let ((head (first form)))
            (and (symbolp head)
                 (not (eq 'quote head))
                 (not (find-blueprint head nil))
                 (not (literal-entry-p form environment))
                 (or (some (lambda (part)
                             (and (consp part) (not (literal-entry-p part environment))))
                           (rest form))
                     (known-function-p head environment)))))))

(defun position-form (form environment)
  "Return a form for the value of :at. FORM is (X Y), two forms, or a form that returns a list."
  (when (and (proper-list-p form) (every #'realp form))
    (setf form `',form))
  (if (and (proper-list-p form)
           (= 2 (length form))
           (not (eq 'quote (first form)))
           (or (not (symbolp (first form)))
               (known-variable-p (first form) environment)
               (not (known-function-p (first form) environment))))
      `(list ,@form)
      form))

(defun option-value-form (key form environment)
  (cond ((eq :at key) (position-form form environment))
        ((and (eq :as key) (consp form) (not (eq 'quote (first form)))) form)
        ((eq :angle key) form)
        (t `',(strip-quote form))))

(defun element-form (element environment)
  (if (and (literal-entry-p element environment) (oddp (length element)))
      `(list ',(strip-quote (first element))
             ,@(loop for (key form) on (rest element) by #'cddr
                     append (list key (option-value-form key form environment))))
      `',element))

(defun literal-robots-form (elements &optional environment)
  "Return a form whose value is a list of robots. ELEMENTS are names and entries as users write them
in a macro, whose ENVIRONMENT is given."
  (if (notany #'consp elements)
      `',elements
      `(list ,@(loop for element in elements collect (element-form element environment)))))

(defun names-in-robots (elements)
  "Return the names of the robots in ELEMENTS, a list of names and entries, that can be variables."
  (loop for element in elements
        for name = (if (and (entry-form-p element) (oddp (length element)))
                       (strip-quote (getf (rest element) :as (first element)))
                       element)
        when (and (symbolp name) (variable-name-p name)) collect name))

(defun robot-list-form (robots environment)
  "ROBOTS are the robots of WITH-SIMULATION. Return a form for them, and the names to bind."
  (cond ((not (or (atom robots) (proper-list-p robots))) (values `',robots '()))
        ((robots-expression-p robots environment) (values robots '()))
        ((and (consp robots) (eq 'quote (first robots)))
         (values robots (names-in-robots (ensure-list (second robots)))))
        ((not (listp robots)) (values `',robots (names-in-robots (list robots))))
        ((literal-entry-p robots environment)
         (values (literal-robots-form (list robots) environment) (names-in-robots (list robots))))
        (t (values (literal-robots-form robots environment) (names-in-robots robots)))))
