;;;; compiling.lisp -- where in its source the compiler is, and what waits until it has read all.

(in-package :ars-magna.host)

(export '(keep-place in-source-p call-at-place at-end-of-unit call-as-unit place-in-text
          compiler-place))

;;; A list that was made of one that stands in the source can be given its place: what the compiler
;;; has to say of it is then said of what the author wrote. See src/host/compiler.lisp.

(defun in-source-p (form)
  "True if FORM was read from what is being compiled, or stands in place of what was."
  (and (place-of form) t))

(defun keep-place (new old)
  "Let NEW, made of OLD, stand where OLD does if it has no place yet. Return NEW."
  (let ((place (and (consp new) (not (eq new old)) (place-of old))))
    (when (and place (not (place-of new)))
      (set-place new place))
    new))

(defun call-at-place (form function)
  "Call FUNCTION. What it warns of the compiler takes to be about FORM."
  (let ((place (place-of form)))
    (if place
        (call-with-current-place place function)
        (funcall function))))

;;; SBCL also remembers where each form at top level begins in the text.

(defvar *kept-place* nil
  "While something is done that waited until all had been read: a list of a form and, after it,
where in the text that stands.")

(defun place-at (path)
  "Return the list that PLACE-IN-TEXT does of the form that PATH leads to, the innermost number
first; NIL if that is not known."
  (destructuring-bind (&optional top . numbers) (reverse path)
    (let ((positions (positions-of-forms)))
      (and top positions (< top (length positions))
           (cons (aref positions top) numbers)))))

(defun compiler-place ()
  "Return the pathname of the file that is being compiled, and what PLACE-IN-TEXT returns of the
form in it that the compiler is at, or NIL if that is not known. Return NIL if no file is being
compiled."
  (let* ((context (and *compile-file-truename* (error-context))) (file (context-file context)))
    (and file (values file (place-at (context-path context))))))

(defun place-in-text (form)
  "Return where FORM stands in the text that is being compiled or loaded: a list of the position
after which the form at top level around it begins, and of numbers from 0, which element of that it
is in, which element of this, and so on. Return NIL if that is not known."
  (cond
    ((and *kept-place* (eq form (first *kept-place*))) (rest *kept-place*))
    ((edited-file) nil)
    (t (place-at (nthcdr 2 (place-of form))))))

;;; What can be said only when all of a file has been read, or of all files of a system.
;;;
;;; Forms that are loaded belong together, and so do files that are compiled in one
;;; WITH-COMPILATION-UNIT; a file compiled by itself is a whole. When a form is evaluated Lisp makes
;;; a unit of it too: what is to be said at its end is left to the unit around that.

(defstruct (unit (:constructor make-unit (kind outer)) (:copier nil))
  "What is compiled or loaded as a whole, of KIND :LOAD or :COMPILATION, within OUTER. TASKS are,
by form, lists of a function to call at its end and where the form stands, for the compiler and in
the text."
  (kind :load :type (member :load :compilation) :read-only t)
  (outer nil :type (or null unit) :read-only t)
  (files-p nil :type boolean)
  (tasks (make-hash-table :test 'eq) :type hash-table :read-only t))

(defvar *unit* nil "The unit that is being compiled or loaded, or NIL.")

(defun context-of (form)
  (call-at-place form #'error-context))

(defun at-end-of-unit (form function)
  "Call FUNCTION when all has been read of what is compiled or loaded together with FORM, once. What
it warns of the compiler takes to be about FORM. Without a compiler, do nothing."
  (when (and *unit* (not (gethash form (unit-tasks *unit*))))
    (setf (gethash form (unit-tasks *unit*))
          (list function (context-of form) (place-in-text form)))))

(defun call-noting-warnings (function)
  "Call FUNCTION. What it warns of is told as what the compiler warns of. Return whether there was a
warning, and whether it was more than a matter of style."
  (let ((warned nil) (failed nil))
    (call-as-compiler
     (lambda ()
       (handler-bind ((warning (lambda (condition)
                                 (setf warned t)
                                 (unless (typep condition 'style-warning) (setf failed t)))))
         (funcall function))))
    (values warned failed)))

(defun end-unit (unit)
  "Do what was to be done at the end of UNIT, in order. Return what CALL-NOTING-WARNINGS does."
  (if (plusp (hash-table-count (unit-tasks unit)))
      (call-noting-warnings
       (lambda ()
         (loop for form being the hash-keys of (unit-tasks unit)
                 using (hash-value (function place in-text))
               do (let ((*kept-place* (cons form in-text)))
                    (call-with-error-context place function)))))
      (values nil nil)))

(defun leave-to-outer (unit)
  (loop for form being the hash-keys of (unit-tasks unit) using (hash-value task)
        do (setf (gethash form (unit-tasks (unit-outer unit))) task)))

(defun call-in-unit (kind function &optional own)
  "Call FUNCTION in a unit of KIND, and return its values: the unit at hand if that will do and OWN
is not true, or else another."
  (if (and *unit* (not own) (member (unit-kind *unit*) (list kind :compilation)))
      (funcall function)
      (let ((*unit* (make-unit kind (and (not own) *unit*))))
        (multiple-value-prog1 (funcall function)
          (if (and (unit-outer *unit*) (not (unit-files-p *unit*)))
              (leave-to-outer *unit*)
              (let ((unit (shiftf *unit* nil))) (end-unit unit)))))))

(defun call-as-unit (function)
  "Call FUNCTION, which evaluates forms that belong together, and return its values."
  (call-in-unit :load function t))

(defun compile-in-unit (function)
  "Call FUNCTION, which compiles a file and returns what COMPILE-FILE does. Return that."
  (cond ((and *unit* (eq :compilation (unit-kind *unit*)))
         (setf (unit-files-p *unit*) t)
         (funcall function))
        (t (let ((*unit* (make-unit :compilation nil)))
             (multiple-value-bind (output warned failed) (funcall function)
               (let ((unit (shiftf *unit* nil)))
                 (multiple-value-bind (warned-now failed-now) (end-unit unit)
                   (values output (or warned warned-now) (or failed failed-now)))))))))

;; Who compiles or loads another file meanwhile has functions of that.
(defun apply-in-own-file (function arguments)
  "Apply FUNCTION, which compiles or loads a file, to ARGUMENTS."
  (call-as-other-file (lambda () (apply function arguments)) #'evaluated-file-p))

;;; SBCL has no hook for the end of a unit.

(defun watch-units ()
  (wrap-function 'compile-file
                 (lambda (function &rest arguments)
                   (compile-in-unit (lambda () (apply-in-own-file function arguments)))))
  (wrap-function 'load
                 (lambda (function &rest arguments)
                   (call-in-unit :load (lambda () (apply-in-own-file function arguments)))))
  (wrap-compilation-units
   (lambda (function body &rest options &key override &allow-other-keys)
     (apply function (lambda () (call-in-unit :compilation body override)) options))))

(watch-units)
