;;;; elsewhere.lisp -- which names code of other threads has bound to robots of its own.

(in-package :ars-magna.host)

(export '(call-telling-names bound-elsewhere-text run-elsewhere-text))

;;; WITH-SIMULATION binds robots' names, and only the thread of its body sees that. Another thread
;;; finds the robot of the top level under such a name, perhaps without knowing. Who notices that
;;; something is asked of that one can tell why.

(defvar *bound-names* (list '())
  "A list whose element is a list (thread number name...) for each WITH-SIMULATION under way.")

(defvar *bindings-made* (list 0) "A list of how often names have been bound so.")

(defun call-telling-names (names function)
  "Call FUNCTION, in whose extent NAMES are bound to robots for this thread only, and let others
know. Return its values."
  (let ((entry (list* (current-thread) (incf (car *bindings-made*)) names)))
    (in-any-case
      (progn (atomic-push entry (car *bound-names*))
             (funcall function))
      (loop for entries = (car *bound-names*)
            until (swap-if (car *bound-names*) entries (remove entry entries :test #'eq))))))

(defun bound-elsewhere (name)
  "Return the thread that has bound NAME last, and a number for when, if it is not this one, and
this one has not bound NAME itself; or NIL."
  (let ((entries (remove-if-not (lambda (entry) (member name (cddr entry) :test #'eq))
                                (car *bound-names*))))
    (if (find (current-thread) entries :key #'first)
        nil
        (values (first (first entries)) (second (first entries))))))

(defun run-elsewhere-text ()
  "Return in words how code here gets at the run of another thread, or NIL if none has one."
  (let ((entry (find (current-thread) (car *bound-names*) :key #'first :test-not #'eq)))
    (and entry
         (format nil "That of (with-simulation (~(~{~A~^ ~}~)) ...), in ~A, is there only. Hand it ~
                      over in a variable: (let ((simulation (current-simulation))) (make-thread ~
                      (lambda () ... simulation)))."
                 (cddr entry) (thread-name (first entry))))))

(defun bound-elsewhere-text (name)
  "Return in words how code here gets at the robot that another thread has bound NAME to, or NIL if
none has; and a number for that binding."
  (multiple-value-bind (thread number) (bound-elsewhere name)
    (values (and thread
                 (let ((name (string-downcase name)))
                   (format nil "In this thread, ~A, ~A is the robot of the top level. That of ~
                                (with-simulation (~A) ...), in ~A, is bound there only. Hand it ~
                                over in a variable: (let ((robot ~A)) (make-thread (lambda () ~
                                ... robot)))."
                           (thread-name (current-thread)) name name (thread-name thread) name)))
            number)))
