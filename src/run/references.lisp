;;;; references.lisp -- how a journal names what its entries are about.

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
