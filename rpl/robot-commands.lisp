;;;; robot-commands.lisp -- commands whose results arrive in fluents: the one table (manual C).

(in-package :ars-magna.rpl-robot)

;;; A row says what becomes of the fluents when a command ends. All settings of one end are one
;;; batch: values and errors first, then the pulse, so that whoever sees the pulse sees the rest.
;;; The functions themselves follow from the commands' definitions: what is the robot's is left
;;; out, cameras, hands and bins are given by index, and any argument may be a fluent.

(defun fluent-of (variable part)
  "Return the fluent in VARIABLE, which for a PART is a vector."
  (let ((value (symbol-value variable)))
    (if (simple-vector-p value) (svref value (part-index part)) value)))

(defun convert-argument (value type operator)
  "Return what VALUE, perhaps a fluent or an index, stands for as an argument of TYPE."
  (let ((value (fluent-value value)))
    (cond ((eq type 'camera) (find-part :camera value operator))
          ((eq type 'hand) (find-part :hand value operator))
          ((eq type 'storage-bin) (find-part :bin value operator))
          ((and (eq type 'destination) (integerp value)) (find-part :bin value operator))
          (t value))))

(defun convert-resource (arguments type operator)
  "Return the resource that ARGUMENTS begin with, and the rest; the robot is implied."
  (if (eq type 'robot)
      (values (rpl-robot) arguments)
      (values (convert-argument (first arguments) type operator) (rest arguments))))

(defun command-in-plan (operator command outcome arguments)
  "Issue COMMAND as the plan function OPERATOR, and post what OUTCOME, a function of the resource,
the error code and the results, makes of its end."
  (let ((runner (rpl-runner)))
    (multiple-value-bind (resource arguments)
        (convert-resource arguments (spec-type (command-resource command)) operator)
      (apply (command-name command) resource
             (append (loop for spec in (command-parameters command)
                           for argument in arguments
                           collect (convert-argument argument (spec-type spec) operator))
                     (list (lambda (err resource &rest results)
                             (post-batch runner (apply outcome resource err results)))))))))

(defun plan-function-name (command-name)
  (intern (format nil "RPL-~A" command-name) :ars-magna.rpl-robot))

(defun parameters-in-plan (command)
  "Return the names of what the plan function for COMMAND takes."
  (append (unless (eq 'robot (spec-type (command-resource command)))
            (list (spec-name (command-resource command))))
          (mapcar #'spec-name (command-parameters command))))

(defun clause-form (clause)
  "Return a form that makes a list of settings from CLAUSE of DEFINE-OUTCOME."
  (ecase (first clause)
    (:set (destructuring-bind (fluent value) (rest clause)
            `(list (list :set (fluent-of ',fluent resource) ,value))))
    (:pulse `(list (list :pulse (fluent-of ',(second clause) resource))))
    (:when (destructuring-bind (test . clauses) (rest clause)
             `(when ,test (append ,@(mapcar #'clause-form clauses)))))))

(defun clause-fluents (clauses)
  (loop for clause in clauses
        append (ecase (first clause)
                 ((:set :pulse) (list (second clause)))
                 (:when (clause-fluents (cddr clause))))))

(defmacro define-outcome (commands (&rest results) &body clauses)
  "Define the plan functions of COMMANDS. When one ends, CLAUSES are carried out with ERR bound to
its error code and RESULTS to its results: (:set fluent form), (:pulse fluent), (:when form
clause...)."
  `(progn
     ,@(loop for command-name in commands
             for command = (find-command command-name)
             for name = (plan-function-name command-name)
             for parameters = (parameters-in-plan command)
             collect `(defun ,name ,parameters
                        ,(format nil "~A~%Returns nothing; sets ~(~{~A~^, ~}~). Arguments may be ~
                                      fluents. (Manual C.)"
                                 (command-documentation command)
                                 (remove-duplicates (clause-fluents clauses)))
                        (command-in-plan ',name (find-command ',command-name)
                                         (lambda (resource err &optional ,@results)
                                           (declare (ignorable resource err ,@results))
                                           (append ,@(mapcar #'clause-form clauses)))
                                         (list ,@parameters))))))

;;; The robot.

(define-outcome (robot-set-speed robot-set-turn-angle) ()
  (:set robot-movement-error* err))

(define-outcome (robot-turn robot-about-face robot-turn-left robot-turn-right robot-turn-corner
                 robot-align-place)
    (angle)
  (:when angle (:set robot-angle-diff* angle))
  (:set robot-movement-error* err)
  (:pulse robot-stopped*))

(define-outcome (robot-go-forward robot-goto-wall robot-follow-wall robot-stop) ()
  (:set robot-movement-error* err)
  (:pulse robot-stopped*))

(define-outcome (robot-goto-designator) (camera designator)
  (:when (null err) (:set robot-arrived-at* designator))
  (:set robot-movement-error* err)
  (:pulse robot-stopped*))

(define-outcome (robot-place) (place-type)
  (:set robot-place* place-type)
  (:pulse robot-place-input*))

;;; Cameras.

(define-outcome (camera-turn camera-align-robot camera-align-place camera-insert camera-remove) ()
  (:set camera-movement-error* err)
  (:pulse camera-moved*))

(define-outcome (camera-view) (view)
  (:when (null err) (:set camera-views* view))
  (:set camera-error* err)
  (:pulse camera-input*))

(define-outcome (camera-get-object-designator camera-get-place-designator) (designator)
  (:set camera-designators* (if designator (list designator) '()))
  (:set camera-error* err)
  (:pulse camera-input*))

(define-outcome (camera-get-all-object-designators camera-get-all-place-designators) (designators)
  (:set camera-designators* designators)
  (:set camera-error* err)
  (:pulse camera-input*))

;; A track is answered twice: when it starts, without an error, and when it ends, with one.
(define-outcome (camera-track) ()
  (:set camera-tracking-error* err)
  (:when (null err) (:pulse camera-tracking*)))

(define-outcome (camera-untrack) ()
  (:when err (:set camera-tracking-error* err)))

;;; Hands.

(define-outcome (hand-insert hand-insert-bin) (destination)
  (:when (null err) (:set hand-inside* destination))
  (:set hand-error* err)
  (:pulse hand-moved*))

(define-outcome (hand-remove) ()
  (:when (null err) (:set hand-inside* nil))
  (:set hand-error* err)
  (:pulse hand-moved*))

(define-outcome (hand-grasp-desig) (designator)
  (:when (null err) (:set hand-grasping* designator))
  (:set hand-error* err)
  (:pulse hand-moved*))

(define-outcome (hand-ungrasp) ()
  (:when (member err '(nil :not-grasping)) (:set hand-grasping* nil))
  (:set hand-error* err)
  (:pulse hand-moved*))

(define-outcome (hand-grasp-check) ()
  (:when (eq err :not-grasping) (:set hand-grasping* nil))
  (:set hand-error* err)
  (:pulse hand-input*))

(define-outcome (hand-track) ()
  (:when (member err '(:grasp-lost :not-grasping)) (:set hand-grasping* nil))
  (:set hand-error* err)
  (:when (eq err :grasp-lost) (:pulse hand-lost*)))

;;; Storage bins.

(define-outcome (storage-bin-open) ()
  (:set storage-bin-error* err)
  (:pulse storage-bin-moved*))

(define-outcome (storage-bin-close) (jammed-part)
  (:set storage-bin-jammer* jammed-part)
  (:set storage-bin-error* err)
  (:pulse storage-bin-moved*))
