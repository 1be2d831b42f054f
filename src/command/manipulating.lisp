;;;; manipulating.lisp -- carry out manipulations (manual 5.5.2).

(in-package :ars-magna.command)

(export '(manipulation-command-p ensure-manipulation-command))

;;; Designators give the objects. Those invalid, false, non-local or of other robots give none.

(defun designated-local-thing (designator resource)
  "Return the local thing that DESIGNATOR denotes for the robot of RESOURCE, or NIL (reading 175)."
  (and (own-designator-p resource designator)
       (eq (designator-type designator) :local)
       (designator-truly-local-p designator)
       (designator-thing designator)))

;;; Methods for given arguments.

(defun method-takes-p (method arguments)
  (let* ((parameters (method-parameters method))
         (count (length (parameter-list-objects parameters)))
         (typed (parameter-list-typed parameters)))
    (and (= (length arguments) (+ count (length typed)))
         (every #'designator-p (subseq arguments 0 count))
         (typep (nth count arguments) '(or robot part))
         (loop for value in (nthcdr count arguments)
               for (nil type) in typed
               ;; Unknown types fit all values.
               for known = (and type (find-argument-type type nil))
               always (or (null known) (argument-of-type-p value type))))))

(defun methods-for (manipulation arguments)
  "Return the methods of MANIPULATION that take ARGUMENTS. Signals WRONG-ARGUMENT if none does."
  (or (remove-if-not (lambda (method) (method-takes-p method arguments))
                     (manipulation-methods manipulation))
      (reject-argument (manipulation-name manipulation) "argument list" arguments
                       (format nil "~{~(~A~)~^ or ~}, objects as designators and the resource as a ~
                                    robot or part, and then a continuation"
                               (loop for method in (manipulation-methods manipulation)
                                     collect (parameter-variables (method-parameters method)))))))

;; See reading 176.
(defun method-resource (method arguments)
  (nth (length (parameter-list-objects (method-parameters method))) arguments))

;;; Methods for given things.

(defun method-things (method arguments)
  "Return a list of the things that the designators in ARGUMENTS of METHOD denote, with NIL for each
designator that denotes no local thing."
  (loop with resource = (method-resource method arguments)
        for nil in (parameter-list-objects (method-parameters method))
        for designator in arguments
        collect (designated-local-thing designator resource)))

(defun method-applies-p (method arguments)
  (let ((things (method-things method arguments)) (parameters (method-parameters method)))
    (and (notany #'null things)
         (equal (mapcar #'body-p things) (parameter-list-robots parameters))
         (patterns-fit-p (parameter-list-patterns parameters) things))))

(defun method-objects (method arguments)
  "Return what the object parameters of METHOD are bound to: things, and robots for their bodies."
  (loop for thing in (method-things method arguments)
        collect (if (body-p thing) (body-robot thing) thing)))

(defun applicable-method (manipulation arguments resource)
  "Return the first method of MANIPULATION that takes ARGUMENTS with RESOURCE and fits the
designated things now, or NIL."
  (find-if (lambda (method)
             (and (method-takes-p method arguments)
                  (eq resource (method-resource method arguments))
                  (method-applies-p method arguments)))
           (manipulation-methods manipulation)))

;;; In its tick.

(defun warn-of-returned-value (operation code)
  "Warn once for the manipulation of OPERATION if CODE, which its body returned, is no error code."
  (unless (typep code '(or null keyword))
    (let ((name (command-prefix (operation-command operation))) (text (unqualified-text code)))
      (warn-once (list :code name) (operation-world operation)
                 (format nil "manipulation ~A: its body returned ~(~A~) as its first value, but ~
                              the first value is an error code (a keyword), or NIL for success. ~
                              To return a result, write (values nil result)."
                         name (cut text 60))))))

(defun run-method-body (operation method)
  "Run the body of METHOD; end OPERATION with the error code and the value that the body returns, or
with :FAILED if the body fails."
  (let* ((arguments (operation-arguments operation)) (objects (method-objects method arguments))
         (results '(:failed)) (*world* (operation-world operation)))
    (in-any-case
      (call-user-code (lambda ()
                        (setf results (multiple-value-list
                                       (apply (method-body method)
                                              (append objects
                                                      (nthcdr (length objects) arguments))))))
                      (list "manipulation " (command-prefix (operation-command operation))))
      (progn (warn-of-returned-value operation (first results))
             (end-operation operation (first results) (second results))))))

(define-step carry-out (operation (and (manipulation-method-p (operation-subject operation))
                                       (method-takes-p (operation-subject operation)
                                                       (operation-arguments operation))))
  "Run the method that is OPERATION's subject. Fail if the method no longer applies, or by chance."
  (let ((method (operation-subject operation))
        (dice (robot-dice (resource-robot (operation-resource operation)) :manipulations)))
    (if (and (method-applies-p method (operation-arguments operation))
             (chance (method-success method) dice))
        (run-method-body operation method)
        (fail-with operation :failed))))

(defun begin-manipulation (operation resource &rest arguments)
  "Choose the method for ARGUMENTS, and run the method when its delay has passed. Fail if there is
no method, as after UNDEFINE."
  (let* ((manipulation (find-manipulation (command-name (operation-command operation)) nil))
         (method (and manipulation (applicable-method manipulation arguments resource))))
    (setf (operation-subject operation) method)
    (cond ((null method) (fail-with operation :failed))
          ((<= (method-delay method) 1) (carry-out operation))
          (t (go-on operation 'carry-out (1- (method-delay method)))))))

;;; Issuing.

(defun designator-arguments (operation)
  (remove-if-not #'designator-p (operation-arguments operation)))

(defun manipulation-report-text (operation value)
  "Return a text with the objects and resource of OPERATION, and VALUE unless it is NIL (manual E)."
  (format nil "~{~A~^, ~} by ~A~@[: ~A~]"
          (mapcar #'destination-name (designator-arguments operation))
          (operation-resource operation)
          (and value (one-line (safe-text value :escape nil :length 100)))))

(defun designated-local-things (operation)
  "Return a list of the things designated in OPERATION; NIL if a designator denotes no local thing."
  (let ((things (loop for designator in (designator-arguments operation)
                      collect (designated-local-thing designator (operation-resource operation)))))
    (and (notany #'null things) things)))

(defun manipulation-failure-text (operation)
  (let ((unfit (and (null (operation-subject operation)) (designated-local-things operation))))
    (format nil "~A failed~@[: ~A is not local, but objects of manipulations must be. Drive there, ~
                 for example with robot-goto-designator, and search again with the type :local~]~
                 ~@[: no method fits ~{~A~^, ~}, because the patterns of the methods require other ~
                 attributes~]~:[~; or things; a robot fits only a parameter such as x - robot~]"
            (command-prefix (operation-command operation))
            (find :local (designator-arguments operation) :key #'designator-type :test-not #'eq)
            unfit
            (some #'body-p unfit))))

(define-record (manipulation-command (:include command) (:constructor %make-manipulation-command))
  "The command by which a manipulation is carried out.")

(defmethod command-journal-entry ((command manipulation-command) operation)
  (list* 'manipulate (command-name command) (operation-arguments operation)))

(defun make-manipulation-command (name)
  (let ((prefix (string-downcase name)))
    (%make-manipulation-command
     :name name :prompt-name (string-upcase name) :prefix prefix
     :origin (format nil "the continuation of manipulation ~A" prefix)
     :family :manipulating :section "5.5"
     :documentation (format nil "Carry out the manipulation ~A." name)
     :resource (make-spec 'by t "the robot or part that carries out the manipulation")
     :results (list (make-spec 'value t "what the manipulation returns"))
     :errors (list (make-error-code :failed #'manipulation-failure-text))
     :delay (constantly 1)
     :report #'manipulation-report-text
     :body #'begin-manipulation)))

(defun ensure-manipulation-command (manipulation)
  "Return the command by which MANIPULATION is carried out. Make the command if there is none yet."
  (or (manipulation-command manipulation)
      (setf (manipulation-command manipulation)
            (make-manipulation-command (manipulation-name manipulation)))))

(public run-manipulation)
(defun run-manipulation (name &rest arguments)
  "Carry out the manipulation NAME, a symbol, with ARGUMENTS (manual 5.5.2). ARGUMENTS fit a method
of the manipulation: first designators for the objects, then the resource (a robot or part), the
other arguments, and last the continuation or NIL. Returns nothing; takes effect in the next tick.
The continuation gets an error code or NIL, and a value.
Error codes: :FAILED if no method fits the designated things, or by chance; :INTERRUPT; the error
codes of the manipulation. Signals UNKNOWN-NAME, and WRONG-ARGUMENT when no method takes ARGUMENTS."
  (let* ((manipulation (find-manipulation name))
         (continuation (first (last arguments)))
         (arguments (butlast arguments))
         (resource (method-resource (first (methods-for manipulation arguments)) arguments))
         (command (ensure-manipulation-command manipulation)))
    (check-argument-type name 'continuation continuation 'continuation)
    (warn-of-continuation command (robot-world (resource-robot resource)) continuation '(err value))
    (issue command resource arguments (and continuation
                                           (lambda (code resource value)
                                             (declare (ignore resource))
                                             (funcall continuation code value))))))

(public manipulate)
(define-user-macro manipulate (name &rest arguments)
  "Call RUN-MANIPULATION with the manipulation NAME, which is not evaluated, as in (manipulate lock
box-designator key-designator hand continuation) (manual 5.5.2)."
  (when (typep name '(cons (eql quote)))
    (reject-clause "manipulate" name
                   (format nil "the name without the quote: (manipulate ~(~A~) ...)"
                           (second name))))
  `(run-manipulation ',name ,@arguments))

(define-compiler-macro run-manipulation (&whole form &rest arguments &environment environment)
  (let ((name (first arguments)))
    (when (and name (symbolp name) (not (known-variable-p name environment))
               (find-manipulation name nil))
      (warn-of-style "run-manipulation: ~A is a manipulation and no variable. Quote its name: ~
                      '~:*~A" name)))
  form)

(define-operator 'manipulate '(name)
  (lambda (name &rest arguments) (apply #'run-manipulation name (append arguments '(nil))))
  :rest 'datum)
