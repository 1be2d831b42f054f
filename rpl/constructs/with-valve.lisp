;;;; with-valve.lisp -- with-valve and with-valves: running while owning a resource (manual D).

(in-package :ars-magna.rpl.constructs)

(defun valve-for (object)
  "Return this run's valve for OBJECT, a valve or a fluent with a valve. Signals WRONG-ARGUMENT."
  (let ((valve (fluent-value object)))
    (unless (valve-p valve)
      (reject-argument 'with-valve 'valve valve
                       (format nil "a valve, made by make-valve~@[: ~(~A~) without a quote, if ~
                                    it is a variable whose value is a valve~]"
                               (and (symbolp valve) (not (keywordp valve)) (not (eq t valve))
                                    valve))))
    (entity-here valve)))

(defun checked-claim (priority valves task)
  (let ((priority (or (fluent-value priority) 0))
        (valves (remove-duplicates (mapcar #'valve-for valves))))
    (check-argument with-valve priority (bounded-number-p priority) "a number from -1e15 to 1e15")
    (make-claim task valves priority)))

(defun claim-or-queue (claim task)
  "Let TASK make CLAIM. Return true if TASK gets the valves at once; otherwise TASK queues."
  (cond ((grantable-p claim) (grant-claim claim) t)
        (t (queue-up claim)
           (park task claim)
           (report-wait-cycle task)
           nil)))

(defun claim-lambda (priority valves scope)
  "Return a lambda expression that returns a cons: the value of PRIORITY, and a list of the valves."
  (dolist (valve valves)
    (when (and (name-without-quote-p valve scope) (fboundp valve))
      (warn-of-style "~A: ~(~A~) is a function, not a variable. Call it: (with-valve ~
                      ((~:*~(~A~))) ...)"
                        (text-title) valve)))
  (value-lambda `(cons ,priority (list ,@valves)) scope))

(define-construct with-valve ((valve &key priority) &body body)
  "Run BODY in a plan while the task owns VALVE. If another task owns VALVE, wait first. VALVE is
released however BODY ends. Return all values of BODY.
  Waiting tasks queue by PRIORITY, a number, by default 0. Among equals, policies come first.
  A task with a higher PRIORITY than the owner's takes VALVE. The owner is suspended, with its
parts, until it gets VALVE back. So two tasks that own one resource never run together.
ON-SUSPENSION and RETRY-AFTER-SUSPENSION define how the owner reacts. Cleanups of an evaporating
owner are not disturbed.
  A part of the owner can own VALVE as well, one part at a time.
If tasks wait for each other's valves, an error says so (manual D; priorities are an addition)."
  (:arguments valve priority)
  (:parts (request function (claim-lambda priority (list valve) scope))
          (body node (body-code body scope)))
  (:steps
   (begin
    (next granted)
    (destructuring-bind (priority . valves) (funcall request environment)
      (setf memory (checked-claim priority valves task)))
    (if (claim-or-queue memory task) (values frame nil) +parked+))
   (granted
    (next inside)
    (enter body environment frame))
   (inside
    (release-valves (shiftf memory nil))
    (values (frame-up frame) value)))
  (:unwind
   (when memory (release-valves (shiftf memory nil)))
   nil))

(defun valves-and-priority (valves)
  "Return the list of the elements of VALVES before :priority, and the form after :priority."
  (let ((rest (member-if #'keywordp valves)))
    (unless (typep rest '(or null (cons (eql :priority) (cons t null))))
      (reject-clause (text-title) valves "(valve... [:priority number])"))
    (values (ldiff valves rest) (second rest))))

(define-construct with-valves ((&rest valves) &body body)
  "Run BODY in a plan while the task owns all of VALVES. After the valves, :priority and a number
may follow. The task takes all the valves together, when no other task owns any of them. So the
order in which tasks name the valves does not matter. Otherwise do as WITH-VALVE."
  (:like with-valve)
  (:arguments &rest valves)
  (:parts (request function (multiple-value-bind (valves priority) (valves-and-priority valves)
                              (claim-lambda priority valves scope)))
          (body node (body-code body scope))))
