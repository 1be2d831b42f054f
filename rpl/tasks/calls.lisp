;;;; calls.lisp -- arguments that plans and functions take, and what plans call for commands.

(in-package :ars-magna.rpl.tasks)

(export '(lambda-list-shape lambda-list-text unknown-keyword-text arguments-misfit-text
                            note-plan-function
          has-plan-function-p plan-call-text wait-for-end-text last-command last-pulse-tick
          advice-on-event
          plan-function-p result-fluent-forms pulse-of-command fluent-of-error-code))

(define-record (shape (:constructor make-shape (least most fixed keys open)))
  "The number of arguments, LEAST to MOST, and the keywords that a function or plan takes."
  (least 0 fixnum)
  (most most-positive-fixnum fixnum)
  (fixed 0 fixnum "how many arguments come before the keywords" :export)
  (keys :none (or list (eql :none))
        "the list of the keywords, or :NONE if there is no &KEY" :export)
  (open nil t "true if other keywords are allowed, too"))

(defun keyword-of (parameter)
  (let ((name (if (consp parameter) (first parameter) parameter)))
    (cond ((consp name) (first name))
          (t (make-keyword name)))))

(defun lambda-list-shape (lambda-list)
  "Return the shape of LAMBDA-LIST, an ordinary lambda list or the lambda list of a function type."
  (let ((mode nil) (least 0) (optional 0) (keys '()) (seen '()))
    (dolist (parameter lambda-list)
      (cond ((member parameter lambda-list-keywords)
             (setf mode parameter)
             (push parameter seen))
            (t (case mode
                 ((nil) (incf least))
                 (&optional (incf optional))
                 (&key (push (keyword-of parameter) keys))))))
    (make-shape least
                (if (intersection '(&rest &key &body) seen) most-positive-fixnum (+ least optional))
                (+ least optional)
                (if (member '&key seen) (nreverse keys) :none)
                (member '&allow-other-keys seen))))

(defun lambda-list-text (lambda-list)
  "Return LAMBDA-LIST as text, in lower case."
  (printing-text ()
    (let ((*print-case* :downcase) (*print-pretty* nil))
      (format nil "~:A" lambda-list))))

(defun unknown-keyword-text (shape rest &key (wrong-p #'keywordp))
  "Return the text of a keyword in REST that SHAPE does not take; or NIL. REST lists the arguments
after the fixed arguments, or their forms. Elements for which WRONG-P is false are not checked."
  (unless (or (shape-open shape)
              (loop for (key value) on rest by #'cddr
                    thereis (and (eq key :allow-other-keys) value)))
    (loop for (key) on rest by #'cddr
          when (and (funcall wrong-p key)
                    (not (member key (list* :allow-other-keys (shape-keys shape)))))
            return (format nil "~(~S~)~@[ (did you mean ~(~S~)?)~]"
                           key (and (keywordp key) (nearest-name key (shape-keys shape)))))))

(defun arguments-misfit-text (shape arguments &key (wrong-p #'keywordp))
  "Return a text that says why ARGUMENTS, or forms for them, do not fit SHAPE; NIL if they may fit.
WRONG-P is as for UNKNOWN-KEYWORD-TEXT."
  (let* ((count (length arguments))
         (rest (nthcdr (shape-fixed shape) arguments)))
    (cond ((not (<= (shape-least shape) count (shape-most shape)))
           (format nil "~D argument~:P" count))
          ((eq :none (shape-keys shape)) nil)
          ((oddp (length rest))
           (loop for (key) on rest by #'cddr
                 when (typep key '(or real string))
                   return (format nil "~S in place of a keyword" key)
                 finally (return "a keyword without a value")))
          (t (unknown-keyword-text shape rest :wrong-p wrong-p)))))

;;;; Plan functions for commands

(defun note-plan-function (name call wait &optional fluent codes results)
  "Record what plans write instead of a call of the command NAME: CALL, and then (wait-for WAIT)
unless WAIT is NIL. CALL is the plan function with the names of its arguments. The first argument is
the number of a part if the robot may have several such parts. FLUENT is the form of the fluent that
has one of CODES if the command failed, or NIL. RESULTS are forms of the fluents for the results."
  (setf (get name 'plan-call) (list call wait)
        (get (first call) 'end) (list (second call) wait results)
        (get (first call) 'codes) (list fluent codes)))

(defun plan-function-p (name)
  "True if NAME is the name of a plan function for a command."
  (and (symbolp name) (get name 'end) t))

(defun fluent-of-error-code (name code)
  "Return the form of the fluent set when a command of plan function NAME ends with CODE, or NIL."
  (destructuring-bind (&optional fluent codes) (and (symbolp name) (get name 'codes))
    (and (symbolp code) (member code codes :test #'same-name-p) fluent)))

(defun has-plan-function-p (name)
  "True if plans call a plan function instead of the command NAME."
  (and (symbolp name) (get name 'plan-call) t))

(defun wait-form-text (wait)
  (let ((*print-pretty* nil)) (and wait (format nil "(wait-for ~(~A~))" wait))))

(defun pulse-of-command (name)
  "Return the form of the fluent that is pulsed when the command NAME of a plan ends, or NIL."
  (second (get name 'plan-call)))

(defun plan-call-text (name)
  "Return the text of the call that plans write instead of a call of the command NAME."
  (destructuring-bind (call wait) (get name 'plan-call)
    (let ((*print-pretty* nil))
      (format nil "~(~A~)~@[ ~A~]" call (wait-form-text wait)))))

(defun wait-for-end-text (name part)
  "Return the text of the form that waits for the end of a command. The plan function NAME has given
the command to part number PART. Return NIL if no fluent is pulsed at the end."
  (destructuring-bind (&optional variable wait results) (get name 'end)
    (declare (ignore results))
    (wait-form-text (subst part variable wait))))

(defun result-fluent-forms (name part)
  "Return the forms of the fluents for the results of the plan function NAME on part number PART."
  (destructuring-bind (&optional variable wait results) (get name 'end)
    (declare (ignore wait))
    (subst part variable results)))

(defgeneric last-command (client task)
  (:documentation "Return the name of the last plan function that the plan of TASK has called. Also
return the number of the part of the robot, if any. Return NIL if the plan has called no plan
function. CLIENT has recorded the calls.")
  (:method (client task)
    (declare (ignore client task))
    nil))

(defgeneric last-pulse-tick (client task fluent)
  (:documentation "Return the tick of the last pulse of FLUENT, if the end of a command of the plan
of TASK caused this pulse; otherwise NIL. CLIENT has recorded the commands.")
  (:method (client task fluent)
    (declare (ignore client task fluent))
    nil))

(defgeneric advice-on-event (client fluent tasks awaited)
  (:documentation "If FLUENT changes at events of CLIENT's run other than the ends of commands,
return a list of texts that say which these are, and what to do so that such an event happens;
otherwise NIL. TASKS wait for FLUENT. A caller other than RUN-PLAN waits for the end of the plan
AWAITED, unless it is NIL.")
  (:method (client fluent tasks awaited)
    (declare (ignore client fluent tasks awaited))
    nil))
