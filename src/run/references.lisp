;;;; references.lisp -- how a journal names what its entries are about.

(in-package :ars-magna.run)

;;; A journal outlives its run, so robots, parts and things stand in it as (:the KIND ARGUMENT...),
;;; by name, index or serial number.

(defun externalize (datum)
  "Return DATUM with each object of a run in it replaced by what names it, for INTERNALIZE to find
its like in another run. What cannot be named stands for itself."
  (typecase datum
    ((or number symbol string function) datum)
    (cons (cons (externalize (car datum)) (externalize (cdr datum))))
    (t (let ((reference (reference datum)))
         (if reference (cons :the reference) datum)))))

(defgeneric dereference (kind arguments simulation)
  (:documentation
   "Return what the reference with KIND, a symbol, and ARGUMENTS names in SIMULATION.")
  (:method (kind arguments simulation)
    (unless (and (typep arguments '(cons t (cons (integer 0) null)))
                 (find kind (all-kinds 'part) :key #'kind-name :test #'same-name-p))
      (reject-use "~S names nothing that a run has." (cons kind arguments)))
    (robot-part (robot-in simulation (first arguments)) kind (second arguments))))

(defmacro define-dereference (kind lambda-list &body body)
  "Define what a reference of KIND, a keyword, with arguments as LAMBDA-LIST takes them, names in
SIMULATION, which BODY may refer to."
  `(defmethod dereference ((kind (eql ,kind)) arguments simulation)
     (declare (ignorable simulation))
     (destructuring-bind ,lambda-list arguments ,@body)))

(defun internalize (datum simulation)
  "Return DATUM with each reference in it replaced by what it names in SIMULATION."
  (cond ((atom datum) datum)
        ((eq (first datum) :the)
         (dereference (second datum) (cddr datum) simulation))
        (t (cons (internalize (car datum) simulation) (internalize (cdr datum) simulation)))))

(defun robot-in (simulation name)
  (or (find name (simulation-robots simulation) :key #'robot-name :test #'same-name-p)
      (reject-name "robot in this simulation" name
                   (mapcar #'robot-name (simulation-robots simulation)))))

(define-dereference :robot (name)
  (robot-in simulation name))

(define-dereference :thing (serial)
  (find-thing serial (simulation-world simulation)))

(define-dereference :map (name)
  (find-map name))

(define-dereference :kicker (name)
  (find-kicker name))

(define-dereference :odometer (robot name)
  (robot-odometer (robot-in simulation robot) name))

;; One that had been dropped when the journal was told of it is made up.
(define-dereference :designator (name serial number type)
  (let ((robot (robot-in simulation name)))
    (or (serial-designator robot serial)
        (make-designator :robot robot :serial serial :number number :type type :valid-p nil))))
