;;;; known-fluents.lisp -- fluents in a plan's text given to functions that need values.

(in-package :ars-magna.rpl.language)

;;; Most of Lisp's functions take values. The compiler knows which arguments they take, and that
;;; some expressions are fluents: the robot's variables, what CREATE-FLUENT and the like return,
;;; what lifted operators make of these, and variables that are bound to such and never assigned.

(defvar *fluents-here* '() "The variables of the plan that are known to hold fluents.")

(defparameter *makers-of-fluents*
  '("CREATE-FLUENT" "STATE" "TASK-STATUS" "FL-PULSED" "FL-VALUE-CHANGED")
  "Names of functions that always return a fluent.")

(defun form-vector-kind (form)
  "If FORM is the variable of a vector of fluents for parts, return the kind of part; else NIL."
  (and (symbolp form) (vector-variable-kind form)))

(defun known-fluent-p (form environment)
  (cond ((null form) nil)
        ((symbolp form)
         (or (known-fluent-variable-p form)
             (and (member form *fluents-here*) (not (bound-in-walk-p form environment)))))
        ((atom form) nil)
        ((and (symbolp (first form))
              (member (first form) '("VREF" "AREF" "SVREF" "ELT") :test #'string=)
              (form-vector-kind (second form))))
        ((operator-in-p form *makers-of-fluents*))
        ((and (plan-text-p form) (operator-in-p form *lifted-operators*))
         (some (lambda (argument) (known-fluent-p argument environment)) (rest form)))))

;;; Conditions.

(defun reject-vector-condition (form)
  (let ((kind (form-vector-kind form)))
    (when kind
      (reject-clause (text-title) form
                     (format nil "one of the fluents in that vector: (vref ~(~A~) ~A)"
                             form kind)))))

;;; Waits for what cannot change.

(defun known-non-fluent-p (form environment)
  "True if FORM, in ENVIRONMENT, is known to return a value that is no fluent. Such forms are
constants, calls of FLUENT-VALUE, and calls of lifted operators with only such arguments."
  (cond ((constantp form) t)
        ((not (and (consp form) (symbolp (first form)) (proper-list-p form))) nil)
        ((local-function-p (first form) environment) nil)
        ((operator-in-p form '("FLUENT-VALUE")) t)
        ((operator-in-p form (list* "AND" "OR" *lifted-operators*))
         (every (lambda (argument) (known-non-fluent-p argument environment)) (rest form)))))

(defun strip-fluent-value (form)
  "Return FORM without calls of FLUENT-VALUE and quotes, so that it returns a fluent, not a value."
  (cond ((and (consp form) (or (operator-in-p form '("FLUENT-VALUE")) (eq 'quote (first form))))
         (second form))
        ((and (consp form) (proper-list-p form))
         (cons (first form)
               (loop for argument in (rest form)
                     collect (if (and (consp argument) (not (eq 'quote (first argument))))
                                 (strip-fluent-value argument)
                                 argument))))
        (t form)))

(defun mistaken-for-fluent-p (form environment)
  "True if FORM is known to return the value of a fluent, or is the quoted name of a fluent."
  (typecase form
    ((cons (eql quote)) (known-fluent-p (second form) environment))
    (cons (and (known-non-fluent-p form environment)
               (mentions-p 'fluent-value form)))))

(defun advice-on-awaited (condition form environment)
  (let ((name (first form)))
    (cond ((mistaken-for-fluent-p condition environment)
           (format nil "~(~A~) needs a fluent, and ~S is a value, which never changes. Write ~
                        (~(~A~) ~S~:[~; ...~])."
                   name condition name (strip-fluent-value condition) (cddr form)))
          ((and (consp condition) (operator-in-p condition '("TASK-STATUS")))
           (format nil "the status of a task is always true, so ~(~A~) does not wait. Compare it: ~
                        (~(~:*~A~) (eq ~S :succeeded)~:[~; ...~])." name condition (cddr form)))
          ((and (typep condition '(or (not (or cons null keyword))
                                     (cons (eql quote) (cons (not null)))))
                (constantp condition))
           (format nil "~(~A~) needs a fluent, such as robot-stopped*, and ~S is a constant, which ~
                        never changes.~@[ To let time pass, write (wait-time ~S).~]"
                   name condition (and (realp condition) (plusp condition) condition))))))

(defun check-awaited (condition form scope)
  (let ((advice (and (plan-text-p form)
                     (let ((*print-case* :downcase) (*print-pretty* t)
                           (*print-right-margin* 10000))
                       (advice-on-awaited condition form (scope-environment scope))))))
    (when advice
      (warn-of-form form "~A" advice))))

;;; Arguments.

(defun type-admits-fluents-p (type)
  (multiple-value-bind (may known) (ignore-errors (subtypep 'fluent type))
    (or may (not known))))

(defun argument-types (name count)
  "Return a list of the types of the first arguments of the function NAME, at most COUNT types."
  (let ((types '()))
    (loop for (part . more) on (function-argument-types name)
          while (< (length types) count)
          do (case part
               (&optional)
               (&rest (return (append (nreverse types) (list (first more)))))
               ((&key &allow-other-keys) (return (nreverse types)))
               (t (push part types)))
          finally (return (nreverse types)))))

(defun misplaced-fluent (form environment)
  (let ((arguments (rest form)))
    (and (some (lambda (argument) (known-fluent-p argument environment)) arguments)
         (loop for argument in arguments
               for types = (argument-types (first form) (length arguments))
                 then (or (rest types) types)
               while types
               when (and (known-fluent-p argument environment)
                         (not (type-admits-fluents-p (first types))))
                 return argument))))

;; What a quoted list holds is never a fluent. With a :test of the author's it may still be found.
(defun fluent-sought-in-constant (form environment)
  "Return the fluent that the call FORM searches for in a constant, which has no fluents; or NIL."
  (and (operator-in-p form '("MEMBER" "FIND" "POSITION" "COUNT" "ASSOC" "RASSOC"))
       (cddr form)
       (constantp (third form))
       (subsetp (cdddr form) '(:test #'eq #'eql #'equal #'equalp) :test #'equal)
       (known-fluent-p (second form) environment)
       (second form)))

(defun check-fluent-increment (form environment)
  (when (and (operator-in-p form '("INCF" "DECF"))
             (typep form '(cons t (cons t (or null (cons t null)))))
             (known-fluent-p (second form) environment))
    (destructuring-bind (name fluent &optional (by 1)) form
      (warn-of-form form "~(~A~) cannot change ~S, which is a fluent. Write ~S."
                    name fluent
                    `(set-value ,fluent (,(if (same-name-p name 'incf) '+ '-)
                                         (fluent-value ,fluent) ,by))))))

(defun check-assignments (form environment)
  "Warn if FORM, in the text of a plan, assigns a value to a variable that holds a fluent."
  (when (operator-in-p form '("SETQ" "SETF"))
    (loop for (place value) on (rest form) by #'cddr
          when (and (symbolp place)
                    (known-fluent-p place environment)
                    (known-non-fluent-p value environment))
            do (warn-of-form form "~(~A~) puts ~S in the place of the fluent ~S, which is then ~
                                   lost. Write ~S."
                             (first form) value place `(set-value ,place ,value)))))

(defun check-fluent-arguments (form environment)
  "Warn if FORM, in the text of a plan, gives a fluent to a function that cannot take fluents."
  (let ((name (first form)))
    (when (and (proper-list-p form)
               (not (operator-in-p form *lifted-operators*))
               (not (local-function-p name environment))
               (not (macro-function name))
               (not (special-operator-p name)))
      (if (fboundp name)
          (let* ((fluent (misplaced-fluent form environment))
                 (found (or fluent (fluent-sought-in-constant form environment))))
            (when found
              (warn-of-form form "~(~A~) ~:[never finds~;cannot take~] ~S, which is a fluent. ~
                                  Write (fluent-value ~:*~S) for its current value, or (fl-funcall ~
                                  #'~(~3:*~A~) ...) for a network."
                            name fluent found)))
          (check-later #'check-lisp-call form)))))

;;; Variables.

(defparameter *assigning-operators*
  '("SETQ" "SETF" "PSETQ" "PSETF" "PUSH" "PUSHNEW" "POP" "MULTIPLE-VALUE-SETQ" "ROTATEF"
    "SHIFTF")
  "Names of operators that assign variables, without INCF and DECF, which assign only numbers.")

(defun assigned-p (variable forms)
  (map-calls (lambda (call)
               (when (and (operator-in-p call *assigning-operators*)
                          (mentions-p variable (rest call)))
                 (return-from assigned-p t)))
             forms))

(defun variables-bound-to-fluents (bindings body scope sequential)
  "Return the variables that BINDINGS, of a LET or LET*, bind to fluents and BODY does not assign."
  (let ((*fluents-here* (scope-fluents scope)) (found '()))
    (loop for (variable value) in (remove-if #'atom bindings)
          do (cond ((and (known-fluent-p value (scope-environment scope))
                         (not (assigned-p variable body)))
                    (push variable found)
                    (when sequential (push variable *fluents-here*)))
                   (t (setf found (remove variable found)))))
    found))
