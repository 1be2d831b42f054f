;;;; define-command.lisp -- define a command, with all data about it, in one form.

(in-package :ars-magna.command)

(export '(define-command))

(defun replace-prefix (prefix replacement string)
  (when (starts-with-subseq prefix string)
    (concatenate 'string replacement (subseq string (length prefix)))))

(defun default-prompt-name (name)
  "Return the prompt's name for the command NAME: ROBOT- is left out, CAMERA- becomes CAM-, and
STORAGE-BIN- becomes BIN- (manual E; the rule is inferred; reading 194)."
  (let ((name (symbol-name name)))
    (or (replace-prefix "ROBOT-" "" name)
        (replace-prefix "CAMERA-" "CAM-" name)
        (replace-prefix "STORAGE-BIN-" "BIN-" name)
        name)))

(defun option-arguments (key options &optional default)
  (let ((entry (assoc key options)))
    (if entry (rest entry) default)))

(defun command-documentation-text (sentence resource parameters results errors section)
  (format nil "~A Returns nothing; takes effect in the next tick.~%~@[Arguments: ~{~A~^; ~}.~%~]~
               The continuation gets an error code or NIL, the ~(~A~)~{, ~A~}.~%~
               Error codes: ~{~S, ~}:INTERRUPT.~@[ (Manual ~A.)~]"
          sentence
          (loop for (name nil text) in parameters
                collect (format nil "~A, ~A" name text))
          (first resource)
          (mapcar #'second results)
          (mapcar #'first errors)
          section))

(defun spec-form (specification)
  (destructuring-bind (name type &optional (text "")) specification
    `(make-spec ',name ',type ,text)))

(define-argument-type 'continuation
  (lambda (value)
    (or (functionp value)
        (and (symbolp value)
             (not (eq t value))
             (or (not (keywordp value)) (fboundp value)))))
  (one-line "a continuation: a function of an error code and the command's results, as
(continuation (err &rest results) ...) makes, or NIL for none"))

(defun argument-check-form (name variable type)
  `(check-argument-type ',name ',variable ,variable (load-time-value (find-argument-type ',type))))

(defun warn-of-uncallable (name forms)
  "FORMS are the arguments in a call of the command NAME. Warn of each form that is no valid call,
such as an unquoted list of data, or (90 deg)."
  (dolist (form forms)
    (typecase form
      ((cons (or keyword (cons (not (eql lambda)))))
       (let ((*print-pretty* nil))
         (warn-of-style "~(~A~): ~S is no call of a function. If it is data, quote it: '~:*~S"
                        name (abridged form))))
      ((cons number)
       (warn-of-style "~(~A~): ~S is no call of a function. Units are for the prompt, in lines ~
                       without parentheses; in Lisp 90 degrees are (* 90 (/ pi 180))."
                      name (abridged form))))))

(defun warn-of-argument-count (name parameters forms)
  (unless (<= (- (length parameters) 2) (length forms) (1- (length parameters)))
    (warn-of-style "~(~A~) takes ~(~:A~), not ~D argument~:P."
                   name parameters (length forms))))

(defun returns-nothing-p (form)
  "True if FORM calls an operator that has an effect, such as output, and returns no function."
  (typecase form
    ((cons (member setf setq)) (constantp (first (last form))))
    ((cons symbol) (or (member (first form) '(out terpri fresh-line format error-set warning-set
                                              message-set error-display))
                       (get (first form) 'command-signature)))))

(defun called-early-p (form count)
  "True if FORM calls a user's function without arguments, although the function takes COUNT
arguments and could itself be the continuation. False if the value is known to be a function."
  (and (typep form '(cons symbol null))
       (users-symbol-p (first form))
       (fboundp (first form))
       (not (macro-function (first form)))
       (callable-with-count-p (first form) count)
       (not (find 'function (ensure-list (third (ensure-list (sb-introspect:function-type
                                                              (first form)))))))))

(defun warn-of-early-call (name form count)
  "Warn if FORM, passed to NAME as the continuation, is evaluated before the command NAME ends."
  (when (or (returns-nothing-p form) (called-early-p form count))
    (let ((*print-pretty* nil))
      (warn-of-style "~(~A~): ~S is evaluated at once, not when the command has ended, and ~
                      returns no continuation. Write (continuation (err &rest results) ~:*~S)."
                        name (abridged form)))))

(defparameter *command-families* '(:moving :looking :handling :manipulating :thinking
                                   :messages)
  "The families of commands.")

(defun check-command-form (name resource parameters results options)
  (flet ((check (test clause expected)
           (unless test
             (reject-clause (definition-title "define-command" name) clause expected))))
    (check (and name (symbolp name) (not (keywordp name))) name "a symbol as the command's name")
    (check (and (proper-list-p resource) (= 2 (length resource))) resource "(variable type)")
    (dolist (parameter parameters)
      (check (and (proper-list-p parameter) (<= 2 (length parameter) 3)) parameter
             "(variable type \"description\")"))
    (dolist (result results)
      (check (and (proper-list-p result) (= 2 (length result)) (stringp (second result))) result
             "(name \"description\")"))
    (loop with keys = '(:family :section :delay :errors :expected :report :echo :prompt :prefix
                        :occupies :arguments :traits)
          for option in options
          do (check (and (consp option) (member (first option) keys)) option
                    (format nil "~{(~(~S~) ...)~#[~; or ~:;, ~]~}" keys)))
    (dolist (trait (option-arguments :traits options))
      (check (member trait *command-traits*) trait
             (format nil "traits of ~{~(~S~)~^, ~}" *command-traits*)))
    (dolist (code (option-arguments :expected options))
      (check (assoc code (option-arguments :errors options)) code
             "an error code that (:errors ...) lists"))
    (let ((family (assoc :family options)))
      (check (and family (member (second family) *command-families*)) (or family options)
             (format nil "(:family family), one of ~{~(~S~)~^, ~}" *command-families*)))))

(defun check-types-known (name types)
  (dolist (type types)
    (unless (find-argument-type type nil)
      (reject-clause (definition-title "define-command" name) type
                     "the name of an argument type that DEFINE-ARGUMENT-TYPE has defined"))))

(defmacro define-command (name (operation resource &rest parameters) (&rest results)
                          (&rest options) sentence &body body)
  "Define the function NAME, which issues a command, and all data about that command.

OPERATION is bound in BODY to the operation. RESOURCE is (variable type), each of PARAMETERS is
(variable type text) with a type of DEFINE-ARGUMENT-TYPE, each of RESULTS is (name text). OPTIONS:
  (:family keyword) (:section string)  the command's family, and its section in the manual, if any
  (:delay form)                        ticks until BODY runs, evaluated when the command begins;
                                       without :delay, BODY runs in the next tick
  (:errors (keyword text [meaning remedy])...)  the command's error codes; the form TEXT returns the
                                       error message, a string or a function of the operation;
                                       strings say what a new code means and what to try
  (:expected keyword...)               the error codes that do not count as failures, so that plans
                                       need not check them
  (:report lambda-list form)           a form for the message of success, with the results as
                                       arguments; (operation-resource OPERATION) is the resource
  (:echo name...)                      the RESULTS that the continuation also gets after an
                                       interruption: the argument for a parameter of the same name;
                                       else the operation's subject, if BODY has begun
  (:prompt name) (:prefix string)      the name at the prompt, by default DEFAULT-PROMPT-NAME, and
                                       the beginning of messages, by default the command's name
  (:occupies function)                 the name of a function of the resource that returns what the
                                       command occupies instead, such as the robot's mind
  (:arguments function)                the name of a function of the resource and the arguments that
                                       checks them further and returns a list of those to keep
  (:traits keyword...)                 properties for warnings and plans: :DRIVES if the command
                                       moves the robot even in one tick; :TURNS if it turns its
                                       resource by a relative angle; :STOPS if it stops its
                                       resource; :ASKS if only its answer is useful; :BEGINS if
                                       its continuation is called at the beginning and at the end
BODY runs in a tick. OPERATION must end with SUCCEED or FAIL-WITH, now or later (reading 149)."
  (check-command-form name resource parameters results options)
  (let ((errors (option-arguments :errors options))
        (variables (mapcar #'first parameters))
        (report (option-arguments :report options)))
    `(progn
       (public ,name)
       (check-types-known ',name '(,(second resource) ,@(mapcar #'second parameters)))
       (eval-when (:compile-toplevel :load-toplevel :execute)
         (setf (get ',name 'command-signature) '(,resource ,parameters ,sentence)))
       (register-command
        (make-command
         :name ',name
         :prompt-name ,(first (option-arguments :prompt options (list (default-prompt-name name))))
         :prefix ,(first (option-arguments :prefix options (list (string-downcase name))))
         :origin ,(format nil "the continuation of ~(~A~)" name)
         :family ,(first (option-arguments :family options))
         :section ,(first (option-arguments :section options))
         :documentation ,sentence
         :resource ,(spec-form resource)
         :occupies ',(first (option-arguments :occupies options))
         :checker ',(first (option-arguments :arguments options))
         :parameters (list ,@(mapcar #'spec-form parameters))
         :results (list ,@(loop for (result text) in results
                                collect (spec-form (list result t text))))
         :errors (list ,@(loop for error in errors collect `(make-error-code ,@error)))
         :expected ',(option-arguments :expected options)
         :traits ',(option-arguments :traits options)
         :echo ',(option-arguments :echo options)
         :delay (lambda () ,(first (option-arguments :delay options '(1))))
         :instant-p ,(null (assoc :delay options))
         :report ,(when report
                    `(lambda (,operation ,@(first report))
                       (declare (ignorable ,operation ,@(first report)))
                       ,@(rest report)))
         :guarded-p (not *loading-simulator-p*)
         :body (lambda (,operation ,(first resource) ,@variables)
                 ;; A later step may be what uses a parameter, by OPERATION-ARGUMENTS.
                 (declare (ignorable ,operation ,(first resource) ,@variables))
                 ,@body)))
       (defun ,name (,(first resource) ,@variables &optional continuation)
         ,(command-documentation-text sentence resource parameters results errors
                                      (first (option-arguments :section options)))
         ,(argument-check-form name (first resource) (second resource))
         ,@(loop for (variable type) in parameters
                 collect (argument-check-form name variable type))
         ,(argument-check-form name 'continuation 'continuation)
         (issue (command-of ',name) ,(first resource) (list ,@variables) continuation))
       (define-compiler-macro ,name (&whole form &rest arguments)
         (warn-of-argument-count ',name '(,(first resource) ,@variables &optional continuation)
                                 arguments)
         (warn-of-uncallable ',name arguments)
         (warn-of-early-call ',name (nth ,(1+ (length parameters)) arguments)
                             ,(+ 2 (length results)))
         form)
       ',name)))
