;;;; forking-oracle.lisp -- finds what a run and its fork share by a full, slow search.

(in-package :ars-magna.tests)

(def-suite* forking :in ars-magna)

;;; A survey has all objects that can be reached from a run: through slots of structures and
;;; instances, lists, arrays, tables, closures and the cells of their variables. It does not use
;;; kinds or the copier. It stops at code, definitions and records of the past, which all runs
;;; share.

(defparameter *everybodys*
  '(number character symbol string package pathname class generic-function method
    definitions::object-kind base:message sb-thread:thread sb-thread:mutex
    world:map world::recipe world:kicker world::substance world::attribute world:place-type
    world::place world::rule ars-magna.ways:terrain
    robot::blueprint command:command command::manipulation
    command::manipulation-method time::interruption
    tasks::chronicle tasks::issue fluents::realm run::warning-record (simple-vector 0))
  "The types of what a run and its forks may share, or of what notes what has been.")

(defun everybodys-p (object)
  "True if runs may share OBJECT."
  (or (some (lambda (type) (typep object type)) *everybodys*)
      (and (functionp object) (not (base:closure-p object)))
      (typecase object
        (ars-magna.ways::field (ars-magna.ways::field-lock object))
        (tasks::node (eq :shared (tasks::node-sharing object)))
        (tasks::procedure (nth-value 1 (tasks::shareable-nodes object))))))

(defun replaced-slots (object)
  "Return the names of the slots of OBJECT in which nothing is ever altered; kinds say so of them."
  (let ((kind (base:kind-of object)))
    (typecase object
      (base:message-queue '(definitions::newest-first definitions::seen))
      (run:journal '(run::newest-first run::header))
      (tasks::node '(tasks::form tasks::names tasks::states))
      (tasks::procedure '(tasks::lambda-list tasks::source))
      ((satisfies base:environment-p)
       (remove-if-not #'host:interpreter-only-slot-p (mapcar #'sb-mop:slot-definition-name
                                                             (sb-mop:class-slots (class-of object)))
                      :key #'string))
      (tasks::plan-runner '(tasks::warned))
      (fluents:entity '(first))
      (t (and kind
              (mapcar #'base:kind-slot-name
                      (remove-if-not #'base:kind-slot-shared-p (base:kind-slots kind))))))))

(defun slots-in (object)
  "Return a list (name . value) for each slot of OBJECT, a structure or an instance."
  (loop for slot in (sb-mop:class-slots (class-of object))
        for name = (sb-mop:slot-definition-name slot)
        when (and (slot-boundp object name)
                  (not (member name (replaced-slots object))))
          collect (cons name (slot-value object name))))

(defun referents (object)
  "Return a list (where . what) of what OBJECT refers to."
  (typecase object
    (cons (list (cons :car (car object)) (cons :cdr (cdr object))))
    (hash-table (loop for key being the hash-keys of object using (hash-value value)
                      collect (cons :key key) collect (cons :value value)))
    (array (if (eq t (array-element-type object))
               (loop for index below (array-total-size object)
                     collect (cons index (row-major-aref object index)))
               '()))
    (function (loop for value in (host::closure-values object) collect (cons :closed value)))
    ((or structure-object standard-object condition) (slots-in object))
    (t (if (host::value-cell-p object)
           (list (cons :variable (host::cell-value object)))
           '()))))

(defun survey (&rest roots)
  "Return a table of all objects that can be reached from ROOTS and are not shared by all runs, each
with (where . parent) of the first path to it."
  (let ((table (make-hash-table :test 'eq)) (work '()))
    (flet ((visit (object whence)
             (unless (or (null object) (everybodys-p object) (gethash object table))
               (setf (gethash object table) whence)
               (push object work))))
      (dolist (root roots) (visit root '(:root)))
      (loop while work
            do (let ((object (pop work)))
                 (loop for (where . what) in (referents object)
                       do (visit what (cons where object)))))
      table)))

(defun survey-run (simulation)
  "Return a survey of SIMULATION and of what it has bound."
  (survey simulation (mapcar #'cdr (run:environment-of simulation))))

(defun way-to (object survey)
  "Return how OBJECT is come to in SURVEY, as a list of types and slots from the root."
  (loop with way = (list (type-of object))
        for (where . whence) = (gethash object survey)
        while whence
        do (push where way)
           (unless (consp whence)
             (push (if (symbolp (type-of whence)) (type-of whence) (class-name (class-of whence)))
                   way))
           (setf object whence)
        finally (return way)))

(defun shared-by (simulation fork)
  "Return the ways to what both SIMULATION and FORK reach and should not."
  (let ((one (survey-run simulation)) (other (survey-run fork)) (ways '()))
    (loop for object being the hash-keys of other
             using (hash-value (nil . whence))
          do (when (and (gethash object one) (not (gethash whence one)))
               (pushnew (way-to object other) ways :test #'equal)))
    ways))

;;; Whether two runs go the same way.

(defun trace-text (simulation)
  "Return what happened to the plans of SIMULATION, as text, or NIL if nobody notes that."
  (let ((trace (run::call-in-simulation simulation
                                (lambda ()
                                  (and driver::*default-interface*
                                       (rpl:plan-trace (driver:rpl-runner)))))))
    (and trace (with-output-to-string (stream) (rpl:write-trace trace stream)))))

(defun messages-text (simulation)
  "Return the messages of SIMULATION as text, and take them."
  (format nil "~{~A~%~}"
          (mapcar #'base:message-text (base:take-messages (run::simulation-messages simulation)))))

(defun passing (ticks simulation)
  "Pass TICKS of SIMULATION. Return a list of its digests, plans and all, with what was said."
  (loop repeat ticks
        until (run:simulation-over simulation)
        do (run:run-ticks 1 simulation)
        collect (run:state-digest simulation t)
        collect (messages-text simulation)))

(defun fork-trouble (simulation ticks &rest options)
  "Fork SIMULATION with OPTIONS, and the fork again. Let these two and SIMULATION pass TICKS. Return
a list of what is wrong."
  (let* ((digest (run:state-digest simulation t))
         (fork (apply #'run:fork-simulation simulation options))
         (forks-fork (apply #'run:fork-simulation fork options))
         (shared (shared-by simulation fork))
         (sooner (passing ticks fork))
         (disturbed-p (/= digest (run:state-digest simulation t)))
         (later (passing ticks simulation))
         (last (passing ticks forks-fork)))
    (append shared
            (when disturbed-p (list "the original was disturbed"))
            (unless (equal sooner later) (list "the fork went another way"))
            (unless (equal later last) (list "the fork's fork went another way"))
            (unless (equal (trace-text fork) (trace-text simulation))
              (list "the traces of plans differ")))))
