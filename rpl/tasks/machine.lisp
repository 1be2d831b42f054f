;;;; machine.lisp -- signals, kinds of nodes, leaves, and waiting.

(in-package :ars-magna.rpl.tasks)

(export '(*leaves-offer-restarts* +nothing+ +parked+ bundle-p call-leaf call-with-value-restarts
          completion-p enter escape-p leaf-p make-bundle make-completion make-escape make-leaf park
          park-again reject-missing-slot single-value wake))

;;; A signal ends or redirects a task: a PLAN-FAILURE; an ESCAPE to an enclosing node, perhaps of an
;;; enclosing task; the word :EVAPORATE; or a COMPLETION, by which the construct that the task
;;; waits in succeeds. A task with children receives a signal only when the last child is gone.

(define-record (escape (:constructor make-escape (target value)))
  "A signal that unwinds to the node TARGET. TARGET receives VALUE."
  (target nil node "the node at which the escape arrives" :export)
  (value nil t "the value that the escape brings" :export))

(define-record (completion (:constructor make-completion (value)))
  "A signal by which a construct succeeds with VALUE."
  (value nil t))

(define-record (bundle (:constructor make-bundle (values)))
  "Several values of a leaf as one object."
  (values '() list "the list of values in the bundle" :export))
(declaim-final escape completion bundle)

(declaim (inline single-value))
(defun single-value (value)
  "Return VALUE, or the first value if VALUE is a bundle."
  (if (bundle-p value) (first (bundle-values value)) value))

;;; Leaves.

(defun reject-missing-slot (slot)
  "Signal MISUSE, because a node was made without its slot SLOT."
  (reject-use "A node of a plan was made without its ~(~A~)." slot))

(define-record (leaf (:include node (step #'step-leaf))
                     (:constructor make-leaf "Return a leaf for a source form and a function of the
environment."))
  "An expression that cannot wait."
  (function (reject-missing-slot 'function) function
            "the function that runs the leaf, with the environment as argument" :writable :export))
(declaim-final leaf)

(defvar *leaves-offer-restarts* nil
  "True while plans may enter the debugger. Leaves then offer restarts: rerun or return a value.")

(declaim (inline call-leaf))
(defun call-leaf (leaf environment)
  "Return the value of LEAF in ENVIRONMENT."
  (if *leaves-offer-restarts*
      (call-with-value-restarts (node-form leaf)
                                (lambda () (funcall (leaf-function leaf) environment)))
      (funcall (leaf-function leaf) environment)))

(defun read-leaf-value ()
  (format *query-io* "~&A form for the value to return: ")
  (finish-output *query-io*)
  (list (evaluate-form (read *query-io*))))

(defvar *inside-leaf-restarts-p* nil
  "True while a leaf offers restarts. If true, the step around the leaf offers no restarts.")

(defun call-with-value-restarts (form function)
  "Return what FUNCTION returns, the value of FORM, with the restarts RETRY and USE-VALUE."
  (let ((text (form-text form)) (*inside-leaf-restarts-p* t))
    (loop
      (restart-case (return (funcall function))
        (retry ()
          :report (lambda (stream) (format stream "Do ~A again." text)))
        (use-value (value)
          :report (lambda (stream) (format stream "Let ~A return a value." text))
          :interactive read-leaf-value
          (return value))))))

(defun step-leaf (node task frame value)
  (declare (ignore task value))
  (values (frame-up frame) (call-leaf node (frame-environment frame))))

(define-global +parked+ (make-frame (make-leaf :function #'identity) (vector) nil)
  "The value that a step returns instead of a frame when its task pauses or has ended.")

(define-global +nothing+ (make-leaf :form nil :function (constantly nil))
  "The expression NIL.")

(declaim (inline enter))
(defun enter (node environment frame)
  "Begin NODE in ENVIRONMENT for FRAME. Return what a step returns. The next step of FRAME gets the
value of NODE. A leaf has no separate frame."
  (if (leaf-p node)
      (values frame (call-leaf node environment))
      (values (make-frame node environment frame) nil)))

(defun park (task awaiting)
  "Note that TASK waits for AWAITING. The current step of TASK must then return +PARKED+."
  (setf (task-state task) :waiting
        (task-awaiting task) awaiting
        (task-since task) (runner-tick (the plan-runner (%task-runner task))))
  (note-event task :wait (traced-subject awaiting)))

(defun park-again (task awaiting)
  "Let TASK, which was made ready to look whether AWAITING has come, go on to wait for it, since the
same tick. The trace does not show that. The current step of TASK must then return +PARKED+."
  (setf (task-state task) :waiting
        (task-awaiting task) awaiting))

(defun wake (task value &optional (reason (task-awaiting task)))
  "Wake TASK, which waits, with VALUE. REASON is the event that TASK waited for."
  (note-event task :wake (traced-subject reason))
  (setf (task-awaiting task) nil
        (task-value task) value)
  (make-ready task))
