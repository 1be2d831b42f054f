;;;; trying.lisp -- how a RAP runs: it tries methods until its success test holds.

(in-package :ars-rap)

;;; Each try is a task of its own. Its name says which RAP it is of, which try, which method and
;;; with which values. So all that shows tasks shows tries, and the steps of a task net as parts of
;;; their try.

(define-condition rap-failed (plan-failure)
  ((call :initarg :call :initform '(nil) :reader rap-failed-call)
   (tries :initarg :tries :initform '() :reader rap-failed-tries))
  (:documentation "A RAP has no method left to try."))

(defun rap-failed-name (failure)
  "Return the name of the RAP that failed."
  (first (rap-failed-call failure)))

(setf (documentation 'rap-failed-tries 'function)
      "Return a list of what the RAP tried, the newest first: lists (method values text). METHOD is
the name of the method, VALUES those of its variables, TEXT why the try did not help.")

;;; Texts of tries contain the texts of the RAPs that they called, and so on. What is longer than
;;; a limit is cut in its middle: it begins with the RAP and ends with the innermost cause.

(defparameter *longest-note* 300 "The largest number of characters in the text of a failed RAP.")

(defun cut-middle (text length)
  (if (<= (length text) length)
      text
      (let ((half (floor (- length 5) 2)))
        (format nil "~A ... ~A" (string-right-trim " " (subseq text 0 half))
                (string-left-trim " " (subseq text (- (length text) half)))))))

(defun try-note (try count)
  "Return a text of COUNT tries that are equal to TRY, a list (method values text)."
  (destructuring-bind (method values text) try
    (format nil "~A~[~;~:;~:*, ~D times~]: ~A" (data-text (cons method values)) count text)))

(defun counted (tries)
  "Return lists (try count) of the different TRIES, in order."
  (let ((counts '()))
    (dolist (try tries (reverse counts))
      (let ((known (assoc try counts :test #'equal)))
        (if known (incf (second known)) (push (list try 1) counts))))))

(defmethod write-failure ((failure rap-failed) stream)
  (let ((call (data-text (rap-failed-call failure)))
        (notes (loop for (try count) in (counted (reverse (rap-failed-tries failure)))
                     collect (try-note try count))))
    (write-string (cut-middle (format nil "~A: ~:[no method is applicable~;~:*~{~A~^; ~}~]"
                                      call notes)
                              *longest-note*)
                  stream)))

;;; Calls without end. Plans have a limit on how deep calls are in each other; a RAP that tried
;;; again what is beyond it would try without end.

(define-condition endless-rap (plan-failure)
  ((call :initarg :call :reader endless-rap-call)
   (depth :initarg :depth :reader endless-rap-depth))
  (:documentation "A RAP has called itself with the same arguments, again and again."))

(defmethod write-failure ((failure endless-rap) stream)
  (format stream "The RAP ~A calls itself with the same arguments, until ~D calls are in each ~
                  other; give it a success test or contexts that end this"
          (data-text (endless-rap-call failure)) (endless-rap-depth failure)))

(defun of-class-p (failure &rest names)
  "True if the class of FAILURE is a symbol with one of NAMES."
  (let ((class (failure-class failure)))
    (and class (symbolp class) (member class names :test #'string=))))

(defun ends-rap-p (failure)
  "True if FAILURE, of a method, ends the RAP: an error of Lisp or a limit of plans."
  (or (typep failure 'lisp-failure)
      (of-class-p failure 'too-deep 'too-many-tasks 'too-many-commands)))

;;; Tries.

(defstruct (rap-try (:constructor make-rap-try (call number method variables values))
                    (:copier nil))
  "The name of the task of a try: try NUMBER of the RAP that was called by CALL, a list of its name
and arguments, by METHOD with VALUES of VARIABLES."
  (call '() :type list :read-only t)
  (number 1 :type fixnum :read-only t)
  (method nil :type symbol :read-only t)
  (variables '() :type list :read-only t)
  (values '() :type list :read-only t)
  (text nil :type (or null string)))

(defun call-text (call)
  (format nil "~{~A~^ ~}" (mapcar #'data-text call)))

(defun try-text (try)
  "Return a text of TRY, such as \"bring cup table, try 2: by-hand (where sink)\"."
  (or (rap-try-text try)
      (setf (rap-try-text try)
            (cut (format nil "~A, try ~D: ~(~A~)~@[ (~{~(~A~) ~A~^, ~})~]"
                         (call-text (rap-try-call try)) (rap-try-number try) (rap-try-method try)
                         (loop for variable in (rap-try-variables try)
                               for value in (rap-try-values try)
                               collect variable collect (data-text value)))
                 120))))

(defmethod print-object ((try rap-try) stream)
  (write-string (try-text try) stream))

(defstruct (rap-run (:constructor make-rap-run (call)) (:copier nil))
  "One run of a RAP by CALL. TRIES are as RAP-FAILED-TRIES returns them; equal tries share a list.
CHOICES is a list of lists (candidate count try) with the newest try of each candidate, a list
(method values). CANDIDATE is the one that is being tried."
  (call '() :type list :read-only t)
  (number 0 :type fixnum)
  (tries '() :type list)
  (choices '() :type list)
  (candidate nil :type list))

(defun note-try (run text)
  "Note in RUN that the candidate did not help, because of TEXT."
  (let* ((candidate (rap-run-candidate run))
         (choice (or (assoc candidate (rap-run-choices run) :test #'value-equal)
                     (first (push (list candidate 0 nil) (rap-run-choices run))))))
    (unless (and (third choice) (string= text (third (third choice))))
      (setf (third choice) (list (first candidate) (second candidate) text)))
    (incf (second choice))
    (push (third choice) (rap-run-tries run))))

(defun choose-method (rows run limit)
  "Return a candidate, (method values), with the fewest tries in RUN: the first among equals. Return
NIL if all that apply were tried LIMIT times. ROWS are lists (name query variable...)."
  (let ((best nil) (fewest limit))
    (loop for (name query . variables) in rows
          do (dolist (bindings (if query (solve query '()) (list '())))
               (let* ((candidate (list name (instance variables bindings)))
                      (count (or (second (assoc candidate (rap-run-choices run)
                                                :test #'value-equal))
                                 0)))
                 (when (< count fewest) (setf best candidate fewest count))
                 (when (zerop fewest) (return-from choose-method best)))))
    best))

(defun name-of-try (run variables)
  (destructuring-bind (method values) (rap-run-candidate run)
    (make-rap-try (rap-run-call run) (incf (rap-run-number run)) method variables values)))

(defun explained (failure task call)
  "Return FAILURE, or, if it is that calls are too deep, and TASK is of a RAP with CALL inside an
equal one, a failure of the same class that says so."
  (if (and (of-class-p failure 'too-deep)
           (not (typep failure 'endless-rap))
           (< 1 (count call (rap-calls-around task) :test #'value-equal)))
      (failure-of (make-condition 'endless-rap :class (failure-class failure) :call call
                                               :depth (getf (failure-data failure) :depth)
                                               :cause failure)
                  task (task-frame task))
      failure))

(defun rap-calls-around (task)
  (loop for frame in (frames-around task)
        when (rap-run-p (frame-data frame)) collect (rap-run-call (frame-data frame))))

(defun start-try (run methods task environment)
  "Start the candidate of RUN, one of METHODS, as a part of TASK. Return what a step returns."
  (destructuring-bind (variables . body)
      (rest (assoc (first (rap-run-candidate run)) methods :test #'eq))
    (spawn task body (apply #'vector environment (second (rap-run-candidate run))) 0
           (task-level task)
           (make-task (name-of-try run variables) body))
    (park task nil)
    +parked+))

(define-expression rap-tries
  "Runs a RAP. The function CALL returns its name and arguments, DONE whether its success test holds
(NIL if it has none), ROWS the rows for CHOOSE-METHOD. METHODS is a list of lists (name variables .
node). LIMIT is the number of times that a candidate is tried."
  (:parts (call function) (done (or null function)) (rows function) (limit integer) (methods list))
  (:steps
   (begin
    (setf memory (make-rap-run (funcall call environment)))
    (at-once choosing))
   (trying
    (cond ((or done (stringp value))
           (note-try memory value)
           (at-once choosing))
          (t (values (frame-up frame) nil))))
   (choosing
    (cond ((and done (funcall done environment)) (values (frame-up frame) nil))
          (t (setf (rap-run-candidate memory)
                   (choose-method (funcall rows environment) memory limit))
             (unless (rap-run-candidate memory)
               (fail (make-condition 'rap-failed :call (rap-run-call memory)
                                                 :tries (rap-run-tries memory))))
             (next trying)
             (start-try memory methods task environment)))))
  (:child-ended
   (ecase how
     (:succeeded (end-with-value task (and done "its success test does not hold")))
     (:evaporated (end-with-value task "it was ended"))
     (:escaped (end-with-signal task result))
     (:failed (if (ends-rap-p result)
                  (end-with-signal task (explained result task (rap-run-call memory)))
                  (end-with-value task (failure-text result)))))))

(defmethod current-form ((node rap-tries) frame)
  (if (frame-data frame)
      (rap-run-call (frame-data frame))
      (node-form node)))

;;; The plan text of RAPs has two forms of its own.

(defun method-node-code (method scope)
  "Return code for an element of the slot METHODS. METHOD is a list (name variables bound form...);
BOUND are the variables that FORMS see, in the order of VARIABLES."
  (destructuring-bind (name variables bound . forms) method
    `(list* ',name ',variables
            ,(block-code nil (first forms) (variable-scope (single-value-scope scope) bound)
                         (lambda (scope) (body-code forms scope))))))

(define-plan-form rap-tries :must (call limit done rows &rest methods) (form scope)
  `(make-rap-tries :form ',(form-as-written form)
                   :call ,(value-lambda `(list ',(first call) ,@(rest call)) scope)
                   :limit ,limit
                   :done ,(and done (value-lambda done scope))
                   :rows ,(value-lambda rows scope)
                   :methods (list ,@(loop for method in methods
                                          collect (method-node-code method scope)))))

(define-plan-form shown-as :must (written form) (whole scope)
  ;; A copy, because the text of the definition itself always shows as it is.
  (plan-code (note-expansion (copy-list form) written) scope))
