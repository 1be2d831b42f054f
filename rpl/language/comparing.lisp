;;;; comparing.lisp -- tests that are never true, or always: of task states, error codes, fluents.

(in-package :ars-magna.rpl.language)

(defparameter *task-states*
  '(:created :running :blocked :suspended :succeeded :failed :evaporated)
  "The values of TASK-STATUS.")

(defun compared-fluent (form)
  "Return the form for the fluent whose value FORM is: what FLUENT-VALUE or VREF is given, or FORM."
  (if (and (operator-in-p form '("FLUENT-VALUE" "VREF")) (consp (rest form)))
      (compared-fluent (second form))
      form))

(defun status-doubt (word)
  "Return in a sentence why no task is ever in the state WORD, or NIL if one may be."
  (unless (member word *task-states*)
    (let ((like (nearest-name word *task-states*)))
      (format nil "the status of a task is never ~(~S~). ~:[It is one of ~{~(~S~)~^, ~}.~;~
                   ~:*Did you mean ~(~S~)?~]"
              word like *task-states*))))

(defun error-fluent-p (form)
  "True if FORM is the variable of a fluent of ours whose value is an error code."
  (and form
       (symbolp form)
       (our-symbol-p form)
       (search "-ERROR*" (symbol-name form))))

(defun comparison-doubt (subject word)
  "Return in a sentence why the value of SUBJECT, a form, is never WORD, a keyword; or NIL."
  (let ((fluent (compared-fluent subject)))
    (cond ((operator-in-p fluent '("TASK-STATUS")) (status-doubt word))
          ((error-fluent-p fluent) (code-doubt word)))))

(defun doubt-comparisons (form)
  "Warn of what FORM, the text of a plan, compares with a keyword that it never is."
  (map-comparisons (lambda (subject word comparison)
                     (let ((doubt (comparison-doubt subject word)))
                       (when doubt (doubt-own-form comparison "~A" doubt))))
                   form))

;;; In ordinary Lisp code, what is no plan, a fluent is an object like any other.

(defun read-fluent (form)
  "Return the variable of the fluent whose value FORM reads, or NIL."
  (when (and (consp form) (consp (cdr form)) (eq 'fluent-value (first form)))
    (let ((fluent (second form)))
      (if (and (consp fluent) (consp (cdr fluent))) (second fluent) fluent))))

(defun test-doubt (form)
  "Return in a sentence why FORM, a test in Lisp code, is always true, or never; or NIL."
  (cond ((and (typep form '(cons symbol (cons t null)))
              (member (first form) '("NOT" "NULL") :test #'string=))
         (test-doubt (second form)))
        ((and (symbolp form) (known-fluent-variable-p form))
         (format nil "~(~A~) is a fluent, which is true in Lisp whatever its value is. Write ~
                      (fluent-value ~:*~(~A~))." form))
        ((known-pulse-p (read-fluent form))
         (format nil "~(~S~) is never true: the fluent is pulsed, which takes no time. Plans write ~
                      (wait-for ~(~A~)); in Lisp, (await-idle), or (run-until (idle-p)) headless."
                 form (read-fluent form)))))

(setf *test-doubt* (lambda (form)
                     ;; Plans read fluents by value.
                     (and (null *own-conses*) (test-doubt form))))
