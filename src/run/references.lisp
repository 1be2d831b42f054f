;;;; references.lisp -- how requests to a run refer to objects, so that they can be repeated.

(in-package :ars-magna.run)

(export '(externalize internalize dereference))

;;; A journal is used after its run, so robots, parts and things are written in it as (:the KIND
;;; ARGUMENT...), with a name, index or serial number. Lists that begin with :THE are written as
;;; (:the :list ...), dotted lists as (:the :list* ...). So are characters and simple vectors.

(defun nameable-p (object)
  "True if OBJECT has a type whose objects DEREFERENCE can find by a reference."
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
    (character (list :the :character (char-code tree)))
    (simple-vector (list* :the :vector (cl:map 'list #'externalize-tree tree)))
    (t (let ((reference (and (nameable-p tree) (reference tree))))
         (if reference
             (list* :the (first reference) (mapcar #'externalize-tree (rest reference)))
             tree)))))

(defun externalize (datum)
  "Return DATUM with each object of a run replaced by a reference, by which INTERNALIZE finds the
counterpart in another run. Other objects, circular lists and very large lists are unchanged."
  (if (tree-p datum) (externalize-tree datum) datum))

(defgeneric dereference (kind arguments simulation)
  (:documentation
   "Return the object in SIMULATION named by the reference (KIND . ARGUMENTS). KIND is a symbol.")
  (:method (kind arguments simulation)
    (unless (and (typep arguments '(cons t (cons (integer 0) null)))
                 (find-kind-name kind 'part))
      (reject-use "~S is not a reference to an object of a run." (cons kind arguments)))
    (robot-part (robot-in simulation (first arguments)) kind (second arguments))))

(defmacro define-dereference (kind lambda-list &body body)
  "Define how to find the object in SIMULATION for a reference of KIND, a keyword. BODY returns the
object. In BODY, the variables of LAMBDA-LIST are bound to the arguments of the reference, and
SIMULATION to the simulation."
  `(defmethod dereference ((kind (eql ,kind)) arguments simulation)
     (declare (ignorable simulation))
     (destructuring-bind ,lambda-list arguments ,@body)))

(defun find-referent (reference simulation)
  "Return the object that REFERENCE, (kind argument...), names in SIMULATION. Signals MISUSE."
  (handler-case (dereference (first reference) (internalize-all (rest reference) simulation)
                             simulation)
    (ars-magna-error (trouble) (error trouble))
    (error () (reject-use "~A is not a reference to an object of a run." (short-text reference)))))

(defun internalize-all (list simulation)
  (mapcar (lambda (tree) (internalize-tree tree simulation)) list))

(defun internalize-tree (tree simulation)
  (cond ((atom tree) tree)
        ((not (proper-list-p tree)) tree)
        ((eq :the (first tree)) (find-referent (rest tree) simulation))
        (t (internalize-all tree simulation))))

(defun internalize (datum simulation)
  "Return DATUM, a value of EXTERNALIZE, with its references replaced by objects of SIMULATION."
  (if (tree-p datum) (internalize-tree datum simulation) datum))

(define-dereference :list (&rest elements)
  elements)

(define-dereference :list* (first &rest elements)
  (append (list first) (butlast elements) (first (last elements))))

(define-dereference :vector (&rest elements)
  (coerce elements 'simple-vector))

(define-dereference :character (code)
  (code-char code))

(defun robot-in (simulation name)
  "Return the robot in SIMULATION that NAME, the name in a reference, means."
  (let* ((robots (simulation-robots simulation)) (meant (robots-meant name robots)))
    (cond ((null meant)
           (reject-name "robot in this simulation" name (mapcar #'robot-name robots)))
          ((rest meant)
           (reject-use "Several robots in this run are called ~A: ~{~A~^, ~}. Give the full name."
                       name (mapcar #'robot-full-name meant)))
          (t (first meant)))))

(define-dereference :simulation ()
  simulation)

(define-dereference :world ()
  (simulation-world simulation))

(define-dereference :robot (name)
  (robot-in simulation name))

(define-dereference :body (name)
  (or (robot-body (robot-in simulation name))
      (reject-use "~A has no body in this run." name)))

;; The thing may have been destroyed before the entry was made; then a stand-in is made.
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

;; The kicker may have been detached; then a stand-in is made.
(define-dereference :attachment (serial name)
  (check-type name (and symbol (not null)))
  (let ((thing (dereference :thing (list serial) simulation)))
    (or (find-attachment thing name)
        (removed-kicker-placeholder thing name))))

(define-dereference :odometer (robot name)
  (robot-odometer (robot-in simulation robot) name))

(define-dereference :recipe (name attributes contents kickers)
  (make-recipe name attributes contents :kickers kickers))

;; The designator may have been dropped; then a stand-in is made.
(define-dereference :designator (name serial number type)
  (let ((robot (robot-in simulation name)))
    (or (designator-with-serial robot serial)
        (make-designator :robot robot :serial serial :number number :type type :valid-p nil))))

;;;; Memorizing arguments

;;; Programs and plans may later change a list or structure that was given to a plan or a fluent.
;;; So a copy is memorized, and each repetition gets a copy of that. Objects of a run in it are
;;; replaced by references, as in a journal. A function is copied with the values it closes over, so
;;; that a function given to SCHEDULE acts on the run in which it is called.

(defstruct (object-placeholder (:constructor make-object-placeholder (reference)) (:copier nil))
  "A placeholder for an object of a run. REFERENCE, a value of EXTERNALIZE, names the object."
  (reference nil :type list :read-only t))

(defun placeholder-for (object)
  "OBJECT is not copied. Return the object that represents OBJECT in memorized arguments."
  (cond ((nameable-p object)
         (let ((reference (externalize object)))
           (if (eq reference object) object (make-object-placeholder reference))))
        ((null *simulation*) object)
        ((eq object *simulation*) (make-object-placeholder '(:the :simulation)))
        ((eq object (simulation-world *simulation*)) (make-object-placeholder '(:the :world)))
        (t object)))

(defun memorize-arguments (arguments)
  "Return a copy of the list ARGUMENTS in its current state, for RECALL-ARGUMENTS."
  (copy-values arguments #'placeholder-for))

(defun recall-arguments (arguments simulation)
  "Return a copy of ARGUMENTS, a value of MEMORIZE-ARGUMENTS, with the objects of SIMULATION."
  (copy-values arguments (lambda (object)
                           (if (object-placeholder-p object)
                               (internalize (object-placeholder-reference object) simulation)
                               object))))

;;; Comparing arguments of two runs.

(defun alike-atoms-p (one other)
  "True if the atoms ONE and OTHER are EQUAL, are functions with the same code, or are objects of
the same class that have no reference. (Each run has its own copy of such objects.)"
  (or (equal one other)
      (and (functionp one) (functionp other) (same-code-p one other))
      (not (or (typep one '(or number symbol character string function))
               (not (eq (class-of one) (class-of other)))))))

(defun alike-trees-p (one other)
  (loop while (and (consp one) (consp other))
        do (unless (alike-trees-p (pop one) (pop other)) (return-from alike-trees-p nil)))
  (alike-atoms-p one other))

(defun alike-across-runs-p (one other)
  "True if ONE and OTHER, both externalized or memorized, can denote the same object in two runs."
  (and (tree-p one) (tree-p other) (alike-trees-p one other)))

(define-shared-types object-placeholder)
