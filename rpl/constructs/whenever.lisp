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
  "Return by what TASK hears of CONDITION, its SOURCE of events: a watcher; CONDITION itself if that
is a view that misses nothing; NIL if it is no fluent, and cannot change."
  (cond ((not (fluent-p condition)) nil)
        ((misses-nothing-p condition) condition)
        (t (let ((watcher (make-watcher condition #'hear task)))
             (watch watcher)
             watcher))))

(defun await-event (task source)
  "Let TASK wait until there is another event from SOURCE. Return what a step returns."
  (cond ((watcher-p source)
         (if (plusp (watcher-pending source))
             (give-way task)
             (park task (watcher-fluent source))))
        ((null source) (wait-for-no-fluent task))
        ((fluent-value source) (give-way task))
        (t (wait-until-heard task source)))
  +parked+)

(defun answer-events (source missed)
  "Note that the body will answer the events that SOURCE has, all, or one if MISSED is :all or a
view counts them. Signals WRONG-ARGUMENT."
  (check-argument whenever missed (member missed '(:once :all)) ":once or :all")
  (cond ((not (watcher-p source)))
        ((eq missed :all) (decf (watcher-pending source)))
        (t (setf (watcher-pending source) 0))))

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
true. A pulse of what a network is computed from is one of the network, if that is true then.
Several such events while BODY runs count as one, as (FLUENT :missed :once) says too; with
(FLUENT :missed :all) as the first argument, or a view with :ALWAYS as FLUENT, as many runs follow.
Ends only by RETURN, failure or evaporation (manual D.4)."
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
    (await-event task memory))
   (waiting
    (answer-events memory (funcall missed environment))
    (next reacting)
    (enter body environment frame)))
  (:unwind
   (let ((source (shiftf memory nil)))
     (when (watcher-p source) (unwatch source)))
   nil))
