;;;; whenever.lisp -- reacting to whatever happens.

(in-package :ars-magna.rpl.constructs)

(defun hear (watcher value trouble)
  "Let the task that WATCHER is for start its body, or remember that it is to."
  (declare (ignore value))
  (let* ((task (watcher-client watcher))
         (frame (task-frame task)))
    (incf (watcher-pending watcher))
    (when (and frame (eq watcher (frame-data frame)) (eq (task-state task) :waiting))
      (when trouble
        (setf (task-signal task) (failure-of trouble task frame)))
      (wake task nil))))

(defun listen-to (condition task)
  "Return a watcher by which TASK hears of CONDITION; NIL if that is no fluent, and cannot change."
  (when (fluent-p condition)
    (let ((watcher (make-watcher condition #'hear task)))
      (watch watcher)
      watcher)))

(defun await-event (task watcher)
  "Let TASK wait until WATCHER has heard something. Return what a step returns."
  (if watcher
      (park task (watcher-fluent watcher))
      (wait-for-no-fluent task))
  +parked+)

(defun answer-events (watcher missed)
  "Note that the body will answer the events that WATCHER has heard: all, or one if MISSED is :all.
Signals WRONG-ARGUMENT."
  (check-argument whenever missed (member missed '(:once :all)) ":once or :all")
  (if (eq missed :all)
      (decf (watcher-pending watcher))
      (setf (watcher-pending watcher) 0)))

(defun fluent-with-options-p (condition environment)
  "True if CONDITION, as WHENEVER has it, is a list of a form and keywords, and no call."
  (and (typep condition '(cons t (cons keyword)))
       (or (eq :missed (second condition))
           (consp (first condition))
           (known-variable-p (first condition) environment))))

(defun split-condition (condition scope)
  "Return a list of the fluent's form and the form for :missed in CONDITION, as WHENEVER has it in
SCOPE. Signals MALFORMED-DEFINITION."
  (cond ((not (fluent-with-options-p condition (scope-environment scope))) (list condition :once))
        ((and (typep condition '(cons t (cons (eql :missed) (cons t null))))
              (typep (third condition) '(or (member :once :all) (and symbol (not keyword)) cons)))
         (list (first condition) (third condition)))
        (t (reject-clause (author) condition "(fluent :missed :once) or (fluent :missed :all)"))))

(define-construct whenever (fluent &body body)
  "Run BODY in a plan whenever FLUENT, or a network, becomes true or is pulsed, and at once if it is
true. Several such events while BODY runs count as one, as (FLUENT :missed :once) says too; with
(FLUENT :missed :all) as the first argument as many runs follow. Ends only by RETURN, failure or
evaporation (manual D.4)."
  (:manual)
  (:arguments (first (split-condition fluent scope)))
  (:parts (condition function (awaited-lambda (first (split-condition fluent scope)) form scope))
          (missed function (value-lambda (second (split-condition fluent scope)) scope))
          (body node (body-code body (single-scope scope))))
  (:code (block-code nil form scope #'build))
  (:steps
   (begin
    (let ((condition (funcall condition environment)))
      (setf memory (listen-to condition task))
      (cond ((fluent-value condition) (next reacting) (enter body environment frame))
            (t (next waiting) (await-event task memory)))))
   (reacting
    (next waiting)
    (if (and memory (plusp (watcher-pending memory)))
        (give-way task)
        (await-event task memory)))
   (waiting
    (answer-events memory (funcall missed environment))
    (next reacting)
    (enter body environment frame)))
  (:unwind
   (let ((watcher (shiftf memory nil)))
     (when watcher (unwatch watcher)))
   nil))
