;;;; mistakes.lisp -- plan text that is valid Lisp but most likely a mistake.

(in-package :ars-magna.rpl.language)

;;; Each mistake is a rule: a function of a call that returns what is wrong with it, or NIL. A rule
;;; for :TEXT is asked about each call in the text of a plan, one for :LEAF about those in the forms
;;; that Lisp runs, but not in what these only call later.

(defvar *mistakes* '()
  "A property list from :TEXT and :LEAF to lists of rule names: see DEFINE-MISTAKE.")

(defmacro define-mistake (name where (form) documentation &body body)
  "Define the rule NAME, a function that returns sentences about a mistake in FORM, a call; or NIL.
WHERE is :TEXT for calls in plan text, or :LEAF for calls in forms that Lisp runs."
  `(progn
     (defun ,name (,form) ,documentation ,@body)
     (pushnew ',name (getf *mistakes* ,where))))

(defun warn-of-text-mistakes (form)
  (map-calls (lambda (call)
               (dolist (rule (getf *mistakes* :text))
                 (let ((text (call-rule rule call)))
                   (when text (style-warn-of-plan-text call "~A" text)))))
             form))

(defun warn-of-leaf-mistakes (form)
  "Warn of the first mistake of each kind in FORM, a form that Lisp runs."
  (when *definition*
    (dolist (rule (getf *mistakes* :leaf))
      (let ((call (find-call rule (list form))))
        (when call (style-warn-of-form call "~A" (call-rule rule call)))))))

(defun call-rule (rule form)
  (let ((*print-case* :downcase) (*print-pretty* nil))
    (funcall rule form)))

;;; Comparisons that are never true: of task states and error codes.

(defparameter *task-states*
  '(:created :running :blocked :suspended :succeeded :failed :evaporated)
  "The values that a fluent of TASK-STATUS can have.")

(defun compared-fluent (form)
  (if (and (operator-in-p form '("FLUENT-VALUE" "VREF")) (consp (rest form)))
      (compared-fluent (second form))
      form))

(defun status-advice (word)
  "Return a sentence about why no task ever has the state WORD, or NIL if a task may have it."
  (unless (member word *task-states*)
    (let ((like (nearest-name word *task-states*)))
      (format nil "the status of a task is never ~(~S~). ~:[It is one of ~{~(~S~)~^, ~}.~;~
                   ~:*Did you mean ~(~S~)?~]"
              word like *task-states*))))

(defun error-fluent-p (form)
  "True if FORM is the variable of one of the simulator's fluents whose values are error codes."
  (and form
       (symbolp form)
       (system-symbol-p form)
       (search "-ERROR*" (symbol-name form))))

(define-mistake impossible-comparison :text (form)
  "FORM compares the value of a fluent with words that the fluent never has as its value."
  (multiple-value-bind (words subject) (compared-words form)
    (let* ((fluent (compared-fluent subject))
           (doubts (remove nil (cond ((operator-in-p fluent '("TASK-STATUS"))
                                      (mapcar #'status-advice words))
                                     ((error-fluent-p fluent)
                                      (mapcar #'wrong-error-code-text words))))))
      (and doubts (format nil "~{~A~^ ~}" doubts)))))

;;; Pulses take no time: no test between two waits finds them true.

(defun tests-in-loop (form)
  "Return a list of the tests after UNTIL and WHILE in FORM, if FORM is a call of LOOP or N-TIMES."
  (when (and (operator-in-p form '("LOOP" "N-TIMES")) (proper-list-p form))
    (loop for (word test) on (rest form)
          when (and (symbolp word) (member word '("UNTIL" "WHILE") :test #'string=))
            collect test)))

(defun pulse-form-p (form)
  "True if FORM is the variable of a pulse-only fluent, or an element of a vector of such fluents."
  (or (known-pulse-p form)
      (and (operator-in-p form '("VREF")) (consp (rest form)) (known-pulse-p (second form)))))

(defun pulse-in-test (test)
  "Return the form of the pulse-only fluent whose value TEST tests; or NIL."
  (cond ((pulse-form-p test) test)
        ((not (proper-list-p test)) nil)
        ((operator-in-p test '("FLUENT-VALUE" "NOT" "NULL" "AND" "OR"))
         (some #'pulse-in-test (rest test)))))

(define-mistake pulse-tested :text (form)
  "FORM tests the value of a fluent that is only pulsed."
  (let ((pulse (if (and (operator-in-p form '("WAIT-UNTIL")) (proper-list-p form))
                   ;; A form whose value is a fluent is waited for.
                   (and (operator-in-p (second form) '("FLUENT-VALUE"))
                        (pulse-in-test (second form)))
                   (some #'pulse-in-test (append (tests-in-loop form) (test-forms form))))))
    (and pulse
         (format nil "the test of ~A is never true: a pulse takes no time. (wait-for ~:*~A) ~
                      waits for the next pulse. A view made before the command, ~
                      (fl-pulsed ~:*~A), is true if a pulse has come since then." pulse))))

;; Each pulse has ended before the next begins.
(defun pulses-in-and (form)
  "Return a list of the pulses in FORM, if FORM is a call of AND with several pulses; or NIL."
  (and (operator-in-p form '("AND"))
       (proper-list-p form)
       (let ((pulses (remove-duplicates (remove-if-not #'pulse-form-p (rest form)) :test #'equal)))
         (and (rest pulses) pulses))))

(define-mistake pulses-joined :text (form)
  "FORM waits for several pulses at the same instant."
  (let ((join (and (operator-in-p form '("WAIT-FOR" "WAIT-UNTIL" "WHENEVER"))
                   (proper-list-p form)
                   (find-call #'pulses-in-and (list (second form))))))
    (and join
         (format nil "~A is never true: a pulse takes no time, and no two pulses come at the same ~
                      instant. To wait for all of them, write (par~{ (wait-for ~A)~})."
                 join (pulses-in-and join)))))

;;; Commands return nothing, and commands that are not those of plans set no fluent at their end.

(defun forms-used-for-value (form)
  "Return a list of the forms in FORM, a call in a plan's text, whose values FORM uses."
  (let ((name (first form)))
    (cond ((not (and (symbolp name) (proper-list-p form))) '())
          ((operator-in-p form '("WAIT-FOR" "WHENEVER" "WAIT-UNTIL")) (list (second form)))
          ((operator-in-p form '("OUT")) (rest form))
          ((and (fboundp name) (not (macro-function name)) (not (special-operator-p name)))
           (rest form))
          (t (append (value-forms-in form) (tests-in-loop form))))))

(define-mistake command-used :text (form)
  "FORM uses the value of a command of the robot."
  (destructuring-bind (&optional name part &rest arguments)
      (find-if (lambda (used)
                 (and (consp used) (proper-list-p used) (plan-function-p (first used))))
               (forms-used-for-value form))
    (declare (ignore arguments))
    (and name
         (format nil "~A returns nothing, because the command only begins. Write the call ~
                      alone~@[, then ~A~]~@[; the results are then in ~{~A~^, ~}~]."
                 name (wait-for-end-text name part) (result-fluent-forms name part)))))

(define-mistake command-of-others :leaf (form)
  "FORM is a command for which plans have another function. Code called later does not count."
  (cond ((and (symbolp (first form)) (same-name-p (first form) 'continuation)) :nowhere)
        ((has-plan-function-p (first form))
         (format nil "~(~A~) does not notify plans of its end. In a plan write ~A."
                 (first form) (plan-call-text (first form))))))

;;; Handlers of Lisp's. A failure is no error.

(defun errors-only-p (clauses)
  (every (lambda (clause)
           (and (consp clause)
                (or (eq :no-error (first clause))
                    (nth-value 0 (ignore-errors (subtypep (first clause) 'error))))))
         clauses))

(defun forms-with-errors-handled (form)
  "Return a list of the forms inside FORM, a Lisp form, that handle errors but not failures."
  (cond ((operator-in-p form '("IGNORE-ERRORS")) (rest form))
        ((operator-in-p form '("HANDLER-CASE"))
         (and (cddr form) (errors-only-p (cddr form)) (list (second form))))
        ((operator-in-p form '("HANDLER-BIND"))
         (and (consp (second form)) (errors-only-p (second form)) (cddr form)))))

(define-mistake useless-error-handler :leaf (form)
  "FORM is a Lisp error handler around a FAIL."
  (and (find-call #'fail-p (forms-with-errors-handled form))
       (format nil "~(~A~) does not handle failures of plans, which FAIL makes. Write ~
                    (handle-failure ((class (e) ...)) body...)." (first form))))

;;; Operators that let time pass, but not for plans.

(defparameter *program-wait-advice*
  '(("SLEEP" . "sleep stops all plans for seconds of real time, in which perhaps no tick passes.")
    ("RUN-TICKS" . "run-ticks is for programs: it cannot be called inside of a tick or plan.")
    ("STEP-TICKS" . "step-ticks is for programs: it cannot be called inside of a tick or plan.")
    ("AWAIT-IDLE" . "await-idle is for programs: a plan would wait for itself.")
    ("RUN-UNTIL" . "run-until is for programs: it cannot be called inside of a tick or plan."))
  "Conses (operator . text). TEXT says why the operator must not be used for waits in plans.")

(define-mistake program-wait :leaf (form)
  "FORM lets time pass in programs, but not in plans."
  (when (operator-in-p form (mapcar #'car *program-wait-advice*))
    (destructuring-bind (name &optional (time 'ticks) &rest options) form
      (declare (ignore options))
      (format nil "~A In a plan write ~A."
              (cdr (assoc (symbol-name name) *program-wait-advice* :test #'string=))
              (cond ((string= "RUN-UNTIL" name) "(wait-until condition)")
                    ((string= "AWAIT-IDLE" name) "(wait-for fluent), such as robot-stopped*")
                    ((string= "SLEEP" name) (format nil "(wait-time ~S :unit :seconds)" time))
                    (t (format nil "(wait-time ~S), for that many ticks" time)))))))

;;; In Lisp code outside of plans a fluent is an object like any other.

(defun fluent-read-in-form (form)
  "Return the variable of the fluent whose value FORM reads, or NIL."
  (when (and (consp form) (consp (cdr form)) (eq 'fluent-value (first form)))
    (let ((fluent (second form)))
      (if (and (consp fluent) (consp (cdr fluent))) (second fluent) fluent))))

(defmethod doubtful-test-text ((form symbol))
  ;; Plans read fluents by value.
  (when (and (null *conses-of-plan-text*) (known-fluent-variable-p form))
    (format nil "~(~A~) is a fluent, which is true in Lisp whatever its value is. Write ~
                 (fluent-value ~:*~(~A~))." form)))

(defmethod doubtful-test-text ((form cons))
  (cond (*conses-of-plan-text* nil)
        ((and (typep form '(cons symbol (cons t null)))
              (member (first form) '("NOT" "NULL") :test #'string=))
         (doubtful-test-text (second form)))
        ((known-pulse-p (fluent-read-in-form form))
         (format nil "~(~S~) is never true: the fluent is pulsed, which takes no time. In plans ~
                      write (wait-for ~(~A~)); in Lisp write (await-idle), or (run-until (idle-p)) ~
                      in a headless run."
                 form (fluent-read-in-form form)))))
