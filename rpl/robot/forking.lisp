;;;; forking.lisp -- plans in forks of their run, and in a run that is rewound.

(in-package :ars-magna.rpl-robot)

(export '(interface-of-robot))

;;; After a rewind a new run replaces the old one. It has the old tasks up to that tick, with the
;;; same numbers. Later tasks of the two runs differ, though they may have the same numbers. So an
;;; interface records the era of each task, a symbol. ERAS is a list (symbol . number), the newest
;;; first; tasks with greater numbers belong to that era. A rewind begins an era; so does
;;; RPL-INIT-ROBOT, after which numbers start again.

(defun era-of-task-number (number interface)
  (car (find number (interface-eras interface) :key #'cdr :test #'>)))

(defun interface-of-robot (robot simulation)
  "Return the interface in SIMULATION for the robot that has the same name as ROBOT, or NIL."
  (find-if (lambda (participant)
             (and (interface-p participant)
                  (eq (robot-name robot) (robot-name (interface-robot participant)))))
           (simulation-participants simulation)))

(defun same-era-p (task interface)
  "True if the counterpart of TASK, a task of another run, has the same number in INTERFACE."
  (let ((number (task-serial task)))
    (eq (era-of-task-number number (runner-client (task-runner task)))
        (era-of-task-number number interface))))

(defmethod counterpart-in-current-run ((task task))
  (let* ((client (and (task-runner task) (runner-client (task-runner task))))
         (interface (and client (interface-of-robot (interface-robot client) *simulation*))))
    (and interface
         (same-era-p task interface)
         (task-numbered (task-serial task) (interface-runner interface)))))

(defun counterpart-of-task (task simulation)
  "SIMULATION is a fork of the run of TASK, or replaces that run in a rewind. Return the counterpart
of TASK there; TASK itself if the counterpart is over. Signals MISUSE if the run was rewound to
before the start of TASK, or if RPL-INIT-ROBOT was called since."
  (let* ((client (runner-client (task-runner task)))
         (interface (interface-of-robot (interface-robot client) simulation)))
    (cond ((and interface (same-era-p task interface))
           (or (task-numbered (task-serial task) (interface-runner interface)) task))
          ((eq (interface-simulation client) (latest-successor (interface-simulation client))) task)
          (t (reject-use "The task ~D, ~A, belongs to a run that was rewound, and is not in the ~
                          run that goes on: it began after the tick to which the run was rewound, ~
                          or RPL-INIT-ROBOT was called since. (plans) lists the plans ~
                          under way."
                         (task-serial task) (task-label task))))))

;;; Where a run is rewound.

(defun eras-until (number eras)
  "Return a list: those of ERAS in which tasks with numbers up to NUMBER began, and the oldest era."
  (append (remove-if (lambda (era) (>= (cdr era) number)) (butlast eras))
          (last eras)))

(defun same-init-call-p (interface other)
  "True if one call of RPL-INIT-ROBOT has made INTERFACE and OTHER, interfaces of two runs."
  (eq (car (first (last (interface-eras interface))))
      (car (first (last (interface-eras other))))))

(defun begin-era (old new)
  "Begin an era in the run NEW, which replaces OLD: later tasks of NEW differ from tasks of OLD."
  (dolist (interface (remove-if-not #'interface-p (simulation-participants new)))
    (let ((before (interface-of-robot (interface-robot interface) old))
          (number (runner-serial (interface-runner interface))))
      (when (and before (same-init-call-p interface before))
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

(defun repeat-call (word arguments serial)
  "Repeat a call made outside of plans: call the function WORD with ARGUMENTS and one more argument,
the task with the number SERIAL. If SERIAL is NIL, the last argument is the runner of plans."
  (let* ((interface (usable-interface))
         (runner (and interface (interface-runner interface)))
         (subject (if (and runner serial) (task-numbered serial runner) runner)))
    (when subject (apply word (append arguments (list subject))))))

(defmethod note-outside-call ((interface interface) word arguments subject)
  (when (interface-valid-p interface)
    (record-plan-action interface #'repeat-call word arguments
                        (and (task-p subject) (task-serial subject)))))

(defun fluent-variable-and-index (fluent)
  "Return a list (variable index) for FLUENT; the index is NIL unless the variable holds a vector.
Return FLUENT itself if no variable holds FLUENT."
  (loop for (variable) in *fluent-variables*
        for value = (symbol-value variable)
        for index = (and (vectorp value) (position fluent value :test #'eq))
        when (or (eq fluent value) index)
          return (list variable index)
        finally (return fluent)))

(defun repeat-fluent-change (function name value)
  "Call FUNCTION with this run's fluent NAME (see FLUENT-VARIABLE-AND-INDEX) and VALUE."
  (funcall function
           (if (consp name)
               (destructuring-bind (variable index) name
                 (if index (aref (symbol-value variable) index) (symbol-value variable)))
               (twin-here name))
           value))

(defun record-fluent-change (function fluent value)
  "Record for rewinds that FUNCTION has been called with FLUENT and VALUE from outside of plans."
  (when (and *simulation* (simulation-past *simulation*))
    (record-outside-act *simulation* #'repeat-fluent-change function
                        (fluent-variable-and-index fluent) value)))

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

(defmethod participant-copy ((interface interface) simulation copier)
  (declare (ignore simulation))
  (let ((twin (forked interface copier))
        (robot (forked (interface-robot interface) copier))
        (realm (forked (source-realm copier) copier)))
    (setf (interface-ender twin) (lambda () (close-interface twin)))
    (push (make-weak-reference (interface-runner interface)) (realm-sources realm))
    (push (interface-ender twin) (robot-enders robot))
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
