;;;; propagation.lisp -- setting and pulsing fluents, and notifying their watchers.

(in-package :ars-magna.rpl.fluents)

(export '(apply-settings copy-back-values))

;;; A change notifies first the watchers of the fluent that was set, in order of arrival, and then
;;; the dependent fluents in order of height. So each is computed at most once, and never from a
;;; mixture of old and new values. Watchers are called only for true values and for errors. A task
;;; whose watcher was called for a true value will wake, whatever happens to the fluent afterwards.
;;;
;;; A pulse notifies the watchers of all dependent fluents that are true at its instant, even if it
;;; does not change them. The change back notifies the watchers of what was false at the instant.

(defvar *propagating* nil
  "While a change spreads through networks, a list whose only element is a list of the views that
are true for the instant of the change; otherwise NIL. Meanwhile networks must not set fluents.")

(defun backlog-now ()
  (if *runner* (home-backlog *runner*) (make-backlog)))

;; Costs 1 ns without a trace.
(declaim (inline trace-change))
(defun trace-change (kind fluent value)
  "If there is a current plan runner, record in its trace that FLUENT has the new value VALUE."
  (let* ((home *runner*)
         (function (and home (home-on-change home))))
    (when function (funcall function kind fluent value))))

(defun grow-backlog (backlog height)
  (flet ((grown (vector)
           (replace (make-array (* 2 (1+ height)) :initial-element nil) vector)))
    (setf (backlog-heads backlog) (grown (backlog-heads backlog))
          (backlog-tails backlog) (grown (backlog-tails backlog)))))

(defun append-to-backlog (derived backlog height)
  (when (>= height (length (backlog-heads backlog))) (grow-backlog backlog height))
  (setf (derived-successor derived) nil
        (backlog-highest backlog) (max height (backlog-highest backlog)))
  (let ((tail (svref (backlog-tails backlog) height)))
    (if tail
        (setf (derived-successor tail) derived)
        (setf (svref (backlog-heads backlog) height) derived))
    (setf (svref (backlog-tails backlog) height) derived)))

(defun enqueue (derived backlog how)
  "Put DERIVED into BACKLOG, to be renewed later. HOW is as for RENEW-DERIVED-FLUENT."
  (unless (derived-queued derived)
    (setf (derived-queued derived) how)
    (append-to-backlog derived backlog (fluent-height derived)))
  (when (eq t how) (setf (derived-queued derived) t)))

(defun dequeue (height backlog)
  "Remove and return the next fluent of HEIGHT from BACKLOG, and how to renew it; or NIL."
  (let ((derived (svref (backlog-heads backlog) height)))
    (when derived
      (let ((successor (shiftf (derived-successor derived) nil)))
        (setf (svref (backlog-heads backlog) height) successor)
        (unless successor (setf (svref (backlog-tails backlog) height) nil))
        (values derived (shiftf (derived-queued derived) nil))))))

(defun notify-watchers (fluent)
  "Notify the watchers of FLUENT, which has just changed or been pulsed, if it is true or in error."
  (let ((value (fluent-now fluent))
        (trouble (and (derived-p fluent) (derived-trouble fluent))))
    (when (or value trouble)
      (loop for watcher = (fluent-first-watcher fluent) then next
            while watcher
            for next = (watcher-next watcher)
            do (funcall (watcher-wake watcher) watcher value trouble)))))

(defun enqueue-dependents (fluent backlog &optional (how t))
  (loop for link = (fluent-first-link fluent) then (link-next link)
        while link
        do (enqueue (link-dependent link) backlog how)))

(declaim (inline renew-derived-fluent))
(defun renew-derived-fluent (derived how kind)
  "Recompute DERIVED if HOW is T, because one of its sources has changed. Do not recompute DERIVED
if HOW is :PULSED. Notify the watchers of DERIVED of the change that spreads. The KIND of this
change is :PULSE, :BACK after a pulse, or otherwise :CHANGE. Return how the dependents of DERIVED
must be renewed; NIL if they need not be. A pulse of a source does not pulse a view."
  (let* ((true-p (fluent-now derived))
         (changed (and (eq t how) (recompute derived))))
    (cond (changed
           (unless (and (eq :back kind) true-p (null (derived-trouble derived)))
             (notify-watchers derived))
           t)
          ((and (eq :pulse kind) (not (view-p derived)))
           (notify-watchers derived)
           :pulsed))))

(defun propagate-by-height (backlog &optional (kind :change))
  "Renew the fluents in BACKLOG and those that depend on them, lowest height first."
  (loop for height from 1
        while (<= height (backlog-highest backlog))
        do (loop
             (multiple-value-bind (derived how) (dequeue height backlog)
               (unless derived (return))
               (let ((next (and (plusp (derived-users derived))
                                (renew-derived-fluent derived how kind))))
                 (when next (enqueue-dependents derived backlog next))))))
  (setf (backlog-highest backlog) 0))

;;; Views, see operators.lisp, are true for the instant of a change.

(defun reset-true-views (instants)
  "The only element of INSTANTS is a list of views. Make these views false again."
  (let ((backlog (backlog-now)))
    (dolist (view (nreverse (shiftf (first instants) '())))
      (setf (fluent-now view) nil)
      (enqueue-dependents view backlog))
    (propagate-by-height backlog)))

(defmacro with-propagation (&body body)
  `(let* ((instants (list nil))
          (*propagating* instants))
     (declare (dynamic-extent instants))
     ,@body
     (when (first instants) (reset-true-views instants))))

(defun propagate-to-dependents (fluent kind)
  "Renew the fluents that depend on FLUENT, without a backlog as long as they form a chain."
  (declare #.*hot*)
  (with-propagation
    (let ((how t))
      (loop
        (let ((link (fluent-first-link fluent)))
          (cond ((null link) (return))
                ((link-next link)
                 (let ((backlog (backlog-now)))
                   (enqueue-dependents fluent backlog how)
                   (return (propagate-by-height backlog kind))))
                (t (setf fluent (link-dependent link)
                         how (renew-derived-fluent fluent how kind))
                   (unless how (return)))))))))

(defun propagate (fluent kind)
  "Notify watchers and dependents of the base fluent FLUENT of the change or pulse KIND."
  (notify-watchers fluent)
  (when (fluent-first-link fluent)
    (propagate-to-dependents fluent kind)))

(defun propagate-all (fluents kind)
  "Do as PROPAGATE does, for all base fluents in FLUENTS at one instant."
  (if (and fluents (null (rest fluents)))
      (propagate (first fluents) kind)
      (let ((backlog (backlog-now)))
        (with-propagation
          (mapc #'notify-watchers fluents)
          (dolist (fluent fluents) (enqueue-dependents fluent backlog))
          (propagate-by-height backlog kind)))))

(defun check-settable (operator fluent)
  (unless (and (fluent-p fluent) (not (derived-p fluent)))
    (error 'wrong-argument :operator operator :name 'fluent :value fluent
                           :expected (format nil "a fluent made by create-fluent or state~:[~; ~
                                                  (leave out the quote before ~(~A~))~]"
                                             (names-fluent-p fluent) fluent)))
  (when *propagating*
    (reject-use "The function of a network set ~A. Networks must not set fluents: set it in a plan."
                fluent)))

;; A fluent is allowed as the value of another.
(defun check-no-circle (operator fluent value)
  "Signal WRONG-ARGUMENT if OPERATOR would set FLUENT to itself or to a network of FLUENT."
  (when (eq value fluent)
    (reject-argument operator 'value value
                     (format nil "a value, not the fluent itself; ~
                                  (fluent-value ...) of ~A is its current value"
                             (fluent-text fluent))))
  (when (and (derived-p value) (depends-p value (entity-here fluent)))
    (reject-argument operator 'value value
                     (format nil "a value, not a network of ~A itself. In the network write ~
                                  (fluent-value ...) around that fluent, for its current value"
                             (fluent-text fluent)))))

;;; A change for another runner is posted to that runner, or made at once while no thread has it.

(defun foreign-home (fluent)
  "Return the home in which FLUENT must be changed, unless this thread owns that home; or NIL."
  (let ((home (home-of fluent)))
    (cond ((null home) (and (null *runner*) (default-home *default-interface*)))
          ((eq home *runner*) nil)
          (t home))))

(defun set-now (fluent value)
  (unless (eql value (fluent-now fluent))
    (before-change fluent)
    (setf (fluent-now fluent) value)
    (incf (fluent-sets fluent))
    (trace-change :set fluent value)
    (propagate fluent :change)))

(defun set-in-home (home fluent value)
  "Set FLUENT of HOME to VALUE: now if no thread owns or serves HOME, otherwise by a post."
  (if (and (not (posted-p home))
           (not (funcall (home-attended-p home)))
           (call-owning-home home #'acquire-home (lambda () (set-now fluent value) t)))
      (funcall (home-on-post home))
      (post-entry home `((:set ,fluent ,value)))))

(public set-value)
(defun set-value (fluent value)
  "Set FLUENT to VALUE and return VALUE. If the value changed (by EQL), wake the tasks that wait for
FLUENT or a network of FLUENT that is now true. FLUENT must not be a network, and VALUE must not be
FLUENT or a network of FLUENT. Any thread may call SET-VALUE; from outside of plans SET-VALUE takes
effect when the running plans pause (manual D.2)."
  (check-settable 'set-value fluent)
  (check-no-circle 'set-value fluent value)
  (unless *runner* (note-outside-change *default-interface* #'set-value fluent value))
  (let* ((fluent (entity-here fluent)) (home (foreign-home fluent)))
    (if home
        (set-in-home home fluent value)
        (set-now fluent value))
    ;; Another thread may have just begun to wait for it.
    (unless (or home *runner*)
      (let ((home (foreign-home fluent)))
        (when home (set-in-home home fluent value)))))
  value)

(defun (setf fluent-value) (value fluent)
  (set-value fluent value))

;;; A pulse is one instant at which fluents have other values, between their former values.

(defun pulse-all (fluents values)
  (let ((before (mapcar #'fluent-now fluents)))
    (loop for fluent in fluents
          for value in values
          do (setf (fluent-now fluent) value)
             (trace-change :pulse fluent value))
    (propagate-all fluents :pulse)
    (loop for fluent in fluents
          for value in before
          do (setf (fluent-now fluent) value))
    (propagate-pulse-end fluents)))

(defun propagate-pulse-end (fluents)
  "FLUENTS have their old values again after a pulse. Recompute the fluents that depend on them."
  (when (some #'fluent-first-link fluents)
    (let ((backlog (backlog-now)))
      (with-propagation
        (dolist (fluent fluents) (enqueue-dependents fluent backlog))
        (propagate-by-height backlog :back)))))

(public pulse)
(defun pulse (fluent &optional (value t))
  "Set FLUENT to VALUE for an instant, and then back. PULSE wakes all tasks that wait for FLUENT, or
for a network that is true at that instant. Return VALUE. Any thread may call PULSE; from outside of
plans PULSE takes effect when the running plans pause (manual C)."
  (check-settable 'pulse fluent)
  (check-no-circle 'pulse fluent value)
  (unless *runner* (note-outside-change *default-interface* #'pulse fluent value))
  (let* ((fluent (entity-here fluent)) (home (foreign-home fluent)))
    (cond (home (post-entry home `((:pulse ,fluent ,value))))
          (t (before-change fluent)
             (incf (fluent-pulses fluent))
             (pulse-all (list fluent) (list value)))))
  value)

(defun apply-settings (settings)
  "Apply SETTINGS at one instant: first all (:set fluent value), then all (:pulse fluent [value])
together. So a task that a pulse wakes sees the values set at the same instant (reading 177)."
  (let ((changed '()) (pulsed '()) (values '()))
    (loop for (kind given . more) in settings
          for fluent = (progn (check-settable kind given) (entity-here given))
          do (before-change fluent)
             (ecase kind
               (:set (unless (eql (first more) (fluent-now fluent))
                       (setf (fluent-now fluent) (first more))
                       (incf (fluent-sets fluent))
                       (trace-change :set fluent (first more))
                       (pushnew fluent changed)))
               (:pulse (incf (fluent-pulses fluent))
                (push fluent pulsed)
                (push (if more (first more) t) values))))
    (when changed (propagate-all (nreverse changed) :change))
    (when pulsed (pulse-all (nreverse pulsed) (nreverse values)))))

;;; A run that was rewound continues in a fork. When that is over, its values are copied back.

(defun copy-back-value (fluent from)
  (let ((value (fluent-now (entity-in fluent from))) (home (home-of fluent)))
    (cond ((eql value (fluent-now fluent)))
          (home (set-in-home home fluent value))
          (t (set-now fluent value)))))

(defun copy-back-values (from realm)
  "Set the base fluents of REALM to the values of their twins in FROM, an ended fork of REALM."
  (let ((*realm* realm))
    (loop for each = from then (realm-parent each)
          until (or (null each) (eq each realm))
          do (dolist (twin (twins-in each))
               (let ((first (weak-value (entity-first twin))))
                 (when (and (fluent-p first)
                            (eq realm (entity-realm first))
                            (not (derived-p first)))
                   (copy-back-value first from)))))))
