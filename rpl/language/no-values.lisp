;;;; no-values.lisp -- values that a plan uses and never gets: of pulses, and of its commands.

(in-package :ars-magna.rpl.language)

;;; Tests.

(defun tests-in-loop (form)
  "Return the tests after UNTIL and WHILE in FORM, a LOOP or N-TIMES."
  (loop for (word test) on (rest form)
        when (and (symbolp word) (member word '("UNTIL" "WHILE") :test #'string=))
          collect test))

(defun tests-in (form)
  "Return the tests that FORM, a call in a plan's text, makes of values."
  (if (and (operator-in-p form '("LOOP" "N-TIMES")) (proper-list-p form))
      (tests-in-loop form)
      (tested-in form)))

;;; Pulses take no time: between two waits nobody finds them true.

(defun pulse-form-p (form)
  "True if FORM is the variable of a fluent that is only pulsed, or one of a vector of such."
  (or (known-pulse-p form)
      (and (operator-in-p form '("VREF")) (consp (rest form)) (known-pulse-p (second form)))))

(defun pulse-in-test (test)
  "Return the form of a fluent that is only pulsed if TEST reads one by value; or NIL."
  (cond ((pulse-form-p test) test)
        ((not (proper-list-p test)) nil)
        ((operator-in-p test '("FLUENT-VALUE" "NOT" "NULL" "AND" "OR"))
         (some #'pulse-in-test (rest test)))))

(defun pulse-read (form)
  "Return the form of the pulsed fluent that a test in FORM, a call of a plan's, reads; or NIL."
  (if (and (operator-in-p form '("WAIT-UNTIL")) (proper-list-p form))
      ;; It waits for what gives a fluent.
      (and (operator-in-p (second form) '("FLUENT-VALUE")) (pulse-in-test (second form)))
      (some #'pulse-in-test (tests-in form))))

(defun doubt-pulse-read (form)
  "Warn if FORM, a call in a plan's text, tests the value of a fluent that is only pulsed."
  (let ((pulse (pulse-read form)))
    (when pulse
      (doubt-own-form form "the test of ~A is never true: a pulse takes no time. (wait-for ~:*~A) ~
                            waits for the next one. A view that is made first, (fl-pulsed ~:*~A), ~
                            is true if there was one since." pulse))))

;; Each pulse has ended before the next begins.
(defun joined-pulses (form)
  "Return the pulses that FORM, a call, joins by AND, if it is one of several; or NIL."
  (and (operator-in-p form '("AND"))
       (proper-list-p form)
       (let ((pulses (remove-duplicates (remove-if-not #'pulse-form-p (rest form)) :test #'equal)))
         (and (rest pulses) pulses))))

(defun doubt-joined-pulses (form)
  "Warn if FORM, a call in a plan's text, waits for several pulses at one time."
  (let* ((join (and (operator-in-p form '("WAIT-FOR" "WAIT-UNTIL" "WHENEVER"))
                    (proper-list-p form)
                    (find-call #'joined-pulses (list (second form)))))
         (pulses (joined-pulses join)))
    (when pulses
      (doubt-own-form form "~A is never true: a pulse takes no time, and no two come at once. To ~
                            wait for all of them write (par~{ (wait-for ~A)~})."
                      join pulses))))

;;; Commands return nothing.

(defun values-used-in-plan (form)
  "Return the forms whose values FORM, a call in a plan's text, uses."
  (let ((name (first form)))
    (cond ((not (and (symbolp name) (proper-list-p form))) '())
          ((operator-in-p form '("WAIT-FOR" "WHENEVER" "WAIT-UNTIL")) (list (second form)))
          ((operator-in-p form '("OUT")) (rest form))
          ((and (fboundp name) (not (macro-function name)) (not (special-operator-p name)))
           (rest form))
          (t (append (values-used-in form)
                     (and (operator-in-p form '("LOOP" "N-TIMES")) (tests-in-loop form)))))))

(defun command-used (form)
  "Return the call of a command whose value FORM, a call in a plan's text, uses; or NIL."
  (find-if (lambda (used)
             (and (consp used) (proper-list-p used) (plan-function-p (first used))))
           (values-used-in-plan form)))

(defun doubt-command-used (form)
  "Warn if FORM, a call in a plan's text, uses the value of one of the robot's commands."
  (let ((command (command-used form)))
    (when command
      (destructuring-bind (name &optional part &rest arguments) command
        (declare (ignore arguments))
        (doubt-own-form form "~A returns nothing: its command only begins. Write it ~
                              alone~@[, then ~A~]~@[; what it has found is then in ~{~A~^, ~}~]."
                        name (end-text name part) (results-of-command name part))))))

(defun doubt-values (form)
  "Warn of values that FORM, the text of a plan, uses and never gets."
  (map-calls (lambda (call)
               (doubt-pulse-read call)
               (doubt-joined-pulses call)
               (doubt-command-used call))
             form))
