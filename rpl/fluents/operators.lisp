;;;; operators.lisp -- networks in plans: views of events, Lisp's operators on fluents.

(in-package :ars-magna.rpl.fluents)

(export '(function-designator-p counts-each-event-p call-lifted))

;;; A view is a network with a memory. Reading it, by FLUENT-VALUE or by being woken by it, resets
;;; it; so each reader needs its own view. While a task waits for it, it is true for the
;;; instant of an event; its value then is a number that it never had before, so that each event is
;;; a change. Nothing is missed while no task waits: fluents count how often they were set and
;;; pulsed, so that a view costs nothing until it is read.

(defun count-settings (fluents)
  (loop for fluent in fluents sum (fluent-sets fluent)))

(defun count-events (fluents)
  (loop for fluent in fluents sum (+ (fluent-sets fluent) (fluent-pulses fluent))))

(defun event-since-reading (view)
  "Return a number if the fluents of VIEW were set or pulsed since VIEW was last read; or NIL."
  (let ((seen (view-memory view)) (events (count-events (view-bases view))))
    (when (< seen events)
      (before-change view)
      (setf (view-memory view) (if (view-always-p view) (1+ seen) events)))))

(defun change-since-reading (view value)
  "Return a number if VALUE, the value of VIEW's fluent, changed since VIEW was last read; or NIL."
  (destructuring-bind (sets . last) (view-memory view)
    (let ((now (count-settings (view-bases view))))
      (unless (= sets now)
        (let ((value (funcall (view-key view) value)))
          (unless (funcall (view-test view) last value)
            (before-change view)
            (setf (view-memory view) (cons now value))
            now))))))

(defun consume-event (view value)
  "Return the value of VIEW, and reset VIEW. VALUE is the value of the first fluent of VIEW."
  (let ((answer (if (view-test view) (change-since-reading view value) (event-since-reading view))))
    ;; It is no longer true when the change under way, if any, is spread.
    (when (and answer *propagating*) (push view (first *propagating*)))
    answer))

(defun make-view (name sources bases memory &key always-p test key)
  (let ((view nil))
    (dolist (base bases) (setf (fluent-reading base) :always))
    (setf view (%make-view name (lambda (&rest values) (consume-event view (first values)))
                           sources (height-over sources) bases memory always-p test key))))

;; The twin starts with the memory of VIEW, and reads the fork's fluents.
(defmethod fresh-twin ((view view) realm)
  (flet ((twins (fluents) (mapcar (lambda (fluent) (entity-in fluent realm)) fluents)))
    (make-view (fluent-name view) (twins (derived-sources view)) (twins (view-bases view))
               (view-memory view)
               :always-p (view-always-p view) :test (view-test view) :key (view-key view))))

(addition fl-pulsed)
(defun fl-pulsed (fluent &key (handle-missed-pulses :once))
  "Return a view: a fluent that is true if FLUENT was set to another value or pulsed since the view
was last read. The view is reset when it is read or wakes a task. HANDLE-MISSED-PULSES says how to
count events that happen while no task waits:
  :ONCE: the next reading is true if there were any events, even before this call;
  :ALWAYS: as many readings are true as there were events;
  :NEVER: as :ONCE, but events before this call are ignored.
A network is pulsed when one of its sources is pulsed, whatever the value of the network. Signals
WRONG-ARGUMENT. (From CRAM, except for pulses of networks.)"
  (check-argument fl-pulsed fluent (fluent-p fluent) "a fluent")
  (check-argument fl-pulsed handle-missed-pulses
                  (member handle-missed-pulses '(:once :never :always)) ":once, :never or :always")
  (let* ((bases (base-fluents (entity-here fluent)))
         (seen (if (eq handle-missed-pulses :never) (count-events bases) 0)))
    (make-view 'fl-pulsed bases bases seen :always-p (eq handle-missed-pulses :always))))

(defun counts-each-event-p (fluent)
  "True if FLUENT is a view that counts each event: see :ALWAYS in FL-PULSED."
  (and (view-p fluent) (view-always-p fluent)))

(defun function-designator-p (object)
  "True if OBJECT is a function or the name of a defined function."
  (or (functionp object)
      (and (symbolp object) (fboundp object) (functionp (symbol-function object))
           (not (macro-function object)) (not (special-operator-p object)))))

(addition fl-value-changed)
(defun fl-value-changed (fluent &key (test #'eql) (key #'identity))
  "Return a view: a fluent that is true if KEY of the value of FLUENT has changed since the view was
made or last read. TEST compares the old and the new value of KEY. The view is reset when it is read
or wakes a task. A pulse does not count as a change. Signals WRONG-ARGUMENT. (From CRAM.)"
  (check-argument fl-value-changed fluent (fluent-p fluent) "a fluent")
  (check-argument fl-value-changed test (function-designator-p test) "a function of two values")
  (check-argument fl-value-changed key (function-designator-p key) "a function of a value")
  (let* ((fluent (entity-here fluent))
         (bases (base-fluents fluent))
         (key (coerce key 'function)))
    (make-view 'fl-value-changed (list fluent) bases
               (cons (count-settings bases) (funcall key (fluent-value fluent)))
               :test (coerce test 'function) :key key)))

;;; LIFTING is what plans turn calls of these operators into. Where no argument is a fluent it is
;;; plain Lisp, and where the compiler can see that none is, nothing is left of it.

(defmacro call-lifted (operator &rest arguments &environment environment)
  "Call the function OPERATOR with ARGUMENTS; return a network if any is a fluent (reading 184)."
  (let* ((bindings (loop for argument in arguments
                         unless (constantp argument environment)
                           collect (list (gensym "ARGUMENT")
                                         (if (member operator '(not null))
                                             `(checked-condition ,argument)
                                             argument))))
         (values (loop with variables = (mapcar #'first bindings)
                       for argument in arguments
                       collect (if (constantp argument environment) argument (pop variables)))))
    `(let ,bindings
       (if (or ,@(loop for (variable) in bindings collect `(fluent-p ,variable)))
           (apply-lifted ',operator #',operator ,@values)
           (,operator ,@values)))))

(defun every-value (&rest values)
  "Return the last of VALUES, which must not be empty, if all VALUES are true; otherwise NIL."
  (and (every #'identity values) (first (last values))))

(defun some-value (&rest values)
  (find-if #'identity values))

(defun lift-junction (name function absorbing thunks)
  "Return AND (if ABSORBING is NIL) or OR (if ABSORBING is T) of the values of THUNKS. Do not call
further thunks when the result is certain. From the first fluent on, the result is a network."
  (loop for (thunk . more) on thunks
        for value = (checked-condition (funcall (the function thunk)))
        when (fluent-p value)
          return (apply #'apply-lifted name function value
                        (mapcar (lambda (thunk) (checked-condition (funcall (the function thunk))))
                               more))
        when (or (null more) (eq absorbing (and value t)))
          return value))

;;; The same under the names of the operators, for ordinary code. Each is also a function.

(defmacro define-lifted-functions (&rest operators)
  "Define functions in ARS-MAGNA.RPL.LIFTED with the names of OPERATORS, which are Lisp functions."
  `(progn
     ,@(loop for operator in operators
             for name = (find-symbol (symbol-name operator) :ars-magna.rpl.lifted)
             collect `(defun ,name (&rest arguments)
                        ,(format nil "Return ~A of ARGUMENTS; a network if one is a fluent."
                                 operator)
                        (apply #'apply-lifted ',operator #',operator arguments))
             collect `(define-compiler-macro ,name (&rest arguments)
                        (list* 'call-lifted ',operator arguments)))))

(define-lifted-functions not null < > <= >= = + - * / eq eql equal)

(defmacro lifted:and (&rest forms)
  "Like Lisp's AND. If a form's value is a fluent, return a network of it and the remaining forms."
  (cond ((null forms) t)
        ((null (rest forms)) (first forms))
        (t `(lift-junction 'and #'every-value nil
                           (list ,@(loop for form in forms collect `(lambda () ,form)))))))

(defmacro lifted:or (&rest forms)
  "Like Lisp's OR. If a form's value is a fluent, return a network of it and the remaining forms."
  (if (rest forms)
      `(lift-junction 'or #'some-value t
                      (list ,@(loop for form in forms collect `(lambda () ,form))))
      (first forms)))

(defmacro lifted:if (test then &optional else)
  "Like Lisp's IF, but TEST may be a fluent, whose value counts (manual D.2)."
  `(if (truth-value ,test) ,then ,else))

(defmacro lifted:when (test &body body)
  "Like Lisp's WHEN, but TEST may be a fluent, whose value counts."
  `(when (truth-value ,test) ,@body))

(defmacro lifted:unless (test &body body)
  "Like Lisp's UNLESS, but TEST may be a fluent, whose value counts."
  `(unless (truth-value ,test) ,@body))

(defmacro lifted:cond (&rest clauses)
  "Like Lisp's COND, but a test may be a fluent, whose value counts."
  `(cond ,@(loop for (test . body) in clauses
                 collect `((truth-value ,test) ,@body))))

(defmacro lifted:loop (&rest forms)
  "Like Lisp's LOOP, but the test in (loop UNTIL test ...) and (loop WHILE test ...) may be a
fluent, whose value counts (manual D.2)."
  (cond ((and (symbolp (first forms)) (string= (first forms) "UNTIL"))
         `(loop (when (truth-value ,(second forms)) (return)) ,@(cddr forms)))
        ((and (symbolp (first forms)) (string= (first forms) "WHILE"))
         `(loop (unless (truth-value ,(second forms)) (return)) ,@(cddr forms)))
        (t `(loop ,@forms))))
