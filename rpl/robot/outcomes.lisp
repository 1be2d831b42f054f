;;;; outcomes.lisp -- making plan functions of commands (manual C).

(in-package :ars-magna.rpl-robot)

(export '(define-outcome))

;;; The functions follow from the commands' definitions: the robot is left out, cameras, hands and
;;; bins are given by index, and any argument may be a fluent. How the end of a command sets fluents
;;; is defined by DEFINE-OUTCOME, in the table of commands.lisp.

(defun fluent-for-part (variable part)
  (let ((value (driver-fluent variable *answered-driver*)))
    (if (simple-vector-p value) (svref value (part-index part)) value)))

(defun convert-argument (value type operator)
  "Return VALUE, perhaps a fluent or an index, converted to an argument of TYPE (reading 181)."
  (let ((value (fluent-value value)) (kind (find-kind-name type 'part)))
    (cond (kind (find-part kind value operator))
          ((and (same-name-p type 'destination) (integerp value))
           (find-part 'storage-bin value operator))
          (t value))))

(defun convert-resource (arguments type operator)
  "Return the resource of a command and the other ARGUMENTS. The resource is the robot if TYPE is
ROBOT, otherwise the first argument."
  (if (same-name-p type (quote robot))
      (values (rpl-robot) arguments)
      (values (convert-argument (first arguments) type operator) (rest arguments))))

(defun note-last-command (driver operator resource)
  (let ((task (task-at-work driver)))
    (when task
      (setf (driver-last-command driver)
            (list (task-serial (task-top task)) operator
                  (and (part-p resource) (part-index resource)))))))

(defmethod last-command ((driver driver) task)
  (destructuring-bind (&optional serial operator part)
      (driver-last-command (driver-with-last-command driver task))
    (if (eql serial (task-serial (task-top task))) (values operator part) nil)))

(defun issue-in-plan (driver operator command outcome arguments)
  (let ((issue (note-command operator arguments (robot-name (driver-robot driver)))))
    (multiple-value-bind (resource arguments)
        (convert-resource arguments (spec-type (command-resource command)) operator)
      (let ((arguments (loop for spec in (command-parameters command)
                             for argument in arguments
                             collect (convert-argument argument (spec-type spec) operator))))
        (check-command-arguments driver operator command arguments)
        (note-last-command driver operator resource)
        (issue-action driver command resource arguments outcome issue)))))

(defun issue-plan-command (operator command outcome arguments)
  "Issue COMMAND as the plan function OPERATOR. OUTCOME, a function of the resource, the error code
and the results, returns the settings of fluents at the end of COMMAND. Return nothing."
  (let ((driver (required-driver)))
    ;; A call from outside of plans is recorded. Its results reach forks too.
    (record-plan-action (driver-interface driver)
                        #'call-for-robot (driver-robot driver) operator
                        (mapcar #'fluent-value arguments))
    (let ((*continues-in-forks-p* t))
      (issue-in-plan driver operator command outcome arguments)))
  (values))

(defun searching-camera (driver)
  "Return a camera of the robot of DRIVER that is searching for designators for plans, or NIL."
  (flet ((search-p (action)
           (and (action-open-p action)
                (find-if (lambda (spec)
                           (member (spec-name spec) '(designator designators) :test #'same-name-p))
                         (command-results (action-command action))))))
    (let ((action (find-if #'search-p (driver-actions driver))))
      (and action (action-resource action)))))

(defun expected-argument-text (driver type argument)
  "Return text on what a plan must give instead of ARGUMENT, which is not of TYPE, to the robot of
DRIVER."
  (let ((camera (and (null argument)
                     (same-name-p type 'designator)
                     (searching-camera driver))))
    (if camera
        (format nil "a designator. The search for it is still under way. First wait for its ~
                     end: (wait-for (vref camera-input* ~D))"
                (part-index camera))
        (argument-type-text type argument))))

(defun check-command-arguments (driver operator command arguments)
  (loop for spec in (command-parameters command)
        for argument in arguments
        unless (argument-of-type-p argument (spec-type spec))
          do (error 'wrong-argument
                    :operator operator :name (spec-name spec) :value argument
                    :expected (expected-argument-text driver (spec-type spec) argument))))

(defun plan-function-name (command-name)
  (symbolicate 'rpl- command-name))

(defun check-fluent-variable (name clause)
  (unless (or (assoc name *fluent-variables*) (known-variable-p name nil))
    (reject-clause "define-outcome" clause "a fluent variable, as DEFINE-FLUENTS defines")))

(defun clause-form (clause)
  (case (and (consp clause) (first clause))
    (:set (destructuring-bind (fluent value) (rest clause)
            (check-fluent-variable fluent clause)
            `(list (list :set (fluent-for-part ',fluent resource) ,value))))
    (:error (check-fluent-variable (second clause) clause)
     `(list (list :error (fluent-for-part ',(second clause) resource) err)))
    (:pulse (check-fluent-variable (second clause) clause)
     `(list (list :pulse (fluent-for-part ',(second clause) resource))))
    (:when (destructuring-bind (test . clauses) (rest clause)
             `(when ,test (append ,@(mapcar #'clause-form clauses)))))
    (t (reject-clause "define-outcome" clause
                      (format nil "(:set fluent form), (:error fluent), (:pulse fluent) or ~
                                   (:when form clause...)")))))

(defun clause-fluents (clauses &optional (kinds '(:set :error :pulse)))
  "Return the fluent variables in those of CLAUSES that have KINDS, perhaps with duplicates."
  (loop for (kind . more) in clauses
        append (cond ((member kind kinds) (list (first more)))
                     ((eq :when kind) (clause-fluents (rest more) kinds)))))

(defun plan-fluent-form (variable part)
  "Return a form for plans: the fluent in VARIABLE, or PART's fluent if VARIABLE holds a vector."
  (if (second (assoc variable *fluent-variables*)) `(vref ,variable ,part) variable))

(defun clause-fluent-form (kind clauses part)
  "Return a form for the fluent in the first clause of KIND, :pulse or :error, in CLAUSES; NIL if
there is no such clause. PART is the name of the command's argument for the part."
  (let ((fluent (second (assoc kind clauses))))
    (and fluent (plan-fluent-form fluent part))))

(defun warn-of-argument-count (name command-name parameters forms)
  (unless (= (length parameters) (length forms))
    (warn-of-style "~(~A~) takes ~:[no argument~;~:*~(~A~)~], not ~D argument~:P.~:[~; In ~
                    plans the robot and the continuation are left out: ~A.~]"
                   name parameters (length forms)
                   (< (length parameters) (length forms)) (plan-call-text command-name))))

(defmacro define-outcome (commands (&rest results) &body clauses)
  "Define the plan functions of COMMANDS. When a command ends, CLAUSES run with ERR bound to its
error code and RESULTS to its results: (:set fluent form); (:error fluent), which sets the fluent to
ERR; (:pulse fluent); (:when form clause...). When a newer command of a plan interrupts a command,
CLAUSES run at once, with :INTERRUPT and no results. A later answer to the interrupted command sets
only the fluents of :SET, which describe the robot's state. See reading 179."
  `(progn
     ,@(loop for command-name in commands
             for (resource specifications sentence) = (command-signature command-name)
             for name = (plan-function-name command-name)
             for parameters = (append (unless (same-name-p 'robot (second resource))
                                        (list (first resource)))
                                      (mapcar #'first specifications))
             for ours = (addition-p command-name)
             collect `(,(if ours 'addition 'public) ,name)
             collect `(setf (get ',command-name 'result-fluents)
                            ',(remove-duplicates (clause-fluents clauses '(:set :error))))
             collect `(mapc #'note-changed-by-commands
                            ',(remove-duplicates (clause-fluents clauses)))
             collect `(note-plan-function
                       ',command-name '(,name ,@parameters)
                       ',(clause-fluent-form :pulse clauses (first parameters))
                       ',(clause-fluent-form :error clauses (first parameters))
                       (mapcar #'error-code-keyword
                               (command-errors (find-command ',command-name)))
                       ',(loop for fluent in (clause-fluents clauses '(:set))
                               collect (plan-fluent-form fluent (first parameters))))
             collect `(defun ,name ,parameters
                        ,(format nil "~A~%Returns nothing; sets ~(~{~A~^, ~}~). Arguments may be ~
                                      fluents.~:[~; (Manual C.)~]"
                                 sentence (remove-duplicates (clause-fluents clauses))
                                 (and *loading-simulator-p* (not ours)))
                        (issue-plan-command ',name (find-command ',command-name)
                                            (lambda (resource err &optional ,@results &rest more)
                                              (declare (ignore more)
                                                       (ignorable resource err ,@results))
                                              (append ,@(mapcar #'clause-form clauses)))
                                            (list ,@parameters)))
             collect `(define-compiler-macro ,name (&whole form &rest arguments)
                        (warn-of-argument-count ',name ',command-name ',parameters arguments)
                        form))))

;;; A user's command has a function in plans only if its outcome is defined.

(defun advice-on-command (name)
  "NAME is a symbol that may begin with RPL-. Return sentences on how plans can issue the command
whose name follows RPL-: by which function, or how to define one; NIL if there is no such command."
  (let* ((text (symbol-name name))
         (command (and (starts-with-subseq "RPL-" text)
                       (find-command (subseq text (length "RPL-")) nil)))
         (own (and command (plan-function-name (command-name command))))
         (same-p (and own (same-name-p name own))))
    (cond ((null command) nil)
          ((and (has-plan-function-p (command-name command)) (not same-p))
           (format nil "plans use the function ~(~A~)." own))
          ((and same-p (not (has-plan-function-p (command-name command))))
           (let ((*print-case* :downcase))
             (format nil "no fluent yet reports the end of the command ~A to plans. Define a ~
                          fluent: (define-fluents ~A (my-fluent* \"Pulsed at its end.\")) and ~
                          (define-outcome (~2:*~A~*) ~:A (:pulse my-fluent*)). Choose ~
                          a name for my-fluent*; the others are of package ars-magna.rpl-robot."
                     (string-downcase (command-name command))
                     (spec-type (command-resource command))
                     (mapcar #'spec-name (command-results command))))))))

(defmethod advice-on-call ((name symbol))
  (or (advice-on-command name) (advice-on-goal name)))
