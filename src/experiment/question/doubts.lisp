;;;; doubts.lisp -- warnings about clauses of DEFEXPERIMENT that are valid but probably mistakes.

(in-package :ars-magna.experiment)

(export '(warn-of-nested-run))

(defun mentioned-p (name tree)
  (cond ((consp tree) (loop while (consp tree)
                            thereis (mentioned-p name (pop tree))))
        (t (eq name tree))))

(defun warn-of-unused-variables (clauses)
  (dolist (name (varied-variables clauses))
    (unless (or (special-p name)
                (loop for key in '(:run :until :success :measure :each-tick)
                      thereis (mentioned-p name (clause-arguments key clauses))))
      (warn-of-style "~A is varied, but no form mentions it.~@[ Did you mean the parameter ~
                      ~A?~]"
                     name (nearest-name name (mapcar #'parameter-name (all-parameters)))))))

(defun warn-of-unnamed-measures (key clauses)
  "Warn if a part (name form) of the clause KEY in CLAUSES looks like a call with a robot."
  (loop with robots = (clause-arguments :robots clauses)
        for part in (clause-arguments key clauses)
        for (name form) = (and (typep part 'named-form) part)
        when (and name (fboundp name) (symbolp form) (member form robots))
          do (warn-of-style "(~A ~A) is a measure called ~A whose value is the robot ~A. Name ~
                             the measure first: (~(~S~) (NAME (~A ~A)))."
                            name form name form key name form)))

(defun warn-of-nested-run (forms)
  "Warn of a WITH-SIMULATION in FORMS, which a trial evaluates."
  (when (mentioned-p 'with-simulation forms)
    (warn-of-style "a trial is already a run. A with-simulation in it starts another run, with ~
                    the same seed in each trial, and measures do not see that run. Leave ~
                    with-simulation out: (run-plan ...) alone.")))

;;; A plan's name.

(defun quoted-name (form)
  "Return the symbol NAME if FORM is 'NAME or #'NAME; else NIL."
  (and (typep form '(cons (member quote function) (cons symbol null))) (second form)))

(defun run-plan-advice (name)
  (format nil "(:run (run-plan '~(~A~) ...)), with the plan's arguments: ~:*~(~A~) alone runs ~
               nothing" name))

(defun check-run-clause (definition clause)
  "Signal MALFORMED-DEFINITION if CLAUSE, :run, is only the name of a plan."
  (let ((name (and (null (cddr clause)) (quoted-name (second clause)))))
    (when (and name (find-procedure name nil))
      (reject-clause definition clause (run-plan-advice name))))
  (let ((advice (test-advice (first (last clause)))))
    (when advice (warn-of-style "~A, :run: ~A" definition advice))))

;;; Tests.

(defun warn-of-plan-as-test (form)
  "Warn if FORM, the last form of :run, tests the first value of a plan: a failure is true, too."
  (when (and (typep form '(cons symbol (cons (cons symbol) (cons (eql t) (or null (cons null))))))
             (same-name-p 'if (first form))
             (same-name-p 'run-plan (first (second form))))
    (let ((*print-case* :downcase) (*print-pretty* t) (*print-right-margin* 10000))
      (warn-of-style ":run: a failed plan returns its failure, which is true, so ~S is T even ~
                      then. Write only ~S, whose second value says how the plan ended, or a clause ~
                      (:success form)."
                        (abridged form) (abridged (second form))))))

(defun number-as-test-advice (form)
  (when (or (realp form)
            (and (consp form) (member (first form) '(length count + - * floor round abs))))
    (let ((*print-case* :downcase) (*print-pretty* nil))
      (format nil "~S is a number: even 0 counts as true. Compare it, as in (< 0 ~:*~S)." form))))

(defun plan-as-test-advice (form)
  (when (and (consp form) (symbolp (first form)) (same-name-p 'run-plan (first form)))
    (format nil "a failed plan returns its failure, which is true. Make the call of RUN-PLAN the ~
                 last form of :run: its second value says how the plan ended.")))

(defun returns-first-value-p (form)
  "True if FORM returns the first value of :run, or of RUN-PLAN."
  (flet ((call-p (form name) (and (typep form '(cons symbol)) (same-name-p name (first form)))))
    (or (call-p form 'run-plan)
        (and (or (call-p form 'first) (call-p form 'car))
             (call-p (second form) 'trial-values)))))

(defun state-as-test-advice (form)
  "Return advice if FORM compares the first value of a plan with :SUCCEEDED or :FAILED; else NIL."
  (block advice
    (map-comparisons (lambda (subject word comparison)
                       (declare (ignore comparison))
                       (when (and (returns-first-value-p subject)
                                  (member word '(:succeeded :failed)))
                         (return-from advice
                           (format nil "RUN-PLAN returns ~(~S~) as its second value. Write ~
                                        (eq (second (trial-values)) ~:*~(~S~))." word))))
                     form)
    nil))

(defun check-test-clause (definition clause)
  "Signal MALFORMED-DEFINITION unless CLAUSE has one form. Warn if it is always true or false."
  (unless (= 2 (length clause)) (reject-by-usage definition clause))
  (let* ((test (second clause))
         (doubt (or (doubtful-test-text test)
                    (test-advice test)
                    (number-as-test-advice test)
                    (state-as-test-advice test)
                    (plan-as-test-advice test))))
    (when doubt (warn-of-style "~A: ~(~S~): ~A" definition (first clause) doubt))))

(defun warn-of-quoted-measure (definition part)
  "Warn if the form in PART, (name form), is quoted: the measure would be the form itself."
  (let ((name (quoted-name (second part))))
    (when (or (typep (second part) '(cons (eql quote) (cons cons null)))
              (and name (fboundp name)))
      (let ((*print-case* :downcase) (*print-pretty* nil))
        (warn-of-style "~A: the measure ~(~A~) is quoted: its value would be the form. Write ~
                        the form alone: ~:[~S~;(~S ...)~]."
                          definition (first part) name (or name (second (second part))))))))
