;;;; references.lisp -- how requests to a run refer to objects, so that they can be repeated.

(in-package :ars-magna.run)

(export '(externalize internalize dereference))

;;; A journal outlives its run, so robots, parts and things stand in it as (:the KIND ARGUMENT...),
;;; by name, index or serial number. Lists that begin with :THE themselves are written as (:the
;;; :list ...), those that do not end in NIL as (:the :list* ...).

(defun nameable-p (object)
  "True if OBJECT is of a kind that DEREFERENCE finds by its reference."
  (typep object '(or thing attachment robot part designator odometer map kicker recipe)))

(defun externalize-list (list)
  (let ((elements (loop for tail = list then (cdr tail)
                        while (consp tail) collect (externalize-tree (car tail)) into elements
                        finally (return (if tail
                                            (append elements (list (externalize-tree tail)))
                                            elements)))))
    (cond ((not (proper-list-p list)) (list* :the :list* elements))
          ((eq :the (first list)) (list* :the :list elements))
          (t elements))))

(defun externalize-tree (tree)
  (typecase tree
    (string (copy-seq tree))
    ((or number symbol function) tree)
    (cons (externalize-list tree))
    (t (let ((reference (and (nameable-p tree) (reference tree))))
         (if reference
             (list* :the (first reference) (mapcar #'externalize-tree (rest reference)))
             tree)))))

(defun externalize (datum)
  "Return DATUM with each object of a run in it replaced by what names it, for INTERNALIZE to find
its like in another run. What cannot be named stands for itself, as do circular and very large
lists."
  (if (tree-p datum) (externalize-tree datum) datum))

(defgeneric dereference (kind arguments simulation)
  (:documentation
   "Return what the reference with KIND, a symbol, and ARGUMENTS names in SIMULATION.")
  (:method (kind arguments simulation)
    (unless (and (typep arguments '(cons t (cons (integer 0) null)))
                 (find-kind-name kind 'part))
      (reject-use "~S names nothing that a run has." (cons kind arguments)))
    (robot-part (robot-in simulation (first arguments)) kind (second arguments))))

(defmacro define-dereference (kind lambda-list &body body)
  "Define what a reference of KIND, a keyword, with arguments as LAMBDA-LIST takes them, names in
SIMULATION, which BODY may refer to."
  `(defmethod dereference ((kind (eql ,kind)) arguments simulation)
     (declare (ignorable simulation))
     (destructuring-bind ,lambda-list arguments ,@body)))

(defun find-referent (reference simulation)
  "Return what REFERENCE, (kind argument...), names in SIMULATION. Signals MISUSE."
  (handler-case (dereference (first reference) (internalize-all (rest reference) simulation)
                             simulation)
    (ars-magna-error (trouble) (error trouble))
    (error () (reject-use "~A names nothing that a run has." (short-text reference)))))

(defun internalize-all (list simulation)
  (mapcar (lambda (tree) (internalize-tree tree simulation)) list))

(defun internalize-tree (tree simulation)
  (cond ((atom tree) tree)
        ((not (proper-list-p tree)) tree)
        ((eq :the (first tree)) (find-referent (rest tree) simulation))
        (t (internalize-all tree simulation))))

(defun internalize (datum simulation)
  "Return DATUM, what EXTERNALIZE has returned, with what it names in SIMULATION."
  (if (tree-p datum) (internalize-tree datum simulation) datum))

(define-dereference :list (&rest elements)
  elements)

(define-dereference :list* (first &rest elements)
  (append (list first) (butlast elements) (first (last elements))))

(defun robot-in (simulation name)
  (or (find name (simulation-robots simulation) :key #'robot-name :test #'same-name-p)
      (reject-name "robot in this simulation" name
                   (mapcar #'robot-name (simulation-robots simulation)))))

(define-dereference :simulation ()
  simulation)

(define-dereference :world ()
  (simulation-world simulation))

(define-dereference :robot (name)
  (robot-in simulation name))

;; One that had been destroyed when the journal was told of it is made up.
(define-dereference :thing (serial)
  (check-type serial unsigned-byte)
  (let ((world (simulation-world simulation)))
    (or (find-thing serial world)
        (destroyed-thing serial world)
        (reject-use "There is no thing with the number ~D." serial))))

(define-dereference :map (name)
  (let ((map (world-map (simulation-world simulation))))
    (unless (same-name-p name (map-name map)) (reject-name "map here" name (list (map-name map))))
    map))

(define-dereference :kicker (name)
  (find-kicker name))

;; Nor need a kicker be there any more.
(define-dereference :attachment (serial name)
  (check-type name (and symbol (not null)))
  (let ((thing (dereference :thing (list serial) simulation)))
    (or (find-attachment thing name)
        (detached-kicker thing name))))

(define-dereference :odometer (robot name)
  (robot-odometer (robot-in simulation robot) name))

(define-dereference :recipe (name attributes contents kickers)
  (make-recipe name attributes contents :kickers kickers))

;; One that had been dropped when the journal was told of it is made up.
(define-dereference :designator (name serial number type)
  (let ((robot (robot-in simulation name)))
    (or (serial-designator robot serial)
        (make-designator :robot robot :serial serial :number number :type type :valid-p nil))))

;;;; Remembering

;;; Whoever has given a plan a list or a structure, or a fluent a value, may change that later; so
;;; may the plan. What is remembered of it is therefore a copy, and what is done again with it has a
;;; copy of that. Objects of a run in it are named, as in a journal, to be found in another run. A
;;; function is copied with what it has closed over: what SCHEDULE is to do acts on the run in which
;;; it happens.

(defstruct (named (:constructor make-named (reference)) (:copier nil))
  "Stands for the object of a run that REFERENCE, which EXTERNALIZE has returned, names."
  (reference nil :type list :read-only t))

(defun name-object (object)
  "Return what stands for OBJECT, of which no copy is to be made, in what is remembered."
  (cond ((nameable-p object)
         (let ((reference (externalize object)))
           (if (eq reference object) object (make-named reference))))
        ((null *simulation*) object)
        ((eq object *simulation*) (make-named '(:the :simulation)))
        ((eq object (simulation-world *simulation*)) (make-named '(:the :world)))
        (t object)))

(defun memorized (arguments)
  "Return the list ARGUMENTS, to be remembered as they are now. See RECALLED."
  (copy-values arguments #'name-object))

(defun recalled (arguments simulation)
  "Return ARGUMENTS, which MEMORIZED has returned, as they were, for SIMULATION."
  (copy-values arguments (lambda (object)
                           (if (named-p object)
                               (internalize (named-reference object) simulation)
                               object))))

;;; Whether what a fork asks for is what was asked for.

(defun alike-atoms-p (one other)
  "True if ONE and OTHER, no conses, are EQUAL, functions of one code, or of one type and nameless:
each run has its own."
  (or (equal one other)
      (and (functionp one) (functionp other) (same-code-p one other))
      (not (or (typep one '(or number symbol character string function))
               (not (eq (class-of one) (class-of other)))))))

(defun alike-trees-p (one other)
  (loop while (and (consp one) (consp other))
        do (unless (alike-trees-p (pop one) (pop other)) (return-from alike-trees-p nil)))
  (alike-atoms-p one other))

(defun alike-p (one other)
  "True if ONE and OTHER, externalized or memorized, may be the same for two runs."
  (and (tree-p one) (tree-p other) (alike-trees-p one other)))

(define-shared named)
