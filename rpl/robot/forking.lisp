;;;; forking.lisp -- plans in forks of their run, and in a run that is rewound.

(in-package :ars-magna.rpl-robot)

(export '(interface-of-simulation))

;;; After a rewind a new run replaces the old one. It has the old tasks up to that tick, with the
;;; same numbers. Later tasks of the two runs differ, though they may have the same numbers. So an
;;; interface records the era of each task, a symbol. ERAS is a list (symbol . number), the newest
;;; first; tasks with greater numbers belong to that era. A rewind begins an era.

(defun era-of-task-number (number interface)
  (car (find number (interface-eras interface) :key #'cdr :test #'>)))

(defun interface-of-simulation (simulation)
  "Return the interface of SIMULATION, or NIL if no plans have driven a robot of SIMULATION."
  (find-if #'interface-p (simulation-participants simulation)))

(defun same-era-p (task interface)
  "True if the counterpart of TASK, a task of another run, has the same number in INTERFACE."
  (let ((number (task-serial task)))
    (eq (era-of-task-number number (runner-client (task-runner task)))
        (era-of-task-number number interface))))

(defmethod counterpart-in-current-run ((task task))
  (let* ((client (and (task-runner task) (runner-client (task-runner task))))
         (interface (and client *simulation* (interface-of-simulation *simulation*))))
    (and interface
         (same-era-p task interface)
         (task-numbered (task-serial task) (interface-runner interface)))))

(defun counterpart-of-task (task simulation)
  "SIMULATION is a fork of the run of TASK, or replaces that run in a rewind. Return the counterpart
of TASK there; TASK itself if the counterpart is over. Signals MISUSE if the run was rewound to
before the start of TASK."
  (let* ((client (runner-client (task-runner task)))
         (interface (interface-of-simulation simulation)))
    (cond ((and interface (same-era-p task interface))
           (or (task-numbered (task-serial task) (interface-runner interface)) task))
          ((eq (interface-simulation client) (latest-successor (interface-simulation client))) task)
          (t (reject-use "The task ~D, ~A, belongs to a run that was rewound, and is not in the ~
                          run that goes on: it began after the tick to which the run was rewound. ~
                          (plans) lists the plans under way."
                         (task-serial task) (task-label task))))))

;;; Where a run is rewound.

(defun eras-until (number eras)
  "Return a list: those of ERAS in which tasks with numbers up to NUMBER began, and the oldest era."
  (append (remove-if (lambda (era) (>= (cdr era) number)) (butlast eras))
          (last eras)))

(defun same-origin-p (interface other)
  "True if INTERFACE and OTHER, interfaces of two runs, are copies of the same interface."
  (eq (car (first (last (interface-eras interface))))
      (car (first (last (interface-eras other))))))

(defun begin-era (old new)
  "Begin an era in the run NEW, which replaces OLD: later tasks of NEW differ from tasks of OLD."
  (dolist (interface (remove-if-not #'interface-p (simulation-participants new)))
    (let ((before (interface-of-simulation old))
          (number (runner-serial (interface-runner interface))))
      (when (and before (same-origin-p interface before))
        (setf (interface-eras interface) (interface-eras before)))
      (setf (interface-eras interface)
            (cons (cons (gensym "ERA") number)
                  (eras-until number (interface-eras interface)))))))

(add-listener *rewind-hooks* begin-era)

;;; When a run is repeated, plans do the same again. But the journal does not record calls from
;;; outside: that plans were begun and ended, fluents set, commands issued by plan functions, or
;;; tasks suspended. A run that can be rewound records them itself.

(defun repeat-reaction ()
  (let ((interface (usable-interface)))
    (when interface
      (with-plans (interface) (react-fully interface)))))

(defun record-plan-action (interface function &rest arguments)
  "Record an action in the run of INTERFACE. FUNCTION, called with ARGUMENTS, repeats the action."
  (apply #'record-outside-act (interface-simulation interface) function arguments))

(defun repeat-call (word arguments serial &optional robot)
  "Repeat a call made outside of plans: call the function WORD with ARGUMENTS and one more argument,
the task with the number SERIAL or, if there is a ROBOT, the agent of its plans. Otherwise the last
argument is the runner of plans."
  (let* ((interface (usable-interface))
         (runner (and interface (interface-runner interface)))
         (driver (and interface robot (find-driver robot interface)))
         (subject (cond ((and runner serial) (task-numbered serial runner))
                        (robot (and driver (driver-agent driver)))
                        (t runner))))
    (when subject (apply word (append arguments (list subject))))))

(defmethod note-outside-call ((driver driver) word arguments subject)
  (when (interface-valid-p (driver-interface driver))
    (record-plan-action (driver-interface driver) #'repeat-call word arguments
                        (and (task-p subject) (task-serial subject))
                        (if (task-p subject) nil (driver-robot driver)))))

(defun place-of-fluent (fluent interface)
  "Return a list (robot variable index) for FLUENT, a fluent of a robot in INTERFACE; the index is
NIL unless the variable stands for a vector. Return FLUENT itself if it belongs to no robot."
  (let ((driver (and interface (driver-of-fluent fluent interface))))
    (loop for (variable . value) in (and driver (driver-fluents driver))
          for index = (and (vectorp value) (position fluent value :test #'eq))
          when (or (eq fluent value) index)
            return (list (driver-robot driver) variable index)
          finally (return fluent))))

(defun repeat-fluent-change (function place value robot)
  "Call FUNCTION with this run's fluent at PLACE (see PLACE-OF-FLUENT; there ROBOT was a separate
argument) and VALUE."
  (funcall function
           (if robot
               (destructuring-bind (variable index) place (robot-fluent robot variable index))
               (twin-here place))
           value))

(defun record-fluent-change (function fluent value)
  "Record for rewinds that FUNCTION has been called with FLUENT and VALUE from outside of plans."
  (when (and *simulation* (simulation-past *simulation*))
    (let ((place (place-of-fluent fluent (interface-of-simulation *simulation*))))
      (record-outside-act *simulation* #'repeat-fluent-change function
                          (if (consp place) (rest place) place) value
                          (and (consp place) (first place))))))

(defmethod note-outside-change ((interface interface) function fluent value)
  (record-fluent-change function fluent value))

(defmethod note-outside-change ((interface null) function fluent value)
  (record-fluent-change function fluent value))

;;; References to a run that is over are dropped.

(defun realm-of-simulation (simulation)
  (cdr (assoc '*realm* (environment-of simulation))))

(defun drop-fluents-of-old-run (old new)
  "Remove references to the run OLD from the fluents of the run NEW, which replaces OLD."
  ;; The realm may be that of a live run around OLD, too.
  (when (or (eq old (global-value '*simulation*))
            (not (eq (realm-of-simulation old) (global-value '*realm*))))
    (drop-realm-references (realm-of-simulation old) (realm-of-simulation new))))

(add-listener *rewind-hooks* drop-fluents-of-old-run)

(defun copy-fluents-back (old new)
  "Copy the values of fluents to OLD, a rewound run, from NEW, its replacement, which is over."
  (let ((from (realm-of-simulation new)) (realm (realm-of-simulation old)))
    (unless (or (null realm) (eq from realm)) (copy-back-values from realm))))

(add-listener *rewound-end-hooks* copy-fluents-back)

;; A live run that was rewound has let top-level code work in a fork of where that worked before.
(defun return-to-root-realm (robot options)
  "Let top-level code work in the root realm of fluents again, because the simulator of ROBOT has
started a new run. Fluents keep their last values."
  (declare (ignore robot options))
  (let ((from (global-value '*realm*)))
    (unless (eq from +root+)
      (copy-back-values from +root+)
      (setf (global-value '*realm*) +root+)
      (when (eq from *realm*) (setf *realm* +root+)))))

(add-listener *simulator-hooks* return-to-root-realm)

;;; Plans are copied while they rest, between two reactions: then all that they are about to do is
;;; in their tasks, and in what was posted to them.

(defmethod client-in-copied-run-p ((interface interface) copier)
  (eq (interface-simulation interface) (copier-option copier :simulation)))

(defmethod copy-plan-value ((interface interface) fork)
  (if (client-in-copied-run-p interface fork)
      (copy-slots interface fork)
      interface))

(defmethod copy-plan-value ((driver driver) fork)
  (if (client-in-copied-run-p (driver-interface driver) fork)
      (copy-slots driver fork)
      driver))

(defmethod participant-copy ((interface interface) simulation copier)
  (declare (ignore simulation))
  (let ((twin (forked interface copier))
        (realm (forked (source-realm copier) copier)))
    (push (make-weak-reference (interface-runner interface)) (realm-sources realm))
    (mapc #'set-ender (interface-drivers twin))
    twin))

;; What this thread is in the middle of cannot continue in a fork.
(defmethod participant-around-p ((interface interface))
  (and (holding-plans-p interface) (not (interface-resting-p interface))))

(defmethod check-forkable ((interface interface))
  (when (participant-around-p interface)
    (refuse-fork "a plan is at work here. In the text of a plan, use PROJECT or ~
                  TRY-BEST, which fork the run when the plans are at rest.")))

(defun call-with-plans-at-rest (interface function)
  "Call FUNCTION while this thread holds the plans of INTERFACE, and return its value. Return :BUSY
if another thread holds the plans."
  (multiple-value-bind (value free-p)
      (call-if-free (interface-lock interface)
                    (lambda ()
                      (call-holding-plans (lambda ()
                                            ;; This repairs what an interrupt has left.
                                            (with-owned-home ((interface-runner interface)))
                                            (funcall function))
                                          interface)))
    (if free-p value :busy)))

(defmethod participant-at-rest ((interface interface) function)
  (cond ((interface-resting-p interface) (funcall function))
        (t (check-not-blocked interface)
           (call-with-plans-at-rest interface function))))

(defmethod call-as-participant-makes-way ((interface interface) function)
  (call-wanting-plans (lambda (have)
                        (declare (ignore have))
                        (allowing-interrupts (funcall function)))
                      interface))

(defmethod participant-place ((interface interface) value)
  (multiple-value-bind (task name) (task-whose-variable-holds value (interface-runner interface))
    (and task (format nil "the variable ~(~A~) of the task ~D, ~A"
                      name (task-serial task) (task-label task)))))

;;; Counterparts.

(defmethod counterpart-in-current-run ((entity entity))
  (entity-here entity))
