;;;; plan-lines.lisp -- PLAN, PLANS and STOP-PLAN.

(in-package :ars-magna.cli)

;;; Which plan is meant.

(defun plan-called (name)
  "Return the plan procedure called NAME, a string: the user's own, or else the newest in whatever
package; NIL if there is none."
  (handler-case (find-procedure (or (find-symbol (string-upcase name)) name))
    (unknown-name () nil)))

(defun plan-names ()
  (remove-duplicates (mapcar #'procedure-name (all-procedures)) :test #'same-name-p))

(defun plan-meant (name)
  "Return the plan procedure called NAME, or the only one whose name begins so. Signals BAD-LINE."
  (let ((candidates (all-starting (string-upcase name) (plan-names) #'string)))
    (cond ((plan-called name))
          ((null candidates) (reject-absent "plan" name (plan-names) "PLAN lists all plans."))
          ((rest candidates) (reject-ambiguous name candidates))
          (t (plan-called (string (first candidates)))))))

(define-choices :plan (plan-names))

;;; What plans take.

(defun plan-documentation (plan)
  (or (documentation (procedure-name plan) 'function) "Not documented."))

;; A plan that another one of its author calls is a part, and not what one would start.
(defun parts-of-plans ()
  "Return the plans that others of the same package call."
  (loop for plan in (all-procedures)
        append (loop for part in (called-procedures plan)
                     unless (or (eq part plan)
                                (not (eq (symbol-package (procedure-name part))
                                         (symbol-package (procedure-name plan)))))
                       collect part)))

(defun whole-sentence (text)
  "Return TEXT up to its first full stop."
  (let* ((text (one-line text)) (end (search ". " text)))
    (if end (subseq text 0 (1+ end)) text)))

(defun write-plan-menu ()
  (let ((parts (parts-of-plans)))
    (dolist (name (plan-names))
      (let ((plan (plan-called (string name))))
        (unless (member plan parts)
          (write-filled (whole-sentence (plan-documentation plan)) 27
                        (format nil "  ~A" name))))))
  (format t "HELP name tells what a plan takes. Those that plans listed here are made of~%~
             can be started as well.~%"))

(defun write-plan-help (plan)
  (format t "PLAN ~A~%" (plan-usage plan))
  (write-filled (plan-documentation plan) 2))

;;; Starting them.

(defun begin-errand (errand plan arguments)
  (with-lock (*plan-errands-lock*) (push errand *plan-errands*))
  (handler-bind ((error (lambda (condition)
                          (close-errand errand)
                          (when (typep condition 'program-error)
                            (reject-line "~A was given ~:[no arguments~;~:*~{~S~^ ~}~]. It is: ~
                                          PLAN ~A."
                                         (procedure-name plan) arguments (plan-usage plan))))))
    (setf (plan-errand-task errand) (apply #'begin-plan plan arguments))))

(defun send-plan (session plan arguments)
  (let ((errand (make-plan-errand (procedure-name plan) session (current-simulation))))
    (check-run)
    (setf (session-failure session) nil)
    (pushnew (procedure-name plan) (session-plans session))
    (let ((task (let ((*robot-to-drive* #'session-robot))
                  (begin-errand errand plan arguments))))
      (push errand (session-errands session))
      (note-plan-of-line (session-account session) task)
      (when (live-p (plan-errand-simulation errand)) (start-watching-plan errand))
      (unless (waits-p session)
        (format t "Plan ~D is under way: ~(~A~).~%" (task-serial task) (procedure-name plan))))))

(defun read-data (text line)
  (loop with position = (skip-blanks text 0)
        until (= position (length text))
        collect (multiple-value-bind (datum end) (read-datum text position line)
                  (setf position (skip-blanks text end))
                  datum)))

(define-line "PLAN" (session (name :plan "the name of a plan" :optional)
                             (args :rest "what the plan takes, not evaluated: no quote is needed"
                                   :optional))
    (:planning)
    "List the plans that there are, or let the robot carry out the plan NAME with ARGS. A live
prompt is back at once; any other waits until the plan is over."
  (if name
      (send-plan session (plan-meant name) (read-data (or args "") (find-line "PLAN")))
      (write-plan-menu)))

;;; Those under way.

(defun plan-package (name)
  "Return the package in which the plan called NAME, or NIL, was written."
  (let ((plan (plan-called (string name))))
    (if plan (symbol-package (procedure-name plan)) (user-package))))

(defun call-reading-plan (name function)
  "Call FUNCTION, which returns text with forms of the plan called NAME. Return it as who reads the
plan would write it: few symbols have a package."
  (let* ((*package* (plan-package name))
         (*print-pretty* nil)
         (text (funcall function)))
    (dolist (prefix '("ars-user::" "ars-worlds::" "ars-worlds:") text)
      (setf text (without prefix text)))))

(defun without (word text)
  "Return TEXT without all that is WORD, in whatever case."
  (with-output-to-string (out)
    (loop for start = 0 then (+ end (length word))
          for end = (search word text :start2 start :test #'char-equal)
          do (write-string text out :start start :end end)
          while end)))

(defun failure-report (failure name)
  (let ((*message-queue* (make-message-queue)))
    (call-reading-plan name (lambda ()
                              (report-failure failure)
                              (message-text (first (take-messages)))))))

(define-line "PLANS" (session) (:planning)
    "Show the plans under way, as trees of what they do and wait for; if the last to end failed,
also where and why."
  (let ((plans (plans)))
    (if plans
        (write-string (call-reading-plan (task-name (first plans))
                                         (lambda ()
                                           (with-output-to-string (out) (print-plans out)))))
        (format t "No plan is under way. PLAN lists the plans that there are.~%")))
  (when (session-failure session)
    (destructuring-bind (failure name) (session-failure session)
      (format t "The last plan failed: ~A~&" (failure-report failure name)))))

(define-line "STOP-PLAN" (session (n count "the number of a plan under way" :optional))
    (:planning)
    "End the plan N, or all that are under way. What it has told the robot to do is interrupted."
  (cond ((null (plans)) (reject-line "No plan is under way."))
        (n (end-plan (or (find n (plans) :key #'task-serial)
                         (reject-line "No plan ~D is under way. PLANS shows which are." n))))
        (t (end-plan :all))))
