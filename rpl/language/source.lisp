;;;; source.lisp -- reading a plan's text: names of operators, and which text is the plan's own.

(in-package :ars-magna.rpl.language)

(export '(text-title misplaced misplaced-advice misplaced-container misplaced-form
          misplaced-suspension operator-in-p note-plan-text note-expansion form-as-written
          plan-only-form))

;;; Inside a plan, IF, AND, < and so on have their plan meaning, whether they are symbols of Common
;;; Lisp, of Nisp or ours. Operators of Lisp or of this system's packages are known by name.
;;;
;;; That holds for the plan's own text only: an AND that DOTIMES or PUSH expands into stays Lisp's.
;;; So the conses of the text are recorded, and those of expansions of macros that are not Lisp's.

(defun text-title ()
  "Return the name, for messages, of the definition or plan that is being compiled."
  (if *definition*
      (let ((form (defining-form *definition*)))
        (definition-title (first form) (second form)))
      "plan"))

(define-condition misplaced-suspension (malformed-definition)
  ((form :initarg :form :reader misplaced-form)
   (container :initarg :container :reader misplaced-container)
   (advice :initarg :advice :reader misplaced-advice))
  (:report (lambda (condition stream)
             (let ((*print-case* :downcase))
               (format stream "A plan cannot wait inside ~A~@[ (~A)~]:~%  ~S~%~
                               because it contains~%  ~S~%~A"
                       (operator-text (misplaced-container condition))
                       (malformed-definition-place condition)
                       (misplaced-container condition) (misplaced-form condition)
                       (misplaced-advice condition)))))
  (:documentation "A plan waits, fails or runs another plan inside a form that only Lisp runs."))

(setf (documentation 'misplaced-form 'function) "Return the form that would make the task wait."
      (documentation 'misplaced-container 'function) "Return the form in which plans cannot wait."
      (documentation 'misplaced-advice 'function) "Return a sentence about what to write instead.")

(defun operator-text (form)
  (format nil "~(~A~)" (if (consp form) (first form) form)))

(defparameter *suspension-advice*
  '((("UNWIND-PROTECT") . "Write (evap-protect form cleanup): the cleanup may wait.")
    (("HANDLER-CASE" "HANDLER-BIND" "IGNORE-ERRORS" "RESTART-CASE" "WITH-SIMPLE-RESTART")
     . "Write (handle-failure ((type (e) ...)) body...): it also handles Lisp errors.")
    (("CATCH" "THROW") . "Write block and return-from, which work across tasks.")
    (("LOOP" "ITER" "ITERATE")
     . "Write (loop UNTIL test ...), dolist, dotimes, n-times or par-loop.")
    (("LAMBDA" "FUNCTION" "NAMED-LAMBDA" "CONTINUATION")
     . "Write dolist or par-loop for mapcar, flet or labels for a local plan.")
    (("LET" "LET*" "PROGV" "MULTIPLE-VALUE-BIND")
     . "Special variables hold for the whole thread: bind a lexical variable or a fluent.")
    (("MULTIPLE-VALUE-CALL" "MULTIPLE-VALUE-PROG1") . "Write multiple-value-bind.")
    (("WITHOUT-SCHEDULING")
     . "Its body is one step. Write evap-protect for forms that must run although they take time.")
    (("ON-SUSPENSION")
     . "The suspended task cannot run: write the forms that wait in the task that suspends it.")
    (("WITH-OPEN-FILE" "WITH-OPEN-STREAM")
     . "Open the file in a leaf, and close it in the cleanup of an evap-protect."))
  "Advice on what to write instead of the Lisp forms in which plans cannot wait, by operator.")

(defun iterate-call-p (form)
  "True if FORM is a call of a macro of the library iterate, which looks into all forms inside."
  (and (symbolp (first form))
       (member (first form) '("ITER" "ITERATE") :test #'string=)
       (symbol-package (first form))
       (string= "ITERATE" (package-name (symbol-package (first form))))))

(defun advice-for-form (form)
  "Return the advice about forms like FORM, in which plans cannot wait, or NIL. Users' macros with
the names of iterate's macros are left out."
  (and (consp form)
       (symbolp (first form))
       (or (not (member (first form) '("ITER" "ITERATE") :test #'string=)) (iterate-call-p form))
       (cdr (find-if (lambda (names) (member (first form) names :test #'string=))
                     *suspension-advice* :key #'car))))

(defun reject-suspension (form container)
  (let ((advice (or (advice-for-form container)
                    "Bind the value by let before this form, so that the plan waits in let.")))
    (call-at-source-location form
                   (lambda ()
                     (error 'misplaced-suspension
                            :definition (text-title) :clause form
                            :expected (format nil "nothing that waits inside ~A. ~A"
                                              (operator-text container)
                                              (string-right-trim "." advice))
                            :form form :container container :advice advice
                            :place (clause-location form))))))

;;; What a construct expands to within a macro of a user.

(defun plan-named-in (form)
  "Return the name of the plan that FORM probably should run, or NIL. FORM was found in ordinary
Lisp code, and looks like the prompt's command PLAN."
  (let ((name (and (operator-in-p form '("PLAN")) (second form))))
    (and name (symbolp name) (find-procedure name nil) name)))

(defun reject-in-lisp (form)
  "Signal MISUSE, because FORM, a form of the plan language, was found in ordinary Lisp code."
  (reject-use "~S is part of the plan language. ~:[Write it in a def-interp-proc, which ~
               (run-plan 'NAME) runs. There it must not be in a lambda or another form that keeps ~
               plans from waiting~;To run the plan, write (run-plan '~:*~(~A~))~]."
              form (plan-named-in form)))

(defvar *conses-of-plan-text* nil
  "While a plan is compiled, a table of all conses in its text; otherwise NIL.")

(defmacro plan-only-form (form)
  "While a plan is compiled, expand to a form that stands for FORM, a form of the plan language.
Otherwise signal MISUSE, because FORM is in ordinary Lisp code."
  (if *conses-of-plan-text* `(signal-misplaced-construct ',form) (reject-in-lisp form)))

(defun signal-misplaced-construct (form)
  "Signal MISUSE, because Lisp runs FORM, a form of the plan language."
  (reject-in-lisp form))

(defun represented-construct (form)
  "Return the construct that FORM, a form in the expansion of a user's macro, stands for; or NIL."
  (typecase form
    ((cons (eql plan-only-form)) (second form))
    ((cons (eql signal-misplaced-construct)) (second (second form)))))

;;; Names of operators.

(defun system-symbol-p (symbol)
  (let ((package (symbol-package symbol)))
    (or (eq package #.(find-package :cl))
        (and package (starts-with-subseq "ARS-MAGNA." (package-name package))))))

(defun plan-operator-name (form)
  "Return the name of the operator of FORM if the operator may have a meaning in plans, or NIL."
  (cond ((not (and (consp form) (symbolp (first form)))) nil)
        ((system-symbol-p (first form)) (symbol-name (first form)))
        ((eq (first form) :tag) ":TAG")))

(defun plan-form-key (name)
  (if (and (symbolp name) (system-symbol-p name)) (symbol-name name) name))

(defun operator-in-p (form names)
  "True if FORM is a call of an operator of Lisp or of this system with one of NAMES."
  (let ((name (plan-operator-name form)))
    (and name (member name names :test #'string=))))

(defun plan-making-form-p (form)
  "True if FORM is a form that makes a plan, and so reads its own text."
  (operator-in-p form '("INTERP-LAMBDA" "DEF-INTERP-PROC")))

(defparameter *lifted-operators*
  '("NOT" "NULL" "<" ">" "<=" ">=" "=" "+" "-" "*" "/" "EQ" "EQL" "EQUAL"))

(defun starts-with-test-p (forms name)
  "True if FORMS, such as the forms after LOOP, start with the symbol NAME and a test."
  (and (rest forms)
       (symbolp (first forms))
       (string= (first forms) name)))

(defun plan-loop-p (form)
  "True if FORM, a LOOP, has a plan's shape (loop [UNTIL or WHILE test] compound-form...)."
  (let ((forms (rest form)))
    (every #'consp (if (or (starts-with-test-p forms "UNTIL") (starts-with-test-p forms "WHILE"))
                       (cddr forms)
                       forms))))

;;; The plan's own text.

(defun note-plan-text (form)
  "Record that FORM and all forms in it belong to the text of the plan itself. Return FORM."
  (labels ((note (form)
             (loop while (and (consp form) (not (gethash form *conses-of-plan-text*)))
                   do (setf (gethash form *conses-of-plan-text*) t)
                      (note (car form))
                      (setf form (cdr form)))
             (when (form-behind-comma form) (note (form-behind-comma form)))))
    (note form))
  form)

(defvar *written-forms* nil
  "While a plan is compiled, a table from conses of expansions to the forms that they stand for.")

(defun form-as-written (form)
  "Return the form in the author's text from which FORM was made, or FORM."
  (values (gethash form *written-forms* form)))

(defun note-written-as (expansion form)
  "Record that the new conses in EXPANSION, made from FORM, stand for FORM. Return EXPANSION."
  (let ((written (form-as-written form)))
    (labels ((note (part)
               (loop while (and (consp part)
                                (not (plan-text-p part))
                                (not (gethash part *written-forms*)))
                     do (setf (gethash part *written-forms*) written)
                        (note (car part))
                        (setf part (cdr part)))))
      (note expansion)))
  expansion)

(defun note-expansion (expansion form)
  "Record that EXPANSION counts as text of the plan itself and stands for FORM. Return EXPANSION."
  (note-plan-text (note-written-as expansion form)))

(defun plan-text-p (form)
  (gethash form *conses-of-plan-text*))

(defmacro with-plan-text ((form) &body body)
  "Run BODY while FORM, and all forms recorded meanwhile, count as the text of a plan. Generated
names are the same every time, so that traces can be compared."
  `(let ((*conses-of-plan-text* (make-hash-table :test 'eq))
         (*written-forms* (make-hash-table :test 'eq))
         (*gensym-counter* 0))
     (note-plan-text ,form)
     ,@body))

(defun mentions-p (symbol code)
  (loop for tail = code then (cdr tail)
        while (consp tail)
        thereis (mentions-p symbol (car tail))
        finally (return (or (eq symbol tail)
                            (and (form-behind-comma tail)
                                 (mentions-p symbol (form-behind-comma tail)))))))
