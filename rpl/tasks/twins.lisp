;;;; twins.lisp -- what plans call instead of functions that tell only their continuations.

(in-package :ars-magna.rpl.tasks)

(export '(note-twin has-twin-p twin-text end-text last-command last-pulse plan-function-p
          results-of-command pulse-of-command teller-of-code))

(defun note-twin (name call wait &optional fluent codes results)
  "Note that plans write CALL, with the names of its arguments, of which the first is a part if
there are several of them, instead of a call of NAME; and that (wait-for WAIT) then waits for the
end, unless WAIT is NIL. FLUENT, a form, or NIL, then has one of CODES if something went wrong, and
RESULTS, forms of fluents, what was found."
  (setf (get name 'twin) (list call wait)
        (get (first call) 'end) (list (second call) wait results)
        (get (first call) 'codes) (list fluent codes)))

(defun plan-function-p (name)
  "True if NAME is a plan's function for a command."
  (and (symbolp name) (get name 'end) t))

(defun teller-of-code (name code)
  "Return the form of the fluent that has CODE if what NAME, a plan's function, has begun ends so;
NIL if it never does."
  (destructuring-bind (&optional fluent codes) (and (symbolp name) (get name 'codes))
    (and (symbolp code) (member code codes :test #'same-name-p) fluent)))

(defun has-twin-p (name)
  "True if plans call another function instead of the one called NAME."
  (and (symbolp name) (get name 'twin) t))

(defun wait-form-text (wait)
  (let ((*print-pretty* nil)) (and wait (format nil "(wait-for ~(~A~))" wait))))

(defun pulse-of-command (name)
  "Return the form of the fluent that is pulsed when a command called NAME of a plan ends, or NIL."
  (second (get name 'twin)))

(defun twin-text (name)
  "Return in words what plans write instead of a call of NAME."
  (destructuring-bind (call wait) (get name 'twin)
    (let ((*print-pretty* nil))
      (format nil "~(~A~)~@[ ~A~]" call (wait-form-text wait)))))

(defun end-text (name part)
  "Return in words how plans wait for the end of what NAME, a plan's function, has begun on the part
numbered PART, or NIL if nothing tells of that."
  (destructuring-bind (&optional variable wait results) (get name 'end)
    (declare (ignore results))
    (wait-form-text (subst part variable wait))))

(defun results-of-command (name part)
  "Return the forms of the fluents that have what NAME, a plan's function, has found out by the part
numbered PART."
  (destructuring-bind (&optional variable wait results) (get name 'end)
    (declare (ignore wait))
    (subst part variable results)))

(defgeneric last-command (client task)
  (:documentation "Return the name of the plan's function that the plan TASK is of has called last,
and the number of the part that it is for, if any, as CLIENT knows; NIL if it has called none.")
  (:method (client task)
    (declare (ignore client task))
    nil))

(defgeneric last-pulse (client task fluent)
  (:documentation "Return the tick at which FLUENT was pulsed last by the end of a command, if that
was one of the plan that TASK is of, as CLIENT knows; or NIL.")
  (:method (client task fluent)
    (declare (ignore client task fluent))
    nil))
